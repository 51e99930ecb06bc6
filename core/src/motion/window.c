// SPDX-License-Identifier: BSD-3-Clause
// Window motions: poses of bodies in the middle of a window and at its ends, and bounds of how far their points are from them.
//
// A point's displacement is bounded by its positions at both ends and the largest change of its velocity in between (linear
// interpolation), which beats path lengths by far where joints' motions cancel or windows are short. Derivation:
// core/docs/edges.md.
#include "checker/pose.h"
#include "motion/edge.h"
#include "base/math_inline.h"

#include <string.h>

// ---- the query's state -----------------------------------------------------------------------------------------------

void lwi_edge_count_state( lwi_edge* e, double t )
{
	e->out->queries += t == e->poses.counted_t ? 0 : 1;
	e->poses.counted_t = t;
}

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
	return true;
}

void lwi_edge_set_posed( lwi_edge* e, double t )
{
	e->poses.posed_t = t;
}

void lwi_edge_forget_poses( lwi_edge* e )
{
	e->poses.posed_t = e->poses.counted_t = NAN;
	for ( int i = 0; i < 2; ++i )
	{
		e->poses.windows[i].cluster = LW_INVALID_INDEX;
	}
	for ( int i = 0; i < LWI_EDGE_FRAMES; ++i )
	{
		e->poses.frame_t[i] = NAN;
	}
}

/// The longer part of the path on one side of its middle is half of it, so rates bound all of the path.
bool lwi_edge_measure_path( lwi_edge* e )
{
	const lw_checker* c = e->checker;
	const double t = e->path.longest > 0 ? 0.5 : 1; // nothing moves: the given state
	lwi_edge_count_state( e, t );
	if ( !lwi_edge_pose( e, t ) )
	{
		return false;
	}
	for ( uint32_t i = 1; i < c->base->tree->cluster_count; ++i )
	{
		lwi_pose_cluster( c, e->query, i );
	}
	lwi_motion_place( c->base->motion, e->path.motion, e->query->pose.world_from_link );
	for ( uint32_t i = 1; i < c->base->tree->cluster_count; ++i )
	{
		lwi_motion_measure_body( c->base->motion, e->path.motion, i, e->query->pose.world_from_link, 0.5 );
	}
	return true;
}

// ---- poses of clusters -----------------------------------------------------------------------------------------------

/// The place of a state's poses: by a multiplicative hash, so that neighbours on all levels get along (Knuth, TAOCP 6.4).
static size_t frame_at( lwi_edge* e, double t )
{
	uint64_t bits;
	memcpy( &bits, &t, sizeof( bits ) );
	const size_t frame = (size_t)( ( bits * 0x9e3779b97f4a7c15u ) >> ( 64 - LWI_EDGE_FRAME_BITS ) );
	if ( e->poses.frame_t[frame] != t )
	{
		const size_t clusters = e->checker->base->tree->cluster_count,
					 padded = lwi_padded_clusters( e->checker->base->tree );
		double* state = e->poses.frame_states + frame * e->checker->base->robot->variable_count;
		double* cosines = e->poses.frame_sincos + 2 * frame * padded;
		e->poses.frame_t[frame] = t;
		memset( e->poses.frame_known + frame * clusters, 0, clusters * sizeof( bool ) );
		lwi_path_at( e, t, state, NULL );
		lwi_sincos_joints( e->checker, e->query, state, cosines, cosines + padded );
	}
	return frame;
}

