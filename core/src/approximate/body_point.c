// SPDX-License-Identifier: BSD-3-Clause
// Tests of one point against a body: the nearest triangle, whether a closed shell encloses it, how deep it lies.
//
// Quinlan, "Efficient distance computation between non-convex objects", 1994 (branch and bound over spheres); Ericson,
//   "Real-Time Collision Detection", 2005, section 5.1.5 (nearest point of a triangle); Shewchuk, "Adaptive precision
//   floating-point arithmetic and fast robust geometric predicates", 1997 (error bounds of orientations).
#include "approximate/body_internal.h"

#include "base/math_inline.h"
#include "distance/convex.h"
#include "shape/shape.h"
#include "distance/tri_tri.h"

#include <string.h>

/// Error bounds of the two orientations relative to the sum of the magnitudes of their products: Shewchuk's are 3u and 7u,
/// and 16u^2 more.
#define ORIENT_2D_ERROR ( 4 * LWI_U64 )
#define ORIENT_3D_ERROR ( 8 * LWI_U64 )

static void load_corners( const lw_shape* shape, uint32_t triangle, lw_vec3 v[3] )
{
	for ( size_t k = 0; k < 3; ++k )
	{
		v[k] = lwi_load( shape->vertices + 3 * (size_t)shape->indices[3 * (size_t)triangle + k] );
	}
}

static void offer_triangle( const lw_shape* shape, uint32_t triangle, lw_vec3 p, bool certified, lwi_nearest* best )
{
	lw_vec3 v[3];
	load_corners( shape, triangle, v );
	lw_vec3 x = lwi_nearest_on_triangle( v, p );
	double distance = lwi_distance( x, p );
	if ( certified )
	{
		const lw_vec3 point[3] = { p, p, p };
		lwi_tri_result r = lwi_tri_tri( point, v );
		distance = r.distance;
		x = r.point_b;
	}
	if ( distance < best->distance )
	{
		*best = ( lwi_nearest ){ distance, triangle, x };
	}
}

typedef struct entry
{
	double gap;
	lwi_ref ref;
} entry;

/// Pushes the children of a node that are nearer than `limit`, the nearest last.
static uint32_t push_children( const lwi_node* node, lw_vec3 p, double limit, entry* stack, uint32_t height )
{
	uint32_t first = height;
	for ( uint32_t lane = 0; lane < LWI_WIDTH && node->child[lane] != LW_INVALID_INDEX; ++lane )
	{
		lw_vec3 c = lwi_v3( (double)node->x[lane], (double)node->y[lane], (double)node->z[lane] );
		// the sphere contains the geometry; the rounding of this gap is subtracted
		double center_distance = lwi_distance( p, c );
		double gap = center_distance - (double)node->r[lane] - 8 * LWI_U64 * center_distance;
		if ( gap >= limit )
		{
			continue;
		}
		uint32_t at = height++;
		while ( at > first && stack[at - 1].gap < gap )
		{
			stack[at] = stack[at - 1];
			--at;
		}
		stack[at] = ( entry ){ gap, node->child[lane] };
	}
	return height;
}

/// @param near_enough the first triangle at this distance or nearer ends the search
/// @param group, of, inside triangles for which ( group[triangle] == of ) != inside are passed over; group NULL: none
static lwi_nearest search( const lw_shape* shape, lw_vec3 p, double stop, double near_enough, bool certified,
	const uint32_t* group, uint32_t of, bool inside )
{
	lwi_nearest best = { stop, LW_INVALID_INDEX, p };
	lw_vec3 moved = lwi_sub( p, lwi_load( shape->origin ) );
	// the tree stands in its own frame: rounding of p's move to that frame
	double shift = 4 * LWI_U64 * ( lwi_length( p ) + lwi_length( lwi_load( shape->origin ) ) );
	entry stack[LWI_MAX_DEPTH * LWI_WIDTH + 1];
	stack[0] = ( entry ){ 0, shape->root };
	uint32_t height = 1;
	while ( height > 0 )
	{
		entry e = stack[--height];
		if ( e.gap - shift >= best.distance )
		{
			continue;
		}
		if ( !lwi_ref_is_leaf( e.ref ) )
		{
			height = push_children( &shape->nodes[e.ref], moved, best.distance + shift, stack, height );
			continue;
		}
		const lwi_leaf* leaf = &shape->leaves[lwi_ref_index( e.ref )];
		for ( uint32_t lane = 0; lane < lwi_ref_count( e.ref ); ++lane )
		{
			uint32_t triangle = leaf->triangle[lane];
			if ( group == NULL || ( group[triangle] == of ) == inside )
			{
				offer_triangle( shape, triangle, p, certified, &best );
			}
		}
		if ( best.triangle != LW_INVALID_INDEX && best.distance <= near_enough )
		{
			return best;
		}
	}
	if ( best.triangle == LW_INVALID_INDEX )
	{
		best.distance = INFINITY;
	}
	return best;
}

