// SPDX-License-Identifier: BSD-3-Clause
// The inside of solids: spheres around a solid's surface may leave a void, which is found, and filled, cell by cell.
//
// Samet, "The quadtree and related hierarchical data structures", 1984. Why a margin at the surface makes it end:
// core/docs/detail.md.
#include "approximate/body_internal.h"
#include "approximate/enclose.h"

#include "base/math_inline.h"
#include "shape/shape.h"

enum
{
	MAX_CELL_DEPTH = 24
};

typedef struct walk
{
	lwi_body* body;
	lwi_array* spheres;
	double margin, excess;
	size_t given;    ///< spheres before the walk; later ones are in no list and always tested
	lwi_array lists; ///< uint32_t: per level, the spheres that meet the current cell
	double gap;
	lw_vec3 at;
	bool open;
} walk;

static const double* sphere_at( const walk* w, size_t i )
{
	return (const double*)w->spheres->data + 4 * i;
}

/// How far a point is from all spheres; negative inside.
static double gap_at( const walk* w, lw_vec3 p )
{
	double gap = INFINITY;
	for ( size_t i = 0; i < w->spheres->count; ++i )
	{
		const double* s = sphere_at( w, i );
		gap = fmin( gap, lwi_distance( p, lwi_load( s ) ) - s[3] );
	}
	return gap;
}

static bool add_sphere( walk* w, lw_vec3 p, double radius )
{
	const double sphere[4] = { p.x, p.y, p.z, radius };
	return lwi_array_push( w->spheres, &w->body->memory, sizeof( sphere ), sphere );
}

/// Handles a cell that no single sphere contains: notes it, or fills it.
static bool leave_open( walk* w, lw_vec3 c )
{
	if ( w->excess > 0 )
	{
		lwi_nearest x = lwi_shape_nearest( w->body->outer, c, INFINITY, false, NULL, 0 );
		double depth = lwi_body_depth( w->body, c, true );
		return depth > 0 ? add_sphere( w, c, depth + w->excess ) : add_sphere( w, x.point, w->excess );
	}
	double gap = fmax( gap_at( w, c ), 0 );
	if ( !w->open || gap > w->gap )
	{
		w->gap = gap;
		w->at = c;
	}
	w->open = true;
	return true;
}

/// @param first where the list of the parent's spheres begins. @return false if out of memory
static bool visit( walk* w, lw_vec3 c, double half, size_t first, int depth )
{
	if ( lwi_body_stopped( w->body ) )
	{
		return false;
	}
	double radius = half * 1.7320508075688774 * ( 1 + 16 * LWI_U64 );
	size_t mine = w->lists.count;
	bool met = false;
	for ( size_t i = 0; i < mine - first + w->spheres->count - w->given; ++i )
	{
		bool listed = i < mine - first;
		size_t index = listed ? ( (const uint32_t*)w->lists.data )[first + i] : w->given + ( i - ( mine - first ) );
		const double* s = sphere_at( w, index );
		double surface_distance = lwi_distance( c, lwi_load( s ) );
		if ( surface_distance + radius <= s[3] )
		{
			w->lists.count = mine;
			return true;
		}
		if ( surface_distance > s[3] + radius )
		{
			continue;
		}
		met = true;
		if ( listed && !lwi_array_push( &w->lists, &w->body->memory, sizeof( uint32_t ), &( uint32_t ){ (uint32_t)index } ) )
		{
			return false;
		}
	}
	// farther than this is all the same
	double far = ( radius > w->margin ? radius : w->margin ) + 2 * w->body->slack;
	double surface_distance = lwi_shape_nearest( w->body->closed, c, far, true, NULL, 0 ).distance;
	bool crossed = surface_distance <= radius + w->body->slack, ok = true;
	bool outside = !crossed && !lwi_body_encloses_by( w->body, c, LW_INVALID_INDEX, w->body->shell_solid );
	bool at_surface = surface_distance + radius + w->body->slack <= w->margin;
	if ( !outside && !at_surface )
	{
		bool is_void = !crossed && !met;
		if ( is_void || depth == MAX_CELL_DEPTH || radius < 0.1 * w->margin || ( w->open && w->excess == 0 ) )
		{
			ok = leave_open( w, c );
		}
		else
		{
			for ( int k = 0; ok && k < 8; ++k )
			{
				double q = 0.5 * half;
				lw_vec3 child = { c.x + ( k & 1 ? q : -q ), c.y + ( k & 2 ? q : -q ), c.z + ( k & 4 ? q : -q ) };
				ok = visit( w, child, q, mine, depth + 1 );
			}
		}
	}
	w->lists.count = mine;
	return ok;
}

int lwi_enclose_voids( lwi_body* body, lwi_array* spheres, double margin, double excess, double* gap, lw_vec3* at )
{
	if ( !body->any_solid || body->closed == NULL )
	{
		return 1;
	}
	walk w = { .body = body, .spheres = spheres, .margin = margin, .excess = excess, .given = spheres->count };
	lw_shape_info info = lw_shape_get_info( body->closed );
	double half = 0;
	lw_vec3 center = { 0.5 * ( info.box_min[0] + info.box_max[0] ), 0.5 * ( info.box_min[1] + info.box_max[1] ),
		0.5 * ( info.box_min[2] + info.box_max[2] ) };
	for ( int k = 0; k < 3; ++k )
	{
		half = fmax( half, 0.5 * ( info.box_max[k] - info.box_min[k] ) );
	}
	bool ok = true;
	for ( uint32_t i = 0; ok && i < spheres->count; ++i )
	{
		ok = lwi_array_push( &w.lists, &body->memory, sizeof( i ), &i );
	}
	ok = ok && visit( &w, center, half * ( 1 + 1e-9 ), 0, 0 );
	lwi_array_free( &w.lists, &body->memory, sizeof( uint32_t ) );
	*gap = w.gap;
	*at = w.at;
	return !ok ? -1 : w.open ? 0 : 1;
}
