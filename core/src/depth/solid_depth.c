// SPDX-License-Identifier: BSD-3-Clause
// Depth of bodies that are not convex: two bounds that narrow with work.
//
// From above: wherever a was moved to and is apart from b, that translation is a way out, and it may end before, by the distance of the two.
// The convex bodies around both give the first; then a is moved along some directions until it is free, and slides along the
// surface that is nearest there. From below: two balls about one point, one in each body, part only after a translation of both radii, and
// two convex parts after one of their own depth. Then cubes of translations, the shortest first: two parts that overlap after every
// translation of a cube exclude the cube; any other cube is cut into eight (branch and bound). Derivation: core/docs/depth.md.
#include "depth/depth.h"
#include "base/exact_sign.h"

enum
{
	MOST_LOOKS = 1 << 14 ///< pairs of parts
};

typedef struct solids
{
	lwi_search_memory* memory;
	const lw_shape *a, *b;
	const lw_transform* a_from_b;
	double rounding; ///< metres
	double lower, upper;
	lw_vec3 way;              ///< translation of length `upper`, a's frame
	lw_vec3 point_a, point_b; ///< where they touch after it, each as before it
	bool are_theirs;          ///< these are points of the bodies, not of the convex ones around
	lw_vec3 normal;           ///< of the last look: from b to a
	lw_vec3 direction;        ///< of the way, of length 1
	uint32_t steps, most_steps;
} solids;

/// Distance of the bodies with a moved: a lower bound, 0 if they touch. A translation that is shorter than all before is kept.
static double look( solids* s, lw_vec3 move )
{
	lw_transform moved = *s->a_from_b;
	moved.t[0] -= move.x;
	moved.t[1] -= move.y;
	moved.t[2] -= move.z;
	const lw_range range = { 0, INFINITY, 0.05 };
	lwi_bound bound;
	lwi_bound_init( &bound, &range );
	bound.insides = true;
	s->steps++;
	lwi_search( s->memory, s->a, s->b, &moved, &bound );
	lw_clearance c;
	lwi_bound_result( &bound, &c );
	if ( c.kind != LW_CLEARANCE_NEAR )
	{
		return 0;
	}
	const lw_vec3 between = lwi_sub( bound.point_a, bound.point_b );
	s->normal = lwi_scale( 1 / lwi_length( between ), between );
	const double length = lwi_length( move ), upper = fmax( 0, length - c.lower ) + s->rounding;
	if ( upper < s->upper )
	{
		s->upper = upper;
		s->way = lwi_scale( length > 0 ? upper / length : 0, move );
		s->point_a = bound.point_a;
		s->point_b = lwi_add( bound.point_b, move );
		s->are_theirs = true;
	}
	return c.lower;
}

static bool is_over( const solids* s, double width )
{
	return s->steps >= s->most_steps || s->upper - s->lower <= width;
}

/// From a free place: the nearest place to the origin on the plane across the nearest points, again and again.
static void slide( solids* s, lw_vec3 move, double gap, double width )
{
	for ( int i = 0; i < 12 && gap > 0 && !is_over( s, width ); ++i )
	{
		const double before = s->upper;
		const lw_vec3 n = s->normal;
		const double height = lwi_dot( n, move ) - 0.98 * gap;
		lw_vec3 next = height > 0 ? lwi_scale( height, n ) : lwi_scale( 1 - gap / lwi_length( move ), move );
		gap = look( s, next );
		if ( !( gap > 0 ) ) // something else is there: half of the way
		{
			next = lwi_scale( 0.5, lwi_add( next, move ) );
			gap = look( s, next );
		}
		move = next;
		if ( s->upper > before * ( 1 - 1e-4 ) )
		{
			return;
		}
	}
}

