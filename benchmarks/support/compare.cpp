// SPDX-License-Identifier: BSD-3-Clause
// Two files of results side by side: see compare.hpp.
#include "support/compare.hpp"

#include "support/race.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

namespace
{

struct Time
{
	double value = 0, lower = 0, upper = 0; ///< quartiles 0: there are none
	bool hasSpread() const { return upper > 0; }
};

bool isHash( const std::string& name )
{
	return name == "answers" || ( name.size() >= 4 && name.compare( name.size() - 4, 4, "hash" ) == 0 );
}

/// Words that name a row. Numbers of a row are results, except those that earlier files had as names.
std::string nameOf( const Json& row )
{
	std::string name;
	for ( const auto& [key, value] : row.items() )
	{
		if ( key == "length" || ( value.is_string() && !isHash( key ) && key != "verdicts" ) )
		{
			name += ( name.empty() ? "" : ", " ) + ( value.is_string() ? value.get<std::string>() : value.dump() );
		}
	}
	return name;
}

std::string groupOf( const Json& row )
{
	for ( const char* key : { "robot", "library", "group", "way", "setting" } )
	{
		if ( row.contains( key ) && row[key].is_string() )
		{
			return row[key].get<std::string>();
		}
	}
	return "all";
}

/// The times of a row: its own, called "", and those of its parts.
std::map<std::string, Time> timesOf( const Json& row, const std::string& by )
{
	std::map<std::string, Time> times;
	const auto add = [&]( const std::string& name, const Json& part )
	{
		if ( part.contains( by ) )
		{
			times[name] = { part[by].get<double>(), part.value( "lower_us", 0.0 ), part.value( "upper_us", 0.0 ) };
			times[name].upper = by == "mean_us" ? times[name].upper : 0; // quartiles are those of the mean
		}
	};
	add( "", row );
	for ( const auto& [name, part] : row.items() )
	{
		if ( part.is_object() )
		{
			add( name, part );
		}
	}
	return times;
}

/// Rows by name; the second of the same name has a number behind it.
std::map<std::string, const Json*> rowsOf( const Json& file )
{
	if ( !file.is_object() || !file.contains( "rows" ) || !file["rows"].is_array() )
	{
		throw std::runtime_error( "it has no rows: give a file of leeway-bench COMMAND --json" );
	}
	std::map<std::string, const Json*> rows;
	for ( const Json& row : file["rows"] )
	{
		const std::string name = nameOf( row );
		std::string unique = name;
		for ( int k = 2; !rows.emplace( unique, &row ).second; ++k )
		{
			unique = name + " #" + std::to_string( k );
		}
	}
	return rows;
}

/// A note for each of these that differs: times are comparable only if all are equal.
void compareOrigins( Comparison& out, const Json& before, const Json& after )
{
	const auto note = [&out]( const std::string& key, const Json& a, const Json& b )
	{
		if ( a != b )
		{
			out.notes.push_back( "other " + key + ": " + a.dump() + ", then " + b.dump() );
		}
	};
	const auto part = []( const Json& file, const char* name ) { return file.value( name, Json::object() ); };
	const Json a = part( before, "provenance" ), b = part( after, "provenance" );
	for ( const char* key : { "processor", "simd", "compiler", "c_flags", "quick", "seed" } )
	{
		note( key, a.value( key, Json() ), b.value( key, Json() ) );
	}
	const Json x = part( before, "options" ), y = part( after, "options" );
	for ( const auto& [name, value] : x.items() )
	{
		note( name, value, y.value( name, Json() ) );
	}
}

const char* verdictOf( char letter )
{
	return letter == 'F' ? "FREE" : letter == 'B' ? "BLOCKED" : "UNDECIDED";
}

void compareVerdicts( Comparison& out, const std::string& row, const std::string& before, const std::string& after )
{
	for ( std::size_t i = 0; i < std::min( before.size(), after.size() ); ++i )
	{
		++out.verdicts;
		if ( before[i] != after[i] )
		{
			const bool sure = before[i] != 'U' && after[i] != 'U';
			out.answers.push_back(
			    { row, "edge " + std::to_string( i ), verdictOf( before[i] ), verdictOf( after[i] ), sure } );
		}
	}
}

void compareAnswers( Comparison& out, const std::string& name, const Json& before, const Json& after )
{
	if ( before.value( "edges_hash", "" ) != after.value( "edges_hash", "" ) )
	{
		out.notes.push_back( name + ": other edges; their verdicts are not compared" );
		return;
	}
	for ( const auto& [key, value] : before.items() )
	{
		if ( !value.is_string() || !after.contains( key ) || !after[key].is_string() || value == after[key] )
		{
			if ( key == "verdicts" && after.contains( key ) )
			{
				out.verdicts += value.get<std::string>().size();
			}
			continue;
		}
		if ( key == "verdicts" )
		{
			compareVerdicts( out, name, value.get<std::string>(), after[key].get<std::string>() );
		}
		else if ( isHash( key ) )
		{
			out.answers.push_back( { name, key, value.get<std::string>(), after[key].get<std::string>(), false } );
		}
	}
}

struct Pair
{
	Difference difference;
	Time before, after;
};

Change judge( const Pair& pair, const Comparison& out, double threshold )
{
	if ( !pair.before.hasSpread() || !pair.after.hasSpread() )
	{
		return Change::UNKNOWN;
	}
	const double ratio = pair.difference.ratio / out.drift;
	const bool apart = pair.after.lower > pair.before.upper * out.drift || pair.after.upper < pair.before.lower * out.drift;
	if ( !apart || 100 * std::abs( ratio - 1 ) <= std::max( threshold, out.scatter ) )
	{
		return Change::NOISE;
	}
	return ratio > 1 ? Change::WORSE : Change::BETTER;
}

/// The drift of all times with a spread, and their scatter about it.
void measureDrift( Comparison& out, const std::vector<Pair>& pairs )
{
	constexpr std::size_t ENOUGH = 20;
	std::vector<double> ratios;
	for ( const Pair& pair : pairs )
	{
		if ( pair.before.hasSpread() && pair.after.hasSpread() && pair.before.value > 0 )
		{
			ratios.push_back( pair.difference.ratio );
		}
	}
	if ( ratios.size() < ENOUGH )
	{
		return;
	}
	out.drift = median( ratios );
	for ( double& ratio : ratios )
	{
		ratio = std::abs( ratio / out.drift - 1 );
	}
	out.scatter = 100 * 3 * 1.4826 * median( ratios ); // of normal deviations
}

} // namespace

