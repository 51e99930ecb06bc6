// SPDX-License-Identifier: BSD-3-Clause
// SRDF: groups in all spellings, allowed pairs, virtual joints, named states.
#include "files.hpp"

using namespace leeway::io;

namespace
{

using Names = std::vector<std::string>;

/// base - lift - torso, then a left arm (l1, l2, l_tip fixed) and a right arm (r1, r2 mimics l2).
class SrdfTest : public FileTest
{
protected:
	RobotModel load( const std::string& srdf, bool strict = false )
	{
		std::string urdf = "<robot name=\"r\">";
		for ( const char* name : { "base", "torso", "l1", "l2", "l_tip", "r1", "r2" } )
		{
			urdf += "<link name=\"" + std::string( name ) +
			        "\"><collision><geometry><sphere radius=\"0.1\"/></geometry></collision></link>";
		}
		auto joint = [&]( const std::string& name, const std::string& type, const std::string& parent,
		                 const std::string& child, const std::string& more = "" )
		{
			urdf += "<joint name=\"" + name + "\" type=\"" + type + "\"><parent link=\"" + parent + "\"/><child link=\"" +
			        child + "\"/><axis xyz=\"0 0 1\"/><limit lower=\"-1\" upper=\"1\" effort=\"1\" velocity=\"1\"/>" + more +
			        "</joint>";
		};
		joint( "j_l2", "revolute", "l1", "l2" );
		joint( "j_lift", "prismatic", "base", "torso" );
		joint( "j_l1", "revolute", "torso", "l1" );
		joint( "j_tip", "fixed", "l2", "l_tip" );
		joint( "j_r1", "continuous", "torso", "r1" );
		joint( "j_r2", "revolute", "r1", "r2", "<mimic joint=\"j_l2\"/>" );
		write( "r.urdf", urdf + "</robot>" );
		write( "r.srdf", "<?xml version=\"1.0\"?>\n<robot name=\"r\">\n" + srdf + "</robot>" );
		LoadOptions options;
		options.strict = strict;
		return loadRobot( path( "r.urdf" ), path( "r.srdf" ), options );
	}
	Names joints( const std::string& content )
	{
		return load( "<group name=\"g\">" + content + "</group>" ).findGroup( "g" )->joints;
	}
	/// An error if strict; else a notice with each of these parts.
	void expectBad( const std::string& srdf, std::vector<std::string> parts )
	{
		const std::vector<Notice> notices = load( srdf ).report.notices;
		for ( const std::string& part : parts )
		{
			EXPECT_NOTICE( notices, part );
		}
		parts.push_back( "r.srdf" );
		expectError( [&] { load( srdf, true ); }, parts );
	}
	/// Of the group a or, without one, of the state s: the message when it is used.
	void expectUnusable( const std::string& srdf, std::vector<std::string> parts )
	{
		const RobotModel model = load( srdf );
		parts.insert( parts.end(), { "r.srdf", "cannot be used" } );
		if ( model.findGroup( "a" ) == nullptr )
		{
			expectError( [&] { (void)model.useGroupState( "", "s" ); }, parts );
			return;
		}
		ProblemOptions options;
		EXPECT_EQ( buildProblem( model, options ).variables.size(), 4u ) << "all joints, without the group";
		options.group = "a";
		expectError( [&] { (void)buildProblem( model, options ); }, parts );
	}
};

} // namespace

TEST_F( SrdfTest, ChainFromBaseToTip )
{
	EXPECT_EQ( joints( "<chain base_link=\"base\" tip_link=\"l_tip\"/>" ), ( Names{ "j_lift", "j_l1", "j_l2" } ) );
	EXPECT_EQ( joints( "<chain base_link=\"torso\" tip_link=\"l2\"/>" ), ( Names{ "j_l1", "j_l2" } ) );
	RobotModel model = load( "<group name=\"g\"><chain base_link=\"torso\" tip_link=\"l_tip\"/></group>" );
	EXPECT_EQ( model.findGroup( "g" )->links, ( Names{ "torso", "l1", "l2", "l_tip" } ) );
	EXPECT_EQ( model.findGroup( "h" ), nullptr );
}

