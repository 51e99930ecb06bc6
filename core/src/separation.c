// SPDX-License-Identifier: BSD-3-Clause
// Planes between bounded shapes: GJK on their convex hulls, with support points from the sphere trees.
//
// Papers: Gilbert, Johnson, Keerthi 1988 (see convex.c); support points by branch and bound as in Ehmann, Lin, "Accurate
// and fast proximity queries between polyhedra using convex surface decomposition", 2001 (hierarchies over hulls). Whatever
// direction comes out, its gap is that of all geometry: a bad one proves less, never something wrong.
#include "separation.h"

#include "math_inline.h"

#include <math.h>
#include <string.h>

#define real double
#define NAME( x ) x##_s
#define FROM( x ) ( x )
#define ADD( a, b ) ( ( a ) + ( b ) )
#define SUB( a, b ) ( ( a ) - ( b ) )
#define MUL( a, b ) ( ( a ) * ( b ) )
#define DIV( a, b ) ( ( a ) / ( b ) )
#define SIGN( a ) ( a )
#define ALL_FACES 1
#include "convex_simplex_impl.h"

/// A subtree still to be looked at, and how far it may reach.
typedef struct candidate
{
	float high;
	lwi_ref ref;
} candidate;

static float dot( const float a[3], const float b[3] )
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static uint32_t greatest( const float value[LWI_WIDTH], uint32_t count )
{
	uint32_t lane = 0;
	for ( uint32_t i = 1; i < count; ++i )
	{
		lane = value[i] > value[lane] ? i : lane;
	}
	return lane;
}

static inline float larger( float a, float b )
{
	return a > b ? a : b;
}

/// True if no value is above the best; a NaN may be passed over, as in greatest(). Most leaves end here.
static inline bool none_above( const float v[LWI_WIDTH], float best )
{
	float first = larger( larger( v[0], v[1] ), larger( v[2], v[3] ) );
	float second = larger( larger( v[4], v[5] ), larger( v[6], v[7] ) );
	return larger( first, second ) <= best;
}

/// Takes the point of a leaf of triangles that is farthest along n, if it is farther than `best`. Returns how far.
static float take_triangles( const lwi_kernels* kernels, const lwi_leaf* leaf, uint32_t count, const float n[3], float best,
	float point[3] )
{
	float low[LWI_WIDTH], high[LWI_WIDTH], farthest = -INFINITY;
	kernels->leaf_project( leaf, n, low, high );
	if ( count == LWI_WIDTH && none_above( high, best ) )
	{
		return best;
	}
	uint32_t lane = greatest( high, count );
	if ( !( high[lane] > best ) )
	{
		return best;
	}
	for ( int v = 0; v < 3; ++v )
	{
		const float p[3] = { leaf->v[v][0][lane], leaf->v[v][1][lane], leaf->v[v][2][lane] };
		if ( dot( n, p ) > farthest )
		{
			farthest = dot( n, p );
			memcpy( point, p, sizeof( p ) );
		}
	}
	return high[lane];
}

static float take_balls( const lwi_kernels* kernels, const lwi_ball_leaf* leaf, uint32_t count, const float n[3], float best,
	float point[3] )
{
	float high[LWI_WIDTH];
	kernels->node_project( leaf, n, best, high );
	uint32_t lane = greatest( high, count );
	if ( !( high[lane] > best ) )
	{
		return best;
	}
	point[0] = leaf->x[lane] + leaf->r[lane] * n[0];
	point[1] = leaf->y[lane] + leaf->r[lane] * n[1];
	point[2] = leaf->z[lane] + leaf->r[lane] * n[2];
	return high[lane];
}

static float take_boxes( const lwi_box_leaf* leaf, uint32_t count, const float n[3], float best, float point[3] )
{
	for ( uint32_t lane = 0; lane < count; ++lane )
	{
		float corner[3];
		for ( int axis = 0; axis < 3; ++axis )
		{
			corner[axis] = n[axis] > 0 ? leaf->boxes.max[axis][lane] : leaf->boxes.min[axis][lane];
		}
		if ( dot( n, corner ) > best )
		{
			best = dot( n, corner );
			memcpy( point, corner, sizeof( corner ) );
		}
	}
	return best;
}

