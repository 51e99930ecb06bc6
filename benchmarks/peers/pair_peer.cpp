// SPDX-License-Identifier: BSD-3-Clause
// Another library used well: see pair_peer.hpp.
#include "peers/pair_peer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace
{

constexpr double INFINITE = std::numeric_limits<double>::infinity();

} // namespace

void PairPeer::addBody( const lw_shape* shape, const lw_transform& parent_from_shape )
{
	lw_diag diag{};
	leeway::require( lw_shape_complete( shape, &diag ), diag ); // a deferred mesh has no counts before
	const lw_shape_info info = lw_shape_get_info( shape );
	PeerGeometry geometry{ info.type, { info.dimensions[0], info.dimensions[1], info.dimensions[2] } };
	geometry.vertices = lw_shape_vertices( shape );
	geometry.vertex_count = info.vertex_count;
	geometry.triangles = lw_shape_triangles( shape );
	geometry.triangle_count = info.triangle_count;
	m_engine->add( shape, geometry );
	Body body;
	body.shape = shape;
	body.parent_from_shape = parent_from_shape;
	for ( int i = 0; i < 3; ++i )
	{
		body.box_center[i] = 0.5 * ( info.box_min[i] + info.box_max[i] );
		body.box_half[i] = 0.5 * ( info.box_max[i] - info.box_min[i] );
	}
	m_bodies.push_back( body );
}

void PairPeer::placeBody( std::uint32_t index, const lw_transform& world_from_parent )
{
	Body& body = m_bodies[index];
	const lw_transform& pose = body.world_from_shape = lw_transform_multiply( &world_from_parent, &body.parent_from_shape );
	m_engine->place( index, pose );
	for ( int i = 0; i < 3; ++i )
	{
		double center = pose.t[i], half = 0;
		for ( int j = 0; j < 3; ++j )
		{
			center += pose.r[i][j] * body.box_center[j];
			half += std::abs( pose.r[i][j] ) * body.box_half[j];
		}
		body.low[i] = center - half;
		body.high[i] = center + half;
	}
}

// A joint moves if it has a variable of the group, or mimics a joint that has; a link, if a joint above it moves.
void PairPeer::findMoving( std::vector<bool>& joint_moves, std::vector<bool>& link_moves ) const
{
	std::vector<bool> in_group( lw_robot_variable_count( m_robot ), false );
	for ( uint32_t i = 0; i < lw_checker_variable_count( m_checker ); ++i )
	{
		in_group[lw_checker_variable( m_checker, i )] = true;
	}
	joint_moves.assign( lw_robot_joint_count( m_robot ), false );
	for ( uint32_t j = 0; j < joint_moves.size(); ++j )
	{
		const uint32_t leader = lw_robot_joint_mimic( m_robot, j );
		const uint32_t variable = lw_robot_joint_variable( m_robot, leader != LW_INVALID_INDEX ? leader : j );
		joint_moves[j] = variable != LW_INVALID_INDEX && in_group[variable];
	}
	link_moves.assign( lw_robot_link_count( m_robot ), false );
	for ( uint32_t link = 0; link < link_moves.size(); ++link )
	{
		uint32_t joint = lw_robot_link_joint( m_robot, link );
		while ( joint != LW_INVALID_INDEX && !link_moves[link] )
		{
			link_moves[link] = joint_moves[joint];
			joint = lw_robot_link_joint( m_robot, lw_robot_joint_parent( m_robot, joint ) );
		}
	}
}

bool PairPeer::isAllowed( std::uint32_t body, std::uint32_t obstacle ) const
{
	return std::any_of( m_allowed.begin(), m_allowed.end(),
	    [&]( const lw_link_object_pair& p )
	    { return p.link == m_bodies[body].link && p.object == m_bodies[obstacle].object; } );
}

