// SPDX-License-Identifier: BSD-3-Clause
// Random shapes of all types, each for the engine and for the oracle from the same numbers.
#pragma once

#include "shape/shape.h"
#include "shape_oracle.hpp"
#include "shapes.hpp"

#include <gtest/gtest.h>

namespace oracle
{
inline constexpr int type_count = 9;
inline constexpr lw_shape_type types[type_count] = { LW_SHAPE_MESH, LW_SHAPE_POINTS, LW_SHAPE_BOX, LW_SHAPE_SPHERE,
    LW_SHAPE_CYLINDER, LW_SHAPE_CAPSULE, LW_SHAPE_CONE, LW_SHAPE_SPHERES, LW_SHAPE_BOXES };
inline constexpr const char* type_names[type_count] = {
    "mesh", "points", "box", "sphere", "cylinder", "capsule", "cone", "spheres", "boxes" };

/// One sphere or box of a set: a model about its own centre.
struct Part
{
	Model model;
	Vec center;
};

/// A shape twice: for the engine and for the oracle, both from the same numbers.
struct Subject
{
	ShapePtr shape;
	lw_shape_type type = LW_SHAPE_MESH;
	Model model;             ///< of a set: only its size
	std::vector<Part> parts; ///< of a set, else empty
};

inline bool is_set( const Subject& s )
{
	return s.type == LW_SHAPE_SPHERES || s.type == LW_SHAPE_BOXES;
}
inline std::size_t item_count( const Subject& s )
{
	return is_set( s ) ? s.parts.size() : s.model.count();
}

inline Vec random_point( SeededRng& rng, double size )
{
	return { rng.uniform( -size, size ), rng.uniform( -size, size ), rng.uniform( -size, size ) };
}

/// How many triangles or points: mostly one to twelve, one in forty enough for inner nodes.
inline int soup_count( SeededRng& rng )
{
	return rng.integer( 0, 39 ) == 0 ? rng.integer( 100, 400 ) : rng.integer( 1, 12 );
}

/// A soup of triangles of all kinds: ordinary, slivers down to 1e-14, segments, points, repeated ones, neighbours.
inline std::vector<Vec> random_triangles( SeededRng& rng, double size )
{
	const int count = soup_count( rng );
	const double part = count > 12 ? 0.2 * size : size * rng.decade( -1.5, 0 );
	// some meshes are not about their frame's origin
	Vec shift = rng.integer( 0, 4 ) == 0 ? random_point( rng, size * rng.decade( 0, 2 ) ) : Vec{ 0, 0, 0 };
	std::vector<Vec> points;
	for ( int i = 0; i < count; ++i )
	{
		Vec center = shift + random_point( rng, size );
		Vec v[3];
		for ( Vec& corner : v )
		{
			corner = center + random_point( rng, part );
		}
		switch ( rng.integer( 0, 9 ) )
		{
		case 0:
			v[2] = v[0] + (real)rng.uniform( 0, 1 ) * ( v[1] - v[0] ) + random_point( rng, part * rng.decade( -14, -2 ) );
			break;
		case 1:
			v[rng.integer( 1, 2 )] = v[0];
			break;
		case 2:
			v[1] = v[2] = v[0];
			break;
		case 3:
			if ( i > 0 )
			{
				std::copy( points.end() - 3, points.end(), v );
			}
			break;
		case 4:
			if ( i > 0 )
			{
				v[0] = points[points.size() - 1];
				v[1] = points[points.size() - 2];
			}
			break;
		default:
			break;
		}
		points.insert( points.end(), v, v + 3 );
	}
	return points;
}

inline std::vector<double> rounded( std::vector<Vec>& points )
{
	std::vector<double> out;
	for ( Vec& p : points )
	{
		lw_vec3 q = to_double( p );
		out.insert( out.end(), { q.x, q.y, q.z } );
		p = from( q );
	}
	return out;
}

inline void make_soup( SeededRng& rng, double size, Subject& out )
{
	if ( out.type == LW_SHAPE_MESH )
	{
		out.model.corners = 3;
		out.model.points = random_triangles( rng, size );
		std::vector<double> vertices = rounded( out.model.points );
		std::vector<uint32_t> indices;
		for ( std::size_t i = 0; i < out.model.points.size(); ++i )
		{
			indices.push_back( static_cast<uint32_t>( i ) );
		}
		out.shape = makeMesh( vertices, indices );
		return;
	}
	out.model.corners = 1;
	const int count = soup_count( rng );
	for ( int i = 0; i < count; ++i )
	{
		bool again = i > 0 && rng.integer( 0, 9 ) == 0;
		out.model.points.push_back( again ? out.model.points.back() : random_point( rng, size ) );
	}
	std::vector<double> points = rounded( out.model.points );
	out.model.radius = rng.integer( 0, 3 ) == 0 ? 0 : size * rng.decade( -3, 0 );
	lw_shape* shape = nullptr;
	lw_status status = lw_shape_create_points(
	    points.data(), static_cast<uint32_t>( count ), out.model.radius, nullptr, nullptr, nullptr, &shape );
	ASSERT_EQ( LW_OK, status );
	out.shape.reset( shape );
}

/// Spheres of radii over four decades, some of them points; boxes of all sizes, some of them plates, segments or points.
inline void make_set( SeededRng& rng, double size, Subject& out )
{
	const bool spheres = out.type == LW_SHAPE_SPHERES;
	const int count = soup_count( rng );
	Vec shift = rng.integer( 0, 4 ) == 0 ? random_point( rng, size * rng.decade( 0, 2 ) ) : Vec{ 0, 0, 0 };
	std::vector<double> numbers;
	for ( int i = 0; i < count; ++i )
	{
		Part part;
		lw_vec3 c = to_double( shift + random_point( rng, size ) );
		double extent = size * rng.decade( count > 12 ? -3 : -4, count > 12 ? -1 : 0 );
		if ( spheres )
		{
			part.model.corners = 1;
			part.model.points.assign( 1, { 0, 0, 0 } );
			part.model.radius = part.model.size = rng.integer( 0, 9 ) == 0 ? 0 : extent;
			part.center = from( c );
			numbers.insert( numbers.end(), { c.x, c.y, c.z, part.model.radius } );
		}
		else
		{
			double low[3] = { c.x, c.y, c.z }, high[3], middle[3];
			for ( int k = 0; k < 3; ++k )
			{
				high[k] = low[k] + ( rng.integer( 0, 9 ) == 0 ? 0 : extent * rng.uniform( 0.05, 1 ) );
				part.model.solid.size[k] = 0.5 * ( high[k] - low[k] );
				middle[k] = to_double( 0.5L * ( (real)low[k] + high[k] ) );
			}
			part.model.solid.type = LWI_CONVEX_BOX;
			part.model.size = Body{ part.model.solid }.radius();
			part.center = { middle[0], middle[1], middle[2] };
			numbers.insert( numbers.end(), low, low + 3 );
			numbers.insert( numbers.end(), high, high + 3 );
		}
		out.model.size = std::max( out.model.size, length( part.center ) + part.model.size );
		out.parts.push_back( part );
	}
	lw_shape* shape = nullptr;
	lw_diag diag = {};
	auto n = static_cast<uint32_t>( count );
	lw_status status = spheres ? lw_shape_create_spheres( numbers.data(), n, nullptr, nullptr, &diag, &shape )
	                           : lw_shape_create_boxes( numbers.data(), n, nullptr, nullptr, &diag, &shape );
	ASSERT_EQ( LW_OK, status ) << diag.message;
	ASSERT_EQ( LW_OK, lwi_shape_validate( shape, &diag ) ) << diag.message;
	out.shape.reset( shape );
}

/// A quarter of the primitives are plates, wires or needles.
inline void make_primitive( SeededRng& rng, double size, Subject& out )
{
	double thinnest = rng.integer( 0, 3 ) == 0 ? -6 : -0.7, d[3];
	for ( double& x : d )
	{
		x = size * rng.decade( thinnest, 0 );
	}
	Model& m = out.model;
	switch ( out.type )
	{
	case LW_SHAPE_SPHERE:
	case LW_SHAPE_CAPSULE:
	{
		d[1] = out.type == LW_SHAPE_SPHERE || rng.integer( 0, 19 ) == 0 ? 0 : d[1];
		m.radius = d[0];
		real half = 0.5L * d[1];
		m.corners = out.type == LW_SHAPE_SPHERE ? 1 : 2;
		m.points.assign( 1, { 0, 0, -half } );
		m.points.resize( static_cast<std::size_t>( m.corners ), { 0, 0, half } );
		break;
	}
	case LW_SHAPE_BOX:
		m.solid = { LWI_CONVEX_BOX, { 0.5 * d[0], 0.5 * d[1], 0.5 * d[2] }, {}, nullptr, 0, nullptr };
		break;
	default:
		m.solid = { out.type == LW_SHAPE_CONE ? LWI_CONVEX_CONE : LWI_CONVEX_CYLINDER, { d[0], 0.5 * d[1], 0 }, {}, nullptr,
		    0, nullptr };
	}
	out.shape = makePrimitive( out.type, d[0], d[1], d[2] );
}

inline Subject make_subject( SeededRng& rng, lw_shape_type type, double size )
{
	Subject out;
	out.type = type;
	if ( is_set( out ) )
	{
		make_set( rng, size, out );
		return out;
	}
	if ( type == LW_SHAPE_MESH || type == LW_SHAPE_POINTS )
	{
		make_soup( rng, size, out );
	}
	else
	{
		make_primitive( rng, size, out );
	}
	real core = out.model.corners == 0 ? Body{ out.model.solid }.radius() : (real)0;
	for ( Vec p : out.model.points )
	{
		core = std::max( core, length( p ) );
	}
	out.model.size = core + out.model.radius;
	return out;
}

inline bool is_solid( const Subject& s )
{
	return s.type != LW_SHAPE_MESH && s.type != LW_SHAPE_POINTS;
}

/// A random point of the shape: of its surface if it is a mesh, well inside if it is a primitive.
inline Vec point_of( SeededRng& rng, const Subject& s )
{
	if ( is_set( s ) )
	{
		return s.parts[static_cast<std::size_t>( rng.integer( 0, (int)s.parts.size() - 1 ) )].center;
	}
	const Model& m = s.model;
	if ( m.corners == 0 )
	{
		return Body{ m.solid }.nearest( random_point( rng, 1e-3 * *std::min_element( m.solid.size, m.solid.size + 2 ) ) );
	}
	auto corners = static_cast<std::size_t>( m.corners );
	std::size_t first = corners * static_cast<std::size_t>( rng.integer( 0, (int)m.count() - 1 ) );
	real left = 1;
	Vec p = { 0, 0, 0 };
	for ( std::size_t k = 0; k < corners; ++k )
	{
		real part = k + 1 == corners ? left : left * (real)rng.uniform( 0, 1 );
		p = p + part * m.points[first + k];
		left -= part;
	}
	return p;
}

inline lw_transform random_pose( SeededRng& rng, double far )
{
	lw_transform m = random_rotation( rng );
	if ( rng.integer( 0, 4 ) == 0 )
	{
		// axes along axes: faces, edges and rims are parallel
		m = lw_transform_identity();
		int turn = rng.integer( 0, 2 );
		for ( int i = 0; i < 3; ++i )
		{
			m.r[i][i] = 0;
		}
		for ( int i = 0; i < 3; ++i )
		{
			m.r[i][( i + turn ) % 3] = 1;
		}
	}
	lw_vec3 d = random_direction( rng );
	m.t[0] = far * d.x;
	m.t[1] = far * d.y;
	m.t[2] = far * d.z;
	return m;
}

/// The parts of a set; any other subject is its own part.
inline std::vector<Part> parts_of( const Subject& s )
{
	return is_set( s ) ? s.parts : std::vector<Part>{ { s.model, { 0, 0, 0 } } };
}

/// The least over all pairs of parts, nearest spheres first; both placed in a frame where a rests.
inline Interval truth_of(
    const Subject& subject_a, const lw_transform& pose_a, const Subject& subject_b, const lw_transform& pose_b, real scale )
{
	if ( !is_set( subject_a ) && !is_set( subject_b ) )
	{
		return shape_distance( subject_a.model, pose_a, subject_b.model, pose_b, scale );
	}
	Pose a_from_b = relative( pose_a, pose_b );
	std::vector<Part> a = parts_of( subject_a ), b = parts_of( subject_b );
	struct Candidate
	{
		real gap;
		const Part *a, *b;
		Vec offset;
	};
	std::vector<Candidate> candidates;
	for ( const Part& x : a )
	{
		for ( const Part& y : b )
		{
			Vec offset = a_from_b.apply( y.center ) - x.center;
			candidates.push_back( { length( offset ) - x.model.size - y.model.size, &x, &y, offset } );
		}
	}
	std::sort(
	    candidates.begin(), candidates.end(), []( const Candidate& x, const Candidate& y ) { return x.gap < y.gap; } );
	Interval best = { INFINITY, INFINITY };
	for ( const Candidate& c : candidates )
	{
		if ( c.gap >= best.upper || best.upper == 0 )
		{
			break;
		}
		Pose place = a_from_b;
		place.t = c.offset;
		Interval d = shape_distance( c.a->model, lw_transform_identity(), c.b->model, to_transform( place ), scale );
		best.lower = std::min( best.lower, d.lower );
		best.upper = std::min( best.upper, d.upper );
	}
	return best;
}
} // namespace oracle
