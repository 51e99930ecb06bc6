// SPDX-License-Identifier: BSD-3-Clause
// Shapes with rounded edges: they contain the original, exceed it by no more than they say, and directions turn slowly beside them.
#include "depth_bodies.hpp"

namespace
{
ShapePtr rounded( const ShapePtr& shape, double radius, lw_status expected = LW_OK )
{
	lw_shape* out = nullptr;
	lw_diag diag = {};
	EXPECT_EQ( expected, lw_shape_create_rounded( shape.get(), radius, nullptr, &diag, &out ) ) << diag.message;
	EXPECT_EQ( expected == LW_OK, out != nullptr );
	return ShapePtr( out );
}

ShapePtr randomConvex( SeededRng& rng, int kind )
{
	const double x = rng.uniform( 0.2, 0.6 ), y = rng.uniform( 0.2, 0.6 ), z = rng.uniform( 0.2, 0.6 );
	return kind == 0   ? makePrimitive( LW_SHAPE_BOX, x, y, z )
	       : kind == 1 ? makePrimitive( LW_SHAPE_CYLINDER, 0.5 * x, y )
	       : kind == 2 ? makePrimitive( LW_SHAPE_CONE, 0.5 * x, y )
	                   : meshOf( prism( rng.integer( 3, 9 ), { x, y, z }, rng.uniform( 0.4, 1 ) ), kind == 3 );
}

/// The direction from b to a, apart or in contact, and how far the surfaces are apart.
lw_vec3 directionOf( const ShapePtr& a, const lw_transform& pose_a, const ShapePtr& b, const lw_transform& pose_b,
    lw_query* query, double* out_distance )
{
	const lw_clearance c = distanceOf( a, pose_a, b, pose_b, query );
	if ( c.lower > 0 )
	{
		const lw_vec3 between = c.point_a - c.point_b;
		*out_distance = c.lower;
		return ( 1 / length( between ) ) * between;
	}
	const lw_depth depth = depthOf( a, pose_a, b, pose_b, query );
	*out_distance = -depth.upper;
	return depth.normal;
}

/// Moves a ball out of a box past its edge (0.1, y, 0.1), its centre half a millimetre below a face; steps of 0.1 mm.
/// @param room metres: distance of the cores where the surfaces touch
/// @param out_most the largest turn of one step
/// @return the same per metre, times the distance of the cores
double fastestTurn( const ShapePtr& box, double ball, double room, lw_query* query, double* out_most )
{
	const ShapePtr probe = makePrimitive( LW_SHAPE_SPHERE, ball );
	const double step = 1e-4;
	double fastest = 0, before_distance = 0;
	lw_vec3 before = {};
	*out_most = 0;
	for ( int i = 0; i < 1500; ++i )
	{
		double distance = 0;
		const lw_vec3 n =
		    directionOf( probe, at( step * i, 0.03, 0.1 - 5e-4 ), box, lw_transform_identity(), query, &distance );
		EXPECT_NEAR( 1, length( n ), 1e-12 );
		if ( i > 0 )
		{
			const double turn = length( n - before );
			*out_most = std::max( *out_most, turn );
			fastest = std::max( fastest, turn / step * ( room + std::min( distance, before_distance ) ) );
		}
		before = n;
		before_distance = distance;
	}
	return fastest;
}
} // namespace

TEST( RoundedShapes, LeaveOutAPartOrExceedTheOriginalByMoreThanTheySay )
{
	SeededRng rng( 15 );
	const QueryPtr query = makeQuery();
	int near = 0;
	for ( int i = 0; i < 2000; ++i )
	{
		const int kind = i % 5;
		const ShapePtr shape = randomConvex( rng, kind );
		const double radius = rng.uniform( 0.005, 0.04 );
		const ShapePtr round = rounded( shape, radius );
		const lw_shape_info info = lw_shape_get_info( round.get() );
		EXPECT_GT( info.excess, 0 );
		EXPECT_LE( info.excess, ( kind == 4 ? 2 : kind == 0 ? 0.43 : 1 ) * radius * 1.001 );
		EXPECT_EQ( kind != 4, info.solid );
		const ShapePtr other =
		    i % 2 == 0 ? makePrimitive( LW_SHAPE_SPHERE, rng.uniform( 1e-3, 0.1 ) ) : randomConvex( rng, i % 4 );
		const lw_transform pose = randomPose( rng, 0.5 ), place = randomPose( rng, 0.5 );
		const double true_distance = distanceOf( shape, pose, other, place, query.get() ).upper,
		             distance = distanceOf( round, pose, other, place, query.get() ).upper;
		EXPECT_LE( distance, true_distance + 1e-9 ) << kind;
		EXPECT_GE( distance, true_distance - info.excess - 1e-9 ) << kind;
		near += true_distance > 0 && distance < true_distance;
	}
	EXPECT_GT( near, 300 );
}

