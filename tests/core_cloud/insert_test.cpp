// SPDX-License-Identifier: BSD-3-Clause
// Hits: all points of a frame are in occupied voxels, whatever their layout; boxes and ages.
#include "cloud_bench.hpp"

#include <cstring>
#include <map>

namespace
{

Voxel voxelOf( const Point& p, double resolution )
{
	Voxel v;
	for ( std::size_t k = 0; k < 3; ++k )
	{
		v[k] = static_cast<int>( std::floor( static_cast<long double>( p[k] ) / static_cast<long double>( resolution ) ) );
	}
	return v;
}

/// Points away from the sides of voxels, where rounding decides.
std::vector<Point> randomPoints( SeededRng& rng, int count, double half, double resolution )
{
	std::vector<Point> points;
	while ( static_cast<int>( points.size() ) < count )
	{
		const Point p = randomPoint( rng, half );
		bool clear = true;
		for ( const double x : p )
		{
			const double cell = x / resolution - std::floor( x / resolution );
			clear = clear && cell > 1e-6 && cell < 1 - 1e-6;
		}
		if ( clear )
		{
			points.push_back( p );
		}
	}
	return points;
}

} // namespace

TEST( CloudHits, APointIsInAnotherVoxel )
{
	SeededRng rng( 20261127 );
	for ( int round = 0; round < 20; ++round )
	{
		const double resolution = rng.decade( -2.5, -0.5 ), half = resolution * rng.uniform( 3, 90 );
		lw_cloud_def def = cloudOf( resolution, half );
		for ( int k = 0; k < 3; ++k )
		{
			def.box_min[k] *= rng.uniform( 0.1, 1 ); // another number of chunks along each axis
			def.box_max[k] *= rng.uniform( 0.1, 1 );
		}
		const CloudPtr cloud = makeCloud( def );
		const lw_cloud_info info = lw_cloud_get_info( cloud.get() );
		const std::vector<Point> points = randomPoints( rng, 1000, 1.1 * half, resolution );
		PointFrame frame( 1, points );
		frame.frame.clears = false;
		const lw_cloud_report report = insert( cloud.get(), frame.frame );
		std::set<Voxel> expected;
		std::size_t outside = 0;
		for ( const Point& p : points )
		{
			bool inside = true;
			for ( std::size_t k = 0; k < 3; ++k )
			{
				inside = inside && p[k] > info.box_min[k] && p[k] < info.box_max[k];
			}
			outside += inside ? 0 : 1;
			if ( inside )
			{
				expected.insert( voxelOf( p, resolution ) );
			}
			EXPECT_EQ( stateAt( cloud.get(), p ), inside ? LW_VOXEL_OCCUPIED : LW_VOXEL_UNSEEN );
		}
		EXPECT_EQ( voxelsOf( cloud.get() ), expected );
		EXPECT_EQ( report.added, expected.size() );
		EXPECT_EQ( report.outside, outside );
		EXPECT_EQ( report.inserted, points.size() - outside );
		EXPECT_EQ( lw_cloud_get_info( cloud.get() ).occupied, expected.size() );
	}
}

/// float and double, rows with gaps, swapped bytes, in the sensor's frame: all the same voxels.
TEST( CloudHits, ALayoutIsReadWrongly )
{
	SeededRng rng( 20261128 );
	const lw_transform pose = lookAt( randomPoint( rng, 0.3 ), randomPoint( rng, 0.3 ) );
	const std::uint32_t width = 13, height = 7;
	for ( int layout = 0; layout < 16; ++layout )
	{
		const bool is_double = layout & 1, swapped = layout & 2, in_world = layout & 4;
		const std::size_t number = is_double ? 8 : 4, step = ( layout & 8 ? 5 : 3 ) * number + 3, row = width * step + 11;
		std::vector<unsigned char> bytes( row * height );
		std::set<Voxel> expected;
		for ( std::uint32_t i = 0; i < width * height; ++i )
		{
			const Point p = randomPoint( rng, 0.5 );
			Point world;
			for ( std::size_t k = 0; k < 3; ++k )
			{
				unsigned char raw[8];
				const float single = static_cast<float>( p[k] );
				std::memcpy( raw, is_double ? static_cast<const void*>( &p[k] ) : &single, number );
				for ( std::size_t b = 0; b < number; ++b )
				{
					bytes[i / width * row + i % width * step + ( 2 - k ) * number + b] = raw[swapped ? number - 1 - b : b];
				}
				world[k] = in_world ? ( is_double ? p[k] : static_cast<double>( single ) ) : pose.t[k];
				for ( std::size_t m = 0; m < 3 && !in_world; ++m )
				{
					world[k] += pose.r[k][m] * ( is_double ? p[m] : static_cast<double>( static_cast<float>( p[m] ) ) );
				}
			}
			expected.insert( voxelOf( world, 0.01 ) );
		}
		const CloudPtr cloud = makeCloud( cloudOf( 0.01, 2 ) );
		lw_cloud_frame frame = lw_cloud_frame_default();
		frame.world_from_sensor = pose;
		frame.points = { bytes.data(), width, height, step, row, { 2 * number, number, 0 }, is_double, swapped, in_world };
		frame.clears = false;
		EXPECT_EQ( insert( cloud.get(), frame ).inserted, width * height );
		EXPECT_EQ( voxelsOf( cloud.get() ), expected ) << layout;
	}
}

