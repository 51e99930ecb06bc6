// SPDX-License-Identifier: BSD-3-Clause
// leeway pairs: classes, findings about an SRDF, and the SRDF it writes.
#include "pairs_fixture.hpp"

#include <algorithm>
#include <filesystem>

TEST_F( Pairs, EveryClassIsFound )
{
	const Outcome result = pairs( { "--json", "pairs.json", "--verbose" } );
	ASSERT_EQ( result.status, 0 ) << result.err;
	const nlohmann::json all = json( "pairs.json" );
	const auto expect = [&]( const char* a, const char* b, const char* kind )
	{
		const nlohmann::json pair = entry( all["pairs"], a, b );
		ASSERT_FALSE( pair.is_null() ) << a << " " << b;
		EXPECT_EQ( pair["class"], kind ) << pair;
	};
	expect( "left", "right", "never" );
	expect( "gear_a", "gear_b", "never" );
	expect( "jaw_a", "jaw_b", "check" );
	expect( "pot", "lid", "check" );
	expect( "nut", "bolt", "always" );
	expect( "base", "flag", "rigid" );
	expect( "base", "pin", "rigid" );
	expect( "base", "left", "adjacent" );
	expect( "flag", "left", "never" ); // rigid links see each other's neighbours move
	EXPECT_EQ( entry( all["pairs"], "left", "right" )["proof"], "hull" );
	EXPECT_EQ( entry( all["pairs"], "gear_a", "gear_b" )["proof"], "subdivision" );
	// A proof must not claim more than the truth: 0.7 between the slides, 0.9 between the gears
	EXPECT_GT( entry( all["pairs"], "left", "right" )["separation"].get<double>(), 0.6 );
	EXPECT_LE( entry( all["pairs"], "left", "right" )["separation"].get<double>(), 0.7 );
	EXPECT_GT( entry( all["pairs"], "gear_a", "gear_b" )["separation"].get<double>(), 0 );
	EXPECT_LE( entry( all["pairs"], "gear_a", "gear_b" )["separation"].get<double>(), 0.9 );
	EXPECT_EQ( all["findings"].size(), 0u );
	EXPECT_EQ( all["pairs"].size(), 13u * 12 / 2 );
	EXPECT_TRUE( contains( result.out, "left - right: proved (hull)" ) ) << result.out;
	EXPECT_TRUE( contains( result.out, "in contact in every measured state" ) ) << result.out;
}

TEST_F( Pairs, AWrongNeverIsFoundWithItsEvidence )
{
	const Outcome result = pairs( { "--srdf", "many.srdf", "--json", "pairs.json" } );
	EXPECT_EQ( result.status, 1 ) << result.err;
	const nlohmann::json all = json( "pairs.json" );
	const nlohmann::json finding = entry( all["findings"], "jaw_a", "jaw_b" );
	ASSERT_FALSE( finding.is_null() ) << result.out;
	EXPECT_EQ( finding["reason"], "Never" );
	// in contact: the jaws are 0.4 apart and come towards each other; nothing else moves them
	EXPECT_EQ( finding["joints"].size(), 2u );
	EXPECT_GE( finding["joints"]["jaw_a_joint"].get<double>() + finding["joints"]["jaw_b_joint"].get<double>(), 0.4 - 1e-9 );
	EXPECT_EQ( finding["state"].size(), all["variables"].size() );
	EXPECT_TRUE( contains( result.out, "jaw_a - jaw_b (Never): in contact" ) ) << result.out;
	EXPECT_TRUE( contains( result.out, "jaw_a_joint=" ) ) << result.out;
	// a wrong claim is told before decisions of a person or of the default state
	EXPECT_LT( result.out.find( "jaw_a - jaw_b (Never)" ), result.out.find( "lid - pot (Default)" ) );

	EXPECT_EQ( entry( all["pairs"], "left", "right" )["opinion"], "confirmed by proof" );
	EXPECT_EQ( entry( all["pairs"], "nut", "bolt" )["opinion"], "always in contact" );
	EXPECT_EQ( entry( all["pairs"], "left", "pot" )["opinion"], "could be disabled" );
	EXPECT_EQ( entry( all["pairs"], "left", "right" )["class"], "allowed" );
	EXPECT_TRUE( entry( all["findings"], "nut", "bolt" )["always"] );
	EXPECT_TRUE( contains( result.err, "tail" ) ) << "a link that the URDF lacks is told: " << result.err;
}

