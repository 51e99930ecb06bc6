// SPDX-License-Identifier: BSD-3-Clause
// Checker.plan(): arrays in, arrays out.
#include "objects.hpp"

#include "leeway/planners/planner.h"

#include <nanobind/stl/string.h>

#include <chrono>
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

/// Searches on another thread, while this one lets the interpreter handle signals: Ctrl-C ends the search.
lw_status planInterruptibly( lw_plan_def def, lw_diag& diag, lw_plan_result& out )
{
	lw_plan_cancel cancel{};
	def.cancel = &cancel;
	bool interrupted = false;
	lw_status status = LW_OK;
	{
		const nb::gil_scoped_release unlocked;
		std::future<lw_status> search = std::async( std::launch::async, [&] { return lw_plan( &def, &diag, &out ); } );
		while ( search.wait_for( std::chrono::milliseconds( 50 ) ) != std::future_status::ready )
		{
			const nb::gil_scoped_acquire locked;
			if ( !interrupted && PyErr_CheckSignals() != 0 )
			{
				interrupted = true;
				lw_plan_request_cancel( &cancel );
			}
		}
		status = search.get();
	}
	if ( interrupted )
	{
		throw nb::python_error();
	}
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

} // namespace leeway::python
