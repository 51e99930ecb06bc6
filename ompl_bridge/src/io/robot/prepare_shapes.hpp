// SPDX-License-Identifier: BSD-3-Clause
// The collision elements of a URDF that are read.
#pragma once

#include "base/xml.hpp"

namespace leeway::io::detail
{

/// Changes the <collision> elements of a URDF by LoadOptions::use_visual and skip_missing_meshes, and takes out shapes of size zero.
/// @throws Error, also if every mesh is missing and no other shape is left
void prepareShapes( XmlFile& xml, const LoadOptions& options, std::vector<Notice>& notices );

} // namespace leeway::io::detail
