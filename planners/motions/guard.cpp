// SPDX-License-Identifier: BSD-3-Clause
// A motion that runs while its world changes: see guard.hpp.
#include "leeway/motions/guard.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <numeric>

namespace leeway::motions
{
namespace
{

double steadyMicroseconds( void* )
{
	return std::chrono::duration<double, std::micro>( std::chrono::steady_clock::now().time_since_epoch() ).count();
}

/// Segments as pieces, which may overlap by rounding.
std::vector<lw_timed_piece> piecesOf( const std::vector<Segment>& segments )
{
	std::vector<lw_timed_piece> pieces;
	for ( std::size_t i = 0; i < segments.size(); ++i )
	{
		const double end = segments[i].begin + segments[i].seconds;
		pieces.push_back( { segments[i].begin, i + 1 < segments.size() ? std::min( end, segments[i + 1].begin ) : end,
		    segments[i].degree, segments[i].points.data() } );
	}
	return pieces;
}

void require( lw_status status, const std::string& file, const char* question )
{
	if ( status != LW_OK )
	{
		throw io::Error( file, question, fmt::format( "is refused: {}", lw_status_name( status ) ),
		    "see leeway/guard.h for what the arguments may be" );
	}
}

} // namespace

Guard::Guard( const io::Problem& problem, const std::vector<Segment>& segments, const GuardSettings& settings )
    : m_file( "guard" ), m_end( segments.empty() ? 0 : segments.back().begin + segments.back().seconds )
{
	const std::size_t count = problem.variables.size();
	if ( segments.empty() || count == 0 )
	{
		throw io::Error( m_file, "motion", "has no segment, or the group has no joint", "give a trajectory" );
	}
	const auto sized = [&]( const std::vector<double>& values ) { return values.empty() || values.size() == count; };
	if ( !sized( settings.tolerance ) || !sized( settings.deceleration ) )
	{
		throw io::Error( m_file, "tolerance, deceleration",
		    fmt::format( "have {} and {} entries", settings.tolerance.size(), settings.deceleration.size() ),
		    fmt::format( "give {}, one for each variable of the group", count ) );
	}
	const std::vector<lw_timed_piece> pieces = piecesOf( segments );
	std::vector<std::uint32_t> variables( count );
	std::iota( variables.begin(), variables.end(), 0u );
	lw_track track{};
	track.variables = variables.data();
	track.variable_count = static_cast<std::uint32_t>( count );
	track.pieces = pieces.data();
	track.piece_count = static_cast<std::uint32_t>( pieces.size() );
	track.lag = settings.lag;
	track.tolerance = settings.tolerance.empty() ? nullptr : settings.tolerance.data();
	const std::vector<double> rest = io::startState( problem );
	make( problem, { &track, 1, rest.data() }, settings );
}

Guard::Guard( const io::Problem& problem, const lw_clock& clock, double end, const GuardSettings& settings )
    : m_file( "guard" ), m_end( end )
{
	if ( !settings.tolerance.empty() || !settings.deceleration.empty() || settings.lag != 0 )
	{
		throw io::Error( m_file, "tolerance, deceleration, lag", "are those of one track", "give them with the tracks" );
	}
	make( problem, clock, settings );
}

void Guard::make( const io::Problem& problem, const lw_clock& clock, const GuardSettings& settings )
{
	lw_guard_def def = lw_guard_def_default();
	def.checker = problem.checker.get();
	def.clock = &clock;
	def.end = m_end;
	def.timed.edge = settings.edge;
	def.timed.edge.tolerance = nullptr;
	def.timed.contact_resolution = settings.contact_resolution;
	def.window = settings.window;
	def.braking = settings.deceleration.empty() ? LW_INVALID_INDEX : 0;
	def.deceleration = settings.deceleration.empty() ? nullptr : settings.deceleration.data();
	def.reaction = settings.reaction;
	def.spare_shapes = settings.spare_shapes;
	def.spare_bodies = settings.spare_bodies;
	def.microseconds = steadyMicroseconds;
	lw_guard* guard = nullptr;
	lw_diag diag{};
	const lw_status status = lw_guard_create( &def, nullptr, &diag, &guard );
	if ( status != LW_OK )
	{
		throw io::Error( m_file, "motion", diag.message, "change the motion or the settings" );
	}
	m_guard.reset( guard );
}

void Guard::publish( const Checker& checker, std::uint64_t stamp )
{
	lw_diag diag{};
	if ( lw_guard_publish( m_guard.get(), checker.get(), stamp, &diag ) != LW_OK )
	{
		throw io::Error( m_file, "world", diag.message, "until another world is published, all answers are UNDECIDED" );
	}
}

lw_guard_answer Guard::ask( double now, double budget )
{
	lw_guard_answer answer;
	require( lw_guard_ask( m_guard.get(), now, budget, &answer ), m_file, "ask" );
	return answer;
}

lw_guard_answer Guard::stop( double from, double budget )
{
	lw_guard_answer answer;
	require( lw_guard_stop( m_guard.get(), from, budget, &answer ), m_file, "stop" );
	return answer;
}

double Guard::brakeBy( double now, double until, double step, double budget )
{
	double time = 0;
	require( lw_guard_brake_by( m_guard.get(), now, until, step, budget, &time ), m_file, "brake_by" );
	return time;
}

lw_guard_scale Guard::speed( const lw_separation& separation, double now, double age, double highest, double budget )
{
	lw_guard_scale scale;
	require( lw_guard_speed( m_guard.get(), &separation, now, age, highest, budget, &scale ), m_file, "speed" );
	return scale;
}

} // namespace leeway::motions
