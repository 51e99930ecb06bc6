// SPDX-License-Identifier: BSD-3-Clause
// How far is a small mesh from a box? The smallest program against the core: build, ask, read the certified interval.
#include <leeway/leeway.h>
#include <stdio.h>

int main( void )
{
	const double vertices[] = { 0, 0, 0, 0.3, 0, 0, 0, 0.3, 0, 0, 0, 0.3 };
	const uint32_t triangles[] = { 0, 1, 2, 0, 1, 3, 0, 2, 3, 1, 2, 3 };
	lw_mesh_def def = lw_mesh_def_default();
	def.vertices = vertices;
	def.vertex_count = 4;
	def.indices = triangles;
	def.triangle_count = 4;
	const double edges[3] = { 0.2, 0.2, 0.2 };
	lw_diag diag = { 0 };
	lw_shape *mesh = NULL, *box = NULL;
	lw_query* query = NULL;
	lw_query_def query_def = lw_query_def_default();
	if ( lw_shape_create_mesh( &def, NULL, &diag, &mesh ) != LW_OK ||
	     lw_shape_create_primitive( LW_SHAPE_BOX, edges, NULL, &diag, &box ) != LW_OK ||
	     lw_query_create( &query_def, NULL, NULL, NULL, &query ) != LW_OK )
	{
		fprintf( stderr, "could not build: %s\n", diag.message );
		return 2;
	}
	lw_transform world_from_mesh = lw_transform_identity(), world_from_box = world_from_mesh;
	world_from_box.t[0] = 0.5;
	lw_clearance c;
	lw_shape_distance( mesh, &world_from_mesh, box, &world_from_box, NULL, query, &c );
	printf( "between %.17g and %.17g m, at (%g, %g, %g)\n", c.lower, c.upper, c.point_a.x, c.point_a.y, c.point_a.z );
	lw_query_destroy( query );
	lw_shape_release( box );
	lw_shape_release( mesh );
	return c.lower > 0 ? 0 : 1;
}
