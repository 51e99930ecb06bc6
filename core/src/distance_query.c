// SPDX-License-Identifier: BSD-3-Clause
// Branch and bound over two sphere trees with the range built in.
// Papers: S. Quinlan, "Efficient distance computation between non-convex objects", ICRA 1994;
//   K. Steinbach, J. Kuffner, T. Asfour, R. Dillmann, "Efficient collision and self-collision detection for humanoids based
//   on sphere trees hierarchies", Humanoids 2006 (range bounds, transform caching).
// Floats filter, doubles decide: nodes and triangle pairs are dropped by float gaps plus their stated slack (kernels.h);
// whatever becomes a result is measured in double from the original vertices.
#include "convex.h"
#include "math_inline.h"
#include "query_internal.h"
#include "tri_tri.h"

#include <string.h>

/// Rounding of a distance measured in double, in units of roundoff times the largest coordinate involved: lwi_tri_tri's 64
/// (tri_tri.h), plus 16 for moving b's vertices into a's frame (three products and sums and the pose's own rounding).
#define LWI_EXACT_ERROR ( 80.0 * LWI_U64 )

/// What a search of one pair needs at hand.
typedef struct search
{
	lw_query* query;
	const lwi_kernels* kernels;
	const lw_shape* a;
	const lw_shape* b;
	const lw_transform* a_from_b; ///< shape frames, double
	lwi_motion tree_a_from_b, tree_b_from_a;
	lwi_bound* bound;
	double radii; ///< dilation of both: the search is about undilated geometry
	double slack; ///< metres: what a float gap may be too large by
	double error; ///< metres: what a distance in double may be off by
	float limit;  ///< subtrees whose gap reaches it are dropped: bound->prune + radii + slack, rounded up
} search;

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
	bound->prune = range->max_d;
	bound->floor = INFINITY;
	bound->triangle_a = bound->triangle_b = bound->pair = bound->current_pair = LW_INVALID_INDEX;
}

bool lwi_bound_offer( lwi_bound* bound, double lower, double upper )
{
	bound->floor = lower < bound->floor ? lower : bound->floor;
	if ( !( upper < bound->upper && lower < bound->range.max_d ) )
	{
		return false;
	}
	bound->upper = upper;
	bound->done = upper <= bound->range.min_d;
	// Within alpha of the best is good enough, but not at or below min_d while the best is above: the verdict needs that.
	double prune = ( 1 - bound->range.alpha ) * upper;
	double decisive = nextafter( bound->range.min_d, INFINITY );
	decisive = decisive < upper ? decisive : upper;
	prune = prune > decisive ? prune : decisive;
	bound->prune = prune < bound->prune ? prune : bound->prune;
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
	if ( bound->done )
	{
		out.kind = LW_CLEARANCE_VIOLATION;
		return out;
	}
	double lower = bound->floor < bound->prune ? bound->floor : bound->prune;
	out.lower = lower > 0 ? lower : 0;
	out.kind = out.lower > bound->range.min_d ? LW_CLEARANCE_NEAR : LW_CLEARANCE_UNDECIDED;
	return out;
}

static void update_limit( search* s )
{
	s->limit = lwi_round_up( s->bound->prune + s->radii + s->slack );
}

/// Witness points of dilated geometry from those of the cores, distance apart; returns them in place.
static void dilate( const search* s, double distance, lw_vec3* point_a, lw_vec3* point_b )
{
	if ( s->radii == 0 )
	{
		return;
	}
	lw_vec3 a = *point_a, b = *point_b;
	lw_vec3 direction = distance > 0 ? lwi_scale( 1 / distance, lwi_sub( b, a ) ) : lwi_v3( 0, 0, 0 );
	double from_a = s->a->radius < distance ? s->a->radius : distance;
	*point_a = lwi_add_scaled( a, from_a, direction );
	// overlapping: both witnesses are one common point
	double from_b = s->b->radius < distance - from_a ? s->b->radius : distance - from_a;
	*point_b = lwi_add_scaled( b, -from_b, direction );
}

