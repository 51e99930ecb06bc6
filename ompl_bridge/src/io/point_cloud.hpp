// SPDX-License-Identifier: BSD-3-Clause
// Point cloud files: PCD (ascii, binary, binary_compressed) and PLY (ascii, binary of both byte orders).
#pragma once

#include "binary_data.hpp"

namespace leeway::io::detail
{

struct PointCloud
{
	std::vector<double> points;     ///< x, y, z, ... as in the file
	std::size_t dropped = 0;        ///< points with a coordinate that is not finite: a sensor saw nothing there
	std::vector<std::string> notes; ///< what the file says that has no place in a shape

	/// Keeps the point, or counts it as dropped.
	void add( double x, double y, double z );
};

/// By the file's ending, .pcd or .ply. Memory is taken as the file's own bytes ask for it, never on the word of its header.
/// @throws Error with the cloud's file and the place in it
PointCloud readPointCloud( const std::string& file );

PointCloud readPcd( const std::string& file );
PointCloud readPlyPoints( const std::string& file );

} // namespace leeway::io::detail
