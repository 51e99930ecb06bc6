// SPDX-License-Identifier: BSD-3-Clause
// The brute force that decides between engines (tests/support/brute_distance.hpp): against closed forms, and against leeway.
#include "brute_distance.hpp"
#include "shapes.hpp"

#include <gtest/gtest.h>

namespace
{

struct Case
{
	lw_shape_type type;
	double dimensions[3];
	double reach; ///< along +x from the origin
};

const Case CASES[] = { { LW_SHAPE_BOX, { 0.4, 0.2, 0.6 }, 0.2 }, { LW_SHAPE_SPHERE, { 0.3, 0, 0 }, 0.3 },
    { LW_SHAPE_CYLINDER, { 0.25, 0.5, 0 }, 0.25 }, { LW_SHAPE_CAPSULE, { 0.15, 0.5, 0 }, 0.15 } };

// A wrong half or radius, or a radius counted once
TEST( BruteDistance, SolidsSideBySideAreAsFarApartAsTheirReachSays )
{
	for ( const Case& a : CASES )
	{
		for ( const Case& b : CASES )
		{
			BruteDistance brute;
			const ShapePtr x = makePrimitive( a.type, a.dimensions[0], a.dimensions[1], a.dimensions[2] ),
			               y = makePrimitive( b.type, b.dimensions[0], b.dimensions[1], b.dimensions[2] );
			for ( const double gap : { 1e-5, 0.01, 1.0 } )
			{
				const lw_transform apart = at( a.reach + b.reach + gap, 0, 0 );
				const oracle::Interval d = brute.distance( x.get(), lw_transform_identity(), y.get(), apart, 10 );
				EXPECT_NEAR( static_cast<double>( d.upper ), gap, 1e-8 );
				EXPECT_LE( static_cast<double>( d.lower ), gap + 1e-12 );
				EXPECT_GE( static_cast<double>( d.lower ), gap - 1e-8 );
			}
		}
	}
}

// One solid inside of another, and a mesh inside of a solid: no surfaces meet
TEST( BruteDistance, BodyInsideOfASolidTouchesIt )
{
	BruteDistance brute;
	const ShapePtr big = makePrimitive( LW_SHAPE_BOX, 2, 2, 2 ), small = makePrimitive( LW_SHAPE_SPHERE, 0.1 );
	const ShapePtr mesh = makeMesh( { 0, 0, 0, 0.1, 0, 0, 0, 0.1, 0, 0, 0, 0.1 }, { 0, 1, 2, 0, 1, 3 } );
	for ( const ShapePtr* inner : { &small, &mesh } )
	{
		const oracle::Interval d =
		    brute.distance( big.get(), lw_transform_identity(), inner->get(), at( 0.3, 0.2, 0.1 ), 1 );
		EXPECT_EQ( static_cast<double>( d.upper ), 0 );
	}
}

// A pair of triangles passed over by its boxes, or a bound that cuts off pairs below it
TEST( BruteDistance, SoupsOfTrianglesAreAsFarApartAsTheEngineProves )
{
	SeededRng rng( 71 );
	const QueryPtr query = makeQuery();
	int contacts = 0;
	for ( int round = 0; round < 40; ++round )
	{
		BruteDistance brute;
		const ShapePtr a = randomSoup( rng, 30, 0.5 ), b = randomSoup( rng, 30, 0.5 );
		const lw_transform pose_a = randomPose( rng, 1 ), pose_b = randomPose( rng, 1 );
		lw_clearance c;
		ASSERT_EQ( lw_shape_distance( a.get(), &pose_a, b.get(), &pose_b, nullptr, query.get(), &c ), LW_OK );
		const oracle::Interval d = brute.distance( a.get(), pose_a, b.get(), pose_b, c.upper + 0.1 );
		EXPECT_NEAR( static_cast<double>( d.upper ), c.upper, 1e-6 );
		EXPECT_LE( static_cast<double>( d.lower ), c.upper + 1e-9 );
		const oracle::Interval bounded = brute.distance( a.get(), pose_a, b.get(), pose_b, 0.5 * c.upper );
		EXPECT_GE( static_cast<double>( bounded.lower ), 0.5 * c.upper - 1e-9 );
		contacts += c.upper <= 0;
	}
	EXPECT_GT( contacts, 0 );
	EXPECT_LT( contacts, 40 );
}

} // namespace