/// Offers the distance [lower, upper] of two undilated pieces.
static void offer( search* s, double lower, double upper, lw_vec3 point_a, lw_vec3 point_b, uint32_t triangle_a,
	uint32_t triangle_b )
{
	double low = lower - s->radii, high = upper - s->radii;
	if ( lwi_bound_offer( s->bound, low > 0 ? low : 0, high > 0 ? high : 0 ) )
	{
		dilate( s, upper, &point_a, &point_b );
		s->bound->point_a = point_a;
		s->bound->point_b = point_b;
		s->bound->triangle_a = triangle_a;
		s->bound->triangle_b = triangle_b;
		update_limit( s );
	}
}

static void load_triangle( const lw_shape* shape, uint32_t triangle, lw_vec3 out[3] )
{
	const uint32_t* index = shape->indices + 3 * (size_t)triangle;
	for ( int i = 0; i < 3; ++i )
	{
		out[i] = lwi_load( shape->vertices + 3 * (size_t)index[i] );
	}
}

static void measure_triangles( search* s, uint32_t triangle_a, uint32_t triangle_b )
{
	lw_vec3 a[3], b[3];
	load_triangle( s->a, triangle_a, a );
	load_triangle( s->b, triangle_b, b );
	for ( int i = 0; i < 3; ++i )
	{
		b[i] = lwi_transform( s->a_from_b, b[i] );
	}
	lwi_tri_result r = lwi_tri_tri( a, b );
	s->query->stats.exact_tests++;
	offer( s, r.distance - s->error, r.distance, r.point_a, r.point_b, triangle_a, triangle_b );
}

// --- soup against soup -----------------------------------------------------------------------------------------------

static void move_center( const lwi_motion* m, const float p[3], float out[3] )
{
	for ( int i = 0; i < 3; ++i )
	{
		out[i] = m->r[3 * i] * p[0] + m->r[3 * i + 1] * p[1] + m->r[3 * i + 2] * p[2] + m->t[i];
	}
}

/// The sphere of a in b's frame, from the cache where it is there.
static void sphere_a_in_b( search* s, lwi_entry* e, float sphere[4] )
{
	if ( e->cached != LWI_CACHED_A_IN_B || !s->query->def.transform_caching )
	{
		move_center( &s->tree_b_from_a, e->center_a, e->moved );
		e->cached = LWI_CACHED_A_IN_B;
		s->query->stats.center_transforms++;
	}
	memcpy( sphere, e->moved, 3 * sizeof( float ) );
	sphere[3] = e->radius_a;
}

static void sphere_b_in_a( search* s, lwi_entry* e, float sphere[4] )
{
	if ( e->cached != LWI_CACHED_B_IN_A || !s->query->def.transform_caching )
	{
		move_center( &s->tree_a_from_b, e->center_b, e->moved );
		e->cached = LWI_CACHED_B_IN_A;
		s->query->stats.center_transforms++;
	}
	memcpy( sphere, e->moved, 3 * sizeof( float ) );
	sphere[3] = e->radius_b;
}

/// The lanes of a mask in ascending order of gap. Returns their count.
static uint32_t sorted_lanes( const float gap[LWI_WIDTH], uint32_t mask, uint32_t lanes[LWI_WIDTH] )
{
	uint32_t count = 0;
	for ( ; mask != 0; mask &= mask - 1 )
	{
		uint32_t lane = lwi_lowest_bit( mask );
		uint32_t at = count++;
		while ( at > 0 && gap[lanes[at - 1]] > gap[lane] )
		{
			lanes[at] = lanes[at - 1];
			--at;
		}
		lanes[at] = lane;
	}
	return count;
}

