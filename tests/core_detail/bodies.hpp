// SPDX-License-Identifier: BSD-3-Clause
// Bodies for the tests of enclosing spheres and of detail: soups with and without an inside, and known facts about them.
#pragma once

#include "shapes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

using Point = std::array<double, 3>;

struct Mesh
{
	std::vector<double> vertices;
	std::vector<uint32_t> triangles;

	uint32_t vertex( double x, double y, double z )
	{
		vertices.insert( vertices.end(), { x, y, z } );
		return static_cast<uint32_t>( vertices.size() / 3 - 1 );
	}
	void triangle( uint32_t a, uint32_t b, uint32_t c ) { triangles.insert( triangles.end(), { a, b, c } ); }
	void quad( uint32_t a, uint32_t b, uint32_t c, uint32_t d )
	{
		triangle( a, b, c );
		triangle( a, c, d );
	}
	Point at( std::size_t triangle, int corner ) const
	{
		const double* v = vertices.data() + 3 * triangles[3 * triangle + static_cast<std::size_t>( corner )];
		return { v[0], v[1], v[2] };
	}
	std::size_t count() const { return triangles.size() / 3; }
	ShapePtr shape() const { return makeMesh( vertices, triangles ); }
	void add( const Mesh& other )
	{
		auto first = static_cast<uint32_t>( vertices.size() / 3 );
		vertices.insert( vertices.end(), other.vertices.begin(), other.vertices.end() );
		for ( uint32_t i : other.triangles )
		{
			triangles.push_back( first + i );
		}
	}
};

/// A box of the given half edges about `c`; without its top where `open`. Faces turn as they like: winding must not matter.
inline Mesh boxMesh( double x, double y, double z, Point c = { 0, 0, 0 }, bool open = false )
{
	Mesh m;
	for ( int k = 0; k < 8; ++k )
	{
		m.vertex( c[0] + ( k & 1 ? x : -x ), c[1] + ( k & 2 ? y : -y ), c[2] + ( k & 4 ? z : -z ) );
	}
	m.quad( 0, 1, 3, 2 );
	m.quad( 0, 1, 5, 4 );
	m.quad( 2, 3, 7, 6 );
	m.quad( 0, 2, 6, 4 );
	m.quad( 1, 3, 7, 5 );
	if ( !open )
	{
		m.quad( 4, 5, 7, 6 );
	}
	return m;
}

/// A torus about z: tube radius r, ring radius R.
inline Mesh torusMesh( double R, double r, int around, int tube )
{
	Mesh m;
	for ( int i = 0; i < around; ++i )
	{
		for ( int k = 0; k < tube; ++k )
		{
			double a = 2 * M_PI * i / around, b = 2 * M_PI * k / tube, d = R + r * std::cos( b );
			m.vertex( d * std::cos( a ), d * std::sin( a ), r * std::sin( b ) );
		}
	}
	auto id = [&]( int i, int k ) { return static_cast<uint32_t>( ( i % around ) * tube + k % tube ); };
	for ( int i = 0; i < around; ++i )
	{
		for ( int k = 0; k < tube; ++k )
		{
			m.quad( id( i, k ), id( i + 1, k ), id( i + 1, k + 1 ), id( i, k + 1 ) );
		}
	}
	return m;
}

/// A bumpy ball: closed, not convex, triangles of all sizes.
inline Mesh bumpyMesh( SeededRng& rng, double radius, int rings, int sectors )
{
	double f = rng.uniform( 1, 5 ), g = rng.uniform( 1, 5 ), depth = rng.uniform( 0, 0.4 );
	Mesh m;
	auto put = [&]( double polar, double around )
	{
		double r = radius * ( 1 + depth * std::sin( f * polar ) * std::cos( std::floor( g ) * around ) );
		return m.vertex(
		    r * std::sin( polar ) * std::cos( around ), r * std::sin( polar ) * std::sin( around ), r * std::cos( polar ) );
	};
	uint32_t top = put( 0, 0 ), bottom = put( M_PI, 0 );
	for ( int i = 1; i < rings; ++i )
	{
		for ( int k = 0; k < sectors; ++k )
		{
			put( M_PI * i / rings, 2 * M_PI * k / sectors );
		}
	}
	auto id = [&]( int i, int k ) { return static_cast<uint32_t>( 2 + ( i - 1 ) * sectors + k % sectors ); };
	for ( int k = 0; k < sectors; ++k )
	{
		m.triangle( top, id( 1, k ), id( 1, k + 1 ) );
		m.triangle( bottom, id( rings - 1, k ), id( rings - 1, k + 1 ) );
		for ( int i = 1; i + 1 < rings; ++i )
		{
			m.quad( id( i, k ), id( i + 1, k ), id( i + 1, k + 1 ), id( i, k + 1 ) );
		}
	}
	return m;
}