/// Moves a along a direction until it is free.
static void search_along( solids* s, lw_vec3 direction, double width )
{
	for ( double length = s->upper / 32; length < s->upper && !is_over( s, width ); length *= 1.4 )
	{
		const lw_vec3 move = lwi_scale( length, direction );
		const double gap = look( s, move );
		if ( gap > 0 )
		{
			slide( s, move, gap, width );
			return;
		}
	}
}

/// Sum of the radii of balls about a point of a's frame; 0 if it is not inside of both.
static double balls_at( solids* s, lw_vec3 x )
{
	s->steps++;
	const double a = lwi_inner_radius( s->a, x );
	const double b = a > 0 ? lwi_inner_radius( s->b, lwi_untransform( s->a_from_b, x ) ) : 0;
	return b > 0 ? a + b - s->rounding : 0;
}

/// The best point near the segment between the two that touch after the way out.
static void find_balls( solids* s, double width )
{
	const lw_vec3 from = s->point_a, along = lwi_sub( s->point_b, from );
	lw_vec3 best = lwi_add_scaled( from, 0.5, along );
	if ( s->are_theirs ) // each end is a ball of radius 0
	{
		s->lower = fmax( s->lower, lwi_inner_radius( s->b, lwi_untransform( s->a_from_b, from ) ) - s->rounding );
		s->lower = fmax( s->lower, lwi_inner_radius( s->a, s->point_b ) - s->rounding );
	}
	double most = 0;
	for ( int i = 1; i < 8; ++i )
	{
		const lw_vec3 x = lwi_add_scaled( from, i / 8.0, along );
		const double sum = balls_at( s, x );
		best = sum > most ? x : best;
		most = fmax( sum, most );
	}
	for ( double step = 0.25 * lwi_length( along ); step > 1e-4 * s->upper; )
	{
		const double before = most;
		const lw_vec3 center = best;
		for ( int i = 0; i < 6; ++i )
		{
			const double d = i % 2 == 0 ? step : -step;
			const lw_vec3 x = lwi_add( center, lwi_v3( i / 2 == 0 ? d : 0, i / 2 == 1 ? d : 0, i / 2 == 2 ? d : 0 ) );
			const double sum = balls_at( s, x );
			best = sum > most ? x : best;
			most = fmax( sum, most );
		}
		step = most > before ? step : 0.5 * step;
		s->lower = fmax( s->lower, most );
		if ( is_over( s, width ) )
		{
			return;
		}
	}
	s->lower = fmax( s->lower, most );
}

enum
{
	RANGES = 4 ///< directions along which parts have ranges
};

/// A convex part of a body.
typedef struct part
{
	lwi_round_convex body;
	double corners[24];                 ///< memory of it
	double least[RANGES], most[RANGES]; ///< contain it, along the axes of a and the way out
} part;

/// A convex body with its inside is one part; others are their balls, boxes or triangles.
static bool is_one_part( const lw_shape* shape )
{
	lwi_convex whole;
	return lwi_has_inside( shape ) && lwi_convex_of_shape( shape, &whole );
}

static uint32_t part_count( const lw_shape* shape )
{
	return is_one_part( shape ) ? 1 : shape->item_count;
}

static void widen( part* p, const solids* s, lw_vec3 point, double radius )
{
	const double at[RANGES] = { point.x, point.y, point.z, lwi_dot( s->direction, point ) };
	for ( int k = 0; k < RANGES; ++k )
	{
		p->least[k] = fmin( p->least[k], at[k] - radius );
		p->most[k] = fmax( p->most[k], at[k] + radius );
	}
}

