// SPDX-License-Identifier: BSD-3-Clause
// --cache: the same answers, faster; files that are damaged, stale or cannot be written.
#include "pairs_fixture.hpp"
#include "seeded_rng.hpp"

#include <algorithm>
#include <filesystem>
#include <sys/stat.h>
#include <unistd.h>
#include <fstream>
#include <tuple>

namespace fs = std::filesystem;

class Cache : public Pairs
{
protected:
	/// The files in the cache with this ending.
	std::vector<fs::path> cached( const std::string& ending ) const
	{
		std::vector<fs::path> result;
		for ( const fs::directory_entry& entry : fs::directory_iterator( path( "cache" ) ) )
		{
			if ( entry.path().extension() == ending )
			{
				result.push_back( entry.path() );
			}
		}
		return result;
	}
	fs::path only( const std::string& ending ) const
	{
		const std::vector<fs::path> all = cached( ending );
		EXPECT_EQ( all.size(), 1u ) << ending;
		return all.empty() ? fs::path() : all[0];
	}
	/// The table of a run, without times. Of several pairs in contact any one may be named.
	static std::string withoutTime( const Outcome& result )
	{
		std::string text;
		for ( std::map<std::string, std::string> row : parseTable( result.out ).rows )
		{
			row.erase( "microseconds" );
			if ( row["env_upper"] == "0" )
			{
				row["env_link"] = row["env_object"] = "any";
			}
			if ( row["self_upper"] == "0" )
			{
				row["self_link1"] = row["self_link2"] = "any";
			}
			for ( const auto& [column, cell] : row )
			{
				text += column + "=" + cell + " ";
			}
			text += "\n";
		}
		return text;
	}
	/// The lines of a table about motions; the ways of their proofs may differ.
	static std::string verdicts( const Outcome& result )
	{
		std::string text;
		for ( const auto& row : parseTable( result.out ).rows )
		{
			text += row.at( "verdict" ) + " " + row.at( "pair" ) + "\n";
		}
		return text;
	}
	Outcome check( const std::vector<std::string>& more = { "--cache", "cache" } ) const
	{
		std::vector<std::string> arguments = { "--group", "arm", "--states", "states.csv" };
		arguments.insert( arguments.end(), more.begin(), more.end() );
		return runModel( "check", arguments );
	}
	/// Changes one byte in the middle.
	static void damage( const fs::path& file )
	{
		std::string bytes = readFile( file.string() );
		bytes.at( bytes.size() / 2 ) = static_cast<char>( ~bytes.at( bytes.size() / 2 ) );
		std::ofstream( file, std::ios::binary ) << bytes;
	}
};

TEST_F( Cache, AnswersAreTheSameWithAndWithout )
{
	const std::string plain = withoutTime( check( { "--no-cache" } ) );
	ASSERT_FALSE( plain.empty() );
	const Outcome cold = check();
	EXPECT_EQ( withoutTime( cold ), plain ) << cold.err;
	const Outcome warm = check();
	EXPECT_EQ( withoutTime( warm ), plain ) << warm.err;
	EXPECT_FALSE( contains( warm.err, "notice" ) ) << warm.err;
	EXPECT_EQ( cached( ".tree" ).size() + cached( ".reach" ).size(), 2u );
	EXPECT_EQ( std::distance( fs::directory_iterator( path( "cache" ) ), fs::directory_iterator() ), 2 );
}

