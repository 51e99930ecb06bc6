// SPDX-License-Identifier: BSD-3-Clause
// Enclosing spheres of a robot's links, and the files that other programs read them from.
#pragma once

#include "leeway/io/model.hpp"

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace leeway::io
{

struct SpherizeOptions
{
	double excess = 0;              ///< metres, > 0: the farthest that a sphere may reach beyond its link; or
	std::uint32_t sphere_count = 0; ///< with excess 0: at most so many spheres for the whole robot, all links alike in
	                                ///< excess
	double close_holes = 0;         ///< metres; see lw_geometry_def
	/// Seconds for the whole robot, by the clock; 0: as long as it takes. Links that are not done by then keep the best spheres
	/// found so far: one around the link at worst, which takes no search.
	double seconds = 0;
	unsigned threads = 0; ///< links are searched at the same time; 0: one thread per processor. No result depends on it
	/// Called before each link with its name and the share of the work that is done, from any thread, by one at a time. May be
	/// empty.
	std::function<void( const std::string&, double )> progress;
};

/// Spheres of one link, in the link's frame. Their numbers have six decimals, and it is these numbers that were checked.
struct LinkSpheres
{
	std::string link;
	std::vector<double> spheres; ///< x, y, z, radius, ...
	lw_spheres_report report{};
	double milliseconds = 0;
	bool met_target = true; ///< false: the time ended before the wanted excess was reached; see report.excess
	std::size_t count() const { return spheres.size() / 4; }
};

/// Spheres around each link with collision geometry, in the model's order. All are proved to enclose it.
/// The same model and options give the same spheres, unless time ends the search.
/// @throws Error (an excess below 0.01 mm, fewer spheres than links; without `seconds`, a body that takes too many), CoreError
std::vector<LinkSpheres> spherize( const RobotModel& model, const SpherizeOptions& options );

/// The model's URDF with the collision geometry of these links replaced by their spheres; all else, comments included, as it
/// was. Each <collision> carries a comment-free plain <sphere>, which any URDF reader knows. @throws Error
std::string writeSpheresUrdf( const RobotModel& model, const std::vector<LinkSpheres>& links );

/// The model's SRDF (or an empty one) with link_sphere_approximation elements for these links; old ones of these links are
/// replaced. @throws Error
std::string writeSpheresSrdf( const RobotModel& model, const std::vector<LinkSpheres>& links );

/// cuRobo's file of spheres: robot, and collision_spheres by link, each a list of center and radius. The excess of each link
/// stands in a comment.
std::string writeSpheresYaml( const RobotModel& model, const std::vector<LinkSpheres>& links );

} // namespace leeway::io
