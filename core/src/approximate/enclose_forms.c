// SPDX-License-Identifier: BSD-3-Clause
// Spheres around boxes, cylinders, capsules and spheres without a search: rows along the edges at growing depths, then a
// layer or a stack in the middle. Nothing here is trusted: lwi_enclose_check() judges the result.
//
// Kershner, "The number of circles covering a set", 1939 (staggered rows cover a plane with the fewest equal discs);
// Bellman,
//   "Dynamic programming", 1957 (which depths). Derivations: core/docs/detail.md.
#include "approximate/enclose.h"

#include "base/math_inline.h"
#include "shape/shape.h"

enum
{
	NODES = 320,         ///< depths that are tried for the rows
	WIDTHS = 48,         ///< widths that are tried for a ring of a layer
	MAX_CELLS = 12,      ///< of a grid, per axis
	MAX_SPHERES = 200000 ///< of one shape
};

/// The first depth that is tried, as a share of the excess.
#define FIRST_DEPTH 0.2
/// Counts of cells come from quotients that may be off by this.
#define QUOTIENT_SLACK 1e-9

/// One box or cylinder, about the origin, and the spheres in the making.
typedef struct form
{
	lw_transform pose;
	bool round; ///< a cylinder along z
	double half[3];
	double middle;           ///< the smallest of them: how deep a centre can lie
	double excess;           ///< a sphere at depth s has a radius of s + excess
	double margin, rounding; ///< are added to the radii
	const lw_allocator* memory;
	lwi_array* out; ///< double[4]; NULL: spheres are counted only
	double count;
	bool failed;
} form;

static void put( form* f, double x, double y, double z, double depth )
{
	f->count += 1;
	if ( f->out != NULL && !f->failed )
	{
		lw_vec3 c = lwi_transform( &f->pose, lwi_v3( x, y, z ) );
		const double sphere[4] = { c.x, c.y, c.z, depth + f->excess + f->margin + f->rounding };
		f->failed = !lwi_array_push( f->out, f->memory, sizeof( sphere ), sphere );
	}
}

/// Intervals of at most `step` that make up `length`.
static double intervals( double length, double step )
{
	return length > 0 ? ceil( length / step * ( 1 - QUOTIENT_SLACK ) ) : 0;
}

static double place( double half, double i, double count )
{
	return count > 0 ? half * ( 2 * i / count - 1 ) : 0;
}

/// Half the chord that a sphere at depth s cuts out of a line in the surface, at `aside` from the nearest point of it,
/// squared.
static double chord_sq( const form* f, double s, double aside )
{
	return 2 * s * f->excess + f->excess * f->excess - aside * aside;
}

// --- rows ------------------------------------------------------------------------------------------------------------

/// Spheres on the edges of the box that lies s deep in a box, which cover the frames of its faces from u to 2 s - u.
static double box_row( form* f, double u, double s )
{
	double w = s - u, free_sq = chord_sq( f, s, w ), inner[3], n[3], corners = 1, count = 0;
	// at a corner three rows share a sphere, which must reach as far along each as it does across
	if ( !( free_sq >= w * w ) || !( free_sq > 0 ) )
	{
		return INFINITY;
	}
	for ( int k = 0; k < 3; ++k )
	{
		inner[k] = fmax( f->half[k] - s, 0 );
		n[k] = intervals( 2 * inner[k], 2 * sqrt( free_sq ) );
		corners *= n[k] > 0 ? 2 : 1;
	}
	count = corners;
	for ( int k = 0; k < 3; ++k )
	{
		count += n[k] > 0 ? ( n[k] - 1 ) * corners / 2 : 0;
	}
	for ( int k = 0; k < 3 && f->out != NULL; ++k )
	{
		// along axis k, at the ends of the two others. The corners belong to the row of the first axis that has a length
		int a = ( k + 1 ) % 3, b = ( k + 2 ) % 3;
		bool first = true, only = n[0] + n[1] + n[2] == 0;
		for ( int j = 0; j < k; ++j )
		{
			first = first && n[j] == 0;
		}
		for ( double i = first ? 0 : 1; ( n[k] > 0 && i <= n[k] - ( first ? 0 : 1 ) ) || ( only && k == 0 && i == 0 ); ++i )
		{
			for ( double ia = 0; ia <= ( n[a] > 0 ? 1 : 0 ); ++ia )
			{
				for ( double ib = 0; ib <= ( n[b] > 0 ? 1 : 0 ); ++ib )
				{
					double p[3];
					p[k] = place( inner[k], i, n[k] );
					p[a] = n[a] > 0 ? place( inner[a], ia, 1 ) : 0;
					p[b] = n[b] > 0 ? place( inner[b], ib, 1 ) : 0;
					put( f, p[0], p[1], p[2], s );
				}
			}
		}
	}
	return count;
}

