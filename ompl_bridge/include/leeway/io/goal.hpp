// SPDX-License-Identifier: BSD-3-Clause
// Goals of motion plan requests as plain data: joint values, and poses of links (moveit_msgs/Constraints).
// Units: metres, radians; quaternions x, y, z, w.
#pragma once

#include "leeway/leeway.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace leeway::io
{

/// A frame by its place: fixed to a link of the robot, or to the planning frame.
struct Frame
{
	std::uint32_t link = LW_INVALID_INDEX;       ///< LW_INVALID_INDEX: the planning frame
	lw_transform pose = lw_transform_identity(); ///< of the frame, in the frame of `link` or in the planning frame
};

/// The value of a variable is in [position - tolerance_below, position + tolerance_above].
struct JointGoal
{
	std::string joint; ///< variable name
	double position = 0, tolerance_above = 0, tolerance_below = 0;
};

/// A solid that a point of a link must lie in, boundary included. Sizes may be 0: a point, a segment, a face.
struct GoalRegion
{
	enum class Type
	{
		Box,     ///< size: full lengths along x, y, z
		Sphere,  ///< size[0]: radius
		Cylinder ///< size[0]: radius, size[1]: full height along z
	};
	Type type = Type::Sphere;
	std::array<double, 3> size = { 0, 0, 0 };
	lw_transform pose = lw_transform_identity(); ///< of its centre, in the frame of the constraint
};

/// A point of a link lies in one of the regions.
struct PositionGoal
{
	std::string link;                           ///< a link of the robot, or an attached object
	std::string frame;                          ///< of the regions: a name for findFrame(); empty = planning frame
	std::array<double, 3> offset = { 0, 0, 0 }; ///< the point, in the frame of the link
	std::vector<GoalRegion> regions;            ///< one or more
	std::string element;                        ///< for errors
};

/// The rotation from the wanted orientation to the link's deviates from none by at most the tolerances. With D the link's
/// rotation in the frame of the wanted orientation (D = wanted^-1 link):
/// - euler_xyz: D = Rx(a) Ry(b) Rz(c), |a| <= tolerance[0], |b| <= tolerance[1], |c| <= tolerance[2]
/// - rotation_vector: D turns about the vector v by |v|, and |v[i]| <= tolerance[i]
struct OrientationGoal
{
	enum class Parameterization
	{
		euler_xyz = 0,
		rotation_vector = 1
	};
	std::string link, frame;                           ///< as PositionGoal
	std::array<double, 4> quaternion = { 0, 0, 0, 1 }; ///< wanted orientation in `frame`, of length 1
	std::array<double, 3> tolerance = { 0, 0, 0 };     ///< >= 0; pi or more leaves an angle free
	Parameterization parameterization = Parameterization::euler_xyz;
	std::string element; ///< for errors
};

} // namespace leeway::io
