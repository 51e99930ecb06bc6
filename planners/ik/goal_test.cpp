// SPDX-License-Identifier: BSD-3-Clause
// Constraints of a goal, tested by the forward kinematics of the engine.
#include "ik/goal_test.hpp"

#include "ik/solver.hpp"

#include <fmt/format.h>

namespace leeway::ik
{
namespace
{

bool within( const Interval& interval, double value )
{
	if ( !interval.wraps || std::isinf( interval.upper - interval.lower ) )
	{
		return value >= interval.lower - excess_rounding && value <= interval.upper + excess_rounding;
	}
	const double middle = 0.5 * ( interval.lower + interval.upper ), half = 0.5 * ( interval.upper - interval.lower );
	return std::fabs( wrapped( value - middle ) ) <= half + excess_rounding;
}

} // namespace

GoalTest::GoalTest( const io::Problem& problem, const io::Request& request, const GoalParts& parts )
    : m_problem( problem ), m_request( request ), m_parts( parts ), m_full( problem.reference ),
      m_links( lw_robot_link_count( problem.robot.get() ) ),
      m_positions( request.goal_positions.begin(), request.goal_positions.end() ),
      m_orientations( request.goal_orientations.begin(), request.goal_orientations.end() )
{
}

void GoalTest::place( const double* q )
{
	lw_checker_full_state( m_problem.checker.get(), q, m_full.data() );
	require( lw_robot_fk( m_problem.robot.get(), m_full.data(), m_links.data() ), "kinematics of a goal state" );
}

Pose GoalTest::pose( const io::Frame& frame ) const
{
	return frame.link == LW_INVALID_INDEX ? toPose( frame.pose ) : toPose( m_links[frame.link] ) * toPose( frame.pose );
}

/// Metres of the positions, radians of the orientations.
std::pair<GoalTest::Numbers, GoalTest::Numbers> GoalTest::excesses( const double* q )
{
	place( q );
	Numbers metres, radians;
	for ( std::size_t i = 0; i < m_positions.size(); ++i )
	{
		const ConstraintPlaces& places = m_parts.positions[i];
		metres.push_back( m_positions[i].excess( pose( places.link ), pose( places.frame ) ) );
	}
	for ( std::size_t i = 0; i < m_orientations.size(); ++i )
	{
		const ConstraintPlaces& places = m_parts.orientations[i];
		radians.push_back( m_orientations[i].excess( pose( places.link ), pose( places.frame ) ) );
	}
	return { metres, radians };
}

bool GoalTest::reaches( const double* q )
{
	const auto [metres, radians] = excesses( q );
	const auto small = []( double excess ) { return excess <= excess_rounding; };
	return std::all_of( metres.begin(), metres.end(), small ) && std::all_of( radians.begin(), radians.end(), small );
}

std::vector<std::string> GoalTest::violations( const double* q )
{
	const auto [metres, radians] = excesses( q );
	std::vector<std::string> lines;
	for ( std::size_t i = 0; i < metres.size(); ++i )
	{
		if ( !( metres[i] <= excess_rounding ) )
		{
			lines.push_back(
			    fmt::format( "link {} is {:.3g} m outside of its region", m_request.goal_positions[i].link, metres[i] ) );
		}
	}
	for ( std::size_t i = 0; i < radians.size(); ++i )
	{
		if ( !( radians[i] <= excess_rounding ) )
		{
			lines.push_back( fmt::format( "link {} is {:.3g} rad beyond the tolerance of its orientation",
			    m_request.goal_orientations[i].link, radians[i] ) );
		}
	}
	for ( std::size_t i = 0; i < m_parts.joints.size(); ++i )
	{
		const Interval& limits = m_parts.limits[i];
		const Interval& joint = m_parts.joints[i];
		const bool constrained = joint.lower > limits.lower || joint.upper < limits.upper;
		if ( constrained && !within( joint, q[i] ) )
		{
			lines.push_back( fmt::format(
			    "joint {} at {} is not between {} and {}", m_problem.variable_names[i], q[i], joint.lower, joint.upper ) );
		}
	}
	return lines;
}

} // namespace leeway::ik
