// SPDX-License-Identifier: BSD-3-Clause
// MoveIt's padding and scale: from scenes and parameter files, for the right links, and scales in the geometry.
#include "files.hpp"

#include <cmath>

using namespace leeway::io;

namespace
{

std::string link( const std::string& name, const std::string& geometry, const std::string& origin = "" )
{
	return "<link name=\"" + name + "\"><collision>" + origin + "<geometry>" + geometry + "</geometry></collision></link>";
}

class PaddingTest : public FileTest
{
protected:
	/// A slider with a link of every shape, each 10 m further in x.
	RobotModel robot()
	{
		// Four corners with the mean (0.5, 0.5, 0.25)
		write( "m.obj", "v 0 0 0\nv 2 0 0\nv 0 2 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\nf 1 3 4\nf 2 3 4\n" );
		std::string urdf =
		    "<robot name=\"r\">" + link( "box", "<box size=\"1 2 3\"/>", "<origin xyz=\"0 5 0\"/>" ) +
		    link( "ball", "<sphere radius=\"0.5\"/>" ) + link( "can", "<cylinder radius=\"0.5\" length=\"2\"/>" ) +
		    link( "pill", "<capsule radius=\"0.5\" length=\"2\"/>" ) +
		    link( "mesh", "<mesh filename=\"m.obj\"/>", "<origin xyz=\"0 0 7\" rpy=\"0 0 1.5707963267948966\"/>" );
		std::string last = "box";
		for ( std::string name : { "ball", "can", "pill", "mesh" } )
		{
			urdf += "<joint name=\"to_" + name + "\" type=\"prismatic\"><origin xyz=\"10 0 0\"/><parent link=\"" + last +
			        "\"/><child link=\"" + name +
			        "\"/><limit lower=\"-1\" upper=\"1\" effort=\"1\" velocity=\"1\"/></joint>";
			last = name;
		}
		return loadRobot( write( "r.urdf", urdf + "</robot>" ), "" );
	}
	SceneModel scene( const std::string& text ) { return loadScene( write( "scene.yaml", "world: {}\n" + text ) ); }
	Padding parameters( const std::string& text ) { return loadPadding( write( "parameters.yaml", text ) ); }
	/// The lowest and highest corner of a link's shape in the link's frame.
	static void boxOf( const leeway::io::Problem& problem, const std::string& name, double low[3], double high[3] )
	{
		const lw_robot* r = problem.robot.get();
		std::uint32_t index = lw_robot_find_link( r, name.c_str() );
		for ( std::uint32_t i = 0; i < lw_robot_body_count( r ); ++i )
		{
			lw_body_def body = lw_robot_body( r, i );
			if ( body.link != index )
			{
				continue;
			}
			lw_shape_info info = lw_shape_get_info( body.shape );
			std::fill( low, low + 3, INFINITY );
			std::fill( high, high + 3, -INFINITY );
			for ( int corner = 0; corner < 8; ++corner )
			{
				for ( int row = 0; row < 3; ++row )
				{
					double v = body.link_from_shape.t[row];
					for ( int k = 0; k < 3; ++k )
					{
						v += body.link_from_shape.r[row][k] *
						     ( ( corner >> k & 1 ) != 0 ? info.box_max[k] : info.box_min[k] );
					}
					low[row] = std::fmin( low[row], v );
					high[row] = std::fmax( high[row], v );
				}
			}
		}
	}
	static void expectBox(
	    const leeway::io::Problem& problem, const std::string& name, std::vector<double> low, std::vector<double> high )
	{
		double l[3], h[3];
		boxOf( problem, name, l, h );
		for ( std::size_t i = 0; i < 3; ++i )
		{
			EXPECT_NEAR( l[i], low[i], 1e-12 ) << name << " " << i;
			EXPECT_NEAR( h[i], high[i], 1e-12 ) << name << " " << i;
		}
	}
};

} // namespace

