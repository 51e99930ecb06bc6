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
	EXPECT_TRUE( contains( outcome.out,
	    "trajectory[1].joint_trajectory: joint shoulder is at -0.6 in its first point and at -0.5 in the end of the one before" ) )
	    << outcome.out;
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

TEST_F( CliTrajectory, PlannedTrajectoryRoundsItsCornersAndKeepsItsLimits )
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
	const nlohmann::json rest = { 0.0, 0.0 };
	const auto stops = [&rest]( const nlohmann::json& of )
	{
		return std::count_if(
		    of.begin(), of.end(), [&]( const nlohmann::json& point ) { return point["velocities"] == rest; } );
	};
	EXPECT_EQ( stops( points ), 2 );
	EXPECT_EQ( points.front()["velocities"], rest );
	EXPECT_EQ( points.back()["accelerations"], rest );
	const Outcome slow = runModel( "plan",
	    { "--request", "request.yaml", "--out", "path.yaml", "--trajectory", "stops.json", "--min-d", "0.001",
	        "--joint-limits", "limits.yaml", "--path-tolerance", "0" },
	    "blocked.yaml" );
	ASSERT_EQ( slow.status, 0 ) << slow.out << slow.err;
	const nlohmann::json stopping = nlohmann::json::parse( readFile( path( "stops.json" ) ) )["joint_trajectory"]["points"];
	EXPECT_GT( stops( stopping ), 2 );
	const auto seconds = []( const nlohmann::json& of )
	{
		const nlohmann::json& time = of.back()["time_from_start"];
		return time["sec"].get<double>() + 1e-9 * time["nanosec"].get<double>();
	};
	EXPECT_GT( seconds( stopping ), seconds( points ) );
	for ( const char* bad : { "-0.1", "nan" } )
	{
		EXPECT_EQ( runModel( "plan", { "--request", "request.yaml", "--trajectory", "t2.json", "--path-tolerance", bad },
		               "blocked.yaml" )
		               .status,
		    2 )
		    << bad;
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
	const std::string header =
	    "time,shoulder,elbow,velocity:shoulder,velocity:elbow,acceleration:shoulder,acceleration:elbow\n";
	for ( const auto& [start, end, time] : { std::tuple( -2.9, 0.0, "0.8000" ), std::tuple( 0.0, -2.9, "1.2000" ) } )
	{
		for ( const double sign : { 1.0, -1.0 } )
		{
			write( "t.csv", header + "0,-1.9,0,0,0," + std::to_string( sign * start ) + ",0\n2,-1.9,0,0,0," +
			                    std::to_string( sign * end ) + ",0\n" );
			const std::string out = audit( { "t.csv" } ).out;
			EXPECT_EQ( contains( out, "joint shoulder: position of -2.1" ) &&
			               contains( out, std::string( time ) + " s is below its limit -2" ),
			    sign > 0 )
			    << out;
		}
	}
}

