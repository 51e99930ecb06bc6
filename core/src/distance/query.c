// SPDX-License-Identifier: BSD-3-Clause
// Branch and bound over two sphere trees with the range built in.
// Papers: S. Quinlan, "Efficient distance computation between non-convex objects", ICRA 1994;
//   K. Steinbach, J. Kuffner, T. Asfour, R. Dillmann, "Efficient collision and self-collision detection for humanoids based
//   on sphere trees hierarchies", Humanoids 2006 (range bounds, transform caching).
// Floats filter, doubles decide: nodes and triangle pairs are dropped by float gaps plus their stated slack
// (simd/kernels.h); whatever becomes a result is measured in double from the original vertices.
#include "distance/pair_query.h"
#include "distance/separation.h"

/// Largest entry of |r r^T - 1| of a rotation that is taken as it is: products of rounded sines and cosines.
#define ALREADY_ORTHONORMAL ( 8.0 * LWI_U64 )

bool lwi_range_is_valid( const lw_range* range )
{
	return range->min_d >= 0 && range->min_d < INFINITY && range->max_d > range->min_d && range->alpha >= 0 &&
		   range->alpha < 1;
}

void lwi_bound_init( lwi_bound* bound, const lw_range* range )
{
	memset( bound, 0, sizeof( *bound ) );
	bound->range = *range;
	bound->upper = INFINITY;
	bound->cutoff = range->max_d;
	bound->floor = INFINITY;
	bound->triangle_a = bound->triangle_b = bound->pair = bound->current_pair = LW_INVALID_INDEX;
}

/// The next double but one: far enough that taking `rounding` off again does not round back to v.
static double beyond( double v )
{
	return nextafter( nextafter( v, INFINITY ), INFINITY );
}

void lwi_bound_allow_rounding( lwi_bound* bound, double rounding, double stretch )
{
	bound->rounding = rounding - stretch * bound->lowest; // of a distance: margins are not stretched
	bound->stretch = stretch;
	bound->cutoff = beyond( bound->range.max_d * ( 1 + 2 * stretch ) + bound->rounding );
}

/// Lower bound of a clearance, given a lower bound v of the measured one.
static double less_rounding( const lwi_bound* bound, double v )
{
	return v - bound->rounding - bound->stretch * fabs( v );
}

bool lwi_bound_offer( lwi_bound* bound, double lower, double upper )
{
	// the margin is exact, the differences are rounded: lower by half a roundoff of their size, of which the distance's own
	// bound has room for its part
	lower = lower - bound->margin - 0x1p-52 * bound->margin;
	upper = upper - bound->margin;
	bound->floor = lower < bound->floor ? lower : bound->floor;
	bound->measured = upper < bound->measured ? upper : bound->measured;
	if ( !( upper < bound->upper && less_rounding( bound, lower ) < bound->range.max_d ) )
	{
		return false;
	}
	bound->upper = upper;
	bound->done = upper <= bound->range.min_d || ( upper > bound->give_up_above && upper < bound->give_up_below );
	// Within alpha of the best is good enough, but not at or below min_d while the best is above: the verdict needs that.
	double cutoff = ( 1 - bound->range.alpha ) * upper;
	double min_d = bound->range.min_d;
	double decisive = bound->rounding > 0 ? beyond( min_d * ( 1 + 2 * bound->stretch ) + bound->rounding ) : nextafter( min_d, INFINITY );
	decisive = decisive < upper ? decisive : upper;
	cutoff = cutoff > decisive ? cutoff : decisive;
	bound->cutoff = cutoff < bound->cutoff ? cutoff : bound->cutoff;
	bound->pair = bound->current_pair;
	return true;
}

