// SPDX-License-Identifier: BSD-3-Clause
// Rays: a voxel is cleared only if a ray of the frame went through it and ended behind it. Checked in long double, ray by ray.
#include "cloud_bench.hpp"

#include <algorithm>
#include <cstring>
#include <functional>

namespace
{

using Real = long double;
using Vector = std::array<Real, 3>;

struct Ray
{
	Vector from, to;
};

/// Does the segment go through the open cube, and end at least `margin` behind all of it along `forward`?
bool passes( const Ray& ray, const Voxel& voxel, Real resolution, Real margin, const Vector& forward )
{
	Real enter = 0, leave = 1, behind = 0, deepest = -INFINITY;
	for ( std::size_t k = 0; k < 3; ++k )
	{
		const Real low = voxel[k] * resolution, high = low + resolution, d = ray.to[k] - ray.from[k];
		if ( std::abs( d ) < 1e-12L )
		{
			if ( ray.from[k] <= low || ray.from[k] >= high )
			{
				return false;
			}
			continue;
		}
		const Real a = ( low - ray.from[k] ) / d, b = ( high - ray.from[k] ) / d;
		enter = std::max( enter, std::min( a, b ) );
		leave = std::min( leave, std::max( a, b ) );
		behind += forward[k] * d;
	}
	for ( int corner = 0; corner < 8; ++corner )
	{
		Real depth = 0;
		for ( std::size_t k = 0; k < 3; ++k )
		{
			depth += forward[k] * ( ( voxel[k] + ( corner >> k & 1 ) ) * resolution - ray.from[k] );
		}
		deepest = std::max( deepest, depth );
	}
	return enter < leave && behind >= deepest + margin - 1e-9L;
}

/// All voxels that were cleared or uncovered are passed by a ray; none of those hit by the frame is.
void expectPassed( const std::set<Voxel>& gone, const std::vector<Ray>& rays, double resolution, double margin,
    const std::function<Vector( const Ray& )>& forward )
{
	std::size_t number = 0;
	for ( const Voxel& voxel : gone )
	{
		if ( gone.size() > 500 && ++number % 11 != 0 )
		{
			continue; // of very many some
		}
		EXPECT_TRUE( std::any_of( rays.begin(), rays.end(),
		    [&]( const Ray& ray ) { return passes( ray, voxel, resolution, margin, forward( ray ) ); } ) )
		    << voxel[0] << " " << voxel[1] << " " << voxel[2];
	}
}

std::set<Voxel> without( const std::set<Voxel>& a, const std::set<Voxel>& b )
{
	std::set<Voxel> out;
	std::set_difference( a.begin(), a.end(), b.begin(), b.end(), std::inserter( out, out.end() ) );
	return out;
}

Point inDouble( const Vector& v )
{
	return { static_cast<double>( v[0] ), static_cast<double>( v[1] ), static_cast<double>( v[2] ) };
}

std::vector<Ray> raysOf( const DepthFrame& frame )
{
	std::vector<Ray> rays;
	const double* t = frame.frame.world_from_sensor.t;
	for ( std::uint32_t i = 0; i < frame.depths.size(); ++i )
	{
		if ( frame.depths[i] > 0 && std::isfinite( frame.depths[i] ) )
		{
			rays.push_back(
			    { { t[0], t[1], t[2] }, frame.point( i % frame.frame.depth.width, i / frame.frame.depth.width ) } );
		}
	}
	return rays;
}

/// Random surfaces: pieces of constant depth, holes without a measurement, noise.
void randomDepths( DepthFrame& frame, SeededRng& rng, double far )
{
	frame.fill( rng.uniform( 0.5 * far, far ) );
	const int width = static_cast<int>( frame.frame.depth.width ), height = static_cast<int>( frame.frame.depth.height );
	for ( int piece = rng.integer( 0, 6 ); piece > 0; --piece )
	{
		const int u0 = rng.integer( 0, width - 1 ), u1 = rng.integer( u0, width - 1 ), v0 = rng.integer( 0, height - 1 ),
		          v1 = rng.integer( v0, height - 1 );
		const double z = rng.integer( 0, 3 ) == 0 ? 0 : rng.uniform( 0.2 * far, far );
		for ( int i = u0; i <= u1; ++i )
		{
			for ( int k = v0; k <= v1; ++k )
			{
				frame.at( static_cast<std::uint32_t>( i ), static_cast<std::uint32_t>( k ) ) = static_cast<float>( z );
			}
		}
	}
	for ( float& z : frame.depths )
	{
		z *= static_cast<float>( 1 + 0.002 * rng.normal() );
	}
}

} // namespace

