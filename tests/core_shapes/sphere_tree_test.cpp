// SPDX-License-Identifier: BSD-3-Clause
// Sphere trees: containment, tightness, tiles, and inputs made to break the builder.
#include "shape/shape.h"
#include "shape_support.hpp"

#include <cstring>

#include "shape/sphere_fit.h"

namespace
{

const lw_sphere_fit all_fits[] = { LW_FIT_GREEDY, LW_FIT_COMPACT, LW_FIT_MINIMAL };

/// A closed surface: a torus of 2 n^2 triangles.
Soup torus( int n, double large, double small )
{
	Soup soup;
	double turn = 2 * std::acos( -1.0 ) / n;
	for ( int i = 0; i < n; ++i )
	{
		for ( int j = 0; j < n; ++j )
		{
			double r = large + small * std::cos( j * turn );
			soup.vertices.push_back( { r * std::cos( i * turn ), r * std::sin( i * turn ), small * std::sin( j * turn ) } );
			auto at = [n]( int a, int b ) { return static_cast<std::uint32_t>( a % n * n + b % n ); };
			soup.triangles.push_back( { at( i, j ), at( i + 1, j ), at( i + 1, j + 1 ) } );
			soup.triangles.push_back( { at( i, j ), at( i + 1, j + 1 ), at( i, j + 1 ) } );
		}
	}
	return soup;
}

double mean( const std::vector<double>& values )
{
	double sum = 0;
	for ( double v : values )
	{
		sum += v;
	}
	return sum / static_cast<double>( values.size() );
}

double sumOfRadii( const TreeStats& stats )
{
	double sum = 0;
	for ( const auto& level : stats.radii )
	{
		for ( double r : level )
		{
			sum += r;
		}
	}
	return sum;
}

} // namespace

TEST( SphereTree, SpheresContainTheirGeometry )
{
	SeededRng rng;
	for ( int round = 0; round < 60; ++round )
	{
		double spread = rng.decade( -9, 8.5 );
		double size = spread * rng.decade( -3, 0.3 );
		Point center = { 0, 0, 0 };
		if ( round % 3 == 0 )
		{
			center = { rng.uniform( -5e8, 5e8 ), rng.uniform( -5e8, 5e8 ), rng.uniform( -5e8, 5e8 ) };
		}
		Soup soup = randomSoup( rng, rng.integer( 1, 600 ), std::min( spread, 1e8 ), std::min( size, 1e8 ), center );
		for ( lw_sphere_fit fit : all_fits )
		{
			auto leafSize = static_cast<std::uint32_t>( rng.integer( 1, 8 ) );
			ShapePtr shape = makeMesh( soup, fit, leafSize );
			ASSERT_NE( shape, nullptr );
			SCOPED_TRACE( "fit " + std::to_string( fit ) + " leaf size " + std::to_string( leafSize ) );
			expectSoundTree( shape.get() );
			// the public bounds, in the shape frame
			lw_shape_info info = lw_shape_get_info( shape.get() );
			for ( const Point& p : soup.vertices )
			{
				long double d = 0;
				for ( int k = 0; k < 3; ++k )
				{
					EXPECT_TRUE( info.box_min[k] <= p[k] && p[k] <= info.box_max[k] );
					long double e = static_cast<long double>( p[k] ) - info.sphere_center[k];
					d += e * e;
				}
				EXPECT_LE( std::sqrt( d ), static_cast<long double>( info.sphere_radius ) );
			}
		}
	}
}

TEST( SphereTree, MinimalNodesAreMinimal )
{
	Soup soup = torus( 40, 1.0, 0.3 );
	ShapePtr shape = makeMesh( soup );
	// every leaf sphere against the fit of exactly the leaf's vertices
	std::vector<std::uint32_t> open = { shape->root };
	int leaves = 0;
	while ( !open.empty() )
	{
		std::uint32_t node = open.back();
		open.pop_back();
		for ( std::uint32_t lane = 0; lane < LWI_WIDTH; ++lane )
		{
			const lwi_node& n = shape->nodes[node];
			const float s[4] = { n.x[lane], n.y[lane], n.z[lane], n.r[lane] };
			const lwi_ref child = n.child[lane];
			if ( child == LW_INVALID_INDEX )
			{
				continue;
			}
			if ( !lwi_ref_is_leaf( child ) )
			{
				open.push_back( child );
				continue;
			}
			std::vector<Point> points;
			for ( std::uint32_t t = 0; t < lwi_ref_count( child ); ++t )
			{
				const std::array<Point, 3> v = leafTriangle( shape.get(), lwi_ref_index( child ), t );
				points.insert( points.end(), v.begin(), v.end() );
			}
			lwi_ball ball = lwi_fit_minimal( points[0].data(), points.size() );
			EXPECT_NEAR( s[3], ball.radius, 1e-6 * ball.radius + 2e-7 );
			++leaves;
		}
	}
	EXPECT_GT( leaves, 300 );
}

