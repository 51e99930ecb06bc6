// SPDX-License-Identifier: BSD-3-Clause
// An MJCF model as one tree of elements: included files stand in the place of <include>.
#include "mjcf/document.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fmt/format.h>

namespace leeway::io::detail::mjcf
{

Document::Document( std::unique_ptr<XmlFile> main ) : m_main( std::move( main ) )
{
	m_files.emplace( &m_main->document(), m_main.get() );
	m_paths.insert( std::filesystem::path( m_main->path() ).lexically_normal().string() );
	include( root(), 0 );
}

/// Reads the files that elements below `parent` include.
void Document::include( const XMLElement& parent, std::size_t depth )
{
	checkLimit( &Limits::nesting, depth, "levels of elements", fileOf( parent ).path(),
	    fileOf( parent ).place( parent, "nesting" ) );
	for ( const XMLElement& child : detail::children( parent, nullptr ) )
	{
		if ( std::strcmp( child.Name(), "include" ) != 0 )
		{
			include( child, depth + 1 );
			continue;
		}
		const std::string name = text( child, "include", "file" );
		// relative to the main file, also in a file that is itself included
		const std::filesystem::path path =
		    ( std::filesystem::path( m_main->path() ).parent_path() / name ).lexically_normal();
		if ( !m_paths.insert( path.string() ).second )
		{
			fail( child, "include " + name, "the file is included twice, or includes itself", "include each file once" );
		}
		std::unique_ptr<XmlFile> file;
		try
		{
			file = std::make_unique<XmlFile>( path.string(), readFile( path.string() ) );
		}
		catch ( const Error& e )
		{
			const std::string problem = e.element().empty() ? e.problem() : e.element() + ": " + e.problem();
			fail( child, "include " + name, fmt::format( "{}: {}", e.file(), problem ), e.remedy() );
		}
		const XmlFile& added = *m_included.emplace( &child, std::move( file ) ).first->second;
		if ( added.document().RootElement() == nullptr )
		{
			fail( child, "include " + name, "the file has no element", "include a file with an element around its content" );
		}
		m_files.emplace( &added.document(), &added );
		include( added.root(), depth + 1 );
	}
}

const XmlFile& Document::fileOf( const XMLElement& at ) const
{
	return *m_files.at( at.GetDocument() );
}

void Document::append( const XMLElement& parent, const char* name, std::vector<const XMLElement*>& out ) const
{
	for ( const XMLElement& child : detail::children( parent, nullptr ) )
	{
		const auto file = m_included.find( &child );
		if ( file != m_included.end() )
		{
			append( file->second->root(), name, out );
		}
		else if ( name == nullptr || std::strcmp( child.Name(), name ) == 0 )
		{
			out.push_back( &child );
		}
	}
}

std::vector<const XMLElement*> Document::children( const XMLElement& parent, const char* name ) const
{
	std::vector<const XMLElement*> out;
	append( parent, name, out );
	return out;
}

std::vector<const XMLElement*> Document::inSections( const char* section, const char* name ) const
{
	std::vector<const XMLElement*> out;
	for ( const XMLElement* part : children( root(), section ) )
	{
		append( *part, name, out );
	}
	return out;
}

void Document::fail(
    const XMLElement& at, const std::string& what, const std::string& problem, const std::string& remedy ) const
{
	fileOf( at ).fail( at, what, problem, remedy );
}

Notice Document::notice( const XMLElement& at, const std::string& what, const std::string& text ) const
{
	return { fileOf( at ).path(), fileOf( at ).place( at, what ), text };
}

ShapeLoader::Place Document::place( const XMLElement& at, const std::string& what, const std::string& owner ) const
{
	return { fileOf( at ).path(), fileOf( at ).place( at, what ), owner };
}

std::string Document::text( const XMLElement& at, const std::string& what, const char* attribute ) const
{
	return fileOf( at ).text( at, what, attribute );
}

std::string Document::optionalText( const XMLElement& at, const std::string& what, const char* attribute ) const
{
	const char* value = at.Attribute( attribute );
	fileOf( at ).requireUtf8( at, what, attribute );
	return value != nullptr ? value : "";
}

std::vector<double> Document::numbers(
    const XMLElement& at, const std::string& what, const char* attribute, std::size_t least, std::size_t most ) const
{
	std::vector<double> values = fileOf( at ).numbers( at, what, attribute, least == most ? least : 0 );
	if ( values.size() < least || values.size() > most )
	{
		fail( at, what,
		    fmt::format( "{}=\"{}\" of <{}> has {} numbers, not {} to {}", attribute, at.Attribute( attribute ), at.Name(),
		        values.size(), least, most ),
		    "correct their number" );
	}
	return values;
}

std::vector<double> Document::range( const XMLElement& at, const std::string& what ) const
{
	std::vector<double> ends;
	for ( const std::string& word : splitBlanks( text( at, what, "range" ) ) )
	{
		const std::optional<double> number = parseNumber( word );
		if ( !number || std::isnan( *number ) )
		{
			return numbers( at, what, "range", 2, 2 ); // which says why not
		}
		ends.push_back( *number );
	}
	return ends.size() == 2 ? ends : numbers( at, what, "range", 2, 2 );
}

std::string Document::word(
    const XMLElement& at, const std::string& what, const char* attribute, const std::vector<std::string>& words ) const
{
	const std::string value = text( at, what, attribute );
	if ( std::find( words.begin(), words.end(), value ) == words.end() )
	{
		fail( at, what, fmt::format( "{}=\"{}\" of <{}> is not known", attribute, value, at.Name() ),
		    "use one of " + joinNames( words ) );
	}
	return value;
}

std::int64_t Document::integer( const XMLElement& at, const std::string& what, const char* attribute ) const
{
	const double value = fileOf( at ).numbers( at, what, attribute, 1 )[0];
	if ( value != std::floor( value ) || std::fabs( value ) > 4294967295.0 )
	{
		fail( at, what,
		    fmt::format(
		        "{}=\"{}\" of <{}> is no whole number of 32 bits", attribute, at.Attribute( attribute ), at.Name() ),
		    "write a whole number" );
	}
	return static_cast<std::int64_t>( value );
}

} // namespace leeway::io::detail::mjcf
