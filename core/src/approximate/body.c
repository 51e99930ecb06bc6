// SPDX-License-Identifier: BSD-3-Clause
// Builds a body: its triangles, its shells, the grids for rays, its outer surface.
#include "approximate/body_internal.h"

#include "base/math_inline.h"
#include "distance/tri_tri.h"
#include "shape/mesh.h"
#include "shape/shape.h"

enum
{
	MAX_HIDDEN_SPLITS = 8 ///< bisections of a triangle that is partly inside another shell: undecided parts are visible
};

/// By how much prisms may stand out of their cylinders, and the size of the parts that are classified as hidden or visible,
/// both as a share of the grain.
#define CHORD_SHARE 0.01
#define HIDDEN_SHARE 0.25

// --- rays and outer surface ---------------------------------------------------------------------------------------------

static lw_status make_grid( lwi_body* body, int which, lwi_ray_grid* grid )
{
	// any directions will do that are not those of a model's edges
	static const double quaternions[LWI_RAY_GRIDS][4] = { { 0.183, 0.365, 0.548, 0.730 }, { 0.71, -0.13, 0.23, 0.65 },
		{ -0.31, 0.57, 0.11, 0.75 } };
	const lw_shape* mesh = body->closed;
	const lw_allocator* memory = &body->memory;
	lw_transform_from_quaternion( ( double[3] ){ 0, 0, 0 }, quaternions[which], &grid->turn );
	grid->vertices = lwi_alloc( memory, 3 * (size_t)mesh->vertex_count * sizeof( double ) );
	grid->start = lwi_alloc_zero( memory, LWI_RAY_CELLS * LWI_RAY_CELLS + 1, sizeof( uint32_t ) );
	if ( grid->vertices == NULL || grid->start == NULL )
	{
		return LW_ERROR_OUT_OF_MEMORY;
	}
	for ( int k = 0; k < 2; ++k )
	{
		grid->low[k] = INFINITY;
		grid->high[k] = -INFINITY;
	}
	for ( size_t i = 0; i < mesh->vertex_count; ++i )
	{
		lw_vec3 p = lwi_rotate( &grid->turn, lwi_load( mesh->vertices + 3 * i ) );
		memcpy( grid->vertices + 3 * i, ( double[3] ){ p.x, p.y, p.z }, 3 * sizeof( double ) );
		grid->low[0] = fmin( grid->low[0], p.x );
		grid->low[1] = fmin( grid->low[1], p.y );
		grid->high[0] = fmax( grid->high[0], p.x );
		grid->high[1] = fmax( grid->high[1], p.y );
	}
	for ( int k = 0; k < 2; ++k )
	{
		double size = grid->high[k] - grid->low[k];
		grid->inv_cell[k] = size > 0 ? LWI_RAY_CELLS / size : 0;
	}
	return LW_OK;
}

/// Cells of one axis that a triangle meets. The cell of a coordinate grows with it, so no rounding leaves one out.
static void cell_range( const lwi_ray_grid* grid, const uint32_t* index, int axis, uint32_t* first, uint32_t* last )
{
	double low = INFINITY, high = -INFINITY;
	for ( int k = 0; k < 3; ++k )
	{
		double v = grid->vertices[3 * (size_t)index[k] + (size_t)axis];
		low = fmin( low, v );
		high = fmax( high, v );
	}
	*first = lwi_ray_cell( low, grid->low[axis], grid->inv_cell[axis] );
	*last = lwi_ray_cell( high, grid->low[axis], grid->inv_cell[axis] );
}