TEST( SphereTree, FitsAreOrderedAndLeavesAreFull )
{
	SeededRng rng;
	std::vector<Soup> soups = { torus( 60, 1.0, 0.3 ), randomSoup( rng, 6000, 1.0, 0.05 ) };
	for ( const Soup& soup : soups )
	{
		std::vector<TreeStats> stats;
		for ( lw_sphere_fit fit : all_fits )
		{
			stats.push_back( expectSoundTree( makeMesh( soup, fit ).get() ) );
		}
		const TreeStats &greedy = stats[0], &compact = stats[1], &minimal = stats[2];
		EXPECT_LT( sumOfRadii( minimal ), sumOfRadii( compact ) );
		EXPECT_LT( sumOfRadii( compact ), 0.97 * sumOfRadii( greedy ) );
		EXPECT_LT( sumOfRadii( compact ), 1.05 * sumOfRadii( minimal ) );
		ASSERT_EQ( greedy.radii.size(), minimal.radii.size() ) << "splits do not depend on the fit";
		for ( std::size_t level = 0; level < minimal.radii.size(); ++level )
		{
			EXPECT_LE( mean( minimal.radii[level] ), mean( compact.radii[level] ) * ( 1 + 1e-6 ) );
			EXPECT_LE( mean( compact.radii[level] ), mean( greedy.radii[level] ) );
		}
		EXPECT_GE( minimal.meanFill(), 6.0 );
		EXPECT_GE( static_cast<double>( minimal.children ) / minimal.nodes, 4.0 );
	}
}

TEST( SphereTree, MemoryPerTriangle )
{
	ShapePtr shape = makeMesh( torus( 80, 1.0, 0.3 ) );
	lw_shape_info info = lw_shape_get_info( shape.get() );
	EXPECT_LT( static_cast<double>( info.bytes ) / info.triangle_count, 120.0 );
}

TEST( SphereTree, TilesCoverTrianglesAndKeepTheirIndex )
{
	SeededRng rng;
	Soup soup = randomSoup( rng, 60, 1.0, 1.0 );
	soup.add( { 0, 0, 0 }, { 2, 0, 0 }, { 1, 1e-12, 0 } ); // sliver
	soup.add( { 0, 0, 0 }, { 0, 0, 0 }, { 0, 0, 2 } );     // segment
	for ( lw_sphere_fit fit : all_fits )
	{
		for ( double radius : { 0.03, 0.2, 10.0 } )
		{
			ShapePtr shape = makeMesh( soup, fit, 8, radius );
			TreeStats stats = expectSoundTree( shape.get(), true );
			EXPECT_EQ( lw_shape_get_info( shape.get() ).triangle_count, soup.triangles.size() );
			if ( radius == 10.0 )
			{
				EXPECT_EQ( stats.lanes, soup.triangles.size() );
				continue;
			}
			EXPECT_GT( stats.lanes, soup.triangles.size() * ( radius < 0.1 ? 20 : 2 ) );
			for ( std::uint32_t leaf = 0; leaf < stats.leaves; ++leaf )
			{
				const std::array<Point, 3> points = leafTriangle( shape.get(), leaf, 0 );
				EXPECT_LE( lwi_fit_minimal( points[0].data(), 3 ).radius, radius * ( 1 + 1e-5 ) );
			}
		}
	}
	// too many tiles is a status at once, not an exhausted machine
	for ( double radius : { 1e-5, 1e-30, 1e-300 } )
	{
		lw_mesh_def def = soup.def();
		def.tree.tile_radius = radius;
		lw_diag diag = {};
		lw_shape* shape = nullptr;
		EXPECT_EQ( lw_shape_create_mesh( &def, nullptr, &diag, &shape ), LW_ERROR_INVALID_ARGUMENT );
		EXPECT_NE( std::strstr( diag.message, "tile_radius" ), nullptr );
	}
	// one ulp wide and far away: there is no midpoint to bisect at
	Soup far;
	far.add( { 1e9, 1e9, 1e9 }, { std::nextafter( 1e9, 0 ), 1e9, 1e9 }, { 1e9, std::nextafter( 1e9, 0 ), 1e9 } );
	expectSoundTree( makeMesh( far, LW_FIT_MINIMAL, 8, 1e-8 ).get(), true );
}

TEST( SphereTree, OneTriangleIsOneLeaf )
{
	Soup soup;
	soup.add( { 1, 2, 3 }, { 1.5, 2, 3 }, { 1, 2.5, 3 } );
	for ( lw_sphere_fit fit : all_fits )
	{
		ShapePtr shape = makeMesh( soup, fit );
		TreeStats stats = expectSoundTree( shape.get() );
		EXPECT_EQ( stats.nodes, 0u );
		EXPECT_EQ( stats.leaves, 1u );
		EXPECT_EQ( stats.depth, 0u );
		EXPECT_NEAR( lw_shape_get_info( shape.get() ).sphere_radius, std::sqrt( 0.125 ), 1e-6 );
	}
}

