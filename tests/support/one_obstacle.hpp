// SPDX-License-Identifier: BSD-3-Clause
// Scenes of one obstacle, and checkers with the default settings.
#pragma once

#include "leeway/handles.hpp"

/// The scene keeps a reference to the shape.
inline leeway::Scene oneObstacle( const lw_shape* obstacle, const lw_transform& world_from_obstacle )
{
	const char* name = "obstacle";
	const lw_scene_shape_def shape = { obstacle, 0, world_from_obstacle };
	lw_scene_def def = lw_scene_def_default();
	def.object_names = &name;
	def.object_count = 1;
	def.shapes = &shape;
	def.shape_count = 1;
	lw_scene* scene = nullptr;
	lw_diag diag = {};
	leeway::require( lw_scene_create( &def, nullptr, &diag, &scene ), diag );
	return leeway::Scene::adopt( scene );
}

/// @param margin of all pairs, metres
inline leeway::Checker checkerOf( const lw_robot* robot, const lw_scene* scene, double margin = 0 )
{
	lw_checker_def def = lw_checker_def_default();
	def.robot = robot;
	def.scene = scene;
	def.margins.environment = def.margins.self = margin;
	lw_checker* checker = nullptr;
	lw_diag diag = {};
	leeway::require( lw_checker_create( &def, nullptr, &diag, &checker ), diag );
	return leeway::Checker::adopt( checker );
}
