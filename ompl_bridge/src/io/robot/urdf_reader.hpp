// SPDX-License-Identifier: BSD-3-Clause
// URDF as a robot, without SRDF.
#pragma once

#include "base/xml.hpp"

namespace leeway::io::detail
{

/// @param xml loses the elements that are left out with a notice @throws Error that names element and remedy
RobotModel readUrdf( XmlFile& xml, const LoadOptions& options );

} // namespace leeway::io::detail
