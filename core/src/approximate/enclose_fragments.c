// SPDX-License-Identifier: BSD-3-Clause
// Cuts a body's triangles into fragments that single spheres can cover, and finds a site for each.
//
// Ma, Bae, Choi, "3D medial axis point approximation using nearest neighbors and the normal field", 2012 (shrinking
//   balls); Stolpner, Kry, Siddiqi, "Medial spheres for shape approximation", 2012 (inner medial spheres, dilated, cover a
//   solid); Rivara, "Algorithms for refining triangular grids", 1984 (longest-edge bisection).
#include "approximate/enclose.h"

#include "base/math_inline.h"
#include "shape/mesh.h"
#include "shape/shape.h"

enum
{
	MAX_SPLITS = 60,      ///< of one triangle; each three of them halve it
	MAX_SHRINKS = 40,     ///< steps of one shrinking ball; rarely more than 8
	MAX_PIECES = 1500000, ///< above that the excess is too small for the body
	PLACES = 1 << 15      ///< of sites that are remembered, by where they were found; a power of 2
};

/// Size of a fragment relative to the patch of a plane that a sphere of the site's depth covers, of radius sqrt( 2 d e + e^2 ).
/// Larger fragments waste the part of a sphere's patch that holds no whole fragment; smaller ones cost time in proportion to their
/// square.
#define PIECE_SHARE 0.3
/// A ball may reach this share of the excess through the surface while it shrinks: facets of a round body then do not
/// stop it (the medial axis has a branch to each convex edge, however blunt).
#define BALL_SHARE 0.12

/// Distance from the surface, as a share of the excess, of the first point of a side that is tested for being inside.
/// Thinner walls have no ball worth a search.
#define FIRST_LOOK 0.02

/// Fragments in a cell of this share of the excess, and with normals alike, share the sites of the first of them, if these
/// cover them: of a fine mesh there are many more triangles than it needs sites.
#define PLACE_SHARE 0.1

/// A cell of fragments, and the sites found for the first of them.
typedef struct place
{
	int64_t cell[3];
	uint32_t facing; ///< largest coordinate of the normal, and its sign; 0: none has been here
	uint32_t count;
	size_t first; ///< site
} place;

typedef struct cutter
{
	lwi_body* body;
	double excess, largest; ///< largest: radius at which balls begin
	lwi_array* fragments;
	lwi_array* sites;
	place* places; ///< [PLACES]; of two that meet in one the later one stays
} cutter;

/// The largest ball on one side of the surface at q, about q + r n, that protrudes little. False if it is not inside.
static bool shrink_ball( const cutter* cut, lw_vec3 q, lw_vec3 n, lwi_site* out )
{
	const lwi_body* body = cut->body;
	double r = cut->largest, give = BALL_SHARE * cut->excess;
	for ( int i = 0; i < MAX_SHRINKS && r > give; ++i )
	{
		lw_vec3 c = lwi_add_scaled( q, r, n );
		lwi_nearest x = lwi_shape_nearest( body->outer, c, r - give, false, NULL, 0 );
		if ( x.distance == INFINITY )
		{
			out->center = c;
			out->depth = lwi_shape_nearest( body->outer, c, INFINITY, false, NULL, 0 ).distance;
			return lwi_body_encloses( cut->body, c );
		}
		lw_vec3 d = lwi_sub( x.point, q );
		double along = lwi_dot( n, d );
		double touching = along > 0 ? lwi_length_sq( d ) / ( 2 * along ) : 0;
		r = touching < 0.95 * r ? touching : 0.95 * r;
	}
	return false;
}

static double longest_edge( const lw_vec3 v[3], int* at )
{
	double longest = -1;
	for ( int k = 0; k < 3; ++k )
	{
		double length = lwi_distance( v[k], v[( k + 1 ) % 3] );
		if ( length > longest )
		{
			longest = length;
			*at = k;
		}
	}
	return longest;
}

static lwi_fragment make_fragment( const lw_vec3 v[3], double dilation )
{
	lwi_fragment fragment = { .corner = { v[0], v[1], v[2] }, .dilation = dilation };
	fragment.center = lwi_scale( 1.0 / 3, lwi_add( lwi_add( v[0], v[1] ), v[2] ) );
	for ( int k = 0; k < 3; ++k )
	{
		fragment.size = fmax( fragment.size, lwi_distance( fragment.center, v[k] ) );
	}
	// a little for its length, so that segments and points count too
	fragment.weight =
		0.5 * lwi_length( lwi_cross( lwi_sub( v[1], v[0] ), lwi_sub( v[2], v[0] ) ) ) + 1e-6 * fragment.size + 1e-12;
	return fragment;
}

