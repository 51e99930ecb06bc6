// SPDX-License-Identifier: BSD-3-Clause
// The inside of a guard: worlds that a writer fills, and the reader with its knowledge. guard/guard.c, guard/stop.c.
#ifndef LEEWAY_GUARD_GUARD_H
#define LEEWAY_GUARD_GUARD_H

#include "base/arena.h"
#include "leeway/guard.h"

LW_EXTERN_C_BEGIN

enum
{
	/// The newest one, that which the reader holds, that of its query, the last proved one; one to fill, and one to spare.
	LWI_WORLDS = 6,
	LWI_NO_WORLD = LW_INVALID_INDEX
};

/// A published world. Written by the writer while nobody looks at it.
typedef struct lwi_world
{
	lw_checker* full;
	lw_checker* changes; ///< NULL: nothing had been proved. Else the pairs that a proved world does not have
	uint64_t stamp;
} lwi_world;

/// The motion of a stop, and its room.
typedef struct lwi_guard_stop
{
	lw_clock clock;
	lw_track* track; ///< of it, which brakes; NULL: none
	double* deceleration;
	lw_timed_piece* pieces;
	double *cut, *points;
} lwi_guard_stop;

struct lw_guard
{
	lw_allocator allocator;
	size_t bytes;
	lw_guard_def def;
	lw_clock clock;
	lwi_guard_stop stop;
	lw_query* query; ///< of the reader; its sizes never change
	lwi_world worlds[LWI_WORLDS];
	uint64_t last_stamp;            ///< of the writer
	LWI_ATOMIC( bool ) lost;        ///< a world could not be published: nothing is known of the world. Set by the writer
	LWI_ATOMIC( uint32_t ) newest;  ///< set by the writer
	LWI_ATOMIC( uint32_t ) reading; ///< that the reader holds; set by it, as are the next two
	LWI_ATOMIC( uint32_t ) bound;   ///< whose checkers its query keeps alive
	LWI_ATOMIC( uint32_t ) proved;  ///< the last one that was proved until the end
	// of the reader
	uint32_t work;                 ///< that is being proved
	uint64_t stamp;                ///< of it
	double proved_from, proved_to; ///< seconds: free in between
	bool is_known;                 ///< a state at proved_to was proved
	bool needs_all;                ///< all pairs, not only those that changed
	double share;                  ///< of the window that is proved at a time: halved while a budget does not suffice for it
	bool is_stuck;
	lw_timed_result stuck; ///< the answer at the end of the proof
	double base_from;      ///< seconds: every world that was proved until the end was proved from here on
};

/// Asks the core about a part of a motion in the world that is held.
lw_status lwi_guard_prove( lw_guard* guard, const lw_checker* checker, const lw_clock* clock, double from, double to,
	const lw_timed_def* def, lw_timed_result* out );

/// Can the guard's clock measure the budget?
bool lwi_guard_has_clock( const lw_guard* guard, double budget );

/// Begins a question: takes hold of the newest world; the query gives up after the budget. @return false: no world is known
bool lwi_guard_begin( lw_guard* guard, double budget );

lw_guard_answer lwi_guard_no_answer( double now );

/// Fills in a verdict that is not FREE.
void lwi_guard_take( const lw_timed_result* result, lw_guard_answer* out );

LW_EXTERN_C_END

#endif
