// SPDX-License-Identifier: BSD-3-Clause
// Deferred meshes: a box now, the triangles and their tree at the first query that needs them.
//
// The shape that is made in the end is an ordinary one, owned by the deferred one. Whichever thread is first publishes its
// own by one compare-and-swap and the others drop theirs: nothing is locked here, and every reader sees one shape for good.
#include "base/math_inline.h"
#include "shape/mesh.h"
#include "shape/shape.h"

#include <string.h>

enum
{
	DEFERRED_COOKIE = 0x4c574431 ///< "LWD1"
};

lw_deferred_def lw_deferred_def_default( void )
{
	lw_deferred_def def;
	memset( &def, 0, sizeof( def ) );
	def.cookie = DEFERRED_COOKIE;
	return def;
}

static lw_status check_def( const lw_deferred_def* def, lw_diag* diag )
{
	if ( def == NULL || def->cookie != DEFERRED_COOKIE )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_DEF, LW_INVALID_INDEX,
			"deferred def was not made by lw_deferred_def_default()" );
	}
	if ( def->make == NULL )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, "deferred def has no make" );
	}
	if ( !lwi_coordinates_valid( def->box_min ) || !lwi_coordinates_valid( def->box_max ) ||
		 !( def->box_min[0] <= def->box_max[0] && def->box_min[1] <= def->box_max[1] &&
			 def->box_min[2] <= def->box_max[2] ) )
	{
		return lwi_fail( diag, LW_ERROR_BAD_GEOMETRY, LW_INVALID_INDEX,
			"the box of a deferred mesh is empty, not finite or too far away" );
	}
	return LW_OK;
}

lw_status lw_shape_create_deferred( const lw_deferred_def* def, const lw_allocator* allocator, lw_diag* diag,
	lw_shape** out_shape )
{
	if ( out_shape == NULL )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX,
			"out_shape is NULL; pass where to store the shape" );
	}
	*out_shape = NULL;
	lw_status status = check_def( def, diag );
	if ( status != LW_OK )
	{
		return status;
	}
	lw_allocator memory = lwi_allocator_or_default( allocator );
	lw_shape* shape = lwi_shape_new( LW_SHAPE_MESH, &memory );
	lwi_deferred* deferred = lwi_alloc_zero( &memory, 1, sizeof( lwi_deferred ) );
	if ( shape == NULL || deferred == NULL )
	{
		lwi_free( &memory, shape, sizeof( lw_shape ) );
		lwi_free( &memory, deferred, sizeof( lwi_deferred ) );
		return lwi_out_of_memory( diag, "a deferred mesh" );
	}
	deferred->def = *def;
	atomic_init( &deferred->made, NULL );
	shape->deferred = deferred;
	shape->bytes = sizeof( lw_shape ) + sizeof( lwi_deferred );
	double half_sq = 0, largest = 0;
	for ( int k = 0; k < 3; ++k )
	{
		shape->box_min[k] = def->box_min[k];
		shape->box_max[k] = def->box_max[k];
		shape->sphere_center[k] = 0.5 * def->box_min[k] + 0.5 * def->box_max[k];
		double half = fmax( def->box_max[k] - shape->sphere_center[k], shape->sphere_center[k] - def->box_min[k] );
		half_sq += half * half;
		largest = fmax( largest, fabs( shape->sphere_center[k] ) );
	}
	// a difference, a square, two sums and a root: 16u covers them; 1e-150 covers underflow
	shape->sphere_radius = sqrt( half_sq ) * ( 1.0 + 16 * LWI_U64 ) + 4 * LWI_U64 * largest + 1e-150;
	*out_shape = shape;
	return LW_OK;
}

/// Fails unless `made` is a mesh within the box of the shape, which earlier queries have used.
static lw_status check_made( const lw_shape* shape, const lw_shape* made, lw_diag* diag )
{
	if ( made == NULL || made->type != LW_SHAPE_MESH || made->deferred != NULL )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, "make of a deferred mesh gave no mesh" );
	}
	for ( int k = 0; k < 3; ++k )
	{
		if ( !( made->box_min[k] >= shape->box_min[k] && made->box_max[k] <= shape->box_max[k] ) )
		{
			return lwi_fail( diag, LW_ERROR_BAD_GEOMETRY, LW_INVALID_INDEX,
				"a deferred mesh turned out to reach beyond its box; give a box that contains it" );
		}
	}
	return LW_OK;
}

