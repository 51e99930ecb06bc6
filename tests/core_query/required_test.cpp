// SPDX-License-Identifier: BSD-3-Clause
// Model only the meshes that a scene requires: deferred meshes, and obstacles that a group cannot come near to. Random
// robots and scenes against the same ones with everything modelled; states inside and outside of the limits. No answer may
// differ.
#include "leeway/blob.h"
#include "checker_handles.hpp"
#include "random_robot.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <limits>
#include <thread>

namespace
{

const double inf = std::numeric_limits<double>::infinity();

/// Counters of a test's deferred meshes.
struct Counts
{
	std::atomic<int> made{ 0 }, released{ 0 };
	std::atomic<bool> fail{ false };
};

/// A deferred mesh that turns out to be another, existing one.
struct Later
{
	ShapePtr shape;
	Counts* counts;
	static lw_status make( void* user, lw_diag*, lw_shape** out )
	{
		Later* later = static_cast<Later*>( user );
		if ( later->counts->fail )
		{
			return LW_ERROR_OUT_OF_MEMORY;
		}
		++later->counts->made;
		*out = lw_shape_retain( later->shape.get() );
		return LW_OK;
	}
	static void release( void* user )
	{
		Later* later = static_cast<Later*>( user );
		++later->counts->released;
		delete later;
	}
};

lw_deferred_def laterDef( const lw_shape* shape, Counts& counts )
{
	const lw_shape_info info = lw_shape_get_info( shape );
	lw_deferred_def def = lw_deferred_def_default();
	std::copy( info.box_min, info.box_min + 3, def.box_min );
	std::copy( info.box_max, info.box_max + 3, def.box_max );
	def.triangle_count = info.triangle_count;
	def.make = Later::make;
	def.release = Later::release;
	def.user = new Later{ ShapePtr( lw_shape_retain( shape ) ), &counts };
	return def;
}

ShapePtr defer( const lw_shape* shape, Counts& counts )
{
	lw_deferred_def def = laterDef( shape, counts );
	lw_shape* deferred = nullptr;
	EXPECT_EQ( LW_OK, lw_shape_create_deferred( &def, nullptr, nullptr, &deferred ) );
	return ShapePtr( deferred );
}

/// Robot, scene and group, as they are and with all meshes deferred.
struct World
{
	RobotModel model;
	RobotPtr robot;
	std::vector<ShapePtr> shapes;
	std::vector<lw_scene_shape_def> placed;
	std::vector<uint32_t> group;
	State reference;
	double margin = 0; ///< of all pairs
};

ScenePtr makeScene( const std::vector<lw_scene_shape_def>& placed )
{
	std::vector<std::string> names;
	std::vector<const char*> pointers;
	for ( std::size_t i = 0; i < placed.size(); ++i )
	{
		names.push_back( "object" + std::to_string( i ) );
	}
	for ( const std::string& name : names )
	{
		pointers.push_back( name.c_str() );
	}
	lw_scene_def def = lw_scene_def_default();
	def.object_names = pointers.data();
	def.object_count = static_cast<uint32_t>( names.size() );
	def.shapes = placed.data();
	def.shape_count = static_cast<uint32_t>( placed.size() );
	lw_scene* scene = nullptr;
	EXPECT_EQ( LW_OK, lw_scene_create( &def, nullptr, nullptr, &scene ) );
	return ScenePtr( scene );
}

/// lw_checker_def::prepare of a test: the meshes given to it, and the threads that make them.
struct Preparation
{
	unsigned threads = 0; ///< 0 leaves everything to the checker
	std::size_t calls = 0, shapes = 0;