/// Pose of a cluster's root link in the world at t. The one possible failure, a zero quaternion, was ruled out when the
/// motion was measured.
static const lw_transform* cluster_pose( lwi_edge* e, double t, uint32_t cluster )
{
	const lw_checker* c = e->checker;
	const lwi_cluster* clusters = c->base->tree->clusters;
	const lw_transform* root = &c->base->group.reference_poses[clusters[0].root_link];
	if ( cluster == 0 )
	{
		return root;
	}
	const size_t frame = frame_at( e, t ), padded = lwi_padded_clusters( c->base->tree );
	const double* state = e->poses.frame_states + frame * c->base->robot->variable_count;
	const double* cosines = e->poses.frame_sincos + 2 * frame * padded;
	bool* known = e->poses.frame_known + frame * c->base->tree->cluster_count;
	lw_transform* poses = e->poses.frame_poses + frame * c->base->tree->cluster_count;
	while ( !known[cluster] )
	{
		uint32_t next = cluster;
		while ( clusters[next].parent != 0 && !known[clusters[next].parent] )
		{
			next = clusters[next].parent;
		}
		const uint32_t parent = clusters[next].parent;
		lwi_pose_under( c, next, parent == 0 ? root : &poses[parent], state, cosines, cosines + padded, &poses[next] );
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

static bool is_window( const lwi_window_poses* w, uint32_t cluster, uint32_t ancestor, lwi_edge_window window )
{
	return w->cluster == cluster && w->ancestor == ancestor && w->window.t == window.t && w->window.half == window.half;
}

/// Callers go through the bodies of one cluster, or alternate between the two bodies of a pair: the last two are kept.
static lwi_window_poses* poses_of( lwi_edge* e, const lwi_window_motion* m )
{
	const uint32_t cluster = e->checker->base->tree->body_cluster[m->body], ancestor = m->ancestor;
	lwi_window_poses* w = &e->poses.windows[e->poses.last];
	if ( is_window( w, cluster, ancestor, m->window ) )
	{
		return w;
	}
	e->poses.last = 1 - e->poses.last;
	w = &e->poses.windows[e->poses.last];
	if ( !is_window( w, cluster, ancestor, m->window ) )
	{
		*w = ( lwi_window_poses ){ .cluster = cluster, .ancestor = ancestor, .window = m->window, .turn = -1 };
		w->middle = pose_below( e, m->window.t, cluster, ancestor );
		w->left = pose_below( e, m->window.t - m->window.half, cluster, ancestor );
		w->right = pose_below( e, m->window.t + m->window.half, cluster, ancestor );
	}
	return w;
}

// ---- window motions --------------------------------------------------------------------------------------------------

void lwi_window_motion_of( const lwi_edge_pair* pair, int side, lwi_edge_window window, lwi_window_motion* m )
{
	const lwi_motion_rate rate = pair->rate[side];
	m->body = pair->body[side];
	m->ancestor = pair->ancestor;
	m->window = window;
	m->moves = rate.path > 0 && window.half > 0;
	m->chord_error = lwi_chord_error_of( rate, window.half );
	m->tube = pair->tube[side];
	m->deviation = m->chord_error.max + m->tube;
	m->path = window.half * rate.path + m->tube;
}

/// Chord of a point at distance 1 by the turn from one pose to another. Of two rotations by an angle a from each other,
/// the difference has the Frobenius norm 2 sqrt( 2 ) sin( a / 2 ).
static double turn_between( const lw_transform* from, const lw_transform* to )
{
	double sum = 0;
	for ( int i = 0; i < 3; ++i )
	{
		for ( int j = 0; j < 3; ++j )
		{
			const double d = to->r[i][j] - from->r[i][j];
			sum += d * d;
		}
	}
	return sqrt( 0.5 * sum );
}

/// The longer chord of a point from the middle to one of the ends, rounded outward.
static double chord_of( const lwi_edge* e, const lwi_window_poses* w, const double local[3] )
{
	const lw_vec3 p = lwi_load( local ), middle = lwi_transform( &w->middle, p );
	const double left = lwi_length_sq( lwi_sub( middle, lwi_transform( &w->left, p ) ) );
	const double right = lwi_length_sq( lwi_sub( middle, lwi_transform( &w->right, p ) ) );
	return sqrt( lwi_larger( left, right ) ) + 8 * lwi_motion_rounding( e->path.motion );
}

double lwi_window_displacement( lwi_edge* e, const lwi_window_motion* m, const lw_sphere* sphere )
{
	if ( !m->moves )
	{
		return m->tube;
	}
	lwi_window_poses* w = poses_of( e, m );
	double chord = chord_of( e, w, sphere->center );
	if ( sphere->radius > 0 )
	{
		if ( w->turn < 0 )
		{
			w->turn = lwi_larger( turn_between( &w->middle, &w->left ), turn_between( &w->middle, &w->right ) );
		}
		chord += sphere->radius * w->turn;
	}
	return lwi_motion_between( chord, m->chord_error, m->path - m->tube ) + m->tube;
}

double lwi_window_loss( lwi_edge* e, const lwi_edge_pair* pair, const lwi_window_motion motion[2] )
{
	const lwi_cluster_tree* tree = e->checker->base->tree;
	double loss = 0;
	for ( int side = 0; side < ( lwi_edge_pair_is_self( pair ) ? 2 : 1 ); ++side )
	{
		loss += lwi_window_displacement( e, &motion[side], &tree->body_spheres[tree->body_place[pair->body[side]]] );
	}
	return loss * LWI_EDGE_OUTWARD;
}

void lwi_window_swept( lwi_edge* e, const lwi_window_motion* m, lwi_swept_poses* out )
{
	const lw_checker* c = e->checker;
	const lwi_cluster_tree* tree = c->base->tree;
	const lw_transform* root_link_from_shape = &tree->body_poses[tree->body_place[m->body]];
	out->shape = lwi_shape_now( c->base->bodies[m->body].shape );
	out->boxed = false;
	if ( !m->moves )
	{
		const lw_transform root_link = pose_below( e, m->window.t, tree->body_cluster[m->body], m->ancestor );
		out->count = 1;
		out->middle = lwi_multiply( &root_link, root_link_from_shape );
		return;
	}
	const lwi_window_poses* w = poses_of( e, m );
	out->count = 3;
	out->middle = out->at[0] = lwi_multiply( &w->middle, root_link_from_shape );
	out->at[1] = lwi_multiply( &w->left, root_link_from_shape );
	out->at[2] = lwi_multiply( &w->right, root_link_from_shape );
}
