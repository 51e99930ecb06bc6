// SPDX-License-Identifier: BSD-3-Clause
// Collision shapes: triangle meshes; sets of points, spheres and boxes; primitives; half-spaces and planes.
//
// A mesh is a surface, unless it is declared solid: a body wholly inside a closed mesh does not touch it. Every other type
// except the plane is solid: a body inside touches it. Primitives are exact, not tessellated.
#ifndef LEEWAY_SHAPE_H
#define LEEWAY_SHAPE_H

#include "leeway/math.h"

LW_EXTERN_C_BEGIN

/// An immutable collision shape with its sphere tree. Reference counted (atomically); threads, robots and scenes may share
/// it. Make one shape per distinct mesh: instances only hold references.
typedef struct lw_shape lw_shape;

/// Values are stable. Dimensions are those of lw_primitive_def.
typedef enum lw_shape_type
{
	LW_SHAPE_MESH = 1,
	LW_SHAPE_POINTS = 2,
	LW_SHAPE_BOX = 3,        ///< dimensions x, y, z: full edge lengths, centred
	LW_SHAPE_SPHERE = 4,     ///< dimensions radius
	LW_SHAPE_CYLINDER = 5,   ///< dimensions radius, height; axis z, centred
	LW_SHAPE_CAPSULE = 6,    ///< dimensions radius, height between the two cap centres; axis z, centred
	LW_SHAPE_CONE = 7,       ///< dimensions radius, height; axis z, base at -height/2, apex at +height/2
	LW_SHAPE_SPHERES = 8,    ///< solid balls, each of its own radius
	LW_SHAPE_BOXES = 9,      ///< solid boxes along the axes of the shape frame
	LW_SHAPE_HALFSPACE = 10, ///< no dimensions: all points with z <= 0, solid
	LW_SHAPE_PLANE = 11      ///< no dimensions: z = 0, without thickness; both sides are free
} lw_shape_type;

LW_API const char* lw_shape_type_name( lw_shape_type type ); ///< "mesh", "points", "box", ...; "shape" if out of range

/// How the sphere of a tree node is fitted to the geometry under it.
typedef enum lw_sphere_fit
{
	LW_FIT_GREEDY = 1,  ///< contains the spheres of its children (Quinlan 1994)
	LW_FIT_COMPACT = 2, ///< contains the vertices under it: Algorithms 1 and 2 of Steinbach et al. 2006, mended
	LW_FIT_MINIMAL = 3  ///< smallest enclosing ball of the vertices under it (Welzl 1991)
} lw_sphere_fit;

/// How a sphere tree is built; a member of the defs below. lw_tree_def_default() returns the settings that measured fastest.
typedef struct lw_tree_def
{
	lw_sphere_fit fit;
	uint32_t leaf_size; ///< triangles per leaf, 1 to 8
	/// Metres. 0: a leaf bounds whole triangles. Above 0: tiles of at most this radius bound the triangles (Quinlan's leaf
	/// spheres; many more nodes, kept for comparison with the paper). Distances are those of the whole triangles either way.
	double tile_radius;
} lw_tree_def;

LW_API lw_tree_def lw_tree_def_default( void );

/// Input of lw_shape_create_mesh(). Make it with lw_mesh_def_default(); a zeroed def is rejected.
typedef struct lw_mesh_def
{
	const double* vertices; ///< [vertex_count][3], metres, mesh frame; copied
	uint32_t vertex_count;
	const uint32_t* indices; ///< [triangle_count][3]; winding does not matter; copied
	uint32_t triangle_count;
	double scale[3];       ///< applied to the vertices; non-zero, may be negative (mirror)
	double weld_tolerance; ///< metres, after scale; vertices closer than this may be merged. 0 = exact duplicates only
	/// The mesh bounds a solid: a point inside touches it, distance 0. After welding the mesh must be closed: an even number
	/// of triangles at every edge, usually two; winding does not matter. Several closed surfaces are several solids, also if
	/// one encloses another: an enclosed void counts as inside. Excludes tree.tile_radius.
	bool solid;
	lw_tree_def tree;
	uint32_t cookie; ///< set by lw_mesh_def_default(); do not touch
} lw_mesh_def;

LW_API lw_mesh_def lw_mesh_def_default( void );

