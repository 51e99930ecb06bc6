// SPDX-License-Identifier: BSD-3-Clause
// How far does an arm leave a seam? Two joints follow a line and an arc by cubics between nine states that are on them; the deviation is
// proved for all times in between.
#include <leeway/leeway.h>
#include <math.h>
#include <stdio.h>

enum
{
	PIECES = 8
};

/// Two links of half a metre in a plane, and their tool.
static lw_robot* make_arm( lw_diag* diag )
{
	const char* links[] = { "base", "upper", "lower" };
	lw_joint_def joints[2] = { lw_joint_def_default(), lw_joint_def_default() };
	for ( uint32_t i = 0; i < 2; ++i )
	{
		joints[i].name = i == 0 ? "shoulder" : "elbow";
		joints[i].type = LW_JOINT_REVOLUTE;
		joints[i].parent = i;
		joints[i].child = i + 1;
		joints[i].axis[0] = 0;
		joints[i].axis[2] = 1;
		joints[i].lower = -3;
		joints[i].upper = 3;
		joints[i].parent_from_joint.t[0] = i == 0 ? 0 : 0.5;
	}
	lw_robot_def def = lw_robot_def_default();
	def.name = "arm";
	def.link_names = links;
	def.link_count = 3;
	def.joints = joints;
	def.joint_count = 2;
	lw_robot* robot = NULL;
	lw_robot_create( &def, NULL, diag, &robot );
	return robot;
}

/// The joints that take the tool to a place of the seam, elbow to the left.
static void reach( const lw_region_def* seam, double fraction, double q[2] )
{
	const lw_transform at = lw_region_reference( seam, fraction );
	const double square = at.t[0] * at.t[0] + at.t[1] * at.t[1];
	q[1] = acos( ( square - 0.5 ) / 0.5 );
	q[0] = atan2( at.t[1], at.t[0] ) - 0.5 * q[1];
}

/// Control points of a cubic whose ends are on the seam and go along it.
static void fit( const lw_region_def* seam, int piece, double points[4][2] )
{
	const double step = 1.0 / PIECES, small = 1e-5;
	for ( int end = 0; end < 2; ++end )
	{
		const double fraction = ( piece + end ) * step;
		double before[2], after[2];
		reach( seam, fraction, points[3 * end] );
		reach( seam, fraction - small, before );
		reach( seam, fraction + small, after );
		for ( int k = 0; k < 2; ++k )
		{
			const double third = ( after[k] - before[k] ) / ( 2 * small ) * step / 3;
			points[1 + end][k] = points[3 * end][k] + ( end == 0 ? third : -third );
		}
	}
}

static int prove( const lw_checker* checker, const lw_region_def* seam, const char* name )
{
	const uint32_t variables[2] = { 0, 1 }, fraction_of = 0;
	const double rest[2] = { 0, 0 }, fractions[2] = { 0, 1 };
	double points[PIECES][4][2];
	lw_timed_piece pieces[PIECES];
	for ( int p = 0; p < PIECES; ++p )
	{
		fit( seam, p, points[p] );
		pieces[p] = ( lw_timed_piece ){ p, p + 1, 3, &points[p][0][0] };
	}
	const lw_track track = { .variables = variables, .variable_count = 2, .pieces = pieces, .piece_count = PIECES };
	const lw_timed_piece steady = { 0, PIECES, 1, fractions };
	const lw_track timing = { .variables = &fraction_of, .variable_count = 1, .pieces = &steady, .piece_count = 1 };
	const lw_clock clock = { &track, 1, rest };
	lw_diag diag = { 0 };
	lw_region* region = NULL;
	lw_region_result r;
	lw_region_errors e;
	if ( lw_region_create( checker, seam, NULL, &diag, &region ) != LW_OK ||
	     lw_region_timed( region, &clock, &timing, 0, PIECES, &r ) != LW_OK ||
	     lw_region_state( region, points[0][0], 0, &e ) != LW_OK )
	{
		fprintf( stderr, "%s: %s\n", name, diag.message );
		lw_region_destroy( region );
		return 2;
	}
	if ( r.verdict == LW_VERDICT_FREE )
	{
		printf( "%s: off by at most %.4f mm across and %.4f mm along x, proved; %.0e mm at its start\n", name,
		    1000 * fmax( r.upper[LW_REGION_Y], -r.lower[LW_REGION_Y] ),
		    1000 * fmax( r.upper[LW_REGION_X], -r.lower[LW_REGION_X] ), 1000 * fabs( e.value[e.worst] ) );
	}
	else
	{
		printf( "%s: %s at %g s: %s of %g m\n", name, lw_verdict_name( r.verdict ), r.time, lw_region_limit_name( r.limit ),
		    r.value );
	}
	lw_region_destroy( region );
	return r.verdict == LW_VERDICT_FREE ? 0 : 1;
}

int main( void )
{
	lw_diag diag = { 0 };
	lw_robot* robot = make_arm( &diag );
	lw_checker_def def = lw_checker_def_default();
	def.robot = robot;
	lw_checker* checker = NULL;
	if ( robot == NULL || lw_checker_create( &def, NULL, &diag, &checker ) != LW_OK )
	{
		fprintf( stderr, "could not build: %s\n", diag.message );
		return 2;
	}
	lw_region_def line = lw_region_def_default();
	line.link = 2;
	line.link_from_b.t[0] = 0.5; // the tool
	for ( int i = 0; i < 3; ++i )
	{
		line.lower[i] = -1e-4;
		line.upper[i] = 1e-4;
	}
	lw_region_def arc = line;
	lw_transform from = lw_transform_identity(), to = from;
	from.t[0] = to.t[0] = 0.6;
	from.t[1] = -0.3;
	to.t[1] = 0.3;
	lw_region_line( &line, &from, &to );
	lw_region_arc( &arc, &from, ( lw_vec3 ){ 0.75, 0, 0 }, &to );
	const int first = prove( checker, &line, "line" ), second = prove( checker, &arc, "arc" );
	lw_checker_release( checker );
	lw_robot_release( robot );
	return first > second ? first : second;
}
