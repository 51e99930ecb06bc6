// SPDX-License-Identifier: BSD-3-Clause
// Margins of pairs: states. Random robots, scenes, groups and margins; inside and outside of the limits, and after edits.
#include "margins_world.hpp"

namespace
{

struct Tally
{
	int near = 0, far = 0, violated = 0, inside = 0, by_margin = 0;
};

void judgeState( const World& world, Oracle& oracle, const std::vector<std::pair<const lw_checker*, lw_query*>>& all,
    const State& q, Tally& tally )
{
	const Oracle::Answer truth = oracle.ask( q );
	tally.inside += truth.inside;
	tally.by_margin += truth.by_margin;
	const lw_checker_info info = lw_checker_get_info( all[0].first );
	for ( const lw_range& range : ranges )
	{
		const double least = std::min( truth.environment, truth.self );
		lw_state_result first = {};
		for ( const auto& [checker, query] : all )
		{
			const lw_state_result got = ask( checker, query, q, range );
			judge( got.environment, truth.environment, range, -info.environment_margin, "environment" );
			judge( got.self, truth.self, range, -info.self_margin, "self" );
			judgeWitness( world, checker, got.environment, false );
			judgeWitness( world, checker, got.self, true );
			if ( std::abs( least - range.min_d ) > rounding )
			{
				const lw_verdict want = least > range.min_d ? LW_VERDICT_FREE : LW_VERDICT_BLOCKED;
				EXPECT_EQ( got.verdict, want );
				EXPECT_EQ( ask( checker, query, q, range, true ).verdict, want );
			}
			if ( checker == all[0].first )
			{
				first = got;
				tally.near += got.environment.kind == LW_CLEARANCE_NEAR;
				tally.far += got.environment.kind == LW_CLEARANCE_FAR;
				tally.violated += got.environment.kind == LW_CLEARANCE_VIOLATION;
			}
			else if ( range.alpha == 0 )
			{
				expectSame( first.environment, got.environment, "environment" );
				expectSame( first.self, got.self, "self" );
			}
		}
	}
}

} // namespace

TEST( Margins, StateIsNotDistanceLessMargin )
{
	SeededRng rng;
	Tally tally;
	for ( int i = 0; i < 50 && !HasFailure(); ++i )
	{
		SCOPED_TRACE( ::testing::Message() << "world " << i );
		World world = randomWorld( rng, i % 2 == 0 );
		world.margins = randomMargins( rng, world );
		Oracle oracle( world );
		// without a reach; with tables if there are any; with obstacles passed over
		const CheckerPtr plain = world.build( nullptr, 1e9 ), tables = world.build( world.reach.get(), 1e9 ),
		                 less = world.build( world.reach.get(), i % 3 == 0 ? inf : 0.1 );
		const QueryPtr queries[] = { makeQuery( plain.get(), false ), makeQuery( tables.get() ),
		    makeQueryWithoutReach( tables.get() ), makeQuery( less.get() ), makeQuery( less.get(), false ) };
		const std::vector<std::pair<const lw_checker*, lw_query*>> all = { { plain.get(), queries[0].get() },
		    { tables.get(), queries[1].get() }, { tables.get(), queries[2].get() }, { less.get(), queries[3].get() },
		    { less.get(), queries[4].get() } };
		for ( int k = 0; k < 12 && !HasFailure(); ++k )
		{
			SCOPED_TRACE( ::testing::Message() << "state " << k );
			judgeState( world, oracle, all, groupState( rng, world, k % 4 == 3 ? 1.5 : 0 ), tally );
		}
	}
	std::printf( "%d near, %d far, %d violated; %d inside of a margin, %d nearest by their margin\n", tally.near, tally.far,
	    tally.violated, tally.inside, tally.by_margin );
	EXPECT_GE( std::min( { tally.near, tally.far, tally.violated } ), 100 );
	EXPECT_GE( tally.inside, 50 );
	EXPECT_GE( tally.by_margin, 50 );
}

namespace
{

/// A chain of boxes that can hardly bend, so that spheres and tables rule out whole parts of it; few of its links have a
/// margin, and that is large.
World stiffWorld( SeededRng& rng )
{
	World world;
	const double box[3] = { 0.1, 0.1, 0.1 };
	const uint32_t links = 7;
	for ( uint32_t i = 0; i < links; ++i )
	{
		if ( i == 0 )
		{
			world.model.link( "base" );
		}
		else
		{
			lw_joint_def& joint = world.model.joint( "l" + std::to_string( i ), LW_JOINT_REVOLUTE, i - 1 );
			joint.parent_from_joint.t[0] = 0.4;
			joint.lower = -0.1;
			joint.upper = 0.1;
		}
		lw_shape* shape = nullptr;
		EXPECT_EQ( LW_OK, lw_shape_create_primitive( LW_SHAPE_BOX, box, nullptr, nullptr, &shape ) );
		world.model.body( i, shape, lw_transform_identity() );
	}
	world.robot = world.model.create();
	world.reach = makeReach( world.robot.get() );
	world.reference = State( links - 1, 0 );
	for ( uint32_t i = 0; i + 1 < links; ++i )
	{
		world.group.push_back( i );
	}
	world.objects = 3;
	for ( uint32_t i = 0; i < world.objects; ++i )
	{
		world.shapes.emplace_back( randomPrimitive( rng, 0.1, nullptr ) );
		lw_transform at = randomTransform( rng, 0 );
		at.t[0] = rng.uniform( 0, 2.4 );
		at.t[1] = rng.uniform( 0.3, 1.2 );
		world.placed.push_back( { world.shapes.back().get(), i, at } );
	}
	createScene( world );
	Margins& m = world.margins;
	m.link.assign( links, 0 );
	m.link[static_cast<std::size_t>( rng.integer( 0, links - 1 ) )] = rng.uniform( 0.2, 1 );
	const uint32_t a = static_cast<uint32_t>( rng.integer( 0, 3 ) ),
	               b = static_cast<uint32_t>( rng.integer( 4, links - 1 ) );
	m.self_pairs[{ a, b }] = rng.uniform( 0.6, 1.2 ) * 0.4 * ( b - a );
	if ( rng.integer( 0, 1 ) != 0 )
	{
		m.pairs[{ b, 1 }] = rng.uniform( 0.2, 1 );
	}
	return world;
}

} // namespace

