// SPDX-License-Identifier: BSD-3-Clause
// Proofs of motions in time, and a look at some states before each.
#include "timed_motion.hpp"

#include "space.hpp"

#include <algorithm>
#include <cmath>

namespace leeway::planners
{

void needOfSettings( bool condition, const std::string& sentence )
{
	if ( !condition )
	{
		throw InputError( "leeway::planners: TimedSettings: " + sentence );
	}
}

double endOf( const lw_track& track )
{
	const lw_timed_piece& last = track.pieces[track.piece_count - 1];
	return ( last.degree > 0 ? last.end : last.start ) + track.lag;
}

TimedMotion::TimedMotion( Checker checker, const TimedSettings& settings, const lw_clock& others, Statistics& statistics )
    : m_checker( std::move( checker ) ), m_settings( settings ), m_statistics( statistics )
{
	needOfSettings( static_cast<bool>( m_checker ), "no checker" );
	const std::size_t n = settings.variables.size();
	needOfSettings( settings.velocity.size() == n, "give a velocity for each variable" );
	needOfSettings( settings.tolerance.empty() || settings.tolerance.size() == n,
	    "tolerance has to be empty, or one for each variable" );
	needOfSettings( settings.lag >= 0 && std::isfinite( settings.lag ), "lag has to be finite and at least 0" );
	needOfSettings( others.rest != nullptr, "the tracks of others need `rest`" );
	m_tracks.assign( others.tracks, others.tracks + others.track_count );
	m_rest.assign( others.rest, others.rest + lw_checker_variable_count( m_checker.get() ) );
	m_state.resize( m_rest.size() );
	m_points.assign( 2 * n, 0.0 );
	addControllers();
	setPlanned( { 0 }, m_points.data() );
	m_clock = { m_tracks.data(), static_cast<std::uint32_t>( m_tracks.size() ), m_rest.data() };
	lw_diag diag = {};
	const bool usable = lw_clock_check( m_checker.get(), &m_clock, &diag ) == LW_OK;
	needOfSettings( usable, diag.message );
	for ( std::size_t i = 0; i < n; ++i )
	{
		m_wraps.push_back( infoOf( i ).wraps && settings.lower.empty() );
	}
}

void TimedMotion::addControllers()
{
	const std::size_t n = m_settings.variables.size();
	const std::vector<std::size_t> sizes =
	    m_settings.controllers.empty() ? std::vector<std::size_t>{ n } : m_settings.controllers;
	std::size_t first = 0;
	for ( const std::size_t count : sizes )
	{
		needOfSettings(
		    count > 0 && count <= n - first, "controllers have to be above 0, and as many as variables together" );
		lw_track own = {};
		own.variables = m_settings.variables.data() + first;
		own.variable_count = static_cast<std::uint32_t>( count );
		own.tolerance = m_settings.tolerance.empty() ? nullptr : m_settings.tolerance.data() + first;
		own.lag = m_settings.lag;
		m_tracks.push_back( own );
		m_controlled.push_back( { first, count, {}, {} } );
		first += count;
	}
	needOfSettings( first == n, "controllers have to be as many as variables together" );
}

lw_variable_info TimedMotion::infoOf( std::size_t i ) const
{
	return lw_robot_variable(
	    lw_checker_robot( m_checker.get() ), lw_checker_variable( m_checker.get(), m_settings.variables[i] ) );
}

void TimedMotion::begin( lw_query* query )
{
	m_query = query;
	m_status = LW_OK;
	lw_query_reset( query );
}

double TimedMotion::difference( std::size_t i, double a, double b ) const
{
	return wraps( i ) ? std::remainder( b - a, full_turn ) : b - a;
}

double TimedMotion::least( const double* a, const double* b ) const
{
	double longest = 0;
	for ( std::size_t i = 0; i < m_settings.velocity.size(); ++i )
	{
		longest = std::max( longest, std::abs( difference( i, a[i], b[i] ) ) / m_settings.velocity[i] );
	}
	return longest;
}

void TimedMotion::findBounds( std::vector<double>& lower, std::vector<double>& upper ) const
{
	const std::size_t n = m_settings.variables.size();
	needOfSettings(
	    m_settings.lower.size() == m_settings.upper.size() && ( m_settings.lower.empty() || m_settings.lower.size() == n ),
	    "lower and upper have to be empty, or one for each variable" );
	lower = m_settings.lower;
	upper = m_settings.upper;
	for ( std::size_t i = 0; i < n && m_settings.lower.empty(); ++i )
	{
		const lw_variable_info info = infoOf( i );
		lower.push_back( info.wraps ? -0.5 * full_turn : info.lower );
		upper.push_back( info.wraps ? 0.5 * full_turn : info.upper );
	}
	for ( std::size_t i = 0; i < n; ++i )
	{
		needOfSettings( std::isfinite( lower[i] ) && std::isfinite( upper[i] ) && lower[i] <= upper[i],
		    "variable " + std::to_string( m_settings.variables[i] ) + " has no finite bounds; give lower and upper" );
	}
}

double TimedMotion::othersEnd() const
{
	double end = m_settings.start_time;
	for ( std::size_t i = 0; i + m_controlled.size() < m_tracks.size(); ++i )
	{
		end = std::max( end, endOf( m_tracks[i] ) );
	}
	return end;
}

void TimedMotion::setPlanned( const std::vector<double>& times, const double* states )
{
	const std::size_t n = m_settings.variables.size(), states_count = times.size();
	lw_track* track = &m_tracks[m_tracks.size() - m_controlled.size()];
	for ( Controlled& c : m_controlled )
	{
		c.points.resize( states_count * c.count );
		c.pieces.clear();
		for ( std::size_t k = 0; k < states_count; ++k )
		{
			std::copy_n( states + k * n + c.first, c.count, c.points.begin() + static_cast<std::ptrdiff_t>( k * c.count ) );
		}
		for ( std::size_t k = 0; k + 1 < states_count; ++k )
		{
			c.pieces.push_back( { times[k], times[k + 1], 1, c.points.data() + k * c.count } );
		}
		if ( states_count == 1 )
		{
			c.pieces.push_back( { times[0], times[0] + 1, 0, c.points.data() } );
		}
		track->pieces = c.pieces.data();
		track->piece_count = static_cast<std::uint32_t>( c.pieces.size() );
		++track;
	}
}

/// All that moves at a time.
bool TimedMotion::isMomentFree( double time )
{
	bool free = false;
	++m_statistics.states;
	const lw_edge_def& edge = m_settings.timed.edge;
	lw_status status = lw_clock_state( m_checker.get(), &m_clock, time, m_state.data() );
	status = status != LW_OK
	             ? status
	             : lw_checker_is_free( m_checker.get(), m_query, m_state.data(), edge.flags, edge.min_d, &free, nullptr );
	m_status = m_status != LW_OK ? m_status : status;
	m_statistics.states_free += free;
	return free && status == LW_OK;
}

/// Three states inside of the motion; proves nothing.
bool TimedMotion::seemsFree( double from, double to )
{
	const double length = to - from;
	return isMomentFree( from + 0.5 * length ) && isMomentFree( from + 0.25 * length ) &&
	       isMomentFree( from + 0.75 * length );
}

bool TimedMotion::isStateFree( const double* q, double time )
{
	m_times.assign( 1, time );
	setPlanned( m_times, q );
	return isMomentFree( time );
}

bool TimedMotion::prove( double from, double to )
{
	++m_statistics.edges;
	const lw_status status = lw_checker_timed( m_checker.get(), m_query, &m_clock, from, to, &m_settings.timed, &m_last );
	m_status = m_status != LW_OK ? m_status : status;
	m_statistics.edge_queries += m_last.queries;
	m_statistics.free += m_last.verdict == LW_VERDICT_FREE;
	m_statistics.blocked += m_last.verdict == LW_VERDICT_BLOCKED;
	m_statistics.undecided += m_last.verdict == LW_VERDICT_UNDECIDED;
	return m_status == LW_OK && m_last.verdict == LW_VERDICT_FREE;
}

bool TimedMotion::proveShifted( double from, double to )
{
	return prove( std::max( std::min( m_settings.start_time, from ), from - m_settings.lag ), to + m_settings.lag );
}

bool TimedMotion::isFree( const double* a, double from, const double* b, double to )
{
	if ( !( to > from ) )
	{
		return false;
	}
	const std::size_t n = m_settings.variables.size();
	std::copy_n( a, n, m_points.begin() );
	for ( std::size_t i = 0; i < n; ++i )
	{
		m_points[n + i] = wraps( i ) ? a[i] + difference( i, a[i], b[i] ) : b[i];
	}
	m_times.assign( { from, to } );
	setPlanned( m_times, m_points.data() );
	return seemsFree( from, to ) && proveShifted( from, to );
}

bool TimedMotion::isRestFree( const double* q, double from, double to )
{
	m_times.assign( 1, from );
	setPlanned( m_times, q );
	return proveShifted( from, std::max( from, to ) );
}

bool TimedMotion::isPathFree( const TimedPath& path, double from, double to )
{
	setPlanned( path.times, path.values.data() );
	return prove( from, to );
}

std::string TimedMotion::lastPair() const
{
	if ( m_last.pair.kind == LW_CLEARANCE_UNKNOWN )
	{
		return "no pair is named";
	}
	const lw_robot* robot = lw_checker_robot( m_checker.get() );
	const lw_scene* scene = lw_checker_scene( m_checker.get() );
	const std::string a = lw_robot_link_name( robot, m_last.pair.a );
	const std::string b =
	    m_last.self ? lw_robot_link_name( robot, m_last.pair.b ) : lw_scene_object_name( scene, m_last.pair.b );
	return a + " and " + b + ", at " + std::to_string( m_last.time ) + " s";
}

} // namespace leeway::planners
