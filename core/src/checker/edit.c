// SPDX-License-Identifier: BSD-3-Clause
// lw_checker_edit(): the def of an edited checker, from the checker before it and the differences. Margins and allowed
// contacts go by name to the links and objects of the new robot and scene. Design and costs: core/docs/edits.md.
#include "checker/checker.h"
#include "base/math_inline.h"
#include "scene/scene.h"

#include <string.h>

enum
{
	EDIT_COOKIE = 0x4c574345
};

lw_checker_edit_def lw_checker_edit_def_default( void )
{
	lw_checker_edit_def def;
	memset( &def, 0, sizeof( def ) );
	def.max_d = NAN;
	def.cookie = EDIT_COOKIE;
	return def;
}

static lw_status check_edit( const lw_checker* c, const lw_checker_edit_def* def, lw_diag* diag )
{
	if ( c == NULL )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, "the checker to edit is NULL" );
	}
	if ( def == NULL || def->cookie != EDIT_COOKIE )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_DEF, LW_INVALID_INDEX,
			"checker edit def was not made by lw_checker_edit_def_default()" );
	}
	if ( def->allowed_count > 0 && def->allowed == NULL )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX,
			"checker edit def: allowed is NULL, its count is not 0" );
	}
	if ( def->robot != NULL && lwi_robot_bare( def->robot ) != lwi_robot_bare( c->base->robot ) )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX,
			"checker edit def: robot '%.60s' was not made from this checker's by lw_robot_attach() or lw_robot_detach(); create a "
			"checker for it",
			lw_robot_name( def->robot ) );
	}
	return LW_OK;
}

/// New places of the links and objects of the edited checker, LW_INVALID_INDEX for removed ones, and the arrays of their
/// defs.
typedef struct carried
{
	lw_allocator allocator;
	uint32_t old_links, old_objects, links, objects; ///< counts
	uint32_t *link, *object;                         ///< [old_links], [old_objects]
	uint32_t allowed_room, environment_room, self_room;
	lw_link_object_pair* allowed;
	double *link_environment, *link_self, *object_margin;
	lw_pair_margin *environment_pairs, *self_pairs;
} carried;

static bool carried_create( carried* k, const lw_checker* c, const lw_checker_def* next, uint32_t more_allowed )
{
	const uint64_t allowed = (uint64_t)c->allowed_count + more_allowed;
	k->old_links = lw_robot_link_count( c->base->robot );
	k->old_objects = c->scene != NULL ? c->scene->object_count : 0;
	k->links = lw_robot_link_count( next->robot );
	k->objects = next->scene != NULL ? next->scene->object_count : 0;
	k->allowed_room = allowed < UINT32_MAX ? (uint32_t)allowed : 0;
	k->environment_room = c->margins != NULL ? c->margins->listed.count : 0;
	k->self_room = c->base->self.margins != NULL ? c->base->self.margins->listed.count : 0;
	k->link = lwi_alloc_zero( &k->allocator, k->old_links, sizeof( uint32_t ) );
	k->object = lwi_alloc_zero( &k->allocator, k->old_objects, sizeof( uint32_t ) );
	k->allowed = lwi_alloc_zero( &k->allocator, k->allowed_room, sizeof( lw_link_object_pair ) );
	k->link_environment = lwi_alloc_zero( &k->allocator, k->links, sizeof( double ) );
	k->link_self = lwi_alloc_zero( &k->allocator, k->links, sizeof( double ) );
	k->object_margin = lwi_alloc_zero( &k->allocator, k->objects, sizeof( double ) );
	k->environment_pairs = lwi_alloc_zero( &k->allocator, k->environment_room, sizeof( lw_pair_margin ) );
	k->self_pairs = lwi_alloc_zero( &k->allocator, k->self_room, sizeof( lw_pair_margin ) );
	return allowed < UINT32_MAX && k->link != NULL && k->object != NULL && k->allowed != NULL &&
		   k->link_environment != NULL && k->link_self != NULL && k->object_margin != NULL && k->environment_pairs != NULL &&
		   k->self_pairs != NULL;
}

static void carried_destroy( carried* k )
{
	lwi_free( &k->allocator, k->link, k->old_links * sizeof( uint32_t ) );
	lwi_free( &k->allocator, k->object, k->old_objects * sizeof( uint32_t ) );
	lwi_free( &k->allocator, k->allowed, k->allowed_room * sizeof( lw_link_object_pair ) );
	lwi_free( &k->allocator, k->link_environment, k->links * sizeof( double ) );
	lwi_free( &k->allocator, k->link_self, k->links * sizeof( double ) );
	lwi_free( &k->allocator, k->object_margin, k->objects * sizeof( double ) );
	lwi_free( &k->allocator, k->environment_pairs, k->environment_room * sizeof( lw_pair_margin ) );
	lwi_free( &k->allocator, k->self_pairs, k->self_room * sizeof( lw_pair_margin ) );
}

/// Links of the bare robot keep their indices; attached links, and objects, are found by name.
static void locate( carried* k, const lw_checker* c, const lw_checker_def* next )
{
	for ( uint32_t i = 0; i < k->old_links; ++i )
	{
		bool stays = next->robot == c->base->robot || !lw_robot_is_attached( c->base->robot, i );
		k->link[i] = stays ? i : lw_robot_find_link( next->robot, c->base->robot->link_names[i] );
	}
	for ( uint32_t i = 0; i < k->old_objects; ++i )
	{
		// mostly where it was, or as many places ahead as were removed before it
		const char* name = c->scene->object_names[i];
		uint32_t guess = i == 0 ? 0 : k->object[i - 1] != LW_INVALID_INDEX ? k->object[i - 1] + 1 : i;
		bool found = guess < k->objects && next->scene->object_names[guess] == name;
		k->object[i] = found ? guess : lw_scene_find_object( next->scene, name );
	}
}

