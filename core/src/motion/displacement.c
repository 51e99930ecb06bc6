// SPDX-License-Identifier: BSD-3-Clause
// The robot's motion along an edge: states, poses of clusters at the ends of cells, and bounds for bodies in between.
//
// A point's displacement is bounded by its positions at both ends and the largest change of its velocity in between (linear
// interpolation), which beats path lengths by far where joints' motions cancel or cells are short. Derivation:
// core/docs/edges.md.
#include "base/arena.h"
#include "checker/pose.h"
#include "motion/edge.h"
#include "base/math_inline.h"

#include <string.h>

enum
{
	SPARE_INTERVALS = 1024 ///< places on a level beyond four per pair
};

// ---- scratch ---------------------------------------------------------------------------------------------------------

/// Lays the scratch out from `memory`; returns its size. Called with NULL to measure, then to place.
static size_t lay_out( lwi_edge* e, void* memory )
{
	lwi_arena arena = lwi_arena_begin( memory, 0 );
	const lw_checker* c = e->checker;
	const size_t clusters = c->base->tree->cluster_count;
	uint32_t variables = c->base->robot->variable_count;
	e->memory = lwi_arena_take( &arena, 1, sizeof( lwi_edge_memory ) );
	e->velocities = lwi_arena_take( &arena, clusters, sizeof( lwi_edge_velocity ) );
	e->motion = lwi_arena_take( &arena, lwi_motion_scratch_size( c->base->motion ), 1 );
	e->full_a = lwi_arena_take( &arena, variables, sizeof( double ) );
	e->full_b = lwi_arena_take( &arena, variables, sizeof( double ) );
	e->full_t = lwi_arena_take( &arena, variables, sizeof( double ) );
	e->tolerance = lwi_arena_take( &arena, variables, sizeof( double ) );
	e->curve = lwi_arena_take( &arena,
		( 2 * ( LW_CURVE_MOST_DEGREE + 1 ) + 4 ) * (size_t)c->base->group.variable_count + variables, sizeof( double ) );
	for ( int i = 0; i < 4; ++i )
	{
		e->ranges[i] = lwi_arena_take( &arena, variables, sizeof( double ) );
	}
	e->speed_now = lwi_arena_take( &arena, variables, sizeof( double ) );
	e->group_t = lwi_arena_take( &arena, c->base->group.variable_count, sizeof( double ) );
	e->frame_t = lwi_arena_take( &arena, LWI_EDGE_FRAMES, sizeof( double ) );
	e->frame_states = lwi_arena_take( &arena, LWI_EDGE_FRAMES * (size_t)variables, sizeof( double ) );
	e->frame_sincos =
		lwi_arena_take( &arena, LWI_EDGE_FRAMES * 2 * (size_t)lwi_padded_clusters( c->base->tree ), sizeof( double ) );
	e->frame_known = lwi_arena_take( &arena, LWI_EDGE_FRAMES * clusters, sizeof( bool ) );
	e->frame_poses = lwi_arena_take( &arena, LWI_EDGE_FRAMES * clusters, sizeof( lw_transform ) );
	e->speeds = lwi_arena_take( &arena, clusters * LWI_WIDTH, sizeof( double ) );
	e->pair_capacity = c->base->moving_body_count + c->base->self.pair_count;
	e->interval_capacity = 4 * e->pair_capacity + SPARE_INTERVALS;
	e->pairs = lwi_arena_take( &arena, e->pair_capacity, sizeof( lwi_edge_pair ) );
	e->levels[0].intervals = lwi_arena_take( &arena, e->interval_capacity, sizeof( lwi_open_interval ) );
	e->levels[1].intervals = lwi_arena_take( &arena, e->interval_capacity, sizeof( lwi_open_interval ) );
	return arena.used;
}

double* lwi_edge_curve_scratch( const lw_checker* checker, lw_query* query )
{
	lwi_edge edge = { .checker = checker };
	return lay_out( &edge, query->scratch.edge ) > query->capacity.edge_bytes ? NULL : edge.curve;
}

