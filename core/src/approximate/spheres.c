// SPDX-License-Identifier: BSD-3-Clause
// Enclosing spheres of a body: the search for a given excess or number, and the public face.
//
// Bradshaw, O'Sullivan, "Adaptive medial-axis approximation for sphere-tree construction", 2004, and Hubbard,
//   "Approximating polyhedra with spheres for time-critical collision detection", 1996 (spheres on the medial axis);
// Stolpner,
//   Kry, Siddiqi, "Medial spheres for shape approximation", 2012 (inner spheres, dilated: the error is exact). The parts are
//   in enclose_*.c.
#include "leeway/spheres.h"

#include "approximate/enclose.h"
#include "base/math_inline.h"
#include "shape/mesh.h"
#include "shape/shape.h"

enum
{
	SPHERES_DEF_COOKIE = 0x4c575331, ///< "LWS1"
	REFINE_ROUNDS = 6,
	FORM_ENOUGH = 24,   ///< a form of more spheres is taken without a search, which would take long
	FORMS_ENOUGH = 200, ///< the same of several shapes, which may hide parts of each other
	COUNT_STEPS = 12    ///< bisections of the excess where a number of spheres is given
};

/// Share of the excess that is reserved for the rounding of radii and depths when fragments are cut.
#define KEPT_BACK 1e-9
/// Margin at the surface of solids, as a share of the excess.
#define SOLID_SHARE 0.04
/// Between the excesses of a search that may be stopped. The sets on the way cost half of the last one, or less.
#define LEVEL_RATIO 3.0
/// Margin of forms, as SOLID_SHARE: more makes the proof short, less the spheres few.
#define FORM_SHARE 0.01

struct lw_spheres
{
	lw_allocator memory;
	double* data; ///< [count][4]
	uint32_t count;
	lw_spheres_report report;
	bool met_target;
};

lw_spheres_def lw_spheres_def_default( void )
{
	return ( lw_spheres_def ){ .cookie = SPHERES_DEF_COOKIE };
}

/// Spheres of at most `excess` into `out` (double[4]), moved to where they need less for some rounds.
static lw_status cover_and_refine( lwi_body* body, const lwi_fragment_tree* tree, const lwi_array* sites, double excess,
	double margin, uint32_t rounds, lwi_array* out )
{
	lwi_array chosen = { 0 };
	lw_status status = lwi_enclose_cover( body, tree, sites->data, sites->count, excess, &chosen );
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
	lwi_array fragments = { 0 }, sites = { 0 };
	lwi_fragment_tree tree = { 0 };
	lw_status status = lwi_enclose_fragments( body, target, &fragments, &sites, diag );
	if ( status == LW_OK && !lwi_fragment_tree_create( fragments.data, (uint32_t)fragments.count, memory, &tree ) )
	{
		status = LW_ERROR_OUT_OF_MEMORY;
	}
	if ( status == LW_OK )
	{
		status = cover_and_refine( body, &tree, &sites, target, margin, rounds, out );
	}
	lwi_fragment_tree_free( &tree, memory );
	lwi_array_free( &fragments, memory, sizeof( lwi_fragment ) );
	lwi_array_free( &sites, memory, sizeof( lwi_site ) );
	if ( status == LW_OK && body->any_solid )
	{
		double gap;
		lw_vec3 at;
		status = lwi_enclose_voids( body, out, margin, target, &gap, &at ) < 0 ? LW_ERROR_OUT_OF_MEMORY : LW_OK;
	}
	return status;
}

// --- proved sets -----------------------------------------------------------------------------------------------------

/// Spheres with their proof.
typedef struct cover_set
{
	lwi_array spheres; ///< double[4]
	lw_spheres_report report;
} cover_set;

/// Centres to the nearest multiple of 10^-decimals, radii up to one that makes up for it.
static void round_outward( lwi_array* spheres, uint32_t decimals )
{
	double scale = pow( 10, decimals ), *data = spheres->data;
	for ( size_t i = 0; i < spheres->count; ++i, data += 4 )
	{
		lw_vec3 c = lwi_load( data );
		for ( int k = 0; k < 3; ++k )
		{
			// a quotient of integers: the double nearest to the decimals, the same that reading them gives
			data[k] = rint( data[k] * scale ) / scale;
		}
		data[3] = ceil( ( data[3] + lwi_distance( c, lwi_load( data ) ) ) * scale * ( 1 + 1e-9 ) ) / scale;
	}
}

/// Bound on the excess added by rounding to so many decimals: a centre moves by at most sqrt(3)/2 of a unit, and a radius
/// grows by that and one unit.
static double rounding_of( uint32_t decimals )
{
	return decimals > 0 ? 3 / pow( 10, decimals ) : 0;
}

