// SPDX-License-Identifier: BSD-3-Clause
// Judges spheres against a body, whoever made them: is everything in them, and how far do they reach beyond it?
//
// Nothing of the search is trusted here. A triangle is in the spheres if it can be cut into fragments that are each in one
// sphere (balls are convex: a fragment is in one if its corners are). Derivations: core/docs/detail.md.
#include "approximate/enclose.h"

#include "base/math_inline.h"
#include "shape/shape.h"

enum
{
	MAX_CUTS = 48 ///< of one triangle; each three halve its size
};

/// Fragments below this share of the body may fail their proof without being reported as uncovered.
#define FINEST 1e-8
/// Once something is uncovered only its extent is of interest.
#define COARSEST 0.01
/// The attained excess is within this share of the largest one over all spheres.
#define ATTAINED_SHARE 1e-3
/// Solids: how deep in the spheres their surface must be, as a share of the body's size.
#define SOLID_MARGIN 1e-5

typedef struct checker
{
	const double* spheres;
	uint32_t count;
	double slack, finest, coarsest;
	lw_spheres_report* report;
	const lw_allocator* memory;
	lwi_array list; ///< uint32_t: spheres that meet the current triangle
} checker;

static double gap_of( const checker* c, const uint32_t* list, size_t count, lw_vec3 p, double dilation )
{
	double gap = INFINITY;
	for ( size_t i = 0; i < count; ++i )
	{
		const double* s = c->spheres + 4 * (size_t)( list != NULL ? list[i] : i );
		gap = fmin( gap, lwi_distance( p, lwi_load( s ) ) + dilation - s[3] );
	}
	return gap;
}

/// Something at p is in no sphere (gap > 0: certainly), or its proof failed.
static void note_uncovered( checker* c, lw_vec3 p, double gap )
{
	if ( c->report->encloses || gap > c->report->uncovered )
	{
		c->report->uncovered = gap > 0 ? gap : 0;
		c->report->uncovered_at = p;
	}
	c->report->encloses = false;
}

static bool fragment_covered( const checker* c, const lw_vec3 v[3], double dilation )
{
	const uint32_t* list = c->list.data;
	for ( size_t i = 0; i < c->list.count; ++i )
	{
		const double* s = c->spheres + 4 * (size_t)list[i];
		lw_vec3 center = lwi_load( s );
		double room = s[3] - dilation - c->slack;
		if ( lwi_distance( v[0], center ) <= room && lwi_distance( v[1], center ) <= room &&
			 lwi_distance( v[2], center ) <= room )
		{
			return true;
		}
	}
	return false;
}

/// Of the part of a thick fragment that is on the side of a plane, the farthest point from a centre on that side: `share` from
/// the centre, with normal n away from it. INFINITY if the fragment is not wholly beyond the centre.
static double half_reach( const lw_vec3 v[3], double dilation, lw_vec3 center, lw_vec3 n, double share )
{
	double low = INFINITY, high = -INFINITY, aside = 0;
	for ( int k = 0; k < 3; ++k )
	{
		lw_vec3 d = lwi_sub( v[k], center );
		double along = lwi_dot( d, n );
		low = fmin( low, along );
		high = fmax( high, along );
		aside = fmax( aside, lwi_length( lwi_sub( d, lwi_scale( along, n ) ) ) );
	}
	double a = lwi_clamp( share, low, high );
	return low >= 0 ? sqrt( fmax( 2 * a * share - a * a, 0 ) + ( aside + dilation ) * ( aside + dilation ) ) : INFINITY;
}

