// SPDX-License-Identifier: BSD-3-Clause
// Convex shapes with rounded edges: a smaller core of the same form, dilated so that it contains the shape. Boxes and cylinders lose a
// layer, others are scaled about a point inside. Derivation: core/docs/near.md.
#include "base/math_inline.h"
#include "leeway/detail.h"
#include "shape/mesh.h"
#include "shape/shape.h"

enum
{
	LEAST_SIDES = 12,
	MOST_SIDES = 256
};

/// The corners and triangles of the core.
typedef struct core
{
	uint32_t vertex_count, triangle_count;
	double vertices[3 * 2 * MOST_SIDES];
	uint32_t triangles[3 * 4 * MOST_SIDES];
	double excess; ///< of the dilated core
} core;

static void add_vertex( core* c, double x, double y, double z )
{
	double* v = c->vertices + 3 * (size_t)c->vertex_count++;
	v[0] = x;
	v[1] = y;
	v[2] = z;
}

static void add_triangle( core* c, uint32_t i, uint32_t j, uint32_t k )
{
	uint32_t* t = c->triangles + 3 * (size_t)c->triangle_count++;
	t[0] = i;
	t[1] = j;
	t[2] = k;
}

static void add_rim( core* c, uint32_t sides, double radius, double z )
{
	for ( uint32_t i = 0; i < sides; ++i )
	{
		const double angle = 2 * 3.14159265358979323846 * i / sides;
		add_vertex( c, radius * cos( angle ), radius * sin( angle ), z );
	}
}

static void add_fan( core* c, uint32_t first, uint32_t sides )
{
	for ( uint32_t i = 1; i + 1 < sides; ++i )
	{
		add_triangle( c, first, first + i, first + i + 1 );
	}
}

/// Sides of a polygon in a circle that leave at most an eighth of the rounding. @param out_sag metres that they leave
static uint32_t sides_of( double circle, double radius, double* out_sag )
{
	const double wanted = ceil( 6.3 * sqrt( circle / radius ) );
	const uint32_t sides = (uint32_t)lwi_clamp( wanted, LEAST_SIDES, MOST_SIDES );
	*out_sag = circle * ( 1 - cos( 3.14159265358979323846 / sides ) ) * ( 1 + 1e-9 );
	return sides;
}

/// A box without a layer: its corners are sqrt( 3 ) layers from the core's.
static bool box_core( const lw_shape* shape, double radius, core* c )
{
	static const uint8_t faces[12][3] = { { 0, 2, 1 }, { 1, 2, 3 }, { 4, 5, 6 }, { 5, 7, 6 }, { 0, 1, 4 }, { 1, 5, 4 },
		{ 2, 6, 3 }, { 3, 6, 7 }, { 0, 4, 2 }, { 2, 4, 6 }, { 1, 3, 5 }, { 3, 7, 5 } };
	const double layer = radius / sqrt( 3 ) * ( 1 - 1e-9 ), *size = shape->dimensions;
	for ( unsigned i = 0; i < 8; ++i )
	{
		double at[3];
		for ( unsigned k = 0; k < 3; ++k )
		{
			at[k] = ( i >> k & 1u ? 1 : -1 ) * ( 0.5 * size[k] - layer );
		}
		add_vertex( c, at[0], at[1], at[2] );
	}
	for ( int i = 0; i < 12; ++i )
	{
		add_triangle( c, faces[i][0], faces[i][1], faces[i][2] );
	}
	c->excess = radius - layer;
	return 0.5 * fmin( size[0], fmin( size[1], size[2] ) ) > layer;
}

/// A prism in the cylinder without a layer. A point of the rim is at most layer + sag from it across the axis, and a layer along it.
static bool cylinder_core( const lw_shape* shape, double radius, core* c )
{
	double sag;
	const double circle = shape->dimensions[0], half = 0.5 * shape->dimensions[1];
	const uint32_t sides = sides_of( circle, radius, &sag );
	const double layer = 0.5 * ( sqrt( fmax( 0, 2 * radius * radius - sag * sag ) ) - sag ) * ( 1 - 1e-9 );
	if ( !( sag < 0.5 * radius && circle > layer && half > layer ) )
	{
		return false;
	}
	add_rim( c, sides, circle - layer, layer - half );
	add_rim( c, sides, circle - layer, half - layer );
	add_fan( c, 0, sides );
	add_fan( c, sides, sides );
	for ( uint32_t i = 0; i < sides; ++i )
	{
		const uint32_t next = ( i + 1 ) % sides;
		add_triangle( c, i, next, sides + next );
		add_triangle( c, i, sides + next, sides + i );
	}
	c->excess = radius - layer;
	return true;
}

/// A pyramid in the cone. It is scaled by the caller.
static bool cone_core( const lw_shape* shape, double radius, core* c, double* sag )
{
	const double half = 0.5 * shape->dimensions[1];
	const uint32_t sides = sides_of( shape->dimensions[0], radius, sag );
	add_rim( c, sides, shape->dimensions[0], -half );
	add_vertex( c, 0, 0, half );
	add_fan( c, 0, sides );
	for ( uint32_t i = 0; i < sides; ++i )
	{
		add_triangle( c, i, ( i + 1 ) % sides, sides );
	}
	return *sag < 0.5 * radius;
}

