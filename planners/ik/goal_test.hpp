// SPDX-License-Identifier: BSD-3-Clause
// Constraints of a goal, tested by the forward kinematics of the engine: code apart from that of the solver.
#pragma once

#include "ik/constraint.hpp"
#include "ik/goal_parts.hpp"

#include <string>
#include <utility>
#include <vector>

namespace leeway::ik
{

class GoalTest
{
public:
	/// All three must outlive it.
	GoalTest( const io::Problem& problem, const io::Request& request, const GoalParts& parts );

	/// True if a group state exceeds no position or orientation constraint.
	bool reaches( const double* q );
	/// One line per constraint that the state exceeds, joint constraints too.
	std::vector<std::string> violations( const double* q );

private:
	using Numbers = std::vector<double>;
	void place( const double* q );
	Pose pose( const io::Frame& frame ) const;
	std::pair<Numbers, Numbers> excesses( const double* q );

	const io::Problem& m_problem;
	const io::Request& m_request;
	const GoalParts& m_parts;
	Numbers m_full;
	std::vector<lw_transform> m_links;
	std::vector<PositionConstraint> m_positions;
	std::vector<OrientationConstraint> m_orientations;
};

} // namespace leeway::ik
