// SPDX-License-Identifier: BSD-3-Clause
// How fast the robot may go on beside people: the part of its motion until it stands, proved at the protective separation distance.
// Derivation: core/docs/guard.md.
#include "base/math_inline.h"
#include "guard/guard.h"
#include "query/query.h"

enum
{
	SEPARATION_COOKIE = 0x6c775370, // "lwSp"
	MOST_GRID = 1024
};

lw_separation lw_separation_default( void )
{
	return ( lw_separation ){ .speed = 1.6, .deceleration = 1, .grid = 64, .cookie = SEPARATION_COOKIE };
}

static bool is_distance( double x )
{
	return x >= 0 && x < INFINITY;
}

static bool is_valid( const lw_guard* g, const lw_separation* def, double now, double age, double highest )
{
	bool valid = is_distance( def->speed ) && is_distance( def->intrusion ) && is_distance( def->reaction ) &&
				 is_distance( age ) && isfinite( now ) && def->deceleration > 0 && def->deceleration < INFINITY &&
				 highest > 0 && highest < INFINITY && def->grid >= 1 && def->grid <= MOST_GRID;
	for ( uint32_t i = 0; i < g->clock.track_count; ++i )
	{
		valid = valid && g->clock.tracks[i].spread_speed == 0;
	}
	return valid;
}

/// Rounds up, by more than the operations before can have lost.
static double up( double x )
{
	return x + 8 * LWI_U64 * fabs( x );
}

/// Proves the motion until it stands, if it goes on at a scale.
static lw_status try_scale( lw_guard* g, const lw_checker* people, const lw_separation* def, double now, double age,
	double scale, lw_guard_scale* out )
{
	const double braking = up( scale / def->deceleration );
	const double until = up( now + up( scale * def->reaction + 0.5 * scale * braking ) );
	lw_timed_def timed = g->def.timed;
	timed.edge.min_d = up( def->intrusion + def->speed * up( def->reaction + braking + age ) );
	timed.edge.flags = LW_CHECK_ENVIRONMENT;
	timed.contact_resolution = 0;
	lw_timed_result r;
	const lw_status status = lwi_guard_prove( g, people, &g->clock, now, until, &timed, &r );
	++out->proofs;
	if ( status == LW_OK && r.verdict == LW_VERDICT_FREE )
	{
		out->scale = scale;
		out->separation = timed.edge.min_d;
		out->until = until;
	}
	else if ( status == LW_OK )
	{
		out->next = r;
	}
	return status;
}

lw_status lw_guard_speed( lw_guard* g, const lw_separation* def, double now, double age, double highest, double budget,
	lw_guard_scale* out )
{
	if ( out == NULL )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	*out = ( lw_guard_scale ){ .separation = NAN,
		.until = now,
		.next = { .verdict = LW_VERDICT_UNKNOWN, .pair = lw_clearance_unknown() } };
	if ( def == NULL || def->cookie != SEPARATION_COOKIE )
	{
		return LW_ERROR_INVALID_DEF;
	}
	if ( g == NULL || !lwi_guard_has_clock( g, budget ) || !is_valid( g, def, now, age, highest ) )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	if ( !lwi_guard_begin( g, budget ) )
	{
		out->next.verdict = LW_VERDICT_UNDECIDED;
		return LW_OK;
	}
	const lwi_world* world = &g->worlds[atomic_load( &g->reading )];
	out->stamp = world->stamp;
	// scales of the grid: that of `proved` is proved, or 0; that of `open` is not, or beyond the highest
	uint32_t proved = 0, open = def->grid + 1, k = def->grid;
	while ( open - proved > 1 && !lwi_query_is_late( g->query ) )
	{
		const double scale = k == def->grid ? highest : highest * k / def->grid;
		const lw_status status = try_scale( g, world->full, def, now, age, scale, out );
		if ( status != LW_OK )
		{
			out->scale = 0;
			return status;
		}
		proved = out->scale == scale ? k : proved;
		open = out->scale == scale ? open : k;
		k = ( proved + open ) / 2;
	}
	return LW_OK;
}
