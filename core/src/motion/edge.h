// SPDX-License-Identifier: BSD-3-Clause
// All data of the current edge: its motion, its pairs, and its unproved cells.
//
// The edge is cut into dyadic *cells*. At the middle of a cell the robot is measured as far as the motion in the cell asks
// for: first by clusters of the checker's tree (links that the group does not move against each other), then, where that is
// not enough, by *edge pairs*: one body against the scene, or two bodies. A cell is proved for a pair, or it is halved.
#ifndef LEEWAY_MOTION_EDGE_H
#define LEEWAY_MOTION_EDGE_H

#include "checker/checker.h"
#include "checker/clusters.h"
#include "motion/tuned.h"
#include "query/query.h"
#include "distance/separation.h"

LW_EXTERN_C_BEGIN

enum
{
	LWI_EDGE_MAX_DEPTH = 64, ///< of halving: log2( V / slack ) + 2, and the slack in use is at least 2^-46 V
	LWI_EDGE_CACHE_BITS = 10,
	LWI_EDGE_CACHE = 1 << LWI_EDGE_CACHE_BITS, ///< places for nearest pairs, by a hash
	LWI_PATH_MOST_DEPTH = 38,                  ///< of halving a curve; ends of pieces are exact in double
	LWI_BATCH_LEVEL = 3,                       ///< of halving, at which cells are the LWI_WIDTH lanes of an interval batch
	LWI_EDGE_FRAME_BITS = 2,
	LWI_EDGE_FRAMES = 1 << LWI_EDGE_FRAME_BITS
};

/// Shrinks a surplus of clearance, 2^-40 relative: far above its dozen roundings, far below any slack.
#define LWI_EDGE_INWARD ( 1.0 - 0x1p-40 )
/// Enlarges a loss of clearance, by at least as much.
#define LWI_EDGE_OUTWARD ( 1.0 + 0x1p-39 )

/// A body against the scene, or two bodies, with bounds of their motion along the whole edge.
typedef struct lwi_edge_pair
{
	uint32_t body_a, body_b; ///< robot bodies; body_b = LW_INVALID_INDEX: the scene
	uint32_t ancestor;       ///< cluster in whose frame both are given; 0 for the scene
	lwi_motion_rate rate_a, rate_b;
	double tube;         ///< metres: of both, see lwi_motion_tube_of()
	uint32_t pair_cache; ///< index into `pair_cache`
	uint8_t cells;       ///< of LWI_WIDTH, not proved by the interval batch
	double slack;    ///< metres: the edge's, or less once a clearance was found to be within that, see lwi_edge_slack()
} lwi_edge_pair;

/// Planes and directions that separated a pair the last few times: directions are few, and states that planners check
/// alternate.
typedef struct lwi_edge_plane
{
	uint64_t key;       ///< of the two hulls; 0: empty
	lwi_backoff pieces; ///< of tests of their pieces
	bool split;         ///< planes of pieces proved the pair last time, and those of the whole did not
	bool begun;        ///< there are some
	bool swapped;       ///< they are given in the frame of the first of the two
	uint8_t served;    ///< lanes of planes that served since the last new one came
	uint8_t next;      ///< lane that goes for a new one, unless it served
	lwi_planes8 planes;
} lwi_edge_plane;

/// Memory that edges of one checker keep for later ones, by a hash of the pair.
typedef struct lwi_edge_memory
{
	uint64_t bindings; ///< lw_query::bindings when it was begun: it is void for any other
	lwi_cached_pair pair_cache[LWI_EDGE_CACHE]; ///< nearest pairs
	lwi_edge_plane planes[LWI_EDGE_CACHE];
} lwi_edge_memory;

/// Result of the plane tests of a window. In ascending order of remaining work.
typedef enum lwi_edge_plane_result
{
	LWI_EDGE_PROVED,  ///< nothing comes too near
	LWI_EDGE_CLOSER,  ///< nothing is too near at the middle, but the window is too wide for a proof
	LWI_EDGE_MEASURE  ///< nothing is known
} lwi_edge_plane_result;

