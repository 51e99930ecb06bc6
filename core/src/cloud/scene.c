// SPDX-License-Identifier: BSD-3-Clause
// Scenes of a cloud: the shapes of chunks that changed are made anew, all others are those of the scene before.
#include "cloud/cloud.h"
#include "base/math_inline.h"
#include "scene/scene.h"

#include <string.h>

/// Puts a new shape in the place of an old one. @return how many there are, 0 or 1
static uint32_t renew( lw_shape* made, lw_shape** shape, bool* changed )
{
	lw_shape_release( *shape );
	*shape = made;
	*changed = false;
	return made != NULL ? 1 : 0;
}

/// The shapes of a chunk, if they are not up to date.
static lw_status make_chunk_shapes( const lw_cloud* cloud, lwi_chunk* chunk, lw_diag* diag )
{
	lw_status status = LW_OK;
	lw_shape* made = NULL;
	if ( chunk->place != LW_INVALID_INDEX && chunk->occupied_changed )
	{
		status = lwi_occupied_shape( cloud, chunk, diag, &made );
		chunk->rebuilt += status == LW_OK ? renew( made, &chunk->occupied, &chunk->occupied_changed ) : 0;
	}
	if ( chunk->place != LW_INVALID_INDEX && chunk->unseen_changed && cloud->def.unseen_blocked && status == LW_OK )
	{
		status = lwi_unseen_shape( cloud, chunk, diag, &made );
		chunk->rebuilt += status == LW_OK ? renew( made, &chunk->unseen, &chunk->unseen_changed ) : 0;
	}
	return status;
}

/// A task. make_shapes() tries a failed one again, and says why it fails. @param context lw_cloud* @param index of a chunk
static void try_chunk_shapes( void* context, uint32_t index )
{
	const lw_cloud* cloud = context;
	lwi_chunk* chunk = lwi_chunk_at( cloud, index );
	chunk->rebuilt = 0;
	(void)make_chunk_shapes( cloud, chunk, NULL );
}

/// Makes the shapes that are not up to date.
static lw_status make_shapes( lw_cloud* cloud, lw_diag* diag )
{
	lw_status status = LW_OK;
	cloud->rebuilt = 0;
	if ( cloud->far_changed )
	{
		lw_shape* made = NULL;
		status = lwi_far_unseen_shape( cloud, diag, &made );
		cloud->rebuilt += status == LW_OK ? renew( made, &cloud->far_unseen, &cloud->far_changed ) : 0;
	}
	const uint32_t count = status == LW_OK ? (uint32_t)cloud->chunks.count : 0;
	lwi_cloud_run( cloud, try_chunk_shapes, cloud, count );
	for ( uint32_t i = 0; i < count && status == LW_OK; ++i )
	{
		lwi_chunk* chunk = lwi_chunk_at( cloud, i );
		status = make_chunk_shapes( cloud, chunk, diag );
		cloud->rebuilt += chunk->rebuilt;
	}
	return status;
}

static uint32_t count_shapes( const lw_cloud* cloud )
{
	uint32_t count = cloud->far_unseen != NULL ? 1 : 0;
	for ( uint32_t i = 0; i < cloud->chunks.count; ++i )
	{
		const lwi_chunk* chunk = lwi_chunk_at( cloud, i );
		count += ( chunk->occupied != NULL ? 1u : 0u ) + ( chunk->unseen != NULL ? 1u : 0u );
	}
	return count;
}

/// Appends a shape, if there is one, to an object of the scene. The pose is the identity, so its box is the shape's own.
static void append( lw_scene* scene, uint32_t object, const lw_shape* shape, uint32_t* at )
{
	if ( shape == NULL )
	{
		return;
	}
	const lw_shape_info info = lw_shape_get_info( shape );
	scene->shapes[*at] = ( lw_scene_shape_def ){ lw_shape_retain( shape ), object, lw_transform_identity() };
	memcpy( scene->box_min[*at], info.box_min, sizeof( double[3] ) );
	memcpy( scene->box_max[*at], info.box_max, sizeof( double[3] ) );
	++*at;
}

/// The objects and shapes of another scene, as the first ones.
static void copy_base( lw_scene* scene, const lw_scene* base )
{
	for ( uint32_t i = 0; i < base->object_count; ++i )
	{
		scene->object_names[i] = lwi_name_retain( base->object_names[i] );
	}
	for ( uint32_t i = 0; i < base->shape_count; ++i )
	{
		scene->shapes[i] = base->shapes[i];
		scene->shapes[i].shape = lw_shape_retain( base->shapes[i].shape );
		memcpy( scene->box_min[i], base->box_min[i], sizeof( double[3] ) );
		memcpy( scene->box_max[i], base->box_max[i], sizeof( double[3] ) );
	}
}

static lw_status check_scene( const lw_cloud* cloud, const lw_scene* base, const char* name, lw_diag* diag )
{
	if ( cloud == NULL || name == NULL )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, "the %s NULL",
			cloud == NULL ? "cloud is" : "name of the object is" );
	}
	if ( base != NULL && lw_scene_find_object( base, name ) != LW_INVALID_INDEX )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, lw_scene_find_object( base, name ),
			"the scene has an object '%.80s' already: give the cloud another name", name );
	}
	if ( !cloud->complete )
	{
		return lwi_fail( diag, LW_ERROR_STALE, LW_INVALID_INDEX,
			"the cloud is incomplete: %llu points were lost; lw_cloud_clear() and begin again, with more than %u blocks",
			(unsigned long long)cloud->lost, cloud->def.most_blocks );
	}
	return LW_OK;
}

lw_status lw_cloud_scene( lw_cloud* cloud, const lw_scene* base, const char* name, lw_diag* diag, lw_scene** out_scene )
{
	if ( out_scene == NULL )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, "out_scene is NULL" );
	}
	*out_scene = NULL;
	lw_status status = check_scene( cloud, base, name, diag );
	status = status == LW_OK ? make_shapes( cloud, diag ) : status;
	if ( status != LW_OK )
	{
		return status;
	}
	if ( cloud->name == NULL || strcmp( cloud->name, name ) != 0 )
	{
		char* other = lwi_name_create( &cloud->allocator, name );
		if ( other == NULL )
		{
			return lwi_out_of_memory( diag, "a scene" );
		}
		lwi_name_release( cloud->name );
		cloud->name = other;
	}
	const uint32_t objects = base != NULL ? base->object_count : 0;
	uint32_t at = base != NULL ? base->shape_count : 0;
	lw_scene* scene = lwi_scene_allocate( objects + 1, at + count_shapes( cloud ), &cloud->allocator );
	if ( scene == NULL )
	{
		return lwi_out_of_memory( diag, "a scene" );
	}
	if ( base != NULL )
	{
		copy_base( scene, base );
	}
	scene->object_names[objects] = lwi_name_retain( cloud->name );
	append( scene, objects, cloud->far_unseen, &at );
	for ( uint32_t i = 0; i < cloud->chunks.count; ++i )
	{
		append( scene, objects, lwi_chunk_at( cloud, i )->occupied, &at );
		append( scene, objects, lwi_chunk_at( cloud, i )->unseen, &at );
	}
	cloud->shapes = count_shapes( cloud );
	lwi_scene_bound( scene );
	*out_scene = scene;
	return LW_OK;
}
