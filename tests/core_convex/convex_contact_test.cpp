// SPDX-License-Identifier: BSD-3-Clause
// Convex distance where the truth is known by construction: a boundary point of each piece, their outward normals opposed,
// the points set a known gap apart along them. The planes through the points then separate the pieces by exactly that gap,
// so it is the distance: also at 10^-15 of the size, where every iterative oracle gives up.
#include "convex_oracle.hpp"

#include <gtest/gtest.h>

#include <map>
#include <string>

using namespace oracle;

namespace
{
/// A boundary point with a direction in its normal cone.
struct Feature
{
	Vec point, normal;
	const char* name;
};

Vec unit( Vec v )
{
	return ( 1 / length( v ) ) * v;
}
real sign( SeededRng& rng )
{
	return rng.integer( 0, 1 ) == 0 ? -1 : 1;
}

Feature box_feature( SeededRng& rng, const double* half )
{
	static const char* const kinds[4] = { "", "face", "edge", "vertex" };
	int pinned = rng.integer( 1, 7 );
	real p[3], n[3];
	for ( int i = 0; i < 3; ++i )
	{
		real s = sign( rng );
		bool pin = ( pinned >> i & 1 ) != 0;
		p[i] = half[i] * ( pin ? s : (real)rng.uniform( -1, 1 ) );
		n[i] = pin ? s * rng.uniform( 0.05, 1 ) : 0;
	}
	int count = ( pinned & 1 ) + ( pinned >> 1 & 1 ) + ( pinned >> 2 & 1 );
	return { { p[0], p[1], p[2] }, unit( { n[0], n[1], n[2] } ), kinds[count] };
}

Feature cylinder_feature( SeededRng& rng, real r, real h )
{
	real phi = rng.uniform( 0, 6.283 ), c = std::cos( phi ), s = std::sin( phi ), side = sign( rng );
	real tilt = rng.uniform( 0.02, 1.55 );
	switch ( rng.integer( 0, 2 ) )
	{
	case 0:
		r *= rng.uniform( 0, 1 );
		return { { r * c, r * s, side * h }, { 0, 0, side }, "cap" };
	case 1:
		return { { r * c, r * s, h * (real)rng.uniform( -1, 1 ) }, { c, s, 0 }, "side" };
	default:
		return {
		    { r * c, r * s, side * h }, { std::cos( tilt ) * c, std::cos( tilt ) * s, side * std::sin( tilt ) }, "rim" };
	}
}

Feature cone_feature( SeededRng& rng, real r, real h )
{
	real phi = rng.uniform( 0, 6.283 ), c = std::cos( phi ), s = std::sin( phi );
	real slope = std::atan2( r, 2 * h ); // of the side's normal over the base plane
	real half_pi = std::acos( (real)0 ), f = rng.uniform( 0, 1 );
	auto normal = [&]( real angle ) { return Vec{ std::cos( angle ) * c, std::cos( angle ) * s, std::sin( angle ) }; };
	switch ( rng.integer( 0, 3 ) )
	{
	case 0:
		return { { f * r * c, f * r * s, -h }, { 0, 0, -1 }, "base" };
	case 1:
		return { { f * r * c, f * r * s, h - 2 * f * h }, normal( slope ), "slant" };
	case 2:
		return { { r * c, r * s, -h }, normal( slope - f * ( slope + half_pi ) ), "rim" };
	default:
		return { { 0, 0, h }, normal( slope + f * ( half_pi - slope ) ), "apex" };
	}
}

Feature triangle_feature( SeededRng& rng, const Body& body )
{
	int k = rng.integer( 0, 2 );
	Vec a = body.vertex( k ), b = body.vertex( ( k + 1 ) % 3 ), c = body.vertex( ( k + 2 ) % 3 );
	Vec n = unit( cross( b - a, c - a ) );
	real u = rng.uniform( 0, 1 ), v = rng.uniform( 0, 1 );
	switch ( rng.integer( 0, 2 ) )
	{
	case 0:
		return { a + ( u * ( 1 - v ) ) * ( b - a ) + ( u * v ) * ( c - a ), sign( rng ) * n, "face" };
	case 1:
	{
		Vec out = unit( cross( b - a, n ) );
		out = dot( out, c - a ) > 0 ? -1.0L * out : out;
		real tilt = rng.uniform( -1.5, 1.5 );
		return { a + u * ( b - a ), std::cos( tilt ) * out + std::sin( tilt ) * n, "edge" };
	}
	default:
		// The normal cone of a vertex: in the plane between the normals of its edges, any tilt out of it
		Vec e = cross( b - a, n ), f = cross( n, c - a );
		e = unit( dot( e, c - a ) > 0 ? -1.0L * e : e );
		f = unit( dot( f, b - a ) > 0 ? -1.0L * f : f );
		real tilt = rng.uniform( -1.5, 1.5 );
		return { a, std::cos( tilt ) * unit( u * e + ( 1 - u ) * f ) + std::sin( tilt ) * n, "vertex" };
	}
}

Feature random_feature( SeededRng& rng, const lwi_convex& shape )
{
	switch ( shape.type )
	{
	case LWI_CONVEX_BOX:
		return box_feature( rng, shape.size );
	case LWI_CONVEX_CYLINDER:
		return cylinder_feature( rng, shape.size[0], shape.size[1] );
	case LWI_CONVEX_CONE:
		return cone_feature( rng, shape.size[0], shape.size[1] );
	default:
		return triangle_feature( rng, Body{ shape } );
	}
}

/// Two unit vectors orthogonal to n and each other, turned by a random angle.
void frame( SeededRng& rng, Vec n, Vec out[2] )
{
	Vec axis = std::fabs( n.x ) < 0.6L ? Vec{ 1, 0, 0 } : Vec{ 0, 1, 0 };
	Vec e = unit( cross( n, axis ) ), f = cross( n, e );
	real angle = rng.uniform( 0, 6.283 );
	out[0] = std::cos( angle ) * e + std::sin( angle ) * f;
	out[1] = cross( n, out[0] );
}

/// The pose that puts b's feature `gap` before a's, normals opposed, any turn about them.
lw_transform place( SeededRng& rng, const Feature& a, const Feature& b, real gap )
{
	Vec k = -1.0L * b.normal, x[2], y[2];
	frame( rng, a.normal, x );
	frame( rng, k, y );
	const Vec n = a.normal;
	const real rows[3][3] = { { x[0].x, x[1].x, n.x }, { x[0].y, x[1].y, n.y }, { x[0].z, x[1].z, n.z } };
	const real columns[3][3] = { { y[0].x, y[0].y, y[0].z }, { y[1].x, y[1].y, y[1].z }, { k.x, k.y, k.z } };
	lw_transform m = {};
	for ( int i = 0; i < 3; ++i )
	{
		for ( int j = 0; j < 3; ++j )
		{
			m.r[i][j] = (double)( rows[i][0] * columns[0][j] + rows[i][1] * columns[1][j] + rows[i][2] * columns[2][j] );
		}
	}
	Vec t = a.point + gap * a.normal - rotate( m, b.point );
	m.t[0] = (double)t.x;
	m.t[1] = (double)t.y;
	m.t[2] = (double)t.z;
	return m;
}

/// How far the pose's own rounding can move the truth: half an ulp per entry of r (sqrt 3 of them per row), of t, twice.
constexpr real pose_error = 8 * ( DBL_EPSILON / 2 );

struct Tally
{
	std::map<std::string, int> features;
	int touching = 0, near = 0, separated = 0;
	real worst_width = 0, rounding_used = 0, worst_upper = 0;
	uint32_t most_iterations = 0;
	uint64_t iterations = 0;
};

void one_contact( SeededRng& rng, int ta, int tb, Tally& tally )
{
	double unit_size = rng.decade( -3, 3 ), small = rng.decade( -9, 0 );
	bool first = rng.integer( 0, 1 ) == 0;
	lwi_convex a = random_piece( rng, (lwi_convex_type)ta, first ? unit_size * small : unit_size );
	lwi_convex b = random_piece( rng, (lwi_convex_type)tb, first ? unit_size : unit_size * small );
	Feature fa = random_feature( rng, a ), fb = random_feature( rng, b );
	int regime = rng.integer( 0, 3 );
	real gap = regime == 0 ? 0 : unit_size * rng.decade( regime == 1 ? -16 : -9, regime == 1 ? -7 : 0 );
	lw_transform m = place( rng, fa, fb, gap );
	real scale = extent( a, b, m );

	lwi_convex_result r = lwi_convex_distance( &a, &b, &m, INFINITY, 0 );
	real width = ( r.upper - r.lower ) / scale;
	tally.features[std::string( fa.name ) + "-" + fb.name]++;
	( regime == 0 ? tally.touching : regime == 1 ? tally.near : tally.separated )++;
	tally.worst_width = std::max( tally.worst_width, width );
	if ( r.lower > 0 )
	{
		tally.rounding_used = std::max( tally.rounding_used, ( r.lower - gap ) / scale + LWI_CONVEX_ROUNDING );
	}
	tally.worst_upper = std::max( tally.worst_upper, ( gap - r.upper ) / scale );
	tally.most_iterations = std::max( tally.most_iterations, r.iterations );
	tally.iterations += r.iterations;
	ASSERT_LE( r.lower, gap + pose_error * scale ) << fa.name << "-" << fb.name << " gap/extent " << gap / scale;
	ASSERT_GE( r.upper, gap - ( pose_error + LWI_CONVEX_ROUNDING ) * scale )
	    << fa.name << "-" << fb.name << " gap/extent " << gap / scale;
	ASSERT_LE( width, width_target( a, b ) ) << fa.name << "-" << fb.name << " gap/extent " << gap / scale;
	Body x{ a }, y{ b };
	Vec pa = from( r.point_a ), pb = unrotate( m, from( r.point_b ) - offset( m ) );
	ASSERT_LE( length( pa - x.nearest( pa ) ), LWI_CONVEX_ROUNDING * scale );
	ASSERT_LE( length( pb - y.nearest( pb ) ), LWI_CONVEX_ROUNDING * scale );
}

class ConvexContact : public ::testing::TestWithParam<std::pair<int, int>>
{
};
} // namespace

