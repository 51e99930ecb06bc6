// SPDX-License-Identifier: BSD-3-Clause
// GJK of eight pairs of convex bodies at once (lwi_convex_lanes), a part of simd/kernels_impl.h. The numbers of a lane do not depend on the others.

/// Square of the shortest direction whose gap counts: squares below have lost digits.
#define CONVEX_LEAST_SQUARE 0x1p-960

typedef struct d3
{
	d4 x, y, z;
} d3;

static inline d3 d3_load( double ( *p )[LWI_WIDTH], uint32_t from )
{
	return ( d3 ){ d4_load( p[0] + from ), d4_load( p[1] + from ), d4_load( p[2] + from ) };
}
static inline void d3_store( double ( *p )[LWI_WIDTH], uint32_t from, d3 a )
{
	d4_store( p[0] + from, a.x );
	d4_store( p[1] + from, a.y );
	d4_store( p[2] + from, a.z );
}
static inline d3 d3_add( d3 a, d3 b )
{
	return ( d3 ){ d4_add( a.x, b.x ), d4_add( a.y, b.y ), d4_add( a.z, b.z ) };
}
static inline d3 d3_sub( d3 a, d3 b )
{
	return ( d3 ){ d4_sub( a.x, b.x ), d4_sub( a.y, b.y ), d4_sub( a.z, b.z ) };
}
static inline d3 d3_scale( d4 s, d3 a )
{
	return ( d3 ){ d4_mul( s, a.x ), d4_mul( s, a.y ), d4_mul( s, a.z ) };
}
static inline d4 d3_dot( d3 a, d3 b )
{
	return d4_add( d4_add( d4_mul( a.x, b.x ), d4_mul( a.y, b.y ) ), d4_mul( a.z, b.z ) );
}
static inline d3 d3_cross( d3 a, d3 b )
{
	return ( d3 ){ d4_sub( d4_mul( a.y, b.z ), d4_mul( a.z, b.y ) ), d4_sub( d4_mul( a.z, b.x ), d4_mul( a.x, b.z ) ),
		d4_sub( d4_mul( a.x, b.y ), d4_mul( a.y, b.x ) ) };
}
static inline d3 d3_select( d4_mask mask, d3 a, d3 b )
{
	return ( d3 ){ d4_select( mask, a.x, b.x ), d4_select( mask, a.y, b.y ), d4_select( mask, a.z, b.z ) };
}

/// The point of the simplex that is nearest to the origin, its square, and the weights of the new point and of those before.
typedef struct convex_nearest
{
	d3 v;
	d4 square, own, weight[3];
} convex_nearest;

/// @param which, also two points of the simplex @param own, one, two the weights of the new point and of these
static inline void convex_offer( convex_nearest* best, d4_mask holds, d3 v, uint32_t which, uint32_t also, d4 own, d4 one,
	d4 two )
{
	const d4 square = d3_dot( v, v ), zero = d4_set( 0 );
	const d4_mask is_less = d4_both( holds, d4_lt( square, best->square ) );
	best->v = d3_select( is_less, v, best->v );
	best->square = d4_select( is_less, square, best->square );
	best->own = d4_select( is_less, own, best->own );
	for ( uint32_t i = 0; i < 3; ++i )
	{
		best->weight[i] = d4_select( is_less, i == which ? one : i == also ? two : zero, best->weight[i] );
	}
}

/// The segment from p to point `at` of the simplex, both ends included.
static inline void convex_segment( convex_nearest* best, d3 p, d3 q, uint32_t at )
{
	const d4 zero = d4_set( 0 ), one = d4_set( 1 );
	const d3 e = d3_sub( q, p );
	const d4 square = d3_dot( e, e ), along = d4_sub( zero, d3_dot( p, e ) );
	const d4_mask inside = d4_both( d4_lt( zero, along ), d4_lt( along, square ) );
	const d4 end = d4_select( d4_lt( zero, along ), one, zero ), t = d4_select( inside, d4_div( along, square ), end );
	d3 v = d3_add( p, d3_scale( t, e ) );
	// once more: v is then orthogonal to e to rounding of its own length
	const d4 rest = d4_select( inside, d4_div( d3_dot( v, e ), square ), zero );
	v = d3_sub( v, d3_scale( rest, e ) );
	convex_offer( best, d4_lt( zero, one ), v, at, 3, d4_sub( one, t ), t, zero );
}

/// The inside of the triangle of p and two points of the simplex.
static inline void convex_triangle( convex_nearest* best, d3 p, d3 q, d3 r, uint32_t at_q, uint32_t at_r )
{
	const d4 zero = d4_set( 0 );
	const d3 e = d3_sub( q, p ), f = d3_sub( r, p ), n = d3_cross( e, f );
	const d4 square = d3_dot( n, n );
	const d4 by_q = d4_div( d3_dot( d3_cross( f, p ), n ), square ), by_r = d4_div( d3_dot( d3_cross( p, e ), n ), square );
	const d4 own = d4_sub( d4_sub( d4_set( 1 ), by_q ), by_r );
	const d4_mask inside = d4_both( d4_both( d4_lt( zero, by_q ), d4_lt( zero, by_r ) ), d4_lt( zero, own ) );
	convex_offer( best, inside, d3_scale( d4_div( d3_dot( p, n ), square ), n ), at_q, at_r, own, by_q, by_r );
}

