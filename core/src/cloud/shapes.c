// SPDX-License-Identifier: BSD-3-Clause
// Shapes of a cloud: balls around occupied voxels, and the sphere trees of balls and boxes straight from the Morton order of their middles.
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

// ---- trees ------------------------------------------------------------------------------------------------------------

typedef struct entry
{
	lwi_ref ref;
	uint32_t first, count; ///< balls or boxes
	uint32_t depth;        ///< nodes above its deepest leaf
	float sphere[4];
} entry;

typedef struct builder
{
	const lw_allocator* memory;
	const double* points;  ///< tree frame, in the order of the codes: [][3] centres of balls, or [][6] corners of boxes
	const uint32_t* codes; ///< Morton, ascending, all different
	bool boxes;
	double radius, slack;
	lwi_array nodes, leaves; ///< of lwi_node, children first; of lwi_ball_leaf or lwi_box_leaf
	bool out_of_memory;
} builder;

static void fit_boxes( const builder* b, entry* e )
{
	const double* p = b->points + 6 * (size_t)e->first;
	double low[3] = { p[0], p[1], p[2] }, high[3] = { p[3], p[4], p[5] };
	for ( uint32_t i = 1; i < e->count; ++i )
	{
		for ( uint32_t k = 0; k < 3; ++k )
		{
			low[k] = lwi_smaller( low[k], p[6 * i + k] );
			high[k] = lwi_larger( high[k], p[6 * i + 3 + k] );
		}
	}
	const lw_vec3 middle = lwi_v3( 0.5 * ( low[0] + high[0] ), 0.5 * ( low[1] + high[1] ), 0.5 * ( low[2] + high[2] ) );
	lwi_ball_around_boxes( middle, p, e->count, b->slack, e->sphere );
}

static void fit( const builder* b, entry* e )
{
	if ( b->boxes )
	{
		fit_boxes( b, e );
		return;
	}
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

static void add_box_leaf( builder* b, uint32_t first, uint32_t count )
{
	lwi_box_leaf leaf;
	for ( uint32_t lane = 0; lane < LWI_WIDTH; ++lane )
	{
		const bool pad = lane >= count;
		const double* p = b->points + 6 * (size_t)( first + ( pad ? 0 : lane ) );
		for ( int k = 0; k < 3; ++k )
		{
			leaf.boxes.min[k][lane] = pad ? INFINITY : lwi_round_down( p[k] );
			leaf.boxes.max[k][lane] = pad ? -INFINITY : lwi_round_up( p[3 + k] );
		}
		leaf.box[lane] = first + ( pad ? 0 : lane );
	}
	b->out_of_memory = !lwi_array_push( &b->leaves, b->memory, sizeof( leaf ), &leaf ) || b->out_of_memory;
}

static void add_ball_leaf( builder* b, uint32_t first, uint32_t count )
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
}

static entry make_leaf( builder* b, uint32_t first, uint32_t count )
{
	if ( b->boxes )
	{
		add_box_leaf( b, first, count );
	}
	else
	{
		add_ball_leaf( b, first, count );
	}
	entry e = { .ref = lwi_leaf_ref( (uint32_t)b->leaves.count - 1, count ), .first = first, .count = count };
	fit( b, &e );
	return e;
}

/// A node over entries that follow each other.
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

/// Entries of the balls or boxes whose middles are in a cube, 1 to 8: those of its octants while there is room, else nodes over them.
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
	const size_t leaf_bytes = leaves * ( b->boxes ? sizeof( lwi_box_leaf ) : sizeof( lwi_ball_leaf ) );
	void* taken = lwi_alloc( b->memory, leaf_bytes );
	shape->ball_leaves = b->boxes ? NULL : taken;
	shape->box_leaves = b->boxes ? taken : NULL;
	shape->node_count = shape->nodes != NULL ? nodes : 0;
	shape->leaf_count = taken != NULL ? leaves : 0;
	if ( b->out_of_memory || shape->node_count != nodes || shape->leaf_count != leaves )
	{
		return false;
	}
	memcpy( taken, b->leaves.data, leaf_bytes );
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

bool lwi_cloud_tree( lw_shape* shape, const uint32_t* codes, uint32_t shift )
{
	const size_t bytes = 3 * (size_t)shape->vertex_count * sizeof( double );
	double* points = lwi_alloc( &shape->allocator, bytes );
	builder b = { .memory = &shape->allocator,
		.points = points,
		.codes = codes,
		.boxes = shape->family == LWI_BOXES,
		.radius = shape->radius,
		.slack = ( shape->family == LWI_BOXES ? 16 : 4 ) * LWI_U64 * (double)shape->extent };
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
		const uint32_t count = gather( &b, 0, shape->item_count, shift, entries );
		const entry root = count == 1 ? entries[0] : make_node( &b, entries, count );
		made = take_tree( &b, shape, &root );
	}
	lwi_array_free( &b.nodes, &shape->allocator, sizeof( lwi_node ) );
	lwi_array_free( &b.leaves, &shape->allocator, b.boxes ? sizeof( lwi_box_leaf ) : sizeof( lwi_ball_leaf ) );
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
static void list_occupied( const lw_cloud* cloud, const lwi_chunk* chunk, double* vertices, uint32_t* codes )
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
				codes[count] = b << 9 | m;
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
	uint32_t* codes = lwi_alloc( &cloud->allocator, count * sizeof( uint32_t ) );
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
		made = lwi_cloud_tree( shape, codes, 12 );
	}
	if ( made )
	{
		lwi_shape_finish( shape );
		status = lwi_shape_find_few_extreme_points( shape, diag );
	}
	lwi_free( &cloud->allocator, codes, count * sizeof( uint32_t ) );
	if ( !made || status != LW_OK )
	{
		lw_shape_release( shape );
		return made ? status : lwi_out_of_memory( diag, "a cloud's shape" );
	}
	*out = shape;
	return LW_OK;
}
