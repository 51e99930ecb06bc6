// SPDX-License-Identifier: BSD-3-Clause
// Mesh creation: welding, degenerate triangles, bad input, failing memory, determinism.
#include "shape/shape.h"
#include "shape_support.hpp"

#include <cstring>
#include <limits>

namespace
{

/// A flat grid of n x n cells as a soup of separate triangles, every vertex repeated.
Soup gridSoup( int n, double cell )
{
	Soup soup;
	for ( int i = 0; i < n; ++i )
	{
		for ( int j = 0; j < n; ++j )
		{
			double x = i * cell, y = j * cell;
			soup.add( { x, y, 0 }, { x + cell, y, 0 }, { x + cell, y + cell, 0 } );
			soup.add( { x, y, 0 }, { x + cell, y + cell, 0 }, { x, y + cell, 0 } );
		}
	}
	return soup;
}

lw_status create( const lw_mesh_def& def, lw_diag& diag )
{
	lw_shape* shape = reinterpret_cast<lw_shape*>( &diag ); // must be overwritten on failure
	lw_status status = lw_shape_create_mesh( &def, nullptr, &diag, &shape );
	EXPECT_EQ( shape == nullptr, status != LW_OK );
	if ( status != LW_OK )
	{
		EXPECT_EQ( diag.status, status );
		EXPECT_GT( std::strlen( diag.message ), 10u );
	}
	lw_shape_release( shape );
	return status;
}

} // namespace

TEST( Mesh, ExactDuplicatesAreWelded )
{
	ShapePtr shape = makeMesh( gridSoup( 20, 0.5 ) );
	lw_shape_info info = lw_shape_get_info( shape.get() );
	EXPECT_EQ( info.vertex_count, 21u * 21u );
	EXPECT_EQ( info.triangle_count, 800u );
	EXPECT_EQ( info.degenerate_count, 0u );
	EXPECT_EQ( info.type, LW_SHAPE_MESH );
}

TEST( Mesh, NegativeZeroIsZero )
{
	Soup soup;
	soup.add( { 0.0, 0.0, 0.0 }, { 1, 0, 0 }, { 0, 1, 0 } );
	soup.add( { -0.0, 0.0, -0.0 }, { 1, -0.0, 0 }, { -0.0, 1, 1 } );
	EXPECT_EQ( lw_shape_get_info( makeMesh( soup ).get() ).vertex_count, 4u );
}

TEST( Mesh, TriangleOrderAndCornersSurviveWelding )
{
	SeededRng rng;
	Soup soup = randomSoup( rng, 300, 1.0, 0.5 );
	soup.triangles[7] = soup.triangles[100]; // leaves three vertices unused
	ShapePtr shape = makeMesh( soup );
	EXPECT_EQ( lw_shape_get_info( shape.get() ).vertex_count, 3u * 299u );
	const double* v = lw_shape_vertices( shape.get() );
	const std::uint32_t* t = lw_shape_triangles( shape.get() );
	for ( std::size_t i = 0; i < 900; ++i )
	{
		const Point& p = soup.vertices[soup.triangles[i / 3][i % 3]];
		EXPECT_EQ( 0, std::memcmp( v + 3 * static_cast<std::size_t>( t[i] ), p.data(), sizeof( p ) ) );
	}
}

TEST( Mesh, ToleranceWeldsNeighboursAndMovesNoVertexFurther )
{
	SeededRng rng;
	for ( double tolerance : { 1e-6, 1e-3, 0.1, 10.0 } )
	{
		Soup soup = gridSoup( 12, 0.25 );
		for ( Point& p : soup.vertices )
		{
			for ( double& x : p )
			{
				x += rng.uniform( -0.25, 0.25 ) * tolerance; // at most 0.87 tolerance apart
			}
		}
		lw_mesh_def def = soup.def();
		def.weld_tolerance = tolerance;
		ShapePtr shape = makeMesh( def );
		lw_shape_info info = lw_shape_get_info( shape.get() );
		if ( tolerance < 0.1 )
		{
			EXPECT_EQ( info.vertex_count, 13u * 13u );
			EXPECT_EQ( info.degenerate_count, 0u );
		}
		EXPECT_EQ( info.triangle_count, soup.triangles.size() );
		const double* v = lw_shape_vertices( shape.get() );
		const std::uint32_t* t = lw_shape_triangles( shape.get() );
		for ( std::size_t i = 0; i < 3 * soup.triangles.size(); ++i )
		{
			Point q;
			std::copy( v + 3 * t[i], v + 3 * t[i] + 3, q.begin() );
			EXPECT_LE( distance( soup.vertices[i], q ), tolerance * ( 1 + 1e-12 ) );
		}
	}
	// everything within one tolerance: one point, all triangles degenerate, still a valid shape
	lw_mesh_def all = lw_mesh_def_default();
	Soup soup = gridSoup( 3, 0.1 );
	all = soup.def();
	all.weld_tolerance = 1e200;
	ShapePtr shape = makeMesh( all );
	EXPECT_EQ( lw_shape_get_info( shape.get() ).vertex_count, 1u );
	EXPECT_EQ( lw_shape_get_info( shape.get() ).degenerate_count, 18u );
	expectSoundTree( shape.get() );
}

