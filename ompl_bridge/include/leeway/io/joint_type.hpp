// SPDX-License-Identifier: BSD-3-Clause
// Names of joint types, as URDF has them.
#pragma once

#include "leeway/robot.h"

namespace leeway::io
{

/// "revolute", "continuous", "prismatic", "planar", "floating" or "fixed".
/// @return never null; "" for a value that is no joint type
const char* jointTypeName( lw_joint_type type );

} // namespace leeway::io
