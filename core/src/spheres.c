// SPDX-License-Identifier: BSD-3-Clause
// Enclosing spheres of a body: the search for a given excess or number, and the public face.
//
// Bradshaw, O'Sullivan, "Adaptive medial-axis approximation for sphere-tree construction", 2004, and Hubbard,
//   "Approximating polyhedra with spheres for time-critical collision detection", 1996 (spheres on the medial axis);
// Stolpner,
//   Kry, Siddiqi, "Medial spheres for shape approximation", 2012 (inner spheres, dilated: the error is exact). The parts are
//   in enclose_*.c.
#include "leeway/spheres.h"

#include "enclose.h"
#include "math_inline.h"
#include "mesh.h"
#include "shape_internal.h"

enum
{
	SPHERES_DEF_COOKIE = 0x4c575331, ///< "LWS1"
	REFINE_ROUNDS = 6,
	COUNT_STEPS = 12 ///< bisections of the excess where a number of spheres is given
};

/// Part of the excess that pieces are not cut for: roundings of radii and depths come out of it.
#define KEPT_BACK 1e-9
/// Margin at the surface of solids, as a share of the excess.
#define SOLID_SHARE 0.04

struct lw_spheres
{
	lw_allocator memory;
	double* data; ///< [count][4]
	uint32_t count;
	lw_spheres_report report;
};

lw_spheres_def lw_spheres_def_default( void )
{
	return (lw_spheres_def){ .cookie = SPHERES_DEF_COOKIE };
}

/// Spheres of at most `excess` into `out` (double[4]), moved to where they need less for some rounds.
static lw_status cover_and_refine( lwi_body* body, const lwi_piece_tree* tree, const lwi_array* sites, double excess,
	double margin, uint32_t rounds, lwi_array* out )
{
	lwi_array chosen = { 0 };
	lw_status status = lwi_enclose_cover( tree, sites->data, sites->count, excess, &body->memory, &chosen );
	if ( status == LW_OK )
	{
		double reached = lwi_enclose_refine( body, tree, &chosen, excess, rounds );
		bool ok = reached >= 0 && lwi_enclose_spheres( body, tree, &chosen, reached, margin, out );
		status = ok ? LW_OK : LW_ERROR_OUT_OF_MEMORY;
	}
	lwi_array_free( &chosen, &body->memory, sizeof( lwi_site ) );
	return status;
}

static lw_status enclose_by_excess( lwi_body* body, double excess, uint32_t rounds, lwi_array* out, lw_diag* diag )
{
	const lw_allocator* memory = &body->memory;
	double margin = body->any_solid ? SOLID_SHARE * excess : 0;
	double target = ( excess - margin - body->chord ) * ( 1 - KEPT_BACK ) - 4 * body->slack;
	if ( !( target > 16 * body->slack ) )
	{
		return lwi_fail( diag, LW_ERROR_UNSUPPORTED, LW_INVALID_INDEX,
			"an excess of %g m is below what doubles resolve on this body; allow more", excess );
	}
	lwi_array pieces = { 0 }, sites = { 0 };
	lwi_piece_tree tree = { 0 };
	lw_status status = lwi_enclose_pieces( body, target, &pieces, &sites, diag );
	if ( status == LW_OK && !lwi_piece_tree_create( pieces.data, (uint32_t)pieces.count, memory, &tree ) )
	{
		status = LW_ERROR_OUT_OF_MEMORY;
	}
	if ( status == LW_OK )
	{
		status = cover_and_refine( body, &tree, &sites, target, margin, rounds, out );
	}
	lwi_piece_tree_free( &tree, memory );
	lwi_array_free( &pieces, memory, sizeof( lwi_piece ) );
	lwi_array_free( &sites, memory, sizeof( lwi_site ) );
	if ( status == LW_OK && body->any_solid )
	{
		double gap;
		lw_vec3 at;
		status = lwi_enclose_voids( body, out, margin, target, &gap, &at ) < 0 ? LW_ERROR_OUT_OF_MEMORY : LW_OK;
	}
	return status;
}

