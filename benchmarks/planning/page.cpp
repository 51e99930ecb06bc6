// SPDX-License-Identifier: BSD-3-Clause
// Results of planning as one page: see page.hpp.
#include "planning/page.hpp"

#include "report/report.hpp"

#include <algorithm>
#include <cctype>

namespace
{

/// [a-z0-9-], as identifiers of a page want it.
std::string idOf( const std::string& text )
{
	std::string id;
	for ( const char c : text )
	{
		const auto u = static_cast<unsigned char>( c );
		id += std::isalnum( u ) != 0 ? static_cast<char>( std::tolower( u ) ) : '-';
	}
	return id;
}

/// Share of all runs that are solved within a time: steps, at most some hundred of them.
std::vector<Point> solvedByTime( std::vector<double> times, std::size_t runs )
{
	constexpr std::size_t MOST = 300;
	std::sort( times.begin(), times.end() );
	std::vector<Point> points;
	const std::size_t step = std::max<std::size_t>( 1, times.size() / MOST );
	for ( std::size_t i = 0; i < times.size(); i += step )
	{
		Point point;
		point.x = times[i] / 1000;
		point.y = 100 * static_cast<double>( i ) / static_cast<double>( runs );
		points.push_back( point );
		point.y = 100 * static_cast<double>( std::min( i + step, times.size() ) ) / static_cast<double>( runs );
		points.push_back( point );
	}
	return points;
}

Plot distributionOf( const SetResult& result, const std::vector<WayKind>& ways, bool with_simplification )
{
	Plot plot;
	plot.id = idOf( result.name ) + ( with_simplification ? "-both" : "-planning" );
	plot.title = result.name + ( with_simplification ? ": planning and simplification" : ": planning" );
	plot.caption = "Share of runs that are solved within a time. A curve ends where its way has no more solutions.";
	plot.x.label = "processor time";
	plot.x.unit = "ms";
	plot.x.log = true;
	plot.y.label = "runs solved";
	plot.y.unit = "%";
	plot.y.from = 0;
	plot.y.to = 100;
	for ( std::size_t w = 0; w < ways.size(); ++w )
	{
		const Tally& tally = result.tallies[w];
		Series series;
		series.name = ways[w].name;
		series.points =
		    solvedByTime( with_simplification ? tally.both() : tally.column( &PlanRun::plan_us ), tally.runs.size() );
		if ( !series.points.empty() )
		{
			plot.series.push_back( series );
		}
	}
	return plot;
}

std::vector<Column> columnsOf( const std::vector<WayKind>& ways )
{
	std::vector<Column> columns = { { "problems", "", 0 }, { "way", "", 0 }, { "runs", "", 0 }, { "solved", "", 1 },
	    { "in contact", "", -1 }, { "planning, median", "us", -1 }, { "mean", "us", -1 }, { "p95", "us", -1 },
	    { "simplification, median", "us", -1 }, { "mean", "us", -1 }, { "p95", "us", -1 }, { "length, first", "", -1 },
	    { "simplified", "", -1 } };
	for ( const std::size_t r : referencesOf( ways ) )
	{
		columns.push_back( { "planning / " + ways[r].name, "", -1 } );
		columns.push_back( { "both / " + ways[r].name, "", -1 } );
	}
	return columns;
}

Table tableOf( const std::string& id, const std::string& title, const std::vector<SetResult>& results,
    const std::vector<WayKind>& ways )
{
	Table table;
	table.id = id;
	table.title = title;
	table.note =
	    "In contact: solved runs whose path touches something, by a dense look on the meshes. Lengths are Euclidean, radians "
	    "and metres alike. Ratios: geometric mean over the problems that both solved.";
	table.columns = columnsOf( ways );
	const auto number = []( std::size_t n ) { return static_cast<double>( n ); };
	for ( const SetResult& result : results )
	{
		for ( std::size_t w = 0; w < ways.size(); ++w )
		{
			const Tally& t = result.tallies[w];
			if ( !t.hasPart() )
			{
				continue;
			}
			const Summary plan = summarise( t.column( &PlanRun::plan_us ) );
			const Summary simplify = summarise( t.column( &PlanRun::simplify_us ) );
			std::vector<Cell> row = { result.name, ways[w].name, number( t.runs.size() ), number( t.solved() ),
			    number( t.inContact() ), plan.median, plan.mean, plan.p95, simplify.median, simplify.mean, simplify.p95,
			    median( t.column( &PlanRun::first_length ) ), median( t.column( &PlanRun::length ) ) };
			for ( const std::size_t r : referencesOf( ways ) )
			{
				row.emplace_back( pairedRatio( t, result.tallies[r], false ) );
				row.emplace_back( pairedRatio( t, result.tallies[r], true ) );
			}
			table.rows.push_back( row );
		}
	}
	return table;
}

} // namespace

void writePlanningPage( const std::string& file, const std::vector<WayKind>& ways, const std::vector<SetResult>& totals,
    const std::vector<SetResult>& sets, const Json& provenance )
{
	Outcome outcome;
	outcome.name = "planning";
	outcome.title = "Whole planning problems";
	outcome.about = "Each way plans the same problems in turn. Every path is looked at densely on the meshes afterwards.";
	for ( const SetResult& total : totals )
	{
		outcome.plots.push_back( distributionOf( total, ways, false ) );
		outcome.plots.push_back( distributionOf( total, ways, true ) );
	}
	outcome.tables = { tableOf( "robots", "By robot", totals, ways ), tableOf( "sets", "By set", sets, ways ) };
	Report report;
	report.title = "leeway: planning measured";
	report.about = "Times are processor time of one run each.";
	report.provenance = provenance;
	report.outcomes = { outcome };
	writePage( report, file );
}