TEST( RoundedShapes, DirectionsJumpAtAnEdge )
{
	const QueryPtr query = makeQuery();
	const ShapePtr box = makePrimitive( LW_SHAPE_BOX, 0.2, 0.2, 0.2 );
	double most = 0;
	for ( const double radius : { 0.002, 0.01, 0.03 } )
	{
		EXPECT_LE( fastestTurn( rounded( box, radius ), 1e-3, radius + 1e-3, query.get(), &most ), 1.001 );
		std::printf( "radius %g m: at most %.2g in 0.1 mm\n", radius, most );
	}
	fastestTurn( box, 1e-3, 1e-3, query.get(), &most );
	EXPECT_GT( most, 1 );
	std::printf( "sharp: at most %.2g in 0.1 mm\n", most );
}

TEST( RoundedShapes, OtherShapesGetRoundWithoutAWord )
{
	const ShapePtr ball = makePrimitive( LW_SHAPE_SPHERE, 0.1 ), capsule = makePrimitive( LW_SHAPE_CAPSULE, 0.1, 1 ),
	               box = makePrimitive( LW_SHAPE_BOX, 0.1, 1, 1 ), floor = makePrimitive( LW_SHAPE_HALFSPACE, 0 ),
	               cylinder = makePrimitive( LW_SHAPE_CYLINDER, 0.1, 1 ), cone = makePrimitive( LW_SHAPE_CONE, 0.1, 1 );
	SeededRng rng( 16 );
	EXPECT_EQ( ball.get(), rounded( ball, 0.01 ).get() );
	EXPECT_EQ( capsule.get(), rounded( capsule, 0.01 ).get() );
	rounded( floor, 0.01, LW_ERROR_UNSUPPORTED );
	rounded( meshOf( angleIron( rng ), true ), 0.01, LW_ERROR_UNSUPPORTED );
	rounded( rounded( box, 0.01 ), 0.01, LW_ERROR_UNSUPPORTED );
	rounded( box, 0.1, LW_ERROR_INVALID_ARGUMENT ); // no room
	rounded( cylinder, 0.2, LW_ERROR_INVALID_ARGUMENT );
	rounded( cylinder, 1e-9, LW_ERROR_INVALID_ARGUMENT ); // too many sides
	rounded( cone, 2, LW_ERROR_INVALID_ARGUMENT );
	rounded( box, 0, LW_ERROR_INVALID_ARGUMENT );
	rounded( box, NAN, LW_ERROR_INVALID_ARGUMENT );
	lw_shape* out = nullptr;
	EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT, lw_shape_create_rounded( nullptr, 0.1, nullptr, nullptr, &out ) );
	EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT, lw_shape_create_rounded( box.get(), 0.1, nullptr, nullptr, nullptr ) );
}

TEST( RoundedShapes, ABlobRefusesOrChangesThem )
{
	SeededRng rng( 17 );
	for ( int kind = 0; kind < 5; ++kind )
	{
		const ShapePtr before = rounded( randomConvex( rng, kind ), 0.02 ), after = throughABlob( before );
		const lw_shape_info info = lw_shape_get_info( after.get() );
		EXPECT_EQ( kind != 4, info.solid );
		EXPECT_EQ( lw_shape_get_info( before.get() ).excess, info.excess );
		const lw_digest a = lw_shape_digest( before.get() ), b = lw_shape_digest( after.get() );
		EXPECT_EQ( a.word[0], b.word[0] );
	}
}

TEST( RoundedShapes, MemoryThatIsMissingLeaks )
{
	const ShapePtr shapes[] = { makePrimitive( LW_SHAPE_CYLINDER, 0.1, 1 ), meshOf( prism( 5, { 1, 1, 1 }, 0.5 ), true ) };
	for ( const ShapePtr& shape : shapes )
	{
		for ( std::size_t fail = 1;; ++fail )
		{
			FailingAllocator memory;
			memory.fail_at = fail;
			lw_shape* out = nullptr;
			const lw_status status = lw_shape_create_rounded( shape.get(), 0.01, &memory.allocator, nullptr, &out );
			lw_shape_release( out );
			EXPECT_EQ( 0u, memory.live );
			if ( status == LW_OK )
			{
				break;
			}
			ASSERT_EQ( LW_ERROR_OUT_OF_MEMORY, status );
		}
	}
}