/// A thick fragment between two spheres, each of which contains the part on its side of the plane of their intersection.
static bool fragment_shared( const checker* c, const lw_vec3 v[3], double dilation )
{
	const uint32_t* list = c->list.data;
	lw_vec3 middle = lwi_scale( 1.0 / 3, lwi_add( lwi_add( v[0], v[1] ), v[2] ) );
	const double* a = NULL;
	double least = INFINITY;
	for ( size_t i = 0; i < c->list.count && dilation > 0; ++i )
	{
		const double* s = c->spheres + 4 * (size_t)list[i];
		double gap = lwi_distance( middle, lwi_load( s ) ) - s[3];
		a = gap < least ? s : a;
		least = fmin( least, gap );
	}
	for ( size_t i = 0; i < c->list.count && a != NULL; ++i )
	{
		const double* b = c->spheres + 4 * (size_t)list[i];
		lw_vec3 d = lwi_sub( lwi_load( b ), lwi_load( a ) );
		double center_distance = lwi_length( d );
		if ( !( center_distance > 0 ) || center_distance >= a[3] + b[3] )
		{
			continue;
		}
		lw_vec3 n = lwi_scale( 1 / center_distance, d );
		double share = 0.5 * ( center_distance + ( a[3] - b[3] ) / center_distance * ( a[3] + b[3] ) );
		if ( half_reach( v, dilation, lwi_load( a ), n, share ) <= a[3] - c->slack &&
			 half_reach( v, dilation, lwi_load( b ), lwi_scale( -1, n ), center_distance - share ) <= b[3] - c->slack )
		{
			return true;
		}
	}
	return false;
}

/// @return false if the check was stopped
static bool check_triangle( lwi_body* body, checker* c, const lw_vec3 triangle[3], double dilation )
{
	struct
	{
		lw_vec3 v[3];
		int cuts;
	} stack[MAX_CUTS + 2];
	memcpy( stack[0].v, triangle, sizeof( stack[0].v ) );
	stack[0].cuts = 0;
	int height = 1;
	while ( height > 0 )
	{
		if ( lwi_body_stopped( body ) )
		{
			return false;
		}
		--height;
		lw_vec3 v[3] = { stack[height].v[0], stack[height].v[1], stack[height].v[2] };
		if ( fragment_covered( c, v, dilation ) || fragment_shared( c, v, dilation ) )
		{
			continue;
		}
		int cuts = stack[height].cuts, l = 0;
		double longest = -1;
		for ( int k = 0; k < 3; ++k )
		{
			double length = lwi_distance( v[k], v[( k + 1 ) % 3] );
			l = length > longest ? k : l;
			longest = fmax( longest, length );
		}
		lw_vec3 center = lwi_scale( 1.0 / 3, lwi_add( lwi_add( v[0], v[1] ), v[2] ) );
		double gap = gap_of( c, c->list.data, c->list.count, center, dilation );
		gap = gap < INFINITY ? gap : gap_of( c, NULL, c->count, center, dilation );
		const lw_vec3 point[3] = { center, center, center };
		if ( gap > 0 && fragment_shared( c, point, dilation ) )
		{
			gap = 0;
		}
		bool fine = longest <= ( c->report->encloses ? c->finest : c->coarsest ) || cuts == MAX_CUTS;
		if ( gap > c->slack || fine )
		{
			note_uncovered( c, center, gap );
		}
		// no point of the fragment is farther than that from its centre
		if ( fine || ( !c->report->encloses && gap + longest <= c->report->uncovered ) )
		{
			continue;
		}
		lw_vec3 middle = lwi_scale( 0.5, lwi_add( v[l], v[( l + 1 ) % 3] ) );
		for ( int half = 0; half < 2; ++half )
		{
			memcpy( stack[height].v, v, sizeof( v ) );
			stack[height].v[half == 0 ? ( l + 1 ) % 3 : l] = middle;
			stack[height++].cuts = cuts + 1;
		}
	}
	return true;
}

