// SPDX-License-Identifier: BSD-3-Clause
// One entry of the engine's pool: a query, scratch vectors and counters, used by one thread at a time.
#pragma once

#include "leeway/ompl/validity.hpp"

namespace leeway::ompl
{

/// A counter written by the thread that holds the slot and read by anyone: no thread waits for another's cache line.
class SlotCounter
{
public:
	void add( std::uint64_t count )
	{
		// only the holder writes, so load and store need not be one step
		m_value.store( m_value.load( std::memory_order_relaxed ) + count, std::memory_order_relaxed );
	}
	std::uint64_t value() const { return m_value.load( std::memory_order_relaxed ); }

private:
	std::atomic<std::uint64_t> m_value{ 0 };
};

/// On cache lines of its own: neighbours are in use by other threads.
struct alignas( 64 ) Engine::Slot
{
	std::atomic<bool> busy{ true }; ///< a new slot belongs to the thread that made it
	Slot* next = nullptr;           ///< written before the slot is published, never after
	Checker checker;                ///< the snapshot in use
	std::uint64_t version = 0;      ///< of it
	Query query;
	std::unique_ptr<double[]> memory;
	double *a, *b;           ///< the ends of the motion (or the state), as read; [adapter size]
	double *from, *to;       ///< the piece that is being proved; [adapter size]
	double *varied, *result; ///< [adapter size]
	SlotCounter states, edges, free, blocked, undecided, edge_queries, motion_costs, cost_edges, cost_queries;
};

} // namespace leeway::ompl