static inline d3 convex_turned( double ( *r )[LWI_WIDTH], uint32_t from, d3 a )
{
	const d3 rows[3] = { d3_load( r, from ), d3_load( r + 3, from ), d3_load( r + 6, from ) };
	return ( d3 ){ d3_dot( rows[0], a ), d3_dot( rows[1], a ), d3_dot( rows[2], a ) };
}

/// Where the bodies are farthest along a direction, and of boxes their points there.
static inline void convex_aim( lwi_convex_lanes* lanes, uint32_t from, d3 v )
{
	const d4 zero = d4_set( 0 );
	d3_store( lanes->v, from, v );
	for ( uint32_t side = 0; side < 2; ++side )
	{
		double( *r )[LWI_WIDTH] = lanes->rotation[side];
		const d3 n = side == 0 ? ( d3 ){ d4_sub( zero, v.x ), d4_sub( zero, v.y ), d4_sub( zero, v.z ) } : v;
		for ( uint32_t i = 0; i < 3; ++i )
		{
			const d3 column = { d4_load( r[i] + from ), d4_load( r[3 + i] + from ), d4_load( r[6 + i] + from ) };
			const d4 along = d3_dot( column, n ), half = d4_load( lanes->half[side][i] + from );
			d4_store( lanes->along[side][i] + from, along );
			d4_store( lanes->support[side][i] + from, d4_select( d4_lt( along, zero ), d4_sub( zero, half ), half ) );
		}
	}
}

static inline d4 d4_abs( d4 a )
{
	return d4_max( a, d4_sub( d4_set( 0 ), a ) );
}

static inline void convex_start_four( lwi_convex_lanes* lanes, uint32_t from, double rounding, double error )
{
	const d4 zero = d4_set( 0 );
	d3 origin[2], middle[2];
	d4 radii = zero, sizes = zero;
	for ( uint32_t side = 0; side < 2; ++side )
	{
		origin[side] = convex_turned( lanes->rotation[side], from, d3_load( lanes->origin[side], from ) );
		middle[side] = convex_turned( lanes->rotation[side], from, d3_load( lanes->middle[side], from ) );
		radii = d4_add( radii, d4_load( lanes->radius[side] + from ) );
		sizes = d4_add( sizes, d4_load( lanes->size[side] + from ) );
	}
	const d3 between = d3_sub( d3_load( lanes->place[1], from ), d3_load( lanes->place[0], from ) );
	const d3 t = d3_sub( d3_add( between, origin[1] ), origin[0] );
	const d4 extent = d4_add( radii, d4_sqrt( d3_dot( t, t ) ) ), round = d4_mul( d4_set( rounding ), extent );
	const d4 share = d4_max( d4_load( lanes->share[0] + from ), d4_load( lanes->share[1] + from ) );
	const d4 largest = d4_max( d4_max( d4_abs( between.x ), d4_abs( between.y ) ), d4_abs( between.z ) );
	const d4 off = d4_mul( d4_set( error ), d4_add( sizes, largest ) );
	d3_store( lanes->first, from, origin[0] );
	d3_store( lanes->second, from, t );
	d4_store( lanes->rounding + from, round );
	d4_store( lanes->error + from, off );
	d4_store( lanes->width + from, d4_max( d4_mul( share, extent ), d4_mul( d4_set( 1.5 ), round ) ) );
	d4_store( lanes->far + from, d4_add( d4_load( lanes->far + from ), d4_add( off, off ) ) );
	d4_store( lanes->lower + from, d4_set( -INFINITY ) );
	d4_store( lanes->upper + from, d4_set( INFINITY ) );
	d3 v = d3_sub( d3_sub( middle[0], middle[1] ), t );
	v.x = d4_select( d4_lt( zero, d3_dot( v, v ) ), v.x, d4_set( 1 ) );
	convex_aim( lanes, from, v );
}

static void convex_start( lwi_convex_lanes* lanes, uint32_t open, double rounding, double error )
{
	for ( uint32_t from = 0; from < LWI_WIDTH; from += 4 )
	{
		if ( ( open >> from & 0xfu ) != 0 )
		{
			convex_start_four( lanes, from, rounding, error );
		}
	}
}

/// The new point of the simplex in each body, and those before.
typedef struct convex_simplex
{
	d3 own[2], before[3][2];
} convex_simplex;

/// Keeps the points that have a weight; the new point takes the places that are left.
static inline void convex_reduce( lwi_convex_lanes* lanes, uint32_t from, uint32_t known, const convex_simplex* simplex,
	const convex_nearest* nearest )
{
	for ( uint32_t side = 0; side < 2; ++side )
	{
		d3 first = simplex->own[side], second = simplex->own[side];
		for ( uint32_t i = known; i-- > 0; ) // the first that counts is the last to be taken
		{
			const d4_mask counts = d4_lt( d4_set( 0 ), nearest->weight[i] );
			second = d3_select( counts, first, second );
			first = d3_select( counts, simplex->before[i][side], first );
		}
		d3_store( lanes->corner[0][side], from, simplex->own[side] );
		d3_store( lanes->corner[1][side], from, first );
		d3_store( lanes->corner[2][side], from, second );
	}
}

