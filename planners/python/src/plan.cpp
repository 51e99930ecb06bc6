// SPDX-License-Identifier: BSD-3-Clause
// Checker.plan(): arrays in, arrays out. Checker.plan_request(): plans that keep a request's constraints along the path; a request in Python is a mapping
// in the shape of MoveIt's message, which is read as its file would be.
#include "constrained.hpp"

#include "leeway/manifold/plan.hpp"
#include "leeway/motions/path_constraints.hpp"
#include "leeway/planners/planner.h"
#include "leeway/sequence/sequence.hpp"

#include <nanobind/eval.h>
#include <nanobind/stl/string.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <future>
#include <limits>

namespace leeway::python
{

namespace
{

using namespace nb::literals;

struct PlanGuard
{
	lw_plan_result result{};
	~PlanGuard() { lw_plan_result_clear( &result ); }
};

/// Ctrl-C ends the search.
lw_status planInterruptibly( lw_plan_def def, lw_diag& diag, lw_plan_result& out )
{
	lw_plan_cancel cancel{};
	def.cancel = &cancel;
	lw_status status = LW_OK;
	workInterruptibly( [&] { status = lw_plan( &def, &diag, &out ); }, [&] { lw_plan_request_cancel( &cancel ); } );
	return status;
}

nb::dict statisticsOf( const lw_plan_result& r )
{
	const lw_plan_statistics& s = r.statistics;
	nb::dict out;
	out["samples"] = s.samples;
	out["states"] = s.states;
	out["edges"] = s.edges;
	out["free"] = s.free;
	out["blocked"] = s.blocked;
	out["undecided"] = s.undecided;
	out["edge_queries"] = s.edge_queries;
	out["start_nodes"] = s.start_nodes;
	out["goal_nodes"] = s.goal_nodes;
	return out;
}

nb::dict clearanceOf( const lw_plan_clearance& c )
{
	const auto range = []( const lw_plan_range& r ) { return nb::make_tuple( r.lower, r.upper ); };
	nb::dict out;
	out["before"] = range( c.before );
	out["after"] = range( c.after );
	out["middle_before"] = range( c.middle_before );
	out["middle_after"] = range( c.middle_after );
	out["ends"] = c.ends;
	return out;
}

nb::object resultOf( const lw_plan_result& r, double min_d, double slack, bool pushed )
{
	nb::object clearance = nb::none();
	if ( pushed && r.states != nullptr )
	{
		nb::dict both;
		both["environment"] = clearanceOf( r.environment_clearance );
		both["self"] = clearanceOf( r.self_clearance );
		clearance = both;
	}
	nb::object states = nb::none();
	if ( r.states != nullptr )
	{
		const NewArray<double> array( { r.state_count, r.variable_count } );
		std::copy( r.states, r.states + std::size_t( r.state_count ) * r.variable_count, array.data );
		states = array.object;
	}
	const NewArray<double> improvements( { r.improvement_count, 2 } );
	std::copy( r.improvements, r.improvements + std::size_t( r.improvement_count ) * 2, improvements.data );
	return result( "Plan", nb::make_tuple( nb::cast( r.outcome ), states, r.length, r.raw_length, r.seconds, r.seed,
	                           nb::str( r.message ), statisticsOf( r ), improvements.object, min_d, slack, clearance ) );
}

/// Numbers that plan() and lw_plan_def share.
struct Numbers
{
	double seconds, min_d, slack, range, optimize_seconds, clearance_goal, clearance_seconds;
	std::uint64_t seed, most_nodes, optimize_samples;
	std::uint32_t threads;
	bool smooth;
};

nb::object plan( const PyChecker& checker, const Doubles& start, const Doubles& goal, const Numbers& n,
    const std::string& check, const nb::object& lower, const nb::object& upper )
{
	const Rows starts = rowsOf( start, checker.variables(), "start", "variables of the group" );
	const Rows goals = rowsOf( goal, checker.variables(), "goal", "variables of the group" );
	lw_plan_def def = lw_plan_def_default();
	def.checker = checker.get();
	def.starts = starts.data;
	def.start_count = static_cast<std::uint32_t>( starts.count );
	def.goals = goals.data;
	def.goal_count = static_cast<std::uint32_t>( goals.count );
	Doubles keep_lower, keep_upper;
	if ( !lower.is_none() )
	{
		keep_lower = nb::cast<Doubles>( lower );
		def.lower = vectorOf( keep_lower, checker.variables(), "lower", "variables of the group" );
	}
	if ( !upper.is_none() )
	{
		keep_upper = nb::cast<Doubles>( upper );
		def.upper = vectorOf( keep_upper, checker.variables(), "upper", "variables of the group" );
	}
	def.edge.min_d = n.min_d;
	def.edge.slack = n.slack;
	def.edge.flags = checkFlags( check );
	def.range = n.range;
	def.seed = n.seed;
	def.threads = n.threads;
	def.most_nodes = n.most_nodes;
	def.seconds = n.seconds;
	def.smooth = n.smooth;
	def.optimize_seconds = n.optimize_seconds;
	def.optimize_samples = n.optimize_samples;
	def.clearance_goal = n.clearance_goal;
	def.clearance_seconds = n.clearance_seconds;
	PlanGuard guard;
	lw_diag diag{};
	require( planInterruptibly( def, diag, guard.result ), diag );
	return resultOf( guard.result, n.min_d, n.slack, n.clearance_goal > 0 );
}

} // namespace

void workInterruptibly( const std::function<void()>& work, const std::function<void()>& cancel )
{
	bool interrupted = false;
	{
		const nb::gil_scoped_release unlocked;
		std::future<void> done = std::async( std::launch::async, work );
		while ( done.wait_for( std::chrono::milliseconds( 50 ) ) != std::future_status::ready )
		{
			const nb::gil_scoped_acquire locked;
			if ( !interrupted && PyErr_CheckSignals() != 0 )
			{
				interrupted = true;
				cancel();
			}
		}
		try
		{
			done.get();
		}
		catch ( ... ) // after Ctrl-C the caller gets KeyboardInterrupt in place of this error
		{
			if ( !interrupted )
			{
				throw;
			}
		}
	}
	if ( interrupted )
	{
		throw nb::python_error();
	}
}

void bindPlans( nb::module_&, nb::class_<PyChecker>& type )
{
	constexpr double infinity = std::numeric_limits<double>::infinity();
	const lw_plan_def def = lw_plan_def_default();
	type.def(
	    "plan",
	    []( const PyChecker& checker, const Doubles& start, const Doubles& goal, double seconds, const Whole& seed,
	        const Whole& threads, double min_d, double slack, const std::string& check, double range, bool smooth,
	        double optimize_seconds, const Whole& optimize_samples, const Whole& most_nodes, const nb::object& lower,
	        const nb::object& upper, double clearance_goal, double clearance_seconds )
	    {
		    constexpr std::uint64_t most = std::numeric_limits<std::uint64_t>::max();
		    return plan( checker, start, goal,
		        { seconds, min_d, slack, range, optimize_seconds, clearance_goal, clearance_seconds, seed.seed(),
		            most_nodes.in( "most_nodes", 2, std::numeric_limits<std::uint32_t>::max() ),
		            optimize_samples.in( "optimize_samples", 0, most ), threads.threads(), smooth },
		        check, lower, upper );
	    },
	    "start"_a, "goal"_a, nb::kw_only(), "seconds"_a = infinity, "seed"_a.none() = 1, "threads"_a.none() = 1,
	    "min_d"_a = 0.0, "slack"_a = 1e-3, "check"_a = "both", "range"_a = 0.0, "smooth"_a = true,
	    "optimize_seconds"_a = 0.0, "optimize_samples"_a.none() = def.optimize_samples,
	    "most_nodes"_a.none() = def.most_nodes, "lower"_a = nb::none(), "upper"_a = nb::none(), "clearance_goal"_a = 0.0,
	    "clearance_seconds"_a = def.clearance_seconds,
	    nb::sig(
	        "def plan(self, start: numpy.typing.ArrayLike, goal: numpy.typing.ArrayLike, *, seconds: float = float('inf'), "
	        "seed: int = 1, threads: int = 1, min_d: float = 0.0, slack: float = 0.001, check: str = 'both', range: float = 0.0, "
	        "smooth: bool = True, optimize_seconds: float = 0.0, optimize_samples: int = ..., most_nodes: int = ..., "
	        "lower: numpy.typing.ArrayLike | None = None, upper: numpy.typing.ArrayLike | None = None, "
	        "clearance_goal: float = 0.0, clearance_seconds: float = 0.01) -> leeway.results.Plan" ),
	    "Searches a path from a start to a goal; every edge of it is proved FREE.\n\n"
	    "start, goal: float64 [dof], or alternatives [k, dof], radians and metres. seconds: of the clock, for search and smoothing.\n"
	    "seed: equal seeds give equal paths unless time ends the work or threads > 1. threads: searches side by side. min_d, slack:\n"
	    "metres, as for edges(). range: longest edge of the search, 0 = a length that suits the robot. smooth: shortcuts, proved again.\n"
	    "optimize_seconds, optimize_samples: after the first path look for shorter ones. lower, upper: float64 [dof], bounds of the\n"
	    "samples in place of joint limits. clearance_goal: metres above min_d, up to which the path is pushed away from obstacles and links, for\n"
	    "clearance_seconds (infinity: until nothing is gained, so that equal seeds give equal paths); the path gets at most a tenth longer.\n\n"
	    "Returns a Plan: outcome (leeway.Outcome), path float64 [n, dof] or None, length, ... ; message has the reasons without a path.\n"
	    "Ctrl-C ends the search. Raises CoreError for an end outside of the bounds." );
}

// ---- constraints along the path --------------------------------------------------------------------------------------

namespace
{

std::vector<double> limitOf(
    const PyChecker& checker, const nb::object& given, const char* name, std::vector<double> otherwise )
{
	if ( given.is_none() )
	{
		return otherwise;
	}
	const Doubles numbers = nb::cast<Doubles>( given );
	const double* values = vectorOf( numbers, checker.variables(), name, "variables of the group" );
	return { values, values + checker.variables() };
}

/// Arrays and numbers of NumPy are lists and numbers of the message.
std::string jsonOf( const nb::dict& message )
{
	const nb::object plain = nb::eval( "lambda value: value.tolist()" );
	return nb::cast<std::string>( nb::module_::import_( "json" ).attr( "dumps" )( message, "default"_a = plain ) );
}

/// A mapping without a start or a goal gets those of the arguments: the reader wants both.
std::string textOf( const PyChecker& checker, const nb::object& request, const double* goal )
{
	const nb::dict all = nb::cast<nb::dict>( nb::module_::import_( "builtins" ).attr( "dict" )( request ) );
	if ( !all.contains( "start_state" ) )
	{
		all["start_state"] = nb::dict();
	}
	if ( goal != nullptr )
	{
		nb::list joints;
		for ( std::size_t i = 0; i < checker.variables(); ++i )
		{
			nb::dict joint;
			joint["joint_name"] = checker.problem->variable_names[i];
			joint["position"] = goal[i];
			joints.append( joint );
		}
		nb::dict constraints;
		constraints["joint_constraints"] = joints;
		nb::list one;
		one.append( constraints );
		all["goal_constraints"] = one;
	}
	return jsonOf( all );
}

struct Asked
{
	io::PathConstraints path;
	io::Request request;
	std::vector<double> start;
};

/// @throws io::Error if joints outside of the group stand elsewhere than those of the checker
std::vector<double> startOf( const io::Problem& problem, const io::Request& request )
{
	std::vector<double> q = io::startState( problem );
	for ( const auto& [name, value] : request.start.values )
	{
		const auto found = std::find( problem.variable_names.begin(), problem.variable_names.end(), name );
		if ( found != problem.variable_names.end() )
		{
			q[static_cast<std::size_t>( found - problem.variable_names.begin() )] = value;
			continue;
		}
		for ( std::uint32_t v = 0; v < problem.reference.size(); ++v )
		{
			if ( io::variableName( problem.robot.get(), v ) == name && problem.reference[v] != value )
			{
				throw io::Error( request.file, "start_state " + name,
				    "is a joint outside of the group, and stands elsewhere in the checker",
				    "make the checker with this value in `reference`" );
			}
		}
	}
	return q;
}

/// @throws io::Error
void requireGroup( const PyChecker& checker, const io::Request& request )
{
	if ( !request.group.empty() && request.group != checker.problem->group )
	{
		throw io::Error( request.file, "group_name",
		    "is " + request.group + ", and the checker is of group '" + checker.problem->group + "'",
		    "make a checker of the group of the request" );
	}
}

/// The given start, else that of the request.
std::vector<double> startOr( const PyChecker& checker, const nb::object& start, const io::Request& request )
{
	if ( start.is_none() )
	{
		return startOf( *checker.problem, request );
	}
	const Doubles numbers = nb::cast<Doubles>( start );
	const double* values = vectorOf( numbers, checker.variables(), "start", "variables of the group" );
	return { values, values + checker.variables() };
}

Asked askedOf( const PyChecker& checker, const nb::object& request, const nb::object& start, const nb::object& goal )
{
	Asked asked;
	Doubles keep_goal;
	const double* goal_values = nullptr;
	if ( !goal.is_none() )
	{
		keep_goal = nb::cast<Doubles>( goal );
		goal_values = vectorOf( keep_goal, checker.variables(), "goal", "variables of the group" );
	}
	const bool is_file = nb::isinstance<nb::str>( request ) || nb::hasattr( request, "__fspath__" );
	const std::string file =
	    is_file ? nb::cast<std::string>( nb::module_::import_( "os" ).attr( "fspath" )( request ) ) : "request";
	asked.request = is_file ? io::loadConstrainedRequest( file, asked.path )
	                        : io::parseConstrainedRequest( file, textOf( checker, request, goal_values ), asked.path );
	if ( !asked.path.items.empty() || asked.path.way )
	{
		throw io::Error( asked.request.file, asked.path.way ? "waypoints" : "items", "are no motion to a goal",
		    "give them to plan_sequence()" );
	}
	if ( is_file && goal_values != nullptr )
	{
		throw nb::value_error( "goal: the request is a file, which has a goal; give the request as a mapping" );
	}
	requireGroup( checker, asked.request );
	asked.start = startOr( checker, start, asked.request );
	return asked;
}

/// The time of the argument, else of the request; and whether there are shortcuts.
void setWork( manifold::Settings& settings, double seconds, bool smooth, const io::Request& request )
{
	settings.seconds = std::isfinite( seconds )            ? seconds
	                   : request.allowed_planning_time > 0 ? request.allowed_planning_time
	                                                       : settings.seconds;
	settings.shortcuts = smooth ? settings.shortcuts : 0;
}

/// Outcomes that are errors of the request.
void requireUsable( const manifold::Result& plan, const std::string& file )
{
	using manifold::Outcome;
	const bool start = plan.outcome == Outcome::START_BROKEN || plan.outcome == Outcome::START_NOT_FREE;
	const bool goal = plan.outcome == Outcome::GOALS_BROKEN || plan.outcome == Outcome::GOALS_NOT_FREE;
	if ( start || goal || plan.outcome == Outcome::EXCLUDED )
	{
		throw io::Error( file,
		    start  ? "start_state"
		    : goal ? "goal_constraints"
		           : "path_constraints",
		    manifold::summary( plan ),
		    plan.outcome == Outcome::START_BROKEN ? "start where they are kept, or give mend_start=True"
		    : start || goal                       ? "choose another state"
		                                          : "widen their tolerances, or remove one" );
	}
}

/// Times, positions and velocities; empty unless solved.
struct PointArrays
{
	PointArrays( const motions::TrajectoryFile& file, bool solved, std::size_t variables )
	    : count( solved ? file.points.size() : 0 ), times( { count } ), positions( { count, variables } ),
	      velocities( { count, variables } )
	{
		for ( std::size_t i = 0; i < count; ++i )
		{
			times.data[i] = file.points[i].time;
			std::copy_n( file.points[i].positions.begin(), variables, positions.data + i * variables );
			std::copy_n( file.points[i].velocities.begin(), variables, velocities.data + i * variables );
		}
	}
	const std::size_t count;
	const NewArray<double> times, positions, velocities;
};

/// Points of the trajectory, proved as its reader drives it.
nb::object planOf( const PyChecker& checker, const manifold::Result& plan, const std::vector<double>& start,
    const io::PathConstraints& path, const motions::TrajectorySettings& as_driven )
{
	const std::size_t count = checker.variables();
	motions::TrajectoryFile file;
	std::string message = plan.solved() ? std::string() : manifold::describe( plan );
	bool solved = plan.solved();
	if ( solved )
	{
		const io::Problem& problem = *checker.problem;
		file = motions::endsOf( problem, plan.segments, start );
		const std::vector<motions::Segment> segments =
		    motions::segmentsOf( problem, file, motions::Interpolation::automatic, 0 );
		const motions::TrajectoryAudit audit =
		    motions::auditTrajectory( problem, *checker.model, "the plan", segments, as_driven );
		std::vector<motions::Segment> kept;
		std::copy_if( segments.begin(), segments.end(), std::back_inserter( kept ),
		    [&]( const motions::Segment& segment ) { return segment.begin > plan.mended - 1e-9; } );
		const std::vector<motions::ConstraintProof> proofs = motions::proveConstraints( problem, path, kept, {} );
		solved = audit.valid() && motions::areKept( proofs );
		message = solved ? message : motions::describe( audit ) + motions::describe( proofs );
	}
	const PointArrays points( file, solved, count );
	return result( "ConstrainedPlan",
	    nb::make_tuple( solved, points.times.object, points.positions.object, points.velocities.object, plan.mended,
	        plan.length, plan.straight, plan.bent, plan.rests, plan.search_seconds, message.c_str() ) );
}

nb::object planRequest( const PyChecker& checker, const nb::object& request, const nb::object& start, const nb::object& goal,
    bool mend_start, double seconds, const Whole& seed, double min_d, double slack, const std::string& check, bool smooth,
    const nb::object& velocity, const nb::object& acceleration )
{
	const io::Problem& problem = *checker.problem;
	const Asked asked = askedOf( checker, request, start, goal );
	manifold::Settings settings{ settingsOf( checker, min_d, slack, check, seed, velocity, acceleration ) };
	setWork( settings, seconds, smooth, asked.request );
	manifold::Task task;
	task.start = asked.start;
	task.mend_start = mend_start;
	motions::TrajectorySettings as_driven;
	as_driven.edge = settings.edge;
	manifold::Result plan;
	std::atomic<bool> stopped = false;
	settings.stop = [&stopped] { return stopped.load(); };
	workInterruptibly(
	    [&]
	    {
		    task.goals = manifold::constrainedGoals(
		        *checker.model, problem, asked.request, asked.path, settings.edge, settings.seed );
		    plan = manifold::planPath( *checker.model, problem, asked.path, task, settings );
	    },
	    [&stopped] { stopped = true; } );
	requireUsable( plan, asked.request.file );
	return planOf( checker, plan, task.start, asked.path, as_driven );
}

// ---- sequences -------------------------------------------------------------------------------------------------------

/// An array in place of a request, for a group of joints.
struct Goals
{
	std::size_t item;
	Doubles states;
	std::string group; ///< empty: that of the checker
};

/// An array in the place of a request is goals: the place gets a goal that the reader takes.
void takeGoals( nb::dict& item, std::size_t index, std::vector<Goals>& goals )
{
	if ( !nb::hasattr( item["req"], "keys" ) )
	{
		goals.push_back( { index, nb::cast<Doubles>( item["req"] ), "" } );
		item["req"] = nb::eval( "{'goal_constraints': [{'joint_constraints': [{'joint_name': '', 'position': 0}]}]}" );
		if ( item.contains( "group_name" ) )
		{
			goals.back().group = nb::cast<std::string>( item["group_name"] );
			nb::del( item["group_name"] );
		}
	}
}

/// The world that changes of the scene begin with, and other groups; empty without both. @throws io::Error
std::shared_ptr<const io::World> worldOf( const PyChecker& checker, const std::vector<sequence::Leg>& legs )
{
	const auto needs = std::find_if( legs.begin(), legs.end(),
	    [&]( const auto& leg )
	    { return !leg.scene.empty() || !( leg.group.empty() || leg.group == checker.problem->group ); } );
	if ( needs == legs.end() )
	{
		return nullptr;
	}
	const std::string what = needs->scene.empty() ? "moves another group than the checker's" : "changes the scene";
	const auto wrong = [&]( const std::string& problem, const char* remedy )
	{ throw io::Error( needs->scene.file.empty() ? "sequence" : needs->scene.file, needs->element, problem, remedy ); };
	checker.world ? void() : wrong( what + ", and the checker was not made of a scene", "call Checker( robot, scene )" );
	auto copy = std::make_shared<const io::World>( *checker.world );
	copy->problem() == checker.of_world
	    ? void()
	    : wrong( what + ", and the World of the checker has changed since", "take the World's checker of now" );
	return copy;
}

/// Arrays among the items are goals.
io::PathConstraints itemsOf( const nb::object& items, io::Request& request, std::vector<Goals>& goals )
{
	io::PathConstraints path;
	const bool is_file = nb::isinstance<nb::str>( items ) || nb::hasattr( items, "__fspath__" );
	if ( is_file )
	{
		request = io::loadConstrainedRequest(
		    nb::cast<std::string>( nb::module_::import_( "os" ).attr( "fspath" )( items ) ), path );
	}
	else
	{
		const nb::object builtins = nb::module_::import_( "builtins" );
		const bool is_message = nb::hasattr( items, "keys" );
		nb::list list;
		for ( const nb::handle item : is_message ? nb::object( items["items"] ) : items )
		{
			nb::dict one;
			if ( !nb::hasattr( item, "keys" ) )
			{
				one["req"] = item;
				takeGoals( one, nb::len( list ), goals );
			}
			else if ( nb::cast<bool>( item.attr( "__contains__" )( "req" ) ) )
			{
				one = nb::cast<nb::dict>( builtins.attr( "dict" )( item ) );
				takeGoals( one, nb::len( list ), goals );
			}
			else
			{
				one["req"] = builtins.attr( "dict" )( item );
			}
			if ( nb::len( list ) == 0 )
			{
				const nb::dict req = nb::cast<nb::dict>( builtins.attr( "dict" )( one["req"] ) );
				req.contains( "start_state" ) ? void() : void( req["start_state"] = nb::dict() );
				one["req"] = req;
			}
			list.append( one );
		}
		nb::dict all;
		all["items"] = list;
		request = io::parseConstrainedRequest( "sequence", jsonOf( all ), path );
	}
	if ( path.items.empty() )
	{
		throw io::Error( request.file, "items", "are missing", "give a file with items, or call plan_request()" );
	}
	return path;
}

/// The scenes of a plan that goes somewhere, as driven. @param world empty: the scene of the checker
std::vector<sequence::Chapter> chaptersOf( const PyChecker& checker, const io::World* world,
    const std::vector<sequence::Leg>& legs, const sequence::Result& plan, const std::vector<motions::Segment>& segments,
    const std::vector<double>& start )
{
	return world != nullptr ? sequence::chaptersOf( *world, legs, plan, segments, start )
	                        : std::vector<sequence::Chapter>{ { checker.problem, 0, legs.size(), segments } };
}

/// Begin and end of each leg, [legs, 2]; the checker of each leg.
nb::object sequenceOf( const PyChecker& checker, const io::PathConstraints& path, const sequence::Result& plan,
    const std::vector<sequence::Leg>& steps, const io::World* world, const std::vector<double>& start,
    const motions::TrajectorySettings& as_driven )
{
	const io::Problem& problem = *checker.problem;
	motions::TrajectoryFile file;
	std::vector<sequence::Chapter> chapters;
	std::string message = plan.solved ? std::string() : sequence::describe( plan );
	bool solved = plan.solved;
	if ( solved )
	{
		file = motions::endsOf( problem, plan.segments, start );
		const std::vector<motions::Segment> segments =
		    motions::segmentsOf( problem, file, motions::Interpolation::automatic, 0 );
		chapters = chaptersOf( checker, world, steps, plan, segments, start );
		const motions::TrajectoryAudit audit =
		    sequence::auditChapters( *checker.model, chapters, "the sequence", as_driven );
		solved = audit.valid();
		message = solved ? message : motions::describe( audit );
		const std::vector<std::vector<motions::ConstraintProof>> proofs =
		    sequence::proveLegs( chapters, path, plan, segments );
		for ( std::size_t i = 0; i < proofs.size(); ++i )
		{
			const bool kept = motions::areKept( proofs[i] );
			solved = solved && kept;
			message += kept ? std::string() : path.items[i].element + ": " + motions::describe( proofs[i] );
		}
	}
	const PointArrays points( file, solved, checker.variables() );
	const NewArray<double> legs( { solved ? plan.legs.size() : 0, 2 } );
	for ( std::size_t i = 0; solved && i < plan.legs.size(); ++i )
	{
		legs.data[2 * i] = plan.legs[i].begin;
		legs.data[2 * i + 1] = plan.legs[i].begin + plan.legs[i].seconds;
	}
	nb::list checkers;
	for ( std::size_t i = 0; solved && i < chapters.size(); ++i )
	{
		const nb::object one = nb::cast( PyChecker( chapters[i].problem, checker.model ) );
		for ( std::size_t k = 0; k < chapters[i].legs; ++k )
		{
			checkers.append( one );
		}
	}
	const nb::object failed = plan.solved ? nb::none() : nb::cast( plan.failed );
	return result(
	    "Sequence", nb::make_tuple( solved, points.times.object, points.positions.object, points.velocities.object,
	                    legs.object, failed, plan.plan_seconds, message.c_str(), nb::tuple( checkers ) ) );
}

/// With arrays as goals. @throws io::Error
std::vector<sequence::Leg> legsOf(
    const PyChecker& checker, const io::PathConstraints& path, const std::vector<Goals>& goals, const lines::Task& line )
{
	std::vector<sequence::Leg> legs = sequence::legsOf( path, line );
	for ( const Goals& own : goals )
	{
		sequence::Leg& leg = legs[own.item];
		leg.group = own.group;
		const std::size_t count =
		    own.group.empty() ? checker.variables() : io::groupVariables( *checker.model, own.group ).size();
		const Rows rows = rowsOf( own.states, count, "items", "variables of the group" );
		leg.request.reset();
		for ( std::size_t k = 0; k < rows.count; ++k )
		{
			leg.goals.emplace_back( rows[k], rows[k] + count );
		}
	}
	return legs;
}

nb::object planSequence( const PyChecker& checker, const nb::object& items, const nb::object& start, const nb::object& tip,
    const nb::object& free_axis, double tolerance, double angle, double speed, double seconds, const Whole& seed,
    double min_d, double slack, const std::string& check, bool smooth, const nb::object& velocity,
    const nb::object& acceleration, const Whole& goal_states )
{
	const io::Problem& problem = *checker.problem;
	io::Request request;
	std::vector<Goals> goals;
	const io::PathConstraints path = itemsOf( items, request, goals );
	lines::Task line;
	line.tip.pose = poseOrIdentity( tip, "tip" );
	line.tolerance = tolerance;
	line.angle = angle;
	line.speed = speed;
	if ( !free_axis.is_none() )
	{
		const Doubles numbers = nb::cast<Doubles>( free_axis );
		const double* axis = vectorOf( numbers, 3, "free_axis", "numbers" );
		line.free_axis = lw_vec3{ axis[0], axis[1], axis[2] };
	}
	const std::vector<sequence::Leg> legs = legsOf( checker, path, goals, line );
	sequence::Settings settings{ { settingsOf( checker, min_d, slack, check, seed, velocity, acceleration ) } };
	settings.states = goal_states.in( "goal_states", 1, std::numeric_limits<std::uint32_t>::max() );
	setWork( settings, seconds, smooth, request );
	motions::TrajectorySettings as_driven;
	as_driven.edge = settings.edge;
	std::atomic<bool> stopped = false;
	settings.stop = [&stopped] { return stopped.load(); };
	const std::shared_ptr<const io::World> world = worldOf( checker, legs );
	const std::vector<double> from = startOr( checker, start, request );
	sequence::Result plan;
	workInterruptibly(
	    [&]
	    {
		    plan = world ? sequence::planSequence( *checker.model, *world, legs, settings, from )
		                 : sequence::planSequence( *checker.model, problem, legs, settings, from );
	    },
	    [&stopped] { stopped = true; } );
	return sequenceOf( checker, path, plan, legs, world.get(), from, as_driven );
}

} // namespace

motions::MotionLimits limitsOf( const PyChecker& checker, const nb::object& velocity, const nb::object& acceleration )
{
	motions::MotionLimits limits;
	if ( velocity.is_none() )
	{
		limits = motions::motionLimits( *checker.problem, *checker.model, {} );
	}
	limits.velocity = limitOf( checker, velocity, "velocity", limits.velocity );
	limits.acceleration = limitOf(
	    checker, acceleration, "acceleration", std::vector<double>( checker.variables(), motions::default_acceleration ) );
	for ( const std::vector<double>* values : { &limits.velocity, &limits.acceleration } )
	{
		for ( const double value : *values )
		{
			if ( !( value > 0 && value < HUGE_VAL ) )
			{
				throw nb::value_error( "velocity, acceleration: limits have to be above 0, and finite" );
			}
		}
	}
	return limits;
}

motions::MotionSettings settingsOf( const PyChecker& checker, double min_d, double slack, const std::string& check,
    const Whole& seed, const nb::object& velocity, const nb::object& acceleration )
{
	motions::MotionSettings settings;
	settings.edge.min_d = min_d;
	settings.edge.slack = slack;
	settings.edge.flags = checkFlags( check );
	settings.limits = limitsOf( checker, velocity, acceleration );
	settings.seed = seed.seed();
	return settings;
}

void bindConstrained( nb::class_<PyChecker>& type )
{
	constexpr double infinity = std::numeric_limits<double>::infinity();
	type.def( "plan_request", &planRequest, "request"_a, "start"_a = nb::none(), "goal"_a = nb::none(), nb::kw_only(),
	    "mend_start"_a = false, "seconds"_a = infinity, "seed"_a.none() = 1, "min_d"_a = 0.0, "slack"_a = 1e-3,
	    "check"_a = "both", "smooth"_a = true, "velocity"_a = nb::none(), "acceleration"_a = nb::none(),
	    nb::sig(
	        "def plan_request(self, request: typing.Mapping | str | os.PathLike, start: numpy.typing.ArrayLike | None = None, "
	        "goal: numpy.typing.ArrayLike | None = None, *, mend_start: bool = False, seconds: float = float('inf'), "
	        "seed: int = 1, min_d: float = 0.0, slack: float = 0.001, check: str = 'both', smooth: bool = True, "
	        "velocity: numpy.typing.ArrayLike | None = None, acceleration: numpy.typing.ArrayLike | None = None) -> "
	        "leeway.results.ConstrainedPlan" ),
	    "A motion that keeps the request's path_constraints, clearances and limits at all times, proved: cubics, straight where they may be.\n\n"
	    "request: a mapping in the shape of moveit_msgs/MotionPlanRequest (lists, numbers, arrays of NumPy), or the name of its file: start_state,\n"
	    "goal_constraints, path_constraints. start: float64 [dof], in place of start_state, which may be missing in a mapping; goal: float64 [dof],\n"
	    "in place of goal_constraints of a mapping. mend_start: a start that breaks constraints is led to them by a first motion, proved free.\n"
	    "seconds: of the search; infinity: the request's allowed_planning_time, else 60. smooth: shortcuts. velocity, acceleration: float64 [dof]\n"
	    "limits (None: of the robot; 1). Returns ConstrainedPlan; trajectory(times, positions, velocities) proves its clearances once more. Equal\n"
	    "seeds give equal plans, unless the time is over. Ctrl-C ends the search. Raises InputError for a request that cannot be read, of another group, and for starts,\n"
	    "goals and constraints that cannot be kept, with the amounts." );
	const lines::Task task;
	type.def( "plan_sequence", &planSequence, "items"_a, "start"_a = nb::none(), nb::kw_only(), "tip"_a = nb::none(),
	    "free_axis"_a = nb::none(), "tolerance"_a = task.tolerance, "angle"_a = task.angle, "speed"_a = HUGE_VAL,
	    "seconds"_a = infinity, "seed"_a.none() = 1, "min_d"_a = 0.0, "slack"_a = 1e-3, "check"_a = "both",
	    "smooth"_a = true, "velocity"_a = nb::none(), "acceleration"_a = nb::none(), "goal_states"_a.none() = 16,
	    nb::sig(
	        "def plan_sequence(self, items: typing.Sequence | typing.Mapping | str | os.PathLike, "
	        "start: numpy.typing.ArrayLike | None = None, *, tip: numpy.typing.ArrayLike | None = None, "
	        "free_axis: numpy.typing.ArrayLike | None = None, tolerance: float = 0.0001, angle: float = 0.0017, "
	        "speed: float = float('inf'), seconds: float = float('inf'), seed: int = 1, min_d: float = 0.0, slack: float = 0.001, "
	        "check: str = 'both', smooth: bool = True, velocity: numpy.typing.ArrayLike | None = None, "
	        "acceleration: numpy.typing.ArrayLike | None = None, goal_states: int = 16) -> leeway.results.Sequence" ),
	    "Motions one after the other, such as approach, grasp and retreat, planned together: a goal counts only if the motions behind it are\n"
	    "found. Each begins where the one before ends; all are proved free and within limits at all times.\n\n"
	    "items: a list; or moveit_msgs/MotionSequenceRequest, as a mapping or the name of its file. An item is float64 [dof] or [k, dof], a goal or\n"
	    "alternatives; or a mapping: a request as of plan_request(), with goal_constraints and perhaps path_constraints, or with waypoints and\n"
	    "link_name, a line; or {\"req\": request or array, \"blend_radius\": metres, \"planning_options\": {\"planning_scene_diff\": difference}}: the corner to the\n"
	    "next line is rounded from that radius on; the difference, in the shape of moveit_msgs/PlanningScene, changes the scene before the motion: objects\n"
	    "are attached to the hand where they are then, released where it leaves them, added, removed and moved, contacts allowed. group_name of a\n"
	    "request, or beside req where that is an array, is a group among the checker's joints: the motion moves its joints alone, and the others stand\n"
	    "where the item before left them. An array without one is of the checker's group. start: float64 [dof], in\n"
	    "place of the first start_state. goal_states: of a pose, at most. tip, free_axis, tolerance, angle, speed: of all lines, as of plan_line(). seconds: of all; infinity: the sum of\n"
	    "allowed_planning_time, else 60. velocity, acceleration: limits. Returns Sequence; without a plan `failed` is the item that is not found.\n"
	    "Equal seeds give equal plans, unless the time is over. Ctrl-C ends it. Raises InputError that names the item." );
}

} // namespace leeway::python
