// SPDX-License-Identifier: BSD-3-Clause
// Depths of polytopes, rounded or not, against the least width of their difference over all directions that can attain it: normals of
// faces, and crosses of edges.
#include "depth_bodies.hpp"

namespace
{
struct Placed
{
	Corners body;
	ShapePtr shape;
	lw_transform pose = {};
	std::vector<lw_vec3> world;
};

Placed randomPolytope( SeededRng& rng, double spread )
{
	Placed out;
	const lw_vec3 size = { rng.uniform( 0.05, 1 ), rng.uniform( 0.05, 1 ), rng.uniform( 0.05, 1 ) };
	switch ( rng.integer( 0, 3 ) )
	{
	case 0:
		out.body = boxCorners( size );
		out.shape = makePrimitive( LW_SHAPE_BOX, size.x, size.y, size.z );
		break;
	case 1:
		out.body.points = { { 0, 0, -size.y }, { 0, 0, size.y } };
		out.body.radius = size.x;
		out.shape = makePrimitive( LW_SHAPE_CAPSULE, size.x, 2 * size.y );
		break;
	case 2:
		out.body.points = { { 0, 0, 0 } };
		out.body.radius = size.x;
		out.shape = makePrimitive( LW_SHAPE_SPHERE, size.x );
		break;
	default:
		out.body = prism( rng.integer( 3, 9 ), size, rng.uniform( 0.3, 1 ), rng.uniform( -0.3, 0.3 ) );
		out.shape = meshOf( out.body, rng.integer( 0, 1 ) == 1 );
	}
	out.pose = randomPose( rng, spread );
	for ( lw_vec3 p : out.body.points )
	{
		out.world.push_back( lw_transform_point( &out.pose, p ) );
	}
	return out;
}

std::vector<lw_vec3> edgesOf( const Placed& p )
{
	std::vector<lw_vec3> out;
	for ( std::size_t i = 0; i < p.body.triangles.size(); ++i )
	{
		const std::size_t next = i % 3 == 2 ? i - 2 : i + 1;
		out.push_back( p.world[p.body.triangles[next]] - p.world[p.body.triangles[i]] );
	}
	if ( p.body.triangles.empty() && p.world.size() == 2 )
	{
		out.push_back( p.world[1] - p.world[0] );
	}
	return out;
}

void addNormals( const Placed& p, std::vector<lw_vec3>& out )
{
	for ( std::size_t i = 0; i + 2 < p.body.triangles.size(); i += 3 )
	{
		const lw_vec3 o = p.world[p.body.triangles[i]];
		out.push_back( cross( p.world[p.body.triangles[i + 1]] - o, p.world[p.body.triangles[i + 2]] - o ) );
	}
}

/// Width of a - b along n, to the side of n.
double width( const Placed& a, const Placed& b, lw_vec3 n )
{
	double most = -INFINITY, least = INFINITY;
	for ( const lw_vec3& p : a.world )
	{
		most = std::max( most, dot( n, p ) );
	}
	for ( const lw_vec3& p : b.world )
	{
		least = std::min( least, dot( n, p ) );
	}
	return most - least;
}

/// Depth of the two cores, or minus infinity if a direction is needed that is none of the candidates (cores apart).
double coreDepth( const Placed& a, const Placed& b )
{
	std::vector<lw_vec3> normals;
	addNormals( a, normals );
	addNormals( b, normals );
	for ( const lw_vec3& u : edgesOf( a ) )
	{
		for ( const lw_vec3& v : edgesOf( b ) )
		{
			normals.push_back( cross( u, v ) );
		}
	}
	double least = INFINITY;
	for ( const lw_vec3& n : normals )
	{
		const double size = length( n );
		if ( size > 1e-9 )
		{
			least = std::min( { least, width( a, b, ( 1 / size ) * n ), width( a, b, ( -1 / size ) * n ) } );
		}
	}
	return least;
}
} // namespace

