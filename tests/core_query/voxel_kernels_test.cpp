// SPDX-License-Identifier: BSD-3-Clause
// Kernels of voxels: every level against arithmetic of its own, voxel by voxel.
#include "kernel_levels.hpp"
#include "seeded_rng.hpp"

#include <array>
#include <cmath>

namespace
{

/// Bits x, y, z in turns.
std::uint32_t interleaved( const std::array<std::uint32_t, 3>& at, std::uint32_t bits )
{
	std::uint32_t out = 0;
	for ( std::uint32_t bit = 0; bit < bits; ++bit )
	{
		for ( std::uint32_t k = 0; k < 3; ++k )
		{
			out |= ( at[k] >> bit & 1u ) << ( 3 * bit + k );
		}
	}
	return out;
}

/// Points about a sensor; some are at it, some have a coordinate that is not finite.
void givePoints( SeededRng& rng, const lwi_point_sensor& sensor, double given[3][LWI_WIDTH] )
{
	for ( std::size_t i = 0; i < LWI_WIDTH; ++i )
	{
		const double kind = rng.uniform( 0, 20 );
		for ( std::size_t k = 0; k < 3; ++k )
		{
			const double at_sensor = sensor.in_world ? sensor.pose.t[k] : 0;
			given[k][i] = kind < 1 ? at_sensor : at_sensor + rng.uniform( -2, 2 );
		}
		given[static_cast<std::size_t>( rng.uniform( 0, 3 ) )][i] += kind > 19 ? HUGE_VAL : kind > 18 ? std::nan( "" ) : 0;
	}
}

/// Voxels of points in range are those that the points have alone.
void expectVoxels(
    const lwi_kernels& table, const lwi_voxel_grid& grid, const double ( *points )[LWI_WIDTH], const lwi_eight_pixels& got )
{
	std::uint32_t place[LWI_WIDTH], voxel[LWI_WIDTH];
	const std::uint32_t lanes = table.point_voxels( &grid, points, place, voxel ) & got.in_range;
	ASSERT_EQ( lanes, got.in_grid & got.in_range ) << "level " << table.level;
	for ( std::size_t i = 0; i < LWI_WIDTH; ++i )
	{
		ASSERT_TRUE( ( lanes >> i & 1u ) == 0 || ( place[i] == got.place[i] && voxel[i] == got.voxel[i] ) );
	}
}

} // namespace

TEST( Kernels, APointIsInAnotherVoxel )
{
	SeededRng rng( 20261128 );
	std::size_t inside = 0;
	for ( int round = 0; round < 3000; ++round )
	{
		lwi_voxel_grid grid = {};
		grid.inverse =
		    round % 2 == 0 ? 1 / rng.decade( -3, 0 ) : std::ldexp( 1.0, round % 7 ); // also exact at the sides of voxels
		std::array<std::uint32_t, 3> chunks;
		for ( std::size_t k = 0; k < 3; ++k )
		{
			chunks[k] = static_cast<std::uint32_t>( rng.uniform( 1, 40 ) );
			grid.first[k] = 32 * std::floor( rng.uniform( -100, 100 ) );
			grid.low[k] = std::floor( rng.uniform( 0, 31 ) );
			grid.high[k] = 32.0 * chunks[k] - std::floor( rng.uniform( 0, 31 ) );
		}
		grid.wide = chunks[0];
		grid.tall = chunks[1];
		double points[3][LWI_WIDTH];
		for ( std::size_t k = 0; k < 3; ++k )
		{
			for ( double& p : points[k] )
			{
				const double kind = rng.uniform( 0, 100 ), any = rng.uniform( grid.low[k] - 2, grid.high[k] + 2 );
				const double voxel = kind < 6 ? grid.high[k] : kind < 9 ? grid.low[k] : kind < 30 ? std::floor( any ) : any;
				p = kind < 1   ? std::nan( "" )
				    : kind < 2 ? HUGE_VAL * ( kind - 1.5 )
				    : kind < 3 ? 1e30
				               : ( voxel + grid.first[k] ) / grid.inverse;
			}
		}
		for ( const lwi_kernels* table : kernelLevels() )
		{
			std::uint32_t place[LWI_WIDTH], voxel[LWI_WIDTH];
			const std::uint32_t lanes = table->point_voxels( &grid, points, place, voxel );
			for ( std::uint32_t i = 0; i < LWI_WIDTH; ++i )
			{
				bool in = true;
				std::array<std::uint32_t, 3> at = {};
				for ( std::size_t k = 0; k < 3; ++k )
				{
					const double x = points[k][i] * grid.inverse - grid.first[k];
					in = in && x >= grid.low[k] && x < grid.high[k];
					at[k] = in ? static_cast<std::uint32_t>( std::floor( x ) ) : 0;
				}
				ASSERT_EQ( in, ( lanes >> i & 1u ) != 0 ) << "level " << table->level;
				inside += in ? 1 : 0;
				if ( in )
				{
					const std::uint32_t chunk = ( at[2] / 32 * chunks[1] + at[1] / 32 ) * chunks[0] + at[0] / 32;
					const std::uint32_t block = interleaved( { at[0] / 8 % 4, at[1] / 8 % 4, at[2] / 8 % 4 }, 2 );
					ASSERT_EQ( place[i], 64 * chunk + block ) << "level " << table->level;
					ASSERT_EQ( voxel[i], interleaved( { at[0] % 8, at[1] % 8, at[2] % 8 }, 3 ) ) << "level " << table->level;
				}
			}
		}
	}
	EXPECT_GT( inside, 10000u );
}

