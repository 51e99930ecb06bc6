// SPDX-License-Identifier: BSD-3-Clause
// Scenes: static obstacles with their world bounds.
#include "scene/scene.h"

#include "base/math_inline.h"

#include <string.h>

enum
{
	SCENE_COOKIE = 0x4c575343
};

lw_scene_def lw_scene_def_default( void )
{
	lw_scene_def def;
	memset( &def, 0, sizeof( def ) );
	def.cookie = SCENE_COOKIE;
	return def;
}

/// World box of the geometry: vertices, balls, corners of boxes; of a convex primitive or a deferred mesh the corners of its
/// box, moved.
void lwi_world_box( const lw_shape* shape, const lw_transform* world_from_shape, double box_min[3], double box_max[3] )
{
	for ( int i = 0; i < 3; ++i )
	{
		box_min[i] = INFINITY;
		box_max[i] = -INFINITY;
	}
	shape = lwi_shape_now( shape );
	if ( shape->family == LWI_UNBOUNDED )
	{
		for ( int i = 0; i < 3; ++i )
		{
			box_min[i] = -INFINITY;
			box_max[i] = INFINITY;
		}
		return;
	}
	size_t count = lwi_hull_count( shape );
	double largest = 0;
	for ( size_t k = 0; k < count; ++k )
	{
		lw_vec3 p = lwi_hull_point( shape, k );
		double r = shape->radii != NULL ? shape->radii[k] : 0;
		largest = fmax( largest, fmax( fabs( p.x ), fmax( fabs( p.y ), fabs( p.z ) ) ) + r );
		p = lwi_transform( world_from_shape, p );
		const double w[3] = { p.x, p.y, p.z };
		for ( int i = 0; i < 3; ++i )
		{
			box_min[i] = w[i] - r < box_min[i] ? w[i] - r : box_min[i];
			box_max[i] = w[i] + r > box_max[i] ? w[i] + r : box_max[i];
		}
	}
	for ( int i = 0; i < 3; ++i )
	{
		// three products and sums of coordinates up to `largest`, one sum with the translation
		double slack = shape->radius + 16 * LWI_U64 * ( 2 * largest + fabs( world_from_shape->t[i] ) );
		box_min[i] -= slack;
		box_max[i] += slack;
	}
}

// --- names, shared by the scenes that are edited from one another -----------------------------------------------------

typedef struct shared_name
{
	lwi_refcount references;
	lw_allocator allocator;
	size_t bytes;
	char text[];
} shared_name;

static shared_name* name_of( const char* text )
{
	return (shared_name*)( text - offsetof( shared_name, text ) );
}

char* lwi_name_create( const lw_allocator* allocator, const char* text )
{
	size_t length = strlen( text ) + 1, bytes = sizeof( shared_name ) + length;
	shared_name* made = lwi_alloc( allocator, bytes );
	if ( made == NULL )
	{
		return NULL;
	}
	atomic_init( &made->references, 1u );
	made->allocator = *allocator;
	made->bytes = bytes;
	memcpy( made->text, text, length );
	return made->text;
}

char* lwi_name_retain( const char* text )
{
	shared_name* mine = name_of( text );
	lwi_retain( &mine->references );
	return mine->text;
}

void lwi_name_release( char* text )
{
	if ( text != NULL && lwi_release( &name_of( text )->references ) )
	{
		const lw_allocator allocator = name_of( text )->allocator;
		lwi_free( &allocator, name_of( text ), name_of( text )->bytes );
	}
}

// --- creation --------------------------------------------------------------------------------------------------------

void lwi_scene_free( lw_scene* scene )
{
	const lw_allocator allocator = scene->allocator;
	if ( scene->object_names != NULL )
	{
		for ( uint32_t i = 0; i < scene->object_count; ++i )
		{
			lwi_name_release( scene->object_names[i] );
		}
	}
	if ( scene->shapes != NULL )
	{
		for ( uint32_t i = 0; i < scene->shape_count; ++i )
		{
			lw_shape_release( (lw_shape*)scene->shapes[i].shape );
		}
	}
	lwi_free( &allocator, scene->object_names, scene->object_count * sizeof( char* ) );
	lwi_free( &allocator, scene->shapes, scene->shape_count * sizeof( lw_scene_shape_def ) );
	lwi_free( &allocator, scene->boxes, scene->block_count * sizeof( lwi_box8 ) );
	lwi_free( &allocator, scene->box_min, scene->shape_count * sizeof( double[3] ) );
	lwi_free( &allocator, scene->box_max, scene->shape_count * sizeof( double[3] ) );
	lwi_free( &allocator, scene->unbounded, scene->shape_count * sizeof( uint32_t ) );
	lwi_free( &allocator, scene, sizeof( lw_scene ) );
}

