// SPDX-License-Identifier: BSD-3-Clause
// The proof that a motion is free: its parts, and who writes them. The proof: core/docs/edges.md; the search: core/docs/search.md.
//
// A *path* tells where the robot is at t and bounds its motion. In a *window*, a part of the path, each body has a *window motion*:
// poses, and how far its points may be from them. A certificate needs two window motions, a clearance and a pair of shapes. Windows of
// pairs that are not proved are on one list.
#ifndef LEEWAY_MOTION_EDGE_H
#define LEEWAY_MOTION_EDGE_H

#include "checker/checker.h"
#include "checker/clusters.h"
#include "checker/pose.h"
#include "motion/tuned.h"
#include "query/query.h"
#include "distance/separation.h"

LW_EXTERN_C_BEGIN

enum
{
	LWI_EDGE_MAX_DEPTH = 64, ///< of halving: log2( V / slack ) + 2, and the slack in use is at least 2^-46 V
	LWI_EDGE_CACHE_BITS = 10,
	LWI_EDGE_CACHE = 1 << LWI_EDGE_CACHE_BITS, ///< places for nearest pairs and for planes, by a hash
	LWI_PATH_MOST_DEPTH = 38,                  ///< of halving a curve; ends of pieces are exact in double
	LWI_GATE_LEVEL = 3,                        ///< of halving, at which windows are the LWI_WIDTH lanes of the gate
	LWI_EDGE_OBSTACLES = 4096,                 ///< places for obstacles of pairs that the gate leaves open
	LWI_EDGE_FRAME_BITS = 4,
	LWI_EDGE_FRAMES = 1 << LWI_EDGE_FRAME_BITS
};

/// Shrinks a surplus of clearance, 2^-40 relative: far above its dozen roundings, far below any slack.
#define LWI_EDGE_INWARD ( 1.0 - 0x1p-40 )
/// Enlarges a loss of clearance, by at least as much.
#define LWI_EDGE_OUTWARD ( 1.0 + 0x1p-39 )

// --- motion/path.c --------------------------------------------------------------------------------------------------------

/// A Bezier curve in place of the straight motion, and the piece of it that is proved.
typedef struct lwi_edge_curve
{
	const double* points; ///< [degree + 1][group variables] of the whole curve
	uint32_t degree;      ///< 0: straight
	double start, end;    ///< of the piece
	double* part;         ///< [degree + 1][group variables] its control points
	double* size;         ///< [group variables] of their rounding; 0: the variable stays, such as a quaternion's
} lwi_edge_curve;

/// Variables on clocks that may be late, as lwi_motion_late has them.
typedef struct lwi_edge_late
{
	const double* deviations; ///< [group variables] by being late, beyond the tolerance
	const uint32_t* tracks;   ///< [group variables]
} lwi_edge_late;

/// The path that is proved: a straight edge, or a piece of a curve, its tolerance and bounds of the motion along it. Owner:
/// motion/path.c. Nothing else knows which kind it is.
typedef struct lwi_path
{
	const double *qa, *qb; ///< [group variables] ends
	lwi_edge_curve curve;
	double *full_a, *full_b;   ///< [robot variable_count] ends
	double *full_t, *group_t;  ///< scratch for a state
	double* tolerance;         ///< [robot variable_count] scratch: around the path
	const lwi_edge_late* late; ///< NULL: all is on one clock
	double* late_tolerance;    ///< [robot variable_count] scratch
	uint32_t* tracks;          ///< [robot variable_count] scratch
	double* ranges[4];         ///< [robot variable_count] scratch of lwi_motion_ranges
	void* motion;              ///< scratch of the motion table
	double longest;            ///< metres, V: the largest path length of a cluster
	double twist_error;        ///< see lwi_motion_twist_error()
	double tube; ///< metres: no body is farther from its place on the path, see lwi_motion_largest_tube(); 0: no tolerance
	double static_rounding; ///< metres: of the poses of static bodies, the largest of all pieces
} lwi_path;

