// SPDX-License-Identifier: BSD-3-Clause
// Plans to poses of a hand, inverse kinematics included: ARMAR-III's arms in the cluttered kitchen and Panda in MotionBenchMaker's
// scenes. Exit status 1 if a pose of a free state is not reached, or a goal state is refuted.
//
// The poses are those of random free states, 12 for each robot. The times are processor times of findGoalStates() and of two
// planners that go from the start of the problem to any of the goal states: leeway::planners, and RRT-Connect of OMPL. Loading
// and the building of checkers are outside of them.
#include "programs/commands.hpp"
#include "support/race.hpp"

#include "leeway/ik/goal_states.hpp"
#include "leeway/ompl/validity.hpp"
#include "leeway/planners/planner.hpp"

#include <ompl/base/goals/GoalStates.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/util/Console.h>
#include <ompl/util/RandomNumbers.h>

#include <cstdio>
#include <memory>
#include <random>

namespace io = leeway::io;
namespace ob = ::ompl::base;

namespace
{

struct Settings
{
	std::string data = LEEWAY_DATA_DIR;
	double seconds = 10;
	int poses = 12;
	std::uint64_t seed = 20260101;
};

struct Robot
{
	std::string name;
	io::RobotModel model;
	leeway::Reach reach;
};

/// A place to plan in; the request's goal becomes a pose.
struct Place
{
	std::string scene, request;
	std::string group; ///< empty: of the request
};

struct Row
{
	double ik = 0, native = 0, rrt = 0; ///< microseconds; planning: negative = no path in time
	std::size_t states = 0, searches = 0;
};

using State = std::vector<double>;

bool isFree( const io::Problem& problem, const State& q )
{
	const leeway::Query query = leeway::makeQuery( problem.checker.get() );
	bool free = false;
	leeway::require( lw_checker_is_free( problem.checker.get(), query.get(), q.data(), LW_CHECK_BOTH, 0, &free, nullptr ),
	    "lw_checker_is_free" );
	return free;
}

State randomFreeState( const io::Problem& problem, std::mt19937_64& random )
{
	for ( ;; )
	{
		State q;
		for ( std::uint32_t variable : problem.variables )
		{
			const lw_variable_info info = lw_robot_variable( problem.robot.get(), variable );
			q.push_back( std::uniform_real_distribution<double>( info.lower, info.upper )( random ) );
		}
		if ( isFree( problem, q ) )
		{
			return q;
		}
	}
}

/// The pose of a link at a state becomes the goal, with the tolerances of RViz.
void askForPose( const io::Problem& problem, const std::string& link, const State& q, io::Request& request )
{
	State full( problem.reference.size() );
	lw_checker_full_state( problem.checker.get(), q.data(), full.data() );
	std::vector<lw_transform> links( lw_robot_link_count( problem.robot.get() ) );
	leeway::require( lw_robot_fk( problem.robot.get(), full.data(), links.data() ), "lw_robot_fk" );
	const lw_transform& pose = links.at( lw_robot_find_link( problem.robot.get(), link.c_str() ) );
	io::PositionGoal position;
	position.link = link;
	position.regions.emplace_back();
	position.regions[0].size = { 1e-4, 0, 0 };
	std::copy( pose.t, pose.t + 3, position.regions[0].pose.t );
	io::OrientationGoal orientation;
	orientation.link = link;
	orientation.tolerance.fill( 1e-3 );
	lw_transform_to_quaternion( &pose, orientation.quaternion.data() );
	request.goal.clear();
	request.goal_positions = { position };
	request.goal_orientations = { orientation };
}

/// @return microseconds; negative without a path
double planNative( const io::Problem& problem, const State& start, const leeway::ik::GoalStates& goal, double seconds )
{
	const leeway::Query query = leeway::makeQuery( problem.checker.get() );
	const double begin = threadMicroseconds();
	leeway::planners::Planner planner( problem.checker, {} );
	planner.addStart( start.data() );
	for ( const State& q : goal.states )
	{
		planner.addGoal( q.data() );
	}
	leeway::planners::Stop stop;
	stop.seconds = seconds;
	const bool solved = planner.solve( query.get(), stop ) == leeway::planners::Outcome::SOLVED;
	return solved ? threadMicroseconds() - begin : -1;
}

double planRrtConnect( const io::Problem& problem, const State& start, const leeway::ik::GoalStates& goal, double seconds )
{
	const auto space = leeway::ompl::makeStateSpace( problem.checker );
	const auto si = std::make_shared<ob::SpaceInformation>( space );
	const auto engine = leeway::ompl::install( si, problem.checker );
	si->setup();
	const auto state = [&]( const State& q )
	{
		ob::ScopedState<> result( space );
		engine->adapter().fromVector( q.data(), result.get() );
		space->enforceBounds( result.get() );
		return result;
	};
	const double begin = threadMicroseconds();
	const auto definition = std::make_shared<ob::ProblemDefinition>( si );
	const auto goals = std::make_shared<ob::GoalStates>( si );
	definition->addStartState( state( start ) );
	for ( const State& q : goal.states )
	{
		goals->addState( state( q ) );
	}
	definition->setGoal( goals );
	::ompl::geometric::RRTConnect planner( si );
	planner.setProblemDefinition( definition );
	planner.setup();
	planner.solve( ob::timedPlannerTerminationCondition( seconds ) );
	return definition->hasExactSolution() ? threadMicroseconds() - begin : -1;
}

/// @param wrong counts poses that are not reached and goal states that are refuted
Row runPose(
    const Settings& settings, const Robot& robot, const io::Problem& problem, const io::Request& request, int& wrong )
{
	Row row;
	leeway::ik::Options options;
	options.seed = settings.seed;
	const double begin = threadMicroseconds();
	const leeway::ik::GoalStates goal = leeway::ik::findGoalStates( robot.model, problem, request, options );
	row.ik = threadMicroseconds() - begin;
	row.states = goal.states.size();
	row.searches = goal.searches;
	wrong += goal.states.empty();
	for ( const State& q : goal.states )
	{
		wrong += !isFree( problem, q ) || !leeway::ik::goalViolations( problem, request, q.data() ).empty();
	}
	if ( goal.states.empty() )
	{
		std::printf( "%s\n", goal.problem.c_str() );
		return row;
	}
	const State start = io::startState( problem );
	row.native = planNative( problem, start, goal, settings.seconds );
	row.rrt = planRrtConnect( problem, start, goal, settings.seconds );
	return row;
}

std::vector<Row> runRobot( const Settings& settings, Robot& robot, const std::vector<Place>& places, int& wrong )
{
	std::mt19937_64 random( settings.seed );
	std::vector<Row> rows;
	for ( std::size_t i = 0; rows.size() < std::size_t( settings.poses ) && i < 10 * places.size(); ++i )
	{
		const Place& place = places[i % places.size()];
		const io::SceneModel scene = io::loadScene( settings.data + "/" + place.scene );
		io::Request request = io::loadRequest( settings.data + "/" + place.request );
		io::ProblemOptions options;
		options.group = place.group.empty() ? request.group : place.group;
		options.scene = &scene;
		options.request = &request;
		if ( robot.reach )
		{
			options.reach = robot.reach;
		}
		else
		{
			options.find_reach = io::ReachOptions();
		}
		const io::Problem problem = io::buildProblem( robot.model, options );
		robot.reach = problem.reach.reach;
		if ( !isFree( problem, io::startState( problem ) ) )
		{
			continue;
		}
		const std::string link = robot.name == "panda"         ? "panda_hand"
		                         : options.group == "left_arm" ? "Hand_Palm_2_L"
		                                                       : "Hand_Palm_2_R";
		askForPose( problem, link, randomFreeState( problem, random ), request );
		rows.push_back( runPose( settings, robot, problem, request, wrong ) );
		const Row& row = rows.back();
		std::printf( "%-8s %-44s %6zu %8zu | %9.0f %9.0f %9.0f\n", robot.name.c_str(), place.request.c_str(), row.states,
		    row.searches, row.ik, row.native, row.rrt );
	}
	return rows;
}

/// Medians, and a row for each pose.
void report( const std::string& name, const std::vector<Row>& rows, Result& result )
{
	std::vector<double> ik, native, rrt;
	for ( const Row& row : rows )
	{
		// a plan that is not found in time counts as endless
		ik.push_back( row.ik );
		native.push_back( row.native < 0 ? HUGE_VAL : row.ik + row.native );
		rrt.push_back( row.rrt < 0 ? HUGE_VAL : row.ik + row.rrt );
		result.add( { { "robot", name }, { "pose", std::to_string( ik.size() ) }, { "states", row.states },
		    { "searches", row.searches }, { "ik", { { "mean_us", row.ik } } }, { "native", { { "mean_us", row.native } } },
		    { "rrtconnect", { { "mean_us", row.rrt } } } } );
	}
	std::printf( "%-8s %-44s %6s %8s | %9.0f %9.0f %9.0f\n\n", name.c_str(), "median, plans with inverse kinematics", "", "",
	    median( ik ), median( native ), median( rrt ) );
	result["medians"][name] = {
	    { "ik_us", median( ik ) }, { "ik_native_us", median( native ) }, { "ik_rrtconnect_us", median( rrt ) } };
}

int run( const Settings& settings, Result& result )
{
	::ompl::msg::setLogLevel( ::ompl::msg::LOG_NONE );
	::ompl::RNG::setSeed( static_cast<std::uint_fast32_t>( settings.seed % 0x7fffffff + 1 ) );
	requireData( settings.data, "armar3" );
	requireData( settings.data, "mbm" );
	std::vector<Place> kitchen, shelves;
	for ( int i = 1; i <= 12; ++i )
	{
		char number[8];
		std::snprintf( number, sizeof number, "%02d", i );
		kitchen.push_back( { "kit_kitchen/scene_cluttered.yaml", std::string( "armar3/reach/" ) + number + ".yaml", "" } );
	}
	for ( const char* number : { "0001", "0002" } )
	{
		for ( const char* set :
		    { "bookshelf_small", "bookshelf_tall", "bookshelf_thin", "box", "cage", "table_pick", "table_under_pick" } )
		{
			const std::string folder = std::string( "mbm/panda/problems/" ) + set + "_panda/";
			shelves.push_back( { folder + "scene" + number + ".yaml", folder + "request" + number + ".yaml", "panda_arm" } );
		}
	}
	std::printf( "microseconds of processor time; -1: no path in %g s\n", settings.seconds );
	std::printf(
	    "%-8s %-44s %6s %8s | %9s %9s %9s\n", "robot", "request", "states", "searches", "ik", "native", "RRTConnect" );
	int wrong = 0;
	for ( const auto& [name, folder, places] :
	    { std::make_tuple( "armar3", "armar3/armar3", &kitchen ), std::make_tuple( "panda", "mbm/panda/panda", &shelves ) } )
	{
		const std::string base = settings.data + "/" + folder;
		Robot robot{ name, io::loadRobot( base + ".urdf", base + ".srdf" ), {} };
		report( name, runRobot( settings, robot, *places, wrong ), result );
	}
	std::printf( "poses not reached, and goal states refuted: %d\n", wrong );
	return wrong > 0 ? 1 : 0;
}

} // namespace

void addPose( Bench& bench )
{
	const auto s = std::make_shared<Settings>();
	Command& command = bench.command( "pose", "plans to poses of a hand, inverse kinematics included" );
	command.option( "--data", s->data, "folder of robots and scenes" );
	command.option( "--poses", s->poses, "of each robot", { 1, 120 } );
	command.option( "--seconds", s->seconds, "at most for a plan", POSITIVE );
	command.option( "--seed", s->seed, "of poses, searches and planners" );
	command.work( [s]( Result& result ) { return run( *s, result ); } );
}
