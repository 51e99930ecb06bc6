// SPDX-License-Identifier: BSD-3-Clause
// Two results of experiments side by side: see compare.hpp.
#include "report/compare.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <tuple>

using Json = nlohmann::ordered_json;

const char* changeName( Change change )
{
	switch ( change )
	{
	case Change::NOISE:
		return "noise";
	case Change::BETTER:
		return "better";
	case Change::WORSE:
		return "worse";
	case Change::OTHER:
		break;
	}
	return "changed";
}

std::size_t Comparison::count( Change change ) const
{
	return static_cast<std::size_t>( std::count_if(
	    differences.begin(), differences.end(), [change]( const Difference& d ) { return d.change == change; } ) );
}

namespace
{

Measure measureOf( const Cell& cell )
{
	if ( const Measure* m = std::get_if<Measure>( &cell ) )
	{
		return *m;
	}
	const double value = std::get<double>( cell );
	return { value, value, value, 1 };
}

std::string textOf( const Cell& cell )
{
	if ( const std::string* word = std::get_if<std::string>( &cell ) )
	{
		return *word;
	}
	char text[32];
	std::snprintf( text, sizeof text, "%.6g", measureOf( cell ).median );
	return text;
}

/// The name of a row: its cells in front of the first column with `better`.
std::string nameOf( const Table& table, const std::vector<Cell>& row )
{
	std::string name;
	for ( std::size_t i = 0; i < row.size() && table.columns[i].better == 0; ++i )
	{
		name += ( name.empty() ? "" : ", " ) + textOf( row[i] );
	}
	return name;
}

template <typename T, typename NameOf>
const T* find( const std::vector<T>& all, const std::string& name, const NameOf& name_of )
{
	const auto found = std::find_if( all.begin(), all.end(), [&]( const T& one ) { return name_of( one ) == name; } );
	return found == all.end() ? nullptr : &*found;
}

Change judge( const Difference& d, const Measure& before, const Measure& after, int better, double threshold )
{
	if ( !( std::abs( d.percent ) > threshold ) && std::isfinite( d.percent ) )
	{
		return Change::NOISE;
	}
	if ( before.median == after.median ) // both infinite, or 0
	{
		return Change::NOISE;
	}
	if ( before.count < 2 || after.count < 2 )
	{
		return Change::OTHER;
	}
	if ( before.lower <= after.upper && after.lower <= before.upper )
	{
		return Change::NOISE;
	}
	return ( after.median > before.median ) == ( better > 0 ) ? Change::BETTER : Change::WORSE;
}

/// Times that drift with the machine.
bool isTime( const Column& column, const Measure& a, const Measure& b )
{
	return column.unit == "us" && column.better != 0 && a.count > 1 && b.count > 1;
}

void compareRow( Comparison& out, const std::string& experiment, const Table& table, const std::vector<Cell>& before,
    const std::vector<Cell>& after, double threshold )
{
	for ( std::size_t i = 0; i < table.columns.size(); ++i )
	{
		const Column& column = table.columns[i];
		const std::string *was = std::get_if<std::string>( &before[i] ), *is = std::get_if<std::string>( &after[i] );
		if ( was != nullptr && is != nullptr && *was != *is ) // cells of the row's name are equal
		{
			out.notes.push_back( "other " + column.name + " in " + nameOf( table, before ) + ": " + *was + ", then " + *is );
		}
		if ( column.better == 0 || std::holds_alternative<std::string>( before[i] ) ||
		     std::holds_alternative<std::string>( after[i] ) )
		{
			continue;
		}
		const Measure a = measureOf( before[i] ), measured = measureOf( after[i] );
		const bool time = isTime( column, a, measured );
		const double drift = time ? out.drift : 1;
		const Measure b = { measured.median / drift, measured.lower / drift, measured.upper / drift, measured.count };
		Difference d{
		    experiment, table.id, nameOf( table, before ), column.name, column.unit, a.median, measured.median, 0, 0, {} };
		d.percent = a.median == b.median ? 0 : 100 * ( b.median / a.median - 1 );
		d.noise = 50 * ( ( a.upper - a.lower ) + ( b.upper - b.lower ) ) / std::abs( a.median );
		d.change = judge( d, a, b, column.better, time ? std::max( threshold, out.scatter ) : threshold );
		out.differences.push_back( d );
	}
}

bool sameColumns( const Table& a, const Table& b )
{
	return std::equal( a.columns.begin(), a.columns.end(), b.columns.begin(), b.columns.end(),
	    []( const Column& x, const Column& y ) { return x.name == y.name && x.unit == y.unit && x.better == y.better; } );
}

void compareTable(
    Comparison& out, const std::string& experiment, const Table& before, const Table& after, double threshold )
{
	if ( !sameColumns( before, after ) )
	{
		out.notes.push_back( experiment + ", " + before.id + ": other columns; not compared" );
		return;
	}
	std::map<std::string, const std::vector<Cell>*> rows;
	for ( const std::vector<Cell>& row : after.rows )
	{
		rows.emplace( nameOf( after, row ), &row );
	}
	std::size_t missing = 0;
	for ( const std::vector<Cell>& row : before.rows )
	{
		const auto found = rows.find( nameOf( before, row ) );
		if ( found == rows.end() )
		{
			++missing;
			continue;
		}
		compareRow( out, experiment, before, row, *found->second, threshold );
	}
	if ( missing > 0 )
	{
		out.notes.push_back(
		    experiment + ", " + before.id + ": " + std::to_string( missing ) + " rows are in the first result only" );
	}
}

/// A verdict that is another one: from holds to broken is worse.
void compareClaims( Comparison& out, const Outcome& before, const Outcome& after )
{
	for ( const Claim& claim : before.claims )
	{
		const Claim* other = nullptr;
		for ( const Claim& candidate : after.claims )
		{
			if ( candidate.source == claim.source && candidate.text == claim.text )
			{
				other = &candidate;
				break;
			}
		}
		if ( other == nullptr )
		{
			out.notes.push_back( before.name + ": claimed in the first result only: " + claim.text );
		}
		else if ( other->verdict != claim.verdict )
		{
			out.notes.push_back( before.name + ": from " + verdictName( claim.verdict ) + " to " +
			                     verdictName( other->verdict ) + ": " + claim.text );
		}
	}
}

Json valueOf( const Json& json, const char* key )
{
	return json.is_object() ? json.value( key, Json() ) : Json();
}

/// Adds a note for each of these entries of the provenance that differs: figures are comparable only if all are equal.
void compareProvenance( Comparison& out, const Json& before, const Json& after )
{
	for ( const char* key : { "processor", "simd", "compiler", "c_flags", "quick", "seed", "data_hash" } )
	{
		const Json a = valueOf( before, key ), b = valueOf( after, key );
		if ( a != b )
		{
			out.notes.push_back( std::string( "other " ) + key + ": " + a.dump() + ", then " + b.dump() );
		}
	}
}

/// The common drift of all times, and their scatter about it: Comparison::drift and scatter.
std::pair<double, double> driftOf( const Report& before, const Report& after )
{
	constexpr std::size_t ENOUGH = 20;
	std::map<std::string, Measure> times;
	std::vector<double> ratios;
	for ( const Report* report : { &before, &after } )
	{
		for ( const Outcome& outcome : report->outcomes )
		{
			for ( const Table& table : outcome.tables )
			{
				for ( const std::vector<Cell>& row : table.rows )
				{
					for ( std::size_t i = 0; i < row.size(); ++i )
					{
						const Measure* m = std::get_if<Measure>( &row[i] );
						if ( m == nullptr || !isTime( table.columns[i], *m, *m ) )
						{
							continue;
						}
						const std::string name =
						    outcome.name + "|" + table.id + "|" + nameOf( table, row ) + "|" + table.columns[i].name;
						const auto [found, is_new] = times.emplace( name, *m );
						if ( report == &after && !is_new && found->second.median > 0 )
						{
							ratios.push_back( m->median / found->second.median );
						}
					}
				}
			}
		}
	}
	if ( ratios.size() < ENOUGH )
	{
		return { 1, 0 };
	}
	const double drift = measure( ratios ).median;
	for ( double& ratio : ratios )
	{
		ratio = std::abs( ratio / drift - 1 );
	}
	return { drift, 100 * 3 * 1.4826 * measure( ratios ).median }; // of normal deviations
}

} // namespace