	static void prepare( void* user, const lw_shape* const* shapes, uint32_t count )
	{
		Preparation& mine = *static_cast<Preparation*>( user );
		++mine.calls;
		mine.shapes += count;
		EXPECT_GE( count, 2u ) << "there is nothing to share";
		EXPECT_LE( count, 64u );
		for ( uint32_t i = 0; i < count; ++i )
		{
			EXPECT_TRUE( lw_shape_peek_info( shapes[i] ).deferred ) << "it was there already";
			EXPECT_EQ( shapes + i, std::find( shapes, shapes + i, shapes[i] ) ) << "twice in one call";
		}
		std::vector<std::thread> threads;
		for ( unsigned t = 0; t < mine.threads; ++t )
		{
			threads.emplace_back(
				[=, &mine]
				{
					for ( uint32_t i = t; i < count; i += mine.threads )
					{
						(void)lw_shape_complete( shapes[i], nullptr );
					}
				} );
		}
		for ( std::thread& thread : threads )
		{
			thread.join();
		}
	}
};

CheckerPtr makeChecker( const lw_robot* robot, const lw_scene* scene, const World& world, double max_d,
	lw_status want = LW_OK, Preparation* preparation = nullptr )
{
	const uint32_t none = 0;
	lw_checker_def def = lw_checker_def_default();
	def.robot = robot;
	def.scene = scene;
	def.variables = world.group.empty() ? &none : world.group.data();
	def.variable_count = static_cast<uint32_t>( world.group.size() );
	def.reference = world.reference.data();
	def.max_d = max_d;
	def.margins.environment = def.margins.self = world.margin;
	def.prepare = preparation != nullptr ? Preparation::prepare : nullptr;
	def.prepare_user = preparation;
	lw_checker* checker = nullptr;
	lw_diag diag = {};
	EXPECT_EQ( want, lw_checker_create( &def, nullptr, &diag, &checker ) ) << diag.message;
	return CheckerPtr( checker );
}

/// Other histories must not matter.
QueryPtr coldQuery( const lw_checker* checker )
{
	const bool hierarchy = true, warm_start = false;
	return makeQuery( checker, hierarchy, warm_start );
}

World randomWorld( SeededRng& rng )
{
	World world;
	RandomRobotOptions options;
	options.joints = rng.integer( 2, 10 );
	options.floating = rng.integer( 0, 2 ) == 0;
	options.size = 0.1;
	options.meshShare = 0.7;
	world.model = randomRobot( rng, options );
	for ( uint32_t i = 0; i < world.model.joints.size(); ++i )
	{
		world.model.allowed.push_back( { world.model.joints[i].parent, world.model.joints[i].child } );
	}
	world.robot = world.model.create();
	world.reference = randomState( rng, world.robot.get() );
	bool chosen = false;
	for ( uint32_t i = 0; i < lw_robot_variable_count( world.robot.get() ); ++i )
	{
		chosen = lw_robot_variable( world.robot.get(), i ).component == 0 ? rng.integer( 0, 2 ) > 0 : chosen;
		if ( chosen )
		{
			world.group.push_back( i );
		}
	}
	double spread = rng.uniform( 1, 5 );
	for ( int i = rng.integer( 1, 30 ); i > 0; --i )
	{
		world.shapes.emplace_back(
			rng.integer( 0, 1 ) != 0 ? randomPrimitive( rng, 0.3, nullptr ) : randomMesh( rng, 20, 0.2, nullptr ) );
		world.placed.push_back(
			{ world.shapes.back().get(), static_cast<uint32_t>( world.placed.size() ), randomTransform( rng, spread ) } );
	}
	return world;
}

/// The same with its meshes deferred.
World deferred( const World& world, Counts& counts )
{
	World out;
	out.group = world.group;
	out.margin = world.margin;
	out.reference = world.reference;
	out.model.linkNames = world.model.linkNames;
	out.model.jointNames = world.model.jointNames;
	out.model.joints = world.model.joints;
	out.model.allowed = world.model.allowed;
	out.model.worldFromRoot = world.model.worldFromRoot;
	const auto take = [&]( const lw_shape* shape )
	{
		bool mesh = lw_shape_get_info( shape ).type == LW_SHAPE_MESH;
		out.shapes.push_back( mesh ? defer( shape, counts ) : ShapePtr( lw_shape_retain( shape ) ) );
		return out.shapes.back().get();
	};
	for ( lw_body_def body : world.model.bodies )
	{
		body.shape = take( body.shape );
		out.model.bodies.push_back( body );
	}
	for ( lw_scene_shape_def shape : world.placed )
	{
		shape.shape = take( shape.shape );
		out.placed.push_back( shape );
	}
	out.robot = out.model.create();
	return out;
}

State groupState( SeededRng& rng, const World& world, double excess )
{
	State full = randomState( rng, world.robot.get(), excess ), q;
	for ( uint32_t variable : world.group )
	{
		q.push_back( full[variable] );
	}
	return q;
}

void expectSame( const lw_clearance& want, const lw_clearance& got, const char* which )
{
	EXPECT_EQ( want.kind, got.kind ) << which << ' ' << want.upper << ' ' << got.upper;
	if ( want.kind != LW_CLEARANCE_VIOLATION ) // there any pair at or below min_d will do
	{
		EXPECT_EQ( want.upper, got.upper ) << which;
		if ( want.lower != got.lower ) // both infinite otherwise
		{
			EXPECT_NEAR( want.lower, got.lower, 1e-12 ) << which;
		}
	}
}

lw_state_result ask( const lw_checker* checker, lw_query* query, const State& q, const lw_range& range )
{
	lw_state_result out;
	EXPECT_EQ( LW_OK, lw_checker_state( checker, query, q.data(), LW_WHAT_BOTH, &range, false, &out ) );
	return out;
}

const lw_range ranges[] = { { 0, inf, 0 }, { 0, 0.05, 0 }, { 0, 0.3, 0 }, { 0.01, 0.1, 0 }, { 0, 5e-324, 0 } };

lw_edge_result askEdge( const lw_checker* checker, lw_query* query, const State& a, const State& b, lw_edge_method method,
	double min_d, lw_status& status )
{
	lw_edge_def def = lw_edge_def_default();
	def.min_d = min_d;
	def.method = method;
	def.max_d = 0.05;
	def.want_proved_until = true;
	lw_edge_result out;
	status = lw_checker_edge( checker, query, a.data(), b.data(), &def, &out );
	return out;
}

} // namespace

