// SPDX-License-Identifier: BSD-3-Clause
// Errors of the readers, and the text handling that all of them use.
#include "io_internal.hpp"

#include <charconv>
#include <limits>
#include <sstream>
#include <system_error>

namespace leeway::io
{

namespace
{

/// "<file>: <element>: <problem>; <remedy>" with empty parts left out and line breaks made blanks.
std::string oneLine(
    const std::string& file, const std::string& element, const std::string& problem, const std::string& remedy )
{
	std::string line;
	for ( const std::string* part : { &file, &element } )
	{
		if ( !part->empty() )
		{
			line += *part + ": ";
		}
	}
	line += problem;
	if ( !remedy.empty() )
	{
		line += "; " + remedy;
	}
	for ( char& c : line )
	{
		c = c == '\n' || c == '\r' ? ' ' : c;
	}
	return line;
}

} // namespace

Error::Error( std::string file, std::string element, std::string problem, std::string remedy )
    : std::runtime_error( oneLine( file, element, problem, remedy ) ), m_file( std::move( file ) ),
      m_element( std::move( element ) ), m_problem( std::move( problem ) ), m_remedy( std::move( remedy ) )
{
}

const Group* RobotModel::findGroup( const std::string& group ) const
{
	for ( const Group& candidate : groups )
	{
		if ( candidate.name == group )
		{
			return &candidate;
		}
	}
	return nullptr;
}

namespace detail
{

std::string readFile( const std::string& file )
{
	return readWholeFile( file );
}

std::optional<double> parseNumber( std::string_view text )
{
	const std::string_view blanks = " \t\r\n";
	std::size_t first = text.find_first_not_of( blanks );
	if ( first == std::string_view::npos )
	{
		return std::nullopt;
	}
	text = text.substr( first, text.find_last_not_of( blanks ) - first + 1 );
	if ( text.size() > 1 && text[0] == '+' && text[1] != '-' && text[1] != '+' )
	{
		text.remove_prefix( 1 ); // from_chars takes no plus sign
	}
	double value = 0;
	auto [end, error] = std::from_chars( text.data(), text.data() + text.size(), value );
	if ( end != text.data() + text.size() )
	{
		return std::nullopt;
	}
	if ( error == std::errc::result_out_of_range )
	{
		// Too large for a double is not finite; too small is zero. Both leave `value` alone.
		bool small = text.find( "e-" ) != std::string_view::npos || text.find( "E-" ) != std::string_view::npos;
		return small ? 0.0 : std::numeric_limits<double>::infinity();
	}
	return error == std::errc() ? std::optional<double>( value ) : std::nullopt;
}

std::vector<std::string> splitBlanks( std::string_view text )
{
	std::istringstream stream{ std::string( text ) };
	std::vector<std::string> words;
	for ( std::string word; stream >> word; )
	{
		words.push_back( word );
	}
	return words;
}

std::string joinNames( const std::vector<std::string>& names, std::size_t limit )
{
	std::string text;
	for ( std::size_t i = 0; i < names.size() && i < limit; ++i )
	{
		text += ( i > 0 ? ", " : "" ) + names[i];
	}
	if ( names.size() > limit )
	{
		text += ", ... (" + std::to_string( names.size() ) + " in all)";
	}
	return names.empty() ? "none" : text;
}

} // namespace detail
} // namespace leeway::io