TEST_F( PaddingTest, ScalesOfASceneAreInTheGeometry )
{
	RobotModel model = robot();
	SceneModel s =
	    scene( "link_scale: [{link_name: box, scale: 2}, {link_name: ball, scale: 3}, {link_name: can, scale: 0.5}, "
	           "{link_name: pill, scale: 2}, {link_name: mesh, scale: 3}]\n" );
	ProblemOptions options;
	options.scene = &s;
	Problem problem = buildProblem( model, options );
	expectBox( problem, "box", { -1, 3, -3 }, { 1, 7, 3 } );
	expectBox( problem, "ball", { -1.5, -1.5, -1.5 }, { 1.5, 1.5, 1.5 } );
	expectBox( problem, "can", { -0.25, -0.25, -0.5 }, { 0.25, 0.25, 0.5 } );
	expectBox( problem, "pill", { -1, -1, -3 }, { 1, 1, 3 } );
	// About the mean of the vertices: x in [-1, 5], y in [-1, 5], z in [-0.5, 2.5] of the mesh, which is turned by a quarter
	expectBox( problem, "mesh", { -5, -1, 6.5 }, { 1, 5, 9.5 } );
	EXPECT_EQ( problem.padding.link_scale.size(), 5u );
	// The model itself is as it was
	expectBox( buildProblem( model, {} ), "box", { -0.5, 4, -1.5 }, { 0.5, 6, 1.5 } );
}

TEST_F( PaddingTest, TheSceneIsStrongerThanParametersAndTheyThanTheirDefaults )
{
	RobotModel model = robot();
	SceneModel s = scene( "link_padding: [{link_name: ball, padding: 0.03}, {link_name: can, padding: 0}]\n"
	                      "link_scale: [{link_name: ball, scale: 1}]\n" );
	ProblemOptions options;
	options.scene = &s;
	options.padding = parameters( "default_robot_padding: 0.01\ndefault_robot_scale: 2\ndefault_object_padding: 0.04\n"
	                              "default_attached_padding: 0.05\ndefault_robot_link_padding: {pill: 0.02, ball: 0.5}\n"
	                              "default_robot_link_scale: {box: 4}\n" );
	Problem problem = buildProblem( model, options );
	EXPECT_EQ( problem.padding.link_padding,
	    ( std::map<std::string, double>{ { "box", 0.01 }, { "ball", 0.03 }, { "pill", 0.02 }, { "mesh", 0.01 } } ) );
	EXPECT_EQ( problem.padding.link_scale,
	    ( std::map<std::string, double>{ { "box", 4 }, { "can", 2 }, { "pill", 2 }, { "mesh", 2 } } ) );
	EXPECT_EQ( problem.padding.object, 0.04 );
	EXPECT_EQ( problem.padding.attached, 0.05 );
	expectBox( problem, "ball", { -0.5, -0.5, -0.5 }, { 0.5, 0.5, 0.5 } );
	expectBox( problem, "can", { -1, -1, -2 }, { 1, 1, 2 } );
	EXPECT_EQ( allNotices( problem.notices ).find( "padding" ), std::string::npos );
}

TEST_F( PaddingTest, NeutralValuesChangeNothing )
{
	RobotModel model = robot();
	SceneModel s = scene( "link_padding: [{link_name: box, padding: 0}, {link_name: someone, padding: 0.0}]\n"
	                      "link_scale: [{link_name: box, scale: 1}, {link_name: someone, scale: 1.0}]\n" );
	ProblemOptions options;
	options.scene = &s;
	Problem problem = buildProblem( model, options );
	EXPECT_TRUE( problem.padding.link_padding.empty() );
	EXPECT_TRUE( problem.padding.link_scale.empty() );
	EXPECT_TRUE( problem.notices.empty() ) << allNotices( problem.notices );
	EXPECT_EQ( lw_robot_body( problem.robot.get(), 0 ).shape, model.links.at( 0 ).collision.at( 0 ).shape.get() );
}

