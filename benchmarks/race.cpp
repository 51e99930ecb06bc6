// SPDX-License-Identifier: BSD-3-Clause
// Contenders in turn: see race.hpp.
#include "race.hpp"

#include <algorithm>
#include <ctime>

double median( std::vector<double> values )
{
	if ( values.empty() )
	{
		return 0;
	}
	const auto middle = values.begin() + static_cast<std::ptrdiff_t>( values.size() / 2 );
	std::nth_element( values.begin(), middle, values.end() );
	return *middle;
}

Summary summarise( std::vector<double> values )
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

nlohmann::ordered_json toJson( const Summary& summary )
{
	return { { "median_us", summary.median }, { "mean_us", summary.mean }, { "p95_us", summary.p95 } };
}

double threadMicroseconds()
{
	timespec now;
	clock_gettime( CLOCK_THREAD_CPUTIME_ID, &now );
	return 1e6 * static_cast<double>( now.tv_sec ) + 1e-3 * static_cast<double>( now.tv_nsec );
}

std::vector<Run> race( const std::vector<Contender>& contenders, const std::vector<std::vector<double>>& questions,
	int repetitions )
{
	const std::size_t n = questions.size();
	std::vector<std::vector<std::vector<double>>> times( contenders.size(), std::vector<std::vector<double>>( n ) );
	std::vector<Run> runs( contenders.size() );
	for ( int pass = 0; pass < repetitions; ++pass )
	{
		for ( std::size_t i = 0; i < n; ++i )
		{
			for ( std::size_t k = 0; k < contenders.size(); ++k )
			{
				// Everybody is first as often: the first one finds the caches as another question left them
				const std::size_t c = ( k + i + static_cast<std::size_t>( pass ) ) % contenders.size();
				const double start = threadMicroseconds();
				const Answer answer = contenders[c].ask( questions[i].data() );
				times[c][i].push_back( threadMicroseconds() - start );
				if ( pass == 0 )
				{
					runs[c].answers.push_back( answer );
				}
			}
		}
	}
	for ( std::size_t c = 0; c < contenders.size(); ++c )
	{
		for ( const std::vector<double>& of_question : times[c] )
		{
			runs[c].microseconds.push_back( median( of_question ) );
		}
	}
	return runs;
}
