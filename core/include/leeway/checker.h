// SPDX-License-Identifier: BSD-3-Clause
// The two questions of a planner: is this state valid, and is this motion? Both answered with a proof.
#ifndef LEEWAY_CHECKER_H
#define LEEWAY_CHECKER_H

#include "leeway/reach.h"
#include "leeway/scene.h"

LW_EXTERN_C_BEGIN

/// Contact between a link and an object that does not count.
typedef struct lw_link_object_pair
{
	uint32_t link, object;
} lw_link_object_pair;

/// The margin of one pair, in place of the sum of its parts.
typedef struct lw_pair_margin
{
	uint32_t a;    ///< link
	uint32_t b;    ///< object; of a self pair the other link
	double margin; ///< metres, >= 0
} lw_pair_margin;

/// How much of a distance does not count: the *clearance* of a pair is its distance less its margin. Metres, finite and >= 0;
/// zeroed: no margins.
///   link to object:  environment + link_environment[link] + object[object], summed in this order
///   link to link:    self + link_self[lower index] + link_self[higher index], in this order
/// and of a pair that is listed what is listed, larger or smaller. Everything that a checker answers is clearance in these
/// terms, for states and edges alike: core/docs/margins.md.
typedef struct lw_margins
{
	double environment;
	double self;
	const double* link_environment; ///< [robot link_count]; NULL = all 0
	const double* link_self;        ///< [robot link_count]; NULL = all 0
	const double* object;           ///< [scene object_count]; NULL = all 0
	const lw_pair_margin* environment_pairs; ///< [environment_pair_count] link, object; each pair once
	uint32_t environment_pair_count;
	const lw_pair_margin* self_pairs; ///< [self_pair_count] two different links in either order; each pair once
	uint32_t self_pair_count;
} lw_margins;

typedef struct lw_checker_def
{
	const lw_robot* robot; ///< a reference is taken
	const lw_scene* scene; ///< a reference is taken; NULL = no environment
	/// The group: robot variables that a state vector of this checker holds, in its order; NULL = all variables in robot
	/// order. All variables of a planar or floating joint are in a group or none.
	const uint32_t* variables;
	uint32_t variable_count;
	/// [robot variable_count] values of the variables outside the group; NULL = default state. The group's have to be finite, and say nothing.
	const double* reference;
	const lw_link_object_pair* allowed; ///< [allowed_count]
	uint32_t allowed_count;
	lw_margins margins; ///< copied. Contact that is allowed stays so, whatever its margin
	/// Motion hulls and pair tables of this robot, or of an equal one (lw_robot_digest()); a reference is taken. NULL = none.
	/// They make queries faster and change no answer: what is passed over is proved to be beyond what was found already.
	/// States outside of lw_reach_variable_range() are asked as without them. See core/docs/self_collision.md.
	const lw_reach* reach;
	/// Metres, > 0: the largest clearance that queries will ask for (range.max_d, or clearance worth a number); INFINITY if any.
	/// Obstacles that the group cannot come this near to within its limits are passed over at once, and those that are deferred
	/// (lw_shape_create_deferred()) are never made for it. No answer depends on it: queries that ask for more, and states outside
	/// of the limits, are asked with everything there is.
	double max_d;
	/// A checker that this one differs little from: another pose of an obstacle, one more, one less. What is the same is shared
	/// with it (the robot and its group, when robot, reach, variables and reference are the same) or copied, and only the rest is
	/// computed: microseconds instead of milliseconds. No answer depends on it. No reference is taken; NULL = none.
	const struct lw_checker* previous;
	/// Called on this thread when several deferred shapes are needed at once, with up to 64 of them: by lw_shape_complete() it may make
	/// them on as many threads as it likes, and returns when it is done. What it leaves is made one by one. No answer depends on
	/// it. NULL = none.
	void ( *prepare )( void* user, const lw_shape* const* shapes, uint32_t shape_count );
	void* prepare_user;
	uint32_t cookie;
} lw_checker_def;

LW_API lw_checker_def lw_checker_def_default( void );

