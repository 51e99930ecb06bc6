// SPDX-License-Identifier: BSD-3-Clause
// Contenders in turn, as in race.hpp, kept pass by pass: the differences between passes are the noise of a figure.
#pragma once

#include "report/experiment.hpp"

/// Times and answers of a contender.
struct Rounds
{
	std::vector<double> means;   ///< microseconds per question, one of each pass
	std::vector<double> medians; ///< microseconds of each question, over the passes
	std::vector<Answer> answers; ///< of the first pass
};

/// Puts the questions by their number, in order: `ask` of each contender gets a pointer to it as a double. Contenders take
/// turns question by question, in a new order each time. A first pass that is not counted warms up.
std::vector<Rounds> raceRounds( const std::vector<Contender>& contenders, std::size_t questions, int passes,
    Progress& progress, const std::string& what );

/// The number of the question that a contender of raceRounds() gets.
inline std::size_t questionNumber( const double* q )
{
	return static_cast<std::size_t>( *q );
}

inline Measure timeOf( const Rounds& rounds )
{
	return measure( rounds.means );
}

/// a over b pass by pass, less `less`: ratioOf( a, b, 1, 100 ) is by how many percent a takes longer.
Measure ratioOf( const Rounds& a, const Rounds& b, double less = 0, double scale = 1 );
