// SPDX-License-Identifier: BSD-3-Clause
// Proves that spheres contain boxes and cylinders whole, by cells that are each in one sphere.
//
// The cells lie in the coordinates of the shape (x, y, z, or radius, angle, z), so none reaches out of it, where spheres are
// thin: a walk through a grid takes area / excess^2 cells at the surface, this one some hundred for each sphere. Samet, "The
// quadtree and related hierarchical data structures", 1984.
#include "approximate/enclose.h"

#include "base/math_inline.h"
#include "shape/shape.h"

enum
{
	MAX_HALVINGS = 72
};

typedef struct solid_walk
{
	lwi_body* body;
	const double* spheres;
	lw_transform pose;
	bool round;
	lwi_array lists; ///< uint32_t: per level, the spheres that meet the current cell
} solid_walk;

/// A box in the coordinates of the shape.
typedef struct cell
{
	double low[3], high[3];
} cell;

/// Corners of a convex body around a cell. Returns the side to halve.
static int corners_of( const solid_walk* w, const cell* c, lw_vec3 out[8] )
{
	// the outer edge touches the arc in its middle; the inner one is a chord, inside of which nothing of the cell is
	double turn = c->high[1] - c->low[1],
		   outer = w->round ? c->high[0] / cos( 0.5 * turn ) * ( 1 + 16 * LWI_U64 ) : c->high[0];
	for ( int k = 0; k < 8; ++k )
	{
		double x = k & 1 ? outer : c->low[0], y = k & 2 ? c->high[1] : c->low[1], z = k & 4 ? c->high[2] : c->low[2];
		out[k] = lwi_transform( &w->pose, w->round ? lwi_v3( x * cos( y ), x * sin( y ), z ) : lwi_v3( x, y, z ) );
	}
	double sides[3] = { c->high[0] - c->low[0], w->round ? turn * c->high[0] : turn, c->high[2] - c->low[2] };
	int longest = sides[0] >= sides[1] ? 0 : 1;
	return sides[2] > sides[longest] ? 2 : longest;
}

static bool contains( const double* s, const lw_vec3 corner[8], double slack )
{
	double room = s[3] - slack;
	for ( int k = 0; k < 8; ++k )
	{
		if ( !( lwi_distance( corner[k], lwi_load( s ) ) <= room ) )
		{
			return false;
		}
	}
	return true;
}

/// @param first where the list of the parent's spheres begins. @return 1 proved, 0 not, -1 out of memory or stopped
static int visit( solid_walk* w, const cell* c, size_t first, int halvings )
{
	if ( lwi_body_stopped( w->body ) )
	{
		return -1;
	}
	lw_vec3 corner[8], middle = { 0, 0, 0 };
	int side = corners_of( w, c, corner );
	double radius = 0;
	for ( int k = 0; k < 8; ++k )
	{
		middle = lwi_add_scaled( middle, 0.125, corner[k] );
	}
	for ( int k = 0; k < 8; ++k )
	{
		radius = fmax( radius, lwi_distance( middle, corner[k] ) );
	}
	size_t mine = w->lists.count;
	bool inside = false;
	if ( !lwi_array_reserve( &w->lists, &w->body->memory, sizeof( uint32_t ), mine - first ) )
	{
		return -1;
	}
	uint32_t* list = w->lists.data;
	for ( size_t i = first; i < mine; ++i )
	{
		const double* s = w->spheres + 4 * (size_t)list[i];
		double center_distance = lwi_distance( middle, lwi_load( s ) );
		if ( center_distance <= s[3] && contains( s, corner, w->body->slack ) )
		{
			w->lists.count = mine;
			return 1;
		}
		inside = inside || center_distance <= s[3];
		if ( center_distance <= ( s[3] + radius ) * ( 1 + 1e-9 ) )
		{
			list[w->lists.count++] = list[i];
		}
	}
	int proved = inside && halvings < MAX_HALVINGS ? 1 : 0;
	for ( int half = 0; half < 2 && proved == 1; ++half )
	{
		cell child = *c;
		( half == 0 ? child.high : child.low )[side] = 0.5 * ( c->low[side] + c->high[side] );
		proved = visit( w, &child, mine, halvings + 1 );
	}
	w->lists.count = mine;
	return proved;
}

int lwi_enclose_solid( lwi_body* body, const lw_shape* shape, const lw_transform* pose, const double* spheres,
	uint32_t count )
{
	const double* d = shape->dimensions;
	solid_walk w = { .body = body, .spheres = spheres, .pose = *pose, .round = shape->type == LW_SHAPE_CYLINDER };
	int proved = lwi_array_reserve( &w.lists, &body->memory, sizeof( uint32_t ), count ) ? 1 : -1;
	for ( uint32_t i = 0; i < count && proved == 1; ++i )
	{
		( (uint32_t*)w.lists.data )[w.lists.count++] = i;
	}
	for ( int quarter = 0; quarter < ( w.round ? 4 : 1 ) && proved == 1; ++quarter )
	{
		cell box = { { -0.5 * d[0], -0.5 * d[1], -0.5 * d[2] }, { 0.5 * d[0], 0.5 * d[1], 0.5 * d[2] } };
		cell wedge = { { 0, 0.5 * LWI_PI * quarter, -0.5 * d[1] }, { d[0], 0.5 * LWI_PI * ( quarter + 1 ), 0.5 * d[1] } };
		proved = visit( &w, w.round ? &wedge : &box, 0, 0 );
	}
	lwi_array_free( &w.lists, &body->memory, sizeof( uint32_t ) );
	return proved;
}
