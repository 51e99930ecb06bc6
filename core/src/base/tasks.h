// SPDX-License-Identifier: BSD-3-Clause
// Tasks on the threads that a user provides: lw_reach_def::parallel, lw_cloud_def::parallel.
#ifndef LEEWAY_BASE_TASKS_H
#define LEEWAY_BASE_TASKS_H

#include "base/base.h"

LW_EXTERN_C_BEGIN

typedef void lwi_task( void* context, uint32_t index );

/// Threads of a definition. `parallel` may run a task twice, too late or never.
typedef struct lwi_threads
{
	void ( *parallel )( void* user, lwi_task* task, void* context, uint32_t count ); ///< NULL: the calling thread runs all
	void* user;
} lwi_threads;

/// Runs task( context, i ) once for each i below count. Without memory for the marks of tasks that have begun, the calling thread runs all.
void lwi_run_tasks( const lwi_threads* threads, const lw_allocator* memory, lwi_task* task, void* context, uint32_t count );

LW_EXTERN_C_END

#endif
