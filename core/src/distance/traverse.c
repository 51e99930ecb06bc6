// SPDX-License-Identifier: BSD-3-Clause
// Branch and bound over two sphere trees, or over one and a primitive, with the range built in.
// Papers: S. Quinlan, "Efficient distance computation between non-convex objects", ICRA 1994;
//   K. Steinbach, J. Kuffner, T. Asfour, R. Dillmann, "Efficient collision and self-collision detection for humanoids based
//   on sphere trees hierarchies", Humanoids 2006 (range bounds, transform caching).
// Floats filter, doubles decide: nodes and triangle pairs are dropped by float gaps plus their stated slack
// (simd/kernels.h); whatever becomes a result is measured in double from the original vertices.
#include "distance/pair_query.h"

// --- tree against tree -----------------------------------------------------------------------------------------------

/// The box around a subtree, its centre and axes moved; of a root only its sphere. Filled in place, and of a root from numbers that are in
/// memory: to copy a structure that was just written in parts takes longer than the test that it is for.
static void obb_of( const lw_shape* shape, uint32_t place, const lwi_motion* motion, const float sphere[4], lwi_obb* out )
{
	static const float own[3][3] = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };
	memcpy( out->center, sphere, 3 * sizeof( float ) );
	out->radius = sphere[3];
	if ( place == LW_INVALID_INDEX )
	{
		memcpy( out->axis, own, sizeof( own ) );
		for ( int i = 0; i < 3; ++i )
		{
			out->low[i] = -sphere[3];
			out->high[i] = sphere[3];
		}
		return;
	}
	const lwi_obb8* obbs = &shape->obbs[place / LWI_WIDTH];
	uint32_t lane = place % LWI_WIDTH;
	for ( int i = 0; i < 3; ++i )
	{
		const float* row = motion->r + 3 * i;
		out->axis[0][i] = row[0] * obbs->n[0][lane] + row[1] * obbs->n[1][lane] + row[2] * obbs->n[2][lane];
		out->axis[1][i] = row[0] * obbs->t[0][lane] + row[1] * obbs->t[1][lane] + row[2] * obbs->t[2][lane];
		out->low[i] = obbs->low[i][lane];
		out->high[i] = obbs->high[i][lane];
	}
	lwi_third_axis( out->axis[0], out->axis[1], out->axis[2] );
}

/// Replaces one side by its children, or some of them; the nearest ends on top of the stack. Returns the new stack height.
/// @param e may be the entry at `height`, which was taken from the stack
static inline uint32_t open_side( lwi_searching* s, lwi_entry* e, int side, uint32_t lanes_to_open, uint32_t height )
{
	const lw_shape* shape = lwi_shape_of( s, side );
	const lwi_ref ref = e->side[side].ref;
	const lwi_node* node = &shape->nodes[ref];
	float sphere[4], gap[LWI_WIDTH];
	lwi_other_sphere( s, e, side, sphere );
	uint32_t mask = s->kernels->sphere_gap( node->x, sphere, s->limit, gap ) & lanes_to_open;
	s->memory->stats.node_tests++;
	uint32_t part = LW_INVALID_INDEX;
	if ( s->front != NULL )
	{
		part = lwi_front_add( s->front, e->side[LWI_A].obb, e->side[LWI_B].obb, side == LWI_B ? LWI_FRONT_SIDE : 0 );
		lwi_front_drop( s->front, part, lanes_to_open & ~mask, gap );
	}
	if ( mask != 0 && s->obbs )
	{
		const uint32_t left = mask;
		lwi_obb other;
		obb_of( lwi_shape_of( s, 1 - side ), e->side[1 - side].obb, &s->from_other[side], sphere, &other );
		const float* d = s->direction[side];
		const float sign = side == LWI_A ? 1.0f : -1.0f, along[3] = { sign * d[0], sign * d[1], sign * d[2] };
		mask &= s->kernels->obb_gap( node, &shape->obbs[ref], &other, s->has_direction ? along : NULL, s->limit, gap );
		if ( s->front != NULL )
		{
			lwi_front_drop( s->front, part, left & ~mask, gap );
		}
	}
	uint32_t lanes[LWI_WIDTH];
	uint32_t count = lwi_sorted_lanes( gap, mask, lanes );
	lwi_entry* stack = &s->memory->stack[height];
	for ( uint32_t i = 0; i < count; ++i ) // the farthest last: its place may be that of the entry
	{
		const uint32_t lane = lanes[i];
		lwi_entry* child = stack + ( count - 1 - i );
		if ( child != e )
		{
			*child = *e;
		}
		child->gap = gap[lane];
		child->part = part;
		child->side[side].ref = node->child[lane];
		child->side[side].obb = ref * LWI_WIDTH + lane;
		child->side[side].center[0] = node->x[lane];
		child->side[side].center[1] = node->y[lane];
		child->side[side].center[2] = node->z[lane];
		child->side[side].radius = node->r[lane];
	}
	return height + count;
}

