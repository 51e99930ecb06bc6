// SPDX-License-Identifier: BSD-3-Clause
// Random lines of 0.2 to 1 m from poses that a robot has. LEEWAY_LINE_ROBOT, _SRDF, _GROUP, _TIP and LEEWAY_LINES choose others and how many.
// A dense search judges those that are not found: many goal states at each of 25 stations, and a chain of near ones from end to end.
#include "leeway/ik/goal_states.hpp"
#include "leeway/lines/lines.hpp"
#include "seeded_rng.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>

using namespace leeway;

namespace
{

std::string setting( const char* name, const std::string& otherwise )
{
	const char* text = std::getenv( name );
	return text != nullptr ? text : otherwise;
}

lw_transform tipOf( const io::Problem& problem, const io::Frame& tip, const std::vector<double>& q )
{
	const std::vector<double> full = motions::fullState( problem, q );
	std::vector<lw_transform> links( lw_robot_link_count( problem.robot.get() ) );
	require( lw_robot_fk( problem.robot.get(), full.data(), links.data() ), "kinematics" );
	return lw_transform_multiply( &links[tip.link], &tip.pose );
}

std::vector<double> randomState( SeededRng& rng, const io::Problem& problem )
{
	std::vector<double> q;
	for ( const std::uint32_t v : problem.variables )
	{
		const lw_variable_info info = lw_robot_variable( problem.robot.get(), v );
		q.push_back( rng.uniform( std::max( info.lower, -3.15 ), std::min( info.upper, 3.15 ) ) );
	}
	return q;
}

/// Goal states of a pose within 0.1 mm and 0.1 degrees.
std::vector<std::vector<double>> statesAt( const io::RobotModel& robot, const io::Problem& problem, const std::string& link,
    const lw_transform& pose, lw_check_flags flags )
{
	io::Request request;
	request.file = "test";
	io::PositionGoal place;
	place.link = link;
	place.regions.emplace_back();
	place.regions.back().size = { 1e-4, 0, 0 };
	place.regions.back().pose = pose;
	request.goal_positions.push_back( place );
	io::OrientationGoal turn;
	turn.link = link;
	turn.tolerance.fill( 1e-3 );
	lw_transform_to_quaternion( &pose, turn.quaternion.data() );
	request.goal_orientations.push_back( turn );
	ik::Options options;
	options.states = 300;
	options.searches = 600;
	options.patience = 300;
	options.flags = flags;
	return ik::findGoalStates( robot, problem, request, options ).states;
}

/// Is there a chain of states, one at each station, of which none is far from the one before?
bool denseSearchFinds( const io::RobotModel& robot, const io::Problem& problem, const lines::Task& task,
    const std::string& link, lw_check_flags flags )
{
	constexpr int stations = 25;
	constexpr double near = 0.35; // radians or metres of each joint
	lw_region_def way = lw_region_def_default();
	require( lw_region_line( &way, &task.waypoints[0].pose, &task.waypoints[1].pose ), "line" );
	std::vector<std::vector<double>> reached;
	for ( int i = 0; i <= stations; ++i )
	{
		const lw_transform pose = lw_region_reference( &way, static_cast<double>( i ) / stations );
		std::vector<std::vector<double>> next;
		for ( const std::vector<double>& q : statesAt( robot, problem, link, pose, flags ) )
		{
			const bool joined =
			    i == 0 || std::any_of( reached.begin(), reached.end(),
			                  [&]( const std::vector<double>& before )
			                  {
				                  double far = 0;
				                  for ( std::size_t v = 0; v < q.size(); ++v )
				                  {
					                  const double step = q[v] - before[v];
					                  const bool wraps =
					                      lw_robot_variable( problem.robot.get(), problem.variables[v] ).wraps;
					                  far = std::max( far, std::fabs( wraps ? std::remainder( step, 2 * M_PI ) : step ) );
				                  }
				                  return far < near;
			                  } );
			if ( joined )
			{
				next.push_back( q );
			}
		}
		if ( next.empty() )
		{
			return false;
		}
		reached = next;
	}
	return true;
}

double median( std::vector<double> values, double share )
{
	std::sort( values.begin(), values.end() );
	return values.empty() ? 0 : values[static_cast<std::size_t>( share * static_cast<double>( values.size() - 1 ) )];
}

} // namespace

