// SPDX-License-Identifier: BSD-3-Clause
// Clearance of states by every pair in turn: forward kinematics and distances of two shapes through the public interface. No
// clusters, spheres of links, masks, tables or memory of earlier states, which a checker has.
#pragma once

#include "checker_handles.hpp"

#include "leeway/distance.h"
#include "leeway/robot.h"
#include "leeway/scene.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>
#include <vector>

/// The oracle of one checker without margins and without allowed pairs of links and objects.
class AllPairs
{
public:
	explicit AllPairs( const lw_checker* checker )
	    : m_checker( checker ), m_robot( lw_checker_robot( checker ) ), m_query( makeQuery( checker, false ) ),
	      m_poses( lw_robot_link_count( m_robot ) ), m_full( lw_robot_variable_count( m_robot ) ), m_ways( m_poses.size() )
	{
		std::set<uint32_t> group;
		for ( uint32_t i = 0; i < lw_checker_variable_count( checker ); ++i )
		{
			group.insert( lw_checker_variable( checker, i ) );
		}
		for ( uint32_t link = 0; link < m_ways.size(); ++link )
		{
			for ( uint32_t at = link; lw_robot_link_joint( m_robot, at ) != LW_INVALID_INDEX; )
			{
				const uint32_t joint = lw_robot_link_joint( m_robot, at );
				if ( isMoved( joint, group ) )
				{
					m_ways[link].insert( joint );
				}
				at = lw_robot_joint_parent( m_robot, joint );
			}
		}
	}

	/// Exact clearances of a state.
	lw_state_result state( const std::vector<double>& q )
	{
		lw_checker_full_state( m_checker, q.data(), m_full.data() );
		EXPECT_EQ( LW_OK, lw_robot_fk( m_robot, m_full.data(), m_poses.data() ) );
		lw_state_result out = {};
		out.environment = environment();
		out.self = self();
		out.verdict = out.environment.upper <= 0 || out.self.upper <= 0 ? LW_VERDICT_BLOCKED : LW_VERDICT_FREE;
		return out;
	}

private:
	/// True if a variable of the group moves the joint, by mimicry too.
	bool isMoved( uint32_t joint, const std::set<uint32_t>& group ) const
	{
		const uint32_t followed = lw_robot_joint_mimic( m_robot, joint ),
		               moving = followed != LW_INVALID_INDEX ? followed : joint;
		return lw_robot_joint_variable_count( m_robot, moving ) > 0 &&
		       group.count( lw_robot_joint_variable( m_robot, moving ) ) > 0 &&
		       ( followed == LW_INVALID_INDEX || follows( joint, lw_robot_joint_variable( m_robot, moving ) ) );
	}

	/// False if a joint that mimics another one stands still: its multiplier is 0.
	bool follows( uint32_t joint, uint32_t variable ) const
	{
		std::vector<double> q( m_full.size() );
		lw_robot_default_state( m_robot, q.data() );
		const lw_transform before = parentFromChild( joint, q );
		q[variable] += 0.3;
		const lw_transform after = parentFromChild( joint, q );
		double moved = 0;
		for ( int i = 0; i < 3; ++i )
		{
			moved += std::fabs( after.t[i] - before.t[i] ) + std::fabs( after.r[i][0] - before.r[i][0] ) +
			         std::fabs( after.r[i][1] - before.r[i][1] );
		}
		return moved > 1e-9;
	}

	lw_transform parentFromChild( uint32_t joint, const std::vector<double>& q ) const
	{
		std::vector<lw_transform> poses( m_poses.size() );
		EXPECT_EQ( LW_OK, lw_robot_fk( m_robot, q.data(), poses.data() ) );
		const lw_transform parent_from_world = lw_transform_inverse( &poses[lw_robot_joint_parent( m_robot, joint )] );
		return lw_transform_multiply( &parent_from_world, &poses[lw_robot_joint_child( m_robot, joint )] );
	}

	lw_transform worldFromBody( const lw_body_def& body ) const
	{
		return lw_transform_multiply( &m_poses[body.link], &body.link_from_shape );
	}

