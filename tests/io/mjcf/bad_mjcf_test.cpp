// SPDX-License-Identifier: BSD-3-Clause
// MJCF: wrong files are refused with their element and line; damaged ones give a model or an Error.
#include "damage.hpp"
#include "mjcf/mjcf_files.hpp"

using namespace leeway::io;

namespace
{

const std::string ball = "<geom size=\"0.1\"/>";

struct BadFile
{
	const char* content; ///< of <mujoco>, from line 2 on
	std::vector<std::string> parts;
};

std::string body( const std::string& content )
{
	return "<worldbody>\n<body name=\"b\">\n" + content + "</body></worldbody>";
}

const std::vector<BadFile>& badSettings()
{
	static const std::vector<BadFile> all = {
	    { "<compiler coordinate=\"global\"/>", { "compiler (line 2)", "coordinate=\"global\"" } },
	    { "<compiler angle=\"grad\"/>", { "compiler (line 2)", "degree, radian" } },
	    { "<compiler eulerseq=\"xyw\"/>", { "compiler (line 2)", "three axes" } },
	    { "<compiler eulerseq=\"xy\"/>", { "compiler (line 2)", "three axes" } },
	    { "<compiler autolimits=\"yes\"/>", { "compiler (line 2)", "true, false" } },
	    { "<option><flag filterparent=\"off\"/></option>", { "flag (line 2)", "enable, disable" } },
	    { "<default><default/></default>", { "default (line 2)", "no name" } },
	    { "<default><default class=\"a\"/><default class=\"a\"/></default>", { "default a (line 2)", "defined before" } },
	    { "<default><geom/><geom/></default>", { "two <geom>" } },
	    { "<include file=\"none.xml\"/>", { "include none.xml (line 2)", "none.xml" } },
	    { "<include/>", { "include (line 2)", "no file" } },
	    { "<include file=\"twice.xml\"/><include file=\"twice.xml\"/>", { "included twice" } },
	    { "<include file=\"loop.xml\"/>", { "loop.xml", "includes itself" } },
	    { "<include file=\"robot.xml\"/>", { "includes itself" } },
	    { "<include file=\"broken.xml\"/>", { "broken.xml", "line 1", "not well-formed" } },
	};
	return all;
}

const std::vector<BadFile>& badTrees()
{
	static const std::vector<BadFile> all = {
	    { "<worldbody><joint/></worldbody>", { "the world has a joint" } },
	    { "<worldbody><bdy/></worldbody>", { "<bdy> (line 2)", "not known in a body" } },
	    { "<worldbody><composite/></worldbody>", { "<composite> (line 2)", "is not read" } },
	    { "<worldbody><flexcomp/></worldbody>", { "<flexcomp> (line 2)", "is not read" } },
	    { "<worldbody><attach model=\"m\" prefix=\"p\"/></worldbody>", { "<attach> (line 2)", "mj_saveLastXML" } },
	    { "<deformable><flex/></deformable>", { "<flex> (line 2)", "bend" } },
	    { "<asset><model name=\"m\" file=\"m.xml\"/></asset>", { "<model> (line 2)", "mj_saveLastXML" } },
	    { "<worldbody><frame scale=\"2\"/></worldbody>", { "frame (line 2)", "scale" } },
	    { "<worldbody><replicate count=\"0\"/></worldbody>", { "replicate (line 2)", "not positive" } },
	    { "<worldbody><replicate count=\"1000000\"/></worldbody>", { "replicas", "limit" } },
	    { "<worldbody><replicate count=\"1.5\"/></worldbody>", { "whole number" } },
	    { "<worldbody><replicate count=\"2\"><body name=\"x\"/></replicate><body name=\"x0\"/></worldbody>",
	        { "body x0 (line 2)", "defined before" } },
	    { "<worldbody><body name=\"world\"/></worldbody>", { "body world (line 2)", "defined before" } },
	    { "<worldbody><body name=\"a\" childclass=\"none\"/></worldbody>",
	        { "body a (line 2)", "no default class none", "main" } },
	    { "<worldbody><body name=\"a\" pos=\"1 2\"/></worldbody>", { "body a (line 2)", "2 numbers, not 3" } },
	    { "<worldbody><body name=\"a\" pos=\"1 2 nan\"/></worldbody>", { "body a (line 2)", "nan" } },
	    { "<worldbody><body name=\"a\" quat=\"0 0 0 0\"/></worldbody>", { "zero quaternion" } },
	    { "<worldbody><body name=\"a\" axisangle=\"0 0 0 1\"/></worldbody>", { "no axis" } },
	    { "<worldbody><body name=\"a\" xyaxes=\"1 0 0 2 0 0\"/></worldbody>", { "no two directions" } },
	    { "<worldbody><body name=\"a\" zaxis=\"0 0 0\"/></worldbody>", { "no direction" } },
	    { "<worldbody><body name=\"a\" quat=\"1 0 0 0\" euler=\"0 0 0\"/></worldbody>", { "both quat and euler" } },
	    { "<worldbody><body name=\"a\" mocap=\"true\"><joint/><geom size=\"1\"/></body></worldbody>",
	        { "body a (line 2)", "mocap" } },
	};
	return all;
}

const std::vector<BadFile>& badGeoms()
{
	static const std::vector<BadFile> all = {
	    { "<worldbody><geom size=\"0\"/></worldbody>", { "body world, geom 1 (line 2)", "above 0" } },
	    { "<worldbody><geom type=\"box\" size=\"1 1\"/></worldbody>", { "size 3 is 0" } },
	    { "<worldbody><geom type=\"cube\" size=\"1\"/></worldbody>", { "type=\"cube\"", "capsule" } },
	    { "<worldbody><geom type=\"sdf\"/></worldbody>", { "plugin" } },
	    { "<worldbody><geom size=\"1\" fromto=\"0 0 0 0 0 1\"/></worldbody>", { "a sphere has no fromto" } },
	    { "<worldbody><geom type=\"capsule\" size=\"1\" fromto=\"0 0 1 0 0 1\"/></worldbody>", { "a point with itself" } },
	    { "<worldbody><geom type=\"mesh\"/></worldbody>", { "names no asset", "mesh=" } },
	    { "<worldbody><geom type=\"mesh\" mesh=\"m\"/></worldbody>", { "there is no mesh m", "<asset>" } },
	    { "<worldbody><geom size=\"1\" class=\"none\"/></worldbody>", { "no default class none" } },
	    { "<worldbody><geom size=\"1\" contype=\"1.5\"/></worldbody>", { "whole number" } },
	    { "<asset><mesh/></asset><worldbody><geom size=\"1\"/></worldbody>", { "mesh (line 2)", "neither name nor file" } },
	    { "<asset><mesh file=\"flat.obj\"/></asset><worldbody><geom type=\"mesh\" mesh=\"flat\"/></worldbody>",
	        { "mesh flat", "one plane" } },
	    { "<asset><mesh name=\"m\" vertex=\"0 0 0 1\"/></asset><worldbody><geom type=\"mesh\" mesh=\"m\"/></worldbody>",
	        { "mesh m (line 2)", "not three" } },
	    { "<asset><mesh name=\"m\" builtin=\"sphere\"/></asset><worldbody><geom type=\"mesh\" mesh=\"m\"/></worldbody>",
	        { "computed by MuJoCo" } },
	    { "<asset><mesh name=\"m\" file=\"none.stl\"/></asset><worldbody><geom type=\"mesh\" mesh=\"m\"/></worldbody>",
	        { "mesh m (line 2)", "none.stl" } },
	    { "<asset><mesh name=\"m\" vertex=\"0 0 0\"/></asset><worldbody><geom mesh=\"m\" type=\"box\"/></worldbody>",
	        { "fits a shape", "type=\"mesh\"" } },
	    { "<asset><hfield name=\"h\" size=\"1 1 1 0\" nrow=\"2\" ncol=\"2\"/></asset><worldbody><geom type=\"hfield\" hfield=\"h\"/></worldbody>",
	        { "hfield h (line 2)", "above 0" } },
	    { "<asset><hfield name=\"h\" size=\"1 1 1 1\" nrow=\"2\" ncol=\"2\" elevation=\"1 2 3\"/></asset><worldbody><geom type=\"hfield\" hfield=\"h\"/></worldbody>",
	        { "3 numbers, not 4" } },
	    { "<asset><hfield name=\"h\" size=\"1 1 1 1\" nrow=\"1\" ncol=\"9\"/></asset><worldbody><geom type=\"hfield\" hfield=\"h\"/></worldbody>",
	        { "1 rows and 9 columns" } },
	    { "<worldbody><geom size=\"1\"/></worldbody><contact><exclude body1=\"a\" body2=\"world\"/></contact>",
	        { "exclude (line 2)", "no body a" } },
	    { "<worldbody><geom size=\"1\"/></worldbody><contact><pair geom1=\"a\" geom2=\"b\"/></contact>",
	        { "pair (line 2)", "no geom a" } },
	    { "<worldbody><geom size=\"1\"/></worldbody><equality><joint joint1=\"a\"/></equality>",
	        { "equality (line 2)", "no joint a" } },
	    { "<worldbody/>", { "no body has a geom" } },
	    { "", { "no body has a geom" } },
	};
	return all;
}

/// Behind the start tag of a body in line 3.
const std::vector<BadFile>& badJoints()
{
	static const std::vector<BadFile> all = {
	    { "<joint name=\"j\" type=\"screw\"/>", { "joint j (line 4)", "hinge, slide" } },
	    { "<joint name=\"j\" axis=\"0 0 0\"/>", { "joint j (line 4)", "axis is zero" } },
	    { "<joint name=\"j\" range=\"2 1\"/>", { "joint j (line 4)", "above upper limit" } },
	    { "<joint name=\"j\" range=\"-inf 1\"/>", { "joint j (line 4)", "a limit on one side only" } },
	    { "<joint name=\"j\" range=\"nan 1\"/>", { "joint j (line 4)", "is not finite" } },
	    { "<joint name=\"j\" range=\"-inf inf 1\"/>", { "joint j (line 4)", "is not finite" } },
	    { "<joint name=\"j\" limited=\"true\"/>", { "joint j (line 4)", "from 0 to 0" } },
	    { "<joint name=\"j\" limited=\"maybe\"/>", { "joint j (line 4)", "auto" } },
	    { "<joint name=\"j\"/><joint name=\"j\"/>", { "joint j (line 4)", "defined before" } },
	    { "<joint type=\"ball\"/><joint/>", { "body b (line 3)", "ball joint and another" } },
	    { "<freejoint/><joint/>", { "body b (line 3)", "beside its free joint" } },
	    { "<body name=\"c\"><freejoint/></body>", { "body c (line 4)", "no child of the world" } },
	};
	return all;
}

/// A file that has nearly all that is read.
const std::string whole =
    "<mujoco model=\"r\"><compiler angle=\"radian\" eulerseq=\"XYZ\" meshdir=\".\"/><option><flag filterparent=\"enable\"/></option>"
    "<default><geom size=\"0.1\"/><default class=\"c\"><joint range=\"-1 1\"/><geom type=\"capsule\" fromto=\"0 0 0 0 0 1\"/></default></default>"
    "<asset><mesh name=\"t\" vertex=\"0 0 0 1 0 0 0 1 0 0 0 1\" scale=\"1 1 2\"/><hfield name=\"h\" nrow=\"2\" ncol=\"2\" size=\"1 1 1 1\" "
    "elevation=\"0 1 2 3\"/></asset><worldbody><geom type=\"hfield\" hfield=\"h\"/><frame pos=\"1 0 0\" euler=\"0 0 1\"><body name=\"a\" "
    "childclass=\"c\"><joint name=\"j\" ref=\"0.2\"/><geom name=\"g\"/><body name=\"b\" xyaxes=\"1 0 0 0 1 0\"><joint name=\"k\" type=\"slide\"/>"
    "<geom type=\"mesh\" mesh=\"t\" class=\"main\"/></body></body></frame><replicate count=\"2\" offset=\"1 0 0\"><body name=\"r\"><joint "
    "type=\"ball\"/><geom name=\"s\"/></body></replicate><body><freejoint/><geom type=\"ellipsoid\" size=\"1 2 3\"/></body></worldbody>"
    "<contact><exclude body1=\"a\" body2=\"b\"/><pair geom1=\"g\" geom2=\"s0\"/></contact><equality><joint joint1=\"k\" joint2=\"j\" "
    "polycoef=\"0 2\"/></equality><keyframe><key name=\"home\" qpos=\"1 2\"/></keyframe></mujoco>";

} // namespace

