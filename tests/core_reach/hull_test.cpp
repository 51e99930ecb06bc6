// SPDX-License-Identifier: BSD-3-Clause
// Motion hulls: nothing that moves leaves them, and they are no larger than they say.
//
// The oracle of membership is the support function: a point is outside of a dilated convex set exactly if along some
// direction it is farther than the farthest of the set. Directions are many and random; forward kinematics place the points.
#include "hull_world.hpp"

namespace
{

/// How far a primitive at the origin goes along n, by its definition.
double primitiveSupport( lw_shape_type type, const double* d, lw_vec3 n )
{
	double across = std::hypot( n.x, n.y );
	switch ( type )
	{
	case LW_SHAPE_BOX:
		return 0.5 * ( d[0] * std::fabs( n.x ) + d[1] * std::fabs( n.y ) + d[2] * std::fabs( n.z ) );
	case LW_SHAPE_SPHERE:
		return d[0];
	case LW_SHAPE_CYLINDER:
		return d[0] * across + 0.5 * d[1] * std::fabs( n.z );
	case LW_SHAPE_CAPSULE:
		return d[0] + 0.5 * d[1] * std::fabs( n.z );
	default:
		return std::max( 0.5 * d[1] * n.z, d[0] * across - 0.5 * d[1] * n.z );
	}
}

} // namespace

TEST( MotionHull, NoStateLeavesItOnRandomRobots )
{
	SeededRng rng;
	int bounded = 0, unbounded = 0;
	for ( int i = 0; i < 24; ++i )
	{
		RandomRobotOptions options;
		options.floating = i % 2 == 1;
		options.joints = 3 + i % 6;
		RobotModel model = randomRobot( rng, options );
		RobotPtr robot = model.create();
		ReachPtr reach = build( robot.get(), i % 3 == 0 ? 0.3 : 0 ); // coarse ones too
		ASSERT_NE( reach, nullptr );
		Directions directions( rng, reach.get(), 300 );
		std::vector<std::vector<lw_vec3>> points;
		for ( std::uint32_t link = 0; link < model.linkNames.size(); ++link )
		{
			points.push_back( linkPoints( model, link ) );
			unbounded += std::isinf( lw_reach_get_node( reach.get(), link ).m.radius ) ? 1 : 0;
		}
		for ( int s = 0; s < 1200 && !HasFailure(); ++s )
		{
			State q = coveredState( rng, reach.get(), s % 3 == 0 );
			bounded += expectContained( rng, model, reach.get(), directions, q, points );
		}
	}
	EXPECT_GT( bounded, 100000 );
	EXPECT_GT( unbounded, 0 );
}

/// One joint about a skew axis and a plate far from it: where sampling loses most, and the margin counts.
TEST( MotionHull, HoldsTheWholeArcAtEveryResolution )
{
	SeededRng rng;
	for ( double error : { 0.5, 0.05, 1e-3 } )
	{
		for ( double width : { 0.0, 0.3, 2.0, 5.0, 6.28, 6.3, 20.0 } )
		{
			RobotModel model;
			model.link( "base" );
			lw_joint_def& joint = model.joint( "arm", LW_JOINT_REVOLUTE, 0 );
			joint.parent_from_joint = randomTransform( rng, 1 );
			joint.axis[0] = 0.3;
			joint.axis[1] = -0.5;
			joint.lower = -0.7;
			joint.upper = -0.7 + width;
			std::vector<lw_vec3> points;
			lw_shape* shape = randomMesh( rng, 10, 0.4, &points );
			model.body( 1, shape, randomTransform( rng, 1 ), points );
			RobotPtr robot = model.create();
			ReachPtr reach = build( robot.get(), error );
			lw_reach_node node = lw_reach_get_node( reach.get(), 1 );
			EXPECT_LE( node.excess, error );
			std::vector<lw_vec3> body = linkPoints( model, 1 );
			Directions directions( rng, reach.get(), 300 );
			std::vector<double> most( directions.all.size(), -inf );
			double low, high;
			lw_reach_variable_range( reach.get(), 0, &low, &high );
			for ( int s = 0; s <= 2000; ++s )
			{
				State q = { std::min( high, low + ( high - low ) * s / 2000.0 ) };
				std::vector<lw_transform> pose( 2 );
				lw_robot_fk( robot.get(), q.data(), pose.data() );
				for ( lw_vec3 p : body )
				{
					lw_vec3 world = apply( pose[1], p );
					for ( std::size_t k = 0; k < most.size(); k += s % 20 == 0 ? 1 : 50 ) // finely along some directions
					{
						most[k] = std::max( most[k], dot( directions.all[k], world ) );
					}
				}
			}
			for ( std::size_t k = 0; k < most.size(); ++k )
			{
				EXPECT_LE( most[k], directions.reach[1][k] + rounding );
				if ( k % 50 == 0 ) // its claimed excess is true: between the states 2e-4 are lost at most
				{
					EXPECT_GE( most[k], directions.reach[1][k] - node.excess - 2e-4 ) << "width " << width;
				}
			}
		}
	}
}

