// SPDX-License-Identifier: BSD-3-Clause
// Every robot of the package example-robot-data in LEEWAY_ZOO_DIR: the last link of its longest chain goes to poses of random states.
#include "seeded_rng.hpp"
#include "urdf_oracle.hpp"

#include "leeway/ik/goal_states.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

using namespace leeway;
namespace fs = std::filesystem;

namespace
{

constexpr double metres = 1e-4, radians = 1e-3;
constexpr double far_limits = 1000; // a description's way of saying none

class ZooRobot
{
public:
	ZooRobot( const std::string& file, const std::string& packages ) : m_oracle( contents( file ) )
	{
		io::LoadOptions options;
		options.package_paths = { packages };
		m_model = io::loadRobot( file, "", options );
		m_problem = io::buildProblem( m_model, {} );
		m_link = lastLink();
	}

	/// A pose that one state has is reached, and each goal state has it.
	void expectReached( SeededRng& rng ) const
	{
		std::vector<double> q;
		for ( std::uint32_t variable : m_problem.variables )
		{
			const lw_variable_info info = lw_robot_variable( m_problem.robot.get(), variable );
			const bool far = info.upper - info.lower > far_limits;
			q.push_back( rng.uniform( far ? -1 : info.lower, far ? 1 : info.upper ) );
		}
		const Matrix at = pose( q );
		ik::Options options;
		options.flags = LW_CHECK_ENVIRONMENT; // without an SRDF neighbours overlap
		const ik::GoalStates goal = ik::findGoalStates( m_model, m_problem, requestOf( at ), options );
		EXPECT_FALSE( goal.states.empty() ) << goal.problem;
		for ( const std::vector<double>& state : goal.states )
		{
			const Matrix difference = product( inverseOf( at ), pose( state ) );
			EXPECT_LE( std::hypot( difference[0][3], difference[1][3], difference[2][3] ), metres + 1e-8 );
			for ( double angle : eulerXyz( difference ) )
			{
				EXPECT_LE( std::fabs( angle ), radians + 1e-8 );
			}
			EXPECT_TRUE( io::limitViolations( m_problem, state ).empty() );
		}
	}

private:
	static std::string contents( const std::string& file )
	{
		std::ostringstream text;
		text << std::ifstream( file ).rdbuf();
		return text.str();
	}

	std::string lastLink() const
	{
		const lw_robot* const robot = m_problem.robot.get();
		std::uint32_t last = 0, longest = 0;
		for ( std::uint32_t link = 0; link < lw_robot_link_count( robot ); ++link )
		{
			std::uint32_t length = 0;
			for ( std::uint32_t j = lw_robot_link_joint( robot, link ); j != LW_INVALID_INDEX;
			      j = lw_robot_link_joint( robot, lw_robot_joint_parent( robot, j ) ) )
			{
				length += lw_robot_joint_variable_count( robot, j );
			}
			last = length > longest ? link : last;
			longest = std::max( length, longest );
		}
		return lw_robot_link_name( robot, last );
	}

	Matrix pose( const std::vector<double>& q ) const
	{
		std::map<std::string, double> values;
		for ( std::size_t i = 0; i < q.size(); ++i )
		{
			values[m_problem.variable_names[i]] = q[i];
		}
		return m_oracle.pose( m_link, values );
	}

	io::Request requestOf( const Matrix& at ) const
	{
		lw_transform transform = lw_transform_identity();
		for ( std::size_t i = 0; i < 9; ++i )
		{
			transform.r[i / 3][i % 3] = at[i / 3][i % 3];
		}
		io::Request request;
		request.goal_positions.resize( 1 );
		request.goal_orientations.resize( 1 );
		request.goal_positions[0].link = request.goal_orientations[0].link = m_link;
		request.goal_positions[0].regions.resize( 1 );
		io::GoalRegion& region = request.goal_positions[0].regions[0];
		region.size = { metres, 0, 0 };
		region.pose.t[0] = at[0][3];
		region.pose.t[1] = at[1][3];
		region.pose.t[2] = at[2][3];
		request.goal_orientations[0].tolerance.fill( radians );
		lw_transform_to_quaternion( &transform, request.goal_orientations[0].quaternion.data() );
		return request;
	}

	UrdfOracle m_oracle;
	io::RobotModel m_model;
	io::Problem m_problem;
	std::string m_link;
};

} // namespace

TEST( PoseZoo, PosesOfRandomStatesAreReachedByEveryRobot )
{
	const char* const folder = std::getenv( "LEEWAY_ZOO_DIR" );
	const fs::path share = fs::path( folder != nullptr ? folder : "" ) / "example-robot-data/cmeel.prefix/share";
	if ( folder == nullptr || !fs::is_directory( share ) )
	{
		GTEST_SKIP() << "LEEWAY_ZOO_DIR does not name a folder with example-robot-data";
	}
	std::vector<std::string> files;
	for ( const fs::directory_entry& entry : fs::recursive_directory_iterator( share / "example-robot-data/robots" ) )
	{
		if ( entry.path().extension() == ".urdf" )
		{
			files.push_back( entry.path().string() );
		}
	}
	std::sort( files.begin(), files.end() );
	SeededRng rng;
	int robots = 0;
	for ( const std::string& file : files )
	{
		SCOPED_TRACE( file );
		std::unique_ptr<ZooRobot> robot;
		try
		{
			robot = std::make_unique<ZooRobot>( file, share.string() );
		}
		catch ( const std::exception& )
		{
			continue; // no joint that moves, or no geometry: tests of the reader are about these
		}
		++robots;
		for ( int i = 0; i < 10; ++i )
		{
			robot->expectReached( rng );
		}
	}
	std::printf( "%d of %zu robots\n", robots, files.size() );
	EXPECT_GE( robots, 10 );
}