/// Allowed pairs stay allowed.
static void carry_allowed( carried* k, const lw_checker* c, lw_checker_def* next )
{
	for ( uint32_t i = 0; i < c->allowed_count; ++i )
	{
		lw_link_object_pair pair = { k->link[c->allowed[i].link], k->object[c->allowed[i].object] };
		if ( pair.link != LW_INVALID_INDEX && pair.object != LW_INVALID_INDEX )
		{
			k->allowed[next->allowed_count++] = pair;
		}
	}
}

/// Values by their new indices.
static void carry_values( const double* values, const uint32_t* where, uint32_t count, double* out )
{
	for ( uint32_t i = 0; i < count; ++i )
	{
		if ( where[i] != LW_INVALID_INDEX )
		{
			out[where[i]] = values[i];
		}
	}
}

/// Returns how many of the pairs are still there.
static uint32_t carry_pairs( const lwi_listed_margins* listed, const uint32_t* where_a, const uint32_t* where_b,
	lw_pair_margin* out )
{
	uint32_t count = 0;
	for ( uint32_t i = 0; i < listed->count; ++i )
	{
		const lw_pair_margin* pair = &listed->pairs[i];
		if ( where_a[pair->a] != LW_INVALID_INDEX && where_b[pair->b] != LW_INVALID_INDEX )
		{
			out[count++] = ( lw_pair_margin ){ where_a[pair->a], where_b[pair->b], pair->margin };
		}
	}
	return count;
}

static void carry_margins( carried* k, const lw_checker* c, lw_margins* out )
{
	if ( c->margins != NULL )
	{
		out->environment = c->margins->all;
		carry_values( c->margins->link, k->link, k->old_links, k->link_environment );
		carry_values( c->margins->object, k->object, k->old_objects, k->object_margin );
		out->link_environment = k->link_environment;
		out->object = k->object_margin;
		out->environment_pairs = k->environment_pairs;
		out->environment_pair_count = carry_pairs( &c->margins->listed, k->link, k->object, k->environment_pairs );
	}
	if ( c->base->self.margins != NULL )
	{
		out->self = c->base->self.margins->all;
		carry_values( c->base->self.margins->link, k->link, k->old_links, k->link_self );
		out->link_self = k->link_self;
		out->self_pairs = k->self_pairs;
		out->self_pair_count = carry_pairs( &c->base->self.margins->listed, k->link, k->link, k->self_pairs );
	}
}

/// An edited checker. @param def as lw_checker_edit() accepts it @param previous as of lw_checker_def
static lw_status edit( const lw_checker* c, const lw_checker_edit_def* def, const lw_checker* previous,
	const lw_allocator* allocator_in, lw_diag* diag, lw_checker** out_checker )
{
	lw_checker_def next = lw_checker_def_default();
	next.robot = def->robot != NULL ? def->robot : c->base->robot;
	next.scene = def->scene != NULL ? def->scene : c->scene;
	next.variables = c->base->group.variables;
	next.variable_count = c->base->group.variable_count;
	next.reference = c->base->group.reference;
	next.reach = c->base->reach;
	next.max_d = isnan( def->max_d ) ? c->max_d : def->max_d;
	next.previous = previous;
	next.only_changes = def->only_changes;
	carried kept = { .allocator = lwi_allocator_or_default( allocator_in ) };
	if ( !carried_create( &kept, c, &next, def->allowed_count ) )
	{
		carried_destroy( &kept );
		return lwi_out_of_memory( diag, "a checker" );
	}
	locate( &kept, c, &next );
	if ( !def->replace_allowed )
	{
		carry_allowed( &kept, c, &next );
	}
	for ( uint32_t i = 0; i < def->allowed_count; ++i )
	{
		kept.allowed[next.allowed_count++] = def->allowed[i];
	}
	next.allowed = kept.allowed;
	if ( def->margins != NULL )
	{
		next.margins = *def->margins;
	}
	else
	{
		carry_margins( &kept, c, &next.margins );
	}
	const lw_status status = lw_checker_create( &next, &kept.allocator, diag, out_checker );
	carried_destroy( &kept );
	return status;
}

lw_status lw_checker_edit( const lw_checker* c, const lw_checker_edit_def* def, const lw_allocator* allocator, lw_diag* diag,
	lw_checker** out_checker )
{
	if ( out_checker == NULL )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, "out_checker is NULL" );
	}
	*out_checker = NULL;
	const lw_status status = check_edit( c, def, diag );
	return status == LW_OK ? edit( c, def, c, allocator, diag, out_checker ) : status;
}

lw_status lwi_checker_changes( const lw_checker* now, const lw_checker* since, const lw_allocator* allocator, lw_diag* diag,
	lw_checker** out_checker )
{
	lw_checker_edit_def def = lw_checker_edit_def_default();
	def.only_changes = true;
	*out_checker = NULL;
	return edit( now, &def, since, allocator, diag, out_checker );
}

bool lwi_checker_is_whole( const lw_checker* c )
{
	return !c->self_unchanged && !c->base->only_changes;
}
