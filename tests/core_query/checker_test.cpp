// SPDX-License-Identifier: BSD-3-Clause
// Scenes and checkers against all pairs one by one; verdicts, errors, allocations, threads.
#include "shapes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <thread>

namespace
{

const double inf = std::numeric_limits<double>::infinity();

/// A random tree of links with one or two bodies each, in a random scene; every joint type but floating has its turn.
class World
{
public:
	lw_robot* robot = nullptr;
	lw_scene* scene = nullptr;
	lw_checker* checker = nullptr;
	std::vector<uint32_t> group; ///< variables
	std::vector<double> reference;
	std::vector<lw_link_pair> allowed_links;
	std::vector<lw_link_object_pair> allowed_objects;
	lw_status status = LW_OK; ///< of the first creation that failed

	World( SeededRng& rng, int links, int obstacles, const lw_allocator* allocator = nullptr )
	{
		build_robot( rng, static_cast<uint32_t>( links ), allocator );
		if ( status == LW_OK )
		{
			build_scene( rng, static_cast<uint32_t>( obstacles ), allocator );
		}
		if ( status == LW_OK )
		{
			build_checker( rng, allocator );
		}
	}
	World( const World& ) = delete;
	World& operator=( const World& ) = delete;
	~World()
	{
		lw_checker_release( checker );
		lw_scene_release( scene );
		lw_robot_release( robot );
	}

	std::vector<double> random_state( SeededRng& rng ) const
	{
		std::vector<double> q( group.size() );
		for ( double& value : q )
		{
			value = rng.uniform( -1.5, 1.5 );
		}
		return q;
	}

private:
	void build_robot( SeededRng& rng, uint32_t links, const lw_allocator* allocator )
	{
		std::vector<std::string> names, joint_names;
		std::vector<const char*> name_pointers;
		std::vector<lw_joint_def> joints;
		std::vector<lw_body_def> bodies;
		std::vector<ShapePtr> shapes;
		for ( uint32_t i = 0; i < links; ++i )
		{
			names.push_back( "link" + std::to_string( i ) );
			joint_names.push_back( "joint" + std::to_string( i ) );
		}
		for ( uint32_t i = 0; i < links; ++i )
		{
			name_pointers.push_back( names[i].c_str() );
			for ( int k = rng.integer( 0, 2 ); k > 0; --k )
			{
				shapes.push_back(
				    rng.integer( 0, 2 ) == 0 ? makePrimitive( LW_SHAPE_CAPSULE, 0.05, 0.2 ) : randomSoup( rng, 30, 0.1 ) );
				bodies.push_back( { shapes.back().get(), i, randomPose( rng, 0.1 ) } );
			}
			if ( i > 0 )
			{
				lw_joint_def joint = lw_joint_def_default();
				const lw_joint_type types[5] = {
				    LW_JOINT_FIXED, LW_JOINT_REVOLUTE, LW_JOINT_CONTINUOUS, LW_JOINT_PRISMATIC, LW_JOINT_REVOLUTE };
				joint.name = joint_names[i].c_str();
				joint.type = types[rng.integer( 0, 4 )];
				joint.parent = static_cast<uint32_t>( rng.integer( std::max( 0, int( i ) - 3 ), int( i ) - 1 ) );
				joint.child = i;
				joint.parent_from_joint = randomPose( rng, 0.4 );
				for ( double& axis : joint.axis )
				{
					axis = rng.uniform( -1, 1 );
				}
				joint.lower = -2;
				joint.upper = 2;
				joints.push_back( joint );
			}
		}
		for ( int i = 0; i < 4; ++i )
		{
			allowed_links.push_back( { static_cast<uint32_t>( rng.integer( 0, int( links ) - 1 ) ),
			    static_cast<uint32_t>( rng.integer( 0, int( links ) - 1 ) ) } );
		}
		lw_robot_def def = lw_robot_def_default();
		def.name = "random";
		def.link_names = name_pointers.data();
		def.link_count = links;
		def.joints = joints.data();
		def.joint_count = static_cast<uint32_t>( joints.size() );
		def.bodies = bodies.data();
		def.body_count = static_cast<uint32_t>( bodies.size() );
		def.allowed_pairs = allowed_links.data();
		def.allowed_pair_count = static_cast<uint32_t>( allowed_links.size() );
		lw_diag diag = {};
		status = lw_robot_create( &def, allocator, &diag, &robot );
	}