void PairPeer::addBodies()
{
	for ( std::uint32_t i = 0; i < lw_robot_body_count( m_robot ); ++i )
	{
		const lw_body_def def = lw_robot_body( m_robot, i );
		addBody( def.shape, def.link_from_shape );
		m_bodies.back().link = def.link;
	}
	m_robot_bodies = static_cast<std::uint32_t>( m_bodies.size() );
	const lw_scene* scene = lw_checker_scene( m_checker );
	const lw_transform identity = lw_transform_identity();
	for ( std::uint32_t i = 0; scene != nullptr && i < lw_scene_shape_count( scene ); ++i )
	{
		const lw_scene_shape_def def = lw_scene_shape( scene, i );
		addBody( def.shape, def.world_from_shape );
		m_bodies.back().object = def.object;
		placeBody( m_robot_bodies + i, identity );
	}
}

void PairPeer::findEnvironmentPairs( const std::vector<bool>& link_moves )
{
	for ( std::uint32_t i = 0; i < m_robot_bodies; ++i )
	{
		if ( link_moves[m_bodies[i].link] )
		{
			m_moving.push_back( i );
			for ( std::uint32_t k = m_robot_bodies; k < m_bodies.size(); ++k )
			{
				if ( !isAllowed( i, k ) )
				{
					m_environment_pairs.emplace_back( i, k );
				}
			}
		}
	}
	if ( lw_checker_scene( m_checker ) != nullptr &&
	     m_environment_pairs.size() != lw_checker_get_info( m_checker ).environment_pairs )
	{
		throw std::runtime_error( "a comparison would not be about the same pairs: other contacts are allowed" );
	}
}

void PairPeer::findSelfPairs( const std::vector<bool>& joint_moves )
{
	// The relative pose of two links can change if a joint that moves is above exactly one of them.
	std::vector<std::vector<bool>> above( lw_robot_link_count( m_robot ) );
	for ( uint32_t link = 0; link < above.size(); ++link )
	{
		above[link].assign( joint_moves.size(), false );
		for ( uint32_t joint = lw_robot_link_joint( m_robot, link ); joint != LW_INVALID_INDEX;
		      joint = lw_robot_link_joint( m_robot, lw_robot_joint_parent( m_robot, joint ) ) )
		{
			above[link][joint] = joint_moves[joint];
		}
	}
	for ( uint32_t a = 0; a < m_robot_bodies; ++a )
	{
		for ( uint32_t b = a + 1; b < m_robot_bodies; ++b )
		{
			const uint32_t la = m_bodies[a].link, lb = m_bodies[b].link;
			if ( above[la] != above[lb] && !lw_robot_pair_allowed( m_robot, la, lb ) )
			{
				m_self_pairs.emplace_back( a, b );
			}
		}
	}
}

void PairPeer::measureStatic( const std::vector<bool>& link_moves )
{
	std::vector<double> neutral( m_full.size() ), q;
	lw_robot_default_state( m_robot, neutral.data() );
	for ( std::uint32_t i = 0; i < lw_checker_variable_count( m_checker ); ++i )
	{
		q.push_back( neutral[lw_checker_variable( m_checker, i )] );
	}
	pose( q.data() );
	m_heap.clear();
	for ( std::uint32_t body = 0; body < m_robot_bodies; ++body )
	{
		placeBody( body, m_link_poses[m_bodies[body].link] );
		for ( std::uint32_t obstacle = m_robot_bodies; obstacle < m_bodies.size(); ++obstacle )
		{
			if ( !link_moves[m_bodies[body].link] && !isAllowed( body, obstacle ) )
			{
				m_static_pairs.emplace_back( body, obstacle );
				addCandidate( body, obstacle, INFINITE );
			}
		}
	}
	m_static_distance = nearest( INFINITE, 0 );
}

PairPeer::PairPeer( const lw_checker* checker, std::unique_ptr<PeerEngine> engine,
    const std::vector<lw_link_object_pair>& allowed, bool managers )
    : m_checker( checker ), m_robot( lw_checker_robot( checker ) ), m_engine( std::move( engine ) ), m_allowed( allowed )
{
	addBodies();
	m_full.resize( lw_robot_variable_count( m_robot ) );
	m_link_poses.resize( lw_robot_link_count( m_robot ) );
	m_heap.reserve( m_bodies.size() * m_robot_bodies );

	std::vector<bool> joint_moves, link_moves;
	findMoving( joint_moves, link_moves );
	findEnvironmentPairs( link_moves );
	findSelfPairs( joint_moves );
	measureStatic( link_moves );
	if ( managers && m_engine->hasManagers() )
	{
		std::vector<std::uint32_t> fixed;
		for ( std::uint32_t i = m_robot_bodies; i < m_bodies.size(); ++i )
		{
			fixed.push_back( i );
		}
		m_engine->manage( m_moving, fixed );
		m_managers = true;
	}
}

