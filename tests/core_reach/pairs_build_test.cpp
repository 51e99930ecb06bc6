// SPDX-License-Identifier: BSD-3-Clause
// The build of pairs: repeated, on threads, interrupted and continued, without memory.
#include "pair_world.hpp"
#include "wild_threads.hpp"

TEST( ReachPairs, WithoutATimeBudgetTheBuildRepeats )
{
	SeededRng rng;
	for ( int round = 0; round < 4; ++round )
	{
		RobotPtr robot = randomSparseRobot( rng, true );
		ReachPtr first = makeReach( robot.get(), 0 ), second = makeReach( robot.get(), 0 );
		std::uint32_t count = lw_robot_link_count( robot.get() );
		State q1( lw_robot_variable_count( robot.get() ) ), q2 = q1;
		for ( std::uint32_t a = 0; a < count; ++a )
		{
			for ( std::uint32_t b = 0; b < a; ++b )
			{
				lw_reach_pair x = pairOf( first, a, b ), y = pairOf( second, a, b );
				EXPECT_EQ( x.kind, y.kind );
				EXPECT_EQ( x.separation, y.separation );
				EXPECT_EQ( x.closest, y.closest );
				EXPECT_EQ( x.contact_share, y.contact_share );
				EXPECT_NE( x.proof, LW_PROOF_SUBDIVISION );
				EXPECT_EQ( lw_reach_closest_state( first.get(), a, b, q1.data() ),
				    lw_reach_closest_state( second.get(), a, b, q2.data() ) );
				EXPECT_EQ( q1, q2 );
			}
		}
	}
}

// Threads that share random streams, queries or "closest so far" give tables that nobody can repeat.
TEST( ReachPairs, ThreadsChangeNothing )
{
	SeededRng rng;
	int runs = 0;
	for ( int round = 0; round < 4; ++round )
	{
		RobotPtr robot = randomSparseRobot( rng, true );
		ReachPtr alone = makeReach( robot.get(), 0 );
		lw_reach_def def = lw_reach_def_default();
		def.robot = robot.get();
		def.seconds = 0;
		def.samples = 200;
		def.parallel = runOnThreads;
		def.parallel_user = &runs;
		lw_reach* made = nullptr;
		ASSERT_EQ( lw_reach_create( &def, nullptr, nullptr, &made ), LW_OK );
		ReachPtr threaded( made );
		for ( std::uint32_t a = 0; a < lw_robot_link_count( robot.get() ); ++a )
		{
			EXPECT_EQ( lw_reach_get_node( alone.get(), a ).m.radius, lw_reach_get_node( threaded.get(), a ).m.radius );
			for ( std::uint32_t b = 0; b < a; ++b )
			{
				lw_reach_pair x = pairOf( alone, a, b ), y = pairOf( threaded, a, b );
				EXPECT_EQ( x.kind, y.kind );
				EXPECT_EQ( x.separation, y.separation );
				EXPECT_EQ( x.closest, y.closest );
				EXPECT_EQ( x.contact_share, y.contact_share );
			}
		}
	}
	EXPECT_GT( runs, 0 );
}

lw_reach* continued(
    const lw_reach* reach, double seconds, const lw_allocator* allocator = nullptr, std::uint32_t samples = 200 )
{
	lw_reach_def def = lw_reach_def_default();
	def.seconds = seconds;
	def.samples = samples;
	lw_reach* more = nullptr;
	lw_diag diag = {};
	lw_status status = lw_reach_continue( reach, &def, allocator, &diag, &more );
	EXPECT_TRUE( status == LW_OK || ( allocator != nullptr && status == LW_ERROR_OUT_OF_MEMORY ) ) << diag.message;
	return more;
}

