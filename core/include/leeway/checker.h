// SPDX-License-Identifier: BSD-3-Clause
// The two questions of a planner, answered with a proof: is this state valid, and is this motion valid?
#ifndef LEEWAY_CHECKER_H
#define LEEWAY_CHECKER_H

#include "leeway/reach.h"
#include "leeway/scene.h"

LW_EXTERN_C_BEGIN

/// A link and an object that may touch.
typedef struct lw_link_object_pair
{
	uint32_t link, object;
} lw_link_object_pair;

/// The margin of one pair; it replaces the sum of the general margins.
typedef struct lw_pair_margin
{
	uint32_t a;    ///< link
	uint32_t b;    ///< object; in a self pair the other link
	double margin; ///< metres, >= 0
} lw_pair_margin;

/// Distances that pairs must keep beyond contact, in metres, finite and >= 0; zeroed: no margins. The *clearance* of a pair is
/// its distance minus its margin, and every answer of a checker is a clearance, for states and edges alike: core/docs/margins.md.
///   link to object:  environment + link_environment[link] + object[object], summed in this order
///   link to link:    self + link_self[lower index] + link_self[higher index], in this order
/// A pair in one of the lists has the listed margin instead of the sum, larger or smaller.
typedef struct lw_margins
{
	double environment;
	double self;
	const double* link_environment;          ///< [robot link_count]; NULL = all 0
	const double* link_self;                 ///< [robot link_count]; NULL = all 0
	const double* object;                    ///< [scene object_count]; NULL = all 0
	const lw_pair_margin* environment_pairs; ///< [environment_pair_count] link, object; each pair once
	uint32_t environment_pair_count;
	const lw_pair_margin* self_pairs; ///< [self_pair_count] two different links in either order; each pair once
	uint32_t self_pair_count;
} lw_margins;

typedef struct lw_checker_def
{
	const lw_robot* robot; ///< a reference is taken
	const lw_scene* scene; ///< a reference is taken; NULL = no environment
	/// The group: the robot variables in a state vector of this checker, in its order; NULL = all variables in robot order.
	/// A planar or floating joint has all of its variables in the group or none.
	const uint32_t* variables;
	uint32_t variable_count;
	/// [robot variable_count] values of the variables outside the group; NULL = default state. Entries of group variables
	/// must be finite; their values are ignored.
	const double* reference;
	const lw_link_object_pair* allowed; ///< [allowed_count]
	uint32_t allowed_count;
	lw_margins margins; ///< copied. Allowed contacts stay allowed, whatever their margin
	/// Motion hulls and pair tables of this robot, or of an equal one (lw_robot_digest()); a reference is taken. NULL =
	/// none. They make queries faster and change no answer: a query skips only pairs that are proved to be irrelevant.
	/// States outside lw_reach_variable_range() are checked without them. See core/docs/self_collision.md.
	const lw_reach* reach;
	/// Metres, > 0: the largest clearance of interest (the max_d of later ranges); INFINITY if unknown. Obstacles that the
	/// group cannot approach to within max_d inside its limits are skipped, and deferred ones (lw_shape_create_deferred())
	/// are never made. It changes no answer: queries with a larger max_d, and states outside the limits, use all obstacles.
	double max_d;
	/// A similar checker, for instance with one obstacle moved, added or removed. The new checker shares or copies all equal
	/// parts (the robot and its group, if robot, reach, variables and reference are equal) and computes the rest:
	/// microseconds instead of milliseconds. It changes no answer. No reference is taken; NULL = none.
	const struct lw_checker* previous;
	/// Check only the changes: every pair is left out that `previous` checks too, at the same place and with no smaller margin.
	/// A state or motion that is FREE by `previous`, and FREE by this checker with the same tolerance and min_d, is FREE by a
	/// checker of all pairs; proving it again costs only the pairs that moved, were added or attached. All pairs are checked if
	/// the groups, the references, or the robots without attached objects differ.
	bool only_changes;
	/// Called on the calling thread with up to 64 deferred shapes that are needed at once. It may make them by
	/// lw_shape_complete() on any number of threads, and returns when they are done. Shapes that it does not make are then
	/// made one by one. It changes no answer. NULL = none.
	void ( *prepare )( void* user, const lw_shape* const* shapes, uint32_t shape_count );
	void* prepare_user;
	uint32_t cookie;
} lw_checker_def;

LW_API lw_checker_def lw_checker_def_default( void );