static void make_part( const solids* s, bool of_a, uint32_t i, part* out )
{
	const lw_shape* shape = of_a ? s->a : s->b;
	const bool one = is_one_part( shape );
	lw_vec3 corner[8];
	const uint32_t count = one ? (uint32_t)lwi_hull_count( shape ) : lwi_item_corners( shape, i, corner );
	const double radius = one ? lwi_hull_radius( shape, 0 ) : shape->family == LWI_BOXES ? 0 : lwi_item_radius( shape, i );
	for ( int k = 0; k < RANGES; ++k )
	{
		out->least[k] = INFINITY;
		out->most[k] = -INFINITY;
	}
	for ( uint32_t k = 0; k < count; ++k )
	{
		const lw_vec3 p = one ? lwi_hull_point( shape, k ) : corner[k];
		widen( out, s, of_a ? p : lwi_transform( s->a_from_b, p ), radius );
		if ( !one )
		{
			out->corners[3 * k] = p.x;
			out->corners[3 * k + 1] = p.y;
			out->corners[3 * k + 2] = p.z;
		}
	}
	if ( one )
	{
		out->body = lwi_convex_around( shape, out->corners );
		return;
	}
	out->body = ( lwi_round_convex ){ { .type = LWI_CONVEX_POINTS, .points = out->corners, .point_count = 8 }, radius };
	if ( shape->family != LWI_BOXES )
	{
		out->body.core = ( lwi_convex ){ .type = LWI_CONVEX_TRIANGLE };
		lwi_load_corners( shape, i, out->body.core.vertex );
	}
}

/// An upper bound of the depth of two parts.
static double way_out_of_ranges( const part* a, const part* b )
{
	double least = INFINITY;
	for ( int k = 0; k < RANGES; ++k )
	{
		least = fmin( least, fmin( a->most[k] - b->least[k], b->most[k] - a->least[k] ) );
	}
	return least;
}

static void compare_parts( solids* s, const part* a, const part* b, const lw_depth_def* def )
{
	lw_depth depth;
	lwi_convex_depth( &a->body, &b->body, s->a_from_b, def, 0, &depth );
	s->lower = fmax( s->lower, depth.lower );
	s->steps++;
}

/// A pair of convex parts is no deeper than the bodies. The most promising pair first, then those that may be deeper.
static void find_parts( solids* s, const lw_depth_def* def, double width )
{
	const uint32_t count_a = part_count( s->a ), count_b = part_count( s->b );
	if ( ( s->a->family == LWI_TRIANGLES || s->b->family == LWI_TRIANGLES ) && (uint64_t)count_a * count_b > MOST_LOOKS )
	{
		return; // triangles of a fine mesh are too small
	}
	part a, b;
	uint32_t best_a = 0, best_b = 0;
	double most = -INFINITY;
	for ( int pass = 0; pass < 2; ++pass )
	{
		uint32_t looks = 0;
		for ( uint32_t i = 0; i < count_a && looks < MOST_LOOKS; ++i )
		{
			make_part( s, true, i, &a );
			for ( uint32_t k = 0; k < count_b && !is_over( s, width ); ++k, ++looks )
			{
				make_part( s, false, k, &b );
				const double bound = way_out_of_ranges( &a, &b );
				if ( pass == 0 && bound > most )
				{
					most = bound;
					best_a = i;
					best_b = k;
				}
				if ( pass == 1 && bound > s->lower && ( i != best_a || k != best_b ) )
				{
					compare_parts( s, &a, &b, def );
				}
			}
		}
		if ( pass == 0 )
		{
			make_part( s, true, best_a, &a );
			make_part( s, false, best_b, &b );
			compare_parts( s, &a, &b, def );
		}
	}
}

// --- all translations -----------------------------------------------------------------------------------------------

enum
{
	MOST_PARTS = 48,
	MOST_CELLS = 1024,
	LOOKS_AT_CELL = 4 ///< pairs of parts
};

/// Of a cell's radius: a depth that is known to that tells if the cell is covered, mostly.
#define COVER_WIDTH 0.2

/// A cube of translations.
typedef struct cell
{
	lw_vec3 center;
	double half;  ///< of an edge
	double least; ///< length of its shortest translation
} cell;

typedef struct cover
{
	solids* s;
	uint32_t count_a, count_b, cell_count;
	part a[MOST_PARTS], b[MOST_PARTS];
	cell cells[MOST_CELLS]; ///< a heap, the shortest first
} cover;