TEST( Required, less_changes_an_answer )
{
	SeededRng rng;
	int free = 0, blocked = 0, outside = 0, edges = 0, different = 0, fewer = 0, unmade = 0;
	for ( int i = 0; i < 150 && !HasFailure(); ++i )
	{
		SCOPED_TRACE( ::testing::Message() << "world " << i );
		Counts counts;
		World world = randomWorld( rng );
		world.margin = i % 2 == 0 ? 0 : rng.decade( -2, 0 );
		World lazy = deferred( world, counts );
		ScenePtr scene = makeScene( world.placed ), lazy_scene = makeScene( lazy.placed );
		// beyond everything: nothing is passed over
		CheckerPtr whole = makeChecker( world.robot.get(), scene.get(), world, 1e9 );
		const double limits[] = { inf, 0.1, 0.3 };
		CheckerPtr less = makeChecker( lazy.robot.get(), lazy_scene.get(), lazy, limits[i % 3] );
		const lw_checker_info all = lw_checker_get_info( whole.get() ), some = lw_checker_get_info( less.get() );
		expectSame( all.static_environment, some.static_environment, "static" );
		fewer += some.near_shapes < world.placed.size();
		QueryPtr query = coldQuery( whole.get() ), other = coldQuery( less.get() );
		for ( int k = 0; k < 8; ++k )
		{
			SCOPED_TRACE( ::testing::Message() << "state " << k );
			double excess = k % 4 == 3 ? 1.5 : 0;
			State q = groupState( rng, world, excess ), to = groupState( rng, world, excess );
			for ( const lw_range& range : ranges )
			{
				SCOPED_TRACE( ::testing::Message() << "min_d " << range.min_d << " max_d " << range.max_d );
				lw_state_result want = ask( whole.get(), query.get(), q, range ), got = ask( less.get(), other.get(), q, range );
				EXPECT_EQ( want.verdict, got.verdict );
				expectSame( want.environment, got.environment, "environment" );
				expectSame( want.self, got.self, "self" );
				++( want.environment.kind == LW_CLEARANCE_VIOLATION ? blocked : free );
			}
			outside += excess > 0;
			// also more than the checker was told that anybody asks for
			const double min_d = k % 3 == 0 ? 0.005 : std::min( limits[i % 3], 0.2 ) * rng.uniform( 0.5, 2.5 );
			for ( lw_edge_method method : { LW_EDGE_CERTIFIED, LW_EDGE_STEPS } )
			{
				lw_status want_status, got_status; // a mimic joint without limits has no motion bound
				lw_edge_result want = askEdge( whole.get(), query.get(), q, to, method, min_d, want_status );
				lw_edge_result got = askEdge( less.get(), other.get(), q, to, method, min_d, got_status );
				EXPECT_EQ( want_status, got_status );
				edges += want_status == LW_OK;
				// Proofs are made of coarse distances, which depend on the order of the search. So does which state ends
				// one, and whether it is a refused one or a blocked one; a proof may not contradict a blocked state.
				different += want.verdict != got.verdict;
				EXPECT_FALSE( want.verdict == LW_VERDICT_FREE && got.verdict == LW_VERDICT_BLOCKED );
				EXPECT_FALSE( got.verdict == LW_VERDICT_FREE && want.verdict == LW_VERDICT_BLOCKED );
				if ( got.verdict == LW_VERDICT_BLOCKED && got_status == LW_OK )
				{
					lw_range range = { min_d, std::nextafter( min_d, 1.0 ), 0 };
					State full_a( world.reference.size() ), full_b( full_a ), full_t( full_a ), at;
					lw_checker_full_state( whole.get(), q.data(), full_a.data() );
					lw_checker_full_state( whole.get(), to.data(), full_b.data() );
					lw_robot_interpolate( world.robot.get(), full_a.data(), full_b.data(), got.t, full_t.data() );
					for ( uint32_t variable : world.group )
					{
						at.push_back( full_t[variable] );
					}
					EXPECT_EQ( LW_VERDICT_BLOCKED, ask( whole.get(), query.get(), at, range ).verdict );
				}
				EXPECT_NEAR( want.proved_until, got.proved_until, 0.25 ); // the last window that was proved may be a quarter of the edge
			}
		}
		bool all_made = std::all_of( lazy.shapes.begin(), lazy.shapes.end(),
			[]( const ShapePtr& shape ) { return !lw_shape_peek_info( shape.get() ).deferred; } );
		unmade += !all_made;
		less.reset();
		other.reset();
		lazy_scene.reset();
		lazy = World();
		EXPECT_EQ( counts.released.load(), static_cast<int>( std::count_if( world.placed.begin(), world.placed.end(),
											   []( const lw_scene_shape_def& s )
											   { return lw_shape_get_info( s.shape ).type == LW_SHAPE_MESH; } ) +
											   std::count_if( world.model.bodies.begin(), world.model.bodies.end(), []( const lw_body_def& b )
												   { return lw_shape_get_info( b.shape ).type == LW_SHAPE_MESH; } ) ) );
	}
	EXPECT_GE( std::min( free, blocked ), 200 );
	EXPECT_GE( outside, 100 );
	EXPECT_GE( edges, 1000 );
	EXPECT_LE( different, edges / 200 ) << "edges with another verdict";
	EXPECT_GE( fewer, 40 ) << "scenes of which something is passed over";
	EXPECT_GE( unmade, 20 ) << "worlds in which some mesh was never needed";
}

