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
