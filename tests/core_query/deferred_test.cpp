// SPDX-License-Identifier: BSD-3-Clause
// Deferred meshes: made late, on threads, or not at all. No answer may differ, and a failure never reads as free.
#include "required_world.hpp"
#include "shape/shape.h"

TEST( Required, FailedMeshReadsAsFreeSpace )
{
	SeededRng rng;
	int failed = 0;
	for ( int i = 0; i < 150; ++i )
	{
		Counts counts;
		World world = randomWorld( rng ), lazy = deferred( world, counts );
		ScenePtr scene = makeScene( lazy.placed );
		for ( const ShapePtr& shape : lazy.shapes ) // of the robot: all it takes to have a checker
		{
			if ( &shape - lazy.shapes.data() < static_cast<std::ptrdiff_t>( world.model.bodies.size() ) )
			{
				ASSERT_EQ( LW_OK, lw_shape_complete( shape.get(), nullptr ) );
			}
		}
		CheckerPtr checker = makeChecker( lazy.robot.get(), scene.get(), lazy, inf );
		QueryPtr query = coldQuery( checker.get() );
		counts.fail = true;
		for ( int k = 0; k < 5; ++k )
		{
			State q = groupState( rng, world, 0 ), to = groupState( rng, world, 0 );
			lw_state_result out;
			lw_status status = lw_checker_state( checker.get(), query.get(), q.data(), LW_CHECK_BOTH, nullptr, false, &out );
			if ( status != LW_OK )
			{
				++failed;
				EXPECT_EQ( LW_ERROR_OUT_OF_MEMORY, status );
				EXPECT_EQ( LW_VERDICT_UNKNOWN, out.verdict );
				EXPECT_EQ( 0, out.environment.lower );
				EXPECT_EQ( inf, out.environment.upper );
			}
			lw_edge_def def = lw_edge_def_default();
			lw_edge_result edge;
			status = lw_checker_edge( checker.get(), query.get(), q.data(), to.data(), &def, &edge );
			bool answered = status == LW_OK && edge.verdict != LW_VERDICT_UNKNOWN;
			bool refused = status == LW_ERROR_OUT_OF_MEMORY && edge.verdict == LW_VERDICT_UNKNOWN;
			bool no_motion_bound = status == LW_ERROR_INVALID_ARGUMENT; // a mimic joint without limits
			EXPECT_TRUE( answered || refused || no_motion_bound ) << lw_status_name( status );
			// and once it can be made, the same query goes on as if nothing had been
			counts.fail = false;
			EXPECT_EQ(
			    LW_OK, lw_checker_state( checker.get(), query.get(), q.data(), LW_CHECK_BOTH, nullptr, false, &out ) );
			counts.fail = true;
		}
	}
	EXPECT_GE( failed, 20 );
}

/// The maker of a mesh, and the time of making, change no answer, only durations.
TEST( Required, ThreadsThatPrepareMeshesChangeAnAnswer )
{
	SeededRng rng;
	std::size_t calls = 0, shapes = 0;
	for ( int i = 0; i < 100; ++i )
	{
		World world = randomWorld( rng );
		Counts counts[3];
		Preparation preparation[3];
		preparation[1].threads = 0;
		preparation[2].threads = 2;
		std::vector<lw_state_result> answers[3];
		std::vector<State> states;
		for ( int k = 0; k < 4; ++k )
		{
			states.push_back( groupState( rng, world, 0 ) );
		}
		for ( int k = 0; k < 3; ++k )
		{
			World lazy = deferred( world, counts[k] );
			ScenePtr scene = makeScene( lazy.placed );
			CheckerPtr checker =
			    makeChecker( lazy.robot.get(), scene.get(), lazy, inf, LW_OK, k > 0 ? &preparation[k] : nullptr );
			QueryPtr query = coldQuery( checker.get() );
			for ( const State& q : states )
			{
				answers[k].emplace_back();
				ASSERT_EQ( LW_OK, lw_checker_state( checker.get(), query.get(), q.data(), LW_CHECK_BOTH, nullptr, false,
				                      &answers[k].back() ) );
			}
			calls += preparation[k].calls;
			shapes += preparation[k].shapes;
		}
		EXPECT_EQ( counts[0].made, counts[1].made ) << "it was asked to prepare and did not, and that made a difference";
		for ( std::size_t k = 0; k < states.size(); ++k )
		{
			for ( int other = 1; other < 3; ++other )
			{
				EXPECT_EQ( answers[0][k].environment.upper, answers[other][k].environment.upper );
				EXPECT_EQ( answers[0][k].self.upper, answers[other][k].self.upper );
				EXPECT_EQ( answers[0][k].verdict, answers[other][k].verdict );
			}
		}
	}
	EXPECT_GE( calls, 100u );
	EXPECT_GE( shapes, 300u );
}

