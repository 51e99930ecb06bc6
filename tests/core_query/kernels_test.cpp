// SPDX-License-Identifier: BSD-3-Clause
// Kernels: every level against the scalar one bit for bit, and every gap against an exact distance in double.
#include "kernel_levels.hpp"
#include "seeded_rng.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

#include "distance/convex.h"
#include "distance/tri_tri.h"
#include "base/sincos.h"

namespace
{

struct Input
{
	lwi_node node;
	lwi_obb8 obbs;
	lwi_obb obb;
	float along[3];
	lwi_leaf leaf, other;
	lwi_box8 boxes;
	lwi_motion motion;
	lwi_primitive primitive;
	float sphere[4];
	double scale;
};

void unit( SeededRng& rng, float out[3] )
{
	double n[3] = { rng.uniform( -1, 1 ), rng.uniform( -1, 1 ), rng.uniform( -1, 1 ) };
	double length = std::sqrt( n[0] * n[0] + n[1] * n[1] + n[2] * n[2] );
	for ( int axis = 0; axis < 3; ++axis )
	{
		out[axis] = static_cast<float>( length > 0 ? n[axis] / length : 0.0 );
	}
}

/// Two unit vectors at right angles, to float rounding.
void axes( SeededRng& rng, float n[3], float t[3] )
{
	float any[3], across[3];
	unit( rng, n );
	unit( rng, any );
	lwi_third_axis( n, any, across );
	const double length =
	    std::sqrt( double( across[0] ) * across[0] + double( across[1] ) * across[1] + double( across[2] ) * across[2] );
	for ( int axis = 0; axis < 3; ++axis )
	{
		t[axis] = static_cast<float>( across[axis] / length );
	}
}

/// A box about which a sphere of radius r fits: a flat patch, a strip or any; now and then as large as the sphere itself.
void faces( SeededRng& rng, float r, float low[3], float high[3] )
{
	const double kind = rng.uniform( 0, 1 );
	for ( int axis = 0; axis < 3; ++axis )
	{
		const double reach = kind > 0.9 ? 1 : ( kind < 0.5 && axis == 0 ) || ( kind < 0.3 && axis == 2 ) ? 1e-3 : 0.5;
		low[axis] = static_cast<float>( -r * ( kind > 0.9 ? 1 : rng.uniform( 0, reach ) ) );
		high[axis] = static_cast<float>( r * ( kind > 0.9 ? 1 : rng.uniform( 0, reach ) ) );
	}
}

float value( SeededRng& rng, double scale )
{
	return static_cast<float>( rng.uniform( -scale, scale ) );
}

/// Triangles from well shaped to needles, segments and points.
void fill_leaf( SeededRng& rng, double scale, lwi_leaf& leaf )
{
	for ( int lane = 0; lane < 8; ++lane )
	{
		double shape = rng.uniform( 0, 1 );
		float base[3] = { value( rng, scale ), value( rng, scale ), value( rng, scale ) };
		double size = scale * ( shape < 0.2 ? 1.0 : shape < 0.6 ? 0.1 : 0.001 );
		for ( int axis = 0; axis < 3; ++axis )
		{
			float along = value( rng, size ), across = value( rng, size ) * ( shape > 0.8 ? 1e-5f : 1.0f );
			leaf.v[0][axis][lane] = base[axis];
			leaf.v[1][axis][lane] = shape > 0.95 ? base[axis] : base[axis] + along;
			leaf.v[2][axis][lane] = shape > 0.9 ? leaf.v[1][axis][lane] : base[axis] + 0.5f * along + across;
		}
		leaf.triangle[lane] = static_cast<uint32_t>( lane );
	}
}

Input random_input( SeededRng& rng )
{
	Input in;
	std::memset( &in, 0, sizeof( in ) );
	in.scale = rng.decade( -6, 6 );
	for ( int lane = 0; lane < 8; ++lane )
	{
		in.node.x[lane] = value( rng, in.scale );
		in.node.y[lane] = value( rng, in.scale );
		in.node.z[lane] = value( rng, in.scale );
		in.node.r[lane] = lane == 7 ? -INFINITY : std::abs( value( rng, in.scale ) );
		for ( int axis = 0; axis < 3; ++axis )
		{
			float a = value( rng, in.scale ), b = value( rng, in.scale );
			in.boxes.min[axis][lane] = lane == 7 ? INFINITY : std::min( a, b );
			in.boxes.max[axis][lane] = lane == 7 ? -INFINITY : std::max( a, b );
		}
	}
	fill_leaf( rng, in.scale, in.leaf );
	fill_leaf( rng, in.scale, in.other );
	double q[4], p[3] = { rng.uniform( -1, 1 ), rng.uniform( -1, 1 ), rng.uniform( -1, 1 ) };
	rng.quaternion( q );
	lw_transform m;
	lw_transform_from_quaternion( p, q, &m );
	for ( int i = 0; i < 9; ++i )
	{
		in.motion.r[i] = static_cast<float>( m.r[i / 3][i % 3] );
	}
	for ( int i = 0; i < 3; ++i )
	{
		in.motion.t[i] = static_cast<float>( 2 * in.scale * m.t[i] );
		in.primitive.size[i] = static_cast<float>( in.scale * rng.uniform( 0.01, 1 ) );
		in.sphere[i] = value( rng, 2 * in.scale );
	}
	in.sphere[3] = std::abs( value( rng, in.scale ) );
	for ( int lane = 0; lane < 7; ++lane )
	{
		float n[3], t[3], low[3], high[3];
		axes( rng, n, t );
		faces( rng, in.node.r[lane], low, high );
		for ( int axis = 0; axis < 3; ++axis )
		{
			in.obbs.n[axis][lane] = n[axis];
			in.obbs.t[axis][lane] = t[axis];
			in.obbs.low[axis][lane] = low[axis];
			in.obbs.high[axis][lane] = high[axis];
		}
	}
	axes( rng, in.obb.axis[0], in.obb.axis[1] );
	lwi_third_axis( in.obb.axis[0], in.obb.axis[1], in.obb.axis[2] );
	std::memcpy( in.obb.center, in.sphere, sizeof( in.obb.center ) );
	in.obb.radius = in.sphere[3];
	faces( rng, in.obb.radius, in.obb.low, in.obb.high );
	unit( rng, in.along );
	const lw_shape_type types[3] = { LW_SHAPE_BOX, LW_SHAPE_CYLINDER, LW_SHAPE_CONE };
	in.primitive.type = types[rng.integer( 0, 2 )];
	return in;
}

/// Everything all kernels say about one input, one after the other.
std::vector<float> outputs( const lwi_kernels* k, const Input& in )
{
	std::vector<float> out( 8 * 34, 0.0f );
	lwi_triangles8 a, b;
	float limit = 0.1f * static_cast<float>( in.scale );
	out[120] = static_cast<float>( k->sphere_gap( in.node.x, in.sphere, limit, &out[0] ) );
	out[169] = static_cast<float>( k->box_gap( &in.boxes, in.sphere, limit, &out[8] ) );
	const float corner[3] = { in.sphere[0] + in.sphere[3], in.sphere[1] + in.sphere[3], in.sphere[2] + in.sphere[3] };
	out[160] = static_cast<float>( k->box_pair_gap( &in.boxes, in.sphere, corner, limit, &out[161] ) );
	float direction[3][8];
	out[121] = static_cast<float>( k->leaf_gap( &in.leaf, in.sphere, limit, &out[16], direction ) );
	std::memcpy( &out[24], direction, sizeof( direction ) );
	k->leaf_project( &in.leaf, in.sphere, &out[48], &out[56] );
	k->leaf_transform( &in.leaf, &in.motion, a );
	std::memcpy( b, in.other.v, sizeof( b ) );
	std::memcpy( &out[64], a, 3 * 8 * sizeof( float ) );
	k->triangle_gap( a, b, INFINITY, &out[88] );
	out[122] = static_cast<float>( k->triangle_gap( a, b, limit, &out[96] ) );
	out[123] = static_cast<float>( k->node_primitive_gap( &in.node, &in.motion, &in.primitive, limit, &out[104] ) );
	out[124] = static_cast<float>( k->leaf_primitive_gap( &in.leaf, &in.motion, &in.primitive, limit, &out[112] ) );
	float low[2][8];
	std::memcpy( low, &out[48], sizeof( low ) );
	out[125] = static_cast<float>( k->slab_gap( low, in.sphere, limit, 2 ) );
	float flat[8]; // pads are not numbers, of either sign
	out[176] = static_cast<float>( k->obb_gap( &in.node, &in.obbs, &in.obb, nullptr, limit, flat ) );
	std::memcpy( &out[177], flat, 7 * sizeof( float ) );
	out[184] = static_cast<float>( k->obb_gap( &in.node, &in.obbs, &in.obb, in.along, limit, flat ) );
	std::memcpy( &out[185], flat, 7 * sizeof( float ) );
	lwi_points8 points[3], moved[3];
	static_assert( sizeof( points ) == sizeof( in.leaf.v ), "a leaf's vertices are three blocks of points" );
	std::memcpy( points, in.leaf.v, sizeof( points ) );
	out[192] = static_cast<float>( k->points_farthest( points, 3, in.sphere, &out[193] ) );
	out[194] = k->points_inside( points, 3, &in.motion, &in.primitive ) ? 1.0f : 0.0f;
	k->points_move( points, 3, &in.motion, moved );
	std::memcpy( &out[200], moved, sizeof( moved ) );
	return out;
}

lw_vec3 vertex( const float v[3][3][8], int k, int lane )
{
	return { v[k][0][lane], v[k][1][lane], v[k][2][lane] };
}

double largest( std::initializer_list<lw_vec3> points )
{
	double size = 0;
	for ( lw_vec3 p : points )
	{
		size = std::max( { size, std::abs( p.x ), std::abs( p.y ), std::abs( p.z ) } );
	}
	return size;
}

/// How far gaps in float exceed distances, and how many reach them.
struct Tightness
{
	double worst = 0; ///< excess in roundoffs of the size
	int tight = 0, separated = 0;