/// The spheres that meet the smallest sphere about the corners' mean.
static bool list_near( checker* c, const lw_vec3 v[3], double dilation )
{
	lw_vec3 center = lwi_scale( 1.0 / 3, lwi_add( lwi_add( v[0], v[1] ), v[2] ) );
	double size = fmax( lwi_distance( center, v[0] ), fmax( lwi_distance( center, v[1] ), lwi_distance( center, v[2] ) ) );
	c->list.count = 0;
	if ( !lwi_array_reserve( &c->list, c->memory, sizeof( uint32_t ), c->count ) )
	{
		return false;
	}
	uint32_t* list = c->list.data;
	for ( uint32_t i = 0; i < c->count; ++i )
	{
		const double* s = c->spheres + 4 * (size_t)i;
		lw_vec3 d = lwi_sub( center, lwi_load( s ) );
		double sum = ( s[3] + size + dilation ) * ( 1 + 1e-9 );
		if ( lwi_length_sq( d ) <= sum * sum )
		{
			list[c->list.count++] = i;
		}
	}
	return true;
}

static bool check_surface( lwi_body* body, checker* c )
{
	const lw_shape* mesh = body->surface;
	bool ok = true;
	for ( uint32_t t = 0; ok && t < mesh->item_count; ++t )
	{
		lw_vec3 v[3];
		for ( size_t k = 0; k < 3; ++k )
		{
			v[k] = lwi_load( mesh->vertices + 3 * (size_t)mesh->indices[3 * (size_t)t + k] );
		}
		ok = list_near( c, v, body->dilation[t] ) && check_triangle( body, c, v, body->dilation[t] );
	}
	return ok;
}

/// Distance of a point to the body: 0 inside.
static double distance_to_body( lwi_body* body, lw_vec3 p )
{
	double depth = lwi_body_depth( body, p, true );
	return depth > 0 ? 0 : -depth;
}

/// A far point of a sphere: straight out from the nearest point of the surface, or for a centre on it along the normal.
static double attained_by( lwi_body* body, lw_vec3 center, double radius )
{
	const lw_shape* mesh = body->surface;
	bool inside = body->outer != NULL && lwi_body_encloses( body, center );
	lwi_nearest x = lwi_shape_nearest( inside ? body->outer : mesh, center, INFINITY, false, NULL, 0 );
	lw_vec3 out = inside ? lwi_sub( x.point, center ) : lwi_sub( center, x.point );
	double length = lwi_length( out );
	if ( !( length > 1e-6 * radius ) )
	{
		const lw_shape* of = inside ? body->outer : mesh;
		const uint32_t* index = of->indices + 3 * (size_t)x.triangle;
		lw_vec3 a = lwi_load( of->vertices + 3 * (size_t)index[0] ), b = lwi_load( of->vertices + 3 * (size_t)index[1] );
		out = lwi_cross( lwi_sub( b, a ), lwi_sub( lwi_load( of->vertices + 3 * (size_t)index[2] ), a ) );
		length = lwi_length( out );
	}
	double best = 0;
	for ( int side = 0; length > 0 && side < ( inside ? 1 : 2 ); ++side )
	{
		lw_vec3 p = lwi_add_scaled( center, ( side == 0 ? radius : -radius ) / length, out );
		best = fmax( best, distance_to_body( body, p ) );
	}
	return best;
}

/// @return false if the check was stopped
static bool check_excess( lwi_body* body, const checker* c )
{
	lw_spheres_report* report = c->report;
	for ( uint32_t i = 0; i < c->count; ++i )
	{
		if ( lwi_body_stopped( body ) )
		{
			return false;
		}
		const double* s = c->spheres + 4 * (size_t)i;
		lw_vec3 center = lwi_load( s );
		double depth = lwi_body_depth( body, center, true );
		report->deep_spheres += depth > 0 ? 1 : 0;
		report->excess = fmax( report->excess, s[3] - depth );
		if ( s[3] - depth > ( 1 + ATTAINED_SHARE ) * report->excess_attained )
		{
			report->excess_attained = fmax( report->excess_attained, attained_by( body, center, s[3] ) );
		}
	}
	report->excess += body->chord;
	report->excess_attained = fmin( report->excess_attained, report->excess );
	return true;
}

