// SPDX-License-Identifier: BSD-3-Clause
// Convex hulls by qhull, and a proof of them that does not trust it.
//
// Papers: Barber, Dobkin, Huhdanpaa, The Quickhull algorithm for convex hulls, 1996 (qhull; its option W leaves out points
// that are close to a facet, the farthest are added first). The walk over facets is the visibility walk of Devillers, Pion,
// Teillaud, Walking in a triangulation, 2002, on the facets seen from the centre.
//
// The output of qhull is only a proposal. For each point p that is dropped, a point of the hull of the kept ones is written
// down as a convex combination of the centre c (the mean of the kept ones) and the corners v0 v1 v2 of the facet that the
// ray from c to p leaves through,
//     p' = c + sum w_k ( v_k - c ),  w_k >= 0,  sum w_k <= 1,
// p itself where that is possible, and |p - p'| bounds how far p is outside. A wrong facet gives a larger bound, never a
// false one. Where that bound is larger than others', the distance of distance/convex.h decides (its upper bound is attained
// by a point of the hull too).
#include "reachability/qhull.h"

#include "distance/convex.h"
#include "base/math_inline.h"
#include "base/sincos.h"

#include <stdlib.h>
#include <string.h>

#if LEEWAY_HULLS

#include <stdio.h>

#include <libqhull_r/qhull_ra.h>

enum
{
	/// Extreme points along so many directions are kept where qhull refuses: flat sets, segments, repeated points.
	DIRECTIONS = 512,
	MAX_ATTEMPTS = 40
};

/// Distances of points that are computed here are wrong by at most this, relative to the extent.
#define ROUNDING ( 64.0 * LWI_U64 )

/// A facet seen from the centre: row k of `inverse` times ( p - c ), over `det`, is the weight of corner k.
typedef struct hull_facet
{
	lw_vec3 corner[3]; ///< about the centre
	lw_vec3 row[3];
	double det;
	uint32_t neighbor[3]; ///< across the edge opposite of corner k
} hull_facet;

/// A dropped point, and how far outside it may be.
typedef struct hull_rest
{
	double bound;
	size_t point;
} hull_rest;

typedef struct hull_work
{
	const lw_allocator* allocator;
	const double* points;
	size_t count, kept_count;
	unsigned char* kept; ///< [count]
	size_t source_count; ///< number of points given to qhull: all, or those that it kept with a smaller width
	uint32_t* source;    ///< [count] indices
	double* copy;        ///< [count][3] of the source
	lw_vec3 center;      ///< mean of the kept points
	size_t facet_count;
	hull_facet* facets;
	size_t allocated; ///< kept_count of the attempt that hull and rests are for
	double* hull;     ///< [allocated][3]
	hull_rest* rests; ///< [count - allocated]
} hull_work;

/// Frees the data of one attempt: all but kept, source and copy.
static void free_attempt( hull_work* w )
{
	lwi_free( w->allocator, w->facets, w->facet_count * sizeof( hull_facet ) );
	lwi_free( w->allocator, w->hull, 3 * w->allocated * sizeof( double ) );
	lwi_free( w->allocator, w->rests, ( w->count - w->allocated ) * sizeof( hull_rest ) );
	w->facets = NULL;
	w->facet_count = 0;
	w->hull = NULL;
	w->rests = NULL;
}

// ---- qhull -----------------------------------------------------------------------------------------------------------

static void find_center( hull_work* w )
{
	lw_vec3 sum = { 0, 0, 0 };
	w->kept_count = 0;
	for ( size_t i = 0; i < w->count; ++i )
	{
		if ( w->kept[i] )
		{
			sum = lwi_add( sum, lwi_load( w->points + 3 * i ) );
			++w->kept_count;
		}
	}
	w->center = lwi_scale( 1.0 / (double)w->kept_count, sum );
}

static double farthest_from_center( const hull_work* w )
{
	double most = 0;
	for ( size_t i = 0; i < w->count; ++i )
	{
		most = fmax( most, lwi_distance( lwi_load( w->points + 3 * i ), w->center ) );
	}
	return most;
}

static void copy_facet( hull_work* w, const facetT* from, hull_facet* to )
{
	for ( int k = 0; k < 3; ++k )
	{
		const vertexT* vertex = SETelemt_( from->vertices, k, vertexT );
		const facetT* neighbor = SETelemt_( from->neighbors, k, facetT );
		to->corner[k] = lwi_sub( lwi_load( vertex->point ), w->center );
		to->neighbor[k] = neighbor->visitid;
	}
	for ( int k = 0; k < 3; ++k )
	{
		to->row[k] = lwi_cross( to->corner[( k + 1 ) % 3], to->corner[( k + 2 ) % 3] );
	}
	to->det = lwi_dot( to->corner[0], to->row[0] );
}

