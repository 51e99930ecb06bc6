// SPDX-License-Identifier: BSD-3-Clause
// A robot of one joint and one body, one obstacle, and their checker.
#pragma once

#include "leeway/checker.h"

#include <gtest/gtest.h>

struct OneJoint
{
	lw_robot* robot = nullptr;
	lw_scene* scene = nullptr;
	lw_checker* checker = nullptr;

	OneJoint() = default;
	OneJoint( const OneJoint& ) = delete;
	OneJoint& operator=( const OneJoint& ) = delete;
	~OneJoint()
	{
		lw_checker_release( checker );
		lw_scene_release( scene );
		lw_robot_release( robot );
	}

	/// Makes the robot: a base, a joint of this type and limits, and a link with the body.
	/// @return the status, with a message in *diag
	lw_status makeRobot( const lw_shape* shape, const lw_transform& link_from_shape, lw_joint_type type,
	    const double axis[3], double limit, lw_diag* diag )
	{
		const char* links[2] = { "base", "arm" };
		lw_joint_def joint = lw_joint_def_default();
		joint.name = "joint";
		joint.type = type;
		joint.parent = 0;
		joint.child = 1;
		for ( int k = 0; k < 3; ++k )
		{
			joint.axis[k] = axis[k];
		}
		joint.lower = -limit;
		joint.upper = limit;
		const lw_body_def body = { shape, 1, link_from_shape };
		lw_robot_def def = lw_robot_def_default();
		def.name = "robot";
		def.link_names = links;
		def.link_count = 2;
		def.joints = &joint;
		def.joint_count = 1;
		def.bodies = &body;
		def.body_count = 1;
		def.world_from_root = lw_transform_identity();
		return lw_robot_create( &def, nullptr, diag, &robot );
	}

	/// Makes the scene of one obstacle, and the checker.
	void makeChecker( const lw_shape* obstacle, const lw_transform& world_from_obstacle )
	{
		const char* objects[1] = { "obstacle" };
		const lw_scene_shape_def shape = { obstacle, 0, world_from_obstacle };
		lw_scene_def scene_def = lw_scene_def_default();
		scene_def.object_names = objects;
		scene_def.object_count = 1;
		scene_def.shapes = &shape;
		scene_def.shape_count = 1;
		EXPECT_EQ( LW_OK, lw_scene_create( &scene_def, nullptr, nullptr, &scene ) );
		lw_checker_def checker_def = lw_checker_def_default();
		checker_def.robot = robot;
		checker_def.scene = scene;
		EXPECT_EQ( LW_OK, lw_checker_create( &checker_def, nullptr, nullptr, &checker ) );
	}
};
