// SPDX-License-Identifier: BSD-3-Clause
// Margins of pairs: checked, copied, looked up, and spread over the bodies and clusters of a checker.
#include "checker/margin.h"

#include "checker/checker.h"
#include "checker/clusters.h"
#include "base/math_inline.h"
#include "scene/scene.h"

#include <stdlib.h>
#include <string.h>

#define REMEDY "give metres, finite and >= 0"

/// Finite and not negative; NaN-safe.
static bool is_margin( double value )
{
	return value >= 0 && value < INFINITY;
}

static lw_status check_general( double value, const char* what, lw_diag* diag )
{
	return is_margin( value )
			   ? LW_OK
			   : lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, "margins: %s is %g; " REMEDY, what, value );
}

static lw_status check_links( const double* values, const char* what, const lw_robot* robot, lw_diag* diag )
{
	for ( uint32_t i = 0; values != NULL && i < lw_robot_link_count( robot ); ++i )
	{
		if ( !is_margin( values[i] ) )
		{
			return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, i, "margins: %s of link '%.80s' is %g; " REMEDY, what,
				lw_robot_link_name( robot, i ), values[i] );
		}
	}
	return LW_OK;
}

static lw_status check_objects( const double* values, const lw_scene* scene, lw_diag* diag )
{
	for ( uint32_t i = 0; values != NULL && scene != NULL && i < lw_scene_object_count( scene ); ++i )
	{
		if ( !is_margin( values[i] ) )
		{
			return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, i, "margins: object '%.80s' has %g; " REMEDY,
				lw_scene_object_name( scene, i ), values[i] );
		}
	}
	return LW_OK;
}

// --- listed pairs ----------------------------------------------------------------------------------------------------

/// The names of the partners of a pair, for messages.
typedef struct naming
{
	const char* what;
	const lw_robot* robot;
	const lw_scene* scene; ///< may be NULL
	bool self;
} naming;

static const char* name_of( const naming* n, uint32_t b )
{
	return n->self ? lw_robot_link_name( n->robot, b ) : lw_scene_object_name( n->scene, b );
}

static lw_status check_pairs( const lw_pair_margin* pairs, uint32_t count, const naming* n, lw_diag* diag )
{
	const uint32_t links = lw_robot_link_count( n->robot );
	const uint32_t others = n->self ? links : n->scene != NULL ? lw_scene_object_count( n->scene ) : 0;
	if ( count > 0 && pairs == NULL )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, "margins: %ss are NULL, their count is not 0",
			n->what );
	}
	for ( uint32_t i = 0; i < count; ++i )
	{
		if ( pairs[i].a >= links || pairs[i].b >= others )
		{
			return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, i, "margins: %s %u: %s index out of range", n->what, i,
				n->self ? "link" : "link or object" );
		}
		const char* a = lw_robot_link_name( n->robot, pairs[i].a );
		if ( n->self && pairs[i].a == pairs[i].b )
		{
			return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, i, "margins: %s %u is link '%.80s' with itself", n->what, i,
				a );
		}
		if ( !is_margin( pairs[i].margin ) )
		{
			return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, i, "margins: %s '%.60s', '%.60s' has %g; " REMEDY, n->what, a,
				name_of( n, pairs[i].b ), pairs[i].margin );
		}
	}
	return LW_OK;
}

static int by_pair( const void* x, const void* y )
{
	const lw_pair_margin *p = x, *q = y;
	return p->a != q->a ? ( p->a < q->a ? -1 : 1 ) : p->b != q->b ? ( p->b < q->b ? -1 : 1 ) : 0;
}

/// A sorted copy of pairs that were checked; the allocator's memory is freed by the owner, also after a failure.
static lw_status copy_pairs( lwi_listed_margins* to, const lw_pair_margin* from, uint32_t count, const naming* n,
	const lw_allocator* allocator, lw_diag* diag )
{
	to->count = count;
	to->pairs = lwi_alloc_zero( allocator, count, sizeof( lw_pair_margin ) );
	if ( to->pairs == NULL )
	{
		return lwi_out_of_memory( diag, "margins" );
	}
	for ( uint32_t i = 0; i < count; ++i )
	{
		bool swap = n->self && from[i].a > from[i].b;
		to->pairs[i] = swap ? ( lw_pair_margin ){ from[i].b, from[i].a, from[i].margin } : from[i];
	}
	if ( count > 1 )
	{
		qsort( to->pairs, count, sizeof( lw_pair_margin ), by_pair );
	}
	for ( uint32_t i = 1; i < count; ++i )
	{
		if ( by_pair( &to->pairs[i - 1], &to->pairs[i] ) == 0 )
		{
			return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX,
				"margins: %s '%.80s', '%.80s' is there twice; keep one of them", n->what,
				lw_robot_link_name( n->robot, to->pairs[i].a ), name_of( n, to->pairs[i].b ) );
		}
	}
	return LW_OK;
}

