// SPDX-License-Identifier: BSD-3-Clause
// Results of experiments survive their file: quartiles, tables, plots, claims.
#include "report/experiment.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace
{

const double INF = std::numeric_limits<double>::infinity();

Outcome example()
{
	Outcome outcome;
	outcome.name = "paper";
	outcome.title = "A <title>";
	outcome.about = "about";
	outcome.seconds = 12.5;
	outcome.details = { { "hash", "00ff" } };
	outcome.tables.push_back( { "times", "Times", "a note", { { "what", "", 0 }, { "limit", "m", 0 }, { "time", "us", -1 } },
	    { { "near", 0.010, Measure{ 3, 2.5, 4, 20 } }, { "far", INF, 1.0 / 3 } } } );
	Plot plot;
	plot.id = "a";
	plot.x = { "distance", "m", true, 1e-4, INF };
	plot.y.from = 0;
	plot.series = {
	    { "one", { { 1, 2, 1.5, 2.5 }, { 3, std::nan( "" ) } }, Mark::DASHES, true }, { "two", {}, Mark::BARS, false } };
	plot.categories = { "first", "second" };
	outcome.plots.push_back( plot );
	outcome.claims.push_back( { "promise", "text", "figure", Verdict::BROKEN, "why" } );
	return outcome;
}

} // namespace

TEST( Measure, QuartilesAreTakenForThoseOfAnotherOrder )
{
	const Measure m = measure( { 5, 1, 4, 2, 3 } );
	EXPECT_EQ( m.median, 3 );
	EXPECT_EQ( m.lower, 2 );
	EXPECT_EQ( m.upper, 4 );
	EXPECT_EQ( m.count, 5u );
	EXPECT_EQ( measure( { 1, 2 } ).median, 1.5 ); // no value is preferred to the other
	EXPECT_EQ( measure( {} ).count, 0u );
	EXPECT_EQ( measure( { 7 } ).upper, 7 );
}

TEST( Outcome, FieldIsLostOnItsWayThroughAFile )
{
	const Outcome before = example();
	const std::string text = toJson( before ).dump();
	const Outcome after = outcomeFromJson( nlohmann::ordered_json::parse( text ) );
	EXPECT_EQ( toJson( after ).dump(), text );
	EXPECT_EQ( after.title, before.title );
	EXPECT_EQ( after.details["hash"], "00ff" );
	EXPECT_EQ( std::get<double>( after.tables[0].rows[1][1] ), INF );
	EXPECT_EQ( std::get<double>( after.tables[0].rows[1][2] ), 0.333333 );
	EXPECT_EQ( std::get<Measure>( after.tables[0].rows[0][2] ).lower, 2.5 );
	EXPECT_EQ( after.tables[0].columns[2].better, -1 );
	EXPECT_EQ( after.plots[0].x.to, INF );
	EXPECT_TRUE( std::isnan( after.plots[0].y.to ) );
	EXPECT_EQ( after.plots[0].series[0].mark, Mark::DASHES );
	EXPECT_EQ( after.plots[0].series[0].points[0].high, 2.5 );
	EXPECT_TRUE( std::isnan( after.plots[0].series[0].points[1].y ) );
	EXPECT_EQ( after.plots[0].categories.size(), 2u );
	EXPECT_FALSE( promisesKept( after ) );
}

TEST( Outcome, RowOfAnotherLengthIsReadAsIfItFitted )
{
	nlohmann::ordered_json json = toJson( example() );
	json["tables"][0]["rows"][1].erase( 2 );
	EXPECT_THROW( outcomeFromJson( json ), std::runtime_error );
	Outcome outcome = example();
	outcome.tables[0].rows[0].pop_back();
	EXPECT_THROW( toJson( outcome ), std::logic_error );
	json = toJson( example() );
	json["claims"][0]["verdict"] = "perhaps";
	EXPECT_THROW( outcomeFromJson( json ), std::runtime_error );
	json["claims"][0].erase( "verdict" );
	EXPECT_THROW( outcomeFromJson( json ), nlohmann::json::exception );
}

TEST( Outcome, DifferenceToThePaperIsTakenForABrokenPromise )
{
	Outcome outcome = example();
	outcome.claims[0].verdict = Verdict::DIFFERS;
	EXPECT_TRUE( promisesKept( outcome ) );
}