TEST( MotionHull, RoundBodiesAreInsideAndHardlyExceeded )
{
	SeededRng rng;
	for ( int i = 0; i < 60; ++i )
	{
		lw_shape_type type = static_cast<lw_shape_type>( LW_SHAPE_BOX + i % 5 );
		double d[3] = { rng.decade( -3, 0 ), rng.decade( -3, 0 ), rng.decade( -3, 0 ) };
		RobotModel model;
		model.link( "base" );
		lw_transform pose = randomTransform( rng, 0.5 );
		model.body( 0, primitive( type, d[0], d[1], d[2] ), pose );
		RobotPtr robot = model.create();
		ReachPtr reach = build( robot.get() );
		lw_reach_node node = lw_reach_get_node( reach.get(), 0 );
		Directions directions( rng, reach.get(), 400 );
		for ( std::size_t k = 0; k < directions.all.size(); ++k )
		{
			lw_vec3 n = directions.all[k], local;
			double* out = &local.x;
			for ( int c = 0; c < 3; ++c )
			{
				out[c] = pose.r[0][c] * n.x + pose.r[1][c] * n.y + pose.r[2][c] * n.z;
			}
			double offset = dot( n, { pose.t[0], pose.t[1], pose.t[2] } );
			double truth = offset + primitiveSupport( type, d, local );
			EXPECT_LE( truth, directions.reach[0][k] + rounding ) << "type " << type;
			EXPECT_GE( truth, directions.reach[0][k] - node.excess - rounding ) << "type " << type;
			double center = dot( n, { node.m.center[0], node.m.center[1], node.m.center[2] } );
			EXPECT_LE( truth, center + node.m.radius + rounding );
			center = dot( n, { node.r.center[0], node.r.center[1], node.r.center[2] } );
			EXPECT_LE( truth, center + node.r.radius + rounding ); // world and link frame agree here
		}
	}
}

TEST( MotionHull, PlanarAndFloatingJointsWithLimits )
{
	SeededRng rng;
	for ( int i = 0; i < 8; ++i )
	{
		RobotModel model;
		model.worldFromRoot = randomTransform( rng, 1 );
		model.link( "base" );
		for ( std::uint32_t k = 0; k < 2; ++k )
		{
			lw_joint_type type = ( i + k ) % 2 ? LW_JOINT_FLOATING : LW_JOINT_PLANAR;
			lw_joint_def& joint = model.joint( "l" + std::to_string( k ), type, k );
			joint.parent_from_joint = randomTransform( rng, 1 );
			joint.axis[0] = rng.uniform( -1, 1 );
			for ( int c = 0; c < 3; ++c )
			{
				joint.position_lower[c] = rng.uniform( -0.5, 0.2 );
				joint.position_upper[c] = joint.position_lower[c] + rng.uniform( 0, 0.5 );
			}
		}
		std::vector<lw_vec3> points;
		lw_shape* shape = randomMesh( rng, 5, 0.2, &points );
		model.body( 2, shape, randomTransform( rng, 0.1 ), points );
		RobotPtr robot = model.create();
		ReachPtr reach = build( robot.get() );
		Directions directions( rng, reach.get(), 300 );
		int bounded = 0;
		for ( int s = 0; s < 3000 && !HasFailure(); ++s )
		{
			State q = coveredState( rng, reach.get(), s % 2 == 0 );
			bounded += expectContained( rng, model, reach.get(), directions, q, { {}, {}, linkPoints( model, 2 ) } );
		}
		EXPECT_GT( bounded, 8000 );

		// one limit less, of either side of either direction, and nothing holds it
		lw_joint_def& joint = model.joints[1];
		int last = joint.type == LW_JOINT_FLOATING ? 2 : 1;
		( i & 4 ? joint.position_upper : joint.position_lower )[last] = i & 4 ? inf : -inf;
		robot = model.create();
		EXPECT_EQ( lw_reach_get_node( build( robot.get() ).get(), 2 ).m.radius, inf );
		EXPECT_EQ( lw_reach_get_node( build( robot.get() ).get(), 0 ).m.radius, inf );
	}
}

