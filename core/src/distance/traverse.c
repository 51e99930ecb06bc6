// SPDX-License-Identifier: BSD-3-Clause
// Branch and bound over two sphere trees, or over one and a primitive, with the range built in.
// Papers: S. Quinlan, "Efficient distance computation between non-convex objects", ICRA 1994;
//   K. Steinbach, J. Kuffner, T. Asfour, R. Dillmann, "Efficient collision and self-collision detection for humanoids based
//   on sphere trees hierarchies", Humanoids 2006 (range bounds, transform caching).
// Floats filter, doubles decide: nodes and triangle pairs are dropped by float gaps plus their stated slack
// (simd/kernels.h); whatever becomes a result is measured in double from the original vertices.
#include "distance/pair_query.h"

// --- tree against tree -----------------------------------------------------------------------------------------------

/// The box around a subtree, its centre and axes moved; of a root only its sphere.
static lwi_obb obb_of( const lw_shape* shape, uint32_t place, const lwi_motion* motion, const float sphere[4] )
{
	lwi_obb out = { .center = { sphere[0], sphere[1], sphere[2] }, .radius = sphere[3] };
	float r = sphere[3];
	if ( place == LW_INVALID_INDEX )
	{
		const lwi_obb cube = { .axis = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } },
			.low = { -r, -r, -r },
			.high = { r, r, r } };
		memcpy( out.axis, cube.axis, sizeof( out.axis ) );
		memcpy( out.low, cube.low, sizeof( out.low ) );
		memcpy( out.high, cube.high, sizeof( out.high ) );
		return out;
	}
	const lwi_obb8* obbs = &shape->obbs[place / LWI_WIDTH];
	uint32_t lane = place % LWI_WIDTH;
	for ( int i = 0; i < 3; ++i )
	{
		const float* row = motion->r + 3 * i;
		out.axis[0][i] = row[0] * obbs->n[0][lane] + row[1] * obbs->n[1][lane] + row[2] * obbs->n[2][lane];
		out.axis[1][i] = row[0] * obbs->t[0][lane] + row[1] * obbs->t[1][lane] + row[2] * obbs->t[2][lane];
		out.low[i] = obbs->low[i][lane];
		out.high[i] = obbs->high[i][lane];
	}
	lwi_third_axis( out.axis[0], out.axis[1], out.axis[2] );
	return out;
}

/// Replaces one side by its children; the nearest ends on top of the stack. Returns the new stack height.
static inline uint32_t open_side( lwi_searching* s, lwi_entry* e, int side, uint32_t height )
{
	const lw_shape* shape = lwi_shape_of( s, side );
	const lwi_ref ref = e->side[side].ref;
	const lwi_node* node = &shape->nodes[ref];
	float sphere[4], gap[LWI_WIDTH];
	lwi_other_sphere( s, e, side, sphere );
	uint32_t mask = s->kernels->sphere_gap( node->x, sphere, s->limit, gap );
	s->memory->stats.node_tests++;
	if ( mask != 0 && s->obbs )
	{
		lwi_obb other = obb_of( lwi_shape_of( s, 1 - side ), e->side[1 - side].obb, &s->from_other[side], sphere );
		const float* d = s->direction[side];
		const float sign = side == LWI_A ? 1.0f : -1.0f, along[3] = { sign * d[0], sign * d[1], sign * d[2] };
		mask &= s->kernels->obb_gap( node, &shape->obbs[ref], &other, s->has_direction ? along : NULL, s->limit, gap );
	}
	uint32_t lanes[LWI_WIDTH];
	uint32_t count = lwi_sorted_lanes( gap, mask, lanes );
	for ( uint32_t i = count; i-- > 0; )
	{
		uint32_t lane = lanes[i];
		lwi_entry* child = &s->memory->stack[height++];
		*child = *e;
		child->gap = gap[lane];
		child->side[side] = ( lwi_subtree ){ .ref = node->child[lane],
			.obb = ref * LWI_WIDTH + lane,
			.center = { node->x[lane], node->y[lane], node->z[lane] },
			.radius = node->r[lane] };
	}
	return height;
}

/// Sphere of the inner side against the real items of the leaf side: far tighter than the leaf's own sphere where triangles
/// are large. True if nothing of the pair can be below the limit.
static bool leaf_side_rules_out( lwi_searching* s, lwi_entry* e )
{
	const int leaf = lwi_ref_is_leaf( e->side[LWI_A].ref ) ? LWI_A : LWI_B;
	float sphere[4], gap[LWI_WIDTH], direction[3][LWI_WIDTH];
	lwi_other_sphere( s, e, leaf, sphere );
	return lwi_leaf_mask( s, lwi_shape_of( s, leaf ), e->side[leaf].ref, sphere, gap, direction ) == 0;
}

enum
{
	BEFORE_WITNESS = 192, ///< comparisons without a nearer pair: large faces that face each other. Why so late: distance.md
	WITNESS_LEAVES = 64   ///< leaves that it may visit per comparison so far: few where it fails
};

