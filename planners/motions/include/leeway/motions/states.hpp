// SPDX-License-Identifier: BSD-3-Clause
// States of a group and of the whole robot, their limits, and their clearances with the names of the pairs.
//
// A group state has the values of io::Problem::variables, in their order; a full state has all variables of the robot. Radians, metres.
// All functions of leeway::motions may be called by several threads at once; each makes a query of its own unless it takes one.
#pragma once

#include "leeway/io/model.hpp"

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace leeway::motions
{

/// Values by variable name.
using Values = std::map<std::string, double>;

/// Progress of a long call: the stage of its work and its share done, 0 to 1. Some calls report from several threads, one at a time.
using ProgressFunction = std::function<void( const char* stage, double share )>;
/// Calls it unless it is empty.
inline void report( const ProgressFunction& progress, const char* stage, double share )
{
	if ( progress )
	{
		progress( stage, share );
	}
}

/// The group's part of a full state.
std::vector<double> groupState( const io::Problem& problem, const std::vector<double>& full );
/// The full state of a group state: other variables stand as in io::Problem::reference.
std::vector<double> fullState( const io::Problem& problem, const std::vector<double>& q );
/// Index of a robot variable by its name (io::variableName()), or LW_INVALID_INDEX.
std::uint32_t variableOf( const lw_robot* robot, const std::string& name );

/// Descriptions print limits with few digits (3.14159) and requests reach them with many: this much beyond a limit, radians
/// or metres, is told but does not make a state unusable.
constexpr double limit_tolerance = 1e-5;

/// One line per variable of a full state that is outside its limits: "joint elbow: 2.9 is above its limit 2.6". NaN is outside.
std::vector<std::string> limitViolations( const lw_robot* robot, const std::vector<double>& full, double tolerance = 0 );
/// The same for the variables of a group state.
std::vector<std::string> groupLimitViolations(
    const io::Problem& problem, const std::vector<double>& q, double tolerance = 0 );

/// From one value of a variable to another, as edges go: the shorter way around, for a joint that wraps.
/// @param variable of the robot
double shorterWay( const lw_robot* robot, std::uint32_t variable, double a, double b );
/// Distance of two group states, Euclidean; the shorter way for variables that wrap.
double jointDistance( const io::Problem& problem, const std::vector<double>& a, const std::vector<double>& b );
/// Points whose angles go on without wrapping: continuous joints take the shorter way from point to point.
std::vector<std::vector<double>> unwrapped( const io::Problem& problem, std::vector<std::vector<double>> points );

/// A clearance with the names of its pair; names are empty where there is no witness.
struct Named
{
	bool asked = true;
	double lower = 0, upper = 0; ///< metres
	std::string first, second;   ///< a link; a link or an object
	lw_vec3 point_a{}, point_b{};
	bool has_points = false;
	double margin = 0; ///< of this pair: its distance minus its clearance

	/// For reports: the smallest known clearance. Inside a margin the search ends at the first pair found.
	double least() const { return has_points && upper <= 0 ? upper : lower; }
	/// ", margin 0.02 m", or nothing without one.
	std::string marginText() const;
};
/// True if some pair of the checker has a margin.
bool hasMargins( const lw_checker* checker );
Named nameEnvironment( const lw_checker* checker, const lw_clearance& clearance, bool asked = true );
Named nameSelf( const lw_checker* checker, const lw_clearance& clearance, bool asked = true );

/// Measures one state. @param range null: exactly
/// @throws io::Error naming `file` and `element` if the state has no meaning (a zero quaternion, a number that is not finite)
lw_state_result measure( const lw_checker* checker, lw_query* query, const std::vector<double>& q, lw_check_flags flags,
    const lw_range* range, const std::string& file, const std::string& element );

} // namespace leeway::motions
