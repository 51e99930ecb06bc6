// SPDX-License-Identifier: BSD-3-Clause
// Is something of one shape inside a closed mesh? Runs after the search of the surfaces.
//
// If no point of the other shape is on the surface, each connected part of it is wholly inside or wholly outside: one point
// of each tells. A point that is inside is contact, whatever the surfaces do. Shapes of many parts are descended: a sphere
// that the surface does not enter is on one side with all that is in it. Proof: core/docs/solid_meshes.md.
//
// A question for contact alone is answered by a vertex of a mesh inside of a box or cylinder, before all searches.
#include "distance/pair_query.h"
#include "shape/closed_mesh.h"

enum
{
	FEW_ITEMS = 8 ///< sets of no more are tested one by one
};

/// The test in one order: is something of `other` inside `mesh`?
typedef struct inside
{
	lwi_searching* s;
	const lw_shape* mesh;
	const lw_shape* other;
	bool mesh_is_a;
	const lwi_motion* mesh_from_other; ///< tree frames
} inside;

/// A point of an item, in the other's shape frame.
static lw_vec3 point_of_item( const lw_shape* shape, uint32_t item )
{
	if ( shape->primitive )
	{
		return lwi_v3( 0, 0, 0 ); // the centre of a box, cylinder or cone
	}
	size_t vertex = shape->family == LWI_BOXES ? 2 * (size_t)item
					: shape->indices != NULL   ? shape->indices[3 * (size_t)item]
											   : item;
	return lwi_load( shape->vertices + 3 * vertex );
}

/// Tests a point of one item; contact if it is inside.
static bool test_item( const inside* q, uint32_t item )
{
	const lw_transform* m = q->s->a_from_b;
	lw_vec3 p = point_of_item( q->other, item );
	lw_vec3 in_mesh = q->mesh_is_a ? lwi_transform( m, p ) : lwi_untransform( m, p );
	if ( !lwi_mesh_contains( q->mesh, in_mesh ) )
	{
		return false;
	}
	lwi_bound* bound = q->s->bound;
	if ( lwi_bound_offer( bound, 0, 0 ) )
	{
		bound->point_a = bound->point_b = q->mesh_is_a ? in_mesh : p;
		bound->triangle_a = q->mesh_is_a ? LW_INVALID_INDEX : item;
		bound->triangle_b = q->mesh_is_a ? item : LW_INVALID_INDEX;
	}
	return true;
}

/// True if the surface of the mesh may enter a sphere (tree frame of the mesh).
static bool surface_enters( const inside* q, const float sphere[4] )
{
	const lw_shape* mesh = q->mesh;
	const lwi_kernels* kernels = q->s->kernels;
	float limit = lwi_round_up( q->s->slack ), gap[LWI_WIDTH], direction[3][LWI_WIDTH];
	lwi_ref stack[( LWI_WIDTH - 1 ) * ( LWI_MAX_DEPTH + 1 ) + LWI_WIDTH];
	uint32_t height = 1;
	stack[0] = mesh->root;
	while ( height > 0 )
	{
		lwi_ref ref = stack[--height];
		if ( lwi_ref_is_leaf( ref ) )
		{
			uint32_t near = kernels->leaf_gap( &mesh->leaves[lwi_ref_index( ref )], sphere, limit, gap, direction );
			if ( ( near & lwi_low_bits( lwi_ref_count( ref ) ) ) != 0 )
			{
				return true;
			}
			continue;
		}
		const lwi_node* node = &mesh->nodes[ref];
		uint32_t near = kernels->sphere_gap( node->x, sphere, limit, gap ), lanes[LWI_WIDTH];
		for ( uint32_t i = lwi_sorted_lanes( gap, near, lanes ); i-- > 0; )
		{
			stack[height++] = node->child[lanes[i]];
		}
	}
	return false;
}

/// True if a sphere is wholly outside of the box of the mesh, in its tree frame.
static bool beyond_box( const inside* q, const float sphere[4] )
{
	const float center[3] = { sphere[0], sphere[1], sphere[2] };
	double reach = (double)sphere[3] + q->s->slack;
	for ( int k = 0; k < 3; ++k )
	{
		double c = (double)center[k] + q->mesh->origin[k];
		if ( c - reach > q->mesh->box_max[k] || c + reach < q->mesh->box_min[k] )
		{
			return true;
		}
	}
	return false;
}

static uint32_t first_item( const lw_shape* shape, lwi_ref ref )
{
	while ( !lwi_ref_is_leaf( ref ) )
	{
		ref = shape->nodes[ref].child[0];
	}
	return lwi_leaf_item( shape, ref, 0 );
}

