// SPDX-License-Identifier: BSD-3-Clause
// Live clouds: layouts of ROS messages, octomaps in and out.
#include "leeway/io/cloud.hpp"

#include "cloud/octomap_reader.hpp"
#include "leeway/parallel.hpp"

#include <octomap/OcTree.h>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <thread>

namespace leeway::io
{

namespace
{

bool isBigEndian()
{
	const std::uint16_t one = 1;
	return *reinterpret_cast<const unsigned char*>( &one ) == 0;
}

[[noreturn]] void refuse(
    const std::string& message, const std::string& element, const std::string& problem, const std::string& remedy )
{
	throw Error( message, element, problem, remedy );
}

/// All rows but the last have their whole step. @param used bytes of the last one
void requireBytes(
    const std::string& message, std::size_t size, std::uint64_t height, std::uint64_t step, std::uint64_t used )
{
	const std::uint64_t needed = height == 0 ? 0 : ( height - 1 ) * step + used;
	if ( step < used || size < needed )
	{
		refuse( message, "data",
		    fmt::format( "has {} bytes; {} rows of {} bytes, {} of them used, need {}", size, height, step, used, needed ),
		    "correct the sizes and steps" );
	}
}

} // namespace

lw_cloud_depth depthOf( const ImageMessage& image, const std::array<double, 9>& k )
{
	const bool is_float = image.encoding == "32FC1";
	if ( !is_float && image.encoding != "16UC1" && image.encoding != "mono16" )
	{
		refuse( "image", "encoding", fmt::format( "\"{}\" holds no depths", image.encoding ), "use 16UC1 or 32FC1" );
	}
	requireBytes( "image", image.size, image.height, image.step, image.width * std::uint64_t{ is_float ? 4u : 2u } );
	lw_cloud_depth depth = {};
	depth.data = image.data;
	depth.width = image.width;
	depth.height = image.height;
	depth.row_step = image.step;
	depth.is_float = is_float;
	depth.is_swapped = image.is_bigendian != isBigEndian();
	depth.scale = is_float ? 1 : 0.001;
	depth.fx = k[0];
	depth.cx = k[2];
	depth.fy = k[4];
	depth.cy = k[5];
	return depth;
}

lw_cloud_points pointsOf( const PointCloudMessage& cloud )
{
	constexpr std::uint8_t float32 = 7, float64 = 8;
	lw_cloud_points points = {};
	std::uint8_t type = 0;
	for ( std::size_t axis = 0; axis < 3; ++axis )
	{
		const std::string name( 1, "xyz"[axis] );
		const auto field = std::find_if(
		    cloud.fields.begin(), cloud.fields.end(), [&]( const PointFieldMessage& f ) { return f.name == name; } );
		if ( field == cloud.fields.end() )
		{
			refuse( "point cloud", "fields", "has no field " + name, "give x, y and z" );
		}
		type = axis == 0 ? field->datatype : type;
		if ( field->datatype != type || ( type != float32 && type != float64 ) )
		{
			refuse( "point cloud", "field " + name, fmt::format( "is of type {}", field->datatype ),
			    "give x, y and z as FLOAT32 (7), or all as FLOAT64 (8)" );
		}
		if ( std::uint64_t{ field->offset } + ( type == float64 ? 8 : 4 ) > cloud.point_step )
		{
			refuse( "point cloud", "field " + name,
			    fmt::format( "begins at byte {} of {}", field->offset, cloud.point_step ),
			    "correct the offset or point_step" );
		}
		points.offset[axis] = field->offset;
	}
	requireBytes( "point cloud", cloud.size, cloud.height, cloud.row_step, cloud.width * std::uint64_t{ cloud.point_step } );
	points.data = cloud.data;
	points.width = cloud.width;
	points.height = cloud.height;
	points.point_step = cloud.point_step;
	points.row_step = cloud.row_step;
	points.is_double = type == float64;
	points.is_swapped = cloud.is_bigendian != isBigEndian();
	return points;
}

Cloud::Cloud( const lw_cloud_def& def, unsigned threads )
    : m_threads( threads > 0 ? threads : std::max( 1u, std::thread::hardware_concurrency() ) )
{
	lw_diag diag{};
	lw_cloud_def mine = def;
	if ( def.parallel == nullptr && m_threads > 1 )
	{
		mine.parallel = runTasks;
		mine.parallel_user = &m_threads;
	}
	require( lw_cloud_create( &mine, nullptr, &diag, &m_cloud ), diag );
}

lw_cloud_report Cloud::insert( const lw_cloud_frame& frame )
{
	lw_diag diag{};
	lw_cloud_report report{};
	require( lw_cloud_insert( m_cloud, &frame, &diag, &report ), diag );
	return report;
}

Scene Cloud::scene( const lw_scene* base, const std::string& name )
{
	lw_diag diag{};
	lw_scene* made = nullptr;
	require( lw_cloud_scene( m_cloud, base, name.c_str(), &diag, &made ), diag );
	return Scene::adopt( made );
}

void Cloud::readOctomap( const std::string& file )
{
	detail::OctomapUse use;
	use.list_free = true;
	const detail::OctomapBoxes map = detail::readOctomapFile( file, use );
	const auto set = [&]( const std::vector<double>& boxes, lw_cloud_voxel state )
	{
		for ( std::size_t i = 0; i + 6 <= boxes.size(); i += 6 )
		{
			lw_diag diag{};
			require( lw_cloud_set_box( m_cloud, &boxes[i], &boxes[i + 3], state, &diag ), diag );
		}
	};
	set( map.free, LW_VOXEL_FREE );
	set( map.boxes, LW_VOXEL_OCCUPIED );
}

void Cloud::writeOctomap( const std::string& file ) const
{
	const lw_cloud_info info = lw_cloud_get_info( m_cloud );
	for ( int k = 0; k < 3; ++k )
	{
		if ( !( info.box_min[k] >= -32768 * info.resolution && info.box_max[k] <= 32768 * info.resolution ) )
		{
			refuse( file, "box", fmt::format( "reaches from {} to {} m", info.box_min[k], info.box_max[k] ),
			    fmt::format( "an octomap of this resolution reaches to {} m: use a smaller box", 32768 * info.resolution ) );
		}
	}
	octomap::OcTree tree( info.resolution );
	for ( const lw_cloud_voxel state : { LW_VOXEL_FREE, LW_VOXEL_OCCUPIED } )
	{
		std::vector<double> centers( 3 * lw_cloud_voxels( m_cloud, state, nullptr, 0 ) );
		lw_cloud_voxels( m_cloud, state, centers.data(), centers.size() / 3 );
		for ( std::size_t i = 0; i < centers.size(); i += 3 )
		{
			tree.updateNode( centers[i], centers[i + 1], centers[i + 2], state == LW_VOXEL_OCCUPIED, true );
		}
	}
	tree.updateInnerOccupancy();
	tree.prune();
	std::ofstream out( file, std::ios::binary );
	const bool full = file.size() > 3 && file.compare( file.size() - 3, 3, ".ot" ) == 0;
	if ( !out || !( full ? tree.write( out ) : tree.writeBinary( out ) ) || !out.flush() )
	{
		refuse( file, "", "cannot be written", "check the folder and its permissions" );
	}
}

} // namespace leeway::io
