// SPDX-License-Identifier: BSD-3-Clause
// Mesh files of every format but COLLADA and glTF: the same tetrahedron, with the units, transforms and faults that each
// format allows.
#include "files.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

using namespace leeway::io;

namespace
{

class MeshTest : public FileTest
{
protected:
	/// The shape of a robot of one link with this mesh.
	lw_shape_info load( const std::string& mesh, const std::string& scale = "", RobotModel* model = nullptr )
	{
		std::string attribute = scale.empty() ? "" : " scale=\"" + scale + "\"";
		std::string urdf =
		    write( "robot.urdf", "<robot name=\"r\"><link name=\"base\"><collision><geometry><mesh filename=\"" + mesh +
		                             "\"" + attribute + "/></geometry></collision></link></robot>" );
		m_model = loadRobot( urdf, "" );
		if ( model != nullptr )
		{
			*model = m_model;
		}
		return lw_shape_get_info( m_model.links[0].collision[0].shape.get() );
	}
	void expectBox( const lw_shape_info& info, std::vector<double> low, std::vector<double> high )
	{
		for ( std::size_t i = 0; i < 3; ++i )
		{
			EXPECT_NEAR( info.box_min[i], low[i], 1e-6 ) << "axis " << i;
			EXPECT_NEAR( info.box_max[i], high[i], 1e-6 ) << "axis " << i;
		}
	}
	RobotModel m_model;
};

const float corners[4][3] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 2, 0 }, { 0, 0, 3 } };
const std::uint32_t faces[4][3] = { { 0, 1, 2 }, { 0, 1, 3 }, { 0, 2, 3 }, { 1, 2, 3 } };

std::string number( float value )
{
	return std::to_string( value );
}

std::string asciiStl( const std::string& first = "" )
{
	std::string text = "solid tetrahedron\n";
	for ( const auto& face : faces )
	{
		text += "facet normal 0 0 0\nouter loop\n";
		for ( std::uint32_t v : face )
		{
			bool replace = !first.empty() && &face == &faces[0] && v == 0;
			text += "vertex " + ( replace ? first : number( corners[v][0] ) ) + " " + number( corners[v][1] ) + " " +
			        number( corners[v][2] ) + "\n";
		}
		text += "endloop\nendfacet\n";
	}
	return text + "endsolid tetrahedron\n";
}

template <typename T> void append( std::string& bytes, const T& value )
{
	bytes.append( reinterpret_cast<const char*>( &value ), sizeof value );
}

std::string binaryStl( float first_x = 0 )
{
	std::string bytes( 80, ' ' );
	append( bytes, std::uint32_t{ 4 } );
	for ( const auto& face : faces )
	{
		bytes.append( 12, '\0' );
		for ( std::uint32_t v : face )
		{
			append( bytes, v == 0 ? first_x : corners[v][0] );
			append( bytes, corners[v][1] );
			append( bytes, corners[v][2] );
		}
		bytes.append( 2, '\0' );
	}
	return bytes;
}

} // namespace

TEST_F( MeshTest, AsciiStl )
{
	write( "m.stl", asciiStl() );
	lw_shape_info info = load( "m.stl" );
	EXPECT_EQ( info.triangle_count, 4u );
	expectBox( info, { 0, 0, 0 }, { 1, 2, 3 } );
}

/// Words that a reader passes over are triangles less.
TEST_F( MeshTest, WordsOfAsciiStlArePassedOver )
{
	const std::string good = asciiStl();
	const auto refused = [&]( const std::string& from, const std::string& to, const std::string& problem )
	{
		std::string text = good;
		const std::size_t at = text.find( from );
		ASSERT_NE( at, std::string::npos ) << from;
		write( "m.stl", text.replace( at, from.size(), to ) );
		expectError( [&] { load( "m.stl" ); }, { "m.stl", problem } );
	};
	refused( "vertex 1.000000", "vertex 1.000,5", "line 5: has \"1.000,5\" where a finite number should be" );
	refused( "vertex 1.000000", "vertex nan", "has \"nan\"" );
	refused( "vertex 1.000000", "vertx 1.0", "has \"vertx\" where vertex should be" );
	refused( "vertex 1.000000", std::string( "vertex 1\0", 9 ), "where a finite number should be" );
	refused( "endloop\nendfacet", "endloop", "has \"facet\" where endfacet should be" );
	refused( "endloop", "vertex 0 0 0\nendloop", "where endloop should be" );
	refused( "endsolid tetrahedron\n", "", "ends where endsolid should be: it was cut short" );
	refused( "endsolid tetrahedron\n", "endsolid tetrahedron\nmore", "has \"more\" where solid should be" );
	write( "m.stl",
	    good +
	        "SOLID second\nFACET NORMAL nan nan nan OUTER LOOP vertex 0 0 -1e0 vertex 1 0 0\nvertex 0 1 0 endloop endfacet\nENDSOLID\n" );
	EXPECT_EQ( load( "m.stl" ).triangle_count, 5u );
	expectBox( load( "m.stl" ), { 0, 0, -1 }, { 1, 2, 3 } );
}

