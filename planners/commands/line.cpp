// SPDX-License-Identifier: BSD-3-Clause
// leeway plan --line, or with a request that has waypoints: a frame goes along lines and arcs.
#include "leeway/lines/lines.hpp"
#include "commands/driven_plan.hpp"
#include "commands/limits_file.hpp"
#include "motions/csv.hpp"
#include "motions/json.hpp"
#include "program/ends.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace leeway::cli
{
namespace
{

[[noreturn]] void wrong( const std::string& option, const std::string& problem, const std::string& remedy )
{
	throw io::Error( "command line", option, problem, remedy );
}

/// As many numbers as one of two counts.
std::vector<double> numbersOf( const std::string& option, const std::string& text, std::size_t few, std::size_t many )
{
	std::vector<double> numbers = cli::numbersOf( option, text, "give numbers" );
	if ( numbers.size() != few && numbers.size() != many )
	{
		wrong( option, fmt::format( "has {} numbers", numbers.size() ),
		    few == many ? fmt::format( "give {}", few ) : fmt::format( "give {} or {}", few, many ) );
	}
	return numbers;
}

lw_transform poseOf( const std::string& option, const std::vector<double>& numbers )
{
	const std::array<double, 4> none = { 0, 0, 0, 1 };
	const std::array<double, 4> turn = numbers.size() > 3 ? unitQuaternion( option, &numbers[3] ) : none;
	lw_transform pose;
	require( lw_transform_from_quaternion( numbers.data(), turn.data(), &pose ), option.c_str() );
	return pose;
}

/// Options that ask for another kind of plan.
void refuseOthers( const PlanOptions& options )
{
	const std::pair<const char*, bool> others[] = { { "--goal", !options.goal.empty() },
	    { "--goal-pose", !options.goal_poses.empty() }, { "--planner", !options.planner.empty() },
	    { "--optimize", options.optimize > 0 }, { "--clearance-goal", options.clearance_goal > 0 } };
	for ( const auto& [name, given] : others )
	{
		if ( given )
		{
			wrong( name, "stands beside --line", "give one of them" );
		}
	}
	if ( !options.out.empty() )
	{
		wrong( "--out", "stands beside --line, whose motion has no straight edges", "give --trajectory FILE" );
	}
	requirePositive( "--line-tolerance", options.line.tolerance );
	requirePositive( "--line-angle", options.line.angle );
	if ( !( options.line.blend >= 0 && std::isfinite( options.line.blend ) ) )
	{
		wrong( "--line-blend", "is no radius", "give metres, 0 or more" );
	}
	if ( !( options.line.speed > 0 ) )
	{
		wrong( "--line-speed", "is no speed above 0", "give metres per second" );
	}
}

void refuseBoth( const PlanOptions& options, const io::PathConstraints& path )
{
	if ( path.way && ( !options.line.poses.empty() || !options.line.frame.empty() ) )
	{
		wrong( options.line.poses.empty() ? "--line-frame" : "--line", "stands beside a request that has waypoints",
		    "give one of them" );
	}
	if ( !path.empty() )
	{
		wrong( "--line", "stands beside a request with path_constraints", "remove it, or the request's path_constraints" );
	}
}

/// Where the tip is in the base at the start state: the orientation of poses without one.
lw_transform startPose( const io::Problem& problem, const lines::Task& task )
{
	std::vector<lw_transform> links( lw_robot_link_count( problem.robot.get() ) );
	const std::vector<double> full = fullState( problem, io::startState( problem ) );
	require( lw_robot_fk( problem.robot.get(), full.data(), links.data() ), "kinematics of the start state" );
	const auto world = [&]( const io::Frame& frame )
	{ return frame.link == LW_INVALID_INDEX ? frame.pose : lw_transform_multiply( &links[frame.link], &frame.pose ); };
	const lw_transform base = world( task.base ), tip = world( task.tip ), back = lw_transform_inverse( &base );
	return lw_transform_multiply( &back, &tip );
}

/// @param text of a pose: numbers, then " via X,Y,Z" or " blend R" @param radius of the blend, if the text has one
lines::Waypoint waypointOf(
    const std::string& option, std::string text, const lw_transform& before, std::optional<double>& radius )
{
	const std::size_t blend = text.find( " blend " );
	if ( blend != std::string::npos )
	{
		radius = numbersOf( option, text.substr( blend + 7 ), 1, 1 ).front();
		text.resize( blend );
	}
	const std::size_t via = text.find( " via " );
	const std::vector<double> numbers = numbersOf( option, text.substr( 0, via ), 3, 7 );
	lines::Waypoint waypoint = { numbers.size() == 7 ? poseOf( option, numbers ) : before };
	std::copy_n( numbers.begin(), 3, waypoint.pose.t );
	if ( via != std::string::npos )
	{
		const std::vector<double> place = numbersOf( option, text.substr( via + 5 ), 3, 3 );
		waypoint.via = lw_vec3{ place[0], place[1], place[2] };
	}
	return waypoint;
}

/// --line-blend: of corners between two lines whose own text has no radius.
void blendCorners( double radius, const std::vector<std::optional<double>>& own, lines::Task& task )
{
	for ( std::size_t i = 0; i < own.size(); ++i )
	{
		const bool inner = i + 1 < own.size() && ( i > 0 || !task.any_start );
		const bool lines = inner && !task.waypoints[i].via && !task.waypoints[i + 1].via;
		task.waypoints[i].blend = own[i].value_or( lines ? radius : 0 );
	}
}

/// Where a link and a frame are named.
struct NamedIn
{
	std::string file, link, frame;
};

void setFrames( const std::string& link, const std::string& frame, const NamedIn& in, const std::string& tip_text,
    const io::Problem& problem, lines::Task& task )
{
	task.tip = io::findFrame( problem, link, in.file, in.link );
	const lw_transform tip =
	    tip_text.empty() ? lw_transform_identity() : poseOf( "--line-tip", numbersOf( "--line-tip", tip_text, 3, 7 ) );
	task.tip.pose = lw_transform_multiply( &task.tip.pose, &tip );
	task.base = io::findFrame( problem, frame, in.file, in.frame );
}

/// @param way of the request, in place of the options' poses; null: none
/// @param request its file, for errors
lines::Task taskOf(
    const LineOptions& line, const io::Problem& problem, const io::CartesianWay* way, const std::string& request )
{
	lines::Task task;
	std::string link;
	std::vector<std::optional<double>> radii;
	if ( way != nullptr )
	{
		setFrames( way->link, way->frame, { request, "link_name", "header.frame_id" }, line.tip, problem, task );
		for ( const lw_transform& pose : way->poses )
		{
			task.waypoints.push_back( { pose } );
			radii.emplace_back();
		}
	}
	for ( const std::string& text : line.poses )
	{
		const std::string option = "--line " + text;
		const std::size_t equals = text.rfind( '=' );
		const std::string name = equals == std::string::npos ? std::string() : trimmed( text.substr( 0, equals ) );
		if ( name.empty() || ( !link.empty() && name != link ) )
		{
			wrong( option, name.empty() ? "names no link" : "names another link than " + link,
			    "write LINK=X,Y,Z or LINK=X,Y,Z,QX,QY,QZ,QW, with one link for all" );
		}
		if ( link.empty() )
		{
			link = name;
			setFrames( link, line.frame, { "command line", option, "--line-frame" }, line.tip, problem, task );
		}
		const lw_transform before = task.waypoints.empty() ? startPose( problem, task ) : task.waypoints.back().pose;
		radii.emplace_back();
		task.waypoints.push_back( waypointOf( option, text.substr( equals + 1 ), before, radii.back() ) );
	}
	if ( !line.free_axis.empty() )
	{
		const std::vector<double> axis = numbersOf( "--free-axis", line.free_axis, 3, 3 );
		task.free_axis = lw_vec3{ axis[0], axis[1], axis[2] };
	}
	task.any_start = line.any_start;
	blendCorners( line.blend, radii, task );
	task.tolerance = line.tolerance;
	task.angle = line.angle;
	task.speed = way != nullptr && way->speed > 0 ? std::min( way->speed, line.speed ) : line.speed;
	return task;
}

const char* nameOf( lines::Obstacle obstacle )
{
	static const char* const names[] = { "none", "unreachable", "joint limit", "singularity", "collision", "undecided" };
	return names[static_cast<int>( obstacle )];
}

std::string reportOf( const lines::Result& line, double seconds )
{
	Json json = { { "solved", line.solved }, { "attempts", line.attempts }, { "seconds", seconds } };
	if ( line.solved )
	{
		json["duration"] = line.parts.back().begin + line.parts.back().seconds;
		json["position_error"] = line.position_error;
		json["angle_error"] = line.angle_error;
		json["cubics"] = line.segments.size();
		json["parts"] = Json::array();
		for ( const lines::Part& part : line.parts )
		{
			json["parts"].push_back(
			    { { "part", part.part }, { "begin", part.begin }, { "seconds", part.seconds }, { "cubics", part.count } } );
		}
		return jsonText( json );
	}
	const lines::Stop& stop = line.stop;
	json["obstacle"] = { { "kind", nameOf( stop.obstacle ) }, { "part", stop.part }, { "fraction", stop.fraction },
	    { "position", { stop.position.x, stop.position.y, stop.position.z } }, { "state", stop.q }, { "joint", stop.joint },
	    { "pair", { stop.pair.first, stop.pair.second } } };
	return jsonText( json );
}

} // namespace

int runLine( const PlanOptions& options )
{
	refuseOthers( options );
	Notices notices( options.common.verbose );
	JointLimits limits = limitsOfFile( options.joint_limits );
	DrivenPlan driven( options );
	io::PathConstraints path;
	Input input = loadInput( options.common, notices, &path );
	refuseBoth( options, path );
	note( limits, options.joint_limits, input.robot, notices );
	input.max_d = options.common.min_d + planning_horizon;
	const PlanEnds ends = readEnds( options, input );
	const Workbench bench( input, ends.group, {}, notices );
	const io::Problem& problem = bench.problem();
	const std::vector<std::string> violations =
	    options.line.any_start ? std::vector<std::string>()
	                           : groupLimitViolations( problem, io::startState( problem ), limit_tolerance );
	if ( !violations.empty() )
	{
		throw io::Error( ends.start.file, ends.start.element, violations.front(), "start within the limits" );
	}
	lines::Settings settings;
	settings.edge.min_d = options.common.min_d;
	settings.edge.flags = options.common.checkFlags();
	settings.edge.slack = options.edge.slack;
	settings.limits = motionLimits( problem, input.robot, limits );
	noteUsual( settings.limits, notices );
	settings.seed = options.seed;
	settings.attempts = options.line.attempts;
	const lines::Task task = taskOf( options.line, problem, path.way ? &*path.way : nullptr, options.common.request );
	const double begin = now();
	const lines::Result line = lines::planLines( input.robot, problem, task, settings );
	const std::string report = reportOf( line, now() - begin );
	std::string text = lines::describe( problem, line );
	std::vector<std::string> notes = { text };
	if ( line.solved )
	{
		driven.drive( problem, input, line.segments, limits, "the line" );
		text += driven.told();
	}
	return driven.finish( problem, input, line.solved && driven.isProved(), text, report,
	    "it proves clearances; that the frame stays on its lines is no part of it", notes );
}

} // namespace leeway::cli
