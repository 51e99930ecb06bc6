// SPDX-License-Identifier: BSD-3-Clause
// Every experiment once on little work: it comes to an end, its promises are kept, its tables and plots are whole.
#include "experiments/experiments.hpp"
#include "report/rounds.hpp"

#include <cmath>
#include <filesystem>
#include <gtest/gtest.h>
#include <set>

namespace
{

/// Shares of a run never fall.
struct Rising : Progress
{
	double last = 0;
	void at( double share, const std::string& what ) override
	{
		EXPECT_GE( share, last - 1e-9 ) << what;
		EXPECT_LE( share, 1 + 1e-9 ) << what;
		last = share;
	}
};

/// The text in front of the first column that tells better from worse.
std::string nameOf( const Table& table, const std::vector<Cell>& row )
{
	std::string name;
	for ( std::size_t i = 0; i < row.size() && table.columns[i].better == 0; ++i )
	{
		const std::string* word = std::get_if<std::string>( &row[i] );
		const double* number = std::get_if<double>( &row[i] );
		name += "|" + ( word != nullptr ? *word : number != nullptr ? std::to_string( *number ) : "?" );
	}
	return name;
}

void expectWhole( const Outcome& outcome )
{
	EXPECT_FALSE( outcome.claims.empty() );
	EXPECT_FALSE( outcome.about.empty() );
	EXPECT_TRUE( promisesKept( outcome ) );
	std::set<std::string> ids;
	for ( const Table& table : outcome.tables )
	{
		EXPECT_TRUE( ids.insert( table.id ).second ) << table.id;
		EXPECT_FALSE( table.rows.empty() ) << table.id;
		std::set<std::string> names;
		for ( const std::vector<Cell>& row : table.rows )
		{
			EXPECT_TRUE( names.insert( nameOf( table, row ) ).second ) << table.id << ": twice " << nameOf( table, row );
		}
	}
	ids.clear();
	for ( const Plot& plot : outcome.plots )
	{
		EXPECT_TRUE( ids.insert( plot.id ).second ) << plot.id;
		EXPECT_FALSE( plot.title.empty() || plot.y.label.empty() || plot.series.empty() ) << plot.id;
		for ( const Series& series : plot.series )
		{
			EXPECT_FALSE( series.points.empty() ) << plot.id << ' ' << series.name;
			for ( const Point& point : series.points )
			{
				EXPECT_FALSE( std::isnan( point.x ) || std::isnan( point.y ) ) << plot.id << ' ' << series.name;
				EXPECT_FALSE( point.low > point.high ) << plot.id << ' ' << series.name;
			}
		}
	}
	EXPECT_NO_THROW( outcomeFromJson( toJson( outcome ) ) ); // rows are as long as columns, and so on
}

} // namespace

TEST( Rounds, ContenderIsAskedOtherQuestionsThanTheRest )
{
	std::vector<double> first, second;
	const std::vector<Contender> contenders = {
	    { "a",
	        [&]( const double* q ) {
		        return first.push_back( *q ), Answer{ *q, *q };
	        } },
	    { "b",
	        [&]( const double* q ) {
		        return second.push_back( *q ), Answer{ 2 * *q, 2 * *q };
	        } },
	};
	Rising progress;
	const std::vector<Rounds> rounds = raceRounds( contenders, 3, 2, progress, "" );
	EXPECT_EQ( first, ( std::vector<double>{ 0, 1, 2, 0, 1, 2, 0, 1, 2 } ) ); // the first pass warms up
	EXPECT_EQ( first, second );
	ASSERT_EQ( rounds.size(), 2u );
	EXPECT_EQ( rounds[0].means.size(), 2u );
	EXPECT_EQ( rounds[0].medians.size(), 3u );
	ASSERT_EQ( rounds[1].answers.size(), 3u );
	EXPECT_EQ( rounds[1].answers[2].upper, 4 );
	EXPECT_EQ( progress.last, 1 );
}

TEST( Rounds, RatioIsThatOfMediansRatherThanOfEachPass )
{
	Rounds a, b;
	a.means = { 2, 20, 6 };
	b.means = { 1, 10, 2 };
	const Measure ratio = ratioOf( a, b );
	EXPECT_EQ( ratio.median, 2 );
	EXPECT_EQ( ratio.upper, 2.5 );
	EXPECT_EQ( ratioOf( a, b, 1, 100 ).median, 100 );
}

TEST( Bench, PaperOnGeneratedShapesIsTorn )
{
	ExperimentSettings settings;
	settings.data.clear();
	settings.quick = settings.smoke = true;
	Rising progress;
	const Outcome outcome = makePaperExperiment()->run( settings, progress );
	expectWhole( outcome );
	EXPECT_EQ( outcome.name, "paper" );
	// volumes do not depend on time: GREEDY spheres contain the compact ones' geometry and more
	for ( const Claim& claim : outcome.claims )
	{
		if ( claim.source == "figure 4" )
		{
			EXPECT_EQ( claim.verdict, Verdict::HOLDS ) << claim.figure;
		}
	}
	for ( const Table& table : outcome.tables )
	{
		for ( std::size_t i = 0; table.id == "levels" && i < table.rows.size(); ++i )
		{
			EXPECT_GE( std::get<double>( table.rows[i][3] ), std::get<double>( table.rows[i][4] ) * 0.999 );
			EXPECT_GE( std::get<double>( table.rows[i][4] ), std::get<double>( table.rows[i][5] ) * 0.999 );
		}
	}
}

TEST( BenchData, ExperimentIsTornOrBreaksAPromise )
{
	ExperimentSettings settings;
	settings.quick = settings.smoke = true;
	settings.budget = 0;
	if ( !std::filesystem::exists( std::filesystem::path( settings.data ) / "armar3" ) )
	{
		GTEST_SKIP() << "no data in " << settings.data;
	}
	for ( const std::unique_ptr<Experiment>& experiment : allExperiments() )
	{
		SCOPED_TRACE( experiment->name() );
		EXPECT_GT( experiment->expectedSeconds( settings ), 0 );
		if ( experiment->name() == "paper" || experiment->name() == "ablation" ) // the others have tests of their own
		{
			Rising progress;
			expectWhole( experiment->run( settings, progress ) );
		}
	}
}

TEST( Bench, ExperimentsShareAName )
{
	std::set<std::string> names;
	for ( const std::unique_ptr<Experiment>& experiment : allExperiments() )
	{
		EXPECT_TRUE( names.insert( experiment->name() ).second ) << experiment->name();
	}
	EXPECT_GE( names.size(), 3u );
}
