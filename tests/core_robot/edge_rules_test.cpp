// SPDX-License-Identifier: BSD-3-Clause
// Rules of edges: ends agree with states, steps keep their promise, bad input never reads as free, answers repeat.
#include "edge_model.hpp"
#include "motion/edge.h"

// A link that no joint of the group moves and that touches the scene makes every edge impossible, at t = 0.
TEST( Edge, StaticBodiesCount )
{
	for ( double gap : { 0.0015, -0.05 } )
	{
		World world;
		world.model.link( "rail" );
		world.model.joint( "ball", LW_JOINT_PRISMATIC, 0 );
		world.model.body( 0, primitive( LW_SHAPE_SPHERE, 0.1, 0, 0 ), lw_transform_identity() );
		world.model.body( 1, primitive( LW_SHAPE_SPHERE, 0.1, 0, 0 ), at( 2, 0, 0 ) );
		world.object( primitive( LW_SHAPE_BOX, 1, 1, 1 ), at( 0, 0, -0.6 - gap ) );
		world.open();
		lw_edge_def def = lw_edge_def_default();
		def.want_proved_until = true;
		lw_edge_result r = world.edge( { 0 }, { 0.5 }, def );
		EXPECT_EQ( r.verdict, gap > 0 ? LW_VERDICT_FREE : LW_VERDICT_BLOCKED );
		if ( gap > 0 )
		{
			EXPECT_LE( r.lower_bound, gap );
		}
		else
		{
			EXPECT_EQ( r.t, 0 );
			EXPECT_EQ( r.proved_until, 0 );
			EXPECT_EQ( r.pair.a, 0u );
			EXPECT_EQ( r.pair.b, 0u );
			EXPECT_FALSE( r.self );
		}
		def.flags = LW_CHECK_SELF;
		EXPECT_EQ( world.edge( { 0 }, { 0.5 }, def ).verdict, LW_VERDICT_FREE );
		def.method = LW_EDGE_STEPS;
		def.flags = LW_CHECK_ENVIRONMENT;
		EXPECT_EQ( world.edge( { 0 }, { 0.5 }, def ).verdict, gap > 0 ? LW_VERDICT_FREE : LW_VERDICT_BLOCKED );
	}
}

// The sample of an end is the given state: no edge into a violation of lw_checker_state survives.
TEST( Edge, EndsAgreeWithStates )
{
	SeededRng rng;
	int blockedEnds = 0;
	for ( int i = 0; i < 120; ++i )
	{
		World world;
		State start;
		randomWorld( rng, world, &start );
		for ( int k = 0; k < 4; ++k )
		{
			State end = randomEnd( rng, world, start );
			lw_state_result state;
			ASSERT_EQ(
			    lw_checker_state( world.checker, world.query, end.data(), LW_CHECK_BOTH, nullptr, false, &state ), LW_OK );
			for ( lw_edge_method method : { LW_EDGE_CERTIFIED, LW_EDGE_STEPS } )
			{
				lw_edge_def def = lw_edge_def_default();
				def.method = method;
				lw_edge_result r = world.edge( start, end, def );
				if ( state.verdict == LW_VERDICT_BLOCKED )
				{
					++blockedEnds;
					EXPECT_EQ( r.verdict, LW_VERDICT_BLOCKED );
					EXPECT_TRUE( r.t == 1 || method == LW_EDGE_CERTIFIED ) << "proofs may find another one first";
				}
			}
		}
	}
	EXPECT_GE( blockedEnds, 60 );
}

// Planners ask about motions to where they are; a clearance just above min_d is no reason to refuse that one.
TEST( Edge, EdgeWithoutLengthIsNotItsState )
{
	SeededRng rng;
	int freeOnes = 0, blockedOnes = 0;
	for ( int i = 0; i < 150; ++i )
	{
		World world;
		State start;
		randomWorld( rng, world, &start );
		lw_state_result state;
		ASSERT_EQ(
		    lw_checker_state( world.checker, world.query, start.data(), LW_CHECK_BOTH, nullptr, false, &state ), LW_OK );
		const double clearance = std::min( state.environment.upper, state.self.upper );
		if ( state.verdict != LW_VERDICT_FREE || !( clearance > 1e-3 && clearance < INFINITY ) )
		{
			continue;
		}
		for ( int k = 0; k < 6; ++k )
		{
			lw_edge_def def = lw_edge_def_default();
			def.alpha = k % 2 == 0 ? 0.1 : 0.9;
			const double off = rng.decade( -7, -0.5 ); // within the slack and alpha, mostly
			def.min_d = clearance * ( 1 - off );
			const lw_edge_result r = world.edge( start, start, def );
			EXPECT_EQ( r.verdict, LW_VERDICT_FREE ) << clearance << ", " << off << " of it more than min_d";
			EXPECT_GE( r.lower_bound, def.min_d );
			EXPECT_LE( r.lower_bound, clearance * ( 1 + 1e-9 ) );
			freeOnes += r.verdict == LW_VERDICT_FREE;
			def.min_d = clearance * ( 1 + off );
			blockedOnes += world.edge( start, start, def ).verdict == LW_VERDICT_BLOCKED;
		}
	}
	EXPECT_GE( freeOnes, 200 );
	EXPECT_EQ( blockedOnes, freeOnes );
}

