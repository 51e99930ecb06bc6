// SPDX-License-Identifier: BSD-3-Clause
// Files of geometry: meshes by our reader and by assimp, point clouds, octomaps, height maps.
#include "fuzz.hpp"

#include "cloud/height_map.hpp"
#include "shape/mesh_source.hpp"
#include "cloud/octomap_reader.hpp"
#include "cloud/point_cloud.hpp"

#include <limits>

namespace fuzz
{

namespace
{

namespace detail = leeway::io::detail;

/// As a link's or object's mesh: looked at, made, used.
void readMesh( const char* name, Input input )
{
	const std::string file = put( name, input );
	const leeway::io::LoadOptions options;
	std::vector<leeway::io::Notice> notices;
	reads(
	    [&]
	    {
		    const detail::OpenedMesh mesh =
		        detail::MeshSource::open( options, file, { 1, 1, 0.5 }, "robot.urdf", "link a", notices );
		    expect( lw_shape_complete( mesh.shape.get(), nullptr ) == LW_OK, "a mesh that was opened can be made" );
		    useShape( mesh.shape.get() );
	    } );
}

leeway::Shape adopted( lw_status status, lw_shape* shape )
{
	expect( ( status == LW_OK ) == ( shape != nullptr ), "there is a shape if and only if the status is LW_OK" );
	return leeway::Shape::adopt( shape );
}

void readCloud( const char* name, Input input )
{
	const std::string file = put( name, input );
	reads(
	    [&]
	    {
		    const detail::PointCloud cloud = detail::readPointCloud( file );
		    expect( cloud.points.size() % 3 == 0, "points have three coordinates" );
		    lw_shape* shape = nullptr;
		    const lw_status status = lw_shape_create_points( cloud.points.data(),
		        static_cast<std::uint32_t>( cloud.points.size() / 3 ), 0.01, nullptr, nullptr, nullptr, &shape );
		    if ( const leeway::Shape points = adopted( status, shape ) )
		    {
			    useShape( points.get() );
		    }
	    } );
}

} // namespace

void meshStl( Input input )
{
	readMesh( "input.stl", input );
}

void meshObj( Input input )
{
	readMesh( "input.obj", input );
}

void meshPly( Input input )
{
	readMesh( "input.ply", input );
}

void meshDae( Input input )
{
	readMesh( "input.dae", input );
}

void meshGltf( Input input )
{
	readMesh( input.substr( 0, 4 ) == "glTF" ? "input.glb" : "input.gltf", input );
}

void cloudPcd( Input input )
{
	readCloud( "input.pcd", input );
}

void cloudPly( Input input )
{
	readCloud( "input.ply", input );
}

void octomap( Input input )
{
	const std::string file = put( "input.bt", input );
	for ( bool unknown : { false, true } )
	{
		detail::OctomapUse use;
		use.unknown_is_occupied = unknown;
		reads(
		    [&]
		    {
			    const detail::OctomapBoxes map = detail::readOctomapFile( file, use );
			    const std::size_t count = map.boxes.size() / 6;
			    expect( map.boxes.size() % 6 == 0 && count == map.occupied + map.unknown, "boxes are counted" );
			    if ( count == 0 || count > 20000 ) // of few bytes: time for trees is better spent on other inputs
			    {
				    return;
			    }
			    lw_shape* shape = nullptr;
			    const lw_status status = lw_shape_create_boxes(
			        map.boxes.data(), static_cast<std::uint32_t>( count ), nullptr, nullptr, nullptr, &shape );
			    if ( const leeway::Shape boxes = adopted( status, shape ) )
			    {
				    useShape( boxes.get() );
			    }
		    } );
	}
}

void heightMap( Input input )
{
	const std::string file = put( input.substr( 0, 4 ) == "\x89PNG" ? "input.png" : "input.txt", input );
	reads(
	    [&]
	    {
		    const detail::HeightGrid grid = detail::readHeightGrid( file );
		    expect( grid.values.size() == grid.columns * grid.rows, "a grid has all its values" );
		    if ( grid.values.size() > 20000 )
		    {
			    return;
		    }
		    detail::HeightMapUse use;
		    use.resolution = 0.1;
		    use.unknown_is_ground = input.size() % 2 == 0;
		    const detail::TriangleSoup soup = detail::groundMesh( grid, use, file );
		    lw_mesh_def def = lw_mesh_def_default();
		    def.vertices = soup.vertices.data();
		    def.vertex_count = static_cast<std::uint32_t>( soup.vertices.size() / 3 );
		    def.indices = soup.indices.data();
		    def.triangle_count = static_cast<std::uint32_t>( soup.indices.size() / 3 );
		    def.solid = true;
		    lw_shape* shape = nullptr;
		    lw_diag diag{};
		    const lw_status status = lw_shape_create_mesh( &def, nullptr, &diag, &shape );
		    expect( status == LW_OK || std::string( diag.message ).find( "closed" ) == std::string::npos,
		        "the ground is a closed surface" );
		    if ( const leeway::Shape ground = adopted( status, shape ) )
		    {
			    useShape( ground.get() );
		    }
	    } );
}

} // namespace fuzz
