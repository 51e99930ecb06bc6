// SPDX-License-Identifier: BSD-3-Clause
// Height maps (greyscale PNG, or a text of numbers) as solid ground.
#pragma once

#include "base/io_internal.hpp"

namespace leeway::io::detail
{

/// Samples of a map in the units of its file; row 0 is the last of the file, the one with the least y.
struct HeightGrid
{
	std::size_t columns = 0, rows = 0;
	std::vector<double> values; ///< [rows][columns]; NaN where the file has no height
	std::size_t unknown = 0;    ///< those that are NaN
};

/// By the file's ending: .png (8 or 16 bits of grey), else text (numbers between commas or blanks, a row a line).
/// @throws Error with the map's file and the place in it
HeightGrid readHeightGrid( const std::string& file );
/// @param any_picture false: 8 or 16 bits of grey, all others are refused. True: the first channel (red, or grey) of any picture, its
/// upper 8 bits, as MuJoCo reads them; transparency is passed over
HeightGrid readHeightPng( const std::string& file, bool any_picture );

/// How a grid lies in its frame.
struct HeightMapUse
{
	double resolution = 0;                 ///< metres between samples
	double z_scale = 1;                    ///< metres for one unit of the file
	std::array<double, 3> origin{};        ///< of the first sample of row 0; z is the height of value 0
	double depth = 10;                     ///< metres of ground below the lowest sample
	std::optional<bool> unknown_is_ground; ///< samples without a height: as high as the highest, or nothing
};

/// The ground as a closed surface: on top two triangles for each four neighbouring samples, split so that their edge is
/// the higher one; walls and a bottom below. @throws Error with `file`
TriangleSoup groundMesh( const HeightGrid& grid, const HeightMapUse& use, const std::string& file );

} // namespace leeway::io::detail
