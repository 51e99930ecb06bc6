// SPDX-License-Identifier: BSD-3-Clause
// Are the nearest points of two shapes the only ones? One body above one obstacle, in placements whose answer is known.
#include "near_world.hpp"
#include "one_joint.hpp"
#include "simple_shapes.hpp"

namespace
{

/// The direction of the one row of a body, turned by rpy, at `position` above an obstacle at the origin.
lw_direction directionOf( lw_shape* body, const std::array<double, 3>& position, const std::array<double, 3>& rpy,
    lw_shape* obstacle, double tie_width = 1e-9 )
{
	const ShapePtr own_body( body ), own_obstacle( obstacle );
	lw_transform pose;
	EXPECT_EQ( LW_OK, lw_transform_from_rpy( position.data(), rpy.data(), &pose ) );
	OneJoint world;
	const double axis[3] = { 0, 0, 1 };
	EXPECT_EQ( LW_OK, world.makeRobot( body, pose, LW_JOINT_PRISMATIC, axis, 5, nullptr ) );
	world.makeChecker( obstacle, lw_transform_identity() );
	const leeway::Query query = queryOf( world.checker );
	lw_near_def def = lw_near_def_default();
	def.distance = 10;
	def.tie_width = tie_width;
	lw_near_pair row = {};
	std::uint32_t count = 0;
	const double q = 0;
	EXPECT_EQ( LW_OK, lw_checker_near( world.checker, query.get(), &q, &def, &row, 1, &count ) );
	EXPECT_EQ( 1u, count );
	return row.direction;
}

lw_shape* box( double size = 1 )
{
	return primitive( LW_SHAPE_BOX, size, size, size );
}

lw_shape* cylinder()
{
	return primitive( LW_SHAPE_CYLINDER, 0.3, 1 );
}

/// A cube of triangles about the origin.
lw_shape* cube( double size )
{
	std::vector<double> vertices;
	for ( int i = 0; i < 8; ++i )
	{
		for ( int k = 0; k < 3; ++k )
		{
			vertices.push_back( ( ( i >> k ) % 2 == 0 ? -0.5 : 0.5 ) * size );
		}
	}
	return meshOf( vertices,
	    { 0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5 } );
}

/// Two tetrahedra whose tips are at x = -1 and 1, the second one higher by `more`.
lw_shape* twoTips( double more )
{
	std::vector<double> vertices;
	for ( const double side : { -1.0, 1.0 } )
	{
		const double top = side > 0 ? more : 0;
		vertices.insert( vertices.end(), { side, 0, top, side - 0.2, -0.2, -1, side + 0.2, -0.2, -1, side, 0.2, -1 } );
	}
	return meshOf( vertices, { 0, 1, 2, 0, 2, 3, 0, 3, 1, 1, 3, 2, 4, 5, 6, 4, 6, 7, 4, 7, 5, 5, 7, 6 } );
}

/// A row of tetrahedra, lower the nearer they are to its middle; the last tip is lower than the first by `less`.
lw_shape* rowOfTips( double less )
{
	std::vector<double> vertices;
	std::vector<std::uint32_t> indices;
	const int count = 64;
	for ( int i = 0; i < count; ++i )
	{
		const double x = 0.5 * i, top = i == 0 ? 0 : i == count - 1 ? -less : -0.2;
		const auto first = static_cast<std::uint32_t>( vertices.size() / 3 );
		vertices.insert( vertices.end(), { x, 0, top, x - 0.1, -0.1, -1, x + 0.1, -0.1, -1, x, 0.1, -1 } );
		for ( const std::uint32_t k : { 0, 1, 2, 0, 2, 3, 0, 3, 1, 1, 3, 2 } )
		{
			indices.push_back( first + k );
		}
	}
	return meshOf( vertices, indices );
}

const std::array<double, 3> straight = { 0, 0, 0 }, tilted = { 0.4, 0.3, 0.2 };

TEST( NearTies, ParallelFacesAreTied )
{
	EXPECT_EQ( LW_DIRECTION_TIED, directionOf( box(), { 0.3, 0.2, 2 }, straight, box() ) );
	EXPECT_EQ( LW_DIRECTION_TIED, directionOf( cube( 1 ), { 0.3, 0.2, 2 }, straight, cube( 1 ) ) );
	EXPECT_EQ( LW_DIRECTION_TIED, directionOf( cube( 1 ), { 0.3, 0.2, 2 }, { 0, 0, 0.5 }, box() ) );
	EXPECT_EQ( LW_DIRECTION_TIED, directionOf( cylinder(), { 0.1, 0.1, 2 }, straight, box() ) );
	EXPECT_EQ( LW_DIRECTION_TIED, directionOf( cylinder(), { 0.1, 0.1, 2 }, straight, cube( 1 ) ) );
}

TEST( NearTies, EdgesAlongAFaceAreTied )
{
	EXPECT_EQ( LW_DIRECTION_TIED, directionOf( box(), { 0.1, 0.2, 2 }, { 0.7, 0, 0.3 }, box() ) );
	EXPECT_EQ( LW_DIRECTION_TIED, directionOf( cube( 1 ), { 0.1, 0.2, 2 }, { 0.7, 0, 0.3 }, cube( 1 ) ) );
	EXPECT_EQ( LW_DIRECTION_TIED, directionOf( cylinder(), { 0, 0, 2 }, { M_PI / 2, 0, 0.3 }, cube( 1 ) ) );
	EXPECT_EQ( LW_DIRECTION_TIED,
	    directionOf( primitive( LW_SHAPE_CAPSULE, 0.2, 0.5 ), { 0, 0, 2 }, { M_PI / 2, 0, 0.3 }, cube( 1 ) ) );
}

TEST( NearTies, CornersAndCrossingEdgesAreNotTied )
{
	EXPECT_EQ( LW_DIRECTION_UNIQUE, directionOf( box(), { 0.1, 0.2, 2 }, tilted, box() ) );
	EXPECT_EQ( LW_DIRECTION_UNIQUE, directionOf( cube( 1 ), { 0.1, 0.2, 2 }, tilted, cube( 1 ) ) );
	EXPECT_EQ( LW_DIRECTION_UNIQUE, directionOf( cube( 1 ), { 0.1, 0.2, 2 }, tilted, box() ) );
	EXPECT_EQ( LW_DIRECTION_UNIQUE, directionOf( primitive( LW_SHAPE_SPHERE, 0.3 ), { 0.1, 0.2, 2 }, straight, cube( 1 ) ) );
	EXPECT_EQ( LW_DIRECTION_UNIQUE, directionOf( cylinder(), { 0, 0, 2 }, { 0.6, 0.1, 0 }, cube( 1 ) ) );
	// an edge of the body across an edge of the obstacle
	EXPECT_EQ( LW_DIRECTION_UNIQUE, directionOf( cube( 1 ), { 0, 1.2, 1.2 }, { -M_PI / 4, 0.5, M_PI / 2 }, cube( 1 ) ) );
	EXPECT_EQ( LW_DIRECTION_UNIQUE, directionOf( cube( 0.1 ), { 1.8, 0.01, 0.02 }, tilted, cube( 1 ) ) );
}

TEST( NearTies, TwoTipsAtOneHeightAreTied )
{
	const std::array<double, 3> above = { 0, 0, 6 };
	EXPECT_EQ( LW_DIRECTION_TIED, directionOf( primitive( LW_SHAPE_BOX, 4, 4, 2 ), above, straight, twoTips( 0 ) ) );
	EXPECT_EQ( LW_DIRECTION_UNIQUE, directionOf( primitive( LW_SHAPE_BOX, 4, 4, 2 ), above, straight, twoTips( 1e-3 ) ) );
	EXPECT_EQ( LW_DIRECTION_TIED, directionOf( cube( 4 ), above, straight, twoTips( 1e-3 ), 2e-3 ) );
	EXPECT_EQ( LW_DIRECTION_UNIQUE, directionOf( cube( 4 ), above, straight, twoTips( 1e-3 ) ) );
}

TEST( NearTies, ATipThatIsFartherWithinTheWidthIsFound )
{
	const std::array<double, 3> above = { 16, 0, 3 };
	for ( const double width : { 1e-2, 1e-3 } )
	{
		EXPECT_EQ(
		    LW_DIRECTION_TIED, directionOf( cube( 40 ), { 16, 0, 20.5 }, straight, rowOfTips( 0.9 * width ), width ) );
		EXPECT_EQ(
		    LW_DIRECTION_UNIQUE, directionOf( cube( 40 ), { 16, 0, 20.5 }, straight, rowOfTips( 1.1 * width ), width ) );
	}
	const auto beam = [] { return primitive( LW_SHAPE_BOX, 40, 1, 1 ); };
	EXPECT_EQ( LW_DIRECTION_TIED, directionOf( beam(), above, straight, rowOfTips( 9e-4 ), 1e-3 ) );
	EXPECT_EQ( LW_DIRECTION_UNIQUE, directionOf( beam(), above, straight, rowOfTips( 1.1e-3 ), 1e-3 ) );
}

TEST( NearTies, AreNotSaidUnlessAskedFor )
{
	EXPECT_EQ( LW_DIRECTION_UNIQUE, directionOf( box(), { 0.3, 0.2, 2 }, straight, box(), 0 ) );
}

} // namespace
