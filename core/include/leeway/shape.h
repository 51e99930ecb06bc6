// SPDX-License-Identifier: BSD-3-Clause
// Collision shapes: triangle meshes; sets of points, spheres and boxes; primitives; half-spaces and planes.
//
// Meshes are surfaces (a body wholly inside a closed mesh does not touch it) unless they are declared solid. Everything else but
// the plane is solid: whatever is inside touches it. No primitive is tessellated.
#ifndef LEEWAY_SHAPE_H
#define LEEWAY_SHAPE_H

#include "leeway/math.h"

LW_EXTERN_C_BEGIN

/// An immutable collision shape and its hierarchy, reference counted (atomically); shared freely by threads, robots,
/// scenes. One shape per distinct mesh: its instances only hold references.
typedef struct lw_shape lw_shape;

/// Values are stable. Dimensions are those of lw_primitive_def.
typedef enum lw_shape_type
{
	LW_SHAPE_MESH = 1,
	LW_SHAPE_POINTS = 2,
	LW_SHAPE_BOX = 3,      ///< dimensions x, y, z: full edge lengths, centred
	LW_SHAPE_SPHERE = 4,   ///< dimensions radius
	LW_SHAPE_CYLINDER = 5, ///< dimensions radius, height; axis z, centred
	LW_SHAPE_CAPSULE = 6,  ///< dimensions radius, height between the two cap centres; axis z, centred
	LW_SHAPE_CONE = 7,     ///< dimensions radius, height; axis z, base at -height/2, apex at +height/2
	LW_SHAPE_SPHERES = 8,  ///< solid balls, each of its own radius
	LW_SHAPE_BOXES = 9,    ///< solid boxes along the axes of the shape frame
	LW_SHAPE_HALFSPACE = 10, ///< no dimensions: everything at z <= 0, solid
	LW_SHAPE_PLANE = 11    ///< no dimensions: z = 0, without thickness; both sides are free
} lw_shape_type;

LW_API const char* lw_shape_type_name( lw_shape_type type ); ///< "mesh", "points", "box", ...; "shape" for another number

/// How the sphere of a tree node is fitted to the geometry under it.
typedef enum lw_sphere_fit
{
	LW_FIT_GREEDY = 1,  ///< contains the spheres of its children (Quinlan 1994)
	LW_FIT_COMPACT = 2, ///< contains the vertices under it: Algorithms 1 and 2 of Steinbach et al. 2006, mended
	LW_FIT_MINIMAL = 3  ///< smallest enclosing ball of the vertices under it (Welzl 1991)
} lw_sphere_fit;

/// How a tree is built. Part of the defs below; lw_tree_def_default() gives the measured best.
typedef struct lw_tree_def
{
	lw_sphere_fit fit;
	uint32_t leaf_size; ///< triangles per leaf, 1 to 8
	/// 0: a leaf bounds whole triangles. Above 0, metres: triangles are bounded by tiles of at most this radius (Quinlan's
	/// leaf spheres; many more nodes, kept for comparison with the paper). Distances are those of the whole triangles.
	double tile_radius;
} lw_tree_def;

LW_API lw_tree_def lw_tree_def_default( void );

/// What lw_shape_create_mesh() needs. Make it with lw_mesh_def_default(); a zeroed def is rejected.
typedef struct lw_mesh_def
{
	const double* vertices;  ///< [vertex_count][3], metres, mesh frame; copied
	uint32_t vertex_count;
	const uint32_t* indices; ///< [triangle_count][3]; winding does not matter; copied
	uint32_t triangle_count;
	double scale[3];         ///< applied to the vertices; non-zero, may be negative (mirror)
	double weld_tolerance;   ///< metres, after scale; vertices closer than this may be merged. 0 = exact duplicates only
	/// The mesh is the boundary of a solid: whatever is inside touches it, distance 0. It must be closed after welding: an even
	/// number of triangles at every edge, two as a rule; winding does not matter. Several closed surfaces are several solids,
	/// also one inside of the other: a void that is enclosed on all sides counts as inside. Not with tree.tile_radius.
	bool solid;
	lw_tree_def tree;
	uint32_t cookie;         ///< set by lw_mesh_def_default(); do not touch
} lw_mesh_def;

