// SPDX-License-Identifier: BSD-3-Clause
// URDF text of a robot that was read from another format.
#pragma once

#include "base/xml.hpp"
#include "leeway/io/model.hpp"

namespace leeway::io::detail
{

/// True if a file is a URDF that can be written again as it is: no macros, no other format.
bool isPlainUrdf( const XmlFile& file );

/// Links without geometry, and joints: limits, mimics, poses to the last digits of a double. The virtual joint of an SRDF is left out.
void describe( const RobotModel& model, tinyxml2::XMLDocument& out );

} // namespace leeway::io::detail
