// SPDX-License-Identifier: BSD-3-Clause
// MJCF: poses of bodies, joints, defaults, frames and replicas, computed by hand.
#include "mjcf/mjcf_files.hpp"

#include "leeway/io/spheres.hpp"

using namespace leeway::io;

namespace
{

const std::string ball = "<geom size=\"0.1\"/>";

const JointModel& jointOf( const RobotModel& model, const std::string& name )
{
	for ( const JointModel& joint : model.joints )
	{
		if ( joint.name == name )
		{
			return joint;
		}
	}
	throw std::out_of_range( name );
}

} // namespace

TEST_F( MjcfTest, HingeTurnsAboutItsAnchorAndTheBodyKeepsItsFrame )
{
	const RobotModel model =
	    load( "<worldbody><body name=\"a\" pos=\"1 0 0\"><joint name=\"j\" pos=\"0 2 0\" range=\"-90 90\"/>" + ball +
	          "</body></worldbody>" );
	EXPECT_EQ( model.root_link, "world" );
	EXPECT_EQ( jointOf( model, "j" ).type, LW_JOINT_REVOLUTE );
	EXPECT_DOUBLE_EQ( jointOf( model, "j" ).upper, pi / 2 ) << "degrees are the default of MJCF";
	expectPoint( poses( model ).at( "a" ), 1, 0, 0 );
	// about the point (1, 2, 0): the origin of the body comes to (1, 2, 0) + turn( 0, -2, 0 ) = (3, 2, 0)
	expectPoint( poses( model, { { "j", pi / 2 } } ).at( "a" ), 3, 2, 0 );
}

TEST_F( MjcfTest, JointsOfOneBodyActInTurn )
{
	const RobotModel model =
	    load( "<compiler angle=\"radian\"/><worldbody><body name=\"a\"><joint name=\"s\" type=\"slide\" axis=\"2 0 0\"/>"
	          "<joint name=\"h\" axis=\"0 0 1\"/><joint name=\"t\" type=\"slide\" axis=\"1 0 0\"/>" +
	          ball + "</body></worldbody>" );
	// slide 1 along x, turn by 90 degrees, slide 2 along the turned x
	expectPoint( poses( model, { { "s", 1 }, { "h", pi / 2 }, { "t", 2 } } ).at( "a" ), 1, 2, 0 );
	EXPECT_TRUE( std::isinf( jointOf( model, "s" ).upper ) );
	EXPECT_EQ( jointOf( model, "h" ).type, LW_JOINT_CONTINUOUS );
}

TEST_F( MjcfTest, ReferenceValueIsWhereTheFilePlacesTheBody )
{
	const RobotModel model =
	    load( "<worldbody><body name=\"a\"><joint name=\"h\" ref=\"90\"/><body name=\"b\" pos=\"1 0 0\"><joint name=\"s\" "
	          "type=\"slide\" axis=\"0 0 1\" ref=\"3\"/>" +
	          ball + "</body></body></worldbody>" );
	expectPoint( poses( model, { { "h", pi / 2 }, { "s", 3 } } ).at( "b" ), 1, 0, 0 );
	expectPoint( poses( model, { { "h", pi }, { "s", 5 } } ).at( "b" ), 0, 1, 2 );
	EXPECT_DOUBLE_EQ( model.useGroupState( "", "qpos0" ).joints.at( "h" ).at( 0 ), pi / 2 );
}

TEST_F( MjcfTest, FreeJointHasThePoseInTheWorld )
{
	const RobotModel model = load( "<worldbody><body name=\"a\" pos=\"0 0 5\"><freejoint name=\"f\"/>" + ball +
	                               "</body></worldbody>"
	                               "<keyframe><key name=\"k\" qpos=\"1 2 3 0 0 0 2\"/></keyframe>" );
	expectPoint( poses( model, { { "f/trans_x", 7 } } ).at( "a" ), 7, 0, 0 );
	const std::vector<double> wanted = { 1, 2, 3, 0, 0, 1, 0 }, start = { 0, 0, 5, 0, 0, 0, 1 };
	EXPECT_EQ( model.useGroupState( "all", "k" ).joints.at( "f" ), wanted ) << "x y z w and of length 1";
	EXPECT_EQ( model.useGroupState( "all", "qpos0" ).joints.at( "f" ), start );
}

