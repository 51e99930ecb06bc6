// SPDX-License-Identifier: BSD-3-Clause
// Motion hulls: nothing that moves leaves them, and they are no larger than they say.
//
// The oracle of membership is the support function: a point is outside of a dilated convex set exactly if along some
// direction it is farther than the farthest of the set. Directions are many and random; forward kinematics place the points.
#include "counting_allocator.hpp"
#include "hull_probe.h"
#include "leeway/leeway.h"
#include "random_robot.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <numeric>

namespace
{

constexpr double inf = INFINITY;
constexpr double rounding = 1e-12; ///< of the forward kinematics that place the points, metres

struct ReachReleaser
{
	void operator()( lw_reach* reach ) const { lw_reach_release( reach ); }
};
using ReachPtr = std::unique_ptr<lw_reach, ReachReleaser>;

struct SweepsReleaser
{
	void operator()( hull_probe_sweeps* sweeps ) const { hull_probe_sweeps_destroy( sweeps ); }
};
using SweepsPtr = std::unique_ptr<hull_probe_sweeps, SweepsReleaser>;

ReachPtr build( const lw_robot* robot, double hullError = 0 )
{
	lw_reach_def def = lw_reach_def_default();
	def.robot = robot;
	def.hull_error = hullError;
	lw_reach* reach = nullptr;
	lw_diag diag = {};
	EXPECT_EQ( hull_probe_create( &def, nullptr, &diag, &reach ), LW_OK ) << diag.message;
	return ReachPtr( reach );
}

lw_vec3 direction( SeededRng& rng )
{
	double x = rng.normal(), y = rng.normal(), z = rng.normal(), l = std::sqrt( x * x + y * y + z * z );
	return { x / l, y / l, z / l };
}

double dot( lw_vec3 a, lw_vec3 b ) { return a.x * b.x + a.y * b.y + a.z * b.z; }

double support( const double* points, std::size_t count, lw_vec3 n )
{
	double most = -inf;
	for ( std::size_t i = 0; i < count; ++i )
	{
		most = std::max( most, n.x * points[3 * i] + n.y * points[3 * i + 1] + n.z * points[3 * i + 2] );
	}
	return most;
}

lw_vec3 apply( const lw_transform& m, lw_vec3 p )
{
	return { m.r[0][0] * p.x + m.r[0][1] * p.y + m.r[0][2] * p.z + m.t[0],
		m.r[1][0] * p.x + m.r[1][1] * p.y + m.r[1][2] * p.z + m.t[1],
		m.r[2][0] * p.x + m.r[2][1] * p.y + m.r[2][2] * p.z + m.t[2] };
}

lw_vec3 applyInverse( const lw_transform& m, lw_vec3 p )
{
	double d[3] = { p.x - m.t[0], p.y - m.t[1], p.z - m.t[2] };
	auto row = [&]( int k ) { return m.r[0][k] * d[0] + m.r[1][k] * d[1] + m.r[2][k] * d[2]; };
	return { row( 0 ), row( 1 ), row( 2 ) };
}

double distance( const double c[3], lw_vec3 p )
{
	return std::sqrt( ( p.x - c[0] ) * ( p.x - c[0] ) + ( p.y - c[1] ) * ( p.y - c[1] ) + ( p.z - c[2] ) * ( p.z - c[2] ) );
}

/// A state that the reach covers: inside the widened limits, or on them. Without limits: anything.
State coveredState( SeededRng& rng, const lw_reach* reach, bool corner )
{
	State q( lw_robot_variable_count( lw_reach_robot( reach ) ) );
	for ( std::uint32_t i = 0; i < q.size(); ++i )
	{
		double low, high;
		lw_reach_variable_range( reach, i, &low, &high );
		q[i] = std::isfinite( low ) && std::isfinite( high )
				   ? ( corner ? ( rng.integer( 0, 1 ) ? low : high ) : rng.uniform( low, high ) )
				   : rng.uniform( std::max( low, -9.0 ), std::min( high, 9.0 ) );
	}
	return q;
}

/// The nodes whose M hold a link: its own and those of all links above it.
std::vector<std::uint32_t> chainUp( const lw_robot* robot, std::uint32_t link )
{
	std::vector<std::uint32_t> chain = { link };
	while ( lw_robot_link_joint( robot, chain.back() ) != LW_INVALID_INDEX )
	{
		chain.push_back( lw_robot_joint_parent( robot, lw_robot_link_joint( robot, chain.back() ) ) );
	}
	return chain;
}

/// Directions and how far each node's hull goes along them.
struct Directions
{
	std::vector<lw_vec3> all;
	std::vector<std::vector<double>> reach; ///< [link][direction]; +inf where it is unbounded

