// SPDX-License-Identifier: BSD-3-Clause
// COLLADA documents: random scenes against assimp's reader, units and transforms, documents that crash assimp, and faults.
#include "mesh_triangles.hpp"
#include "seeded_rng.hpp"

#include <fmt/format.h>

using namespace leeway::io;

namespace
{

class ColladaTest : public MeshTriangles
{
protected:
	/// Of the mesh that was loaded last.
	void expectBox( std::vector<double> low, std::vector<double> high )
	{
		const lw_shape_info info = lw_shape_get_info( m_model.links[0].collision[0].shape.get() );
		for ( std::size_t i = 0; i < 3; ++i )
		{
			EXPECT_NEAR( info.box_min[i], low[i], 1e-15 ) << "axis " << i;
			EXPECT_NEAR( info.box_max[i], high[i], 1e-15 ) << "axis " << i;
		}
	}
};

const float tetrahedron[4][3] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 2, 0 }, { 0, 0, 3 } };
const std::uint32_t sides[4][3] = { { 0, 1, 2 }, { 0, 1, 3 }, { 0, 2, 3 }, { 1, 2, 3 } };

std::string number( double value )
{
	return fmt::format( "{:.9g}", value );
}

/// A tetrahedron at one node.
std::string collada( const std::string& unit, const std::string& up, const std::string& node_matrix )
{
	std::string positions, indices;
	for ( const auto& c : tetrahedron )
	{
		positions += number( c[0] ) + " " + number( c[1] ) + " " + number( c[2] ) + " ";
	}
	for ( const auto& f : sides )
	{
		indices += std::to_string( f[0] ) + " " + std::to_string( f[1] ) + " " + std::to_string( f[2] ) + " ";
	}
	return "<?xml version=\"1.0\"?><COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" "
	       "version=\"1.4.1\"><asset>" +
	       unit + "<up_axis>" + up +
	       "</up_axis></asset><library_geometries><geometry id=\"g\"><mesh><source id=\"p\"><float_array id=\"a\" "
	       "count=\"12\">" +
	       positions +
	       "</float_array><technique_common><accessor source=\"#a\" count=\"4\" stride=\"3\"><param "
	       "name=\"X\" type=\"float\"/><param name=\"Y\" type=\"float\"/><param name=\"Z\" "
	       "type=\"float\"/></accessor></technique_common>"
	       "</source><vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/></vertices><triangles "
	       "count=\"4\"><input "
	       "semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/><p>" +
	       indices +
	       "</p></triangles></mesh></geometry></library_geometries>"
	       "<library_visual_scenes><visual_scene id=\"s\"><node id=\"n\"><matrix>" +
	       node_matrix +
	       "</matrix><instance_geometry "
	       "url=\"#g\"/></node></visual_scene></library_visual_scenes><scene><instance_visual_scene "
	       "url=\"#s\"/></scene></COLLADA>";
}

const char* identity_matrix = "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1";

std::string replaced( std::string text, const std::string& what, const std::string& by )
{
	const std::size_t at = text.find( what );
	EXPECT_NE( at, std::string::npos ) << what;
	return text.replace( at, what.size(), by );
}