TEST( ConvexDepth, IntervalMissesTheLeastWidthOfPolytopes )
{
	SeededRng rng( 1 );
	const QueryPtr query = makeQuery();
	int overlaps = 0, wide = 0;
	const int pairs = pairCount( 6000 );
	for ( int i = 0; i < pairs; ++i )
	{
		const Placed a = randomPolytope( rng, 0.6 ), b = randomPolytope( rng, 0.6 );
		const double core = coreDepth( a, b ), radii = a.body.radius + b.body.radius;
		const lw_clearance apart = distanceOf( a.shape, a.pose, b.shape, b.pose, query.get() );
		if ( core < 1e-9 || core == INFINITY ) // cores apart, or flat: the tests of moves look at them
		{
			continue;
		}
		const lw_depth depth = depthOf( a.shape, a.pose, b.shape, b.pose, query.get() );
		EXPECT_EQ( LW_DEPTH_OVERLAP, depth.kind );
		EXPECT_LE( depth.lower, core + radii + 1e-13 ) << i;
		EXPECT_GE( depth.upper, core + radii - 1e-13 ) << i;
		wide += depth.upper - depth.lower > 3e-13;
		overlaps++;
		const lw_vec3 between = depth.point_b - depth.point_a;
		EXPECT_NEAR( depth.upper, dot( between, depth.normal ), 1e-9 );
		EXPECT_NEAR( 1, length( depth.normal ), 1e-14 );
		(void)apart;
	}
	EXPECT_GT( overlaps, 1000 );
	EXPECT_LE( wide, overlaps / 100 );
}

TEST( ConvexDepth, SpheresAndCapsulesDifferFromTheirFormulas )
{
	SeededRng rng( 2 );
	const QueryPtr query = makeQuery();
	for ( int i = 0; i < 1000; ++i )
	{
		const double ra = rng.uniform( 0.1, 1 ), rb = rng.uniform( 0.1, 1 ), d = rng.uniform( 0, ra + rb ) * ( i % 10 != 0 );
		const ShapePtr a = makePrimitive( LW_SHAPE_SPHERE, ra ), b = makePrimitive( LW_SHAPE_SPHERE, rb );
		const lw_vec3 n = randomDirection( rng ), p = { 3, -2, 1 };
		const lw_depth depth = depthOf(
		    a, movedBy( lw_transform_identity(), p + d * n ), b, movedBy( lw_transform_identity(), p ), query.get() );
		EXPECT_NEAR( ra + rb - d, depth.upper, 1e-13 );
		EXPECT_NEAR( ra + rb - d, depth.lower, 2e-13 );
		if ( d > 1e-3 )
		{
			EXPECT_NEAR( 1, dot( n, depth.normal ), 1e-12 );
		}
	}
	// crossing axes: out across both
	const ShapePtr capsule = makePrimitive( LW_SHAPE_CAPSULE, 0.1, 1 );
	lw_transform turned = lw_transform_identity();
	const double q[4] = { std::sqrt( 0.5 ), 0, 0, std::sqrt( 0.5 ) }, zero[3] = { 0, 0, 0 };
	lw_transform_from_quaternion( zero, q, &turned );
	const lw_depth depth = depthOf( capsule, lw_transform_identity(), capsule, turned, query.get() );
	EXPECT_NEAR( 0.2, depth.upper, 1e-13 );
	EXPECT_NEAR( 0.2, depth.lower, 1e-13 );
	EXPECT_NEAR( 1, std::fabs( depth.normal.x ), 1e-12 );
}

