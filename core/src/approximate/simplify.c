// SPDX-License-Identifier: BSD-3-Clause
// Fewer triangles near those of a mesh: edges collapse while both stay near each other.
//
// Garland, Heckbert, "Surface simplification using quadric error metrics", 1997 (order and places); Klein, Liebich,
// Strasser, "Mesh reduction with error control", 1996 (each triangle of the original is kept with the one that stands for
// it). Nothing here is promised: approximate/simplify_prove.c judges the outcome; core/docs/detail.md has the purpose.
#include "approximate/body.h"
#include "approximate/simplify.h"
#include "base/math_inline.h"
#include "shape/shape.h"

#include <stdlib.h>
#include <string.h>

enum
{
	MAX_STAR = 96,      ///< triangles around an edge; busier ones stay
	MAX_NEAR = 256,     ///< of these and around them
	MAX_PIECES = 60,    ///< of an original triangle in a proof: more gain nothing, and failing proofs take much of the time
	MOST_PIECES = 4000, ///< of a moved one: as many as there are triangles under it
	LEVELS = 8,         ///< rounds of growing error, each twice the one before
	MAX_PASSES = 12     ///< in one round
};

/// Weight of the planes that stand on open edges, relative to the triangle's own.
#define BOUNDARY_WEIGHT 4.0

/// Of equal edges, as in flat regions, short ones go first: metres of error that a metre of length counts as.
#define LENGTH_WEIGHT 1e-4

/// Sum of squared distances to weighted planes: x^T A x + 2 b x + c.
typedef struct quadric
{
	double xx, xy, xz, yy, yz, zz, x, y, z, c, weight;
} quadric;

typedef struct candidate
{
	double cost; ///< m^2
	uint32_t u, v;
} candidate;

typedef struct simplifier
{
	const lw_shape* mesh;
	lw_allocator memory;
	double deviation;
	lwi_soup soup;         ///< in place; dead triangles have LW_INVALID_INDEX first
	quadric* quadrics;     ///< [vertices]
	uint32_t* corner_head; ///< [vertices] a corner 3 t + k at the vertex, then by corner_next; may name dead triangles
	uint32_t* corner_next; ///< [3 triangles]
	uint32_t* own_head;    ///< [triangles] original triangles that a triangle represents, then by own_next
	uint32_t* own_next;    ///< [triangles]
	uint32_t* seen;        ///< [triangles] stamps
	uint32_t star_corners[3 * MAX_STAR], stamp;
	uint32_t* changed;     ///< [vertices] pass in which triangles around it changed
	uint32_t* locked;      ///< [vertices] pass in which it was part of a collapse
	candidate* candidates; ///< [3 triangles]
	uint32_t pass;
	double limit, last_limit; ///< costs of this round and of the one before
	lw_vec3 center;           ///< quadrics are about it
} simplifier;

/// The triangles around a collapse.
typedef struct star
{
	uint32_t triangles[MAX_STAR], count; ///< at u or v
	uint32_t kept;                       ///< the first `kept` triangles have only one of u and v
	lw_vec3 w;
} star;

// --- quadrics --------------------------------------------------------------------------------------------------------

static void add_plane( quadric* q, lw_vec3 n, lw_vec3 through, double weight )
{
	double d = -lwi_dot( n, through );
	q->xx += weight * n.x * n.x;
	q->xy += weight * n.x * n.y;
	q->xz += weight * n.x * n.z;
	q->yy += weight * n.y * n.y;
	q->yz += weight * n.y * n.z;
	q->zz += weight * n.z * n.z;
	q->x += weight * n.x * d;
	q->y += weight * n.y * d;
	q->z += weight * n.z * d;
	q->c += weight * d * d;
	q->weight += weight;
}

static quadric sum_of( const quadric* a, const quadric* b )
{
	return ( quadric ){ a->xx + b->xx, a->xy + b->xy, a->xz + b->xz, a->yy + b->yy, a->yz + b->yz, a->zz + b->zz,
		a->x + b->x, a->y + b->y, a->z + b->z, a->c + b->c, a->weight + b->weight };
}

/// Mean squared distance to the planes.
static double error_at( const quadric* q, lw_vec3 p )
{
	double e = q->xx * p.x * p.x + q->yy * p.y * p.y + q->zz * p.z * p.z +
			   2 * ( q->xy * p.x * p.y + q->xz * p.x * p.z + q->yz * p.y * p.z + q->x * p.x + q->y * p.y + q->z * p.z ) +
			   q->c;
	return q->weight > 0 ? fmax( e, 0 ) / q->weight : 0;
}

