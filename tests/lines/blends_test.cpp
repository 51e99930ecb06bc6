// SPDX-License-Identifier: BSD-3-Clause
// Rounded corners: the tip is compared with lines and circles that the test makes itself, at dense times; radii that do not fit are named.
#include "line_world.hpp"
#include "seeded_rng.hpp"

#include <array>
#include <functional>

namespace
{

using Point = std::array<double, 3>;

Point operator-( const Point& a, const Point& b )
{
	return { a[0] - b[0], a[1] - b[1], a[2] - b[2] };
}
Point along( const Point& a, const Point& d, double s )
{
	return { a[0] + s * d[0], a[1] + s * d[1], a[2] + s * d[2] };
}
double dot( const Point& a, const Point& b )
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
double norm( const Point& a )
{
	return std::sqrt( dot( a, a ) );
}
Point unit( const Point& a )
{
	return along( { 0, 0, 0 }, a, 1 / norm( a ) );
}
Point placeOf( const lw_transform& m )
{
	return { m.t[0], m.t[1], m.t[2] };
}
double angleBetween( const lw_transform& a, const lw_transform& b )
{
	double trace = 0;
	for ( int i = 0; i < 3; ++i )
	{
		for ( int k = 0; k < 3; ++k )
		{
			trace += a.r[i][k] * b.r[i][k];
		}
	}
	return std::acos( std::clamp( 0.5 * ( trace - 1 ), -1.0, 1.0 ) );
}

/// Distance of a point from a line between two points.
double fromLine( const Point& p, const Point& a, const Point& b )
{
	const Point d = b - a;
	const double s = std::clamp( dot( p - a, d ) / dot( d, d ), 0.0, 1.0 );
	return norm( p - along( a, d, s ) );
}

/// Distance of a point from the part of a circle that touches both sides of a corner at a distance from it.
double fromCircle( const Point& p, const Point& before, const Point& corner, const Point& after, double at )
{
	const Point u = unit( before - corner ), v = unit( after - corner ), inward = unit( along( u, v, 1 ) );
	const double cosine = dot( u, inward ), sine = std::sqrt( 1 - cosine * cosine ), radius = at * sine / cosine;
	const Point center = along( corner, inward, at / cosine ),
	            normal = unit( { u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0] } );
	const Point to = p - center;
	const double lift = dot( to, normal );
	const Point flat = along( to, normal, -lift );
	// In the wedge of the corner, between both touching points
	const bool inside = dot( unit( flat ), along( { 0, 0, 0 }, inward, -1 ) ) > sine - 1e-6 || norm( flat ) < 1e-12;
	return inside ? std::hypot( norm( flat ) - radius, lift ) : HUGE_VAL;
}

/// Of all tips at dense times the distance from the way with rounded corners, and from each waypoint's orientation in its corner.
struct Measured
{
	double from_way = 0, least_speed = HUGE_VAL;
	std::vector<double> turned; ///< least, of each inner waypoint, near its corner
};

Measured measured( const LineWorld& world, const lines::Result& r )
{
	const std::vector<lines::Waypoint>& w = world.task.waypoints;
	Measured m;
	m.turned.assign( w.size(), HUGE_VAL );
	const double end = r.segments.back().begin + r.segments.back().seconds;
	Point before = placeOf( world.tip( motions::stateAt( r.segments, 0 ) ) );
	constexpr int steps = 4000;
	for ( int i = 0; i <= steps; ++i )
	{
		const lw_transform tip = world.tip( motions::stateAt( r.segments, end * i / steps ) );
		const Point p = placeOf( tip );
		double least = HUGE_VAL;
		for ( std::size_t k = 1; k < w.size(); ++k )
		{
			const Point a = placeOf( w[k - 1].pose ), b = placeOf( w[k].pose ), way = unit( b - a );
			least = std::min( least, fromLine( p, along( a, way, w[k - 1].blend ), along( b, way, -w[k].blend ) ) );
			if ( w[k].blend > 0 )
			{
				least = std::min( least, fromCircle( p, a, b, placeOf( w[k + 1].pose ), w[k].blend ) );
				m.turned[k] = std::min( m.turned[k], angleBetween( tip, w[k].pose ) );
			}
		}
		m.from_way = std::max( m.from_way, least );
		if ( i > steps / 50 && i < steps - steps / 50 )
		{
			m.least_speed = std::min( m.least_speed, norm( p - before ) * steps / end );
		}
		before = p;
	}
	return m;
}

