// SPDX-License-Identifier: BSD-3-Clause
// Live clouds: voxels that depth cameras and scanners fill and clear, and scenes made of them.
//
// A cloud is the map of one writer. Frames come in by lw_cloud_insert(); lw_cloud_scene() makes a scene of the cloud as it is, which shares all
// shapes that did not change with the scene before. Planners keep their scenes, as after any other edit. Derivation: core/docs/cloud.md.
#ifndef LEEWAY_CLOUD_H
#define LEEWAY_CLOUD_H

#include "leeway/robot.h"
#include "leeway/scene.h"

LW_EXTERN_C_BEGIN

/// Voxels in a box of the world. Calls of one cloud come one at a time, and may use threads of yours (lw_cloud_def::parallel); the shapes in its
/// scenes are immutable and shared.
typedef struct lw_cloud lw_cloud;

/// Sensors of one cloud are numbered from 0 to this number less one.
#define LW_CLOUD_SENSORS 16

/// Make it with lw_cloud_def_default().
typedef struct lw_cloud_def
{
	double
		resolution; ///< metres, 1e-4 to 10: edge of a voxel. Voxel (i, j, k) is from (i, j, k) * resolution, in the world frame
	/// Metres, world frame: the box that the cloud is about, enlarged to whole voxels. Points beyond it are counted and dropped.
	double box_min[3], box_max[3];
	/// Voxels that no ray has passed and no point has hit: blocked (true), or free. The scene has those within the box.
	bool unseen_blocked;
	double sensor_error; ///< metres, >= 0: a measured point is no farther from the true one. Obstacles are enlarged by it
	/// Metres, >= 0: a ray clears a voxel only if it ends so far behind all of it; NaN: the resolution.
	double clear_margin;
	double shadow; ///< metres, >= 0: points nearer than this to the robot of a frame are its own body
	/// Metres and radians: a sensor that has moved or turned by more since its frame before has jumped. INFINITY: no limit.
	double jump_distance, jump_angle;
	uint32_t most_blocks; ///< of 8 x 8 x 8 voxels, some 2.3 kB each: the most that are kept
	/// Runs task( context, i ) for each i below count, on any number of threads in any order, and returns when all have returned. Tasks that it
	/// does not run are then run one by one. lw_cloud_insert() gives it the rays, lw_cloud_scene() the shapes; no answer depends on it. The
	/// allocator must be thread-safe. NULL: all tasks run on the calling thread.
	void ( *parallel )( void* user, void ( *task )( void* context, uint32_t index ), void* context, uint32_t count );
	void* parallel_user; ///< it has to live as long as the cloud
	uint32_t cookie;
} lw_cloud_def;

/// 1 cm, a box of 2 m around the origin, unseen voxels free, shadow 2 cm, no limit of jumps, 65,536 blocks.
LW_API lw_cloud_def lw_cloud_def_default( void );

/// An empty cloud: all voxels are unseen.
/// @return LW_OK, LW_ERROR_INVALID_DEF, LW_ERROR_INVALID_ARGUMENT (diag names it), LW_ERROR_OUT_OF_MEMORY
LW_API lw_status lw_cloud_create( const lw_cloud_def* def, const lw_allocator* allocator, lw_diag* diag,
	lw_cloud** out_cloud );
LW_API void lw_cloud_destroy( lw_cloud* cloud ); ///< NULL is ignored; scenes made of it stay valid

/// Points in memory, in the layout of sensor_msgs/PointCloud2: `height` rows of `width` points.
typedef struct lw_cloud_points
{
	const void* data;
	uint32_t width, height; ///< height 1: one list
	size_t point_step;      ///< bytes from a point to the next
	size_t row_step;        ///< bytes from a row to the next
	size_t offset[3];       ///< bytes from a point to its x, y, z
	bool is_double;         ///< float64; else float32
	bool is_swapped;        ///< bytes are in the other order than this machine's
	bool in_world;          ///< coordinates are in the world frame; else in the sensor's
} lw_cloud_points;

