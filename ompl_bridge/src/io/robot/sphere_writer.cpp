// SPDX-License-Identifier: BSD-3-Clause
// Spherised URDF, SRDF with link_sphere_approximation, and cuRobo's YAML.
#include "leeway/io/spheres.hpp"

#include "base/xml.hpp"
#include "robot/urdf_writer.hpp"

#include <fmt/format.h>

#include <iterator>

namespace leeway::io
{

namespace
{

using tinyxml2::XMLElement;

std::string center( const LinkSpheres& link, std::size_t sphere, const char* between )
{
	const double* s = link.spheres.data() + 4 * sphere;
	return fmt::format( "{:.6f}{}{:.6f}{}{:.6f}", s[0], between, s[1], between, s[2] );
}

std::string radius( const LinkSpheres& link, std::size_t sphere )
{
	return fmt::format( "{:.6f}", link.spheres[4 * sphere + 3] );
}

const LinkSpheres* find( const std::vector<LinkSpheres>& links, const char* name )
{
	for ( const LinkSpheres& link : links )
	{
		if ( name != nullptr && link.link == name )
		{
			return &link;
		}
	}
	return nullptr;
}

void removeAll( XMLElement& parent, const char* name )
{
	while ( XMLElement* e = parent.FirstChildElement( name ) )
	{
		parent.DeleteChild( e );
	}
}

} // namespace

std::string writeSpheresUrdf( const RobotModel& model, const std::vector<LinkSpheres>& links )
{
	detail::XmlFile file(
	    model.urdf_file, model.expanded_urdf.empty() ? readWholeFile( model.urdf_file ) : model.expanded_urdf );
	tinyxml2::XMLDocument& xml = file.document();
	if ( !detail::isPlainUrdf( file ) )
	{
		detail::describe( model, xml );
	}
	for ( XMLElement* link = xml.RootElement()->FirstChildElement( "link" ); link != nullptr;
	      link = link->NextSiblingElement( "link" ) )
	{
		const LinkSpheres* spheres = find( links, link->Attribute( "name" ) );
		if ( spheres == nullptr )
		{
			continue;
		}
		removeAll( *link, "collision" );
		for ( std::size_t i = 0; i < spheres->count(); ++i )
		{
			XMLElement* collision = xml.NewElement( "collision" );
			XMLElement* origin = xml.NewElement( "origin" );
			XMLElement* geometry = xml.NewElement( "geometry" );
			XMLElement* sphere = xml.NewElement( "sphere" );
			origin->SetAttribute( "xyz", center( *spheres, i, " " ).c_str() );
			origin->SetAttribute( "rpy", "0 0 0" );
			sphere->SetAttribute( "radius", radius( *spheres, i ).c_str() );
			geometry->InsertEndChild( sphere );
			collision->InsertEndChild( origin );
			collision->InsertEndChild( geometry );
			link->InsertEndChild( collision );
		}
	}
	return detail::printed( xml );
}

std::string writeSpheresSrdf( const RobotModel& model, const std::vector<LinkSpheres>& links )
{
	detail::SrdfDraft draft( model );
	tinyxml2::XMLDocument& xml = draft.document();
	XMLElement* root = xml.RootElement();
	for ( XMLElement* e = root->FirstChildElement( "link_sphere_approximation" ); e != nullptr; )
	{
		XMLElement* next = e->NextSiblingElement( "link_sphere_approximation" );
		const char* name = e->Attribute( "link" );
		if ( name != nullptr && find( links, name ) != nullptr )
		{
			root->DeleteChild( e );
		}
		e = next;
	}
	for ( const LinkSpheres& link : links )
	{
		XMLElement* approximation = xml.NewElement( "link_sphere_approximation" );
		approximation->SetAttribute( "link", link.link.c_str() );
		for ( std::size_t i = 0; i < link.count(); ++i )
		{
			XMLElement* sphere = xml.NewElement( "sphere" );
			sphere->SetAttribute( "center", center( link, i, " " ).c_str() );
			sphere->SetAttribute( "radius", radius( link, i ).c_str() );
			approximation->InsertEndChild( sphere );
		}
		root->InsertEndChild( approximation );
	}
	return detail::printed( xml );
}

std::string writeSpheresYaml( const RobotModel& model, const std::vector<LinkSpheres>& links )
{
	// JSON's quoting is YAML's too; names with a quote or a backslash are rare but legal
	const auto quoted = []( const std::string& name )
	{
		std::string out = "\"";
		for ( const char c : name )
		{
			out += c == '"' || c == '\\' ? std::string( { '\\', c } ) : std::string( 1, c );
		}
		return out + "\"";
	};
	std::string text = fmt::format( "robot: {}\ncollision_spheres:\n", quoted( model.name ) );
	for ( const LinkSpheres& link : links )
	{
		fmt::format_to( std::back_inserter( text ), "  {}: # {} spheres, at most {:.6f} m beyond the link\n",
		    quoted( link.link ), link.count(), link.report.excess );
		for ( std::size_t i = 0; i < link.count(); ++i )
		{
			fmt::format_to( std::back_inserter( text ), "    - \"center\": [{}]\n      \"radius\": {}\n",
			    center( link, i, ", " ), radius( link, i ) );
		}
	}
	return text;
}

} // namespace leeway::io
