// SPDX-License-Identifier: BSD-3-Clause
// Objects of the core for the structured fuzzer: how bytes become arguments, and everything that creates, edits and
// releases.
#pragma once

#include "fuzz.hpp"

#include "leeway/leeway.h"

#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

namespace fuzz
{

/// Numbers from bytes, zeros after their end.
class Bytes
{
public:
	explicit Bytes( Input input ) : m_left( input ) {}
	bool empty() const { return m_left.empty(); }
	std::uint8_t next()
	{
		const std::uint8_t value = m_left.empty() ? 0 : static_cast<std::uint8_t>( m_left[0] );
		m_left.remove_prefix( m_left.empty() ? 0 : 1 );
		return value;
	}
	std::uint32_t below( std::uint32_t end ) { return next() % end; }
	bool oneIn( std::uint32_t n ) { return below( n ) == 0; }
	double between( double low, double high )
	{
		const unsigned high_byte = next();
		return low + ( high - low ) * ( high_byte * 256 + next() ) / 65535;
	}

private:
	Input m_left;
};

/// Counts live blocks, and fails once when `left` allocations are used up.
struct FailingAllocator
{
	long left = -1; ///< negative: does not fail
	long live = 0;
	std::size_t bytes = 0;
	lw_allocator interface {
		take, give, this
	};

	static void* take( void* user, std::size_t size, std::size_t align )
	{
		auto* self = static_cast<FailingAllocator*>( user );
		if ( self->left >= 0 && self->left-- == 0 )
		{
			return nullptr;
		}
		++self->live;
		self->bytes += size;
		return std::aligned_alloc( align, ( size + align - 1 ) / align * align );
	}
	static void give( void* user, void* memory, std::size_t size )
	{
		auto* self = static_cast<FailingAllocator*>( user );
		--self->live;
		self->bytes -= size;
		std::free( memory );
	}
};

class CoreWorld
{
public:
	/// Of the run: deferred shapes need it where no object of this class is at hand.
	static FailingAllocator*& allocator()
	{
		static FailingAllocator* current = nullptr;
		return current;
	}

protected:
	/// Tame: numbers of a few metres, so that edges end soon and intervals can be compared. Else any double.
	explicit CoreWorld( Input input ) : m_bytes( input ), m_tame( m_bytes.oneIn( 2 ) ) {}
	~CoreWorld();
	CoreWorld( const CoreWorld& ) = delete;
	CoreWorld& operator=( const CoreWorld& ) = delete;

	double real();
	lw_transform pose();
	/// One of those that are there; seldom none.
	template <typename T> T* pick( const std::vector<T*>& from )
	{
		return from.empty() || m_bytes.oneIn( 32 ) ? nullptr
		                                           : from[m_bytes.below( static_cast<std::uint32_t>( from.size() ) )];
	}

	void addPrimitive();
	void addMesh();
	void addSet();
	void addDeferred();
	void addDetail();
	void addScene();
	void editScene();
	void addRobot();
	void changeAttached();
	void addChecker();
	void editChecker();
	void addQuery();
	void addReach();
	void saveAndRead();
	void lookAtRobot();
	void failSoon() { allocator()->left = m_bytes.below( 64 ); }
	void releaseSomething();

	Bytes m_bytes;
	bool m_tame;
	std::vector<lw_shape*> m_shapes;
	std::vector<lw_scene*> m_scenes;
	std::vector<lw_robot*> m_robots;
	std::vector<lw_checker*> m_checkers;
	std::vector<lw_query*> m_queries;
	std::vector<lw_reach*> m_reaches;

private:
	const lw_allocator* memory() const { return &allocator()->interface; }
	lw_tree_def tree();
	/// Keeps objects that were made; releases the oldest of many.
	template <typename T> void keep( std::vector<T*>& all, void ( *release )( T* ), lw_status status, T* made );
	bool moderate( const lw_shape* shape ) const;
	void makeMargins( const lw_robot* robot, const lw_scene* scene, lw_margins& margins );

	std::vector<double> m_link_margins, m_object_margins;
};

} // namespace fuzz
