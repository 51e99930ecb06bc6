// SPDX-License-Identifier: BSD-3-Clause
// A robot, a scene and a checker of them, drawn at random or simple, for tests of edges.
#pragma once

#include "leeway/checker.h"
#include "random_robot.hpp"
#include "simple_shapes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

struct SceneObject
{
	lw_shape* shape;
	lw_transform pose;
};

/// A robot, a scene and a checker of them, torn down in order.
struct World
{
	RobotModel model;
	std::vector<ShapePtr> sceneShapes;
	std::vector<SceneObject> objects;
	std::vector<lw_link_object_pair> allowed;
	std::vector<std::uint32_t> variables; ///< empty = all
	State reference;
	RobotPtr robot;
	lw_scene* scene = nullptr;
	lw_checker* checker = nullptr;
	lw_query* query = nullptr;
	lw_query* plain = nullptr; ///< for the audit

	World() = default;
	World( const World& ) = delete;
	World& operator=( const World& ) = delete;
	~World() { close(); }

	void close()
	{
		lw_query_destroy( query );
		lw_query_destroy( plain );
		lw_checker_release( checker );
		lw_scene_release( scene );
		query = plain = nullptr;
		checker = nullptr;
		scene = nullptr;
	}

	void object( lw_shape* shape, const lw_transform& pose )
	{
		sceneShapes.emplace_back( shape );
		objects.push_back( { shape, pose } );
	}

	void open()
	{
		close();
		robot = model.create();
		ASSERT_NE( robot, nullptr );
		std::vector<std::string> names;
		std::vector<const char*> pointers;
		std::vector<lw_scene_shape_def> shapes;
		for ( std::size_t i = 0; i < objects.size(); ++i )
		{
			names.push_back( "object" + std::to_string( i ) );
			shapes.push_back( { objects[i].shape, static_cast<std::uint32_t>( i ), objects[i].pose } );
		}
		for ( const std::string& name : names )
		{
			pointers.push_back( name.c_str() );
		}
		lw_scene_def sceneDef = lw_scene_def_default();
		sceneDef.object_names = pointers.data();
		sceneDef.object_count = static_cast<std::uint32_t>( names.size() );
		sceneDef.shapes = shapes.data();
		sceneDef.shape_count = static_cast<std::uint32_t>( shapes.size() );
		ASSERT_EQ( lw_scene_create( &sceneDef, nullptr, nullptr, &scene ), LW_OK );
		lw_checker_def def = lw_checker_def_default();
		def.robot = robot.get();
		def.scene = scene;
		def.variables = variables.empty() ? nullptr : variables.data();
		def.variable_count = static_cast<std::uint32_t>( variables.size() );
		def.reference = reference.empty() ? nullptr : reference.data();
		def.allowed = allowed.data();
		def.allowed_count = static_cast<std::uint32_t>( allowed.size() );
		lw_diag diag = {};
		ASSERT_EQ( lw_checker_create( &def, nullptr, &diag, &checker ), LW_OK ) << diag.message;
		lw_query_def queryDef = lw_query_def_default();
		ASSERT_EQ( lw_query_create( &queryDef, scene, checker, nullptr, &query ), LW_OK );
		ASSERT_EQ( lw_query_create( &queryDef, nullptr, nullptr, nullptr, &plain ), LW_OK );
	}

	bool objectAllowed( std::uint32_t link, std::uint32_t index ) const
	{
		return std::any_of( allowed.begin(), allowed.end(),
		    [=]( const lw_link_object_pair& p ) { return p.link == link && p.object == index; } );
	}

	State full( const State& q ) const
	{
		State out( lw_robot_variable_count( robot.get() ) );
		lw_checker_full_state( checker, q.data(), out.data() );
		return out;
	}

