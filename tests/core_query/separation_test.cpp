// SPDX-License-Identifier: BSD-3-Clause
// Planes between shapes at several poses, against heights of all their points: verdicts apart, near and neither.
#include "oracle_subject.hpp"
#include "sanitized.hpp"

#include "distance/separation.h"

namespace
{
using namespace oracle;

constexpr double u = 0x1p-24;

/// How far the points of a model reach along n, of any length, from its own origin; dilated by `radius`.
double reach( const Model& m, Vec n, real radius )
{
	real most = -INFINITY;
	const double* s = m.solid.size;
	const real across = std::sqrt( n.x * n.x + n.y * n.y ), up = s[1] * n.z;
	for ( Vec p : m.points )
	{
		most = std::max( most, dot( n, p ) );
	}
	if ( m.corners == 0 )
	{
		most = m.solid.type == LWI_CONVEX_BOX    ? std::abs( n.x ) * s[0] + std::abs( n.y ) * s[1] + std::abs( n.z ) * s[2]
		       : m.solid.type == LWI_CONVEX_CONE ? std::max( up, s[0] * across - up )
		                                         : s[0] * across + std::abs( up );
	}
	return to_double( most + radius );
}

const lwi_kernels& kernels()
{
	return *lwi_kernels_get( lw_simd_available() );
}

/// Shapes at their poses `at`, the first of which is the middle, made ready for a search.
struct Ready
{
	lwi_cloud cloud = {};
	lwi_swept_poses poses;

	explicit Ready( const lwi_swept_poses& from ) : poses( from )
	{
		poses.middle = from.at[0];
		poses.cloud = &cloud;
	}
};

/// lwi_separate(), both at their middle poses. @param direction in: where to begin, out: the plane; tree frame of b
bool separate_two( const lwi_swept_poses& a, const lwi_swept_poses& b, float limit, float direction[3], int directions )
{
	lw_transform from[2] = { a.at[0], b.at[0] };
	const lw_shape* shapes[2] = { a.shape, b.shape };
	for ( int i = 0; i < 2; ++i )
	{
		const lw_vec3 origin = lwi_transform( &from[i], lwi_load( shapes[i]->origin ) );
		const double t[3] = { origin.x, origin.y, origin.z };
		std::copy( t, t + 3, from[i].t );
	}
	const lw_transform a_from_b = lwi_relative( &from[0], &from[1] );
	lwi_motion m;
	for ( int i = 0; i < 9; ++i )
	{
		m.r[i] = (float)a_from_b.r[i / 3][i % 3];
		m.t[i / 3] = (float)a_from_b.t[i / 3];
	}
	lwi_plane plane = { { direction[0], direction[1], direction[2] } };
	const bool apart = lwi_separate( &kernels(), a.shape, b.shape, &m, limit, &plane, directions );
	std::copy( plane.direction, plane.direction + 3, direction );
	return apart;
}

/// A subject at its poses.
struct Moving
{
	Subject subject;
	lwi_swept_poses places = {};

	std::vector<Pose> poses() const
	{
		std::vector<Pose> out;
		for ( int i = 0; i < places.count; ++i )
		{
			out.push_back( pose_from( places.at[i] ) );
		}
		return out;
	}

	/// Of all poses along a unit n. Triangles are dilated afterwards, balls move as they are.
	double reach( Vec n ) const
	{
		double most = -INFINITY;
		for ( const Pose& pose : poses() )
		{
			const Vec along = { dot( pose.column[0], n ), dot( pose.column[1], n ), dot( pose.column[2], n ) };
			for ( const Part& part : parts_of( subject ) )
			{
				const bool ball = part.model.corners == 1;
				const real radius = part.model.radius * ( ball ? length( along ) : 1 );
				most = std::max(
				    most, ::reach( part.model, along, radius ) + to_double( dot( n, pose.t ) + dot( along, part.center ) ) );
			}
		}
		return most;
	}

