// SPDX-License-Identifier: BSD-3-Clause
// How far the points of a body can move along an edge: an upper bound of their path lengths.
#ifndef LEEWAY_ROBOT_MOTION_BOUND_H
#define LEEWAY_ROBOT_MOTION_BOUND_H

#include "leeway/reach.h"
#include "robot/robot.h"

LW_EXTERN_C_BEGIN

/// Data of a robot's bodies that no edge changes: enclosing spheres, distances to the first joint axis, and for each
/// joint j above body b the largest distance from b to the axis of j over *all* configurations. Immutable, kept by the
/// checker, which also keeps the robot alive.
typedef struct lwi_motion_table lwi_motion_table;

/// A rigid group: bodies on links between which no joint of the edges moves, and a sphere around them.
typedef struct lwi_rigid_group
{
	uint32_t link;    ///< its frame is the frame of the fields below
	lw_sphere sphere; ///< contains the bodies
	uint32_t count;   ///< of shapes, where they are
	const lw_shape* const* shapes;
	const lw_transform* link_from_shape;
} lwi_rigid_group;

/// A table over groups instead of bodies: below, `body` is then a group. Nothing of `groups` is kept.
lw_status lwi_motion_table_create_groups( const lw_robot* robot, const lwi_rigid_group* groups, uint32_t group_count,
	const bool* fixed_variables, const double* reference, const lw_allocator* allocator, lw_diag* diag,
	lwi_motion_table** out_table );

/// Each body is a group.
/// @param fixed_variables [variable_count] true where the variable stays at reference[variable] in every edge; NULL = none.
/// All variables of a planar or floating joint are fixed or none.
/// @param reference [variable_count]; finite. May be NULL if fixed_variables is
/// @return LW_OK, LW_ERROR_OUT_OF_MEMORY, LW_ERROR_INVALID_ARGUMENT (zero quaternion in the reference)
lw_status lwi_motion_table_create( const lw_robot* robot, const bool* fixed_variables, const double* reference,
	const lw_allocator* allocator, lw_diag* diag, lwi_motion_table** out_table );
void lwi_motion_table_destroy( lwi_motion_table* table ); ///< NULL is ignored
size_t lwi_motion_table_bytes( const lwi_motion_table* table );

/// Upper bound, for any point of any body, of the distance between its place in the world at a state and the place that
/// double arithmetic computes. Poses are not quite rigid: a distance of two bodies, in the frame of one of them, is off by
/// up to three times that and *stretch times itself. Derivation: core/docs/numerics.md. Cost: the moving joints that shift,
/// or that follow others.
/// @param state [variable_count] finite
double lwi_motion_state_rounding( const lwi_motion_table* table, const double* state, double* stretch, double* reach );

/// Bytes of scratch, 64-aligned, that lwi_motion_measure() fills. It holds pointers into itself: it must not be moved.
size_t lwi_motion_scratch_size( const lwi_motion_table* table );
/// How much more that may be for a robot with this many more links on fixed joints.
size_t lwi_motion_scratch_spare( uint32_t links );

/// Measures the edge qa -> qb (full states, finite; the motion of lw_robot_interpolate over t in [0, 1]) for all bodies.
/// Holds for states outside the joint limits too. @return false for a zero quaternion or an edge whose length overflows
bool lwi_motion_measure( const lwi_motion_table* table, const double* qa, const double* qb, void* scratch );

/// Bounds of the motion of a body's points along the whole edge, rounded outward. On any part [s, t] of the edge a point's
/// way is at most (t - s) * path long, and its velocity changes by at most (t - s) * change.
typedef struct lwi_motion_rate
{
	double path;   ///< metres per unit of t. 0 exactly if no joint in between moves
	double change; ///< largest acceleration, metres per squared unit of t
} lwi_motion_rate;

enum
{
	LWI_NO_TRACK = LW_INVALID_INDEX,
	LWI_TWO_TRACKS = LW_INVALID_INDEX - 1
};

/// Variables on tracks, each with a clock of its own that may be late. The bodies of one track are late as one, and goes through the
/// same states later; so only bodies that two tracks move, or of which each has its own, see each other elsewhere.
typedef struct lwi_motion_late
{
	const double* tolerance; ///< [variable_count] that of the motion, and by how much the variable may be off by being late
	const uint32_t* tracks;  ///< [variable_count] LWI_NO_TRACK: it rests
} lwi_motion_late;

/// Of a body, by the joints between it and an ancestor.
typedef struct lwi_motion_tube
{
	double timely;  ///< metres: on the clock of its track
	double late;    ///< metres: with all tracks as late as they may be, >= timely
	uint32_t track; ///< that moves it; LWI_NO_TRACK, LWI_TWO_TRACKS or more
} lwi_motion_tube;

/// lwi_motion_measure() in steps: bounds that need no pose, then the joints' places at some state of the edge, then body by
/// body.
/// @param poses [link_count] world_from_link at that state, of the bodies' links and of the moving joints' children
/// @param share of the edge, on the longer side of that state: 0.5 for its middle
bool lwi_motion_begin( const lwi_motion_table* table, const double* qa, const double* qb, void* scratch );
/// Ranges of the variables along a curve over t in [0, 1], and of their derivatives: [variable_count] each. Those that do not
/// move have least = most, and 0. A quaternion's are not read: a floating joint only shifts. Bounds of a shift's coordinates are
/// taken as a vector: its length is the bound of the shift.
typedef struct lwi_motion_ranges
{
	const double *least, *most;
	const double *speed, *change; ///< no smaller than the absolute first and second derivative
} lwi_motion_ranges;

