// SPDX-License-Identifier: BSD-3-Clause
// A cup past a shelf, a tray in two hands, a door on its hinge.
#include "manifold_world.hpp"

namespace
{

const double any = 4; // radians: no limit

/// Two arms of seven joints, 0.6 m apart, with hands `left` and `right`.
std::string twoArms()
{
	std::string links = "<link name='base'/>", joints;
	for ( const auto& [side, y] : { std::pair<std::string, double>( "left", 0.3 ), { "right", -0.3 } } )
	{
		const struct
		{
			const char *origin, *axis;
		} parts[] = { { "0 0 0.3", "0 0 1" }, { "0 0 0", "0 1 0" }, { "0 0 0.2", "0 0 1" }, { "0.05 0 0.2", "0 -1 0" },
		    { "-0.05 0 0.2", "0 0 1" }, { "0 0 0.2", "0 1 0" }, { "0.08 0 0", "0 0 -1" } };
		std::string last = "base";
		for ( int i = 0; i < 7; ++i )
		{
			const std::string link = i == 6 ? side : side + std::to_string( i + 1 );
			const std::string origin = i == 0 ? "0 " + std::to_string( y ) + " 0.3" : parts[i].origin;
			links += "<link name='" + link + "'><collision><geometry><sphere radius='0.03'/></geometry></collision></link>";
			joints += "<joint name='" + side + "_j" + std::to_string( i + 1 ) + "' type='revolute'><parent link='" + last +
			          "'/><child link='" + link + "'/><origin xyz='" + origin + "'/><axis xyz='" + parts[i].axis +
			          "'/><limit lower='-2.8' upper='2.8' effort='1' velocity='1'/></joint>";
			last = link;
		}
	}
	return "<robot name='two_arms'>" + links + joints + "</robot>";
}

std::string box( const std::string& id, const std::string& size, const std::string& place )
{
	return "    - {id: " + id + ", primitives: [{type: box, dimensions: [" + size + "]}], primitive_poses: [{position: [" +
	       place + "], orientation: [0, 0, 0, 1]}]}\n";
}

/// How much of their time the segments need, by the limits of velocity, acceleration and jerk: the mean over the time.
double neededShare( const ManifoldWorld& world, const manifold::Result& r )
{
	const motions::MotionLimits& limits = world.settings.limits;
	const std::size_t n = world.problem.variables.size();
	double needed = 0, all = 0;
	for ( const motions::Segment& s : r.segments )
	{
		double most = 0;
		for ( std::size_t v = 0; v < n; ++v )
		{
			const double *p = s.points.data() + v, h = s.seconds;
			for ( std::size_t k = 0; k < 3; ++k )
			{
				most = std::max( most, 3 * std::fabs( p[( k + 1 ) * n] - p[k * n] ) / h / limits.velocity[v] );
			}
			for ( std::size_t k = 0; k < 2; ++k )
			{
				const double second = 6 * std::fabs( p[( k + 2 ) * n] - 2 * p[( k + 1 ) * n] + p[k * n] ) / ( h * h );
				most = std::max( most, std::sqrt( second / limits.acceleration[v] ) );
			}
			const double third = 6 * std::fabs( p[3 * n] - 3 * p[2 * n] + 3 * p[n] - p[0] ) / ( h * h * h );
			most = std::max( most, std::cbrt( third / limits.mostJerk( v ) ) );
		}
		EXPECT_LE( most, 1 + 1e-9 );
		needed += most * s.seconds;
		all += s.seconds;
	}
	return needed / all;
}

} // namespace