TEST_F( SrdfTest, ChainOverACommonAncestor )
{
	EXPECT_EQ( joints( "<chain base_link=\"l_tip\" tip_link=\"r2\"/>" ), ( Names{ "j_l2", "j_l1", "j_r1" } ) )
	    << "r2 mimics";
	EXPECT_EQ( joints( "<chain base_link=\"l2\" tip_link=\"torso\"/>" ), ( Names{ "j_l2", "j_l1" } ) );
}

TEST_F( SrdfTest, JointListsKeepTheirOrder )
{
	EXPECT_EQ( joints( "<joint name=\"j_l2\"/><joint name=\"j_tip\"/><joint name=\"j_lift\"/><joint name=\"j_r2\"/><joint "
	                   "name=\"j_l2\"/>" ),
	    ( Names{ "j_l2", "j_lift" } ) )
	    << "no fixed, no mimic, none twice";
}

TEST_F( SrdfTest, LinksStandForTheirParentJoints )
{
	EXPECT_EQ( joints( "<link name=\"l2\"/><link name=\"base\"/><link name=\"torso\"/>" ), ( Names{ "j_l2", "j_lift" } ) );
}

TEST_F( SrdfTest, SubgroupsInAnyOrder )
{
	RobotModel model = load(
	    "<group name=\"all\"><group name=\"two\"/><joint name=\"j_lift\"/></group><group name=\"two\"><group "
	    "name=\"l\"/><joint name=\"j_r1\"/></group><group name=\"l\"><chain base_link=\"torso\" tip_link=\"l2\"/></group>" );
	EXPECT_EQ( model.findGroup( "all" )->joints, ( Names{ "j_l1", "j_l2", "j_r1", "j_lift" } ) );
	EXPECT_EQ( model.groups.size(), 3u );
	EXPECT_EQ( model.groups[0].name, "all" ) << "in the order of the file";
}

TEST_F( SrdfTest, GroupsThatAreWrong )
{
	expectBad( "<group name=\"a\"><group name=\"b\"/></group><group name=\"b\"><group name=\"a\"/></group>",
	    { "group a", "contains itself" } );
	expectBad( "<group name=\"a\"><group name=\"a\"/></group>", { "contains itself" } );
	expectBad( "<group name=\"a\"><group name=\"b\"/></group>", { "group a", "no group b" } );
	expectBad( "<group name=\"a\"><joint name=\"elbow\"/></group>", { "group a (line 3)", "no joint elbow" } );
	expectBad( "<group name=\"a\"><joint/></group>", { "group a (line 3)", "<joint> has no name" } );
	expectBad( "<group name=\"a\"><link name=\"hand\"/></group>", { "group a", "no link hand" } );
	expectBad( "<group name=\"a\"><chain base_link=\"base\" tip_link=\"hand\"/></group>", { "group a", "no link hand" } );
	expectBad( "<group name=\"a\"><chain base_link=\"base\"/></group>", { "tip_link" } );
	expectBad( "<group name=\"a\"/><group name=\"a\"/>", { "group a", "before" } );
	expectBad( "<group/>", { "no name" } );
}

TEST_F( SrdfTest, GroupsJoinedByPlusCountAJointTwice )
{
	const std::string both = "<group name=\"l\"><joint name=\"j_lift\"/><joint name=\"j_l1\"/><link name=\"l1\"/></group>"
	                         "<group name=\"r\"><joint name=\"j_r1\"/><joint name=\"j_lift\"/></group>";
	RobotModel model = load( both );
	EXPECT_EQ( model.useGroup( "r+l" ).joints, ( Names{ "j_r1", "j_lift", "j_l1" } ) );
	EXPECT_EQ( model.useGroup( "l+r+l" ).joints, ( Names{ "j_lift", "j_l1", "j_r1" } ) );
	EXPECT_EQ( model.useGroup( "l+r" ).name, "l+r" );
	EXPECT_EQ( groupVariables( model, "l+r" ), ( Names{ "j_lift", "j_l1", "j_r1" } ) );
	expectError( [&] { (void)model.useGroup( "l+x" ); }, { "group x", "no such group", "use one of l, r" } );
	model = load( both + "<group name=\"l+r\"><joint name=\"j_l2\"/></group>" );
	EXPECT_EQ( model.useGroup( "l+r" ).joints, Names{ "j_l2" } ) << "a group of that name goes first";
}

