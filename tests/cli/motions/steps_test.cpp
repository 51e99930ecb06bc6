// SPDX-License-Identifier: BSD-3-Clause
// leeway audit --steps. A cup stands beyond the tip of the arm at a shoulder angle of -1: the arm alone passes the wall of the scene, the
// cup on its stretched arm does not.
#include "cli_fixture.hpp"

#include <nlohmann/json.hpp>

#include <cmath>

class CliSteps : public Cli
{
protected:
	void SetUp() override
	{
		Cli::SetUp();
		std::string scene = readFile( path( "scene.yaml" ) );
		scene += "    - id: cup\n      primitives:\n        - type: box\n          dimensions: [0.1, 0.1, 0.1]\n"
		         "      primitive_poses:\n        - position: [" +
		         std::to_string( 0.88 * std::cos( -1 ) ) + ", " + std::to_string( 0.88 * std::sin( -1 ) ) +
		         ", 0]\n          orientation: [0, 0, 0, 1]\n";
		write( "cup.yaml", scene );
		write( "reach.csv", "time,shoulder,elbow\n0,-0.6,0\n1,-1,0\n" );
		write( "swing.csv", "time,shoulder,elbow\n0,-1,0\n3,1,0\n" );
		write( "back.csv", "time,shoulder,elbow\n0,-1,0\n1,-1.4,0\n" );
		write( "fold.csv", "time,shoulder,elbow\n0,-1,0\n3,-1,1.5\n" );
		write( "turn.csv", "time,shoulder\n0,-1\n3,1\n" ); // of the group shoulder_only
	}

	Outcome audit( const std::string& steps, std::vector<std::string> more = {} )
	{
		write( "steps.yaml", "steps:\n" + steps );
		more.insert( more.begin(), { "--steps", "steps.yaml" } );
		return runModel( "audit", more, "cup.yaml" );
	}
	nlohmann::json report( const std::string& steps )
	{
		const Outcome outcome = audit( steps, { "--report", "report.json", "--profile", "p.csv" } );
		EXPECT_NE( outcome.status, 2 ) << outcome.err;
		return nlohmann::json::parse( readFile( path( "report.json" ) ) );
	}

	const std::string reach = "- trajectory: reach.csv\n", swing = "- trajectory: swing.csv\n",
	                  back = "- trajectory: back.csv\n", attach = "- {attach: cup, link: tool, touch_links: [fore]}\n",
	                  release = "- release: cup\n";
};

TEST_F( CliSteps, AnAttachedObjectMovesWithTheArm )
{
	EXPECT_EQ( audit( reach + swing ).status, 0 );
	const nlohmann::json carried = report( reach + attach + swing );
	EXPECT_EQ( carried["audit"]["verdict"], "BLOCKED" );
	EXPECT_EQ( carried["audit"]["violation"]["pair"], nlohmann::json( { "cup", "wall" } ) );
	EXPECT_GT( carried["audit"]["violation"]["time"], 1 ); // of all steps
	EXPECT_EQ( carried["steps"][0]["verdict"], "FREE" );
	EXPECT_EQ( carried["steps"][1]["verdict"], "BLOCKED" );
	EXPECT_EQ( carried["steps"][1]["begin"], 1.0 );
	// allowed for a while
	EXPECT_EQ( audit( reach + attach + "- allow: [cup, wall]\n" + swing ).status, 0 );
	EXPECT_EQ( audit( reach + attach + "- allow: [wall, cup]\n- forbid: [cup, wall]\n" + swing ).status, 1 );
}

TEST_F( CliSteps, AReleasedObjectStaysWhereItIs )
{
	const auto nearest = [&]( const std::string& steps )
	{
		EXPECT_EQ( report( steps )["audit"]["verdict"], "FREE" );
		const Table table = parseTable( readFile( path( "p.csv" ) ) );
		return table.number( table.rows.size() - 1, "environment" );
	};
	EXPECT_GT( nearest( reach + back ), 0.1 ); // the cup is left behind
	write( "hold.csv", "time,shoulder,elbow\n0,-1.4,0\n" );
	EXPECT_LT( nearest( reach + attach + back + release + "- trajectory: hold.csv\n" ), 0.05 );
}

