// SPDX-License-Identifier: BSD-3-Clause
// Points of a path with their clearances, and the least clearance along parts of it: states from above, certified edges from below.
#pragma once

#include "leeway/planners/clearance.hpp"

#include "space.hpp"

#include <algorithm>
#include <array>
#include <vector>

namespace leeway::planners
{

constexpr unsigned kinds = 2; ///< of pairs: with obstacles, of the robot itself
constexpr lw_check_flags flag_of[kinds] = { LW_CHECK_ENVIRONMENT, LW_CHECK_SELF };

/// Points joined by straight edges. Each knows its clearances, each edge the margins that are proved of it, until an end moves.
class Band
{
public:
	struct Point
	{
		std::vector<double> q;
		std::array<double, kinds> upper; ///< measured; NaN: not yet
		bool still = false;              ///< the last push moved it by little
		std::vector<double> good;        ///< the last place without contact
	};
	struct Edge
	{
		std::array<double, kinds> proved{};                ///< 0: nothing
		std::array<double, kinds> upper{ NAN, NAN }, at{}; ///< the least of a few states inside, and its place; NaN: not yet
	};

	std::vector<Point> points;
	std::vector<Edge> edges;         ///< from point i to the next
	std::size_t first = 0, last = 0; ///< of the middle

	void add( const double* q, std::size_t size )
	{
		points.push_back( { std::vector<double>( q, q + size ), unknown(), false, std::vector<double>( q, q + size ) } );
		edges.resize( points.size() - 1 );
	}

	void insert( std::size_t edge, const std::vector<double>& q )
	{
		Edge both;
		both.proved = edges[edge].proved; // proofs of the whole edge hold for its parts
		edges[edge] = both;
		points.insert( points.begin() + static_cast<std::ptrdiff_t>( edge + 1 ), { q, unknown(), false, q } );
		edges.insert( edges.begin() + static_cast<std::ptrdiff_t>( edge + 1 ), both );
		first += first > edge;
		last += last > edge;
	}

	/// Drops a point between the ends. @param joined the edge in place of two
	void drop( std::size_t point, const Edge& joined )
	{
		points.erase( points.begin() + static_cast<std::ptrdiff_t>( point ) );
		edges.erase( edges.begin() + static_cast<std::ptrdiff_t>( point ) );
		edges[point - 1] = joined;
		first -= first > point;
		last -= last > point;
	}

	void move( std::size_t point, const std::vector<double>& q )
	{
		points[point].q = q;
		points[point].upper = unknown();
		edges[point - 1] = edges[point] = {};
	}

	double length( const Space& space ) const
	{
		double sum = 0;
		for ( std::size_t i = 0; i < edges.size(); ++i )
		{
			sum += space.distance( points[i].q.data(), points[i + 1].q.data() );
		}
		return sum;
	}

private:
	static std::array<double, kinds> unknown() { return { NAN, NAN }; }
};

/// A place on a band where its clearance is low.
struct LowPlace
{
	std::size_t edge = 0;
	double t = -1; ///< below 0: none was found
};

/// Encloses the least clearance of parts of a band. As in the costs of OMPL's motions (ompl/objective.cpp), an edge check at a margin is
/// FREE, or stops at a state whose clearance lowers the bound.
class MarginProver
{
public:
	static constexpr double tolerance = 0.07;

	/// @param most metres: larger clearances are not measured
	MarginProver( const lw_checker* checker, lw_query* query, const lw_edge_def& edge, const Space& space, double most,
	    Statistics& work )
	    : m_checker( checker ), m_query( query ), m_own( edge ), m_space( space ), m_most( most ), m_work( work )
	{
		m_own.tolerance = nullptr;
		m_own.method = LW_EDGE_CERTIFIED;
	}

	/// Metres, measured, of each kind; at most `most`.
	std::array<double, kinds> clearances( const double* q )
	{
		const lw_range range = { 0, m_most, tolerance / 4 };
		lw_state_result state;
		note( lw_checker_state( m_checker, m_query, q, m_own.flags, &range, false, &state ) );
		++m_work.states;
		std::array<double, kinds> upper{ std::min( m_most, state.environment.upper ), std::min( m_most, state.self.upper ) };
		for ( unsigned k = 0; k < kinds; ++k )
		{
			upper[k] = m_status != LW_OK ? 0 : ( m_own.flags & flag_of[k] ) == 0 ? m_most : upper[k];
		}
		return upper;
	}

	/// The least clearance of a kind from point `first` to point `last`, no more than `cap`.
	/// @param bound the upper end that is known already
	/// @param floor a lower end below it is of no use: then 0
	/// @param low receives the last place that lowered the bound
	ClearanceRange enclose( Band& band, unsigned kind, std::size_t first, std::size_t last, double cap, double bound,
	    double floor, LowPlace* low )
	{
		double high = bound;
		for ( std::size_t i = first; i <= last; ++i )
		{
			measure( band.points[i] );
			if ( band.points[i].upper[kind] < high )
			{
				high = band.points[i].upper[kind];
				place( low, i > first ? i - 1 : i, i > first ? 1 : 0 );
			}
		}
		for ( std::size_t i = first; i < last; ++i )
		{
			Band::Edge& edge = band.edges[i];
			const double ends = std::min( band.points[i].upper[kind], band.points[i + 1].upper[kind] );
			if ( edge.proved[kind] < marginBelow( high, cap, 0 ) && ends < likely * high )
			{
				look( edge, band.points[i].q.data(), band.points[i + 1].q.data() );
				if ( edge.upper[kind] < high )
				{
					high = edge.upper[kind];
					place( low, i, edge.at[kind] );
				}
			}
		}
		double margin = marginBelow( high, cap, floor );
		if ( margin < std::max( floor, lowest() ) )
		{
			return { 0, high };
		}
		for ( std::size_t i = first; i < last; ++i )
		{
			for ( unsigned failures = 1; !isProved( band, i, kind, margin, high ); ++failures )
			{
				high = std::min( high, m_failed );
				place( low, i, m_failed_at );
				const double next = std::min( marginBelow( high, cap, floor ), margin / ( 1 + tolerance ) );
				margin = failures > trusted ? std::min( next, margin * 0.7 ) : next;
				if ( m_status != LW_OK || margin < std::max( floor, lowest() ) || failures > most_failures )
				{
					return { 0, high };
				}
			}
		}
		return { margin, high };
	}