/// Rounds and proves. LW_ERROR_UNSUPPORTED if the proof fails.
static lw_status prove( lwi_body* body, const lw_spheres_def* def, cover_set* set, lw_diag* diag )
{
	if ( def->decimals > 0 )
	{
		round_outward( &set->spheres, def->decimals );
	}
	lw_status status =
		lwi_enclose_check( body, &def->body, set->spheres.data, (uint32_t)set->spheres.count, diag, &set->report );
	if ( status == LW_OK && !set->report.encloses )
	{
		status = lwi_fail( diag, LW_ERROR_UNSUPPORTED, LW_INVALID_INDEX,
			"the spheres found could not be proved to enclose the body near (%g, %g, %g); use another excess",
			set->report.uncovered_at.x, set->report.uncovered_at.y, set->report.uncovered_at.z );
	}
	return status;
}

static lw_status cover_by_excess( lwi_body* body, const lw_spheres_def* def, double excess, uint32_t rounds, cover_set* set,
	lw_diag* diag )
{
	set->spheres.count = 0;
	double target = excess - rounding_of( def->decimals );
	lw_status status = enclose_by_excess( body, target, rounds, &set->spheres, diag );
	return status == LW_OK ? prove( body, def, set, diag ) : status;
}

/// One sphere around everything. It is made whether or not the search is stopped.
static lw_status cover_by_one( lwi_body* body, const lw_spheres_def* def, cover_set* set, lw_diag* diag )
{
	lw_shape_info info = lw_shape_get_info( body->surface );
	lw_vec3 c = lwi_load( info.sphere_center );
	// a margin that is no matter for such a sphere makes its proof easy
	const double sphere[4] = { c.x, c.y, c.z, 1.01 * ( info.sphere_radius + body->dilation_max ) + 16 * body->slack };
	set->spheres.count = 0;
	if ( !lwi_array_push( &set->spheres, &body->memory, sizeof( sphere ), sphere ) )
	{
		return LW_ERROR_OUT_OF_MEMORY;
	}
	bool stopped = body->stopped;
	body->stop = NULL;
	body->stopped = false;
	lw_status status = prove( body, def, set, diag );
	body->stop = def->stop;
	body->stopped = stopped;
	return status;
}

/// Spheres by formulas, where each shape has one. Without spheres, or with too much excess, there are none.
static lw_status cover_by_forms( lwi_body* body, const lw_spheres_def* def, cover_set* set, lw_diag* diag )
{
	bool made;
	double target = def->excess - rounding_of( def->decimals );
	set->spheres.count = 0;
	lw_status status = lwi_enclose_forms( body, &def->body, target, FORM_SHARE * target, &set->spheres, &made );
	status = status == LW_OK && made ? prove( body, def, set, diag ) : status;
	if ( status != LW_OK || !made || !( set->report.excess <= def->excess ) )
	{
		set->spheres.count = 0;
	}
	return status == LW_ERROR_UNSUPPORTED || body->stopped ? LW_OK : status;
}

static void keep( cover_set* best, cover_set* set )
{
	cover_set swap = *best;
	*best = *set;
	*set = swap;
}

/// Sets of ever smaller excess down to the wanted one, each at LEVEL_RATIO of the last, until the search is stopped.
static lw_status search_levels( lwi_body* body, const lw_spheres_def* def, cover_set* best, cover_set* set, bool* met,
	lw_diag* diag )
{
	lw_status status = cover_by_one( body, def, best, diag );
	if ( status != LW_OK )
	{
		return status;
	}
	int level = 0;
	while ( LEVEL_RATIO * def->excess * pow( LEVEL_RATIO, level ) < best->report.excess )
	{
		++level;
	}
	for ( ; status == LW_OK && level >= 0 && !body->stopped; --level )
	{
		status = cover_by_excess( body, def, def->excess * pow( LEVEL_RATIO, level ), 0, set, diag );
		if ( status == LW_OK )
		{
			keep( best, set );
			*met = level == 0;
		}
	}
	return body->stopped || status == LW_ERROR_UNSUPPORTED ? LW_OK : status;
}

/// The fewer of form and search. A form of many spheres spares the search, which takes milliseconds for each.
static lw_status fill_by_excess( lwi_body* body, const lw_spheres_def* def, cover_set* best, cover_set* set, bool* met,
	lw_diag* diag )
{
	lw_status status = cover_by_forms( body, def, best, diag );
	if ( status != LW_OK )
	{
		return status;
	}
	bool formed = best->spheres.count > 0;
	if ( !formed && def->stop != NULL )
	{
		return search_levels( body, def, best, set, met, diag );
	}
	*met = true;
	if ( best->spheres.count > ( def->body.shape_count > 1 ? FORMS_ENOUGH : FORM_ENOUGH ) || best->spheres.count == 1 )
	{
		return LW_OK;
	}
	status = cover_by_excess( body, def, def->excess, 0, set, diag );
	if ( status == LW_OK && ( !formed || set->spheres.count < best->spheres.count ) )
	{
		keep( best, set );
	}
	return formed && ( body->stopped || status == LW_ERROR_UNSUPPORTED ) ? LW_OK : status;
}