	/// True if some joint of the group lies between the two links.
	bool groupMoves( std::uint32_t linkA, std::uint32_t linkB ) const
	{
		auto chain = [&]( std::uint32_t link )
		{
			std::vector<std::uint32_t> joints;
			for ( std::uint32_t j = lw_robot_link_joint( robot.get(), link ); j != LW_INVALID_INDEX;
			      j = lw_robot_link_joint( robot.get(), link ) )
			{
				joints.push_back( j );
				link = lw_robot_joint_parent( robot.get(), j );
			}
			return joints;
		};
		std::vector<std::uint32_t> a = chain( linkA ), b = chain( linkB );
		std::vector<std::uint32_t> between;
		std::sort( a.begin(), a.end() );
		std::sort( b.begin(), b.end() );
		std::set_symmetric_difference( a.begin(), a.end(), b.begin(), b.end(), std::back_inserter( between ) );
		return std::any_of( between.begin(), between.end(),
		    [&]( std::uint32_t j )
		    {
			    std::uint32_t followed = lw_robot_joint_mimic( robot.get(), j );
			    std::uint32_t leader = followed != LW_INVALID_INDEX ? followed : j;
			    std::uint32_t v = lw_robot_joint_variable( robot.get(), leader );
			    return v != LW_INVALID_INDEX &&
			           ( variables.empty() || std::find( variables.begin(), variables.end(), v ) != variables.end() );
		    } );
	}

	double shapeDistance(
	    const lw_body_def& a, const lw_transform& worldFromA, const lw_shape* b, const lw_transform& worldFromB ) const
	{
		lw_transform poseA = lw_transform_multiply( &worldFromA, &a.link_from_shape );
		lw_clearance c;
		EXPECT_EQ( lw_shape_distance( a.shape, &poseA, b, &worldFromB, nullptr, plain, &c ), LW_OK );
		return c.upper;
	}

	/// Least distance at a full state, pair by pair, without the checker. With links given only that pair.
	double clearance( const State& fullState, lw_check_flags flags, std::uint32_t a = LW_INVALID_INDEX,
	    std::uint32_t b = LW_INVALID_INDEX ) const
	{
		std::vector<lw_transform> poses( lw_robot_link_count( robot.get() ) );
		EXPECT_EQ( lw_robot_fk( robot.get(), fullState.data(), poses.data() ), LW_OK );
		double least = INFINITY;
		for ( std::size_t i = 0; i < model.bodies.size(); ++i )
		{
			lw_body_def bodyI = lw_robot_body( robot.get(), static_cast<std::uint32_t>( i ) );
			for ( std::uint32_t k = 0; ( flags & LW_CHECK_ENVIRONMENT ) != 0 && k < objects.size(); ++k )
			{
				if ( !objectAllowed( bodyI.link, k ) && ( a == LW_INVALID_INDEX || ( a == bodyI.link && b == k ) ) )
				{
					least = std::min( least, shapeDistance( bodyI, poses[bodyI.link], objects[k].shape, objects[k].pose ) );
				}
			}
			for ( std::size_t k = 0; ( flags & LW_CHECK_SELF ) != 0 && k < i; ++k )
			{
				lw_body_def bodyK = lw_robot_body( robot.get(), static_cast<std::uint32_t>( k ) );
				std::uint32_t linkI = bodyI.link, linkK = bodyK.link;
				bool asked = a == LW_INVALID_INDEX || ( a == linkI && b == linkK ) || ( b == linkI && a == linkK );
				if ( asked && !lw_robot_pair_allowed( robot.get(), linkI, linkK ) && groupMoves( linkI, linkK ) )
				{
					lw_transform poseK = lw_transform_multiply( &poses[bodyK.link], &bodyK.link_from_shape );
					least = std::min( least, shapeDistance( bodyI, poses[bodyI.link], bodyK.shape, poseK ) );
				}
			}
		}
		return least;
	}

	double clearanceAt( const State& qa, const State& qb, double t, lw_check_flags flags, std::uint32_t a = LW_INVALID_INDEX,
	    std::uint32_t b = LW_INVALID_INDEX ) const
	{
		State fullA = full( qa ), fullB = full( qb ), q( fullA.size() );
		lw_robot_interpolate( robot.get(), fullA.data(), fullB.data(), t, q.data() );
		return clearance( q, flags, a, b );
	}

	lw_edge_result edge( const State& qa, const State& qb, const lw_edge_def& def ) const
	{
		lw_edge_result result;
		EXPECT_EQ( lw_checker_edge( checker, query, qa.data(), qb.data(), &def, &result ), LW_OK );
		return result;
	}
};

