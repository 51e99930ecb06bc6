// SPDX-License-Identifier: BSD-3-Clause
// Makes deferred meshes on several threads, before the first query needs them.
#pragma once

#include "leeway/checker.h"
#include "leeway/parallel.hpp"

#include <algorithm>
#include <thread>
#include <vector>

namespace leeway
{

/// Makes meshes on several threads; for lw_checker_def::prepare and lw_checker_prepare(). The first query that needs a mesh
/// reports it if the mesh cannot be made.
/// @param user points to the number of threads, an unsigned
inline void makeShapes( void* user, const lw_shape* const* shapes, std::uint32_t count )
{
	std::vector<const lw_shape*> list( shapes, shapes + count );
	// Largest meshes first: they take longest
	std::sort( list.begin(), list.end(),
	    []( const lw_shape* a, const lw_shape* b )
	    { return lw_shape_peek_info( a ).triangle_count > lw_shape_peek_info( b ).triangle_count; } );
	inParallel( list.size(), *static_cast<const unsigned*>( user ),
	    [&list]( std::size_t i ) { (void)lw_shape_complete( list[i], nullptr ); } );
}

/// Makes the deferred meshes that states within the limits can need, so that the first queries cost as much as later ones
/// (lw_checker_prepare()). Meshes that no state within the limits can approach stay deferred. It changes no answer.
/// @param threads number of threads; 0 = one per core
/// @return LW_OK, or the status of the mesh that cannot be made (diag names it): queries that come near it fail
inline lw_status prepare( const lw_checker* checker, unsigned threads = 0, lw_diag* diag = nullptr )
{
	unsigned most = threads > 0 ? threads : std::max( 1U, std::thread::hardware_concurrency() );
	return lw_checker_prepare( checker, most > 1 ? makeShapes : nullptr, &most, diag );
}

} // namespace leeway
