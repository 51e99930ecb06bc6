// SPDX-License-Identifier: BSD-3-Clause
// Promised and observed errors of the float filters: see trade.hpp.
//
// Subtrees and triangle pairs are dropped by distances in float32 plus a slack (core/src/simd/kernels.h); the others are
// measured in double. The slack is a knob too, though nobody turns it: with too little slack answers are wrong, with too
// much searches take longer.
#include "experiments/trade.hpp"
#include "experiments/trade_float.h"

namespace
{

struct Case
{
	const char* name;
	double extent_a, extent_b, apart; // metres
};
const Case CASES[] = {
    { "finger and can", 0.03, 0.08, 0.2 },
    { "arm and table", 0.2, 1.0, 1.5 },
    { "hand and kitchen", 0.1, 5.0, 8.0 },
    { "building and hand", 100.0, 0.1, 200.0 },
};
const char* const KERNELS[] = { "triangle - triangle", "point - triangle" };
const char* const LEVELS[] = { "", "scalar", "SSE2", "AVX2" };

} // namespace

void addTradeFloats( const ExperimentSettings& settings, const TradeSettings& trade, Progress& progress, Outcome& out )
{
	Table table{ "floats", "Float filters against doubles",
	    "Random triangles of a robot's sizes, rounded to float, moved and compared as the search does. A unit is 2^-24 of "
	    "the distance of the "
	    "origins plus twice both extents. The worst of all instruction sets that are there.",
	    { { "filter", "", 0 }, { "sizes", "", 0 }, { "promised", "units", 0 }, { "observed", "units", -1 },
	        { "observed", "m", -1 }, { "pairs", "", 0 } },
	    {} };
	Promise promise( 0 );
	const auto leaves = static_cast<std::uint32_t>( settings.pick( 12500, 2000, 50 ) );
	double share = 0;
	for ( int kernel = 0; kernel < 2; ++kernel )
	{
		for ( const Case& c : CASES )
		{
			progress.at( share, "float filters" );
			share += 0.125;
			trade_float_result worst{};
			worst.worst = -1;
			for ( int level = LW_SIMD_SCALAR; level <= lw_simd_available() && level <= LW_SIMD_AVX2; ++level )
			{
				trade_float_result r = trade_float_run(
				    static_cast<lw_simd>( level ), kernel, c.extent_a, c.extent_b, c.apart, settings.seed, leaves );
				r.worst += trade.inject == "float" ? 1.1 * r.promised : 0;
				promise.observe( std::isnan( r.worst ) ? r.worst : std::max( 0.0, r.worst ), r.promised,
				    text( "%s, %s, %s", KERNELS[kernel], c.name, LEVELS[level] ) );
				const std::uint64_t count = worst.count + r.count;
				worst = r.worst > worst.worst || std::isnan( r.worst ) ? r : worst;
				worst.count = count;
			}
			table.rows.push_back( { std::string( KERNELS[kernel] ), std::string( c.name ), worst.promised, worst.worst,
			    worst.metres, static_cast<double>( worst.count ) } );
		}
	}
	out.claims.push_back(
	    claimOf( "float slack: no gap in float exceeds the distance in double by more than the slack", { &promise },
	        text( "each the worst of %u pairs; the worst uses %.1f of %.0f units", leaves * 8, promise.worst(),
	            promise.promised() ) ) );
	out.tables.push_back( table );
}
