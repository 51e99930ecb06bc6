// SPDX-License-Identifier: BSD-3-Clause
// The float filters of the search: eight lanes at a time, one table per instruction set.
//
// Every gap is a certified lower bound up to rounding: it is the width of a slab between the two things along some
// direction, and such a width never exceeds the distance whatever the direction. So degenerate triangles can make a gap
// small, never too large. Pads give +INFINITY. A NaN (overflow) must be read as "not dropped": compare with !( gap >= limit
// ).
//
// Rounding, u = 2^-24, S = |translation| + 2 (extent of a + extent of b), S bounding every coordinate difference below:
//   a point moved into the other frame: rounded matrix entries u, three products u, three sums 3u, translation u:
//     <= sqrt(3) (5 u |c| + 2 u |t|) <= 9 u S;
//   triangle vertices rounded to float: sqrt(3) u per side <= 2 u S;
//   a gap from these: difference u, dot product 3u, both relative to |n| |p - v|, quotient and root 2u: <= 7 u S.
// Sum 18 u S. Triangles in the frame of a primitive: moved 9 u S, rounded 2 u S, two supports along n 4 u S each, their
// difference and quotient 5 u S, in all 24 u S. Oriented boxes: centres 9 u S and 7 u S, reaches 17 u of the radii, 25 u S
// (core/docs/distance.md). LWI_GAP_SLACK = 32 leaves room. tests/core_query measures it.
// Contract: every level gives the bits of the scalar one (tests/core_query/kernels_test.cpp).
#ifndef LEEWAY_SIMD_KERNELS_H
#define LEEWAY_SIMD_KERNELS_H

#include "leeway/shape.h"
#include "simd/lanes.h"
#include "simd/tree_layout.h"
#include "simd/voxels.h"

#include <float.h>

LW_EXTERN_C_BEGIN

#define LWI_GAP_SLACK 32.0

/// Underflow's share of the slack, metres. Products below 2^-126 are off by up to 2^-150 each: three squares under a root by
/// 2^-74, and a gap has at most four such roots in a row or in a sum (a sphere around a box or triangle, an axis, a
/// distance); three products over the root of the least divisor, 2^-63, by far less. 2^-72, and again as much room as the
/// slack leaves for other roundings.
#define LWI_GAP_UNDERFLOW 0x1p-68

/// Metres by which a gap of things of this size may be too large.
static inline double lwi_gap_slack( double size )
{
	return LWI_GAP_SLACK * ( 0.5 * (double)FLT_EPSILON ) * size + LWI_GAP_UNDERFLOW;
}

/// Eight triangles, [vertex][axis][lane].
typedef float lwi_triangles8[3][3][LWI_WIDTH];

/// A rigid motion in float: p -> r p + t, rows of r then t.
typedef struct lwi_motion
{
	float r[9], t[3];
} lwi_motion;

/// Eight planes in one frame. Something is on the far side of each.
typedef struct lwi_planes8
{
	float direction[3][LWI_WIDTH]; ///< towards it, of length 1 to rounding
	float reach[LWI_WIDTH];        ///< how far it reaches against the direction, from the frame's origin; +INFINITY for pads
} lwi_planes8;

/// A box that is not along the axes, maybe sheared: its middle, and from there to the middles of three faces.
typedef struct lwi_sheared_box
{
	float middle[3], half[3][3];
} lwi_sheared_box;

/// A primitive for the filters: lw_shape_type and half sizes (box), radius and half height (cylinder, cone); nothing
/// (half-space, plane).
typedef struct lwi_primitive
{
	lw_shape_type type;
	float size[3];
} lwi_primitive;

/// A pose, by rows: [i][0..2] of its rotation, [i][3] of its origin.
typedef struct lwi_pose_rows
{
	double at[3][4];
} lwi_pose_rows;

