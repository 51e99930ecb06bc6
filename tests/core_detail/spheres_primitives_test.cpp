// SPDX-License-Identifier: BSD-3-Clause
// Enclosing spheres of primitives by formulas: no holes, no excess beyond the stated one, no more spheres than a search.
#include "enclosing.hpp"

namespace
{

/// A box (full sides), cylinder (radius, length) or capsule (radius, length of its axis) and its known volume and surface.
struct Primitive
{
	lw_shape_type type;
	double d[3];

	ShapePtr shape() const { return makePrimitive( type, d[0], d[1], d[2] ); }

	/// A point of it, often of its surface, edges or corners.
	Point sample( SeededRng& rng ) const
	{
		auto coordinate = [&]() { return rng.integer( 0, 1 ) == 0 ? rng.uniform( -1, 1 ) : rng.integer( 0, 1 ) * 2.0 - 1; };
		if ( type == LW_SHAPE_BOX )
		{
			return { 0.5 * d[0] * coordinate(), 0.5 * d[1] * coordinate(), 0.5 * d[2] * coordinate() };
		}
		const double angle = rng.uniform( 0, 6.2831853 ), z = 0.5 * d[1] * coordinate();
		if ( type == LW_SHAPE_CYLINDER )
		{
			const double r = d[0] * coordinate();
			return { r * std::cos( angle ), r * std::sin( angle ), z };
		}
		const double u[3] = { rng.normal(), rng.normal(), rng.normal() };
		const double k = d[0] * coordinate() / std::hypot( u[0], u[1], u[2] );
		return { k * u[0], k * u[1], k * u[2] + z };
	}

