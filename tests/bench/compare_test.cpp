// SPDX-License-Identifier: BSD-3-Clause
// Two files of results side by side: change against noise, rows that belong together, verdicts that changed.
#include "support/compare.hpp"

#include <gtest/gtest.h>

namespace
{

Json timed( const char* robot, double mean, double lower = 0, double upper = 0 )
{
	Json row = { { "robot", robot }, { "mean_us", mean }, { "median_us", 2 * mean } };
	if ( upper > 0 )
	{
		row["lower_us"] = lower;
		row["upper_us"] = upper;
	}
	return row;
}

Json fileOf( const std::vector<Json>& rows )
{
	return { { "provenance", { { "processor", "x" } } }, { "options", { { "--seed", "1" } } }, { "rows", rows } };
}

Change changeOf( const Json& before, const Json& after, double threshold = 3 )
{
	CompareOptions options;
	options.threshold = threshold;
	const Comparison c = compare( fileOf( { before } ), fileOf( { after } ), options );
	EXPECT_EQ( c.differences.size(), 1u );
	return c.differences.at( 0 ).change;
}

Json judged( const char* edges, const char* verdicts )
{
	return { { "robot", "arm" }, { "judge", "certified" }, { "edges_hash", edges }, { "verdicts", verdicts } };
}

} // namespace

TEST( Compare, NoiseIsTakenForChange )
{
	EXPECT_EQ( changeOf( timed( "a", 10, 9, 11 ), timed( "a", 10.9, 10, 12 ) ), Change::NOISE ); // quartiles overlap
	const Json one = timed( "a", 10, 9.9, 10.05 ), other = timed( "a", 10.2, 10.1, 10.3 );
	EXPECT_EQ( changeOf( one, other ), Change::NOISE ); // below the threshold
	EXPECT_EQ( changeOf( one, other, 1 ), Change::WORSE );
	EXPECT_EQ( changeOf( timed( "a", 10 ), timed( "a", 20 ) ), Change::UNKNOWN ); // measured once
}

TEST( Compare, ChangeIsTakenForNoise )
{
	EXPECT_EQ( changeOf( timed( "a", 10, 9, 11 ), timed( "a", 13, 12, 14 ) ), Change::WORSE );
	EXPECT_EQ( changeOf( timed( "a", 13, 12, 14 ), timed( "a", 10, 9, 11 ) ), Change::BETTER );
}

TEST( Compare, BusyMachineIsTakenForASlowerProgram )
{
	std::vector<Json> before, after;
	for ( int i = 0; i < 30; ++i )
	{
		const std::string name = "row " + std::to_string( i );
		before.push_back( timed( name.c_str(), 10 + i, 9.99 + i, 10.01 + i ) );
		const double slower = ( i == 7 ? 1.5 : 1.2 ) * ( 1 + 0.001 * ( i % 3 ) );
		after.push_back( timed( name.c_str(), slower * ( 10 + i ), slower * ( 9.99 + i ), slower * ( 10.01 + i ) ) );
	}
	Comparison c = compare( fileOf( before ), fileOf( after ), {} );
	EXPECT_NEAR( c.drift, 1.2, 0.01 );
	EXPECT_EQ( c.count( Change::WORSE ), 1u );
	EXPECT_TRUE( c.isWorse() );
	CompareOptions absolute;
	absolute.absolute = true;
	c = compare( fileOf( before ), fileOf( after ), absolute );
	EXPECT_EQ( c.count( Change::WORSE ), 30u );
}

TEST( Compare, RatioIsNotTheGeometricMeanOfItsRobot )
{
	Json a = timed( "arm", 10 ), b = timed( "arm", 10 ), c = timed( "other", 10 );
	a["set"] = "near";
	b["set"] = "any";
	const Json before = fileOf( { a, b, c } );
	a["mean_us"] = 20;
	b["mean_us"] = 80;
	const Comparison comparison = compare( before, fileOf( { c, b, a } ), {} ); // rows are matched by name
	const auto ratios = ratiosOf( comparison );
	EXPECT_NEAR( ratios.at( { "", "arm" } ).mean, 4, 1e-12 );
	EXPECT_NEAR( ratios.at( { "", "other" } ).mean, 1, 1e-12 );
	EXPECT_NEAR( ratios.at( { "", "" } ).mean, std::cbrt( 16 ), 1e-12 );
	EXPECT_NEAR( ratios.at( { "", "arm" } ).most, 8, 1e-12 );
	CompareOptions by;
	by.by = "median_us";
	EXPECT_NEAR( ratiosOf( compare( before, fileOf( { a, b, c } ), by ) ).at( { "", "" } ).mean, 1, 1e-12 );
}

