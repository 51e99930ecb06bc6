// SPDX-License-Identifier: BSD-3-Clause
// Planes that separated pairs of shapes, remembered by pair: the quickest end of most searches that find nothing.
#include "distance/pair_query.h"

enum
{
	MAX_FAILURES = 3, ///< after so many, one search in 2^3 tries
	PLANE_DIRECTIONS_KNOWN = 2,
	PLANE_DIRECTIONS_NEW = LWI_MAX_DIRECTIONS
};

/// Depends on the geometry, not on addresses: within alpha, the known planes choose the one of the nearest pairs that is
/// found first, and a run that another process repeats must find the same one.
static uint64_t hash_of( const lw_shape* shape )
{
	uint64_t bits[4];
	memcpy( bits, shape->sphere_center, sizeof( shape->sphere_center ) );
	memcpy( bits + 3, &shape->sphere_radius, sizeof( shape->sphere_radius ) );
	uint64_t hash = (uint64_t)shape->type * 0x165667b19e3779f9u + shape->item_count;
	for ( int i = 0; i < 4; ++i )
	{
		hash = ( hash ^ bits[i] ) * 0x9e3779b97f4a7c15u;
		hash ^= hash >> 29;
	}
	return hash;
}

static lwi_cached_axis* cached_axis_of( lwi_searching* s )
{
	uint64_t shapes = hash_of( s->a ) * 0x9e3779b97f4a7c15u ^ hash_of( s->b ) * 0xc2b2ae3d27d4eb4fu;
	uint32_t key = (uint32_t)( shapes >> 32 ) ^ s->bound->current_pair * 0x85ebca6bu;
	key = key != 0 ? key : 1;
	lwi_cached_axis* axis = &s->memory->axis_cache[key >> ( 32 - LWI_AXIS_CACHE_BITS )];
	if ( axis->key != key )
	{
		*axis = ( lwi_cached_axis ){ .key = key };
	}
	return axis;
}

/// True if the plane that separated the two last time does so again, or one near it.
static bool old_plane_rules_out( lwi_searching* s, lwi_cached_axis* axis )
{
	return axis->known &&
		   lwi_separate( s->kernels, s->a, s->b, &s->from_other[LWI_A], s->limit, &axis->plane, PLANE_DIRECTIONS_KNOWN );
}

/// Searches for a new plane, less often after searches that found none.
static bool new_plane_rules_out( lwi_searching* s, lwi_cached_axis* axis )
{
	if ( !lwi_backoff_is_due( &axis->backoff ) )
	{
		return false;
	}
	axis->plane = lwi_plane_between( s->a, s->b, &s->from_other[LWI_B] );
	axis->known =
		lwi_separate( s->kernels, s->a, s->b, &s->from_other[LWI_A], s->limit, &axis->plane, PLANE_DIRECTIONS_NEW );
	if ( axis->known )
	{
		lwi_backoff_succeeded( &axis->backoff );
		return true;
	}
	lwi_backoff_failed( &axis->backoff, MAX_FAILURES, 0 );
	return false;
}

bool lwi_plane_rules_out( lwi_searching* s )
{
	lwi_cached_axis* axis = cached_axis_of( s );
	return old_plane_rules_out( s, axis ) || new_plane_rules_out( s, axis );
}

bool lwi_plane_rules_out_late( lwi_searching* s )
{
	lwi_cached_axis* axis = cached_axis_of( s );
	if ( !lwi_backoff_is_due( &axis->late_backoff ) )
	{
		return false;
	}
	lwi_plane plane = lwi_plane_between( s->a, s->b, &s->from_other[LWI_B] );
	if ( !lwi_separate( s->kernels, s->a, s->b, &s->from_other[LWI_A], s->limit, &plane, PLANE_DIRECTIONS_NEW ) )
	{
		lwi_backoff_failed( &axis->late_backoff, MAX_FAILURES, 2 ); // no wait after the first failure: it says little
		return false;
	}
	axis->plane = plane;
	axis->known = true;
	lwi_backoff_succeeded( &axis->late_backoff );
	return true;
}
