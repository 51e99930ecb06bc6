// SPDX-License-Identifier: BSD-3-Clause
// Balls about a point inside of shapes. Derivation: core/docs/depth.md.
#include "depth/depth.h"
#include "distance/tri_tri.h"
#include "shape/closed_mesh.h"

bool lwi_has_inside( const lw_shape* shape )
{
	const bool surface = shape->type == LW_SHAPE_MESH || shape->type == LW_SHAPE_POINTS;
	return shape->type != LW_SHAPE_PLANE && ( !surface || shape->components != NULL || shape->radius > 0 );
}

lwi_round_convex lwi_convex_around( const lw_shape* shape, double* corners )
{
	lwi_round_convex out = { .radius = 0 };
	if ( lwi_convex_of_shape( shape, &out.core ) )
	{
		out.radius = shape->primitive ? 0 : lwi_item_radius( shape, 0 );
		return out;
	}
	out.core = ( lwi_convex ){ .type = LWI_CONVEX_POINTS, .points = shape->vertices, .point_count = shape->vertex_count };
	if ( shape->type == LW_SHAPE_SPHERES || shape->type == LW_SHAPE_BOXES ) // the box around, dilation included
	{
		for ( int i = 0; i < 24; ++i )
		{
			corners[i] = ( i / 3 >> i % 3 & 1 ) != 0 ? shape->box_max[i % 3] : shape->box_min[i % 3];
		}
		out.core.points = corners;
		out.core.point_count = 8;
		return out;
	}
	out.radius = shape->radius;
	return out;
}

enum
{
	STACK_SIZE = ( LWI_WIDTH - 1 ) * ( LWI_MAX_DEPTH + 1 ) + LWI_WIDTH
};

typedef struct nearest
{
	const lw_shape* mesh;
	lw_vec3 point;   ///< shape frame
	float tree_p[3]; ///< tree frame
	double slack;    ///< metres: error of a sphere's gap
	double least;
} nearest;

static void look_at_leaf( nearest* n, lwi_ref ref )
{
	const lwi_leaf* leaf = &n->mesh->leaves[lwi_ref_index( ref )];
	for ( uint32_t lane = 0; lane < lwi_ref_count( ref ); ++lane )
	{
		const lw_vec3 p[3] = { n->point, n->point, n->point };
		lw_vec3 corner[3];
		lwi_load_corners( n->mesh, leaf->triangle[lane], corner );
		n->least = fmin( n->least, lwi_tri_tri( p, corner ).distance );
	}
}

/// Lower bound of the distance of a point from the triangles of a mesh, without its dilation. Nearest child last on the stack.
static double surface_distance( const lw_shape* mesh, lw_vec3 point )
{
	nearest n = { .mesh = mesh, .point = point, .least = INFINITY };
	const lw_vec3 p = lwi_sub( point, lwi_load( mesh->origin ) );
	const double size = (double)mesh->extent + lwi_length( p );
	n.tree_p[0] = (float)p.x;
	n.tree_p[1] = (float)p.y;
	n.tree_p[2] = (float)p.z;
	n.slack = 16 * (double)FLT_EPSILON * size;
	struct
	{
		lwi_ref ref;
		double gap;
	} stack[STACK_SIZE];
	uint32_t height = 1;
	stack[0].ref = mesh->root;
	stack[0].gap = -INFINITY;
	while ( height > 0 )
	{
		const lwi_ref ref = stack[--height].ref;
		if ( stack[height].gap >= n.least )
		{
			continue;
		}
		if ( lwi_ref_is_leaf( ref ) )
		{
			look_at_leaf( &n, ref );
			continue;
		}
		const lwi_node* node = &mesh->nodes[ref];
		const uint32_t bottom = height;
		for ( int lane = 0; lane < LWI_WIDTH && node->child[lane] != LW_INVALID_INDEX; ++lane )
		{
			const double x = (double)( node->x[lane] - n.tree_p[0] ), y = (double)( node->y[lane] - n.tree_p[1] ),
						 z = (double)( node->z[lane] - n.tree_p[2] );
			const double gap = sqrt( x * x + y * y + z * z ) - (double)node->r[lane] - n.slack;
			uint32_t at = height++;
			for ( ; at > bottom && stack[at - 1].gap < gap; --at )
			{
				stack[at] = stack[at - 1];
			}
			stack[at].ref = node->child[lane];
			stack[at].gap = gap;
		}
	}
	return n.least - LWI_EXACT_ERROR * ( size + lwi_length( point ) );
}

