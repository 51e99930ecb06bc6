// SPDX-License-Identifier: BSD-3-Clause
// Levels of detail: the coarser shape contains the shape, its excess holds, and nothing else about it is odd.
#include "bodies.hpp"

#include "leeway/leeway.h"
#include "shape/shape.h"

#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <fstream>

namespace
{

ShapePtr coarser( const lw_shape* shape, double tolerance, const lw_allocator* allocator = nullptr )
{
	lw_shape* out = nullptr;
	lw_diag diag = {};
	EXPECT_EQ( lw_shape_create_detail( shape, tolerance, nullptr, allocator, &diag, &out ), LW_OK ) << diag.message;
	return ShapePtr( out );
}

double radiusOf( const lw_shape* shape )
{
	return lw_shape_get_info( shape ).dimensions[0];
}

/// The triangles of a shape, as it is.
Mesh meshOf( const lw_shape* shape )
{
	lw_shape_info info = lw_shape_get_info( shape );
	Mesh mesh;
	mesh.vertices.assign( lw_shape_vertices( shape ), lw_shape_vertices( shape ) + 3 * std::size_t( info.vertex_count ) );
	mesh.triangles.assign(
	    lw_shape_triangles( shape ), lw_shape_triangles( shape ) + 3 * std::size_t( info.triangle_count ) );
	return mesh;
}

/// The middle of a side, a corner, or any point of a triangle: where a proof by corners would be wrong first.
Point suspectOf( SeededRng& rng, const Mesh& mesh )
{
	auto t = static_cast<std::size_t>( rng.integer( 0, static_cast<int>( mesh.count() ) - 1 ) );
	int k = rng.integer( 0, 5 );
	Point a = mesh.at( t, k % 3 ), b = mesh.at( t, ( k + 1 ) % 3 );
	if ( k >= 3 )
	{
		return pointOf( rng, mesh, t );
	}
	double share = rng.integer( 0, 2 ) == 0 ? 0.0 : rng.uniform( 0, 1 );
	return { a[0] + share * ( b[0] - a[0] ), a[1] + share * ( b[1] - a[1] ), a[2] + share * ( b[2] - a[2] ) };
}

/// Looks for a point of the shape outside of the coarser one, and for one of the coarser one that is too far away.
void hunt( SeededRng& rng, const lw_shape* shape, const lw_shape* coarse, double tolerance, int points )
{
	lw_shape_info info = lw_shape_get_info( coarse );
	Mesh whole = meshOf( shape ), fewer = meshOf( coarse );
	double radius = radiusOf( coarse ), rounding = 1e-12 * ( 1 + info.sphere_radius );
	ASSERT_LE( info.excess, tolerance );
	ASSERT_LE( radius, info.excess );
	ASSERT_LE( info.triangle_count, info.original_count );
	for ( int i = 0; i < points; ++i )
	{
		Point p = suspectOf( rng, whole ), q = suspectOf( rng, fewer );
		ASSERT_LE( toSurface( p, fewer ), radius + rounding ) << p[0] << " " << p[1] << " " << p[2];
		ASSERT_LE( toSurface( q, whole ), info.excess - radius + rounding ) << q[0] << " " << q[1] << " " << q[2];
		for ( std::size_t k = 0; k < 3; ++k )
		{
			ASSERT_GE( p[k], info.box_min[k] );
			ASSERT_LE( p[k], info.box_max[k] );
		}
	}
	EXPECT_EQ( lwi_shape_validate( coarse, nullptr ), LW_OK );
}

/// A grid of n x n squares over one metre; heights by f( x, y ).
template <typename F> Mesh sheet( int n, F f )
{
	Mesh mesh;
	for ( int i = 0; i <= n; ++i )
	{
		for ( int k = 0; k <= n; ++k )
		{
			double x = double( i ) / n, y = double( k ) / n;
			mesh.vertex( x, y, f( x, y ) );
		}
	}
	auto id = [&]( int i, int k ) { return static_cast<uint32_t>( i * ( n + 1 ) + k ); };
	for ( int i = 0; i < n; ++i )
	{
		for ( int k = 0; k < n; ++k )
		{
			mesh.quad( id( i, k ), id( i + 1, k ), id( i + 1, k + 1 ), id( i, k + 1 ) );
		}
	}
	return mesh;
}

Mesh randomMesh( SeededRng& rng, int kind )
{
	switch ( kind )
	{
	case 0:
		return bumpyMesh( rng, rng.uniform( 0.02, 0.3 ), rng.integer( 4, 14 ), rng.integer( 4, 18 ) );
	case 1:
		return torusMesh( rng.uniform( 0.05, 0.3 ), rng.uniform( 0.005, 0.04 ), rng.integer( 5, 24 ), rng.integer( 3, 12 ) );
	case 2:
	{
		double amplitude = rng.decade( -4, -1 ), f = rng.uniform( 1, 12 ), g = rng.uniform( 1, 12 );
		return sheet(
		    rng.integer( 3, 14 ), [&]( double x, double y ) { return amplitude * std::sin( f * x ) * std::cos( g * y ); } );
	}
	case 3: // thin plates, one inside the other: a triangle near both sides may replace both
	{
		Mesh mesh = boxMesh( 0.2, 0.1, 0.001 );
		mesh.add( boxMesh( 0.1, 0.05, 0.0005, { 0.02, 0, 0 }, true ) );
		mesh.add( boxMesh( 0.002, 0.002, 0.002, { 0, 0, rng.uniform( 0, 0.01 ) } ) );
		return mesh;
	}
	default: // a soup: nothing hangs together, corners anywhere, some triangles are segments or points
	{
		Mesh mesh;
		for ( int i = 0; i < 60; ++i )
		{
			Point c = { rng.uniform( 0, 0.1 ), rng.uniform( 0, 0.1 ), rng.uniform( 0, 0.1 ) };
			double size = rng.decade( -4, -1 );
			uint32_t v[3];
			for ( uint32_t& vertex : v )
			{
				vertex = mesh.vertex(
				    c[0] + rng.uniform( 0, size ), c[1] + rng.uniform( 0, size ), c[2] + rng.uniform( 0, size ) );
			}
			bool flat = rng.integer( 0, 9 ) == 0;
			mesh.triangle( v[0], v[1], flat ? v[rng.integer( 0, 1 )] : v[2] );
			if ( rng.integer( 0, 3 ) == 0 && i > 0 )
			{
				mesh.triangle( v[0], v[1], v[0] - 1 ); // hangs together with the one before
			}
		}
		return mesh;
	}
	}
}

} // namespace

