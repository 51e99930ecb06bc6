// SPDX-License-Identifier: BSD-3-Clause
// Tracks that own their arrays, evaluated by Bernstein polynomials.
#pragma once

#include "leeway/clock.h"

#include <algorithm>
#include <cmath>
#include <vector>

/// A polynomial of time that owns its control points.
struct OwnedPiece
{
	double start, end;
	unsigned degree;
	std::vector<double> points; ///< [degree + 1][variables]
};

/// A track that owns its arrays.
struct OwnedTrack
{
	std::vector<std::uint32_t> variables;
	std::vector<OwnedPiece> pieces;
	std::vector<double> tolerance; ///< empty or one each
	double lag = 0, spread_speed = 0, spread_start = 0;
	std::vector<lw_timed_piece> views;

	lw_track view()
	{
		views.clear();
		for ( const OwnedPiece& piece : pieces )
		{
			views.push_back( { piece.start, piece.end, piece.degree, piece.points.data() } );
		}
		lw_track track = {};
		track.variables = variables.data();
		track.variable_count = static_cast<std::uint32_t>( variables.size() );
		track.pieces = views.data();
		track.piece_count = static_cast<std::uint32_t>( views.size() );
		track.lag = lag;
		track.tolerance = tolerance.empty() ? nullptr : tolerance.data();
		track.spread_speed = spread_speed;
		track.spread_start = spread_start;
		return track;
	}

	/// Value of a variable at a time, at rest before, between and after the pieces.
	double at( std::size_t variable, double time ) const
	{
		const OwnedPiece* last = nullptr;
		for ( const OwnedPiece& piece : pieces )
		{
			last = piece.start <= time ? &piece : last;
		}
		if ( last == nullptr )
		{
			return pieces.front().points[variable];
		}
		const double u = std::min( 1.0, ( time - last->start ) / ( last->end - last->start ) );
		double value = 0;
		for ( unsigned i = 0; i <= last->degree; ++i )
		{
			double weight = std::pow( u, i ) * std::pow( 1 - u, last->degree - i );
			for ( unsigned k = 0; k < i; ++k )
			{
				weight *= static_cast<double>( last->degree - k ) / ( k + 1 );
			}
			value += weight * last->points[i * variables.size() + variable];
		}
		return value;
	}

	double spread( double time ) const { return spread_speed * std::max( 0.0, time - spread_start ); }
};

/// All tracks, as the core takes them.
struct OwnedClock
{
	std::vector<OwnedTrack> tracks;
	std::vector<double> rest; ///< of all variables of the group
	std::vector<lw_track> views;

	lw_clock view()
	{
		views.clear();
		for ( OwnedTrack& track : tracks )
		{
			views.push_back( track.view() );
		}
		lw_clock clock = {};
		clock.tracks = views.data();
		clock.track_count = static_cast<std::uint32_t>( views.size() );
		clock.rest = rest.data();
		return clock;
	}
};
