// SPDX-License-Identifier: BSD-3-Clause
// A motion that runs, and worlds that change: only changed pairs are proved again. Derivation: core/docs/guard.md.
#include "guard/guard.h"
#include "base/math_inline.h"
#include "checker/checker.h"
#include "motion/edge.h"
#include "query/query.h"

#include <string.h>

enum
{
	GUARD_COOKIE = 0x6c774764, // "lwGd"
	MOST_TRIES = 4             ///< to take hold of the newest world: as often may the writer publish another one meanwhile
};

/// A window is not halved any more below this share.
#define LEAST_SHARE 0x1p-10

lw_guard_def lw_guard_def_default( void )
{
	return (
		lw_guard_def ){ .timed = lw_timed_def_default(), .window = 1, .braking = LW_INVALID_INDEX, .cookie = GUARD_COOKIE };
}

// ---- making ----------------------------------------------------------------------------------------------------------

static lw_status check_limits( const lw_guard_def* def, lw_diag* diag )
{
	if ( !isfinite( def->end ) || !( def->window > 0 && def->window < INFINITY ) )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX,
			"end has to be finite, and window above 0: %g, %g", def->end, def->window );
	}
	if ( def->braking == LW_INVALID_INDEX )
	{
		return LW_OK;
	}
	if ( def->braking >= def->clock->track_count || def->deceleration == NULL ||
		 !( def->reaction >= 0 && def->reaction < INFINITY ) )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX,
			"braking names no track, or there are no decelerations, or reaction is %g", def->reaction );
	}
	for ( uint32_t i = 0; i < def->clock->tracks[def->braking].variable_count; ++i )
	{
		if ( !( def->deceleration[i] > 0 && def->deceleration[i] < INFINITY ) )
		{
			return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, i, "deceleration of variable %u is %g; give one above 0", i,
				def->deceleration[i] );
		}
	}
	return LW_OK;
}

/// Places the tracks behind the guard: a copy of the clock, and room for the stops. @param memory NULL: only measures
static size_t lay_out( const lw_guard_def* def, lw_guard* g )
{
	lwi_arena arena = lwi_arena_begin( g, sizeof( lw_guard ) );
	const lw_clock* clock = def->clock;
	const uint32_t count = def->checker->base->group.variable_count;
	lw_track* tracks = lwi_arena_take( &arena, clock->track_count, sizeof( lw_track ) );
	lw_track* stopping = lwi_arena_take( &arena, clock->track_count, sizeof( lw_track ) );
	double* rest = lwi_arena_take( &arena, count, sizeof( double ) );
	for ( uint32_t t = 0; t < clock->track_count; ++t )
	{
		const lw_track* from = &clock->tracks[t];
		const size_t n = from->variable_count;
		uint32_t* variables = lwi_arena_take( &arena, n, sizeof( uint32_t ) );
		double* tolerance = lwi_arena_take( &arena, n, sizeof( double ) );
		lw_timed_piece* pieces = lwi_arena_take( &arena, from->piece_count, sizeof( lw_timed_piece ) );
		if ( g != NULL )
		{
			memcpy( variables, from->variables, n * sizeof( uint32_t ) );
			memset( tolerance, 0, n * sizeof( double ) );
			memcpy( tolerance, from->tolerance != NULL ? from->tolerance : tolerance, n * sizeof( double ) );
			memcpy( pieces, from->pieces, from->piece_count * sizeof( lw_timed_piece ) );
			tracks[t] = *from;
			tracks[t].variables = variables;
			tracks[t].tolerance = tolerance;
			tracks[t].pieces = pieces;
		}
		for ( uint32_t p = 0; p < from->piece_count; ++p )
		{
			const size_t numbers = ( from->pieces[p].degree + 1 ) * n;
			double* points = lwi_arena_take( &arena, numbers, sizeof( double ) );
			if ( g != NULL )
			{
				memcpy( points, from->pieces[p].points, numbers * sizeof( double ) );
				pieces[p].points = points;
			}
		}
	}
	const lw_track* braking = def->braking != LW_INVALID_INDEX ? &clock->tracks[def->braking] : NULL;
	const size_t n = braking != NULL ? braking->variable_count : 0;
	double* deceleration = lwi_arena_take( &arena, n, sizeof( double ) );
	// all pieces, the one that is cut among them, and one more for each variable that comes to a stop
	lw_timed_piece* pieces = lwi_arena_take( &arena, n > 0 ? braking->piece_count + n + 1 : 0, sizeof( lw_timed_piece ) );
	double* cut = lwi_arena_take( &arena, ( LW_CURVE_MOST_DEGREE + 1 ) * n, sizeof( double ) );
	double* points = lwi_arena_take( &arena, n * ( 2 + 3 * n ), sizeof( double ) ); // speeds, places, quadratics
	if ( g != NULL )
	{
		memcpy( rest, clock->rest, count * sizeof( double ) );
		memcpy( deceleration, n > 0 ? def->deceleration : deceleration, n * sizeof( double ) );
		memcpy( stopping, tracks, clock->track_count * sizeof( lw_track ) );
		g->clock = ( lw_clock ){ tracks, clock->track_count, rest };
		g->stop = ( lwi_guard_stop ){ .clock = { stopping, clock->track_count, rest },
			.track = n > 0 ? &stopping[def->braking] : NULL,
			.deceleration = deceleration,
			.pieces = pieces,
			.cut = cut,
			.points = points };
	}
	return arena.used;
}