// A collapse that is accepted by its corners alone leaves parts of the shape outside; one that is accepted by samples of one
// side lets the coarser one grow where nothing is.
TEST( Detail, ContainsTheShapeAndStaysNearIt )
{
	SeededRng rng;
	for ( int i = 0; i < 60; ++i )
	{
		ShapePtr shape = randomMesh( rng, i % 5 ).shape();
		double tolerance = rng.decade( -4, -1 );
		SCOPED_TRACE( testing::Message() << "mesh " << i << " tolerance " << tolerance );
		hunt( rng, shape.get(), coarser( shape.get(), tolerance ).get(), tolerance, 400 );
		if ( HasFatalFailure() )
		{
			return;
		}
	}
}

TEST( Detail, DistancesAreBelowTheTrueOnesByAtMostTheExcess )
{
	SeededRng rng;
	QueryPtr query = makeQuery();
	for ( int i = 0; i < 30; ++i )
	{
		ShapePtr shape = randomMesh( rng, i % 5 ).shape(), coarse = coarser( shape.get(), rng.decade( -4, -1.5 ) );
		ShapePtr others[] = { randomMesh( rng, ( i + 2 ) % 5 ).shape(), makePrimitive( LW_SHAPE_BOX, 0.1, 0.2, 0.05 ),
		    makePrimitive( LW_SHAPE_CAPSULE, 0.02, 0.1 ), makePrimitive( LW_SHAPE_SPHERE, 0.03 ) };
		for ( const ShapePtr& other : others )
		{
			for ( int k = 0; k < 10; ++k )
			{
				lw_transform a = randomPose( rng, 0.3 ), b = randomPose( rng, 0.3 );
				lw_clearance exact, bound;
				ASSERT_EQ( lw_shape_distance( shape.get(), &a, other.get(), &b, nullptr, query.get(), &exact ), LW_OK );
				ASSERT_EQ( lw_shape_distance( coarse.get(), &a, other.get(), &b, nullptr, query.get(), &bound ), LW_OK );
				double excess = lw_shape_get_info( coarse.get() ).excess;
				EXPECT_LE( bound.lower, exact.upper );
				EXPECT_GE( bound.upper + 1e-12, exact.lower - excess );
				if ( bound.lower > 0 && bound.upper > 1e-9 )
				{
					EXPECT_NEAR( std::hypot( bound.point_a.x - bound.point_b.x, bound.point_a.y - bound.point_b.y,
					                 bound.point_a.z - bound.point_b.z ),
					    bound.upper, 1e-9 );
				}
			}
		}
	}
}