	Directions( SeededRng& rng, const lw_reach* of, int count )
	{
		for ( int i = 0; i < count; ++i )
		{
			all.push_back( direction( rng ) );
		}
		for ( std::uint32_t link = 0; link < lw_robot_link_count( lw_reach_robot( of ) ); ++link )
		{
			lw_reach_node node = lw_reach_get_node( of, link );
			reach.emplace_back();
			for ( lw_vec3 n : all )
			{
				double most = support( lw_reach_hull_points( of, link ), node.hull_point_count, n );
				reach.back().push_back( std::isinf( node.m.radius ) ? inf : most + node.dilation );
			}
		}
	}
};

/// Points of a link's bodies in its frame.
std::vector<lw_vec3> linkPoints( const RobotModel& model, std::uint32_t link )
{
	std::vector<lw_vec3> points;
	for ( std::size_t b = 0; b < model.bodies.size(); ++b )
	{
		for ( lw_vec3 p : model.bodyPoints[b] )
		{
			if ( model.bodies[b].link == link )
			{
				points.push_back( apply( model.bodies[b].link_from_shape, p ) );
			}
		}
	}
	return points;
}

/// All points of all bodies at one state against the hulls and spheres of all nodes above them. @return bounded checks
int expectContained( SeededRng& rng, const RobotModel& model, const lw_reach* reach, const Directions& d, const State& q,
	const std::vector<std::vector<lw_vec3>>& points )
{
	const lw_robot* robot = lw_reach_robot( reach );
	std::vector<lw_transform> pose( model.linkNames.size() );
	EXPECT_EQ( lw_robot_fk( robot, q.data(), pose.data() ), LW_OK );
	int bounded = 0;
	for ( std::uint32_t link = 0; link < pose.size(); ++link )
	{
		for ( std::uint32_t node : chainUp( robot, link ) )
		{
			std::uint32_t joint = lw_robot_link_joint( robot, node );
			lw_transform parent = joint == LW_INVALID_INDEX ? lw_transform_identity()
															: pose[lw_robot_joint_parent( robot, joint )];
			lw_reach_node n = lw_reach_get_node( reach, node );
			std::size_t k = static_cast<std::size_t>( rng.integer( 0, static_cast<int>( d.all.size() ) - 1 ) );
			for ( lw_vec3 p : points[link] )
			{
				lw_vec3 world = apply( pose[link], p );
				lw_vec3 inParent = applyInverse( parent, world );
				EXPECT_LE( dot( d.all[k], inParent ), d.reach[node][k] + rounding ) << "node " << node << " link " << link;
				EXPECT_LE( distance( n.m.center, inParent ), n.m.radius + rounding ) << "node " << node << " link " << link;
				EXPECT_LE( distance( n.mr.center, applyInverse( pose[node], world ) ), n.mr.radius + rounding );
				if ( node == link )
				{
					EXPECT_LE( distance( n.r.center, p ), n.r.radius + rounding );
				}
			}
			bounded += std::isinf( n.m.radius ) ? 0 : 1;
		}
	}
	return bounded;
}

lw_transform at( double x, double y, double z )
{
	lw_transform m = lw_transform_identity();
	m.t[0] = x;
	m.t[1] = y;
	m.t[2] = z;
	return m;
}

lw_shape* primitive( lw_shape_type type, double x, double y, double z )
{
	double dimensions[3] = { x, y, z };
	lw_shape* shape = nullptr;
	EXPECT_EQ( lw_shape_create_primitive( type, dimensions, nullptr, nullptr, &shape ), LW_OK );
	return shape;
}

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
	auto expect = [&]( std::uint32_t variable, double low, double high ) {
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

/// A plate with a flat tip in the middle of the side towards +x: a point that is dropped where the error may be coarser than
/// its height.
/// @param turned how the mesh stands in its own frame, along whose axes the farthest vertices are never dropped
lw_shape* plateWithTip( double height, const lw_transform& turned, std::vector<lw_vec3>* points )
{
	double vertices[] = { 0, -0.2, -0.2, 0, 0.2, -0.2, 0, 0.2, 0.2, 0, -0.2, 0.2, height, 0, 0, -0.1, 0, 0 };
	static const std::uint32_t indices[] = { 0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4, 1, 0, 5, 2, 1, 5, 3, 2, 5, 0, 3, 5 };
	for ( std::size_t i = 0; i < 18; i += 3 )
	{
		points->push_back( apply( turned, { vertices[i], vertices[i + 1], vertices[i + 2] } ) );
		vertices[i] = points->back().x;
		vertices[i + 1] = points->back().y;
		vertices[i + 2] = points->back().z;
	}
	lw_mesh_def def = lw_mesh_def_default();
	def.vertices = vertices;
	def.vertex_count = 6;
	def.indices = indices;
	def.triangle_count = 8;
	lw_shape* shape = nullptr;
	EXPECT_EQ( lw_shape_create_mesh( &def, nullptr, nullptr, &shape ), LW_OK );
	return shape;
}

/// An arm that slides, and turns by a thousandth: its hulls have hardly any error of sampling, in which one of dropped
/// points could hide.
/// @param turned where the plate's tip looks: not along an axis, whose farthest points are never dropped
/// @param mesh how the plate stands in the frame of its mesh; where it is on the link does not depend on it
std::uint32_t slidingArm( RobotModel& model, const std::string& name, const lw_transform& base, const lw_transform& turned, double tip,
	const lw_transform& mesh = lw_transform_identity() )
{
	std::uint32_t link = 0;
	for ( int i = 0; i < 3; ++i )
	{
		const bool turns = i > 0;
		lw_joint_def& joint = model.joint( name + std::to_string( i ), turns ? LW_JOINT_REVOLUTE : LW_JOINT_PRISMATIC, link );
		joint.parent_from_joint = i == 0 ? base : lw_transform_identity();
		for ( int k = 0; k < 3; ++k )
		{
			joint.axis[k] = turned.r[k][2]; // along the plate, and about a line in it
		}
		joint.lower = turns ? -1e-4 : -0.3;
		joint.upper = turns ? 1e-4 : 0.4;
		link = static_cast<std::uint32_t>( model.linkNames.size() ) - 1;
	}
	std::vector<lw_vec3> points;
	lw_shape* shape = plateWithTip( tip, mesh, &points );
	const lw_transform back = lw_transform_inverse( &mesh );
	model.body( link, shape, lw_transform_multiply( &turned, &back ), points );
	return link;
}

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
			const lw_vec3 p = { radius * std::sin( z ) * std::cos( angle ), radius * std::sin( z ) * std::sin( angle ), radius * std::cos( z ) };
			points->push_back( p );
			vertices.insert( vertices.end(), { p.x, p.y, p.z } );
			const auto at = static_cast<std::uint32_t>( around * i + k ), next = static_cast<std::uint32_t>( around * i + ( k + 1 ) % around );
			if ( i < across )
			{
				indices.insert( indices.end(), { at, next, at + around } );
			}
		}
	}
	lw_mesh_def def = lw_mesh_def_default();
	def.vertices = vertices.data();
	def.vertex_count = static_cast<std::uint32_t>( points->size() );
	def.indices = indices.data();
	def.triangle_count = static_cast<std::uint32_t>( indices.size() / 3 );
	lw_shape* shape = nullptr;
	EXPECT_EQ( lw_shape_create_mesh( &def, nullptr, nullptr, &shape ), LW_OK );
	return shape;
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
					EXPECT_TRUE( node == 0 || distance( of.m.center, applyInverse( pose[node - 1], world ) ) <= of.m.radius + rounding );
					farthest[node] = std::max( farthest[node], far );
				}
			}
		}
		tight += farthest[0] > 0.99 * lw_reach_get_node( reach.get(), 0 ).mr.radius;
	}
	EXPECT_GE( dropped, 30 );
	EXPECT_GE( tight, 30 );
}

