// SPDX-License-Identifier: BSD-3-Clause
// Small robots in small scenes, built with the core's C interface, each joint type in one of them.
#pragma once

#include "leeway/ompl/validity.hpp"
#include "poses.hpp"
#include "seeded_rng.hpp"

#include <gtest/gtest.h>

#include <ompl/base/ScopedState.h>
#include <ompl/util/Console.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <ostream>
#include <string>
#include <vector>

namespace ob = ::ompl::base;

constexpr double pi = 3.14159265358979323846;
const double inf = std::numeric_limits<double>::infinity();
const double nan_value = std::numeric_limits<double>::quiet_NaN();

inline leeway::Shape makeShape( lw_shape_type type, double x, double y = 0, double z = 0 )
{
	const double dimensions[3] = { x, y, z };
	lw_shape* shape = nullptr;
	lw_diag diag = {};
	leeway::require( lw_shape_create_primitive( type, dimensions, nullptr, &diag, &shape ), diag );
	return leeway::Shape::adopt( shape );
}

inline leeway::Shape makeBox( double x, double y, double z )
{
	return makeShape( LW_SHAPE_BOX, x, y, z );
}
inline leeway::Shape makeBall( double radius )
{
	return makeShape( LW_SHAPE_SPHERE, radius );
}

/// A joint and the link that it moves; the links are a chain. The name is the joint's.
struct Segment
{
	std::string name;
	lw_joint_def joint = lw_joint_def_default();
	leeway::Shape shape = {};
	lw_transform link_from_shape = lw_transform_identity();
};

struct Obstacle
{
	leeway::Shape shape;
	lw_transform pose;
};

inline Segment slider( const char* name, int axis, double lower, double upper, leeway::Shape shape = {} )
{
	Segment segment{ name, lw_joint_def_default(), std::move( shape ) };
	segment.joint.type = LW_JOINT_PRISMATIC;
	for ( int i = 0; i < 3; ++i )
	{
		segment.joint.axis[i] = i == axis;
	}
	segment.joint.lower = lower;
	segment.joint.upper = upper;
	return segment;
}

/// A hinge about z at x = `offset` of the link before, with a capsule `length` long along x.
inline Segment hinge(
    const char* name, lw_joint_type type, double offset, double length, double lower = 0, double upper = 0 )
{
	Segment segment{ name, lw_joint_def_default(), makeShape( LW_SHAPE_CAPSULE, 0.03, length ) };
	segment.joint.type = type;
	segment.joint.parent_from_joint = at( offset, 0, 0 );
	segment.joint.axis[0] = segment.joint.axis[1] = 0;
	segment.joint.axis[2] = 1;
	segment.joint.lower = lower;
	segment.joint.upper = upper;
	const double position[3] = { length / 2, 0, 0 };
	const double rpy[3] = { 0, pi / 2, 0 };
	leeway::require( lw_transform_from_rpy( position, rpy, &segment.link_from_shape ), "rpy" );
	return segment;
}

/// A planar or floating joint; positions within +-`range`.
inline Segment vehicle( const char* name, lw_joint_type type, double range, leeway::Shape shape,
    const lw_transform& link_from_shape = lw_transform_identity() )
{
	Segment segment{ name, lw_joint_def_default(), std::move( shape ), link_from_shape };
	segment.joint.type = type;
	segment.joint.axis[0] = segment.joint.axis[1] = 0;
	segment.joint.axis[2] = 1;
	for ( int i = 0; i < 3; ++i )
	{
		segment.joint.position_lower[i] = -range;
		segment.joint.position_upper[i] = range;
	}
	return segment;
}

