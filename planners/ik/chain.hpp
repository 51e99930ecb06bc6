// SPDX-License-Identifier: BSD-3-Clause
// The joints by which a group moves certain frames: their poses, and the Jacobians of points on them.
//
// A *freedom* is one direction in which a state can change. Each variable of a group state q is one freedom, except for the
// quaternion of a floating joint: its four variables have three freedoms, turns about the axes of the child frame.
#pragma once

#include "ik/rotation.hpp"

#include "leeway/io/model.hpp"

#include <map>
#include <string>
#include <vector>

namespace leeway::ik
{

struct Freedom
{
	std::uint32_t variable; ///< entry of q; of a quaternion its first entry
	int turn;               ///< -1: q[variable] changes; 0, 1, 2: the quaternion turns about this axis
};

/// A frame on the chain, see Chain::add().
struct ChainFrame
{
	int joint = -1; ///< last moving joint between the root and the frame; -1: the frame is at rest
	Pose pose;      ///< in the child frame of the joint, or in the planning frame
};

/// Columns of linear velocities above angular ones.
using Twists = Eigen::Matrix<double, 6, Eigen::Dynamic>;

class Chain
{
public:
	/// All freedoms of the problem's group; joints outside of the group are at the reference state.
	/// @throws io::Error if the model has no joint of the robot's name for it: the problem is of another robot
	Chain( const io::RobotModel& model, const io::Problem& problem );

	/// Adds the joints between the root and a frame.
	ChainFrame add( const io::Frame& frame );

	const std::vector<Freedom>& freedoms() const { return m_freedoms; }
	/// True if the freedom moves one of the frames added so far.
	bool moves( std::size_t freedom ) const { return m_moves[freedom]; }
	const std::vector<bool>& moves() const { return m_moves; }
	/// [freedoms] which move one frame in the other.
	std::vector<bool> movesBetween( const ChainFrame& a, const ChainFrame& b ) const;
	/// True if whole turns of the freedom leave all poses as they are.
	bool wholeTurns( std::size_t freedom ) const;

	/// Forward kinematics. @param q [variables of the group]
	void place( const double* q );
	/// After place(): the pose in the planning frame.
	Pose pose( const ChainFrame& frame ) const;
	/// After place(): adds `sign` times the velocity of a point that the frame carries, per velocity of each freedom.
	/// @param point planning frame @param twists [6 x freedoms], planning frame
	void addJacobian( const ChainFrame& frame, const Vector3d& point, double sign, Eigen::Ref<Twists> twists ) const;

private:
	struct Joint
	{
		lw_joint_type type;
		int parent; ///< joint before this one; -1 = none
		Pose parent_from_joint;
		Vector3d axis, plane_x, plane_y;
		std::uint32_t variable; ///< entry of q
		int freedom;            ///< first one of the joint
		double multiplier = 1, offset = 0;
		Pose world_from_joint, world_from_child; ///< before and after the joint's motion
	};
	const io::JointModel* model( std::uint32_t joint ) const;
	int addJoint( std::uint32_t joint, Pose& rest );
	void placeJoint( Joint& joint, const double* q ) const;
	void findFreedoms( const io::Problem& problem );

	const lw_robot* m_robot;
	std::map<std::string, const io::JointModel*> m_models;
	std::vector<int> m_entry;              ///< [robot variables] entry of q; -1 = outside of the group
	std::vector<int> m_first_freedom;      ///< [entries of q]
	std::vector<lw_transform> m_reference; ///< [links], at the reference state
	std::vector<Freedom> m_freedoms;
	std::vector<bool> m_moves; ///< [freedoms]
	std::vector<Joint> m_joints;
	std::map<std::uint32_t, int> m_known; ///< robot joint -> m_joints
};

} // namespace leeway::ik