/// Replaces b by its children; the nearest ends on top of the stack. Returns the new stack height.
static uint32_t open_b( search* s, lwi_entry* e, uint32_t height )
{
	const lwi_node* node = &s->b->nodes[e->b];
	float sphere[4], gap[LWI_WIDTH];
	sphere_a_in_b( s, e, sphere );
	uint32_t mask = s->kernels->sphere_gap( node->x, sphere, s->limit, gap );
	s->query->stats.node_tests++;
	uint32_t lanes[LWI_WIDTH];
	uint32_t count = sorted_lanes( gap, mask, lanes );
	for ( uint32_t i = count; i-- > 0; )
	{
		uint32_t lane = lanes[i];
		lwi_entry* child = &s->query->stack[height++];
		*child = *e;
		child->b = node->child[lane];
		child->gap = gap[lane];
		child->center_b[0] = node->x[lane];
		child->center_b[1] = node->y[lane];
		child->center_b[2] = node->z[lane];
		child->radius_b = node->r[lane];
	}
	return height;
}

static uint32_t open_a( search* s, lwi_entry* e, uint32_t height )
{
	const lwi_node* node = &s->a->nodes[e->a];
	float sphere[4], gap[LWI_WIDTH];
	sphere_b_in_a( s, e, sphere );
	uint32_t mask = s->kernels->sphere_gap( node->x, sphere, s->limit, gap );
	s->query->stats.node_tests++;
	uint32_t lanes[LWI_WIDTH];
	uint32_t count = sorted_lanes( gap, mask, lanes );
	for ( uint32_t i = count; i-- > 0; )
	{
		uint32_t lane = lanes[i];
		lwi_entry* child = &s->query->stack[height++];
		*child = *e;
		child->a = node->child[lane];
		child->gap = gap[lane];
		child->center_a[0] = node->x[lane];
		child->center_a[1] = node->y[lane];
		child->center_a[2] = node->z[lane];
		child->radius_a = node->r[lane];
	}
	return height;
}

/// Filters the waiting triangle pairs and measures what is left, most promising first.
static void flush_batch( search* s )
{
	lwi_batch* batch = &s->query->batch;
	if ( batch->count == 0 )
	{
		return;
	}
	uint32_t used = batch->count;
	batch->count = 0;
	float gap[LWI_WIDTH];
	// lanes from `used` on are stale pairs of an earlier batch
	uint32_t mask = s->kernels->triangle_gap( batch->a, batch->b, s->limit, gap ) & lwi_low_bits( used );
	s->query->stats.triangle_tests += used;
	uint32_t lanes[LWI_WIDTH];
	uint32_t count = sorted_lanes( gap, mask, lanes );
	for ( uint32_t i = 0; i < count && !s->bound->done; ++i )
	{
		uint32_t lane = lanes[i];
		if ( !( gap[lane] >= s->limit ) )
		{
			measure_triangles( s, batch->triangle_a[lane], batch->triangle_b[lane] );
		}
	}
}

static void add_to_batch( search* s, const lwi_leaf* a, uint32_t lane_a, lwi_triangles8 b, uint32_t lane_b,
	uint32_t triangle_b )
{
	lwi_batch* batch = &s->query->batch;
	uint32_t at = batch->count++;
	for ( int vertex = 0; vertex < 3; ++vertex )
	{
		for ( int axis = 0; axis < 3; ++axis )
		{
			batch->a[vertex][axis][at] = a->v[vertex][axis][lane_a];
			batch->b[vertex][axis][at] = b[vertex][axis][lane_b];
		}
	}
	batch->triangle_a[at] = a->triangle[lane_a];
	batch->triangle_b[at] = triangle_b;
	if ( batch->count == LWI_WIDTH )
	{
		flush_batch( s );
	}
}

static uint32_t least_lane( const float gap[LWI_WIDTH], uint32_t count )
{
	uint32_t best = 0;
	for ( uint32_t lane = 1; lane < count; ++lane )
	{
		best = gap[lane] < gap[best] ? lane : best;
	}
	return best;
}

