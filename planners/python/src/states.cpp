// SPDX-License-Identifier: BSD-3-Clause
// Batches of states: Checker.clearance() and Checker.is_free().
#include "objects.hpp"

#include <nanobind/stl/string.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace leeway::python
{

namespace
{

using namespace nb::literals;

constexpr std::size_t block_of_states = 256;

void writePoint( lw_vec3 p, bool valid, double* out )
{
	constexpr double none = std::numeric_limits<double>::quiet_NaN();
	out[0] = valid ? p.x : none;
	out[1] = valid ? p.y : none;
	out[2] = valid ? p.z : none;
}

struct Answers
{
	double *lower, *upper;
	std::int32_t* pairs;
	double* witnesses; ///< null: not wanted
	std::uint32_t links;

	void write( std::size_t i, const lw_clearance& c, double least, bool self ) const
	{
		lower[i] = least;
		upper[i] = c.upper;
		const auto index = []( std::uint32_t k, std::uint32_t first )
		{ return k == LW_INVALID_INDEX ? -1 : static_cast<std::int32_t>( k + first ); };
		pairs[2 * i] = index( c.a, 0 );
		pairs[2 * i + 1] = index( c.b, self ? 0 : links );
		if ( witnesses != nullptr )
		{
			const bool valid = std::isfinite( c.upper );
			writePoint( c.point_a, valid, witnesses + 6 * i );
			writePoint( c.point_b, valid, witnesses + 6 * i + 3 );
		}
	}
	/// The nearer of both clearances.
	void write( std::size_t i, const lw_state_result& r, lw_check_flags flags ) const
	{
		if ( flags != LW_CHECK_BOTH )
		{
			const lw_clearance& only = flags == LW_CHECK_SELF ? r.self : r.environment;
			write( i, only, only.lower, flags == LW_CHECK_SELF );
			return;
		}
		const bool self = r.self.upper < r.environment.upper ||
		                  ( r.self.upper == r.environment.upper && r.self.lower < r.environment.lower );
		write( i, self ? r.self : r.environment, std::min( r.self.lower, r.environment.lower ), self );
	}
};

nb::object clearance( const PyChecker& checker, const Doubles& q, const std::string& check, double min_d, double max_d,
    double alpha, bool witnesses, const Whole& threads )
{
	const Rows rows = rowsOf( q, checker.variables(), "q", "variables of the group" );
	const lw_check_flags flags = checkFlags( check );
	const lw_range range = { min_d, max_d, alpha };
	const std::size_t n = rows.count;
	const bool one = rows.single;
	const NewArray<double> lower = one ? NewArray<double>( {} ) : NewArray<double>( { n } );
	const NewArray<double> upper = one ? NewArray<double>( {} ) : NewArray<double>( { n } );
	const NewArray<std::int32_t> pairs = one ? NewArray<std::int32_t>( { 2 } ) : NewArray<std::int32_t>( { n, 2 } );
	const NewArray<double> points = !witnesses ? NewArray<double>( { 0 } )
	                                : one      ? NewArray<double>( { 2, 3 } )
	                                           : NewArray<double>( { n, 2, 3 } );
	const Answers answers = { lower.data, upper.data, pairs.data, witnesses ? points.data : nullptr,
	    lw_robot_link_count( lw_checker_robot( checker.get() ) ) };
	inBlocks( *checker.queries, n, block_of_states, threads.threads(),
	    [&]( lw_query* query, std::size_t begin, std::size_t end )
	    {
		    for ( std::size_t i = begin; i < end; ++i )
		    {
			    lw_state_result r;
			    const lw_status status = lw_checker_state( checker.get(), query, rows[i], flags, &range, false, &r );
			    if ( status != LW_OK )
			    {
				    failState( status, rows, i );
			    }
			    answers.write( i, r, flags );
		    }
	    } );
	return result(
	    "Clearances", nb::make_tuple( lower.object, upper.object, pairs.object, witnesses ? points.object : nb::none() ) );
}

nb::object isFree( const PyChecker& checker, const Doubles& q, double min_d, const std::string& check, const Whole& threads )
{
	const Rows rows = rowsOf( q, checker.variables(), "q", "variables of the group" );
	const lw_check_flags flags = checkFlags( check );
	const NewArray<bool> free = rows.single ? NewArray<bool>( {} ) : NewArray<bool>( { rows.count } );
	inBlocks( *checker.queries, rows.count, block_of_states, threads.threads(),
	    [&]( lw_query* query, std::size_t begin, std::size_t end )
	    {
		    const auto count = static_cast<std::uint32_t>( end - begin );
		    std::vector<lw_verdict> verdicts( count );
		    if ( lw_checker_states( checker.get(), query, rows[begin], count, flags, min_d, LW_STATES_FULL, verdicts.data(),
		             nullptr ) == LW_OK )
		    {
			    std::transform( verdicts.begin(), verdicts.end(), free.data + begin,
			        []( lw_verdict verdict ) { return verdict == LW_VERDICT_FREE; } );
			    return;
		    }
		    for ( std::size_t i = begin; i < end; ++i ) // one of these is bad
		    {
			    const lw_status status =
			        lw_checker_is_free( checker.get(), query, rows[i], flags, min_d, free.data + i, nullptr );
			    if ( status != LW_OK )
			    {
				    failState( status, rows, i );
			    }
		    }
	    } );
	return rows.single ? nb::object( nb::bool_( *free.data ) ) : free.object;
}

} // namespace

void failState( lw_status status, const Rows& rows, std::size_t i )
{
	std::string text = "q[" + std::to_string( i ) + "]: " + lw_status_name( status );
	for ( std::size_t v = 0; v < rows.width; ++v )
	{
		if ( !std::isfinite( rows[i][v] ) )
		{
			text = "q[" + std::to_string( i ) + "]: entry " + std::to_string( v ) + " is not finite; correct the state";
		}
	}
	throw CoreError( status, text );
}

void bindStates( nb::class_<PyChecker>& type )
{
	constexpr double infinity = std::numeric_limits<double>::infinity();
	type.def( "clearance", &clearance, "q"_a, nb::kw_only(), "check"_a = "both", "min_d"_a = 0.0, "max_d"_a = infinity,
	    "alpha"_a = 0.0, "witnesses"_a = true, "threads"_a.none() = 1,
	    nb::sig(
	        "def clearance(self, q: numpy.typing.ArrayLike, *, check: str = 'both', min_d: float = 0.0, "
	        "max_d: float = float('inf'), alpha: float = 0.0, witnesses: bool = True, threads: int = 1) -> leeway.results.Clearances" ),
	    "Certified clearances of states: lower <= clearance <= upper.\n\n"
	    "q: float64 [n, dof] or [dof], radians and metres; a C-ordered float64 array is not copied. check: \"both\", \"environment\" or\n"
	    "\"self\". min_d, max_d: metres; clearances outside need no precise value. alpha: relative tolerance in [0, 1).\n"
	    "threads: 0 = one per core; it changes no bit of an answer.\n\n"
	    "Returns (lower float64 [n], upper float64 [n], pairs int32 [n, 2], witnesses float64 [n, 2, 3]): metres, of the nearest pair.\n"
	    "A pair is two indices into `names`: a link, and an object or a link; -1 if none is near. Witnesses are points in the world, on\n"
	    "the first and the second of the pair; NaN if none is near, None if not wanted. For one state the arrays have no first axis.\n"
	    "Raises CoreError for a state that is not finite." );
	type.def( "is_free", &isFree, "q"_a, nb::kw_only(), "min_d"_a = 0.0, "check"_a = "both", "threads"_a.none() = 1,
	    nb::sig(
	        "def is_free(self, q: numpy.typing.ArrayLike, *, min_d: float = 0.0, check: str = 'both', threads: int = 1) -> "
	        "numpy.typing.NDArray[numpy.bool_]" ),
	    "Is every clearance of each state above min_d? bool [n], or a bool for one state [dof]. True is proved." );
}

} // namespace leeway::python
