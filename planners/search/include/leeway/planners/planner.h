// SPDX-License-Identifier: BSD-3-Clause
// Paths in joint space for programs in C: a checker, starts and goals in; a path of proved edges out. The search and the
// smoother are those of planner.hpp and smooth.hpp. The library behind it is C++ and needs neither files nor OMPL.
//
//     lw_plan_def def = lw_plan_def_default();
//     def.checker = checker;
//     def.starts = start, def.start_count = 1;
//     def.goals = goal, def.goal_count = 1;
//     def.seconds = 1;
//     lw_plan_result result;
//     if ( lw_plan( &def, &diag, &result ) == LW_OK && result.outcome == LW_PLAN_SOLVED ) { use( result.states ); }
//     lw_plan_result_clear( &result );
#ifndef LEEWAY_PLANNERS_PLANNER_H
#define LEEWAY_PLANNERS_PLANNER_H

#include "leeway/checker.h"

LW_EXTERN_C_BEGIN

/// How a search ended. Only SOLVED has a path; no other outcome states that there is none.
typedef enum lw_plan_outcome
{
	LW_PLAN_UNKNOWN = 0,    ///< an error, or a path whose clearance is within the slack: see lw_plan_result.message
	LW_PLAN_SOLVED = 1,     ///< each edge of the path is FREE by lw_checker_edge()
	LW_PLAN_TIMED_OUT = 2,  ///< lw_plan_def.seconds are over
	LW_PLAN_CANCELLED = 3,  ///< lw_plan_def.cancel
	LW_PLAN_NODES_FULL = 4, ///< lw_plan_def.most_nodes
	LW_PLAN_NO_START = 5,   ///< no start is proved free
	LW_PLAN_NO_GOAL = 6     ///< no goal is proved free
} lw_plan_outcome;

/// "SOLVED", "TIMED_OUT", ...; "UNKNOWN" for any other value. Static storage.
LW_API const char* lw_plan_outcome_name( lw_plan_outcome outcome );

/// A flag that ends a search. Zeroed: not requested. It belongs to the caller, and lives as long as the call that reads it.
typedef struct lw_plan_cancel
{
	uint32_t requested;
} lw_plan_cancel;

/// Sets the flag. Any thread may call it, and a signal handler.
LW_API void lw_plan_request_cancel( lw_plan_cancel* cancel );

/// Counts of work.
typedef struct lw_plan_statistics
{
	uint64_t samples, states, states_free;
	uint64_t lane_states; ///< states checked in the lanes of vectors, most of them inside edges: lw_checker_states()
	uint64_t edges, free, blocked, undecided; ///< edges = free + blocked + undecided + errors; smoothing included
	uint64_t edge_queries;                    ///< states at which edges measured distances
	uint64_t start_nodes, goal_nodes;         ///< of the two trees
} lw_plan_statistics;

/// A problem. Make it with lw_plan_def_default(), which has no checker and no ends. All arrays belong to the caller and are
/// read during the call only. n = lw_checker_variable_count(); metres and radians, in the order of the checker's variables.
typedef struct lw_plan_def
{
	const lw_checker* checker; ///< robot, scene and group; floating joints are not supported
	lw_query* query; ///< made for the checker (lw_query_fits()), used by this call alone; NULL = one is made and destroyed
	const double* starts; ///< [start_count][n] alternatives, within the bounds; those that are not free are left out
	uint32_t start_count; ///< at least 1
	const double* goals;  ///< [goal_count][n] alternatives
	uint32_t goal_count;  ///< at least 1
	const double* lower;  ///< [n] bounds of samples and ends; NULL = joint limits. Entries of angles that wrap are not used
	const double* upper;  ///< [n]
	lw_edge_def edge;     ///< how states and edges are validated; its min_d is the clearance that the path keeps
	double range;         ///< longest edge that a tree grows by, Euclidean, > 0; 0 = a length that suits the robot
	double
	    sample_radius; ///< samples lie within this many ranges of a node, 6.5; 0 = anywhere in the bounds, as half of the first 64
	uint64_t seed; ///< equal seeds give equal paths, unless time or a cancellation ends the work, or threads > 1
	uint32_t
	    threads; ///< searches side by side with the seeds seed, seed + 1, ..., 1 to 64; the first path ends all: portfolio.hpp; 1
	uint64_t most_nodes;          ///< of both trees, 2 to 2^32 - 1; 2^20
	double seconds;               ///< of the clock, for search and smoothing together; INFINITY
	const lw_plan_cancel* cancel; ///< looked at between edges; NULL = none
	bool smooth;                  ///< shortcuts and cut corners, each edge proved again; true
	/// After the first path: shorter ones for so many seconds, as long as `seconds` lasts, or for so many samples: optimize.hpp. 0: no; 0
	double optimize_seconds;
	uint64_t optimize_samples; ///< UINT64_MAX
	/// After all other work the path is pushed away from obstacles and links, up to this clearance above edge.min_d, metres: clearance.hpp. The
	/// path gets longer by a tenth at most. 0: no; 0
	double clearance_goal;
	/// Of the clock, for that, as long as `seconds` lasts; INFINITY: until nothing is gained, so that equal seeds give equal paths; 0.01
	double clearance_seconds;
	bool explain; ///< without a path, measure the reasons: up to a second after the end of the search; true
	uint32_t cookie;
} lw_plan_def;

