// SPDX-License-Identifier: BSD-3-Clause
// Moves spheres so that the largest excess falls: fragments go to the sphere that needs least for them, spheres to where they
// need least for their fragments, and again.
//
// Lloyd, "Least squares quantization in PCM", 1982; Wang, Zhou, Snyder, Liu, Bao, Peng, Guo, "Variational sphere set
//   approximation for solid objects", 2006 (Lloyd's iteration for spheres around a solid; here it minimises the
//   certified excess instead of the volume outside); Hooke, Jeeves, "Direct search", 1961 (the moves).
#include "approximate/enclose.h"

#include "base/math_inline.h"

/// Moves of a centre begin with this share of the excess and end below the second.
#define FIRST_STEP 0.6
#define LAST_STEP 0.03

typedef struct refiner
{
	lwi_body* body;
	const lwi_fragment_tree* tree;
	lwi_site* sites;
	size_t site_count;
	uint32_t* owner; ///< [fragment]: site
	double* need;    ///< [fragment]: excess of the owner for it
	uint32_t* order; ///< [fragment]: fragments by owner
	uint32_t* start; ///< [site + 1] into order
	double* worst;   ///< [site]: excess it needs for its fragments
	lwi_array found;
} refiner;

/// Gives an owner to a fragment that no site reaches with the current excess. Never seen, but a fragment without a sphere must not
/// be.
static void adopt( refiner* r, uint32_t fragment )
{
	for ( size_t i = 0; i < r->site_count; ++i )
	{
		double need = lwi_fragment_reach( &r->tree->fragments[fragment], r->sites[i].center ) - r->sites[i].depth;
		if ( need < r->need[fragment] )
		{
			r->need[fragment] = need;
			r->owner[fragment] = (uint32_t)i;
		}
	}
}

/// Gives each fragment to the site that needs the least excess for it. Visits sites as far away as `excess` allows.
static bool assign( refiner* r, double excess )
{
	const lwi_fragment_tree* tree = r->tree;
	for ( uint32_t p = 0; p < tree->count; ++p )
	{
		r->owner[p] = LW_INVALID_INDEX;
		r->need[p] = INFINITY;
	}
	for ( size_t i = 0; i < r->site_count; ++i )
	{
		if ( lwi_body_stopped( r->body ) )
		{
			return false;
		}
		const lwi_site* site = &r->sites[i];
		double radius = site->depth + excess + r->body->slack; // a fragment exactly at the limit must not slip out
		if ( !lwi_fragment_tree_covered( tree, site->center, radius, &r->body->memory, &r->found ) )
		{
			return false;
		}
		const uint32_t* found = r->found.data;
		for ( size_t k = 0; k < r->found.count; ++k )
		{
			double need = lwi_fragment_reach( &tree->fragments[found[k]], site->center ) - site->depth;
			if ( need < r->need[found[k]] )
			{
				r->need[found[k]] = need;
				r->owner[found[k]] = (uint32_t)i;
			}
		}
	}
	memset( r->start, 0, ( r->site_count + 1 ) * sizeof( uint32_t ) );
	for ( size_t i = 0; i < r->site_count; ++i )
	{
		r->worst[i] = -INFINITY;
	}
	for ( uint32_t p = 0; p < tree->count; ++p )
	{
		if ( r->owner[p] == LW_INVALID_INDEX )
		{
			adopt( r, p );
		}
		++r->start[r->owner[p] + 1];
		r->worst[r->owner[p]] = fmax( r->worst[r->owner[p]], r->need[p] );
	}
	for ( size_t i = 0; i < r->site_count; ++i )
	{
		r->start[i + 1] += r->start[i];
	}
	for ( uint32_t p = tree->count; p-- > 0; )
	{
		// filled from the back: afterwards start[i] is where site i begins in order, shifted by one entry
		r->order[--r->start[r->owner[p] + 1]] = p;
	}
	return true;
}

/// Fragments of a site after assign(): start[i + 1] is its begin, and its end the begin of the next.
static size_t begin_of( const refiner* r, size_t site )
{
	return r->start[site + 1];
}

static size_t end_of( const refiner* r, size_t site )
{
	return site + 1 < r->site_count ? r->start[site + 2] : r->tree->count;
}

static double reach_of( const refiner* r, size_t site, lw_vec3 center )
{
	double reach = 0;
	for ( size_t k = begin_of( r, site ); k < end_of( r, site ); ++k )
	{
		reach = fmax( reach, lwi_fragment_reach( &r->tree->fragments[r->order[k]], center ) );
	}
	return reach;
}

