// SPDX-License-Identifier: BSD-3-Clause
// The triangles of a body: meshes, boxes and prisms around the other primitives, in one frame.
#include "approximate/body_internal.h"

#include "base/math_inline.h"
#include "shape/shape.h"

enum
{
	MIN_SIDES = 16,  ///< of a prism around a cylinder or cone, which stands out by 2.0e-2 of the radius
	MAX_SIDES = 128, ///< 3.0e-4 of the radius
	MAX_RINGS = 64   ///< of the quadrangles of a prism
};

void lwi_body_triangles_free( lwi_body_triangles* s, const lw_allocator* memory )
{
	lwi_array_free( &s->vertices, memory, 3 * sizeof( double ) );
	lwi_array_free( &s->indices, memory, 3 * sizeof( uint32_t ) );
	lwi_array_free( &s->dilation, memory, sizeof( double ) );
	lwi_array_free( &s->solid, memory, sizeof( bool ) );
}

static bool add_vertex( lwi_body_triangles* s, const lw_allocator* memory, const lw_transform* pose, double x, double y,
	double z )
{
	lw_vec3 p = lwi_transform( pose, lwi_v3( x, y, z ) );
	const double v[3] = { p.x, p.y, p.z };
	return lwi_array_push( &s->vertices, memory, sizeof( v ), v );
}

static bool add_triangle( lwi_body_triangles* s, const lw_allocator* memory, uint32_t a, uint32_t b, uint32_t c,
	double dilation, bool solid )
{
	const uint32_t corners[3] = { a, b, c };
	return lwi_array_push( &s->indices, memory, sizeof( corners ), corners ) &&
		   lwi_array_push( &s->dilation, memory, sizeof( dilation ), &dilation ) &&
		   lwi_array_push( &s->solid, memory, sizeof( solid ), &solid );
}

static bool add_box( lwi_body_triangles* s, const lw_allocator* memory, const lw_transform* pose, const double low[3],
	const double high[3] )
{
	// two triangles per face; corner k has bit 0, 1, 2 for the greatest x, y, z
	static const uint32_t faces[6][4] = { { 0, 1, 3, 2 }, { 4, 5, 7, 6 }, { 0, 1, 5, 4 }, { 2, 3, 7, 6 }, { 0, 2, 6, 4 },
		{ 1, 3, 7, 5 } };
	uint32_t first = (uint32_t)s->vertices.count;
	bool ok = true;
	for ( uint32_t k = 0; k < 8; ++k )
	{
		ok = ok &&
			 add_vertex( s, memory, pose, k & 1 ? high[0] : low[0], k & 2 ? high[1] : low[1], k & 4 ? high[2] : low[2] );
	}
	for ( int f = 0; f < 6; ++f )
	{
		ok = ok && add_triangle( s, memory, first + faces[f][0], first + faces[f][1], first + faces[f][2], 0, true ) &&
			 add_triangle( s, memory, first + faces[f][0], first + faces[f][2], first + faces[f][3], 0, true );
	}
	return ok;
}

/// Sides of a prism around a circle that stand out of it by at most `chord`.
static uint32_t sides_for( double radius, double chord )
{
	uint32_t sides = MIN_SIDES;
	while ( sides < MAX_SIDES && radius / cos( LWI_PI / sides ) - radius > chord )
	{
		sides *= 2;
	}
	return sides;
}

/// A regular polygon of `sides` (a power of 2) corners first, first + 1, ...: ears over every second corner, again over
/// the remaining ones. The trees have small triangles at the rim and large ones in the middle; those of a fan would all be
/// long.
static bool add_polygon( lwi_body_triangles* s, const lw_allocator* memory, uint32_t first, uint32_t sides )
{
	bool ok = true;
	for ( uint32_t step = 1; 2 * step < sides; step *= 2 )
	{
		for ( uint32_t i = 0; i < sides && ok; i += 2 * step )
		{
			// the last two ears, over opposite corners, are the two halves of a square
			ok = add_triangle( s, memory, first + i, first + i + step, first + ( i + 2 * step ) % sides, 0, true );
		}
	}
	return ok;
}

static bool add_circle( lwi_body_triangles* s, const lw_allocator* memory, const lw_transform* pose, double radius, double z,
	uint32_t sides )
{
	bool ok = true;
	for ( uint32_t i = 0; i < sides && ok; ++i )
	{
		double angle = 2 * LWI_PI * i / sides;
		ok = add_vertex( s, memory, pose, radius * cos( angle ), radius * sin( angle ), z );
	}
	return ok;
}