static const lw_pair_margin* find_pair( const lwi_listed_margins* listed, uint32_t a, uint32_t b )
{
	const lw_pair_margin key = { a, b, 0 };
	uint32_t first = 0, count = listed->count;
	while ( count > 0 )
	{
		uint32_t half = count / 2;
		int order = by_pair( &listed->pairs[first + half], &key );
		if ( order == 0 )
		{
			return &listed->pairs[first + half];
		}
		first = order < 0 ? first + half + 1 : first;
		count = order < 0 ? count - half - 1 : half;
	}
	return NULL;
}

/// True if a link is in a listed pair. @param either as its second link too
static bool is_listed( const lwi_listed_margins* listed, uint32_t link, bool either )
{
	for ( uint32_t i = 0; i < listed->count; ++i )
	{
		if ( listed->pairs[i].a == link || ( either && listed->pairs[i].b == link ) )
		{
			return true;
		}
	}
	return false;
}

static double largest_listed( const lwi_listed_margins* listed )
{
	double largest = 0;
	for ( uint32_t i = 0; i < listed->count; ++i )
	{
		largest = fmax( largest, listed->pairs[i].margin );
	}
	return largest;
}

static double largest_of( const double* values, uint32_t count )
{
	double largest = 0;
	for ( uint32_t i = 0; i < count; ++i )
	{
		largest = fmax( largest, values[i] );
	}
	return largest;
}

/// A copy; zeros for NULL. NULL without memory.
static double* copy_values( const double* from, uint32_t count, const lw_allocator* allocator )
{
	double* to = lwi_alloc_zero( allocator, count, sizeof( double ) );
	if ( to != NULL && from != NULL && count > 0 )
	{
		memcpy( to, from, count * sizeof( double ) );
	}
	return to;
}

// --- self pairs ------------------------------------------------------------------------------------------------------

void lwi_self_margins_destroy( lwi_self_margins* m )
{
	if ( m == NULL )
	{
		return;
	}
	const lw_allocator allocator = m->allocator;
	lwi_free( &allocator, m->link, m->link_count * sizeof( double ) );
	lwi_free( &allocator, m->listed.pairs, m->listed.count * sizeof( lw_pair_margin ) );
	lwi_free( &allocator, m, sizeof( *m ) );
}

static lw_status fill_self( lwi_self_margins* m, const lw_margins* def, const naming* n, lw_diag* diag )
{
	m->all = def->self;
	m->link = copy_values( def->link_self, m->link_count, &m->allocator );
	if ( m->link == NULL )
	{
		return lwi_out_of_memory( diag, "margins" );
	}
	double link = largest_of( m->link, m->link_count );
	lw_status status = copy_pairs( &m->listed, def->self_pairs, def->self_pair_count, n, &m->allocator, diag );
	m->largest = status == LW_OK ? fmax( m->all + link + link, largest_listed( &m->listed ) ) : 0;
	m->bytes = sizeof( *m ) + m->link_count * sizeof( double ) + m->listed.count * sizeof( lw_pair_margin );
	return status;
}

lw_status lwi_self_margins_create( const lw_margins* def, const lw_robot* robot, const lw_allocator* allocator,
	lw_diag* diag, lwi_self_margins** out_margins )
{
	const naming n = { "self pair", robot, NULL, true };
	*out_margins = NULL;
	lw_status status = check_general( def->self, "self", diag );
	status = status == LW_OK ? check_links( def->link_self, "link_self", robot, diag ) : status;
	status = status == LW_OK ? check_pairs( def->self_pairs, def->self_pair_count, &n, diag ) : status;
	if ( status != LW_OK )
	{
		return status;
	}
	lwi_self_margins* m = lwi_alloc_zero( allocator, 1, sizeof( *m ) );
	if ( m == NULL )
	{
		return lwi_out_of_memory( diag, "margins" );
	}
	m->allocator = *allocator;
	m->link_count = lw_robot_link_count( robot );
	status = fill_self( m, def, &n, diag );
	if ( status != LW_OK || m->largest == 0 )
	{
		lwi_self_margins_destroy( m );
		return status;
	}
	*out_margins = m;
	return LW_OK;
}

bool lwi_self_margins_equal( const lwi_self_margins* x, const lwi_self_margins* y )
{
	if ( x == NULL || y == NULL )
	{
		return x == y;
	}
	bool equal = x->all == y->all && x->link_count == y->link_count && x->listed.count == y->listed.count;
	for ( uint32_t i = 0; equal && i < x->link_count; ++i )
	{
		equal = x->link[i] == y->link[i];
	}
	for ( uint32_t i = 0; equal && i < x->listed.count; ++i )
	{
		const lw_pair_margin *p = &x->listed.pairs[i], *q = &y->listed.pairs[i];
		equal = p->a == q->a && p->b == q->b && p->margin == q->margin;
	}
	return equal;
}

