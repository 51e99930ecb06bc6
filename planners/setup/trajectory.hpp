// SPDX-License-Identifier: BSD-3-Clause
// Timed trajectories as a controller drives them: polynomial segments, proved at all times and not at samples.
#pragma once

#include "setup/json.hpp"
#include "setup/setup.hpp"
#include "text/trajectory_file.hpp"

#include <map>
#include <string>
#include <vector>

namespace leeway::cli
{

enum class Interpolation
{
	automatic, ///< by the data that both ends of a segment have, as ros2_controllers' joint_trajectory_controller does
	linear,
	cubic,  ///< positions and velocities
	quintic ///< positions, velocities and accelerations
};

/// From one point to the next: a Bezier curve of the group's variables.
struct Segment
{
	double begin = 0, seconds = 0; ///< of all trajectories one after the other
	unsigned degree = 1;
	std::vector<double> points; ///< [degree + 1][group variables]
};

struct TrajectorySettings
{
	lw_edge_def edge = lw_edge_def_default(); ///< without its tolerance
	Interpolation interpolation = Interpolation::automatic;
	std::vector<double> tolerance; ///< [group variables]; empty: none
	JointLimits limits;            ///< over the velocity limits of the robot
};

/// The first place where a proof ended.
struct Violation
{
	lw_verdict verdict = LW_VERDICT_FREE;
	double time = 0;       ///< seconds
	std::vector<double> q; ///< group state
	std::vector<std::string> names; ///< of its variables
	bool self = false;
	Named pair;
};

struct TrajectoryAudit
{
	std::size_t segments = 0, by_degree[6] = {};
	double duration = 0;
	Violation violation;               ///< FREE: there is none
	double lower_bound = 0;            ///< metres, proved, of all clearances at all times; 0 if not FREE
	std::vector<std::string> problems; ///< joint limits and gaps, sentences
	double min_d = 0;
	std::map<std::string, double> tolerance; ///< by variable; empty: none
	double proof_seconds = 0;
	std::uint64_t states = 0;
	bool valid() const { return violation.verdict == LW_VERDICT_FREE && problems.empty(); }
};

/// Tolerances of the group's variables, empty if all are 0: those of a goal in `file`, then those of the command line, "E" or "JOINT=E".
/// @throws io::Error
std::vector<double> tolerances( const Workbench& bench, const std::string& file,
    const std::map<std::string, double>& of_goal, const std::vector<std::string>& given );

/// Segments of a trajectory in the order of the group's variables.
/// @param begin seconds of the trajectories before it
/// @throws io::Error for a joint that is missing or too many, and for data that the interpolation needs and the file lacks
std::vector<Segment> segmentsOf(
    const Workbench& bench, const TrajectoryFile& file, Interpolation interpolation, double begin );

/// The ways to a first point that comes after time 0, from where the controller finds the robot: straight, cubic if the point has velocities, quintic
/// if it has accelerations too. Which of them ROS's joint_trajectory_controller drives depends on the state interfaces of the hardware; with
/// another interpolation than automatic there is one.
/// @param start one point of the file's joints at time 0, with velocities and accelerations (0 at rest)
/// @return the last is that of the first point's own data
std::vector<Segment> approachesTo( const Workbench& bench, const TrajectoryFile& file, const TrajectoryPoint& start,
    Interpolation interpolation, double begin );

/// Proves all segments, and compares positions, velocities and accelerations with their limits at all times.
/// @param file of the segments, for errors
/// @param instead curves that may be driven in place of a segment: proved and compared too, and not counted @throws io::Error
TrajectoryAudit auditTrajectory( const Workbench& bench, const io::RobotModel& robot, const std::string& file,
    const std::vector<Segment>& segments, const TrajectorySettings& settings, const std::vector<Segment>& instead = {} );
/// Adds the audit of a trajectory that is driven after those before.
void append( TrajectoryAudit& whole, const TrajectoryAudit& next );

/// Group state at a time of all trajectories.
std::vector<double> stateAt( const std::vector<Segment>& segments, double time );

/// Lines for people.
std::string describe( const TrajectoryAudit& audit );
Json toJson( const TrajectoryAudit& audit );

} // namespace leeway::cli