// The bound itself, against random states: it is proved, so no state may come nearer.
TEST( Required, obstacle_nearer_than_proved )
{
	SeededRng rng;
	int proved = 0, tight = 0;
	for ( int i = 0; i < 120; ++i )
	{
		World world = randomWorld( rng );
		ScenePtr scene = makeScene( world.placed );
		CheckerPtr checker = makeChecker( world.robot.get(), scene.get(), world, inf );
		QueryPtr query = coldQuery( checker.get() );
		std::vector<lw_transform> poses( lw_robot_link_count( world.robot.get() ) );
		std::vector<double> least( world.placed.size(), inf );
		State full = world.reference;
		for ( int k = 0; k < 60; ++k )
		{
			State q = groupState( rng, world, 0 );
			lw_checker_full_state( checker.get(), q.data(), full.data() );
			if ( k % 2 == 0 ) // corners of the box of limits: reach is longest there
			{
				for ( uint32_t variable : world.group )
				{
					lw_variable_info info = lw_robot_variable( world.robot.get(), variable );
					bool limited = std::isfinite( info.lower ) && std::isfinite( info.upper );
					full[variable] = limited ? ( rng.integer( 0, 1 ) != 0 ? info.lower : info.upper ) : full[variable];
				}
			}
			ASSERT_EQ( LW_OK, lw_robot_fk( world.robot.get(), full.data(), poses.data() ) );
			for ( std::size_t s = 0; s < world.placed.size(); ++s )
			{
				double bound = lw_checker_obstacle_distance( checker.get(), static_cast<uint32_t>( s ) );
				if ( bound == 0 || bound == inf )
				{
					continue;
				}
				for ( uint32_t b = 0; b < lw_robot_body_count( world.robot.get() ); ++b )
				{
					lw_body_def body = lw_robot_body( world.robot.get(), b );
					bool moves = false;
					for ( uint32_t link = body.link; lw_robot_link_joint( world.robot.get(), link ) != LW_INVALID_INDEX; )
					{
						uint32_t joint = lw_robot_link_joint( world.robot.get(), link );
						uint32_t leader = joint;
						double share = 1; // 0: it mimics, but stands still
						while ( world.model.joints[leader].mimic != LW_INVALID_INDEX )
						{
							share *= world.model.joints[leader].mimic_multiplier;
							leader = world.model.joints[leader].mimic;
						}
						uint32_t variable = lw_robot_joint_variable( world.robot.get(), leader );
						moves = moves || ( share != 0 && std::find( world.group.begin(), world.group.end(), variable ) != world.group.end() );
						link = lw_robot_joint_parent( world.robot.get(), joint );
					}
					if ( !moves )
					{
						continue;
					}
					lw_transform pose = lw_transform_multiply( &poses[body.link], &body.link_from_shape );
					lw_clearance clearance;
					ASSERT_EQ( LW_OK, lw_shape_distance( body.shape, &pose, world.placed[s].shape, &world.placed[s].world_from_shape,
										  nullptr, query.get(), &clearance ) );
					EXPECT_GE( clearance.upper, bound ) << "world " << i << " shape " << s << " body " << b;
					least[s] = std::min( least[s], clearance.upper );
				}
			}
		}
		for ( std::size_t s = 0; s < world.placed.size(); ++s )
		{
			double bound = lw_checker_obstacle_distance( checker.get(), static_cast<uint32_t>( s ) );
			proved += bound > 0 && bound < inf;
			tight += bound > 0.7 * least[s] && bound < inf;
		}
	}
	EXPECT_GE( proved, 200 );
	EXPECT_GE( tight, 20 ) << "bounds are so loose that this test finds nothing";
}

