// SPDX-License-Identifier: BSD-3-Clause
// The robot's own body: points within the shadow of its exact geometry are dropped, all others are kept. Against distances in closed form.
#include "cloud_bench.hpp"
#include "random_robot.hpp"
#include "simple_shapes.hpp"

#include <algorithm>

namespace
{

/// One link that turns about z, with a box, a ball in its hand, and a mesh that is the same box elsewhere.
struct Arm
{
	static constexpr double HALF[3] = { 0.2, 0.05, 0.03 };
	RobotModel model;
	RobotPtr robot;

	Arm()
	{
		model.link( "base" );
		model.joint( "arm", LW_JOINT_REVOLUTE, 0 );
		model.body( 1, primitive( LW_SHAPE_BOX, 2 * HALF[0], 2 * HALF[1], 2 * HALF[2] ), at( 0.3, 0, 0 ) );
		model.body( 1, primitive( LW_SHAPE_SPHERE, 0.08 ), at( 0.6, 0, 0.02 ) );
		std::vector<double> corners;
		for ( int i = 0; i < 8; ++i )
		{
			for ( int k = 0; k < 3; ++k )
			{
				corners.push_back( i >> k & 1 ? HALF[k] : -HALF[k] );
			}
		}
		model.body( 1,
		    meshOf( corners, { 0, 1, 3, 0, 3, 2, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4, 2, 3, 7, 2, 7, 6, 0, 2, 6, 0, 6, 4, 1,
		                         3, 7, 1, 7, 5 } ),
		    at( 0.3, 0, 0.3 ) );
		robot = model.create();
	}

	/// Distance of a point of the world to the robot at this angle. The mesh is a surface, but no point is taken inside of it.
	static double distance( const Point& p, double angle )
	{
		const double x = std::cos( angle ) * p[0] + std::sin( angle ) * p[1],
		             y = std::cos( angle ) * p[1] - std::sin( angle ) * p[0];
		const auto box = [&]( double z )
		{
			const double d[3] = { std::abs( x - 0.3 ) - HALF[0], std::abs( y ) - HALF[1], std::abs( p[2] - z ) - HALF[2] };
			return std::hypot( std::max( d[0], 0.0 ), std::max( d[1], 0.0 ), std::max( d[2], 0.0 ) );
		};
		const double ball = std::max( 0.0, std::hypot( x - 0.6, y, p[2] - 0.02 ) - 0.08 );
		return std::min( { box( 0 ), box( 0.3 ), ball } );
	}
};

} // namespace

TEST( CloudBody, APointOfTheBodyStaysOrAnObstacleGoes )
{
	SeededRng rng( 20261206 );
	const Arm arm;
	for ( const double shadow : { 0.0, 0.01, 0.05 } )
	{
		lw_cloud_def def = cloudOf( 0.01, 1 );
		def.shadow = shadow;
		const CloudPtr cloud = makeCloud( def );
		std::size_t own = 0, kept = 0;
		for ( int frame = 1; frame <= 30; ++frame )
		{
			const double angle = rng.uniform( -3, 3 );
			std::vector<Point> points;
			std::size_t expected = 0;
			lw_cloud_clear( cloud.get() );
			while ( points.size() < 200 )
			{
				Point p = randomPoint( rng, 0.8 );
				p[2] *= 0.5;
				const double d = Arm::distance( p, angle );
				// on the side of a body rounding decides; inside of the mesh it has no surface
				const bool inside_mesh = Arm::distance( { p[0], p[1], p[2] }, angle ) == 0 && p[2] > 0.2;
				if ( d > 0.1 || ( d > 0 && std::abs( d - shadow ) < 1e-9 ) || inside_mesh )
				{
					continue;
				}
				points.push_back( p );
				expected += d <= shadow ? 1 : 0;
			}
			PointFrame f( frame, points );
			f.frame.robot = arm.robot.get();
			f.frame.state = &angle;
			const lw_cloud_report report = insert( cloud.get(), f.frame );
			ASSERT_EQ( report.own, expected );
			ASSERT_EQ( report.inserted, points.size() - expected );
			for ( const Point& p : points )
			{
				ASSERT_TRUE( Arm::distance( p, angle ) <= shadow || stateAt( cloud.get(), p ) == LW_VOXEL_OCCUPIED );
			}
			own += report.own;
			kept += report.inserted;
		}
		EXPECT_GT( own, 10u );
		EXPECT_GT( kept, 1000u );
	}
}

