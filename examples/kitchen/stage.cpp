// SPDX-License-Identifier: BSD-3-Clause
// The parts of a picture: colours by mesh, solids given triangles, one node per shape; files and the light.
#include "stage.hpp"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <fstream>

namespace kitchen
{

namespace
{

constexpr double crease = 0.7; ///< radians: edges sharper than this are drawn sharp

/// Primitives are solids without triangles: here they get some.
void tessellate( const lw_shape_info& info, std::vector<double>& vertices, std::vector<uint32_t>& triangles )
{
	const double* d = info.dimensions;
	auto ring = [&]( double radius, double z, int n )
	{
		for ( int i = 0; i < n; ++i )
			vertices.insert(
			    vertices.end(), { radius * std::cos( 2 * M_PI * i / n ), radius * std::sin( 2 * M_PI * i / n ), z } );
	};
	const uint32_t n = 48;
	std::vector<std::pair<double, double>> profile; // radius, z
	if ( info.type == LW_SHAPE_BOX )
	{
		for ( int i = 0; i < 8; ++i )
			vertices.insert( vertices.end(),
			    { ( i & 1 ? 0.5 : -0.5 ) * d[0], ( i & 2 ? 0.5 : -0.5 ) * d[1], ( i & 4 ? 0.5 : -0.5 ) * d[2] } );
		triangles = {
		    0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5 };
		return;
	}
	if ( info.type == LW_SHAPE_CYLINDER )
		profile = { { 0, -0.5 * d[1] }, { d[0], -0.5 * d[1] }, { d[0], 0.5 * d[1] }, { 0, 0.5 * d[1] } };
	else if ( info.type == LW_SHAPE_CONE )
		profile = { { 0, -0.5 * d[1] }, { d[0], -0.5 * d[1] }, { 0, 0.5 * d[1] } };
	else // sphere and capsule: two domes
		for ( int i = 0; i <= 24; ++i )
		{
			const double a = M_PI * ( i / 24.0 - 0.5 ), h = info.type == LW_SHAPE_CAPSULE ? 0.5 * d[1] : 0;
			if ( i == 12 && h > 0 )
				profile.emplace_back( d[0], -h );
			profile.emplace_back( d[0] * std::cos( a ), d[0] * std::sin( a ) + ( i < 12 ? -h : h ) );
		}
	for ( const auto& [radius, z] : profile )
		ring( radius, z, static_cast<int>( n ) );
	for ( uint32_t k = 0; k + 1 < profile.size(); ++k )
		for ( uint32_t i = 0; i < n; ++i )
		{
			const uint32_t a = k * n + i, b = k * n + ( i + 1 ) % n;
			triangles.insert( triangles.end(), { a, b, b + n, a, b + n, a + n } );
		}
}

/// @param report in the order of the shapes of each owner
std::map<std::string, std::vector<std::string>> surfaces( const io::LoadReport& report, const Colours& colours )
{
	std::map<std::string, std::vector<std::string>> result;
	std::map<std::string, size_t> primitives;
	for ( const io::LoadedShape& shape : report.shapes )
		result[shape.owner].push_back( shape.file.empty() ? colours.ofPrimitive( shape.owner, primitives[shape.owner]++ )
		                                                  : colours.ofMesh( shape.file ) );
	return result;
}

} // namespace

Colours::Colours( const std::string& file, Gltf& gltf ) : m_gltf( gltf )
{
	define( { "plain", { 0.75, 0.75, 0.77, 1 }, 0.5, 0 } );
	if ( file.empty() )
		return;
	try
	{
		const YAML::Node root = YAML::LoadFile( file );
		for ( const auto& entry : root["materials"] )
		{
			const auto v = entry.second.as<std::vector<double>>();
			define(
			    { entry.first.as<std::string>(), { v.at( 0 ), v.at( 1 ), v.at( 2 ), v.at( 3 ) }, v.at( 4 ), v.at( 5 ) } );
		}
		for ( const auto& entry : root["meshes"] )
			m_meshes[entry.first.as<std::string>()] = entry.second.as<std::string>();
		for ( const auto& entry : root["primitives"] )
			m_primitives[entry.first.as<std::string>()] = entry.second.as<std::vector<std::string>>();
	}
	catch ( const std::exception& error )
	{
		throw io::Error( file, "colours", error.what(), "give the colours.yaml that kitchen_demo writes" );
	}
}

std::string Colours::ofMesh( const std::string& file ) const
{
	for ( const auto& [name, surface] : m_meshes )
		if ( file.size() > name.size() && file.compare( file.size() - name.size() - 1, std::string::npos, "/" + name ) == 0 )
			return surface;
	return "plain";
}

std::string Colours::ofPrimitive( const std::string& owner, size_t index ) const
{
	const auto it = m_primitives.find( owner );
	return it != m_primitives.end() && index < it->second.size() ? it->second[index] : "plain";
}

int Colours::material( const std::string& name, double opacity )
{
	const std::string key = opacity < 1 ? name + " ghost" : name;
	const auto it = m_materials.find( key );
	if ( it != m_materials.end() )
		return it->second;
	const auto known = m_surfaces.find( name );
	Surface surface = known == m_surfaces.end() ? m_surfaces.at( "plain" ) : known->second;
	surface.name = key;
	surface.colour[3] *= opacity;
	return m_materials[key] = m_gltf.addMaterial( surface );
}

int Meshes::of( const lw_shape* shape, int material, bool translucent )
{
	auto geometry = m_geometry.find( shape );
	if ( geometry == m_geometry.end() )
	{
		const lw_shape_info info = lw_shape_get_info( shape );
		std::vector<double> vertices;
		std::vector<uint32_t> triangles;
		ShadedMesh mesh;
		if ( info.type == LW_SHAPE_MESH )
			mesh = shade(
			    lw_shape_vertices( shape ), info.vertex_count, lw_shape_triangles( shape ), info.triangle_count, crease );
		else
		{
			tessellate( info, vertices, triangles );
			mesh = shade( vertices.data(), vertices.size() / 3, triangles.data(), triangles.size() / 3, crease );
		}
		geometry = m_geometry.emplace( shape, m_gltf.addGeometry( mesh ) ).first;
	}
	const auto key = std::make_pair( shape, material );
	const auto mesh = m_meshes.find( key );
	return mesh != m_meshes.end() ? mesh->second
	                              : m_meshes[key] = translucent ? m_gltf.addTranslucentMesh( geometry->second, material )
	                                                            : m_gltf.addMesh( geometry->second, material );
}

Gltf::Vec translation( const lw_transform& t )
{
	return { t.t[0], t.t[1], t.t[2] };
}

Gltf::Quat rotation( const lw_transform& t )
{
	Gltf::Quat q;
	lw_transform_to_quaternion( &t, q.data() );
	return q;
}

Stage::Stage( const io::RobotModel& robot_model, const lw_robot* made, const std::string& colour_file )
    : robot( made ), colours( colour_file, gltf ), meshes( gltf )
{
	const auto robot_surfaces = surfaces( robot_model.report, colours );
	for ( const io::LinkModel& link : robot_model.links )
	{
		std::vector<Painted>& painted = links[lw_robot_find_link( robot, link.name.c_str() )];
		for ( size_t i = 0; i < link.collision.size(); ++i )
			painted.push_back( { &link.collision[i], robot_surfaces.at( link.name ).at( i ) } );
	}
}

void Stage::addScene( const io::SceneModel& scene )
{
	const auto scene_surfaces = surfaces( scene.report, colours );
	const int root = gltf.addNode( "scene", -1, { 0, 0, 0 }, { 0, 0, 0, 1 } );
	for ( const io::SceneObject& object : scene.objects )
		for ( size_t i = 0; i < object.shapes.size(); ++i )
			add( object.name, root, { &object.shapes[i], scene_surfaces.at( object.name ).at( i ) }, 1 );
}

void Stage::add( const std::string& name, int parent, const Painted& painted, double opacity )
{
	const int mesh = meshes.of( painted.shape->shape.get(), colours.material( painted.surface, opacity ), opacity < 1 );
	gltf.addNode( name, parent, translation( painted.shape->pose ), rotation( painted.shape->pose ), mesh );
}

void Stage::addRobot( const std::vector<lw_transform>& poses )
{
	for ( const auto& [link, painted] : links )
	{
		const int node =
		    gltf.addNode( lw_robot_link_name( robot, link ), -1, translation( poses[link] ), rotation( poses[link] ) );
		for ( const Painted& shape : painted )
			add( "shape", node, shape, 1 );
	}
}

void writeFile( const std::string& file, const std::string& bytes )
{
	std::ofstream out( file, std::ios::binary );
	out.write( bytes.data(), static_cast<std::streamsize>( bytes.size() ) );
	out.close();
	if ( !out )
		throw io::Error( file, "file", "cannot be written", "check the folder and its free space" );
}

std::string lightImage()
{
	const int width = 256, height = 128;
	std::string bytes = fmt::format( "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {} +X {}\n", height, width );
	auto put = [&bytes]( double r, double g, double b )
	{
		int exponent = 0;
		const double scale = std::frexp( std::max( { r, g, b, 1e-9 } ), &exponent ) * 256 / std::max( { r, g, b, 1e-9 } );
		for ( double v : { r, g, b } )
			bytes += static_cast<char>( static_cast<unsigned char>( v * scale ) );
		bytes += static_cast<char>( static_cast<unsigned char>( exponent + 128 ) );
	};
	for ( int y = 0; y < height; ++y )
		for ( int x = 0; x < width; ++x )
		{
			const double up = std::cos( M_PI * ( y + 0.5 ) / height ), around = 2 * M_PI * ( x + 0.5 ) / width;
			auto lamp = [&]( double at_up, double at_around, double size, double power )
			{
				const double across =
				    std::remainder( around - at_around, 2 * M_PI ) * std::sqrt( std::max( 0.05, 1 - up * up ) );
				return power * std::exp( -( across * across + ( up - at_up ) * ( up - at_up ) ) / ( size * size ) );
			};
			const double sky = 0.36 + 0.40 * std::max( 0.0, up ), ground = up < 0 ? 0.26 * up : 0;
			const double key = lamp( 0.65, 0.9, 0.45, 4.2 ), fill = lamp( 0.35, 3.6, 0.7, 0.9 );
			put( sky + ground * 0.8 + key * 1.00 + fill * 0.85, sky + ground * 0.9 + key * 0.95 + fill * 0.93,
			    sky + ground + key * 0.86 + fill * 1.05 );
		}
	return bytes;
}

} // namespace kitchen