/// A window that is not proved for a pair: [cell, cell + 1] / 2^level of the part that is searched.
typedef struct lwi_open_window
{
	uint64_t cell;
	uint32_t pair; ///< LW_INVALID_INDEX: everything, in a first window
	uint8_t level;
	uint8_t skip; ///< halvings before the next measurement: the windows would be too wide
} lwi_open_window;

/// All windows that are not proved. Only motion/work.c changes it.
typedef struct lwi_work
{
	lwi_open_window* windows; ///< [capacity] first windows, leftmost last; from `head` to `tail` those of pairs, by cell
	uint32_t capacity, first_count, head, tail;
	double end;           ///< of the searched part, [0, end] of the path
	double end_proved;    ///< all but the open windows is proved up to here
	bool from_left;       ///< the leftmost window is next; else the widest
	bool probed;          ///< whole states were tested for a collision
	uint32_t most_states; ///< out->queries at which the proof is given up
} lwi_work;

/// Part of the edge: |u - t| <= half.
typedef struct lwi_edge_window
{
	double t, half;
} lwi_edge_window;

/// Poses of a cluster in the middle of a window and at its ends, seen from another cluster above it.
typedef struct lwi_edge_pose_triplet
{
	uint32_t cluster, ancestor; ///< LW_INVALID_INDEX: nothing yet
	lwi_edge_window window;
	lw_transform middle, left, right;
	double turn; ///< longer chord of the turns, of a point at distance 1; < 0: not yet computed
} lwi_edge_pose_triplet;

/// Velocity of a cluster in the world at the posed state, and bounds of its change.
typedef struct lwi_edge_velocity
{
	uint64_t stamp; ///< of the state; 0: none
	lwi_twist twist;
	lw_vec3 center;               ///< of its sphere
	uint32_t depth;               ///< clusters above it
	const lwi_motion_rate* rates; ///< [depth] of the whole edge, seen from the first, second, .. cluster above it
	const double* tubes;          ///< [depth] likewise, metres; used if the edge has a tolerance
} lwi_edge_velocity;

/// A Bezier curve in place of the straight motion, and the piece of it that is proved.
typedef struct lwi_edge_curve
{
	const double* points; ///< [degree + 1][group variables] of the whole curve
	uint32_t degree;      ///< 0: straight
	double start, end;    ///< of the piece
	double* part;         ///< [degree + 1][group variables] its control points
	double* size;         ///< [group variables] of their rounding; 0: the variable stays, such as a quaternion's
} lwi_edge_curve;

/// The path that is proved: a straight edge, or a piece of a curve, its tolerance and bounds of the motion along it. Owner:
/// motion/path.c.
typedef struct lwi_path
{
	const double *qa, *qb; ///< [group variables] ends
	lwi_edge_curve curve;
	double *full_a, *full_b;  ///< [robot variable_count] ends
	double *full_t, *group_t; ///< scratch for a state
	double* tolerance;        ///< [robot variable_count] scratch: around the path
	double* ranges[4];        ///< [robot variable_count] scratch of lwi_motion_ranges
	double* speed_now;        ///< [robot variable_count] derivative of a curve, see lwi_path_curve_at()
	void* motion;             ///< scratch of the motion table
	double longest;           ///< metres, V: the largest path length of a cluster
	double twist_error;       ///< see lwi_motion_twist_error()
	double tube; ///< metres: no body is farther from its place on the path, see lwi_motion_largest_tube(); 0: no tolerance
	double static_rounding; ///< metres: of the poses of static bodies, the largest of all pieces
} lwi_path;

