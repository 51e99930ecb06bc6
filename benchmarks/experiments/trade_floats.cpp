// SPDX-License-Identifier: BSD-3-Clause
// Promised and observed errors of the float filters: see trade.hpp.
//
// Subtrees and triangle pairs are dropped by distances in float32 plus a slack (core/src/simd/kernels.h); the others are
// measured in double. The slack is a knob too, though nobody turns it: with too little slack answers are wrong, with too
// much searches take longer.
#include "experiments/trade.hpp"
#include "distance/tri_tri.h"
#include "leeway/math.h"
#include "simd/kernels.h"

#include <cmath>

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
const char* const LEVELS[] = { "", "scalar", "SSE2", "AVX2", "NEON" };

/// Errors of the float gaps of one kind. A unit is 2^-24 of the size of the question, as simd/kernels.h defines it.
struct FloatErrors
{
	uint64_t count;
	double worst;    ///< units by which a gap exceeded the distance in double; below 0: none did
	double promised; ///< units: the slack that is added to every limit
	double metres;   ///< the same excess, of the question where it was worst
};

struct LeafPair
{
	lw_vec3 a[LWI_WIDTH][3], b[LWI_WIDTH][3]; ///< in double, in their own frames
	lw_transform a_from_b;
};

/// splitmix64 (Steele, Lea, Flood 2014), in [-1, 1).
double nextNumber( std::uint64_t* state )
{
	std::uint64_t z = ( *state += 0x9e3779b97f4a7c15u );
	z = ( z ^ ( z >> 30 ) ) * 0xbf58476d1ce4e5b9u;
	z = ( z ^ ( z >> 27 ) ) * 0x94d049bb133111ebu;
	return (double)( ( z ^ ( z >> 31 ) ) >> 11 ) * 0x1p-52 - 1;
}

lw_vec3 nextPoint( std::uint64_t* state, double size )
{
	lw_vec3 p;
	p.x = size * nextNumber( state );
	p.y = size * nextNumber( state );
	p.z = size * nextNumber( state );
	return p;
}

/// Corners within the extent: large triangles, small ones and needles.
void fillTriangle( std::uint64_t* state, double extent, lw_vec3 out[3] )
{
	double kind = nextNumber( state ), inner = 0.57 * extent; // a cube within the extent's sphere
	double size = kind < -0.5 ? inner : kind < 0.5 ? 0.05 * inner : 0.001 * inner, width = kind > 0.75 ? 1e-4 : 1;
	lw_vec3 base = nextPoint( state, inner - 0.5 * size ), along = nextPoint( state, 0.5 * size );
	lw_vec3 across = nextPoint( state, 0.25 * size * width );
	out[0] = base;
	out[1] = lw_vec3{ base.x + along.x, base.y + along.y, base.z + along.z };
	out[2] =
	    lw_vec3{ base.x + 0.5 * along.x + across.x, base.y + 0.5 * along.y + across.y, base.z + 0.5 * along.z + across.z };
}

void fillPair( std::uint64_t* state, double extent_a, double extent_b, double apart, LeafPair* out )
{
	for ( int i = 0; i < LWI_WIDTH; ++i )
	{
		fillTriangle( state, extent_a, out->a[i] );
		fillTriangle( state, extent_b, out->b[i] );
	}
	lw_vec3 place = nextPoint( state, 0.57 * apart ), axis = nextPoint( state, 1 );
	double q[4] = { axis.x, axis.y, axis.z, nextNumber( state ) }, t[3] = { place.x, place.y, place.z };
	double norm = std::sqrt( q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3] );
	for ( int i = 0; i < 4; ++i )
	{
		q[i] = norm > 0.1 ? q[i] / norm : i == 3;
	}
	lw_transform_from_quaternion( t, q, &out->a_from_b );
}

