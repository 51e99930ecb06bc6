// SPDX-License-Identifier: BSD-3-Clause
// The planner as one of OMPL's.
//
//     leeway::ompl::install( si, checker );
//     setup.setPlanner( std::make_shared<leeway::planners::OmplPlanner>( si ) );
#pragma once

#include "leeway/ompl/validity.hpp"
#include "leeway/planners/portfolio.hpp"

#include <ompl/base/Planner.h>
#include <ompl/util/RandomNumbers.h>

#include <functional>

namespace leeway::planners
{

/// Planner under OMPL's interface: several starts and goals, goals that are sampled while it searches, approximate solutions, clear(),
/// and solve() again. Samples lie in the bounds of the space. clear() takes a new seed from OMPL's random numbers unless setSeed() gave one.
///
/// A goal that can be sampled (GoalSampleableRegion) need not be a list of states: the first sample is waited for, up to eight begin the
/// search, and more are drawn while it runs, as many as the goal gives, one whenever the work has grown by an eighth. A path ends at a
/// sample, bit for bit. Goals that cannot be sampled are UNRECOGNIZED_GOAL_TYPE. Any number of starts.
///
/// States and edges go straight to the checker; solve() adds them to Engine::counters() and Engine::undecidedPairs() at its end.
class OmplPlanner : public ::ompl::base::Planner
{
public:
	explicit OmplPlanner( const ::ompl::base::SpaceInformationPtr& si );
	~OmplPlanner() override;

	/// @throws %ompl::Exception if the motion validator is not leeway's, if the space's curves are not straight edges, or if the
	/// group has a floating joint; setup() throws the same
	::ompl::base::PlannerStatus solve( const ::ompl::base::PlannerTerminationCondition& end ) override;
	void clear() override;
	void setup() override;
	void getPlannerData(
	    ::ompl::base::PlannerData& data ) const override; ///< of the search that found the path, or of the first

	/// Longest edge that a tree grows by; 0 = geometricRange(), which setup() fills in.
	void setRange( double range );
	double getRange() const { return m_range; }
	/// Searches side by side, 1 to 64: see Portfolio. One by default.
	void setThreads( unsigned threads );
	unsigned getThreads() const { return m_threads; }
	/// Seed of the first search, in place of one from OMPL's random numbers.
	void setSeed( unsigned seed );
	unsigned getSeed() const { return m_seed; } ///< 0 before setSeed()
	/// After the first path, look for shorter ones until solve() has to end: optimize(). False by default.
	void setOptimize( bool optimize );
	bool getOptimize() const { return m_optimize; }
	/// Called about every `interval` seconds of a search, on the thread of solve(), with its first search and the seconds so far.
	void setProgress( std::function<void( const Growth& growth, double seconds )> progress, double interval = 1 );
	std::uint64_t seed() const; ///< of the search that found the path, or of the first; 0 before the first solve()
	const Statistics& statistics() const { return m_statistics; } ///< of all solve() since clear() or a new checker
	/// Planner::explain() of the last search; zeroed if there was none.
	Stuck explain() const;

private:
	class Goals;
	const leeway::ompl::Engine& engine() const;
	void makePlanner( const lw_checker* checker );
	bool addStarts();
	Outcome search( const leeway::ompl::Engine::Lease& lease, Goals& goals );
	void count( const leeway::ompl::Engine::Lease& lease );
	void addShortestPath( const leeway::ompl::Engine::Lease& lease, Goals& goals );
	void addPath( const Path& path, bool approximate, double distance );
	void freeStates();

	std::unique_ptr<Portfolio> m_planner;
	const lw_checker* m_checker = nullptr; ///< of m_planner
	Statistics m_statistics;
	std::vector<BlockingPair> m_counted; ///< pairs whose undecided edges are in the engine's counts
	double m_range = 0;
	unsigned m_threads = 1, m_seed = 0;
	bool m_seed_given = false, m_optimize = false;
	std::function<void( const Growth&, double )> m_progress;
	double m_interval = 1;                 ///< seconds
	std::vector<double> m_starts, m_goals; ///< of m_planner
	::ompl::RNG m_rng;
	mutable std::vector<::ompl::base::State*> m_states; ///< handed out by getPlannerData()
};

/// Settings with the engine's edge options and the bounds of its space.
/// @throws InputError for a space with rotations
Settings settingsOf( const leeway::ompl::Engine& engine );

/// geometricRange() of a checker in the bounds of a space that fits it.
/// @throws InputError for a space with rotations
double geometricRange( const leeway::ompl::Engine& engine );

} // namespace leeway::planners
