// SPDX-License-Identifier: BSD-3-Clause
// States along a reference: Newton steps keep a frame on it within the joint limits; a wish steers the joints that it leaves open.
#pragma once

#include "ik/chain.hpp"
#include "leeway/lines/lines.hpp"

namespace leeway::lines
{

using State = Eigen::VectorXd;

/// A way of the joints that the reference leaves open: towards a posture, so strongly.
struct Wish
{
	State posture;
	double strength = 0;
};

class Follower
{
public:
	/// @throws io::Error (a floating joint; the group does not move the tip)
	Follower( const io::RobotModel& robot, const io::Problem& problem, const Task& task );

	std::size_t variables() const { return static_cast<std::size_t>( m_lower.size() ); }
	const State& lower() const { return m_lower; } ///< infinite: none
	const State& upper() const { return m_upper; }
	/// The tip in the base.
	lw_transform pose( const State& q );

	/// Moves q onto the reference. @return false if that does not succeed; blame() then says by which joint
	bool correct( const lw_region_def& reference, double fraction, State& q );
	/// The joints' speeds for each unit of the fraction: the needs of the reference, and beside them `hint`.
	State rate( const lw_region_def& reference, double fraction, const State& q, const State& hint );
	/// Speeds of the joints by a wish and by near limits, for each unit of the fraction, before the reference's needs.
	State drift( const State& q, const Wish& wish ) const;

	struct Blame
	{
		Obstacle obstacle = Obstacle::SINGULARITY;
		std::size_t variable = 0;
	};
	/// After correct() or rate(): a joint at its limit, or the one that moves fastest.
	const Blame& blame() const { return m_blame; }

private:
	void place( const lw_region_def& reference, double fraction, const State& q );
	State solved( const Eigen::VectorXd& wanted, const std::vector<bool>& fixed, double damping );

	ik::Chain m_chain;
	ik::ChainFrame m_tip, m_base;
	bool m_free = false;
	Eigen::Vector3d m_axis;
	State m_lower, m_upper;
	Eigen::Matrix3Xd m_linear, m_angular;
	Eigen::MatrixXd m_jacobian, m_active; ///< [rows][variables]
	Eigen::VectorXd m_error, m_flow;      ///< [rows] of the pose; of the reference, for each unit of the fraction
	Blame m_blame;
};

} // namespace leeway::lines