/// The point's distance from the nearest plane of a convex mesh's triangles; 0 outside.
static double depth_in_convex_mesh( const lw_shape* mesh, lw_vec3 point )
{
	const lw_vec3 middle = lwi_add( lwi_load( mesh->convex->points ), mesh->convex->mean );
	double least = INFINITY, size = 0;
	for ( uint32_t i = 0; i < mesh->item_count && least > 0; ++i )
	{
		lw_vec3 c[3];
		lwi_load_corners( mesh, i, c );
		const lw_vec3 n = lwi_cross( lwi_sub( c[1], c[0] ), lwi_sub( c[2], c[0] ) );
		const lw_vec3 from = lwi_sub( point, c[0] );
		const double inside = lwi_dot( n, lwi_sub( middle, c[0] ) ), length = lwi_length( n );
		least = fmin( least, copysign( 1, inside ) * lwi_dot( n, from ) / length );
		// the normal is off by 4u of the edges' product over its length
		const double edges = lwi_length( lwi_sub( c[1], c[0] ) ) * lwi_length( lwi_sub( c[2], c[0] ) );
		size = fmax( size, lwi_length( from ) * fmax( 1, edges / length ) );
	}
	return fmax( 0, least - 16 * LWI_U64 * ( size + mesh->sphere_radius + lwi_length( point ) ) );
}

/// The largest of the balls about the point inside of the items of a set of balls or boxes.
static double depth_in_items( const lw_shape* shape, lw_vec3 point )
{
	double most = 0;
	for ( uint32_t i = 0; i < shape->item_count; ++i )
	{
		if ( shape->family == LWI_BALLS )
		{
			most = fmax( most,
				lwi_item_radius( shape, i ) - lwi_distance( point, lwi_load( shape->vertices + 3 * (size_t)i ) ) );
			continue;
		}
		const double *low = shape->vertices + 6 * (size_t)i, *high = low + 3, at[3] = { point.x, point.y, point.z };
		double depth = INFINITY;
		for ( int k = 0; k < 3; ++k )
		{
			depth = fmin( depth, fmin( at[k] - low[k], high[k] - at[k] ) );
		}
		most = fmax( most, depth );
	}
	return most - 16 * LWI_U64 * ( most + lwi_length( point ) );
}

/// The depth of the point as a body of its own.
static double depth_in_primitive( const lw_shape* shape, lw_vec3 point )
{
	const lw_transform identity = lw_transform_identity();
	const lwi_round_convex body = { lwi_convex_of_primitive( shape ), 0 };
	const lwi_round_convex at = { { .type = LWI_CONVEX_TRIANGLE, .vertex = { point, point, point } }, 0 };
	const lw_depth_def def = { .steps = 1 }; // it has a closed form
	lw_depth depth;
	lwi_convex_depth( &body, &at, &identity, &def, 0, &depth );
	return depth.lower;
}

double lwi_inner_radius( const lw_shape* shape, lw_vec3 point )
{
	double depth = 0;
	if ( shape->family == LWI_CONVEX )
	{
		depth = depth_in_primitive( shape, point );
	}
	else if ( shape->family == LWI_BALLS || shape->family == LWI_BOXES )
	{
		depth = depth_in_items( shape, point );
	}
	else if ( shape->components != NULL && shape->convex != NULL )
	{
		depth = depth_in_convex_mesh( shape, point );
	}
	else if ( shape->components != NULL && lwi_mesh_contains( shape, point ) )
	{
		depth = surface_distance( shape, point );
	}
	else if ( shape->family == LWI_TRIANGLES && shape->radius > 0 )
	{
		// a lower bound of the distance would be an upper bound of the ball
		depth = shape->radius - surface_distance( shape, point ) -
				2 * LWI_EXACT_ERROR * ( (double)shape->extent + 2 * lwi_length( point ) );
	}
	return fmax( 0, depth );
}