/// Where clusters are at states of the path, and how they move there. Owner: motion/displacement.c.
typedef struct lwi_edge_poses
{
	double posed_t;                    ///< the state the query is posed at; NaN if none
	double speed_t;                    ///< the state of a curve whose speeds the motion table has
	lwi_edge_velocity* velocities;     ///< [clusters]
	lwi_edge_pose_triplet triplets[2]; ///< the last two computed
	int last_triplet;
	double* frame_t;           ///< [LWI_EDGE_FRAMES] states whose cluster poses are kept; NaN: unused
	double* frame_states;      ///< [LWI_EDGE_FRAMES][robot variable_count]
	double* frame_sincos;      ///< [LWI_EDGE_FRAMES][2][clusters, padded] cosines and sines of the joints above clusters
	bool* frame_known;         ///< [LWI_EDGE_FRAMES][clusters]
	lw_transform* frame_poses; ///< [LWI_EDGE_FRAMES][clusters] world_from_root_link
} lwi_edge_poses;

/// Pairs that spheres left open, what proves them, and the least that did. Owner: motion/edge_pair.c.
typedef struct lwi_edge_pairs
{
	lwi_edge_pair* all; ///< [capacity]
	uint32_t count, capacity;
	double rounding[2]; ///< metres: subtracted from a lower bound of a pair's clearance; [1] of a self pair
	double slack[2];    ///< metres: the def's, unless rounding is coarser
	double enough[2];   ///< metres: clearance that proves a pair without motion; margins excluded
	uint32_t close;     ///< windows of pairs with less than slack[] that were not proved
	double spare;       ///< metres: every proof holds with clearance min_d + spare at least
	double apart;       ///< metres: least separation of the pairs that tables prove; +inf if there are none
} lwi_edge_pairs;

/// A question, and all that its proof needs. Each part is written by its owner only.
typedef struct lwi_edge
{
	const lw_checker* checker;
	lw_query* query;
	const lw_edge_def* def;
	lw_edge_result* out;
	lwi_path path;
	lwi_edge_poses poses;
	lwi_edge_pairs pairs;
	lwi_work work;
	lwi_edge_memory* memory; ///< of this edge and the ones before. Owner: motion/plane_test.c
	double* lane_speeds;     ///< [clusters][LWI_WIDTH] scratch of motion/interval_batch.c
	bool failed;             ///< a state could not be posed or measured
	lw_status failure;       ///< why, if it was not the state: a deferred mesh
} lwi_edge;

/// Result of one measurement of a pair.
typedef struct lwi_edge_sample
{
	bool proved;  ///< on all of the window
	bool low;     ///< to be undecided: the clearance is within the pair's least slack, or the edge's states are used up
	bool blocked;
	uint8_t skip; ///< levels below to skip for the pair: their cells would be too wide
	lw_clearance clearance;
} lwi_edge_sample;

// --- motion/edge.c -------------------------------------------------------------------------------------------------------

/// Bytes of scratch that edges of this checker need. @param spare_bodies that the robot may have beyond those it has, and as
/// many links
size_t lwi_edge_scratch_size( const lw_checker* checker, uint32_t spare_bodies );

/// Lays the scratch of the query out. @return false if it is too small
bool lwi_edge_begin( lwi_edge* edge );

// --- motion/path.c --------------------------------------------------------------------------------------------------------

typedef enum lwi_path_result
{
	LWI_PATH_READY,
	LWI_PATH_BENT,  ///< a piece that bends so much that its halves are to be begun
	LWI_PATH_FAILED ///< it cannot be measured
} lwi_path_result;

/// Begins [cell, cell + 1] / 2^level of a curve, or a straight edge (0, 0): ends, bounds of its motion, rounding.
lwi_path_result lwi_path_begin( lwi_edge* edge, uint64_t cell, uint8_t level );

static inline bool lwi_path_is_curve( const lwi_edge* edge )
{
	return edge->path.curve.degree > 0;
}

/// The group's variables at t; the ends are the given states themselves.
const double* lwi_path_state( lwi_edge* edge, double t );

/// The full state at t. All but the group's variables are those of both ends.
void lwi_path_full_state( lwi_edge* edge, double t, double* state );

