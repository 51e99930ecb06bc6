// SPDX-License-Identifier: BSD-3-Clause
// Shapes of a cloud: balls around occupied voxels, with a sphere tree straight from their Morton order; boxes of unseen voxels.
//
// Eight children of a wide node are the eight octants of a cube, so the tree is an octree: no splitting, no sorting. Octants with few voxels
// are joined: a node takes the children of its children as its own while there is room for them.
#include "cloud/cloud.h"
#include "base/math_inline.h"
#include "shape/shape.h"
#include "shape/sphere_fit.h"

#include <string.h>

double lwi_cloud_radius( const lw_cloud* cloud )
{
	// a point may be beyond the side of its voxel by the rounding of a product and a sum of its size
	double largest = 0;
	for ( int k = 0; k < 3; ++k )
	{
		largest = lwi_larger( largest, fabs( lwi_voxel_low( cloud, k, cloud->low[k] ) ) );
		largest = lwi_larger( largest, fabs( lwi_voxel_low( cloud, k, cloud->high[k] ) ) );
	}
	const double radius = 0.5 * sqrt( 3 ) * cloud->def.resolution + cloud->def.sensor_error;
	return radius * ( 1 + 8 * LWI_U64 ) + 16 * LWI_U64 * largest;
}

// ---- the tree of balls -----------------------------------------------------------------------------------------------

typedef struct entry
{
	lwi_ref ref;
	uint32_t first, count; ///< voxels
	uint32_t depth;        ///< nodes above its deepest leaf
	float sphere[4];
} entry;

typedef struct builder
{
	const lw_allocator* memory;
	const double* points;  ///< [][3] centres, tree frame, in the order of the codes
	const uint16_t* codes; ///< Morton, ascending
	double radius, slack;
	lwi_array nodes, leaves; ///< of lwi_node, children first; of lwi_ball_leaf
	bool out_of_memory;
} builder;

static void fit( const builder* b, entry* e )
{
	const double* p = b->points + 3 * (size_t)e->first;
	double low[3] = { p[0], p[1], p[2] }, high[3] = { p[0], p[1], p[2] };
	for ( uint32_t i = 1; i < e->count; ++i )
	{
		for ( uint32_t k = 0; k < 3; ++k )
		{
			low[k] = lwi_smaller( low[k], p[3 * i + k] );
			high[k] = lwi_larger( high[k], p[3 * i + k] );
		}
	}
	const lw_vec3 middle = lwi_v3( 0.5 * ( low[0] + high[0] ), 0.5 * ( low[1] + high[1] ), 0.5 * ( low[2] + high[2] ) );
	lwi_ball_around_balls( middle, p, NULL, e->count, b->radius, b->slack, e->sphere );
}

static entry make_leaf( builder* b, uint32_t first, uint32_t count )
{
	lwi_ball_leaf leaf;
	for ( uint32_t lane = 0; lane < LWI_WIDTH; ++lane )
	{
		const bool pad = lane >= count;
		const double* p = b->points + 3 * (size_t)( first + ( pad ? 0 : lane ) );
		leaf.x[lane] = pad ? 0 : (float)p[0];
		leaf.y[lane] = pad ? 0 : (float)p[1];
		leaf.z[lane] = pad ? 0 : (float)p[2];
		leaf.r[lane] = pad ? -INFINITY : lwi_round_up( b->radius );
		leaf.child[lane] = pad ? LW_INVALID_INDEX : first + lane;
	}
	b->out_of_memory = !lwi_array_push( &b->leaves, b->memory, sizeof( leaf ), &leaf ) || b->out_of_memory;
	entry e = { .ref = lwi_leaf_ref( (uint32_t)b->leaves.count - 1, count ), .first = first, .count = count };
	fit( b, &e );
	return e;
}

/// A node over entries whose voxels follow each other.
static entry make_node( builder* b, const entry* children, uint32_t count )
{
	entry e = { .first = children[0].first };
	lwi_node node;
	for ( uint32_t i = 0; i < LWI_WIDTH; ++i )
	{
		const bool pad = i >= count;
		node.x[i] = pad ? 0 : children[i].sphere[0];
		node.y[i] = pad ? 0 : children[i].sphere[1];
		node.z[i] = pad ? 0 : children[i].sphere[2];
		node.r[i] = pad ? -INFINITY : children[i].sphere[3];
		node.child[i] = pad ? LW_INVALID_INDEX : children[i].ref;
		e.count += pad ? 0 : children[i].count;
		e.depth = !pad && children[i].depth >= e.depth ? children[i].depth + 1 : e.depth;
	}
	b->out_of_memory = !lwi_array_push( &b->nodes, b->memory, sizeof( node ), &node ) || b->out_of_memory;
	e.ref = (uint32_t)b->nodes.count - 1;
	fit( b, &e );
	return e;
}