	/// A point of the hull of all poses that is farthest along n, by differences: far less exact than reach().
	Vec farthest( Vec n ) const
	{
		const real h = 1e-6L, length_n = length( n );
		auto at = [&]( Vec v ) { return (real)reach( 1 / length( v ) * v ) * length( v ); };
		const Vec unit = 1 / length_n * n;
		return { ( at( unit + Vec{ h, 0, 0 } ) - at( unit - Vec{ h, 0, 0 } ) ) / ( 2 * h ),
		    ( at( unit + Vec{ 0, h, 0 } ) - at( unit - Vec{ 0, h, 0 } ) ) / ( 2 * h ),
		    ( at( unit + Vec{ 0, 0, h } ) - at( unit - Vec{ 0, 0, h } ) ) / ( 2 * h ) };
	}

	double size() const
	{
		double way = 0;
		std::vector<Pose> all = poses();
		for ( const Pose& pose : all )
		{
			way = std::max( way, to_double( length( pose.t - all[0].t ) ) );
		}
		return to_double( subject.model.size ) + way;
	}
};

Moving random_moving( SeededRng& rng, double size, double far, bool moves )
{
	Moving m;
	m.subject = make_subject( rng, types[rng.integer( 0, type_count - 1 )], size );
	m.places.shape = m.subject.shape.get();
	m.places.count = 1;
	m.places.at[0] = random_pose( rng, far );
	const double step = size * rng.decade( -3, 0 ), turn = rng.decade( -3, -0.3 );
	const bool several = moves && rng.integer( 0, 2 ) > 0;
	for ( int i = 1; i < 3 && several; ++i )
	{
		m.places.count = 3;
		const lw_vec3 axis = random_direction( rng );
		const double q[4] = {
		    axis.x * std::sin( turn ), axis.y * std::sin( turn ), axis.z * std::sin( turn ), std::cos( turn ) };
		lw_transform move;
		const lw_vec3 by = to_double( random_point( rng, step ) );
		const double t[3] = { by.x, by.y, by.z };
		lw_transform_from_quaternion( t, q, &move );
		const double* old = m.places.at[0].t;
		m.places.at[i] = lw_transform_multiply( &move, &m.places.at[0] );
		for ( int k = 0; k < 3; ++k )
		{
			m.places.at[i].t[k] = old[k] + t[k];
		}
	}
	return m;
}

double gap( const Moving& a, const Moving& b, Vec n )
{
	return -b.reach( -1.0L * n ) - a.reach( n );
}

/// The widest gap that steps towards the nearest points of the hulls pass by (Gilbert 1966), and its direction.
double widest_gap( const Moving& a, const Moving& b, Vec* direction )
{
	Vec v = pose_from( b.places.at[0] ).t - pose_from( a.places.at[0] ).t;
	v = length( v ) > 0 ? v : Vec{ 1, 0, 0 };
	double best = -INFINITY;
	for ( int i = 0; i < 120; ++i )
	{
		const Vec n = 1 / length( v ) * v;
		const double now = gap( a, b, n );
		if ( now > best )
		{
			best = now;
			*direction = n;
		}
		const Vec s = b.farthest( -1.0L * n ) - a.farthest( n ), e = s - v;
		const real t = dot( e, e ) > 0 ? std::min( std::max( -dot( v, e ) / dot( e, e ), (real)0 ), (real)1 ) : 0;
		v = i == 0 ? s : v + t * e;
		if ( !( length( v ) > 1e-9L * ( a.size() + b.size() ) ) )
		{
			break;
		}
	}
	return best;
}

double dilation( const Moving& m )
{
	return m.subject.model.corners > 1 ? to_double( m.subject.model.radius ) : 0;
}

lwi_swept_plane plane_along( const Moving& b, Vec n )
{
	lwi_swept_plane out = {};
	const Pose pose = pose_from( b.places.at[0] );
	const lw_vec3 o = lwi_load( b.places.shape->origin );
	for ( int k = 0; k < 3; ++k )
	{
		out.direction[k] = static_cast<float>( dot( pose.column[k], n ) );
	}
	const Vec back = -1.0L * n;
	const double reach = b.reach( back ) - dilation( b ) - to_double( dot( back, pose.apply( from( o ) ) ) );
	out.reach_b = std::nextafter( static_cast<float>( reach ), INFINITY );
	return out;
}

Vec direction_of( const Moving& b, const lwi_swept_plane& plane )
{
	const Pose pose = pose_from( b.places.at[0] );
	const float* d = plane.direction;
	const Vec n = (real)d[0] * pose.column[0] + (real)d[1] * pose.column[1] + (real)d[2] * pose.column[2];
	return 1 / length( n ) * n;
}

void random_pair( SeededRng& rng, Moving& a, Moving& b )
{
	const double size = rng.decade( -3, 1 );
	a = random_moving( rng, size, 0.1 * size, true );
	b = random_moving( rng, size * rng.decade( -1, 1 ), 0, rng.integer( 0, 2 ) == 0 );
	const lw_vec3 d = random_direction( rng );
	const double far = rng.uniform( 0.3, 1.5 ) * ( a.size() + b.size() );
	const double away[3] = { far * d.x, far * d.y, far * d.z };
	for ( int i = 0; i < b.places.count; ++i )
	{
		for ( int k = 0; k < 3; ++k )
		{
			b.places.at[i].t[k] += away[k];
		}
	}
}

} // namespace