TEST_F( Cache, EdgesPlansAndAuditsReadItToo )
{
	const std::vector<std::string> edge = { "--group", "arm", "--edges", "edges.csv" };
	std::vector<std::string> none = edge;
	none.push_back( "--no-cache" );
	const std::string plain = verdicts( runModel( "edge", none ) );
	ASSERT_FALSE( plain.empty() );
	std::vector<std::string> with = edge;
	with.insert( with.end(), { "--cache", "cache" } );
	EXPECT_EQ( verdicts( runModel( "edge", with ) ), plain );
	EXPECT_EQ( verdicts( runModel( "edge", with ) ), plain );
	const Outcome plan =
	    runModel( "plan", { "--request", "request.yaml", "--out", "path.yaml", "--cache", "cache" }, "blocked.yaml" );
	EXPECT_EQ( plan.status, 0 ) << plan.err;
	const Outcome audit = runModel( "audit", { "--path", "path.yaml", "--cache", "cache" }, "blocked.yaml" );
	EXPECT_EQ( audit.status, 0 ) << audit.out << audit.err;
	EXPECT_EQ( cached( ".tree" ).size(), 1u );
	EXPECT_EQ( cached( ".reach" ).size(), 1u );
}

TEST_F( Cache, InfoNamesThePartsFromIt )
{
	check();
	const Outcome result = runModel( "info", { "--group", "arm", "--cache", "cache", "--json", "info.json" } );
	ASSERT_EQ( result.status, 0 ) << result.err;
	const nlohmann::json info = json( "info.json" );
	std::size_t from_cache = 0;
	for ( const nlohmann::json& shape : info["robot"]["shapes"] )
	{
		from_cache += shape["cached"] ? 1 : 0;
		EXPECT_EQ( shape["cached"], shape["source"] == "mesh fore.stl" ) << shape;
	}
	EXPECT_EQ( from_cache, 1u );
	EXPECT_EQ( info["pair_classes"]["adjacent"], 2 );
	EXPECT_TRUE( info["hierarchy"]["cached"] );
	EXPECT_EQ( info["hierarchy"]["links"].size(), 5u );
	EXPECT_TRUE( contains( result.out, "from the cache" ) ) << result.out;
}

TEST_F( Cache, InfoShowsTheHierarchyWithoutOneAndBuildsNoTables )
{
	const Outcome result = runModel( "info", { "--json", "info.json" } );
	ASSERT_EQ( result.status, 0 ) << result.err;
	const nlohmann::json info = json( "info.json" );
	EXPECT_FALSE( info["hierarchy"]["cached"] );
	EXPECT_TRUE( info["pair_classes"].is_null() );
	const nlohmann::json& fore = info["hierarchy"]["links"][2];
	EXPECT_EQ( fore["link"], "fore" );
	EXPECT_EQ( fore["joint"], "elbow" );
	EXPECT_EQ( fore["joint_type"], "revolute" );
	EXPECT_EQ( fore["depth"], 2 );
	EXPECT_GT( fore["m"]["radius"], fore["r"]["radius"] );
	EXPECT_GT( fore["hull_points"], 8 );
	EXPECT_TRUE( info["hierarchy"]["links"][4]["r"].is_null() ) << "the finger has no geometry";
	const Outcome empty = runModel( "info", { "--cache", "cache" } );
	EXPECT_EQ( empty.status, 0 );
	EXPECT_TRUE( contains( empty.out, "no pair tables in the cache yet" ) ) << empty.out;
	EXPECT_TRUE( cached( ".reach" ).empty() );
}

TEST_F( Cache, DamagedFilesAreToldAndReplaced )
{
	const std::string plain = withoutTime( check() );
	for ( const char* ending : { ".tree", ".reach" } )
	{
		const fs::path file = only( ending );
		const std::string good = readFile( file.string() );
		damage( file );
		const Outcome damaged = check();
		EXPECT_EQ( withoutTime( damaged ), plain ) << damaged.err;
		EXPECT_TRUE( contains( damaged.err, "notice: " + ( fs::path( "cache" ) / file.filename() ).string() ) )
		    << damaged.err;
		EXPECT_EQ( readFile( file.string() ).size(), good.size() ) << ending;
		std::ofstream( file, std::ios::binary ) << good.substr( 0, good.size() - 100 );
		EXPECT_TRUE( contains( check().err, "built anew" ) ) << ending << " cut short";
		std::ofstream( file, std::ios::binary ) << good << "x";
		EXPECT_TRUE( contains( check().err, "built anew" ) ) << ending << " with a byte more";
		std::ofstream( file, std::ios::binary ) << "";
		EXPECT_TRUE( contains( check().err, "built anew" ) ) << ending << " empty";
		EXPECT_FALSE( contains( check().err, "notice" ) ) << ending << " replaced";
	}
}