/// Entries of the voxels of a cube, 1 to 8: those of its octants while there is room, else nodes over them.
static uint32_t gather( builder* b, uint32_t begin, uint32_t end, uint32_t shift, entry out[LWI_WIDTH] )
{
	if ( end - begin <= LWI_WIDTH )
	{
		out[0] = make_leaf( b, begin, end - begin );
		return 1;
	}
	entry lists[8][LWI_WIDTH];
	uint32_t counts[8] = { 0 }, total = 0;
	for ( uint32_t octant = 0, at = begin; octant < 8; ++octant )
	{
		uint32_t next = at;
		while ( next < end && ( b->codes[next] >> shift & 7u ) == octant )
		{
			++next;
		}
		counts[octant] = next > at ? gather( b, at, next, shift - 3, lists[octant] ) : 0;
		total += counts[octant];
		at = next;
	}
	while ( total > LWI_WIDTH )
	{
		uint32_t most = 0;
		for ( uint32_t i = 1; i < 8; ++i )
		{
			most = counts[i] > counts[most] ? i : most;
		}
		lists[most][0] = make_node( b, lists[most], counts[most] );
		total -= counts[most] - 1;
		counts[most] = 1;
	}
	uint32_t count = 0;
	for ( uint32_t i = 0; i < 8; ++i )
	{
		for ( uint32_t k = 0; k < counts[i]; ++k )
		{
			out[count++] = lists[i][k];
		}
	}
	return count;
}

/// Moves nodes and leaves into the shape, parents before children.
static bool take_tree( builder* b, lw_shape* shape, const entry* root )
{
	const uint32_t nodes = (uint32_t)b->nodes.count, leaves = (uint32_t)b->leaves.count;
	shape->nodes = nodes > 0 ? lwi_alloc( b->memory, nodes * sizeof( lwi_node ) ) : NULL;
	shape->ball_leaves = lwi_alloc( b->memory, leaves * sizeof( lwi_ball_leaf ) );
	shape->node_count = shape->nodes != NULL ? nodes : 0;
	shape->leaf_count = shape->ball_leaves != NULL ? leaves : 0;
	if ( b->out_of_memory || shape->node_count != nodes || shape->leaf_count != leaves )
	{
		return false;
	}
	memcpy( shape->ball_leaves, b->leaves.data, leaves * sizeof( lwi_ball_leaf ) );
	for ( uint32_t i = 0; i < nodes; ++i )
	{
		lwi_node* node = &shape->nodes[i];
		*node = ( (const lwi_node*)b->nodes.data )[nodes - 1 - i];
		for ( uint32_t k = 0; k < LWI_WIDTH; ++k )
		{
			const bool inner = node->child[k] != LW_INVALID_INDEX && !lwi_ref_is_leaf( node->child[k] );
			node->child[k] = inner ? nodes - 1 - node->child[k] : node->child[k];
		}
	}
	shape->root = lwi_ref_is_leaf( root->ref ) ? root->ref : nodes - 1 - root->ref;
	shape->depth = root->depth;
	memcpy( shape->root_sphere, root->sphere, sizeof( root->sphere ) );
	return true;
}

static bool build_tree( lw_shape* shape, const uint16_t* codes )
{
	const size_t bytes = 3 * (size_t)shape->vertex_count * sizeof( double );
	double* points = lwi_alloc( &shape->allocator, bytes );
	builder b = { .memory = &shape->allocator,
		.points = points,
		.codes = codes,
		.radius = shape->radius,
		.slack = 4 * LWI_U64 * (double)shape->extent };
	bool made = points != NULL;
	if ( made )
	{
		for ( size_t i = 0; i < shape->vertex_count; ++i )
		{
			for ( size_t k = 0; k < 3; ++k )
			{
				points[3 * i + k] = shape->vertices[3 * i + k] - shape->origin[k];
			}
		}
		entry entries[LWI_WIDTH];
		const uint32_t count = gather( &b, 0, shape->vertex_count, 12, entries );
		const entry root = count == 1 ? entries[0] : make_node( &b, entries, count );
		made = take_tree( &b, shape, &root );
	}
	lwi_array_free( &b.nodes, &shape->allocator, sizeof( lwi_node ) );
	lwi_array_free( &b.leaves, &shape->allocator, sizeof( lwi_ball_leaf ) );
	lwi_free( &shape->allocator, points, bytes );
	return made;
}

static uint32_t count_occupied( const lw_cloud* cloud, const lwi_chunk* chunk )
{
	uint32_t count = 0;
	for ( uint32_t b = 0; b < LWI_CHUNK_BLOCKS; ++b )
	{
		for ( uint32_t w = 0; w < LWI_BLOCK_WORDS && lwi_is_made( chunk->blocks[b] ); ++w )
		{
			count += lwi_bits( lwi_block_at( cloud, chunk->blocks[b] )->occupied[w] );
		}
	}
	return count;
}

