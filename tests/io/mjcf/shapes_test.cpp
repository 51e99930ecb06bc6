// SPDX-License-Identifier: BSD-3-Clause
// MJCF: shapes of geoms: sizes, fromto, hulls of meshes, height fields, ellipsoids.
#include "mjcf/mjcf_files.hpp"

#include <cstring>
#include <png.h>

using namespace leeway::io;

namespace
{

class MjcfShapes : public MjcfTest
{
protected:
	/// The shapes of the world.
	std::vector<PlacedShape> shapes(
	    const std::string& geoms, const std::string& before = "", const LoadOptions& options = {} ) const
	{
		return load( before + "<worldbody>" + geoms + "</worldbody>", options ).links.at( 0 ).collision;
	}
};

/// Distance of the farthest vertex along a direction.
double reach( const PlacedShape& placed, double x, double y, double z )
{
	const lw_shape_info info = lw_shape_get_info( placed.shape.get() );
	const double* v = lw_shape_vertices( placed.shape.get() );
	double most = -HUGE_VAL;
	for ( std::uint32_t i = 0; i < info.vertex_count; ++i )
	{
		const lw_vec3 p = lw_transform_point( &placed.pose, { v[3 * i], v[3 * i + 1], v[3 * i + 2] } );
		most = std::max( most, x * p.x + y * p.y + z * p.z );
	}
	return most;
}

void append( std::string& bytes, std::uint32_t word )
{
	bytes.append( reinterpret_cast<const char*>( &word ), 4 );
}

void append( std::string& bytes, float value )
{
	bytes.append( reinterpret_cast<const char*>( &value ), 4 );
}

} // namespace

TEST_F( MjcfShapes, SizesAreHalfEdges )
{
	const std::vector<PlacedShape> all =
	    shapes( "<geom type=\"box\" size=\"1 2 3\"/><geom size=\"4\" pos=\"1 2 3\"/><geom type=\"capsule\" size=\"0.5 2\"/>"
	            "<geom type=\"cylinder\" size=\"0.6 3\"/>" );
	const lw_shape_type types[4] = { LW_SHAPE_BOX, LW_SHAPE_SPHERE, LW_SHAPE_CAPSULE, LW_SHAPE_CYLINDER };
	const double dimensions[4][3] = { { 2, 4, 6 }, { 4, 0, 0 }, { 0.5, 4, 0 }, { 0.6, 6, 0 } };
	ASSERT_EQ( all.size(), 4u );
	for ( std::size_t i = 0; i < 4; ++i )
	{
		const lw_shape_info info = lw_shape_get_info( all[i].shape.get() );
		EXPECT_EQ( info.type, types[i] );
		for ( std::size_t k = 0; k < ( i == 0 ? 3u : i == 1 ? 1u : 2u ); ++k )
		{
			EXPECT_DOUBLE_EQ( info.dimensions[k], dimensions[i][k] ) << i << " " << k;
		}
	}
	expectPoint( all[1].pose, 1, 2, 3 );
}

TEST_F( MjcfShapes, FromtoGivesLengthPlaceAndAxis )
{
	const std::vector<PlacedShape> all = shapes(
	    "<geom type=\"capsule\" size=\"0.1\" fromto=\"1 0 0 1 4 0\"/><geom type=\"box\" size=\"0.1\" fromto=\"0 0 0 0 0 6\"/>" );
	const lw_shape_info capsule = lw_shape_get_info( all.at( 0 ).shape.get() ),
	                    box = lw_shape_get_info( all.at( 1 ).shape.get() );
	EXPECT_DOUBLE_EQ( capsule.dimensions[1], 4 );
	expectPoint( all[0].pose, 1, 2, 0 );
	EXPECT_NEAR( all[0].pose.r[1][2], -1, 1e-15 ) << "z goes from the second point to the first";
	EXPECT_DOUBLE_EQ( box.dimensions[0], 0.2 );
	EXPECT_DOUBLE_EQ( box.dimensions[2], 6 );
}

TEST_F( MjcfShapes, MeshIsItsConvexHullAndSolid )
{
	// a U: its hull fills the notch between the arms
	write( "meshes/u.obj",
	    "v 0 0 0\nv 3 0 0\nv 3 2 0\nv 2 2 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nv 0 0 1\nv 3 0 1\nv 3 2 1\nv 2 2 1\nv 2 1 1\nv 1 1 1\nv 1 2 1\n"
	    "v 0 2 1\nf 1 2 3 4 5 6 7 8\nf 9 10 11 12 13 14 15 16\n" );
	const std::vector<PlacedShape> all =
	    shapes( "<geom type=\"mesh\" mesh=\"u\"/><geom type=\"mesh\" mesh=\"u\" pos=\"9 0 0\"/>",
	        "<compiler meshdir=\"meshes\"/><asset><mesh file=\"u.obj\" scale=\"2 1 1\"/></asset>" );
	ASSERT_EQ( all.size(), 2u );
	const lw_shape_info info = lw_shape_get_info( all[0].shape.get() );
	EXPECT_TRUE( info.solid );
	EXPECT_EQ( info.vertex_count, 8u );
	EXPECT_EQ( info.triangle_count, 12u );
	EXPECT_NEAR( reach( all[0], 1, 0, 0 ), 6, 1e-12 );
	EXPECT_EQ( all[0].shape.get(), all[1].shape.get() ) << "two geoms of one asset share a shape";
}