static float take_leaf( const lwi_kernels* kernels, const lw_shape* shape, lwi_ref ref, const float n[3], float best,
	float point[3] )
{
	uint32_t index = lwi_ref_index( ref ), count = lwi_ref_count( ref );
	switch ( shape->family )
	{
	case LWI_BALLS:
		return take_balls( kernels, &shape->ball_leaves[index], count, n, best, point );
	case LWI_BOXES:
		return take_boxes( &shape->box_leaves[index], count, n, best, point );
	case LWI_TRIANGLES:
	case LWI_CONVEX:
	case LWI_UNBOUNDED:
		break;
	}
	return take_triangles( kernels, &shape->leaves[index], count, n, best, point );
}

/// The farthest point of a box, cylinder or cone along n.
static float support_solid( const lw_shape* shape, const float n[3], float point[3] )
{
	float half[3];
	for ( int axis = 0; axis < 3; ++axis )
	{
		half[axis] = lwi_round_up( 0.5 * shape->dimensions[axis] );
	}
	if ( shape->type == LW_SHAPE_BOX )
	{
		for ( int axis = 0; axis < 3; ++axis )
		{
			point[axis] = n[axis] > 0 ? half[axis] : -half[axis];
		}
		return dot( n, point );
	}
	float radius = lwi_round_up( shape->dimensions[0] ), height = half[1]; // half the height
	float across = sqrtf( n[0] * n[0] + n[1] * n[1] ), share = across > 0 ? radius / across : 0;
	bool apex = shape->type == LW_SHAPE_CONE && 2 * height * n[2] >= radius * across;
	point[0] = apex ? 0 : share * n[0];
	point[1] = apex ? 0 : share * n[1];
	point[2] = apex || ( shape->type == LW_SHAPE_CYLINDER && n[2] > 0 ) ? height : -height;
	return dot( n, point );
}

/// How far a shape with a tree, or a solid, reaches along a unit direction, and where, in its tree frame. It never says less
/// than what is true, whatever `point` is to begin with; the nearer that is to the answer, the less is looked at.
static float support( const lwi_kernels* kernels, const lw_shape* shape, const float n[3], float point[3] )
{
	if ( shape->family == LWI_CONVEX )
	{
		return support_solid( shape, n, point );
	}
	candidate stack[( LWI_WIDTH - 1 ) * ( LWI_MAX_DEPTH + 1 ) + LWI_WIDTH];
	uint32_t height = 0;
	float best = dot( n, point );
	stack[height++] = (candidate){ INFINITY, shape->root };
	while ( height > 0 )
	{
		candidate next = stack[--height];
		if ( !( next.high > best ) )
		{
			continue;
		}
		if ( lwi_ref_is_leaf( next.ref ) )
		{
			best = take_leaf( kernels, shape, next.ref, n, best, point );
			continue;
		}
		const lwi_node* node = &shape->nodes[next.ref];
		float high[LWI_WIDTH], farthest = -INFINITY;
		for ( uint32_t mask = kernels->node_project( node, n, best, high ); mask != 0; mask &= mask - 1 )
		{
			uint32_t lane = lwi_lowest_bit( mask ), place = height++;
			if ( high[lane] < farthest ) // the farthest stays on top
			{
				stack[place] = stack[place - 1];
				--place;
			}
			else
			{
				farthest = high[lane];
			}
			stack[place] = (candidate){ high[lane], node->child[lane] };
		}
	}
	return best;
}

static void turn( const lwi_motion* m, const float v[3], float out[3] )
{
	for ( int i = 0; i < 3; ++i )
	{
		out[i] = m->r[3 * i] * v[0] + m->r[3 * i + 1] * v[1] + m->r[3 * i + 2] * v[2];
	}
}

static void turn_back( const lwi_motion* m, const float v[3], float out[3] )
{
	for ( int i = 0; i < 3; ++i )
	{
		out[i] = m->r[i] * v[0] + m->r[3 + i] * v[1] + m->r[6 + i] * v[2];
	}
}

static bool normalize( float n[3] )
{
	// in double: the squares of a short n are no floats
	double x = (double)n[0], y = (double)n[1], z = (double)n[2], length = sqrt( x * x + y * y + z * z );
	for ( int i = 0; i < 3; ++i )
	{
		n[i] = (float)( (double)n[i] / length );
	}
	return length > 0 && length < INFINITY;
}

