// SPDX-License-Identifier: BSD-3-Clause
// Verdicts on two results: change against noise, rows that belong together, results that do not.
#include "report/compare.hpp"

#include <gtest/gtest.h>

namespace
{

Report reportOf( const std::vector<std::vector<Cell>>& rows, int better = -1 )
{
	Outcome outcome;
	outcome.name = "paper";
	outcome.tables.push_back(
	    { "times", "", "", { { "what", "" }, { "max_d", "mm" }, { "time", "us", better }, { "count", "" } }, rows } );
	return { { { "processor", "x" }, { "quick", false } }, { outcome } };
}

std::vector<Cell> row( const std::string& what, double max_d, const Cell& time )
{
	return { what, max_d, time, 7.0 };
}

Change changeOf( const Measure& before, const Measure& after, double threshold = 3, int better = -1 )
{
	const Comparison c = compare(
	    reportOf( { row( "self", 10, before ) }, better ), reportOf( { row( "self", 10, after ) }, better ), threshold );
	EXPECT_EQ( c.differences.size(), 1u );
	return c.differences.at( 0 ).change;
}

} // namespace

TEST( Compare, NoiseIsTakenForChange )
{
	EXPECT_EQ( changeOf( { 10, 9, 11, 9 }, { 10.9, 10, 12, 9 } ), Change::NOISE );          // quartiles overlap
	EXPECT_EQ( changeOf( { 10, 9.9, 10.05, 9 }, { 10.2, 10.1, 10.3, 9 } ), Change::NOISE ); // below the threshold
	EXPECT_EQ( changeOf( { 10, 9.9, 10.05, 9 }, { 10.2, 10.1, 10.3, 9 }, 1 ), Change::WORSE );
}

TEST( Compare, ChangeIsTakenForNoise )
{
	EXPECT_EQ( changeOf( { 10, 9, 11, 9 }, { 13, 12, 14, 9 } ), Change::WORSE );
	EXPECT_EQ( changeOf( { 13, 12, 14, 9 }, { 10, 9, 11, 9 } ), Change::BETTER );
	const double inf = std::numeric_limits<double>::infinity();
	EXPECT_EQ( changeOf( { 13, 12, 14, 9 }, { inf, inf, inf, 9 } ), Change::WORSE );
	EXPECT_EQ( changeOf( { 0, 0, 0, 9 }, { 1, 1, 1, 9 } ), Change::WORSE );
	EXPECT_EQ( changeOf( { inf, inf, inf, 9 }, { inf, inf, inf, 9 } ), Change::NOISE );
}

TEST( Compare, MoreIsAlwaysWorse )
{
	EXPECT_EQ( changeOf( { 10, 9, 11, 9 }, { 13, 12, 14, 9 }, 3, 1 ), Change::BETTER );
	EXPECT_EQ( changeOf( { 13, 12, 14, 9 }, { 10, 9, 11, 9 }, 3, 1 ), Change::WORSE );
}

TEST( Compare, FigureWithoutSpreadIsCalledWorse )
{
	const Comparison c = compare( reportOf( { row( "self", 10, 5.0 ) } ), reportOf( { row( "self", 10, 6.0 ) } ), 3 );
	ASSERT_EQ( c.differences.size(), 1u );
	EXPECT_EQ( c.differences[0].change, Change::OTHER );
	EXPECT_NEAR( c.differences[0].percent, 20, 1e-9 );
}

TEST( Compare, RowsAreMatchedByTheirPlace )
{
	const Measure five = { 5, 4.9, 5.1, 9 }, nine = { 9, 8.9, 9.1, 9 };
	const Comparison c = compare( reportOf( { row( "self", 10, five ), row( "self", 20, nine ), row( "gone", 20, nine ) } ),
	    reportOf( { row( "new", 1, nine ), row( "self", 20, nine ), row( "self", 10, five ) } ), 3 );
	ASSERT_EQ( c.differences.size(), 2u );
	EXPECT_EQ( c.count( Change::NOISE ), 2u );
	EXPECT_EQ( c.differences[0].row, "self, 10" );
	ASSERT_EQ( c.notes.size(), 1u );
	EXPECT_NE( c.notes[0].find( "1 rows" ), std::string::npos );
}

