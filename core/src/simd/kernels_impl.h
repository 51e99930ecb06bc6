// SPDX-License-Identifier: BSD-3-Clause
// The one source of all kernels; kernels_<isa>.c includes it after simd_<isa>.h, with LWI_KERNELS naming the table.
#include "simd/kernels.h"
#include "base/sincos.h"

#include <math.h>

typedef struct v3
{
	f8 x, y, z;
} v3;

static inline v3 v3_set( const float p[3] )
{
	return ( v3 ){ f8_set( p[0] ), f8_set( p[1] ), f8_set( p[2] ) };
}
static inline v3 v3_load( const float ( *p )[LWI_WIDTH] )
{
	return ( v3 ){ f8_load( p[0] ), f8_load( p[1] ), f8_load( p[2] ) };
}
static inline void v3_store( float ( *p )[LWI_WIDTH], v3 a )
{
	f8_store( p[0], a.x );
	f8_store( p[1], a.y );
	f8_store( p[2], a.z );
}
static inline v3 v3_add( v3 a, v3 b )
{
	return ( v3 ){ f8_add( a.x, b.x ), f8_add( a.y, b.y ), f8_add( a.z, b.z ) };
}
static inline v3 v3_sub( v3 a, v3 b )
{
	return ( v3 ){ f8_sub( a.x, b.x ), f8_sub( a.y, b.y ), f8_sub( a.z, b.z ) };
}
static inline v3 v3_mul( f8 s, v3 a )
{
	return ( v3 ){ f8_mul( s, a.x ), f8_mul( s, a.y ), f8_mul( s, a.z ) };
}
static inline f8 v3_dot( v3 a, v3 b )
{
	return f8_add( f8_add( f8_mul( a.x, b.x ), f8_mul( a.y, b.y ) ), f8_mul( a.z, b.z ) );
}
static inline v3 v3_cross( v3 a, v3 b )
{
	return ( v3 ){ f8_sub( f8_mul( a.y, b.z ), f8_mul( a.z, b.y ) ), f8_sub( f8_mul( a.z, b.x ), f8_mul( a.x, b.z ) ),
		f8_sub( f8_mul( a.x, b.y ), f8_mul( a.y, b.x ) ) };
}
static inline v3 v3_select( m8 mask, v3 a, v3 b )
{
	return ( v3 ){ f8_select( mask, a.x, b.x ), f8_select( mask, a.y, b.y ), f8_select( mask, a.z, b.z ) };
}
static inline v3 v3_move( const lwi_motion* m, v3 p )
{
	const float* r = m->r;
	f8 x = f8_add( f8_add( f8_mul( f8_set( r[0] ), p.x ), f8_mul( f8_set( r[1] ), p.y ) ), f8_mul( f8_set( r[2] ), p.z ) );
	f8 y = f8_add( f8_add( f8_mul( f8_set( r[3] ), p.x ), f8_mul( f8_set( r[4] ), p.y ) ), f8_mul( f8_set( r[5] ), p.z ) );
	f8 z = f8_add( f8_add( f8_mul( f8_set( r[6] ), p.x ), f8_mul( f8_set( r[7] ), p.y ) ), f8_mul( f8_set( r[8] ), p.z ) );
	return ( v3 ){ f8_add( x, f8_set( m->t[0] ) ), f8_add( y, f8_set( m->t[1] ) ), f8_add( z, f8_set( m->t[2] ) ) };
}
static inline f8 f8_clamp01( f8 a )
{
	return f8_min( f8_max( a, f8_set( 0.0f ) ), f8_set( 1.0f ) );
}
/// A divisor: zero lengths of degenerate triangles become the smallest normal float, so that no quotient is 0 / 0.
static inline f8 f8_divisor( f8 a )
{
	return f8_max( a, f8_set( 1.17549435e-38f ) );
}

/// Stores the gaps; bit i of the result is set where lane i does not reach the limit.
static inline uint32_t store_gap( float gap[LWI_WIDTH], f8 value, float limit )
{
	f8_store( gap, value );
	return ~m8_bits( f8_ge( value, f8_set( limit ) ) ) & 0xffu;
}

static uint32_t sphere_gap( const float* xyzr, const float sphere[4], float limit, float gap[LWI_WIDTH] )
{
	f8 dx = f8_sub( f8_load( xyzr ), f8_set( sphere[0] ) );
	f8 dy = f8_sub( f8_load( xyzr + 8 ), f8_set( sphere[1] ) );
	f8 dz = f8_sub( f8_load( xyzr + 16 ), f8_set( sphere[2] ) );
	f8 distance = f8_sqrt( f8_add( f8_add( f8_mul( dx, dx ), f8_mul( dy, dy ) ), f8_mul( dz, dz ) ) );
	return store_gap( gap, f8_sub( distance, f8_add( f8_load( xyzr + 24 ), f8_set( sphere[3] ) ) ), limit );
}

/// How far a box with these axes reaches along u from 0, or its sphere if that is less.
static inline f8 obb_extent( v3 u, const v3 axis[3], const f8 low[3], const f8 high[3], f8 radius )
{
	f8 sum = f8_set( 0.0f );
	for ( int i = 0; i < 3; ++i )
	{
		f8 along = v3_dot( u, axis[i] );
		sum = f8_add( sum, f8_max( f8_mul( low[i], along ), f8_mul( high[i], along ) ) );
	}
	return f8_min( sum, radius );
}