/// The gap of a and b along n (a's frame, unit), and the difference of their support points: b's less a's.
static float gap_along( const lwi_kernels* kernels, const lw_shape* a, const lw_shape* b, const lwi_motion* m, const float n[3],
	lwi_plane* plane, vec_s* difference )
{
	float n_b[3], moved[3];
	turn_back( m, n, n_b );
	const float back[3] = { -n_b[0], -n_b[1], -n_b[2] };
	float high_a = support( kernels, a, n, plane->point_a );
	float low_b = -support( kernels, b, back, plane->point_b ) + dot( n, m->t );
	turn( m, plane->point_b, moved );
	*difference = (vec_s){ (double)( moved[0] + m->t[0] - plane->point_a[0] ), (double)( moved[1] + m->t[1] - plane->point_a[1] ),
		(double)( moved[2] + m->t[2] - plane->point_a[2] ) };
	return low_b - high_a;
}

/// Keeps the points with weight.
static int reduce( vec_s* w, int count, const nearest_s* nearest )
{
	int kept = 0;
	for ( int i = 0; i < count; ++i )
	{
		if ( nearest->weight[i] > 0 )
		{
			w[kept++] = w[i];
		}
	}
	return kept;
}

lwi_plane lwi_plane_between( const lw_shape* a, const lw_shape* b, const lwi_motion* b_from_a )
{
	lwi_plane plane;
	float moved[3];
	turn( b_from_a, a->root_sphere, moved );
	for ( int i = 0; i < 3; ++i )
	{
		plane.direction[i] = b->root_sphere[i] - ( moved[i] + b_from_a->t[i] );
		plane.point_a[i] = a->root_sphere[i];
		plane.point_b[i] = b->root_sphere[i];
	}
	return plane;
}

bool lwi_separate( const lwi_kernels* kernels, const lw_shape* a, const lw_shape* b, const lwi_motion* m, float limit,
	lwi_plane* plane, int steps )
{
	vec_s w[4];
	int count = 0;
	float n[3];
	turn( m, plane->direction, n );
	for ( int step = 0; step < steps && normalize( n ); ++step )
	{
		float gap = gap_along( kernels, a, b, m, n, plane, &w[count] );
		if ( gap >= limit )
		{
			turn_back( m, n, plane->direction );
			return true;
		}
		++count;
		nearest_s nearest;
		bool inside = nearest_to_origin_s( w, count, &nearest );
		if ( inside || !( nearest.sq >= (double)limit * (double)limit ) )
		{
			return false; // the hulls are nearer than that
		}
		count = reduce( w, count, &nearest );
		n[0] = (float)nearest.v.x;
		n[1] = (float)nearest.v.y;
		n[2] = (float)nearest.v.z;
		if ( count == 4 )
		{
			return false;
		}
	}
	return false;
}

// --- places ----------------------------------------------------------------------------------------------------------

/// How far the box around a shape reaches along n, tree frame. Seven roundings.
static float reach_of_box( const lw_shape* shape, const float n[3] )
{
	float sum = 0;
	for ( int i = 0; i < 3; ++i )
	{
		sum += n[i] * ( n[i] > 0 ? (float)( shape->box_max[i] - shape->origin[i] ) : (float)( shape->box_min[i] - shape->origin[i] ) );
	}
	return sum;
}

/// True if no vertex of a leaf is farther along n than `most`.
static bool leaf_stays_below( const lwi_kernels* kernels, const lw_shape* shape, lwi_ref leaf, const float n[3], float most )
{
	uint32_t index = lwi_ref_index( leaf ), count = lwi_ref_count( leaf ), above = 0;
	if ( shape->family != LWI_TRIANGLES )
	{
		float point[3];
		return take_leaf( kernels, shape, leaf, n, most, point ) <= most;
	}
	float low[LWI_WIDTH], high[LWI_WIDTH];
	kernels->leaf_project( &shape->leaves[index], n, low, high );
	for ( uint32_t i = 0; i < LWI_WIDTH; ++i )
	{
		above |= (uint32_t)!( high[i] <= most ) << i;
	}
	return ( above & ( ( 1u << count ) - 1 ) ) == 0;
}