	void build_scene( SeededRng& rng, uint32_t obstacles, const lw_allocator* allocator )
	{
		std::vector<std::string> names;
		std::vector<const char*> name_pointers;
		std::vector<lw_scene_shape_def> placed;
		std::vector<ShapePtr> shapes;
		for ( uint32_t i = 0; i < obstacles; ++i )
		{
			names.push_back( "object" + std::to_string( i ) );
			shapes.push_back( i % 3 == 0 ? makePrimitive( LW_SHAPE_BOX, 0.3, 0.2, 0.1 ) : randomSoup( rng, 50, 0.2 ) );
			for ( int k = rng.integer( 1, 2 ); k > 0; --k )
			{
				placed.push_back( { shapes.back().get(), i, randomPose( rng, 2 ) } );
			}
		}
		for ( const std::string& name : names )
		{
			name_pointers.push_back( name.c_str() );
		}
		lw_scene_def def = lw_scene_def_default();
		def.object_names = name_pointers.data();
		def.object_count = obstacles;
		def.shapes = placed.data();
		def.shape_count = static_cast<uint32_t>( placed.size() );
		status = lw_scene_create( &def, allocator, nullptr, &scene );
	}

	void build_checker( SeededRng& rng, const lw_allocator* allocator )
	{
		for ( uint32_t variable = 0; variable < lw_robot_variable_count( robot ); ++variable )
		{
			reference.push_back( rng.uniform( -1, 1 ) );
			if ( rng.integer( 0, 2 ) > 0 )
			{
				group.push_back( variable );
			}
		}
		std::shuffle( group.begin(), group.end(), rng.engine() );
		for ( int i = 0; i < 3 && lw_scene_object_count( scene ) > 0; ++i )
		{
			allowed_objects.push_back( { static_cast<uint32_t>( rng.integer( 0, int( lw_robot_link_count( robot ) ) - 1 ) ),
			    static_cast<uint32_t>( rng.integer( 0, int( lw_scene_object_count( scene ) ) - 1 ) ) } );
		}
		lw_checker_def def = lw_checker_def_default();
		def.robot = robot;
		def.scene = scene;
		const uint32_t none = 0;
		def.variables = group.empty() ? &none : group.data(); // NULL would mean all
		def.variable_count = static_cast<uint32_t>( group.size() );
		def.reference = reference.data();
		def.allowed = allowed_objects.data();
		def.allowed_count = static_cast<uint32_t>( allowed_objects.size() );
		lw_diag diag = {};
		status = lw_checker_create( &def, allocator, &diag, &checker );
	}
};

std::vector<double> full_state( const World& world, const std::vector<double>& q )
{
	std::vector<double> full = world.reference;
	for ( std::size_t i = 0; i < q.size(); ++i )
	{
		full[world.group[i]] = q[i];
	}
	return full;
}

/// Smallest environment distance, pair by pair with the plain query.
double all_environment_pairs( const World& world, const std::vector<lw_transform>& poses, lw_query* query )
{
	double best = inf;
	for ( uint32_t body = 0; body < lw_robot_body_count( world.robot ); ++body )
	{
		lw_body_def def = lw_robot_body( world.robot, body );
		lw_transform pose = lw_transform_multiply( &poses[def.link], &def.link_from_shape );
		for ( uint32_t shape = 0; shape < lw_scene_shape_count( world.scene ); ++shape )
		{
			lw_scene_shape_def obstacle = lw_scene_shape( world.scene, shape );
			bool allowed = std::any_of( world.allowed_objects.begin(), world.allowed_objects.end(),
			    [&]( lw_link_object_pair p ) { return p.link == def.link && p.object == obstacle.object; } );
			lw_clearance out;
			if ( !allowed && lw_shape_distance( def.shape, &pose, obstacle.shape, &obstacle.world_from_shape, nullptr, query,
			                     &out ) == LW_OK )
			{
				best = std::min( best, out.upper );
			}
		}
	}
	return best;
}

/// True if the relative pose of two links differs between random states of the group.
bool moves_against( const World& world, uint32_t a, uint32_t b, SeededRng& rng )
{
	std::vector<lw_transform> poses( lw_robot_link_count( world.robot ) );
	lw_transform first = lw_transform_identity();
	for ( int i = 0; i < 3; ++i )
	{
		std::vector<double> full = full_state( world, world.random_state( rng ) );
		EXPECT_EQ( LW_OK, lw_robot_fk( world.robot, full.data(), poses.data() ) );
		lw_transform inverse = lw_transform_inverse( &poses[a] );
		lw_transform relative = lw_transform_multiply( &inverse, &poses[b] );
		double change = 0;
		for ( int r = 0; r < 3; ++r )
		{
			change = std::max( change, std::abs( relative.t[r] - first.t[r] ) );
			for ( int c = 0; c < 3; ++c )
			{
				change = std::max( change, std::abs( relative.r[r][c] - first.r[r][c] ) );
			}
		}
		if ( i > 0 && change > 1e-9 )
		{
			return true;
		}
		first = relative;
	}
	return false;
}

double all_self_pairs( const World& world, const std::vector<lw_transform>& poses, lw_query* query, SeededRng& rng )
{
	double best = inf;
	uint32_t bodies = lw_robot_body_count( world.robot );
	for ( uint32_t i = 0; i < bodies; ++i )
	{
		for ( uint32_t j = i + 1; j < bodies; ++j )
		{
			lw_body_def a = lw_robot_body( world.robot, i ), b = lw_robot_body( world.robot, j );
			if ( lw_robot_pair_allowed( world.robot, a.link, b.link ) || !moves_against( world, a.link, b.link, rng ) )
			{
				continue;
			}
			lw_transform pose_a = lw_transform_multiply( &poses[a.link], &a.link_from_shape );
			lw_transform pose_b = lw_transform_multiply( &poses[b.link], &b.link_from_shape );
			lw_clearance out;
			EXPECT_EQ( LW_OK, lw_shape_distance( a.shape, &pose_a, b.shape, &pose_b, nullptr, query, &out ) );
			best = std::min( best, out.upper );
		}
	}
	return best;
}

void expect_distance( const lw_clearance& got, double want )
{
	if ( want == inf )
	{
		EXPECT_EQ( got.kind, LW_CLEARANCE_FAR );
		EXPECT_EQ( got.lower, inf );
		return;
	}
	EXPECT_NEAR( got.upper, want, 1e-9 );
	EXPECT_LE( got.lower, want + 1e-12 );
	EXPECT_GE( got.lower, want - 1e-9 );
	EXPECT_NE( got.a, LW_INVALID_INDEX );
	EXPECT_NE( got.b, LW_INVALID_INDEX );
}

/// Distance of two links, or of a link and an object, at these poses.
double distanceOf(
    const World& world, const std::vector<lw_transform>& poses, bool self, uint32_t link, uint32_t other, lw_query* query )
{
	double best = inf;
	for ( uint32_t i = 0; i < lw_robot_body_count( world.robot ); ++i )
	{
		const lw_body_def a = lw_robot_body( world.robot, i );
		const lw_transform pose_a = lw_transform_multiply( &poses[a.link], &a.link_from_shape );
		const uint32_t count = self ? lw_robot_body_count( world.robot ) : lw_scene_shape_count( world.scene );
		for ( uint32_t k = 0; k < count && a.link == link; ++k )
		{
			const lw_body_def b = lw_robot_body( world.robot, self ? k : i );
			const lw_scene_shape_def obstacle = self ? lw_scene_shape_def() : lw_scene_shape( world.scene, k );
			const lw_transform pose_b =
			    self ? lw_transform_multiply( &poses[b.link], &b.link_from_shape ) : obstacle.world_from_shape;
			lw_clearance out;
			if ( ( self ? b.link : obstacle.object ) == other )
			{
				EXPECT_EQ( LW_OK,
				    lw_shape_distance( a.shape, &pose_a, self ? b.shape : obstacle.shape, &pose_b, nullptr, query, &out ) );
				best = std::min( best, out.upper );
			}
		}
	}
	return best;
}

/// The reason of a state that is not free names a pair that is too near.
void expectReason( const World& world, lw_query* query, const std::vector<double>& q, double min_d,
    const std::vector<lw_transform>& poses, lw_query* plain )
{
	bool free = false;
	lw_state_reason reason;
	ASSERT_EQ( LW_OK, lw_checker_is_free( world.checker, query, q.data(), LW_CHECK_BOTH, min_d, &free, &reason ) );
	EXPECT_EQ( free ? LW_VERDICT_FREE : LW_VERDICT_BLOCKED, reason.verdict );
	EXPECT_EQ( free, reason.pair.kind == LW_CLEARANCE_UNKNOWN );
	if ( !free )
	{
		EXPECT_LE( reason.pair.upper, min_d );
		EXPECT_LE( distanceOf( world, poses, reason.self, reason.pair.a, reason.pair.b, plain ), min_d + 1e-9 );
	}
}

} // namespace

