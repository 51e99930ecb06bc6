// SPDX-License-Identifier: BSD-3-Clause
// Plans to poses of links: from a request and from --goal-pose, their audit, and goals that cannot be reached.
#include "cli_fixture.hpp"

#include <nlohmann/json.hpp>
#include <yaml-cpp/yaml.h>

#include <cmath>

namespace
{

/// The arm's tool, from the joint values.
std::array<double, 3> tool( const std::vector<double>& q )
{
	return { 0.4 * std::cos( q[0] ) + 0.4 * std::cos( q[0] + q[1] ), 0.4 * std::sin( q[0] ) + 0.4 * std::sin( q[0] + q[1] ),
	    q[0] + q[1] };
}

class CliPose : public Cli
{
protected:
	/// A request from shoulder -1, elbow 0 to a ball of 1 mm about (x, y), and more constraints.
	void writeRequest( const std::string& name, double x, double y, const std::string& more = "" ) const
	{
		write( name, "group_name: arm\nallowed_planning_time: 30\nstart_state: {joint_state: {name: [shoulder, elbow], "
		             "position: [-1, 0]}}\n"
		             "goal_constraints:\n  - position_constraints:\n      - {link_name: tool, header: {frame_id: base}, "
		             "constraint_region: "
		             "{primitives: [{type: sphere, dimensions: [0.001]}], primitive_poses: [{position: [" +
		                 std::to_string( x ) + ", " + std::to_string( y ) + ", 0]}]}}\n" + more );
	}
	std::vector<double> lastPoint() const
	{
		const YAML::Node points = YAML::LoadFile( path( "path.yaml" ) )["points"];
		return points[points.size() - 1]["positions"].as<std::vector<double>>();
	}
	Outcome planPose( const std::vector<std::string>& poses ) const
	{
		std::vector<std::string> arguments = { "--group", "arm", "--out", "path.yaml" };
		for ( const std::string& pose : poses )
		{
			arguments.insert( arguments.end(), { "--goal-pose", pose } );
		}
		return runModel( "plan", arguments );
	}
	void expectWrong( const std::vector<std::string>& poses, const std::vector<std::string>& words ) const
	{
		const Outcome outcome = planPose( poses );
		EXPECT_EQ( outcome.status, 2 ) << outcome.out;
		for ( const std::string& word : words )
		{
			EXPECT_TRUE( contains( outcome.err, word ) ) << "lacks '" << word << "': " << outcome.err;
		}
	}
};

} // namespace

TEST_F( CliPose, ARequestWithAPositionIsPlannedAndAudited )
{
	writeRequest( "pose.yaml", 0.3, 0.5 );
	const Outcome outcome =
	    runModel( "plan", { "--request", "pose.yaml", "--out", "path.yaml", "--report", "report.json" }, "blocked.yaml" );
	ASSERT_EQ( outcome.status, 0 ) << outcome.err;
	EXPECT_TRUE( contains( outcome.out, "inverse kinematics" ) ) << outcome.out;
	const auto at = tool( lastPoint() );
	EXPECT_LE( std::hypot( at[0] - 0.3, at[1] - 0.5 ), 0.001 + 1e-8 );
	const nlohmann::json report = nlohmann::json::parse( readFile( path( "report.json" ) ) );
	EXPECT_GE( report["goal_states"]["found"].get<int>(), 2 ) << "elbow left and elbow right";
	EXPECT_EQ( runModel( "audit", { "--path", "path.yaml", "--request", "pose.yaml" }, "blocked.yaml" ).status, 0 );
	writeRequest( "other.yaml", 0.3, 0.51 );
	const Outcome other = runModel( "audit", { "--path", "path.yaml", "--request", "other.yaml" }, "blocked.yaml" );
	EXPECT_EQ( other.status, 1 );
	EXPECT_TRUE( contains( other.out, "link tool is 0.00" ) && contains( other.out, "outside of its region" ) ) << other.out;
}