static bool covers( const lwi_site* site, double excess, const lwi_fragment* fragment )
{
	return lwi_fragment_reach( fragment, site->center ) <= site->depth + excess;
}

static double patch_of( const lwi_site* site, double excess )
{
	return sqrt( 2 * fmax( site->depth, 0 ) * excess + excess * excess );
}

/// The cell of a fragment.
static place place_of( const cutter* cut, const lwi_fragment* fragment, lw_vec3 normal )
{
	double size = PLACE_SHARE * cut->excess, x = fabs( normal.x ), y = fabs( normal.y ), z = fabs( normal.z );
	uint32_t facing = x >= y && x >= z ? ( normal.x > 0 ? 1 : 2 ) : y >= z ? ( normal.y > 0 ? 3 : 4 ) : normal.z > 0 ? 5 : 6;
	return ( place ){ .cell = { (int64_t)floor( fragment->center.x / size ), (int64_t)floor( fragment->center.y / size ),
						  (int64_t)floor( fragment->center.z / size ) },
		.facing = facing };
}

static place* remembered( const cutter* cut, const place* p )
{
	uint64_t hash = p->facing;
	for ( int k = 0; k < 3; ++k )
	{
		hash = ( hash ^ (uint64_t)p->cell[k] ) * 0x9e3779b97f4a7c15u; // 2^64 over the golden ratio
		hash ^= hash >> 29;
	}
	return &cut->places[hash & ( PLACES - 1 )];
}

/// True if the first fragment of this one's cell has sites, and one of them covers this fragment too.
static bool is_served( const cutter* cut, const place* here, const lwi_fragment* fragment )
{
	const place* there = remembered( cut, here );
	if ( there->facing != here->facing || memcmp( there->cell, here->cell, sizeof( here->cell ) ) != 0 )
	{
		return false;
	}
	const lwi_site* sites = cut->sites->data;
	for ( size_t i = there->first; i < there->first + there->count; ++i )
	{
		if ( fragment->size <= PIECE_SHARE * patch_of( &sites[i], cut->excess ) &&
			 covers( &sites[i], cut->excess, fragment ) )
		{
			return true;
		}
	}
	return false;
}

/// Keeps a fragment with its site. @return 1 kept, 0 it must be cut, -1 out of memory
static int keep_fragment( const cutter* cut, const lwi_fragment* fragment )
{
	const lw_allocator* memory = &cut->body->memory;
	lwi_site sites[3];
	int count = 0;
	lw_vec3 normal = lwi_cross( lwi_sub( fragment->corner[1], fragment->corner[0] ),
		lwi_sub( fragment->corner[2], fragment->corner[0] ) );
	place here = place_of( cut, fragment, normal );
	if ( is_served( cut, &here, fragment ) )
	{
		return lwi_array_push( cut->fragments, memory, sizeof( lwi_fragment ), fragment ) ? 1 : -1;
	}
	double length = lwi_length( normal );
	for ( int side = 0; side < 2 && length > 0 && cut->body->outer != NULL; ++side )
	{
		lw_vec3 n = lwi_scale( ( side == 0 ? -1 : 1 ) / length, normal );
		// outside of all shells there is no ball to be found, and the search for it would be the longest
		bool inside = lwi_body_encloses( cut->body, lwi_add_scaled( fragment->center, FIRST_LOOK * cut->excess, n ) );
		count += inside && shrink_ball( cut, fragment->center, n, &sites[count] ) ? 1 : 0;
	}
	if ( count == 2 && sites[1].depth > sites[0].depth )
	{
		lwi_site swap = sites[0];
		sites[0] = sites[1];
		sites[1] = swap;
	}
	if ( fragment->size > PIECE_SHARE * patch_of( count > 0 ? &sites[0] : &( lwi_site ){ .depth = 0 }, cut->excess ) )
	{
		return 0;
	}
	if ( count == 0 || !covers( &sites[0], cut->excess, fragment ) )
	{
		// on the surface itself: the excess is the radius
		lwi_site own = { fragment->center, lwi_body_depth( cut->body, fragment->center, false ) };
		if ( !covers( &own, 0.9 * cut->excess, fragment ) )
		{
			return 0;
		}
		for ( int k = count++; k > 0; --k )
		{
			sites[k] = sites[k - 1];
		}
		sites[0] = own;
	}
	if ( !lwi_array_push( cut->fragments, memory, sizeof( lwi_fragment ), fragment ) )
	{
		return -1;
	}
	here.first = cut->sites->count;
	here.count = (uint32_t)count;
	*remembered( cut, &here ) = here;
	for ( int k = 0; k < count; ++k )
	{
		if ( !lwi_array_push( cut->sites, memory, sizeof( lwi_site ), &sites[k] ) )
		{
			return -1;
		}
	}
	return 1;
}

