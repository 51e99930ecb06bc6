// SPDX-License-Identifier: BSD-3-Clause
// AVX2 kernels. This file alone is compiled with -mavx2; it defines nothing that other files could pick up but its table.
#include "simd/kernels.h"

#if defined( __AVX2__ )
#include "simd/simd_avx2.h"

#define LWI_KERNELS lwi_kernels_avx2
#define LWI_KERNELS_LEVEL LW_SIMD_AVX2
#include "simd/kernels_impl.h"
#else
typedef int lwi_no_avx2; // not an empty translation unit
#endif