TEST( RandomLinesData, SolvableLinesAreMissed )
{
	const std::string panda = std::string( LEEWAY_DATA_DIR ) + "/mbm/panda/";
	const std::string urdf = setting( "LEEWAY_LINE_ROBOT", panda + "panda.urdf" );
	if ( !std::filesystem::exists( urdf ) )
	{
		GTEST_SKIP() << urdf;
	}
	io::LoadOptions load;
	load.package_paths = { setting( "LEEWAY_LINE_PACKAGES", panda ) };
	const std::string srdf =
	    setting( "LEEWAY_LINE_SRDF", std::getenv( "LEEWAY_LINE_ROBOT" ) != nullptr ? "" : panda + "panda.srdf" );
	const io::RobotModel robot = io::loadRobot( urdf, srdf, load );
	io::ProblemOptions options;
	options.group = setting( "LEEWAY_LINE_GROUP", std::getenv( "LEEWAY_LINE_ROBOT" ) != nullptr ? "" : "panda_arm" );
	const io::Problem problem = io::buildProblem( robot, options );
	lines::Task task;
	const std::string link = setting( "LEEWAY_LINE_TIP", "panda_hand" );
	task.tip = io::findFrame( problem, link, "test", "tip" );
	task.any_start = true;
	lines::Settings settings;
	settings.edge.flags = srdf.empty() ? LW_CHECK_ENVIRONMENT : LW_CHECK_BOTH;
	settings.limits.velocity.assign( problem.variables.size(), 1 );
	settings.limits.acceleration.assign( problem.variables.size(), 2 );
	SeededRng rng( 44 );
	const int count = std::atoi( setting( "LEEWAY_LINES", "10" ).c_str() );
	const Query query = makeQuery( problem.checker.get() );
	std::vector<double> times, cubics, errors;
	int solved = 0, later = 0, first = 0, asked = 0;
	while ( asked < count )
	{
		// a line from a free state's pose in a random direction, with a turn of up to 0.5 rad
		const std::vector<double> q = randomState( rng, problem );
		bool free = false;
		require( lw_checker_is_free( problem.checker.get(), query.get(), q.data(), settings.edge.flags, 0, &free, nullptr ),
		    "free" );
		if ( !free )
		{
			continue;
		}
		const lw_transform from = tipOf( problem, task.tip, q );
		lw_vec3 d = { rng.normal(), rng.normal(), rng.normal() };
		const double length = rng.uniform( 0.2, 1 ) / std::sqrt( d.x * d.x + d.y * d.y + d.z * d.z );
		const double none[3] = { 0, 0, 0 },
		             rpy[3] = { rng.uniform( -0.3, 0.3 ), rng.uniform( -0.3, 0.3 ), rng.uniform( -0.3, 0.3 ) };
		lw_transform turn, to;
		lw_transform_from_rpy( none, rpy, &turn );
		to = lw_transform_multiply( &from, &turn );
		to.t[0] = from.t[0] + length * d.x;
		to.t[1] = from.t[1] + length * d.y;
		to.t[2] = from.t[2] + length * d.z;
		task.waypoints = { { from }, { to } };
		++asked;
		settings.seed = static_cast<std::uint64_t>( asked );
		settings.attempts = 100;
		const auto begin = std::chrono::steady_clock::now();
		lines::Result r = lines::planLines( robot, problem, task, settings );
		const double ms = std::chrono::duration<double, std::milli>( std::chrono::steady_clock::now() - begin ).count();
		if ( r.solved )
		{
			times.push_back( ms );
			cubics.push_back( static_cast<double>( r.segments.size() ) );
			errors.push_back( 1e6 * r.position_error );
			++solved;
			first += r.attempts == 1;
			EXPECT_LE( r.position_error, task.tolerance );
			EXPECT_LE( r.angle_error, task.angle );
			continue;
		}
		later += denseSearchFinds( robot, problem, task, link, settings.edge.flags );
	}
	std::printf( "%s: %d lines: %d solved, %d at the first attempt; %d more by a dense search; ms median %.2f, 95 %% %.1f; "
	             "cubics median %.0f, error median %.1f um\n",
	    robot.name.c_str(), count, solved, first, later, median( times, 0.5 ), median( times, 0.95 ), median( cubics, 0.5 ),
	    median( errors, 0.5 ) );
	EXPECT_GE( solved, 4 * later );
}
