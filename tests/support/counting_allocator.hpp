// SPDX-License-Identifier: BSD-3-Clause
// Allocators that count live memory and fail: when a number of allocations is used up, or at one of them.
#pragma once

#include "leeway/base.h"

#include <cstddef>
#include <cstdlib>

/// Fails when none are left; counts live blocks.
struct CountingAllocator
{
	int left = 1 << 30;
	int live = 0;
	std::size_t bytes = 0;

	lw_allocator get()
	{
		return { []( void* user, std::size_t size, std::size_t align ) -> void*
		    {
			    auto* self = static_cast<CountingAllocator*>( user );
			    if ( self->left-- <= 0 )
			    {
				    return nullptr;
			    }
			    ++self->live;
			    self->bytes += size;
			    return std::aligned_alloc( align, ( size + align - 1 ) / align * align );
		    },
		    []( void* user, void* memory, std::size_t size )
		    {
			    auto* self = static_cast<CountingAllocator*>( user );
			    --self->live;
			    self->bytes -= size;
			    std::free( memory );
		    },
		    this };
	}
};

/// Counts calls and live bytes; fails at call number `fail_at` (0 = never).
struct FailingAllocator
{
	std::size_t calls = 0, live = 0, fail_at = 0;
	lw_allocator allocator{ alloc, release, this };

	static void* alloc( void* user, std::size_t size, std::size_t align )
	{
		auto* self = static_cast<FailingAllocator*>( user );
		if ( ++self->calls == self->fail_at )
		{
			return nullptr;
		}
		self->live += size;
		const std::size_t rounded = ( size + align - 1 ) / align * align;
		return std::aligned_alloc( align, rounded > 0 ? rounded : align );
	}
	static void release( void* user, void* memory, std::size_t size )
	{
		static_cast<FailingAllocator*>( user )->live -= size;
		std::free( memory );
	}
};
