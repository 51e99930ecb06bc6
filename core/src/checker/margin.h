// SPDX-License-Identifier: BSD-3-Clause
// Margins of pairs in a checker: the given ones, exact, and rounded rows for whole blocks of pairs.
//
// Margins are made of parts, so that a robot of 100 links among 1,000 objects takes 1,100 numbers and not 100,000: links'
// parts are added to radii before gaps are computed, objects' parts are taken off a row of gaps behind it, listed pairs have
// rows of their own. Derivation: core/docs/margins.md.
#ifndef LEEWAY_CHECKER_MARGIN_H
#define LEEWAY_CHECKER_MARGIN_H

#include "base/base.h"
#include "leeway/checker.h"

LW_EXTERN_C_BEGIN

/// Pairs with a margin of their own, ascending by a, then b; of self pairs a < b.
typedef struct lwi_listed_margins
{
	lw_pair_margin* pairs; ///< [count]
	uint32_t count;
} lwi_listed_margins;

/// Between links: kept by the base of checkers.
typedef struct lwi_self_margins
{
	lw_allocator allocator;
	size_t bytes;
	uint32_t link_count;
	double all;
	double* link; ///< [link_count]
	lwi_listed_margins listed;
	double largest; ///< of all pairs, or more
} lwi_self_margins;

/// Between links and objects: each checker's own, because objects are its scene's.
typedef struct lwi_margins
{
	lw_allocator allocator;
	size_t bytes;
	uint32_t link_count, object_count, body_count, cluster_count, row_size;
	double all;
	double* link;   ///< [link_count]
	double* object; ///< [object_count]
	lwi_listed_margins listed;
	double largest; ///< of all pairs, or more
	// for queries
	double* bodies; ///< [body_count] all + link
	double*
		clusters;   ///< [2 * cluster_count] largest of a cluster's bodies, then of its subtree's, but for the objects' parts
	float* objects; ///< [row_size] of each scene shape its object's part, rounded up; NULL if all are 0
	const float** body_row; ///< [body_count] addends of a body's margin by shape: `objects`, a row of `rows`, or NULL
	float* rows;            ///< rows of bodies in listed pairs, rounded up
	size_t row_bytes;
} lwi_margins;

/// Copies the margins of self pairs. *out_margins is NULL if all of them are 0.
/// @return LW_ERROR_INVALID_ARGUMENT (diag names the entry), LW_ERROR_OUT_OF_MEMORY
lw_status lwi_self_margins_create( const lw_margins* def, const lw_robot* robot, const lw_allocator* allocator,
	lw_diag* diag, lwi_self_margins** out_margins );
void lwi_self_margins_destroy( lwi_self_margins* margins );                          ///< NULL is ignored
bool lwi_self_margins_equal( const lwi_self_margins* x, const lwi_self_margins* y ); ///< either may be NULL

/// The margins of a checker with its base, scene and masks. *out_margins is NULL if all of them are 0.
/// @return as above
lw_status lwi_margins_create( const lw_margins* def, const struct lw_checker* checker, lw_diag* diag,
	lwi_margins** out_margins );
void lwi_margins_destroy( lwi_margins* margins ); ///< NULL is ignored

double lwi_margin_to_object( const lwi_margins* margins, uint32_t link, uint32_t object );
double lwi_margin_of_links( const lwi_self_margins* margins, uint32_t link_a, uint32_t link_b );

/// Takes margins off gaps, rounded down. @param row NULL = none
static inline void lwi_subtract_margins( float* gaps, const float* row, uint32_t count )
{
	for ( uint32_t i = 0; row != NULL && i < count; ++i )
	{
		float less = gaps[i] - row[i]; // to half a roundoff; so is the product. Infinities and NaN stay
		gaps[i] = less * ( less < 0 ? 1 + 0x1p-22f : 1 - 0x1p-22f );
	}
}

LW_EXTERN_C_END

#endif