/// Bits, cuts, bytes moved, entries of each other: the answers of states and motions stay, and the entry is built anew.
TEST_F( Cache, ADamagedEntryChangesAnAnswer )
{
	const std::vector<std::string> motions = { "--group", "arm", "--edges", "edges.csv", "--cache", "cache" };
	const std::string plain = withoutTime( check( { "--no-cache" } ) ), proved = verdicts( runModel( "edge", motions ) );
	ASSERT_EQ( withoutTime( check() ), plain );
	const fs::path files[2] = { only( ".tree" ), only( ".reach" ) };
	const std::string good[2] = { readFile( files[0].string() ), readFile( files[1].string() ) };
	SeededRng rng;
	int rebuilt = 0;
	for ( int i = 0; i < 60; ++i )
	{
		for ( int k = 0; k < 2; ++k )
		{
			std::string bytes = good[k];
			const auto place = [&]
			{ return static_cast<std::size_t>( rng.integer( 0, static_cast<int>( bytes.size() ) - 1 ) ); };
			const std::size_t at = place(), other = place();
			switch ( i % 6 )
			{
			case 0:
				bytes.resize( at );
				break;
			case 1:
				std::swap( bytes[at], bytes[other] );
				break;
			case 2:
				bytes.replace( at, 8, std::string( 8, '\xff' ) );
				break;
			case 3:
				bytes = good[1 - k];
				break;
			default:
				for ( int flips = rng.integer( 1, 4 ); flips > 0; --flips )
				{
					const std::size_t byte = place();
					bytes[byte] = static_cast<char>( bytes[byte] ^ ( 1 << rng.integer( 0, 7 ) ) );
				}
			}
			std::ofstream( files[k], std::ios::binary ) << bytes;
			rebuilt += bytes != good[k] ? 1 : 0;
		}
		const Outcome outcome = i % 10 == 9 ? runModel( "edge", motions ) : check();
		EXPECT_EQ( i % 10 == 9 ? verdicts( outcome ) : withoutTime( outcome ), i % 10 == 9 ? proved : plain ) << outcome.err;
		for ( const fs::path& file : files )
		{
			rebuilt -= contains( outcome.err, file.filename().string() + ": cache: not used" ) ? 1 : 0;
		}
	}
	EXPECT_EQ( rebuilt, 0 ) << "damaged entries that were used";
}

TEST_F( Cache, EntriesThatAreNoRegularFilesAreReplacedAndNotWaitedFor )
{
	const std::string plain = withoutTime( check() );
	for ( const char* ending : { ".tree", ".reach" } )
	{
		const fs::path file = only( ending );
		for ( const bool link : { false, true } )
		{
			fs::remove( file );
			ASSERT_EQ( link ? ::symlink( "/dev/zero", file.c_str() ) : ::mkfifo( file.c_str(), 0600 ), 0 );
			const Outcome outcome = check();
			EXPECT_EQ( withoutTime( outcome ), plain ) << outcome.err;
			EXPECT_TRUE( contains( outcome.err, "no regular file" ) ) << outcome.err;
			EXPECT_TRUE( fs::is_regular_file( fs::symlink_status( file ) ) ) << ending << " is not replaced";
		}
	}
}