/// Descends the other's tree: opens spheres that the surface enters, tests one point of each other sphere.
static bool test_tree( const inside* q )
{
	lwi_entry* stack = q->s->memory->stack;
	const lw_shape* other = q->other;
	stack[0].side[LWI_A].ref = other->root;
	memcpy( stack[0].side[LWI_A].center, other->root_sphere, 3 * sizeof( float ) );
	stack[0].side[LWI_A].radius = other->root_sphere[3];
	for ( uint32_t height = 1; height > 0; )
	{
		lwi_entry e = stack[--height];
		float sphere[4];
		lwi_move_center( q->mesh_from_other, e.side[LWI_A].center, sphere );
		sphere[3] = e.side[LWI_A].radius;
		if ( beyond_box( q, sphere ) )
		{
			continue;
		}
		if ( !surface_enters( q, sphere ) )
		{
			if ( test_item( q, first_item( other, e.side[LWI_A].ref ) ) )
			{
				return true;
			}
			continue;
		}
		if ( lwi_ref_is_leaf( e.side[LWI_A].ref ) )
		{
			for ( uint32_t lane = 0; lane < lwi_ref_count( e.side[LWI_A].ref ); ++lane )
			{
				if ( test_item( q, lwi_leaf_item( other, e.side[LWI_A].ref, lane ) ) )
				{
					return true;
				}
			}
			continue;
		}
		const lwi_node* node = &other->nodes[e.side[LWI_A].ref];
		for ( int lane = 0; lane < LWI_WIDTH && node->child[lane] != LW_INVALID_INDEX; ++lane )
		{
			lwi_entry* child = &stack[height++];
			child->side[LWI_A].ref = node->child[lane];
			child->side[LWI_A].center[0] = node->x[lane];
			child->side[LWI_A].center[1] = node->y[lane];
			child->side[LWI_A].center[2] = node->z[lane];
			child->side[LWI_A].radius = node->r[lane];
		}
	}
	return false;
}

static bool test( const inside* q )
{
	const lw_shape* other = q->other;
	if ( other->family == LWI_UNBOUNDED )
	{
		return false; // nothing unbounded is inside
	}
	if ( other->primitive )
	{
		return test_item( q, LW_INVALID_INDEX );
	}
	if ( other->type == LW_SHAPE_MESH ? other->part_count <= LWI_MAX_PARTS : other->item_count <= FEW_ITEMS )
	{
		uint32_t count = other->type == LW_SHAPE_MESH ? other->part_count : other->item_count;
		for ( uint32_t i = 0; i < count; ++i )
		{
			if ( test_item( q, other->type == LW_SHAPE_MESH ? other->parts[i] : i ) )
			{
				return true;
			}
		}
		return false;
	}
	return test_tree( q );
}

static inside one_order( lwi_searching* s, bool mesh_is_a )
{
	return ( inside ){ s, mesh_is_a ? s->a : s->b, mesh_is_a ? s->b : s->a, mesh_is_a,
		mesh_is_a ? &s->from_other[LWI_A] : &s->from_other[LWI_B] };
}

void lwi_search_inside( lwi_searching* s )
{
	// A point that is inside by less than the rounding of its move may be taken for outside. The surface is then as near,
	// and was measured whatever the bound (lwi_searching.least): its lower end is 0.
	bool found = false;
	for ( int side = 0; side < 2 && !found && !s->bound->done; ++side )
	{
		inside q = one_order( s, side == 0 );
		found = lwi_is_filled( s->bound, q.mesh ) && test( &q );
	}
}

void lwi_measure_inside( lwi_searching* s, uint32_t item_a, uint32_t item_b )
{
	bool mesh_is_a = item_a == LW_INVALID_INDEX && s->a->closed;
	inside q = one_order( s, mesh_is_a );
	uint32_t item = mesh_is_a ? item_b : item_a;
	if ( q.mesh->closed && q.other->family != LWI_UNBOUNDED && ( q.other->primitive || item < q.other->item_count ) )
	{
		test_item( &q, item );
	}
}

// --- a vertex inside of a primitive ----------------------------------------------------------------------------------

/// A box or cylinder made smaller by all roundings of a moved vertex. False: it is no such thing, or nothing is left of it.
static bool inner_of( const lwi_searching* s, const lw_shape* solid, lwi_primitive* out )
{
	const int sizes = solid->type == LW_SHAPE_BOX ? 3 : solid->type == LW_SHAPE_CYLINDER ? 2 : 0;
	double size[3];
	lwi_sizes_of_primitive( solid, size );
	out->type = solid->type;
	for ( int i = 0; i < sizes; ++i )
	{
		if ( !( size[i] > s->slack ) )
		{
			return false;
		}
		out->size[i] = lwi_round_down( size[i] - s->slack );
	}
	return sizes > 0;
}