/// Extents of both leaves along one direction given in a's frame: high of a and low of b on the same scale (metres), so that
/// low_b[j] - high_a[i] is a gap of every pair at once. Facing flat surfaces are settled here.
static void project_leaves( search* s, const lwi_leaf* a, const lwi_leaf* b, const float direction[3], float high_a[LWI_WIDTH],
	float low_b[LWI_WIDTH] )
{
	float norm = sqrtf( direction[0] * direction[0] + direction[1] * direction[1] + direction[2] * direction[2] );
	float inverse = norm > 0 ? 1.0f / norm : 0.0f;
	float n[3] = { direction[0] * inverse, direction[1] * inverse, direction[2] * inverse };
	const lwi_motion* m = &s->tree_a_from_b;
	float n_b[3] = { m->r[0] * n[0] + m->r[3] * n[1] + m->r[6] * n[2], m->r[1] * n[0] + m->r[4] * n[1] + m->r[7] * n[2],
		m->r[2] * n[0] + m->r[5] * n[1] + m->r[8] * n[2] };
	float shift = n[0] * m->t[0] + n[1] * m->t[1] + n[2] * m->t[2];
	float low_a[LWI_WIDTH], high_b[LWI_WIDTH];
	s->kernels->leaf_project( a, n, low_a, high_a );
	s->kernels->leaf_project( b, n_b, low_b, high_b );
	for ( int lane = 0; lane < LWI_WIDTH; ++lane )
	{
		low_b[lane] += shift;
	}
}

/// All triangle pairs of two leaves: spheres against triangles, then two slabs common to all pairs, then the batch.
static void compare_leaves( search* s, lwi_entry* e )
{
	const lwi_leaf* a = &s->a->leaves[lwi_ref_index( e->a )];
	const lwi_leaf* b = &s->b->leaves[lwi_ref_index( e->b )];
	uint32_t count_a = lwi_ref_count( e->a ), count_b = lwi_ref_count( e->b );
	s->query->stats.leaf_tests++;

	float sphere[4], gap_a[LWI_WIDTH], gap_b[LWI_WIDTH], direction_a[3][LWI_WIDTH], direction_b[3][LWI_WIDTH];
	sphere_b_in_a( s, e, sphere );
	uint32_t mask_a = s->kernels->leaf_gap( a, sphere, s->limit, gap_a, direction_a ) & lwi_low_bits( count_a );
	if ( mask_a == 0 )
	{
		return;
	}
	sphere_a_in_b( s, e, sphere );
	uint32_t mask_b = s->kernels->leaf_gap( b, sphere, s->limit, gap_b, direction_b ) & lwi_low_bits( count_b );
	if ( mask_b == 0 )
	{
		return;
	}
	float high_a[2][LWI_WIDTH], low_b[2][LWI_WIDTH];
	uint32_t nearest = least_lane( gap_a, count_a );
	float along[3] = { direction_a[0][nearest], direction_a[1][nearest], direction_a[2][nearest] };
	project_leaves( s, a, b, along, high_a[0], low_b[0] );
	// from b's side the direction points from b to a: turned around, and into a's frame
	nearest = least_lane( gap_b, count_b );
	float back[3] = { -direction_b[0][nearest], -direction_b[1][nearest], -direction_b[2][nearest] };
	const lwi_motion* m = &s->tree_a_from_b;
	for ( int i = 0; i < 3; ++i )
	{
		along[i] = m->r[3 * i] * back[0] + m->r[3 * i + 1] * back[1] + m->r[3 * i + 2] * back[2];
	}
	project_leaves( s, a, b, along, high_a[1], low_b[1] );

	lwi_triangles8 moved;
	bool have_moved = false;
	for ( ; mask_a != 0 && !s->bound->done; mask_a &= mask_a - 1 )
	{
		uint32_t i = lwi_lowest_bit( mask_a );
		float high[2] = { high_a[0][i], high_a[1][i] };
		uint32_t mask = s->kernels->slab_gap( (const float( * )[LWI_WIDTH])low_b, high, s->limit ) & mask_b;
		if ( mask != 0 && !have_moved )
		{
			s->kernels->leaf_transform( b, &s->tree_a_from_b, moved );
			have_moved = true;
		}
		for ( ; mask != 0; mask &= mask - 1 )
		{
			uint32_t j = lwi_lowest_bit( mask );
			add_to_batch( s, a, i, moved, j, b->triangle[j] );
		}
	}
}

