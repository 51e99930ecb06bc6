// SPDX-License-Identifier: BSD-3-Clause
// Shapes and motion hulls kept between loads: changes that make another file, and notices that are repeated.
#include "files.hpp"
#include "leeway/io/cache.hpp"

#include <atomic>
#include <fcntl.h>
#include <sys/stat.h>
#include <thread>

using namespace leeway;
using namespace leeway::io;

namespace fs = std::filesystem;

namespace
{

class IoCache : public FileTest
{
protected:
	IoCache()
	{
		writeTetrahedron( "a.obj", 0.2 );
		writeTetrahedron( "b.obj", 0.1 );
		writeUrdf( "" );
		options.cache = path( "cache" );
	}
	/// Two meshes, one of them twice and once more at half the size; a box.
	void writeUrdf( const std::string& more )
	{
		std::string urdf = "<robot name=\"cached/robot\">" + link( "base", mesh( "a.obj" ) ) +
		                   link( "one", mesh( "b.obj" ) ) +
		                   link( "two", mesh( "b.obj" ) + mesh( "b.obj\" scale=\"0.5 0.5 0.5" ) ) +
		                   link( "three", "<collision><geometry><box size=\"0.1 0.1 0.1\"/></geometry></collision>" );
		for ( const char* child : { "one", "two", "three" } )
		{
			urdf += "<joint name=\"" + std::string( child ) +
			        "_joint\" type=\"revolute\"><parent link=\"base\"/><child link=\"" + child + "\"/><origin xyz=\"" +
			        std::to_string( child[1] == 'n'   ? 1
			                        : child[1] == 'w' ? 2
			                                          : 3 ) +
			        " 0 0\"/><limit lower=\"-1\" upper=\"1\" effort=\"1\" velocity=\"1\"/></joint>";
		}
		write( "r.urdf", urdf + more + "</robot>" );
	}
	static std::string link( const std::string& name, const std::string& content )
	{
		return "<link name=\"" + name + "\">" + content + "</link>";
	}
	static std::string mesh( const std::string& file )
	{
		return "<collision><geometry><mesh filename=\"" + file + "\"/></geometry></collision>";
	}
	/// Makes all that is deferred.
	static void complete( const RobotModel& model )
	{
		for ( const LinkModel& link : model.links )
		{
			for ( const PlacedShape& shape : link.collision )
			{
				EXPECT_EQ( lw_shape_complete( shape.shape.get(), nullptr ), LW_OK );
			}
		}
	}
	RobotModel load()
	{
		options.strict = true; // all pairs, and no notice about neighbours
		return loadRobot( path( "r.urdf" ), "", options );
	}
	std::size_t cachedShapes( const RobotModel& model )
	{
		std::size_t count = 0;
		for ( const LoadedShape& shape : model.report.shapes )
		{
			count += shape.cached ? 1 : 0;
		}
		return count;
	}
	std::size_t files() const
	{
		return static_cast<std::size_t>(
		    std::distance( fs::directory_iterator( path( "cache" ) ), fs::directory_iterator() ) );
	}

	LoadOptions options;
};

} // namespace

TEST_F( IoCache, ShapesFromItAreTheSame )
{
	const RobotModel cold = load(), late = load();
	complete( cold );
	const RobotModel warm = load();
	EXPECT_EQ( cachedShapes( cold ), 0u );
	EXPECT_EQ( cachedShapes( late ), 0u ) << "nothing was built yet that could have been kept";
	EXPECT_EQ( cachedShapes( warm ), 3u ); // a, b, half of b; the other b is shared, the box is built
	EXPECT_EQ( warm.report.cache, options.cache );
	EXPECT_GT( warm.report.cache_milliseconds, 0 );
	EXPECT_EQ( files(), 3u );
	ASSERT_EQ( cold.links.size(), warm.links.size() );
	for ( std::size_t i = 0; i < cold.links.size(); ++i )
	{
		ASSERT_EQ( cold.links[i].collision.size(), warm.links[i].collision.size() );
		for ( std::size_t k = 0; k < cold.links[i].collision.size(); ++k )
		{
			const lw_shape *want = cold.links[i].collision[k].shape.get(), *got = warm.links[i].collision[k].shape.get();
			EXPECT_TRUE( lw_digest_equal( lw_shape_digest( want ), lw_shape_digest( got ) ) ) << cold.links[i].name;
			EXPECT_EQ( lw_shape_peek_info( want ).triangle_count, lw_shape_peek_info( got ).triangle_count );
			EXPECT_TRUE( lw_shape_peek_info( got ).deferred || i != 0 ) << "counts and digest come from beside the tree";
			EXPECT_EQ( lw_shape_complete( got, nullptr ), LW_OK );
			EXPECT_FALSE( lw_shape_peek_info( got ).deferred );
			EXPECT_TRUE( lw_digest_equal( lw_shape_digest( want ), lw_shape_digest( got ) ) ) << cold.links[i].name;
		}
		EXPECT_EQ( cold.report.shapes[i].shared, warm.report.shapes[i].shared );
	}
	EXPECT_TRUE( warm.report.notices.empty() ) << allNotices( warm.report.notices );
	EXPECT_EQ( warm.links[1].collision[0].shape.get(), warm.links[2].collision[0].shape.get() ) << "shared";
}