static uint32_t obb_gap( const lwi_node* node, const lwi_obb8* obbs, const lwi_obb* other, const float along[3], float limit,
	float gap[LWI_WIDTH] )
{
	f8 zero = f8_set( 0.0f ), radius = f8_load( node->r ), other_radius = f8_set( other->radius );
	v3 axis[3] = { v3_load( obbs->n ), v3_load( obbs->t ) }, other_axis[3];
	axis[2] = v3_cross( axis[0], axis[1] );
	f8 low[3], high[3], other_low[3], other_high[3];
	for ( int i = 0; i < 3; ++i )
	{
		low[i] = f8_load( obbs->low[i] );
		high[i] = f8_load( obbs->high[i] );
		other_axis[i] = v3_set( other->axis[i] );
		// along the opposite normal its faces change places
		other_low[i] = f8_sub( zero, f8_set( other->high[i] ) );
		other_high[i] = f8_sub( zero, f8_set( other->low[i] ) );
	}
	v3 across = v3_sub( v3_set( other->center ), ( v3 ){ f8_load( node->x ), f8_load( node->y ), f8_load( node->z ) } );
	f8 length = f8_sqrt( v3_dot( across, across ) );
	m8 vanishes = f8_lt( length, f8_set( 0x1p-62f ) ); // or its squares do: no unit direction, no proof
	length = f8_max( length, f8_set( 0x1p-62f ) );
	v3 u = { f8_div( across.x, length ), f8_div( across.y, length ), f8_div( across.z, length ) };
	f8 reach =
		f8_add( obb_extent( u, axis, low, high, radius ), obb_extent( u, other_axis, other_low, other_high, other_radius ) );
	f8 best = f8_select( vanishes, f8_set( -INFINITY ), f8_sub( v3_dot( u, across ), reach ) );
	if ( along != NULL )
	{
		u = v3_set( along );
		reach = f8_add( obb_extent( u, axis, low, high, radius ),
			obb_extent( u, other_axis, other_low, other_high, other_radius ) );
		best = f8_max( best, f8_sub( v3_dot( u, across ), reach ) );
	}
	return store_gap( gap, best, limit );
}

static uint32_t sphere_pairs( const float* blocks, uint32_t count, const uint8_t* mask, uint32_t stride, float limit,
	uint16_t* near )
{
	uint32_t found = 0;
	for ( uint32_t i = 0; i < count; ++i )
	{
		const float* mine = blocks + 4 * (size_t)LWI_WIDTH * ( i / LWI_WIDTH ) + i % LWI_WIDTH;
		const v3 center = { f8_set( mine[0] ), f8_set( mine[LWI_WIDTH] ), f8_set( mine[2 * LWI_WIDTH] ) };
		const f8 reach = f8_set( mine[3 * LWI_WIDTH] + limit );
		for ( uint32_t block = i / LWI_WIDTH; block * LWI_WIDTH < count; ++block )
		{
			uint32_t lanes = mask[i * stride + block];
			if ( lanes == 0 )
			{
				continue;
			}
			const float* p = blocks + 4 * (size_t)LWI_WIDTH * block;
			v3 d = v3_sub( ( v3 ){ f8_load( p ), f8_load( p + LWI_WIDTH ), f8_load( p + 2 * LWI_WIDTH ) }, center );
			f8 far = f8_add( reach, f8_load( p + 3 * LWI_WIDTH ) );
			lanes &= ~m8_bits( f8_ge( v3_dot( d, d ), f8_mul( far, far ) ) );
			for ( ; lanes != 0; lanes &= lanes - 1 )
			{
				near[found++] = (uint16_t)( 256 * i + LWI_WIDTH * block + lwi_lowest_bit( lanes ) );
			}
		}
	}
	return found;
}

/// How far a place is outside of a box along an axis, at least, if the place's coordinate is in [low, high].
static inline f8 outside( f8 low, f8 high, f8 min, f8 max )
{
	return f8_max( f8_max( f8_sub( min, high ), f8_sub( low, max ) ), f8_set( 0.0f ) );
}

static uint32_t box_gap( const lwi_box8* boxes, const float sphere[4], float limit, float gap[LWI_WIDTH] )
{
	f8 sum = f8_set( 0.0f );
	for ( int axis = 0; axis < 3; ++axis )
	{
		f8 c = f8_set( sphere[axis] ), d = outside( c, c, f8_load( boxes->min[axis] ), f8_load( boxes->max[axis] ) );
		sum = f8_add( sum, f8_mul( d, d ) );
	}
	return store_gap( gap, f8_sub( f8_sqrt( sum ), f8_set( sphere[3] ) ), limit );
}