/// Random depth images over random voxels, coarse and fine, with and without unseen voxels that are blocked.
TEST( CloudRays, ADepthImageClearsWithoutARay )
{
	SeededRng rng( 20261202 );
	std::size_t cleared = 0, uncovered = 0, kept = 0;
	for ( int round = 0; round < 24; ++round )
	{
		const double resolution = rng.uniform( 0.02, 0.06 );
		lw_cloud_def def = cloudOf( resolution, 0.6 );
		def.unseen_blocked = round % 2 == 1;
		def.clear_margin = round % 3 == 0 ? 0 : rng.uniform( 0, 0.1 );
		const CloudPtr cloud = makeCloud( def );
		std::vector<Point> before;
		for ( int i = 0; i < 600; ++i )
		{
			before.push_back( randomPoint( rng, 0.6 ) );
		}
		hit( cloud.get(), 1, before );
		const std::set<Voxel> had = voxelsOf( cloud.get() );
		DepthFrame frame( 2, lookAt( randomPoint( rng, 1 ), randomPoint( rng, 0.3 ) ), 40, 30, rng.uniform( 15, 60 ) );
		randomDepths( frame, rng, 1.6 );
		const lw_cloud_report report = insert( cloud.get(), frame.frame );
		const std::vector<Ray> rays = raysOf( frame );
		const std::set<Voxel> has = voxelsOf( cloud.get() );
		const lw_transform& pose = frame.frame.world_from_sensor;
		const Vector forward = { pose.r[0][2], pose.r[1][2], pose.r[2][2] };
		const std::set<Voxel> gone = without( had, has );
		expectPassed( gone, rays, resolution, def.clear_margin, [&]( const Ray& ) { return forward; } );
		EXPECT_EQ( gone.size(), report.cleared );
		for ( const Ray& ray : rays )
		{
			const lw_cloud_voxel state = stateAt( cloud.get(), inDouble( ray.to ) );
			const lw_cloud_info info = lw_cloud_get_info( cloud.get() );
			bool inside = true;
			for ( std::size_t k = 0; k < 3; ++k )
			{
				inside = inside && ray.to[k] > info.box_min[k] + 1e-6 && ray.to[k] < info.box_max[k] - 1e-6;
			}
			EXPECT_TRUE( !inside || state == LW_VOXEL_OCCUPIED );
		}
		if ( def.unseen_blocked )
		{
			const std::set<Voxel> free = without( voxelsOf( cloud.get(), LW_VOXEL_FREE ), gone );
			expectPassed( free, rays, resolution, def.clear_margin, [&]( const Ray& ) { return forward; } );
			EXPECT_EQ( free.size(), report.uncovered );
			uncovered += free.size();
		}
		cleared += gone.size();
		kept += has.size();
	}
	EXPECT_GT( cleared, 200u );
	EXPECT_GT( uncovered, 2000u );
	EXPECT_GT( kept, 1000u );
}