static cell cell_at( lw_vec3 c, double half )
{
	const lw_vec3 nearest = { fmax( 0, fabs( c.x ) - half ), fmax( 0, fabs( c.y ) - half ), fmax( 0, fabs( c.z ) - half ) };
	return ( cell ){ c, half, lwi_length( nearest ) * ( 1 - 8 * LWI_U64 ) };
}

static void push( cover* v, cell c )
{
	uint32_t at = v->cell_count++;
	for ( ; at > 0 && v->cells[( at - 1 ) / 2].least > c.least; at = ( at - 1 ) / 2 )
	{
		v->cells[at] = v->cells[( at - 1 ) / 2];
	}
	v->cells[at] = c;
}

static cell pop( cover* v )
{
	const cell out = v->cells[0], last = v->cells[--v->cell_count];
	uint32_t at = 0;
	for ( uint32_t child = 1; child < v->cell_count; child = 2 * at + 1 )
	{
		child += child + 1 < v->cell_count && v->cells[child + 1].least < v->cells[child].least;
		if ( last.least <= v->cells[child].least )
		{
			break;
		}
		v->cells[at] = v->cells[child];
		at = child;
	}
	v->cells[at] = last;
	return out;
}

/// The pair with the greatest upper bound of its depth after a translation, between two limits. False if there is none.
static bool next_pair( const cover* v, lw_vec3 move, double above, double below, const part** out_a, const part** out_b,
	double* bound )
{
	const double shift[RANGES] = { move.x, move.y, move.z, lwi_dot( v->s->direction, move ) };
	*bound = above;
	for ( uint32_t i = 0; i < v->count_a; ++i )
	{
		for ( uint32_t k = 0; k < v->count_b; ++k )
		{
			const part *a = &v->a[i], *b = &v->b[k];
			double least = INFINITY;
			for ( int d = 0; d < RANGES && least > *bound; ++d )
			{
				least = lwi_smaller( least,
					lwi_smaller( a->most[d] + shift[d] - b->least[d], b->most[d] - a->least[d] - shift[d] ) );
			}
			if ( least > *bound && least < below )
			{
				*bound = least;
				*out_a = a;
				*out_b = b;
			}
		}
	}
	return *bound > above;
}

/// True if two parts overlap after each translation of a cell.
static bool is_covered( cover* v, const cell* c )
{
	const double radius = sqrt( 3 ) * c->half * ( 1 + 8 * LWI_U64 );
	const lw_depth_def def = { .width = COVER_WIDTH * radius, .steps = 32 };
	lw_transform moved = *v->s->a_from_b;
	moved.t[0] -= c->center.x;
	moved.t[1] -= c->center.y;
	moved.t[2] -= c->center.z;
	const part *a = NULL, *b = NULL;
	double bound = INFINITY;
	for ( int i = 0; i < LOOKS_AT_CELL && next_pair( v, c->center, radius, bound, &a, &b, &bound ); ++i )
	{
		lw_depth depth;
		lwi_convex_depth( &a->body, &b->body, &moved, &def, 0, &depth );
		v->s->steps++;
		if ( depth.lower - v->s->rounding >= radius )
		{
			return true;
		}
	}
	return false;
}

/// Looks at a cell that is not covered, and cuts it into eight.
static void cut( cover* v, const cell* c, double width )
{
	if ( lwi_length( c->center ) < v->s->upper )
	{
		const double gap = look( v->s, c->center );
		slide( v->s, c->center, gap, width );
	}
	for ( int i = 0; i < 8; ++i )
	{
		const double h = 0.5 * c->half;
		const cell child = cell_at( lwi_add( c->center, lwi_v3( i & 1 ? h : -h, i & 2 ? h : -h, i & 4 ? h : -h ) ), h );
		if ( child.least < v->s->upper )
		{
			push( v, child );
		}
	}
}

