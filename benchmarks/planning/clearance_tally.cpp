// SPDX-License-Identifier: BSD-3-Clause
#include "planning/clearance_tally.hpp"
#include "support/race.hpp"

#include <algorithm>
#include <cstdio>

namespace
{

constexpr const char* part_names[] = { "environment", "self", "both" };

double medianOf( std::vector<double> values )
{
	std::sort( values.begin(), values.end() );
	return values.empty() ? 0 : values[values.size() / 2];
}

double quantileOf( std::vector<double> values, double share )
{
	std::sort( values.begin(), values.end() );
	return values.empty() ? 0 : values[static_cast<std::size_t>( share * static_cast<double>( values.size() - 1 ) )];
}

} // namespace

void ClearanceTally::add(
    const EdgeWorld& world, const std::vector<std::vector<double>>& states, double goal, double seconds )
{
	leeway::planners::Path path;
	for ( const std::vector<double>& state : states )
	{
		path.dimension = state.size();
		path.values.insert( path.values.end(), state.begin(), state.end() );
	}
	const leeway::Query query = leeway::makeQuery( world.with_tables.get() );
	leeway::planners::ClearanceSettings settings;
	settings.goal = goal;
	settings.seconds = seconds;
	leeway::planners::ClearanceReport report;
	leeway::planners::Path warm = path; // makes deferred meshes, which belong to no path
	leeway::require( raiseClearance( world.with_tables.get(), query.get(), settings, {}, warm, &report ), "clearance" );
	const double begin = processMicroseconds();
	leeway::require( raiseClearance( world.with_tables.get(), query.get(), settings, {}, path, &report ), "clearance" );
	Row row{};
	row.cpu_ms = ( processMicroseconds() - begin ) * 1e-3;
	row.wall_ms = report.seconds * 1e3;
	row.goal = report.goal;
	row.changed = report.changed;
	row.length_ratio = report.length_before > 0 ? report.length_after / report.length_before : 1;
	row.proved = report.notice != "the path is not proved free";
	const leeway::planners::ClearanceChange* changes[] = { &report.environment, &report.self };
	for ( unsigned k = 0; k < 3; ++k )
	{
		const auto least = [&]( auto value )
		{
			leeway::planners::ClearanceRange a = value( *changes[k % 2] ), b = value( *changes[k < 2 ? k : 1] );
			return leeway::planners::ClearanceRange{ std::min( a.lower, b.lower ), std::min( a.upper, b.upper ) };
		};
		row.before[k] = least( []( const auto& c ) { return c.before; } );
		row.after[k] = least( []( const auto& c ) { return c.after; } );
		row.middle_before[k] = least( []( const auto& c ) { return c.middle_before; } );
		row.middle_after[k] = least( []( const auto& c ) { return c.middle_after; } );
		row.ends[k] = k < 2 ? changes[k]->ends : std::min( changes[0]->ends, changes[1]->ends );
	}
	m_rows.push_back( row );
}

ClearanceTally::Summary ClearanceTally::summary( unsigned part, bool middle ) const
{
	std::vector<double> before, after, ratio;
	Summary out{};
	for ( const Row& row : m_rows )
	{
		const leeway::planners::ClearanceRange &from = middle ? row.middle_before[part] : row.before[part],
		                                       &to = middle ? row.middle_after[part] : row.after[part];
		before.push_back( from.lower );
		after.push_back( to.lower );
		ratio.push_back( to.lower / from.upper ); // proved after, measured before
		// the ends are measured: of what they allow a twentieth more cannot be proved
		const bool could = 2 * from.upper <= ( middle ? row.goal : std::min( row.goal, row.ends[part] / 1.06 ) );
		out.could += could;
		out.doubled += could && to.lower >= 2 * from.upper;
	}
	out.before = medianOf( before );
	out.after = medianOf( after );
	out.ratio = medianOf( ratio );
	return out;
}

void ClearanceTally::printHeader( double goal )
{
	std::printf(
	    "\nclearance raised, goal %g m: medians in mm, lower ends; 'doubled': of the paths whose ends and goal allow twice\n"
	    "  set, pairs, part                            paths   before    after  ratio  doubled       length (most)   ms, cpu ms (95 %%)\n",
	    goal );
}

void ClearanceTally::print( const std::string& set ) const
{
	std::vector<double> lengths, wall, cpu;
	std::size_t changed = 0, proved = 0;
	for ( const Row& row : m_rows )
	{
		lengths.push_back( row.length_ratio );
		wall.push_back( row.wall_ms );
		cpu.push_back( row.cpu_ms );
		changed += row.changed;
		proved += row.proved;
	}
	for ( const unsigned part : { 2u, 0u, 1u } )
	{
		for ( const bool middle : { false, true } )
		{
			const Summary s = summary( part, middle );
			std::printf( "  %-22s %-11s %-7s %5zu %8.2f %8.2f %6.2f %4zu of %-4zu", set.c_str(), part_names[part],
			    middle ? "middle" : "whole", m_rows.size(), s.before * 1e3, s.after * 1e3, s.ratio, s.doubled, s.could );
			part == 2 && !middle
			    ? std::printf( "  %6.3f (%.3f)  %6.2f, %.2f (%.2f); %zu changed\n", medianOf( lengths ),
			          quantileOf( lengths, 1 ), medianOf( wall ), medianOf( cpu ), quantileOf( cpu, 0.95 ), changed )
			    : std::printf( "\n" );
		}
	}
	if ( proved < m_rows.size() )
	{
		std::printf( "  %zu paths were not proved free at the start\n", m_rows.size() - proved );
	}
}

Json ClearanceTally::json( const std::string& set ) const
{
	Json out = { { "set", set }, { "paths", m_rows.size() } };
	for ( const unsigned part : { 0u, 1u, 2u } )
	{
		for ( const bool middle : { false, true } )
		{
			const Summary s = summary( part, middle );
			out[part_names[part]][middle ? "middle" : "whole"] = { { "before", s.before }, { "after", s.after },
			    { "ratio", s.ratio }, { "could_double", s.could }, { "doubled", s.doubled } };
		}
	}
	return out;
}
