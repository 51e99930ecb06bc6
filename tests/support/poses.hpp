// SPDX-License-Identifier: BSD-3-Clause
// Poses in one line.
#pragma once

#include "leeway/math.h"

/// The pose of a frame moved by (x, y, z).
inline lw_transform at( double x, double y, double z )
{
	lw_transform pose = lw_transform_identity();
	pose.t[0] = x;
	pose.t[1] = y;
	pose.t[2] = z;
	return pose;
}
