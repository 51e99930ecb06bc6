// SPDX-License-Identifier: BSD-3-Clause
// Searches for the state in which two links are nearest: evidence of contact, or an upper bound of their separation.
//
// R. Hooke, T. A. Jeeves, "Direct search solution of numerical and statistical problems", J. ACM 8(2), 1961: steps along
// each variable, a further step in the direction that helped, step widths halved when nothing helps. No gradients:
// distances of meshes have kinks wherever the nearest pair of features changes, and those are where minima are. Steps in
// random directions from where this ends (an evolution strategy) found nothing nearer on ARMAR-III.
#include "base/math_inline.h"
#include "reachability/proof.h"

#include <string.h>

enum
{
	START_CANDIDATES = 8, ///< random states; the nearest of them begins a restart
	HALVINGS = 12         ///< from a quarter of the range to 6e-5 of it
};

/// A state is nearer if its distance is less than this share of the least one: to tell equal ones apart costs the most.
#define NEARER 0.98

/// One descent: the best state is in analyser->best.
typedef struct descent
{
	lwi_pair_analyser* analyser;
	double value;  ///< distance at analyser->best
	uint32_t used; ///< measurements
	uint32_t budget;
} descent;

static size_t state_bytes( const lwi_pair_analyser* p )
{
	return p->robot->variable_count * sizeof( double );
}

static bool is_over( const descent* d )
{
	return d->used >= d->budget || d->value <= 0;
}

/// Measures analyser->trial; takes it over if it is nearer.
static bool try_trial( descent* d )
{
	lwi_pair_analyser* p = d->analyser;
	++d->used;
	double found = lwi_pair_analyser_distance( p, p->trial, NEARER * d->value );
	if ( found < d->value )
	{
		d->value = found;
		memcpy( p->best, p->trial, state_bytes( p ) );
		return true;
	}
	return false;
}

static bool wraps( const lwi_pair_analyser* p, uint32_t v )
{
	return p->robot->variables[v].wraps;
}

/// Keeps a value inside the range of random states: clamped, or turned back into [-pi, pi].
static double inside( const lwi_pair_analyser* p, uint32_t v, double value )
{
	double low = p->sample_lower[v], high = p->sample_upper[v];
	return lwi_clamp( wraps( p, v ) ? remainder( value, high - low ) : value, low, high );
}

/// A step along each variable, forwards or else backwards. True if any helped.
static bool explore( descent* d, double scale )
{
	lwi_pair_analyser* p = d->analyser;
	bool helped = false;
	for ( uint32_t i = 0; i < p->variable_count; ++i )
	{
		uint32_t v = p->variables[i];
		double step = scale * ( p->sample_upper[v] - p->sample_lower[v] );
		for ( int sign = 1; sign >= -1 && !is_over( d ); sign -= 2 )
		{
			memcpy( p->trial, p->best, state_bytes( p ) );
			p->trial[v] = inside( p, v, p->best[v] + sign * step );
			if ( p->trial[v] != p->best[v] && try_trial( d ) )
			{
				helped = true;
				break;
			}
		}
	}
	return helped;
}

/// Once more the way from `previous` to `best`, as long as that helps.
static void follow( descent* d )
{
	lwi_pair_analyser* p = d->analyser;
	bool helped = true;
	while ( helped && !is_over( d ) )
	{
		memcpy( p->trial, p->best, state_bytes( p ) );
		for ( uint32_t i = 0; i < p->variable_count; ++i )
		{
			uint32_t v = p->variables[i];
			p->trial[v] = inside( p, v, 2 * p->best[v] - p->previous[v] );
		}
		memcpy( p->previous, p->best, state_bytes( p ) );
		helped = try_trial( d );
	}
}

static void run( descent* d )
{
	lwi_pair_analyser* p = d->analyser;
	double scale = 0.25;
	for ( int halving = 0; halving < HALVINGS && !is_over( d ); )
	{
		memcpy( p->previous, p->best, state_bytes( p ) );
		if ( explore( d, scale ) )
		{
			follow( d );
		}
		else
		{
			scale *= 0.5;
			++halving;
		}
	}
}

/// Puts the nearest of a few random states of the pair's variables into analyser->best.
static void restart( descent* d, uint64_t* random, const double* q )
{
	lwi_pair_analyser* p = d->analyser;
	d->value = INFINITY;
	memcpy( p->best, q, state_bytes( p ) );
	for ( int i = 0; i < START_CANDIDATES && !is_over( d ); ++i )
	{
		memcpy( p->trial, q, state_bytes( p ) );
		lwi_pair_analyser_random_state( p, random, p->variables, p->variable_count, p->trial );
		try_trial( d );
	}
}

void lwi_pair_analyser_search( lwi_pair_analyser* p, uint64_t seed, uint32_t budget, double* closest, double* q )
{
	uint64_t random = seed;
	uint32_t used = 0;
	for ( uint32_t start = 0; used<budget&& * closest> 0; ++start )
	{
		// a third for the state that is known, the rest for restarts
		descent d = { p, *closest, 0, ( budget + 2 ) / 3 };
		if ( start == 0 )
		{
			memcpy( p->best, q, state_bytes( p ) );
		}
		else
		{
			restart( &d, &random, q );
		}
		run( &d );
		used += d.used > 0 ? d.used : budget;
		if ( d.value < *closest )
		{
			*closest = d.value;
			memcpy( q, p->best, state_bytes( p ) );
		}
	}
}
