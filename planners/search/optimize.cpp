// SPDX-License-Identifier: BSD-3-Clause
// Repeated searches for shorter paths: see optimize.hpp.
#include "leeway/planners/optimize.hpp"
#include "leeway/planners/smooth.hpp"

#include "cost_tree.hpp"
#include "ellipsoid.hpp"
#include "samples.hpp"
#include "space.hpp"
#include "validator.hpp"

#include <algorithm>
#include <chrono>

namespace leeway::planners
{

namespace
{

constexpr double first_gain = 0.02, least_gain = 1e-6; // share of the best length that a new path has to save
constexpr std::size_t first_nodes = 1000,
                      most_nodes = 100000; // of one search; after this many it begins anew, with a quarter more
constexpr std::uint64_t most_idle = 100;   // samples for each node that a search may grow by, without growing at all
constexpr unsigned draws = 20;             // of a sample in the informed set, until one lies in the bounds

class Optimizer
{
public:
	Optimizer( const lw_checker* checker, lw_query* query, const OptimizeSettings& settings, const Stop& stop, Path& path,
	    OptimizeReport& report )
	    : m_checker( checker ), m_query( query ), m_settings( settings ), m_stop( stop ), m_report( report ),
	      m_space( checker, settings.search.lower, settings.search.upper ),
	      m_validator( checker, query, settings.search.edge, report.work ), m_deadline( stop ),
	      m_random( settings.search.seed ), m_path( path ), m_trees{ CostTree( m_space ), CostTree( m_space ) },
	      m_sample( m_space.size() ), m_next( m_space.size() ), m_begin( std::chrono::steady_clock::now() )
	{
		m_range =
		    settings.search.range > 0 ? settings.search.range : geometricRange( checker, m_space.lower(), m_space.upper() );
	}

	lw_status run()
	{
		m_best = lengthOf( m_path );
		note();
		addEnds();
		const double shortest = shortestLine();
		while ( !over() && m_best > shortest * ( 1 + least_gain ) )
		{
			++m_report.searches;
			if ( search() )
			{
				m_nodes = std::max( m_nodes - m_nodes / 4, first_nodes );
			}
			else // nothing shorter was near: look longer for less
			{
				m_nodes = std::min( m_nodes + m_nodes / 4, most_nodes );
				m_gain = std::max( m_gain / 2, least_gain );
			}
		}
		return status();
	}

private:
	lw_status status() const { return m_validator.status() != LW_OK ? m_validator.status() : m_smoothing; }
	bool over() { return m_deadline.over() || status() != LW_OK || m_report.samples >= m_settings.most_samples; }

	double lengthOf( const Path& path ) const
	{
		double sum = 0;
		for ( std::size_t i = 0; i + 1 < path.count(); ++i )
		{
			sum += m_space.distance( path[i], path[i + 1] );
		}
		return sum;
	}

	double passed() const { return std::chrono::duration<double>( std::chrono::steady_clock::now() - m_begin ).count(); }

	void note() { m_report.improvements.push_back( { passed(), m_report.samples, m_best } ); }

	/// The path's own ends, and those of the settings that are free.
	void addEnds()
	{
		for ( unsigned side = 0; side < 2; ++side )
		{
			const double* own = m_path[side == 0 ? 0 : m_path.count() - 1];
			m_ends[side].assign( own, own + m_space.size() );
			const std::vector<double>& more = side == 0 ? m_settings.starts : m_settings.goals;
			for ( std::size_t i = 0; i < more.size() && !over(); i += m_space.size() )
			{
				if ( m_space.firstUnusable( more.data() + i ) == m_space.size() &&
				     m_space.distance( more.data() + i, own ) > 0 && m_validator.isStateFree( more.data() + i ) )
				{
					m_ends[side].insert( m_ends[side].end(), more.data() + i, more.data() + i + m_space.size() );
				}
			}
		}
	}

	std::size_t endCount( unsigned side ) const { return m_ends[side].size() / m_space.size(); }
	const double* end( unsigned side, std::size_t i ) const { return m_ends[side].data() + i * m_space.size(); }

	/// Distance to the nearest end of a side: no path from there to q is shorter.
	double toEnd( unsigned side, const double* q ) const
	{
		double least = HUGE_VAL;
		for ( std::size_t i = 0; i < endCount( side ); ++i )
		{
			least = std::min( least, m_space.distance( q, end( side, i ) ) );
		}
		return least;
	}

	double shortestLine() const
	{
		double least = HUGE_VAL;
		for ( std::size_t i = 0; i < endCount( 0 ); ++i )
		{
			least = std::min( least, toEnd( 1, end( 0, i ) ) );
		}
		return least;
	}

