// SPDX-License-Identifier: BSD-3-Clause
// SDF: poses of random chains against matrices of this file, shapes, worlds, includes, and errors with their place.
#include "files.hpp"
#include "seeded_rng.hpp"

#include <array>
#include <cmath>
#include <sstream>

using namespace leeway::io;

namespace
{

/// A rigid motion as a matrix of three rows.
struct Motion
{
	double m[3][4] = { { 1, 0, 0, 0 }, { 0, 1, 0, 0 }, { 0, 0, 1, 0 } };
};

Motion operator*( const Motion& a, const Motion& b )
{
	Motion c;
	for ( int i = 0; i < 3; ++i )
	{
		for ( int j = 0; j < 4; ++j )
		{
			c.m[i][j] = a.m[i][0] * b.m[0][j] + a.m[i][1] * b.m[1][j] + a.m[i][2] * b.m[2][j] + ( j == 3 ? a.m[i][3] : 0 );
		}
	}
	return c;
}

Motion inverse( const Motion& a )
{
	Motion b;
	for ( int i = 0; i < 3; ++i )
	{
		b.m[i][3] = 0;
		for ( int j = 0; j < 3; ++j )
		{
			b.m[i][j] = a.m[j][i];
			b.m[i][3] -= a.m[j][i] * a.m[j][3];
		}
	}
	return b;
}

/// Rodrigues' formula. @param axis of length 1
Motion turn( const std::array<double, 3>& axis, double angle )
{
	Motion a;
	const double c = std::cos( angle ), s = std::sin( angle );
	const double cross[3][3] = { { 0, -axis[2], axis[1] }, { axis[2], 0, -axis[0] }, { -axis[1], axis[0], 0 } };
	for ( int i = 0; i < 3; ++i )
	{
		for ( int j = 0; j < 3; ++j )
		{
			a.m[i][j] = ( i == j ? c : 0 ) + ( 1 - c ) * axis[i] * axis[j] + s * cross[i][j];
		}
	}
	return a;
}

Motion shift( double x, double y, double z )
{
	Motion a;
	a.m[0][3] = x;
	a.m[1][3] = y;
	a.m[2][3] = z;
	return a;
}

/// "x y z roll pitch yaw" as SDF means it.
struct Pose
{
	std::array<double, 6> numbers{};
	Motion motion() const
	{
		return shift( numbers[0], numbers[1], numbers[2] ) * turn( { 0, 0, 1 }, numbers[5] ) *
		       turn( { 0, 1, 0 }, numbers[4] ) * turn( { 1, 0, 0 }, numbers[3] );
	}
	std::string text( const std::string& attributes = "" ) const
	{
		std::ostringstream out;
		out.precision( 17 );
		out << "<pose" << attributes << ">";
		for ( double number : numbers )
		{
			out << number << " ";
		}
		out << "</pose>";
		return out.str();
	}
};

Pose randomPose( SeededRng& rng )
{
	Pose pose;
	for ( double& number : pose.numbers )
	{
		number = rng.uniform( -1.5, 1.5 );
	}
	return pose;
}

double difference( const lw_transform& a, const Motion& b )
{
	double most = 0;
	for ( int i = 0; i < 3; ++i )
	{
		most = std::max( most, std::fabs( a.t[i] - b.m[i][3] ) );
		for ( int j = 0; j < 3; ++j )
		{
			most = std::max( most, std::fabs( a.r[i][j] - b.m[i][j] ) );
		}
	}
	return most;
}

const char* const ball = "<collision name=\"c\"><geometry><sphere><radius>0.1</radius></sphere></geometry></collision>";

std::string sdf( const std::string& inside )
{
	return "<sdf version=\"1.9\">" + inside + "</sdf>";
}

class SdfTest : public FileTest
{
protected:
	RobotModel load( const std::string& text ) const { return loadRobot( write( "model.sdf", text ), "" ); }
	/// The pose of a link in the world at these values of the variables.
	static lw_transform poseOf( const leeway::Robot& robot, const std::string& link, const std::vector<double>& q )
	{
		std::vector<lw_transform> poses( lw_robot_link_count( robot.get() ) );
		EXPECT_EQ( lw_robot_fk( robot.get(), q.data(), poses.data() ), LW_OK );
		for ( std::uint32_t i = 0; i < poses.size(); ++i )
		{
			if ( lw_robot_link_name( robot.get(), i ) == link )
			{
				return poses[i];
			}
		}
		ADD_FAILURE() << "there is no link " << link;
		return lw_transform_identity();
	}
};

} // namespace

