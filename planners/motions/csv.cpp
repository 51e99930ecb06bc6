// SPDX-License-Identifier: BSD-3-Clause
// Comma-separated tables: strict about numbers, lenient about white space.
#include "motions/csv.hpp"

#include "motions/names.hpp"

#include "leeway/io/limits.hpp"
#include "leeway/io/model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <set>
#include <sstream>

namespace leeway::motions
{
namespace
{

// One line of cells. Quoted cells may contain commas and doubled quotes, not line ends.
std::vector<std::string> split( const std::string& file, std::size_t line, const std::string& text )
{
	std::vector<std::string> cells;
	std::string cell;
	bool quoted = false, was_quoted = false;
	for ( std::size_t i = 0; i < text.size(); ++i )
	{
		const char c = text[i];
		if ( quoted && c == '"' && i + 1 < text.size() && text[i + 1] == '"' )
		{
			cell += text[++i];
		}
		else if ( c == '"' && ( quoted || trimmed( cell ).empty() ) )
		{
			cell = quoted ? cell : "";
			quoted = !quoted;
			was_quoted = true;
		}
		else if ( c == ',' && !quoted )
		{
			cells.push_back( was_quoted ? cell : trimmed( cell ) );
			cell.clear();
			was_quoted = false;
		}
		else if ( quoted || !was_quoted )
		{
			cell += c;
		}
	}
	if ( quoted )
	{
		throw io::Error(
		    file, fmt::format( "line {}", line ), "a quoted cell does not end", "close the quote on the same line" );
	}
	cells.push_back( was_quoted ? cell : trimmed( cell ) );
	return cells;
}

void checkHeader( const CsvTable& table, std::size_t line )
{
	std::set<std::string> seen;
	for ( const std::string& name : table.header )
	{
		if ( name.empty() )
		{
			throw io::Error( table.file, fmt::format( "line {}", line ), "a column of the header has no name",
			    "name every column, or remove the extra comma" );
		}
		if ( !seen.insert( name ).second )
		{
			throw io::Error(
			    table.file, fmt::format( "column '{}'", name ), "appears twice in the header", "keep one of them" );
		}
	}
}

} // namespace

std::string trimmed( const std::string& text )
{
	const char* blanks = " \t\r\n";
	const std::size_t first = text.find_first_not_of( blanks );
	return first == std::string::npos ? "" : text.substr( first, text.find_last_not_of( blanks ) - first + 1 );
}

std::optional<double> finiteNumber( const std::string& text )
{
	char* end = nullptr;
	const double number = std::strtod( text.c_str(), &end );
	// strtod also takes hexadecimal, "inf" and "nan"; none is a joint value.
	const bool decimal =
	    !text.empty() && end == text.c_str() + text.size() && text.find_first_of( "xX" ) == std::string::npos;
	return decimal && std::isfinite( number ) ? std::optional<double>( number ) : std::nullopt;
}

CsvTable readCsv( const std::string& name )
{
	const bool standard_input = name == "-";
	const std::string file = standard_input ? "standard input" : name;
	const std::string bytes = io::readWholeFile( standard_input ? "/dev/stdin" : name );
	if ( const std::size_t zero = bytes.find( '\0' ); zero != std::string::npos )
	{
		const auto end = bytes.begin() + static_cast<std::ptrdiff_t>( zero );
		throw io::Error( file, fmt::format( "line {}", 1 + std::count( bytes.begin(), end, '\n' ) ),
		    "has a byte 0: this is no text", "give a table of comma-separated values" );
	}
	std::istringstream stream( bytes );
	CsvTable table;
	table.file = file;
	std::string text;
	for ( std::size_t line = 1; std::getline( stream, text ); ++line )
	{
		if ( line == 1 && text.rfind( "\xef\xbb\xbf", 0 ) == 0 )
		{
			text.erase( 0, 3 );
		}
		const std::string bare = trimmed( text );
		if ( bare.empty() || bare[0] == '#' )
		{
			continue;
		}
		std::vector<std::string> cells = split( file, line, bare );
		if ( table.header.empty() )
		{
			table.header = std::move( cells );
			checkHeader( table, line );
			continue;
		}
		if ( cells.size() != table.header.size() )
		{
			throw io::Error( file, fmt::format( "line {}", line ),
			    fmt::format( "has {} where the header has {}", counted( cells.size(), "cell" ),
			        counted( table.header.size(), "column" ) ),
			    "give one value for every column" );
		}
		table.rows.push_back( { line, std::move( cells ) } );
	}
	if ( table.header.empty() )
	{
		throw io::Error( file, "table", "is empty", "give a header line of column names, then one line per row" );
	}
	return table;
}

double CsvTable::value( std::size_t row, std::size_t column ) const
{
	const std::string& cell = rows[row].cells[column];
	const std::optional<double> number = finiteNumber( cell );
	if ( !number )
	{
		throw io::Error( file, fmt::format( "line {}, column '{}'", rows[row].line, header[column] ),
		    cell.empty() ? "the value is missing" : fmt::format( "'{}' is not a finite number", cell ),
		    "give a finite number in radians or metres" );
	}
	if ( std::fabs( *number ) > largest_number )
	{
		throw io::Error( file, fmt::format( "line {}, column '{}'", rows[row].line, header[column] ),
		    fmt::format( "{:g} is beyond {:g}", *number, largest_number ), "give radians, metres or seconds" );
	}
	return *number;
}

std::string csvCell( const std::string& text )
{
	if ( text.find_first_of( ",\"\n\r" ) == std::string::npos && trimmed( text ) == text )
	{
		return text;
	}
	std::string quoted = "\"";
	for ( char c : text )
	{
		quoted += c == '"' ? "\"\"" : std::string( 1, c );
	}
	return quoted + "\"";
}

} // namespace leeway::motions
