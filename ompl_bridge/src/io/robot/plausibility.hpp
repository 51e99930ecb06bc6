// SPDX-License-Identifier: BSD-3-Clause
// Notices about readable values that are hardly meant: degrees, millimetres, a robot inside an obstacle's surface.
#pragma once

#include "base/io_internal.hpp"

namespace leeway::io::detail
{

/// Limits of revolute joints that look like degrees or bound nothing, and of prismatic joints that look like millimetres.
void noticeOddLimits( const RobotModel& model, std::vector<Notice>& notices );

/// Meshes of a robot that are far larger than its other shapes or than 50 m, or smaller than half a millimetre.
void noticeOddSizes( const RobotModel& model, std::vector<Notice>& notices );
/// Meshes of a scene larger than 50 m or smaller than half a millimetre.
void noticeOddSizes( const SceneModel& scene, std::vector<Notice>& notices );

/// Objects of which a mesh encloses a link in the reference state: surfaces have no inside, so that the link is free there.
/// @param allowed links and objects whose contact does not count
/// Cost: linear in the triangles of meshes whose box contains a point of a link
void noticeEnclosures( const RobotModel& model, const SceneModel& scene,
    const std::vector<std::pair<std::string, std::string>>& allowed, Problem& problem );

} // namespace leeway::io::detail
