// SPDX-License-Identifier: BSD-3-Clause
// Start and goal on the command line, planning without SRDF, group and scene, and contacts that are allowed there.
#include "cli_fixture.hpp"

#include <nlohmann/json.hpp>
#include <yaml-cpp/yaml.h>

#include <cmath>

class CliEnds : public Cli
{
protected:
	void SetUp() override
	{
		Cli::SetUp();
		// Named states of two groups, one of them under a name that both have
		edit( "arm.srdf", "</robot>",
		    "<group_state name='low' group='arm'><joint name='shoulder' value='-1'/><joint name='elbow' value='0.25'/>"
		    "<joint name='finger_joint' value='0.125'/></group_state>"
		    "<group_state name='high' group='arm'><joint name='shoulder' value='1'/></group_state>"
		    "<group_state name='out' group='arm'><joint name='shoulder' value='1'/></group_state>"
		    "<group_state name='out' group='shoulder_only'><joint name='shoulder' value='0.5'/></group_state>"
		    "</robot>" );
	}

	Outcome plan( const std::vector<std::string>& more ) const
	{
		std::vector<std::string> arguments = { "plan", "--robot", "arm.urdf", "--out", "path.yaml" };
		arguments.insert( arguments.end(), more.begin(), more.end() );
		return run( arguments );
	}
	YAML::Node pathFile() const { return YAML::LoadFile( path( "path.yaml" ) ); }
	std::vector<double> point( bool last ) const
	{
		const YAML::Node points = pathFile()["points"];
		return points[last ? points.size() - 1 : 0]["positions"].as<std::vector<double>>();
	}
	/// Without an SRDF neighbours that overlap are in contact; here they stand apart.
	void partNeighbours() const
	{
		edit( "arm.urdf", R"(xyz="0.2 0 0"/><geometry><box size="0.4)", R"(xyz="0.2 0 0"/><geometry><box size="0.2)" );
	}
};

namespace
{
using Vector = std::vector<double>;
const std::vector<std::string> srdf = { "--srdf", "arm.srdf" };

std::vector<std::string> operator+( std::vector<std::string> a, const std::vector<std::string>& b )
{
	a.insert( a.end(), b.begin(), b.end() );
	return a;
}
} // namespace

TEST_F( CliEnds, AGoalOfValuesNeedsNoRequestNorSceneNorSrdf )
{
	partNeighbours();
	const Outcome outcome = plan( { "--goal", "shoulder=1, elbow=-0.5" } );
	ASSERT_EQ( outcome.status, 0 ) << outcome.err;
	EXPECT_EQ( point( false ), ( Vector{ 0, 0 } ) );
	EXPECT_EQ( point( true ), ( Vector{ 1, -0.5 } ) );
	EXPECT_EQ( pathFile()["group"].as<std::string>(), "" );
	EXPECT_EQ( run( { "audit", "--robot", "arm.urdf", "--path", "path.yaml" } ).status, 0 );
}

TEST_F( CliEnds, JointsThatTheGoalDoesNotNameKeepTheStartsValue )
{
	ASSERT_EQ( plan( srdf + std::vector<std::string>{ "--start", "elbow=0.5", "--goal", "shoulder=1" } ).status, 0 );
	EXPECT_EQ( point( false ), ( Vector{ 0, 0.5 } ) );
	EXPECT_EQ( point( true ), ( Vector{ 1, 0.5 } ) );
}

TEST_F( CliEnds, NamedStatesBringTheirGroup )
{
	ASSERT_EQ( plan( srdf + std::vector<std::string>{ "--start", "low", "--goal", "high" } ).status, 0 );
	EXPECT_EQ( pathFile()["group"].as<std::string>(), "arm" );
	EXPECT_EQ( point( false ), ( Vector{ -1, 0.25 } ) ); // finger_joint follows the elbow: no value of its own
	EXPECT_EQ( point( true ), ( Vector{ 1, 0.25 } ) );
}

