// SPDX-License-Identifier: BSD-3-Clause
// Half-spaces and planes against every type of shape, in scenes, under checkers and edges. The oracle: heights of all points
// of a shape above the plane in long double, those of solids in closed form.
#include "one_joint.hpp"
#include "oracle_subject.hpp"

#include <array>
#include <cstring>
#include <limits>

using namespace oracle;

namespace
{
const double inf = std::numeric_limits<double>::infinity();
constexpr real roundoff = 0x1p-53L;

struct Span
{
	real low = INFINITY, high = -INFINITY;

	void add( real z, real radius )
	{
		low = std::min( low, z - radius );
		high = std::max( high, z + radius );
	}
};

/// Heights of a model about `center`, in the frame whose z axis is the plane's normal.
void add_model( const Model& m, const Pose& plane_from_shape, Vec center, Span& span )
{
	for ( Vec p : m.points )
	{
		span.add( plane_from_shape.apply( p + center ).z, m.radius );
	}
	if ( m.corners != 0 )
	{
		return;
	}
	const double* s = m.solid.size;
	real z = plane_from_shape.apply( center ).z;
	real nx = plane_from_shape.column[0].z, ny = plane_from_shape.column[1].z, nz = plane_from_shape.column[2].z;
	real flat = std::hypot( nx, ny );
	switch ( m.solid.type )
	{
	case LWI_CONVEX_BOX:
		span.add( z, std::fabs( nx ) * s[0] + std::fabs( ny ) * s[1] + std::fabs( nz ) * s[2] );
		break;
	case LWI_CONVEX_CYLINDER:
		span.add( z, flat * s[0] + std::fabs( nz ) * s[1] );
		break;
	default:
		span.add( z + nz * s[1], 0 );
		span.add( z - nz * s[1], flat * s[0] );
	}
}

real distance_to_plane( const Subject& s, const Pose& plane_from_shape, bool two_sided )
{
	Span span;
	for ( const Part& part : parts_of( s ) )
	{
		Span one;
		add_model( part.model, plane_from_shape, part.center, one );
		// of a soup each piece counts for itself: only some may lie across
		span.low = std::min( span.low, one.low );
		span.high = std::max( span.high, one.high );
	}
	if ( !two_sided )
	{
		return std::max( span.low, (real)0 );
	}
	// each connected piece
	real best = INFINITY;
	for ( const Part& part : parts_of( s ) )
	{
		const Model& m = part.model;
		for ( std::size_t i = 0; i < m.count(); ++i )
		{
			Span one;
			if ( m.corners == 0 )
			{
				add_model( m, plane_from_shape, part.center, one );
			}
			for ( int k = 0; k < m.corners; ++k )
			{
				Vec p = m.points[i * static_cast<std::size_t>( m.corners ) + static_cast<std::size_t>( k )];
				one.add( plane_from_shape.apply( p + part.center ).z, m.radius );
			}
			real d = one.low <= 0 && one.high >= 0 ? 0 : std::min( std::fabs( one.low ), std::fabs( one.high ) );
			best = std::min( best, d );
		}
	}
	return best;
}

ShapePtr make_unbounded( bool two_sided )
{
	lw_shape* shape = nullptr;
	EXPECT_EQ( LW_OK,
	    lw_shape_create_primitive( two_sided ? LW_SHAPE_PLANE : LW_SHAPE_HALFSPACE, nullptr, nullptr, nullptr, &shape ) );
	return ShapePtr( shape );
}
} // namespace

TEST( UnboundedShapes, BoxLeavesOutAPart )
{
	for ( const bool two_sided : { false, true } )
	{
		const lw_shape_info info = lw_shape_get_info( make_unbounded( two_sided ).get() );
		for ( int k = 0; k < 2; ++k )
		{
			EXPECT_EQ( info.box_min[k], -HUGE_VAL );
			EXPECT_EQ( info.box_max[k], HUGE_VAL );
		}
		EXPECT_EQ( info.box_max[2], 0 );
		EXPECT_EQ( info.box_min[2], two_sided ? 0 : -HUGE_VAL );
	}
}

class Unbounded : public ::testing::TestWithParam<int>
{
};