	void add( float gap, double exact, double size )
	{
		worst = std::max( worst, ( gap - exact ) / ( size * 0x1p-24 ) );
		if ( exact > 0.01 * size )
		{
			++separated;
			tight += gap > 0.99 * exact;
		}
	}

	/// @param share of the lanes that must be tight
	void expect( double share ) const
	{
		std::printf( "worst excess: %.2f roundoffs of the size; tight %d of %d\n", worst, tight, separated );
		EXPECT_LT( worst, LWI_GAP_SLACK / 2 );
		EXPECT_GT( tight, separated * share );
	}
};

} // namespace

TEST( Kernels, LevelDiffersFromScalar )
{
	SeededRng rng;
	auto tables = kernelLevels();
	ASSERT_FALSE( tables.empty() );
	for ( int i = 0; i < 20000; ++i )
	{
		Input in = random_input( rng );
		std::vector<float> want = outputs( &lwi_kernels_scalar, in );
		for ( const lwi_kernels* table : tables )
		{
			std::vector<float> got = outputs( table, in );
			ASSERT_EQ( 0, std::memcmp( want.data(), got.data(), want.size() * sizeof( float ) ) )
			    << "level " << table->level << ", input " << i;
		}
	}
}

// An instruction's own minimum hands on another operand than a comparison with a selection
TEST( Kernels, LevelTakesAnotherOperandThanNoNumber )
{
	SeededRng rng;
	for ( int i = 0; i < 2000; ++i )
	{
		Input in = random_input( rng );
		const auto at = static_cast<std::size_t>( rng.integer( 0, 2 ) ),
		           lane = static_cast<std::size_t>( rng.integer( 0, 6 ) );
		float* const places[] = { &in.sphere[at], &in.motion.t[at], &in.node.r[lane], &in.boxes.min[at][lane],
		    &in.boxes.max[at][lane], &in.leaf.v[at][0][lane], &in.obbs.low[at][lane], &in.primitive.size[at] };
		*places[rng.integer( 0, 7 )] = NAN;
		const std::vector<float> want = outputs( &lwi_kernels_scalar, in );
		for ( const lwi_kernels* table : kernelLevels() )
		{
			const std::vector<float> got = outputs( table, in );
			for ( std::size_t k = 0; k < want.size(); ++k )
			{
				const bool same = std::memcmp( &want[k], &got[k], sizeof( float ) ) == 0 ||
				                  ( std::isnan( want[k] ) && std::isnan( got[k] ) );
				ASSERT_TRUE( same ) << "level " << table->level << ", input " << i << ", output " << k << ": " << want[k]
				                    << ", " << got[k];
			}
		}
	}
}