static void find_translations( solids* s, double width )
{
	cover v; // not cleared as a whole
	v.s = s;
	v.count_a = part_count( s->a );
	v.count_b = part_count( s->b );
	v.cell_count = 0;
	if ( v.count_a > MOST_PARTS || v.count_b > MOST_PARTS )
	{
		return;
	}
	for ( uint32_t i = 0; i < v.count_a; ++i )
	{
		make_part( s, true, i, &v.a[i] );
	}
	for ( uint32_t i = 0; i < v.count_b; ++i )
	{
		make_part( s, false, i, &v.b[i] );
	}
	push( &v, cell_at( lwi_v3( 0, 0, 0 ), s->upper ) );
	while ( v.cell_count > 0 && v.cell_count + 8 <= MOST_CELLS && !is_over( s, width ) )
	{
		const cell c = pop( &v );
		s->lower = fmax( s->lower, fmin( c.least, s->upper ) - s->rounding ); // all shorter translations are covered
		if ( c.least < s->upper && !is_covered( &v, &c ) )
		{
			cut( &v, &c, width );
		}
	}
	s->lower = fmax( s->lower, ( v.cell_count > 0 ? fmin( v.cells[0].least, s->upper ) : s->upper ) - s->rounding );
}

void lwi_solid_depth( lwi_search_memory* memory, const lw_shape* a, const lw_shape* b, const lw_transform* a_from_b,
	const lw_depth_def* def, lw_depth* out )
{
	double corners_a[24], corners_b[24];
	const lwi_round_convex around_a = lwi_convex_around( a, corners_a ), around_b = lwi_convex_around( b, corners_b );
	lwi_convex_depth( &around_a, &around_b, a_from_b, def, 0, out );
	if ( out->kind == LW_DEPTH_APART )
	{
		return;
	}
	const double size = a->sphere_radius + b->sphere_radius + lwi_length( lwi_load( a->sphere_center ) ) +
						lwi_length( lwi_load( b->sphere_center ) ) + lwi_length( lwi_load( a_from_b->t ) );
	// the least way out so far leaves a little room, so that all others are shorter by more than rounding
	solids s =
		{ .memory = memory, .a = a, .b = b, .a_from_b = a_from_b, .rounding = LWI_EXACT_ERROR * size, .upper = INFINITY };
	s.most_steps = def->steps / 2;
	if ( look( &s, lwi_v3( 0, 0, 0 ) ) > 0 )
	{
		*out = ( lw_depth ){ .kind = LW_DEPTH_APART, .steps = out->steps + 1 };
		return;
	}
	s.upper = out->upper;
	s.way = lwi_scale( out->upper, out->normal );
	s.point_a = out->point_a;
	s.point_b = out->point_b;
	const double width = fmax( def->width, 4 * s.rounding );
	search_along( &s, out->normal, width );
	for ( int i = 0; i < 12; ++i )
	{
		const double sign = i % 2 == 0 ? 1 : -1;
		const int k = i / 2 % 3;
		const lw_vec3 axis =
			i < 6 ? lwi_v3( k == 0, k == 1, k == 2 ) : lwi_v3( a_from_b->r[0][k], a_from_b->r[1][k], a_from_b->r[2][k] );
		search_along( &s, lwi_scale( sign, axis ), width );
	}
	s.most_steps = def->steps / 8 * 5;
	find_balls( &s, width );
	s.most_steps = def->steps / 4 * 3;
	s.direction = lwi_scale( 1 / fmax( lwi_length( s.way ), LWI_EXACT_LEAST ), s.way );
	find_parts( &s, def, width );
	s.most_steps = def->steps;
	find_translations( &s, width );
	const double length = lwi_length( s.way );
	out->upper = s.upper;
	out->lower = fmin( s.lower, s.upper );
	out->normal = length > 0 ? lwi_scale( 1 / length, s.way ) : out->normal;
	out->point_a = s.point_a;
	out->point_b = s.point_b;
	out->steps += s.steps;
}
