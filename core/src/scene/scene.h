// SPDX-License-Identifier: BSD-3-Clause
// The inside of a scene, and the gaps between its boxes and a sphere.
#ifndef LEEWAY_SCENE_SCENE_H
#define LEEWAY_SCENE_SCENE_H

#include "base/base.h"
#include "simd/kernels.h"
#include "leeway/scene.h"
#include "distance/distance.h"

LW_EXTERN_C_BEGIN

struct lw_scene
{
	lwi_refcount references;
	lw_allocator allocator;
	uint32_t object_count, shape_count;
	uint32_t block_count; ///< of LWI_WIDTH shapes
	char** object_names;
	lw_scene_shape_def* shapes; ///< poses orthonormal
	double origin[3];           ///< centre of everything: floats below are relative to it
	double extent;              ///< largest |coordinate| of the boxes about the origin
	lwi_box8* boxes;            ///< [block_count] world bounds of the shapes, rounded outward
	double ( *box_min )[3];     ///< [shape_count] the same in double, world
	double ( *box_max )[3];
	uint32_t* unbounded; ///< [unbounded_count] half-spaces and planes, ascending: their boxes are infinite
	uint32_t unbounded_count;
};

/// Arrays of these sizes, all 0 but the counts; NULL without memory. The scene owns the names and shape references put into
/// them.
lw_scene* lwi_scene_allocate( uint32_t object_count, uint32_t shape_count, const lw_allocator* allocator );
void lwi_scene_free( lw_scene* scene );
/// The origin, and the float blocks about it: for a scene with its shapes and their boxes in double.
void lwi_scene_bound( lw_scene* scene );

/// Names of objects: reference counted.
char* lwi_name_create( const lw_allocator* allocator, const char* text );
char* lwi_name_retain( const char* text );
void lwi_name_release( char* text ); ///< NULL is ignored

/// World box of a shape at a pose, outward by a stated rounding.
void lwi_world_box( const lw_shape* shape, const lw_transform* world_from_shape, double box_min[3], double box_max[3] );

/// Distance of a sphere to a half-space or plane, rounded down: boxes say nothing of these. Rounding: three differences,
/// products and sums, and a normal that is of unit length to 8 roundoffs.
float lwi_unbounded_gap( const lw_scene_shape_def* obstacle, const double center[3], double radius );

/// Gaps of a bounding sphere (world) to the boxes, half-spaces and planes of the first blocks of the scene: gaps[blocks *
/// LWI_WIDTH], pads +INFINITY. Returns the metres to add to a limit before comparing a gap with it. *near: some gap is below
/// `cutoff` plus these metres, or is not a number.
double lwi_scene_gaps( const lw_scene* scene, uint32_t blocks, const lwi_kernels* kernels, const double center[3],
	double radius, double cutoff, float* gaps, bool* near );

LW_EXTERN_C_END

#endif
