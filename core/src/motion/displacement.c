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

bool lwi_edge_pose( lwi_edge* e, double t )
{
	if ( t == e->poses.posed_t )
	{
		return true;
	}
	e->poses.posed_t = NAN;
	if ( lwi_checker_pose( e->checker, e->query, lwi_path_state( e, t ) ) != LW_OK )
	{
		e->failed = true;
		return false;
	}
	e->poses.posed_t = t;
	++e->out->queries;
	return true;
}

// ---- poses of clusters ----------------------------------------------------------------------------------------------

void lwi_edge_set_posed( lwi_edge* e, double t )
{
	e->poses.posed_t = t;
}

void lwi_edge_forget_poses( lwi_edge* e )
{
	e->poses.posed_t = e->poses.speed_t = NAN;
	for ( int i = 0; i < 2; ++i )
	{
		e->poses.triplets[i].cluster = LW_INVALID_INDEX;
	}
	for ( int i = 0; i < LWI_EDGE_FRAMES; ++i )
	{
		e->poses.frame_t[i] = NAN;
	}
	for ( uint32_t i = 0; i < e->checker->base->tree->cluster_count; ++i )
	{
		e->poses.velocities[i].stamp = 0; // no state has it
	}
}

/// The place of a state's poses: by a multiplicative hash, so that neighbours on all levels get along (Knuth, TAOCP 6.4).
static size_t frame_at( lwi_edge* e, double t )
{
	uint64_t bits;
	memcpy( &bits, &t, sizeof( bits ) );
	size_t frame = (size_t)( ( bits * 0x9e3779b97f4a7c15u ) >> ( 64 - LWI_EDGE_FRAME_BITS ) );
	if ( e->poses.frame_t[frame] != t )
	{
		size_t clusters = e->checker->base->tree->cluster_count, variables = e->checker->base->robot->variable_count;
		e->poses.frame_t[frame] = t;
		memset( e->poses.frame_known + frame * clusters, 0, clusters * sizeof( bool ) );
		double* state = e->poses.frame_states + frame * variables;
		if ( t == 0 || t == 1 )
		{
			memcpy( state, t == 0 ? e->path.full_a : e->path.full_b, variables * sizeof( double ) );
		}
		else
		{
			lwi_path_full_state( e, t, state );
		}
		double* cosines = e->poses.frame_sincos + 2 * frame * lwi_padded_clusters( e->checker->base->tree );
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
	const double* state = e->poses.frame_states + frame * c->base->robot->variable_count;
	bool* known = e->poses.frame_known + frame * c->base->tree->cluster_count;
	lw_transform* poses = e->poses.frame_poses + frame * c->base->tree->cluster_count;
	const size_t padded = lwi_padded_clusters( c->base->tree );
	const double* cosines = e->poses.frame_sincos + 2 * frame * padded;
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
	if ( t != e->poses.posed_t )
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

const lwi_edge_velocity* lwi_edge_velocity_now( lwi_edge* e, uint32_t cluster )
{
	const lw_checker* c = e->checker;
	const lwi_cluster* clusters = c->base->tree->clusters;
	const uint64_t stamp = e->query->pose.state_stamp;
	if ( lwi_path_is_curve( e ) && e->poses.speed_t != e->poses.posed_t )
	{
		lwi_path_curve_at( e, e->poses.posed_t, e->path.full_t );
		lwi_motion_set_speeds( c->base->motion, e->path.motion, e->path.speed_now );
		e->poses.speed_t = e->poses.posed_t;
	}
	while ( e->poses.velocities[cluster].stamp != stamp )
	{
		uint32_t next = cluster;
		while ( next != 0 && e->poses.velocities[clusters[next].parent].stamp != stamp )
		{
			next = clusters[next].parent;
		}
		lwi_edge_velocity* velocity = &e->poses.velocities[next];
		lwi_pose_cluster( c, e->query, next );
		const lw_transform* pose = &e->query->pose.world_from_link[clusters[next].root_link];
		*velocity = (lwi_edge_velocity){ .stamp = stamp, .center = lwi_transform( pose, lwi_load( clusters[next].r.center ) ) };
		if ( next != 0 )
		{
			lwi_twist own = lwi_motion_twist( c->base->motion, e->path.motion, next, pose );
			const lwi_edge_velocity* above = &e->poses.velocities[clusters[next].parent];
			velocity->twist = (lwi_twist){ lwi_add( above->twist.angular, own.angular ),
				lwi_add( above->twist.linear, own.linear ) };
			velocity->depth = above->depth + 1;
			velocity->rates = lwi_motion_rates( c->base->motion, e->path.motion, next );
			velocity->tubes = lwi_motion_tubes( c->base->motion, e->path.motion, next );
		}
	}
	return &e->poses.velocities[cluster];
}

bool lwi_edge_is_linear( lwi_motion_rate rate, lwi_edge_window window )
{
	return 0.5 * window.half * window.half * rate.change <= LWI_MOST_LINEAR_BULGE;
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
	if ( is_triplet( &e->poses.triplets[e->poses.last_triplet], cluster, ancestor, window ) )
	{
		return &e->poses.triplets[e->poses.last_triplet];
	}
	e->poses.last_triplet = 1 - e->poses.last_triplet;
	lwi_edge_pose_triplet* s = &e->poses.triplets[e->poses.last_triplet];
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
	return sqrt( lwi_larger( left, right ) ) + 8 * lwi_motion_rounding( e->path.motion );
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
