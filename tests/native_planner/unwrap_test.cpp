// SPDX-License-Identifier: BSD-3-Clause
// Paths as a controller without wrap-around drives them: from the numbers of the start on, without jumps.
#include "planner_rig.hpp"
#include "seeded_rng.hpp"

#include "leeway/planners/planner.h"
#include "leeway/planners/unwrap.hpp"

#include <cstring>

namespace
{

constexpr double pi = 3.14159265358979323846;

bool wraps( const leeway::Checker& checker, std::size_t v )
{
	return lw_robot_variable( lw_checker_robot( checker.get() ), lw_checker_variable( checker.get(), std::uint32_t( v ) ) )
	    .wraps;
}

/// The path from `start` to `goal` by lw_plan(), flat.
planners::Path planned(
    const leeway::Checker& checker, const std::vector<double>& start, const std::vector<double>& goal, bool smooth )
{
	lw_plan_def def = lw_plan_def_default();
	def.checker = checker.get();
	def.starts = start.data();
	def.goals = goal.data();
	def.start_count = def.goal_count = 1;
	def.seconds = patience;
	def.smooth = smooth;
	lw_diag diag{};
	lw_plan_result result{};
	EXPECT_EQ( lw_plan( &def, &diag, &result ), LW_OK ) << diag.message;
	EXPECT_EQ( result.outcome, LW_PLAN_SOLVED ) << result.message;
	planners::Path path{ result.variable_count, {} };
	path.values.assign( result.states, result.states + std::size_t( result.state_count ) * result.variable_count );
	lw_plan_result_clear( &result );
	return path;
}

TEST( NativePlannerUnwrap, PathsBeginAtTheNumbersOfTheStartAndDoNotJump )
{
	SeededRng rng( 361 );
	unsigned turned = 0;
	for ( const char* name : { "Arm", "Cart", "Carrier" } )
	{
		SCOPED_TRACE( name );
		const World& world = worldOf( name );
		const leeway::Checker checker = world.make();
		for ( int round = 0; round < 8; ++round )
		{
			std::vector<double> start = world.start, goal = world.goal;
			for ( std::size_t v = 0; v < start.size(); ++v )
			{
				start[v] += wraps( checker, v ) ? 2 * pi * rng.integer( -3, 3 ) : 0;
				goal[v] += wraps( checker, v ) ? 2 * pi * rng.integer( -3, 3 ) : 0;
				turned += std::fabs( start[v] - world.start[v] ) > 1;
			}
			const planners::Path path = planned( checker, start, goal, round % 2 == 0 );
			ASSERT_EQ( std::memcmp( path[0], start.data(), start.size() * sizeof( double ) ), 0 )
			    << "not the start, bit for bit";
			for ( std::size_t i = 1; i < path.count(); ++i )
			{
				for ( std::size_t v = 0; v < start.size(); ++v )
				{
					ASSERT_TRUE( !wraps( checker, v ) || std::fabs( path[i][v] - path[i - 1][v] ) <= pi )
					    << "jumps at " << i;
				}
			}
			for ( std::size_t v = 0; v < start.size(); ++v )
			{
				const double off = path[path.count() - 1][v] - goal[v];
				ASSERT_NEAR( wraps( checker, v ) ? std::remainder( off, 2 * pi ) : off, 0, 1e-9 ) << "not the goal";
			}
			audit( checker, path );
		}
	}
	EXPECT_GT( turned, 10u );
}

TEST( NativePlannerUnwrap, EachOfSeveralStartsKeepsItsNumbers )
{
	const World& world = worldOf( "Arm" );
	const leeway::Checker checker = world.make();
	std::vector<double> other = world.start;
	for ( std::size_t v = 0; v < other.size(); ++v )
	{
		other[v] += wraps( checker, v ) ? 4 * pi : 0;
	}
	planners::Path path{ other.size(), world.start };
	EXPECT_TRUE( planners::unwrap( checker.get(), other.data(), path ) );
	EXPECT_EQ( path.values, other );
	EXPECT_FALSE( planners::unwrap( checker.get(), other.data(), path ) ) << "it goes on already";
	path.values.back() += 0.5;
	const std::vector<double> elsewhere = path.values;
	planners::unwrap( checker.get(), other.data(), path );
	EXPECT_EQ( path.values, elsewhere ) << "a start of another path replaced the path's own";
}

/// A quaternion and its opposite are one rotation; with three opposite numbers it is another.
TEST( NativePlannerUnwrap, AQuaternionChangesSomeOfItsSigns )
{
	const World& world = worldOf( "Drone" );
	const leeway::Checker checker = world.make();
	std::vector<double> next = world.start;
	std::uint32_t opposite = 0;
	for ( std::uint32_t v = 0; v < next.size(); ++v )
	{
		const lw_variable_info info =
		    lw_robot_variable( lw_checker_robot( checker.get() ), lw_checker_variable( checker.get(), v ) );
		const bool turns = info.component >= 3;
		next[v] = turns ? -next[v] : next[v] + 0.01;
		opposite += turns;
	}
	ASSERT_EQ( opposite, 4u );
	planners::Path path{ next.size(), world.start };
	path.values.insert( path.values.end(), next.begin(), next.end() );
	EXPECT_TRUE( planners::unwrap( checker.get(), world.start.data(), path ) );
	for ( std::size_t v = 0; v < next.size(); ++v )
	{
		EXPECT_NEAR( path[1][v], world.start[v], 0.0101 ) << v;
	}
}

TEST( NativePlannerUnwrap, TheLastEdgeIsNotProved )
{
	const World& world = worldOf( "Arm" );
	const leeway::Checker checker = world.make();
	const leeway::Query query = leeway::makeQuery( checker.get() );
	SeededRng rng( 57 );
	std::vector<double> touching = world.start;
	bool is_free = true;
	while ( is_free )
	{
		for ( double& value : touching )
		{
			value = rng.uniform( -pi, pi );
		}
		ASSERT_EQ(
		    lw_checker_is_free( checker.get(), query.get(), touching.data(), LW_CHECK_BOTH, 0, &is_free, nullptr ), LW_OK );
	}
	planners::Path path{ touching.size(), world.start };
	path.values.insert( path.values.end(), world.start.begin(), world.start.end() );
	const lw_edge_def def = lw_edge_def_default();
	ASSERT_EQ( planners::areFree( checker.get(), query.get(), def, path, is_free, nullptr ), LW_OK );
	EXPECT_TRUE( is_free );
	path.values.insert( path.values.end(), touching.begin(), touching.end() );
	ASSERT_EQ( planners::areFree( checker.get(), query.get(), def, path, is_free, nullptr ), LW_OK );
	EXPECT_FALSE( is_free );
}

} // namespace
