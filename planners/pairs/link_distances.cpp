// SPDX-License-Identifier: BSD-3-Clause
// Distances of pairs of links: the least of their bodies' distances.
#include "leeway/pairs/link_distances.hpp"

#include <limits>
#include <utility>

namespace leeway::pairs
{

LinkDistances::LinkDistances( Robot robot ) : m_robot( std::move( robot ) ), m_query( makeQuery( nullptr ) )
{
	m_bodies.resize( lw_robot_link_count( m_robot.get() ) );
	m_poses.resize( m_bodies.size() );
	for ( std::uint32_t i = 0; i < lw_robot_body_count( m_robot.get() ); ++i )
	{
		const lw_body_def body = lw_robot_body( m_robot.get(), i );
		m_bodies[body.link].push_back( body );
	}
}

void LinkDistances::move( const std::vector<double>& q )
{
	require( lw_robot_fk( m_robot.get(), q.data(), m_poses.data() ), "lw_robot_fk" );
}

lw_clearance LinkDistances::measure( std::uint32_t link_a, std::uint32_t link_b, double max_d )
{
	lw_clearance nearest{};
	nearest.lower = nearest.upper = std::numeric_limits<double>::infinity();
	for ( const lw_body_def& a : m_bodies[link_a] )
	{
		const lw_transform pose_a = lw_transform_multiply( &m_poses[link_a], &a.link_from_shape );
		for ( const lw_body_def& b : m_bodies[link_b] )
		{
			const lw_transform pose_b = lw_transform_multiply( &m_poses[link_b], &b.link_from_shape );
			const lw_range range = { 0, max_d < nearest.upper ? max_d : nearest.upper, 0 };
			lw_clearance found;
			require( lw_shape_distance( a.shape, &pose_a, b.shape, &pose_b, &range, m_query.get(), &found ),
			    "lw_shape_distance" );
			nearest.lower = found.lower < nearest.lower ? found.lower : nearest.lower;
			nearest.upper = found.upper < nearest.upper ? found.upper : nearest.upper;
			if ( !( nearest.upper > 0 ) )
			{
				return nearest;
			}
		}
	}
	return nearest;
}

} // namespace leeway::pairs