lw_status lw_guard_create( const lw_guard_def* def, const lw_allocator* allocator, lw_diag* diag, lw_guard** out_guard )
{
	if ( out_guard == NULL )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	*out_guard = NULL;
	if ( def == NULL || def->cookie != GUARD_COOKIE )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_DEF, LW_INVALID_INDEX, "make the def with lw_guard_def_default()" );
	}
	lw_status status = lw_clock_check( def->checker, def->clock, diag );
	status = status == LW_OK ? check_limits( def, diag ) : status;
	if ( status == LW_OK && !lwi_checker_is_whole( def->checker ) )
	{
		status = lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, "the checker is one of changes only" );
	}
	if ( status != LW_OK )
	{
		return status;
	}
	const lw_allocator memory = lwi_allocator_or_default( allocator );
	const size_t bytes = lay_out( def, NULL );
	lw_guard* g = lwi_alloc_zero( &memory, 1, bytes );
	if ( g == NULL )
	{
		return lwi_out_of_memory( diag, "guard" );
	}
	g->allocator = memory;
	g->bytes = bytes;
	g->def = *def;
	lay_out( def, g );
	g->worlds[0].full = lw_checker_retain( def->checker );
	g->def.checker = NULL; // of the caller's arrays only copies are used from here on
	g->def.clock = NULL;
	g->def.deceleration = NULL;
	atomic_init( &g->newest, 0 );
	atomic_init( &g->reading, LWI_NO_WORLD );
	atomic_init( &g->bound, LWI_NO_WORLD );
	atomic_init( &g->proved, LWI_NO_WORLD );
	g->work = LWI_NO_WORLD;
	g->share = 1;
	g->base_from = -INFINITY;
	lw_query_def query = lw_query_def_default();
	query.spare_shapes = def->spare_shapes;
	query.spare_bodies = def->spare_bodies;
	status = lw_query_create( &query, lw_checker_scene( def->checker ), def->checker, &memory, &g->query );
	if ( status != LW_OK )
	{
		lw_guard_destroy( g );
		return status == LW_ERROR_OUT_OF_MEMORY ? lwi_out_of_memory( diag, "guard" ) : status;
	}
	*out_guard = g;
	return LW_OK;
}

static void empty_world( lwi_world* world )
{
	lw_checker_release( world->full );
	lw_checker_release( world->changes );
	*world = ( lwi_world ){ 0 };
}

void lw_guard_destroy( lw_guard* g )
{
	if ( g == NULL )
	{
		return;
	}
	lw_query_destroy( g->query );
	for ( uint32_t i = 0; i < LWI_WORLDS; ++i )
	{
		empty_world( &g->worlds[i] );
	}
	const lw_allocator memory = g->allocator;
	lwi_free( &memory, g, g->bytes );
}

// ---- the writer ------------------------------------------------------------------------------------------------------

/// A world that the reader neither reads, nor has in its query, nor relies on.
static lwi_world* free_world( lw_guard* g )
{
	const uint32_t kept[] = { atomic_load( &g->newest ), atomic_load( &g->reading ), atomic_load( &g->bound ),
		atomic_load( &g->proved ) };
	for ( uint32_t i = 0; i < LWI_WORLDS; ++i )
	{
		if ( i != kept[0] && i != kept[1] && i != kept[2] && i != kept[3] )
		{
			return &g->worlds[i];
		}
	}
	return NULL;
}

