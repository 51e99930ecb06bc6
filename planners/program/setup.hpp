// SPDX-License-Identifier: BSD-3-Clause
// From file names to a checker, for all subcommands.
#pragma once

#include "leeway/io/path_constraints.hpp"
#include "leeway/io/world_model.hpp"
#include "leeway/motions/audit.hpp"
#include "leeway/motions/motion_files.hpp"
#include "leeway/motions/trajectory.hpp"
#include "program/options.hpp"
#include "program/output.hpp"

#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace leeway::cli
{

/// The files, read.
struct Input
{
	io::RobotModel robot;
	std::optional<io::SceneModel> scene;
	std::optional<io::WorldModel> world; ///< of --world: robot and scene are its own
	std::optional<io::Request> request;
	/// With a cache: where motion hulls and pair tables are, and the seconds of this run for proofs.
	std::optional<io::ReachOptions> reach;
	double robot_seconds = 0, scene_seconds = 0;
	/// The required clearance, and the largest clearance of interest (io::ProblemOptions).
	double min_d = 0, max_d = std::numeric_limits<double>::infinity();
	std::string robot_file, scene_file, request_file;
	io::Margins margins;
	io::Padding padding;
	std::vector<std::pair<std::string, std::string>> allowed; ///< of --allow and the world file
};

/// Metres beyond the margin: obstacles that the group cannot come this near to are passed over where a proof of a motion
/// needs no more clearance than this. Where it needs more, it is asked for.
constexpr double planning_horizon = 0.25;

/// Options of the readers of files. @throws io::Error for a folder of --package-path that is not there
io::LoadOptions loadOptionsOf( const CommonOptions& options );

/// Reads robot, scene and request, with progress, and passes their notices on.
/// @param path constraints along the path of the request; null: they are an error
/// @throws io::Error
Input loadInput( const CommonOptions& options, Notices& notices, io::PathConstraints* path = nullptr );

/// Reports slow builds of motion hulls and slow proofs: the stage, then its progress.
class ReachProgress
{
public:
	explicit ReachProgress( Progress& progress ) : m_progress( progress ) {}
	/// Makes `def` report here; this must outlive the building.
	void attach( lw_reach_def& def );
	/// Cancels the building that many seconds after attach().
	void endAfter( double seconds ) { m_limit = seconds; }
	bool isEnded() const { return m_ended; }

private:
	static bool report( void* self, const char* stage, double share );
	double m_budget = 0, m_begin = 0, m_limit = HUGE_VAL;
	bool m_hulls_only = false, m_told = false, m_ended = false;
	Progress& m_progress;
};

/// Options of a problem of these files. @param values by variable name
io::ProblemOptions problemOptions( const Input& input, const std::string& group, const Values& values );

/// Tells about joints that a scene's robot_state puts elsewhere than they stand. Tables and motions say where those of the group are.
void noteState( const Input& input, const io::Problem& problem, Notices& notices );

/// A checker for one group, rebuilt only when a joint outside of the group moves.
///
/// Joints outside of the group stand where `values` puts them, else where the request starts, else at zero. (The
/// robot_state of a scene is not used for them: a table of states must mean the same in every scene.)
class Workbench
{
public:
	/// @throws io::Error
	Workbench( const Input& input, std::string group, const Values& values, Notices& notices );

	const io::Problem& problem() const { return m_problem; }
	const lw_robot* robot() const { return m_problem.robot.get(); }
	const lw_checker* checker() const { return m_problem.checker.get(); }
	lw_query* query() const { return m_query.get(); }
	double buildSeconds() const { return m_seconds; }
	/// Motion hulls and pair tables that the checker uses; empty without a cache.
	const io::LoadedReach& reach() const { return m_reach; }

	/// Builds or continues motion hulls and pair tables for later runs, in the cache; the checker keeps those that it has.
	/// @return false if it ended without them after that many seconds
	bool proveTables( const io::ReachOptions& options, double seconds ) const;

	/// Makes the checker stand for the variables outside of the group as the full state has them.
	/// @param full [robot variable_count]
	/// @return true if it had to be rebuilt
	bool use( const std::vector<double>& full );

	/// The group's part of a full state.
	std::vector<double> groupState( const std::vector<double>& full ) const
	{
		return motions::groupState( m_problem, full );
	}
	/// The full state of a group state.
	std::vector<double> fullState( const std::vector<double>& q ) const { return motions::fullState( m_problem, q ); }
	/// Name of every robot variable.
	const std::vector<std::string>& variableNames() const { return m_names; }
	/// Index of a robot variable, or LW_INVALID_INDEX.
	std::uint32_t variable( const std::string& name ) const { return variableOf( robot(), name ); }
	/// True if the robot variable is in the group.
	bool inGroup( std::uint32_t variable ) const { return m_in_group[variable]; }

private:
	io::ProblemOptions options( const Values& values ) const;
	void build( const Values& values );
	const Input& m_input;
	std::string m_group;
	Notices& m_notices;
	Values m_values;
	io::Problem m_problem;
	io::LoadedReach m_reach;
	Query m_query;
	std::vector<std::string> m_names;
	std::vector<bool> m_in_group;
	double m_seconds = 0;
	bool m_built = false;
};

/// Measures one state by the bench's query. @param range null: exactly @throws io::Error naming `file` and `element`
lw_state_result measure( const Workbench& bench, const std::vector<double>& q, lw_check_flags flags, const lw_range* range,
    const std::string& file, const std::string& element );

/// auditPath() with its progress shown.
Audit audited( const Workbench& bench, const std::vector<std::vector<double>>& points, AuditSettings settings,
    const std::string& file );

/// Options --tolerance: E for all joints, or JOINT=E. @throws io::Error
std::vector<Tolerance> givenTolerances( const std::vector<std::string>& options );

/// Option --interpolation. @throws io::Error
Interpolation interpolationOf( const std::string& name );

} // namespace leeway::cli