// Between two steps no point moves more than max_d, so with min_d >= max_d / 2 the environment is really free of contact,
// with min_d >= max_d the robot is of itself.
TEST( Edge, StepsKeepTheirPromise )
{
	SeededRng rng;
	int verdicts[4] = {}, partial = 0;
	for ( int i = 0; i < 120; ++i )
	{
		World world;
		State start;
		randomWorld( rng, world, &start );
		for ( int k = 0; k < 3; ++k )
		{
			lw_edge_def def = lw_edge_def_default();
			def.method = LW_EDGE_STEPS;
			def.max_d = rng.decade( -3, -1.5 );
			def.flags = rng.integer( 0, 1 ) ? LW_CHECK_ENVIRONMENT : LW_CHECK_BOTH;
			def.min_d = def.flags == LW_CHECK_ENVIRONMENT ? def.max_d / 2 : def.max_d;
			def.want_proved_until = true;
			State end = randomEnd( rng, world, start );
			lw_edge_result r = world.edge( start, end, def );
			++verdicts[r.verdict];
			if ( r.verdict == LW_VERDICT_FREE )
			{
				EXPECT_EQ( r.t, 1 );
				EXPECT_EQ( r.proved_until, 1 );
				for ( int n = 0; n < 40; ++n )
				{
					EXPECT_GT( world.clearanceAt( start, end, rng.uniform( 0, 1 ), def.flags ), 0 );
				}
				continue;
			}
			double there =
			    world.clearanceAt( start, end, r.t, r.self ? LW_CHECK_SELF : LW_CHECK_ENVIRONMENT, r.pair.a, r.pair.b );
			EXPECT_LE( there, def.min_d + 1e-10 );
			EXPECT_TRUE( r.proved_until < r.t || r.t == 0 );
			partial += r.proved_until > 0 ? 1 : 0;
			if ( r.proved_until > 0 )
			{
				EXPECT_GT( world.clearanceAt( start, end, r.proved_until, def.flags ), def.min_d );
			}
		}
	}
	std::printf( "FREE %d BLOCKED %d UNDECIDED %d, partly free %d\n", verdicts[1], verdicts[2], verdicts[3], partial );
	EXPECT_GE( verdicts[LW_VERDICT_FREE], 60 );
	EXPECT_GE( verdicts[LW_VERDICT_BLOCKED], 60 );
	EXPECT_GE( partial, 30 );
}

TEST( Edge, StepsVisitEachStateOnce )
{
	World world;
	slider( world, 0.5 );
	lw_edge_def def = lw_edge_def_default();
	def.method = LW_EDGE_STEPS;
	for ( int n : { 1, 2, 3, 7, 8, 100 } )
	{
		def.max_d = 1.0 / n * ( 1 + 1e-9 );
		EXPECT_EQ( world.edge( { -0.5 }, { 0.5 }, def ).queries, static_cast<std::uint32_t>( n + 1 ) );
	}
	def.max_d = 1e-12;
	const lw_edge_result r = world.edge( { -0.5 }, { 0.5 }, def ); // the step is absurdly small for this edge
	EXPECT_EQ( r.verdict, LW_VERDICT_UNDECIDED );
	EXPECT_EQ( r.pair.kind, LW_CLEARANCE_UNKNOWN );
}

