// SPDX-License-Identifier: BSD-3-Clause
// Messages in files of motions and problems: misspelt fields, odd times and numbers, keys that are there twice, meanings of ROS. Each field by itself:
// fields_test.cpp.
#include "cli_fixture.hpp"

#include <nlohmann/json.hpp>

using Json = nlohmann::json;

namespace
{

const char* const point =
    R"({"positions": [-0.6, 0], "velocities": [], "accelerations": [], "effort": [], "time_from_start": {"sec": 0, "nanosec": 0}})";

Json timedMessage()
{
	Json out = Json::parse(
	    R"({"header": {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": ""}, "joint_names": ["shoulder", "elbow"]})" );
	out["points"] = { Json::parse( point ), Json::parse( point ) };
	out["points"][1]["positions"][0] = -0.5;
	out["points"][1]["time_from_start"]["sec"] = 1;
	return out;
}

const char* const multi_dof = R"({"header": {"frame_id": ""}, "joint_names": [], "points": []})";

Json robotState()
{
	return Json::parse(
	    R"({"joint_state": {"header": {"frame_id": ""}, "name": ["shoulder", "elbow"], "position": [-0.6, 0], "velocity": [], "effort": []},
		"multi_dof_joint_state": {"header": {"frame_id": ""}, "joint_names": [], "transforms": [], "twist": [], "wrench": []},
		"attached_collision_objects": [], "is_diff": false})" );
}

Json displayTrajectory()
{
	return { { "model_id", "" },
	    { "trajectory", Json::array( { { { "joint_trajectory", timedMessage() },
	                        { "multi_dof_joint_trajectory", Json::parse( multi_dof ) } } } ) },
	    { "trajectory_start", robotState() } };
}

const char* const tolerance = R"({"name": "shoulder", "position": 0.01, "velocity": 0, "acceleration": 0})";

Json goal()
{
	return { { "trajectory", timedMessage() }, { "multi_dof_trajectory", Json::parse( multi_dof ) },
	    { "path_tolerance", { Json::parse( tolerance ) } }, { "component_path_tolerance", Json::array() },
	    { "goal_tolerance", Json::array() }, { "component_goal_tolerance", Json::array() },
	    { "goal_time_tolerance", { { "sec", 0 }, { "nanosec", 0 } } } };
}

const char* const attached_pole =
    R"([{"link_name": "fore", "object": {"id": "pole", "primitives": [{"type": 1, "dimensions": [0.02, 0.02, 2]}],
	"primitive_poses": [{"position": {"x": 0.4, "y": 0, "z": 0}, "orientation": {"x": 0, "y": 0, "z": 0, "w": 1}}]}, "touch_links": ["tool"]}])";

/// Of an audit, without times of the clock.
Json reportOf( const std::string& text )
{
	Json json = Json::parse( text )["audit"];
	for ( const char* clock : { "proof_seconds", "seconds" } )
	{
		json.erase( clock );
	}
	return json;
}

} // namespace

class CliMessages : public Cli
{
protected:
	struct Answer
	{
		int status = 0;
		std::string err;
		Json report;
		bool operator==( const Answer& other ) const
		{
			return status == other.status && err == other.err && report == other.report;
		}
	};
	Answer audit( const Json& message ) const
	{
		write( "t.json", message.dump() );
		const Outcome outcome = runModel( "audit", { "--trajectory", "t.json", "--report", "r.json" }, "blocked.yaml" );
		return { outcome.status, outcome.err, outcome.status == 2 ? Json() : reportOf( readFile( path( "r.json" ) ) ) };
	}
};

TEST_F( CliMessages, TheJointBetweenWorldAndRobotMayStandAtTheIdentity )
{
	Json message = displayTrajectory();
	const Answer before = audit( message );
	for ( const char* transform : { R"([{"translation": [0, 0, 0], "rotation": [0, 0, 0, 1]}])",
	          R"([{"translation": {"x": 0, "y": 0, "z": 0}, "rotation": {"x": 0, "y": 0, "z": 0, "w": 1}}])" } )
	{
		message["trajectory_start"]["multi_dof_joint_state"]["joint_names"] = { "virtual_joint" };
		message["trajectory_start"]["multi_dof_joint_state"]["transforms"] = Json::parse( transform );
		EXPECT_TRUE( audit( message ) == before ) << transform << audit( message ).err;
	}
}

