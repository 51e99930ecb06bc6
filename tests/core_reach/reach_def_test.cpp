// SPDX-License-Identifier: BSD-3-Clause
// Definitions of a reach: bad input, robots without geometry, hulls alone, building that ends early.
#include "hull_world.hpp"

TEST( ReachDef, BadInputIsNamed )
{
	RobotModel model;
	model.link( "base" );
	RobotPtr robot = model.create();
	lw_reach_def good = lw_reach_def_default();
	good.robot = robot.get();
	auto expect = [&]( const lw_reach_def* def, lw_status status, const char* text )
	{
		lw_reach* reach = reinterpret_cast<lw_reach*>( &model );
		lw_diag diag = {};
		EXPECT_EQ( lw_reach_create( def, nullptr, &diag, &reach ), status ) << text;
		EXPECT_EQ( reach, nullptr );
		EXPECT_NE( std::string( diag.message ).find( text ), std::string::npos ) << diag.message;
		EXPECT_EQ( lw_reach_create( def, nullptr, nullptr, &reach ), status );
	};
	expect( nullptr, LW_ERROR_INVALID_ARGUMENT, "NULL" );
	lw_reach_def def = good;
	def.cookie ^= 1u;
	expect( &def, LW_ERROR_INVALID_DEF, "lw_reach_def_default" );
	def = {};
	expect( &def, LW_ERROR_INVALID_DEF, "lw_reach_def_default" );
	def = good;
	def.robot = nullptr;
	expect( &def, LW_ERROR_INVALID_ARGUMENT, "robot" );
	for ( double bad : { -1.0, double( NAN ), inf } )
	{
		def = good;
		def.hull_error = bad;
		expect( &def, LW_ERROR_INVALID_ARGUMENT, "hull_error" );
		def = good;
		def.limit_margin = bad;
		expect( &def, LW_ERROR_INVALID_ARGUMENT, "limit_margin" );
		def = good;
		def.seconds = bad;
		expect( &def, LW_ERROR_INVALID_ARGUMENT, "budget" );
	}
	EXPECT_EQ( lw_reach_create( &good, nullptr, nullptr, nullptr ), LW_ERROR_INVALID_ARGUMENT );
	EXPECT_EQ( lw_reach_retain( nullptr ), nullptr );
	lw_reach_release( nullptr );
}

TEST( ReachDef, HullsOfARobotWithoutGeometry )
{
	RobotModel model;
	model.link( "base" );
	model.joint( "a", LW_JOINT_REVOLUTE, 0 );
	RobotPtr robot = model.create();
	ReachPtr reach = build( robot.get() );
	EXPECT_LT( lw_reach_get_node( reach.get(), 0 ).mr.radius, 0 );
}

TEST( ReachDef, HullsOnlyProvesNothingAboutPairs )
{
	SeededRng rng;
	for ( int i = 0; i < 5; ++i )
	{
		RobotModel model = randomRobot( rng, {} );
		RobotPtr robot = model.create();
		lw_reach_def def = lw_reach_def_default();
		def.robot = robot.get();
		def.hull_error = 0.3;
		def.seconds = 0;
		def.samples = 50;
		lw_reach *reach = nullptr, *hulls = nullptr;
		ASSERT_EQ( lw_reach_create( &def, nullptr, nullptr, &reach ), LW_OK );
		def.hulls_only = true;
		ASSERT_EQ( lw_reach_create( &def, nullptr, nullptr, &hulls ), LW_OK );
		ReachPtr whole( reach ), bare( hulls );
		for ( std::uint32_t a = 0; a < lw_robot_link_count( robot.get() ); ++a )
		{
			EXPECT_EQ( lw_reach_get_node( hulls, a ).m.radius, lw_reach_get_node( reach, a ).m.radius );
			for ( std::uint32_t b = 0; b < a; ++b )
			{
				lw_reach_pair pair = lw_reach_get_pair( hulls, a, b );
				lw_pair_class other = lw_reach_get_pair( reach, a, b ).kind;
				bool judged = other == LW_PAIR_NEVER || other == LW_PAIR_ALWAYS || other == LW_PAIR_CHECK;
				EXPECT_EQ( pair.kind, judged ? LW_PAIR_CHECK : other );
				EXPECT_EQ( pair.separation, 0 );
				EXPECT_EQ( pair.closest, inf );
				State q( lw_robot_variable_count( robot.get() ) );
				EXPECT_FALSE( lw_reach_closest_state( hulls, a, b, q.data() ) );
			}
		}
		lw_blob_def blob = lw_blob_def_default();
		blob.reach = hulls;
		void* bytes = nullptr;
		std::size_t size = 0;
		ASSERT_EQ( lw_blob_write( &blob, nullptr, nullptr, &bytes, &size ), LW_OK );
		lw_reach* read = nullptr;
		lw_diag diag{};
		EXPECT_EQ( lw_blob_read_reach( bytes, size, blob.key, robot.get(), nullptr, &diag, &read ), LW_OK ) << diag.message;
		lw_reach_release( read );
		lw_blob_free( nullptr, bytes, size );
	}
}