/// The point of least error, where it is clear.
static bool best_point( const quadric* q, lw_vec3* out )
{
	double a = q->yy * q->zz - q->yz * q->yz, b = q->xz * q->yz - q->xy * q->zz, c = q->xy * q->yz - q->xz * q->yy;
	double determinant = q->xx * a + q->xy * b + q->xz * c, trace = q->xx + q->yy + q->zz;
	if ( !( determinant > 1e-5 * trace * trace * trace ) )
	{
		return false;
	}
	double d = q->xx * q->zz - q->xz * q->xz, e = q->xy * q->xz - q->xx * q->yz, f = q->xx * q->yy - q->xy * q->xy;
	*out = lwi_v3( -( a * q->x + b * q->y + c * q->z ) / determinant, -( b * q->x + d * q->y + e * q->z ) / determinant,
		-( c * q->x + e * q->y + f * q->z ) / determinant );
	return isfinite( out->x ) && isfinite( out->y ) && isfinite( out->z );
}

// --- the current mesh ------------------------------------------------------------------------------------------------

static lw_vec3 at( const simplifier* s, uint32_t vertex )
{
	return lwi_load( s->soup.vertices + 3 * (size_t)vertex );
}

static const uint32_t* corners( const simplifier* s, uint32_t triangle )
{
	return s->soup.indices + 3 * (size_t)triangle;
}

static void load_original( const simplifier* s, uint32_t triangle, lw_vec3 out[3] )
{
	for ( size_t k = 0; k < 3; ++k )
	{
		out[k] = lwi_load( s->mesh->vertices + 3 * (size_t)s->mesh->indices[3 * (size_t)triangle + k] );
	}
}

static bool has( const uint32_t* triangle, uint32_t vertex )
{
	return triangle[0] == vertex || triangle[1] == vertex || triangle[2] == vertex;
}

static bool is_alive( const simplifier* s, uint32_t triangle )
{
	return corners( s, triangle )[0] != LW_INVALID_INDEX;
}

static bool is_open_edge( const simplifier* s, uint32_t triangle, uint32_t a, uint32_t b )
{
	for ( uint32_t c = s->corner_head[a]; c != LW_INVALID_INDEX; c = s->corner_next[c] )
	{
		if ( c / 3 != triangle && has( corners( s, c / 3 ), b ) )
		{
			return false;
		}
	}
	return true;
}

static void add_quadrics( simplifier* s )
{
	for ( uint32_t t = 0; t < s->soup.triangle_count; ++t )
	{
		const uint32_t* v = corners( s, t );
		lw_vec3 p[3];
		for ( int k = 0; k < 3; ++k )
		{
			p[k] = lwi_sub( at( s, v[k] ), s->center );
		}
		lw_vec3 n = lwi_cross( lwi_sub( p[1], p[0] ), lwi_sub( p[2], p[0] ) );
		double twice = lwi_length( n );
		if ( !( twice > 0 ) )
		{
			continue;
		}
		n = lwi_scale( 1 / twice, n );
		for ( int k = 0; k < 3; ++k )
		{
			add_plane( &s->quadrics[v[k]], n, p[0], 0.5 * twice );
		}
		for ( int k = 0; k < 3; ++k )
		{
			int next = ( k + 1 ) % 3;
			lw_vec3 edge = lwi_sub( p[next], p[k] ), up = lwi_cross( edge, n );
			if ( lwi_length( up ) > 0 && is_open_edge( s, t, v[k], v[next] ) )
			{
				double weight = BOUNDARY_WEIGHT * lwi_length_sq( edge );
				up = lwi_scale( 1 / lwi_length( up ), up );
				add_plane( &s->quadrics[v[k]], up, p[k], weight );
				add_plane( &s->quadrics[v[next]], up, p[k], weight );
			}
		}
	}
}

// --- one collapse ----------------------------------------------------------------------------------------------------