LW_API lw_plan_def lw_plan_def_default( void );

enum
{
	LW_PLAN_MESSAGE = 2048, ///< bytes of lw_plan_result.message
	LW_PLAN_PAIRS = 8       ///< of lw_plan_stuck
};

/// A pair that kept motions from being free.
typedef struct lw_plan_pair
{
	uint32_t a, b;      ///< a link, and an object or another link; LW_INVALID_INDEX: motions too long to check
	bool self;          ///< b is a link
	uint64_t blocked;   ///< edges found at or below min_d at this pair
	uint64_t undecided; ///< edges left undecided at this pair
	uint64_t states;    ///< states that were not free, of motions without an edge check: estimated from a part of them
	double clearance;   ///< metres: the least that was seen
} lw_plan_pair;

/// Growth of a search tree.
typedef struct lw_plan_tree
{
	uint64_t nodes;
	uint64_t tries, grown; ///< samples towards which the tree was to grow, and did
	double extent;         ///< Euclidean distance from an end to the farthest node of its tree
} lw_plan_tree;

/// Reasons of a search without a path; zeroed if SOLVED, or without lw_plan_def.explain.
typedef struct lw_plan_stuck
{
	lw_plan_tree trees[2]; ///< of starts, of goals
	double gap;            ///< least distance between nodes of the two trees that were seen together; they may be gone since
	uint64_t not_free;     ///< motions that were blocked or undecided, by an edge or by a state
	lw_plan_pair pairs[LW_PLAN_PAIRS]; ///< the most frequent first
	uint32_t pair_count;               ///< at most LW_PLAN_PAIRS
	/// [2][variable_count][2] proved free travel of each joint alone from the first start, then from the first goal, down and
	/// up: radians or metres until the first state that is not free, or the bound. Owned by the result; NULL if not measured.
	double* travel;
	bool enclosed[2]; ///< of these ends: free, and no travel reaches 0.01
} lw_plan_stuck;

/// The least clearance along a path: [proved for every state, measured at a state], metres, no more than the goal.
typedef struct lw_plan_range
{
	double lower, upper;
} lw_plan_range;

/// The effect of lw_plan_def.clearance_goal on one kind of pairs; zeroed without it, or if the path was not looked at.
typedef struct lw_plan_clearance
{
	lw_plan_range before, after;               ///< of the whole path
	lw_plan_range middle_before, middle_after; ///< without the first and the last tenth of its length
	double ends; ///< the clearance of the start and the goal, the smaller one: no path between them has more
} lw_plan_clearance;

/// An answer. lw_plan() fills it, whatever it returns; lw_plan_result_clear() frees its arrays.
typedef struct lw_plan_result
{
	lw_plan_outcome outcome;
	/// [state_count][variable_count] first a start, bit for bit, then straight edges to a goal. Angles that wrap go on without jumps, by
	/// at most half a turn from state to state, so the last may be whole turns away from the goal: a controller without wrap-around
	/// drives what was proved. Owned by the result; NULL = no path
	double* states;
	uint32_t state_count;    ///< 0 without a path, else at least 2
	uint32_t variable_count; ///< n of the checker
	double length;           ///< sum of Euclidean lengths of the edges, radians and metres alike
	double raw_length;       ///< before smoothing
	/// [improvement_count][2] seconds since the search for shorter paths began, and length of the best path; first the path that it
	/// began with. Owned by the result; NULL without optimize_seconds
	double* improvements;
	uint32_t improvement_count;
	lw_plan_clearance environment_clearance, self_clearance; ///< with clearance_goal
	double seconds;                                          ///< of the clock, for the whole call
	uint64_t seed; ///< of the search that found the path: with it and threads = 1 the call gives the same path
	lw_plan_statistics statistics;
	lw_plan_stuck stuck;
	char message[LW_PLAN_MESSAGE]; ///< lines in UTF-8 on an outcome without a path, always terminated; empty if SOLVED
} lw_plan_result;

/// Searches a path, and smooths it. Each edge of the path is FREE by lw_checker_edge() with def->edge: proved for
/// LW_EDGE_CERTIFIED, sampled for LW_EDGE_STEPS. Any number of threads may plan with one checker, each with its own query.
/// @return LW_OK for every outcome but UNKNOWN; LW_ERROR_INVALID_DEF; LW_ERROR_INVALID_ARGUMENT (diag names the field, joint or
/// end; diag.index is the index of the end); LW_ERROR_OUT_OF_MEMORY; or the status of a check that failed. No C++ exception
/// leaves the call.
LW_API lw_status lw_plan( const lw_plan_def* def, lw_diag* diag, lw_plan_result* out );

/// Frees the arrays and zeroes the result. A zeroed result and NULL are fine.
LW_API void lw_plan_result_clear( lw_plan_result* result );

LW_EXTERN_C_END

#endif