/// The least excess, to a few percent, for which at most `most` spheres are found. Their number is no monotone function
/// of the
/// excess, but what is kept has been found.
static lw_status enclose_by_count( lwi_body* body, uint32_t most, lwi_array* out, lw_diag* diag )
{
	lw_shape_info info = lw_shape_get_info( body->surface );
	// one sphere around everything has no more; twice that leaves room for margins
	double high = 4 * ( info.sphere_radius + body->dilation_max ), low = 0;
	for ( int i = 0; i < COUNT_STEPS && high > 1.03 * low; ++i )
	{
		double middle = low > 0 ? sqrt( low * high ) : 0.4 * high;
		out->count = 0;
		lw_status status = enclose_by_excess( body, middle, 0, out, diag );
		if ( status != LW_OK && status != LW_ERROR_UNSUPPORTED )
		{
			return status;
		}
		bool few = status == LW_OK && out->count <= most;
		high = few ? middle : high;
		low = few ? low : middle;
	}
	out->count = 0;
	return enclose_by_excess( body, high, REFINE_ROUNDS, out, diag );
}

// --- public ----------------------------------------------------------------------------------------------------------

static lw_status make_body( const lw_geometry_def* def, const lw_allocator* memory, lw_diag* diag, lwi_body* out )
{
	memset( out, 0, sizeof( *out ) );
	if ( def->shapes == NULL || def->shape_count == 0 || !( def->close_holes >= 0 ) || !isfinite( def->close_holes ) )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX,
			"a body needs one shape or more and close_holes of 0 or more metres" );
	}
	lwi_body_part* parts = lwi_alloc( memory, def->shape_count * sizeof( lwi_body_part ) );
	if ( parts == NULL )
	{
		return lwi_out_of_memory( diag, "a body" );
	}
	lw_status status = LW_OK;
	for ( uint32_t i = 0; i < def->shape_count && status == LW_OK; ++i )
	{
		parts[i].shape = def->shapes[i];
		parts[i].body_from_shape = def->body_from_shape != NULL ? def->body_from_shape[i] : lw_transform_identity();
		if ( parts[i].shape == NULL || !lw_transform_is_valid( &parts[i].body_from_shape ) )
		{
			status = lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, i,
				"shape %u of the body is NULL or its pose is no rigid motion", i );
		}
	}
	if ( status == LW_OK )
	{
		status = lwi_body_create( parts, def->shape_count, def->close_holes, memory, diag, out );
	}
	lwi_free( memory, parts, def->shape_count * sizeof( lwi_body_part ) );
	return status;
}

static lw_status fill( lw_spheres* set, lwi_body* body, const lw_spheres_def* def, lw_diag* diag )
{
	lwi_array found = { 0 };
	lw_status status = def->excess > 0 ? enclose_by_excess( body, def->excess, 0, &found, diag )
									   : enclose_by_count( body, def->sphere_count, &found, diag );
	if ( status == LW_OK )
	{
		size_t size = 4 * found.count * sizeof( double );
		set->data = lwi_alloc( &set->memory, size );
		status = set->data != NULL ? LW_OK : LW_ERROR_OUT_OF_MEMORY;
		if ( status == LW_OK )
		{
			memcpy( set->data, found.data, size );
			set->count = (uint32_t)found.count;
			status = lwi_enclose_check( body, set->data, set->count, diag, &set->report );
		}
	}
	lwi_array_free( &found, &set->memory, 4 * sizeof( double ) );
	if ( status == LW_OK && !set->report.encloses )
	{
		status = lwi_fail( diag, LW_ERROR_UNSUPPORTED, LW_INVALID_INDEX,
			"the spheres found could not be proved to enclose the body near (%g, %g, %g); use another excess",
			set->report.uncovered_at.x, set->report.uncovered_at.y, set->report.uncovered_at.z );
	}
	return status == LW_ERROR_OUT_OF_MEMORY ? lwi_out_of_memory( diag, "enclosing spheres" ) : status;
}