TEST( MotionSweeps, TipsThatWereDroppedFaceEachOther )
{
	SeededRng rng;
	int apart = 0, dropped = 0;
	for ( int i = 0; i < 60; ++i )
	{
		RobotModel model;
		model.link( "base" );
		const lw_transform turned = randomTransform( rng, 0 ), back = lw_transform_inverse( &turned );
		lw_transform facing = at( 0.3, 0, 0 ); // seen by the plate
		facing.r[0][0] = facing.r[1][1] = -1;
		facing = lw_transform_multiply( &facing, &back );
		facing = lw_transform_multiply( &turned, &facing );
		const double tip = rng.decade( -3.5, -1.5 );
		const std::uint32_t a = slidingArm( model, "l", lw_transform_identity(), turned, tip ),
							b = slidingArm( model, "r", facing, turned, tip );
		RobotPtr robot = model.create();
		ReachPtr reach = build( robot.get(), 0.15 );
		hull_probe_sweeps* made = nullptr;
		ASSERT_EQ( hull_probe_sweeps_create( reach.get(), &made ), LW_OK );
		const SweepsPtr sweeps( made );
		double separation = 0;
		ASSERT_EQ( hull_probe_separation( sweeps.get(), a, b, &separation ), LW_OK );
		EXPECT_LE( separation, 0.3 - 2 * tip + rounding ) << "tips of " << tip << " m face each other";
		apart += separation > 0;
		dropped += lw_reach_get_node( reach.get(), 1 ).dilation > 1e-5;
	}
	EXPECT_GE( apart, 30 );
	EXPECT_GE( dropped, 10 );
}

