// SPDX-License-Identifier: BSD-3-Clause
// The experiment `plans` on one reach of the generated kitchen: paths are as promised, a bad one is noticed, and the log is
// one that ompl_benchmark_statistics.py reads.
#include "experiments/plans.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>

namespace fs = std::filesystem;

namespace
{

class NoProgress : public Progress
{
public:
	void at( double, const std::string& ) override {}
};

class Plans : public testing::Test
{
protected:
	void SetUp() override
	{
#ifndef LEEWAY_TEST_KITCHEN
		GTEST_SKIP() << "this build has no kitchen of its own";
#endif
		m_folder = fs::path( testing::TempDir() ) / ( "leeway_plans_" + std::to_string( ::getpid() ) );
	}
	void TearDown() override
	{
		fs::remove_all( m_folder );
	}

	Outcome run( const std::string& inject )
	{
		ExperimentSettings settings;
		settings.data.clear();
		settings.out = m_folder.string();
		settings.smoke = settings.quick = true;
		NoProgress progress;
		PlansSettings plans;
		plans.inject = inject;
		return makePlansExperiment( plans )->run( settings, progress );
	}

	fs::path m_folder;
};

/// The next line of a log, which must end like this. @return the number that it begins with
int count( std::istream& log, const std::string& ending )
{
	std::string line;
	std::getline( log, line );
	EXPECT_GE( line.size(), ending.size() ) << line;
	EXPECT_EQ( line.substr( line.size() - std::min( line.size(), ending.size() ) ), ending );
	return std::stoi( line );
}

} // namespace

TEST_F( Plans, ErrorOfAProofIsNotNoticed )
{
	const Outcome bad = run( "certified" );
	ASSERT_EQ( bad.claims.size(), 1u );
	EXPECT_EQ( bad.claims[0].verdict, Verdict::BROKEN );
	EXPECT_NE( bad.claims[0].why.find( "01_fridge, certified" ), std::string::npos ) << bad.claims[0].why;
}

// The log as ompl_benchmark_statistics.py goes through it, whose database Planner Arena shows.
TEST_F( Plans, PathIsNotAsPromisedOrLogIsNotReadable )
{
	const Outcome good = run( "" );
	ASSERT_EQ( good.claims.size(), 1u );
	EXPECT_EQ( good.claims[0].verdict, Verdict::HOLDS ) << good.claims[0].figure << ": " << good.claims[0].why;
	ASSERT_EQ( good.tables.size(), 1u );
	std::set<std::string> names;
	for ( const std::vector<Cell>& row : good.tables[0].rows )
	{
		EXPECT_TRUE( names.insert( std::get<std::string>( row[0] ) ).second ) << "two rows of one name";
		EXPECT_EQ( std::get<double>( row[2] ), 1 ) << "a run is missing";
	}
	EXPECT_GE( names.size(), 5u );
	EXPECT_NO_THROW( toJson( good ) );

	const fs::path file = m_folder / "plans-kitchen_01_fridge.log";
	std::ifstream log( file );
	ASSERT_TRUE( log ) << file;
	std::string line, word;
	std::getline( log, line );
	EXPECT_EQ( line.rfind( "OMPL version", 0 ), 0u ) << line;
	std::getline( log, line );
	EXPECT_EQ( line, "Experiment leeway_kitchen_01_fridge" ); // one word: the last one is taken
	const std::regex head( "[0-9]+ planners" );
	while ( std::getline( log, line ) && !std::regex_match( line, head ) )
	{
	}
	ASSERT_TRUE( log ) << "there is no list of planners";
	const int planners = std::stoi( line );
	EXPECT_GE( planners, 5 );
	for ( int i = 0; i < planners; ++i )
	{
		std::getline( log, line );
		EXPECT_EQ( line.find_first_not_of( "abcdefghijklmnopqrstuvwxyz_0123456789" ), std::string::npos ) << line;
		for ( int k = count( log, " common properties" ); k > 0; --k )
		{
			std::getline( log, line );
		}
		std::set<std::string> columns;
		const int properties = count( log, " properties for each run" );
		for ( int k = 0; k < properties; ++k )
		{
			std::getline( log, line );
			columns.insert( line );
			std::istringstream words( line );
			while ( words >> word )
			{
			}
			EXPECT_TRUE( word == "REAL" || word == "INTEGER" || word == "BOOLEAN" || word == "ENUM" ) << line;
		}
		for ( const char* ours : { "leeway edges INTEGER", "leeway min d REAL", "leeway step REAL", "time REAL" } )
		{
			EXPECT_EQ( columns.count( ours ), 1u ) << ours;
		}
		for ( int k = count( log, " runs" ); k > 0; --k )
		{
			std::getline( log, line );
			std::size_t values = 0;
			for ( std::size_t at = line.find( "; " ); at != std::string::npos; at = line.find( "; ", at + 1 ) )
			{
				++values;
			}
			EXPECT_EQ( values, static_cast<std::size_t>( properties ) ) << line;
		}
		std::getline( log, line );
		EXPECT_EQ( line, "." );
	}
}