TEST_F( CliTrajectory, QuinticsKeepTheVelocitiesOfBothEnds )
{
	// From -1.9 back to it with a velocity of -0.6 at the start, or 0.6 at the end, 2 s later: 16 / 81 of 1.2 rad below, at a third and two thirds
	const std::string header =
	    "time,shoulder,elbow,velocity:shoulder,velocity:elbow,acceleration:shoulder,acceleration:elbow\n";
	for ( const auto& [start, end, time] : { std::tuple( "-0.6", "0", "0.6667" ), std::tuple( "0", "0.6", "1.3333" ) } )
	{
		write( "t.csv", header + "0,-1.9,0," + start + ",0,0,0\n2,-1.9,0," + end + ",0,0,0\n" );
		const std::string out = audit( { "t.csv" } ).out;
		EXPECT_TRUE( contains( out, "joint shoulder: position of -2.13704" ) ) << out;
		EXPECT_TRUE( contains( out, std::string( time ) + " s is below its limit -2" ) ) << out;
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

// The post stands at shoulder angles around zero, between -1 and 1.
TEST_F( CliTrajectory, TheWayFromAKnownStartToALateFirstPointIsProved )
{
	const auto with = [&]( const std::string& start, const std::string& velocities )
	{
		write( "t.json", R"({"joint_names": ["shoulder", "elbow"], "points": [{"positions": [-1, 0], )" + velocities +
		                     R"("time_from_start": 3}, {"positions": [-1.2, 0], )" + velocities +
		                     R"("time_from_start": 4}], "trajectory_start": )" + start + "}" );
	};
	const std::string at_one = R"({"joint_state": {"name": ["shoulder", "elbow"], "position": [1, 0]}})";
	with( at_one, "" );
	const nlohmann::json beyond = report( { "t.json" } );
	EXPECT_EQ( beyond["verdict"], "BLOCKED" );
	EXPECT_EQ( beyond["violation"]["pair"][1], "post" );
	EXPECT_NEAR( beyond["violation"]["state"]["shoulder"], 1 - 2 * beyond["violation"]["time"].get<double>() / 3, 1e-9 );
	EXPECT_EQ( beyond["segments"]["linear"], 2 );
	with( R"({"joint_state": {"name": ["shoulder", "elbow"], "position": [-0.8, 0]}})", "" );
	EXPECT_EQ( audit( { "t.json", "--profile", "p.csv" } ).status, 0 );
	EXPECT_EQ( parseTable( readFile( path( "p.csv" ) ) ).rows.size(), 401u );
	// straight it would be free: the cubic that a velocity at the first point bends swings past the post, and so does one from a moving start
	with( R"({"joint_state": {"name": ["shoulder", "elbow"], "position": [-0.8, 0]}})", R"("velocities": [-2.5, 0], )" );
	EXPECT_EQ( report( { "t.json", "--interpolation", "linear" } )["verdict"], "FREE" );
	EXPECT_EQ( report( { "t.json" } )["verdict"], "BLOCKED" );
	with( R"({"joint_state": {"name": ["shoulder", "elbow"], "position": [-0.8, 0], "velocity": [2.5, 0]}})",
	    R"("velocities": [0, 0], )" );
	EXPECT_EQ( report( { "t.json" } )["verdict"], "BLOCKED" );
	// robots whose hardware reports no velocity are driven straight: 0.2 rad in 3 s, with a peak in the middle of cubics alone
	with( R"({"joint_state": {"name": ["shoulder", "elbow"], "position": [1.5, 0]}})", R"("velocities": [0, 0], )" );
	EXPECT_TRUE( contains( audit( { "t.json" }, "scene.yaml" ).out, "velocity of -1.25 rad/s" ) );
	// some joints known, others not
	with( R"({"joint_state": {"name": ["shoulder"], "position": [-0.8]}})", "" );
	const Outcome half = audit( { "t.json" } );
	EXPECT_EQ( half.status, 2 );
	EXPECT_TRUE( contains( half.err, "points[0].time_from_start" ) && contains( half.err, "elbow" ) ) << half.err;
	with( "{}", "" );
	const Outcome unknown = audit( { "t.json" } );
	EXPECT_TRUE( unknown.status == 0 && contains( unknown.err, "not known and not proved" ) ) << unknown.err;
}

TEST_F( CliTrajectory, StartsOfRequestsAndOfEarlierTrajectoriesAreStartsToo )
{
	const std::string late =
	    R"({"joint_names": ["shoulder", "elbow"], "points": [{"positions": [1, 0], "time_from_start": 3}]})";
	write( "t.json", late );
	EXPECT_EQ( report( { "t.json", "--request", "request.yaml" } )["verdict"], "BLOCKED" ); // of -1
	write( "t.json",
	    R"({"trajectory": [{"joint_trajectory": {"joint_names": ["shoulder", "elbow"], "points": [{"positions": [-1, 0], "time_from_start": 0}]}},
		{"joint_trajectory": )" +
	        late + "}]}" );
	EXPECT_EQ( report( { "t.json" } )["verdict"], "BLOCKED" );
	write(
	    "t.json", R"({"joint_names": ["shoulder", "elbow"], "points": [{"positions": [-0.9, 0], "time_from_start": 0}]})" );
	const Outcome away = audit( { "t.json", "--request", "request.yaml" } );
	EXPECT_EQ( away.status, 1 );
	EXPECT_TRUE( contains( away.out, "joint shoulder is at -0.9 in its first point and at -1 in the request's start" ) )
	    << away.out;
}

TEST_F( CliTrajectory, TwoStartsOfOneFileMustAgree )
{
	const auto with = [&]( const char* one, const char* other )
	{
		write( "t.json",
		    std::string(
		        R"({"joint_names": ["shoulder", "elbow"], "points": [{"positions": [-0.6, 0], "time_from_start": 0}], )" ) +
		        R"("trajectory_start": {"joint_state": {"name": ["shoulder"], "position": [)" + one + R"(]}}, )" +
		        R"("start_state": {"joint_state": {"name": ["shoulder"], "position": [)" + other + "]}}}" );
		return audit( { "t.json" } );
	};
	EXPECT_EQ( with( "-0.6", "-0.6" ).status, 0 );
	for ( const Outcome& outcome : { with( "-0.6", "0.9" ), with( "0.9", "-0.6" ) } )
	{
		EXPECT_EQ( outcome.status, 2 );
		EXPECT_TRUE( contains( outcome.err, "trajectory_start" ) && contains( outcome.err, "start_state" ) ) << outcome.err;
	}
	for ( const char* state :
	    { "[1, 2]", "5", R"({"joint_state": ["shoulder"]})", R"({"joint_state": {"name": [], "position": [1]}})" } )
	{
		write( "t.json",
		    std::string(
		        R"({"joint_names": ["shoulder", "elbow"], "points": [{"positions": [-0.6, 0], "time_from_start": 0}], "trajectory_start": )" ) +
		        state + "}" );
		EXPECT_EQ( audit( { "t.json" } ).status, 2 ) << state;
	}
	write( "t.json",
	    R"({"joint_names": ["shoulder", "elbow"], "points": [{"positions": [-0.6, 0], "time_from_start": 0}], "trajectory_start":
		{"joint_state": {"name": ["shoulder"], "position": [-0.6], "velocity": [0.1]}}})" );
	EXPECT_TRUE( contains( audit( { "t.json" } ).err, "trajectory_start.joint_state.velocity" ) );
}

TEST_F( CliTrajectory, FlagsOfJointLimitsAreBooleansOrErrors )
{
	write( "t.csv", "time,shoulder,elbow\n0,-0.6,0\n1,-0.5,0\n" );
	const auto with = [&]( const std::string& limits )
	{
		write( "limits.yaml", "joint_limits:\n  shoulder:\n" + limits );
		return audit( { "t.csv", "--joint-limits", "limits.yaml" } );
	};
	for ( const char* word : { "true", "True", "TRUE", "yes", "Yes", "on", "y", "Y" } )
	{
		EXPECT_EQ( with( std::string( "    has_velocity_limits: " ) + word + "\n    max_velocity: 0.01\n" ).status, 1 )
		    << word;
	}
	for ( const char* word : { "false", "no", "off", "n" } )
	{
		EXPECT_EQ( with( std::string( "    has_velocity_limits: " ) + word + "\n    max_velocity: 0.01\n" ).status, 0 )
		    << word;
	}
	for ( const char* word : { "tru", "1", "yES", "", "[true]", "2" } )
	{
		const Outcome outcome = with( std::string( "    has_velocity_limits: " ) + word + "\n    max_velocity: 0.01\n" );
		EXPECT_EQ( outcome.status, 2 ) << word;
		EXPECT_TRUE( contains( outcome.err, "joint_limits.shoulder.has_velocity_limits (line 3)" ) ) << outcome.err;
	}
	EXPECT_TRUE(
	    contains( with( "    has_velocity_limit: true\n    max_velocity: 0.01\n" ).err, "is has_velocity_limits meant?" ) );
	EXPECT_TRUE(
	    contains( with( "    has_velocity_limits: true\n    max_velocty: 0.01\n" ).err, "is max_velocity meant?" ) );
	EXPECT_TRUE( contains( with( "    max_velocity: 0.01\n" ).err, "there is no has_velocity_limits" ) );
	EXPECT_TRUE( contains( with( "    has_effort_limits: true\n    max_effort: 0.01\n" ).err, "max_effort (line 4)" ) );
	EXPECT_EQ( with( "    has_jerk_limits: true\n    max_jerk: 0.01\n" ).err, "" );
	EXPECT_EQ( with( "    true\n" ).status, 2 );
	write( "limits.yaml", "joint_limits:\n  sholder:\n    has_velocity_limits: true\n    max_velocity: 0.01\n" );
	EXPECT_TRUE( contains( audit( { "t.csv", "--joint-limits", "limits.yaml" } ).err, "joint_limits.sholder" ) );
}

TEST_F( CliTrajectory, NumbersOfTablesHaveTheBoundOfAllOthers )
{
	for ( const char* row : { "0,2e15,0", "2e15,0,0", "0,-1e308,0" } )
	{
		write( "t.csv", std::string( "time,shoulder,elbow\n" ) + row + "\n" );
		const Outcome outcome = audit( { "t.csv" } );
		EXPECT_EQ( outcome.status, 2 ) << row;
		EXPECT_TRUE( contains( outcome.err, "line 2" ) && contains( outcome.err, "is beyond 1e+15" ) ) << outcome.err;
	}
}

TEST_F( CliTrajectory, PointsOfPathsHaveTheFieldsOfPoints )
{
	const auto with = [&]( const std::string& more )
	{
		write( "p.yaml", "joint_names: [shoulder, elbow]\npoints:\n- positions: [-1, 0]\n- positions: [-0.9, 0]\n" + more );
		return runModel( "audit", { "--path", "p.yaml" }, "blocked.yaml" );
	};
	EXPECT_EQ( with( "" ).status, 0 );
	EXPECT_TRUE( contains( with( "  velocites: [1, 1]\n" ).err,
	    "points[1].velocites (line 5): trajectory_msgs/JointTrajectoryPoint has no such field: is velocities meant?" ) );
	EXPECT_EQ( with( "  speed: 1\n" ).status, 2 );
	EXPECT_TRUE( contains( with( "  effort: [1, 1]\n" ).err, "points[1].effort" ) );
	for ( const char* field : { "velocities: [1, 1]", "accelerations: [1, 1]", "time_from_start: 2" } )
	{
		EXPECT_TRUE( contains( with( std::string( "  " ) + field + "\n" ).err, "a path has straight edges" ) ) << field;
	}
	write( "p.yaml", "joint_names: [shoulder, elbow]\nstart_state: {joint_state: 3}\npoints: [[-1, 0]]\n" );
	EXPECT_EQ( runModel( "audit", { "--path", "p.yaml" } ).status, 2 );
}