void roundLeaf( lw_vec3 triangles[LWI_WIDTH][3], lwi_leaf* leaf )
{
	*leaf = {};
	for ( int lane = 0; lane < LWI_WIDTH; ++lane )
	{
		for ( int k = 0; k < 3; ++k )
		{
			leaf->v[k][0][lane] = (float)triangles[lane][k].x;
			leaf->v[k][1][lane] = (float)triangles[lane][k].y;
			leaf->v[k][2][lane] = (float)triangles[lane][k].z;
		}
	}
}

lwi_motion roundMotion( const lw_transform* m )
{
	lwi_motion out;
	for ( int i = 0; i < 9; ++i )
	{
		out.r[i] = (float)m->r[i / 3][i % 3];
	}
	for ( int i = 0; i < 3; ++i )
	{
		out.t[i] = (float)m->t[i];
	}
	return out;
}

/// The float gaps of the eight pairs, lane by lane; of the first corner of b to all of a for kernel 1.
void floatGaps( const lwi_kernels* kernels, int kernel, LeafPair* pair, float gap[LWI_WIDTH] )
{
	lwi_leaf a, b;
	roundLeaf( pair->a, &a );
	roundLeaf( pair->b, &b );
	lwi_motion motion = roundMotion( &pair->a_from_b );
	if ( kernel == 0 )
	{
		lwi_triangles8 moved;
		kernels->leaf_transform( &b, &motion, moved );
		kernels->triangle_gap( a.v, moved, INFINITY, gap );
		return;
	}
	float sphere[4] = { 0, 0, 0, 0 }, direction[3][LWI_WIDTH];
	float c[3] = { b.v[0][0][0], b.v[0][1][0], b.v[0][2][0] };
	for ( int axis = 0; axis < 3; ++axis )
	{
		const float* r = motion.r + 3 * axis;
		sphere[axis] = r[0] * c[0] + r[1] * c[1] + r[2] * c[2] + motion.t[axis];
	}
	kernels->leaf_gap( &a, sphere, INFINITY, gap, direction );
}

/// Two leaves of random triangles, each in its own frame, `extent_a` and `extent_b` about its origin, the frames up to
/// `apart` metres from each other: rounded to float, moved and compared as the search does, and in double from the same
/// triangles.
/// @param kernel 0 triangles against triangles, 1 a point against triangles
FloatErrors floatErrors(
    lw_simd level, int kernel, double extent_a, double extent_b, double apart, std::uint64_t seed, std::uint32_t leaves )
{
	const lwi_kernels* kernels = lwi_kernels_get( level );
	FloatErrors out = { 0, -INFINITY, LWI_GAP_SLACK, 0 };
	for ( std::uint32_t i = 0; i < leaves; ++i )
	{
		LeafPair pair;
		fillPair( &seed, extent_a, extent_b, apart, &pair );
		float gap[LWI_WIDTH];
		floatGaps( kernels, kernel, &pair, gap );
		const double* t = pair.a_from_b.t;
		double size = std::sqrt( t[0] * t[0] + t[1] * t[1] + t[2] * t[2] ) + 2 * ( extent_a + extent_b );
		for ( int lane = 0; lane < LWI_WIDTH; ++lane )
		{
			lw_vec3 moved[3];
			for ( int k = 0; k < 3; ++k )
			{
				moved[k] = lw_transform_point( &pair.a_from_b, kernel == 0 ? pair.b[lane][k] : pair.b[0][0] );
			}
			double excess = (double)gap[lane] - lwi_tri_tri( pair.a[lane], moved ).distance;
			double units = excess / ( size * 0x1p-24 );
			if ( !( units <= out.worst ) && !std::isnan( out.worst ) ) // a NaN is the worst of all, and stays
			{
				out.worst = units;
				out.metres = excess;
			}
			out.count++;
		}
	}
	return out;
}

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
			FloatErrors worst{};
			worst.worst = -1;
			for ( int level = LW_SIMD_SCALAR; level <= lw_simd_available(); ++level )
			{
				if ( !lw_simd_supported( static_cast<lw_simd>( level ) ) )
				{
					continue;
				}
				FloatErrors r = floatErrors(
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
