// SPDX-License-Identifier: BSD-3-Clause
// XML with strict numbers and errors that name file, element and line.
#include "base/xml.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fmt/format.h>

namespace leeway::io::detail
{

namespace
{

/// The first element below `at` that xacro would have replaced, or nullptr.
const tinyxml2::XMLElement* findXacro( const tinyxml2::XMLElement& at )
{
	if ( std::strncmp( at.Name(), "xacro:", 6 ) == 0 )
	{
		return &at;
	}
	for ( const tinyxml2::XMLAttribute* a = at.FirstAttribute(); a != nullptr; a = a->Next() )
	{
		if ( std::strstr( a->Value(), "${" ) != nullptr || std::strstr( a->Value(), "$(" ) != nullptr )
		{
			return &at;
		}
	}
	for ( const tinyxml2::XMLElement* child = at.FirstChildElement(); child != nullptr; child = child->NextSiblingElement() )
	{
		if ( const tinyxml2::XMLElement* found = findXacro( *child ) )
		{
			return found;
		}
	}
	return nullptr;
}

/// The first node beside the root that may not be there: elements and text; comments, declarations and DOCTYPE may.
const tinyxml2::XMLNode* findBesideRoot( const tinyxml2::XMLDocument& document )
{
	for ( const tinyxml2::XMLNode* node = document.FirstChild(); node != nullptr; node = node->NextSibling() )
	{
		if ( ( node->ToElement() != nullptr && node != document.RootElement() ) || node->ToText() != nullptr )
		{
			return node;
		}
	}
	return nullptr;
}

/// The parser's error: in plain words for some errors, as the parser's name of the error for the others.
std::string parserText( const tinyxml2::XMLDocument& document )
{
	switch ( document.ErrorID() )
	{
	case tinyxml2::XML_ERROR_PARSING_DECLARATION:
		return "<?xml ...?> stands behind something else: it has to be the first thing in the file";
	case tinyxml2::XML_ERROR_MISMATCHED_ELEMENT:
		return "a tag is closed that is not the open one, or never";
	case tinyxml2::XML_ERROR_PARSING_ATTRIBUTE:
		return "an attribute is not name=\"value\", or is there twice";
	default:
		return tinyxml2::XMLDocument::ErrorIDToName( document.ErrorID() );
	}
}

/// Roots of formats that are not read where a <robot> is wanted.
struct OtherFormat
{
	const char *root, *what, *remedy;
};
constexpr OtherFormat other_formats[] = {
    { "mujoco", "an MJCF model", "give it as the robot (--robot)" },
    { "mujocoinclude", "a part of an MJCF model", "give the file that includes it" },
    { "sdf", "an SDF model or world of Gazebo",
        "build leeway with libsdformat 12 (-DLEEWAY_SDF=ON), give the URDF that it was made from, or convert it to one (sdformat_urdf)" },
    { "COLLADA", "a COLLADA mesh", "name it as the mesh of a URDF" },
};

} // namespace

void refuseUsd( const std::string& file, const std::string& content )
{
	const auto begins = [&]( const char* with ) { return content.compare( 0, std::strlen( with ), with ) == 0; };
	const char* kind = begins( "#usda" )        ? "this is a USD stage (text)"
	                   : begins( "PXR-USDC" )   ? "this is a USD stage (binary)"
	                   : begins( "PK\x03\x04" ) ? "this is a zip archive, as usdz stages of USD are"
	                                            : nullptr;
	if ( kind != nullptr )
	{
		throw Error( file, "", kind,
		    "export it as a URDF or MJCF, with the program that made it, or convert it by Python: leeway.usd.to_urdf( FILE, FOLDER ); in "
		    "Python, leeway.usd.load( FILE ) reads it" );
	}
}

bool beginsAsXml( const std::string& content )
{
	const std::size_t bom = content.compare( 0, 3, "\xEF\xBB\xBF" ) == 0 ? 3 : 0;
	const std::size_t first = content.find_first_not_of( " \t\r\n", bom );
	return first != std::string::npos && content[first] == '<' &&
	       content.compare( first, 2, "<<" ) != 0; // <<: is a key of YAML
}

std::optional<XmlProblem> parseXml( tinyxml2::XMLDocument& document, std::string content )
{
	if ( const std::size_t zero = content.find( '\0' ); zero != std::string::npos )
	{
		const auto end = content.begin() + static_cast<std::ptrdiff_t>( zero );
		return XmlProblem{ 1 + static_cast<int>( std::count( content.begin(), end, '\n' ) ), "a byte 0: this is no text" };
	}
	// tinyxml2 takes a closing tag that closes nothing for the end of the document. An element that is put behind all the
	// rest, of a name that the document has not, shows whether it came that far.
	std::size_t run = 0, longest = 0;
	for ( char c : content )
	{
		run = c == '_' ? run + 1 : 0;
		longest = std::max( longest, run );
	}
	const std::string last( longest + 1, '_' );
	content += "<" + last + "/>";
	if ( document.Parse( content.data(), content.size() ) != tinyxml2::XML_SUCCESS )
	{
		if ( document.ErrorID() == tinyxml2::XML_ELEMENT_DEPTH_EXCEEDED )
		{
			return XmlProblem{ document.ErrorLineNum(),
			    fmt::format( "elements are nested more than {} deep, which is not read", TINYXML2_MAX_ELEMENT_DEPTH ) };
		}
		return XmlProblem{ document.ErrorLineNum(), fmt::format( "not well-formed XML ({})", parserText( document ) ) };
	}
	tinyxml2::XMLNode* end = document.LastChild();
	if ( end == nullptr || end->ToElement() == nullptr || end->Value() != last )
	{
		return XmlProblem{ end != nullptr ? end->GetLineNum() : 1,
		    "not well-formed XML (behind what begins there, a tag closes what was not opened)" };
	}
	document.DeleteChild( end );
	if ( const tinyxml2::XMLNode* beside = findBesideRoot( document ) )
	{
		const bool is_element = beside->ToElement() != nullptr;
		return XmlProblem{ beside->GetLineNum(), fmt::format( "not well-formed XML ({} beside the root element)",
		                                             is_element ? fmt::format( "<{}>", beside->Value() ) : "text" ) };
	}
	return std::nullopt;
}

XmlFile::XmlFile( const std::string& file, std::string content ) : m_path( file )
{
	refuseUsd( file, content );
	if ( const std::optional<XmlProblem> problem = parseXml( m_doc, std::move( content ) ) )
	{
		throw Error( file, fmt::format( "line {}", problem->line ), problem->text, "correct the file at that line" );
	}
}

void XmlFile::requireRobot( const char* kind ) const
{
	if ( m_doc.RootElement() == nullptr || std::strcmp( m_doc.RootElement()->Name(), "robot" ) != 0 )
	{
		const std::string name = m_doc.RootElement() != nullptr ? m_doc.RootElement()->Name() : "nothing";
		const auto known = std::find_if( std::begin( other_formats ), std::end( other_formats ),
		    [&]( const OtherFormat& format ) { return name == format.root; } );
		const bool named = known != std::end( other_formats );
		throw Error( m_path, fmt::format( "<{}>", name ),
		    named ? fmt::format( "this is {}, and the root element of a {} is <robot>", known->what, kind )
		          : fmt::format( "the root element of a {} is <robot>", kind ),
		    named ? known->remedy : fmt::format( "give a {} file", kind ) );
	}
	// An expanded file may still declare the xacro namespace; only elements and values that xacro replaces mark a xacro file
	if ( const tinyxml2::XMLElement* xacro = findXacro( root() ) )
	{
		if ( root().Attribute( "xmlns:xacro" ) == nullptr && std::strncmp( xacro->Name(), "xacro:", 6 ) == 0 )
		{
			fail( *xacro, fmt::format( "<{}>", xacro->Name() ),
			    "this is a xacro file whose <robot> does not declare xacro's namespace",
			    "write <robot xmlns:xacro=\"http://www.ros.org/wiki/xacro\" ...>; then it is read as it is" );
		}
		fail( *xacro, fmt::format( "<{}>", xacro->Name() ), "this is a xacro file",
		    fmt::format(
		        "run xacro first: xacro {} > robot.{}", m_path, std::strcmp( kind, "URDF" ) == 0 ? "urdf" : "srdf" ) );
	}
}

bool XmlFile::isXacro() const
{
	const tinyxml2::XMLElement* root = m_doc.RootElement();
	return root != nullptr && std::strcmp( root->Name(), "robot" ) == 0 && root->Attribute( "xmlns:xacro" ) != nullptr &&
	       findXacro( *root ) != nullptr;
}

std::string XmlFile::place( const tinyxml2::XMLElement& at, const std::string& what ) const
{
	return fmt::format( "{} (line {})", what, at.GetLineNum() );
}

void XmlFile::fail(
    const tinyxml2::XMLElement& at, const std::string& what, const std::string& problem, const std::string& remedy ) const
{
	throw Error( m_path, place( at, what ), problem, remedy );
}

std::string XmlFile::text( const tinyxml2::XMLElement& at, const std::string& what, const char* attribute ) const
{
	const char* value = at.Attribute( attribute );
	if ( value == nullptr || *value == '\0' )
	{
		fail( at, what, fmt::format( "<{}> has no {}", at.Name(), attribute ),
		    fmt::format( "add {}=\"...\" to it", attribute ) );
	}
	requireUtf8( at, what, attribute );
	return value;
}

void XmlFile::requireUtf8( const tinyxml2::XMLElement& at, const std::string& what, const char* attribute ) const
{
	const char* value = at.Attribute( attribute );
	if ( value != nullptr && !isUtf8( value ) )
	{
		fail( at, what, fmt::format( "{}=\"{}\" of <{}> is not UTF-8", attribute, value, at.Name() ),
		    "save the file as UTF-8" );
	}
}

std::vector<double> XmlFile::numbers(
    const tinyxml2::XMLElement& at, const std::string& what, const char* attribute, std::size_t count ) const
{
	std::string value = text( at, what, attribute );
	std::vector<std::string> words = splitBlanks( value );
	std::vector<double> numbers;
	for ( const std::string& word : words )
	{
		std::optional<double> number = parseNumber( word );
		if ( !number || !std::isfinite( *number ) )
		{
			fail( at, what,
			    fmt::format( "{}=\"{}\" of <{}>: \"{}\" is not {}", attribute, value, at.Name(), word,
			        number ? "finite" : "a number" ),
			    "write a finite decimal number" );
		}
		numbers.push_back( *number );
	}
	if ( count != 0 ? numbers.size() != count : numbers.empty() )
	{
		fail( at, what,
		    fmt::format( "{}=\"{}\" of <{}> has {} numbers, not {}", attribute, value, at.Name(), numbers.size(),
		        count != 0 ? std::to_string( count ) : "one or more" ),
		    "correct their number" );
	}
	return numbers;
}

SrdfDraft::SrdfDraft( const RobotModel& model )
{
	if ( !model.srdf_file.empty() )
	{
		m_file.emplace( model.srdf_file );
		m_file->requireRobot( "SRDF" );
		return;
	}
	m_fresh.InsertEndChild( m_fresh.NewDeclaration() );
	tinyxml2::XMLElement* root = m_fresh.NewElement( "robot" );
	root->SetAttribute( "name", model.name.c_str() );
	m_fresh.InsertEndChild( root );
}

std::string printed( const tinyxml2::XMLDocument& document )
{
	tinyxml2::XMLPrinter printer;
	document.Print( &printer );
	return printer.CStr();
}

} // namespace leeway::io::detail
