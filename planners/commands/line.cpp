// SPDX-License-Identifier: BSD-3-Clause
// leeway plan --line, or with a request that has waypoints: a frame goes along lines and arcs.
#include "commands/line_task.hpp"
#include "commands/driven_plan.hpp"
#include "commands/limits_file.hpp"
#include "leeway/motions/path_constraints.hpp"
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
	requireLineNumbers( options.line );
}

void refuseBoth( const PlanOptions& options, const io::PathConstraints& path )
{
	if ( path.way && ( !options.line.poses.empty() || !options.line.frame.empty() ) )
	{
		wrong( options.line.poses.empty() ? "--line-frame" : "--line", "stands beside a request that has waypoints",
		    "give one of them" );
	}
	if ( !path.way && !path.empty() )
	{
		wrong( "--line", "stands beside a request with path_constraints",
		    "give its poses as the request's waypoints, or remove path_constraints" );
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

/// @param way of the request, in place of the options' poses; null: none
/// @param request its file, for errors
lines::Task taskOf(
    const LineOptions& line, const io::Problem& problem, const io::CartesianWay* way, const std::string& request )
{
	lines::Task task = commonTask( line );
	std::string link;
	std::vector<std::optional<double>> radii;
	if ( way != nullptr )
	{
		task = lines::taskOf( problem, *way, task, request );
		radii.resize( task.waypoints.size() );
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
			io::Frame tip = io::findFrame( problem, link, "command line", option );
			tip.pose = lw_transform_multiply( &tip.pose, &task.tip.pose );
			task.tip = tip;
			task.base = io::findFrame( problem, line.frame, "command line", "--line-frame" );
		}
		const lw_transform before = task.waypoints.empty() ? startPose( problem, task ) : task.waypoints.back().pose;
		radii.emplace_back();
		task.waypoints.push_back( waypointOf( option, text.substr( equals + 1 ), before, radii.back() ) );
	}
	task.any_start = line.any_start;
	blendCorners( line.blend, radii, task );
	return task;
}

const char* nameOf( lines::Obstacle obstacle )
{
	static const char* const names[] = {
	    "none", "unreachable", "joint limit", "singularity", "collision", "undecided", "constraint" };
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
	if ( stop.obstacle == lines::Obstacle::CONSTRAINT )
	{
		json["obstacle"]["constraint"] = stop.constraint;
	}
	return jsonText( json );
}

} // namespace

lines::Task commonTask( const LineOptions& line )
{
	lines::Task task;
	if ( !line.tip.empty() )
	{
		task.tip.pose = poseOf( "--line-tip", numbersOf( "--line-tip", line.tip, 3, 7 ) );
	}
	if ( !line.free_axis.empty() )
	{
		const std::vector<double> axis = numbersOf( "--free-axis", line.free_axis, 3, 3 );
		task.free_axis = lw_vec3{ axis[0], axis[1], axis[2] };
	}
	task.tolerance = line.tolerance;
	task.angle = line.angle;
	task.speed = line.speed;
	return task;
}

void requireLineNumbers( const LineOptions& line )
{
	requirePositive( "--line-tolerance", line.tolerance );
	requirePositive( "--line-angle", line.angle );
	if ( !( line.blend >= 0 && std::isfinite( line.blend ) ) )
	{
		wrong( "--line-blend", "is no radius", "give metres, 0 or more" );
	}
	if ( !( line.speed > 0 ) )
	{
		wrong( "--line-speed", "is no speed above 0", "give metres per second" );
	}
}

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
	const lines::Settings settings{ settingsOf( options, input, problem, limits, notices ), options.line.attempts };
	lines::Task task = taskOf( options.line, problem, path.way ? &*path.way : nullptr, options.common.request );
	task.path = path;
	const double begin = now();
	const lines::Result line = lines::planLines( input.robot, problem, task, settings );
	const std::string report = reportOf( line, now() - begin );
	std::string text = lines::describe( problem, line );
	std::vector<std::string> notes = { text };
	bool kept = true;
	if ( line.solved )
	{
		const std::vector<Segment>& segments = driven.drive( problem, input, line.segments, limits, "the line" );
		const std::vector<ConstraintProof> proofs = proveConstraints( problem, path, segments, {} );
		text += driven.told() + motions::describe( proofs );
		kept = areKept( proofs );
		for ( const ConstraintProof& proof : proofs )
		{
			notes.push_back( motions::describe( proof ) );
		}
	}
	return driven.finish( problem, input, line.solved && kept && driven.isProved(), text, report,
	    path.empty() ? "it proves clearances; that the frame stays on its lines is no part of it"
	                 : "it proves clearances; that the frame stays on its lines, and path_constraints, are no part of it",
	    notes );
}

} // namespace leeway::cli
