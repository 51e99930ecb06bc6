// SPDX-License-Identifier: BSD-3-Clause
// NEON kernels, part of the baseline of every 64-bit ARM machine.
#include "simd/kernels.h"

#if defined( __aarch64__ ) && defined( __ARM_NEON )
#include "simd/simd_neon.h"

#define LWI_KERNELS lwi_kernels_neon
#define LWI_KERNELS_LEVEL LW_SIMD_NEON
#include "simd/kernels_impl.h"
#else
typedef int lwi_no_neon; // not an empty translation unit
#endif