TEST_F( CliMessages, MisspeltFieldsAreNamedWithTheFieldThatIsMeant )
{
	for ( const auto& [pointer, wrong, meant] : { std::tuple( "/points/0", "velocites", "velocities" ),
	          std::tuple( "/points/1", "time_from_strat", "time_from_start" ),
	          std::tuple( "/points/0", "postions", "positions" ), std::tuple( "", "joint_name", "joint_names" ),
	          std::tuple( "/points/0/time_from_start", "nanosecs", "nanosec" ) } )
	{
		Json message = timedMessage();
		message[Json::json_pointer( pointer )][wrong] = Json::array();
		const Answer answer = audit( message );
		EXPECT_EQ( answer.status, 2 ) << wrong;
		EXPECT_TRUE( contains( answer.err, wrong ) && contains( answer.err, std::string( "is " ) + meant + " meant?" ) )
		    << answer.err;
	}
}

TEST_F( CliMessages, OddTimesAndNumbersAreLocatedErrors )
{
	const auto expect = [&]( const std::string& at, const char* value, const std::string& word )
	{
		Json message = timedMessage();
		message[Json::json_pointer( at )] = Json::parse( value );
		const Answer answer = audit( message );
		EXPECT_EQ( answer.status, 2 ) << at << " " << value;
		EXPECT_TRUE( contains( answer.err, word ) && !contains( answer.err, "internal" ) )
		    << at << " " << value << ": " << answer.err;
	};
	for ( const char* time :
	    { R"({"sec": 1, "nanosec": 2000000000})", R"({"sec": -1, "nanosec": 0})", R"({"sec": 1, "nanosec": -1})",
	        R"({"sec": 1.5})", R"({"sec": 18446744073709551616})", R"({"sec": 1, "nanosec": 0.5})",
	        R"({"sec": 1, "secs": 2})", R"({"nanosec": 1, "nsecs": 1})", R"({"second": 1})", "\"soon\"", "-1", "1e300" } )
	{
		expect( "/points/1/time_from_start", time, "points[1].time_from_start" );
	}
	for ( const char* number : { "1e308", "-1e308", "1e16", "\"x\"", "null" } )
	{
		expect( "/points/1/positions/0", number, "points[1].positions[0]" );
	}
	expect( "/points/1/velocities", "[1e308, 0]", "points[1].velocities[0]" );
}

/// A limit that is misspelt, or switched on by a word that is no true, would be a limit less.
TEST_F( CliMessages, JointLimitsAreDropped )
{
	write( "t.json", timedMessage().dump() );
	const auto said = [&]( const std::string& text )
	{
		write( "l.yaml", text );
		const Outcome outcome = runModel( "audit", { "--trajectory", "t.json", "--joint-limits", "l.yaml" } );
		return std::to_string( outcome.status ) + " " + outcome.err;
	};
	const std::string on = "joint_limits:\n  shoulder:\n    has_velocity_limits: true\n    max_velocity: 0.001\n";
	EXPECT_EQ( said( on ).substr( 0, 2 ), "1 " );
	for ( const char* yes : { "yes", "True", "TRUE", "on" } )
	{
		EXPECT_EQ(
		    said( "joint_limits: {shoulder: {has_velocity_limits: " + std::string( yes ) + ", max_velocity: 0.001}}\n" )
		        .substr( 0, 2 ),
		    "1 " );
	}
	for ( const auto& [text, problem] :
	    { std::pair( std::string( "joint_limits: {shoulder: {has_velocity_limits: maybe}}\n" ), "neither true nor false" ),
	        std::pair( std::string( "joint_limits: {shoulder: {has_velocity_limits: [[1]]}}\n" ), "neither true nor false" ),
	        std::pair(
	            std::string( "joint_limits: {shoulder: {has_velocity_limit: true}}\n" ), "is has_velocity_limits meant?" ),
	        std::pair( std::string( "joint_limits: {shoulder: {zebra: 1}}\n" ), "zebra" ),
	        std::pair( std::string( "joint_limits: {shoulder: 3}\n" ), "is no map" ),
	        std::pair(
	            std::string( "joint_limits: {shoulder: {has_velocity_limits: false, max_velocity: x}}\n" ), "max_velocity" ),
	        std::pair( on + "zebra: 1\n", "zebra" ), std::pair( on + "---\n" + on, "several YAML documents" ),
	        std::pair(
	            std::string( "joint_limits: {shoulder: {max_velocity: x}}\n" ), "there is no has_velocity_limits" ) } )
	{
		const std::string told = said( text );
		EXPECT_TRUE( told.substr( 0, 2 ) == "2 " && contains( told, problem ) && contains( told, "l.yaml" ) )
		    << text << told;
	}
	EXPECT_TRUE( contains( said( on + "    has_position_limits: true\n" ), "has_position_limits (line 5): is not used" ) );
	EXPECT_TRUE( contains( said( "joint_limits: {shoulder: {has_velocity_limits: false, max_velocity: 3}}\n" ),
	    "has_velocity_limits is not true" ) );
	EXPECT_FALSE( contains( said( on + "    has_acceleration_limits: false\n    max_acceleration: 0\n" ), "notice" ) );
}

