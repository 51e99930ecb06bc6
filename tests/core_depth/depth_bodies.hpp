// SPDX-License-Identifier: BSD-3-Clause
// Bodies for tests of depths, and the call.
#pragma once

#include "shapes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

/// Number of pairs of a test, times LEEWAY_DEPTH_FACTOR: long hunts (core/docs/depth.md).
inline int pairCount( int usual )
{
	const char* factor = std::getenv( "LEEWAY_DEPTH_FACTOR" );
	return usual * ( factor != nullptr ? std::max( 1, std::atoi( factor ) ) : 1 );
}

inline lw_vec3 operator+( lw_vec3 a, lw_vec3 b )
{
	return { a.x + b.x, a.y + b.y, a.z + b.z };
}
inline lw_vec3 operator-( lw_vec3 a, lw_vec3 b )
{
	return { a.x - b.x, a.y - b.y, a.z - b.z };
}
inline lw_vec3 operator*( double s, lw_vec3 a )
{
	return { s * a.x, s * a.y, s * a.z };
}
inline double dot( lw_vec3 a, lw_vec3 b )
{
	return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline lw_vec3 cross( lw_vec3 a, lw_vec3 b )
{
	return { a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x };
}
inline double length( lw_vec3 a )
{
	return std::sqrt( dot( a, a ) );
}

inline lw_vec3 randomDirection( SeededRng& rng )
{
	lw_vec3 n = { rng.normal(), rng.normal(), rng.normal() };
	return ( 1 / length( n ) ) * n;
}

inline lw_transform movedBy( lw_transform pose, lw_vec3 move )
{
	pose.t[0] += move.x;
	pose.t[1] += move.y;
	pose.t[2] += move.z;
	return pose;
}

/// A convex body as its corners, triangles and dilation.
struct Corners
{
	std::vector<lw_vec3> points;
	std::vector<std::uint32_t> triangles;
	double radius = 0;
};

inline ShapePtr meshOf( const Corners& body, bool solid )
{
	std::vector<double> vertices;
	for ( const lw_vec3& p : body.points )
	{
		vertices.insert( vertices.end(), { p.x, p.y, p.z } );
	}
	lw_mesh_def def = lw_mesh_def_default();
	def.vertices = vertices.data();
	def.vertex_count = static_cast<std::uint32_t>( body.points.size() );
	def.indices = body.triangles.data();
	def.triangle_count = static_cast<std::uint32_t>( body.triangles.size() / 3 );
	def.solid = solid;
	lw_shape* shape = nullptr;
	lw_diag diag = {};
	EXPECT_EQ( LW_OK, lw_shape_create_mesh( &def, nullptr, &diag, &shape ) ) << diag.message;
	return ShapePtr( shape );
}

/// A prism over a regular polygon, its top smaller by a factor and shifted; outward triangles.
inline Corners prism( int sides, lw_vec3 size, double top, double shift = 0 )
{
	Corners out;
	const auto at = [&]( int i ) { return static_cast<std::uint32_t>( i % sides ); };
	for ( int level = 0; level < 2; ++level )
	{
		const double scale = level == 0 ? 1 : top;
		for ( int i = 0; i < sides; ++i )
		{
			const double angle = 2 * M_PI * i / sides;
			out.points.push_back( { scale * size.x * std::cos( angle ) + level * shift, scale * size.y * std::sin( angle ),
			    ( level == 0 ? -1 : 1 ) * size.z } );
		}
	}
	const std::uint32_t n = static_cast<std::uint32_t>( sides );
	for ( int i = 0; i < sides; ++i )
	{
		const std::uint32_t a = at( i ), b = at( i + 1 );
		out.triangles.insert( out.triangles.end(), { a, b, n + b, a, n + b, n + a } );
	}
	for ( int i = 1; i + 1 < sides; ++i )
	{
		const std::uint32_t a = at( i ), b = at( i + 1 );
		out.triangles.insert( out.triangles.end(), { 0, b, a, n, n + a, n + b } );
	}
	return out;
}

inline Corners boxCorners( lw_vec3 edges )
{
	Corners out;
	for ( int i = 0; i < 8; ++i )
	{
		out.points.push_back(
		    { ( i & 1 ? 0.5 : -0.5 ) * edges.x, ( i & 2 ? 0.5 : -0.5 ) * edges.y, ( i & 4 ? 0.5 : -0.5 ) * edges.z } );
	}
	out.triangles = {
	    0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5 };
	return out;
}

/// An angle profile of two arms: closed, not convex.
inline Corners angleIron( SeededRng& rng )
{
	const double a = rng.uniform( 0.2, 0.6 ), b = rng.uniform( 0.2, 0.6 ), t = rng.uniform( 0.02, 0.15 ),
	             h = rng.uniform( 0.05, 0.4 );
	const double profile[6][2] = { { 0, 0 }, { a, 0 }, { a, t }, { t, t }, { t, b }, { 0, b } };
	Corners out;
	for ( int i = 0; i < 12; ++i )
	{
		out.points.push_back( { profile[i % 6][0], profile[i % 6][1], i < 6 ? -h : h } );
	}
	for ( std::uint32_t i = 0; i < 6; ++i )
	{
		const std::uint32_t j = ( i + 1 ) % 6;
		out.triangles.insert( out.triangles.end(), { i, j, 6 + j, i, 6 + j, 6 + i } );
	}
	const std::uint32_t caps[4][3] = { { 0, 1, 2 }, { 0, 2, 3 }, { 0, 3, 4 }, { 0, 4, 5 } };
	for ( const std::uint32_t* c : caps )
	{
		out.triangles.insert( out.triangles.end(), { c[0], c[2], c[1], 6 + c[0], 6 + c[1], 6 + c[2] } );
	}
	return out;
}

inline lw_depth depthOf( const ShapePtr& a, const lw_transform& pose_a, const ShapePtr& b, const lw_transform& pose_b,
    lw_query* query, std::uint32_t steps = 256 )
{
	lw_depth_def def = lw_depth_def_default();
	def.steps = steps;
	lw_depth out = {};
	EXPECT_EQ( LW_OK, lw_shape_depth( a.get(), &pose_a, b.get(), &pose_b, &def, query, &out ) );
	return out;
}

inline lw_clearance distanceOf(
    const ShapePtr& a, const lw_transform& pose_a, const ShapePtr& b, const lw_transform& pose_b, lw_query* query )
{
	lw_clearance out = {};
	EXPECT_EQ( LW_OK, lw_shape_distance( a.get(), &pose_a, b.get(), &pose_b, nullptr, query, &out ) );
	return out;
}

/// The shape, written to a blob and read again.
inline ShapePtr throughABlob( const ShapePtr& shape )
{
	const lw_shape* shapes[] = { shape.get() };
	lw_blob_def def = lw_blob_def_default();
	def.shapes = shapes;
	def.shape_count = 1;
	void* bytes = nullptr;
	std::size_t size = 0;
	EXPECT_EQ( LW_OK, lw_blob_write( &def, nullptr, nullptr, &bytes, &size ) );
	lw_shape* read = nullptr;
	lw_diag diag = {};
	EXPECT_EQ( LW_OK, lw_blob_read_shapes( bytes, size, def.key, nullptr, &diag, &read, 1 ) ) << diag.message;
	lw_blob_free( nullptr, bytes, size );
	return ShapePtr( read );
}