/// A random robot among random objects, contacts of the state qa allowed.
inline void randomWorld( SeededRng& rng, World& world, State* start )
{
	RandomRobotOptions options;
	options.joints = rng.integer( 2, 7 );
	options.size = 0.1;
	options.triangles = rng.integer( 1, 12 );
	options.floating = rng.integer( 0, 2 ) > 0;
	do
	{
		world.model = randomRobot( rng, options );
		world.robot = world.model.create();
	} while ( lw_robot_variable_count( world.robot.get() ) == 0 );
	State q = randomState( rng, world.robot.get() );
	world.reference = q;
	world.variables.clear();
	if ( rng.integer( 0, 3 ) == 0 )
	{
		for ( std::uint32_t j = 0; j < lw_robot_joint_count( world.robot.get() ); ++j )
		{
			bool take = rng.integer( 0, 3 ) > 0;
			for ( std::uint32_t k = 0; take && k < lw_robot_joint_variable_count( world.robot.get(), j ); ++k )
			{
				world.variables.push_back( lw_robot_joint_variable( world.robot.get(), j ) + k );
			}
		}
	}
	int objects = rng.integer( 0, 3 ) ? rng.integer( 5, 25 ) : 0;
	for ( int i = 0; i < objects; ++i )
	{
		bool mesh = rng.integer( 0, 1 ) == 1;
		int triangles = rng.integer( 1, 20 );
		lw_shape* shape = mesh ? randomMesh( rng, triangles, 0.15, nullptr ) : randomPrimitive( rng, 0.2, nullptr );
		lw_transform pose = randomTransform( rng, 0.7 );
		for ( int k = 0; k < 3; ++k )
		{
			pose.t[k] += world.model.worldFromRoot.t[k];
		}
		world.object( shape, pose );
	}
	world.open();
	State full = q;
	const double close = 0.002;
	for ( std::uint32_t a = 0; a < world.model.linkNames.size(); ++a )
	{
		for ( std::uint32_t b = 0; b < world.model.linkNames.size(); ++b )
		{
			if ( b < a && world.clearance( full, LW_CHECK_SELF, a, b ) < close )
			{
				world.model.allowed.push_back( { a, b } );
			}
		}
		for ( std::uint32_t k = 0; k < world.objects.size(); ++k )
		{
			if ( world.clearance( full, LW_CHECK_ENVIRONMENT, a, k ) < close )
			{
				world.allowed.push_back( { a, k } );
			}
		}
	}
	world.open();
	start->clear();
	for ( std::uint32_t i = 0; i < lw_checker_variable_count( world.checker ); ++i )
	{
		start->push_back( q[lw_checker_variable( world.checker, i )] );
	}
}

/// Some state of the group: a random one, or one near `start`.
inline State randomEnd( SeededRng& rng, const World& world, const State& start )
{
	State full = randomState( rng, world.robot.get(), rng.integer( 0, 4 ) == 0 ? 0.7 : 0.0 );
	State near = world.full( start );
	double share = rng.integer( 0, 2 ) ? rng.decade( -1.5, 0 ) : 1.0;
	lw_robot_interpolate( world.robot.get(), near.data(), full.data(), share, full.data() );
	State end;
	for ( std::uint32_t i = 0; i < lw_checker_variable_count( world.checker ); ++i )
	{
		end.push_back( full[lw_checker_variable( world.checker, i )] );
	}
	return end;
}

/// A ball of 10 cm that slides along x above a slab whose top is `gap` below it.
inline void slider( World& world, double gap, double slabTurn = 0 )
{
	world.model.link( "rail" );
	lw_joint_def& j = world.model.joint( "ball", LW_JOINT_PRISMATIC, 0 );
	j.axis[0] = 1;
	j.axis[2] = 0;
	j.lower = -2;
	j.upper = 2;
	world.model.body( 1, primitive( LW_SHAPE_SPHERE, 0.1, 0, 0 ), lw_transform_identity() );
	lw_transform pose = at( 0, 0, -0.1 - gap - 0.5 );
	pose.r[0][0] = pose.r[1][1] = std::cos( slabTurn );
	pose.r[1][0] = std::sin( slabTurn );
	pose.r[0][1] = -pose.r[1][0];
	world.object( primitive( LW_SHAPE_BOX, 10, 10, 1 ), pose );
	world.open();
}