/// An object in the hand is part of the robot; without it the points are an obstacle.
TEST( CloudBody, TheObjectInTheHandIsAnObstacle )
{
	const Arm arm;
	const ShapePtr cup( primitive( LW_SHAPE_SPHERE, 0.05 ) );
	const lw_shape* shapes[1] = { cup.get() };
	const lw_transform pose = at( 0.9, 0, 0 );
	lw_attachment_def attach = lw_attachment_def_default();
	attach.name = "cup";
	attach.link = 1;
	attach.shapes = shapes;
	attach.link_from_shape = &pose;
	attach.shape_count = 1;
	lw_robot* made = nullptr;
	ASSERT_EQ( LW_OK, lw_robot_attach( arm.robot.get(), &attach, nullptr, nullptr, &made ) );
	const RobotPtr holding( made );
	const CloudPtr cloud = makeCloud( cloudOf( 0.01, 1 ) );
	const double angle = 0;
	PointFrame frame( 1, { { 0.851, 0.001, 0.001 } } );
	frame.frame.robot = holding.get();
	frame.frame.state = &angle;
	EXPECT_EQ( insert( cloud.get(), frame.frame ).own, 1u );
	frame.frame.robot = arm.robot.get();
	frame.frame.stamp = 2;
	EXPECT_EQ( insert( cloud.get(), frame.frame ).inserted, 1u );
}

/// The robot in front of an obstacle: its points clear voxels before it, and none behind.
TEST( CloudBody, RaysGoThroughTheRobot )
{
	const Arm arm;
	const double angle = 0;
	const CloudPtr cloud = makeCloud( cloudOf( 0.02, 2 ) );
	const Point before = { 0.61, 0.01, 0.71 }, behind = { 0.61, 0.01, -0.51 };
	hit( cloud.get(), 1, { before, behind }, { 0.6, 0, 1.5 } );
	DepthFrame frame( 2, lookAt( { 0.6, 0, 1.5 }, { 0.6, 0, 0 } ), 81, 81, 600 );
	frame.fill( 1.4 ); // the ball's top is at z = 0.1
	frame.frame.robot = arm.robot.get();
	frame.frame.state = &angle;
	const lw_cloud_report report = insert( cloud.get(), frame.frame );
	EXPECT_GT( report.own, 500u );
	EXPECT_EQ( stateAt( cloud.get(), before ), LW_VOXEL_UNSEEN );
	EXPECT_EQ( stateAt( cloud.get(), behind ), LW_VOXEL_OCCUPIED );
	EXPECT_EQ( stateAt( cloud.get(), { 0.61, 0.01, 0.09 } ), LW_VOXEL_UNSEEN ) << "its own body is no obstacle";
}

TEST( CloudBody, AStateThatIsNoNumberIsUsed )
{
	const Arm arm;
	const CloudPtr cloud = makeCloud( cloudOf( 0.02, 1 ) );
	const double angle = NAN;
	PointFrame frame( 1, { { 0.5, 0, 0 } } );
	frame.frame.robot = arm.robot.get();
	frame.frame.state = &angle;
	insert( cloud.get(), frame.frame, LW_ERROR_INVALID_ARGUMENT );
	EXPECT_EQ( lw_cloud_get_info( cloud.get() ).occupied, 0u );
	EXPECT_EQ( lw_cloud_get_info( cloud.get() ).frames, 0u );
	frame.frame.state = nullptr;
	insert( cloud.get(), frame.frame, LW_ERROR_INVALID_ARGUMENT );
}
