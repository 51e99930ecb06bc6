// SPDX-License-Identifier: BSD-3-Clause
// Convex distance against an independent minimisation: 100,000 random pairs, every combination, 9 decades of size ratio.
#include "convex_oracle.hpp"

#include <gtest/gtest.h>

using namespace oracle;

namespace
{
struct Tally
{
	int pairs = 0, separated = 0, close = 0, overlapping = 0, decided = 0, first_smaller = 0, second_smaller = 0;
	real worst_width = 0, worst_outside = 0, worst_high = 0, worst_low = 0;
};

/// Everything that must hold of one result, whatever the oracle says.
void check_witnesses(
    const lwi_convex& a, const lwi_convex& b, const lw_transform& m, const lwi_convex_result& r, real scale, Tally& tally )
{
	Body x{ a }, y{ b };
	Vec pa = from( r.point_a );
	Vec pb = unrotate( m, from( r.point_b ) - offset( m ) );
	real outside = std::max( length( pa - x.nearest( pa ) ), length( pb - y.nearest( pb ) ) ) / scale;
	tally.worst_outside = std::max( tally.worst_outside, outside );
	ASSERT_LE( outside, LWI_CONVEX_ROUNDING );
	real apart = length( from( r.point_a ) - from( r.point_b ) );
	ASSERT_LE( std::fabs( apart - r.upper ), LWI_CONVEX_ROUNDING * scale );
	ASSERT_LE( r.lower, r.upper );
	ASSERT_GE( r.lower, 0 );
}

/// Moves b towards a until a fraction of the gap is left.
void approach( const lwi_convex& a, const lwi_convex& b, double left, lw_transform& m )
{
	lwi_convex_result r = lwi_convex_distance( &a, &b, &m, INFINITY, 0 );
	double f = 1 - left;
	m.t[0] -= f * ( r.point_b.x - r.point_a.x );
	m.t[1] -= f * ( r.point_b.y - r.point_a.y );
	m.t[2] -= f * ( r.point_b.z - r.point_a.z );
}

/// One random pair: sizes 1 and 10^-9..1 (either first), placed so that some overlap and a third nearly touch.
void one_pair( SeededRng& rng, int ta, int tb, Tally& tally )
{
	double small = rng.decade( -9, 0 ), unit = rng.decade( -3, 3 );
	bool first = rng.integer( 0, 1 ) == 0;
	lwi_convex a = random_piece( rng, (lwi_convex_type)ta, first ? unit * small : unit );
	lwi_convex b = random_piece( rng, (lwi_convex_type)tb, first ? unit : unit * small );
	lw_transform m = random_rotation( rng );
	double far = unit * rng.uniform( 0, 2 );
	lw_vec3 d = random_direction( rng );
	m.t[0] = far * d.x;
	m.t[1] = far * d.y;
	m.t[2] = far * d.z;
	if ( rng.integer( 0, 2 ) == 0 )
	{
		approach( a, b, rng.decade( -9, -1 ), m );
	}
	( first ? tally.first_smaller : tally.second_smaller ) += small < 1e-3;

	real scale = extent( a, b, m );
	lwi_convex_result r = lwi_convex_distance( &a, &b, &m, INFINITY, 0 );
	check_witnesses( a, b, m, r, scale, tally );
	real width = ( r.upper - r.lower ) / scale;
	ASSERT_LE( width, width_target( a, b ) );
	tally.worst_width = std::max( tally.worst_width, width );

	Interval o = distance( a, b, m, 1e-11L * scale, 1500 );
	++tally.pairs;
	tally.decided += o.upper - o.lower <= 1e-10L * scale;
	tally.overlapping += r.upper == 0;
	tally.separated += r.lower > 0;
	tally.close += r.lower > 0 && r.upper < 1e-3L * scale;
	tally.worst_low = std::max( tally.worst_low, ( r.lower - o.upper ) / scale );
	tally.worst_high = std::max( tally.worst_high, ( o.lower - r.upper ) / scale );
	// The oracle's own rounding is 1e-19 of the scale; upper is attained up to the witness's rounding
	ASSERT_LE( r.lower, o.upper + 1e-18L * scale ) << "not a lower bound";
	ASSERT_GE( r.upper, o.lower - LWI_CONVEX_ROUNDING * scale ) << "not an upper bound";
}

class ConvexOracle : public ::testing::TestWithParam<std::pair<int, int>>
{
};
} // namespace

TEST_P( ConvexOracle, IntervalContainsTheMinimisedDistance )
{
	auto [ta, tb] = GetParam();
	SeededRng rng( 20260101u + 10u * (unsigned)ta + (unsigned)tb );
	Tally tally;
	for ( int i = 0; i < 10000; ++i )
	{
		one_pair( rng, ta, tb, tally );
		ASSERT_FALSE( HasFatalFailure() ) << "pair " << i;
		std::swap( ta, tb );
	}
	std::printf( "%s-%s: %d pairs, %d separated (%d close), %d overlapping; oracle within 1e-10: %d; worst: width "
	             "%.2Lg, lower above oracle %.2Lg, upper below oracle %.2Lg, witness outside %.2Lg (of the extent)\n",
	    names[ta], names[tb], tally.pairs, tally.separated, tally.close, tally.overlapping, tally.decided, tally.worst_width,
	    tally.worst_low, tally.worst_high, tally.worst_outside );
	EXPECT_GT( tally.separated, 1000 );
	EXPECT_GT( tally.close, 1000 );
	EXPECT_GT( tally.overlapping, 25 );
	EXPECT_GT( tally.first_smaller, 1000 );
	EXPECT_GT( tally.second_smaller, 1000 );
	EXPECT_GT( tally.decided, 9000 ) << "the oracle has lost its teeth";
}

INSTANTIATE_TEST_SUITE_P( combinations, ConvexOracle, ::testing::ValuesIn( combinations ),
    []( const auto& pair ) { return std::string( names[pair.param.first] ) + "_" + names[pair.param.second]; } );