// --- links and objects -----------------------------------------------------------------------------------------------

void lwi_margins_destroy( lwi_margins* m )
{
	if ( m == NULL )
	{
		return;
	}
	const lw_allocator allocator = m->allocator;
	lwi_free( &allocator, m->link, m->link_count * sizeof( double ) );
	lwi_free( &allocator, m->object, m->object_count * sizeof( double ) );
	lwi_free( &allocator, m->listed.pairs, m->listed.count * sizeof( lw_pair_margin ) );
	lwi_free( &allocator, m->bodies, m->body_count * sizeof( double ) );
	lwi_free( &allocator, m->clusters, m->cluster_count * sizeof( double[2] ) );
	lwi_free( &allocator, m->objects, m->row_size * sizeof( float ) );
	lwi_free( &allocator, (void*)m->body_row, m->body_count * sizeof( float* ) );
	lwi_free( &allocator, m->rows, m->row_bytes );
	lwi_free( &allocator, m, sizeof( *m ) );
}

static lw_status fill_given( lwi_margins* m, const lw_margins* def, const naming* n, lw_diag* diag )
{
	m->all = def->environment;
	m->link = copy_values( def->link_environment, m->link_count, &m->allocator );
	m->object = copy_values( def->object, m->object_count, &m->allocator );
	if ( m->link == NULL || m->object == NULL )
	{
		return lwi_out_of_memory( diag, "margins" );
	}
	lw_status status = copy_pairs( &m->listed, def->environment_pairs, def->environment_pair_count, n, &m->allocator, diag );
	if ( status == LW_OK ) // without objects too: the margins given are kept for scenes that have some
	{
		double sum = m->all + largest_of( m->link, m->link_count ) + largest_of( m->object, m->object_count );
		m->largest = fmax( sum, largest_listed( &m->listed ) );
	}
	return status;
}

/// Excess of a body's margins to the shapes of the scene, if its link is listed.
static void fill_row( const lwi_margins* m, const lw_checker* c, uint32_t body, float* row )
{
	for ( uint32_t i = 0; i < c->scene->shape_count; ++i )
	{
		uint32_t object = c->scene->shapes[i].object;
		const lw_pair_margin* listed = find_pair( &m->listed, c->base->bodies[body].link, object );
		row[i] = lwi_round_up( listed != NULL ? listed->margin - m->bodies[body] : m->object[object] );
	}
}

/// Largest margin of a body, without the share of `objects`.
static double largest_of_body( const lwi_margins* m, const lw_checker* c, uint32_t body )
{
	double largest = m->bodies[body];
	for ( uint32_t i = 0; i < m->listed.count; ++i )
	{
		const lw_pair_margin* pair = &m->listed.pairs[i];
		largest = fmax( largest, pair->a == c->base->bodies[body].link ? pair->margin - m->object[pair->b] : 0 );
	}
	return largest;
}

/// The largest margin of each cluster and subtree, children before parents.
static void fill_clusters( lwi_margins* m, const lw_checker* c )
{
	const lwi_cluster_tree* t = c->base->tree;
	for ( uint32_t i = t->cluster_count; i-- > 0; )
	{
		const lwi_cluster* cluster = &t->clusters[i];
		for ( uint32_t k = 0; k < cluster->body_count; ++k )
		{
			m->clusters[2 * i] = fmax( m->clusters[2 * i], largest_of_body( m, c, t->bodies[cluster->first_body + k] ) );
		}
		m->clusters[2 * i + 1] = fmax( m->clusters[2 * i + 1], m->clusters[2 * i] );
		if ( i > 0 )
		{
			m->clusters[2 * cluster->parent + 1] = fmax( m->clusters[2 * cluster->parent + 1], m->clusters[2 * i + 1] );
		}
	}
}

/// The objects' parts, shape by shape, if there are any. @return false without memory
static bool fill_objects( lwi_margins* m, const lw_checker* c )
{
	if ( !( largest_of( m->object, m->object_count ) > 0 ) )
	{
		return true;
	}
	m->objects = lwi_alloc_zero( &m->allocator, m->row_size, sizeof( float ) );
	for ( uint32_t i = 0; m->objects != NULL && i < c->scene->shape_count; ++i )
	{
		m->objects[i] = lwi_round_up( m->object[c->scene->shapes[i].object] );
	}
	m->bytes += m->row_size * sizeof( float );
	return m->objects != NULL;
}

