// SPDX-License-Identifier: BSD-3-Clause
// Edited scenes and checkers against those made from nothing: the same to the bit. And edits that are refused.
#include "changing_world.hpp"

#include <gtest/gtest.h>

namespace
{

bool sameBits( double a, double b )
{
	return std::memcmp( &a, &b, sizeof( double ) ) == 0;
}

void expectSame( const lw_clearance& a, const lw_clearance& b, const std::string& what )
{
	EXPECT_TRUE( sameBits( a.lower, b.lower ) && sameBits( a.upper, b.upper ) )
	    << what << ": [" << a.lower << ", " << a.upper << "] and [" << b.lower << ", " << b.upper << "]";
	EXPECT_EQ( a.kind, b.kind ) << what;
	EXPECT_EQ( a.a, b.a ) << what;
	EXPECT_EQ( a.b, b.b ) << what;
}

/// The same found another way. Of violations only the first is found.
void expectSameDistance( const lw_clearance& a, const lw_clearance& b, const std::string& what )
{
	EXPECT_EQ( a.kind, b.kind ) << what;
	if ( a.kind == LW_CLEARANCE_NEAR )
	{
		EXPECT_NEAR( a.upper, b.upper, 1e-9 ) << what;
	}
}

void expectSameInfo( const leeway::Checker& edited, const leeway::Checker& fresh, const std::string& what )
{
	const lw_checker_info a = lw_checker_get_info( edited.get() ), b = lw_checker_get_info( fresh.get() );
	EXPECT_EQ( a.moving_bodies, b.moving_bodies ) << what;
	EXPECT_EQ( a.static_bodies, b.static_bodies ) << what;
	EXPECT_EQ( a.environment_pairs, b.environment_pairs ) << what;
	EXPECT_EQ( a.self_pairs, b.self_pairs ) << what;
	EXPECT_EQ( a.never_pairs, b.never_pairs ) << what;
	EXPECT_EQ( a.hierarchy, b.hierarchy ) << what;
	EXPECT_TRUE( sameBits( a.horizon, b.horizon ) ) << what << ": " << a.horizon << " and " << b.horizon;
	EXPECT_EQ( a.near_shapes, b.near_shapes ) << what;
	EXPECT_EQ( a.bytes, b.bytes ) << what;
	EXPECT_TRUE( sameBits( a.environment_margin, b.environment_margin ) && sameBits( a.self_margin, b.self_margin ) )
	    << what;
	expectSame( a.static_environment, b.static_environment, what + ", static" );
	const lw_scene* scene = lw_checker_scene( edited.get() );
	ASSERT_EQ( lw_scene_shape_count( scene ), lw_scene_shape_count( lw_checker_scene( fresh.get() ) ) );
	for ( std::uint32_t i = 0; i < lw_scene_shape_count( scene ); ++i )
	{
		EXPECT_TRUE(
		    sameBits( lw_checker_obstacle_distance( edited.get(), i ), lw_checker_obstacle_distance( fresh.get(), i ) ) )
		    << what << ": shape " << i;
	}
}

lw_state_result ask( const leeway::Checker& checker, lw_query* query, const State& q, const lw_range& range )
{
	lw_state_result result;
	lw_status status = lw_checker_state( checker.get(), query, q.data(), LW_CHECK_BOTH, &range, false, &result );
	EXPECT_EQ( status, LW_OK );
	return result;
}

lw_edge_result askEdge( const leeway::Checker& checker, lw_query* query, const State& qa, const State& qb )
{
	lw_edge_def def = lw_edge_def_default();
	def.min_d = 0.002;
	def.slack = 0.002;
	lw_edge_result result;
	EXPECT_EQ( lw_checker_edge( checker.get(), query, qa.data(), qb.data(), &def, &result ), LW_OK );
	return result;
}

lw_range randomRange( SeededRng& rng )
{
	return rng.integer( 0, 1 ) ? lw_range_exact()
	                           : lw_range{ rng.uniform( 0, 0.05 ), rng.uniform( 0.06, 0.4 ), rng.integer( 0, 1 ) * 0.1 };
}

const char* const ALL_KINDS[] = { "move", "add", "remove", "attach", "detach", "allow", "max_d", "margin" };

/// The questions of a planner, to two checkers.
struct Comparison
{
	int free = 0, blocked = 0, edges_free = 0;