TEST_F( CliMessages, DocumentsAfterTheFirstAreDropped )
{
	const std::string points = "joint_names: [shoulder, elbow]\npoints: [[-0.6, 0], [-0.5, 0]]\n";
	write( "p.yaml", points );
	EXPECT_EQ( runModel( "audit", { "--path", "p.yaml" } ).status, 0 );
	write( "p.yaml", points + "---\n" + points );
	EXPECT_TRUE( contains( runModel( "audit", { "--path", "p.yaml" } ).err, "is one of 2 YAML documents" ) );
	const std::string one = timedMessage().dump();
	for ( const std::string& text : { one + one, one + "\n" + one, one + "\n--- " + one, one + "\n...\n" + one } )
	{
		write( "t.json", text );
		const Outcome outcome = runModel( "audit", { "--trajectory", "t.json" } );
		EXPECT_TRUE( outcome.status == 2 && contains( outcome.err, "document" ) ) << text << outcome.err;
	}
	write( "t.json", "---\n" + one + "\n---\n" ); // as ros2 topic echo ends
	EXPECT_NE( runModel( "audit", { "--trajectory", "t.json" } ).status, 2 );
	write( "t.csv", "time,shoulder,elbow\n0,-0.6,0\n1,-1e308,0\n" );
	const Outcome far = runModel( "audit", { "--trajectory", "t.csv" } );
	EXPECT_TRUE( far.status == 2 && contains( far.err, "line 3" ) && contains( far.err, "beyond 1e+15" ) ) << far.err;
}

