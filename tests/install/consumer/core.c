// SPDX-License-Identifier: BSD-3-Clause
// C against the installed core: headers and library are of one version, and two boxes 3 m apart are measured.
#include <leeway/leeway.h>

#include <stdio.h>

int main( void )
{
	const double size[3] = { 1, 1, 1 };
	lw_transform a = lw_transform_identity(), b = lw_transform_identity();
	b.t[0] = 4;
	lw_shape* box = NULL;
	lw_query* query = NULL;
	lw_query_def def = lw_query_def_default();
	lw_clearance clearance = lw_clearance_unknown();
	bool ok = lw_version() == LW_VERSION;
	ok = ok && lw_shape_create_primitive( LW_SHAPE_BOX, size, NULL, NULL, &box ) == LW_OK;
	ok = ok && lw_query_create( &def, NULL, NULL, NULL, &query ) == LW_OK;
	ok = ok && lw_shape_distance( box, &a, box, &b, NULL, query, &clearance ) == LW_OK;
	ok = ok && clearance.lower <= 3 && clearance.upper >= 3 - 1e-12 && clearance.upper - clearance.lower < 1e-6;
	lw_reach* reach = NULL; // the function behind it is linked with qhull
	ok = ok && lw_reach_create( NULL, NULL, NULL, &reach ) == LW_ERROR_INVALID_ARGUMENT;
	printf( "leeway %u: two boxes are %.9f to %.9f m apart\n", lw_version(), clearance.lower, clearance.upper );
	lw_query_destroy( query );
	lw_shape_release( box );
	return ok ? 0 : 1;
}
