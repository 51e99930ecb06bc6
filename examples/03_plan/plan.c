// SPDX-License-Identifier: BSD-3-Clause
// A path around a wall, in C, without any file: a cube on two rails, 5 mm away from everything, each edge proved.
#include <leeway/leeway.h>
#include <leeway/planners/planner.h>
#include <stdio.h>

// Two rails along x and y, and the cube on the second.
static lw_robot* make_robot( const lw_shape* cube, lw_diag* diag )
{
	const char* const links[] = { "floor", "bridge", "cube" };
	lw_joint_def joints[2];
	for ( uint32_t i = 0; i < 2; ++i )
	{
		joints[i] = lw_joint_def_default();
		joints[i].name = i == 0 ? "rail x" : "rail y";
		joints[i].type = LW_JOINT_PRISMATIC;
		joints[i].parent = i;
		joints[i].child = i + 1;
		joints[i].axis[0] = i == 0;
		joints[i].axis[1] = i == 1;
		joints[i].lower = -1;
		joints[i].upper = 1;
	}
	const lw_body_def body = { cube, 2, lw_transform_identity() };
	lw_robot_def def = lw_robot_def_default();
	def.name = "gantry";
	def.link_names = links;
	def.link_count = 3;
	def.joints = joints;
	def.joint_count = 2;
	def.bodies = &body;
	def.body_count = 1;
	lw_robot* robot = NULL;
	lw_robot_create( &def, NULL, diag, &robot );
	return robot;
}

// A wall with room at one end.
static lw_scene* make_scene( const lw_shape* wall, lw_diag* diag )
{
	const char* const objects[] = { "wall" };
	lw_scene_shape_def shape = { 0 };
	shape.shape = wall;
	shape.world_from_shape = lw_transform_identity();
	shape.world_from_shape.t[1] = -0.5;
	lw_scene_def def = lw_scene_def_default();
	def.object_names = objects;
	def.object_count = 1;
	def.shapes = &shape;
	def.shape_count = 1;
	lw_scene* scene = NULL;
	lw_scene_create( &def, NULL, diag, &scene );
	return scene;
}

int main( void )
{
	const double cube_edges[3] = { 0.1, 0.1, 0.1 }, wall_edges[3] = { 0.1, 2, 0.2 };
	const double start[] = { -0.8, -0.8 }, goal[] = { 0.8, -0.8 };
	lw_diag diag = { 0 };
	lw_shape *cube = NULL, *wall = NULL;
	lw_shape_create_primitive( LW_SHAPE_BOX, cube_edges, NULL, &diag, &cube );
	lw_shape_create_primitive( LW_SHAPE_BOX, wall_edges, NULL, &diag, &wall );
	lw_robot* robot = make_robot( cube, &diag );
	lw_scene* scene = make_scene( wall, &diag );
	lw_checker_def checker_def = lw_checker_def_default();
	checker_def.robot = robot;
	checker_def.scene = scene;
	lw_checker* checker = NULL;
	lw_plan_result result = { 0 };
	lw_plan_def def = lw_plan_def_default();
	if ( lw_checker_create( &checker_def, NULL, &diag, &checker ) == LW_OK )
	{
		def.checker = checker;
		def.starts = start;
		def.start_count = 1;
		def.goals = goal;
		def.goal_count = 1;
		def.edge.min_d = 0.005;
		def.seconds = 10;
		lw_plan( &def, &diag, &result );
	}
	printf( "%s: %u states, length %.3g (%.3g before smoothing)%s%s\n", lw_plan_outcome_name( result.outcome ),
	    (unsigned)result.state_count, result.length, result.raw_length, diag.message, result.message );
	for ( uint32_t i = 0; i < result.state_count; ++i )
	{
		const double* q = result.states + i * result.variable_count;
		printf( "  %8.4g %8.4g\n", q[0], q[1] );
	}
	const bool solved = result.outcome == LW_PLAN_SOLVED;
	lw_plan_result_clear( &result );
	lw_checker_release( checker );
	lw_scene_release( scene );
	lw_robot_release( robot );
	lw_shape_release( wall );
	lw_shape_release( cube );
	return solved ? 0 : 1;
}
