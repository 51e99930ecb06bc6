// SPDX-License-Identifier: BSD-3-Clause
// Queries: the scratch of one thread, allocated once.
#include "checker_internal.h"
#include "math_inline.h"
#include "distance_internal.h"
#include "scene_internal.h"

#include <string.h>

enum
{
	QUERY_COOKIE = 0x4c575155,
	MAX_SPARE = 1 << 24 ///< beyond that nothing would fit
};

lw_query_def lw_query_def_default( void )
{
	lw_query_def def;
	memset( &def, 0, sizeof( def ) );
	def.simd = LW_SIMD_BEST;
	def.transform_caching = true;
	def.warm_start = true;
	def.hierarchy = true;
	def.motion_hulls = true;
	def.pair_tables = true;
	def.planes = true;
	def.cookie = QUERY_COOKIE;
	return def;
}

static uint32_t padded( uint32_t count )
{
	return ( count + LWI_WIDTH - 1 ) / LWI_WIDTH * LWI_WIDTH;
}

/// Takes `size` bytes of the block that starts at `base` (NULL while measuring).
static void* take( char* base, size_t* used, size_t count, size_t size )
{
	void* part = base != NULL ? base + *used : NULL;
	*used += lwi_align_up( count * size );
	return part;
}

/// Lays the query's arrays out behind it. Called twice: to measure, then to place.
static size_t lay_out( lw_query* q, char* base )
{
	size_t used = lwi_align_up( sizeof( lw_query ) );
	q->waiting = take( base, &used, LWI_MAX_WAITING, sizeof( lwi_waiting ) );
	q->state = take( base, &used, q->variable_capacity, sizeof( double ) );
	q->world_from_link = take( base, &used, q->link_capacity, sizeof( lw_transform ) );
	q->node_stamp = take( base, &used, q->link_capacity, sizeof( uint64_t ) );
	q->sphere_stamp = take( base, &used, q->link_capacity, sizeof( uint64_t[2] ) );
	q->body_stamp = take( base, &used, q->body_capacity, sizeof( uint64_t ) );
	q->angles = take( base, &used, padded( q->link_capacity ), sizeof( double ) );
	q->cosines = take( base, &used, padded( q->link_capacity ), sizeof( double ) );
	q->sines = take( base, &used, padded( q->link_capacity ), sizeof( double ) );
	q->motion_trials = take( base, &used, q->link_capacity, sizeof( lwi_trial ) );
	q->spheres = take( base, &used, q->link_capacity, sizeof( double[2][4] ) );
	q->block_stamp = take( base, &used, q->link_capacity, sizeof( uint64_t ) );
	// each node begins a block of its own
	q->blocks = take( base, &used, q->body_capacity + LWI_WIDTH * (size_t)q->link_capacity, sizeof( float[4] ) );
	q->world_from_body = take( base, &used, q->body_capacity, sizeof( lw_transform ) );
	q->body_center = take( base, &used, q->body_capacity, sizeof( double[3] ) );
	q->body_spheres = take( base, &used, 4 * (size_t)padded( q->body_capacity ), sizeof( float ) );
	q->gaps = take( base, &used, q->gap_capacity, sizeof( float ) );
	q->row = take( base, &used, padded( q->scene_capacity ), sizeof( float ) );
	q->candidates = take( base, &used, q->gap_capacity, sizeof( lwi_candidate ) );
	q->edge_scratch = take( base, &used, q->edge_capacity, 1 );
	return used;
}

lw_status lw_query_create( const lw_query_def* def, const struct lw_scene* scene, const struct lw_checker* checker,
	const lw_allocator* allocator_in, lw_query** out_query )
{
	if ( out_query == NULL )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	*out_query = NULL;
	if ( def == NULL || def->cookie != QUERY_COOKIE )
	{
		return LW_ERROR_INVALID_DEF;
	}
	lw_query sizes;
	memset( &sizes, 0, sizeof( sizes ) );
	if ( def->spare_shapes > MAX_SPARE || def->spare_bodies > MAX_SPARE )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	sizes.scene_capacity = scene != NULL ? scene->shape_count : 0;
	if ( checker != NULL && checker->scene != NULL && checker->scene->shape_count > sizes.scene_capacity )
	{
		sizes.scene_capacity = checker->scene->shape_count;
	}
	sizes.scene_capacity += def->spare_shapes;
	size_t gaps = padded( sizes.scene_capacity );
	if ( checker != NULL )
	{
		sizes.variable_capacity = lw_robot_variable_count( checker->robot );
		// an attached object is a link with a body at least
		sizes.link_capacity = lw_robot_link_count( checker->robot ) + def->spare_bodies;
		sizes.body_capacity = lw_robot_body_count( checker->robot ) + def->spare_bodies;
		size_t rows = (size_t)checker->moving_body_count + def->spare_bodies;
		size_t environment = ( rows > 0 ? rows : 1 ) * padded( sizes.scene_capacity );
		size_t self = sizes.body_capacity * (size_t)padded( sizes.body_capacity );
		gaps = environment > gaps ? environment : gaps;
		gaps = self > gaps ? self : gaps;
		sizes.edge_capacity = lwi_edge_scratch_size( checker, def->spare_bodies );
	}
	if ( gaps > UINT32_MAX / 2 || sizes.body_capacity > UINT32_MAX / 2 )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	sizes.gap_capacity = (uint32_t)gaps;
	lw_allocator allocator = lwi_allocator_or_default( allocator_in );
	size_t bytes = lay_out( &sizes, NULL );
	lw_query* query = lwi_alloc_zero( &allocator, 1, bytes );
	if ( query == NULL )
	{
		return LW_ERROR_OUT_OF_MEMORY;
	}
	*query = sizes;
	query->allocator = allocator;
	query->def = *def;
	query->kernels = lwi_kernels_get( def->simd );
	query->bytes = bytes;
	lay_out( query, (char*)query );
	*out_query = query;
	return LW_OK;
}