TEST_F( PaddingTest, ParametersOfRos1AndRos2 )
{
	EXPECT_EQ(
	    parameters( "robot_description_planning:\n  default_robot_padding: 0.01\n  joint_limits: {a: {max: 1}}\n" ).robot,
	    0.01 );
	Padding ros2 = parameters( "move_group:\n  ros__parameters:\n    other: [1, 2]\n    robot_description_planning:\n      "
	                           "default_robot_link_padding: {hand: 0.02}\n" );
	EXPECT_EQ( ros2.link_padding.at( "hand" ), 0.02 );
	auto bad = [&]( const std::string& text, std::vector<std::string> parts )
	{
		parts.push_back( "parameters.yaml" );
		expectError( [&] { parameters( text ); }, parts );
	};
	bad( "robot_padding: 0.01\n", { "no parameter of padding or scale", "default_robot_padding" } );
	bad( "default_robot_padding: -0.01\n", { "default_robot_padding", "-0.01 is no padding" } );
	bad( "default_robot_padding: x\n", { "default_robot_padding", "not a number" } );
	bad( "default_robot_link_scale: {scaler: 0}\n", { "default_robot_link_scale.scaler", "0 is no scale" } );
	bad( "default_robot_link_padding: {scaler: 0}\ndefault_robot_scale: 0\n", { "default_robot_scale" } );
	bad( "default_robot_link_padding: [0.1]\n", { "default_robot_link_padding", "not a map" } );
	bad( "a: {default_robot_scale: 1}\nb: {default_robot_scale: 2}\n", { "there twice", "a.default_robot_scale" } );
	expectError( [&] { loadPadding( path( "none.yaml" ) ); }, { "none.yaml", "no such file" } );
}

TEST_F( PaddingTest, ShapesThatNoLinkCanHave )
{
	auto bad = [&]( const std::string& text, std::vector<std::string> parts )
	{
		parts.push_back( "scene.yaml" );
		expectError( [&] { scene( text ); }, parts );
	};
	bad( "link_padding: [{link_name: box, padding: -0.1}]\n", { "link_padding[0] box.padding", "-0.1 is no padding" } );
	bad( "link_padding: [{link_name: box, padding: .nan}]\n", { "link_padding[0] box.padding", "not finite" } );
	bad( "link_padding: [{link_name: box}]\n", { "link_padding[0] box.padding", "missing" } );
	bad( "link_padding: [{padding: 0.1}]\n", { "link_padding[0].link_name", "missing" } );
	bad(
	    "link_padding: [{link_name: box, padding: 0}, {link_name: box, padding: 1}]\n", { "link_padding[1] box", "twice" } );
	bad( "link_scale: [{link_name: box, scale: 0}]\n", { "link_scale[0] box.scale", "0 is no scale" } );
	bad( "link_scale: [{link_name: box, scale: -1}]\n", { "-1 is no scale" } );

	RobotModel model = robot();
	for ( const char* entry :
	    { "link_padding: [{link_name: hand, padding: 0.1}]\n", "link_scale: [{link_name: hand, scale: 2}]\n" } )
	{
		SceneModel s = scene( entry );
		ProblemOptions options;
		options.scene = &s;
		expectError( [&] { buildProblem( model, options ); }, { "scene.yaml", "hand", "no link hand" } );
	}
	ProblemOptions options;
	options.padding.link_padding["hand"] = 0.1;
	expectError( [&] { buildProblem( model, options ); }, { "r.urdf", "no link hand" } );
	options.padding.link_padding = { { "box", NAN } };
	expectError( [&] { buildProblem( model, options ); }, { "link_padding box", "is no padding" } );
	options.padding.link_padding.clear();
	options.padding.robot_scale = -1;
	expectError( [&] { buildProblem( model, options ); }, { "link_scale", "-1 is no scale" } );
	options.padding = Padding();
	options.padding.object = -1;
	expectError( [&] { buildProblem( model, options ); }, { "objects", "-1 is no padding" } );
}