/// A prism or pyramid around a cylinder or cone.
static bool add_round( lwi_body_triangles* s, const lw_allocator* memory, const lwi_body_part* part, double chord,
	double* stands_out )
{
	const double* d = part->shape->dimensions;
	const lw_transform* pose = &part->body_from_shape;
	bool cone = part->shape->type == LW_SHAPE_CONE;
	uint32_t sides = sides_for( d[0], chord ), first = (uint32_t)s->vertices.count;
	double radius = d[0] / cos( LWI_PI / sides ) * ( 1 + 64 * LWI_U64 ), half = 0.5 * d[1];
	*stands_out = fmax( *stands_out, radius - d[0] );
	// rings so near that the quadrangles between them are not much longer than wide
	double rings = cone ? 0 : ceil( d[1] * sides / ( 4 * 2 * LWI_PI * radius ) );
	uint32_t ring_count = rings < 1 ? 1 : rings > MAX_RINGS ? MAX_RINGS : (uint32_t)rings;
	bool ok = add_circle( s, memory, pose, radius, -half, sides ) && add_polygon( s, memory, first, sides );
	if ( cone )
	{
		uint32_t tip = first + sides;
		ok = ok && add_vertex( s, memory, pose, 0, 0, half );
		for ( uint32_t i = 0; i < sides && ok; ++i )
		{
			ok = add_triangle( s, memory, tip, first + i, first + ( i + 1 ) % sides, 0, true );
		}
		return ok;
	}
	for ( uint32_t ring = 0; ring < ring_count && ok; ++ring )
	{
		uint32_t low = first + ring * sides, high = low + sides;
		ok = add_circle( s, memory, pose, radius, -half + 2 * half * ( ring + 1 ) / ring_count, sides );
		for ( uint32_t i = 0; i < sides && ok; ++i )
		{
			uint32_t next = ( i + 1 ) % sides;
			ok = add_triangle( s, memory, low + i, low + next, high + i, 0, true ) &&
				 add_triangle( s, memory, low + next, high + next, high + i, 0, true );
		}
	}
	return ok && add_polygon( s, memory, first + ring_count * sides, sides );
}

/// @param part not deferred, and bounded
bool lwi_body_add_part( lwi_body_triangles* s, const lw_allocator* memory, const lwi_body_part* part, double chord,
	double* stands_out )
{
	const lw_shape* shape = part->shape;
	const lw_transform* pose = &part->body_from_shape;
	if ( shape->family == LWI_CONVEX )
	{
		return shape->type == LW_SHAPE_BOX ? add_box( s, memory, pose, shape->box_min, shape->box_max )
										   : add_round( s, memory, part, chord, stands_out );
	}
	bool ok = true;
	for ( size_t i = 0; ok && shape->family == LWI_BOXES && i < shape->item_count; ++i )
	{
		ok = add_box( s, memory, pose, shape->vertices + 6 * i, shape->vertices + 6 * i + 3 );
	}
	if ( shape->family == LWI_BOXES )
	{
		return ok;
	}
	uint32_t first = (uint32_t)s->vertices.count;
	for ( size_t i = 0; ok && i < shape->vertex_count; ++i )
	{
		const double* v = shape->vertices + 3 * i;
		ok = add_vertex( s, memory, pose, v[0], v[1], v[2] );
	}
	for ( uint32_t i = 0; ok && i < shape->item_count; ++i )
	{
		const uint32_t ball[3] = { i, i, i };
		const uint32_t* t = shape->indices != NULL ? shape->indices + 3 * (size_t)i : ball;
		ok = add_triangle( s, memory, first + t[0], first + t[1], first + t[2], lwi_item_radius( shape, i ), shape->closed );
	}
	return ok;
}

/// A mesh shape of some of the triangles. Its vertices are welded where they are equal, and only used ones are kept.
lw_status lwi_body_mesh_of( const double* vertices, size_t vertex_count, const uint32_t* indices, size_t triangle_count,
	const lw_allocator* memory, lw_diag* diag, lw_shape** out )
{
	lw_mesh_def def = lw_mesh_def_default();
	def.vertices = vertices;
	def.vertex_count = (uint32_t)vertex_count;
	def.indices = indices;
	def.triangle_count = (uint32_t)triangle_count;
	return lw_shape_create_mesh( &def, memory, diag, out );
}
