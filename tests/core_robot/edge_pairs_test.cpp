// SPDX-License-Identifier: BSD-3-Clause
// Pairs of links that take turns to move: the memory of one edge must not prove the next.
#include "checker_handles.hpp"
#include "random_robot.hpp"

#include <gtest/gtest.h>

namespace
{

/// Two arms that turn about parallel axes, with a box each, of sizes that have nothing to do with each other.
struct TwoArms
{
	RobotModel model;
	RobotPtr robot;
	CheckerPtr checker;
	QueryPtr query, plain;

	explicit TwoArms( SeededRng& rng )
	{
		model.link( "root" );
		for ( int side : { -1, 1 } )
		{
			lw_joint_def& j = model.joint( side < 0 ? "a" : "b", LW_JOINT_REVOLUTE, 0 );
			j.parent_from_joint.t[0] = side * 0.15;
			std::vector<double> size;
			for ( int k = 0; k < 3; ++k )
			{
				size.push_back( rng.decade( -1.7, -0.4 ) );
			}
			lw_shape* shape = nullptr;
			EXPECT_EQ( LW_OK, lw_shape_create_primitive( LW_SHAPE_BOX, size.data(), nullptr, nullptr, &shape ) );
			lw_transform at = lw_transform_identity();
			at.t[0] = rng.uniform( 0.1, 0.35 );
			model.body( side < 0 ? 1 : 2, shape, at );
		}
		robot = model.create();
		lw_checker_def def = lw_checker_def_default();
		def.robot = robot.get();
		lw_checker* made = nullptr;
		EXPECT_EQ( LW_OK, lw_checker_create( &def, nullptr, nullptr, &made ) );
		checker.reset( made );
		query = makeQuery( made );
		plain = makeQuery( made );
	}

	/// Distance of the two boxes by two poses and two shapes, without a checker.
	double apart( const State& q )
	{
		std::vector<lw_transform> links( lw_robot_link_count( robot.get() ) ), bodies;
		EXPECT_EQ( LW_OK, lw_robot_fk( robot.get(), q.data(), links.data() ) );
		for ( const lw_body_def& body : model.bodies )
		{
			bodies.push_back( lw_transform_multiply( &links[body.link], &body.link_from_shape ) );
		}
		lw_clearance out;
		EXPECT_EQ( LW_OK, lw_shape_distance( model.bodies[0].shape, &bodies[0], model.bodies[1].shape, &bodies[1], nullptr,
		                      plain.get(), &out ) );
		return out.upper;
	}
};

} // namespace

TEST( EdgePairs, ArmIsProvedByTheOther )
{
	SeededRng rng;
	int free = 0, close = 0, blocked = 0;
	for ( int i = 0; i < 80 && !HasFailure(); ++i )
	{
		TwoArms arms( rng );
		State from = { rng.uniform( -3, 3 ), rng.uniform( -3, 3 ) };
		for ( int k = 0; k < 80 && !HasFailure(); ++k )
		{
			// one arm moves, mostly a little, the other one stands
			const std::size_t moves = rng.integer( 0, 1 ) ? 1 : 0;
			State to = from;
			to[moves] = std::clamp( to[moves] + rng.uniform( -1, 1 ) * rng.decade( -1.5, 0.5 ), -3.0, 3.0 );
			lw_edge_def def = lw_edge_def_default();
			lw_edge_result r;
			ASSERT_EQ( LW_OK, lw_checker_edge( arms.checker.get(), arms.query.get(), from.data(), to.data(), &def, &r ) );
			blocked += r.verdict == LW_VERDICT_BLOCKED;
			if ( r.verdict != LW_VERDICT_FREE )
			{
				from[rng.integer( 0, 1 ) ? 1 : 0] = rng.uniform( -3, 3 );
				continue;
			}
			++free;
			double least = INFINITY;
			for ( int step = 0; step <= 60; ++step )
			{
				State q = from;
				q[moves] += ( to[moves] - from[moves] ) * step / 60;
				least = std::min( least, arms.apart( q ) );
			}
			EXPECT_GE( least, r.lower_bound - 1e-9 ) << "world " << i << ", edge " << k;
			EXPECT_GT( r.lower_bound, def.min_d );
			close += least < 0.05;
			from = to;
		}
	}
	std::printf( "%d free, %d of them within 5 cm, %d blocked\n", free, close, blocked );
	EXPECT_GE( free, 1000 );
	EXPECT_GE( close, 200 );
	EXPECT_GE( blocked, 80 );
}