TEST_F( CliMessages, KeysThatAreThereTwiceAreErrorsWithBothLines )
{
	write( "t.yaml",
	    "joint_names: [shoulder, elbow]\npoints:\n- positions: [-0.6, 0]\n  time_from_start: 0\n- positions: [-0.5, 0]\n"
	    "  time_from_start: 1\n  positions: [0.9, 0]\n" );
	write( "p.yaml", "joint_names: [shoulder, elbow]\nmin_d: 0.5\npoints: [[0, 0], [0.1, 0]]\nmin_d: 0\n" );
	write( "l.yaml", "joint_limits:\n  shoulder: {has_velocity_limits: true, max_velocity: 1,\n    max_velocity: 9}\n" );
	write( "s.yaml", "- attach: wall\n  link: fore\n  link: upper\n" );
	for ( const auto& [option, file, key, lines] :
	    { std::tuple( "--trajectory", "t.yaml", "positions", std::pair( "line 7", "line 5" ) ),
	        std::tuple( "--path", "p.yaml", "min_d", std::pair( "line 4", "line 2" ) ),
	        std::tuple( "--steps", "s.yaml", "link", std::pair( "line 3", "line 2" ) ) } )
	{
		const Outcome outcome = runModel( "audit", { option, file } );
		EXPECT_EQ( outcome.status, 2 ) << file;
		EXPECT_TRUE( contains( outcome.err, file ) && contains( outcome.err, key ) && contains( outcome.err, lines.first ) &&
		             contains( outcome.err, lines.second ) )
		    << outcome.err;
	}
	write( "t.json", timedMessage().dump() );
	EXPECT_EQ( runModel( "audit", { "--trajectory", "t.json", "--joint-limits", "l.yaml" } ).status, 2 );
	edit( "t.json", R"("joint_names")", R"("joint_names": ["elbow", "shoulder"], "joint_names")" );
	const Outcome twice = runModel( "audit", { "--trajectory", "t.json" } );
	EXPECT_TRUE( twice.status == 2 && contains( twice.err, "joint_names" ) && contains( twice.err, "twice" ) ) << twice.err;
	edit( "request.yaml", "allowed_planning_time: 30\n", "allowed_planning_time: 30\nallowed_planning_time: 1\n" );
	const Outcome request = runModel( "plan", { "--request", "request.yaml" } );
	EXPECT_TRUE( request.status == 2 && contains( request.err, "line 3" ) && contains( request.err, "line 4" ) )
	    << request.err;
}

TEST_F( CliMessages, MeaningsThatRosHasAreNotReplacedByOthers )
{
	Json accelerated = timedMessage();
	accelerated["points"][0]["accelerations"] = accelerated["points"][1]["accelerations"] = { 0.1, 0 };
	EXPECT_TRUE( contains( audit( accelerated ).err, "accelerations and no velocities" ) );
	for ( const auto& [value, word] :
	    { std::pair( 0.0, "controller's own tolerance" ), std::pair( -1.0, "deviate as far as it likes" ) } )
	{
		Json message = goal();
		message["path_tolerance"][0]["position"] = value;
		const Answer answer = audit( message );
		EXPECT_TRUE( answer.status == 2 && contains( answer.err, word ) && contains( answer.err, "--tolerance shoulder" ) )
		    << answer.err;
		EXPECT_EQ(
		    runModel( "audit", { "--trajectory", "t.json", "--tolerance", "shoulder=0.01" }, "blocked.yaml" ).status, 0 );
	}
	Json away = displayTrajectory();
	away["trajectory_start"]["joint_state"]["position"] = { 0.3, 0 };
	const Answer answer = audit( away );
	EXPECT_EQ( answer.status, 1 );
	EXPECT_TRUE(
	    contains( answer.report.dump(), "joint shoulder is at -0.6 in its first point and at 0.3 in its start state" ) )
	    << answer.report.dump();
	Json beyond = timedMessage();
	beyond["trajectory_start"] = robotState();
	beyond["trajectory_start"]["joint_state"]["position"] = { -0.6, 9 };
	EXPECT_TRUE( contains( audit( beyond ).err, "elbow" ) );
}

TEST_F( CliMessages, APathFileWithAnAttachedObjectIsRefused )
{
	ASSERT_EQ( runModel( "plan", { "--goal", "shoulder=0.5", "--out", "p.yaml" } ).status, 0 );
	edit( "p.yaml", "start_state:\n",
	    std::string( "start_state:\n  attached_collision_objects: " ) + Json::parse( attached_pole ).dump() + "\n" );
	const Outcome outcome = runModel( "audit", { "--path", "p.yaml" } );
	EXPECT_EQ( outcome.status, 2 );
	EXPECT_TRUE( contains( outcome.err, "attached_collision_objects" ) && contains( outcome.err, "--scene" ) )
	    << outcome.err;
}

TEST_F( CliMessages, APlanWithMoreTimeThanTheClockCountsIsSolved )
{
	EXPECT_EQ(
	    runModel( "plan", { "--request", "request.yaml", "--time", "1e300", "--planner", "RRTConnect" }, "blocked.yaml" )
	        .status,
	    0 );
}

