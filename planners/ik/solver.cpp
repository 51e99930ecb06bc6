// SPDX-License-Identifier: BSD-3-Clause
// States of a group that satisfy constraints, found by damped least squares within bounds.
#include "ik/solver.hpp"

#include <Eigen/Cholesky>

namespace leeway::ik
{
namespace
{

constexpr int most_steps = 80;
constexpr double longest_step = 1;     // radians or metres of one freedom
constexpr double solved_cost = 1e-24;  // squared metres: errors of 1e-12
constexpr double stalled_share = 1e-3; // a step that gains a smaller share of the cost is a poor one
constexpr int most_poor_steps = 6;
constexpr double first_damping = 1, least_damping = 1e-6, most_damping = 1e9;
constexpr double damping_floor = 1e-14;

} // namespace

double Excess::sum() const
{
	return metres + radian_length * radians;
}

Solver::Solver( Chain& chain, BoundGoal& goal ) : m_chain( chain ), m_goal( goal )
{
	const auto freedoms = static_cast<Eigen::Index>( chain.freedoms().size() );
	const auto rows = static_cast<Eigen::Index>( 3 * ( goal.positions.size() + goal.orientations.size() ) );
	m_residual.resize( rows );
	m_jacobian.resize( rows, freedoms );
	m_active.resize( rows, freedoms );
	m_normal.resize( rows, rows );
	m_gradient.resize( rows );
	m_step.resize( freedoms );
	m_linear.resize( 3, freedoms );
	m_angular.resize( 3, freedoms );
	m_fixed.resize( chain.freedoms().size() );
	m_variables = 0;
	for ( const Freedom& freedom : chain.freedoms() )
	{
		m_variables = std::max<std::size_t>( m_variables, freedom.variable + ( freedom.turn < 0 ? 1 : 4 ) );
	}
	m_try.resize( m_variables );
}

void Solver::draw( Random& random, double share, double* q ) const
{
	const std::vector<Freedom>& freedoms = m_chain.freedoms();
	for ( std::size_t i = 0; i < freedoms.size(); ++i )
	{
		const auto k = static_cast<Eigen::Index>( i );
		if ( freedoms[i].turn < 0 )
		{
			double& value = q[freedoms[i].variable];
			value += share * ( random.between( m_goal.draw_lower[k], m_goal.draw_upper[k] ) - value );
		}
		else if ( freedoms[i].turn == 0 && share == 1 &&
		          m_chain.moves( i ) ) // uniform rotations (Shoemake, Graphics Gems III, 1992)
		{
			const double u = random.unit(), a = random.between( 0, 2 * pi ), b = random.between( 0, 2 * pi );
			double* const r = q + freedoms[i].variable;
			r[0] = std::sqrt( 1 - u ) * std::sin( a );
			r[1] = std::sqrt( 1 - u ) * std::cos( a );
			r[2] = std::sqrt( u ) * std::sin( b );
			r[3] = std::sqrt( u ) * std::cos( b );
		}
	}
}

void Solver::clamp( double* q ) const
{
	const std::vector<Freedom>& freedoms = m_chain.freedoms();
	for ( std::size_t i = 0; i < freedoms.size(); ++i )
	{
		const auto k = static_cast<Eigen::Index>( i );
		if ( freedoms[i].turn < 0 )
		{
			double& value = q[freedoms[i].variable];
			value = std::clamp( value, m_goal.lower[k], m_goal.upper[k] );
		}
	}
}

Excess Solver::excess( const double* q )
{
	m_chain.place( q );
	Excess excess;
	for ( std::size_t i = 0; i < m_goal.positions.size(); ++i )
	{
		const auto& bound = m_goal.positions[i];
		const double metres = bound.constraint.excess( m_chain.pose( bound.link ), m_chain.pose( bound.frame ) );
		if ( metres > excess.metres )
		{
			excess.metres = metres;
			excess.position = i;
		}
	}
	for ( std::size_t i = 0; i < m_goal.orientations.size(); ++i )
	{
		const auto& bound = m_goal.orientations[i];
		const double radians = bound.constraint.excess( m_chain.pose( bound.link ), m_chain.pose( bound.frame ) );
		if ( radians > excess.radians )
		{
			excess.radians = radians;
			excess.orientation = i;
		}
	}
	return excess;
}

bool Solver::solve( Random& random, double* q )
{
	bool tight = true;
	for ( auto& bound : m_goal.positions )
	{
		bound.constraint.draw( random );
		tight = tight && bound.constraint.isTight();
	}
	for ( auto& bound : m_goal.orientations )
	{
		bound.constraint.draw( random );
		tight = tight && bound.constraint.isTight();
	}
	clamp( q );
	return descend( q, false ) || ( !tight && descend( q, true ) );
}

/// Errors of all constraints, positions first, and their Jacobian. @return the squared length of the errors
double Solver::evaluate( const double* q, bool to_nearest, bool jacobian )
{
	m_chain.place( q );
	Eigen::Index row = 0;
	const auto add = [&]( const auto& bound, bool position, double weight )
	{
		const Pose link = m_chain.pose( bound.link ), frame = m_chain.pose( bound.frame );
		const ConstraintError e =
		    to_nearest ? bound.constraint.toNearest( link, frame ) : bound.constraint.toTarget( link, frame );
		m_residual.segment<3>( row ) = weight * e.error;
		if ( jacobian )
		{
			Vector3d point = link.t;
			if constexpr ( std::is_same_v<std::decay_t<decltype( bound.constraint )>, PositionConstraint> )
			{
				point = bound.constraint.point( link );
			}
			m_linear.setZero();
			m_angular.setZero();
			m_chain.addJacobian( bound.link, point, 1, m_linear, m_angular );
			m_chain.addJacobian( bound.frame, point, -1, m_linear, m_angular );
			m_jacobian.middleRows<3>( row ).noalias() = weight * e.motion * ( position ? m_linear : m_angular );
		}
		row += 3;
	};
	for ( const auto& bound : m_goal.positions )
	{
		add( bound, true, 1 );
	}
	for ( const auto& bound : m_goal.orientations )
	{
		add( bound, false, radian_length );
	}
	return m_residual.squaredNorm();
}

/// m_step = -A^T (A A^T + damping)^-1 residual, where A is the Jacobian without the columns of fixed freedoms.
void Solver::step( double damping )
{
	m_active = m_jacobian;
	for ( std::size_t i = 0; i < m_fixed.size(); ++i )
	{
		if ( m_fixed[i] )
		{
			m_active.col( static_cast<Eigen::Index>( i ) ).setZero();
		}
	}
	m_normal.noalias() = m_active * m_active.transpose();
	m_normal.diagonal().array() += damping;
	m_gradient = m_normal.ldlt().solve( m_residual );
	m_step.noalias() = -( m_active.transpose() * m_gradient );
	const double largest = m_step.cwiseAbs().maxCoeff();
	if ( largest > longest_step )
	{
		m_step *= longest_step / largest;
	}
}

/// A step after which freedoms at a bound are not further out: these stay, and the others step again without them.
void Solver::stepWithinBounds( const double* q, double damping )
{
	std::fill( m_fixed.begin(), m_fixed.end(), false );
	bool again = true;
	for ( std::size_t round = 0; again && round <= m_fixed.size(); ++round )
	{
		step( damping );
		again = false;
		for ( std::size_t k = 0; k < m_fixed.size(); ++k )
		{
			const Freedom& freedom = m_chain.freedoms()[k];
			const auto column = static_cast<Eigen::Index>( k );
			const double value = freedom.turn < 0 ? q[freedom.variable] : 0;
			const bool out = ( m_step[column] < 0 && value <= m_goal.lower[column] ) ||
			                 ( m_step[column] > 0 && value >= m_goal.upper[column] );
			again = again || ( out && !m_fixed[k] );
			m_fixed[k] = m_fixed[k] || out;
		}
	}
}

/// to = from moved by m_step, quaternions of length 1.
void Solver::move( const double* from, double* to ) const
{
	std::copy( from, from + m_variables, to );
	const std::vector<Freedom>& freedoms = m_chain.freedoms();
	for ( std::size_t i = 0; i < freedoms.size(); ++i )
	{
		const auto k = static_cast<Eigen::Index>( i );
		if ( freedoms[i].turn < 0 )
		{
			to[freedoms[i].variable] += m_step[k];
		}
		else if ( freedoms[i].turn == 0 )
		{
			double* const r = to + freedoms[i].variable;
			const Eigen::Quaterniond turned = Eigen::Quaterniond( r[3], r[0], r[1], r[2] ).normalized() *
			                                  Eigen::Quaterniond( exponential( m_step.segment<3>( k ) ) );
			Eigen::Map<Eigen::Vector4d> quaternion( r );
			quaternion = turned.normalized().coeffs(); // x, y, z, w
		}
	}
	clamp( to );
}

bool Solver::descend( double* q, bool to_nearest )
{
	double cost = evaluate( q, to_nearest, true ), damping = first_damping;
	int poor = 0;
	for ( int i = 0; i < most_steps && cost > solved_cost && poor < most_poor_steps; ++i )
	{
		stepWithinBounds( q, damping * cost + damping_floor );
		move( q, m_try.data() );
		m_residual_before = m_residual;
		const double next = evaluate( m_try.data(), to_nearest, false );
		if ( next < cost )
		{
			poor = next > ( 1 - stalled_share ) * cost ? poor + 1 : 0;
			std::copy( m_try.begin(), m_try.end(), q );
			cost = evaluate( q, to_nearest, true );
			damping = std::max( 0.1 * damping, least_damping );
		}
		else
		{
			++poor;
			damping = std::min( 10 * damping, most_damping );
			m_residual = m_residual_before;
		}
	}
	const Excess left = excess( q );
	return left.metres <= 0.5 * excess_rounding && left.radians <= 0.5 * excess_rounding;
}

} // namespace leeway::ik