bool lwi_edge_begin( lwi_edge* edge )
{
	lw_query* query = edge->query;
	if ( lay_out( edge, query->scratch.edge ) > query->capacity.edge_bytes )
	{
		return false;
	}
	lwi_checker_bind( edge->checker, query );
	if ( edge->memory->bindings != query->pose.bindings )
	{
		memset( edge->memory, 0, sizeof( *edge->memory ) );
		edge->memory->bindings = query->pose.bindings;
	}
	for ( int i = 0; i < 2; ++i )
	{
		edge->triplets[i].cluster = LW_INVALID_INDEX;
	}
	for ( int i = 0; i < LWI_EDGE_FRAMES; ++i )
	{
		edge->frame_t[i] = NAN;
	}
	for ( uint32_t i = 0; i < edge->checker->base->tree->cluster_count; ++i )
	{
		edge->velocities[i].stamp = 0; // no state has it
	}
	lw_checker_full_state( edge->checker, edge->qa, edge->full_a );
	lw_checker_full_state( edge->checker, edge->qb, edge->full_b );
	return true;
}

size_t lwi_edge_scratch_size( const lw_checker* checker, uint32_t spare_bodies )
{
	lwi_edge edge = { .checker = checker };
	// Each more may move, and meet all others: the memory of lay_out() for as many pairs, and its rounding of five arrays
	size_t pairs = spare_bodies * ( 1 + (size_t)checker->base->robot->body_count + spare_bodies );
	size_t more = pairs * ( sizeof( lwi_edge_pair ) + 2 * 4 * sizeof( lwi_open_interval ) ) + 5 * LWI_ALIGNMENT +
				  spare_bodies * ( sizeof( lwi_batch_point ) + sizeof( bool ) + LWI_WIDTH * sizeof( double ) ) +
				  lwi_motion_scratch_spare( spare_bodies );
	return lay_out( &edge, NULL ) + ( spare_bodies > 0 ? more : 0 );
}

// ---- states ----------------------------------------------------------------------------------------------------------

/// Sets the rounding that pairs allow for. @param of_poses metres, of poses and states
static void allow_rounding( lwi_edge* e, double of_poses )
{
	for ( int self = 0; self < 2; ++self )
	{
		// t itself is rounded too (2^-53 of the path), and so is the surplus (2^-53 of min_d, a few times).
		// A quarter of the slack more, with which proofs hold, becomes lower_bound.
		e->rounding[self] = ( 1 + self ) * of_poses + 0x1p-47 * ( e->longest + e->def->min_d + e->tube );
		e->slack[self] = lwi_larger( e->def->slack, 4 * e->rounding[self] );
		e->enough[self] = e->def->min_d + e->rounding[self] + 0.25 * e->slack[self];
	}
}

/// Hands the tolerances of the group's variables to the motion's bounds.
static void tolerate( lwi_edge* e )
{
	const lw_checker* c = e->checker;
	memset( e->tolerance, 0, c->base->robot->variable_count * sizeof( double ) );
	for ( uint32_t i = 0; i < c->base->group.variable_count; ++i )
	{
		e->tolerance[c->base->group.variables[i]] = e->def->tolerance[i];
	}
	lwi_motion_tolerate( c->base->motion, e->motion, e->tolerance );
	e->tube = lwi_motion_largest_tube( e->motion );
}

double lwi_edge_second_difference( const double* points, uint32_t degree, uint32_t stride )
{
	double most = 0;
	for ( uint32_t k = 2; k <= degree; ++k )
	{
		const double *p = points + k * stride, *before = p - stride;
		most = lwi_larger( most, fabs( ( p[0] - before[0] ) - ( before[0] - *( before - stride ) ) ) );
	}
	return most;
}

