// SPDX-License-Identifier: BSD-3-Clause
// Every robot, scene and request of the shared data is read, whole, and makes a problem.
#include "leeway/io/model.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

using namespace leeway::io;
namespace fs = std::filesystem;

namespace
{

const fs::path data = LEEWAY_DATA_DIR;

class DataTest : public testing::Test
{
protected:
	void SetUp() override
	{
		if ( !fs::is_directory( data ) )
		{
			ASSERT_EQ( std::getenv( "CI" ), nullptr ) << "the shared data is missing: " << data;
			GTEST_SKIP() << "no shared data at " << data;
		}
	}
};

std::string file( const std::string& name )
{
	return ( data / name ).string();
}

std::size_t triangles( const std::vector<PlacedShape>& shapes )
{
	std::size_t count = 0;
	for ( const PlacedShape& shape : shapes )
	{
		count += lw_shape_get_info( shape.shape.get() ).triangle_count;
	}
	return count;
}

std::size_t triangles( const RobotModel& model )
{
	std::size_t count = 0;
	for ( const LinkModel& link : model.links )
	{
		count += triangles( link.collision );
	}
	return count;
}

std::size_t triangles( const SceneModel& scene )
{
	std::size_t count = 0;
	for ( const SceneObject& object : scene.objects )
	{
		count += triangles( object.shapes );
	}
	return count;
}

/// The problem of a request in a scene; start and goal are complete states of the group.
void expectProblem( const RobotModel& robot, const SceneModel& scene, const Request& request )
{
	ProblemOptions options;
	options.group = request.group;
	options.scene = &scene;
	options.request = &request;
	Problem problem = buildProblem( robot, options );
	EXPECT_EQ( lw_scene_object_count( problem.scene.get() ), scene.objects.size() );
	EXPECT_EQ( startState( problem ).size(), problem.variables.size() );
	EXPECT_EQ( goalState( problem, request ).size(), problem.variables.size() );
	// The goals of MotionBenchMaker reach pi where the URDF says 3.14159: out of limits by rounding, and by no more
	std::vector<double> goal = goalState( problem, request );
	for ( std::size_t i = 0; i < goal.size(); ++i )
	{
		lw_variable_info info = lw_robot_variable( problem.robot.get(), problem.variables[i] );
		goal[i] = std::clamp( goal[i], std::min( goal[i] + 3e-6, info.lower ), std::max( goal[i] - 3e-6, info.upper ) );
	}
	EXPECT_TRUE( limitViolations( problem, goal ).empty() ) << request.file;
}

void expectMotionBenchMaker( const std::string& robot_name, std::size_t links_with_geometry, std::size_t robot_triangles )
{
	std::string folder = "mbm/" + robot_name + "/";
	RobotModel robot = loadRobot( file( folder + robot_name + ".urdf" ), file( folder + robot_name + ".srdf" ) );
	EXPECT_EQ( robot.links.size() - robot.report.links_without_geometry.size(),
	    links_with_geometry + ( robot.planning_frame != robot.root_link ? 1 : 0 ) )
	    << "the virtual joint's frame has no geometry";
	EXPECT_EQ( triangles( robot ), robot_triangles );
	std::size_t count = 0;
	for ( const fs::directory_entry& entry : fs::recursive_directory_iterator( data / folder / "problems" ) )
	{
		std::string name = entry.path().filename().string();
		if ( name.rfind( "scene", 0 ) != 0 )
		{
			continue;
		}
		SCOPED_TRACE( entry.path() );
		SceneModel scene = loadScene( entry.path().string() );
		EXPECT_TRUE( scene.report.notices.empty() );
		EXPECT_GE( scene.objects.size(), 2u );
		Request request = loadRequest( ( entry.path().parent_path() / ( "request" + name.substr( 5 ) ) ).string() );
		EXPECT_TRUE( request.notices.empty() );
		expectProblem( robot, scene, request );
		++count;
	}
	EXPECT_EQ( count, 140u );
}

} // namespace