void lwi_query_forget_checker( lw_query* query )
{
	lw_checker_release( query->posed );
	query->posed = NULL;
}

void lw_query_destroy( lw_query* query )
{
	if ( query != NULL )
	{
		lwi_query_forget_checker( query );
		lw_allocator allocator = query->allocator;
		lwi_free( &allocator, query, query->bytes );
	}
}

void lw_query_reset( lw_query* query )
{
	query->warm_environment.valid = false;
	query->warm_self.valid = false;
	query->warm_scene.valid = false;
	memset( query->hints, 0, sizeof( query->hints ) );
	query->last_edge_body = 0;
	query->last_edge_self = false;
	lwi_query_forget_checker( query );
}

lw_query_stats lw_query_get_stats( const lw_query* query )
{
	return query->stats;
}

void lw_query_reset_stats( lw_query* query )
{
	memset( &query->stats, 0, sizeof( query->stats ) );
}

size_t lw_query_bytes( const lw_query* query )
{
	return query->bytes;
}

void* lwi_query_edge_scratch( lw_query* query )
{
	return query->edge_scratch;
}

bool lw_query_fits( const lw_query* query, const lw_checker* checker )
{
	return query != NULL && checker != NULL && lwi_query_fits( query, checker );
}

bool lwi_query_fits( const lw_query* query, const lw_checker* checker )
{
	size_t columns = padded( checker->scene != NULL ? checker->scene->shape_count : 0 );
	size_t rows = checker->moving_body_count > 0 ? checker->moving_body_count : 1;
	size_t bodies = lw_robot_body_count( checker->robot );
	return query->variable_capacity >= lw_robot_variable_count( checker->robot ) &&
		   query->link_capacity >= lw_robot_link_count( checker->robot ) && query->body_capacity >= bodies &&
		   padded( query->scene_capacity ) >= columns && query->gap_capacity >= rows * columns &&
		   query->gap_capacity >= bodies * padded( (uint32_t)bodies ) &&
		   query->edge_capacity >= lwi_edge_scratch_size( checker, 0 );
}

static bool before( lwi_candidate x, lwi_candidate y )
{
	return x.gap < y.gap || ( x.gap == y.gap && x.pair < y.pair );
}

static void sift_down( lwi_candidate* heap, uint32_t at, uint32_t count )
{
	lwi_candidate moving = heap[at];
	for ( uint32_t child = 2 * at + 1; child < count; child = 2 * at + 1 )
	{
		if ( child + 1 < count && before( heap[child + 1], heap[child] ) )
		{
			++child;
		}
		if ( !before( heap[child], moving ) )
		{
			break;
		}
		heap[at] = heap[child];
		at = child;
	}
	heap[at] = moving;
}

void lwi_heap_build( lwi_candidate* heap, uint32_t count )
{
	for ( uint32_t i = count / 2; i-- > 0; )
	{
		sift_down( heap, i, count );
	}
}

void lwi_heap_push( lwi_candidate* heap, uint32_t* count, lwi_candidate fresh )
{
	uint32_t at = ( *count )++;
	while ( at > 0 && before( fresh, heap[( at - 1 ) / 2] ) )
	{
		heap[at] = heap[( at - 1 ) / 2];
		at = ( at - 1 ) / 2;
	}
	heap[at] = fresh;
}

lwi_candidate lwi_heap_pop( lwi_candidate* heap, uint32_t* count )
{
	lwi_candidate top = heap[0];
	*count -= 1;
	heap[0] = heap[*count];
	if ( *count > 0 )
	{
		sift_down( heap, 0, *count );
	}
	return top;
}

uint32_t lwi_collect( lw_query* query, uint32_t entries, float limit, uint32_t skip )
{
	uint32_t count = 0;
	for ( uint32_t i = 0; i < entries; ++i )
	{
		if ( query->gaps[i] < limit && i != skip )
		{
			query->candidates[count++] = (lwi_candidate){ query->gaps[i], i };
		}
	}
	lwi_heap_build( query->candidates, count );
	return count;
}
