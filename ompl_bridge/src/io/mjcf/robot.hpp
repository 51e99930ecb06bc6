// SPDX-License-Identifier: BSD-3-Clause
// MJCF as a robot.
#pragma once

#include "mjcf/geoms.hpp"

namespace leeway::io::detail
{

/// A robot model of an MJCF file: its root link is the world. @param xml whose root is <mujoco> @throws Error
RobotModel readMjcf( std::unique_ptr<XmlFile> xml, const LoadOptions& options );

namespace mjcf
{

/// A joint of MuJoCo as joints of a model: three for a ball, of which each has its component.
struct JointNames
{
	std::vector<std::string> names;
};
JointNames namesOf( const Joint& joint );

/// A joint that follows another one, or is fixed.
struct Coupling
{
	std::string driver;                ///< empty: fixed
	double multiplier = 0, offset = 0; ///< value = multiplier * driver's value + offset
};
using Couplings = std::map<std::string, Coupling>; ///< by name of the joint
/// Joints of <equality> that follow others linearly; notices about all that it cannot hold. @throws Error
Couplings readCouplings(
    const Document& document, const Defaults& defaults, const Tree& tree, std::vector<Notice>& notices );
/// Adds the link of each body, behind that of its parent and without shapes, and the joints between.
void addLinks( const Document& document, const Tree& tree, const Couplings& couplings, RobotModel& model );

/// Geoms of <pair>, by the two names, sorted.
using GeomPairs = std::set<std::pair<std::string, std::string>>;
GeomPairs readGeomPairs( const Document& document, const Tree& tree );
/// A link that has nothing but a plane of the world or of a body that is fixed to it.
struct PlaneLink
{
	std::string link;
	std::size_t body = 0;
	const Geom* geom = nullptr;
};
/// Pairs of links that MuJoCo does not check, each with its reason. @throws Error
void addPairs( const Document& document, const Compiler& compiler, const Tree& tree, const GeomPairs& pairs,
    const std::vector<PlaneLink>& planes, RobotModel& model );

/// Groups (all, and one for each tree of bodies that moves, if there are several) and the states of keyframes and qpos0.
void addStates( const Document& document, const Tree& tree, RobotModel& model );

} // namespace mjcf
} // namespace leeway::io::detail