/// Spheres of a ring of this radius, each `aside` from the points that it covers, out to radius `rim`; 0 if none do.
static double ring_count( double free_sq, double rim, double radius )
{
	// a point of the rim at the angle phi from a sphere is 2 rim radius ( 1 - cos phi ) farther from it, squared
	double q = rim * radius > 0 ? free_sq / ( 2 * rim * radius ) : 2;
	return !( free_sq >= 0 ) ? 0 : q >= 2 ? 1 : intervals( LWI_PI, acos( 1 - q ) );
}

static void put_ring( form* f, double radius, double z, double count, double depth )
{
	for ( double i = 0; i < count && f->out != NULL; ++i )
	{
		put( f, radius * cos( 2 * LWI_PI * i / count ), radius * sin( 2 * LWI_PI * i / count ), z, depth );
	}
}

/// The same for a cylinder: rings, or a stack on the axis.
static double cylinder_row( form* f, double u, double s )
{
	double radius = f->half[0], height = f->half[2], free_sq = chord_sq( f, s, s - u );
	if ( s >= radius )
	{
		double half = fmax( height - s, 0 ), n = intervals( 2 * half, 2 * sqrt( chord_sq( f, s, 0 ) ) );
		for ( double i = 0; i <= n && f->out != NULL && n < MAX_SPHERES; ++i )
		{
			put( f, 0, 0, place( half, i, n ), s );
		}
		return free_sq >= 0 ? n + 1 : INFINITY;
	}
	double m = ring_count( free_sq, radius, radius - s );
	put_ring( f, radius - s, height > s ? height - s : 0, m, s );
	if ( height > s )
	{
		put_ring( f, radius - s, s - height, m, s );
	}
	return m > 0 ? ( height > s ? 2 : 1 ) * m : INFINITY;
}

static double row( form* f, double u, double s )
{
	return f->round ? cylinder_row( f, u, s ) : box_row( f, u, s );
}

// --- layers ----------------------------------------------------------------------------------------------------------

/// Staggered rows of discs of radius rho over a rectangle.
typedef struct stagger
{
	double count, n, rows, pitch, edge, step; ///< n per row; rows at `edge` from the rim, `pitch` apart; discs 2 step apart
	bool more;                                ///< every second row has one more
	bool turned;                              ///< rows along y
} stagger;

static stagger best_stagger( double x, double y, double rho )
{
	stagger best = { .count = INFINITY };
	for ( int way = 0; way < 4; ++way )
	{
		double along = way & 1 ? y : x, across = way & 1 ? x : y;
		bool more = ( way & 2 ) != 0;
		double least = floor( along / ( 2 * rho ) );
		for ( double n = fmax( least, 1 ); n <= 2 * least + 3; ++n )
		{
			double step = along / ( more ? 2 * n : 2 * n - 1 );
			if ( n == 1 && !more )
			{
				step = 0.5 * along; // one row after another of single discs would not be staggered
			}
			double edge_sq = rho * rho - step * step;
			if ( !( edge_sq > 0 ) )
			{
				continue;
			}
			double edge = sqrt( edge_sq ), pitch = n == 1 && !more ? 2 * edge : rho + edge;
			double rows = 1 + intervals( across - 2 * edge, pitch );
			if ( rows == 1 && !more )
			{
				step = 0.5 * along / n;
				edge = 0.5 * across;
			}
			double near = rows > 1 ? ( across - 2 * edge ) / ( rows - 1 ) : 0;
			if ( near > 2 * edge && near < rho - edge )
			{
				continue; // rows so thin and near leave gaps between three discs
			}
			double count = rows * n + ( more ? floor( rows / 2 ) : 0 );
			if ( count < best.count )
			{
				best = ( stagger ){ count, n, rows, pitch, edge, step, more, ( way & 1 ) != 0 };
			}
		}
	}
	return best;
}

