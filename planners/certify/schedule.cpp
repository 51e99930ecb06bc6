// SPDX-License-Identifier: BSD-3-Clause
// Schedules of several robots on one clock as pieces of one curve, and the tubes around it: FORMAT.md, "One clock"
#include "certify/schedule.hpp"

#include <algorithm>
#include <limits>

namespace leeway::certify
{
namespace
{

constexpr double touching = 1e-6; ///< seconds: pieces that lags reach up to this are reached

/// Control points of a curve of a higher degree that is the same.
std::vector<double> raised( std::vector<double> points, std::size_t variables, unsigned degree )
{
	for ( std::size_t n = points.size() / variables - 1; n < degree; ++n )
	{
		std::vector<double> next( ( n + 2 ) * variables );
		for ( std::size_t i = 0; i <= n + 1; ++i )
		{
			const double s = double( i ) / double( n + 1 );
			for ( std::size_t j = 0; j < variables; ++j )
			{
				const double before = i > 0 ? points[( i - 1 ) * variables + j] : 0;
				const double at = i <= n ? points[i * variables + j] : 0;
				next[i * variables + j] = before == at ? at : s * before + ( 1 - s ) * at;
			}
		}
		points.swap( next );
	}
	return points;
}

/// The motion of a track's variables from one time to a later one, between which none of its pieces ends.
std::vector<double> trackPart( const lw_track& track, double from, double to )
{
	const std::size_t n = track.variable_count;
	const lw_timed_piece* last = nullptr;
	for ( std::uint32_t i = 0; i < track.piece_count; ++i )
	{
		const lw_timed_piece& piece = track.pieces[i];
		if ( piece.start <= from && to <= piece.end )
		{
			const std::vector<double> points( piece.points, piece.points + ( piece.degree + 1 ) * n );
			const double span = piece.end - piece.start;
			return partOf( points, n, ( from - piece.start ) / span, ( to - piece.start ) / span );
		}
		last = piece.end <= from ? &piece : last;
	}
	// At rest: at the end of the piece before, or at the beginning of the first one
	const double* at = last != nullptr ? last->points + last->degree * n : track.pieces[0].points;
	return { at, at + n };
}

/// Times at which a track may begin or end a piece, in order, and the ends of the interval.
std::vector<double> timesOf( const lw_clock& clock, double from, double to )
{
	std::vector<double> times{ from, to };
	for ( std::uint32_t t = 0; t < clock.track_count; ++t )
	{
		for ( std::uint32_t i = 0; i < clock.tracks[t].piece_count; ++i )
		{
			for ( const double at : { clock.tracks[t].pieces[i].start, clock.tracks[t].pieces[i].end } )
			{
				if ( at > from && at < to )
				{
					times.push_back( at );
				}
			}
		}
	}
	std::sort( times.begin(), times.end() );
	times.erase( std::unique( times.begin(), times.end() ), times.end() );
	if ( times.size() == 1 )
	{
		times.push_back( from );
	}
	return times;
}

} // namespace

std::vector<double> partOf( const std::vector<double>& points, std::size_t variables, double from, double to )
{
	const std::size_t degree = points.size() / variables - 1;
	std::vector<double> row = points, out = points;
	/// Cuts `row` at t and keeps one side of it in `out`
	const auto cut = [&]( double t, bool keeps_first )
	{
		for ( std::size_t level = 0; level <= degree; ++level )
		{
			for ( std::size_t j = 0; j < variables; ++j )
			{
				const std::size_t place = keeps_first ? level : degree - level;
				out[place * variables + j] = row[( keeps_first ? 0 : degree - level ) * variables + j];
			}
			for ( std::size_t i = 0; i < ( degree - level ) * variables; ++i )
			{
				row[i] = row[i] == row[i + variables] ? row[i] : ( 1 - t ) * row[i] + t * row[i + variables];
			}
		}
		row = out;
	};
	if ( to < 1 )
	{
		cut( std::max( to, 0.0 ), true );
	}
	if ( from > 0 )
	{
		cut( to > 0 ? std::min( from / to, 1.0 ) : 0, false );
	}
	return row;
}

void halvePiece( std::vector<Piece>& pieces, std::size_t k, std::size_t variables )
{
	const Piece whole = pieces[k];
	Piece half = { whole.degree, partOf( whole.points, variables, 0, 0.5 ), whole.seconds / 2 };
	pieces[k] = { whole.degree, partOf( whole.points, variables, 0.5, 1 ), whole.seconds / 2 };
	std::copy( half.points.end() - std::ptrdiff_t( variables ), half.points.end(), pieces[k].points.begin() );
	pieces.insert( pieces.begin() + std::ptrdiff_t( k ), std::move( half ) );
}

std::vector<Deviation> deviationsOf( const Model& model, const Settings& settings )
{
	std::vector<Deviation> out( model.variables.size() );
	for ( std::size_t j = 0; j < out.size() && !settings.tolerance.empty(); ++j )
	{
		out[j].tolerance = settings.tolerance[j];
	}
	for ( std::uint32_t t = 0; t < settings.tracks.size(); ++t )
	{
		const Track& track = settings.tracks[t];
		for ( const std::uint32_t j : track.variables )
		{
			out[j].track = t + 1;
			out[j].lag = track.lag;
		}
		// Its uppermost joints that shift: bodies below them, and no others, leave their places
		std::vector<bool> below( model.links.size(), false );
		for ( std::size_t i = 1; i < model.links.size(); ++i )
		{
			const Link& link = model.links[i];
			const bool shifts = link.type == Link::shift && link.variable != nothing && out[link.variable].track == t + 1;
			below[i] = below[link.parent] || shifts;
			if ( shifts && !below[link.parent] && track.spread > 0 )
			{
				// By the joint's value, of which a part may go into the place
				out[link.variable].spread =
				    std::max( out[link.variable].spread, track.spread / std::fabs( link.multiplier ) );
				out[link.variable].since = track.since;
			}
		}
	}
	return out;
}

Tubes tubesOf( const std::vector<Piece>& pieces, std::size_t k, double begin, const std::vector<Deviation>& deviations )
{
	const std::size_t variables = deviations.size();
	std::vector<double> times{ begin };
	for ( const Piece& piece : pieces )
	{
		times.push_back( times.back() + piece.seconds );
	}
	double most_lag = 0;
	for ( const Deviation& deviation : deviations )
	{
		most_lag = std::max( most_lag, deviation.lag );
	}
	Tubes tubes;
	for ( std::size_t j = 0; j < variables; ++j )
	{
		const Deviation& own = deviations[j];
		const double spread_until = std::min( times[k + 1] + most_lag, times.back() );
		tubes.timely.push_back( own.tolerance + own.spread * std::max( 0.0, spread_until - own.since ) );
		double low = pieces[k].points[j], high = low, speed = 0;
		const auto take = [&]( std::size_t i )
		{
			const Piece& piece = pieces[i];
			for ( unsigned l = 0; l <= piece.degree; ++l )
			{
				const double at = piece.points[l * variables + j],
				             before = piece.points[( l > 0 ? l - 1 : 0 ) * variables + j];
				low = std::min( low, at );
				high = std::max( high, at );
				if ( at != before )
				{
					speed = std::max( speed, piece.degree * std::fabs( at - before ) / piece.seconds );
				}
			}
		};
		for ( std::size_t i = k; own.lag > 0 && i < pieces.size() && times[i] <= times[k + 1] + own.lag + touching; ++i )
		{
			take( i );
		}
		for ( std::size_t i = k; own.lag > 0 && i > 0 && times[i] >= times[k] - own.lag - touching; --i )
		{
			take( i - 1 );
		}
		tubes.late.push_back( own.lag > 0 ? std::min( high - low, own.lag * speed ) : 0 );
	}
	return tubes;
}

void setLate( const Model& model, const std::vector<Piece>& pieces, const std::vector<Deviation>& deviations,
    std::vector<Pair>& pairs )
{
	const std::size_t variables = deviations.size();
	std::vector<bool> moves( variables, false );
	for ( const Piece& piece : pieces )
	{
		for ( std::size_t i = 0; i < piece.points.size(); ++i )
		{
			moves[i % variables] = moves[i % variables] || piece.points[i] != pieces.front().points[i % variables];
		}
	}
	for ( Pair& pair : pairs )
	{
		std::uint32_t track = nothing;
		pair.late = false;
		for ( const std::uint32_t body : { pair.a, pair.object ? nothing : pair.b } )
		{
			for ( std::uint32_t at = body != nothing ? model.bodies[body].owner : 0; at > pair.ancestor;
			      at = model.links[at].parent )
			{
				const std::uint32_t variable = model.links[at].variable;
				if ( variable != nothing && moves[variable] )
				{
					pair.late = pair.late || ( track != nothing && track != deviations[variable].track );
					track = deviations[variable].track;
				}
			}
		}
	}
}

Schedule scheduleOf( const io::Problem& problem, const lw_clock& clock, double from, double to )
{
	require( lw_clock_check( problem.checker.get(), &clock, nullptr ), "lw_clock_check" );
	const std::size_t variables = problem.variables.size();
	Schedule out;
	out.tolerance.assign( variables, 0 );
	double most_lag = 0;
	for ( std::uint32_t t = 0; t < clock.track_count; ++t )
	{
		const lw_track& track = clock.tracks[t];
		out.tracks.push_back( { { track.variables, track.variables + track.variable_count }, track.lag, track.spread_speed,
		    track.spread_start } );
		for ( std::uint32_t i = 0; i < track.variable_count && track.tolerance != nullptr; ++i )
		{
			out.tolerance[track.variables[i]] = track.tolerance[i];
		}
		most_lag = std::max( most_lag, track.lag );
	}
	out.begin = from - most_lag;
	const std::vector<double> times = timesOf( clock, from - most_lag, to + most_lag );
	std::vector<double> moved( variables, 0 ); // how far pieces are from those of the tracks
	for ( std::size_t k = 0; k + 1 < times.size(); ++k )
	{
		std::vector<std::vector<double>> parts;
		Piece piece{ 1, {}, times[k + 1] - times[k] };
		for ( std::uint32_t t = 0; t < clock.track_count; ++t )
		{
			parts.push_back( trackPart( clock.tracks[t], times[k], times[k + 1] ) );
			piece.degree = std::max( piece.degree, unsigned( parts[t].size() / clock.tracks[t].variable_count - 1 ) );
		}
		for ( unsigned l = 0; l <= piece.degree; ++l )
		{
			piece.points.insert( piece.points.end(), clock.rest, clock.rest + variables );
		}
		for ( std::uint32_t t = 0; t < clock.track_count; ++t )
		{
			const lw_track& track = clock.tracks[t];
			const std::vector<double> points = raised( parts[t], track.variable_count, piece.degree );
			for ( std::size_t i = 0; i < points.size(); ++i )
			{
				piece.points[i / track.variable_count * variables + track.variables[i % track.variable_count]] = points[i];
			}
		}
		for ( std::size_t i = 0; i < piece.points.size(); ++i )
		{
			if ( piece.points[i] != piece.points[i % variables] ) // cut and raised: as core/docs/clock.md
			{
				moved[i % variables] = std::max( moved[i % variables], std::ldexp( std::fabs( piece.points[i] ), -44 ) );
			}
		}
		for ( std::size_t j = 0; j < variables && k > 0; ++j ) // a track may jump by 1e-6
		{
			const std::vector<double>& before = out.pieces.back().points;
			const double end = before[before.size() - variables + j];
			moved[j] = std::max( moved[j],
			    std::ldexp( std::fabs( end ), -44 ) * ( end != piece.points[j] ) + std::fabs( end - piece.points[j] ) );
			piece.points[j] = end;
		}
		out.pieces.push_back( std::move( piece ) );
	}
	for ( std::size_t j = 0; j < variables; ++j )
	{
		out.tolerance[j] += moved[j];
	}
	return out;
}

} // namespace leeway::certify
