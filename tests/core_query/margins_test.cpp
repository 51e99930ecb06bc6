// SPDX-License-Identifier: BSD-3-Clause
// Margins of pairs: rules for all, and definitions that are refused.
#include "margins_world.hpp"

// --- laws ------------------------------------------------------------------------------------------------------------

// Zeros, however they are spelt, are no margins: bit for bit, and without a byte.
TEST( Margins, ZerosChangeAnAnswer )
{
	SeededRng rng;
	for ( int i = 0; i < 15; ++i )
	{
		World world = randomWorld( rng, false );
		const CheckerPtr none = world.build();
		const uint32_t links = lw_robot_link_count( world.robot.get() );
		world.margins.link.assign( links, 0 );
		world.margins.link_self.assign( links, 0 );
		world.margins.object.assign( world.objects, 0 );
		world.margins.self_pairs[{ 0, 1 }] = 0;
		if ( world.objects > 0 )
		{
			world.margins.pairs[{ 1, 0 }] = 0;
		}
		const CheckerPtr zeros = world.build();
		EXPECT_EQ( lw_checker_get_info( none.get() ).bytes, lw_checker_get_info( zeros.get() ).bytes );
		EXPECT_EQ( lw_checker_get_info( zeros.get() ).environment_margin, 0 );
		const QueryPtr one = makeQuery( none.get() ), other = makeQuery( zeros.get() );
		for ( int k = 0; k < 10; ++k )
		{
			const State q = groupState( rng, world, 0 );
			const lw_state_result a = ask( none.get(), one.get(), q, ranges[0] ),
			                      b = ask( zeros.get(), other.get(), q, ranges[0] );
			EXPECT_TRUE( sameBits( a.environment, b.environment ) );
			EXPECT_TRUE( sameBits( a.self, b.self ) );
		}
	}
}

// The same margin for all pairs moves all answers by it, and nothing else.
TEST( Margins, UniformMarginIsNotAShift )
{
	SeededRng rng;
	int shifted = 0;
	for ( int i = 0; i < 25; ++i )
	{
		World world = randomWorld( rng, i % 3 == 0 );
		const CheckerPtr none = world.build( world.reach.get() );
		const double margin = rng.decade( -3, -1 );
		world.margins.environment = world.margins.self = margin;
		const CheckerPtr with = world.build( world.reach.get() );
		const QueryPtr one = makeQuery( none.get() ), other = makeQuery( with.get() );
		for ( int k = 0; k < 10; ++k )
		{
			const State q = groupState( rng, world, 0 );
			const lw_state_result a = ask( none.get(), one.get(), q, ranges[0] ),
			                      b = ask( with.get(), other.get(), q, ranges[0] );
			for ( const auto& [bare, less] : { std::pair( a.environment, b.environment ), std::pair( a.self, b.self ) } )
			{
				if ( bare.upper < inf && bare.upper > margin )
				{
					++shifted;
					EXPECT_EQ( bare.upper - margin, less.upper );
					EXPECT_EQ( bare.a, less.a );
					EXPECT_EQ( bare.b, less.b );
					EXPECT_EQ( 0, std::memcmp( &bare.point_a, &less.point_a, sizeof( lw_vec3 ) ) );
				}
			}
		}
	}
	EXPECT_GE( shifted, 150 );
}

// A ball with a margin is a larger ball.
TEST( Margins, MarginOfABallIsNotItsRadius )
{
	for ( const double gap : { 0.5, 0.031, 0.03, 0.02, -0.01 } )
	{
		World world;
		world.model.link( "base" );
		world.model.joint( "slider", LW_JOINT_PRISMATIC, 0 );
		const double ball[3] = { 0.1, 0, 0 }, box[3] = { 0.2, 0.2, 0.2 };
		lw_shape* shape = nullptr;
		ASSERT_EQ( LW_OK, lw_shape_create_primitive( LW_SHAPE_SPHERE, ball, nullptr, nullptr, &shape ) );
		world.model.body( 1, shape, lw_transform_identity() );
		ASSERT_EQ( LW_OK, lw_shape_create_primitive( LW_SHAPE_BOX, box, nullptr, nullptr, &shape ) );
		world.shapes.emplace_back( shape );
		lw_transform at = lw_transform_identity();
		at.t[0] = 0.2 + gap;
		world.placed = { { shape, 0, at } };
		world.objects = 1;
		createScene( world );
		world.robot = world.model.create();
		world.reference = { 0 };
		world.group = { 0 };
		world.margins.link = { 0, 0.02 };
		world.margins.object = { 0.01 };
		const CheckerPtr checker = world.build();
		const QueryPtr query = makeQuery( checker.get() );
		const lw_state_result got = ask( checker.get(), query.get(), { 0 }, ranges[0] );
		EXPECT_EQ( got.verdict, gap > 0.03 + 1e-9 ? LW_VERDICT_FREE : gap < 0.03 - 1e-9 ? LW_VERDICT_BLOCKED : got.verdict );
		EXPECT_NEAR( got.environment.upper, std::max( gap, 0.0 ) - 0.03, 1e-12 )
		    << "contact is as deep as the margin, no deeper";
		EXPECT_EQ( got.environment.kind == LW_CLEARANCE_VIOLATION, got.environment.upper <= 0 );
		EXPECT_EQ( lw_checker_environment_margin( checker.get(), 1, 0 ), 0.03 );
		EXPECT_EQ( lw_checker_environment_margin( checker.get(), 1, 1 ), 0 ) << "no such object";
	}
}