/// Sphere of the inner side against the real items of the leaf side: far tighter than the leaf's own sphere where triangles
/// are large. True if nothing of the pair can be below the limit.
static bool leaf_side_rules_out( lwi_searching* s, lwi_entry* e )
{
	const int leaf = lwi_ref_is_leaf( e->side[LWI_A].ref ) ? LWI_A : LWI_B;
	float sphere[4], gap[LWI_WIDTH], direction[3][LWI_WIDTH];
	lwi_other_sphere( s, e, leaf, sphere );
	if ( lwi_leaf_mask( s, lwi_shape_of( s, leaf ), e->side[leaf].ref, sphere, gap, direction ) != 0 )
	{
		return false;
	}
	if ( s->front != NULL )
	{
		const uint32_t part = lwi_front_add( s->front, e->side[LWI_A].obb, e->side[LWI_B].obb, LWI_FRONT_WHOLE );
		lwi_front_note_lanes( s->front, part, lwi_low_bits( lwi_ref_count( e->side[leaf].ref ) ), gap );
	}
	return true;
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
	root->part = LW_INVALID_INDEX;
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
	uint32_t part = LW_INVALID_INDEX;
	if ( s->front != NULL )
	{
		part = lwi_front_add( s->front, e->side[LWI_A].obb, e->side[LWI_B].obb, LWI_FRONT_WHOLE );
	}
	lwi_compare_leaves( s, e, part );
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

/// An entry that was left when the limit fell below its gap.
static void drop_entry( lwi_front* front, const lwi_entry* e )
{
	if ( e->part == LW_INVALID_INDEX )
	{
		lwi_front_note( front, lwi_front_add( front, e->side[LWI_A].obb, e->side[LWI_B].obb, LWI_FRONT_WHOLE ), e->gap );
		return;
	}
	const int side = ( front->parts[e->part].lanes & LWI_FRONT_SIDE ) != 0 ? LWI_B : LWI_A;
	front->parts[e->part].lanes |= 1u << ( e->side[side].obb % LWI_WIDTH );
	lwi_front_note( front, e->part, e->gap );
}

typedef enum walk_end
{
	WALK_ENDED, ///< nothing is left, or the bound is done
	WALK_RULED_OUT,
	WALK_LOOKED
} walk_end;

/// The walk without the batch that is left at its end.
static walk_end walk_entries( lwi_searching* s, lwi_walk* walk, bool look )
{
	lwi_search_memory* memory = s->memory;
	const uint64_t measured = memory->stats.exact_tests;
	while ( walk->height > walk->bottom && !s->bound->done )
	{
		if ( look && ( memory->stats.exact_tests != measured || walk->leaves >= LEAVES_OF_A_LOOK ) )
		{
			return WALK_LOOKED;
		}
		lwi_entry* e = &memory->stack[--walk->height]; // in its place: a copy would wait for what wrote it
		if ( e->gap >= s->limit )
		{
			if ( s->front != NULL )
			{
				drop_entry( s->front, e );
			}
			continue;
		}
		const lwi_subtree *a = &e->side[LWI_A], *b = &e->side[LWI_B];
		bool leaf_a = lwi_ref_is_leaf( a->ref ), leaf_b = lwi_ref_is_leaf( b->ref );
		if ( leaf_a && leaf_b )
		{
			if ( meet_leaves( s, e, walk ) )
			{
				memory->batch.count = 0; // none of the pairs that wait can be below the limit
				return WALK_RULED_OUT;
			}
			continue;
		}
		// a leaf much larger than the node it faces is a poor sphere: test its triangles first
		if ( leaf_a != leaf_b && ( leaf_a ? 2 * a->radius > b->radius : 2 * b->radius > a->radius ) &&
			 leaf_side_rules_out( s, e ) )
		{
			continue;
		}
		const int side = !leaf_b && ( leaf_a || b->radius >= a->radius ) ? LWI_B : LWI_A;
		walk->height = open_side( s, e, side, LWI_FRONT_LANES, walk->height );
	}
	return WALK_ENDED;
}

/// The end of a walk, of which nothing is left. @param end not WALK_LOOKED
static void end_walk( lwi_searching* s, walk_end end )
{
	if ( end == WALK_ENDED && !s->bound->done )
	{
		lwi_flush_batch( s );
	}
	if ( s->front != NULL && ( end == WALK_RULED_OUT || s->bound->done ) )
	{
		s->front->whole = false;
	}
}

bool lwi_walk_trees( lwi_searching* s, lwi_walk* walk, bool look )
{
	const walk_end end = walk_entries( s, walk, look );
	if ( end == WALK_LOOKED )
	{
		lwi_flush_batch( s );
		return false;
	}
	end_walk( s, end );
	return true;
}

/// A subtree by its place.
static lwi_subtree subtree_at( const lw_shape* shape, uint32_t place )
{
	if ( place == LW_INVALID_INDEX )
	{
		const float* sphere = shape->root_sphere;
		return ( lwi_subtree ){ shape->root, place, { sphere[0], sphere[1], sphere[2] }, sphere[3] };
	}
	const lwi_node* node = &shape->nodes[place / LWI_WIDTH];
	const uint32_t lane = place % LWI_WIDTH;
	return ( lwi_subtree ){ node->child[lane], place, { node->x[lane], node->y[lane], node->z[lane] }, node->r[lane] };
}

/// True if a part of the last front is still farther than the limit; it then is one of this front too.
static bool stays_dropped( lwi_searching* s, const lwi_front_part* part )
{
	if ( ( part->lanes & ~(uint32_t)LWI_FRONT_SIDE ) == 0 )
	{
		return true; // nothing of it was dropped
	}
	if ( !( (double)part->apart - s->front->moved >= (double)s->limit ) )
	{
		return false;
	}
	const uint32_t copy = lwi_front_add( s->front, part->place[LWI_A], part->place[LWI_B], part->lanes );
	s->front->parts[copy].apart = part->apart;
	return true;
}

void lwi_walk_front( lwi_searching* s, lwi_walk* walk )
{
	walk->height = walk->bottom;
	walk->bounded = false; // a plane has been looked for
	walk_end end = WALK_ENDED;
	for ( uint32_t i = 0; i < s->front->old_count && end == WALK_ENDED && !s->bound->done; ++i )
	{
		const lwi_front_part* part = &s->front->old[i];
		if ( stays_dropped( s, part ) )
		{
			continue;
		}
		lwi_entry e = { .gap = -INFINITY,
			.side = { subtree_at( s->a, part->place[LWI_A] ), subtree_at( s->b, part->place[LWI_B] ) },
			.moved_side = LW_INVALID_INDEX,
			.part = LW_INVALID_INDEX };
		if ( ( part->lanes & LWI_FRONT_PAIR ) != 0 )
		{
			lwi_compare_again( s, &e, part->lanes / LWI_WIDTH % LWI_WIDTH, part->lanes % LWI_WIDTH );
			continue;
		}
		if ( ( part->lanes & LWI_FRONT_WHOLE ) != 0 )
		{
			s->memory->stack[walk->height++] = e;
			for ( ; i + 1 < s->front->old_count && ( s->front->old[i + 1].lanes & LWI_FRONT_PAIR ) != 0; ++i )
			{
			}
		}
		else
		{
			const int side = ( part->lanes & LWI_FRONT_SIDE ) != 0 ? LWI_B : LWI_A;
			walk->height = open_side( s, &e, side, part->lanes % LWI_FRONT_SIDE, walk->height );
		}
		end = walk_entries( s, walk, false );
	}
	end_walk( s, end );
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

/// A search of one tree for what is near a primitive.
typedef struct primitive_walk
{
	lwi_searching* s;
	const lw_shape* tree;
	bool primitive_is_a, mesh, plane_is_open;
	lwi_primitive primitive;
	lwi_slab_backoff backoff;
	uint32_t measured, bottom, height;
} primitive_walk;

static primitive_walk begin_primitive( lwi_searching* s )
{
	const bool primitive_is_a = s->a->primitive;
	const lw_shape* primitive = primitive_is_a ? s->a : s->b;
	const lwi_convex convex = lwi_convex_of_primitive( primitive );
	const bool planes = primitive->family == LWI_CONVEX && s->memory->def.planes;
	const uint32_t bottom = s->memory->stack_bottom;
	primitive_walk w = { .s = s,
		.tree = primitive_is_a ? s->b : s->a,
		.primitive_is_a = primitive_is_a,
		.plane_is_open = s->limit < INFINITY && planes,
		.primitive = { primitive->type,
			{ lwi_round_up( convex.size[0] ), lwi_round_up( convex.size[1] ), lwi_round_up( convex.size[2] ) } },
		.backoff = { INFINITY, UINT32_MAX },
		.bottom = bottom,
		.height = bottom };
	w.mesh = planes && w.tree->family == LWI_TRIANGLES;
	return w;
}

/// Measures an item of the tree, with its gap. Of the front the item is a part of its own, since its distance is known better.
static void measure_item( primitive_walk* w, uint32_t place, uint32_t lane, lwi_ref ref, float gap )
{
	lwi_searching* s = w->s;
	const uint32_t item = lwi_leaf_item( w->tree, ref, lane );
	const double floor = s->bound->floor;
	s->bound->floor = INFINITY;
	lwi_measure_items( s, w->primitive_is_a ? LW_INVALID_INDEX : item, w->primitive_is_a ? item : LW_INVALID_INDEX );
	if ( s->front != NULL )
	{
		const uint32_t part = lwi_front_add( s->front, place, LW_INVALID_INDEX, 1u << lane );
		// without a measurement it shares the corner of a distance known before
		const double core = s->bound->floor < INFINITY ? s->bound->floor + s->radii : s->shared.distance - s->error;
		const float distance = lwi_round_down( core );
		lwi_front_note( s->front, part, distance > gap ? distance : gap );
	}
	s->bound->floor = floor < s->bound->floor ? floor : s->bound->floor;
}

/// Lanes of a leaf. True if no remaining item can be below the limit.
static bool open_leaf( primitive_walk* w, const lwi_entry* e, uint32_t lanes_to_open )
{
	lwi_searching* s = w->s;
	const lwi_motion* motion = &s->from_other[w->primitive_is_a ? LWI_A : LWI_B];
	const lwi_ref ref = e->side[LWI_A].ref;
	if ( ( lanes_to_open & ( lanes_to_open - 1 ) ) == 0 ) // an item of a front: its gap would not spare it
	{
		measure_item( w, e->side[LWI_A].obb, lwi_lowest_bit( lanes_to_open ), ref, -INFINITY );
		return false;
	}
	float gap[LWI_WIDTH];
	uint32_t lanes[LWI_WIDTH];
	const uint32_t mask = primitive_leaf_mask( s, w->tree, ref, motion, &w->primitive, gap ) & lanes_to_open;
	s->memory->stats.leaf_tests++;
	if ( mask != 0 && w->plane_is_open && lwi_plane_rules_out( s ) ) // before anything is measured: that costs as much
	{
		return true;
	}
	w->plane_is_open = w->plane_is_open && mask == 0;
	uint32_t part = LW_INVALID_INDEX;
	if ( s->front != NULL )
	{
		part = lwi_front_add( s->front, e->side[LWI_A].obb, LW_INVALID_INDEX, 0 );
		lwi_front_drop( s->front, part, lwi_low_bits( lwi_ref_count( ref ) ) & lanes_to_open & ~mask, gap );
	}
	const uint32_t count = lwi_sorted_lanes( gap, mask, lanes );
	for ( uint32_t i = 0; i < count && !s->bound->done; ++i )
	{
		if ( !( gap[lanes[i]] >= s->limit ) )
		{
			if ( w->mesh && witness_rules_out( s, w->measured++, &w->backoff ) )
			{
				return true;
			}
			measure_item( w, e->side[LWI_A].obb, lanes[i], ref, gap[lanes[i]] );
		}
		else if ( s->front != NULL )
		{
			lwi_front_drop( s->front, part, 1u << lanes[i], gap );
		}
	}
	return false;
}

/// Lanes of a node; the nearest ends on top of the stack.
static void open_node( primitive_walk* w, const lwi_entry* e, uint32_t lanes_to_open )
{
	lwi_searching* s = w->s;
	const lwi_motion* motion = &s->from_other[w->primitive_is_a ? LWI_A : LWI_B];
	const uint32_t index = e->side[LWI_A].ref;
	const lwi_node* node = &w->tree->nodes[index];
	float gap[LWI_WIDTH];
	uint32_t lanes[LWI_WIDTH];
	const uint32_t mask = s->kernels->node_primitive_gap( node, motion, &w->primitive, s->limit, gap ) & lanes_to_open;
	s->memory->stats.node_tests++;
	uint32_t part = LW_INVALID_INDEX;
	if ( s->front != NULL )
	{
		part = lwi_front_add( s->front, e->side[LWI_A].obb, LW_INVALID_INDEX, 0 );
		lwi_front_drop( s->front, part, lanes_to_open & ~mask, gap );
	}
	for ( uint32_t i = lwi_sorted_lanes( gap, mask, lanes ); i-- > 0; )
	{
		lwi_entry* child = &s->memory->stack[w->height++];
		child->side[LWI_A].ref = node->child[lanes[i]];
		child->side[LWI_A].obb = index * LWI_WIDTH + lanes[i];
		child->gap = gap[lanes[i]];
		child->part = part;
	}
}

/// Some lanes of one subtree. False if no remaining item can be below the limit.
static bool open_subtree( primitive_walk* w, const lwi_entry* e, uint32_t lanes )
{
	if ( lwi_ref_is_leaf( e->side[LWI_A].ref ) )
	{
		return !open_leaf( w, e, lanes );
	}
	open_node( w, e, lanes );
	return true;
}

static bool walk_primitive( primitive_walk* w )
{
	lwi_searching* s = w->s;
	while ( w->height > w->bottom && !s->bound->done )
	{
		const lwi_entry* e = &s->memory->stack[--w->height]; // its children take its place when it has been read
		if ( !( e->gap >= s->limit ) )
		{
			if ( !open_subtree( w, e, LWI_FRONT_LANES ) )
			{
				return false;
			}
		}
		else if ( s->front != NULL )
		{
			drop_entry( s->front, e );
		}
	}
	return true;
}

void lwi_search_primitive( lwi_searching* s )
{
	primitive_walk w = begin_primitive( s );
	bool open = true;
	lwi_entry e;
	memset( &e, 0, sizeof( e ) );
	e.part = LW_INVALID_INDEX;
	if ( s->front == NULL || s->front->old_count == 0 )
	{
		e.side[LWI_A] = subtree_at( w.tree, LW_INVALID_INDEX ); // of both sides only this one is used
		open = open_subtree( &w, &e, LWI_FRONT_LANES ) && walk_primitive( &w );
	}
	else
	{
		w.plane_is_open = false; // one has been looked for
		for ( uint32_t i = 0; i < s->front->old_count && open && !s->bound->done; ++i )
		{
			const lwi_front_part* part = &s->front->old[i];
			if ( !stays_dropped( s, part ) )
			{
				e.side[LWI_A] = subtree_at( w.tree, part->place[0] );
				open = open_subtree( &w, &e, part->lanes % LWI_FRONT_SIDE ) && walk_primitive( &w );
			}
		}
	}
	if ( s->front != NULL && ( !open || s->bound->done ) )
	{
		s->front->whole = false;
	}
}