LW_API lw_mesh_def lw_mesh_def_default( void );

/// Builds a mesh shape from any triangle soup: open, non-manifold, with duplicate and zero-area triangles (kept: they are
/// segments or points of the surface). Welding moves no vertex by more than weld_tolerance.
/// @param allocator NULL = malloc; remembered by the shape
/// Coordinates after scale are at most 1e9 m: products of four lengths must fit a float. They may be as small as they like, but
/// distances below 1e-56 m are not told from 0.
/// @param diag on LW_ERROR_BAD_GEOMETRY names the first non-finite or too large vertex, out-of-range index, an open edge of a
/// solid mesh (index = its triangle), or "no triangles". Nullable.
/// @param out_shape owned by the caller: lw_shape_release(). Set to NULL on failure.
/// @return LW_OK, LW_ERROR_INVALID_DEF, LW_ERROR_INVALID_ARGUMENT, LW_ERROR_BAD_GEOMETRY or LW_ERROR_OUT_OF_MEMORY
/// Cost: O(n log n) time; see lw_shape_info for memory.
LW_API lw_status lw_shape_create_mesh( const lw_mesh_def* def, const lw_allocator* allocator, lw_diag* diag,
	lw_shape** out_shape );

/// A set of points, each the centre of a solid ball of one radius (sensor clouds, user-given spheres of equal size).
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

/// A solid primitive (BOX, SPHERE, CYLINDER, CAPSULE, CONE), a HALFSPACE or a PLANE. The last two have no bounds: box and
/// sphere of lw_shape_info are infinite. They may be obstacles, not parts of a robot.
/// @param dimensions as listed at lw_shape_type; each from 1e-100 to 1e9 (a capsule's height may be 0); NULL if there are none
/// @return LW_OK, LW_ERROR_INVALID_ARGUMENT (type), LW_ERROR_BAD_GEOMETRY (index = dimension) or LW_ERROR_OUT_OF_MEMORY
LW_API lw_status lw_shape_create_primitive( lw_shape_type type, const double dimensions[3], const lw_allocator* allocator,
	lw_diag* diag, lw_shape** out_shape );

/// A mesh of which only a box is known until a query needs more. Make it with lw_deferred_def_default().
typedef struct lw_deferred_def
{
	double box_min[3], box_max[3]; ///< contains the mesh; shape frame, metres
	uint32_t triangle_count;       ///< what lw_shape_peek_info() says until the mesh is there
	/// Of the mesh (lw_shape_digest()), if it is known from an earlier run: lw_shape_digest() then need not make it.
	bool has_digest;
	lw_digest digest;
	/// Makes the mesh: a reference to a shape of lw_shape_create_mesh() or a blob goes to out_shape. Called by whichever thread
	/// needs it first, by several at once where they meet there; each gets the same geometry. Until it is LW_OK it is called again
	/// whenever the mesh is needed. Once it was LW_OK it is not called any more by those who come later.
	lw_status ( *make )( void* user, lw_diag* diag, lw_shape** out_shape );
	void ( *release )( void* user ); ///< called once, with the last reference to the shape. Nullable
	void* user;
	uint32_t cookie;
} lw_deferred_def;

LW_API lw_deferred_def lw_deferred_def_default( void );

/// A mesh that is made when a query first gets near it: what is out of everybody's reach is never read, and gets no tree. It is
/// used like any other mesh, and answers are the same. The first query near it pays for it: it calls make, which may read files
/// and take memory; lw_shape_complete() does that beforehand. Where make fails, whoever needed the mesh gets its status, and
/// no distance.
/// @param out_shape owned by the caller: lw_shape_release(). Set to NULL on failure; def->release is then not called.
/// @return LW_OK, LW_ERROR_INVALID_DEF, LW_ERROR_INVALID_ARGUMENT (no make), LW_ERROR_BAD_GEOMETRY (the box), LW_ERROR_OUT_OF_MEMORY
LW_API lw_status lw_shape_create_deferred( const lw_deferred_def* def, const lw_allocator* allocator, lw_diag* diag,
	lw_shape** out_shape );