TEST_F( Cache, AFileOfAnotherRobotUnderThisNameIsStale )
{
	check();
	const fs::path trees = only( ".tree" ), reach = only( ".reach" );
	const std::string old_trees = readFile( trees.string() ), old_reach = readFile( reach.string() );
	edit( "fore.stl", "vertex 0.4", "vertex 0.45" );
	const std::string plain = withoutTime( check( {} ) );
	EXPECT_EQ( withoutTime( check() ), plain );
	ASSERT_EQ( cached( ".tree" ).size(), 2u );
	for ( const auto& [ending, old, content] :
	    { std::tuple( ".tree", trees, old_trees ), std::tuple( ".reach", reach, old_reach ) } )
	{
		for ( const fs::path& file : cached( ending ) )
		{
			if ( file != old )
			{
				std::ofstream( file, std::ios::binary ) << content;
			}
		}
		const Outcome result = check();
		EXPECT_EQ( withoutTime( result ), plain ) << ending;
		EXPECT_TRUE( contains( result.err, "built anew" ) ) << ending << result.err;
	}
}

TEST_F( Cache, AChangedMeshIsSeen )
{
	const std::string before = withoutTime( check() );
	edit( "fore.stl", "vertex 0.4", "vertex 0.45" );
	const std::string plain = withoutTime( check( {} ) );
	ASSERT_NE( plain, before );
	EXPECT_EQ( withoutTime( check() ), plain );
}

TEST_F( Cache, AFileThatCannotBeReplacedCostsOnlyTime )
{
	check();
	for ( const char* ending : { ".tree", ".reach" } )
	{
		const fs::path file = only( ending );
		fs::remove( file );
		fs::create_directories( file / "full" ); // a folder that is not empty cannot be renamed over
	}
	const Outcome result = check();
	EXPECT_EQ( withoutTime( result ), withoutTime( check( {} ) ) );
	EXPECT_TRUE( contains( result.err, "cannot be written" ) ) << result.err;
	EXPECT_EQ( std::distance( fs::directory_iterator( path( "cache" ) ), fs::directory_iterator() ), 2 )
	    << "temporary files are left";
}

TEST_F( Cache, PairsKeepsItsTablesForALaterRun )
{
	const Outcome first = pairs( { "--cache", "cache", "--json", "first.json" } );
	EXPECT_TRUE( contains( first.out, "tables built" ) ) << first.out;
	const Outcome second = pairs( { "--cache", "cache", "--json", "second.json" } );
	const bool complete = json( "first.json" )["complete"];
	EXPECT_TRUE( contains( second.out, complete ? "of earlier runs read" : "of earlier runs continued" ) ) << second.out;
	if ( complete )
	{
		EXPECT_EQ( json( "first.json" )["pairs"], json( "second.json" )["pairs"] );
	}
	EXPECT_TRUE( contains( pairs( { "--cache", "cache", "--seed", "7" } ).out, "tables built" ) );
	EXPECT_TRUE( contains(
	    run( { "pairs", "--robot", "many.urdf", "--cache", "cache", "--budget", "0", "--samples", "100", "--seed", "7" } )
	        .out,
	    "of earlier runs read" ) );
}

TEST_F( Cache, WithoutAnOptionItIsWherePlatformsKeepCaches )
{
	const auto kept = [&]( const char* ending )
	{
		std::size_t count = 0;
		for ( const fs::directory_entry& entry : fs::directory_iterator( path( ".caches/leeway" ) ) )
		{
			count += entry.path().extension() == ending ? 1 : 0;
		}
		return count;
	};
	const std::string plain = withoutTime( check( { "--no-cache" } ) );
	EXPECT_FALSE( fs::exists( path( ".caches" ) ) ) << "--no-cache keeps nothing";
	EXPECT_TRUE( contains( run( { "cache" } ).out, "there is no cache yet" ) );
	EXPECT_EQ( withoutTime( check( {} ) ), plain );
	EXPECT_EQ( kept( ".reach" ), 1u );
	EXPECT_EQ( kept( ".tree" ), 1u );
	const Outcome list = run( { "cache" } );
	EXPECT_EQ( list.status, 0 ) << list.err;
	EXPECT_TRUE( contains( list.out, ".caches/leeway" ) && contains( list.out, "pairs proved" ) ) << list.out;
	const Outcome info = runModel( "info", { "--group", "arm" } );
	EXPECT_TRUE( contains( info.out, "are proved to stay apart" ) ) << info.out;
	EXPECT_TRUE( contains( info.out, "proofs are" ) ) << info.out;
	EXPECT_EQ( run( { "cache", "--clean" } ).status, 0 );
	EXPECT_EQ( kept( ".reach" ), 0u );
	for ( const char* option : { "--cache", "--cache-limit", "--proofs" } )
	{
		EXPECT_EQ( check( { "--no-cache", option, "5" } ).status, 2 ) << option;
	}
	EXPECT_EQ( check( { "--proofs", "-1" } ).status, 2 );
}

