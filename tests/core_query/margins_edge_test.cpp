// SPDX-License-Identifier: BSD-3-Clause
// Margins of pairs: edges, looked at densely.
#include "margins_world.hpp"

namespace
{

/// Group state at t.
State stateAt( const World& world, const State& a, const State& b, double t )
{
	State out( world.reference.size() );
	lw_robot_interpolate( world.robot.get(), world.full( a ).data(), world.full( b ).data(), t, out.data() );
	return world.part( out );
}

/// The least clearance that a look at some states of an edge finds.
double lookAt( const World& world, Oracle& oracle, const State& a, const State& b, double end, int steps )
{
	double least = inf;
	for ( int i = 0; i <= steps; ++i )
	{
		const Oracle::Answer truth = oracle.ask( stateAt( world, a, b, end * i / steps ) );
		least = std::min( { least, truth.environment, truth.self } );
	}
	return least;
}

struct EdgeTally
{
	int free = 0, blocked = 0, undecided = 0, partial = 0, nearly = 0;
};

void judgeEdge( const World& world, Oracle& oracle, const lw_checker* checker, lw_query* query, const State& a,
    const State& b, const lw_edge_def& def, EdgeTally& tally )
{
	lw_edge_result r;
	if ( lw_checker_edge( checker, query, a.data(), b.data(), &def, &r ) != LW_OK )
	{
		return; // a mimic joint without limits has no motion bound
	}
	SCOPED_TRACE( ::testing::Message() << lw_verdict_name( r.verdict ) << " at " << r.t << ", min_d " << def.min_d );
	const bool certified = def.method == LW_EDGE_CERTIFIED;
	if ( r.verdict == LW_VERDICT_FREE )
	{
		++tally.free;
		const double least = lookAt( world, oracle, a, b, 1, 40 );
		tally.nearly += least < def.min_d + 0.02;
		EXPECT_TRUE( !certified || least >= r.lower_bound - rounding ) << least << ' ' << r.lower_bound;
		EXPECT_TRUE( !certified || r.lower_bound > def.min_d );
		EXPECT_GT( certified ? least : std::min( lookAt( world, oracle, a, b, 1, 1 ), inf ), def.min_d - rounding );
		return;
	}
	oracle.ask( stateAt( world, a, b, r.t ) );
	const double pair = oracle.ofPair( r.self, r.pair.a, r.pair.b );
	const bool blocked = r.verdict == LW_VERDICT_BLOCKED;
	++( blocked ? tally.blocked : tally.undecided );
	EXPECT_LE( pair, ( blocked ? def.min_d : ( def.min_d + def.slack ) / ( 1 - def.alpha ) ) + rounding );
	EXPECT_TRUE( !blocked || r.pair.upper <= def.min_d );
	if ( r.proved_until > 0 && certified )
	{
		++tally.partial;
		EXPECT_GT( lookAt( world, oracle, a, b, r.proved_until, 20 ), def.min_d );
	}
}

} // namespace

TEST( Margins, EdgeEntersAMargin )
{
	SeededRng rng;
	EdgeTally tally;
	for ( int i = 0; i < 50 && !HasFailure(); ++i )
	{
		SCOPED_TRACE( ::testing::Message() << "world " << i );
		World world = randomWorld( rng, i % 2 == 0 );
		world.margins = randomMargins( rng, world );
		Oracle oracle( world );
		const CheckerPtr plain = world.build( nullptr, 1e9 ), tables = world.build( world.reach.get(), 0.2 );
		const QueryPtr one = makeQuery( plain.get() ), other = makeQuery( tables.get() );
		// from a state that is free, if there is one nearby
		State home = groupState( rng, world, 0 );
		for ( int k = 0; k < 30 && ask( plain.get(), one.get(), home, ranges[4] ).verdict != LW_VERDICT_FREE; ++k )
		{
			home = groupState( rng, world, 0 );
		}
		for ( int k = 0; k < 5 && !HasFailure(); ++k )
		{
			const State far = groupState( rng, world, 0 ), to = stateAt( world, home, far, rng.decade( -2, 0 ) );
			lw_edge_def def = lw_edge_def_default();
			def.method = k == 4 ? LW_EDGE_STEPS : LW_EDGE_CERTIFIED;
			def.max_d = 0.05;
			def.min_d = rng.integer( 0, 1 ) != 0 ? 0 : rng.decade( -3, -1 );
			def.slack = rng.decade( -4, -2 );
			def.want_proved_until = true;
			judgeEdge( world, oracle, plain.get(), one.get(), home, to, def, tally );
			judgeEdge( world, oracle, tables.get(), other.get(), home, to, def, tally );
		}
	}
	std::printf( "%d free, %d nearly not, %d blocked, %d undecided, %d proved in part\n", tally.free, tally.nearly,
	    tally.blocked, tally.undecided, tally.partial );
	EXPECT_GE( std::min( tally.free, tally.blocked ), 80 );
	EXPECT_GE( std::min( tally.partial, tally.nearly ), 10 );
}

