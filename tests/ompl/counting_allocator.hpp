// SPDX-License-Identifier: BSD-3-Clause
// Counts the allocations of the whole program, C and C++, and makes them fail on demand (counting_allocator.cpp).
#pragma once

#include <atomic>
#include <cstdint>

namespace counting
{

extern std::atomic<std::uint64_t> allocations;
extern thread_local bool out_of_memory;      ///< operator new fails on this thread
extern thread_local bool core_out_of_memory; ///< malloc and its kin, called from the core, fail on this thread

} // namespace counting
