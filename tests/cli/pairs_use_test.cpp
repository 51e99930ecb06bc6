// SPDX-License-Identifier: BSD-3-Clause
// leeway pairs: can one plan with the SRDF that it writes? Overlaps by design, evidence, near pairs, share of free states.
#include "pairs_fixture.hpp"

namespace
{

class PairsUse : public Pairs
{
protected:
	/// Puts the lid `above` the pot (metres, at 0) and lets it slide from `lower` to `upper`.
	void slideLid( double above, const std::string& lower, const std::string& upper )
	{
		edit( "many.urdf", "<origin xyz=\"0 -2 0.1\"/>", "<origin xyz=\"0 -2 " + std::to_string( 0.15 + above ) + "\"/>" );
		edit( "many.urdf", R"(lower="0" upper="0.5")", "lower=\"" + lower + "\" upper=\"" + upper + "\"" );
	}
	/// An SRDF that disables `pairs` ("a b reason").
	void disable( const std::vector<std::vector<std::string>>& pairs )
	{
		std::string text = "<robot name=\"many\">\n";
		for ( const std::vector<std::string>& pair : pairs )
		{
			text += "<disable_collisions link1=\"" + pair[0] + "\" link2=\"" + pair[1] + "\" reason=\"" + pair[2] + "\"/>\n";
		}
		write( "given.srdf", text + "</robot>\n" );
	}
	/// The reason with which a file disables two links (in alphabetical order); empty if it does not.
	std::string reason( const std::string& file, const std::string& first, const std::string& second ) const
	{
		const std::string text = readFile( path( file ) );
		const std::string begin = "link1=\"" + first + "\" link2=\"" + second + "\" reason=\"";
		const std::size_t at = text.find( begin );
		return at == std::string::npos
		           ? ""
		           : text.substr( at + begin.size(), text.find( '"', at + begin.size() ) - at - begin.size() );
	}
};

/// A box that four slides move over another: the links in between are far away.
std::string chain()
{
	std::string text =
	    R"(<robot name="chain"><link name="base"><collision><geometry><box size="1 1 1"/></geometry></collision></link>)";
	std::string parent = "base";
	for ( const std::string name : { "a", "b", "c", "tip" } )
	{
		const bool last = name == "tip";
		text += "<link name=\"" + name + "\"><collision><origin xyz=\"" +
		        ( last ? "0.56 0 0" : "0 0 " + std::to_string( 5 + name[0] - 'a' ) ) +
		        "\"/><geometry><box size=\"0.1 0.1 0.1\"/></geometry></collision></link>\n<joint name=\"j" + name +
		        "\" type=\"prismatic\"><parent link=\"" + parent + "\"/><child link=\"" + name +
		        "\"/><axis xyz=\"1 0 0\"/><limit lower=\"-0.35\" upper=\"0.25\" effort=\"1\" velocity=\"1\"/></joint>\n";
		parent = name;
	}
	return text + "</robot>";
}

} // namespace

TEST_F( PairsUse, AnOverlapInMostStatesIsDisabledWithItsShare )
{
	slideLid( 0.001, "-0.2", "0.05" ); // free at 0, in contact in 80 % of the range
	const Outcome result = pairs( { "--out", "new.srdf", "--json", "pairs.json" } );
	ASSERT_EQ( result.status, 0 ) << result.err;
	const nlohmann::json pair = entry( json( "pairs.json" )["pairs"], "lid", "pot" );
	EXPECT_NEAR( pair["contact_share"].get<double>(), 0.8, 0.12 ) << pair;
	const std::string why = reason( "new.srdf", "lid", "pot" );
	EXPECT_EQ( why.rfind( "Default (in contact in ", 0 ), 0u ) << why;
	EXPECT_TRUE( contains( why, " % of 200 random states)" ) ) << why;
	EXPECT_EQ( reason( "new.srdf", "jaw_a", "jaw_b" ), "" ) << "contact in a fifth of the states is a collision";
	EXPECT_TRUE( contains( result.out, "free in other states: lid - pot, in contact in " ) ) << result.out;
}

// Judged again, the new file's own words on overlaps must not be findings.
TEST_F( PairsUse, AnOverlapByDesignIsNoFinding )
{
	slideLid( 0.001, "-0.2", "0.05" );
	disable( { { "lid", "pot", "Always" } } );
	const Outcome result = pairs( { "--srdf", "given.srdf", "--out", "new.srdf", "--json", "pairs.json" } );
	EXPECT_EQ( result.status, 0 ) << result.out;
	EXPECT_TRUE(
	    contains( entry( json( "pairs.json" )["pairs"], "lid", "pot" )["opinion"].get<std::string>(), "by design" ) );
	EXPECT_FALSE( entry( json( "pairs.json" )["findings"], "lid", "pot" ).is_null() );
	EXPECT_FALSE( contains( result.out, "enabled again: lid - pot" ) ) << result.out;
	const Outcome again = pairs( { "--srdf", "new.srdf", "--out", "newer.srdf" } );
	EXPECT_EQ( again.status, 0 ) << again.out;
	EXPECT_EQ( readFile( path( "new.srdf" ) ), readFile( path( "newer.srdf" ) ) );
}