// Poses have the same bits however they were asked for, so joints turned together must turn as one alone; and numerics.md
// says how much
TEST( Kernels, TurnsDifferFromOneAloneOrFromTheTruth )
{
	SeededRng rng;
	double worst = 0;
	for ( int i = 0; i < 40000; ++i )
	{
		double angles[12];
		uint32_t count = static_cast<uint32_t>( rng.integer( 1, 12 ) );
		for ( double& angle : angles )
		{
			int kind = rng.integer( 0, 9 );
			angle = kind < 4   ? rng.uniform( -4, 4 )
			        : kind < 6 ? rng.integer( -9, 9 ) * 1.5707963267948966 +
			                         rng.uniform( -1, 1 ) * std::pow( 10.0, rng.integer( -18, -1 ) )
			        : kind == 6 ? rng.integer( -9, 9 ) * 0.78539816339744831 + rng.uniform( -1e-15, 1e-15 )
			        : kind == 7 ? rng.uniform( -1, 1 ) * LWI_SINCOS_LARGEST
			        : kind == 8 ? rng.uniform( -1, 1 ) * std::pow( 10.0, rng.integer( 5, 15 ) )
			                    : rng.uniform( -1, 1 ) * std::pow( 10.0, rng.integer( -300, 0 ) );
		}
		for ( const lwi_kernels* table : kernelLevels() )
		{
			double cosine[12], sine[12];
			table->sincos( angles, count, cosine, sine );
			for ( uint32_t k = 0; k < count; ++k )
			{
				lwi_sincos alone = lwi_sincos_of( angles[k] );
				ASSERT_EQ( 0, std::memcmp( &alone.c, &cosine[k], sizeof( double ) ) )
				    << "level " << table->level << " at " << angles[k];
				ASSERT_EQ( 0, std::memcmp( &alone.s, &sine[k], sizeof( double ) ) )
				    << "level " << table->level << " at " << angles[k];
			}
		}
		for ( uint32_t k = 0; k < count; ++k )
		{
			lwi_sincos turn = lwi_sincos_of( angles[k] );
			long double exact = angles[k];
			worst = std::max( worst, static_cast<double>( std::abs( turn.c - std::cos( exact ) ) ) );
			worst = std::max( worst, static_cast<double>( std::abs( turn.s - std::sin( exact ) ) ) );
		}
	}
	std::printf( "sine and cosine: worst seen / promised %.3f\n", worst / 0x1p-52 );
	EXPECT_LE( worst, 0x1p-52 );
}