lw_clearance lwi_bound_result( const lwi_bound* bound )
{
	lw_clearance out = lw_clearance_unknown();
	if ( bound->failed )
	{
		return out;
	}
	if ( bound->upper == INFINITY )
	{
		out.kind = LW_CLEARANCE_FAR;
		out.lower = bound->range.max_d;
		return out;
	}
	out.upper = bound->upper;
	out.lower = bound->lowest;
	if ( bound->done )
	{
		out.kind = bound->upper <= bound->range.min_d ? LW_CLEARANCE_VIOLATION : LW_CLEARANCE_UNDECIDED;
		return out;
	}
	double lower = less_rounding( bound, bound->floor < bound->cutoff ? bound->floor : bound->cutoff );
	if ( lower >= bound->range.max_d ) // of a pair that was beyond it by less than rounding
	{
		out = lw_clearance_unknown();
		out.kind = LW_CLEARANCE_FAR;
		out.lower = bound->range.max_d;
		return out;
	}
	out.lower = lower > out.lower ? lower : out.lower;
	out.kind = out.lower > bound->range.min_d ? LW_CLEARANCE_NEAR : LW_CLEARANCE_UNDECIDED;
	return out;
}

// --- tree against tree -----------------------------------------------------------------------------------------------

/// The box around a subtree, its centre and axes moved; of a root only its sphere.
static lwi_obb obb_of( const lw_shape* shape, uint32_t place, const lwi_motion* motion, const float sphere[4] )
{
	lwi_obb out = { .center = { sphere[0], sphere[1], sphere[2] }, .radius = sphere[3] };
	float r = sphere[3];
	if ( place == LW_INVALID_INDEX )
	{
		const lwi_obb cube = { .axis = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } }, .low = { -r, -r, -r }, .high = { r, r,
			r } };
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

/// Replaces b by its children; the nearest ends on top of the stack. Returns the new stack height.
static uint32_t open_b( lwi_searching* s, lwi_entry* e, uint32_t height )
{
	const lwi_node* node = &s->b->nodes[e->b];
	float sphere[4], gap[LWI_WIDTH];
	lwi_sphere_a_in_b( s, e, sphere );
	uint32_t mask = s->kernels->sphere_gap( node->x, sphere, s->limit, gap );
	s->memory->stats.node_tests++;
	if ( mask != 0 && s->obbs )
	{
		lwi_obb other = obb_of( s->a, e->obb_a, &s->tree_b_from_a, sphere );
		float back[3] = { -s->direction_b[0], -s->direction_b[1], -s->direction_b[2] };
		mask &= s->kernels->obb_gap( node, &s->b->obbs[e->b], &other, s->has_direction ? back : NULL, s->limit, gap );
	}
	uint32_t lanes[LWI_WIDTH];
	uint32_t count = lwi_sorted_lanes( gap, mask, lanes );
	for ( uint32_t i = count; i-- > 0; )
	{
		uint32_t lane = lanes[i];
		lwi_entry* child = &s->memory->stack[height++];
		*child = *e;
		child->obb_b = e->b * LWI_WIDTH + lane;
		child->b = node->child[lane];
		child->gap = gap[lane];
		child->center_b[0] = node->x[lane];
		child->center_b[1] = node->y[lane];
		child->center_b[2] = node->z[lane];
		child->radius_b = node->r[lane];
	}
	return height;
}

static uint32_t open_a( lwi_searching* s, lwi_entry* e, uint32_t height )
{
	const lwi_node* node = &s->a->nodes[e->a];
	float sphere[4], gap[LWI_WIDTH];
	lwi_sphere_b_in_a( s, e, sphere );
	uint32_t mask = s->kernels->sphere_gap( node->x, sphere, s->limit, gap );
	s->memory->stats.node_tests++;
	if ( mask != 0 && s->obbs )
	{
		lwi_obb other = obb_of( s->b, e->obb_b, &s->tree_a_from_b, sphere );
		mask &= s->kernels->obb_gap( node, &s->a->obbs[e->a], &other, s->has_direction ? s->direction_a : NULL, s->limit,
			gap );
	}
	uint32_t lanes[LWI_WIDTH];
	uint32_t count = lwi_sorted_lanes( gap, mask, lanes );
	for ( uint32_t i = count; i-- > 0; )
	{
		uint32_t lane = lanes[i];
		lwi_entry* child = &s->memory->stack[height++];
		*child = *e;
		child->obb_a = e->a * LWI_WIDTH + lane;
		child->a = node->child[lane];
		child->gap = gap[lane];
		child->center_a[0] = node->x[lane];
		child->center_a[1] = node->y[lane];
		child->center_a[2] = node->z[lane];
		child->radius_a = node->r[lane];
	}
	return height;
}

