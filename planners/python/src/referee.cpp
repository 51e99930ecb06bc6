// SPDX-License-Identifier: BSD-3-Clause
// Rulings on results of other planners, and certificates of paths: the libraries leeway::referee and leeway::certify.
#include "objects.hpp"

#include "leeway/certify/certificate.hpp"
#include "leeway/motions/motion_files.hpp"
#include "leeway/motions/path_file.hpp"
#include "referee/judge.hpp"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

namespace leeway::python
{
namespace
{

using namespace nb::literals;

bool isFile( const nb::object& given )
{
	return nb::isinstance<nb::str>( given ) || nb::hasattr( given, "__fspath__" );
}

std::string nameOf( const nb::object& given )
{
	return nb::cast<std::string>( nb::module_::import_( "os" ).attr( "fspath" )( given ) );
}

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
	if ( isFile( given ) )
	{
		return referee::readItems( nameOf( given ) );
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

nb::bytes certificateOf( const PyChecker& checker, const nb::object& given, const std::optional<double>& min_d,
    const std::string& check, const nb::object& tolerance, const std::vector<std::string>& sources, double seconds )
{
	std::vector<std::vector<double>> points;
	certify::Settings settings;
	std::string file = "path";
	if ( isFile( given ) )
	{
		const motions::PathFile path = motions::readPath( nameOf( given ) );
		const std::vector<std::string> elsewhere = motions::startDifferences( path, *checker.problem );
		if ( !elsewhere.empty() )
		{
			throw io::Error( path.file, "start_state", elsewhere.front(),
			    "give the checker this state of the joints: Checker(..., reference=)" );
		}
		points = motions::groupPoints( path, *checker.problem );
		settings.min_d = path.min_d;
		file = path.file;
	}
	else
	{
		points = rowsOfStates( checker, given, "path" );
	}
	settings.min_d = min_d.value_or( settings.min_d );
	settings.flags = checkFlags( check );
	settings.sources = sources;
	settings.seconds = seconds;
	if ( !( settings.min_d >= 0 ) )
	{
		throw nb::value_error( "min_d: is no number of 0 or more" );
	}
	if ( !tolerance.is_none() )
	{
		const Doubles numbers = nb::cast<Doubles>( tolerance );
		const double* values = vectorOf( numbers, checker.variables(), "tolerance", "variables of the group" );
		settings.tolerance.assign( values, values + checker.variables() );
	}
	certify::Certificate certificate;
	{
		const nb::gil_scoped_release unlocked;
		certificate = certify::certify(
		    *checker.problem, *checker.model, certify::piecesOf( *checker.problem, points ), settings, file );
	}
	return nb::bytes( certificate.bytes.data(), certificate.bytes.size() );
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
	type.def( "certificate", &certificateOf, "path"_a, nb::kw_only(), "min_d"_a = nb::none(), "check"_a = "both",
	    "tolerance"_a = nb::none(), "sources"_a = std::vector<std::string>(), "seconds"_a = 60.0,
	    nb::sig(
	        "def certificate(self, path: str | os.PathLike | numpy.typing.ArrayLike, *, min_d: float | None = None, check: str = 'both', "
	        "tolerance: numpy.typing.ArrayLike | None = None, sources: list[str] = [], seconds: float = 60.0) -> bytes" ),
	    "A certificate of a path, which leeway.certificate.check() and the programs beside it check: `leeway audit --certificate`.\n\n"
	    "path: float64 [n, dof], or a path file. min_d: of the file unless given, else 0. tolerance: float64 [dof], deviations for which it holds.\n"
	    "sources: files whose SHA-256 is stored. seconds: then it is an error. Raises InputError if the path is not free, and names the pair." );
}

} // namespace leeway::python
