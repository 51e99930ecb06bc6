// SPDX-License-Identifier: BSD-3-Clause
// leeway.TimedWorld: several robots and moving objects of a world file on one clock.
#include "objects.hpp"

#include "motions/report.hpp"
#include "motions/timed_robots.hpp"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <optional>

namespace leeway::python
{

namespace
{

using namespace nb::literals;

/// The world, its problem and its schedule. One call at a time: a mutex keeps others waiting.
struct PyTimedWorld
{
	PyTimedWorld( io::WorldModel read, double proof_seconds ) : world( std::move( read ) )
	{
		io::ProblemOptions options = io::worldProblem( world );
		options.find_reach = io::ReachOptions();
		options.find_reach->def.seconds = proof_seconds;
		problem = std::make_shared<const io::Problem>( io::buildProblem( world.robot, options ) );
		model = std::make_shared<const io::RobotModel>( world.robot );
		schedule = std::make_unique<motions::Schedule>( world, *problem );
	}

	io::WorldModel world;
	std::shared_ptr<const io::Problem> problem;
	std::shared_ptr<const io::RobotModel> model;
	std::unique_ptr<motions::Schedule> schedule;
	std::mutex mutex;
};

nb::list partsOf( const PyTimedWorld& self )
{
	nb::list out;
	for ( const io::WorldPart& part : self.world.parts )
	{
		nb::dict one;
		one["name"] = part.name;
		one["kind"] = part.kind == io::WorldPart::Kind::robot ? "robot" : "object";
		one["variables"] = nb::cast( part.variables );
		one["lag"] = part.lag;
		one["spread_speed"] = part.spread_speed;
		one["spread_start"] = part.spread_start;
		out.append( one );
	}
	return out;
}

void setMotion( PyTimedWorld& self, const std::string& part, const Doubles& times, const Doubles& positions )
{
	const std::size_t width = self.world.part( part ).variables.size();
	const Rows rows = rowsOf( positions, width, "positions", "variables of the part" );
	const double* at = vectorOf( times, rows.count, "times", "rows of positions" );
	std::vector<std::vector<double>> points;
	for ( std::size_t i = 0; i < rows.count; ++i )
	{
		points.emplace_back( rows[i], rows[i] + width );
	}
	const std::lock_guard<std::mutex> lock( self.mutex );
	self.schedule->add( part, { at, at + rows.count }, points );
}

nb::object stateOf( PyTimedWorld& self, double time )
{
	std::vector<double> q;
	{
		const std::lock_guard<std::mutex> lock( self.mutex );
		q = self.schedule->state( time );
	}
	const NewArray<double> array( { q.size() } );
	std::copy( q.begin(), q.end(), array.data );
	return array.object;
}

nb::object prove( PyTimedWorld& self, double start, const std::optional<double>& end, double min_d, double slack,
    const std::string& check, const std::optional<double>& resolution )
{
	motions::ScheduleSettings settings;
	settings.edge.min_d = min_d;
	settings.edge.slack = slack;
	settings.edge.flags = checkFlags( check );
	settings.contact_resolution = resolution.value_or( 0 );
	motions::ScheduleAudit audit;
	{
		const nb::gil_scoped_release unlocked;
		const std::lock_guard<std::mutex> lock( self.mutex );
		settings.from = start;
		settings.to = end.value_or( std::max( start, self.schedule->duration() ) );
		if ( !( settings.from <= settings.to ) )
		{
			throw io::Error( self.world.file, "prove", "end is before start", "give a later end" );
		}
		audit = motions::auditSchedule( *self.schedule, settings );
	}
	return dictOf( toJson( audit ) );
}

struct PlanArguments
{
	double deadline, start, seconds, min_d, slack;
	std::string check;
	std::uint64_t seed;
	bool together;
};

planners::TimedRobot robotOf( PyTimedWorld& self, const std::string& name, const Doubles& goal, const PlanArguments& a )
{
	const std::size_t count = self.world.part( name ).variables.size();
	const Rows goals = rowsOf( goal, count, "goal", "variables of the part" );
	planners::TimedRobot robot = motions::timedRobot( self.world, *self.schedule, name, {}, a.start );
	for ( std::size_t i = 0; i < goals.count; ++i )
	{
		robot.goals.push_back( motions::goalOf( self.world, *self.schedule, robot, { goals[i], goals[i] + goals.width } ) );
	}
	return robot;
}

nb::object plan( PyTimedWorld& self, const nb::dict& goals, const PlanArguments& a )
{
	std::vector<planners::TimedRobot> robots;
	const std::lock_guard<std::mutex> lock( self.mutex );
	for ( const auto& [name, goal] : goals )
	{
		robots.push_back( robotOf( self, nb::cast<std::string>( name ), nb::cast<Doubles>( goal ), a ) );
	}
	planners::ScheduleSettings settings;
	settings.timed.timed.edge.min_d = a.min_d;
	settings.timed.timed.edge.slack = a.slack;
	settings.timed.timed.edge.flags = checkFlags( a.check );
	settings.timed.start_time = a.start;
	settings.timed.deadline = a.deadline;
	settings.timed.seed = a.seed;
	settings.together = a.together;
	settings.search_seconds = a.seconds;
	planners::SchedulePlan made;
	{
		const nb::gil_scoped_release unlocked;
		const Query query = makeQuery( self.problem->checker.get() );
		made = motions::planBeside( self.world, *self.schedule, query.get(), robots, settings );
	}
	nb::dict out;
	out["solved"] = made.outcome == planners::Outcome::SOLVED;
	out["outcome"] = planners::name( made.outcome );
	out["problem"] = made.problem;
	out["lower_bound"] = made.proof.lower_bound;
	out["proved_until"] = made.proof.proved_until;
	nb::dict paths;
	for ( std::size_t r = 0; r < made.paths.size(); ++r )
	{
		const planners::TimedPath& path = made.paths[r];
		const std::size_t width = self.world.part( robots[r].name ).variables.size();
		const NewArray<double> times( { path.count() } ), positions( { path.count(), width } );
		std::copy( path.times.begin(), path.times.end(), times.data );
		for ( std::size_t i = 0; i < path.count(); ++i )
		{
			const std::vector<double> whole = motions::wholePoint( self.world, *self.schedule, robots[r], path[i] );
			std::copy( whole.begin(), whole.end(), positions.data + i * width );
		}
		paths[robots[r].name.c_str()] = nb::make_tuple( times.object, positions.object );
	}
	out["paths"] = paths;
	nb::list order;
	for ( const std::size_t r : made.order )
	{
		order.append( robots[r].name );
	}
	out["order"] = order;
	return out;
}

} // namespace

void bindTimedWorlds( nb::module_& module )
{
	constexpr double default_slack = 1e-3;
	nb::class_<PyTimedWorld> type( module, "TimedWorld",
	    "Several robots and objects that move, of a world file, on one clock (ompl_bridge/docs/worlds.md). Metres, radians, seconds.\n"
	    "Calls of several threads take turns." );
	type.def(
	    "__init__",
	    []( PyTimedWorld* self, const std::string& file, const std::vector<std::string>& packages, const std::string& cache,
	        double proof_seconds )
	    {
		    const nb::gil_scoped_release unlocked;
		    io::LoadOptions options;
		    options.package_paths = packages;
		    options.cache = cache;
		    new ( self ) PyTimedWorld( io::loadWorld( file, options ), proof_seconds );
	    },
	    "file"_a, nb::kw_only(), "packages"_a = std::vector<std::string>(), "cache"_a = "",
	    "proof_seconds"_a = io::default_proof_seconds,
	    "Reads a world file. packages, cache: as for Robot. proof_seconds: for the tables of pairs that never meet.\n"
	    "Raises InputError that names file, element and remedy." );
	type.def_prop_ro( "parts", &partsOf,
	    "Robots, then objects that move: dicts with name, kind ('robot', 'object'), variables, lag, spread_speed, spread_start." );
	type.def_prop_ro(
	    "files", []( const PyTimedWorld& self ) { return self.world.files; },
	    "Files that the world names, and itself: robots, SRDFs, motions, the scene. Not those of meshes." );
	type.def_prop_ro(
	    "digest", []( const PyTimedWorld& self ) { return digestText( lw_robot_digest( self.problem->robot.get() ) ); },
	    "Robot.digest of the one robot that the world is read into." );
	type.def_prop_ro(
	    "variables", []( const PyTimedWorld& self ) { return self.problem->variable_names; },
	    "Names of the entries of a state: all joints of all parts." );
	type.def_prop_ro(
	    "duration",
	    []( PyTimedWorld& self )
	    {
		    const std::lock_guard<std::mutex> lock( self.mutex );
		    return self.schedule->duration();
	    },
	    "Seconds at which the last motion ends; of loops, the first time around." );
	type.def_prop_ro(
	    "checker", []( const PyTimedWorld& self ) { return PyChecker( self.problem, self.model ); },
	    "The Checker of all joints, for states(), edges(), near() and others at one time." );
	type.def( "set_motion", &setMotion, "part"_a, "times"_a, "positions"_a,
	    nb::sig(
	        "def set_motion(self, part: str, times: numpy.typing.ArrayLike, positions: numpy.typing.ArrayLike) -> None" ),
	    "Replaces a part's motion. times: float64 [n], increasing; positions: float64 [n, variables of the part], joined straight." );
	type.def( "state", &stateOf, "time"_a, nb::sig( "def state(self, time: float) -> numpy.ndarray" ),
	    "float64 [variables] at a time." );
	type.def(
	    "prove",
	    []( PyTimedWorld& self, double start, const std::optional<double>& end, double min_d, double slack,
	        const std::string& check, const std::optional<double>& contact_resolution )
	    { return prove( self, start, end, min_d, slack, check, contact_resolution ); },
	    nb::kw_only(), "start"_a = 0.0, "end"_a = nb::none(), "min_d"_a = 0.0, "slack"_a = default_slack, "check"_a = "both",
	    "contact_resolution"_a = nb::none(),
	    nb::sig(
	        "def prove(self, *, start: float = 0.0, end: float | None = None, min_d: float = 0.0, slack: float = 0.001, "
	        "check: str = 'both', contact_resolution: float | None = None) -> dict" ),
	    "Proves that all clearances stay above min_d from start to end (None: when the last motion ends), for all motions that lags,\n"
	    "tolerances and unknown motions allow. contact_resolution: seconds to which the first contact is searched for.\n\n"
	    "Returns the report of `leeway world audit --json`: verdict, valid, time, proved_until, pair, lower_bound, ..." );
	type.def(
	    "plan",
	    []( PyTimedWorld& self, const nb::dict& goals, double deadline, double start, bool together, double seconds,
	        const Whole& seed, double min_d, double slack, const std::string& check ) {
		    return plan( self, goals, { deadline, start, seconds, min_d, slack, check, seed.seed(), together } );
	    },
	    "goals"_a, nb::kw_only(), "deadline"_a, "start"_a = 0.0, "together"_a = false, "seconds"_a = 10.0,
	    "seed"_a.none() = 1, "min_d"_a = 0.0, "slack"_a = default_slack, "check"_a = "both",
	    nb::sig(
	        "def plan(self, goals: dict[str, numpy.typing.ArrayLike], *, deadline: float, start: float = 0.0, together: bool = False, "
	        "seconds: float = 10.0, seed: int = 1, min_d: float = 0.0, slack: float = 0.001, check: str = 'both') -> dict" ),
	    "Plans robots from where they stand at `start` to goals by `deadline`, beside all else. goals: for each robot float64 [variables of\n"
	    "the part], or alternatives [k, variables]. One after the other, in the first order that works, or together in one search; seconds:\n"
	    "of each search. Velocities are those of the robot's description. Clearances of everything count.\n\n"
	    "Returns a dict: solved, outcome, problem (why not), lower_bound, proved_until, order, and paths: by robot (times [n],\n"
	    "positions [n, variables]) for set_motion(). Nothing is set." );
}

} // namespace leeway::python
