// SPDX-License-Identifier: BSD-3-Clause
// The obstacles that a group can come near to: envelopes of its clusters against the boxes of the obstacles.
//
// Model only the required part of a scene: Steinbach et al. 2006, section IV, for links; here for obstacles. Derivation:
// core/docs/required.md.
#include "checker/culling.h"

#include "base/math_inline.h"
#include "scene/scene.h"

#include <string.h>

/// Share of a number that covers the rounding of the sums below.
static const double rounding = 0x1p-36;

/// A cluster's clearance given its distance from a shape; rounded down.
static double less_margin( const lw_checker* checker, uint32_t cluster, uint32_t shape, double distance )
{
	const lwi_margins* m = checker->margins;
	if ( m == NULL )
	{
		return distance;
	}
	double largest = m->clusters[2 * cluster] + m->object[checker->scene->shapes[shape].object];
	return distance - largest - rounding * largest;
}

/// Marks the obstacles that some body of a cluster is checked against and that are not proved to stay beyond the horizon.
static void mark_near( lw_checker* checker, const lwi_reuse* reuse, uint32_t index )
{
	const lwi_cluster* cluster = &checker->base->tree->clusters[index];
	const uint32_t blocks = checker->environment.block_count, clusters = checker->base->tree->cluster_count;
	const lw_checker* old = reuse->previous;
	bool same_envelope =
		old != NULL && index < old->base->tree->cluster_count &&
		memcmp( &checker->base->envelopes[index], &old->base->envelopes[index], sizeof( lwi_envelope ) ) == 0;
	for ( uint32_t block = 0; block < blocks; ++block )
	{
		uint32_t asked = 0, near = 0;
		for ( uint32_t i = 0; i < cluster->body_count; ++i )
		{
			asked |=
				checker->environment.mask[(size_t)checker->base->tree->bodies[cluster->first_body + i] * blocks + block];
		}
		for ( uint32_t lane = 0; lane < LWI_WIDTH && asked >> lane != 0; ++lane )
		{
			uint32_t shape = block * LWI_WIDTH + lane;
			if ( ( asked >> lane & 1 ) == 0 )
			{
				continue;
			}
			uint32_t source = same_envelope ? reuse->source[shape] : LW_INVALID_INDEX;
			double distance = source != LW_INVALID_INDEX
								  ? old->culling.cluster_distance[(size_t)source * old->base->tree->cluster_count + index]
								  : NAN;
			if ( isnan( distance ) )
			{
				const lw_scene_shape_def* obstacle = &checker->scene->shapes[shape];
				distance =
					lwi_envelope_distance( obstacle->shape, &obstacle->world_from_shape, &checker->base->envelopes[index] );
			}
			checker->culling.cluster_distance[(size_t)shape * clusters + index] = distance;
			double clearance = less_margin( checker, index, shape, distance );
			checker->culling.obstacle_distance[shape] = fmin( checker->culling.obstacle_distance[shape], clearance );
			near |= clearance >= checker->culling.horizon ? 0 : 1u << lane;
		}
		for ( uint32_t i = 0; i < cluster->body_count; ++i )
		{
			size_t at = (size_t)checker->base->tree->bodies[cluster->first_body + i] * blocks + block;
			checker->culling.near_mask[at] = (uint8_t)( checker->environment.mask[at] & near );
		}
	}
}

void lwi_checker_cull( lw_checker* checker, const lwi_reuse* reuse )
{
	uint32_t shapes = checker->scene != NULL ? checker->scene->shape_count : 0;
	// No state is farther from the scene than the static bodies are. (The excess is for ties.)
	double fixed = checker->nearest_static.clearance.upper;
	checker->culling.horizon = fixed < checker->max_d ? fixed + 1e-9 * fabs( fixed ) + 1e-9 : checker->max_d;
	checker->culling.is_complete = fixed < checker->culling.horizon;
	for ( uint32_t i = 0; i < shapes; ++i )
	{
		checker->culling.obstacle_distance[i] = INFINITY;
	}
	for ( size_t i = 0; i < (size_t)shapes * checker->base->tree->cluster_count; ++i )
	{
		checker->culling.cluster_distance[i] = NAN;
	}
	for ( uint32_t i = 1; i < checker->base->tree->cluster_count && shapes > 0; ++i )
	{
		if ( ( checker->environment.clusters[i] & LWI_CLUSTER_CHECKED ) != 0 )
		{
			mark_near( checker, reuse, i );
		}
	}
	checker->culling.near_block_count = 0;
	for ( uint32_t i = 0; i < shapes; ++i )
	{
		if ( !( checker->culling.obstacle_distance[i] >= checker->culling.horizon ) )
		{
			++checker->culling.near_shape_count;
			checker->culling.near_block_count = i / LWI_WIDTH + 1;
		}
	}
}
