// SPDX-License-Identifier: BSD-3-Clause
// Enclosing spheres: nothing sticks out, the excess holds, the check sees each gap.
#include "enclosing.hpp"

namespace
{

TEST( Spheres, CornersCoveredButNotWholeTriangles )
{
	SeededRng rng;
	for ( int i = 0; i < 12; ++i )
	{
		double size = rng.decade( -2, 1 );
		Mesh mesh = i % 3 == 0   ? boxMesh( size, size * rng.uniform( 0.1, 1 ), size * rng.uniform( 0.1, 1 ), { 3, -2, 1 } )
		            : i % 3 == 1 ? torusMesh( size, size * rng.uniform( 0.1, 0.6 ), 24, 12 )
		                         : bumpyMesh( rng, size, 10, 16 );
		ShapePtr shape = mesh.shape();
		double excess = size * rng.uniform( 0.08, 0.4 );
		SpheresPtr set = enclose( Body( shape.get() ), excess );
		std::vector<Sphere> spheres = spheresOf( set.get() );
		lw_spheres_report report = lw_spheres_get_report( set.get() );
		EXPECT_TRUE( report.encloses );
		EXPECT_EQ( report.shells, 1u );
		EXPECT_LE( report.excess, excess );
		EXPECT_GT( report.deep_spheres, 0u );
		expectNothingOutside( rng, mesh, spheres, 40 );
		double seen = farthestBeyond( rng, mesh, spheres, 30, true );
		EXPECT_LE( seen, report.excess + 1e-12 * size );
		EXPECT_LE( report.excess_attained, report.excess );
		EXPECT_GE( report.excess_attained, 0.5 * report.excess );
	}
}

TEST( Spheres, OpenMeshTakenForSolid )
{
	SeededRng rng;
	Mesh open = boxMesh( 0.5, 0.4, 0.3, { 0, 0, 0 }, true );
	ShapePtr shape = open.shape();
	SpheresPtr set = enclose( Body( shape.get() ), 0.1 );
	lw_spheres_report report = lw_spheres_get_report( set.get() );
	EXPECT_EQ( report.deep_spheres, 0u );
	EXPECT_EQ( report.shells, 0u );
	EXPECT_EQ( report.open_shells, 1u );
	EXPECT_NEAR( report.widest_open_hole, std::hypot( 1.0, 0.8 ), 1e-12 );
	expectNothingOutside( rng, open, spheresOf( set.get() ), 100 );
	EXPECT_LE( farthestBeyond( rng, open, spheresOf( set.get() ), 50, false ), 0.1 );

	// with its hole declared closed the box is solid, and takes fewer spheres
	SpheresPtr closed = enclose( Body( shape.get(), 1.3 ), 0.1 );
	lw_spheres_report closed_report = lw_spheres_get_report( closed.get() );
	EXPECT_EQ( closed_report.holes, 1u );
	EXPECT_NEAR( closed_report.widest_hole, std::hypot( 1.0, 0.8 ), 1e-12 );
	EXPECT_GT( closed_report.deep_spheres, 0u );
	EXPECT_LT( lw_spheres_count( closed.get() ), lw_spheres_count( set.get() ) );
	expectNothingOutside( rng, open, spheresOf( closed.get() ), 100 );
	EXPECT_LE( farthestBeyond( rng, boxMesh( 0.5, 0.4, 0.3 ), spheresOf( closed.get() ), 50, true ), 0.1 );
	EXPECT_EQ( lw_spheres_get_report( enclose( Body( shape.get(), 1.2 ), 0.1 ).get() ).holes, 0u );
}

TEST( Spheres, TouchingAndNestedShellsCancel )
{
	// two boxes that share an edge: four triangles meet there
	Mesh touching = boxMesh( 0.5, 0.5, 0.5 );
	touching.add( boxMesh( 0.5, 0.5, 0.5, { 1, 1, 0 } ) );
	ShapePtr shape = touching.shape();
	SpheresPtr set = enclose( Body( shape.get() ), 0.2 );
	EXPECT_EQ( lw_spheres_get_report( set.get() ).shells, 2u );
	EXPECT_GT( lw_spheres_get_report( set.get() ).deep_spheres, 0u );

	// a box inside of a box, whose inside a ray of both would call outside, and which must not make the walls thin
	Mesh outer = boxMesh( 0.5, 0.5, 0.5 ), nested = outer;
	nested.add( boxMesh( 0.2, 0.2, 0.2 ) );
	ShapePtr outer_shape = outer.shape(), nested_shape = nested.shape();
	uint32_t alone = lw_spheres_count( enclose( Body( outer_shape.get() ), 0.1 ).get() );
	SpheresPtr both = enclose( Body( nested_shape.get() ), 0.1 );
	EXPECT_EQ( lw_spheres_get_report( both.get() ).shells, 2u );
	EXPECT_LE( lw_spheres_count( both.get() ), alone + alone / 4 + 8 );
	SeededRng rng;
	expectNothingOutside( rng, nested, spheresOf( both.get() ), 100 );
	EXPECT_LE( farthestBeyond( rng, outer, spheresOf( both.get() ), 50, true ), 0.1 );

	// overlapping shells: inside of either is inside
	Mesh overlapping = boxMesh( 0.5, 0.3, 0.3 );
	overlapping.add( boxMesh( 0.5, 0.3, 0.3, { 0.4, 0.1, 0.05 } ) );
	ShapePtr overlap_shape = overlapping.shape();
	lw_spheres_report report = check( Body( overlap_shape.get() ), { { { 0.2, 0, 0 }, 0.9 } } );
	EXPECT_TRUE( report.encloses );
	EXPECT_EQ( report.deep_spheres, 1u );
	EXPECT_LT( report.excess, 0.7 );
}

TEST( Spheres, MissingSphereIsNotSeen )
{
	SeededRng rng;
	Mesh mesh = bumpyMesh( rng, 0.3, 12, 18 );
	ShapePtr shape = mesh.shape();
	Body body( shape.get() );
	std::vector<Sphere> spheres = spheresOf( enclose( body, 0.03 ).get() );
	ASSERT_TRUE( check( body, spheres ).encloses );
	int found = 0;
	for ( std::size_t i = 0; i < spheres.size(); ++i )
	{
		std::vector<Sphere> fewer = spheres;
		if ( i % 2 == 0 )
		{
			fewer.erase( fewer.begin() + static_cast<std::ptrdiff_t>( i ) );
		}
		else
		{
			fewer[i].radius *= 0.95;
		}
		lw_spheres_report report = check( body, fewer );
		double oracle = -INFINITY;
		for ( std::size_t t = 0; t < mesh.count(); ++t )
		{
			for ( int k = 0; k < 20; ++k )
			{
				oracle = std::max( oracle, gap( fewer, pointOf( rng, mesh, t ) ) );
			}
		}
		if ( oracle > 0 )
		{
			++found;
			EXPECT_FALSE( report.encloses ) << "sphere " << i;
			EXPECT_GT( report.uncovered, 0 );
			EXPECT_GT( gap( fewer, { report.uncovered_at.x, report.uncovered_at.y, report.uncovered_at.z } ), 0 );
		}
	}
	EXPECT_GE( found, static_cast<int>( spheres.size() / 4 ) );
	EXPECT_FALSE( check( body, {} ).encloses );
}

TEST( Spheres, CheckBelievesTooSmallAnExcess )
{
	SeededRng rng;
	for ( int i = 0; i < 10; ++i )
	{
		Mesh mesh = bumpyMesh( rng, 0.3, 8, 12 );
		ShapePtr shape = mesh.shape();
		std::vector<Sphere> spheres;
		for ( int k = 0; k < 10; ++k )
		{
			spheres.push_back( { { rng.uniform( -0.5, 0.5 ), rng.uniform( -0.5, 0.5 ), rng.uniform( -0.5, 0.5 ) },
			    rng.uniform( 0, 0.4 ) } );
		}
		lw_spheres_report report = check( Body( shape.get() ), spheres );
		EXPECT_LE( farthestBeyond( rng, mesh, spheres, 60, true ), report.excess + 1e-12 );
		EXPECT_LE( report.excess_attained, report.excess );
	}
}

TEST( Spheres, VoidInsideOfSolidPrimitive )
{
	SeededRng rng;
	struct Case
	{
		lw_shape_type type;
		double d[3];
	};
	for ( const Case& c : { Case{ LW_SHAPE_BOX, { 1.0, 0.8, 0.6 } }, Case{ LW_SHAPE_CYLINDER, { 0.4, 0.9, 0 } },
	          Case{ LW_SHAPE_CONE, { 0.4, 0.9, 0 } } } )
	{
		ShapePtr shape = makePrimitive( c.type, c.d[0], c.d[1], c.d[2] );
		Body body( shape.get() );
		SpheresPtr set = enclose( body, 0.1 );
		lw_spheres_report report = lw_spheres_get_report( set.get() );
		EXPECT_TRUE( report.encloses );
		EXPECT_LE( report.excess, 0.1 );
		std::vector<Sphere> spheres = spheresOf( set.get() );
		for ( int i = 0; i < 5000; ++i )
		{
			Point p = { rng.uniform( -0.5, 0.5 ), rng.uniform( -0.5, 0.5 ), rng.uniform( -0.5, 0.5 ) };
			double round = std::hypot( p[0], p[1] );
			bool inside = c.type == LW_SHAPE_BOX
			                  ? std::abs( p[0] ) <= 0.5 && std::abs( p[1] ) <= 0.4 && std::abs( p[2] ) <= 0.3
			              : c.type == LW_SHAPE_CYLINDER ? round <= 0.4 && std::abs( p[2] ) <= 0.45
			                                            : std::abs( p[2] ) <= 0.45 && round <= 0.4 * ( 0.45 - p[2] ) / 0.9;
			if ( inside )
			{
				EXPECT_LE( gap( spheres, p ), 0 );
			}
		}
	}
	// spheres along the surface only: as a mesh the box is enclosed, as a solid it is not
	Mesh mesh = boxMesh( 0.5, 0.5, 0.5 );
	std::vector<Sphere> skin;
	for ( int i = 0; i < 6 * 21 * 21; ++i )
	{
		int face = i / 441, u = i % 21, v = i / 21 % 21;
		Point p;
		p[static_cast<std::size_t>( face / 2 )] = face % 2 == 0 ? 0.5 : -0.5;
		p[static_cast<std::size_t>( ( face / 2 + 1 ) % 3 )] = -0.5 + 0.05 * u;
		p[static_cast<std::size_t>( ( face / 2 + 2 ) % 3 )] = -0.5 + 0.05 * v;
		skin.push_back( { p, 0.06 } );
	}
	ShapePtr hollow = mesh.shape(), solid = makePrimitive( LW_SHAPE_BOX, 1, 1, 1 );
	EXPECT_TRUE( check( Body( hollow.get() ), skin ).encloses );
	lw_mesh_def filled_def = lw_mesh_def_default();
	filled_def.vertices = mesh.vertices.data();
	filled_def.vertex_count = 8;
	filled_def.indices = mesh.triangles.data();
	filled_def.triangle_count = 12;
	filled_def.solid = true;
	lw_shape* filled = nullptr;
	ASSERT_EQ( lw_shape_create_mesh( &filled_def, nullptr, nullptr, &filled ), LW_OK );
	ShapePtr filled_owner( filled );
	EXPECT_FALSE( check( Body( filled ), skin ).encloses );
	EXPECT_FALSE( check( Body( solid.get() ), skin ).encloses );
	EXPECT_GT( check( Body( solid.get() ), skin ).uncovered, 0 );
}

TEST( Spheres, RoundShapesAreTheirOwnSpheres )
{
	ShapePtr ball = makePrimitive( LW_SHAPE_SPHERE, 0.3 );
	SpheresPtr one = enclose( Body( ball.get() ), 0.01 );
	ASSERT_EQ( lw_spheres_count( one.get() ), 1u );
	EXPECT_NEAR( lw_spheres_data( one.get() )[3], 0.3, 1e-12 );
	EXPECT_LE( lw_spheres_get_report( one.get() ).excess, 1e-12 );

	SeededRng rng;
	ShapePtr capsule = makePrimitive( LW_SHAPE_CAPSULE, 0.1, 0.6 );
	SpheresPtr row = enclose( Body( capsule.get() ), 0.02 );
	EXPECT_LE( lw_spheres_get_report( row.get() ).excess, 0.02 );
	EXPECT_LE( lw_spheres_count( row.get() ), 32u );
	for ( int i = 0; i < 2000; ++i )
	{
		double d[3] = { rng.normal(), rng.normal(), rng.normal() }, length = std::hypot( d[0], d[1], d[2] );
		Point p = { 0.1 * d[0] / length, 0.1 * d[1] / length, 0.1 * d[2] / length + rng.uniform( -0.3, 0.3 ) };
		EXPECT_LE( gap( spheresOf( row.get() ), p ), 0 );
	}
	std::vector<double> cloud;
	for ( int i = 0; i < 600; ++i )
	{
		cloud.push_back( rng.uniform( -1, 1 ) );
	}
	lw_shape* points = nullptr;
	ASSERT_EQ( lw_shape_create_points( cloud.data(), 200, 0.02, nullptr, nullptr, nullptr, &points ), LW_OK );
	ShapePtr owner( points );
	SpheresPtr around = enclose( Body( points ), 0.2 );
	EXPECT_LT( lw_spheres_count( around.get() ), 200u );
	for ( int i = 0; i < 200; ++i )
	{
		EXPECT_LE( gap( spheresOf( around.get() ), { cloud[3 * i], cloud[3 * i + 1], cloud[3 * i + 2] } ), -0.02 + 1e-12 );
	}
}

TEST( Spheres, PosesOfPartsAreForgotten )
{
	SeededRng rng;
	Mesh mesh = boxMesh( 0.2, 0.1, 0.05 );
	ShapePtr shape = mesh.shape(), ball = makePrimitive( LW_SHAPE_SPHERE, 0.15 );
	Body body( shape.get() );
	body.shapes.push_back( ball.get() );
	body.poses = { randomPose( rng, 1 ), randomPose( rng, 1 ) };
	SpheresPtr set = enclose( body, 0.02 );
	std::vector<Sphere> spheres = spheresOf( set.get() );
	for ( std::size_t t = 0; t < mesh.count(); ++t )
	{
		for ( int i = 0; i < 50; ++i )
		{
			Point p = pointOf( rng, mesh, t );
			lw_vec3 q = lw_transform_point( &body.poses[0], { p[0], p[1], p[2] } );
			EXPECT_LE( gap( spheres, { q.x, q.y, q.z } ), 1e-15 );
		}
	}
	EXPECT_LE( gap( spheres, { body.poses[1].t[0], body.poses[1].t[1], body.poses[1].t[2] } ), -0.15 );
}

TEST( Spheres, NumberIsExceededOrWasted )
{
	SeededRng rng;
	Mesh mesh = bumpyMesh( rng, 0.3, 8, 10 );
	ShapePtr shape = mesh.shape();
	double before = INFINITY;
	for ( uint32_t n : { 1u, 4u, 16u } )
	{
		SpheresPtr set = enclose( Body( shape.get() ), 0, n );
		EXPECT_LE( lw_spheres_count( set.get() ), n );
		EXPECT_GE( lw_spheres_count( set.get() ), 1u );
		double excess = lw_spheres_get_report( set.get() ).excess;
		EXPECT_LE( excess, before * 1.02 );
		before = excess;
		expectNothingOutside( rng, mesh, spheresOf( set.get() ), 10 );
	}
	EXPECT_LT( before, 0.2 );
}

TEST( Spheres, RandomSoupsBreakTheCover )
{
	SeededRng rng;
	for ( int i = 0; i < 6; ++i )
	{
		Mesh mesh;
		for ( int t = 0; t < 60; ++t )
		{
			Point c = { rng.uniform( -1, 1 ), rng.uniform( -1, 1 ), rng.uniform( -1, 1 ) };
			double size = rng.decade( -3, 0 );
			uint32_t v[3];
			for ( uint32_t& k : v )
			{
				k = mesh.vertex( c[0] + size * rng.normal(), c[1] + size * rng.normal(), c[2] + size * rng.normal() );
			}
			// slivers, segments and points too
			mesh.triangle( v[0], t % 7 == 0 ? v[0] : v[1], t % 5 == 0 ? v[1] : v[2] );
		}
		ShapePtr shape = mesh.shape();
		SpheresPtr set = enclose( Body( shape.get() ), 0.15 );
		EXPECT_LE( lw_spheres_get_report( set.get() ).excess, 0.15 );
		expectNothingOutside( rng, mesh, spheresOf( set.get() ), 30 );
		EXPECT_LE( farthestBeyond( rng, mesh, spheresOf( set.get() ), 10, false ), 0.15 );
	}
}

TEST( Spheres, SameInputOtherSpheres )
{
	ShapePtr shape = torusMesh( 0.4, 0.1, 20, 10 ).shape();
	SpheresPtr a = enclose( Body( shape.get() ), 0.03 ), b = enclose( Body( shape.get() ), 0.03 );
	ASSERT_EQ( lw_spheres_count( a.get() ), lw_spheres_count( b.get() ) );
	EXPECT_TRUE( std::equal( lw_spheres_data( a.get() ), lw_spheres_data( a.get() ) + 4 * lw_spheres_count( a.get() ),
	    lw_spheres_data( b.get() ) ) );
}

TEST( Spheres, StoppedSearchLeavesHolesOrForgetsItsBest )
{
	SeededRng rng;
	ShapePtr torus = torusMesh( 0.4, 0.1, 20, 10 ).shape(), can = makePrimitive( LW_SHAPE_CYLINDER, 0.2, 0.7 );
	Body body( torus.get() );
	body.shapes.push_back( can.get() );
	for ( uint32_t number : { 0u, 6u } )
	{
		lw_spheres_def def = lw_spheres_def_default();
		def.body = body.def();
		def.excess = number == 0 ? 0.06 : 0;
		def.sphere_count = number;
		def.decimals = 4;
		def.stop = Countdown::over;
		double before = INFINITY;
		int unmet = 0;
		for ( int calls = 0; calls < 100000000; calls = 8 * calls + rng.integer( 0, 3 ) )
		{
			Countdown countdown{ calls };
			def.user = &countdown;
			lw_diag diag = {};
			lw_spheres* out = nullptr;
			ASSERT_EQ( lw_spheres_create( &def, nullptr, &diag, &out ), LW_OK ) << diag.message;
			SpheresPtr set( out );
			lw_spheres_report report = lw_spheres_get_report( set.get() ), again = check( body, spheresOf( set.get() ) );
			EXPECT_TRUE( report.encloses && again.encloses ) << calls;
			EXPECT_EQ( lw_spheres_met_target( set.get() ), countdown.calls >= 0 );
			EXPECT_LE( report.excess, before ) << calls;
			EXPECT_LE( again.excess, report.excess + 0.01 * ( number == 0 ? 0.06 : 0.1 ) );
			before = report.excess;
			unmet += lw_spheres_met_target( set.get() ) ? 0 : 1;
			if ( countdown.calls >= 0 )
			{
				break;
			}
			calls += calls == 0 ? 1 : 0;
		}
		EXPECT_GE( unmet, 4 );
		if ( number == 0 )
		{
			EXPECT_LE( before, 0.06 );
		}
	}
}

TEST( Spheres, OtherNumbersAreProvedThanAreWritten )
{
	SeededRng rng;
	Mesh mesh = bumpyMesh( rng, 0.3, 8, 10 );
	ShapePtr shape = mesh.shape();
	Body body( shape.get() );
	lw_spheres_def def = lw_spheres_def_default();
	def.body = body.def();
	def.excess = 0.03;
	def.decimals = 3;
	lw_diag diag = {};
	lw_spheres* out = nullptr;
	ASSERT_EQ( lw_spheres_create( &def, nullptr, &diag, &out ), LW_OK ) << diag.message;
	SpheresPtr set( out );
	EXPECT_LE( lw_spheres_get_report( set.get() ).excess, 0.03 );
	for ( uint32_t i = 0; i < 4 * lw_spheres_count( set.get() ); ++i )
	{
		const double number = lw_spheres_data( set.get() )[i];
		char text[32];
		std::snprintf( text, sizeof( text ), "%.3f", number );
		EXPECT_EQ( std::strtod( text, nullptr ), number );
	}
	EXPECT_TRUE( check( body, spheresOf( set.get() ) ).encloses );
	def.decimals = 13;
	EXPECT_EQ( lw_spheres_create( &def, nullptr, &diag, &out ), LW_ERROR_INVALID_ARGUMENT );
}

TEST( Spheres, BadInputIsUsed )
{
	ShapePtr shape = boxMesh( 1, 1, 1 ).shape();
	Body body( shape.get() );
	lw_spheres_def def = lw_spheres_def_default();
	lw_spheres* out = nullptr;
	lw_diag diag = {};
	auto status = [&]() { return lw_spheres_create( &def, nullptr, &diag, &out ); };
	def.body = body.def();
	EXPECT_EQ( status(), LW_ERROR_INVALID_ARGUMENT ); // neither excess nor count
	def.excess = 0.1;
	def.sphere_count = 3;
	EXPECT_EQ( status(), LW_ERROR_INVALID_ARGUMENT ); // both
	def.sphere_count = 0;
	def.excess = -1;
	EXPECT_EQ( status(), LW_ERROR_INVALID_ARGUMENT );
	def.excess = NAN;
	EXPECT_EQ( status(), LW_ERROR_INVALID_ARGUMENT );
	def.excess = 1e-16;
	EXPECT_EQ( status(), LW_ERROR_UNSUPPORTED );
	def.excess = 1e-6;
	EXPECT_EQ( status(), LW_ERROR_UNSUPPORTED ) << "millions of pieces";
	def.excess = 0.1;
	def.body.close_holes = -1;
	EXPECT_EQ( status(), LW_ERROR_INVALID_ARGUMENT );
	def.body = { nullptr, nullptr, 0, 0 };
	EXPECT_EQ( status(), LW_ERROR_INVALID_ARGUMENT );
	lw_transform shear = lw_transform_identity();
	shear.r[0][1] = 0.5;
	def.body = body.def();
	def.body.body_from_shape = &shear;
	EXPECT_EQ( status(), LW_ERROR_INVALID_ARGUMENT );
	def.cookie = 0;
	EXPECT_EQ( status(), LW_ERROR_INVALID_DEF );
	EXPECT_EQ( out, nullptr );
	lw_geometry_def geometry = body.def();
	lw_spheres_report report;
	const double bad[8] = { 0, 0, 0, 1, 0, NAN, 0, 1 }, negative[4] = { 0, 0, 0, -1 };
	EXPECT_EQ( lw_spheres_check( &geometry, bad, 2, nullptr, &diag, &report ), LW_ERROR_BAD_GEOMETRY );
	EXPECT_EQ( diag.index, 1u );
	EXPECT_FALSE( report.encloses );
	EXPECT_EQ( lw_spheres_check( &geometry, negative, 1, nullptr, &diag, &report ), LW_ERROR_BAD_GEOMETRY );
	EXPECT_EQ( lw_spheres_check( nullptr, bad, 1, nullptr, &diag, &report ), LW_ERROR_INVALID_ARGUMENT );
}

TEST( Spheres, FailingAllocationLeaks )
{
	Mesh mesh = boxMesh( 0.5, 0.4, 0.3, { 0, 0, 0 }, true );
	mesh.add( boxMesh( 0.2, 0.1, 0.1, { 2, 0, 0 } ) );
	ShapePtr shape = mesh.shape(), solid = makePrimitive( LW_SHAPE_CYLINDER, 0.2, 0.5 );
	Body body( shape.get(), 2.0 );
	body.shapes.push_back( solid.get() );
	lw_spheres_def def = lw_spheres_def_default();
	def.body = body.def();
	def.excess = 0.6;
	bool done = false;
	int failures = 0;
	for ( std::size_t at = 1; !done; ++at )
	{
		FailingAllocator memory;
		memory.fail_at = at;
		lw_spheres* out = nullptr;
		lw_diag diag = {};
		lw_status status = lw_spheres_create( &def, &memory.allocator, &diag, &out );
		done = status == LW_OK;
		if ( !done )
		{
			ASSERT_EQ( status, LW_ERROR_OUT_OF_MEMORY ) << "call " << at << ": " << diag.message;
			EXPECT_EQ( out, nullptr );
			++failures;
		}
		lw_spheres_destroy( out );
		ASSERT_EQ( memory.live, 0u ) << "call " << at;
	}
	EXPECT_GT( failures, 50 );
}

} // namespace