static uint32_t box_pair_gap( const lwi_box8* boxes, const float min[3], const float max[3], float limit,
	float gap[LWI_WIDTH] )
{
	f8 sum = f8_set( 0.0f );
	for ( int axis = 0; axis < 3; ++axis )
	{
		f8 d = outside( f8_set( min[axis] ), f8_set( max[axis] ), f8_load( boxes->min[axis] ), f8_load( boxes->max[axis] ) );
		sum = f8_add( sum, f8_mul( d, d ) );
	}
	return store_gap( gap, f8_sqrt( sum ), limit );
}

/// Width of the slab between the point p and the triangle v along n, least over the vertices of n . (p - v), over |n|.
static inline f8 point_slab( v3 n, v3 p_v0, v3 p_v1, v3 p_v2 )
{
	f8 least = f8_min( f8_min( v3_dot( n, p_v0 ), v3_dot( n, p_v1 ) ), v3_dot( n, p_v2 ) );
	return f8_div( least, f8_sqrt( f8_divisor( v3_dot( n, n ) ) ) );
}

/// Distance of points to triangles, lane by lane. *direction is that of the widest slab found, from the triangle to the
/// point; *nearest is the vector from the nearest point of its edges.
static inline f8 point_triangle( v3 p, v3 v0, v3 v1, v3 v2, v3* direction, v3* nearest )
{
	v3 d0 = v3_sub( p, v0 ), d1 = v3_sub( p, v1 ), d2 = v3_sub( p, v2 );
	const v3 from[3] = { d0, d1, d2 };
	const v3 edge[3] = { v3_sub( v1, v0 ), v3_sub( v2, v1 ), v3_sub( v0, v2 ) };
	v3 best = d0;
	f8 best_sq = v3_dot( d0, d0 );
	for ( int i = 0; i < 3; ++i )
	{
		f8 t = f8_clamp01( f8_div( v3_dot( from[i], edge[i] ), f8_divisor( v3_dot( edge[i], edge[i] ) ) ) );
		v3 d = v3_sub( from[i], v3_mul( t, edge[i] ) );
		f8 sq = v3_dot( d, d );
		m8 nearer = f8_lt( sq, best_sq );
		best = v3_select( nearer, d, best );
		best_sq = f8_select( nearer, sq, best_sq );
	}
	// along the normal, towards p
	v3 normal = v3_cross( edge[0], edge[1] );
	f8 side = v3_dot( normal, d0 );
	f8 zero = f8_set( 0.0f );
	normal = v3_select( f8_lt( side, zero ), v3_sub( ( v3 ){ zero, zero, zero }, normal ), normal );
	f8 by_edge = point_slab( best, d0, d1, d2 );
	f8 by_normal = point_slab( normal, d0, d1, d2 );
	m8 normal_wins = f8_lt( by_edge, by_normal );
	*direction = v3_select( normal_wins, normal, best );
	*nearest = best;
	return f8_select( normal_wins, by_normal, by_edge );
}

static uint32_t leaf_gap( const lwi_leaf* leaf, const float sphere[4], float limit, float gap[LWI_WIDTH],
	float direction[3][LWI_WIDTH] )
{
	v3 along, nearest;
	f8 distance = point_triangle( v3_set( sphere ), v3_load( leaf->v[0] ), v3_load( leaf->v[1] ), v3_load( leaf->v[2] ),
		&along, &nearest );
	v3_store( direction, along );
	return store_gap( gap, f8_sub( distance, f8_set( sphere[3] ) ), limit );
}

static uint32_t node_project( const lwi_node* node, const float direction[3], float least, float high[LWI_WIDTH] )
{
	v3 center = { f8_load( node->x ), f8_load( node->y ), f8_load( node->z ) };
	f8 value = f8_add( v3_dot( v3_set( direction ), center ), f8_load( node->r ) );
	f8_store( high, value );
	return m8_bits( f8_lt( f8_set( least ), value ) );
}

static uint32_t slab_gap( const float ( *low )[LWI_WIDTH], const float* high, float limit, uint32_t count )
{
	f8 at = f8_set( limit );
	uint32_t dropped = 0;
	for ( uint32_t i = 0; i < count; ++i )
	{
		dropped |= m8_bits( f8_ge( f8_sub( f8_load( low[i] ), f8_set( high[i] ) ), at ) );
	}
	return ~dropped & 0xffu;
}

static void leaf_project( const lwi_leaf* leaf, const float direction[3], float low[LWI_WIDTH], float high[LWI_WIDTH] )
{
	v3 n = v3_set( direction );
	f8 s0 = v3_dot( n, v3_load( leaf->v[0] ) );
	f8 s1 = v3_dot( n, v3_load( leaf->v[1] ) );
	f8 s2 = v3_dot( n, v3_load( leaf->v[2] ) );
	f8_store( low, f8_min( f8_min( s0, s1 ), s2 ) );
	f8_store( high, f8_max( f8_max( s0, s1 ), s2 ) );
}

static void leaf_transform( const lwi_leaf* leaf, const lwi_motion* motion, lwi_triangles8 out )
{
	for ( int vertex = 0; vertex < 3; ++vertex )
	{
		v3_store( out[vertex], v3_move( motion, v3_load( leaf->v[vertex] ) ) );
	}
}

