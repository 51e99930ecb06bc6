// SPDX-License-Identifier: BSD-3-Clause
// The goal of a request, its names looked up in a problem.
#pragma once

#include "leeway/io/model.hpp"

#include <string>
#include <vector>

namespace leeway::ik
{

/// The frames that a constraint is about.
struct ConstraintPlaces
{
	io::Frame link, frame;
};

/// Values that a variable of the group may have.
struct Interval
{
	double lower, upper; ///< radians or metres; infinite: none
	bool wraps;          ///< equal up to whole turns
};

struct GoalParts
{
	std::vector<ConstraintPlaces> positions, orientations; ///< as in the request
	std::vector<Interval> limits;                          ///< [variables of the group] joint limits
	std::vector<Interval> joints;                          ///< the same, within the joint constraints
};

/// [variables of the group] infinite for joints without limits and for quaternions.
std::vector<Interval> jointLimits( const io::Problem& problem );

/// @throws io::Error, see findGoalStates()
GoalParts goalParts( const io::Problem& problem, const io::Request& request );

/// The file and the element of a constraint, for errors.
std::string goalFile( const io::Request& request );
std::string goalElement( const io::Request& request, const std::string& element );

} // namespace leeway::ik