/// lwi_motion_begin() for a curve, whose angles do not wrap and whose quaternions stay. `share` of lwi_motion_measure_body()
/// is then of t.
bool lwi_motion_begin_curve( const lwi_motion_table* table, const lwi_motion_ranges* ranges, void* scratch );
/// Metres: how far any point of any body is at most from its place on the motion that was begun, for motions within a tolerance.
double lwi_motion_any_tube( const lwi_motion_table* table, const void* scratch, const double* tolerance );

/// Between begin and measure_body: bounds are asked for motions that differ from the edge at any time by at most this much.
/// @param tolerance [variable_count] >= 0, finite; 0 for variables that are no joint values or shifts
/// @param late NULL: nothing follows a clock of its own
void lwi_motion_tolerate( const lwi_motion_table* table, void* scratch, const double* tolerance,
	const lwi_motion_late* late );
/// Metres: how far any point of any body moves at most if each variable changes by so much, as in lwi_motion_tolerate(); shifts
/// of joints below are assumed in their middle.
double lwi_motion_moved_by( const lwi_motion_table* table, const double* by );
void lwi_motion_place( const lwi_motion_table* table, void* scratch, const lw_transform* poses );
void lwi_motion_measure_body( const lwi_motion_table* table, void* scratch, uint32_t body, const lw_transform* poses,
	double share );

/// Motion of a measured body in the frame of `ancestor`: a link above the body's link or that link itself, or
/// LW_INVALID_INDEX for the world.
lwi_motion_rate lwi_motion_of( const lwi_motion_table* table, const void* scratch, uint32_t body, uint32_t ancestor );
double lwi_motion_bound( const lwi_motion_table* table, const void* scratch, uint32_t body, uint32_t ancestor ); ///< path
/// Metres: distance of a measured body's points from their places on the edge at the same time, for all motions within the
/// tolerance, in the frame of `ancestor`. 0 without a tolerance.
lwi_motion_tube lwi_motion_tube_of( const lwi_motion_table* table, const void* scratch, uint32_t body, uint32_t ancestor );
/// Does a pair feel that tracks are late? Only if two of them move it. @param a, b tracks of its sides, `b` LWI_NO_TRACK for the scene
static inline bool lwi_motion_feels_late( uint32_t a, uint32_t b )
{
	return a == LWI_TWO_TRACKS || b == LWI_TWO_TRACKS || ( a != b && a != LWI_NO_TRACK && b != LWI_NO_TRACK );
}
/// No less than that of any body, in the frame of any link above it; known before bodies are measured.
double lwi_motion_largest_tube( const void* scratch );

/// How far points get from the straight line between their places at both ends of a part of the edge.
typedef struct lwi_chord_error
{
	double coefficient; ///< metres: s ( 1 - s ) of this at the share s of the part
	double max;         ///< metres, at the most
} lwi_chord_error;

/// @param h the part's length in t
lwi_chord_error lwi_chord_error_of( lwi_motion_rate rate, double h );

/// Upper bound of the distance of a point from where it is at one end of a part of the edge, anywhere on the part.
/// @param chord of its places at both ends, or more @param path along the part
double lwi_motion_between( double chord, lwi_chord_error error, double path );

/// Radians that all joints together turn along the edge.
double lwi_motion_rotation( const void* scratch );
/// How far the velocity of a point of any body, of twists that were summed up joint by joint in double, is from the true one at most.
double lwi_motion_twist_error( const void* scratch );

/// Upper bound of the path length of any body in the world along the whole edge, once it was begun: looser than that of any
/// of its parts.
double lwi_motion_total( const void* scratch );

/// Upper bound of the distance between a body's point at t and its place in the world by double arithmetic, for all bodies.
double lwi_motion_rounding( const void* scratch );

// --- cells of the joint space, seen from one of two links ----------------------------------------------------------------
//
// A *way* leads from the link of a body to another link: the joints that a variable moves, in order, constant ones left out;
// the first `upward` of them lead towards the root. None is a floating joint. Derivation: core/docs/self_collision.md.

/// Raises lengths[k], k = 0 .. count, to the largest distance of any point of `body` from its place at `center`, in any
/// state whose variables differ from `center` by at most half_width, in a frame behind the first k joints of the way.
/// Rounded outward.
/// @param center, half_width [variable_count] @param table made without fixed variables
/// @param poses [link_count] of the links next to the way's joints and of the body's link at `center`, in one frame
/// @param rounding bounds the rounding of those poses, see lwi_motion_box_rounding()
void lwi_motion_cell( const lwi_motion_table* table, uint32_t body, const uint32_t* way, uint32_t count, uint32_t upward,
	const double* center, const double* half_width, const lw_transform* poses, double rounding, double* lengths );

/// Upper bound of lwi_motion_rounding() for poses relative to any link of the way, at all states in a finite box.
double lwi_motion_box_rounding( const lwi_motion_table* table, uint32_t body, const uint32_t* way, uint32_t count,
	const double* lower, const double* upper );

LW_EXTERN_C_END

#endif
