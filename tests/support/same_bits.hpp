// SPDX-License-Identifier: BSD-3-Clause
// Two answers that are one: member by member, since the padding between members has no value.
#pragma once

#include "leeway/distance.h"

#include <cstring>

inline bool sameBits( double a, double b )
{
	return std::memcmp( &a, &b, sizeof( double ) ) == 0;
}

inline bool sameBits( const lw_vec3& a, const lw_vec3& b )
{
	return sameBits( a.x, b.x ) && sameBits( a.y, b.y ) && sameBits( a.z, b.z );
}

/// The interval, its class and its names.
inline bool sameInterval( const lw_clearance& a, const lw_clearance& b )
{
	return sameBits( a.lower, b.lower ) && sameBits( a.upper, b.upper ) && a.kind == b.kind && a.a == b.a && a.b == b.b;
}

/// Its witness points too.
inline bool sameBits( const lw_clearance& a, const lw_clearance& b )
{
	return sameInterval( a, b ) && sameBits( a.point_a, b.point_a ) && sameBits( a.point_b, b.point_b );
}