/// @param compared leaves against leaves, or triangles against a primitive, so far
static bool witness_rules_out( lwi_searching* s, uint32_t compared, lwi_slab_backoff* backoff )
{
	if ( s->bound->upper != backoff->upper )
	{
		*backoff = ( lwi_slab_backoff ){ s->bound->upper, compared + BEFORE_WITNESS };
	}
	if ( compared < backoff->next )
	{
		return false;
	}
	uint32_t budget = WITNESS_LEAVES * compared;
	bool proved = lwi_witness_proves( s, &budget );
	backoff->next = budget == 0 ? 2 * compared : UINT32_MAX;
	return proved;
}

enum
{
	LEAVES_BEFORE_PLANE = 1,      ///< comparisons of leaves before the first search for a plane: most searches end without
	LEAVES_BEFORE_LATE_PLANE = 2, ///< and again when a suspended search resumes: many end at once
	LEAVES_OF_A_LOOK = 4,         ///< comparisons after which a first pass is over even if nothing was measured
	LEAVES_BEFORE_LEAST = 8,      ///< comparisons after which the entry with the least gap is next, wherever it is
};

lwi_walk lwi_walk_begin( lwi_searching* s )
{
	lwi_search_memory* memory = s->memory;
	lwi_walk walk = { .bottom = memory->stack_bottom,
		.height = memory->stack_bottom + 1,
		.bounded = s->limit < INFINITY,
		.backoff = { INFINITY, UINT32_MAX } };
	lwi_entry* root = &memory->stack[walk.bottom];
	root->gap = 0;
	for ( int side = LWI_A; side <= LWI_B; ++side )
	{
		const lw_shape* shape = lwi_shape_of( s, side );
		const float* sphere = shape->root_sphere;
		root->side[side] = ( lwi_subtree ){ .ref = shape->root,
			.obb = LW_INVALID_INDEX,
			.center = { sphere[0], sphere[1], sphere[2] },
			.radius = sphere[3] };
	}
	root->moved_side = LW_INVALID_INDEX;
	s->obbs = s->a->family == LWI_TRIANGLES && s->b->family == LWI_TRIANGLES;
	s->guess_gap = INFINITY;
	if ( s->bound->upper < INFINITY && s->bound->pair == s->bound->current_pair )
	{
		lwi_set_direction( s, s->bound->point_a, s->bound->point_b );
		s->guess_gap = -INFINITY;
	}
	memory->batch.count = 0;
	return walk;
}

/// Depth first, a search stays near its start, which may be far from the nearest pair: a ring around a shaft is almost as
/// near everywhere. So now and then the entry with the least gap is taken. The path of that entry needs room of its own.
static void take_least( lwi_searching* s, lwi_walk* walk )
{
	lwi_entry* stack = s->memory->stack;
	if ( walk->height < walk->bottom + 2 || walk->height > LWI_STACK_SIZE - LWI_STACK_PATH )
	{
		return;
	}
	uint32_t top = walk->height - 1, least = top;
	for ( uint32_t i = top; i-- > walk->bottom; )
	{
		least = stack[i].gap < stack[least].gap ? i : least;
	}
	if ( least != top )
	{
		lwi_entry taken = stack[least];
		stack[least] = stack[top];
		stack[top] = taken;
	}
}

/// Two leaves. True if no remaining pair can be below the limit.
static bool meet_leaves( lwi_searching* s, lwi_entry* e, lwi_walk* walk )
{
	const bool planes = s->memory->def.planes;
	if ( ++walk->leaves == LEAVES_BEFORE_PLANE && walk->bounded && planes && lwi_plane_rules_out( s ) )
	{
		return true;
	}
	if ( walk->leaves == walk->late_plane && lwi_plane_rules_out_late( s ) )
	{
		return true;
	}
	if ( s->obbs && planes && witness_rules_out( s, walk->leaves, &walk->backoff ) )
	{
		return true;
	}
	lwi_compare_leaves( s, e );
	if ( walk->leaves % LEAVES_BEFORE_LEAST == 0 )
	{
		take_least( s, walk );
	}
	return false;
}

void lwi_walk_again( lwi_walk* walk )
{
	walk->late_plane = walk->leaves + LEAVES_BEFORE_LATE_PLANE;
}

bool lwi_walk_trees( lwi_searching* s, lwi_walk* walk, bool look )
{
	lwi_search_memory* memory = s->memory;
	const uint64_t measured = memory->stats.exact_tests;
	while ( walk->height > walk->bottom && !s->bound->done )
	{
		if ( look && ( memory->stats.exact_tests != measured || walk->leaves >= LEAVES_OF_A_LOOK ) )
		{
			lwi_flush_batch( s );
			return false;
		}
		lwi_entry e = memory->stack[--walk->height];
		if ( e.gap >= s->limit )
		{
			continue;
		}
		const lwi_subtree *a = &e.side[LWI_A], *b = &e.side[LWI_B];
		bool leaf_a = lwi_ref_is_leaf( a->ref ), leaf_b = lwi_ref_is_leaf( b->ref );
		if ( leaf_a && leaf_b )
		{
			if ( meet_leaves( s, &e, walk ) )
			{
				memory->batch.count = 0; // none of the pairs that wait can be below the limit
				return true;
			}
			continue;
		}
		// a leaf much larger than the node it faces is a poor sphere: test its triangles first
		if ( leaf_a != leaf_b && ( leaf_a ? 2 * a->radius > b->radius : 2 * b->radius > a->radius ) &&
			 leaf_side_rules_out( s, &e ) )
		{
			continue;
		}
		walk->height = !leaf_b && ( leaf_a || b->radius >= a->radius ) ? open_side( s, &e, LWI_B, walk->height )
																	   : open_side( s, &e, LWI_A, walk->height );
	}
	if ( !s->bound->done )
	{
		lwi_flush_batch( s );
	}
	return true;
}