void expectRounded( const LineWorld& world, const lines::Result& r )
{
	world.expectOnItsWay( r );
	if ( !r.solved )
	{
		return;
	}
	const Measured m = measured( world, r );
	EXPECT_LE( m.from_way, r.position_error * std::sqrt( 3 ) + 1e-9 );
	const double end = r.segments.back().begin + r.segments.back().seconds;
	EXPECT_GT( m.least_speed, 1e-3 / end ) << "it rests";
	for ( const double turned : m.turned )
	{
		EXPECT_TRUE( turned > 1e9 || turned < r.angle_error + 0.01 ) << turned; // samples come near the middle of the corner
	}
	motions::TrajectorySettings settings;
	settings.edge = world.settings.edge;
	const motions::TrajectoryAudit audit =
	    motions::auditTrajectory( world.problem, world.robot, "line", r.segments, settings );
	EXPECT_TRUE( audit.valid() ) << motions::describe( audit );
}

} // namespace

TEST( Blends, ARoundedCornerIsLeftOrRestedAt )
{
	LineWorld world( sevenAxisArm() );
	world.task.waypoints = { { placed( 0.35, -0.15, 0.4 ) }, { placed( 0.35, -0.15, 0.55 ) }, { placed( 0.35, 0.2, 0.55 ) },
	    { placed( 0.35, 0.2, 0.4 ) } };
	world.task.waypoints[1].blend = 0.03;
	world.task.waypoints[2].blend = 0.05;
	const lines::Result r = world.plan();
	expectRounded( world, r );
	ASSERT_EQ( 7u, r.parts.size() ); // three lines, four halves of corners
	EXPECT_EQ( 2u, r.parts.back().part );
	// The middle of the first corner is on its circle: the corner is ( sqrt 2 - 1 ) radii away
	const Point middle = placeOf( world.tip( motions::stateAt( r.segments, r.parts[2].begin ) ) );
	EXPECT_NEAR( 0.03 * ( std::sqrt( 2 ) - 1 ), norm( middle - Point{ 0.35, -0.15, 0.55 } ), 1e-4 );
}

TEST( Blends, ATightCornerSlowsTheLinesBesideIt )
{
	LineWorld world( sevenAxisArm() );
	world.task.waypoints = {
	    { placed( 0.35, -0.3, 0.45 ) }, { placed( 0.35, 0.1, 0.45 ), {}, 0.004 }, { placed( 0.35, 0.1, 0.6 ) } };
	const lines::Result rounded = world.plan();
	expectRounded( world, rounded );
	world.task.waypoints[1].blend = 0;
	const lines::Result rests = world.plan();
	ASSERT_TRUE( rounded.solved && rests.solved );
	const auto end = []( const lines::Result& r ) { return r.segments.back().begin + r.segments.back().seconds; };
	EXPECT_LT( end( rounded ), 1.2 * end( rests ) ); // with one scale of time 4 times as long
}

TEST( Blends, AxesThatTurnOverACornerJump )
{
	LineWorld world( sevenAxisArm() );
	world.task.waypoints = { { placed( 0.35, -0.15, 0.4 ) }, { placed( 0.35, -0.1, 0.55, M_PI - 0.3, 0.2 ), {}, 0.06 },
	    { placed( 0.4, 0.2, 0.5, M_PI, 0, 0.5 ), {}, 0.02 }, { placed( 0.35, 0.2, 0.4, M_PI + 0.2 ) } };
	const lines::Result r = world.plan();
	expectRounded( world, r );
	ASSERT_TRUE( r.solved );
	EXPECT_TRUE( r.parts[1].turns_apart );
	// The tip does not turn in the middle of a corner: half a step to both sides turns it by less than the speed on the line would
	const double at = r.parts[2].begin, step = 1e-3;
	EXPECT_LT( angleBetween( r.parts[1].wanted( at - step ), r.parts[2].wanted( at + step ) ), 0.01 * step );
	EXPECT_NEAR( 0, angleBetween( r.parts[2].wanted( at ), world.task.waypoints[1].pose ), 1e-7 );
}

TEST( Blends, AStraightCornerNeedsNoCircle )
{
	LineWorld world( sevenAxisArm() );
	world.task.waypoints = {
	    { placed( 0.35, -0.2, 0.45 ) }, { placed( 0.35, 0, 0.45 ), {}, 0.02 }, { placed( 0.35, 0.2, 0.45 ) } };
	const lines::Result r = world.plan();
	world.expectOnItsWay( r );
	ASSERT_EQ( 2u, r.parts.size() );
	EXPECT_GT( std::fabs( r.parts[1].pace.first ), 0.1 );
}

