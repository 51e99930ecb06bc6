// SPDX-License-Identifier: BSD-3-Clause
// Damped Newton steps (Levenberg 1944; Wampler 1986) with joints at their limits left out; free joints drift within the null space (Liégeois 1977).
#include "lines/follower.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>

namespace leeway::lines
{
namespace
{

using Eigen::Vector3d;

constexpr int most_steps = 30;
constexpr double solved_error = 1e-11; // metres; a radian counts as turn_length
constexpr double turn_length = 0.2;    // metres that count as much as a radian
constexpr double step_damping = 1e-9;  // of a step that has to be right
constexpr double least_damping = 1e-14;
constexpr double longest_step = 0.5; // radians or metres of one joint
constexpr double near_limit = 0.12;  // share of a joint's range

Vector3d toVector( const lw_vec3& v )
{
	return { v.x, v.y, v.z };
}

/// Two unit directions across a third.
Eigen::Matrix<double, 2, 3> across( const Vector3d& axis )
{
	Eigen::Matrix<double, 2, 3> rows;
	rows.row( 0 ) = axis.unitOrthogonal();
	rows.row( 1 ) = axis.cross( rows.row( 0 ).transpose() );
	return rows;
}

} // namespace

Follower::Follower( const io::RobotModel& robot, const io::Problem& problem, const Task& task )
    : m_chain( robot, problem ), m_tip( m_chain.add( task.tip ) ), m_base( m_chain.add( task.base ) )
{
	const auto count = static_cast<Eigen::Index>( problem.variables.size() );
	bool moves = false;
	for ( std::size_t i = 0; i < m_chain.freedoms().size(); ++i )
	{
		moves = moves || m_chain.moves( i );
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
	m_lower.resize( count );
	m_upper.resize( count );
	for ( Eigen::Index i = 0; i < count; ++i )
	{
		const lw_variable_info info =
		    lw_robot_variable( problem.robot.get(), problem.variables[static_cast<std::size_t>( i )] );
		m_lower[i] = info.wraps ? -HUGE_VAL : info.lower;
		m_upper[i] = info.wraps ? HUGE_VAL : info.upper;
	}
	m_free = task.free_axis.has_value();
	m_axis = m_free ? toVector( *task.free_axis ).normalized() : Vector3d::UnitZ();
	const Eigen::Index rows = m_free ? 5 : 6;
	m_linear.resize( 3, count );
	m_angular.resize( 3, count );
	m_jacobian.resize( rows, count );
	m_active.resize( rows, count );
	m_error.resize( rows );
	m_flow.resize( rows );
}

lw_transform Follower::pose( const State& q )
{
	m_chain.place( q.data() );
	const ik::Pose tip = ik::inverse( m_chain.pose( m_base ) ) * m_chain.pose( m_tip );
	lw_transform out;
	for ( int i = 0; i < 3; ++i )
	{
		for ( int k = 0; k < 3; ++k )
		{
			out.r[i][k] = tip.r( i, k );
		}
		out.t[i] = tip.t[i];
	}
	return out;
}

/// Errors, the reference's flow and the Jacobian, all in the base.
void Follower::place( const lw_region_def& def, double fraction, const State& q )
{
	m_chain.place( q.data() );
	const ik::Pose base = m_chain.pose( m_base ), tip = ik::inverse( base ) * m_chain.pose( m_tip );
	const ik::Pose wanted = ik::toPose( lw_region_reference( &def, fraction ) );
	m_linear.setZero();
	m_angular.setZero();
	const Vector3d point = m_chain.pose( m_tip ).t;
	m_chain.addJacobian( m_tip, point, 1, m_linear, m_angular );
	m_chain.addJacobian( m_base, point, -1, m_linear, m_angular );
	const Vector3d arm = wanted.t - fraction * toVector( def.shift ) - toVector( def.center );
	m_error.head<3>() = wanted.t - tip.t;
	m_flow.head<3>() = toVector( def.shift ) + toVector( def.arc ).cross( arm );
	m_jacobian.topRows<3>().noalias() = base.r.transpose() * m_linear;
	if ( !m_free )
	{
		m_error.tail<3>() = turn_length * ik::logarithm( wanted.r * tip.r.transpose() );
		m_flow.tail<3>() = turn_length * toVector( def.turn );
		m_jacobian.bottomRows<3>().noalias() = turn_length * base.r.transpose() * m_angular;
		return;
	}
	const Vector3d is = tip.r * m_axis, should = wanted.r * m_axis, turn = is.cross( should );
	const double angle = std::atan2( turn.norm(), is.dot( should ) );
	const Eigen::Matrix<double, 2, 3> rows = turn_length * across( should );
	m_error.tail<2>() = rows * ( turn.norm() > 0 ? Vector3d( angle / turn.norm() * turn ) : turn );
	m_flow.tail<2>() = rows * toVector( def.turn );
	m_jacobian.bottomRows<2>().noalias() = rows * base.r.transpose() * m_angular;
}

/// The smallest change of the joints that makes this change of the pose, those that are fixed left out.
State Follower::solved( const Eigen::VectorXd& wanted, const std::vector<bool>& fixed, double damping )
{
	m_active = m_jacobian;
	for ( std::size_t i = 0; i < fixed.size(); ++i )
	{
		if ( fixed[i] )
		{
			m_active.col( static_cast<Eigen::Index>( i ) ).setZero();
		}
	}
	Eigen::MatrixXd normal = m_active * m_active.transpose();
	normal.diagonal().array() += damping;
	return m_active.transpose() * normal.ldlt().solve( wanted );
}

bool Follower::correct( const lw_region_def& def, double fraction, State& q )
{
	std::vector<bool> fixed( variables() );
	double before = HUGE_VAL;
	for ( int step = 0; step < most_steps; ++step )
	{
		place( def, fraction, q );
		const double error = m_error.norm();
		if ( error < solved_error )
		{
			return true;
		}
		std::fill( fixed.begin(), fixed.end(), false );
		const double damping = error > before ? 1e-4 : least_damping + step_damping * error * error;
		State change;
		bool again = true;
		for ( std::size_t round = 0; again && round <= fixed.size(); ++round )
		{
			again = false;
			change = solved( m_error, fixed, damping );
			for ( Eigen::Index i = 0; i < q.size(); ++i )
			{
				const bool out = ( change[i] < 0 && q[i] <= m_lower[i] ) || ( change[i] > 0 && q[i] >= m_upper[i] );
				if ( out && !fixed[static_cast<std::size_t>( i )] )
				{
					fixed[static_cast<std::size_t>( i )] = again = true;
				}
			}
		}
		const double largest = change.cwiseAbs().maxCoeff();
		Eigen::Index most;
		change.cwiseAbs().maxCoeff( &most );
		const auto at_limit = std::find( fixed.begin(), fixed.end(), true );
		m_blame = at_limit != fixed.end()
		              ? Blame{ Obstacle::JOINT_LIMIT, static_cast<std::size_t>( at_limit - fixed.begin() ) }
		              : Blame{ Obstacle::SINGULARITY, static_cast<std::size_t>( most ) };
		q += largest > longest_step ? State( longest_step / largest * change ) : change;
		q = q.cwiseMax( m_lower ).cwiseMin( m_upper );
		before = error;
	}
	return false;
}

State Follower::rate( const lw_region_def& def, double fraction, const State& q, const State& hint )
{
	place( def, fraction, q );
	const std::vector<bool> none( variables(), false );
	const Eigen::VectorXd rest = m_flow - m_jacobian * hint;
	const State rate = hint + solved( rest, none, least_damping );
	Eigen::Index most;
	rate.cwiseAbs().maxCoeff( &most );
	m_blame = { Obstacle::SINGULARITY, static_cast<std::size_t>( most ) };
	return rate;
}

State Follower::drift( const State& q, const Wish& wish ) const
{
	State drift = State::Zero( q.size() );
	for ( Eigen::Index i = 0; i < q.size(); ++i )
	{
		if ( wish.strength > 0 )
		{
			drift[i] = std::clamp( wish.strength * ( wish.posture[i] - q[i] ), -1.0, 1.0 );
		}
		const double range = m_upper[i] - m_lower[i];
		if ( range < 100 && range > 0 )
		{
			const double below = ( q[i] - m_lower[i] ) / range, above = ( m_upper[i] - q[i] ) / range;
			drift[i] += below < near_limit ? 1 - below / near_limit : 0;
			drift[i] -= above < near_limit ? 1 - above / near_limit : 0;
		}
	}
	return drift;
}

} // namespace leeway::lines
