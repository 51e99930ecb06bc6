// SPDX-License-Identifier: BSD-3-Clause
// The front of a search: the parts of it that were dropped, and how far each is at least. Another search of the same two shapes
// at a near pose takes up only those that their motion may have brought below its limit. Argument: core/docs/near.md.
#ifndef LEEWAY_DISTANCE_FRONT_H
#define LEEWAY_DISTANCE_FRONT_H

#include "base/math_inline.h"
#include "simd/tree_layout.h"

LW_EXTERN_C_BEGIN

enum
{
	LWI_FRONT_ROOM = 1024, ///< parts of one front; a search that leaves more leaves none
	LWI_FRONT_LANES = ( 1 << LWI_WIDTH ) - 1,
	LWI_FRONT_SIDE = 1 << LWI_WIDTH,  ///< the lanes are children of b's subtree, else of a's
	LWI_FRONT_WHOLE = 2 << LWI_WIDTH, ///< the pair of subtrees itself, not some of its lanes; of leaves, all but the PAIRs
	LWI_FRONT_PAIR = 4 << LWI_WIDTH ///< one triangle each of the leaves of the last WHOLE: lane of a * LWI_WIDTH + lane of b
};

/// Two subtrees (of a search with a primitive: one), and those lanes of one of them that were dropped.
typedef struct lwi_front_part
{
	uint32_t place[2]; ///< of each subtree: node * LWI_WIDTH + lane of its parent; LW_INVALID_INDEX: root
	uint32_t lanes;    ///< bits of lanes and LWI_FRONT_SIDE; or one of the other two
	float apart;       ///< metres: they were at least this far apart, less their dilations, when `moved` was 0
} lwi_front_part;

typedef struct lwi_front
{
	const lwi_front_part* old; ///< [old_count] parts of the last search
	uint32_t old_count;        ///< 0: there is none, the search begins at the roots
	lwi_front_part* parts;     ///< [LWI_FRONT_ROOM] of this search
	uint32_t count;            ///< of these; they are all of the search only if it is `whole`
	bool whole;
	double moved;  ///< metres: since the front was begun no distance of two points of the shapes changed by more
	double offset; ///< metres: added to a gap of this search gives `apart`
	double
		ahead; ///< metres: gaps that exceed the limit by less are worth a better one, so that later searches leave them out
} lwi_front;

/// The least gap of a part: NaN is none.
static inline void lwi_front_note( lwi_front* front, uint32_t part, float gap )
{
	const float apart = gap == gap ? lwi_round_down( (double)gap + front->offset ) : -INFINITY;
	front->parts[part].apart = apart < front->parts[part].apart ? apart : front->parts[part].apart;
}

/// The same of some lanes.
static inline void lwi_front_note_lanes( lwi_front* front, uint32_t part, uint32_t lanes, const float gap[LWI_WIDTH] )
{
	float least = INFINITY;
	for ( ; lanes != 0; lanes &= lanes - 1 )
	{
		const float mine = gap[lwi_lowest_bit( lanes )];
		least = mine >= least ? least : mine == mine ? mine : -INFINITY;
	}
	if ( least < INFINITY )
	{
		lwi_front_note( front, part, least );
	}
}

/// A new part of which nothing was dropped yet. Too many: the front is not whole, and the index that of another part.
static inline uint32_t lwi_front_add( lwi_front* front, uint32_t place_a, uint32_t place_b, uint32_t lanes )
{
	if ( front->count == LWI_FRONT_ROOM )
	{
		front->whole = false;
		front->count = 0;
	}
	const lwi_front_part part = { { place_a, place_b }, lanes, INFINITY };
	front->parts[front->count] = part;
	return front->count++;
}

/// Lanes of a part that were dropped.
static inline void lwi_front_drop( lwi_front* front, uint32_t part, uint32_t lanes, const float gap[LWI_WIDTH] )
{
	front->parts[part].lanes |= lanes;
	lwi_front_note_lanes( front, part, lanes, gap );
}

LW_EXTERN_C_END

#endif
