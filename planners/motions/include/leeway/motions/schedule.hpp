// SPDX-License-Identifier: BSD-3-Clause
// All motions of a world on one clock, and their proof: robots from their trajectory files or from plans, objects from the world file.
#pragma once

#include "leeway/clock.h"
#include "leeway/io/world_model.hpp"
#include "leeway/motions/states.hpp"
#include "leeway/motions/trajectory_file.hpp"

#include <cstddef>
#include <string>
#include <vector>

namespace leeway::motions
{

/// The motions of all parts of a world over time.
///
/// A part without a motion stands at its state. Before its motion a part stands at the motion's first point, wherever its state is, and after it at
/// the last. Joints that a trajectory does not name keep their values. Trajectories of one file are driven one after the other. Points are
/// joined as a controller joins them (Interpolation::automatic).
class Schedule
{
public:
	/// Reads the trajectory files of the robots, whose joints have names with or without the robot's.
	/// @param problem of the world's robot, outlives this; its group has all variables of parts that move, or may deviate
	/// @throws io::Error that names part, file and piece
	Schedule( const io::WorldModel& world, const io::Problem& problem );
	Schedule( const Schedule& ) = delete;
	Schedule& operator=( const Schedule& ) = delete;

	/// Replaces a part's motion by straight joint-space edges. @param times [n] seconds on the clock, increasing, n >= 1
	/// @param points [n][variables of the part], in the order of io::WorldPart::variables @throws io::Error
	void add( const std::string& part, const std::vector<double>& times, const std::vector<std::vector<double>>& points );

	/// Seconds at which the last motion ends; of loops, the first time around. 0 if nothing moves after 0.
	double duration() const;
	/// The clock, on which loops go on until then at least. It is valid until the next call of this or of add(), and as long as this lives.
	/// @throws io::Error (loops of more than most_pieces pieces)
	const lw_clock& clock( double until );
	/// The same without the tracks of some parts, for planners that move these. It is valid as long as clock()'s.
	lw_clock clockWithout( const std::vector<std::string>& parts, double until );
	/// The group's state.
	std::vector<double> state( double time );
	/// Indices into the group of a part's variables, in the order of io::WorldPart::variables. @throws io::Error (no such part in the group)
	const std::vector<std::uint32_t>& variables( const std::string& part ) const;

	const io::Problem& problem() const { return m_problem; }
	/// Fields of trajectory files that have no say, and joints that stand elsewhere than a file says.
	const std::vector<io::Notice>& notices() const { return m_notices; }
	static constexpr std::size_t most_pieces = 1'000'000;

private:
	struct Track
	{
		io::WorldPart part;                   ///< with its pieces, those of robots too
		std::string source;                   ///< of its pieces, for errors
		std::vector<std::string> piece_names; ///< of a trajectory's pieces, for errors
		std::vector<std::uint32_t> variables; ///< of the group
		std::vector<io::TimedPiece> pieces;   ///< until m_until
		std::vector<lw_timed_piece> rows;     ///< views of them
	};
	Track makeTrack( const io::WorldPart& part ) const;
	void readMotion( Track& track );
	void repeat( Track& track, double until ) const;
	void check() const;
	std::size_t trackOf( const std::string& part ) const;

	std::string m_file; ///< of the world
	const io::Problem& m_problem;
	std::vector<Track> m_tracks;
	std::vector<lw_track> m_rows, m_some_rows;
	std::vector<double> m_rest; ///< [group variables]
	std::vector<io::Notice> m_notices;
	double m_until = 0;
	lw_clock m_clock{};
};

/// Largest velocities of a part's variables: of `limits`, by names with or without the robot's, else of the robot's description.
/// @return [io::WorldPart::variables]; 0 for those of planar and floating joints without one @throws io::Error for another variable without one
std::vector<double> velocityLimits( const io::WorldModel& world, const io::WorldPart& part, const JointLimits& limits );

struct ScheduleSettings
{
	double from = 0, to = 0;                  ///< seconds
	lw_edge_def edge = lw_edge_def_default(); ///< without its tolerance
	double contact_resolution = 0;            ///< seconds, as lw_timed_def
};

/// The proof of a schedule.
struct ScheduleAudit
{
	double from = 0, to = 0, min_d = 0;
	lw_verdict verdict = LW_VERDICT_UNKNOWN;
	double time = 0;         ///< of the verdict
	double proved_until = 0; ///< as lw_timed_result
	bool by_spread = false, self = false;
	Named pair;                     ///< that decides, exact at `time`; without names if FREE
	std::vector<double> q;          ///< group state at `time`
	std::vector<std::string> names; ///< of its variables
	double lower_bound = 0;         ///< metres, proved, if FREE
	std::size_t pieces = 0;
	std::uint64_t states = 0;
	double seconds = 0;
	bool valid() const { return verdict == LW_VERDICT_FREE; }
};

/// Proves [from, to] by lw_checker_timed(). @throws io::Error
ScheduleAudit auditSchedule( Schedule& schedule, const ScheduleSettings& settings );

/// Lines for people.
std::string describe( const ScheduleAudit& audit );

} // namespace leeway::motions