TEST( MotionHull, UnlimitedJointsAreUnboundedUpToTheRoot )
{
	RobotModel model;
	model.link( "base" );
	model.joint( "turn", LW_JOINT_CONTINUOUS, 0 );
	lw_joint_def& slide = model.joint( "slide", LW_JOINT_PRISMATIC, 1 );
	slide.lower = 0;
	slide.upper = inf;
	model.joint( "tip", LW_JOINT_REVOLUTE, 2 );
	model.joint( "side", LW_JOINT_REVOLUTE, 0 );
	model.joint( "empty", LW_JOINT_REVOLUTE, 0 );
	for ( std::uint32_t link : { 1u, 3u, 4u } )
	{
		model.body( link, primitive( LW_SHAPE_BOX, 0.1, 0.2, 0.3 ), at( 0.1, 0, 0 ) );
	}
	RobotPtr robot = model.create();
	ReachPtr reach = build( robot.get() );
	auto node = [&]( std::uint32_t link ) { return lw_reach_get_node( reach.get(), link ); };
	for ( std::uint32_t link : { 0u, 1u, 2u } )
	{
		EXPECT_EQ( node( link ).m.radius, inf ) << link;
		EXPECT_EQ( node( link ).hull_point_count, 0u );
		EXPECT_EQ( lw_reach_hull_points( reach.get(), link ), nullptr );
	}
	EXPECT_EQ( node( 1 ).mr.radius, inf ); // the slider is seen from it
	EXPECT_LT( node( 2 ).mr.radius, 1 );   // seen from the sliding link it is not far
	EXPECT_LT( node( 2 ).r.radius, 0 );
	EXPECT_LT( node( 3 ).m.radius, 1 );
	EXPECT_LT( node( 4 ).m.radius, 1 );
	EXPECT_LT( node( 5 ).m.radius, 0 );
	EXPECT_LT( node( 5 ).mr.radius, 0 );
	EXPECT_EQ( node( 5 ).hull_point_count, 0u );
}

TEST( MotionHull, RangesAreLimitsWidened )
{
	RobotModel model;
	model.link( "base" );
	model.joint( "a", LW_JOINT_REVOLUTE, 0 );
	model.joint( "b", LW_JOINT_CONTINUOUS, 1 );
	lw_joint_def& plane = model.joint( "c", LW_JOINT_PLANAR, 2 );
	plane.position_lower[0] = -1;
	plane.position_upper[0] = 2;
	model.joint( "d", LW_JOINT_FLOATING, 3 );
	RobotPtr robot = model.create();
	ReachPtr reach = build( robot.get() );
	auto expect = [&]( std::uint32_t variable, double low, double high )
	{
		double a, b;
		lw_reach_variable_range( reach.get(), variable, &a, &b );
		EXPECT_DOUBLE_EQ( a, low ) << variable;
		EXPECT_DOUBLE_EQ( b, high ) << variable;
	};
	expect( 0, -3 - 1e-4, 3 + 1e-4 );
	expect( 1, -inf, inf ); // continuous
	expect( 2, -1 - 1e-4, 2 + 1e-4 );
	expect( 3, -inf, inf );
	expect( 4, -inf, inf ); // theta
	expect( 8, -inf, inf ); // of a quaternion
}

TEST( MotionHull, ExcessKeepsTheBudgetOverAChain )
{
	SeededRng rng;
	for ( double error : { 0.2, 0.02 } )
	{
		RobotModel model;
		model.link( "base" );
		for ( std::uint32_t i = 0; i < 4; ++i )
		{
			lw_joint_def& joint = model.joint( "l" + std::to_string( i ), LW_JOINT_REVOLUTE, i );
			joint.parent_from_joint = randomTransform( rng, 0.2 );
			joint.lower = -1;
			joint.upper = 1;
			std::vector<lw_vec3> points;
			lw_shape* shape = randomMesh( rng, 20, 0.1, &points );
			model.body( i + 1, shape, lw_transform_identity(), points );
		}
		RobotPtr robot = model.create();
		ReachPtr reach = build( robot.get(), error );
		for ( std::uint32_t link = 0; link < 5; ++link )
		{
			lw_reach_node node = lw_reach_get_node( reach.get(), link );
			EXPECT_LE( node.excess, error );
			EXPECT_LE( node.dilation, node.excess );
		}
	}
}

namespace
{

/// A finely meshed ball of which most vertices can be dropped, wherever they are.
lw_shape* denseBall( double radius, std::vector<lw_vec3>* points )
{
	constexpr int across = 24, around = 48;
	std::vector<double> vertices;
	std::vector<std::uint32_t> indices;
	for ( int i = 0; i <= across; ++i )
	{
		for ( int k = 0; k < around; ++k )
		{
			const double z = M_PI * i / across, angle = 2 * M_PI * ( k + 0.5 * i ) / around;
			const lw_vec3 p = { radius * std::sin( z ) * std::cos( angle ), radius * std::sin( z ) * std::sin( angle ),
			    radius * std::cos( z ) };
			points->push_back( p );
			vertices.insert( vertices.end(), { p.x, p.y, p.z } );
			const auto at = static_cast<std::uint32_t>( around * i + k ),
			           next = static_cast<std::uint32_t>( around * i + ( k + 1 ) % around );
			if ( i < across )
			{
				indices.insert( indices.end(), { at, next, at + around } );
			}
		}
	}
	return meshOf( vertices, indices );
}

} // namespace

