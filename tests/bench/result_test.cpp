// SPDX-License-Identifier: BSD-3-Clause
// The file of results and the timing behind it: fields, quartiles, turns of contenders.
#include "support/race.hpp"
#include "support/result.hpp"
#include "support/temporary_folder.hpp"

#include <fstream>
#include <gtest/gtest.h>

TEST( Result, FieldIsLostOnItsWayThroughAFile )
{
	Result result( "edges" );
	result["options"] = { { "--seed", "1" } };
	result.add( { { "robot", "a, \"b\"" }, { "certified", { { "mean_us", 1.5 } } }, { "list", { 1, 2 } } } );
	result.add( { { "robot", "c" }, { "edges", 7 } } );
	EXPECT_EQ( result.csv(), "robot,certified.mean_us,edges\n\"a, \"\"b\"\"\",1.5,\nc,,7\n" );
	const TemporaryFolder folder;
	const std::string file = ( folder.path() / "result.json" ).string();
	result.writeJson( file );
	std::ifstream in( file );
	const Json read = Json::parse( in );
	EXPECT_EQ( read.at( "command" ), "edges" );
	EXPECT_EQ( read.at( "options" ).at( "--seed" ), "1" );
	EXPECT_EQ( read.at( "rows" ), result.rows() );
	EXPECT_TRUE( read.at( "provenance" ).contains( "commit" ) );
	EXPECT_THROW( result.writeJson( ( folder.path() / "none" / "r.json" ).string() ), std::runtime_error );
}

TEST( Race, ContenderIsAskedOtherQuestionsThanTheRest )
{
	std::vector<std::vector<double>> asked( 2 );
	std::vector<Contender> contenders;
	for ( std::size_t c = 0; c < 2; ++c )
	{
		contenders.push_back( { "c", [&asked, c]( const double* q )
		    {
			    asked[c].push_back( *q );
			    return Answer{ *q, *q };
		    } } );
	}
	const auto runs = race( contenders, { "s", "", { { 1 }, { 2 }, { 3 } } }, 4, 2 );
	EXPECT_EQ( asked[0].size(), 12u );
	EXPECT_EQ( asked[0], asked[1] );
	ASSERT_EQ( runs[1].answers.size(), 3u );
	EXPECT_EQ( runs[1].answers[2].upper, 3 );
	ASSERT_EQ( runs[0].passes.size(), 3u );
	EXPECT_EQ( runs[0].passes[0].size(), 4u );
}

TEST( Race, QuartilesAreNotThoseOfTheMeanOfEachPass )
{
	::Run run;
	run.microseconds = { 3, 30 };
	run.passes = { { 1, 2, 3, 4, 5 }, { 10, 20, 30, 40, 50 } };
	const Summary both = summarise( run ), second = summarise( run, { 1 } );
	EXPECT_DOUBLE_EQ( both.mean, 16.5 );
	EXPECT_DOUBLE_EQ( both.lower, 11 ); // of 5.5, 11, 16.5, 22, 27.5
	EXPECT_DOUBLE_EQ( both.upper, 22 );
	EXPECT_DOUBLE_EQ( second.lower, 20 );
	run.passes = { { 1 }, { 10 } };
	EXPECT_EQ( summarise( run ).upper, 0 ); // one pass has none
	EXPECT_FALSE( toJson( summarise( run ) ).contains( "lower_us" ) );
	EXPECT_EQ( rounded( 1234567 ), 1234600 );
	EXPECT_EQ( rounded( 0.00123456 ), 0.0012346 );
	EXPECT_EQ( rounded( 0 ), 0 );
}
