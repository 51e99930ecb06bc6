// SPDX-License-Identifier: BSD-3-Clause
// States along a reference: descents keep a frame on it within the joint limits; a wish steers the joints that it leaves open.
#pragma once

#include "ik/pose_errors.hpp"
#include "lines/way.hpp"

namespace leeway::lines
{

using State = Eigen::VectorXd;

/// A way of the joints that the reference leaves open: towards a posture, so strongly, or so that they arrive there at its end.
struct Wish
{
	State posture;
	double strength = 0;
	bool arrives = false;
};

class Follower
{
public:
	/// @throws io::Error (a floating joint; the group does not move the tip)
	Follower( const io::RobotModel& robot, const io::Problem& problem, const Task& task );

	std::size_t variables() const { return static_cast<std::size_t>( m_bounds.lower.size() ); }
	const State& lower() const { return m_bounds.lower; } ///< infinite: none
	const State& upper() const { return m_bounds.upper; }
	/// The tip in the base.
	lw_transform pose( const State& q );

	/// Moves q onto a reference. @return false if that does not succeed; blame() then says by which joint
	bool correct( const ik::Pose& reference, State& q );
	/// The joints' change with a reference that moves: its needs, and beside them `hint`.
	State rate( const ik::Pose& reference, const Leg::Motion& motion, const State& q, const State& hint );
	/// Speeds of the joints by a wish and by near limits, for a whole run, before the reference's needs.
	State drift( const State& q, const Wish& wish, double fraction ) const;

	struct Blame
	{
		Obstacle obstacle = Obstacle::SINGULARITY;
		std::size_t variable = 0;
	};
	/// After correct() or rate(): a joint at its limit, or the one that moves fastest.
	const Blame& blame() const { return m_blame; }

private:
	ik::Chain m_chain;
	ik::PoseErrors m_errors;
	ik::Descent m_descent;
	ik::Bounds m_bounds;
	Blame m_blame;
};

} // namespace leeway::lines