/// Facets and vertices of a finished hull. A facet that is no triangle is never entered: the bound holds without it.
static bool copy_hull( hull_work* w, qhT* qh )
{
	vertexT* vertex;
	facetT* facet;
	memset( w->kept, 0, w->count );
	FORALLvertices
	{
		w->kept[w->source[( vertex->point - w->copy ) / 3]] = 1;
	}
	find_center( w );
	unsigned int number = 0;
	FORALLfacets
	{
		facet->visitid = number++;
	}
	w->facets = lwi_alloc_zero( w->allocator, number, sizeof( hull_facet ) );
	if ( w->facets == NULL )
	{
		return false;
	}
	w->facet_count = number;
	FORALLfacets
	{
		if ( facet->simplicial && qh_setsize( qh, facet->vertices ) == 3 && qh_setsize( qh, facet->neighbors ) == 3 )
		{
			copy_facet( w, facet, &w->facets[facet->visitid] );
		}
	}
	return true;
}

/// qhull writes its messages to a file; nobody reads them here.
static FILE* open_nowhere( void )
{
	FILE* file = fopen( "/dev/null", "w" );
	// cppcheck-suppress resourceLeak ; run_qhull() closes it
	return file != NULL ? file : tmpfile();
}

/// @param out_refused qhull finds the set flat, or fails otherwise
static lw_status run_qhull( hull_work* w, double tolerance, bool* out_refused )
{
	*out_refused = true;
	if ( w->source_count < 5 || w->source_count > INT32_MAX / 4 )
	{
		return LW_OK;
	}
	for ( size_t i = 0; i < w->source_count; ++i )
	{
		memcpy( w->copy + 3 * i, w->points + 3 * (size_t)w->source[i], 3 * sizeof( double ) );
	}
	FILE* nowhere = open_nowhere();
	qhT* qh = lwi_alloc( w->allocator, sizeof( qhT ) );
	if ( nowhere == NULL || qh == NULL )
	{
		if ( nowhere != NULL )
		{
			fclose( nowhere );
		}
		lwi_free( w->allocator, qh, sizeof( qhT ) );
		return LW_ERROR_OUT_OF_MEMORY;
	}
	char command[64];
	if ( tolerance > 0 )
	{
		snprintf( command, sizeof( command ), "qhull Qt Pp W%.6e", tolerance );
	}
	else
	{
		snprintf( command, sizeof( command ), "qhull Qt Pp" );
	}
	// errors inside end in its own setjmp and come back as an exit code
	qh_zero( qh, nowhere );
	int code = qh_new_qhull( qh, 3, (int)w->source_count, w->copy, False, command, nowhere, nowhere );
	lw_status status = LW_OK;
	if ( code == 0 )
	{
		*out_refused = false;
		status = copy_hull( w, qh ) ? LW_OK : LW_ERROR_OUT_OF_MEMORY;
	}
	else if ( code == qh_ERRmem )
	{
		status = LW_ERROR_OUT_OF_MEMORY;
	}
	qh->NOerrexit = True;
	qh_freeqhull( qh, !qh_ALL );
	int long_memory, short_memory;
	qh_memfreeshort( qh, &long_memory, &short_memory );
	fclose( nowhere );
	lwi_free( w->allocator, qh, sizeof( qhT ) );
	return status;
}

/// Extreme points along directions spread by the golden angle.
static void keep_extremes( hull_work* w, size_t max_points )
{
	memset( w->kept, 0, w->count );
	size_t directions = max_points < DIRECTIONS ? max_points : DIRECTIONS;
	for ( size_t d = 0; d < directions; ++d )
	{
		double z = 1 - ( 2 * (double)d + 1 ) / (double)directions, r = sqrt( 1 - z * z );
		lwi_sincos turn = lwi_sincos_of( 2.39996322972865332 * (double)d );
		lw_vec3 n = lwi_v3( r * turn.c, r * turn.s, z );
		size_t best = 0;
		double most = -INFINITY;
		for ( size_t i = 0; i < w->count; ++i )
		{
			double reach = lwi_dot( n, lwi_load( w->points + 3 * i ) );
			if ( reach > most )
			{
				most = reach;
				best = i;
			}
		}
		w->kept[best] = 1;
	}
	find_center( w );
}

// ---- proof -----------------------------------------------------------------------------------------------------------

/// The facet that the ray from the centre along v leaves through, from `start` across the edge that v is farthest beyond.
/// It may end elsewhere if the facets are wrong.
static uint32_t walk( const hull_work* w, lw_vec3 v, uint32_t start )
{
	uint32_t at = start;
	for ( size_t step = 0; step < w->facet_count; ++step )
	{
		const hull_facet* f = &w->facets[at];
		double sign = f->det < 0 ? -1 : 1;
		double worst = 0;
		uint32_t next = at;
		for ( int k = 0; k < 3; ++k )
		{
			double side = sign * lwi_dot( f->row[k], v );
			if ( side < worst )
			{
				worst = side;
				next = f->neighbor[k];
			}
		}
		if ( next == at || next >= w->facet_count )
		{
			break;
		}
		at = next;
	}
	return at;
}

