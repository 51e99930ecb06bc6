// SPDX-License-Identifier: BSD-3-Clause
// The steps of enclosing a body with spheres: fragments to cover, candidates, cover, refinement, check. Each step fails as if
// memory had run out when the search is stopped (lwi_body_stopped()).
#ifndef LEEWAY_APPROXIMATE_ENCLOSE_H
#define LEEWAY_APPROXIMATE_ENCLOSE_H

#include "approximate/body.h"
#include "base/grow.h"
#include "leeway/spheres.h"

LW_EXTERN_C_BEGIN

/// A fragment of a triangle (or of a solid's inside): a sphere covers it if it contains its corners.
typedef struct lwi_fragment
{
	lw_vec3 corner[3];
	lw_vec3 center;
	double size; ///< from the centre to the farthest corner
	double dilation;
	double weight; ///< weight in the cover: its area
} lwi_fragment;

/// A centre, and how deep it lies: a sphere about it of radius r has an excess of at most r - depth.
typedef struct lwi_site
{
	lw_vec3 center;
	double depth;
} lwi_site;

/// A k-d tree over the centres of fragments.
typedef struct lwi_fragment_tree
{
	lwi_fragment* fragments; ///< [count], reordered
	uint32_t count;
	struct lwi_fragment_node* nodes;
	uint32_t node_count;
} lwi_fragment_tree;

/// Fragments so small, and sites so many, that each fragment is covered by the sphere of some site with the wanted excess.
/// fragments: lwi_fragment; sites: lwi_site. Some site covers each fragment.
lw_status lwi_enclose_fragments( lwi_body* body, double excess, lwi_array* fragments, lwi_array* sites, lw_diag* diag );

/// Reorders the fragments. @return false if out of memory
bool lwi_fragment_tree_create( lwi_fragment* fragments, uint32_t count, const lw_allocator* memory, lwi_fragment_tree* out );
void lwi_fragment_tree_free( lwi_fragment_tree* tree, const lw_allocator* memory );
/// Indices of all fragments that the sphere covers, into `out` (uint32_t, emptied first). @return false if out of memory
bool lwi_fragment_tree_covered( const lwi_fragment_tree* tree, lw_vec3 center, double radius, const lw_allocator* memory,
	lwi_array* out );
/// Farthest point of a fragment from a centre, dilation included.
double lwi_fragment_reach( const lwi_fragment* fragment, lw_vec3 center );

/// Few of the sites whose spheres of the given excess cover all fragments, into `chosen` (lwi_site).
lw_status lwi_enclose_cover( lwi_body* body, const lwi_fragment_tree* tree, const lwi_site* sites, size_t site_count,
	double excess, lwi_array* chosen );

/// Moves the sites so that the excess they need becomes small. @return that excess (the larger of all), or -1: out of memory
double lwi_enclose_refine( lwi_body* body, const lwi_fragment_tree* tree, lwi_array* chosen, double excess,
	uint32_t rounds );

/// The spheres (double[4], appended) that the sites need for the fragments nearest to them, larger by margin.
bool lwi_enclose_spheres( lwi_body* body, const lwi_fragment_tree* tree, lwi_array* chosen, double excess, double margin,
	lwi_array* spheres );

/// Walks through the inside of the solids of a body whose surface is covered with at least this margin. With excess > 0 a
/// sphere of that excess is appended wherever there is a void; with 0 nothing is, and *gap says how far the centre of the
/// void that was met first is from the spheres, *at where.
/// @return 1 no void is open, 0 some void is, -1 out of memory
int lwi_enclose_voids( lwi_body* body, lwi_array* spheres, double margin, double excess, double* gap, lw_vec3* at );

/// Spheres (double[4], appended) by formulas for the shapes of a body, of at most `excess`. lwi_enclose_check() finds the
/// parts that they miss or exceed.
/// @param margin how much deeper than just enough the surface is to lie in them
/// @param made false: some shape is no box, cylinder, capsule or sphere, or takes too many
lw_status lwi_enclose_forms( lwi_body* body, const lw_geometry_def* def, double excess, double margin, lwi_array* out,
	bool* made );

/// Proves that spheres contain a box or cylinder whole. @return 1 proved, 0 not, -1 out of memory or stopped
int lwi_enclose_solid( lwi_body* body, const lw_shape* shape, const lw_transform* pose, const double* spheres,
	uint32_t count );

/// Report of spheres against a body; see lw_spheres_check(). @param def the def from which the body was made
lw_status lwi_enclose_check( lwi_body* body, const lw_geometry_def* def, const double* spheres, uint32_t count,
	lw_diag* diag, lw_spheres_report* out );

LW_EXTERN_C_END

#endif
