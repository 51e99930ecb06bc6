// SPDX-License-Identifier: BSD-3-Clause
// Reaches with hulls alone, states that they cover, and plates whose tips may be dropped from a hull.
#pragma once

#include "checker_handles.hpp"
#include "counting_allocator.hpp"
#include "hull_inside.hpp"
#include "leeway/leeway.h"
#include "random_robot.hpp"
#include "simple_shapes.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <numeric>

inline constexpr double inf = INFINITY;
inline constexpr double rounding = 1e-12; ///< of the forward kinematics that place the points, metres

inline ReachPtr build( const lw_robot* robot, double hullError = 0 )
{
	lw_reach_def def = lw_reach_def_default();
	def.robot = robot;
	def.hull_error = hullError;
	lw_reach* reach = nullptr;
	lw_diag diag = {};
	EXPECT_EQ( createHulls( &def, nullptr, &diag, &reach ), LW_OK ) << diag.message;
	return ReachPtr( reach );
}

inline lw_vec3 direction( SeededRng& rng )
{
	double x = rng.normal(), y = rng.normal(), z = rng.normal(), l = std::sqrt( x * x + y * y + z * z );
	return { x / l, y / l, z / l };
}

inline double dot( lw_vec3 a, lw_vec3 b )
{
	return a.x * b.x + a.y * b.y + a.z * b.z;
}

inline double support( const double* points, std::size_t count, lw_vec3 n )
{
	double most = -inf;
	for ( std::size_t i = 0; i < count; ++i )
	{
		most = std::max( most, n.x * points[3 * i] + n.y * points[3 * i + 1] + n.z * points[3 * i + 2] );
	}
	return most;
}

inline lw_vec3 apply( const lw_transform& m, lw_vec3 p )
{
	return { m.r[0][0] * p.x + m.r[0][1] * p.y + m.r[0][2] * p.z + m.t[0],
	    m.r[1][0] * p.x + m.r[1][1] * p.y + m.r[1][2] * p.z + m.t[1],
	    m.r[2][0] * p.x + m.r[2][1] * p.y + m.r[2][2] * p.z + m.t[2] };
}

inline lw_vec3 applyInverse( const lw_transform& m, lw_vec3 p )
{
	double d[3] = { p.x - m.t[0], p.y - m.t[1], p.z - m.t[2] };
	auto row = [&]( int k ) { return m.r[0][k] * d[0] + m.r[1][k] * d[1] + m.r[2][k] * d[2]; };
	return { row( 0 ), row( 1 ), row( 2 ) };
}

inline double distance( const double c[3], lw_vec3 p )
{
	return std::sqrt( ( p.x - c[0] ) * ( p.x - c[0] ) + ( p.y - c[1] ) * ( p.y - c[1] ) + ( p.z - c[2] ) * ( p.z - c[2] ) );
}

/// A state that the reach covers: inside the widened limits, or on them. Without limits: anything.
inline State coveredState( SeededRng& rng, const lw_reach* reach, bool corner )
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
inline std::vector<std::uint32_t> chainUp( const lw_robot* robot, std::uint32_t link )
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
inline std::vector<lw_vec3> linkPoints( const RobotModel& model, std::uint32_t link )
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
inline int expectContained( SeededRng& rng, const RobotModel& model, const lw_reach* reach, const Directions& d,
    const State& q, const std::vector<std::vector<lw_vec3>>& points )
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
			lw_transform parent =
			    joint == LW_INVALID_INDEX ? lw_transform_identity() : pose[lw_robot_joint_parent( robot, joint )];
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

/// A plate with a flat tip in the middle of the side towards +x: a point that is dropped where the error may be coarser than
/// its height.
/// @param turned how the mesh stands in its own frame, along whose axes the farthest vertices are never dropped
inline lw_shape* plateWithTip( double height, const lw_transform& turned, std::vector<lw_vec3>* points )
{
	std::vector<double> vertices = { 0, -0.2, -0.2, 0, 0.2, -0.2, 0, 0.2, 0.2, 0, -0.2, 0.2, height, 0, 0, -0.1, 0, 0 };
	static const std::vector<std::uint32_t> indices = {
	    0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4, 1, 0, 5, 2, 1, 5, 3, 2, 5, 0, 3, 5 };
	for ( std::size_t i = 0; i < 18; i += 3 )
	{
		points->push_back( apply( turned, { vertices[i], vertices[i + 1], vertices[i + 2] } ) );
		vertices[i] = points->back().x;
		vertices[i + 1] = points->back().y;
		vertices[i + 2] = points->back().z;
	}
	return meshOf( vertices, indices );
}

/// An arm that slides, and turns by a thousandth: its hulls have hardly any error of sampling, in which one of dropped
/// points could hide.
/// @param turned where the plate's tip looks: not along an axis, whose farthest points are never dropped
/// @param mesh how the plate stands in the frame of its mesh; where it is on the link does not depend on it
inline std::uint32_t slidingArm( RobotModel& model, const std::string& name, const lw_transform& base,
    const lw_transform& turned, double tip, const lw_transform& mesh = lw_transform_identity() )
{
	std::uint32_t link = 0;
	for ( int i = 0; i < 3; ++i )
	{
		const bool turns = i > 0;
		lw_joint_def& joint =
		    model.joint( name + std::to_string( i ), turns ? LW_JOINT_REVOLUTE : LW_JOINT_PRISMATIC, link );
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
