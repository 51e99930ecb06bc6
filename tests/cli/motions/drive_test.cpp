// SPDX-License-Identifier: BSD-3-Clause
// leeway audit --trajectory: which segment and which trajectory an answer is of. The post of blocked.yaml is met at shoulder angles around zero.
#include "cli_fixture.hpp"

#include <nlohmann/json.hpp>

#include <cmath>

namespace
{

class CliDrive : public Cli
{
protected:
	Outcome audit( std::vector<std::string> more )
	{
		more.insert( more.begin(), "--trajectory" );
		return runModel( "audit", more, "blocked.yaml" );
	}
	nlohmann::json report( const std::string& file )
	{
		const Outcome outcome = audit( { file, "--report", "report.json" } );
		EXPECT_NE( outcome.status, 2 ) << outcome.err;
		return nlohmann::json::parse( readFile( path( "report.json" ) ) )["audit"];
	}
	/// One trajectory of a message, of shoulder and elbow: an array of points.
	static std::string part( const std::string& points )
	{
		return R"({"joint_trajectory": {"joint_names": ["shoulder", "elbow"], "points": )" + points + "}}";
	}
	/// A point at rest at that time.
	static std::string point( double shoulder, double time )
	{
		return "{\"positions\": [" + std::to_string( shoulder ) + ", 0], \"time_from_start\": " + std::to_string( time ) +
		       "}";
	}
	static std::string started( double shoulder, const std::string& parts )
	{
		return R"({"trajectory_start": {"joint_state": {"name": ["shoulder", "elbow"], "position": [)" +
		       std::to_string( shoulder ) + ", 0]}}, \"trajectory\": [" + parts + "]}";
	}
};

} // namespace

TEST_F( CliDrive, AViolationIsThatOfAnotherSegment )
{
	// free, then twice through the post
	write( "t.csv", "time,shoulder,elbow\n0,-0.6,0\n1,-0.5,0\n3,0.5,0\n5,-0.6,0\n" );
	const nlohmann::json violation = report( "t.csv" )["violation"];
	const double time = violation["time"];
	EXPECT_GT( time, 1 );
	EXPECT_LT( time, 3 );
	EXPECT_NEAR( violation["state"]["shoulder"].get<double>(), -0.5 + 0.5 * ( time - 1 ), 1e-9 );
}

TEST_F( CliDrive, AViolationIsForgottenAfterTheNextTrajectory )
{
	const std::string blocked = part( "[" + point( -0.6, 0 ) + "," + point( 0.6, 2 ) + "]" );
	const std::string is_free = part( "[" + point( 0.6, 0 ) + "," + point( 0.7, 2 ) + "]" );
	write( "t.json", "{\"trajectory\": [" + blocked + "," + is_free + "]}" );
	EXPECT_EQ( audit( { "t.json" } ).status, 1 );
	EXPECT_EQ( report( "t.json" )["verdict"], "BLOCKED" );
}

TEST_F( CliDrive, AViolatedPositionHidesTheVelocity )
{
	write( "t.csv", "time,shoulder,elbow\n0,-1.9,0\n1,-3.5,0\n" );
	const std::string out = audit( { "t.csv" } ).out;
	EXPECT_TRUE( contains( out, "joint shoulder: position of -3.5" ) ) << out;
	EXPECT_TRUE( contains( out, "joint shoulder: velocity of -1.6" ) || contains( out, "joint shoulder: velocity of 1.6" ) )
	    << out;
}

TEST_F( CliDrive, AContinuousJointHasLimits )
{
	edit( "arm.urdf", "<joint name=\"elbow\" type=\"revolute\">", "<joint name=\"elbow\" type=\"continuous\">" );
	edit( "arm.urdf", "multiplier=\"0.5\"", "multiplier=\"1\"" ); // a whole turn is a whole turn of its follower, too
	for ( const std::string sign : { "", "-" } )
	{
		write( "t.csv", "time,shoulder,elbow\n0,-0.6," + sign + "2.9\n4,-0.6," + sign + "3.5\n4.5,-0.6," + sign + "3.6\n" );
		const std::string out = audit( { "t.csv" } ).out;
		EXPECT_FALSE( contains( out, "position of" ) ) << out;
	}
}

TEST_F( CliDrive, AProfileShowsStatesOfTheNextSegment )
{
	write( "one.csv", "time,shoulder,elbow\n0,-1.5,0\n1,-1.0,0\n" );
	write( "two.csv", "time,shoulder,elbow\n0,-1.5,0\n1,-1.0,0\n2,-0.6,0\n" );
	ASSERT_EQ( audit( { "one.csv", "--profile", "one.p" } ).status, 0 );
	ASSERT_EQ( audit( { "two.csv", "--profile", "two.p" } ).status, 0 );
	const Table one = parseTable( readFile( path( "one.p" ) ) ), two = parseTable( readFile( path( "two.p" ) ) );
	for ( const std::size_t row : { 0u, 20u, 60u } )
	{
		ASSERT_NEAR( one.number( row, "time" ), two.number( row, "time" ), 1e-12 );
		EXPECT_NEAR( one.number( row, "environment" ), two.number( row, "environment" ), 1e-9 ) << row;
	}
}