/// 16UC1 and 32FC1, both byte orders, rows with gaps.
TEST( CloudHits, ADepthImageIsReadWrongly )
{
	const lw_transform pose = lookAt( { 0.1, -0.2, 0.3 }, { 1, 0.5, -0.2 } );
	DepthFrame truth( 1, pose, 31, 17, 40 );
	SeededRng rng( 20261129 );
	std::set<Voxel> expected;
	for ( float& z : truth.depths )
	{
		z = static_cast<float>( 0.001 * rng.integer( 300, 1500 ) );
	}
	for ( std::uint32_t i = 0; i < 31 * 17; ++i )
	{
		const std::array<long double, 3> p = truth.point( i % 31, i / 31 );
		expected.insert(
		    voxelOf( { static_cast<double>( p[0] ), static_cast<double>( p[1] ), static_cast<double>( p[2] ) }, 0.0137 ) );
	}
	for ( int layout = 0; layout < 4; ++layout )
	{
		const bool is_float = layout & 1, swapped = layout & 2;
		const std::size_t size = is_float ? 4 : 2, row = 31 * size + 6;
		std::vector<unsigned char> bytes( row * 17 );
		for ( std::uint32_t i = 0; i < 31 * 17; ++i )
		{
			const std::uint16_t millimetres = static_cast<std::uint16_t>( std::lround( 1000 * truth.depths[i] ) );
			unsigned char raw[4];
			std::memcpy( raw, is_float ? static_cast<const void*>( &truth.depths[i] ) : &millimetres, size );
			for ( std::size_t b = 0; b < size; ++b )
			{
				bytes[i / 31 * row + i % 31 * size + b] = raw[swapped ? size - 1 - b : b];
			}
		}
		const CloudPtr cloud = makeCloud( cloudOf( 0.0137, 3 ) );
		lw_cloud_frame frame = truth.frame;
		frame.depth.data = bytes.data();
		frame.depth.row_step = row;
		frame.depth.is_float = is_float;
		frame.depth.is_swapped = swapped;
		frame.depth.scale = is_float ? 1 : 0.001;
		EXPECT_EQ( insert( cloud.get(), frame ).inserted, 31u * 17 );
		EXPECT_EQ( voxelsOf( cloud.get() ), expected ) << layout;
	}
}

TEST( CloudAge, AVoxelIsForgottenTooEarly )
{
	const CloudPtr cloud = makeCloud( cloudOf( 0.1, 2 ) );
	const Point old = { 0.55, 0.05, 0.05 }, twice = { 0.65, 0.05, 0.05 }, young = { 0.75, 0.05, 0.05 };
	const double begin = 1.7e9; // seconds since 1970
	hit( cloud.get(), begin, { old, twice } );
	hit( cloud.get(), begin + 0.5, { twice } );
	hit( cloud.get(), begin + 1, { young } );
	EXPECT_EQ( lw_cloud_forget_before( cloud.get(), begin ), 0u ) << "not before its own stamp";
	EXPECT_EQ( lw_cloud_forget_before( cloud.get(), begin + 0.4 ), 1u );
	EXPECT_EQ( stateAt( cloud.get(), old ), LW_VOXEL_UNSEEN );
	EXPECT_EQ( stateAt( cloud.get(), twice ), LW_VOXEL_OCCUPIED );
	EXPECT_EQ( lw_cloud_forget_before( cloud.get(), begin + 0.502 ), 1u );
	EXPECT_EQ( stateAt( cloud.get(), young ), LW_VOXEL_OCCUPIED );
	EXPECT_EQ( lw_cloud_get_info( cloud.get() ).occupied, 1u );
}