/// Points in one direction and all around.
TEST( CloudRays, PointsClearWithoutARay )
{
	SeededRng rng( 20261203 );
	std::size_t cleared = 0;
	for ( int round = 0; round < 12; ++round )
	{
		const double resolution = rng.uniform( 0.03, 0.08 );
		lw_cloud_def def = cloudOf( resolution, 0.8 );
		def.unseen_blocked = round % 2 == 1;
		const CloudPtr cloud = makeCloud( def );
		std::vector<Point> before, after;
		for ( int i = 0; i < 800; ++i )
		{
			before.push_back( randomPoint( rng, 0.8 ) );
		}
		hit( cloud.get(), 1, before );
		const std::set<Voxel> had = voxelsOf( cloud.get() );
		const Point sensor = randomPoint( rng, 0.5 );
		const bool around = round % 3 == 0;
		for ( int i = 0; i < 3000; ++i )
		{
			double d[3], length = 0;
			for ( double& x : d )
			{
				x = around ? rng.normal() : rng.uniform( -0.4, 0.4 );
			}
			d[0] += around ? 0 : 1;
			length = std::sqrt( d[0] * d[0] + d[1] * d[1] + d[2] * d[2] );
			const double range = rng.integer( 0, 9 ) == 0 ? rng.uniform( 0.2, 1 ) : 1.4;
			after.push_back( { sensor[0] + d[0] / length * range, sensor[1] + d[1] / length * range,
			    sensor[2] + d[2] / length * range } );
		}
		const PointFrame frame( 2, after, sensor );
		const lw_cloud_report report = insert( cloud.get(), frame.frame );
		std::vector<Ray> rays;
		for ( const Point& p : after )
		{
			rays.push_back( { { sensor[0], sensor[1], sensor[2] }, { p[0], p[1], p[2] } } );
		}
		const std::set<Voxel> gone = without( had, voxelsOf( cloud.get() ) );
		// the picture looks along a direction that the test does not know: behind is along the ray, and the margin left out
		const auto along = []( const Ray& ray )
		{
			Vector f;
			Real length = 0;
			for ( std::size_t k = 0; k < 3; ++k )
			{
				f[k] = ray.to[k] - ray.from[k];
				length += f[k] * f[k];
			}
			for ( Real& x : f )
			{
				x /= std::sqrt( length );
			}
			return f;
		};
		expectPassed( gone, rays, resolution, -0.6 * resolution, along );
		expectPassed( without( voxelsOf( cloud.get(), LW_VOXEL_FREE ), gone ), rays, resolution, -0.6 * resolution, along );
		EXPECT_EQ( gone.size(), report.cleared );
		cleared += gone.size();
	}
	EXPECT_GT( cleared, 100u );
}

/// In front of a wall all is cleared in the middle of the picture, but nothing near the wall.
TEST( CloudRays, FreeSpaceStaysOccupied )
{
	SeededRng rng( 20261204 );
	for ( const bool as_points : { false, true } )
	{
		lw_cloud_def def = cloudOf( 0.02, 1 );
		def.unseen_blocked = true;
		const CloudPtr cloud = makeCloud( def );
		std::vector<Point> before;
		for ( int i = 0; i < 400; ++i )
		{
			before.push_back( { rng.uniform( -0.3, 0.6 ), rng.uniform( -0.2, 0.2 ), rng.uniform( -0.2, 0.2 ) } );
		}
		hit( cloud.get(), 1, before );
		DepthFrame camera( 2, lookAt( { -0.9, 0, 0 }, { 1, 0, 0 } ), 320, 240, 250 );
		camera.fill( 1.6 );
		std::vector<Point> wall;
		for ( const Ray& ray : raysOf( camera ) )
		{
			wall.push_back( inDouble( ray.to ) );
		}
		const PointFrame points( 2, wall, { -0.9, 0, 0 } );
		const lw_cloud_report report = insert( cloud.get(), as_points ? points.frame : camera.frame );
		EXPECT_GE( report.cleared, 380u );
		for ( const Point& p : before )
		{
			EXPECT_EQ( stateAt( cloud.get(), p ), LW_VOXEL_FREE ) << p[0] << " " << p[1] << " " << p[2];
		}
		EXPECT_EQ( stateAt( cloud.get(), { 0.69, 0, 0 } ), LW_VOXEL_UNSEEN ) << "nearer to the wall than the margin";
		EXPECT_EQ( stateAt( cloud.get(), { 0.8, 0, 0 } ), LW_VOXEL_UNSEEN ) << "behind the wall";
		EXPECT_EQ( stateAt( cloud.get(), { -0.5, 0.5, 0 } ), LW_VOXEL_UNSEEN ) << "beside the picture";
	}
}

