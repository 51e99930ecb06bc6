// SPDX-License-Identifier: BSD-3-Clause
// Rows of near pairs against exact distances of all pairs, which know nothing of spheres, hulls, tables and memory.
#include "near_world.hpp"

#include <cstring>

namespace
{

/// Link and link, or link and object, with the least upper bound of their rows.
using LinkPair = std::tuple<bool, std::uint32_t, std::uint32_t>;

LinkPair linksOf( const lw_near_pair& row )
{
	const std::uint32_t a = row.clearance.a, b = row.clearance.b;
	return row.self ? LinkPair{ true, std::min( a, b ), std::max( a, b ) } : LinkPair{ false, a, b };
}

double length( const lw_vec3& v )
{
	return std::sqrt( v.x * v.x + v.y * v.y + v.z * v.z );
}

class NearWorlds : public testing::TestWithParam<int>
{
protected:
	NearWorlds()
	{
		RandomWorldOptions options;
		options.margins = GetParam() % 3 == 0;
		world = randomWorld( 4000 + std::uint64_t( GetParam() ), options );
		checker = GetParam() % 2 == 0 ? world.checker.get() : world.with_tables.get();
		query = queryOf( checker );
		auditor = std::make_unique<EdgeAuditor>( world.robot.get(), world.scene.get(), world.variables,
		    world.reference.data(), world.allowed, 1e-4,
		    [this]( bool self, std::uint32_t link, std::uint32_t other ) { return world.margins.of( self, link, other ); } );
	}

