// SPDX-License-Identifier: BSD-3-Clause
// Primitives and point sets: bounds, bad dimensions, lifetime.
#include "shape/shape.h"
#include "shape_support.hpp"

#include <cstring>

namespace
{

ShapePtr makePrimitive( lw_shape_type type, double a, double b = 0, double c = 0 )
{
	double dimensions[3] = { a, b, c };
	lw_diag diag = {};
	lw_shape* shape = nullptr;
	EXPECT_EQ( lw_shape_create_primitive( type, dimensions, nullptr, &diag, &shape ), LW_OK ) << diag.message;
	return ShapePtr( shape );
}

/// Points on the surface of a primitive, its extreme ones among them.
std::vector<Point> surface( SeededRng& rng, lw_shape_type type, const double* d )
{
	std::vector<Point> points;
	for ( int i = 0; i < 400; ++i )
	{
		double angle = i < 8 ? i * std::acos( -1.0 ) / 4 : rng.uniform( 0, 7 );
		double top = i % 2 == 0 ? 0.5 : -0.5;
		Point n = { rng.normal(), rng.normal(), rng.normal() };
		double length = distance( n, { 0, 0, 0 } );
		double x = std::cos( angle ) * d[0], y = std::sin( angle ) * d[0];
		switch ( type )
		{
		case LW_SHAPE_BOX:
			points.push_back(
			    { ( i & 1 ? 0.5 : -0.5 ) * d[0], ( i & 2 ? 0.5 : -0.5 ) * d[1], ( i & 4 ? 0.5 : -0.5 ) * d[2] } );
			break;
		case LW_SHAPE_CYLINDER:
			points.push_back( { x, y, top * d[1] } );
			break;
		case LW_SHAPE_CONE:
			points.push_back( i == 0 ? Point{ 0, 0, 0.5 * d[1] } : Point{ x, y, -0.5 * d[1] } );
			break;
		default:
			points.push_back( { n[0] / length * d[0], n[1] / length * d[0],
			    n[2] / length * d[0] + ( type == LW_SHAPE_CAPSULE ? ( n[2] > 0 ? 0.5 : -0.5 ) * d[1] : 0.0 ) } );
			break;
		}
	}
	return points;
}

} // namespace

TEST( Primitives, BoundsContainTheSurfaceTightly )
{
	SeededRng rng;
	for ( lw_shape_type type : { LW_SHAPE_BOX, LW_SHAPE_SPHERE, LW_SHAPE_CYLINDER, LW_SHAPE_CAPSULE, LW_SHAPE_CONE } )
	{
		for ( int round = 0; round < 40; ++round )
		{
			double d[3] = { rng.decade( -6, 6 ), rng.decade( -6, 6 ), rng.decade( -6, 6 ) };
			ShapePtr shape = makePrimitive( type, d[0], d[1], d[2] );
			lw_shape_info info = lw_shape_get_info( shape.get() );
			EXPECT_EQ( info.type, type );
			EXPECT_EQ( info.triangle_count, 0u );
			EXPECT_EQ( info.vertex_count, 0u );
			EXPECT_EQ( info.depth, 0u );
			EXPECT_EQ( lw_shape_vertices( shape.get() ), nullptr );
			EXPECT_EQ( lw_shape_triangles( shape.get() ), nullptr );
			EXPECT_EQ( info.dimensions[0], d[0] );
			Point center;
			std::copy( info.sphere_center, info.sphere_center + 3, center.begin() );
			double largest = 0;
			for ( const Point& p : surface( rng, type, d ) )
			{
				largest = std::max( largest, distance( center, p ) );
				for ( int k = 0; k < 3; ++k )
				{
					EXPECT_GE( p[k], info.box_min[k] - 1e-14 * info.sphere_radius );
					EXPECT_LE( p[k], info.box_max[k] + 1e-14 * info.sphere_radius );
				}
			}
			EXPECT_LE( largest, info.sphere_radius * ( 1 + 1e-15 ) );
			double exact = type == LW_SHAPE_SPHERE ? d[0] : type == LW_SHAPE_CAPSULE ? d[0] + 0.5 * d[1] : largest;
			EXPECT_LE( info.sphere_radius, exact * ( 1 + 1e-6 ) );
			EXPECT_EQ( shape->primitive, type != LW_SHAPE_SPHERE && type != LW_SHAPE_CAPSULE );
			EXPECT_EQ( lwi_shape_validate( shape.get(), nullptr ), LW_OK );
		}
	}
}