/// Matrices, turns and moves in any order. Axes are of length 1, and upward is across to ahead: else assimp shears.
std::string randomTransforms( SeededRng& rng )
{
	const auto write = [&]( const char* name, const std::vector<double>& numbers )
	{
		std::string out = std::string( "<" ) + name + ">";
		for ( const double value : numbers )
		{
			out += number( value ) + " ";
		}
		return out + "</" + name + ">";
	};
	const auto random = [&]( std::size_t count )
	{
		std::vector<double> out( count );
		std::generate( out.begin(), out.end(), [&] { return rng.uniform( -1, 1 ); } );
		return out;
	};
	std::string out;
	for ( int i = rng.integer( 0, 3 ); i > 0; --i )
	{
		std::vector<double> v = random( 12 );
		const double length = std::sqrt( v[0] * v[0] + v[1] * v[1] + v[2] * v[2] );
		switch ( rng.integer( 0, 4 ) )
		{
		case 0:
			v.insert( v.end(), { 0, 0, 0, 1 } );
			out += write( "matrix", v );
			break;
		case 1:
			out += write( "rotate", { v[0] / length, v[1] / length, v[2] / length, 180 * v[3] } );
			break;
		case 2:
			out += write( "lookat", { v[3], v[4], v[5], v[3] + v[0], v[4] + v[1], v[5] + v[2], v[1], -v[0], 0 } );
			break;
		default:
			out += write( rng.integer( 0, 1 ) == 0 ? "translate" : "scale", random( 3 ) );
		}
	}
	return out;
}

/// Faces with normals or without, whose indices stand before or after those of vertices.
std::string randomFaces( SeededRng& rng, int vertices )
{
	const int kind = rng.integer( 0, 2 ), step = rng.integer( 1, 3 ), vertex = rng.integer( 0, step - 1 ),
	          faces = rng.integer( 1, 5 );
	const char* names[] = { "triangles", "polylist", "tristrips" };
	std::string inputs = "<input semantic=\"VERTEX\" source=\"#v\" offset=\"" + std::to_string( vertex ) + "\"/>";
	for ( int other = 0; other < step; ++other )
	{
		inputs +=
		    other == vertex ? "" : "<input semantic=\"NORMAL\" source=\"#p\" offset=\"" + std::to_string( other ) + "\"/>";
	}
	std::string lengths, list;
	const int corners = kind == 2 ? faces + 2 : 3 * faces;
	for ( int i = 0; i < corners * step; ++i )
	{
		list += std::to_string( rng.integer( 0, vertices - 1 ) ) + " ";
	}
	for ( int i = 0; i < faces && kind == 1; ++i )
	{
		lengths += "3 ";
	}
	return std::string( "<" ) + names[kind] + " count=\"" + std::to_string( kind == 2 ? 1 : faces ) + "\">" + inputs +
	       ( kind == 1 ? "<vcount>" + lengths + "</vcount>" : "" ) + "<p>" + list + "</p></" + names[kind] + ">";
}

std::string randomDocument( SeededRng& rng )
{
	const int vertices = rng.integer( 3, 9 ), more = rng.integer( 0, 2 ), skipped = rng.integer( 0, 3 );
	std::string positions, parameters, faces, nodes, ends;
	const int all = skipped + ( 3 + more ) * vertices;
	for ( int i = 0; i < all; ++i )
	{
		positions += number( rng.uniform( -1, 1 ) ) + " ";
	}
	for ( const char* axis : { "X", "Y", "Z" } )
	{
		parameters += std::string( "<param name=\"" ) + axis + "\" type=\"float\"/>";
	}
	for ( int i = rng.integer( 1, 3 ); i > 0; --i )
	{
		faces += randomFaces( rng, vertices );
	}
	for ( int i = rng.integer( 1, 4 ); i > 0; --i )
	{
		nodes += "<node>" + randomTransforms( rng ) + ( rng.integer( 0, 1 ) == 0 ? "<instance_geometry url=\"#g\"/>" : "" ) +
		         ( rng.integer( 0, 1 ) == 0 ? "<instance_node url=\"#l\"/>" : "" );
		const bool closes = rng.integer( 0, 1 ) == 0;
		nodes += closes ? "</node>" : "";
		ends += closes ? "" : "</node>";
	}
	return "<?xml version=\"1.0\"?><COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" version=\"1.4.1\"><asset><unit "
	       "meter=\"" +
	       number( rng.uniform( 0.1, 2 ) ) +
	       "\"/><up_axis>Y_UP</up_axis></asset><library_geometries><geometry id=\"g\"><mesh><source id=\"p\"><float_array id=\"a\" "
	       "count=\"" +
	       std::to_string( all ) + "\">" + positions + "</float_array><technique_common><accessor source=\"#a\" count=\"" +
	       std::to_string( vertices ) + "\" stride=\"" + std::to_string( 3 + more ) + "\" offset=\"" +
	       std::to_string( skipped ) + "\">" + parameters +
	       "</accessor></technique_common></source><vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/></vertices>" +
	       faces + "</mesh></geometry></library_geometries><library_nodes><node id=\"l\">" + randomTransforms( rng ) +
	       "<instance_geometry url=\"#g\"/></node></library_nodes><library_visual_scenes><visual_scene id=\"s\">" + nodes +
	       ends +
	       "<node><instance_geometry url=\"#g\"/></node></visual_scene></library_visual_scenes><scene><instance_visual_scene "
	       "url=\"#s\"/></scene></COLLADA>";
}

} // namespace