/// Everything needed to check one group of one robot in one scene. Immutable, shared by all threads, reference counted.
/// All its answers are clearances, distances less margins: lower and upper of an interval, min_d, max_d and slack of a
/// question. Where a pair is nearer than its margin they are negative, no lower than minus the margin; alpha is relative to
/// clearances above min_d, and so to positive ones. Witness points are on the geometry itself: the distance of the pair is
/// upper + its margin. A lower of 0 "when contact cannot be excluded" is minus the largest margin where there are any.
/// Links that the group does not move are static: their distance to the scene is measured once, at creation, and is part
/// of every environment interval. Self pairs are those whose relative pose the group can change and that are not allowed.
typedef struct lw_checker lw_checker;

/// @return LW_OK, LW_ERROR_INVALID_DEF, LW_ERROR_INVALID_ARGUMENT (diag says which), LW_ERROR_OUT_OF_MEMORY
LW_API lw_status lw_checker_create( const lw_checker_def* def, const lw_allocator* allocator, lw_diag* diag,
	lw_checker** out_checker );

/// What is to be different. Make it with lw_checker_edit_def_default(): nothing.
typedef struct lw_checker_edit_def
{
	const lw_scene* scene; ///< NULL = the same. From lw_scene_edit(), or any other: what is the same to the bit is recognised
	const lw_robot* robot; ///< NULL = the same. From lw_robot_attach() and lw_robot_detach()
	const lw_link_object_pair* allowed; ///< [allowed_count], indices of the robot and the scene as they are to be
	uint32_t allowed_count;
	/// False: what was allowed stays so, for links and objects that are still there by name; `allowed` comes on top. True: only
	/// `allowed` counts.
	bool replace_allowed;
	/// NULL: each link, object and pair that is still there by name keeps its margin, what is new has none of its own. Otherwise
	/// these count, and nothing of what was.
	const lw_margins* margins;
	double max_d; ///< as lw_checker_def::max_d; NaN = the same
	uint32_t cookie;
} lw_checker_edit_def;

LW_API lw_checker_edit_def lw_checker_edit_def_default( void );

/// A snapshot: the checker with another scene, or with something in its hand. The checker itself stays as it is; queries that
/// use it keep it, with its scene. Answers are those of a checker made from nothing, and it shares or copies what is the same.
/// Queries made for one snapshot serve the others as long as they are large enough: lw_query_fits(), and the spare_... of
/// lw_query_def.
/// @return as lw_checker_create(); LW_ERROR_INVALID_ARGUMENT also for a robot of other origin
/// Cost: another scene: microseconds, plus a few for each shape that changed; more only if what stands still may have got another
/// nearest obstacle. Another robot: what depends on bodies is computed again. Figures in core/docs/edits.md.
LW_API lw_status lw_checker_edit( const lw_checker* checker, const lw_checker_edit_def* def, const lw_allocator* allocator,
	lw_diag* diag, lw_checker** out_checker );

LW_API lw_checker* lw_checker_retain( const lw_checker* checker );
LW_API void lw_checker_release( lw_checker* checker );

LW_API const lw_robot* lw_checker_robot( const lw_checker* checker );
LW_API const lw_scene* lw_checker_scene( const lw_checker* checker ); ///< NULL if none
/// Margin of a link to an object, or of two links: what is taken off the distance of the pair. 0 for indices out of range.
LW_API double lw_checker_environment_margin( const lw_checker* checker, uint32_t link, uint32_t object );
LW_API double lw_checker_self_margin( const lw_checker* checker, uint32_t link_a, uint32_t link_b );
LW_API uint32_t lw_checker_variable_count( const lw_checker* checker );
LW_API uint32_t lw_checker_variable( const lw_checker* checker, uint32_t index ); ///< robot variable of state entry `index`
/// Writes the full robot state [robot variable_count] of a group state q [variable_count].
LW_API void lw_checker_full_state( const lw_checker* checker, const double* q, double* full );