/// The triangles at u or v: those with one of both first. False if they are too many.
static bool gather( const simplifier* s, uint32_t u, uint32_t v, star* out )
{
	uint32_t both[MAX_STAR], both_count = 0;
	out->count = 0;
	for ( int side = 0; side < 2; ++side )
	{
		for ( uint32_t c = s->corner_head[side == 0 ? u : v]; c != LW_INVALID_INDEX; c = s->corner_next[c] )
		{
			const uint32_t* t = corners( s, c / 3 );
			bool shared = is_alive( s, c / 3 ) && has( t, u ) && has( t, v );
			if ( !is_alive( s, c / 3 ) || ( shared && side == 1 ) )
			{
				continue;
			}
			if ( out->count + both_count == MAX_STAR )
			{
				return false;
			}
			if ( shared )
			{
				both[both_count++] = c / 3;
			}
			else
			{
				out->triangles[out->count++] = c / 3;
			}
		}
	}
	out->kept = out->count;
	for ( uint32_t i = 0; i < both_count; ++i )
	{
		out->triangles[out->count++] = both[i];
	}
	return true;
}

/// The corners of a triangle of the star when u and v are w.
static void moved( const simplifier* s, const star* st, uint32_t i, uint32_t u, uint32_t v, lw_vec3 out[3] )
{
	const uint32_t* t = corners( s, st->triangles[i] );
	for ( int k = 0; k < 3; ++k )
	{
		out[k] = t[k] == u || t[k] == v ? st->w : at( s, t[k] );
	}
}

/// True if a triangle that is more than a sliver would turn over.
static bool folds( const simplifier* s, const star* st, uint32_t i, const lw_vec3 p[3] )
{
	const uint32_t* t = corners( s, st->triangles[i] );
	lw_vec3 a = at( s, t[0] ), b = at( s, t[1] ), c = at( s, t[2] );
	lw_vec3 before = lwi_cross( lwi_sub( b, a ), lwi_sub( c, a ) );
	lw_vec3 after = lwi_cross( lwi_sub( p[1], p[0] ), lwi_sub( p[2], p[0] ) );
	double longest = fmax( lwi_distance( a, b ), fmax( lwi_distance( b, c ), lwi_distance( c, a ) ) );
	double size = lwi_length( before );
	return size > 0.5 * s->deviation * longest && !( lwi_dot( before, after ) > 0.2 * size * lwi_length( after ) );
}

/// True if some moved triangle is not near the original.
static bool strays( const simplifier* s, const star* st, const lwi_candidate* triangles )
{
	uint32_t hint = LW_INVALID_INDEX;
	for ( uint32_t i = 0; i < st->kept; ++i )
	{
		if ( !( lwi_detail_distance( s->mesh, triangles[i].v, s->deviation, s->deviation, MOST_PIECES, &hint ) <=
				 s->deviation ) )
		{
			return true;
		}
	}
	return false;
}

/// Triangles around the star follow those of the star, as many as there is room for; their count.
static uint32_t add_ring( simplifier* s, const star* st, uint32_t u, uint32_t v, lwi_candidate* triangles )
{
	uint32_t count = st->kept;
	++s->stamp;
	for ( uint32_t i = 0; i < st->count; ++i )
	{
		s->seen[st->triangles[i]] = s->stamp;
	}
	for ( uint32_t i = 0; i < 3 * st->count; ++i )
	{
		uint32_t vertex = s->star_corners[i];
		bool inner = vertex == u || vertex == v;
		for ( uint32_t c = inner ? LW_INVALID_INDEX : s->corner_head[vertex]; c != LW_INVALID_INDEX; c = s->corner_next[c] )
		{
			uint32_t t = c / 3;
			if ( is_alive( s, t ) && s->seen[t] != s->stamp && count < MAX_NEAR )
			{
				s->seen[t] = s->stamp;
				for ( int k = 0; k < 3; ++k )
				{
					triangles[count].v[k] = at( s, corners( s, t )[k] );
				}
				lwi_candidate_set( &triangles[count++] );
			}
		}
	}
	return count;
}

/// Are all original triangles that the star represents near the moved star and the triangles around it?
static bool covers( const simplifier* s, const star* st, const lwi_candidate* near, uint32_t count )
{
	uint32_t hint = LW_INVALID_INDEX;
	for ( uint32_t i = 0; i < st->count; ++i )
	{
		for ( uint32_t t = s->own_head[st->triangles[i]]; t != LW_INVALID_INDEX; t = s->own_next[t] )
		{
			lw_vec3 own[3];
			load_original( s, t, own );
			if ( !lwi_detail_is_near( near, count, (const lw_vec3*)own, s->deviation, MAX_PIECES, &hint ) )
			{
				return false;
			}
		}
	}
	return true;
}