TEST_F( SrdfTest, AGroupThatLostAPartIsAnErrorOnlyWhereItIsUsed )
{
	const std::string good = "<group name=\"good\"><joint name=\"j_l2\"/></group>\n";
	expectUnusable( good + "<group name=\"a\"><joint name=\"j_l1\"/>\n<joint name=\"elbow\"/></group>",
	    { "group a", "no joint elbow (line 5)", "use one of good" } );
	expectUnusable(
	    good + "<group name=\"a\"><chain base_link=\"base\" tip_link=\"hand\"/></group>", { "no link hand (line 4)" } );
	expectUnusable( good + "<group name=\"a\"><chain tip_link=\"l2\"/></group>", { "<chain> has no base_link (line 4)" } );
	expectUnusable( good + "<group name=\"a\"><group name=\"arms\"/></group>", { "there is no group arms (line 4)" } );
	expectUnusable( good + "<group name=\"a\"><group name=\"b\"/></group><group name=\"b\"><link name=\"x\"/></group>",
	    { "group a", "its group b: the URDF has no link x (line 4)" } );
	expectUnusable( good + "<group name=\"a\"><group name=\"b\"/></group><group name=\"b\"><group name=\"a\"/></group>",
	    { "its group b: group a contains itself" } );
	RobotModel model = load( good + "<group name=\"a\"><joint name=\"j_l1\"/><joint name=\"elbow\"/></group>" );
	EXPECT_EQ( model.findGroup( "a" )->joints, Names{ "j_l1" } ) << "what is there is kept";
	EXPECT_EQ( model.useGroup( "good" ).joints, Names{ "j_l2" } );
	expectError( [&] { (void)model.useGroup( "bad" ); }, { "there is no such group", "use one of good" } );
	model = load( good + "<group name=\"good\"><joint name=\"j_r1\"/></group>" );
	EXPECT_EQ( model.useGroup( "good" ).joints, Names{ "j_l2" } ) << "the first one, as in MoveIt";
}

TEST_F( SrdfTest, AGroupOfManyBrokenGroupsHasAShortDefect )
{
	std::string text;
	for ( int i = 0; i < 60; ++i )
	{
		text += "<group name=\"g" + std::to_string( i ) + "\"><joint name=\"elbow\"/>";
		for ( int k = 0; k < i; ++k )
		{
			text += "<group name=\"g" + std::to_string( k ) + "\"/>";
		}
		text += "</group>";
	}
	EXPECT_LT( load( text ).findGroup( "g59" )->defect.size(), 1000u );
}

TEST_F( SrdfTest, AUrdfIsNoSrdf )
{
	(void)load( "" );
	expectError(
	    [&] { (void)loadRobot( path( "r.urdf" ), path( "r.urdf" ) ); }, { "r.urdf", "<link> (line 1)", "this is a URDF" } );
	const std::string both = write(
	    "both.srdf", "<robot name=\"r\"><link name=\"base\"/><group name=\"g\"><joint name=\"j_l1\"/></group></robot>" );
	const RobotModel model = loadRobot( path( "r.urdf" ), both );
	EXPECT_EQ( model.useGroup( "g" ).joints, Names{ "j_l1" } );
	EXPECT_NOTICE( model.report.notices, "links and joints of an SRDF were ignored" );
	(void)load( "<group name=\"g\"><joint name=\"j_l1\"/></group>" );
	expectError( [&] { (void)loadRobot( path( "r.srdf" ), "" ); }, { "r.srdf", "this is an SRDF", "as the robot" } );
	EXPECT_NOTICE( load( "" ).report.notices, "holds no group and disables no pair" );
	EXPECT_NOTICE(
	    load( "<disable_collision link1=\"l1\" link2=\"l2\"/>" ).report.notices, "were ignored: <disable_collision>" );
}

TEST_F( SrdfTest, DisabledPairs )
{
	RobotModel model =
	    load( "<disable_collisions link1=\"base\" link2=\"l1\" reason=\"Never\"/><disable_collisions link1=\"l1\" "
	          "link2=\"base\"/><disable_collisions link1=\"wheel\" link2=\"l1\" reason=\"Never\"/>" );
	ASSERT_EQ( model.disabled.size(), 1u );
	EXPECT_EQ( model.disabled[0].link1, "base" );
	EXPECT_EQ( model.disabled[0].reason, "Never" );
	EXPECT_NOTICE( model.report.notices, "lacks were ignored: wheel" );
	expectBad( "<disable_collisions link1=\"base\"/>", { "disable_collisions", "link2" } );
}