TEST_F( CliEnds, AStateOfSeveralGroupsIsThatOfTheGroupAskedFor )
{
	const Outcome which = plan( srdf + std::vector<std::string>{ "--goal", "out" } );
	EXPECT_EQ( which.status, 2 );
	EXPECT_TRUE( contains( which.err, "groups arm and shoulder_only" ) ) << which.err;
	ASSERT_EQ( plan( srdf + std::vector<std::string>{ "--goal", "out", "--group", "shoulder_only" } ).status, 0 );
	EXPECT_EQ( point( true ), ( Vector{ 0.5 } ) );
}

TEST_F( CliEnds, EndsOnTheCommandLineGoBeforeThoseOfTheRequest )
{
	const std::vector<std::string> request = srdf + std::vector<std::string>{ "--request", "request.yaml" };
	ASSERT_EQ( plan( request + std::vector<std::string>{ "--goal", "shoulder=0.5" } ).status, 0 );
	EXPECT_EQ( point( false ), ( Vector{ -1, 0 } ) );
	EXPECT_EQ( point( true ), ( Vector{ 0.5, 0 } ) );
	ASSERT_EQ( plan( request + std::vector<std::string>{ "--start", "shoulder=-0.5" } ).status, 0 );
	EXPECT_EQ( point( false ), ( Vector{ -0.5, 0 } ) );
	EXPECT_EQ( point( true ), ( Vector{ 1, 0 } ) );
}

TEST_F( CliEnds, TheGroupOfTheCommandLineGoesBeforeTheRequests )
{
	edit( "request.yaml", "group_name: arm\n", "" );
	const std::vector<std::string> request = srdf + std::vector<std::string>{ "--request", "request.yaml" };
	const Outcome shoulder = plan( request + std::vector<std::string>{ "--group", "shoulder_only" } );
	ASSERT_EQ( shoulder.status, 0 ) << shoulder.err;
	EXPECT_EQ( pathFile()["joint_names"].as<std::vector<std::string>>(), ( std::vector<std::string>{ "shoulder" } ) );
	ASSERT_EQ( plan( request ).status, 0 ); // all joints
	EXPECT_EQ( pathFile()["joint_names"].size(), 2u );
	partNeighbours();
	EXPECT_EQ( plan( { "--request", "request.yaml" } ).status, 0 );
}

TEST_F( CliEnds, WrongEndsAreNamedWithTheLikelyOnes )
{
	struct Wrong
	{
		std::vector<std::string> arguments, words;
	};
	const std::vector<Wrong> all = {
	    { {}, { "--goal", "--request" } },
	    { { "--goal", "sholder=1" }, { "--goal sholder", "use shoulder" } },
	    { { "--goal", "shoulder=one" }, { "--goal shoulder", "'one'" } },
	    { { "--goal", "shoulder=nan" }, { "'nan'" } },
	    { { "--goal", "shoulder=1,elbow" }, { "'elbow' is not joint=value" } },
	    { { "--goal", "shoulder=1,shoulder=2" }, { "twice" } },
	    { { "--goal", "hihg" }, { "group_state hihg", "high of group arm" } },
	    { { "--goal", "tool_joint=1" }, { "fixed" } },
	    { { "--goal", "finger_joint=1" }, { "follows joint elbow" } },
	    { { "--goal", "shoulder=3" }, { "command line: --goal", "above its limit" } },
	    { { "--goal", "high", "--start", "elbow=2.9" }, { "command line: --start", "above its limit", "start at 0" } },
	    { { "--goal", "elbow=1", "--group", "shoulder_only" }, { "--goal elbow", "shoulder_only" } },
	};
	for ( const Wrong& wrong : all )
	{
		const Outcome outcome = plan( srdf + wrong.arguments );
		EXPECT_EQ( outcome.status, 2 ) << outcome.out;
		for ( const std::string& word : wrong.words )
		{
			EXPECT_TRUE( contains( outcome.err, word ) ) << "lacks '" << word << "': " << outcome.err;
		}
	}
	const Outcome bare = plan( { "--goal", "high" } );
	EXPECT_TRUE( bare.status == 2 && contains( bare.err, "--srdf" ) ) << bare.err;
}