/// Ranges of a curve's values and derivatives, by their control points: first and second differences. A second difference of
/// rounded differences is off by two of their roundings.
static void bound_variable( const lwi_edge_bend* bend, uint32_t count, uint32_t i, double* out[4], uint32_t v )
{
	const double* p = bend->points + i;
	const double n = bend->degree;
	const double second = lwi_edge_second_difference( p, bend->degree, count );
	double least = p[0], most = p[0], first = 0;
	for ( uint32_t k = 1; k <= bend->degree; ++k )
	{
		least = lwi_smaller( least, p[k * count] );
		most = lwi_larger( most, p[k * count] );
		first = lwi_larger( first, fabs( p[k * count] - p[( k - 1 ) * count] ) );
	}
	out[0][v] = least;
	out[1][v] = most;
	out[2][v] = n * first * LWI_EDGE_OUTWARD;
	out[3][v] = n * ( n - 1 ) * ( second + 0x1p-50 * first ) * LWI_EDGE_OUTWARD;
}

static bool begin_curve( lwi_edge* e )
{
	const lw_checker* c = e->checker;
	const size_t bytes = c->base->robot->variable_count * sizeof( double );
	memcpy( e->ranges[0], e->full_a, bytes );
	memcpy( e->ranges[1], e->full_a, bytes );
	memset( e->ranges[2], 0, bytes );
	memset( e->ranges[3], 0, bytes );
	memset( e->tolerance, 0, bytes );
	memset( e->speed_now, 0, bytes );
	for ( uint32_t i = 0; i < c->base->group.variable_count; ++i )
	{
		bound_variable( e->bend, c->base->group.variable_count, i, e->ranges, c->base->group.variables[i] );
		e->tolerance[c->base->group.variables[i]] = e->bend->deviation[i];
	}
	const lwi_motion_ranges ranges = { e->ranges[0], e->ranges[1], e->ranges[2], e->ranges[3] };
	if ( !lwi_motion_begin_curve( c->base->motion, &ranges, e->motion ) )
	{
		return false;
	}
	e->chord_tube = e->bend->same_way ? lwi_motion_any_tube( c->base->motion, e->motion, e->tolerance ) : INFINITY;
	return true;
}

bool lwi_edge_measure_motion( lwi_edge* e )
{
	const lw_checker* c = e->checker;
	e->apart = e->spare = INFINITY;
	e->most_states = LW_EDGE_MOST_STATES;
	if ( e->bend != NULL ? !begin_curve( e ) : !lwi_motion_begin( c->base->motion, e->full_a, e->full_b, e->motion ) )
	{
		return false;
	}
	if ( e->def->tolerance != NULL )
	{
		tolerate( e );
	}
	if ( !isfinite( e->tube ) )
	{
		return false;
	}
	e->static_rounding = lwi_motion_rounding( e->motion );
	e->longest = lwi_motion_total( e->motion );
	e->twist_error = lwi_motion_twist_error( e->motion );
	allow_rounding( e, e->static_rounding );
	return true;
}

/// Bernstein polynomials of some degree at t.
static void bernstein( uint32_t degree, double t, double out[LW_CURVE_MOST_DEGREE + 1] )
{
	out[0] = 1;
	for ( uint32_t k = 1; k <= degree; ++k )
	{
		out[k] = t * out[k - 1];
		for ( uint32_t i = k - 1; i > 0; --i )
		{
			out[i] = ( 1 - t ) * out[i] + t * out[i - 1];
		}
		out[0] *= 1 - t;
	}
}

void lwi_edge_bend_at( lwi_edge* e, double t, double* state )
{
	const lw_checker* c = e->checker;
	const uint32_t count = c->base->group.variable_count, degree = e->bend->degree;
	double weights[LW_CURVE_MOST_DEGREE + 1], of_differences[LW_CURVE_MOST_DEGREE + 1];
	bernstein( degree, t, weights );
	bernstein( degree - 1, t, of_differences );
	memcpy( state, e->full_a, c->base->robot->variable_count * sizeof( double ) );
	for ( uint32_t i = 0; i < count; ++i )
	{
		const double* p = e->bend->points + i;
		const uint32_t v = c->base->group.variables[i];
		double value = weights[0] * p[0], speed = 0;
		for ( uint32_t k = 1; k <= degree; ++k )
		{
			value += weights[k] * p[k * count];
			speed += of_differences[k - 1] * ( p[k * count] - p[( k - 1 ) * count] );
		}
		state[v] = e->ranges[0][v] < e->ranges[1][v] ? value : p[0]; // quaternions stay as they are given
		e->speed_now[v] = degree * speed;
	}
}

