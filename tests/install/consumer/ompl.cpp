// SPDX-License-Identifier: BSD-3-Clause
// C++ against the installed OMPL shim: a slider in front of a ball, its state space made from the checker.
#include <leeway/ompl/validity.hpp>

int main()
{
	const double radius[3] = { 0.1, 0, 0 };
	lw_shape* ball = nullptr;
	leeway::require( lw_shape_create_primitive( LW_SHAPE_SPHERE, radius, nullptr, nullptr, &ball ), "shape" );
	leeway::Shape shape = leeway::Shape::adopt( ball );

	const char* links[] = { "rail", "slider" };
	lw_joint_def joint = lw_joint_def_default();
	joint.name = "slide";
	joint.type = LW_JOINT_PRISMATIC;
	joint.parent = 0;
	joint.child = 1;
	joint.lower = 0;
	joint.upper = 2;
	lw_body_def body = { ball, 1, lw_transform_identity() };
	lw_robot_def robot_def = lw_robot_def_default();
	robot_def.name = "slider";
	robot_def.link_names = links;
	robot_def.link_count = 2;
	robot_def.joints = &joint;
	robot_def.joint_count = 1;
	robot_def.bodies = &body;
	robot_def.body_count = 1;
	lw_robot* robot = nullptr;
	leeway::require( lw_robot_create( &robot_def, nullptr, nullptr, &robot ), "robot" );
	leeway::Robot robot_owner = leeway::Robot::adopt( robot );

	lw_checker_def checker_def = lw_checker_def_default();
	checker_def.robot = robot;
	lw_checker* checker = nullptr;
	leeway::require( lw_checker_create( &checker_def, nullptr, nullptr, &checker ), "checker" );
	return leeway::ompl::makeStateSpace( leeway::Checker::adopt( checker ) )->getDimension() == 1 ? 0 : 1;
}