TEST( ConvexDepth, PointsOfPrimitivesDifferFromTheirFormulas )
{
	const QueryPtr query = makeQuery();
	const ShapePtr ball = makePrimitive( LW_SHAPE_SPHERE, 0.1 );
	const ShapePtr cone = makePrimitive( LW_SHAPE_CONE, 1, 2 ), cylinder = makePrimitive( LW_SHAPE_CYLINDER, 1, 3 );
	lw_depth depth = depthOf( cylinder, lw_transform_identity(), ball, at( 0.7, 0, 0.2 ), query.get() );
	EXPECT_NEAR( 0.4, depth.upper, 1e-13 );
	EXPECT_NEAR( -1, depth.normal.x, 1e-14 );
	depth = depthOf( ball, at( 0.1, 0, -1.45 ), cylinder, lw_transform_identity(), query.get() );
	EXPECT_NEAR( 0.15, depth.upper, 1e-13 );
	EXPECT_NEAR( -1, depth.normal.z, 1e-14 );
	// a cone's side has the normal (2, 0, 1) / sqrt 5; (0.2, 0, 0) is 0.6 / sqrt 5 behind it and 1 above the base
	depth = depthOf( ball, at( 0.2, 0, 0 ), cone, lw_transform_identity(), query.get() );
	EXPECT_NEAR( 0.6 / std::sqrt( 5.0 ) + 0.1, depth.upper, 1e-13 );
	EXPECT_NEAR( 0.6 / std::sqrt( 5.0 ) + 0.1, depth.lower, 1e-13 );
	EXPECT_NEAR( 2 / std::sqrt( 5.0 ), depth.normal.x, 1e-14 );
	EXPECT_NEAR( 0.1, length( depth.point_a - lw_vec3{ 0.2, 0, 0 } ), 1e-14 );
	depth = depthOf( ball, at( 0, 0, -0.9 ), cone, lw_transform_identity(), query.get() );
	EXPECT_NEAR( 0.2, depth.upper, 1e-13 );
	EXPECT_NEAR( -1, depth.normal.z, 1e-14 );
}

namespace
{

/// How far a primitive reaches along a unit direction of the world.
double reachOf( lw_shape_type type, const double* d, const lw_transform& pose, const lw_vec3& n )
{
	const double x = n.x * pose.r[0][0] + n.y * pose.r[1][0] + n.z * pose.r[2][0],
	             y = n.x * pose.r[0][1] + n.y * pose.r[1][1] + n.z * pose.r[2][1],
	             z = n.x * pose.r[0][2] + n.y * pose.r[1][2] + n.z * pose.r[2][2], across = std::hypot( x, y );
	const double place = n.x * pose.t[0] + n.y * pose.t[1] + n.z * pose.t[2], half = 0.5 * d[1];
	switch ( type )
	{
	case LW_SHAPE_SPHERE:
		return place + d[0];
	case LW_SHAPE_CAPSULE:
		return place + d[0] + half * std::fabs( z );
	case LW_SHAPE_BOX:
		return place + 0.5 * ( d[0] * std::fabs( x ) + d[1] * std::fabs( y ) + d[2] * std::fabs( z ) );
	case LW_SHAPE_CYLINDER:
		return place + d[0] * across + half * std::fabs( z );
	default: // a cone
		return place + std::max( half * z, d[0] * across - half * z );
	}
}

} // namespace

TEST( ConvexDepth, ClosedFormsAreNotTheLeastWidthInTheWorld )
{
	SeededRng rng( 5 );
	const QueryPtr query = makeQuery();
	const lw_shape_type types[] = { LW_SHAPE_SPHERE, LW_SHAPE_CAPSULE, LW_SHAPE_BOX, LW_SHAPE_CYLINDER, LW_SHAPE_CONE };
	int overlaps[2] = { 0, 0 };
	for ( int i = 0; i < 4000; ++i )
	{
		const bool swapped = i % 2 == 0;
		lw_shape_type type[2] = { i % 3 == 0 ? LW_SHAPE_CAPSULE : LW_SHAPE_SPHERE, types[i % 3 == 0 ? i % 2 : i % 5] };
		swapped ? std::swap( type[0], type[1] ) : void();
		double size[2][3];
		lw_transform pose[2];
		ShapePtr shape[2];
		for ( int k = 0; k < 2; ++k )
		{
			for ( double& d : size[k] )
			{
				d = rng.uniform( 0.2, 1 );
			}
			shape[k] = makePrimitive( type[k], size[k][0], size[k][1], size[k][2] );
			pose[k] = randomPose( rng, 0.3 );
			pose[k].t[0] += 1000; // metres from the world's origin
		}
		const lw_depth depth = depthOf( shape[0], pose[0], shape[1], pose[1], query.get() );
		double least = INFINITY;
		const auto width = [&]( const lw_vec3& n )
		{ return reachOf( type[0], size[0], pose[0], -1.0 * n ) + reachOf( type[1], size[1], pose[1], n ); };
		for ( int k = 0; k < 300; ++k )
		{
			least = std::min( least, width( randomDirection( rng ) ) );
		}
		if ( depth.kind == LW_DEPTH_APART )
		{
			const lw_clearance apart = distanceOf( shape[0], pose[0], shape[1], pose[1], query.get() );
			EXPECT_GT( apart.upper, 0 );
			continue;
		}
		ASSERT_EQ( LW_DEPTH_OVERLAP, depth.kind );
		++overlaps[swapped];
		// no way out is shorter than the depth, and the one along its normal is as long
		EXPECT_LE( depth.lower, least + 1e-12 ) << i;
		EXPECT_NEAR( depth.upper, width( depth.normal ), 1e-11 ) << i;
		EXPECT_LE( depth.upper - depth.lower, 1e-12 ) << i;
		EXPECT_NEAR( depth.upper, dot( depth.point_b - depth.point_a, depth.normal ), 1e-9 ) << i;
	}
	EXPECT_GT( std::min( overlaps[0], overlaps[1] ), 500 );
}