/// A body against the scene, or two bodies, and bounds of their motion along the whole path.
typedef struct lwi_edge_pair
{
	uint32_t body[2];  ///< robot bodies; [1] = LW_INVALID_INDEX: the scene
	uint32_t ancestor; ///< cluster in whose frame motions are given; 0 for the scene
	lwi_motion_rate rate[2];
	double tube[2];                          ///< metres: of motions within the tolerance, see lwi_motion_tube_of()
	uint32_t pair_cache;                     ///< index into `pair_cache`
	uint8_t cells;                           ///< of LWI_WIDTH, not proved by the gate
	uint8_t skip;                            ///< halvings before it is measured: its bodies bend too much in wider windows
	uint32_t first_obstacle, obstacle_count; ///< in lwi_edge_pairs.obstacles; LW_INVALID_INDEX: no room
	double slack;                            ///< metres: the edge's, or less once a clearance was found to be within that
} lwi_edge_pair;

static inline bool lwi_edge_pair_is_self( const lwi_edge_pair* pair )
{
	return pair->body[1] != LW_INVALID_INDEX;
}

// --- motion/window.c ------------------------------------------------------------------------------------------------------

/// Part of the path: |u - t| <= half.
typedef struct lwi_edge_window
{
	double t, half;
	uint8_t cells, whole_cells; ///< of the LWI_WIDTH of the gate: those that it touches, those that lie in it
} lwi_edge_window;

/// Poses of a cluster in the middle of a window and at its ends, seen from another cluster above it.
typedef struct lwi_window_poses
{
	uint32_t cluster, ancestor; ///< LW_INVALID_INDEX: nothing yet
	lwi_edge_window window;
	lw_transform middle, left, right;
	double turn; ///< longer chord of the turns, of a point at distance 1; < 0: not yet computed
} lwi_window_poses;

/// All that a certificate needs of one body's motion in a window.
typedef struct lwi_window_motion
{
	uint32_t body, ancestor; ///< body of the robot; cluster in whose frame it moves
	lwi_edge_window window;
	bool moves;
	lwi_chord_error chord_error; ///< from the lines between the poses at the ends and in the middle
	double deviation;            ///< metres: no point is farther from these lines than this, the tube included
	double path;                 ///< metres: no point gets farther from its place in the middle, the tube included
	double tube;                 ///< metres: the part of both that no halving takes away
} lwi_window_motion;

/// Where clusters are at states of the path. Owner: motion/window.c.
typedef struct lwi_edge_poses
{
	double posed_t;              ///< the state the query is posed at; NaN if none
	double counted_t;            ///< the state that lwi_edge_count_state() added last
	lwi_window_poses windows[2]; ///< the last two computed
	int last;
	double* frame_t;           ///< [LWI_EDGE_FRAMES] states whose cluster poses are kept; NaN: unused
	double* frame_states;      ///< [LWI_EDGE_FRAMES][robot variable_count]
	double* frame_sincos;      ///< [LWI_EDGE_FRAMES][2][clusters, padded] cosines and sines of the joints above clusters
	bool* frame_known;         ///< [LWI_EDGE_FRAMES][clusters]
	lw_transform* frame_poses; ///< [LWI_EDGE_FRAMES][clusters] world_from_root_link
} lwi_edge_poses;

// --- motion/certify.c, motion/planes.c ------------------------------------------------------------------------------------

/// Pairs that the gate left open, what proves them, and the least that did. Owner: motion/certify.c.
typedef struct lwi_edge_pairs
{
	lwi_open_obstacle* obstacles; ///< [LWI_EDGE_OBSTACLES] of all pairs with the scene, one pair after the other
	uint32_t obstacle_count;
	lwi_edge_pair* all; ///< [capacity]
	uint32_t count, capacity;
	double rounding[2]; ///< metres: subtracted from a lower bound of a pair's clearance; [1] of a self pair
	double slack[2];    ///< metres: the def's, unless rounding is coarser
	double need[2];     ///< metres: clearance that proves a pair without motion; margins excluded
	uint32_t close;     ///< windows of pairs with less than slack[] that were not proved
	double surplus;     ///< metres: every proof holds with clearance min_d + surplus at least
	double separation;  ///< metres: least separation of the pairs that tables prove; +inf if there are none
} lwi_edge_pairs;

