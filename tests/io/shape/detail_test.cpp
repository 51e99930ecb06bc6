// SPDX-License-Identifier: BSD-3-Clause
// Levels of detail of loaded geometry: every kind that has one, deferred or not, from the cache, and geometry without one.
#include "files.hpp"

#include <cmath>

using namespace leeway;
using namespace leeway::io;

namespace
{

constexpr double detail = 0.004;

class IoDetail : public FileTest
{
protected:
	IoDetail()
	{
		std::string obj;
		constexpr int around = 40, tube = 20;
		for ( int i = 0; i < around * tube; ++i )
		{
			double a = 2 * M_PI * ( i / tube ) / around, b = 2 * M_PI * ( i % tube ) / tube, d = 0.2 + 0.05 * std::cos( b );
			obj += "v " + std::to_string( d * std::cos( a ) ) + " " + std::to_string( d * std::sin( a ) ) + " " +
			       std::to_string( 0.05 * std::sin( b ) ) + "\n";
		}
		const auto id = []( int i, int k ) { return " " + std::to_string( ( i % around ) * tube + k % tube + 1 ); };
		for ( int i = 0; i < around * tube; ++i )
		{
			int k = i % tube, j = i / tube;
			obj += "f" + id( j, k ) + id( j + 1, k ) + id( j + 1, k + 1 ) + "\nf" + id( j, k ) + id( j + 1, k + 1 ) +
			       id( j, k + 1 ) + "\n";
		}
		write( "ring.obj", obj );
		write( "r.urdf",
		    "<robot name=\"r\"><link name=\"base\"><collision><geometry><mesh filename=\"ring.obj\"/></geometry></collision></link>"
		    "<link name=\"tip\"><collision><geometry><box size=\"0.1 0.1 0.1\"/></geometry></collision></link>"
		    "<joint name=\"j\" type=\"revolute\"><parent link=\"base\"/><child link=\"tip\"/><origin xyz=\"0 0 1\"/>"
		    "<limit lower=\"-1\" upper=\"1\" effort=\"1\" velocity=\"1\"/></joint></robot>" );
		std::string cloud =
		    "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 2000\nHEIGHT 1\nPOINTS 2000\nDATA ascii\n";
		for ( int i = 0; i < 2000; ++i )
		{
			cloud += std::to_string( 0.001 * ( i % 50 ) ) + " " + std::to_string( 0.001 * ( i / 50 ) ) + " 0\n";
		}
		write( "c.pcd", cloud );
		options.detail = detail;
	}
	Shape ring() { return loadRobot( path( "r.urdf" ), "", options ).links[0].collision[0].shape; }

	LoadOptions options;
};

} // namespace

TEST_F( IoDetail, MeshesAreCoarserWhetherTheyAreDeferredOrNot )
{
	Shape later = ring();
	ASSERT_TRUE( lw_shape_peek_info( later.get() ).deferred );
	lw_diag diag{};
	ASSERT_EQ( lw_shape_complete( later.get(), &diag ), LW_OK ) << diag.message;
	options.defer = false;
	Shape now = ring();
	options.detail = 0;
	Shape whole = ring();
	const lw_shape_info info = lw_shape_get_info( later.get() ), same = lw_shape_get_info( now.get() ),
	                    all = lw_shape_get_info( whole.get() );
	EXPECT_EQ( info.triangle_count, same.triangle_count );
	EXPECT_EQ( info.original_count, all.triangle_count );
	EXPECT_LT( info.triangle_count, all.triangle_count / 2 );
	EXPECT_GT( info.excess, 0 );
	EXPECT_LE( info.excess, detail );
	EXPECT_EQ( all.excess, 0 );
}

// A tree of another tolerance under the same name would be another shape than was asked for.
TEST_F( IoDetail, TheCacheKeepsEachToleranceForItself )
{
	options.cache = path( "cache" );
	const auto cached = [&]
	{
		const RobotModel model = loadRobot( path( "r.urdf" ), "", options );
		EXPECT_EQ( lw_shape_complete( model.links[0].collision[0].shape.get(), nullptr ), LW_OK );
		return model.report.shapes[0].cached;
	};
	EXPECT_FALSE( cached() );
	EXPECT_TRUE( cached() );
	const lw_shape_info warm = lw_shape_get_info( ring().get() );
	EXPECT_GT( warm.excess, 0 );
	EXPECT_EQ( warm.original_count, 1600u );
	options.detail = 0.002;
	EXPECT_FALSE( cached() );
	options.detail = 0;
	EXPECT_FALSE( cached() );
	EXPECT_EQ( lw_shape_get_info( ring().get() ).excess, 0 );
	options.detail = detail;
	EXPECT_TRUE( cached() );
}

TEST_F( IoDetail, ScenesHaveItToo )
{
	write( "s.yaml",
	    "name: s\nworld:\n  collision_objects:\n    - id: cloud\n      header: {frame_id: base}\n      leeway_shapes:\n"
	    "        - {type: point_cloud, resource: c.pcd, radius: 0.001}\n" );
	const SceneModel scene = loadScene( path( "s.yaml" ), options );
	ASSERT_EQ( scene.objects.size(), 1u );
	const lw_shape_info info = lw_shape_get_info( scene.objects[0].shapes[0].shape.get() );
	EXPECT_EQ( info.original_count, 2000u );
	EXPECT_LT( info.vertex_count, 400u );
	EXPECT_GT( info.dimensions[0], 0.001 );
	EXPECT_LE( info.excess, detail );
}

TEST_F( IoDetail, ImpossibleLevelsAreNamed )
{
	for ( double wrong : { -0.001, double( NAN ), double( INFINITY ) } )
	{
		options.detail = wrong;
		expectError( [&] { loadRobot( path( "r.urdf" ), "", options ); }, { "detail", "is no tolerance" } );
	}
	options.detail = detail;
	const RobotModel model = loadRobot( path( "r.urdf" ), "", options );
	ProblemOptions problem;
	problem.padding.link_scale["base"] = 1.1;
	expectError(
	    [&] { buildProblem( model, problem ); }, { "base", "a coarser shape cannot be scaled", "level of detail" } );
	problem.padding.link_scale = { { "tip", 1.1 } };
	EXPECT_NO_THROW( buildProblem( model, problem ) );
}
