// SPDX-License-Identifier: BSD-3-Clause
// leeway.Reach: motion hulls and tables of the link pairs that can ever meet.
#include "objects.hpp"

#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <tuple>

namespace leeway::python
{

namespace
{

using namespace nb::literals;

void makeReach(
    PyReach* self, const PyRobot& robot, double seconds, const std::string& cache, const Whole& threads, const Whole& seed )
{
	io::ReachOptions options;
	options.cache = cache;
	options.threads = threads.threads();
	options.def.seconds = seconds;
	options.def.seed = seed.seed();
	const nb::gil_scoped_release unlocked;
	PyReach made{ io::loadReach( robot.robot, options ) };
	new ( self ) PyReach( std::move( made ) );
}

nb::dict reachInfo( const PyReach& reach )
{
	const lw_reach_info& info = reach.loaded.info;
	nb::dict out;
	out["pairs"] = info.pairs;
	out["proved"] = info.proved;
	out["contact"] = info.contact;
	out["unprovable"] = info.unprovable;
	out["open"] = info.open;
	out["complete"] = info.complete;
	return out;
}

std::vector<std::tuple<std::string, std::string, std::string>> pairClasses( const PyReach& reach )
{
	std::vector<std::tuple<std::string, std::string, std::string>> out;
	const lw_reach* core = reach.loaded.reach.get();
	const lw_robot* robot = core != nullptr ? lw_reach_robot( core ) : nullptr;
	for ( std::uint32_t i = 0; robot != nullptr && i < lw_robot_link_count( robot ); ++i )
	{
		for ( std::uint32_t j = i + 1; j < lw_robot_link_count( robot ); ++j )
		{
			const lw_pair_class kind = lw_reach_get_pair( core, i, j ).kind;
			if ( kind != LW_PAIR_NONE )
			{
				out.emplace_back(
				    lw_robot_link_name( robot, i ), lw_robot_link_name( robot, j ), lw_pair_class_name( kind ) );
			}
		}
	}
	return out;
}

} // namespace

void bindReach( nb::module_& module )
{
	nb::class_<PyReach> type( module, "Reach",
	    "Motion hulls of a robot and the pairs of its links that never meet, proved. Checkers become faster with it and give the same\n"
	    "answers." );
	type.def( "__init__", &makeReach, "robot"_a, nb::kw_only(), "seconds"_a = io::default_proof_seconds, "cache"_a = "",
	    "threads"_a.none() = 0, "seed"_a.none() = lw_reach_def_default().seed,
	    nb::sig(
	        "def __init__(self, robot: Robot, *, seconds: float = ..., cache: str = '', threads: int = 0, seed: int = 1) -> None" ),
	    "seconds: time for proofs. cache: a folder that keeps them; the next call goes on from there. threads: 0 = one per core." );
	type.def_prop_ro( "pairs", &pairClasses,
	    "(link, link, class) of all pairs with geometry; class: \"rigid\", \"adjacent\", \"allowed\" (by the SRDF), \"never\" (proved apart in\n"
	    "every state within the limits), \"always\" (in contact in every measured state) or \"check\"." );
	type.def_prop_ro(
	    "info", &reachInfo, nb::sig( "def info(self) -> dict[str, int]" ), "Counts of pairs by the state of their proofs." );
	type.def_prop_ro(
	    "notices", []( const PyReach& r ) { return noticeLines( r.loaded.notices ); }, "Lines on the cache." );
	type.def( "__reduce__", &refusePickle );
	type.def( "__repr__",
	    []( const PyReach& r )
	    {
		    return "<leeway.Reach: " + std::to_string( r.loaded.info.pairs ) + " pairs, " +
		           std::to_string( r.loaded.info.proved ) + " proved apart, " + std::to_string( r.loaded.info.contact ) +
		           " found in contact>";
	    } );
}

} // namespace leeway::python