	/// Grows both trees until they join in a path shorter than the bound, or are full. @return true if the path is shorter now
	bool search()
	{
		m_bound = m_best * ( 1 - m_gain );
		for ( unsigned side = 0; side < 2; ++side )
		{
			m_trees[side].clear();
			for ( std::size_t i = 0; i < endCount( side ); ++i )
			{
				m_trees[side].add( end( side, i ), CostTree::none, 0 );
			}
		}
		makeEllipsoids();
		if ( m_ellipsoids.empty() )
		{
			return false;
		}
		for ( std::uint64_t idle = 0;
		      idle < most_idle * m_nodes && m_trees[0].size() + m_trees[1].size() < m_nodes && !over(); ++idle )
		{
			++m_report.samples;
			if ( grow() )
			{
				return take();
			}
		}
		return false;
	}

	void makeEllipsoids()
	{
		m_ellipsoids.clear();
		for ( std::size_t s = 0; s < endCount( 0 ); ++s )
		{
			for ( std::size_t g = 0; g < endCount( 1 ); ++g )
			{
				if ( m_space.distance( end( 0, s ), end( 1, g ) ) < m_bound )
				{
					m_ellipsoids.emplace_back( m_space, end( 0, s ), end( 1, g ), m_bound );
				}
			}
		}
	}

	/// Uniform in the ball of this radius around the origin.
	void drawBall( double radius )
	{
		double square = 0;
		for ( double& x : m_sample ) // Box and Muller
		{
			const double u = 1 - m_random.uniform(), v = m_random.uniform();
			x = std::sqrt( -2 * std::log( u ) ) * std::cos( full_turn * v );
			square += x * x;
		}
		const double scale = radius * std::pow( m_random.uniform(), 1 / static_cast<double>( m_space.size() ) ) /
		                     std::sqrt( std::max( square, 1e-300 ) );
		for ( double& x : m_sample )
		{
			x *= scale;
		}
	}

	/// Near a node of the tree, or in an ellipsoid; of joints that wrap, the ways around the other side too.
	void drawSample( const CostTree& tree )
	{
		if ( m_random.uniform() < m_settings.local_share )
		{
			const double* center = tree.state( static_cast<std::uint32_t>( m_random.below( tree.size() ) ) );
			drawBall( m_settings.local_radius * m_range );
			for ( std::size_t i = 0; i < m_space.size(); ++i )
			{
				m_sample[i] += center[i];
			}
		}
		else if ( m_space.anyWraps() && m_random.uniform() < 0.5 )
		{
			for ( std::size_t i = 0; i < m_space.size(); ++i )
			{
				m_sample[i] = m_space.lower()[i] + m_random.uniform() * ( m_space.upper()[i] - m_space.lower()[i] );
			}
		}
		else
		{
			const Ellipsoid& ellipsoid = m_ellipsoids[m_random.below( m_ellipsoids.size() )];
			unsigned draw = 0;
			do
			{
				drawBall( 1 );
				ellipsoid.map( m_sample.data() );
			} while ( m_space.firstUnusable( m_sample.data() ) < m_space.size() && ++draw < draws );
		}
		m_space.normalise( m_sample.data() );
	}

	/// One edge of the smaller tree towards a sample, then steps to the other tree. @return true if they met: m_found
	bool grow()
	{
		const unsigned side = m_trees[0].size() <= m_trees[1].size() ? 0 : 1;
		CostTree& tree = m_trees[side];
		drawSample( tree );
		const double from = toEnd( side, m_sample.data() ), to = toEnd( 1 - side, m_sample.data() );
		if ( from + to >= m_bound )
		{
			return false;
		}
		// The cost of the sample: between that of a straight line, and the most that can still be part of a shorter path
		const double cost = from + m_random.uniform() * ( m_bound - from - to );
		const std::uint32_t near = tree.nearest( m_sample.data(), cost );
		if ( near == CostTree::none )
		{
			return false;
		}
		const double distance = m_space.distance( tree.state( near ), m_sample.data() );
		if ( !( distance > 0 ) )
		{
			return false;
		}
		m_space.between( tree.state( near ), m_sample.data(), std::min( 1.0, std::min( m_range, longest_turn ) / distance ),
		    m_next.data() );
		const std::uint32_t node = extend( side, near );
		return node != CostTree::none && connect( side, node );
	}

	/// Adds m_next to the tree if it can be part of a shorter path, and is free with its edge.
	std::uint32_t extend( unsigned side, std::uint32_t near )
	{
		CostTree& tree = m_trees[side];
		const double cost = tree.cost( near ) + m_space.distance( tree.state( near ), m_next.data() );
		if ( cost + toEnd( 1 - side, m_next.data() ) >= m_bound || !m_validator.isStateFree( m_next.data() ) ||
		     !m_validator.isEdgeFree( tree.state( near ), m_next.data() ) )
		{
			return CostTree::none;
		}
		return tree.add( m_next.data(), near, cost );
	}

