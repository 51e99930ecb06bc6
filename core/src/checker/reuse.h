// SPDX-License-Identifier: BSD-3-Clause
// The parts that a checker can take over from an earlier one. Design: core/docs/edits.md.
#ifndef LEEWAY_CHECKER_REUSE_H
#define LEEWAY_CHECKER_REUSE_H

#include "checker/culling.h"

LW_EXTERN_C_BEGIN

/// Where each shape of `scene` is in `previous`: the same shape at the same pose, to the bit. Scenes that were edited in a
/// few places are recognised; other shapes get LW_INVALID_INDEX and are measured again.
/// @param source [shape_count of scene], written. Scenes may be NULL
void lwi_match_scenes( const lw_scene* previous, const lw_scene* scene, uint32_t* source );

/// Takes over the static environment of an earlier checker as far as it holds.
/// @param fresh [scene_block_count] zero; gets the bits of shapes that may be nearer and are yet to be measured
/// @return false if everything has to be measured
bool lwi_reuse_static( lw_checker* checker, const lwi_reuse* reuse, uint8_t* fresh );

LW_EXTERN_C_END

#endif