// --- tree against primitive ----------------------------------------------------------------------------------------------

/// Items of a leaf that are near a primitive.
static uint32_t primitive_leaf_mask( const lwi_searching* s, const lw_shape* tree, lwi_ref ref, const lwi_motion* motion,
	const lwi_primitive* primitive, float gap[LWI_WIDTH] )
{
	uint32_t index = lwi_ref_index( ref ), real = lwi_low_bits( lwi_ref_count( ref ) );
	if ( tree->family == LWI_TRIANGLES )
	{
		return s->kernels->leaf_primitive_gap( &tree->leaves[index], motion, primitive, s->limit, gap ) & real;
	}
	lwi_node spheres;
	if ( tree->family == LWI_BOXES )
	{
		lwi_box_leaf_spheres( &tree->box_leaves[index], &spheres );
	}
	const lwi_node* node = tree->family == LWI_BALLS ? &tree->ball_leaves[index] : &spheres;
	return s->kernels->node_primitive_gap( node, motion, primitive, s->limit, gap ) & real;
}

void lwi_search_primitive( lwi_searching* s )
{
	lwi_search_memory* memory = s->memory;
	bool primitive_is_a = s->a->primitive;
	const lw_shape* tree = primitive_is_a ? s->b : s->a;
	const lw_shape* primitive_shape = primitive_is_a ? s->a : s->b;
	lwi_convex convex = lwi_convex_of_primitive( primitive_shape );
	lwi_primitive primitive = { primitive_shape->type,
		{ lwi_round_up( convex.size[0] ), lwi_round_up( convex.size[1] ), lwi_round_up( convex.size[2] ) } };
	const lwi_motion* motion = &s->from_other[primitive_is_a ? LWI_A : LWI_B];
	lwi_entry root;
	memset( &root, 0, sizeof( root ) );
	root.side[LWI_A].ref = tree->root; // of both sides only this one is used
	const uint32_t bottom = memory->stack_bottom;
	memory->stack[bottom] = root;
	bool convex_primitive = primitive_shape->family == LWI_CONVEX && memory->def.planes;
	bool plane_is_open = s->limit < INFINITY && convex_primitive;
	bool mesh = convex_primitive && tree->family == LWI_TRIANGLES;
	lwi_slab_backoff backoff = { INFINITY, UINT32_MAX };
	uint32_t measured = 0;
	uint32_t height = bottom + 1;
	while ( height > bottom && !s->bound->done )
	{
		lwi_entry e = memory->stack[--height];
		if ( e.gap >= s->limit )
		{
			continue;
		}
		float gap[LWI_WIDTH];
		uint32_t lanes[LWI_WIDTH];
		if ( lwi_ref_is_leaf( e.side[LWI_A].ref ) )
		{
			uint32_t mask = primitive_leaf_mask( s, tree, e.side[LWI_A].ref, motion, &primitive, gap );
			memory->stats.leaf_tests++;
			if ( mask != 0 && plane_is_open && lwi_plane_rules_out( s ) ) // before anything is measured: that costs as much
			{
				return;
			}
			plane_is_open = plane_is_open && mask == 0;
			uint32_t count = lwi_sorted_lanes( gap, mask, lanes );
			for ( uint32_t i = 0; i < count && !s->bound->done; ++i )
			{
				if ( !( gap[lanes[i]] >= s->limit ) )
				{
					if ( mesh && witness_rules_out( s, measured++, &backoff ) )
					{
						return;
					}
					uint32_t item = lwi_leaf_item( tree, e.side[LWI_A].ref, lanes[i] );
					lwi_measure_items( s, primitive_is_a ? LW_INVALID_INDEX : item,
						primitive_is_a ? item : LW_INVALID_INDEX );
				}
			}
			continue;
		}
		const lwi_node* node = &tree->nodes[e.side[LWI_A].ref];
		uint32_t mask = s->kernels->node_primitive_gap( node, motion, &primitive, s->limit, gap );
		memory->stats.node_tests++;
		for ( uint32_t i = lwi_sorted_lanes( gap, mask, lanes ); i-- > 0; )
		{
			lwi_entry* child = &memory->stack[height++];
			child->side[LWI_A].ref = node->child[lanes[i]];
			child->gap = gap[lanes[i]];
		}
	}
}
