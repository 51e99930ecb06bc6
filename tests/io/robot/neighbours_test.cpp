// SPDX-License-Identifier: BSD-3-Clause
// Robots without an SRDF: pairs of links that may touch, and why.
#include "files.hpp"

using namespace leeway::io;

namespace
{

std::string linkXml( const std::string& name, double radius )
{
	const std::string shape =
	    radius > 0 ? "<collision><geometry><sphere radius=\"" + std::to_string( radius ) + "\"/></geometry></collision>"
	               : "";
	return "<link name=\"" + name + "\">" + shape + "</link>";
}

std::string jointXml( const std::string& name, const std::string& parent, const std::string& child, const std::string& x,
    const std::string& type = "revolute", const std::string& reach = "1.5" )
{
	return "<joint name=\"" + name + "\" type=\"" + type + "\"><parent link=\"" + parent + "\"/><child link=\"" + child +
	       "\"/><origin xyz=\"" + x + " 0 0\"/><axis xyz=\"0 0 1\"/><limit lower=\"-" + reach + "\" upper=\"" + reach +
	       "\"/></joint>";
}

class NeighboursTest : public FileTest
{
protected:
	/// a, b and c a metre apart, with nothing but a frame between b and c.
	RobotModel load( double radius_of_c, bool strict = false )
	{
		LoadOptions options;
		options.strict = strict;
		return loadRobot(
		    write( "r.urdf", "<robot name=\"r\">" + linkXml( "a", 0.1 ) + linkXml( "b", 0.1 ) + linkXml( "frame", 0 ) +
		                         linkXml( "c", radius_of_c ) + jointXml( "j", "a", "b", "1" ) +
		                         jointXml( "k", "b", "frame", "0.5" ) + jointXml( "l", "frame", "c", "0.5" ) + "</robot>" ),
		    "", options );
	}
};

} // namespace

TEST_F( NeighboursTest, LinksThatAJointJoinsMayTouch )
{
	const RobotModel model = load( 0.1 );
	ASSERT_EQ( model.disabled.size(), 2u );
	EXPECT_EQ( model.disabled[0].reason, "Adjacent (joined by j)" );
	EXPECT_EQ( model.disabled[1].link1 + " " + model.disabled[1].link2, "b c" ) << "a link without geometry is no neighbour";
	EXPECT_TRUE( isComputedReason( model.disabled[1].reason ) ) << "leeway pairs decides anew";
	EXPECT_NOTICE( model.report.notices,
	    "contact of 2 pairs of links is allowed, and checked with --strict: a - b (joined by j), b - c" );
}

TEST_F( NeighboursTest, LinksInContactInAllStatesMayTouch )
{
	const RobotModel model = load( 2.5 );
	ASSERT_EQ( model.disabled.size(), 3u );
	EXPECT_EQ( model.disabled[2].link1 + " " + model.disabled[2].link2, "a c" );
	EXPECT_EQ( model.disabled[2].reason, "Always (in contact in all of 200 random states)" );
	EXPECT_EQ( load( 1.2 ).disabled.size(), 2u ) << "a and c are in contact in some states only";
}

TEST_F( NeighboursTest, StatesWithoutPosesAreTakenForContact )
{
	const RobotModel model =
	    loadRobot( write( "r.urdf", "<robot name=\"r\">" + linkXml( "a", 1 ) + linkXml( "b", 0.1 ) + linkXml( "c", 1 ) +
	                                    jointXml( "j", "a", "b", "0.1", "prismatic", "1e308" ) +
	                                    jointXml( "k", "b", "c", "0.1" ) + "</robot>" ),
	        "" );
	EXPECT_EQ( model.disabled.size(), 2u ) << "a and c are in contact at zero, and the other states are beyond all numbers";
}

TEST_F( NeighboursTest, TheNoticeNamesTwentyPairsOfMore )
{
	std::string links = linkXml( "l0", 0.1 ), joints;
	for ( int i = 1; i <= 30; ++i )
	{
		const std::string name = std::to_string( i );
		links += linkXml( "l" + name, 0.1 );
		joints += jointXml( "j" + name, "l" + std::to_string( i - 1 ), "l" + name, "1" );
	}
	const RobotModel model = loadRobot( write( "r.urdf", "<robot name=\"r\">" + links + joints + "</robot>" ), "" );
	EXPECT_NOTICE( model.report.notices, "contact of 30 pairs" );
	EXPECT_NOTICE( model.report.notices, "l29 - l30 (joined by j30)" );
}

TEST_F( NeighboursTest, StrictChecksAllPairs )
{
	EXPECT_TRUE( load( 2.5, true ).disabled.empty() );
}
