// SPDX-License-Identifier: BSD-3-Clause
// Lines, arcs and polylines that arms of six and seven joints follow.
#include "line_world.hpp"

TEST( Lines, ASevenAxisArmLeavesItsLine )
{
	LineWorld world( sevenAxisArm() );
	world.task.waypoints = { { placed( 0.35, -0.25, 0.45 ) }, { placed( 0.4, 0.25, 0.5 ) } };
	const lines::Result r = world.plan();
	world.expectOnItsWay( r );
	EXPECT_LT( r.segments.size(), 40u );
	const lines::Part& part = r.parts.front();
	for ( const double u : { 0.0, 0.1, 0.5, 0.9, 1.0 } ) // on the line of the task, with the pace that is promised
	{
		const double y = part.wanted( part.begin + u * part.seconds ).t[1];
		EXPECT_NEAR( -0.25 + 0.5 * ( 3 * u * u - 2 * u * u * u ), y, 1e-9 );
	}
}

TEST( Lines, ASixAxisArmLeavesItsArc )
{
	LineWorld world( sixAxisArm() );
	world.task.waypoints = {
	    { placed( 0.45, -0.1, 0.4 ) }, { placed( 0.45, 0.1, 0.4, M_PI - 0.3 ), lw_vec3{ 0.5, 0, 0.45 } } };
	const lines::Result r = world.plan();
	world.expectOnItsWay( r );
	EXPECT_GT( std::fabs( r.parts.front().region.arc.x ) + std::fabs( r.parts.front().region.arc.z ), 0.1 );
}

TEST( Lines, APolylineRunsOverItsCorners )
{
	LineWorld world( sevenAxisArm() );
	world.task.waypoints = { { placed( 0.35, -0.15, 0.4 ) }, { placed( 0.35, -0.15, 0.55 ) }, { placed( 0.35, 0.2, 0.55 ) },
	    { placed( 0.35, 0.2, 0.4 ) } };
	const lines::Result r = world.plan();
	world.expectOnItsWay( r );
	ASSERT_EQ( 3u, r.parts.size() );
	const std::size_t count = world.problem.variables.size();
	for ( const lines::Part& part : r.parts ) // at rest at both ends
	{
		const Vector &first = r.segments[part.first].points, &last = r.segments[part.first + part.count - 1].points;
		for ( std::size_t v = 0; v < count; ++v )
		{
			EXPECT_EQ( first[v], first[count + v] );
			EXPECT_EQ( last[2 * count + v], last[3 * count + v] );
		}
	}
}

TEST( Lines, TheStartStateStaysWhereItIs )
{
	LineWorld world( sixAxisArm() );
	world.problem.reference = { 0.2, 0.5, 1.2, 0.1, -0.6, 0.3 };
	world.task.any_start = false;
	lw_transform to = world.tip( world.problem.reference );
	to.t[1] += 0.1;
	to.t[2] += 0.05;
	world.task.waypoints = { { to } };
	const lines::Result r = world.plan();
	world.expectOnItsWay( r );
	EXPECT_EQ( world.problem.reference, Vector( r.segments.front().points.begin(), r.segments.front().points.begin() + 6 ) );
}

TEST( Lines, TheTrajectoryIsFasterThanItsLimits )
{
	LineWorld world( sevenAxisArm() );
	world.settings.limits.velocity.assign( 7, 0.3 );
	world.settings.limits.acceleration.assign( 7, 0.5 );
	world.task.waypoints = { { placed( 0.35, -0.25, 0.45 ) }, { placed( 0.4, 0.25, 0.5 ) } };
	const lines::Result r = world.plan();
	ASSERT_TRUE( r.solved );
	motions::TrajectorySettings settings;
	settings.edge = world.settings.edge;
	for ( std::size_t v = 0; v < 7; ++v )
	{
		settings.limits.velocity[world.problem.variable_names[v]] = 0.3;
		settings.limits.acceleration[world.problem.variable_names[v]] = 0.5;
	}
	const motions::TrajectoryAudit audit =
	    motions::auditTrajectory( world.problem, world.robot, "line", r.segments, settings );
	EXPECT_TRUE( audit.valid() ) << motions::describe( audit );
	world.task.speed = 0.02;
	const lines::Result slow = world.plan();
	ASSERT_TRUE( slow.solved );
	EXPECT_GE( slow.parts.front().seconds, 1.5 * std::sqrt( 0.05 * 0.05 + 0.5 * 0.5 + 0.05 * 0.05 ) / 0.02 );
}

TEST( Lines, AFreeAxisIsHeldFast )
{
	LineWorld world( sixAxisArm() );
	world.task.waypoints = { { placed( 0.45, -0.1, 0.4 ) }, { placed( 0.45, 0.1, 0.4, M_PI, 0, 3 ) } };
	world.task.free_axis = lw_vec3{ 0, 0, 2 };
	const lines::Result r = world.plan();
	world.expectOnItsWay( r );
	const lw_transform first = world.tip( motions::stateAt( r.segments, 0 ) ),
	                   last = world.tip( motions::stateAt( r.segments, 1e9 ) );
	EXPECT_GT( first.r[0][0] * last.r[0][0] + first.r[1][0] * last.r[1][0], -0.9 ); // it did not turn by 3 rad
}

TEST( Lines, AnotherPostureGetsPastAnObstacle )
{
	// a ball beside the elbow's usual place
	const std::string scene =
	    "world:\n  collision_objects:\n    - {id: ball, primitives: [{type: sphere, dimensions: [0.06]}], "
	    "primitive_poses: [{position: [0.5, 0.0, 0.35], orientation: [0, 0, 0, 1]}]}\n";
	LineWorld world( sevenAxisArm(), scene );
	world.task.waypoints = { { placed( 0.35, -0.25, 0.45 ) }, { placed( 0.3, 0.25, 0.5 ) } };
	const lines::Result r = world.plan();
	world.expectOnItsWay( r );
}

TEST( Lines, PosesAreThoseOfAnotherFrame )
{
	LineWorld world( sevenAxisArm() );
	world.task.base = io::findFrame( world.problem, "j1_link", "test", "base" ); // it turns below the hand
	world.task.waypoints = { { placed( 0.35, 0, 0.15 ) }, { placed( 0.45, 0, 0.2 ) } };
	world.expectOnItsWay( world.plan() );
}

TEST( Lines, EqualSeedsGiveOtherAnswers )
{
	LineWorld world( sevenAxisArm() );
	world.task.waypoints = { { placed( 0.35, -0.25, 0.45 ) }, { placed( 0.4, 0.25, 0.5 ) } };
	const lines::Result a = world.plan(), b = world.plan();
	ASSERT_TRUE( a.solved && b.solved );
	EXPECT_EQ( a.segments.front().points, b.segments.front().points );
	EXPECT_EQ( a.segments.size(), b.segments.size() );
}
