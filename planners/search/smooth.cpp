// SPDX-License-Identifier: BSD-3-Clause
// The smoother. Papers: Geraerts and Overmars, Creating high-quality paths for motion planning (IJRR 2007), partial shortcuts; corners
// cut at midpoints are a step of Chaikin's subdivision, whose limit is a quadratic B-spline.
#include "leeway/planners/smooth.hpp"

#include "samples.hpp"
#include "space.hpp"
#include "validator.hpp"

#include <algorithm>
#include <numeric>
#include <unordered_set>

namespace leeway::planners
{

namespace
{

constexpr std::size_t most_states = 200; // no corners are cut in longer paths
constexpr unsigned corner_tries = 2;     // a corner is cut at the middle of its edges, then at a quarter
constexpr double least_join = 2;         // edges that later rounds replace by one, if a share of the path is less
constexpr double least_piece = 0.02;     // share of an edge: points nearer to a state are replaced by the state
constexpr double least_corner = 1e-3;    // share of the path's length that a cut corner has to save
constexpr double least_shortcut = 5e-3;  // and a shortcut

// A cut rounds a joint's value by less than 8 units of the last place of 1, times the joint's values at both ends. Edges are proved with
// a tolerance that holds 64 cuts.
constexpr double kept_tolerance = 0x1p-44; // share of a joint's values at both ends
constexpr unsigned char most_cuts = 63;    // one behind another
constexpr unsigned char not_kept = 255;    // proved without the tolerance, or by the caller

/// A place on the path: a state, or a point between it and the next.
struct Place
{
	std::size_t edge; ///< from state `edge` to the next
	double t;         ///< [0, 1)
};

class Smoother
{
public:
	Smoother( const lw_checker* checker, lw_query* query, const SmoothSettings& settings, const Stop& stop, Path& path,
	    Statistics& statistics )
	    : m_settings( settings ), m_space( Space::ofLimits( checker ) ), m_tolerance( m_space.size() ),
	      m_validator( checker, query, withTolerance( settings.edge, m_tolerance.data() ), statistics ), m_deadline( stop ),
	      m_random( settings.seed ), m_path( path ), m_cuts( path.count() > 0 ? path.count() - 1 : 0, not_kept ),
	      m_names( path.count() ), m_names_used( static_cast<std::uint32_t>( path.count() ) )
	{
		std::iota( m_names.begin(), m_names.end(), 0u );
	}

	lw_status run()
	{
		double length = total();
		for ( unsigned round = 0; round < m_settings.rounds && m_path.count() > 2 && !over(); ++round )
		{
			joinStates( round == 0 ? m_path.count() : laterJoins() );
			joinPoints();
			cutCorners();
			const double shorter = total();
			if ( shorter > ( 1 - m_settings.gain ) * length )
			{
				break;
			}
			length = shorter;
		}
		return m_validator.status();
	}

	double total() const { return m_path.count() > 0 ? lengthBetween( 0, m_path.count() - 1 ) : 0; }

	/// Length of the path from one state to another.
	double lengthBetween( std::size_t first, std::size_t last ) const
	{
		double sum = 0;
		for ( std::size_t i = first; i < last; ++i )
		{
			sum += m_space.distance( m_path[i], m_path[i + 1] );
		}
		return sum;
	}

private:
	/// Certificates hold for a tolerance around the edge, samples for none.
	static lw_edge_def withTolerance( lw_edge_def edge, const double* tolerance )
	{
		edge.tolerance = edge.method == LW_EDGE_CERTIFIED ? tolerance : nullptr;
		return edge;
	}

	bool over() { return m_deadline.over() || m_validator.status() != LW_OK; }

	/// Two of three long shortcuts fail, nearly all of them at one of the states that are looked at first.
	bool isFree( const double* a, const double* b )
	{
		if ( m_space.partCount( a, b ) != 1 || !m_validator.seemsFree( m_space, a, b ) )
		{
			return false;
		}
		for ( std::size_t i = 0; i < m_tolerance.size(); ++i )
		{
			const double size = std::fabs( a[i] ) + std::fabs( b[i] ) + ( m_space.wraps( i ) ? 2 * full_turn : 0 );
			m_tolerance[i] =
			    ( m_settings.edge.tolerance != nullptr ? m_settings.edge.tolerance[i] : 0 ) + kept_tolerance * size;
		}
		return m_validator.isEdgeFree( a, b );
	}

