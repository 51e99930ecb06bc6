// SPDX-License-Identifier: BSD-3-Clause
// Two results of experiments side by side: what changed, and what is noise.
#pragma once

#include "report.hpp"

#include <string>
#include <vector>

enum class Change
{
	NOISE, ///< quartiles overlap, or less than the threshold
	BETTER,
	WORSE,
	OTHER ///< a figure that tells no better from worse, or that was not measured several times, is another one
};
const char* changeName( Change change ); ///< "noise", "better", "worse", "changed"

/// One cell that is in both.
struct Difference
{
	std::string experiment, table, row, column, unit;
	double before = 0, after = 0; ///< medians
	double percent = 0;           ///< of the median
	double noise = 0;             ///< percent: half of the quartiles' widths, both together
	Change change = Change::NOISE;
};

struct Comparison
{
	std::vector<Difference> differences; ///< of all columns with `better`, and of claims whose verdict is another one
	std::vector<std::string> notes;      ///< why the two may not be comparable, and what is in one only
	std::size_t count( Change change ) const;
};

/// A measure has changed if the quartiles of the two do not overlap and the medians differ by more than `threshold` percent.
/// A plain figure has changed if it differs by more than that: there is no telling whether that is noise.
Comparison compare( const Report& before, const Report& after, double threshold );

/// As a text: notes, what got better or worse, and counts; with `all` the noise too.
std::string comparisonText( const Comparison& comparison, bool all );
