// SPDX-License-Identifier: BSD-3-Clause
// The parts of a shape. Built by shape/shape.c (with shape/mesh.c, shape/sphere_fit.c, shape/tree_build.c), read by the
// queries.
//
// Families. *Triangles*, possibly degenerate (segments, points), dilated by one radius: meshes (radius 0 but
// for coarser ones), capsules (one segment). *Balls*: point sets (one radius for all), spheres, sets of spheres (a radius
// each). *Boxes*: sets of axis-aligned boxes. *Convex*: a box, cylinder or cone, measured by distance/convex.c. *Unbounded*:
// a half-space or a plane. The first three have a sphere tree over their items; that of triangles is about the undilated
// geometry, that of balls and boxes about all of it.
#ifndef LEEWAY_SHAPE_SHAPE_H
#define LEEWAY_SHAPE_SHAPE_H

#include "base/base.h"
#include "leeway/shape.h"
#include "base/math_inline.h"
#include "simd/tree_layout.h"

LW_EXTERN_C_BEGIN

enum
{
	LWI_MAX_PARTS = 16,     ///< connected parts of a mesh that are known one by one
	LWI_EXTREME_BLOCKS = 8, ///< of the extreme points of a shape, at most
	LWI_MOST_CONVEX_VERTICES =
		LWI_MOST_CORNER_BLOCKS * LWI_WIDTH, ///< of meshes that are searched as one convex body: 10 bits number them
	LWI_DENSE_MESH = 256 ///< triangles from which a mesh has pieces: searches of fewer take no longer than planes of pieces
};

/// Flags of lw_shape.components, below the number of the component.
#define LWI_COMPONENT_FLIPPED 1u ///< this triangle is against the orientation of its component
#define LWI_COMPONENT_MIXED 2u   ///< the component has no orientation

typedef enum lwi_family
{
	LWI_TRIANGLES,
	LWI_BALLS,
	LWI_BOXES,
	LWI_CONVEX,
	LWI_UNBOUNDED
} lwi_family;

/// The family of a type; LWI_CONVEX for unknown types.
static inline lwi_family lwi_family_of( lw_shape_type type )
{
	switch ( type )
	{
	case LW_SHAPE_MESH:
	case LW_SHAPE_CAPSULE:
		return LWI_TRIANGLES;
	case LW_SHAPE_POINTS:
	case LW_SHAPE_SPHERE:
	case LW_SHAPE_SPHERES:
		return LWI_BALLS;
	case LW_SHAPE_BOXES:
		return LWI_BOXES;
	case LW_SHAPE_HALFSPACE:
	case LW_SHAPE_PLANE:
		return LWI_UNBOUNDED;
	case LW_SHAPE_BOX:
	case LW_SHAPE_CYLINDER:
	case LW_SHAPE_CONE:
		break;
	}
	return LWI_CONVEX;
}

/// The def of a mesh that is made at its first use, and the mesh.
typedef struct lwi_deferred
{
	lw_deferred_def def;
	LWI_ATOMIC( lw_shape* ) made; ///< NULL until then; a reference
} lwi_deferred;

/// A mesh that is the surface of a convex body. Its vertices are sorted, so that answers do not depend on the order of triangles.
typedef struct lwi_convex_mesh
{
	// of distances
	double reach;        ///< of the vertices, about the first of them
	lw_vec3 mean;        ///< of the vertices, about the first of them
	double* points;      ///< [vertex_count][3] sorted
	lwi_corners8* about; ///< [blocks] the same, about the first of them
	const struct lwi_kernels* kernels;
	uint32_t blocks;

	double excess;        ///< metres: the hull's boundary is no farther from the surface
	uint32_t* first;      ///< [vertex_count + 1] where a vertex' neighbours begin, the end last
	uint32_t* neighbours; ///< along edges, ascending
	uint32_t* triangles;  ///< of these edges, on one side
	uint16_t* corners;    ///< [item_count][3] points of the mesh's triangles
	uint32_t start[27];   ///< a vertex that is far along the directions of each cell of lwi_direction_cell()
	size_t bytes;         ///< of this and the arrays
} lwi_convex_mesh;