/// Sphere of the inner side against the real items of the leaf side: far tighter than the leaf's own sphere where triangles
/// are large. True if nothing of the pair can be below the limit.
static bool leaf_side_rules_out( lwi_searching* s, lwi_entry* e )
{
	float sphere[4], gap[LWI_WIDTH], direction[3][LWI_WIDTH];
	if ( lwi_ref_is_leaf( e->a ) )
	{
		lwi_sphere_b_in_a( s, e, sphere );
		return lwi_leaf_mask( s, s->a, e->a, sphere, gap, direction ) == 0;
	}
	lwi_sphere_a_in_b( s, e, sphere );
	return lwi_leaf_mask( s, s->b, e->b, sphere, gap, direction ) == 0;
}

// --- planes ----------------------------------------------------------------------------------------------------------

enum
{
	LEAVES_BEFORE_PLANE = 1, ///< comparisons of leaves before the first search for a plane: most searches end without
	LEAVES_BEFORE_LATE_PLANE = 2, ///< and again when a suspended search resumes: many end at once
	MAX_FAILURES = 3,        ///< after so many, one search in 2^3 tries
	PLANE_DIRECTIONS_KNOWN = 2,
	PLANE_DIRECTIONS_NEW = LWI_MAX_DIRECTIONS
};

/// Depends on the geometry, not on addresses: within alpha, the known planes choose the one of the nearest pairs that is
/// found first, and a run that another process repeats must find the same one.
static uint64_t hash_of( const lw_shape* shape )
{
	uint64_t bits[4];
	memcpy( bits, shape->sphere_center, sizeof( shape->sphere_center ) );
	memcpy( bits + 3, &shape->sphere_radius, sizeof( shape->sphere_radius ) );
	uint64_t hash = (uint64_t)shape->type * 0x165667b19e3779f9u + shape->item_count;
	for ( int i = 0; i < 4; ++i )
	{
		hash = ( hash ^ bits[i] ) * 0x9e3779b97f4a7c15u;
		hash ^= hash >> 29;
	}
	return hash;
}

static lwi_cached_axis* cached_axis_of( lwi_searching* s )
{
	uint64_t shapes = hash_of( s->a ) * 0x9e3779b97f4a7c15u ^ hash_of( s->b ) * 0xc2b2ae3d27d4eb4fu;
	uint32_t key = (uint32_t)( shapes >> 32 ) ^ s->bound->current_pair * 0x85ebca6bu;
	key = key != 0 ? key : 1;
	lwi_cached_axis* axis = &s->memory->axis_cache[key >> ( 32 - LWI_AXIS_CACHE_BITS )];
	if ( axis->key != key )
	{
		*axis = (lwi_cached_axis){ .key = key };
	}
	return axis;
}

/// True if the plane that separated the two last time does so again, or one near it.
static bool old_plane_rules_out( lwi_searching* s, lwi_cached_axis* axis )
{
	return axis->known &&
		   lwi_separate( s->kernels, s->a, s->b, &s->tree_a_from_b, s->limit, &axis->plane, PLANE_DIRECTIONS_KNOWN );
}

/// Searches for a new plane, less often after searches that found none.
static bool new_plane_rules_out( lwi_searching* s, lwi_cached_axis* axis )
{
	if ( !lwi_backoff_is_due( &axis->backoff ) )
	{
		return false;
	}
	axis->plane = lwi_plane_between( s->a, s->b, &s->tree_b_from_a );
	axis->known = lwi_separate( s->kernels, s->a, s->b, &s->tree_a_from_b, s->limit, &axis->plane, PLANE_DIRECTIONS_NEW );
	if ( axis->known )
	{
		lwi_backoff_succeeded( &axis->backoff );
		return true;
	}
	lwi_backoff_failed( &axis->backoff, MAX_FAILURES, 0 );
	return false;
}