TEST_F( IoCache, OptionsAndFilesThatMatterMakeAnotherFile )
{
	complete( load() );
	EXPECT_EQ( cachedShapes( load() ), 3u );
	const auto differs = [&]( const char* what, std::size_t same = 0 )
	{ EXPECT_EQ( cachedShapes( load() ), same ) << what; };
	options.tree.leaf_size = options.tree.leaf_size == 4 ? 2 : 4;
	differs( "leaf size" );
	options.tree = lw_tree_def_default();
	options.tree.fit = options.tree.fit == LW_FIT_MINIMAL ? LW_FIT_GREEDY : LW_FIT_MINIMAL;
	differs( "fit" );
	options.tree = lw_tree_def_default();
	options.weld_tolerance = 1e-3;
	differs( "weld tolerance" );
	options.weld_tolerance = 0;
	writeTetrahedron( "b.obj", 0.11 );
	differs( "a mesh", 1 );
	writeTetrahedron( "b.obj", 0.1 );
	differs( "as before", 3 );
	writeUrdf( "<!-- changed -->" );
	differs( "the URDF does not matter to a mesh", 3 );
}

TEST_F( IoCache, FacesThatWereLeftOutAreToldEachTime )
{
	write( "a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\nf 1 3 4\nf 2 3 4\nl 1 2\n" );
	const RobotModel cold = load();
	complete( cold );
	const RobotModel warm = load();
	EXPECT_EQ( cachedShapes( warm ), 3u );
	EXPECT_NOTICE( cold.report.notices, "have no surface" );
	EXPECT_NOTICE( warm.report.notices, "have no surface" );
	EXPECT_EQ( cold.report.notices.size(), warm.report.notices.size() );
}

// Every byte of a file that stands for something must matter: none may be changed unseen.
TEST_F( IoCache, ChangedBytesAreSeen )
{
	complete( load() );
	for ( const fs::directory_entry& entry : fs::directory_iterator( options.cache ) )
	{
		std::ifstream stream( entry.path(), std::ios::binary );
		const std::string good( std::istreambuf_iterator<char>( stream ), {} );
		for ( std::size_t at = 0; at < good.size(); at += 1 + good.size() / 150 )
		{
			std::string bad = good;
			bad[at] = static_cast<char>( bad[at] ^ 4 );
			std::ofstream( entry.path(), std::ios::binary ) << bad;
			const RobotModel model = load();
			EXPECT_EQ( cachedShapes( model ), 2u ) << at << " of " << good.size();
			EXPECT_NOTICE( model.report.notices, "built anew" );
		}
		const RobotModel model = load();
		complete( model );
		EXPECT_EQ( cachedShapes( load() ), 3u ) << "replaced";
	}
}

TEST_F( IoCache, AFileThatChangesMeanwhileChangesNothing )
{
	const RobotModel before = load();
	complete( load() );
	const RobotModel warm = load();
	writeTetrahedron( "a.obj", 0.4 );
	writeTetrahedron( "b.obj", 0.3 );
	fs::remove_all( options.cache );
	complete( before );
	complete( warm );
	for ( std::size_t i = 0; i < 3; ++i )
	{
		EXPECT_TRUE( lw_digest_equal( lw_shape_digest( before.links[i].collision[0].shape.get() ),
		    lw_shape_digest( warm.links[i].collision[0].shape.get() ) ) );
	}
}

