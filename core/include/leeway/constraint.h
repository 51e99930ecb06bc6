// SPDX-License-Identifier: BSD-3-Clause
// Constraints on the pose of a frame, proved for all times: a seam to follow, a cup to keep upright, a tray in two hands.
#ifndef LEEWAY_CONSTRAINT_H
#define LEEWAY_CONSTRAINT_H

#include "leeway/clock.h"

LW_EXTERN_C_BEGIN

/// How the angles that `turns` limits are read from a rotation.
typedef enum lw_turns
{
	LW_TURNS_VECTOR = 0, ///< coordinates of the rotation vector, of length up to pi
	LW_TURNS_XYZ = 1     ///< angles a, b, c of Rx(a) Ry(b) Rz(c), b within a quarter turn: MoveIt's XYZ_EULER_ANGLES
} lw_turns;

/// A pose region: where a frame B has to be, seen from a frame A. A *reference* pose moves in A with a *fraction*: B's errors are those
/// from the reference.
///
/// Position error: of B's origin from the reference's, along the axes that the reference has at fraction 0. Rotation: from the reference's
/// axes to B's. Limits that are INFINITY are none, and so are angles of half a turn; at least one is finite. Two arms with a tray: A and B are frames of their hands.
typedef struct lw_region_def
{
	uint32_t base_link, link; ///< of A and of B; LW_INVALID_INDEX: the world
	lw_transform base_from_a; ///< A in its link
	lw_transform link_from_b; ///< B in its link
	lw_transform start;       ///< the reference in A at fraction 0
	lw_vec3 shift;            ///< metres, in A: the reference shifts by this while the fraction goes from 0 to 1
	lw_vec3 arc,
		center;   ///< its origin turns about an axis through `center` by the rotation vector `arc`, in A, before it shifts
	lw_vec3 turn; ///< rotation vector in A by which its axes turn, at uniform speed
	double lower[3], upper[3]; ///< metres: limits of the position error, lower < upper
	double angle;              ///< radians, > 0: limit of the angle of the rotation
	double tilt;               ///< radians, > 0: limit of the angle between `axis` of B and of the reference
	lw_vec3 axis;              ///< of B and of the reference, any length but 0; z
	double turns[3];           ///< radians, > 0: limits of the absolute angles of the rotation, as `turns_are` says
	lw_turns turns_are;
	uint32_t cookie;
} lw_region_def;

/// World and link 0, a reference at rest at A, and no limits.
LW_API lw_region_def lw_region_def_default( void );

/// A reference that goes along the straight line between two poses, with axes that turn about one axis, the shorter way.
/// @param from, to in A; lw_transform_is_valid()
/// @return LW_OK, LW_ERROR_INVALID_ARGUMENT (then *def is unchanged)
LW_API lw_status lw_region_line( lw_region_def* def, const lw_transform* from, const lw_transform* to );

/// A reference along the arc of a circle from `from` through `via` to the place of `to`, with axes as of lw_region_line().
/// @return LW_OK, LW_ERROR_INVALID_ARGUMENT (also: the three places are on one line, to 1e-9 of their distances; *def is unchanged)
LW_API lw_status lw_region_arc( lw_region_def* def, const lw_transform* from, lw_vec3 via, const lw_transform* to );

/// The reference in A. @param fraction of its way; any finite number
LW_API lw_transform lw_region_reference( const lw_region_def* def, double fraction );

/// A region of a checker's robot, with the memory of its proofs: one thread at a time uses it.
typedef struct lw_region lw_region;

/// Variables outside of the group are at the checker's reference state.
/// @param checker a reference is taken
/// @return LW_OK, LW_ERROR_INVALID_DEF, LW_ERROR_INVALID_ARGUMENT (diag names it: a link, a pose, a limit that leaves no room, no limit),
/// LW_ERROR_OUT_OF_MEMORY
LW_API lw_status lw_region_create( const lw_checker* checker, const lw_region_def* def, const lw_allocator* allocator,
	lw_diag* diag, lw_region** out_region );
LW_API void lw_region_destroy( lw_region* region ); ///< NULL is ignored