static void points_move( const lwi_points8* points, uint32_t blocks, const lwi_motion* motion, lwi_points8* out )
{
	for ( uint32_t i = 0; i < blocks; ++i )
	{
		v3_store( out[i].at, v3_move( motion, v3_load( points[i].at ) ) );
	}
}

static uint32_t points_farthest( const lwi_points8* points, uint32_t blocks, const float direction[3], float* high )
{
	v3 n = v3_set( direction );
	f8 best = v3_dot( n, v3_load( points[0].at ) ), block = f8_set( 0.0f );
	for ( uint32_t i = 1; i < blocks; ++i )
	{
		f8 value = v3_dot( n, v3_load( points[i].at ) );
		m8 farther = f8_lt( best, value );
		best = f8_select( farther, value, best );
		block = f8_select( farther, f8_set( (float)i ), block );
	}
	float values[LWI_WIDTH], found[LWI_WIDTH];
	f8_store( values, best );
	f8_store( found, block );
	uint32_t lane = 0;
	for ( uint32_t i = 1; i < LWI_WIDTH; ++i )
	{
		lane = values[i] > values[lane] ? i : lane;
	}
	*high = values[lane];
	return LWI_WIDTH * (uint32_t)found[lane] + lane;
}

/// n . c of four corners
static inline d4 corner_heights( const d4 n[3], const lwi_corners8* corners, uint32_t from )
{
	const d4 x = d4_mul( n[0], d4_load( corners->at[0] + from ) ), y = d4_mul( n[1], d4_load( corners->at[1] + from ) );
	return d4_add( d4_add( x, y ), d4_mul( n[2], d4_load( corners->at[2] + from ) ) );
}

static uint32_t corners_farthest( const lwi_corners8* corners, uint32_t blocks, const double direction[3] )
{
	const d4 n[3] = { d4_set( direction[0] ), d4_set( direction[1] ), d4_set( direction[2] ) };
	double height[LWI_MOST_CORNER_BLOCKS][LWI_WIDTH], four[4];
	d4 low = d4_set( -INFINITY ), high = low;
	for ( uint32_t i = 0; i < blocks; ++i )
	{
		const d4 x = corner_heights( n, corners + i, 0 ), y = corner_heights( n, corners + i, 4 );
		d4_store( height[i], x );
		d4_store( height[i] + 4, y );
		low = d4_max( low, x );
		high = d4_max( high, y );
	}
	d4_store( four, d4_max( low, high ) );
	const double even = four[0] < four[1] ? four[1] : four[0], odd = four[2] < four[3] ? four[3] : four[2];
	const d4 most = d4_set( even < odd ? odd : even );
	for ( uint32_t from = 0; from < blocks; from += 4 ) // a branch for each block would be taken at random
	{
		uint32_t less = 0xffffffffu;
		for ( uint32_t k = 0; k < 4 && from + k < blocks; ++k )
		{
			const double* here = height[from + k];
			const uint32_t low_is_less = d4_bits( d4_lt( d4_load( here ), most ) ),
						   high_is_less = d4_bits( d4_lt( d4_load( here + 4 ), most ) );
			less &= ~( 0xffu << 8 * k ) | ( low_is_less | high_is_less << 4 ) << 8 * k;
		}
		if ( less != 0xffffffffu )
		{
			return LWI_WIDTH * from + lwi_lowest_bit( ~less );
		}
	}
	return 0;
}

static uint32_t planes_clear( const lwi_planes8* planes, const float r[9], const lwi_sheared_box* boxes, uint32_t count,
	float need, float hope, float room[LWI_WIDTH] )
{
	const lwi_motion turn = { { r[0], r[1], r[2], r[3], r[4], r[5], r[6], r[7], r[8] }, { 0, 0, 0 } };
	const v3 n = v3_move( &turn, v3_load( planes->direction ) );
	const f8 bottom = f8_sub( f8_set( 0.0f ), f8_load( planes->reach ) ), none = f8_set( -INFINITY );
	f8 least = f8_set( INFINITY );
	uint32_t clear = 0xffu;
	for ( uint32_t i = 0; i < count; ++i )
	{
		const f8 left = f8_sub( bottom, v3_dot( n, v3_set( boxes[i].middle ) ) );
		const f8 x = f8_abs( v3_dot( n, v3_set( boxes[i].half[0] ) ) ),
				 y = f8_abs( v3_dot( n, v3_set( boxes[i].half[1] ) ) );
		const f8 z = f8_abs( v3_dot( n, v3_set( boxes[i].half[2] ) ) ), all = f8_add( f8_add( x, y ), z );
		const f8 here = f8_sub( left, all );
		clear &= m8_bits( f8_ge( here, f8_set( need ) ) );
		// on the face whose normal is nearest to n the lowest corner is this high at least
		const f8 face = f8_max( f8_max( x, y ), z ), most = f8_add( f8_sub( left, f8_add( face, face ) ), all );
		least = f8_min( f8_select( f8_ge( most, f8_set( hope ) ), here, none ), least );
	}
	f8_store( room, least );
	return clear;
}

