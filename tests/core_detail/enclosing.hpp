// SPDX-License-Identifier: BSD-3-Clause
// Enclosing spheres of bodies, made and checked, for their tests.
#pragma once

#include "bodies.hpp"

#include "leeway/spheres.h"

#include <gtest/gtest.h>

struct SpheresDeleter
{
	void operator()( lw_spheres* s ) const { lw_spheres_destroy( s ); }
};
using SpheresPtr = std::unique_ptr<lw_spheres, SpheresDeleter>;

struct Sphere
{
	Point center;
	double radius;
};

inline std::vector<Sphere> spheresOf( const lw_spheres* set )
{
	std::vector<Sphere> out;
	for ( uint32_t i = 0; i < lw_spheres_count( set ); ++i )
	{
		const double* s = lw_spheres_data( set ) + 4 * i;
		out.push_back( { { s[0], s[1], s[2] }, s[3] } );
	}
	return out;
}

struct Body
{
	std::vector<const lw_shape*> shapes;
	std::vector<lw_transform> poses;
	double close_holes = 0;

	explicit Body( const lw_shape* shape, double holes = 0 ) : shapes{ shape }, close_holes( holes ) {}
	lw_geometry_def def() const
	{
		return {
		    shapes.data(), poses.empty() ? nullptr : poses.data(), static_cast<uint32_t>( shapes.size() ), close_holes };
	}
};

inline SpheresPtr enclose( const Body& body, double excess, uint32_t count = 0, const lw_allocator* allocator = nullptr )
{
	lw_spheres_def def = lw_spheres_def_default();
	def.body = body.def();
	def.excess = excess;
	def.sphere_count = count;
	lw_diag diag = {};
	lw_spheres* out = nullptr;
	EXPECT_EQ( lw_spheres_create( &def, allocator, &diag, &out ), LW_OK ) << diag.message;
	return SpheresPtr( out );
}

inline lw_spheres_report check( const Body& body, const std::vector<Sphere>& spheres )
{
	std::vector<double> data;
	for ( const Sphere& s : spheres )
	{
		data.insert( data.end(), { s.center[0], s.center[1], s.center[2], s.radius } );
	}
	lw_spheres_report report;
	lw_diag diag = {};
	lw_geometry_def def = body.def();
	EXPECT_EQ(
	    lw_spheres_check( &def, data.data(), static_cast<uint32_t>( spheres.size() ), nullptr, &diag, &report ), LW_OK )
	    << diag.message;
	return report;
}

/// How far p is from the nearest sphere; negative inside.
inline double gap( const std::vector<Sphere>& spheres, const Point& p )
{
	double best = INFINITY;
	for ( const Sphere& s : spheres )
	{
		best = std::min( best, distance( p, s.center ) - s.radius );
	}
	return best;
}

inline void expectNothingOutside( SeededRng& rng, const Mesh& mesh, const std::vector<Sphere>& spheres, int samples )
{
	for ( std::size_t t = 0; t < mesh.count(); ++t )
	{
		for ( int k = 0; k < 3; ++k )
		{
			EXPECT_LE( gap( spheres, mesh.at( t, k ) ), 0 );
		}
		for ( int i = 0; i < samples; ++i )
		{
			EXPECT_LE( gap( spheres, pointOf( rng, mesh, t ) ), 0 );
		}
	}
}

/// Points on the spheres against a slow oracle of the body. Returns the farthest distance seen.
inline double farthestBeyond(
    SeededRng& rng, const Mesh& mesh, const std::vector<Sphere>& spheres, int samples, bool has_inside )
{
	double most = 0;
	for ( const Sphere& s : spheres )
	{
		for ( int i = 0; i < samples; ++i )
		{
			double d[3] = { rng.normal(), rng.normal(), rng.normal() }, length = std::hypot( d[0], d[1], d[2] );
			Point p;
			for ( std::size_t k = 0; k < 3; ++k )
			{
				p[k] = s.center[k] + s.radius * d[k] / length;
			}
			if ( !has_inside || !insideByRays( rng, p, mesh ) )
			{
				most = std::max( most, toSurface( p, mesh ) );
			}
		}
	}
	return most;
}

/// Stops a search after a number of calls.
struct Countdown
{
	int calls; ///< until the search is to stop

	static bool over( void* user ) { return --static_cast<Countdown*>( user )->calls < 0; }
};
