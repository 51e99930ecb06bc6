// SPDX-License-Identifier: BSD-3-Clause
// leeway audit --trajectory. The post of blocked.yaml is met at shoulder angles around zero.
#include "cli_fixture.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

class CliTrajectory : public Cli
{
protected:
	Outcome audit( std::vector<std::string> more, const std::string& scene = "blocked.yaml" )
	{
		std::vector<std::string> arguments = { "--trajectory" };
		arguments.insert( arguments.end(), more.begin(), more.end() );
		return runModel( "audit", arguments, scene );
	}
	nlohmann::json report( std::vector<std::string> more )
	{
		more.insert( more.end(), { "--report", "report.json" } );
		const Outcome outcome = audit( more );
		EXPECT_NE( outcome.status, 2 ) << outcome.err;
		return nlohmann::json::parse( readFile( path( "report.json" ) ) )["audit"];
	}
};

namespace
{

// Both ends, and the straight way between them, are free: the cubic swings into the post and back.
const char* const swing = "time,shoulder,elbow,velocity:shoulder,velocity:elbow\n0,-0.6,0,0.8,0\n3,-0.6,0,-0.8,0\n";

} // namespace

TEST_F( CliTrajectory, ACurveThatLeavesItsStraightWayIsBlockedWhereItIsDriven )
{
	write( "t.csv", swing );
	const Outcome linear = audit( { "t.csv", "--interpolation", "linear" } );
	EXPECT_EQ( linear.status, 0 ) << linear.out << linear.err;
	const nlohmann::json driven = report( { "t.csv" } );
	EXPECT_EQ( driven["verdict"], "BLOCKED" );
	EXPECT_EQ( driven["segments"]["cubic"], 1 );
	EXPECT_EQ( driven["violation"]["pair"][1], "post" );
	const double time = driven["violation"]["time"], shoulder = driven["violation"]["state"]["shoulder"];
	EXPECT_NEAR( shoulder, -0.6 + 0.8 * time * ( 1 - time / 3 ), 1e-9 );
	EXPECT_LT( std::abs( shoulder ), 0.3 );
	EXPECT_EQ( audit( { "t.csv", "--interpolation", "quintic" } ).status, 2 );
}

TEST_F( CliTrajectory, EveryFormatGivesTheSameVerdict )
{
	const std::string points = R"("points": [
 {"positions": [0, -0.6], "velocities": [0, 0.8], "accelerations": [], "time_from_start": TIME0},
 {"positions": [0, -0.6], "velocities": [0, -0.8], "effort": [], "time_from_start": TIME3}])";
	const auto with = [&]( const std::string& zero, const std::string& three )
	{
		std::string text = R"({"joint_names": ["elbow", "shoulder"], )" + points + "}";
		text.replace( text.find( "TIME0" ), 5, zero );
		return text.replace( text.find( "TIME3" ), 5, three );
	};
	write( "t.csv", swing );
	nlohmann::json expected = report( { "t.csv" } );
	expected.erase( "proof_seconds" );
	const std::string ros2 = with( R"({"sec": 0, "nanosec": 0})", R"({"sec": 3, "nanosec": 0})" );
	const std::string ros1 = with( R"({"secs": 0, "nsecs": 0})", R"({"secs": 3, "nsecs": 0})" );
	const std::string messages[] = { ros2, ros1, with( "0.0", "3" ), R"({"joint_trajectory": )" + ros2 + "}",
	    R"({"trajectory": )" + ros2 + "}", R"({"trajectory": {"joint_trajectory": )" + ros2 + "}}",
	    R"({"model_id": "arm", "trajectory": [{"joint_trajectory": )" + ros2 +
	        R"(, "multi_dof_joint_trajectory": {"joint_names": []}}]})" };
	for ( const std::string& message : messages )
	{
		write( "t.json", message );
		nlohmann::json found = report( { "t.json" } );
		found.erase( "proof_seconds" );
		EXPECT_EQ( found, expected ) << message;
	}
	write( "t.yaml",
	    "joint_names: [shoulder, elbow]\npoints:\n- positions: [-0.6, 0]\n  velocities: [0.8, 0]\n  time_from_start:\n"
	    "    sec: 0\n    nanosec: 0\n- positions: [-0.6, 0]\n  velocities: [-0.8, 0]\n  time_from_start: {sec: 3, nanosec: "
	    "0}\n---\n" );
	nlohmann::json found = report( { "t.yaml" } );
	found.erase( "proof_seconds" );
	EXPECT_EQ( found, expected );
}

