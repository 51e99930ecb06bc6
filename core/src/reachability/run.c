// SPDX-License-Identifier: BSD-3-Clause
// Tasks of a reach on the threads that its user provides, and progress that any of them reports.
#define _POSIX_C_SOURCE 199309L // clock_gettime
#include "base/math_inline.h"
#include "reachability/reach.h"

#include <time.h>

/// Seconds between two reports of progress.
#define REPORT_INTERVAL 0.1

enum
{
	FEW_STEPS = 200 ///< of a stage whose steps may be long
};

double lwi_monotonic_seconds( void )
{
	struct timespec t = { 0 };
#if defined( CLOCK_MONOTONIC )
	clock_gettime( CLOCK_MONOTONIC, &t );
#else
	timespec_get( &t, TIME_UTC );
#endif
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

void lwi_reach_begin( const lwi_reach_job* job, const char* name, double seconds, uint32_t count )
{
	lwi_reach_stage* stage = job->stage;
	if ( stage != NULL )
	{
		stage->name = name;
		stage->begin = lwi_monotonic_seconds();
		stage->seconds = seconds;
		stage->count = count;
		atomic_store( &stage->done, 0u );
		atomic_store( &stage->last_report, 0.0 ); // each stage is reported at once
	}
}

void lwi_reach_step( const lwi_reach_job* job )
{
	if ( job->stage != NULL )
	{
		atomic_fetch_add( &job->stage->done, 1u );
		if ( job->stage->count <= FEW_STEPS )
		{
			atomic_store( &job->stage->last_report, 0.0 ); // each of them is reported
		}
	}
}

bool lwi_reach_goes_on( const lwi_reach_job* job )
{
	lwi_reach_stage* stage = job->stage;
	if ( stage == NULL || job->def->progress == NULL )
	{
		return true;
	}
	double now = lwi_monotonic_seconds();
	if ( atomic_load( &stage->cancelled ) )
	{
		return false;
	}
	if ( now - atomic_load( &stage->last_report ) < REPORT_INTERVAL || atomic_exchange( &stage->reporting, true ) )
	{
		return true; // it is too early, or another thread does it
	}
	atomic_store( &stage->last_report, now );
	double share = stage->seconds > 0 ? ( now - stage->begin ) / stage->seconds
				   : stage->count > 0 ? (double)atomic_load( &stage->done ) / stage->count
									  : 0;
	bool goes_on = job->def->progress( job->def->progress_user, stage->name, lwi_clamp( share, 0.0, 1.0 ) );
	if ( !goes_on )
	{
		atomic_store( &stage->cancelled, true );
	}
	atomic_store( &stage->reporting, false );
	return goes_on;
}

void lwi_reach_run( const lwi_reach_job* job, lwi_task* task, void* context, uint32_t count )
{
	const lwi_threads threads = { job->def->parallel, job->def->parallel_user };
	lwi_run_tasks( &threads, &job->reach->allocator, task, context, count );
}