// The sphere of a cone is the smallest one: through apex and rim, or on the base if that is wider.
TEST( Primitives, ConeSphereIsMinimal )
{
	EXPECT_NEAR( lw_shape_get_info( makePrimitive( LW_SHAPE_CONE, 1, 3 ).get() ).sphere_radius, 10.0 / 6, 1e-14 );
	EXPECT_NEAR( lw_shape_get_info( makePrimitive( LW_SHAPE_CONE, 1, 0.5 ).get() ).sphere_radius, 1.0, 1e-14 );
	EXPECT_NEAR( lw_shape_get_info( makePrimitive( LW_SHAPE_CONE, 1, 0.5 ).get() ).sphere_center[2], -0.25, 1e-14 );
}

TEST( Primitives, SphereIsABallAndCapsuleASegment )
{
	ShapePtr sphere = makePrimitive( LW_SHAPE_SPHERE, 0.25 ), capsule = makePrimitive( LW_SHAPE_CAPSULE, 0.1, 0.8 );
	const lw_shape &s = *sphere, &c = *capsule;
	EXPECT_EQ( s.item_count, 1u );
	EXPECT_EQ( s.radius, 0.25 );
	EXPECT_NEAR( s.root_sphere[3], 0.25, 1e-6 );
	EXPECT_GE( static_cast<double>( s.root_sphere[3] ), 0.25 );
	EXPECT_EQ( c.item_count, 1u );
	EXPECT_EQ( c.radius, 0.1 );
	EXPECT_EQ( c.vertices[3 * c.indices[0] + 2], -0.4 );
	EXPECT_EQ( c.vertices[3 * c.indices[1] + 2], 0.4 );
	EXPECT_EQ( c.indices[1], c.indices[2] );
	EXPECT_NEAR( c.root_sphere[3], 0.4, 1e-6 );
	EXPECT_EQ( lwi_shape_validate( makePrimitive( LW_SHAPE_CAPSULE, 0.1, 0.0 ).get(), nullptr ), LW_OK );
}

TEST( Primitives, BadDimensionsAreNamed )
{
	lw_diag diag = {};
	lw_shape* shape = nullptr;
	for ( double bad : { 0.0, -1.0, std::nan( "" ), double( INFINITY ), 1e10 } )
	{
		double d[3] = { 1, bad, 1 };
		for ( lw_shape_type type : { LW_SHAPE_BOX, LW_SHAPE_CYLINDER, LW_SHAPE_CONE, LW_SHAPE_CAPSULE } )
		{
			if ( type != LW_SHAPE_CAPSULE || bad != 0.0 )
			{
				EXPECT_EQ( lw_shape_create_primitive( type, d, nullptr, &diag, &shape ), LW_ERROR_BAD_GEOMETRY );
				EXPECT_EQ( diag.index, 1u );
				EXPECT_EQ( shape, nullptr );
			}
		}
	}
	double d[3] = { 1, 1, 1 };
	EXPECT_EQ( lw_shape_create_primitive( LW_SHAPE_MESH, d, nullptr, &diag, &shape ), LW_ERROR_INVALID_ARGUMENT );
	auto unknown = static_cast<lw_shape_type>( 99 );
	EXPECT_EQ( lw_shape_create_primitive( unknown, d, nullptr, &diag, &shape ), LW_ERROR_INVALID_ARGUMENT );
	EXPECT_EQ( lw_shape_create_primitive( LW_SHAPE_BOX, nullptr, nullptr, &diag, &shape ), LW_ERROR_INVALID_ARGUMENT );
}

