// SPDX-License-Identifier: BSD-3-Clause
// Allocation, failure reports, version. No global state.
#define _DEFAULT_SOURCE // madvise
#include "base/base.h"

#include "leeway/version.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#if defined( __linux__ )
#include <sys/mman.h>
#endif

/// Bytes. Larger pieces begin at a multiple of it, so that the kernel may give pages of this size: small ones cost a look-up for each few blocks of a
/// cloud, or nodes of a large mesh.
#define LARGE_PAGE ( (size_t)1 << 21 )

static void* default_alloc( void* user, size_t size, size_t align )
{
	(void)user;
	align = size >= LARGE_PAGE ? LARGE_PAGE : align;
	// aligned_alloc wants a multiple of the alignment
	size_t rounded = ( size + align - 1 ) & ~( align - 1 );
	void* memory = rounded < size ? NULL : aligned_alloc( align, rounded > 0 ? rounded : align );
#if defined( __linux__ )
	if ( memory != NULL && size >= LARGE_PAGE )
	{
		(void)madvise( memory, size & ~( LARGE_PAGE - 1 ), MADV_HUGEPAGE ); // it may refuse
	}
#endif
	return memory;
}

static void default_free( void* user, void* memory, size_t size )
{
	(void)user;
	(void)size;
	free( memory );
}

lw_allocator lwi_allocator_or_default( const lw_allocator* allocator )
{
	if ( allocator != NULL )
	{
		return *allocator;
	}
	return ( lw_allocator ){ default_alloc, default_free, NULL };
}

void* lwi_alloc( const lw_allocator* allocator, size_t size )
{
	return allocator->alloc( allocator->user, size, LWI_ALIGNMENT );
}

void* lwi_alloc_zero( const lw_allocator* allocator, size_t count, size_t size )
{
	if ( size != 0 && count > SIZE_MAX / size )
	{
		return NULL;
	}
	void* memory = lwi_alloc( allocator, count * size );
	if ( memory != NULL )
	{
		memset( memory, 0, count * size );
	}
	return memory;
}

void lwi_free( const lw_allocator* allocator, void* memory, size_t size )
{
	if ( memory != NULL )
	{
		allocator->free( allocator->user, memory, size );
	}
}

lw_status lwi_fail( lw_diag* diag, lw_status status, uint32_t index, const char* format, ... )
{
	if ( diag != NULL )
	{
		diag->status = status;
		diag->index = index;
		va_list arguments;
		va_start( arguments, format );
		vsnprintf( diag->message, sizeof( diag->message ), format, arguments );
		va_end( arguments );
	}
	return status;
}

lw_status lwi_out_of_memory( lw_diag* diag, const char* what )
{
	return lwi_fail( diag, LW_ERROR_OUT_OF_MEMORY, LW_INVALID_INDEX, "out of memory while building %s", what );
}

uint32_t lw_version( void )
{
	return LW_VERSION;
}

const char* lw_status_name( lw_status status )
{
	switch ( status )
	{
	case LW_OK:
		return "LW_OK";
	case LW_ERROR_INVALID_ARGUMENT:
		return "LW_ERROR_INVALID_ARGUMENT";
	case LW_ERROR_INVALID_DEF:
		return "LW_ERROR_INVALID_DEF";
	case LW_ERROR_OUT_OF_MEMORY:
		return "LW_ERROR_OUT_OF_MEMORY";
	case LW_ERROR_BAD_GEOMETRY:
		return "LW_ERROR_BAD_GEOMETRY";
	case LW_ERROR_UNSUPPORTED:
		return "LW_ERROR_UNSUPPORTED";
	case LW_ERROR_CANCELLED:
		return "LW_ERROR_CANCELLED";
	case LW_ERROR_DAMAGED:
		return "LW_ERROR_DAMAGED";
	case LW_ERROR_STALE:
		return "LW_ERROR_STALE";
	}
	return "unknown status";
}