static lw_status too_many( const cutter* cut, lw_diag* diag )
{
	return lwi_fail( diag, LW_ERROR_UNSUPPORTED, LW_INVALID_INDEX,
		"an excess of %g m takes more than %d fragments of this body; allow more", cut->excess, (int)MAX_PIECES );
}

/// The size that no fragment exceeds: the share of the patch of the deepest point there can be.
static double largest_fragment( const cutter* cut )
{
	return PIECE_SHARE * sqrt( 2 * cut->largest * cut->excess + cut->excess * cut->excess );
}

static lw_status cut_triangle( const cutter* cut, const lw_vec3 triangle[3], double dilation, lw_diag* diag )
{
	double most = largest_fragment( cut ); // above that size no ball needs to be tried
	struct
	{
		lw_vec3 v[3];
		int splits;
	} stack[MAX_SPLITS + 2];
	memcpy( stack[0].v, triangle, sizeof( stack[0].v ) );
	stack[0].splits = 0;
	int height = 1;
	while ( height > 0 )
	{
		--height;
		lw_vec3 v[3] = { stack[height].v[0], stack[height].v[1], stack[height].v[2] };
		int splits = stack[height].splits, l = 0;
		longest_edge( v, &l );
		lwi_fragment fragment = make_fragment( v, dilation );
		int kept = fragment.size > most ? 0 : keep_fragment( cut, &fragment );
		if ( kept < 0 || lwi_body_stopped( cut->body ) )
		{
			return LW_ERROR_OUT_OF_MEMORY;
		}
		if ( kept > 0 )
		{
			continue;
		}
		if ( splits == MAX_SPLITS || cut->fragments->count > MAX_PIECES )
		{
			return too_many( cut, diag );
		}
		lw_vec3 middle = lwi_scale( 0.5, lwi_add( v[l], v[( l + 1 ) % 3] ) );
		for ( int half = 0; half < 2; ++half )
		{
			memcpy( stack[height].v, v, sizeof( v ) );
			stack[height].v[half == 0 ? ( l + 1 ) % 3 : l] = middle;
			stack[height++].splits = splits + 1;
		}
	}
	return LW_OK;
}

static void load_triangle( const lw_shape* mesh, uint32_t triangle, lw_vec3 v[3] )
{
	for ( size_t k = 0; k < 3; ++k )
	{
		v[k] = lwi_load( mesh->vertices + 3 * (size_t)mesh->indices[3 * (size_t)triangle + k] );
	}
}

lw_status lwi_enclose_fragments( lwi_body* body, double excess, lwi_array* fragments, lwi_array* sites, lw_diag* diag )
{
	const lw_shape* mesh = body->surface;
	lw_shape_info info = lw_shape_get_info( mesh );
	cutter cut = { body, excess, info.sphere_radius, fragments, sites, NULL };
	// a fragment of size s has an area of at most 1.3 s^2 (the equilateral triangle): a cut into too many fragments is not begun
	double area = 0, most = largest_fragment( &cut );
	for ( uint32_t t = 0; t < mesh->item_count; ++t )
	{
		lw_vec3 v[3];
		load_triangle( mesh, t, v );
		area += 0.5 * lwi_length( lwi_cross( lwi_sub( v[1], v[0] ), lwi_sub( v[2], v[0] ) ) );
	}
	if ( area > 1.3 * most * most * MAX_PIECES )
	{
		return too_many( &cut, diag );
	}
	cut.places = lwi_alloc_zero( &body->memory, PLACES, sizeof( place ) );
	lw_status status = cut.places != NULL ? LW_OK : LW_ERROR_OUT_OF_MEMORY;
	for ( uint32_t t = 0; t < mesh->item_count && status == LW_OK; ++t )
	{
		lw_vec3 v[3];
		load_triangle( mesh, t, v );
		status = cut_triangle( &cut, v, body->dilation[t], diag );
	}
	lwi_free( &body->memory, cut.places, PLACES * sizeof( place ) );
	if ( status != LW_OK )
	{
		return status;
	}
	// the smallest sphere around everything: where few spheres are wanted nothing is better
	lwi_site whole = { lwi_load( info.sphere_center ), 0 };
	whole.depth = lwi_body_depth( body, whole.center, false );
	return lwi_array_push( sites, &body->memory, sizeof( whole ), &whole ) ? LW_OK : LW_ERROR_OUT_OF_MEMORY;
}
