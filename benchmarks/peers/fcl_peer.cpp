// SPDX-License-Identifier: BSD-3-Clause
// FCL as a peer: see fcl_peer.hpp.
#include "peers/fcl_peer.hpp"

#include <algorithm>
#include <ctime>
#include <fcl/config.h>
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/cone.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/math/bv/OBBRSS.h>
#include <fcl/math/bv/RSS.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>
#include <stdexcept>

namespace
{

double threadSeconds()
{
	timespec now;
	clock_gettime( CLOCK_THREAD_CPUTIME_ID, &now );
	return static_cast<double>( now.tv_sec ) + 1e-9 * static_cast<double>( now.tv_nsec );
}

} // namespace

std::string FclEngine::description() const
{
	return std::string( "FCL " ) + FCL_VERSION +
	       ( m_volume == FclVolume::RSS ? ", BVHModel<RSS> (distances only), as packaged"
	                                    : ", BVHModel<OBBRSS>, as packaged" );
}

template <typename Volume> std::shared_ptr<fcl::CollisionGeometryd> FclEngine::makeMesh( const PeerGeometry& geometry )
{
	std::vector<fcl::Vector3d> vertices;
	std::vector<fcl::Triangle> triangles;
	for ( std::uint32_t i = 0; i < geometry.vertex_count; ++i )
	{
		vertices.emplace_back( geometry.vertices + 3 * std::size_t{ i } );
	}
	for ( std::uint32_t i = 0; i < geometry.triangle_count; ++i )
	{
		const std::uint32_t* t = geometry.triangles + 3 * std::size_t{ i };
		triangles.emplace_back( t[0], t[1], t[2] );
	}
	const double start = threadSeconds();
	using Model = fcl::BVHModel<Volume>;
	const auto model = std::make_shared<Model>();
	model->beginModel( static_cast<int>( triangles.size() ), static_cast<int>( vertices.size() ) );
	model->addSubModel( vertices, triangles );
	model->endModel();
	m_build_seconds += threadSeconds() - start;
	m_bytes += sizeof( Model ) + static_cast<std::size_t>( model->getNumBVs() ) * sizeof( fcl::BVNode<Volume> ) +
	           triangles.size() * sizeof( fcl::Triangle ) + vertices.size() * sizeof( fcl::Vector3d );
	return model;
}

std::shared_ptr<fcl::CollisionGeometryd> FclEngine::make( const PeerGeometry& geometry )
{
	const double* d = geometry.dimensions;
	switch ( geometry.type )
	{
	case LW_SHAPE_MESH:
		return m_volume == FclVolume::RSS ? makeMesh<fcl::RSSd>( geometry ) : makeMesh<fcl::OBBRSSd>( geometry );
	case LW_SHAPE_BOX:
		return std::make_shared<fcl::Boxd>( d[0], d[1], d[2] );
	case LW_SHAPE_SPHERE:
		return std::make_shared<fcl::Sphered>( d[0] );
	case LW_SHAPE_CYLINDER:
		return std::make_shared<fcl::Cylinderd>( d[0], d[1] );
	case LW_SHAPE_CAPSULE:
		return std::make_shared<fcl::Capsuled>( d[0], d[1] );
	case LW_SHAPE_CONE:
		return std::make_shared<fcl::Coned>( d[0], d[1] );
	default:
		throw std::runtime_error(
		    "FCL has no shape like one of this model's (sets of points, spheres or boxes, half-spaces)" );
	}
}

std::size_t FclEngine::add( const void* key, const PeerGeometry& geometry )
{
	const std::lock_guard<std::mutex> lock( m_models->mutex );
	std::shared_ptr<fcl::CollisionGeometryd>& entry = m_models->entries[key];
	if ( !entry )
	{
		entry = make( geometry );
		entry->computeLocalAABB();
	}
	m_bodies.push_back( { entry, fcl::Transform3d::Identity() } );
	return m_bodies.size() - 1;
}