/// Everything needed to check one group of one robot in one scene. Immutable, shared by all threads, reference counted.
///
/// All its numbers are clearances (distance minus margin): lower and upper of intervals, min_d, max_d and slack of calls.
/// A clearance is negative if the pair is nearer than its margin, and never below minus the margin; where contact cannot be
/// excluded, lower is minus the largest margin. alpha is relative to clearances above min_d. Witness points are on the
/// geometry: the distance of a pair is its upper plus its margin.
///
/// Links that the group does not move are static: their distance to the scene is measured once, at creation, and is part
/// of every environment interval. Self pairs are the pairs whose relative pose the group can change and that may not touch.
typedef struct lw_checker lw_checker;

/// @return LW_OK, LW_ERROR_INVALID_DEF, LW_ERROR_INVALID_ARGUMENT (diag names it), LW_ERROR_OUT_OF_MEMORY
LW_API lw_status lw_checker_create( const lw_checker_def* def, const lw_allocator* allocator, lw_diag* diag,
	lw_checker** out_checker );

/// Differences to an existing checker. Make it with lw_checker_edit_def_default(): no difference.
typedef struct lw_checker_edit_def
{
	const lw_scene* scene; ///< NULL = the same. From lw_scene_edit(), or any other: bit-equal parts are recognised
	const lw_robot* robot; ///< NULL = the same. From lw_robot_attach() and lw_robot_detach()
	const lw_link_object_pair* allowed; ///< [allowed_count], indices of the new robot and the new scene
	uint32_t allowed_count;
	/// False: allowed contacts stay allowed for links and objects whose names still exist, and `allowed` adds to them. True:
	/// `allowed` replaces them.
	bool replace_allowed;
	/// NULL: each link, object and pair whose names still exist keeps its margin; new ones have only the general margins.
	/// Otherwise these margins replace the old ones.
	const lw_margins* margins;
	double max_d;      ///< as lw_checker_def::max_d; NaN = the same
	bool only_changes; ///< as lw_checker_def::only_changes: pairs of `checker` itself are left out where they did not change
	uint32_t cookie;
} lw_checker_edit_def;

LW_API lw_checker_edit_def lw_checker_edit_def_default( void );

/// Makes a new checker with another scene or another attached object. `checker` is unchanged; queries that use it keep
/// it and its scene alive. The answers equal those of a checker made from scratch; equal parts are shared or copied.
/// Queries made for one checker serve its edits as long as they are large enough: lw_query_fits(), and spare_shapes and
/// spare_bodies of lw_query_def.
/// @return as lw_checker_create(); LW_ERROR_INVALID_ARGUMENT also if def->robot does not come from this
/// checker's robot by lw_robot_attach() and lw_robot_detach()
/// Cost: another scene: microseconds, plus a few per changed shape; more only if the nearest obstacle of the static links
/// may have changed. Another robot: all data that depend on bodies are computed again. Figures: core/docs/edits.md.
LW_API lw_status lw_checker_edit( const lw_checker* checker, const lw_checker_edit_def* def, const lw_allocator* allocator,
	lw_diag* diag, lw_checker** out_checker );

LW_API lw_checker* lw_checker_retain( const lw_checker* checker );
LW_API void lw_checker_release( lw_checker* checker );

LW_API const lw_robot* lw_checker_robot( const lw_checker* checker );
LW_API const lw_scene* lw_checker_scene( const lw_checker* checker ); ///< NULL if none
/// Margin of a link and an object, or of two links, in metres. 0 for out-of-range indices.
LW_API double lw_checker_environment_margin( const lw_checker* checker, uint32_t link, uint32_t object );
LW_API double lw_checker_self_margin( const lw_checker* checker, uint32_t link_a, uint32_t link_b );
LW_API uint32_t lw_checker_variable_count( const lw_checker* checker );
LW_API uint32_t lw_checker_variable( const lw_checker* checker, uint32_t index ); ///< robot variable of state entry `index`
/// Writes the full robot state [robot variable_count] of a group state q [variable_count].
LW_API void lw_checker_full_state( const lw_checker* checker, const double* q, double* full );