TEST( Required, BoxThatWasNotTrue )
{
	SeededRng rng;
	ShapePtr mesh( randomMesh( rng, 10, 0.2, nullptr ) );
	Counts counts;
	lw_deferred_def def = laterDef( mesh.get(), counts );
	def.box_max[1] -= 1e-3;
	lw_shape* shape = nullptr;
	ASSERT_EQ( LW_OK, lw_shape_create_deferred( &def, nullptr, nullptr, &shape ) );
	ShapePtr owner( shape );
	lw_diag diag = {};
	EXPECT_EQ( LW_ERROR_BAD_GEOMETRY, lw_shape_complete( shape, &diag ) );
	EXPECT_NE( nullptr, std::strstr( diag.message, "box" ) );
	EXPECT_EQ( nullptr, lw_shape_vertices( shape ) );
	lw_query_def query_def = lw_query_def_default();
	lw_query* query = nullptr;
	ASSERT_EQ( LW_OK, lw_query_create( &query_def, nullptr, nullptr, nullptr, &query ) );
	lw_transform here = lw_transform_identity();
	lw_clearance out;
	EXPECT_EQ( LW_ERROR_BAD_GEOMETRY, lw_shape_distance( shape, &here, mesh.get(), &here, nullptr, query, &out ) );
	EXPECT_EQ( 0, out.lower );
	lw_query_destroy( query );
}

TEST( Required, BadDeferredDef )
{
	SeededRng rng;
	ShapePtr mesh( randomMesh( rng, 10, 0.2, nullptr ) );
	Counts counts;
	lw_deferred_def good = laterDef( mesh.get(), counts );
	lw_shape* shape = nullptr;
	for ( int i = 0; i < 5; ++i )
	{
		lw_deferred_def def = good;
		lw_status want = i == 0 ? LW_ERROR_INVALID_DEF : i == 1 ? LW_ERROR_INVALID_ARGUMENT : LW_ERROR_BAD_GEOMETRY;
		def.cookie = i == 0 ? 0 : def.cookie;
		def.make = i == 1 ? nullptr : def.make;
		def.box_min[2] = i == 2 ? std::nan( "" ) : i == 3 ? def.box_max[2] + 1 : i == 4 ? -1e12 : def.box_min[2];
		EXPECT_EQ( want, lw_shape_create_deferred( &def, nullptr, nullptr, &shape ) ) << i;
		EXPECT_EQ( nullptr, shape );
	}
	EXPECT_EQ( 0, counts.released ) << "a def that was not taken is the caller's";
	Later::release( good.user );
}