TEST_F( ColladaTest, TrianglesDifferFromThoseOfAssimp )
{
	SeededRng rng( 20261122 );
	std::size_t triangles = 0;
	for ( int i = 0; i < 150; ++i )
	{
		const std::string text = randomDocument( rng );
		write( "m.dae", text );
		const std::vector<Triangle> ours = load( "m.dae" );
		ASSERT_LT( difference( ours, trianglesByAssimp( path( "m.dae" ) ) ), 1e-4 )
		    << i << ": " << text; // theirs are of float
		triangles += ours.size();
	}
	EXPECT_GT( triangles, 2000u );
}

TEST_F( ColladaTest, UnitIsApplied )
{
	write( "m.dae", collada( "<unit name=\"centimeter\" meter=\"0.01\"/>", "Z_UP", identity_matrix ) );
	load( "m.dae" );
	expectBox( { 0, 0, 0 }, { 0.01, 0.02, 0.03 } );
}

TEST_F( ColladaTest, UpAxisIsNot )
{
	for ( const char* up : { "X_UP", "Y_UP", "Z_UP" } )
	{
		write( "m.dae", collada( "<unit meter=\"1\"/>", up, identity_matrix ) );
		load( "m.dae" );
		expectBox( { 0, 0, 0 }, { 1, 2, 3 } );
	}
}

TEST_F( ColladaTest, NodeTransformIsApplied )
{
	write( "m.dae", collada( "<unit meter=\"0.1\"/>", "Y_UP", "0 -1 0 5 1 0 0 0 0 0 1 0 0 0 0 1" ) );
	load( "m.dae" );
	expectBox( { 0.3, 0, 0 }, { 0.5, 0.1, 0.3 } );
}

