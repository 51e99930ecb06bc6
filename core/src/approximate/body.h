// SPDX-License-Identifier: BSD-3-Clause
// The inside of a body made of triangle soups: which points its closed shells enclose, and how deep they lie.
//
// A *shell* is a set of triangles that hang together by edges. It is closed if each of its edges belongs to an even number
// of its triangles: then every path from a point that a ray finds inside (an odd number of crossings) to infinity meets it.
// A point is *enclosed* if some closed shell has it inside. Derivations: core/docs/detail.md.
#ifndef LEEWAY_APPROXIMATE_BODY_H
#define LEEWAY_APPROXIMATE_BODY_H

#include "base/base.h"
#include "leeway/shape.h"

LW_EXTERN_C_BEGIN

/// One shape of a body.
typedef struct lwi_body_part
{
	const lw_shape* shape;
	lw_transform body_from_shape;
} lwi_body_part;

struct lwi_ray_grid;

typedef struct lwi_body
{
	lw_allocator memory;
	/// All triangles, welded where corners are equal; index = the order of the parts.
	lw_shape* surface;
	uint32_t triangle_count;
	double* dilation; ///< [triangle_count]: each triangle is the core of all points this near to it
	double dilation_max;
	bool* solid; ///< [triangle_count]: of a solid (primitive or mesh), whose inside is geometry too
	bool any_solid;
	/// Closed shells with the caps that close their holes, and the part of them that is not inside another shell. NULL:
	/// none.
	lw_shape* closed;
	lw_shape* outer;
	uint32_t* shell; ///< [triangle_count of closed]
	uint32_t shell_count;
	bool* shell_solid;       ///< [shell_count]
	uint32_t open_shells;    ///< shells that stay open
	uint32_t holes;          ///< closed by caps
	double widest_hole;      ///< metres, of those closed: the diagonal of its box
	double widest_open_hole; ///< metres, of the open ones; 0 if there is none
	uint32_t hidden;         ///< triangles of closed shells that are partly or wholly inside of others
	struct lwi_ray_grid* grids;
	uint8_t* parity;         ///< [shell_count], scratch, zero between calls
	uint32_t inside_shell;   ///< the shell that lwi_body_encloses() found
	double chord;            ///< metres: by how much prisms around cylinders and cones stand out
	double extent;           ///< largest |coordinate| of any vertex
	double slack;            ///< metres: largest error of a computed distance or position of a vertex
	bool ( *stop )( void* ); ///< ends searches; NULL: nothing does
	void* user;              ///< given to stop
	uint32_t calls;          ///< of lwi_body_stopped()
	bool stopped;            ///< stop has returned true
} lwi_body;

/// @param close_holes metres: caps close the holes of a shell if each is at most this wide
/// @param grain metres, >= 0: depths that are too small by less than that do no harm, which saves time. 0: as exact as it
/// gets
/// @param stop, user see lwi_body: once stopped, the search for hidden parts counts all undecided parts as visible
/// @return LW_OK, LW_ERROR_BAD_GEOMETRY or LW_ERROR_OUT_OF_MEMORY; *out is zeroed on failure
lw_status lwi_body_create( const lwi_body_part* parts, uint32_t part_count, double close_holes, double grain,
	bool ( *stop )( void* ), void* user, const lw_allocator* allocator, lw_diag* diag, lwi_body* out );
void lwi_body_free( lwi_body* body );

/// True once body->stop has returned true (called at every 16th call). The work in progress then fails.
bool lwi_body_stopped( lwi_body* body );

/// Nearest triangle of a mesh shape to a point of its frame.
typedef struct lwi_nearest
{
	double distance; ///< +inf if nothing is nearer than `stop`
	uint32_t triangle;
	lw_vec3 point;
} lwi_nearest;

/// @param stop nothing at or beyond it is of interest
/// @param certified distances by lwi_tri_tri (error: LWI_TRI_TRI_ERROR of the extents), otherwise about 5 times faster
/// @param group [triangle_count]: visits only triangles with group[triangle] == of; NULL: all of them
lwi_nearest lwi_shape_nearest( const lw_shape* shape, lw_vec3 p, double stop, bool certified, const uint32_t* group,
	uint32_t of );

/// True if some triangle is (by the fast distance) nearer than that.
bool lwi_shape_is_near( const lw_shape* shape, lw_vec3 p, double distance );
/// As lwi_shape_is_near(), of the triangles whose group is another than `of`.
bool lwi_shape_is_near_but( const lw_shape* shape, lw_vec3 p, double distance, const uint32_t* group, uint32_t of );

/// True if a closed shell is proved to have p inside. False if none has, or rounding leaves it open.
bool lwi_body_encloses( lwi_body* body, lw_vec3 p );

/// Signed depth s of a point: each ball about p of radius r protrudes from the body by at most r - s. That is, no point
/// of the ball that is outside of the body is farther than r - s from the body's surface. Positive inside: the distance to
/// the outer surface; negative outside: minus the distance to the surface.
/// @param certified rounding is taken off; otherwise a fast estimate for searches
double lwi_body_depth( lwi_body* body, lw_vec3 p, bool certified );

LW_EXTERN_C_END

#endif