TEST_F( MjcfTest, WrongFilesAreRefusedWithTheirPlace )
{
	write( "twice.xml", "<mujoco/>" );
	write( "loop.xml", "<x><include file=\"loop.xml\"/></x>" );
	write( "broken.xml", "<x><y></x>" );
	write( "flat.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 2 4 3\n" );
	const std::string joint = "<joint name=\"j\"", close = "/>" + ball;
	for ( const std::vector<BadFile>* files : { &badSettings(), &badTrees(), &badGeoms() } )
	{
		for ( const BadFile& file : *files )
		{
			SCOPED_TRACE( file.content );
			expectBad( file.content, file.parts );
		}
	}
	for ( const BadFile& file : badJoints() )
	{
		SCOPED_TRACE( file.content );
		expectBad( body( file.content + ball ), file.parts );
	}
	const std::string two = body( joint + "/><body name=\"c\"><joint name=\"k\"" + close + "</body>" + ball );
	expectBad( two + "<equality><joint joint1=\"j\" joint2=\"j\"/></equality>", { "follows itself" } );
	expectBad( two + "<equality><joint joint1=\"j\" joint2=\"k\"/><joint joint1=\"k\" joint2=\"j\"/></equality>",
	    { "by way of others" } );
	expectBad( two + "<keyframe><key name=\"a\"/><key name=\"a\"/></keyframe>", { "key a (line 4)", "defined before" } );
}

TEST_F( MjcfTest, KeyframesOfTooManyNumbersCannotBeUsed )
{
	const RobotModel model =
	    load( body( "<joint name=\"j\"/>" + ball ) + "<keyframe><key name=\"k\" qpos=\"1 2\"/></keyframe>" );
	EXPECT_NOTICE( model.report.notices, "key k" );
	expectError( [&] { (void)model.useGroupState( "", "k" ); }, { "qpos has 2 numbers for 1" } );
}

TEST_F( MjcfTest, DamagedFilesGiveAModelOrAnError )
{
	const auto read = [&]( const std::string& text ) { (void)loadRobot( write( "damaged.xml", text ), "" ); };
	read( whole );
	expectCutsRefused( read, whole, whole.size() - 1 );
	const DamageCount count = tryFlippedBits( read, whole );
	EXPECT_GT( count.refused, 20 );
}