// A tolerance below the spacing of doubles must neither weld nor send all vertices into one bucket.
TEST( Mesh, TinyToleranceIsExactWelding )
{
	SeededRng rng;
	Soup soup = randomSoup( rng, 3000, 1e6, 1.0 );
	for ( double tolerance : { 1e-300, 1e-30, 1e-12 } )
	{
		lw_mesh_def def = soup.def();
		def.weld_tolerance = tolerance;
		EXPECT_EQ( lw_shape_get_info( makeMesh( def ).get() ).vertex_count, 9000u );
	}
}

TEST( Mesh, DegenerateTrianglesAreKeptAndCounted )
{
	Soup soup;
	soup.add( { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 } );
	soup.add( { 1, 1, 1 }, { 1, 1, 1 }, { 2, 2, 2 } );                   // segment
	soup.add( { 5, 5, 5 }, { 5, 5, 5 }, { 5, 5, 5 } );                   // point
	soup.add( { 0.1, 0.2, 0.3 }, { 0.4, 0.8, 1.2 }, { 0.7, 1.4, 2.1 } ); // collinear but for rounding
	ShapePtr shape = makeMesh( soup );
	lw_shape_info info = lw_shape_get_info( shape.get() );
	EXPECT_EQ( info.triangle_count, 4u );
	EXPECT_EQ( info.degenerate_count, 3u );
	EXPECT_EQ( info.box_max[2], 5.0 );
	expectSoundTree( shape.get() );
}

TEST( Mesh, ScaleMirrorsAndStretches )
{
	SeededRng rng;
	Soup soup = randomSoup( rng, 200, 1.0, 0.2 );
	lw_mesh_def def = soup.def();
	def.scale[0] = -0.001;
	def.scale[2] = 3.0;
	ShapePtr shape = makeMesh( def );
	Point low = { 1e9, 1e9, 1e9 }, high = { -1e9, -1e9, -1e9 };
	for ( const Point& p : soup.vertices )
	{
		for ( int k = 0; k < 3; ++k )
		{
			low[k] = std::min( low[k], p[k] * def.scale[k] );
			high[k] = std::max( high[k], p[k] * def.scale[k] );
		}
	}
	lw_shape_info info = lw_shape_get_info( shape.get() );
	for ( int k = 0; k < 3; ++k )
	{
		EXPECT_EQ( info.box_min[k], low[k] );
		EXPECT_EQ( info.box_max[k], high[k] );
	}
	expectSoundTree( shape.get() );
}

TEST( Mesh, BadInputIsNamed )
{
	SeededRng rng;
	const Soup good = randomSoup( rng, 20, 1.0, 0.2 );
	lw_diag diag = {};
	for ( double bad : { std::nan( "" ), double( INFINITY ), -double( INFINITY ), 2e9, 1e300 } )
	{
		Soup soup = good;
		soup.vertices[37][1] = bad;
		EXPECT_EQ( create( soup.def(), diag ), LW_ERROR_BAD_GEOMETRY ) << bad;
		EXPECT_EQ( diag.index, 37u );
	}
	Soup soup = good;
	soup.triangles[11][2] = 60;
	EXPECT_EQ( create( soup.def(), diag ), LW_ERROR_BAD_GEOMETRY );
	EXPECT_EQ( diag.index, 11u );
	soup.triangles.clear();
	EXPECT_EQ( create( soup.def(), diag ), LW_ERROR_BAD_GEOMETRY );
	EXPECT_NE( std::strstr( diag.message, "no triangles" ), nullptr );

	auto expectInvalid = [&]( auto&& change )
	{
		lw_mesh_def def = good.def();
		change( def );
		EXPECT_EQ( create( def, diag ), LW_ERROR_INVALID_ARGUMENT ) << diag.message;
	};
	for ( double bad : { 0.0, std::nan( "" ), double( INFINITY ) } )
	{
		expectInvalid( [&]( lw_mesh_def& d ) { d.scale[1] = bad; } );
	}
	for ( double bad : { -1e-9, std::nan( "" ), double( INFINITY ) } )
	{
		expectInvalid( [&]( lw_mesh_def& d ) { d.weld_tolerance = bad; } );
		expectInvalid( [&]( lw_mesh_def& d ) { d.tree.tile_radius = bad; } );
	}
	expectInvalid( []( lw_mesh_def& d ) { d.tree.leaf_size = 0; } );
	expectInvalid( []( lw_mesh_def& d ) { d.tree.leaf_size = 9; } );
	expectInvalid( []( lw_mesh_def& d ) { d.tree.fit = static_cast<lw_sphere_fit>( 0 ); } );
	expectInvalid( []( lw_mesh_def& d ) { d.vertices = nullptr; } );
	expectInvalid( []( lw_mesh_def& d ) { d.indices = nullptr; } );

	lw_mesh_def zeroed = {};
	EXPECT_EQ( create( zeroed, diag ), LW_ERROR_INVALID_DEF );
	lw_shape* shape = nullptr;
	EXPECT_EQ( lw_shape_create_mesh( nullptr, nullptr, &diag, &shape ), LW_ERROR_INVALID_ARGUMENT );
	EXPECT_EQ( lw_shape_create_mesh( &zeroed, nullptr, nullptr, nullptr ), LW_ERROR_INVALID_ARGUMENT );
}

