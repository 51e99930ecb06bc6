// SPDX-License-Identifier: BSD-3-Clause
// The robot's own body: is a point nearer than the shadow to the exact geometry of one of its bodies?
//
// A body is rigid, so distances of points in its own frame stay as they are. A grid around each shape remembers the distance of the centres of its
// cells, measured when a point first comes into a cell: that of any other point of the cell differs by no more than the way from the centre. Points for
// which that does not decide are measured themselves.
#include "cloud/cloud.h"
#include "base/math_inline.h"

#include <string.h>

static const double SLACK = 1e-6;          ///< metres: of distances in floats
static const double CELLS_ALONG = 64;      ///< of the longest side, at most
static const double CELLS_IN_SHADOW = 3;   ///< cells along the shadow
static const uint32_t UNUSED_FRAMES = 300; ///< after which a grid is given back

typedef struct lwi_body_grid lwi_body_grid;
struct lwi_body_grid
{
	lw_shape* shape;      ///< a reference
	double low[3];        ///< shape frame
	double cell, inverse; ///< metres, and 1 / cell
	uint32_t size[3];
	float*
		distance; ///< of the centres of cells; NaN: not measured, infinite: so far that all of the cell is beyond the shadow
	uint32_t used; ///< frame
};

static size_t cells_of( const lwi_body_grid* grid )
{
	return (size_t)grid->size[0] * grid->size[1] * grid->size[2];
}

static void free_grid( lw_cloud* cloud, lwi_body_grid* grid )
{
	lw_shape_release( grid->shape );
	lwi_free( &cloud->allocator, grid->distance, cells_of( grid ) * sizeof( float ) );
	lwi_free( &cloud->allocator, grid, sizeof( *grid ) );
}

void lwi_own_body_free( lw_cloud* cloud )
{
	for ( uint32_t i = 0; i < cloud->grids.count; ++i )
	{
		free_grid( cloud, ( (lwi_body_grid**)cloud->grids.data )[i] );
	}
	lwi_array_free( &cloud->grids, &cloud->allocator, sizeof( lwi_body_grid* ) );
	lw_query_destroy( cloud->query );
	lw_shape_release( cloud->point );
}

static lwi_body_grid* new_grid( lw_cloud* cloud, const lw_shape* shape )
{
	const lw_shape_info info = lw_shape_get_info( shape );
	lwi_body_grid* grid = lwi_alloc_zero( &cloud->allocator, 1, sizeof( lwi_body_grid ) );
	if ( grid == NULL )
	{
		return NULL;
	}
	const double shadow = cloud->def.shadow;
	double longest = 0;
	for ( int k = 0; k < 3; ++k )
	{
		longest = lwi_larger( longest, info.box_max[k] - info.box_min[k] + 2 * shadow );
	}
	grid->cell = lwi_larger( longest / CELLS_ALONG, lwi_larger( shadow / CELLS_IN_SHADOW, 0.5 * cloud->def.resolution ) );
	grid->inverse = 1 / grid->cell;
	for ( int k = 0; k < 3; ++k )
	{
		grid->low[k] = info.box_min[k] - shadow;
		grid->size[k] = (uint32_t)( ( info.box_max[k] + shadow - grid->low[k] ) / grid->cell ) + 1;
	}
	grid->shape = lw_shape_retain( shape );
	grid->distance = lwi_alloc( &cloud->allocator, cells_of( grid ) * sizeof( float ) );
	if ( grid->distance == NULL || !lwi_array_push( &cloud->grids, &cloud->allocator, sizeof( grid ), &grid ) )
	{
		free_grid( cloud, grid );
		return NULL;
	}
	for ( size_t i = 0; i < cells_of( grid ); ++i )
	{
		grid->distance[i] = NAN;
	}
	return grid;
}

static lwi_body_grid* grid_of( lw_cloud* cloud, const lw_shape* shape )
{
	lwi_body_grid** grids = cloud->grids.data;
	for ( uint32_t i = 0; i < cloud->grids.count; ++i )
	{
		if ( grids[i]->shape == shape )
		{
			return grids[i];
		}
	}
	return new_grid( cloud, shape );
}

