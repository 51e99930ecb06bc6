// SPDX-License-Identifier: BSD-3-Clause
// SRDFs that are written: computed pairs replaced, everything else kept.
#include "files.hpp"

#include "leeway/io/spheres.hpp"

#include <nlohmann/json.hpp>

using namespace leeway;
using namespace leeway::io;

namespace
{

class SrdfWriter : public FileTest
{
protected:
	RobotModel robot( const std::string& srdf )
	{
		std::string urdf = "<robot name=\"r &amp; s\">";
		for ( const char* name : { "a", "b", "c", "d" } )
		{
			urdf += "<link name=\"" + std::string( name ) +
			        "\"><collision><geometry><sphere radius=\"0.1\"/></geometry></collision></link>";
			if ( name[0] != 'a' )
			{
				urdf += "<joint name=\"j" + std::string( name ) +
				        "\" type=\"continuous\"><parent link=\"a\"/><child link=\"" + name + "\"/></joint>";
			}
		}
		write( "r.urdf", urdf + "</robot>" );
		if ( srdf.empty() )
		{
			return loadRobot( path( "r.urdf" ), "" );
		}
		write( "r.srdf", srdf );
		return loadRobot( path( "r.urdf" ), path( "r.srdf" ) );
	}
	static bool has( const std::string& text, const std::string& part ) { return text.find( part ) != std::string::npos; }
	/// The text read back as this robot's SRDF.
	RobotModel reload( const std::string& text )
	{
		write( "new.srdf", text );
		return loadRobot( path( "r.urdf" ), path( "new.srdf" ) );
	}
};

} // namespace

TEST_F( SrdfWriter, ReasonsOfOthersAreNotComputed )
{
	for ( const char* reason : { "Adjacent", "Never", "Default", "Always", "Never (hulls apart)",
	          "Default (in contact in 91.3 % of 2000 random states)", "Always (in contact in all 2000 random states)",
	          "Never (evidence only: no contact in 100000 random states)" } )
	{
		EXPECT_TRUE( isComputedReason( reason ) ) << reason;
	}
	for ( const char* reason : { "", "User", "IgnoreCollision", "never", "Never mind", "Adjacents", " Never" } )
	{
		EXPECT_FALSE( isComputedReason( reason ) ) << reason;
	}
}

TEST_F( SrdfWriter, PairsAreSortedAndReadBack )
{
	const RobotModel model = robot( "" );
	const WrittenSrdf srdf = writeSrdf(
	    model, { { "d", "c", "Never (\"quoted\" & <odd>)" }, { "b", "a", "Adjacent" }, { "a", "c", "Adjacent" } } );
	ASSERT_EQ( srdf.written.size(), 3u );
	EXPECT_EQ( srdf.written[0].link2, "b" );
	const RobotModel again = reload( srdf.text );
	EXPECT_TRUE( again.report.notices.empty() ) << allNotices( again.report.notices );
	ASSERT_EQ( again.disabled.size(), 3u );
	EXPECT_EQ( again.disabled[0].link1, "a" );
	EXPECT_EQ( again.disabled[0].link2, "b" );
	EXPECT_EQ( again.disabled[2].link1, "c" );
	EXPECT_EQ( again.disabled[2].reason, "Never (\"quoted\" & <odd>)" );
}

TEST_F( SrdfWriter, NothingToWriteLeavesTheRest )
{
	const RobotModel model = robot( "<robot name=\"r &amp; s\"><group name=\"g\"><joint name=\"jb\"/></group>"
	                                "<disable_collisions link1=\"a\" link2=\"b\" reason=\"Never\"/></robot>" );
	const WrittenSrdf srdf = writeSrdf( model, {} );
	EXPECT_FALSE( has( srdf.text, "disable_collisions" ) ) << srdf.text;
	EXPECT_EQ( reload( srdf.text ).groups.size(), 1u );
}