namespace
{

/// Up to three sheared boxes in float, and in double as they were meant: the middle, three half axes.
struct ShearedBoxes
{
	uint32_t count;
	lwi_sheared_box boxes[3];
	double exact[3][4][3];
	double far; ///< sum of all coordinates, and `scale`

	ShearedBoxes( SeededRng& rng, double scale ) : count( static_cast<uint32_t>( rng.integer( 1, 3 ) ) ), far( scale )
	{
		for ( uint32_t box = 0; box < count; ++box )
		{
			for ( int k = 0; k < 12; ++k )
			{
				const double x = rng.uniform( -1, 1 ) * scale * ( k < 3 ? 2 : 0.3 );
				exact[box][k / 3][k % 3] = x;
				float* to = k < 3 ? &boxes[box].middle[0] : &boxes[box].half[k / 3 - 1][0];
				to[k % 3] = static_cast<float>( x );
				far += std::abs( x );
			}
		}
	}

	/// Room of the boxes below a plane: of the least lower one, and that which some corner of each box has.
	void room( const lw_transform& turn, const lwi_planes8& planes, int lane, double& least, double& most ) const
	{
		least = most = INFINITY;
		for ( uint32_t box = 0; box < count && lane < 7; ++box )
		{
			double h[4] = { 0, 0, 0, 0 };
			for ( int k = 0; k < 12; ++k )
			{
				double n = 0;
				for ( int axis = 0; axis < 3; ++axis )
				{
					n += turn.r[k % 3][axis] * static_cast<double>( planes.direction[axis][lane] );
				}
				h[k / 3] += n * exact[box][k / 3][k % 3];
			}
			const double all = std::abs( h[1] ) + std::abs( h[2] ) + std::abs( h[3] ), left = -planes.reach[lane] - h[0];
			least = std::min( least, left - all );
			most = std::min( most, left + all - 2 * std::max( { std::abs( h[1] ), std::abs( h[2] ), std::abs( h[3] ) } ) );
		}
	}
};

} // namespace