/// True if a shape reaches no farther along n (tree frame, unit) than `most`: far less is looked at than for how far it reaches.
static bool stays_below( const lwi_kernels* kernels, const lw_shape* shape, const float n[3], float most )
{
	if ( reach_of_box( shape, n ) <= most )
	{
		return true;
	}
	if ( shape->family == LWI_CONVEX )
	{
		float point[3];
		return support_solid( shape, n, point ) <= most;
	}
	lwi_ref stack[( LWI_WIDTH - 1 ) * ( LWI_MAX_DEPTH + 1 ) + LWI_WIDTH];
	uint32_t height = 0;
	stack[height++] = shape->root;
	while ( height > 0 )
	{
		lwi_ref next = stack[--height];
		if ( lwi_ref_is_leaf( next ) )
		{
			if ( !leaf_stays_below( kernels, shape, next, n, most ) )
			{
				return false;
			}
			continue;
		}
		float high[LWI_WIDTH];
		const lwi_node* node = &shape->nodes[next];
		for ( uint32_t mask = kernels->node_project( node, n, most, high ); mask != 0; mask &= mask - 1 )
		{
			stack[height++] = node->child[lwi_lowest_bit( mask )];
		}
	}
	return true;
}

/// Directions and origins of a question about places.
typedef struct between_places
{
	lw_vec3 from; ///< b's tree frame's origin at its middle place: heights are taken from there
	double need;  ///< width of the slab between float heights that proves the limit
} between_places;

static lw_vec3 origin_of( const lw_transform* at, const lw_shape* shape )
{
	return lwi_transform( at, lwi_load( shape->origin ) );
}

static double size_of( const lw_shape* shape )
{
	return shape->solid ? shape->sphere_radius : (double)shape->extent;
}

/// No coordinate of the places' origins is larger than this.
static double coordinates_of( const lwi_places* s )
{
	const double* t = s->middle.t;
	double far = fabs( t[0] ) + fabs( t[1] ) + fabs( t[2] );
	if ( s->drifts )
	{
		const lw_vec3 *v = &s->shift, *w = &s->turn;
		return far + fabs( v->x ) + fabs( v->y ) + fabs( v->z ) + ( fabs( w->x ) + fabs( w->y ) + fabs( w->z ) ) * far;
	}
	for ( int i = 1; i < s->count; ++i ) // the first is the middle
	{
		far += fabs( s->at[i].t[0] ) + fabs( s->at[i].t[1] ) + fabs( s->at[i].t[2] );
	}
	return far;
}

/// The place that a drift leads to, one way or the other.
static lw_transform drifted( const lwi_places* s, double by )
{
	lw_transform m;
	const lw_transform* from = &s->middle;
	const lw_vec3 w = lwi_scale( by, s->turn ), v = lwi_add_scaled( lwi_cross( w, lwi_load( from->t ) ), by, s->shift );
	for ( int k = 0; k < 3; ++k )
	{
		const double x = from->r[0][k], y = from->r[1][k], z = from->r[2][k];
		m.r[0][k] = x + ( w.y * z - w.z * y );
		m.r[1][k] = y + ( w.z * x - w.x * z );
		m.r[2][k] = z + ( w.x * y - w.y * x );
	}
	m.t[0] = from->t[0] + v.x;
	m.t[1] = from->t[1] + v.y;
	m.t[2] = from->t[2] + v.z;
	return m;
}

static void make_places( lwi_places* s )
{
	if ( !s->made )
	{
		s->at[0] = drifted( s, -1 );
		s->at[1] = drifted( s, 1 );
		s->made = true;
	}
}

/// Dilations, and rounding: edges.md.
static between_places question_of( const lwi_places* a, const lwi_places* b, double limit )
{
	between_places q = { .from = origin_of( &b->middle, b->shape ) };
	double extents = size_of( a->shape ) + size_of( b->shape ), far = coordinates_of( a ) + coordinates_of( b );
	double dilation = ( a->shape->family == LWI_TRIANGLES ? a->shape->radius : 0 ) +
					  ( b->shape->family == LWI_TRIANGLES ? b->shape->radius : 0 );
	q.need = ( limit + dilation ) * ( 1 + 0x1p-21 ) + lwi_gap_slack( extents ) + 0x1p-46 * ( far + extents );
	return q;
}

static void local_direction( const lw_transform* at, lw_vec3 n, float local[3] )
{
	lw_vec3 v = lwi_unrotate( at, n );
	local[0] = (float)v.x;
	local[1] = (float)v.y;
	local[2] = (float)v.z;
}

