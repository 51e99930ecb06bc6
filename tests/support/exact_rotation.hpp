// SPDX-License-Identifier: BSD-3-Clause
// Rotations in more than double precision: the meaning of a matrix of doubles.
#pragma once

#include "exact_triangles.hpp"

namespace exact
{
/// The rotation that is meant by a matrix that is one to rounding, or to the tolerance of lw_transform_is_valid(): its rows
/// made orthonormal.
template <class R> struct RotationOf
{
	Vec<R> row[3];

	RotationOf() : row{ { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } } {}
	explicit RotationOf( const lw_transform& m )
	{
		for ( int i = 0; i < 2; ++i )
		{
			row[i] = { R( m.r[i][0] ), R( m.r[i][1] ), R( m.r[i][2] ) };
		}
		row[0] = ( 1 / length( row[0] ) ) * row[0];
		for ( int i = 0; i < 2; ++i ) // the second time against rounding in the first
		{
			row[1] = row[1] - dot( row[0], row[1] ) * row[0];
			row[1] = ( 1 / length( row[1] ) ) * row[1];
		}
		row[2] = cross( row[0], row[1] );
	}
	Vec<R> operator()( lw_vec3 p ) const { return ( *this )( Vec<R>{ R( p.x ), R( p.y ), R( p.z ) } ); }
	Vec<R> operator()( Vec<R> v ) const { return { dot( row[0], v ), dot( row[1], v ), dot( row[2], v ) }; }
	RotationOf operator*( const RotationOf& other ) const
	{
		RotationOf out;
		for ( int i = 0; i < 3; ++i )
		{
			out.row[i] = row[i].x * other.row[0] + row[i].y * other.row[1] + row[i].z * other.row[2];
		}
		return out;
	}
	Vec<R> back( Vec<R> v ) const { return v.x * row[0] + v.y * row[1] + v.z * row[2]; }
};

using Rotation = RotationOf<Wide>;

/// A rotation about a unit axis (Rodrigues).
inline Rotation turn( Vec<Wide> axis, Wide angle )
{
	Wide c = std::cos( angle ), s = std::sin( angle ), d = 1 - c;
	Rotation out;
	out.row[0] = { c + d * axis.x * axis.x, d * axis.x * axis.y - s * axis.z, d * axis.x * axis.z + s * axis.y };
	out.row[1] = { d * axis.x * axis.y + s * axis.z, c + d * axis.y * axis.y, d * axis.y * axis.z - s * axis.x };
	out.row[2] = { d * axis.x * axis.z - s * axis.y, d * axis.y * axis.z + s * axis.x, c + d * axis.z * axis.z };
	return out;
}
} // namespace exact