lw_status lw_spheres_create(
	const lw_spheres_def* def, const lw_allocator* allocator, lw_diag* diag, lw_spheres** out_spheres )
{
	if ( out_spheres == NULL )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, "out_spheres is NULL" );
	}
	*out_spheres = NULL;
	if ( def == NULL || def->cookie != SPHERES_DEF_COOKIE )
	{
		return lwi_fail( diag, def == NULL ? LW_ERROR_INVALID_ARGUMENT : LW_ERROR_INVALID_DEF, LW_INVALID_INDEX,
			"spheres def %s; make it with lw_spheres_def_default()", def == NULL ? "is NULL" : "has no valid cookie" );
	}
	if ( !( def->excess >= 0 ) || !isfinite( def->excess ) || ( def->excess > 0 ) == ( def->sphere_count > 0 ) )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX,
			"excess is %g and sphere_count %u; give one of them, above 0", def->excess, def->sphere_count );
	}
	lw_allocator memory = lwi_allocator_or_default( allocator );
	lwi_body body;
	lw_status status = make_body( &def->body, &memory, diag, &body );
	if ( status != LW_OK )
	{
		return status;
	}
	lw_spheres* set = lwi_alloc_zero( &memory, 1, sizeof( lw_spheres ) );
	status = set != NULL ? LW_OK : lwi_out_of_memory( diag, "enclosing spheres" );
	if ( set != NULL )
	{
		set->memory = memory;
		status = fill( set, &body, def, diag );
	}
	lwi_body_free( &body );
	if ( status != LW_OK )
	{
		lw_spheres_destroy( set );
		return status;
	}
	*out_spheres = set;
	return LW_OK;
}

void lw_spheres_destroy( lw_spheres* spheres )
{
	if ( spheres != NULL )
	{
		lw_allocator memory = spheres->memory;
		lwi_free( &memory, spheres->data, 4 * (size_t)spheres->count * sizeof( double ) );
		lwi_free( &memory, spheres, sizeof( lw_spheres ) );
	}
}

uint32_t lw_spheres_count( const lw_spheres* spheres )
{
	return spheres->count;
}

const double* lw_spheres_data( const lw_spheres* spheres )
{
	return spheres->data;
}

lw_spheres_report lw_spheres_get_report( const lw_spheres* spheres )
{
	return spheres->report;
}

lw_status lw_spheres_check( const lw_geometry_def* body_def, const double* spheres, uint32_t count,
	const lw_allocator* allocator,
	lw_diag* diag, lw_spheres_report* out )
{
	if ( body_def == NULL || out == NULL || ( spheres == NULL && count > 0 ) )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, "body, spheres or out is NULL" );
	}
	*out = (lw_spheres_report){ .uncovered = INFINITY, .excess = INFINITY };
	for ( uint32_t i = 0; i < count; ++i )
	{
		const double* s = spheres + 4 * (size_t)i;
		if ( !lwi_coordinates_valid( s ) || !( s[3] >= 0 && s[3] <= LWI_MAX_COORDINATE ) )
		{
			return lwi_fail( diag, LW_ERROR_BAD_GEOMETRY, i,
				"sphere %u is (%g, %g, %g), radius %g; give finite metres, a radius of 0 or more",
				i, s[0], s[1], s[2], s[3] );
		}
	}
	lw_allocator memory = lwi_allocator_or_default( allocator );
	lwi_body body;
	lw_status status = make_body( body_def, &memory, diag, &body );
	if ( status == LW_OK )
	{
		status = lwi_enclose_check( &body, spheres, count, diag, out );
		lwi_body_free( &body );
	}
	return status;
}