TEST( Required, DeferredMeshTellsItsBounds )
{
	SeededRng rng;
	ShapePtr mesh( randomMesh( rng, 10, 0.2, nullptr ) );
	Counts counts;
	ShapePtr later = defer( mesh.get(), counts );
	lw_shape_info info = lw_shape_peek_info( later.get() );
	EXPECT_TRUE( info.deferred );
	EXPECT_EQ( 10u, info.triangle_count );
	EXPECT_EQ( 0u, info.node_count );
	EXPECT_EQ( 0, counts.made );
	EXPECT_EQ( LW_OK, lwi_shape_validate( later.get(), nullptr ) );
	EXPECT_EQ( 1, counts.made );
	info = lw_shape_get_info( later.get() );
	EXPECT_FALSE( info.deferred );
	EXPECT_EQ( 10u, info.triangle_count );
	EXPECT_TRUE( lw_digest_equal( lw_shape_digest( mesh.get() ), lw_shape_digest( later.get() ) ) );
	EXPECT_EQ( lw_shape_triangles( mesh.get() ), lw_shape_triangles( later.get() ) );
	EXPECT_EQ( LW_OK, lw_shape_complete( later.get(), nullptr ) );
	EXPECT_EQ( 1, counts.made );
}

TEST( Required, ThreadsMeetAtADeferredMesh )
{
	SeededRng rng;
	for ( int i = 0; i < 10; ++i )
	{
		Counts counts;
		World world = randomWorld( rng ), lazy = deferred( world, counts );
		ScenePtr scene = makeScene( world.placed ), lazy_scene = makeScene( lazy.placed );
		CheckerPtr whole = makeChecker( world.robot.get(), scene.get(), world, 1e9 );
		CheckerPtr less = makeChecker( lazy.robot.get(), lazy_scene.get(), lazy, inf );
		std::vector<State> states;
		for ( int k = 0; k < 8; ++k )
		{
			states.push_back( groupState( rng, world, k % 2 ) );
		}
		std::atomic<int> different{ 0 };
		std::vector<std::thread> threads;
		for ( int t = 0; t < 4; ++t )
		{
			threads.emplace_back(
			    [&]
			    {
				    QueryPtr query = coldQuery( whole.get() ), other = coldQuery( less.get() );
				    for ( const State& q : states )
				    {
					    lw_state_result want = ask( whole.get(), query.get(), q, ranges[0] );
					    lw_state_result got = ask( less.get(), other.get(), q, ranges[0] );
					    different += want.verdict != got.verdict || want.environment.upper != got.environment.upper;
				    }
			    } );
		}
		for ( std::thread& thread : threads )
		{
			thread.join();
		}
		EXPECT_EQ( 0, different );
	}
}

TEST( Required, ReachOfADeferredRobotDiffers )
{
	SeededRng rng;
	Counts counts;
	World world = randomWorld( rng ), lazy = deferred( world, counts );
	lw_reach_def def = lw_reach_def_default();
	def.hulls_only = true;
	def.hull_error = 0.3;
	lw_reach* reach[2] = { nullptr, nullptr };
	void* bytes[2] = { nullptr, nullptr };
	std::size_t size[2];
	for ( int i = 0; i < 2; ++i )
	{
		def.robot = i == 0 ? world.robot.get() : lazy.robot.get();
		lw_status status = lw_reach_create( &def, nullptr, nullptr, &reach[i] );
		if ( status == LW_ERROR_UNSUPPORTED )
		{
			GTEST_SKIP() << "a build without qhull";
		}
		ASSERT_EQ( LW_OK, status );
		lw_blob_def blob = lw_blob_def_default();
		blob.reach = reach[i];
		ASSERT_EQ( LW_OK, lw_blob_write( &blob, nullptr, nullptr, &bytes[i], &size[i] ) );
	}
	ASSERT_EQ( size[0], size[1] );
	EXPECT_EQ( 0, std::memcmp( bytes[0], bytes[1], size[0] ) );
	EXPECT_TRUE( lw_digest_equal( lw_robot_digest( world.robot.get() ), lw_robot_digest( lazy.robot.get() ) ) );
	for ( int i = 0; i < 2; ++i )
	{
		lw_blob_free( nullptr, bytes[i], size[i] );
		lw_reach_release( reach[i] );
	}
}