/// Planes and directions that separated a pair the last few times: directions are few, and states that planners check
/// alternate.
typedef struct lwi_edge_plane
{
	uint64_t key;       ///< of the two hulls; 0: empty
	uint64_t bindings;  ///< of the memory when it was written: it is empty for any other
	lwi_backoff pieces; ///< of tests of their pieces
	bool split;         ///< planes of pieces proved the pair last time, and those of the whole did not
	bool begun;         ///< there are some
	bool swapped;       ///< they are given in the frame of the first of the two
	uint8_t served;     ///< lanes of planes that served since the last new one came
	uint8_t next;       ///< lane that goes for a new one, unless it served
	lwi_planes8 planes;
} lwi_edge_plane;

/// Memory that edges of one checker keep for later ones, by a hash of the pair.
typedef struct lwi_edge_memory
{
	uint64_t bindings;                          ///< lw_query::bindings when it was begun: it is void for any other
	lwi_cached_pair pair_cache[LWI_EDGE_CACHE]; ///< nearest pairs
	lwi_edge_plane planes[LWI_EDGE_CACHE];
} lwi_edge_memory;

/// Result of the plane tests of a window. In ascending order of remaining work.
typedef enum lwi_edge_plane_result
{
	LWI_EDGE_PROVED, ///< nothing comes too near
	LWI_EDGE_HALVE,  ///< nothing is too near at the middle, but the window is too wide for a proof
	LWI_EDGE_MEASURE ///< nothing is known
} lwi_edge_plane_result;

/// Result for a pair in a window: proved; `low`: too near; else it is to be halved.
typedef struct lwi_edge_sample
{
	bool proved; ///< on all of the window
	bool low;    ///< to be undecided: the clearance is within the pair's slack, or the edge's states are used up
	bool blocked;
	uint8_t skip; ///< halvings more before the next measurement: those windows would be too wide
	lw_clearance clearance;
} lwi_edge_sample;

// --- motion/work.c --------------------------------------------------------------------------------------------------------

/// A window that is not proved for a pair: [cell, cell + 1] / 2^level of the part that is searched.
typedef struct lwi_open_window
{
	uint64_t cell;
	uint32_t pair; ///< LW_INVALID_INDEX: everything, in a first window
	uint8_t level;
	uint8_t skip; ///< halvings before the next measurement
} lwi_open_window;

/// All windows that are not proved. Owner: motion/work.c.
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

/// A cluster in the lanes of the gate, seen from the world.
typedef struct lwi_lane_bound
{
	double size;      ///< metres: no coordinate of its sphere is larger, with its displacement
	double deviation; ///< metres: from motion with the velocities in the middle, the tube not included
} lwi_lane_bound;

/// Where a collision is likely: windows of the gate, by their middles.
typedef struct lwi_edge_hints
{
	uint32_t next;              ///< bodies of clusters from here on were compared with the scene
	uint32_t met;               ///< windows with a point of a body inside of an obstacle
	uint32_t unsure[LWI_WIDTH]; ///< number of bodies near obstacles that points are not compared with, such as meshes
} lwi_edge_hints;

/// Scratch for curves that are made for a query one after the other. The query's own questions do not use it.
typedef struct lwi_edge_room
{
	double* points;                 ///< [LW_CURVE_MOST_DEGREE + 1][group variables]
	double *tolerance, *deviations; ///< [group variables]
	uint32_t* tracks;               ///< [group variables]
} lwi_edge_room;

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
	lwi_edge_memory* memory;           ///< of this edge and the ones before. Owner: motion/planes.c
	double *lane_states, *lane_speeds; ///< [LWI_WIDTH][robot variable_count] scratch of motion/gate.c
	lwi_lane_bound* lane_bounds;       ///< [clusters] scratch of motion/gate.c
	lwi_edge_hints hints;              ///< Owner: motion/gate.c
	lwi_edge_room room;                ///< of others than this edge
	bool failed;                       ///< a state could not be posed or measured
	lw_status failure;                 ///< why, if it was not the state: a deferred mesh
} lwi_edge;

// --- motion/edge.c --------------------------------------------------------------------------------------------------------

/// Bytes of scratch that edges of this checker need. @param spare_bodies that the robot may have beyond those it has, and as
/// many links
size_t lwi_edge_scratch_size( const lw_checker* checker, uint32_t spare_bodies );

/// Lays the scratch of the query out. @return false if it is too small
bool lwi_edge_begin( lwi_edge* edge );