/// Width of the slab between two triangles along n, from a to b: (min over b - max over a of n . v) / |n|. All vertices are
/// relative to one origin near both.
static inline f8 triangle_slab( v3 n, const v3 a[3], const v3 b[3] )
{
	f8 high = f8_max( f8_max( v3_dot( n, a[0] ), v3_dot( n, a[1] ) ), v3_dot( n, a[2] ) );
	f8 low = f8_min( f8_min( v3_dot( n, b[0] ), v3_dot( n, b[1] ) ), v3_dot( n, b[2] ) );
	return f8_div( f8_sub( low, high ), f8_sqrt( f8_divisor( v3_dot( n, n ) ) ) );
}

/// Vector from segment a + s u to segment b + t v, shortest up to rounding (Ericson 2005, section 5.1.9). uu, vv: squared
/// lengths, at least the smallest normal float.
static inline v3 segment_vector( v3 a, v3 u, f8 uu, v3 b, v3 v, f8 vv )
{
	v3 r = v3_sub( a, b );
	f8 uv = v3_dot( u, v ), ur = v3_dot( u, r ), vr = v3_dot( v, r );
	f8 denominator = f8_sub( f8_mul( uu, vv ), f8_mul( uv, uv ) );
	f8 s = f8_clamp01( f8_div( f8_sub( f8_mul( uv, vr ), f8_mul( ur, vv ) ), f8_divisor( denominator ) ) );
	f8 t = f8_clamp01( f8_div( f8_add( f8_mul( uv, s ), vr ), vv ) );
	s = f8_clamp01( f8_div( f8_sub( f8_mul( uv, t ), ur ), uu ) );
	return v3_sub( v3_sub( v3_mul( t, v ), v3_mul( s, u ) ), r );
}

static uint32_t triangle_gap( lwi_triangles8 a_in, lwi_triangles8 b_in, float limit, float gap[LWI_WIDTH] )
{
	// relative to a vertex of a: the dot products of the slabs then cancel no large coordinates
	v3 origin = v3_load( (const float( * )[LWI_WIDTH])a_in[0] );
	v3 a[3], b[3], u[3], v[3];
	for ( int i = 0; i < 3; ++i )
	{
		a[i] = v3_sub( v3_load( (const float( * )[LWI_WIDTH])a_in[i] ), origin );
		b[i] = v3_sub( v3_load( (const float( * )[LWI_WIDTH])b_in[i] ), origin );
	}
	for ( int i = 0; i < 3; ++i )
	{
		u[i] = v3_sub( a[( i + 1 ) % 3], a[i] );
		v[i] = v3_sub( b[( i + 1 ) % 3], b[i] );
	}
	// both normals: the answer when a vertex is nearest to a face, and the usual way out
	v3 zero = { f8_set( 0.0f ), f8_set( 0.0f ), f8_set( 0.0f ) };
	v3 na = v3_cross( u[0], u[1] ), nb = v3_cross( v[0], v[1] );
	v3 across = v3_sub( v3_add( v3_add( b[0], b[1] ), b[2] ), v3_add( v3_add( a[0], a[1] ), a[2] ) );
	na = v3_select( f8_lt( v3_dot( na, across ), zero.x ), v3_sub( zero, na ), na );
	nb = v3_select( f8_lt( v3_dot( nb, across ), zero.x ), v3_sub( zero, nb ), nb );
	f8 best = f8_max( triangle_slab( na, a, b ), triangle_slab( nb, a, b ) );
	best = f8_max( best, triangle_slab( across, a, b ) );
	if ( m8_bits( f8_ge( best, f8_set( limit ) ) ) != 0xffu )
	{
		f8 uu[3], vv[3];
		for ( int i = 0; i < 3; ++i )
		{
			uu[i] = f8_divisor( v3_dot( u[i], u[i] ) );
			vv[i] = f8_divisor( v3_dot( v[i], v[i] ) );
		}
		v3 shortest = across;
		f8 shortest_sq = f8_set( INFINITY );
		for ( int i = 0; i < 3; ++i )
		{
			for ( int j = 0; j < 3; ++j )
			{
				v3 d = segment_vector( a[i], u[i], uu[i], b[j], v[j], vv[j] );
				f8 sq = v3_dot( d, d );
				m8 nearer = f8_lt( sq, shortest_sq );
				shortest = v3_select( nearer, d, shortest );
				shortest_sq = f8_select( nearer, sq, shortest_sq );
			}
		}
		best = f8_max( best, triangle_slab( shortest, a, b ) );
	}
	return store_gap( gap, best, limit );
}

