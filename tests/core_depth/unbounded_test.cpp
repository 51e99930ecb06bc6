// SPDX-License-Identifier: BSD-3-Clause
// Depths in half-spaces and planes; bodies without an inside; bad arguments.
#include "depth_bodies.hpp"

TEST( UnboundedDepth, FloorsAndWallsDifferFromTheirFormulas )
{
	SeededRng rng( 4 );
	const QueryPtr query = makeQuery();
	const ShapePtr floor = makePrimitive( LW_SHAPE_HALFSPACE, 0 ), wall = makePrimitive( LW_SHAPE_PLANE, 0 );
	for ( int i = 0; i < 500; ++i )
	{
		const Corners body = prism( rng.integer( 3, 8 ), { 0.5, 0.3, 0.8 }, 0.5 );
		const ShapePtr shape = meshOf( body, true );
		const lw_transform pose = randomPose( rng, 0.5 ), ground = randomPose( rng, 0.5 );
		double low = INFINITY, high = -INFINITY;
		const lw_vec3 up = { ground.r[0][2], ground.r[1][2], ground.r[2][2] };
		for ( lw_vec3 p : body.points )
		{
			const double z = dot( up, lw_transform_point( &pose, p ) - lw_vec3{ ground.t[0], ground.t[1], ground.t[2] } );
			low = std::min( low, z );
			high = std::max( high, z );
		}
		const lw_depth depth = depthOf( shape, pose, floor, ground, query.get() );
		const lw_depth other = depthOf( floor, ground, shape, pose, query.get() );
		const lw_depth through = depthOf( shape, pose, wall, ground, query.get() );
		EXPECT_EQ( low > 0 ? LW_DEPTH_APART : LW_DEPTH_OVERLAP, depth.kind );
		if ( low < 0 )
		{
			EXPECT_LE( depth.lower, -low + 1e-14 );
			EXPECT_NEAR( -low, depth.upper, 1e-13 );
			EXPECT_NEAR( 1, dot( up, depth.normal ), 1e-14 );
			EXPECT_NEAR( -1, dot( up, other.normal ), 1e-14 );
			EXPECT_NEAR( depth.upper, other.upper, 1e-13 );
			EXPECT_NEAR( low, dot( up, depth.point_a - lw_vec3{ ground.t[0], ground.t[1], ground.t[2] } ), 1e-13 );
			EXPECT_NEAR( depth.upper, dot( depth.normal, depth.point_b - depth.point_a ), 1e-13 );
			EXPECT_NEAR( other.upper, dot( other.normal, other.point_b - other.point_a ), 1e-13 );
		}
		if ( low < 0 && high > 0 )
		{
			EXPECT_NEAR( std::min( -low, high ), through.upper, 1e-13 );
			EXPECT_NEAR( -low < high ? 1 : -1, dot( up, through.normal ), 1e-14 );
		}
	}
	const ShapePtr cone = makePrimitive( LW_SHAPE_CONE, 1, 2 ), cylinder = makePrimitive( LW_SHAPE_CYLINDER, 1, 2 );
	EXPECT_NEAR( 0.7, depthOf( cone, at( 0, 0, 0.3 ), floor, lw_transform_identity(), query.get() ).upper, 1e-14 );
	EXPECT_NEAR( 0.7, depthOf( cylinder, at( 0, 0, 0.3 ), floor, lw_transform_identity(), query.get() ).lower, 1e-13 );
}

TEST( UnboundedDepth, SurfacesHaveAnInside )
{
	const QueryPtr query = makeQuery();
	Corners open = prism( 5, { 1, 1, 1 }, 1 );
	open.triangles.resize( open.triangles.size() - 3 );
	const ShapePtr surface = meshOf( open, false ), wall = makePrimitive( LW_SHAPE_PLANE, 0 ),
	               ball = makePrimitive( LW_SHAPE_SPHERE, 0.5 );
	EXPECT_EQ( LW_DEPTH_NO_INSIDE, depthOf( surface, at( 0.1, 0, 0 ), surface, lw_transform_identity(), query.get() ).kind );
	EXPECT_EQ(
	    LW_DEPTH_NO_INSIDE, depthOf( surface, lw_transform_identity(), wall, lw_transform_identity(), query.get() ).kind );
	EXPECT_EQ( INFINITY, depthOf( surface, lw_transform_identity(), wall, lw_transform_identity(), query.get() ).upper );
	EXPECT_EQ( LW_DEPTH_APART, depthOf( surface, at( 0, 0, 3 ), wall, lw_transform_identity(), query.get() ).kind );
	// a ball across a face of the surface has to leave it, or go in further
	const lw_depth depth = depthOf( ball, at( 0, 0, 1.2 ), surface, lw_transform_identity(), query.get() );
	EXPECT_EQ( LW_DEPTH_OVERLAP, depth.kind );
	EXPECT_LE( depth.lower, 0.3 );
	EXPECT_GE( depth.upper, 0.3 );
}

TEST( UnboundedDepth, BadArgumentsGiveAnAnswer )
{
	const QueryPtr query = makeQuery();
	const ShapePtr box = makePrimitive( LW_SHAPE_BOX, 1, 1, 1 ), floor = makePrimitive( LW_SHAPE_HALFSPACE, 0 );
	const lw_transform pose = lw_transform_identity();
	lw_depth out = {};
	lw_depth_def def = lw_depth_def_default();
	EXPECT_EQ( LW_ERROR_UNSUPPORTED, lw_shape_depth( floor.get(), &pose, floor.get(), &pose, &def, query.get(), &out ) );
	EXPECT_EQ( LW_DEPTH_UNKNOWN, out.kind );
	EXPECT_EQ( INFINITY, out.upper );
	EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT, lw_shape_depth( nullptr, &pose, box.get(), &pose, &def, query.get(), &out ) );
	EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT, lw_shape_depth( box.get(), nullptr, box.get(), &pose, &def, query.get(), &out ) );
	EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT, lw_shape_depth( box.get(), &pose, box.get(), &pose, &def, nullptr, &out ) );
	EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT, lw_shape_depth( box.get(), &pose, box.get(), &pose, &def, query.get(), nullptr ) );
	def.steps = 0;
	EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT, lw_shape_depth( box.get(), &pose, box.get(), &pose, &def, query.get(), &out ) );
	def = lw_depth_def_default();
	def.width = NAN;
	EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT, lw_shape_depth( box.get(), &pose, box.get(), &pose, &def, query.get(), &out ) );
	def = {};
	EXPECT_EQ( LW_ERROR_INVALID_DEF, lw_shape_depth( box.get(), &pose, box.get(), &pose, &def, query.get(), &out ) );
	EXPECT_EQ( LW_OK, lw_shape_depth( box.get(), &pose, box.get(), &pose, nullptr, query.get(), &out ) );
	EXPECT_EQ( LW_DEPTH_OVERLAP, out.kind );
}