TEST_F( MeshTest, WordsOfOffAreTakenForTheNumbersThatTheyBeginWith )
{
	const std::string good = "OFF # four\n4 4 0\n0 0 0\n1 0 0\n0 2 0\n0 0 3\n3 0 1 2\n3 0 1 3\n3 0 2 3\n3 1 2 3\n";
	write( "m.off", good );
	EXPECT_EQ( load( "m.off" ).triangle_count, 4u );
	write( "m.off", std::string( good ).replace( good.find( "0 2 0" ), 3, "0 2,5" ) );
	expectError( [&] { load( "m.off" ); }, { "m.off", "line 5 has \"2,5\" where a number should be" } );
}

TEST_F( MeshTest, BinaryStlWhateverItsHeaderSays )
{
	std::string bytes = binaryStl();
	write( "m.STL", bytes );
	expectBox( load( "m.STL" ), { 0, 0, 0 }, { 1, 2, 3 } );
	bytes.replace( 0, 5, "solid" );
	write( "n.stl", bytes );
	EXPECT_EQ( load( "n.stl" ).triangle_count, 4u );
}

TEST_F( MeshTest, ObjWithQuadsKeepsEveryTriangle )
{
	write( "m.obj", "v 0 0 0\nv 1 0 0\nv 1 2 0\nv 0 2 0\nv 0 0 3\nf 1 2 3 4\nf 1 2 5\n" );
	lw_shape_info info = load( "m.obj" );
	EXPECT_EQ( info.triangle_count, 3u );
	expectBox( info, { 0, 0, 0 }, { 1, 2, 3 } );
}

TEST_F( MeshTest, DegenerateAndDuplicateTrianglesStay )
{
	write( "m.obj", "v 0 0 0\nv 1 0 0\nv 0 2 0\nf 1 2 3\nf 1 2 3\nf 1 2 2\nf 1 1 1\n" );
	lw_shape_info info = load( "m.obj" );
	EXPECT_EQ( info.triangle_count, 4u );
	EXPECT_EQ( info.degenerate_count, 2u );
}

TEST_F( MeshTest, LinesAndPointsAreDroppedWithANotice )
{
	write( "m.obj", "v 0 0 0\nv 1 0 0\nv 0 2 0\nf 1 2 3\nl 1 2\n" );
	RobotModel model;
	EXPECT_EQ( load( "m.obj", "", &model ).triangle_count, 1u );
	EXPECT_NOTICE( model.report.notices, "1 points and lines" );
}

TEST_F( MeshTest, Ply )
{
	write( "m.ply",
	    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 4\n"
	    "property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 2 0\n0 0 3\n3 0 1 2\n3 0 1 3\n3 0 2 3\n3 1 2 "
	    "3\n" );
	lw_shape_info info = load( "m.ply" );
	EXPECT_EQ( info.triangle_count, 4u );
	expectBox( info, { 0, 0, 0 }, { 1, 2, 3 } );
}

/// A header up to the element of faces, and a tetrahedron's corners.
const std::string ply_points = "element vertex 4\nproperty double x\nproperty double y\nproperty double z\n";
const std::string ply_corners = "0 0 0\n1 0 0\n0 2 0\n0 0 3\n";

TEST_F( MeshTest, PlyWordsAreNoLines )
{
	// assimp takes the first line for the first vertex, and the rest of the words of the second for a face
	write(
	    "m.ply", "ply\nformat ascii 1.0\n" + ply_points +
	                 "element face 4\nproperty list uchar int vertex_index\nend_header\n0 0\n0 1 0 0 0\n\n\n2 0 0 0 3\n3 0 "
	                 "1\n2 3 0 1 3 3 0 2 3 3 1 2 3" );
	lw_shape_info info = load( "m.ply" );
	EXPECT_EQ( info.triangle_count, 4u );
	EXPECT_EQ( info.degenerate_count, 0u );
	expectBox( info, { 0, 0, 0 }, { 1, 2, 3 } );
}

