// SPDX-License-Identifier: BSD-3-Clause
// Pages of paths: the text that leeway.view() wraps.
#include "objects.hpp"

#include "view/page.hpp"

#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <utility>

namespace leeway::python
{

namespace
{

using namespace nb::literals;

/// @param paths of the group, by name; the first is shown first
std::string pageOf( const PyChecker& checker, const std::vector<std::pair<std::string, Doubles>>& paths, double min_d,
    const std::string& check )
{
	view::requireView( "view" );
	std::vector<view::NamedMotion> motions;
	const lw_check_flags flags = checkFlags( check );
	std::vector<std::vector<std::vector<double>>> points;
	for ( const auto& [name, array] : paths )
	{
		const Rows rows = rowsOf( array, checker.variables(), "path", "variables of the group" );
		if ( rows.count == 0 )
		{
			throw nb::value_error( "path: has no state" );
		}
		std::vector<std::vector<double>>& states = points.emplace_back();
		for ( std::size_t i = 0; i < rows.count; ++i )
		{
			states.emplace_back( rows[i], rows[i] + rows.width );
		}
	}
	const nb::gil_scoped_release unlocked;
	for ( std::size_t i = 0; i < paths.size(); ++i )
	{
		const view::Measuring how = { *checker.problem, flags, min_d, paths[i].first };
		motions.push_back( { paths[i].first, view::motionOfPath( how, points[i] ) } );
		if ( paths.size() > 1 )
		{
			view::setNothingApart( motions.back().motion );
		}
	}
	view::PageInput page = { *checker.model, nullptr, *checker.problem, std::move( motions.front().motion ), flags };
	page.source = motions.front().name;
	page.min_d = min_d;
	motions.erase( motions.begin() );
	page.more = std::move( motions );
	return view::pageHtml( { &page } );
}

} // namespace

void bindViews( nb::module_& module )
{
	module.def(
	    "view_page",
	    []( const PyChecker& checker, const nb::list& paths, double min_d, const std::string& check )
	    {
		    std::vector<std::pair<std::string, Doubles>> named;
		    for ( const nb::handle entry : paths )
		    {
			    const nb::tuple pair( nb::borrow( entry ) );
			    named.emplace_back( nb::cast<std::string>( pair[0] ), nb::cast<Doubles>( pair[1] ) );
		    }
		    if ( named.empty() )
		    {
			    throw nb::value_error( "path: give at least one" );
		    }
		    return pageOf( checker, named, min_d, check );
	    },
	    "checker"_a, "paths"_a, "min_d"_a = 0.0, "check"_a = "both",
	    nb::sig( "def view_page(checker: Checker, paths: list[tuple[str, numpy.typing.ArrayLike]], min_d: float = 0.0, "
	             "check: str = 'both') -> str" ),
	    "The page of named paths as HTML: what leeway.view() wraps." );
}

} // namespace leeway::python