/// Contents of a checker. Counts are of bodies (shapes of links) and of pairs.
typedef struct lw_checker_info
{
	uint32_t moving_bodies;     ///< bodies on links that the group moves
	uint32_t static_bodies;     ///< the others
	uint32_t environment_pairs; ///< moving bodies x scene shapes, without allowed ones
	uint32_t self_pairs;        ///< pairs of bodies to check for self-collision
	uint32_t never_pairs;       ///< of self_pairs: proved apart by the reach; contact-only checks skip them
	bool hierarchy;             ///< the checker has a reach, and the reach covers the values of variables outside the group
	/// Metres of clearance: obstacles that the group cannot approach to within this, inside its limits, are skipped. The
	/// smaller of max_d and the clearance of the static bodies, which no state exceeds.
	double horizon;
	uint32_t near_shapes;                   ///< scene shapes that are not skipped
	double environment_margin, self_margin; ///< metres: upper bounds of the margins of all pairs
	lw_clearance static_environment; ///< of the static bodies; a = link, b = object; FAR, lower = +inf if there is no pair
	size_t bytes;
} lw_checker_info;
LW_API lw_checker_info lw_checker_get_info( const lw_checker* checker );

/// Metres: a proved lower bound of the clearance between all moving bodies and a scene shape, over all states within the
/// limits. Minus the margin if nothing is proved; +inf if no moving body is checked against the shape. Shapes at or above
/// lw_checker_info.horizon are skipped.
LW_API double lw_checker_obstacle_distance( const lw_checker* checker, uint32_t scene_shape );

/// Makes the deferred shapes that states within the limits can need, so that no later call has to: scene shapes that are not
/// skipped, and static bodies that a moving body checked against them can approach to within lw_checker_def::max_d. Other
/// shapes stay deferred. It changes no answer; a call that needs a deferred shape makes it.
/// @param prepare as lw_checker_def::prepare; NULL = all are made on this thread
/// @param user passed to prepare
/// @return LW_OK, LW_ERROR_INVALID_ARGUMENT, or the status of the shape that could not be made (diag says why): calls that
/// come near that shape fail with the same status
/// Cost: below a millisecond, plus half a microsecond per triangle for the trees. Any number of threads may call it, also
/// while others use the checker.
LW_API lw_status lw_checker_prepare( const lw_checker* checker,
	void ( *prepare )( void* user, const lw_shape* const* shapes, uint32_t shape_count ), void* user, lw_diag* diag );

/// Outcome of a state or edge check.
typedef enum lw_verdict
{
	LW_VERDICT_UNKNOWN = 0,  ///< an error
	LW_VERDICT_FREE = 1,     ///< proved: every selected clearance is > min_d
	LW_VERDICT_BLOCKED = 2,  ///< found: a selected clearance is <= min_d
	LW_VERDICT_UNDECIDED = 3 ///< not decided: the clearance is in the stated band just above min_d
} lw_verdict;

/// "FREE", "BLOCKED", "UNDECIDED" or "UNKNOWN".
LW_API const char* lw_verdict_name( lw_verdict verdict );

/// Selects the clearances to check.
typedef enum lw_check_flags
{
	LW_CHECK_ENVIRONMENT = 1,
	LW_CHECK_SELF = 2,
	LW_CHECK_BOTH = 3
} lw_check_flags;

typedef struct lw_state_result
{
	lw_verdict verdict;
	lw_clearance environment; ///< a = link, b = object; FAR, lower = +inf without a scene; UNKNOWN if not selected
	lw_clearance self;        ///< a, b = links; FAR, lower = +inf if there are no pairs; UNKNOWN if not selected
} lw_state_result;

/// Checks one state.
/// With an exact range both intervals are measured. If `stop_at_first` is set, the first violation ends the call, and the
/// other interval may be UNKNOWN.
/// Intervals hold for the exact kinematics of q: the rounding bound P of the poses is subtracted from lower (about 1e-12 m
/// for an arm; formula in core/docs/numerics.md). So with alpha = 0, upper - lower is at most P plus the rounding of
/// lw_clearance.
/// @param q [lw_checker_variable_count()]
/// @param range NULL = exact
/// @return LW_OK, or LW_ERROR_INVALID_ARGUMENT for a non-finite value, a zero quaternion, or translations so large that P
/// exceeds three metres. On an error the verdict is UNKNOWN and the intervals are [0, +inf]: an error never reads as free
LW_API lw_status lw_checker_state( const lw_checker* checker, lw_query* query, const double* q, lw_check_flags flags,
	const lw_range* range, bool stop_at_first, lw_state_result* out );