/// Each of them made assimp read without end, or ask for more memory than there is.
TEST_F( ColladaTest, MissingNumbersAreReadAllTheSame )
{
	const std::string good = collada( "<unit meter=\"1\"/>", "Z_UP", identity_matrix );
	const auto refused = [&]( const std::string& what, const std::string& by, const std::string& words )
	{
		write( "bad.dae", replaced( good, what, by ) );
		expectError( [&] { load( "bad.dae" ); }, { "robot.urdf", "bad.dae", words } );
	};
	refused( "<p>0 1 2", "<p>0 1 \"2", "an index should be" );
	refused( identity_matrix, "nan 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1", "" );
	refused( identity_matrix, "1 0 0 0 0 1 0 0 0 0 1 0", "has 12 numbers, not 16" );
	refused( "</p></triangles>", "7 </p></triangles>", "" );
	refused( "<p>0 1 2", "<p>0 1 4", "names vertex 4 of 4" );
	refused( "count=\"4\" stride=\"3\"", "count=\"5\" stride=\"3\"", "asks for 5 points" );
	refused( "count=\"4\" stride=\"3\"", "count=\"4\" stride=\"2\"", "asks for 4 points" );
	refused( "count=\"4\" stride=\"3\"", "count=\"4\" stride=\"3\" offset=\"1\"", "from number 1 on" );
	refused( "url=\"#g\"", "url=\"#h\"", "no <geometry> here has that id" );
	refused( "url=\"#g\"", "url=\"other.dae#g\"", "no <geometry> here has that id" );
	refused( "semantic=\"VERTEX\"", "semantic=\"NORMAL\"", "has no input VERTEX" );
	refused( "meter=\"1\"", "meter=\"0\"", "which is no length" );
	refused( "<scene>", "<scenery>", "" );
	refused( "<p>0 1 2", "<p>0 -1 2", "an index should be" );
	refused( "<triangles count=\"4\"", "<triangles count=\"400000000\"", "4 faces of 400000000" );
	refused( "count=\"12\"", "count=\"1000000000\"", "12 numbers of 1000000000" );
	refused( "offset=\"0\"", "offset=\"4000000000\"", "12 indices, 4000000001 for each corner" );
	refused( "offset=\"0\"", "offset=\"18446744073709551615\"", "is index 18446744073709551615 of a corner" );
	refused( "<instance_geometry url=\"#g\"/>", "<instance_node url=\"#n\"/>", "the limit nesting is 128" );
	// each node places the next one twice
	std::string nodes;
	for ( int i = 0; i < 60; ++i )
	{
		const std::string next = "<instance_node url=\"#n" + std::to_string( i + 1 ) + "\"/>";
		nodes += "<node id=\"n" + std::to_string( i ) + "\">" + next + next + "</node>";
	}
	refused( "<node id=\"n\">", nodes + "<node id=\"n60\">", "alias_nodes" );
}

TEST_F( ColladaTest, PolygonsOfManyCorners )
{
	const std::string good = collada( "<unit meter=\"1\"/>", "Z_UP", identity_matrix );
	std::string text = replaced( good, "<triangles count=\"4\">", "<polylist count=\"2\">" );
	text = replaced(
	    text, "<p>0 1 2 0 1 3 0 2 3 1 2 3 </p></triangles>", "<vcount>3 4</vcount><p>0 1 2 0 1 2 3</p></polylist>" );
	write( "m.dae", text );
	EXPECT_EQ( load( "m.dae" ).size(), 3u );
	write( "n.dae", replaced( text, "<vcount>3 4", "<vcount>3 4000000" ) );
	expectError( [&] { load( "n.dae" ); }, { "robot.urdf", "n.dae", "7 corners, and polygons for 3" } );
}

/// assimp aborts over fans, strips of lines and skewed nodes.
TEST_F( ColladaTest, FansAndStripsAreUnfolded )
{
	const std::string good = collada( "<unit meter=\"1\"/>", "Z_UP", identity_matrix );
	const std::string input = "<input semantic=\"VERTEX\" source=\"#v\" offset=\"1\"/><p>", end = "</mesh>";
	const auto with = [&]( const std::string& name, const std::string& lists )
	{ return replaced( good, end, "<" + name + " count=\"2\">" + input + lists + "</p></" + name + ">" + end ); };
	write( "fan.dae", with( "trifans", "9 0 9 1 9 2 9 3</p><p>9 1 9 2 9 3" ) );
	EXPECT_EQ( load( "fan.dae" ).size(), 4u + 2 + 1 );
	write( "strip.dae", with( "tristrips", "9 0 9 1 9 2 9 3</p><p>9 1 9 2 9 3" ) );
	EXPECT_EQ( load( "strip.dae" ).size(), 4u + 2 + 1 );
	write( "polygons.dae", with( "polygons", "9 0 9 1 9 2 9 3</p><p>9 1 9 2 9 3" ) );
	EXPECT_EQ( load( "polygons.dae" ).size(), 4u + 2 + 1 );
	write( "triangles.dae", with( "triangles", "9 0 9 1 9 2</p><p>9 1 9 2 9 3" ) );
	EXPECT_EQ( load( "triangles.dae" ).size(), 4u + 1 + 1 );
	write( "lines.dae", with( "linestrips", "9 0 9 1 9 2 9 3</p><p>9 1 9 2 9 3" ) );
	EXPECT_EQ( load( "lines.dae" ).size(), 4u );
	EXPECT_NOTICE( m_model.report.notices, "5 points and lines" );
	write( "odd.dae", with( "trifans", "9 0 9 1 9 2 9" ) );
	expectError( [&] { load( "odd.dae" ); }, { "robot.urdf", "odd.dae", "has 7 indices, 2 for each corner" } );
	write( "few.dae", with( "polygons", "9 0 9 1 9 2" ) );
	expectError( [&] { load( "few.dae" ); }, { "robot.urdf", "few.dae", "has 1 faces of 2" } );
	write( "holes.dae", with( "polygons", "9 0 9 1 9 2</p><ph><p>9 0 9 1 9 2 9 3</p></ph><p>9 1 9 2 9 3" ) );
	expectError( [&] { load( "holes.dae" ); }, { "robot.urdf", "holes.dae", "polygons with holes" } );
	write( "skew.dae", replaced( good, "<matrix>", "<skew>10 1 0 0 0 1 0</skew><matrix>" ) );
	expectError( [&] { load( "skew.dae" ); }, { "robot.urdf", "skew.dae", "export the node with a matrix" } );
}

