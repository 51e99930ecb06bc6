// SPDX-License-Identifier: BSD-3-Clause
// Meshes that are convex are measured as one body. The oracle is brute force over their triangles, which knows nothing of hulls; hulls
// are found by testing every triple of points.
#include "sanitized.hpp"
#include "shapes.hpp"

#include "distance/tri_tri.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>

namespace
{

using Point = std::array<double, 3>;

struct Hull
{
	std::vector<double> vertices;
	std::vector<uint32_t> indices;

	Point at( uint32_t i ) const { return { vertices[3 * i], vertices[3 * i + 1], vertices[3 * i + 2] }; }
};

double height( const Hull& h, uint32_t a, uint32_t b, uint32_t c, uint32_t p )
{
	const Point o = h.at( a ), u = h.at( b ), v = h.at( c ), w = h.at( p );
	double m[3][3];
	for ( std::size_t k = 0; k < 3; ++k )
	{
		m[0][k] = u[k] - o[k];
		m[1][k] = v[k] - o[k];
		m[2][k] = w[k] - o[k];
	}
	return m[0][0] * ( m[1][1] * m[2][2] - m[1][2] * m[2][1] ) - m[0][1] * ( m[1][0] * m[2][2] - m[1][2] * m[2][0] ) +
	       m[0][2] * ( m[1][0] * m[2][1] - m[1][1] * m[2][0] );
}

/// Points of an ellipsoid, and the triangles of their hull, turned at random.
Hull randomHull( SeededRng& rng, uint32_t count, double size )
{
	Hull hull;
	const double axes[3] = { size, size * rng.decade( -1.5, 0 ), size * rng.decade( -1.5, 0 ) };
	for ( uint32_t i = 0; i < count; ++i )
	{
		double p[3], length = 0;
		for ( double& x : p )
		{
			x = rng.normal();
			length += x * x;
		}
		for ( std::size_t k = 0; k < 3; ++k )
		{
			hull.vertices.push_back( axes[k] * p[k] / std::sqrt( length ) + 0.3 * size );
		}
	}
	for ( uint32_t a = 0; a < count; ++a )
	{
		for ( uint32_t b = a + 1; b < count; ++b )
		{
			for ( uint32_t c = b + 1; c < count; ++c )
			{
				int above = 0, below = 0;
				for ( uint32_t p = 0; p < count; ++p )
				{
					const double z = p == a || p == b || p == c ? 0 : height( hull, a, b, c, p );
					above += z > 0;
					below += z < 0;
				}
				if ( above == 0 || below == 0 )
				{
					const bool turn = rng.integer( 0, 1 ) == 1;
					hull.indices.insert( hull.indices.end(), { a, turn ? c : b, turn ? b : c } );
				}
			}
		}
	}
	return hull;
}

/// The mean of the vertices from the first one on: a point inside.
Point middleOf( const Hull& hull, uint32_t first )
{
	const uint32_t count = static_cast<uint32_t>( hull.vertices.size() / 3 );
	Point middle{};
	for ( uint32_t i = first; i < count; ++i )
	{
		for ( std::size_t k = 0; k < 3; ++k )
		{
			middle[k] += hull.at( i )[k] / ( count - first );
		}
	}
	return middle;
}

/// The vertices, so many times as far from a point.
std::vector<double> scaledAbout( const Point& middle, double factor, const Hull& hull )
{
	std::vector<double> out = hull.vertices;
	for ( std::size_t k = 0; k < out.size(); ++k )
	{
		out[k] = middle[k % 3] + ( out[k] - middle[k % 3] ) * factor;
	}
	return out;
}

/// The least distance of two parallel planes, one of them through a face, that the hull is between.
double thickness( const Hull& hull )
{
	double least = std::numeric_limits<double>::infinity();
	for ( std::size_t i = 0; i < hull.indices.size(); i += 3 )
	{
		const uint32_t* t = &hull.indices[i];
		const Point a = hull.at( t[0] ), b = hull.at( t[1] ), c = hull.at( t[2] );
		double far = 0, square = 0;
		for ( uint32_t v = 0; v < hull.vertices.size() / 3; ++v )
		{
			far = std::max( far, std::fabs( height( hull, t[0], t[1], t[2], v ) ) );
		}
		for ( std::size_t k = 0, l = 1, m = 2; k < 3; l = m, m = k++ )
		{
			const double n = ( b[l] - a[l] ) * ( c[m] - a[m] ) - ( b[m] - a[m] ) * ( c[l] - a[l] );
			square += n * n;
		}
		least = std::min( least, far / std::sqrt( square ) );
	}
	return least;
}

lw_shape* shapeOf( const Hull& hull, bool solid = false )
{
	lw_mesh_def def = lw_mesh_def_default();
	def.vertices = hull.vertices.data();
	def.vertex_count = static_cast<uint32_t>( hull.vertices.size() / 3 );
	def.indices = hull.indices.data();
	def.triangle_count = static_cast<uint32_t>( hull.indices.size() / 3 );
	def.solid = solid;
	lw_shape* shape = nullptr;
	EXPECT_EQ( LW_OK, lw_shape_create_mesh( &def, nullptr, nullptr, &shape ) );
	return shape;
}

lw_clearance distanceOf(
    const lw_shape* a, const lw_transform& pose_a, const lw_shape* b, const lw_transform& pose_b, const QueryPtr& query )
{
	lw_clearance out;
	EXPECT_EQ( LW_OK, lw_shape_distance( a, &pose_a, b, &pose_b, nullptr, query.get(), &out ) );
	return out;
}

/// A convex mesh is measured once; a tree takes several triangles.
bool isOneBody( const Hull& hull, double size = 1 )
{
	const ShapePtr shape( shapeOf( hull ) );
	const ShapePtr box = makePrimitive( LW_SHAPE_BOX, 0.1 * size, 0.2 * size, 0.3 * size );
	const QueryPtr query = makeQuery();
	const lw_transform here = lw_transform_identity(), there = at( 3 * size, 0.1 * size, 0.2 * size );
	distanceOf( shape.get(), here, box.get(), there, query );
	const lw_query_stats stats = lw_query_get_stats( query.get() );
	return stats.node_tests + stats.leaf_tests == 0;
}

TEST( ConvexMeshes, HullsAreNotSeen )
{
	SeededRng rng( 1 );
	for ( int i = 0; i < 40; ++i )
	{
		const double size = rng.decade( -3, 3 );
		Hull hull;
		do // of flat ones rounding hides which way the faces look
		{
			hull = randomHull( rng, static_cast<uint32_t>( rng.integer( 4, 24 ) ), size );
		} while ( thickness( hull ) < 0.01 * size );
		EXPECT_TRUE( isOneBody( hull, size ) ) << i;
	}
}

TEST( ConvexMeshes, DentedOpenOrDoubledMeshesAreTakenForHulls )
{
	SeededRng rng( 2 );
	for ( int i = 0; i < 40; ++i )
	{
		const Hull hull = randomHull( rng, 12, 1 );
		Hull dented = hull, open = hull, twice = hull, doubled = hull;
		const Point inside = middleOf( hull, 1 );
		std::copy( inside.begin(), inside.end(), dented.vertices.begin() );
		open.indices.resize( open.indices.size() - 3 );
		std::copy_n( hull.indices.begin(), 3, doubled.indices.end() - 3 ); // as many triangles as a hull
		for ( uint32_t v : hull.indices )                                  // a second shell around the first
		{
			twice.indices.push_back( v + 12 );
		}
		const std::vector<double> shell = scaledAbout( middleOf( hull, 0 ), 1.5, hull );
		twice.vertices.insert( twice.vertices.end(), shell.begin(), shell.end() );
		EXPECT_FALSE( isOneBody( dented ) ) << i;
		EXPECT_FALSE( isOneBody( open ) ) << i;
		EXPECT_FALSE( isOneBody( doubled ) ) << i;
		EXPECT_FALSE( isOneBody( twice ) ) << i;
	}
}

/// The least distance of all pairs of triangles.
double bruteOf( const Hull& a, const lw_transform& pose_a, const Hull& b, const lw_transform& pose_b )
{
	const auto triangle = []( const Hull& hull, const lw_transform& pose, std::size_t first, lw_vec3 out[3] )
	{
		for ( std::size_t k = 0; k < 3; ++k )
		{
			const Point p = hull.at( hull.indices[first + k] );
			out[k] = lw_transform_point( &pose, { p[0], p[1], p[2] } );
		}
	};
	double least = std::numeric_limits<double>::infinity();
	for ( std::size_t i = 0; i < a.indices.size(); i += 3 )
	{
		lw_vec3 x[3], y[3];
		triangle( a, pose_a, i, x );
		for ( std::size_t j = 0; j < b.indices.size(); j += 3 )
		{
			triangle( b, pose_b, j, y );
			least = std::min( least, lwi_tri_tri( x, y ).distance );
		}
	}
	return least;
}

TEST( ConvexMeshes, IntervalMissesTheDistanceOfAllTriangles )
{
	SeededRng rng( 3 );
	const QueryPtr query = makeQuery();
	int apart = 0, crossing = 0;
	Hull large;
	for ( int i = 0; i < unlessSanitized( 2000, 100 ); ++i )
	{
		const bool climbs = i % 20 == 0; // from vertex to vertex: some hulls of more than LWI_CLIMB_FROM
		if ( i % 200 == 0 )
		{
			large = randomHull( rng, 105, 1 );
		}
		const Hull a = climbs ? large : randomHull( rng, static_cast<uint32_t>( rng.integer( 4, 16 ) ), 1 );
		const Hull b = randomHull( rng, static_cast<uint32_t>( rng.integer( 4, 16 ) ), rng.decade( -1, 0.3 ) );
		const lw_transform pose_a = randomPose( rng, 0.1 ), pose_b = randomPose( rng, rng.integer( 0, 1 ) == 0 ? 0.5 : 3 );
		const ShapePtr shape_a( shapeOf( a ) ), shape_b( shapeOf( b ) );
		const lw_clearance out = distanceOf( shape_a.get(), pose_a, shape_b.get(), pose_b, query );
		const double truth = bruteOf( a, pose_a, b, pose_b );
		ASSERT_LE( out.lower, truth + 3e-12 ) << i;
		ASSERT_GE( out.upper, truth - 3e-12 ) << i;
		ASSERT_LE( out.upper - out.lower, 3e-12 ) << i;
		if ( truth > 0 )
		{
			++apart;
			const double witness =
			    std::hypot( out.point_a.x - out.point_b.x, out.point_a.y - out.point_b.y, out.point_a.z - out.point_b.z );
			ASSERT_NEAR( witness, truth, 3e-12 ) << i;
		}
		crossing += truth == 0;
	}
	EXPECT_GT( apart, unlessSanitized( 800, 30 ) );
	EXPECT_GT( crossing, unlessSanitized( 100, 5 ) );
}

TEST( ConvexMeshes, SurfaceInsideASurfaceIsContact )
{
	SeededRng rng( 4 );
	const QueryPtr query = makeQuery();
	for ( int i = 0; i < 50; ++i )
	{
		Hull outer = randomHull( rng, 20, 1 ), inner = outer;
		inner.vertices = scaledAbout( middleOf( outer, 0 ), 0.5, outer );
		const lw_transform here = lw_transform_identity();
		const ShapePtr surface( shapeOf( outer ) ), solid( shapeOf( outer, true ) ), small( shapeOf( inner ) );
		const lw_clearance apart = distanceOf( surface.get(), here, small.get(), here, query );
		EXPECT_GT( apart.lower, 1e-4 ) << i;
		EXPECT_NEAR( apart.upper, bruteOf( outer, here, inner, here ), 3e-12 ) << i;
		EXPECT_EQ( 0, distanceOf( solid.get(), here, small.get(), here, query ).upper ) << i;
	}
}

/// A witness is on the triangle of a mesh that is named with it.
void expectNamed(
    const ShapePtr& mesh, const lw_transform& pose, std::uint32_t triangle, lw_vec3 witness, const QueryPtr& query )
{
	ASSERT_LT( triangle, lw_shape_get_info( mesh.get() ).triangle_count );
	const ShapePtr alone = triangleOf( mesh, triangle ), point = makePrimitive( LW_SHAPE_SPHERE, 1e-9 );
	EXPECT_LT( distanceOf( alone.get(), pose, point.get(), at( witness.x, witness.y, witness.z ), query ).upper, 1e-7 );
}

TEST( ConvexMeshes, NamedTriangleDoesNotHoldTheWitness )
{
	SeededRng rng( 5 );
	const QueryPtr query = makeQuery();
	Hull cuboid; // faces of four corners, of which two triangles have three
	for ( int i = 0; i < 8; ++i )
	{
		cuboid.vertices.insert( cuboid.vertices.end(), { i & 1 ? 0.4 : -0.4, i & 2 ? 0.5 : -0.5, i & 4 ? 0.3 : -0.3 } );
	}
	cuboid.indices = {
	    0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5 };
	int named = 0;
	for ( int i = 0; i < 600; ++i )
	{
		const Hull small = randomHull( rng, 14, 1 ), large = i % 200 == 0 ? randomHull( rng, 150, 1 ) : cuboid;
		const ShapePtr a( shapeOf( small ) ),
		    b = i % 2 == 0 ? ShapePtr( shapeOf( large ) ) : makePrimitive( LW_SHAPE_BOX, 0.2, 0.3, 0.4 );
		const lw_transform here = randomPose( rng, 1 ), there = randomPose( rng, 4 );
		const lw_clearance out = distanceOf( a.get(), here, b.get(), there, query );
		if ( out.lower > 0 )
		{
			SCOPED_TRACE( i );
			++named;
			expectNamed( a, here, out.a, out.point_a, query );
			i % 2 == 0 ? expectNamed( b, there, out.b, out.point_b, query ) : (void)0;
		}
	}
	EXPECT_GT( named, 300 );
}

} // namespace