static bool plane_rules_out( lwi_searching* s )
{
	lwi_cached_axis* axis = cached_axis_of( s );
	return old_plane_rules_out( s, axis ) || new_plane_rules_out( s, axis );
}

/// The same for a resumed search: the bound is tighter since another pair was searched, so planes that failed before are
/// tried again. The back-off of these late tries is kept apart from that of the first ones.
static bool plane_rules_out_late( lwi_searching* s )
{
	lwi_cached_axis* axis = cached_axis_of( s );
	if ( !lwi_backoff_is_due( &axis->late_backoff ) )
	{
		return false;
	}
	lwi_plane plane = lwi_plane_between( s->a, s->b, &s->tree_b_from_a );
	if ( !lwi_separate( s->kernels, s->a, s->b, &s->tree_a_from_b, s->limit, &plane, PLANE_DIRECTIONS_NEW ) )
	{
		lwi_backoff_failed( &axis->late_backoff, MAX_FAILURES, 2 ); // no wait after the first failure: it says little
		return false;
	}
	axis->plane = plane;
	axis->known = true;
	lwi_backoff_succeeded( &axis->late_backoff );
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
		*backoff = (lwi_slab_backoff){ s->bound->upper, compared + BEFORE_WITNESS };
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
	LEAVES_OF_A_LOOK = 4,    ///< comparisons after which a first pass is over even if nothing was measured
	LEAVES_BEFORE_LEAST = 8, ///< comparisons after which the entry with the least gap is next, wherever it is
};

static lwi_walk begin_walk( lwi_searching* s )
{
	lwi_search_memory* memory = s->memory;
	lwi_walk walk = { .bottom = memory->stack_bottom, .height = memory->stack_bottom + 1, .bounded = s->limit < INFINITY,
		.backoff = { INFINITY, UINT32_MAX } };
	lwi_entry* root = &memory->stack[walk.bottom];
	memset( root, 0, sizeof( *root ) );
	root->a = s->a->root;
	root->b = s->b->root;
	memcpy( root->center_a, s->a->root_sphere, 3 * sizeof( float ) );
	memcpy( root->center_b, s->b->root_sphere, 3 * sizeof( float ) );
	root->radius_a = s->a->root_sphere[3];
	root->radius_b = s->b->root_sphere[3];
	root->obb_a = root->obb_b = LW_INVALID_INDEX;
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
	if ( ++walk->leaves == LEAVES_BEFORE_PLANE && walk->bounded && planes && plane_rules_out( s ) )
	{
		return true;
	}
	if ( walk->leaves == walk->late_plane && plane_rules_out_late( s ) )
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

/// @param look stop after the first measurement, or after LEAVES_OF_A_LOOK
/// @return false if it did; else the search is done
static bool walk_trees( lwi_searching* s, lwi_walk* walk, bool look )
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
		bool leaf_a = lwi_ref_is_leaf( e.a ), leaf_b = lwi_ref_is_leaf( e.b );
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
		if ( leaf_a != leaf_b && ( leaf_a ? 2 * e.radius_a > e.radius_b : 2 * e.radius_b > e.radius_a ) &&
			 leaf_side_rules_out( s, &e ) )
		{
			continue;
		}
		walk->height = !leaf_b && ( leaf_a || e.radius_b >= e.radius_a ) ? open_b( s, &e, walk->height ) : open_a( s, &e, walk->height );
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

/// One shape with a tree (a or b) against one primitive.
static void search_primitive( lwi_searching* s )
{
	lwi_search_memory* memory = s->memory;
	bool primitive_is_a = s->a->primitive;
	const lw_shape* tree = primitive_is_a ? s->b : s->a;
	const lw_shape* primitive_shape = primitive_is_a ? s->a : s->b;
	lwi_convex convex = lwi_convex_of_primitive( primitive_shape );
	lwi_primitive primitive = { primitive_shape->type,
		{ lwi_round_up( convex.size[0] ), lwi_round_up( convex.size[1] ), lwi_round_up( convex.size[2] ) } };
	const lwi_motion* motion = primitive_is_a ? &s->tree_a_from_b : &s->tree_b_from_a;
	lwi_entry root;
	memset( &root, 0, sizeof( root ) );
	root.a = tree->root;
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
		if ( lwi_ref_is_leaf( e.a ) )
		{
			uint32_t mask = primitive_leaf_mask( s, tree, e.a, motion, &primitive, gap );
			memory->stats.leaf_tests++;
			if ( mask != 0 && plane_is_open && plane_rules_out( s ) ) // before anything is measured: that costs as much
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
					uint32_t item = lwi_leaf_item( tree, e.a, lanes[i] );
					lwi_measure_items( s, primitive_is_a ? LW_INVALID_INDEX : item, primitive_is_a ? item
						: LW_INVALID_INDEX );
				}
			}
			continue;
		}
		const lwi_node* node = &tree->nodes[e.a];
		uint32_t mask = s->kernels->node_primitive_gap( node, motion, &primitive, s->limit, gap );
		memory->stats.node_tests++;
		for ( uint32_t i = lwi_sorted_lanes( gap, mask, lanes ); i-- > 0; )
		{
			lwi_entry* child = &memory->stack[height++];
			child->a = node->child[lanes[i]];
			child->gap = gap[lanes[i]];
		}
	}
}

