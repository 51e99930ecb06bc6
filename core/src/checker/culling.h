// SPDX-License-Identifier: BSD-3-Clause
// The obstacles that a group can come near to. Derivation: core/docs/required.md.
#ifndef LEEWAY_CHECKER_CULLING_H
#define LEEWAY_CHECKER_CULLING_H

#include "checker/checker.h"

LW_EXTERN_C_BEGIN

/// Results of an earlier checker of a similar scene.
typedef struct lwi_reuse
{
	const lw_checker* previous; ///< NULL = none
	uint32_t* source;           ///< [shape_count] the same shape at the same pose in the previous scene, or LW_INVALID_INDEX
} lwi_reuse;

/// Fills checker->culling. For a checker with its base, its masks and its nearest static pair.
void lwi_checker_cull( lw_checker* checker, const lwi_reuse* reuse );

LW_EXTERN_C_END

#endif
