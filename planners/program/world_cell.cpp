// SPDX-License-Identifier: BSD-3-Clause
// See world_cell.hpp.
#include "program/world_cell.hpp"

#include "motions/names.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace leeway::cli
{
namespace
{

/// Motions of the command line, PART=FILE, in the place of those of the world file.
void takeMotions( const std::vector<std::string>& motions, io::WorldModel& world )
{
	std::vector<std::string> robots;
	for ( const io::WorldPart& part : world.parts )
	{
		if ( part.kind == io::WorldPart::Kind::robot )
		{
			robots.push_back( part.name );
		}
	}
	for ( const std::string& text : motions )
	{
		const std::size_t equals = text.find( '=' );
		const std::string name = text.substr( 0, equals );
		if ( equals == std::string::npos || std::find( robots.begin(), robots.end(), name ) == robots.end() )
		{
			throw io::Error( "command line", "--motion " + text, fmt::format( "'{}' is no robot of the world", name ),
			    "write ROBOT=FILE; " + useOneOf( name, robots ) );
		}
		for ( io::WorldPart& part : world.parts )
		{
			if ( part.name == name )
			{
				part.motion_file = text.substr( equals + 1 );
				part.motion_start = 0;
				readsFile( "--motion", part.motion_file );
			}
		}
	}
}

Input inputOf( const WorldOptions& options, Notices& notices, const std::set<std::string>& focus )
{
	Input input = loadInput( options.common, notices );
	takeMotions( options.motions, *input.world );
	for ( std::size_t i = 0; !focus.empty() && i < input.robot.links.size(); ++i )
	{
		for ( std::size_t k = 0; k < i; ++k )
		{
			const std::string &a = input.robot.links[i].name, &b = input.robot.links[k].name;
			if ( focus.count( ownerOf( a ) ) + focus.count( ownerOf( b ) ) == 0 )
			{
				input.allowed.emplace_back( a, b );
			}
		}
		for ( std::size_t k = 0; input.scene && k < input.scene->objects.size(); ++k )
		{
			if ( focus.count( ownerOf( input.robot.links[i].name ) ) == 0 )
			{
				input.allowed.emplace_back( input.robot.links[i].name, input.scene->objects[k].name );
			}
		}
	}
	return input;
}

} // namespace

std::string ownerOf( const std::string& link )
{
	return link.substr( 0, link.find( '/' ) );
}

Cell::Cell( const WorldOptions& options, Notices& notices, const std::set<std::string>& focus )
    : m_input( inputOf( options, notices, focus ) ), m_bench( m_input, "", m_input.world->state().values, notices )
{
}

} // namespace leeway::cli
