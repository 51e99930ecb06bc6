// SPDX-License-Identifier: BSD-3-Clause
// leeway world: two arms and a box on one clock, from outside.
#include "cli_fixture.hpp"

#include <nlohmann/json.hpp>

/// Arms at x = 0 and 1.8, the second turned by half a turn: at zero their tips are 0.2 m apart. A box passes over them.
class CliWorld : public Cli
{
protected:
	void SetUp() override
	{
		Cli::SetUp();
		write( "cell.yaml", world );
		write( "swing.yaml",
		    "joint_names: [shoulder, elbow]\npoints:\n  - {positions: [1.5, 0], time_from_start: 0}\n"
		    "  - {positions: [0, 0], time_from_start: 2}\n  - {positions: [1.5, 0], time_from_start: 4}\n" );
	}
	Outcome ask( const std::string& question, std::vector<std::string> more = {} ) const
	{
		more.insert( more.begin(), { "world", question, "--world", "cell.yaml", "--no-cache" } );
		return run( more );
	}
	/// Of "left - right", at the beginning of a line.
	static double clearanceOf( const Outcome& outcome, const std::string& pair )
	{
		const std::size_t at = outcome.out.find( "\n" + pair + " " );
		return at == std::string::npos ? -9 : std::stod( outcome.out.substr( at + 1 + pair.size() ) );
	}

	const std::string world =
	    "leeway_world: 1\nrobots:\n  - {name: left, robot: arm.urdf, srdf: arm.srdf, motion: swing.yaml}\n"
	    "  - {name: right, robot: arm.urdf, srdf: arm.srdf, base: {position: [1.8, 0, 0], orientation: [0, 0, 1, 0]}}\n"
	    "objects:\n  - {name: box, shapes: [{type: box, dimensions: [0.2, 0.2, 0.2]}], pose: {position: [0, 0, 2]}, motion: [{start: 0, end: 5, position: [2, 0, 2]}]}\n"
	    "scene: scene.yaml\nallowed: [[right/upper, wall], [right/fore, wall], [right/base, wall], [left/base, wall], [left/upper, wall], [left/fore, wall]]\n";
};

TEST_F( CliWorld, ACheckIsOfAnotherTime )
{
	const Outcome first = ask( "check" ), later = ask( "check", { "--time", "2", "--json", "c.json" } );
	ASSERT_EQ( later.status, 0 ) << later.out << later.err;
	EXPECT_NEAR( clearanceOf( later, "left - right" ), 0.2, 1e-6 ) << later.out;
	EXPECT_GT( clearanceOf( first, "left - right" ), 0.6 ) << first.out;
	// the arms' upper side is at 0.025, at least
	EXPECT_NEAR( clearanceOf( later, "box - left" ), 2 - 0.1 - 0.025, 0.1 ) << later.out;
	const nlohmann::json json = nlohmann::json::parse( readFile( path( "c.json" ) ) );
	EXPECT_EQ( json["time"], 2 );
	EXPECT_EQ( json["state"]["left/shoulder"], 0 );
	EXPECT_NEAR( json["state"]["box/x"].get<double>(), 0.8, 1e-12 );
	EXPECT_EQ( ask( "check", { "--time", "2", "--min-d", "0.25" } ).status, 1 );
}

TEST_F( CliWorld, AnAuditEndsBeforeTheMotions )
{
	const Outcome free = ask( "audit", { "--json", "a.json" } );
	ASSERT_EQ( free.status, 0 ) << free.out << free.err;
	EXPECT_TRUE( contains( free.out, "0 to 5 s" ) && contains( free.out, "proved" ) && contains( free.out, "\nvalid\n" ) )
	    << free.out;
	const nlohmann::json json = nlohmann::json::parse( readFile( path( "a.json" ) ) );
	EXPECT_EQ( json["audit"]["verdict"], "FREE" );
	EXPECT_GT( json["audit"]["lower_bound"].get<double>(), 0 );
	const Outcome near = ask( "audit", { "--min-d", "0.25", "--first-contact", "--json", "b.json" } );
	EXPECT_EQ( near.status, 1 ) << near.out << near.err;
	EXPECT_TRUE( contains( near.out, "BLOCKED" ) && contains( near.out, "left/fore" ) && contains( near.out, "right/fore" ) )
	    << near.out;
	const nlohmann::json blocked = nlohmann::json::parse( readFile( path( "b.json" ) ) );
	const double time = blocked["audit"]["violation"]["time"];
	EXPECT_TRUE( time > 1 && time < 2 ) << time;
	EXPECT_GE( blocked["audit"]["proved_until"].get<double>(), time - 2e-3 );
	EXPECT_EQ( ask( "audit", { "--min-d", "0.25", "--to", "1" } ).status, 0 );
	EXPECT_EQ( ask( "audit", { "--min-d", "0.25", "--from", "3.5" } ).status, 0 );
}

