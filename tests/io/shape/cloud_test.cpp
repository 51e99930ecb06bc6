// SPDX-License-Identifier: BSD-3-Clause
// Point clouds in scenes: every spelling of PCD and PLY gives the same points; damage is refused, never read as fewer.
#include "damage.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

extern "C"
{
#include <liblzf/lzf.h>
}

using namespace leeway::io;

namespace
{

using Points = std::vector<std::array<double, 3>>;

struct PcdField
{
	std::string name;
	char type;
	int size;
	int count;
};

template <typename T> std::string bytesOf( T value, bool big_endian = false )
{
	std::string bytes( reinterpret_cast<const char*>( &value ), sizeof value );
	if ( big_endian )
	{
		std::reverse( bytes.begin(), bytes.end() );
	}
	return bytes;
}

std::string encode( const PcdField& field, double value )
{
	switch ( field.type )
	{
	case 'F':
		return field.size == 4 ? bytesOf( static_cast<float>( value ) ) : bytesOf( value );
	case 'I':
		return field.size == 1   ? bytesOf( static_cast<std::int8_t>( value ) )
		       : field.size == 2 ? bytesOf( static_cast<std::int16_t>( value ) )
		       : field.size == 4 ? bytesOf( static_cast<std::int32_t>( value ) )
		                         : bytesOf( static_cast<std::int64_t>( value ) );
	default:
		return field.size == 1   ? bytesOf( static_cast<std::uint8_t>( value ) )
		       : field.size == 2 ? bytesOf( static_cast<std::uint16_t>( value ) )
		       : field.size == 4 ? bytesOf( static_cast<std::uint32_t>( value ) )
		                         : bytesOf( static_cast<std::uint64_t>( value ) );
	}
}

/// The value of one of a point's fields; others than x, y, z hold something that is no coordinate.
double fieldValue( const PcdField& field, const std::array<double, 3>& point )
{
	return field.name == "x" ? point[0] : field.name == "y" ? point[1] : field.name == "z" ? point[2] : 77;
}

std::string pcdHeader( const std::vector<PcdField>& fields, std::size_t width, std::size_t height, const std::string& data )
{
	std::string names, types, sizes, counts;
	for ( const PcdField& field : fields )
	{
		names += " " + field.name;
		types += std::string( " " ) + field.type;
		sizes += " " + std::to_string( field.size );
		counts += " " + std::to_string( field.count );
	}
	return "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS" + names + "\nSIZE" + sizes + "\nTYPE" + types +
	       "\nCOUNT" + counts + "\nWIDTH " + std::to_string( width ) + "\nHEIGHT " + std::to_string( height ) +
	       "\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + std::to_string( width * height ) + "\nDATA " + data + "\n";
}

std::string packed( const std::string& data )
{
	std::string out( data.size() * 2 + 64, '\0' );
	unsigned size =
	    lzf_compress( data.data(), static_cast<unsigned>( data.size() ), out.data(), static_cast<unsigned>( out.size() ) );
	return bytesOf( static_cast<std::uint32_t>( size ) ) + bytesOf( static_cast<std::uint32_t>( data.size() ) ) +
	       out.substr( 0, size );
}

std::string pcd( const std::vector<PcdField>& fields, const Points& points, const std::string& format )
{
	std::string data;
	if ( format == "binary_compressed" )
	{
		for ( const PcdField& field : fields )
		{
			for ( const std::array<double, 3>& point : points )
			{
				for ( int i = 0; i < field.count; ++i )
				{
					data += encode( field, fieldValue( field, point ) );
				}
			}
		}
		return pcdHeader( fields, points.size(), 1, format ) + packed( data );
	}
	for ( const std::array<double, 3>& point : points )
	{
		for ( const PcdField& field : fields )
		{
			for ( int i = 0; i < field.count; ++i )
			{
				char text[64];
				std::snprintf( text, sizeof text, "%.17g ", fieldValue( field, point ) );
				data += format == "ascii" ? std::string( text ) : encode( field, fieldValue( field, point ) );
			}
		}
		data += format == "ascii" ? "\n" : "";
	}
	return pcdHeader( fields, points.size(), 1, format ) + data;
}

const std::vector<PcdField> plain = { { "x", 'F', 4, 1 }, { "y", 'F', 4, 1 }, { "z", 'F', 4, 1 } };

/// @param type of the coordinates: "float" or "double"
std::string ply( const Points& points, const std::string& format, const std::string& type = "float" )
{
	// x, y, z in another order, among other properties, after another element
	std::string text =
	    "ply\nformat " + format +
	    " 1.0\ncomment of no use\nelement camera 2\nproperty list uchar short rays\nproperty uchar id\nelement vertex " +
	    std::to_string( points.size() ) + "\nproperty uchar red\nproperty " + type + " z\nproperty " + type +
	    " x\nproperty list ushort int near\nproperty " + type + " y\nend_header\n";
	if ( format == "ascii" )
	{
		text += "2 5 6 1\n0 2\n";
		for ( const auto& p : points )
		{
			char line[128];
			std::snprintf( line, sizeof line, "200 %.17g %.17g 1 -5 %.17g\n", p[2], p[0], p[1] );
			text += line;
		}
		return text;
	}
	bool big = format == "binary_big_endian";
	auto coordinate = [&]( double v )
	{ return type == "float" ? bytesOf( static_cast<float>( v ), big ) : bytesOf( v, big ); };
	text += bytesOf( std::uint8_t{ 2 } ) + bytesOf( std::int16_t{ 5 }, big ) + bytesOf( std::int16_t{ 6 }, big ) + "\1";
	text += std::string( 1, '\0' ) + "\2";
	for ( const auto& p : points )
	{
		text += "\xc8" + coordinate( p[2] ) + coordinate( p[0] ) + bytesOf( std::uint16_t{ 1 }, big ) +
		        bytesOf( std::int32_t{ -5 }, big ) + coordinate( p[1] );
	}
	return text;
}

class CloudTest : public FileTest
{
protected:
	SceneModel load( const std::string& name, const std::string& bytes, const std::string& more = "radius: 0.01" )
	{
		write( name, bytes );
		return loadScene( write( "scene.yaml", "world: {collision_objects: [{id: scan, leeway_shapes: [{type: point_cloud, "
		                                       "resource: " +
		                                           name + ", " + more + "}]}]}\n" ) );
	}
	static Points pointsOf( const SceneModel& scene )
	{
		const lw_shape* shape = scene.objects.at( 0 ).shapes.at( 0 ).shape.get();
		const double* v = lw_shape_vertices( shape );
		Points points;
		for ( std::uint32_t i = 0; i < lw_shape_get_info( shape ).vertex_count; ++i )
		{
			points.push_back( { v[3 * i], v[3 * i + 1], v[3 * i + 2] } );
		}
		std::sort( points.begin(), points.end() );
		return points;
	}
	void expectBad( const std::string& name, const std::string& bytes, std::vector<std::string> parts )
	{
		parts.insert( parts.end(), { "scene.yaml", "leeway_shapes[0]", name } );
		expectError( [&] { load( name, bytes ); }, parts );
	}
	/// Coordinates that every number type can hold.
	static Points integers( SeededRng& rng, std::size_t count )
	{
		Points points;
		for ( std::size_t i = 0; i < count; ++i )
		{
			points.push_back( { double( rng.integer( 0, 100 ) ), double( rng.integer( 0, 100 ) ), double( i ) } );
		}
		std::sort( points.begin(), points.end() );
		return points;
	}
};

const double not_a_number = std::numeric_limits<double>::quiet_NaN();

} // namespace

