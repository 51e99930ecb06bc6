// SPDX-License-Identifier: BSD-3-Clause
// Questions allocate nothing: malloc and its kin are replaced in this program, and count while one is asked of the shared
// library.
#include "random_world.hpp"

#include <gtest/gtest.h>

#include <cerrno>
#include <cstddef>

// ---- malloc, counted ---------------------------------------------------------------------------------------------------

extern "C"
{
	// The name of glibc's own malloc where a program replaces it
	void* __libc_malloc( std::size_t size );
	void* __libc_calloc( std::size_t count, std::size_t size );
	void* __libc_realloc( void* memory, std::size_t size );
	void* __libc_memalign( std::size_t align, std::size_t size );
	void __libc_free( void* memory );
}

namespace
{

thread_local bool watched = false;
thread_local long calls = 0;

void count()
{
	calls += watched ? 1 : 0;
}

} // namespace

extern "C" void* malloc( std::size_t size )
{
	count();
	return __libc_malloc( size );
}

extern "C" void* calloc( std::size_t number, std::size_t size )
{
	count();
	return __libc_calloc( number, size );
}

extern "C" void* realloc( void* memory, std::size_t size )
{
	count();
	return __libc_realloc( memory, size );
}

extern "C" void* memalign( std::size_t align, std::size_t size )
{
	count();
	return __libc_memalign( align, size );
}

extern "C" void* aligned_alloc( std::size_t align, std::size_t size )
{
	count();
	return __libc_memalign( align, size );
}

extern "C" int posix_memalign( void** out, std::size_t align, std::size_t size )
{
	count();
	*out = __libc_memalign( align, size );
	return *out != nullptr ? 0 : ENOMEM;
}

extern "C" void free( void* memory )
{
	count();
	__libc_free( memory );
}

namespace
{

/// Calls of malloc and its kin while it lives.
class Watch
{
public:
	Watch() : m_before( calls ) { watched = true; }
	~Watch() { watched = false; }
	long count() const { return calls - m_before; }

private:
	long m_before;
};

} // namespace

TEST( AsBuilt, TheWatchSeesAllocations )
{
	lw_shape* shape = nullptr;
	const double sizes[3] = { 1, 1, 1 };
	const Watch watch;
	ASSERT_EQ( LW_OK, lw_shape_create_primitive( LW_SHAPE_BOX, sizes, nullptr, nullptr, &shape ) );
	EXPECT_GT( watch.count(), 0 );
	lw_shape_release( shape );
}

TEST( AsBuilt, QueriesAllocateNothing )
{
	SeededRng rng;
	long states = 0, edges = 0, verdicts[4] = {};
	for ( std::uint64_t seed = 1; seed <= 12; ++seed )
	{
		RandomWorldOptions options;
		options.margins = seed % 2 == 0;
		const EdgeWorld world = randomWorld( seed, options );
		for ( const leeway::Checker* checker : { &world.checker, &world.with_tables } )
		{
			lw_query_def def = lw_query_def_default();
			def.motion_hulls = def.pair_tables = seed % 3 != 0;
			const leeway::Query query = leeway::makeQuery( checker->get(), def );
			std::vector<double> a = world.home, b = a;
			for ( int i = 0; i < 20; ++i )
			{
				for ( double& value : b )
				{
					value += rng.uniform( -0.3, 0.3 );
				}
				lw_edge_def edge_def = lw_edge_def_default();
				edge_def.method = i % 4 == 0 ? LW_EDGE_STEPS : LW_EDGE_CERTIFIED;
				edge_def.max_d = 0.05;
				edge_def.slack = 0.01;
				edge_def.want_proved_until = i % 2 == 0;
				const lw_range near = { 0.0, 0.05, 0.1 };
				lw_state_result state;
				lw_edge_result edge;
				lw_clearance pair;
				const lw_transform here = lw_transform_identity();
				const bool empty = lw_scene_shape_count( world.scene.get() ) == 0;
				const lw_shape* object = lw_scene_shape( world.scene.get(), 0 ).shape;
				const lw_shape* body = lw_robot_body( world.robot.get(), 0 ).shape;
				const Watch watch;
				const lw_status status[] = {
				    lw_checker_state( checker->get(), query.get(), b.data(), LW_CHECK_BOTH, nullptr, false, &state ),
				    lw_checker_state( checker->get(), query.get(), b.data(), LW_CHECK_BOTH, &near, true, &state ),
				    lw_checker_edge( checker->get(), query.get(), a.data(), b.data(), &edge_def, &edge ),
				    empty ? LW_OK : lw_shape_distance( object, &here, body, &here, nullptr, query.get(), &pair ),
				};
				lw_query_reset( query.get() );
				(void)lw_query_get_stats( query.get() );
				EXPECT_EQ( watch.count(), 0 ) << "world " << seed << ", motion " << i;
				for ( lw_status s : status )
				{
					EXPECT_EQ( s, LW_OK );
				}
				++states;
				++edges;
				++verdicts[edge.verdict];
			}
		}
	}
	EXPECT_GT( states, 400 );
	EXPECT_GT( verdicts[LW_VERDICT_FREE], 20 );
	EXPECT_GT( verdicts[LW_VERDICT_BLOCKED], 20 );
}