TEST_F( MeshTest, PlyStripsAreAllThere )
{
	// assimp keeps the last one
	write( "m.ply", "ply\nformat ascii 1.0\n" + ply_points +
	                    "element tristrips 2\nproperty list int int vertex_indices\nend_header\n" + ply_corners +
	                    "8 0 1 2 -1 1 2 0 3\n3 0 1 3\n" );
	EXPECT_EQ( load( "m.ply" ).triangle_count, 4u );
	expectBox( load( "m.ply" ), { 0, 0, 0 }, { 1, 2, 3 } );
	write( "bad.ply", "ply\nformat ascii 1.0\n" + ply_points +
	                      "element tristrips 1\nproperty list int int vertex_indices\nend_header\n" + ply_corners +
	                      "3 0 -2 1\n" );
	expectError( [&] { load( "bad.ply" ); }, { "bad.ply", "tristrips 0", "vertex -2 of 4" } );
}

TEST_F( MeshTest, PlyBeyondABlockOfAssimps )
{
	// 3 MB and more: its numbers lie across the blocks that assimp reads
	constexpr int n = 200;
	std::string vertices, ply_faces, obj_faces;
	for ( int i = 0; i < n * n; ++i )
	{
		const int column = i % n, row = i / n;
		vertices += "v " + std::to_string( column ) + " " + std::to_string( row ) + " " + std::to_string( i * i % 7 ) + "\n";
		if ( column + 1 < n && row + 1 < n )
		{
			const std::string a = " " + std::to_string( i + 1 ), b = " " + std::to_string( i + n );     // from 0
			const std::string c = " " + std::to_string( i + 2 ), d = " " + std::to_string( i + n + 1 ); // from 1
			ply_faces += "3 " + std::to_string( i ) + a + b + "\n3" + a + b + d + "\n";
			obj_faces += "f" + a + c + d + "\nf" + c + d + " " + std::to_string( i + n + 2 ) + "\n";
		}
	}
	write( "m.obj", vertices + obj_faces );
	vertices.erase( std::remove( vertices.begin(), vertices.end(), 'v' ), vertices.end() );
	write( "m.ply", "ply\nformat ascii 1.0\nelement vertex " + std::to_string( n * n ) +
	                    "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
	                    std::to_string( 2 * ( n - 1 ) * ( n - 1 ) ) +
	                    "\nproperty list uchar int vertex_indices\nend_header\n" + vertices + ply_faces );
	RobotModel ply, obj;
	EXPECT_EQ( load( "m.ply", "", &ply ).triangle_count, 2u * ( n - 1 ) * ( n - 1 ) );
	(void)load( "m.obj", "", &obj );
	EXPECT_TRUE( lw_digest_equal( lw_shape_digest( ply.links.at( 0 ).collision.at( 0 ).shape.get() ),
	    lw_shape_digest( obj.links.at( 0 ).collision.at( 0 ).shape.get() ) ) );
}

TEST_F( MeshTest, PlyWithMoreOrLessThanItsHeaderSays )
{
	const std::string begin = "ply\nformat ascii 1.0\n" + ply_points, two = "element face 2\n",
	                  list = "property list uchar int vertex_indices\n", end = "end_header\n" + ply_corners;
	auto bad = [&]( const std::string& text, const std::vector<std::string>& parts )
	{
		write( "bad.ply", text );
		expectError( [&] { load( "bad.ply" ); }, parts );
	};
	write( "good.ply", begin + two + list + end + "3 0 1 2\n4 0 1 2 3\n \n" );
	EXPECT_EQ( load( "good.ply" ).triangle_count, 3u );
	bad( begin + two + list + end + "3 0 1 2\n4 0 1 2 3\n3 1 2 3\n", { "bad.ply", "end", "after the last element" } );
	bad( begin + two + list + end + "3 0 1 2\n9999999999 0 1 2 3\n", { "bad.ply", "face 1", "is missing" } );
	bad( begin + two + list + end + "3 0 1 2\n1.5 0 1 2 3\n", { "bad.ply", "face 1", "length 1.5" } );
	bad( begin + two + list + end + "3 0 1 2\n3 0 1.5 2\n", { "bad.ply", "face 1", "vertex 1.5 of 4" } );
	bad( begin + two + list + end + "3 0 1 2\n0\n", { "bad.ply", "face 1", "no corners" } );
	bad( begin + two + "property list uchar int corners\n" + end + "3 0 1 2\n3 0 1 2\n",
	    { "bad.ply", "element face", "0 lists vertex_indices" } );
	bad( begin + two + list + list + end + "3 0 1 2 3 0 1 2\n3 0 1 2 3 0 1 2\n", { "bad.ply", "element face", "2 lists" } );
}

