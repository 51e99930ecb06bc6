// SPDX-License-Identifier: BSD-3-Clause
// Rows and their origin as files: see result.hpp.
#include "support/result.hpp"

#include "support/provenance.hpp"

#include <algorithm>
#include <sstream>
#include <utility>
#include <vector>

Result::Result( const std::string& command )
    : m_json( { { "command", command }, { "provenance", provenance() }, { "rows", Json::array() } } )
{
}

void Result::add( Json row )
{
	m_json["rows"].push_back( std::move( row ) );
}

std::string Result::origin() const
{
	const Json& p = m_json.at( "provenance" );
	const auto word = [&p]( const char* key ) { return p.at( key ).get<std::string>(); };
	return word( "processor" ) + ", " + word( "compiler" ) + ", leeway at " + word( "simd" ) + ", commit " +
	       word( "commit" ) + ( p.at( "dirty" ).get<bool>() ? " (changed)" : "" );
}

void Result::writeJson( const std::string& file ) const
{
	if ( file.empty() )
	{
		return;
	}
	// rows last and one a line, so that two files differ by lines
	std::string text = "{\n";
	for ( const auto& [name, value] : m_json.items() )
	{
		if ( name != "rows" )
		{
			text += Json( name ).dump() + ": " + value.dump() + ",\n";
		}
	}
	text += "\"rows\": [";
	for ( std::size_t i = 0; i < rows().size(); ++i )
	{
		text += ( i > 0 ? ",\n" : "\n" ) + rows()[i].dump();
	}
	writeFile( file, text + "\n]}\n" );
}

namespace
{

using Fields = std::vector<std::pair<std::string, std::string>>;

std::string quoted( const std::string& word )
{
	if ( word.find_first_of( ",\"\n" ) == std::string::npos )
	{
		return word;
	}
	std::string out = "\"";
	for ( const char c : word )
	{
		out += c == '"' ? "\"\"" : std::string( 1, c );
	}
	return out + '"';
}

void flatten( const Json& row, const std::string& prefix, Fields& fields )
{
	for ( const auto& [name, value] : row.items() )
	{
		if ( value.is_object() )
		{
			flatten( value, prefix + name + ".", fields );
		}
		else if ( !value.is_array() )
		{
			fields.emplace_back( prefix + name, value.is_string() ? quoted( value.get<std::string>() ) : value.dump() );
		}
	}
}

} // namespace

std::string Result::csv() const
{
	std::vector<std::string> columns;
	std::vector<Fields> table;
	for ( const Json& row : rows() )
	{
		flatten( row, "", table.emplace_back() );
		for ( const auto& [name, value] : table.back() )
		{
			if ( std::find( columns.begin(), columns.end(), name ) == columns.end() )
			{
				columns.push_back( name );
			}
		}
	}
	std::ostringstream out;
	const auto line = [&]( const auto& cell )
	{
		for ( std::size_t i = 0; i < columns.size(); ++i )
		{
			out << ( i > 0 ? "," : "" ) << cell( columns[i] );
		}
		out << '\n';
	};
	line( []( const std::string& name ) { return quoted( name ); } );
	for ( const Fields& fields : table )
	{
		line(
		    [&fields]( const std::string& name )
		    {
			    const auto found =
			        std::find_if( fields.begin(), fields.end(), [&]( const auto& field ) { return field.first == name; } );
			    return found == fields.end() ? std::string() : found->second;
		    } );
	}
	return out.str();
}

void Result::writeCsv( const std::string& file ) const
{
	if ( !file.empty() )
	{
		writeFile( file, csv() );
	}
}