// ---- single links seen from an ancestor -------------------------------------------------------------------------------

TEST( MotionSweeps, NeverAboveTheDistanceOfAnyState )
{
	SeededRng rng;
	int apart = 0;
	for ( int i = 0; i < 25; ++i )
	{
		RandomRobotOptions options;
		options.floating = i % 3 == 2;
		options.size = 0.08;
		options.offset = 0.5;
		RobotModel model = randomRobot( rng, options );
		RobotPtr robot = model.create();
		ReachPtr reach = build( robot.get() );
		hull_probe_sweeps* made = nullptr;
		ASSERT_EQ( hull_probe_sweeps_create( reach.get(), &made ), LW_OK );
		SweepsPtr sweeps( made );
		std::uint32_t count = lw_robot_link_count( robot.get() );
		std::vector<double> separation( count * count, 0 );
		for ( std::uint32_t a = 0; a < count; ++a )
		{
			for ( std::uint32_t b = 0; b < count; ++b )
			{
				ASSERT_EQ( hull_probe_separation( sweeps.get(), a, b, &separation[a * count + b] ), LW_OK );
				apart += separation[a * count + b] > 0 ? 1 : 0;
			}
		}
		lw_query_def queryDef = lw_query_def_default();
		lw_query* query = nullptr;
		ASSERT_EQ( lw_query_create( &queryDef, nullptr, nullptr, nullptr, &query ), LW_OK );
		std::vector<lw_transform> pose( count );
		for ( int s = 0; s < 200; ++s )
		{
			State q = coveredState( rng, reach.get(), s % 2 == 0 );
			ASSERT_EQ( lw_robot_fk( robot.get(), q.data(), pose.data() ), LW_OK );
			for ( std::uint32_t b = 0; b < count * count; ++b )
			{
				std::uint32_t x = b / count, y = b % count;
				if ( separation[b] > 0 )
				{
					const lw_body_def &dx = model.bodies[x], &dy = model.bodies[y];
					lw_transform px = lw_transform_multiply( &pose[x], &dx.link_from_shape );
					lw_transform py = lw_transform_multiply( &pose[y], &dy.link_from_shape );
					lw_clearance c;
					ASSERT_EQ( lw_shape_distance( dx.shape, &px, dy.shape, &py, nullptr, query, &c ), LW_OK );
					EXPECT_LE( separation[b], c.upper + rounding ) << x << " " << y;
				}
			}
		}
		lw_query_destroy( query );
	}
	EXPECT_GT( apart, 30 );
}

/// The purpose of circumscribed sampling: no error across the planes in which fingers turn.
TEST( MotionSweeps, FingersInParallelPlanesStayApart )
{
	RobotModel model;
	model.link( "palm" );
	for ( std::uint32_t i = 0; i < 2; ++i )
	{
		lw_joint_def& joint = model.joint( i == 0 ? "index" : "middle", LW_JOINT_REVOLUTE, 0 );
		joint.parent_from_joint = at( 0, 0, 0.022 * i );
		joint.lower = 0;
		joint.upper = 1.7;
		model.body( i + 1, primitive( LW_SHAPE_BOX, 0.1, 0.02, 0.02 ), at( 0.05, 0, 0 ) );
	}
	RobotPtr robot = model.create();
	ReachPtr reach = build( robot.get() );
	hull_probe_sweeps* made = nullptr;
	ASSERT_EQ( hull_probe_sweeps_create( reach.get(), &made ), LW_OK );
	SweepsPtr sweeps( made );
	double separation = 0;
	ASSERT_EQ( hull_probe_separation( sweeps.get(), 1, 2, &separation ), LW_OK );
	EXPECT_LE( separation, 0.002 );
	EXPECT_GT( separation, 0.0018 );
}