/// Two links that turn against each other, proved apart by a grid of their joints: verdict and lower bound count the
/// margin.
TEST( Margins, EdgeByAGridEntersAMargin )
{
#ifndef LEEWAY_HULLS
	GTEST_SKIP() << "built without qhull";
#endif
	SeededRng rng;
	EdgeTally tally;
	int folds = 0;
	for ( int i = 0; i < 12 && !HasFailure(); ++i )
	{
		SCOPED_TRACE( ::testing::Message() << "world " << i );
		World world;
		world.model.link( "root" );
		for ( uint32_t k = 0; k < 2; ++k )
		{
			lw_joint_def& joint = world.model.joint( "l" + std::to_string( k ), LW_JOINT_REVOLUTE, k );
			joint.parent_from_joint.t[0] = k == 0 ? 0 : rng.uniform( 0.2, 0.4 );
			joint.axis[0] = rng.uniform( -0.1, 0.1 );
			joint.lower = -3.1;
			joint.upper = 3.1;
		}
		const double arm = world.model.joints[1].parent_from_joint.t[0];
		const double size[3] = { rng.uniform( 0.02, 0.05 ), 0, 0 };
		for ( uint32_t link : { 0u, 2u } )
		{
			lw_shape* shape = nullptr;
			ASSERT_EQ( LW_OK, lw_shape_create_primitive( LW_SHAPE_SPHERE, size, nullptr, nullptr, &shape ) );
			lw_transform at = lw_transform_identity();
			at.t[0] = link == 0 ? -0.05 : arm * rng.uniform( 0.8, 1 ); // it reaches the other one where the arm is folded
			world.model.body( link, shape, at );
		}
		world.robot = world.model.create();
		world.reference = { 0, 0 };
		world.group = { 0, 1 };
		world.margins.self = rng.uniform( 0.03, 0.1 ); // more than grids leave of a distance
		lw_reach_def def = lw_reach_def_default();
		def.robot = world.robot.get();
		def.seconds = 5; // ample: grids of one pair of two joints
		def.samples = 50;
		lw_reach* reach = nullptr;
		ASSERT_EQ( LW_OK, lw_reach_create( &def, nullptr, nullptr, &reach ) );
		world.reach.reset( reach );
		folds += lw_reach_get_pair( reach, 0, 2 ).separation == 0; // else tables prove all edges before a grid is asked
		Oracle oracle( world );
		const CheckerPtr tables = world.build( world.reach.get() );
		const QueryPtr query = makeQuery( tables.get() );
		for ( int k = 0; k < 40 && !HasFailure(); ++k )
		{
			const State from = groupState( rng, world, 0 );
			State to = stateAt( world, from, groupState( rng, world, 0 ), rng.decade( -2, 0 ) );
			if ( k % 2 == 0 )
			{
				// far by its path, and about as near all the way: the purpose of a grid
				to = { -from[0], std::clamp( from[1] + rng.uniform( -0.05, 0.05 ), -3.1, 3.1 ) };
			}
			lw_edge_def edge = lw_edge_def_default();
			judgeEdge( world, oracle, tables.get(), query.get(), from, to, edge, tally );
		}
	}
	EXPECT_GE( tally.free, 100 );
	EXPECT_GE( folds, 4 );
}
