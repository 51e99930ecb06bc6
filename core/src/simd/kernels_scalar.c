// SPDX-License-Identifier: BSD-3-Clause
// Scalar kernels: the definition of the others.
#include "simd/simd_scalar.h"

#define LWI_KERNELS lwi_kernels_scalar
#define LWI_KERNELS_LEVEL LW_SIMD_SCALAR
#include "simd/kernels_impl.h"