TEST( CloudRays, ALaterHitOfAnotherSensorIsCleared )
{
	const CloudPtr cloud = makeCloud( cloudOf( 0.05, 2 ) );
	const Point early = { 0.525, 0.025, 0.025 }, late = { 0.525, 0.125, 0.025 };
	hit( cloud.get(), 1, { early } );
	hit( cloud.get(), 3, { late } );
	DepthFrame other( 2, lookAt( { -0.5, 0, 0 }, { 1, 0, 0 } ), 320, 240, 250 );
	other.fill( 2 );
	other.frame.sensor = 1;
	EXPECT_EQ( insert( cloud.get(), other.frame ).cleared, 1u );
	EXPECT_EQ( stateAt( cloud.get(), early ), LW_VOXEL_UNSEEN );
	EXPECT_EQ( stateAt( cloud.get(), late ), LW_VOXEL_OCCUPIED ) << "it was hit at 3 s, the ray is of 2 s";
	other.frame.stamp = 4;
	EXPECT_EQ( insert( cloud.get(), other.frame ).cleared, 1u );
}

/// The same frames with hits between them: a voxel that every frame hits is never cleared by these frames.
TEST( CloudRays, ASurfaceIsClearedByItsOwnFrame )
{
	SeededRng rng( 20261205 );
	const CloudPtr cloud = makeCloud( cloudOf( 0.02, 1.5 ) );
	for ( int k = 1; k <= 20; ++k )
	{
		// a floor at a small angle: neighbouring rays pass over the voxels that others hit
		DepthFrame frame( k, lookAt( { -1, 0, 0.12 }, { 1, 0, -0.05 } ), 160, 120, 120 );
		std::vector<Point> hits;
		for ( std::uint32_t i = 0; i < frame.depths.size(); ++i )
		{
			frame.depths[i] = 1;
			const std::array<long double, 3> p = frame.point( i % 160, i / 160 );
			const double drop = 0.12 - static_cast<double>( p[2] );
			frame.depths[i] = drop > 0.05 ? static_cast<float>( 0.12 / drop + 0.004 * rng.normal() ) : 0.0f;
		}
		insert( cloud.get(), frame.frame );
		for ( const Ray& ray : raysOf( frame ) )
		{
			const Point p = inDouble( ray.to );
			const bool inside = std::abs( p[0] ) < 1.49 && std::abs( p[1] ) < 1.49;
			ASSERT_TRUE( !inside || stateAt( cloud.get(), p ) == LW_VOXEL_OCCUPIED ) << k;
		}
	}
}

TEST( CloudRays, AFarDepthClearsWithoutTrust )
{
	for ( const bool trusted : { false, true } )
	{
		for ( const double depth : { 5.0, static_cast<double>( INFINITY ) } )
		{
			const CloudPtr cloud = makeCloud( cloudOf( 0.05, 2 ) );
			hit( cloud.get(), 1, { { 0.525, 0.025, 0.025 }, { 1.925, 0.025, 0.025 } } );
			DepthFrame frame( 2, lookAt( { -0.5, 0, 0 }, { 1, 0, 0 } ), 320, 240, 250 );
			frame.fill( depth );
			frame.frame.far = 2;
			frame.frame.trust_far = trusted;
			const lw_cloud_report report = insert( cloud.get(), frame.frame );
			EXPECT_EQ( report.inserted, 0u );
			EXPECT_EQ( report.cleared, trusted ? 1u : 0u );
			EXPECT_EQ( stateAt( cloud.get(), { 1.925, 0.025, 0.025 } ), LW_VOXEL_OCCUPIED ) << "it is beyond `far`";
		}
	}
}

TEST( CloudRays, AFarPointClearsWithoutTrust )
{
	for ( const bool trusted : { false, true } )
	{
		const CloudPtr cloud = makeCloud( cloudOf( 0.05, 2 ) );
		hit( cloud.get(), 1, { { 0.525, 0.025, 0.025 }, { 1.925, 0.025, 0.025 } } );
		std::vector<std::array<double, 3>> points;
		for ( int i = 0; i < 10000; ++i )
		{
			points.push_back( { 4.5, 0.01 * ( i % 100 ) - 0.5, 0.01 * static_cast<int>( i / 100 ) - 0.5 } );
		}
		PointFrame frame( 2, points, { -0.5, 0, 0 } );
		frame.frame.far = 2;
		frame.frame.trust_far = trusted;
		const lw_cloud_report report = insert( cloud.get(), frame.frame );
		EXPECT_EQ( report.inserted, 0u );
		EXPECT_EQ( report.out_of_range, 10000u );
		EXPECT_EQ( report.cleared, trusted ? 1u : 0u );
		EXPECT_EQ( stateAt( cloud.get(), { 1.925, 0.025, 0.025 } ), LW_VOXEL_OCCUPIED ) << "it is beyond `far`";
	}
}

