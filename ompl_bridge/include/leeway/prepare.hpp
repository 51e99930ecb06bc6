// SPDX-License-Identifier: BSD-3-Clause
// Deferred meshes made on several threads, before the first question needs them.
#pragma once

#include "leeway/checker.h"
#include "leeway/parallel.hpp"

#include <algorithm>
#include <thread>
#include <vector>

namespace leeway
{

/// For lw_checker_def::prepare and lw_checker_prepare(): makes meshes on several threads. @param user points to their number, an unsigned. A mesh that
/// cannot be made is reported by the first query that needs it.
inline void makeShapes( void* user, const lw_shape* const* shapes, std::uint32_t count )
{
	std::vector<const lw_shape*> list( shapes, shapes + count );
	// Those that take longest first
	std::sort( list.begin(), list.end(),
	    []( const lw_shape* a, const lw_shape* b )
	    { return lw_shape_peek_info( a ).triangle_count > lw_shape_peek_info( b ).triangle_count; } );
	inParallel( list.size(), *static_cast<const unsigned*>( user ),
	    [&list]( std::size_t i ) { (void)lw_shape_complete( list[i], nullptr ); } );
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