// A run that begins anew each time never ends; one that forgets its proofs is worse than none.
TEST( ReachPairs, ManyShortRunsProveAsMuchAsALongOne )
{
	SeededRng rng;
	int runs = 0, proved = 0, by_subdivision = 0;
	for ( int round = 0; round < 6; ++round )
	{
		RobotPtr robot = round == 0 ? PlanarArm( 1.5, 2.6 ).model.create() : randomSparseRobot( rng, round % 2 == 0 );
		ReachPtr reach = makeReach( robot.get(), 1e-9, 200 );
		for ( int run = 0; run < 400 && !lw_reach_get_info( reach.get() ).complete; ++run, ++runs )
		{
			// the first end before all random states are measured
			ReachPtr more( continued( reach.get(), run < 40 ? 1e-5 : 0.02 ) );
			ASSERT_NE( more, nullptr );
			for ( std::uint32_t a = 0; a < lw_robot_link_count( robot.get() ); ++a )
			{
				for ( std::uint32_t b = 0; b < a; ++b )
				{
					lw_reach_pair before = pairOf( reach, a, b ), after = pairOf( more, a, b );
					EXPECT_GE( after.separation, std::min( before.separation, after.closest ) );
					EXPECT_LE( after.closest, before.closest * ( 1 + 1e-12 ) );
				}
			}
			EXPECT_GE( lw_reach_get_info( more.get() ).samples, lw_reach_get_info( reach.get() ).samples );
			EXPECT_GE( lw_reach_get_info( more.get() ).seconds, lw_reach_get_info( reach.get() ).seconds );
			reach = std::move( more );
		}
		const lw_reach_info info = lw_reach_get_info( reach.get() );
		EXPECT_EQ( info.pairs, info.proved + info.contact + info.unprovable + info.open );
		PairAttacker attacker( reach.get(), rng.engine()() );
		for ( std::uint32_t a = 0; a < lw_robot_link_count( robot.get() ); ++a )
		{
			for ( std::uint32_t b = 0; b < a; ++b )
			{
				lw_reach_pair pair = pairOf( reach, a, b );
				proved += pair.separation > 0;
				by_subdivision += pair.proof == LW_PROOF_SUBDIVISION;
				if ( pair.separation > 0 )
				{
					EXPECT_GE( attacker.attack( a, b, 60, 120 ), pair.separation - ROUNDING )
					    << round << ": " << a << ' ' << b;
				}
			}
		}
		if ( round == 0 )
		{
			EXPECT_TRUE( info.complete );
			EXPECT_GE( pairOf( reach, 0, 2 ).separation, 0.7 * PlanarArm::truth( 1.5, 2.6 ) );
		}
	}
	std::printf( "%d runs, %d proved, %d of them by subdivision\n", runs, proved, by_subdivision );
	EXPECT_GE( proved, 25 );
	EXPECT_GE( by_subdivision, 3 );
}

// A cell that is lost when a proof is interrupted is a part of the box that nobody looked at.
TEST( ReachPairs, NoCellIsLostWhenAProofIsInterrupted )
{
	RobotPtr robot = PlanarArm( 1.5, 2.6 ).model.create();
	ReachPtr reach = makeReach( robot.get(), 0, 10 );
	int open = 0;
	for ( std::uint64_t budget : { 10u, 57u, 200u, 333u } )
	{
		double whole = 0, in_parts = 0;
		const std::uint32_t height = openCells( reach.get(), 2, 0, budget, budget, &whole );
		EXPECT_EQ( openCells( reach.get(), 2, 0, budget, 7, &in_parts ), height ) << budget;
		EXPECT_EQ( in_parts, whole ) << budget;
		open += height > 1;
	}
	EXPECT_GE( open, 2 ) << "the proof is too easy";
}

