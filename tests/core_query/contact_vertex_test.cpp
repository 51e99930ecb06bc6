// SPDX-License-Identifier: BSD-3-Clause
// A vertex inside of a box or cylinder answers a question for yes or no. The oracle is the search that measures distances: it has no such test.
#include "sanitized.hpp"
#include "shapes.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace
{

/// A surface, a box or cylinder, and their poses.
struct Pair
{
	ShapePtr mesh, solid;
	lw_transform mesh_pose, solid_pose;
	double size;
};

ShapePtr randomSolid( SeededRng& rng, double size )
{
	const double x = rng.uniform( 0.1, 1 ) * size, y = rng.uniform( 0.1, 1 ) * size, z = rng.uniform( 0.1, 1 ) * size;
	return rng.integer( 0, 1 ) == 0 ? makePrimitive( LW_SHAPE_BOX, x, y, z )
	                                : makePrimitive( LW_SHAPE_CYLINDER, 0.5 * x, y );
}

lw_clearance ask( const Pair& pair, bool mesh_first, const lw_range& range, const QueryPtr& query )
{
	lw_clearance out;
	const lw_shape *a = mesh_first ? pair.mesh.get() : pair.solid.get(),
	               *b = mesh_first ? pair.solid.get() : pair.mesh.get();
	const lw_transform &pose_a = mesh_first ? pair.mesh_pose : pair.solid_pose,
	                   &pose_b = mesh_first ? pair.solid_pose : pair.mesh_pose;
	EXPECT_EQ( LW_OK, lw_shape_distance( a, &pose_a, b, &pose_b, &range, query.get(), &out ) );
	return out;
}

/// How far a point of the world is from a shape.
double distanceTo( const ShapePtr& shape, const lw_transform& pose, lw_vec3 point, double size, const QueryPtr& query )
{
	const ShapePtr ball = makePrimitive( LW_SHAPE_SPHERE, 1e-12 * size );
	const lw_transform place = at( point.x, point.y, point.z );
	lw_clearance out;
	EXPECT_EQ( LW_OK, lw_shape_distance( shape.get(), &pose, ball.get(), &place, nullptr, query.get(), &out ) );
	return out.upper;
}

/// Answers of a pair agree, and the witness of a contact is on the triangle that is named and in the solid.
void check( const Pair& pair, bool mesh_first, double min_d, const QueryPtr& query )
{
	const lw_clearance exact = ask( pair, mesh_first, lw_range_exact(), query );
	const lw_clearance answer = ask( pair, mesh_first, lw_range_threshold( min_d ), query );
	if ( answer.kind != LW_CLEARANCE_VIOLATION )
	{
		EXPECT_GT( exact.upper, min_d );
		return;
	}
	EXPECT_LE( exact.lower, min_d );
	EXPECT_LE( answer.upper, min_d );
	const lw_vec3 on_mesh = mesh_first ? answer.point_a : answer.point_b,
	              on_solid = mesh_first ? answer.point_b : answer.point_a;
	const std::uint32_t triangle = mesh_first ? answer.a : answer.b;
	ASSERT_LT( triangle, lw_shape_get_info( pair.mesh.get() ).triangle_count );
	EXPECT_EQ( LW_INVALID_INDEX, mesh_first ? answer.b : answer.a );
	EXPECT_LT(
	    distanceTo( triangleOf( pair.mesh, triangle ), pair.mesh_pose, on_mesh, pair.size, query ), 1e-9 * pair.size );
	EXPECT_LT( distanceTo( pair.solid, pair.solid_pose, on_solid, pair.size, query ), 1e-9 * pair.size );
}

/// No node or leaf of a tree was opened since the counts were set to 0.
bool wasAnsweredByAVertex( const QueryPtr& query )
{
	const lw_query_stats stats = lw_query_get_stats( query.get() );
	return stats.node_tests + stats.leaf_tests == 0;
}

TEST( ContactVertex, AnswersDifferFromDistances )
{
	SeededRng rng( 1 );
	const QueryPtr query = makeQuery();
	int contacts = 0, at_once = 0;
	for ( int i = 0; i < unlessSanitized( 4000, 400 ); ++i )
	{
		const double size = rng.decade( -3, 3 );
		Pair pair{ randomSoup( rng, static_cast<int>( rng.integer( 2, 60 ) ), 0.4 * size ), randomSolid( rng, size ),
		    randomPose( rng, 0.6 * size ), randomPose( rng, 0.6 * size ), size };
		const bool mesh_first = rng.integer( 0, 1 ) == 0;
		SCOPED_TRACE( i );
		check( pair, mesh_first, i % 3 == 0 ? rng.uniform( 0, 0.2 ) * size : 0, query );
		lw_query_reset_stats( query.get() );
		const lw_clearance contact = ask( pair, mesh_first, lw_range_threshold( 0 ), query );
		contacts += contact.kind == LW_CLEARANCE_VIOLATION;
		at_once += contact.kind == LW_CLEARANCE_VIOLATION && wasAnsweredByAVertex( query );
	}
	EXPECT_GT( contacts, unlessSanitized( 1000, 100 ) );
	EXPECT_GT( at_once, contacts / 2 );
}

TEST( ContactVertex, BesideAFaceIsContact )
{
	SeededRng rng( 2 );
	const QueryPtr query = makeQuery();
	for ( int i = 0; i < unlessSanitized( 4000, 400 ); ++i )
	{
		const double size = rng.decade( -3, 3 ), half = 0.4 * size, gap = rng.decade( -12, -3 ) * size;
		const bool inside = i % 2 == 0;
		// a tip that points down at the upper face of a box or cylinder, in a frame of its own; open, so that it has a tree
		const double tip = half + ( inside ? -gap : gap );
		const lw_transform solid_from_mesh = randomPose( rng, 2 * size );
		std::vector<double> vertices;
		for ( const lw_vec3& v : { lw_vec3{ 0.1 * size, 0.2 * size, tip }, lw_vec3{ size, 0, tip + size },
		          lw_vec3{ -size, size, tip + size }, lw_vec3{ -size, -size, tip + size } } )
		{
			const lw_transform mesh_from_solid = lw_transform_inverse( &solid_from_mesh );
			const lw_vec3 p = lw_transform_point( &mesh_from_solid, v );
			vertices.insert( vertices.end(), { p.x, p.y, p.z } );
		}
		Pair pair{ makeMesh( vertices, { 0, 1, 2, 0, 2, 3, 0, 3, 1 } ),
		    i % 4 < 2 ? makePrimitive( LW_SHAPE_BOX, size, size, 2 * half )
		              : makePrimitive( LW_SHAPE_CYLINDER, 0.5 * size, 2 * half ),
		    {}, randomPose( rng, size ), size };
		pair.mesh_pose = lw_transform_multiply( &pair.solid_pose, &solid_from_mesh );
		const lw_clearance answer = ask( pair, true, lw_range_threshold( 0 ), query );
		EXPECT_EQ( inside, answer.kind == LW_CLEARANCE_VIOLATION ) << i << ": " << gap / size;
	}
}

} // namespace
