// SPDX-License-Identifier: BSD-3-Clause
// The error of one frame's pose in another frame, of which either may move.
#include "ik/pose_errors.hpp"

namespace leeway::ik
{

PoseErrors::PoseErrors( Chain& chain, const io::Frame& tip, const io::Frame& base, const std::optional<Vector3d>& free_axis )
    : m_chain( chain ), m_tip( chain.add( tip ) ), m_base( chain.add( base ) ),
      m_moving( chain.movesBetween( m_tip, m_base ) ), m_free_axis( free_axis )
{
}

Pose PoseErrors::pose( const double* q )
{
	m_chain.place( q );
	return inverse( m_chain.pose( m_base ) ) * m_chain.pose( m_tip );
}

/// The derivative of the rotation vector is that of its rotation: to first order near 0, and exact along the vector, so that the gradient of
/// its length is exact everywhere.
void PoseErrors::evaluate( const double* q, Eigen::VectorXd& residual, Eigen::MatrixXd& jacobian )
{
	m_chain.place( q );
	const Pose base = m_chain.pose( m_base ), tip = m_chain.pose( m_tip ), wanted = base * m_wanted;
	m_base_turn = base.r;
	Eigen::Map<Twists> twists( jacobian.data(), 6, jacobian.cols() );
	twists.setZero();
	m_chain.addJacobian( m_tip, tip.t, 1, twists );
	if ( m_base.joint >= 0 )
	{
		m_chain.addJacobian( m_base, wanted.t, -1, twists );
	}
	residual.head<3>() = tip.t - wanted.t;
	if ( !m_free_axis )
	{
		residual.tail<3>() = radian_length * logarithm( tip.r * wanted.r.transpose() );
		twists.bottomRows<3>() *= radian_length;
		return;
	}
	const Vector3d is = tip.r * *m_free_axis, should = wanted.r * *m_free_axis, turn = should.cross( is );
	const double angle = std::atan2( turn.norm(), is.dot( should ) );
	m_turns = Matrix3d::Identity() - should * should.transpose();
	const Vector3d axis = turn.norm() > 0 ? turn.normalized() : should.unitOrthogonal();
	residual.tail<3>() = radian_length * angle * axis;
	for ( Eigen::Index k = 0; k < twists.cols(); ++k )
	{
		twists.col( k ).tail<3>() = radian_length * m_turns * Vector3d( twists.col( k ).tail<3>() );
	}
}

Eigen::VectorXd PoseErrors::flow( const Vector3d& linear, const Vector3d& angular ) const
{
	Eigen::VectorXd flow( 6 );
	flow.head<3>() = -( m_base_turn * linear );
	flow.tail<3>() = -radian_length * ( m_turns * ( m_base_turn * angular ) );
	return flow;
}

PoseExcess excessOf( const Eigen::VectorXd& residual )
{
	return { residual.head<3>().norm(), residual.tail<3>().norm() / radian_length };
}

} // namespace leeway::ik
