// SPDX-License-Identifier: BSD-3-Clause
// Blobs: sphere trees, motion hulls and pair tables as bytes, to be stored in a file.
//
// A blob has a format version, a checksum, and a key that its owner computes from the source content. Reading refuses a
// damaged or stale blob, and one of another version or machine. It does not protect against a malicious blob.
#ifndef LEEWAY_BLOB_H
#define LEEWAY_BLOB_H

#include "leeway/reach.h"

LW_EXTERN_C_BEGIN

/// Contents of a blob: shapes, a reach, or both. Make it with lw_blob_def_default().
typedef struct lw_blob_def
{
	lw_digest key;                 ///< digest of the source content (files, options)
	const lw_shape* const* shapes; ///< [shape_count]
	uint32_t shape_count;
	const lw_reach* reach; ///< nullable
	uint32_t cookie;
} lw_blob_def;

LW_API lw_blob_def lw_blob_def_default( void );

/// @param out_bytes owned by the caller: lw_blob_free() with the same allocator and size. NULL on failure.
/// @return LW_OK, LW_ERROR_INVALID_DEF, LW_ERROR_INVALID_ARGUMENT, LW_ERROR_OUT_OF_MEMORY
LW_API lw_status lw_blob_write( const lw_blob_def* def, const lw_allocator* allocator, lw_diag* diag, void** out_bytes,
	size_t* out_size );
LW_API void lw_blob_free( const lw_allocator* allocator, void* bytes, size_t size );

typedef struct lw_blob_info
{
	uint32_t version; ///< of the format
	lw_digest key;
	uint32_t shape_count;
	bool has_reach;
} lw_blob_info;

/// Checks header and checksum and reads the header.
/// @return LW_OK, LW_ERROR_DAMAGED (not a blob, cut short, changed), LW_ERROR_STALE (another version, byte order or layout)
LW_API lw_status lw_blob_get_info( const void* bytes, size_t size, lw_diag* diag, lw_blob_info* out );

/// Reads the shapes.
/// @param key must equal the key of the blob
/// @param out_shapes [shape_count], written; each owned by the caller. All NULL on failure.
/// @return as lw_blob_get_info(); LW_ERROR_STALE also for another key, LW_ERROR_DAMAGED for inconsistent contents,
/// LW_ERROR_INVALID_ARGUMENT if shape_count differs from the blob's, LW_ERROR_OUT_OF_MEMORY
LW_API lw_status lw_blob_read_shapes( const void* bytes, size_t size, lw_digest key, const lw_allocator* allocator,
	lw_diag* diag, lw_shape** out_shapes, uint32_t shape_count );

/// Reads the reach. `robot` must equal the robot of the blob (lw_robot_digest()), else LW_ERROR_STALE.
/// @param out_reach owned by the caller: lw_reach_release(). Set to NULL on failure.
/// @return as lw_blob_read_shapes(); LW_ERROR_INVALID_ARGUMENT if the blob holds no reach
LW_API lw_status lw_blob_read_reach( const void* bytes, size_t size, lw_digest key, const lw_robot* robot,
	const lw_allocator* allocator, lw_diag* diag, lw_reach** out_reach );

LW_EXTERN_C_END

#endif