TEST( ConvexDepth, CurvedBodiesHaveWideIntervals )
{
	SeededRng rng( 3 );
	const QueryPtr query = makeQuery();
	const lw_shape_type types[] = { LW_SHAPE_CYLINDER, LW_SHAPE_CONE, LW_SHAPE_BOX, LW_SHAPE_CAPSULE };
	std::vector<double> widths;
	const int pairs = pairCount( 2000 );
	for ( int i = 0; i < pairs; ++i )
	{
		const ShapePtr a = makePrimitive( types[rng.integer( 0, 1 )], rng.uniform( 0.1, 1 ), rng.uniform( 0.1, 1 ) );
		const ShapePtr b =
		    makePrimitive( types[rng.integer( 0, 3 )], rng.uniform( 0.1, 1 ), rng.uniform( 0.1, 1 ), rng.uniform( 0.1, 1 ) );
		const lw_depth depth = depthOf( a, randomPose( rng, 0.5 ), b, randomPose( rng, 0.5 ), query.get() );
		if ( depth.kind == LW_DEPTH_OVERLAP )
		{
			widths.push_back( depth.upper - depth.lower );
		}
	}
	std::sort( widths.begin(), widths.end() );
	ASSERT_GT( widths.size(), 1000u );
	EXPECT_LT( widths[widths.size() / 2], 1e-9 );
	EXPECT_LT( widths[widths.size() * 95 / 100], 1e-6 );
	std::printf( "widths: median %.1e, 95 %% %.1e, 99 %% %.1e, most %.1e\n", widths[widths.size() / 2],
	    widths[widths.size() * 95 / 100], widths[widths.size() * 99 / 100], widths.back() );
}

TEST( ConvexDepth, ParallelFacesAndEqualBodiesAreWide )
{
	const QueryPtr query = makeQuery();
	const ShapePtr box = makePrimitive( LW_SHAPE_BOX, 1, 2, 3 );
	lw_depth depth = depthOf( box, lw_transform_identity(), box, lw_transform_identity(), query.get() );
	EXPECT_NEAR( 1, depth.lower, 1e-13 );
	EXPECT_NEAR( 1, depth.upper, 1e-13 );
	depth = depthOf( box, at( 0, 0, 2.9 ), box, lw_transform_identity(), query.get() );
	EXPECT_NEAR( 0.1, depth.lower, 1e-13 );
	EXPECT_NEAR( 1, depth.normal.z, 1e-15 );
	depth = depthOf( box, at( 1, 0, 0 ), box, lw_transform_identity(), query.get() );
	EXPECT_LT( depth.upper, 1e-13 ); // faces touch: apart, or an overlap of nothing
	EXPECT_EQ( 0, depth.lower );
	depth = depthOf( box, at( 1.1, 0, 0 ), box, lw_transform_identity(), query.get() );
	EXPECT_EQ( LW_DEPTH_APART, depth.kind );
	EXPECT_EQ( 0, depth.upper );
}
