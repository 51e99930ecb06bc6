// SPDX-License-Identifier: BSD-3-Clause
// Goals that keep the constraints along the path: one inverse kinematics for both, whose constraints along the path are made narrower.
#include "leeway/manifold/plan.hpp"

#include "leeway/ik/goal_states.hpp"

namespace leeway::manifold
{
namespace
{

constexpr double inner_share = 0.8; // of tolerances along the path: a goal at their limit cannot be proved

io::Request withConstraints( const io::Request& request, const io::PathConstraints& path )
{
	io::Request both = request;
	for ( const io::JointGoal& goal : path.joints )
	{
		const double cut = 0.5 * ( 1 - inner_share ) * ( goal.tolerance_below + goal.tolerance_above );
		both.goal.push_back( { goal.joint, goal.position, goal.tolerance_above - cut, goal.tolerance_below - cut } );
	}
	for ( io::PositionGoal goal : path.positions )
	{
		for ( io::GoalRegion& region : goal.regions )
		{
			for ( double& size : region.size )
			{
				size *= inner_share;
			}
		}
		both.goal_positions.push_back( goal );
	}
	for ( io::OrientationGoal goal : path.orientations )
	{
		for ( double& tolerance : goal.tolerance )
		{
			tolerance *= tolerance < M_PI ? inner_share : 1;
		}
		both.goal_orientations.push_back( goal );
	}
	return both;
}

} // namespace

std::vector<std::vector<double>> constrainedGoals( const io::RobotModel& robot, const io::Problem& problem,
    const io::Request& request, const io::PathConstraints& path, const lw_edge_def& edge, std::uint64_t seed,
    std::size_t most )
{
	Manifold manifold( robot, problem, path ); // constraints that leave no room are named before any search
	const std::vector<double> goal = request.hasPoseGoal() ? std::vector<double>() : io::goalState( problem, request );
	const std::vector<std::string> broken = goal.empty() ? std::vector<std::string>() : manifold.violations( goal.data() );
	if ( !goal.empty() && broken.empty() )
	{
		return { goal };
	}
	ik::Options options;
	options.seed = seed;
	options.states = most;
	options.min_d = edge.min_d;
	options.flags = edge.flags;
	const io::Request both = withConstraints( request, path );
	const ik::GoalStates found = ik::findGoalStates( robot, problem, both, options );
	if ( !found.states.empty() )
	{
		return found.states;
	}
	const std::string problem_text =
	    broken.empty() ? found.problem : "the goal breaks the constraints along the path: " + broken.front();
	throw io::Error( request.goal_file.empty() ? request.file : request.goal_file,
	    request.goal_element + ( path.empty() ? "" : " with path_constraints" ), problem_text,
	    request.hasPoseGoal() ? found.remedy : "choose another goal, or widen path_constraints" );
}

} // namespace leeway::manifold
