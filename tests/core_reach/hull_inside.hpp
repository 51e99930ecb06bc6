// SPDX-License-Identifier: BSD-3-Clause
// Hulls of a reach without the rest of it: from the core's internal headers.
#pragma once

#include "reachability/qhull.h"
#include "reachability/reach.h"
#include "reachability/sweep.h"

#include <gtest/gtest.h>

/// A reach with hulls only: no pairs, no tables.
inline lw_status createHulls( const lw_reach_def* def, const lw_allocator* allocator, lw_diag* diag, lw_reach** out_reach )
{
	*out_reach = nullptr;
	lw_allocator memory = lwi_allocator_or_default( allocator );
	auto* reach = static_cast<lw_reach*>( lwi_alloc_zero( &memory, 1, sizeof( lw_reach ) ) );
	if ( reach == nullptr )
	{
		return LW_ERROR_OUT_OF_MEMORY;
	}
	reach->references = 1;
	reach->allocator = memory;
	reach->robot = lw_robot_retain( def->robot );
	reach->hull_error = def->hull_error;
	reach->limit_margin = def->limit_margin;
	lwi_reach_stage stage = {};
	lwi_reach_job job = { def, reach, diag, &stage };
	lw_status status = lwi_reach_allocate( reach, diag );
	status = status == LW_OK ? lwi_reach_build_hulls( &job ) : status;
	if ( status != LW_OK )
	{
		lwi_reach_free( reach );
		return status;
	}
	*out_reach = reach;
	return LW_OK;
}

/// The sweeps of a reach.
class HullSweeps
{
public:
	explicit HullSweeps( lw_reach* reach ) : m_job{ &m_def, reach, nullptr, nullptr }
	{
		EXPECT_EQ( lwi_sweeps_create( &m_job, &m_sweeps ), LW_OK );
	}
	HullSweeps( const HullSweeps& ) = delete;
	HullSweeps& operator=( const HullSweeps& ) = delete;
	~HullSweeps() { lwi_sweeps_destroy( m_sweeps ); }

	double separation( std::uint32_t link_a, std::uint32_t link_b )
	{
		double out = 0;
		EXPECT_EQ( lwi_sweeps_separation( m_sweeps, link_a, link_b, &out ), LW_OK );
		return out;
	}

private:
	lw_reach_def m_def = lw_reach_def_default();
	lwi_reach_job m_job;
	lwi_sweeps* m_sweeps = nullptr;
};

/// lwi_reduce_points()
inline lw_status reducePoints(
    double* points, size_t* count, double tolerance, size_t max_points, const lw_allocator* allocator, double* out_outside )
{
	lw_allocator memory = lwi_allocator_or_default( allocator );
	return lwi_reduce_points( points, count, tolerance, max_points, &memory, out_outside );
}