TEST_F( CliEnds, PlanarAndFloatingJointsAreSetByTheirVariables )
{
	for ( const auto& [type, goal, many] :
	    { std::make_tuple( "planar", "base/x=0.5,base/theta=1,shoulder=0.5", "base/x, base/y, base/theta" ),
	        std::make_tuple( "floating", "base/trans_x=0.5,base/trans_z=0.25,shoulder=0.5",
	            "base/trans_x, base/trans_y, base/trans_z" ) } )
	{
		TearDown();
		Cli::SetUp();
		edit( "arm.srdf", "<group name=\"arm\">",
		    std::string( "<virtual_joint name='base' type='" ) + type +
		        "' parent_frame='odom' child_link='base'/><group name=\"arm\">" );
		const Outcome outcome = plan( srdf + std::vector<std::string>{ "--goal", goal } );
		ASSERT_EQ( outcome.status, 0 ) << type << outcome.err;
		EXPECT_EQ( point( true )[0], 0.5 ) << type;
		const Outcome wrong = plan( srdf + std::vector<std::string>{ "--goal", "base/q=1" } );
		EXPECT_TRUE( wrong.status == 2 && contains( wrong.err, many ) ) << wrong.err;
	}
}

TEST_F( CliEnds, ARotationAndItsNegativeAreTheSameGoal )
{
	write( "free.xml",
	    "<mujoco><worldbody><geom type=\"plane\" size=\"1 1 1\"/><body name=\"b\" pos=\"0 0 1\"><freejoint name=\"f\"/>"
	    "<geom type=\"box\" size=\"0.1 0.2 0.3\"/></body></worldbody></mujoco>" );
	// the shorter way to the negative of a rotation ends at the rotation itself
	const Outcome outcome = run( { "plan", "--robot", "free.xml", "--start", "f/trans_z=1", "--goal",
	    "f/trans_x=0.5,f/trans_z=1,f/rot_x=-0.6,f/rot_w=-0.8", "--out", "path.yaml" } );
	EXPECT_EQ( outcome.status, 0 ) << outcome.err;
	EXPECT_TRUE( contains( outcome.out, "audit       VALID" ) ) << outcome.out;
}

TEST_F( CliEnds, RandomEndsAreFreeAndTheSameForASeed )
{
	const auto path_of = [&]( const char* seed )
	{
		const Outcome outcome = plan( { "--start", "random", "--goal", "random", "--seed", seed } );
		EXPECT_EQ( outcome.status, 0 ) << outcome.err;
		return point( false );
	};
	const std::vector<double> first = path_of( "1" ), again = path_of( "1" ), other = path_of( "2" );
	EXPECT_EQ( first, again );
	EXPECT_NE( first, other );
}

TEST_F( CliEnds, RandomEndsKeepAwayFromLimitsThatBoundNothing )
{
	write( "base.urdf", R"(<robot name="base"><link name="odom"/>
	  <link name="slide"><collision><geometry><sphere radius="0.1"/></geometry></collision></link>
	  <link name="top"><collision><geometry><sphere radius="0.1"/></geometry></collision></link>
	  <joint name="x" type="prismatic"><parent link="odom"/><child link="slide"/><axis xyz="1 0 0"/>
	    <limit lower="-999999" upper="999999" effort="1" velocity="1"/></joint>
	  <joint name="turn" type="revolute"><parent link="slide"/><child link="top"/><axis xyz="0 0 1"/>
	    <limit lower="2000" upper="4000" effort="1" velocity="1"/></joint>
	  <link name="tool"/><joint name="twice" type="revolute"><parent link="top"/><child link="tool"/><axis xyz="0 0 1"/>
	    <limit lower="-100" upper="100" effort="1" velocity="1"/></joint></robot>)" );
	const Outcome outcome =
	    run( { "plan", "--robot", "base.urdf", "--start", "random", "--goal", "random", "--out", "path.yaml" } );
	ASSERT_EQ( outcome.status, 0 ) << outcome.err;
	for ( const std::vector<double>& ends : { point( true ), point( false ) } )
	{
		EXPECT_LE( std::fabs( ends[0] ), 1 ); // a metre, and half a turn from the nearest value to zero
		EXPECT_TRUE( ends[1] >= 2000 && ends[1] <= 2003.2 ) << ends[1];
		EXPECT_LE( std::fabs( ends[2] ), 3.2 );
	}
	// nothing can be touched: an edge is a step
	EXPECT_TRUE( contains( outcome.out, "VALID: 2 exact states" ) ) << outcome.out;
}