/// Prepared once, no state within the limits makes a mesh; whatever is made, answers are the same.
TEST( Required, PreparedCheckerLeavesAMeshToAState )
{
	SeededRng rng;
	int prepared = 0, unmade = 0, later = 0;
	std::size_t shared = 0;
	for ( int i = 0; i < 150 && !HasFailure(); ++i )
	{
		SCOPED_TRACE( ::testing::Message() << "world " << i );
		Counts counts, other_counts;
		World world = randomWorld( rng );
		world.margin = i % 2 == 0 ? 0 : rng.decade( -2, 0 );
		World lazy = deferred( world, counts ), other = deferred( world, other_counts );
		ScenePtr scene = makeScene( lazy.placed ), other_scene = makeScene( other.placed );
		const double limit = i % 3 == 0 ? inf : 0.1;
		CheckerPtr checker = makeChecker( lazy.robot.get(), scene.get(), lazy, limit );
		CheckerPtr unprepared = makeChecker( other.robot.get(), other_scene.get(), other, limit );
		const int created = counts.made;
		Preparation preparation;
		preparation.threads = 2 * static_cast<unsigned>( i % 2 );
		ASSERT_EQ(
		    LW_OK, lw_checker_prepare( checker.get(), i % 5 == 0 ? nullptr : Preparation::prepare, &preparation, nullptr ) );
		const int made = counts.made;
		ASSERT_EQ( LW_OK, lw_checker_prepare( checker.get(), nullptr, nullptr, nullptr ) );
		EXPECT_EQ( made, counts.made ) << "the second time there is nothing left";
		prepared += made > created;
		shared += preparation.shapes;
		unmade += std::any_of( lazy.shapes.begin(), lazy.shapes.end(),
		    []( const ShapePtr& shape ) { return lw_shape_peek_info( shape.get() ).deferred; } );
		QueryPtr query = coldQuery( checker.get() ), other_query = coldQuery( unprepared.get() );
		for ( int k = 0; k < 8; ++k )
		{
			const State q = groupState( rng, world, 0 );
			const lw_range range = { 0, limit, 0 };
			const lw_state_result got = ask( checker.get(), query.get(), q, range );
			const lw_state_result want = ask( unprepared.get(), other_query.get(), q, range );
			EXPECT_EQ( made, counts.made ) << "state " << k << " had to make a mesh";
			expectSame( want.environment, got.environment, "environment" );
			expectSame( want.self, got.self, "self" );
		}
		later += other_counts.made > created;
	}
	EXPECT_GE( prepared, 60 ) << "checkers with something to prepare";
	EXPECT_GE( later, 30 ) << "checkers whose states had to make something";
	EXPECT_GE( unmade, 20 ) << "checkers that leave something deferred: all is made, needed or not";
	EXPECT_GE( shared, 50u );
}

TEST( Required, FailedPreparationGoesUnsaid )
{
	SeededRng rng;
	int failed = 0;
	for ( int i = 0; i < 100; ++i )
	{
		Counts counts;
		World world = randomWorld( rng ), lazy = deferred( world, counts );
		ScenePtr scene = makeScene( lazy.placed );
		CheckerPtr checker = makeChecker( lazy.robot.get(), scene.get(), lazy, inf );
		counts.fail = true;
		Preparation preparation;
		preparation.threads = 2;
		const lw_status status = lw_checker_prepare( checker.get(), Preparation::prepare, &preparation, nullptr );
		counts.fail = false;
		const int before = counts.made;
		EXPECT_EQ( LW_OK, lw_checker_prepare( checker.get(), nullptr, nullptr, nullptr ) ) << "it can be made now";
		EXPECT_EQ( counts.made > before ? LW_ERROR_OUT_OF_MEMORY : LW_OK, status );
		failed += status != LW_OK;
	}
	EXPECT_GE( failed, 30 );
	EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT, lw_checker_prepare( nullptr, nullptr, nullptr, nullptr ) );
}