TEST_F( SrdfWriter, PairsComeWhereTheOldOnesWere )
{
	const RobotModel model =
	    robot( "<robot name=\"r &amp; s\"><disable_collisions link1=\"a\" link2=\"b\" reason=\"Never\"/>"
	           "<!-- middle --><disable_collisions link1=\"a\" link2=\"c\" reason=\"Never\"/><!-- end --></robot>" );
	const std::string text = writeSrdf( model, { { "b", "c", "Never" } } ).text;
	EXPECT_LT( text.find( "link1=\"b\"" ), text.find( "middle" ) ) << text;
	EXPECT_LT( text.find( "middle" ), text.find( "end" ) ) << text;
}

TEST_F( SrdfWriter, DecisionsCoverComputedPairs )
{
	const RobotModel model =
	    robot( "<robot name=\"r &amp; s\"><disable_collisions link1=\"b\" link2=\"a\" reason=\"Never\"/>"
	           "<disable_collisions link1=\"a\" link2=\"b\" reason=\"Bolted by hand\"/>"
	           "<disable_collisions link1=\"a\" link2=\"c\"/><disable_default_collisions link=\"d\"/>"
	           "<enable_collisions link1=\"d\" link2=\"b\"/></robot>" );
	const WrittenSrdf srdf = writeSrdf( model, { { "a", "b", "Never" }, { "a", "c", "Adjacent" }, { "c", "d", "Never" },
	                                               { "b", "d", "Never" }, { "b", "c", "Never" } } );
	ASSERT_EQ( srdf.written.size(), 2u ) << srdf.text;
	EXPECT_EQ( srdf.written[0].link2, "c" );
	EXPECT_EQ( srdf.written[1].link2, "d" );
	ASSERT_EQ( srdf.kept.size(), 2u );
	EXPECT_EQ( srdf.kept[0].reason, "Bolted by hand" );
	EXPECT_EQ( srdf.kept[1].reason, "" );
	EXPECT_TRUE( has( srdf.text, "<disable_default_collisions link=\"d\"/>" ) ) << srdf.text;
	EXPECT_TRUE( has( srdf.text, "<enable_collisions link1=\"d\" link2=\"b\"/>" ) ) << srdf.text;
}

TEST_F( SrdfWriter, AnSrdfThatVanishedIsAnError )
{
	const RobotModel model = robot( "<robot name=\"r &amp; s\"/>" );
	std::filesystem::remove( path( "r.srdf" ) );
	expectError( [&] { writeSrdf( model, {} ); }, { "r.srdf", "no such file" } );
}

// YAML takes JSON's quotes: names come back whatever is in them, and so do numbers.
TEST( SphereFiles, NamesAndNumbersOfYamlComeBack )
{
	RobotModel model;
	model.name = "robot \"two\"";
	std::vector<LinkSpheres> links;
	for ( const char* name : { "plain", "with \"quotes\"", "back\\slash", "\\\"", "colon: # no comment", "\xc3\xa4" } )
	{
		LinkSpheres link;
		link.link = name;
		link.spheres = { 0.125, -2, 3.5, 0.25 };
		links.push_back( link );
	}
	const std::string text = writeSpheresYaml( model, links );
	EXPECT_EQ( text.find( "robot: " + nlohmann::json( model.name ).dump() + "\n" ), 0u ) << text;
	std::size_t at = 0;
	for ( const LinkSpheres& link : links )
	{
		at = text.find( "\n  " + nlohmann::json( link.link ).dump() + ": #", at );
		ASSERT_NE( at, std::string::npos ) << link.link << " in\n" << text;
		const std::size_t begin = text.find( '[', at ), end = text.find( ']', begin ),
		                  radius = text.find( "\"radius\": ", end );
		ASSERT_NE( radius, std::string::npos );
		EXPECT_EQ( nlohmann::json::parse( text.substr( begin, end + 1 - begin ) ), nlohmann::json( { 0.125, -2.0, 3.5 } ) );
		EXPECT_EQ( std::stod( text.substr( radius + 10 ) ), 0.25 );
	}
}