/// A depth image, in the layout of sensor_msgs/Image with 16UC1 or 32FC1. Pixel (u, v) at depth z is the point
/// ((u - cx) / fx, (v - cy) / fy, 1) z of the sensor's optical frame: x right, y down, z forward. No lens distortion.
typedef struct lw_cloud_depth
{
	const void* data;
	uint32_t width, height;
	size_t row_step;       ///< bytes from a row to the next
	bool is_float;         ///< float32; else uint16
	bool is_swapped;       ///< bytes are in the other order than this machine's
	double scale;          ///< metres of depth 1: 0.001 for millimetres, 1 for metres
	double fx, fy, cx, cy; ///< pixels
} lw_cloud_depth;

/// The measurements of one sensor at one time. Make it with lw_cloud_frame_default(), and set points or depth.
typedef struct lw_cloud_frame
{
	uint32_t sensor; ///< below LW_CLOUD_SENSORS
	double stamp;    ///< seconds on one clock of all sensors; above that of the sensor's frame before
	lw_transform world_from_sensor;
	double near, far; ///< metres, 0 <= near < far. Depths or, of points, distances from the sensor. Nearer ones say nothing
	bool trust_far;   ///< a depth beyond `far`, +infinity too, clears up to `far`. Else it says nothing
	bool clears;      ///< rays clear the voxels that they passed. Else points are added only
	lw_cloud_points points; ///< data NULL: none
	lw_cloud_depth depth;   ///< data NULL: none. One of both is set
	const lw_robot* robot;  ///< with objects in its hand: its own body is left out. NULL: nothing is left out
	const double* state;    ///< [variable_count] of the robot at the stamp
	uint32_t cookie;
} lw_cloud_frame;

LW_API lw_cloud_frame lw_cloud_frame_default( void );

/// Counts of one frame. Each of its points or pixels is in one of the first six.
typedef struct lw_cloud_report
{
	uint32_t inserted;     ///< points in voxels
	uint32_t not_measured; ///< NaN, zero or negative depth, infinite
	uint32_t out_of_range; ///< nearer than `near`, beyond `far`
	uint32_t outside;      ///< of the box
	uint32_t own;          ///< on the robot's own body
	uint32_t lost;         ///< no room: the cloud is not complete any more
	uint32_t added;        ///< voxels that became occupied
	uint32_t cleared;      ///< voxels that were occupied and became free
	uint32_t uncovered;    ///< voxels that were unseen and became free
} lw_cloud_report;

/// Takes a frame: first the points, then the rays. A voxel that this frame has hit is not cleared by it; nor is one that another sensor has hit
/// at a later stamp. Faults, each on the safe side:
/// * a stamp not above that of the sensor's frame before (late, or out of order), or a sensor that has jumped: LW_ERROR_STALE, nothing changes,
///   counted in lw_cloud_info. After a jump all frames are refused until lw_cloud_allow_jump(), or until the sensor is back;
/// * no points, or none that is measured: taken, clears nothing; NaN, zero, infinite: counted, such a ray clears nothing;
/// * no room for a block, or no memory: the other points are taken, LW_ERROR_OUT_OF_MEMORY; the cloud is incomplete, see lw_cloud_scene().
/// @param report nullable
/// @return LW_OK, LW_ERROR_STALE, LW_ERROR_INVALID_DEF, LW_ERROR_INVALID_ARGUMENT (pose, stamp, range, layout, state: nothing changes),
/// LW_ERROR_OUT_OF_MEMORY
/// Cost: core/docs/cloud.md has figures.
LW_API lw_status lw_cloud_insert( lw_cloud* cloud, const lw_cloud_frame* frame, lw_diag* diag, lw_cloud_report* report );

/// The next frame of this sensor may come from anywhere.
LW_API void lw_cloud_allow_jump( lw_cloud* cloud, uint32_t sensor );