/// Builds a mesh shape from any triangle soup: open, non-manifold, with duplicate and zero-area triangles. Zero-area
/// triangles are kept as segments or points of the surface. Welding moves no vertex by more than weld_tolerance.
/// Coordinates after scale are at most 1e9 m. Small coordinates are accepted, but distances below 1e-56 m may read as 0.
/// @param allocator NULL = malloc; stored in the shape
/// @param diag nullable; on LW_ERROR_BAD_GEOMETRY names the first non-finite or too large vertex, an out-of-range index,
/// an open edge of a solid mesh (index = its triangle), or "no triangles"
/// @param out_shape owned by the caller: lw_shape_release(). Set to NULL on failure.
/// @return LW_OK, LW_ERROR_INVALID_DEF, LW_ERROR_INVALID_ARGUMENT, LW_ERROR_BAD_GEOMETRY or LW_ERROR_OUT_OF_MEMORY
/// Cost: O(n log n) time; lw_shape_info gives the memory.
LW_API lw_status lw_shape_create_mesh( const lw_mesh_def* def, const lw_allocator* allocator, lw_diag* diag,
	lw_shape** out_shape );

/// A set of points, each the centre of a solid ball; all balls have the same radius (sensor clouds, equal spheres).
/// @param points [point_count][3], metres, shape frame; copied. @param radius metres, >= 0
/// @return as lw_shape_create_mesh()
LW_API lw_status lw_shape_create_points( const double* points, uint32_t point_count, double radius, const lw_tree_def* tree,
	const lw_allocator* allocator, lw_diag* diag, lw_shape** out_shape );

/// A set of solid balls of different radii: robots and objects given as spheres. Balls may overlap.
/// @param spheres [sphere_count][4]: x, y, z, radius; metres, shape frame; radii >= 0; copied
/// @return as lw_shape_create_mesh(); diag.index = sphere
LW_API lw_status lw_shape_create_spheres( const double* spheres, uint32_t sphere_count, const lw_tree_def* tree,
	const lw_allocator* allocator, lw_diag* diag, lw_shape** out_shape );

/// A set of solid axis-aligned boxes: occupied cells of an octree or grid, of any sizes. Boxes may overlap.
/// @param boxes [box_count][6]: least x, y, z, greatest x, y, z; metres, shape frame; least <= greatest; copied
/// @return as lw_shape_create_mesh(); diag.index = box
LW_API lw_status lw_shape_create_boxes( const double* boxes, uint32_t box_count, const lw_tree_def* tree,
	const lw_allocator* allocator, lw_diag* diag, lw_shape** out_shape );

/// A solid primitive (BOX, SPHERE, CYLINDER, CAPSULE, CONE), a HALFSPACE or a PLANE. A half-space and a plane are
/// unbounded: box and sphere of lw_shape_info are infinite. They may be obstacles, but not parts of a robot.
/// @param dimensions as listed at lw_shape_type; each from 1e-100 to 1e9 (capsule height: also 0); NULL if the type has none
/// @return LW_OK, LW_ERROR_INVALID_ARGUMENT (type), LW_ERROR_BAD_GEOMETRY (index = dimension) or LW_ERROR_OUT_OF_MEMORY
LW_API lw_status lw_shape_create_primitive( lw_shape_type type, const double dimensions[3], const lw_allocator* allocator,
	lw_diag* diag, lw_shape** out_shape );

/// A mesh that is read later; until then only its box is known. Make it with lw_deferred_def_default().
typedef struct lw_deferred_def
{
	double box_min[3], box_max[3]; ///< contains the mesh; shape frame, metres
	uint32_t triangle_count;       ///< lw_shape_peek_info() returns it until the mesh has been made
	/// Digest of the mesh from an earlier run, if known: lw_shape_digest() then need not make the mesh.
	bool has_digest;
	lw_digest digest;
	/// Makes the mesh: writes a reference to a shape from lw_shape_create_mesh() or from a blob to out_shape. The first
	/// thread that needs the mesh calls make; several threads may call it at the same time, and each must get the same
	/// geometry. After a failure the next thread that needs the mesh calls it again; after LW_OK no later thread calls it.
	lw_status ( *make )( void* user, lw_diag* diag, lw_shape** out_shape );
	void ( *release )( void* user ); ///< called once, when the last reference to the shape is dropped. Nullable
	void* user;
	uint32_t cookie;
} lw_deferred_def;

LW_API lw_deferred_def lw_deferred_def_default( void );