/// The full state of a curve at t, and its derivative: `state`, edge->path.speed_now.
void lwi_path_curve_at( lwi_edge* edge, double t, double* state );

/// Do the tables of the reach hold along all of the path?
bool lwi_path_is_covered( const lwi_edge* edge );

// --- motion/displacement.c ------------------------------------------------------------------------------------------------

/// Forgets poses and velocities: of another path.
void lwi_edge_forget_poses( lwi_edge* edge );

/// Tells at which state somebody else has posed the query; NaN: at none.
void lwi_edge_set_posed( lwi_edge* edge, double t );

/// Poses the query at t. @return false if that failed; edge->failed is set
bool lwi_edge_pose( lwi_edge* edge, double t );

/// Largest distance of a sphere carried by a cluster from its place at the middle of a window, within it, in the frame of
/// another cluster above it.
/// @param local frame of the cluster's `root_link`
double lwi_edge_displacement( lwi_edge* edge, uint32_t cluster, uint32_t ancestor, const lw_sphere* local,
	lwi_motion_rate rate, lwi_edge_window window );

/// Largest distance of a point carried by a cluster from its place at the middle of a window, in the same frame.
/// @param local frame of the cluster's `root_link` @param rate of it, or of a sphere that contains it
double lwi_edge_point_displacement( lwi_edge* edge, uint32_t cluster, uint32_t ancestor, const double local[3],
	lwi_motion_rate rate, lwi_edge_window window );

/// First-order motion of a cluster over a window, in the frame of a cluster above it: its velocity at the middle;
/// `bulge` bounds the deviation from it.
typedef struct lwi_edge_linear_motion
{
	lwi_twist twist; ///< coordinates of the world, at the middle; NaN if there is none
	double bulge;    ///< metres
} lwi_edge_linear_motion;

/// The velocity of a cluster at the state that the query is posed at.
const lwi_edge_velocity* lwi_edge_velocity_now( lwi_edge* edge, uint32_t cluster );

static inline const lwi_edge_velocity* lwi_edge_velocity_of( lwi_edge* edge, uint32_t cluster )
{
	const lwi_edge_velocity* velocity = &edge->poses.velocities[cluster];
	return velocity->stamp == edge->query->pose.state_stamp ? velocity : lwi_edge_velocity_now( edge, cluster );
}

/// Bounds for a cluster's geometry over the whole edge, seen from a cluster above it. The cluster was measured.
static inline lwi_motion_rate lwi_edge_rate( const lwi_edge_velocity* velocity, const lwi_edge_velocity* ancestor )
{
	const uint32_t joints = velocity->depth - ancestor->depth;
	const lwi_motion_rate still = { 0, 0 };
	return joints > 0 ? velocity->rates[joints - 1] : still;
}

/// How far the points of a cluster may be from their places on the edge, seen from a cluster above it. The cluster was
/// measured.
static inline double lwi_edge_tube( const lwi_edge* edge, const lwi_edge_velocity* velocity,
	const lwi_edge_velocity* ancestor )
{
	const uint32_t joints = velocity->depth - ancestor->depth;
	return edge->path.tube > 0 && joints > 0 ? velocity->tubes[joints - 1] : 0;
}

/// Largest deviation of a cluster's point over half a window from the motion with its velocity in the middle.
static inline double lwi_edge_bulge( const lwi_edge* edge, lwi_motion_rate rate, double half )
{
	return rate.path > 0 ? ( 0.5 * half * rate.change + edge->path.twist_error ) * half * LWI_EDGE_OUTWARD : 0;
}

/// The linear motion in a window at whose middle the query is posed.
lwi_edge_linear_motion lwi_edge_linear_motion_of( lwi_edge* edge, uint32_t cluster, uint32_t ancestor, lwi_motion_rate rate,
	lwi_edge_window window );