TEST( Separation, ExtremePointOutsideOfHull )
{
	SeededRng rng;
	for ( int i = 0; i < unlessSanitized( 600, 20 ); ++i )
	{
		Moving m = random_moving( rng, rng.decade( -3, 1 ), 0, false );
		m.places.at[0] = lw_transform_identity();
		const lw_shape& shape = *m.places.shape;
		const uint32_t count = shape.extreme_blocks * LWI_WIDTH;
		ASSERT_GE( count, 8u );
		const double slack = 8 * u * to_double( m.subject.model.size );
		for ( int k = 0; k < 60; ++k )
		{
			const Vec n = from( random_direction( rng ) );
			for ( uint32_t j = 0; j < count; ++j )
			{
				const auto& at = shape.extreme_points[j / LWI_WIDTH].at;
				const uint32_t lane = j % LWI_WIDTH;
				const Vec point = {
				    at[0][lane] + shape.origin[0], at[1][lane] + shape.origin[1], at[2][lane] + shape.origin[2] };
				ASSERT_LE( dot( n, point ), m.reach( n ) - dilation( m ) + slack )
				    << type_names[m.subject.type == types[0] ? 0 : 1] << ", type " << m.subject.type << ", shape " << i;
			}
		}
	}
}

TEST( Separation, NearIsNotNearOrApartIsNotApart )
{
	SeededRng rng;
	int apart = 0, near = 0, separable = 0, missed = 0;
	for ( int i = 0; i < unlessSanitized( 1500, 300 ); ++i )
	{
		Moving a, b;
		random_pair( rng, a, b );
		Vec best;
		const double widest = widest_gap( a, b, &best ), size = a.size() + b.size();
		const double shares[6] = { 0.1, 0.5, 0.9, 0.99, 1.01, 1.5 };
		const double limit =
		    widest > 0 ? widest * shares[rng.integer( 0, 5 )] : rng.integer( 0, 1 ) * size * rng.decade( -4, -1 );
		const lw_vec3 start = random_direction( rng );
		float direction[3] = { static_cast<float>( start.x ), static_cast<float>( start.y ), static_cast<float>( start.z ) };
		lwi_swept_plane plane = {};
		Ready ready_a( a.places ), ready_b( b.places );
		const lwi_separation result =
		    lwi_separate_swept( &kernels(), &ready_a.poses, &ready_b.poses, limit, direction, &plane );
		const bool is_apart = result == LWI_APART, is_near = result == LWI_NEAR || result == LWI_MEET;
		const std::string what = "pair " + std::to_string( i ) + ", types " + std::to_string( a.subject.type ) + " " +
		                         std::to_string( b.subject.type ) + ", widest " + std::to_string( widest / size );
		apart += is_apart;
		near += is_near;
		if ( is_apart )
		{
			const Vec n = direction_of( b, plane );
			ASSERT_GE( gap( a, b, n ), limit ) << what;
			const lw_vec3 origin =
			    to_double( pose_from( b.places.at[0] ).apply( from( lwi_load( b.places.shape->origin ) ) ) );
			ASSERT_GE( (double)plane.reach_b + 16 * u * size,
			    b.reach( -1.0L * n ) - dilation( b ) + to_double( dot( n, from( origin ) ) ) )
			    << what;
		}
		const double rounding = ( limit + dilation( a ) + dilation( b ) ) * 0x1p-20 + 128 * u * size;
		if ( is_near )
		{
			ASSERT_LE( widest, limit + rounding ) << what;
		}
		if ( widest >= limit + rounding )
		{
			++separable;
			missed += !is_apart;
		}
	}
	std::printf( "%d apart, %d near; %d of %d planes missed\n", apart, near, missed, separable );
	EXPECT_GE( apart, unlessSanitized( 300, 3 ) );
	EXPECT_GE( near, unlessSanitized( 150, 1 ) );
	EXPECT_LE( missed, separable / 20 );
}