TEST( Kernels, APixelSeesAnotherPointOrItsRayEndsElsewhere )
{
	SeededRng rng( 20261130 );
	std::size_t in_range = 0, beyond = 0, unmeasured = 0;
	for ( int round = 0; round < 3000; ++round )
	{
		lwi_voxel_grid grid = {};
		grid.inverse = 1 / rng.decade( -3, 0 );
		for ( double& high : grid.high )
		{
			high = 64;
		}
		grid.wide = grid.tall = 2;
		lwi_pixel_row row = {};
		std::vector<double> columns( 30 );
		const auto u = static_cast<std::uint32_t>( rng.uniform( 0, 8 ) );
		for ( double& x : columns )
		{
			x = rng.uniform( -0.5, 0.5 );
		}
		for ( std::size_t k = 0; k < 3; ++k )
		{
			row.columns[k] = columns.data() + 5 * k;
			row.row[k] = rng.uniform( -1, 1 );
			row.t[k] = 32 / grid.inverse;
		}
		const bool trusts = round % 2 == 0;
		row.near = round % 3 == 0 ? 0 : 0.5;
		row.far = round % 5 == 0 ? HUGE_VAL : 2;
		row.most = trusts ? HUGE_VAL : 1.7e308;
		row.beyond = trusts && row.far < HUGE_VAL ? row.far : 0;
		std::array<double, LWI_WIDTH> depths;
		for ( double& z : depths )
		{
			const double kind = rng.uniform( 0, 20 );
			z = kind < 1   ? std::nan( "" )
			    : kind < 2 ? HUGE_VAL
			    : kind < 3 ? 0
			    : kind < 4 ? row.near
			    : kind < 5 ? row.far
			               : rng.uniform( -0.5, 3 );
		}
		for ( const lwi_kernels* table : kernelLevels() )
		{
			lwi_eight_pixels got;
			table->pixel_voxels( &grid, &row, u, depths.data(), &got );
			double points[3][LWI_WIDTH];
			for ( std::size_t i = 0; i < LWI_WIDTH; ++i )
			{
				const double z = depths[i];
				const bool measured = z > 0 && z <= row.most, in = measured && z >= row.near && z <= row.far;
				ASSERT_EQ( measured, ( got.measured >> i & 1u ) != 0 ) << "level " << table->level << ", depth " << z;
				ASSERT_EQ( in, ( got.in_range >> i & 1u ) != 0 ) << "level " << table->level << ", depth " << z;
				const double end = in ? z : measured && z > row.far ? row.beyond : 0;
				ASSERT_EQ( static_cast<float>( end ), got.rays[i] ) << "level " << table->level << ", depth " << z;
				for ( std::size_t k = 0; k < 3; ++k )
				{
					points[k][i] = row.t[k] + z * ( row.row[k] + row.columns[k][u + i] );
					ASSERT_TRUE( !in || points[k][i] == got.points[k][i] ) << "level " << table->level;
				}
				++( in ? in_range : measured ? beyond : unmeasured );
			}
			expectVoxels( *table, grid, points, got );
		}
	}
	EXPECT_GT( in_range, 5000u );
	EXPECT_GT( beyond, 1000u );
	EXPECT_GT( unmeasured, 1000u );
}