/// Vertex i of a convex mesh, about the first of them.
static inline lw_vec3 lwi_mesh_point( const lwi_convex_mesh* mesh, uint32_t i )
{
	const lwi_corners8* block = mesh->about + i / LWI_WIDTH;
	return lwi_v3( block->at[0][i % LWI_WIDTH], block->at[1][i % LWI_WIDTH], block->at[2][i % LWI_WIDTH] );
}

/// Vertices in place of a triangle: lwi_convex_mesh_triangle(). No triangle has such a number.
#define LWI_CORNERS 0x80000000u

/// The 27 cells of directions: in each coordinate well below, near or well above 0.
static inline uint32_t lwi_direction_cell( lw_vec3 n )
{
	const double most = 0.4142 * fmax( fabs( n.x ), fmax( fabs( n.y ), fabs( n.z ) ) );
	const uint32_t x = (uint32_t)( 1 + ( n.x > most ) - ( n.x < -most ) ),
				   y = (uint32_t)( 1 + ( n.y > most ) - ( n.y < -most ) );
	return 9 * x + 3 * y + (uint32_t)( 1 + ( n.z > most ) - ( n.z < -most ) );
}

/// Searches begin with the first two lines of memory, each 64 bytes; reference counts, which threads write, are in another.
struct lw_shape
{
	lw_shape_type type;
	lwi_family family;
	lwi_deferred* deferred; ///< NULL: the shape is complete. Else only its box, sphere and bytes are valid
	bool primitive;         ///< convex or unbounded: no items, no tree
	bool closed;            ///< declared solid: closed, and all points inside belong to it
	float extent;           ///< >= largest |p_tree| over all geometry, rounded up: scale of float rounding errors
	double radius;          ///< of a capsule, a sphere, all points of a set, a coarser mesh; else 0
	double sphere_center[3], sphere_radius; ///< bound of the whole shape, dilation included, shape frame

	/// Sphere tree, tree frame = shape frame shifted by origin: p_tree = p_shape - origin. Centre of the vertices' box.
	double origin[3];
	lwi_convex_mesh* convex; ///< of a convex mesh, else NULL
	// Triangles, balls, boxes: the original geometry in double, shape frame. Results are computed from it.
	double* vertices;  ///< [vertex_count][3]; least and greatest corner of box i are 2i and 2i + 1
	uint32_t* indices; ///< [item_count][3] of triangles, else NULL
	uint32_t vertex_count, item_count;
	double* radii; ///< [item_count] of LW_SHAPE_SPHERES, else NULL

	double dimensions[3]; ///< of primitives, as given; [0] of the radius of a set or mesh
	/// [item_count] number << 2 | flags; LW_INVALID_INDEX: degenerate. Of a mesh that is declared solid, or closed: depths count its
	/// inside, and distances only if it is declared. NULL: no inside.
	uint32_t* components;
	double box_min[3], box_max[3]; ///< of the whole shape, dilation included, shape frame
	lwi_ref root;                  ///< a node, or a leaf if everything fits into one
	float root_sphere[4];          ///< x, y, z, r: contains everything, tree frame
	uint32_t node_count, leaf_count, depth;
	lwi_node* nodes;
	lwi_obb8* obbs;             ///< [node_count] of triangles, else NULL
	lwi_leaf* leaves;           ///< of triangles
	lwi_ball_leaf* ball_leaves; ///< of balls
	lwi_box_leaf* box_leaves;   ///< of boxes
	lwi_points8* extreme_points;
	uint32_t extreme_blocks; ///< vertices of a bounded shape far along some directions, inside its convex hull; tree frame

	/// What is below each child of the root, of a dense mesh that is not solid: their hulls are apart where the whole's are
	/// not. A piece shares the whole's arrays and frame; root, sphere, box and extreme points are its own; it has no items.
	uint32_t piece_count; ///< 0: no pieces
	lw_shape* pieces;     ///< [piece_count]