lwi_nearest lwi_shape_nearest( const lw_shape* shape, lw_vec3 p, double stop, bool certified, const uint32_t* group,
	uint32_t of )
{
	return search( shape, p, stop, 0, certified, group, of, true );
}

bool lwi_shape_is_near_but( const lw_shape* shape, lw_vec3 p, double distance, const uint32_t* group, uint32_t of )
{
	return search( shape, p, distance, distance, false, group, of, false ).triangle != LW_INVALID_INDEX;
}

bool lwi_shape_is_near( const lw_shape* shape, lw_vec3 p, double distance )
{
	return search( shape, p, distance, distance, false, NULL, 0, true ).triangle != LW_INVALID_INDEX;
}

// --- rays ------------------------------------------------------------------------------------------------------------

/// Sign of the area of a, b, p in the plane: 1, -1, or 0 where rounding could decide it.
static int orient_2d( const double* a, const double* b, lw_vec3 p )
{
	double left = ( a[0] - p.x ) * ( b[1] - p.y ), right = ( a[1] - p.y ) * ( b[0] - p.x );
	double area = left - right, error = ORIENT_2D_ERROR * ( fabs( left ) + fabs( right ) );
	return area > error ? 1 : area < -error ? -1 : 0;
}

/// Sign of the volume of a, b, c, p; 0 where rounding could decide it.
static int orient_3d( const double* a, const double* b, const double* c, lw_vec3 p )
{
	double ax = a[0] - p.x, ay = a[1] - p.y, az = a[2] - p.z, bx = b[0] - p.x, by = b[1] - p.y, bz = b[2] - p.z;
	double cx = c[0] - p.x, cy = c[1] - p.y, cz = c[2] - p.z;
	double volume = az * ( bx * cy - cx * by ) + bz * ( cx * ay - ax * cy ) + cz * ( ax * by - bx * ay );
	double size = fabs( az ) * ( fabs( bx * cy ) + fabs( cx * by ) ) + fabs( bz ) * ( fabs( cx * ay ) + fabs( ax * cy ) ) +
				  fabs( cz ) * ( fabs( ax * by ) + fabs( bx * ay ) );
	double error = ORIENT_3D_ERROR * size;
	return volume > error ? 1 : volume < -error ? -1 : 0;
}

/// Does the ray from p along +z cross the triangle? 1 yes, 0 no, -1 undecided.
static int crosses( const double* a, const double* b, const double* c, lw_vec3 p )
{
	if ( fmax( a[2], fmax( b[2], c[2] ) ) < p.z )
	{
		return 0;
	}
	int s0 = orient_2d( a, b, p ), s1 = orient_2d( b, c, p ), s2 = orient_2d( c, a, p );
	bool positive = s0 > 0 || s1 > 0 || s2 > 0, negative = s0 < 0 || s1 < 0 || s2 < 0;
	if ( positive && negative )
	{
		return 0;
	}
	if ( s0 == 0 || s1 == 0 || s2 == 0 )
	{
		return -1;
	}
	// the volume is positive if p is below a triangle that runs counter-clockwise seen from above
	int side = orient_3d( a, b, c, p );
	return side == 0 ? -1 : side == s0 ? 1 : 0;
}