TEST( Kernels, APointOfASensorIsElsewhereOrHasAnotherRay )
{
	SeededRng rng( 20261201 );
	std::size_t in_range = 0, beyond = 0, unmeasured = 0;
	for ( int round = 0; round < 3000; ++round )
	{
		lwi_voxel_grid grid = {};
		grid.inverse = 1 / rng.decade( -3, 0 );
		for ( std::size_t k = 0; k < 3; ++k )
		{
			grid.first[k] = -32;
			grid.high[k] = 64;
		}
		grid.wide = grid.tall = 2;
		lwi_point_sensor sensor = {};
		for ( std::size_t k = 0; k < 9; ++k )
		{
			sensor.pose.r[k / 3][k % 3] = rng.uniform( -1, 1 ); // any matrix: the sums are what is compared
		}
		for ( double& t : sensor.pose.t )
		{
			t = rng.uniform( -1, 1 ) / grid.inverse;
		}
		sensor.in_world = round % 2 == 0;
		sensor.near_sq = round % 3 == 0 ? 0 : 0.25;
		sensor.far_sq = round % 5 == 0 ? HUGE_VAL : 4;
		double given[3][LWI_WIDTH];
		givePoints( rng, sensor, given );
		for ( const lwi_kernels* table : kernelLevels() )
		{
			lwi_eight_pixels got;
			lwi_eight_rays rays;
			table->sensor_points( &grid, &sensor, given, &got, &rays );
			double points[3][LWI_WIDTH];
			for ( std::size_t i = 0; i < LWI_WIDTH; ++i )
			{
				double ray[3];
				bool measured = true;
				for ( std::size_t k = 0; k < 3; ++k )
				{
					const double* r = sensor.pose.r[k];
					ray[k] = sensor.in_world ? given[k][i] - sensor.pose.t[k]
					                         : r[0] * given[0][i] + r[1] * given[1][i] + r[2] * given[2][i];
					points[k][i] = sensor.in_world ? given[k][i] : ray[k] + sensor.pose.t[k];
					measured = measured && std::isfinite( given[k][i] );
				}
				const double length_sq = ray[0] * ray[0] + ray[1] * ray[1] + ray[2] * ray[2];
				const bool in = measured && length_sq > 0 && length_sq >= sensor.near_sq && length_sq <= sensor.far_sq;
				ASSERT_EQ( measured, ( got.measured >> i & 1u ) != 0 ) << "level " << table->level;
				ASSERT_EQ( in, ( got.in_range >> i & 1u ) != 0 ) << "level " << table->level << ", square " << length_sq;
				ASSERT_TRUE( !measured || rays.length_sq[i] == length_sq ) << "level " << table->level;
				for ( std::size_t k = 0; k < 3; ++k )
				{
					ASSERT_TRUE( !measured || rays.axis[k][i] == ray[k] ) << "level " << table->level;
					ASSERT_TRUE( !measured || got.points[k][i] == points[k][i] ) << "level " << table->level;
				}
				++( in ? in_range : measured ? beyond : unmeasured );
			}
			expectVoxels( *table, grid, points, got );
		}
	}
	EXPECT_GT( in_range, 5000u );
	EXPECT_GT( beyond, 1000u );
	EXPECT_GT( unmeasured, 1000u );
}

TEST( Kernels, ARayHasOtherTangents )
{
	SeededRng rng( 20261202 );
	for ( int round = 0; round < 1000; ++round )
	{
		double r[3][3];
		for ( auto& row : r )
		{
			for ( double& x : row )
			{
				x = rng.uniform( -1, 1 );
			}
		}
		float rays[3][LWI_WIDTH];
		for ( auto& axis : rays )
		{
			for ( float& x : axis )
			{
				x = static_cast<float>( rng.uniform( -3, 3 ) );
			}
		}
		for ( const lwi_kernels* table : kernelLevels() )
		{
			double out[3][LWI_WIDTH];
			table->ray_tangents( r, rays[0], rays[1], rays[2], out );
			for ( std::size_t i = 0; i < LWI_WIDTH; ++i )
			{
				double q[3];
				for ( std::size_t k = 0; k < 3; ++k )
				{
					q[k] = r[k][0] * double( rays[0][i] ) + r[k][1] * double( rays[1][i] ) + r[k][2] * double( rays[2][i] );
				}
				ASSERT_EQ( q[0] / q[2], out[0][i] ) << "level " << table->level;
				ASSERT_EQ( q[1] / q[2], out[1][i] ) << "level " << table->level;
				ASSERT_EQ( q[2], out[2][i] ) << "level " << table->level;
			}
		}
	}
}

