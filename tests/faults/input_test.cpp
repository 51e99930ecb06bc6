// SPDX-License-Identifier: BSD-3-Clause
// Inputs that change, never end or ask for too much: a whole state of a file or an error, and limits that are told by name.
#include "files.hpp"

#include "cache/cache_file.hpp"
#include "cloud/height_map.hpp"
#include "cloud/octomap_reader.hpp"
#include "cloud/point_cloud.hpp"
#include "seeded_rng.hpp"

#include "leeway/io/limits.hpp"

#include <atomic>
#include <fcntl.h>
#include <sys/stat.h>
#include <thread>
#include <unistd.h>

using namespace leeway::io;

namespace
{

class Input : public FileTest
{
};

/// A robot of one link with this mesh.
std::string robotOf( const std::string& mesh )
{
	return "<robot name='r'><link name='a'><collision><geometry><mesh filename='" + mesh +
	       "'/></geometry></collision></link></robot>";
}

Limits with( std::uint64_t Limits::*limit, std::uint64_t value )
{
	Limits limits;
	limits.*limit = value;
	return limits;
}

} // namespace

TEST_F( Input, AFileThatGrowsMeanwhileIsAnError )
{
	const std::string file = write( "large", std::string( std::size_t( 48 ) << 20, 'x' ) );
	std::atomic<bool> stop{ false };
	std::thread writer(
	    [&]
	    {
		    const int descriptor = open( file.c_str(), O_WRONLY | O_APPEND );
		    while ( !stop )
		    {
			    EXPECT_EQ( ::write( descriptor, "y", 1 ), 1 );
			    usleep( 200 );
		    }
		    close( descriptor );
	    } );
	int changed = 0, whole = 0;
	for ( int i = 0; i < 4; ++i )
	{
		try
		{
			whole += readWholeFile( file ).size() >= std::size_t( 48 ) << 20 ? 1 : 0;
		}
		catch ( const Error& error )
		{
			EXPECT_NE( std::string( error.what() ).find( "changed while it was read" ), std::string::npos ) << error.what();
			++changed;
		}
	}
	stop = true;
	writer.join();
	EXPECT_EQ( changed + whole, 4 );
	EXPECT_GT( changed, 0 );
	EXPECT_GT( readWholeFile( file ).size(), std::size_t( 48 ) << 20 );
}

TEST_F( Input, AMeshThatChangesAfterItWasOpenedIsTheOneThatWasOpened )
{
	std::string stl( 80, ' ' );
	const std::uint32_t count = 1;
	stl.append( reinterpret_cast<const char*>( &count ), 4 );
	const float numbers[12] = { 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0 };
	stl.append( reinterpret_cast<const char*>( numbers ), 48 ).append( 2, '\0' );
	for ( const auto& [name, bytes] : { std::pair( std::string( "m.stl" ), stl ),
	          std::pair( std::string( "m.obj" ), std::string( "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n" ) ) } )
	{
		const std::string file = write( name, bytes ), urdf = write( "r.urdf", robotOf( name ) );
		LoadOptions now;
		now.defer = false;
		const RobotModel made = loadRobot( urdf, "", now );
		for ( int change = 0; change < 3; ++change )
		{
			write( name, bytes );
			const RobotModel deferred = loadRobot( urdf, "" );
			change == 0   ? (void)write( name, "garbage" )
			: change == 1 ? (void)write( name, "" )
			              : (void)std::remove( file.c_str() );
			const lw_shape* shape = deferred.links[0].collision[0].shape.get();
			lw_diag diag{};
			ASSERT_EQ( LW_OK, lw_shape_complete( shape, &diag ) ) << diag.message;
			EXPECT_TRUE(
			    lw_digest_equal( lw_shape_digest( shape ), lw_shape_digest( made.links[0].collision[0].shape.get() ) ) );
		}
	}
}

TEST_F( Input, EveryByteOfACacheFileCounts )
{
	const std::string urdf = write( "r.urdf", robotOf( "m.obj" ) );
	writeTetrahedron( "m.obj" );
	LoadOptions options;
	options.cache = path( "cache" );
	options.defer = false;
	const lw_digest want = lw_shape_digest( loadRobot( urdf, "", options ).links[0].collision[0].shape.get() );
	std::string file;
	for ( const auto& entry : std::filesystem::directory_iterator( options.cache ) )
	{
		file = entry.path().string();
	}
	const std::string good = readWholeFile( file );
	SeededRng rng;
	const auto loadsAnyway = [&]( const std::string& bytes, bool used )
	{
		std::ofstream( file, std::ios::binary ) << bytes;
		const RobotModel model = loadRobot( urdf, "", options );
		EXPECT_TRUE( lw_digest_equal( want, lw_shape_digest( model.links[0].collision[0].shape.get() ) ) );
		EXPECT_EQ( hasNotice( model.report.notices, "not used" ), !used ) << allNotices( model.report.notices );
	};
	loadsAnyway( good, true );
	for ( std::size_t at = 0; at < good.size(); at += 1 + good.size() / 500 )
	{
		std::string flipped = good;
		flipped[at] = static_cast<char>( flipped[at] ^ ( 1 << rng.integer( 0, 7 ) ) );
		loadsAnyway( flipped, false );
		loadsAnyway( good.substr( 0, at ), false );
	}
}