TEST_F( CloudTest, PcdFieldsOfAnyOrderAndType )
{
	SeededRng rng;
	const std::pair<char, int> kinds[] = { { 'F', 4 }, { 'F', 8 }, { 'I', 1 }, { 'I', 2 }, { 'I', 4 }, { 'I', 8 },
	    { 'U', 1 }, { 'U', 2 }, { 'U', 4 }, { 'U', 8 } };
	for ( int round = 0; round < 60; ++round )
	{
		std::vector<PcdField> fields;
		for ( const char* name : { "x", "y", "z", "rgb", "_", "descriptor" } )
		{
			auto [type, size] = kinds[rng.integer( 0, 9 )];
			bool coordinate = std::strlen( name ) == 1 && name[0] != '_';
			if ( coordinate || rng.integer( 0, 1 ) == 0 )
			{
				fields.push_back( { name, type, size, coordinate ? 1 : rng.integer( 1, 5 ) } );
			}
		}
		std::shuffle( fields.begin(), fields.end(), rng.engine() );
		Points points = integers( rng, static_cast<std::size_t>( rng.integer( 1, 100 ) ) );
		for ( const char* format : { "ascii", "binary", "binary_compressed" } )
		{
			SCOPED_TRACE( pcdHeader( fields, 1, 1, format ) );
			SceneModel scene = load( "scan.pcd", pcd( fields, points, format ) );
			EXPECT_EQ( pointsOf( scene ), points );
			EXPECT_TRUE( scene.report.notices.empty() ) << allNotices( scene.report.notices );
		}
	}
}