TEST_F( CliDrive, AProfileOfALaterTrajectoryBeginsAtZero )
{
	const std::string first = part( "[" + point( -1.5, 0 ) + "," + point( -1.0, 1 ) + "]" );
	const std::string second = part( "[" + point( -1.0, 0 ) + "," + point( -0.6, 1 ) + "]" );
	write( "t.json", "{\"trajectory\": [" + first + "," + second + "]}" );
	ASSERT_EQ( audit( { "t.json", "--profile", "p.csv" } ).status, 0 );
	const Table table = parseTable( readFile( path( "p.csv" ) ) );
	for ( std::size_t row = 1; row < table.rows.size(); ++row )
	{
		ASSERT_GE( table.number( row, "time" ), table.number( row - 1, "time" ) ) << row;
	}
	EXPECT_NEAR( table.number( table.rows.size() - 1, "time" ), 2, 1e-9 );
}

TEST_F( CliDrive, AJumpInOneDirectionIsNone )
{
	const std::string motion = part( "[" + point( -0.8, 0 ) + "," + point( -0.7, 1 ) + "]" );
	for ( const double start : { -0.9, -0.7 } )
	{
		write( "t.json", started( start, motion ) );
		const Outcome outcome = audit( { "t.json" } );
		EXPECT_EQ( outcome.status, 1 ) << start;
		EXPECT_TRUE( contains( outcome.out, "joint shoulder is at -0.8" ) ) << outcome.out;
	}
	write( "t.json", started( -0.8, motion ) );
	EXPECT_EQ( audit( { "t.json" } ).status, 0 );
}

TEST_F( CliDrive, TheWayToALateFirstPointBeginsWithItsAcceleration )
{
	// from rest without an acceleration: 2 s^3 (1 - s)^2 of the point's -2.9 rad/s^2, 0.2 rad below at 3/5 of 2 s
	const std::string late =
	    R"([{"positions": [-1.9, 0], "velocities": [0, 0], "accelerations": [-2.9, 0], "time_from_start": 2},
		{"positions": [-1.9, 0], "velocities": [0, 0], "accelerations": [0, 0], "time_from_start": 2.01}])";
	write( "t.json", started( -1.9, part( late ) ) );
	const std::string out = audit( { "t.json" } ).out;
	EXPECT_TRUE( contains( out, "joint shoulder: position of -2.10" ) && contains( out, "1.2000 s is below its limit -2" ) )
	    << out;
}

TEST_F( CliDrive, ACornerIsUnwrappedFromTheFirstPoint )
{
	// away from the post, more than half a turn in all: 1.683 is 4.6 rad from the post's other side
	edit( "arm.urdf", "<joint name=\"shoulder\" type=\"revolute\">", "<joint name=\"shoulder\" type=\"continuous\">" );
	write( "p.yaml",
	    "joint_names: [shoulder, elbow]\npoints: [[-0.6, 0], [-2.6, 0], [" + std::to_string( 2 * M_PI - 4.6 ) + ", 0]]\n" );
	const Outcome outcome =
	    runModel( "audit", { "--path", "p.yaml", "--corner-blend", "0.01", "--report", "r.json" }, "blocked.yaml" );
	ASSERT_NE( outcome.status, 2 ) << outcome.err;
	EXPECT_EQ( nlohmann::json::parse( readFile( path( "r.json" ) ) )["roundings"]["verdict"], "FREE" ) << outcome.out;
}

TEST_F( CliDrive, APlannedTrajectoryIsFasterThanTheLimitsOfTheFile )
{
	write( "limits.yaml",
	    "joint_limits:\n  shoulder: {has_velocity_limits: true, max_velocity: 0.2, has_acceleration_limits: true, max_acceleration: 9}\n"
	    "  elbow: {has_velocity_limits: true, max_velocity: 0.1, has_acceleration_limits: true, max_acceleration: 9}\n" );
	ASSERT_EQ(
	    runModel( "plan",
	        { "--request", "request.yaml", "--out", "path.yaml", "--trajectory", "t.json", "--joint-limits", "limits.yaml" },
	        "blocked.yaml" )
	        .status,
	    0 );
	const Outcome audited = audit( { "t.json", "--joint-limits", "limits.yaml" } );
	EXPECT_EQ( audited.status, 0 ) << audited.out;
}
