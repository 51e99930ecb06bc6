// SPDX-License-Identifier: BSD-3-Clause
// Batches of near pairs and their derivatives: Checker.near() and Checker.point_jacobian().
#include "objects.hpp"

#include "leeway/depth.h"
#include "leeway/near.h"

#include <nanobind/stl/string.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <vector>

namespace leeway::python
{

namespace
{

using namespace nb::literals;

constexpr std::size_t block_of_states = 32;
constexpr std::uint32_t first_capacity = 64; // rows; grows with the states that have more

/// The near pairs of one state.
struct NearState
{
	std::vector<lw_near_pair> rows;
	std::vector<double> derivatives; ///< [rows][dof]; empty: not wanted
};

struct Question
{
	const PyChecker& checker;
	lw_near_def def;
	bool derivatives;
	double* links; ///< [states][links]
	mutable std::atomic<std::uint32_t> capacity{ first_capacity };

	/// All near pairs, whatever their number.
	NearState ask( lw_query* query, const Rows& rows, std::size_t i ) const
	{
		NearState out;
		out.rows.resize( capacity );
		for ( ;; )
		{
			const auto room = static_cast<std::uint32_t>( out.rows.size() );
			lw_near_def wanted = def;
			if ( derivatives )
			{
				out.derivatives.resize( std::size_t( room ) * checker.variables() );
				wanted.derivatives = out.derivatives.data();
			}
			wanted.link_clearance = links + i * lw_robot_link_count( lw_checker_robot( checker.get() ) );
			std::uint32_t count = 0;
			const lw_status status =
			    lw_checker_near( checker.get(), query, rows[i], &wanted, out.rows.data(), room, &count );
			if ( status != LW_OK )
			{
				failState( status, rows, i );
			}
			if ( count <= room )
			{
				out.rows.resize( count );
				out.derivatives.resize( derivatives ? count * checker.variables() : 0 );
				return out;
			}
			out.rows.resize( count );
			capacity = std::max<std::uint32_t>( capacity, count + count / 4 ); // the next states are like this one
		}
	}
};

/// Columns of all rows of all states, one state after the other.
nb::object columns(
    const PyChecker& checker, const std::vector<NearState>& states, bool derivatives, const nb::object& links )
{
	const std::uint32_t link_count = lw_robot_link_count( lw_checker_robot( checker.get() ) );
	const std::size_t dof = checker.variables();
	const NewArray<std::int64_t> offsets( { states.size() + 1 } );
	offsets.data[0] = 0;
	for ( std::size_t i = 0; i < states.size(); ++i )
	{
		offsets.data[i + 1] = offsets.data[i] + static_cast<std::int64_t>( states[i].rows.size() );
	}
	const auto n = static_cast<std::size_t>( offsets.data[states.size()] );
	const NewArray<double> lower( { n } ), upper( { n } ), normals( { n, 3 } ), points( { n, 2, 3 } );
	const NewArray<double> slopes = derivatives ? NewArray<double>( { n, dof } ) : NewArray<double>( { 0 } );
	const NewArray<std::int32_t> pairs( { n, 2 } ), bodies( { n, 2 } );
	const NewArray<std::uint8_t> directions( { n } );
	std::size_t k = 0;
	for ( const NearState& state : states )
	{
		std::copy( state.derivatives.begin(), state.derivatives.end(), slopes.data + k * dof );
		for ( const lw_near_pair& row : state.rows )
		{
			lower.data[k] = row.clearance.lower;
			upper.data[k] = row.clearance.upper;
			pairs.data[2 * k] = static_cast<std::int32_t>( row.clearance.a );
			pairs.data[2 * k + 1] = static_cast<std::int32_t>( row.clearance.b + ( row.self ? 0 : link_count ) );
			bodies.data[2 * k] = static_cast<std::int32_t>( row.body_a );
			bodies.data[2 * k + 1] = static_cast<std::int32_t>( row.body_b );
			directions.data[k] = static_cast<std::uint8_t>( row.direction );
			write( normals.data + 3 * k, row.normal );
			write( points.data + 6 * k, row.clearance.point_a );
			write( points.data + 6 * k + 3, row.clearance.point_b );
			++k;
		}
	}
	return result(
	    "NearPairs", nb::make_tuple( offsets.object, pairs.object, lower.object, upper.object, normals.object, points.object,
	                     directions.object, derivatives ? slopes.object : nb::none(), bodies.object, links ) );
}

nb::object near( const PyChecker& checker, const Doubles& q, double distance, const std::string& check, double alpha,
    double tie_width, bool derivatives, bool depth, const Whole& threads )
{
	const Rows rows = rowsOf( q, checker.variables(), "q", "variables of the group" );
	if ( !( distance > 0 ) || !( alpha >= 0 && alpha < 1 ) || !( tie_width >= 0 ) )
	{
		throw nb::value_error( "near(): distance has to be above 0, alpha in [0, 1), tie_width 0 or more" );
	}
	const std::size_t link_count = lw_robot_link_count( lw_checker_robot( checker.get() ) );
	const NewArray<double> links =
	    rows.single ? NewArray<double>( { link_count } ) : NewArray<double>( { rows.count, link_count } );
	Question question{ checker, lw_near_def_default(), derivatives, links.data };
	question.def.flags = checkFlags( check );
	question.def.distance = distance;
	question.def.alpha = alpha;
	question.def.tie_width = tie_width;
	question.def.depth_steps = depth ? lw_depth_def_default().steps : 0;
	std::vector<NearState> states( rows.count );
	inBlocks( *checker.queries, rows.count, block_of_states, threads.threads(),
	    [&]( lw_query* query, std::size_t begin, std::size_t end )
	    {
		    for ( std::size_t i = begin; i < end; ++i )
		    {
			    states[i] = question.ask( query, rows, i );
		    }
	    } );
	return columns( checker, states, derivatives, links.object );
}

nb::object pointJacobian( const PyChecker& checker, const Doubles& q, const std::string& link, const Doubles& point )
{
	const double* const state = vectorOf( q, checker.variables(), "q", "variables of the group" );
	const double* const p = vectorOf( point, 3, "point", "coordinates" );
	const lw_robot* robot = lw_checker_robot( checker.get() );
	const std::uint32_t index = lw_robot_find_link( robot, link.c_str() );
	if ( index == LW_INVALID_INDEX )
	{
		const std::string text =
		    "link: robot " + std::string( lw_robot_name( robot ) ) + " has no link '" + link + "'; Checker.links lists them";
		throw nb::value_error( text.c_str() );
	}
	const NewArray<double> out( { 3, checker.variables() } );
	Query query = checker.queries->take();
	const lw_status status =
	    lw_checker_point_jacobian( checker.get(), query.get(), state, index, { p[0], p[1], p[2] }, out.data );
	checker.queries->giveBack( std::move( query ) );
	if ( status != LW_OK )
	{
		throw CoreError( status,
		    std::string( "point_jacobian(): " ) + lw_status_name( status ) + "; q and point have to be finite numbers" );
	}
	return out.object;
}

} // namespace

void bindNear( nb::class_<PyChecker>& type )
{
	type.def( "near", &near, "q"_a, "distance"_a, nb::kw_only(), "check"_a = "both", "alpha"_a = 0.0, "tie_width"_a = 0.0,
	    "derivatives"_a = true, "depth"_a = false, "threads"_a.none() = 1,
	    nb::sig(
	        "def near(self, q: numpy.typing.ArrayLike, distance: float, *, check: str = 'both', alpha: float = 0.0, "
	        "tie_width: float = 0.0, derivatives: bool = True, depth: bool = False, threads: int = 1) -> leeway.results.NearPairs" ),
	    "All pairs of each state whose clearance is below `distance` (metres, > 0, may be inf), nearest first: certified intervals,\n"
	    "directions, and derivatives by the variables of the group.\n\n"
	    "q: float64 [n, dof] or [dof]. check: \"both\", \"environment\" or \"self\". alpha: relative tolerance in [0, 1).\n"
	    "tie_width: metres; above 0, pairs whose nearest points are not the only ones are marked, which takes a second search.\n"
	    "depth: pairs in contact have a clearance below 0, minus their certified penetration depth, and a direction; bodies without an\n"
	    "inside have none. Pairs of bodies that stand still and obstacles are left out. threads: 0 = one per core.\n\n"
	    "Returns NearPairs: rows of all states behind each other; those of state i are offsets[i] to offsets[i + 1].\n"
	    "Raises CoreError for a state that is not finite." );
	type.def( "point_jacobian", &pointJacobian, "q"_a, "link"_a, "point"_a,
	    nb::sig( "def point_jacobian(self, q: numpy.typing.ArrayLike, link: str, point: numpy.typing.ArrayLike) -> "
	             "numpy.typing.NDArray[numpy.float64]" ),
	    "float64 [3, dof]: velocity of a point that a link carries, for each variable of the group at speed 1. point: world, at q." );
}

} // namespace leeway::python
