// SPDX-License-Identifier: BSD-3-Clause
// Threads that a user might provide.
#pragma once

#include <cstdint>
#include <thread>
#include <vector>

/// `parallel` of a definition: runs tasks on three threads, the last one first; leaves some of them to the library, and runs some twice.
/// @param user int*: counts the calls
inline void runOnThreads( void* user, void ( *task )( void*, std::uint32_t ), void* context, std::uint32_t count )
{
	*static_cast<int*>( user ) += 1;
	std::vector<std::thread> threads;
	for ( std::uint32_t first = 0; first < 3; ++first )
	{
		threads.emplace_back(
		    [=]
		    {
			    for ( std::uint32_t i = first; i < count; i += 3 )
			    {
				    if ( i % 7 != 5 )
				    {
					    task( context, count - 1 - i );
					    task( context, i % 5 == 0 ? i : count + i );
				    }
			    }
		    } );
	}
	for ( std::thread& thread : threads )
	{
		thread.join();
	}
}
