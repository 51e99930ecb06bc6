// SPDX-License-Identifier: BSD-3-Clause
// Octomaps in scenes: trees written by liboctomap are read as the boxes that it sees, and damage never as free space.
#include "damage.hpp"

#include <octomap/ColorOcTree.h>
#include <octomap/OcTree.h>
#include <octomap/OcTreeStamped.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

using namespace leeway::io;

namespace
{

using Box = std::array<double, 6>;
using Boxes = std::vector<Box>;

constexpr double resolution = 0.1;

/// Rays from a sensor into a room: occupied ends, free space before them, much that is unknown; pruned where possible.
template <typename Tree> void fill( Tree& tree, SeededRng& rng )
{
	for ( int i = 0; i < 60; ++i )
	{
		octomap::point3d end( static_cast<float>( rng.uniform( -2, 2 ) ), static_cast<float>( rng.uniform( -2, 2 ) ),
		    static_cast<float>( rng.uniform( -2, 2 ) ) );
		tree.insertRay( octomap::point3d( 0, 0, 0 ), end );
	}
	for ( int x = 0; x < 8; ++x )
	{
		for ( int y = 0; y < 8; ++y )
		{
			for ( int z = 0; z < 8; ++z )
			{
				double c[3] = { 1.6 + resolution * ( x + 0.5 ), -3.2 + resolution * ( y + 0.5 ), resolution * ( z + 0.5 ) };
				tree.updateNode( c[0], c[1], c[2], true );
			}
		}
	}
	tree.updateInnerOccupancy();
	tree.prune();
}

/// Occupied cells as the library's own iterator tells them.
template <typename Tree> Boxes occupied( const Tree& tree )
{
	Boxes boxes;
	for ( auto leaf = tree.begin_leafs(); leaf != tree.end_leafs(); ++leaf )
	{
		if ( tree.isNodeOccupied( *leaf ) )
		{
			double h = leaf.getSize() / 2;
			boxes.push_back(
			    { leaf.getX() - h, leaf.getY() - h, leaf.getZ() - h, leaf.getX() + h, leaf.getY() + h, leaf.getZ() + h } );
		}
	}
	std::sort( boxes.begin(), boxes.end() );
	return boxes;
}

template <typename Tree> std::string binaryFile( Tree& tree )
{
	std::ostringstream stream;
	EXPECT_TRUE( tree.writeBinaryConst( stream ) );
	return stream.str();
}

template <typename Tree> std::string fullFile( const Tree& tree )
{
	std::ostringstream stream;
	EXPECT_TRUE( tree.write( stream ) );
	return stream.str();
}

Boxes boxesOf( const lw_shape* shape )
{
	const double* v = lw_shape_vertices( shape );
	Boxes boxes;
	for ( std::uint32_t i = 0; i < lw_shape_get_info( shape ).vertex_count; i += 2 )
	{
		const double* p = v + 3 * i;
		boxes.push_back( { p[0], p[1], p[2], p[3], p[4], p[5] } );
	}
	std::sort( boxes.begin(), boxes.end() );
	return boxes;
}

void expectSame( const Boxes& boxes, const Boxes& expected )
{
	ASSERT_EQ( boxes.size(), expected.size() );
	for ( std::size_t i = 0; i < boxes.size(); ++i )
	{
		for ( std::size_t k = 0; k < 6; ++k )
		{
			ASSERT_NEAR( boxes[i][k], expected[i][k], 1e-9 ) << i;
		}
	}
}

class OctomapTest : public FileTest
{
protected:
	OctomapTest() : m_tree( resolution ) { fill( m_tree, m_rng ); }
	SceneModel load( const std::string& name, const std::string& bytes, const std::string& more = "unknown: free" )
	{
		write( name, bytes );
		return loadScene(
		    write( "scene.yaml", "world: {collision_objects: [{id: map, leeway_shapes: [{type: octomap, resource: " + name +
		                             ", " + more + "}]}]}\n" ) );
	}
	static const lw_shape* shape( const SceneModel& scene ) { return scene.objects.at( 0 ).shapes.at( 0 ).shape.get(); }
	SceneModel message( const std::string& id, bool binary, const std::string& data, const std::string& more = "" )
	{
		return loadScene( write( "scene.yaml", "world: {octomap: {header: {frame_id: map}, origin: {position: [1, 2, 3], "
		                                       "orientation: [0, 0, 0, 1]}, octomap: {header: {frame_id: ''}, binary: " +
		                                           std::string( binary ? "true" : "false" ) + ", id: " + id +
		                                           ", resolution: 0.1, data: " + data + "}" + more + "}}\n" ) );
	}
	void expectBad( const std::string& name, const std::string& bytes, std::vector<std::string> parts,
	    const std::string& more = "unknown: free" )
	{
		parts.insert( parts.end(), { "scene.yaml" } );
		expectError( [&] { load( name, bytes, more ); }, parts );
	}