// --- entry points ----------------------------------------------------------------------------------------------------

static double max_abs3( const double v[3] )
{
	return fmax( fabs( v[0] ), fmax( fabs( v[1] ), fabs( v[2] ) ) );
}

/// Reach of the geometry about the tree's origin, or about the shape's if it is a primitive.
static double extent_of( const lw_shape* shape )
{
	if ( shape->family == LWI_UNBOUNDED )
	{
		return 0; // distances from it are those of the other's points along its normal
	}
	return shape->primitive ? shape->sphere_radius + max_abs3( shape->sphere_center ) : (double)shape->extent;
}

static lwi_motion motion_of( const lw_transform* m )
{
	lwi_motion out;
	for ( int i = 0; i < 3; ++i )
	{
		for ( int j = 0; j < 3; ++j )
		{
			out.r[3 * i + j] = (float)m->r[i][j];
		}
		out.t[i] = (float)m->t[i];
	}
	return out;
}

static lwi_searching search_begin( lwi_search_memory* memory, const lw_shape* a, const lw_shape* b, const lw_transform* a_from_b,
	lwi_bound* bound )
{
	lwi_searching s;
	memset( &s, 0, sizeof( s ) );
	s.memory = memory;
	s.kernels = memory->kernels;
	s.a = a;
	s.b = b;
	s.a_from_b = a_from_b;
	s.bound = bound;
	s.radii = ( a->family == LWI_TRIANGLES ? a->radius : 0 ) + ( b->family == LWI_TRIANGLES ? b->radius : 0 ) + bound->margin;
	// tree frames are the shape frames shifted by `origin` (zero for primitives)
	lw_transform tree = *a_from_b;
	lw_vec3 origin_b = lwi_transform( a_from_b, lwi_load( b->origin ) );
	tree.t[0] = origin_b.x - a->origin[0];
	tree.t[1] = origin_b.y - a->origin[1];
	tree.t[2] = origin_b.z - a->origin[2];
	lw_transform inverse;
	for ( int i = 0; i < 3; ++i )
	{
		for ( int j = 0; j < 3; ++j )
		{
			inverse.r[i][j] = tree.r[j][i];
		}
		inverse.t[i] = -( tree.r[0][i] * tree.t[0] + tree.r[1][i] * tree.t[1] + tree.r[2][i] * tree.t[2] );
	}
	s.tree_a_from_b = motion_of( &tree );
	s.tree_b_from_a = motion_of( &inverse );
	double size = lwi_length( lwi_load( tree.t ) ) + 2 * ( extent_of( a ) + extent_of( b ) );
	s.slack = lwi_gap_slack( size );
	// moving the origins themselves rounds too: by doubles, of the coordinates of origins and poses
	double reach = max_abs3( a->origin ) + max_abs3( b->origin ) + max_abs3( a_from_b->t ) + extent_of( a ) + extent_of( b );
	s.error = LWI_EXACT_ERROR * reach;
	s.slack += s.error;
	s.least = a->closed || b->closed ? s.error + s.radii - bound->margin : -INFINITY;
	lwi_update_limit( &s );
	return s;
}

