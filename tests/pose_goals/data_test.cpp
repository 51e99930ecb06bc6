// SPDX-License-Identifier: BSD-3-Clause
// ARMAR-III's arms in the cluttered kitchen, Panda and Fetch: poses of random free states are reached by free states.
#include "seeded_rng.hpp"
#include "urdf_oracle.hpp"

#include "leeway/ik/goal_states.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

using namespace leeway;

namespace
{

const std::filesystem::path data = LEEWAY_DATA_DIR;

struct Case
{
	const char* robot;
	const char* scene;   ///< empty: none
	const char* request; ///< of the start state; empty: none
	const char* group;
	const char* link;
};

class PoseData : public testing::TestWithParam<Case>
{
};

std::string contents( const std::string& file )
{
	std::ostringstream text;
	text << std::ifstream( file ).rdbuf();
	return text.str();
}

void askFor( io::Request& request, const std::string& link, const Matrix& at )
{
	lw_transform transform = lw_transform_identity();
	for ( std::size_t i = 0; i < 9; ++i )
	{
		transform.r[i / 3][i % 3] = at[i / 3][i % 3];
	}
	io::PositionGoal position;
	position.link = link;
	position.regions.emplace_back();
	position.regions[0].size = { 1e-4, 0, 0 };
	io::OrientationGoal orientation;
	orientation.link = link;
	orientation.tolerance = { 1e-3, 1e-3, 1e-3 };
	lw_transform_to_quaternion( &transform, orientation.quaternion.data() );
	for ( std::size_t i = 0; i < 3; ++i )
	{
		position.regions[0].pose.t[i] = at[i][3];
	}
	request.goal.clear();
	request.goal_positions = { position };
	request.goal_orientations = { orientation };
}

} // namespace

TEST_P( PoseData, PosesOfRandomFreeStatesAreReached )
{
	if ( !std::filesystem::is_directory( data ) )
	{
		ASSERT_EQ( std::getenv( "CI" ), nullptr ) << "the shared data is missing: " << data;
		GTEST_SKIP() << "no shared data at " << data;
	}
	const Case& c = GetParam();
	const std::string urdf = ( data / c.robot ).string() + ".urdf";
	const io::RobotModel robot = io::loadRobot( urdf, ( data / c.robot ).string() + ".srdf" );
	const UrdfOracle oracle( contents( urdf ) );
	io::ProblemOptions options;
	io::SceneModel scene;
	io::Request request;
	options.group = c.group;
	if ( *c.scene != '\0' )
	{
		scene = io::loadScene( ( data / c.scene ).string() );
		options.scene = &scene;
	}
	if ( *c.request != '\0' )
	{
		request = io::loadRequest( ( data / c.request ).string() );
		options.request = &request;
	}
	const io::Problem problem = io::buildProblem( robot, options );
	const lw_robot* const core = problem.robot.get();
	std::vector<lw_transform> links( lw_robot_link_count( core ) );
	const Query query = makeQuery( problem.checker.get() );
	SeededRng rng;
	int reached = 0, asked = 0;
	while ( asked < 12 )
	{
		std::vector<double> q, full( problem.reference.size() );
		for ( std::uint32_t variable : problem.variables )
		{
			const lw_variable_info info = lw_robot_variable( core, variable );
			q.push_back( rng.uniform( info.lower, info.upper ) );
		}
		bool free = false;
		require(
		    lw_checker_is_free( problem.checker.get(), query.get(), q.data(), LW_CHECK_BOTH, 0, &free, nullptr ), "state" );
		if ( !free )
		{
			continue;
		}
		++asked;
		const auto values = [&]( const std::vector<double>& state )
		{
			lw_checker_full_state( problem.checker.get(), state.data(), full.data() );
			std::map<std::string, double> all;
			for ( std::uint32_t i = 0; i < full.size(); ++i )
			{
				all[io::variableName( core, i )] = full[i];
			}
			return all;
		};
		const Matrix at = oracle.pose( c.link, values( q ) );
		askFor( request, c.link, at );
		const ik::GoalStates goal = ik::findGoalStates( robot, problem, request );
		reached += goal.states.empty() ? 0 : 1;
		for ( const std::vector<double>& state : goal.states )
		{
			const Matrix difference = product( inverseOf( at ), oracle.pose( c.link, values( state ) ) );
			EXPECT_LE( std::hypot( difference[0][3], difference[1][3], difference[2][3] ), 1e-4 + 1e-8 );
			for ( double angle : eulerXyz( difference ) )
			{
				EXPECT_LE( std::fabs( angle ), 1e-3 + 1e-8 );
			}
			EXPECT_TRUE( io::limitViolations( problem, state ).empty() );
			require(
			    lw_checker_is_free( problem.checker.get(), query.get(), state.data(), LW_CHECK_BOTH, 0, &free, nullptr ),
			    "state" );
			EXPECT_TRUE( free );
		}
	}
	EXPECT_EQ( reached, asked );
}

INSTANTIATE_TEST_SUITE_P( Robots, PoseData,
    testing::Values(
        Case{ "armar3/armar3", "kit_kitchen/scene_cluttered.yaml", "armar3/reach/06.yaml", "right_arm", "Hand_Palm_2_R" },
        Case{
            "armar3/armar3", "kit_kitchen/scene_cluttered.yaml", "armar3/reach/01.yaml", "torso_left_arm", "Hand_Palm_2_L" },
        Case{ "mbm/panda/panda", "", "", "panda_arm", "panda_hand" },
        Case{ "mbm/fetch/fetch", "", "", "arm_with_torso", "gripper_link" } ) );