	/// Steps of equal length to the nearest node of the other tree with which the path is shorter.
	bool connect( unsigned side, std::uint32_t node )
	{
		CostTree &tree = m_trees[side], &other = m_trees[1 - side];
		const std::uint32_t goal = other.nearest( tree.state( node ), m_bound - tree.cost( node ) );
		if ( goal == CostTree::none )
		{
			return false;
		}
		const double distance = m_space.distance( tree.state( node ), other.state( goal ) );
		const auto steps =
		    static_cast<unsigned>( std::max( 1.0, std::ceil( distance / std::min( m_range, longest_turn ) ) ) );
		for ( unsigned step = 1; step < steps; ++step )
		{
			m_space.between( tree.state( node ), other.state( goal ), 1.0 / ( steps - step + 1 ), m_next.data() );
			node = extend( side, node );
			if ( node == CostTree::none )
			{
				return false;
			}
		}
		if ( !m_validator.isEdgeFree( tree.state( node ), other.state( goal ) ) )
		{
			return false;
		}
		m_found.dimension = m_space.size();
		m_found.values.clear();
		append( m_trees[0], side == 0 ? node : goal );
		for ( std::size_t i = 0, j = m_found.count(); i + 1 < j; ++i )
		{
			--j;
			std::swap_ranges( m_found[i], m_found[i] + m_found.dimension, m_found[j] );
		}
		append( m_trees[1], side == 0 ? goal : node );
		return true;
	}

	void append( const CostTree& tree, std::uint32_t node )
	{
		for ( ; node != CostTree::none; node = tree.parent( node ) )
		{
			m_found.values.insert( m_found.values.end(), tree.state( node ), tree.state( node ) + m_space.size() );
		}
	}

	/// The found path, smoothed, becomes the best if it is shorter and its edges are FREE as anybody would ask for them.
	bool take()
	{
		SmoothSettings smoothing;
		smoothing.edge = m_settings.search.edge;
		smoothing.seed = m_random.next();
		smoothing.later_joins = 1;
		smoothing.rounds = 8; // milliseconds, beside a search of a tenth of a second
		smoothing.gain = 0.002;
		smoothing.shortcuts = 16;
		Stop rest = m_stop;
		rest.seconds = m_stop.seconds - passed();
		const Path raw = m_found;
		m_smoothing = smooth( m_checker, m_query, smoothing, rest, m_found, &m_report.work );
		for ( const Path* path : { static_cast<const Path*>( &m_found ), &raw } )
		{
			const double length = lengthOf( *path );
			if ( length < m_best && isFree( *path ) )
			{
				m_path = *path;
				m_best = length;
				note();
				return true;
			}
		}
		return false;
	}

	/// All edges in their order, with a cold query: within the slack a proof may depend on the edges before.
	bool isFree( const Path& path )
	{
		lw_query_reset( m_query );
		for ( std::size_t i = 0; i + 1 < path.count(); ++i )
		{
			if ( m_space.partCount( path[i], path[i + 1] ) > 1 || !m_validator.isEdgeFree( path[i], path[i + 1] ) )
			{
				return false;
			}
		}
		return true;
	}

	const lw_checker* m_checker;
	lw_query* m_query;
	const OptimizeSettings& m_settings;
	const Stop& m_stop;
	OptimizeReport& m_report;
	Space m_space;
	Validator m_validator;
	lw_status m_smoothing = LW_OK; ///< of the smoother, which has a validator of its own
	Deadline m_deadline;
	Random m_random;
	Path& m_path;
	Path m_found;
	CostTree m_trees[2];
	std::vector<Ellipsoid> m_ellipsoids;
	std::vector<double> m_ends[2], m_sample, m_next;
	std::chrono::steady_clock::time_point m_begin;
	double m_range, m_best = 0, m_bound = 0, m_gain = first_gain;
	std::size_t m_nodes = first_nodes;
};

} // namespace

lw_status optimize( const lw_checker* checker, lw_query* query, const OptimizeSettings& settings, const Stop& stop,
    Path& path, OptimizeReport* report )
{
	const auto need = []( bool condition, const char* sentence )
	{
		if ( !condition )
		{
			throw InputError( std::string( "leeway::planners: optimize: " ) + sentence );
		}
	};
	const std::size_t size = lw_checker_variable_count( checker );
	need( path.dimension == size && path.count() > 0 && path.values.size() % size == 0,
	    "the path's dimension is not the checker's; give states of its group" );
	need( std::all_of( path.values.begin(), path.values.end(), []( double value ) { return std::isfinite( value ); } ),
	    "the path has a value that is not finite" );
	need( settings.starts.size() % size == 0 && settings.goals.size() % size == 0, "starts and goals need whole states" );
	need( settings.local_share >= 0 && settings.local_share <= 1, "local_share must be 0 to 1" );
	need( settings.local_radius > 0 && std::isfinite( settings.local_radius ), "local_radius must be finite and above 0" );
	need( std::isfinite( stop.seconds ) || stop.cancel != nullptr || stop.poll != nullptr ||
	          settings.most_samples < UINT64_MAX,
	    "give a time, a sample limit, or a way to cancel it: it does not end by itself" );
	requireUsable( settings.search );
	OptimizeReport unused;
	OptimizeReport& to = report != nullptr ? *report : unused;
	to = {};
	lw_query_reset( query );
	return Optimizer( checker, query, settings, stop, path, to ).run();
}

} // namespace leeway::planners