/// Weights of the foot of the perpendicular on the facet: nearer than where the ray leaves. @return false if it is beside it
static bool weights_of_foot( const hull_facet* f, lw_vec3 v, double weight[3] )
{
	lw_vec3 e1 = lwi_sub( f->corner[1], f->corner[0] ), e2 = lwi_sub( f->corner[2], f->corner[0] );
	lw_vec3 n = lwi_cross( e1, e2 ), w = lwi_sub( v, f->corner[0] );
	double nn = lwi_length_sq( n );
	if ( !( nn > 0 ) )
	{
		return false;
	}
	weight[1] = lwi_dot( lwi_cross( w, e2 ), n ) / nn;
	weight[2] = lwi_dot( lwi_cross( e1, w ), n ) / nn;
	weight[0] = 1 - weight[1] - weight[2];
	return weight[0] >= 0 && weight[1] >= 0 && weight[2] >= 0;
}

/// |p - p'| of the combination at the top of this file; v = p - c.
static double outside_of_facet( const hull_facet* f, lw_vec3 v )
{
	if ( f->det == 0 )
	{
		return INFINITY;
	}
	double weight[3], sum = 0;
	for ( int k = 0; k < 3; ++k )
	{
		weight[k] = fmax( 0.0, lwi_dot( f->row[k], v ) / f->det );
		sum += weight[k];
	}
	if ( !( sum < 1e6 ) )
	{
		return INFINITY;
	}
	if ( sum > 1 )
	{
		double scale = 1 / sum, foot[3];
		if ( weights_of_foot( f, v, foot ) )
		{
			memcpy( weight, foot, sizeof( foot ) );
			scale = 1;
		}
		for ( int k = 0; k < 3; ++k )
		{
			weight[k] *= scale;
		}
	}
	lw_vec3 inside = { 0, 0, 0 };
	for ( int k = 0; k < 3; ++k )
	{
		inside = lwi_add_scaled( inside, weight[k], f->corner[k] );
	}
	return lwi_distance( v, inside );
}

static int by_bound( const void* a, const void* b )
{
	const hull_rest* x = a;
	const hull_rest* y = b;
	if ( x->bound != y->bound )
	{
		return x->bound > y->bound ? -1 : 1;
	}
	return x->point < y->point ? -1 : x->point > y->point ? 1 : 0;
}

/// Largest distance of a dropped point from the hull of the kept ones, without rounding.
static double prove( hull_work* w )
{
	double floor = ROUNDING * farthest_from_center( w ); // smaller bounds are not refined: the rounding covers them
	size_t rest_count = 0, hull_count = 0;
	uint32_t facet = 0;
	for ( size_t i = 0; i < w->count; ++i )
	{
		lw_vec3 p = lwi_load( w->points + 3 * i );
		if ( w->kept[i] )
		{
			memcpy( w->hull + 3 * hull_count++, w->points + 3 * i, 3 * sizeof( double ) );
			continue;
		}
		double bound = INFINITY;
		if ( w->facet_count > 0 )
		{
			lw_vec3 v = lwi_sub( p, w->center );
			facet = walk( w, v, facet );
			bound = outside_of_facet( &w->facets[facet], v );
		}
		if ( bound > floor )
		{
			w->rests[rest_count++] = ( hull_rest ){ bound, i };
		}
	}
	qsort( w->rests, rest_count, sizeof( hull_rest ), by_bound );
	lwi_convex hull = { .type = LWI_CONVEX_POINTS, .points = w->hull, .point_count = (uint32_t)w->kept_count };
	lw_transform identity = lw_transform_identity();
	double most = floor;
	for ( size_t i = 0; i < rest_count && w->rests[i].bound > most; ++i )
	{
		lw_vec3 p = lwi_load( w->points + 3 * w->rests[i].point );
		lwi_convex point = { .type = LWI_CONVEX_TRIANGLE, .vertex = { p, p, p } };
		lwi_convex_result r = lwi_convex_distance( &point, &hull, &identity, INFINITY, most );
		most = fmax( most, fmin( r.upper, w->rests[i].bound ) );
	}
	return most;
}

// ---- attempts --------------------------------------------------------------------------------------------------------

