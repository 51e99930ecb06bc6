// SPDX-License-Identifier: BSD-3-Clause
// Small arms as URDF text, their problems, and goals for them.
#pragma once

#include "seeded_rng.hpp"
#include "urdf_oracle.hpp"

#include "leeway/ik/goal_states.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>

using namespace leeway;
using Vector = std::vector<double>;

/// Joints of a serial arm, links named after them; the last link is "hand".
struct ArmText
{
	std::string joints;
	std::string last = "base";
	std::string links = "<link name='base'><collision><origin xyz='0 0 -0.3'/><geometry><sphere "
	                    "radius='0.05'/></geometry></collision></link>";

	ArmText& add( const std::string& name, const std::string& type, const std::string& origin, const std::string& axis,
	    double lower, double upper, const std::string& more = "", const std::string& parent = "" )
	{
		links += "<link name='" + name + "_link'/>";
		joints += "<joint name='" + name + "' type='" + type + "'><parent link='" + ( parent.empty() ? last : parent ) +
		          "'/><child link='" + name + "_link'/><origin " + origin + "/><axis xyz='" + axis + "'/>" +
		          ( type == "fixed" || type == "continuous" ? ""
		                                                    : "<limit lower='" + std::to_string( lower ) + "' upper='" +
		                                                          std::to_string( upper ) + "' effort='1' velocity='1'/>" ) +
		          more + "</joint>";
		last = parent.empty() ? name + "_link" : last;
		return *this;
	}
	/// The hand has a ball of 2 cm.
	std::string text() const
	{
		return "<robot name='arm'>" + links +
		       "<link name='hand'><collision><geometry><sphere radius='0.02'/></geometry></collision></link>" + joints +
		       "<joint name='flange' type='fixed'><parent link='" + last +
		       "'/><child link='hand'/><origin xyz='0.05 0 0.08' rpy='0.1 0.2 0.3'/></joint></robot>";
	}
};

inline std::string sixAxisArm()
{
	return ArmText()
	    .add( "j1", "revolute", "xyz='0 0 0.3'", "0 0 1", -2.9, 2.9 )
	    .add( "j2", "revolute", "xyz='0.05 0 0'", "0 1 0", -1.9, 1.9 )
	    .add( "j3", "revolute", "xyz='0 0 0.4'", "0 1 0", -2.5, 2.5 )
	    .add( "j4", "revolute", "xyz='0 0 0.2'", "0 0 1", -3, 3 )
	    .add( "j5", "revolute", "xyz='0 0 0.2' rpy='0.1 0 0'", "0 1 0", -2, 2 )
	    .add( "j6", "revolute", "xyz='0 0 0.05'", "0 0 2", -3, 3 )
	    .text();
}

inline std::string sevenAxisArm( const std::string& wrist = "revolute" )
{
	return ArmText()
	    .add( "j1", "revolute", "xyz='0 0 0.3'", "0 0 1", -2.9, 2.9 )
	    .add( "j2", "revolute", "xyz='0 0 0'", "0 1 0", -1.9, 1.9 )
	    .add( "j3", wrist, "xyz='0 0 0.2'", "0 0 1", -2.9, 2.9 )
	    .add( "j4", "revolute", "xyz='0.05 0 0.2' rpy='0 0 0.4'", "0 -1 0", -2.5, 2.5 )
	    .add( "j5", wrist, "xyz='-0.05 0 0.2'", "0 0 1", -2.9, 2.9 )
	    .add( "j6", "revolute", "xyz='0 0 0.2'", "1 1 0", -2, 2 )
	    .add( "j7", wrist, "xyz='0.08 0 0'", "0 0 -1", -2.9, 2.9 )
	    .text();
}