/// May the reader's query serve a checker? Sizes of a query never change, so the writer may read them.
static bool has_room( const lw_guard* g, const lw_checker* checker )
{
	const lwi_query_sizes sizes = lwi_checker_query_sizes( checker, 0, 0 );
	return lwi_query_has_room( g->query, &sizes ) && g->query->capacity.edge_bytes >= lwi_edge_scratch_size( checker, 0 );
}

/// Does the clock move the same variables of the same robot?
static bool moves_alike( const lw_checker* a, const lw_checker* b )
{
	return lwi_robot_bare( a->base->robot ) == lwi_robot_bare( b->base->robot ) &&
		   a->base->group.variable_count == b->base->group.variable_count &&
		   memcmp( a->base->group.variables, b->base->group.variables,
			   a->base->group.variable_count * sizeof( uint32_t ) ) == 0;
}

static lw_status check_world( const lw_guard* g, const lw_checker* checker, lw_diag* diag )
{
	if ( checker == NULL || !lwi_checker_is_whole( checker ) ||
		 !moves_alike( checker, g->worlds[atomic_load( &g->newest )].full ) )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX,
			"no checker, one of changes only, or of another robot or group; edit the guard's own by lw_checker_edit()" );
	}
	if ( !has_room( g, checker ) )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX,
			"the world has more shapes or bodies than the guard has room for; raise spare_shapes or spare_bodies" );
	}
	return LW_OK;
}

/// Fills a world: the checker of all pairs, and that of the pairs that changed since the last proved world.
static lw_status fill_world( lw_guard* g, const lw_checker* checker, lwi_world* world, lw_diag* diag )
{
	world->full = lw_checker_retain( checker );
	const uint32_t base = atomic_load( &g->proved );
	return base == LWI_NO_WORLD ? LW_OK
								: lwi_checker_changes( checker, g->worlds[base].full, &g->allocator, diag, &world->changes );
}

lw_status lw_guard_publish( lw_guard* g, const lw_checker* checker, uint64_t stamp, lw_diag* diag )
{
	if ( g == NULL || stamp <= g->last_stamp ) // an older world than the last one tells nothing
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX,
			"no guard, or a stamp that is not above the last one" );
	}
	lw_status status = check_world( g, checker, diag );
	lwi_world* world = free_world( g );
	if ( status == LW_OK )
	{
		empty_world( world );
		status = fill_world( g, checker, world, diag );
	}
	if ( status != LW_OK )
	{
		empty_world( world );
		atomic_store( &g->lost, true );
		return status;
	}
	world->stamp = g->last_stamp = stamp;
	atomic_store( &g->newest, (uint32_t)( world - g->worlds ) );
	atomic_store( &g->lost, false );
	return LW_OK;
}

// ---- the reader ------------------------------------------------------------------------------------------------------

bool lwi_guard_has_clock( const lw_guard* g, double budget )
{
	return budget > 0 && ( budget == INFINITY || g->def.microseconds != NULL );
}

bool lwi_guard_begin( lw_guard* g, double budget )
{
	g->query->deadline = ( lwi_deadline ){ 0 };
	if ( budget < INFINITY )
	{
		const double now = g->def.microseconds( g->def.user );
		g->query->deadline = ( lwi_deadline ){ g->def.microseconds, g->def.user, now + budget };
	}
	bool held = false;
	for ( int i = 0; i < MOST_TRIES && !held; ++i )
	{
		const uint32_t newest = atomic_load( &g->newest );
		atomic_store( &g->reading, newest );
		held = atomic_load( &g->newest ) == newest; // else the writer may be filling it
	}
	return held && !atomic_load( &g->lost );
}

lw_guard_answer lwi_guard_no_answer( double now )
{
	return ( lw_guard_answer ){ .verdict = LW_VERDICT_UNKNOWN,
		.now = now,
		.proved_until = now,
		.time = now,
		.pair = lw_clearance_unknown() };
}

