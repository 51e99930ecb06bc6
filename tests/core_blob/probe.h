/* SPDX-License-Identifier: BSD-3-Clause */
/* The inside of blobs and reaches for tests in C++, which cannot read the atomics of the internal headers. */
#ifndef LEEWAY_TESTS_BLOB_PROBE_H
#define LEEWAY_TESTS_BLOB_PROBE_H

#include "leeway/blob.h"

LW_EXTERN_C_BEGIN

/* Where fields of the header are. */
typedef struct probe_header
{
	size_t size, checksum, version, section_count, layout, key, table, table_entry;
} probe_header;
probe_header probe_header_fields( void );

/* Makes the checksum right again after an edit. */
void probe_seal( void* bytes, size_t size );

/* A reach of the robot with random contents of every kind: nothing is proved, everything is there to be saved. */
lw_reach* probe_random_reach( const lw_robot* robot, uint64_t seed );

/// Of all open cells of proofs under way.
size_t probe_open_bytes( const lw_reach* reach );
uint32_t probe_grid_count( const lw_reach* reach );

/* Name of the first member in which two reaches differ in any bit, or NULL. */
const char* probe_difference( const lw_reach* a, const lw_reach* b );

LW_EXTERN_C_END

#endif