/// Centres and codes of the occupied voxels, in Morton order.
static void list_occupied( const lw_cloud* cloud, const lwi_chunk* chunk, double* vertices, uint16_t* codes )
{
	size_t count = 0;
	for ( uint32_t b = 0; b < LWI_CHUNK_BLOCKS; ++b )
	{
		if ( !lwi_is_made( chunk->blocks[b] ) )
		{
			continue;
		}
		int32_t corner[3];
		lwi_block_corner( cloud, chunk->place, b, corner );
		const lwi_block* block = lwi_block_at( cloud, chunk->blocks[b] );
		for ( uint32_t w = 0; w < LWI_BLOCK_WORDS; ++w )
		{
			for ( uint64_t left = block->occupied[w]; left != 0; left &= left - 1, ++count )
			{
				const uint32_t m = w << 6 | lwi_lowest( left );
				uint32_t v[3];
				lwi_unmorton( m, v );
				for ( int k = 0; k < 3; ++k )
				{
					vertices[3 * count + (size_t)k] =
						( (double)( cloud->first[k] + corner[k] + (int32_t)v[k] ) + 0.5 ) * cloud->def.resolution;
				}
				codes[count] = (uint16_t)( b << 9 | m );
			}
		}
	}
}

lw_status lwi_occupied_shape( const lw_cloud* cloud, const lwi_chunk* chunk, lw_diag* diag, lw_shape** out )
{
	*out = NULL;
	const uint32_t count = count_occupied( cloud, chunk );
	if ( count == 0 )
	{
		return LW_OK;
	}
	lw_shape* shape = lwi_shape_new( LW_SHAPE_POINTS, &cloud->allocator );
	uint16_t* codes = lwi_alloc( &cloud->allocator, count * sizeof( uint16_t ) );
	bool made = shape != NULL && codes != NULL;
	if ( made )
	{
		shape->vertices = lwi_alloc( &cloud->allocator, 3 * (size_t)count * sizeof( double ) );
		made = shape->vertices != NULL;
	}
	lw_status status = LW_OK;
	if ( made )
	{
		shape->item_count = shape->vertex_count = count;
		shape->radius = shape->dimensions[0] = lwi_cloud_radius( cloud );
		list_occupied( cloud, chunk, shape->vertices, codes );
		lwi_shape_set_frame( shape );
		made = build_tree( shape, codes );
	}
	if ( made )
	{
		lwi_shape_finish( shape );
		status = lwi_shape_find_few_extreme_points( shape, diag );
	}
	lwi_free( &cloud->allocator, codes, count * sizeof( uint16_t ) );
	if ( !made || status != LW_OK )
	{
		lw_shape_release( shape );
		return made ? status : lwi_out_of_memory( diag, "a cloud's shape" );
	}
	*out = shape;
	return LW_OK;
}

// ---- unseen voxels as boxes ------------------------------------------------------------------------------------------

/// Cells of a grid, [size z][size y][size x] bytes; those that are 1 become boxes, the largest first along x, then y, then z.
typedef struct cells
{
	uint8_t* at;
	uint32_t size[3];
} cells;

static bool is_full( const cells* grid, const uint32_t low[3], const uint32_t high[3] )
{
	for ( uint32_t z = low[2]; z < high[2]; ++z )
	{
		for ( uint32_t y = low[1]; y < high[1]; ++y )
		{
			const uint8_t* row = grid->at + ( (size_t)z * grid->size[1] + y ) * grid->size[0];
			for ( uint32_t x = low[0]; x < high[0]; ++x )
			{
				if ( row[x] == 0 )
				{
					return false;
				}
			}
		}
	}
	return true;
}

static void empty( cells* grid, const uint32_t low[3], const uint32_t high[3] )
{
	for ( uint32_t z = low[2]; z < high[2]; ++z )
	{
		for ( uint32_t y = low[1]; y < high[1]; ++y )
		{
			memset( grid->at + ( (size_t)z * grid->size[1] + y ) * grid->size[0] + low[0], 0, high[0] - low[0] );
		}
	}
}

/// The box that grows from a cell.
static void grow( const cells* grid, const uint32_t low[3], uint32_t high[3] )
{
	for ( int k = 0; k < 3; ++k )
	{
		high[k] = low[k] + 1;
	}
	for ( int k = 0; k < 3; ++k )
	{
		uint32_t from[3] = { low[0], low[1], low[2] }, to[3] = { high[0], high[1], high[2] };
		while ( high[k] < grid->size[k] )
		{
			from[k] = high[k];
			to[k] = high[k] + 1;
			if ( !is_full( grid, from, to ) )
			{
				break;
			}
			++high[k];
		}
	}
}