TEST_F( CliEnds, RandomEndsAreFoundWhereOnlyStatesNearTheReferenceAreFree )
{
	std::string robot = "<robot name='slots'><link name='base'>", joints;
	for ( const std::string i : { "0", "1", "2", "3", "4", "5" } ) // each ball is free in a twentieth of its way
	{
		for ( const std::string side : { "0.65 ", "-0.65 " } )
		{
			robot += "<collision><origin xyz='0 " + side + i + "'/><geometry><box size='1 1 0.5'/></geometry></collision>";
		}
		joints += "<link name='ball" + i + "'><collision><geometry><sphere radius='0.1'/></geometry></collision></link>";
		joints += "<joint name='j" + i + "' type='prismatic'><parent link='base'/><child link='ball" + i +
		          "'/><origin xyz='0 0 " + i +
		          "'/><axis xyz='0 1 0'/><limit lower='-1' upper='1' effort='1' velocity='1'/></joint>";
	}
	write( "slots.urdf", robot + "</link>" + joints + "</robot>" );
	const std::vector<std::string> plan = {
	    "plan", "--robot", "slots.urdf", "--start", "random", "--goal", "random", "--strict" };
	EXPECT_EQ( run( plan + std::vector<std::string>{ "--out", "path.yaml" } ).status, 0 );
	edit( "slots.urdf", "sphere radius='0.1'", "sphere radius='0.2'" ); // wider than its slot
	const Outcome outcome = run( plan );
	EXPECT_EQ( outcome.status, 2 );
	EXPECT_TRUE( contains( outcome.err, "random states is free: base - ball0 were too near in 100 % of them" ) &&
	             contains( outcome.err, "--allow base:ball0" ) )
	    << outcome.err;
}

TEST_F( CliEnds, AStateThatIsCalledRandomIsNamedAsTheSourceOfItsValues )
{
	write( "key.xml",
	    "<mujoco><worldbody><body name='b'><joint name='j' type='slide' range='-1 1'/><geom size='0.1'/></body></worldbody>"
	    "<keyframe><key name='random' qpos='3'/></keyframe></mujoco>" );
	const Outcome outcome = run( { "plan", "--robot", "key.xml", "--start", "random", "--goal", "j=0" } );
	EXPECT_EQ( outcome.status, 2 );
	EXPECT_TRUE( contains( outcome.err, "--start, the state random of key.xml: joint j: 3 is above its limit 1" ) &&
	             contains( outcome.err, "give a state inside the joint limits" ) )
	    << outcome.err;
}

