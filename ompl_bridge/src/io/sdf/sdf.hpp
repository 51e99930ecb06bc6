// SPDX-License-Identifier: BSD-3-Clause
// SDF (Gazebo) as a robot, by libsdformat. These files are built if that library is there (LEEWAY_SDF).
#pragma once

#include "base/io_internal.hpp"
#include "shape/geometry_loader.hpp"
#include "shape/missing_meshes.hpp"

#include <sdf/sdf.hh>

namespace leeway::io::detail
{

/// A robot model of a model or world: its root link is the world, and links have the names of SDF, "model::link" where models are
/// nested. @param file whose root is <sdf> @throws Error
RobotModel readSdf( const std::string& file, const LoadOptions& options );

namespace sdf
{

using ::ignition::math::Pose3d;

lw_transform transformOf( const Pose3d& pose );

/// "joint arm::elbow (line 12)"
std::string placeOf( const std::string& what, const ::sdf::ElementPtr& element );

/// Collision shapes of links.
class Shapes
{
public:
	Shapes( const std::string& file, const LoadOptions& options, LoadReport& report )
	    : m_file( file ), m_options( options ), m_report( report ), m_shapes( options, report ),
	      m_geometry( options, report )
	{
	}
	/// @param name of the link in the robot
	/// @param planes receives its planes: they are no part of a body @throws Error
	std::vector<PlacedShape> read( const ::sdf::Link& link, const std::string& name, std::vector<PlacedShape>& planes );
	/// Notices of all links. @throws Error if nothing is left to check
	void finish();

private:
	/// A shape of a <collision> or <visual>.
	struct Given
	{
		const ::sdf::Geometry* geometry;
		ShapeLoader::Place place;
		lw_transform pose;
	};
	void add( const Given& given, std::vector<PlacedShape>& shapes, std::vector<PlacedShape>& planes );
	Shape shapeOf( const Given& given );
	Shape meshOf( const Given& given );

	const std::string& m_file;
	const LoadOptions& m_options;
	LoadReport& m_report;
	ShapeLoader m_shapes;
	GeometryLoader m_geometry;
	MissingMeshes m_missing;
	std::vector<std::string> m_visual, m_hidden; ///< links whose visual geometry is used, or is all they have
	std::size_t m_count = 0;
};

} // namespace sdf
} // namespace leeway::io::detail
