// SPDX-License-Identifier: BSD-3-Clause
// SSE2 kernels, part of the baseline of every x86-64 machine.
#include "simd/kernels.h"

#if defined( __SSE2__ )
#include "simd/simd_sse2.h"

#define LWI_KERNELS lwi_kernels_sse2
#define LWI_KERNELS_LEVEL LW_SIMD_SSE2
#include "simd/kernels_impl.h"
#else
typedef int lwi_no_sse2; // not an empty translation unit
#endif
