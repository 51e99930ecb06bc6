// SPDX-License-Identifier: BSD-3-Clause
// Clouds and frames of tests, in a line each.
#pragma once

#include "leeway/cloud.h"
#include "leeway/handles.hpp"
#include "poses.hpp"
#include "seeded_rng.hpp"

#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <memory>
#include <set>
#include <vector>

struct CloudReleaser
{
	void operator()( lw_cloud* cloud ) const { lw_cloud_destroy( cloud ); }
};
using CloudPtr = std::unique_ptr<lw_cloud, CloudReleaser>;
using Voxel = std::array<int, 3>;
using Point = std::array<double, 3>;

inline lw_cloud_def cloudOf( double resolution, double half_box )
{
	lw_cloud_def def = lw_cloud_def_default();
	def.resolution = resolution;
	for ( int k = 0; k < 3; ++k )
	{
		def.box_min[k] = -half_box;
		def.box_max[k] = half_box;
	}
	return def;
}

inline CloudPtr makeCloud( const lw_cloud_def& def, const lw_allocator* allocator = nullptr )
{
	lw_cloud* cloud = nullptr;
	lw_diag diag = {};
	EXPECT_EQ( LW_OK, lw_cloud_create( &def, allocator, &diag, &cloud ) ) << diag.message;
	return CloudPtr( cloud );
}

/// A frame of points in the world, which it keeps.
struct PointFrame
{
	std::vector<double> numbers;
	lw_cloud_frame frame = lw_cloud_frame_default();

	PointFrame( double stamp, const std::vector<Point>& points, const Point& sensor = { 0, 0, 0 } )
	{
		for ( const Point& p : points )
		{
			numbers.insert( numbers.end(), p.begin(), p.end() );
		}
		numbers.push_back( 0 ); // data is not NULL without points
		frame.stamp = stamp;
		frame.points.data = numbers.data();
		frame.points.width = static_cast<std::uint32_t>( points.size() );
		frame.points.height = 1;
		frame.points.point_step = 3 * sizeof( double );
		for ( std::size_t k = 0; k < 3; ++k )
		{
			frame.points.offset[k] = k * sizeof( double );
			frame.world_from_sensor.t[k] = sensor[k];
		}
		frame.points.is_double = frame.points.in_world = true;
	}
	PointFrame( const PointFrame& ) = delete;
	PointFrame& operator=( const PointFrame& ) = delete;
};

/// A depth image in metres, which it keeps.
struct DepthFrame
{
	std::vector<float> depths;
	lw_cloud_frame frame = lw_cloud_frame_default();

	DepthFrame(
	    double stamp, const lw_transform& world_from_camera, std::uint32_t width, std::uint32_t height, double focal )
	    : depths( static_cast<std::size_t>( width ) * height )
	{
		frame.stamp = stamp;
		frame.world_from_sensor = world_from_camera;
		lw_cloud_depth& d = frame.depth;
		d.data = depths.data();
		d.width = width;
		d.height = height;
		d.row_step = width * sizeof( float );
		d.is_float = true;
		d.fx = d.fy = focal;
		d.cx = 0.5 * ( width - 1.0 );
		d.cy = 0.5 * ( height - 1.0 );
	}
	DepthFrame( const DepthFrame& ) = delete;
	DepthFrame& operator=( const DepthFrame& ) = delete;

	float& at( std::uint32_t u, std::uint32_t v ) { return depths[static_cast<std::size_t>( v ) * frame.depth.width + u]; }
	void fill( double z ) { std::fill( depths.begin(), depths.end(), static_cast<float>( z ) ); }
	/// The point of a pixel at its depth, world, in long double.
	std::array<long double, 3> point( std::uint32_t u, std::uint32_t v ) const
	{
		const lw_cloud_depth& d = frame.depth;
		const long double z = depths[static_cast<std::size_t>( v ) * d.width + u];
		const long double q[3] = {
		    ( u - static_cast<long double>( d.cx ) ) / d.fx * z, ( v - static_cast<long double>( d.cy ) ) / d.fy * z, z };
		std::array<long double, 3> p;
		for ( std::size_t i = 0; i < 3; ++i )
		{
			p[i] = frame.world_from_sensor.t[i];
			for ( std::size_t k = 0; k < 3; ++k )
			{
				p[i] += frame.world_from_sensor.r[i][k] * q[k];
			}
		}
		return p;
	}
};

