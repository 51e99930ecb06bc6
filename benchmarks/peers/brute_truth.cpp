// SPDX-License-Identifier: BSD-3-Clause
// Brute force: see brute_truth.hpp.
#include "peers/brute_truth.hpp"

#include "brute_distance.hpp"

#include <algorithm>

namespace
{

/// Nearer than this is a contact to brute force, whose intervals of overlapping pieces shrink towards 0.
constexpr double CONTACT = 1e-8;

} // namespace

Truth bruteForce( BruteDistance& brute, const std::vector<PlacedPair>& pairs, double bound )
{
	Truth truth;
	truth.lower = truth.upper = bound;
	for ( const PlacedPair& pair : pairs )
	{
		const oracle::Interval found = brute.distance( pair.a, pair.world_from_a, pair.b, pair.world_from_b, truth.upper );
		if ( static_cast<double>( found.upper ) < truth.upper )
		{
			truth.upper = static_cast<double>( found.upper );
			const lw_shape_type a = lw_shape_get_info( pair.a ).type, b = lw_shape_get_info( pair.b ).type;
			truth.kinds = std::string( lw_shape_type_name( a ) ) + " and " + lw_shape_type_name( b );
			truth.is_solid = a != LW_SHAPE_MESH || b != LW_SHAPE_MESH;
		}
		truth.lower = std::min( truth.lower, static_cast<double>( found.lower ) );
	}
	if ( truth.upper < CONTACT )
	{
		truth.lower = truth.upper = 0;
	}
	return truth;
}