/// Makes a deferred mesh that is not there yet; for other shapes there is nothing to do. From any thread.
/// @return LW_OK, what make returned, or LW_ERROR_BAD_GEOMETRY (the mesh reaches beyond the box that was told)
LW_API lw_status lw_shape_complete( const lw_shape* shape, lw_diag* diag );

LW_API lw_shape* lw_shape_retain( const lw_shape* shape ); ///< adds a reference; NULL gives NULL
LW_API void lw_shape_release( lw_shape* shape );           ///< drops a reference; NULL is ignored

/// Digest of all that a shape's answers depend on: type, geometry, dimensions, tree. Makes a deferred mesh whose digest was not
/// told; {0} if that fails.
LW_API lw_digest lw_shape_digest( const lw_shape* shape );

/// What a shape is made of and costs.
typedef struct lw_shape_info
{
	lw_shape_type type;
	uint32_t vertex_count;     ///< of a mesh after welding; points; centres of spheres; corners of boxes, two each; else 0
	uint32_t triangle_count;   ///< of a mesh, else 0
	uint32_t degenerate_count; ///< zero-area triangles, kept
	uint32_t node_count;       ///< wide inner nodes of the sphere tree
	uint32_t leaf_count;
	uint32_t depth;            ///< inner levels; 0 for primitives
	size_t bytes;              ///< everything the shape holds
	double box_min[3], box_max[3]; ///< axis-aligned bounds, shape frame, metres
	double sphere_center[3];       ///< bounding sphere, shape frame, metres
	double sphere_radius;
	double dimensions[3];          ///< of a primitive; radius of a point set, or of a coarser mesh, in [0]
	/// Of a coarser shape (detail.h): metres, certified: none of its points is farther from the shape it stands for. Else 0.
	double excess;
	uint32_t original_count;       ///< triangles, points or balls of the shape it stands for; else those it has
	bool solid;                    ///< whatever is inside touches it: of a mesh lw_mesh_def.solid, of all others but planes true
	bool deferred;                 ///< not made yet: counts but for triangles are 0, the bounds are those of the box that was told
} lw_shape_info;

/// Makes a deferred mesh; if that fails, as lw_shape_peek_info().
LW_API lw_shape_info lw_shape_get_info( const lw_shape* shape );
/// The same without making anything: `deferred` tells if there is more to know.
LW_API lw_shape_info lw_shape_peek_info( const lw_shape* shape );

/// Vertices of a mesh or point set, centres of spheres, least and greatest corners of boxes: [vertex_count][3], owned by the
/// shape; NULL for primitives. Makes a deferred mesh; NULL if that fails.
LW_API const double* lw_shape_vertices( const lw_shape* shape );
/// Radii of LW_SHAPE_SPHERES: [vertex_count], owned by the shape; NULL for others.
LW_API const double* lw_shape_radii( const lw_shape* shape );
/// Triangles of a mesh: [triangle_count][3], owned by the shape; NULL for others. Makes a deferred mesh; NULL if that fails.
LW_API const uint32_t* lw_shape_triangles( const lw_shape* shape );

/// Checks the tree's invariants: every node sphere contains all the geometry under it, every triangle is in a leaf.
/// @return LW_OK; LW_ERROR_BAD_GEOMETRY with the first offending node in diag (a bug of this library);
/// LW_ERROR_INVALID_ARGUMENT for NULL; LW_ERROR_OUT_OF_MEMORY (it keeps a mark per triangle)
LW_API lw_status lw_shape_validate( const lw_shape* shape, lw_diag* diag );

LW_EXTERN_C_END

#endif