	SeededRng m_rng;
	octomap::OcTree m_tree;
};

std::string list( const std::string& bytes )
{
	std::string text = "[";
	for ( char c : bytes )
	{
		text += std::to_string( static_cast<int>( c ) ) + ", ";
	}
	return text + "]";
}

bool inside( const Boxes& boxes, const std::array<double, 3>& p )
{
	return std::any_of( boxes.begin(), boxes.end(),
	    [&]( const Box& b )
	    { return p[0] >= b[0] && p[0] <= b[3] && p[1] >= b[1] && p[1] <= b[4] && p[2] >= b[2] && p[2] <= b[5]; } );
}

} // namespace

TEST_F( OctomapTest, FilesOfEveryKindGiveTheLibrarysCells )
{
	octomap::ColorOcTree color( resolution );
	octomap::OcTreeStamped stamped( resolution );
	fill( color, m_rng );
	fill( stamped, m_rng );
	expectSame( boxesOf( shape( load( "m.ot", fullFile( m_tree ) ) ) ), occupied( m_tree ) );
	expectSame( boxesOf( shape( load( "m.ot", fullFile( color ) ) ) ), occupied( color ) );
	expectSame( boxesOf( shape( load( "m.ot", fullFile( stamped ) ) ) ), occupied( stamped ) );
	m_tree.toMaxLikelihood();
	m_tree.prune();
	SceneModel scene = load( "m.bt", binaryFile( m_tree ) );
	expectSame( boxesOf( shape( scene ) ), occupied( m_tree ) );
	EXPECT_GT( occupied( m_tree ).size(), 50u );
	Boxes boxes = occupied( m_tree );
	auto larger = []( const Box& x, const Box& y ) { return x[3] - x[0] < y[3] - y[0]; };
	Box largest = *std::max_element( boxes.begin(), boxes.end(), larger );
	EXPECT_NEAR( largest[3] - largest[0], 8 * resolution, 1e-6 ) << "a pruned cell among them";
	EXPECT_EQ( scene.report.shapes.at( 0 ).source,
	    "octomap m.bt, " + std::to_string( occupied( m_tree ).size() ) + " occupied cells of 0.1 m and more" );
	EXPECT_TRUE( scene.report.notices.empty() ) << allNotices( scene.report.notices );
}

TEST_F( OctomapTest, UnknownCellsAreThoseTheLibraryFindsNothingAt )
{
	m_tree.toMaxLikelihood();
	m_tree.prune();
	double low[3], high[3];
	m_tree.getMetricMin( low[0], low[1], low[2] );
	m_tree.getMetricMax( high[0], high[1], high[2] );
	for ( bool bounded : { false, true } )
	{
		Box bounds = { low[0], low[1], low[2], high[0], high[1], high[2] };
		std::string more = "unknown: occupied";
		if ( bounded )
		{
			bounds = { -1.23, -5, -0.55, 4, 1.11, 0.33 }; // cuts cells, and reaches beyond the known space
			more += ", bounds: {min: [-1.23, -5, -0.55], max: {x: 4, y: 1.11, z: 0.33}}";
		}
		Boxes boxes = boxesOf( shape( load( "m.bt", binaryFile( m_tree ), more ) ) );
		int counts[3] = { 0, 0, 0 };
		for ( int i = 0; i < 20000; ++i )
		{
			std::array<double, 3> p = { m_rng.uniform( -5, 5 ), m_rng.uniform( -5, 5 ), m_rng.uniform( -3, 3 ) };
			if ( i % 4 == 0 ) // in and around the block
			{
				p = { m_rng.uniform( 1, 3 ), m_rng.uniform( -4, -2 ), m_rng.uniform( -1, 1 ) };
			}
			octomap::OcTreeNode* node = m_tree.search( p[0], p[1], p[2] );
			bool in_bounds = inside( { bounds }, p );
			bool expected = node != nullptr ? m_tree.isNodeOccupied( node ) : in_bounds;
			ASSERT_EQ( inside( boxes, p ), expected ) << p[0] << " " << p[1] << " " << p[2];
			++counts[node == nullptr ? 2 : expected ? 1 : 0];
		}
		EXPECT_GT( *std::min_element( counts, counts + 3 ), 20 );
	}
}