TEST_F( Pairs, ASrdfWithoutWrongClaimsGivesStatusZero )
{
	edit( "many.srdf", R"(<disable_collisions link1="jaw_a" link2="jaw_b" reason="Never"/>)", "" );
	edit( "many.srdf", R"(<disable_collisions link1="lid" link2="pot" reason="Default"/>)", "" );
	const Outcome result = pairs( { "--srdf", "many.srdf" } );
	EXPECT_EQ( result.status, 0 ) << result.out << result.err;
	EXPECT_FALSE( contains( result.out, "findings:" ) ) << result.out;
}

TEST_F( Pairs, TouchingNeighboursAreNoFinding )
{
	edit( "many.urdf", "<origin xyz=\"-0.4 0.3 0\"/>", "<origin xyz=\"-0.4 0.12 0\"/>" );
	write( "near.srdf", R"(<robot name="many"><disable_collisions link1="base" link2="left" reason="Adjacent"/></robot>)" );
	const Outcome result = pairs( { "--srdf", "near.srdf" } );
	EXPECT_EQ( result.status, 0 ) << result.out;
	EXPECT_FALSE( contains( result.out, "findings:" ) ) << result.out;
	EXPECT_TRUE( contains( result.out, "disabled neighbours for which a state in contact was found" ) ) << result.out;
	EXPECT_TRUE( contains( result.out, "base - left (Adjacent): in contact" ) ) << result.out;
}

TEST_F( Pairs, TheNewSrdfKeepsAllThatSomebodyWrote )
{
	const Outcome result = pairs( { "--srdf", "many.srdf", "--out", "new.srdf" } );
	EXPECT_EQ( result.status, 1 );
	const std::string text = readFile( path( "new.srdf" ) );
	for ( const char* kept :
	    { "<!-- written by hand -->", "<group name=\"jaws\">", "<!-- the first -->", "<group_state name=\"open\"",
	        "<end_effector name=\"grip\" parent_link=\"base\" group=\"jaws\"/>", "<passive_joint name=\"pot_joint\"/>",
	        "<virtual_joint name=\"stand\" type=\"fixed\" parent_frame=\"hall\" child_link=\"base\"/>",
	        "<something_new value=\"1 &amp; 2\"/>", "<!-- pairs -->", "<link_sphere_approximation link=\"base\"/>",
	        R"(<disable_collisions link1="left" link2="jaw_a" reason="I never drive there"/>)",
	        R"(<disable_collisions link1="gear_b" link2="gear_a" reason="User"/>)",
	        R"(<disable_collisions link1="left" link2="tail" reason="Never"/>)",
	        R"x(<disable_collisions link1="left" link2="right" reason="Never (hulls apart)"/>)x",
	        R"x(<disable_collisions link1="lid" link2="pot" reason="Default (in contact at the default state, and in )x",
	        R"x(<disable_collisions link1="bolt" link2="nut" reason="Always (in contact in all 200 random states)"/>)x",
	        R"(<disable_collisions link1="base" link2="left" reason="Adjacent"/>)",
	        R"(<disable_collisions link1="base" link2="flag" reason="Adjacent"/>)",
	        R"x(<disable_collisions link1="base" link2="pin" reason="Never (rigidly attached)"/>)x" } )
	{
		EXPECT_TRUE( contains( text, kept ) ) << kept << "\n" << text;
	}
	EXPECT_FALSE( contains( text, R"(link1="jaw_a" link2="jaw_b")" ) ) << text;
	EXPECT_FALSE( contains( text, R"(link1="gear_a" link2="gear_b")" ) ) << "kept and computed: " << text;
	EXPECT_LT( text.find( "<!-- pairs -->" ), text.find( "hulls apart" ) );
	EXPECT_LT( text.find( "hulls apart" ), text.find( "link_sphere_approximation" ) );
	EXPECT_TRUE( contains( result.out, "enabled again: jaw_a - jaw_b was disabled as Never" ) ) << result.out;
	EXPECT_TRUE( contains( result.out, "free in other states: lid - pot" ) ) << result.out;
}

TEST_F( Pairs, WithoutAnSrdfANewOneNamesItsProofs )
{
	EXPECT_EQ( pairs( { "--out", "new.srdf" } ).status, 0 );
	const std::string text = readFile( path( "new.srdf" ) );
	EXPECT_TRUE( contains( text, "<robot name=\"many\">" ) ) << text;
	EXPECT_TRUE( contains( text, R"x(link1="gear_a" link2="gear_b" reason="Never (joint box certified)")x" ) ) << text;
	EXPECT_TRUE( contains( text, R"x(link1="left" link2="right" reason="Never (hulls apart)")x" ) ) << text;
}

