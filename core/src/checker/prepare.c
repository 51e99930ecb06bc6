// SPDX-License-Identifier: BSD-3-Clause
// Deferred shapes that states can need, made before the first query instead of by it.
#include "checker/checker.h"
#include "base/math_inline.h"
#include "scene/scene.h"

/// Called for each shape that may be needed. @return LW_OK to go on
typedef lw_status visit( void* user, const lw_shape* shape );

/// True if a body of the cluster is checked against this one.
static bool is_checked( const lw_checker* checker, const lwi_cluster* cluster, uint32_t body )
{
	for ( uint32_t i = 0; i < cluster->body_count; ++i )
	{
		const uint32_t other = checker->base->tree->bodies[cluster->first_body + i];
		const uint32_t row = body < other ? body : other, column = body < other ? other : body;
		const uint8_t* mask = checker->base->self.mask + (size_t)row * checker->base->body_block_count;
		if ( ( mask[column / LWI_WIDTH] >> ( column % LWI_WIDTH ) & 1 ) != 0 )
		{
			return true;
		}
	}
	return false;
}

/// True if a moving body may come within max_d of a static one.
static bool is_reached( const lw_checker* checker, uint32_t body, double largest_margin )
{
	const lwi_checker_body* b = &checker->base->bodies[body];
	const lw_transform world_from_shape =
		lwi_multiply( &checker->base->group.reference_poses[b->link], &b->link_from_shape );
	for ( uint32_t i = 1; i < checker->base->tree->cluster_count; ++i )
	{
		if ( is_checked( checker, &checker->base->tree->clusters[i], body ) &&
			 lwi_envelope_distance( b->shape, &world_from_shape, &checker->base->envelopes[i] ) - largest_margin <
				 checker->max_d )
		{
			return true;
		}
	}
	return false;
}

static lw_status visit_needed( const lw_checker* checker, visit* each, void* user )
{
	lw_status status = LW_OK;
	const lwi_cluster_tree* tree = checker->base->tree;
	const double margin = -lwi_lowest_self( checker->base );
	for ( uint32_t i = 0; tree->cluster_count > 0 && i < tree->clusters[0].body_count && status == LW_OK; ++i )
	{
		const uint32_t body = tree->bodies[tree->clusters[0].first_body + i];
		if ( lwi_shape_now( checker->base->bodies[body].shape )->deferred != NULL && is_reached( checker, body, margin ) )
		{
			status = each( user, checker->base->bodies[body].shape );
		}
	}
	for ( uint32_t i = 0; checker->scene != NULL && i < checker->scene->shape_count && status == LW_OK; ++i )
	{
		const lw_shape* shape = checker->scene->shapes[i].shape;
		if ( lwi_shape_now( shape )->deferred != NULL && checker->culling.obstacle_distance[i] < checker->culling.horizon )
		{
			status = each( user, shape );
		}
	}
	return status;
}

static lw_status note( void* user, const lw_shape* shape )
{
	lwi_prefetch_note( user, shape );
	return LW_OK;
}

static lw_status make( void* user, const lw_shape* shape )
{
	lw_status status;
	lwi_shape_made( shape, &status, user );
	return status;
}

lw_status lw_checker_prepare( const lw_checker* checker,
	void ( *prepare )( void* user, const lw_shape* const* shapes, uint32_t shape_count ), void* user, lw_diag* diag )
{
	if ( checker == NULL )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, "checker is NULL" );
	}
	lwi_prefetch prefetch = { .prepare = prepare, .user = user };
	if ( prepare != NULL )
	{
		(void)visit_needed( checker, note, &prefetch );
		lwi_prefetch_flush( &prefetch );
	}
	// the remaining ones one by one: an error then has its reason
	return visit_needed( checker, make, diag );
}
