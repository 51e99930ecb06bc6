// SPDX-License-Identifier: BSD-3-Clause
// Scenes by snapshots: a scene with some of its objects added, removed or moved, sharing shapes and names with the one
// before.
//
// Objects that stay keep their order, added ones come last: the scene equals the one that lw_scene_create() makes of the
// same list. Boxes in the world are computed for shapes that were added or moved; the others' are copied. Costs:
// core/docs/edits.md.
#include "base/math_inline.h"
#include "scene/scene.h"

#include <string.h>

/// An object on the way; its shapes are those that name it.
typedef struct draft_object
{
	const char* name; ///< the old scene's, or the change's
	bool shared;      ///< it is the old scene's
	bool removed;
	uint32_t index; ///< in the new scene
} draft_object;

typedef struct draft_shape
{
	lw_scene_shape_def def; ///< object = index into the draft's
	uint32_t source;        ///< the old scene's shape of the same pose, or LW_INVALID_INDEX
} draft_shape;

typedef struct draft
{
	const lw_scene* scene;
	uint32_t object_count, shape_count, object_capacity, shape_capacity;
	draft_object* objects;
	draft_shape* shapes;
} draft;

/// The object of this name in the draft. @return its index; LW_INVALID_INDEX with a message if there is none, or
/// several
static uint32_t find( const draft* d, const lw_scene_change* change, uint32_t at, lw_diag* diag )
{
	uint32_t found = LW_INVALID_INDEX;
	for ( uint32_t i = 0; i < d->object_count; ++i )
	{
		const draft_object* object = &d->objects[i];
		if ( object->removed || strcmp( object->name, change->object ) != 0 )
		{
			continue;
		}
		if ( found != LW_INVALID_INDEX )
		{
			lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, at, "scene change %u: two objects are named '%.80s': rename one", at,
				change->object );
			return LW_INVALID_INDEX;
		}
		found = i;
	}
	if ( found == LW_INVALID_INDEX )
	{
		lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, at, "scene change %u: there is no object '%.80s'; add it first", at,
			change->object );
	}
	return found;
}

static lw_status check_poses( const lw_scene_change* change, uint32_t at, lw_diag* diag )
{
	for ( uint32_t i = 0; i < change->shape_count; ++i )
	{
		if ( !lw_transform_is_valid( &change->world_from_shape[i] ) )
		{
			return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, at,
				"scene change %u: object '%.80s': the pose of its shape %u is not finite or not a rotation, or beyond 1e15 m; normalise its quaternion, give metres",
				at, change->object, i );
		}
	}
	return LW_OK;
}

static lw_status check_change( const lw_scene_change* change, uint32_t at, lw_diag* diag )
{
	if ( change->type < LW_SCENE_ADD || change->type > LW_SCENE_MOVE )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, at, "scene change %u: unknown type %d", at, (int)change->type );
	}
	if ( change->object == NULL )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, at, "scene change %u names no object", at );
	}
	bool wants_shapes = change->type == LW_SCENE_ADD && change->shape_count > 0;
	bool wants_poses = change->type != LW_SCENE_REMOVE && change->shape_count > 0;
	if ( ( wants_shapes && change->shapes == NULL ) || ( wants_poses && change->world_from_shape == NULL ) )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, at,
			"scene change %u: object '%.80s': an array is NULL, its count is not 0", at, change->object );
	}
	for ( uint32_t i = 0; wants_shapes && i < change->shape_count; ++i )
	{
		if ( change->shapes[i] == NULL )
		{
			return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, at, "scene change %u: object '%.80s': its shape %u is NULL",
				at, change->object, i );
		}
	}
	return wants_poses ? check_poses( change, at, diag ) : LW_OK;
}

static lw_status add( draft* d, const lw_scene_change* change, uint32_t at, lw_diag* diag )
{
	for ( uint32_t i = 0; i < d->object_count; ++i )
	{
		if ( !d->objects[i].removed && strcmp( d->objects[i].name, change->object ) == 0 )
		{
			return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, at,
				"scene change %u: there is an object '%.80s' already; remove it first, or choose another name", at,
				change->object );
		}
	}
	uint32_t object = d->object_count++;
	d->objects[object] = ( draft_object ){ .name = change->object };
	for ( uint32_t i = 0; i < change->shape_count; ++i )
	{
		draft_shape* shape = &d->shapes[d->shape_count++];
		shape->def = ( lw_scene_shape_def ){ change->shapes[i], object, lwi_orthonormal( &change->world_from_shape[i] ) };
		shape->source = LW_INVALID_INDEX;
	}
	return LW_OK;
}

static lw_status move( draft* d, const lw_scene_change* change, uint32_t at, lw_diag* diag )
{
	uint32_t object = find( d, change, at, diag ), count = 0;
	if ( object == LW_INVALID_INDEX )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	for ( uint32_t i = 0; i < d->shape_count; ++i )
	{
		count += d->shapes[i].def.object == object ? 1u : 0u;
	}
	if ( count != change->shape_count )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, at,
			"scene change %u: object '%.80s' has %u shapes, but %u poses are given; give one for each, in their order", at,
			change->object, count, change->shape_count );
	}
	count = 0;
	for ( uint32_t i = 0; i < d->shape_count; ++i )
	{
		if ( d->shapes[i].def.object == object )
		{
			lw_transform pose = lwi_orthonormal( &change->world_from_shape[count++] );
			bool same = memcmp( &pose, &d->shapes[i].def.world_from_shape, sizeof( pose ) ) == 0;
			d->shapes[i].source = same ? d->shapes[i].source : LW_INVALID_INDEX;
			d->shapes[i].def.world_from_shape = pose;
		}
	}
	return LW_OK;
}