/// Proves the choice in kept[]; the kept points are then in w->hull. @param out_outside without rounding
static lw_status prove_attempt( hull_work* w, double* out_outside )
{
	w->allocated = w->kept_count;
	w->hull = lwi_alloc( w->allocator, 3 * w->kept_count * sizeof( double ) );
	w->rests = lwi_alloc( w->allocator, ( w->count - w->kept_count ) * sizeof( hull_rest ) );
	if ( w->hull == NULL || w->rests == NULL )
	{
		return LW_ERROR_OUT_OF_MEMORY;
	}
	*out_outside = prove( w );
	return LW_OK;
}

/// Without qhull: all points if they are few, else extreme ones.
static lw_status attempt_extremes( hull_work* w, size_t max_points, double* out_outside )
{
	free_attempt( w );
	if ( w->count <= max_points )
	{
		memset( w->kept, 1, w->count );
		find_center( w );
	}
	else
	{
		keep_extremes( w, max_points );
	}
	return prove_attempt( w, out_outside );
}

/// All points, or the points kept now: all others are close to their hull already.
static void choose_source( hull_work* w, bool only_kept )
{
	w->source_count = 0;
	for ( size_t i = 0; i < w->count; ++i )
	{
		if ( !only_kept || w->kept[i] )
		{
			w->source[w->source_count++] = (uint32_t)i;
		}
	}
}

/// Finds the tolerance for qhull. Too many points: larger. Points that it leaves out of a thin set within its tolerance of
/// two opposite facets may be far outside beyond their rims: smaller, and from then on never as large again.
static lw_status attempt_all( hull_work* w, double tolerance, size_t max_points, double* out_outside )
{
	double width = tolerance, limit = INFINITY;
	choose_source( w, false );
	for ( int attempt = 0; attempt < MAX_ATTEMPTS; ++attempt )
	{
		bool refused;
		free_attempt( w );
		lw_status status = run_qhull( w, width, &refused );
		if ( status != LW_OK || refused )
		{
			return status == LW_OK ? attempt_extremes( w, max_points, out_outside ) : status;
		}
		if ( w->kept_count > max_points )
		{
			// on smooth surfaces the number of vertices goes with 1 / width
			double more = fmax( 1.25, 1.1 * (double)w->kept_count / (double)max_points );
			width = width > 0 ? width * more : 1e-6 * farthest_from_center( w );
			if ( width >= limit )
			{
				return attempt_extremes( w, max_points, out_outside );
			}
			choose_source( w, true );
			continue;
		}
		status = prove_attempt( w, out_outside );
		if ( status != LW_OK || !( *out_outside > 2 * width ) || !( width > 0 ) )
		{
			return status;
		}
		limit = width;
		choose_source( w, false );
		width = width > 1e-9 * farthest_from_center( w ) ? 0.1 * width : 0;
	}
	return attempt_extremes( w, max_points, out_outside );
}

bool lwi_hulls_available( void )
{
	return true;
}

lw_status lwi_reduce_points( double* points, size_t* count, double tolerance, size_t max_points,
	const lw_allocator* allocator, double* out_outside )
{
	*out_outside = 0;
	if ( *count <= 4 )
	{
		return LW_OK;
	}
	hull_work w = { .allocator = allocator, .points = points, .count = *count };
	w.kept = lwi_alloc_zero( allocator, w.count, 1 );
	w.source = lwi_alloc( allocator, w.count * sizeof( uint32_t ) );
	w.copy = lwi_alloc( allocator, 3 * w.count * sizeof( double ) );
	bool ready = w.kept != NULL && w.source != NULL && w.copy != NULL;
	double outside = 0;
	lw_status status = ready ? attempt_all( &w, tolerance, max_points, &outside ) : LW_ERROR_OUT_OF_MEMORY;
	if ( status == LW_OK )
	{
		double extent = lwi_length( w.center ) + farthest_from_center( &w );
		// the centre is the mean of the kept points to one rounding for each of them
		double rounding = ( ROUNDING + LWI_U64 * (double)w.kept_count ) * 2 * extent;
		*out_outside = w.kept_count < w.count ? ( outside + rounding ) * ( 1 + ROUNDING ) : 0;
		memcpy( points, w.hull, 3 * w.kept_count * sizeof( double ) );
		*count = w.kept_count;
	}
	free_attempt( &w );
	lwi_free( allocator, w.kept, w.count );
	lwi_free( allocator, w.source, w.count * sizeof( uint32_t ) );
	lwi_free( allocator, w.copy, 3 * w.count * sizeof( double ) );
	return status;
}

#else

bool lwi_hulls_available( void )
{
	return false;
}

lw_status lwi_reduce_points( double* points, size_t* count, double tolerance, size_t max_points,
	const lw_allocator* allocator, double* out_outside )
{
	(void)points;
	(void)count;
	(void)tolerance;
	(void)max_points;
	(void)allocator;
	*out_outside = INFINITY;
	return LW_ERROR_UNSUPPORTED;
}

#endif