TEST_F( IoCache, TheLeastRecentlyUsedGoFirst )
{
	complete( load() );
	std::vector<CacheEntry> all = listCache( options.cache );
	ASSERT_EQ( all.size(), 3u );
	std::uint64_t bytes = 0;
	for ( const CacheEntry& entry : all )
	{
		EXPECT_EQ( entry.kind, CacheEntry::tree );
		EXPECT_TRUE( entry.good ) << entry.problem;
		EXPECT_EQ( entry.triangles, 4u );
		EXPECT_TRUE( entry.name == "a" || entry.name == "b" ) << entry.name;
		bytes += entry.bytes;
	}
	const std::string oldest = all[1].file;
	const timespec times[2] = { { 1000000000, 0 }, { 1000000000, 0 } };
	ASSERT_EQ( utimensat( AT_FDCWD, oldest.c_str(), times, 0 ), 0 );
	EXPECT_EQ( listCache( options.cache ).back().file, oldest );
	const TrimmedCache trimmed = trimCache( options.cache, bytes - 1 );
	EXPECT_EQ( trimmed.files, 1u );
	EXPECT_FALSE( fs::exists( oldest ) );
	EXPECT_EQ( trimmed.remaining + trimmed.bytes, bytes );
	EXPECT_EQ( cachedShapes( load() ), 2u );
	// the file just read is the last to go
	all = listCache( options.cache );
	for ( const CacheEntry& entry : all )
	{
		ASSERT_EQ( utimensat( AT_FDCWD, entry.file.c_str(), times, 0 ), 0 );
	}
	EXPECT_EQ( listCache( options.cache ).back().used, 1000000000 );
	EXPECT_EQ( cachedShapes( load() ), 2u );
	EXPECT_GT( listCache( options.cache ).back().used, 1000000000 ) << "reading counts as use";
	EXPECT_EQ( trimCache( options.cache, 0 ).remaining, 0u );
	EXPECT_EQ( files(), 0u );
}

TEST_F( IoCache, ForeignFilesAreLeftAlone )
{
	complete( load() );
	const std::string digits( 32, 'a' );
	const std::string foreign[] = {
	    "notes.txt", "a.tree", "a-" + digits + ".txt", "a-" + std::string( 32, 'x' ) + ".tree", "." + digits + ".reach" };
	const std::string ours[] = { "r-" + digits + ".trees", "a-" + digits + ".tree.partial-abc123" };
	for ( const std::string& name : foreign )
	{
		write( "cache/" + name, "mine" );
	}
	for ( const std::string& name : ours )
	{
		write( "cache/" + name, "left" );
	}
	fs::create_directories( path( "cache/folder-" + digits + ".tree" ) );
	const std::vector<CacheEntry> list = listCache( options.cache );
	const auto count = [&]( CacheEntry::Kind kind )
	{ return std::count_if( list.begin(), list.end(), [&]( const CacheEntry& entry ) { return entry.kind == kind; } ); };
	EXPECT_EQ( count( CacheEntry::foreign ), 5 );
	EXPECT_EQ( count( CacheEntry::leftover ), 2 );
	trimCache( options.cache, 0 );
	for ( const std::string& name : foreign )
	{
		EXPECT_TRUE( fs::exists( path( "cache/" + name ) ) ) << name;
	}
	EXPECT_FALSE( fs::exists( path( "cache/" + ours[0] ) ) );
	EXPECT_TRUE( fs::exists( path( "cache/" + ours[1] ) ) ) << "somebody may be writing it";
	const timespec times[2] = { { 1000000000, 0 }, { 1000000000, 0 } };
	ASSERT_EQ( utimensat( AT_FDCWD, path( "cache/" + ours[1] ).c_str(), times, 0 ), 0 );
	trimCache( options.cache, UINT64_MAX );
	EXPECT_FALSE( fs::exists( path( "cache/" + ours[1] ) ) ) << "an hour later nobody is";
	EXPECT_EQ( files(), 6u );
	expectError( [&] { listCache( path( "nowhere" ) ); }, { "nowhere", "cannot be read" } );
}

TEST_F( IoCache, TheLimitHolds )
{
	options.cache_limit = 1; // no file fits
	complete( load() );
	EXPECT_LE( files(), 1u ) << "each write makes room, for itself at most";
	options.cache_limit = default_cache_limit;
	complete( load() );
	EXPECT_EQ( files(), 3u );
}

