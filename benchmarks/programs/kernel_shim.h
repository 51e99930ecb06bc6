// SPDX-License-Identifier: BSD-3-Clause
// The core's kernels for a C++ program: their own header is C11.
#ifndef LEEWAY_BENCHMARKS_KERNEL_SHIM_H
#define LEEWAY_BENCHMARKS_KERNEL_SHIM_H

#include "leeway/base.h"

/// Input of the kernels at one level; NULL if out of memory. Released by bench_kernel_destroy().
void* bench_kernel_create( lw_simd level );
void bench_kernel_destroy( void* work );

/// One call, eight lanes: kernel 0 sphere against spheres, 1 sphere against triangles, 2 triangles against triangles.
/// @return one of the gaps, or 0
float bench_kernel_run( void* work, int kernel );

#endif
