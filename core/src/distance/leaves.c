// SPDX-License-Identifier: BSD-3-Clause
// Leaves against leaves: eight items at a time by floats, the remaining ones in double.
//
// Two leaves of triangles go through slabs and batches, the rest is one item against eight: a ball is its sphere, a triangle
// before boxes its box in their frame, a box before boxes the sphere around it.
#include "distance/pair_query.h"

// --- one sphere against a leaf ---------------------------------------------------------------------------------------

uint32_t lwi_leaf_mask( const lwi_searching* s, const lw_shape* shape, lwi_ref leaf, const float sphere[4],
	float gap[LWI_WIDTH], float direction[3][LWI_WIDTH] )
{
	uint32_t index = lwi_ref_index( leaf ), real = lwi_low_bits( lwi_ref_count( leaf ) );
	switch ( shape->family )
	{
	case LWI_BALLS:
		return s->kernels->sphere_gap( shape->ball_leaves[index].x, sphere, s->limit, gap ) & real;
	case LWI_BOXES:
		return s->kernels->box_gap( &shape->box_leaves[index].boxes, sphere, s->limit, gap ) & real;
	case LWI_TRIANGLES:
	case LWI_CONVEX:
	case LWI_UNBOUNDED:
		break;
	}
	return s->kernels->leaf_gap( &shape->leaves[index], sphere, s->limit, gap, direction ) & real;
}

uint32_t lwi_leaf_item( const lw_shape* shape, lwi_ref leaf, uint32_t lane )
{
	uint32_t index = lwi_ref_index( leaf );
	return shape->family == LWI_BALLS   ? shape->ball_leaves[index].child[lane]
		   : shape->family == LWI_BOXES ? shape->box_leaves[index].box[lane]
										: shape->leaves[index].triangle[lane];
}

void lwi_box_leaf_spheres( const lwi_box_leaf* leaf, lwi_node* spheres )
{
	for ( uint32_t lane = 0; lane < LWI_WIDTH; ++lane )
	{
		float half[3], middle[3];
		for ( int axis = 0; axis < 3; ++axis )
		{
			half[axis] = 0.5f * ( leaf->boxes.max[axis][lane] - leaf->boxes.min[axis][lane] );
			middle[axis] = leaf->boxes.min[axis][lane] + half[axis];
		}
		spheres->x[lane] = middle[0];
		spheres->y[lane] = middle[1];
		spheres->z[lane] = middle[2];
		// a few roundings of the coordinates: the slack of gaps takes them in
		spheres->r[lane] = sqrtf( half[0] * half[0] + half[1] * half[1] + half[2] * half[2] );
	}
}

// --- the front -------------------------------------------------------------------------------------------------------

/// Notes the gaps of lanes that were dropped, if there is a front.
static void note_lanes( lwi_searching* s, uint32_t part, uint32_t dropped, const float gap[LWI_WIDTH] )
{
	if ( s->front != NULL )
	{
		lwi_front_note_lanes( s->front, part, dropped, gap );
	}
}

// --- triangles against triangles -------------------------------------------------------------------------------------

void lwi_flush_batch( lwi_searching* s )
{
	lwi_batch* batch = &s->memory->batch;
	if ( batch->count == 0 )
	{
		return;
	}
	uint32_t used = batch->count;
	batch->count = 0;
	float gap[LWI_WIDTH];
	// lanes from `used` on are stale pairs of an earlier batch
	const float limit = s->front != NULL ? s->limit + (float)s->front->ahead : s->limit;
	uint32_t mask = s->kernels->triangle_gap( batch->a, batch->b, limit, gap ) & lwi_low_bits( used );
	s->memory->stats.triangle_tests += used;
	for ( uint32_t lane = 0; s->front != NULL && lane < used; ++lane )
	{
		lwi_front_note( s->front, batch->part[lane], gap[lane] );
	}
	uint32_t lanes[LWI_WIDTH];
	uint32_t count = lwi_sorted_lanes( gap, mask, lanes );
	for ( uint32_t i = 0; i < count && !s->bound->done; ++i )
	{
		uint32_t lane = lanes[i];
		if ( !( gap[lane] >= s->limit ) )
		{
			lwi_measure_items( s, batch->triangle_a[lane], batch->triangle_b[lane] );
		}
	}
}