/// Its shapes stay on the list and name a removed object.
static lw_status drop( draft* d, const lw_scene_change* change, uint32_t at, lw_diag* diag )
{
	uint32_t object = find( d, change, at, diag );
	if ( object == LW_INVALID_INDEX )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	d->objects[object].removed = true;
	return LW_OK;
}

static lw_status apply( draft* d, const lw_scene_change* changes, uint32_t count, lw_diag* diag )
{
	lw_status status = LW_OK;
	for ( uint32_t i = 0; i < count && status == LW_OK; ++i )
	{
		status = changes[i].type == LW_SCENE_ADD    ? add( d, &changes[i], i, diag )
				 : changes[i].type == LW_SCENE_MOVE ? move( d, &changes[i], i, diag )
													: drop( d, &changes[i], i, diag );
	}
	return status;
}

/// The draft begins as the scene itself, with room for the added objects and shapes.
static lw_status begin( draft* d, const lw_allocator* allocator, lw_diag* diag )
{
	d->objects = lwi_alloc_zero( allocator, d->object_capacity, sizeof( draft_object ) );
	d->shapes = lwi_alloc_zero( allocator, d->shape_capacity, sizeof( draft_shape ) );
	if ( d->objects == NULL || d->shapes == NULL )
	{
		return lwi_out_of_memory( diag, "a scene" );
	}
	for ( uint32_t i = 0; i < d->object_count; ++i )
	{
		d->objects[i] = ( draft_object ){ .name = d->scene->object_names[i], .shared = true };
	}
	for ( uint32_t i = 0; i < d->shape_count; ++i )
	{
		d->shapes[i] = ( draft_shape ){ d->scene->shapes[i], i };
	}
	return LW_OK;
}

static lw_status finish( draft* d, const lw_allocator* allocator, lw_diag* diag, lw_scene** out_scene )
{
	uint32_t objects = 0, shapes = 0;
	for ( uint32_t i = 0; i < d->object_count; ++i )
	{
		d->objects[i].index = objects;
		objects += d->objects[i].removed ? 0u : 1u;
	}
	for ( uint32_t i = 0; i < d->shape_count; ++i )
	{
		shapes += d->objects[d->shapes[i].def.object].removed ? 0u : 1u;
	}
	lw_scene* scene = lwi_scene_allocate( objects, shapes, allocator );
	bool ok = scene != NULL;
	for ( uint32_t i = 0; ok && i < d->object_count; ++i )
	{
		const draft_object* object = &d->objects[i];
		if ( !object->removed )
		{
			char* name = object->shared ? lwi_name_retain( object->name ) : lwi_name_create( allocator, object->name );
			scene->object_names[object->index] = name;
			ok = name != NULL;
		}
	}
	if ( !ok )
	{
		lw_scene_release( scene );
		return lwi_out_of_memory( diag, "a scene" );
	}
	uint32_t at = 0;
	for ( uint32_t i = 0; i < d->shape_count; ++i )
	{
		const draft_shape* shape = &d->shapes[i];
		if ( d->objects[shape->def.object].removed )
		{
			continue;
		}
		scene->shapes[at] = shape->def;
		scene->shapes[at].object = d->objects[shape->def.object].index;
		scene->shapes[at].shape = lw_shape_retain( shape->def.shape );
		if ( shape->source != LW_INVALID_INDEX )
		{
			memcpy( scene->box_min[at], d->scene->box_min[shape->source], sizeof( double[3] ) );
			memcpy( scene->box_max[at], d->scene->box_max[shape->source], sizeof( double[3] ) );
		}
		else
		{
			lwi_world_box( shape->def.shape, &shape->def.world_from_shape, scene->box_min[at], scene->box_max[at] );
		}
		++at;
	}
	lwi_scene_bound( scene );
	*out_scene = scene;
	return LW_OK;
}

lw_status lw_scene_edit( const lw_scene* scene, const lw_scene_change* changes, uint32_t change_count,
	const lw_allocator* allocator_in, lw_diag* diag, lw_scene** out_scene )
{
	if ( out_scene == NULL )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, "out_scene is NULL" );
	}
	*out_scene = NULL;
	if ( scene == NULL || ( change_count > 0 && changes == NULL ) )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, "scene edit: the %s NULL",
			scene == NULL ? "scene is" : "changes are" );
	}
	uint64_t objects = scene->object_count, shapes = scene->shape_count;
	for ( uint32_t i = 0; i < change_count; ++i )
	{
		lw_status status = check_change( &changes[i], i, diag );
		if ( status != LW_OK )
		{
			return status;
		}
		objects += changes[i].type == LW_SCENE_ADD ? 1u : 0u;
		shapes += changes[i].type == LW_SCENE_ADD ? changes[i].shape_count : 0u;
	}
	if ( objects >= LW_INVALID_INDEX || shapes >= LW_INVALID_INDEX )
	{
		return lwi_out_of_memory( diag, "a scene" );
	}
	lw_allocator allocator = lwi_allocator_or_default( allocator_in );
	draft d = { .scene = scene,
		.object_count = scene->object_count,
		.shape_count = scene->shape_count,
		.object_capacity = (uint32_t)objects,
		.shape_capacity = (uint32_t)shapes };
	lw_status status = begin( &d, &allocator, diag );
	status = status == LW_OK ? apply( &d, changes, change_count, diag ) : status;
	status = status == LW_OK ? finish( &d, &allocator, diag, out_scene ) : status;
	lwi_free( &allocator, d.objects, d.object_capacity * sizeof( draft_object ) );
	lwi_free( &allocator, d.shapes, d.shape_capacity * sizeof( draft_shape ) );
	return status;
}