TEST( Compare, OtherMachineOrOtherWorkGoesUnsaid )
{
	Report before = reportOf( { row( "self", 10, 5.0 ) } ), after = before;
	before.outcomes[0].details = { { "data_hash", "1" } };
	after.outcomes[0].details = { { "data_hash", "2" } };
	after.provenance["processor"] = "y";
	after.provenance["quick"] = true;
	EXPECT_EQ( compare( before, after, 3 ).notes.size(), 3u );
	after = before;
	after.outcomes[0].tables[0].columns[2].unit = "ms";
	const Comparison c = compare( before, after, 3 );
	EXPECT_TRUE( c.differences.empty() ); // microseconds against milliseconds
	EXPECT_EQ( c.notes.size(), 1u );
	after.outcomes[0].name = "other";
	EXPECT_EQ( compare( before, after, 3 ).notes.size(), 1u );
}

TEST( Compare, ClaimThatNoLongerHoldsGoesUnsaid )
{
	Report before = reportOf( {} ), after = before;
	before.outcomes[0].claims = { { "paper", "tables help", "", Verdict::HOLDS, "" } };
	after.outcomes[0].claims = { { "paper", "tables help", "", Verdict::DIFFERS, "" } };
	const Comparison c = compare( before, after, 3 );
	ASSERT_EQ( c.notes.size(), 1u );
	EXPECT_NE( c.notes[0].find( "from holds to differs" ), std::string::npos );
}

TEST( Compare, TextLeavesOutALoss )
{
	const Measure before = { 10, 9, 11, 9 }, after = { 13, 12, 14, 9 };
	const Comparison c = compare( reportOf( { row( "self", 10, before ), row( "self", 20, before ) } ),
	    reportOf( { row( "self", 10, after ), row( "self", 20, before ) } ), 3 );
	const std::string text = comparisonText( c, false );
	EXPECT_NE( text.find( "worse" ), std::string::npos );
	EXPECT_NE( text.find( "self, 10: time" ), std::string::npos );
	EXPECT_EQ( text.find( "self, 20: time" ), std::string::npos );
	EXPECT_NE( comparisonText( c, true ).find( "self, 20: time" ), std::string::npos );
	EXPECT_NE( text.find( "0 better, 1 worse" ), std::string::npos );
}

TEST( Compare, BusyMachineIsTakenForASlowerProgram )
{
	std::vector<std::vector<Cell>> before, after;
	for ( int i = 0; i < 30; ++i )
	{
		before.push_back( row( "self", i, Measure{ 10, 9.9, 10.1, 9 } ) );
		const double slower = i == 7 ? 1.5 : 1.1; // one of them is slower by itself
		after.push_back( row( "self", i, Measure{ 10 * slower, 9.9 * slower, 10.1 * slower, 9 } ) );
	}
	const Comparison c = compare( reportOf( before ), reportOf( after ), 3 );
	EXPECT_NEAR( c.drift, 1.1, 1e-9 );
	EXPECT_EQ( c.count( Change::WORSE ), 1u );
	EXPECT_EQ( c.differences[7].change, Change::WORSE );
	EXPECT_DOUBLE_EQ( c.differences[7].after, 15 ); // as it was measured
	EXPECT_NE( comparisonText( c, false ).find( "+10.0 %" ), std::string::npos );
	EXPECT_EQ( compare( reportOf( before ), reportOf( after ), 3, true ).count( Change::WORSE ), 30u );
}

TEST( Compare, AnswersOfPeersThatDifferAreNotTold )
{
	const auto run = []( double mean, const char* hash )
	{
		const nlohmann::ordered_json row = { { "workload", "B arm self exact, free" }, { "library", "leeway" },
		    { "mean_us", mean }, { "median_us", mean }, { "p95_us", mean }, { "answers_hash", hash }, { "count", 100 } };
		return reportFromJson( { { "rows", { row } }, { "provenance", { { "simd", "AVX2" } } } } );
	};
	EXPECT_TRUE( compare( run( 10, "a1" ), run( 10, "a1" ), 3 ).notes.empty() );
	const Comparison c = compare( run( 10, "a1" ), run( 12, "b2" ), 3 );
	ASSERT_EQ( c.notes.size(), 1u );
	EXPECT_EQ( c.notes[0], "other answers in B arm self exact, free, leeway: a1, then b2" );
	ASSERT_EQ( c.differences.size(), 1u );
	EXPECT_EQ( c.differences[0].change, Change::WORSE );
	EXPECT_NEAR( c.differences[0].percent, 20, 1e-9 );
}