/// Scales points about their mean, so that none moves by more than `move`. False if that is too far.
static bool scale( double* vertices, uint32_t count, double move )
{
	lw_vec3 sum = { 0, 0, 0 };
	const lw_vec3 first = lwi_load( vertices );
	double reach = 0;
	for ( uint32_t i = 0; i < count; ++i )
	{
		sum = lwi_add( sum, lwi_sub( lwi_load( vertices + 3 * (size_t)i ), first ) );
	}
	const lw_vec3 middle = lwi_add_scaled( first, 1.0 / count, sum );
	for ( uint32_t i = 0; i < count; ++i )
	{
		reach = fmax( reach, lwi_distance( lwi_load( vertices + 3 * (size_t)i ), middle ) );
	}
	const double factor = 1 - move / reach * ( 1 - 1e-9 );
	for ( uint32_t i = 0; i < count; ++i )
	{
		const lw_vec3 p = lwi_add_scaled( middle, factor, lwi_sub( lwi_load( vertices + 3 * (size_t)i ), middle ) );
		vertices[3 * (size_t)i] = p.x;
		vertices[3 * (size_t)i + 1] = p.y;
		vertices[3 * (size_t)i + 2] = p.z;
	}
	return factor > 0.01;
}

static lw_status has_no_room( double radius, lw_diag* diag )
{
	return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX,
		"the shape has no room for edges of a radius of %g m; give another radius", radius );
}

static lw_status make( const lw_shape* shape, core* c, double radius, const lw_allocator* memory, lw_diag* diag,
	lw_shape** out )
{
	lw_mesh_def def = lw_mesh_def_default();
	def.vertices = c->vertices;
	def.vertex_count = c->vertex_count;
	def.indices = c->triangles;
	def.triangle_count = c->triangle_count;
	const bool is_mesh = shape->type == LW_SHAPE_MESH;
	const size_t bytes = 3 * (size_t)shape->vertex_count * sizeof( double );
	double* scaled = NULL;
	if ( is_mesh )
	{
		scaled = lwi_alloc( memory, bytes );
		if ( scaled == NULL )
		{
			return lwi_out_of_memory( diag, "a rounded shape" );
		}
		for ( size_t i = 0; i < 3 * (size_t)shape->vertex_count; ++i )
		{
			scaled[i] = shape->vertices[i];
		}
		def.vertices = scaled;
		def.vertex_count = shape->vertex_count;
		def.indices = shape->indices;
		def.triangle_count = shape->item_count;
		c->excess = shape->closed ? radius : 2 * radius; // the surface of the core is inside of the mesh's
	}
	def.solid = shape->closed || !is_mesh;
	const lw_status status = is_mesh && !scale( scaled, shape->vertex_count, radius )
								 ? has_no_room( radius, diag )
								 : lwi_mesh_shape( &def, radius, memory, diag, out );
	if ( status == LW_OK )
	{
		( *out )->excess = c->excess * ( 1 + 16 * LWI_U64 );
		( *out )->original_count = def.triangle_count;
	}
	lwi_free( memory, scaled, bytes );
	return status;
}

lw_status lw_shape_create_rounded( const lw_shape* shape, double radius, const lw_allocator* allocator, lw_diag* diag,
	lw_shape** out_shape )
{
	if ( out_shape == NULL || shape == NULL )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, "%s is NULL",
			shape == NULL ? "shape" : "out_shape" );
	}
	*out_shape = NULL;
	if ( !( radius > 0 ) || !isfinite( radius ) )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, "radius is %g; give metres above 0", radius );
	}
	lw_status status = LW_OK;
	shape = lwi_shape_made( shape, &status, diag );
	if ( shape == NULL )
	{
		return status;
	}
	if ( shape->type == LW_SHAPE_SPHERE || shape->type == LW_SHAPE_CAPSULE )
	{
		*out_shape = lw_shape_retain( shape );
		return LW_OK;
	}
	core c = { .vertex_count = 0 };
	double sag = 0;
	const bool convex = shape->family == LWI_CONVEX || ( shape->convex != NULL && shape->radius == 0 );
	if ( !convex )
	{
		return lwi_fail( diag, LW_ERROR_UNSUPPORTED, LW_INVALID_INDEX,
			"only boxes, cylinders, cones and convex meshes can be rounded; give a convex hull or pieces" );
	}
	const bool has_room = shape->type == LW_SHAPE_BOX        ? box_core( shape, radius, &c )
						  : shape->type == LW_SHAPE_CYLINDER ? cylinder_core( shape, radius, &c )
						  : shape->type == LW_SHAPE_CONE     ? cone_core( shape, radius, &c, &sag )
															 : true;
	if ( !has_room || ( shape->type == LW_SHAPE_CONE && !scale( c.vertices, c.vertex_count, radius - sag ) ) )
	{
		return has_no_room( radius, diag );
	}
	c.excess = shape->type == LW_SHAPE_CONE ? radius : c.excess;
	const lw_allocator memory = lwi_allocator_or_default( allocator );
	return make( shape, &c, radius, &memory, diag, out_shape );
}
