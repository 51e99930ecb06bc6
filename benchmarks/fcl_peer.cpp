// SPDX-License-Identifier: BSD-3-Clause
// FCL used well: see fcl_peer.hpp.
#include "fcl_peer.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/cone.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>
#include <limits>
#include <stdexcept>
#include <utility>

namespace
{

constexpr double INFINITE = std::numeric_limits<double>::infinity();

fcl::Transform3d toFcl( const lw_transform& t )
{
	fcl::Transform3d out = fcl::Transform3d::Identity();
	for ( int i = 0; i < 3; ++i )
	{
		for ( int j = 0; j < 3; ++j )
		{
			out.linear()( i, j ) = t.r[i][j];
		}
		out.translation()[i] = t.t[i];
	}
	return out;
}

} // namespace

std::shared_ptr<fcl::CollisionGeometryd> FclPeer::modelOf( const lw_shape* shape )
{
	const std::lock_guard<std::mutex> lock( m_models->mutex );
	FclModels::Entry& entry = m_models->entries[shape];
	if ( !entry.geometry )
	{
		lw_diag diag{};
		leeway::require( lw_shape_complete( shape, &diag ), diag ); // a deferred mesh has no counts before
		const lw_shape_info info = lw_shape_get_info( shape );
		const double* d = info.dimensions;
		switch ( info.type )
		{
		case LW_SHAPE_MESH:
			entry.geometry = makeMesh( shape );
			break;
		case LW_SHAPE_BOX:
			entry.geometry = std::make_shared<fcl::Boxd>( d[0], d[1], d[2] );
			break;
		case LW_SHAPE_SPHERE:
			entry.geometry = std::make_shared<fcl::Sphered>( d[0] );
			break;
		case LW_SHAPE_CYLINDER:
			entry.geometry = std::make_shared<fcl::Cylinderd>( d[0], d[1] );
			break;
		case LW_SHAPE_CAPSULE:
			entry.geometry = std::make_shared<fcl::Capsuled>( d[0], d[1] );
			break;
		case LW_SHAPE_CONE:
			entry.geometry = std::make_shared<fcl::Coned>( d[0], d[1] );
			break;
		default:
			throw std::runtime_error( "FCL has no shape like one of this model's (sets of points, spheres or boxes, half-spaces)" );
		}
		entry.geometry->computeLocalAABB();
		entry.shape = leeway::Shape::adopt( lw_shape_retain( shape ) );
	}
	return entry.geometry;
}

std::shared_ptr<fcl::CollisionGeometryd> FclPeer::makeMesh( const lw_shape* shape )
{
	const lw_shape_info info = lw_shape_get_info( shape );
	const double* v = lw_shape_vertices( shape );
	const uint32_t* t = lw_shape_triangles( shape );
	std::vector<fcl::Vector3d> vertices;
	std::vector<fcl::Triangle> triangles;
	for ( uint32_t i = 0; i < info.vertex_count; ++i )
	{
		vertices.emplace_back( v[3 * i], v[3 * i + 1], v[3 * i + 2] );
	}
	for ( uint32_t i = 0; i < info.triangle_count; ++i )
	{
		triangles.emplace_back( t[3 * i], t[3 * i + 1], t[3 * i + 2] );
	}
	const auto start = std::chrono::steady_clock::now();
	const auto model = std::make_shared<Model>();
	model->beginModel( static_cast<int>( triangles.size() ), static_cast<int>( vertices.size() ) );
	model->addSubModel( vertices, triangles );
	model->endModel();
	m_build_seconds += std::chrono::duration<double>( std::chrono::steady_clock::now() - start ).count();
	m_bytes += sizeof( Model ) + static_cast<std::size_t>( model->getNumBVs() ) * sizeof( fcl::BVNode<fcl::OBBRSSd> ) +
		triangles.size() * sizeof( fcl::Triangle ) + vertices.size() * sizeof( fcl::Vector3d );
	return model;
}

FclPeer::Body FclPeer::makeBody( const lw_shape* shape, const lw_transform& parent_from_shape, uint32_t link )
{
	const lw_shape_info info = lw_shape_get_info( shape );
	Body body;
	body.model = modelOf( shape );
	body.parent_from_shape = parent_from_shape;
	body.link = link;
	for ( int i = 0; i < 3; ++i )
	{
		body.box_center[i] = 0.5 * ( info.box_min[i] + info.box_max[i] );
		body.box_half[i] = 0.5 * ( info.box_max[i] - info.box_min[i] );
	}
	return body;
}