/// @param group robot variables in the order of the state vector; empty = all
inline leeway::Checker makeChecker( const std::vector<Segment>& chain, const std::vector<Obstacle>& obstacles,
    const std::vector<std::uint32_t>& group = {}, const lw_margins& margins = {} )
{
	std::vector<std::string> names = { "base" };
	std::vector<lw_joint_def> joints;
	std::vector<lw_body_def> bodies;
	for ( std::uint32_t i = 0; i < chain.size(); ++i )
	{
		names.push_back( chain[i].name + " link" );
		lw_joint_def joint = chain[i].joint;
		joint.name = chain[i].name.c_str();
		joint.parent = i;
		joint.child = i + 1;
		joints.push_back( joint );
		if ( chain[i].shape )
		{
			bodies.push_back( { chain[i].shape.get(), i + 1, chain[i].link_from_shape } );
		}
	}
	std::vector<const char*> link_names;
	std::vector<lw_link_pair> allowed; // neighbours overlap at the joint
	for ( std::uint32_t i = 0; i < names.size(); ++i )
	{
		link_names.push_back( names[i].c_str() );
		if ( i > 0 )
		{
			allowed.push_back( { i - 1, i } );
		}
	}
	lw_diag diag = {};
	lw_robot_def robot_def = lw_robot_def_default();
	robot_def.name = "robot";
	robot_def.link_names = link_names.data();
	robot_def.link_count = static_cast<std::uint32_t>( link_names.size() );
	robot_def.joints = joints.data();
	robot_def.joint_count = static_cast<std::uint32_t>( joints.size() );
	robot_def.bodies = bodies.data();
	robot_def.body_count = static_cast<std::uint32_t>( bodies.size() );
	robot_def.allowed_pairs = allowed.data();
	robot_def.allowed_pair_count = static_cast<std::uint32_t>( allowed.size() );
	lw_robot* robot = nullptr;
	leeway::require( lw_robot_create( &robot_def, nullptr, &diag, &robot ), diag );
	const leeway::Robot robot_owner = leeway::Robot::adopt( robot );

	std::vector<const char*> object_names( obstacles.size(), "obstacle" );
	std::vector<lw_scene_shape_def> shapes;
	for ( std::uint32_t i = 0; i < obstacles.size(); ++i )
	{
		shapes.push_back( { obstacles[i].shape.get(), i, obstacles[i].pose } );
	}
	lw_scene_def scene_def = lw_scene_def_default();
	scene_def.object_names = object_names.data();
	scene_def.object_count = static_cast<std::uint32_t>( object_names.size() );
	scene_def.shapes = shapes.data();
	scene_def.shape_count = static_cast<std::uint32_t>( shapes.size() );
	lw_scene* scene = nullptr;
	leeway::require( lw_scene_create( &scene_def, nullptr, &diag, &scene ), diag );
	const leeway::Scene scene_owner = leeway::Scene::adopt( scene );

	lw_checker_def def = lw_checker_def_default();
	def.robot = robot;
	def.scene = scene;
	def.variables = group.empty() ? nullptr : group.data();
	def.variable_count = static_cast<std::uint32_t>( group.size() );
	def.margins = margins;
	lw_checker* checker = nullptr;
	leeway::require( lw_checker_create( &def, nullptr, &diag, &checker ), diag );
	return leeway::Checker::adopt( checker );
}

// ---- the worlds ----

/// A box on two rails before a wall with a gap: RealVector(2).
inline leeway::Checker gantryWorld()
{
	return makeChecker( { slider( "rail x", 0, -1, 1 ), slider( "rail y", 1, -1, 1, makeBox( 0.1, 0.1, 0.1 ) ) },
	    { { makeBox( 0.1, 1.4, 0.2 ), at( 0, -0.3, 0 ) }, { makeBox( 0.1, 0.2, 0.2 ), at( 0, 0.9, 0 ) },
	        { makeBall( 0.15 ), at( 0.5, 0.2, 0 ) } } );
}

/// A planar arm on a turntable among pillars, links in each other's way: SO2 and two bounded joints.
inline leeway::Checker armWorld()
{
	return makeChecker(
	    { hinge( "turn", LW_JOINT_CONTINUOUS, 0, 0.4 ), hinge( "elbow", LW_JOINT_REVOLUTE, 0.4, 0.35, -2.8, 2.8 ),
	        hinge( "wrist", LW_JOINT_REVOLUTE, 0.35, 0.3, -2.5, 2.5 ) },
	    { { makeShape( LW_SHAPE_CYLINDER, 0.08, 0.5 ), at( 0.7, 0.5, 0 ) }, { makeBox( 0.2, 0.1, 0.3 ), at( -0.6, 0.4, 0 ) },
	        { makeBall( 0.1 ), at( -0.2, -0.75, 0 ) } } );
}

/// A long cart: SE2.
inline leeway::Checker cartWorld()
{
	return makeChecker( { vehicle( "drive", LW_JOINT_PLANAR, 1, makeBox( 0.5, 0.1, 0.1 ) ) },
	    { { makeBox( 0.1, 0.9, 0.2 ), at( 0, -0.6, 0 ) }, { makeBox( 0.1, 0.5, 0.2 ), at( 0, 0.8, 0 ) } } );
}

/// A flying plate: SE3.
inline leeway::Checker droneWorld()
{
	return makeChecker( { vehicle( "fly", LW_JOINT_FLOATING, 1, makeBox( 0.5, 0.3, 0.05 ) ) },
	    { { makeBox( 0.1, 2, 0.9 ), at( 0, 0, -0.6 ) }, { makeBall( 0.3 ), at( 0.4, 0.4, 0.5 ) } } );
}