// Edges stand on it: a body below a plane counts as apart from one above
TEST( Kernels, BoxIsBelowAPlaneThatItReaches )
{
	SeededRng rng;
	int clear_lanes = 0, hopeless_lanes = 0;
	for ( int i = 0; i < 3000; ++i )
	{
		const double scale = rng.decade( -4, 4 ), q[4] = { rng.normal(), rng.normal(), rng.normal(), rng.normal() },
		             at[3] = { 0, 0, 0 };
		lw_transform turn;
		ASSERT_EQ( LW_OK, lw_transform_from_quaternion( at, q, &turn ) );
		lwi_planes8 planes;
		for ( int lane = 0; lane < 8; ++lane )
		{
			float n[3];
			unit( rng, n );
			for ( int axis = 0; axis < 3; ++axis )
			{
				planes.direction[axis][lane] = n[axis];
			}
			planes.reach[lane] = lane == 7 ? INFINITY : value( rng, scale );
		}
		float r[9];
		for ( int k = 0; k < 9; ++k )
		{
			r[k] = static_cast<float>( turn.r[k / 3][k % 3] );
		}
		const ShearedBoxes sheared( rng, scale );
		const lwi_sheared_box* boxes = sheared.boxes;
		const uint32_t count = sheared.count;
		const double slack = 16 * 0x1p-24 * sheared.far, need = rng.uniform( 0, scale ), hope = rng.uniform( 0, scale );
		float room[8];
		const uint32_t clear = lwi_kernels_scalar.planes_clear(
		    &planes, r, boxes, count, static_cast<float>( need ), static_cast<float>( hope ), room );
		for ( int lane = 0; lane < 8; ++lane )
		{
			double least, most;
			sheared.room( turn, planes, lane, least, most );
			const bool is_clear = ( clear >> lane & 1 ) != 0, hopeless = room[lane] == -INFINITY;
			ASSERT_FALSE( lane == 7 && ( is_clear || !hopeless ) ) << "a pad";
			if ( lane < 7 )
			{
				ASSERT_TRUE( is_clear ? least >= need - slack : least <= need + slack ) << least << " of " << need;
				ASSERT_TRUE( hopeless ? most <= hope + slack : most >= hope - slack ) << most << " of " << hope;
				ASSERT_TRUE( hopeless || std::abs( room[lane] - least ) <= slack );
				clear_lanes += is_clear;
				hopeless_lanes += hopeless;
			}
		}
		for ( const lwi_kernels* table : kernelLevels() )
		{
			float other[8];
			ASSERT_EQ( clear, table->planes_clear( &planes, r, boxes, count, static_cast<float>( need ),
			                      static_cast<float>( hope ), other ) );
			ASSERT_EQ( 0, std::memcmp( room, other, sizeof( room ) ) ) << "level " << table->level;
		}
	}
	EXPECT_GE( clear_lanes, 1000 );
	EXPECT_GE( hopeless_lanes, 1000 );
}

TEST( Kernels, NearSpheresAreLeftOut )
{
	SeededRng rng;
	size_t near_pairs = 0, far_pairs = 0;
	for ( int i = 0; i < 5000; ++i )
	{
		const uint32_t count = static_cast<uint32_t>( rng.integer( 1, 24 ) );
		const double scale = rng.decade( -6, 6 );
		float blocks[3][4][8] = {};
		uint8_t mask[24][3] = {};
		for ( uint32_t k = 0; k < count; ++k )
		{
			for ( int axis = 0; axis < 3; ++axis )
			{
				blocks[k / 8][axis][k % 8] = value( rng, scale );
			}
			blocks[k / 8][3][k % 8] = std::abs( value( rng, 0.5 * scale ) );
			for ( uint32_t other = k + 1; other < count; ++other )
			{
				mask[k][other / 8] |= static_cast<uint8_t>( rng.integer( 0, 3 ) > 0 ? 1u << other % 8 : 0u );
			}
		}
		const float limit = rng.uniform( 0, 1 ) < 0.3 ? 0 : std::abs( value( rng, scale ) );
		const std::vector<uint16_t> first = pairsByAllLevels( &lwi_kernels::sphere_pairs, blocks[0][0], count, mask, limit );
		ASSERT_FALSE( HasFailure() );
		for ( uint32_t a = 0; a < count; ++a )
		{
			for ( uint32_t b = a + 1; b < count; ++b )
			{
				double square = 0;
				for ( int axis = 0; axis < 3; ++axis )
				{
					const double d = static_cast<double>( blocks[a / 8][axis][a % 8] ) -
					                 static_cast<double>( blocks[b / 8][axis][b % 8] );
					square += d * d;
				}
				const double gap = std::sqrt( square ) - static_cast<double>( blocks[a / 8][3][a % 8] ) -
				                   static_cast<double>( blocks[b / 8][3][b % 8] );
				const bool asked = ( mask[a][b / 8] >> b % 8 & 1 ) != 0;
				const bool named = std::find( first.begin(), first.end(), 256 * a + b ) != first.end();
				ASSERT_TRUE( asked || !named );
				if ( asked && gap < static_cast<double>( limit ) - lwi_gap_slack( 4 * scale ) )
				{
					ASSERT_TRUE( named ) << "gap " << gap << ", limit " << limit;
					++near_pairs;
				}
				if ( asked && gap > static_cast<double>( limit ) + lwi_gap_slack( 4 * scale ) )
				{
					ASSERT_FALSE( named ) << "gap " << gap << ", limit " << limit;
					++far_pairs;
				}
			}
		}
	}
	EXPECT_GE( std::min( near_pairs, far_pairs ), 10000u );
}