/// A FIFO would wait for a writer, and /dev/zero has no end: each is told for what it is, by whichever name.
TEST_F( Input, PipesDevicesAndFoldersAreRead )
{
	const std::string pipe = path( "pipe" ), folder = path( "folder" ), link = path( "link" ), loop = path( "loop" );
	ASSERT_EQ( mkfifo( pipe.c_str(), 0600 ), 0 );
	std::filesystem::create_directory( folder );
	std::filesystem::create_symlink( "pipe", link );
	std::filesystem::create_symlink( "loop", loop );
	const std::vector<std::pair<std::string, std::string>> fakes = { { pipe, "is a pipe, not a file" },
	    { link, "is a pipe, not a file" }, { folder, "is a folder, not a file" }, { "/dev/zero", "is a device, not a file" },
	    { "/dev/null", "is a device, not a file" }, { loop, "cannot be read: " } };
	for ( const auto& [file, problem] : fakes )
	{
		expectError( [&, name = file] { (void)readWholeFile( name ); }, { file, problem } );
		expectError( [&, name = file] { (void)loadRobot( name, "" ); }, { file, problem } );
		expectError( [&, name = file] { (void)loadScene( name ); }, { file, problem } );
		expectError( [&, name = file] { (void)loadRequest( name ); }, { file, problem } );
		const std::string kind = problem.substr( 0, 3 ) == "is " ? problem.substr( 3 ) : "Too many levels";
		expectError(
		    [&, name = file] { (void)loadRobot( write( "r.urdf", robotOf( name ) ), "" ); }, { file + " (" + kind } );
	}
	writeTetrahedron( "m.obj" );
	const std::string model = write( "r.urdf", robotOf( "m.obj" ) );
	expectError( [&] { (void)loadRobot( model, pipe ); }, { pipe, "is a pipe" } );
}

/// assimp opens the libraries of materials that an OBJ names, glTF its buffers.
TEST_F( Input, PipesThatMeshesNameAreOpened )
{
	const std::string pipe = path( "pipe" );
	ASSERT_EQ( mkfifo( pipe.c_str(), 0600 ), 0 );
	const std::string corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl steel\nf 1 2 3\n";
	write( "m.obj", "mtllib " + pipe + "\n" + corners );
	EXPECT_EQ( loadRobot( write( "r.urdf", robotOf( "m.obj" ) ), "" ).links.size(), 1u );
	write( "m.gltf", R"({"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
	    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
	    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
	    "bufferViews": [{"buffer": 0, "byteLength": 36}], "buffers": [{"byteLength": 36, "uri": "pipe"}]})" );
	expectError(
	    [&] { (void)loadRobot( write( "r.urdf", robotOf( "m.gltf" ) ), "" ); }, { "m.gltf", "buffer 0", "is a pipe" } );
}

TEST_F( Input, AStreamOfTheProgramIsReadToItsEndAndToTheLimit )
{
	const auto streamed = []( const std::string& text )
	{
		int ends[2];
		EXPECT_EQ( ::pipe( ends ), 0 );
		EXPECT_EQ( ::write( ends[1], text.data(), text.size() ), static_cast<ssize_t>( text.size() ) );
		close( ends[1] );
		const std::string bytes = readWholeFile( "/dev/fd/" + std::to_string( ends[0] ) );
		close( ends[0] );
		return bytes;
	};
	const std::string text( 5000, 'x' );
	EXPECT_EQ( streamed( text ), text );
	const LimitScope scope( with( &Limits::file_bytes, 4999 ) );
	expectError(
	    [&] { (void)streamed( text ); }, { "/dev/fd/", "the limit file_bytes is 4999", "--input-limit file_bytes=N" } );
	const int zero = open( "/dev/zero", O_RDONLY );
	expectError( [&] { (void)readWholeFile( "/dev/fd/" + std::to_string( zero ) ); }, { "is a device, not a file" } );
	close( zero );
}

TEST_F( Input, LimitsAreOfTheScopeAndTold )
{
	EXPECT_EQ( currentLimits().links, Limits().links );
	{
		const LimitScope outer( with( &Limits::links, 7 ) );
		EXPECT_EQ( currentLimits().links, 7u );
		{
			const LimitScope inner( with( &Limits::triangles, 5 ) );
			EXPECT_EQ( currentLimits().links, Limits().links );
			std::thread( [] { EXPECT_EQ( currentLimits().triangles, Limits().triangles ); } ).join();
		}
		EXPECT_EQ( currentLimits().links, 7u );
	}
	EXPECT_EQ( limitNames().size() * sizeof( std::uint64_t ), sizeof( Limits ) ) << "each limit has a name";
}

