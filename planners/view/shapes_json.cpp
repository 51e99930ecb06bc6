// SPDX-License-Identifier: BSD-3-Clause
// Shapes for display: primitives by their dimensions, meshes within a budget of triangles, sets of balls and boxes, sphere trees.
#include "view/content.hpp"
#include "view/display.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace leeway::view
{
namespace
{

constexpr std::size_t most_items = 20000;         // balls or boxes shown of one set
constexpr std::uint32_t most_level_spheres = 512; // of a level that is shown
constexpr std::uint32_t most_levels = 5;

Json meshJson( const DisplayMesh& mesh, PageBytes& bytes )
{
	const QuantisedMesh q = quantise( mesh );
	Json json = { { "vertices", q.positions.size() / 3 }, { "triangles", q.triangles.size() / 3 },
	    { "low", { q.low[0], q.low[1], q.low[2] } }, { "size", { q.size[0], q.size[1], q.size[2] } },
	    { "positions", bytes.add( q.positions ) } };
	const bool wide = mesh.vertices.size() > 65535;
	json["wide"] = wide;
	json["indices"] =
	    wide ? bytes.add( q.triangles ) : bytes.add( std::vector<std::uint16_t>( q.triangles.begin(), q.triangles.end() ) );
	return json;
}

/// Items of a set, at most most_items of them.
Json setJson( const lw_shape* shape, const lw_shape_info& info, const std::string& owner, PageContent& content )
{
	const double* v = lw_shape_vertices( shape );
	const double* radii = lw_shape_radii( shape );
	const bool boxes = info.type == LW_SHAPE_BOXES;
	const std::size_t count = boxes ? info.vertex_count / 2 : info.vertex_count, width = boxes ? 6 : 3;
	const std::size_t stride = ( count + most_items - 1 ) / most_items;
	std::vector<float> out;
	for ( std::size_t i = 0; i < count; i += std::max<std::size_t>( stride, 1 ) )
	{
		for ( std::size_t k = 0; k < width; ++k )
		{
			out.push_back( static_cast<float>( v[width * i + k] ) );
		}
		if ( !boxes )
		{
			out.push_back( static_cast<float>( radii != nullptr ? radii[i] : info.dimensions[0] ) );
		}
	}
	const std::size_t shown = out.size() / ( boxes ? 6 : 4 );
	if ( shown < count )
	{
		content.omitted.push_back(
		    fmt::format( "{}: {} of {} {} are shown", owner, shown, count, boxes ? "boxes" : "balls" ) );
	}
	return { { "type", boxes ? "boxes" : "balls" }, { "count", shown }, { "data", content.bytes.add( out ) } };
}

Json levelsJson( const lw_shape* shape, const lw_shape_info& info, PageBytes& bytes )
{
	Json levels = Json::array();
	for ( std::uint32_t level = 0; level <= std::min( info.depth, most_levels ); ++level )
	{
		const std::uint32_t count = lw_shape_level_spheres( shape, level, nullptr, 0 );
		if ( count == 0 || count > most_level_spheres )
		{
			break;
		}
		std::vector<double> spheres( 4 * std::size_t( count ) );
		(void)lw_shape_level_spheres( shape, level, spheres.data(), count );
		levels.push_back(
		    { { "count", count }, { "data", bytes.add( std::vector<float>( spheres.begin(), spheres.end() ) ) } } );
	}
	return levels;
}

Json oneShape( const lw_shape* shape, const std::string& owner, std::size_t budget, PageContent& content )
{
	lw_diag diag = {};
	if ( lw_shape_complete( shape, &diag ) != LW_OK )
	{
		content.omitted.push_back( fmt::format( "{}: not shown: its mesh cannot be read: {}", owner, diag.message ) );
		return { { "type", "none" } };
	}
	const lw_shape_info info = lw_shape_get_info( shape );
	Json json;
	if ( info.type == LW_SHAPE_MESH )
	{
		const DisplayMesh mesh = displayMesh( shape, budget );
		json = { { "type", "mesh" }, { "mesh", meshJson( mesh, content.bytes ) } };
		if ( mesh.deviation > 0 )
		{
			content.omitted.push_back( fmt::format( "{}: {} of {} triangles are shown; vertices moved by at most {:.2g} mm",
			    owner, mesh.triangles.size(), mesh.original, 1000 * mesh.deviation ) );
		}
		if ( info.dimensions[0] > 0 )
		{
			content.omitted.push_back( fmt::format(
			    "{}: the thickness of its coarser mesh, {:.2g} mm, is not drawn", owner, 1000 * info.dimensions[0] ) );
		}
	}
	else if ( info.type == LW_SHAPE_POINTS || info.type == LW_SHAPE_SPHERES || info.type == LW_SHAPE_BOXES )
	{
		json = setJson( shape, info, owner, content );
	}
	else
	{
		if ( !std::isfinite( info.sphere_radius ) )
		{
			content.omitted.push_back(
			    fmt::format( "{}: it has no end; a square of 20 m is drawn", owner ) ); // page/geometry.js
		}
		json = { { "type", lw_shape_type_name( info.type ) },
		    { "dimensions", { info.dimensions[0], info.dimensions[1], info.dimensions[2] } } };
	}
	json["levels"] = levelsJson( shape, info, content.bytes );
	return json;
}

} // namespace

Json shapesJson( const ShapeList& shapes, std::size_t budget, const ProgressFunction& progress, PageContent& content )
{
	Json json = Json::array();
	for ( std::size_t i = 0; i < shapes.shapes().size(); ++i )
	{
		json.push_back( oneShape( shapes.shapes()[i], shapes.owner( i ), budget, content ) );
		report( progress, "meshes of the page", double( i + 1 ) / double( shapes.shapes().size() ) );
	}
	return json;
}

void addOverlays( const PageInput& page, PageContent& content )
{
	const lw_robot* robot = page.problem.robot.get();
	Json hulls = Json::array();
	double dilation = 0;
	const lw_reach* reach = page.problem.reach.reach.get();
	for ( std::uint32_t link = 0; reach != nullptr && link < lw_robot_link_count( lw_reach_robot( reach ) ); ++link )
	{
		const lw_reach_node node = lw_reach_get_node( reach, link );
		const std::uint32_t joint = lw_robot_link_joint( robot, link );
		if ( node.hull_point_count == 0 || joint == LW_INVALID_INDEX )
		{
			continue;
		}
		const DisplayMesh mesh = displayHull( lw_reach_hull_points( reach, link ), node.hull_point_count );
		if ( !mesh.triangles.empty() )
		{
			hulls.push_back( { { "link", link }, { "parent", lw_robot_joint_parent( robot, joint ) },
			    { "mesh", meshJson( mesh, content.bytes ) } } );
			dilation = std::max( dilation, node.dilation );
		}
	}
	content.json["hulls"] = hulls;
	if ( !hulls.empty() )
	{
		content.omitted.push_back(
		    fmt::format( "motion hulls are drawn without their safety distance, at most {:.2g} mm", 1000 * dilation ) );
	}
	Json spheres = Json::array();
	for ( const io::LinkSpheres& link : page.spheres )
	{
		const std::uint32_t index = lw_robot_find_link( robot, link.link.c_str() );
		if ( index != LW_INVALID_INDEX && link.count() > 0 )
		{
			spheres.push_back( { { "link", index }, { "count", link.count() },
			    { "data", content.bytes.add( std::vector<float>( link.spheres.begin(), link.spheres.end() ) ) },
			    { "excess", link.report.excess } } );
		}
	}
	content.json["spheres"] = spheres;
}

} // namespace leeway::view