TEST( ConstrainedTasks, ACupTiltsOnItsWayPastAShelf )
{
	ManifoldWorld world(
	    sevenAxisArm(), "world:\n  collision_objects:\n" + box( "board", "0.3, 0.5, 0.02", "0.45, 0, 0.5" ) );
	Vector start = { 0.1, 0.9, 0.1, -1.6, 0.1, 0.5, 0.3 };
	world.keepOrientation( "hand", start, { 0.1, 0.1, any } );
	world.task.start = start;
	ASSERT_TRUE( world.isFree( start ) );
	const Matrix under = world.pose( "hand", start );
	world.askForPlace(
	    "hand", { under[0][3], under[1][3], 1.04 - under[2][3] }, 0.01 ); // as far from the board on its other side
	world.task.goals =
	    manifold::constrainedGoals( world.robot, world.problem, world.request, world.path, world.settings.edge, 1 );
	const manifold::Result r = world.plan();
	world.expectKept( r );
	EXPECT_GT( neededShare( world, r ), 0.6 );
	const Vector& last = r.segments.back().points;
	const Matrix above = world.pose( "hand", Vector( last.end() - 7, last.end() ) );
	EXPECT_LT( std::fabs( above[2][3] - ( 1.04 - under[2][3] ) ), 0.0101 );
}

TEST( ConstrainedTasks, ATrayLeavesTheHands )
{
	ManifoldWorld world( twoArms() );
	Vector start;
	for ( const double turn : { 1.0, -1.0 } ) // mirrored arms
	{
		const Vector arm = { -0.2 * turn, 0.7, 0.1 * turn, -1.2, 0.1 * turn, 0.4, 0.2 * turn };
		start.insert( start.end(), arm.begin(), arm.end() );
	}
	world.keepOrientation( "left", start, { 0.1, 0.1, any } );
	world.keepOrientation(
	    "right", start, { 2e-3, 2e-3, 2e-3 }, io::OrientationGoal::Parameterization::rotation_vector, "left" );
	world.keepPlace( "right", start, { 2e-3, 2e-3, 2e-3 }, "left" );
	manifold::Manifold manifold( world.robot, world.problem, world.path );
	world.task.start = start;
	Vector goal = start;
	goal[0] += 0.4;
	goal[1] -= 0.3;
	goal[3] += 0.3;
	goal[7] += 0.4;
	ASSERT_TRUE( manifold.project( goal.data() ) );
	world.task.goals = { goal };
	const manifold::Result r = world.plan();
	world.expectKept( r );
	EXPECT_GT( neededShare( world, r ), 0.9 );
	EXPECT_GT( r.bent, 0u );
	EXPECT_GT( r.length, 0.4 );
}

TEST( ConstrainedTasks, ADoorLeavesItsHinge )
{
	ManifoldWorld world( sevenAxisArm() );
	const Vector start = { 0.1, 0.9, 0.1, -1.6, 0.1, 0.5, 0.3 };
	// The hinge is a place of the base, which the hand carries; the base turns about its z axis, seen from the hand
	world.keepOrientation( "base", start, { 1e-3, 1e-3, any }, io::OrientationGoal::Parameterization::euler_xyz, "hand" );
	world.keepPlace( "base", start, { 2e-3, 2e-3, 2e-3 }, "hand" );
	io::PositionGoal& hinge = world.path.positions[0];
	hinge.offset = { 0.5, 0.4, 0 };
	const Matrix hand = world.pose( "hand", start );
	const std::array<double, 3> seen = transformed( inverseOf( hand ), hinge.offset );
	std::copy( seen.begin(), seen.end(), hinge.regions[0].pose.t );
	manifold::Manifold manifold( world.robot, world.problem, world.path );
	SeededRng rng( 12 );
	Vector widest = start;
	double most = 0;
	const auto turned = [&]( const Vector& q )
	{ return std::fabs( eulerXyz( product( world.pose( "hand", q ), inverseOf( hand ) ) )[2] ); };
	for ( int i = 0; i < 200; ++i )
	{
		Vector q = start;
		for ( double& value : q )
		{
			value += rng.uniform( -0.6, 0.6 );
		}
		if ( manifold.project( q.data() ) && world.isFree( q ) && turned( q ) > most && turned( q ) < 1.2 )
		{
			widest = q;
			most = turned( q );
		}
	}
	ASSERT_GT( most, 0.5 );
	world.task.start = start;
	world.task.goals = { widest };
	world.expectKept( world.plan() );
}