void PairPeer::pose( const double* q )
{
	lw_checker_full_state( m_checker, q, m_full.data() );
	if ( lw_robot_fk( m_robot, m_full.data(), m_link_poses.data() ) != LW_OK )
	{
		throw std::runtime_error( "a state of the comparison is not usable" );
	}
	for ( const std::uint32_t i : m_moving )
	{
		placeBody( i, m_link_poses[m_bodies[i].link] );
	}
	if ( m_managers )
	{
		m_engine->refresh();
	}
}

double PairPeer::largestShapeError() const
{
	double robot = 0, all = 0;
	for ( std::uint32_t i = 0; i < m_bodies.size(); ++i )
	{
		all = std::max( all, m_engine->shapeError( i ) );
		robot = i < m_robot_bodies ? all : robot;
	}
	return robot + all;
}

PlacedPair PairPeer::placedPair( std::uint32_t a, std::uint32_t b ) const
{
	return { m_bodies[a].shape, m_bodies[b].shape, m_bodies[a].world_from_shape, m_bodies[b].world_from_shape };
}

std::vector<PlacedPair> PairPeer::placedPairs( bool self ) const
{
	std::vector<PlacedPair> out;
	const auto add = [&]( const Pairs& pairs )
	{
		for ( const auto& [a, b] : pairs )
		{
			out.push_back( placedPair( a, b ) );
		}
	};
	add( self ? m_self_pairs : m_environment_pairs );
	if ( !self )
	{
		add( m_static_pairs );
	}
	return out;
}

void PairPeer::addCandidate( std::uint32_t a, std::uint32_t b, double bound )
{
	double squared = 0;
	for ( int i = 0; i < 3; ++i )
	{
		const double gap =
		    std::max( 0.0, std::max( m_bodies[a].low[i] - m_bodies[b].high[i], m_bodies[b].low[i] - m_bodies[a].high[i] ) );
		squared += gap * gap;
	}
	if ( squared < bound * bound )
	{
		m_heap.push_back( { squared, a, b } );
	}
}

double PairPeer::nearest( double bound, double relative_error )
{
	const auto later = []( const Candidate& x, const Candidate& y ) { return x.squared > y.squared; };
	std::make_heap( m_heap.begin(), m_heap.end(), later );
	double best = bound;
	while ( !m_heap.empty() && best > 0 && m_heap.front().squared < best * best )
	{
		const Candidate candidate = m_heap.front();
		std::pop_heap( m_heap.begin(), m_heap.end(), later );
		m_heap.pop_back();
		best = std::min( best, std::max( 0.0, m_engine->distance( candidate.a, candidate.b, best, relative_error ) ) );
	}
	return best;
}

double PairPeer::nearestOf( const Pairs& pairs, double bound, double relative_error )
{
	m_heap.clear();
	for ( const auto& [a, b] : pairs )
	{
		addCandidate( a, b, bound );
	}
	return nearest( bound, relative_error );
}

double PairPeer::environmentDistance( double bound, double relative_error )
{
	bound = std::min( bound, m_static_distance );
	return m_managers ? managedDistance( bound, relative_error ) : nearestOf( m_environment_pairs, bound, relative_error );
}

double PairPeer::managedDistance( double bound, double relative_error )
{
	double best = bound;
	if ( best > 0 )
	{
		m_engine->nearPairs(
		    [&]( std::uint32_t a, std::uint32_t b )
		    {
			    if ( !isAllowed( a, b ) )
			    {
				    best = std::min( best, std::max( 0.0, m_engine->distance( a, b, best, relative_error ) ) );
			    }
			    return best;
		    } );
	}
	return best;
}

