// SPDX-License-Identifier: BSD-3-Clause
// Small MJCF texts as robots.
#pragma once

#include "files.hpp"

#include "leeway/prepare.hpp"

#include <cmath>
#include <map>

/// Loads its text as the content of <mujoco>.
class MjcfTest : public FileTest
{
protected:
	/// Strict, so that shapes that overlap are no neighbours.
	static leeway::io::LoadOptions strict()
	{
		leeway::io::LoadOptions options;
		options.strict = true;
		return options;
	}
	leeway::io::RobotModel load( const std::string& content, const leeway::io::LoadOptions& options = strict() ) const
	{
		return leeway::io::loadRobot(
		    write( "robot.xml", "<mujoco model=\"r\">\n" + content + "</mujoco>\n" ), "", options );
	}
	void expectBad( const std::string& content, std::vector<std::string> parts ) const
	{
		parts.push_back( ".xml: " );
		expectError( [&] { load( content ); }, parts );
	}
	/// Poses of all links by name. @param values by variable; others are 0, quaternions 0 0 0 1
	static std::map<std::string, lw_transform> poses(
	    const leeway::io::RobotModel& model, const std::map<std::string, double>& values = {} )
	{
		const leeway::Robot robot = leeway::io::buildRobot( model );
		std::vector<double> q( lw_robot_variable_count( robot.get() ) );
		std::size_t used = 0;
		for ( std::uint32_t i = 0; i < q.size(); ++i )
		{
			const std::string name = leeway::io::variableName( robot.get(), i );
			const auto given = values.find( name );
			used += given != values.end() ? 1 : 0;
			const bool w = name.size() > 6 && name.compare( name.size() - 6, 6, "/rot_w" ) == 0;
			q[i] = given != values.end() ? given->second : w ? 1 : 0;
		}
		EXPECT_EQ( used, values.size() ) << "a value has no variable";
		std::vector<lw_transform> all( lw_robot_link_count( robot.get() ) );
		EXPECT_EQ( lw_robot_fk( robot.get(), q.data(), all.data() ), LW_OK );
		std::map<std::string, lw_transform> named;
		for ( std::uint32_t i = 0; i < all.size(); ++i )
		{
			named.emplace( lw_robot_link_name( robot.get(), i ), all[i] );
		}
		return named;
	}
	static std::string reason( const leeway::io::RobotModel& model, const std::string& a, const std::string& b )
	{
		for ( const leeway::io::DisabledPair& pair : model.disabled )
		{
			if ( ( pair.link1 == a && pair.link2 == b ) || ( pair.link1 == b && pair.link2 == a ) )
			{
				return pair.reason;
			}
		}
		return "checked";
	}

	static constexpr double pi = 3.14159265358979323846;
};
