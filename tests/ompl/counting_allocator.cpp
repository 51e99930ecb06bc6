// SPDX-License-Identifier: BSD-3-Clause
// Every allocation of the test program, counted and made to fail on demand. In a file of its own: where GCC can inline one
// half of a new and delete pair, it takes the malloc and free inside for a mismatch.
#include "counting_allocator.hpp"

#include <cstddef>
#include <cstdlib>
#include <new>

namespace counting
{

std::atomic<std::uint64_t> allocations{ 0 };
thread_local bool out_of_memory = false;
thread_local bool core_out_of_memory = false;

} // namespace counting

namespace
{

using namespace counting;

/// @return nullptr while the test lets memory run out
void* allocate( std::size_t size, std::size_t align )
{
	if ( out_of_memory )
	{
		return nullptr;
	}
	return align > alignof( std::max_align_t ) ? std::aligned_alloc( align, ( size + align - 1 ) / align * align )
	                                           : std::malloc( size > 0 ? size : 1 );
}

void* allocateOrThrow( std::size_t size, std::size_t align )
{
	void* memory = allocate( size, align );
	if ( memory == nullptr )
	{
		throw std::bad_alloc();
	}
	return memory;
}

} // namespace

// C allocations of the statically linked core: the linker sends them here (--wrap).
extern "C"
{
	void* __real_malloc( std::size_t size );
	void* __real_calloc( std::size_t count, std::size_t size );
	void* __real_realloc( void* memory, std::size_t size );
	void* __real_aligned_alloc( std::size_t align, std::size_t size );

	void* __wrap_malloc( std::size_t size );
	void* __wrap_calloc( std::size_t count, std::size_t size );
	void* __wrap_realloc( void* memory, std::size_t size );
	void* __wrap_aligned_alloc( std::size_t align, std::size_t size );

	void* __wrap_malloc( std::size_t size )
	{
		allocations.fetch_add( 1, std::memory_order_relaxed );
		return core_out_of_memory ? nullptr : __real_malloc( size );
	}
	void* __wrap_calloc( std::size_t count, std::size_t size )
	{
		allocations.fetch_add( 1, std::memory_order_relaxed );
		return core_out_of_memory ? nullptr : __real_calloc( count, size );
	}
	void* __wrap_realloc( void* memory, std::size_t size )
	{
		allocations.fetch_add( 1, std::memory_order_relaxed );
		return core_out_of_memory ? nullptr : __real_realloc( memory, size );
	}
	void* __wrap_aligned_alloc( std::size_t align, std::size_t size )
	{
		allocations.fetch_add( 1, std::memory_order_relaxed );
		return core_out_of_memory ? nullptr : __real_aligned_alloc( align, size );
	}
}

// Those of C++, here and in OMPL. All forms: the library's default for one form calls another, but a sanitizer's does not.
void* operator new( std::size_t size )
{
	return allocateOrThrow( size, 0 );
}
void* operator new[]( std::size_t size )
{
	return allocateOrThrow( size, 0 );
}
void* operator new( std::size_t size, std::align_val_t align )
{
	return allocateOrThrow( size, static_cast<std::size_t>( align ) );
}
void* operator new[]( std::size_t size, std::align_val_t align )
{
	return allocateOrThrow( size, static_cast<std::size_t>( align ) );
}
void* operator new( std::size_t size, const std::nothrow_t& ) noexcept
{
	return allocate( size, 0 );
}
void* operator new[]( std::size_t size, const std::nothrow_t& ) noexcept
{
	return allocate( size, 0 );
}
void* operator new( std::size_t size, std::align_val_t align, const std::nothrow_t& ) noexcept
{
	return allocate( size, static_cast<std::size_t>( align ) );
}
void* operator new[]( std::size_t size, std::align_val_t align, const std::nothrow_t& ) noexcept
{
	return allocate( size, static_cast<std::size_t>( align ) );
}
// clang-format off
void operator delete( void* memory ) noexcept { std::free( memory ); }
void operator delete[]( void* memory ) noexcept { std::free( memory ); }
void operator delete( void* memory, std::size_t ) noexcept { std::free( memory ); }
void operator delete[]( void* memory, std::size_t ) noexcept { std::free( memory ); }
void operator delete( void* memory, std::align_val_t ) noexcept { std::free( memory ); }
void operator delete[]( void* memory, std::align_val_t ) noexcept { std::free( memory ); }
void operator delete( void* memory, std::size_t, std::align_val_t ) noexcept { std::free( memory ); }
void operator delete[]( void* memory, std::size_t, std::align_val_t ) noexcept { std::free( memory ); }
// clang-format on
