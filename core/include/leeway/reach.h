// SPDX-License-Identifier: BSD-3-Clause
// Where the parts of a robot can get to: range-of-motion hulls, and which of its links can ever meet.
//
// Computed once per robot, offline (seconds), and valid for every state inside the joint limits. Paper: Steinbach et al.
// 2006, sections III and IV. Words: R = the geometry of one link; M = everything that a link and its subtree can reach,
// seen from the parent link, over the ranges of all joints below the parent; MR = R and the M of all children together.
// Derivations: core/docs/motion_hulls.md, core/docs/self_collision.md.
#ifndef LEEWAY_REACH_H
#define LEEWAY_REACH_H

#include "leeway/robot.h"

LW_EXTERN_C_BEGIN

/// What lw_reach_create() needs. Make it with lw_reach_def_default().
typedef struct lw_reach_def
{
	const lw_robot* robot; ///< a reference is taken
	/// Metres, the error budget: by how much a hull may exceed the convex hull of what is truly reachable, summed over the
	/// longest chain. It sets the resolution at which joints are sampled. 0 = 1 % of the robot's longest chain.
	double hull_error;
	/// Radians or metres by which joint ranges are widened, so that states on a limit, or beyond it by rounding, are covered.
	double limit_margin;
	/// Seconds, >= 0, that everything after the motion hulls may take: samples, hulls of pairs, search for contact, charts and proofs by
	/// subdivision. Less time leaves more pairs to check, never a wrong answer, and lw_reach_continue() goes on from there. 0 = samples,
	/// hulls of pairs and search take what they take, without charts and subdivision: such a build repeats bit for bit.
	double seconds;
	bool hulls_only;  ///< no pair is measured or proved: all that are not rigid, adjacent or allowed are to be checked
	uint32_t samples; ///< random states at which all pairs are measured first: contact found needs no proof attempt
	uint64_t seed;
	/// Called now and then with the share done in [0, 1]; return false to give up (LW_ERROR_CANCELLED). Nullable. Never called by two
	/// threads at the same time, but by any of those that `parallel` uses.
	bool ( *progress )( void* user, const char* stage, double share );
	void* progress_user;
	/// Runs task( context, i ) for each i below count, on as many threads as it likes and in any order, and returns when all have returned.
	/// Tasks that it leaves are run one by one. What is proved does not depend on it, but for how much fits into `seconds`. The allocator
	/// must then be thread-safe. NULL = everything on the calling thread.
	void ( *parallel )( void* user, void ( *task )( void* context, uint32_t index ), void* context, uint32_t count );
	void* parallel_user;
	uint32_t cookie;
} lw_reach_def;

LW_API lw_reach_def lw_reach_def_default( void );

/// Immutable, shared by threads and checkers, reference counted.
typedef struct lw_reach lw_reach;

/// @return LW_OK, LW_ERROR_INVALID_DEF, LW_ERROR_INVALID_ARGUMENT (diag says which), LW_ERROR_OUT_OF_MEMORY,
/// LW_ERROR_CANCELLED, LW_ERROR_UNSUPPORTED (a build without qhull)
/// Cost: up to seconds for the motion hulls of a humanoid, plus the budget def->seconds; on the threads of def->parallel.
LW_API lw_status lw_reach_create( const lw_reach_def* def, const lw_allocator* allocator, lw_diag* diag,
	lw_reach** out_reach );

/// A reach of the same robot in which more is proved: goes on where `reach` stopped, for def->seconds, those pairs first whose bounding
/// spheres met in most of the random states. Nothing that was proved is lost; the hulls are copied. `reach` stays as it is.
/// @param def its seconds, samples, hulls_only, progress and parallel count; robot must be NULL or lw_reach_robot( reach )
/// @param allocator of the new reach
/// @return as lw_reach_create()
/// Cost: def->seconds at the most, but for the last step that was begun (milliseconds to some tenths of a second)
LW_API lw_status lw_reach_continue( const lw_reach* reach, const lw_reach_def* def, const lw_allocator* allocator, lw_diag* diag,
	lw_reach** out_reach );

/// How far the proofs of a reach are. Counts are of pairs that move against each other and whose contact is not allowed.
typedef struct lw_reach_info
{
	uint32_t pairs;      ///< all of them
	uint32_t proved;     ///< apart in every state
	uint32_t contact;    ///< a state in contact was found: there is no such proof
	uint32_t unprovable; ///< neither, and no more is tried: endless joints, contact just outside the limits, too many cells
	uint32_t open;       ///< neither, so far: more time may prove them
	uint32_t charts;     ///< of pairs between which at most three variables move
	uint32_t samples;    ///< random states measured
	uint64_t seed;       ///< of these
	double seconds;      ///< spent on all that def->seconds bounds, by this reach and those that it continues
	bool complete;       ///< more time changes nothing (for no more samples than were asked for)
} lw_reach_info;
LW_API lw_reach_info lw_reach_get_info( const lw_reach* reach );