TEST_F( OctomapTest, MessagesInPlanningScenes )
{
	m_tree.toMaxLikelihood();
	m_tree.prune();
	std::ostringstream binary, full;
	m_tree.writeBinaryData( binary );
	m_tree.writeData( full );
	for ( bool is_binary : { true, false } )
	{
		std::string bytes = is_binary ? binary.str() : full.str();
		std::vector<unsigned char> raw( bytes.begin(), bytes.end() );
		SceneModel scene = message( "OcTree", is_binary, list( bytes ) );
		ASSERT_EQ( scene.objects.size(), 1u );
		EXPECT_EQ( scene.objects[0].name, "<octomap>" );
		EXPECT_EQ( scene.objects[0].frame, "map" );
		expectPoint( scene.objects[0].shapes.at( 0 ).pose, 1, 2, 3 );
		expectSame( boxesOf( shape( scene ) ), occupied( m_tree ) );
		EXPECT_NOTICE( scene.report.notices, "free, as in MoveIt" );
	}
	std::size_t free = boxesOf( shape( message( "OcTree", true, list( binary.str() ) ) ) ).size();
	SceneModel scene = message( "OcTree", true, list( binary.str() ), ", leeway_unknown: occupied" );
	EXPECT_GT( boxesOf( shape( scene ) ).size(), free );
	EXPECT_TRUE( scene.report.notices.empty() ) << allNotices( scene.report.notices );
	// !!binary: four cells of the first octant, at base64 of 0x55 0x02
	scene = message( "OcTree", true, "!!binary \"qgI=\"" ); // 10 10 10 10 | 10 00 00 00: five occupied octants
	EXPECT_EQ( boxesOf( shape( scene ) ).size(), 5u );
}

TEST_F( OctomapTest, MessagesThatCannotBe )
{
	auto bad = [&]( const std::string& id, bool binary, const std::string& data, std::vector<std::string> parts,
	               const std::string& more = "" )
	{
		parts.push_back( "scene.yaml" );
		parts.push_back( "octomap" );
		expectError( [&] { message( id, binary, data, more ); }, parts );
	};
	bad( "Grid", true, "[1, 0]", { "\"Grid\" are not known" } );
	for ( const char* id : { "A", "ColorOcTre", "CountingOcTree", "OcTre", "OcTreeStampe", "Octree",
	          "Z" } ) // before, between and after those known
	{
		bad( id, true, "[1, 0]", { "trees of type", id, "not known" } );
	}
	bad( "OcTree", true, "[1, 300]", { "data[1]", "no byte" } );
	bad( "OcTree", true, "[1, 0.5]", { "data[1]", "no byte" } );
	bad( "OcTree", true, "[1]", { "cell 0", "is missing" } );
	bad( "OcTree", true, "[0, 0]", { "divided into nothing" } );
	bad( "OcTree", true, "[1, 0, 7]", { "1 bytes after the last cell" } );
	bad( "OcTree", true, "[1, 0]", { "leeway_bounds", "no meaning" }, ", leeway_bounds: {min: [0, 0, 0], max: [1, 1, 1]}" );
	bad( "OcTree", true, "[1, 0]", { "leeway_unknown", "maybe" }, ", leeway_unknown: maybe" );
	bad( "OcTree", true, "[1, 0]", { "bounds", "no range" },
	    ", leeway_unknown: occupied, leeway_bounds: {min: [0, 0, 0], max: [1, 1, 0]}" );
	bad( "OcTree", true, "[1, 0]", { "leeway_unkown", "is leeway_unknown meant?" }, ", leeway_unkown: free" );
	bad( "OcTree", true, "!!binary \"%\"", { "base64" } );
	bad( "OcTree", true, "!!binary \"qgI\xc3\xa9\"", { "base64" } );
	bad( "OcTree", true, "!!binary \"\xf4\x8f\xbf\xbf\"", { "base64" } );
	bad( "OcTree", false, list( std::string( "\0\0\xc0\x7f\0", 5 ) ), { "not a number" } ); // NaN
	// As deep as the bytes say: each cell has one child of its own
	bad( "OcTree", true, list( std::string( 100000, '\3' ) ), { "below the finest level" } );
}

