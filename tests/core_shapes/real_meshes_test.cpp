// SPDX-License-Identifier: BSD-3-Clause
// Trees of a real robot and kitchen: containment for every fit, and the figures of core/docs/sphere_trees.md.
#include "shape_support.hpp"

#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>

namespace
{

std::vector<std::string> stlFiles()
{
	std::vector<std::string> files;
	for ( const char* folder : { "/armar3/meshes/full", "/kit_kitchen/meshes" } )
	{
		std::error_code error;
		for ( const auto& entry : std::filesystem::directory_iterator( std::string( LEEWAY_DATA_DIR ) + folder, error ) )
		{
			if ( entry.path().extension() == ".stl" )
			{
				files.push_back( entry.path().string() );
			}
		}
	}
	std::sort( files.begin(), files.end() );
	return files;
}

/// Binary STL: 80 bytes of header, a count, per triangle a normal, three corners and two spare bytes.
Soup readStl( const std::string& path )
{
	std::ifstream file( path, std::ios::binary );
	std::uint32_t count = 0;
	file.seekg( 80 );
	file.read( reinterpret_cast<char*>( &count ), 4 );
	Soup soup;
	for ( std::uint32_t i = 0; i < count; ++i )
	{
		char record[50];
		float f[12];
		file.read( record, sizeof( record ) );
		std::memcpy( f, record, sizeof( f ) );
		soup.add( { f[3], f[4], f[5] }, { f[6], f[7], f[8] }, { f[9], f[10], f[11] } );
	}
	EXPECT_TRUE( file.good() ) << path;
	return soup;
}

class RealMeshes : public testing::Test
{
protected:
	void SetUp() override
	{
		files = stlFiles();
		if ( files.empty() )
		{
			const char* ci = std::getenv( "CI" );
			if ( ci != nullptr && std::strcmp( ci, "true" ) == 0 )
			{
				FAIL() << "no meshes under " << LEEWAY_DATA_DIR;
			}
			GTEST_SKIP() << "no meshes under " << LEEWAY_DATA_DIR;
		}
	}

	std::vector<std::string> files;
};

} // namespace

TEST_F( RealMeshes, TreesAreSoundAndFitsAreOrdered )
{
	std::map<std::size_t, std::array<double, 3>> sums; // per level, of each fit
	std::map<std::size_t, std::size_t> counts;
	std::size_t triangles = 0, bytes = 0, lanes = 0, leaves = 0, nodes = 0, children = 0;
	for ( const std::string& file : files )
	{
		SCOPED_TRACE( file );
		Soup soup = readStl( file );
		for ( lw_sphere_fit fit : { LW_FIT_GREEDY, LW_FIT_COMPACT, LW_FIT_MINIMAL } )
		{
			ShapePtr shape = makeMesh( soup, fit );
			TreeStats stats = expectSoundTree( shape.get() );
			for ( std::size_t level = 0; level < stats.radii.size(); ++level )
			{
				for ( double r : stats.radii[level] )
				{
					sums[level][fit - 1] += r;
				}
				counts[level] += fit == LW_FIT_MINIMAL ? stats.radii[level].size() : 0;
			}
			if ( fit == LW_FIT_MINIMAL )
			{
				lw_shape_info info = lw_shape_get_info( shape.get() );
				EXPECT_LT( static_cast<double>( info.bytes ), 250.0 * info.triangle_count + 2000.0 );
				triangles += info.triangle_count;
				bytes += info.bytes;
				lanes += stats.lanes;
				leaves += stats.leaves;
				nodes += stats.nodes;
				children += stats.children;
			}
		}
	}
	std::printf( "%zu triangles, %.1f bytes per triangle, %.2f triangles per leaf, %.2f children per node\n", triangles,
	    static_cast<double>( bytes ) / triangles, static_cast<double>( lanes ) / leaves,
	    static_cast<double>( children ) / nodes );
	for ( const auto& [level, sum] : sums )
	{
		std::printf( "level %zu: %zu spheres, compact / minimal %.4f, greedy / minimal %.4f\n", level, counts[level],
		    sum[1] / sum[2], sum[0] / sum[2] );
		EXPECT_LE( sum[2], sum[1] * ( 1 + 1e-6 ) );
		EXPECT_LE( sum[1], sum[0] );
	}
	EXPECT_GE( static_cast<double>( lanes ) / leaves, 6.0 );
	EXPECT_LT( static_cast<double>( bytes ) / triangles, 120.0 );
}

TEST_F( RealMeshes, TiledTreesAreSound )
{
	std::size_t lanes = 0, triangles = 0;
	for ( const std::string& file : files )
	{
		SCOPED_TRACE( file );
		Soup soup = readStl( file );
		ShapePtr shape = makeMesh( soup, LW_FIT_COMPACT, 8, 0.05 );
		lanes += expectSoundTree( shape.get(), true ).lanes;
		triangles += soup.triangles.size();
	}
	EXPECT_GT( lanes, triangles + 10000 ) << "kitchen fronts are larger than 5 cm";
}