static lw_status check_def( const lw_scene_def* def, lw_diag* diag )
{
	if ( def->cookie != SCENE_COOKIE )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_DEF, LW_INVALID_INDEX, "scene def was not made by lw_scene_def_default()" );
	}
	if ( ( def->object_count > 0 && def->object_names == NULL ) || ( def->shape_count > 0 && def->shapes == NULL ) )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX,
			"scene def: an array is NULL, its count is not 0" );
	}
	for ( uint32_t i = 0; i < def->object_count; ++i )
	{
		if ( def->object_names[i] == NULL )
		{
			return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, i, "scene object %u has no name", i );
		}
	}
	for ( uint32_t i = 0; i < def->shape_count; ++i )
	{
		const lw_scene_shape_def* shape = &def->shapes[i];
		if ( shape->shape == NULL || shape->object >= def->object_count )
		{
			return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, i, "scene shape %u: no shape, or object index out of range",
				i );
		}
		if ( !lw_transform_is_valid( &shape->world_from_shape ) )
		{
			return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, i,
				"scene shape %u of object '%.80s': its pose is not finite or not a rotation, or beyond 1e15 m; normalise its quaternion, give metres",
				i, def->object_names[shape->object] );
		}
	}
	return LW_OK;
}

void lwi_scene_bound( lw_scene* scene )
{
	double all_min[3] = { INFINITY, INFINITY, INFINITY }, all_max[3] = { -INFINITY, -INFINITY, -INFINITY };
	for ( uint32_t i = 0; i < scene->shape_count; ++i )
	{
		if ( scene->shapes[i].shape->family == LWI_UNBOUNDED )
		{
			scene->unbounded[scene->unbounded_count++] = i;
			continue;
		}
		for ( int axis = 0; axis < 3; ++axis )
		{
			all_min[axis] = fmin( all_min[axis], scene->box_min[i][axis] );
			all_max[axis] = fmax( all_max[axis], scene->box_max[i][axis] );
		}
	}
	for ( int axis = 0; axis < 3 && scene->shape_count > scene->unbounded_count; ++axis )
	{
		scene->origin[axis] = 0.5 * all_min[axis] + 0.5 * all_max[axis];
		scene->extent = fmax( scene->extent, all_max[axis] - all_min[axis] );
	}
	for ( uint32_t i = 0; i < scene->block_count * LWI_WIDTH; ++i )
	{
		lwi_box8* block = &scene->boxes[i / LWI_WIDTH];
		uint32_t lane = i % LWI_WIDTH;
		for ( int axis = 0; axis < 3; ++axis )
		{
			bool real = i < scene->shape_count && scene->box_max[i][axis] < INFINITY; // else: nothing is near the lane
			block->min[axis][lane] = real ? lwi_round_down( scene->box_min[i][axis] - scene->origin[axis] ) : INFINITY;
			block->max[axis][lane] = real ? lwi_round_up( scene->box_max[i][axis] - scene->origin[axis] ) : -INFINITY;
		}
	}
}

lw_scene* lwi_scene_allocate( uint32_t object_count, uint32_t shape_count, const lw_allocator* allocator )
{
	lw_scene* scene = lwi_alloc_zero( allocator, 1, sizeof( lw_scene ) );
	if ( scene == NULL )
	{
		return NULL;
	}
	atomic_init( &scene->references, 1u );
	scene->allocator = *allocator;
	scene->object_count = object_count;
	scene->shape_count = shape_count;
	scene->block_count = shape_count / LWI_WIDTH + ( shape_count % LWI_WIDTH != 0 );
	scene->object_names = lwi_alloc_zero( allocator, object_count, sizeof( char* ) );
	scene->shapes = lwi_alloc_zero( allocator, shape_count, sizeof( lw_scene_shape_def ) );
	scene->boxes = lwi_alloc_zero( allocator, scene->block_count, sizeof( lwi_box8 ) );
	scene->box_min = lwi_alloc_zero( allocator, shape_count, sizeof( double[3] ) );
	scene->box_max = lwi_alloc_zero( allocator, shape_count, sizeof( double[3] ) );
	scene->unbounded = lwi_alloc_zero( allocator, shape_count, sizeof( uint32_t ) );
	if ( scene->object_names == NULL || scene->shapes == NULL || scene->boxes == NULL || scene->box_min == NULL ||
		 scene->box_max == NULL || scene->unbounded == NULL )
	{
		lwi_scene_free( scene );
		return NULL;
	}
	return scene;
}