/// A small ball on a chain of one to three joints.
static World ballOnAChain( SeededRng& rng, double radius, lw_transform* link_from_ball )
{
	World world;
	world.model.link( "root" );
	const int joints = rng.integer( 1, 3 );
	const bool drives = rng.integer( 0, 3 ) == 0; // its first joint roams a plane
	for ( int k = 0; k < joints; ++k )
	{
		lw_joint_def& joint = world.model.joint( "l" + std::to_string( k ),
			k == 0 && drives ? LW_JOINT_PLANAR : k == 0 || rng.integer( 0, 3 ) > 0 ? LW_JOINT_REVOLUTE : LW_JOINT_PRISMATIC,
			static_cast<uint32_t>( k ) );
		joint.parent_from_joint = randomTransform( rng, 0.5 );
		joint.lower = rng.uniform( -3, 0 );
		joint.upper = joint.lower + rng.decade( -1, 0.8 );
		for ( int axis = 0; axis < 3; ++axis )
		{
			joint.position_lower[axis] = -rng.decade( -1, 0.5 );
			joint.position_upper[axis] = rng.decade( -1, 0.5 );
		}
	}
	*link_from_ball = lw_transform_identity();
	link_from_ball->t[0] = drives ? rng.uniform( 0, 0.2 ) : rng.uniform( 0.2, 1 );
	lw_shape* shape = nullptr;
	EXPECT_EQ( LW_OK, lw_shape_create_primitive( LW_SHAPE_SPHERE, &radius, nullptr, nullptr, &shape ) );
	world.model.body( static_cast<uint32_t>( joints ), shape, *link_from_ball );
	world.robot = world.model.create();
	for ( uint32_t v = 0; v < lw_robot_variable_count( world.robot.get() ); ++v )
	{
		world.group.push_back( v );
	}
	world.reference = randomState( rng, world.robot.get() );
	return world;
}