TEST_F( Pairs, TheNewSrdfReloadsAndFreesTheDefaultState )
{
	ASSERT_EQ( pairs( { "--srdf", "many.srdf", "--out", "new.srdf" } ).status, 1 );
	write( "zero.csv", "jaw_a_joint,lid_joint\n0,0\n0,0.3\n" );
	const std::vector<std::string> check = { "check", "--robot", "many.urdf", "--states", "zero.csv", "--what", "self" };
	const auto with = [&]( const std::string& file )
	{
		std::vector<std::string> arguments = check;
		arguments.insert( arguments.end(), { "--srdf", file } );
		return run( arguments );
	};
	edit( "many.srdf", R"(<disable_collisions link1="lid" link2="pot" reason="Default"/>)", "" );
	EXPECT_EQ( with( "many.srdf" ).status, 1 ); // the lid is on the pot
	const Outcome freed = with( "new.srdf" );
	EXPECT_EQ( freed.status, 0 ) << freed.out << freed.err;
	// judged again, only the contacts at the default state are left to be told
	const Outcome again = pairs( { "--srdf", "new.srdf", "--json", "again.json", "--out", "newer.srdf" } );
	EXPECT_EQ( again.status, 1 );
	EXPECT_TRUE( entry( json( "again.json" )["findings"], "jaw_a", "jaw_b" ).is_null() );
	EXPECT_EQ( readFile( path( "new.srdf" ) ), readFile( path( "newer.srdf" ) ) );
}

TEST_F( Pairs, TwoRunsWriteTheSame )
{
	const Outcome first = pairs( { "--srdf", "many.srdf", "--out", "first.srdf", "--json", "first.json" } );
	const Outcome second = pairs( { "--srdf", "many.srdf", "--out", "second.srdf", "--json", "second.json" } );
	EXPECT_EQ( readFile( path( "first.srdf" ) ), readFile( path( "second.srdf" ) ) );
	EXPECT_EQ( json( "first.json" )["pairs"], json( "second.json" )["pairs"] );
	EXPECT_EQ( json( "first.json" )["findings"], json( "second.json" )["findings"] );
}

TEST_F( Pairs, LinksDisabledByDefaultStayAsTheyAre )
{
	write( "default.srdf", R"(<robot name="many"><disable_default_collisions link="left"/>
<enable_collisions link1="left" link2="right"/></robot>)" );
	EXPECT_EQ( pairs( { "--srdf", "default.srdf", "--out", "new.srdf" } ).status, 0 );
	const std::string text = readFile( path( "new.srdf" ) );
	EXPECT_TRUE( contains( text, R"(<disable_default_collisions link="left"/>)" ) ) << text;
	EXPECT_TRUE( contains( text, R"(<enable_collisions link1="left" link2="right"/>)" ) ) << text;
	EXPECT_FALSE( contains( text, R"(link1="left" link2="nut")" ) ) << "disabled twice: " << text;
	EXPECT_TRUE( contains( text, R"x(link1="left" link2="right" reason="Never (hulls apart)")x" ) ) << text;
}

// ---- odd robots and bad input

namespace
{

struct BadCase
{
	std::string name, file, from, to; ///< `from` replaced by `to` in `file`; `from` empty: none
	std::vector<std::string> arguments, words;
};

std::ostream& operator<<( std::ostream& stream, const BadCase& value )
{
	return stream << value.name;
}

const std::string left_limit = R"(<axis xyz="0 1 0"/><limit lower="0" upper="0.2" effort="1" velocity="1"/></joint>
  <joint name="right_joint")";