TEST_P( Unbounded, DistanceContradictsTheHeightsOfPoints )
{
	SeededRng rng( 20260401u + (unsigned)GetParam() );
	QueryPtr query = makeQuery();
	int apart = 0, touching = 0, far = 0;
	for ( int i = 0; i < 3000; ++i )
	{
		double size = rng.decade( -4, 3 );
		Subject s = make_subject( rng, types[GetParam()], size );
		bool two_sided = i % 2 == 0;
		ShapePtr plane = make_unbounded( two_sided );
		lw_transform pose_s = random_pose( rng, size * rng.uniform( 0, 5 ) );
		lw_transform pose_p = random_pose( rng, size * rng.uniform( 0, 2 ) );
		Pose plane_from_shape = relative( pose_p, pose_s );
		real truth = distance_to_plane( s, plane_from_shape, two_sided );
		real scale = length( offset( pose_s ) - offset( pose_p ) ) + 2 * s.model.size;
		lw_range range = lw_range_exact();
		if ( i % 3 == 0 )
		{
			range.max_d = size * rng.uniform( 0.1, 3 );
		}
		lw_clearance c;
		bool first = rng.integer( 0, 1 ) == 0;
		const lw_shape *a = first ? plane.get() : s.shape.get(), *b = first ? s.shape.get() : plane.get();
		const lw_transform &pose_a = first ? pose_p : pose_s, &pose_b = first ? pose_s : pose_p;
		ASSERT_EQ( LW_OK, lw_shape_distance( a, &pose_a, b, &pose_b, &range, query.get(), &c ) );
		::testing::Message story;
		story << "size " << size << " scale " << scale << " truth " << truth << " got " << c.lower << " " << c.upper;
		SCOPED_TRACE( story );
		ASSERT_LE( c.lower, truth + 64 * roundoff * scale );
		if ( c.kind == LW_CLEARANCE_FAR )
		{
			++far;
			ASSERT_GE( truth, range.max_d - 64 * roundoff * scale );
			continue;
		}
		ASSERT_GE( c.upper, truth - 64 * roundoff * scale );
		ASSERT_LE( c.upper, truth + 160 * roundoff * scale );
		ASSERT_LE( c.upper - c.lower, 400 * roundoff * scale );
		real world = length( offset( pose_s ) ) + length( offset( pose_p ) );
		Vec on_plane = from( first ? c.point_a : c.point_b ), on_shape = from( first ? c.point_b : c.point_a );
		ASSERT_NEAR(
		    0, to_double( length( on_plane - on_shape ) - c.upper ), to_double( 64 * roundoff * ( scale + world ) ) );
		real height = unrotate( pose_p, on_plane - offset( pose_p ) ).z;
		ASSERT_LE( two_sided ? std::fabs( height ) : height, 64 * roundoff * ( scale + world ) );
		( c.upper > 0 ? apart : touching ) += 1;
	}
	std::printf( "%d apart, %d touching, %d beyond max_d\n", apart, touching, far );
	EXPECT_GE( apart, 500 );
	EXPECT_GE( touching, 300 );
	EXPECT_GE( far, 100 );
}

INSTANTIATE_TEST_SUITE_P( types, Unbounded, ::testing::Range( 0, type_count ),
    []( const auto& one ) { return std::string( type_names[one.param] ); } );

namespace
{
/// A robot that is one body on a floating joint. The scene is its own from now on.
struct Flying : OneJoint
{
	Flying( const lw_shape* body, lw_scene* obstacles )
	{
		const double axis[3] = { 0, 0, 1 };
		lw_diag diag = {};
		scene = obstacles;
		EXPECT_EQ( LW_OK, makeRobot( body, lw_transform_identity(), LW_JOINT_FLOATING, axis, 0, &diag ) ) << diag.message;
		lw_checker_def def = lw_checker_def_default();
		def.robot = robot;
		def.scene = scene;
		EXPECT_EQ( LW_OK, lw_checker_create( &def, nullptr, &diag, &checker ) ) << diag.message;
	}
};

/// x y z qx qy qz qw within a distance of the origin along each axis.
std::array<double, 7> random_place( SeededRng& rng, double reach )
{
	std::array<double, 7> q;
	for ( int i = 0; i < 7; ++i )
	{
		q[i] = i < 3 ? rng.uniform( -reach, reach ) : rng.uniform( -1, 1 );
	}
	return q;
}
} // namespace