/// The tables that queries read. @return false without memory
static bool fill_tables( lwi_margins* m, const lw_checker* c )
{
	m->bodies = lwi_alloc_zero( &m->allocator, m->body_count, sizeof( double ) );
	m->clusters = lwi_alloc_zero( &m->allocator, m->cluster_count, sizeof( double[2] ) );
	m->body_row = lwi_alloc_zero( &m->allocator, m->body_count, sizeof( float* ) );
	if ( m->bodies == NULL || m->clusters == NULL || m->body_row == NULL || !fill_objects( m, c ) )
	{
		return false;
	}
	size_t rows = 0;
	for ( uint32_t i = 0; i < m->body_count; ++i )
	{
		m->bodies[i] = m->all + m->link[c->base->bodies[i].link];
		m->body_row[i] = m->objects;
		rows += is_listed( &m->listed, c->base->bodies[i].link, false ) ? 1u : 0u;
	}
	m->rows = lwi_alloc_zero( &m->allocator, rows * m->row_size, sizeof( float ) );
	if ( m->rows == NULL )
	{
		return false;
	}
	m->row_bytes = rows * m->row_size * sizeof( float );
	float* row = m->rows;
	for ( uint32_t i = 0; i < m->body_count; ++i )
	{
		if ( is_listed( &m->listed, c->base->bodies[i].link, false ) )
		{
			fill_row( m, c, i, row );
			m->body_row[i] = row;
			row += m->row_size;
		}
	}
	fill_clusters( m, c );
	m->bytes += sizeof( *m ) + ( m->link_count + (size_t)m->object_count + m->body_count ) * sizeof( double ) +
				m->cluster_count * sizeof( double[2] ) + m->listed.count * sizeof( lw_pair_margin ) +
				m->body_count * sizeof( float* ) + m->row_bytes;
	return true;
}

lw_status lwi_margins_create( const lw_margins* def, const lw_checker* c, lw_diag* diag, lwi_margins** out_margins )
{
	const naming n = { "pair", c->base->robot, c->scene, false };
	*out_margins = NULL;
	lw_status status = check_general( def->environment, "environment", diag );
	status = status == LW_OK ? check_links( def->link_environment, "link_environment", c->base->robot, diag ) : status;
	status = status == LW_OK ? check_objects( def->object, c->scene, diag ) : status;
	status = status == LW_OK ? check_pairs( def->environment_pairs, def->environment_pair_count, &n, diag ) : status;
	if ( status != LW_OK )
	{
		return status;
	}
	lwi_margins* m = lwi_alloc_zero( &c->allocator, 1, sizeof( *m ) );
	if ( m == NULL )
	{
		return lwi_out_of_memory( diag, "margins" );
	}
	m->allocator = c->allocator;
	m->link_count = lw_robot_link_count( c->base->robot );
	m->object_count = c->scene != NULL ? c->scene->object_count : 0;
	m->body_count = lw_robot_body_count( c->base->robot );
	m->cluster_count = c->base->tree->cluster_count;
	m->row_size = c->environment.block_count * LWI_WIDTH;
	status = fill_given( m, def, &n, diag );
	bool none = m->largest == 0;
	if ( status == LW_OK && !none && !fill_tables( m, c ) )
	{
		status = lwi_out_of_memory( diag, "margins" );
	}
	if ( status != LW_OK || none )
	{
		lwi_margins_destroy( m );
		return status;
	}
	*out_margins = m;
	return LW_OK;
}

// --- lookups ---------------------------------------------------------------------------------------------------------

double lwi_margin_to_object( const lwi_margins* m, uint32_t link, uint32_t object )
{
	const lw_pair_margin* listed = find_pair( &m->listed, link, object );
	return listed != NULL ? listed->margin : m->all + m->link[link] + m->object[object];
}

double lwi_margin_of_links( const lwi_self_margins* m, uint32_t link_a, uint32_t link_b )
{
	uint32_t low = link_a < link_b ? link_a : link_b, high = link_a < link_b ? link_b : link_a;
	const lw_pair_margin* listed = find_pair( &m->listed, low, high );
	return listed != NULL ? listed->margin : m->all + m->link[low] + m->link[high];
}

double lw_checker_environment_margin( const lw_checker* checker, uint32_t link, uint32_t object )
{
	const lwi_margins* m = checker->margins;
	return m != NULL && link < m->link_count && object < m->object_count ? lwi_margin_to_object( m, link, object ) : 0;
}

double lw_checker_self_margin( const lw_checker* checker, uint32_t link_a, uint32_t link_b )
{
	const lwi_self_margins* m = checker->base->self.margins;
	bool pair = m != NULL && link_a < m->link_count && link_b < m->link_count && link_a != link_b;
	return pair ? lwi_margin_of_links( m, link_a, link_b ) : 0;
}