/// Moves one site to where it needs less for its fragments, by steps along the axes and diagonals.
static void move_site( refiner* r, size_t site, double excess )
{
	static const double directions[14][3] = { { 1, 0, 0 }, { -1, 0, 0 }, { 0, 1, 0 }, { 0, -1, 0 }, { 0, 0, 1 },
		{ 0, 0, -1 }, { .577, .577, .577 }, { .577, .577, -.577 }, { .577, -.577, .577 }, { .577, -.577, -.577 },
		{ -.577, .577, .577 }, { -.577, .577, -.577 }, { -.577, -.577, .577 }, { -.577, -.577, -.577 } };
	lwi_site* s = &r->sites[site];
	for ( double step = FIRST_STEP * excess; step > LAST_STEP * excess; step *= 0.5 )
	{
		for ( int moves = 0; moves < 8; ++moves )
		{
			bool moved = false;
			for ( int d = 0; d < 14; ++d )
			{
				lwi_site next = { lwi_add_scaled( s->center, step, lwi_load( directions[d] ) ), 0 };
				double reach = reach_of( r, site, next.center );
				// the depth grows by at most the step: this test often suffices
				if ( reach - ( s->depth + step ) >= r->worst[site] )
				{
					continue;
				}
				next.depth = lwi_body_depth( r->body, next.center, false );
				if ( reach - next.depth < r->worst[site] - 1e-4 * excess )
				{
					r->worst[site] = reach - next.depth;
					*s = next;
					moved = true;
				}
			}
			if ( !moved )
			{
				break;
			}
		}
	}
}

static double largest( const refiner* r )
{
	double most = 0;
	for ( size_t i = 0; i < r->site_count; ++i )
	{
		most = fmax( most, r->worst[i] );
	}
	return most;
}

static bool make_refiner( refiner* r, lwi_body* body, const lwi_fragment_tree* tree, lwi_array* sites )
{
	const lw_allocator* memory = &body->memory;
	size_t fragments = tree->count, count = sites->count;
	*r = ( refiner ){ .body = body, .tree = tree, .sites = sites->data, .site_count = count };
	r->owner = lwi_alloc( memory, fragments * sizeof( uint32_t ) );
	r->need = lwi_alloc( memory, fragments * sizeof( double ) );
	r->order = lwi_alloc( memory, fragments * sizeof( uint32_t ) );
	r->start = lwi_alloc( memory, ( count + 1 ) * sizeof( uint32_t ) );
	r->worst = lwi_alloc( memory, count * sizeof( double ) );
	return r->owner != NULL && r->need != NULL && r->order != NULL && r->start != NULL && r->worst != NULL;
}

static void free_refiner( refiner* r )
{
	const lw_allocator* memory = &r->body->memory;
	size_t fragments = r->tree->count, count = r->site_count;
	lwi_array_free( &r->found, memory, sizeof( uint32_t ) );
	lwi_free( memory, r->owner, fragments * sizeof( uint32_t ) );
	lwi_free( memory, r->need, fragments * sizeof( double ) );
	lwi_free( memory, r->order, fragments * sizeof( uint32_t ) );
	lwi_free( memory, r->start, ( count + 1 ) * sizeof( uint32_t ) );
	lwi_free( memory, r->worst, count * sizeof( double ) );
}

double lwi_enclose_refine( lwi_body* body, const lwi_fragment_tree* tree, lwi_array* chosen, double excess, uint32_t rounds )
{
	refiner r;
	bool ok = make_refiner( &r, body, tree, chosen ) && assign( &r, excess );
	size_t count = chosen->count;
	double now = ok ? largest( &r ) : -1;
	for ( uint32_t round = 0; ok && round < rounds; ++round )
	{
		for ( size_t i = 0; i < count; ++i )
		{
			if ( begin_of( &r, i ) < end_of( &r, i ) )
			{
				move_site( &r, i, now );
			}
		}
		// each fragment is still within the excess of its own site: a search no farther than that loses nothing
		ok = assign( &r, largest( &r ) );
		now = ok ? largest( &r ) : -1;
	}
	free_refiner( &r );
	return now;
}

bool lwi_enclose_spheres( lwi_body* body, const lwi_fragment_tree* tree, lwi_array* chosen, double excess, double margin,
	lwi_array* spheres )
{
	refiner r;
	bool ok = make_refiner( &r, body, tree, chosen ) && assign( &r, excess );
	for ( size_t i = 0; ok && i < r.site_count; ++i )
	{
		if ( begin_of( &r, i ) >= end_of( &r, i ) )
		{
			continue; // others cover all that it covers
		}
		lw_vec3 c = r.sites[i].center;
		// the rounding of a reach, and the displacement of corners by bisecting triangles
		double radius = reach_of( &r, i, c ) * ( 1 + 16 * LWI_U64 ) + body->slack + margin;
		const double sphere[4] = { c.x, c.y, c.z, radius };
		ok = lwi_array_push( spheres, &body->memory, sizeof( sphere ), sphere );
	}
	free_refiner( &r );
	return ok;
}