TEST( Detail, FineMeshesGetFarFewerTriangles )
{
	ShapePtr flat = sheet( 40, []( double, double ) { return 0.0; } ).shape();
	EXPECT_LE( lw_shape_get_info( coarser( flat.get(), 1e-3 ).get() ).triangle_count, 20u ) << "of 3200 in one plane";
	ShapePtr torus = torusMesh( 0.2, 0.05, 96, 48 ).shape();
	lw_shape_info info = lw_shape_get_info( coarser( torus.get(), 4e-3 ).get() );
	EXPECT_EQ( info.original_count, 9216u );
	EXPECT_LE( info.triangle_count, 1800u );
	EXPECT_GT( info.excess, 0 );
	EXPECT_LT( info.bytes, lw_shape_get_info( torus.get() ).bytes / 3 );
}

TEST( Detail, ShapesThatCannotGainStayThemselves )
{
	Mesh box = boxMesh( 0.3, 0.2, 0.1 );
	lw_mesh_def def = lw_mesh_def_default();
	def.vertices = box.vertices.data();
	def.vertex_count = static_cast<uint32_t>( box.vertices.size() / 3 );
	def.indices = box.triangles.data();
	def.triangle_count = static_cast<uint32_t>( box.count() );
	def.solid = true;
	lw_shape* solid = nullptr;
	ASSERT_EQ( lw_shape_create_mesh( &def, nullptr, nullptr, &solid ), LW_OK );
	const double cells[12] = { 0, 0, 0, 1, 1, 1, 1, 0, 0, 2, 1, 1 };
	lw_shape* boxes = nullptr;
	ASSERT_EQ( lw_shape_create_boxes( cells, 2, nullptr, nullptr, nullptr, &boxes ), LW_OK );
	ShapePtr shapes[] = { box.shape(), ShapePtr( solid ), ShapePtr( boxes ), makePrimitive( LW_SHAPE_CYLINDER, 0.1, 0.2 ),
	    makePrimitive( LW_SHAPE_SPHERE, 0.1 ), makePrimitive( LW_SHAPE_HALFSPACE, 0 ) };
	for ( const ShapePtr& shape : shapes )
	{
		ShapePtr same = coarser( shape.get(), 1e-3 );
		EXPECT_EQ( same.get(), shape.get() );
		EXPECT_EQ( lw_shape_get_info( same.get() ).excess, 0 );
	}
}

