// SPDX-License-Identifier: BSD-3-Clause
// Coal (hpp-fcl's successor) as a peer: a module of its own, because Coal's packages bring other versions of assimp, octomap
// and boost than the rest of a program has.
//
// OBBRSS, its fastest volume for both questions; no contacts, no nearest points, no penetration depth; a margin by
// security_margin, its own and fastest way. Its managers are given the least distance by the caller: the library's own
// callback takes a result's min_distance for the least one, which shape pairs overwrite.
#include "peers/peer_engine.hpp"

#include <algorithm>
#include <coal/BV/OBBRSS.h>
#include <coal/BVH/BVH_model.h>
#include <coal/broadphase/broadphase_dynamic_AABB_tree.h>
#include <coal/collision.h>
#include <coal/config.hh>
#include <coal/distance.h>
#include <coal/shape/convex.h>
#include <coal/shape/geometric_shapes.h>
#include <ctime>
#include <map>
#include <stdexcept>
#include <vector>

namespace
{

using Model = coal::BVHModel<coal::OBBRSS>;
using Models = std::map<const void*, std::shared_ptr<coal::CollisionGeometry>>;

/// The two bodies' numbers, the moving one first: managers may swap them.
std::pair<std::uint32_t, std::uint32_t> numbersOf( const coal::CollisionObject* a, const coal::CollisionObject* b )
{
	const auto *x = static_cast<const std::uint32_t*>( a->getUserData() ),
	           *y = static_cast<const std::uint32_t*>( b->getUserData() );
	return x < y ? std::make_pair( *x, *y ) : std::make_pair( *y, *x );
}

struct OverlapCallback : coal::CollisionCallBackBase
{
	explicit OverlapCallback( const std::function<bool( std::uint32_t, std::uint32_t )>& test ) : m_test( test ) {}
	bool collide( coal::CollisionObject* a, coal::CollisionObject* b ) override
	{
		const auto [moving, fixed] = numbersOf( a, b );
		return m_test( moving, fixed );
	}
	const std::function<bool( std::uint32_t, std::uint32_t )>& m_test;
};

struct NearCallback : coal::DistanceCallBackBase
{
	explicit NearCallback( const std::function<double( std::uint32_t, std::uint32_t )>& test ) : m_test( test ) {}
	bool distance( coal::CollisionObject* a, coal::CollisionObject* b, coal::CoalScalar& least ) override
	{
		const auto [moving, fixed] = numbersOf( a, b );
		least = m_test( moving, fixed );
		return least <= 0;
	}
	const std::function<double( std::uint32_t, std::uint32_t )>& m_test;
};

double threadSeconds()
{
	timespec now;
	clock_gettime( CLOCK_THREAD_CPUTIME_ID, &now );
	return static_cast<double>( now.tv_sec ) + 1e-9 * static_cast<double>( now.tv_nsec );
}

class CoalEngine : public PeerEngine
{
public:
	explicit CoalEngine( std::shared_ptr<Models> models ) : m_models( std::move( models ) )
	{
		m_distance.enable_signed_distance = false;
		m_signed.enable_signed_distance = true;
		m_signed.gjk_max_iterations = m_signed.epa_max_iterations = 512;
		m_collision.enable_contact = false;
		m_collision.num_max_contacts = 1;
		m_margin = m_collision;
	}

	std::string name() const override { return "Coal"; }
	std::string description() const override { return "Coal " COAL_VERSION ", BVHModel<OBBRSS>, as packaged"; }

	std::size_t add( const void* key, const PeerGeometry& geometry ) override
	{
		std::shared_ptr<coal::CollisionGeometry>& entry = ( *m_models )[key];
		if ( !entry )
		{
			entry = make( geometry );
			entry->computeLocalAABB();
		}
		m_bodies.push_back( { entry, coal::Transform3s() } );
		return m_bodies.size() - 1;
	}

	void place( std::size_t body, const lw_transform& world_from_shape ) override
	{
		coal::Matrix3s rotation;
		for ( int i = 0; i < 3; ++i )
		{
			for ( int j = 0; j < 3; ++j )
			{
				rotation( i, j ) = world_from_shape.r[i][j];
			}
		}
		m_bodies[body].pose = coal::Transform3s(
		    rotation, coal::Vec3s( world_from_shape.t[0], world_from_shape.t[1], world_from_shape.t[2] ) );
	}

	double distance( std::size_t a, std::size_t b, double bound, double relative_error ) override
	{
		m_distance.rel_err = relative_error;
		m_distance.abs_err = relative_error > 0 ? 1e30 : 0; // as in FCL: the relative one does nothing without
		coal::DistanceResult result( bound );
		coal::distance(
		    m_bodies[a].geometry.get(), m_bodies[a].pose, m_bodies[b].geometry.get(), m_bodies[b].pose, m_distance, result );
		return std::min( bound, std::max( 0.0, result.min_distance ) );
	}

	bool collides( std::size_t a, std::size_t b ) override { return meets( a, b, m_collision ); }

	bool within( std::size_t a, std::size_t b, double margin ) override
	{
		m_margin.security_margin = margin;
		return meets( a, b, m_margin );
	}

	double signedDistance( std::size_t a, std::size_t b, double tolerance ) override
	{
		m_signed.gjk_tolerance = m_signed.epa_tolerance = tolerance;
		coal::DistanceResult result;
		return coal::distance(
		    m_bodies[a].geometry.get(), m_bodies[a].pose, m_bodies[b].geometry.get(), m_bodies[b].pose, m_signed, result );
	}