TEST( Margins, PartOfARobotIsRuledOutByLessThanItsMargin )
{
	SeededRng rng;
	Tally tally;
	for ( int i = 0; i < 60 && !HasFailure(); ++i )
	{
		SCOPED_TRACE( ::testing::Message() << "world " << i );
		World world = stiffWorld( rng );
		Oracle oracle( world );
		const CheckerPtr plain = world.build( nullptr, 1e9 ), tables = world.build( world.reach.get(), 1e9 );
		EXPECT_EQ( lw_checker_get_info( tables.get() ).hierarchy, world.reach != nullptr );
		const QueryPtr one = makeQuery( plain.get(), false );
		const QueryPtr other = makeQuery( tables.get(), false ); // a warm start would find the pair that spheres hide
		for ( int k = 0; k < 4; ++k )
		{
			judgeState( world, oracle, { { plain.get(), one.get() }, { tables.get(), other.get() } },
			    groupState( rng, world, 0 ), tally );
		}
	}
	EXPECT_GE( std::min( { tally.near, tally.far, tally.violated } ), 50 );
	EXPECT_GE( tally.inside, 50 );
}

TEST( Margins, ObstacleIsPassedOverWithinItsMargin )
{
	SeededRng rng;
	int passed_over = 0, negative = 0;
	for ( int i = 0; i < 50 && !HasFailure(); ++i )
	{
		SCOPED_TRACE( ::testing::Message() << "world " << i );
		World world = randomWorld( rng, false );
		world.margins = randomMargins( rng, world );
		Oracle oracle( world );
		const CheckerPtr checker = world.build( nullptr, 0.05 );
		const lw_checker_info info = lw_checker_get_info( checker.get() );
		passed_over += info.near_shapes < world.placed.size();
		for ( int k = 0; k < 20; ++k )
		{
			const State q = groupState( rng, world, 0 );
			for ( uint32_t shape = 0; shape < world.placed.size(); ++shape )
			{
				const double proved = lw_checker_obstacle_distance( checker.get(), shape );
				negative += proved < 0;
				EXPECT_GE( oracle.toShape( q, shape ), proved - rounding );
			}
		}
	}
	EXPECT_GE( passed_over, 20 );
	EXPECT_GE( negative, 100 );
}

// A checker made after another one, with other margins, must not believe bounds of the old ones.
TEST( Margins, EditKeepsAnOldMargin )
{
	SeededRng rng;
	int fixed = 0, shared = 0;
	for ( int i = 0; i < 40 && !HasFailure(); ++i )
	{
		SCOPED_TRACE( ::testing::Message() << "world " << i );
		World world = randomWorld( rng, i % 4 == 0 );
		CheckerPtr last = world.build( world.reach.get(), 0.2 );
		for ( int k = 0; k < 6; ++k )
		{
			const Margins before = world.margins, fresh = randomMargins( rng, world );
			world.margins = k % 3 == 2 ? Margins() : fresh;
			if ( k % 2 == 0 ) // the environment's alone
			{
				world.margins.self = before.self;
				world.margins.link_self = before.link_self;
				world.margins.self_pairs = before.self_pairs;
			}
			const CheckerPtr edited = world.build( world.reach.get(), 0.2, last.get() );
			const CheckerPtr anew = world.build( world.reach.get(), 0.2 );
			const lw_checker_info a = lw_checker_get_info( edited.get() ), b = lw_checker_get_info( anew.get() );
			expectSame( b.static_environment, a.static_environment, "static" );
			fixed += b.static_environment.upper < inf;
			shared += k % 2 == 0;
			EXPECT_EQ( a.never_pairs, b.never_pairs );
			EXPECT_EQ( a.near_shapes, b.near_shapes );
			const QueryPtr one = makeQuery( edited.get() ), other = makeQuery( anew.get() );
			for ( int j = 0; j < 4; ++j )
			{
				const State q = groupState( rng, world, 0 );
				for ( const lw_range& range : { ranges[0], ranges[1], ranges[4] } )
				{
					const lw_state_result got = ask( edited.get(), one.get(), q, range ),
					                      want = ask( anew.get(), other.get(), q, range );
					EXPECT_EQ( want.verdict, got.verdict );
					expectSame( want.environment, got.environment, "environment" );
					expectSame( want.self, got.self, "self" );
				}
			}
			last.reset( lw_checker_retain( edited.get() ) );
		}
	}
	EXPECT_GE( fixed, 30 );
	EXPECT_GE( shared, 60 );
}
