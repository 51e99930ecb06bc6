// SPDX-License-Identifier: BSD-3-Clause
// Settings of a whole MJCF model: <compiler>, <option> and the classes of <default>.
#include "mjcf/settings.hpp"

#include <cctype>
#include <cstring>
#include <fmt/format.h>

namespace leeway::io::detail::mjcf
{

namespace
{

/// Elements of a class whose attributes are looked up.
constexpr const char* classed_elements[] = { "joint", "geom", "mesh", "equality", "material" };

bool isTrue( const Document& document, const XMLElement& at, const std::string& what, const char* attribute )
{
	return document.word( at, what, attribute, { "true", "false" } ) == "true";
}

void readFlags( const Document& document, Compiler& compiler, std::vector<Notice>& notices )
{
	for ( const XMLElement* flag : document.inSections( "option", "flag" ) )
	{
		if ( flag->Attribute( "filterparent" ) != nullptr )
		{
			compiler.filter_parent = document.word( *flag, "flag", "filterparent", { "enable", "disable" } ) == "enable";
		}
		if ( flag->Attribute( "contact" ) != nullptr &&
		     document.word( *flag, "flag", "contact", { "enable", "disable" } ) == "disable" )
		{
			notices.push_back( document.notice( *flag, "flag", "contact=\"disable\" is ignored: contacts are checked" ) );
		}
	}
}

void readCompilerElement( const Document& document, const XMLElement& e, Compiler& compiler, std::string& asset_folder )
{
	const std::string what = "compiler";
	const auto has = [&]( const char* attribute ) { return e.Attribute( attribute ) != nullptr; };
	if ( has( "coordinate" ) && document.word( e, what, "coordinate", { "local", "global" } ) == "global" )
	{
		document.fail( e, what, "coordinate=\"global\" is not read, and MuJoCo has not read it since 2.3.4",
		    "let an older MuJoCo write the model: it writes local coordinates" );
	}
	compiler.degrees =
	    has( "angle" ) ? document.word( e, what, "angle", { "degree", "radian" } ) == "degree" : compiler.degrees;
	compiler.auto_limits = has( "autolimits" ) ? isTrue( document, e, what, "autolimits" ) : compiler.auto_limits;
	compiler.strip_path = has( "strippath" ) ? isTrue( document, e, what, "strippath" ) : compiler.strip_path;
	compiler.align_free = has( "alignfree" ) ? isTrue( document, e, what, "alignfree" ) : compiler.align_free;
	compiler.mesh_folder = has( "meshdir" ) ? document.optionalText( e, what, "meshdir" ) : compiler.mesh_folder;
	asset_folder = has( "assetdir" ) ? document.optionalText( e, what, "assetdir" ) : asset_folder;
	if ( has( "eulerseq" ) )
	{
		compiler.euler = document.text( e, what, "eulerseq" );
		if ( compiler.euler.size() != 3 || compiler.euler.find_first_not_of( "xyzXYZ" ) != std::string::npos )
		{
			document.fail( e, what, fmt::format( "eulerseq=\"{}\" is no sequence of three axes", compiler.euler ),
			    "write three of x, y, z, X, Y, Z" );
		}
	}
}

} // namespace

Compiler readCompiler( const Document& document, std::vector<Notice>& notices )
{
	Compiler compiler;
	std::string asset_folder;
	for ( const XMLElement* e : document.children( document.root(), "compiler" ) )
	{
		readCompilerElement( document, *e, compiler, asset_folder );
	}
	compiler.mesh_folder = compiler.mesh_folder.empty() ? asset_folder : compiler.mesh_folder;
	readFlags( document, compiler, notices );
	return compiler;
}

const char* orientationOf( const Document& document, const XMLElement& element )
{
	const char* found = nullptr;
	for ( const char* kind : orientations )
	{
		if ( element.Attribute( kind ) == nullptr )
		{
			continue;
		}
		if ( found != nullptr )
		{
			document.fail( element, fmt::format( "<{}>", element.Name() ), fmt::format( "has both {} and {}", found, kind ),
			    "give one orientation" );
		}
		found = kind;
	}
	return found;
}

Defaults::Defaults( const Document& document ) : m_document( document )
{
	m_classes["main"] = {};
	for ( const XMLElement* top : document.children( document.root(), "default" ) )
	{
		Attributes main = m_classes["main"]; // of several sections, each adds to it
		readClass( *top, main, 0 );
	}
}

void Defaults::readClass( const XMLElement& element, Attributes& attributes, std::size_t depth )
{
	std::string name = m_document.optionalText( element, "default", "class" );
	if ( name.empty() && depth > 0 )
	{
		m_document.fail( element, "default", "a class below another has no name", "add class=\"...\" to it" );
	}
	for ( const char* kind : classed_elements )
	{
		const std::vector<const XMLElement*> given = m_document.children( element, kind );
		if ( given.size() > 1 )
		{
			m_document.fail( *given[1], "default " + name, fmt::format( "has two <{}>", kind ), "keep one" );
		}
		if ( given.empty() )
		{
			continue;
		}
		if ( orientationOf( m_document, *given[0] ) != nullptr )
		{
			for ( const char* orientation : orientations )
			{
				attributes.erase( { kind, orientation } );
			}
		}
		for ( const tinyxml2::XMLAttribute* a = given[0]->FirstAttribute(); a != nullptr; a = a->Next() )
		{
			attributes[{ kind, a->Name() }] = given[0];
		}
	}
	if ( depth > 0 && !m_classes.emplace( name, attributes ).second )
	{
		m_document.fail(
		    element, "default " + name, "a class of this name was defined before", "rename or remove one of them" );
	}
	if ( depth == 0 )
	{
		m_classes["main"] = attributes;
		if ( !name.empty() )
		{
			m_classes[name] = attributes; // older files rename the class at the top
		}
	}
	checkLimit( &Limits::objects, m_classes.size() * ( 1 + attributes.size() ), "attributes of default classes",
	    m_document.path(), "<default>" );
	for ( const XMLElement* nested : m_document.children( element, "default" ) )
	{
		Attributes inherited = attributes;
		readClass( *nested, inherited, depth + 1 );
	}
}

void Defaults::requireClass( const XMLElement& at, const std::string& what, const std::string& name ) const
{
	if ( !name.empty() && m_classes.count( name ) == 0 )
	{
		std::vector<std::string> known;
		for ( const auto& [class_name, attributes] : m_classes )
		{
			known.push_back( class_name );
		}
		m_document.fail( at, what, fmt::format( "there is no default class {}", name ), "use one of " + joinNames( known ) );
	}
}

const Defaults::Attributes& Defaults::classOf( const XMLElement& element, const std::string& child_class ) const
{
	const std::string own = m_document.optionalText( element, element.Name(), "class" );
	requireClass( element, fmt::format( "<{}>", element.Name() ), own );
	return m_classes.at( !own.empty() ? own : !child_class.empty() ? child_class : "main" );
}

const XMLElement* Defaults::find(
    const XMLElement& element, const std::string& child_class, const char* attribute, const char* kind ) const
{
	if ( element.Attribute( attribute ) != nullptr )
	{
		return &element;
	}
	const Attributes& attributes = classOf( element, child_class );
	const auto found = attributes.find( { kind != nullptr ? kind : element.Name(), attribute } );
	return found != attributes.end() ? found->second : nullptr;
}

std::pair<const XMLElement*, const char*> Defaults::findOrientation(
    const XMLElement& element, const std::string& child_class ) const
{
	if ( const char* own = orientationOf( m_document, element ) )
	{
		return { &element, own };
	}
	for ( const char* kind : orientations )
	{
		if ( const XMLElement* carrier = find( element, child_class, kind ) )
		{
			return { carrier, kind };
		}
	}
	return { nullptr, nullptr };
}

} // namespace leeway::io::detail::mjcf