std::size_t Comparison::count( Change change ) const
{
	return static_cast<std::size_t>( std::count_if(
	    differences.begin(), differences.end(), [change]( const Difference& d ) { return d.change == change; } ) );
}

bool Comparison::isWorse() const
{
	return count( Change::WORSE ) > 0 ||
	       std::any_of( answers.begin(), answers.end(), []( const ChangedAnswer& a ) { return a.contradicts; } );
}

Comparison compare( const Json& before, const Json& after, const CompareOptions& options )
{
	Comparison out;
	const auto old_rows = rowsOf( before ), new_rows = rowsOf( after );
	compareOrigins( out, before, after );
	std::vector<Pair> pairs;
	std::size_t only_before = 0;
	for ( const auto& [name, row] : old_rows )
	{
		const auto found = new_rows.find( name );
		if ( found == new_rows.end() )
		{
			++only_before;
			continue;
		}
		compareAnswers( out, name, *row, *found->second );
		const std::map<std::string, Time> now = timesOf( *found->second, options.by );
		for ( const auto& [time, was] : timesOf( *row, options.by ) )
		{
			const auto is = now.find( time );
			if ( is != now.end() )
			{
				const double ratio = was.value == is->second.value ? 1 : is->second.value / was.value;
				pairs.push_back( { { groupOf( *row ), name, time, was.value, is->second.value, ratio, Change::NOISE }, was,
				    is->second } );
			}
		}
	}
	const std::size_t both = old_rows.size() - only_before;
	if ( only_before > 0 || both < new_rows.size() )
	{
		out.notes.push_back( std::to_string( only_before ) + " rows are in the first file only, " +
		                     std::to_string( new_rows.size() - both ) + " in the second only" );
	}
	if ( !options.absolute )
	{
		measureDrift( out, pairs );
	}
	for ( Pair& pair : pairs )
	{
		pair.difference.change = judge( pair, out, options.threshold );
		out.differences.push_back( pair.difference );
	}
	return out;
}