	SeededRng rng{ std::mt19937_64( std::uint64_t( GetParam() ) ) };
	EdgeWorld world;
	const lw_checker* checker = nullptr;
	leeway::Query query;
	std::unique_ptr<EdgeAuditor> auditor;
};

/// Links that no variable of the group moves: their obstacles have no rows.
std::vector<bool> standingLinks( const EdgeWorld& world, SeededRng& rng )
{
	const lw_robot* robot = world.robot.get();
	std::vector<lw_transform> a( lw_robot_link_count( robot ) ), b = a;
	EXPECT_EQ( LW_OK, lw_robot_fk( robot, world.full( randomGroupState( world, rng ) ).data(), a.data() ) );
	EXPECT_EQ( LW_OK, lw_robot_fk( robot, world.full( randomGroupState( world, rng ) ).data(), b.data() ) );
	std::vector<bool> out;
	for ( std::size_t i = 0; i < a.size(); ++i )
	{
		out.push_back( std::memcmp( &a[i], &b[i], sizeof( lw_transform ) ) == 0 );
	}
	return out;
}

/// Intervals of all rows hold the auditor's clearance, and no pair is missing.
void expectAllPairs( const EdgeWorld& world, EdgeAuditor& auditor, const NearRows& near, const std::vector<double>& q,
    double distance, const std::vector<bool>& standing )
{
	std::map<LinkPair, const lw_near_pair*> least;
	for ( const lw_near_pair& row : near.rows )
	{
		const auto place = least.emplace( linksOf( row ), &row ).first;
		place->second = row.clearance.upper < place->second->clearance.upper ? &row : place->second;
	}
	const std::vector<double> full = world.full( q );
	const std::uint32_t links = lw_robot_link_count( world.robot.get() );
	const std::uint32_t objects = world.scene ? lw_scene_object_count( world.scene.get() ) : 0;
	const auto compare = [&]( bool self, std::uint32_t a, std::uint32_t b )
	{
		const double clearance = auditor.clearance( full.data(), self, a, b );
		const auto row = least.find( { self, a, b } );
		if ( row == least.end() )
		{
			EXPECT_GE( clearance, distance - 1e-9 ) << "no row of " << self << " " << a << " " << b;
			return;
		}
		EXPECT_LE( row->second->clearance.lower, clearance + 1e-9 );
		// the auditor measures until a clearance is below 0
		EXPECT_TRUE( clearance <= 0 || row->second->clearance.upper >= clearance - 1e-9 );
		EXPECT_LE( near.links[a], row->second->clearance.lower );
		EXPECT_GE( clearance + 1e-9, std::min( distance, near.links[a] ) );
		EXPECT_TRUE( !self || clearance + 1e-9 >= std::min( distance, near.links[b] ) );
	};
	for ( std::uint32_t a = 0; a < links; ++a )
	{
		for ( std::uint32_t b = a + 1; b < links; ++b )
		{
			compare( true, a, b );
		}
		for ( std::uint32_t b = 0; b < objects && !standing[a]; ++b )
		{
			compare( false, a, b );
		}
	}
}

TEST_P( NearWorlds, EachNearPairHasARow )
{
	const std::vector<bool> standing = standingLinks( world, rng );
	for ( int i = 0; i < 12; ++i )
	{
		const std::vector<double> q = randomGroupState( world, rng );
		lw_near_def def = lw_near_def_default();
		def.distance = i % 4 == 0 ? INFINITY : rng.decade( -3, 0 );
		const NearRows near = nearPairs( checker, query.get(), q, def );
		ASSERT_EQ( LW_OK, near.status );
		expectAllPairs( world, *auditor, near, q, std::min( def.distance, 1e9 ), standing );
	}
}

TEST_P( NearWorlds, RowsAreInOrderAndTellTheDirectionOut )
{
	for ( int i = 0; i < 6; ++i )
	{
		const std::vector<double> q = randomGroupState( world, rng );
		lw_near_def def = lw_near_def_default();
		def.distance = 0.3;
		const NearRows near = nearPairs( checker, query.get(), q, def );
		ASSERT_EQ( LW_OK, near.status );
		for ( std::size_t k = 0; k < near.rows.size(); ++k )
		{
			const lw_near_pair& row = near.rows[k];
			EXPECT_TRUE( k == 0 || near.rows[k - 1].clearance.upper <= row.clearance.upper );
			const bool apart = row.clearance.kind == LW_CLEARANCE_NEAR;
			EXPECT_EQ( row.direction != LW_DIRECTION_NONE, apart );
			EXPECT_NEAR( length( row.normal ), apart ? 1 : 0, 1e-12 );
			if ( apart )
			{
				const double margin = row.self ? lw_checker_self_margin( checker, row.clearance.a, row.clearance.b )
				                               : lw_checker_environment_margin( checker, row.clearance.a, row.clearance.b );
				const double distance = row.clearance.upper + margin;
				EXPECT_NEAR( row.clearance.point_a.x, row.clearance.point_b.x + distance * row.normal.x, 1e-9 );
				EXPECT_NEAR( row.clearance.point_a.y, row.clearance.point_b.y + distance * row.normal.y, 1e-9 );
				EXPECT_NEAR( row.clearance.point_a.z, row.clearance.point_b.z + distance * row.normal.z, 1e-9 );
				EXPECT_LE( row.clearance.upper - row.clearance.lower, 1e-9 );
			}
		}
	}
}

TEST_P( NearWorlds, ABufferThatIsTooSmallKeepsTheNearestAndCountsAll )
{
	const std::vector<double> q = randomGroupState( world, rng );
	lw_near_def def = lw_near_def_default();
	def.distance = INFINITY;
	const NearRows all = nearPairs( checker, query.get(), q, def );
	ASSERT_EQ( LW_OK, all.status );
	for ( const std::uint32_t capacity : { 0u, 1u, 3u } )
	{
		const NearRows few = nearPairs( checker, query.get(), q, def, capacity );
		ASSERT_EQ( LW_OK, few.status );
		EXPECT_EQ( all.total, few.total );
		EXPECT_EQ( all.links, few.links );
		for ( std::size_t k = 0; k < few.rows.size(); ++k )
		{
			EXPECT_EQ( bodiesOf( all.rows[k] ), bodiesOf( few.rows[k] ) );
		}
	}
}

TEST_P( NearWorlds, MemoryOfEarlierStatesChangesNoRow )
{
	std::vector<double> q = randomGroupState( world, rng );
	lw_near_def def = lw_near_def_default();
	def.distance = 0.2;
	leeway::Query cold = queryOf( checker, false );
	for ( int i = 0; i < 8; ++i )
	{
		for ( double& value : q )
		{
			value += rng.uniform( -0.02, 0.02 );
		}
		lw_query_reset( cold.get() );
		const NearRows a = nearPairs( checker, query.get(), q, def ), b = nearPairs( checker, cold.get(), q, def );
		ASSERT_EQ( b.total, a.total );
		for ( std::size_t k = 0; k < a.rows.size(); ++k )
		{
			EXPECT_NEAR( a.rows[k].clearance.upper, b.rows[k].clearance.upper, 1e-11 );
		}
	}
}

/// As a controller: small steps, turns, and now and then a jump.
TEST_P( NearWorlds, AStaleBoundMissesNoPair )
{
	std::vector<double> q = randomGroupState( world, rng ), step( q.size() );
	lw_near_def def = lw_near_def_default();
	leeway::Query cold = queryOf( checker, false );
	for ( int i = 0; i < 240; ++i )
	{
		if ( i % 80 == 0 )
		{
			q = randomGroupState( world, rng );
		}
		def.distance = i % 7 == 0 ? 0.3 : 0.2;
		const double speed = rng.decade( -4, -2 );
		for ( std::size_t k = 0; k < q.size(); ++k )
		{
			step[k] = i % 40 == 0 ? rng.uniform( -1, 1 ) : step[k];
			q[k] += speed * step[k];
		}
		const NearRows a = nearPairs( checker, query.get(), q, def ), b = nearPairs( checker, cold.get(), q, def );
		ASSERT_EQ( b.total, a.total );
		for ( std::size_t k = 0; k < a.rows.size(); ++k )
		{
			ASSERT_EQ( a.rows[k].clearance.kind, b.rows[k].clearance.kind );
			ASSERT_NEAR( a.rows[k].clearance.upper, b.rows[k].clearance.upper, 1e-11 );
			ASSERT_NEAR( a.rows[k].clearance.lower, b.rows[k].clearance.lower, 1e-11 );
		}
	}
}

INSTANTIATE_TEST_SUITE_P( Random, NearWorlds, testing::Range( 0, 24 ) );

leeway::Shape primitive( lw_shape_type type, double x, double y = 0, double z = 0 )
{
	const double size[3] = { x, y, z };
	lw_shape* shape = nullptr;
	EXPECT_EQ( LW_OK, lw_shape_create_primitive( type, size, nullptr, nullptr, &shape ) );
	return leeway::Shape::adopt( shape );
}

/// One sliding link with bodies of one shape, beside obstacles of that shape.
leeway::Checker crowd(
    const std::vector<lw_transform>& bodies, const std::vector<lw_transform>& obstacles, const lw_shape* shape )
{
	lw_robot_def robot_def = lw_robot_def_default();
	const char* links[2] = { "base", "slider" };
	lw_joint_def joint = lw_joint_def_default();
	joint.name = "slide";
	joint.type = LW_JOINT_PRISMATIC;
	joint.parent = 0;
	joint.child = 1;
	joint.lower = -1;
	joint.upper = 1;
	std::vector<lw_body_def> body_defs;
	for ( const lw_transform& pose : bodies )
	{
		lw_body_def body = {};
		body.link = 1;
		body.shape = shape;
		body.link_from_shape = pose;
		body_defs.push_back( body );
	}
	robot_def.link_names = links;
	robot_def.link_count = 2;
	robot_def.joints = &joint;
	robot_def.joint_count = 1;
	robot_def.bodies = body_defs.data();
	robot_def.body_count = static_cast<std::uint32_t>( bodies.size() );
	lw_robot* robot = nullptr;
	EXPECT_EQ( LW_OK, lw_robot_create( &robot_def, nullptr, nullptr, &robot ) );
	const leeway::Robot robot_owner = leeway::Robot::adopt( robot );
	std::vector<lw_scene_shape_def> shapes;
	for ( const lw_transform& pose : obstacles )
	{
		shapes.push_back( { shape, 0, pose } );
	}
	const char* name = "obstacles";
	lw_scene_def scene_def = lw_scene_def_default();
	scene_def.shapes = shapes.data();
	scene_def.shape_count = static_cast<std::uint32_t>( shapes.size() );
	scene_def.object_names = &name;
	scene_def.object_count = 1;
	lw_scene* scene = nullptr;
	EXPECT_EQ( LW_OK, lw_scene_create( &scene_def, nullptr, nullptr, &scene ) );
	const leeway::Scene scene_owner = leeway::Scene::adopt( scene );
	lw_checker_def def = lw_checker_def_default();
	def.robot = robot;
	def.scene = scene;
	lw_checker* checker = nullptr;
	EXPECT_EQ( LW_OK, lw_checker_create( &def, nullptr, nullptr, &checker ) );
	return leeway::Checker::adopt( checker );
}

TEST( Near, ManyRowsAreInAnotherOrderThanTheirDistances )
{
	SeededRng rng( 20261204 );
	for ( int round = 0; round < 12; ++round )
	{
		// on a grid many distances are equal; one obstacle is very far; all are equally far; anywhere
		std::vector<lw_transform> bodies( 36, lw_transform_identity() ), obstacles = bodies;
		for ( std::size_t i = 0; i < bodies.size(); ++i )
		{
			for ( std::size_t k = 0; k < 3; ++k )
			{
				const bool grid = round % 4 == 0, same = round % 4 == 2;
				bodies[i].t[k] = same ? 0 : grid ? 0.25 * std::floor( rng.uniform( 0, 4 ) ) : rng.uniform( 0, 1 );
				obstacles[i].t[k] = same ? 2 : 2 + ( grid ? 0.25 * std::floor( rng.uniform( 0, 4 ) ) : rng.uniform( 0, 1 ) );
			}
		}
		obstacles[7].t[0] = round % 4 == 1 ? 1e7 : obstacles[7].t[0];
		const leeway::Shape ball = primitive( LW_SHAPE_SPHERE, 0.01 );
		const leeway::Checker checker = crowd( bodies, obstacles, ball.get() );
		const leeway::Query query = queryOf( checker.get() );
		lw_near_def def = lw_near_def_default();
		def.distance = INFINITY;
		const NearRows all = nearPairs( checker.get(), query.get(), { 0.0 }, def );
		ASSERT_EQ( LW_OK, all.status );
		ASSERT_EQ( all.rows.size(), 1296u );
		const auto key = []( const lw_near_pair& row )
		{ return std::make_tuple( row.clearance.upper, row.self, row.body_a, row.body_b ); };
		for ( std::size_t i = 1; i < all.rows.size(); ++i )
		{
			ASSERT_LT( key( all.rows[i - 1] ), key( all.rows[i] ) ) << "round " << round << ", row " << i;
		}
		for ( const std::uint32_t capacity : { 1u, 5u, 100u, 1000u, 1295u } )
		{
			const NearRows few = nearPairs( checker.get(), query.get(), { 0.0 }, def, capacity );
			ASSERT_EQ( few.rows.size(), capacity );
			EXPECT_EQ( few.total, 1296u );
			for ( std::size_t i = 0; i < capacity; ++i )
			{
				ASSERT_EQ( key( all.rows[i] ), key( few.rows[i] ) ) << "capacity " << capacity << ", row " << i;
			}
		}
	}
}

lw_transform poseIn( SeededRng& rng, double size )
{
	const double at[3] = { rng.uniform( 0, size ), rng.uniform( 0, size ), rng.uniform( 0, size ) };
	double xyzw[4];
	rng.quaternion( xyzw );
	lw_transform pose;
	EXPECT_EQ( LW_OK, lw_transform_from_quaternion( at, xyzw, &pose ) );
	return pose;
}

TEST( Near, ABoxThatTouchesOrIsNearHasAnotherRowThanItsPairAlone )
{
	SeededRng rng( 20261206 );
	const leeway::Shape box = primitive( LW_SHAPE_BOX, 0.3, 0.2, 0.1 );
	for ( int round = 0; round < 4; ++round )
	{
		std::vector<lw_transform> bodies, obstacles;
		for ( int i = 0; i < 13; ++i )
		{
			bodies.push_back( poseIn( rng, 0.3 ) );
			obstacles.push_back( poseIn( rng, 0.3 ) );
		}
		const leeway::Checker checker = crowd( bodies, obstacles, box.get() );
		const leeway::Query query = queryOf( checker.get() );
		lw_near_def def = lw_near_def_default();
		def.distance = INFINITY;
		const NearRows all = nearPairs( checker.get(), query.get(), { 0.0 }, def );
		ASSERT_EQ( all.rows.size(), bodies.size() * obstacles.size() );
		int touching = 0;
		for ( const lw_near_pair& row : all.rows )
		{
			const lw_range exact = lw_range_exact();
			lw_clearance alone;
			ASSERT_EQ( LW_OK, lw_shape_distance( box.get(), &bodies[row.body_a], box.get(), &obstacles[row.body_b], &exact,
			                      query.get(), &alone ) );
			touching += alone.upper == 0 ? 1 : 0;
			ASSERT_EQ( row.clearance.kind == LW_CLEARANCE_VIOLATION, alone.upper == 0 );
			ASSERT_NEAR( row.clearance.upper, alone.upper, 1e-12 );
			ASSERT_NEAR( row.clearance.lower, alone.lower, 3e-12 );
		}
		EXPECT_GT( touching, 10 );
	}
}

TEST( Near, BadArgumentsReadAsNoClearance )
{
	const EdgeWorld world = randomWorld( 77 );
	const lw_checker* checker = world.checker.get();
	const leeway::Query query = queryOf( checker );
	std::vector<double> q = world.home, links( lw_robot_link_count( world.robot.get() ), 1.0 );
	std::uint32_t count = 7;
	lw_near_def def = lw_near_def_default();
	def.link_clearance = links.data();
	const auto status = [&] { return lw_checker_near( checker, query.get(), q.data(), &def, nullptr, 0, &count ); };
	const auto refused = [&]
	{
		count = 7;
		std::fill( links.begin(), links.end(), 1.0 );
		return status() == LW_ERROR_INVALID_ARGUMENT && count == 0 && links[0] == -INFINITY;
	};
	EXPECT_EQ( LW_OK, status() );
	for ( const double bad : { 0.0, -1.0, static_cast<double>( NAN ) } )
	{
		def.distance = bad;
		EXPECT_TRUE( refused() ) << bad;
	}
	def.distance = 0.1;
	def.alpha = 1;
	EXPECT_TRUE( refused() );
	def.alpha = 0;
	def.tie_width = NAN;
	EXPECT_TRUE( refused() );
	def.tie_width = 0;
	def.flags = static_cast<lw_check_flags>( 0 );
	EXPECT_TRUE( refused() );
	def.flags = LW_CHECK_BOTH;
	q[0] = NAN;
	EXPECT_TRUE( refused() );
	q[0] = world.home[0];
	EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT, lw_checker_near( checker, query.get(), q.data(), &def, nullptr, 3, &count ) );
	EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT, lw_checker_near( checker, query.get(), q.data(), &def, nullptr, 0, nullptr ) );
	EXPECT_EQ( LW_ERROR_INVALID_DEF, lw_checker_near( checker, query.get(), q.data(), nullptr, nullptr, 0, &count ) );
	def.cookie = 0;
	EXPECT_EQ( LW_ERROR_INVALID_DEF, status() );
}

} // namespace