TEST_F( OctomapTest, NothingOccupied )
{
	SceneModel scene = message( "OcTree", true, "[1, 0]" );
	EXPECT_TRUE( scene.objects.empty() );
	EXPECT_NOTICE( scene.report.notices, "no occupied cell" );
	scene = message( "", true, "[]" );
	EXPECT_TRUE( scene.objects.empty() );
	octomap::OcTree empty( 0.1 );
	scene = load( "m.bt", binaryFile( empty ) );
	EXPECT_TRUE( scene.objects.at( 0 ).shapes.empty() );
	EXPECT_NOTICE( scene.report.notices, "no occupied cell" );
	Boxes boxes = boxesOf(
	    shape( load( "m.bt", binaryFile( empty ), "unknown: occupied, bounds: {min: [0, 0, 0], max: [1, 1, 1]}" ) ) );
	expectSame( boxes, { { 0, 0, 0, 1, 1, 1 } } );
}

TEST_F( OctomapTest, KeysThatASceneMustHave )
{
	std::string bytes = binaryFile( m_tree );
	expectBad( "m.bt", bytes, { "unknown", "what are cells that nobody has seen" }, "pose: {position: [0, 0, 0]}" );
	expectBad( "m.bt", bytes, { "unknown", "neither free nor occupied" }, "unknown: solid" );
	expectBad( "m.bt", bytes, { "bounds", "no meaning" }, "unknown: free, bounds: {min: [0, 0, 0], max: [1, 1, 1]}" );
	expectBad( "m.bt", bytes, { "bounds", "no range" }, "unknown: occupied, bounds: {min: [0, 0, 0], max: [1, 1, 1e9]}" );
	expectBad( "m.bt", bytes, { "bounds.max" }, "unknown: occupied, bounds: {min: [0, 0, 0]}" );
	expectBad( "m.bt", bytes, { "treshold", "not known" }, "unknown: free, treshold: 0.3" );
	expectBad( "m.txt", "hello", { "m.txt", "no octomap" } );
	expectError(
	    [&]
	    {
		    loadScene( write( "s.yaml", "world: {collision_objects: [{id: map, leeway_shapes: [{type: octomap, resource: "
		                                "gone.bt, unknown: free}]}]}\n" ) );
	    },
	    { "s.yaml", "octomap gone.bt was not found" } );
	auto header = [&]( const std::string& from, const std::string& to )
	{
		std::string text = bytes;
		return text.replace( text.find( from ), from.size(), to );
	};
	expectBad( "m.bt", header( "id OcTree", "id MyTree" ), { "MyTree" } );
	expectBad( "m.bt", header( "res 0.1", "res 0" ), { "cells of 0 m" } );
	expectBad( "m.bt", header( "res 0.1", "res nan" ), { "cells of nan m" } );
	expectBad( "m.bt", header( "size ", "size 1" ), { "size" } );
	expectBad( "m.bt", header( "size ", "seize " ), { "header" } );
	expectBad( "m.bt", header( "# Octomap OcTree binary", "# Octomap binary" ), { "no octomap" } );
}

TEST_F( OctomapTest, CutAndFlipped )
{
	auto read_binary = [&]( const std::string& bytes ) { load( "m.bt", bytes ); };
	std::string bytes = binaryFile( m_tree );
	expectCutsRefused( read_binary, bytes, bytes.size() );
	DamageCount count = tryFlippedBits( read_binary, bytes );
	EXPECT_GT( count.refused, 20 );
	octomap::ColorOcTree color( resolution );
	fill( color, m_rng );
	auto read_full = [&]( const std::string& text ) { load( "m.ot", text ); };
	bytes = fullFile( color );
	expectCutsRefused( read_full, bytes, bytes.size() );
	DamageCount full = tryFlippedBits( read_full, bytes );
	EXPECT_GT( full.refused, 10 );
	EXPECT_GT( full.read + count.read, 20 ) << "too much damage to test anything";
}