/// The same for one of the places, of length 1. Returns what heights along it are to be multiplied by.
static double place_direction( const lwi_places* s, int i, lw_vec3 n, float local[3] )
{
	if ( !s->drifts )
	{
		local_direction( &s->at[i], n, local );
		return 1;
	}
	lw_vec3 v = lwi_unrotate( &s->at[i], n );
	double length = lwi_length( v ), inverse = 1 / length;
	local[0] = (float)( inverse * v.x );
	local[1] = (float)( inverse * v.y );
	local[2] = (float)( inverse * v.z );
	return length;
}

/// The farthest point of all places along n. Returns how far, above q->from.
/// @param start where to look first, tree frame; where it was found
static double farthest_of_places( const lwi_kernels* kernels, lwi_places* s, const between_places* q, lw_vec3 n,
	float start[3], lw_vec3* farthest )
{
	make_places( s );
	double best = -INFINITY;
	float first[3];
	memcpy( first, start, sizeof( first ) );
	for ( int i = 0; i < s->count; ++i )
	{
		float local[3], point[3];
		double scale = place_direction( s, i, n, local );
		memcpy( point, first, sizeof( point ) );
		lw_vec3 origin = lwi_sub( origin_of( &s->at[i], s->shape ), q->from );
		double high = scale * (double)support( kernels, s->shape, local, point ) + lwi_dot( n, origin );
		if ( !( high <= best ) )
		{
			best = high;
			lw_vec3 p = lwi_v3( (double)point[0], (double)point[1], (double)point[2] );
			*farthest = lwi_add( origin, lwi_rotate( &s->at[i], p ) );
			memcpy( start, point, sizeof( point ) );
		}
	}
	return best;
}

/// A point of the places' hull that is far along n: the middle's farthest, at that of the places where it is farthest.
static lw_vec3 far_point( const lwi_kernels* kernels, lwi_places* s, const between_places* q, lw_vec3 n, float start[3] )
{
	make_places( s );
	float local[3];
	local_direction( &s->middle, n, local );
	support( kernels, s->shape, local, start );
	lw_vec3 farthest = { 0, 0, 0 }, point = lwi_v3( (double)start[0], (double)start[1], (double)start[2] );
	double best = -INFINITY;
	for ( int i = 0; i < s->count; ++i )
	{
		lw_vec3 at = lwi_add( lwi_sub( origin_of( &s->at[i], s->shape ), q->from ), lwi_rotate( &s->at[i], point ) );
		double high = lwi_dot( n, at );
		if ( !( high <= best ) )
		{
			best = high;
			farthest = at;
		}
	}
	return farthest;
}

/// How far a box reaches along n, from the origin of its tree.
static double reach_of_corners( const lw_shape* shape, lw_vec3 n )
{
	const double *low = shape->box_min, *high = shape->box_max, *o = shape->origin;
	return n.x * ( ( n.x > 0 ? high[0] : low[0] ) - o[0] ) + n.y * ( ( n.y > 0 ? high[1] : low[1] ) - o[1] ) +
		   n.z * ( ( n.z > 0 ? high[2] : low[2] ) - o[2] );
}

/// all_stay_below() for the box around a shape. Of what drifts no place is needed: in x +- ( shift + turn x x ),
/// n . ( turn x y ) is y . ( n x turn ).
static bool box_stays_below( const lwi_places* s, const between_places* q, lw_vec3 n, double most )
{
	if ( s->drifts )
	{
		lw_vec3 origin = origin_of( &s->middle, s->shape );
		lw_vec3 along = lwi_unrotate( &s->middle, n ), change = lwi_unrotate( &s->middle, lwi_cross( n, s->turn ) );
		double high = lwi_dot( n, lwi_sub( origin, q->from ) );
		double climb = lwi_dot( n, lwi_add( s->shift, lwi_cross( s->turn, origin ) ) );
		double after = high + climb + reach_of_corners( s->shape, lwi_add( along, change ) );
		double before = high - climb + reach_of_corners( s->shape, lwi_sub( along, change ) );
		return after <= most && before <= most;
	}
	for ( int i = 0; i < s->count; ++i )
	{
		lw_vec3 origin = lwi_sub( origin_of( &s->at[i], s->shape ), q->from );
		if ( !( lwi_dot( n, origin ) + reach_of_corners( s->shape, lwi_unrotate( &s->at[i], n ) ) <= most ) )
		{
			return false;
		}
	}
	return true;
}

