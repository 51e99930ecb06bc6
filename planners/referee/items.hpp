// SPDX-License-Identifier: BSD-3-Clause
// Results of other planners as files: paths, trajectories, splines, regions.
#pragma once

#include "leeway/motions/trajectory.hpp"
#include "referee/region.hpp"

#include <optional>
#include <string>
#include <vector>

namespace leeway::referee
{

/// One result that is judged. One of points, trajectory, segments and region is there.
struct Item
{
	std::string name;                        ///< of the file, with its place in it if there are several
	std::string file, element;               ///< element: the place, "" for the file itself
	std::vector<std::string> joint_names;    ///< of points and segments; empty: the group's variables, in their order
	std::vector<std::vector<double>> points; ///< a path: straight from one to the next
	std::optional<motions::TrajectoryFile> trajectory;
	std::vector<motions::Segment> segments; ///< a spline in time
	std::optional<Region> region;
	std::vector<std::pair<std::string, double>> start_state; ///< of a path file
	std::vector<io::Notice> notices;
};

/// Reads the items of a file, by its ending and its keys:
///   - .npy: NumPy array of float64 or float32, [points][joints] or [paths][points][joints]
///   - .txt: a line of numbers for each point, such as OMPL's PathGeometric::printAsMatrix() writes
///   - .csv: with a column time a trajectory, else a path; a column for each joint
///   - YAML or JSON: paths of leeway, MoveIt's and ROS's trajectories; A and b of a region, several under `regions` or by name;
///     bspline (order, knots, control_points), bezier (start, end, control_points), piecewise_polynomial (breaks, coefficients), or
///     composite, a list of these, all with joint_names
/// @throws io::Error
std::vector<Item> readItems( const std::string& file );

} // namespace leeway::referee