/// What a checker keeps. Counts of bodies (shapes of links) and pairs.
typedef struct lw_checker_info
{
	uint32_t moving_bodies;  ///< bodies on links that the group moves
	uint32_t static_bodies;  ///< the others
	uint32_t environment_pairs; ///< moving bodies x scene shapes, without allowed ones
	uint32_t self_pairs;     ///< pairs of bodies to check for self-collision
	uint32_t never_pairs;    ///< of these: proved apart by the reach, never searched where only contact is asked for
	bool hierarchy;          ///< queries can use the reach: there is one, and it covers the variables outside of the group
	/// Metres of clearance: obstacles that the group cannot come this near to within its limits are passed over. The least of max_d and what
	/// the static bodies have already: no state has more.
	double horizon;
	uint32_t near_shapes;    ///< scene shapes that are not passed over
	double environment_margin, self_margin; ///< metres: the largest of any pair, or more
	lw_clearance static_environment; ///< of the static bodies; a = link, b = object; FAR with lower = +inf if there is nothing
	size_t bytes;
} lw_checker_info;
LW_API lw_checker_info lw_checker_get_info( const lw_checker* checker );

/// Metres: a proved lower bound of the clearance of all moving bodies to a scene shape, in all states within the limits; 0 less
/// the margin if nothing is proved, +inf if no moving body is checked against it. At or above the horizon it is passed over.
LW_API double lw_checker_obstacle_distance( const lw_checker* checker, uint32_t scene_shape );

/// Makes deferred shapes that states within the limits can need, so that no question has to: bodies that stand still and that a body
/// which moves, and is checked against them, may come within lw_checker_def::max_d of; scene shapes that are not passed over. Others stay
/// deferred. No answer depends on it; a question that needs a shape which is still deferred makes it.
/// @param prepare as lw_checker_def::prepare, NULL = all are made on this thread. @param user passed on to it
/// @return LW_OK, LW_ERROR_INVALID_ARGUMENT, or what making a shape returned (diag says why): questions that come near it fail alike
/// Cost: a fraction of a millisecond, and that of the shapes' trees, half a microsecond per triangle. Any number of threads may call
/// it, and ask questions meanwhile.
LW_API lw_status lw_checker_prepare( const lw_checker* checker,
	void ( *prepare )( void* user, const lw_shape* const* shapes, uint32_t shape_count ), void* user, lw_diag* diag );

/// What a state or an edge turned out to be.
typedef enum lw_verdict
{
	LW_VERDICT_UNKNOWN = 0, ///< an error
	LW_VERDICT_FREE = 1,    ///< proved: every clearance asked for is > min_d
	LW_VERDICT_BLOCKED = 2, ///< found: a clearance is <= min_d
	LW_VERDICT_REFUSED = 3  ///< neither: within the stated band just above min_d
} lw_verdict;

/// "FREE", "BLOCKED", "REFUSED" or "UNKNOWN".
LW_API const char* lw_verdict_name( lw_verdict verdict );

/// Which clearances are asked for.
typedef enum lw_what
{
	LW_WHAT_ENVIRONMENT = 1,
	LW_WHAT_SELF = 2,
	LW_WHAT_BOTH = 3
} lw_what;

typedef struct lw_state_result
{
	lw_verdict verdict;
	lw_clearance environment; ///< a = link, b = object; FAR with lower = +inf if there is no scene; UNKNOWN if not asked
	lw_clearance self;        ///< a, b = links; FAR with lower = +inf if there are no pairs; UNKNOWN if not asked
} lw_state_result;

/// Checks one state.
/// With an exact range both intervals are always measured. If `stop_at_first` is set, the first violation found ends the
/// whole query (the other interval may then be UNKNOWN): the fastest validity check is range {min_d, nextafter(min_d), 0}
/// with stop_at_first.
/// Intervals hold for the exact kinematics of q: what double arithmetic may be off by, P = 2^-53 (n + 2) (192 L + 24 |root| + 64 distance)
/// with n joints and L metres of offsets and shifts along the longest chain (1e-12 m for an arm), is taken off lower. So with alpha = 0
/// upper - lower is at most P and the rounding of lw_clearance.
/// @param q [lw_checker_variable_count()]; a non-finite value, a zero quaternion, or shifts so large that P exceeds three metres
/// are LW_ERROR_INVALID_ARGUMENT, verdict UNKNOWN, intervals [0, +inf]: an error never reads as free
/// @param range NULL = exact
LW_API lw_status lw_checker_state( const lw_checker* checker, lw_query* query, const double* q, lw_what what,
	const lw_range* range, bool stop_at_first, lw_state_result* out );