/// The least excess, to a few percent, for which at most so many spheres are found. Their number is no monotone function of
/// the excess, but each set that is kept was computed.
static lw_status fill_by_count( lwi_body* body, const lw_spheres_def* def, cover_set* best, cover_set* set, bool* met,
	lw_diag* diag )
{
	lw_status status = cover_by_one( body, def, best, diag );
	if ( status != LW_OK )
	{
		return status;
	}
	double high = best->report.excess, low = 0;
	for ( int i = 0; i < COUNT_STEPS && high > 1.03 * low && status == LW_OK; ++i )
	{
		double middle = low > 0 ? sqrt( low * high ) : 0.4 * high;
		status = cover_by_excess( body, def, middle, 0, set, diag );
		bool few = status == LW_OK && set->spheres.count <= def->sphere_count;
		if ( few )
		{
			keep( best, set );
		}
		high = few ? middle : high;
		low = few ? low : middle;
		status = status == LW_ERROR_UNSUPPORTED ? LW_OK : status;
	}
	if ( status == LW_OK )
	{
		status = cover_by_excess( body, def, high, REFINE_ROUNDS, set, diag );
		if ( status == LW_OK && set->spheres.count <= def->sphere_count && set->report.excess < best->report.excess )
		{
			keep( best, set );
		}
	}
	*met = !body->stopped;
	return body->stopped || status == LW_ERROR_UNSUPPORTED ? LW_OK : status;
}

// --- public ----------------------------------------------------------------------------------------------------------

static lw_status make_body( const lw_geometry_def* def, double grain, bool ( *stop )( void* ), void* user,
	const lw_allocator* memory, lw_diag* diag, lwi_body* out )
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
		status = lwi_body_create( parts, def->shape_count, def->close_holes, grain, stop, user, memory, diag, out );
	}
	lwi_free( memory, parts, def->shape_count * sizeof( lwi_body_part ) );
	return status;
}

static lw_status fill( lw_spheres* out, lwi_body* body, const lw_spheres_def* def, lw_diag* diag )
{
	cover_set best = { 0 }, set = { 0 };
	lw_status status = def->excess > 0 ? fill_by_excess( body, def, &best, &set, &out->met_target, diag )
									   : fill_by_count( body, def, &best, &set, &out->met_target, diag );
	if ( status == LW_OK )
	{
		size_t size = 4 * best.spheres.count * sizeof( double );
		out->data = lwi_alloc( &out->memory, size );
		status = out->data != NULL ? LW_OK : LW_ERROR_OUT_OF_MEMORY;
		if ( status == LW_OK )
		{
			memcpy( out->data, best.spheres.data, size );
			out->count = (uint32_t)best.spheres.count;
			out->report = best.report;
		}
	}
	lwi_array_free( &best.spheres, &out->memory, 4 * sizeof( double ) );
	lwi_array_free( &set.spheres, &out->memory, 4 * sizeof( double ) );
	return status == LW_ERROR_OUT_OF_MEMORY ? lwi_out_of_memory( diag, "enclosing spheres" ) : status;
}

lw_status lw_spheres_create( const lw_spheres_def* def, const lw_allocator* allocator, lw_diag* diag,
	lw_spheres** out_spheres )
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
	if ( def->decimals > 12 )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX,
			"decimals is %u; give at most 12, or 0 for numbers as found", def->decimals );
	}
	lw_allocator memory = lwi_allocator_or_default( allocator );
	lwi_body body;
	lw_status status = make_body( &def->body, def->excess, def->stop, def->user, &memory, diag, &body );
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

bool lw_spheres_met_target( const lw_spheres* spheres )
{
	return spheres->met_target;
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
	const lw_allocator* allocator, lw_diag* diag, lw_spheres_report* out )
{
	if ( body_def == NULL || out == NULL || ( spheres == NULL && count > 0 ) )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, "body, spheres or out is NULL" );
	}
	*out = ( lw_spheres_report ){ .uncovered = INFINITY, .excess = INFINITY };
	for ( uint32_t i = 0; i < count; ++i )
	{
		const double* s = spheres + 4 * (size_t)i;
		if ( !lwi_coordinates_valid( s ) || !( s[3] >= 0 && s[3] <= LWI_MAX_COORDINATE ) )
		{
			return lwi_fail( diag, LW_ERROR_BAD_GEOMETRY, i,
				"sphere %u is (%g, %g, %g), radius %g; give finite metres, a radius of 0 or more", i, s[0], s[1], s[2],
				s[3] );
		}
	}
	lw_allocator memory = lwi_allocator_or_default( allocator );
	lwi_body body;
	lw_status status = make_body( body_def, 0, NULL, NULL, &memory, diag, &body );
	if ( status == LW_OK )
	{
		status = lwi_enclose_check( &body, body_def, spheres, count, diag, out );
		lwi_body_free( &body );
	}
	return status;
}
