// SPDX-License-Identifier: BSD-3-Clause
// The module leeway._core.
#include "errors.hpp"
#include "objects.hpp"

#include "leeway/planners/planner.h"

#include <nanobind/stl/string.h>

#include <limits>

namespace
{

void bindEnumerations( nanobind::module_& module )
{
	namespace nb = nanobind;
	nb::enum_<lw_verdict>( module, "Verdict", nb::is_arithmetic(), "Outcome of a check. Only FREE is free." )
	    .value( "UNKNOWN", LW_VERDICT_UNKNOWN, "an error" )
	    .value( "FREE", LW_VERDICT_FREE, "proved: every clearance is above min_d" )
	    .value( "BLOCKED", LW_VERDICT_BLOCKED, "found: a clearance is at most min_d" )
	    .value( "UNDECIDED", LW_VERDICT_UNDECIDED, "not decided: a clearance is in the stated band above min_d" );
	nb::enum_<lw_plan_outcome>( module, "Outcome", nb::is_arithmetic(), "End of a search. Only SOLVED has a path." )
	    .value( "UNKNOWN", LW_PLAN_UNKNOWN, "an error" )
	    .value( "SOLVED", LW_PLAN_SOLVED, "each edge of the path is FREE" )
	    .value( "TIMED_OUT", LW_PLAN_TIMED_OUT, "the seconds are over" )
	    .value( "CANCELLED", LW_PLAN_CANCELLED, "the caller ended it" )
	    .value( "NODES_FULL", LW_PLAN_NODES_FULL, "most_nodes is reached" )
	    .value( "NO_START", LW_PLAN_NO_START, "no start is proved free" )
	    .value( "NO_GOAL", LW_PLAN_NO_GOAL, "no goal is proved free" );
}

} // namespace

NB_MODULE( _core, module )
{
	using namespace leeway::python;
	nanobind::set_leak_warnings( false ); // Ctrl-C ends a process while its threads hold robots: their memory goes with it
	module.doc() = "Certified clearance and motion checks of robots: the compiled part of the package leeway.";
	const std::uint32_t version = lw_version();
	module.attr( "version" ) = std::to_string( version / 10000 ) + "." + std::to_string( version / 100 % 100 ) + "." +
	                           std::to_string( version % 100 );
	bindErrors( module );
	namespace nb = nanobind;
	module.def(
	    "whole_number",
	    []( const std::string& name, const Whole& value, std::uint64_t least, std::uint64_t most )
	    { return value.in( name.c_str(), least, most ); },
	    nb::arg( "name" ), nb::arg( "value" ).none(), nb::arg( "least" ) = 0,
	    nb::arg( "most" ) = std::numeric_limits<std::int64_t>::max(),
	    nb::sig( "def whole_number(name: str, value: int, least: int = 0, most: int = 9223372036854775807) -> int" ),
	    "The value of an argument that is a whole number in [least, most], and no bool. Raises ValueError that names the argument." );
	bindEnumerations( module );
	bindShapes( module );
	bindRobots( module );
	bindReach( module );
	bindScenes( module );
	bindClouds( module );
	bindCheckers( module );
	bindTimedWorlds( module );
	bindGuards( module );
	bindInverses( module );
	bindViews( module );
}