/// Odd crossings with some shell along the grid's direction: 1 yes, 0 no, -1 undecided.
static int odd_crossings( lwi_body* body, const lwi_ray_grid* grid, lw_vec3 point, uint32_t but, const bool* among )
{
	lw_vec3 p = lwi_rotate( &grid->turn, point );
	if ( p.x < grid->low[0] || p.x > grid->high[0] || p.y < grid->low[1] || p.y > grid->high[1] )
	{
		return 0;
	}
	size_t cell = (size_t)lwi_ray_cell( p.y, grid->low[1], grid->inv_cell[1] ) * LWI_RAY_CELLS +
				  lwi_ray_cell( p.x, grid->low[0], grid->inv_cell[0] );
	int answer = 0;
	for ( uint32_t i = grid->start[cell]; i < grid->start[cell + 1]; ++i )
	{
		uint32_t triangle = grid->items[i], shell = body->shell[triangle];
		if ( shell == but || ( among != NULL && !among[shell] ) )
		{
			continue; // the point may lie on it
		}
		const uint32_t* index = body->closed->indices + 3 * (size_t)triangle;
		const double *a = grid->vertices + 3 * (size_t)index[0], *b = grid->vertices + 3 * (size_t)index[1];
		const double* c = grid->vertices + 3 * (size_t)index[2];
		int crossed = crosses( a, b, c, p );
		if ( crossed < 0 )
		{
			answer = -1;
			break;
		}
		body->parity[shell] ^= (uint8_t)crossed;
	}
	for ( uint32_t i = grid->start[cell]; i < grid->start[cell + 1]; ++i )
	{
		uint8_t* parity = &body->parity[body->shell[grid->items[i]]];
		uint32_t shell = body->shell[grid->items[i]];
		if ( *parity != 0 && answer == 0 )
		{
			answer = 1;
			body->inside_shell = shell;
		}
		*parity = 0;
	}
	return answer;
}

bool lwi_body_encloses_by( lwi_body* body, lw_vec3 p, uint32_t but, const bool* among )
{
	for ( int i = 0; body->closed != NULL && i < LWI_RAY_GRIDS; ++i )
	{
		int odd = odd_crossings( body, &body->grids[i], p, but, among );
		if ( odd >= 0 )
		{
			return odd == 1;
		}
	}
	return false;
}

bool lwi_body_encloses( lwi_body* body, lw_vec3 p )
{
	return lwi_body_encloses_by( body, p, LW_INVALID_INDEX, NULL );
}

// --- depth -----------------------------------------------------------------------------------------------------------

/// Distance to the dilated surface: min over triangles of distance - dilation, negative inside of a dilated triangle.
static double dilated_distance( const lwi_body* body, lw_vec3 p, bool certified )
{
	if ( body->dilation_max == 0 )
	{
		return lwi_shape_nearest( body->surface, p, INFINITY, certified, NULL, 0 ).distance;
	}
	const lw_shape* shape = body->surface;
	double best = INFINITY;
	lw_vec3 moved = lwi_sub( p, lwi_load( shape->origin ) );
	double shift = 4 * LWI_U64 * ( lwi_length( p ) + lwi_length( lwi_load( shape->origin ) ) );
	entry stack[LWI_MAX_DEPTH * LWI_WIDTH + 1];
	stack[0] = ( entry ){ 0, shape->root };
	uint32_t height = 1;
	while ( height > 0 )
	{
		entry e = stack[--height];
		double limit = best + body->dilation_max + shift;
		if ( e.gap >= limit )
		{
			continue;
		}
		if ( !lwi_ref_is_leaf( e.ref ) )
		{
			height = push_children( &shape->nodes[e.ref], moved, limit, stack, height );
			continue;
		}
		const lwi_leaf* leaf = &shape->leaves[lwi_ref_index( e.ref )];
		for ( uint32_t lane = 0; lane < lwi_ref_count( e.ref ); ++lane )
		{
			lwi_nearest nearest = { INFINITY, LW_INVALID_INDEX, p };
			offer_triangle( shape, leaf->triangle[lane], p, certified, &nearest );
			best = fmin( best, nearest.distance - body->dilation[leaf->triangle[lane]] );
		}
	}
	return best;
}

double lwi_body_depth( lwi_body* body, lw_vec3 p, bool certified )
{
	double inside = -INFINITY;
	if ( body->outer != NULL )
	{
		double distance = lwi_shape_nearest( body->outer, p, INFINITY, certified, NULL, 0 ).distance;
		// nearer to the surface than rounding, a ray proves nothing
		inside = distance > body->slack && lwi_body_encloses( body, p ) ? distance : -INFINITY;
		if ( inside > 0 && body->dilation_max == 0 )
		{
			return certified ? inside - body->slack : inside;
		}
	}
	double depth = fmax( inside, -dilated_distance( body, p, certified ) );
	return certified ? depth - body->slack : depth;
}
