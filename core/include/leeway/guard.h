// SPDX-License-Identifier: BSD-3-Clause
// While it drives: is the rest of a motion still proved, now that the scene has changed, and is there a proved stop?
#ifndef LEEWAY_GUARD_H
#define LEEWAY_GUARD_H

#include "leeway/clock.h"

LW_EXTERN_C_BEGIN

/// Guards one motion of a checker's robot. Two threads: a writer publishes worlds, a reader asks in its cycle. Calls of the reader
/// (lw_guard_ask, lw_guard_stop, lw_guard_brake_by) allocate nothing, take no lock and free nothing; those of the writer may.
/// Derivation: core/docs/guard.md.
typedef struct lw_guard lw_guard;

typedef struct lw_guard_def
{
	const lw_checker* checker; ///< with the scene at the start; a reference is taken
	const lw_clock* clock;     ///< as lw_clock_check() accepts it; copied, with all its arrays
	double end;                ///< seconds: the motion is guarded until then
	lw_timed_def timed;        ///< of all proofs. contact_resolution: of the first contact
	double window;             ///< seconds, > 0: proved at a time; less where a budget does not suffice
	/// The track that brakes; LW_INVALID_INDEX: none, lw_guard_stop() is then an error.
	uint32_t braking;
	const double* deceleration; ///< [variable_count of that track] radians and metres per squared second, > 0; copied
	double reaction;            ///< seconds, >= 0: from the order to stop until the robot begins to brake
	uint32_t spare_shapes;      ///< scenes may have so many shapes more than that of the checker
	uint32_t spare_bodies;      ///< robots so many bodies of attached objects more than its robot
	/// Microseconds of a clock that never goes back, for budgets; called on the reader's thread. NULL: budgets must be infinite.
	double ( *microseconds )( void* user );
	void* user;
	uint32_t cookie;
} lw_guard_def;

LW_API lw_guard_def lw_guard_def_default( void );

/// @return LW_OK, LW_ERROR_INVALID_DEF, LW_ERROR_INVALID_ARGUMENT (diag names it), LW_ERROR_OUT_OF_MEMORY
LW_API lw_status lw_guard_create( const lw_guard_def* def, const lw_allocator* allocator, lw_diag* diag,
	lw_guard** out_guard );
LW_API void lw_guard_destroy( lw_guard* guard ); ///< NULL is ignored; no call may be under way

/// Writer: the world has changed. From the return on no answer is about an earlier one.
///
/// @param checker of the world as it is now, by lw_checker_edit() from the one before: other objects, attached objects, allowed contacts and
/// margins; not `only_changes`. A reference is taken, and given back on the writer's thread
/// @param stamp of the writer, such as the time at which the world was seen; above that of the one before
/// @return LW_OK, LW_ERROR_INVALID_ARGUMENT (another robot or group; more shapes than spare_shapes), LW_ERROR_OUT_OF_MEMORY: nothing is
/// published, the answers are UNDECIDED until another world is. A stamp that is not above the last one is an LW_ERROR_INVALID_ARGUMENT that changes
/// nothing: the answers are about the newer world
/// Cost: one lw_checker_edit().
LW_API lw_status lw_guard_publish( lw_guard* guard, const lw_checker* checker, uint64_t stamp, lw_diag* diag );

/// An answer about one world, the newest that had been published when the call began.
typedef struct lw_guard_answer
{
	/// FREE: no clearance is at most min_d from `now` to the end, for all motions that the clock allows: proved.
	/// BLOCKED, UNDECIDED: as of lw_timed_result, at `time`; UNDECIDED with `pair` UNKNOWN: the budget has ended before the proof: ask again,
	/// and brake if proved_until comes too near.
	/// UNKNOWN: an error; nothing is claimed.
	lw_verdict verdict;
	uint64_t stamp;      ///< of the world; 0: that of the def
	double now;          ///< seconds, of the question
	double proved_until; ///< seconds, >= now: FREE's claim holds from now to here; now if nothing is proved
	double time;         ///< seconds: of the contact or the undecided verdict; the end if FREE
	bool by_spread, self;
	lw_clearance pair; ///< at `time`
	uint32_t windows;  ///< proved or tried in this call
} lw_guard_answer;