/// True if a shape reaches no farther along n (unit to rounding) than `most` above q->from, at any of its places.
static bool all_stay_below( const lwi_kernels* kernels, lwi_places* s, const between_places* q, lw_vec3 n, double most )
{
	make_places( s );
	for ( int i = 0; i < s->count; ++i )
	{
		float local[3];
		double scale = place_direction( s, i, n, local );
		double left = ( most - lwi_dot( n, lwi_sub( origin_of( &s->at[i], s->shape ), q->from ) ) ) / scale;
		if ( !( left > -INFINITY && stays_below( kernels, s->shape, local, lwi_round_down( left ) ) ) )
		{
			return false;
		}
	}
	return true;
}

/// The direction of a plane, and the lowest of b along it.
static lw_vec3 plane_now( const lwi_kernels* kernels, lwi_places* b, const between_places* q, const lwi_places_plane* plane,
	double* bottom )
{
	const float* d = plane->direction;
	lw_vec3 n = lwi_rotate( &b->middle, lwi_v3( (double)d[0], (double)d[1], (double)d[2] ) );
	*bottom = -(double)plane->reach_b; // of b at its middle place; what stands has no other
	if ( b->count > 1 )
	{
		float point[3];
		lw_vec3 lowest;
		memcpy( point, b->shape->root_sphere, sizeof( point ) );
		*bottom = -farthest_of_places( kernels, b, q, lwi_scale( -1, n ), point, &lowest );
	}
	return n;
}

uint32_t lwi_places_apart_by( const lwi_kernels* kernels, lwi_places* a, lwi_places* b, double limit,
	const lwi_places_plane* known, uint32_t count )
{
	between_places q = question_of( a, b, limit );
	for ( uint32_t i = 0; i < count && b->count == 1; ++i ) // boxes are asked first
	{
		double bottom;
		lw_vec3 n = plane_now( kernels, b, &q, &known[i], &bottom );
		if ( box_stays_below( a, &q, n, bottom - q.need ) )
		{
			return i;
		}
	}
	make_places( a );
	for ( uint32_t i = 0; i < count; ++i )
	{
		double bottom;
		lw_vec3 n = plane_now( kernels, b, &q, &known[i], &bottom );
		if ( all_stay_below( kernels, a, &q, n, bottom - q.need ) )
		{
			return i;
		}
	}
	return count;
}

bool lwi_separate_places( const lwi_kernels* kernels, lwi_places* a, lwi_places* b, double limit,
	const float direction[3], int steps, lwi_places_plane* out )
{
	between_places q = question_of( a, b, limit );
	float point_a[3], point_b[3];
	memcpy( point_a, a->shape->root_sphere, sizeof( point_a ) );
	memcpy( point_b, b->shape->root_sphere, sizeof( point_b ) );
	vec_s w[4];
	int count = 0;
	lwi_places_plane next = { .reach_b = 0 };
	float* d = next.direction;
	memcpy( d, direction, 3 * sizeof( float ) );
	for ( int step = 0; step < steps && normalize( d ); ++step )
	{
		lw_vec3 n = lwi_rotate( &b->middle, lwi_v3( (double)d[0], (double)d[1], (double)d[2] ) ), bottom;
		double low = -farthest_of_places( kernels, b, &q, lwi_scale( -1, n ), point_b, &bottom );
		if ( box_stays_below( a, &q, n, low - q.need ) || all_stay_below( kernels, a, &q, n, low - q.need ) )
		{
			next.reach_b = lwi_round_up( -low );
			*out = next;
			return true;
		}
		// what it says of a only decides where to look next
		lw_vec3 difference = lwi_sub( bottom, far_point( kernels, a, &q, n, point_a ) );
		w[count++] = (vec_s){ difference.x, difference.y, difference.z };
		nearest_s nearest;
		bool inside = nearest_to_origin_s( w, count, &nearest );
		if ( inside || !( nearest.sq >= q.need * q.need ) )
		{
			return false; // the hulls are nearer than that
		}
		count = reduce( w, count, &nearest );
		if ( count == 4 )
		{
			return false;
		}
		local_direction( &b->middle, lwi_v3( nearest.v.x, nearest.v.y, nearest.v.z ), d );
	}
	return false;
}