	void states( const ChangingWorld& world, const leeway::Checker& edited, const leeway::Checker& fresh, SeededRng& rng,
	    const std::string& what )
	{
		leeway::Query a = leeway::makeQuery( edited.get() ), b = leeway::makeQuery( fresh.get() );
		for ( int i = 0; i < 3; ++i )
		{
			const State q = world.randomGroupState( rng, i == 2 ? 0.2 : 0 );
			const lw_range range = randomRange( rng );
			const lw_state_result x = ask( edited, a.get(), q, range ), y = ask( fresh, b.get(), q, range );
			EXPECT_EQ( x.verdict, y.verdict ) << what;
			expectSame( x.environment, y.environment, what + ", environment" );
			expectSame( x.self, y.self, what + ", self" );
			free += x.verdict == LW_VERDICT_FREE;
			blocked += x.verdict == LW_VERDICT_BLOCKED;
		}
		const State qa = world.randomGroupState( rng ), qb = world.randomGroupState( rng );
		const lw_edge_result x = askEdge( edited, a.get(), qa, qb ), y = askEdge( fresh, b.get(), qa, qb );
		EXPECT_EQ( x.verdict, y.verdict ) << what;
		EXPECT_EQ( x.queries, y.queries ) << what;
		EXPECT_TRUE( sameBits( x.t, y.t ) && sameBits( x.lower_bound, y.lower_bound ) ) << what;
		edges_free += x.verdict == LW_VERDICT_FREE;
	}
};

TEST( Edits, CheckerDiffersFromOneMadeFromNothing )
{
	SeededRng rng( 20261121 );
	Comparison comparison;
	std::map<std::string, int> kinds;
	int with_static = 0, edits = 0;
	// how often a kind of edit or of answer comes depends on the seed: as long as it takes, within reason
	const auto isEnough = [&]
	{
		bool all = with_static > 200 && comparison.free > 100 && comparison.blocked > 100 && comparison.edges_free > 5;
		for ( const char* kind : ALL_KINDS )
		{
			all = all && kinds[kind] > 20;
		}
		return all;
	};
	while ( ( edits < 1000 || ( edits < 10000 && !isEnough() ) ) && !::testing::Test::HasFailure() )
	{
		ChangingWorld world( rng, false );
		for ( int i = 0; i < 50 && !::testing::Test::HasFailure(); ++i, ++edits )
		{
			const std::string kind = world.change( rng );
			++kinds[kind];
			const std::string what = "edit " + std::to_string( edits ) + " (" + kind + ")";
			const leeway::Checker fresh =
			    world.checkerFromNothing( world.robotFromNothing(), world.sceneFromNothing(), leeway::Reach() );
			expectSameInfo( world.checker, fresh, what );
			with_static += lw_checker_get_info( world.checker.get() ).static_environment.upper < INFINITY;
			comparison.states( world, world.checker, fresh, rng, what );
		}
	}
	EXPECT_TRUE( isEnough() ) << edits << " edits, " << with_static << " with static bodies, " << comparison.free
	                          << " free, " << comparison.blocked << " blocked, " << comparison.edges_free << " free edges";
}

TEST( Edits, TablesOfTheBareRobotChangeAnAnswer )
{
#ifndef LEEWAY_HULLS
	GTEST_SKIP() << "built without qhull";
#endif
	SeededRng rng( 20261122 );
	int hierarchy = 0, never = 0, attached = 0, edits = 0;
	while ( edits < 300 && !::testing::Test::HasFailure() )
	{
		ChangingWorld world( rng, true );
		for ( int i = 0; i < 30 && !::testing::Test::HasFailure(); ++i, ++edits )
		{
			const std::string what = "edit " + std::to_string( edits ) + " (" + world.change( rng ) + ")";
			// the same robot, and tables: to the bit. No tables, another robot: the same answer
			const leeway::Checker fresh = world.checkerFromNothing( world.robot, world.sceneFromNothing(), world.reach );
			expectSameInfo( world.checker, fresh, what );
			const leeway::Checker plain =
			    world.checkerFromNothing( world.robotFromNothing(), world.sceneFromNothing(), leeway::Reach() );
			leeway::Query a = leeway::makeQuery( world.checker.get() ), b = leeway::makeQuery( fresh.get() ),
			              c = leeway::makeQuery( plain.get() );
			const lw_checker_info info = lw_checker_get_info( world.checker.get() );
			hierarchy += info.hierarchy;
			never += info.never_pairs > 0 && !world.attached.empty();
			attached += !world.attached.empty();
			for ( int k = 0; k < 4; ++k )
			{
				const State q = world.randomGroupState( rng );
				const lw_state_result x = ask( world.checker, a.get(), q, lw_range_exact() ),
				                      y = ask( fresh, b.get(), q, lw_range_exact() ),
				                      z = ask( plain, c.get(), q, lw_range_exact() );
				expectSame( x.environment, y.environment, what + ", environment" );
				expectSame( x.self, y.self, what + ", self" );
				EXPECT_EQ( x.verdict, z.verdict ) << what;
				expectSameDistance( x.environment, z.environment, what + ", environment" );
				expectSameDistance( x.self, z.self, what + ", self" );
			}
		}
	}
	EXPECT_GT( hierarchy, 200 );
	EXPECT_GT( attached, 100 );
	EXPECT_GT( never, 10 );
}

// An object on a link that stands still is taken off and put back elsewhere on it, the same shape: its clearance is another
// one.
TEST( Edits, StandingObjectIsMeasuredWhereItWas )
{
	RobotModel model;
	model.link( "base" );
	model.joint( "hand", LW_JOINT_REVOLUTE, 0 );
	const double size[3] = { 0.1, 0.1, 0.1 };
	lw_shape* made = nullptr;
	ASSERT_EQ( lw_shape_create_primitive( LW_SHAPE_BOX, size, nullptr, nullptr, &made ), LW_OK );
	const leeway::Shape box = leeway::Shape::adopt( made );
	model.body( 0, lw_shape_retain( made ), lw_transform_identity() );
	const leeway::Robot bare = leeway::Robot::adopt( model.create().release() );
	const lw_shape* shape = box.get();
	auto holding = [&]( const lw_robot* robot, double x )
	{
		lw_transform pose = lw_transform_identity();
		pose.t[0] = x;
		lw_attachment_def def = lw_attachment_def_default();
		def.name = "cup";
		def.link = 0;
		def.shapes = &shape;
		def.link_from_shape = &pose;
		def.shape_count = 1;
		lw_robot* out = nullptr;
		EXPECT_EQ( lw_robot_attach( robot, &def, nullptr, nullptr, &out ), LW_OK );
		return leeway::Robot::adopt( out );
	};
	lw_scene_shape_def obstacle = { box.get(), 0, lw_transform_identity() };
	obstacle.world_from_shape.t[0] = 2;
	const char* name = "wall";
	lw_scene_def scene_def = lw_scene_def_default();
	scene_def.object_names = &name;
	scene_def.object_count = 1;
	scene_def.shapes = &obstacle;
	scene_def.shape_count = 1;
	lw_scene* scene_made = nullptr;
	ASSERT_EQ( lw_scene_create( &scene_def, nullptr, nullptr, &scene_made ), LW_OK );
	const leeway::Scene scene = leeway::Scene::adopt( scene_made );
	const double places[] = { 1.0, 1.6, 0.5, 1.8, 1.95, 1.0, 3.5 }; // nearer and further, and into the wall
	leeway::Robot robot = holding( bare.get(), 0.3 );
	const State reference = { 0 };
	auto fresh = [&]
	{
		lw_checker_def def = lw_checker_def_default();
		def.robot = robot.get();
		def.scene = scene.get();
		def.reference = reference.data();
		lw_checker* out = nullptr;
		EXPECT_EQ( lw_checker_create( &def, nullptr, nullptr, &out ), LW_OK );
		return leeway::Checker::adopt( out );
	};
	leeway::Checker checker = fresh();
	for ( double x : places )
	{
		lw_robot* without = nullptr;
		ASSERT_EQ( lw_robot_detach( robot.get(), "cup", nullptr, nullptr, &without ), LW_OK );
		const leeway::Robot empty = leeway::Robot::adopt( without );
		robot = holding( empty.get(), x );
		lw_checker_edit_def edit = lw_checker_edit_def_default();
		edit.robot = robot.get();
		lw_checker* out = nullptr;
		ASSERT_EQ( lw_checker_edit( checker.get(), &edit, nullptr, nullptr, &out ), LW_OK );
		checker = leeway::Checker::adopt( out );
		const lw_clearance is = lw_checker_get_info( checker.get() ).static_environment;
		expectSame( is, lw_checker_get_info( fresh().get() ).static_environment, "at " + std::to_string( x ) );
		EXPECT_NEAR( is.upper, std::max( 0.0, std::fabs( 2 - x ) - 0.1 ), 1e-12 ) << x;
	}
}

TEST( Edits, QueryWithRoomDoesNotServeLaterSnapshots )
{
	SeededRng rng( 20261123 );
	int worlds = 0, asked = 0, blocked = 0, different = 0;
	while ( worlds++ < 12 )
	{
		ChangingWorld world( rng, false );
		lw_query_def def = lw_query_def_default();
		def.spare_shapes = 60;
		def.spare_bodies = 12;
		leeway::Query query = leeway::makeQuery( world.checker.get(), def );
		const leeway::Query tight = leeway::makeQuery( world.checker.get() );
		const std::uint32_t shapes = lw_scene_shape_count( world.scene.get() ),
		                    bodies = lw_robot_body_count( world.robot.get() );
		std::vector<std::pair<State, State>> edges;
		for ( int i = 0; i < 40; ++i )
		{
			const std::string kind = world.change( rng );
			ASSERT_TRUE( lw_query_fits( query.get(), world.checker.get() ) ) << kind;
			if ( lw_scene_shape_count( world.scene.get() ) > ( shapes + 7 ) / 8 * 8 ) // however many bodies it has room for
			{
				EXPECT_FALSE( lw_query_fits( tight.get(), world.checker.get() ) );
			}
			const bool larger = lw_scene_shape_count( world.scene.get() ) > ( shapes + 7 ) / 8 * 8 ||
			                    lw_robot_body_count( world.robot.get() ) > bodies;
			if ( larger && lw_checker_get_info( world.checker.get() ).environment_pairs > 0 )
			{
				lw_state_result result;
				const State q = world.randomGroupState( rng );
				const bool fits = lw_query_fits( tight.get(), world.checker.get() );
				EXPECT_EQ(
				    lw_checker_state( world.checker.get(), tight.get(), q.data(), LW_CHECK_BOTH, nullptr, false, &result ),
				    fits ? LW_OK : LW_ERROR_INVALID_ARGUMENT );
				EXPECT_TRUE( fits || result.verdict == LW_VERDICT_UNKNOWN );
			}
			// memory of earlier snapshots changes no verdict
			const leeway::Query fresh = leeway::makeQuery( world.checker.get() );
			edges.push_back( { world.randomGroupState( rng ), world.randomGroupState( rng ) } );
			const lw_range range = { 0.01, 0.3, 0 };
			const State& qa = edges.back().first;
			EXPECT_EQ(
			    ask( world.checker, query.get(), qa, range ).verdict, ask( world.checker, fresh.get(), qa, range ).verdict );
			for ( const auto& [a, b] : edges ) // the pairs near before the edit are remembered
			{
				const lw_edge_result x = askEdge( world.checker, query.get(), a, b ),
				                     y = askEdge( world.checker, fresh.get(), a, b );
				EXPECT_FALSE( x.verdict == LW_VERDICT_FREE && y.verdict == LW_VERDICT_BLOCKED ) << kind;
				EXPECT_FALSE( x.verdict == LW_VERDICT_BLOCKED && y.verdict == LW_VERDICT_FREE ) << kind;
				different += x.verdict != y.verdict; // an undecided verdict may depend on remembered pairs
				++asked;
				blocked += y.verdict == LW_VERDICT_BLOCKED;
			}
			if ( edges.size() > 6 )
			{
				edges.erase( edges.begin() );
			}
		}
	}
	std::printf( "%d edges asked again after edits, %d blocked, %d with another verdict\n", asked, blocked, different );
	EXPECT_GE( blocked, 100 );
	EXPECT_LE( different, asked / 50 );
}

TEST( Edits, SnapshotInUseChanges )
{
	SeededRng rng( 20261124 );
	ChangingWorld world( rng, false );
	const leeway::Checker first = world.checker;
	const leeway::Query query = leeway::makeQuery( first.get() );
	const State q = world.randomGroupState( rng );
	const lw_state_result before = ask( first, query.get(), q, lw_range_exact() );
	for ( int i = 0; i < 50; ++i )
	{
		world.change( rng );
	}
	lw_query_reset( query.get() );
	const lw_state_result after = ask( first, query.get(), q, lw_range_exact() );
	expectSame( before.environment, after.environment, "environment" );
	expectSame( before.self, after.self, "self" );
}

// --- bad input ---------------------------------------------------------------------------------------------------------

class BadEdits : public ::testing::Test
{
protected:
	BadEdits() : rng( 20261125 ), world( rng, false )
	{
		while ( world.objects.size() < 3 || world.objects[0].shapes.empty() || world.objects[1].shapes.empty() )
		{
			world.change( rng );
		}
	}

