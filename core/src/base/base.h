// SPDX-License-Identifier: BSD-3-Clause
// Allocation through lw_allocator, failure reports, reference counts.
#ifndef LEEWAY_BASE_BASE_H
#define LEEWAY_BASE_BASE_H

#include "leeway/base.h"

#include <assert.h>

/// A variable that threads share. C++ reads it as std::atomic, which GCC and Clang lay out alike; tests/headers compares sizes.
#ifdef __cplusplus
#include <atomic>
#define LWI_ATOMIC( type ) std::atomic<type>
#else
#include <stdatomic.h>
#define LWI_ATOMIC( type ) _Atomic( type )
#endif

LW_EXTERN_C_BEGIN

#if defined( __GNUC__ )
#define LWI_PRINTF( text, first ) __attribute__( ( format( printf, text, first ) ) )
#else
#define LWI_PRINTF( text, first )
#endif

enum
{
	LWI_ALIGNMENT = 64
};

/// A copy of *allocator, or malloc and free if it is NULL.
lw_allocator lwi_allocator_or_default( const lw_allocator* allocator );

/// Uninitialised memory aligned to LWI_ALIGNMENT, or NULL. A size of 0 gives a pointer that must be freed too.
void* lwi_alloc( const lw_allocator* allocator, size_t size );
/// The same, all bytes 0; count * size is checked for overflow (NULL then).
void* lwi_alloc_zero( const lw_allocator* allocator, size_t count, size_t size );
void lwi_free( const lw_allocator* allocator, void* memory, size_t size ); ///< NULL is ignored

/// Fills *diag (nullable) and returns `status`.
lw_status lwi_fail( lw_diag* diag, lw_status status, uint32_t index, const char* format, ... ) LWI_PRINTF( 4, 5 );

/// LW_ERROR_OUT_OF_MEMORY with a message that names `what`, the object under construction.
lw_status lwi_out_of_memory( lw_diag* diag, const char* what );

/// The reference count of an immutable object.
typedef LWI_ATOMIC( unsigned ) lwi_refcount;

#ifndef __cplusplus
/// One more reference.
static inline void lwi_retain( lwi_refcount* count )
{
	atomic_fetch_add_explicit( count, 1u, memory_order_relaxed );
}

/// True if this was the last reference: the decrement synchronises with those of other threads.
static inline bool lwi_release( lwi_refcount* count )
{
	return atomic_fetch_sub_explicit( count, 1u, memory_order_acq_rel ) == 1u;
}
#endif

/// The finaliser of MurmurHash3 (Appleby 2011) over a running value: a bijection of h and of v, in which every bit changes
/// every other with a probability near one half.
static inline uint64_t lwi_mix( uint64_t h, uint64_t v )
{
	h ^= v;
	h ^= h >> 33;
	h *= 0xff51afd7ed558ccdull;
	h ^= h >> 33;
	h *= 0xc4ceb9fe1a85ec53ull;
	return h ^ h >> 33;
}

/// Rounds a byte count up to LWI_ALIGNMENT, for objects laid out as one block with parts behind each other.
static inline size_t lwi_align_up( size_t size )
{
	return ( size + ( LWI_ALIGNMENT - 1 ) ) & ~(size_t)( LWI_ALIGNMENT - 1 );
}

LW_EXTERN_C_END

#endif
