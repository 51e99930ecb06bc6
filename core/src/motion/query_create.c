// SPDX-License-Identifier: BSD-3-Clause
// A query for states and motions of one checker: how large its arrays have to be.
#include "checker/checker.h"
#include "motion/edge.h"
#include "scene/scene.h"

enum
{
	MAX_SPARE = 1 << 24 ///< more than that never fits
};

lw_status lw_query_create( const lw_query_def* def, const struct lw_scene* scene, const struct lw_checker* checker,
	const lw_allocator* allocator, lw_query** out_query )
{
	if ( out_query == NULL )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	*out_query = NULL;
	if ( def == NULL )
	{
		return LW_ERROR_INVALID_DEF;
	}
	if ( def->spare_shapes > MAX_SPARE || def->spare_bodies > MAX_SPARE )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	const uint32_t shapes = scene != NULL ? scene->shape_count : 0;
	lwi_query_sizes sizes = { .shapes = shapes + def->spare_shapes, .gaps = lwi_padded( shapes + def->spare_shapes ) };
	if ( checker != NULL )
	{
		const uint32_t known = checker->scene != NULL ? checker->scene->shape_count : 0;
		sizes = lwi_checker_query_sizes( checker, ( shapes > known ? shapes - known : 0 ) + def->spare_shapes,
			def->spare_bodies );
		sizes.edge_bytes = lwi_edge_scratch_size( checker, def->spare_bodies );
	}
	return lwi_query_create( def, &sizes, allocator, out_query );
}

bool lw_query_fits( const lw_query* query, const lw_checker* checker )
{
	return query != NULL && checker != NULL && lwi_query_fits( query, checker ) &&
		   query->capacity.edge_bytes >= lwi_edge_scratch_size( checker, 0 );
}