/// How an edge is validated.
typedef enum lw_edge_method
{
	LW_EDGE_CERTIFIED = 1, ///< proved along the whole edge by clearance against motion bounds
	LW_EDGE_STEPS = 2      ///< states at fixed steps between which no robot point moves further than max_d
} lw_edge_method;

enum
{
	LW_EDGE_MOST_STATES = 1 << 18 ///< of one edge: longer ones, thousands of turns, are to be cut
};

typedef struct lw_edge_def
{
	lw_edge_method method;
	lw_what what;
	double min_d; ///< metres, >= 0: the edge must keep every clearance above it
	/// Metres, > 0, CERTIFIED: clearances in (min_d, min_d + slack] may be refused. An upper bound that nobody has to know: a pair within it
	/// gets a slack of its own, half of the room that it has, down to rounding.
	double slack;
	uint32_t close_windows; ///< CERTIFIED: parts of the edge that are halved for pairs within the slack, 1,024; 0: they are refused at once
	double max_d; ///< metres, > 0, STEPS: bound of the motion of any robot point between two checked states
	double alpha; ///< relative tolerance of the distances used, [0, 1)
	/// Compute proved_until even when a violation was found early (t_last of OMPL's checkMotion). Costs extra queries.
	bool want_proved_until;
	uint32_t cookie;
} lw_edge_def;

LW_API lw_edge_def lw_edge_def_default( void );

typedef struct lw_edge_result
{
	/// CERTIFIED: FREE is a proof for every t in [0, 1]. BLOCKED: a state with clearance <= min_d was found, at t. REFUSED: at
	/// t the clearance of `pair` is at most (min_d + slack) / (1 - alpha), and the proof was given up: the pair has next to no room there, or
	/// stays near for so long that windows ran out (below). Disable it if it may touch, or ask for a smaller min_d.
	/// STEPS: FREE means that all checked states are > min_d, no more; see core/docs/edges.md for what follows from max_d.
	/// Both: REFUSED with `pair` UNKNOWN: the edge takes more than LW_EDGE_MOST_STATES states; cut it.
	lw_verdict verdict;
	double t;            ///< of the violation or refusal; 1 if FREE
	double proved_until; ///< all of [0, proved_until] is proved (STEPS: checked); 1 if FREE; 0 if not wanted
	bool self;           ///< the pair below is a self pair
	lw_clearance pair;   ///< the deciding clearance at t: a = link, b = object or link; UNKNOWN if FREE, or REFUSED for its length
	double lower_bound;  ///< CERTIFIED and FREE: a proved lower bound of all clearances along the edge, > min_d; else 0
	uint32_t queries;    ///< states at which distances were measured
} lw_edge_result;

/// Checks the straight edge from qa to qb (see lw_robot_interpolate): both ends and everything between.
/// @return LW_OK, LW_ERROR_INVALID_DEF, LW_ERROR_INVALID_ARGUMENT (verdict UNKNOWN)
/// Cost: CERTIFIED: at most 2 V / slack + 2 states, V the largest motion bound over the edge; 2 close_windows more if pairs are within the slack, and 4
/// in search of a collision; never more than LW_EDGE_MOST_STATES. Typically a handful. proved_until may take as many again. STEPS: V / max_d
/// states. Method: Schwarzer, Saha, Latombe 2005, with motion bounded by chords; formulas and proof in core/docs/edges.md.
LW_API lw_status lw_checker_edge( const lw_checker* checker, lw_query* query, const double* qa, const double* qb,
	const lw_edge_def* def, lw_edge_result* out );

LW_EXTERN_C_END

#endif