// ---- points made few --------------------------------------------------------------------------------------------------

namespace
{

/// The kept points, dilated, hold all; they are a subset in order; the loss is about the requested one.
void expectReduced( SeededRng& rng, const std::vector<double>& points, double tolerance, std::size_t limit, double most )
{
	std::vector<double> kept = points;
	std::size_t count = points.size() / 3;
	double outside = -1;
	ASSERT_EQ( hull_probe_reduce( kept.data(), &count, tolerance, limit, nullptr, &outside ), LW_OK );
	ASSERT_GE( count, 1u );
	EXPECT_LE( count, std::max<std::size_t>( limit, 4 ) );
	EXPECT_GE( outside, 0 );
	EXPECT_LE( outside, most );
	std::size_t from = 0;
	for ( std::size_t i = 0; i < count; ++i, ++from )
	{
		while ( from < points.size() / 3 && !std::equal( &kept[3 * i], &kept[3 * i] + 3, &points[3 * from] ) )
		{
			++from;
		}
		ASSERT_LT( from, points.size() / 3 ) << "not a subset";
	}
	for ( int k = 0; k < 2000; ++k )
	{
		lw_vec3 n = direction( rng );
		EXPECT_LE( support( points.data(), points.size() / 3, n ), support( kept.data(), count, n ) + outside + 1e-15 );
	}
}

} // namespace

TEST( ReducePoints, EllipsoidsOfAllProportions )
{
	SeededRng rng;
	for ( double flat : { 1.0, 0.1, 1e-3, 1e-6, 0.0 } )
	{
		for ( double thin : { 1.0, 1e-2, 1e-4 } )
		{
			std::vector<double> points;
			for ( int i = 0; i < 3000; ++i )
			{
				lw_vec3 p = direction( rng );
				points.insert( points.end(), { 0.3 + p.x, 0.1 + thin * p.y, 2 + flat * p.z } );
			}
			// a plate thinner than the tolerance must keep its rim
			expectReduced( rng, points, 0.01, 600, 0.03 );
			expectReduced( rng, points, 0, 100, 0.2 );
		}
	}
}

TEST( ReducePoints, DegenerateSets )
{
	SeededRng rng;
	std::vector<double> one, same, line, square, cube;
	for ( int i = 0; i < 900; ++i )
	{
		double t = rng.uniform( 0, 1 );
		one = { 1, 2, 3 };
		same.insert( same.end(), { 1, 2, 3 } );
		line.insert( line.end(), { t, 2 * t, -t } );
		square.insert( square.end(), { t, rng.uniform( 0, 1 ), 5 } );
		cube.insert( cube.end(), { double( rng.integer( 0, 1 ) ), double( rng.integer( 0, 1 ) ), double( rng.integer( 0, 1 ) ) } );
	}
	for ( const std::vector<double>* points : { &one, &same, &line, &square, &cube } )
	{
		expectReduced( rng, *points, 0, 200, 1e-2 );
		expectReduced( rng, *points, 1e-3, 200, 1e-2 );
	}
	std::size_t count = cube.size() / 3;
	double outside;
	ASSERT_EQ( hull_probe_reduce( cube.data(), &count, 0, 200, nullptr, &outside ), LW_OK );
	EXPECT_EQ( count, 8u );
	EXPECT_LT( outside, 1e-12 );
}

TEST( ReducePoints, EveryFailingAllocationIsReported )
{
	SeededRng rng;
	std::vector<double> points;
	for ( int i = 0; i < 3000; ++i )
	{
		points.push_back( rng.normal() );
	}
	for ( int allowed = 0;; ++allowed )
	{
		CountingAllocator counter;
		counter.left = allowed;
		lw_allocator allocator = counter.get();
		std::vector<double> copy = points;
		std::size_t count = copy.size() / 3;
		double outside;
		lw_status status = hull_probe_reduce( copy.data(), &count, 0.01, 300, &allocator, &outside );
		EXPECT_EQ( counter.live, 0 );
		if ( status == LW_OK )
		{
			EXPECT_GT( allowed, 4 );
			break;
		}
		EXPECT_EQ( status, LW_ERROR_OUT_OF_MEMORY );
		EXPECT_EQ( copy, points );
	}
}