TEST( Points, AreBallsOfOneRadius )
{
	SeededRng rng;
	std::vector<Point> points;
	for ( int i = 0; i < 5000; ++i )
	{
		points.push_back( { rng.normal(), rng.normal(), 3 + rng.normal() } );
	}
	points[17] = points[4711]; // duplicates stay: an index is a point
	for ( lw_sphere_fit fit : { LW_FIT_GREEDY, LW_FIT_COMPACT, LW_FIT_MINIMAL } )
	{
		lw_tree_def tree = { fit, 8, 0.001 };
		lw_shape* raw = nullptr;
		ASSERT_EQ( lw_shape_create_points( points[0].data(), 5000, 0.02, &tree, nullptr, nullptr, &raw ), LW_OK );
		ShapePtr shape( raw );
		lw_diag diag = {};
		EXPECT_EQ( lwi_shape_validate( raw, &diag ), LW_OK ) << diag.message;
		lw_shape_info info = lw_shape_get_info( raw );
		EXPECT_EQ( info.vertex_count, 5000u );
		EXPECT_EQ( info.triangle_count, 0u );
		EXPECT_EQ( lw_shape_triangles( raw ), nullptr );
		EXPECT_EQ( info.dimensions[0], 0.02 );
		ASSERT_NE( lw_shape_vertices( raw ), nullptr );
		EXPECT_EQ( 0, std::memcmp( lw_shape_vertices( raw ), points[0].data(), 5000 * sizeof( Point ) ) );
		Point center;
		std::copy( info.sphere_center, info.sphere_center + 3, center.begin() );
		for ( const Point& p : points )
		{
			EXPECT_LE( distance( center, p ) + 0.02, info.sphere_radius );
			EXPECT_LE( info.box_min[2], p[2] - 0.02 );
			EXPECT_GE( info.box_max[2], p[2] + 0.02 );
		}
	}
}

// Inputs that would make clouds slow or large.
TEST( Points, LargeCloudsAreShallowAndSmall )
{
	SeededRng rng;
	std::vector<double> points;
	const uint32_t count = 200000;
	for ( uint32_t i = 0; i < count; ++i )
	{
		double x = rng.uniform( -3, 3 ), y = rng.uniform( -3, 3 );
		points.insert( points.end(), { x, y, i % 3 == 0 ? 0.0 : 0.2 * std::sin( 3 * x ) + 0.001 * rng.normal() } );
	}
	lw_shape* raw = nullptr;
	ASSERT_EQ( lw_shape_create_points( points.data(), count, 0.005, nullptr, nullptr, nullptr, &raw ), LW_OK );
	ShapePtr shape( raw );
	lw_diag diag = {};
	EXPECT_EQ( lwi_shape_validate( raw, &diag ), LW_OK ) << diag.message;
	lw_shape_info info = lw_shape_get_info( raw );
	EXPECT_LE( info.depth, 12u );
	EXPECT_LT( static_cast<double>( info.bytes ) / count, 60.0 );
}

