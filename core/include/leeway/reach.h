// SPDX-License-Identifier: BSD-3-Clause
// Range of motion of a robot: hulls of all places that its parts can reach, and tables of the link pairs that can ever meet.
//
// Computed once per robot, offline (seconds), and valid for every state inside the joint limits. Paper: Steinbach et al.
// 2006, sections III and IV. Terms: R = the geometry of one link; M = all places that a link and its subtree can reach, in
// the frame of the parent link, over the ranges of all joints below the parent; MR = R and the M of all children together.
// Derivations: core/docs/motion_hulls.md, core/docs/self_collision.md.
#ifndef LEEWAY_REACH_H
#define LEEWAY_REACH_H

#include "leeway/robot.h"

LW_EXTERN_C_BEGIN

/// Input of lw_reach_create(). Make it with lw_reach_def_default().
typedef struct lw_reach_def
{
	const lw_robot* robot; ///< a reference is taken
	/// Metres: the error budget, how far a hull may exceed the convex hull of the truly reachable places, summed over the
	/// longest chain. It sets the resolution at which joints are sampled. 0 = 1 % of the robot's longest chain.
	double hull_error;
	/// Radians or metres: joint ranges are widened by this, so that they cover states on a limit or beyond it by rounding.
	double limit_margin;
	/// Seconds, >= 0: time budget of all steps after the motion hulls: samples, hulls of pairs, search for contact,
	/// clearance grids and proofs by subdivision. With less time more pairs remain to be checked; no answer becomes wrong,
	/// and lw_reach_continue() goes on from there. 0 = samples, hulls of pairs and the search run to their end, without
	/// grids and subdivision: such a build repeats bit for bit.
	double seconds;
	bool hulls_only;  ///< make no proofs: every pair that is not rigid, adjacent or allowed remains to be checked
	uint32_t samples; ///< random states at which all pairs are measured first; pairs found in contact need no proof
	uint64_t seed;
	/// Progress callback: receives the share done in [0, 1] and returns false to cancel (LW_ERROR_CANCELLED). Nullable. Any
	/// thread of `parallel` may call it, but never two at the same time.
	bool ( *progress )( void* user, const char* stage, double share );
	void* progress_user;
	/// Runs task( context, i ) for each i below count, on any number of threads in any order, and returns when all have
	/// returned. Tasks that it does not run are then run one by one. The proofs do not depend on it, except that more of
	/// them fit into `seconds`. The allocator must be thread-safe. NULL = all tasks run on the calling thread.
	void ( *parallel )( void* user, void ( *task )( void* context, uint32_t index ), void* context, uint32_t count );
	void* parallel_user;
	uint32_t cookie;
} lw_reach_def;

LW_API lw_reach_def lw_reach_def_default( void );

/// Motion hulls and pair tables of one robot. Immutable, shared by threads and checkers, reference counted.
typedef struct lw_reach lw_reach;

/// @return LW_OK, LW_ERROR_INVALID_DEF, LW_ERROR_INVALID_ARGUMENT (diag names it), LW_ERROR_OUT_OF_MEMORY,
/// LW_ERROR_CANCELLED, LW_ERROR_UNSUPPORTED (a build without qhull)
/// Cost: up to seconds for the motion hulls of a humanoid, plus def->seconds; it runs on the threads of def->parallel.
LW_API lw_status lw_reach_create( const lw_reach_def* def, const lw_allocator* allocator, lw_diag* diag,
	lw_reach** out_reach );

/// Makes a new reach of the same robot with more proofs: it resumes where `reach` stopped and runs for def->seconds. Pairs
/// whose bounding spheres met in most of the random states come first. All earlier proofs are kept; the hulls are copied;
/// `reach` is unchanged.
/// @param def only seconds, samples, hulls_only, progress and parallel are used; robot must be NULL or that of `reach`
/// @param allocator of the new reach
/// @return as lw_reach_create()
/// Cost: at most def->seconds plus the step in progress (milliseconds to some tenths of a second)
LW_API lw_status lw_reach_continue( const lw_reach* reach, const lw_reach_def* def, const lw_allocator* allocator,
	lw_diag* diag, lw_reach** out_reach );