TEST( MotionHull, PointsThatWereDroppedBelowAreHeldAbove )
{
	SeededRng rng;
	int dropped = 0;
	for ( int i = 0; i < 60; ++i )
	{
		RobotModel model;
		model.link( "base" );
		const lw_transform turned = randomTransform( rng, 0 );
		slidingArm( model, "l", lw_transform_identity(), turned, rng.decade( -4.5, -1.5 ),
		    randomTransform( rng, 0 ) ); // the flattest are dropped of the mesh already
		RobotPtr robot = model.create();
		ReachPtr reach = build( robot.get(), 0.15 );
		const lw_vec3 n = { turned.r[0][0], turned.r[1][0], turned.r[2][0] };
		const std::vector<lw_vec3> points = linkPoints( model, 3 );
		std::vector<lw_transform> pose( model.linkNames.size() );
		const State q( 3, 0.0 );
		ASSERT_EQ( lw_robot_fk( robot.get(), q.data(), pose.data() ), LW_OK );
		for ( std::uint32_t node = 1; node < pose.size(); ++node )
		{
			const lw_reach_node of = lw_reach_get_node( reach.get(), node );
			const double most = support( lw_reach_hull_points( reach.get(), node ), of.hull_point_count, n );
			for ( lw_vec3 p : points )
			{
				const double x = dot( n, applyInverse( pose[node - 1], apply( pose[3], p ) ) );
				EXPECT_LE( x, most + of.dilation + rounding ) << "node " << node;
				dropped += x > most + 1e-5;
			}
		}
	}
	EXPECT_GE( dropped, 10 ) << "no point was dropped";
}

TEST( MotionHull, SpheresHoldPointsThatWereDropped )
{
	SeededRng rng;
	int dropped = 0, tight = 0;
	for ( int i = 0; i < 40; ++i )
	{
		RobotModel model;
		model.link( "base" );
		std::vector<lw_vec3> points;
		for ( std::uint32_t parent = 0; parent < 2; ++parent ) // no turn, whose sampling would make hulls larger
		{
			lw_joint_def& joint = model.joint( "l" + std::to_string( parent ), LW_JOINT_PRISMATIC, parent );
			joint.parent_from_joint = randomTransform( rng, 0.3 );
			joint.lower = -rng.uniform( 0, 0.3 );
			joint.upper = rng.uniform( 0, 0.3 );
		}
		lw_shape* shape = denseBall( rng.uniform( 0.05, 0.3 ), &points );
		model.body( 2, shape, randomTransform( rng, 0.2 ), points );
		RobotPtr robot = model.create();
		ReachPtr reach = build( robot.get(), 0.15 );
		dropped += lw_reach_get_node( reach.get(), 1 ).dilation > 1e-5;
		const std::vector<lw_vec3> inLink = linkPoints( model, 2 );
		double farthest[3] = { 0, 0, 0 };
		for ( int corner = 0; corner < 4; ++corner )
		{
			State q( 2 );
			for ( std::uint32_t v = 0; v < 2; ++v )
			{
				double low, high;
				lw_reach_variable_range( reach.get(), v, &low, &high );
				q[v] = corner >> v & 1 ? high : low;
			}
			std::vector<lw_transform> pose( model.linkNames.size() );
			ASSERT_EQ( lw_robot_fk( robot.get(), q.data(), pose.data() ), LW_OK );
			for ( std::uint32_t node = 0; node < 3; ++node )
			{
				const lw_reach_node of = lw_reach_get_node( reach.get(), node );
				for ( lw_vec3 p : inLink )
				{
					const lw_vec3 world = apply( pose[2], p );
					const double far = distance( of.mr.center, applyInverse( pose[node], world ) );
					EXPECT_LE( far, of.mr.radius + rounding ) << "node " << node;
					EXPECT_TRUE( node == 0 ||
					             distance( of.m.center, applyInverse( pose[node - 1], world ) ) <= of.m.radius + rounding );
					farthest[node] = std::max( farthest[node], far );
				}
			}
		}
		tight += farthest[0] > 0.99 * lw_reach_get_node( reach.get(), 0 ).mr.radius;
	}
	EXPECT_GE( dropped, 30 );
	EXPECT_GE( tight, 30 );
}