// Memory that ends at call 1, 2, 3, ... : a status each time, nothing left behind, and at last success.
TEST( Mesh, EveryFailedAllocationIsCleanedUp )
{
	SeededRng rng;
	const Soup soup = randomSoup( rng, 2000, 1.0, 0.2 );
	for ( double tile : { 0.0, 0.05 } )
	{
		for ( lw_sphere_fit fit : { LW_FIT_GREEDY, LW_FIT_MINIMAL } )
		{
			lw_mesh_def def = soup.def();
			def.tree = { fit, 4, tile };
			def.weld_tolerance = 1e-3;
			long failures = 0;
			for ( ;; ++failures )
			{
				CountingAllocator memory;
				memory.failAt = failures + 1;
				lw_allocator allocator = memory.get();
				lw_diag diag = {};
				lw_shape* shape = nullptr;
				lw_status status = lw_shape_create_mesh( &def, &allocator, &diag, &shape );
				if ( status == LW_OK )
				{
					EXPECT_EQ( memory.live, lw_shape_get_info( shape ).bytes ) << "info.bytes is what the shape holds";
					memory.failAt = memory.calls + 1;
					EXPECT_EQ( lwi_shape_validate( shape, &diag ), LW_ERROR_OUT_OF_MEMORY );
					lw_shape_release( shape );
					EXPECT_EQ( memory.live, 0u );
					break;
				}
				ASSERT_EQ( status, LW_ERROR_OUT_OF_MEMORY );
				ASSERT_EQ( shape, nullptr );
				ASSERT_EQ( memory.live, 0u ) << "leak after a failure at call " << failures + 1;
			}
			EXPECT_GT( failures, 15 );
		}
	}
}

// Equal input gives equal bytes, whatever was in the memory before.
TEST( Mesh, BuildIsDeterministic )
{
	SeededRng rng;
	const Soup soup = randomSoup( rng, 3000, 1.0, 0.1 );
	for ( lw_sphere_fit fit : { LW_FIT_GREEDY, LW_FIT_COMPACT, LW_FIT_MINIMAL } )
	{
		for ( double tile : { 0.0, 0.03 } )
		{
			lw_mesh_def def = soup.def();
			def.tree = { fit, 7, tile };
			def.weld_tolerance = 0.01;
			CountingAllocator memory;
			memory.calls = 1; // other garbage than below
			lw_allocator allocator = memory.get();
			{
				ShapePtr first = makeMesh( def, &allocator ), second = makeMesh( def );
				const lw_shape &a = *first, &b = *second;
				ASSERT_EQ( a.node_count, b.node_count );
				ASSERT_EQ( a.leaf_count, b.leaf_count );
				EXPECT_EQ( 0, std::memcmp( a.nodes, b.nodes, a.node_count * sizeof( lwi_node ) ) );
				EXPECT_EQ( 0, std::memcmp( a.leaves, b.leaves, a.leaf_count * sizeof( lwi_leaf ) ) );
				EXPECT_EQ( 0, std::memcmp( a.root_sphere, b.root_sphere, sizeof( a.root_sphere ) ) );
			}
			EXPECT_EQ( memory.live, 0u );
		}
	}
}
