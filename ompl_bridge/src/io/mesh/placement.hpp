// SPDX-License-Identifier: BSD-3-Clause
// Where a node of a mesh file puts points: any affine map, in double. Files' matrices are float, and chains of them would
// round at every level.
#pragma once

#include <array>
#include <cstddef>

namespace leeway::io::detail
{

/// Three rows; the last column is the translation.
using Placement = std::array<std::array<double, 4>, 3>;

inline constexpr Placement IN_PLACE = { { { 1, 0, 0, 0 }, { 0, 1, 0, 0 }, { 0, 0, 1, 0 } } };

/// a * b: applies b first, then a.
inline Placement multiply( const Placement& a, const Placement& b )
{
	Placement product{};
	for ( std::size_t row = 0; row < 3; ++row )
	{
		for ( std::size_t column = 0; column < 4; ++column )
		{
			product[row][column] = a[row][0] * b[0][column] + a[row][1] * b[1][column] + a[row][2] * b[2][column] +
			                       ( column == 3 ? a[row][3] : 0 );
		}
	}
	return product;
}

inline std::array<double, 3> apply( const Placement& by, double x, double y, double z )
{
	std::array<double, 3> out{};
	for ( std::size_t row = 0; row < 3; ++row )
	{
		out[row] = by[row][0] * x + by[row][1] * y + by[row][2] * z + by[row][3];
	}
	return out;
}

} // namespace leeway::io::detail
