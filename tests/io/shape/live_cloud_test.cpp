// SPDX-License-Identifier: BSD-3-Clause
// Live clouds with messages of ROS, octomaps and worlds.
#include "files.hpp"
#include "leeway/io/cloud.hpp"
#include "leeway/io/world.hpp"
#include "seeded_rng.hpp"

#include <octomap/OcTree.h>

#include <cstring>
#include <gtest/gtest.h>

using namespace leeway::io;

namespace
{

lw_cloud_def clouds( double resolution, bool blocked )
{
	lw_cloud_def def = lw_cloud_def_default();
	def.resolution = resolution;
	def.unseen_blocked = blocked;
	for ( int k = 0; k < 3; ++k )
	{
		def.box_min[k] = -1;
		def.box_max[k] = 1;
	}
	return def;
}

std::vector<double> voxels( const Cloud& cloud, lw_cloud_voxel state )
{
	std::vector<double> centers( 3 * lw_cloud_voxels( cloud.get(), state, nullptr, 0 ) );
	lw_cloud_voxels( cloud.get(), state, centers.data(), centers.size() / 3 );
	return centers;
}

void hit( Cloud& cloud, double stamp, double x, double y, double z )
{
	const double p[3] = { x, y, z };
	lw_cloud_frame frame = lw_cloud_frame_default();
	frame.stamp = stamp;
	frame.points = { p, 1, 1, sizeof( p ), sizeof( p ), { 0, 8, 16 }, true, false, true };
	frame.clears = false;
	cloud.insert( frame );
}

class LiveClouds : public FileTest
{
};

template <typename Call> std::string problemOf( Call call )
{
	try
	{
		call();
	}
	catch ( const Error& error )
	{
		return error.what();
	}
	return "no error";
}

} // namespace

TEST_F( LiveClouds, AMessageIsReadWrongly )
{
	const std::array<double, 9> k = { 100, 0, 1.5, 0, 100, 0.5, 0, 0, 1 };
	ImageMessage image;
	image.height = 2;
	image.width = 4;
	image.encoding = "16UC1";
	image.is_bigendian = true;
	image.step = 10;
	std::vector<std::uint8_t> bytes( 18 );
	bytes[2] = 0x02; // pixel (1, 0): 0x0258 = 600 mm
	bytes[3] = 0x58;
	image.data = bytes.data();
	image.size = bytes.size();
	Cloud cloud( clouds( 0.01, false ) );
	lw_cloud_frame frame = lw_cloud_frame_default();
	frame.stamp = 1;
	frame.depth = depthOf( image, k );
	const lw_cloud_report report = cloud.insert( frame );
	EXPECT_EQ( report.inserted, 1u );
	EXPECT_EQ( report.not_measured, 7u );
	EXPECT_EQ( lw_cloud_state( cloud.get(), { -0.5 / 100 * 0.6, -0.5 / 100 * 0.6, 0.6001 } ), LW_VOXEL_OCCUPIED );
	image.size = 17;
	EXPECT_NE( problemOf( [&] { depthOf( image, k ); } ).find( "17 bytes" ), std::string::npos );
	image.encoding = "rgb8";
	EXPECT_NE( problemOf( [&] { depthOf( image, k ); } ).find( "32FC1" ), std::string::npos );

	PointCloudMessage points;
	points.height = 1;
	points.width = 2;
	points.fields = { { "intensity", 0, 7, 1 }, { "z", 12, 7, 1 }, { "x", 4, 7, 1 }, { "y", 8, 7, 1 } };
	points.point_step = 16;
	points.row_step = 32;
	const float numbers[8] = { 9, 0.105f, 0.205f, 0.305f, 9, NAN, 0, 0 };
	points.data = reinterpret_cast<const std::uint8_t*>( numbers );
	points.size = sizeof( numbers );
	frame = lw_cloud_frame_default();
	frame.stamp = 2;
	frame.points = pointsOf( points );
	const lw_cloud_report second = cloud.insert( frame );
	EXPECT_EQ( second.inserted, 1u );
	EXPECT_EQ( second.not_measured, 1u );
	EXPECT_EQ( lw_cloud_state( cloud.get(), { 0.105, 0.205, 0.305 } ), LW_VOXEL_OCCUPIED );
	points.fields[1].datatype = 8;
	EXPECT_NE( problemOf( [&] { pointsOf( points ); } ).find( "FLOAT64" ), std::string::npos );
	points.fields[1] = { "w", 12, 7, 1 };
	EXPECT_NE( problemOf( [&] { pointsOf( points ); } ).find( "no field z" ), std::string::npos );
	points.fields[1] = { "z", 13, 7, 1 };
	EXPECT_NE( problemOf( [&] { pointsOf( points ); } ).find( "field z" ), std::string::npos );
}

