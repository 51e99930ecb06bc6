// SPDX-License-Identifier: BSD-3-Clause
// Shapes and motion hulls kept between loads: what makes another file, and what is told again.
#include "files.hpp"

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
	RobotModel load() { return loadRobot( path( "r.urdf" ), "", options ); }
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
	const RobotModel cold = load(), warm = load();
	EXPECT_EQ( cachedShapes( cold ), 0u );
	EXPECT_EQ( cachedShapes( warm ), 3u ); // a, b, half of b; the other b is shared, the box is built
	EXPECT_EQ( cold.report.cache_file, warm.report.cache_file );
	EXPECT_NE( fs::path( warm.report.cache_file ).filename().string().find( "cached_robot-" ), std::string::npos );
	EXPECT_GT( warm.report.cache_milliseconds, 0 );
	EXPECT_EQ( files(), 1u );
	ASSERT_EQ( cold.links.size(), warm.links.size() );
	for ( std::size_t i = 0; i < cold.links.size(); ++i )
	{
		ASSERT_EQ( cold.links[i].collision.size(), warm.links[i].collision.size() );
		for ( std::size_t k = 0; k < cold.links[i].collision.size(); ++k )
		{
			EXPECT_TRUE( lw_digest_equal( lw_shape_digest( cold.links[i].collision[k].shape.get() ),
			    lw_shape_digest( warm.links[i].collision[k].shape.get() ) ) )
			    << cold.links[i].name;
			EXPECT_EQ( lw_shape_validate( warm.links[i].collision[k].shape.get(), nullptr ), LW_OK );
		}
		EXPECT_EQ( cold.report.shapes[i].shared, warm.report.shapes[i].shared );
	}
	EXPECT_TRUE( warm.report.notices.empty() ) << allNotices( warm.report.notices );
	EXPECT_EQ( warm.links[1].collision[0].shape.get(), warm.links[2].collision[0].shape.get() ) << "shared";
}

TEST_F( IoCache, OptionsAndFilesThatMatterMakeAnotherFile )
{
	const std::string first = load().report.cache_file;
	EXPECT_EQ( load().report.cache_file, first );
	const auto differs = [&]( const char* what )
	{
		const RobotModel model = load();
		EXPECT_NE( model.report.cache_file, first ) << what;
		EXPECT_EQ( cachedShapes( model ), 0u ) << what;
	};
	options.tree.leaf_size = options.tree.leaf_size == 4 ? 2 : 4;
	differs( "leaf size" );
	options.tree = lw_tree_def_default();
	options.tree.fit = options.tree.fit == LW_FIT_MINIMAL ? LW_FIT_GREEDY : LW_FIT_MINIMAL;
	differs( "fit" );
	options.tree = lw_tree_def_default();
	options.weld_tolerance = 1e-3;
	differs( "weld tolerance" );
	options.weld_tolerance = 0;
	options.use_visual = true;
	differs( "visual" );
	options.use_visual = false;
	writeTetrahedron( "b.obj", 0.11 );
	differs( "a mesh" );
	writeTetrahedron( "b.obj", 0.1 );
	EXPECT_EQ( load().report.cache_file, first );
	writeUrdf( "<!-- changed -->" );
	differs( "the URDF" );
}

TEST_F( IoCache, FacesThatWereLeftOutAreToldEachTime )
{
	write( "a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\nf 1 3 4\nf 2 3 4\nl 1 2\n" );
	const RobotModel cold = load(), warm = load();
	EXPECT_EQ( cachedShapes( warm ), 3u );
	EXPECT_NOTICE( cold.report.notices, "have no surface" );
	EXPECT_NOTICE( warm.report.notices, "have no surface" );
	EXPECT_EQ( cold.report.notices.size(), warm.report.notices.size() );
}

TEST_F( IoCache, WordsBesideTheBlobAreCheckedToo )
{
	const std::string file = load().report.cache_file;
	std::ifstream stream( file, std::ios::binary );
	const std::string good( std::istreambuf_iterator<char>( stream ), {} );
	// the file ends with a word for each shape, their count and a digest
	for ( const std::size_t from_end : { 1u, 16u, 24u, 25u, 48u } )
	{
		std::string bad = good;
		bad[bad.size() - from_end] = static_cast<char>( bad[bad.size() - from_end] ^ 4 );
		std::ofstream( file, std::ios::binary ) << bad;
		const RobotModel model = load();
		EXPECT_EQ( cachedShapes( model ), 0u ) << from_end;
		EXPECT_NOTICE( model.report.notices, "built anew" );
		EXPECT_EQ( cachedShapes( load() ), 3u ) << "replaced";
	}
}

TEST_F( IoCache, AMissingMeshIsTheSameError )
{
	load();
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
	EXPECT_EQ( model.report.cache_file, "" );
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
	EXPECT_EQ( found.seconds_spent, 0.5 );
	for ( std::uint32_t a = 0; a < 4; ++a )
	{
		for ( std::uint32_t b = 0; b < 4; ++b )
		{
			EXPECT_EQ( lw_reach_get_pair( found.reach.get(), a, b ).separation,
			    lw_reach_get_pair( built.reach.get(), a, b ).separation );
		}
	}
	wanted.accept_less = false;
	EXPECT_TRUE( loadReach( robot, wanted ).cached );
	wanted.def.samples = 51;
	EXPECT_FALSE( loadReach( robot, wanted ).cached ) << "fewer samples than asked for";
	wanted.def.samples = 50;
	wanted.def.seconds = 0.25;
	EXPECT_TRUE( loadReach( robot, wanted ).cached );
	wanted.accept_less = true;
	wanted.def.seconds = 100;
	EXPECT_TRUE( loadReach( robot, wanted ).cached ) << "whatever there is";
	// a pair allowed makes another robot, whose tables differ
	RobotModel other = load();
	other.disabled.push_back( { "one", "two", "" } );
	wanted.build = false;
	EXPECT_FALSE( loadReach( buildRobot( other ), wanted ).reach );
}

TEST_F( IoCache, AProblemUsesWhatItIsTold )
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