lw_status lwi_guard_prove( lw_guard* g, const lw_checker* checker, const lw_clock* clock, double from, double to,
	const lw_timed_def* def, lw_timed_result* out )
{
	const lw_status status = lw_checker_timed( checker, g->query, clock, from, to, def, out );
	atomic_store( &g->bound,
		atomic_load( &g->reading ) ); // the query let go of the one before, which the writer kept until now
	return status;
}

void lwi_guard_take( const lw_timed_result* r, lw_guard_answer* out )
{
	out->verdict = r->verdict;
	out->time = r->time;
	out->by_spread = r->by_spread;
	out->self = r->self;
	out->pair = r->pair;
}

/// Nothing is proved from a time on.
static void begin_at( lw_guard* g, double now )
{
	g->proved_from = g->proved_to = now;
	g->is_known = false;
}

/// Begins a proof, if the world is another one or the time was not proved.
static void begin_work( lw_guard* g, double now )
{
	const uint32_t held = atomic_load( &g->reading );
	const lwi_world* world = &g->worlds[held];
	if ( g->work != held || g->stamp != world->stamp || now < g->proved_from )
	{
		g->work = held;
		g->stamp = world->stamp;
		g->needs_all = world->changes == NULL || now < g->base_from;
		g->is_stuck = false;
		begin_at( g, now );
	}
	else if ( now > g->proved_to )
	{
		begin_at( g, now );
		g->is_stuck = g->is_stuck && now <= g->stuck.time;
	}
}

/// Takes the result of a window from `proved_to` to a time. One that the budget cut short decides nothing, and shows how much it suffices for.
static void take_window( lw_guard* g, double to, const lw_timed_result* r )
{
	const bool cut =
		r->verdict == LW_VERDICT_UNDECIDED && r->pair.kind == LW_CLEARANCE_UNKNOWN && lwi_query_is_late( g->query );
	if ( r->verdict == LW_VERDICT_FREE )
	{
		g->is_known = true;
		g->proved_to = to;
		g->share = lwi_smaller( 2 * g->share, 1 );
		return;
	}
	const bool gained = r->proved_until > g->proved_to;
	g->is_known = cut && ( g->is_known || gained );
	g->proved_to = lwi_larger( g->proved_to, r->proved_until );
	g->share = cut && !gained ? lwi_larger( 0.5 * g->share, LEAST_SHARE ) : g->share;
	g->is_stuck = !cut;
	g->stuck = *r;
}

/// Proves window after window, until the end, a contact, or the end of the budget.
static lw_status work_on( lw_guard* g, double end, lw_guard_answer* out )
{
	const lwi_world* world = &g->worlds[g->work];
	const lw_checker* checker = g->needs_all ? world->full : world->changes;
	lw_status status = LW_OK;
	while ( status == LW_OK && ( g->proved_to < end || !g->is_known ) && !g->is_stuck && !lwi_query_is_late( g->query ) )
	{
		const double to = lwi_smaller( g->proved_to + g->share * g->def.window, end );
		lw_timed_result r;
		status = lwi_guard_prove( g, checker, &g->clock, g->proved_to, to, &g->def.timed, &r );
		++out->windows;
		if ( status == LW_OK )
		{
			take_window( g, to, &r );
		}
	}
	return status;
}

lw_status lw_guard_ask( lw_guard* g, double now, double budget, lw_guard_answer* out )
{
	if ( out == NULL )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	*out = lwi_guard_no_answer( now );
	if ( g == NULL || !isfinite( now ) || !lwi_guard_has_clock( g, budget ) )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	if ( !lwi_guard_begin( g, budget ) )
	{
		out->verdict = LW_VERDICT_UNDECIDED;
		return LW_OK;
	}
	const double end = lwi_larger( now, g->def.end );
	begin_work( g, now );
	const lw_status status = work_on( g, end, out );
	out->stamp = g->stamp;
	if ( status != LW_OK )
	{
		return status;
	}
	out->proved_until = lwi_larger( now, g->proved_to );
	out->verdict = LW_VERDICT_UNDECIDED;
	if ( g->is_stuck )
	{
		lwi_guard_take( &g->stuck, out );
	}
	else if ( g->is_known && g->proved_to >= end )
	{
		out->verdict = LW_VERDICT_FREE;
		out->time = end;
		g->base_from = lwi_larger( g->base_from, g->proved_from );
		atomic_store( &g->proved, g->work );
	}
	return LW_OK;
}