TEST( Kernels, PadsAreNotInfinitelyFar )
{
	SeededRng rng;
	Input in = random_input( rng );
	float gap[8];
	EXPECT_EQ( 0u, lwi_kernels_scalar.sphere_gap( in.node.x, in.sphere, INFINITY, gap ) & 0x80u );
	EXPECT_EQ( gap[7], INFINITY );
	(void)lwi_kernels_scalar.box_gap( &in.boxes, in.sphere, INFINITY, gap );
	EXPECT_EQ( gap[7], INFINITY );
	lwi_kernels_scalar.node_primitive_gap( &in.node, &in.motion, &in.primitive, INFINITY, gap );
	EXPECT_EQ( gap[7], INFINITY );
}

// The slack of simd/kernels.h: a gap never exceeds the exact distance by more than LWI_GAP_SLACK roundoffs of the size
// involved, and for separated triangles it is the distance itself to about as much.
TEST( Kernels, TriangleGapExceedsDistance )
{
	SeededRng rng;
	Tightness seen;
	for ( int i = 0; i < 20000; ++i )
	{
		Input in = random_input( rng );
		float gap[8];
		lwi_triangles8 a, b;
		std::memcpy( a, in.leaf.v, sizeof( a ) );
		std::memcpy( b, in.other.v, sizeof( b ) );
		lwi_kernels_scalar.triangle_gap( a, b, INFINITY, gap );
		for ( int lane = 0; lane < 8; ++lane )
		{
			lw_vec3 ta[3] = { vertex( a, 0, lane ), vertex( a, 1, lane ), vertex( a, 2, lane ) };
			lw_vec3 tb[3] = { vertex( b, 0, lane ), vertex( b, 1, lane ), vertex( b, 2, lane ) };
			double exact = lwi_tri_tri( ta, tb ).distance;
			double size = 2 * largest( { ta[0], ta[1], ta[2], tb[0], tb[1], tb[2] } );
			seen.add( gap[lane], exact, size );
		}
	}
	seen.expect( 0.99 );
	EXPECT_GE( seen.separated, 50000 );
}

TEST( Kernels, PointTriangleGapExceedsDistance )
{
	SeededRng rng;
	Tightness seen;
	for ( int i = 0; i < 20000; ++i )
	{
		Input in = random_input( rng );
		in.sphere[3] = 0;
		float gap[8], direction[3][8];
		lwi_kernels_scalar.leaf_gap( &in.leaf, in.sphere, INFINITY, gap, direction );
		lw_vec3 p = { in.sphere[0], in.sphere[1], in.sphere[2] };
		for ( int lane = 0; lane < 8; ++lane )
		{
			lw_vec3 t[3] = { vertex( in.leaf.v, 0, lane ), vertex( in.leaf.v, 1, lane ), vertex( in.leaf.v, 2, lane ) };
			lw_vec3 point[3] = { p, p, p };
			double exact = lwi_tri_tri( t, point ).distance;
			double size = 2 * largest( { t[0], t[1], t[2], p } );
			seen.add( gap[lane], exact, size );
		}
	}
	seen.expect( 0.99 );
}

TEST( Kernels, SolidGapExceedsDistance )
{
	SeededRng rng;
	Tightness seen;
	for ( int i = 0; i < 20000; ++i )
	{
		Input in = random_input( rng );
		float gap[8];
		lwi_kernels_scalar.node_primitive_gap( &in.node, &in.motion, &in.primitive, INFINITY, gap );
		lwi_convex solid = {};
		solid.type = in.primitive.type == LW_SHAPE_BOX    ? LWI_CONVEX_BOX
		             : in.primitive.type == LW_SHAPE_CONE ? LWI_CONVEX_CONE
		                                                  : LWI_CONVEX_CYLINDER;
		for ( int axis = 0; axis < 3; ++axis )
		{
			solid.size[axis] = in.primitive.size[axis];
		}
		for ( int lane = 0; lane < 7; ++lane )
		{
			const double c[3] = { in.node.x[lane], in.node.y[lane], in.node.z[lane] };
			double m[3];
			for ( int axis = 0; axis < 3; ++axis )
			{
				const float* r = in.motion.r + 3 * axis;
				m[axis] = double( r[0] ) * c[0] + double( r[1] ) * c[1] + double( r[2] ) * c[2] + in.motion.t[axis];
			}
			lw_vec3 p = { m[0], m[1], m[2] }, closest;
			double exact = lwi_convex_point_distance( &solid, p, &closest ) - double( in.node.r[lane] );
			double size = 2 * largest( { p, { solid.size[0], solid.size[1], solid.size[2] }, { c[0], c[1], c[2] } } ) +
			              in.node.r[lane];
			seen.add( gap[lane], exact, size );
		}
	}
	seen.expect( 0.99 );
}