TEST( Blends, SomeCornersRestAndOthersDoNot )
{
	LineWorld world( sixAxisArm() );
	world.task.waypoints = { { placed( 0.45, -0.1, 0.4 ) }, { placed( 0.45, -0.1, 0.45 ), {}, 0.02 },
	    { placed( 0.45, 0.1, 0.45 ) }, { placed( 0.5, 0.1, 0.45 ), {}, 0.02 }, { placed( 0.5, 0.1, 0.4 ) } };
	const lines::Result r = world.plan();
	world.expectOnItsWay( r );
	ASSERT_EQ( 8u, r.parts.size() );
	const std::size_t count = world.problem.variables.size(), resting = r.parts[4].first;
	for ( std::size_t v = 0; v < count; ++v )
	{
		EXPECT_EQ( r.segments[resting].points[v], r.segments[resting].points[count + v] );
	}
}

TEST( Blends, ARandomWayIsLeft )
{
	SeededRng rng( 57 );
	int solved = 0;
	for ( int i = 0; i < 40; ++i )
	{
		LineWorld world( sevenAxisArm() );
		world.settings.attempts = 6;
		Point at = { 0.35, -0.15, 0.45 };
		world.task.waypoints = { { placed( at[0], at[1], at[2] ) } };
		const double side = rng.uniform( 0.06, 0.15 );
		for ( int k = 0; k < 4; ++k )
		{
			const Point to = unit( { rng.uniform( -1, 1 ), rng.uniform( 0, 1 ), rng.uniform( -1, 1 ) } );
			at = along( at, to, side );
			const double turn = rng.uniform( -0.3, 0.3 );
			world.task.waypoints.push_back( { placed( at[0], at[1], at[2], M_PI + turn, turn * turn ), {},
			    k < 3 ? rng.uniform( 0.1, 0.5 ) * side : 0 } );
		}
		const lines::Result r = world.plan();
		if ( r.solved )
		{
			++solved;
			expectRounded( world, r );
		}
	}
	EXPECT_GT( solved, 20 );
}

TEST( Blends, RadiiThatDoNotFit )
{
	const struct
	{
		const char* words;
		std::function<void( lines::Task& )> spoil;
	} cases[] = {
	    { "has the radius -0.01", []( lines::Task& t ) { t.waypoints[1].blend = -0.01; } },
	    { "has the radius nan", []( lines::Task& t ) { t.waypoints[1].blend = NAN; } },
	    { "has the radius inf", []( lines::Task& t ) { t.waypoints[1].blend = HUGE_VAL; } },
	    { "need 0.16 m of a line of 0.15 m", []( lines::Task& t ) { t.waypoints[1].blend = 0.16; } },
	    { "waypoint 3 and the one before: need 0.36 m of a line of 0.35 m",
	        []( lines::Task& t )
	        {
		        t.waypoints[1].blend = 0.15;
		        t.waypoints[2].blend = 0.21;
	        } },
	    { "waypoint 4: has a radius, and the way ends there", []( lines::Task& t ) { t.waypoints[3].blend = 0.01; } },
	    { "waypoint 1: has a radius, and the way begins there", []( lines::Task& t ) { t.waypoints[0].blend = 0.01; } },
	    { "beside an arc",
	        []( lines::Task& t )
	        {
		        t.waypoints[1].blend = 0.01;
		        t.waypoints[2].via = lw_vec3{ 0.4, 0, 0.6 };
	        } },
	    { "turns back",
	        []( lines::Task& t )
	        {
		        t.waypoints[1].blend = 0.01;
		        t.waypoints[2].pose = t.waypoints[0].pose;
	        } },
	    { "is where the waypoint before is",
	        []( lines::Task& t )
	        {
		        t.waypoints[2] = t.waypoints[1];
		        t.waypoints[2].blend = 0.01;
	        } },
	    { "beside an arc or a turn in place",
	        []( lines::Task& t )
	        {
		        t.waypoints[1].blend = 0.01;
		        t.waypoints[2].pose = placed( 0.35, -0.15, 0.55, M_PI - 0.3 );
	        } },
	};
	for ( const auto& wrong : cases )
	{
		LineWorld world( sevenAxisArm() );
		world.task.waypoints = { { placed( 0.35, -0.15, 0.4 ) }, { placed( 0.35, -0.15, 0.55 ) },
		    { placed( 0.35, 0.2, 0.55 ) }, { placed( 0.35, 0.2, 0.4 ) } };
		wrong.spoil( world.task );
		try
		{
			world.plan();
			ADD_FAILURE() << wrong.words;
		}
		catch ( const io::Error& error )
		{
			EXPECT_NE( std::string::npos, std::string( error.what() ).find( wrong.words ) ) << error.what();
		}
	}
}