/// The room of the query. @return false if the query is too small
bool lwi_edge_take_room( const lw_checker* checker, lw_query* query, lwi_edge_room* out );

/// lw_checker_edge() with degree 0, whose points are both ends; lw_checker_curve() with others; and tracks that may be late.
/// @param late nullable
lw_status lwi_edge_prove_late( const lw_checker* checker, lw_query* query, const double* points, uint32_t degree,
	const lw_edge_def* def, const lwi_edge_late* late, lw_edge_result* out );

// --- motion/path.c --------------------------------------------------------------------------------------------------------

typedef enum lwi_path_result
{
	LWI_PATH_READY,
	LWI_PATH_BENT,  ///< a piece that bends so much that its halves are to be begun
	LWI_PATH_FAILED ///< it cannot be measured
} lwi_path_result;

/// Begins [cell, cell + 1] / 2^level of a curve, or a straight edge (0, 0): ends, rounding, and bounds of its motion that need no pose.
lwi_path_result lwi_path_begin( lwi_edge* edge, uint64_t cell, uint8_t level );

/// Replaces the control points of one variable, `stride` numbers apart, by those of [0, s], or of [s, 1] (de Casteljau).
void lwi_curve_cut( double* p, uint32_t degree, uint32_t stride, double s, bool keep_left );

/// The group's variables at t; the ends are the given states themselves.
const double* lwi_path_state( lwi_edge* edge, double t );

/// The full state at t, and the derivative of each variable per unit of t of the piece; a floating joint's three numbers from the
/// quaternion's first on are its angular velocity in the frame before the joint, in which its shift is given, not in the child's. @param speeds [robot variable_count], 0 for all but the group's; may be NULL
void lwi_path_at( const lwi_edge* edge, double t, double* state, double* speeds );

/// The same at the middles of the eight parts of [0, end], 0 < end <= 1. @param states, speeds [LWI_WIDTH][robot variable_count]
void lwi_path_lanes( const lwi_edge* edge, double end, double* states, double* speeds );

/// Do the tables of the reach hold along all of the path?
bool lwi_path_is_covered( const lwi_edge* edge );

/// Clearance grids know straight edges.
static inline bool lwi_path_is_straight( const lwi_edge* edge )
{
	return edge->path.curve.degree == 0;
}

/// How far a point may be at most from uniform motion over half a window, from its place and velocity in the middle.
static inline double lwi_path_acceleration( const lwi_edge* edge, lwi_motion_rate rate, double half )
{
	return rate.path > 0 ? ( 0.5 * half * rate.change + edge->path.twist_error ) * half * LWI_EDGE_OUTWARD : 0;
}

// --- motion/window.c ------------------------------------------------------------------------------------------------------

/// Forgets all poses: of another path.
void lwi_edge_forget_poses( lwi_edge* edge );

/// Notes at which state somebody else has posed the query; NaN: at none.
void lwi_edge_set_posed( lwi_edge* edge, double t );

/// Adds the state at t to out->queries, unless it was added last.
void lwi_edge_count_state( lwi_edge* edge, double t );

/// Poses the query at t. @return false if that failed; edge->failed is set
bool lwi_edge_pose( lwi_edge* edge, double t );

/// Measures how clusters move along the whole path, by their poses in its middle. @return false if that failed
bool lwi_edge_measure_path( lwi_edge* edge );

/// @param side 0 or 1: of which body of the pair @param m made in its place
void lwi_window_motion_of( const lwi_edge_pair* pair, int side, lwi_edge_window window, lwi_window_motion* m );

/// Largest distance from the middle's place to any other in the window, of the points of a sphere that the body carries.
/// @param sphere frame of the cluster's `root_link`
double lwi_window_displacement( lwi_edge* edge, const lwi_window_motion* motion, const lw_sphere* sphere );

/// How much the clearance of a pair may lose within a window, from its middle.
double lwi_window_loss( lwi_edge* edge, const lwi_edge_pair* pair, const lwi_window_motion motion[2] );

/// The body's poses in the window, seen from the ancestor.
void lwi_window_swept( lwi_edge* edge, const lwi_window_motion* motion, lwi_swept_poses* out );

// --- motion/gate.c --------------------------------------------------------------------------------------------------------