/// Largest distance of a sphere from its place at the middle, by its linear motion; NaN if there is none.
/// @param center in the world at the middle
double lwi_edge_linear_length( const lwi_edge_linear_motion* linear, lw_vec3 center, double radius, double half );

/// True if the acceleration is so small that a linear motion bounds as well as the poses at the window's ends.
bool lwi_edge_is_linear( lwi_motion_rate rate, lwi_edge_window window );

/// Poses of a body on both sides of all its poses within a window.
/// @param linear motion of its cluster: two poses in the world; NULL: the middle and both ends, seen from the ancestor
void lwi_edge_swept_poses( lwi_edge* edge, uint32_t body, uint32_t ancestor, lwi_motion_rate rate, lwi_edge_window window,
	const lwi_edge_linear_motion* linear, lwi_swept_poses* out );

/// Radians in half a window, all joints together: beyond, the rounding of directions in interval batches is not bounded.
#define LWI_EDGE_MOST_ROTATION 1.0

static inline bool lwi_edge_rotates_little( const lwi_edge* edge, lwi_edge_window window )
{
	return lwi_motion_rotation( edge->path.motion ) * window.half <= LWI_EDGE_MOST_ROTATION;
}

// --- motion/plane_test.c --------------------------------------------------------------------------------------------------

/// Searches for planes that prove a pair during a window, at whose middle the query is posed.
/// @param skip number of levels below to skip, if the answer is CLOSER
lwi_edge_plane_result lwi_edge_plane_test( lwi_edge* edge, const lwi_edge_pair* pair, lwi_edge_window window,
	uint8_t* skip );

// --- motion/edge_pair.c ---------------------------------------------------------------------------------------------------

/// Measures a pair at window.t, no further than needed to prove the window and a little more.
lwi_edge_sample lwi_edge_measure( lwi_edge* edge, lwi_edge_pair* pair, lwi_edge_window window );

/// How much the clearance of a pair may lose within a window, from its middle.
double lwi_edge_loss( lwi_edge* edge, const lwi_edge_pair* pair, lwi_edge_window window );

/// False for cells of a level that an interval batch has proved for a pair.
static inline bool lwi_edge_cell_is_open( const lwi_edge_pair* pair, uint64_t cell, int level )
{
	const int finer = LWI_BATCH_LEVEL - level;
	const uint32_t cells = pair->cells;
	return finer >= 0 ? ( cells >> ( cell << finer ) & ( ( 1u << ( 1 << finer ) ) - 1 ) ) != 0
					  : ( cells >> ( cell >> -finer ) & 1 ) != 0;
}

/// The verdict for a sample that ends the proof; always false. An undecided verdict never replaces a collision found elsewhere.
bool lwi_edge_fail( lwi_edge* edge, const lwi_edge_pair* pair, double t, const lwi_edge_sample* sample );

/// Lower bound of the static bodies' clearance; +infinity if the query does not cover them.
double lwi_edge_static_lower( const lwi_edge* edge );

/// Are the static bodies above min_d? If not, that is the verdict.
bool lwi_edge_static_is_free( lwi_edge* edge );

static inline bool lwi_edge_pair_is_self( const lwi_edge_pair* pair )
{
	return pair->body_b != LW_INVALID_INDEX;
}

/// True if the pair has a slack of its own, and the edge has not used up def->close_windows.
static inline bool lwi_edge_is_close( const lwi_edge* edge, const lwi_edge_pair* pair )
{
	return pair->slack < edge->pairs.slack[lwi_edge_pair_is_self( pair )] && edge->pairs.close < edge->def->close_windows;
}

/// The slack of a pair: the edge's, or the smaller one that its own clearance allows.
static inline double lwi_edge_slack( const lwi_edge* edge, const lwi_edge_pair* pair )
{
	return lwi_edge_is_close( edge, pair ) ? pair->slack : edge->pairs.slack[lwi_edge_pair_is_self( pair )];
}