/// Covers a rectangle of the two larger faces of a box with spheres in its middle plane.
static double box_layer( form* f, double inset )
{
	int thin = f->half[0] <= f->half[1] && f->half[0] <= f->half[2] ? 0 : f->half[1] <= f->half[2] ? 1 : 2;
	int a = ( thin + 1 ) % 3, b = ( thin + 2 ) % 3;
	double x = 2 * ( f->half[a] - inset ), y = 2 * ( f->half[b] - inset );
	if ( x <= 0 || y <= 0 )
	{
		return 0;
	}
	stagger g = best_stagger( x, y, sqrt( chord_sq( f, f->middle, 0 ) ) );
	if ( f->out == NULL || !( g.count <= MAX_SPHERES ) )
	{
		return g.count;
	}
	double along = g.turned ? y : x, across = g.turned ? x : y;
	// the rows keep their least distance from the rim or less: the spare width is shared between them
	double pitch = g.rows > 1 ? fmin( g.pitch, ( across - 2 * g.edge ) / ( g.rows - 1 ) ) : 0;
	for ( double r = 0; r < g.rows; ++r )
	{
		bool odd = fmod( r, 2 ) > 0;
		bool single = g.n == 1 && !g.more;
		for ( double i = 0; i < g.n + ( odd && g.more ? 1 : 0 ); ++i )
		{
			double u = -0.5 * along + ( single ? g.step : ( odd ? 0 : g.step ) + 2 * g.step * i );
			double v = g.rows == 1 ? 0 : -0.5 * across + g.edge + r * pitch;
			double p[3] = { 0, 0, 0 };
			p[a] = g.turned ? v : u;
			p[b] = g.turned ? u : v;
			put( f, p[0], p[1], p[2], f->middle );
		}
	}
	return g.count;
}

/// Covers a disc of the ends of a flat cylinder with rings of spheres in its middle plane.
static double cylinder_layer( form* f, double inset )
{
	double rho = sqrt( chord_sq( f, f->middle, 0 ) ), rim = f->half[0] - inset, count = 0;
	if ( f->half[0] <= f->half[2] )
	{
		return 0;
	}
	while ( rim > 0 && count < MAX_SPHERES )
	{
		if ( rim <= rho )
		{
			put( f, 0, 0, 0, f->middle );
			return count + 1;
		}
		double most = 0, width = 0, spheres = 0;
		for ( int i = 1; i < WIDTHS; ++i )
		{
			double w = rho * i / WIDTHS, inner = fmax( rim - 2 * w, 0 );
			double m = ring_count( rho * rho - w * w, rim, rim - w ), worth = ( rim * rim - inner * inner ) / m;
			if ( m > 0 && worth > most )
			{
				most = worth;
				width = w;
				spheres = m;
			}
		}
		put_ring( f, rim - width, 0, spheres, f->middle );
		count += spheres;
		rim -= 2 * width;
	}
	return count;
}

static double layer( form* f, double inset )
{
	return f->round ? cylinder_layer( f, inset ) : box_layer( f, inset );
}

// --- the whole -------------------------------------------------------------------------------------------------------

/// Cells of a grid with a sphere in each, for excesses so large that rows are not worth it. Into n[3]. Returns their number.
static double best_grid( const form* f, double n[3] )
{
	double best = INFINITY;
	for ( int i = 0; i < MAX_CELLS * MAX_CELLS * MAX_CELLS && !f->round; ++i )
	{
		const double m[3] = { 1 + i % MAX_CELLS, 1 + i / MAX_CELLS % MAX_CELLS, 1 + i / MAX_CELLS / MAX_CELLS };
		double reach_sq = 0, depth = INFINITY;
		for ( int k = 0; k < 3; ++k )
		{
			reach_sq += f->half[k] / m[k] * ( f->half[k] / m[k] );
			depth = fmin( depth, f->half[k] / m[k] );
		}
		if ( sqrt( reach_sq ) - depth <= f->excess && m[0] * m[1] * m[2] < best )
		{
			best = m[0] * m[1] * m[2];
			memcpy( n, m, sizeof( m ) );
		}
	}
	return best;
}

static void put_grid( form* f, const double n[3] )
{
	double cell[3] = { f->half[0] / n[0], f->half[1] / n[1], f->half[2] / n[2] };
	double depth = fmin( cell[0], fmin( cell[1], cell[2] ) );
	for ( double i = 0; i < n[0]; ++i )
	{
		for ( double j = 0; j < n[1]; ++j )
		{
			for ( double k = 0; k < n[2]; ++k )
			{
				put( f, cell[0] * ( 2 * i + 1 ) - f->half[0], cell[1] * ( 2 * j + 1 ) - f->half[1],
					cell[2] * ( 2 * k + 1 ) - f->half[2], depth );
			}
		}
	}
}