// ---- bad input --------------------------------------------------------------------------------------------------------

TEST( ReachDef, BadInputIsNamed )
{
	RobotModel model;
	model.link( "base" );
	RobotPtr robot = model.create();
	lw_reach_def good = lw_reach_def_default();
	good.robot = robot.get();
	auto expect = [&]( const lw_reach_def* def, lw_status status, const char* text ) {
		lw_reach* reach = reinterpret_cast<lw_reach*>( &model );
		lw_diag diag = {};
		EXPECT_EQ( lw_reach_create( def, nullptr, &diag, &reach ), status ) << text;
		EXPECT_EQ( reach, nullptr );
		EXPECT_NE( std::string( diag.message ).find( text ), std::string::npos ) << diag.message;
		EXPECT_EQ( lw_reach_create( def, nullptr, nullptr, &reach ), status );
	};
	expect( nullptr, LW_ERROR_INVALID_ARGUMENT, "NULL" );
	lw_reach_def def = good;
	def.cookie ^= 1u;
	expect( &def, LW_ERROR_INVALID_DEF, "lw_reach_def_default" );
	def = {};
	expect( &def, LW_ERROR_INVALID_DEF, "lw_reach_def_default" );
	def = good;
	def.robot = nullptr;
	expect( &def, LW_ERROR_INVALID_ARGUMENT, "robot" );
	for ( double bad : { -1.0, double( NAN ), inf } )
	{
		def = good;
		def.hull_error = bad;
		expect( &def, LW_ERROR_INVALID_ARGUMENT, "hull_error" );
		def = good;
		def.limit_margin = bad;
		expect( &def, LW_ERROR_INVALID_ARGUMENT, "limit_margin" );
		def = good;
		def.seconds = bad;
		expect( &def, LW_ERROR_INVALID_ARGUMENT, "budget" );
	}
	EXPECT_EQ( lw_reach_create( &good, nullptr, nullptr, nullptr ), LW_ERROR_INVALID_ARGUMENT );
	EXPECT_EQ( lw_reach_retain( nullptr ), nullptr );
	lw_reach_release( nullptr );
}

TEST( ReachDef, HullsOfARobotWithoutGeometry )
{
	RobotModel model;
	model.link( "base" );
	model.joint( "a", LW_JOINT_REVOLUTE, 0 );
	RobotPtr robot = model.create();
	ReachPtr reach = build( robot.get() );
	EXPECT_LT( lw_reach_get_node( reach.get(), 0 ).mr.radius, 0 );
}

TEST( ReachDef, HullsOnlyProvesNothingAboutPairs )
{
	SeededRng rng;
	for ( int i = 0; i < 5; ++i )
	{
		RobotModel model = randomRobot( rng, {} );
		RobotPtr robot = model.create();
		lw_reach_def def = lw_reach_def_default();
		def.robot = robot.get();
		def.hull_error = 0.3;
		def.seconds = 0;
		def.samples = 50;
		lw_reach *reach = nullptr, *hulls = nullptr;
		ASSERT_EQ( lw_reach_create( &def, nullptr, nullptr, &reach ), LW_OK );
		def.hulls_only = true;
		ASSERT_EQ( lw_reach_create( &def, nullptr, nullptr, &hulls ), LW_OK );
		ReachPtr whole( reach ), bare( hulls );
		for ( std::uint32_t a = 0; a < lw_robot_link_count( robot.get() ); ++a )
		{
			EXPECT_EQ( lw_reach_get_node( hulls, a ).m.radius, lw_reach_get_node( reach, a ).m.radius );
			for ( std::uint32_t b = 0; b < a; ++b )
			{
				lw_reach_pair pair = lw_reach_get_pair( hulls, a, b );
				lw_pair_class other = lw_reach_get_pair( reach, a, b ).kind;
				bool judged = other == LW_PAIR_NEVER || other == LW_PAIR_ALWAYS || other == LW_PAIR_CHECK;
				EXPECT_EQ( pair.kind, judged ? LW_PAIR_CHECK : other );
				EXPECT_EQ( pair.separation, 0 );
				EXPECT_EQ( pair.closest, inf );
				State q( lw_robot_variable_count( robot.get() ) );
				EXPECT_FALSE( lw_reach_closest_state( hulls, a, b, q.data() ) );
			}
		}
		lw_blob_def blob = lw_blob_def_default();
		blob.reach = hulls;
		void* bytes = nullptr;
		std::size_t size = 0;
		ASSERT_EQ( lw_blob_write( &blob, nullptr, nullptr, &bytes, &size ), LW_OK );
		lw_reach* read = nullptr;
		lw_diag diag{};
		EXPECT_EQ( lw_blob_read_reach( bytes, size, blob.key, robot.get(), nullptr, &diag, &read ), LW_OK ) << diag.message;
		lw_reach_release( read );
		lw_blob_free( nullptr, bytes, size );
	}
}

