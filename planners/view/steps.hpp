// SPDX-License-Identifier: BSD-3-Clause
// Measured states along a motion, as the page plays them.
#pragma once

#include "leeway/motions/trajectory.hpp"
#include "view/apart.hpp"

#include <string>
#include <vector>

namespace leeway::view
{

using namespace motions; // states, clearances and segments

/// A state with its exact clearances.
struct ViewStep
{
	double at = 0; ///< seconds; of an untimed path the share of its length, 0 to 1; of a list the number of its state
	std::vector<double> q; ///< group state
	lw_state_result result = {};
	lw_state_result others = {};       ///< without the pairs that are set apart
	std::vector<lwv_pair> marked = {}; ///< pairs in contact that the checker allows
	std::string label;                 ///< of a list of states; else empty
};

enum class StepUnit
{
	none,    ///< one state, no motion
	seconds, ///< a trajectory
	share,   ///< a path without times
	state    ///< a list of states
};

struct ViewMotion
{
	StepUnit unit = StepUnit::none;
	std::vector<ViewStep> steps;
	std::vector<ApartPair> apart = {}; ///< pairs that keep their distance; none of a list of states
};

/// Puts all pairs back that were set apart. Motions that are compared show all of them: a pair that keeps its distance in one may come near in another.
void setNothingApart( ViewMotion& motion );

/// How states are measured.
struct Measuring
{
	const io::Problem& problem;
	lw_check_flags flags = LW_CHECK_BOTH;
	double min_d = 0;               ///< required, metres: pairs that are nearer are never set apart
	std::string file;               ///< for errors
	ProgressFunction progress = {}; ///< may be empty
};

/// States of a path at equal distances and at its corners, and more around the least clearances.
/// @param points group states, at least one @throws io::Error
ViewMotion motionOfPath( const Measuring& how, const std::vector<std::vector<double>>& points );

/// States of a trajectory at equal times and at the ends of its segments, and more around the least clearances.
ViewMotion motionOfTrajectory( const Measuring& how, const std::vector<Segment>& segments );

/// States one by one. @param labels [states] or empty
ViewMotion motionOfStates( const io::Problem& problem, const std::vector<std::vector<double>>& states,
    const std::vector<std::string>& labels, lw_check_flags flags, const std::string& file );

/// The step with the least of both clearances, without the pairs that are set apart.
std::size_t leastStep( const ViewMotion& motion );

/// The least known clearance of a state: that of Named::least().
double leastClearance( const lw_state_result& result );

} // namespace leeway::view
