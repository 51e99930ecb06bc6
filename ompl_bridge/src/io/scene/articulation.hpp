// SPDX-License-Identifier: BSD-3-Clause
// URDFs as parts of a scene: kitchens with doors and drawers at given joint values.
#pragma once

#include "base/io_internal.hpp"

namespace leeway::io::detail
{

/// Sets a URDF or MJCF up at these joint values; joints that are not named are at zero, those of an MJCF where the file places them. The articulation's shapes and
/// notices are in its model's report.
/// @param prefix of the objects' names: "" or "kitchen/"
/// @param place the file and element that errors about values name
/// @throws Error
Articulation readArticulation( std::unique_ptr<XmlFile> xml, const std::string& name, const std::string& prefix,
    const std::map<std::string, double>& values, const ShapeLoader::Place& place, const LoadOptions& options );

/// Its objects where its values put them, one for each link with geometry.
std::vector<SceneObject> articulatedObjects( const Articulation& articulation );

} // namespace leeway::io::detail