inline lw_cloud_report insert( lw_cloud* cloud, const lw_cloud_frame& frame, lw_status expected = LW_OK )
{
	lw_cloud_report report = {};
	lw_diag diag = {};
	EXPECT_EQ( expected, lw_cloud_insert( cloud, &frame, &diag, &report ) ) << diag.message;
	return report;
}

inline void hit( lw_cloud* cloud, double stamp, const std::vector<Point>& points, const Point& sensor = { 0, 0, 0 } )
{
	PointFrame frame( stamp, points, sensor );
	frame.frame.clears = false;
	insert( cloud, frame.frame );
}

inline lw_cloud_voxel stateAt( const lw_cloud* cloud, const Point& p )
{
	return lw_cloud_state( cloud, { p[0], p[1], p[2] } );
}

inline std::set<Voxel> voxelsOf( const lw_cloud* cloud, lw_cloud_voxel state = LW_VOXEL_OCCUPIED )
{
	const std::uint64_t count = lw_cloud_voxels( cloud, state, nullptr, 0 );
	std::vector<double> centers( 3 * count + 1 );
	EXPECT_EQ( count, lw_cloud_voxels( cloud, state, centers.data(), count ) );
	const double resolution = lw_cloud_get_info( cloud ).resolution;
	std::set<Voxel> voxels;
	for ( std::uint64_t i = 0; i < count; ++i )
	{
		Voxel v;
		for ( std::size_t k = 0; k < 3; ++k )
		{
			v[k] = static_cast<int>( std::floor( centers[3 * i + k] / resolution ) );
		}
		voxels.insert( v );
	}
	EXPECT_EQ( voxels.size(), count ) << "a voxel is listed twice";
	return voxels;
}

/// A camera at `eye` that looks at `target`, x right, y down.
inline lw_transform lookAt( const Point& eye, const Point& target )
{
	double f[3], length = 0;
	for ( std::size_t k = 0; k < 3; ++k )
	{
		f[k] = target[k] - eye[k];
		length += f[k] * f[k];
	}
	for ( double& x : f )
	{
		x /= std::sqrt( length );
	}
	const double up[3] = { 0.01, 0.02, 1 };
	double right[3] = { f[1] * up[2] - f[2] * up[1], f[2] * up[0] - f[0] * up[2], f[0] * up[1] - f[1] * up[0] };
	const double size = std::sqrt( right[0] * right[0] + right[1] * right[1] + right[2] * right[2] );
	for ( double& x : right )
	{
		x /= size;
	}
	const double down[3] = {
	    f[1] * right[2] - f[2] * right[1], f[2] * right[0] - f[0] * right[2], f[0] * right[1] - f[1] * right[0] };
	lw_transform m = lw_transform_identity();
	for ( std::size_t k = 0; k < 3; ++k )
	{
		m.r[k][0] = right[k];
		m.r[k][1] = down[k];
		m.r[k][2] = f[k];
		m.t[k] = eye[k];
	}
	return m;
}

inline Point randomPoint( SeededRng& rng, double half )
{
	return { rng.uniform( -half, half ), rng.uniform( -half, half ), rng.uniform( -half, half ) };
}

/// The cloud as an object of this name in a scene.
inline leeway::Scene sceneOf( lw_cloud* cloud, const lw_scene* base = nullptr )
{
	lw_scene* scene = nullptr;
	lw_diag diag = {};
	EXPECT_EQ( LW_OK, lw_cloud_scene( cloud, base, "cloud", &diag, &scene ) ) << diag.message;
	return leeway::Scene::adopt( scene );
}
