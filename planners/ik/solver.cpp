// SPDX-License-Identifier: BSD-3-Clause
// States of a group that satisfy constraints, found by damped least squares within bounds.
#include "ik/solver.hpp"

namespace leeway::ik
{

double Excess::sum() const
{
	return metres + radian_length * radians;
}

Solver::Solver( Chain& chain, BoundGoal& goal )
    : m_chain( chain ), m_goal( goal ),
      m_descent( chain, chain.moves(), 3 * ( goal.positions.size() + goal.orientations.size() ) ),
      m_twists( 6, static_cast<Eigen::Index>( chain.freedoms().size() ) )
{
}

void draw( const std::vector<Freedom>& freedoms, const std::vector<bool>& moving, const Bounds& between, Random& random,
    double share, double* q )
{
	for ( std::size_t i = 0; i < freedoms.size(); ++i )
	{
		const auto k = static_cast<Eigen::Index>( i );
		if ( freedoms[i].turn < 0 )
		{
			double& value = q[freedoms[i].variable];
			value += share * ( random.between( between.lower[k], between.upper[k] ) - value );
		}
		else if ( freedoms[i].turn == 0 && share == 1 && moving[i] ) // uniform rotations (Shoemake, Graphics Gems III, 1992)
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
	return descend( q, false ) || ( !tight && descend( q, true ) );
}

/// Errors of all constraints, positions first, and their Jacobian.
void Solver::evaluate( const double* q, Eigen::VectorXd& residual, Eigen::MatrixXd& jacobian )
{
	m_chain.place( q );
	Eigen::Index row = 0;
	const auto add = [&]( const auto& bound, bool position, double weight )
	{
		const Pose link = m_chain.pose( bound.link ), frame = m_chain.pose( bound.frame );
		const ConstraintError e =
		    m_to_nearest ? bound.constraint.toNearest( link, frame ) : bound.constraint.toTarget( link, frame );
		residual.segment<3>( row ) = weight * e.error;
		Vector3d point = link.t;
		if constexpr ( std::is_same_v<std::decay_t<decltype( bound.constraint )>, PositionConstraint> )
		{
			point = bound.constraint.point( link );
		}
		m_twists.setZero();
		m_chain.addJacobian( bound.link, point, 1, m_twists );
		m_chain.addJacobian( bound.frame, point, -1, m_twists );
		const Matrix3d motion = weight * e.motion;
		jacobian.middleRows<3>( row ) = motion.lazyProduct( m_twists.middleRows<3>( position ? 0 : 3 ) );
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
}

bool Solver::descend( double* q, bool to_nearest )
{
	m_to_nearest = to_nearest;
	m_descent.run( *this, m_goal.bounds, q );
	const Excess left = excess( q );
	return left.metres <= 0.5 * excess_rounding && left.radians <= 0.5 * excess_rounding;
}

} // namespace leeway::ik