TEST_F( CliTrajectory, AToleranceThatReachesThePostIsNotFree )
{
	write( "t.csv", "time,shoulder,elbow\n0,-0.6,0\n1,-0.5,0\n" );
	EXPECT_EQ( audit( { "t.csv" } ).status, 0 );
	EXPECT_EQ( report( { "t.csv", "--tolerance", "0.05" } )["verdict"], "FREE" );
	const nlohmann::json wide = report( { "t.csv", "--tolerance", "shoulder=0.5" } );
	EXPECT_EQ( wide["verdict"], "UNDECIDED" );
	EXPECT_EQ( wide["violation"]["pair"][1], "post" );
	EXPECT_EQ( wide["tolerance"]["elbow"], 0.0 );
	write( "goal.json", R"({"trajectory": {"joint_names": ["shoulder", "elbow"], "points": [{"positions": [-0.6, 0],
		"time_from_start": 0}, {"positions": [-0.5, 0], "time_from_start": 1}]}, "path_tolerance": [{"name": "shoulder", "position": 0.5}]})" );
	EXPECT_EQ( report( { "goal.json" } )["verdict"], "UNDECIDED" );
}

TEST_F( CliTrajectory, LimitsHoldBetweenThePointsToo )
{
	// at rest at both ends; 1.5 rad in 2 s is 1.125 rad/s in the middle, and 2.25 rad/s^2 at the ends
	write( "t.csv", "time,shoulder,elbow,velocity:shoulder,velocity:elbow\n0,-1.9,0,0,0\n2,-0.4,0,0,0\n" );
	const Outcome fast = audit( { "t.csv" } );
	EXPECT_EQ( fast.status, 1 );
	EXPECT_TRUE( contains( fast.out, "joint shoulder: velocity of 1.125 rad/s at 1.0000 s is above its limit 1" ) )
	    << fast.out;
	write( "limits.yaml", "joint_limits:\n  shoulder:\n    has_velocity_limits: true\n    max_velocity: 1.2\n"
	                      "    has_acceleration_limits: true\n    max_acceleration: 2.0\n" );
	const Outcome slow = audit( { "t.csv", "--joint-limits", "limits.yaml" } );
	EXPECT_FALSE( contains( slow.out, "velocity" ) ) << slow.out;
	EXPECT_TRUE( contains( slow.out, "joint shoulder: acceleration of 2.25 rad/s^2 at 0.0000 s is above its limit 2" ) )
	    << slow.out;
	write( "t.csv", "time,shoulder,elbow,velocity:shoulder,velocity:elbow\n0,-1.9,0,-0.5,0\n2,-1.9,0,0.5,0\n" );
	EXPECT_TRUE(
	    contains( audit( { "t.csv" } ).out, "joint shoulder: position of -2.15 rad at 1.0000 s is below its limit -2" ) );
}

TEST_F( CliTrajectory, AJumpBetweenTwoTrajectoriesIsTold )
{
	const std::string one =
	    R"({"joint_trajectory": {"joint_names": ["shoulder", "elbow"], "points": [)"
	    R"({"positions": [-0.6, 0], "time_from_start": 0}, {"positions": [-0.5, 0], "time_from_start": 1}]}})";
	write( "t.json", R"({"trajectory": [)" + one + ", " + one + "]}" );
	const Outcome outcome = audit( { "t.json" } );
	EXPECT_EQ( outcome.status, 1 );
	EXPECT_TRUE( contains( outcome.out, "trajectory[1].joint_trajectory starts 0.1 away" ) ) << outcome.out;
}

TEST_F( CliTrajectory, OnePointIsAStateThatIsHeld )
{
	write( "t.csv", "time,shoulder,elbow,velocity:shoulder,velocity:elbow\n0,-0.6,0,0,0\n" );
	EXPECT_EQ( audit( { "t.csv", "--profile", "p.csv" } ).status, 0 );
	EXPECT_EQ( parseTable( readFile( path( "p.csv" ) ) ).rows.size(), 1u );
	write( "t.csv", "time,shoulder,elbow\n0,0,0\n" );
	EXPECT_EQ( report( { "t.csv" } )["verdict"], "BLOCKED" );
	write( "t.csv", "time,shoulder,elbow,velocity:shoulder,velocity:elbow\n0,-0.6,0,1e308,0\n1e-300,-0.6,0,-1e308,0\n" );
	EXPECT_NE( audit( { "t.csv" } ).status, 0 ); // beyond all numbers, but no hang
}

TEST_F( CliTrajectory, ProfileIsMeasuredOnTheCurve )
{
	write( "t.csv", swing );
	EXPECT_EQ( audit( { "t.csv", "--profile", "p.csv" } ).status, 1 );
	const Table table = parseTable( readFile( path( "p.csv" ) ) );
	ASSERT_EQ( table.rows.size(), 301u );
	EXPECT_NEAR( table.number( 300, "time" ), 3, 1e-9 );
	EXPECT_EQ( table.number( 150, "environment" ), 0 );
	EXPECT_GT( table.number( 0, "environment" ), 0.01 );
}