/// An obstacle, a ball as well, in some direction from where the chain's ball is at q.
static void placeBeside( SeededRng& rng, World& world, const lw_transform& link_from_ball, const State& q, double radius, double gap )
{
	std::vector<lw_transform> poses( lw_robot_link_count( world.robot.get() ) );
	ASSERT_EQ( LW_OK, lw_robot_fk( world.robot.get(), q.data(), poses.data() ) );
	lw_transform there = lw_transform_multiply( &poses.back(), &link_from_ball );
	const lw_transform turned = randomTransform( rng, 0 );
	for ( int axis = 0; axis < 3; ++axis )
	{
		there.t[axis] += turned.r[axis][0] * ( 2 * radius + gap );
	}
	lw_shape* shape = nullptr;
	ASSERT_EQ( LW_OK, lw_shape_create_primitive( LW_SHAPE_SPHERE, &radius, nullptr, nullptr, &shape ) );
	world.shapes.emplace_back( shape );
	world.placed.push_back( { shape, static_cast<uint32_t>( world.placed.size() ), there } );
}

// A planner may ask for more room than it told the checker that anybody asks for: then nothing may be passed over. A ball
// swings past obstacles outside of its circle, which it cannot come near to by as much as the checker was told.
TEST( Required, edge_asks_for_more_than_its_checker_was_told )
{
	SeededRng rng;
	int beyond = 0, free = 0, passed_over = 0;
	for ( int i = 0; i < 1000 && !HasFailure(); ++i )
	{
		World world;
		world.model.link( "root" );
		world.model.joint( "arm", LW_JOINT_REVOLUTE, 0 ); // about z
		const double arm = rng.uniform( 0.4, 1 ), radius = 0.002, gap = rng.decade( -1, 0 ), angle = rng.uniform( -1, 1 );
		lw_transform at = lw_transform_identity(), there = at;
		at.t[0] = arm;
		there.t[0] = ( arm + 2 * radius + gap ) * std::cos( angle );
		there.t[1] = ( arm + 2 * radius + gap ) * std::sin( angle );
		lw_shape *ball = nullptr, *obstacle = nullptr;
		ASSERT_EQ( LW_OK, lw_shape_create_primitive( LW_SHAPE_SPHERE, &radius, nullptr, nullptr, &ball ) );
		ASSERT_EQ( LW_OK, lw_shape_create_primitive( LW_SHAPE_SPHERE, &radius, nullptr, nullptr, &obstacle ) );
		world.model.body( 1, ball, at );
		world.robot = world.model.create();
		world.reference = { 0 };
		world.group = { 0 };
		world.shapes.emplace_back( obstacle );
		world.placed.push_back( { obstacle, 0, there } );
		const ScenePtr scene = makeScene( world.placed );
		const CheckerPtr checker = makeChecker( world.robot.get(), scene.get(), world, gap * rng.uniform( 0.4, 1.2 ) );
		const QueryPtr query = coldQuery( checker.get() );
		const lw_checker_info info = lw_checker_get_info( checker.get() );
		passed_over += info.near_shapes == 0;
		for ( double factor : { 0.5, 1.001, 1.05 } )
		{
			lw_status status;
			const lw_edge_result r = askEdge( checker.get(), query.get(), { rng.uniform( -2.9, -1 ) }, { rng.uniform( 1, 2.9 ) },
				LW_EDGE_CERTIFIED, factor * gap, status );
			ASSERT_EQ( status, LW_OK );
			EXPECT_TRUE( factor < 1 || r.verdict != LW_VERDICT_FREE ) << "world " << i << ", gap " << gap << ", min_d " << factor * gap;
			free += r.verdict == LW_VERDICT_FREE;
			beyond += factor > 1 && info.horizon < factor * gap;
		}
	}
	EXPECT_GE( std::min( { beyond, free, passed_over } ), 300 );
}