std::vector<BadCase> badCases()
{
	const std::vector<std::string> out = { "--out", "new.srdf", "--json", "pairs.json" };
	return {
	    { "RobotMissing", "", "", "", { "--robot", "none.urdf" }, { "none.urdf", "no such file" } },
	    { "SrdfMissing", "", "", "", { "--srdf", "none.srdf" }, { "none.srdf" } },
	    { "BudgetNegative", "", "", "", { "--budget", "-1" }, { "--budget", "-1" } },
	    { "BudgetNan", "", "", "", { "--budget", "nan" }, { "--budget", "nan" } },
	    { "BudgetInfinite", "", "", "", { "--budget", "inf" }, { "--budget" } },
	    { "BudgetText", "", "", "", { "--budget", "long" }, { "--budget" } },
	    { "SamplesNegative", "", "", "", { "--samples", "-5" }, { "--samples" } },
	    { "NeverAfterNegative", "", "", "", { "--never-after", "-5" }, { "--never-after" } },
	    { "NeverAfterText", "", "", "", { "--never-after", "often" }, { "--never-after" } },
	    { "OutInMissingFolder", "", "", "", { "--out", "none/new.srdf" }, { "none/new.srdf", "cannot be written" } },
	    { "OutIsAFolder", "", "", "", { "--out", "." }, { "cannot be written" } },
	    { "CacheIsAFile", "", "", "", { "--cache", "many.urdf" }, { "many.urdf", "cache", "not a folder" } },
	    { "CacheUnderAFile", "", "", "", { "--cache", "many.urdf/cache" }, { "many.urdf/cache", "cache" } },
	    { "SceneNotTaken", "", "", "", { "--scene", "scene.yaml" }, { "--scene" } },
	    { "JointWithoutLimits", "many.urdf", left_limit, "</joint>\n  <joint name=\"right_joint\"", out,
	        { "many.urdf", "left_joint", "has no <limit>", "continuous" } },
	    { "LimitsReversed", "many.urdf", R"(lower="-3" upper="3")", R"(lower="3" upper="-3")", out,
	        { "many.urdf", "gear_a_joint", "lower limit 3 is above upper limit -3", "swap" } },
	    { "DisconnectedTree", "many.urdf", "</robot>", "<link name=\"island\"/></robot>", out,
	        { "many.urdf", "2 root links", "island", "connect" } },
	    { "Loop", "many.urdf", "</robot>",
	        R"(<joint name="back" type="fixed"><parent link="pin"/><child link="base"/></joint></robot>)", out,
	        { "many.urdf", "cycle", "remove one joint" } },
	    { "TwoParents", "many.urdf", "</robot>",
	        R"(<joint name="second" type="fixed"><parent link="left"/><child link="pin"/></joint></robot>)", out,
	        { "many.urdf", "pin", "already the child" } },
	    { "MimicOfItself", "many.urdf", R"(<mimic joint="gear_a_joint"/>)", R"(<mimic joint="gear_b_joint"/>)", out,
	        { "many.urdf", "gear_b_joint" } },
	    { "MimicOfNothing", "many.urdf", R"(<mimic joint="gear_a_joint"/>)", R"(<mimic joint="crank"/>)", out,
	        { "many.urdf", "gear_b_joint", "crank" } },
	    { "NoGeometry", "many.urdf", "", "<robot name=\"many\"><link name=\"base\"/></robot>", out,
	        { "many.urdf", "no link has collision geometry" } },
	};
}

class PairsBadInput : public Pairs, public testing::WithParamInterface<BadCase>
{
};

std::string badName( const testing::TestParamInfo<BadCase>& info )
{
	return info.param.name;
}

} // namespace

TEST_P( PairsBadInput, IsNamedAndLeavesNothing )
{
	const BadCase& bad = GetParam();
	if ( !bad.file.empty() )
	{
		bad.from.empty() ? write( bad.file, bad.to ) : edit( bad.file, bad.from, bad.to );
	}
	const std::vector<std::string> before = files();
	std::vector<std::string> arguments = { "pairs", "--samples", "10" };
	const auto given = [&]( const std::string& option )
	{ return std::find( bad.arguments.begin(), bad.arguments.end(), option ) != bad.arguments.end(); };
	for ( const auto& [option, value] : { std::pair( "--robot", "many.urdf" ), std::pair( "--budget", "0" ) } )
	{
		if ( !given( option ) )
		{
			arguments.insert( arguments.end(), { option, value } );
		}
	}
	if ( given( "--samples" ) )
	{
		arguments.erase( arguments.begin() + 1, arguments.begin() + 3 );
	}
	arguments.insert( arguments.end(), bad.arguments.begin(), bad.arguments.end() );
	const Outcome result = run( arguments );
	EXPECT_EQ( result.status, 2 ) << result.out << result.err;
	EXPECT_EQ( result.out, "" );
	const std::size_t error = result.err.find( "leeway: error: " );
	ASSERT_NE( error, std::string::npos ) << result.err;
	const std::string message = result.err.substr( error );
	EXPECT_FALSE( contains( message, "internal" ) ) << message;
	for ( const std::string& word : bad.words )
	{
		EXPECT_TRUE( contains( message, word ) ) << "lacks '" << word << "': " << message;
	}
	EXPECT_EQ( files(), before );
}

