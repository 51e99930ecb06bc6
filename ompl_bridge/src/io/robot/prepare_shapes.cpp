// SPDX-License-Identifier: BSD-3-Clause
// The collision elements of a URDF that are read: visual ones in their place on request, without shapes of size zero, and on request
// without meshes that are missing. One notice of each kind tells the changes.
#include "robot/prepare_shapes.hpp"

#include "shape/missing_meshes.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace leeway::io::detail
{

namespace
{

using tinyxml2::XMLElement;

/// LoadOptions::use_visual: where there is no collision element, visual elements become collision elements.
void useVisual( XmlFile& xml, std::vector<Notice>& notices )
{
	std::vector<std::string> names;
	XMLElement* link = xml.document().RootElement()->FirstChildElement( "link" );
	for ( ; link != nullptr; link = link->NextSiblingElement( "link" ) )
	{
		if ( link->FirstChildElement( "collision" ) != nullptr || link->FirstChildElement( "visual" ) == nullptr )
		{
			continue;
		}
		names.push_back( xml.text( *link, "link", "name" ) );
		while ( XMLElement* visual = link->FirstChildElement( "visual" ) )
		{
			visual->SetName( "collision" );
		}
	}
	if ( !names.empty() )
	{
		notices.push_back( { xml.path(), "<visual>",
		    fmt::format( "visual geometry is used for links without collision geometry: {}", joinNames( names ) ) } );
	}
}

/// Whether all numbers of a shape are there, and 0: some exporters put such boxes where a link has no shape.
bool hasNoSize( const XMLElement& collision )
{
	const XMLElement* geometry = collision.FirstChildElement( "geometry" );
	const XMLElement* shape = geometry != nullptr ? geometry->FirstChildElement() : nullptr;
	const bool alone = shape != nullptr && shape->NextSiblingElement() == nullptr;
	const std::string type = alone ? shape->Name() : "";
	const auto zero = [&]( const char* attribute, std::size_t count )
	{
		const char* text = shape->Attribute( attribute );
		const std::vector<std::string> words = splitBlanks( text != nullptr ? text : "" );
		return words.size() == count && std::all_of( words.begin(), words.end(),
		                                    []( const std::string& word ) { return parseNumber( word ) == 0.0; } );
	};
	return ( type == "box" && zero( "size", 3 ) ) || ( type == "sphere" && zero( "radius", 1 ) ) ||
	       ( ( type == "cylinder" || type == "capsule" ) && zero( "radius", 1 ) && zero( "length", 1 ) );
}

/// Takes collision elements of shapes without size out of the document.
void leaveOutShapesWithoutSize( XmlFile& xml, std::vector<Notice>& notices )
{
	std::vector<std::string> names;
	XMLElement* robot = xml.document().RootElement();
	for ( XMLElement* link = robot->FirstChildElement( "link" ); link != nullptr; link = link->NextSiblingElement( "link" ) )
	{
		for ( XMLElement* collision = link->FirstChildElement( "collision" ); collision != nullptr; )
		{
			XMLElement* next = collision->NextSiblingElement( "collision" );
			if ( hasNoSize( *collision ) )
			{
				names.push_back( fmt::format( "{} (line {})", xml.text( *link, "link", "name" ), collision->GetLineNum() ) );
				link->DeleteChild( collision );
			}
			collision = next;
		}
	}
	if ( !names.empty() )
	{
		notices.push_back( { xml.path(), "<collision>",
		    fmt::format(
		        "shapes of size zero are left out, {} of links: {}", names.size(), joinNames( names, names.size() ) ) } );
	}
}

/// The name of the mesh file of a collision element; nullptr if it is no mesh.
const char* meshOf( const XMLElement& collision )
{
	const XMLElement* geometry = collision.FirstChildElement( "geometry" );
	const XMLElement* mesh = geometry != nullptr ? geometry->FirstChildElement( "mesh" ) : nullptr;
	return mesh != nullptr ? mesh->Attribute( "filename" ) : nullptr;
}

/// LoadOptions::skip_missing_meshes: takes collision elements whose mesh is nowhere out of the document.
void leaveOutMissingMeshes( XmlFile& xml, const LoadOptions& options, std::vector<Notice>& notices )
{
	MissingMeshes missing;
	bool others = false;
	XMLElement* robot = xml.document().RootElement();
	for ( XMLElement* link = robot->FirstChildElement( "link" ); link != nullptr; link = link->NextSiblingElement( "link" ) )
	{
		for ( XMLElement* collision = link->FirstChildElement( "collision" ); collision != nullptr; )
		{
			XMLElement* next = collision->NextSiblingElement( "collision" );
			const char* uri = meshOf( *collision );
			if ( uri != nullptr && !hasResource( uri, xml.path(), options ) )
			{
				missing.add( uri, xml.text( *link, "link", "name" ), collision->GetLineNum() );
				link->DeleteChild( collision );
			}
			else
			{
				others = true;
			}
			collision = next;
		}
	}
	missing.report( xml.path(), others, notices );
}

} // namespace

void prepareShapes( XmlFile& xml, const LoadOptions& options, std::vector<Notice>& notices )
{
	leaveOutShapesWithoutSize( xml, notices );
	if ( options.use_visual )
	{
		useVisual( xml, notices );
		leaveOutShapesWithoutSize( xml, notices );
	}
	if ( options.skip_missing_meshes )
	{
		leaveOutMissingMeshes( xml, options, notices );
	}
}

} // namespace leeway::io::detail