/// The shape with its geometry; NULL ends the search.
static const lw_shape* geometry_of( lwi_search_memory* memory, const lw_shape* shape, lwi_bound* bound )
{
	lw_status status;
	const lw_shape* made = lwi_shape_made( shape, &status, NULL );
	if ( made == NULL )
	{
		memory->failure = status;
		bound->failed = bound->done = true;
	}
	return made;
}

/// Suspends a search; lwi_search_waiting() resumes it. False if there is no room for it.
static bool wait_for_others( lwi_searching* s, const lwi_walk* walk )
{
	lwi_search_memory* memory = s->memory;
	if ( memory->waiting_count == LWI_MAX_WAITING || walk->height > LWI_STACK_PATH )
	{
		return false;
	}
	lwi_waiting* waiting = &memory->waiting[memory->waiting_count++];
	*waiting = (lwi_waiting){ .search = *s, .a_from_b = *s->a_from_b, .walk = *walk, .pair = s->bound->current_pair,
		.margin = s->bound->margin, .measured = s->bound->measured };
	memory->stack_bottom = walk->height;
	return true;
}

static void end_search( lwi_searching* s )
{
	if ( s->a->closed || s->b->closed )
	{
		lwi_search_inside( s );
	}
}

/// @param look the search may be suspended after its first pass
static void search_pair( lwi_search_memory* memory, const lw_shape* a, const lw_shape* b, const lw_transform* a_from_b, lwi_bound* bound, bool look )
{
	bool deferred = lwi_shape_now( a )->deferred != NULL || lwi_shape_now( b )->deferred != NULL;
	if ( deferred && lwi_box_gap( a, b, a_from_b ) >= bound->cutoff + bound->margin )
	{
		return; // not worth making it
	}
	a = geometry_of( memory, a, bound );
	b = geometry_of( memory, b, bound );
	if ( a == NULL || b == NULL )
	{
		return;
	}
	memory->stats.queries++;
	if ( memory->def.planes && lwi_boxes_are_apart( a, b, a_from_b, bound ) )
	{
		return; // so nothing is inside of the other either
	}
	lwi_searching s = search_begin( memory, a, b, a_from_b, bound );
	if ( a->primitive && b->primitive )
	{
		lwi_measure_items( &s, LW_INVALID_INDEX, LW_INVALID_INDEX );
	}
	else if ( a->primitive || b->primitive )
	{
		search_primitive( &s );
	}
	else
	{
		lwi_walk walk = begin_walk( &s );
		if ( !walk_trees( &s, &walk, look ) && ( wait_for_others( &s, &walk ) || !walk_trees( &s, &walk, false ) ) )
		{
			return;
		}
	}
	end_search( &s );
}

void lwi_search( lwi_search_memory* memory, const lw_shape* a, const lw_shape* b, const lw_transform* a_from_b, lwi_bound* bound )
{
	search_pair( memory, a, b, a_from_b, bound, false );
}

void lwi_search_first( lwi_search_memory* memory, const lw_shape* a, const lw_shape* b, const lw_transform* a_from_b, lwi_bound* bound )
{
	bound->measured = INFINITY;
	search_pair( memory, a, b, a_from_b, bound, true );
}