// In contact more often than not, but four joints lie between: these links can get out of each other's way.
TEST_F( PairsUse, ContactOverALongChainStaysEnabled )
{
	write( "chain.urdf", chain() );
	const Outcome result = run( { "pairs", "--robot", "chain.urdf", "--budget", "0", "--samples", "300", "--out", "new.srdf",
	    "--json", "pairs.json" } );
	ASSERT_EQ( result.status, 0 ) << result.err;
	const nlohmann::json pair = entry( json( "pairs.json" )["pairs"], "base", "tip" );
	EXPECT_GT( pair["contact_share"].get<double>(), 0.55 ) << pair;
	EXPECT_LT( pair["contact_share"].get<double>(), 0.9 ) << pair;
	EXPECT_EQ( reason( "new.srdf", "base", "tip" ), "" );
}

TEST_F( PairsUse, ClaimsOfContactThatIsThereStay )
{
	slideLid( 0.001, "-0.02", "0.05" ); // free at 0, in contact in 27 % of the range
	disable( { { "lid", "pot", "Default" } } );
	ASSERT_EQ( pairs( { "--srdf", "given.srdf", "--out", "new.srdf" } ).status, 1 );
	EXPECT_EQ( reason( "new.srdf", "lid", "pot" ).rfind( "Default (in contact in ", 0 ), 0u )
	    << readFile( path( "new.srdf" ) );
	// nobody's claim, or a claim that there is no contact: to be checked
	ASSERT_EQ( pairs( { "--out", "new.srdf" } ).status, 0 );
	EXPECT_EQ( reason( "new.srdf", "lid", "pot" ), "" );
}

TEST_F( PairsUse, TheCostOfEnablingIsTold )
{
	slideLid( 0.001, "-0.02", "0.05" );
	disable( { { "lid", "pot", "Never" }, { "jaw_a", "jaw_b", "Default" }, { "bolt", "nut", "Default" } } );
	const Outcome result = pairs( { "--srdf", "given.srdf", "--out", "new.srdf", "--json", "pairs.json" } );
	ASSERT_EQ( result.status, 1 ) << result.err;
	EXPECT_EQ( reason( "new.srdf", "lid", "pot" ), "" );
	EXPECT_TRUE( contains( result.out, "enabled again: lid - pot was disabled as Never, but is in contact in " ) )
	    << result.out;
	EXPECT_TRUE( contains( result.out, "the pairs enabled again (1) block " ) ) << result.out;
	const nlohmann::json use = json( "pairs.json" )["usability"];
	EXPECT_EQ( use["states"], 200 );
	EXPECT_NEAR( use["cost_of_enabled_again"].get<double>(), 0.27 * 200, 30 ) << use;
	EXPECT_NEAR( use["free_new"].get<double>(), 0.73 * 200, 35 ) << use;
	EXPECT_EQ( use["free_given"].get<int>(), use["free_new"].get<int>() + use["cost_of_enabled_again"].get<int>() ) << use;
}

TEST_F( PairsUse, TheShareOfFreeStatesIsTold )
{
	const Outcome result = pairs( { "--out", "new.srdf", "--json", "pairs.json" } );
	ASSERT_EQ( result.status, 0 ) << result.err;
	EXPECT_TRUE( contains( result.out, "free of self contact, of 200 random states: 0.0 % without an SRDF, " ) )
	    << result.out;
	EXPECT_TRUE( contains( result.out, "the default state is free" ) ) << result.out;
	EXPECT_FALSE( contains( result.out, "block most" ) ) << result.out;
	// all that is left is the jaws: they meet if both are out by 0.4 in all, of 0.3 each
	const nlohmann::json use = json( "pairs.json" )["usability"];
	EXPECT_EQ( use["free_given"], 0 );
	EXPECT_NEAR( use["free_new"].get<double>(), 0.78 * 200, 25 ) << use;
	ASSERT_EQ( use["blocking"].size(), 1u ) << use;
	EXPECT_EQ( use["blocking"][0]["link1"], "jaw_a" );
	EXPECT_EQ( use["blocking"][0]["alone"], use["blocking"][0]["states"] );
	EXPECT_EQ( use["free_new"].get<int>() + use["blocking"][0]["states"].get<int>(), 200 );
}