	// Meshes only.
	uint32_t part_count;           ///< connected parts
	uint32_t parts[LWI_MAX_PARTS]; ///< a triangle of each, if there are no more than these
	uint32_t component_count;      ///< closed surfaces of a mesh that has an inside
	uint32_t degenerate_count;

	lwi_refcount references;
	uint32_t original_count; ///< items of the original; 0 if there is none
	double excess;           ///< metres: of a coarser shape, how far it may reach beyond the original
	lw_allocator allocator;
	size_t bytes;
};

/// Asks for the vertices of a convex mesh before they are needed.
static inline void lwi_fetch_corners( const lw_shape* shape )
{
#if defined( __GNUC__ )
	const lwi_convex_mesh* mesh = shape->convex;
	for ( uint32_t i = 0; mesh != NULL && i < mesh->blocks && i < 8; ++i )
	{
		__builtin_prefetch( mesh->about[i].at[0] );
		__builtin_prefetch( mesh->about[i].at[1] );
		__builtin_prefetch( mesh->about[i].at[2] );
	}
#endif
}

/// The mesh of a deferred shape, made now if needed. NULL with a status if that fails.
const lw_shape* lwi_shape_make( const lw_shape* shape, lw_status* out_status, lw_diag* diag );

/// The shape with its geometry, made now if it is deferred. NULL with a status if that fails.
static inline const lw_shape* lwi_shape_made( const lw_shape* shape, lw_status* out_status, lw_diag* diag )
{
	*out_status = LW_OK;
	return shape->deferred == NULL ? shape : lwi_shape_make( shape, out_status, diag );
}

/// The shape with its geometry if that is made already, else the shape as it is: bounds only.
const lw_shape* lwi_shape_now( const lw_shape* shape );

/// Lower bound of the distance of two shapes from their boxes alone, rounded down; 0 if they may touch.
double lwi_box_gap( const lw_shape* a, const lw_shape* b, const lw_transform* a_from_b );

/// lwi_box_gap() of two shapes at these poses if it is below a limit; INFINITY if it is not, or if one is unbounded.
static inline double lwi_box_gap_below( double limit, const lw_shape* a, const lw_shape* b, const lw_transform* world_from_a,
	const lw_transform* world_from_b )
{
	double sum_sq = 0;
	const lw_transform a_from_b = lwi_relative( world_from_a, world_from_b );
	for ( int i = 0; i < 3; ++i )
	{
		double center = a_from_b.t[i] - a->sphere_center[i];
		for ( int k = 0; k < 3; ++k )
		{
			center += a_from_b.r[i][k] * b->sphere_center[k];
		}
		sum_sq += center * center;
	}
	const double reach = a->sphere_radius + b->sphere_radius;
	if ( !( reach < INFINITY ) || !( sqrt( sum_sq ) - reach < limit ) )
	{
		return INFINITY;
	}
	const double gap = lwi_box_gap( a, b, &a_from_b );
	return gap < limit ? gap : INFINITY;
}

/// Deferred shapes that are needed next, for lw_checker_def::prepare.
enum
{
	LWI_PREFETCH_CAPACITY = 64
};

typedef struct lwi_prefetch
{
	void ( *prepare )( void* user, const lw_shape* const* shapes, uint32_t shape_count ); ///< NULL: nothing is noted
	void* user;
	const lw_shape* shapes[LWI_PREFETCH_CAPACITY];
	uint32_t count;
} lwi_prefetch;

/// Notes a deferred shape that has not been made; hands over the noted shapes when the list is full.
void lwi_prefetch_note( lwi_prefetch* prefetch, const lw_shape* shape );
/// Hands over the noted shapes, if there are at least two.
void lwi_prefetch_flush( lwi_prefetch* prefetch );

/// Radius of a ball, dilation of any other item.
static inline double lwi_item_radius( const lw_shape* shape, uint32_t item )
{
	return shape->radii != NULL ? shape->radii[item] : shape->radius;
}