TEST( CloudRays, AFartherPointOfAPixelClearsPastANearerOne )
{
	for ( const bool near_comes_first : { false, true } )
	{
		std::vector<std::array<double, 3>> points;
		for ( int i = 0; i < 2 * 1024; ++i )
		{
			const bool near = ( i < 1024 ) == near_comes_first;
			const double depth = near ? 1 : 2; // each ray twice, so two of a pixel
			points.push_back( { depth, depth * 0.01 * ( i % 32 - 16 ), depth * 0.01 * ( i / 32 % 32 - 16 ) } );
		}
		const CloudPtr cloud = makeCloud( cloudOf( 0.05, 2.5 ) );
		hit( cloud.get(), 1, { { 1.525, 0.025, 0.025 }, { 0.525, 0.025, 0.025 } } );
		const PointFrame frame( 2, points );
		insert( cloud.get(), frame.frame );
		EXPECT_EQ( stateAt( cloud.get(), { 1.525, 0.025, 0.025 } ), LW_VOXEL_OCCUPIED );
		EXPECT_NE( stateAt( cloud.get(), { 0.525, 0.025, 0.025 } ), LW_VOXEL_OCCUPIED ) << "it is in front of all";
	}
}

TEST( CloudRays, PointsInRowsAreReadInAnotherWay )
{
	SeededRng rng( 20261203 );
	for ( const auto& [width, height] : { std::pair{ 37u, 29u }, { 16u, 16u }, { 1u, 300u }, { 300u, 2u }, { 8u, 33u } } )
	{
		std::vector<std::array<double, 3>> points;
		for ( std::uint32_t i = 0; i < width * height; ++i )
		{
			points.push_back( { rng.uniform( 0.5, 1.5 ), rng.uniform( -0.5, 0.5 ), rng.uniform( -0.5, 0.5 ) } );
			points.back()[i % 3] += i % 11 == 0 ? std::nan( "" ) : i % 13 == 0 ? 9 : 0;
		}
		const CloudPtr listed = makeCloud( cloudOf( 0.05, 2 ) ), rows = makeCloud( cloudOf( 0.05, 2 ) );
		PointFrame frame( 2, points );
		frame.frame.far = 3;
		hit( listed.get(), 1, { { 0.325, 0.025, 0.025 } } );
		hit( rows.get(), 1, { { 0.325, 0.025, 0.025 } } );
		const lw_cloud_report in_list = insert( listed.get(), frame.frame );
		frame.frame.points.width = width;
		frame.frame.points.height = height;
		frame.frame.points.row_step = width * frame.frame.points.point_step;
		const lw_cloud_report in_rows = insert( rows.get(), frame.frame );
		EXPECT_EQ( 0, std::memcmp( &in_list, &in_rows, sizeof( in_list ) ) ) << width << " x " << height;
		EXPECT_GT( in_rows.not_measured, 0u );
		EXPECT_GT( in_rows.out_of_range, 0u );
		std::vector<double> a( 3 * lw_cloud_voxels( listed.get(), LW_VOXEL_OCCUPIED, nullptr, 0 ) ), b( a.size() );
		EXPECT_EQ( a.size() / 3, lw_cloud_voxels( listed.get(), LW_VOXEL_OCCUPIED, a.data(), a.size() / 3 ) );
		EXPECT_EQ( b.size() / 3, lw_cloud_voxels( rows.get(), LW_VOXEL_OCCUPIED, b.data(), b.size() / 3 ) );
		for ( std::vector<double>* all : { &a, &b } )
		{
			std::sort( all->begin(), all->end() ); // chunks are made in the order of points
		}
		EXPECT_EQ( a, b ) << width << " x " << height;
	}
}