TEST_F( CliMessages, TextsThatReadersTakeDifferentlyAreErrors )
{
	const std::string good =
	    "joint_names: [shoulder, elbow]\npoints:\n- positions: [-0.6, 0]\n  time_from_start: 0\n- positions: [-0.5, 0]\n  time_from_start: 1\n";
	const auto with = [&]( const std::string& text )
	{
		write( "t.yaml", text );
		return runModel( "audit", { "--trajectory", "t.yaml" }, "blocked.yaml" );
	};
	const auto instead = [&]( const std::string& from, const std::string& to )
	{
		std::string text = good;
		return with( text.replace( text.find( from ), from.size(), to ) );
	};
	ASSERT_EQ( with( good ).status, 0 );
	EXPECT_EQ( with( good + "---\n" ).status, 0 );
	EXPECT_EQ( with( "--- # one\n" + good ).status, 0 );
	EXPECT_EQ( instead( "[-0.6, 0]", "&start [-0.6, 0]" ).status, 0 );
	EXPECT_EQ( instead( "[-0.6, 0]", "[!!float -0.6, 0]" ).status, 0 );
	// a second motion through the post, behind marks that end the first document
	const std::string second =
	    "joint_names: [shoulder, elbow]\npoints:\n- positions: [-0.5, 0]\n  time_from_start: 0\n- positions: [0.5, 0]\n  time_from_start: 1\n";
	EXPECT_EQ( with( good + "---\n" + second ).status, 1 );
	EXPECT_EQ( with( good + "--- # two\n" + second ).status, 1 );
	for ( const std::string& text : { good + "...\n" + second, good + "--- !!map\n" + second, good + "--- {}\n" + second,
	          good + "... # end\n---\n" + second } )
	{
		EXPECT_TRUE( contains( with( text ).err, "line 7" ) ) << text << with( text ).err;
	}
	EXPECT_TRUE( contains( instead( "[-0.5, 0]", "[!!str -0.5, 0]" ).err, "points[1].positions[0]" ) );
	EXPECT_TRUE( contains( instead( "[-0.5, 0]", "[-010, 0]" ).err, "octal" ) );
	EXPECT_TRUE( contains( instead( "[-0.5, 0]", "[1_0, 0]" ).err, "points[1].positions[0]" ) );
	EXPECT_TRUE( contains( instead( "[-0.5, 0]", "[1:30, 0]" ).err, "points[1].positions[0]" ) );
	EXPECT_TRUE( contains( instead( "[-0.5, 0]", "[.nan, 0]" ).err, "points[1].positions[0]" ) );
	EXPECT_TRUE( contains( instead( "- positions: [-0.5, 0]", "- <<: {positions: [-0.5, 0]}" ).err, "merge keys" ) );
	EXPECT_TRUE( contains( instead( "[shoulder, elbow]", "[shoulder, elbow, elbow]" ).err, "repeated" ) );
	EXPECT_TRUE( contains( instead( "[shoulder, elbow]", "[shoulder]" ).err, "points[0].positions" ) );
	EXPECT_TRUE( contains( instead( "time_from_start: 1", "time_from_start: 0" ).err, "points[1].time_from_start" ) );
	EXPECT_TRUE( contains( instead( "time_from_start: 1", "time_from_start: {sec: 1, secs: 1}" ).err, "secs" ) );
	EXPECT_TRUE( contains( instead( "  time_from_start: 1", "  velocities: [.nan, 0]\n  time_from_start: 1" ).err,
	    "points[1].velocities[0]" ) );
	write( "p.yaml",
	    "joint_names: [shoulder, elbow]\npoints: [[-1, 0], [-0.9, 0]]\n---\njoint_names: [shoulder, elbow]\npoints: [[-1, 0], [1, 0]]\n" );
	EXPECT_TRUE( contains( runModel( "audit", { "--path", "p.yaml" }, "blocked.yaml" ).err, "2 YAML documents" ) );
	write( "s.yaml", "<<: {world: {}}\n" + readFile( path( "blocked.yaml" ) ) );
	EXPECT_TRUE( contains( runModel( "check", { "--states", "states.csv" }, "s.yaml" ).err, "merge keys" ) );
}
