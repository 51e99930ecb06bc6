// SPDX-License-Identifier: BSD-3-Clause
// The distance of two triangles at the extremes against certificates in 64 and 113 bits.
#include "extreme_judge.hpp"

#include <gtest/gtest.h>

using namespace extremes;

namespace
{

void expectNothingBroken( const Findings& findings )
{
	EXPECT_EQ( findings.broken, 0u );
	for ( const std::string& text : findings.examples )
	{
		ADD_FAILURE() << text;
	}
}

} // namespace

TEST( ExtremeTriangles, DistanceBeyondItsBound )
{
	double worst = 0;
	for ( int f = 0; f < family_count; ++f )
	{
		Findings findings;
		for ( std::uint64_t i = 0; i < caseCount( 40000 ); ++i )
		{
			Random random( i * family_count + static_cast<unsigned>( f ) );
			judgeTriangles( randomPair( random, static_cast<Family>( f ) ), family_names[f], i, findings );
		}
		std::printf( "%-16s worst / promised: distance %.4f, witness %.4f; certified %d, 64 bits %d, 113 bits %d\n",
		    family_names[f], findings.worst[triangle_distance], findings.worst[triangle_witness], (int)findings.efforts[0],
		    (int)findings.efforts[1], (int)findings.efforts[2] );
		expectNothingBroken( findings );
		worst = std::max( worst, findings.worst[triangle_distance] );
	}
	EXPECT_GT( worst, 0.001 ) << "a bound so loose says nothing";
}

TEST( ExtremeTriangles, Denormals )
{
	Findings findings;
	for ( std::uint64_t i = 0; i < caseCount( 200000 ); ++i )
	{
		Random random( i );
		Family family = static_cast<Family>( i % far_away );
		TrianglePair p = basicPair( random, family );
		double scales[2] = { std::ldexp( 1.0, -static_cast<int>( random.below( 1075 ) ) ), 1 };
		scales[1] = random.below( 2 ) == 0 ? scales[0] : std::ldexp( 1.0, -static_cast<int>( random.below( 1075 ) ) );
		for ( int t = 0; t < 2; ++t )
		{
			for ( lw_vec3 *v = t == 0 ? p.a : p.b, *end = v + 3; v != end; ++v )
			{
				*v = { scales[t] * v->x, scales[t] * v->y, scales[t] * v->z };
			}
		}
		judgeTriangles( p, family_names[family], i, findings );
	}
	std::printf( "worst / promised: distance %.4f, witness %.4f\n", findings.worst[triangle_distance],
	    findings.worst[triangle_witness] );
	expectNothingBroken( findings );
}