	/// How far a point is from it; 0 inside.
	double away( const Point& p ) const
	{
		if ( type == LW_SHAPE_BOX )
		{
			return std::hypot( std::max( std::abs( p[0] ) - 0.5 * d[0], 0.0 ),
			    std::max( std::abs( p[1] ) - 0.5 * d[1], 0.0 ), std::max( std::abs( p[2] ) - 0.5 * d[2], 0.0 ) );
		}
		const double round = std::hypot( p[0], p[1] ), z = std::max( std::abs( p[2] ) - 0.5 * d[1], 0.0 );
		return type == LW_SHAPE_CYLINDER ? std::hypot( std::max( round - d[0], 0.0 ), z )
		                                 : std::max( std::hypot( round, z ) - d[0], 0.0 );
	}
};

Primitive randomPrimitive( SeededRng& rng, int kind )
{
	const double size = rng.decade( -2, 1 );
	Primitive out{ kind == 0 ? LW_SHAPE_BOX : kind == 1 ? LW_SHAPE_CYLINDER : LW_SHAPE_CAPSULE, {} };
	for ( double& d : out.d )
	{
		d = size * rng.decade( -1.3, 0 );
	}
	return out;
}

double largest( const Primitive& p )
{
	return std::max( { p.d[0], p.d[1], p.type == LW_SHAPE_BOX ? p.d[2] : 0 } );
}

TEST( Spheres, FormOfPrimitiveLeavesHolesOrReachesTooFar )
{
	SeededRng rng;
	for ( int i = 0; i < 90; ++i )
	{
		const Primitive primitive = randomPrimitive( rng, i % 3 );
		ShapePtr shape = primitive.shape();
		Body body( shape.get() );
		const bool posed = rng.integer( 0, 1 ) == 1;
		lw_transform pose = posed ? randomPose( rng, 2 ) : lw_transform_identity();
		body.poses = { pose };
		const double excess = largest( primitive ) * rng.decade( -2.2, 0 );
		Countdown countdown{ 400000 }; // a search that is asked for where the form fails would be stopped
		lw_spheres_def def = lw_spheres_def_default();
		def.body = body.def();
		def.excess = excess;
		def.stop = Countdown::over;
		def.user = &countdown;
		lw_diag diag = {};
		lw_spheres* out = nullptr;
		ASSERT_EQ( lw_spheres_create( &def, nullptr, &diag, &out ), LW_OK ) << diag.message;
		SpheresPtr set( out );
		const std::vector<Sphere> spheres = spheresOf( out );
		const lw_spheres_report report = lw_spheres_get_report( set.get() );
		EXPECT_TRUE( report.encloses && check( body, spheres ).encloses );
		EXPECT_LE( report.excess, excess );
		EXPECT_TRUE( lw_spheres_met_target( out ) )
		    << i << ": " << primitive.d[0] << " " << primitive.d[1] << " " << primitive.d[2] << " excess " << excess;
		const double rounding = 1e-15 * ( 4 + largest( primitive ) );
		for ( int k = 0; k < 1500; ++k )
		{
			const Point p = primitive.sample( rng );
			const lw_vec3 q = lw_transform_point( &pose, { p[0], p[1], p[2] } );
			ASSERT_LE( gap( spheres, { q.x, q.y, q.z } ), rounding )
			    << i << ": " << primitive.d[0] << " " << primitive.d[1] << " " << primitive.d[2] << " excess " << excess;
		}
		const lw_transform back = lw_transform_inverse( &pose );
		for ( int k = 0; k < 4000; ++k )
		{
			const Sphere& s = spheres[static_cast<std::size_t>( k ) % spheres.size()];
			const double u[3] = { rng.normal(), rng.normal(), rng.normal() }, n = s.radius / std::hypot( u[0], u[1], u[2] );
			const lw_vec3 q =
			    lw_transform_point( &back, { s.center[0] + n * u[0], s.center[1] + n * u[1], s.center[2] + n * u[2] } );
			ASSERT_LE( primitive.away( { q.x, q.y, q.z } ), report.excess + rounding ) << i;
		}
	}
}

TEST( Spheres, FormTakesMoreSpheresOrWorkThanASearch )
{
	// the last column is the time of the search
	struct Case
	{
		Primitive primitive;
		double excess;
		uint32_t by_search;
	};
	const Case cases[] = { { { LW_SHAPE_BOX, { 0.3, 0.2, 0.1 } }, 0.05, 10 },
	    { { LW_SHAPE_BOX, { 0.3, 0.2, 0.1 } }, 0.01, 163 }, { { LW_SHAPE_BOX, { 0.3, 0.2, 0.1 } }, 0.002, 1649 },
	    { { LW_SHAPE_CYLINDER, { 0.05, 0.3, 0 } }, 0.02, 16 }, { { LW_SHAPE_CYLINDER, { 0.05, 0.3, 0 } }, 0.002, 402 },
	    { { LW_SHAPE_CYLINDER, { 0.2, 0.05, 0 } }, 0.005, 681 }, { { LW_SHAPE_CAPSULE, { 0.05, 0.4, 0 } }, 0.005, 89 } };
	for ( const Case& c : cases )
	{
		ShapePtr shape = c.primitive.shape();
		EXPECT_LE( lw_spheres_count( enclose( Body( shape.get() ), c.excess ).get() ), 0.8 * c.by_search ) << c.by_search;
	}
	// an arm: the search would ask many millions of times whether to go on
	ShapePtr box = makePrimitive( LW_SHAPE_BOX, 0.3, 0.2, 0.1 ), can = makePrimitive( LW_SHAPE_CYLINDER, 0.05, 0.3 );
	ShapePtr capsule = makePrimitive( LW_SHAPE_CAPSULE, 0.05, 0.4 );
	for ( const lw_shape* shape : { box.get(), can.get(), capsule.get() } )
	{
		Body body( shape );
		Countdown countdown{ 100000 };
		lw_spheres_def def = lw_spheres_def_default();
		def.body = body.def();
		def.excess = 0.0005;
		def.decimals = 6;
		def.stop = Countdown::over;
		def.user = &countdown;
		lw_diag diag = {};
		lw_spheres* out = nullptr;
		ASSERT_EQ( lw_spheres_create( &def, nullptr, &diag, &out ), LW_OK ) << diag.message;
		SpheresPtr set( out );
		EXPECT_TRUE( lw_spheres_met_target( set.get() ) );
		EXPECT_LE( lw_spheres_get_report( set.get() ).excess, 0.0005 );
		// stopped within the form: the result is complete all the same
		for ( int calls : { 0, 1, 5, 20, 100 } )
		{
			countdown.calls = calls;
			ASSERT_EQ( lw_spheres_create( &def, nullptr, &diag, &out ), LW_OK ) << diag.message;
			SpheresPtr stopped( out );
			EXPECT_TRUE( check( body, spheresOf( out ) ).encloses );
			EXPECT_EQ( lw_spheres_met_target( out ), countdown.calls >= 0 );
		}
	}
}

TEST( Spheres, CellsOfPrimitiveMissAGap )
{
	SeededRng rng;
	int found = 0;
	for ( int i = 0; i < 120; ++i )
	{
		const Primitive primitive = randomPrimitive( rng, i % 3 );
		ShapePtr shape = primitive.shape();
		Body body( shape.get() );
		std::vector<Sphere> spheres = spheresOf( enclose( body, largest( primitive ) * rng.decade( -1.5, -0.7 ) ).get() );
		Sphere& one = spheres[static_cast<std::size_t>( rng.integer( 0, static_cast<int>( spheres.size() ) - 1 ) )];
		one.radius *= 1 - rng.decade( -2.5, -0.5 );
		double oracle = -INFINITY;
		for ( int k = 0; k < 20000; ++k )
		{
			oracle = std::max( oracle, gap( spheres, primitive.sample( rng ) ) );
		}
		if ( oracle > 1e-12 )
		{
			++found;
			EXPECT_FALSE( check( body, spheres ).encloses ) << i << " gap " << oracle;
		}
	}
	EXPECT_GE( found, 35 );
}

TEST( Spheres, CornersOfCellsCoveredButNotTheirArcs )
{
	// the sphere contains the corners of each quarter of the cylinder, but not the arc of the quarter that is away from it
	ShapePtr disc = makePrimitive( LW_SHAPE_CYLINDER, 1, 0.1 );
	EXPECT_FALSE( check( Body( disc.get() ), { { { -1, -1, 0 }, 2.3 } } ).encloses );
	EXPECT_TRUE( check( Body( disc.get() ), { { { -1, -1, 0 }, 2.42 } } ).encloses );
	// a sphere that contains seven corners of a box
	ShapePtr box = makePrimitive( LW_SHAPE_BOX, 1, 1, 1 );
	for ( int k = 0; k < 8; ++k )
	{
		const Point c = { k & 1 ? 0.01 : -0.01, k & 2 ? 0.01 : -0.01, k & 4 ? 0.01 : -0.01 };
		EXPECT_FALSE( check( Body( box.get() ), { { c, 0.875 } } ).encloses ) << k;
		EXPECT_TRUE( check( Body( box.get() ), { { c, 0.884 } } ).encloses ) << k;
	}
	// the neck between two spheres of a capsule, and spheres beside the axis
	ShapePtr capsule = makePrimitive( LW_SHAPE_CAPSULE, 0.05, 0.4 );
	Body body( capsule.get() );
	const std::vector<Sphere> row = spheresOf( enclose( body, 0.005 ).get() );
	ASSERT_GE( row.size(), 6u );
	for ( int i = 0; i < 20; ++i )
	{
		std::vector<Sphere> moved = row;
		Sphere& one = moved[row.size() / 2];
		( i % 2 == 0 ? one.center[0] : one.radius ) -= 0.0003 * ( 4 + i );
		EXPECT_FALSE( check( body, moved ).encloses ) << i;
		one.radius += 0.0004 * ( 4 + i );
		EXPECT_TRUE( check( body, moved ).encloses ) << i;
	}
}

} // namespace