TEST( Checker, DiffersFromAllPairs )
{
	SeededRng rng;
	int environment_free = 0, environment_hit = 0, self_free = 0, self_hit = 0;
	for ( int i = 0; i < 60; ++i )
	{
		World world( rng, rng.integer( 2, 14 ), rng.integer( 0, 60 ) );
		ASSERT_EQ( LW_OK, world.status );
		QueryPtr plain = makeQuery(), query = makeQuery( nullptr, world.checker );
		for ( int k = 0; k < 10; ++k )
		{
			std::vector<double> q = world.random_state( rng ), full = full_state( world, q );
			std::vector<lw_transform> poses( lw_robot_link_count( world.robot ) );
			ASSERT_EQ( LW_OK, lw_robot_fk( world.robot, full.data(), poses.data() ) );
			double environment = all_environment_pairs( world, poses, plain.get() );
			double self = all_self_pairs( world, poses, plain.get(), rng );
			lw_state_result got;
			ASSERT_EQ(
			    LW_OK, lw_checker_state( world.checker, query.get(), q.data(), LW_CHECK_BOTH, nullptr, false, &got ) );
			SCOPED_TRACE( ::testing::Message() << "world " << i << " state " << k );
			expect_distance( got.environment, environment );
			expect_distance( got.self, self );
			EXPECT_EQ( got.verdict, environment > 0 && self > 0 ? LW_VERDICT_FREE : LW_VERDICT_BLOCKED );
			++( environment > 0 ? environment_free : environment_hit );
			++( self > 0 ? self_free : self_hit );
			// the planner's question
			double min_d = 0.02;
			lw_range margin = { min_d, std::nextafter( min_d, 1.0 ), 0 };
			ASSERT_EQ( LW_OK, lw_checker_state( world.checker, query.get(), q.data(), LW_CHECK_BOTH, &margin, true, &got ) );
			EXPECT_EQ( got.verdict, std::min( environment, self ) > min_d ? LW_VERDICT_FREE : LW_VERDICT_BLOCKED );
			for ( const double asked : { 0.0, min_d, 0.3 } )
			{
				bool both = false, one = false;
				ASSERT_EQ( LW_OK,
				    lw_checker_is_free( world.checker, query.get(), q.data(), LW_CHECK_BOTH, asked, &both, nullptr ) );
				EXPECT_EQ( both, std::min( environment, self ) > asked ) << asked;
				expectReason( world, query.get(), q, asked, poses, plain.get() );
				ASSERT_EQ(
				    LW_OK, lw_checker_is_free( world.checker, query.get(), q.data(), LW_CHECK_SELF, asked, &one, nullptr ) );
				EXPECT_EQ( one, self > asked ) << asked;
			}
		}
	}
	EXPECT_GE( std::min( { environment_free, environment_hit, self_free, self_hit } ), 50 );
}