/// The nearest of all sides of the simplex but those without the new point, which cannot hold it.
static inline convex_nearest convex_nearest_of( const convex_simplex* simplex, d3 p, uint32_t known )
{
	const d4 zero = d4_set( 0 );
	convex_nearest out = { p, d3_dot( p, p ), d4_set( 1 ), { zero, zero, zero } };
	d3 w[3];
	for ( uint32_t i = 0; i < known; ++i )
	{
		w[i] = d3_sub( simplex->before[i][0], simplex->before[i][1] );
		convex_segment( &out, p, w[i], i );
	}
	for ( uint32_t i = 0; i + 1 < known; ++i )
	{
		for ( uint32_t k = i + 1; k < known; ++k )
		{
			convex_triangle( &out, p, w[i], w[k], i, k );
		}
	}
	return out;
}

/// The weighted points, if they are nearer than those so far. Returns the upper bound.
static inline d4 convex_witness( lwi_convex_lanes* lanes, uint32_t from, uint32_t known, const convex_simplex* simplex,
	const convex_nearest* nearest )
{
	d3 point[2];
	for ( uint32_t side = 0; side < 2; ++side )
	{
		point[side] = d3_scale( nearest->own, simplex->own[side] );
		for ( uint32_t i = 0; i < known; ++i )
		{
			point[side] = d3_add( point[side], d3_scale( nearest->weight[i], simplex->before[i][side] ) );
		}
	}
	const d3 between = d3_sub( point[0], point[1] );
	const d4 length = d4_sqrt( d3_dot( between, between ) ), last = d4_load( lanes->upper + from );
	const d4_mask nearer = d4_lt( length, last );
	for ( uint32_t side = 0; side < 2; ++side )
	{
		const d3 so_far = known > 0 ? d3_load( lanes->point[side], from ) : point[side];
		d3_store( lanes->point[side], from, d3_select( nearer, point[side], so_far ) );
	}
	const d4 upper = d4_select( nearer, length, last );
	d4_store( lanes->upper + from, upper );
	return upper;
}

static inline uint32_t convex_step_four( lwi_convex_lanes* lanes, uint32_t from, uint32_t known )
{
	const d3 v = d3_load( lanes->v, from );
	convex_simplex simplex;
	for ( uint32_t side = 0; side < 2; ++side )
	{
		simplex.own[side] = convex_turned( lanes->rotation[side], from, d3_load( lanes->support[side], from ) );
		for ( uint32_t i = 0; i < known; ++i )
		{
			simplex.before[i][side] = d3_load( lanes->corner[i][side], from );
		}
	}
	simplex.own[1] = d3_add( simplex.own[1], d3_load( lanes->second, from ) );
	const d3 p = d3_sub( simplex.own[0], simplex.own[1] );
	const d4 square = d3_dot( v, v ), last = d4_load( lanes->lower + from );
	const d4 gap = d4_sub( d4_div( d3_dot( v, p ), d4_sqrt( square ) ), d4_load( lanes->rounding + from ) );
	const d4_mask counts = d4_both( d4_lt( d4_set( CONVEX_LEAST_SQUARE ), square ), d4_lt( last, gap ) );
	const d4 lower = d4_select( counts, gap, last );
	d4_store( lanes->lower + from, lower );
	const convex_nearest nearest = convex_nearest_of( &simplex, p, known );
	const d4 upper = convex_witness( lanes, from, known, &simplex, &nearest );
	convex_reduce( lanes, from, known, &simplex, &nearest );
	convex_aim( lanes, from, nearest.v );
	const d4_mask narrow = d4_lt( d4_sub( upper, lower ), d4_load( lanes->width + from ) );
	const d4_mask apart = d4_lt( d4_set( 0 ), lower ), is_far = d4_lt( d4_load( lanes->far + from ), lower );
	return d4_bits( d4_either( d4_both( apart, narrow ), is_far ) );
}

/// Each count has a loop of its own.
static inline uint32_t convex_step_of( lwi_convex_lanes* lanes, uint32_t open, uint32_t known )
{
	return open & ( ( ( open & 0xfu ) != 0 ? convex_step_four( lanes, 0, known ) : 0 ) |
					  ( ( open & 0xf0u ) != 0 ? convex_step_four( lanes, 4, known ) << 4 : 0 ) );
}

static uint32_t convex_step( lwi_convex_lanes* lanes, uint32_t open, uint32_t known )
{
	return known == 0   ? convex_step_of( lanes, open, 0 )
		   : known == 1 ? convex_step_of( lanes, open, 1 )
		   : known == 2 ? convex_step_of( lanes, open, 2 )
						: convex_step_of( lanes, open, 3 );
}