/// The answer of lw_checker_is_free() with its reason.
typedef struct lw_state_reason
{
	/// FREE: every selected clearance is above min_d. BLOCKED: the clearance of `pair` is at most min_d. UNDECIDED: that of
	/// `pair` is min_d up to rounding. UNKNOWN: an error.
	lw_verdict verdict;
	bool self; ///< `pair` is two links; false: a link and an object
	/// The first pair found that is not above min_d: a = link, b = object or link. Its `upper` is attained; it need not be the
	/// least clearance of the state. UNKNOWN if the state is FREE, and after an error.
	lw_clearance pair;
} lw_state_reason;

/// Is every clearance of the state above min_d? The fastest validity check: it measures no more than the answer needs.
/// @param q as for lw_checker_state()
/// @param min_d safety margin, metres, finite, >= 0
/// @param out_free true: proved. False: a clearance is at most min_d, or rounding (1e-12 m for an arm) decides, or an error
/// @param out_reason the pair that is too near; nullable
/// @return as lw_checker_state()
LW_API lw_status lw_checker_is_free( const lw_checker* checker, lw_query* query, const double* q, lw_check_flags flags,
	double min_d, bool* out_free, lw_state_reason* out_reason );

/// How much lw_checker_states() measures.
typedef enum lw_states_effort
{
	LW_STATES_CONTACT = 1, ///< contact with the scene only: no state is FREE, and the first BLOCKED one ends the call
	LW_STATES_LANES = 2,   ///< eight states at a time in the lanes of vectors; those that need more are UNDECIDED
	LW_STATES_FULL = 3,    ///< lanes, then lw_checker_is_free() for each state that they leave undecided
	/// LANES for states along a motion, of which only those before the first BLOCKED one matter: states of the same four (0 to
	/// 3, 4 to 7 ..) as a BLOCKED one, and all behind them, may be left UNDECIDED
	LW_STATES_ALONG = 4
} lw_states_effort;

/// lw_checker_is_free() of many states, eight at a time in the lanes of vectors: the spheres of meshes prove states free, and
/// vertices of the robot's meshes inside boxes and cylinders prove them blocked. CONTACT suits states of an edge before its proof.
/// @param q [count][lw_checker_variable_count()]
/// @param out [count] FREE and BLOCKED as by lw_checker_is_free(). UNDECIDED: not decided with this effort; with FULL: a clearance
/// is min_d up to rounding
/// @param out_open [count] the tests that remain for an UNDECIDED state: a state that passes them in lw_checker_is_free() is
/// free; 0 for other states. Nullable
/// @return as lw_checker_state(); after an error all verdicts are UNKNOWN
/// Method: core/docs/states.md.
LW_API lw_status lw_checker_states( const lw_checker* checker, lw_query* query, const double* q, uint32_t count,
	lw_check_flags flags, double min_d, lw_states_effort effort, lw_verdict* out, lw_check_flags* out_open );

/// How an edge is validated.
typedef enum lw_edge_method
{
	LW_EDGE_CERTIFIED = 1, ///< proved along the whole edge by clearance against motion bounds
	LW_EDGE_STEPS = 2      ///< states at fixed steps between which no robot point moves further than max_d
} lw_edge_method;

enum
{
	LW_EDGE_MOST_STATES = 1 << 18 ///< limit of states per edge; cut longer edges (thousands of turns) into pieces
};

typedef struct lw_edge_def
{
	lw_edge_method method;
	lw_check_flags flags;
	double min_d; ///< metres, >= 0: the edge must keep every clearance above it
	/// Metres, > 0, CERTIFIED: clearances in (min_d, min_d + slack] may be UNDECIDED. It is an upper bound that needs no
	/// tuning: a pair within the band gets its own slack, half of its remaining clearance, down to rounding.
	double slack;
	uint32_t close_windows; ///< CERTIFIED: how many time intervals may be halved for pairs within slack, 1,024; 0: none
	double max_d;           ///< metres, > 0, STEPS: bound of the motion of any robot point between two checked states
	double alpha;           ///< relative tolerance of the distances used, [0, 1)
	/// Compute proved_until also if a violation is found early (t_last of OMPL's checkMotion). Costs as many states again, or 8
	/// if those are more; up to 32 while nothing is proved.
	bool want_proved_until;
	/// CERTIFIED: FREE holds for every motion r with |r_j(t) - q_j(t)| <= tolerance[j] at all t, q being the edge; what a
	/// controller may deviate before it stops. [variable count of the group], radians and metres, finite, >= 0; 0 for
	/// quaternions. NULL: 0. BLOCKED is about the edge itself. Read during the call only.
	const double* tolerance;
	uint32_t cookie;
} lw_edge_def;