TEST_F( SdfTest, PosesOfRandomChainsDiffer )
{
	SeededRng rng( 20261125 );
	for ( int round = 0; round < 40; ++round )
	{
		const Pose model = randomPose( rng );
		const Pose parent = randomPose( rng );
		Motion placed = parent.motion(); // of the link before, in the model, at zero
		std::string text = model.text() + "<link name=\"l0\">" + parent.text() + ball + "</link>";
		std::vector<double> q;
		std::vector<Motion> expected = { model.motion() * parent.motion() };
		for ( int i = 1; i <= 5; ++i )
		{
			const std::string number = std::to_string( i ), before = std::to_string( i - 1 );
			const Pose child = randomPose( rng ), joint = round % 4 == 0 ? Pose() : randomPose( rng );
			const bool slides = i == 3, in_model = i % 2 == 0;
			std::array<double, 3> axis = { rng.uniform( -1, 1 ), rng.uniform( -1, 1 ), rng.uniform( -1, 1 ) };
			const double length = std::hypot( axis[0], axis[1], axis[2] );
			std::ostringstream axis_text;
			axis_text.precision( 17 );
			axis_text << "<axis><xyz" << ( in_model ? " expressed_in=\"__model__\"" : "" ) << ">" << axis[0] << " "
			          << axis[1] << " " << axis[2] << "</xyz><limit><lower>-3</lower><upper>3</upper></limit></axis>";
			for ( double& a : axis )
			{
				a /= length;
			}
			// Odd links are placed in the model, even ones in the link before; the joint stands in the child's frame
			text += "<link name=\"l" + number + "\">" + child.text( i % 2 == 0 ? " relative_to=\"l" + before + "\"" : "" ) +
			        ball + "</link><joint name=\"j" + number + "\" type=\"" + ( slides ? "prismatic" : "revolute" ) + "\">" +
			        joint.text() + "<parent>l" + before + "</parent><child>l" + number + "</child>" + axis_text.str() +
			        "</joint>";
			const Motion child_at = i % 2 == 0 ? placed * child.motion() : child.motion();
			const Motion joint_at = child_at * joint.motion();
			if ( in_model )
			{
				const Motion back = inverse( joint_at );
				const std::array<double, 3> given = axis;
				for ( int row = 0; row < 3; ++row )
				{
					axis[row] = back.m[row][0] * given[0] + back.m[row][1] * given[1] + back.m[row][2] * given[2];
				}
			}
			q.push_back( rng.uniform( -2, 2 ) );
			const Motion moved =
			    slides ? shift( q.back() * axis[0], q.back() * axis[1], q.back() * axis[2] ) : turn( axis, q.back() );
			expected.push_back( expected.back() * inverse( placed ) * joint_at * moved * inverse( joint_at ) * child_at );
			placed = child_at;
		}
		const leeway::Robot robot = buildRobot( load( sdf( "<model name=\"chain\">" + text + "</model>" ) ) );
		ASSERT_EQ( lw_robot_variable_count( robot.get() ), q.size() );
		for ( std::size_t i = 0; i < expected.size(); ++i )
		{
			EXPECT_LT( difference( poseOf( robot, "l" + std::to_string( i ), q ), expected[i] ), 1e-12 )
			    << round << " l" << i;
		}
	}
}

