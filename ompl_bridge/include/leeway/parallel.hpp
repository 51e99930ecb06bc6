// SPDX-License-Identifier: BSD-3-Clause
// A parallel loop.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace leeway
{

/// Calls work( i ) for each i in [0, count), started in this order, on at most `threads` threads (the caller's included),
/// and waits for all of them. The first exception ends the loop and is rethrown here.
template <typename Work> void inParallel( std::size_t count, unsigned threads, const Work& work )
{
	std::atomic<std::size_t> next{ 0 };
	std::mutex mutex;
	std::exception_ptr failure;
	const auto run = [&]
	{
		for ( std::size_t i = next++; i < count; i = next++ )
		{
			try
			{
				work( i );
			}
			catch ( ... )
			{
				const std::lock_guard<std::mutex> lock( mutex );
				failure = failure ? failure : std::current_exception();
				next = count;
			}
		}
	};
	std::vector<std::thread> others;
	for ( std::size_t i = 1; i < std::min<std::size_t>( threads, count ); ++i )
	{
		try
		{
			others.emplace_back( run );
		}
		catch ( const std::system_error& )
		{
			break; // no more threads available: the running ones do all rounds
		}
	}
	run();
	for ( std::thread& thread : others )
	{
		thread.join();
	}
	if ( failure )
	{
		std::rethrow_exception( failure );
	}
}

/// lw_reach_def::parallel and lw_cloud_def::parallel. @param user const unsigned*: the number of threads, the caller's included
inline void runTasks( void* user, void ( *task )( void*, std::uint32_t ), void* context, std::uint32_t count )
{
	inParallel( count, *static_cast<const unsigned*>( user ),
	    [=]( std::size_t i ) { task( context, static_cast<std::uint32_t>( i ) ); } );
}

} // namespace leeway