	/// Is the motion between these states proved at the margin? @param high an upper bound of the least clearance, for the accuracy
	/// @param proved receives a proved lower bound
	bool isFree( const double* a, const double* b, unsigned kind, double margin, double high, double* proved )
	{
		lw_edge_def def = m_own;
		def.flags = flag_of[kind];
		def.min_d = margin < lowest() ? margin : margin * more;
		const double share = std::clamp( high / margin - 1, tolerance / 8, tolerance ) / 4;
		def.slack = margin < lowest() ? m_own.slack : std::max( share * margin, least_slack );
		def.alpha = share;
		def.close_windows = 0;
		lw_edge_result result;
		note( lw_checker_edge( m_checker, m_query, a, b, &def, &result ) );
		++m_work.edges;
		if ( m_status != LW_OK )
		{
			return false;
		}
		m_work.edge_queries += result.queries;
		m_work.free += result.verdict == LW_VERDICT_FREE;
		m_work.blocked += result.verdict == LW_VERDICT_BLOCKED;
		m_work.undecided += result.verdict == LW_VERDICT_UNDECIDED;
		m_failed_at = result.t;
		m_failed = result.pair.kind == LW_CLEARANCE_UNKNOWN ? margin : std::max( result.pair.upper, 0.0 );
		*proved = result.lower_bound / more;
		return result.verdict == LW_VERDICT_FREE;
	}

	void measure( Band::Point& point )
	{
		if ( std::isnan( point.upper[0] ) )
		{
			point.upper = clearances( point.q.data() );
		}
	}

	/// A margin that a motion with this least clearance is proved at; the floor itself if it is in reach.
	static double marginBelow( double high, double cap, double floor )
	{
		const double margin = high >= cap ? cap : std::min( high / ( 1 + tolerance ), high - 3 * least_slack );
		return margin < floor && floor <= std::min( high * ( 1 - tolerance / 4 ), high - least_slack ) ? floor : margin;
	}

	double failedClearance() const { return m_failed; } ///< measured there
	double failedAt() const { return m_failed_at; }     ///< of the last motion that was not proved, [0, 1]

	/// Margins below it are not tried: their proofs would take many states.
	double lowest() const { return m_own.min_d + m_own.slack; }
	lw_status status() const { return m_status; }

private:
	static constexpr unsigned trusted = 2, most_failures = 12;
	static constexpr double least_slack = 5e-5; ///< metres: a finer one takes tens of states
	static constexpr double more = 1 + 1e-9;    ///< proved / reported: unwrap() rounds angles
	static constexpr double likely =
	    2; ///< times the bound: an edge between ends that are farther gets its proof, and no states

	/// A few states inside of an edge: a failed proof takes as long as tens of them.
	void look( Band::Edge& edge, const double* a, const double* b )
	{
		if ( !std::isnan( edge.upper[0] ) )
		{
			return;
		}
		edge.upper = { m_most, m_most };
		m_inner.resize( m_space.size() );
		for ( const double t : { 0.25, 0.5, 0.75 } )
		{
			m_space.between( a, b, t, m_inner.data() );
			const std::array<double, kinds> upper = clearances( m_inner.data() );
			for ( unsigned k = 0; k < kinds; ++k )
			{
				if ( upper[k] < edge.upper[k] )
				{
					edge.upper[k] = upper[k];
					edge.at[k] = t;
				}
			}
		}
	}

	bool isProved( Band& band, std::size_t i, unsigned kind, double margin, double high )
	{
		Band::Edge& edge = band.edges[i];
		if ( edge.proved[kind] >= margin )
		{
			return true;
		}
		double proved = 0;
		if ( !isFree( band.points[i].q.data(), band.points[i + 1].q.data(), kind, margin, high, &proved ) )
		{
			m_failed = std::min( m_failed, high );
			return false;
		}
		edge.proved[kind] = std::max( proved, margin );
		return true;
	}

	static void place( LowPlace* low, std::size_t edge, double t )
	{
		if ( low != nullptr )
		{
			*low = { edge, t };
		}
	}

	void note( lw_status status ) { m_status = m_status == LW_OK ? status : m_status; }

	const lw_checker* m_checker;
	lw_query* m_query;
	lw_edge_def m_own;
	const Space& m_space;
	double m_most;
	std::vector<double> m_inner;
	Statistics& m_work;
	double m_failed = 0, m_failed_at = 0;
	lw_status m_status = LW_OK;
};

} // namespace leeway::planners
