// SPDX-License-Identifier: BSD-3-Clause
// Profiles along a line: see profile.hpp.
#include "motions/profile.hpp"

#include <algorithm>
#include <cmath>

namespace leeway::motions
{
namespace
{

constexpr int bisections = 60;

/// From one speed to another: the acceleration rises, may stay, and falls to 0.
struct Change
{
	double rise = 0, stay = 0; ///< seconds; it falls as long as it rises
	double acceleration = 0;   ///< signed, in the middle

	double seconds() const { return 2 * rise + stay; }
};

Change changeOf( double from, double to, const LineLimits& limits )
{
	const double difference = std::abs( to - from ), sign = to < from ? -1 : 1;
	const double jerk = std::min( limits.jerk, limits.acceleration / shortest_phase );
	Change change;
	if ( difference == 0 )
	{
		return change;
	}
	change.rise = limits.acceleration / jerk;
	change.stay = difference / limits.acceleration - change.rise;
	if ( change.stay < 0 ) // the limit of the acceleration is not reached
	{
		change.rise = std::max( std::sqrt( difference / jerk ), shortest_phase );
		change.stay = 0;
	}
	else if ( change.stay <
	          shortest_phase ) // less acceleration, so that it may stay; a longer change brings more speed, as everywhere
	{
		change.stay = shortest_phase;
		change.rise = 0.5 * ( std::hypot( change.stay, 2 * std::sqrt( difference / jerk ) ) - change.stay );
	}
	change.acceleration = sign * difference / ( change.rise + change.stay );
	return change;
}

/// The speed is symmetric around the middle of the change.
double lengthOf( double from, double to, const LineLimits& limits )
{
	return 0.5 * ( from + to ) * changeOf( from, to, limits ).seconds();
}

void addPhase( std::vector<LineState>& states, double seconds, double acceleration )
{
	if ( seconds > 0 )
	{
		const LineState& s = states.back();
		const double jerk = ( acceleration - s.acceleration ) / seconds;
		states.push_back(
		    { s.time + seconds, s.place + seconds * ( s.speed + seconds * ( s.acceleration / 2 + seconds * jerk / 6 ) ),
		        s.speed + seconds * ( s.acceleration + seconds * jerk / 2 ), acceleration } );
	}
}

void addChange( std::vector<LineState>& states, const Change& change, double to )
{
	addPhase( states, change.rise, change.acceleration );
	addPhase( states, change.stay, change.acceleration );
	addPhase( states, change.rise, 0 );
	states.back().speed = to;
}

} // namespace

double reachableSpeed( double from, double length, const LineLimits& limits )
{
	double low = std::min( from, limits.velocity ), high = limits.velocity;
	if ( lengthOf( from, high, limits ) <= length )
	{
		return high;
	}
	for ( int i = 0; i < bisections; ++i )
	{
		const double middle = 0.5 * ( low + high );
		( lengthOf( from, middle, limits ) <= length ? low : high ) = middle;
	}
	return low;
}

std::vector<LineState> fastestProfile( double length, double from, double to, const LineLimits& limits )
{
	const auto fits = [&]( double top, double cruise )
	{ return lengthOf( from, top, limits ) + lengthOf( top, to, limits ) + top * cruise <= length; };
	std::vector<LineState> states = { { 0, 0, from, 0 } };
	double low = std::max( from, to ), high = limits.velocity;
	if ( from != to && !fits( low, shortest_phase ) ) // the point changes its speed on all of the length
	{
		const double slower = length / lengthOf( from, to, limits );
		Change change = changeOf( from, to, limits );
		change.acceleration /= slower;
		change.rise *= slower;
		change.stay *= slower;
		addChange( states, change, to );
		states.back().place = length;
		return states;
	}
	low = fits( high, shortest_phase ) ? high : low;
	for ( int i = 0; i < bisections && low < high; ++i )
	{
		const double middle = 0.5 * ( low + high );
		( fits( middle, shortest_phase ) ? low : high ) = middle;
	}
	addChange( states, changeOf( from, low, limits ), low );
	const double rest = length - states.back().place - lengthOf( low, to, limits );
	addPhase( states, low > 0 ? std::max( rest, 0.0 ) / low : 0, 0 );
	addChange( states, changeOf( low, to, limits ), to );
	states.back().place = length; // up to rounding it is, as the speeds are
	return states;
}

} // namespace leeway::motions
