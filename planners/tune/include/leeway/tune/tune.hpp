// SPDX-License-Identifier: BSD-3-Clause
// Speed against accuracy on the user's own scene: measurement, and proposal of a setting.
//
// Two terms. The *asked* range [min_d, max_d] is the range of clearances that the user wants to distinguish: at or below
// min_d a state is not valid, beyond max_d clearances count as equal. A *setting* may give some of that up for speed.
#pragma once

#include "leeway/motions/states.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace leeway::tune
{

/// The target of the proposal.
struct Target
{
	enum Kind
	{
		NONE,
		TIME,        ///< microseconds for a state
		ERROR,       ///< metres, of a state's clearance
		CONSERVATISM ///< metres, of motions
	};
	Kind kind = NONE;
	double value = 0;
};

struct Motion
{
	std::vector<double> from, to; ///< group states
	/// Metres: the least clearance along it lies in [low, high]; low is proved, high was found at a state. Nothing is looked
	/// for above the largest conservatism that is measured.
	double low = 0, high = 0;
};

/// Samples of states and motions, with their true clearances.
struct Samples
{
	std::vector<std::vector<double>> states; ///< group states
	std::vector<double> environment, self;   ///< exact clearance of each state, metres; +inf if not asked
	std::vector<Motion> motions;
	std::size_t free_states = 0, free_motions = 0; ///< clearance above the asked min_d
};

/// One setting, for states or for motions, with its results.
struct Row
{
	// the setting
	bool motion = false;
	double min_d = 0;
	double max_d = 0; ///< states: beyond it no distance; steps: motion between two of them
	double alpha = 0;
	double slack = 0; ///< certified motions
	lw_edge_method method = LW_EDGE_CERTIFIED;

	/// States: metres by which a reported clearance may lie below the true one, both taken into the asked range. Motions:
	/// metres above the asked min_d up to which a motion may be turned down that is free.
	double promised = 0;
	double worst = 0, mean = 0; ///< of that, seen. Motions: mean over those turned down
	bool proof = true;          ///< every FREE is a proof
	std::size_t missed = 0;     ///< called free, but not: only without proof
	std::size_t free = 0;       ///< called free
	double work = 0;            ///< per state or motion: microseconds on the machine that unitWork() was fitted on
	double measured = 0;        ///< per state or motion: microseconds of processor time, this run
	bool front = false;         ///< no other is as cheap and as good
};

struct Settings
{
	double min_d = 0, max_d = 0.5; ///< asked
	lw_check_flags flags = LW_CHECK_BOTH;
	std::size_t states = 400, motions = 100;
	std::uint64_t seed = 1;
	Target target;
	double rate = 0;                    ///< microseconds per unit of work on this machine; 0: measured
	motions::ProgressFunction progress; ///< may be empty
};

/// A proposal: settings for states and for motions, both at the same min_d.
struct Proposal
{
	const Row* states = nullptr;
	const Row* motions = nullptr;
	bool met = false; ///< the target
	double best = 0;  ///< if not: the best that some setting reaches, in the target's terms
};

/// Work that was counted since the statistics were reset, in microseconds on the machine of the fit: equal seeds give equal
/// work.
/// @param states posed and measured, @param motions begun
double unitWork( const lw_query_stats& stats, std::size_t states, std::size_t motions );

/// Draws states and motions and measures their true clearances. Equal seeds give equal samples.
/// @throws io::Error if no free state is found
Samples drawSamples( const io::Problem& problem, const Settings& settings, const std::string& robot_file );

/// Goes through the grid. @throws io::Error if an answer breaks its promise
std::vector<Row> measureGrid( const io::Problem& problem, const Settings& settings, const Samples& samples );

/// Marks the rows of the Pareto front of each kind: no other row is as good in work, promise, proof and free share, and
/// better in one of them.
void markFront( std::vector<Row>& rows );

/// Proposes settings with proofs that refuse at most a tenth of the free states and motions. @param rate microseconds per
/// unit of work
Proposal propose( const std::vector<Row>& rows, const Samples& samples, const Target& target, double rate );

/// Measured microseconds per unit of work: exact states and default motions, each as fast as it was in several passes.
double measuredRate( const io::Problem& problem, const Settings& settings, const Samples& samples );

/// All of it.
struct Tuning
{
	Samples samples;
	std::vector<Row> rows; ///< the first: exact states
	double rate = 0;       ///< microseconds per unit of work: as given, else measured, to two digits
	Proposal proposal;     ///< points into `rows`
	Tuning() = default;
	Tuning( Tuning&& ) = default;
	Tuning& operator=( Tuning&& ) = default;
};
/// Samples, measures and proposes, on one thread. Equal seeds and rates give equal results, apart from Row::measured.
/// @param robot_file for errors @throws io::Error
/// Cost: each setting of the grid, some 180, answers for all states or motions.
Tuning tune( const io::Problem& problem, const Settings& settings, const std::string& robot_file );

/// Lines for people: the Pareto fronts, and the proposal.
std::string describeFronts( const Tuning& tuning );
std::string describe( const Tuning& tuning, const Settings& settings );
/// All rows: kind,min_d,max_d,alpha,validator,slack,proof,promised,worst,mean,free,missed,work,time_us,measured_us,front,proposed
std::string rowsCsv( const Tuning& tuning );

/// The largest conservatism of motions that is measured, metres.
double largestConservatism( const Target& target );

} // namespace leeway::tune