/// A mesh that is made when a query first comes near its box. A mesh out of every body's reach is never read and gets no
/// tree. It is used like any other mesh and gives the same answers. The first query near it calls make, which may read
/// files and allocate; lw_shape_complete() does that beforehand. If make fails, the query returns the status of make and no
/// distance.
/// @return LW_OK, LW_ERROR_INVALID_DEF, LW_ERROR_INVALID_ARGUMENT (no make), LW_ERROR_BAD_GEOMETRY (the box),
/// LW_ERROR_OUT_OF_MEMORY
LW_API lw_status lw_shape_create_deferred( const lw_deferred_def* def, const lw_allocator* allocator, lw_diag* diag,
	lw_shape** out_shape );

/// Makes a deferred mesh, if it has not been made. For other shapes it does nothing. Any thread may call it.
/// @return LW_OK, the status of make, or LW_ERROR_BAD_GEOMETRY (the mesh extends beyond the def's box)
LW_API lw_status lw_shape_complete( const lw_shape* shape, lw_diag* diag );

LW_API lw_shape* lw_shape_retain( const lw_shape* shape ); ///< adds a reference; NULL gives NULL
LW_API void lw_shape_release( lw_shape* shape );           ///< drops a reference; NULL is ignored

/// Digest of everything that determines a shape's answers: type, geometry, dimensions, tree. Makes a deferred mesh unless
/// its def has a digest; returns {0} if that fails.
LW_API lw_digest lw_shape_digest( const lw_shape* shape );

/// Contents and memory of a shape.
typedef struct lw_shape_info
{
	lw_shape_type type;
	uint32_t vertex_count;     ///< of a mesh, after welding; points; centres of spheres; two corners per box; else 0
	uint32_t triangle_count;   ///< of a mesh, else 0
	uint32_t degenerate_count; ///< zero-area triangles, kept
	uint32_t node_count;       ///< wide inner nodes of the sphere tree
	uint32_t leaf_count;
	uint32_t depth;                ///< inner levels; 0 for primitives
	size_t bytes;                  ///< everything the shape holds
	double box_min[3], box_max[3]; ///< axis-aligned bounds, shape frame, metres
	double sphere_center[3];       ///< bounding sphere, shape frame, metres
	double sphere_radius;
	double dimensions[3]; ///< of a primitive; radius of a point set, or of a coarser mesh, in [0]
	/// Metres, certified. Of a coarser shape (detail.h): no point of it is farther from its original than this. Else 0.
	double excess;
	uint32_t original_count; ///< triangles, points or balls; of a coarser shape those of its original
	bool solid;              ///< points inside touch it; meshes: lw_mesh_def.solid; planes: false; others: true
	bool deferred;           ///< not made yet: counts but triangle_count are 0; bounds are those of the def
} lw_shape_info;

/// Makes a deferred mesh. If that fails, the result is that of lw_shape_peek_info().
LW_API lw_shape_info lw_shape_get_info( const lw_shape* shape );
/// The same, but never makes a deferred mesh: check the member `deferred`.
LW_API lw_shape_info lw_shape_peek_info( const lw_shape* shape );

/// Vertices of a mesh or point set, centres of spheres, least and greatest corners of boxes: [vertex_count][3], owned by the
/// shape; NULL for primitives. Makes a deferred mesh; NULL if that fails.
LW_API const double* lw_shape_vertices( const lw_shape* shape );
/// Radii of LW_SHAPE_SPHERES: [vertex_count], owned by the shape; NULL for others.
LW_API const double* lw_shape_radii( const lw_shape* shape );
/// Triangles of a mesh: [triangle_count][3], owned by the shape; NULL for others. Makes a deferred mesh; NULL if that fails.
LW_API const uint32_t* lw_shape_triangles( const lw_shape* shape );

/// Spheres of one level of the sphere tree, shape frame. Level 0 is the bounding sphere. Level k holds the spheres of all nodes at
/// depth k, and those of leaves above it, so that each level contains the shape. Primitives have level 0 only, and return it for
/// every level. Deeper levels than lw_shape_info.depth equal the deepest one. Makes a deferred mesh.
/// @param out_spheres [capacity][4]: centre x, y, z and radius, metres; nullable with capacity 0
/// @return number of spheres of the level; it may exceed capacity: the first `capacity` are written. 0 for NULL, for half-spaces
/// and planes, and if a deferred mesh cannot be made
LW_API uint32_t lw_shape_level_spheres( const lw_shape* shape, uint32_t level, double* out_spheres, uint32_t capacity );

LW_EXTERN_C_END

#endif