TEST( Compare, TimesOfTwoContendersAreMixed )
{
	const Json part = { { "mean_us", 10 } }, slower = { { "mean_us", 30 } };
	const Json before = { { "robot", "arm" }, { "certified", part }, { "fcl", part } };
	const Json after = { { "robot", "arm" }, { "certified", part }, { "fcl", slower } };
	const auto ratios = ratiosOf( compare( fileOf( { before } ), fileOf( { after } ), {} ) );
	EXPECT_NEAR( ratios.at( { "certified", "" } ).mean, 1, 1e-12 );
	EXPECT_NEAR( ratios.at( { "fcl", "" } ).mean, 3, 1e-12 );
}

TEST( Compare, ChangedVerdictGoesUnsaid )
{
	Comparison c = compare( fileOf( { judged( "1", "FFBU" ) } ), fileOf( { judged( "1", "FUBF" ) } ), {} );
	EXPECT_EQ( c.verdicts, 4u );
	ASSERT_EQ( c.answers.size(), 2u );
	EXPECT_EQ( c.answers[0].what, "edge 1" );
	EXPECT_EQ( c.answers[0].before, "FREE" );
	EXPECT_EQ( c.answers[0].after, "UNDECIDED" );
	EXPECT_FALSE( c.isWorse() );
	c = compare( fileOf( { judged( "1", "FFBU" ) } ), fileOf( { judged( "1", "FBBU" ) } ), {} );
	EXPECT_TRUE( c.isWorse() ); // free and blocked
	EXPECT_NE( comparisonText( c, false ).find( "1 of 4 changed, 1 contradict" ), std::string::npos );
	c = compare( fileOf( { judged( "1", "FFBU" ) } ), fileOf( { judged( "1", "FFBU" ) } ), {} );
	EXPECT_TRUE( c.answers.empty() );
	EXPECT_EQ( c.verdicts, 4u );
}

TEST( Compare, VerdictsOfOtherEdgesAreCompared )
{
	const Comparison c = compare( fileOf( { judged( "1", "FF" ) } ), fileOf( { judged( "2", "BB" ) } ), {} );
	EXPECT_EQ( c.verdicts, 0u );
	EXPECT_TRUE( c.answers.empty() );
	EXPECT_EQ( c.notes.size(), 1u );
}

TEST( Compare, OtherMachineOtherWorkOrAnswerGoesUnsaid )
{
	Json before = fileOf( { timed( "a", 1 ), timed( "b", 1 ) } ), after = fileOf( { timed( "a", 1 ), timed( "c", 1 ) } );
	after["provenance"]["processor"] = "y";
	after["options"]["--seed"] = "2";
	const Comparison c = compare( before, after, {} );
	ASSERT_EQ( c.notes.size(), 3u );
	EXPECT_NE( c.notes[0].find( "processor" ), std::string::npos );
	EXPECT_NE( c.notes[1].find( "--seed" ), std::string::npos );
	EXPECT_NE( c.notes[2].find( "1 rows are in the first file only, 1 in the second" ), std::string::npos );
	before["rows"][0]["answers_hash"] = "1";
	after["rows"][0]["answers_hash"] = "2";
	ASSERT_EQ( compare( before, after, {} ).answers.size(), 1u );
}

TEST( Compare, FileOfAnotherKindIsReadAsOne )
{
	EXPECT_THROW( compare( Json::array(), fileOf( {} ), {} ), std::runtime_error );
	EXPECT_THROW( compare( fileOf( {} ), { { "rows", 1 } }, {} ), std::runtime_error );
}
