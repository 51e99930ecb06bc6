// SPDX-License-Identifier: BSD-3-Clause
// Results of ways on sets of problems: table, JSON.
#pragma once

#include "planning/ways.hpp"
#include "support/race.hpp"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

/// One run of a way on a problem.
struct PlanRun
{
	std::size_t problem = 0;                                 ///< equal numbers are equal problems, in all ways
	bool solved = false, in_contact = false, direct = false; ///< direct: one straight edge
	double plan_us = 0, simplify_us = 0, first_length = 0, length = 0;
};

/// Runs of one way on one set of problems.
struct Tally
{
	std::vector<PlanRun> runs;
	std::size_t asked = 0, accepted = 0;      ///< problems, and those with no end that the way refuses
	std::size_t problems = 0, refused = 0;    ///< of those that were planned; runs of a refused one are not solved
	std::vector<std::string> unsolved;        ///< names of problems with a run that was not solved
	std::uint64_t hash = 0xcbf29ce484222325u; ///< of all states of all paths, FNV-1a over their bytes

	void addPath( const States& path );
	void add( const Tally& other );
	std::size_t solved() const;
	std::size_t inContact() const;
	/// False if all problems were refused, such as those of a robot that a module does not know: no row then.
	bool hasPart() const { return !runs.empty() && refused < problems; }
	/// Of solved runs.
	std::vector<double> column( double PlanRun::*member ) const;
	/// Planning and simplification together.
	std::vector<double> both() const;
};

/// Geometric mean over the problems that both solved of the ratio of their medians; 0 without such a problem.
/// @param with_simplification planning and simplification together, else planning alone
double pairedRatio( const Tally& tally, const Tally& reference, bool with_simplification );

/// Tallies of all ways on one set.
struct SetResult
{
	std::string name;
	std::vector<Tally> tallies; ///< as the ways
};

/// Ways that others are compared with: the first one, and each module.
std::vector<std::size_t> referencesOf( const std::vector<WayKind>& ways );

void printHeader( const std::vector<WayKind>& ways );
void print( const SetResult& result, const std::vector<WayKind>& ways );
/// A row for each way. @param spread with all planning times, for results of a whole robot
Json toJson( const SetResult& result, const std::vector<WayKind>& ways, bool spread );