TEST_F( IoCache, ThreadsShareAFolder )
{
	std::vector<std::thread> threads;
	std::atomic<int> wrong{ 0 };
	for ( int t = 0; t < 4; ++t )
	{
		threads.emplace_back(
		    [&, t]
		    {
			    for ( int i = 0; i < 10; ++i )
			    {
				    RobotModel model = loadRobot( path( "r.urdf" ), "", options );
				    complete( model );
				    wrong += lw_shape_get_info( model.links[0].collision[0].shape.get() ).triangle_count != 4;
				    if ( t == 0 )
				    {
					    trimCache( options.cache, static_cast<std::uint64_t>( i % 2 ) * 1000 );
				    }
				    for ( const Notice& notice : model.report.notices )
				    {
					    wrong += notice.text.find( "damaged" ) != std::string::npos;
				    }
			    }
		    } );
	}
	for ( std::thread& thread : threads )
	{
		thread.join();
	}
	EXPECT_EQ( wrong, 0 );
	for ( const CacheEntry& entry : listCache( options.cache ) )
	{
		EXPECT_TRUE( entry.kind == CacheEntry::tree && entry.good ) << entry.file << ' ' << entry.problem;
	}
}

TEST_F( IoCache, AMissingMeshIsTheSameError )
{
	complete( load() );
	fs::remove( path( "b.obj" ) );
	expectError( [&] { load(); }, { "r.urdf", "b.obj", "was not found" } );
	write( "b.obj", "" );
	expectError( [&] { load(); }, { "r.urdf", "link one", "b.obj" } );
}

TEST_F( IoCache, AFileInPlaceOfTheFolderIsNamed )
{
	options.cache = write( "taken", "" );
	expectError( [&] { load(); }, { "taken", "not a folder" } );
	ReachOptions reach;
	reach.cache = path( "taken" );
	options.cache.clear();
	expectError( [&] { loadReach( buildRobot( load() ), reach ); }, { "taken", "not a folder" } );
}

TEST_F( IoCache, APrimitiveRobotNeedsNoFile )
{
	write( "r.urdf", "<robot name=\"r\">" +
	                     link( "base", "<collision><geometry><sphere radius=\"1\"/></geometry></collision>" ) + "</robot>" );
	const RobotModel model = load();
	(void)model;
	EXPECT_EQ( files(), 0u );
}

#ifdef LEEWAY_HULLS

TEST_F( IoCache, AReachIsFoundByItsRobotAndEffort )
{
	const Robot robot = buildRobot( load() );
	ReachOptions wanted;
	wanted.cache = options.cache;
	wanted.def.seconds = 0.5;
	wanted.def.samples = 50;
	wanted.build = false;
	EXPECT_FALSE( loadReach( robot, wanted ).reach );
	wanted.build = true;
	const LoadedReach built = loadReach( robot, wanted );
	EXPECT_FALSE( built.cached );
	ASSERT_TRUE( built.reach );
	const LoadedReach found = loadReach( robot, wanted );
	EXPECT_TRUE( found.cached );
	EXPECT_EQ( found.info.pairs, 6u );
	for ( std::uint32_t a = 0; a < 4; ++a )
	{
		for ( std::uint32_t b = 0; b < 4; ++b )
		{
			EXPECT_GE( lw_reach_get_pair( found.reach.get(), a, b ).separation,
			    lw_reach_get_pair( built.reach.get(), a, b ).separation );
		}
	}
	wanted.def.samples = 51;
	EXPECT_TRUE( loadReach( robot, wanted ).advanced ) << "fewer samples than asked for";
	EXPECT_EQ( loadReach( robot, wanted ).info.samples, 51u );
	wanted.def.samples = 20;
	EXPECT_EQ( loadReach( robot, wanted ).info.samples, 51u ) << "nothing is forgotten";
	wanted.def.seed = 7;
	wanted.proceed = false;
	EXPECT_TRUE( loadReach( robot, wanted ).cached ) << "whatever there is";
	wanted.proceed = true;
	EXPECT_FALSE( loadReach( robot, wanted ).cached ) << "other random states";
	// a pair allowed makes another robot, whose tables differ
	RobotModel other = load();
	other.disabled.push_back( { "one", "two", "" } );
	wanted.build = false;
	EXPECT_FALSE( loadReach( buildRobot( other ), wanted ).reach );
}