TEST_F( MjcfTest, BallJointIsThreeHinges )
{
	const RobotModel model = load(
	    "<compiler angle=\"radian\"/><worldbody><body name=\"a\"><joint name=\"b\" type=\"ball\" pos=\"0 0 1\" range=\"0 1.2\"/>" +
	    ball + "</body></worldbody><keyframe><key qpos=\"0.7071067811865476 0.7071067811865476 0 0\"/></keyframe>" );
	EXPECT_NOTICE( model.report.notices, "three hinges b_x, b_y, b_z" );
	EXPECT_DOUBLE_EQ( jointOf( model, "b_z" ).upper, 0.4 ) << "the sum of three turns is within the limit";
	expectPoint( poses( model, { { "b_x", pi / 2 } } ).at( "a" ), 0, 1, 1 );
	EXPECT_NEAR( model.useGroupState( "", "key0" ).joints.at( "b_x" ).at( 0 ), pi / 2, 1e-12 );
}

TEST_F( MjcfTest, OrientationsInFiveWays )
{
	const auto turned = [&]( const std::string& attribute, const std::string& compiler = "" )
	{
		const RobotModel model = load( compiler + "<worldbody><body name=\"a\" " + attribute +
		                               "><body name=\"b\" pos=\"1 2 3\">" + ball + "</body></body></worldbody>" );
		return poses( model ).at( "b" );
	};
	expectPoint( turned( "quat=\"2 0 0 2\"" ), -2, 1, 3 );
	expectPoint( turned( "axisangle=\"0 0 5 90\"" ), -2, 1, 3 );
	expectPoint( turned( "euler=\"0 0 90\"" ), -2, 1, 3 );
	expectPoint( turned( "xyaxes=\"0 2 0 -3 1 0\"" ), -2, 1, 3 );
	expectPoint( turned( "zaxis=\"1 0 0\"" ), 3, 2, -1 );
	// about x, then about the new y, against about x, then about the old y
	expectPoint( turned( "euler=\"90 90 0\"" ), 3, 1, 2 );
	expectPoint( turned( "euler=\"90 90 0\"", "<compiler eulerseq=\"XYZ\"/>" ), 2, -3, -1 );
	expectPoint( turned( "euler=\"0 0 1.5707963267948966\"", "<compiler angle=\"radian\"/>" ), -2, 1, 3 );
}

TEST_F( MjcfTest, ClassesNestAndTheNearestCounts )
{
	const RobotModel model = load(
	    "<default><geom size=\"0.1\"/><joint axis=\"1 0 0\"/><default class=\"big\"><geom size=\"0.2\"/><default class=\"box\"><geom "
	    "type=\"box\" size=\"1 2 3\"/></default></default></default><worldbody><geom/><body name=\"a\" childclass=\"big\"><joint "
	    "name=\"j\"/><geom/><frame childclass=\"box\"><geom/><geom class=\"main\"/></frame></body></worldbody>" );
	const auto dimension = [&]( std::size_t link, std::size_t shape )
	{ return lw_shape_get_info( model.links.at( link ).collision.at( shape ).shape.get() ).dimensions[0]; };
	EXPECT_DOUBLE_EQ( dimension( 0, 0 ), 0.1 );
	ASSERT_EQ( model.links.at( 1 ).collision.size(), 2u ) << "two spheres are one shape";
	EXPECT_DOUBLE_EQ( dimension( 1, 0 ), 2.0 ) << "half edges";
	EXPECT_DOUBLE_EQ( jointOf( model, "j" ).axis[0], 1 );
}

TEST_F( MjcfTest, AnOrientationOfItsOwnReplacesThatOfTheClass )
{
	const RobotModel model = load(
	    "<default><geom type=\"box\" size=\"1 1 1\" euler=\"90 0 0\"/></default><worldbody><body name=\"a\"><geom quat=\"1 0 0 0\"/>"
	    "<geom zaxis=\"1 0 0\"/><geom/></body></worldbody>" );
	const std::vector<PlacedShape>& shapes = model.links.at( 1 ).collision;
	EXPECT_NEAR( shapes.at( 0 ).pose.r[2][2], 1, 1e-15 );
	EXPECT_NEAR( shapes.at( 1 ).pose.r[0][2], 1, 1e-15 );
	EXPECT_NEAR( shapes.at( 2 ).pose.r[1][2], -1, 1e-15 );
}

