// SPDX-License-Identifier: BSD-3-Clause
// The memory of a checker: its arrays, and the references to it.
#include "checker/checker.h"
#include "scene/scene.h"

bool lwi_checker_allocate( lw_checker* c )
{
	const lw_allocator* allocator = &c->allocator;
	uint32_t bodies = lw_robot_body_count( c->base->robot ), clusters = c->base->tree->cluster_count;
	uint32_t shapes = c->scene != NULL ? c->scene->shape_count : 0;
	c->environment.block_count = c->scene != NULL ? c->scene->block_count : 0;
	c->environment.mask = lwi_alloc_zero( allocator, bodies, c->environment.block_count );
	c->culling.near_mask = lwi_alloc_zero( allocator, bodies, c->environment.block_count );
	c->environment.clusters = lwi_alloc_zero( allocator, clusters, 1 );
	c->culling.obstacle_distance = lwi_alloc_zero( allocator, c->environment.block_count, sizeof( double[LWI_WIDTH] ) );
	c->culling.cluster_distance = lwi_alloc_zero( allocator, (size_t)clusters * shapes, sizeof( double ) );
	c->allowed = lwi_alloc_zero( allocator, c->allowed_count, sizeof( lw_link_object_pair ) );
	c->bytes = sizeof( lw_checker ) + c->environment.block_count * ( sizeof( double[LWI_WIDTH] ) + (size_t)2 * bodies ) +
			   clusters + (size_t)clusters * shapes * sizeof( double ) + c->allowed_count * sizeof( lw_link_object_pair );
	return c->environment.mask != NULL && c->culling.near_mask != NULL && c->environment.clusters != NULL &&
		   c->culling.obstacle_distance != NULL && c->culling.cluster_distance != NULL && c->allowed != NULL;
}

void lwi_checker_free( lw_checker* c )
{
	const lw_allocator allocator = c->allocator;
	uint32_t bodies = 0, clusters = 0, shapes = c->scene != NULL ? c->scene->shape_count : 0;
	if ( c->base != NULL )
	{
		bodies = lw_robot_body_count( c->base->robot );
		clusters = c->base->tree->cluster_count;
	}
	lwi_free( &allocator, c->allowed, c->allowed_count * sizeof( lw_link_object_pair ) );
	lwi_free( &allocator, c->environment.mask, (size_t)bodies * c->environment.block_count );
	lwi_free( &allocator, c->culling.near_mask, (size_t)bodies * c->environment.block_count );
	lwi_free( &allocator, c->environment.clusters, clusters );
	lwi_free( &allocator, c->culling.obstacle_distance, c->environment.block_count * sizeof( double[LWI_WIDTH] ) );
	lwi_free( &allocator, c->culling.cluster_distance, (size_t)clusters * shapes * sizeof( double ) );
	lwi_margins_destroy( c->margins );
	lwi_checker_base_release( c->base );
	lw_scene_release( c->scene );
	lwi_free( &allocator, c, sizeof( lw_checker ) );
}

lw_checker* lw_checker_retain( const lw_checker* checker )
{
	lw_checker* mine = (lw_checker*)checker;
	if ( mine != NULL )
	{
		lwi_retain( &mine->references );
	}
	return mine;
}

void lw_checker_release( lw_checker* checker )
{
	if ( checker != NULL && lwi_release( &checker->references ) )
	{
		lwi_checker_free( checker );
	}
}
