// SPDX-License-Identifier: BSD-3-Clause
// Height maps in scenes: ground where the numbers say, solid below, from pictures and texts; damage is refused.
#include "damage.hpp"

#include <octomap/OcTree.h>
#include <png.h>

#include <array>
#include <cmath>
#include <sstream>

using namespace leeway::io;

namespace
{

using Rows = std::vector<std::vector<unsigned>>;

void appendBytes( png_structp png, png_bytep bytes, png_size_t count )
{
	static_cast<std::string*>( png_get_io_ptr( png ) )->append( reinterpret_cast<const char*>( bytes ), count );
}

/// A picture by libpng, the first row on top.
std::string picture( const Rows& rows, int depth, int color = PNG_COLOR_TYPE_GRAY, int interlace = PNG_INTERLACE_NONE )
{
	std::string file;
	png_structp png = png_create_write_struct( PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr );
	png_infop info = png_create_info_struct( png );
	png_set_write_fn( png, &file, appendBytes, nullptr );
	png_set_IHDR( png, info, static_cast<png_uint_32>( rows[0].size() ), static_cast<png_uint_32>( rows.size() ), depth,
	    color, interlace, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT );
	// Gamma must not bend heights
	png_set_gAMA( png, info, 0.45455 );
	std::vector<std::vector<unsigned char>> bytes;
	for ( const std::vector<unsigned>& row : rows )
	{
		bytes.emplace_back();
		for ( unsigned value : row )
		{
			for ( int channel = 0; channel < ( color == PNG_COLOR_TYPE_RGB ? 3 : 1 ); ++channel )
			{
				if ( depth == 16 )
				{
					bytes.back().push_back( static_cast<unsigned char>( value >> 8 ) );
				}
				bytes.back().push_back( static_cast<unsigned char>( value & 255 ) );
			}
		}
	}
	std::vector<unsigned char*> pointers;
	for ( std::vector<unsigned char>& row : bytes )
	{
		pointers.push_back( row.data() );
	}
	png_set_rows( png, info, pointers.data() );
	png_write_png( png, info, PNG_TRANSFORM_IDENTITY, nullptr );
	png_destroy_write_struct( &png, &info );
	return file;
}

class HeightMapTest : public FileTest
{
protected:
	SceneModel load(
	    const std::string& name, const std::string& bytes, const std::string& more = "resolution: 0.5, z_scale: 1" )
	{
		write( name, bytes );
		return loadScene( write( "scene.yaml", "world: {collision_objects: [{id: ground, leeway_shapes: [{type: height_map, "
		                                       "resource: " +
		                                           name + ", " + more + "}]}]}\n" ) );
	}
	void expectBad( const std::string& name, const std::string& bytes, std::vector<std::string> parts,
	    const std::string& more = "resolution: 0.5, z_scale: 1" )
	{
		parts.insert( parts.end(), { "scene.yaml", "leeway_shapes[0]" } );
		expectError( [&] { load( name, bytes, more ); }, parts );
	}
	static const lw_shape* shape( const SceneModel& scene ) { return scene.objects.at( 0 ).shapes.at( 0 ).shape.get(); }
	static lw_shape_info info( const SceneModel& scene ) { return lw_shape_get_info( shape( scene ) ); }
	/// Distance of a ball of this radius to the ground, 0 in contact.
	double distance( const SceneModel& scene, const std::array<double, 3>& p, double radius = 0.01 )
	{
		double dimensions[3] = { radius, 0, 0 };
		lw_shape* raw = nullptr;
		EXPECT_EQ( lw_shape_create_primitive( LW_SHAPE_SPHERE, dimensions, nullptr, nullptr, &raw ), LW_OK );
		leeway::Shape ball = leeway::Shape::adopt( raw );
		lw_query_def def = lw_query_def_default();
		lw_query* raw_query = nullptr;
		EXPECT_EQ( lw_query_create( &def, nullptr, nullptr, nullptr, &raw_query ), LW_OK );
		leeway::Query query( raw_query );
		lw_transform at = lw_transform_identity(), ground = lw_transform_identity();
		std::copy( p.begin(), p.end(), at.t );
		lw_clearance c;
		EXPECT_EQ( lw_shape_distance( shape( scene ), &ground, ball.get(), &at, nullptr, query.get(), &c ), LW_OK );
		return c.upper;
	}
};

} // namespace