TEST_P( ConvexContact, KnownGapBetweenFeatures )
{
	auto [ta, tb] = GetParam();
	SeededRng rng( 77u + 10u * (unsigned)ta + (unsigned)tb );
	Tally tally;
	const int count = 10000;
	for ( int i = 0; i < count; ++i )
	{
		one_contact( rng, ta, tb, tally );
		ASSERT_FALSE( HasFatalFailure() ) << "pair " << i;
	}
	std::printf( "%s-%s: %d pairs, %d touching, %d within 1e-7, %d feature pairs; worst: width %.2Lg, rounding used "
	             "%.2Lg of %.2g, upper below truth %.2Lg (of the extent), iterations %u (mean %.1f)\n",
	    names[ta], names[tb], count, tally.touching, tally.near, (int)tally.features.size(), tally.worst_width,
	    tally.rounding_used, LWI_CONVEX_ROUNDING, tally.worst_upper, tally.most_iterations,
	    (double)tally.iterations / count );
	EXPECT_GT( tally.touching, count / 6 );
	EXPECT_GT( tally.near, count / 6 );
	EXPECT_GT( tally.separated, count / 3 );
	const size_t kinds[4] = { 3, 3, 3, 4 };
	EXPECT_EQ( tally.features.size(), kinds[ta] * kinds[tb] );
	for ( const auto& feature : tally.features )
	{
		EXPECT_GT( feature.second, 100 ) << feature.first;
	}
}

INSTANTIATE_TEST_SUITE_P( combinations, ConvexContact, ::testing::ValuesIn( combinations ),
    []( const auto& pair ) { return std::string( names[pair.param.first] ) + "_" + names[pair.param.second]; } );
