// SPDX-License-Identifier: BSD-3-Clause
#include "base/tasks.h"

#include <stdatomic.h>

/// Tasks of which each runs once, whatever the threads do.
typedef struct run
{
	lwi_task* task;
	void* context;
	uint32_t count;
	atomic_bool* begun; ///< [count]
} run;

static void run_once( void* context, uint32_t index )
{
	const run* r = context;
	if ( index < r->count && !atomic_exchange( &r->begun[index], true ) )
	{
		r->task( r->context, index );
	}
}

void lwi_run_tasks( const lwi_threads* threads, const lw_allocator* memory, lwi_task* task, void* context, uint32_t count )
{
	run r = { task, context, count, NULL };
	if ( threads->parallel != NULL && count > 1 )
	{
		r.begun = lwi_alloc( memory, count * sizeof( atomic_bool ) );
	}
	if ( r.begun == NULL )
	{
		for ( uint32_t i = 0; i < count; ++i )
		{
			task( context, i );
		}
		return;
	}
	for ( uint32_t i = 0; i < count; ++i )
	{
		atomic_init( &r.begun[i], false );
	}
	threads->parallel( threads->user, run_once, &r, count );
	for ( uint32_t i = 0; i < count; ++i )
	{
		run_once( &r, i );
	}
	lwi_free( memory, r.begun, count * sizeof( atomic_bool ) );
}
