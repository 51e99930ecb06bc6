// SPDX-License-Identifier: BSD-3-Clause
// Speed against accuracy on the user's own scene: what is measured, and which setting is proposed.
//
// Two words hold throughout. The *asked* range [min_d, max_d] is what the user wants to know of a clearance: at or below
// min_d a state is not valid, beyond max_d all room is the same. A *setting* may give some of that up for speed.
#pragma once

#include "setup/setup.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace leeway::cli
{

/// What must be met; the rest is then chosen for it.
struct TuneTarget
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

struct TuneMotion
{
	std::vector<double> from, to; ///< group states
	/// Metres: the least clearance along it lies in [low, high]; low is proved, high was found at a state. Nothing is looked
	/// for above the largest conservatism that is measured.
	double low = 0, high = 0;
};

/// What settings are measured on, and what is true there.
struct TuneSamples
{
	std::vector<std::vector<double>> states; ///< group states
	std::vector<double> environment, self;   ///< exact clearance of each state, metres; +inf if not asked
	std::vector<TuneMotion> motions;
	std::size_t free_states = 0, free_motions = 0; ///< clearance above the asked min_d
};

/// One setting, for states or for motions, and what it did.
struct TuneRow
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
	bool proof = true;          ///< what is called free is free
	std::size_t missed = 0;     ///< called free, but not: only without proof
	std::size_t free = 0;       ///< called free
	double work = 0;            ///< per state or motion: microseconds on the machine that unitWork() was fitted on
	double measured = 0;        ///< per state or motion: microseconds of processor time, this run
	bool front = false;         ///< no other is as cheap and as good
};

struct TuneSettings
{
	double min_d = 0, max_d = 0.5; ///< asked
	lw_what what = LW_WHAT_BOTH;
	std::size_t states = 400, motions = 100;
	std::uint64_t seed = 1;
	TuneTarget target;
};

/// What a proposal consists of: both at the same min_d.
struct TuneProposal
{
	const TuneRow* states = nullptr;
	const TuneRow* motions = nullptr;
	bool met = false; ///< the target
	double best = 0;  ///< if not: the best that some setting reaches, in the target's terms
};

/// Work that was counted since the statistics were reset, in microseconds on the machine of the fit: equal seeds give equal
/// work.
/// @param states posed and measured, @param motions begun
double unitWork( const lw_query_stats& stats, std::size_t states, std::size_t motions );

/// States and motions, and what is true of them. Equal seeds give equal samples.
/// @throws io::Error if no free state is found
TuneSamples drawSamples( const Workbench& bench, const TuneSettings& settings, const std::string& robot_file );

/// Goes through the grid. @throws io::Error if an answer breaks its promise
std::vector<TuneRow> measureGrid( const Workbench& bench, const TuneSettings& settings, const TuneSamples& samples );

/// Marks the rows that no other row of its kind is as good as in all of work, promise, proof and what stays free, and better
/// in one.
void markFront( std::vector<TuneRow>& rows );

/// A setting that is a proof and turns down no more than a tenth of what is free. @param rate microseconds per unit of work
TuneProposal propose( const std::vector<TuneRow>& rows, const TuneSamples& samples, const TuneTarget& target, double rate );

/// Measured microseconds per unit of work: exact states and default motions, each as fast as it was in several passes.
double measuredRate( const Workbench& bench, const TuneSettings& settings, const TuneSamples& samples );

/// The largest conservatism of motions that is measured, metres.
double largestConservatism( const TuneTarget& target );

} // namespace leeway::cli
