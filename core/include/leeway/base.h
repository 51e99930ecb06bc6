// SPDX-License-Identifier: BSD-3-Clause
// Status codes, diagnosis, allocator, version. Every other header includes this one.
#ifndef LEEWAY_BASE_H
#define LEEWAY_BASE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifndef LW_API
#if defined( _WIN32 ) && defined( LEEWAY_SHARED )
#define LW_API __declspec( dllexport )
#elif defined( __GNUC__ )
#define LW_API __attribute__( ( visibility( "default" ) ) )
#else
#define LW_API
#endif
#endif

#ifdef __cplusplus
#define LW_EXTERN_C_BEGIN                                                                                                   \
	extern "C"                                                                                                              \
	{
#define LW_EXTERN_C_END }
#else
#define LW_EXTERN_C_BEGIN
#define LW_EXTERN_C_END
#endif

LW_EXTERN_C_BEGIN

/// "No such element" wherever an index is returned or accepted.
#define LW_INVALID_INDEX UINT32_MAX

/// Outcome of a fallible call. Values are part of the ABI: never renumbered, only appended.
typedef enum lw_status
{
	LW_OK = 0,
	LW_ERROR_INVALID_ARGUMENT = -1, ///< a null, wrong-size, non-finite or out-of-range argument
	LW_ERROR_INVALID_DEF = -2,      ///< the def was not made by its lw_*_def_default()
	LW_ERROR_OUT_OF_MEMORY = -3,    ///< the allocator returned NULL; nothing was leaked or changed
	LW_ERROR_BAD_GEOMETRY = -4,     ///< see lw_diag.index for the offending vertex, triangle or element
	LW_ERROR_UNSUPPORTED = -5,      ///< a valid request this build cannot answer
	LW_ERROR_CANCELLED = -6,        ///< a progress callback returned false
	LW_ERROR_DAMAGED = -7,          ///< saved bytes are truncated, altered, or not a blob
	LW_ERROR_STALE = -8             ///< saved bytes of another version, machine or content; late frames, lost points
} lw_status;

/// Where and why a call failed. Owned by the caller; every function accepts NULL in its place.
typedef struct lw_diag
{
	lw_status status;
	uint32_t index;    ///< offending element, or LW_INVALID_INDEX
	char message[240]; ///< one line, UTF-8, always terminated
} lw_diag;

/// Memory source of an object. The object stores it at creation. It must be thread-safe if several threads create or
/// release objects. A NULL allocator pointer means malloc and free.
typedef struct lw_allocator
{
	/// @return memory of `size` bytes aligned to `align` (a power of two, at most 64), or NULL
	void* ( *alloc )( void* user, size_t size, size_t align );
	void ( *free )( void* user, void* memory, size_t size ); ///< `memory` is never NULL; `size` as allocated
	void* user;
} lw_allocator;

/// Instruction set used by the float kernels. All levels give the same bits.
typedef enum lw_simd
{
	LW_SIMD_BEST = 0, ///< the highest level that this machine and this build support
	LW_SIMD_SCALAR = 1,
	LW_SIMD_SSE2 = 2,
	LW_SIMD_AVX2 = 3,
	LW_SIMD_NEON = 4 ///< 64-bit ARM
} lw_simd;

/// The highest level that this machine and this build support. The environment variable LW_CPU_MASK (a lw_simd value as a
/// decimal number) lowers it, so that one binary can test every level.
LW_API lw_simd lw_simd_available( void );

/// @return true if this machine and this build have the level, and LW_CPU_MASK allows it; a query that asks for another level
/// uses the next lower one. False for LW_SIMD_BEST.
LW_API bool lw_simd_supported( lw_simd level );

/// A 128-bit content hash: different contents give different values, but for chance. Not cryptographic.
typedef struct lw_digest
{
	uint64_t word[2];
} lw_digest;

/// Digest of `size` bytes, appended to the digest `from` ({0} to begin). Parts must come in the same order each time.
LW_API lw_digest lw_digest_bytes( lw_digest from, const void* bytes, size_t size );
LW_API bool lw_digest_equal( lw_digest a, lw_digest b );

/// Library version as major * 10000 + minor * 100 + patch; compare with LW_VERSION of the headers.
LW_API uint32_t lw_version( void );

/// "LW_OK", "LW_ERROR_OUT_OF_MEMORY", ...; "unknown status" for any other value. Static storage.
LW_API const char* lw_status_name( lw_status status );

LW_EXTERN_C_END

#endif