/// How far a point is outside of a box or cylinder, at most 0 inside.
static double depth_at( const lwi_primitive* primitive, const float p[3] )
{
	const double x = fabs( p[0] ) - primitive->size[0], y = fabs( p[1] ) - primitive->size[1];
	if ( primitive->type == LW_SHAPE_BOX )
	{
		return lwi_larger( lwi_larger( x, y ), fabs( p[2] ) - primitive->size[2] );
	}
	return lwi_larger( sqrt( (double)p[0] * p[0] + (double)p[1] * p[1] ) - primitive->size[0],
		fabs( p[2] ) - primitive->size[1] );
}

/// The deepest of eight of a mesh's extreme points, some of which are inside. False: none of all is
static bool find_inside( const lwi_searching* s, const lw_shape* mesh, const lwi_motion* motion, const lwi_primitive* inner,
	float out[3] )
{
	uint32_t block = 0;
	while ( block < mesh->extreme_blocks && !s->kernels->points_inside( &mesh->extreme_points[block], 1, motion, inner ) )
	{
		++block;
	}
	double deepest = INFINITY;
	for ( uint32_t lane = 0; block < mesh->extreme_blocks && lane < LWI_WIDTH; ++lane )
	{
		const lwi_points8* points = &mesh->extreme_points[block];
		const float p[3] = { points->at[0][lane], points->at[1][lane], points->at[2][lane] };
		float moved[3];
		lwi_move_center( motion, p, moved );
		const double depth = depth_at( inner, moved );
		if ( depth < deepest )
		{
			deepest = depth;
			memcpy( out, p, sizeof( p ) );
		}
	}
	return deepest < INFINITY;
}

/// The triangle that has a corner with exactly these numbers in its tree, and the corner as it was given. LW_INVALID_INDEX: none
static uint32_t triangle_at( const lwi_searching* s, const lw_shape* mesh, const float at[3], lw_vec3* corner )
{
	const float sphere[4] = { at[0], at[1], at[2], 0 }, limit = lwi_round_up( s->slack );
	float gap[LWI_WIDTH];
	lwi_ref stack[( LWI_WIDTH - 1 ) * ( LWI_MAX_DEPTH + 1 ) + LWI_WIDTH];
	uint32_t height = 1;
	stack[0] = mesh->root;
	while ( height > 0 )
	{
		const lwi_ref ref = stack[--height];
		if ( !lwi_ref_is_leaf( ref ) )
		{
			const lwi_node* node = &mesh->nodes[ref];
			uint32_t near = s->kernels->sphere_gap( node->x, sphere, limit, gap );
			for ( ; near != 0; near &= near - 1 )
			{
				stack[height++] = node->child[lwi_lowest_bit( near )];
			}
			continue;
		}
		const lwi_leaf* leaf = &mesh->leaves[lwi_ref_index( ref )];
		for ( uint32_t i = 0; i < 3 * lwi_ref_count( ref ); ++i )
		{
			const uint32_t lane = i / 3, k = i % 3;
			if ( leaf->v[k][0][lane] == at[0] && leaf->v[k][1][lane] == at[1] && leaf->v[k][2][lane] == at[2] )
			{
				lw_vec3 corners[3];
				lwi_load_corners( mesh, leaf->triangle[lane], corners );
				*corner = corners[k];
				return leaf->triangle[lane];
			}
		}
	}
	return LW_INVALID_INDEX;
}

bool lwi_search_vertices( lwi_searching* s )
{
	const bool solid_is_a = s->a->primitive;
	const lw_shape *solid = solid_is_a ? s->a : s->b, *mesh = solid_is_a ? s->b : s->a;
	lwi_primitive inner;
	float at[3] = { 0, 0, 0 };
	lw_vec3 corner;
	if ( !lwi_asks_yes_or_no( s->bound ) || !s->memory->def.planes || mesh->family != LWI_TRIANGLES ||
		 !inner_of( s, solid, &inner ) || !find_inside( s, mesh, &s->from_other[solid_is_a ? LWI_A : LWI_B], &inner, at ) )
	{
		return false;
	}
	const uint32_t item = triangle_at( s, mesh, at, &corner );
	if ( item == LW_INVALID_INDEX )
	{
		return false;
	}
	const lw_vec3 p = solid_is_a ? lwi_transform( s->a_from_b, corner ) : corner;
	s->memory->stats.exact_tests++;
	lwi_offer_pieces( s->bound, 0, 0, 0, 0, p, p, solid_is_a ? LW_INVALID_INDEX : item,
		solid_is_a ? item : LW_INVALID_INDEX );
	return true;
}