TEST( SphereTree, IdenticalTrianglesAndPoints )
{
	Soup triangles, points;
	for ( int i = 0; i < 100000; ++i )
	{
		triangles.add( { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } );
		points.add( { 7, 7, 7 }, { 7, 7, 7 }, { 7, 7, 7 } );
	}
	for ( lw_sphere_fit fit : all_fits )
	{
		TreeStats stats = expectSoundTree( makeMesh( triangles, fit ).get() );
		EXPECT_LE( stats.depth, 6u ) << "equal centres must be halved, 12500 leaves are 5 levels";
		EXPECT_EQ( stats.leaves, 12500u );
		EXPECT_LE( expectSoundTree( makeMesh( points, fit, 1 ).get() ).depth, 7u );
	}
}

// Sizes in a geometric row make every cheap split cut off one item: without the fallback, the depth is the item count.
TEST( SphereTree, DepthIsBoundedForGeometricRows )
{
	SeededRng rng;
	std::uint32_t deepest = 0;
	for ( double ratio : { 1.01, 1.05, 1.3, 2.0 } )
	{
		for ( bool nested : { false, true } )
		{
			for ( std::uint32_t leafSize : { 1u, 8u } )
			{
				Soup soup;
				double x = 1e-9;
				for ( int i = 0; i < 4000; ++i )
				{
					double s = nested ? x : 0.1 * x;
					soup.add( { x, 0, 0 }, { x + s, s, 0 }, { x, 0, s } );
					x *= ratio;
					x = x > 4e8 ? 1e-9 * rng.uniform( 1, 2 ) : x;
				}
				for ( lw_sphere_fit fit : all_fits )
				{
					TreeStats stats = expectSoundTree( makeMesh( soup, fit, leafSize ).get() );
					deepest = std::max( deepest, stats.depth );
				}
			}
		}
	}
	EXPECT_LE( deepest, static_cast<std::uint32_t>( LWI_MAX_DEPTH ) );
	EXPECT_GE( deepest, 8u ) << "the input is not adversarial any more";
}

// Made against the builder: clusters that shrink towards the centre of the box. Each node spends all its lanes on the
// outermost cluster and leaves the rest to one child. Without the balanced fallback this tree is 30 levels deep.
TEST( SphereTree, DepthIsBoundedForShrinkingClusters )
{
	SeededRng rng;
	Soup soup;
	double size = 5e8;
	for ( double side : { -1.0, 1.0 } )
	{
		double x = side * 1.5 * size, w = 0.2 * size; // exactly opposite: the tree's origin is exactly 0
		soup.add( { x, -w, -w }, { x, w, w }, { x, 0, 0 } );
	}
	for ( int i = 0; i < 28; ++i, size *= 0.1 )
	{
		for ( int j = 0; j < 60; ++j )
		{
			Point p[3];
			for ( Point& q : p )
			{
				q = { size * rng.uniform( 1.0, 1.4 ), size * rng.uniform( -0.2, 0.2 ), size * rng.uniform( -0.2, 0.2 ) };
			}
			soup.add( p[0], p[1], p[2] );
		}
	}
	for ( lw_sphere_fit fit : all_fits )
	{
		TreeStats stats = expectSoundTree( makeMesh( soup, fit, 1 ).get() );
		EXPECT_GE( stats.depth, 22u ) << "the input is not adversarial any more";
	}
}

TEST( SphereTree, CollinearAndExtremeShapes )
{
	SeededRng rng;
	Soup line, needles, decades;
	for ( int i = 0; i < 3000; ++i )
	{
		double t = rng.uniform( -1, 1 );
		line.add( { t, 2 * t, 3 * t }, { t + 0.01, 2 * t + 0.02, 3 * t + 0.03 }, { t + 0.02, 2 * t + 0.04, 3 * t + 0.06 } );
		double h = 1e-9 * rng.uniform( 0, 1 );
		needles.add( { -1e6, t, 0 }, { 1e6, t, h }, { 1e6, t + h, 0 } );
		Point p[3];
		for ( Point& q : p )
		{
			for ( double& x : q )
			{
				x = rng.decade( -9, 9 ) * ( rng.integer( 0, 1 ) == 0 ? -1 : 1 );
			}
		}
		decades.add( p[0], p[1], p[2] );
	}
	for ( lw_sphere_fit fit : all_fits )
	{
		expectSoundTree( makeMesh( line, fit ).get() );
		expectSoundTree( makeMesh( needles, fit ).get() );
		expectSoundTree( makeMesh( decades, fit ).get() );
	}
}

