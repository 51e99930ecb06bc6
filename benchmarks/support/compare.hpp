// SPDX-License-Identifier: BSD-3-Clause
// Two files of results side by side, row by row: ratios of times, verdicts and answers that changed.
#pragma once

#include "support/result.hpp"

#include <cstddef>
#include <map>
#include <string>
#include <utility>
#include <vector>

enum class Change
{
	NOISE, ///< quartiles overlap, or less than the threshold
	BETTER,
	WORSE,
	UNKNOWN ///< measured once: whether that is noise is not known
};

/// A time that is in both.
struct Difference
{
	std::string group, row, time; ///< group: the row's robot, library, way or setting
	double before = 0, after = 0; ///< microseconds
	double ratio = 1;             ///< after / before, 1 where both are 0
	Change change = Change::NOISE;
};

/// An edge's verdict that is another one, or a hash of answers.
struct ChangedAnswer
{
	std::string row, what;     ///< "edge 17", or the name of the hash
	std::string before, after; ///< FREE, BLOCKED, UNDECIDED; or the hashes
	bool contradicts = false;  ///< free in one and blocked in the other
};

struct Comparison
{
	std::vector<Difference> differences;
	std::vector<ChangedAnswer> answers;
	std::size_t verdicts = 0;       ///< that were compared
	std::vector<std::string> notes; ///< reasons why the two may not be comparable, and rows that only one has
	/// Times as a whole: the median of the ratios of times with quartiles; 1 for fewer than twenty of them.
	double drift = 1;
	/// Usual scatter of these ratios about the drift, percent: three standard deviations, estimated from the median deviation.
	double scatter = 0;

	std::size_t count( Change change ) const;
	/// True if a time got worse beyond noise, or verdicts contradict each other.
	bool isWorse() const;
};

struct CompareOptions
{
	double threshold = 3;       ///< percent: less is noise
	bool absolute = false;      ///< do not take off the common drift of all times: for quiet machines
	std::string by = "mean_us"; ///< or "median_us", "p95_us"
};

/// A time has changed if its quartiles do not overlap and the means differ by more than the threshold. Quartiles do not show an
/// influence that lasts for a whole run (another program beside it), so times are compared beyond the drift that all have in
/// common, which is reported, unless `absolute`.
/// @param before, after files of leeway-bench, read as JSON @throws std::exception if they are none
Comparison compare( const Json& before, const Json& after, const CompareOptions& options );

/// Ratios of the times of a group, or of all rows.
struct Ratios
{
	std::size_t count = 0;
	double mean = 1, least = 1, most = 1; ///< geometric mean
};

/// By time ("" are the rows' own, "certified" those of a part) and group; the group "" is all of them.
std::map<std::pair<std::string, std::string>, Ratios> ratiosOf( const Comparison& comparison );

/// As a text: notes, a line for each group and the geometric mean, changes beyond noise, answers. @param all every row too
std::string comparisonText( const Comparison& comparison, bool all );
