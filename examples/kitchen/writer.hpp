// SPDX-License-Identifier: BSD-3-Clause
// The demo as files: meshes, URDF, SRDF, planning scene, requests and a table of colours.
#pragma once

#include "model.hpp"

namespace kitchen
{

struct Demo
{
	Robot robot;
	Room room;
	std::vector<Reach> reaches;
};

Demo makeDemo();

/// Writes everything into the folder (created if missing), whose own name becomes the package of the mesh URIs.
/// @throws std::runtime_error naming the file that cannot be written
void writeDemo( const Demo& demo, const std::string& folder );

} // namespace kitchen