Comparison compare( const Report& before, const Report& after, double threshold, bool absolute )
{
	Comparison out;
	if ( !absolute )
	{
		std::tie( out.drift, out.scatter ) = driftOf( before, after );
	}
	compareProvenance( out, before.provenance, after.provenance );
	for ( const Outcome& outcome : before.outcomes )
	{
		const Outcome* other = find( after.outcomes, outcome.name, []( const Outcome& o ) { return o.name; } );
		if ( other == nullptr )
		{
			out.notes.push_back( outcome.name + ": in the first result only" );
			continue;
		}
		if ( valueOf( outcome.details, "data_hash" ) != valueOf( other->details, "data_hash" ) )
		{
			out.notes.push_back( outcome.name + ": other data" );
		}
		for ( const Table& table : outcome.tables )
		{
			const Table* same = find( other->tables, table.id, []( const Table& t ) { return t.id; } );
			if ( same == nullptr )
			{
				out.notes.push_back( outcome.name + ", " + table.id + ": in the first result only" );
				continue;
			}
			compareTable( out, outcome.name, table, *same, threshold );
		}
		compareClaims( out, outcome, *other );
	}
	return out;
}

std::string comparisonText( const Comparison& comparison, bool all )
{
	std::string out;
	for ( const std::string& note : comparison.notes )
	{
		out += "note: " + note + "\n";
	}
	if ( comparison.drift != 1 || comparison.scatter > 0 )
	{
		char text[200];
		std::snprintf( text, sizeof text,
		    "note: all times as a whole: %+.1f %%; one by one they scatter by %.1f %% about that; changes are what goes "
		    "beyond "
		    "both (--absolute: all)\n",
		    100 * ( comparison.drift - 1 ), comparison.scatter );
		out += text;
	}
	for ( const Difference& d : comparison.differences )
	{
		if ( d.change == Change::NOISE && !all )
		{
			continue;
		}
		char figures[128];
		std::snprintf( figures, sizeof figures, "%-8s %+8.1f %% (noise %.1f %%)  %10.4g -> %10.4g %s  ",
		    changeName( d.change ), d.percent, d.noise, d.before, d.after, d.unit.c_str() );
		out += figures + d.experiment + ", " + d.table + ": " + d.row + ": " + d.column + "\n";
	}
	const std::size_t better = comparison.count( Change::BETTER ), worse = comparison.count( Change::WORSE );
	out += std::to_string( comparison.differences.size() ) + " figures: " + std::to_string( better ) + " better, " +
	       std::to_string( worse ) + " worse, " + std::to_string( comparison.count( Change::OTHER ) ) +
	       " changed without a spread, " + std::to_string( comparison.count( Change::NOISE ) ) + " within noise\n";
	return out;
}
