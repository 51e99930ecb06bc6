// SPDX-License-Identifier: BSD-3-Clause
// Results of ways on sets of problems: see tally.hpp.
#include "planning/tally.hpp"

#include "support/provenance.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

void Tally::addPath( const States& path )
{
	for ( const std::vector<double>& point : path )
	{
		for ( std::size_t i = 0; i < point.size() * sizeof( double ); ++i )
		{
			hash = ( hash ^ reinterpret_cast<const unsigned char*>( point.data() )[i] ) * 0x100000001b3u;
		}
	}
}

void Tally::add( const Tally& other )
{
	runs.insert( runs.end(), other.runs.begin(), other.runs.end() );
	asked += other.asked;
	accepted += other.accepted;
	problems += other.problems;
	refused += other.refused;
	unsolved.insert( unsolved.end(), other.unsolved.begin(), other.unsolved.end() );
	hash = hash * 31 + other.hash;
}

std::size_t Tally::solved() const
{
	return static_cast<std::size_t>(
	    std::count_if( runs.begin(), runs.end(), []( const PlanRun& r ) { return r.solved; } ) );
}

std::size_t Tally::inContact() const
{
	return static_cast<std::size_t>(
	    std::count_if( runs.begin(), runs.end(), []( const PlanRun& r ) { return r.in_contact; } ) );
}

std::vector<double> Tally::column( double PlanRun::*member ) const
{
	std::vector<double> values;
	for ( const PlanRun& run : runs )
	{
		if ( run.solved )
		{
			values.push_back( run.*member );
		}
	}
	return values;
}

std::vector<double> Tally::both() const
{
	std::vector<double> values = column( &PlanRun::plan_us );
	const std::vector<double> simplify = column( &PlanRun::simplify_us );
	std::transform( values.begin(), values.end(), simplify.begin(), values.begin(), std::plus<double>() );
	return values;
}

namespace
{

/// Median time of each problem that was solved.
std::map<std::size_t, double> byProblem( const Tally& tally, bool with_simplification )
{
	std::map<std::size_t, std::vector<double>> times;
	for ( const PlanRun& run : tally.runs )
	{
		if ( run.solved )
		{
			times[run.problem].push_back( run.plan_us + ( with_simplification ? run.simplify_us : 0 ) );
		}
	}
	std::map<std::size_t, double> medians;
	for ( auto& [problem, values] : times )
	{
		medians[problem] = median( std::move( values ) );
	}
	return medians;
}

} // namespace

double pairedRatio( const Tally& tally, const Tally& reference, bool with_simplification )
{
	const std::map<std::size_t, double> ours = byProblem( tally, with_simplification );
	const std::map<std::size_t, double> theirs = byProblem( reference, with_simplification );
	double sum = 0;
	int count = 0;
	for ( const auto& [problem, time] : ours )
	{
		const auto found = theirs.find( problem );
		if ( found != theirs.end() && time > 0 && found->second > 0 )
		{
			sum += std::log( time / found->second );
			++count;
		}
	}
	return count > 0 ? std::exp( sum / count ) : 0;
}

std::vector<std::size_t> referencesOf( const std::vector<WayKind>& ways )
{
	std::vector<std::size_t> references = { 0 };
	for ( std::size_t w = 1; w < ways.size(); ++w )
	{
		if ( ways[w].module )
		{
			references.push_back( w );
		}
	}
	return references;
}

namespace
{

/// References that planned this set.
std::vector<std::size_t> partsOf( const SetResult& result, const std::vector<WayKind>& ways )
{
	std::vector<std::size_t> references = referencesOf( ways );
	const auto absent = [&]( std::size_t r ) { return !result.tallies[r].hasPart(); };
	references.erase( std::remove_if( references.begin(), references.end(), absent ), references.end() );
	return references;
}

} // namespace

void printHeader( const std::vector<WayKind>& ways )
{
	std::printf( "microseconds of processor time; x NAME: ratio to it, planning / with simplification, geometric mean over "
	             "problems; solved of runs\n" );
	std::printf( "%-24s %-26s %9s | %9s %9s %10s | %8s %9s | %6s %6s | %7s", "problems", "way", "solved", "median", "mean",
	    "p95", "simplify", "p95", "first", "length", "contact" );
	for ( const std::size_t r : referencesOf( ways ) )
	{
		std::printf( " | %15s", ( "x " + ways[r].name ).c_str() );
	}
	std::printf( "\n" );
}

void print( const SetResult& result, const std::vector<WayKind>& ways )
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
		std::printf( "%-24s %-26s %4zu/%-4zu | %9.0f %9.0f %10.0f | %8.0f %9.0f | %6.2f %6.2f | %7zu", result.name.c_str(),
		    ways[w].name.c_str(), t.solved(), t.runs.size(), plan.median, plan.mean, plan.p95, simplify.median, simplify.p95,
		    median( t.column( &PlanRun::first_length ) ), median( t.column( &PlanRun::length ) ), t.inContact() );
		for ( const std::size_t r : partsOf( result, ways ) )
		{
			std::printf(
			    " | %7.2f %7.2f", pairedRatio( t, result.tallies[r], false ), pairedRatio( t, result.tallies[r], true ) );
		}
		std::printf( t.accepted < t.asked ? "  accepts the ends of %zu of %zu\n" : "\n", t.accepted, t.asked );
	}
	std::fflush( stdout );
}

Json toJson( const SetResult& result, const std::vector<WayKind>& ways, bool spread )
{
	Json rows = Json::array();
	for ( std::size_t w = 0; w < ways.size(); ++w )
	{
		const Tally& t = result.tallies[w];
		if ( !t.hasPart() )
		{
			continue;
		}
		Json row = { { "problems", result.name }, { "way", ways[w].name }, { "runs", t.runs.size() },
		    { "solved", t.solved() }, { "problems_asked", t.asked }, { "ends_accepted", t.accepted },
		    { "problems_planned", t.problems }, { "planned_refused", t.refused },
		    { "planning", toJson( summarise( t.column( &PlanRun::plan_us ) ) ) },
		    { "simplification", toJson( summarise( t.column( &PlanRun::simplify_us ) ) ) },
		    { "both", toJson( summarise( t.both() ) ) },
		    { "first_length_median", median( t.column( &PlanRun::first_length ) ) },
		    { "length_median", median( t.column( &PlanRun::length ) ) }, { "in_contact", t.inContact() },
		    { "paths_hash", std::to_string( t.hash ) } };
		row["direct"] = std::count_if( t.runs.begin(), t.runs.end(), []( const PlanRun& run ) { return run.direct; } );
		if ( !spread && !t.unsolved.empty() )
		{
			row["unsolved"] = t.unsolved;
		}
		for ( const std::size_t r : partsOf( result, ways ) )
		{
			row["ratios"][ways[r].name] = { { "planning", pairedRatio( t, result.tallies[r], false ) },
			    { "both", pairedRatio( t, result.tallies[r], true ) } };
		}
		if ( spread )
		{
			std::vector<double> times = t.column( &PlanRun::plan_us );
			std::sort( times.begin(), times.end() );
			Json& quantiles = row["planning_us_quantiles"] = Json::array(); // 0, 1, ..., 100 % of the solved runs
			for ( std::size_t i = 0; i <= 100 && !times.empty(); ++i )
			{
				quantiles.push_back( std::round( 10 * times[( times.size() - 1 ) * i / 100] ) / 10 );
			}
		}
		rows.push_back( row );
	}
	return rows;
}