/// The full state at t. All but the group's variables are those of both ends.
static void interpolate( lwi_edge* e, double t, double* state )
{
	const lw_checker* c = e->checker;
	if ( e->bend != NULL )
	{
		lwi_edge_bend_at( e, t, state );
		return;
	}
	if ( c->base->tree->floating_count > 0 )
	{
		lw_robot_interpolate( c->base->robot, e->full_a, e->full_b, t, state );
		return;
	}
	memcpy( state, e->full_a, c->base->robot->variable_count * sizeof( double ) );
	for ( uint32_t i = 0; i < c->base->group.variable_count; ++i )
	{
		uint32_t v = c->base->group.variables[i];
		state[v] = lwi_interpolate_variable( &c->base->robot->variables[v], e->qa[i], e->qb[i], t );
	}
}

const double* lwi_edge_state( lwi_edge* e, double t )
{
	if ( t == 0 || t == 1 )
	{
		return t == 0 ? e->qa : e->qb;
	}
	interpolate( e, t, e->full_t );
	for ( uint32_t i = 0; i < e->checker->base->group.variable_count; ++i )
	{
		e->group_t[i] = e->full_t[e->checker->base->group.variables[i]];
	}
	return e->group_t;
}

bool lwi_edge_is_covered( const lwi_edge* e )
{
	bool covered = lwi_checker_covers( e->checker, e->query, e->qa, e->qb );
	for ( uint32_t i = 1; covered && e->bend != NULL && i < e->bend->degree; ++i )
	{
		const double* point = e->bend->points + (size_t)i * e->checker->base->group.variable_count;
		covered = lwi_checker_covers( e->checker, e->query, point, point );
	}
	return covered;
}

bool lwi_edge_stays_near( const lwi_edge* e, double limit )
{
	bool near = lwi_checker_stays_near( e->checker, e->qa, e->qb, limit );
	for ( uint32_t i = 1; near && e->bend != NULL && i < e->bend->degree; ++i )
	{
		const double* point = e->bend->points + (size_t)i * e->checker->base->group.variable_count;
		near = lwi_checker_stays_near( e->checker, point, point, limit );
	}
	return near;
}

bool lwi_edge_pose( lwi_edge* e, double t )
{
	if ( t == e->posed_t )
	{
		return true;
	}
	e->posed_t = NAN;
	if ( lwi_checker_pose( e->checker, e->query, lwi_edge_state( e, t ) ) != LW_OK )
	{
		e->failed = true;
		return false;
	}
	e->posed_t = t;
	++e->out->queries;
	return true;
}

// ---- poses of clusters ----------------------------------------------------------------------------------------------

/// The place of a state's poses: by a multiplicative hash, so that neighbours on all levels get along (Knuth, TAOCP 6.4).
static size_t frame_at( lwi_edge* e, double t )
{
	uint64_t bits;
	memcpy( &bits, &t, sizeof( bits ) );
	size_t frame = (size_t)( ( bits * 0x9e3779b97f4a7c15u ) >> ( 64 - LWI_EDGE_FRAME_BITS ) );
	if ( e->frame_t[frame] != t )
	{
		size_t clusters = e->checker->base->tree->cluster_count, variables = e->checker->base->robot->variable_count;
		e->frame_t[frame] = t;
		memset( e->frame_known + frame * clusters, 0, clusters * sizeof( bool ) );
		double* state = e->frame_states + frame * variables;
		if ( t == 0 || t == 1 )
		{
			memcpy( state, t == 0 ? e->full_a : e->full_b, variables * sizeof( double ) );
		}
		else
		{
			interpolate( e, t, state );
		}
		double* cosines = e->frame_sincos + 2 * frame * lwi_padded_clusters( e->checker->base->tree );
		lwi_sincos_joints( e->checker, e->query, state, cosines, cosines + lwi_padded_clusters( e->checker->base->tree ) );
	}
	return frame;
}