/// Resumes a suspended search.
static void resume( lwi_search_memory* memory, lwi_waiting* waiting, lwi_bound* bound )
{
	lwi_searching* s = &waiting->search;
	lwi_walk* walk = &waiting->walk;
	s->a_from_b = &waiting->a_from_b;
	bound->current_pair = waiting->pair;
	bound->margin = waiting->margin;
	lwi_update_limit( s );
	const uint32_t entries = walk->height - walk->bottom;
	memmove( &memory->stack[memory->stack_bottom], &memory->stack[walk->bottom], entries * sizeof( lwi_entry ) );
	walk->bottom = memory->stack_bottom;
	walk->height = memory->stack_bottom + entries;
	if ( memory->def.planes && s->limit < INFINITY && bound->pair != bound->current_pair )
	{
		walk->late_plane = walk->leaves + LEAVES_BEFORE_LATE_PLANE;
	}
	(void)walk_trees( s, walk, false );
	end_search( s );
}

void lwi_search_waiting( lwi_search_memory* memory, lwi_bound* bound )
{
	for ( uint32_t left = memory->waiting_count; left > 0 && !bound->done; --left )
	{
		uint32_t next = 0;
		for ( uint32_t i = 1; i < left; ++i )
		{
			next = memory->waiting[i].measured < memory->waiting[next].measured ? i : next;
		}
		lwi_waiting waiting = memory->waiting[next];
		memory->waiting[next] = memory->waiting[left - 1];
		resume( memory, &waiting, bound );
	}
	memory->waiting_count = memory->stack_bottom = 0;
}

void lwi_measure( lwi_search_memory* memory, const lw_shape* a, const lw_shape* b, const lw_transform* a_from_b, uint32_t item_a,
	uint32_t item_b, lwi_bound* bound )
{
	a = lwi_shape_now( a );
	b = lwi_shape_now( b );
	if ( ( a->primitive || item_a < a->item_count ) && ( b->primitive || item_b < b->item_count ) )
	{
		lwi_searching s = search_begin( memory, a, b, a_from_b, bound );
		lwi_measure_items( &s, item_a, item_b );
	}
	else if ( a->closed || b->closed )
	{
		lwi_searching s = search_begin( memory, a, b, a_from_b, bound );
		lwi_measure_inside( &s, item_a, item_b );
	}
}

lw_transform lwi_orthonormal( const lw_transform* transform )
{
	lw_transform m = *transform;
	double worst = 0;
	for ( int i = 0; i < 3; ++i )
	{
		for ( int j = 0; j < 3; ++j )
		{
			double want = i == j ? 1 : 0;
			worst = fmax( worst, fabs( lwi_dot( lwi_load( m.r[i] ), lwi_load( m.r[j] ) ) - want ) );
		}
	}
	if ( worst <= ALREADY_ORTHONORMAL )
	{
		return m;
	}
	lw_vec3 x = lwi_load( m.r[0] ), y = lwi_load( m.r[1] );
	x = lwi_scale( 1 / lwi_length( x ), x );
	y = lwi_add_scaled( y, -lwi_dot( x, y ), x );
	y = lwi_scale( 1 / lwi_length( y ), y );
	lw_vec3 rows[3] = { x, y, lwi_cross( x, y ) };
	for ( int i = 0; i < 3; ++i )
	{
		m.r[i][0] = rows[i].x;
		m.r[i][1] = rows[i].y;
		m.r[i][2] = rows[i].z;
	}
	return m;
}

lw_range lw_range_exact( void )
{
	return (lw_range){ 0, INFINITY, 0 };
}

lw_clearance lw_clearance_unknown( void )
{
	return (lw_clearance){ 0, INFINITY, { 0, 0, 0 }, { 0, 0, 0 }, LW_CLEARANCE_UNKNOWN, LW_INVALID_INDEX, LW_INVALID_INDEX };
}