/// Distance of points in the primitive's frame to the primitive; of a half-space less than 0 inside.
static inline f8 primitive_distance( v3 p, const lwi_primitive* primitive )
{
	f8 zero = f8_set( 0.0f );
	f8 sx = f8_set( primitive->size[0] ), sy = f8_set( primitive->size[1] ), sz = f8_set( primitive->size[2] );
	if ( primitive->type == LW_SHAPE_HALFSPACE || primitive->type == LW_SHAPE_PLANE )
	{
		return primitive->type == LW_SHAPE_PLANE ? f8_abs( p.z ) : p.z;
	}
	if ( primitive->type == LW_SHAPE_BOX )
	{
		f8 x = f8_max( f8_sub( f8_abs( p.x ), sx ), zero );
		f8 y = f8_max( f8_sub( f8_abs( p.y ), sy ), zero );
		f8 z = f8_max( f8_sub( f8_abs( p.z ), sz ), zero );
		return f8_sqrt( f8_add( f8_add( f8_mul( x, x ), f8_mul( y, y ) ), f8_mul( z, z ) ) );
	}
	f8 radial = f8_sqrt( f8_add( f8_mul( p.x, p.x ), f8_mul( p.y, p.y ) ) );
	if ( primitive->type == LW_SHAPE_CYLINDER )
	{
		f8 x = f8_max( f8_sub( radial, sx ), zero );
		f8 z = f8_max( f8_sub( f8_abs( p.z ), sy ), zero );
		return f8_sqrt( f8_add( f8_mul( x, x ), f8_mul( z, z ) ) );
	}
	// A cone in the half plane (radial, z) is the triangle (0, -h), (R, -h), (0, h). Its distance is the greatest width of
	// three slabs: below the base, along the slant's normal, and towards the nearest point of slant or base rim.
	f8 from_x = f8_sub( radial, sx ), from_z = f8_add( p.z, sy );
	f8 height = f8_add( sy, sy );
	f8 length_sq = f8_divisor( f8_add( f8_mul( sx, sx ), f8_mul( height, height ) ) );
	f8 below = f8_sub( zero, from_z );
	f8 slant = f8_div( f8_add( f8_mul( height, from_x ), f8_mul( sx, from_z ) ), f8_sqrt( length_sq ) );
	f8 t = f8_clamp01( f8_div( f8_sub( f8_mul( height, from_z ), f8_mul( sx, from_x ) ), length_sq ) );
	f8 dx = f8_add( from_x, f8_mul( t, sx ) ), dz = f8_sub( from_z, f8_mul( t, height ) );
	f8 norm = f8_sqrt( f8_divisor( f8_add( f8_mul( dx, dx ), f8_mul( dz, dz ) ) ) );
	// width along (dx, dz): least over the triangle's corners (the rim's corner is the origin of from)
	f8 to_rim = f8_add( f8_mul( dx, from_x ), f8_mul( dz, from_z ) );
	f8 to_apex = f8_add( f8_mul( dx, radial ), f8_mul( dz, f8_sub( from_z, height ) ) );
	f8 to_left_rim = f8_add( f8_mul( dx, f8_add( radial, sx ) ), f8_mul( dz, from_z ) );
	f8 nearest = f8_div( f8_min( f8_min( to_rim, to_apex ), to_left_rim ), norm );
	return f8_max( f8_max( f8_max( below, slant ), nearest ), zero );
}

static uint32_t node_primitive_gap( const lwi_node* node, const lwi_motion* motion, const lwi_primitive* primitive,
	float limit, float gap[LWI_WIDTH] )
{
	v3 center = { f8_load( node->x ), f8_load( node->y ), f8_load( node->z ) };
	return store_gap( gap, f8_sub( primitive_distance( v3_move( motion, center ), primitive ), f8_load( node->r ) ), limit );
}

/// At most 0 inside of a box, cylinder or half-space.
static inline f8 primitive_depth( v3 p, const lwi_primitive* primitive )
{
	if ( primitive->type == LW_SHAPE_HALFSPACE )
	{
		return p.z;
	}
	const f8 sx = f8_set( primitive->size[0] ), sy = f8_set( primitive->size[1] );
	if ( primitive->type == LW_SHAPE_BOX )
	{
		const f8 z = f8_sub( f8_abs( p.z ), f8_set( primitive->size[2] ) );
		return f8_max( f8_max( f8_sub( f8_abs( p.x ), sx ), f8_sub( f8_abs( p.y ), sy ) ), z );
	}
	const f8 radial = f8_sub( f8_add( f8_mul( p.x, p.x ), f8_mul( p.y, p.y ) ), f8_mul( sx, sx ) );
	return f8_max( radial, f8_sub( f8_abs( p.z ), sy ) );
}

static bool points_inside( const lwi_points8* points, uint32_t blocks, const lwi_motion* motion,
	const lwi_primitive* primitive )
{
	const f8 zero = f8_set( 0.0f );
	uint32_t inside = 0;
	for ( uint32_t i = 0; i < blocks && inside == 0; ++i )
	{
		const v3 p = { f8_load( points[i].at[0] ), f8_load( points[i].at[1] ), f8_load( points[i].at[2] ) };
		inside = m8_bits( f8_ge( zero, primitive_depth( v3_move( motion, p ), primitive ) ) ) & 0xffu;
	}
	return inside != 0;
}

/// The point of a box or cylinder that is nearest to p.
static inline v3 primitive_nearest( v3 p, const lwi_primitive* primitive )
{
	f8 sx = f8_set( primitive->size[0] ), sy = f8_set( primitive->size[1] ), sz = f8_set( primitive->size[2] ),
	   zero = f8_set( 0.0f );
	if ( primitive->type == LW_SHAPE_BOX )
	{
		return ( v3 ){ f8_min( f8_max( p.x, f8_sub( zero, sx ) ), sx ), f8_min( f8_max( p.y, f8_sub( zero, sy ) ), sy ),
			f8_min( f8_max( p.z, f8_sub( zero, sz ) ), sz ) };
	}
	f8 radial = f8_sqrt( f8_add( f8_mul( p.x, p.x ), f8_mul( p.y, p.y ) ) );
	f8 share = f8_min( f8_div( sx, f8_divisor( radial ) ), f8_set( 1.0f ) );
	return ( v3 ){ f8_mul( share, p.x ), f8_mul( share, p.y ), f8_min( f8_max( p.z, f8_sub( zero, sy ) ), sy ) };
}