static lw_status fill_grid( lwi_body* body, lwi_ray_grid* grid )
{
	const lw_shape* mesh = body->closed;
	// counted first, then filled from the back of each cell
	for ( int pass = 0; pass < 2; ++pass )
	{
		for ( uint32_t t = 0; t < mesh->item_count; ++t )
		{
			uint32_t x0, x1, y0, y1;
			cell_range( grid, mesh->indices + 3 * (size_t)t, 0, &x0, &x1 );
			cell_range( grid, mesh->indices + 3 * (size_t)t, 1, &y0, &y1 );
			for ( uint32_t y = y0; y <= y1; ++y )
			{
				for ( uint32_t x = x0; x <= x1; ++x )
				{
					uint32_t* start = &grid->start[y * LWI_RAY_CELLS + x];
					if ( pass == 0 )
					{
						++*start;
					}
					else
					{
						grid->items[--*start] = t;
					}
				}
			}
		}
		if ( pass == 0 )
		{
			for ( size_t i = 0; i < LWI_RAY_CELLS * LWI_RAY_CELLS; ++i )
			{
				grid->start[i + 1] += grid->start[i];
			}
			// after the sum start[i] is the end of cell i, and the last entry the end of all
			grid->item_count = grid->start[LWI_RAY_CELLS * LWI_RAY_CELLS];
			grid->items = lwi_alloc( &body->memory, grid->item_count * sizeof( uint32_t ) );
			if ( grid->items == NULL )
			{
				return LW_ERROR_OUT_OF_MEMORY;
			}
		}
	}
	return LW_OK;
}

/// Output of the search for hidden triangles: the outer surface, as a soup.
typedef struct outer_search
{
	lwi_body* body;
	lwi_array vertices; ///< double[3]
	double finest;      ///< parts smaller than that are not cut
	uint32_t shell;     ///< of the current triangle
	bool any_hidden;    ///< a part of it is hidden
	bool ok;
} outer_search;

static void keep_part( outer_search* s, const lw_vec3 v[3] )
{
	for ( int k = 0; k < 3 && s->ok; ++k )
	{
		s->ok =
			lwi_array_push( &s->vertices, &s->body->memory, 3 * sizeof( double ), ( double[3] ){ v[k].x, v[k].y, v[k].z } );
	}
}

/// Keeps the parts of a triangle that are not proved to lie inside of another shell.
static void keep_visible( outer_search* s, const lw_vec3 v[3], int splits )
{
	lwi_body* body = s->body;
	if ( lwi_body_stopped( body ) )
	{
		keep_part( s, v );
		return;
	}
	lw_vec3 center = lwi_scale( 1.0 / 3, lwi_add( lwi_add( v[0], v[1] ), v[2] ) );
	double radius = fmax( lwi_distance( center, v[0] ), fmax( lwi_distance( center, v[1] ), lwi_distance( center, v[2] ) ) );
	// a hidden part has its centre inside; a part with its centre outside may still have hidden parts, if another shell
	// is near
	bool inside = lwi_body_encloses_by( body, center, s->shell, NULL );
	double reach = radius + 2 * body->slack;
	if ( inside &&
		 lwi_shape_nearest( body->closed, center, reach, true, body->shell, body->inside_shell ).distance == INFINITY )
	{
		s->any_hidden = true;
		return;
	}
	if ( splits == 0 || radius <= s->finest ||
		 !( inside || lwi_shape_is_near_but( body->closed, center, reach, body->shell, s->shell ) ) )
	{
		keep_part( s, v );
		return;
	}
	int l = 0;
	double longest = -1;
	for ( int k = 0; k < 3; ++k )
	{
		double length = lwi_distance( v[k], v[( k + 1 ) % 3] );
		l = length > longest ? k : l;
		longest = fmax( longest, length );
	}
	lw_vec3 middle = lwi_scale( 0.5, lwi_add( v[l], v[( l + 1 ) % 3] ) );
	lw_vec3 first[3] = { v[l], middle, v[( l + 2 ) % 3] }, second[3] = { middle, v[( l + 1 ) % 3], v[( l + 2 ) % 3] };
	keep_visible( s, first, splits - 1 );
	keep_visible( s, second, splits - 1 );
}

