// SPDX-License-Identifier: BSD-3-Clause
// Damaged files: whatever is cut, doubled or replaced in a valid file, reading gives a model or an Error, nothing else.
#include "files.hpp"
#include "seeded_rng.hpp"

using namespace leeway::io;

namespace
{

const std::string urdf =
    "<robot name=\"r\"><link name=\"a\"><collision><origin xyz=\"0 0 1\" rpy=\"0 0 0.5\"/><geometry><box size=\"1 1 1\"/>"
    "</geometry></collision></link><link name=\"b\"><collision><geometry><mesh filename=\"m.obj\" scale=\"1 1 2\"/>"
    "</geometry></collision></link><joint name=\"j\" type=\"revolute\"><parent link=\"a\"/><child link=\"b\"/><axis "
    "xyz=\"0 0 1\"/><limit lower=\"-1\" upper=\"1\" effort=\"1\" velocity=\"1\"/></joint></robot>";
const std::string srdf =
    "<robot name=\"r\"><group name=\"g\"><chain base_link=\"a\" tip_link=\"b\"/></group><group name=\"h\"><group "
    "name=\"g\"/>"
    "</group><virtual_joint name=\"v\" type=\"planar\" parent_frame=\"w\" child_link=\"a\"/><disable_collisions "
    "link1=\"a\" link2=\"b\" reason=\"Never\"/><group_state name=\"s\" group=\"g\"><joint name=\"j\" value=\"1\"/>"
    "</group_state></robot>";
const std::string scene =
    "name: s\nworld:\n  collision_objects:\n    - id: o\n      header: {frame_id: a}\n      pose: {position: {x: 1, y: 2, "
    "z: 3}, orientation: [0, 0, 0, 1]}\n      primitives: [{type: cylinder, dimensions: [1, 2]}]\n      primitive_poses: "
    "[{position: [1, 2, 3], orientation: [0, 0, 0, 1]}]\n      meshes: [{vertices: [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "
    "triangles: [[0, 1, 2]]}]\n      mesh_poses: [{position: [0, 0, 0]}]\nallowed_collision_matrix: {entry_names: [a, o], "
    "entry_values: [[0, 1], [1, 0]]}\nrobot_state: {joint_state: {name: [j], position: [0.5]}}\n";
const std::string request =
    "group_name: g\nstart_state: {joint_state: {name: [j], position: [0]}}\ngoal_constraints:\n  - joint_constraints:\n     "
    " - {joint_name: j, position: 1}\n";

/// One to three random cuts, copies and replacements.
std::string damage( std::string text, SeededRng& rng )
{
	const std::string splinters[] = { "<", ">", "\"", "/", "{", "}", "[", "]", ":", "-", " ", "\n", "&a ", "*a", "nan",
	    "1e999", std::string( 1, '\0' ), "\xff", "~", "-1", "%" };
	for ( int i = rng.integer( 1, 3 ); i > 0 && !text.empty(); --i )
	{
		std::size_t at = static_cast<std::size_t>( rng.integer( 0, static_cast<int>( text.size() ) - 1 ) );
		std::size_t length = static_cast<std::size_t>( rng.integer( 1, 12 ) );
		switch ( rng.integer( 0, 3 ) )
		{
		case 0:
			text.erase( at, length );
			break;
		case 1:
			text.insert( at, text.substr( at, length * 4 ) );
			break;
		case 2:
			text.replace( at, 1, splinters[static_cast<std::size_t>( rng.integer( 0, 20 ) )] );
			break;
		default:
			text.resize( rng.integer( 0, 9 ) == 0 ? at : text.size() );
			break;
		}
	}
	return text;
}

class DamageTest : public FileTest
{
protected:
	template <typename F> void run( const std::string& text, F read )
	{
		SeededRng rng;
		int good = 0, bad = 0;
		for ( int i = 0; i < 300; ++i )
		{
			std::string damaged = damage( text, rng );
			try
			{
				read( damaged );
				++good;
			}
			catch ( const Error& error )
			{
				++bad;
				EXPECT_FALSE( error.problem().empty() );
				EXPECT_FALSE( error.remedy().empty() ) << error.what();
			}
			catch ( const std::exception& error )
			{
				ADD_FAILURE() << error.what() << " from:\n" << damaged;
			}
		}
		EXPECT_GT( good, 10 ) << "too much damage to test anything";
		EXPECT_GT( bad, 50 ) << "too little damage to test anything";
	}
};

} // namespace

TEST_F( DamageTest, Urdf )
{
	writeTetrahedron( "m.obj" );
	run( urdf, [&]( const std::string& text ) { buildProblem( loadRobot( write( "r.urdf", text ), "" ), {} ); } );
}

TEST_F( DamageTest, Srdf )
{
	writeTetrahedron( "m.obj" );
	std::string good = write( "r.urdf", urdf );
	run( srdf, [&]( const std::string& text ) { loadRobot( good, write( "r.srdf", text ) ); } );
}

TEST_F( DamageTest, Scene )
{
	writeTetrahedron( "m.obj" );
	RobotModel robot = loadRobot( write( "r.urdf", urdf ), "" );
	run( scene,
	    [&]( const std::string& text )
	    {
		    SceneModel model = loadScene( write( "s.yaml", text ) );
		    ProblemOptions options;
		    options.scene = &model;
		    buildProblem( robot, options );
	    } );
}

TEST_F( DamageTest, Request )
{
	run( request, [&]( const std::string& text ) { loadRequest( write( "q.yaml", text ) ); } );
}

TEST_F( DamageTest, YamlThatContainsItself )
{
	expectError(
	    [&] { loadScene( write( "s.yaml", "world: &w\n  collision_objects: [*w]\n" ) ); }, { "s.yaml", "contains itself" } );
	expectError( [&] { loadScene( write( "s.yaml", std::string( 100000, '[' ) ) ); }, { "s.yaml" } );
	expectError( [&] { loadScene( write( "s.yaml", "world: " + std::string( 500, '[' ) + std::string( 500, ']' ) ) ); },
	    { "s.yaml" } );
}