/// Sphere of the inner side against the real triangles of the leaf side: far tighter than the leaf's own sphere where the
/// triangles are large. True if nothing of the pair can be below the limit.
static bool leaf_side_rules_out( search* s, lwi_entry* e )
{
	float sphere[4], gap[LWI_WIDTH], direction[3][LWI_WIDTH];
	if ( lwi_ref_is_leaf( e->a ) )
	{
		sphere_b_in_a( s, e, sphere );
		return s->kernels->leaf_gap( &s->a->leaves[lwi_ref_index( e->a )], sphere, s->limit, gap, direction ) == 0;
	}
	sphere_a_in_b( s, e, sphere );
	return s->kernels->leaf_gap( &s->b->leaves[lwi_ref_index( e->b )], sphere, s->limit, gap, direction ) == 0;
}

static void search_soups( search* s )
{
	lw_query* query = s->query;
	lwi_entry root;
	memset( &root, 0, sizeof( root ) );
	root.a = s->a->root;
	root.b = s->b->root;
	memcpy( root.center_a, s->a->root_sphere, 3 * sizeof( float ) );
	memcpy( root.center_b, s->b->root_sphere, 3 * sizeof( float ) );
	root.radius_a = s->a->root_sphere[3];
	root.radius_b = s->b->root_sphere[3];
	query->batch.count = 0;
	query->stack[0] = root;
	uint32_t height = 1;
	while ( height > 0 && !s->bound->done )
	{
		lwi_entry e = query->stack[--height];
		if ( e.gap >= s->limit )
		{
			continue;
		}
		bool leaf_a = lwi_ref_is_leaf( e.a ), leaf_b = lwi_ref_is_leaf( e.b );
		if ( leaf_a && leaf_b )
		{
			compare_leaves( s, &e );
			// the first finds are flushed at once: a low bound early is worth more than full lanes
			if ( query->batch.count >= LWI_WIDTH / 2 || s->bound->upper == INFINITY )
			{
				flush_batch( s );
			}
			continue;
		}
		// a leaf much larger than the node it faces is a poor sphere: ask its triangles first
		if ( leaf_a != leaf_b && ( leaf_a ? 2 * e.radius_a > e.radius_b : 2 * e.radius_b > e.radius_a ) &&
			 leaf_side_rules_out( s, &e ) )
		{
			continue;
		}
		height = !leaf_b && ( leaf_a || e.radius_b >= e.radius_a ) ? open_b( s, &e, height ) : open_a( s, &e, height );
	}
	if ( !s->bound->done )
	{
		flush_batch( s );
	}
}

// --- soup against solid ----------------------------------------------------------------------------------------------

static lwi_convex convex_of_solid( const lw_shape* shape )
{
	lwi_convex convex = { .type = LWI_CONVEX_BOX };
	if ( shape->type == LW_SHAPE_BOX )
	{
		for ( int i = 0; i < 3; ++i )
		{
			convex.size[i] = 0.5 * shape->dimensions[i];
		}
		return convex;
	}
	convex.type = shape->type == LW_SHAPE_CYLINDER ? LWI_CONVEX_CYLINDER : LWI_CONVEX_CONE;
	convex.size[0] = shape->dimensions[0];
	convex.size[1] = 0.5 * shape->dimensions[1];
	return convex;
}

static lwi_convex convex_of_triangle( const lw_shape* shape, uint32_t triangle )
{
	lwi_convex convex = { .type = LWI_CONVEX_TRIANGLE };
	load_triangle( shape, triangle, convex.vertex );
	return convex;
}