/// Progress of the proofs. Counts are of pairs that move against each other and that may not touch.
typedef struct lw_reach_info
{
	uint32_t pairs;      ///< all of them
	uint32_t proved;     ///< proved apart in every state
	uint32_t contact;    ///< found in contact in some state: no proof exists
	uint32_t unprovable; ///< neither, and given up: endless joints, contact just outside the limits, too many cells
	uint32_t open;       ///< neither, so far: more time may prove them
	uint32_t grids;      ///< clearance grids made; only pairs with at most three variables between them have one
	uint32_t samples;    ///< random states measured
	uint64_t seed;       ///< seed of the random states
	double seconds;      ///< spent of the time budgets of this reach and of those that it continues
	bool complete;       ///< more time changes nothing (at the same number of samples)
} lw_reach_info;
LW_API lw_reach_info lw_reach_get_info( const lw_reach* reach );

LW_API lw_reach* lw_reach_retain( const lw_reach* reach );
LW_API void lw_reach_release( lw_reach* reach );
LW_API const lw_robot* lw_reach_robot( const lw_reach* reach );
/// The range of a variable that this reach covers: its limits widened by limit_margin. Checkers ignore the reach for states
/// outside.
LW_API void lw_reach_variable_range( const lw_reach* reach, uint32_t variable, double* out_lower, double* out_upper );

// Out-of-range indices return the conservative default: unbounded spheres, CHECK pairs, empty ranges.

/// A sphere. radius < 0: empty; +inf: unbounded (a joint without limits).
typedef struct lw_sphere
{
	double center[3];
	double radius;
} lw_sphere;

/// Bounds of one link: spheres around R, M and MR, and the size of the M hull.
typedef struct lw_reach_node
{
	lw_sphere r;               ///< link frame
	lw_sphere m;               ///< frame of the parent link (of the world for the root)
	lw_sphere mr;              ///< link frame
	uint32_t hull_point_count; ///< of M; 0 if it is empty or unbounded
	double dilation;           ///< metres: M is contained in the convex hull of its points, dilated by this
	double excess;             ///< metres: upper bound of how far that exceeds the convex hull of the reachable places
} lw_reach_node;
LW_API lw_reach_node lw_reach_get_node( const lw_reach* reach, uint32_t link );
/// Points of the M hull of a link, [hull_point_count][3], frame of its parent link, owned by the reach.
LW_API const double* lw_reach_hull_points( const lw_reach* reach, uint32_t link );

/// Class of a link pair: the first that applies.
typedef enum lw_pair_class
{
	LW_PAIR_NONE = 0,  ///< the same link, or one has no geometry
	LW_PAIR_RIGID = 1, ///< no joint between them moves: their relative pose is constant
	/// Neighbours: one of them is the nearest link with geometry above the other, whatever joints are between. (MoveIt's
	/// Setup Assistant also joins all neighbours of a link without geometry to each other; that would include siblings,
	/// which can collide.)
	LW_PAIR_ADJACENT = 2,
	LW_PAIR_ALLOWED = 3, ///< allowed by the robot's list (SRDF)
	LW_PAIR_NEVER = 4,   ///< proved: apart in every state, see `proof`
	LW_PAIR_ALWAYS = 5,  ///< in contact in every state that was measured: evidence, not a proof
	LW_PAIR_CHECK = 6    ///< none of the above: must be checked
} lw_pair_class;
LW_API const char* lw_pair_class_name( lw_pair_class kind ); ///< "adjacent", "never", ...

typedef enum lw_pair_proof
{
	LW_PROOF_NONE = 0,
	LW_PROOF_HULL = 1,       ///< motion hulls of both links, in their common ancestor's frame, are apart (equation 1)
	LW_PROOF_SUBDIVISION = 2 ///< the joint box was cut into cells, each with clearance above its motion bound
} lw_pair_proof;
LW_API const char* lw_pair_proof_name( lw_pair_proof proof );

typedef struct lw_reach_pair
{
	lw_pair_class kind;
	lw_pair_proof proof;     ///< of any pair that has one, adjacent and allowed pairs included
	bool adjacent;           ///< as LW_PAIR_ADJACENT; also set for rigid pairs
	bool allowed;            ///< listed by the robot
	double separation;       ///< metres, proved: the links are at least this far apart in every state; 0 = nothing is proved
	double closest;          ///< metres: the smallest distance measured in any state; 0 = contact; +inf = none measured
	double contact_share;    ///< share of the random states in contact
	uint32_t variable_count; ///< variables that move the two against each other
} lw_reach_pair;
LW_API lw_reach_pair lw_reach_get_pair( const lw_reach* reach, uint32_t link_a, uint32_t link_b );
/// Writes the state at which `closest` was measured to q [variable_count]. False if there is none.
LW_API bool lw_reach_closest_state( const lw_reach* reach, uint32_t link_a, uint32_t link_b, double* q );

LW_EXTERN_C_END

#endif