/// Pose of a cluster's root link in the world at t. The one possible failure, a zero quaternion, was ruled out when the
/// motion was measured.
static const lw_transform* cluster_pose( lwi_edge* e, double t, uint32_t cluster )
{
	const lw_checker* c = e->checker;
	const lwi_cluster* clusters = c->base->tree->clusters;
	if ( cluster == 0 )
	{
		return &c->base->group.reference_poses[clusters[0].root_link];
	}
	size_t frame = frame_at( e, t );
	const double* state = e->frame_states + frame * c->base->robot->variable_count;
	bool* known = e->frame_known + frame * c->base->tree->cluster_count;
	lw_transform* poses = e->frame_poses + frame * c->base->tree->cluster_count;
	const size_t padded = lwi_padded_clusters( c->base->tree );
	const double* cosines = e->frame_sincos + 2 * frame * padded;
	while ( !known[cluster] )
	{
		uint32_t next = cluster;
		while ( clusters[next].parent != 0 && !known[clusters[next].parent] )
		{
			next = clusters[next].parent;
		}
		uint32_t parent = clusters[next].parent;
		const lw_transform* above = parent == 0 ? &c->base->group.reference_poses[clusters[0].root_link] : &poses[parent];
		lwi_pose_under( c, next, above, state, cosines, cosines + padded, &poses[next] );
		known[next] = true;
	}
	return &poses[cluster];
}

/// The query's own pose where it is at t.
static const lw_transform* pose_at( lwi_edge* e, double t, uint32_t cluster )
{
	if ( t != e->posed_t )
	{
		return cluster_pose( e, t, cluster );
	}
	lwi_pose_cluster( e->checker, e->query, cluster );
	return &e->query->pose.world_from_link[e->checker->base->tree->clusters[cluster].root_link];
}

/// Pose of a cluster in the frame of one above it.
static lw_transform pose_below( lwi_edge* e, double t, uint32_t cluster, uint32_t ancestor )
{
	const lw_transform* pose = pose_at( e, t, cluster );
	return ancestor == 0 ? *pose : lwi_relative( pose_at( e, t, ancestor ), pose );
}

// ---- linear motions --------------------------------------------------------------------------------------------------

/// Metres. Where paths bend more than this, a body's poses at the window's ends bound its motion better than its velocity
/// in the middle.
#define MAX_LINEAR_BULGE 0.004

const lwi_edge_velocity* lwi_edge_velocity_now( lwi_edge* e, uint32_t cluster )
{
	const lw_checker* c = e->checker;
	const lwi_cluster* clusters = c->base->tree->clusters;
	const uint64_t stamp = e->query->pose.state_stamp;
	if ( e->bend != NULL && e->speed_t != e->posed_t )
	{
		lwi_edge_bend_at( e, e->posed_t, e->full_t );
		lwi_motion_set_speeds( c->base->motion, e->motion, e->speed_now );
		e->speed_t = e->posed_t;
	}
	while ( e->velocities[cluster].stamp != stamp )
	{
		uint32_t next = cluster;
		while ( next != 0 && e->velocities[clusters[next].parent].stamp != stamp )
		{
			next = clusters[next].parent;
		}
		lwi_edge_velocity* velocity = &e->velocities[next];
		lwi_pose_cluster( c, e->query, next );
		const lw_transform* pose = &e->query->pose.world_from_link[clusters[next].root_link];
		*velocity = (lwi_edge_velocity){ .stamp = stamp, .center = lwi_transform( pose, lwi_load( clusters[next].r.center ) ) };
		if ( next != 0 )
		{
			lwi_twist own = lwi_motion_twist( c->base->motion, e->motion, next, pose );
			const lwi_edge_velocity* above = &e->velocities[clusters[next].parent];
			velocity->twist = (lwi_twist){ lwi_add( above->twist.angular, own.angular ),
				lwi_add( above->twist.linear, own.linear ) };
			velocity->depth = above->depth + 1;
			velocity->rates = lwi_motion_rates( c->base->motion, e->motion, next );
			velocity->tubes = lwi_motion_tubes( c->base->motion, e->motion, next );
		}
	}
	return &e->velocities[cluster];
}