TEST_F( CliWorld, AnEdgeForgetsTheMotionsOfOthers )
{
	write( "edges.csv", "start,end,from:right/shoulder,to:right/shoulder\n3.5,5,0,1\n0,2,1.2,-0.6\n1,3,0,0.01\n" );
	const Outcome outcome = ask( "edge", { "--edges", "edges.csv", "--min-d", "0.25" } );
	EXPECT_EQ( outcome.status, 1 ) << outcome.err;
	const Table table = parseTable( outcome.out );
	ASSERT_EQ( table.rows.size(), 3u ) << outcome.out;
	EXPECT_EQ( table.rows[0].at( "verdict" ), "FREE" );
	EXPECT_EQ( table.rows[2].at( "verdict" ), "BLOCKED" ) << "the left arm comes";
	EXPECT_TRUE( table.number( 2, "time" ) > 1 && table.number( 2, "time" ) < 2.1 );
	write( "edges.csv", "start,end,from:right/shouldr,to:right/shouldr\n0,1,0,1\n" );
	EXPECT_TRUE( contains(
	    ask( "edge", { "--edges", "edges.csv" } ).err, "column 'from:right/shouldr': names no joint of the world" ) );
	write( "edges.csv", "start,end,from:right/elbow\n0,1,0\n" );
	EXPECT_TRUE( contains( ask( "edge", { "--edges", "edges.csv" } ).err, "there is no column 'to:right/elbow'" ) );
	write( "edges.csv", "start,end,from:right/elbow,to:right/elbow\n1,1,0,1\n" );
	EXPECT_TRUE( contains( ask( "edge", { "--edges", "edges.csv" } ).err, "line 2: begins at 1 s and ends at 1 s" ) );
}

TEST_F( CliWorld, OptionsOfAnotherQuestionAreIgnored )
{
	const auto error = [&]( const std::string& question, const std::vector<std::string>& more )
	{
		const Outcome outcome = ask( question, more );
		EXPECT_EQ( outcome.status, 2 ) << question;
		return outcome.err;
	};
	EXPECT_TRUE( contains( error( "check", { "--to", "1" } ), "--to: has no meaning for leeway world check" ) );
	EXPECT_TRUE( contains( error( "audit", { "--time", "1" } ), "--time: has no meaning for leeway world audit" ) );
	EXPECT_TRUE( contains( error( "edge", {} ), "--edges: is missing" ) );
	EXPECT_TRUE( contains( error( "audit", { "--from", "2", "--to", "1" } ), "--to: 1 s is before --from 2 s" ) );
	EXPECT_TRUE( contains( error( "frobnicate", {} ), "leeway world frobnicate: is no question" ) );
	EXPECT_TRUE( contains( run( { "world", "audit" } ).err, "--world is required" ) );
	EXPECT_TRUE( contains( run( { "world", "audit", "--world", "arm.urdf" } ).err, "this is a URDF" ) );
	EXPECT_TRUE( contains( run( { "check", "--robot", "arm.urdf", "--scene", "cell.yaml", "--states", "states.csv" } ).err,
	    "this is a world file" ) );
}

TEST_F( CliWorld, AWorldIsRefusedAsARobot )
{
	write( "states.csv", "left/shoulder,right/shoulder,box/x\n0,0,1\n0.2,-0.2,1\n" );
	const Outcome outcome =
	    run( { "check", "--robot", "cell.yaml", "--states", "states.csv", "--what", "self", "--no-cache" } );
	ASSERT_EQ( outcome.status, 0 ) << outcome.err;
	EXPECT_NEAR( parseTable( outcome.out ).number( 0, "self_lower" ), 0.2, 1e-6 );
	EXPECT_TRUE( contains( outcome.err, "scene.yaml is no part of the robot" ) ) << outcome.err;
	const Outcome plan = run( { "plan", "--robot", "cell.yaml", "--group", "right", "--goal", "right/shoulder=0.5",
	    "--no-cache", "--out", "p.yaml" } );
	EXPECT_EQ( plan.status, 0 ) << plan.err;
}

