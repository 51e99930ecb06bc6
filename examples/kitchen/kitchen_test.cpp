// SPDX-License-Identifier: BSD-3-Clause
// The demo as its users meet it: written to files, read back by leeway's readers, every request standing where it should.
#include "writer.hpp"

#include "leeway/io/model.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>

namespace
{

namespace fs = std::filesystem;
namespace io = leeway::io;

/// Writes the demo to <temporary>/<parent>/kitchen once per program run.
fs::path written( const std::string& parent )
{
	static std::map<std::string, fs::path> folders;
	fs::path& folder = folders[parent];
	if ( folder.empty() )
	{
		std::string name = ( fs::temp_directory_path() / "leeway_kitchen_XXXXXX" ).string();
		if ( !mkdtemp( name.data() ) )
			throw std::runtime_error( "no temporary folder" );
		folder = fs::path( name ) / "kitchen";
		kitchen::writeDemo( kitchen::makeDemo(), folder.string() );
	}
	return folder;
}

/// Removes the files of written() when the program ends.
class Cleaner : public testing::Environment
{
	void TearDown() override
	{
		for ( const char* parent : { "first", "second" } )
			fs::remove_all( written( parent ).parent_path() );
	}
};
const auto* const cleaner = testing::AddGlobalTestEnvironment( new Cleaner );

std::string content( const fs::path& file )
{
	std::ifstream in( file, std::ios::binary );
	return { std::istreambuf_iterator<char>( in ), {} };
}

/// The demo read by leeway.
struct Loaded
{
	io::RobotModel robot =
	    io::loadRobot( ( written( "first" ) / "robot.urdf" ).string(), ( written( "first" ) / "robot.srdf" ).string() );
	io::SceneModel scene = io::loadScene( ( written( "first" ) / "scene.yaml" ).string() );
};

const Loaded& loaded()
{
	static const Loaded demo;
	return demo;
}

size_t trianglesOf( const std::vector<io::PlacedShape>& shapes )
{
	size_t count = 0;
	for ( const io::PlacedShape& shape : shapes )
		count += lw_shape_get_info( shape.shape.get() ).triangle_count;
	return count;
}

TEST( Kitchen, TwoRunsWriteTheSameBytes )
{
	size_t files = 0;
	for ( const fs::directory_entry& entry : fs::recursive_directory_iterator( written( "first" ) ) )
		if ( entry.is_regular_file() )
		{
			const fs::path name = fs::relative( entry.path(), written( "first" ) );
			EXPECT_EQ( content( entry.path() ), content( written( "second" ) / name ) ) << name;
			++files;
		}
	EXPECT_GT( files, 150u );
}

TEST( Kitchen, RobotHasItsJointsAndTriangles )
{
	const io::Problem problem = io::buildProblem( loaded().robot, {} );
	EXPECT_EQ( lw_robot_variable_count( problem.robot.get() ), 23u );
	size_t triangles = 0;
	for ( const io::LinkModel& link : loaded().robot.links )
		triangles += trianglesOf( link.collision );
	EXPECT_GT( triangles, 14000u );
	EXPECT_LT( triangles, 18000u );
}

TEST( Kitchen, RobotAndSceneTogetherAreAsLargeAsPromised )
{
	size_t triangles = kitchen::makeDemo().robot.triangles();
	for ( const io::SceneObject& object : loaded().scene.objects )
		triangles += trianglesOf( object.shapes );
	EXPECT_GT( triangles, 95000u );
}

TEST( Kitchen, ReadersFindNothingToRemark )
{
	for ( const io::LoadReport* report : { &loaded().robot.report, &loaded().scene.report } )
		for ( const io::Notice& notice : report->notices )
			ADD_FAILURE() << notice.file << ": " << notice.element << ": " << notice.text;
}

TEST( Kitchen, InstancesShareOneMesh )
{
	size_t shared = 0, meshes = 0;
	for ( const io::LoadedShape& shape : loaded().scene.report.shapes )
		if ( !shape.file.empty() )
		{
			++meshes;
			shared += shape.shared;
		}
	EXPECT_GT( shared, meshes / 2 );
}

/// Clearance of a state of the request's group, in metres.
double clearance( const io::Problem& problem, const std::vector<double>& state )
{
	const leeway::Query query = leeway::makeQuery( problem.checker.get() );
	const lw_range range = lw_range_exact();
	lw_state_result result;
	if ( lw_checker_state( problem.checker.get(), query.get(), state.data(), LW_CHECK_BOTH, &range, false, &result ) !=
	     LW_OK )
		return 0;
	return std::min( result.environment.lower, result.self.lower );
}

TEST( Kitchen, EveryRequestStartsAndEndsInTheClearAndWithinLimits )
{
	size_t requests = 0;
	for ( const fs::directory_entry& entry : fs::directory_iterator( written( "first" ) / "reach" ) )
	{
		SCOPED_TRACE( entry.path().filename().string() );
		const io::Request request = io::loadRequest( entry.path().string() );
		io::ProblemOptions options;
		options.group = request.group;
		options.scene = &loaded().scene;
		options.request = &request;
		const io::Problem problem = io::buildProblem( loaded().robot, options );
		for ( const std::vector<double>& state : { io::startState( problem ), io::goalState( problem, request ) } )
		{
			EXPECT_GE( clearance( problem, state ), 0.005 );
			EXPECT_TRUE( io::limitViolations( problem, state ).empty() );
		}
		++requests;
	}
	EXPECT_EQ( requests, kitchen::reachTasks().size() );
	EXPECT_GE( requests, 8u );
}

TEST( Kitchen, HandsEndWhereTheTaskSays )
{
	for ( const kitchen::Reach& reach : kitchen::makeReaches() )
	{
		SCOPED_TRACE( reach.name );
		const io::Request request = io::loadRequest( ( written( "first" ) / "reach" / ( reach.name + ".yaml" ) ).string() );
		io::ProblemOptions options;
		options.group = request.group;
		options.request = &request;
		const io::Problem problem = io::buildProblem( loaded().robot, options );
		const lw_robot* robot = problem.robot.get();
		std::vector<double> full( lw_robot_variable_count( robot ) );
		lw_checker_full_state( problem.checker.get(), io::goalState( problem, request ).data(), full.data() );
		std::vector<lw_transform> poses( lw_robot_link_count( robot ) );
		ASSERT_EQ( lw_robot_fk( robot, full.data(), poses.data() ), LW_OK );
		for ( const kitchen::HandTarget& hand : reach.hands )
		{
			const lw_transform& tcp = poses[lw_robot_find_link( robot, ( hand.side + "_tcp" ).c_str() )];
			EXPECT_LT( std::hypot( tcp.t[0] - hand.tcp.x, tcp.t[1] - hand.tcp.y, tcp.t[2] - hand.tcp.z ), 0.02 );
		}
	}
}

} // namespace