bool lwi_edge_is_linear( lwi_motion_rate rate, lwi_edge_window window )
{
	return 0.5 * window.half * window.half * rate.change <= MAX_LINEAR_BULGE;
}

lwi_edge_linear_motion lwi_edge_linear_motion_of( lwi_edge* e, uint32_t cluster, uint32_t ancestor, lwi_motion_rate rate,
	lwi_edge_window window )
{
	const lwi_twist *own = &lwi_edge_velocity_of( e, cluster )->twist, *above = &lwi_edge_velocity_of( e, ancestor )->twist;
	const double bulge = lwi_edge_bulge( e, rate, window.half );
	return (lwi_edge_linear_motion){ { lwi_sub( own->angular, above->angular ), lwi_sub( own->linear, above->linear ) }, bulge };
}

static inline lw_vec3 velocity( const lwi_twist* twist, lw_vec3 at )
{
	return lwi_add( twist->linear, lwi_cross( twist->angular, at ) );
}

double lwi_edge_linear_length( const lwi_edge_linear_motion* linear, lw_vec3 center, double radius, double half )
{
	double turn = radius > 0 ? lwi_length( linear->twist.angular ) * radius : 0;
	return half * ( lwi_length( velocity( &linear->twist, center ) ) + turn ) * LWI_EDGE_OUTWARD + linear->bulge;
}

// ---- displacements ---------------------------------------------------------------------------------------------------

/// Chord of a point at distance 1 by the turn from one pose to another. Of two rotations by an angle a from each other,
/// the difference has the Frobenius norm 2 sqrt( 2 ) sin( a / 2 ).
static double turn_between( const lw_transform* from, const lw_transform* to )
{
	double sum = 0;
	for ( int i = 0; i < 3; ++i )
	{
		for ( int j = 0; j < 3; ++j )
		{
			double d = to->r[i][j] - from->r[i][j];
			sum += d * d;
		}
	}
	return sqrt( 0.5 * sum );
}

static bool is_triplet( const lwi_edge_pose_triplet* s, uint32_t cluster, uint32_t ancestor, lwi_edge_window window )
{
	return s->cluster == cluster && s->ancestor == ancestor && s->window.t == window.t && s->window.half == window.half;
}

/// Callers go through the bodies of one cluster, or alternate between the two bodies of a pair: the last two triplets are
/// kept.
static lwi_edge_pose_triplet* triplet_of( lwi_edge* e, uint32_t cluster, uint32_t ancestor, lwi_edge_window window )
{
	if ( is_triplet( &e->triplets[e->last_triplet], cluster, ancestor, window ) )
	{
		return &e->triplets[e->last_triplet];
	}
	e->last_triplet = 1 - e->last_triplet;
	lwi_edge_pose_triplet* s = &e->triplets[e->last_triplet];
	if ( !is_triplet( s, cluster, ancestor, window ) )
	{
		s->cluster = cluster;
		s->ancestor = ancestor;
		s->window = window;
		s->middle = pose_below( e, window.t, cluster, ancestor );
		s->left = pose_below( e, window.t - window.half, cluster, ancestor );
		s->right = pose_below( e, window.t + window.half, cluster, ancestor );
		s->turn = -1;
	}
	return s;
}

/// The longer chord of a point from the middle to one of the ends, rounded outward.
static double chord_of( const lwi_edge* e, const lwi_edge_pose_triplet* s, const double local[3] )
{
	lw_vec3 p = lwi_load( local ), middle = lwi_transform( &s->middle, p );
	double left = lwi_length_sq( lwi_sub( middle, lwi_transform( &s->left, p ) ) );
	double right = lwi_length_sq( lwi_sub( middle, lwi_transform( &s->right, p ) ) );
	return sqrt( lwi_larger( left, right ) ) + 8 * lwi_motion_rounding( e->motion );
}