TEST_F( MeshTest, ScaleAndMirror )
{
	write( "m.stl", asciiStl() );
	expectBox( load( "m.stl", "0.001 0.001 -0.002" ), { 0, 0, -0.006 }, { 0.001, 0.002, 0 } );
	EXPECT_DOUBLE_EQ( m_model.report.shapes[0].scale[2], -0.002 );
	expectError( [&] { load( "m.stl", "1 0 1" ); }, { "robot.urdf", "link base, collision 1", "scale 1 0 1" } );
}

TEST_F( MeshTest, OneShapePerFileAndScale )
{
	write( "m.stl", asciiStl() );
	std::string collision = "<collision><geometry><mesh filename=\"m.stl\" scale=\"1 1 1\"/></geometry></collision>";
	std::string other = "<collision><geometry><mesh filename=\"./m.stl\" scale=\"2 1 1\"/></geometry></collision>";
	std::string urdf =
	    write( "robot.urdf", "<robot name=\"r\"><link name=\"base\">" + collision + other + collision +
	                             "<collision><geometry><mesh filename=\"./m.stl\"/></geometry></collision></link></robot>" );
	RobotModel model = loadRobot( urdf, "" );
	const std::vector<PlacedShape>& shapes = model.links[0].collision;
	EXPECT_EQ( shapes[0].shape.get(), shapes[2].shape.get() );
	EXPECT_EQ( shapes[0].shape.get(), shapes[3].shape.get() ) << "no scale is scale 1, and ./m.stl is m.stl";
	EXPECT_NE( shapes[0].shape.get(), shapes[1].shape.get() );
	ASSERT_EQ( model.report.shapes.size(), 4u );
	EXPECT_FALSE( model.report.shapes[0].shared );
	EXPECT_FALSE( model.report.shapes[1].shared );
	EXPECT_TRUE( model.report.shapes[2].shared );
	EXPECT_TRUE( model.report.shapes[3].shared );
	EXPECT_EQ( model.report.shapes[2].file, path( "m.stl" ) );
	EXPECT_EQ( model.report.shapes[2].owner, "base" );
}

TEST_F( MeshTest, NotFiniteVertices )
{
	write( "nan.stl", binaryStl( std::nanf( "" ) ) );
	expectError( [&] { load( "nan.stl" ); }, { "robot.urdf", "link base, collision 1", "nan.stl" } );
	write( "inf.stl", binaryStl( INFINITY ) );
	expectError( [&] { load( "inf.stl" ); }, { "robot.urdf", "inf.stl" } );
	write( "text.stl", asciiStl( "nan" ) );
	expectError( [&] { load( "text.stl" ); }, { "robot.urdf", "text.stl" } );
	write( "nan.obj", "v nan 0 0\nv 1 0 0\nv 0 2 0\nf 1 2 3\n" );
	expectError( [&] { load( "nan.obj" ); }, { "robot.urdf", "nan.obj" } );
	write( "inf.obj", "v 1e300 0 0\nv 1 0 0\nv 0 2 0\nf 1 2 3\n" );
	expectError( [&] { load( "inf.obj" ); }, { "robot.urdf", "inf.obj" } );
	write( "nan.ply",
	    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
	    "property list uchar int vertex_indices\nend_header\n0 nan 0\n1 0 0\n0 2 0\n3 0 1 2\n" );
	expectError( [&] { load( "nan.ply" ); }, { "robot.urdf", "nan.ply" } );
}

TEST_F( MeshTest, EmptyBrokenAndUnknownFiles )
{
	write( "empty.stl", "" );
	expectError( [&] { load( "empty.stl" ); }, { "robot.urdf", "link base, collision 1", "empty.stl" } );
	write( "none.stl", "solid a\nendsolid a\n" );
	expectError( [&] { load( "none.stl" ); }, { "robot.urdf", "none.stl" } );
	write( "points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n" );
	expectError( [&] { load( "points.obj" ); }, { "robot.urdf", "points.obj" } );
	write( "cut.stl", binaryStl().substr( 0, 150 ) );
	expectError( [&] { load( "cut.stl" ); }, { "robot.urdf", "cut.stl" } );
	write( "what.xyzzy", "hello" );
	expectError( [&] { load( "what.xyzzy" ); }, { "robot.urdf", "what.xyzzy", "convert" } );
}
