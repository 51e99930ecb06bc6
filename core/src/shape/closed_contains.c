// SPDX-License-Identifier: BSD-3-Clause
// Is a point inside a closed mesh? Winding numbers along a ray, exact for the numbers given.
//
// The ray runs along an axis, to the nearest side of the mesh's box, from a point that is moved by nothing at all but in a
// direction that no vertex and no edge lies in (simulation of simplicity: Edelsbrunner, Muecke, 1990). Seen along the ray a
// triangle winds around the point by -1, 0 or 1, and the triangles of a closed surface that lie ahead add up to its winding
// number. Proof: core/docs/solid_meshes.md.
#include "base/exact_sign.h"
#include "shape/closed_mesh.h"

#include <string.h>

enum
{
	COMPONENTS_AT_ONCE = 256,
	STACK_SIZE = ( LWI_WIDTH - 1 ) * ( LWI_MAX_DEPTH + 1 ) + LWI_WIDTH
};

typedef struct ray
{
	const lw_shape* shape;
	double p[3];      ///< shape frame
	double tree_p[3]; ///< tree frame
	int axis;
	bool forward;
	double slack; ///< metres: error of tree_p and of the spheres
	bool on_surface;
	uint32_t first_component; ///< of those counted now
	int32_t winding[COMPONENTS_AT_ONCE];
} ray;

static double snapped( double v )
{
	return fabs( v ) < LWI_EXACT_LEAST ? 0.0 : v;
}

/// How often the triangle winds around p, seen along the axis: u and v are the other two axes. p is moved to (u + e, v + d),
/// with d infinitely smaller than e, both than anything: the half line from there towards greater u crosses an edge that
/// runs up past it, or down, if that edge is to its right.
static int winding_of( const double vertex[3][3], const double p[3], int axis )
{
	int u = ( axis + 1 ) % 3, v = ( axis + 2 ) % 3, winding = 0;
	bool above[3];
	for ( int k = 0; k < 3; ++k )
	{
		above[k] = vertex[k][v] > p[v];
	}
	if ( above[0] == above[1] && above[1] == above[2] )
	{
		return 0;
	}
	for ( int k = 0; k < 3; ++k )
	{
		int next = ( k + 1 ) % 3;
		if ( above[k] == above[next] )
		{
			continue;
		}
		// always evaluated from the lower end: triangles that share an edge get the same sign
		int low = above[k] ? next : k, high = above[k] ? k : next;
		const double a[2] = { vertex[low][u], vertex[low][v] }, b[2] = { vertex[high][u], vertex[high][v] };
		const double q[2] = { p[u], p[v] };
		if ( lwi_exact_orientation( a, b, q ) > 0 )
		{
			winding += above[next] ? 1 : -1;
		}
	}
	return winding;
}

static void count_triangle( ray* r, uint32_t triangle )
{
	uint32_t component = r->shape->components[triangle];
	if ( component == LW_INVALID_INDEX || ( component >> 2 ) - r->first_component >= COMPONENTS_AT_ONCE )
	{
		return;
	}
	double vertex[3][3];
	bool behind = true;
	for ( int k = 0; k < 3; ++k )
	{
		const double* from = r->shape->vertices + 3 * (size_t)r->shape->indices[3 * (size_t)triangle + (size_t)k];
		for ( int i = 0; i < 3; ++i )
		{
			vertex[k][i] = snapped( from[i] );
		}
		behind = behind && ( r->forward ? vertex[k][r->axis] < r->p[r->axis] : vertex[k][r->axis] > r->p[r->axis] );
	}
	int winding = behind ? 0 : winding_of( (const double( * )[3])vertex, r->p, r->axis );
	if ( winding == 0 )
	{
		return;
	}
	// side and winding agree where the triangle's plane is ahead in the direction of the axis
	int ahead = winding * lwi_exact_side( vertex[0], vertex[1], vertex[2], r->p );
	r->on_surface = r->on_surface || ahead == 0;
	if ( ( ahead > 0 ) != r->forward )
	{
		return;
	}
	int32_t* sum = &r->winding[( component >> 2 ) - r->first_component];
	*sum = ( component & LWI_COMPONENT_MIXED ) != 0
			   ? *sum ^ 1
			   : *sum + ( ( component & LWI_COMPONENT_FLIPPED ) != 0 ? -winding : winding );
}

/// True if the ray may meet the sphere.
static bool meets( const ray* r, const lwi_node* node, int lane )
{
	const double center[3] = { (double)node->x[lane], (double)node->y[lane], (double)node->z[lane] };
	double radius = (double)node->r[lane] + r->slack;
	int u = ( r->axis + 1 ) % 3, v = ( r->axis + 2 ) % 3;
	double du = center[u] - r->tree_p[u], dv = center[v] - r->tree_p[v], along = center[r->axis] - r->tree_p[r->axis];
	return du * du + dv * dv <= radius * radius && ( r->forward ? along : -along ) >= -radius;
}

static void cast( ray* r )
{
	const lw_shape* shape = r->shape;
	lwi_ref stack[STACK_SIZE];
	uint32_t height = 1;
	stack[0] = shape->root;
	while ( height > 0 && !r->on_surface )
	{
		lwi_ref ref = stack[--height];
		if ( lwi_ref_is_leaf( ref ) )
		{
			const lwi_leaf* leaf = &shape->leaves[lwi_ref_index( ref )];
			for ( uint32_t lane = 0; lane < lwi_ref_count( ref ); ++lane )
			{
				count_triangle( r, leaf->triangle[lane] );
			}
			continue;
		}
		const lwi_node* node = &shape->nodes[ref];
		for ( int lane = 0; lane < LWI_WIDTH && node->child[lane] != LW_INVALID_INDEX; ++lane )
		{
			if ( meets( r, node, lane ) )
			{
				stack[height++] = node->child[lane];
			}
		}
	}
}

bool lwi_mesh_contains( const lw_shape* shape, lw_vec3 point )
{
	ray r = { .shape = shape, .p = { snapped( point.x ), snapped( point.y ), snapped( point.z ) } };
	double nearest = INFINITY, largest = 0.0;
	for ( int k = 0; k < 3; ++k )
	{
		double to_max = shape->box_max[k] - r.p[k], to_min = r.p[k] - shape->box_min[k];
		if ( !( to_max >= 0.0 && to_min >= 0.0 ) )
		{
			return false;
		}
		if ( to_max < nearest || to_min < nearest )
		{
			r.axis = k;
			r.forward = to_max <= to_min;
			nearest = to_max < to_min ? to_max : to_min;
		}
		r.tree_p[k] = r.p[k] - shape->origin[k];
		largest = fmax( largest, fmax( fabs( shape->box_min[k] ), fabs( shape->box_max[k] ) ) );
	}
	// differences of coordinates within the box, and displacements by snapping
	r.slack = 16 * LWI_U64 * ( largest + (double)shape->extent ) + LWI_EXACT_LEAST;
	for ( ; r.first_component < shape->component_count; r.first_component += COMPONENTS_AT_ONCE )
	{
		memset( r.winding, 0, sizeof( r.winding ) );
		cast( &r );
		for ( int i = 0; i < COMPONENTS_AT_ONCE && !r.on_surface; ++i )
		{
			if ( r.winding[i] != 0 )
			{
				return true;
			}
		}
		if ( r.on_surface )
		{
			return true;
		}
	}
	return false;
}