/// Largest distance of a sphere from its place at the middle, where a linear motion bounds it well; else INFINITY.
static double linear_bound( lwi_edge* e, uint32_t cluster, uint32_t ancestor, const lw_sphere* local, lwi_motion_rate rate,
	lwi_edge_window window )
{
	if ( !lwi_edge_is_linear( rate, window ) )
	{
		return INFINITY;
	}
	lwi_edge_linear_motion linear = lwi_edge_linear_motion_of( e, cluster, ancestor, rate, window ); // poses the cluster
	const lw_transform* pose = &e->query->pose.world_from_link[e->checker->base->tree->clusters[cluster].root_link];
	double length =
		lwi_edge_linear_length( &linear, lwi_transform( pose, lwi_load( local->center ) ), local->radius, window.half );
	double path = window.half * rate.path;
	return length < path ? length : length >= path ? path : INFINITY; // no number without a twist
}

double lwi_edge_displacement( lwi_edge* e, uint32_t cluster, uint32_t ancestor, const lw_sphere* local, lwi_motion_rate rate,
	lwi_edge_window window )
{
	if ( rate.path == 0 || window.half == 0 )
	{
		return 0;
	}
	double by_velocity = linear_bound( e, cluster, ancestor, local, rate, window );
	if ( by_velocity < INFINITY )
	{
		return by_velocity;
	}
	lwi_edge_pose_triplet* s = triplet_of( e, cluster, ancestor, window );
	if ( s->turn < 0 )
	{
		s->turn = lwi_larger( turn_between( &s->middle, &s->left ), turn_between( &s->middle, &s->right ) );
	}
	double chord = chord_of( e, s, local->center ) + local->radius * s->turn;
	return lwi_motion_between( chord, lwi_chord_error_of( rate, window.half ), window.half * rate.path );
}

double lwi_edge_point_displacement( lwi_edge* e, uint32_t cluster, uint32_t ancestor, const double local[3],
	lwi_motion_rate rate, lwi_edge_window window )
{
	if ( rate.path == 0 || window.half == 0 )
	{
		return 0;
	}
	const lw_sphere point = { { local[0], local[1], local[2] }, 0 };
	double by_velocity = linear_bound( e, cluster, ancestor, &point, rate, window );
	if ( by_velocity < INFINITY )
	{
		return by_velocity;
	}
	const double chord = chord_of( e, triplet_of( e, cluster, ancestor, window ), local );
	return lwi_motion_between( chord, lwi_chord_error_of( rate, window.half ), window.half * rate.path );
}

void lwi_edge_swept_poses( lwi_edge* e, uint32_t body, uint32_t ancestor, lwi_motion_rate rate, lwi_edge_window window,
	const lwi_edge_linear_motion* linear, lwi_swept_poses* out )
{
	const lw_checker* c = e->checker;
	const lw_transform* root_link_from_shape = &c->base->tree->body_poses[c->base->tree->body_place[body]];
	const uint32_t cluster = c->base->tree->body_cluster[body];
	out->shape = lwi_shape_now( c->base->bodies[body].shape );
	out->count = 1;
	out->is_linear = linear != NULL && rate.path > 0;
	out->made = !out->is_linear;
	out->boxed = false;
	if ( linear != NULL )
	{
		lwi_pose_body( c, e->query, body );
		out->middle = e->query->pose.world_from_body[body];
	}
	else
	{
		lw_transform root_link = pose_below( e, window.t, cluster, ancestor );
		out->middle = lwi_multiply( &root_link, root_link_from_shape );
	}
	if ( out->is_linear )
	{
		out->turn = lwi_scale( window.half, linear->twist.angular );
		out->shift = lwi_scale( window.half, linear->twist.linear );
		out->count = 2;
		return;
	}
	if ( rate.path > 0 )
	{
		const lwi_edge_pose_triplet* s = triplet_of( e, cluster, ancestor, window );
		out->at[0] = out->middle;
		out->at[1] = lwi_multiply( &s->left, root_link_from_shape );
		out->at[2] = lwi_multiply( &s->right, root_link_from_shape );
		out->count = 3;
	}
}