TEST( Detail, SetsOfBallsAreContainedToo )
{
	SeededRng rng;
	for ( int round = 0; round < 6; ++round )
	{
		bool one_radius = round % 2 == 0;
		std::vector<double> points, balls;
		for ( int i = 0; i < 3000; ++i )
		{
			for ( int k = 0; k < 3; ++k )
			{
				points.push_back( rng.uniform( 0, 0.2 ) + ( round > 3 ? 100 : 0 ) );
				balls.push_back( points.back() );
			}
			balls.push_back( one_radius ? 0.002 : rng.decade( -4, -2 ) );
		}
		lw_shape* raw = nullptr;
		ASSERT_EQ( one_radius ? lw_shape_create_points( points.data(), 3000, 0.002, nullptr, nullptr, nullptr, &raw )
		                      : lw_shape_create_spheres( balls.data(), 3000, nullptr, nullptr, nullptr, &raw ),
		    LW_OK );
		ShapePtr shape( raw ), coarse = coarser( raw, 0.02 );
		lw_shape_info info = lw_shape_get_info( coarse.get() );
		EXPECT_LT( info.vertex_count, 1500u );
		EXPECT_EQ( info.original_count, 3000u );
		EXPECT_EQ( info.type, lw_shape_get_info( raw ).type );
		ASSERT_LE( info.excess, 0.02 );
		auto at = [&]( uint32_t i )
		{
			const double* v = lw_shape_vertices( coarse.get() ) + 3 * i;
			return Point{ v[0], v[1], v[2] };
		};
		auto radius = [&]( uint32_t i ) { return one_radius ? info.dimensions[0] : lw_shape_radii( coarse.get() )[i]; };
		double worst = 0;
		for ( std::size_t i = 0; i < 3000; ++i )
		{
			Point p = { balls[4 * i], balls[4 * i + 1], balls[4 * i + 2] };
			double least = INFINITY;
			for ( uint32_t k = 0; k < info.vertex_count; ++k )
			{
				least = std::min( least, distance( p, at( k ) ) + balls[4 * i + 3] - radius( k ) );
			}
			ASSERT_LE( least, 0 ) << "ball " << i << " sticks out";
		}
		for ( uint32_t k = 0; k < info.vertex_count; ++k )
		{
			double least = INFINITY;
			for ( std::size_t i = 0; i < 3000; ++i )
			{
				Point p = { balls[4 * i], balls[4 * i + 1], balls[4 * i + 2] };
				least = std::min( least, distance( p, at( k ) ) + radius( k ) - balls[4 * i + 3] );
			}
			worst = std::max( worst, least );
		}
		EXPECT_LE( worst, info.excess );
	}
}

TEST( Detail, ACoarserOneOfACoarserOneAddsUp )
{
	SeededRng rng;
	ShapePtr shape = torusMesh( 0.2, 0.05, 48, 24 ).shape(), once = coarser( shape.get(), 1e-3 ),
	         twice = coarser( once.get(), 5e-3 );
	lw_shape_info first = lw_shape_get_info( once.get() ), second = lw_shape_get_info( twice.get() );
	EXPECT_LT( second.triangle_count, first.triangle_count );
	EXPECT_EQ( second.original_count, 2304u );
	EXPECT_GT( second.excess, first.excess );
	hunt( rng, shape.get(), twice.get(), 6e-3, 500 );
}

TEST( Detail, TwoRunsAreEqualToTheBit )
{
	SeededRng rng;
	ShapePtr shape = bumpyMesh( rng, 0.2, 20, 30 ).shape();
	EXPECT_TRUE( lw_digest_equal(
	    lw_shape_digest( coarser( shape.get(), 1e-2 ).get() ), lw_shape_digest( coarser( shape.get(), 1e-2 ).get() ) ) );
}

TEST( Detail, BadInputIsNamed )
{
	ShapePtr shape = boxMesh( 1, 1, 1 ).shape();
	for ( double tolerance : { 0.0, -1.0, double( NAN ), double( INFINITY ) } )
	{
		lw_shape* out = shape.get();
		lw_diag diag = {};
		EXPECT_EQ(
		    lw_shape_create_detail( shape.get(), tolerance, nullptr, nullptr, &diag, &out ), LW_ERROR_INVALID_ARGUMENT );
		EXPECT_EQ( out, nullptr );
		EXPECT_NE( std::strstr( diag.message, "tolerance" ), nullptr ) << diag.message;
	}
	lw_shape* out = nullptr;
	EXPECT_EQ( lw_shape_create_detail( nullptr, 1, nullptr, nullptr, nullptr, &out ), LW_ERROR_INVALID_ARGUMENT );
	EXPECT_EQ( lw_shape_create_detail( shape.get(), 1, nullptr, nullptr, nullptr, nullptr ), LW_ERROR_INVALID_ARGUMENT );
	lw_tree_def tiled = lw_tree_def_default();
	tiled.tile_radius = 0.1;
	EXPECT_EQ( lw_shape_create_detail( shape.get(), 1, &tiled, nullptr, nullptr, &out ), LW_ERROR_INVALID_ARGUMENT );
}