TEST_F( HeightMapTest, PicturesOf8And16BitsLieTheRightWayUp )
{
	// Seen from above: the first row is the far one, with the greatest y
	Rows rows = { { 0, 0, 0, 200 }, { 0, 0, 0, 0 }, { 100, 0, 0, 0 } };
	for ( int depth : { 8, 16 } )
	{
		Rows scaled = rows;
		for ( std::vector<unsigned>& row : scaled )
		{
			for ( unsigned& value : row )
			{
				value *= depth == 16 ? 257 : 1;
			}
		}
		SceneModel scene = load( "g.png", picture( scaled, depth ),
		    depth == 8 ? "resolution: 0.5, z_scale: 0.01, origin: [10, 20, 30]"
		               : "resolution: 0.5, z_scale: 3.8910505836575876e-05, "
		                 "origin: [10, 20, 30]" );
		lw_shape_info i = info( scene );
		EXPECT_NEAR( i.box_min[0], 10, 1e-9 );
		EXPECT_NEAR( i.box_max[0], 11.5, 1e-9 );
		EXPECT_NEAR( i.box_min[1], 20, 1e-9 );
		EXPECT_NEAR( i.box_max[1], 21, 1e-9 );
		EXPECT_NEAR( i.box_min[2], 20, 1e-9 ) << "ten metres below the lowest place";
		EXPECT_NEAR( i.box_max[2], 32, 1e-9 );
		EXPECT_NEAR( distance( scene, { 11.5, 21, 33 } ), 0.99, 1e-9 ) << "the far right corner is 2 m high";
		EXPECT_NEAR( distance( scene, { 10, 20, 32 } ), 0.99, 1e-9 ) << "the near left corner is 1 m high";
		EXPECT_NEAR( distance( scene, { 10, 21, 31 } ), 2 / std::sqrt( 5 ) - 0.01, 1e-9 ) << "nothing nearer than its slope";
		EXPECT_TRUE( scene.report.notices.empty() ) << allNotices( scene.report.notices );
	}
}

TEST_F( HeightMapTest, EverythingBelowIsContact )
{
	SeededRng rng;
	std::string text;
	double heights[6][9];
	for ( int y = 5; y >= 0; --y )
	{
		for ( int x = 0; x < 9; ++x )
		{
			heights[y][x] = rng.uniform( -1, 1 );
			char number[40];
			std::snprintf( number, sizeof number, "%.17g%s", heights[y][x],
			    x == 8                     ? "\n"
			    : rng.integer( 0, 1 ) == 0 ? ","
			                               : " ; " );
			text += number;
		}
	}
	SceneModel scene = load( "g.csv", "# heights\n\n" + text, "resolution: 0.5, z_scale: 2, depth: 3" );
	int below = 0;
	for ( int i = 0; i < 2000; ++i )
	{
		std::array<double, 3> p = { rng.uniform( 0.02, 3.98 ), rng.uniform( 0.02, 2.48 ), rng.uniform( -4, 4 ) };
		int x = static_cast<int>( p[0] / 0.5 ), y = static_cast<int>( p[1] / 0.5 );
		double u = p[0] / 0.5 - x, v = p[1] / 0.5 - y;
		double a = heights[y][x], b = heights[y][x + 1], c = heights[y + 1][x + 1], d = heights[y + 1][x];
		// Of the two ways to split the square the one with the higher edge is the upper hull: the greater of both at each
		// place
		double rising = u >= v ? a + u * ( b - a ) + v * ( c - b ) : a + v * ( d - a ) + u * ( c - d );
		double falling = u + v <= 1 ? a + u * ( b - a ) + v * ( d - a ) : c + ( 1 - u ) * ( d - c ) + ( 1 - v ) * ( b - c );
		double ground = 2 * std::fmax( rising, falling );
		if ( p[2] < ground )
		{
			++below;
			EXPECT_EQ( distance( scene, p, 1e-6 ), 0 ) << p[0] << " " << p[1] << " " << p[2] << " under " << ground;
		}
		else
		{
			EXPECT_GT( distance( scene, p, 1e-6 ) + 1e-5, 0 );
			EXPECT_LE( distance( scene, p, 1e-6 ), p[2] - ground + 1e-9 );
		}
	}
	EXPECT_GT( below, 300 );
	EXPECT_EQ( distance( scene, { 2, 1, -3 } ), 0 );
	EXPECT_GT( distance( scene, { -1, 1, -3 } ), 0.98 ) << "beside the map is no ground";
}