TEST( Kernels, ARayIsInAnotherPixel )
{
	SeededRng rng( 20261206 );
	std::size_t inside = 0, outside = 0;
	for ( int round = 0; round < 2000; ++round )
	{
		const auto width = static_cast<std::uint32_t>( rng.uniform( 1, 50 ) ),
		           height = static_cast<std::uint32_t>( rng.uniform( 1, 50 ) );
		const lwi_ray_picture picture = {
		    rng.uniform( 5, 40 ), rng.uniform( 5, 40 ), 0.5 * width, 0.5 * height, width, height };
		double tangents[3][LWI_WIDTH];
		for ( std::size_t i = 0; i < LWI_WIDTH; ++i )
		{
			const double kind = rng.uniform( 0, 20 );
			tangents[0][i] = kind < 1 ? std::nan( "" ) : kind < 3 ? 0.5 * width / picture.fx : rng.uniform( -1, 1 );
			tangents[1][i] = kind > 19 ? HUGE_VAL : kind > 17 ? 0.5 * height / picture.fy : rng.uniform( -1, 1 );
			tangents[2][i] = rng.uniform( -0.5, 3 );
		}
		for ( const lwi_kernels* table : kernelLevels() )
		{
			std::uint32_t pixel[LWI_WIDTH];
			float depth[LWI_WIDTH];
			table->ray_pixels( &picture, tangents, pixel, depth );
			for ( std::size_t i = 0; i < LWI_WIDTH; ++i )
			{
				const double u = tangents[0][i] * picture.fx + picture.cx, v = tangents[1][i] * picture.fy + picture.cy;
				const bool in = tangents[2][i] > 0 && u >= 0 && u < width + 1.0 && v >= 0 && v < height + 1.0;
				ASSERT_EQ( in ? float( tangents[2][i] ) : HUGE_VALF, depth[i] ) << "level " << table->level;
				ASSERT_LT( pixel[i], width * height ) << "level " << table->level;
				if ( in )
				{
					const std::uint32_t column = std::min( static_cast<std::uint32_t>( u ), width - 1 ),
					                    row = std::min( static_cast<std::uint32_t>( v ), height - 1 );
					ASSERT_EQ( row * width + column, pixel[i] ) << "level " << table->level;
				}
				++( in ? inside : outside );
			}
		}
	}
	EXPECT_GT( inside, 2000u );
	EXPECT_GT( outside, 2000u );
}

TEST( Kernels, AVoxelIsBeforeAnotherPixel )
{
	SeededRng rng( 20261129 );
	std::size_t before = 0, others = 0;
	for ( int round = 0; round < 3000; ++round )
	{
		lwi_voxel_view view = {};
		view.width = static_cast<std::uint32_t>( rng.uniform( 1, 40 ) );
		view.height = static_cast<std::uint32_t>( rng.uniform( 1, 40 ) );
		std::vector<float> depths( std::size_t( view.width ) * view.height );
		for ( float& z : depths )
		{
			z = static_cast<float>( rng.uniform( -0.5, 3 ) );
			z = z < 0 ? 0 : z;
		}
		view.least = depths.data();
		view.fx = view.fy = static_cast<float>( rng.uniform( 5, 40 ) );
		view.cx = static_cast<float>( 0.5 * view.width );
		view.cy = static_cast<float>( 0.5 * view.height );
		view.half = static_cast<float>( rng.decade( -3, -1 ) );
		view.nearest = 0.5f * view.half;
		view.margin = static_cast<float>( rng.decade( -3, -1 ) );
		view.slack = static_cast<float>( rng.decade( -6, -1 ) );
		for ( auto& axis : view.voxels )
		{
			for ( float& by : axis )
			{
				by = static_cast<float>( rng.uniform( -0.1, 0.1 ) );
			}
		}
		// behind the sensor, at it, in front of it
		const double z_of_middle = round % 50 == 0 ? 0 : rng.uniform( -0.5, 2 );
		const float middle[3] = { static_cast<float>( rng.uniform( -1, 1 ) ), static_cast<float>( rng.uniform( -1, 1 ) ),
		    static_cast<float>( z_of_middle ) };
		for ( const lwi_kernels* table : kernelLevels() )
		{
			const std::uint32_t lanes = table->voxels_before( &view, middle );
			for ( std::size_t i = 0; i < LWI_WIDTH; ++i )
			{
				const float x = middle[0] + view.voxels[0][i], y = middle[1] + view.voxels[1][i],
				            z = middle[2] + view.voxels[2][i];
				// the kernel's own order of float operations: a pixel's edge is decided by rounding
				const float by_z = 1 / z, u = view.fx * x * by_z + view.cx + 0.5f, v = view.fy * y * by_z + view.cy + 0.5f;
				bool expected =
				    z - view.half > view.nearest && u >= 0 && v >= 0 && u < float( view.width ) && v < float( view.height );
				const float far = z + view.half;
				expected = expected &&
				           depths[std::size_t( v ) * view.width + std::size_t( u )] > far + view.margin + view.slack * far;
				ASSERT_EQ( expected, ( lanes >> i & 1u ) != 0 ) << "level " << table->level;
				++( expected ? before : others );
			}
		}
	}
	EXPECT_GT( before, 1000u );
	EXPECT_GT( others, 1000u );
}
