// SPDX-License-Identifier: BSD-3-Clause
// Results of planning as one page: see page.hpp.
#include "planning/page.hpp"

#include "support/provenance.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace
{

/// Told apart also by those who see fewer colours; from the ninth way on they repeat.
const char* const COLOURS[] = { "#d55e00", "#0072b2", "#56b4e9", "#009e73", "#cc79a7", "#999999", "#e69f00", "#333333" };
constexpr double WIDTH = 760, HEIGHT = 320, LEFT = 50, RIGHT = 20, TOP = 15, BOTTOM = 45;

const char* colourOf( std::size_t way )
{
	return COLOURS[way % std::size( COLOURS )];
}

std::string escaped( const std::string& text )
{
	std::string out;
	for ( const char c : text )
	{
		out += c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '&' ? "&amp;" : c == '"' ? "&quot;" : std::string( 1, c );
	}
	return out;
}

/// Times of the solved runs in milliseconds, in order.
std::vector<double> timesOf( const Tally& tally, bool with_simplification )
{
	std::vector<double> times = with_simplification ? tally.both() : tally.column( &PlanRun::plan_us );
	for ( double& time : times )
	{
		time = std::max( time / 1000, 1e-3 );
	}
	std::sort( times.begin(), times.end() );
	return times;
}

/// Share of all runs that are solved within a time, as steps; at most some hundred of them.
std::string curve( const std::vector<double>& times, std::size_t runs, double first, double decades, std::size_t way )
{
	constexpr std::size_t MOST = 300;
	const std::size_t step = std::max<std::size_t>( 1, times.size() / MOST );
	std::string points;
	for ( std::size_t i = 0; i < times.size(); i += step )
	{
		const double x = LEFT + ( WIDTH - LEFT - RIGHT ) * ( std::log10( times[i] ) - first ) / decades;
		for ( const std::size_t solved : { i, std::min( i + step, times.size() ) } )
		{
			const double share = static_cast<double>( solved ) / static_cast<double>( runs );
			points += fmt::format( "{:.1f},{:.1f} ", x, TOP + ( HEIGHT - TOP - BOTTOM ) * ( 1 - share ) );
		}
	}
	return fmt::format( "<polyline fill='none' stroke='{}' stroke-width='1.5' points='{}'/>\n", colourOf( way ), points );
}

/// Axes of the curves: shares from the left, decades of milliseconds below.
std::string axes( double first, double decades )
{
	std::string out;
	for ( int percent = 0; percent <= 100; percent += 25 )
	{
		const double y = TOP + ( HEIGHT - TOP - BOTTOM ) * ( 1 - percent / 100.0 );
		out += fmt::format( "<line x1='{0}' x2='{1}' y1='{2:.1f}' y2='{2:.1f}' stroke='#ddd'/><text x='{3}' y='{4:.1f}' "
		                    "text-anchor='end'>{5} %</text>\n",
		    LEFT, WIDTH - RIGHT, y, LEFT - 5, y + 4, percent );
	}
	for ( int k = 0; k <= static_cast<int>( decades ); ++k )
	{
		const double x = LEFT + ( WIDTH - LEFT - RIGHT ) * k / decades;
		out += fmt::format( "<line x1='{0:.1f}' x2='{0:.1f}' y1='{1}' y2='{2}' stroke='#ddd'/><text x='{0:.1f}' y='{3}' "
		                    "text-anchor='middle'>{4:g}</text>\n",
		    x, TOP, HEIGHT - BOTTOM, HEIGHT - BOTTOM + 16, std::pow( 10, first + k ) );
	}
	return out + fmt::format( "<text x='{}' y='{}' text-anchor='middle'>processor time, ms</text>\n", ( LEFT + WIDTH ) / 2,
	                 HEIGHT - 8 );
}

std::string picture( const SetResult& result, const std::vector<WayKind>& ways, bool with_simplification )
{
	double least = INFINITY, most = 0;
	for ( const Tally& tally : result.tallies )
	{
		const std::vector<double> times = timesOf( tally, with_simplification );
		least = times.empty() ? least : std::min( least, times.front() );
		most = times.empty() ? most : std::max( most, times.back() );
	}
	if ( most == 0 )
	{
		return "<p>nothing was solved</p>\n";
	}
	const double first = std::floor( std::log10( least ) );
	const double decades = std::max( 1.0, std::ceil( std::log10( most ) ) - first );
	std::string out = fmt::format( "<svg width='{0}' height='{1}' viewBox='0 0 {0} {1}' font-family='sans-serif' "
	                               "font-size='11'>\n{2}",
	    WIDTH, HEIGHT, axes( first, decades ) );
	std::string legend;
	for ( std::size_t w = 0; w < ways.size(); ++w )
	{
		const std::vector<double> times = timesOf( result.tallies[w], with_simplification );
		if ( !times.empty() )
		{
			out += curve( times, result.tallies[w].runs.size(), first, decades, w );
			legend +=
			    fmt::format( "<span style='color:{}'>&#9632;</span> {}&ensp;", colourOf( w ), escaped( ways[w].name ) );
		}
	}
	return out + "</svg>\n<p>" + legend + "</p>\n";
}

std::string tableOf( const std::vector<SetResult>& results, const std::vector<WayKind>& ways )
{
	std::string out = "<table><tr>";
	std::vector<std::string> columns = { "problems", "way", "solved", "in contact", "planning, median us", "mean", "p95",
	    "simplification, median us", "mean", "p95", "length, first", "simplified" };
	for ( const std::size_t r : referencesOf( ways ) )
	{
		columns.push_back( "planning / " + ways[r].name );
		columns.push_back( "both / " + ways[r].name );
	}
	for ( const std::string& column : columns )
	{
		out += "<th>" + escaped( column );
	}
	for ( const SetResult& result : results )
	{
		for ( std::size_t w = 0; w < ways.size(); ++w )
		{
			const Tally& t = result.tallies[w];
			if ( !t.hasPart() )
			{
				continue;
			}
			const Summary plan = summarise( t.column( &PlanRun::plan_us ) ),
			              simplify = summarise( t.column( &PlanRun::simplify_us ) );
			out += fmt::format( "<tr><td>{}<td>{}<td>{} of {}<td>{}", escaped( result.name ), escaped( ways[w].name ),
			    t.solved(), t.runs.size(), t.inContact() );
			for ( const double value : { plan.median, plan.mean, plan.p95, simplify.median, simplify.mean, simplify.p95 } )
			{
				out += fmt::format( "<td>{:.0f}", value );
			}
			for ( const auto member : { &PlanRun::first_length, &PlanRun::length } )
			{
				out += fmt::format( "<td>{:.2f}", median( t.column( member ) ) );
			}
			for ( const std::size_t r : referencesOf( ways ) )
			{
				out += fmt::format( "<td>{:.2f}<td>{:.2f}", pairedRatio( t, result.tallies[r], false ),
				    pairedRatio( t, result.tallies[r], true ) );
			}
			out += "\n";
		}
	}
	return out + "</table>\n";
}

} // namespace