TEST_F( CloudTest, PcdAsPclDocumentsIt )
{
	// The example of PCL's documentation of the format, without its colours' meaning
	SceneModel scene =
	    load( "a.pcd", "# .PCD v.7 - Point Cloud Data file format\nVERSION .7\nFIELDS x y z rgb\nSIZE 4 4 4 4\n"
	                   "TYPE F F F F\nCOUNT 1 1 1 1\nWIDTH 3\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 3\n"
	                   "DATA ascii\n0.93773 0.33763 0 4.2108e+06\n0.90805 0.35641 0 4.2108e+06\n0.81915 0.32 0 "
	                   "4.2108e+06\n" );
	EXPECT_EQ( pointsOf( scene ), ( Points{ { 0.81915, 0.32, 0 }, { 0.90805, 0.35641, 0 }, { 0.93773, 0.33763, 0 } } ) );
	const LoadedShape& line = scene.report.shapes.at( 0 );
	EXPECT_EQ( line.source, "point cloud a.pcd, 3 points of radius 0.01" );
	EXPECT_EQ( line.file, path( "a.pcd" ) );
	EXPECT_EQ( line.owner, "scan" );
}

TEST_F( CloudTest, PcdOfDosAndOfOldVersions )
{
	EXPECT_EQ( pointsOf( load( "a.pcd", "VERSION .5\r\nCOLUMNS x y z\r\nSIZE 4 4 4\r\nTYPE F F F\r\nPOINTS 1\r\nDATA "
	                                    "ascii\r\n1 2 3\r\n\r\n" ) ),
	    ( Points{ { 1, 2, 3 } } ) );
	EXPECT_EQ( pointsOf( load( "a.pcd", pcd( plain, { { 1, 2, 3 } }, "binary" ) + std::string( 4000, '\0' ) ) ),
	    ( Points{ { 1, 2, 3 } } ) )
	    << "zeros to the end of a page are no points";
	SceneModel seen =
	    load( "a.pcd", "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS 1\nVIEWPOINT 0 0 1 1 0 0 0\nDATA ascii\n1 2 "
	                   "3\n" );
	EXPECT_NOTICE( seen.report.notices, "VIEWPOINT is not applied" );
}