TEST_F( SrdfTest, DefaultsDisabledAndEnabledAgain )
{
	for ( const char* pair : { "link1=\"r1\" link2=\"torso\"", "link1=\"torso\" link2=\"r1\"" } )
	{
		RobotModel model =
		    load( "<disable_default_collisions link=\"torso\"/><enable_collisions " + std::string( pair ) + "/>" );
		EXPECT_EQ( model.disabled.size(), 5u ) << "six other links, one enabled again by " << pair;
		for ( const DisabledPair& disabled : model.disabled )
		{
			EXPECT_TRUE( disabled.link1 == "torso" && disabled.link2 != "r1" ) << pair;
		}
	}
	const std::string half = "<disable_default_collisions link=\"torso\"/><enable_collisions link1=\"torso\"/>";
	EXPECT_TRUE( load( half ).disabled.empty() ) << "which pair was meant nobody knows: none is disabled";
	expectBad( half, { "enable_collisions (line 3)", "link2" } );
	expectBad( "<disable_default_collisions/>", { "disable_default_collisions (line 3)", "no link" } );
}

TEST_F( SrdfTest, VirtualJoints )
{
	std::string head = "<virtual_joint name=\"v\" parent_frame=\"odom\" child_link=\"base\" type=\"";
	RobotModel planar = load( head + "planar\"/><group name=\"g\"><joint name=\"v\"/><joint name=\"j_lift\"/></group>" );
	EXPECT_EQ( planar.joints.front().name, "v" );
	EXPECT_EQ( planar.joints.front().type, LW_JOINT_PLANAR );
	EXPECT_DOUBLE_EQ( planar.joints.front().axis[2], 1 );
	EXPECT_EQ( planar.planning_frame, "odom" );
	EXPECT_EQ( planar.root_link, "base" );
	EXPECT_EQ( planar.links.front().name, "odom" );
	EXPECT_EQ( planar.findGroup( "g" )->joints, ( Names{ "v", "j_lift" } ) );
	EXPECT_EQ( load( head + "floating\"/>" ).joints.front().type, LW_JOINT_FLOATING );
	RobotModel fixed = load( head + "fixed\"/><group name=\"g\"><joint name=\"v\"/><joint name=\"j_lift\"/></group>" );
	EXPECT_EQ( fixed.planning_frame, "odom" );
	EXPECT_EQ( fixed.findGroup( "g" )->joints, Names{ "j_lift" } );
	expectBad( "<virtual_joint name=\"v\" parent_frame=\"odom\" child_link=\"torso\" type=\"fixed\"/>",
	    { "virtual_joint v", "root link base" } );
	expectBad( head + "ball\"/>", { "virtual_joint v", "ball" } );
	expectBad( "<virtual_joint name=\"v\" parent_frame=\"l1\" child_link=\"base\" type=\"floating\"/>",
	    { "is a link of the robot" } );
	expectBad( head + "planar\"/>" + head + "planar\"/>", { "second virtual joint" } );
	expectBad(
	    "<virtual_joint name=\"j_r1\" parent_frame=\"odom\" child_link=\"base\" type=\"planar\"/>", { "of this name" } );
}

