// SPDX-License-Identifier: BSD-3-Clause
// Values of a YAML file: see yaml_values.hpp.
#include "motions/yaml_values.hpp"

#include "leeway/io/keys.hpp"
#include "leeway/io/limits.hpp"
#include "leeway/io/model.hpp"
#include "motions/csv.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <set>

namespace leeway::motions
{

namespace
{

/// A line that parts documents. Readers of one document pass over all that stands behind it, so other spellings than "---" alone are errors.
bool isMark( const std::string& file, std::size_t line, const std::string& text )
{
	const std::string bare = trimmed( text.substr( 0, text.find( " #" ) ) );
	const bool begins = text.compare( 0, 3, "---" ) == 0 &&
	                    ( text.size() == 3 || std::isspace( static_cast<unsigned char>( text[3] ) ) != 0 );
	if ( ( begins && bare != "---" ) || ( text.compare( 0, 3, "..." ) == 0 && bare == "..." ) )
	{
		throw io::Error( file, fmt::format( "line {}", line + 1 ),
		    fmt::format( "'{}' ends a document in a way that is not read here", bare ),
		    "write --- on a line of its own between two documents, and nothing else" );
	}
	return bare == "---";
}

} // namespace

std::vector<YAML::Node> loadYaml( const std::string& file, std::size_t* out_bytes )
{
	const std::string bytes = io::readWholeFile( file );
	*out_bytes = bytes.size();
	std::vector<YAML::Node> documents;
	std::size_t line = 0, begin_line = 0, begin = 0; // of the document
	for ( std::size_t at = 0; at <= bytes.size(); ++line )
	{
		const std::size_t end = std::min( bytes.find( '\n', at ), bytes.size() );
		const bool mark = isMark( file, line, bytes.substr( at, end - at ) ), last = end >= bytes.size();
		if ( mark || last )
		{
			// YAML::LoadAll() never returns from some malformed texts: documents are parted here
			const std::string document = bytes.substr( begin, ( mark ? at : end ) - begin );
			try
			{
				documents.push_back( YAML::Load( document ) );
				if ( io::holdsSeveralDocuments( document ) )
				{
					throw io::Error( file, fmt::format( "line {}", begin_line + 1 ),
					    "a second document begins without a line ---", "write --- between them, or give one" );
				}
				io::requireSoundDocument( file, documents.back(), document.size(), begin_line );
			}
			catch ( const YAML::Exception& error )
			{
				throw io::Error( file,
				    fmt::format( "line {}", begin_line + static_cast<std::size_t>( error.mark.line + 1 ) ),
				    "is not valid YAML: " + error.msg, "correct the file" );
			}
			begin = std::min( end + 1, bytes.size() );
			begin_line = line + 1;
		}
		at = end + 1;
	}
	documents.erase(
	    std::remove_if( documents.begin(), documents.end(), []( const YAML::Node& node ) { return node.IsNull(); } ),
	    documents.end() );
	return documents;
}

double finiteValue( const std::string& file, const YAML::Node& node, const std::string& element )
{
	double value = NAN;
	try
	{
		value = node.as<double>();
	}
	catch ( const YAML::Exception& )
	{
	}
	const std::string tag = node.IsDefined() ? node.Tag() : "",
	                  text = node.IsDefined() && node.IsScalar() ? node.Scalar() : "";
	if ( tag == "tag:yaml.org,2002:str" || tag == "tag:yaml.org,2002:binary" || tag == "tag:yaml.org,2002:null" )
	{
		throw io::Error( file, element, fmt::format( "'{}' has a tag of a text", text ), "remove the tag" );
	}
	const std::size_t digits = text.find_first_not_of( "+-" );
	if ( digits != std::string::npos && digits + 1 < text.size() && text[digits] == '0' &&
	     text.find_first_not_of( "0123456789", digits ) == std::string::npos )
	{
		throw io::Error( file, element,
		    fmt::format( "'{}' begins with 0: some readers of YAML take it for an octal number", text ),
		    "write it without the 0" );
	}
	if ( !std::isfinite( value ) )
	{
		throw io::Error( file, element, "is not a finite number", "give a finite number in radians or metres" );
	}
	if ( std::fabs( value ) > largest_number )
	{
		throw io::Error(
		    file, element, fmt::format( "{:g} is beyond {:g}", value, largest_number ), "give radians, metres or seconds" );
	}
	return value;
}

std::vector<std::string> nameList( const std::string& file, const YAML::Node& node, const std::string& element )
{
	std::vector<std::string> result;
	std::set<std::string> seen;
	if ( node.IsDefined() && node.IsSequence() ) // a key that is missing is no node at all
	{
		for ( const YAML::Node& name : node )
		{
			result.push_back( name.IsScalar() ? name.Scalar() : "" );
			if ( result.back().empty() || !seen.insert( result.back() ).second )
			{
				throw io::Error( file, element, "has an empty or repeated name", "name every joint once" );
			}
		}
	}
	if ( result.empty() )
	{
		throw io::Error( file, element, "is missing or empty", "list the joint names" );
	}
	return result;
}

std::vector<double> numberList( const std::string& file, const YAML::Node& node, const std::string& element,
    std::size_t count, const std::string& remedy )
{
	if ( !node.IsDefined() || !node.IsSequence() || node.size() != count )
	{
		throw io::Error( file, element, fmt::format( "is not a list of {} numbers", count ), remedy );
	}
	std::vector<double> numbers;
	for ( std::size_t k = 0; k < count; ++k )
	{
		numbers.push_back( finiteValue( file, node[k], fmt::format( "{}[{}]", element, k ) ) );
	}
	return numbers;
}

std::vector<std::pair<std::string, double>> jointState(
    const std::string& file, const YAML::Node& joints, const std::string& element )
{
	const std::vector<std::string> names = nameList( file, joints["name"], element + ".name" );
	const std::vector<double> positions =
	    numberList( file, joints["position"], element + ".position", names.size(), "give one position for every name" );
	std::vector<std::pair<std::string, double>> state;
	for ( std::size_t i = 0; i < names.size(); ++i )
	{
		state.emplace_back( names[i], positions[i] );
	}
	return state;
}

} // namespace leeway::motions
