// SPDX-License-Identifier: BSD-3-Clause
// A reach for tests, and the search that tries to prove it wrong: written anew, over the public interface only.
#pragma once

#include "checker_handles.hpp"
#include "leeway/distance.h"
#include "leeway/reach.h"
#include "seeded_rng.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <set>
#include <vector>

inline ReachPtr makeReach( const lw_robot* robot, double seconds, std::uint32_t samples = 200 )
{
	lw_reach_def def = lw_reach_def_default();
	def.robot = robot;
	def.seconds = seconds;
	def.samples = samples;
	lw_reach* reach = nullptr;
	lw_diag diag = {};
	EXPECT_EQ( lw_reach_create( &def, nullptr, &diag, &reach ), LW_OK ) << diag.message;
	return ReachPtr( reach );
}

/// Measures pairs of links and looks for states in which they are near.
class PairAttacker
{
public:
	PairAttacker( const lw_reach* reach, std::uint64_t seed )
	    : m_reach( reach ), m_robot( lw_reach_robot( reach ) ), m_rng( seed ), m_poses( lw_robot_link_count( m_robot ) )
	{
		lw_query_def def = lw_query_def_default();
		EXPECT_EQ( lw_query_create( &def, nullptr, nullptr, nullptr, &m_query ), LW_OK );
		for ( std::uint32_t v = 0; v < lw_robot_variable_count( m_robot ); ++v )
		{
			double low, high;
			lw_reach_variable_range( reach, v, &low, &high );
			bool angle = lw_robot_variable( m_robot, v ).wraps;
			m_low.push_back( std::isfinite( low ) ? low : angle ? -M_PI : std::isfinite( high ) ? high - 8 : -8 );
			m_high.push_back( std::isfinite( high ) ? high : angle ? M_PI : m_low.back() + 16 );
		}
	}
	PairAttacker( const PairAttacker& ) = delete;
	PairAttacker& operator=( const PairAttacker& ) = delete;
	~PairAttacker() { lw_query_destroy( m_query ); }

	/// Upper bound of the distance at q, exact to rounding if it is below `limit`.
	double distance( std::uint32_t a, std::uint32_t b, const std::vector<double>& q, double limit = INFINITY )
	{
		EXPECT_EQ( lw_robot_fk( m_robot, q.data(), m_poses.data() ), LW_OK );
		double least = limit;
		for ( std::uint32_t i = 0; i < lw_robot_body_count( m_robot ); ++i )
		{
			lw_body_def x = lw_robot_body( m_robot, i );
			for ( std::uint32_t j = 0; x.link == a && j < lw_robot_body_count( m_robot ) && least > 0; ++j )
			{
				lw_body_def y = lw_robot_body( m_robot, j );
				if ( y.link != b )
				{
					continue;
				}
				lw_transform poseX = lw_transform_multiply( &m_poses[a], &x.link_from_shape );
				lw_transform poseY = lw_transform_multiply( &m_poses[b], &y.link_from_shape );
				lw_range range = { 0, least, 0 };
				lw_clearance c;
				EXPECT_EQ( lw_shape_distance( x.shape, &poseX, y.shape, &poseY, &range, m_query, &c ), LW_OK );
				least = std::min( least, c.upper );
			}
		}
		return least;
	}

	std::vector<double> randomState()
	{
		std::vector<double> q( m_low.size() );
		for ( std::uint32_t v = 0; v < q.size(); ++v )
		{
			bool quaternion = lw_robot_joint_variable_count( m_robot, lw_robot_variable( m_robot, v ).joint ) == 7 &&
			                  lw_robot_variable( m_robot, v ).component >= 3;
			q[v] = quaternion ? m_rng.normal() : m_rng.uniform( m_low[v], m_high[v] );
			// corners of the joint box are where much happens
			if ( !quaternion && m_rng.integer( 0, 5 ) == 0 )
			{
				q[v] = m_rng.integer( 0, 1 ) ? m_low[v] : m_high[v];
			}
		}
		return q;
	}

	/// The least distance found by random states and random steps of shrinking width from the best of them.
	double attack( std::uint32_t a, std::uint32_t b, int states, int steps )
	{
		std::vector<double> best = randomState();
		double least = distance( a, b, best );
		for ( int i = 0; i < states && least > 0; ++i )
		{
			take( a, b, randomState(), best, least );
		}
		for ( int i = 0; i < steps && least > 0; ++i )
		{
			std::vector<double> q = best;
			double width = std::pow( 10.0, m_rng.uniform( -4, -0.3 ) );
			bool one = m_rng.integer( 0, 1 ) == 1;
			std::uint32_t only = static_cast<std::uint32_t>( m_rng.integer( 0, static_cast<int>( q.size() ) - 1 ) );
			for ( std::uint32_t v = 0; v < q.size(); ++v )
			{
				if ( !one || v == only )
				{
					double step = m_rng.normal() * width * ( m_high[v] - m_low[v] );
					q[v] = std::min( std::max( q[v] + step, m_low[v] ), m_high[v] );
				}
			}
			take( a, b, q, best, least );
		}
		return least;
	}

	/// The evidence: a state inside the limits at which the distance is `closest`.
	void checkEvidence( std::uint32_t a, std::uint32_t b )
	{
		lw_reach_pair pair = lw_reach_get_pair( m_reach, a, b );
		std::vector<double> q( m_low.size() );
		ASSERT_TRUE( lw_reach_closest_state( m_reach, a, b, q.data() ) ) << a << " " << b;
		for ( std::uint32_t v = 0; v < q.size(); ++v )
		{
			lw_variable_info info = lw_robot_variable( m_robot, v );
			EXPECT_TRUE( q[v] >= info.lower && q[v] <= info.upper ) << "variable " << v << " = " << q[v];
		}
		EXPECT_EQ( distance( a, b, q ), pair.closest ) << a << " " << b;
		EXPECT_LE( pair.separation, pair.closest );
	}

private:
	void take( std::uint32_t a, std::uint32_t b, const std::vector<double>& q, std::vector<double>& best, double& least )
	{
		double found = distance( a, b, q, least );
		if ( found < least )
		{
			least = found;
			best = q;
		}
	}

	const lw_reach* m_reach;
	const lw_robot* m_robot;
	SeededRng m_rng;
	std::vector<lw_transform> m_poses;
	lw_query* m_query = nullptr;
	std::vector<double> m_low, m_high;
};
