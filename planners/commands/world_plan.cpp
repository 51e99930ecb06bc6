// SPDX-License-Identifier: BSD-3-Clause
// leeway world plan: robots beside all that moves, in states and time.
#include "leeway/motions/trajectory.hpp"
#include "motions/names.hpp"
#include "motions/report.hpp"
#include "motions/timed_robots.hpp"
#include "program/ends.hpp"
#include "commands/world_cell.hpp"
#include "commands/limits_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace leeway::cli
{
namespace
{

/// A robot and where it is to go: of --goal ROBOT=STATE.
struct Wanted
{
	std::string robot, state, option;
};

std::vector<Wanted> wantedOf( const WorldOptions& options )
{
	std::vector<Wanted> out;
	for ( const std::string& text : options.goals )
	{
		const std::size_t equals = text.find( '=' );
		const Wanted wanted = {
		    text.substr( 0, equals ), equals == std::string::npos ? "" : text.substr( equals + 1 ), "--goal " + text };
		if ( wanted.state.empty() )
		{
			throw io::Error( "command line", wanted.option, "names no state",
			    "write ROBOT=STATE of the SRDF, or ROBOT=JOINT=VALUE,JOINT=VALUE" );
		}
		if ( std::any_of( out.begin(), out.end(), [&]( const Wanted& w ) { return w.robot == wanted.robot; } ) )
		{
			throw io::Error( "command line", wanted.option, "a robot has one goal", "remove one of them" );
		}
		out.push_back( wanted );
	}
	return out;
}

/// A robot of the world as the planner takes it. Joints that the goal does not name keep their values.
planners::TimedRobot robotOf( Cell& cell, const Wanted& wanted, const JointLimits& limits, double from )
{
	const io::WorldModel& world = cell.world();
	const io::WorldPart& part = world.part( wanted.robot );
	if ( part.kind != io::WorldPart::Kind::robot )
	{
		throw io::Error( "command line", wanted.option, wanted.robot + " is an object", "name a robot of the world" );
	}
	planners::TimedRobot robot = timedRobot( world, cell.schedule(), part.name, limits, from );
	const Values goal = parseEnd( wanted.option, wanted.state, "", world.robot, part.name + "/" ).values;
	std::vector<double> values = wholePoint( world, cell.schedule(), robot, robot.start.data() );
	for ( std::size_t i = 0; i < part.variables.size(); ++i )
	{
		const auto value = goal.find( part.variables[i] );
		values[i] = value != goal.end() ? value->second : values[i];
	}
	robot.goals = { goalOf( world, cell.schedule(), robot, values ) };
	return robot;
}

std::string trajectoryText( const io::Problem& problem, const planners::TimedRobot& robot, const planners::TimedPath& path )
{
	Json trajectory;
	for ( const std::uint32_t v : robot.variables )
	{
		trajectory["joint_names"].push_back( problem.variable_names[v].substr( robot.name.size() + 1 ) );
	}
	for ( std::size_t i = 0; i < path.count(); ++i )
	{
		Json point;
		point["positions"] = std::vector<double>( path[i], path[i] + path.dimension );
		point["time_from_start"] = path.times[i];
		trajectory["points"].push_back( point );
	}
	Json json;
	json["joint_trajectory"] = trajectory;
	return jsonText( json );
}

/// Trajectories in the folder of --out, and the options that name them.
struct Results
{
	std::vector<std::unique_ptr<OutputFile>> files;
	std::string again;
};

Results trajectoriesOf( const WorldOptions& options, const Cell& cell, const std::vector<planners::TimedRobot>& robots,
    const planners::SchedulePlan& plan )
{
	Results out;
	std::filesystem::create_directories( options.out );
	for ( std::size_t r = 0; r < robots.size(); ++r )
	{
		const std::string file = ( std::filesystem::path( options.out ) / ( robots[r].name + ".json" ) ).string();
		out.files.push_back( std::make_unique<OutputFile>( "--out", file ) );
		out.files.back()->text = trajectoryText( cell.bench().problem(), robots[r], plan.paths[r] );
		out.again += fmt::format( " --motion {}={}", robots[r].name, file );
	}
	return out;
}

Json reportOf( const WorldOptions& options, const std::vector<planners::TimedRobot>& robots,
    const planners::SchedulePlan& plan, const Notices& notices )
{
	const bool solved = plan.outcome == planners::Outcome::SOLVED;
	Json json;
	json["world"] = options.common.cell;
	json["outcome"] = planners::name( plan.outcome );
	json["problem"] = plan.problem;
	for ( std::size_t r = 0; solved && r < robots.size(); ++r )
	{
		json["arrivals"][robots[r].name] = plan.paths[r].times.back();
	}
	json["lower_bound"] = solved ? plan.proof.lower_bound : 0;
	json["proved_until"] = solved ? plan.proof.time : options.from;
	json["edges"] = plan.statistics.edges;
	json["samples"] = plan.statistics.samples;
	json["notices"] = notices.all();
	return json;
}

std::string describe( const planners::SchedulePlan& plan, const std::vector<planners::TimedRobot>& robots )
{
	std::string text;
	if ( plan.outcome != planners::Outcome::SOLVED )
	{
		return fmt::format( "not solved: {}\n", plan.problem );
	}
	for ( std::size_t r = 0; r < robots.size(); ++r )
	{
		const planners::TimedPath& path = plan.paths[r];
		text += fmt::format( "{:<12}{}, from {:g} s to {:.3f} s\n", robots[r].name, counted( path.count(), "point" ),
		    path.times.front(), path.times.back() );
	}
	if ( plan.order.size() > 1 )
	{
		text += "planned in the order";
		for ( const std::size_t r : plan.order )
		{
			text += " " + robots[r].name;
		}
		text += "\n";
	}
	return text + fmt::format( "proved: every clearance of the planned robots is at least {:.6g} m until {:.3f} s\n",
	                  plan.proof.lower_bound, plan.proof.time );
}

} // namespace

int runWorldPlan( const WorldOptions& options )
{
	Notices notices( options.common.verbose );
	const JointLimits limits = limitsOfFile( options.joint_limits );
	notices.add( "joint limits of the file", limits.notices );
	const std::vector<Wanted> wanted = wantedOf( options );
	OutputFile json_file( "--json", options.json );
	std::set<std::string> focus;
	for ( const Wanted& one : wanted )
	{
		focus.insert( one.robot );
	}
	Cell cell( options, notices, focus );
	std::vector<planners::TimedRobot> robots;
	for ( const Wanted& one : wanted )
	{
		robots.push_back( robotOf( cell, one, limits, options.from ) );
	}
	planners::ScheduleSettings settings;
	settings.timed.timed.edge.min_d = options.common.min_d;
	settings.timed.timed.edge.slack = options.slack;
	settings.timed.timed.edge.flags = options.common.checkFlags();
	settings.timed.start_time = options.from;
	settings.timed.deadline = options.deadline;
	settings.timed.seed = options.seed;
	settings.together = options.together;
	settings.search_seconds = options.search_seconds;
	planners::SchedulePlan plan;
	{
		const Progress progress( "planning" );
		plan = planBeside( cell.world(), cell.schedule(), cell.bench().query(), robots, settings );
	}
	const bool solved = plan.outcome == planners::Outcome::SOLVED;
	Results results;
	if ( solved && !options.out.empty() )
	{
		results = trajectoriesOf( options, cell, robots, plan );
	}
	std::vector<OutputFile*> files;
	for ( const std::unique_ptr<OutputFile>& file : results.files )
	{
		files.push_back( file.get() );
	}
	if ( !options.json.empty() )
	{
		json_file.text = jsonText( reportOf( options, robots, plan, notices ) );
		files.push_back( &json_file );
	}
	commitTogether( files );
	printOut( describe( plan, robots ) );
	if ( !results.again.empty() )
	{
		tell( "leeway: look at it by leeway world view --world {}{} --out page.html\n", options.common.cell, results.again );
	}
	return solved ? exit_yes : exit_no;
}

} // namespace leeway::cli