static lw_status make_outer( lwi_body* body, double finest, lw_diag* diag )
{
	const lw_shape* mesh = body->closed;
	const lw_allocator* memory = &body->memory;
	outer_search s = { .body = body, .finest = finest, .ok = true };
	for ( uint32_t t = 0; t < mesh->item_count && s.ok; ++t )
	{
		lw_vec3 v[3];
		for ( size_t k = 0; k < 3; ++k )
		{
			v[k] = lwi_load( mesh->vertices + 3 * (size_t)mesh->indices[3 * (size_t)t + k] );
		}
		size_t before = s.vertices.count;
		s.shell = body->shell[t];
		s.any_hidden = false;
		if ( body->shell_count > 1 )
		{
			keep_visible( &s, v, MAX_HIDDEN_SPLITS );
		}
		body->hidden += s.any_hidden ? 1 : 0;
		if ( !s.any_hidden )
		{
			s.vertices.count = before;
			keep_part( &s, v );
		}
	}
	lwi_array indices = { 0 };
	s.ok = s.ok && lwi_array_reserve( &indices, memory, sizeof( uint32_t ), s.vertices.count );
	for ( uint32_t i = 0; s.ok && i < s.vertices.count; ++i )
	{
		( (uint32_t*)indices.data )[indices.count++] = i;
	}
	// some part always stays: the outermost point of all shells is inside of none
	lw_status status = LW_ERROR_OUT_OF_MEMORY;
	if ( s.ok )
	{
		status = lwi_body_mesh_of( s.vertices.data, s.vertices.count, indices.data, indices.count / 3, memory, diag,
			&body->outer );
	}
	lwi_array_free( &indices, memory, sizeof( uint32_t ) );
	lwi_array_free( &s.vertices, memory, 3 * sizeof( double ) );
	return status;
}

// --- the whole -------------------------------------------------------------------------------------------------------

static void set_scale( lwi_body* body )
{
	const lw_shape* mesh = body->surface;
	for ( size_t i = 0; i < 3 * (size_t)mesh->vertex_count; ++i )
	{
		body->extent = fmax( body->extent, fabs( mesh->vertices[i] ) );
	}
	for ( uint32_t t = 0; t < mesh->item_count; ++t )
	{
		body->dilation_max = fmax( body->dilation_max, body->dilation[t] );
		body->any_solid = body->any_solid || body->solid[t];
	}
	// Moving a part into the body's frame rounds each coordinate by 4u of the extent; a certified distance is off by
	// LWI_TRI_TRI_ERROR of it and a point tested may be as far away as the body is large; turning it for rays by 4u more.
	body->slack = 4 * LWI_TRI_TRI_ERROR * ( body->extent + body->dilation_max );
}