bool PairPeer::managedCollides()
{
	bool found = false;
	m_engine->overlappingPairs( [&]( std::uint32_t a, std::uint32_t b )
	    { return found = found || ( !isAllowed( a, b ) && m_engine->collides( a, b ) ); } );
	return found;
}

std::vector<NearBodies> PairPeer::nearPairs( double bound )
{
	std::vector<NearBodies> out;
	const auto ask = [&]( std::uint32_t a, std::uint32_t b )
	{
		const double distance = m_engine->distance( a, b, bound, 0 );
		if ( distance < bound )
		{
			out.push_back( { a, b, std::max( 0.0, distance ) } );
		}
	};
	m_heap.clear();
	for ( const Pairs* pairs : { m_managers ? nullptr : &m_environment_pairs, &m_self_pairs } )
	{
		for ( std::size_t i = 0; pairs != nullptr && i < pairs->size(); ++i )
		{
			addCandidate( ( *pairs )[i].first, ( *pairs )[i].second, bound );
		}
	}
	for ( const Candidate& candidate : m_heap )
	{
		ask( candidate.a, candidate.b );
	}
	if ( m_managers )
	{
		m_engine->nearPairs(
		    [&]( std::uint32_t a, std::uint32_t b )
		    {
			    if ( !isAllowed( a, b ) )
			    {
				    ask( a, b );
			    }
			    return bound;
		    } );
	}
	return out;
}

double PairPeer::selfDistance( double bound, double relative_error )
{
	return nearestOf( m_self_pairs, bound, relative_error );
}

/// Pairs whose boxes are within the margin, in any order: the first that passes the test is the answer.
template <typename Test> bool PairPeer::anyOf( const Pairs& pairs, double margin, const Test& test ) const
{
	return std::any_of( pairs.begin(), pairs.end(),
	    [&]( const auto& pair )
	    {
		    const Body &a = m_bodies[pair.first], &b = m_bodies[pair.second];
		    for ( int i = 0; i < 3; ++i )
		    {
			    if ( a.low[i] - margin > b.high[i] || b.low[i] - margin > a.high[i] )
			    {
				    return false;
			    }
		    }
		    return test( pair.first, pair.second );
	    } );
}

bool PairPeer::environmentWithin( double margin )
{
	if ( m_managers ) // their tests for overlap know no margin
	{
		return environmentDistance( margin ) < margin;
	}
	return m_static_distance < margin ||
	       anyOf( m_environment_pairs, margin,
	           [&]( std::uint32_t a, std::uint32_t b ) { return m_engine->within( a, b, margin ); } );
}

bool PairPeer::selfWithin( double margin )
{
	return anyOf(
	    m_self_pairs, margin, [&]( std::uint32_t a, std::uint32_t b ) { return m_engine->within( a, b, margin ); } );
}

bool PairPeer::environmentCollides()
{
	if ( m_managers )
	{
		return m_static_distance <= 0 || managedCollides();
	}
	return m_static_distance <= 0 ||
	       anyOf( m_environment_pairs, 0, [&]( std::uint32_t a, std::uint32_t b ) { return m_engine->collides( a, b ); } );
}

bool PairPeer::selfCollides()
{
	return anyOf( m_self_pairs, 0, [&]( std::uint32_t a, std::uint32_t b ) { return m_engine->collides( a, b ); } );
}

bool PairPeer::isFreeAtStates( const std::vector<double>& from, const std::vector<double>& to, std::uint32_t states )
{
	const auto free = [&]( double t )
	{
		std::vector<double> q( from.size() );
		for ( std::size_t i = 0; i < q.size(); ++i )
		{
			q[i] = from[i] + t * ( to[i] - from[i] );
		}
		pose( q.data() );
		return !environmentCollides() && !selfCollides();
	};
	const std::uint32_t n = std::max( 1u, states - 1 );
	std::uint32_t stride = 1;
	bool all = free( 1 ) && free( 0 );
	while ( stride < n )
	{
		stride *= 2;
	}
	for ( stride /= 2; all && stride > 0; stride /= 2 )
	{
		for ( std::uint32_t i = stride; all && i < n; i += 2 * stride )
		{
			all = free( static_cast<double>( i ) / n );
		}
	}
	return all;
}