static lw_status check_solids( lwi_body* body, const checker* c, double margin )
{
	lwi_array spheres = { 0 };
	double gap = 0;
	lw_vec3 at = { 0, 0, 0 };
	int closed = -1;
	if ( lwi_array_reserve( &spheres, c->memory, 4 * sizeof( double ), c->count ) )
	{
		memcpy( spheres.data, c->spheres, 4 * (size_t)c->count * sizeof( double ) );
		spheres.count = c->count;
		closed = lwi_enclose_voids( body, &spheres, margin, 0, &gap, &at );
	}
	lwi_array_free( &spheres, c->memory, 4 * sizeof( double ) );
	if ( closed == 0 )
	{
		c->report->encloses = false;
		c->report->uncovered = gap;
		c->report->uncovered_at = at;
	}
	return closed < 0 ? LW_ERROR_OUT_OF_MEMORY : LW_OK;
}

/// Proves the shapes one by one, where each is a box, a cylinder, a capsule or a sphere.
/// @return 1 proved, 0 not, or for other shapes; -1 out of memory or stopped
static int check_primitives( lwi_body* body, checker* c, const lw_geometry_def* def )
{
	for ( uint32_t i = 0; i < def->shape_count; ++i )
	{
		lw_shape_type type = def->shapes[i]->type;
		if ( type != LW_SHAPE_BOX && type != LW_SHAPE_CYLINDER && type != LW_SHAPE_CAPSULE && type != LW_SHAPE_SPHERE )
		{
			return 0;
		}
	}
	for ( uint32_t i = 0; i < def->shape_count; ++i )
	{
		const lw_shape* shape = def->shapes[i];
		lw_transform pose = def->body_from_shape != NULL ? def->body_from_shape[i] : lw_transform_identity();
		double half = shape->type == LW_SHAPE_CAPSULE ? 0.5 * shape->dimensions[1] : 0;
		lw_vec3 end = lwi_transform( &pose, lwi_v3( 0, 0, half ) );
		const lw_vec3 axis[3] = { lwi_transform( &pose, lwi_v3( 0, 0, -half ) ), end, end };
		bool solid = shape->type == LW_SHAPE_BOX || shape->type == LW_SHAPE_CYLINDER;
		int proved = solid ? lwi_enclose_solid( body, shape, &pose, c->spheres, c->count )
					 : list_near( c, axis, shape->dimensions[0] ) && check_triangle( body, c, axis, shape->dimensions[0] )
						 ? ( c->report->encloses ? 1 : 0 )
						 : -1;
		if ( proved != 1 )
		{
			return proved;
		}
	}
	return 1;
}

lw_status lwi_enclose_check( lwi_body* body, const lw_geometry_def* def, const double* spheres, uint32_t count,
	lw_diag* diag, lw_spheres_report* out )
{
	*out = ( lw_spheres_report ){ .encloses = true,
		.shells = body->shell_count,
		.open_shells = body->open_shells,
		.holes = body->holes,
		.widest_hole = body->widest_hole,
		.widest_open_hole = body->widest_open_hole };
	double size = lw_shape_get_info( body->surface ).sphere_radius + body->dilation_max;
	double margin = body->any_solid ? SOLID_MARGIN * size : 0;
	checker c = { .spheres = spheres,
		.count = count,
		.slack = body->slack,
		.finest = FINEST * size,
		.coarsest = COARSEST * size,
		.report = out,
		.memory = &body->memory };
	int proved = check_primitives( body, &c, def );
	bool ok = proved >= 0;
	if ( proved == 0 )
	{
		// once more by the surface: this proof finds the open parts
		out->encloses = true;
		out->uncovered = 0;
		c.slack += margin;
		ok = check_surface( body, &c );
	}
	lw_status status = LW_ERROR_OUT_OF_MEMORY;
	if ( ok && check_excess( body, &c ) )
	{
		status = out->encloses && proved == 0 ? check_solids( body, &c, margin ) : LW_OK;
	}
	lwi_array_free( &c.list, &body->memory, sizeof( uint32_t ) );
	return status == LW_OK ? LW_OK : lwi_out_of_memory( diag, "the check of spheres" );
}
