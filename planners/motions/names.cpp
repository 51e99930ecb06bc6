// SPDX-License-Identifier: BSD-3-Clause
// Names that people type: which one was meant, and why a name is no column of a table.
#include "motions/names.hpp"

#include "leeway/io/keys.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

namespace leeway::motions
{
namespace
{

std::string lower( std::string text )
{
	std::transform(
	    text.begin(), text.end(), text.begin(), []( unsigned char c ) { return static_cast<char>( std::tolower( c ) ); } );
	return text;
}

} // namespace

std::vector<std::string> nearNames( const std::string& name, const std::vector<std::string>& known, std::size_t limit )
{
	std::vector<std::pair<std::size_t, std::string>> found;
	const std::string wanted = lower( name );
	for ( const std::string& candidate : known )
	{
		const std::string have = lower( candidate );
		const bool part = wanted.size() >= 3 && have.find( wanted ) != std::string::npos;
		const std::size_t distance = io::editDistance( wanted, have ), most = 1 + std::min( wanted.size(), have.size() ) / 4;
		if ( distance <= most || part )
		{
			found.emplace_back( part ? std::min( distance, most ) : distance, candidate );
		}
	}
	std::stable_sort( found.begin(), found.end(), []( const auto& a, const auto& b ) { return a.first < b.first; } );
	std::vector<std::string> names;
	for ( std::size_t i = 0; i < std::min( limit, found.size() ); ++i )
	{
		names.push_back( found[i].second );
	}
	return names;
}

std::string useOneOf( const std::string& name, const std::vector<std::string>& known )
{
	const std::vector<std::string> near = nearNames( name, known );
	return near.size() == 1 ? "use " + near[0] : "use one of " + listed( near.empty() ? known : near );
}

std::string listed( const std::vector<std::string>& names, std::size_t limit )
{
	std::string text;
	for ( std::size_t i = 0; i < std::min( limit, names.size() ); ++i )
	{
		text += ( i > 0 ? ", " : "" ) + names[i];
	}
	return names.size() > limit ? fmt::format( "{}, ... ({} in all)", text, names.size() ) : text;
}

std::string counted( std::size_t count, const std::string& noun )
{
	return fmt::format( "{} {}{}", count, noun, count == 1 ? "" : "s" );
}

std::vector<std::string> variableNames( const io::RobotModel& robot )
{
	std::vector<std::string> names;
	for ( const io::JointModel& joint : robot.joints )
	{
		const std::vector<std::string> variables = io::variableNames( joint );
		names.insert( names.end(), variables.begin(), variables.end() );
	}
	return names;
}

UnknownVariable explainUnknown( const std::string& name, const io::RobotModel& robot )
{
	for ( const io::JointModel& joint : robot.joints )
	{
		if ( name != joint.name && name.rfind( joint.name + "/", 0 ) != 0 )
		{
			continue;
		}
		const std::vector<std::string> variables = io::variableNames( joint );
		if ( !variables.empty() )
		{
			return { true, true,
			    fmt::format( "joint {} has {}", joint.name,
			        variables.size() == 1 ? "one value, which is called as the joint" : "several values" ),
			    ( variables.size() == 1 ? "name it " : "name them " ) + listed( variables ) };
		}
		if ( name == joint.name )
		{
			return { true, false, joint.mimic.empty() ? "the joint is fixed" : "the joint follows joint " + joint.mimic,
			    joint.mimic.empty() ? "leave it out" : "give " + joint.mimic };
		}
	}
	return { false, false, "the robot has no such joint", useOneOf( name, variableNames( robot ) ) };
}

} // namespace leeway::motions