/// State of a voxel.
typedef enum lw_cloud_voxel
{
	LW_VOXEL_UNSEEN = 0,
	LW_VOXEL_FREE = 1, ///< a cloud whose unseen voxels are free has unseen ones in their place
	LW_VOXEL_OCCUPIED = 2
} lw_cloud_voxel;

/// Gives the voxels of a box a state. Unseen and free: voxels wholly inside (to 1e-6 of a voxel). Occupied: all voxels that it meets.
/// @return LW_OK, LW_ERROR_INVALID_ARGUMENT (a number is not finite, min above max, state), LW_ERROR_OUT_OF_MEMORY (then incomplete)
LW_API lw_status lw_cloud_set_box( lw_cloud* cloud, const double box_min[3], const double box_max[3], lw_cloud_voxel state,
	lw_diag* diag );

/// Forgets occupied voxels whose last hit was before `stamp`: they are unseen again. Times are kept to a millisecond, rounded so
/// that a voxel stays longer, for 49 days from the first frame on; later hits never age. @return how many
LW_API uint32_t lw_cloud_forget_before( lw_cloud* cloud, double stamp );

/// Forgets everything, stamps and poses of sensors too. The cloud is complete again, and unseen.
LW_API void lw_cloud_clear( lw_cloud* cloud );

/// State of the voxel that a point is in. Outside of the box: UNSEEN.
LW_API lw_cloud_voxel lw_cloud_state( const lw_cloud* cloud, lw_vec3 point );

/// Centres of all voxels of a state, occupied or free, in the world frame, in a fixed order.
/// @param out [capacity][3], nullable with capacity 0
/// @return how many there are; it may exceed capacity: the first `capacity` are written
LW_API uint64_t lw_cloud_voxels( const lw_cloud* cloud, lw_cloud_voxel state, double* out, uint64_t capacity );

/// A scene: the objects of `base`, then one object of this name with all shapes of the cloud. Unchanged shapes are those of the scene
/// before, so that lw_checker_edit() finds them; checkers need room for them (lw_query_def::spare_shapes).
///
/// The object contains every point that was inserted and not removed since, and each such true point (off by sensor_error at most). No point of
/// the object is farther than lw_cloud_info::excess from an inserted point. With unseen_blocked it contains all unseen voxels, too.
/// @param base nullable: nothing but the cloud. It has no object of this name
/// @param name of the object, such as "cloud"; the same for all scenes of a cloud
/// @return LW_OK, LW_ERROR_STALE (the cloud is incomplete: some points are lost; lw_cloud_clear() and begin again, with more blocks),
/// LW_ERROR_INVALID_ARGUMENT, LW_ERROR_OUT_OF_MEMORY
/// Cost: of each changed shape of 32 x 32 x 32 voxels, and some ten nanoseconds per shape. core/docs/cloud.md has figures.
LW_API lw_status lw_cloud_scene( lw_cloud* cloud, const lw_scene* base, const char* name, lw_diag* diag,
	lw_scene** out_scene );

typedef struct lw_cloud_info
{
	double resolution;
	double box_min[3], box_max[3]; ///< metres, whole voxels
	bool unseen_blocked;
	bool complete;     ///< false: points were lost
	double excess;     ///< metres: sqrt(3) resolution + 2 sensor_error, and rounding. Clearances are lower by that at most
	double last_stamp; ///< the greatest of all sensors; -INFINITY: no frame
	uint64_t occupied; ///< voxels
	uint64_t frames, late, jumped; ///< frames that were taken; refused because late; refused because of a jump
	uint64_t lost;                 ///< points
	uint32_t blocks, most_blocks;
	uint32_t shapes;  ///< of the scene that was made last
	uint32_t rebuilt; ///< of these, made anew for it
	size_t bytes;     ///< of the cloud, without its shapes
} lw_cloud_info;

LW_API lw_cloud_info lw_cloud_get_info( const lw_cloud* cloud );

LW_EXTERN_C_END

#endif