TEST_F( MjcfTest, FramesMoveBodiesGeomsAndJoints )
{
	const RobotModel model = load(
	    "<worldbody><frame pos=\"1 0 0\" euler=\"0 0 90\"><frame pos=\"0 1 0\"><body name=\"a\" pos=\"0 0 1\"><frame pos=\"5 0 0\" euler=\"0 0 90\">"
	    "<joint name=\"j\" type=\"slide\" axis=\"1 0 0\"/><geom type=\"box\" size=\"1 1 1\" pos=\"1 0 0\"/></frame></body></frame></frame></worldbody>" );
	expectPoint( poses( model ).at( "a" ), 0, 0, 1 );
	expectPoint( poses( model, { { "j", 2 } } ).at( "a" ), -2, 0, 1 ); // y of the body is -x of the world
	expectPoint( model.links.at( 1 ).collision.at( 0 ).pose, 5, 1, 0 );
}

TEST_F( MjcfTest, ReplicasStandAtPowersOfTheOffset )
{
	const RobotModel model = load(
	    "<worldbody><replicate count=\"2\" offset=\"0 1 0\" euler=\"90 0 0\"><replicate count=\"2\" sep=\"-\" offset=\"1 0 0\" euler=\"0 90 0\">"
	    "<body name=\"a\">" +
	    ball + "</body></replicate></replicate></worldbody>" );
	const auto all = poses( model );
	// the example of MuJoCo's reference
	expectPoint( all.at( "a-00" ), 0, 0, 0 );
	expectPoint( all.at( "a-10" ), 1, 0, 0 );
	expectPoint( all.at( "a-01" ), 0, 1, 0 );
	expectPoint( all.at( "a-11" ), 1, 1, 0 );
	EXPECT_NEAR( all.at( "a-11" ).r[0][2], 1, 1e-15 ); // quat 0.5 0.5 0.5 0.5
}

TEST_F( MjcfTest, EqualityOfJointsIsAMimic )
{
	const RobotModel model =
	    load( "<compiler angle=\"radian\"/><worldbody><body name=\"a\"><joint name=\"j\" ref=\"0.5\"/>" + ball +
	          "<body name=\"b\"><joint name=\"k\" ref=\"0.25\"/>" + ball + "<body name=\"c\"><joint name=\"l\"/>" + ball +
	          "</body></body></body></worldbody><equality><joint joint1=\"k\" joint2=\"j\" polycoef=\"0.1 2\"/>"
	          "<joint joint1=\"l\" polycoef=\"0.3\"/><joint joint1=\"j\" joint2=\"l\" active=\"false\"/></equality>" );
	const JointModel& k = jointOf( model, "k" );
	EXPECT_EQ( k.mimic, "j" );
	EXPECT_DOUBLE_EQ( k.mimic_multiplier, 2 );
	EXPECT_DOUBLE_EQ( k.mimic_offset, 0.25 + 0.1 - 2 * 0.5 ) << "both are counted from their references";
	EXPECT_EQ( jointOf( model, "l" ).type, LW_JOINT_FIXED );
	EXPECT_NEAR(
	    std::atan2( jointOf( model, "l" ).parent_from_joint.r[1][0], jointOf( model, "l" ).parent_from_joint.r[0][0] ), 0.3,
	    1e-15 );
	EXPECT_EQ( model.useGroup( "all" ).joints, std::vector<std::string>{ "j" } );
}

TEST_F( MjcfTest, LoopsAndCurvesAreToldAndNotHeld )
{
	const RobotModel model = load(
	    "<worldbody><body name=\"a\"><joint name=\"j\"/>" + ball + "</body><body name=\"b\"><joint name=\"k\"/>" + ball +
	    "</body></worldbody><equality>"
	    "<connect body1=\"a\" body2=\"b\" anchor=\"0 0 0\"/><joint joint1=\"j\" joint2=\"k\" polycoef=\"0 1 1\"/></equality>" );
	EXPECT_NOTICE( model.report.notices, "a and b move independently" );
	EXPECT_NOTICE( model.report.notices, "by a curve" );
	EXPECT_EQ( model.useGroup( "all" ).joints.size(), 2u );
	EXPECT_EQ( model.useGroup( "a" ).joints, std::vector<std::string>{ "j" } );
}

TEST_F( MjcfTest, IncludedFilesStandInPlace )
{
	write( "parts/arm.xml", "<mujocoinclude><body name=\"a\" pos=\"0 0 2\">" + ball +
	                            "<include file=\"parts/hand.xml\"/></body></mujocoinclude>" );
	write( "parts/hand.xml", "<anything><body name=\"h\" pos=\"0 0 1\"><joint name=\"j\"/>" + ball + "</body></anything>" );
	const RobotModel model = load( "<worldbody><include file=\"parts/arm.xml\"/></worldbody>" );
	expectPoint( poses( model ).at( "h" ), 0, 0, 3 );
}

