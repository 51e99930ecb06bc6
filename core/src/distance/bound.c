// SPDX-License-Identifier: BSD-3-Clause
// The running bound of a search: what is measured lowers it, and the answer is read from it.
// Method and proof: core/docs/distance.md; margins: core/docs/margins.md.
#include "distance/distance.h"
#include "base/math_inline.h"

#include <math.h>
#include <string.h>

bool lwi_range_is_valid( const lw_range* range )
{
	return range->min_d >= 0 && range->min_d < INFINITY && range->max_d > range->min_d && range->alpha >= 0 &&
		   range->alpha < 1;
}

void lwi_bound_init( lwi_bound* bound, const lw_range* range )
{
	memset( bound, 0, sizeof( *bound ) );
	bound->range = *range;
	bound->upper = INFINITY;
	bound->cutoff = range->max_d;
	bound->floor = INFINITY;
	bound->triangle_a = bound->triangle_b = bound->pair = bound->current_pair = LW_INVALID_INDEX;
}

/// The next double but one: far enough that taking `rounding` off again does not round back to v.
static double beyond( double v )
{
	return lwi_next_up( lwi_next_up( v ) );
}

void lwi_bound_allow_rounding( lwi_bound* bound, double rounding, double stretch )
{
	bound->rounding = rounding - stretch * bound->lowest; // of a distance: margins are not stretched
	bound->stretch = stretch;
	bound->cutoff = beyond( bound->range.max_d * ( 1 + 2 * stretch ) + bound->rounding );
}

/// Lower bound of a clearance, given a lower bound v of the measured one.
static double less_rounding( const lwi_bound* bound, double v )
{
	return v - bound->rounding - bound->stretch * fabs( v );
}

bool lwi_bound_offer( lwi_bound* bound, double lower, double upper )
{
	// the margin is exact, the differences are rounded: lower by half a roundoff of their size, of which the distance's own
	// bound has room for its part
	lower = lower - bound->margin - 0x1p-52 * bound->margin;
	upper = upper - bound->margin;
	bound->floor = lower < bound->floor ? lower : bound->floor;
	bound->measured = upper < bound->measured ? upper : bound->measured;
	if ( !( upper < bound->upper && less_rounding( bound, lower ) < bound->range.max_d ) )
	{
		return false;
	}
	bound->upper = upper;
	bound->done = upper <= bound->range.min_d;
	// Within alpha of the best is good enough, but not at or below min_d while the best is above: the verdict needs that.
	double cutoff = ( 1 - bound->range.alpha ) * upper;
	double min_d = bound->range.min_d;
	double decisive = bound->rounding > 0 ? beyond( min_d * ( 1 + 2 * bound->stretch ) + bound->rounding )
										  : lw_range_threshold( min_d ).max_d;
	decisive = decisive < upper ? decisive : upper;
	cutoff = cutoff > decisive ? cutoff : decisive;
	cutoff += bound->ties != NULL ? bound->ties->width : 0;
	bound->cutoff = cutoff < bound->cutoff ? cutoff : bound->cutoff;
	bound->pair = bound->current_pair;
	return true;
}

void lwi_bound_result( const lwi_bound* bound, lw_clearance* out )
{
	out->lower = 0; // each on its own: a copy of an answer that was just made would wait for it
	out->upper = INFINITY;
	out->point_a = out->point_b = lwi_v3( 0, 0, 0 );
	out->kind = LW_CLEARANCE_UNKNOWN;
	out->a = out->b = LW_INVALID_INDEX;
	if ( bound->failed )
	{
		return;
	}
	if ( bound->upper == INFINITY )
	{
		out->kind = LW_CLEARANCE_FAR;
		out->lower = bound->range.max_d;
		return;
	}
	const double lower = less_rounding( bound, bound->floor < bound->cutoff ? bound->floor : bound->cutoff );
	if ( !bound->done && lower >= bound->range.max_d ) // of a pair that was beyond it by less than rounding
	{
		out->kind = LW_CLEARANCE_FAR;
		out->lower = bound->range.max_d;
		return;
	}
	out->upper = bound->upper;
	out->lower = !bound->done && lower > bound->lowest ? lower : bound->lowest;
	const bool violates = bound->done && bound->upper <= bound->range.min_d;
	const bool apart = !bound->done && out->lower > bound->range.min_d;
	out->kind = violates ? LW_CLEARANCE_VIOLATION : apart ? LW_CLEARANCE_NEAR : LW_CLEARANCE_UNDECIDED;
}

lw_range lw_range_exact( void )
{
	return ( lw_range ){ 0, INFINITY, 0 };
}

lw_range lw_range_threshold( double min_d )
{
	return ( lw_range ){ min_d, lwi_next_up( min_d ), 0 };
}

lw_clearance lw_clearance_unknown( void )
{
	return (
		lw_clearance ){ 0, INFINITY, { 0, 0, 0 }, { 0, 0, 0 }, LW_CLEARANCE_UNKNOWN, LW_INVALID_INDEX, LW_INVALID_INDEX };
}