TEST_F( SrdfTest, GroupStates )
{
	std::string group =
	    "<virtual_joint name=\"v\" parent_frame=\"odom\" child_link=\"base\" type=\"planar\"/><group name=\"g\"><joint "
	    "name=\"j_lift\"/></group>";
	RobotModel model = load(
	    group + "<group_state name=\"up\" group=\"g\"><joint name=\"j_lift\" value=\"0.5\"/><joint name=\"v\" value=\"1 2 "
	            "0.3\"/><joint name=\"gone\" value=\"1\"/></group_state><group_state name=\"x\" group=\"h\"/>" );
	ASSERT_EQ( model.group_states.size(), 2u );
	EXPECT_EQ( model.group_states[0].joints.at( "j_lift" ), std::vector<double>{ 0.5 } );
	EXPECT_EQ( model.group_states[0].joints.at( "v" ).size(), 3u );
	EXPECT_NOTICE( model.report.notices, "no joint gone" );
	EXPECT_EQ( model.useGroupState( "g", "up" ).joints.size(), 2u ) << "all joints of the group have values";
	expectUnusable( group + "<group_state name=\"s\" group=\"g\"><joint name=\"gone\" value=\"1\"/></group_state>",
	    { "group_state s", "no joint gone (line 3)" } );
	expectError( [&] { (void)model.useGroupState( "", "x" ); }, { "group_state x", "no group h" } );
	expectError( [&] { (void)model.useGroupState( "", "y" ); }, { "group_state y", "no such state", "up of group g" } );
	const std::string down = "<group_state name=\"down\" group=\"g\"><joint name=\"j_lift\" value=\"0\"/></group_state>";
	EXPECT_EQ( load( group + down ).useGroupState( "g", "down" ).joints.at( "j_lift" ), std::vector<double>{ 0 } );
	expectBad( group + "<group_state name=\"s\"/>", { "group_state s (line 3)", "no group" } );
	expectUnusable( group + "<group_state name=\"s\"/>", { "<group_state> has no group (line 3)" } );
	expectUnusable(
	    group + "<group_state name=\"s\" group=\"g\"><joint name=\"j_lift\" value=\"nan\"/></group_state>", { "nan" } );
	EXPECT_NOTICE( model.report.notices, "no group h" );
	expectBad( group + "<group_state name=\"up\" group=\"g\"><joint name=\"j_lift\" value=\"nan\"/></group_state>",
	    { "group_state up", "nan" } );
}

TEST_F( SrdfTest, TextThatTheXmlReaderWouldLeaveOut )
{
	(void)load( "" );
	auto bad = [&]( const std::string& text, const std::vector<std::string>& parts )
	{
		write( "bad.srdf", text );
		expectError( [&] { (void)loadRobot( path( "r.urdf" ), path( "bad.srdf" ) ); }, parts );
	};
	const std::string group = "<group name=\"g\"><joint name=\"j_l2\"/></group>", robot = "<robot name=\"r\">" + group;
	bad( "<robot name=\"r\"/>\n" + group, { "bad.srdf", "line 2", "<group> beside the root" } );
	bad( robot + "</robot>\n\nand more", { "bad.srdf", "line 3", "text beside the root" } );
	bad( "<!-- c -->\n" + robot + "</robot>\n</robot>\n" + robot + "</robot>",
	    { "bad.srdf", "line 2", "closes what was not opened" } );
	bad( "</x>" + robot + "</robot>", { "bad.srdf", "line 1", "closes what was not opened" } );
	bad( robot + "</robot>\n_</x><_/></x>", { "bad.srdf", "closes what was not opened" } );
	bad( robot + "\n" + std::string( 1, '\0' ) + "</robot>", { "bad.srdf", "line 2", "no text" } );
	bad( robot, { "bad.srdf", "not well-formed" } );
	bad( "<!-- c -->", { "bad.srdf", "the root element" } );
	write( "good.srdf",
	    "\xef\xbb\xbf<?xml version=\"1.0\"?><!DOCTYPE robot>\n<!-- c -->" + robot + "</robot> \n<!-- ___ -->\n" );
	EXPECT_EQ( loadRobot( path( "r.urdf" ), path( "good.srdf" ) ).groups.size(), 1u );
}

TEST_F( SrdfTest, OtherRobotsAndFiles )
{
	const std::string group = "<group name=\"g\"><joint name=\"j_l1\"/></group>";
	RobotModel model =
	    load( group + "<end_effector name=\"e\" parent_link=\"l2\" group=\"g\"/><passive_joint name=\"j_r2\"/>" );
	EXPECT_TRUE( model.report.notices.empty() ) << allNotices( model.report.notices );
	EXPECT_NOTICE( load( group + "<end_effector name=\"e\" parent_link=\"l2\" group=\"hand\"/>", true ).report.notices,
	    "there is no group hand" );
	expectError( [&] { loadRobot( path( "r.urdf" ), path( "none.srdf" ) ); }, { "none.srdf", "no such file" } );
	expectError(
	    [&] { loadRobot( path( "r.urdf" ), write( "b.srdf", "<robot name=\"r\"><group" ) ); }, { "b.srdf", "XML" } );
	EXPECT_NOTICE(
	    loadRobot( path( "r.urdf" ), write( "o.srdf", "<robot name=\"other\"/>" ) ).report.notices, "robot other" );
}