TEST( Checker, ErrorReadsAsFree )
{
	SeededRng rng;
	World world( rng, 8, 5 );
	QueryPtr query = makeQuery( nullptr, world.checker ), too_small = makeQuery();
	std::vector<double> q( world.group.size() );
	lw_state_result out;
	for ( double bad : { std::nan( "" ), inf, -inf } )
	{
		q[0] = bad;
		EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT,
		    lw_checker_state( world.checker, query.get(), q.data(), LW_CHECK_BOTH, nullptr, false, &out ) );
		EXPECT_EQ( out.verdict, LW_VERDICT_UNKNOWN );
		EXPECT_EQ( out.environment.lower, 0 );
		EXPECT_EQ( out.environment.upper, inf );
		EXPECT_EQ( out.self.kind, LW_CLEARANCE_UNKNOWN );
		bool free = true;
		lw_state_reason reason = { LW_VERDICT_FREE, false, {} };
		EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT,
		    lw_checker_is_free( world.checker, query.get(), q.data(), LW_CHECK_BOTH, 0, &free, &reason ) );
		EXPECT_FALSE( free );
		EXPECT_EQ( reason.verdict, LW_VERDICT_UNKNOWN );
		EXPECT_EQ( reason.pair.kind, LW_CLEARANCE_UNKNOWN );
	}
	for ( double bad : { -0.1, inf, std::nan( "" ) } )
	{
		bool free = true;
		std::vector<double> zero( world.group.size() );
		EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT,
		    lw_checker_is_free( world.checker, query.get(), zero.data(), LW_CHECK_BOTH, bad, &free, nullptr ) )
		    << bad;
		EXPECT_FALSE( free ) << bad;
	}
	q[0] = 0;
	EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT,
	    lw_checker_state( world.checker, too_small.get(), q.data(), LW_CHECK_BOTH, nullptr, false, &out ) );
	EXPECT_EQ( LW_OK, lw_checker_state( world.checker, query.get(), q.data(), LW_CHECK_BOTH, nullptr, false, &out ) );
}

