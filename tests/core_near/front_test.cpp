// SPDX-License-Identifier: BSD-3-Clause
// Searches that go on where the last one ended, on bodies whose nearest places change all the time: bumpy balls that turn.
#include "near_world.hpp"
#include "one_joint.hpp"
#include "seeded_rng.hpp"
#include "simple_shapes.hpp"

namespace
{

/// A ball of triangles whose vertices are moved in and out by a tenth.
lw_shape* bumpyBall( SeededRng& rng, std::uint32_t rings )
{
	std::vector<double> vertices;
	std::vector<std::uint32_t> indices;
	const std::uint32_t sectors = 2 * rings;
	for ( std::uint32_t i = 0; i <= rings; ++i )
	{
		for ( std::uint32_t k = 0; k < sectors; ++k )
		{
			const double theta = M_PI * i / rings, phi = 2 * M_PI * k / sectors, r = 0.2 * rng.uniform( 0.9, 1 );
			vertices.insert( vertices.end(), { r * std::sin( theta ) * std::cos( phi ),
			                                     r * std::sin( theta ) * std::sin( phi ), r * std::cos( theta ) } );
			const std::uint32_t here = i * sectors + k, next = i * sectors + ( k + 1 ) % sectors;
			if ( i < rings )
			{
				indices.insert( indices.end(), { here, here + sectors, next, next, here + sectors, next + sectors } );
			}
		}
	}
	return meshOf( vertices, indices );
}

lw_shape* obstacleOf( SeededRng& rng, int kind )
{
	switch ( kind )
	{
	case 0:
		return bumpyBall( rng, 24 );
	case 1:
		return primitive( LW_SHAPE_BOX, 0.3, 0.4, 0.2 );
	case 2:
		return primitive( LW_SHAPE_CYLINDER, 0.15, 0.4 );
	case 3:
		return primitive( LW_SHAPE_SPHERE, 0.2 );
	default:
		return primitive( LW_SHAPE_CAPSULE, 0.1, 0.3 );
	}
}

class NearFronts : public testing::TestWithParam<int>
{
};

/// The ball turns beside an obstacle at `gap`, by steps of `speed`, and is asked for pairs below `distance`.
void expectNoStalePart( lw_shape* ball, lw_shape* obstacle, double gap, double speed, double distance )
{
	OneJoint world;
	const double axis[3] = { 0.3, -0.5, 0.8 };
	ASSERT_EQ( LW_OK, world.makeRobot( ball, lw_transform_identity(), LW_JOINT_REVOLUTE, axis, 100, nullptr ) );
	lw_transform pose = lw_transform_identity();
	pose.t[0] = 0.4 + gap;
	world.makeChecker( obstacle, pose );
	const leeway::Query warm = queryOf( world.checker ), cold = queryOf( world.checker, false );
	lw_near_def def = lw_near_def_default();
	def.distance = distance;
	for ( double q = 0; q < 400 * speed; q += speed )
	{
		const NearRows a = nearPairs( world.checker, warm.get(), { q }, def, 1 ),
		               b = nearPairs( world.checker, cold.get(), { q }, def, 1 );
		ASSERT_EQ( b.total, a.total );
		if ( a.total == 0 )
		{
			continue;
		}
		ASSERT_EQ( a.rows[0].clearance.kind, b.rows[0].clearance.kind );
		ASSERT_NEAR( a.rows[0].clearance.upper, b.rows[0].clearance.upper, 1e-12 ) << "at " << q;
		ASSERT_NEAR( a.rows[0].clearance.lower, b.rows[0].clearance.lower, 1e-12 ) << "at " << q;
	}
}

TEST_P( NearFronts, APartThatCameNearIsTakenUpAgain )
{
	SeededRng rng{ std::mt19937_64( std::uint64_t( GetParam() ) ) };
	for ( const double speed : { 1e-4, 1e-3, 1e-2 } )
	{
		const ShapePtr ball( bumpyBall( rng, 24 ) ), obstacle( obstacleOf( rng, GetParam() % 5 ) );
		const double gap = rng.uniform( 0, 0.1 );
		expectNoStalePart( ball.get(), obstacle.get(), gap, speed, 1 );
		expectNoStalePart( ball.get(), obstacle.get(), gap, speed, gap + 0.02 ); // sometimes farther
	}
}

INSTANTIATE_TEST_SUITE_P( Random, NearFronts, testing::Range( 0, 20 ) );

} // namespace
