// SPDX-License-Identifier: BSD-3-Clause
// A simulated depth camera: triangles of scenes and robots into a depth image, by a depth buffer. Needs nothing but the core.
#pragma once

#include "leeway/leeway.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

/// Triangles, one after the other: nine numbers each, metres.
using TriangleList = std::vector<double>;

class DepthCamera
{
public:
	/// @param focal pixels; the optical axis goes through the middle of the image
	DepthCamera( std::uint32_t width, std::uint32_t height, double focal )
	    : m_width( width ), m_height( height ), m_focal( focal ), m_inverse( static_cast<std::size_t>( width ) * height )
	{
	}

	/// The lens and the layout of images of this camera; `data` is left to the caller.
	lw_cloud_depth layout() const
	{
		lw_cloud_depth depth = {};
		depth.width = m_width;
		depth.height = m_height;
		depth.row_step = m_width * sizeof( float );
		depth.is_float = true;
		depth.scale = 1;
		depth.fx = depth.fy = m_focal;
		depth.cx = 0.5 * ( m_width - 1.0 );
		depth.cy = 0.5 * ( m_height - 1.0 );
		return depth;
	}

	void begin() { std::fill( m_inverse.begin(), m_inverse.end(), 0.0 ); }

	/// Draws triangles that are in a frame of the world.
	void draw(
	    const TriangleList& triangles, const lw_transform& world_from_triangles, const lw_transform& world_from_camera )
	{
		const lw_transform camera_from_world = lw_transform_inverse( &world_from_camera );
		const lw_transform pose = lw_transform_multiply( &camera_from_world, &world_from_triangles );
		for ( std::size_t i = 0; i + 9 <= triangles.size(); i += 9 )
		{
			std::array<lw_vec3, 4> corners;
			std::array<lw_vec3, 3> given;
			for ( std::size_t k = 0; k < 3; ++k )
			{
				const double* p = &triangles[i + 3 * k];
				given[k] = lw_transform_point( &pose, { p[0], p[1], p[2] } );
			}
			const std::size_t count = clip( given, corners );
			for ( std::size_t k = 2; k < count; ++k )
			{
				fill( corners[0], corners[k - 1], corners[k] );
			}
		}
	}

	/// Depths in metres; 0 where nothing is.
	std::vector<float> image() const
	{
		std::vector<float> depths( m_inverse.size() );
		std::transform( m_inverse.begin(), m_inverse.end(), depths.begin(),
		    []( double inverse ) { return inverse > 0 ? static_cast<float>( 1 / inverse ) : 0.0f; } );
		return depths;
	}

private:
	static constexpr double NEAR = 0.05; ///< metres: nothing nearer is drawn

	/// The part in front of the camera: 0, 3 or 4 corners.
	static std::size_t clip( const std::array<lw_vec3, 3>& given, std::array<lw_vec3, 4>& out )
	{
		std::size_t count = 0;
		for ( std::size_t k = 0; k < 3; ++k )
		{
			const lw_vec3 a = given[k], b = given[( k + 1 ) % 3];
			if ( a.z > NEAR )
			{
				out[count++] = a;
			}
			if ( ( a.z > NEAR ) != ( b.z > NEAR ) )
			{
				const double t = ( NEAR - a.z ) / ( b.z - a.z );
				out[count++] = { a.x + t * ( b.x - a.x ), a.y + t * ( b.y - a.y ), NEAR };
			}
		}
		return count;
	}