TEST_F( CliEnds, ARandomGoalIsAsGoodAWholeTurnAway )
{
	// a stick on a joint of four turns, and a wall of its base that it cannot pass
	write( "stick.urdf",
	    R"(<robot name="stick"><link name="base"><collision><origin xyz="1 0 0"/><geometry><box size="0.2 0.2 0.2"/></geometry>
	  </collision></link><link name="stick"><collision><origin xyz="0.7 0 0"/><geometry><box size="0.8 0.05 0.05"/></geometry></collision></link>
	  <joint name="j" type="revolute"><parent link="base"/><child link="stick"/><axis xyz="0 0 1"/>
	    <limit lower="-12.56" upper="12.56" effort="1" velocity="1"/></joint></robot>)" );
	for ( const char* seed : { "1", "2", "3", "4", "5", "6" } )
	{
		const Outcome outcome = run( { "plan", "--robot", "stick.urdf", "--strict", "--start", "random", "--goal", "random",
		    "--seed", seed, "--time", "5", "--out", "path.yaml" } );
		EXPECT_TRUE( outcome.status == 0 && contains( outcome.out, "audit       VALID" ) ) << seed << outcome.err;
	}
	const Outcome given =
	    run( { "plan", "--robot", "stick.urdf", "--strict", "--start", "j=1", "--goal", "j=-1", "--time", "0.5" } );
	EXPECT_EQ( given.status, 1 ) << "numbers are meant as they are";
	EXPECT_TRUE( contains( given.err, "`leeway pairs --robot stick.urdf --out S.srdf` finds them" ) ) << given.err;
}

// ---- contacts that are allowed on the command line

TEST_F( CliEnds, AnAllowedContactDoesNotCount )
{
	write( "touch.csv", "shoulder,elbow\n1.2,-1.2\n" ); // the fore arm reaches to x = 0.545
	edit( "scene.yaml", "[1.0, 0, 0]", "[0.6, 0, 0]" ); // the wall's face is at 0.5
	const std::vector<std::string> check = { "--group", "arm", "--states", "touch.csv" };
	EXPECT_EQ( runModel( "check", check ).status, 1 );
	const Outcome allowed = runModel( "check", check + std::vector<std::string>{ "--allow", "wall:fore" } );
	ASSERT_EQ( allowed.status, 0 ) << allowed.out;
	EXPECT_NE( parseTable( allowed.out ).rows[0].at( "env_link" ), "fore" );
	const std::vector<std::string> ends = { "--start", "shoulder=1.2,elbow=-1.2", "--goal", "shoulder=1.2,elbow=-1" };
	EXPECT_EQ( runModel( "plan", ends ).status, 2 );
	EXPECT_EQ( runModel( "plan", ends + std::vector<std::string>{ "--allow", "fore:wall", "--out", "p.yaml" } ).status, 0 );
	EXPECT_EQ( runModel( "audit", { "--path", "p.yaml" } ).status, 1 );
	EXPECT_EQ( runModel( "audit", { "--path", "p.yaml", "--allow", "fore:wall" } ).status, 0 );
	write( "edges.csv", "from:shoulder,from:elbow,to:shoulder,to:elbow\n1.2,-1.2,1.2,-1\n" );
	EXPECT_EQ( runModel( "edge", { "--edges", "edges.csv" } ).status, 1 );
	EXPECT_EQ( runModel( "edge", { "--edges", "edges.csv", "--allow", "fore:wall" } ).status, 0 );
}

TEST_F( CliEnds, AnAllowedContactOfAStandingLinkDoesNotCount )
{
	edit( "scene.yaml", "[1.0, 0, 0]", "[0, 0, -1.2]" ); // the base in the wall, whose top the arm stays 0.175 m above
	EXPECT_EQ( runModel( "plan", { "--goal", "high" } ).status, 2 );
	const Outcome outcome = runModel( "plan", { "--goal", "high", "--allow", "base:wall" } );
	EXPECT_EQ( outcome.status, 0 ) << outcome.err;
}

TEST_F( CliEnds, TwoLinksMayBeAllowedToTouch )
{
	const std::vector<std::string> without = { "check", "--robot", "arm.urdf", "--states", "states.csv" };
	EXPECT_EQ( run( without ).status, 0 ) << "without an SRDF neighbours may touch";
	const std::vector<std::string> bare = without + std::vector<std::string>{ "--strict" };
	EXPECT_EQ( run( bare ).status, 1 ); // neighbours overlap
	const Outcome allowed = run( bare + std::vector<std::string>{ "--allow", "fore:upper" } );
	EXPECT_EQ( allowed.status, 0 ) << allowed.out;
	const Outcome info = run( { "info", "--robot", "arm.urdf", "--strict", "--allow", "upper:fore", "--json", "i.json" } );
	ASSERT_EQ( info.status, 0 ) << info.err;
	EXPECT_EQ( nlohmann::json::parse( readFile( path( "i.json" ) ) )["checker"]["link_pairs"]["disabled"], 1 );
}