/// Results must not take the place of a motion.
TEST_F( CliWorld, AResultReplacesAMotion )
{
	const Outcome outcome = ask( "audit", { "--json", "swing.yaml" } );
	EXPECT_EQ( outcome.status, 2 );
	EXPECT_TRUE( contains( outcome.err, "swing.yaml" ) ) << outcome.err;
	EXPECT_TRUE( contains( readFile( path( "swing.yaml" ) ), "joint_names" ) );
}

TEST_F( CliWorld, ATrajectoryIsAnotherPlan )
{
	const Outcome plan = ask( "plan",
	    { "--goal", "right=shoulder=0.4,elbow=0.2", "--deadline", "9", "--out", path( "motions" ), "--json", "p.json" } );
	ASSERT_EQ( plan.status, 0 ) << plan.out << plan.err;
	const nlohmann::json json = nlohmann::json::parse( readFile( path( "p.json" ) ) );
	EXPECT_EQ( json["outcome"], "solved" );
	const double arrival = json["arrivals"]["right"];
	EXPECT_TRUE( arrival > 0 && arrival <= 9 ) << arrival;
	const nlohmann::json trajectory = nlohmann::json::parse( readFile( path( "motions/right.json" ) ) );
	const nlohmann::json last = trajectory["joint_trajectory"]["points"].back();
	EXPECT_EQ( last["time_from_start"], arrival );
	EXPECT_EQ( last["positions"], ( std::vector<double>{ 0.4, 0.2 } ) );
	const Outcome audit = ask( "audit", { "--motion", "right=" + path( "motions/right.json" ) } );
	EXPECT_EQ( audit.status, 0 ) << audit.out << audit.err;
	// the same arms, each planned beside the other's motion
	const Outcome both = ask( "plan",
	    { "--goal", "right=shoulder=0.4", "--goal", "left=shoulder=1.2", "--deadline", "20", "--together", "--seed", "3" } );
	EXPECT_EQ( both.status, 0 ) << both.out << both.err;
}

TEST_F( CliWorld, PlanWithOthersIsAnotherPlan )
{
	ASSERT_EQ( ask( "plan", { "--goal", "right=shoulder=0.4,elbow=0.2", "--deadline", "9", "--out", path( "a" ), "--seconds",
	                            "5", "--seed", "2" } )
	               .status,
	    0 );
	const Outcome plan = run( { "plan", "--others=cell.yaml", "--goal", "right=shoulder=0.4,elbow=0.2", "--deadline", "9",
	    "--out", path( "b" ), "--time", "5", "--seed", "2", "--report", "b.json", "--no-cache" } );
	ASSERT_EQ( plan.status, 0 ) << plan.out << plan.err;
	EXPECT_EQ( readFile( path( "b/right.json" ) ), readFile( path( "a/right.json" ) ) );
	EXPECT_EQ( nlohmann::json::parse( readFile( path( "b.json" ) ) )["outcome"], "solved" );
	// options of other plans are told, and so is a deadline of these
	const Outcome robot = run( { "plan", "--others", "cell.yaml", "--robot", "arm.urdf", "--goal", "right=shoulder=0.4" } );
	EXPECT_EQ( robot.status, 2 );
	EXPECT_TRUE( contains( robot.err, "--robot" ) ) << robot.err;
	const Outcome deadline = runModel( "plan", { "--goal", "shoulder=0.1", "--deadline", "9" } );
	EXPECT_EQ( deadline.status, 2 );
	EXPECT_TRUE( contains( deadline.err, "add --others" ) ) << deadline.err;
}

