// SPDX-License-Identifier: BSD-3-Clause
// Scenes: named static obstacles, each one or more shapes at fixed poses.
#ifndef LEEWAY_SCENE_H
#define LEEWAY_SCENE_H

#include "leeway/distance.h"

LW_EXTERN_C_BEGIN

typedef struct lw_scene_shape_def
{
	const lw_shape* shape; ///< a reference is taken
	uint32_t object;       ///< index into object_names
	lw_transform world_from_shape;
} lw_scene_shape_def;

typedef struct lw_scene_def
{
	const char* const* object_names; ///< [object_count]
	uint32_t object_count;
	const lw_scene_shape_def* shapes; ///< [shape_count]
	uint32_t shape_count;
	uint32_t cookie;
} lw_scene_def;

LW_API lw_scene_def lw_scene_def_default( void );

/// Immutable; threads and checkers may share it; reference counted.
typedef struct lw_scene lw_scene;

/// An empty scene (no shapes) is valid: every distance to it is FAR.
/// @return LW_OK, LW_ERROR_INVALID_DEF, LW_ERROR_INVALID_ARGUMENT (diag.index = shape), LW_ERROR_OUT_OF_MEMORY
LW_API lw_status lw_scene_create( const lw_scene_def* def, const lw_allocator* allocator, lw_diag* diag,
	lw_scene** out_scene );

typedef enum lw_scene_change_type
{
	LW_SCENE_ADD = 1,    ///< appends an object
	LW_SCENE_REMOVE = 2, ///< removes an object; the indices of later objects drop by one
	LW_SCENE_MOVE = 3    ///< gives the shapes of an object new poses
} lw_scene_change_type;

/// One change of a scene. Members that the type does not use are ignored.
typedef struct lw_scene_change
{
	lw_scene_change_type type;
	const char* object;                   ///< name; ADD: not in use yet; REMOVE and MOVE: of an existing object
	const lw_shape* const* shapes;        ///< ADD: [shape_count], references are taken
	const lw_transform* world_from_shape; ///< ADD, MOVE: [shape_count]
	uint32_t shape_count;                 ///< MOVE: as many as the object has; poses in the order of its shapes
} lw_scene_change;

/// Makes a new scene by applying the changes in order. `scene` is unchanged and stays valid for its users; both share shapes
/// and names. The result equals lw_scene_create() with the same objects in the same order. lw_checker_edit() makes a
/// checker for it.
/// @return LW_OK, LW_ERROR_INVALID_ARGUMENT (diag.index = change: no such object, name in use, bad pose),
/// LW_ERROR_OUT_OF_MEMORY
/// Cost: some ten nanoseconds per object; for each added or moved shape one pass over its vertices.
LW_API lw_status lw_scene_edit( const lw_scene* scene, const lw_scene_change* changes, uint32_t change_count,
	const lw_allocator* allocator, lw_diag* diag, lw_scene** out_scene );

LW_API lw_scene* lw_scene_retain( const lw_scene* scene );
LW_API void lw_scene_release( lw_scene* scene );

LW_API uint32_t lw_scene_object_count( const lw_scene* scene );
LW_API uint32_t lw_scene_shape_count( const lw_scene* scene );
LW_API const char* lw_scene_object_name( const lw_scene* scene, uint32_t object );
LW_API uint32_t lw_scene_find_object( const lw_scene* scene, const char* name );   ///< LW_INVALID_INDEX if none
LW_API lw_scene_shape_def lw_scene_shape( const lw_scene* scene, uint32_t index ); ///< the scene keeps the reference

LW_EXTERN_C_END

#endif
