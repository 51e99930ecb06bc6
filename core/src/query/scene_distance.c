// SPDX-License-Identifier: BSD-3-Clause
// The obstacle of a scene that is nearest to a shape.
#include "base/math_inline.h"
#include "query/query.h"
#include "scene/scene.h"

/// Nearest first: the shape with the least gap is searched, then all others whose gap is below the bound.
static void search_scene( const lw_scene* scene, lw_query* query, const lw_shape* shape, const lw_transform* world_from_shape,
	lwi_bound* bound )
{
	lw_vec3 center = lwi_transform( world_from_shape, lwi_load( shape->sphere_center ) );
	double world_center[3] = { center.x, center.y, center.z };
	bool near;
	double slack = lwi_scene_gaps( scene, scene->block_count, query->search.kernels, world_center, shape->sphere_radius,
		bound->cutoff,
		query->scratch.gaps, &near );
	uint32_t count = 0;
	float limit = lwi_round_up( bound->cutoff + slack );
	for ( uint32_t i = 0; i < scene->shape_count; ++i )
	{
		if ( !( query->scratch.gaps[i] >= limit ) )
		{
			float gap = query->scratch.gaps[i];
			const lwi_candidate candidate = { gap == gap ? gap : -INFINITY, i }; // overflowed: searched first
			query->scratch.candidates[count++] = candidate;
		}
	}
	lwi_heap_build( query->scratch.candidates, count );
	while ( count > 0 && !bound->done )
	{
		lwi_candidate next = lwi_heap_pop( query->scratch.candidates, &count );
		if ( next.gap >= lwi_round_up( bound->cutoff + slack ) )
		{
			break;
		}
		bound->current_pair = next.pair;
		const lw_scene_shape_def* obstacle = &scene->shapes[next.pair];
		lw_transform relative = lwi_relative( world_from_shape, &obstacle->world_from_shape );
		lwi_search( &query->search, shape, obstacle->shape, &relative, bound );
	}
}

lw_status lw_scene_distance( const lw_scene* scene, const lw_shape* shape, const lw_transform* world_from_shape,
	const lw_range* range, lw_query* query, lw_clearance* out )
{
	if ( out == NULL )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	*out = lw_clearance_unknown();
	lw_range wanted = range != NULL ? *range : lw_range_exact();
	if ( scene == NULL || shape == NULL || world_from_shape == NULL || query == NULL || !lwi_range_is_valid( &wanted ) ||
		 !lw_transform_is_valid( world_from_shape ) || query->capacity.shapes < scene->shape_count )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	if ( shape->family == LWI_UNBOUNDED )
	{
		return LW_ERROR_UNSUPPORTED;
	}
	lw_transform pose = lwi_orthonormal( world_from_shape );
	query->search.failure = LW_OK;
	lwi_bound bound;
	lwi_bound_init( &bound, &wanted );
	lwi_cached_pair* cached = &query->cache.nearest_scene;
	if ( lwi_cached_pair_pays( query, cached, &bound ) && cached->pair < scene->shape_count )
	{
		const lw_scene_shape_def* obstacle = &scene->shapes[cached->pair];
		lw_transform relative = lwi_relative( &pose, &obstacle->world_from_shape );
		bound.current_pair = cached->pair;
		lwi_measure_cached_pair( query, shape, obstacle->shape, &relative, cached, &bound );
	}
	if ( !bound.done )
	{
		search_scene( scene, query, shape, &pose, &bound );
	}
	*out = lwi_bound_result( &bound );
	if ( bound.failed )
	{
		return query->search.failure;
	}
	if ( out->upper < INFINITY )
	{
		out->point_a = lwi_transform( &pose, bound.point_a );
		out->point_b = lwi_transform( &pose, bound.point_b );
		out->a = lwi_named_element( shape, bound.triangle_a );
		out->b = scene->shapes[bound.pair].object;
		*cached = (lwi_cached_pair){ bound.pair, bound.triangle_a, bound.triangle_b, bound.upper, true };
	}
	return LW_OK;
}