TEST_F( CliTrajectory, PlannedTrajectoryStopsAtCornersAndKeepsItsLimits )
{
	write( "limits.yaml", "joint_limits:\n  elbow:\n    has_acceleration_limits: true\n    max_acceleration: 0.5\n" );
	const Outcome plan = runModel( "plan",
	    { "--request", "request.yaml", "--out", "path.yaml", "--trajectory", "t.json", "--min-d", "0.001", "--joint-limits",
	        "limits.yaml" },
	    "blocked.yaml" );
	ASSERT_EQ( plan.status, 0 ) << plan.out << plan.err;
	EXPECT_TRUE( contains( plan.err, "no acceleration limit of shoulder" ) ) << plan.err;
	const nlohmann::json points = nlohmann::json::parse( readFile( path( "t.json" ) ) )["joint_trajectory"]["points"];
	const Outcome audited = audit( { "t.json", "--min-d", "0.001", "--joint-limits", "limits.yaml" } );
	EXPECT_EQ( audited.status, 0 ) << audited.out << audited.err;
	EXPECT_TRUE( contains( audited.out, std::to_string( points.size() - 1 ) + " quintic" ) ) << audited.out;
	for ( const nlohmann::json& point : points )
	{
		EXPECT_EQ( point["velocities"], nlohmann::json( { 0.0, 0.0 } ) );
	}
	// as fast as the limits allow: half of one of them is too little
	write( "half.yaml",
	    "joint_limits:\n  elbow:\n    has_velocity_limits: true\n    max_velocity: 0.5\n    has_acceleration_limits: "
	    "true\n    max_acceleration: 0.25\n  shoulder:\n    has_velocity_limits: true\n    max_velocity: 0.5\n"
	    "    has_acceleration_limits: true\n    max_acceleration: 0.5\n" );
	EXPECT_EQ( audit( { "t.json", "--joint-limits", "half.yaml" } ).status, 1 );
}

TEST_F( CliTrajectory, BadFilesNameTheElementAndTheRemedy )
{
	const auto error = [&]( const std::string& file, const std::string& text )
	{
		write( file, text );
		const Outcome outcome = audit( { file } );
		EXPECT_EQ( outcome.status, 2 ) << outcome.out;
		return outcome.err;
	};
	EXPECT_TRUE(
	    contains( error( "t.csv", "time,shoulder,elbow\n0,0,0\n0,0,0\n" ), "points[1].time_from_start: 0 s is not after" ) );
	EXPECT_TRUE( contains( error( "t.csv", "shoulder,elbow\n0,0\n" ), "no column time" ) );
	EXPECT_TRUE( contains( error( "t.csv", "time,shoulder,elbow,velocity:elbow\n0,0,0,0\n" ), "velocity:<joint>" ) );
	EXPECT_TRUE( contains( error( "t.csv", "time,wrist\n0,0\n" ), "no group of the SRDF has just these joints" ) );
	EXPECT_TRUE( contains(
	    error( "t.json", R"({"joint_names": ["shoulder", "elbow"], "points": [{"positions": [0], "time_from_start": 0}]})" ),
	    "points[0].positions: is not a list of 2 numbers" ) );
	EXPECT_TRUE( contains( error( "t.json", R"({"joint_names": ["shoulder", "elbow"], "points": [{"positions": [0, 0]}]})" ),
	    "points[0].time_from_start: is missing" ) );
	EXPECT_TRUE( contains( error( "t.json", "[1, 2]" ), "is not a YAML map" ) );
	const Outcome both = runModel( "audit", {}, "blocked.yaml" );
	EXPECT_EQ( both.status, 2 );
	EXPECT_TRUE( contains( both.err, "--trajectory" ) ) << both.err;
}