TEST( Edge, BadInputNeverReadsAsFree )
{
	World world;
	slider( world, 1 );
	State a = { 0 }, b = { 0.5 };
	lw_edge_result r;
	auto refused = [&]( const lw_edge_def& def, lw_status expected )
	{
		std::memset( static_cast<void*>( &r ), 0x11, sizeof( r ) );
		EXPECT_EQ( lw_checker_edge( world.checker, world.query, a.data(), b.data(), &def, &r ), expected );
		EXPECT_EQ( r.verdict, LW_VERDICT_UNKNOWN );
		EXPECT_EQ( r.proved_until, 0 );
		EXPECT_EQ( r.lower_bound, 0 );
		EXPECT_EQ( r.pair.lower, 0 );
		EXPECT_EQ( r.pair.upper, INFINITY );
	};
	const double nan = std::nan( "" );
	for ( lw_edge_method method : { LW_EDGE_CERTIFIED, LW_EDGE_STEPS } )
	{
		lw_edge_def good = lw_edge_def_default();
		good.method = method;
		EXPECT_EQ( world.edge( a, b, good ).verdict, LW_VERDICT_FREE );
		for ( double bad : std::initializer_list<double>{ nan, INFINITY, -INFINITY } )
		{
			a[0] = bad;
			refused( good, LW_ERROR_INVALID_ARGUMENT );
			a[0] = 0;
			b[0] = bad;
			refused( good, LW_ERROR_INVALID_ARGUMENT );
			b[0] = 0.5;
		}
		a[0] = -1.7e308;
		b[0] = 1.7e308;
		refused( good, LW_ERROR_INVALID_ARGUMENT ); // longer than doubles can say
		a[0] = 0;
		b[0] = 0.5;
		for ( double bad : std::initializer_list<double>{ nan, INFINITY, -1.0 } )
		{
			lw_edge_def def = good;
			def.min_d = bad;
			refused( def, LW_ERROR_INVALID_ARGUMENT );
			def = good;
			( method == LW_EDGE_STEPS ? def.max_d : def.slack ) = bad;
			refused( def, LW_ERROR_INVALID_ARGUMENT );
			def = good;
			def.alpha = bad == INFINITY ? 1 : bad;
			refused( def, LW_ERROR_INVALID_ARGUMENT );
		}
		lw_edge_def def = good;
		def.cookie = 0;
		refused( def, LW_ERROR_INVALID_DEF );
		def = good;
		def.flags = static_cast<lw_check_flags>( 0 );
		refused( def, LW_ERROR_INVALID_ARGUMENT );
	}
	lw_edge_def def = lw_edge_def_default();
	lw_query_def queryDef = lw_query_def_default();
	lw_query* small = nullptr;
	ASSERT_EQ( lw_query_create( &queryDef, nullptr, nullptr, nullptr, &small ), LW_OK );
	EXPECT_EQ( lw_checker_edge( world.checker, small, a.data(), b.data(), &def, &r ), LW_ERROR_INVALID_ARGUMENT );
	lw_query_destroy( small );
}

// Same question, same query history: the same bits, whatever ran before on another query.
TEST( Edge, RepeatsBitForBit )
{
	SeededRng rng;
	for ( int i = 0; i < 30; ++i )
	{
		World world;
		State start;
		randomWorld( rng, world, &start );
		State end = randomEnd( rng, world, start );
		lw_edge_def def = lw_edge_def_default();
		def.want_proved_until = true;
		lw_query_reset( world.query );
		lw_edge_result first = world.edge( start, end, def );
		lw_query_reset( world.query );
		lw_edge_result second = world.edge( start, end, def );
		EXPECT_EQ( first.verdict, second.verdict );
		EXPECT_EQ( first.t, second.t );
		EXPECT_EQ( first.proved_until, second.proved_until );
		EXPECT_EQ( first.lower_bound, second.lower_bound );
		EXPECT_EQ( first.queries, second.queries );
		EXPECT_EQ( first.pair.upper, second.pair.upper );
	}
}

// A rod above a field of 4,761 cubes, more than the gate has places for: one of them stands in its way, or none.
TEST( Edge, ObstaclesBeyondTheGatesListAreForgotten )
{
	constexpr int rows = 69;
	static_assert( rows * rows > LWI_EDGE_OBSTACLES );
	for ( const bool stands : { false, true } )
	{
		World world;
		world.model.link( "rail" );
		lw_joint_def& slide = world.model.joint( "rod", LW_JOINT_PRISMATIC, 0 );
		slide.axis[1] = 1;
		slide.axis[2] = 0;
		world.model.body( 1, primitive( LW_SHAPE_BOX, 2, 0.02, 0.02 ), lw_transform_identity() );
		for ( int i = 0; i < rows * rows; ++i )
		{
			const bool is_last = i == rows * rows - 1;
			world.object( primitive( LW_SHAPE_BOX, 0.005, 0.005, 0.005 ),
			    at( 0.01 * ( i % rows - rows / 2 ), 0.01 * ( i / rows - rows / 2 ), is_last && stands ? 0 : -0.03 ) );
		}
		world.open();
		const lw_edge_result r = world.edge( { 0 }, { 0.5 }, lw_edge_def_default() );
		EXPECT_EQ( r.verdict, stands ? LW_VERDICT_BLOCKED : LW_VERDICT_FREE );
		EXPECT_TRUE( stands || ( r.lower_bound > 0 && r.lower_bound <= 0.03 - 0.0125 ) ) << r.lower_bound;
	}
}