// Small balls on short chains, and small obstacles right beside places that they come to: there a bound that is a few per
// cent of an arm's length too large is wrong.
TEST( Required, obstacle_beside_the_way_is_out_of_reach )
{
	SeededRng rng;
	int proved = 0, beside = 0;
	for ( int i = 0; i < 300 && !HasFailure(); ++i )
	{
		lw_transform at;
		World world = ballOnAChain( rng, 0.002, &at );
		std::vector<double> gaps;
		for ( int k = 0; k < 60; ++k )
		{
			State q = randomState( rng, world.robot.get() );
			for ( uint32_t v = 0; v < q.size(); ++v ) // limits, where a way ends
			{
				const lw_variable_info info = lw_robot_variable( world.robot.get(), v );
				const int where = rng.integer( 0, 5 );
				const double limit = where == 0 ? info.lower : info.upper;
				q[v] = where < 2 && std::isfinite( limit ) ? limit : q[v];
			}
			gaps.push_back( rng.decade( -4, -1 ) );
			placeBeside( rng, world, at, q, 0.002, gaps.back() );
		}
		const ScenePtr scene = makeScene( world.placed );
		const CheckerPtr checker = makeChecker( world.robot.get(), scene.get(), world, inf );
		for ( uint32_t k = 0; k < gaps.size(); ++k )
		{
			const double bound = lw_checker_obstacle_distance( checker.get(), k );
			EXPECT_LE( bound, gaps[k] + 1e-9 ) << "robot " << i << ", obstacle " << k;
			proved += bound > 0;
			beside += bound > 0.5 * gaps[k];
		}
	}
	std::printf( "%d of obstacles a little beside the way proved to be, %d with half of their gap\n", proved, beside );
	EXPECT_GE( beside, 20 );
}

TEST( Required, failed_mesh_reads_as_free_space )
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
			lw_status status = lw_checker_state( checker.get(), query.get(), q.data(), LW_WHAT_BOTH, nullptr, false, &out );
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
			EXPECT_EQ( LW_OK, lw_checker_state( checker.get(), query.get(), q.data(), LW_WHAT_BOTH, nullptr, false, &out ) );
			counts.fail = true;
		}
	}
	EXPECT_GE( failed, 20 );
}