TEST( Kernels, PointInsideOfASolidIsMissedOrInvented )
{
	SeededRng rng;
	int inside = 0, outside = 0;
	for ( int i = 0; i < 20000; ++i )
	{
		Input in = random_input( rng );
		const lw_shape_type types[] = { LW_SHAPE_BOX, LW_SHAPE_CYLINDER, LW_SHAPE_HALFSPACE };
		in.primitive.type = types[i % 3];
		const uint32_t blocks = 1 + static_cast<uint32_t>( i ) % 3;
		lwi_points8 points[3];
		std::memcpy( points, in.leaf.v, sizeof( points ) );
		double deepest = -INFINITY, size = 0; // how far a point is inside
		for ( uint32_t point = 0; point < blocks * LWI_WIDTH; ++point )
		{
			double m[3];
			for ( int axis = 0; axis < 3; ++axis )
			{
				m[axis] = double( in.motion.t[axis] );
				for ( int k = 0; k < 3; ++k )
				{
					m[axis] += double( in.motion.r[3 * axis + k] ) * double( points[point / 8].at[k][point % 8] );
				}
				size = std::max( { size, std::abs( m[axis] ), double( in.primitive.size[axis] ) } );
			}
			const float* s = in.primitive.size;
			const double depth =
			    in.primitive.type == LW_SHAPE_HALFSPACE ? -m[2]
			    : in.primitive.type == LW_SHAPE_BOX
			        ? std::min( { s[0] - std::abs( m[0] ), s[1] - std::abs( m[1] ), s[2] - std::abs( m[2] ) } )
			        : std::min( s[0] - std::hypot( m[0], m[1] ), s[1] - std::abs( m[2] ) );
			deepest = std::max( deepest, depth );
		}
		const bool is = lwi_kernels_scalar.points_inside( points, blocks, &in.motion, &in.primitive );
		if ( std::abs( deepest ) > 1e-3 * size )
		{
			ASSERT_EQ( deepest > 0, is ) << "input " << i;
			++( is ? inside : outside );
		}
	}
	EXPECT_GE( std::min( inside, outside ), 2000 );
}

// The promise of oriented boxes: no two points of two of them, cut by their spheres, are nearer than the gap. The points
// tried are those that reach farthest along the line of the centres and along other directions, where a wrong formula would
// show.
TEST( Kernels, ObbGapExceedsDistance )
{
	SeededRng rng;
	const auto farthest =
	    []( const float axis[3][3], const float low[3], const float high[3], double r, const double u[3], double out[3] )
	{
		const bool is_sphere = low[0] <= -r;
		for ( int k = 0; k < 3; ++k )
		{
			out[k] = is_sphere ? r * u[k] : 0.0;
		}
		for ( int i = 0; i < 3 && !is_sphere; ++i )
		{
			double along = 0;
			for ( int k = 0; k < 3; ++k )
			{
				along += u[k] * axis[i][k];
			}
			for ( int k = 0; k < 3; ++k )
			{
				out[k] += ( along > 0 ? double( high[i] ) : double( low[i] ) ) * axis[i][k];
			}
		}
	};
	double worst = 0;
	int better = 0, reached = 0;
	for ( int i = 0; i < 20000; ++i )
	{
		Input in = random_input( rng );
		float gap[8], sphere_gap[8];
		lwi_kernels_scalar.sphere_gap( in.node.x, in.sphere, INFINITY, sphere_gap );
		lwi_kernels_scalar.obb_gap( &in.node, &in.obbs, &in.obb, in.along, INFINITY, gap );
		for ( int lane = 0; lane < 7; ++lane )
		{
			const double c[3] = { in.node.x[lane], in.node.y[lane], in.node.z[lane] };
			float axis[3][3], low[3], high[3];
			double u[3], size = in.node.r[lane] + in.obb.radius, length = 0;
			for ( int k = 0; k < 3; ++k )
			{
				axis[0][k] = in.obbs.n[k][lane];
				axis[1][k] = in.obbs.t[k][lane];
				low[k] = in.obbs.low[k][lane];
				high[k] = in.obbs.high[k][lane];
				u[k] = in.obb.center[k] - c[k];
				length += u[k] * u[k];
				size += std::abs( u[k] ) + std::abs( c[k] );
			}
			lwi_third_axis( axis[0], axis[1], axis[2] );
			double nearest = INFINITY;
			for ( int attempt = 0; attempt < 8; ++attempt )
			{
				double p[3], q[3], along[3], back[3], distance = 0;
				float random[3];
				unit( rng, random );
				for ( int k = 0; k < 3; ++k )
				{
					along[k] = attempt == 0 ? u[k] / std::sqrt( length ) : double( attempt == 1 ? in.along[k] : random[k] );
					back[k] = -along[k];
				}
				farthest( axis, low, high, in.node.r[lane], along, p );
				farthest( in.obb.axis, in.obb.low, in.obb.high, in.obb.radius, back, q );
				for ( int k = 0; k < 3; ++k )
				{
					const double d = u[k] + q[k] - p[k];
					distance += d * d;
				}
				nearest = std::min( nearest, std::sqrt( distance ) );
			}
			worst = std::max( worst, ( gap[lane] - nearest ) / ( size * 0x1p-24 ) );
			better += gap[lane] > sphere_gap[lane] + 0.01 * size;
			reached += gap[lane] > 0.9 * nearest;
		}
	}
	std::printf( "worst excess: %.2f roundoffs of the size; %d better than spheres, %d reached\n", worst, better, reached );
	EXPECT_LT( worst, LWI_GAP_SLACK / 2 );
	EXPECT_GT( better, 70000 );
	EXPECT_GT( reached, 10000 );
}

