// SPDX-License-Identifier: BSD-3-Clause
// Random plans of a robot's description under five constraints: LEEWAY_MANIFOLD_ROBOT, _SRDF, _GROUP, _TIP, _PACKAGES choose
// the robot, LEEWAY_MANIFOLD_PLANS how many. It prints solved shares and times for benchmarks.
#include "leeway/manifold/plan.hpp"
#include "seeded_rng.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>

using namespace leeway;
using Vector = std::vector<double>;

namespace
{

std::string setting( const char* name, const std::string& otherwise )
{
	const char* text = std::getenv( name );
	return text != nullptr ? text : otherwise;
}

Vector randomState( SeededRng& rng, const io::Problem& problem )
{
	Vector q;
	for ( const std::uint32_t v : problem.variables )
	{
		const lw_variable_info info = lw_robot_variable( problem.robot.get(), v );
		q.push_back( rng.uniform( std::max( info.lower, -3.14 ), std::min( info.upper, 3.14 ) ) );
	}
	return q;
}

/// Constraints about the tip's pose at a state: half widths of its turns and of its coordinates; 0: none.
io::PathConstraints constraintsAt( const io::Problem& problem, const std::string& tip, const Vector& q,
    const std::array<double, 3>& turns, const std::array<double, 3>& places )
{
	const io::Frame frame = io::findFrame( problem, tip, "test", "tip" );
	const Vector full = motions::fullState( problem, q );
	std::vector<lw_transform> links( lw_robot_link_count( problem.robot.get() ) );
	require( lw_robot_fk( problem.robot.get(), full.data(), links.data() ), "kinematics" );
	const lw_transform at = lw_transform_multiply( &links[frame.link], &frame.pose );
	io::PathConstraints path;
	path.file = "test";
	if ( turns[0] > 0 )
	{
		io::OrientationGoal goal;
		goal.link = tip;
		goal.element = "orientation";
		goal.tolerance = turns;
		lw_transform_to_quaternion( &at, goal.quaternion.data() );
		path.orientations.push_back( goal );
	}
	if ( places[0] > 0 )
	{
		io::PositionGoal goal;
		goal.link = tip;
		goal.element = "position";
		goal.regions.emplace_back();
		goal.regions[0].type = io::GoalRegion::Type::Box;
		goal.regions[0].size = { 2 * places[0], 2 * places[1], 2 * places[2] };
		goal.regions[0].pose = at;
		path.positions.push_back( goal );
	}
	return path;
}

double quantile( Vector values, double share )
{
	std::sort( values.begin(), values.end() );
	return values.empty() ? 0 : values[static_cast<std::size_t>( share * static_cast<double>( values.size() - 1 ) )];
}

} // namespace

TEST( RandomPlansData, SolvablePlansAreMissed )
{
	const std::string panda = std::string( LEEWAY_DATA_DIR ) + "/mbm/panda/";
	const bool given = std::getenv( "LEEWAY_MANIFOLD_ROBOT" ) != nullptr;
	const std::string urdf = setting( "LEEWAY_MANIFOLD_ROBOT", panda + "panda.urdf" );
	if ( !std::filesystem::exists( urdf ) )
	{
		GTEST_SKIP() << urdf;
	}
	io::LoadOptions load;
	load.package_paths = { setting( "LEEWAY_MANIFOLD_PACKAGES", panda ) };
	const std::string srdf = setting( "LEEWAY_MANIFOLD_SRDF", given ? "" : panda + "panda.srdf" );
	const io::RobotModel robot = io::loadRobot( urdf, srdf, load );
	io::ProblemOptions options;
	options.group = setting( "LEEWAY_MANIFOLD_GROUP", given ? "" : "panda_arm" );
	const io::Problem problem = io::buildProblem( robot, options );
	const std::string tip = setting( "LEEWAY_MANIFOLD_TIP", "panda_hand" );
	const struct
	{
		const char* name;
		std::array<double, 3> turns, places;
	} kinds[] = { { "upright within 0.1", { 0.1, 0.1, 4 }, {} }, { "upright within 0.001", { 1e-3, 1e-3, 4 }, {} },
	    { "plane within 1 mm", {}, { 5, 5, 1e-3 } }, { "plane within 0.1 mm", {}, { 5, 5, 1e-4 } },
	    { "line within 1 mm", {}, { 5, 1e-3, 1e-3 } } };
	const int count = std::atoi( setting( "LEEWAY_MANIFOLD_PLANS", "5" ).c_str() );
	manifold::Settings settings;
	settings.edge.flags = srdf.empty() ? LW_CHECK_ENVIRONMENT : LW_CHECK_BOTH;
	settings.limits.velocity.assign( problem.variables.size(), 1 );
	settings.limits.acceleration.assign( problem.variables.size(), 2 );
	settings.seconds = 5;
	const Query query = makeQuery( problem.checker.get() );
	SeededRng rng( 45 );
	for ( const auto& kind : kinds )
	{
		Vector times, pieces;
		int asked = 0, solved = 0;
		for ( int tries = 0; asked < count && tries < 1000 * count; ++tries )
		{
			const auto isFree = [&]( const Vector& q )
			{
				bool free = false;
				require( lw_checker_is_free(
				             problem.checker.get(), query.get(), q.data(), settings.edge.flags, 0, &free, nullptr ),
				    "free" );
				return free;
			};
			manifold::Task task;
			task.start = randomState( rng, problem );
			const io::PathConstraints path = constraintsAt( problem, tip, task.start, kind.turns, kind.places );
			Vector goal = randomState( rng, problem );
			if ( !isFree( task.start ) || !manifold::Manifold( robot, problem, path ).project( goal.data() ) ||
			     !isFree( goal ) )
			{
				continue;
			}
			task.goals = { goal };
			settings.seed = static_cast<std::uint64_t>( ++asked );
			const auto begin = std::chrono::steady_clock::now();
			const manifold::Result r = manifold::planPath( robot, problem, path, task, settings );
			const double ms = std::chrono::duration<double, std::milli>( std::chrono::steady_clock::now() - begin ).count();
			solved += r.solved() ? 1 : 0;
			r.solved() ? times.push_back( ms ) : void();
			r.solved() ? pieces.push_back( static_cast<double>( r.segments.size() ) ) : void();
			EXPECT_TRUE( !r.solved() || motions::areKept( motions::proveConstraints( problem, path, r.segments, {} ) ) );
		}
		std::printf( "%s, %s: %d of %d solved; ms median %.1f, 95 %% %.0f; cubics median %.0f\n", robot.name.c_str(),
		    kind.name, solved, asked, quantile( times, 0.5 ), quantile( times, 0.95 ), quantile( pieces, 0.5 ) );
	}
}
