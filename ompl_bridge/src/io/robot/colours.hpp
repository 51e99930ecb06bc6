// SPDX-License-Identifier: BSD-3-Clause
// Colours of a URDF's links, for pictures alone: no clearance depends on them.
#pragma once

#include "base/xml.hpp"
#include "leeway/io/model.hpp"

namespace leeway::io::detail
{

/// The colour of a link: that of its first visual with one, by value or by the name of a material of the robot. None for a
/// texture, and for values that are no colour: a picture shows the link in its own colour then.
std::optional<Colour> linkColour( const XmlFile& xml, const tinyxml2::XMLElement& link );

} // namespace leeway::io::detail