TEST_F( DataTest, PandaScenesAndRequests )
{
	expectMotionBenchMaker( "panda", 11, 3472 );
}

TEST_F( DataTest, FetchScenesAndRequests )
{
	expectMotionBenchMaker( "fetch", 15, 1802 );
}

TEST_F( DataTest, ArmarInItsThreeDetails )
{
	struct Case
	{
		const char *urdf, *srdf;
		std::size_t links, triangles, pairs;
	};
	for ( const Case& c : { Case{ "armar3/armar3.urdf", "armar3/armar3.srdf", 54, 32258, 71 },
	          Case{ "armar3/armar3_coarse.urdf", "armar3/armar3_coarse.srdf", 47, 1016, 75 },
	          Case{ "armar3/armar3_convex.urdf", "armar3/armar3.srdf", 47, 1676, 71 } } )
	{
		SCOPED_TRACE( c.urdf );
		RobotModel robot = loadRobot( file( c.urdf ), file( c.srdf ) );
		EXPECT_EQ( robot.links.size(), 95u );
		EXPECT_EQ( robot.joints.size(), 94u );
		EXPECT_EQ( robot.links.size() - robot.report.links_without_geometry.size(), c.links );
		EXPECT_EQ( triangles( robot ), c.triangles );
		EXPECT_EQ( robot.disabled.size(), c.pairs );
		EXPECT_EQ( robot.groups.size(), 13u );
		EXPECT_EQ( robot.findGroup( "platform_torso_both_arms" )->joints.size(), 20u );
		EXPECT_EQ( lw_robot_variable_count( buildProblem( robot, {} ).robot.get() ), 55u );
	}
}

TEST_F( DataTest, TwelveReachesInTheClutteredKitchen )
{
	RobotModel robot = loadRobot( file( "armar3/armar3.urdf" ), file( "armar3/armar3.srdf" ) );
	SceneModel scene = loadScene( file( "kit_kitchen/scene_cluttered.yaml" ) );
	EXPECT_EQ( scene.objects.size(), 39u );
	EXPECT_EQ( triangles( scene ), 69474u );
	EXPECT_TRUE( scene.report.notices.empty() );
	std::size_t built = 0;
	for ( const LoadedShape& shape : scene.report.shapes )
	{
		built += shape.shared ? 0 : 1;
	}
	EXPECT_EQ( built, 21u ) << "one shape per mesh file";
	for ( int i = 1; i <= 12; ++i )
	{
		std::string name = std::string( "armar3/reach/" ) + ( i < 10 ? "0" : "" ) + std::to_string( i ) + ".yaml";
		SCOPED_TRACE( name );
		Request request = loadRequest( file( name ) );
		EXPECT_TRUE( request.notices.empty() );
		expectProblem( robot, scene, request );
	}
}

TEST_F( DataTest, OtherKitchens )
{
	SceneModel kit = loadScene( file( "kit_kitchen/scene.yaml" ) );
	EXPECT_EQ( kit.objects.size(), 13u );
	EXPECT_EQ( triangles( kit ), 12943u );
	SceneModel yaml = loadScene( file( "mbm/kitchen/kitchen.yaml" ) );
	EXPECT_EQ( yaml.objects.size(), 7u );
	EXPECT_EQ( triangles( yaml ), 420u );
	SceneModel urdf = loadScene( file( "mbm/kitchen/kitchen.urdf" ) );
	EXPECT_EQ( urdf.objects.size(), 5u );
	EXPECT_EQ( triangles( urdf ), 420u );
	// The YAML was made from the URDF: the same links at the same places
	for ( const SceneObject& link : urdf.objects )
	{
		for ( const SceneObject& object : yaml.objects )
		{
			for ( int i = 0; object.name == link.name && i < 3; ++i )
			{
				EXPECT_NEAR( object.shapes.at( 0 ).pose.t[i], link.shapes.at( 0 ).pose.t[i], 1e-9 ) << link.name;
			}
		}
	}
}