TEST_F( CloudTest, PointsThatAreNotFiniteAreCounted )
{
	const double infinity = std::numeric_limits<double>::infinity();
	Points points = {
	    { 1, 2, 3 }, { not_a_number, 0, 0 }, { 4, 5, 6 }, { 0, not_a_number, 0 }, { 0, 0, infinity }, { 0, -infinity, 0 } };
	for ( const char* format : { "ascii", "binary", "binary_compressed" } )
	{
		SceneModel scene = load( "a.pcd", pcd( plain, points, format ) );
		EXPECT_EQ( pointsOf( scene ), ( Points{ { 1, 2, 3 }, { 4, 5, 6 } } ) );
		EXPECT_NOTICE( scene.report.notices, "4 of 6 points" );
	}
	for ( const char* format : { "ascii", "binary_little_endian", "binary_big_endian" } )
	{
		SceneModel scene = load( "a.ply", ply( points, format ) );
		EXPECT_EQ( pointsOf( scene ), ( Points{ { 1, 2, 3 }, { 4, 5, 6 } } ) );
		EXPECT_NOTICE( scene.report.notices, "4 of 6 points" );
	}
	expectBad( "a.pcd", pcd( plain, { { not_a_number, not_a_number, not_a_number } }, "binary" ),
	    { "none of its 1 points is finite" } );
}

TEST_F( CloudTest, PlyInEveryFormat )
{
	SeededRng rng;
	Points points = integers( rng, 500 );
	for ( const char* format : { "ascii", "binary_little_endian", "binary_big_endian" } )
	{
		for ( const char* type : { "float", "double" } )
		{
			SceneModel scene = load( "scan.PLY", ply( points, format, type ) );
			EXPECT_EQ( pointsOf( scene ), points );
			EXPECT_NOTICE( scene.report.notices, "its 2 elements camera are no points" );
		}
	}
}

TEST_F( CloudTest, PlyWithFacesIsAMesh )
{
	std::string mesh =
	    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement "
	    "face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
	expectBad( "m.ply", mesh, { "element face", "mesh", "meshes" } );
	SceneModel scene = loadScene( write( "scene.yaml",
	    "world: {collision_objects: [{id: a, pose: {position: [0, 0, 0]}, meshes: [{resource: m.ply}]}]}\n" ) );
	EXPECT_EQ( lw_shape_get_info( scene.objects.at( 0 ).shapes.at( 0 ).shape.get() ).triangle_count, 1u );
	// The other way round: a cloud is no mesh
	write( "c.ply", ply( { { 1, 2, 3 } }, "ascii" ) );
	expectError(
	    [&]
	    {
		    loadScene( write( "scene.yaml",
		        "world: {collision_objects: [{id: a, pose: {position: [0, 0, 0]}, meshes: [{resource: c.ply}]}]}\n" ) );
	    },
	    { "scene.yaml", "c.ply" } );
}

TEST_F( CloudTest, PosesAndRadius )
{
	write( "a.pcd", pcd( plain, { { 1, 2, 3 } }, "binary" ) );
	SceneModel scene = loadScene( write( "scene.yaml",
	    "world: {collision_objects: [{id: scan, header: {frame_id: camera}, pose: {position: [10, 0, 0]}, leeway_shapes: "
	    "[{type: point_cloud, resource: a.pcd, radius: 0.25, pose: {position: [0, 20, 0]}}, {type: POINT_CLOUD, resource: "
	    "a.pcd, radius: 0}]}]}\n" ) );
	const SceneObject& object = scene.objects.at( 0 );
	EXPECT_EQ( object.frame, "camera" );
	expectPoint( object.shapes.at( 0 ).pose, 10, 20, 0 );
	expectPoint( object.shapes.at( 1 ).pose, 10, 0, 0 );
	EXPECT_DOUBLE_EQ( lw_shape_get_info( object.shapes[0].shape.get() ).dimensions[0], 0.25 );
	EXPECT_DOUBLE_EQ( lw_shape_get_info( object.shapes[1].shape.get() ).dimensions[0], 0 );
}

