// SPDX-License-Identifier: BSD-3-Clause
// World files.
#pragma once

#include "leeway/io/world_model.hpp"

#include <string>

namespace leeway::io::detail
{

/// Whether a file that can be no XML is meant as a world.
bool isWorld( const std::string& content );

/// Where the objects go that rest.
enum class Resting
{
	scene, ///< into WorldModel::scene
	links  ///< onto the robot: links that are fixed to its root
};

/// @param content of the file @throws Error
WorldModel readWorld( const std::string& file, std::string content, const LoadOptions& options, Resting resting );

} // namespace leeway::io::detail