/// Begins the gate: all bodies in eight windows of [0, edge->work.end] at once, by their spheres and boxes.
void lwi_edge_gate_begin( lwi_edge* edge );

/// Goes on with it. Pairs not proved become the edge's pairs, with their cells.
/// @param to_the_end false: a body that seems to be inside of an obstacle ends the call @return true at the end
bool lwi_edge_gate( lwi_edge* edge, bool to_the_end );

// --- motion/planes.c ------------------------------------------------------------------------------------------------------

/// Searches for planes that prove a pair during a window. Obstacles that they prove are tested no more in that part.
/// @param motion of its bodies; [1] is not read for the scene @param need clearance that proves the pair without motion, margins excluded
/// @param out_some true: they proved the pair, or one of its obstacles
lwi_edge_plane_result lwi_edge_plane_test( lwi_edge* edge, const lwi_edge_pair* pair, const lwi_window_motion motion[2],
	double need, bool* out_some );

// --- motion/certify.c -----------------------------------------------------------------------------------------------------

/// Tries to prove a pair in a window: planes, then the distance in its middle.
lwi_edge_sample lwi_edge_certify( lwi_edge* edge, lwi_edge_pair* pair, lwi_edge_window window );

/// Windows of the gate that the window [cell, cell + 1] / 2^level touches.
static inline uint8_t lwi_edge_cells_of( uint64_t cell, int level )
{
	const int finer = LWI_GATE_LEVEL - level;
	return (uint8_t)( finer >= 0 ? ( ( 1u << ( 1 << finer ) ) - 1 ) << ( cell << finer ) : 1u << ( cell >> -finer ) );
}

/// False for windows that the gate has proved for a pair.
static inline bool lwi_edge_cell_is_open( const lwi_edge_pair* pair, uint64_t cell, int level )
{
	return ( pair->cells & lwi_edge_cells_of( cell, level ) ) != 0;
}

/// The verdict for a sample that ends the proof; always false. An undecided verdict never replaces a collision found elsewhere.
/// @param pair NULL: it is of none
bool lwi_edge_fail( lwi_edge* edge, const lwi_edge_pair* pair, double t, const lwi_edge_sample* sample );

/// Lower bound of the static bodies' clearance; +infinity if the query does not cover them.
double lwi_edge_static_lower( const lwi_edge* edge );

/// Are the static bodies above min_d? If not, that is the verdict.
bool lwi_edge_static_is_free( lwi_edge* edge );

/// Notes that something was proved by as much as edge->pairs.need.
void lwi_edge_note_proof( lwi_edge* edge );

/// No pairs, and what proves one along the path that was begun: its rounding, slack and clearance.
void lwi_edge_begin_pairs( lwi_edge* edge );

/// Adds a pair, of which bodies, ancestor and cells are given.
lwi_edge_pair* lwi_edge_add_pair( lwi_edge* edge, lwi_edge_pair pair );

/// True if a separation that holds along all of the path, less margins, is at least the clearance of a certificate.
/// @param tube metres: by which motions within the tolerance may reduce it
bool lwi_edge_is_separated( lwi_edge* edge, float separation, double tube );

/// True if the grid of two bodies proves all of the path, both ends of which are covered, with as much clearance.
/// @param slice NULL: there is none @param tube as for lwi_edge_is_separated()
bool lwi_edge_grid_proves( lwi_edge* edge, const lwi_grid_slice* slice, uint32_t body_a, uint32_t body_b, double tube );

// --- motion/work.c --------------------------------------------------------------------------------------------------------

/// Empties the list, but for one first window. @param from_left the leftmost window is always next
void lwi_work_begin( lwi_edge* edge, double end, bool from_left );

/// Is the whole robot above min_d at t? Nearest pair first. A failure is reported; an undecided verdict never replaces a collision
/// found elsewhere.
bool lwi_edge_state_is_free( lwi_edge* edge, double t );

/// Proves all pairs on the whole path and lowers out->lower_bound, or sets the verdict. @return true if it is free
bool lwi_edge_prove( lwi_edge* edge );

/// The right end of the run that is proved for every pair from t = 0, before the failure at out->t.
double lwi_edge_proved_run( lwi_edge* edge );

LW_EXTERN_C_END

#endif
