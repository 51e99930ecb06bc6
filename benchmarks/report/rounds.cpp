// SPDX-License-Identifier: BSD-3-Clause
// Contenders in turn, pass by pass: see rounds.hpp.
#include "report/rounds.hpp"

std::vector<Rounds> raceRounds( const std::vector<Contender>& contenders, std::size_t questions, int passes,
    Progress& progress, const std::string& what )
{
	std::vector<Rounds> all( contenders.size() );
	std::vector<std::vector<std::vector<double>>> times( contenders.size(), std::vector<std::vector<double>>( questions ) );
	std::mt19937_64 random; // its default seed
	std::vector<std::size_t> order( contenders.size() );
	std::iota( order.begin(), order.end(), std::size_t{ 0 } );
	for ( int pass = -1; pass < passes; ++pass )
	{
		std::vector<double> sums( contenders.size(), 0.0 );
		for ( std::size_t i = 0; i < questions; ++i )
		{
			// In a new order each time: a contender that follows one with much memory finds the caches cold
			for ( std::size_t k = order.size(); k-- > 1; )
			{
				std::swap( order[k], order[random() % ( k + 1 )] );
			}
			const double number = static_cast<double>( i );
			for ( const std::size_t c : order )
			{
				const double start = threadMicroseconds();
				const Answer answer = contenders[c].ask( &number );
				const double taken = threadMicroseconds() - start;
				if ( pass < 0 )
				{
					all[c].answers.push_back( answer );
					continue;
				}
				sums[c] += taken;
				times[c][i].push_back( taken );
			}
		}
		for ( std::size_t c = 0; pass >= 0 && c < contenders.size(); ++c )
		{
			all[c].means.push_back( sums[c] / static_cast<double>( questions ) );
		}
		progress.at( ( pass + 2.0 ) / ( passes + 1.0 ), what );
	}
	for ( std::size_t c = 0; c < contenders.size(); ++c )
	{
		for ( const std::vector<double>& of_question : times[c] )
		{
			all[c].medians.push_back( median( of_question ) );
		}
	}
	return all;
}

Measure ratioOf( const Rounds& a, const Rounds& b, double less, double scale )
{
	std::vector<double> ratios;
	for ( std::size_t pass = 0; pass < a.means.size(); ++pass )
	{
		ratios.push_back( scale * ( a.means[pass] / b.means[pass] - less ) );
	}
	return measure( ratios );
}