/// Clearance on the edge that keeps all motions of the pair within the tolerance above min_d.
static inline double lwi_edge_least( const lwi_edge* edge, const lwi_edge_pair* pair )
{
	return edge->def->min_d + pair->tube;
}

/// Clearance that proves a pair if it loses nothing by motion, margins not in it.
static inline double lwi_edge_enough( const lwi_edge* edge, const lwi_edge_pair* pair )
{
	const bool self = lwi_edge_pair_is_self( pair );
	return pair->tube + ( lwi_edge_is_close( edge, pair )
								? edge->def->min_d + edge->pairs.rounding[self] + LWI_SLACK_SHARE * pair->slack
								: edge->pairs.enough[self] );
}

/// Notes that something was proved by as much as edge->pairs.enough.
void lwi_edge_note_proof( lwi_edge* edge );

/// No pairs, and what proves one along the path that was begun: its rounding, slack and clearance.
void lwi_edge_begin_pairs( lwi_edge* edge );

/// Fills in the fields of a pair other than its bodies, their ancestor and its cells.
void lwi_edge_prepare_pair( lwi_edge* edge, lwi_edge_pair* pair );

/// Returns its index.
uint32_t lwi_edge_add_pair( lwi_edge* edge, const lwi_edge_pair* pair );

/// True if a separation that holds along all of the edge, less margins, is at least the clearance of a certificate.
/// @param tube metres: by which motions within the tolerance may reduce it
bool lwi_edge_is_apart( lwi_edge* edge, float separation, double tube );

/// True if the grid of two bodies proves all of the edge, both ends of which are covered, with as much clearance.
/// @param slice NULL: there is none @param tube as for lwi_edge_is_apart()
bool lwi_edge_grid_proves( lwi_edge* edge, const lwi_grid_slice* slice, uint32_t body_a, uint32_t body_b, double tube );

// --- motion/midpoint_pass.c -----------------------------------------------------------------------------------------------

/// Measures everything at window.t, at which clusters were measured, clusters first. Unproved pairs are added to edge->pairs.all
/// and to the list of windows. With many of them whole states are probed.
/// @return false if the proof ends here: something is blocked or undecided
bool lwi_edge_midpoint_pass( lwi_edge* edge, lwi_edge_window window );

/// Poses all clusters at t, and measures how they move, from there. @param share of the edge on the longer side of t
/// @return false if that failed
bool lwi_edge_measure_clusters( lwi_edge* edge, double t, double share );

// --- motion/interval_batch.c ----------------------------------------------------------------------------------------------

/// True for edges that are long and bent enough for an interval batch, of robots that can have one. Clusters were measured.
bool lwi_edge_has_batch( lwi_edge* edge );

/// Everything in eight windows at once, by spheres; pairs not proved become the edge's pairs, with their cells. Clusters
/// were measured.
void lwi_edge_batch_pass( lwi_edge* edge );

// --- motion/work.c ------------------------------------------------------------------------------------------------------

/// Empties the list, but for one first window. @param from_left the leftmost window is always next
void lwi_work_begin( lwi_edge* edge, double end, bool from_left );

/// Adds a pair that a first window leaves open: its halves are next. @param skip levels below that
void lwi_work_add( lwi_edge* edge, uint32_t pair, uint8_t skip );

/// Is the whole robot above min_d at t? Nearest pair first. A failure is reported; an undecided verdict never replaces a collision
/// found elsewhere.
bool lwi_edge_state_is_free( lwi_edge* edge, double t );

/// Probes whole states where a proof would cost much: with many open cells, or pairs within the slack.
/// @param work open cells so far @return false if there is a collision
bool lwi_edge_probe( lwi_edge* edge, uint32_t work );

/// Proves all pairs on the whole path and lowers out->lower_bound, or sets the verdict. @return true if it is free
bool lwi_edge_prove( lwi_edge* edge );

/// The right end of the run that is proved for every pair from t = 0, before the failure at out->t.
double lwi_edge_proved_run( lwi_edge* edge );

LW_EXTERN_C_END

#endif
