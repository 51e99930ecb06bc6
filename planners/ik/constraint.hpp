// SPDX-License-Identifier: BSD-3-Clause
// One position or orientation constraint as geometry: its excess, and errors to reduce.
//
// An *excess* is 0 if the constraint is satisfied, else the distance to its nearest region in metres or the largest angle
// beyond its tolerance in radians. An *error* leads to a target inside of the tolerances: a random one, or the nearest.
#pragma once

#include "ik/random.hpp"
#include "ik/rotation.hpp"

#include "leeway/io/goal.hpp"

namespace leeway::ik
{

/// Targets keep this share of every tolerance, so that a solution does not leave it by rounding.
constexpr double inner_share = 0.999;

/// An error and the change of it that motion makes: d(error) = motion * (velocity of the link relative to the frame), with
/// the velocity in the planning frame: linear for positions, angular for orientations.
struct ConstraintError
{
	Vector3d error = Vector3d::Zero(); ///< metres or radians
	Matrix3d motion = Matrix3d::Zero();
};

class PositionConstraint
{
public:
	explicit PositionConstraint( const io::PositionGoal& goal ) : m_goal( goal ) {}

	/// The point of the link, in the planning frame.
	Vector3d point( const Pose& link ) const;
	double excess( const Pose& link, const Pose& frame ) const;
	/// A random point of a random region becomes the target.
	void draw( Random& random );
	ConstraintError toTarget( const Pose& link, const Pose& frame ) const;
	/// To the nearest point of the region that draw() chose. Directions in which the region is not left have no error.
	ConstraintError toNearest( const Pose& link, const Pose& frame ) const;
	/// True if the tolerances are so small that the nearest point is no easier to reach than a random one.
	bool isTight() const;

private:
	Vector3d inRegion( const io::GoalRegion& region, const Pose& link, const Pose& frame ) const;
	io::PositionGoal m_goal;
	std::size_t m_region = 0;
	Vector3d m_target = Vector3d::Zero(); ///< in the frame of the region
};

class OrientationConstraint
{
public:
	explicit OrientationConstraint( const io::OrientationGoal& goal );

	double excess( const Pose& link, const Pose& frame ) const;
	void draw( Random& random );
	ConstraintError toTarget( const Pose& link, const Pose& frame ) const;
	ConstraintError toNearest( const Pose& link, const Pose& frame ) const;
	bool isTight() const;

private:
	Matrix3d deviation( const Pose& link, const Pose& frame ) const;
	Vector3d angles( const Matrix3d& deviation ) const;
	Matrix3d rotation( const Vector3d& angles ) const;
	Matrix3d turnsOfAngles( const Vector3d& angles ) const;
	bool isEuler() const { return m_goal.parameterization == io::OrientationGoal::Parameterization::euler_xyz; }

	io::OrientationGoal m_goal;
	Matrix3d m_wanted;
	Vector3d m_bound;                         ///< of the angles: tolerances up to half a turn (pitch: a quarter)
	Vector3d m_inner;                         ///< the same for targets
	Matrix3d m_target = Matrix3d::Identity(); ///< deviation
};

} // namespace leeway::ik
