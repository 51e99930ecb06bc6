// SPDX-License-Identifier: BSD-3-Clause
// Descents with joints at their limits left out; free joints drift within the null space (Liégeois 1977).
#include "lines/follower.hpp"

#include <algorithm>
#include <cmath>

namespace leeway::lines
{
namespace
{

using Eigen::Vector3d;

constexpr double least_damping = 1e-14;
constexpr double near_limit = 0.12; // share of a joint's range
constexpr double last_way = 0.05;   // fraction of a way before whose end joints that arrive slow down

Vector3d toVector( const lw_vec3& v )
{
	return { v.x, v.y, v.z };
}

std::optional<Vector3d> freeAxis( const Task& task )
{
	return task.free_axis ? std::optional<Vector3d>( toVector( *task.free_axis ).normalized() ) : std::nullopt;
}

} // namespace

Follower::Follower( const io::RobotModel& robot, const io::Problem& problem, const Task& task )
    : m_chain( robot, problem ), m_errors( m_chain, task.tip, task.base, freeAxis( task ) ),
      m_descent( m_chain, m_errors.moving(), ik::PoseErrors::rows )
{
	const auto count = static_cast<Eigen::Index>( problem.variables.size() );
	bool moves = false;
	for ( std::size_t i = 0; i < m_chain.freedoms().size(); ++i )
	{
		moves = moves || m_errors.moving()[i];
		if ( m_chain.freedoms()[i].turn >= 0 )
		{
			throw io::Error( robot.urdf_file, "group " + problem.group,
			    "has a floating joint, whose turns no trajectory has", "choose a group without it" );
		}
	}
	if ( !moves )
	{
		throw io::Error( robot.urdf_file, "group " + problem.group, "does not move the frame of the line",
		    "choose the group of its arm, or another link" );
	}
	m_bounds.lower.resize( count );
	m_bounds.upper.resize( count );
	for ( Eigen::Index i = 0; i < count; ++i )
	{
		const lw_variable_info info =
		    lw_robot_variable( problem.robot.get(), problem.variables[static_cast<std::size_t>( i )] );
		m_bounds.lower[i] = info.wraps ? -HUGE_VAL : info.lower;
		m_bounds.upper[i] = info.wraps ? HUGE_VAL : info.upper;
	}
}

lw_transform Follower::pose( const State& q )
{
	return ik::toTransform( m_errors.pose( q.data() ) );
}

bool Follower::correct( const ik::Pose& reference, State& q )
{
	m_errors.aim( reference );
	if ( m_descent.run( m_errors, m_bounds, q.data() ) )
	{
		return true;
	}
	const std::vector<char>& fixed = m_descent.fixed();
	const auto at_limit = std::find_if( fixed.begin(), fixed.end(), []( char is ) { return is != 0; } );
	Eigen::Index most;
	m_descent.lastStep().cwiseAbs().maxCoeff( &most );
	m_blame = at_limit != fixed.end() ? Blame{ Obstacle::JOINT_LIMIT, static_cast<std::size_t>( at_limit - fixed.begin() ) }
	                                  : Blame{ Obstacle::SINGULARITY, static_cast<std::size_t>( most ) };
	return false;
}

State Follower::rate( const ik::Pose& reference, const Leg::Motion& motion, const State& q, const State& hint )
{
	m_errors.aim( reference );
	m_descent.evaluate( m_errors, q.data() );
	const Eigen::VectorXd flow = m_errors.flow( motion.linear, motion.angular );
	const State rate = hint + m_descent.leastChange( -flow - m_descent.jacobian() * hint, least_damping );
	Eigen::Index most;
	rate.cwiseAbs().maxCoeff( &most );
	m_blame = { Obstacle::SINGULARITY, static_cast<std::size_t>( most ) };
	return rate;
}

State Follower::drift( const State& q, const Wish& wish, double fraction ) const
{
	State drift = State::Zero( q.size() );
	if ( wish.arrives )
	{
		return ( wish.posture - q ) / std::max( 1 - fraction, last_way );
	}
	for ( Eigen::Index i = 0; i < q.size(); ++i )
	{
		if ( wish.strength > 0 )
		{
			drift[i] = std::clamp( wish.strength * ( wish.posture[i] - q[i] ), -1.0, 1.0 );
		}
		const double range = m_bounds.upper[i] - m_bounds.lower[i];
		if ( range < 100 && range > 0 )
		{
			const double below = ( q[i] - m_bounds.lower[i] ) / range, above = ( m_bounds.upper[i] - q[i] ) / range;
			drift[i] += below < near_limit ? 1 - below / near_limit : 0;
			drift[i] -= above < near_limit ? 1 - above / near_limit : 0;
		}
	}
	return drift;
}

} // namespace leeway::lines
