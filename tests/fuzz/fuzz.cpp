// SPDX-License-Identifier: BSD-3-Clause
// The table of targets, the folder of inputs, and the queries made of every shape that was read.
#include "fuzz.hpp"
#include "shape/shape.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>

namespace fuzz
{

namespace
{

class Folder
{
public:
	Folder()
	{
		unsetenv( "ROS_PACKAGE_PATH" );
		unsetenv( "AMENT_PREFIX_PATH" );
		std::string pattern = ( std::filesystem::temp_directory_path() / "leeway_fuzz_XXXXXX" ).string();
		expect( mkdtemp( pattern.data() ) != nullptr, "a temporary folder can be made" );
		m_path = pattern;
	}
	~Folder()
	{
		std::error_code error;
		std::filesystem::remove_all( m_path, error );
	}
	const std::string& path() const { return m_path; }

private:
	std::string m_path;
};

const std::string& folder()
{
	static const Folder made;
	return made.path();
}

} // namespace

const std::vector<Target>& targets()
{
	constexpr std::size_t text = 4096, binary = 8192;
	static const std::vector<Target> all = {
	    { "mesh_stl", meshStl, text, "mesh_stl" },
	    { "mesh_obj", meshObj, text, "mesh_obj" },
	    { "mesh_ply", meshPly, text, "mesh_ply" },
	    { "mesh_dae", meshDae, text, "mesh_dae" },
	    { "mesh_gltf", meshGltf, text, "mesh_gltf" },
	    { "cloud_pcd", cloudPcd, text, "cloud_pcd" },
	    { "cloud_ply", cloudPly, text, "cloud_ply" },
	    { "octomap", octomap, text, "octomap" },
	    { "height_map", heightMap, text, "height_map" },
	    { "urdf", urdf, text, "urdf" },
	    { "mjcf", mjcf, text, "mjcf" },
	    { "srdf", srdf, text, "srdf" },
	    { "scene", scene, text, "scene" },
	    { "request", request, text, "request" },
	    { "settings", settings, text, "settings" },
	    { "world", world, text, "world" },
	    { "csv", csv, text, "csv" },
	    { "path", path, text, "path" },
	    { "steps", steps, text, "steps" },
	    { "referee_text", refereeText, text, "referee_text" },
	    { "referee_array", refereeArray, text, "referee_array" },
	    { "shape_blob", shapeBlob, binary, "shape_blob" },
	    { "reach_blob", reachBlob, binary, "reach_blob" },
	    { "cache_file", cacheFile, binary, "cache_file" },
	    { "core_calls", coreCalls, text, "core_calls" },
	};
	return all;
}

const Target* findTarget( const std::string& name )
{
	for ( const Target& target : targets() )
	{
		if ( target.name == name )
		{
			return &target;
		}
	}
	return nullptr;
}

void expect( bool holds, const char* promise )
{
	if ( !holds )
	{
		std::fprintf( stderr, "broken promise: %s\n", promise );
		std::abort();
	}
}

std::string pathOf( const std::string& name )
{
	return folder() + "/" + name;
}

std::string put( const std::string& name, Input bytes )
{
	const std::string path = pathOf( name );
	std::ofstream stream( path, std::ios::binary | std::ios::trunc );
	stream.write( bytes.data(), static_cast<std::streamsize>( bytes.size() ) );
	stream.close();
	expect( bool( stream ), "the input can be written to the temporary folder" );
	return path;
}

std::string putOnce( const std::string& name, const std::string& bytes )
{
	static std::set<std::string> there;
	return there.insert( name ).second ? put( name, bytes ) : pathOf( name );
}

void useShape( const lw_shape* shape )
{
	const lw_shape_info info = lw_shape_get_info( shape );
	if ( info.deferred ) // its maker failed, and says so again
	{
		return;
	}
	lw_diag diag{};
	const lw_status valid = lwi_shape_validate( shape, &diag );
	expect( valid == LW_OK, "a shape that was made has a valid tree" );
	const double edges[3] = { 0.5, 0.5, 0.5 };
	lw_shape* box = nullptr;
	lw_query* query = nullptr;
	const lw_query_def def = lw_query_def_default();
	expect( lw_shape_create_primitive( LW_SHAPE_BOX, edges, nullptr, nullptr, &box ) == LW_OK &&
	            lw_query_create( &def, nullptr, nullptr, nullptr, &query ) == LW_OK,
	    "a box and a query can be made" );
	lw_transform away = lw_transform_identity();
	for ( double offset : { 0.0, 3.0, -1e4 } )
	{
		away.t[0] = offset;
		const lw_transform here = lw_transform_identity();
		for ( const lw_shape* other : { static_cast<const lw_shape*>( box ), shape } )
		{
			lw_clearance c = lw_clearance_unknown();
			const lw_status status = lw_shape_distance( shape, &here, other, &away, nullptr, query, &c );
			expect( status != LW_OK || ( c.lower >= 0 && c.lower <= c.upper ), "distances are intervals" );
			expect( status == LW_OK || ( c.lower == 0 && c.upper == INFINITY ), "an error never reads as free space" );
		}
	}
	lw_query_destroy( query );
	lw_shape_release( box );
}

namespace
{

std::string tetrahedronStl()
{
	const float corners[4][3] = { { 0, 0, 0 }, { 0.2f, 0, 0 }, { 0, 0.2f, 0 }, { 0, 0, 0.2f } };
	const int faces[4][3] = { { 0, 1, 2 }, { 0, 1, 3 }, { 0, 2, 3 }, { 1, 2, 3 } };
	std::string bytes( 80, '\0' );
	bytes += std::string( "\4\0\0\0", 4 );
	for ( const int( &face )[3] : faces )
	{
		bytes += std::string( 12, '\0' ); // no normal
		for ( int corner : face )
		{
			bytes.append( reinterpret_cast<const char*>( corners[corner] ), sizeof( corners[corner] ) );
		}
		bytes += std::string( 2, '\0' );
	}
	return bytes;
}

} // namespace

void putMeshes()
{
	putOnce( "tetrahedron.obj", "v 0 0 0\nv 0.2 0 0\nv 0 0.2 0\nv 0 0 0.2\nf 1 2 3\nf 1 2 4\nf 1 3 4\nf 2 3 4\n" );
	putOnce( "tetrahedron.stl", tetrahedronStl() );
}

const char* const robot_urdf =
    "<robot name=\"r\"><link name=\"a\"><collision><origin xyz=\"0 0 -0.5\"/><geometry><box size=\"0.2 0.2 "
    "0.2\"/></geometry>"
    "</collision></link><link name=\"b\"><collision><origin xyz=\"0.3 0 0\"/><geometry><box size=\"0.6 0.1 "
    "0.1\"/></geometry>"
    "</collision></link><link name=\"c\"><collision><geometry><mesh "
    "filename=\"tetrahedron.stl\"/></geometry></collision></link>"
    "<joint name=\"j\" type=\"revolute\"><parent link=\"a\"/><child link=\"b\"/><axis xyz=\"0 0 1\"/>"
    "<limit lower=\"-2\" upper=\"2\" effort=\"1\" velocity=\"1\"/></joint>"
    "<joint name=\"k\" type=\"prismatic\"><parent link=\"b\"/><child link=\"c\"/><origin xyz=\"0.7 0 0\"/><axis xyz=\"1 0 "
    "0\"/>"
    "<limit lower=\"0\" upper=\"0.5\" effort=\"1\" velocity=\"1\"/></joint></robot>";

const char* const robot_srdf = "<robot name=\"r\"><group name=\"g\"><joint name=\"j\"/><joint name=\"k\"/></group>"
                               "<disable_collisions link1=\"a\" link2=\"b\" reason=\"Adjacent\"/></robot>";

const leeway::io::RobotModel& fixedRobot()
{
	putMeshes();
	static const leeway::io::RobotModel model =
	    leeway::io::loadRobot( putOnce( "fixed.urdf", robot_urdf ), putOnce( "fixed.srdf", robot_srdf ) );
	return model;
}

} // namespace fuzz
