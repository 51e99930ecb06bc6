// SPDX-License-Identifier: BSD-3-Clause
// PQP 1.3 as a peer: a module of its own, made where PQP's headers and library are found. It holds none of PQP's code.
//
// OBBs for contacts and rectangle swept spheres for distances, as it is configured. It has no bound to be given: a distance
// below one is asked for by PQP_Tolerance() first, which is cheap where there is none. It starts each distance from the two
// triangles that were nearest last time (per mesh, so instances share them). Without primitives of its own it gets
// triangles: boxes exactly, round ones by inscribed polyhedra.
#include "peers/peer_engine.hpp"

#include <PQP.h>
#include <algorithm>
#include <cmath>
#include <ctime>
#include <map>
#include <stdexcept>
#include <vector>

namespace
{

using Models = std::map<const void*, std::shared_ptr<PQP_Model>>;

double threadSeconds()
{
	timespec now;
	clock_gettime( CLOCK_THREAD_CPUTIME_ID, &now );
	return static_cast<double>( now.tv_sec ) + 1e-9 * static_cast<double>( now.tv_nsec );
}

struct Triangles
{
	std::vector<double> vertices;
	std::vector<std::uint32_t> corners;

	std::uint32_t add( double x, double y, double z )
	{
		vertices.insert( vertices.end(), { x, y, z } );
		return static_cast<std::uint32_t>( vertices.size() / 3 - 1 );
	}
};

Triangles box( const double* edges )
{
	Triangles out;
	for ( int corner = 0; corner < 8; ++corner )
	{
		const auto at = [&]( int axis ) { return ( ( corner >> axis ) & 1 ? 0.5 : -0.5 ) * edges[axis]; };
		out.add( at( 0 ), at( 1 ), at( 2 ) );
	}
	out.corners = {
	    0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5 };
	return out;
}

/// A solid of revolution about z from its outline, radius and height from the lower end to the upper; ends are closed.
Triangles turned( const std::vector<std::pair<double, double>>& outline, std::uint32_t columns )
{
	const auto is_point = [&]( std::size_t row ) { return outline[row].first <= 0; };
	Triangles out;
	for ( const auto& [radius, height] : outline )
	{
		for ( std::uint32_t column = 0; column < columns; ++column )
		{
			const double angle = 2 * M_PI * column / columns;
			out.add( radius * std::cos( angle ), radius * std::sin( angle ), height );
		}
	}
	const std::uint32_t low = out.add( 0, 0, outline.front().second ), high = out.add( 0, 0, outline.back().second );
	const auto add = [&out]( std::uint32_t a, std::uint32_t b, std::uint32_t c ) {
		out.corners.insert( out.corners.end(), { a, b, c } );
	};
	const std::uint32_t last = static_cast<std::uint32_t>( outline.size() - 1 );
	for ( std::uint32_t column = 0; column < columns; ++column )
	{
		const std::uint32_t next = ( column + 1 ) % columns;
		for ( std::uint32_t row = 0; row < last; ++row )
		{
			const std::uint32_t a = row * columns + column, b = row * columns + next;
			if ( !is_point( row ) )
			{
				add( a, b, a + columns );
			}
			if ( !is_point( row + 1 ) )
			{
				add( b, b + columns, a + columns );
			}
		}
		if ( !is_point( 0 ) )
		{
			add( low, next, column );
		}
		if ( !is_point( last ) )
		{
			add( high, last * columns + column, last * columns + next );
		}
	}
	return out;
}

/// Half a circle's arc from one end of the axis to the other, its middle at `height` there.
std::vector<std::pair<double, double>> arc( double radius, double low, double high, int parts )
{
	std::vector<std::pair<double, double>> outline;
	for ( int i = 1; i < parts; ++i )
	{
		const double angle = M_PI * i / parts;
		outline.emplace_back( radius * std::sin( angle ), ( 2 * i <= parts ? low : high ) - radius * std::cos( angle ) );
		if ( 2 * i == parts && low < high )
		{
			outline.emplace_back( radius, high );
		}
	}
	outline.insert( outline.begin(), { 0, low - radius } );
	outline.emplace_back( 0, high + radius );
	return outline;
}

Triangles trianglesOf( const PeerGeometry& geometry )
{
	const double* d = geometry.dimensions;
	switch ( geometry.type )
	{
	case LW_SHAPE_BOX:
		return box( d );
	case LW_SHAPE_SPHERE:
		return turned( arc( d[0], 0, 0, 10 ), 18 );
	case LW_SHAPE_CYLINDER:
		return turned( { { d[0], -0.5 * d[1] }, { d[0], 0.5 * d[1] } }, 32 );
	case LW_SHAPE_CAPSULE:
		return turned( arc( d[0], -0.5 * d[1], 0.5 * d[1], 10 ), 18 );
	case LW_SHAPE_CONE:
		return turned( { { d[0], -0.5 * d[1] }, { 0, 0.5 * d[1] } }, 32 );
	default:
		throw std::runtime_error( "PQP cannot have a shape like one of this model's (sets of points, spheres or boxes, "
		                          "half-spaces)" );
	}
}

/// How deep the polyhedron lies below the surface at most: at the middle of an edge between two meridians and parallels.
double errorOf( const PeerGeometry& geometry )
{
	const double radius = geometry.dimensions[0];
	switch ( geometry.type )
	{
	case LW_SHAPE_SPHERE:
	case LW_SHAPE_CAPSULE:
		return radius * ( 1 - std::cos( M_PI / 18 ) * std::cos( M_PI / 20 ) );
	case LW_SHAPE_CYLINDER:
	case LW_SHAPE_CONE:
		return radius * ( 1 - std::cos( M_PI / 32 ) );
	default:
		return 0;
	}
}

class PqpEngine : public PeerEngine
{
public:
	explicit PqpEngine( std::shared_ptr<Models> models ) : m_models( std::move( models ) ) {}