/// @param e leaves a and b @param b their triangles in a's frame, of which lane `moved` is lane_b
static void add_to_batch( lwi_searching* s, const lwi_entry* e, uint32_t lane_a, lwi_triangles8 b, uint32_t moved,
	uint32_t lane_b )
{
	const lwi_leaf* a = &s->a->leaves[lwi_ref_index( e->side[LWI_A].ref )];
	lwi_batch* batch = &s->memory->batch;
	uint32_t at = batch->count++;
	for ( int vertex = 0; vertex < 3; ++vertex )
	{
		for ( int axis = 0; axis < 3; ++axis )
		{
			batch->a[vertex][axis][at] = a->v[vertex][axis][lane_a];
			batch->b[vertex][axis][at] = b[vertex][axis][moved];
		}
	}
	batch->triangle_a[at] = a->triangle[lane_a];
	batch->triangle_b[at] = s->b->leaves[lwi_ref_index( e->side[LWI_B].ref )].triangle[lane_b];
	if ( s->front != NULL )
	{
		batch->part[at] =
			lwi_front_add( s->front, e->side[LWI_A].obb, e->side[LWI_B].obb, LWI_FRONT_PAIR | lane_a * LWI_WIDTH | lane_b );
	}
	if ( batch->count == LWI_WIDTH )
	{
		lwi_flush_batch( s );
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
static void project_leaves( lwi_searching* s, const lwi_leaf* a, const lwi_leaf* b, const float direction[3],
	float high_a[LWI_WIDTH], float low_b[LWI_WIDTH] )
{
	// in double: normals of small triangles have squares that a float cannot hold, and a slab is one only along a unit
	// vector
	double x = (double)direction[0], y = (double)direction[1], z = (double)direction[2],
		   norm = sqrt( x * x + y * y + z * z );
	double inverse = norm > 0 ? 1 / norm : 0;
	float n[3] = { (float)( x * inverse ), (float)( y * inverse ), (float)( z * inverse ) };
	const lwi_motion* m = &s->from_other[LWI_A];
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

/// Extents of the lanes of two leaves along a few directions.
typedef struct lane_slabs
{
	const float ( *high_a )[LWI_WIDTH];
	const float ( *low_b )[LWI_WIDTH];
	uint32_t count; ///< 2 or 3
} lane_slabs;

/// Notes the widest slabs of a triangle of a, `i`, and those of b that they dropped.
static void note_slabs( lwi_searching* s, uint32_t part, const lane_slabs* all, uint32_t i, uint32_t dropped )
{
	float widest[LWI_WIDTH];
	for ( int j = 0; j < LWI_WIDTH; ++j )
	{
		const float first = all->low_b[0][j] - all->high_a[0][i], second = all->low_b[1][j] - all->high_a[1][i];
		widest[j] = first > second ? first : second;
	}
	for ( int j = 0; all->count > 2 && j < LWI_WIDTH; ++j )
	{
		const float third = all->low_b[2][j] - all->high_a[2][i];
		widest[j] = third > widest[j] ? third : widest[j];
	}
	lwi_front_note_lanes( s->front, part, dropped, widest );
}

/// Pairs of lanes that no slab drops wait in the batch.
static void add_pairs( lwi_searching* s, const lwi_entry* e, const lane_slabs* all, uint32_t mask_a, uint32_t mask_b,
	uint32_t part )
{
	lwi_triangles8 moved;
	bool have_moved = false;
	for ( ; mask_a != 0 && !s->bound->done; mask_a &= mask_a - 1 )
	{
		uint32_t i = lwi_lowest_bit( mask_a );
		float high[3] = { all->high_a[0][i], all->high_a[1][i], all->count > 2 ? all->high_a[2][i] : 0 };
		uint32_t mask = s->kernels->slab_gap( all->low_b, high, s->limit, all->count ) & mask_b;
		if ( s->front != NULL && mask != mask_b )
		{
			note_slabs( s, part, all, i, mask_b & ~mask );
		}
		if ( mask != 0 && !have_moved )
		{
			s->kernels->leaf_transform( &s->b->leaves[lwi_ref_index( e->side[LWI_B].ref )], &s->from_other[LWI_A], moved );
			have_moved = true;
		}
		for ( ; mask != 0; mask &= mask - 1 )
		{
			uint32_t j = lwi_lowest_bit( mask );
			add_to_batch( s, e, i, moved, j, j );
		}
	}
}

/// All triangle pairs of two leaves: spheres against triangles, then two slabs common to all pairs, then the batch.
static void compare_triangles( lwi_searching* s, lwi_entry* e, uint32_t part )
{
	const lwi_leaf* a = &s->a->leaves[lwi_ref_index( e->side[LWI_A].ref )];
	const lwi_leaf* b = &s->b->leaves[lwi_ref_index( e->side[LWI_B].ref )];
	uint32_t count_a = lwi_ref_count( e->side[LWI_A].ref ), count_b = lwi_ref_count( e->side[LWI_B].ref );
	s->memory->stats.leaf_tests++;
	float high_a[3][LWI_WIDTH], low_b[3][LWI_WIDTH];
	uint32_t slabs = 2;
	if ( s->has_direction )
	{
		project_leaves( s, a, b, s->direction[LWI_A], high_a[2], low_b[2] );
		float high = high_a[2][0], low = low_b[2][0];
		for ( int lane = 1; lane < LWI_WIDTH; ++lane )
		{
			high = high_a[2][lane] > high ? high_a[2][lane] : high;
			low = low_b[2][lane] < low ? low_b[2][lane] : low;
		}
		if ( low - high >= s->limit )
		{
			if ( s->front != NULL )
			{
				lwi_front_note( s->front, part, low - high );
			}
			return;
		}
		slabs = 3;
	}

	float sphere[4], gap_a[LWI_WIDTH], gap_b[LWI_WIDTH], direction_a[3][LWI_WIDTH], direction_b[3][LWI_WIDTH];
	lwi_other_sphere( s, e, LWI_A, sphere );
	uint32_t mask_a = s->kernels->leaf_gap( a, sphere, s->limit, gap_a, direction_a ) & lwi_low_bits( count_a );
	uint32_t nearest = least_lane( gap_a, count_a );
	float along[3] = { direction_a[0][nearest], direction_a[1][nearest], direction_a[2][nearest] };
	if ( gap_a[nearest] < s->guess_gap )
	{
		s->guess_gap = gap_a[nearest];
		lwi_set_direction( s, lwi_v3( 0, 0, 0 ), lwi_v3( (double)along[0], (double)along[1], (double)along[2] ) );
	}
	note_lanes( s, part, lwi_low_bits( count_a ) & ~mask_a, gap_a );
	if ( mask_a == 0 )
	{
		return;
	}
	lwi_other_sphere( s, e, LWI_B, sphere );
	uint32_t mask_b = s->kernels->leaf_gap( b, sphere, s->limit, gap_b, direction_b ) & lwi_low_bits( count_b );
	note_lanes( s, part, lwi_low_bits( count_b ) & ~mask_b, gap_b );
	if ( mask_b == 0 )
	{
		return;
	}
	project_leaves( s, a, b, along, high_a[0], low_b[0] );
	// from b's side the direction points from b to a: turned around, and into a's frame
	nearest = least_lane( gap_b, count_b );
	float back[3] = { -direction_b[0][nearest], -direction_b[1][nearest], -direction_b[2][nearest] };
	const lwi_motion* m = &s->from_other[LWI_A];
	for ( int i = 0; i < 3; ++i )
	{
		along[i] = m->r[3 * i] * back[0] + m->r[3 * i + 1] * back[1] + m->r[3 * i + 2] * back[2];
	}
	project_leaves( s, a, b, along, high_a[1], low_b[1] );

	const lane_slabs all = { (const float( * )[LWI_WIDTH])high_a, (const float( * )[LWI_WIDTH])low_b, slabs };
	add_pairs( s, e, &all, mask_a, mask_b, part );
}

void lwi_compare_again( lwi_searching* s, const lwi_entry* e, uint32_t lane_a, uint32_t lane_b )
{
	const lwi_leaf* b = &s->b->leaves[lwi_ref_index( e->side[LWI_B].ref )];
	lwi_triangles8 moved;
	for ( int k = 0; k < 3; ++k )
	{
		const float v[3] = { b->v[k][0][lane_b], b->v[k][1][lane_b], b->v[k][2][lane_b] };
		float out[3];
		lwi_move_center( &s->from_other[LWI_A], v, out );
		for ( int axis = 0; axis < 3; ++axis )
		{
			moved[k][axis][0] = out[axis];
		}
	}
	add_to_batch( s, e, lane_a, moved, 0, lane_b );
}

// --- anything else ---------------------------------------------------------------------------------------------------

/// Measures an item of one side (`one_is_a`) against the lanes of a leaf of the other, nearest first.
static void measure_lanes( lwi_searching* s, bool one_is_a, uint32_t one, const lw_shape* other, lwi_ref leaf,
	const float gap[LWI_WIDTH], uint32_t mask )
{
	uint32_t lanes[LWI_WIDTH];
	uint32_t count = lwi_sorted_lanes( gap, mask, lanes );
	for ( uint32_t i = 0; i < count && !s->bound->done; ++i )
	{
		if ( !( gap[lanes[i]] >= s->limit ) )
		{
			uint32_t item = lwi_leaf_item( other, leaf, lanes[i] );
			lwi_measure_items( s, one_is_a ? one : item, one_is_a ? item : one );
		}
	}
}

/// Balls, or the spheres around boxes, one by one against the items of the other leaf.
static void compare_spheres( lwi_searching* s, lwi_entry* e, bool spheres_are_a, uint32_t part )
{
	const int my_side = spheres_are_a ? LWI_A : LWI_B, other_side = 1 - my_side;
	const lw_shape *mine = lwi_shape_of( s, my_side ), *other = lwi_shape_of( s, other_side );
	lwi_ref my_leaf = e->side[my_side].ref, other_leaf = e->side[other_side].ref;
	const lwi_motion* other_from_mine = &s->from_other[other_side];
	float sphere[4], gap[LWI_WIDTH], inner[LWI_WIDTH], direction[3][LWI_WIDTH];
	lwi_other_sphere( s, e, my_side, sphere );
	uint32_t lanes[LWI_WIDTH];
	const uint32_t near = lwi_leaf_mask( s, mine, my_leaf, sphere, gap, direction );
	note_lanes( s, part, lwi_low_bits( lwi_ref_count( my_leaf ) ) & ~near, gap );
	uint32_t count = lwi_sorted_lanes( gap, near, lanes );
	lwi_node around;
	const lwi_node* spheres = &around;
	if ( mine->family == LWI_BALLS )
	{
		spheres = &mine->ball_leaves[lwi_ref_index( my_leaf )];
	}
	else if ( count > 0 )
	{
		lwi_box_leaf_spheres( &mine->box_leaves[lwi_ref_index( my_leaf )], &around );
	}
	for ( uint32_t i = 0; i < count && !s->bound->done; ++i )
	{
		uint32_t lane = lanes[i];
		if ( gap[lane] >= s->limit )
		{
			note_lanes( s, part, 1u << lane, gap );
			continue;
		}
		const float center[3] = { spheres->x[lane], spheres->y[lane], spheres->z[lane] };
		lwi_move_center( other_from_mine, center, sphere );
		sphere[3] = spheres->r[lane];
		uint32_t mask = lwi_leaf_mask( s, other, other_leaf, sphere, inner, direction );
		note_lanes( s, part, lwi_low_bits( lwi_ref_count( other_leaf ) ), inner );
		if ( mask != 0 )
		{
			measure_lanes( s, spheres_are_a, lwi_leaf_item( mine, my_leaf, lane ), other, other_leaf, inner, mask );
		}
	}
}

/// Width of the slab between a triangle (frame of the boxes) and a box, along the triangle's normal. As for triangles, it is
/// at most the distance whatever rounding made of the normal.
static float normal_gap( const float v[3][3], const lwi_box8* boxes, uint32_t lane )
{
	float e[3], f[3], n[3];
	for ( int axis = 0; axis < 3; ++axis )
	{
		e[axis] = v[1][axis] - v[0][axis];
		f[axis] = v[2][axis] - v[0][axis];
	}
	for ( int axis = 0; axis < 3; ++axis )
	{
		int next = ( axis + 1 ) % 3, last = ( axis + 2 ) % 3;
		n[axis] = e[next] * f[last] - e[last] * f[next];
	}
	// as the kernels' least divisor: below it underflow of the products would be worth more than LWI_GAP_UNDERFLOW
	float length = sqrtf( n[0] * n[0] + n[1] * n[1] + n[2] * n[2] );
	if ( !( length >= 0x1p-63f ) )
	{
		return -INFINITY;
	}
	// both about the middle of the box: no large coordinates cancel
	float middle[3], reach = 0, low = INFINITY, high = -INFINITY;
	for ( int axis = 0; axis < 3; ++axis )
	{
		float half = 0.5f * ( boxes->max[axis][lane] - boxes->min[axis][lane] );
		middle[axis] = boxes->min[axis][lane] + half;
		reach += half * fabsf( n[axis] );
	}
	for ( int k = 0; k < 3; ++k )
	{
		float d = n[0] * ( v[k][0] - middle[0] ) + n[1] * ( v[k][1] - middle[1] ) + n[2] * ( v[k][2] - middle[2] );
		low = d < low ? d : low;
		high = d > high ? d : high;
	}
	float above = low - reach, below = -high - reach;
	return ( above > below ? above : below ) / length;
}

/// Triangles, one by one in the frame of the boxes: by their boxes there, then along their normals.
static void compare_boxes( lwi_searching* s, lwi_entry* e, bool triangles_are_a )
{
	const lw_shape* triangles = triangles_are_a ? s->a : s->b;
	const lw_shape* boxes = triangles_are_a ? s->b : s->a;
	const int mine = triangles_are_a ? LWI_A : LWI_B, other = 1 - mine;
	lwi_ref leaf_ref = e->side[mine].ref, box_ref = e->side[other].ref;
	const lwi_leaf* leaf = &triangles->leaves[lwi_ref_index( leaf_ref )];
	const lwi_box_leaf* box_leaf = &boxes->box_leaves[lwi_ref_index( box_ref )];
	float sphere[4], gap[LWI_WIDTH], inner[LWI_WIDTH], direction[3][LWI_WIDTH];
	lwi_other_sphere( s, e, other, sphere );
	uint32_t near = lwi_leaf_mask( s, boxes, box_ref, sphere, inner, direction );
	if ( near == 0 )
	{
		return;
	}
	lwi_other_sphere( s, e, mine, sphere );
	uint32_t lanes[LWI_WIDTH];
	uint32_t count = lwi_sorted_lanes( gap, lwi_leaf_mask( s, triangles, leaf_ref, sphere, gap, direction ), lanes );
	lwi_triangles8 moved;
	if ( count > 0 )
	{
		s->kernels->leaf_transform( leaf, &s->from_other[other], moved );
	}
	for ( uint32_t i = 0; i < count && !s->bound->done; ++i )
	{
		uint32_t lane = lanes[i];
		if ( gap[lane] >= s->limit )
		{
			return;
		}
		float v[3][3], min[3], max[3];
		for ( int axis = 0; axis < 3; ++axis )
		{
			for ( int k = 0; k < 3; ++k )
			{
				v[k][axis] = moved[k][axis][lane];
			}
			min[axis] = fminf( fminf( v[0][axis], v[1][axis] ), v[2][axis] );
			max[axis] = fmaxf( fmaxf( v[0][axis], v[1][axis] ), v[2][axis] );
		}
		uint32_t mask = s->kernels->box_pair_gap( &box_leaf->boxes, min, max, s->limit, inner ) & near;
		for ( uint32_t left = mask; left != 0; left &= left - 1 )
		{
			uint32_t j = lwi_lowest_bit( left );
			float by_normal = normal_gap( (const float( * )[3])v, &box_leaf->boxes, j );
			inner[j] = by_normal > inner[j] ? by_normal : inner[j];
			mask &= inner[j] >= s->limit ? ~( 1u << j ) : ~0u;
		}
		measure_lanes( s, triangles_are_a, leaf->triangle[lane], boxes, box_ref, inner, mask );
	}
}

void lwi_compare_leaves( lwi_searching* s, lwi_entry* e, uint32_t part )
{
	lwi_family a = s->a->family, b = s->b->family;
	if ( a == LWI_TRIANGLES && b == LWI_TRIANGLES )
	{
		compare_triangles( s, e, part );
		// the first finds are flushed at once: a low bound early is worth more than full lanes
		if ( s->memory->batch.count >= LWI_WIDTH / 2 || s->bound->upper == INFINITY )
		{
			lwi_flush_batch( s );
		}
		return;
	}
	s->memory->stats.leaf_tests++;
	if ( a == LWI_BALLS || b == LWI_BALLS )
	{
		compare_spheres( s, e, a == LWI_BALLS, part );
	}
	else if ( a == LWI_TRIANGLES || b == LWI_TRIANGLES )
	{
		compare_boxes( s, e, a == LWI_TRIANGLES );
	}
	else
	{
		compare_spheres( s, e, true, part );
	}
}