TEST( Detail, EveryFailedAllocationIsToldAndNothingLeaks )
{
	ShapePtr mesh = torusMesh( 0.2, 0.05, 24, 12 ).shape();
	std::vector<double> points;
	for ( int i = 0; i < 300; ++i )
	{
		points.push_back( 1e-3 * ( i % 7 ) );
	}
	lw_shape* raw = nullptr;
	ASSERT_EQ( lw_shape_create_points( points.data(), 100, 0, nullptr, nullptr, nullptr, &raw ), LW_OK );
	ShapePtr set( raw );
	for ( const lw_shape* shape : { mesh.get(), set.get() } )
	{
		bool done = false;
		for ( std::size_t fail_at = 1; !done; ++fail_at )
		{
			FailingAllocator counting;
			counting.fail_at = fail_at;
			lw_shape* out = nullptr;
			lw_status status = lw_shape_create_detail( shape, 3e-2, nullptr, &counting.allocator, nullptr, &out );
			done = status == LW_OK;
			ASSERT_TRUE( done || status == LW_ERROR_OUT_OF_MEMORY ) << lw_status_name( status );
			EXPECT_EQ( out != nullptr, done );
			EXPECT_NE( out, shape );
			lw_shape_release( out );
			EXPECT_EQ( counting.live, 0u ) << "failing at " << fail_at;
		}
	}
}

// Meshes as they are drawn: shells in shells, slivers, holes, corners where many triangles meet.
TEST( Detail, HoldsForTheMeshesOfARobotAndAKitchen )
{
	SeededRng rng;
	QueryPtr query = makeQuery();
	const double origin[3] = { 0, 0, 0 };
	lw_shape* raw = nullptr;
	ASSERT_EQ( lw_shape_create_points( origin, 1, 0, nullptr, nullptr, nullptr, &raw ), LW_OK );
	ShapePtr probe( raw );
	int meshes = 0;
	for ( const char* folder : { "/armar3/meshes/full", "/kit_kitchen/meshes" } )
	{
		std::error_code error;
		for ( const auto& entry : std::filesystem::directory_iterator( std::string( LEEWAY_DATA_DIR ) + folder, error ) )
		{
			if ( entry.path().extension() != ".stl" || entry.file_size() > 84 + 50 * 700 || ++meshes % 2 == 0 )
			{
				continue;
			}
			SCOPED_TRACE( entry.path().string() );
			std::ifstream file( entry.path(), std::ios::binary );
			Mesh mesh;
			char record[50];
			file.seekg( 84 );
			while ( file.read( record, sizeof( record ) ) )
			{
				float f[12];
				std::memcpy( f, record, sizeof( f ) );
				uint32_t a = mesh.vertex( f[3], f[4], f[5] ), b = mesh.vertex( f[6], f[7], f[8] );
				mesh.triangle( a, b, mesh.vertex( f[9], f[10], f[11] ) );
			}
			double tolerance = rng.decade( -3.5, -2 );
			ShapePtr shape = mesh.shape(), coarse = coarser( shape.get(), tolerance );
			lw_shape_info info = lw_shape_get_info( coarse.get() );
			Mesh fewer = meshOf( coarse.get() );
			ASSERT_LE( info.excess, tolerance );
			auto apart = [&]( const lw_shape* from, const Point& p )
			{
				lw_transform here = lw_transform_identity(), there = at( p[0], p[1], p[2] );
				lw_clearance c;
				EXPECT_EQ( lw_shape_distance( from, &here, probe.get(), &there, nullptr, query.get(), &c ), LW_OK );
				return c.lower;
			};
			for ( int i = 0; i < 500; ++i )
			{
				ASSERT_EQ( apart( coarse.get(), suspectOf( rng, mesh ) ), 0 );
				ASSERT_LE( apart( shape.get(), suspectOf( rng, fewer ) ), info.excess - radiusOf( coarse.get() ) + 1e-12 );
			}
		}
	}
	if ( meshes == 0 )
	{
		GTEST_SKIP() << "no meshes under " << LEEWAY_DATA_DIR;
	}
}