TEST_F( SdfTest, LimitsAndTypesOfJoints )
{
	const auto joint =
	    []( const std::string& name, const std::string& type, const std::string& child, const std::string& limit )
	{
		return "<link name=\"" + child + "\">" + ball + "</link><joint name=\"" + name + "\" type=\"" + type +
		       "\"><parent>base</parent><child>" + child + "</child><axis><xyz>0 0 1</xyz><limit>" + limit +
		       "</limit></axis>" + ( type == "universal" ? "<axis2><xyz>1 0 0</xyz></axis2>" : "" ) + "</joint>";
	};
	const RobotModel model =
	    load( sdf( "<model name=\"m\"><link name=\"base\"/>" +
	               joint( "a", "revolute", "la", "<lower>-1</lower><upper>2</upper><velocity>3</velocity>" ) +
	               joint( "b", "revolute", "lb", "" ) + joint( "c", "prismatic", "lc", "<lower>0</lower><upper>1</upper>" ) +
	               joint( "d", "universal", "ld", "" ) + joint( "e", "fixed", "le", "" ) + joint( "f", "ball", "lf", "" ) +
	               "</model>" ) );
	const auto of = [&]( const std::string& name )
	{
		for ( const JointModel& j : model.joints )
		{
			if ( j.name == name )
			{
				return j;
			}
		}
		ADD_FAILURE() << name;
		return JointModel();
	};
	EXPECT_EQ( of( "a" ).type, LW_JOINT_REVOLUTE );
	EXPECT_EQ( of( "a" ).lower, -1 );
	EXPECT_EQ( of( "a" ).upper, 2 );
	EXPECT_EQ( of( "a" ).velocity, 3 );
	EXPECT_EQ( of( "b" ).type, LW_JOINT_CONTINUOUS );
	EXPECT_EQ( of( "c" ).type, LW_JOINT_PRISMATIC );
	EXPECT_EQ( of( "d/1" ).type, LW_JOINT_CONTINUOUS );
	EXPECT_EQ( of( "d/2" ).child, "ld" );
	EXPECT_EQ( of( "e" ).type, LW_JOINT_FIXED );
	EXPECT_EQ( of( "f_x" ).parent, "base" );
	EXPECT_EQ( of( "f_y" ).upper, std::acos( -1.0 ) / 2 );
	EXPECT_EQ( of( "f_z" ).child, "lf" );
	EXPECT_EQ( of( "f_z" ).axis[2], 1 );
	EXPECT_NOTICE( model.report.notices, "joint f: a ball joint is three hinges" );
	EXPECT_NOTICE( model.report.notices, "links that no joint holds stand where the file places them (1): base" );
}

TEST_F( SdfTest, ShapesOfAllKinds )
{
	const std::string mesh = writeTetrahedron( "meshes/t.obj" );
	const auto shape = []( const std::string& name, const std::string& inside )
	{ return "<collision name=\"" + name + "\"><pose>1 2 3 0 0 0</pose><geometry>" + inside + "</geometry></collision>"; };
	const RobotModel model =
	    load( sdf( "<model name=\"m\"><link name=\"a\">" + shape( "1", "<box><size>1 2 3</size></box>" ) +
	               shape( "2", "<cylinder><radius>1</radius><length>4</length></cylinder>" ) +
	               shape( "3", "<capsule><radius>1</radius><length>4</length></capsule>" ) +
	               shape( "4", "<ellipsoid><radii>1 2 3</radii></ellipsoid>" ) +
	               shape( "5", "<mesh><uri>meshes/t.obj</uri><scale>2 2 2</scale></mesh>" ) +
	               shape( "6", "<sphere><radius>0.5</radius></sphere>" ) +
	               shape( "7", "<plane><normal>0 0 1</normal></plane>" ) + "</link></model>" ) );
	ASSERT_EQ( model.links[1].name, "a" );
	ASSERT_EQ( model.links[1].collision.size(), 6u );
	const std::vector<lw_shape_type> types = {
	    LW_SHAPE_BOX, LW_SHAPE_CYLINDER, LW_SHAPE_CAPSULE, LW_SHAPE_MESH, LW_SHAPE_MESH, LW_SHAPE_SPHERE };
	for ( std::size_t i = 0; i < types.size(); ++i )
	{
		EXPECT_EQ( lw_shape_peek_info( model.links[1].collision[i].shape.get() ).type, types[i] ) << i;
		EXPECT_EQ( model.links[1].collision[i].pose.t[2], 3 );
	}
	EXPECT_EQ( model.report.shapes.at( 4 ).file, mesh );
	EXPECT_EQ( model.report.shapes.at( 4 ).scale[0], 2 );
	EXPECT_EQ( model.links[2].name, "a/plane" ) << "a plane is no part of a body";
	EXPECT_EQ( model.disabled.at( 0 ).reason, "fixed to the world in the SDF" );
}

