// SPDX-License-Identifier: BSD-3-Clause
// Coordinate descent over positive values, such as shares of a time.
#pragma once

#include <cmath>
#include <cstddef>

namespace leeway::motions
{

struct Descent
{
	double first_factor, least_factor; ///< above 1: of a value, by one change
	double least_gain;                 ///< of the cost, by a change that is kept
	std::size_t most_changes;          ///< that are tried
};

/// Multiplies one value after the other by a factor and by its inverse, and keeps what gains; the factor falls to its root when nothing does.
/// @param value( i ) of `count` @param take( i, x ) makes x the value number i; again with the old one where the change gains nothing
/// @param cost() of all values, > 0; infinite: they are not possible @return the last cost
template <typename Value, typename Take, typename Cost>
double descend( const Descent& by, std::size_t count, const Value& value, const Take& take, const Cost& cost )
{
	double best = cost();
	std::size_t changes = 0;
	for ( double factor = by.first_factor; factor > by.least_factor && changes < by.most_changes; )
	{
		bool better = false;
		for ( std::size_t i = 0; i < 2 * count; ++i, ++changes )
		{
			const double old = value( i / 2 );
			take( i / 2, i % 2 == 0 ? old / factor : old * factor );
			const double now = cost();
			const bool gains = now < best * ( 1 - by.least_gain );
			gains ? static_cast<void>( best = now ) : take( i / 2, old );
			better = better || gains;
		}
		factor = better ? factor : std::sqrt( factor );
	}
	return best;
}

} // namespace leeway::motions
