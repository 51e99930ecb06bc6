// SPDX-License-Identifier: BSD-3-Clause
// Planes between bounded shapes: GJK on their convex hulls, with support points from the sphere trees.
//
// Paper: Gilbert, Johnson, Keerthi 1988 (see distance/convex.c). Whatever direction comes out, its gap is that of all
// geometry: a bad one proves less, never something wrong. Between poses the first directions come from extreme points, a
// few points inside the hulls: edges.md.
#include "distance/separation.h"

#include "base/math_inline.h"
#include "distance/simplex.h"
#include "shape/support.h"

#include <math.h>
#include <string.h>

static float dot( const float a[3], const float b[3] )
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
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

/// Keeps the points with weight.
static int reduce( vec_d* w, int count, const nearest_d* nearest )
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

// --- poses ----------------------------------------------------------------------------------------------------------

/// Directions and origins of a plane test over poses.
typedef struct plane_query
{
	lw_vec3 from; ///< b's tree frame's origin at its middle pose: heights are taken from there
	double need;  ///< width of the slab between float heights that proves the limit
} plane_query;

static lw_vec3 origin_of( const lw_transform* at, const lw_shape* shape )
{
	return lwi_transform( at, lwi_load( shape->origin ) );
}

static double size_of( const lw_shape* shape )
{
	return shape->primitive ? shape->sphere_radius : (double)shape->extent;
}

/// No coordinate of the poses' origins is larger than this.
static double coordinates_of( const lwi_swept_poses* s )
{
	const double* t = s->middle.t;
	double far = fabs( t[0] ) + fabs( t[1] ) + fabs( t[2] );
	for ( int i = 1; i < s->count; ++i ) // the first is the middle
	{
		far += fabs( s->at[i].t[0] ) + fabs( s->at[i].t[1] ) + fabs( s->at[i].t[2] );
	}
	return far;
}

/// @param i below the count
static inline const lw_transform* swept_pose( const lwi_swept_poses* s, int i )
{
	return s->count > 1 ? &s->at[i] : &s->middle;
}

/// Dilation that boxes include and supports do not.
static double dilation_of( const lw_shape* shape )
{
	return shape->family == LWI_TRIANGLES ? shape->radius : 0;
}