std::map<std::pair<std::string, std::string>, Ratios> ratiosOf( const Comparison& comparison )
{
	std::map<std::pair<std::string, std::string>, Ratios> all;
	for ( const Difference& d : comparison.differences )
	{
		if ( !( d.before > 0 && d.after > 0 ) )
		{
			continue;
		}
		for ( const std::string& group : { d.group, std::string() } )
		{
			Ratios& r = all[{ d.time, group }];
			r.least = r.count == 0 ? d.ratio : std::min( r.least, d.ratio );
			r.most = r.count == 0 ? d.ratio : std::max( r.most, d.ratio );
			r.mean = std::exp( ( std::log( r.mean ) * static_cast<double>( r.count ) + std::log( d.ratio ) ) /
			                   static_cast<double>( r.count + 1 ) );
			++r.count;
		}
	}
	return all;
}

namespace
{

template <typename... Values> std::string line( const char* format, Values... values )
{
	char text[512];
	std::snprintf( text, sizeof text, format, values... );
	return text;
}

std::string groupLines( const Comparison& comparison )
{
	std::string out = line( "%-20s %-36s %6s %8s %8s %8s\n", "after / before", "", "times", "mean", "least", "most" );
	for ( const auto& [name, r] : ratiosOf( comparison ) )
	{
		out += line( "%-20.20s %-36.36s %6zu %8.3f %8.3f %8.3f\n", name.first.c_str(),
		    name.second.empty() ? "geometric mean of all" : name.second.c_str(), r.count, r.mean, r.least, r.most );
	}
	return out;
}

std::string answerLines( const Comparison& comparison )
{
	std::string out;
	std::size_t contradictions = 0, verdicts = 0;
	for ( const ChangedAnswer& a : comparison.answers )
	{
		out += "answer: " + a.row + ": " + a.what + ": " + a.before + ", then " + a.after +
		       ( a.contradicts ? " CONTRADICTION\n" : "\n" );
		contradictions += a.contradicts;
		verdicts += a.what.compare( 0, 5, "edge " ) == 0;
	}
	if ( comparison.verdicts > 0 )
	{
		out += line(
		    "verdicts: %zu of %zu changed, %zu contradict each other\n", verdicts, comparison.verdicts, contradictions );
	}
	return out;
}

} // namespace

std::string comparisonText( const Comparison& comparison, bool all )
{
	static const char* const names[] = { "noise", "better", "worse", "" };
	std::string out;
	for ( const std::string& note : comparison.notes )
	{
		out += "note: " + note + "\n";
	}
	if ( comparison.drift != 1 || comparison.scatter > 0 )
	{
		out += line(
		    "note: all times as a whole: %+.1f %%; one by one they scatter by %.1f %% about that; better and worse are "
		    "beyond both (--absolute: all)\n",
		    100 * ( comparison.drift - 1 ), comparison.scatter );
	}
	for ( const Difference& d : comparison.differences )
	{
		if ( all || d.change == Change::BETTER || d.change == Change::WORSE )
		{
			out += line( "%-7s %8.3f  %10.4g -> %10.4g us  ", names[static_cast<int>( d.change )], d.ratio, d.before,
			           d.after ) +
			       d.row + ( d.time.empty() ? "" : ": " + d.time ) + "\n";
		}
	}
	out += groupLines( comparison ) + answerLines( comparison );
	out += line( "%zu times: %zu better, %zu worse, %zu within noise, %zu measured once\n", comparison.differences.size(),
	    comparison.count( Change::BETTER ), comparison.count( Change::WORSE ), comparison.count( Change::NOISE ),
	    comparison.count( Change::UNKNOWN ) );
	return out;
}