/// Measures two convex pieces; `triangle_a`, `triangle_b` are LW_INVALID_INDEX for solids.
static void measure_convex( search* s, uint32_t triangle_a, uint32_t triangle_b )
{
	lwi_convex a = s->a->solid ? convex_of_solid( s->a ) : convex_of_triangle( s->a, triangle_a );
	lwi_convex b = s->b->solid ? convex_of_solid( s->b ) : convex_of_triangle( s->b, triangle_b );
	s->query->stats.exact_tests++;
	double stop_below = s->bound->range.min_d + s->radii;
	lwi_convex_result r = lwi_convex_distance( &a, &b, s->a_from_b, s->bound->prune + s->radii, stop_below );
	offer( s, r.lower - s->error, r.upper, r.point_a, r.point_b, triangle_a, triangle_b );
}

/// One soup (a or b) against one solid.
static void search_solid( search* s )
{
	lw_query* query = s->query;
	bool solid_is_a = s->a->solid;
	const lw_shape* soup = solid_is_a ? s->b : s->a;
	lwi_convex convex = convex_of_solid( solid_is_a ? s->a : s->b );
	lwi_solid solid = { ( solid_is_a ? s->a : s->b )->type,
		{ lwi_round_up( convex.size[0] ), lwi_round_up( convex.size[1] ), lwi_round_up( convex.size[2] ) } };
	const lwi_motion* motion = solid_is_a ? &s->tree_a_from_b : &s->tree_b_from_a;
	lwi_entry root;
	memset( &root, 0, sizeof( root ) );
	root.a = soup->root;
	query->stack[0] = root;
	uint32_t height = 1;
	while ( height > 0 && !s->bound->done )
	{
		lwi_entry e = query->stack[--height];
		if ( e.gap >= s->limit )
		{
			continue;
		}
		float gap[LWI_WIDTH];
		uint32_t lanes[LWI_WIDTH];
		if ( lwi_ref_is_leaf( e.a ) )
		{
			const lwi_leaf* leaf = &soup->leaves[lwi_ref_index( e.a )];
			uint32_t mask = s->kernels->leaf_solid_gap( leaf, motion, &solid, s->limit, gap );
			query->stats.leaf_tests++;
			uint32_t count = sorted_lanes( gap, mask & lwi_low_bits( lwi_ref_count( e.a ) ), lanes );
			for ( uint32_t i = 0; i < count && !s->bound->done; ++i )
			{
				if ( !( gap[lanes[i]] >= s->limit ) )
				{
					uint32_t triangle = leaf->triangle[lanes[i]];
					measure_convex( s, solid_is_a ? LW_INVALID_INDEX : triangle, solid_is_a ? triangle : LW_INVALID_INDEX );
				}
			}
			continue;
		}
		const lwi_node* node = &soup->nodes[e.a];
		uint32_t mask = s->kernels->node_solid_gap( node, motion, &solid, s->limit, gap );
		query->stats.node_tests++;
		for ( uint32_t i = sorted_lanes( gap, mask, lanes ); i-- > 0; )
		{
			lwi_entry* child = &query->stack[height++];
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

/// Half diagonal of the bounds, about the tree's origin (a soup) or the shape's (a solid).
static double extent_of( const lw_shape* shape )
{
	return shape->solid ? shape->sphere_radius + max_abs3( shape->sphere_center ) : (double)shape->extent;
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

static search search_begin( lw_query* query, const lw_shape* a, const lw_shape* b, const lw_transform* a_from_b,
	lwi_bound* bound )
{
	search s;
	memset( &s, 0, sizeof( s ) );
	s.query = query;
	s.kernels = query->kernels;
	s.a = a;
	s.b = b;
	s.a_from_b = a_from_b;
	s.bound = bound;
	s.radii = a->radius + b->radius;
	// tree frames are the shape frames shifted by `origin` (zero for solids)
	lw_transform tree = *a_from_b;
	lw_vec3 origin_b = lwi_transform( a_from_b, lwi_load( b->origin ) );
	tree.t[0] = origin_b.x - a->origin[0];
	tree.t[1] = origin_b.y - a->origin[1];
	tree.t[2] = origin_b.z - a->origin[2];
	lw_transform identity = lw_transform_identity();
	lw_transform inverse = lwi_relative( &tree, &identity );
	s.tree_a_from_b = motion_of( &tree );
	s.tree_b_from_a = motion_of( &inverse );
	double size = lwi_length( lwi_load( tree.t ) ) + 2 * ( extent_of( a ) + extent_of( b ) );
	s.slack = LWI_GAP_SLACK * LWI_U32 * size;
	// moving the origins themselves rounds too: by doubles, of the coordinates of origins and poses
	double reach = max_abs3( a->origin ) + max_abs3( b->origin ) + max_abs3( a_from_b->t ) + extent_of( a ) + extent_of( b );
	s.error = LWI_EXACT_ERROR * reach;
	s.slack += s.error;
	update_limit( &s );
	return s;
}

/// The shape with its geometry; NULL ends the question.
static const lw_shape* geometry_of( lw_query* query, const lw_shape* shape, lwi_bound* bound )
{
	lw_status status;
	const lw_shape* made = lwi_shape_made( shape, &status, NULL );
	if ( made == NULL )
	{
		query->failure = status;
		bound->failed = bound->done = true;
	}
	return made;
}

void lwi_search( lw_query* query, const lw_shape* a, const lw_shape* b, const lw_transform* a_from_b, lwi_bound* bound )
{
	a = geometry_of( query, a, bound );
	b = geometry_of( query, b, bound );
	if ( a == NULL || b == NULL )
	{
		return;
	}
	search s = search_begin( query, a, b, a_from_b, bound );
	query->stats.queries++;
	if ( a->solid && b->solid )
	{
		measure_convex( &s, LW_INVALID_INDEX, LW_INVALID_INDEX );
	}
	else if ( a->solid || b->solid )
	{
		search_solid( &s );
	}
	else
	{
		search_soups( &s );
	}
}

void lwi_measure( lw_query* query, const lw_shape* a, const lw_shape* b, const lw_transform* a_from_b, uint32_t triangle_a,
	uint32_t triangle_b, lwi_bound* bound )
{
	a = lwi_shape_now( a );
	b = lwi_shape_now( b );
	if ( ( !a->solid && triangle_a >= a->triangle_count ) || ( !b->solid && triangle_b >= b->triangle_count ) )
	{
		return;
	}
	search s = search_begin( query, a, b, a_from_b, bound );
	if ( a->solid || b->solid )
	{
		measure_convex( &s, triangle_a, triangle_b );
	}
	else
	{
		measure_triangles( &s, triangle_a, triangle_b );
	}
}

lw_transform lwi_orthonormal( const lw_transform* transform )
{
	const double already = 8 * DBL_EPSILON; // products of rounded sines and cosines
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
	if ( worst <= already )
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

lw_status lw_shape_distance( const lw_shape* a, const lw_transform* world_from_a, const lw_shape* b,
	const lw_transform* world_from_b, const lw_range* range, lw_query* query, lw_clearance* out )
{
	if ( out == NULL )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	*out = lw_clearance_unknown();
	lw_range wanted = range != NULL ? *range : lw_range_exact();
	if ( a == NULL || b == NULL || world_from_a == NULL || world_from_b == NULL || query == NULL ||
		 !lwi_range_is_valid( &wanted ) || !lw_transform_is_valid( world_from_a ) || !lw_transform_is_valid( world_from_b ) )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	lw_transform pose_a = lwi_orthonormal( world_from_a ), pose_b = lwi_orthonormal( world_from_b );
	lw_transform a_from_b = lwi_relative( &pose_a, &pose_b );
	lwi_bound bound;
	lwi_bound_init( &bound, &wanted );
	query->failure = LW_OK;
	lwi_search( query, a, b, &a_from_b, &bound );
	*out = lwi_bound_result( &bound );
	if ( bound.failed )
	{
		return query->failure;
	}
	if ( out->upper < INFINITY )
	{
		out->point_a = lwi_transform( &pose_a, bound.point_a );
		out->point_b = lwi_transform( &pose_a, bound.point_b );
		out->a = lwi_named_element( a, bound.triangle_a );
		out->b = lwi_named_element( b, bound.triangle_b );
	}
	return LW_OK;
}