void FclPeer::placeBody( Body& body, const lw_transform& world_from_parent )
{
	const lw_transform pose = lw_transform_multiply( &world_from_parent, &body.parent_from_shape );
	body.pose = toFcl( pose );
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
void FclPeer::findMoving( const lw_checker* checker, std::vector<bool>& joint_moves, std::vector<bool>& link_moves ) const
{
	std::vector<bool> in_group( lw_robot_variable_count( m_robot ), false );
	for ( uint32_t i = 0; i < lw_checker_variable_count( checker ); ++i )
	{
		in_group[lw_checker_variable( checker, i )] = true;
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

FclPeer::FclPeer( const lw_checker* checker, std::shared_ptr<FclModels> models,
	const std::vector<lw_link_object_pair>& allowed )
	: m_checker( checker ), m_robot( lw_checker_robot( checker ) ),
	  m_models( models ? std::move( models ) : std::make_shared<FclModels>() )
{
	const auto isAllowed = [&allowed]( uint32_t link, uint32_t object ) {
		return std::any_of( allowed.begin(), allowed.end(),
			[=]( const lw_link_object_pair& p ) { return p.link == link && p.object == object; } );
	};
	for ( uint32_t i = 0; i < lw_robot_body_count( m_robot ); ++i )
	{
		const lw_body_def def = lw_robot_body( m_robot, i );
		m_bodies.push_back( makeBody( def.shape, def.link_from_shape, def.link ) );
	}
	const lw_scene* scene = lw_checker_scene( checker );
	const lw_transform identity = lw_transform_identity();
	for ( uint32_t i = 0; scene != nullptr && i < lw_scene_shape_count( scene ); ++i )
	{
		const lw_scene_shape_def def = lw_scene_shape( scene, i );
		m_obstacles.push_back( makeBody( def.shape, def.world_from_shape, LW_INVALID_INDEX ) );
		m_obstacles.back().object = def.object;
		placeBody( m_obstacles.back(), identity );
	}
	m_full.resize( lw_robot_variable_count( m_robot ) );
	m_link_poses.resize( lw_robot_link_count( m_robot ) );
	m_heap.reserve( m_bodies.size() * ( m_bodies.size() + m_obstacles.size() ) );

	std::vector<bool> joint_moves, link_moves;
	findMoving( checker, joint_moves, link_moves );
	for ( uint32_t i = 0; i < m_bodies.size(); ++i )
	{
		if ( link_moves[m_bodies[i].link] )
		{
			m_moving.push_back( i );
			for ( uint32_t k = 0; k < m_obstacles.size(); ++k )
			{
				if ( !isAllowed( m_bodies[i].link, m_obstacles[k].object ) )
				{
					m_environment_pairs.emplace_back( i, k );
				}
			}
		}
	}
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
	for ( uint32_t a = 0; a < m_bodies.size(); ++a )
	{
		for ( uint32_t b = a + 1; b < m_bodies.size(); ++b )
		{
			const uint32_t la = m_bodies[a].link, lb = m_bodies[b].link;
			if ( above[la] != above[lb] && !lw_robot_pair_allowed( m_robot, la, lb ) )
			{
				m_self_pairs.emplace_back( a, b );
			}
		}
	}

	// Bodies that never move: once, the others in their neutral state.
	std::vector<double> neutral( m_full.size() ), q;
	lw_robot_default_state( m_robot, neutral.data() );
	for ( uint32_t i = 0; i < lw_checker_variable_count( checker ); ++i )
	{
		q.push_back( neutral[lw_checker_variable( checker, i )] );
	}
	pose( q.data() );
	m_heap.clear();
	for ( Body& body : m_bodies )
	{
		placeBody( body, m_link_poses[body.link] );
		for ( const Body& obstacle : m_obstacles )
		{
			if ( !link_moves[body.link] && !isAllowed( body.link, obstacle.object ) )
			{
				addCandidate( body, obstacle, INFINITE );
			}
		}
	}
	m_static_distance = nearest( INFINITE, 0 );
}

void FclPeer::pose( const double* q )
{
	lw_checker_full_state( m_checker, q, m_full.data() );
	if ( lw_robot_fk( m_robot, m_full.data(), m_link_poses.data() ) != LW_OK )
	{
		throw std::runtime_error( "a state of the comparison is not usable" );
	}
	for ( uint32_t i : m_moving )
	{
		placeBody( m_bodies[i], m_link_poses[m_bodies[i].link] );
	}
}

std::vector<std::pair<std::shared_ptr<fcl::CollisionGeometryd>, fcl::Transform3d>> FclPeer::movingBodies() const
{
	std::vector<std::pair<std::shared_ptr<fcl::CollisionGeometryd>, fcl::Transform3d>> bodies;
	for ( const std::uint32_t i : m_moving )
	{
		bodies.emplace_back( m_bodies[i].model, m_bodies[i].pose );
	}
	return bodies;
}

void FclPeer::addCandidate( const Body& a, const Body& b, double bound )
{
	double squared = 0;
	for ( int i = 0; i < 3; ++i )
	{
		const double gap = std::max( 0.0, std::max( a.low[i] - b.high[i], b.low[i] - a.high[i] ) );
		squared += gap * gap;
	}
	if ( squared < bound * bound )
	{
		m_heap.push_back( { squared, &a, &b } );
	}
}

double FclPeer::nearest( double bound, double relative_error )
{
	const auto later = []( const Candidate& x, const Candidate& y ) { return x.squared > y.squared; };
	std::make_heap( m_heap.begin(), m_heap.end(), later );
	// FCL drops a pair of boxes if their distance is >= best - abs_err and * (1 + rel_err) is >= best: with no absolute
	// error allowed the relative one does nothing
	fcl::DistanceRequestd request( false, false, relative_error, relative_error > 0 ? 1e30 : 0.0 );
	fcl::DistanceResultd result;
	double best = bound;
	while ( !m_heap.empty() && best > 0 && m_heap.front().squared < best * best )
	{
		const Candidate candidate = m_heap.front();
		std::pop_heap( m_heap.begin(), m_heap.end(), later );
		m_heap.pop_back();
		result.clear();
		result.min_distance = best;
		fcl::distance( candidate.a->model.get(), candidate.a->pose, candidate.b->model.get(), candidate.b->pose, request,
			result );
		best = std::min( best, std::max( 0.0, result.min_distance ) );
	}
	return best;
}

double FclPeer::environmentDistance( double bound, double relative_error )
{
	bound = std::min( bound, m_static_distance );
	m_heap.clear();
	for ( const auto& [body, obstacle] : m_environment_pairs )
	{
		addCandidate( m_bodies[body], m_obstacles[obstacle], bound );
	}
	return nearest( bound, relative_error );
}

double FclPeer::selfDistance( double bound )
{
	m_heap.clear();
	for ( const auto& [a, b] : m_self_pairs )
	{
		addCandidate( m_bodies[a], m_bodies[b], bound );
	}
	return nearest( bound, 0 );
}

namespace
{

bool collides( const fcl::CollisionGeometryd* a, const fcl::Transform3d& pose_a, const fcl::CollisionGeometryd* b,
	const fcl::Transform3d& pose_b )
{
	static const fcl::CollisionRequestd request( 1, false );
	fcl::CollisionResultd result;
	return fcl::collide( a, pose_a, b, pose_b, request, result ) > 0;
}

template <typename Body>
bool boxesMeet( const Body& a, const Body& b )
{
	return a.low[0] <= b.high[0] && b.low[0] <= a.high[0] && a.low[1] <= b.high[1] && b.low[1] <= a.high[1] &&
		a.low[2] <= b.high[2] && b.low[2] <= a.high[2];
}

} // namespace

bool FclPeer::environmentCollides()
{
	for ( const auto& [body, obstacle] : m_environment_pairs )
	{
		const Body &a = m_bodies[body], &b = m_obstacles[obstacle];
		if ( boxesMeet( a, b ) && collides( a.model.get(), a.pose, b.model.get(), b.pose ) )
		{
			return true;
		}
	}
	return m_static_distance <= 0;
}

bool FclPeer::selfCollides()
{
	for ( const auto& [first, second] : m_self_pairs )
	{
		const Body &a = m_bodies[first], &b = m_bodies[second];
		if ( boxesMeet( a, b ) && collides( a.model.get(), a.pose, b.model.get(), b.pose ) )
		{
			return true;
		}
	}
	return false;
}
