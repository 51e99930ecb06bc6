// SPDX-License-Identifier: BSD-3-Clause
// Errors and reports of the readers, and the text handling that all of them use.
#include "base/io_internal.hpp"
#include "leeway/io/printable.hpp"

#include <algorithm>
#include <charconv>
#include <fmt/format.h>
#include <iterator>
#include <limits>
#include <sstream>
#include <system_error>

namespace leeway::io
{

namespace
{

/// Bytes of the UTF-8 character that `text` begins with; 0 if it begins with none. (RFC 3629: no longer form than needed, no
/// surrogates, nothing above U+10FFFF.)
std::size_t characterBytes( std::string_view text )
{
	const auto at = [&]( std::size_t i ) { return i < text.size() ? static_cast<unsigned char>( text[i] ) : 0u; };
	const unsigned first = at( 0 );
	if ( first < 0x80 )
	{
		return 1;
	}
	const std::size_t count = first >= 0xc2 && first <= 0xdf   ? 2
	                          : ( first & 0xf0u ) == 0xe0      ? 3
	                          : first >= 0xf0 && first <= 0xf4 ? 4
	                                                           : 0;
	for ( std::size_t i = 1; i < count; ++i )
	{
		if ( ( at( i ) & 0xc0u ) != 0x80 )
		{
			return 0;
		}
	}
	const unsigned second = at( 1 );
	const bool wrong = ( first == 0xe0 && second < 0xa0 ) || ( first == 0xed && second > 0x9f ) ||
	                   ( first == 0xf0 && second < 0x90 ) || ( first == 0xf4 && second > 0x8f );
	return wrong ? 0 : count;
}

} // namespace

std::string printable( const std::string& text )
{
	std::string out;
	for ( std::size_t i = 0; i < text.size(); )
	{
		const std::size_t count = characterBytes( std::string_view( text ).substr( i ) );
		const unsigned char c = static_cast<unsigned char>( text[i] );
		const bool blank = c == '\n' || c == '\r' || c == '\t';
		const bool high = count == 2 && c == 0xc2 && static_cast<unsigned char>( text[i + 1] ) < 0xa0; // U+0080 to U+009F
		const bool bytes = count == 0 || ( c < 0x20 && !blank ) || c == 0x7f || high;
		out += blank ? " " : bytes ? fmt::format( "\\x{:02x}", c ) : text.substr( i, count );
		i += high ? 1 : std::max<std::size_t>( count, 1 );
	}
	return out;
}

namespace
{

/// Names of files and elements come from files: one of a million letters is told by its ends.
std::string shortened( const std::string& part )
{
	constexpr std::size_t longest = 600, first = 360, last = 120;
	return part.size() <= longest ? part
	                              : fmt::format( "{} ... ({} letters) ... {}", part.substr( 0, first ), part.size(),
	                                    part.substr( part.size() - last ) );
}

/// "<file>: <element>: <problem>; <remedy>" with empty parts left out, printable.
std::string oneLine(
    const std::string& file, const std::string& element, const std::string& problem, const std::string& remedy )
{
	std::string line;
	for ( const std::string* part : { &file, &element } )
	{
		if ( !part->empty() )
		{
			line += shortened( *part ) + ": ";
		}
	}
	line += shortened( problem );
	if ( !remedy.empty() )
	{
		line += "; " + shortened( remedy );
	}
	return printable( line );
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

namespace
{

/// Of groups without a defect.
std::string usableGroups( const RobotModel& model )
{
	std::vector<std::string> names;
	for ( const Group& group : model.groups )
	{
		if ( group.defect.empty() )
		{
			names.push_back( group.name );
		}
	}
	return detail::joinNames( names );
}

void addMissing( const std::vector<std::string>& names, std::vector<std::string>& to )
{
	std::copy_if( names.begin(), names.end(), std::back_inserter( to ),
	    [&]( const std::string& name ) { return std::find( to.begin(), to.end(), name ) == to.end(); } );
}

} // namespace

Group RobotModel::useGroup( const std::string& group ) const
{
	const Group* found = findGroup( group );
	const std::size_t plus = group.find( '+' );
	if ( found == nullptr && plus != std::string::npos )
	{
		Group all = useGroup( group.substr( 0, plus ) );
		const Group rest = useGroup( group.substr( plus + 1 ) );
		all.name = group;
		addMissing( rest.joints, all.joints );
		addMissing( rest.links, all.links );
		return all;
	}
	if ( found == nullptr )
	{
		throw Error( srdf_file.empty() ? urdf_file : srdf_file, "group " + group, "there is no such group",
		    groups.empty() && srdf_file.empty() ? "give an SRDF that defines it, or name no group: then all joints can move"
		                                        : "use one of " + usableGroups( *this ) );
	}
	if ( !found->defect.empty() )
	{
		throw Error( srdf_file.empty() ? urdf_file : srdf_file, "group " + group, "cannot be used: " + found->defect,
		    "correct the SRDF, or use one of " + usableGroups( *this ) );
	}
	return *found;
}

const GroupState& RobotModel::useGroupState( const std::string& group, const std::string& state ) const
{
	const std::string& file = srdf_file.empty() ? urdf_file : srdf_file;
	const GroupState* found = nullptr;
	std::vector<std::string> names;
	for ( const GroupState& candidate : group_states )
	{
		const bool of_group = group.empty() || candidate.group == group;
		names.push_back( candidate.name + " of group " + candidate.group );
		if ( !of_group || candidate.name != state )
		{
			continue;
		}
		if ( found != nullptr )
		{
			throw Error( file, "group_state " + state,
			    fmt::format( "groups {} and {} have a state of this name", found->group, candidate.group ),
			    "name the group" );
		}
		found = &candidate;
	}
	if ( found == nullptr )
	{
		throw Error( file, "group_state " + state,
		    group.empty() ? "there is no such state" : fmt::format( "group {} has no such state", group ),
		    names.empty() ? "give an SRDF that defines it" : "use one of " + detail::joinNames( names ) );
	}
	if ( !found->defect.empty() )
	{
		throw Error(
		    file, "group_state " + state, "cannot be used: " + found->defect, "correct the SRDF, or use another state" );
	}
	return *found;
}

namespace detail
{

void append( const LoadReport& report, LoadReport& out )
{
	out.shapes.insert( out.shapes.end(), report.shapes.begin(), report.shapes.end() );
	out.links_without_geometry.insert(
	    out.links_without_geometry.end(), report.links_without_geometry.begin(), report.links_without_geometry.end() );
	out.notices.insert( out.notices.end(), report.notices.begin(), report.notices.end() );
	out.cache_milliseconds += report.cache_milliseconds;
}

bool isUtf8( std::string_view text )
{
	while ( !text.empty() )
	{
		const std::size_t count = characterBytes( text );
		if ( count == 0 )
		{
			return false;
		}
		text.remove_prefix( count );
	}
	return true;
}

std::string lower( std::string text )
{
	std::transform( text.begin(), text.end(), text.begin(), []( unsigned char c ) { return std::tolower( c ); } );
	return text;
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
