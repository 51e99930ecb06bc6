// SPDX-License-Identifier: BSD-3-Clause
// The spheres of one level of a sphere tree, for pictures.
#include "shape/shape.h"

#include <math.h>

/// Collects the spheres of a level into an array that may be too small for all of them.
typedef struct level_walk
{
	const lw_shape* shape;
	double* out;
	uint32_t capacity, count;
} level_walk;

static void add_sphere( level_walk* w, double x, double y, double z, double radius )
{
	if ( w->count < w->capacity )
	{
		double* at = w->out + 4 * (size_t)w->count;
		at[0] = x + w->shape->origin[0];
		at[1] = y + w->shape->origin[1];
		at[2] = z + w->shape->origin[2];
		at[3] = radius;
	}
	++w->count;
}

static void visit_children( level_walk* w, uint32_t node, uint32_t levels )
{
	const lwi_node* n = &w->shape->nodes[node];
	for ( uint32_t lane = 0; lane < LWI_WIDTH && n->child[lane] != LW_INVALID_INDEX; ++lane )
	{
		if ( levels > 1 && !lwi_ref_is_leaf( n->child[lane] ) )
		{
			visit_children( w, n->child[lane], levels - 1 ); // at most LWI_MAX_DEPTH deep
		}
		else
		{
			add_sphere( w, (double)n->x[lane], (double)n->y[lane], (double)n->z[lane], (double)n->r[lane] );
		}
	}
}

uint32_t lw_shape_level_spheres( const lw_shape* shape, uint32_t level, double* out_spheres, uint32_t capacity )
{
	lw_status status = LW_OK;
	const lw_shape* made = shape != NULL ? lwi_shape_made( shape, &status, NULL ) : NULL;
	if ( made == NULL || !isfinite( made->sphere_radius ) )
	{
		return 0;
	}
	level_walk w = { made, out_spheres, out_spheres != NULL ? capacity : 0, 0 };
	if ( level == 0 || made->primitive || lwi_ref_is_leaf( made->root ) )
	{
		const double* c = made->sphere_center;
		const double* o = made->origin;
		add_sphere( &w, c[0] - o[0], c[1] - o[1], c[2] - o[2], made->sphere_radius );
	}
	else
	{
		visit_children( &w, made->root, level );
	}
	return w.count;
}