TEST( Sets, BadInputIsNamed )
{
	lw_diag diag = {};
	lw_shape* shape = nullptr;
	const double nan = std::nan( "" );
	const double spheres[8] = { 0, 0, 0, 1, 1, 1, 1, -0.5 }, lost[8] = { 0, 0, 0, 1, nan, 1, 1, 0.5 };
	EXPECT_EQ( lw_shape_create_spheres( spheres, 2, nullptr, nullptr, &diag, &shape ), LW_ERROR_BAD_GEOMETRY );
	EXPECT_EQ( diag.index, 1u );
	EXPECT_NE( std::strstr( diag.message, "sphere 1" ), nullptr ) << diag.message;
	EXPECT_EQ( lw_shape_create_spheres( lost, 2, nullptr, nullptr, &diag, &shape ), LW_ERROR_BAD_GEOMETRY );
	EXPECT_EQ( diag.index, 1u );
	const double boxes[12] = { 0, 0, 0, 1, 1, 1, 0, 0, 0, 1, -1, 1 };
	EXPECT_EQ( lw_shape_create_boxes( boxes, 2, nullptr, nullptr, &diag, &shape ), LW_ERROR_BAD_GEOMETRY );
	EXPECT_EQ( diag.index, 1u );
	EXPECT_EQ( lw_shape_create_boxes( nullptr, 2, nullptr, nullptr, &diag, &shape ), LW_ERROR_INVALID_ARGUMENT );
	EXPECT_EQ( lw_shape_create_spheres( spheres, 0, nullptr, nullptr, &diag, &shape ), LW_ERROR_BAD_GEOMETRY );
	EXPECT_EQ( shape, nullptr );
	EXPECT_EQ( lw_shape_create_boxes( boxes, 1, nullptr, nullptr, &diag, &shape ), LW_OK );
	EXPECT_EQ( lw_shape_get_info( shape ).vertex_count, 2u );
	EXPECT_EQ( lw_shape_radii( shape ), nullptr );
	lw_shape_release( shape );
	EXPECT_EQ( lw_shape_create_spheres( spheres, 1, nullptr, nullptr, &diag, &shape ), LW_OK );
	EXPECT_EQ( lw_shape_radii( shape )[0], 1.0 );
	lw_shape_release( shape );
}

TEST( Points, BadInputIsNamed )
{
	lw_diag diag = {};
	lw_shape* shape = nullptr;
	double p[6] = { 0, 0, 0, 1, std::nan( "" ), 0 };
	EXPECT_EQ( lw_shape_create_points( p, 2, 0.1, nullptr, nullptr, &diag, &shape ), LW_ERROR_BAD_GEOMETRY );
	EXPECT_EQ( diag.index, 1u );
	for ( double bad : { -0.1, std::nan( "" ), double( INFINITY ) } )
	{
		EXPECT_EQ( lw_shape_create_points( p, 1, bad, nullptr, nullptr, &diag, &shape ), LW_ERROR_BAD_GEOMETRY );
	}
	EXPECT_EQ( lw_shape_create_points( p, 0, 0.1, nullptr, nullptr, &diag, &shape ), LW_ERROR_BAD_GEOMETRY );
	EXPECT_EQ( lw_shape_create_points( nullptr, 1, 0.1, nullptr, nullptr, &diag, &shape ), LW_ERROR_INVALID_ARGUMENT );
	EXPECT_EQ( shape, nullptr );
	EXPECT_EQ( lw_shape_create_points( p, 1, 0.0, nullptr, nullptr, &diag, &shape ), LW_OK );
	lw_shape_release( shape );
}

TEST( Shapes, LastReferenceFreesEverything )
{
	CountingAllocator memory;
	lw_allocator allocator = memory.get();
	double d[3] = { 1, 2, 3 };
	std::vector<lw_shape*> shapes;
	for ( lw_shape_type type : { LW_SHAPE_BOX, LW_SHAPE_SPHERE, LW_SHAPE_CYLINDER, LW_SHAPE_CAPSULE, LW_SHAPE_CONE } )
	{
		long failures = 0;
		lw_shape* shape = nullptr;
		std::size_t before = memory.live;
		for ( ;; ++failures )
		{
			memory.calls = 0;
			memory.failAt = failures + 1;
			lw_status status = lw_shape_create_primitive( type, d, &allocator, nullptr, &shape );
			if ( status == LW_OK )
			{
				break;
			}
			ASSERT_EQ( status, LW_ERROR_OUT_OF_MEMORY );
			ASSERT_EQ( memory.live, before );
		}
		EXPECT_EQ( memory.live, before + lw_shape_get_info( shape ).bytes );
		shapes.push_back( shape );
	}
	for ( lw_shape* shape : shapes )
	{
		EXPECT_EQ( lw_shape_retain( shape ), shape );
		lw_shape_release( shape );
	}
	EXPECT_GT( memory.live, 0u );
	for ( lw_shape* shape : shapes )
	{
		lw_shape_release( shape );
	}
	EXPECT_EQ( memory.live, 0u );
	lw_shape_release( nullptr );
	EXPECT_EQ( lw_shape_retain( nullptr ), nullptr );
}