/// Cells of an edge in voxels, from a voxel on, as boxes within the cloud's box. Empties the grid.
static lw_status boxes_of( const lw_cloud* cloud, cells* grid, const int32_t corner[3], int32_t edge, lw_diag* diag,
	lw_shape** out )
{
	lwi_array boxes = { 0 };
	bool kept = true;
	uint32_t low[3];
	for ( low[2] = 0; low[2] < grid->size[2]; ++low[2] )
	{
		for ( low[1] = 0; low[1] < grid->size[1]; ++low[1] )
		{
			const uint8_t* row = grid->at + ( (size_t)low[2] * grid->size[1] + low[1] ) * grid->size[0];
			for ( low[0] = 0; low[0] < grid->size[0] && kept; ++low[0] )
			{
				if ( row[low[0]] == 0 )
				{
					continue;
				}
				uint32_t high[3];
				double box[6];
				grow( grid, low, high );
				empty( grid, low, high );
				for ( int k = 0; k < 3; ++k )
				{
					const int32_t a = corner[k] + (int32_t)low[k] * edge, b = corner[k] + (int32_t)high[k] * edge;
					box[k] = lwi_voxel_low( cloud, k, a > cloud->low[k] ? a : cloud->low[k] );
					box[k + 3] = lwi_voxel_low( cloud, k, b < cloud->high[k] ? b : cloud->high[k] );
				}
				kept = lwi_array_push( &boxes, &cloud->allocator, sizeof( box ), box );
			}
		}
	}
	lw_status status = kept ? LW_OK : lwi_out_of_memory( diag, "a cloud's shape" );
	if ( boxes.count > 0 && kept )
	{
		status = lw_shape_create_boxes( boxes.data, (uint32_t)boxes.count, NULL, &cloud->allocator, diag, out );
	}
	lwi_array_free( &boxes, &cloud->allocator, sizeof( double[6] ) );
	return status;
}

static bool fill_unseen( const lw_cloud* cloud, const lwi_chunk* chunk, cells* grid )
{
	bool any = false;
	for ( uint32_t b = 0; b < LWI_CHUNK_BLOCKS; ++b )
	{
		const uint32_t is = chunk->blocks[b];
		if ( is == LWI_ALL_FREE )
		{
			continue;
		}
		uint32_t at[3];
		lwi_unmorton( b, at );
		for ( uint32_t m = 0; m < LWI_BLOCK_VOXELS; ++m )
		{
			uint32_t v[3];
			lwi_unmorton( m, v );
			const bool unseen = is == LWI_ALL_UNSEEN || ( lwi_block_at( cloud, is )->seen[m >> 6] >> ( m & 63 ) & 1 ) == 0;
			grid->at[( ( at[2] * 8 + v[2] ) * LWI_CHUNK_EDGE + at[1] * 8 + v[1] ) * LWI_CHUNK_EDGE + at[0] * 8 + v[0]] =
				unseen;
			any = any || unseen;
		}
	}
	return any;
}

lw_status lwi_unseen_shape( const lw_cloud* cloud, const lwi_chunk* chunk, lw_diag* diag, lw_shape** out )
{
	*out = NULL;
	const size_t bytes = (size_t)LWI_CHUNK_EDGE * LWI_CHUNK_EDGE * LWI_CHUNK_EDGE;
	cells grid = { lwi_alloc_zero( &cloud->allocator, bytes, 1 ), { LWI_CHUNK_EDGE, LWI_CHUNK_EDGE, LWI_CHUNK_EDGE } };
	if ( grid.at == NULL )
	{
		return lwi_out_of_memory( diag, "a cloud's shape" );
	}
	int32_t corner[3];
	lwi_block_corner( cloud, chunk->place, 0, corner );
	const lw_status status = fill_unseen( cloud, chunk, &grid ) ? boxes_of( cloud, &grid, corner, 1, diag, out ) : LW_OK;
	lwi_free( &cloud->allocator, grid.at, bytes );
	return status;
}

lw_status lwi_far_unseen_shape( const lw_cloud* cloud, lw_diag* diag, lw_shape** out )
{
	*out = NULL;
	const size_t places = lwi_table_size( cloud );
	cells grid = { lwi_alloc( &cloud->allocator, places ), { cloud->size[0], cloud->size[1], cloud->size[2] } };
	if ( grid.at == NULL )
	{
		return lwi_out_of_memory( diag, "a cloud's shape" );
	}
	for ( size_t i = 0; i < places; ++i )
	{
		grid.at[i] = cloud->table[i] == LWI_ALL_UNSEEN;
	}
	const int32_t corner[3] = { 0, 0, 0 };
	const lw_status status = boxes_of( cloud, &grid, corner, LWI_CHUNK_EDGE, diag, out );
	lwi_free( &cloud->allocator, grid.at, places );
	return status;
}