	/// Lowers a clearance to the distance of two shapes, if that is less.
	void lower( const lw_body_def& a, const lw_shape* b, const lw_transform& world_from_b, lw_clearance& least )
	{
		const lw_transform world_from_a = worldFromBody( a );
		const lw_range exact = lw_range_exact();
		lw_clearance pair;
		ASSERT_EQ( LW_OK, lw_shape_distance( a.shape, &world_from_a, b, &world_from_b, &exact, m_query.get(), &pair ) );
		least.kind = LW_CLEARANCE_NEAR;
		least.lower = std::min( least.lower, pair.lower );
		least.upper = std::min( least.upper, pair.upper );
	}

	static lw_clearance nothing()
	{
		lw_clearance out = lw_clearance_unknown();
		out.kind = LW_CLEARANCE_FAR;
		out.lower = out.upper = std::numeric_limits<double>::infinity();
		return out;
	}

	lw_clearance environment()
	{
		lw_clearance least = nothing();
		const lw_scene* scene = lw_checker_scene( m_checker );
		for ( uint32_t i = 0; i < lw_robot_body_count( m_robot ); ++i )
		{
			for ( uint32_t k = 0; scene != nullptr && k < lw_scene_shape_count( scene ); ++k )
			{
				const lw_scene_shape_def other = lw_scene_shape( scene, k );
				lower( lw_robot_body( m_robot, i ), other.shape, other.world_from_shape, least );
			}
		}
		return least;
	}

	lw_clearance self()
	{
		lw_clearance least = nothing();
		for ( uint32_t i = 0; i < lw_robot_body_count( m_robot ); ++i )
		{
			for ( uint32_t k = i + 1; k < lw_robot_body_count( m_robot ); ++k )
			{
				const lw_body_def a = lw_robot_body( m_robot, i ), b = lw_robot_body( m_robot, k );
				if ( m_ways[a.link] != m_ways[b.link] && !lw_robot_pair_allowed( m_robot, a.link, b.link ) )
				{
					lower( a, b.shape, worldFromBody( b ), least );
				}
			}
		}
		return least;
	}

	const lw_checker* m_checker;
	const lw_robot* m_robot;
	QueryPtr m_query;
	std::vector<lw_transform> m_poses;
	std::vector<double> m_full;
	std::vector<std::set<uint32_t>> m_ways; ///< per link: the joints above it that the group moves
};

/// Metres: largest difference of two poses of a body by sums in different order, for robots of some metres and fifty joints.
/// Prismatic joints far out of their limits are within it.
constexpr double ALL_PAIRS_ROUNDING = 1e-10;

/// True if a clearance is so near to an end of the range that rounding decides the answer. Contact is 0 either way.
inline bool isDecidedByRounding( const lw_clearance& exact, const lw_range& range )
{
	const double d = exact.upper, r = ALL_PAIRS_ROUNDING;
	return d > 0 && ( std::abs( d - range.min_d ) <= r || std::abs( d - range.max_d ) <= r );
}

/// Expects the answer to a range that the exact clearance implies.
/// @param range alpha is 0
inline void expectImplied( const lw_clearance& exact, const lw_clearance& got, const lw_range& range, const char* which )
{
	const double d = exact.upper, r = ALL_PAIRS_ROUNDING;
	if ( isDecidedByRounding( exact, range ) )
	{
		return;
	}
	if ( d <= range.min_d )
	{
		EXPECT_EQ( LW_CLEARANCE_VIOLATION, got.kind ) << which << ' ' << d << ' ' << got.upper;
	}
	else if ( d >= range.max_d )
	{
		EXPECT_EQ( LW_CLEARANCE_FAR, got.kind ) << which << ' ' << d << ' ' << got.upper;
	}
	else
	{
		EXPECT_EQ( LW_CLEARANCE_NEAR, got.kind ) << which << ' ' << d << ' ' << got.upper;
		EXPECT_NEAR( d, got.upper, r ) << which;
		EXPECT_LE( got.lower, d + r ) << which;
	}
}