LW_API lw_reach* lw_reach_retain( const lw_reach* reach );
LW_API void lw_reach_release( lw_reach* reach );
LW_API const lw_robot* lw_reach_robot( const lw_reach* reach );
LW_API size_t lw_reach_bytes( const lw_reach* reach );
/// The ranges of a variable for which everything here holds: its limits widened by limit_margin. A state outside is not
/// covered; checkers then ask without it.
LW_API void lw_reach_variable_range( const lw_reach* reach, uint32_t variable, double* out_lower, double* out_upper );

// Of an index that there is not, nothing is known: unbounded spheres, pairs to be checked, distances of 0, empty ranges.

/// A sphere; radius < 0: contains nothing; +inf: unbounded (a joint without limits).
typedef struct lw_sphere
{
	double center[3];
	double radius;
} lw_sphere;

/// The node of one link.
typedef struct lw_reach_node
{
	lw_sphere r;       ///< link frame
	lw_sphere m;       ///< frame of the parent link (of the world for the root)
	lw_sphere mr;      ///< link frame
	uint32_t hull_point_count; ///< of M; 0 if it is empty or unbounded
	double dilation;   ///< metres: M is contained in the convex hull of its points, dilated by this
	double excess;     ///< metres: how far that may exceed the convex hull of what is reachable
} lw_reach_node;
LW_API lw_reach_node lw_reach_get_node( const lw_reach* reach, uint32_t link );
/// Points of the M hull of a link, [hull_point_count][3], frame of its parent link, owned by the reach.
LW_API const double* lw_reach_hull_points( const lw_reach* reach, uint32_t link );

/// What is known of two links. The first that applies.
typedef enum lw_pair_class
{
	LW_PAIR_NONE = 0,     ///< the same link, or one has no geometry
	LW_PAIR_RIGID = 1,    ///< no joint between them moves: they never move against each other
	/// Neighbours: one of the two is the nearest link above the other that has geometry, whatever moves in between. (MoveIt's
	/// Setup Assistant says the same, and also joins all neighbours of a link without geometry to each other; that would
	/// take siblings for adjacent, which can collide.)
	LW_PAIR_ADJACENT = 2,
	LW_PAIR_ALLOWED = 3,  ///< allowed by the robot's list (SRDF)
	LW_PAIR_NEVER = 4,    ///< proved: apart in every state, see `proof`
	LW_PAIR_ALWAYS = 5,   ///< in contact in every state that was looked at. Evidence, not a proof
	LW_PAIR_CHECK = 6     ///< to be checked
} lw_pair_class;
LW_API const char* lw_pair_class_name( lw_pair_class kind ); ///< "adjacent", "never", ...

typedef enum lw_pair_proof
{
	LW_PROOF_NONE = 0,
	LW_PROOF_HULL = 1,       ///< hulls of both links' motion, seen from their common ancestor, are apart (equation 1)
	LW_PROOF_SUBDIVISION = 2 ///< the joint box was cut into cells, each with clearance above its motion bound
} lw_pair_proof;
LW_API const char* lw_pair_proof_name( lw_pair_proof proof );

typedef struct lw_reach_pair
{
	lw_pair_class kind;
	lw_pair_proof proof; ///< also of adjacent and allowed pairs, if there is one
	bool adjacent; ///< as LW_PAIR_ADJACENT says; also of rigid pairs
	bool allowed;  ///< listed by the robot
	double separation;   ///< proved, metres: in no state are the two links closer. 0 = nothing is proved
	double closest;      ///< the least distance found in any state looked at; 0 = contact; +inf if none was measured
	double contact_share; ///< share of the random states in contact
	uint32_t variable_count; ///< variables that move the two against each other
} lw_reach_pair;
LW_API lw_reach_pair lw_reach_get_pair( const lw_reach* reach, uint32_t link_a, uint32_t link_b );
/// The state where `closest` was found, the evidence: q [variable_count] is written. False if there is none.
LW_API bool lw_reach_closest_state( const lw_reach* reach, uint32_t link_a, uint32_t link_b, double* q );

/// Equations (1) to (12), as distances: the paper's truth value is "> 0". Each is a proved lower bound, in metres, of all
/// distances that the entry stands for; +inf where it stands for nothing that is to be checked.
LW_API double lw_reach_base( const lw_reach* reach, uint32_t link_i, uint32_t link_j );   ///< (1) R_i, R_j
LW_API double lw_reach_rigid( const lw_reach* reach, uint32_t link_i, uint32_t link_j );  ///< (3) R_i, M_j
LW_API double lw_reach_motion( const lw_reach* reach, uint32_t link_i, uint32_t link_j ); ///< (4) M_i, M_j
LW_API double lw_reach_scfree( const lw_reach* reach, uint32_t link_i );                  ///< (12) inside MR_i

LW_EXTERN_C_END

#endif