// An error is one line of text: bytes of a file that is none must not get into it.
TEST_F( CloudTest, AHeaderThatIsNoTextIsNotRepeated )
{
	expectError( [&] { load( "a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty fl\x1b[2J x\nend_header\n" ); },
	    { "a.ply", "header line 4", "is no text" } );
	expectError(
	    [&] { load( "a.pcd", "# a comment\n\nFIE\x1b[2JLDS x y z\n" ); }, { "a.pcd", "header line 3", "is no text" } );
}

TEST_F( CloudTest, KeysThatTheSceneMustHave )
{
	std::string good = pcd( plain, { { 1, 2, 3 } }, "binary" );
	expectError( [&] { load( "a.pcd", good, "radius: -0.1" ); }, { "scene.yaml", "radius", "-0.1 is negative" } );
	expectError( [&] { load( "a.pcd", good, "pose: {position: [0, 0, 0]}" ); }, { "radius", "missing" } );
	expectError( [&] { load( "a.pcd", good, "radius: 0.1, raduis: 3" ); }, { "raduis", "not known" } );
	expectError( [&] { load( "a.xyz", good ); }, { "a.xyz", "no point cloud", ".pcd or .ply" } );
	std::filesystem::remove( path( "a.pcd" ) );
	expectError(
	    [&]
	    {
		    loadScene( write( "s.yaml", "world: {collision_objects: [{id: scan, leeway_shapes: [{type: point_cloud, "
		                                "resource: 'package://maps/a.pcd', radius: 0}]}]}\n" ) );
	    },
	    { "s.yaml", "scan.leeway_shapes[0]", "point cloud package://maps/a.pcd was not found, tried",
	        path( "maps/a.pcd" ) } );
	expectError( [&]
	    { loadScene( write( "s.yaml", "world: {collision_objects: [{id: scan, leeway_shapes: [{type: fog}]}]}\n" ) ); },
	    { "s.yaml", "type", "fog is not known" } );
	expectError( [&] { loadScene( write( "s.yaml", "world: {collision_objects: [{id: scan, leeway_shape: [{}]}]}\n" ) ); },
	    { "s.yaml", "leeway_shape", "is leeway_shapes meant?" } );
}

TEST_F( CloudTest, PcdHeadersThatLie )
{
	auto with = [&]( const std::string& from, const std::string& to, const char* format = "binary" )
	{
		std::string text = pcd( plain, { { 1, 2, 3 }, { 4, 5, 6 } }, format );
		std::size_t at = text.find( from );
		EXPECT_NE( at, std::string::npos ) << from;
		return text.replace( at, from.size(), to );
	};
	std::vector<std::pair<std::string, std::string>> huge = { { "WIDTH 2", "WIDTH 4000000000" },
	    { "WIDTH 2", "WIDTH 18446744073709551615" }, { "HEIGHT 1", "HEIGHT 9223372036854775809" },
	    { "WIDTH 2", "WIDTH 99999999999999999999999" }, { "COUNT 1 1 1", "COUNT 1 1 18446744073709551615" },
	    { "COUNT 1 1 1", "COUNT 1 1 0" }, { "SIZE 4 4 4", "SIZE 4 4 3" }, { "TYPE F F F", "TYPE F F X" },
	    { "TYPE F F F", "TYPE F F" }, { "FIELDS x y z", "FIELDS x y x" }, { "FIELDS x y z", "FIELDS x y w" },
	    { "COUNT 1 1 1", "COUNT 1 1 2" }, { "WIDTH 2", "WIDTH -2" }, { "POINTS 2", "POINTS 3" },
	    { "POINTS 2", "POINTS two" }, { "DATA ", "DATA x" }, { "VERSION 0.7", "VERSOIN 0.7" }, { "WIDTH 2", "WIDTH 2 3" } };
	for ( const char* format : { "ascii", "binary", "binary_compressed" } )
	{
		for ( const auto& [from, to] : huge )
		{
			SCOPED_TRACE( to );
			expectBad( "a.pcd", with( from, to, format ), {} );
		}
		std::string more = with( "WIDTH 2", "WIDTH 1", format );
		more.replace( more.find( "POINTS 2" ), 8, "POINTS 1" );
		expectBad( "a.pcd", more, { "DATA" } ); // points behind the last one would be geometry left out
	}
	expectBad( "a.pcd", with( "1 2 3", "1 2", "ascii" ), { "point 0", "2 values, not 3" } );
	expectBad( "a.pcd", with( "4 5 6", "4 five 6", "ascii" ), { "point 1", "five" } );
	// A compressed size that no data can grow to
	expectBad( "a.pcd",
	    pcdHeader( plain, 300000000, 1, "binary_compressed" ) + bytesOf( std::uint32_t{ 12 } ) +
	        bytesOf( std::uint32_t{ 3600000000 } ) + "123456789012",
	    { "DATA" } );
}