// MoveIt's SRDFs have a floating joint between the world and an arm that is bolted down.
TEST_F( CliWorld, ABaseIsPlannedLikeAJoint )
{
	write( "base.srdf", readFile( path( "arm.srdf" ) ) );
	edit( "base.srdf", "</robot>",
	    "<virtual_joint name='base_joint' type='floating' parent_frame='map' child_link='base'/></robot>" );
	edit( "cell.yaml", "srdf: arm.srdf, base:", "srdf: base.srdf, base:" );
	const Outcome plan =
	    ask( "plan", { "--goal", "right=shoulder=0.4,elbow=0.2", "--deadline", "9", "--out", path( "motions" ) } );
	ASSERT_EQ( plan.status, 0 ) << plan.out << plan.err;
	EXPECT_FALSE( contains( readFile( path( "motions/right.json" ) ), "base_joint" ) );
	EXPECT_EQ( ask( "audit", { "--motion", "right=" + path( "motions/right.json" ) } ).status, 0 );
	const Outcome moved = ask( "plan", { "--goal", "right=base_joint/trans_x=0.4", "--deadline", "9" } );
	EXPECT_EQ( moved.status, 2 );
	EXPECT_TRUE( contains( moved.err, "right/base_joint/trans_x: has no velocity limit" ) ) << moved.err;
}

// The elbow is not in the group: it stands, whatever its limits are, and no goal moves it.
TEST_F( CliWorld, APlanMovesJointsOutsideOfTheGroup )
{
	edit( "cell.yaml", "srdf: arm.srdf, base:", "srdf: arm.srdf, group: shoulder_only, state: {elbow: 0.3}, base:" );
	const Outcome plan = ask( "plan", { "--goal", "right=shoulder=0.4", "--deadline", "9", "--out", path( "motions" ) } );
	ASSERT_EQ( plan.status, 0 ) << plan.out << plan.err;
	EXPECT_FALSE( contains( readFile( path( "motions/right.json" ) ), "elbow" ) );
	EXPECT_EQ( ask( "audit", { "--motion", "right=" + path( "motions/right.json" ) } ).status, 0 );
	const Outcome moved = ask( "plan", { "--goal", "right=elbow=0.4", "--deadline", "9" } );
	EXPECT_EQ( moved.status, 2 );
	EXPECT_TRUE( contains( moved.err, "right/elbow: is not in the group shoulder_only, and the goal moves it" ) )
	    << moved.err;
}

TEST_F( CliWorld, AMissingGoalIsNotNamed )
{
	const auto error = [&]( const std::vector<std::string>& more )
	{
		const Outcome outcome = ask( "plan", more );
		EXPECT_EQ( outcome.status, 2 ) << outcome.out;
		return outcome.err;
	};
	EXPECT_TRUE( contains( error( { "--deadline", "9" } ), "--goal: is missing" ) );
	EXPECT_TRUE( contains( error( { "--goal", "right=shoulder=1" } ), "--deadline: is missing" ) );
	// as --goal of leeway plan says it
	EXPECT_TRUE( contains( error( { "--goal", "right=sholder=1", "--deadline", "9" } ), "use right/shoulder" ) );
	EXPECT_TRUE( contains( error( { "--goal", "right=left/shoulder=1", "--deadline", "9" } ), "no such joint" ) );
	EXPECT_TRUE( contains( error( { "--goal", "right=shoulder=x", "--deadline", "9" } ), "'x' is not a finite number" ) );
	EXPECT_TRUE( contains( error( { "--goal", "right=shoulder", "--deadline", "9" } ), "right/shoulder" ) );
	EXPECT_TRUE(
	    contains( error( { "--goal", "right=elbow=1,shoulder", "--deadline", "9" } ), "'shoulder' is not joint=value" ) );
	EXPECT_TRUE(
	    contains( error( { "--goal", "right=shoulder=1,right/shoulder=2", "--deadline", "9" } ), "is given twice" ) );
	EXPECT_TRUE( contains( error( { "--goal", "right=finger_joint=1", "--deadline", "9" } ), "follows joint right/elbow" ) );
	EXPECT_TRUE( contains( error( { "--goal", "box=x=1", "--deadline", "9" } ), "box" ) );
	EXPECT_TRUE( contains( error( { "--goal", "rihgt=shoulder=1", "--deadline", "9" } ), "rihgt" ) );
	EXPECT_TRUE( contains( ask( "audit", { "--motion", "rihgt=swing.yaml" } ).err, "is no robot of the world" ) );
	const Outcome late = ask( "plan", { "--goal", "right=shoulder=1", "--deadline", "0.01" } );
	EXPECT_EQ( late.status, 1 );
	EXPECT_TRUE( contains( late.out, "full speed" ) ) << late.out;
}