TEST( ReachDef, OfLinksThatAreNotThereNothingIsProved )
{
	SeededRng rng;
	RandomRobotOptions options;
	options.joints = 3;
	RobotModel model = randomRobot( rng, options );
	RobotPtr robot = model.create();
	ReachPtr reach = build( robot.get() );
	const std::uint32_t count = lw_robot_link_count( robot.get() );
	for ( std::uint32_t a = 0; a < count + 2; ++a )
	{
		for ( std::uint32_t b : { count, count + 1, LW_INVALID_INDEX } )
		{
			for ( auto [x, y] : { std::pair( a, b ), std::pair( b, a ) } )
			{
				EXPECT_EQ( lw_reach_get_pair( reach.get(), x, y ).kind, LW_PAIR_CHECK );
				EXPECT_EQ( lw_reach_get_pair( reach.get(), x, y ).separation, 0 );
				State q( lw_robot_variable_count( robot.get() ) );
				EXPECT_FALSE( lw_reach_closest_state( reach.get(), x, y, q.data() ) );
			}
		}
	}
}

TEST( ReachDef, GivingUpDuringHullsIsReported )
{
	SeededRng rng;
	RobotModel model = randomRobot( rng, {} );
	RobotPtr robot = model.create();
	struct Calls
	{
		int left;
		double last = 0;
	};
	for ( int allowed = 0; allowed < 6; ++allowed )
	{
		Calls calls = { allowed };
		lw_reach_def def = lw_reach_def_default();
		def.robot = robot.get();
		def.progress_user = &calls;
		def.progress = []( void* user, const char* stage, double share )
		{
			Calls* c = static_cast<Calls*>( user );
			EXPECT_STREQ( stage, "hulls" );
			EXPECT_GE( share, c->last );
			c->last = share;
			return c->left-- > 0;
		};
		CountingAllocator counter;
		lw_allocator allocator = counter.get();
		lw_reach* reach = nullptr;
		EXPECT_EQ( createHulls( &def, &allocator, nullptr, &reach ), LW_ERROR_CANCELLED );
		EXPECT_EQ( counter.live, 0 );
	}
}

TEST( ReachDef, EveryFailingAllocationOfTheHullsIsReported )
{
	SeededRng rng;
	RandomRobotOptions options;
	options.joints = 3;
	RobotModel model = randomRobot( rng, options );
	RobotPtr robot = model.create();
	lw_reach_def def = lw_reach_def_default();
	def.robot = robot.get();
	def.hull_error = 0.2;
	for ( int allowed = 0;; ++allowed )
	{
		CountingAllocator counter;
		counter.left = allowed;
		lw_allocator allocator = counter.get();
		lw_reach* reach = nullptr;
		lw_status status = createHulls( &def, &allocator, nullptr, &reach );
		if ( status == LW_OK )
		{
			EXPECT_GT( allowed, 20 );
			lw_reach_release( reach );
			EXPECT_EQ( counter.live, 0 );
			break;
		}
		ASSERT_EQ( status, LW_ERROR_OUT_OF_MEMORY ) << allowed;
		ASSERT_EQ( counter.live, 0 ) << allowed;
	}
}
