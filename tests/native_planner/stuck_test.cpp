// SPDX-License-Identifier: BSD-3-Clause
// Reasons of a search that finds no path: pairs, free travel, enclosed ends, growth of the trees.
#include "planner_rig.hpp"

#include "blame.hpp"
#include "leeway/planners/planner.h"

namespace
{

using planners::Stuck;

/// A cube of 0.1 m on two rails, and boxes.
leeway::Checker gantryAmong( const std::vector<Obstacle>& boxes )
{
	return makeChecker( { slider( "rail x", 0, -1, 1 ), slider( "rail y", 1, -1, 1, makeBox( 0.1, 0.1, 0.1 ) ) }, boxes );
}

/// Walls around (x, y) that leave the cube 3 mm on each side.
std::vector<Obstacle> cellAt( double x, double y )
{
	const double gap = 0.003, side = 0.05 + gap + 0.01;
	return { { makeBox( 0.02, 0.3, 0.2 ), at( x - side, y, 0 ) }, { makeBox( 0.02, 0.3, 0.2 ), at( x + side, y, 0 ) },
	    { makeBox( 0.3, 0.02, 0.2 ), at( x, y - side, 0 ) }, { makeBox( 0.3, 0.02, 0.2 ), at( x, y + side, 0 ) } };
}

/// A search for so many nodes from (-0.8, -0.8) to (0.8, -0.8).
struct StuckProblem : Problem
{
	static planners::Settings few()
	{
		planners::Settings settings;
		settings.most_nodes = 200;
		return settings;
	}
	explicit StuckProblem( const std::vector<Obstacle>& boxes, const planners::Settings& settings = few() )
	    : Problem( gantryAmong( boxes ), settings )
	{
		const double start[] = { -0.8, -0.8 }, goal[] = { 0.8, -0.8 };
		planner.addStart( start );
		planner.addGoal( goal );
	}
	Stuck explain() { return planner.explain( query.get() ); }
};

/// A search ends on nodes or tries, never on time alone.
planners::Stop afterPolls( int& left )
{
	planners::Stop stop;
	stop.poll = []( void* user ) { return --*static_cast<int*>( user ) <= 0; };
	stop.user = &left;
	return stop;
}

TEST( NativeStuck, TheWallInTheWayIsNamed )
{
	StuckProblem problem( { { makeBox( 0.5, 3, 0.2 ), at( 0, 0, 0 ) } } );
	ASSERT_EQ( problem.solve(), Outcome::NODES_FULL );
	const planners::Statistics before = problem.planner.statistics();
	const Stuck stuck = problem.explain();
	ASSERT_EQ( stuck.pairs.size(), 1u );
	EXPECT_FALSE( stuck.pairs[0].self );
	EXPECT_EQ( stuck.pairs[0].b, 0u );
	EXPECT_EQ( stuck.pairs[0].blocked, before.blocked );
	EXPECT_EQ( stuck.pairs[0].undecided, before.undecided );
	EXPECT_LE( stuck.pairs[0].clearance, 0 );
	ASSERT_GE( stuck.not_free, before.blocked + before.undecided );
	const std::uint64_t states = stuck.not_free - before.blocked - before.undecided; // by looks, or one by one
	EXPECT_GE( states, before.states - before.states_free + before.passed_over );
	EXPECT_GT( states, 0u );
	EXPECT_NEAR( double( stuck.pairs[0].states ), double( states ), 0.02 * double( stuck.not_free ) );
	EXPECT_GE( stuck.gap, 0.6 ) << "wall and cube lie between the trees";
	EXPECT_LE( stuck.gap, 1.6 );
	EXPECT_EQ( stuck.trees[0].nodes + stuck.trees[1].nodes, before.start_nodes + before.goal_nodes );
	for ( const planners::TreeGrowth& tree : stuck.trees )
	{
		EXPECT_GT( tree.extent, 1.0 );
		EXPECT_LE( tree.extent, std::hypot( 0.5, 1.8 ) );
		EXPECT_LE( tree.grown, tree.tries );
	}
	EXPECT_EQ( stuck.trees[0].tries + stuck.trees[1].tries, before.samples );
	const std::string text = describe( problem.checker.get(), stuck );
	EXPECT_NE( text.find( "no tree is stuck" ), std::string::npos ) << text;
	EXPECT_LE( std::count( text.begin(), text.end(), '\n' ), 7 ) << text;
	EXPECT_NE( text.find( planners::pairName( problem.checker.get(), stuck.pairs[0] ) + " 100 %" ), std::string::npos )
	    << text;
}

TEST( NativeStuck, EnclosedEndsAreCalledSo )
{
	for ( const bool at_goal : { false, true } )
	{
		SCOPED_TRACE( at_goal );
		StuckProblem problem( cellAt( at_goal ? 0.8 : -0.8, -0.8 ) );
		int polls = 100;
		ASSERT_EQ( problem.solve( afterPolls( polls ) ), Outcome::CANCELLED );
		const Stuck stuck = problem.explain();
		ASSERT_EQ( stuck.ends[0].size(), 1u );
		ASSERT_EQ( stuck.ends[1].size(), 1u );
		EXPECT_EQ( stuck.ends[0][0].enclosed, !at_goal );
		EXPECT_EQ( stuck.ends[1][0].enclosed, at_goal );
		const planners::EndRoom& room = stuck.ends[at_goal][0];
		for ( int i = 0; i < 2; ++i )
		{
			EXPECT_NEAR( room.down[i], 0.003, 2e-4 );
			EXPECT_NEAR( room.up[i], 0.003, 2e-4 );
			EXPECT_LE( std::max( room.down[i], room.up[i] ), 0.003 );
		}
		EXPECT_EQ( stuck.trees[at_goal].nodes, 1u );
		const std::string text = describe( problem.checker.get(), stuck );
		const std::string name = at_goal ? "goal" : "start";
		EXPECT_NE( text.find( "the " + name + " tree is stuck" ), std::string::npos ) << text;
		EXPECT_NE( text.find( name + ": enclosed" ), std::string::npos ) << text;
		EXPECT_NE( text.find( "another " + name ), std::string::npos ) << text;
		EXPECT_EQ( text.find( at_goal ? "another start" : "another goal" ), std::string::npos ) << text;
	}
}

TEST( NativeStuck, FreeTravelEndsAtTheFirstStateThatIsNotFree )
{
	for ( const char* name : { "Gantry", "Arm", "Cart" } )
	{
		SCOPED_TRACE( name );
		const World& world = worldOf( name );
		planners::Settings settings;
		settings.most_nodes = 2;
		Problem problem( world, settings );
		ASSERT_EQ( problem.solve(), Outcome::NODES_FULL );
		const Stuck stuck = problem.planner.explain( problem.query.get() );
		int inside = 0;
		for ( unsigned side = 0; side < 2; ++side )
		{
			const std::vector<double>& end = side == 0 ? world.start : world.goal;
			for ( std::uint32_t i = 0; i < end.size(); ++i )
			{
				for ( const double sign : { -1.0, 1.0 } )
				{
					// by exact states at steps of a milliradian, up to the limit
					const lw_variable_info info = lw_robot_variable( lw_checker_robot( problem.checker.get() ), i );
					const double most = info.wraps ? 3.0 : sign > 0 ? info.upper - end[i] : end[i] - info.lower;
					std::vector<double> q = end;
					double travel = 0;
					for ( bool free = true; free && travel < most; travel = std::min( most, travel + 1e-3 ) )
					{
						q[i] = end[i] + sign * travel;
						ASSERT_EQ( lw_checker_is_free( problem.checker.get(), problem.query.get(), q.data(), LW_CHECK_BOTH,
						               0, &free, nullptr ),
						    LW_OK );
						if ( !free )
						{
							++inside;
							break;
						}
					}
					const planners::EndRoom& room = stuck.ends[side][0];
					const double measured = sign > 0 ? room.up[i] : room.down[i];
					EXPECT_LE( measured, travel + 1e-9 ) << side << ", variable " << i;
					EXPECT_GE( measured, travel - 0.02 ) << side << ", variable " << i;
				}
			}
		}
		EXPECT_GT( inside, 0 ) << "no joint meets anything before its limit";
	}
}

TEST( NativeStuck, ExplainingChangesNoSearch )
{
	const World& world = worldOf( "Arm" );
	Problem alone( world, planners::Settings() ), asked( world, planners::Settings() );
	ASSERT_EQ( alone.solve(), Outcome::SOLVED );
	int polls = 3;
	ASSERT_EQ( asked.solve( afterPolls( polls ) ), Outcome::CANCELLED );
	const Stuck first = asked.planner.explain( asked.query.get() ), again = asked.planner.explain( asked.query.get() );
	EXPECT_EQ( describe( asked.checker.get(), first ), describe( asked.checker.get(), again ) );
	ASSERT_EQ( asked.solve(), Outcome::SOLVED );
	Problem paused( world, planners::Settings() );
	polls = 3;
	ASSERT_EQ( paused.solve( afterPolls( polls ) ), Outcome::CANCELLED );
	ASSERT_EQ( paused.solve(), Outcome::SOLVED );
	EXPECT_EQ( asked.planner.path().values, paused.planner.path().values );
}

TEST( NativeStuck, PairsOfEndsThatAreNotFreeAreNamed )
{
	const World& world = worldOf( "Gantry" );
	Problem problem( world.make() );
	problem.planner.addStart( world.start.data() );
	problem.planner.addGoal( world.inside.data() );
	ASSERT_EQ( problem.solve(), Outcome::NO_GOAL );
	const Stuck stuck = problem.planner.explain( problem.query.get() );
	ASSERT_EQ( stuck.ends[1].size(), 1u );
	EXPECT_FALSE( stuck.ends[1][0].free );
	EXPECT_FALSE( stuck.ends[1][0].enclosed );
	EXPECT_EQ( stuck.ends[1][0].pair.count(), 1u );
	const std::string text = describe( problem.checker.get(), stuck );
	EXPECT_NE( text.find( "goal: not proved free: " ), std::string::npos ) << text;
	EXPECT_EQ( text.find( "trees" ), std::string::npos ) << "there is one tree: " << text;
	Problem nothing( world.make() ); // no ends, no search
	EXPECT_EQ( describe( problem.checker.get(), nothing.planner.explain( nothing.query.get() ) ), "" );
}

TEST( NativeStuck, TheCStructHasTheSame )
{
	const leeway::Checker checker = gantryAmong( cellAt( -0.8, -0.8 ) );
	const double start[] = { -0.8, -0.8 }, goal[] = { 0.8, -0.8 };
	lw_plan_def def = lw_plan_def_default();
	def.checker = checker.get();
	def.starts = start;
	def.goals = goal;
	def.start_count = def.goal_count = 1;
	def.seconds = 0.05;
	lw_plan_result result;
	ASSERT_EQ( lw_plan( &def, nullptr, &result ), LW_OK );
	ASSERT_EQ( result.outcome, LW_PLAN_TIMED_OUT );
	EXPECT_TRUE( result.stuck.enclosed[0] );
	EXPECT_FALSE( result.stuck.enclosed[1] );
	ASSERT_NE( result.stuck.travel, nullptr );
	for ( int i = 0; i < 4; ++i )
	{
		EXPECT_NEAR( result.stuck.travel[i], 0.003, 2e-4 ) << "of the start";
		EXPECT_GT( result.stuck.travel[4 + i], 0.19 ) << "of the goal";
	}
	ASSERT_EQ( result.stuck.pair_count, 4u );
	EXPECT_GE( result.stuck.pairs[0].states + result.stuck.pairs[0].blocked, result.stuck.pairs[3].states );
	EXPECT_EQ( result.stuck.trees[0].nodes, 1u );
	EXPECT_NE( std::string( result.message ).find( "start: enclosed" ), std::string::npos ) << result.message;
	lw_plan_result_clear( &result );
	EXPECT_EQ( result.stuck.travel, nullptr );
	def.explain = false;
	ASSERT_EQ( lw_plan( &def, nullptr, &result ), LW_OK );
	EXPECT_EQ( result.stuck.travel, nullptr );
	EXPECT_EQ( result.stuck.pair_count, 0u );
	lw_plan_result_clear( &result );
}

TEST( NativeBlame, KeptStatesAreSpreadOverTheSearch )
{
	for ( const int count : { 1, 255, 256, 257, 1000, 100000 } )
	{
		planners::Blame blame( 1 );
		for ( int i = 0; i < count; ++i )
		{
			const double q = i;
			blame.state( &q );
		}
		EXPECT_EQ( blame.count(), std::uint64_t( count ) );
		const std::size_t kept = blame.keptCount();
		EXPECT_LT( kept, 256u );
		EXPECT_GE( kept, std::min<std::size_t>( count, 128 ) );
		for ( std::size_t i = 0; i < kept; ++i )
		{
			EXPECT_EQ( *blame.kept( i ), double( i * blame.stride() ) );
		}
		EXPECT_GE( kept * blame.stride(), std::uint64_t( count ) );
		EXPECT_LT( ( kept - 1 ) * blame.stride(), std::uint64_t( count ) );
	}
}

} // namespace