	std::string name() const override { return "PQP"; }
	std::string description() const override
	{
		return "PQP 1.3, OBB and RSS, as its library was built; round primitives as polyhedra";
	}

	std::size_t add( const void* key, const PeerGeometry& geometry ) override
	{
		std::shared_ptr<PQP_Model>& entry = ( *m_models )[key];
		if ( !entry )
		{
			entry = make( geometry );
		}
		m_bodies.emplace_back();
		m_bodies.back().model = entry;
		m_bodies.back().error = errorOf( geometry );
		return m_bodies.size() - 1;
	}

	void place( std::size_t body, const lw_transform& world_from_shape ) override
	{
		Body& b = m_bodies[body];
		std::copy( &world_from_shape.r[0][0], &world_from_shape.r[0][0] + 9, &b.r[0][0] );
		std::copy( world_from_shape.t, world_from_shape.t + 3, b.t );
	}

	double distance( std::size_t a, std::size_t b, double bound, double relative_error ) override
	{
		if ( std::isfinite( bound ) && !within( a, b, bound ) )
		{
			return bound;
		}
		Body &x = m_bodies[a], &y = m_bodies[b];
		PQP_DistanceResult result;
		// The relative error does nothing if no absolute one is allowed
		PQP_Distance(
		    &result, x.r, x.t, x.model.get(), y.r, y.t, y.model.get(), relative_error, relative_error > 0 ? 1e30 : 0.0 );
		return std::min( bound, result.Distance() );
	}

	bool collides( std::size_t a, std::size_t b ) override
	{
		Body &x = m_bodies[a], &y = m_bodies[b];
		PQP_Collide( &m_contacts, x.r, x.t, x.model.get(), y.r, y.t, y.model.get(), PQP_FIRST_CONTACT );
		return m_contacts.Colliding() != 0;
	}

	bool within( std::size_t a, std::size_t b, double margin ) override
	{
		Body &x = m_bodies[a], &y = m_bodies[b];
		PQP_ToleranceResult result;
		PQP_Tolerance( &result, x.r, x.t, x.model.get(), y.r, y.t, y.model.get(), margin );
		return result.CloserThanTolerance() != 0;
	}

	bool hasSolids() const override { return false; }
	double shapeError( std::size_t body ) const override { return m_bodies[body].error; }
	std::unique_ptr<PeerEngine> another() const override { return std::make_unique<PqpEngine>( m_models ); }
	double buildSeconds() const override { return m_build_seconds; }
	std::size_t bytes() const override { return m_bytes; }

private:
	struct Body
	{
		std::shared_ptr<PQP_Model> model;
		double error = 0;
		PQP_REAL r[3][3] = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } }, t[3] = { 0, 0, 0 };
	};

	std::shared_ptr<PQP_Model> make( const PeerGeometry& geometry )
	{
		Triangles made;
		if ( geometry.type != LW_SHAPE_MESH )
		{
			made = trianglesOf( geometry );
		}
		const bool own = geometry.type != LW_SHAPE_MESH;
		const double* vertices = own ? made.vertices.data() : geometry.vertices;
		const std::uint32_t* corners = own ? made.corners.data() : geometry.triangles;
		const std::size_t count = own ? made.corners.size() / 3 : geometry.triangle_count;
		const double start = threadSeconds();
		auto model = std::make_shared<PQP_Model>();
		model->BeginModel( static_cast<int>( count ) );
		for ( std::size_t i = 0; i < count; ++i )
		{
			const auto corner = [&]( int k )
			{ return vertices + 3 * std::size_t{ corners[3 * i + static_cast<std::size_t>( k )] }; };
			model->AddTri( corner( 0 ), corner( 1 ), corner( 2 ), static_cast<int>( i ) );
		}
		if ( model->EndModel() != 0 )
		{
			throw std::runtime_error( "PQP could not build a tree (a shape without triangles, or no memory)" );
		}
		m_build_seconds += threadSeconds() - start;
		m_bytes += static_cast<std::size_t>( model->MemUsage( 0 ) );
		return model;
	}

	std::shared_ptr<Models> m_models;
	std::vector<Body> m_bodies;
	PQP_CollideResult m_contacts; ///< keeps its array
	double m_build_seconds = 0;
	std::size_t m_bytes = 0;
};

} // namespace

PeerEngine* leeway_peer_engine()
{
	return new PqpEngine( std::make_shared<Models>() );
}
