// SPDX-License-Identifier: BSD-3-Clause
// Parts of robot and scene that a checker keeps: one line for each link and obstacle.
#include "leeway/pairs/required.hpp"
#include "leeway/motions/states.hpp"
#include "pairs/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>

namespace leeway::pairs
{
namespace
{

/// True if a variable of the group moves the link.
bool groupMoves( const io::Problem& problem, std::uint32_t link )
{
	const lw_robot* robot = problem.robot.get();
	for ( std::uint32_t joint = lw_robot_link_joint( robot, link ); joint != LW_INVALID_INDEX;
	      joint = lw_robot_link_joint( robot, link ) )
	{
		const std::uint32_t leader = lw_robot_joint_mimic( robot, joint );
		const std::uint32_t variable = lw_robot_joint_variable( robot, leader == LW_INVALID_INDEX ? joint : leader );
		if ( variable != LW_INVALID_INDEX &&
		     std::find( problem.variables.begin(), problem.variables.end(), variable ) != problem.variables.end() )
		{
			return true;
		}
		link = lw_robot_joint_parent( robot, joint );
	}
	return false;
}

void add( const lw_shape* shape, RequiredLine& line )
{
	const lw_shape_info info = lw_shape_peek_info( shape );
	++line.shapes;
	line.made += info.deferred ? 0 : 1;
	line.triangles += info.triangle_count;
}

std::vector<RequiredLine> linkLines( const io::Problem& problem )
{
	const lw_robot* robot = problem.robot.get();
	std::vector<RequiredLine> lines;
	for ( std::uint32_t link = 0; link < lw_robot_link_count( robot ); ++link )
	{
		RequiredLine line;
		line.name = lw_robot_link_name( robot, link );
		for ( std::uint32_t i = 0; i < lw_robot_body_count( robot ); ++i )
		{
			const lw_body_def body = lw_robot_body( robot, i );
			if ( body.link == link )
			{
				add( body.shape, line );
			}
		}
		if ( line.shapes > 0 )
		{
			const bool moves = groupMoves( problem, link );
			line.why = moves ? "the group moves it" : "static";
			lines.push_back( line );
		}
	}
	return lines;
}

std::vector<RequiredLine> obstacleLines( const io::Problem& problem, const lw_checker_info& info )
{
	const lw_scene* scene = lw_checker_scene( problem.checker.get() );
	std::vector<RequiredLine> lines( scene != nullptr ? lw_scene_object_count( scene ) : 0 );
	std::vector<double> distance( lines.size(), HUGE_VAL );
	for ( std::uint32_t i = 0; scene != nullptr && i < lw_scene_shape_count( scene ); ++i )
	{
		const lw_scene_shape_def shape = lw_scene_shape( scene, i );
		add( shape.shape, lines[shape.object] );
		distance[shape.object] =
		    std::fmin( distance[shape.object], lw_checker_obstacle_distance( problem.checker.get(), i ) );
	}
	for ( std::uint32_t i = 0; i < lines.size(); ++i )
	{
		RequiredLine& line = lines[i];
		line.name = lw_scene_object_name( scene, i );
		line.kept = !( distance[i] >= info.horizon );
		// less margins, as everything
		line.why = line.kept && distance[i] > 0 ? fmt::format( "may come within {:.3f} m", distance[i] )
		           : line.kept                  ? "may be touched"
		           : std::isinf( distance[i] )  ? "no moving link is checked against it"
		                                        : fmt::format( "out of reach: stays {:.3f} m away", distance[i] );
	}
	return lines;
}

Modelled count( const io::Problem& problem, const io::RobotModel& robot, const io::SceneModel* scene )
{
	Modelled modelled;
	std::set<const lw_shape*> seen;
	const auto take = [&]( const lw_shape* shape )
	{
		const lw_shape_info info = lw_shape_peek_info( shape );
		if ( info.deferred )
		{
			return;
		}
		modelled.triangles += info.triangle_count;
		if ( seen.insert( shape ).second )
		{
			++modelled.shapes;
			modelled.bytes += info.bytes;
		}
	};
	for ( std::uint32_t i = 0; i < lw_robot_body_count( problem.robot.get() ); ++i )
	{
		take( lw_robot_body( problem.robot.get(), i ).shape );
	}
	const lw_scene* placed = lw_checker_scene( problem.checker.get() );
	for ( std::uint32_t i = 0; placed != nullptr && i < lw_scene_shape_count( placed ); ++i )
	{
		take( lw_scene_shape( placed, i ).shape );
	}
	for ( const io::LoadReport* report : { &robot.report, scene != nullptr ? &scene->report : nullptr } )
	{
		for ( std::size_t i = 0; report != nullptr && i < report->shapes.size(); ++i )
		{
			modelled.milliseconds += report->shapes[i].totalMilliseconds();
		}
		modelled.milliseconds += report != nullptr ? report->cache_milliseconds : 0;
	}
	return modelled;
}

std::string table( const char* title, const std::vector<RequiredLine>& lines )
{
	std::size_t width = 5;
	for ( const RequiredLine& line : lines )
	{
		width = std::max( width, line.name.size() );
	}
	std::string text;
	for ( const RequiredLine& line : lines )
	{
		fmt::format_to( std::back_inserter( text ), "  {:<8} {:<{}}  {:>9} {:<7}  {}\n", title, line.name, width,
		    line.triangles,
		    !line.kept      ? "dropped"
		    : line.made > 0 ? "kept"
		                    : "waits",
		    line.why );
	}
	return text;
}

std::string line( const char* title, const Modelled& m )
{
	return fmt::format( "  {}: {} distinct shapes, {} triangles, {} bytes, {:.1f} ms of reading and building\n", title,
	    m.shapes, m.triangles, m.bytes, m.milliseconds );
}

Json linesJson( const std::vector<RequiredLine>& lines )
{
	Json json = Json::array();
	for ( const RequiredLine& line : lines )
	{
		json.push_back( { { "name", line.name }, { "kept", line.kept }, { "why", line.why }, { "shapes", line.shapes },
		    { "made", line.made }, { "triangles", line.triangles } } );
	}
	return json;
}

Json modelledJson( const Modelled& m )
{
	return {
	    { "shapes", m.shapes }, { "triangles", m.triangles }, { "bytes", m.bytes }, { "milliseconds", m.milliseconds } };
}

} // namespace

Required findRequired( const io::Problem& problem, const io::RobotModel& robot, const io::SceneModel* scene )
{
	Required required;
	required.checker = lw_checker_get_info( problem.checker.get() );
	const Query query = makeQuery( problem.checker.get() );
	(void)motions::measure( problem.checker.get(), query.get(), io::startState( problem ), LW_CHECK_BOTH, nullptr,
	    robot.urdf_file, "reference state" );
	required.links = linkLines( problem );
	required.obstacles = obstacleLines( problem, required.checker );
	for ( const RequiredLine& obstacle : required.obstacles )
	{
		required.kept_obstacles += obstacle.kept ? 1 : 0;
	}
	required.first = count( problem, robot, scene );
	const auto complete = []( const lw_shape* shape )
	{
		lw_diag diag{};
		require( lw_shape_complete( shape, &diag ), diag );
	};
	for ( std::uint32_t i = 0; i < lw_robot_body_count( problem.robot.get() ); ++i )
	{
		complete( lw_robot_body( problem.robot.get(), i ).shape );
	}
	const lw_scene* placed = lw_checker_scene( problem.checker.get() );
	for ( std::uint32_t i = 0; placed != nullptr && i < lw_scene_shape_count( placed ); ++i )
	{
		complete( lw_scene_shape( placed, i ).shape );
	}
	required.all = count( problem, robot, scene );
	return required;
}

std::string requiredText( const io::Problem& problem, const Required& required )
{
	const double horizon = required.checker.horizon;
	const motions::Named fixed = motions::nameEnvironment( problem.checker.get(), required.checker.static_environment );
	std::string text = "required of robot and scene, for states within the limits\n";
	if ( std::isfinite( horizon ) )
	{
		text += fmt::format( "  horizon {:.3f} m: {}\n", horizon,
		    fixed.upper < horizon
		        ? fmt::format( "no state has more: static {} and {} are this close", fixed.first, fixed.second )
		        : "--max-d" );
	}
	else
	{
		text += "  no horizon: --max-d is infinite and no static link is near an obstacle\n";
	}
	text += table( "link", required.links ) + table( "obstacle", required.obstacles );
	text += fmt::format( "  {} of {} obstacles kept\n", required.kept_obstacles, required.obstacles.size() );
	text += line( "up to the first answer", required.first ) + line( "everything", required.all );
	text += "  waits: has no tree yet, and gets one when a query comes near it; dropped: no query within the limits can\n";
	return text + fmt::format( "  saved so far: {} triangles, {} bytes, {:.1f} ms\n",
	                  required.all.triangles - required.first.triangles, required.all.bytes - required.first.bytes,
	                  required.all.milliseconds - required.first.milliseconds );
}

Json requiredJson( const Required& required )
{
	return { { "horizon", std::isfinite( required.checker.horizon ) ? Json( required.checker.horizon ) : Json( nullptr ) },
	    { "kept_obstacles", required.kept_obstacles }, { "links", linesJson( required.links ) },
	    { "obstacles", linesJson( required.obstacles ) }, { "first_answer", modelledJson( required.first ) },
	    { "everything", modelledJson( required.all ) } };
}

} // namespace leeway::pairs
