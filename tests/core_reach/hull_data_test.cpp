// SPDX-License-Identifier: BSD-3-Clause
// Motion hulls of the shared robots: no vertex leaves a hull or a sphere at random states and at corners of the joint box.
// The longer run of a million states is that of leeway-bench reach.
#include "hull_inside.hpp"
#include "leeway/io/model.hpp"
#include "seeded_rng.hpp"

#include <algorithm>
#include <gtest/gtest.h>

namespace
{

struct Plane
{
	double n[3], reach;
};

double dot( const double* a, const double* b )
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

Plane plane( SeededRng& rng )
{
	Plane p = { { rng.normal(), rng.normal(), rng.normal() }, -INFINITY };
	double length = std::sqrt( dot( p.n, p.n ) );
	for ( double& x : p.n )
	{
		x /= length;
	}
	return p;
}

/// Vertices of a link's meshes that are extreme along some directions, link frame. Primitives: points of their boxes' faces.
std::vector<lw_vec3> extremePoints( SeededRng& rng, const lw_robot* robot, std::uint32_t link )
{
	std::vector<lw_vec3> points;
	for ( std::uint32_t b = 0; b < lw_robot_body_count( robot ); ++b )
	{
		lw_body_def body = lw_robot_body( robot, b );
		lw_shape_info info = lw_shape_get_info( body.shape );
		if ( body.link != link )
		{
			continue;
		}
		if ( info.type != LW_SHAPE_MESH )
		{
			for ( int k = 0; k < 6; ++k ) // centres of the box's faces: points of all primitives of the shared robots
			{
				lw_vec3 p = { 0, 0, 0 };
				( &p.x )[k / 2] = k % 2 ? info.box_max[k / 2] : info.box_min[k / 2];
				points.push_back( lw_transform_point( &body.link_from_shape, p ) );
			}
			continue;
		}
		const double* v = lw_shape_vertices( body.shape );
		std::vector<std::uint32_t> extreme;
		for ( int k = 0; k < 60; ++k )
		{
			Plane p = plane( rng );
			std::uint32_t best = 0;
			for ( std::uint32_t i = 1; i < info.vertex_count; ++i )
			{
				best = dot( p.n, v + 3 * i ) > dot( p.n, v + 3 * best ) ? i : best;
			}
			extreme.push_back( best );
		}
		std::sort( extreme.begin(), extreme.end() );
		extreme.erase( std::unique( extreme.begin(), extreme.end() ), extreme.end() );
		for ( std::uint32_t i : extreme )
		{
			points.push_back( lw_transform_point( &body.link_from_shape, { v[3 * i], v[3 * i + 1], v[3 * i + 2] } ) );
		}
	}
	return points;
}

double away( const lw_sphere& s, lw_vec3 p )
{
	double d[3] = { p.x - s.center[0], p.y - s.center[1], p.z - s.center[2] };
	return std::sqrt( dot( d, d ) );
}

class MotionHullData : public testing::TestWithParam<const char*>
{
};

} // namespace

TEST_P( MotionHullData, NoVertexLeavesHullOrSphere )
{
	constexpr double rounding = 1e-12;
	constexpr int directions = 200, states = 10000;
	SeededRng rng;
	leeway::io::RobotModel model = leeway::io::loadRobot( std::string( LEEWAY_DATA_DIR ) + "/" + GetParam(), "" );
	leeway::Robot robot = leeway::io::buildRobot( model );
	lw_reach_def def = lw_reach_def_default();
	def.robot = robot.get();
	lw_reach* reach = nullptr;
	ASSERT_EQ( createHulls( &def, nullptr, nullptr, &reach ), LW_OK );
	std::uint32_t links = lw_robot_link_count( robot.get() );
	std::vector<std::vector<lw_vec3>> points;
	std::vector<std::vector<Plane>> planes( links );
	std::vector<lw_reach_node> nodes;
	std::vector<std::uint32_t> parent;
	for ( std::uint32_t link = 0; link < links; ++link )
	{
		points.push_back( extremePoints( rng, robot.get(), link ) );
		nodes.push_back( lw_reach_get_node( reach, link ) );
		const double* hull = lw_reach_hull_points( reach, link );
		std::uint32_t joint = lw_robot_link_joint( robot.get(), link );
		parent.push_back( joint == LW_INVALID_INDEX ? joint : lw_robot_joint_parent( robot.get(), joint ) );
		for ( int k = 0; k < directions; ++k )
		{
			planes[link].push_back( plane( rng ) );
			Plane& p = planes[link].back();
			for ( std::uint32_t i = 0; i < nodes[link].hull_point_count; ++i )
			{
				p.reach = std::max( p.reach, dot( p.n, hull + 3 * i ) + nodes[link].dilation );
			}
		}
	}
	std::vector<double> q( lw_robot_variable_count( robot.get() ) );
	std::vector<lw_transform> pose( links );
	for ( int s = 0; s < states && !HasFailure(); ++s )
	{
		for ( std::uint32_t i = 0; i < q.size(); ++i )
		{
			double low, high;
			lw_reach_variable_range( reach, i, &low, &high );
			bool limited = std::isfinite( low ) && std::isfinite( high );
			q[i] = limited && s % 4 == 0 ? ( rng.integer( 0, 1 ) ? low : high )
			                             : rng.uniform( std::max( low, -9.0 ), std::min( high, 9.0 ) );
		}
		ASSERT_EQ( lw_robot_fk( robot.get(), q.data(), pose.data() ), LW_OK );
		for ( std::uint32_t link = 0; link < links; ++link )
		{
			for ( std::uint32_t up = link; up != LW_INVALID_INDEX && !points[link].empty(); up = parent[up] )
			{
				lw_transform inverse = lw_transform_identity();
				if ( parent[up] != LW_INVALID_INDEX )
				{
					inverse = lw_transform_inverse( &pose[parent[up]] );
				}
				lw_transform m = lw_transform_multiply( &inverse, &pose[link] );
				const Plane& p = planes[up][static_cast<std::size_t>( rng.integer( 0, directions - 1 ) )];
				for ( lw_vec3 local : points[link] )
				{
					lw_vec3 x = lw_transform_point( &m, local );
					bool hull = dot( p.n, &x.x ) <= p.reach + rounding || std::isinf( nodes[up].m.radius );
					bool sphere = away( nodes[up].m, x ) <= nodes[up].m.radius + rounding;
					EXPECT_TRUE( hull && sphere ) << lw_robot_link_name( robot.get(), link ) << " leaves M of "
					                              << lw_robot_link_name( robot.get(), up );
				}
			}
		}
	}
	lw_reach_release( reach );
}

INSTANTIATE_TEST_SUITE_P(
    Robots, MotionHullData, testing::Values( "armar3/armar3.urdf", "mbm/fetch/fetch.urdf", "mbm/panda/panda.urdf" ) );
