// SPDX-License-Identifier: BSD-3-Clause
// Two results of experiments side by side: changes, and noise.
#pragma once

#include "report/report.hpp"

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
	double percent = 0;           ///< of the median, beyond the drift of all times
	double noise = 0;             ///< percent: half of the quartiles' widths, both together
	Change change = Change::NOISE;
};

struct Comparison
{
	std::vector<Difference> differences; ///< of all columns with `better`, and of claims whose verdict is another one
	std::vector<std::string> notes;      ///< reasons why the two may not be comparable, and entries that only one has
	/// Times as a whole: the median of the ratio after / before, over all times measured several times; 1 for fewer than
	/// twenty of them.
	double drift = 1;
	/// Usual scatter of times about the drift, percent: three standard deviations, estimated from the median deviation. 0
	/// for fewer than twenty times.
	double scatter = 0;
	std::size_t count( Change change ) const;
};

/// A measure has changed if the quartiles of the two do not overlap and the medians differ by more than `threshold` percent.
/// A plain figure has changed if it differs by more than that: there is no telling whether that is noise.
/// Quartiles do not show an influence that lasts for a whole run (another program beside it): two runs of one program on a
/// busy machine differ by ten percent as a whole. So times are compared beyond that drift, which is reported, unless
/// `absolute`.
Comparison compare( const Report& before, const Report& after, double threshold, bool absolute = false );

/// As a text: notes, improvements and losses, and counts; with `all` the noise too.
std::string comparisonText( const Comparison& comparison, bool all );