void writePlanningPage( const std::string& file, const std::vector<WayKind>& ways, const std::vector<SetResult>& totals,
    const std::vector<SetResult>& sets, const std::string& origin )
{
	std::string page =
	    "<!DOCTYPE html><html lang='en'><meta charset='utf-8'><title>leeway: planning measured</title>\n"
	    "<style>body{font-family:sans-serif;margin:2em}td,th{padding:2px 8px;text-align:right}"
	    "td:nth-child(-n+2),th:nth-child(-n+2){text-align:left}</style>\n<h1>Whole planning problems</h1>\n<p>" +
	    escaped( origin ) +
	    "</p>\n<p>Each way plans the same problems in turn. Times are processor time of one run each. Every path is "
	    "looked at densely on the meshes afterwards: in contact are the solved runs whose path touches something. "
	    "Lengths are Euclidean, radians and metres alike. Ratios are geometric means over the problems that both "
	    "solved. Curves: the share of runs that are solved within a time; a curve ends where its way has no more "
	    "solutions.</p>\n";
	for ( const SetResult& total : totals )
	{
		page += "<h2>" + escaped( total.name ) + "</h2>\n<h3>Planning</h3>\n" + picture( total, ways, false ) +
		        "<h3>Planning and simplification</h3>\n" + picture( total, ways, true );
	}
	page += "<h2>By robot</h2>\n" + tableOf( totals, ways ) + "<h2>By set</h2>\n" + tableOf( sets, ways ) + "</html>\n";
	writeFile( file, page );
}