/// Hands the original triangles of the star to the triangles that are nearest now.
static void hand_over( simplifier* s, const star* st, const lwi_candidate* triangles )
{
	uint32_t all = LW_INVALID_INDEX;
	for ( uint32_t i = 0; i < st->count; ++i )
	{
		uint32_t* head = &s->own_head[st->triangles[i]];
		while ( *head != LW_INVALID_INDEX )
		{
			uint32_t t = *head;
			*head = s->own_next[t];
			s->own_next[t] = all;
			all = t;
		}
	}
	while ( all != LW_INVALID_INDEX )
	{
		uint32_t t = all;
		all = s->own_next[t];
		lw_vec3 own[3];
		load_original( s, t, own );
		lw_vec3 middle = lwi_scale( 1.0 / 3, lwi_add( own[0], lwi_add( own[1], own[2] ) ) );
		uint32_t best = lwi_nearest_candidate( triangles, st->kept, middle, INFINITY );
		uint32_t to = st->triangles[best];
		s->own_next[t] = s->own_head[to];
		s->own_head[to] = t;
	}
}

static void unite( simplifier* s, const star* st, uint32_t u, uint32_t v )
{
	double* place = s->soup.vertices + 3 * (size_t)u;
	place[0] = st->w.x;
	place[1] = st->w.y;
	place[2] = st->w.z;
	s->quadrics[u] = sum_of( &s->quadrics[u], &s->quadrics[v] );
	for ( uint32_t i = st->kept; i < st->count; ++i )
	{
		s->soup.indices[3 * (size_t)st->triangles[i]] = LW_INVALID_INDEX;
	}
	// the corners of both that are alive, in one list
	uint32_t list = LW_INVALID_INDEX;
	for ( int side = 0; side < 2; ++side )
	{
		for ( uint32_t c = s->corner_head[side == 0 ? u : v], next; c != LW_INVALID_INDEX; c = next )
		{
			next = s->corner_next[c];
			if ( is_alive( s, c / 3 ) )
			{
				s->soup.indices[c] = u;
				s->corner_next[c] = list;
				list = c;
			}
		}
	}
	s->corner_head[u] = list;
	s->corner_head[v] = LW_INVALID_INDEX;
	for ( uint32_t i = 0; i < st->kept; ++i )
	{
		for ( int k = 0; k < 3; ++k )
		{
			s->changed[corners( s, st->triangles[i] )[k]] = s->pass;
		}
	}
	s->locked[u] = s->locked[v] = s->pass;
}

static lw_vec3 place_of( const simplifier* s, uint32_t u, uint32_t v, double* cost )
{
	quadric q = sum_of( &s->quadrics[u], &s->quadrics[v] );
	lw_vec3 a = lwi_sub( at( s, u ), s->center ), b = lwi_sub( at( s, v ), s->center ), best = a;
	double length = lwi_distance( a, b ), least = error_at( &q, a ), other = error_at( &q, b );
	best = other < least ? b : best;
	least = fmin( least, other );
	lw_vec3 clear;
	// beyond the edge by more than its length is no place for it
	bool is_clear =
		best_point( &q, &clear ) && lwi_distance( clear, a ) < 2 * length && lwi_distance( clear, b ) < 2 * length;
	if ( !is_clear )
	{
		clear = lwi_scale( 0.5, lwi_add( a, b ) );
	}
	other = error_at( &q, clear );
	if ( other < 0.99 * least )
	{
		best = clear;
		least = other;
	}
	*cost = least + LENGTH_WEIGHT * LENGTH_WEIGHT * length * length;
	return lwi_add( best, s->center );
}

static bool collapse( simplifier* s, uint32_t u, uint32_t v )
{
	star st;
	lwi_candidate triangles[MAX_NEAR];
	if ( !gather( s, u, v, &st ) || st.kept == 0 )
	{
		return false;
	}
	double cost;
	st.w = place_of( s, u, v, &cost );
	for ( uint32_t i = 0; i < st.kept; ++i )
	{
		moved( s, &st, i, u, v, triangles[i].v );
		lwi_candidate_set( &triangles[i] );
		if ( folds( s, &st, i, triangles[i].v ) )
		{
			return false;
		}
	}
	for ( uint32_t i = 0; i < 3 * st.count; ++i )
	{
		s->star_corners[i] = corners( s, st.triangles[i / 3] )[i % 3];
	}
	uint32_t near = add_ring( s, &st, u, v, triangles );
	if ( !covers( s, &st, triangles, near ) || strays( s, &st, triangles ) )
	{
		return false;
	}
	hand_over( s, &st, triangles );
	unite( s, &st, u, v );
	return true;
}