TEST( ReachPairs, GoingOnRefusesAnotherRobotAndKeepsTheReachWhenMemoryEnds )
{
	RobotPtr robot = PlanarArm( 1.5, 2.6 ).model.create(), other = PlanarArm( 1, 1 ).model.create();
	ReachPtr reach = makeReach( robot.get(), 0.02, 20 );
	lw_reach_def def = lw_reach_def_default();
	def.robot = other.get();
	lw_reach* more = nullptr;
	lw_diag diag = {};
	EXPECT_EQ( lw_reach_continue( reach.get(), &def, nullptr, &diag, &more ), LW_ERROR_INVALID_ARGUMENT );
	EXPECT_NE( std::string( diag.message ).find( "another one" ), std::string::npos );
	EXPECT_EQ( lw_reach_continue( nullptr, &def, nullptr, &diag, &more ), LW_ERROR_INVALID_ARGUMENT );
	def.robot = nullptr;
	EXPECT_EQ( lw_reach_create( &def, nullptr, &diag, &more ), LW_ERROR_INVALID_ARGUMENT );
	std::size_t failures = 0;
	for ( bool done = false; !done; )
	{
		FailingAllocator memory;
		memory.fail_at = ++failures;
		more = continued( reach.get(), 0.01, &memory.allocator, 40 );
		done = more != nullptr;
		lw_reach_release( more );
		ASSERT_EQ( memory.live, 0u ) << "failing at call " << failures;
		ASSERT_LT( failures, 10000u );
	}
	EXPECT_GE( failures, 10u );
}

TEST( ReachPairs, GivingUpIsReported )
{
	RobotPtr robot = PlanarArm( 1.5, 2.6 ).model.create(); // 17 mm apart: too near for hulls
	for ( const char* when : { "samples", "hulls of pairs", "search for contact", "grids and proofs" } )
	{
		lw_reach_def def = lw_reach_def_default();
		def.robot = robot.get();
		def.seconds = 1;
		def.progress_user = const_cast<char*>( when );
		def.progress = []( void* user, const char* stage, double share )
		{
			EXPECT_TRUE( share >= 0 && share <= 1 );
			return std::string( stage ) != static_cast<const char*>( user );
		};
		lw_reach* reach = nullptr;
		lw_diag diag = {};
		lw_status status = lw_reach_create( &def, nullptr, &diag, &reach );
		EXPECT_EQ( status, LW_ERROR_CANCELLED ) << when;
		EXPECT_EQ( reach, nullptr );
		lw_reach_release( reach );
	}
}

TEST( ReachPairs, RobotsWithNothingToMeasure )
{
	RobotModel bare;
	bare.link( "base" );
	addJoint( bare, "arm", LW_JOINT_REVOLUTE, 0, 1, -1, 1 );
	RobotPtr robot = bare.create();
	ReachPtr reach = makeReach( robot.get(), 0.2 );
	ASSERT_NE( reach, nullptr );
	EXPECT_EQ( lw_reach_get_pair( reach.get(), 0, 1 ).kind, LW_PAIR_NONE );
	double q[1];
	EXPECT_FALSE( lw_reach_closest_state( reach.get(), 0, 1, q ) );

	RobotModel rigid;
	rigid.link( "base" );
	addBall( rigid, 0, 0.1 );
	addJoint( rigid, "plate", LW_JOINT_FIXED, 0, 1, 0, 0 );
	addBall( rigid, 1, 0.1 );
	robot = rigid.create();
	reach = makeReach( robot.get(), 0.2 );
	ASSERT_NE( reach, nullptr );
	EXPECT_EQ( lw_reach_get_pair( reach.get(), 0, 1 ).kind, LW_PAIR_RIGID );
}

TEST( ReachPairs, EveryFailingAllocationIsReportedAndNothingLeaks )
{
	RobotPtr robot = PlanarArm( 1, 1 ).model.create();
	lw_reach_def def = lw_reach_def_default();
	def.robot = robot.get();
	def.samples = 5;
	def.hull_error = 0.2; // small hulls: the loop below makes many
	def.seconds = 0.01;
	std::size_t failures = 0;
	for ( lw_status status = LW_ERROR_OUT_OF_MEMORY; status != LW_OK; )
	{
		FailingAllocator memory;
		memory.fail_at = ++failures;
		lw_reach* reach = nullptr;
		status = lw_reach_create( &def, &memory.allocator, nullptr, &reach );
		EXPECT_TRUE( status == LW_OK || ( status == LW_ERROR_OUT_OF_MEMORY && reach == nullptr ) ) << failures;
		lw_reach_release( reach );
		ASSERT_EQ( memory.live, 0u ) << "failing at call " << failures;
		ASSERT_LT( failures, 10000u );
	}
	std::printf( "%zu allocations\n", failures - 1 );
	EXPECT_GE( failures, 10u );
}