lw_status lw_scene_create( const lw_scene_def* def, const lw_allocator* allocator_in, lw_diag* diag, lw_scene** out_scene )
{
	if ( out_scene == NULL )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, "out_scene is NULL" );
	}
	*out_scene = NULL;
	if ( def == NULL )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, "scene def is NULL" );
	}
	lw_status status = check_def( def, diag );
	if ( status != LW_OK )
	{
		return status;
	}
	lw_allocator allocator = lwi_allocator_or_default( allocator_in );
	lw_scene* scene = lwi_scene_allocate( def->object_count, def->shape_count, &allocator );
	bool ok = scene != NULL;
	for ( uint32_t i = 0; ok && i < def->object_count; ++i )
	{
		scene->object_names[i] = lwi_name_create( &allocator, def->object_names[i] );
		ok = scene->object_names[i] != NULL;
	}
	if ( !ok )
	{
		lw_scene_release( scene );
		return lwi_out_of_memory( diag, "a scene" );
	}
	for ( uint32_t i = 0; i < def->shape_count; ++i )
	{
		scene->shapes[i] = def->shapes[i];
		scene->shapes[i].shape = lw_shape_retain( def->shapes[i].shape );
		scene->shapes[i].world_from_shape = lwi_orthonormal( &def->shapes[i].world_from_shape );
		lwi_world_box( scene->shapes[i].shape, &scene->shapes[i].world_from_shape, scene->box_min[i], scene->box_max[i] );
	}
	lwi_scene_bound( scene );
	*out_scene = scene;
	return LW_OK;
}

lw_scene* lw_scene_retain( const lw_scene* scene )
{
	lw_scene* mine = (lw_scene*)scene;
	if ( mine != NULL )
	{
		lwi_retain( &mine->references );
	}
	return mine;
}

void lw_scene_release( lw_scene* scene )
{
	if ( scene != NULL && lwi_release( &scene->references ) )
	{
		lwi_scene_free( scene );
	}
}

uint32_t lw_scene_object_count( const lw_scene* scene )
{
	return scene->object_count;
}

uint32_t lw_scene_shape_count( const lw_scene* scene )
{
	return scene->shape_count;
}

const char* lw_scene_object_name( const lw_scene* scene, uint32_t object )
{
	return object < scene->object_count ? scene->object_names[object] : "";
}

uint32_t lw_scene_find_object( const lw_scene* scene, const char* name )
{
	for ( uint32_t i = 0; i < scene->object_count; ++i )
	{
		if ( strcmp( scene->object_names[i], name ) == 0 )
		{
			return i;
		}
	}
	return LW_INVALID_INDEX;
}

lw_scene_shape_def lw_scene_shape( const lw_scene* scene, uint32_t index )
{
	lw_scene_shape_def none;
	memset( &none, 0, sizeof( none ) );
	none.object = LW_INVALID_INDEX;
	return index < scene->shape_count ? scene->shapes[index] : none;
}

float lwi_unbounded_gap( const lw_scene_shape_def* obstacle, const double center[3], double radius )
{
	const lw_transform* m = &obstacle->world_from_shape;
	double z = 0, size = radius;
	for ( int i = 0; i < 3; ++i )
	{
		z += ( center[i] - m->t[i] ) * m->r[i][2];
		size += fabs( center[i] ) + fabs( m->t[i] );
	}
	double gap = obstacle->shape->type == LW_SHAPE_PLANE ? fabs( z ) - radius : z - radius;
	return lwi_round_down( gap - 32 * LWI_U64 * size );
}

double lwi_scene_gaps( const lw_scene* scene, uint32_t blocks, const lwi_kernels* kernels, const double center[3],
	double radius, double cutoff, float* gaps, bool* near )
{
	float sphere[4];
	double reach = 0;
	for ( int i = 0; i < 3; ++i )
	{
		double relative = center[i] - scene->origin[i];
		sphere[i] = (float)relative;
		reach = fabs( relative ) > reach ? fabs( relative ) : reach;
	}
	sphere[3] = lwi_round_up( radius );
	// as in simd/kernels.h; the centre is only rounded here, not moved
	double slack = lwi_gap_slack( reach + scene->extent + radius );
	float limit = lwi_round_up( cutoff + slack );
	uint32_t lanes = 0;
	for ( uint32_t block = 0; block < blocks; ++block )
	{
		lanes |= kernels->box_gap( &scene->boxes[block], sphere, limit, gaps + block * LWI_WIDTH );
	}
	for ( uint32_t i = 0; i < scene->unbounded_count && scene->unbounded[i] < blocks * LWI_WIDTH; ++i )
	{
		float gap = lwi_unbounded_gap( &scene->shapes[scene->unbounded[i]], center, radius );
		gaps[scene->unbounded[i]] = gap;
		lanes |= gap >= limit ? 0u : 1u;
	}
	*near = lanes != 0;
	return slack;
}