// --- rounds ----------------------------------------------------------------------------------------------------------

static int by_cost( const void* left, const void* right )
{
	const candidate* a = left;
	const candidate* b = right;
	if ( a->cost != b->cost )
	{
		return a->cost < b->cost ? -1 : 1;
	}
	return a->u != b->u ? ( a->u < b->u ? -1 : 1 ) : a->v != b->v ? ( a->v < b->v ? -1 : 1 ) : 0;
}

/// Edges of this round's costs that were not tried since a triangle around them changed.
static uint32_t find_candidates( simplifier* s )
{
	uint32_t count = 0;
	for ( uint32_t t = 0; t < s->soup.triangle_count; ++t )
	{
		const uint32_t* i = corners( s, t );
		for ( int k = 0; k < 3 && is_alive( s, t ); ++k )
		{
			uint32_t u = i[k], v = i[( k + 1 ) % 3];
			if ( u == v )
			{
				continue;
			}
			candidate* c = &s->candidates[count];
			(void)place_of( s, u, v, &c->cost );
			bool is_new = c->cost > s->last_limit || s->changed[u] + 1 >= s->pass || s->changed[v] + 1 >= s->pass;
			c->u = u < v ? u : v;
			c->v = u < v ? v : u;
			count += c->cost <= s->limit && is_new ? 1 : 0;
		}
	}
	return count;
}

/// @return how many edges collapsed
static uint32_t run_pass( simplifier* s )
{
	uint32_t count = find_candidates( s ), done = 0;
	qsort( s->candidates, count, sizeof( candidate ), by_cost );
	for ( uint32_t i = 0; i < count; ++i )
	{
		candidate c = s->candidates[i];
		bool again = i > 0 && c.u == s->candidates[i - 1].u && c.v == s->candidates[i - 1].v;
		if ( !again && s->locked[c.u] != s->pass && s->locked[c.v] != s->pass )
		{
			done += collapse( s, c.u, c.v ) ? 1 : 0;
		}
	}
	++s->pass;
	return done;
}

static void run( simplifier* s )
{
	s->last_limit = -1;
	double error = s->deviation / (double)( 1 << ( LEVELS - 2 ) );
	for ( int level = 0; level < LEVELS; ++level, error *= 2 )
	{
		s->limit = error * error;
		uint32_t least = s->soup.triangle_count / 1000;
		for ( int i = 0; i < MAX_PASSES && run_pass( s ) > least; ++i )
		{
			s->last_limit = s->limit;
		}
		s->last_limit = s->limit;
	}
}

// --- beginning and end -----------------------------------------------------------------------------------------------

static void free_scratch( simplifier* s )
{
	size_t vertices = s->mesh->vertex_count, triangles = s->mesh->item_count;
	lwi_free( &s->memory, s->quadrics, vertices * sizeof( quadric ) );
	lwi_free( &s->memory, s->corner_head, vertices * sizeof( uint32_t ) );
	lwi_free( &s->memory, s->corner_next, 3 * triangles * sizeof( uint32_t ) );
	lwi_free( &s->memory, s->own_head, triangles * sizeof( uint32_t ) );
	lwi_free( &s->memory, s->own_next, triangles * sizeof( uint32_t ) );
	lwi_free( &s->memory, s->seen, triangles * sizeof( uint32_t ) );
	lwi_free( &s->memory, s->changed, vertices * sizeof( uint32_t ) );
	lwi_free( &s->memory, s->locked, vertices * sizeof( uint32_t ) );
	lwi_free( &s->memory, s->candidates, 3 * triangles * sizeof( candidate ) );
}