TEST( Checker, BadDefIsAccepted )
{
	SeededRng rng;
	World world( rng, 8, 5 );
	lw_checker* checker = nullptr;
	lw_diag diag = {};
	lw_checker_def def = lw_checker_def_default();
	EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT, lw_checker_create( &def, nullptr, &diag, &checker ) );
	def.robot = world.robot;
	uint32_t twice[2] = { 0, 0 }, beyond[1] = { 10000 };
	def.variables = twice;
	def.variable_count = 2;
	EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT, lw_checker_create( &def, nullptr, &diag, &checker ) );
	def.variables = beyond;
	def.variable_count = 1;
	EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT, lw_checker_create( &def, nullptr, &diag, &checker ) );
	def.variables = nullptr;
	std::vector<double> reference( lw_robot_variable_count( world.robot ), NAN );
	def.reference = reference.data();
	EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT, lw_checker_create( &def, nullptr, &diag, &checker ) );
	EXPECT_NE( diag.message[0], '\0' );
	lw_checker_def zero = {};
	zero.robot = world.robot;
	EXPECT_EQ( LW_ERROR_INVALID_DEF, lw_checker_create( &zero, nullptr, &diag, &checker ) );
	EXPECT_EQ( checker, nullptr );
}

TEST( Checker, QueryAllocates )
{
	SeededRng rng;
	FailingAllocator counting;
	World world( rng, 10, 12, &counting.allocator );
	ASSERT_EQ( LW_OK, world.status );
	QueryPtr query = makeQuery( nullptr, world.checker, lw_query_def_default(), &counting.allocator );
	std::size_t before = counting.calls;
	for ( int i = 0; i < 100; ++i )
	{
		std::vector<double> qa = world.random_state( rng ), qb = world.random_state( rng );
		lw_state_result state;
		ASSERT_EQ( LW_OK, lw_checker_state( world.checker, query.get(), qa.data(), LW_CHECK_BOTH, nullptr, false, &state ) );
		lw_edge_def def = lw_edge_def_default();
		lw_edge_result edge;
		ASSERT_EQ( LW_OK, lw_checker_edge( world.checker, query.get(), qa.data(), qb.data(), &def, &edge ) );
	}
	EXPECT_EQ( before, counting.calls );
}

