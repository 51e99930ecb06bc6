// SPDX-License-Identifier: BSD-3-Clause
// A module of leeway-bench planning that goes from start to goal in one straight edge.
#include "planning/planner_module.hpp"

namespace
{

class Straight : public PlannerModule
{
public:
	std::string name() const override { return "straight"; }
	std::string description() const override { return "one edge, not checked"; }
	std::string take( const PlannerProblem& problem ) override
	{
		m_problem = problem;
		return problem.start.size() == problem.joints.size() ? "" : "no start";
	}
	PlannerAnswer plan() override
	{
		PlannerAnswer answer;
		answer.solved = true;
		answer.first = m_problem.start;
		answer.first.insert( answer.first.end(), m_problem.goal.begin(), m_problem.goal.end() );
		answer.path = answer.first;
		return answer;
	}

private:
	PlannerProblem m_problem;
};

} // namespace

extern "C" PlannerModule* leeway_planner_module()
{
	return new Straight;
}
