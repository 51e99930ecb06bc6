// SPDX-License-Identifier: BSD-3-Clause
// Digests of objects take their fields in one by one, because structs have padding.
#ifndef LEEWAY_BASE_DIGEST_H
#define LEEWAY_BASE_DIGEST_H

#include "base/math_inline.h"

static inline lw_digest lwi_digest_doubles( lw_digest d, const double* values, size_t count )
{
	return lw_digest_bytes( d, values, count * sizeof( double ) );
}

static inline lw_digest lwi_digest_floats( lw_digest d, const float* values, size_t count )
{
	return lw_digest_bytes( d, values, count * sizeof( float ) );
}

static inline lw_digest lwi_digest_indices( lw_digest d, const uint32_t* values, size_t count )
{
	return lw_digest_bytes( d, values, count * sizeof( uint32_t ) );
}

static inline lw_digest lwi_digest_transform( lw_digest d, const lw_transform* m )
{
	return lwi_digest_doubles( lwi_digest_doubles( d, &m->r[0][0], 9 ), m->t, 3 );
}

#endif
