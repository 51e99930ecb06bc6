// SPDX-License-Identifier: BSD-3-Clause
// Deferred meshes made on several threads, before the first question needs them.
#pragma once

#include "leeway/checker.h"

#include <algorithm>
#include <atomic>
#include <system_error>
#include <thread>
#include <vector>

namespace leeway
{

/// lw_checker_def::prepare, and the like: makes meshes on as many threads as `user`, an unsigned, says. What fails here fails again when somebody
/// needs it, who says so.
inline void makeShapes( void* user, const lw_shape* const* shapes, std::uint32_t count )
{
	std::vector<const lw_shape*> list( shapes, shapes + count );
	// Those that take longest first
	std::sort( list.begin(), list.end(),
	    []( const lw_shape* a, const lw_shape* b )
	    { return lw_shape_peek_info( a ).triangle_count > lw_shape_peek_info( b ).triangle_count; } );
	std::atomic<std::size_t> next{ 0 };
	const auto work = [&]
	{
		for ( std::size_t i = next++; i < list.size(); i = next++ )
		{
			(void)lw_shape_complete( list[i], nullptr );
		}
	};
	std::vector<std::thread> others;
	for ( std::size_t i = 1; i < std::min<std::size_t>( *static_cast<const unsigned*>( user ), list.size() ); ++i )
	{
		try
		{
			others.emplace_back( work );
		}
		catch ( const std::system_error& )
		{
			break; // no more threads to be had: this one does it
		}
	}
	work();
	for ( std::thread& thread : others )
	{
		thread.join();
	}
}

/// Makes the deferred meshes that states within the limits can need, so that the first questions cost what later ones do
/// (lw_checker_prepare()). What no state within the limits can come near stays unmade. Answers are the same without it.
/// @param threads that make them; 0 = one per core
/// @return LW_OK, or why a mesh cannot be made (diag names it): questions that come near it have no answer
inline lw_status prepare( const lw_checker* checker, unsigned threads = 0, lw_diag* diag = nullptr )
{
	unsigned most = threads > 0 ? threads : std::max( 1U, std::thread::hardware_concurrency() );
	return lw_checker_prepare( checker, most > 1 ? makeShapes : nullptr, &most, diag );
}

} // namespace leeway