/// Random hits, against a map of last hits.
TEST( CloudAge, AHitIsLostAmongOthers )
{
	SeededRng rng( 20261130 );
	const CloudPtr cloud = makeCloud( cloudOf( 0.1, 1 ) );
	std::map<Voxel, double> last;
	for ( int frame = 1; frame <= 200; ++frame )
	{
		const std::vector<Point> points = randomPoints( rng, 40, 0.35, 0.1 );
		hit( cloud.get(), 0.1 * frame, points );
		for ( const Point& p : points )
		{
			last[voxelOf( p, 0.1 )] = 0.1 * frame;
		}
		if ( frame % 10 == 0 )
		{
			const double before = 0.1 * frame - rng.uniform( 0.2, 2.5 );
			lw_cloud_forget_before( cloud.get(), before );
			std::set<Voxel> expected;
			for ( auto at = last.begin(); at != last.end(); )
			{
				at = at->second < before - 0.002 ? last.erase( at ) : std::next( at );
			}
			for ( const auto& [voxel, stamp] : last )
			{
				expected.insert( voxel );
			}
			ASSERT_EQ( voxelsOf( cloud.get() ), expected ) << frame;
		}
	}
}

/// Boxes of random states against a plain array, with unseen voxels free or blocked.
TEST( CloudBoxes, AVoxelOfABoxIsForgotten )
{
	SeededRng rng( 20261201 );
	for ( const bool blocked : { false, true } )
	{
		lw_cloud_def def = cloudOf( 0.1, 1.05 );
		def.unseen_blocked = blocked;
		const CloudPtr cloud = makeCloud( def );
		const int low = -11, edge = 22;
		std::vector<int> truth( static_cast<std::size_t>( edge * edge * edge ), LW_VOXEL_UNSEEN );
		for ( int round = 0; round < 60; ++round )
		{
			double from[3], to[3];
			int first[3], end[3];
			const auto state = static_cast<lw_cloud_voxel>( rng.integer( 0, 2 ) );
			for ( int k = 0; k < 3; ++k )
			{
				const bool aligned = rng.integer( 0, 1 ) == 0;
				from[k] = aligned ? 0.1 * rng.integer( -14, 10 ) : rng.uniform( -1.4, 1 );
				to[k] = from[k] + ( aligned ? 0.1 * rng.integer( 1, 20 ) : rng.uniform( 0, 2 ) );
				const double a = from[k] / 0.1, b = to[k] / 0.1, e = 1e-6;
				first[k] = static_cast<int>( state == LW_VOXEL_OCCUPIED ? std::floor( a + e ) : std::ceil( a - e ) );
				end[k] = static_cast<int>( state == LW_VOXEL_OCCUPIED ? std::ceil( b - e ) : std::floor( b + e ) );
			}
			ASSERT_EQ( LW_OK, lw_cloud_set_box( cloud.get(), from, to, state, nullptr ) );
			std::set<Voxel> occupied, free;
			for ( int i = 0; i < edge * edge * edge; ++i )
			{
				const Voxel v = { low + i % edge, low + i / edge % edge, low + i / edge / edge };
				const bool inside = v[0] >= first[0] && v[0] < end[0] && v[1] >= first[1] && v[1] < end[1] &&
				                    v[2] >= first[2] && v[2] < end[2];
				int& is = truth[static_cast<std::size_t>( i )];
				is = inside ? ( state == LW_VOXEL_FREE && !blocked ? LW_VOXEL_UNSEEN : state ) : is;
				( is == LW_VOXEL_OCCUPIED ? occupied : free ).insert( v );
				if ( is == LW_VOXEL_UNSEEN )
				{
					free.erase( v );
				}
			}
			ASSERT_EQ( voxelsOf( cloud.get() ), occupied ) << round;
			ASSERT_EQ( voxelsOf( cloud.get(), LW_VOXEL_FREE ), free ) << round;
			ASSERT_EQ( lw_cloud_get_info( cloud.get() ).occupied, occupied.size() );
		}
		const double everything[2][3] = { { -INFINITY, -INFINITY, -INFINITY }, { INFINITY, INFINITY, INFINITY } };
		EXPECT_EQ( LW_OK, lw_cloud_set_box( cloud.get(), everything[0], everything[1], LW_VOXEL_UNSEEN, nullptr ) );
		EXPECT_EQ( lw_cloud_get_info( cloud.get() ).blocks, 0u ) << "blocks of a cloud without voxels are given back";
	}
}
