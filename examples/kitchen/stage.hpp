// SPDX-License-Identifier: BSD-3-Clause
// Shared by the pictures: a robot and a scene as glTF nodes, their colours, and a light to see them by.
#pragma once

#include "gltf.hpp"

#include "leeway/io/model.hpp"

#include <map>
#include <string>
#include <vector>

namespace kitchen
{

namespace io = leeway::io;

/// Surfaces by mesh file and by primitive, from the table that kitchen_demo writes; a plain grey for names that it lacks.
class Colours
{
public:
	/// @param file empty: all is plain
	/// @throws io::Error
	Colours( const std::string& file, Gltf& gltf );
	std::string ofMesh( const std::string& file ) const;
	std::string ofPrimitive( const std::string& owner, size_t index ) const;
	/// glTF material of a surface, made at first use; with an opacity below 1 its ghost.
	int material( const std::string& name, double opacity = 1 );
	/// A surface of its own, beside those of the table.
	void define( const Surface& surface ) { m_surfaces[surface.name] = surface; }

private:
	Gltf& m_gltf;
	std::map<std::string, Surface> m_surfaces;
	std::map<std::string, std::string> m_meshes;
	std::map<std::string, std::vector<std::string>> m_primitives;
	std::map<std::string, int> m_materials;
};

/// glTF meshes of shapes: vertex data once per shape, one mesh per shape and material.
class Meshes
{
public:
	explicit Meshes( Gltf& gltf ) : m_gltf( gltf ) {}
	int of( const lw_shape* shape, int material, bool translucent = false );

private:
	Gltf& m_gltf;
	std::map<const lw_shape*, int> m_geometry;
	std::map<std::pair<const lw_shape*, int>, int> m_meshes;
};

Gltf::Vec translation( const lw_transform& t );
Gltf::Quat rotation( const lw_transform& t );

/// One owner's shapes with the surface of each.
struct Painted
{
	const io::PlacedShape* shape;
	std::string surface;
};

/// A world to draw: everything that the pictures share. The models must outlive it.
class Stage
{
public:
	Stage( const io::RobotModel& robot_model, const lw_robot* robot, const std::string& colour_file );
	void addScene( const io::SceneModel& scene );
	void add( const std::string& name, int parent, const Painted& painted, double opacity );
	void addRobot( const std::vector<lw_transform>& poses );

	const lw_robot* robot;
	Gltf gltf;
	Colours colours;
	Meshes meshes;
	std::map<uint32_t, std::vector<Painted>> links;
};

/// @throws io::Error
void writeFile( const std::string& file, const std::string& bytes );

/// A softly lit room as a light source: Radiance RGBE, latitude by longitude, bright above and from the window side.
std::string lightImage();

} // namespace kitchen
