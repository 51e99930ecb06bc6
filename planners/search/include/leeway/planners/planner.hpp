// SPDX-License-Identifier: BSD-3-Clause
// A planner for joint space: two trees that grow towards each other; lw_checker_edge() validates every motion.
//
//     leeway::planners::Planner planner( checker, {} );
//     planner.addStart( start );
//     planner.addGoal( goal );
//     if ( planner.solve( query ) == leeway::planners::Outcome::SOLVED ) { use( planner.path() ); }
//
// Papers: Kuffner and LaValle, RRT-Connect (ICRA 2000); balanced trees, steps from the new node and the order of work after VAMP
// (Thomason, Kingston, Kavraki, ICRA 2024).
#pragma once

#include "leeway/handles.hpp"
#include "leeway/planners/stuck.hpp"

#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace leeway::planners
{

/// A setting or a state that cannot be used; the message names it and a remedy.
struct InputError : std::invalid_argument
{
	using std::invalid_argument::invalid_argument;
};

/// Order of the samples. Both orders depend on the seed only.
enum class Samples
{
	HALTON, ///< Halton points, shifted by the seed
	RANDOM  ///< xoshiro256**
};

/// A path: states one after another in one array, joined by straight edges (lw_robot_interpolate()).
struct Path
{
	std::size_t dimension = 0;  ///< entries of a state
	std::vector<double> values; ///< [count() * dimension], metres and radians
	std::size_t count() const { return dimension == 0 ? 0 : values.size() / dimension; }
	const double* operator[]( std::size_t i ) const { return values.data() + i * dimension; }
	double* operator[]( std::size_t i ) { return values.data() + i * dimension; }
};

struct Settings
{
	/// How edges are validated: method, margin, slack, clearances (leeway/checker.h). LW_EDGE_CERTIFIED proves each edge of a path;
	/// LW_EDGE_STEPS only samples it.
	lw_edge_def edge = lw_edge_def_default();
	/// Longest edge that a tree grows by, in the metric of Planner::distance(), > 0; 0 = geometricRange().
	double range = 0;
	std::uint64_t seed = 1;
	Samples samples = Samples::RANDOM;
	/// Samples lie within this many ranges of a random node of the tree that grows, and within 3/4 of the bounds' diagonal; 0 =
	/// anywhere in the bounds. In narrow places far samples ask for the same few blocked directions again and again. Half of the
	/// first 64 samples lie anywhere: they solve easy problems.
	double sample_radius = 6.5;
	std::size_t most_nodes = 1 << 20; ///< of both trees; solve() ends with NODES_FULL
	/// Bounds of the samples and of all ends, one per variable; empty = joint limits. Entries of variables that wrap are not used.
	std::vector<double> lower, upper;
};

/// @throws InputError for settings out of their domain
void requireUsable( const Settings& settings );

/// When a search or a smoothing ends. Looked at between two edges; an edge takes microseconds, seldom milliseconds.
struct Stop
{
	double seconds = HUGE_VAL;                 ///< of the clock, from the call; NaN and negative values end it at once
	const std::atomic<bool>* cancel = nullptr; ///< any thread may set it
	bool ( *poll )( void* user ) = nullptr;    ///< true = end; called every few edges on the thread of the search
	void* user = nullptr;
};

enum class Outcome
{
	SOLVED,
	TIMED_OUT,  ///< Stop::seconds are over; no statement on whether a path exists
	CANCELLED,  ///< Stop::cancel or Stop::poll
	NODES_FULL, ///< Settings::most_nodes
	NO_START,   ///< no start is proved free: see Planner::endProblem()
	NO_GOAL,    ///< no goal is proved free: see Planner::endProblem()
	FAILED      ///< the checker returned an error: see Planner::failure()
};
const char* name( Outcome outcome );

/// Work since construction or clear().
struct Statistics
{
	std::uint64_t samples = 0, states = 0, states_free = 0;
	std::uint64_t lane_states = 0; ///< states checked in the lanes of vectors: lw_checker_states()
	std::uint64_t edges = 0, free = 0, blocked = 0, undecided = 0; ///< edges = free + blocked + undecided + errors
	std::uint64_t edge_queries = 0;                                ///< states at which edges measured distances
	std::uint64_t start_nodes = 0, goal_nodes = 0;
	std::uint64_t passed_over =
	    0; ///< states near the scene that lanes left undecided, dropped because few like them were free

	/// Adds all counts.
	Statistics& operator+=( const Statistics& more );
	/// Work since an earlier moment of the same search. Nodes may have become fewer: their differences then wrap.
	Statistics since( const Statistics& before ) const;
};

/// Progress of a search, for display.
struct Growth
{
	std::size_t start_nodes = 0, goal_nodes = 0; ///< may fall: an edge that is not FREE is removed with all nodes behind it
	double gap =
	    HUGE_VAL; ///< least distance of a start node and a goal node that the search compared; both may be removed since
};

/// Length of the longest edge that suits the robot, in the metric of Planner::distance(): a motion of this length in a random
/// direction moves the fastest point of the moving links by about half of the group's reach. Depends on the robot only.
/// @param lower, upper [variable count] finite bounds
double geometricRange( const lw_checker* checker, const double* lower, const double* upper );

/// Bidirectional search. The smaller tree grows by one edge towards a sample; from the new node steps of equal length go towards
/// the nearest node of the other tree until one fails. A straight edge from each start to each goal comes first. The end of a new
/// edge and states inside of it are checked at once; the edge is proved when the tree has grown four edges beyond it or a path passes
/// through it. An edge that is not FREE is removed with all nodes behind it.
///
/// Deterministic: equal checker, settings, ends and calls give equal paths, unless Stop ends the search. One thread per planner.
/// Memory: 12 dimension + 9 bytes per node, doubled when full; nothing else is allocated during a search.
class Planner
{
public:
	/// @throws InputError for settings out of their domain, a group without variables, a variable without finite bounds, or a floating
	/// joint in the group
	Planner( Checker checker, const Settings& settings );
	~Planner();
	Planner( Planner&& ) noexcept;
	Planner& operator=( Planner&& ) noexcept;

	/// Adds an end. It is checked by the next solve(); solve() with no free one ends with NO_START or NO_GOAL.
	/// @param q [dimension()] within the bounds
	/// @throws InputError for a value that is not finite, or outside of the bounds by more than 1e-5
	void addStart( const double* q );
	void addGoal( const double* q );

	/// Searches on where the last call stopped. After SOLVED it returns SOLVED and the same path at once.
	/// @param query made for the checker; its warm starts are dropped, so that equal seeds give equal paths
	Outcome solve( lw_query* query, const Stop& stop = {} );

	/// After SOLVED: from a start to a goal, each edge FREE. Otherwise empty.
	/// Angles that wrap are in [-pi, pi]: unwrap() makes a path that a controller may drive.
	const Path& path() const;
	/// From a start to the node of its tree that is nearest to a goal of those with a proved way, each edge FREE; empty if no
	/// start is free.
	/// @param distance of its last state to that goal
	Path approximatePath( double* distance ) const;

	/// Pairs at which edges ended that were not FREE, in the order of their first time; of blocked states there is no count.
	const std::vector<BlockingPair>& blockingPairs() const;
	/// After an outcome without a path: the reasons, measured now, in up to a second. It changes nothing of the search.
	/// @param query as for solve()
	Stuck explain( lw_query* query, const Stop& stop = {} ) const;

	void clear(); ///< forgets ends, trees and path
	const Statistics& statistics() const;
	Growth growth() const; ///< of now; from Stop::poll, too
	double range() const;  ///< in use
	std::size_t dimension() const;
	/// Euclidean, radians and metres alike; the shorter way for variables that wrap.
	double distance( const double* a, const double* b ) const;
	const std::string& endProblem() const; ///< after NO_START and NO_GOAL: a sentence on the last end that cannot be used
	lw_status failure() const;             ///< after FAILED

	/// States of a tree for display: the start tree, then the goal tree. Edges are not all proved: see Planner.
	/// @param visit called for each node; parent = its index, or LW_INVALID_INDEX for ends
	void visitNodes( void ( *visit )( void* user, bool of_goal, std::uint32_t parent, const double* q ), void* user ) const;

private:
	struct Parts;
	std::unique_ptr<Parts> m_parts;
};

} // namespace leeway::planners