inline double distance( const Point& a, const Point& b )
{
	return std::hypot( a[0] - b[0], a[1] - b[1], a[2] - b[2] );
}

/// A uniform point of a triangle.
inline Point pointOf( SeededRng& rng, const Mesh& m, std::size_t triangle )
{
	double u = rng.uniform( 0, 1 ), v = rng.uniform( 0, 1 );
	if ( u + v > 1 )
	{
		u = 1 - u;
		v = 1 - v;
	}
	Point a = m.at( triangle, 0 ), b = m.at( triangle, 1 ), c = m.at( triangle, 2 ), p;
	for ( std::size_t k = 0; k < 3; ++k )
	{
		p[k] = a[k] + u * ( b[k] - a[k] ) + v * ( c[k] - a[k] );
	}
	return p;
}

/// Distance of a point to a segment, and to a triangle, in a form of their own (projection onto the plane's normal).
inline double toSegment( const Point& p, const Point& a, const Point& b )
{
	double length_sq = 0, along = 0;
	for ( std::size_t k = 0; k < 3; ++k )
	{
		length_sq += ( b[k] - a[k] ) * ( b[k] - a[k] );
		along += ( p[k] - a[k] ) * ( b[k] - a[k] );
	}
	double t = length_sq > 0 ? std::clamp( along / length_sq, 0.0, 1.0 ) : 0;
	return distance( p, { a[0] + t * ( b[0] - a[0] ), a[1] + t * ( b[1] - a[1] ), a[2] + t * ( b[2] - a[2] ) } );
}

inline Point cross( const Point& a, const Point& b )
{
	return { a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0] };
}
inline Point minus( const Point& a, const Point& b )
{
	return { a[0] - b[0], a[1] - b[1], a[2] - b[2] };
}
inline double dot( const Point& a, const Point& b )
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

inline double toTriangle( const Point& p, const Point& a, const Point& b, const Point& c )
{
	double best = std::min( { toSegment( p, a, b ), toSegment( p, b, c ), toSegment( p, c, a ) } );
	Point n = cross( minus( b, a ), minus( c, a ) );
	double length = std::sqrt( dot( n, n ) );
	bool above = length > 0 && dot( cross( minus( b, a ), minus( p, a ) ), n ) >= 0 &&
	             dot( cross( minus( c, b ), minus( p, b ) ), n ) >= 0 &&
	             dot( cross( minus( a, c ), minus( p, c ) ), n ) >= 0;
	return above ? std::min( best, std::abs( dot( minus( p, a ), n ) ) / length ) : best;
}

inline double toSurface( const Point& p, const Mesh& m )
{
	double best = INFINITY;
	for ( std::size_t t = 0; t < m.count(); ++t )
	{
		best = std::min( best, toTriangle( p, m.at( t, 0 ), m.at( t, 1 ), m.at( t, 2 ) ) );
	}
	return best;
}

/// True if most of five random rays cross the surface an odd number of times.
inline bool insideByRays( SeededRng& rng, const Point& p, const Mesh& m )
{
	int votes = 0;
	for ( int ray = 0; ray < 5; ++ray )
	{
		Point d = { rng.normal(), rng.normal(), rng.normal() };
		int crossings = 0;
		for ( std::size_t t = 0; t < m.count(); ++t )
		{
			// Moeller, Trumbore 1997
			Point a = m.at( t, 0 ), e1 = minus( m.at( t, 1 ), a ), e2 = minus( m.at( t, 2 ), a ), h = cross( d, e2 );
			double det = dot( e1, h );
			if ( det == 0 )
			{
				continue;
			}
			Point s = minus( p, a ), q = cross( s, e1 );
			double u = dot( s, h ) / det, v = dot( d, q ) / det, w = dot( e2, q ) / det;
			crossings += u >= 0 && v >= 0 && u + v <= 1 && w > 0 ? 1 : 0;
		}
		votes += crossings % 2;
	}
	return votes >= 3;
}