// A read-only or missing home must not stop a run.
TEST_F( Cache, AHomeThatCannotBeWrittenIsANotice )
{
	write( ".caches", "a file where the folder of caches would be" );
	const Outcome quiet = check( {} );
	EXPECT_EQ( withoutTime( quiet ), withoutTime( check( { "--no-cache" } ) ) );
	EXPECT_FALSE( contains( quiet.err, "cannot be written" ) ) << quiet.err;
	const Outcome told = check( { "--verbose" } );
	EXPECT_TRUE( contains( told.err, "cannot be written" ) ) << told.err;
}

TEST_F( Cache, TablesMissTheHeldObject )
{
	const std::string attached =
	    "robot_state:\n  attached_collision_objects:\n    - link_name: tool\n      object:\n"
	    "        id: cup\n        primitives:\n          - {type: box, dimensions: [0.02, 0.02, 0.02]}\n"
	    "        primitive_poses:\n          - {position: [0.05, 0, 0], orientation: [0, 0, 0, 1]}\n"
	    "      touch_links: [fore]\n";
	write( "scene.yaml", readFile( path( "scene.yaml" ) ) + attached );
	const Outcome plain = check( {} );
	const Outcome first = check( { "--cache", "cache" } ), second = check( { "--cache", "cache" } );
	EXPECT_EQ( withoutTime( first ), withoutTime( plain ) ) << first.err;
	EXPECT_EQ( withoutTime( second ), withoutTime( plain ) ) << second.err;
	EXPECT_FALSE( cached( ".reach" ).empty() ) << "the robot without the cup has tables";
}

TEST_F( Cache, StatesBeyondTheLimitsHaveTheSameAnswer )
{
	write( "states.csv", "shoulder,elbow\n1.9,2.79\n2.5,-3.1\n-2.5,3.14\n2.0001,2.8001\n" );
	check();
	EXPECT_EQ( withoutTime( check() ), withoutTime( check( {} ) ) );
}

class CacheData : public Cache
{
protected:
	void SetUp() override
	{
		Cache::SetUp();
		if ( !fs::exists( LEEWAY_DATA_DIR "/README.md" ) )
		{
			GTEST_SKIP() << "no data in " LEEWAY_DATA_DIR;
		}
	}
};

TEST_F( CacheData, ArmarStatesHaveTheSameRows )
{
	const std::string data = LEEWAY_DATA_DIR "/", armar = data + "armar3/armar3";
	std::vector<std::string> arguments = { "check", "--robot", armar + "_convex.urdf", "--srdf", armar + ".srdf", "--scene",
	    data + "kit_kitchen/scene_cluttered.yaml", "--group", "torso_both_arms", "--states",
	    data + "armar3/groundtruth/groundtruth_armar3_scene_cluttered_parked.csv" };
	const std::string plain = withoutTime( run( arguments ) );
	ASSERT_EQ( std::count( plain.begin(), plain.end(), '\n' ), 700 );
	arguments.insert( arguments.end(), { "--cache", "cache" } );
	EXPECT_EQ( withoutTime( run( arguments ) ), plain ) << "built";
	EXPECT_EQ( withoutTime( run( arguments ) ), plain ) << "read";
}
