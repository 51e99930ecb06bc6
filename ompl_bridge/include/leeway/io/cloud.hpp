// SPDX-License-Identifier: BSD-3-Clause
// Live clouds (leeway/cloud.h) with the messages of ROS and with octomaps. Needs no ROS: the structs here have the members of its messages.
//
//     leeway::io::Cloud cloud( def );
//     lw_cloud_frame frame = lw_cloud_frame_default();   // sensor, stamp, pose, robot and state
//     frame.depth = leeway::io::depthOf( image, camera_k );
//     cloud.insert( frame );
//     engine->update( world.see( "cloud", cloud ) );
#pragma once

#include "leeway/handles.hpp"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace leeway::io
{

/// sensor_msgs/Image. The data are not copied.
struct ImageMessage
{
	std::uint32_t height = 0, width = 0;
	std::string encoding; ///< 16UC1 or mono16: millimetres; 32FC1: metres (REP 118)
	bool is_bigendian = false;
	std::uint32_t step = 0; ///< bytes of a row
	const std::uint8_t* data = nullptr;
	std::size_t size = 0; ///< bytes
};

/// sensor_msgs/PointField
struct PointFieldMessage
{
	std::string name;
	std::uint32_t offset = 0;  ///< bytes
	std::uint8_t datatype = 7; ///< 7 FLOAT32, 8 FLOAT64
	std::uint32_t count = 1;
};

/// sensor_msgs/PointCloud2. The data are not copied. `is_dense` is not needed: points that are not finite are counted and left out.
struct PointCloudMessage
{
	std::uint32_t height = 0, width = 0;
	std::vector<PointFieldMessage> fields; ///< x, y, z among them
	bool is_bigendian = false;
	std::uint32_t point_step = 0, row_step = 0; ///< bytes
	const std::uint8_t* data = nullptr;
	std::size_t size = 0; ///< bytes
};

/// The image as a frame has it. It must outlive the frame. @param k the matrix of sensor_msgs/CameraInfo, by rows
/// @throws Error (another encoding, too few bytes)
lw_cloud_depth depthOf( const ImageMessage& image, const std::array<double, 9>& k );

/// The points as a frame has them, in the sensor's frame. They must outlive the frame.
/// @throws Error (no x, y or z, of other types than floats or of different ones, too few bytes)
lw_cloud_points pointsOf( const PointCloudMessage& cloud );

/// Owns a cloud. One thread at a time; its scenes are for all.
class Cloud
{
public:
	/// @param threads for the rays of a frame and the shapes of a scene, unless the definition has its own `parallel`: the caller's and those made
	/// for each call, some 0.1 ms each; 0: one per processor. It changes no result @throws CoreError
	explicit Cloud( const lw_cloud_def& def, unsigned threads = 1 );
	~Cloud() { lw_cloud_destroy( m_cloud ); }
	Cloud( const Cloud& ) = delete;
	Cloud& operator=( const Cloud& ) = delete;
	lw_cloud* get() { return m_cloud; }
	const lw_cloud* get() const { return m_cloud; }

	/// @throws CoreError, as lw_cloud_insert(): LW_ERROR_STALE for a frame that is late or whose sensor has jumped
	lw_cloud_report insert( const lw_cloud_frame& frame );
	/// @param base may be null @throws CoreError, as lw_cloud_scene()
	Scene scene( const lw_scene* base, const std::string& name );
	/// Free and occupied cells of an octomap (.bt, .ot) within the box, added to those that are there. Cells of another size: voxels that an
	/// occupied cell meets are occupied, voxels wholly in one free cell are free. @throws Error, CoreError (too many blocks)
	void readOctomap( const std::string& file );
	/// Free and occupied voxels as an octomap of the same resolution: .ot, else .bt. @throws Error (the file, a box beyond 2^15 cells)
	void writeOctomap( const std::string& file ) const;

private:
	lw_cloud* m_cloud = nullptr;
	unsigned m_threads;
};

} // namespace leeway::io
