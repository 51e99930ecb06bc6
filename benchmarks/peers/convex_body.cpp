// SPDX-License-Identifier: BSD-3-Clause
#include "peers/convex_body.hpp"

#include <cmath>
#include <map>

namespace
{

/// The hull of points on an ellipsoid: rings of a ball are all its corners.
Mesh ballHull( double scale, std::mt19937_64& random )
{
	Mesh mesh;
	const std::uint32_t rings = 5, sectors = 6;
	const double size[3] = {
	    scale * uniform( random, 0.1, 0.5 ), scale * uniform( random, 0.1, 0.5 ), scale * uniform( random, 0.1, 0.5 ) };
	mesh.vertices = { 0, 0, size[2], 0, 0, -size[2] };
	for ( std::uint32_t i = 1; i < rings; ++i )
	{
		for ( std::uint32_t k = 0; k < sectors; ++k )
		{
			const double along = M_PI * i / rings, around = 2 * M_PI * k / sectors;
			mesh.vertices.insert(
			    mesh.vertices.end(), { size[0] * std::sin( along ) * std::cos( around ),
			                             size[1] * std::sin( along ) * std::sin( around ), size[2] * std::cos( along ) } );
		}
	}
	for ( std::uint32_t k = 0; k < sectors; ++k )
	{
		const std::uint32_t here = 2 + k, next = 2 + ( k + 1 ) % sectors, last = ( rings - 2 ) * sectors;
		mesh.triangles.insert( mesh.triangles.end(), { 0, here, next, 1, next + last, here + last } );
		for ( std::uint32_t i = 0; i + 2 < rings; ++i )
		{
			const std::uint32_t a = here + i * sectors, b = next + i * sectors;
			mesh.triangles.insert( mesh.triangles.end(), { a, a + sectors, b, b, a + sectors, b + sectors } );
		}
	}
	return mesh;
}

} // namespace

ConvexBody convexBody( const std::string& kind, double scale, std::mt19937_64& random )
{
	static const std::map<std::string, lw_shape_type> types = { { "sphere", LW_SHAPE_SPHERE },
	    { "capsule", LW_SHAPE_CAPSULE }, { "box", LW_SHAPE_BOX }, { "cylinder", LW_SHAPE_CYLINDER },
	    { "cone", LW_SHAPE_CONE }, { "hull", LW_SHAPE_MESH } };
	ConvexBody out;
	out.geometry.type = types.at( kind );
	if ( kind == "hull" )
	{
		out.mesh = ballHull( scale, random );
		out.shape = shapeOf( out.mesh, true );
		out.geometry.vertices = out.mesh.vertices.data();
		out.geometry.vertex_count = static_cast<std::uint32_t>( out.mesh.vertices.size() / 3 );
		out.geometry.triangles = out.mesh.triangles.data();
		out.geometry.triangle_count = static_cast<std::uint32_t>( out.mesh.triangles.size() / 3 );
		out.geometry.convex = true;
		return out;
	}
	const bool round = kind != "box";
	out.geometry.dimensions[0] = scale * uniform( random, 0.1, round ? 0.5 : 1 );
	out.geometry.dimensions[1] = kind == "sphere" ? 0 : scale * uniform( random, 0.1, 1 );
	out.geometry.dimensions[2] = kind == "box" ? scale * uniform( random, 0.1, 1 ) : 0;
	lw_shape* shape = nullptr;
	leeway::require(
	    lw_shape_create_primitive( out.geometry.type, out.geometry.dimensions, nullptr, nullptr, &shape ), "a shape" );
	out.shape = leeway::Shape::adopt( shape );
	return out;
}