const lw_shape* lwi_shape_make( const lw_shape* shape, lw_status* out_status, lw_diag* diag )
{
	lwi_deferred* deferred = shape->deferred;
	lw_shape* made = atomic_load_explicit( &deferred->made, memory_order_acquire );
	*out_status = LW_OK;
	if ( made != NULL )
	{
		return made;
	}
	lw_status status = deferred->def.make( deferred->def.user, diag, &made );
	if ( status == LW_OK )
	{
		status = check_made( shape, made, diag );
	}
	if ( status != LW_OK )
	{
		lw_shape_release( made );
		*out_status = status;
		return NULL;
	}
	lw_shape* first = NULL;
	if ( !atomic_compare_exchange_strong_explicit( &deferred->made, &first, made, memory_order_acq_rel,
			 memory_order_acquire ) )
	{
		lw_shape_release( made );
		made = first;
	}
	return made;
}

const lw_shape* lwi_shape_now( const lw_shape* shape )
{
	const lw_shape* made =
		shape->deferred != NULL ? atomic_load_explicit( &shape->deferred->made, memory_order_acquire ) : NULL;
	return made != NULL ? made : shape;
}

/// Distance of a's box from the box around b's in a's frame.
static double gap_in_frame( const lw_shape* a, const lw_shape* b, const lw_transform* a_from_b )
{
	double sum_sq = 0, size = 0;
	for ( int i = 0; i < 3; ++i )
	{
		double center = a_from_b->t[i], half = 0;
		for ( int k = 0; k < 3; ++k )
		{
			center += a_from_b->r[i][k] * ( 0.5 * b->box_min[k] + 0.5 * b->box_max[k] );
			half += fabs( a_from_b->r[i][k] ) * ( 0.5 * b->box_max[k] - 0.5 * b->box_min[k] );
			size += fabs( b->box_min[k] ) + fabs( b->box_max[k] );
		}
		double outside = fmax( 0, fmax( a->box_min[i] - ( center + half ), center - half - a->box_max[i] ) );
		sum_sq += outside * outside;
		size += fabs( a->box_min[i] ) + fabs( a->box_max[i] ) + fabs( a_from_b->t[i] );
	}
	// a few dozen roundings of coordinates up to `size`; the comparison below turns NaN into no gap
	double gap = sqrt( sum_sq ) - 128 * LWI_U64 * size;
	return gap > 0 ? gap : 0;
}

double lwi_box_gap( const lw_shape* a, const lw_shape* b, const lw_transform* a_from_b )
{
	lw_transform identity = lw_transform_identity();
	lw_transform b_from_a = lwi_relative( a_from_b, &identity );
	return fmax( gap_in_frame( a, b, a_from_b ), gap_in_frame( b, a, &b_from_a ) );
}

void lwi_prefetch_note( lwi_prefetch* prefetch, const lw_shape* shape )
{
	if ( prefetch->prepare == NULL || lwi_shape_now( shape )->deferred == NULL )
	{
		return;
	}
	for ( uint32_t i = 0; i < prefetch->count; ++i )
	{
		if ( prefetch->shapes[i] == shape )
		{
			return;
		}
	}
	if ( prefetch->count == LWI_PREFETCH_CAPACITY )
	{
		lwi_prefetch_flush( prefetch );
	}
	prefetch->shapes[prefetch->count++] = shape;
}

void lwi_prefetch_flush( lwi_prefetch* prefetch )
{
	if ( prefetch->count > 1 )
	{
		prefetch->prepare( prefetch->user, prefetch->shapes, prefetch->count );
	}
	prefetch->count = 0;
}

lw_status lw_shape_complete( const lw_shape* shape, lw_diag* diag )
{
	if ( shape == NULL )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, "shape is NULL" );
	}
	lw_status status;
	lwi_shape_made( shape, &status, diag );
	return status;
}