// --- bad input -------------------------------------------------------------------------------------------------------

TEST( Margins, NonsenseIsAMargin )
{
	SeededRng rng;
	World world = randomWorld( rng, false );
	while ( world.objects < 2 )
	{
		world = randomWorld( rng, false );
	}
	const uint32_t links = lw_robot_link_count( world.robot.get() );
	const auto refuse = [&]( const std::string& want, const std::function<void( Margins& )>& spoil )
	{
		world.margins = Margins();
		spoil( world.margins );
		lw_diag diag = {};
		CheckerPtr checker;
		EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT, world.build( checker, &diag, nullptr ) ) << want;
		EXPECT_EQ( checker, nullptr );
		EXPECT_NE( std::string( diag.message ).find( want ), std::string::npos ) << diag.message;
	};
	for ( const double bad : { -1e-9, inf, std::nan( "" ) } )
	{
		refuse( "environment is", [&]( Margins& m ) { m.environment = bad; } );
		refuse( "self is", [&]( Margins& m ) { m.self = bad; } );
		refuse( "link_environment of link 'l0'", [&]( Margins& m ) { m.link.assign( links, 0 ), m.link[1] = bad; } );
		refuse( "link_self of link 'l0'", [&]( Margins& m ) { m.link_self.assign( links, 0 ), m.link_self[1] = bad; } );
		refuse( "object 'object1'", [&]( Margins& m ) { m.object.assign( world.objects, 0 ), m.object[1] = bad; } );
		refuse( "pair 'l0', 'object1'", [&]( Margins& m ) { m.pairs[{ 1, 1 }] = bad; } );
		refuse( "self pair 'l1', 'l0'", [&]( Margins& m ) { m.self_pairs[{ 1, 2 }] = bad; } );
	}
	refuse( "index out of range", [&]( Margins& m ) { m.pairs[{ links, 0 }] = 0.1; } );
	refuse( "index out of range", [&]( Margins& m ) { m.pairs[{ 0, world.objects }] = 0.1; } );
	refuse( "index out of range", [&]( Margins& m ) { m.self_pairs[{ 0, links }] = 0.1; } );
	refuse( "with itself", [&]( Margins& m ) { m.self_pairs[{ 1, 1 }] = 0.1; } );

	lw_checker_def def = lw_checker_def_default();
	def.robot = world.robot.get();
	def.scene = world.scene.get();
	const lw_pair_margin twice[] = { { 0, 1, 0.1 }, { 1, 0, 0.2 }, { 0, 1, 0.1 } };
	lw_diag diag = {};
	lw_checker* checker = nullptr;
	def.margins.environment_pairs = twice;
	def.margins.environment_pair_count = 3;
	EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT, lw_checker_create( &def, nullptr, &diag, &checker ) );
	EXPECT_STREQ( diag.message, "margins: pair 'root', 'object1' is there twice; keep one of them" );
	def.margins = {};
	def.margins.self_pairs = twice;
	def.margins.self_pair_count = 2;
	EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT, lw_checker_create( &def, nullptr, &diag, &checker ) );
	EXPECT_STREQ( diag.message, "margins: self pair 'root', 'l0' is there twice; keep one of them" );
	def.margins.self_pairs = nullptr;
	EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT, lw_checker_create( &def, nullptr, &diag, &checker ) );
	EXPECT_STREQ( diag.message, "margins: self pairs are NULL, their count is not 0" );
}

TEST( Margins, LeakWithoutMemory )
{
	SeededRng rng;
	World world = randomWorld( rng, false );
	while ( world.objects == 0 )
	{
		world = randomWorld( rng, false );
	}
	world.margins = randomMargins( rng, world );
	world.margins.object.assign( world.objects, 0.01 );
	world.margins.pairs[{ 0, 0 }] = 0.2;
	world.margins.self_pairs[{ 0, 1 }] = 0.2;
	CheckerPtr checker;
	lw_status status = LW_ERROR_OUT_OF_MEMORY;
	for ( int allowed = 0; status != LW_OK && !HasFailure(); ++allowed )
	{
		CountingAllocator memory;
		memory.left = allowed;
		const lw_allocator allocator = memory.get();
		lw_diag diag = {};
		status = world.build( checker, &diag, nullptr, inf, &allocator );
		EXPECT_TRUE( status == LW_OK || status == LW_ERROR_OUT_OF_MEMORY );
		checker.reset();
		EXPECT_EQ( memory.live, 0 ) << allowed;
		EXPECT_EQ( memory.bytes, 0u ) << allowed;
	}
}