TEST_F( MjcfShapes, ReferencePoseOfAMeshIsTakenAway )
{
	const std::string corners = "0 0 0  1 0 0  0 2 0  0 0 3";
	const PlacedShape moved = shapes( "<geom type=\"mesh\" mesh=\"t\"/>",
	    "<asset><mesh name=\"t\" vertex=\"" + corners + "\" refpos=\"1 0 0\" refquat=\"1 0 0 1\"/></asset>" )
	                              .at( 0 );
	// (x - 1, y, z), then turned by -90 degrees about z: (y, 1 - x, z)
	EXPECT_NEAR( reach( moved, 1, 0, 0 ), 2, 1e-12 );
	EXPECT_NEAR( reach( moved, 0, 1, 0 ), 1, 1e-12 );
	EXPECT_NEAR( reach( moved, 0, 0, 1 ), 3, 1e-12 );
}

TEST_F( MjcfShapes, BinaryMeshOfMuJoCo )
{
	std::string bytes;
	for ( std::uint32_t count : { 4u, 0u, 0u, 0u } )
	{
		append( bytes, count );
	}
	for ( float value : { 0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f } )
	{
		append( bytes, value );
	}
	write( "t.msh", bytes );
	EXPECT_EQ(
	    lw_shape_get_info(
	        shapes( "<geom type=\"mesh\" mesh=\"t\"/>", "<asset><mesh file=\"t.msh\"/></asset>" ).at( 0 ).shape.get() )
	        .triangle_count,
	    4u );
	write( "t.msh", bytes + "1234" );
	expectBad( "<asset><mesh file=\"t.msh\"/></asset><worldbody><geom type=\"mesh\" mesh=\"t\"/></worldbody>",
	    { "mesh t (line 2)", "its header says 64" } );
}

TEST_F( MjcfShapes, EllipsoidIsContained )
{
	const PlacedShape e = shapes( "<geom type=\"ellipsoid\" size=\"1 2 3\"/>" ).at( 0 );
	for ( double a = 0; a < 6.3; a += 0.1 )
	{
		const double x = std::cos( a ), y = std::sin( a ) * 0.6, z = std::sin( a ) * 0.8,
		             support = std::hypot( x, 2 * y, 3 * z );
		EXPECT_GE( reach( e, x, y, z ), support );
		EXPECT_LE( reach( e, x, y, z ), 1.01 * support );
	}
	EXPECT_EQ( lw_shape_get_info( shapes( "<geom type=\"ellipsoid\" size=\"2 2 2\"/>" ).at( 0 ).shape.get() ).type,
	    LW_SHAPE_SPHERE );
}

TEST_F( MjcfShapes, HeightFieldStandsOnItsBase )
{
	const std::string field =
	    "<asset><hfield name=\"h\" nrow=\"2\" ncol=\"3\" size=\"1 2 3 0.5\" elevation=\"10 12 14  16 18 20\"/></asset>";
	const PlacedShape h = shapes( "<geom type=\"hfield\" hfield=\"h\" pos=\"0 0 1\"/>", field ).at( 0 );
	EXPECT_TRUE( lw_shape_get_info( h.shape.get() ).solid );
	EXPECT_NEAR( reach( h, 0, 0, 1 ), 4, 1e-12 );
	EXPECT_NEAR( reach( h, 0, 0, -1 ), -0.5, 1e-12 );
	// the first row of the file is that of the greatest y: highest at x = 1, y = -2
	EXPECT_NEAR( reach( h, 1, -1, 1 ), 1 + 2 + 4, 1e-12 );
	EXPECT_LT( reach( h, 1, 1, 1 ), 1 + 2 + 4 - 0.5 );
}

TEST_F( MjcfShapes, HeightFieldOfABinaryFile )
{
	std::string bytes;
	append( bytes, 2u );
	append( bytes, 2u );
	for ( float height : { 0.f, 1.f, 1.f, 3.f } )
	{
		append( bytes, height );
	}
	write( "h.bin", bytes );
	const std::string text = "<asset><hfield file=\"h.bin\" size=\"1 1 2 1\"/></asset>";
	const PlacedShape h = shapes( "<geom type=\"hfield\" hfield=\"h\"/>", text ).at( 0 );
	EXPECT_NEAR( reach( h, 1, 1, 1 ), 4, 1e-12 ) << "rows of a file begin at the least y";
	write( "h.bin", bytes.substr( 0, 20 ) );
	expectBad( text + "<worldbody><geom type=\"hfield\" hfield=\"h\"/></worldbody>",
	    { "hfield h (line 2)", "no height field of 2 rows" } );
}