// A run that waits a second for proofs, and forgets them, makes the next one wait for the same.
TEST_F( IoCache, ProofsGoOnUntilTheyAreComplete )
{
	const Robot robot = buildRobot( load() );
	ReachOptions wanted;
	wanted.cache = options.cache;
	wanted.def.seconds = 0.01;
	wanted.def.samples = 300;
	int runs = 0;
	for ( bool complete = false; !complete; ++runs )
	{
		const LoadedReach loaded = loadReach( robot, wanted );
		ASSERT_TRUE( loaded.reach );
		EXPECT_EQ( loaded.cached, runs > 0 );
		EXPECT_TRUE( loaded.advanced );
		complete = loaded.info.complete && loaded.info.samples >= wanted.def.samples;
		const std::vector<CacheEntry> entries = listCache( options.cache );
		const auto kept = std::find_if(
		    entries.begin(), entries.end(), []( const CacheEntry& e ) { return e.kind == CacheEntry::reach; } );
		ASSERT_NE( kept, entries.end() );
		EXPECT_TRUE( kept->good );
		EXPECT_EQ( kept->proved, loaded.info.proved );
		EXPECT_EQ( kept->complete, loaded.info.complete );
		EXPECT_EQ( kept->seconds, loaded.info.seconds );
		ASSERT_LT( runs, 2000 );
	}
	const LoadedReach done = loadReach( robot, wanted );
	EXPECT_TRUE( done.cached );
	EXPECT_FALSE( done.advanced ) << "there is nothing left to prove";
	EXPECT_EQ( done.info.open, 0u );
}

// $HOME may be read-only, unset or relative; a cache must not be made in the current folder then.
TEST_F( IoCache, TheDefaultFolderIsWherePlatformsKeepCaches )
{
	const auto with = []( const char* caches, const char* home )
	{
		caches != nullptr ? setenv( "XDG_CACHE_HOME", caches, 1 ) : unsetenv( "XDG_CACHE_HOME" );
		home != nullptr ? setenv( "HOME", home, 1 ) : unsetenv( "HOME" );
		return defaultCacheFolder();
	};
	const char* old_home = std::getenv( "HOME" );
	const char* old_caches = std::getenv( "XDG_CACHE_HOME" );
	const std::string home = old_home != nullptr ? old_home : "", caches = old_caches != nullptr ? old_caches : "";
	EXPECT_EQ( with( "/a/b", "/h" ), "/a/b/leeway" );
	EXPECT_EQ( with( "", "/h" ), "/h/.cache/leeway" );
	EXPECT_EQ( with( "relative", "/h" ), "/h/.cache/leeway" );
	EXPECT_EQ( with( nullptr, "/h" ), "/h/.cache/leeway" );
	EXPECT_EQ( with( nullptr, "relative" ), "" );
	EXPECT_EQ( with( nullptr, nullptr ), "" );
	old_home != nullptr ? setenv( "HOME", home.c_str(), 1 ) : unsetenv( "HOME" );
	old_caches != nullptr ? setenv( "XDG_CACHE_HOME", caches.c_str(), 1 ) : unsetenv( "XDG_CACHE_HOME" );
	EXPECT_TRUE( isUsableCache( path( "new/deep" ) ) );
	EXPECT_FALSE( isUsableCache( "" ) );
	EXPECT_FALSE( isUsableCache( write( "file", "" ) ) );
	EXPECT_FALSE( isUsableCache( "/proc/leeway" ) );
}

TEST_F( IoCache, AProblemUsesItsOptions )
{
	const RobotModel model = load();
	ProblemOptions problem;
	const Problem plain = buildProblem( model, problem );
	EXPECT_FALSE( plain.reach.reach );
	problem.find_reach = ReachOptions();
	problem.find_reach->cache = options.cache;
	problem.find_reach->def.seconds = 0;
	problem.find_reach->def.samples = 10;
	const Problem built = buildProblem( model, problem );
	ASSERT_TRUE( built.reach.reach );
	EXPECT_FALSE( built.reach.cached );
	EXPECT_TRUE( buildProblem( model, problem ).reach.cached );
	// the checker keeps a hierarchy of its own for it
	EXPECT_GT( lw_checker_get_info( built.checker.get() ).bytes, lw_checker_get_info( plain.checker.get() ).bytes );
	problem.find_reach->cache.clear();
	problem.find_reach->build = false;
	problem.reach = built.reach.reach;
	EXPECT_EQ( buildProblem( model, problem ).reach.reach.get(), built.reach.reach.get() );
}

#else

TEST_F( IoCache, WithoutQhullAProblemHasNoReachAndANotice )
{
	ProblemOptions problem;
	problem.find_reach = ReachOptions();
	const Problem built = buildProblem( load(), problem );
	EXPECT_FALSE( built.reach.reach );
	EXPECT_NOTICE( built.notices, "motion hulls" );
}

#endif