	bool hasManagers() const override { return true; }
	void manage( const std::vector<std::uint32_t>& moving, const std::vector<std::uint32_t>& fixed ) override
	{
		m_managed = std::make_unique<Managers>();
		m_managed->numbers = moving;
		m_managed->numbers.insert( m_managed->numbers.end(), fixed.begin(), fixed.end() );
		m_managed->moving_count = moving.size();
		for ( std::size_t i = 0; i < m_managed->numbers.size(); ++i )
		{
			const Body& body = m_bodies[m_managed->numbers[i]];
			m_managed->objects.push_back( std::make_unique<coal::CollisionObject>( body.geometry, body.pose, false ) );
			m_managed->objects.back()->setUserData( &m_managed->numbers[i] );
			( i < moving.size() ? m_managed->moving : m_managed->fixed ).registerObject( m_managed->objects.back().get() );
		}
		m_managed->moving.setup();
		m_managed->fixed.setup();
	}
	void refresh() override
	{
		for ( std::size_t i = 0; i < m_managed->moving_count; ++i )
		{
			m_managed->objects[i]->setTransform( m_bodies[m_managed->numbers[i]].pose );
			m_managed->objects[i]->computeAABB();
		}
		m_managed->moving.update();
	}
	void overlappingPairs( const std::function<bool( std::uint32_t, std::uint32_t )>& test ) override
	{
		OverlapCallback callback( test );
		m_managed->moving.collide( &m_managed->fixed, &callback );
	}
	void nearPairs( const std::function<double( std::uint32_t, std::uint32_t )>& test ) override
	{
		NearCallback callback( test );
		m_managed->moving.distance( &m_managed->fixed, &callback );
	}

	std::unique_ptr<PeerEngine> another() const override { return std::make_unique<CoalEngine>( m_models ); }
	double buildSeconds() const override { return m_build_seconds; }
	std::size_t bytes() const override { return m_bytes; }

private:
	struct Body
	{
		std::shared_ptr<coal::CollisionGeometry> geometry;
		coal::Transform3s pose;
	};

	struct Managers
	{
		std::vector<std::uint32_t> numbers; ///< objects' user data point here
		std::vector<std::unique_ptr<coal::CollisionObject>> objects;
		std::size_t moving_count = 0;
		coal::DynamicAABBTreeCollisionManager moving, fixed;
	};

	bool meets( std::size_t a, std::size_t b, const coal::CollisionRequest& request ) const
	{
		coal::CollisionResult result;
		return coal::collide( m_bodies[a].geometry.get(), m_bodies[a].pose, m_bodies[b].geometry.get(), m_bodies[b].pose,
		           request, result ) > 0;
	}

	std::shared_ptr<coal::CollisionGeometry> make( const PeerGeometry& geometry )
	{
		const double* d = geometry.dimensions;
		switch ( geometry.type )
		{
		case LW_SHAPE_MESH:
			return makeMesh( geometry );
		case LW_SHAPE_BOX:
			return std::make_shared<coal::Box>( d[0], d[1], d[2] );
		case LW_SHAPE_SPHERE:
			return std::make_shared<coal::Sphere>( d[0] );
		case LW_SHAPE_CYLINDER:
			return std::make_shared<coal::Cylinder>( d[0], d[1] );
		case LW_SHAPE_CAPSULE:
			return std::make_shared<coal::Capsule>( d[0], d[1] );
		case LW_SHAPE_CONE:
			return std::make_shared<coal::Cone>( d[0], d[1] );
		default:
			throw std::runtime_error( "Coal has no shape like one of this model's (sets of points, spheres or boxes)" );
		}
	}

	std::shared_ptr<coal::CollisionGeometry> makeMesh( const PeerGeometry& geometry )
	{
		std::vector<coal::Vec3s> vertices;
		std::vector<coal::Triangle> triangles;
		for ( std::uint32_t i = 0; i < geometry.vertex_count; ++i )
		{
			const double* v = geometry.vertices + 3 * std::size_t{ i };
			vertices.emplace_back( v[0], v[1], v[2] );
		}
		for ( std::uint32_t i = 0; i < geometry.triangle_count; ++i )
		{
			const std::uint32_t* t = geometry.triangles + 3 * std::size_t{ i };
			triangles.emplace_back( t[0], t[1], t[2] );
		}
		if ( geometry.convex )
		{
			const auto points = std::make_shared<std::vector<coal::Vec3s>>( vertices );
			const auto polygons = std::make_shared<std::vector<coal::Triangle>>( triangles );
			return std::make_shared<coal::Convex<coal::Triangle>>(
			    points, geometry.vertex_count, polygons, geometry.triangle_count );
		}
		const double start = threadSeconds();
		const auto model = std::make_shared<Model>();
		model->beginModel( static_cast<unsigned>( triangles.size() ), static_cast<unsigned>( vertices.size() ) );
		model->addSubModel( vertices, triangles );
		model->endModel();
		m_build_seconds += threadSeconds() - start;
		m_bytes += sizeof( Model ) + static_cast<std::size_t>( model->getNumBVs() ) * sizeof( coal::BVNode<coal::OBBRSS> ) +
		           triangles.size() * sizeof( coal::Triangle ) + vertices.size() * sizeof( coal::Vec3s );
		return model;
	}

	std::shared_ptr<Models> m_models;
	std::vector<Body> m_bodies;
	coal::DistanceRequest m_distance{ false }, m_signed{ true };
	coal::CollisionRequest m_collision, m_margin;
	std::unique_ptr<Managers> m_managed;
	double m_build_seconds = 0;
	std::size_t m_bytes = 0;
};

} // namespace

PeerEngine* leeway_peer_engine()
{
	return new CoalEngine( std::make_shared<Models>() );
}