/// What a region limits.
typedef enum lw_region_limit
{
	LW_REGION_X = 0, ///< position errors
	LW_REGION_Y = 1,
	LW_REGION_Z = 2,
	LW_REGION_ANGLE = 3,
	LW_REGION_TILT = 4,
	LW_REGION_TURN_X = 5,
	LW_REGION_TURN_Y = 6,
	LW_REGION_TURN_Z = 7,
	LW_REGION_LIMITS = 8 ///< how many they are; none
} lw_region_limit;

/// "position x", "angle", ...; "none" for others.
LW_API const char* lw_region_limit_name( lw_region_limit limit );

/// Errors of one state, as double arithmetic computes them.
typedef struct lw_region_errors
{
	lw_transform pose;               ///< of B in A
	double value[LW_REGION_LIMITS];  ///< metres and radians; angles in [0, pi], turns with their signs
	double excess[LW_REGION_LIMITS]; ///< how far beyond its limit each is; at most 0 within
	lw_region_limit worst;           ///< that with the largest excess among the finite limits
} lw_region_errors;

/// @param q [lw_checker_variable_count()]
/// @param fraction finite, of the reference's way
/// @return LW_OK, LW_ERROR_INVALID_ARGUMENT (a number that is not finite, a zero quaternion)
/// Cost: one transform product for each moving joint between the frames.
LW_API lw_status lw_region_state( lw_region* region, const double* q, double fraction, lw_region_errors* out );

/// Some errors of a state and their derivatives, in the order of lw_region_limit: for Newton steps onto a region, tangents and optimisers.
///
/// @param errors bit mask, 1 << lw_region_limit, of 1 to LW_REGION_LIMITS errors
/// @param values [errors in the mask] as those of lw_region_state()
/// @param jacobian [errors in the mask][lw_checker_variable_count()] of `values` by the variables, metres and radians for each radian or metre; of a
/// floating joint by the entries of its quaternion. Rows are 0 where an error has no derivative: of the angle and the tilt at 0 and at half a turn,
/// of x-y-z turns at a gimbal lock, within 1e-9. Nullable
/// @return as lw_region_state(), and LW_ERROR_INVALID_ARGUMENT for other masks; then nothing is changed
/// Cost: as lw_region_state() for positions, up to twice as much with angles.
LW_API lw_status lw_region_rows( lw_region* region, const double* q, double fraction, uint32_t errors, double* values,
	double* jacobian );

typedef struct lw_region_result
{
	/// FREE: proved for every time of the interval and for all motions that lags and tolerances allow: no error is beyond its limit.
	/// BLOCKED: at `time` the error `limit` of the tracks themselves is beyond its limit, by more than rounding.
	/// UNDECIDED: an error near `time` is at its limit up to rounding, the tubes of lags and tolerances leave no room, or the work has
	/// ended. UNKNOWN: an error of the call.
	lw_verdict verdict;
	double time;           ///< seconds; the end if FREE
	lw_region_limit limit; ///< that decides; LW_REGION_LIMITS if FREE or UNKNOWN
	double value, excess;  ///< of it at `time`, metres or radians
	double proved_until;   ///< seconds: FREE's claim holds from the start to here
	/// FREE: bounds of all errors at all times, proved; of the limits that are not asked for too, where they are known: else INFINITY.
	/// `lower` of angle and tilt is 0, of turns -upper.
	double lower[LW_REGION_LIMITS], upper[LW_REGION_LIMITS];
	uint64_t windows, states; ///< tried
} lw_region_result;

/// Proves that a region is kept on the tracks of a clock from start to end.
///
/// The reference is where `timing` says: at the same time on the same clock.
/// @param clock as lw_clock_check() accepts it; no track with a joint between A and B spreads; read during the call only
/// @param timing the fraction: a track of one variable (its index counts for nothing) without lag, tolerance and spread. NULL: 0
/// @param start, end seconds, finite, start <= end
/// @return LW_OK, LW_ERROR_INVALID_ARGUMENT (verdict UNKNOWN)
/// Cost: about 2 us for each window of seven joints; a window of a motion that is fitted to a line is some tenth of a second long.
/// At most LW_EDGE_MOST_STATES states. It allocates nothing. Method: core/docs/constraints.md.
LW_API lw_status lw_region_timed( lw_region* region, const lw_clock* clock, const lw_track* timing, double start, double end,
	lw_region_result* out );

LW_EXTERN_C_END

#endif
