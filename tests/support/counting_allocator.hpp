// SPDX-License-Identifier: BSD-3-Clause
// An lw_allocator that counts live blocks and fails when a given number of allocations are used up.
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
		return { []( void* user, std::size_t size, std::size_t align ) -> void* {
					auto* self = static_cast<CountingAllocator*>( user );
					if ( self->left-- <= 0 )
					{
						return nullptr;
					}
					++self->live;
					self->bytes += size;
					return std::aligned_alloc( align, ( size + align - 1 ) / align * align );
				},
			[]( void* user, void* memory, std::size_t size ) {
				auto* self = static_cast<CountingAllocator*>( user );
				--self->live;
				self->bytes -= size;
				std::free( memory );
			},
			this };
	}
};