TEST_F( MjcfTest, AnEmptyRangeIsNoneAndAutolimitsDecide )
{
	const RobotModel model = load(
	    "<worldbody><body name=\"a\"><joint name=\"j\" range=\"0 0\"/><joint name=\"k\" range=\"-1 1\" limited=\"false\" axis=\"1 0 0\"/>"
	    "<joint name=\"l\" range=\"-inf inf\" axis=\"0 1 0\"/>" +
	    ball + "</body></worldbody>" );
	EXPECT_EQ( jointOf( model, "j" ).type, LW_JOINT_CONTINUOUS );
	EXPECT_EQ( jointOf( model, "k" ).type, LW_JOINT_CONTINUOUS );
	EXPECT_EQ( jointOf( model, "l" ).type, LW_JOINT_CONTINUOUS );
	expectBad( "<compiler autolimits=\"false\"/><worldbody><body name=\"a\"><joint name=\"j\" range=\"-1 1\"/>" + ball +
	               "</body></worldbody>",
	    { "joint j (line 2)", "autolimits" } );
}

TEST_F( MjcfTest, NamesThatAreMissingAreMade )
{
	const RobotModel model =
	    load( "<worldbody><body><joint/>" + ball + "<body name=\"body1\"><joint/><joint axis=\"1 0 0\"/>" + ball +
	          "</body></body></worldbody>" );
	EXPECT_EQ( model.links.at( 1 ).name, "body1_" );
	EXPECT_EQ(
	    model.useGroup( "all" ).joints, ( std::vector<std::string>{ "body1_/joint", "body1/joint", "body1/joint_" } ) );
}

TEST_F( MjcfTest, TheUrdfOfItsSpheresMovesOtherwise )
{
	const RobotModel model = load(
	    "<worldbody><body name=\"base\" pos=\"0 0 1\" euler=\"0 90 0\">" + ball +
	    "<body name=\"a\" pos=\"1 2 3\" euler=\"30 -40 70\"><joint name=\"h\" axis=\"1 2 3\" pos=\"0 1 0\" range=\"-90 60\"/>" +
	    ball + "<body name=\"b\" pos=\"0 0 1\"><joint name=\"s\" type=\"slide\" axis=\"0 1 1\"/>" + ball +
	    "<body name=\"c\" pos=\"0.1 0 0\"><joint name=\"m\" axis=\"0 0 1\" range=\"-90 90\"/>" + ball +
	    "</body></body></body></body>" + "<body name=\"free\" pos=\"5 0 0\"><freejoint name=\"f\"/>" + ball +
	    "</body></worldbody>" + "<equality><joint joint1=\"m\" joint2=\"h\" polycoef=\"0.1 0.5 0 0 0\"/></equality>" );
	SpherizeOptions how;
	how.excess = 0.02;
	const RobotModel again =
	    loadRobot( write( "spheres.urdf", writeSpheresUrdf( model, spherize( model, how ) ) ), "", strict() );
	EXPECT_EQ( model.root_link, again.root_link );
	const std::map<std::string, double> values = {
	    { "h", 0.7 }, { "s", 20 }, { "f/trans_x", 2 }, { "f/rot_x", 0.6 }, { "f/rot_w", 0.8 } };
	const std::map<std::string, lw_transform> expected = poses( model, values ), found = poses( again, values );
	ASSERT_EQ( expected.size(), found.size() );
	for ( const auto& [link, pose] : expected )
	{
		for ( int i = 0; i < 3; ++i )
		{
			EXPECT_NEAR( pose.t[i], found.at( link ).t[i], 1e-12 ) << link;
			for ( int k = 0; k < 3; ++k )
			{
				EXPECT_NEAR( pose.r[i][k], found.at( link ).r[i][k], 1e-12 ) << link;
			}
		}
	}
	for ( const JointModel& joint : model.joints )
	{
		const JointModel& other = jointOf( again, joint.name );
		EXPECT_EQ( joint.type, other.type ) << joint.name;
		EXPECT_NEAR( std::max( -1e9, joint.lower ), other.lower, 1e-12 ) << joint.name;
		EXPECT_NEAR( std::min( 1e9, joint.upper ), other.upper, 1e-12 ) << joint.name;
	}
}