TEST_F( HeightMapTest, PlacesWithoutAHeight )
{
	std::string text = "1 1 1 1 1\n1 nan 1 1 1\n1 1 1 1 1\n1 1 1 1 1\n";
	expectBad( "g.txt", text, { "1 places without a height", "unknown: free" } );
	SceneModel open = load( "g.txt", text, "resolution: 1, z_scale: 1, unknown: free" );
	EXPECT_NOTICE( open.report.notices, "1 of 20 places" );
	EXPECT_EQ( distance( open, { 3, 1, 0.5 } ), 0 );
	EXPECT_GT( distance( open, { 1, 2, 0 } ), 0.9 ) << "a hole of four squares around the place";
	EXPECT_LT( distance( open, { 1, 2, 0 } ), 1 ) << "with walls";
	SceneModel shut = load( "g.txt", text + "1 1 3 1 1\n", "resolution: 1, z_scale: 1, unknown: occupied" );
	EXPECT_NEAR( distance( shut, { 1, 3, 4 } ), 0.99, 1e-9 ) << "as high as the highest";
	expectBad( "g.txt", "nan nan\nnan nan\n", { "no heights" }, "resolution: 1, z_scale: 1, unknown: free" );
	expectBad( "g.txt", "nan 1\n1 nan\n", { "no four neighbouring" }, "resolution: 1, z_scale: 1, unknown: free" );
}

TEST_F( HeightMapTest, FlatGroundHasFewTriangles )
{
	std::string row = "0 0 0 0 0 0 0 0 0 0 0\n", text;
	for ( int i = 0; i < 11; ++i )
	{
		text += row;
	}
	lw_shape_info i = info( load( "g.txt", text ) );
	EXPECT_EQ( i.triangle_count, 2u * 100 + 2 * 40 + 40 ) << "top, walls, and a fan for the bottom";
}

TEST_F( HeightMapTest, TextsThatAreNoMap )
{
	Rows rows = { { 1, 2 }, { 3, 4 } };
	expectBad( "g.png", picture( rows, 8, PNG_COLOR_TYPE_RGB ), { "g.png", "not grey" } );
	expectBad( "g.png", picture( rows, 8, PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_ADAM7 ), { "interlaced" } );
	expectBad( "g.png", "hello", { "g.png", "no height map" } );
	expectBad( "g.png", picture( { { 1, 2 } }, 8 ), { "2 x 1 heights", "2 x 2" } );
	expectBad( "g.csv", "1,2\n3\n", { "g.csv", "line 2", "1 numbers, not 2" } );
	expectBad( "g.csv", "1,2\n3,x\n", { "line 2", "\"x\" is no height" } );
	expectBad( "g.csv", "1,2\n3,inf\n", { "line 2", "\"inf\" is no height" } );
	expectBad( "g.csv", "1,2\n", { "2 x 1 heights" } );
	expectBad( "g.csv", "1 2\n3 4\n", { "resolution", "missing" }, "z_scale: 1" );
	expectBad( "g.csv", "1 2\n3 4\n", { "z_scale", "missing" }, "resolution: 1" );
	expectBad( "g.csv", "1 2\n3 4\n", { "resolution", "-1 is not above 0" }, "resolution: -1, z_scale: 1" );
	expectBad( "g.csv", "1 2\n3 4\n", { "depth", "0 is not above 0" }, "resolution: 1, z_scale: 1, depth: 0" );
	expectBad( "g.csv", "1 2\n3 4\n", { "origin" }, "resolution: 1, z_scale: 1, origin: [1, 2]" );
	expectBad( "g.csv", "1 2\n3 4\n", { "scale", "not known" }, "resolution: 1, z_scale: 1, scale: 3" );
	expectBad( "g.csv", "1 1e300\n3 4\n", { "g.csv" }, "resolution: 1, z_scale: 1" );
}