TEST_F( SdfTest, WorldsHaveTheirModelsAndIncludes )
{
	write( "models/post/model.config", "<model><name>post</name><sdf version=\"1.9\">model.sdf</sdf></model>" );
	write(
	    "models/post/model.sdf", sdf( "<model name=\"post\"><static>true</static><link name=\"l\"><pose>0 0 1 0 0 0</pose>" +
	                                  std::string( ball ) + "</link></model>" ) );
	const std::string text =
	    sdf( "<world name=\"w\"><include><uri>model://post</uri><pose>1 0 0 0 0 0</pose><name>p1</name></include>"
	         "<include><uri>model://post</uri><pose>2 0 0 0 0 0</pose><name>p2</name></include></world>" );
	LoadOptions options;
	expectError( [&] { loadRobot( write( "w.sdf", text ), "" ); }, { "w.sdf: <sdf>", "post", "--package-path" } );
	options.package_paths = { path( "models" ) };
	const RobotModel model = loadRobot( path( "w.sdf" ), "", options );
	EXPECT_EQ( model.name, "w" );
	const leeway::Robot robot = buildRobot( model );
	EXPECT_EQ( poseOf( robot, "p1::l", {} ).t[0], 1 );
	EXPECT_EQ( poseOf( robot, "p2::l", {} ).t[0], 2 );
	EXPECT_EQ( poseOf( robot, "p2::l", {} ).t[2], 1 );
	const SceneModel scene = loadScene( path( "w.sdf" ), options );
	ASSERT_EQ( scene.objects.size(), 2u );
	EXPECT_EQ( scene.objects[1].name, "p2::l" );
}

TEST_F( SdfTest, LoopsAndInertiasAreTold )
{
	const std::string inertia = "<inertial><inertia><ixx>1</ixx><iyy>1</iyy><izz>9</izz></inertia></inertial>";
	const RobotModel model = load( sdf(
	    "<model name=\"m\"><link name=\"a\">" + std::string( ball ) + inertia +
	    "</link><link name=\"b\"/><joint name=\"rod\" type=\"screw\"><parent>a</parent><child>b</child><axis><xyz>0 0 1</xyz></axis></joint>"
	    "<joint name=\"j\" type=\"fixed\"><parent>a</parent><child>b</child></joint></model>" ) );
	EXPECT_NOTICE(
	    model.report.notices, "joints that close loops are not held (1), links move as if they were not there: rod at b" );
	EXPECT_NOTICE( model.report.notices, "inertia" );
}

TEST_F( SdfTest, WrongFilesAreRefusedWithTheirPlace )
{
	const std::string links = "<link name=\"a\">" + std::string( ball ) + "</link>\n<link name=\"b\"/>\n";
	const auto refused = [&]( const std::string& inside, const std::vector<std::string>& words )
	{ expectError( [&] { load( sdf( "<model name=\"m\">" + links + inside + "</model>" ) ); }, words ); };
	refused( "<joint name=\"j\" type=\"screw\"><parent>a</parent><child>b</child><axis><xyz>0 0 1</xyz></axis></joint>",
	    { "joint j (line 3)", "screw", "revolute" } );
	refused( "<joint name=\"j\" type=\"revolute\"><parent>a</parent><child>c</child><axis><xyz>0 0 1</xyz></axis></joint>",
	    { "model.sdf: <sdf>", "c", "correct the file" } );
	refused( "<joint name=\"j\" type=\"fixed\"><parent>a</parent><child>b</child></joint>"
	         "<joint name=\"k\" type=\"fixed\"><parent>b</parent><child>a</child></joint>",
	    { "cycle" } );
	refused(
	    "<joint name=\"j\" type=\"revolute\"><parent>a</parent><child>b</child><axis><xyz>0 0 1</xyz><limit><lower>1</lower>"
	    "</limit></axis></joint>",
	    { "joint j", "one side only" } );
	refused(
	    "<link name=\"c\"><collision name=\"x\"><geometry><mesh><uri>gone.obj</uri></mesh></geometry></collision></link>",
	    { "link c, collision x", "gone.obj was not found" } );
	refused( "<link name=\"c\"><collision name=\"x\"><geometry><box><size>0 1 1</size></box></geometry></collision></link>",
	    { "box" } );
	expectError( [&] { load( sdf( "" ) ); }, { "no model" } );
	expectError(
	    [&] { load( sdf( "<model name=\"m\"><link name=\"a\"/></model>" ) ); }, { "no link has collision geometry" } );
	EXPECT_NOTICE(
	    load( sdf( "<model name=\"m\"><link name=\"a\">" + std::string( ball ) + "<masss>1</masss></link></model>" ) )
	        .report.notices,
	    "masss" );
}
