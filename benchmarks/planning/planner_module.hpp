// SPDX-License-Identifier: BSD-3-Clause
// The interface between leeway-bench planning and a planner of another library.
//
// A module plans by its own model of the robot and its own checks; leeway-bench hands it each problem, takes its path and has
// it audited on the meshes. It needs nothing but the core's headers and calls none of the core's functions. README.md tells how
// to add one.
#pragma once

#include "leeway/shape.h"

#include <string>
#include <vector>

/// One primitive of the scene. Dimensions as lw_shape_type has them; its pose in the world, which is the robot's root.
struct PlannerObstacle
{
	std::string name;
	lw_shape_type type;
	double dimensions[3];
	lw_transform pose;
};

struct PlannerProblem
{
	std::string robot, set;          ///< "panda", "box_panda"
	std::vector<std::string> joints; ///< of a state, in the order of its entries
	std::vector<double> start, goal;
	std::vector<PlannerObstacle> obstacles;
};

struct PlannerAnswer
{
	bool solved = false;
	double plan_us = 0, simplify_us = 0;
	/// States one after another in one array: before and after the simplification. Edges are straight in the numbers themselves,
	/// also those of joints without limits.
	std::vector<double> first, path;
};

class PlannerModule
{
public:
	PlannerModule() = default;
	PlannerModule( const PlannerModule& ) = delete;
	PlannerModule& operator=( const PlannerModule& ) = delete;
	virtual ~PlannerModule() = default;

	virtual std::string name() const = 0;
	virtual std::string description() const = 0; ///< version, settings, compiler flags

	/// Makes a problem the current one; the order of random numbers starts anew.
	/// @return empty, or the reason why it is not planned, such as "start in collision"
	virtual std::string take( const PlannerProblem& problem ) = 0;
	/// Plans the current problem once more, with further random numbers.
	virtual PlannerAnswer plan() = 0;
};

/// The one function that a module exports.
extern "C" PlannerModule* leeway_planner_module();