	/// 1 / z is linear in the image.
	void fill( lw_vec3 a, lw_vec3 b, lw_vec3 c )
	{
		const lw_vec3* corners[3] = { &a, &b, &c };
		double u[3], v[3], inverse[3];
		for ( int k = 0; k < 3; ++k )
		{
			inverse[k] = 1 / corners[k]->z;
			u[k] = m_focal * corners[k]->x * inverse[k] + 0.5 * ( m_width - 1.0 );
			v[k] = m_focal * corners[k]->y * inverse[k] + 0.5 * ( m_height - 1.0 );
		}
		const double area = ( u[1] - u[0] ) * ( v[2] - v[0] ) - ( u[2] - u[0] ) * ( v[1] - v[0] );
		if ( area == 0 )
		{
			return;
		}
		const auto [u_low, u_high] = std::minmax( { u[0], u[1], u[2] } );
		const auto [v_low, v_high] = std::minmax( { v[0], v[1], v[2] } );
		const auto first = []( double x, std::uint32_t size )
		{ return static_cast<std::uint32_t>( std::clamp( std::ceil( x ), 0.0, static_cast<double>( size ) ) ); };
		const auto end = []( double x, std::uint32_t size )
		{ return static_cast<std::uint32_t>( std::clamp( std::floor( x ) + 1, 0.0, static_cast<double>( size ) ) ); };
		for ( std::uint32_t y = first( v_low, m_height ); y < end( v_high, m_height ); ++y )
		{
			for ( std::uint32_t x = first( u_low, m_width ); x < end( u_high, m_width ); ++x )
			{
				const double s = ( ( x - u[0] ) * ( v[2] - v[0] ) - ( u[2] - u[0] ) * ( y - v[0] ) ) / area;
				const double t = ( ( u[1] - u[0] ) * ( y - v[0] ) - ( x - u[0] ) * ( v[1] - v[0] ) ) / area;
				if ( s >= 0 && t >= 0 && s + t <= 1 )
				{
					double& kept = m_inverse[static_cast<std::size_t>( y ) * m_width + x];
					kept = std::max( kept, inverse[0] + s * ( inverse[1] - inverse[0] ) + t * ( inverse[2] - inverse[0] ) );
				}
			}
		}
	}

	std::uint32_t m_width, m_height;
	double m_focal;
	std::vector<double> m_inverse; ///< 1 / depth; 0: nothing
};

/// A surface that is turned about z: rings of (radius, z), in 48 steps.
inline TriangleList turned( const std::vector<std::array<double, 2>>& rings )
{
	constexpr int steps = 48;
	const auto at = []( const std::array<double, 2>& ring, int step )
	{
		const double angle = 2 * 3.14159265358979323846 * step / steps;
		return std::array<double, 3>{ ring[0] * std::cos( angle ), ring[0] * std::sin( angle ), ring[1] };
	};
	TriangleList out;
	for ( std::size_t i = 1; i < rings.size(); ++i )
	{
		for ( int step = 0; step < steps; ++step )
		{
			const std::array<double, 3> p[4] = {
			    at( rings[i - 1], step ), at( rings[i - 1], step + 1 ), at( rings[i], step ), at( rings[i], step + 1 ) };
			for ( const int corner : { 0, 1, 2, 1, 3, 2 } )
			{
				out.insert( out.end(), p[corner].begin(), p[corner].end() );
			}
		}
	}
	return out;
}

/// Triangles of a mesh, a box, a sphere, a cylinder or a cone (round ones in steps), shape frame. None of other types.
inline TriangleList trianglesOf( const lw_shape* shape )
{
	const lw_shape_info info = lw_shape_get_info( shape );
	const double* d = info.dimensions;
	TriangleList out;
	switch ( info.type )
	{
	case LW_SHAPE_MESH:
		for ( std::size_t i = 0; i < 3 * static_cast<std::size_t>( info.triangle_count ); ++i )
		{
			const double* v = lw_shape_vertices( shape ) + 3 * static_cast<std::size_t>( lw_shape_triangles( shape )[i] );
			out.insert( out.end(), v, v + 3 );
		}
		return out;
	case LW_SHAPE_BOX:
		for ( int face = 0; face < 6; ++face )
		{
			const int axis = face / 2;
			for ( const int corner : { 0, 1, 2, 1, 3, 2 } )
			{
				double p[3];
				p[axis] = face % 2 == 0 ? 0.5 * d[axis] : -0.5 * d[axis];
				p[( axis + 1 ) % 3] = ( corner & 1 ? 0.5 : -0.5 ) * d[( axis + 1 ) % 3];
				p[( axis + 2 ) % 3] = ( corner & 2 ? 0.5 : -0.5 ) * d[( axis + 2 ) % 3];
				out.insert( out.end(), p, p + 3 );
			}
		}
		return out;
	case LW_SHAPE_SPHERE:
	{
		std::vector<std::array<double, 2>> rings;
		for ( int i = 0; i <= 24; ++i )
		{
			const double angle = 3.14159265358979323846 * i / 24;
			rings.push_back( { d[0] * std::sin( angle ), -d[0] * std::cos( angle ) } );
		}
		return turned( rings );
	}
	case LW_SHAPE_CYLINDER:
		return turned( { { 0, -0.5 * d[1] }, { d[0], -0.5 * d[1] }, { d[0], 0.5 * d[1] }, { 0, 0.5 * d[1] } } );
	case LW_SHAPE_CONE:
		return turned( { { 0, -0.5 * d[1] }, { d[0], -0.5 * d[1] }, { 0, 0.5 * d[1] } } );
	default:
		return out;
	}
}