static bool take_memory( simplifier* s )
{
	size_t vertices = s->mesh->vertex_count, triangles = s->mesh->item_count;
	s->soup.vertices_size = 3 * vertices * sizeof( double );
	s->soup.indices_size = 3 * triangles * sizeof( uint32_t );
	s->soup.vertices = lwi_alloc( &s->memory, s->soup.vertices_size );
	s->soup.indices = lwi_alloc( &s->memory, s->soup.indices_size );
	s->quadrics = lwi_alloc_zero( &s->memory, vertices, sizeof( quadric ) );
	s->corner_head = lwi_alloc( &s->memory, vertices * sizeof( uint32_t ) );
	s->corner_next = lwi_alloc( &s->memory, 3 * triangles * sizeof( uint32_t ) );
	s->own_head = lwi_alloc( &s->memory, triangles * sizeof( uint32_t ) );
	s->own_next = lwi_alloc( &s->memory, triangles * sizeof( uint32_t ) );
	s->seen = lwi_alloc_zero( &s->memory, triangles, sizeof( uint32_t ) );
	s->changed = lwi_alloc_zero( &s->memory, vertices, sizeof( uint32_t ) );
	s->locked = lwi_alloc_zero( &s->memory, vertices, sizeof( uint32_t ) );
	s->candidates = lwi_alloc( &s->memory, 3 * triangles * sizeof( candidate ) );
	return s->soup.vertices != NULL && s->soup.indices != NULL && s->quadrics != NULL && s->corner_head != NULL &&
		   s->corner_next != NULL && s->own_head != NULL && s->own_next != NULL && s->seen != NULL && s->changed != NULL &&
		   s->locked != NULL && s->candidates != NULL;
}

/// Copies the mesh; each triangle represents itself.
static void begin( simplifier* s )
{
	const lw_shape* mesh = s->mesh;
	memcpy( s->soup.vertices, mesh->vertices, s->soup.vertices_size );
	memcpy( s->soup.indices, mesh->indices, s->soup.indices_size );
	s->soup.vertex_count = mesh->vertex_count;
	s->soup.triangle_count = mesh->item_count;
	memset( s->corner_head, 0xff, mesh->vertex_count * sizeof( uint32_t ) );
	memset( s->own_next, 0xff, mesh->item_count * sizeof( uint32_t ) );
	for ( uint32_t t = 0; t < mesh->item_count; ++t )
	{
		s->own_head[t] = t;
	}
	for ( uint32_t c = 0; c < 3 * mesh->item_count; ++c )
	{
		uint32_t vertex = s->soup.indices[c];
		s->corner_next[c] = s->corner_head[vertex];
		s->corner_head[vertex] = c;
	}
	s->center = lwi_load( mesh->origin );
	s->pass = 1;
	add_quadrics( s );
}

/// Where a thin piece fell flat two triangles may have the same corners.
static void drop_copies( simplifier* s )
{
	for ( uint32_t t = 0; t < s->soup.triangle_count; ++t )
	{
		uint32_t* v = s->soup.indices + 3 * (size_t)t;
		for ( uint32_t c = is_alive( s, t ) ? s->corner_head[v[0]] : LW_INVALID_INDEX; c != LW_INVALID_INDEX;
			  c = s->corner_next[c] )
		{
			const uint32_t* other = corners( s, c / 3 );
			if ( c / 3 < t && is_alive( s, c / 3 ) && has( other, v[0] ) && has( other, v[1] ) && has( other, v[2] ) &&
				 has( v, other[0] ) && has( v, other[1] ) && has( v, other[2] ) )
			{
				v[0] = LW_INVALID_INDEX;
				break;
			}
		}
	}
}

static void pack( lwi_soup* soup )
{
	uint32_t count = 0;
	for ( size_t t = 0; t < soup->triangle_count; ++t )
	{
		if ( soup->indices[3 * t] != LW_INVALID_INDEX )
		{
			memmove( soup->indices + 3 * (size_t)count++, soup->indices + 3 * t, 3 * sizeof( uint32_t ) );
		}
	}
	soup->triangle_count = count;
}

void lwi_soup_free( const lw_allocator* memory, lwi_soup* soup )
{
	lwi_free( memory, soup->vertices, soup->vertices_size );
	lwi_free( memory, soup->indices, soup->indices_size );
	memset( soup, 0, sizeof( *soup ) );
}

lw_status lwi_detail_simplify( const lw_shape* mesh, double deviation, const lw_allocator* memory, lw_diag* diag,
	lwi_soup* out )
{
	simplifier s = { .mesh = mesh, .memory = *memory, .deviation = deviation };
	bool good = take_memory( &s );
	if ( good )
	{
		begin( &s );
		run( &s );
		drop_copies( &s );
		pack( &s.soup );
	}
	else
	{
		lwi_soup_free( memory, &s.soup );
	}
	free_scratch( &s );
	*out = s.soup;
	return good ? LW_OK : lwi_out_of_memory( diag, "a level of detail" );
}