typedef struct lwi_kernels
{
	lw_simd level;
	// Those that return uint32_t: bit i is set where lane i does not reach `limit`, NaN included.

	/// |c - c_i| - (r + r_i) of a sphere (x, y, z, r) and eight: xyzr = float[4][8], as the head of lwi_node
	uint32_t ( *sphere_gap )( const float* xyzr, const float sphere[4], float limit, float gap[LWI_WIDTH] );
	/// distance of one oriented box and eight, by their slabs along the line of the centres of their spheres and along
	/// `along` (unit, from the node to the other; NULL for none); NaN for pads
	uint32_t ( *obb_gap )( const lwi_node* node, const lwi_obb8* obbs, const lwi_obb* other, const float along[3],
		float limit, float gap[LWI_WIDTH] );
	/// pairs of spheres in blocks of float[4][8] whose gap does not reach `limit` >= 0, by its square: `near` gets 256 *
	/// lower + higher index. mask[i * stride + block]: which of a block's are compared with sphere i, a later one; returns
	/// their count
	uint32_t ( *sphere_pairs )( const float* blocks, uint32_t count, const uint8_t* mask, uint32_t stride, float limit,
		uint16_t* near );
	/// distance of the sphere's centre to eight boxes, minus its radius
	uint32_t ( *box_gap )( const lwi_box8* boxes, const float sphere[4], float limit, float gap[LWI_WIDTH] );
	/// distance of eight boxes to one in the same frame
	uint32_t (
		*box_pair_gap )( const lwi_box8* boxes, const float min[3], const float max[3], float limit, float gap[LWI_WIDTH] );
	/// distance of the sphere's centre to the eight triangles of a leaf, minus its radius; direction[axis][lane] is the
	/// slab's direction (any length), from triangle to centre
	uint32_t ( *leaf_gap )( const lwi_leaf* leaf, const float sphere[4], float limit, float gap[LWI_WIDTH],
		float direction[3][LWI_WIDTH] );
	/// low - high of eight lanes against one high, along `count` directions; a lane is dropped if any of them reaches
	/// `limit`
	uint32_t ( *slab_gap )( const float ( *low )[LWI_WIDTH], const float* high, float limit, uint32_t count );
	/// how far the spheres of a node reach along a unit direction: direction . center + radius; bit i is set where lane i
	/// reaches farther than `least`
	uint32_t ( *node_project )( const lwi_node* node, const float direction[3], float least, float high[LWI_WIDTH] );
	/// extent of the eight triangles of a leaf along `direction`: least and greatest direction . vertex
	void ( *leaf_project )( const lwi_leaf* leaf, const float direction[3], float low[LWI_WIDTH], float high[LWI_WIDTH] );
	/// the leaf's triangles moved
	void ( *leaf_transform )( const lwi_leaf* leaf, const lwi_motion* motion, lwi_triangles8 out );
	/// blocks of eight points moved
	void ( *points_move )( const lwi_points8* points, uint32_t blocks, const lwi_motion* motion, lwi_points8* out );
	/// the point of `blocks` > 0 of these that is farthest along `direction`, and how far; of several the one in the first
	/// lane, in the first block
	uint32_t ( *points_farthest )( const lwi_points8* points, uint32_t blocks, const float direction[3], float* high );
	/// the same in double; of several the first
	uint32_t ( *corners_farthest )( const lwi_corners8* corners, uint32_t blocks, const double direction[3] );
	/// planes that `count` > 0 boxes stay `need` below. Boxes have the axes of the world and the planes' origin; r: rows of
	/// world_from_planes room[lane]: how far below they stay, -INFINITY where nothing that touches all faces of one of the
	/// boxes stays `hope` below
	uint32_t ( *planes_clear )( const lwi_planes8* planes, const float r[9], const lwi_sheared_box* boxes, uint32_t count,
		float need, float hope, float room[LWI_WIDTH] );
	/// distances of eight pairs of triangles. Lanes that reach `limit` by a cheap direction may stop there.
	uint32_t ( *triangle_gap )( lwi_triangles8 a, lwi_triangles8 b, float limit, float gap[LWI_WIDTH] );
	/// distance of the centres of a node's spheres to a primitive, minus their radii; motion = primitive_from_tree
	uint32_t ( *node_primitive_gap )( const lwi_node* node, const lwi_motion* motion, const lwi_primitive* primitive,
		float limit, float gap[LWI_WIDTH] );
	/// distance of the triangles of a leaf to a primitive, of the spheres around them where that is enough and to cones
	uint32_t ( *leaf_primitive_gap )( const lwi_leaf* leaf, const lwi_motion* motion, const lwi_primitive* primitive,
		float limit, float gap[LWI_WIDTH] );
	/// Is some point of some block, moved, inside of a box, cylinder or half-space?
	bool ( *points_inside )( const lwi_points8* points, uint32_t blocks, const lwi_motion* motion,
		const lwi_primitive* primitive );
	/// cosines and sines of angles as lwi_sincos_of() has them; fastest for multiples of four
	void ( *sincos )( const double* angle, uint32_t count, double* cosine, double* sine );

	/// Poses of a chain's tip. Part i is a turn about z, a shift along z, and `before` both a pose that stands still.
	/// @param tips [count + 1] in the frame that part i - 1 moves; the last one is given
	void ( *chain_tips )( const lwi_pose_rows* before, const double* cosine, const double* sine, const double* shift,
		uint32_t count, lwi_pose_rows* tips );

	// Interval batches: simd/lanes.h. [LWI_WIDTH] lanes

	/// The frame behind a joint. @param value of a joint that shifts, else zeros @param cosine, sine 1 and 0 of one that
	/// does
	/// @param speed how fast it turns or shifts, per unit of t, in each lane
	void ( *batch_frame )( const lwi_batch_frame* above, const lwi_batch_joint* joint, const double* cosine,
		const double* sine, const double* value, const double* speed, lwi_batch_frame* out );
	/// A point of a frame, from an origin in the world. @param half width of half a window in t; 0: twists are not read
	void ( *batch_point )( const lwi_batch_frame* frame, const double local[3], const double origin[3], double half,
		lwi_batch_point* out );
	/// Lanes in which a point may come within `reach` > 0 of a box or of another point, except for changes of velocity
	uint32_t ( *batch_box )( const lwi_batch_point* point, const float min[3], const float max[3], float reach );
	uint32_t ( *batch_pair )( const lwi_batch_point* a, const lwi_batch_point* b, float reach );

	// States in lanes: checker/states.c

	/// The frame behind a joint, as batch_frame()
	void ( *lane_frame )( const lwi_lane_motion* above, const lwi_lane_joint* joint, const double* cosine,
		const double* sine, const double* value, lwi_lane_motion* out );
	/// A frame of a batch, from an origin in the world
	void ( *lane_of_batch )( const lwi_batch_frame* frame, const double origin[3], lwi_lane_motion* out );
	/// A point of a frame that is at rest, from a place
	void ( *lane_point )( const lwi_lane_motion* frame, const double local[3], const double from[3], lwi_batch_point* out );
	/// Boxes that a point comes nearer to than `reach` > 0: a number per block, bits 8 k + lane of box k. Of those among these
	void ( *lane_boxes )( const lwi_batch_point* point, const lwi_box8* boxes, uint32_t blocks, float reach,
		const uint64_t* among, uint64_t* near );
	/// A body: its frame in the frame of a cluster (r, t), and that
	void ( *lane_body )( const lwi_lane_motion* frame, const double r[3][3], const double t[3], lwi_lane_motion* out );
	/// The body in the frame of something that stands still: its rows r and place t
	void ( *lane_relative )( const lwi_lane_motion* body, const double r[3][3], const double t[3], lwi_lane_motion* out );
	/// The first body in the frame of the second
	void ( *lane_between )( const lwi_lane_motion* a, const lwi_lane_motion* b, lwi_lane_motion* out );
	/// Lanes in which a box of the tree's frame comes nearer than `limit` > 0 to a box or cylinder, by their faces
	uint32_t ( *lane_slabs )( const lwi_lane_motion* motion, const float middle[3], const float half[3],
		const lwi_primitive* primitive, float limit );

	// Pairs of convex bodies in lanes: distance/convex_lanes.c. open: lanes that count

	/// Begins with the direction between the middles: sets where the bodies are farthest, of boxes their points there, and an
	/// interval of which nothing is known.
	/// @param rounding, error shares of the extent, and of both sizes and the largest coordinate between the places
	void ( *convex_start )( lwi_convex_lanes* lanes, uint32_t open, double rounding, double error );
	/// Takes in the points where the bodies are farthest: narrows the intervals, and sets the next direction as convex_start()
	/// does.
	/// @param known points of the simplex so far, 3 at most; of these some may be equal
	/// @return lanes whose interval is above 0 and narrow enough, or beyond `far`
	uint32_t ( *convex_step )( lwi_convex_lanes* lanes, uint32_t open, uint32_t known );

	// Voxels: cloud/insert.c, cloud/clear.c

	/// Voxels of eight points. @param place of its chunk, chunks in the order z, y, x, times LWI_CHUNK_BLOCKS, and its block's number in there, in Morton
	/// order @param voxel its number in the block, in Morton order. @return lanes whose points are in the grid; others have numbers without meaning
	uint32_t (
		*point_voxels )( const lwi_voxel_grid* grid, const double ( *point )[LWI_WIDTH], uint32_t* place, uint32_t* voxel );
	/// The points of eight pixels of a row. @param depths of columns u to u + 7, metres; a depth that is NaN, 0 or negative is not measured
	void ( *pixel_voxels )( const lwi_voxel_grid* grid, const lwi_pixel_row* row, uint32_t u, const double* depths,
		lwi_eight_pixels* out );
	/// Eight points of a sensor: sets points, voxels and lanes of `out`, and their rays. @param given [3][8] coordinates; those that are not finite are not
	/// measured
	void ( *sensor_points )( const lwi_voxel_grid* grid, const lwi_point_sensor* sensor, const double ( *given )[LWI_WIDTH],
		lwi_eight_pixels* out, lwi_eight_rays* rays );
	/// Eight rays in a view. @param r rotation from the world to the view @param x, y, z [8] of the rays @param out [3][8] tangents x / z and y / z, and z
	void (
		*ray_tangents )( const double r[3][3], const float* x, const float* y, const float* z, double ( *out )[LWI_WIDTH] );
	/// Pixels of eight rays, those on the greatest tangents in the last pixels, and their depths: infinite, in pixel 0, if they are not in the picture
	/// @param tangents of ray_tangents
	void ( *ray_pixels )( const lwi_ray_picture* picture, const double ( *tangents )[LWI_WIDTH], uint32_t* pixel,
		float* depth );
	/// Lanes of a cube of eight voxels whose middle's pixel saw something behind them. @param middle of the cube, frame of the view
	uint32_t ( *voxels_before )( const lwi_voxel_view* view, const float middle[3] );
} lwi_kernels;

/// The table of a level; levels that this build or machine lacks give the next lower one.
const lwi_kernels* lwi_kernels_get( lw_simd level );

extern const lwi_kernels lwi_kernels_scalar;
extern const lwi_kernels lwi_kernels_sse2;
extern const lwi_kernels lwi_kernels_avx2;
extern const lwi_kernels lwi_kernels_neon;

LW_EXTERN_C_END

#endif