TEST( Checker, FailedAllocationLeaks )
{
	for ( std::size_t fail_at = 1;; ++fail_at )
	{
		FailingAllocator counting;
		counting.fail_at = fail_at;
		lw_status status;
		{
			SeededRng rng;
			World world( rng, 5, 4, &counting.allocator );
			status = world.status;
		}
		ASSERT_EQ( counting.live, 0u ) << "failing at call " << fail_at;
		if ( status == LW_OK )
		{
			EXPECT_GT( fail_at, 10u );
			break;
		}
		ASSERT_EQ( status, LW_ERROR_OUT_OF_MEMORY );
	}
}

TEST( Checker, ThreadsDisagree )
{
	SeededRng rng;
	World world( rng, 12, 15 );
	std::vector<std::vector<double>> states;
	for ( int i = 0; i < 200; ++i )
	{
		states.push_back( world.random_state( rng ) );
	}
	const int thread_count = 4;
	std::vector<std::vector<double>> answers( thread_count );
	std::vector<std::thread> threads;
	for ( int t = 0; t < thread_count; ++t )
	{
		threads.emplace_back(
		    [&, t]
		    {
			    QueryPtr query = makeQuery( nullptr, world.checker );
			    for ( const std::vector<double>& q : states )
			    {
				    lw_state_result out;
				    lw_checker_state( world.checker, query.get(), q.data(), LW_CHECK_BOTH, nullptr, false, &out );
				    answers[t].push_back( out.environment.lower );
				    answers[t].push_back( out.self.upper );
			    }
		    } );
	}
	for ( std::thread& thread : threads )
	{
		thread.join();
	}
	for ( int t = 1; t < thread_count; ++t )
	{
		EXPECT_EQ( answers[0], answers[t] ); // same bits
	}
}

TEST( Checker, QueryKeepsPosesOfAnotherChecker )
{
	SeededRng rng;
	World one( rng, 14, 12 ), two( rng, 5, 4 ); // a query fits both
	lw_query_def def = lw_query_def_default();
	def.warm_start = false;
	// made for the larger, used for both in turn
	QueryPtr shared = makeQuery( nullptr, one.checker, def ), also = makeQuery( nullptr, two.checker, def );
	int compared = 0;
	for ( int i = 0; i < 50; ++i )
	{
		for ( const World* world : { &one, &two } )
		{
			QueryPtr fresh = makeQuery( nullptr, world->checker, def );
			std::vector<double> q = world->random_state( rng );
			lw_state_result want, got;
			ASSERT_EQ(
			    LW_OK, lw_checker_state( world->checker, fresh.get(), q.data(), LW_CHECK_BOTH, nullptr, false, &want ) );
			for ( lw_query* query : { shared.get(), also.get() } )
			{
				if ( lw_checker_state( world->checker, query, q.data(), LW_CHECK_BOTH, nullptr, false, &got ) == LW_OK )
				{
					EXPECT_EQ( want.environment.upper, got.environment.upper );
					EXPECT_EQ( want.self.upper, got.self.upper );
					++compared;
				}
			}
		}
	}
	EXPECT_GE( compared, 150 ); // at least one query fits both
}