// Slabs of triangles before boxes and cylinders: never too wide, and mostly the distance itself, or measurements in double
// are in vain.
TEST( Kernels, LeafPrimitiveGapExceedsDistance )
{
	SeededRng rng;
	Tightness seen;
	for ( int i = 0; i < 4000; ++i )
	{
		Input in = random_input( rng );
		in.primitive.type = i % 2 != 0 ? LW_SHAPE_BOX : LW_SHAPE_CYLINDER;
		lwi_convex solid = {};
		solid.type = i % 2 != 0 ? LWI_CONVEX_BOX : LWI_CONVEX_CYLINDER;
		std::copy_n( in.primitive.size, 3, solid.size );
		lw_transform place = lw_transform_identity();
		for ( int axis = 0; axis < 3; ++axis )
		{
			std::copy_n( in.motion.r + 3 * axis, 3, place.r[axis] );
			place.t[axis] = in.motion.t[axis];
		}
		float gap[8];
		lwi_kernels_scalar.leaf_primitive_gap( &in.leaf, &in.motion, &in.primitive, INFINITY, gap );
		for ( int lane = 0; lane < 8; ++lane )
		{
			lwi_convex triangle = {};
			triangle.type = LWI_CONVEX_TRIANGLE;
			for ( int k = 0; k < 3; ++k )
			{
				triangle.vertex[k] = vertex( in.leaf.v, k, lane );
			}
			double exact = lwi_convex_distance( &solid, &triangle, &place, INFINITY, 0 ).upper;
			double size =
			    2 * largest( { triangle.vertex[0], triangle.vertex[1], triangle.vertex[2] } ) +
			    largest( { { solid.size[0], solid.size[1], solid.size[2] }, { place.t[0], place.t[1], place.t[2] } } );
			seen.add( gap[lane], exact, size );
		}
	}
	seen.expect( 0.9 );
}

// Huge and tiny coordinates overflow or vanish in float: the answer may be NaN or small, it may not say "far".
TEST( Kernels, OverflowReadsAsFar )
{
	SeededRng rng;
	for ( double scale :
	    { 1e-30, 1e-20, 1e-12, 1e6, 1e9 } ) // shapes to 1e9 m (core/docs/numerics.md): beyond, gaps of some are infinite
	{
		for ( int i = 0; i < 200; ++i )
		{
			lwi_leaf a, b;
			fill_leaf( rng, scale, a );
			fill_leaf( rng, scale, b );
			float gap[8];
			lwi_kernels_scalar.triangle_gap( a.v, b.v, INFINITY, gap );
			for ( int lane = 0; lane < 8; ++lane )
			{
				lw_vec3 ta[3] = { vertex( a.v, 0, lane ), vertex( a.v, 1, lane ), vertex( a.v, 2, lane ) };
				lw_vec3 tb[3] = { vertex( b.v, 0, lane ), vertex( b.v, 1, lane ), vertex( b.v, 2, lane ) };
				double exact = lwi_tri_tri( ta, tb ).distance;
				EXPECT_FALSE( gap[lane] > exact + 1e-4 * scale )
				    << "scale " << scale << " gap " << gap[lane] << " exact " << exact;
			}
		}
	}
}
