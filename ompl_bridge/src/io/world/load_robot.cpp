// SPDX-License-Identifier: BSD-3-Clause
// Robots and worlds from files, told apart by content.
#include "base/io_internal.hpp"
#include "base/xml.hpp"
#include "world/world_reader.hpp"

#include <fmt/format.h>

namespace leeway::io
{

namespace
{

/// A world as a robot: all that the file itself describes is on the robot, and the scene that it names is not.
RobotModel robotOfWorld(
    const std::string& file, const std::string& srdf_file, std::string content, const LoadOptions& options )
{
	const WorldModel world = detail::readWorld( file, std::move( content ), options, detail::Resting::links );
	RobotModel robot = world.robot;
	if ( world.scene )
	{
		robot.report.notices.push_back(
		    { file, "scene", fmt::format( "{} is no part of the robot: give it as the scene too", world.scene->file ) } );
	}
	if ( !srdf_file.empty() )
	{
		detail::readSrdf( srdf_file, options.strict, robot );
	}
	return robot;
}

} // namespace

WorldModel loadWorld( const std::string& file, const LoadOptions& options )
{
	return detail::readWorld( file, readWholeFile( file ), options, detail::Resting::scene );
}

RobotModel loadRobot( const std::string& urdf_file, const std::string& srdf_file, const LoadOptions& options )
{
	std::string content = readWholeFile( urdf_file );
	return detail::isWorld( content ) ? robotOfWorld( urdf_file, srdf_file, std::move( content ), options )
	                                  : detail::loadOneRobot( urdf_file, std::move( content ), srdf_file, options );
}

} // namespace leeway::io