/// Gives back the grids of shapes that no frame has had for a while: of objects that were put down.
static void forget_unused( lw_cloud* cloud )
{
	lwi_body_grid** grids = cloud->grids.data;
	for ( size_t i = cloud->grids.count; i-- > 0; )
	{
		if ( cloud->frame - grids[i]->used > UNUSED_FRAMES )
		{
			free_grid( cloud, grids[i] );
			grids[i] = grids[--cloud->grids.count];
		}
	}
}

static bool make_tools( lw_cloud* cloud )
{
	const lw_query_def def = lw_query_def_default();
	const double origin[3] = { 0, 0, 0 };
	return ( cloud->query != NULL || lw_query_create( &def, NULL, NULL, &cloud->allocator, &cloud->query ) == LW_OK ) &&
		   ( cloud->point != NULL ||
			   lw_shape_create_points( origin, 1, 0, NULL, &cloud->allocator, NULL, &cloud->point ) == LW_OK );
}

lw_status lwi_own_bodies_pose( lw_cloud* cloud, const lw_robot* robot, const double* state, lw_diag* diag,
	lwi_own_body* out )
{
	const uint32_t links = lw_robot_link_count( robot );
	forget_unused( cloud );
	lw_transform* poses = lwi_alloc( &cloud->allocator, links * sizeof( lw_transform ) );
	if ( poses == NULL || !make_tools( cloud ) )
	{
		lwi_free( &cloud->allocator, poses, links * sizeof( lw_transform ) );
		return lwi_out_of_memory( diag, "the body of a robot" );
	}
	lw_status status = lw_robot_fk( robot, state, poses );
	if ( status != LW_OK )
	{
		lwi_fail( diag, status, LW_INVALID_INDEX,
			"the state of robot '%.60s' has a number that is not finite, or a quaternion of 0", lw_robot_name( robot ) );
	}
	for ( uint32_t i = 0; i < lw_robot_body_count( robot ) && status == LW_OK; ++i )
	{
		const lw_body_def body = lw_robot_body( robot, i );
		lwi_own_body* own = &out[i];
		own->grid = grid_of( cloud, body.shape );
		if ( own->grid == NULL )
		{
			status = lwi_out_of_memory( diag, "the body of a robot" );
			break;
		}
		own->grid->used = cloud->frame;
		own->world_from_body = lwi_multiply( &poses[body.link], &body.link_from_shape );
		const lw_shape_info info = lw_shape_get_info( body.shape );
		const lw_vec3 c = lwi_transform( &own->world_from_body, lwi_load( info.sphere_center ) );
		own->center[0] = c.x;
		own->center[1] = c.y;
		own->center[2] = c.z;
		own->radius = info.sphere_radius + cloud->def.shadow;
	}
	lwi_free( &cloud->allocator, poses, links * sizeof( lw_transform ) );
	return status;
}

/// Does a sphere meet the box around a body and its shadow?
static bool meets_box( const lwi_own_body* body, const double center[3], double radius )
{
	const lwi_body_grid* grid = body->grid;
	const lw_vec3 p = lwi_untransform( &body->world_from_body, lwi_load( center ) );
	const double at[3] = { p.x, p.y, p.z };
	double square = 0;
	for ( int k = 0; k < 3; ++k )
	{
		const double below = grid->low[k] - at[k], above = at[k] - grid->low[k] - grid->size[k] * grid->cell;
		const double outside = lwi_larger( lwi_larger( below, above ), 0 );
		square += outside * outside;
	}
	return square <= radius * radius;
}

bool lwi_own_bodies_near( const lwi_own_body* bodies, uint32_t count, const double center[3], double radius,
	lwi_body_set* out )
{
	*out = ( lwi_body_set ){ { 0 } };
	bool near = false;
	for ( uint32_t i = 0; i < count; ++i )
	{
		const double d[3] = { bodies[i].center[0] - center[0], bodies[i].center[1] - center[1],
			bodies[i].center[2] - center[2] };
		const double reach = bodies[i].radius + radius;
		if ( d[0] * d[0] + d[1] * d[1] + d[2] * d[2] <= reach * reach && meets_box( &bodies[i], center, radius ) )
		{
			out->word[i >> 6] |= (uint64_t)1 << ( i & 63 );
			near = true;
		}
	}
	return near;
}

