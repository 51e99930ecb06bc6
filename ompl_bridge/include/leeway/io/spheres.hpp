// SPDX-License-Identifier: BSD-3-Clause
// Enclosing spheres of a robot's links, and files of them for other programs.
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
	double excess = 0; ///< metres, > 0: how far a sphere may extend beyond its link; or
	/// With excess 0: the largest number of spheres of the whole robot; all links get a similar excess.
	std::uint32_t sphere_count = 0;
	double close_holes = 0; ///< metres; see lw_geometry_def
	/// Seconds of wall time for the whole robot; 0: no limit. When the time ends, unfinished links keep the best spheres so
	/// far: at worst one around the link, which takes no search.
	double seconds = 0;
	unsigned threads = 0; ///< links run in parallel; 0: one thread per processor. It changes no result
	/// Progress callback before each link: its name and the share of work done. Any thread may call it, but never two at the
	/// same time. May be empty.
	std::function<void( const std::string&, double )> progress;
};

/// Spheres of one link, in the link's frame. Their numbers have six decimals; the proof is about these decimals.
struct LinkSpheres
{
	std::string link;
	std::vector<double> spheres; ///< x, y, z, radius, ...
	lw_spheres_report report{};
	double milliseconds = 0;
	bool met_target = true; ///< false: the time ended before the requested excess; see report.excess
	std::size_t count() const { return spheres.size() / 4; }
};

/// Spheres around each link with collision geometry, in the model's order. Every set is proved to enclose its link.
/// The same model and options give the same spheres, unless time ends the search.
/// @throws Error (an excess below 0.01 mm, fewer spheres than links; without `seconds`, a body that needs too many spheres),
/// CoreError
std::vector<LinkSpheres> spherize( const RobotModel& model, const SpherizeOptions& options );

/// The model's URDF with the collision geometry of these links replaced by their spheres; the rest of the text, comments
/// included, is unchanged. Each `collision` element carries a comment-free plain `sphere`, which any URDF reader knows. @throws
/// Error
std::string writeSpheresUrdf( const RobotModel& model, const std::vector<LinkSpheres>& links );

/// The model's SRDF (or an empty one) with link_sphere_approximation elements for these links; old ones of these links are
/// replaced. @throws Error
std::string writeSpheresSrdf( const RobotModel& model, const std::vector<LinkSpheres>& links );

/// cuRobo's file of spheres: robot, and collision_spheres by link, each a list of center and radius. A comment gives the
/// excess of each link.
std::string writeSpheresYaml( const RobotModel& model, const std::vector<LinkSpheres>& links );

} // namespace leeway::io
