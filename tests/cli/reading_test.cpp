// SPDX-License-Identifier: BSD-3-Clause
// Files of real robots that are not as they should be: values read, notices, effects of the options.
#include "cli_fixture.hpp"

#include <algorithm>

namespace
{

class ReadingCli : public Cli
{
protected:
	std::size_t notices( const std::string& text ) const
	{
		std::size_t count = 0;
		for ( std::size_t at = text.find( "notice:" ); at != std::string::npos; at = text.find( "notice:", at + 1 ) )
		{
			++count;
		}
		return count;
	}
	/// Exit status 2 and one line with all of these.
	void expectError( const Outcome& outcome, const std::vector<std::string>& words ) const
	{
		EXPECT_EQ( outcome.status, 2 ) << outcome.err;
		const std::size_t at = outcome.err.find( "leeway: error:" );
		ASSERT_NE( at, std::string::npos ) << outcome.err;
		for ( const std::string& word : words )
		{
			EXPECT_TRUE( contains( outcome.err.substr( at ), word ) ) << word << " is not in " << outcome.err;
		}
		EXPECT_FALSE( contains( outcome.err, "internal" ) ) << outcome.err;
	}
};

} // namespace

TEST_F( ReadingCli, ABrokenGroupOfTheSrdfMattersToNobodyElse )
{
	edit( "arm.srdf", "<group name=\"shoulder_only\">",
	    "<group name=\"gripper\"><chain base_link=\"tool\" tip_link=\"palm\"/></group>\n"
	    "<group_state name=\"home\"/><group name=\"shoulder_only\">" );
	const Outcome good = runModel( "info", { "--group", "arm" } );
	EXPECT_EQ( good.status, 0 ) << good.err;
	EXPECT_TRUE(
	    contains( good.err, "arm.srdf: group gripper (line 4): cannot be used: the URDF has no link palm (line 4)" ) )
	    << good.err;
	EXPECT_TRUE( contains( good.err, "group_state home (line 5): cannot be used" ) ) << good.err;
	EXPECT_TRUE( contains( good.out, "group gripper: cannot be used: the URDF has no link palm (line 4)" ) ) << good.out;
	expectError( runModel( "info", { "--group", "gripper" } ),
	    { "arm.srdf: group gripper", "no link palm (line 4)", "use one of arm, shoulder_only" } );
	expectError(
	    runModel( "info", { "--group", "arm", "--strict" } ), { "arm.srdf: group gripper (line 4)", "no link palm" } );
}

TEST_F( ReadingCli, AUrdfAsSrdfIsTold )
{
	expectError( run( { "info", "--robot", "arm.urdf", "--srdf", "arm.urdf" } ), { "arm.urdf", "this is a URDF" } );
	expectError( run( { "info", "--robot", "arm.srdf" } ), { "arm.srdf", "this is an SRDF" } );
}

TEST_F( ReadingCli, VisualGeometryOnRequest )
{
	std::string bare = readFile( path( "arm.urdf" ) );
	for ( std::size_t at = bare.find( "collision" ); at != std::string::npos; at = bare.find( "collision", at ) )
	{
		bare.replace( at, 9, "visual" );
	}
	write( "bare.urdf", bare );
	expectError( run( { "info", "--robot", "bare.urdf" } ), { "bare.urdf", "no link has collision geometry", "--visual" } );
	const std::vector<std::string> rest = {
	    "--srdf", "arm.srdf", "--group", "arm", "--scene", "scene.yaml", "--states", "states.csv" };
	const auto check = [&]( const std::string& robot, const std::vector<std::string>& more )
	{
		std::vector<std::string> arguments = { "check", "--robot", robot };
		arguments.insert( arguments.end(), rest.begin(), rest.end() );
		arguments.insert( arguments.end(), more.begin(), more.end() );
		return run( arguments );
	};
	const Outcome by_visual = check( "bare.urdf", { "--visual" } ), by_collision = check( "arm.urdf", {} );
	EXPECT_TRUE(
	    contains( by_visual.err, "visual geometry is used for links without collision geometry: base, upper, fore" ) )
	    << by_visual.err;
	const Table a = parseTable( by_visual.out ), b = parseTable( by_collision.out );
	ASSERT_EQ( a.rows.size(), b.rows.size() ) << by_visual.err;
	ASSERT_FALSE( a.rows.empty() );
	EXPECT_EQ( a.number( 0, "env_lower" ), b.number( 0, "env_lower" ) );
}

