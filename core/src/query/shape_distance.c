// SPDX-License-Identifier: BSD-3-Clause
// The distance of two shapes.
#include "base/math_inline.h"
#include "query/query.h"

lw_status lw_shape_distance( const lw_shape* a, const lw_transform* world_from_a, const lw_shape* b,
	const lw_transform* world_from_b, const lw_range* range, lw_query* query, lw_clearance* out )
{
	if ( out == NULL )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	*out = lw_clearance_unknown();
	lw_range wanted = range != NULL ? *range : lw_range_exact();
	lw_transform scratch_a, scratch_b;
	const lw_transform *pose_a = NULL, *pose_b = NULL;
	if ( a == NULL || b == NULL || world_from_a == NULL || world_from_b == NULL || query == NULL ||
		 !lwi_range_is_valid( &wanted ) || ( pose_a = lwi_pose_given( world_from_a, &scratch_a ) ) == NULL ||
		 ( pose_b = lwi_pose_given( world_from_b, &scratch_b ) ) == NULL )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	if ( a->family == LWI_UNBOUNDED && b->family == LWI_UNBOUNDED )
	{
		return LW_ERROR_UNSUPPORTED;
	}
	lwi_fetch_corners( a );
	lwi_fetch_corners( b );
	lwi_bound bound;
	lwi_bound_init( &bound, &wanted );
	if ( lwi_have_closed_form( a, b ) && lwi_search_round( &query->search, a, pose_a, b, pose_b, &bound ) )
	{
		query->search.stats.queries++;
		lwi_bound_result( &bound, out );
		if ( out->upper < INFINITY )
		{
			out->point_a = lwi_add( bound.point_a, lwi_load( pose_a->t ) );
			out->point_b = lwi_add( bound.point_b, lwi_load( pose_a->t ) );
		}
		return LW_OK;
	}
	lw_transform a_from_b = lwi_relative( pose_a, pose_b );
	query->search.failure = LW_OK;
	lwi_search( &query->search, a, b, &a_from_b, &bound );
	lwi_bound_result( &bound, out );
	if ( bound.failed )
	{
		return query->search.failure;
	}
	if ( out->upper < INFINITY )
	{
		out->point_a = lwi_transform( pose_a, bound.point_a );
		out->point_b = lwi_transform( pose_a, bound.point_b );
		out->a = lwi_named_element( a, bound.triangle_a, bound.point_a );
		out->b = lwi_named_element( b, bound.triangle_b, lwi_untransform( &a_from_b, bound.point_b ) );
	}
	return LW_OK;
}
