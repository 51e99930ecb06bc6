// SPDX-License-Identifier: BSD-3-Clause
// Audits of paths and trajectories, analyses of link pairs, and tuning: the libraries of the program leeway, and their reports as dicts.
#include "objects.hpp"

#include "motions/report.hpp"
#include "pairs/report.hpp"
#include "tune/report.hpp"

#include "leeway/motions/motion_files.hpp"
#include "leeway/motions/path_file.hpp"
#include "leeway/motions/states.hpp"
#include "leeway/motions/timed.hpp"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace leeway::python
{

nb::object dictOf( const motions::Json& json )
{
	return nb::module_::import_( "json" ).attr( "loads" )( nb::str( motions::jsonText( json ).c_str() ) );
}

std::string fileName( const nb::object& given )
{
	if ( nb::isinstance<nb::str>( given ) || nb::hasattr( given, "__fspath__" ) )
	{
		return nb::cast<std::string>( nb::module_::import_( "os" ).attr( "fspath" )( given ) );
	}
	return "";
}

std::vector<double> toleranceOf( const PyChecker& checker, const std::string& file,
    const std::map<std::string, double>& of_goal, const nb::object& given )
{
	std::vector<motions::Tolerance> tolerances;
	if ( !given.is_none() )
	{
		const Doubles numbers = nb::cast<Doubles>( given );
		const double* values = vectorOf( numbers, checker.variables(), "tolerance", "variables of the group" );
		for ( std::size_t v = 0; v < checker.variables(); ++v )
		{
			const std::string& name = checker.problem->variable_names[v];
			tolerances.push_back( { name, values[v], "tolerance", name } );
		}
	}
	return motions::tolerances( *checker.problem, file, of_goal, tolerances );
}

motions::Interpolation interpolationOf( const std::string& name )
{
	for ( const auto& [known, value] :
	    { std::pair( "auto", motions::Interpolation::automatic ), std::pair( "linear", motions::Interpolation::linear ),
	        std::pair( "cubic", motions::Interpolation::cubic ), std::pair( "quintic", motions::Interpolation::quintic ) } )
	{
		if ( name == known )
		{
			return value;
		}
	}
	throw nb::value_error( ( "interpolation: '" + name + "' is none of auto, linear, cubic, quintic" ).c_str() );
}

std::vector<motions::TrajectoryFile> trajectoriesOf( const PyChecker& checker, const nb::object& times,
    const nb::object& positions, const nb::object& velocities, const nb::object& accelerations )
{
	const std::string file = fileName( times );
	return file.empty() ? std::vector<motions::TrajectoryFile>{ trajectoryOf(
	                          checker, nb::cast<Doubles>( times ), positions, velocities, accelerations ) }
	                    : motions::readTrajectories( file );
}

namespace
{

using namespace nb::literals;

/// Lets Ctrl-C end a long call.
motions::ProgressFunction interruptible()
{
	return []( const char*, double )
	{
		const nb::gil_scoped_acquire locked;
		if ( PyErr_CheckSignals() != 0 )
		{
			throw nb::python_error();
		}
	};
}

struct Path
{
	std::string file;
	std::vector<std::vector<double>> points; ///< group states
	double min_d = 0;
	std::vector<io::Notice> notices;
};

/// A report, and its notices.
nb::object dictWithNotices( motions::Json json, const std::vector<io::Notice>& notices )
{
	json["notices"] = noticeLines( notices );
	return dictOf( json );
}

std::vector<io::Notice>& append( std::vector<io::Notice>& notices, const std::vector<io::Notice>& more )
{
	notices.insert( notices.end(), more.begin(), more.end() );
	return notices;
}

Path pathOf( const PyChecker& checker, const nb::object& given )
{
	Path path;
	path.file = fileName( given );
	if ( !path.file.empty() )
	{
		const motions::PathFile file = motions::readPath( path.file );
		path.points = motions::groupPoints( file, *checker.problem );
		path.min_d = file.min_d;
		motions::startValues( file, *checker.model, path.notices );
		append( path.notices, file.notices );
		const std::vector<std::string> elsewhere = motions::startDifferences( file, *checker.problem );
		if ( !elsewhere.empty() )
		{
			throw io::Error( path.file, "start_state", elsewhere.front(),
			    "give the checker this state of the joints: Checker(..., reference=)" );
		}
		return path;
	}
	path.file = "path";
	const Doubles numbers = nb::cast<Doubles>( given );
	const Rows rows = rowsOf( numbers, checker.variables(), "path", "variables of the group" );
	for ( std::size_t i = 0; i < rows.count; ++i )
	{
		path.points.emplace_back( rows[i], rows[i] + rows.width );
	}
	if ( path.points.empty() )
	{
		throw nb::value_error( "path: has no state" );
	}
	return path;
}

nb::object auditPath( const PyChecker& checker, const nb::object& given, const std::optional<double>& min_d,
    const std::string& check, double resolution, double seconds )
{
	const Path path = pathOf( checker, given );
	motions::AuditSettings settings;
	settings.min_d = min_d.value_or( path.min_d );
	settings.flags = checkFlags( check );
	settings.resolution = resolution;
	settings.time = seconds;
	settings.progress = interruptible();
	motions::Audit audit;
	{
		const nb::gil_scoped_release unlocked;
		audit = motions::auditPath( *checker.problem, path.points, settings, path.file );
	}
	return dictWithNotices( toJson( audit, settings ), path.notices );
}

/// The text of a path file. @throws nb::value_error if the audit finds the path invalid
std::string pathText( const PyChecker& checker, const Doubles& given, double min_d, double slack, const Whole& seed,
    const std::string& planner )
{
	const Rows rows = rowsOf( given, checker.variables(), "path", "variables of the group" );
	motions::PathFile file;
	file.seed = seed.seed();
	for ( std::size_t i = 0; i < rows.count; ++i )
	{
		file.points.emplace_back( rows[i], rows[i] + rows.width );
	}
	if ( file.points.empty() )
	{
		throw nb::value_error( "path: has no state" );
	}
	motions::AuditSettings settings;
	settings.min_d = min_d;
	settings.progress = interruptible();
	motions::Audit audit;
	{
		const nb::gil_scoped_release unlocked;
		audit = motions::auditPath( *checker.problem, file.points, settings, "path" );
	}
	if ( !audit.valid )
	{
		const std::string text = "path: is not saved, its audit finds: " + audit.problems.front();
		throw nb::value_error( text.c_str() );
	}
	const lw_robot* robot = lw_checker_robot( checker.get() );
	file.robot = checker.model->name;
	file.group = checker.problem->group;
	file.planner = planner;
	file.validator = "certified";
	file.min_d = min_d;
	file.slack = slack;
	file.length = audit.length;
	file.environment = audit.environment.clearance.lower;
	file.self = audit.self.clearance.lower;
	const std::vector<double> full = motions::fullState( *checker.problem, file.points.front() );
	for ( std::uint32_t i = 0; i < full.size(); ++i )
	{
		file.start_state.emplace_back( io::variableName( robot, i ), full[i] );
	}
	file.joint_names = checker.problem->variable_names;
	return motions::writePath( file );
}

nb::object auditRoundings( const PyChecker& checker, const nb::object& given, double radius,
    const std::optional<double>& min_d, double slack, const std::string& check, const nb::object& tolerance )
{
	const Path path = pathOf( checker, given );
	const std::vector<double> tolerances = toleranceOf( checker, "tolerance", {}, tolerance );
	lw_edge_def def = lw_edge_def_default();
	def.min_d = min_d.value_or( path.min_d );
	def.slack = slack;
	def.flags = checkFlags( check );
	def.tolerance = tolerances.empty() ? nullptr : tolerances.data();
	motions::RoundingAudit audit;
	{
		const nb::gil_scoped_release unlocked;
		audit = motions::auditRoundings( *checker.problem, path.points, radius, def, path.file );
	}
	return dictWithNotices( toJson( audit ), path.notices );
}

motions::JointLimits limitsOf( const nb::object& given )
{
	motions::JointLimits limits;
	const std::string file = fileName( given );
	if ( !file.empty() )
	{
		return motions::readJointLimits( file );
	}
	if ( given.is_none() )
	{
		return limits;
	}
	for ( const auto& [joint, entry] : nb::cast<nb::dict>( given ) )
	{
		const auto name = nb::cast<std::string>( joint );
		for ( const auto& [key, value] : nb::cast<nb::dict>( entry ) )
		{
			const auto what = nb::cast<std::string>( key );
			const double number = nb::cast<double>( value );
			if ( ( what != "max_velocity" && what != "max_acceleration" && what != "max_jerk" ) ||
			     !( number > 0 && std::isfinite( number ) ) )
			{
				throw nb::value_error(
				    ( "joint_limits: " + name + ": give max_velocity, max_acceleration and max_jerk, numbers above 0" )
				        .c_str() );
			}
			( what == "max_velocity" ? limits.velocity
			    : what == "max_jerk" ? limits.jerk
			                         : limits.acceleration )[name] = number;
		}
	}
	return limits;
}

nb::object auditTrajectory( const PyChecker& checker, const nb::object& times, const nb::object& positions,
    const nb::object& velocities, const nb::object& accelerations, const std::string& interpolation,
    const nb::object& joint_limits, double min_d, double slack, const std::string& check, const nb::object& tolerance )
{
	const std::vector<motions::TrajectoryFile> files =
	    trajectoriesOf( checker, times, positions, velocities, accelerations );
	motions::TrajectorySettings settings;
	settings.edge.min_d = min_d;
	settings.edge.slack = slack;
	settings.edge.flags = checkFlags( check );
	settings.interpolation = interpolationOf( interpolation );
	settings.limits = limitsOf( joint_limits );
	std::vector<io::Notice> notices = settings.limits.notices;
	const std::string limits_file = fileName( joint_limits );
	motions::noteUnknownLimits(
	    settings.limits, limits_file.empty() ? "joint_limits" : limits_file, *checker.model, notices );
	motions::startValues( files, *checker.model, notices );
	motions::Drive drive;
	for ( const motions::TrajectoryFile& trajectory : files )
	{
		settings.tolerance = toleranceOf( checker, trajectory.file, trajectory.path_tolerance, tolerance );
		const nb::gil_scoped_release unlocked;
		drive.add( *checker.problem, *checker.model, trajectory, settings );
		append( append( notices, trajectory.notices ), drive.notices() );
	}
	return dictWithNotices( toJson( drive.whole() ), notices );
}

nb::object timedPath( const PyChecker& checker, const Doubles& path, const nb::object& joint_limits, double path_tolerance,
    double min_d, double slack, const std::string& check, const nb::object& tolerance )
{
	const Rows rows = rowsOf( path, checker.variables(), "path", "variables of the group" );
	if ( rows.count == 0 || !( path_tolerance >= 0 ) )
	{
		throw nb::value_error( rows.count == 0 ? "path: is empty" : "path_tolerance: is no number of 0 or more" );
	}
	std::vector<std::vector<double>> points;
	for ( std::size_t i = 0; i < rows.count; ++i )
	{
		points.emplace_back( rows[i], rows[i] + rows.width );
	}
	motions::TimingSettings settings;
	settings.edge.min_d = min_d;
	settings.edge.slack = slack;
	settings.edge.flags = checkFlags( check );
	settings.path_tolerance = path_tolerance;
	const std::vector<double> room = toleranceOf( checker, "path", {}, tolerance );
	settings.edge.tolerance = room.empty() ? nullptr : room.data();
	const motions::JointLimits given = limitsOf( joint_limits );
	std::vector<io::Notice> unknown; // a result of arrays has no place for it
	motions::noteUnknownLimits( given, "joint_limits", *checker.model, unknown );
	if ( !unknown.empty() )
	{
		throw nb::value_error( ( unknown.front().element + ": " + unknown.front().text ).c_str() );
	}
	const motions::MotionLimits limits = motionLimits( *checker.problem, *checker.model, given );
	motions::TrajectoryFile timed;
	{
		const nb::gil_scoped_release unlocked;
		timed = motions::timedPath( *checker.problem, points, limits, settings );
	}
	const std::size_t n = timed.points.size();
	const NewArray<double> times( { n } ), positions( { n, rows.width } ), velocities( { n, rows.width } ),
	    accelerations( { n, rows.width } );
	for ( std::size_t i = 0; i < n; ++i )
	{
		const motions::TrajectoryPoint& point = timed.points[i];
		times.data[i] = point.time;
		std::copy( point.positions.begin(), point.positions.end(), positions.data + i * rows.width );
		std::copy( point.velocities.begin(), point.velocities.end(), velocities.data + i * rows.width );
		std::copy( point.accelerations.begin(), point.accelerations.end(), accelerations.data + i * rows.width );
	}
	return result( "Timed", nb::make_tuple( times.object, positions.object, velocities.object, accelerations.object ) );
}

nb::object analysePairs( const PyRobot& robot, double seconds, const Whole& samples, const Whole& seed,
    const Whole& never_after, const std::string& cache, bool srdf )
{
	pairs::Settings settings;
	settings.reach.cache = cache;
	settings.reach.def.seconds = seconds;
	constexpr std::uint64_t most = std::numeric_limits<std::uint32_t>::max();
	settings.samples = { static_cast<std::uint32_t>( samples.in( "samples", 0, most ) ), seed.seed(),
	    static_cast<std::uint32_t>( never_after.in( "never_after", 0, most ) ), interruptible() };
	settings.new_srdf = srdf;
	motions::Json json;
	{
		const nb::gil_scoped_release unlocked;
		const pairs::Analysis analysis( *robot.model, settings );
		json = toJson( analysis, *robot.model, settings );
		if ( analysis.srdf )
		{
			json["new_srdf"] = analysis.srdf->document.text;
		}
	}
	return dictOf( json );
}

nb::object tuneChecks( const PyChecker& checker, double min_d, double max_d, const std::string& check, std::size_t states,
    std::size_t edges, std::uint64_t seed, const std::string& target, double value, double rate )
{
	tune::Settings settings;
	settings.min_d = min_d;
	settings.max_d = max_d;
	settings.flags = checkFlags( check );
	settings.states = states;
	settings.motions = edges;
	settings.seed = seed;
	settings.rate = rate;
	settings.target.value = value;
	settings.target.kind = target == "microseconds"   ? tune::Target::TIME
	                       : target == "error"        ? tune::Target::ERROR
	                       : target == "conservatism" ? tune::Target::CONSERVATISM
	                                                  : tune::Target::NONE;
	settings.progress = interruptible();
	motions::Json json;
	{
		const nb::gil_scoped_release unlocked;
		json = toJson( tune::tune( *checker.problem, settings, checker.model->urdf_file ), settings );
	}
	return dictOf( json );
}

} // namespace

motions::TrajectoryFile trajectoryOf( const PyChecker& checker, const Doubles& times, const nb::object& positions,
    const nb::object& velocities, const nb::object& accelerations )
{
	motions::TrajectoryFile trajectory;
	trajectory.file = "trajectory";
	trajectory.joint_names = checker.problem->variable_names;
	const auto refuse = []( const std::string& text ) { throw nb::value_error( text.c_str() ); };
	const auto read = [&]( const nb::object& given, const char* name, std::vector<double> motions::TrajectoryPoint::*member )
	{
		if ( given.is_none() )
		{
			return;
		}
		const Doubles numbers = nb::cast<Doubles>( given );
		const Rows rows = rowsOf( numbers, checker.variables(), name, "variables of the group" );
		if ( trajectory.points.empty() )
		{
			trajectory.points.resize( rows.count );
		}
		if ( rows.count != trajectory.points.size() )
		{
			refuse( std::string( name ) + ": " + std::to_string( rows.count ) + " rows beside " +
			        std::to_string( trajectory.points.size() ) + " positions" );
		}
		for ( std::size_t i = 0; i < rows.count; ++i )
		{
			( trajectory.points[i].*member ).assign( rows[i], rows[i] + rows.width );
		}
	};
	if ( positions.is_none() )
	{
		refuse( "positions: are missing" );
	}
	read( positions, "positions", &motions::TrajectoryPoint::positions );
	const double* t = vectorOf( times, trajectory.points.size(), "times", "seconds, one for each position" );
	read( velocities, "velocities", &motions::TrajectoryPoint::velocities );
	read( accelerations, "accelerations", &motions::TrajectoryPoint::accelerations );
	if ( trajectory.points.size() < 2 || ( velocities.is_none() && !accelerations.is_none() ) )
	{
		refuse( "positions: a trajectory has at least 2, and velocities if it has accelerations" );
	}
	for ( std::size_t i = 0; i < trajectory.points.size(); ++i )
	{
		trajectory.points[i].time = t[i];
		if ( !std::isfinite( t[i] ) || ( i > 0 && !( t[i] > t[i - 1] ) ) )
		{
			refuse( "times[" + std::to_string( i ) + "]: is not after the time before it" );
		}
	}
	return trajectory;
}

void bindAudits( nb::module_& module, nb::class_<PyChecker>& type )
{
	constexpr double slack = 1e-3;
	const motions::AuditSettings usual;
	type.def( "audit", &auditPath, "path"_a, nb::kw_only(), "min_d"_a = nb::none(), "check"_a = "both",
	    "resolution"_a = usual.resolution, "seconds"_a = usual.time,
	    nb::sig(
	        "def audit(self, path: numpy.typing.ArrayLike | str | os.PathLike, *, min_d: float | None = None, check: str = 'both', "
	        "resolution: float = 0.0001, seconds: float = 60.0) -> dict[str, typing.Any]" ),
	    "Measures a path by dense exact states, without the proofs of edges: the audit of `leeway audit`.\n\n"
	    "path: float64 [n, dof], or a path file of `leeway plan`, whose other joints have to stand where the checker has them. min_d: of the file\n"
	    "unless given, else 0. resolution: metres, near contact no robot point moves farther between\n"
	    "two states. seconds: then it ends, and the path is not valid. Returns the program's report: valid, problems, states, length, and\n"
	    "of environment and self the least clearance with its pair and place, also between the states; profile in hundredths; notices, lines: what\n"
	    "was read and has no say." );
	type.def( "path_text", &pathText, "path"_a, nb::kw_only(), "min_d"_a = 0.0, "slack"_a = slack, "seed"_a = 0,
	    "planner"_a = "Leeway",
	    nb::sig(
	        "def path_text(self, path: numpy.typing.ArrayLike, *, min_d: float = 0.0, slack: float = 0.001, seed: int = 0, "
	        "planner: str = 'Leeway') -> str" ),
	    "The text of a path file, as `leeway plan --out` writes it, which `leeway audit --path` and `leeway view --path` read.\n\n"
	    "path: float64 [n, dof]. min_d, slack, seed, planner: what is written about it. Raises ValueError if an audit finds it invalid." );
	type.def( "audit_roundings", &auditRoundings, "path"_a, "radius"_a, nb::kw_only(), "min_d"_a = nb::none(),
	    "slack"_a = slack, "check"_a = "both", "tolerance"_a = nb::none(),
	    nb::sig(
	        "def audit_roundings(self, path: numpy.typing.ArrayLike | str | os.PathLike, radius: float, *, min_d: float | None = None, "
	        "slack: float = 0.001, check: str = 'both', tolerance: numpy.typing.ArrayLike | None = None) -> dict[str, typing.Any]" ),
	    "Proves a path and all roundings of its corners that stay within `radius` (radians, metres) of them: `leeway audit --corner-blend`.\n\n"
	    "Returns the program's report: verdict, corners, lower_bound, notices; not FREE: the point, pair, clearance, state, and free_radius. path, min_d: as for audit()." );
	type.def( "audit_trajectory", &auditTrajectory, "times"_a, "positions"_a = nb::none(), "velocities"_a = nb::none(),
	    "accelerations"_a = nb::none(), nb::kw_only(), "interpolation"_a = "auto", "joint_limits"_a = nb::none(),
	    "min_d"_a = 0.0, "slack"_a = slack, "check"_a = "both", "tolerance"_a = nb::none(),
	    nb::sig(
	        "def audit_trajectory(self, times: numpy.typing.ArrayLike | str | os.PathLike, positions: numpy.typing.ArrayLike | None = None, "
	        "velocities: numpy.typing.ArrayLike | None = None, accelerations: numpy.typing.ArrayLike | None = None, *, "
	        "interpolation: str = 'auto', joint_limits: str | os.PathLike | dict[str, dict[str, float]] | None = None, "
	        "min_d: float = 0.0, slack: float = 0.001, check: str = 'both', tolerance: numpy.typing.ArrayLike | None = None) -> "
	        "dict[str, typing.Any]" ),
	    "Proves a timed trajectory at all times, and compares its positions, velocities and accelerations with their limits: `leeway audit\n"
	    "--trajectory`.\n\n"
	    "times: a file (JointTrajectory, RobotTrajectory, DisplayTrajectory, FollowJointTrajectory goal, CSV), or float64 [n] seconds with\n"
	    "positions, velocities, accelerations float64 [n, dof]. joint_limits: MoveIt's joint_limits.yaml, or {joint: {\"max_velocity\": x,\n"
	    "\"max_acceleration\": y, \"max_jerk\": z}}; others are those of the URDF. tolerance: float64 [dof]. Returns the program's report: valid,\n"
	    "verdict, lower_bound, problems (limits, jumps), the first violation with time, pair, clearance and state; notices, lines: what was read and has no say, and\n"
	    "a way to a first point after 0 s that nobody proved." );
	type.def( "timed", &timedPath, "path"_a, nb::kw_only(), "joint_limits"_a = nb::none(),
	    "path_tolerance"_a = std::numeric_limits<double>::infinity(), "min_d"_a = 0.0, "slack"_a = slack, "check"_a = "both",
	    "tolerance"_a = nb::none(),
	    nb::sig(
	        "def timed(self, path: numpy.typing.ArrayLike, *, joint_limits: str | os.PathLike | dict[str, dict[str, float]] | None = None, "
	        "path_tolerance: float = float('inf'), min_d: float = 0.0, slack: float = 0.001, check: str = 'both', "
	        "tolerance: numpy.typing.ArrayLike | None = None) -> leeway.results.Timed" ),
	    "A fast trajectory along a proved path, at rest at both ends: the timing of `leeway plan --trajectory`. trajectory() proves it as it is driven.\n\n"
	    "path: float64 [n, dof], with free edges. joint_limits: as for audit_trajectory(), with max_jerk; else those of the URDF, an acceleration of 1 and\n"
	    "a jerk of 10 times that. path_tolerance: radians and metres, corners are rounded within it as far as they are proved free; 0: the robot stops\n"
	    "at each. min_d, slack, check, tolerance: of these proofs." );
	const pairs::Settings reach;
	module.def( "pairs", &analysePairs, "robot"_a, nb::kw_only(), "seconds"_a = 15.0,
	    "samples"_a.none() = reach.reach.def.samples, "seed"_a.none() = reach.reach.def.seed, "never_after"_a.none() = 0,
	    "cache"_a = "", "srdf"_a = false,
	    nb::sig( "def pairs(robot: Robot, *, seconds: float = 15.0, samples: int = 2000, seed: int = 1, "
	             "never_after: int = 0, cache: str = '', srdf: bool = False) -> dict[str, typing.Any]" ),
	    "The pairs of links that can ever meet, findings about the SRDF, and random states: the report of `leeway pairs`.\n\n"
	    "seconds: for proofs. samples: random states. never_after: disable also pairs without contact in so many states. srdf: make an\n"
	    "SRDF with computed pairs, its text is `new_srdf`. All cores work. Raises InputError." );
	module.def( "_tune", &tuneChecks );
}

} // namespace leeway::python
