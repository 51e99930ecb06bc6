// SPDX-License-Identifier: BSD-3-Clause
// Tools that write and read blobs: bytes with bounds, and the contents of sections. Format: core/docs/blobs.md.
#ifndef LEEWAY_BLOB_BLOB_H
#define LEEWAY_BLOB_BLOB_H

#include "base/base.h"
#include "leeway/blob.h"

#include <string.h>

LW_EXTERN_C_BEGIN

/// Offsets of the header's fields. The first three have their place in every version: they tell whether the bytes are
/// a blob, whole and unchanged, before any other field is read. Numbers of the header are little-endian everywhere.
enum
{
	LWI_BLOB_MAGIC = 0,          ///< 8 bytes
	LWI_BLOB_SIZE = 8,           ///< u64, of everything
	LWI_BLOB_CHECKSUM = 16,      ///< 2 u64, of everything but itself
	LWI_BLOB_VERSION = 32,       ///< u32
	LWI_BLOB_SECTION_COUNT = 36, ///< u32
	LWI_BLOB_LAYOUT = 40,        ///< 8 bytes, see blob/blob.c
	LWI_BLOB_KEY = 48,           ///< 2 u64
	LWI_BLOB_TABLE = 64,         ///< one entry per section
	LWI_BLOB_TABLE_ENTRY = 16,   ///< u32 kind, u32 zero, u64 bytes without padding
	LWI_BLOB_SECTION_ALIGNMENT = 8
};

/// Ends every message about bytes that cannot be used.
#define LWI_BLOB_REMEDY "; delete it and build again"

// --- bytes, native byte order: the header's layout field names it ----------------------------------------------------

/// Appends values. With bytes = NULL it only counts, so that the same code first computes the size and then fills it.
typedef struct lwi_writer
{
	unsigned char* bytes; ///< nullable
	size_t capacity, at;
} lwi_writer;

static inline void lwi_write( lwi_writer* w, const void* from, size_t size )
{
	if ( w->bytes != NULL && size > 0 )
	{
		assert( size <= w->capacity - w->at );
		memcpy( w->bytes + w->at, from, size );
	}
	w->at += size;
}
static inline void lwi_write_u32( lwi_writer* w, uint32_t value )
{
	lwi_write( w, &value, sizeof( value ) );
}
static inline void lwi_write_u64( lwi_writer* w, uint64_t value )
{
	lwi_write( w, &value, sizeof( value ) );
}
static inline void lwi_write_double( lwi_writer* w, double value )
{
	lwi_write( w, &value, sizeof( value ) );
}

/// Reads behind each other. Past the end it gives zeros and stays `failed`, so that one test after many reads is enough.
typedef struct lwi_reader
{
	const unsigned char* bytes;
	size_t size, at;
	bool failed;
} lwi_reader;

static inline size_t lwi_reader_left( const lwi_reader* r )
{
	return r->size - r->at;
}
static inline void lwi_read( lwi_reader* r, void* to, size_t size )
{
	r->failed = r->failed || size > lwi_reader_left( r );
	if ( size == 0 )
	{
		return; // `to` may be NULL
	}
	if ( r->failed )
	{
		memset( to, 0, size );
		return;
	}
	memcpy( to, r->bytes + r->at, size );
	r->at += size;
}
static inline uint32_t lwi_read_u32( lwi_reader* r )
{
	uint32_t value;
	lwi_read( r, &value, sizeof( value ) );
	return value;
}
static inline uint64_t lwi_read_u64( lwi_reader* r )
{
	uint64_t value;
	lwi_read( r, &value, sizeof( value ) );
	return value;
}
static inline double lwi_read_double( lwi_reader* r )
{
	double value;
	lwi_read( r, &value, sizeof( value ) );
	return value;
}

// --- envelope --------------------------------------------------------------------------------------------------------

/// Writes the checksum of the rest into a blob of at least LWI_BLOB_TABLE bytes.
void lwi_blob_seal( unsigned char* bytes, size_t size );

// --- sections: blob/blob_shape.c, blob/blob_reach.c ----------------------------------------------------------------------------

void lwi_blob_write_shape( lwi_writer* w, const lw_shape* shape );
/// @param index of the shape in the blob, for messages
/// @return LW_OK, LW_ERROR_DAMAGED (contents that make no sense), LW_ERROR_OUT_OF_MEMORY; *out_shape is NULL on failure
lw_status lwi_blob_read_shape( lwi_reader* r, uint32_t index, const lw_allocator* allocator, lw_diag* diag,
	lw_shape** out_shape );

void lwi_blob_write_reach( lwi_writer* w, const lw_reach* reach );
/// @return the same, or LW_ERROR_STALE: of another robot
lw_status lwi_blob_read_reach( lwi_reader* r, const lw_robot* robot, const lw_allocator* allocator, lw_diag* diag,
	lw_reach** out_reach );

LW_EXTERN_C_END

#endif