TEST_F( PairsUse, AContactThatBlocksEveryStateIsNamed )
{
	const Outcome result = pairs( {} );
	ASSERT_EQ( result.status, 0 ) << result.err;
	EXPECT_TRUE( contains( result.out, "of 200 random states: 0.0 % without an SRDF\n" ) ) << result.out;
	EXPECT_TRUE( contains( result.out, "the default state is not free: " ) ) << result.out;
	EXPECT_TRUE( contains( result.out, "bolt - nut: in contact in 100 %" ) ) << result.out;
	EXPECT_TRUE( contains( result.out, "--out writes an SRDF without the pairs that touch by design" ) ) << result.out;
}

TEST_F( PairsUse, NeverSeenIsDisabledOnlyOnRequestAndSaysSo )
{
	// no time for the proof that the gears stay apart
	const auto gears = [&]( std::vector<std::string> more )
	{
		more.insert( more.end(), { "--budget", "0", "--out", "new.srdf", "--json", "pairs.json" } );
		std::vector<std::string> arguments = { "pairs", "--robot", "many.urdf", "--samples", "200" };
		arguments.insert( arguments.end(), more.begin(), more.end() );
		return run( arguments );
	};
	disable( { { "gear_a", "gear_b", "Never" } } );
	ASSERT_EQ( gears( { "--srdf", "given.srdf" } ).status, 0 );
	EXPECT_EQ( reason( "new.srdf", "gear_a", "gear_b" ), "" );
	EXPECT_EQ( entry( json( "pairs.json" )["pairs"], "gear_a", "gear_b" )["opinion"], "not proved" );
	EXPECT_TRUE( entry( json( "pairs.json" )["pairs"], "gear_a", "gear_b" )["never_seen_states"].is_null() );

	ASSERT_EQ( gears( { "--srdf", "given.srdf", "--never-after", "5000" } ).status, 0 );
	EXPECT_EQ( reason( "new.srdf", "gear_a", "gear_b" ), "Never (evidence only: no contact in 5000 random states)" );
	EXPECT_EQ( reason( "new.srdf", "jaw_a", "jaw_b" ), "" ) << "in contact in a fifth of the states";
	const nlohmann::json pair = entry( json( "pairs.json" )["pairs"], "gear_a", "gear_b" );
	EXPECT_TRUE( contains( pair["opinion"].get<std::string>(), "no proof" ) ) << pair;
	EXPECT_EQ( pair["never_seen_states"], 5000 );
	EXPECT_EQ( pair["separation"], 0 );
	EXPECT_TRUE( pair["proof"].is_null() ) << pair;
	// not carried on: without the option it is to be proved again
	write( "given.srdf", readFile( path( "new.srdf" ) ) );
	const Outcome again = gears( { "--srdf", "given.srdf" } );
	EXPECT_TRUE( contains( again.out, "enabled again: gear_a - gear_b was disabled as Never (evidence only" ) ) << again.out;
}

TEST_F( PairsUse, NearPairsAreNamedWithTheirDistances )
{
	edit( "many.urdf", R"("lid_joint" type="prismatic")", R"("lid_joint" type="revolute")" );
	edit( "many.urdf", "<origin xyz=\"0 -2 0.1\"/>", "<origin xyz=\"0 -2 0.15102\"/>" );
	const Outcome result = pairs( { "--json", "pairs.json" } );
	ASSERT_EQ( result.status, 0 ) << result.err;
	EXPECT_TRUE( contains( result.out, "near by design: lid - pot 1.02 to 1.02 mm in 200 random states" ) ) << result.out;
	const nlohmann::json near = json( "pairs.json" )["near"];
	ASSERT_EQ( near.size(), 1u ) << near;
	EXPECT_EQ( near[0]["link1"], "lid" );
	EXPECT_NEAR( near[0]["least"].get<double>(), 0.00102, 1e-9 );
	EXPECT_NEAR( near[0]["most"].get<double>(), 0.00102, 1e-9 );
}

TEST_F( PairsUse, ALidThatIsNearNowAndThenIsNotNearByDesign )
{
	slideLid( 0.001, "0", "0.05" );
	const Outcome result = pairs( {} );
	EXPECT_FALSE( contains( result.out, "near by design" ) ) << result.out;
}

TEST_F( PairsUse, WithoutRandomStatesTheDefaultStateDecides )
{
	const Outcome result =
	    run( { "pairs", "--robot", "many.urdf", "--budget", "1", "--samples", "0", "--out", "new.srdf" } );
	ASSERT_EQ( result.status, 0 ) << result.err;
	EXPECT_EQ( reason( "new.srdf", "lid", "pot" ), "Default (in contact at the default state)" );
	EXPECT_FALSE( contains( result.out, "random states:" ) ) << result.out;
}
