// SPDX-License-Identifier: BSD-3-Clause
// Arrays that grow while something is built, over lw_allocator.
#ifndef LEEWAY_BASE_GROW_H
#define LEEWAY_BASE_GROW_H

#include "base/base.h"

#include <string.h>

/// An array of items of one size. A zeroed one is empty.
typedef struct lwi_array
{
	void* data;
	size_t count, capacity; ///< items
} lwi_array;

/// Room for `more` items behind the last; the array stays as it is on failure.
static inline bool lwi_array_reserve( lwi_array* array, const lw_allocator* memory, size_t item, size_t more )
{
	if ( array->count + more <= array->capacity )
	{
		return true;
	}
	size_t capacity = array->capacity + array->capacity / 2 + more + 16;
	if ( capacity > SIZE_MAX / item )
	{
		return false;
	}
	void* grown = lwi_alloc( memory, capacity * item );
	if ( grown == NULL )
	{
		return false;
	}
	if ( array->count > 0 )
	{
		memcpy( grown, array->data, array->count * item );
	}
	lwi_free( memory, array->data, array->capacity * item );
	array->data = grown;
	array->capacity = capacity;
	return true;
}

static inline bool lwi_array_push( lwi_array* array, const lw_allocator* memory, size_t item, const void* value )
{
	if ( !lwi_array_reserve( array, memory, item, 1 ) )
	{
		return false;
	}
	memcpy( (char*)array->data + array->count * item, value, item );
	++array->count;
	return true;
}

static inline void lwi_array_free( lwi_array* array, const lw_allocator* memory, size_t item )
{
	lwi_free( memory, array->data, array->capacity * item );
	memset( array, 0, sizeof( *array ) );
}

#endif