	void expectRefused( const lw_scene_change& bad, const std::string& part )
	{
		const lw_transform pose = lw_transform_identity();
		lw_scene_change good = { LW_SCENE_MOVE, nullptr, nullptr, &pose, 0 };
		std::vector<lw_transform> poses = world.objects[0].poses;
		good.object = world.objects[0].name.c_str();
		good.world_from_shape = poses.data();
		good.shape_count = static_cast<std::uint32_t>( poses.size() );
		const lw_scene_change changes[] = { good, bad };
		lw_scene* out = reinterpret_cast<lw_scene*>( &rng );
		lw_diag diag = {};
		EXPECT_EQ( lw_scene_edit( world.scene.get(), changes, 2, nullptr, &diag, &out ), LW_ERROR_INVALID_ARGUMENT ) << part;
		EXPECT_EQ( out, nullptr );
		EXPECT_EQ( diag.index, 1u ) << part;
		EXPECT_NE( std::string( diag.message ).find( part ), std::string::npos ) << diag.message;
	}

	SeededRng rng;
	ChangingWorld world;
};

TEST_F( BadEdits, ObjectThatIsNotThere )
{
	expectRefused( { LW_SCENE_REMOVE, "teapot", nullptr, nullptr, 0 }, "there is no object 'teapot'" );
	expectRefused( { LW_SCENE_MOVE, "teapot", nullptr, nullptr, 0 }, "there is no object 'teapot'" );
	expectRefused( { LW_SCENE_MOVE, nullptr, nullptr, nullptr, 0 }, "names no object" );
}

TEST_F( BadEdits, NameThatIsTaken )
{
	const std::string name = world.objects[1].name;
	expectRefused( { LW_SCENE_ADD, name.c_str(), nullptr, nullptr, 0 }, "there is an object '" + name + "' already" );
	// removed first, it is free again
	const lw_scene_change changes[] = { { LW_SCENE_REMOVE, name.c_str(), nullptr, nullptr, 0 },
	    { LW_SCENE_ADD, name.c_str(), nullptr, nullptr, 0 }, { LW_SCENE_MOVE, name.c_str(), nullptr, nullptr, 0 } };
	lw_scene* out = nullptr;
	ASSERT_EQ( lw_scene_edit( world.scene.get(), changes, 3, nullptr, nullptr, &out ), LW_OK );
	EXPECT_EQ( lw_scene_object_count( out ), world.objects.size() );
	EXPECT_EQ( lw_scene_find_object( out, name.c_str() ), world.objects.size() - 1 );
	lw_scene_release( out );
}

TEST_F( BadEdits, PosesOfWrongNumberOrKind )
{
	std::vector<lw_transform> poses( 9, lw_transform_identity() );
	const std::string name = world.objects[1].name;
	expectRefused( { LW_SCENE_MOVE, name.c_str(), nullptr, poses.data(), 9 }, "but 9 poses are given" );
	poses[0].r[0][0] = 2;
	const std::uint32_t count = static_cast<std::uint32_t>( world.objects[1].poses.size() );
	expectRefused( { LW_SCENE_MOVE, name.c_str(), nullptr, poses.data(), count }, "not a rotation" );
	poses[0] = lw_transform_identity();
	poses[0].t[1] = NAN;
	expectRefused( { LW_SCENE_MOVE, name.c_str(), nullptr, poses.data(), count }, "not finite" );
	expectRefused( { LW_SCENE_MOVE, name.c_str(), nullptr, nullptr, count }, "an array is NULL" );
	const lw_shape* shapes[] = { nullptr };
	expectRefused( { LW_SCENE_ADD, "new", shapes, poses.data() + 1, 1 }, "its shape 0 is NULL" );
	expectRefused( { static_cast<lw_scene_change_type>( 7 ), "new", nullptr, nullptr, 0 }, "unknown type" );
}

TEST_F( BadEdits, ObjectWhoseNameTwoHave )
{
	const char* names[] = { "twin", "twin" };
	lw_scene_def def = lw_scene_def_default();
	def.object_names = names;
	def.object_count = 2;
	lw_scene *scene = nullptr, *out = nullptr;
	ASSERT_EQ( lw_scene_create( &def, nullptr, nullptr, &scene ), LW_OK );
	const lw_scene_change change = { LW_SCENE_REMOVE, "twin", nullptr, nullptr, 0 };
	lw_diag diag = {};
	EXPECT_EQ( lw_scene_edit( scene, &change, 1, nullptr, &diag, &out ), LW_ERROR_INVALID_ARGUMENT );
	EXPECT_NE( std::string( diag.message ).find( "two objects are named 'twin'" ), std::string::npos ) << diag.message;
	lw_scene_release( scene );
}

TEST_F( BadEdits, CheckerEditThatDoesNotFit )
{
	lw_checker* out = nullptr;
	lw_diag diag = {};
	lw_checker_edit_def def = lw_checker_edit_def_default();
	const RobotPtr other = world.model.create();
	def.robot = other.get();
	EXPECT_EQ( lw_checker_edit( world.checker.get(), &def, nullptr, &diag, &out ), LW_ERROR_INVALID_ARGUMENT );
	EXPECT_NE( std::string( diag.message ).find( "was not made from this checker's" ), std::string::npos ) << diag.message;
	def = lw_checker_edit_def_default();
	const lw_link_object_pair pair = { 0, 10000 };
	def.allowed = &pair;
	def.allowed_count = 1;
	EXPECT_EQ( lw_checker_edit( world.checker.get(), &def, nullptr, &diag, &out ), LW_ERROR_INVALID_ARGUMENT );
	EXPECT_NE( std::string( diag.message ).find( "index out of range" ), std::string::npos ) << diag.message;
	def = lw_checker_edit_def_default();
	def.max_d = -1;
	EXPECT_EQ( lw_checker_edit( world.checker.get(), &def, nullptr, &diag, &out ), LW_ERROR_INVALID_ARGUMENT );
	def = {};
	EXPECT_EQ( lw_checker_edit( world.checker.get(), &def, nullptr, &diag, &out ), LW_ERROR_INVALID_DEF );
	EXPECT_EQ( out, nullptr );
}

} // namespace