TEST( UnboundedScenes, SceneDiffersFromItsPairs )
{
	SeededRng rng;
	for ( int round = 0; round < 60; ++round )
	{
		std::vector<Subject> subjects;
		std::vector<ShapePtr> planes;
		std::vector<lw_scene_shape_def> shapes;
		const char* groups[1] = { "everything" };
		for ( int i = 0; i < 20; ++i )
		{
			lw_scene_shape_def def = { nullptr, 0, random_pose( rng, rng.uniform( 0, 20 ) ) };
			if ( rng.integer( 0, 3 ) == 0 || round % 10 == 0 )
			{
				planes.push_back( make_unbounded( rng.integer( 0, 1 ) == 0 ) );
				def.shape = planes.back().get();
			}
			else
			{
				subjects.push_back( make_subject( rng, types[rng.integer( 0, type_count - 1 )], rng.decade( -1, 0.5 ) ) );
				def.shape = subjects.back().shape.get();
			}
			shapes.push_back( def );
		}
		lw_scene_def def = lw_scene_def_default();
		def.object_names = groups;
		def.object_count = 1;
		def.shapes = shapes.data();
		def.shape_count = static_cast<uint32_t>( shapes.size() );
		lw_scene* scene = nullptr;
		ASSERT_EQ( LW_OK, lw_scene_create( &def, nullptr, nullptr, &scene ) );
		lw_shape_type type = round % 2 == 0 ? LW_SHAPE_SPHERE : types[rng.integer( 0, type_count - 1 )];
		Subject probe = make_subject( rng, type, rng.decade( -2, 0 ) );
		Flying flying( probe.shape.get(), scene );
		ASSERT_NE( nullptr, flying.checker );
		QueryPtr query = makeQuery( scene, flying.checker );
		for ( int i = 0; i < 20; ++i )
		{
			const std::array<double, 7> q = random_place( rng, rng.uniform( 0, 40 ) );
			lw_transform pose;
			ASSERT_EQ( LW_OK, lw_transform_from_quaternion( q.data(), q.data() + 3, &pose ) );
			lw_range range = lw_range_exact();
			range.max_d = i % 2 == 0 ? inf : rng.uniform( 0.1, 5 );
			lw_query_reset( query.get() ); // a warm start would hide the loss by the gaps
			double least = inf;
			lw_clearance c;
			for ( const lw_scene_shape_def& one : shapes )
			{
				ASSERT_EQ( LW_OK, lw_shape_distance( probe.shape.get(), &pose, one.shape, &one.world_from_shape, nullptr,
				                      query.get(), &c ) );
				least = std::min( least, c.upper );
			}
			if ( i % 3 == 0 )
			{
				range.max_d = least + 1e-6; // no room for a gap that is too large
			}
			lw_state_result state;
			ASSERT_EQ( LW_OK,
			    lw_checker_state( flying.checker, query.get(), q.data(), LW_CHECK_ENVIRONMENT, &range, false, &state ) );
			c = state.environment;
			if ( least < range.max_d )
			{
				ASSERT_NEAR( least, c.upper, 1e-13 * ( 1 + least ) );
			}
			else
			{
				ASSERT_EQ( LW_CLEARANCE_FAR, c.kind );
			}
		}
		lw_clearance c;
		lw_transform id = lw_transform_identity();
		ShapePtr plane = make_unbounded( false );
		EXPECT_EQ( LW_ERROR_UNSUPPORTED, lw_shape_distance( plane.get(), &id, plane.get(), &id, nullptr, query.get(), &c ) );
	}
}

namespace
{
/// A ball of radius 0.1 at the end of an arm of 1 m that turns about the y axis at the origin, above a floor at z = -0.5.
struct Arm : OneJoint
{
	ShapePtr ball = makePrimitive( LW_SHAPE_SPHERE, 0.1 );
	ShapePtr floor = make_unbounded( false );

	Arm()
	{
		const double about_y[3] = { 0, 1, 0 };
		lw_diag diag = {};
		EXPECT_EQ(
		    LW_ERROR_INVALID_ARGUMENT, makeRobot( floor.get(), at( 1, 0, 0 ), LW_JOINT_REVOLUTE, about_y, 3, &diag ) );
		EXPECT_NE( nullptr, std::strstr( diag.message, "'arm'" ) ) << diag.message;
		EXPECT_EQ( LW_OK, makeRobot( ball.get(), at( 1, 0, 0 ), LW_JOINT_REVOLUTE, about_y, 3, &diag ) );
		makeChecker( floor.get(), at( 3, 4, -0.5 ) );
	}
};
} // namespace

TEST( UnboundedScenes, CheckerLosesTheFloor )
{
	Arm arm;
	QueryPtr query = makeQuery( nullptr, arm.checker );
	lw_edge_def edge = lw_edge_def_default();
	edge.flags = LW_CHECK_ENVIRONMENT;
	edge.min_d = 0.01;
	edge.slack = 0.001;
	for ( double q = -2.9; q < 2.9; q += 0.05 )
	{
		double truth = std::max( 0.0, 0.5 - std::sin( q ) - 0.1 ); // turning about y takes x down
		lw_state_result state;
		ASSERT_EQ( LW_OK, lw_checker_state( arm.checker, query.get(), &q, LW_CHECK_ENVIRONMENT, nullptr, false, &state ) );
		ASSERT_NEAR( truth, state.environment.upper, 1e-14 );
		ASSERT_LE( state.environment.lower, truth + 1e-15 );
		double from = -2.9, to = q;
		lw_edge_result result;
		ASSERT_EQ( LW_OK, lw_checker_edge( arm.checker, query.get(), &from, &to, &edge, &result ) );
		double least = inf;
		for ( int k = 0; k <= 1000; ++k )
		{
			least = std::min( least, 0.4 - std::sin( from + ( to - from ) * k / 1000 ) );
		}
		if ( std::abs( least - edge.min_d ) > 0.01 )
		{
			ASSERT_EQ( least > edge.min_d ? LW_VERDICT_FREE : LW_VERDICT_BLOCKED, result.verdict ) << q << " " << least;
		}
	}
}
