// SPDX-License-Identifier: BSD-3-Clause
// Derivatives of rows against finite differences of their clearances, and point Jacobians against those of forward kinematics.
#include "near_world.hpp"

namespace
{

class NearDerivatives : public NearTest
{
protected:
	NearDerivatives() : NearTest( 6000 ) { def.distance = INFINITY; }
};

TEST_P( NearDerivatives, AreTheSlopesOfTheClearances )
{
	const double h = 1e-5;
	int smooth = 0, sharp = 0; // one-sided slopes that agree, and those of a ridge
	for ( int i = 0; i < 3; ++i )
	{
		const std::vector<double> q = randomGroupState( world, rng );
		const NearRows near = rows( q );
		ASSERT_EQ( LW_OK, near.status );
		for ( std::size_t v = 0; v < q.size(); ++v )
		{
			std::vector<double> less = q, more = q;
			less[v] -= h;
			more[v] += h;
			const auto low = clearances( less ), high = clearances( more );
			for ( std::size_t k = 0; k < near.rows.size(); ++k )
			{
				const lw_near_pair& row = near.rows[k];
				if ( row.clearance.upper < 1e-3 )
				{
					continue; // curves of the distance there are as sharp as 1 / distance
				}
				const double before = ( row.clearance.upper - low.at( bodiesOf( row ) ) ) / h;
				const double after = ( high.at( bodiesOf( row ) ) - row.clearance.upper ) / h;
				const double slope = near.derivatives[k * q.size() + v];
				// of differences of two clearances, each as wrong as its interval is wide
				const double width = row.clearance.upper - row.clearance.lower;
				const double turn = std::sqrt( 2 * width / row.clearance.upper ); // of the direction
				const double error = 2 * width / h + turn + 1e-7 * std::max( 1.0, std::fabs( slope ) );
				EXPECT_GE( slope, std::min( before, after ) - error ) << "row " << k << " variable " << v;
				EXPECT_LE( slope, std::max( before, after ) + error ) << "row " << k << " variable " << v;
				( std::fabs( after - before ) < 1e-3 ? smooth : sharp )++;
			}
		}
	}
	EXPECT_LE( sharp, smooth / 5 );
}

TEST_P( NearDerivatives, OfAPointAreThoseOfForwardKinematics )
{
	const double h = 1e-6;
	const lw_robot* robot = world.robot.get();
	const std::vector<double> q = randomGroupState( world, rng );
	const std::size_t variables = q.size();
	std::vector<lw_transform> poses( lw_robot_link_count( robot ) ), low = poses, high = poses;
	const lw_vec3 local = { rng.uniform( -1, 1 ), rng.uniform( -1, 1 ), rng.uniform( -1, 1 ) };
	ASSERT_EQ( LW_OK, lw_robot_fk( robot, world.full( q ).data(), poses.data() ) );
	for ( std::uint32_t link = 0; link < poses.size(); ++link )
	{
		std::vector<double> jacobian( 3 * variables );
		const lw_vec3 point = lw_transform_point( &poses[link], local );
		ASSERT_EQ(
		    LW_OK, lw_checker_point_jacobian( world.checker.get(), query.get(), q.data(), link, point, jacobian.data() ) );
		for ( std::size_t v = 0; v < variables; ++v )
		{
			std::vector<double> less = q, more = q;
			less[v] -= h;
			more[v] += h;
			ASSERT_EQ( LW_OK, lw_robot_fk( robot, world.full( less ).data(), low.data() ) );
			ASSERT_EQ( LW_OK, lw_robot_fk( robot, world.full( more ).data(), high.data() ) );
			const lw_vec3 a = lw_transform_point( &low[link], local ), b = lw_transform_point( &high[link], local );
			EXPECT_NEAR( jacobian[v], ( b.x - a.x ) / ( 2 * h ), 1e-7 ) << link << " " << v;
			EXPECT_NEAR( jacobian[variables + v], ( b.y - a.y ) / ( 2 * h ), 1e-7 ) << link << " " << v;
			EXPECT_NEAR( jacobian[2 * variables + v], ( b.z - a.z ) / ( 2 * h ), 1e-7 ) << link << " " << v;
		}
	}
}

INSTANTIATE_TEST_SUITE_P( Random, NearDerivatives, testing::Range( 0, 30 ) );

} // namespace