/// Out and in again: the same voxels; and liboctomap sees the same cells.
TEST_F( LiveClouds, AnOctomapLosesVoxels )
{
	SeededRng rng( 20261220 );
	for ( const char* name : { "map.bt", "map.ot" } )
	{
		Cloud cloud( clouds( 0.05, true ) );
		for ( int i = 0; i < 40; ++i )
		{
			double low[3], high[3];
			for ( int k = 0; k < 3; ++k )
			{
				low[k] = rng.uniform( -1, 1 );
				high[k] = low[k] + rng.uniform( 0, 0.6 );
			}
			const lw_cloud_voxel state = i % 2 == 0 ? LW_VOXEL_FREE : LW_VOXEL_OCCUPIED;
			ASSERT_EQ( LW_OK, lw_cloud_set_box( cloud.get(), low, high, state, nullptr ) );
		}
		const std::string file = path( name );
		cloud.writeOctomap( file );
		Cloud copy( clouds( 0.05, true ) );
		copy.readOctomap( file );
		EXPECT_EQ( voxels( copy, LW_VOXEL_OCCUPIED ), voxels( cloud, LW_VOXEL_OCCUPIED ) );
		EXPECT_EQ( voxels( copy, LW_VOXEL_FREE ), voxels( cloud, LW_VOXEL_FREE ) );
		const std::unique_ptr<octomap::AbstractOcTree> read(
		    std::string( name ) == "map.ot" ? octomap::AbstractOcTree::read( file ) : new octomap::OcTree( file ) );
		const auto* tree = dynamic_cast<const octomap::OcTree*>( read.get() );
		ASSERT_NE( tree, nullptr );
		const std::vector<double> occupied = voxels( cloud, LW_VOXEL_OCCUPIED );
		for ( std::size_t i = 0; i < occupied.size(); i += 3 )
		{
			const octomap::OcTreeNode* node = tree->search( occupied[i], occupied[i + 1], occupied[i + 2] );
			ASSERT_TRUE( node != nullptr && tree->isNodeOccupied( node ) );
		}
	}
	EXPECT_NE( problemOf( [&] { Cloud( clouds( 0.05, true ) ).writeOctomap( path( "none/map.bt" ) ); } ).find( "written" ),
	    std::string::npos );
}

/// A map of larger or smaller cells: occupied space stays so, and nothing is free that the map has not as free.
TEST_F( LiveClouds, AnOctomapOfOtherCellsLosesObstacles )
{
	SeededRng rng( 20261221 );
	for ( const double cell : { 0.03, 0.05, 0.11 } )
	{
		octomap::OcTree tree( cell );
		for ( int i = 0; i < 300; ++i )
		{
			tree.insertRay( octomap::point3d( 0, 0, 0 ),
			    octomap::point3d( static_cast<float>( rng.uniform( -0.9, 0.9 ) ),
			        static_cast<float>( rng.uniform( -0.9, 0.9 ) ), static_cast<float>( rng.uniform( -0.9, 0.9 ) ) ) );
		}
		tree.writeBinary( path( "other.bt" ) );
		Cloud cloud( clouds( 0.05, true ) );
		cloud.readOctomap( path( "other.bt" ) );
		for ( int i = 0; i < 3000; ++i )
		{
			const lw_vec3 p = { rng.uniform( -1, 1 ), rng.uniform( -1, 1 ), rng.uniform( -1, 1 ) };
			const octomap::OcTreeNode* node = tree.search( p.x, p.y, p.z );
			const lw_cloud_voxel state = lw_cloud_state( cloud.get(), p );
			ASSERT_TRUE( node == nullptr || !tree.isNodeOccupied( node ) || state == LW_VOXEL_OCCUPIED );
			ASSERT_TRUE( state != LW_VOXEL_FREE || ( node != nullptr && !tree.isNodeOccupied( node ) ) );
		}
	}
}

/// A world sees a cloud again and again; its allowed contacts and margins stay with the name.
TEST_F( LiveClouds, AWorldKeepsAnOldCloud )
{
	const std::string urdf = write( "ball.urdf", R"(<robot name="ball"><link name="world"/>
<joint name="x" type="prismatic"><parent link="world"/><child link="ball"/><axis xyz="1 0 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
<link name="ball"><collision><geometry><sphere radius="0.1"/></geometry></collision></link></robot>)" );
	const RobotModel robot = loadRobot( urdf, "" );
	World world( robot, {} );
	Cloud cloud( clouds( 0.02, false ) );
	const auto isFree = []( const leeway::Checker& checker )
	{
		const leeway::Query query = leeway::makeQuery( checker.get() );
		const double q = 0;
		lw_state_result result;
		EXPECT_EQ( LW_OK, lw_checker_state( checker.get(), query.get(), &q, LW_CHECK_BOTH, nullptr, false, &result ) );
		return result.verdict == LW_VERDICT_FREE;
	};
	EXPECT_TRUE( isFree( world.see( "cloud", cloud ) ) );
	hit( cloud, 1, 0.11, 0, 0 );
	const leeway::Checker blocked = world.see( "cloud", cloud );
	EXPECT_FALSE( isFree( blocked ) );
	EXPECT_TRUE( isFree( world.allow( "ball", "cloud", true ) ) );
	hit( cloud, 2, 0.5, 0, 0 );
	EXPECT_TRUE( isFree( world.see( "cloud", cloud ) ) ) << "contact is still allowed";
	EXPECT_FALSE( isFree( world.allow( "ball", "cloud", false ) ) );
	lw_cloud_clear( cloud.get() );
	EXPECT_TRUE( isFree( world.see( "cloud", cloud ) ) );
	EXPECT_FALSE( isFree( blocked ) ) << "a snapshot stays as it was";
	EXPECT_THROW( world.move( "cloud", lw_transform_identity() ), Error );
	EXPECT_THROW( world.attach( "cloud", "ball", {} ), Error );
	EXPECT_TRUE( isFree( world.remove( "cloud" ) ) );
	EXPECT_THROW( world.see( "ball", cloud ), Error ) << "a link has this name";
}