/// The maker of a mesh, and the time of making, change no answer, only durations.
TEST( Required, threads_that_prepare_meshes_change_an_answer )
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
			CheckerPtr checker = makeChecker( lazy.robot.get(), scene.get(), lazy, inf, LW_OK, k > 0 ? &preparation[k] : nullptr );
			QueryPtr query = coldQuery( checker.get() );
			for ( const State& q : states )
			{
				answers[k].emplace_back();
				ASSERT_EQ( LW_OK, lw_checker_state( checker.get(), query.get(), q.data(), LW_WHAT_BOTH, nullptr, false,
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

TEST( Required, box_that_was_not_true )
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

TEST( Required, bad_deferred_def )
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

TEST( Required, deferred_mesh_says_what_it_knows )
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
	EXPECT_EQ( LW_OK, lw_shape_validate( later.get(), nullptr ) );
	EXPECT_EQ( 1, counts.made );
	info = lw_shape_get_info( later.get() );
	EXPECT_FALSE( info.deferred );
	EXPECT_EQ( 10u, info.triangle_count );
	EXPECT_TRUE( lw_digest_equal( lw_shape_digest( mesh.get() ), lw_shape_digest( later.get() ) ) );
	EXPECT_EQ( lw_shape_triangles( mesh.get() ), lw_shape_triangles( later.get() ) );
	EXPECT_EQ( LW_OK, lw_shape_complete( later.get(), nullptr ) );
	EXPECT_EQ( 1, counts.made );
}

TEST( Required, threads_meet_at_a_deferred_mesh )
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

TEST( Required, reach_of_a_deferred_robot_differs )
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

namespace
{

/// A checker of this robot of one joint and a ball about the origin: the ball has to be looked at.
/// @param contact the robot touches it
void expectNotPassedOver( const lw_robot_def& def, const lw_shape* obstacle, bool contact )
{
	lw_robot* robot = nullptr;
	const lw_status status = lw_robot_create( &def, nullptr, nullptr, &robot );
	if ( !contact && status == LW_ERROR_INVALID_ARGUMENT )
	{
		return; // poses as far as that are none
	}
	ASSERT_EQ( LW_OK, status );
	const RobotPtr robot_owner( robot );
	const ScenePtr scene = makeScene( { { obstacle, 0, lw_transform_identity() } } );
	lw_checker_def checker_def = lw_checker_def_default();
	checker_def.robot = robot;
	checker_def.scene = scene.get();
	checker_def.max_d = 0.1;
	lw_checker* checker = nullptr;
	ASSERT_EQ( LW_OK, lw_checker_create( &checker_def, nullptr, nullptr, &checker ) );
	const CheckerPtr checker_owner( checker );
	EXPECT_EQ( 0.0, lw_checker_obstacle_distance( checker, 0 ) );
	QueryPtr query = coldQuery( checker );
	const double q = 0.3;
	const lw_range range = { 0, 0.1, 0 };
	lw_state_result result;
	ASSERT_EQ( LW_OK, lw_checker_state( checker, query.get(), &q, LW_WHAT_BOTH, &range, false, &result ) );
	EXPECT_EQ( contact, result.verdict == LW_VERDICT_BLOCKED );
}

} // namespace

// The sweep of a body so far from the axis of its joint that squares leave the range of doubles has no number of arcs. It
// must not get lost, nor the obstacles with it. Nor may that of a point on the axis, whose number of arcs is 0 / 0 if its
// ball has no radius.
TEST( Required, sweeps_without_a_number_of_arcs_are_not_lost )
{
	const double origin[3] = { 0, 0, 0 }, sizes[3] = { 0.5, 0, 0 };
	lw_shape *point = nullptr, *ball = nullptr;
	ASSERT_EQ( LW_OK, lw_shape_create_points( origin, 1, 0.0, nullptr, nullptr, nullptr, &point ) );
	ASSERT_EQ( LW_OK, lw_shape_create_primitive( LW_SHAPE_SPHERE, sizes, nullptr, nullptr, &ball ) );
	const ShapePtr body( point ), obstacle( ball );
	lw_joint_def joint = lw_joint_def_default();
	joint.name = "j";
	joint.type = LW_JOINT_REVOLUTE;
	joint.parent = 0;
	joint.child = 1;
	joint.axis[0] = 0;
	joint.axis[2] = 1;
	joint.lower = -1;
	joint.upper = 1;
	const char* links[2] = { "base", "tip" };
	lw_body_def bodies[2] = { { body.get(), 1, lw_transform_identity() }, { body.get(), 1, lw_transform_identity() } };
	bodies[1].link_from_shape.t[0] = 1e200;
	lw_robot_def def = lw_robot_def_default();
	def.name = "r";
	def.link_names = links;
	def.link_count = 2;
	def.joints = &joint;
	def.joint_count = 1;
	def.bodies = bodies;
	for ( uint32_t far : { 0u, 1u } )
	{
		SCOPED_TRACE( far );
		def.bodies = bodies + far;
		def.body_count = 1;
		expectNotPassedOver( def, obstacle.get(), far == 0 );
	}
}

/// Prepared once, no state within the limits makes a mesh; whatever is made, answers are the same.
TEST( Required, prepared_checker_leaves_a_mesh_to_a_state )
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
		ASSERT_EQ( LW_OK, lw_checker_prepare( checker.get(), i % 5 == 0 ? nullptr : Preparation::prepare, &preparation, nullptr ) );
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

TEST( Required, failed_preparation_goes_unsaid )
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
