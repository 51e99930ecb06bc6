// SPDX-License-Identifier: BSD-3-Clause
// Checkers by snapshots: what an edited scene, or a robot with an object in its hand, shares with what was before.
//
// A checker made after another one is what it would be if it were made from nothing: whatever is taken over was computed from
// the same bits. Design and costs: core/docs/edits.md.
#include "checker_edit.h"

#include "checker_base.h"
#include "math_inline.h"
#include "scene_internal.h"

#include <string.h>

// --- what is the same ------------------------------------------------------------------------------------------------

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
	uint32_t next = 0; // edits keep the order of what stays
	for ( uint32_t i = 0; scene != NULL && i < scene->shape_count; ++i )
	{
		source[i] = LW_INVALID_INDEX;
		uint32_t at = next;
		while ( previous != NULL && at < previous->shape_count && !same_object( previous, at, scene, i ) )
		{
			++at; // removed, or else this one is new: then the next starts where this one did
		}
		if ( previous != NULL && at < previous->shape_count )
		{
			source[i] = same_shape( &previous->shapes[at], &scene->shapes[i] ) ? at : LW_INVALID_INDEX;
			next = at + 1;
		}
	}
}

// --- the static environment ------------------------------------------------------------------------------------------

/// The bodies that stand still are the same, in the same order.
static bool same_static_bodies( const lw_checker* x, const lw_checker* y )
{
	if ( x->base == y->base )
	{
		return true;
	}
	uint32_t count = x->tree->nodes[0].body_count;
	bool same = count == y->tree->nodes[0].body_count;
	for ( uint32_t i = 0; same && i < count; ++i )
	{
		const lwi_checker_body* a = &x->bodies[x->tree->bodies[i]];
		const lwi_checker_body* b = &y->bodies[y->tree->bodies[i]];
		same = a->shape == b->shape && a->link == b->link &&
			memcmp( &a->link_from_shape, &b->link_from_shape, sizeof( lw_transform ) ) == 0 &&
			memcmp( &x->reference_poses[a->link], &y->reference_poses[b->link], sizeof( lw_transform ) ) == 0;
	}
	return same;
}

static bool is_checked( const lw_checker* c, uint32_t body, uint32_t shape )
{
	return ( c->environment_mask[(size_t)body * c->scene_block_count + shape / LWI_WIDTH] >> ( shape % LWI_WIDTH ) & 1 ) != 0;
}

static double margin_of( const lw_checker* c, uint32_t body, uint32_t shape )
{
	return lwi_environment_margin( c, body, c->scene->shapes[shape].object );
}

/// True if a shape is to be measured against a static body: it was not before, or with another margin, and may be nearer than
/// what is known.
static bool may_be_nearer( const lw_checker* c, const lw_checker* old, uint32_t place, uint32_t shape, uint32_t source )
{
	uint32_t body = c->tree->bodies[place], before = old->tree->bodies[place];
	double margin = margin_of( c, body, shape );
	if ( !is_checked( c, body, shape ) ||
		 ( source != LW_INVALID_INDEX && is_checked( old, before, source ) && margin_of( old, before, source ) == margin ) )
	{
		return false;
	}
	const lwi_checker_body* b = &c->bodies[body];
	lw_transform world_from_body = lwi_multiply( &c->reference_poses[b->link], &b->link_from_shape );
	lw_transform relative = lwi_relative( &world_from_body, &c->scene->shapes[shape].world_from_shape );
	return lwi_box_gap( b->shape, c->scene->shapes[shape].shape, &relative ) - margin < c->static_environment.upper;
}

bool lwi_keep_static( lw_checker* c, const lwi_kept* kept, uint8_t* fresh )
{
	const lw_checker* old = kept->previous;
	if ( old == NULL || !same_static_bodies( c, old ) )
	{
		return false;
	}
	const uint32_t shapes = c->scene->shape_count, count = c->tree->nodes[0].body_count;
	if ( old->static_shape != LW_INVALID_INDEX )
	{
		uint32_t place = old->tree->body_place[old->static_body], body = c->tree->bodies[place], found = LW_INVALID_INDEX;
		for ( uint32_t i = 0; i < shapes; ++i )
		{
			bool same = kept->source[i] == old->static_shape && is_checked( c, body, i ) &&
						margin_of( c, body, i ) == margin_of( old, old->static_body, old->static_shape );
			found = same ? i : found;
		}
		if ( found == LW_INVALID_INDEX )
		{
			return false; // the nearest one is gone
		}
		c->static_environment = old->static_environment;
		c->static_environment.lower = fmax( c->static_environment.lower, lwi_lowest_environment( c ) );
		c->static_environment.b = c->scene->shapes[found].object;
		c->static_body = body;
		c->static_shape = found;
	}
	for ( uint32_t shape = 0; shape < shapes; ++shape )
	{
		for ( uint32_t place = 0; place < count; ++place )
		{
			if ( may_be_nearer( c, old, place, shape, kept->source[shape] ) )
			{
				fresh[shape / LWI_WIDTH] = (uint8_t)( fresh[shape / LWI_WIDTH] | ( 1u << ( shape % LWI_WIDTH ) ) );
				break;
			}
		}
	}
	return true;
}