TEST_F( HeightMapTest, CutAndFlipped )
{
	SeededRng rng;
	Rows rows( 40, std::vector<unsigned>( 50 ) );
	for ( std::vector<unsigned>& row : rows )
	{
		for ( unsigned& value : row )
		{
			value = static_cast<unsigned>( rng.integer( 0, 65535 ) );
		}
	}
	std::string bytes = picture( rows, 16 );
	auto read = [&]( const std::string& damaged ) { load( "g.png", damaged ); };
	expectCutsRefused( read, bytes, bytes.size() );
	EXPECT_GT( tryFlippedBits( read, bytes ).refused, 60 ) << "every chunk has a checksum";
	// A header that promises the largest picture there may be, and no data
	std::string huge = picture( { { 1, 2 }, { 3, 4 } }, 8 );
	huge.replace( 16, 8, std::string( "\0\0\x80\0\0\0\x80\0", 8 ) );
	expectBad( "g.png", huge, { "g.png" } );
}

TEST_F( HeightMapTest, TheExampleOfTheScenesPageLoads )
{
	std::ifstream page( LEEWAY_SCENES_PAGE );
	std::string text( std::istreambuf_iterator<char>( page ), {} );
	std::size_t first = text.find( "```yaml\n" ) + 8;
	ASSERT_LT( first, text.size() );
	write( "scene.yaml", text.substr( first, text.find( "```", first ) - first ) );
	std::string shape = "<collision><geometry><sphere radius=\"0.1\"/></geometry></collision></link>";
	auto pair = [&]( const std::string& a, const std::string& b, const std::string& joint )
	{
		return "<robot name=\"r\"><link name=\"" + a + "\">" + shape + "<link name=\"" + b + "\">" + shape +
		       "<joint name=\"" + joint + "\" type=\"continuous\"><parent link=\"" + a + "\"/><child link=\"" + b +
		       "\"/></joint></robot>";
	};
	write( "kitchen/kitchen.urdf", pair( "body", "door", "fridge_door" ) );
	write( "workshop/vice.stl",
	    "solid vice\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 0 9 0\nvertex 9 0 0\n"
	    "endloop\nendfacet\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 9 0 0\nvertex 0 0 9\n"
	    "endloop\nendfacet\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 0 0 9\nvertex 0 9 0\n"
	    "endloop\nendfacet\nfacet normal 0 0 0\nouter loop\nvertex 9 0 0\nvertex 0 9 0\nvertex 0 0 9\n"
	    "endloop\nendfacet\nendsolid vice\n" );
	write( "shelf.pcd", "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS 1\nDATA ascii\n1 2 3\n" );
	write( "yard.png", picture( { { 1, 2 }, { 3, 4 } }, 16 ) );
	octomap::OcTree tree( 0.1 );
	tree.updateNode( 0.05, 0.05, 0.05, true );
	std::ostringstream map;
	tree.writeBinaryConst( map );
	write( "room.bt", map.str() );
	RobotModel robot = loadRobot( write( "r.urdf", pair( "hand", "finger", "elbow" ) ), "" );
	SceneModel scene = loadScene( path( "scene.yaml" ) );
	EXPECT_TRUE( scene.report.notices.empty() ) << allNotices( scene.report.notices );
	EXPECT_EQ( scene.objects.size(), 5u );
	EXPECT_EQ( scene.objects.at( 2 ).shapes.size(), 4u );
	EXPECT_EQ( scene.attached.size(), 1u );
	ProblemOptions options;
	options.scene = &scene;
	EXPECT_NO_THROW( buildProblem( robot, options ) );
}