LW_API lw_edge_def lw_edge_def_default( void );

/// The answer for an edge.
///
/// Verdicts of edges whose least clearance is above min_d + slack, or that touch, do not depend on earlier calls. Within
/// (min_d, min_d + slack] an edge may be FREE or UNDECIDED, and an edge that collides BLOCKED or UNDECIDED, depending on earlier
/// calls with the same query; lw_query_reset() makes equal calls equal.
/// Remedies for UNDECIDED: allow the pair if it may touch, or reduce min_d; with a tolerance, reduce the tolerance.
typedef struct lw_edge_result
{
	/// FREE by CERTIFIED: proved for every t in [0, 1].
	/// FREE by STEPS: every checked state is above min_d; core/docs/edges.md derives what max_d adds.
	/// BLOCKED: the state at t has a clearance of at most min_d: that of `pair`.
	/// UNDECIDED with a pair: at t every clearance is above min_d, that of `pair` is at most (min_d + slack) / (1 - alpha), and
	/// no window around t could be proved, or too many would have to be halved (close_windows). A tolerance raises the limit by
	/// the distance that the pair's points may move within it.
	/// UNDECIDED with `pair` UNKNOWN: the edge takes more than LW_EDGE_MOST_STATES states; cut it into pieces.
	/// UNKNOWN: an error.
	lw_verdict verdict;
	double t;            ///< of the violation or undecided verdict; 1 if FREE
	double proved_until; ///< all of [0, proved_until] is proved (STEPS: checked); 1 if FREE; 0 if not wanted
	bool self;           ///< `pair` is two links; false: a link and an object
	lw_clearance pair;   ///< the deciding clearance at t: a = link, b = object or link; UNKNOWN if FREE or too long
	/// CERTIFIED and FREE: a proved lower bound, > min_d, of all clearances along the edge and along all motions within the
	/// tolerance. Otherwise 0.
	double lower_bound;
	uint32_t queries; ///< states at which distances were measured
} lw_edge_result;

/// Checks the straight edge from qa to qb (see lw_robot_interpolate): both ends and everything between.
/// @return LW_OK, LW_ERROR_INVALID_DEF, LW_ERROR_INVALID_ARGUMENT (verdict UNKNOWN)
/// Cost: CERTIFIED: typically a handful of states. At most 2 V / slack + 2, where V bounds the motion of any robot point
/// over the edge; plus 2 close_windows if pairs are within slack, plus 5 to search for a collision; never more than
/// LW_EDGE_MOST_STATES. proved_until: as many again, at least 8. STEPS: V / max_d states.
/// Method: Schwarzer, Saha, Latombe 2005, with motion bounded by chords; formulas and proof in core/docs/edges.md.
LW_API lw_status lw_checker_edge( const lw_checker* checker, lw_query* query, const double* qa, const double* qb,
	const lw_edge_def* def, lw_edge_result* out );

enum
{
	LW_CURVE_MOST_DEGREE = 7
};

/// Checks a polynomial motion, a Bezier curve of the group's variables: q(t) = sum of C(n, i) t^i (1 - t)^(n - i) points[i],
/// t in [0, 1], n the degree. A piecewise curve (spline, trajectory) takes one call for each piece.
/// Angles are plain numbers: a continuous joint turns as far as its control points say. Quaternions must be the same in all.
/// @param points [degree + 1][lw_checker_variable_count()], finite; read during the call only
/// @param degree 1 to LW_CURVE_MOST_DEGREE
/// @param def as for lw_checker_edge(), CERTIFIED only
/// @param out as for lw_checker_edge(). BLOCKED: the curve's own state at t has the violation. UNDECIDED: `pair` is measured at a
/// state whose robot points are less than slack / 8 away from those of the curve's state at t
/// @return LW_OK, LW_ERROR_INVALID_DEF, LW_ERROR_INVALID_ARGUMENT (verdict UNKNOWN)
/// Cost: that of an edge, and more the farther the curve is from its chord: at a distance of 2 to 10 % of the chord's length
/// 1.2 to 2.1 times the cost of the chord (core/docs/lab/motions.md).
/// Method: edges whose joints speed up and slow down; proof in core/docs/motions.md.
LW_API lw_status lw_checker_curve( const lw_checker* checker, lw_query* query, const double* points, uint32_t degree,
	const lw_edge_def* def, lw_edge_result* out );

LW_EXTERN_C_END

#endif