TEST_F( CliPose, OrientationAndJointConstraintsChooseTheElbow )
{
	writeRequest( "pose.yaml", 0.4, 0.4,
	    "    joint_constraints: [{joint_name: elbow, position: 1.5, tolerance_above: 1, tolerance_below: 1}]\n" );
	ASSERT_EQ( runModel( "plan", { "--request", "pose.yaml", "--out", "path.yaml" } ).status, 0 );
	EXPECT_NEAR( lastPoint()[1], std::acos( 0.0 ), 0.02 );
	writeRequest( "turned.yaml", 0.4, 0.4,
	    "    orientation_constraints: [{link_name: tool, header: {frame_id: base}, orientation: [0, 0, 0, 1], "
	    "absolute_x_axis_tolerance: 0.1, "
	    "absolute_y_axis_tolerance: 0.1, absolute_z_axis_tolerance: 0.1}]\n" );
	ASSERT_EQ( runModel( "plan", { "--request", "turned.yaml", "--out", "path.yaml" } ).status, 0 );
	EXPECT_NEAR( lastPoint()[1], -std::acos( 0.0 ), 0.02 ) << "the tool points along x";
}

TEST_F( CliPose, PosesOnTheCommandLine )
{
	ASSERT_EQ( planPose( { "tool=0.4,0.4,0" } ).status, 0 );
	EXPECT_NEAR( tool( lastPoint() )[0], 0.4, 1.1e-4 );
	EXPECT_NEAR( tool( lastPoint() )[1], 0.4, 1.1e-4 );
	ASSERT_EQ( planPose( { "tool=0.4,0.4,0,0,0,0.70710678,0.70710678" } ).status, 0 );
	EXPECT_NEAR( tool( lastPoint() )[2], std::acos( 0.0 ), 1.1e-3 );
	ASSERT_EQ( planPose( { "tool=0.4,0.4,0", "fore=0.4,0,0" } ).status, 0 );
	EXPECT_NEAR( lastPoint()[1], std::acos( 0.0 ), 2e-3 ) << "the place of the forearm leaves one elbow";
}

TEST_F( CliPose, EqualSeedsGiveEqualPaths )
{
	ASSERT_EQ( planPose( { "tool=0.3,0.5,0" } ).status, 0 );
	const std::string first = readFile( path( "path.yaml" ) );
	ASSERT_EQ( planPose( { "tool=0.3,0.5,0" } ).status, 0 );
	EXPECT_EQ( readFile( path( "path.yaml" ) ), first );
}

TEST_F( CliPose, WrongPosesAreNamed )
{
	expectWrong( { "tool" }, { "--goal-pose tool", "names no link", "LINK=X,Y,Z" } );
	expectWrong( { "tool=0.4,0.4" }, { "2 numbers, not 3 or 7" } );
	expectWrong( { "tool=0.4,0.4,one" }, { "'one' is not a finite number" } );
	expectWrong( { "tool=0.4,0.4,0,0,0,0,0" }, { "the quaternion has length 0" } );
	expectWrong( { "tol=0.4,0.4,0" }, { "has no link tol", "tool" } );
	expectWrong( { "base=0.4,0.4,0" }, { "group arm cannot move link base" } );
	expectWrong( { "tool=3,0,0" },
	    { "command line", "no state of group arm reaches it", "2.2e+03 mm outside of the region of link tool" } );
	EXPECT_EQ( runModel( "plan", { "--goal-pose", "tool=0.4,0.4,0", "--goal", "elbow=1" } ).status, 2 );
}

TEST_F( CliPose, AGoalInCollisionNamesThePair )
{
	const Outcome outcome =
	    runModel( "plan", { "--group", "arm", "--start", "shoulder=-1", "--goal-pose", "tool=0.6,0,0" }, "blocked.yaml" );
	EXPECT_EQ( outcome.status, 2 );
	EXPECT_TRUE( contains( outcome.err, "none is free" ) && contains( outcome.err, "fore - " ) ) << outcome.err;
}

TEST_F( CliPose, ConstraintsOfThePathWithoutRoomAreRefusedByName )
{
	writeRequest( "pose.yaml", 0.4, 0.4 );
	edit( "pose.yaml", "group_name: arm\n",
	    "group_name: arm\npath_constraints: {orientation_constraints: [{link_name: tool, orientation: [0, 0, 0, 1]}]}\n" );
	const Outcome outcome = runModel( "plan", { "--request", "pose.yaml", "--trajectory", "plan.json" } );
	EXPECT_EQ( outcome.status, 2 );
	EXPECT_TRUE( contains( outcome.err, "path_constraints.orientation_constraints[0] tool" ) ) << outcome.err;
}