static lw_status build( const lwi_body_part* parts, uint32_t part_count, double close_holes, double grain,
	lwi_body_triangles* s, lwi_body* body, lw_diag* diag )
{
	const lw_allocator* memory = &body->memory;
	for ( uint32_t i = 0; i < part_count; ++i )
	{
		lw_status made;
		lwi_body_part part = { lwi_shape_made( parts[i].shape, &made, diag ), parts[i].body_from_shape };
		if ( part.shape == NULL )
		{
			return made;
		}
		if ( part.shape->family == LWI_UNBOUNDED )
		{
			return lwi_fail( diag, LW_ERROR_UNSUPPORTED, i, "shape %u is a half-space or a plane, which no spheres enclose",
				i );
		}
		if ( s->vertices.count + 4 * (size_t)part.shape->vertex_count > UINT32_MAX / 2 || s->indices.count > LWI_MAX_ITEMS )
		{
			return lwi_fail( diag, LW_ERROR_BAD_GEOMETRY, i, "more than %zu triangles in one body; give fewer parts",
				LWI_MAX_ITEMS );
		}
		if ( !lwi_body_add_part( s, memory, &part, CHORD_SHARE * grain, &body->chord ) )
		{
			return LW_ERROR_OUT_OF_MEMORY;
		}
	}
	size_t triangles = s->indices.count;
	body->triangle_count = (uint32_t)triangles;
	body->dilation = lwi_alloc( memory, triangles * sizeof( double ) );
	body->solid = lwi_alloc( memory, triangles * sizeof( bool ) );
	if ( body->dilation == NULL || body->solid == NULL )
	{
		return LW_ERROR_OUT_OF_MEMORY;
	}
	memcpy( body->dilation, s->dilation.data, triangles * sizeof( double ) );
	memcpy( body->solid, s->solid.data, triangles * sizeof( bool ) );
	lw_status status =
		lwi_body_mesh_of( s->vertices.data, s->vertices.count, s->indices.data, triangles, memory, diag, &body->surface );
	if ( status != LW_OK )
	{
		return status;
	}
	set_scale( body );
	status = lwi_body_find_shells( body, close_holes, diag );
	if ( status != LW_OK || body->closed == NULL )
	{
		return status;
	}
	body->grids = lwi_alloc_zero( memory, LWI_RAY_GRIDS, sizeof( lwi_ray_grid ) );
	for ( int i = 0; i < LWI_RAY_GRIDS && status == LW_OK; ++i )
	{
		status = body->grids == NULL ? LW_ERROR_OUT_OF_MEMORY : make_grid( body, i, &body->grids[i] );
		status = status == LW_OK ? fill_grid( body, &body->grids[i] ) : status;
	}
	return status == LW_OK ? make_outer( body, HIDDEN_SHARE * grain, diag ) : status;
}

bool lwi_body_stopped( lwi_body* body )
{
	if ( body->stop != NULL && !body->stopped && ( body->calls++ & 15 ) == 0 )
	{
		body->stopped = body->stop( body->user );
	}
	return body->stopped;
}

lw_status lwi_body_create( const lwi_body_part* parts, uint32_t part_count, double close_holes, double grain,
	bool ( *stop )( void* ), void* user, const lw_allocator* allocator, lw_diag* diag, lwi_body* out )
{
	memset( out, 0, sizeof( *out ) );
	out->memory = *allocator;
	out->stop = stop;
	out->user = user;
	lwi_body_triangles s = { 0 };
	lw_status status = build( parts, part_count, close_holes, grain, &s, out, diag );
	lwi_body_triangles_free( &s, allocator );
	if ( status != LW_OK )
	{
		lwi_body_free( out );
	}
	return status == LW_ERROR_OUT_OF_MEMORY ? lwi_out_of_memory( diag, "a body" ) : status;
}

void lwi_body_free( lwi_body* body )
{
	const lw_allocator* memory = &body->memory;
	lwi_free( memory, body->dilation, body->triangle_count * sizeof( double ) );
	lwi_free( memory, body->solid, body->triangle_count * sizeof( bool ) );
	for ( int i = 0; body->grids != NULL && i < LWI_RAY_GRIDS; ++i )
	{
		lwi_ray_grid* grid = &body->grids[i];
		lwi_free( memory, grid->vertices, 3 * (size_t)body->closed->vertex_count * sizeof( double ) );
		lwi_free( memory, grid->start, ( LWI_RAY_CELLS * LWI_RAY_CELLS + 1 ) * sizeof( uint32_t ) );
		lwi_free( memory, grid->items, grid->item_count * sizeof( uint32_t ) );
	}
	lwi_free( memory, body->grids, LWI_RAY_GRIDS * sizeof( lwi_ray_grid ) );
	if ( body->closed != NULL )
	{
		lwi_free( memory, body->shell, body->closed->item_count * sizeof( uint32_t ) );
	}
	lwi_free( memory, body->shell_solid, body->shell_count * sizeof( bool ) );
	lwi_free( memory, body->parity, body->shell_count * sizeof( uint8_t ) );
	lw_shape_release( body->outer );
	lw_shape_release( body->closed );
	lw_shape_release( body->surface );
	memset( body, 0, sizeof( *body ) );
}
