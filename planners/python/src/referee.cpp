// SPDX-License-Identifier: BSD-3-Clause
// Rulings on results of other planners: the library leeway::referee.
#include "objects.hpp"

#include "referee/judge.hpp"

#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

namespace leeway::python
{
namespace
{

using namespace nb::literals;

std::vector<std::vector<double>> rowsOfStates( const PyChecker& checker, const nb::object& given, const char* name )
{
	const Doubles numbers = nb::cast<Doubles>( given );
	const Rows rows = rowsOf( numbers, checker.variables(), name, "variables of the group" );
	std::vector<std::vector<double>> out;
	for ( std::size_t i = 0; i < rows.count; ++i )
	{
		out.emplace_back( rows[i], rows[i] + rows.width );
	}
	if ( out.empty() )
	{
		throw nb::value_error( ( std::string( name ) + ": has no rows" ).c_str() );
	}
	return out;
}

std::vector<referee::Item> itemsOf( const PyChecker& checker, const nb::object& given )
{
	if ( const std::string file = fileName( given ); !file.empty() )
	{
		return referee::readItems( file );
	}
	referee::Item item;
	item.name = item.file = "item";
	if ( nb::isinstance<nb::tuple>( given ) && nb::len( given ) == 2 )
	{
		referee::Region region;
		region.file = "item";
		region.a = rowsOfStates( checker, given[0], "A" );
		const Doubles limits = nb::cast<Doubles>( given[1] );
		const double* values = vectorOf( limits, region.a.size(), "b", "rows of A" );
		region.b.assign( values, values + region.a.size() );
		item.region = std::move( region );
	}
	else
	{
		item.points = rowsOfStates( checker, given, "item" );
	}
	return { item };
}

nb::object judgeItems( const PyChecker& checker, const nb::object& given, double min_d, const std::string& check,
    double search, double prove, const Whole& seed, const std::string& policy )
{
	if ( policy != "proved" && policy != "collision" )
	{
		throw nb::value_error( "policy: is neither 'proved' nor 'collision'" );
	}
	if ( !( min_d >= 0 ) || !( search >= 0 ) || !( prove >= 0 ) )
	{
		throw nb::value_error( "min_d, search, prove: are numbers of 0 or more" );
	}
	const std::vector<referee::Item> items = itemsOf( checker, given );
	referee::JudgeSettings settings;
	settings.region.min_d = min_d;
	settings.region.flags = checkFlags( check );
	settings.region.search_seconds = search;
	settings.region.proof_seconds = prove;
	settings.region.seed = static_cast<std::uint32_t>( seed.in( "seed", 0, 0xffffffff ) );
	motions::Json rulings = motions::Json::array();
	{
		const nb::gil_scoped_release unlocked;
		for ( const referee::Item& item : items )
		{
			const referee::Ruling ruling = referee::judge( *checker.problem, *checker.model, item, settings );
			rulings.push_back( toJson( ruling, policy == "proved" ? referee::Policy::proved : referee::Policy::collision ) );
		}
	}
	return dictOf( rulings );
}

} // namespace

void bindReferee( nb::class_<PyChecker>& type )
{
	type.def( "referee", &judgeItems, "item"_a, nb::kw_only(), "min_d"_a = 0.0, "check"_a = "both", "search"_a = 1.0,
	    "prove"_a = 1.0, "seed"_a = 1, "policy"_a = "proved",
	    nb::sig(
	        "def referee(self, item: str | os.PathLike | numpy.typing.ArrayLike | tuple[numpy.typing.ArrayLike, numpy.typing.ArrayLike], *, "
	        "min_d: float = 0.0, check: str = 'both', search: float = 1.0, prove: float = 1.0, seed: int = 1, policy: str = 'proved') -> "
	        "list[dict[str, typing.Any]]" ),
	    "Judges results of other planners: the rulings of `leeway referee`.\n\n"
	    "item: a file of paths, trajectories or regions, as that command reads; a path float64 [n, dof]; or (A, b), the region A q <= b, for which\n"
	    "a colliding state is searched in `search` seconds; if there is none, boxes of it are proved in `prove` seconds. policy: what passes: 'proved',\n"
	    "or all but a 'collision'. Returns a dict for each: name, kind, passed, verdict, reason, problems, assumed; first and worst with place and state,\n"
	    "worst also with depth [least, most]; region: the share that is proved. Raises InputError." );
}

} // namespace leeway::python