/// Depths of rows that together take the fewest spheres: each row covers the surface from one node (a distance from the
/// edges) to the next; the last lies in the middle, and leaves a layer to cover. *last is the node that it begins at.
static double best_rows( form* f, double node[NODES], int before[NODES], int* last )
{
	double count[NODES], best = INFINITY, low = fmin( FIRST_DEPTH * f->excess, 0.5 * f->middle );
	*last = -1;
	for ( int j = 0; j < NODES; ++j )
	{
		node[j] = j == 0 ? 0 : f->middle * pow( low / f->middle, 1 - ( j - 1 ) / ( NODES - 2.0 ) );
		count[j] = j == 0 ? 0 : INFINITY;
		before[j] = -1;
		for ( int i = 0; i < j; ++i )
		{
			double sum = count[i] < count[j] ? count[i] + row( f, node[i], 0.5 * ( node[i] + node[j] ) ) : INFINITY;
			if ( sum < count[j] )
			{
				count[j] = sum;
				before[j] = i;
			}
		}
		double sum = count[j] < best ? count[j] + row( f, node[j], f->middle ) : INFINITY;
		if ( sum < best )
		{
			sum += layer( f, 2 * f->middle - node[j] );
		}
		if ( sum < best )
		{
			best = sum;
			*last = j;
		}
	}
	return best;
}

/// Puts the spheres of a form, or none if there are too many.
static bool put_form( form* f )
{
	double node[NODES], n[3] = { 1, 1, 1 };
	int before[NODES], last;
	lwi_array* out = f->out;
	f->out = NULL; // the search for depths only counts
	double by_grid = best_grid( f, n ), by_rows = best_rows( f, node, before, &last );
	f->out = out;
	if ( !( fmin( by_grid, by_rows ) <= MAX_SPHERES ) )
	{
		return false;
	}
	if ( by_grid <= by_rows )
	{
		put_grid( f, n );
		return true;
	}
	row( f, node[last], f->middle );
	layer( f, 2 * f->middle - node[last] );
	for ( int j = last; before[j] >= 0; j = before[j] )
	{
		row( f, node[before[j]], 0.5 * ( node[before[j]] + node[j] ) );
	}
	return true;
}

/// A row on the axis of a capsule (of a sphere: one). The necks between two spheres are as wide as the capsule.
static bool put_capsule( form* f, double radius, double half )
{
	double inner = fmax( half - f->excess, 0 ), n = intervals( 2 * inner, 2 * sqrt( chord_sq( f, radius, 0 ) ) );
	for ( double i = 0; i <= n && n < MAX_SPHERES; ++i )
	{
		put( f, 0, 0, place( inner, i, n ), radius );
	}
	return n < MAX_SPHERES;
}

static bool put_shape( form* f, const lw_shape* shape )
{
	const double* d = shape->dimensions;
	if ( shape->type == LW_SHAPE_SPHERE )
	{
		f->excess = f->margin = 0;
		put( f, 0, 0, 0, d[0] );
		return true;
	}
	if ( shape->type == LW_SHAPE_CAPSULE )
	{
		return put_capsule( f, d[0], 0.5 * d[1] );
	}
	f->round = shape->type == LW_SHAPE_CYLINDER;
	if ( !f->round && shape->type != LW_SHAPE_BOX )
	{
		return false;
	}
	for ( int k = 0; k < 3; ++k )
	{
		f->half[k] = 0.5 * ( f->round ? ( k < 2 ? 2 * d[0] : d[1] ) : d[k] );
	}
	f->middle = fmin( f->half[0], fmin( f->half[1], f->half[2] ) );
	return f->middle > 0 && put_form( f );
}

lw_status lwi_enclose_forms( lwi_body* body, const lw_geometry_def* def, double excess, double margin, lwi_array* out,
	bool* made )
{
	*made = false;
	// a centre is no less deep in a prism than in its cylinder, and the excess over the prism counts as larger by the chord
	double target = excess - margin - body->chord - 16 * body->slack;
	for ( uint32_t i = 0; i < def->shape_count && target > 0; ++i )
	{
		form f = { .pose = def->body_from_shape != NULL ? def->body_from_shape[i] : lw_transform_identity(),
			.excess = target,
			.margin = margin,
			.rounding = 8 * body->slack,
			.memory = &body->memory,
			.out = out };
		if ( lwi_body_stopped( body ) || !put_shape( &f, def->shapes[i] ) )
		{
			return LW_OK;
		}
		if ( f.failed )
		{
			return LW_ERROR_OUT_OF_MEMORY;
		}
	}
	*made = target > 0;
	return LW_OK;
}
