// SPDX-License-Identifier: BSD-3-Clause
// Voxels of a live cloud in the lanes of vectors: cloud/insert.c, cloud/clear.c.
#ifndef LEEWAY_SIMD_VOXELS_H
#define LEEWAY_SIMD_VOXELS_H

#include "leeway/math.h"
#include "simd/tree_layout.h"

enum
{
	LWI_BLOCK_EDGE = 8,     ///< voxels
	LWI_BLOCK_VOXELS = 512, ///< of a block
	LWI_BLOCK_WORDS = 8,
	LWI_CHUNK_EDGE = 32, ///< voxels
	LWI_CHUNK_BLOCKS = 64
};

/// Voxel (x, y, z) of a point p is floor( p inverse - first ), along each axis within low <= x < high, whole numbers >= 0.
typedef struct lwi_voxel_grid
{
	double inverse, first[3], low[3], high[3];
	uint32_t wide, tall; ///< chunks along x and y
} lwi_voxel_grid;

/// Pixels of a row of a depth image: that of column u sees the point t + z (row + columns[u]) at depth z, world. A depth is a point from `near` to `far`;
/// one beyond `far`, up to `most`, clears its ray up to `beyond`.
typedef struct lwi_pixel_row
{
	const double* columns[3];
	double row[3], t[3];
	double near, far, most, beyond; ///< metres
} lwi_pixel_row;

/// What eight pixels saw.
typedef struct lwi_eight_pixels
{
	double points[3][LWI_WIDTH];                 ///< world; without meaning where the pixel is not in range
	float rays[LWI_WIDTH];                       ///< depths that the rays clear to, 0 if a pixel says nothing
	uint32_t place[LWI_WIDTH], voxel[LWI_WIDTH]; ///< of the points, see point_voxels
	uint32_t measured, in_range, in_grid;        ///< lanes
} lwi_eight_pixels;

/// Points of a sensor, and which of them count: those from `near` to `far`.
typedef struct lwi_point_sensor
{
	lw_transform pose; ///< world_from_sensor
	bool in_world;     ///< points are given in the world, not in the sensor's frame
	double near_sq, far_sq;
} lwi_point_sensor;

/// What eight points say, beside lwi_eight_pixels.
typedef struct lwi_eight_rays
{
	double axis[3][LWI_WIDTH]; ///< from the sensor to the points, along the axes of the world
	double length_sq[LWI_WIDTH];
} lwi_eight_rays;

/// A picture of rays: that of tangents x / z and y / z is in pixel ( x / z fx + cx, y / z fy + cy ), rounded down.
typedef struct lwi_ray_picture
{
	double fx, fy, cx, cy;
	uint32_t width, height;
} lwi_ray_picture;

/// The depths that a sensor saw, and a cube of eight voxels in its view: pixel (u, v) looks along ((u - cx) / fx, (v - cy) / fy, 1).
typedef struct lwi_voxel_view
{
	const float* least; ///< [height][width] depths z, 0 if a pixel saw nothing
	uint32_t width, height;
	float fx, fy, cx, cy;
	float half;                 ///< a voxel reaches from its middle along z
	float nearest;              ///< depth: voxels that begin nearer are not looked up
	float margin, slack;        ///< what was seen is behind its far side by more than margin + slack times that
	float voxels[3][LWI_WIDTH]; ///< x, y and z from the cube's middle to those of its voxels
} lwi_voxel_view;

#endif
