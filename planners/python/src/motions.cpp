// SPDX-License-Identifier: BSD-3-Clause
// Batches of motions: Checker.edges(), Checker.path(), Checker.curves() and Checker.trajectory().
#include "objects.hpp"

#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <cmath>
#include <limits>

namespace leeway::python
{

namespace
{

using namespace nb::literals;

constexpr std::size_t block_of_motions = 16;

[[noreturn]] void refuse( const std::string& text )
{
	throw nb::value_error( text.c_str() );
}

/// Settings that all motions of a batch share.
struct EdgeOptions
{
	lw_edge_def def = lw_edge_def_default();
	Doubles tolerance; ///< keeps def.tolerance alive
};

EdgeOptions edgeOptions( const PyChecker& checker, double min_d, double slack, const std::string& check,
    const nb::object& step, const nb::object& tolerance, bool proved_until, double alpha = lw_edge_def_default().alpha )
{
	EdgeOptions options;
	options.def.alpha = alpha;
	options.def.min_d = min_d;
	options.def.slack = slack;
	options.def.flags = checkFlags( check );
	options.def.want_proved_until = proved_until;
	if ( !step.is_none() )
	{
		options.def.method = LW_EDGE_STEPS;
		options.def.max_d = nb::cast<double>( step );
	}
	if ( !tolerance.is_none() )
	{
		options.tolerance = nb::cast<Doubles>( tolerance );
		options.def.tolerance = vectorOf( options.tolerance, checker.variables(), "tolerance", "variables of the group" );
	}
	return options;
}

/// Arrays of results, one entry for each motion.
class Motions
{
public:
	Motions( const PyChecker& checker, std::size_t count )
	    : m_links( lw_robot_link_count( lw_checker_robot( checker.get() ) ) ), m_verdict( { count } ), m_t( { count } ),
	      m_lower( { count } ), m_until( { count } ), m_pairs( { count, 2 } ), m_clearance( { count } ),
	      m_witnesses( { count, 2, 3 } )
	{
	}
	void write( std::size_t i, const lw_edge_result& r ) const
	{
		m_verdict.data[i] = static_cast<std::uint8_t>( r.verdict );
		m_t.data[i] = r.t;
		m_lower.data[i] = r.lower_bound;
		m_until.data[i] = r.proved_until;
		const auto index = []( std::uint32_t k, std::uint32_t first )
		{ return k == LW_INVALID_INDEX ? -1 : static_cast<std::int32_t>( k + first ); };
		m_pairs.data[2 * i] = index( r.pair.a, 0 );
		m_pairs.data[2 * i + 1] = index( r.pair.b, r.self ? 0 : m_links );
		m_clearance.data[i] = r.pair.upper;
		const bool known = std::isfinite( r.pair.upper );
		const double none = std::numeric_limits<double>::quiet_NaN();
		const double values[6] = {
		    r.pair.point_a.x, r.pair.point_a.y, r.pair.point_a.z, r.pair.point_b.x, r.pair.point_b.y, r.pair.point_b.z };
		for ( std::size_t k = 0; k < 6; ++k )
		{
			m_witnesses.data[6 * i + k] = known ? values[k] : none;
		}
	}
	nb::object object() const
	{
		return result( "Motions", nb::make_tuple( m_verdict.object, m_t.object, m_lower.object, m_until.object,
		                              m_pairs.object, m_clearance.object, m_witnesses.object ) );
	}

private:
	std::uint32_t m_links;
	NewArray<std::uint8_t> m_verdict;
	NewArray<double> m_t, m_lower, m_until;
	NewArray<std::int32_t> m_pairs;
	NewArray<double> m_clearance, m_witnesses;
};

/// @param ask status = ask( query, i, result )
template <typename Ask>
nb::object checkAll( const PyChecker& checker, std::size_t count, const Whole& threads, const char* name, const Ask& ask )
{
	const Motions motions( checker, count );
	inBlocks( *checker.queries, count, block_of_motions, threads.threads(),
	    [&]( lw_query* query, std::size_t begin, std::size_t end )
	    {
		    for ( std::size_t i = begin; i < end; ++i )
		    {
			    lw_edge_result r;
			    const lw_status status = ask( query, i, r );
			    if ( status != LW_OK )
			    {
				    throw CoreError(
				        status, std::string( name ) + " " + std::to_string( i ) + ": " + lw_status_name( status ) +
				                    ": a number is not finite, or min_d, slack, step or tolerance is out of its domain" );
			    }
			    motions.write( i, r );
		    }
	    } );
	return motions.object();
}

nb::object edges( const PyChecker& checker, const Doubles& a, const Doubles& b, double min_d, double slack,
    const std::string& check, const nb::object& step, const nb::object& tolerance, bool proved_until, double alpha,
    const Whole& threads )
{
	const Rows from = rowsOf( a, checker.variables(), "a", "variables of the group" );
	const Rows to = rowsOf( b, checker.variables(), "b", "variables of the group" );
	if ( from.count != to.count )
	{
		refuse( "a and b: " + std::to_string( from.count ) + " states beside " + std::to_string( to.count ) );
	}
	const EdgeOptions options = edgeOptions( checker, min_d, slack, check, step, tolerance, proved_until, alpha );
	return checkAll( checker, from.count, threads, "edge",
	    [&]( lw_query* query, std::size_t i, lw_edge_result& r )
	    { return lw_checker_edge( checker.get(), query, from[i], to[i], &options.def, &r ); } );
}

nb::object path( const PyChecker& checker, const Doubles& q, double min_d, double slack, const std::string& check,
    const nb::object& step, const nb::object& tolerance, bool proved_until, double alpha, const Whole& threads )
{
	const Rows rows = rowsOf( q, checker.variables(), "q", "variables of the group" );
	if ( rows.count < 2 )
	{
		refuse( "q: a path has at least 2 states" );
	}
	const EdgeOptions options = edgeOptions( checker, min_d, slack, check, step, tolerance, proved_until, alpha );
	return checkAll( checker, rows.count - 1, threads, "edge",
	    [&]( lw_query* query, std::size_t i, lw_edge_result& r )
	    { return lw_checker_edge( checker.get(), query, rows[i], rows[i + 1], &options.def, &r ); } );
}

nb::object curves( const PyChecker& checker, const Doubles& points, double min_d, double slack, const std::string& check,
    const nb::object& tolerance, const Whole& threads )
{
	const std::size_t width = checker.variables();
	if ( points.dimensions() != 3 || points.shape( 2 ) != width || points.shape( 1 ) < 2 ||
	     points.shape( 1 ) > LW_CURVE_MOST_DEGREE + 1 )
	{
		refuse( "points: shape " + shapeText( points ) + " is not (n, degree + 1, " + std::to_string( width ) +
		        ") with a degree of 1 to " + std::to_string( static_cast<int>( LW_CURVE_MOST_DEGREE ) ) );
	}
	const EdgeOptions options = edgeOptions( checker, min_d, slack, check, nb::none(), tolerance, false );
	const auto degree = static_cast<std::uint32_t>( points.shape( 1 ) - 1 );
	const std::size_t size = points.shape( 1 ) * width;
	const double* data = points.data();
	return checkAll( checker, points.shape( 0 ), threads, "curve",
	    [&]( lw_query* query, std::size_t i, lw_edge_result& r )
	    { return lw_checker_curve( checker.get(), query, data + i * size, degree, &options.def, &r ); } );
}

nb::object trajectory( const PyChecker& checker, const Doubles& times, const nb::object& positions,
    const nb::object& velocities, const nb::object& accelerations, double min_d, double slack, const std::string& check,
    const nb::object& tolerance, const Whole& threads )
{
	const motions::TrajectoryFile file = trajectoryOf( checker, times, positions, velocities, accelerations );
	const std::vector<motions::Segment> pieces =
	    motions::segmentsOf( *checker.problem, file, motions::Interpolation::automatic, 0 );
	const EdgeOptions options = edgeOptions( checker, min_d, slack, check, nb::none(), tolerance, true );
	return checkAll( checker, pieces.size(), threads, "piece",
	    [&]( lw_query* query, std::size_t i, lw_edge_result& r )
	    { return lw_checker_curve( checker.get(), query, pieces[i].points.data(), pieces[i].degree, &options.def, &r ); } );
}

} // namespace

void bindMotions( nb::class_<PyChecker>& type )
{
	constexpr double slack = 1e-3;
	const double alpha = lw_edge_def_default().alpha;
	type.def( "edges", &edges, "a"_a, "b"_a, nb::kw_only(), "min_d"_a = 0.0, "slack"_a = slack, "check"_a = "both",
	    "step"_a = nb::none(), "tolerance"_a = nb::none(), "proved_until"_a = false, "alpha"_a = alpha,
	    "threads"_a.none() = 1,
	    nb::sig(
	        "def edges(self, a: numpy.typing.ArrayLike, b: numpy.typing.ArrayLike, *, min_d: float = 0.0, slack: float = 0.001, "
	        "check: str = 'both', step: float | None = None, tolerance: numpy.typing.ArrayLike | None = None, "
	        "proved_until: bool = False, alpha: float = 0.1, threads: int = 1) -> leeway.results.Motions" ),
	    "Checks the straight edges from a[i] to b[i]: both ends and everything between.\n\n"
	    "a, b: float64 [n, dof] or [dof], radians and metres. min_d: metres, the edge must keep every clearance above it. slack:\n"
	    "metres, clearances in (min_d, min_d + slack] may be UNDECIDED. step: None = a proof; else metres, only states are checked\n"
	    "between which no robot point moves farther. tolerance: float64 [dof], FREE holds for every motion within it. proved_until:\n"
	    "also compute it for edges that are not FREE. alpha: relative tolerance of distances on the way. threads: 0 = one per core; it changes no bit of an answer.\n\n"
	    "Returns arrays [n]: verdicts (leeway.Verdict), t of the colliding or undecided state, proved lower bounds of all clearances,\n"
	    "shares proved, and of the deciding pair: indices into `names`, clearance, witnesses [n, 2, 3]." );
	type.def( "path", &path, "q"_a, nb::kw_only(), "min_d"_a = 0.0, "slack"_a = slack, "check"_a = "both",
	    "step"_a = nb::none(), "tolerance"_a = nb::none(), "proved_until"_a = false, "alpha"_a = alpha,
	    "threads"_a.none() = 1,
	    nb::sig(
	        "def path(self, q: numpy.typing.ArrayLike, *, min_d: float = 0.0, slack: float = 0.001, check: str = 'both', "
	        "step: float | None = None, tolerance: numpy.typing.ArrayLike | None = None, proved_until: bool = False, "
	        "alpha: float = 0.1, threads: int = 1) -> leeway.results.Motions" ),
	    "edges( q[:-1], q[1:] ): the n - 1 edges of a path, float64 [n, dof]." );
	type.def( "curves", &curves, "points"_a, nb::kw_only(), "min_d"_a = 0.0, "slack"_a = slack, "check"_a = "both",
	    "tolerance"_a = nb::none(), "threads"_a.none() = 1,
	    nb::sig(
	        "def curves(self, points: numpy.typing.ArrayLike, *, min_d: float = 0.0, slack: float = 0.001, check: str = 'both', "
	        "tolerance: numpy.typing.ArrayLike | None = None, threads: int = 1) -> leeway.results.Motions" ),
	    "Checks Bezier curves by their control points, float64 [n, degree + 1, dof], degree 1 to 7. Angles do not wrap. Proofs and\n"
	    "results as for edges()." );
	type.def( "trajectory", &trajectory, "times"_a, "positions"_a, "velocities"_a = nb::none(),
	    "accelerations"_a = nb::none(), nb::kw_only(), "min_d"_a = 0.0, "slack"_a = slack, "check"_a = "both",
	    "tolerance"_a = nb::none(), "threads"_a.none() = 1,
	    nb::sig(
	        "def trajectory(self, times: numpy.typing.ArrayLike, positions: numpy.typing.ArrayLike, "
	        "velocities: numpy.typing.ArrayLike | None = None, accelerations: numpy.typing.ArrayLike | None = None, *, "
	        "min_d: float = 0.0, slack: float = 0.001, check: str = 'both', tolerance: numpy.typing.ArrayLike | None = None, "
	        "threads: int = 1) -> leeway.results.Motions" ),
	    "Checks a timed trajectory at all times, as a joint trajectory controller drives it: pieces between its points are quintic\n"
	    "with velocities and accelerations, cubic with velocities, else straight.\n\n"
	    "times: float64 [n], seconds, rising. positions, velocities, accelerations: float64 [n, dof]. Angles do not wrap.\n"
	    "Results as for edges(), one for each of the n - 1 pieces; t is a share of the piece. audit_trajectory() compares limits of joints too." );
}

} // namespace leeway::python
