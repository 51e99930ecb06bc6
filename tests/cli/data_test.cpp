// SPDX-License-Identifier: BSD-3-Clause
// Requests of real robots, end to end. Skipped where the data are not.
#include "cli_fixture.hpp"

#include <nlohmann/json.hpp>

#include <filesystem>

class CliData : public Cli
{
protected:
	void SetUp() override
	{
		Cli::SetUp();
		if ( !std::filesystem::exists( LEEWAY_DATA_DIR "/README.md" ) )
		{
			GTEST_SKIP() << "no data in " LEEWAY_DATA_DIR;
		}
	}

	// Plans, expects a certified path, audits the file that was written by itself.
	void planAndAudit( const std::string& robot, const std::string& scene, const std::string& request, bool goal_named )
	{
		const std::string data = LEEWAY_DATA_DIR "/";
		const std::vector<std::string> model = {
		    "--robot", data + robot + ".urdf", "--srdf", data + robot + ".srdf", "--scene", data + scene };
		std::vector<std::string> plan = {
		    "plan", "--request", data + request, "--out", "path.yaml", "--report", "report.json" };
		plan.insert( plan.end(), model.begin(), model.end() );
		const Outcome planned = run( plan );
		ASSERT_EQ( planned.status, 0 ) << planned.err;
		const auto report = nlohmann::json::parse( readFile( path( "report.json" ) ) );
		EXPECT_TRUE( report["audit"]["valid"] );
		EXPECT_EQ( report["path"]["edges_free"], report["path"]["states"].get<int>() - 1 );
		std::vector<std::string> audit = { "audit", "--path", "path.yaml" };
		audit.insert( audit.end(), model.begin(), model.end() );
		if ( goal_named )
		{
			audit.insert( audit.end(), { "--request", data + request } );
		}
		const Outcome audited = run( audit );
		EXPECT_EQ( audited.status, 0 ) << audited.out << audited.err;
	}
};

TEST_F( CliData, PandaPicksFromTheTable )
{
	planAndAudit( "mbm/panda/panda", "mbm/panda/problems/table_pick_panda/scene0001.yaml",
	    "mbm/panda/problems/table_pick_panda/request0001.yaml", true );
}

TEST_F( CliData, ArmarReachesIntoTheFridge )
{
	planAndAudit( "armar3/armar3", "kit_kitchen/scene_cluttered.yaml", "armar3/reach/04.yaml", true );
}

TEST_F( CliData, ArmarReachesToTheTable )
{
	planAndAudit( "armar3/armar3", "kit_kitchen/scene_cluttered.yaml", "armar3/reach/07.yaml", false );
}

/// Two arms swing over a table while a box passes in front of them, again and again, and a person may come.
TEST_F( CliData, TwoPandasShareATable )
{
	const std::string panda = LEEWAY_DATA_DIR "/mbm/panda/panda",
	                  hand_up = "panda_joint2: -0.785, panda_joint4: -2.356, panda_joint6: 1.571";
	write( "swing.csv",
	    "time,panda_joint1,panda_joint2,panda_joint4,panda_joint6\n0,0,-0.785,-2.356,1.571\n2,0.9,-0.785,-2.356,1.571\n4,0,-0.785,-2.356,1.571\n" );
	std::string world = "leeway_world: 1\nrobots:\n";
	for ( const auto& [name, y] : { std::pair( "left", "0.4" ), { "right", "-0.4" } } )
	{
		world += std::string( "  - {name: " ) + name + ", robot: " + panda + ".urdf, srdf: " + panda +
		         ".srdf, base: {position: [0, " + y + ", 0]}, state: {" + hand_up +
		         "}, tolerance: 0.002, lag: 0.02, motion: swing.csv}\n";
	}
	world +=
	    "objects:\n  - {name: table, pose: {position: [0.5, 0, -0.2]}, shapes: [{type: box, dimensions: [1, 2, 0.05]}]}\n"
	    "  - {name: box, pose: {position: [0.6, -1.5, 0.05]}, shapes: [{type: box, dimensions: [0.1, 0.1, 0.1]}], repeat: 7, "
	    "motion: [{start: 0, end: 6, position: [0.6, 1.5, 0.05]}, {start: 6, end: 7, position: [0.6, -1.5, 0.05]}]}\n"
	    "  - {name: person, pose: {position: [12, 0, 0.9]}, shapes: [{type: cylinder, dimensions: [1.8, 0.3]}], unknown_motion: {speed: 1.6}}\n";
	write( "cell.yaml", world );
	const Outcome free = run( { "world", "audit", "--world", "cell.yaml", "--min-d", "0.01", "--no-cache" } );
	EXPECT_EQ( free.status, 0 ) << free.out << free.err;
	const Outcome later = run( { "world", "audit", "--world", "cell.yaml", "--to", "9", "--no-cache" } );
	EXPECT_EQ( later.status, 1 ) << later.out << later.err;
	EXPECT_TRUE( contains( later.out, "person" ) && contains( later.out, "which the unknown motion may close" ) )
	    << later.out;
}