/// Width of the slab between triangles and a box or cylinder along n, from triangle to primitive.
static inline f8 primitive_slab( v3 n, const v3 v[3], const lwi_primitive* primitive )
{
	f8 sx = f8_set( primitive->size[0] ), sy = f8_set( primitive->size[1] ), sz = f8_set( primitive->size[2] ), reach;
	if ( primitive->type == LW_SHAPE_BOX )
	{
		reach = f8_add( f8_add( f8_mul( sx, f8_abs( n.x ) ), f8_mul( sy, f8_abs( n.y ) ) ), f8_mul( sz, f8_abs( n.z ) ) );
	}
	else
	{
		// not less than it is: squares of a short n vanish, and the cylinder would have no width across it
		f8 across = f8_sqrt( f8_divisor( f8_add( f8_mul( n.x, n.x ), f8_mul( n.y, n.y ) ) ) );
		reach = f8_add( f8_mul( sx, across ), f8_mul( sy, f8_abs( n.z ) ) );
	}
	f8 high = f8_max( f8_max( v3_dot( n, v[0] ), v3_dot( n, v[1] ) ), v3_dot( n, v[2] ) );
	f8 width = f8_sub( f8_sub( f8_set( 0.0f ), reach ), high );
	return f8_div( width, f8_sqrt( f8_divisor( v3_dot( n, n ) ) ) );
}

/// Widest slab between triangles and a box along the cross products of an edge and an axis, where edges of both are nearest.
/// Such a direction lies in the plane of the other two axes; the box being symmetric, both ways along it give one slab.
static inline f8 edge_slabs( const v3 v[3], const lwi_primitive* primitive )
{
	const f8 x[3][3] = { { v[0].x, v[1].x, v[2].x }, { v[0].y, v[1].y, v[2].y }, { v[0].z, v[1].z, v[2].z } };
	f8 zero = f8_set( 0.0f ), best = f8_sub( zero, f8_set( INFINITY ) );
	for ( int i = 0; i < 3; ++i )
	{
		for ( int axis = 0; axis < 3; ++axis )
		{
			int p = ( axis + 1 ) % 3, q = ( axis + 2 ) % 3, next = ( i + 1 ) % 3;
			f8 np = f8_sub( x[q][next], x[q][i] ), nq = f8_sub( x[p][i], x[p][next] );
			f8 h0 = f8_add( f8_mul( np, x[p][0] ), f8_mul( nq, x[q][0] ) );
			f8 h1 = f8_add( f8_mul( np, x[p][1] ), f8_mul( nq, x[q][1] ) );
			f8 h2 = f8_add( f8_mul( np, x[p][2] ), f8_mul( nq, x[q][2] ) );
			f8 low = f8_min( f8_min( h0, h1 ), h2 ), high = f8_max( f8_max( h0, h1 ), h2 );
			f8 reach = f8_add( f8_mul( f8_set( primitive->size[p] ), f8_abs( np ) ),
				f8_mul( f8_set( primitive->size[q] ), f8_abs( nq ) ) );
			f8 width = f8_sub( f8_max( low, f8_sub( zero, high ) ), reach );
			f8 length = f8_sqrt( f8_divisor( f8_add( f8_mul( np, np ), f8_mul( nq, nq ) ) ) );
			best = f8_max( best, f8_div( width, length ) );
		}
	}
	return best;
}

/// Distance of triangles to a box or cylinder by slabs: a step towards the nearest points, each projecting on the other
/// (Cheney and Goldstein, Proximity maps for convex sets, Proceedings of the AMS 10, 1959), which finds faces and their
/// normals; the corners' own nearest points; and, where that is not enough, pairs of edges. These are all the features that
/// can be nearest but corners of the box, which the first step finds where triangles are not much larger.
static inline f8 triangle_primitive( const v3 v[3], v3 center, const lwi_primitive* primitive, float limit )
{
	v3 along, nearest;
	point_triangle( primitive_nearest( center, primitive ), v[0], v[1], v[2], &along, &nearest );
	f8 best = primitive_slab( along, v, primitive );
	for ( int i = 0; i < 3; ++i )
	{
		best = f8_max( best, primitive_slab( v3_sub( primitive_nearest( v[i], primitive ), v[i] ), v, primitive ) );
	}
	if ( primitive->type == LW_SHAPE_BOX && m8_bits( f8_ge( best, f8_set( limit ) ) ) != 0xffu )
	{
		best = f8_max( best, edge_slabs( v, primitive ) );
	}
	return best;
}