void FclEngine::place( std::size_t body, const lw_transform& world_from_shape )
{
	fcl::Transform3d& pose = m_bodies[body].pose;
	for ( int i = 0; i < 3; ++i )
	{
		for ( int j = 0; j < 3; ++j )
		{
			pose.linear()( i, j ) = world_from_shape.r[i][j];
		}
		pose.translation()[i] = world_from_shape.t[i];
	}
}

// FCL drops a pair of boxes if their distance is >= best - abs_err and * (1 + rel_err) is >= best: with no absolute error
// allowed the relative one does nothing
double FclEngine::distance( std::size_t a, std::size_t b, double bound, double relative_error )
{
	const fcl::DistanceRequestd request( false, false, relative_error, relative_error > 0 ? 1e30 : 0.0 );
	fcl::DistanceResultd result;
	result.min_distance = bound;
	fcl::distance( m_bodies[a].model.get(), m_bodies[a].pose, m_bodies[b].model.get(), m_bodies[b].pose, request, result );
	return std::min( bound, std::max( 0.0, result.min_distance ) );
}

bool FclEngine::collides( std::size_t a, std::size_t b )
{
	static const fcl::CollisionRequestd request( 1, false );
	fcl::CollisionResultd result;
	return fcl::collide(
	           m_bodies[a].model.get(), m_bodies[a].pose, m_bodies[b].model.get(), m_bodies[b].pose, request, result ) > 0;
}

void FclEngine::manage( const std::vector<std::uint32_t>& moving, const std::vector<std::uint32_t>& fixed )
{
	m_managed = std::make_unique<Managers>();
	m_managed->numbers = moving;
	m_managed->numbers.insert( m_managed->numbers.end(), fixed.begin(), fixed.end() );
	m_managed->moving_count = moving.size();
	for ( std::size_t i = 0; i < m_managed->numbers.size(); ++i )
	{
		const Body& body = m_bodies[m_managed->numbers[i]];
		m_managed->objects.push_back( std::make_unique<fcl::CollisionObjectd>( body.model, body.pose ) );
		m_managed->objects.back()->setUserData( &m_managed->numbers[i] );
		( i < moving.size() ? m_managed->moving : m_managed->fixed ).registerObject( m_managed->objects.back().get() );
	}
	m_managed->moving.setup();
	m_managed->fixed.setup();
}

void FclEngine::refresh()
{
	for ( std::size_t i = 0; i < m_managed->moving_count; ++i )
	{
		m_managed->objects[i]->setTransform( m_bodies[m_managed->numbers[i]].pose );
		m_managed->objects[i]->computeAABB();
	}
	m_managed->moving.update();
}

namespace
{

/// The two bodies' numbers, the moving one first: managers may swap them.
std::pair<std::uint32_t, std::uint32_t> numbersOf( const fcl::CollisionObjectd* a, const fcl::CollisionObjectd* b )
{
	const auto *x = static_cast<const std::uint32_t*>( a->getUserData() ),
	           *y = static_cast<const std::uint32_t*>( b->getUserData() );
	return x < y ? std::make_pair( *x, *y ) : std::make_pair( *y, *x );
}

} // namespace

void FclEngine::overlappingPairs( const std::function<bool( std::uint32_t, std::uint32_t )>& test )
{
	m_managed->moving.collide( &m_managed->fixed, const_cast<void*>( static_cast<const void*>( &test ) ),
	    []( fcl::CollisionObjectd* a, fcl::CollisionObjectd* b, void* data )
	    {
		    const auto [moving, fixed] = numbersOf( a, b );
		    return ( *static_cast<const std::function<bool( std::uint32_t, std::uint32_t )>*>( data ) )( moving, fixed );
	    } );
}

void FclEngine::nearPairs( const std::function<double( std::uint32_t, std::uint32_t )>& test )
{
	m_managed->moving.distance( &m_managed->fixed, const_cast<void*>( static_cast<const void*>( &test ) ),
	    []( fcl::CollisionObjectd* a, fcl::CollisionObjectd* b, void* data, double& least )
	    {
		    const auto [moving, fixed] = numbersOf( a, b );
		    least = ( *static_cast<const std::function<double( std::uint32_t, std::uint32_t )>*>( data ) )( moving, fixed );
		    return least <= 0;
	    } );
}