TEST_F( ReadingCli, PairsOfAVisualLinkAreNotTakenFromTheCacheOfTheRobotWithoutIt )
{
	edit( "arm.urdf", "<link name=\"tool\"/>",
	    "<link name=\"tool\"><visual><origin xyz=\"0.05 0 0\"/><geometry><box size=\"0.06 0.02 0.02\"/></geometry></visual></link>" );
	const std::vector<std::string> question = { "--group", "arm", "--states", "states.csv", "--cache", "cache" };
	std::vector<std::string> with_visual = question;
	with_visual.push_back( "--visual" );
	const Table without = parseTable( runModel( "check", question ).out ),
	            with = parseTable( runModel( "check", with_visual ).out ),
	            again = parseTable( runModel( "check", question ).out );
	ASSERT_FALSE( without.rows.empty() );
	EXPECT_NEAR( without.number( 0, "env_lower" ), 0.1, 1e-6 );
	EXPECT_NEAR( with.number( 0, "env_lower" ), 0.02, 1e-6 ) << "the tool reaches further than the forearm";
	EXPECT_EQ( again.number( 0, "env_lower" ), without.number( 0, "env_lower" ) );
}

TEST_F( ReadingCli, AMisspeltKeyIsNoEmptyWorld )
{
	edit( "scene.yaml", "collision_objects:", "collision_object:" );
	expectError( runModel( "check", { "--group", "arm", "--states", "states.csv" } ),
	    { "scene.yaml: world.collision_object", "is collision_objects meant?" } );
}

TEST_F( ReadingCli, AMisspeltMarginOfAPathIsNoMarginOfZero )
{
	write( "path.yaml", "Min_D: 5\ngroup: arm\njoint_names: [shoulder, elbow]\npoints:\n  - positions: [0, 0]\n" );
	expectError( runModel( "audit", { "--path", "path.yaml" } ), { "path.yaml: Min_D (line 1)", "is min_d meant?" } );
}

TEST_F( ReadingCli, NamesThatAreNotUtf8AreNoInternalError )
{
	edit( "arm.urdf", "<link name=\"tool\"/>", "<link name=\"to\xe9l\"/>" );
	expectError(
	    runModel( "info", { "--group", "arm", "--json", "o.json" } ), { "arm.urdf: link (line ", "to\\xe9l", "UTF-8" } );
}

TEST_F( ReadingCli, AFolderThatIsNotUtf8IsNoInternalError )
{
	write( "arm_\xe9.urdf", readFile( path( "arm.urdf" ) ) );
	const Outcome outcome = run( { "info", "--robot", "arm_\xe9.urdf", "--srdf", "arm.srdf", "--json", "o.json" } );
	EXPECT_EQ( outcome.status, 0 ) << outcome.err;
	EXPECT_TRUE( contains( readFile( path( "o.json" ) ), "arm_\xef\xbf\xbd.urdf" ) );
}

TEST_F( ReadingCli, AZeroByteDoesNotCutTheMessage )
{
	write( "states.csv", std::string( "shoulder,elbow\n0,0.\0005\n", 22 ) );
	expectError(
	    runModel( "check", { "--group", "arm", "--states", "states.csv" } ), { "states.csv", "line 2", "byte 0", ";" } );
}

TEST_F( ReadingCli, LinksThatAreAlikeShareANotice )
{
	std::string links;
	for ( int i = 0; i < 21; ++i )
	{
		const std::string n = std::to_string( i );
		links += "<link name=\"v" + n +
		         "\"><visual><geometry><sphere radius=\"0.01\"/></geometry></visual></link><joint name=\"jv" + n +
		         "\" type=\"fixed\"><parent link=\"tool\"/><child link=\"v" + n + "\"/></joint>";
	}
	const std::size_t before = notices( runModel( "info", { "--group", "arm" } ).err );
	edit( "arm.urdf", "<link name=\"tool\"/>", "<link name=\"tool\"/>" + links );
	EXPECT_EQ( notices( runModel( "info", { "--group", "arm" } ).err ), before + 1 );
}

TEST_F( ReadingCli, AnObjectIsToldToBeAScene )
{
	write( "mug.urdf",
	    "<robot name=\"mug\"><link name=\"mug\"><collision><geometry><cylinder radius=\"0.04\" length=\"0.1\"/></geometry>"
	    "</collision></link></robot>" );
	expectError( run( { "info", "--robot", "mug.urdf" } ), { "mug.urdf", "no joint that can move", "--scene" } );
	EXPECT_EQ( runModel( "info", { "--group", "arm" }, "mug.urdf" ).status, 0 );
}