TEST_F( CloudTest, PlyHeadersThatLie )
{
	auto with = [&]( const std::string& from, const std::string& to, const char* format )
	{
		std::string text = ply( { { 1, 2, 3 }, { 4, 5, 6 } }, format );
		std::size_t at = text.find( from );
		EXPECT_NE( at, std::string::npos ) << from;
		return text.replace( at, from.size(), to );
	};
	std::vector<std::pair<std::string, std::string>> lies = { { "vertex 2", "vertex 3" }, { "vertex 2", "vertex 1" },
	    { "vertex 2", "vertex 4000000000" }, { "vertex 2", "vertex 18446744073709551615" }, { "vertex 2", "vertex 0" },
	    { "vertex 2", "vertices 2" }, { "1.0", "2.0" }, { "float z", "quad z" }, { "float z", "float x" },
	    { "camera 2", "camera 900000000" }, { "ply\n", "PLY\n" }, { "end_header", "end_heade" },
	    { "property list uchar short rays\nproperty uchar id\n", "" } };
	for ( const char* format : { "ascii", "binary_little_endian", "binary_big_endian" } )
	{
		for ( const auto& [from, to] : lies )
		{
			SCOPED_TRACE( std::string( format ) + ": " + to );
			expectBad( "a.ply", with( from, to, format ), {} );
		}
	}
	expectBad( "a.ply", with( "2 5 6 1", "-2 5 6 1", "ascii" ), { "list rays has length -2" } );
}

TEST_F( CloudTest, CutAndFlipped )
{
	SeededRng rng;
	Points points = integers( rng, 60 );
	const std::vector<PcdField> fields = { { "a", 'U', 1, 3 }, { "x", 'F', 4, 1 }, { "y", 'F', 8, 1 }, { "z", 'I', 2, 1 } };
	int taken = 0;
	for ( const char* format : { "ascii", "binary", "binary_compressed" } )
	{
		auto read = [&]( const std::string& bytes ) { load( "a.pcd", bytes ); };
		std::string bytes = pcd( fields, points, format );
		// The last characters of a text may be missing unseen: a cut number is a number
		expectCutsRefused( read, bytes, bytes.size() - ( std::string( format ) == "ascii" ? 4 : 0 ) );
		DamageCount count = tryFlippedBits( read, bytes );
		EXPECT_GT( count.refused, 15 ) << format;
		taken += count.read;
	}
	for ( const char* format : { "ascii", "binary_little_endian", "binary_big_endian" } )
	{
		auto read = [&]( const std::string& bytes ) { load( "a.ply", bytes ); };
		std::string bytes = ply( points, format );
		expectCutsRefused( read, bytes, bytes.size() - ( std::string( format ) == "ascii" ? 4 : 0 ) );
		DamageCount count = tryFlippedBits( read, bytes );
		EXPECT_GT( count.refused, 15 ) << format;
		taken += count.read;
	}
	EXPECT_GT( taken, 40 ) << "too much damage to test anything";
}