TEST( Separation, TwoShapesAreNearerThanTheirPlaneSays )
{
	SeededRng rng;
	int apart = 0, separable = 0, missed = 0;
	for ( int i = 0; i < unlessSanitized( 1500, 300 ); ++i )
	{
		Moving a, b;
		random_pair( rng, a, b );
		for ( Moving* m : { &a, &b } )
		{
			m->places.count = 1;
		}
		Vec best;
		const double widest = widest_gap( a, b, &best ) + dilation( a ) + dilation( b ), size = a.size() + b.size();
		const double shares[6] = { 0.01, 0.5, 0.9, 0.99, 1.01, 1.5 };
		const double limit = std::max( widest, 1e-3 * size ) * shares[rng.integer( 0, 5 )];
		const lw_vec3 start = random_direction( rng );
		float direction[3] = { static_cast<float>( start.x ), static_cast<float>( start.y ), static_cast<float>( start.z ) };
		const bool found = separate_two( a.places, b.places, static_cast<float>( limit ), direction, 3 );
		const double far = to_double( length( pose_from( b.places.at[0] ).t - pose_from( a.places.at[0] ).t ) );
		const double rounding = 64 * u * ( size + far );
		if ( found )
		{
			++apart;
			const Vec n = direction_of( b, { { direction[0], direction[1], direction[2] }, 0 } );
			ASSERT_GE( gap( a, b, n ) + dilation( a ) + dilation( b ), limit - rounding )
			    << "pair " << i << ", types " << a.subject.type << " " << b.subject.type;
		}
		if ( widest >= limit + rounding )
		{
			++separable;
			missed += !found;
		}
	}
	std::printf( "%d apart; %d of %d planes missed\n", apart, missed, separable );
	EXPECT_GE( apart, unlessSanitized( 300, 3 ) );
	EXPECT_LE( missed, separable / 20 );
}

TEST( Separation, KnownPlaneThatHoldsIsPassedOver )
{
	SeededRng rng;
	int held = 0, none = 0;
	for ( int i = 0; i < unlessSanitized( 1500, 300 ); ++i )
	{
		Moving a, b;
		random_pair( rng, a, b );
		lwi_swept_plane known[4];
		double gaps[4], size = a.size() + b.size();
		Vec best = from( random_direction( rng ) );
		widest_gap( a, b, &best );
		for ( int k = 0; k < 4; ++k )
		{
			Vec n = best + random_point( rng, rng.decade( -3, 0.3 ) );
			known[k] = plane_along( b, 1 / length( n ) * n );
			gaps[k] = gap( a, b, direction_of( b, known[k] ) );
		}
		const double limit = std::max( 0.0, rng.uniform( 0.5, 1.5 ) * gaps[rng.integer( 0, 3 )] );
		lwi_planes8 planes = {};
		for ( uint32_t k = 0; k < LWI_WIDTH; ++k )
		{
			lwi_plane_to_lane( &planes, k, k < 4 ? known[k] : lwi_swept_plane{ {}, INFINITY } );
		}
		Ready ready_a( a.places ), ready_b( b.places );
		const uint32_t which =
		    std::min( lwi_swept_apart_by( &kernels(), &ready_a.poses, &ready_b.poses, limit, &planes ), 4u );
		const double rounding = ( limit + dilation( a ) + dilation( b ) ) * 0x1p-20 + 128 * u * size;
		for ( uint32_t k = 0; k < 4; ++k )
		{
			if ( which == k )
			{
				++held;
				ASSERT_GE( gaps[k], limit ) << "pair " << i;
			}
			if ( which == 4 )
			{
				++none;
				ASSERT_LE( gaps[k], limit + rounding ) << "pair " << i << ", plane " << k;
			}
		}
	}
	EXPECT_GE( held, unlessSanitized( 200, 2 ) );
	EXPECT_GE( none, unlessSanitized( 200, 2 ) );
}
