// SPDX-License-Identifier: BSD-3-Clause
// No result takes the place of a file that the run reads, or of another result.
#include "cli_fixture.hpp"

#include <filesystem>
#include <unistd.h>

namespace
{

struct Clash
{
	std::string name;
	std::vector<std::string> arguments; ///< with the model's before them
	std::string option, other;          ///< both are named
	std::string file;                   ///< must stay as it is; empty: must not come to be
};

std::ostream& operator<<( std::ostream& stream, const Clash& clash )
{
	return stream << clash.name;
}

const std::vector<Clash> clashes = {
    { "Robot", { "check", "--states", "states.csv", "--out", "arm.urdf" }, "--out", "--robot", "arm.urdf" },
    { "RobotByAnotherPath", { "check", "--states", "states.csv", "--out", "folder/../arm.urdf" }, "--out", "--robot",
        "arm.urdf" },
    { "RobotByALink", { "check", "--states", "states.csv", "--out", "link.urdf" }, "--out", "--robot", "link.urdf" },
    { "RobotByAHardLink", { "check", "--states", "states.csv", "--out", "hard.urdf" }, "--out", "--robot", "hard.urdf" },
    { "Srdf", { "info", "--json", "arm.srdf" }, "--json", "--srdf", "arm.srdf" },
    { "SrdfThatIsJudged", { "pairs", "--out", "arm.srdf" }, "--out", "--srdf", "arm.srdf" },
    { "Scene", { "edge", "--edges", "edges.csv", "--out", "scene.yaml" }, "--out", "--scene", "scene.yaml" },
    { "Request", { "plan", "--request", "request.yaml", "--report", "request.yaml" }, "--report", "--request",
        "request.yaml" },
    { "Mesh", { "check", "--states", "states.csv", "--out", "fore.stl" }, "--out", "a mesh of --robot", "fore.stl" },
    { "SceneMesh", { "check", "--states", "states.csv", "--scene", "mesh.yaml", "--out", "wall.stl" }, "--out",
        "a mesh of --scene", "wall.stl" },
    { "States", { "check", "--states", "states.csv", "--out", "states.csv" }, "--out", "--states", "states.csv" },
    { "Edges", { "edge", "--edges", "edges.csv", "--out", "edges.csv" }, "--out", "--edges", "edges.csv" },
    { "Path", { "audit", "--path", "good.yaml", "--profile", "good.yaml" }, "--profile", "--path", "good.yaml" },
    { "Margins", { "check", "--states", "states.csv", "--margins", "m.yaml", "--out", "m.yaml" }, "--out", "--margins",
        "m.yaml" },
    { "PlanTwice", { "plan", "--request", "request.yaml", "--out", "p", "--report", "p" }, "--report", "--out", "" },
    { "PlanTwiceByAnotherPath", { "plan", "--request", "request.yaml", "--out", "p", "--report", "./folder/../p" },
        "--report", "--out", "" },
    { "AuditTwice", { "audit", "--path", "good.yaml", "--report", "p", "--profile", "p" }, "--profile", "--report", "" },
    { "TuneTwice", { "tune", "--states", "2", "--edges", "1", "--csv", "p", "--json", "p" }, "--json", "--csv", "" },
};

std::string clashName( const testing::TestParamInfo<Clash>& info )
{
	return info.param.name;
}

class Overwrite : public Cli, public testing::WithParamInterface<Clash>
{
};

} // namespace

TEST_P( Overwrite, IsAnErrorThatNamesBothOptions )
{
	const Clash& clash = GetParam();
	std::filesystem::create_directory( path( "folder" ) );
	std::filesystem::create_symlink( "arm.urdf", path( "link.urdf" ) );
	std::filesystem::create_hard_link( path( "arm.urdf" ), path( "hard.urdf" ) );
	write( "good.yaml", "joint_names: [shoulder, elbow]\npoints:\n  - positions: [0, 0]\n  - positions: [0.2, 0.1]\n" );
	write( "m.yaml", "environment: 0.01\n" );
	write( "wall.stl", readFile( path( "fore.stl" ) ) );
	write( "mesh.yaml", "world:\n  collision_objects:\n    - id: wall\n      meshes:\n        - resource: wall.stl\n"
	                    "      mesh_poses:\n        - position: [2, 0, 0]\n          orientation: [0, 0, 0, 1]\n" );
	std::vector<std::string> arguments = clash.arguments;
	arguments.insert( arguments.begin() + 1, { "--robot", "arm.urdf", "--srdf", "arm.srdf" } );
	if ( clash.name != "SceneMesh" && clash.arguments[0] != "pairs" )
	{
		arguments.insert( arguments.begin() + 1, { "--scene", "scene.yaml" } );
	}
	const std::string before = clash.file.empty() ? "" : readFile( path( clash.file ) );
	const std::vector<std::string> listed = files();
	const Outcome outcome = run( arguments );
	EXPECT_EQ( outcome.status, 2 ) << outcome.out << outcome.err;
	EXPECT_TRUE(
	    contains( outcome.err, "command line: " + clash.option + ": " ) && contains( outcome.err, clash.other + " " ) )
	    << outcome.err;
	EXPECT_EQ( files(), listed );
	EXPECT_EQ( clash.file.empty() ? "" : readFile( path( clash.file ) ), before );
}

INSTANTIATE_TEST_SUITE_P( Cli, Overwrite, testing::ValuesIn( clashes ), clashName );

TEST_F( Cli, AnOlderResultIsReplacedAndADeviceMayTakeTwoResults )
{
	write( "out.csv", "an older result" );
	EXPECT_EQ( runModel( "check", { "--states", "states.csv", "--out", "out.csv" } ).status, 0 );
	EXPECT_TRUE( contains( readFile( path( "out.csv" ) ), "verdict" ) );
	EXPECT_EQ(
	    runModel( "plan", { "--request", "request.yaml", "--out", "/dev/null", "--report", "/dev/null" } ).status, 0 );
}