// Steps of another group: the joints that it lacks stand where they were moved last, and attached objects stay on the arm.
TEST_F( CliSteps, GroupsTakeTurns )
{
	const std::string turn = "- trajectory: turn.csv\n", fold = "- trajectory: fold.csv\n";
	const nlohmann::json stretched = report( reach + attach + turn );
	EXPECT_EQ( stretched["steps"][1]["group"], "shoulder_only" );
	EXPECT_EQ( stretched["audit"]["verdict"], "BLOCKED" );
	EXPECT_EQ( stretched["audit"]["violation"]["state"].size(), 1u ); // of that group
	EXPECT_EQ( report( reach + attach + fold + turn )["audit"]["verdict"], "FREE" );
	EXPECT_EQ( report( reach + attach + release + turn )["audit"]["verdict"], "FREE" );
	EXPECT_EQ( report( reach + attach + "- allow: [cup, wall]\n" + turn )["audit"]["verdict"], "FREE" );
	// before the first motion of the elbow it stands where that begins
	EXPECT_EQ( report( turn + attach + swing )["audit"]["problems"].size(), 1u );
	// tolerances of joints that a step's group lacks are for other steps
	EXPECT_EQ( audit( reach + turn, { "--tolerance", "elbow=0.001" } ).status, 0 );
	EXPECT_EQ( audit( reach + turn, { "--tolerance", "knee=0.001" } ).status, 2 );
}

// Until its group moves it, the elbow stands where that motion begins: the arm passes the post with the elbow folded, not stretched.
TEST_F( CliSteps, AJointStandsWhereItsLaterMotionEnds )
{
	write( "stretched.csv", "time,shoulder,elbow\n0,1,0\n3,1,2.5\n" );
	write( "folded.csv", "time,shoulder,elbow\n0,1,2.5\n3,1,0\n" );
	for ( const bool folded : { false, true } )
	{
		write( "steps.yaml", std::string( "steps:\n- trajectory: turn.csv\n- trajectory: " ) +
		                         ( folded ? "folded.csv\n" : "stretched.csv\n" ) );
		const Outcome outcome = runModel( "audit", { "--steps", "steps.yaml", "--report", "report.json" }, "blocked.yaml" );
		ASSERT_NE( outcome.status, 2 ) << outcome.err;
		const nlohmann::json steps = nlohmann::json::parse( readFile( path( "report.json" ) ) )["steps"];
		EXPECT_EQ( steps[0]["verdict"], folded ? "FREE" : "BLOCKED" ) << outcome.out;
		EXPECT_EQ( steps[1]["verdict"], "FREE" ) << outcome.out;
	}
}

TEST_F( CliSteps, JumpsBetweenStepsAreTold )
{
	const Outcome outcome = audit( back + "- trajectory: swing.csv\n" );
	EXPECT_EQ( outcome.status, 1 );
	EXPECT_TRUE( contains( outcome.out, "in the end of the one before" ) ) << outcome.out;
}

TEST_F( CliSteps, BadStepsNameTheElementAndTheRemedy )
{
	const auto error = [&]( const std::string& steps )
	{
		const Outcome outcome = audit( steps );
		EXPECT_EQ( outcome.status, 2 ) << outcome.out;
		return outcome.err;
	};
	EXPECT_TRUE( contains( error( reach + "- {attach: mug, link: tool}\n" ), "steps[1]: object mug" ) );
	EXPECT_TRUE( contains( error( reach + "- {attach: cup, link: paw}\n" ), "has no link paw" ) );
	EXPECT_TRUE( contains( error( reach + "- attach: cup\n" ), "steps[1].link" ) );
	EXPECT_TRUE( contains( error( reach + release ), "is not attached" ) );
	EXPECT_TRUE( contains( error( reach + "- {attach: cup, release: cup, link: tool}\n" ), "has both attach and release" ) );
	EXPECT_TRUE( contains( error( reach + "- wave: cup\n" ), "steps[1]: is no step" ) );
	EXPECT_TRUE( contains( error( reach + "- {release: cup, link: tool}\n" ), "steps[1].link: is unknown" ) );
	EXPECT_TRUE( contains( error( attach ), "has no trajectory" ) );
	EXPECT_TRUE( contains( error( reach + "- allow: [cup]\n" ), "steps[1].allow: is no pair" ) );
	EXPECT_TRUE( contains( error( "- trajectory: none.csv\n" ), "none.csv" ) );
	EXPECT_TRUE( contains( error( reach + "- 3\n" ), "steps[1]" ) );
	EXPECT_TRUE( contains( error( reach + "step: []\n" ), "step: is unknown beside steps" ) );
}
