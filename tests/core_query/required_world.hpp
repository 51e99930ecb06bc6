// SPDX-License-Identifier: BSD-3-Clause
// Robots and scenes as they are and with all meshes deferred, for tests of the modelling that a scene requires.
#pragma once
#include "leeway/blob.h"
#include "checker_handles.hpp"
#include "random_robot.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <limits>
#include <thread>

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

inline lw_deferred_def laterDef( const lw_shape* shape, Counts& counts )
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

inline ShapePtr defer( const lw_shape* shape, Counts& counts )
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

inline ScenePtr makeScene( const std::vector<lw_scene_shape_def>& placed )
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

inline CheckerPtr makeChecker( const lw_robot* robot, const lw_scene* scene, const World& world, double max_d,
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
inline QueryPtr coldQuery( const lw_checker* checker )
{
	const bool warm_start = false;
	return makeQuery( checker, warm_start );
}

inline World randomWorld( SeededRng& rng )
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
inline World deferred( const World& world, Counts& counts )
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

inline State groupState( SeededRng& rng, const World& world, double excess )
{
	State full = randomState( rng, world.robot.get(), excess ), q;
	for ( uint32_t variable : world.group )
	{
		q.push_back( full[variable] );
	}
	return q;
}

inline void expectSame( const lw_clearance& want, const lw_clearance& got, const char* which )
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

inline lw_state_result ask( const lw_checker* checker, lw_query* query, const State& q, const lw_range& range )
{
	lw_state_result out;
	EXPECT_EQ( LW_OK, lw_checker_state( checker, query, q.data(), LW_CHECK_BOTH, &range, false, &out ) );
	return out;
}

const lw_range ranges[] = { { 0, inf, 0 }, { 0, 0.05, 0 }, { 0, 0.3, 0 }, { 0.01, 0.1, 0 }, { 0, 5e-324, 0 } };

inline lw_edge_result askEdge( const lw_checker* checker, lw_query* query, const State& a, const State& b,
    lw_edge_method method, double min_d, lw_status& status )
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