TEST_F( Input, EachLimitIsMetByItsFile )
{
	const auto expectLimit = [&]( std::uint64_t Limits::*limit, std::uint64_t enough, const std::string& name, auto read )
	{
		{
			const LimitScope scope( with( limit, enough ) );
			EXPECT_NO_THROW( read() ) << name;
		}
		const LimitScope scope( with( limit, enough - 1 ) );
		expectError( read, { "the limit " + name + " is " + std::to_string( enough - 1 ) } );
	};
	writeTetrahedron( "m.obj" );
	const std::string urdf = write( "r.urdf", robotOf( "m.obj" ) );
	expectLimit( &Limits::triangles, 4, "triangles", [&] { (void)loadRobot( urdf, "" ); } );
	expectLimit( &Limits::links, 1, "links", [&] { (void)loadRobot( urdf, "" ); } );
	const std::string box = "primitives: [{type: sphere, dimensions: [1]}], primitive_poses: [{position: [9, 0, 0]}]}";
	const std::string scene = write( "s.yaml", "world:\n  collision_objects: [{id: a, " + box + ", {id: b, " + box + "]\n" );
	expectLimit( &Limits::objects, 2, "objects", [&] { (void)loadScene( scene ); } );
	const std::string cloud =
	    write( "c.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
	                    "end_header\n0 0 0\n1 1 1\n2 2 2\n" );
	expectLimit( &Limits::points, 3, "points", [&] { (void)detail::readPointCloud( cloud ); } );
	const std::string pcd = write( "c.pcd",
	    "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 2\nHEIGHT 1\nPOINTS 2\nDATA ascii\n0 0 0\n1 1 1\n" );
	expectLimit( &Limits::points, 2, "points", [&] { (void)detail::readPointCloud( pcd ); } );
	const std::string heights = write( "h.txt", "1 2 3\n4 5 6\n" );
	expectLimit( &Limits::points, 6, "points", [&] { (void)detail::readHeightGrid( heights ); } );
	const std::string deep = write( "d.yaml", "world: {a: [[[1]]]}\n" );
	expectLimit( &Limits::nesting, 5, "nesting", [&] { (void)loadScene( deep ); } );
}

/// Each line doubles the nodes of the one before: 40 lines are 10^12 nodes. They are counted, not visited.
TEST_F( Input, AliasesOfAliasesAreCountedNotVisited )
{
	std::string text = "x0: &x0 [1, 2]\n";
	for ( int i = 1; i < 40; ++i )
	{
		const std::string before = std::to_string( i - 1 ), now = std::to_string( i );
		text += "x" + now + ": &x" + now + " [*x" + before + ", *x" + before + "]\n";
	}
	const std::string file = write( "s.yaml", text + "world: {}\n" );
	expectError( [&] { (void)loadScene( file ); }, { "the limit alias_nodes is 1000000" } );
	expectError( [&] { (void)loadRequest( file ); }, { "alias_nodes" } );
}

/// For valgrind: one file of each kind, whole and damaged.
TEST( Smoke, FilesOfEachKind )
{
	class Files : public FileTest
	{
	public:
		using FileTest::write;
		using FileTest::writeTetrahedron;
		void TestBody() override {}
	} files;
	files.writeTetrahedron( "m.obj" );
	const std::string urdf =
	    files.write( "r.urdf", "<robot name='r'><link name='a'/><link name='b'><collision><geometry><mesh "
	                           "filename='m.obj'/></geometry></collision></link>"
	                           "<joint name='j' type='continuous'><parent link='a'/><child link='b'/></joint></robot>" );
	const RobotModel robot = loadRobot( urdf, "" );
	ProblemOptions options;
	const SceneModel scene =
	    loadScene( files.write( "s.yaml", "world:\n  collision_objects:\n    - {id: a, primitives: [{type: box, dimensions: "
	                                      "[1, 1, 1]}], primitive_poses: [{position: [3, 0, 0]}]}\n" ) );
	options.scene = &scene;
	const Problem problem = buildProblem( robot, options );
	const leeway::Query query = leeway::makeQuery( problem.checker.get() );
	lw_state_result result;
	const std::vector<double> q = startState( problem );
	EXPECT_EQ(
	    LW_OK, lw_checker_state( problem.checker.get(), query.get(), q.data(), LW_CHECK_BOTH, nullptr, false, &result ) );
	EXPECT_THROW( (void)loadScene( files.write( "bad.yaml", "world: [" ) ), Error );
	EXPECT_THROW( (void)loadRobot( files.write( "bad.urdf", "<robot" ), "" ), Error );
}