/// Dilations, and rounding: edges.md.
static plane_query plane_query_of( const lwi_swept_poses* a, const lwi_swept_poses* b, double limit )
{
	plane_query q = { .from = origin_of( &b->middle, b->shape ) };
	double extents = size_of( a->shape ) + size_of( b->shape ), far = coordinates_of( a ) + coordinates_of( b );
	double dilation = dilation_of( a->shape ) + dilation_of( b->shape );
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

/// The farthest point of all poses along n. Returns how far, above q->from.
/// @param start point where the search begins, tree frame; on return the farthest point
static double farthest_of_poses( const lwi_kernels* kernels, lwi_swept_poses* s, const plane_query* q, lw_vec3 n,
	float start[3], lw_vec3* farthest )
{
	double best = -INFINITY;
	float first[3];
	memcpy( first, start, sizeof( first ) );
	for ( int i = 0; i < s->count; ++i )
	{
		float local[3], point[3];
		local_direction( swept_pose( s, i ), n, local );
		memcpy( point, first, sizeof( point ) );
		lw_vec3 origin = lwi_sub( origin_of( swept_pose( s, i ), s->shape ), q->from );
		double high = (double)lwi_support( kernels, s->shape, local, point ) + lwi_dot( n, origin );
		if ( !( high <= best ) )
		{
			best = high;
			lw_vec3 p = lwi_v3( (double)point[0], (double)point[1], (double)point[2] );
			*farthest = lwi_add( origin, lwi_rotate( swept_pose( s, i ), p ) );
			memcpy( start, point, sizeof( point ) );
		}
	}
	return best;
}

/// A point of the poses' hull that is far along n: the middle's farthest, at that pose where it is farthest.
static lw_vec3 far_point( const lwi_kernels* kernels, lwi_swept_poses* s, const plane_query* q, lw_vec3 n, float start[3] )
{
	float local[3];
	local_direction( &s->middle, n, local );
	lwi_support( kernels, s->shape, local, start );
	lw_vec3 farthest = { 0, 0, 0 }, point = lwi_v3( (double)start[0], (double)start[1], (double)start[2] );
	double best = -INFINITY;
	for ( int i = 0; i < s->count; ++i )
	{
		lw_vec3 at = lwi_add( lwi_sub( origin_of( swept_pose( s, i ), s->shape ), q->from ),
			lwi_rotate( swept_pose( s, i ), point ) );
		double high = lwi_dot( n, at );
		if ( !( high <= best ) )
		{
			best = high;
			farthest = at;
		}
	}
	return farthest;
}

/// Of coordinates: heights of boxes in floats. The turned normal is off by 7 u of the length of the vector that it multiplies,
/// the middle and the half axes by 2 u, products and sums by 3 u, the sum of four by 3 u, the difference to the height by 1 u.
#define BOX_SLACK ( 16 * 0.5 * (double)FLT_EPSILON )

/// Puts the box around a shape at all its poses, world axes.
static void make_boxes( lwi_swept_poses* s )
{
	if ( s->boxed )
	{
		return;
	}
	const double *low = s->shape->box_min, *high = s->shape->box_max;
	const lw_vec3 middle = lwi_v3( 0.5 * ( low[0] + high[0] ), 0.5 * ( low[1] + high[1] ), 0.5 * ( low[2] + high[2] ) );
	s->box_size = 0;
	for ( int i = 0; i < s->count; ++i )
	{
		const lw_transform* at = swept_pose( s, i );
		double size = 0;
		s->box_middle[i] = lwi_transform( at, middle );
		for ( int k = 0; k < 9; ++k )
		{
			const double x = 0.5 * ( high[k / 3] - low[k / 3] ) * at->r[k % 3][k / 3];
			s->boxes[i].half[k / 3][k % 3] = (float)x;
			size += fabs( x );
		}
		s->box_size = lwi_larger( s->box_size, size );
	}
	s->boxed = true;
}

/// Planes of the static shape b that the box around a stays below at all its poses. @param room see
/// lwi_kernels::planes_clear
static uint32_t planes_clear( const lwi_kernels* kernels, lwi_swept_poses* a, const lwi_swept_poses* b, const plane_query* q,
	const lwi_planes8* planes, float room[LWI_WIDTH] )
{
	make_boxes( a );
	float r[9];
	for ( int k = 0; k < 9; ++k )
	{
		r[k] = (float)b->middle.r[k / 3][k % 3];
	}
	double far = 0;
	for ( int i = 0; i < a->count; ++i )
	{
		const lw_vec3 middle = lwi_sub( a->box_middle[i], q->from );
		a->boxes[i].middle[0] = (float)middle.x;
		a->boxes[i].middle[1] = (float)middle.y;
		a->boxes[i].middle[2] = (float)middle.z;
		far = lwi_larger( far, fabs( middle.x ) + fabs( middle.y ) + fabs( middle.z ) );
	}
	const double slack = BOX_SLACK * ( far + a->box_size + size_of( b->shape ) );
	return kernels->planes_clear( planes, r, a->boxes, (uint32_t)a->count, lwi_round_up( q->need + slack ),
		lwi_round_down( q->need - slack - dilation_of( a->shape ) ), room );
}

static bool box_stays_below( const lwi_kernels* kernels, lwi_swept_poses* a, const lwi_swept_poses* b, const plane_query* q,
	const lwi_swept_plane* plane )
{
	lwi_planes8 one = { .reach = { 0 } };
	float room[LWI_WIDTH];
	lwi_plane_to_lane( &one, 0, *plane );
	return ( planes_clear( kernels, a, b, q, &one, room ) & 1 ) != 0;
}

/// True if a shape reaches no farther along n (unit to rounding) than `most` above q->from, at any of its poses.
static bool all_stay_below( const lwi_kernels* kernels, lwi_swept_poses* s, const plane_query* q, lw_vec3 n, double most )
{
	for ( int i = 0; i < s->count; ++i )
	{
		float local[3];
		local_direction( swept_pose( s, i ), n, local );
		double left = most - lwi_dot( n, lwi_sub( origin_of( swept_pose( s, i ), s->shape ), q->from ) );
		if ( !( left > -INFINITY && lwi_stays_below( kernels, s->shape, local, lwi_round_down( left ) ) ) )
		{
			return false;
		}
	}
	return true;
}

static lw_vec3 normal_of( const lwi_swept_poses* b, const float direction[3] )
{
	return lwi_rotate( &b->middle, lwi_v3( (double)direction[0], (double)direction[1], (double)direction[2] ) );
}

// --- extreme points ---------------------------------------------------------------------------------------------------

enum
{
	GJK_STEPS = 24 ///< directions tried on the extreme points between two tests of all geometry
};

/// Of the distance of their hulls: a gap that wide is not worth another step.
#define WIDE_ENOUGH 0.5

/// Points inside the hull of a shape at all its poses.
typedef struct extremes
{
	const lwi_points8* points;
	uint32_t blocks;
	const lw_transform* local;       ///< frame of the points; NULL: axes of the poses' frame
	lw_vec3 origin;                  ///< theirs, above q->from
	lw_vec3 cut[LWI_MAX_DIRECTIONS]; ///< further points, from searches of all geometry; above q->from
	int cuts;
} extremes;

static void make_cloud( const lwi_kernels* kernels, lwi_swept_poses* s )
{
	lwi_cloud* cloud = s->cloud;
	lw_vec3 middle = origin_of( &s->middle, s->shape );
	uint32_t blocks = s->shape->extreme_blocks;
	for ( int i = 0; i < s->count; ++i )
	{
		lwi_motion motion;
		lw_vec3 from = lwi_sub( origin_of( swept_pose( s, i ), s->shape ), middle );
		for ( int k = 0; k < 9; ++k )
		{
			motion.r[k] = (float)swept_pose( s, i )->r[k / 3][k % 3];
		}
		motion.t[0] = (float)from.x;
		motion.t[1] = (float)from.y;
		motion.t[2] = (float)from.z;
		kernels->points_move( s->shape->extreme_points, blocks, &motion, cloud->points + blocks * (uint32_t)i );
	}
	cloud->blocks = blocks * (uint32_t)s->count;
	cloud->made = true;
}

static extremes extremes_of( const lwi_kernels* kernels, lwi_swept_poses* s, const plane_query* q )
{
	extremes c;
	c.points = s->shape->extreme_points;
	c.blocks = s->shape->extreme_blocks;
	c.local = &s->middle;
	c.cuts = 0;
	c.origin = lwi_sub( origin_of( &s->middle, s->shape ), q->from );
	if ( s->count > 1 )
	{
		if ( !s->cloud->made )
		{
			make_cloud( kernels, s );
		}
		c.points = s->cloud->points;
		c.blocks = s->cloud->blocks;
		c.local = NULL;
	}
	return c;
}

/// Support of extreme points along n, and the index of its support point.
static double extremes_support( const lwi_kernels* kernels, const extremes* c, lw_vec3 n, uint32_t* which )
{
	float high, direction[3];
	lw_vec3 local = c->local != NULL ? lwi_unrotate( c->local, n ) : n;
	direction[0] = (float)local.x;
	direction[1] = (float)local.y;
	direction[2] = (float)local.z;
	*which = kernels->points_farthest( c->points, c->blocks, direction, &high );
	double reach = (double)high + lwi_dot( n, c->origin );
	for ( int i = 0; i < c->cuts; ++i )
	{
		double other = lwi_dot( n, c->cut[i] );
		if ( other > reach )
		{
			reach = other;
			*which = c->blocks * LWI_WIDTH + (uint32_t)i;
		}
	}
	return reach;
}

static lw_vec3 extreme_point( const extremes* c, uint32_t which )
{
	if ( which >= c->blocks * LWI_WIDTH )
	{
		return c->cut[which - c->blocks * LWI_WIDTH];
	}
	const lwi_points8* block = &c->points[which / LWI_WIDTH];
	uint32_t lane = which % LWI_WIDTH;
	lw_vec3 p = lwi_v3( (double)block->at[0][lane], (double)block->at[1][lane], (double)block->at[2][lane] );
	return lwi_add( c->origin, c->local != NULL ? lwi_rotate( c->local, p ) : p );
}

/// The same in the tree frame of the shape; for a point of the cut `point` keeps the pose where the cut was found.
static void extreme_start( const lw_shape* shape, const extremes* c, uint32_t which, float point[3] )
{
	if ( which >= c->blocks * LWI_WIDTH )
	{
		return;
	}
	const lwi_points8* block = &shape->extreme_points[which / LWI_WIDTH % shape->extreme_blocks];
	for ( int k = 0; k < 3; ++k )
	{
		point[k] = block->at[k][which % LWI_WIDTH];
	}
}

/// GJK between two sets of extreme points.
typedef struct gjk
{
	extremes a, b;
	double need;
	vec_d w[4];
	int count;
	double upper; ///< of the distance of their hulls; 0 at first: the first good enough direction ends the search
	lw_vec3 n;    ///< unit, from a to b: the direction to try next
	uint32_t which_a, which_b; ///< points that are nearest to the plane
	double high, low;          ///< of a and of b along it
} gjk;

/// LWI_APART: s->n is the direction in which to search for a plane.
static lwi_separation separate_extremes( const lwi_kernels* kernels, gjk* s )
{
	for ( int step = 0; step < GJK_STEPS; ++step )
	{
		s->high = extremes_support( kernels, &s->a, s->n, &s->which_a );
		s->low = -extremes_support( kernels, &s->b, lwi_scale( -1, s->n ), &s->which_b );
		if ( s->low - s->high >= s->need && s->low - s->high >= WIDE_ENOUGH * s->upper )
		{
			return LWI_APART;
		}
		lw_vec3 difference = lwi_sub( extreme_point( &s->b, s->which_b ), extreme_point( &s->a, s->which_a ) );
		s->w[s->count++] = ( vec_d ){ difference.x, difference.y, difference.z };
		nearest_d nearest;
		if ( nearest_to_origin_d( s->w, s->count, true, &nearest ) )
		{
			return LWI_MEET;
		}
		s->count = reduce( s->w, s->count, &nearest );
		s->upper = sqrt( nearest.sq );
		bool near = nearest.sq < s->need * s->need;
		if ( s->count == 4 || !( s->upper > 0 && s->upper < INFINITY ) )
		{
			return near ? LWI_NEAR : LWI_UNKNOWN;
		}
		s->n = lwi_scale( 1 / s->upper, lwi_v3( nearest.v.x, nearest.v.y, nearest.v.z ) );
		if ( near )
		{
			return LWI_NEAR;
		}
	}
	return LWI_UNKNOWN;
}

/// True if everything stays below a plane of b. @param extremes_b NULL: b is static
static bool hulls_stay_below( const lwi_kernels* kernels, lwi_swept_poses* a, lwi_swept_poses* b, const plane_query* q,
	const extremes* extremes_a, const extremes* extremes_b, lwi_swept_plane plane )
{
	uint32_t which_a, which_b = 0;
	lw_vec3 n = normal_of( b, plane.direction ), down = lwi_scale( -1, n ), lowest;
	double high = extremes_support( kernels, extremes_a, n, &which_a );
	double bottom =
		-( extremes_b == NULL ? (double)plane.reach_b : extremes_support( kernels, extremes_b, down, &which_b ) );
	if ( !( high <= bottom - q->need ) )
	{
		return false; // extreme points belong to the shape: if they are not below, the shape is not
	}
	if ( extremes_b != NULL )
	{
		float point[3];
		extreme_start( b->shape, extremes_b, which_b, point );
		bottom = -farthest_of_poses( kernels, b, q, down, point, &lowest );
	}
	return all_stay_below( kernels, a, q, n, bottom - q->need );
}

uint32_t lwi_swept_apart_by( const lwi_kernels* kernels, lwi_swept_poses* a, lwi_swept_poses* b, double limit,
	const lwi_planes8* known )
{
	const plane_query q = plane_query_of( a, b, limit );
	const bool stands = b->count == 1;
	float room[LWI_WIDTH];
	if ( stands )
	{
		uint32_t clear = planes_clear( kernels, a, b, &q, known, room );
		if ( clear != 0 )
		{
			return lwi_lowest_bit( clear );
		}
	}
	extremes extremes_a = extremes_of( kernels, a, &q ), extremes_b;
	if ( !stands )
	{
		extremes_b = extremes_of( kernels, b, &q );
		memset( room, 0, sizeof( room ) );
	}
	for ( uint32_t tries = 0; tries < LWI_WIDTH; ++tries )
	{
		uint32_t lane = 0;
		for ( uint32_t i = 1; i < LWI_WIDTH; ++i )
		{
			lane = room[i] > room[lane] ? i : lane;
		}
		const lwi_swept_plane plane = lwi_plane_of_lane( known, lane );
		if ( !( room[lane] > -INFINITY ) )
		{
			break;
		}
		room[lane] = -INFINITY;
		if ( plane.reach_b < INFINITY &&
			 hulls_stay_below( kernels, a, b, &q, &extremes_a, stands ? NULL : &extremes_b, plane ) )
		{
			return lane;
		}
	}
	return LWI_WIDTH;
}

lwi_separation lwi_separate_swept( const lwi_kernels* kernels, lwi_swept_poses* a, lwi_swept_poses* b, double limit,
	float direction[3], lwi_swept_plane* out )
{
	plane_query q = plane_query_of( a, b, limit );
	float point_a[3], point_b[3], *d = direction;
	if ( !normalize( d ) )
	{
		return LWI_UNKNOWN;
	}
	gjk s = { .need = q.need, .upper = 0, .n = normal_of( b, d ) };
	s.a = extremes_of( kernels, a, &q );
	s.b = extremes_of( kernels, b, &q );
	for ( int tried = 0; tried < LWI_MAX_DIRECTIONS; ++tried )
	{
		lwi_separation found = separate_extremes( kernels, &s );
		local_direction( &b->middle, s.n, d );
		if ( found != LWI_APART || !normalize( d ) )
		{
			return found == LWI_APART ? LWI_UNKNOWN : found;
		}
		extreme_start( a->shape, &s.a, s.which_a, point_a );
		extreme_start( b->shape, &s.b, s.which_b, point_b );
		lw_vec3 n = normal_of( b, d ), lowest;
		double low = -farthest_of_poses( kernels, b, &q, lwi_scale( -1, n ), point_b, &lowest );
		const lwi_swept_plane next = { { d[0], d[1], d[2] }, lwi_round_up( -low ) };
		if ( box_stays_below( kernels, a, b, &q, &next ) || all_stay_below( kernels, a, &q, n, low - q.need ) )
		{
			*out = next;
			return LWI_APART;
		}
		// the farthest point of a only chooses the next direction
		s.a.cut[s.a.cuts++] = far_point( kernels, a, &q, n, point_a );
		s.b.cut[s.b.cuts++] = lowest;
	}
	return LWI_UNKNOWN;
}

// --- two shapes at one pose -----------------------------------------------------------------------------------------

lwi_plane lwi_plane_between( const lw_shape* a, const lw_shape* b, const lwi_motion* b_from_a )
{
	lwi_plane plane;
	float moved[3];
	turn( b_from_a, a->root_sphere, moved );
	for ( int i = 0; i < 3; ++i )
	{
		plane.direction[i] = b->root_sphere[i] - ( moved[i] + b_from_a->t[i] );
	}
	return plane;
}

/// The slab between two shapes, a's tree frame.
typedef struct slab
{
	const lwi_kernels* kernels;
	const lw_shape *a, *b;
	const lwi_motion* m; ///< a_from_b
	float n[3], back[3]; ///< the direction, and b's of the same plane, its tree frame
	float from;          ///< height of b's origin
} slab;

/// True if a stays below a plane, and b above one that is higher by the limit.
static bool slab_holds( const slab* s, double high, double limit )
{
	float most = lwi_round_down( high );
	return lwi_stays_below( s->kernels, s->a, s->n, most ) &&
		   lwi_stays_below( s->kernels, s->b, s->back, lwi_round_down( (double)s->from - ( (double)most + limit ) ) );
}

/// The gap along the slab, and the points that it is between.
static float slab_gap( const slab* s, float point_a[3], float point_b[3], lw_vec3* a, lw_vec3* b )
{
	float high = lwi_support( s->kernels, s->a, s->n, point_a ), moved[3];
	float low = -lwi_support( s->kernels, s->b, s->back, point_b ) + s->from;
	turn( s->m, point_b, moved );
	*a = lwi_v3( (double)point_a[0], (double)point_a[1], (double)point_a[2] );
	*b = lwi_v3( (double)( moved[0] + s->m->t[0] ), (double)( moved[1] + s->m->t[1] ), (double)( moved[2] + s->m->t[2] ) );
	return low - high;
}

bool lwi_separate( const lwi_kernels* kernels, const lw_shape* a, const lw_shape* b, const lwi_motion* m, float limit,
	lwi_plane* plane, int directions )
{
	slab between = { .kernels = kernels, .a = a, .b = b, .m = m };
	turn( m, plane->direction, between.n );
	if ( !normalize( between.n ) )
	{
		return false;
	}
	lw_transform a_from_b;
	for ( int i = 0; i < 9; ++i )
	{
		a_from_b.r[i / 3][i % 3] = (double)m->r[i];
	}
	gjk s = { .need = (double)limit, .n = lwi_v3( (double)between.n[0], (double)between.n[1], (double)between.n[2] ) };
	s.a = ( extremes ){ .points = a->extreme_points, .blocks = a->extreme_blocks };
	s.b = ( extremes ){ .points = b->extreme_points, .blocks = b->extreme_blocks, .local = &a_from_b };
	s.b.origin = lwi_v3( (double)m->t[0], (double)m->t[1], (double)m->t[2] );
	float point_a[3] = { 0, 0, 0 }, point_b[3] = { 0, 0, 0 };
	for ( int tried = 0; tried < directions && separate_extremes( kernels, &s ) == LWI_APART; ++tried )
	{
		between.n[0] = (float)s.n.x;
		between.n[1] = (float)s.n.y;
		between.n[2] = (float)s.n.z;
		turn_back( m, between.n, between.back );
		between.from = dot( between.n, m->t );
		for ( int i = 0; i < 3; ++i )
		{
			between.back[i] = -between.back[i];
		}
		extreme_start( a, &s.a, s.which_a, point_a );
		extreme_start( b, &s.b, s.which_b, point_b );
		lw_vec3 *cut_a = &s.a.cut[s.a.cuts++], *cut_b = &s.b.cut[s.b.cuts++];
		// the extreme points leave some room: a quick test tells whether it is enough, else the gap is computed
		if ( slab_holds( &between, 0.5 * ( s.high + s.low - s.need ), s.need ) ||
			 slab_gap( &between, point_a, point_b, cut_a, cut_b ) >= limit )
		{
			turn_back( m, between.n, plane->direction );
			return true;
		}
	}
	return false;
}
