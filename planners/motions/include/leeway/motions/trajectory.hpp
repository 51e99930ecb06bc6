// SPDX-License-Identifier: BSD-3-Clause
// Timed trajectories as a controller drives them: polynomial segments, proved at all times and not at samples.
#pragma once

#include "leeway/motions/states.hpp"
#include "leeway/motions/trajectory_file.hpp"

#include <map>
#include <string>
#include <vector>

namespace leeway::motions
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
	double time = 0;                ///< seconds
	std::vector<double> q;          ///< group state
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

/// Adds the audit of a trajectory that is driven after those before.
void append( TrajectoryAudit& whole, const TrajectoryAudit& next );

/// A tolerance of one variable, or of all variables of the group.
struct Tolerance
{
	std::string variable;      ///< empty: all
	double value = 0;          ///< radians or metres, 0 or more
	std::string file, element; ///< that gives it, for errors
};

/// Tolerances [group variables], empty if all are 0: those of a goal in `file`, then the given ones; a later one replaces an earlier.
/// @throws io::Error for a negative one, an unknown joint, and a tolerance of the goal that no number gives
std::vector<double> tolerances( const io::Problem& problem, const std::string& file,
    const std::map<std::string, double>& of_goal, const std::vector<Tolerance>& given );

/// Segments of a trajectory in the order of the group's variables.
/// @param begin seconds of the trajectories before it
/// @throws io::Error for a joint that is missing or too many, and for data that the interpolation needs and the file lacks
std::vector<Segment> segmentsOf(
    const io::Problem& problem, const TrajectoryFile& file, Interpolation interpolation, double begin );

/// The same of some columns of the file, in this order. @param columns indices into joint_names
std::vector<Segment> segmentsOf(
    const TrajectoryFile& file, const std::vector<std::size_t>& columns, Interpolation interpolation, double begin );

/// The ways to a first point that comes after time 0, from where the controller finds the robot: straight, cubic if the point has velocities, quintic
/// if it has accelerations too. Which of them ROS's joint_trajectory_controller drives depends on the state interfaces of the hardware; with
/// another interpolation than automatic there is one.
/// @param start one point of the file's joints at time 0, with velocities and accelerations (0 at rest)
/// @return the last is that of the first point's own data
std::vector<Segment> approachesTo( const io::Problem& problem, const TrajectoryFile& file, const TrajectoryPoint& start,
    Interpolation interpolation, double begin );

/// Proves all segments, and compares positions, velocities and accelerations with their limits at all times.
/// @param file of the segments, for errors
/// @param instead curves that may be driven in place of a segment: proved and compared too, and not counted @throws io::Error
TrajectoryAudit auditTrajectory( const io::Problem& problem, const io::RobotModel& robot, const std::string& file,
    const std::vector<Segment>& segments, const TrajectorySettings& settings, const std::vector<Segment>& instead = {} );

/// Clearances over time, exact, at steps of 10 ms and at the end: lines "time,environment,self", without a header.
std::string profileCsv(
    const io::Problem& problem, const std::vector<Segment>& segments, lw_check_flags flags, const std::string& file );

/// Trajectories that are driven one after the other, by one group or by several.
class Drive
{
public:
	/// @param start where a request says that joints stand before the first trajectory; may be empty
	explicit Drive( Values start = {} ) : m_start( std::move( start ) ) {}

	/// Audits a trajectory that begins where the one before ended. A jump from there, or from the start state to a first
	/// point at time 0, is a problem. The way to a first point that comes later is proved with it if the start is known. @param problem of the trajectory's group, in the world as it is by then @throws io::Error
	const TrajectoryAudit& add( const io::Problem& problem, const io::RobotModel& robot, const TrajectoryFile& file,
	    const TrajectorySettings& settings );
	/// Segments of the last trajectory.
	const std::vector<Segment>& segments() const { return m_segments; }
	/// What the last trajectory leaves unproved.
	const std::vector<io::Notice>& notices() const { return m_notices; }
	/// Seconds at which it begins.
	double begin() const { return m_begin; }
	/// Of all.
	const TrajectoryAudit& whole() const { return m_whole; }

private:
	/// Where a joint stands, and by what that is known.
	struct Place
	{
		double value;
		const char* of;
	};
	std::vector<Place> placesOf( const TrajectoryFile& file, const std::string& name ) const;
	std::vector<Segment> approachesOf(
	    const io::Problem& problem, const TrajectoryFile& file, const TrajectorySettings& settings );
	std::vector<std::string> differences(
	    const io::Problem& problem, const io::RobotModel& robot, const TrajectoryFile& file, const Segment& first ) const;

	Values m_start;
	TrajectoryAudit m_whole, m_last;
	std::vector<io::Notice> m_notices;
	std::vector<Segment> m_segments;
	double m_begin = 0;
	Values m_ends; ///< of all variables that were moved
};

/// Group state at a time of all trajectories.
std::vector<double> stateAt( const std::vector<Segment>& segments, double time );

/// Lines for people.
std::string describe( const TrajectoryAudit& audit );

} // namespace leeway::motions