// The elbow folds while the shoulder waits, then the shoulder turns past the post, then the arm stretches again.
TEST_F( CliTrajectory, RoundedCornersOfAFreePathMeetThePost )
{
	const std::string points =
	    "joint_names: [shoulder, elbow]\npoints:\n"
	    "  - positions: [-1, 0]\n  - positions: [-1, 2.4]\n  - positions: [1, 2.4]\n  - positions: [1, 0]\n";
	write( "p.yaml", points );
	const auto audited = [&]( std::vector<std::string> more )
	{
		more.insert( more.begin(), { "--path", "p.yaml" } );
		return runModel( "audit", more, "blocked.yaml" );
	};
	ASSERT_EQ( audited( {} ).status, 0 );
	const Outcome narrow = audited( { "--corner-blend", "0.05" } );
	EXPECT_EQ( narrow.status, 0 ) << narrow.out << narrow.err;
	EXPECT_TRUE( contains( narrow.out, "2 corners by up to 0.05: FREE" ) ) << narrow.out;
	const Outcome wide = audited( { "--corner-blend", "1.5", "--report", "r.json" } );
	EXPECT_EQ( wide.status, 1 ) << wide.out << wide.err;
	const nlohmann::json found = nlohmann::json::parse( readFile( this->path( "r.json" ) ) )["roundings"];
	EXPECT_EQ( found["verdict"], "BLOCKED" );
	EXPECT_EQ( found["point"], 1 );
	EXPECT_EQ( found["pair"][1], "post" );
	EXPECT_GT( found["free_radius"], 0.05 );
	const double shoulder = found["state"]["shoulder"], elbow = found["state"]["elbow"];
	write( "states.csv", "shoulder,elbow\n" + std::to_string( shoulder ) + "," + std::to_string( elbow ) + "\n" );
	EXPECT_EQ( runModel( "check", { "--states", "states.csv" }, "blocked.yaml" ).status, 1 );
	// a tolerance that reaches the post
	EXPECT_EQ( audited( { "--corner-blend", "0.05", "--tolerance", "shoulder=1" } ).status, 1 );
	EXPECT_EQ( audited( { "--tolerance", "0.1" } ).status, 2 );
	EXPECT_EQ( audited( { "--corner-blend", "-1" } ).status, 2 );
	EXPECT_EQ( audit( { "t.csv", "--corner-blend", "0.1" } ).status, 2 );
}

TEST_F( CliTrajectory, QuinticsKeepTheSignsOfTheirAccelerations )
{
	// half of s^2 (1 - s)^3 and of s^3 (1 - s)^2 times 4 s^2: 0.2 rad farther at 0.8 s and at 1.2 s
	const std::string header = "time,shoulder,elbow,velocity:shoulder,velocity:elbow,acceleration:shoulder,acceleration:elbow\n";
	for ( const auto& [start, end, time] : { std::tuple( -2.9, 0.0, "0.8000" ), std::tuple( 0.0, -2.9, "1.2000" ) } )
	{
		for ( const double sign : { 1.0, -1.0 } )
		{
			write( "t.csv", header + "0,-1.9,0,0,0," + std::to_string( sign * start ) + ",0\n2,-1.9,0,0,0," + std::to_string( sign * end ) + ",0\n" );
			const std::string out = audit( { "t.csv" } ).out;
			EXPECT_EQ( contains( out, "joint shoulder: position of -2.1" ) && contains( out, std::string( time ) + " s is below its limit -2" ), sign > 0 ) << out;
		}
	}
}

TEST_F( CliTrajectory, LengthsOfAGroupWrapTheGroupsOwnJoints )
{
	edit( "arm.srdf", "</robot>", "<group name=\"last\"><joint name=\"elbow\"/></group></robot>" );
	edit( "arm.urdf", "<joint name=\"elbow\" type=\"revolute\">", "<joint name=\"elbow\" type=\"continuous\">" );
	edit( "arm.urdf", "multiplier=\"0.5\"", "multiplier=\"1\"" );
	write( "p.yaml", "group: last\njoint_names: [elbow]\npoints: [[3], [-3]]\n" );
	runModel( "audit", { "--path", "p.yaml", "--report", "r.json" } );
	const nlohmann::json report = nlohmann::json::parse( readFile( path( "r.json" ) ) );
	EXPECT_NEAR( report["audit"]["length"].get<double>(), 2 * M_PI - 6, 1e-9 );
}

TEST_F( CliTrajectory, BoundsBetweenStatesCountTheMotionOfBothBodies )
{
	write( "rail.urdf", "<robot name='rail'><link name='base'><collision><geometry><box size='0.2 0.2 0.2'/></geometry></collision></link><link name='cart'>"
		"<collision><geometry><box size='0.2 0.2 0.2'/></geometry></collision></link><joint name='rail' type='prismatic'><parent link='base'/><child link='cart'/>"
		"<axis xyz='1 0 0'/><limit lower='0' upper='2' effort='1' velocity='1'/></joint></robot>" );
	write( "p.yaml", "joint_names: [rail]\npoints: [[1], [0.3]]\n" );
	const Outcome outcome = run( { "audit", "--robot", "rail.urdf", "--path", "p.yaml", "--report", "r.json", "--profile", "p.csv" } );
	ASSERT_EQ( outcome.status, 0 ) << outcome.err;
	const Table samples = parseTable( readFile( path( "p.csv" ) ) );
	double expected = 9;
	for ( std::size_t i = 1; i < samples.rows.size(); ++i )
	{
		const double moved = 1.001 * 0.7 * ( samples.number( i, "t" ) - samples.number( i - 1, "t" ) );
		expected = std::min( expected, ( samples.number( i - 1, "self" ) + samples.number( i, "self" ) - 2 * moved ) / 2 );
	}
	EXPECT_NEAR( nlohmann::json::parse( readFile( path( "r.json" ) ) )["audit"]["self"]["between_states"].get<double>(), expected, 1e-9 );
}
