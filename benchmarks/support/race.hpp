// SPDX-License-Identifier: BSD-3-Clause
// Contenders that answer the same questions in turn, and the times they took.
//
// Each passes over a set of states several times; the time of a state is the median over the passes. Passes go over the
// whole set, so that no contender sees the same state twice in a row and profits from its last answer. They take turns every
// few states, as a planner uses one library and not all of them in turn: the next contender finds the caches cold and has a
// few states to warm them. The time of reading the clock, a system call, is measured and subtracted.
#pragma once

#include "support/configurations.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <functional>
#include <nlohmann/json.hpp>
#include <numeric>
#include <random>
#include <string>
#include <vector>

/// An answer: an interval for distances, lower = upper = 0 or 1 for questions of yes and no.
struct Answer
{
	double lower = 0, upper = 0;
};

/// Somebody who answers a question about a state.
struct Contender
{
	std::string name;
	std::function<Answer( const double* q )> ask;
};

/// Results of a contender on a set: per state its answer (of the first pass), its time, and the times of all passes.
struct Run
{
	std::vector<Answer> answers;
	std::vector<double> microseconds;        ///< medians over the passes
	std::vector<std::vector<double>> passes; ///< of each state
};

inline double median( std::vector<double> values )
{
	if ( values.empty() )
	{
		return 0;
	}
	const auto middle = values.begin() + static_cast<std::ptrdiff_t>( values.size() / 2 );
	std::nth_element( values.begin(), middle, values.end() );
	return *middle;
}

struct Summary
{
	double median = 0, mean = 0, p95 = 0;
	double lower = 0, upper = 0; ///< quartiles of the mean over the passes; 0: there was one pass
};

inline Summary summarise( std::vector<double> values )
{
	Summary summary;
	if ( values.empty() )
	{
		return summary;
	}
	std::sort( values.begin(), values.end() );
	summary.median = median( values );
	summary.p95 = values[std::min( values.size() - 1, values.size() * 95 / 100 )];
	for ( double value : values )
	{
		summary.mean += value / static_cast<double>( values.size() );
	}
	return summary;
}

/// Of sorted values, share in [0, 1], between the two next to it.
inline double quantile( const std::vector<double>& sorted, double share )
{
	const double place = share * static_cast<double>( sorted.size() - 1 );
	const auto below = static_cast<std::size_t>( place );
	const std::size_t above = std::min( below + 1, sorted.size() - 1 );
	return sorted[below] + ( place - static_cast<double>( below ) ) * ( sorted[above] - sorted[below] );
}

/// Times of some states of a run, with the spread of their mean.
inline Summary summarise( const Run& run, const std::vector<std::size_t>& states )
{
	std::vector<double> times, means;
	for ( const std::size_t i : states )
	{
		times.push_back( run.microseconds[i] );
		means.resize( run.passes[i].size(), 0.0 );
		for ( std::size_t pass = 0; pass < means.size(); ++pass )
		{
			means[pass] += run.passes[i][pass] / static_cast<double>( states.size() );
		}
	}
	Summary summary = summarise( std::move( times ) );
	if ( means.size() > 1 )
	{
		std::sort( means.begin(), means.end() );
		summary.lower = quantile( means, 0.25 );
		summary.upper = quantile( means, 0.75 );
	}
	return summary;
}

inline Summary summarise( const Run& run )
{
	std::vector<std::size_t> all( run.microseconds.size() );
	std::iota( all.begin(), all.end(), std::size_t{ 0 } );
	return summarise( run, all );
}

/// To five digits: no time here is better, and files stay small.
inline double rounded( double value )
{
	if ( !( std::abs( value ) > 0 ) || !std::isfinite( value ) )
	{
		return value;
	}
	const double scale = std::pow( 10, 4 - std::floor( std::log10( std::abs( value ) ) ) );
	return std::round( value * scale ) / scale;
}

inline nlohmann::ordered_json toJson( const Summary& summary )
{
	nlohmann::ordered_json json = { { "median_us", rounded( summary.median ) }, { "mean_us", rounded( summary.mean ) },
	    { "p95_us", rounded( summary.p95 ) } };
	if ( summary.upper > 0 )
	{
		json["lower_us"] = rounded( summary.lower );
		json["upper_us"] = rounded( summary.upper );
	}
	return json;
}

/// Processor time of this thread: other programs on the machine do not lengthen a query.
inline double threadMicroseconds()
{
	timespec now;
	clock_gettime( CLOCK_THREAD_CPUTIME_ID, &now );
	return 1e6 * static_cast<double>( now.tv_sec ) + 1e-3 * static_cast<double>( now.tv_nsec );
}

/// The same of all threads: planners may use several.
inline double processMicroseconds()
{
	timespec now;
	clock_gettime( CLOCK_PROCESS_CPUTIME_ID, &now );
	return 1e6 * static_cast<double>( now.tv_sec ) + 1e-3 * static_cast<double>( now.tv_nsec );
}

/// Median time between two successive readings of the clock.
inline double clockMicroseconds()
{
	std::vector<double> apart;
	for ( int i = 0; i < 201; ++i )
	{
		const double start = threadMicroseconds();
		apart.push_back( threadMicroseconds() - start );
	}
	return median( std::move( apart ) );
}

/// @param block states in a row for one contender before the next one's turn: with 1 each contender finds the caches full of
/// others' trees; with more they hold its own for most of the block, as under a planner
inline std::vector<Run> race(
    const std::vector<Contender>& contenders, const ConfigurationSet& set, int repetitions, std::size_t block = 24 )
{
	const std::size_t n = set.states.size();
	std::vector<std::vector<std::vector<double>>> times( contenders.size(), std::vector<std::vector<double>>( n ) );
	std::vector<Run> runs( contenders.size() );
	std::mt19937_64 random; // its default seed
	std::vector<std::size_t> order( contenders.size() );
	std::iota( order.begin(), order.end(), std::size_t{ 0 } );
	const double clock = clockMicroseconds();
	for ( int pass = 0; pass < repetitions; ++pass )
	{
		for ( std::size_t first = 0; first < n; first += block )
		{
			for ( std::size_t k = order.size(); k-- > 1; )
			{
				std::swap( order[k], order[random() % ( k + 1 )] );
			}
			for ( const std::size_t c : order )
			{
				for ( std::size_t i = first; i < std::min( n, first + block ); ++i )
				{
					const double start = threadMicroseconds();
					const Answer answer = contenders[c].ask( set.states[i].data() );
					times[c][i].push_back( std::max( 0.0, threadMicroseconds() - start - clock ) );
					if ( pass == 0 )
					{
						runs[c].answers.push_back( answer );
					}
				}
			}
		}
	}
	for ( std::size_t c = 0; c < contenders.size(); ++c )
	{
		for ( const std::vector<double>& of_state : times[c] )
		{
			runs[c].microseconds.push_back( median( of_state ) );
		}
		runs[c].passes = std::move( times[c] );
	}
	return runs;
}