	/// A piece of an edge that was proved with the tolerance lies within that, and needs no proof.
	/// @param edge of which a to b is a piece @param cuts of the piece
	bool isPieceFree( std::size_t edge, const double* a, const double* b, unsigned char* cuts )
	{
		const bool kept = m_cuts[edge] < most_cuts;
		*cuts = kept ? static_cast<unsigned char>( m_cuts[edge] + 1 ) : fresh();
		return kept || isFree( a, b );
	}

	/// Cuts of an edge that was proved now.
	unsigned char fresh() const { return m_settings.edge.method == LW_EDGE_CERTIFIED ? 0 : not_kept; }

	/// Replaces the states strictly between `first` and `last` by the given ones. @param cuts of the new edges
	void replace(
	    std::size_t first, std::size_t last, const std::vector<double>& states, const std::vector<unsigned char>& cuts )
	{
		const auto at = [&]( std::size_t i )
		{ return m_path.values.begin() + static_cast<std::ptrdiff_t>( i * m_path.dimension ); };
		const auto place = m_path.values.erase( at( first + 1 ), at( last ) );
		m_path.values.insert( place, states.begin(), states.end() );
		const auto edge = [&]( std::size_t i ) { return m_cuts.begin() + static_cast<std::ptrdiff_t>( i ); };
		m_cuts.insert( m_cuts.erase( edge( first ), edge( last ) ), cuts.begin(), cuts.end() );
		const auto name = [&]( std::size_t i ) { return m_names.begin() + static_cast<std::ptrdiff_t>( i ); };
		const auto names = m_names.insert( m_names.erase( name( first + 1 ), name( last ) ), cuts.size() - 1, 0u );
		std::iota( names, names + static_cast<std::ptrdiff_t>( cuts.size() - 1 ), m_names_used );
		m_names_used += static_cast<std::uint32_t>( cuts.size() - 1 );
	}

	/// Is the edge between two states of the path free? One that failed is not tried again in a later round.
	bool canJoin( std::size_t i, std::size_t j )
	{
		const std::uint64_t names = std::uint64_t( m_names[i] ) << 32 | m_names[j];
		if ( m_failed.count( names ) != 0 )
		{
			return false;
		}
		const bool free = isFree( m_path[i], m_path[j] );
		if ( !free )
		{
			m_failed.insert( names );
		}
		return free;
	}

	std::size_t laterJoins() const
	{
		return static_cast<std::size_t>(
		    std::max( least_join, m_settings.later_joins * static_cast<double>( m_path.count() ) ) );
	}

	/// From each state straight to the last state that can be reached, where that saves enough. Later rounds gain little by it: cut
	/// corners are new states beside old ones, and most far joins fail again.
	/// @param most edges to be replaced by one
	void joinStates( std::size_t most )
	{
		const double worth = least_shortcut * total();
		for ( std::size_t i = 0; i + 2 < m_path.count(); ++i )
		{
			for ( std::size_t j = std::min( m_path.count() - 1, i + most ); j > i + 1 && !over(); --j )
			{
				if ( lengthBetween( i, j ) - m_space.distance( m_path[i], m_path[j] ) >= worth && canJoin( i, j ) )
				{
					replace( i, j, {}, { fresh() } );
					break;
				}
			}
		}
	}

	/// A place at this share of the path's length.
	Place placeAt( double share, double length ) const
	{
		double rest = share * length;
		for ( std::size_t i = 0; i + 2 < m_path.count(); ++i )
		{
			const double edge = m_space.distance( m_path[i], m_path[i + 1] );
			if ( rest < edge )
			{
				return snapped( { i, rest / edge } );
			}
			rest -= edge;
		}
		const std::size_t last = m_path.count() - 2;
		return snapped( { last, std::min( rest / m_space.distance( m_path[last], m_path[last + 1] ), 1.0 ) } );
	}

	static Place snapped( Place place )
	{
		const bool at_end = place.t > 1 - least_piece;
		return { place.edge + at_end, at_end || !( place.t >= least_piece ) ? 0 : place.t };
	}

	/// Appends the place's state.
	void append( const Place& place, std::vector<double>& out ) const
	{
		const std::size_t size = m_path.dimension;
		out.insert( out.end(), m_path[place.edge], m_path[place.edge] + size );
		if ( place.t > 0 )
		{
			m_space.between( m_path[place.edge], m_path[place.edge + 1], place.t, out.data() + out.size() - size );
		}
	}