static uint32_t leaf_primitive_gap( const lwi_leaf* leaf, const lwi_motion* motion, const lwi_primitive* primitive,
	float limit, float gap[LWI_WIDTH] )
{
	v3 v0 = v3_load( leaf->v[0] ), v1 = v3_load( leaf->v[1] ), v2 = v3_load( leaf->v[2] );
	if ( primitive->type == LW_SHAPE_HALFSPACE || primitive->type == LW_SHAPE_PLANE )
	{
		f8 z0 = v3_move( motion, v0 ).z, z1 = v3_move( motion, v1 ).z, z2 = v3_move( motion, v2 ).z;
		f8 above = f8_min( f8_min( z0, z1 ), z2 );
		f8 below = f8_sub( f8_set( 0.0f ), f8_max( f8_max( z0, z1 ), z2 ) );
		return store_gap( gap, primitive->type == LW_SHAPE_PLANE ? f8_max( above, below ) : above, limit );
	}
	v3 center = v3_mul( f8_set( 1.0f / 3.0f ), v3_add( v3_add( v0, v1 ), v2 ) );
	v3 d0 = v3_sub( v0, center ), d1 = v3_sub( v1, center ), d2 = v3_sub( v2, center );
	f8 radius = f8_sqrt( f8_max( f8_max( v3_dot( d0, d0 ), v3_dot( d1, d1 ) ), v3_dot( d2, d2 ) ) );
	v3 moved = v3_move( motion, center );
	f8 by_sphere = f8_sub( primitive_distance( moved, primitive ), radius );
	uint32_t near = store_gap( gap, by_sphere, limit );
	if ( near == 0 || primitive->type == LW_SHAPE_CONE )
	{
		return near;
	}
	const v3 v[3] = { v3_move( motion, v0 ), v3_move( motion, v1 ), v3_move( motion, v2 ) };
	return store_gap( gap, f8_max( triangle_primitive( v, moved, primitive, limit ), by_sphere ), limit );
}

static void sincos_all( const double* restrict angle, uint32_t count, double* restrict cosine, double* restrict sine )
{
	bool reduced = true;
	for ( uint32_t i = 0; i < count; ++i )
	{
		lwi_sincos out = lwi_sincos_reduced( angle[i] );
		cosine[i] = out.c;
		sine[i] = out.s;
	}
	for ( uint32_t i = 0; i < count; ++i )
	{
		reduced = reduced && fabs( angle[i] ) <= LWI_SINCOS_LARGEST;
	}
	for ( uint32_t i = 0; i < count && !reduced; ++i )
	{
		lwi_sincos out = lwi_sincos_of( angle[i] );
		cosine[i] = out.c;
		sine[i] = out.s;
	}
}

/// Row i of a pose times the rows m, with 0, 0, 0, 1 below them.
static inline d4 row_times( const double row[4], const d4 m[4] )
{
	d4 sum = d4_mul( d4_set( row[0] ), m[0] );
	for ( int k = 1; k < 4; ++k )
	{
		sum = d4_add( sum, d4_mul( d4_set( row[k] ), m[k] ) );
	}
	return sum;
}

static void chain_tips( const lwi_pose_rows* restrict before, const double* restrict cosine, const double* restrict sine,
	const double* restrict shift, uint32_t count, lwi_pose_rows* restrict tips )
{
	static const double unit[4] = { 0, 0, 0, 1 };
	const d4 last = d4_load( unit );
	const lwi_pose_rows* tip = &tips[count];
	d4 m[4] = { d4_load( tip->at[0] ), d4_load( tip->at[1] ), d4_load( tip->at[2] ), last };
	for ( uint32_t i = count; i-- > 0; )
	{
		const d4 c = d4_set( cosine[i] ), s = d4_set( sine[i] ), x = m[0], y = m[1];
		m[0] = d4_add( d4_mul( c, x ), d4_mul( d4_set( -sine[i] ), y ) );
		m[1] = d4_add( d4_mul( s, x ), d4_mul( c, y ) );
		m[2] = d4_add( m[2], d4_mul( d4_set( shift[i] ), last ) );
		const d4 rows[3] = { row_times( before[i].at[0], m ), row_times( before[i].at[1], m ),
			row_times( before[i].at[2], m ) };
		for ( int k = 0; k < 3; ++k )
		{
			m[k] = rows[k];
			d4_store( tips[i].at[k], rows[k] );
		}
	}
}

#include "simd/kernels_lanes_impl.h"
#include "simd/kernels_convex_impl.h"
#include "simd/kernels_voxels_impl.h"

const lwi_kernels LWI_KERNELS = { LWI_KERNELS_LEVEL, sphere_gap, obb_gap, sphere_pairs, box_gap, box_pair_gap, leaf_gap,
	slab_gap, node_project, leaf_project, leaf_transform, points_move, points_farthest, corners_farthest, planes_clear,
	triangle_gap, node_primitive_gap, leaf_primitive_gap, points_inside, sincos_all, chain_tips, batch_frame, batch_point,
	batch_box, batch_pair, lane_frame, lane_of_batch, lane_point, lane_boxes, lane_body, lane_relative, lane_between,
	lane_slabs, convex_start, convex_step, point_voxels, pixel_voxels, sensor_points, ray_tangents, ray_pixels,
	voxels_before };
