// SPDX-License-Identifier: BSD-3-Clause
// The parts of an earlier checker that a new one takes over: shapes that did not change, and the static environment.
//
// A checker made after another one equals one made from nothing: every part taken over was computed from
// the same bits. Design and costs: core/docs/edits.md.
#include "checker/reuse.h"

#include "checker/base.h"
#include "base/math_inline.h"
#include "scene/scene.h"

#include <string.h>

enum
{
	MOST_LOOKS = 1 << 20 ///< at shapes of one object: a few milliseconds. Beyond, shapes that stayed count as changed
};

// --- equal parts -----------------------------------------------------------------------------------------------------

static bool same_shape( const lw_scene_shape_def* x, const lw_scene_shape_def* y )
{
	return x->shape == y->shape && memcmp( &x->world_from_shape, &y->world_from_shape, sizeof( lw_transform ) ) == 0;
}

/// Edited scenes share the names they have in common.
static bool same_object( const lw_scene* x, uint32_t i, const lw_scene* y, uint32_t k )
{
	const char* name = x->object_names[x->shapes[i].object];
	const char* other = y->object_names[y->shapes[k].object];
	return name == other || strcmp( name, other ) == 0;
}

void lwi_match_scenes( const lw_scene* previous, const lw_scene* scene, uint32_t* source )
{
	uint32_t next = 0; // edits keep the order of the shapes that stay
	uint32_t looks = MOST_LOOKS;
	const uint32_t count = previous != NULL ? previous->shape_count : 0;
	for ( uint32_t i = 0; scene != NULL && i < scene->shape_count; ++i )
	{
		source[i] = LW_INVALID_INDEX;
		uint32_t at = next;
		while ( at < count && !same_object( previous, at, scene, i ) )
		{
			++at; // removed, or else this one is new: then the next starts where this one did
		}
		// of an object with many shapes some may have come, gone or changed, as in a live cloud
		const uint32_t object = at < count ? previous->shapes[at].object : 0;
		while ( looks > 0 && at < count && previous->shapes[at].object == object &&
				!same_shape( &previous->shapes[at], &scene->shapes[i] ) )
		{
			++at;
			--looks;
		}
		if ( at < count && same_object( previous, at, scene, i ) && same_shape( &previous->shapes[at], &scene->shapes[i] ) )
		{
			source[i] = at;
			next = at + 1;
		}
	}
}

// --- the static environment ------------------------------------------------------------------------------------------

/// True if the static bodies are the same, in the same order.
static bool same_static_bodies( const lw_checker* x, const lw_checker* y )
{
	if ( x->base == y->base )
	{
		return true;
	}
	uint32_t count = x->base->tree->clusters[0].body_count;
	bool same = count == y->base->tree->clusters[0].body_count;
	for ( uint32_t i = 0; same && i < count; ++i )
	{
		const lwi_checker_body* a = &x->base->bodies[x->base->tree->bodies[i]];
		const lwi_checker_body* b = &y->base->bodies[y->base->tree->bodies[i]];
		same = a->shape == b->shape && a->link == b->link &&
			   memcmp( &a->link_from_shape, &b->link_from_shape, sizeof( lw_transform ) ) == 0 &&
			   memcmp( &x->base->group.reference_poses[a->link], &y->base->group.reference_poses[b->link],
				   sizeof( lw_transform ) ) == 0;
	}
	return same;
}

static bool is_checked( const lw_checker* c, uint32_t body, uint32_t shape )
{
	return ( c->environment.mask[(size_t)body * c->environment.block_count + shape / LWI_WIDTH] >> ( shape % LWI_WIDTH ) &
			   1 ) != 0;
}

static double margin_of( const lw_checker* c, uint32_t body, uint32_t shape )
{
	return lwi_environment_margin( c, body, c->scene->shapes[shape].object );
}

/// True if a shape is to be measured against a static body: it was not before, or with another margin, and may be nearer
/// than the known static clearance.
static bool may_be_nearer( const lw_checker* c, const lw_checker* old, uint32_t place, uint32_t shape, uint32_t source )
{
	uint32_t body = c->base->tree->bodies[place], before = old->base->tree->bodies[place];
	double margin = margin_of( c, body, shape );
	if ( !is_checked( c, body, shape ) ||
		 ( source != LW_INVALID_INDEX && is_checked( old, before, source ) && margin_of( old, before, source ) == margin ) )
	{
		return false;
	}
	const lwi_checker_body* b = &c->base->bodies[body];
	lw_transform world_from_body = lwi_multiply( &c->base->group.reference_poses[b->link], &b->link_from_shape );
	lw_transform relative = lwi_relative( &world_from_body, &c->scene->shapes[shape].world_from_shape );
	return lwi_box_gap( b->shape, c->scene->shapes[shape].shape, &relative ) - margin < c->nearest_static.clearance.upper;
}

bool lwi_reuse_static( lw_checker* c, const lwi_reuse* reuse, uint8_t* fresh )
{
	const lw_checker* old = reuse->previous;
	// a violation comes from the first pair found, and others may exist: its measurement cannot be continued
	if ( old == NULL || old->nearest_static.clearance.kind == LW_CLEARANCE_VIOLATION || !same_static_bodies( c, old ) )
	{
		return false;
	}
	const uint32_t shapes = c->scene->shape_count, count = c->base->tree->clusters[0].body_count;
	if ( old->nearest_static.shape != LW_INVALID_INDEX )
	{
		uint32_t place = old->base->tree->body_place[old->nearest_static.body], body = c->base->tree->bodies[place],
				 found = LW_INVALID_INDEX;
		for ( uint32_t i = 0; i < shapes; ++i )
		{
			bool same = reuse->source[i] == old->nearest_static.shape && is_checked( c, body, i ) &&
						margin_of( c, body, i ) == margin_of( old, old->nearest_static.body, old->nearest_static.shape );
			found = same ? i : found;
		}
		if ( found == LW_INVALID_INDEX )
		{
			return false; // the nearest one is gone
		}
		c->nearest_static.clearance = old->nearest_static.clearance;
		c->nearest_static.clearance.lower = fmax( c->nearest_static.clearance.lower, lwi_lowest_environment( c ) );
		c->nearest_static.clearance.b = c->scene->shapes[found].object;
		c->nearest_static.body = body;
		c->nearest_static.shape = found;
	}
	for ( uint32_t shape = 0; shape < shapes; ++shape )
	{
		for ( uint32_t place = 0; place < count; ++place )
		{
			if ( may_be_nearer( c, old, place, shape, reuse->source[shape] ) )
			{
				fresh[shape / LWI_WIDTH] = (uint8_t)( fresh[shape / LWI_WIDTH] | ( 1u << ( shape % LWI_WIDTH ) ) );
				break;
			}
		}
	}
	return true;
}