TEST_F( CliEnds, AllowedNamesThatAreNotThereAreErrorsThatListNearOnes )
{
	for ( const auto& [text, word] : { std::make_pair( "fore:wal", "use wall" ), std::make_pair( "four:wall", "use fore" ),
	          std::make_pair( "fore", "LINK:OBJECT" ), std::make_pair( "wall:wall", "both are objects" ) } )
	{
		const Outcome outcome = runModel( "check", { "--states", "states.csv", "--allow", text } );
		EXPECT_EQ( outcome.status, 2 ) << text;
		EXPECT_TRUE( contains( outcome.err, word ) ) << text << ": " << outcome.err;
	}
}

// ---- joints without limits -------------------------------------------------------------------------------------------

TEST_F( CliEnds, PathsAndTrajectoriesBeginAtTheNumbersOfTheStartNotAWholeTurnAway )
{
	edit( "arm.urdf", "<joint name=\"shoulder\" type=\"revolute\">", "<joint name=\"shoulder\" type=\"continuous\">" );
	edit( "request.yaml", "position: [-1, ", "position: [5.25, " ); // -1 and a turn
	for ( const char* planner : { "Leeway", "RRTConnect" } )
	{
		SCOPED_TRACE( planner );
		const std::vector<std::string> model = {
		    "--robot", "arm.urdf", "--srdf", "arm.srdf", "--scene", "blocked.yaml", "--request", "request.yaml" };
		const Outcome outcome =
		    run( std::vector<std::string>{ "plan" } + model +
		         std::vector<std::string>{ "--planner", planner, "--out", "path.yaml", "--trajectory", "timed.yaml" } );
		ASSERT_EQ( outcome.status, 0 ) << outcome.err;
		const YAML::Node points = pathFile()["points"];
		EXPECT_EQ( points[0]["positions"][0].as<double>(), 5.25 );
		double before = 5.25;
		for ( const YAML::Node& at : points )
		{
			const double now = at["positions"][0].as<double>();
			EXPECT_LE( std::fabs( now - before ), 3.2 ) << "a jump";
			before = now;
		}
		EXPECT_NEAR( std::remainder( before - 1, 2 * M_PI ), 0, 1e-9 );
		const YAML::Node timed = YAML::LoadFile( path( "timed.yaml" ) )["joint_trajectory"]["points"];
		EXPECT_EQ( timed[0]["positions"][0].as<double>(), 5.25 );
		EXPECT_NEAR( timed[timed.size() - 1]["positions"][0].as<double>(), before, 1e-9 );
		const Outcome audit = run( std::vector<std::string>{ "audit", "--path", "path.yaml" } + model );
		EXPECT_EQ( audit.status, 0 ) << audit.out << audit.err;
	}
}

TEST_F( CliEnds, AnAuditRefusesAPathThatBeginsAWholeTurnFromTheStart )
{
	edit( "arm.urdf", "<joint name=\"shoulder\" type=\"revolute\">", "<joint name=\"shoulder\" type=\"continuous\">" );
	const std::vector<std::string> model = {
	    "--robot", "arm.urdf", "--srdf", "arm.srdf", "--scene", "blocked.yaml", "--request", "request.yaml" };
	ASSERT_EQ( run( std::vector<std::string>{ "plan", "--out", "path.yaml" } + model ).status, 0 );
	edit( "request.yaml", "position: [-1, ", "position: [5.283185307179586, " );
	const Outcome audit = run( std::vector<std::string>{ "audit", "--path", "path.yaml" } + model );
	EXPECT_EQ( audit.status, 1 );
	EXPECT_TRUE( contains( audit.out, "joint shoulder at -1" ) && contains( audit.out, "5.28318530717958" ) ) << audit.out;
}