/// Reader: is the motion still free from now on? Proofs stay known: a call about the same world costs nothing, one after
/// a change proves the pairs that changed.
/// @param now seconds on the clock, finite. Earlier than in the call before: all is proved again
/// @param budget microseconds, > 0; INFINITY: until all is known. The answer comes as late as one step of the search takes: poses, or the pairs of a
/// window once (core/docs/guard.md)
/// @return LW_OK, LW_ERROR_INVALID_ARGUMENT (also: a budget without a clock), or that of lw_checker_timed(): verdict UNKNOWN
LW_API lw_status lw_guard_ask( lw_guard* guard, double now, double budget, lw_guard_answer* out );

/// Reader: is it free to be told to stop at `from`? The braking track goes on until from + reaction; then each variable decelerates by itself.
/// All other tracks move on. Proved from `from` until it stands, in the newest world, all pairs.
/// @param out time: FREE: when it stands
/// @param budget as for lw_guard_ask(): UNDECIDED with `pair` UNKNOWN after it
/// @return as lw_guard_ask(); LW_ERROR_INVALID_ARGUMENT also without a braking track
LW_API lw_status lw_guard_stop( lw_guard* guard, double from, double budget, lw_guard_answer* out );

/// Reader: until when may the order to stop wait? The latest of the times now + k * step, up to `until`, at which the motion is still
/// proved and a stop is proved. Call it after lw_guard_ask(), with its proved_until.
/// @param budget as for lw_guard_ask(), of all stops
/// @param out_time seconds; NaN: no stop is proved, not even now, or the budget has ended before one was: brake
/// Cost: one lw_guard_stop() for each of these times, from the last one backwards.
LW_API lw_status lw_guard_brake_by( lw_guard* guard, double now, double until, double step, double budget,
	double* out_time );

/// Speed and separation: the robot slows down before people come too near (ISO/TS 15066:2016, 5.5.4; ISO 13855:2010).
typedef struct lw_separation
{
	double
		speed; ///< metres per second, >= 0: no point of an object of the scene is faster. 1.6; 2 for hands and arms (K, v_h)
	double intrusion; ///< metres, >= 0: kept at all times; of reach and of the errors of sensor and robot (C + Z_d + Z_r)
	double
		reaction; ///< seconds, >= 0: from `now` until the robot begins to brake, the time until the next call included (T_r)
	double deceleration; ///< per second, > 0: the scale falls at least as fast when the robot brakes on its tracks; 1
	uint32_t grid;       ///< 1 to 1,024: scales are multiples of highest / grid; 64
	uint32_t cookie;
} lw_separation;

LW_API lw_separation lw_separation_default( void );

typedef struct lw_guard_scale
{
	double scale; ///< 0: none is proved, brake; else proved
	double
		separation; ///< metres: exceeded by all clearances of bodies and objects from now until `until`; NaN without a scale
	double until;   ///< seconds on the clock: no farther the robot comes before it stands
	uint64_t stamp; ///< of the scene
	lw_timed_result next; ///< of the least scale that was tried and not proved: which pair decides, and where. UNKNOWN: none
	uint32_t proofs;
} lw_guard_scale;

/// Reader: how fast may the robot go on? All tracks go on along the same path at the same scale of their speeds, of which 1 is that of the clock. If
/// from `now` on the scale is at most out->scale, and falls from now + reaction on until the robot stands, no object of the scene comes as near
/// as `intrusion` until it stands, however the objects move with at most `speed`. Give people a guard of their own: all objects count.
/// In a cycle of at most `reaction`: go on at the answered scale; if the robot is faster, brake until an answer allows the scale that it has.
/// @param now seconds on the clock: where the robot is
/// @param age seconds, >= 0, since the scene was seen; so long ago the objects were at their places
/// @param highest > 0: no larger scale is tried
/// @param budget as for lw_guard_ask(): after it the largest scale that was proved until then
/// @return as lw_guard_ask(); LW_ERROR_INVALID_ARGUMENT also if a track spreads. On an error the scale is 0
/// Cost: up to 1 + log2( grid ) proofs of the part of the motion until it stands. Derivation: core/docs/guard.md.
LW_API lw_status lw_guard_speed( lw_guard* guard, const lw_separation* def, double now, double age, double highest,
	double budget, lw_guard_scale* out );

LW_EXTERN_C_END

#endif