/// Distance of a point to a shape as an interval, up to a limit.
static lw_clearance measure( lw_cloud* cloud, const lw_shape* shape, lw_vec3 point, const lw_range* range )
{
	const lw_transform identity = lw_transform_identity();
	lw_transform at = identity;
	at.t[0] = point.x;
	at.t[1] = point.y;
	at.t[2] = point.z;
	lw_clearance out;
	if ( lw_shape_distance( cloud->point, &at, shape, &identity, range, cloud->query, &out ) != LW_OK )
	{
		out = lw_clearance_unknown();
	}
	return out;
}

/// The distance of the centre of a cell. Infinite if it could not be measured: nothing is proved then.
static float measure_cell( lw_cloud* cloud, const lwi_body_grid* grid, lw_vec3 center )
{
	// beyond it no point of the cell is within the shadow
	const lw_range range = { 0, cloud->def.shadow + 2 * grid->cell, 0 };
	const lw_clearance d = measure( cloud, grid->shape, center, &range );
	return d.kind == LW_CLEARANCE_NEAR        ? (float)d.upper
		   : d.kind == LW_CLEARANCE_VIOLATION ? 0
		   : d.kind == LW_CLEARANCE_UNDECIDED ? (float)d.upper
											  : INFINITY;
}

typedef enum answer
{
	OFF,
	ON,
	OPEN ///< the distance of its cell does not tell
} answer;

static answer by_cell( lw_cloud* cloud, const lwi_own_body* body, lw_vec3 point )
{
	const lwi_body_grid* grid = body->grid;
	const lw_vec3 p = lwi_untransform( &body->world_from_body, point );
	const double at[3] = { p.x, p.y, p.z };
	double center[3], from_sq = 0;
	size_t place = 0;
	for ( int k = 2; k >= 0; --k )
	{
		const double cell = ( at[k] - grid->low[k] ) * grid->inverse;
		if ( !( cell >= 0 && cell < grid->size[k] ) )
		{
			return OFF; // beyond the box and the shadow
		}
		const uint32_t c = (uint32_t)cell;
		place = place * grid->size[k] + c;
		center[k] = grid->low[k] + ( c + 0.5 ) * grid->cell;
		from_sq += ( at[k] - center[k] ) * ( at[k] - center[k] );
	}
	float* known = &grid->distance[place];
	if ( isnan( *known ) )
	{
		*known = measure_cell( cloud, grid, lwi_load( center ) );
	}
	const double d = (double)*known, way = sqrt( from_sq ) + SLACK;
	return d - way > cloud->def.shadow ? OFF : d + way <= cloud->def.shadow ? ON : OPEN;
}

static bool by_distance( lw_cloud* cloud, const lwi_own_body* body, lw_vec3 point )
{
	const lw_range range = lw_range_threshold( cloud->def.shadow );
	return measure( cloud, body->grid->shape, lwi_untransform( &body->world_from_body, point ), &range ).kind ==
		   LW_CLEARANCE_VIOLATION;
}

bool lwi_own_body_has( lw_cloud* cloud, const lwi_own_body* bodies, const lwi_body_set* which, lw_vec3 point )
{
	// a point on a link is mostly in the open cells of its neighbours: no distance is measured before all cells were asked
	lwi_body_set open = { { 0 } };
	for ( uint32_t w = 0; w < LWI_BODY_WORDS; ++w )
	{
		for ( uint64_t left = which->word[w]; left != 0; left &= left - 1 )
		{
			const answer found = by_cell( cloud, &bodies[w << 6 | lwi_lowest( left )], point );
			if ( found == ON )
			{
				return true;
			}
			open.word[w] |= found == OPEN ? left & ( 0 - left ) : 0;
		}
	}
	for ( uint32_t w = 0; w < LWI_BODY_WORDS; ++w )
	{
		for ( uint64_t left = open.word[w]; left != 0; left &= left - 1 )
		{
			if ( by_distance( cloud, &bodies[w << 6 | lwi_lowest( left )], point ) )
			{
				return true;
			}
		}
	}
	return false;
}