/// A robot of a URDF text, in a scene, with all joints or a group.
class PoseWorld
{
public:
	explicit PoseWorld( const std::string& urdf, const std::string& scene = "", const std::string& srdf = "",
	    const std::string& group = "", const std::map<std::string, double>& reference = {} )
	    : oracle( urdf )
	{
		std::string pattern = ( std::filesystem::temp_directory_path() / "leeway_pose_XXXXXX" ).string();
		const std::filesystem::path folder = mkdtemp( pattern.data() );
		const auto write = [&]( const char* name, const std::string& text )
		{
			std::ofstream( folder / name ) << text;
			return ( folder / name ).string();
		};
		robot = io::loadRobot( write( "r.urdf", urdf ), srdf.empty() ? "" : write( "r.srdf", srdf ) );
		io::ProblemOptions options;
		if ( !scene.empty() )
		{
			model = io::loadScene( write( "scene.yaml", scene ) );
			options.scene = &model;
		}
		options.group = group;
		options.overrides.values = reference;
		problem = io::buildProblem( robot, options );
		std::filesystem::remove_all( folder );
		request.file = "request.yaml";
	}

	/// Values of all variables by name.
	std::map<std::string, double> values( const Vector& q ) const
	{
		std::map<std::string, double> result;
		for ( std::uint32_t i = 0; i < problem.reference.size(); ++i )
		{
			result[io::variableName( problem.robot.get(), i )] = problem.reference[i];
		}
		for ( std::size_t i = 0; i < q.size(); ++i )
		{
			result[problem.variable_names[i]] = q[i];
		}
		return result;
	}
	Matrix pose( const std::string& link, const Vector& q ) const { return oracle.pose( link, values( q ) ); }

	Vector randomState( SeededRng& rng ) const
	{
		Vector q;
		for ( std::uint32_t variable : problem.variables )
		{
			const lw_variable_info info = lw_robot_variable( problem.robot.get(), variable );
			q.push_back( rng.uniform( info.lower, info.upper ) );
		}
		return q;
	}
	bool isFree( const Vector& q, double min_d = 0 ) const
	{
		const Query query = makeQuery( problem.checker.get() );
		lw_state_result state;
		require( lw_checker_state( problem.checker.get(), query.get(), q.data(), LW_CHECK_BOTH, nullptr, false, &state ),
		    "state" );
		return state.environment.lower > min_d && state.self.lower > min_d;
	}

	/// A goal at a pose in the planning frame: a ball about the origin of the link, and an orientation.
	void askFor( const std::string& link, const Matrix& at, double metres, double radians )
	{
		askForPlace( link, { at[0][3], at[1][3], at[2][3] }, metres );
		lw_transform transform = lw_transform_identity();
		for ( std::size_t i = 0; i < 9; ++i )
		{
			transform.r[i / 3][i % 3] = at[i / 3][i % 3];
		}
		io::OrientationGoal goal;
		goal.link = link;
		lw_transform_to_quaternion( &transform, goal.quaternion.data() );
		goal.tolerance.fill( radians );
		request.goal_orientations = { goal };
	}
	void askForPlace( const std::string& link, const std::array<double, 3>& at, double metres )
	{
		io::PositionGoal goal;
		goal.link = link;
		goal.regions.emplace_back();
		goal.regions[0].size = { metres, 0, 0 };
		std::copy( at.begin(), at.end(), goal.regions[0].pose.t );
		request.goal_positions = { goal };
	}

	ik::GoalStates find( const ik::Options& options = {} ) const
	{
		return ik::findGoalStates( robot, problem, request, options );
	}

	/// Every state: inside the limits, free, and where askFor() wants the link.
	void expectReached(
	    const ik::GoalStates& goal, const std::string& link, const Matrix& at, double metres, double radians ) const
	{
		for ( const Vector& q : goal.states )
		{
			const Matrix difference = product( inverseOf( at ), pose( link, q ) );
			EXPECT_LE( std::hypot( difference[0][3], difference[1][3], difference[2][3] ), metres + 1e-8 );
			for ( double angle : eulerXyz( difference ) )
			{
				EXPECT_LE( std::fabs( angle ), radians + 1e-8 );
			}
			EXPECT_TRUE( io::limitViolations( problem, q ).empty() ) << io::limitViolations( problem, q )[0];
			EXPECT_TRUE( isFree( q ) );
			EXPECT_TRUE( ik::goalViolations( problem, request, q.data() ).empty() );
		}
	}

	UrdfOracle oracle;
	io::RobotModel robot;
	io::SceneModel model;
	io::Problem problem;
	io::Request request;
};