/// A cart that carries a turntable and a slide: SE2, SO2 and RealVector in one compound.
inline leeway::Checker carrierWorld()
{
	Segment slide = slider( "slide", 2, 0, 0.5, makeBall( 0.1 ) );
	slide.joint.parent_from_joint = at( 0.3, 0, 0.1 );
	return makeChecker( { vehicle( "drive", LW_JOINT_PLANAR, 1, makeBox( 0.4, 0.2, 0.1 ) ),
	                        hinge( "mast", LW_JOINT_CONTINUOUS, 0, 0.3 ), slide },
	    { { makeBox( 0.2, 0.2, 1 ), at( 0.5, 0, 0 ) }, { makeBall( 0.2 ), at( -0.4, 0.5, 0.4 ) } } );
}

/// A checker, and states of it: two that are valid with something between them, one in the midst of an obstacle.
struct World
{
	const char* name;
	leeway::Checker ( *make )();
	std::vector<double> start, goal, inside;
};

inline void PrintTo( const World& world, std::ostream* out )
{
	*out << world.name;
}

inline const std::vector<World>& worlds()
{
	static const std::vector<World> all = {
	    { "Gantry", gantryWorld, { -0.8, -0.8 }, { 0.8, -0.8 }, { 0, -0.3 } },
	    { "Arm", armWorld, { 0.2, 0.3, 0.3 }, { 1.6, -0.5, 0.4 }, { 0.62, 0, 0 } },
	    { "Cart", cartWorld, { -0.7, -0.5, pi / 2 }, { 0.7, -0.5, -pi / 2 }, { 0, -0.6, 0 } },
	    { "Drone", droneWorld, { -0.7, 0, -0.4, 0, 0, 0, 1 }, { 0.7, -0.5, -0.4, 0, 0, std::sqrt( 0.5 ), std::sqrt( 0.5 ) },
	        { 0, 0, -0.6, 0, 0, 0, 1 } },
	    { "Carrier", carrierWorld, { -0.4, -0.3, 0, 0, 0.1 }, { 0.95, 0, 0, 0, 0.1 }, { 0.5, 0, 0, 0, 0.2 } },
	};
	return all;
}

// ---- OMPL around them ----

/// A space information with leeway installed. OMPL's messages are kept off the output.
struct Rig
{
	leeway::Checker checker;
	ob::StateSpacePtr space;
	ob::SpaceInformationPtr si;
	std::shared_ptr<const leeway::ompl::Engine> engine;

	explicit Rig(
	    leeway::Checker the_checker, const leeway::ompl::Options& options = {}, ob::StateSpacePtr the_space = nullptr )
	    : checker( std::move( the_checker ) ), space( std::move( the_space ) )
	{
		::ompl::msg::setLogLevel( ::ompl::msg::LOG_ERROR );
		if ( !space )
		{
			space = leeway::ompl::makeStateSpace( checker );
		}
		si = std::make_shared<ob::SpaceInformation>( space );
		engine = leeway::ompl::install( si, checker, options );
		si->setup();
	}

	/// Uniform in the space, with this test's own random numbers: OMPL's seed can be set only once per process.
	void sample( SeededRng& rng, ob::State* state ) const
	{
		const lw_robot* robot = lw_checker_robot( checker.get() );
		std::vector<double> q( engine->adapter().size() );
		for ( std::uint32_t i = 0; i < q.size(); ++i )
		{
			const lw_variable_info info = lw_robot_variable( robot, lw_checker_variable( checker.get(), i ) );
			q[i] = rng.uniform( info.lower, info.upper );
			if ( lw_robot_joint_type( robot, info.joint ) == LW_JOINT_FLOATING && info.component == 3 )
			{
				rng.quaternion( &q[i] );
				i += 3;
			}
		}
		engine->adapter().fromVector( q.data(), state );
	}

	void sampleValid( SeededRng& rng, ob::State* state ) const
	{
		do
		{
			sample( rng, state );
		} while ( !si->isValid( state ) );
	}

	std::vector<double> vector( const ob::State* state ) const
	{
		std::vector<double> q( engine->adapter().size() );
		engine->adapter().toVector( state, q.data() );
		return q;
	}
};

/// The true clearance of a state, by the core's exact query; 0 on any doubt.
inline double exactClearance( const Rig& rig, lw_query* query, const ob::State* state )
{
	const std::vector<double> q = rig.vector( state );
	lw_state_result result;
	if ( lw_checker_state( rig.checker.get(), query, q.data(), LW_CHECK_BOTH, nullptr, false, &result ) != LW_OK ||
	     result.verdict != LW_VERDICT_FREE )
	{
		return 0;
	}
	return std::min( result.environment.lower, result.self.lower );
}
