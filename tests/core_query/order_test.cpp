// SPDX-License-Identifier: BSD-3-Clause
// The order in which a search compares its pairs: counters of queries, not clocks, show a detour.
//
// Parts that lie within each other, ball in shell, overlap with all their spheres and boxes: lower bounds show neither the
// nearest part nor its place.
#include "all_pairs.hpp"
#include "checker_handles.hpp"
#include "random_robot.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace
{

/// The surface of a ball by latitude and longitude, 4 n n triangles; one of its vertices is at a height of its own.
lw_shape* ball( int n, double radius, int raised = -1, double height = 0 )
{
	std::vector<double> vertices;
	std::vector<uint32_t> indices;
	const double pi = 3.14159265358979323846;
	for ( int i = 0; i <= n; ++i )
	{
		for ( int j = 0; j < 2 * n; ++j )
		{
			const double theta = pi * i / n, phi = pi * j / n, r = i * 2 * n + j == raised ? radius + height : radius;
			vertices.insert( vertices.end(), { r * std::sin( theta ) * std::cos( phi ),
			                                     r * std::sin( theta ) * std::sin( phi ), r * std::cos( theta ) } );
		}
	}
	const auto at = [n]( int i, int j ) { return static_cast<uint32_t>( i * 2 * n + j % ( 2 * n ) ); };
	for ( int i = 0; i < n; ++i )
	{
		for ( int j = 0; j < 2 * n; ++j )
		{
			indices.insert( indices.end(),
			    { at( i, j ), at( i + 1, j ), at( i + 1, j + 1 ), at( i, j ), at( i + 1, j + 1 ), at( i, j + 1 ) } );
		}
	}
	lw_mesh_def def = lw_mesh_def_default();
	def.vertices = vertices.data();
	def.vertex_count = static_cast<uint32_t>( vertices.size() / 3 );
	def.indices = indices.data();
	def.triangle_count = static_cast<uint32_t>( indices.size() / 3 );
	def.weld_tolerance = 1e-12; // the poles
	lw_shape* shape = nullptr;
	EXPECT_EQ( LW_OK, lw_shape_create_mesh( &def, nullptr, nullptr, &shape ) );
	return shape;
}

lw_transform shifted( lw_vec3 by )
{
	lw_transform m = lw_transform_identity();
	m.t[0] = by.x;
	m.t[1] = by.y;
	m.t[2] = by.z;
	return m;
}

/// Comparisons of leaves that an exact distance takes.
double leavesOf( const lw_shape* a, const lw_shape* b, const lw_transform& at, double& distance )
{
	const lw_query_def def = lw_query_def_default();
	lw_query* created = nullptr;
	EXPECT_EQ( LW_OK, lw_query_create( &def, nullptr, nullptr, nullptr, &created ) );
	const QueryPtr query( created );
	const lw_transform identity = lw_transform_identity();
	lw_clearance clearance;
	EXPECT_EQ( LW_OK, lw_shape_distance( a, &identity, b, &at, nullptr, query.get(), &clearance ) );
	distance = clearance.upper;
	return static_cast<double>( lw_query_get_stats( query.get() ).leaf_tests );
}

lw_clearance selfClearance( const lw_checker* checker, lw_query* query, const State& q )
{
	lw_state_result out;
	EXPECT_EQ( LW_OK, lw_checker_state( checker, query, q.data(), LW_CHECK_SELF, nullptr, false, &out ) );
	return out.self;
}

} // namespace

/// A ball within a shell, 10 mm away everywhere, and one outside of it, 0.1 mm away. By their spheres the pair within comes
/// first; searched to its end first, it takes thousands of comparisons.
TEST( Order, FirstPairIsSearchedToItsEndBeforeANearerOne )
{
	SeededRng rng;
	RobotModel model;
	const std::uint32_t base = model.link( "base" );
	model.joint( "inner", LW_JOINT_REVOLUTE, base );
	model.joint( "outer", LW_JOINT_REVOLUTE, base );
	const lw_transform beside = shifted( { 0.1201, 0, 0 } );
	model.body( 0, ball( 40, 0.1 ), lw_transform_identity() );
	model.body( 1, ball( 37, 0.09 ), lw_transform_identity() );
	model.body( 2, ball( 10, 0.02 ), beside );
	model.allowed.push_back( { 1, 2 } );
	double far, near;
	const double leaves_within = leavesOf( model.shapes[0].get(), model.shapes[1].get(), lw_transform_identity(), far );
	const double leaves_beside = leavesOf( model.shapes[0].get(), model.shapes[2].get(), beside, near );
	EXPECT_GE( far, 0.009 );
	EXPECT_LE( near, 0.002 );
	const RobotPtr robot = model.create();
	lw_checker_def def = lw_checker_def_default();
	def.robot = robot.get();
	lw_checker* created = nullptr;
	ASSERT_EQ( LW_OK, lw_checker_create( &def, nullptr, nullptr, &created ) );
	const CheckerPtr checker( created );
	const QueryPtr query = makeQuery( checker.get(), false );
	AllPairs all_pairs( checker.get() );
	for ( int i = 0; i < 50; ++i )
	{
		const State q = { rng.uniform( -3, 3 ), rng.uniform( -0.01, 0.01 ) };
		EXPECT_NEAR(
		    all_pairs.state( q ).self.upper, selfClearance( checker.get(), query.get(), q ).upper, ALL_PAIRS_ROUNDING );
	}
	const double leaves = static_cast<double>( lw_query_get_stats( query.get() ).leaf_tests ) / 50;
	std::printf( "comparisons of leaves: %.0f within, %.0f beside, %.0f per state\n", leaves_within, leaves_beside, leaves );
	EXPECT_LE( leaves, leaves_beside + 0.25 * leaves_within );
}

/// A ball within a shell, 10 mm away but for one spike: all work before the spike is found is in vain.
TEST( Order, SearchStaysWhereItBegan )
{
	SeededRng rng;
	const ShapePtr shell( ball( 40, 0.1 ) );
	double leaves = 0, distance;
	for ( int i = 0; i < 50; ++i )
	{
		const ShapePtr inner( ball( 37, 0.09, rng.integer( 2 * 74, 35 * 74 ), 0.0095 ) );
		leaves += leavesOf( shell.get(), inner.get(), lw_transform_identity(), distance ) / 50;
		EXPECT_LE( distance, 0.001 );
	}
	std::printf( "comparisons of leaves: %.0f\n", leaves );
	EXPECT_LE( leaves, 4400 ) << "depth first alone takes 5019";
}