INSTANTIATE_TEST_SUITE_P( Everything, PairsBadInput, testing::ValuesIn( badCases() ), badName );

TEST_F( Pairs, AMimicOfAMimicFollowsTheFirst )
{
	// pot follows gear_b, which follows gear_a: the lid's height and gear_a move pot against lid
	edit( "many.urdf", R"(<limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
  <joint name="lid_joint")",
	    R"(<limit lower="-1" upper="1" effort="1" velocity="1"/><mimic joint="gear_b_joint"/></joint>
  <joint name="lid_joint")" );
	const Outcome result = pairs( { "--srdf", "many.srdf", "--json", "pairs.json" } );
	ASSERT_EQ( result.status, 1 ) << result.err;
	const nlohmann::json finding = entry( json( "pairs.json" )["findings"], "lid", "pot" );
	ASSERT_FALSE( finding.is_null() );
	EXPECT_TRUE( finding["joints"].contains( "gear_a_joint" ) ) << finding;
	EXPECT_TRUE( finding["joints"].contains( "lid_joint" ) ) << finding;
	EXPECT_FALSE( finding["joints"].contains( "pot_joint" ) ) << finding;
}

TEST_F( Pairs, ZeroLengthLinksAndUnlimitedSlidesAreCovered )
{
	// jaw_b's origin on jaw_a's; left may go anywhere along y
	edit( "many.urdf", "<origin xyz=\"0.5 2 0\"/>", "<origin xyz=\"0 2 0\"/>" );
	edit( "many.urdf", R"(<axis xyz="0 1 0"/><limit lower="0" upper="0.2")",
	    R"(<axis xyz="0 1 0"/><limit lower="0" upper="1e6")" );
	const Outcome result = pairs( { "--json", "pairs.json" } );
	ASSERT_EQ( result.status, 0 ) << result.err;
	const nlohmann::json all = json( "pairs.json" );
	EXPECT_EQ( entry( all["pairs"], "jaw_a", "jaw_b" )["closest"], 0 );
	EXPECT_EQ( entry( all["pairs"], "left", "right" )["class"], "never" );
}

class PairsData : public Pairs
{
protected:
	void SetUp() override
	{
		Pairs::SetUp();
		if ( !std::filesystem::exists( LEEWAY_DATA_DIR "/README.md" ) )
		{
			GTEST_SKIP() << "no data in " LEEWAY_DATA_DIR;
		}
	}
};

// Panda's SRDF calls a pair Never that can collide. Where all other pairs are disabled, the state that is shown for it must
// be blocked by it.
TEST_F( PairsData, TheEvidenceOfAFindingIsAContact )
{
	const std::string panda = LEEWAY_DATA_DIR "/mbm/panda/panda";
	const Outcome result =
	    run( { "pairs", "--robot", panda + ".urdf", "--srdf", panda + ".srdf", "--budget", "1", "--json", "pairs.json" } );
	ASSERT_EQ( result.status, 1 ) << result.err;
	const nlohmann::json all = json( "pairs.json" );
	const nlohmann::json finding = entry( all["findings"], "panda_link2", "panda_link6" );
	ASSERT_FALSE( finding.is_null() ) << result.out;
	EXPECT_EQ( finding["reason"], "Never" );
	std::string header, row, srdf = "<robot name=\"panda\">\n";
	for ( std::size_t i = 0; i < all["variables"].size(); ++i )
	{
		header += ( i > 0 ? "," : "" ) + all["variables"][i].get<std::string>();
		row += ( i > 0 ? "," : "" ) + finding["state"][i].dump();
	}
	write( "evidence.csv", header + "\n" + row + "\n" );
	for ( const nlohmann::json& pair : all["pairs"] )
	{
		if ( pair["link1"] != finding["link1"] || pair["link2"] != finding["link2"] )
		{
			srdf += "<disable_collisions link1=" + pair["link1"].dump() + " link2=" + pair["link2"].dump() + "/>\n";
		}
	}
	write( "only.srdf", srdf + "</robot>" );
	const Outcome blocked =
	    run( { "check", "--robot", panda + ".urdf", "--srdf", "only.srdf", "--states", "evidence.csv", "--what", "self" } );
	EXPECT_EQ( blocked.status, 1 ) << blocked.out << blocked.err;
	EXPECT_EQ( parseTable( blocked.out ).rows.at( 0 ).at( "self_upper" ), "0" ) << blocked.out;
}