/// Points whose balls (lwi_hull_radius()) have the same convex hull as a bounded shape, or one that contains it: vertices,
/// centres, corners of boxes; corners of the box around a convex primitive or a deferred mesh.
static inline size_t lwi_hull_count( const lw_shape* shape )
{
	bool one_box = shape->primitive || shape->deferred != NULL;
	return one_box ? 8 : shape->family == LWI_BOXES ? 8 * (size_t)shape->item_count : shape->vertex_count;
}
static inline lw_vec3 lwi_hull_point( const lw_shape* shape, size_t index )
{
	bool one_box = shape->primitive || shape->deferred != NULL;
	if ( !one_box && shape->family != LWI_BOXES )
	{
		return lwi_load( shape->vertices + 3 * index );
	}
	const double* low = one_box ? shape->box_min : shape->vertices + 6 * ( index / 8 );
	const double* high = one_box ? shape->box_max : low + 3;
	return lwi_v3( index & 1 ? high[0] : low[0], index & 2 ? high[1] : low[1], index & 4 ? high[2] : low[2] );
}
static inline double lwi_hull_radius( const lw_shape* shape, size_t index )
{
	return shape->radii != NULL ? shape->radii[index] : shape->radius;
}

// Steps of making a shape.

/// An empty shape with one reference, or NULL.
lw_shape* lwi_shape_new( lw_shape_type type, const lw_allocator* allocator );

/// From the items: the box, the origin of the tree frame in its centre (of triangles without the dilation), the extent.
void lwi_shape_set_frame( lw_shape* shape );

/// The last step, after tree and root sphere: the bounds and the bytes.
void lwi_shape_finish( lw_shape* shape );

/// The oriented boxes (OBBs) of a tree of triangles, found from its nodes and leaves. The tree is valid.
/// @return LW_OK or LW_ERROR_OUT_OF_MEMORY
lw_status lwi_shape_find_obbs( lw_shape* shape, lw_diag* diag );

/// The extreme points of a bounded shape whose tree, if it has one, is valid, and its pieces.
/// @return LW_OK or LW_ERROR_OUT_OF_MEMORY
lw_status lwi_shape_find_extreme_points( lw_shape* shape, lw_diag* diag );

/// The same along a third of the directions, for shapes that are one of many and often made anew. Not of meshes.
lw_status lwi_shape_find_few_extreme_points( lw_shape* shape, lw_diag* diag );

void lwi_shape_free_extreme_points( lw_shape* shape ); ///< and its pieces

/// Fills `convex` of a mesh that is convex. Cost: O(vertices triangles), of meshes that are closed and of few vertices.
/// @return LW_OK, also for other meshes, or LW_ERROR_OUT_OF_MEMORY
lw_status lwi_shape_find_convexity( lw_shape* shape, lw_diag* diag );

/// A triangle of a convex mesh that a point of its surface is on, to rounding. Cost: of the triangles around `near`, if it is on one
/// of these, else O(triangles). @param near a triangle, or LWI_CORNERS and the three vertices that the point is between, equal ones
/// included, from the lowest 10 bits up
uint32_t lwi_convex_mesh_triangle( const lw_shape* shape, lw_vec3 point, uint32_t near );

/// All steps, for a shape whose vertices, indices, radii and counts are set.
lw_status lwi_shape_build( lw_shape* shape, const lw_tree_def* def, lw_diag* diag );

/// lw_shape_create_mesh() for a surface that is `radius` thick.
lw_status lwi_mesh_shape( const lw_mesh_def* def, double radius, const lw_allocator* allocator, lw_diag* diag,
	lw_shape** out_shape );

/// Checks the tree's invariants: every node sphere contains all the geometry under it, every triangle is in a leaf.
/// @return LW_OK; LW_ERROR_BAD_GEOMETRY with the first offending node in diag (a bug of this library, or a damaged blob);
/// LW_ERROR_INVALID_ARGUMENT for NULL; LW_ERROR_OUT_OF_MEMORY (it allocates one mark per triangle)
lw_status lwi_shape_validate( const lw_shape* shape, lw_diag* diag );

lw_status lwi_check_tree_def( const lw_tree_def* def, lw_diag* diag );

LW_EXTERN_C_END

#endif