TEST( SphereTree, AMillionTriangles )
{
	Soup soup = torus( 724, 1.0, 0.3 ); // 2^20 and a few
	ShapePtr shape = makeMesh( soup );
	lw_diag diag = {};
	EXPECT_EQ( lwi_shape_validate( shape.get(), &diag ), LW_OK ) << diag.message;
	lw_shape_info info = lw_shape_get_info( shape.get() );
	EXPECT_EQ( info.triangle_count, 2u * 724u * 724u );
	EXPECT_LE( info.depth, 12u );
	EXPECT_LT( static_cast<double>( info.bytes ) / info.triangle_count, 120.0 );
}

// A validation that finds nothing wrong in a damaged tree would make every other test here worthless.
TEST( SphereTree, ValidationSeesDamage )
{
	Soup soup = torus( 20, 1.0, 0.3 );
	int found = 0;
	for ( std::uint32_t lane = 0; lane < 3; ++lane )
	{
		ShapePtr shape = makeMesh( soup );
		lw_diag diag = {};
		ASSERT_EQ( lwi_shape_validate( shape.get(), &diag ), LW_OK );
		shape->nodes[0].r[lane] *= 0.999f;
		EXPECT_EQ( lwi_shape_validate( shape.get(), &diag ), LW_ERROR_BAD_GEOMETRY );
		EXPECT_EQ( diag.status, LW_ERROR_BAD_GEOMETRY );
		++found;
	}
	EXPECT_EQ( found, 3 );
	for ( std::uint32_t other : { 5u, 1000000u } )
	{
		ShapePtr shape = makeMesh( soup );
		std::uint32_t& triangle = shape->leaves[3].triangle[0];
		triangle = triangle == other ? 6u : other; // one triangle twice, or one that does not exist; another missing
		EXPECT_EQ( lwi_shape_validate( shape.get(), nullptr ), LW_ERROR_BAD_GEOMETRY );
	}
	// a float triangle that sticks out of its sphere while the original does not
	ShapePtr shape = makeMesh( soup );
	for ( auto& coordinate : shape->leaves[3].v[2] )
	{
		coordinate[1] = 9;
	}
	lw_diag diag = {};
	EXPECT_EQ( lwi_shape_validate( shape.get(), &diag ), LW_ERROR_BAD_GEOMETRY );
	EXPECT_NE( std::strstr( diag.message, "leaf triangle" ), nullptr ) << diag.message;
	// half a segment: inside its sphere, and of the right area
	Soup segment;
	segment.add( { 0, 0, 0 }, { 0, 0, 0 }, { 0, 0, 2 } );
	shape = makeMesh( segment );
	for ( std::uint32_t lane = 0; lane < LWI_WIDTH; ++lane )
	{
		for ( auto& coordinate : shape->leaves[0].v[2] )
		{
			coordinate[lane] = 0;
		}
	}
	EXPECT_EQ( lwi_shape_validate( shape.get(), nullptr ), LW_ERROR_BAD_GEOMETRY );
}

TEST( SphereTree, EveryLevelContainsTheShape )
{
	const Soup soup = torus( 40, 1.0, 0.3 );
	const ShapePtr shape = makeMesh( soup );
	const std::uint32_t depth = lw_shape_get_info( shape.get() ).depth;
	ASSERT_GE( depth, 2U );
	std::uint32_t before = 0;
	for ( std::uint32_t level = 0; level <= depth; ++level )
	{
		const std::uint32_t count = lw_shape_level_spheres( shape.get(), level, nullptr, 0 );
		EXPECT_GT( count, before ) << "deeper levels have more spheres";
		std::vector<double> spheres( 4 * count );
		EXPECT_EQ( lw_shape_level_spheres( shape.get(), level, spheres.data(), count ), count );
		for ( const Point& p : soup.vertices )
		{
			bool inside = false;
			for ( std::uint32_t i = 0; i < count; ++i )
			{
				const double* s = &spheres[4 * i];
				inside = inside || distance( p, { s[0], s[1], s[2] } ) <= s[3] * ( 1 + 1e-12 );
			}
			EXPECT_TRUE( inside ) << "level " << level;
		}
		before = count;
	}
	EXPECT_EQ( lw_shape_level_spheres( shape.get(), depth + 5, nullptr, 0 ), before );
	EXPECT_EQ( lw_shape_level_spheres( nullptr, 0, nullptr, 0 ), 0U );
	double guard[5] = { 0, 0, 0, 0, -1 }; // more spheres than room
	EXPECT_EQ( lw_shape_level_spheres( shape.get(), depth, guard, 1 ), before );
	EXPECT_EQ( guard[4], -1 );
	EXPECT_GT( guard[3], 0 );
}