TEST( ReachDef, OfLinksThatAreNotThereNothingIsProved )
{
	SeededRng rng;
	RandomRobotOptions options;
	options.joints = 3;
	RobotModel model = randomRobot( rng, options );
	RobotPtr robot = model.create();
	ReachPtr reach = build( robot.get() );
	const std::uint32_t count = lw_robot_link_count( robot.get() );
	for ( std::uint32_t a = 0; a < count + 2; ++a )
	{
		for ( std::uint32_t b : { count, count + 1, LW_INVALID_INDEX } )
		{
			for ( auto [x, y] : { std::pair( a, b ), std::pair( b, a ) } )
			{
				EXPECT_EQ( lw_reach_get_pair( reach.get(), x, y ).kind, LW_PAIR_CHECK );
				EXPECT_EQ( lw_reach_get_pair( reach.get(), x, y ).separation, 0 );
				EXPECT_EQ( lw_reach_base( reach.get(), x, y ), 0 );
				EXPECT_EQ( lw_reach_rigid( reach.get(), x, y ), 0 );
				EXPECT_EQ( lw_reach_motion( reach.get(), x, y ), 0 );
				State q( lw_robot_variable_count( robot.get() ) );
				EXPECT_FALSE( lw_reach_closest_state( reach.get(), x, y, q.data() ) );
			}
			EXPECT_EQ( lw_reach_scfree( reach.get(), b ), 0 );
		}
	}
}

TEST( ReachDef, GivingUpDuringHullsIsReported )
{
	SeededRng rng;
	RobotModel model = randomRobot( rng, {} );
	RobotPtr robot = model.create();
	struct Calls
	{
		int left;
		double last = 0;
	};
	for ( int allowed = 0; allowed < 6; ++allowed )
	{
		Calls calls = { allowed };
		lw_reach_def def = lw_reach_def_default();
		def.robot = robot.get();
		def.progress_user = &calls;
		def.progress = []( void* user, const char* stage, double share ) {
			Calls* c = static_cast<Calls*>( user );
			EXPECT_STREQ( stage, "hulls" );
			EXPECT_GE( share, c->last );
			c->last = share;
			return c->left-- > 0;
		};
		CountingAllocator counter;
		lw_allocator allocator = counter.get();
		lw_reach* reach = nullptr;
		EXPECT_EQ( hull_probe_create( &def, &allocator, nullptr, &reach ), LW_ERROR_CANCELLED );
		EXPECT_EQ( counter.live, 0 );
	}
}

TEST( ReachDef, EveryFailingAllocationOfTheHullsIsReported )
{
	SeededRng rng;
	RandomRobotOptions options;
	options.joints = 3;
	RobotModel model = randomRobot( rng, options );
	RobotPtr robot = model.create();
	lw_reach_def def = lw_reach_def_default();
	def.robot = robot.get();
	def.hull_error = 0.2;
	for ( int allowed = 0;; ++allowed )
	{
		CountingAllocator counter;
		counter.left = allowed;
		lw_allocator allocator = counter.get();
		lw_reach* reach = nullptr;
		lw_status status = hull_probe_create( &def, &allocator, nullptr, &reach );
		if ( status == LW_OK )
		{
			EXPECT_GT( allowed, 20 );
			lw_reach_release( reach );
			EXPECT_EQ( counter.live, 0 );
			break;
		}
		ASSERT_EQ( status, LW_ERROR_OUT_OF_MEMORY ) << allowed;
		ASSERT_EQ( counter.live, 0 ) << allowed;
	}
}
