// SPDX-License-Identifier: BSD-3-Clause
// Time parametrisation of a path: as fast as limits of velocity, acceleration and jerk allow, with corners rounded as far as the proof allows.
#pragma once

#include "leeway/motions/trajectory.hpp"

#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace leeway::motions
{

/// Limits of each variable of the group.
struct MotionLimits
{
	std::vector<double> velocity, acceleration; ///< [group variables]
	std::vector<double> jerk;                   ///< [group variables]; empty: none
	std::vector<std::string> usual;      ///< variables without a limit of the acceleration, which keep default_acceleration
	std::vector<std::string> usual_jerk; ///< variables without a limit of the jerk, which keep default_jerk

	double mostJerk( std::size_t variable ) const { return jerk.empty() ? HUGE_VAL : jerk[variable]; }
};

/// rad/s^2 or m/s^2 of joints that no file limits, as MoveIt has it.
constexpr double default_acceleration = 1;
/// Per second, times the limit of the acceleration: in a tenth of a second it is reached.
constexpr double default_jerk = 10;

/// Those of `limits`, else of the robot (its acceleration and jerk are of URDF 1.2), else the defaults.
/// @throws io::Error for a joint without a velocity limit, and for floating joints
MotionLimits motionLimits( const io::Problem& problem, const io::RobotModel& robot, const JointLimits& limits );

/// Settings that leeway::manifold, leeway::lines and leeway::sequence share.
struct MotionSettings
{
	lw_edge_def edge = lw_edge_def_default(); ///< min_d, flags, slack
	MotionLimits limits;                      ///< motionLimits()
	std::uint64_t seed = 1;                   ///< equal seeds give equal plans, unless the time is over
	std::function<bool()> stop; ///< asked now and then; true ends the work, as if the time were over; may be empty
};

struct TimingSettings
{
	lw_edge_def edge = lw_edge_def_default(); ///< of the proofs of roundings
	/// Radians and metres, Euclidean: no rounding is farther from the path (MoveIt's path_tolerance); 0: the robot stops at each corner.
	double path_tolerance = HUGE_VAL;
};

/// A motion along a path, at rest at both ends. Edges are driven by double-S profiles, corners on quintics at a constant speed from edge to edge, each as
/// large as is proved free, so the acceleration is continuous. Angles go on without wrapping. How fast: core/docs/motions.md.
/// @param points group states, at least one; their edges are proved
/// @return points with velocities and accelerations, between which quintics are driven: auditTrajectory() proves them
/// @throws CoreError
TrajectoryFile timedPath( const io::Problem& problem, const std::vector<std::vector<double>>& points,
    const MotionLimits& limits, const TimingSettings& settings );

/// The ends of cubic segments that follow each other, with velocities: a controller drives the same cubics.
/// @param standing group state that is held where there is no segment: one point
TrajectoryFile endsOf(
    const io::Problem& problem, const std::vector<Segment>& segments, const std::vector<double>& standing = {} );

/// As a moveit_msgs/RobotTrajectory: JSON, which is YAML too.
std::string robotTrajectory( const TrajectoryFile& trajectory );

} // namespace leeway::motions