TEST_F( ColladaTest, NodeWithTheIdOfItsGeometry )
{
	const std::string good = collada( "<unit meter=\"1\"/>", "Z_UP", identity_matrix );
	const std::size_t from = good.find( "<library_geometries>" ), to = good.find( "<library_visual_scenes>" );
	const std::string geometry = good.substr( from, to - from );
	std::string text = replaced( replaced( good, geometry, "" ), "<node id=\"n\">", "<node id=\"g\">" );
	write( "m.dae", replaced( text, "<scene>", geometry + "<scene>" ) );
	EXPECT_EQ( load( "m.dae" ).size(), 4u );
}

TEST_F( ColladaTest, SkinsStandAsTheirGeometryDoes )
{
	const std::string good = collada( "<unit meter=\"1\"/>", "Z_UP", "1 0 0 5 0 1 0 0 0 0 1 0 0 0 0 1" );
	std::string text = replaced( good, "<instance_geometry url=\"#g\"/>", "<instance_controller url=\"#m\"/>" );
	text = replaced( text, "<library_visual_scenes>",
	    "<library_controllers><controller id=\"k\"><skin source=\"#g\"/></controller><controller id=\"m\"><morph source=\"#k\"/>"
	    "</controller></library_controllers><library_visual_scenes>" );
	write( "m.dae", text );
	EXPECT_EQ( load( "m.dae" ).size(), 4u );
	expectBox( { 5, 0, 0 }, { 6, 2, 3 } );
	write( "n.dae", replaced( text, "<skin source=\"#g\"/>", "<skin source=\"#m\"/>" ) );
	expectError( [&] { load( "n.dae" ); }, { "robot.urdf", "n.dae", "the limit nesting is 128" } );
}

TEST_F( ColladaTest, NodesOfALibraryArePlaced )
{
	const std::string good = collada( "<unit meter=\"1\"/>", "Z_UP", identity_matrix );
	const std::string twice = "<node id=\"m\"><translate>10 0 0</translate><instance_node url=\"#l\"/></node><node id=\"k\">"
	                          "<instance_node url=\"#l\"/></node>";
	std::string text = replaced( good, "<node id=\"n\">", twice + "<node id=\"n\">" );
	text = replaced( text, "<library_visual_scenes>",
	    "<library_nodes><node id=\"l\"><instance_geometry url=\"#g\"/></node></library_nodes><library_visual_scenes>" );
	write( "m.dae", text );
	EXPECT_EQ( load( "m.dae" ).size(), 12u );
	expectBox( { 0, 0, 0 }, { 11, 2, 3 } );
}