	/// Joins two places by a straight edge if that saves enough, and it and the rest of their edges are free.
	bool join( const Place& from, const Place& to, double worth )
	{
		m_new.clear();
		append( from, m_new );
		append( to, m_new );
		const double *p = m_new.data(), *q = p + m_path.dimension;
		const std::size_t after = to.edge + ( to.t > 0 ? 1 : 0 ); // the first state that stays
		const double length = m_space.distance( p, m_path[from.edge + 1] ) + lengthBetween( from.edge + 1, to.edge ) +
		                      m_space.distance( m_path[to.edge], q );
		if ( length - m_space.distance( p, q ) < worth )
		{
			return false;
		}
		unsigned char before_cuts = 0, after_cuts = 0;
		if ( !isFree( p, q ) || ( from.t > 0 && !isPieceFree( from.edge, m_path[from.edge], p, &before_cuts ) ) ||
		     ( to.t > 0 && !isPieceFree( to.edge, q, m_path[after], &after_cuts ) ) )
		{
			return false;
		}
		std::vector<unsigned char> cuts;
		if ( to.t <= 0 )
		{
			m_new.resize( m_path.dimension );
		}
		if ( from.t <= 0 )
		{
			m_new.erase( m_new.begin(), m_new.begin() + static_cast<std::ptrdiff_t>( m_path.dimension ) );
		}
		if ( from.t > 0 )
		{
			cuts.push_back( before_cuts );
		}
		cuts.push_back( fresh() );
		if ( to.t > 0 )
		{
			cuts.push_back( after_cuts );
		}
		replace( from.edge, after, m_new, cuts );
		return true;
	}

	void joinPoints()
	{
		for ( unsigned k = 0; k < m_settings.shortcuts && m_path.count() > 2 && !over(); ++k )
		{
			const double length = total(), u = m_random.uniform(), v = m_random.uniform();
			const Place from = placeAt( std::min( u, v ), length ), to = placeAt( std::max( u, v ), length );
			const std::size_t last = to.t > 0 ? to.edge : to.edge - 1;
			if ( to.edge > from.edge && last > from.edge )
			{
				join( from, to, least_shortcut * length );
			}
		}
	}

	/// Each corner between points of its two edges: the middles, or a quarter of the way.
	void cutCorners()
	{
		const double worth = least_corner * total();
		for ( std::size_t i = 1; i + 1 < m_path.count() && m_path.count() < most_states; ++i )
		{
			double share = 0.5;
			for ( unsigned k = 0; k < corner_tries && !over(); ++k, share /= 2 )
			{
				if ( join( { i - 1, 1 - share }, { i, share }, worth ) )
				{
					++i; // the corner is two states now
					break;
				}
			}
		}
	}

	const SmoothSettings& m_settings;
	Space m_space;
	std::vector<double> m_tolerance; ///< with which the next edge is proved
	Validator m_validator;
	Deadline m_deadline;
	Random m_random;
	Path& m_path;
	std::vector<unsigned char> m_cuts;  ///< of each edge: cuts since the proof of an edge that it is a piece of
	std::vector<std::uint32_t> m_names; ///< of each state
	std::uint32_t m_names_used;
	std::unordered_set<std::uint64_t> m_failed; ///< pairs of names: their edge is not free
	std::vector<double> m_new;
};

} // namespace

lw_status smooth( const lw_checker* checker, lw_query* query, const SmoothSettings& settings, const Stop& stop, Path& path,
    Statistics* statistics )
{
	if ( path.dimension == 0 || path.dimension != lw_checker_variable_count( checker ) ||
	     path.values.size() % path.dimension != 0 )
	{
		throw InputError( "leeway::planners: smooth: the path's dimension is not the checker's; give states of its group" );
	}
	if ( !( settings.gain >= 0 && settings.later_joins >= 0 && settings.later_joins <= 1 ) )
	{
		throw InputError( "leeway::planners: SmoothSettings: gain must be at least 0, later_joins 0 to 1" );
	}
	Statistics unused;
	lw_query_reset( query );
	return Smoother( checker, query, settings, stop, path, statistics != nullptr ? *statistics : unused ).run();
}

double length( const lw_checker* checker, const Path& path )
{
	const Space space = Space::ofLimits( checker );
	double sum = 0;
	for ( std::size_t i = 0; i + 1 < path.count(); ++i )
	{
		sum += space.distance( path[i], path[i + 1] );
	}
	return sum;
}

} // namespace leeway::planners