// Heights of MuJoCo 4.0.0 for such pictures: the red channel, whatever the others are.
TEST_F( MjcfShapes, HeightFieldOfAColourPictureHasOtherHeights )
{
	const unsigned char pixels[] = { 0, 50, 60, 0, 0, 7, 8, 100, 100, 9, 9, 255, 255, 0, 1, 3 };
	png_image image = {};
	image.version = PNG_IMAGE_VERSION;
	image.width = image.height = 2;
	image.format = PNG_FORMAT_RGBA;
	std::string file( PNG_IMAGE_PNG_SIZE_MAX( image ), '\0' );
	png_alloc_size_t size = file.size();
	ASSERT_NE( png_image_write_to_memory( &image, file.data(), &size, 0, pixels, 0, nullptr ), 0 );
	write( "h.png", file.substr( 0, size ) );
	const PlacedShape h =
	    shapes( "<geom type=\"hfield\" hfield=\"h\"/>", "<asset><hfield file=\"h.png\" size=\"1 1 2 1\"/></asset>" ).at( 0 );
	EXPECT_NEAR( reach( h, 1, -1, 1 ), 1 + 1 + 2, 1e-12 ) << "255: the last pixel is at the greatest x and the least y";
	EXPECT_NEAR( reach( h, -1, -1, 1 ), 1 + 1 + 2 * 100.0 / 255, 1e-12 );
}

TEST_F( MjcfShapes, GeomsThatCollideWithNothingAreLeftOutAndNamed )
{
	const std::string text =
	    "<worldbody><body name=\"a\"><geom size=\"1\" contype=\"0\" conaffinity=\"0\"/></body><body name=\"b\"><geom size=\"1\"/><geom size=\"2\" "
	    "contype=\"0\" conaffinity=\"0\"/></body></worldbody>";
	const RobotModel plain = load( text );
	EXPECT_TRUE( plain.links.at( 1 ).collision.empty() );
	EXPECT_EQ( plain.links.at( 2 ).collision.size(), 1u );
	EXPECT_NOTICE( plain.report.notices, "are not checked: a" );
	LoadOptions options;
	options.use_visual = true;
	EXPECT_EQ( load( text, options ).links.at( 1 ).collision.size(), 1u );
}

TEST_F( MjcfShapes, LinksWithoutTheColourOfTheirGeoms )
{
	const auto body = [&]( const std::string& name, const std::string& geoms )
	{ return "<body name=\"" + name + "\" childclass=\"c\">" + geoms + "<joint/></body>"; };
	const std::string seen = " contype=\"0\" conaffinity=\"0\"";
	const RobotModel model = load(
	    "<default><geom size=\"0.1\"/><material rgba=\"0 0 1 0.5\"/><default class=\"c\"/><default class=\"red\">"
	    "<geom rgba=\"1 0 0 1\"/></default></default><asset><material name=\"moss\" rgba=\"0 0.5 0 1\"/><material name=\"sky\"/>"
	    "<material name=\"photo\" texture=\"t\" rgba=\"1 1 0 1\"/></asset><worldbody>" +
	    body( "own", "<geom/><geom rgba=\"0.1 0.2 0.3 1\" material=\"moss\"/>" ) +
	    body( "classed", "<geom class=\"red\"/>" ) + body( "named", "<geom material=\"moss\"/>" ) +
	    body( "of_default", "<geom material=\"sky\"/>" ) + body( "textured", "<geom material=\"photo\"/>" ) +
	    body( "gone", "<geom material=\"none\"/>" ) + body( "wrong", "<geom rgba=\"1 0 7 1\"/>" ) +
	    body( "short", "<geom rgba=\"1 0 0\"/>" ) +
	    body( "visual", "<geom rgba=\"1 1 1 1\"/><geom rgba=\"0 0 0 1\"" + seen + "/>" ) + body( "plain", "<geom/>" ) +
	    "</worldbody>" );
	std::map<std::string, std::optional<Colour>> found;
	for ( const LinkModel& link : model.links )
	{
		found[link.name] = link.colour;
	}
	const auto is = []( double r, double g, double b, double a ) { return std::optional<Colour>( { r, g, b, a } ); };
	EXPECT_EQ( found.at( "own" ), is( 0.1, 0.2, 0.3, 1 ) );
	EXPECT_EQ( found.at( "classed" ), is( 1, 0, 0, 1 ) );
	EXPECT_EQ( found.at( "named" ), is( 0, 0.5, 0, 1 ) );
	EXPECT_EQ( found.at( "of_default" ), is( 0, 0, 1, 0.5 ) );
	EXPECT_EQ( found.at( "visual" ), is( 0, 0, 0, 1 ) );
	for ( const char* none : { "textured", "gone", "wrong", "short", "plain" } )
	{
		EXPECT_EQ( found.at( none ), std::nullopt ) << none;
	}
}
