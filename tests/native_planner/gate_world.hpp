// SPDX-License-Identifier: BSD-3-Clause
// A gate that opens, and a dense look at tracks: for tests of plans in time.
#pragma once

#include "clock_world.hpp"
#include "one_obstacle.hpp"
#include "simple_shapes.hpp"

constexpr double radius = 0.2; ///< metres, of balls

/// A ball in front of a wall with a gap, and behind the gap a gate that shifts along y. Variables: x and y of the ball, y of the gate.
struct Gate
{
	RobotPtr robot;
	leeway::Scene scene;

	Gate()
	{
		RobotModel model;
		model.link( "world" );
		addJoint( model, "x", LW_JOINT_PRISMATIC, 0, 0 );
		addJoint( model, "y", LW_JOINT_PRISMATIC, 1, 1 );
		addJoint( model, "gate", LW_JOINT_PRISMATIC, 0, 1 );
		model.body( 2, primitive( LW_SHAPE_SPHERE, radius ), lw_transform_identity() );
		model.body( 3, primitive( LW_SHAPE_BOX, 0.1, 1.2, 1 ), along( 0.25, 0 ) );
		for ( lw_joint_def& joint : model.joints )
		{
			joint.lower = -2;
			joint.upper = 2;
		}
		robot = model.create();
		const ShapePtr wall( primitive( LW_SHAPE_BOX, 0.1, 2, 1 ) );
		const char* names[] = { "left", "right" };
		const lw_scene_shape_def shapes[] = { { wall.get(), 0, along( 0, 1.4 ) }, { wall.get(), 1, along( 0, -1.4 ) } };
		lw_scene_def def = lw_scene_def_default();
		def.object_names = names;
		def.object_count = 2;
		def.shapes = shapes;
		def.shape_count = 2;
		lw_scene* made = nullptr;
		leeway::require( lw_scene_create( &def, nullptr, nullptr, &made ), "the walls" );
		scene = leeway::Scene::adopt( made );
	}

	static lw_transform along( double x, double y )
	{
		lw_transform at = lw_transform_identity();
		at.t[0] = x;
		at.t[1] = y;
		return at;
	}

	/// The gate opens from 5 to 7 s.
	static OwnedClock clock()
	{
		OwnedClock clock;
		clock.rest = { 0, 0, 0 };
		OwnedTrack gate;
		gate.variables = { 2 };
		gate.pieces = { { 5, 7, 1, { 0, 2 } } };
		clock.tracks = { gate };
		return clock;
	}
};

/// The least clearance of all tracks between two times, by states 4 ms apart.
inline double leastClearance( const lw_robot* robot, const lw_scene* scene, const OwnedClock& clock, double from, double to )
{
	std::vector<std::uint32_t> all;
	for ( std::uint32_t i = 0; i < clock.rest.size(); ++i )
	{
		all.push_back( i );
	}
	EdgeAuditor auditor( robot, scene, all, clock.rest.data() );
	double least = INFINITY;
	for ( double t = from; t <= to; t += 0.004 )
	{
		std::vector<double> q = clock.rest;
		for ( const OwnedTrack& track : clock.tracks )
		{
			for ( std::size_t i = 0; i < track.variables.size(); ++i )
			{
				q[track.variables[i]] = track.at( i, t );
			}
		}
		least = std::min( least, auditor.clearance( q.data() ) );
	}
	return least;
}
