// SPDX-License-Identifier: BSD-3-Clause
// An experiment: its settings and its results (tables, plots, and claims held against them). report.hpp makes a page of the
// results.
#pragma once

#include "support/command.hpp"
#include "support/race.hpp"

#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <variant>
#include <vector>

/// Settings of all experiments.
struct ExperimentSettings
{
	std::string data =
	    LEEWAY_DATA_DIR; ///< folder with armar3, kit_kitchen and mbm; empty: only work that needs no data, for tests
	std::string out;     ///< folder for files of their own; empty: write none
	bool quick = false;  ///< a share of the work; all experiments together stay under two minutes
	bool smoke = false;  ///< the least that runs every line: seconds, for tests. Implies quick
	std::uint64_t seed = 20260101;
	double budget = 5; ///< seconds for proofs of pairs, per robot
	std::size_t pick( std::size_t full, std::size_t short_run, std::size_t least ) const
	{
		return smoke ? least : quick ? short_run : full;
	}
};

/// Told by an experiment how far it is.
class Progress
{
public:
	virtual ~Progress() = default;
	/// @param share of this experiment that is done, in [0, 1], never less than before.
	/// @param what name of the work at hand
	virtual void at( double share, const std::string& what ) = 0;
};

/// A part of another progress: its own 0 to 1 are `from` to `to` of the whole.
class PartProgress : public Progress
{
public:
	PartProgress( Progress& whole, double from, double to ) : m_whole( whole ), m_from( from ), m_to( to ) {}
	void at( double share, const std::string& what ) override { m_whole.at( m_from + share * ( m_to - m_from ), what ); }

private:
	Progress& m_whole;
	double m_from, m_to;
};

/// A figure that was measured several times: median and quartiles.
struct Measure
{
	double median = 0, lower = 0, upper = 0;
	std::size_t count = 0;
};

/// Of values in any order, quartiles by interpolation; zeros for none.
Measure measure( std::vector<double> values );

using Cell = std::variant<std::string, double, Measure>;

struct Column
{
	std::string name, unit; ///< unit "" = a word or a bare number
	/// +1 more is better, -1 less is better, 0 neither.
	int better = 0;
};

/// The cells in front of the first column with `better` name the row: no two rows may have equal names.
struct Table
{
	std::string id, title, note; ///< id: unique in the experiment, [a-z0-9-]
	std::vector<Column> columns;
	std::vector<std::vector<Cell>> rows; ///< each as long as columns
};

struct Axis
{
	std::string label, unit; ///< a unit is shown in brackets behind the label
	bool log = false;
	double from = std::numeric_limits<double>::quiet_NaN(); ///< NaN: by the data
	double to = std::numeric_limits<double>::quiet_NaN();
	double step = std::numeric_limits<double>::quiet_NaN(); ///< between labels; NaN: by the data
};

struct Point
{
	double x = 0, y = 0;
	double low = std::numeric_limits<double>::quiet_NaN(); ///< of y, the spread; NaN: none is drawn
	double high = std::numeric_limits<double>::quiet_NaN();
};

enum class Mark
{
	LINES,  ///< points joined by lines
	POINTS, ///< by themselves
	DASHES, ///< a dashed line without points: a bound, a promise, a reference
	BARS    ///< from 0 to y; in plots with `categories` only. Points where y is logarithmic
};

struct Series
{
	std::string name;
	std::vector<Point> points; ///< in the order of x if they are joined; a point that is not finite interrupts the line
	Mark mark = Mark::LINES;
	bool second = false; ///< belongs to the y axis on the right
};

struct Plot
{
	std::string id, title, caption; ///< id: unique in the experiment, [a-z0-9-]
	Axis x, y, y2;                  ///< y2 counts if a series is `second`
	std::vector<Series> series;
	/// Names along x, at 0, 1, 2, ...: series of POINTS and BARS are drawn side by side there.
	std::vector<std::string> categories;
};

enum class Verdict
{
	HOLDS,   ///< the claim is seen in our figures
	PARTLY,  ///< seen in some of them: `why` names these and gives the reason
	DIFFERS, ///< not seen: `why` gives the reason, by figures
	BROKEN   ///< one of our own promises is not kept: the run fails, exit status 1
};
const char* verdictName( Verdict verdict ); ///< "holds", "partly", "differs", "BROKEN"

/// A claim of a source and our figures beside it. Verdict and figures come from the data of the run, never from the source.
struct Claim
{
	std::string source; ///< of the claim: "paper, figure 9a"; "promise" for our own
	std::string text;   ///< the claim itself
	std::string figure; ///< our result, with figures and units
	Verdict verdict = Verdict::HOLDS;
	std::string why; ///< the difference and its reason; may be empty if the claim holds
};

struct Outcome
{
	std::string name, title, about; ///< about: the work and its data, one paragraph
	std::vector<Table> tables;
	std::vector<Plot> plots;
	std::vector<Claim> claims;
	nlohmann::ordered_json details; ///< settings of its own, hashes of its data, anything else worth keeping; may be null
	double seconds = 0;             ///< wall time, set by whoever ran it
};

/// True if no promise is broken.
bool promisesKept( const Outcome& outcome );

class Experiment
{
public:
	virtual ~Experiment() = default;
	virtual std::string name() const = 0; ///< of its subcommand: "paper"
	virtual std::string title() const = 0;
	/// Seconds it will take about, before it began: for the time left of several.
	virtual double expectedSeconds( const ExperimentSettings& settings ) const = 0;
	/// Options of its own, for its subcommand; the common ones are there already.
	virtual void addOptions( Command& ) {}
	/// @throws std::exception if it cannot be done
	virtual Outcome run( const ExperimentSettings& settings, Progress& progress ) = 0;
};

/// As it is kept in a file, and back. Figures are kept to six digits.
nlohmann::ordered_json toJson( const Outcome& outcome );
/// @throws std::exception with the field that is missing or of the wrong kind
Outcome outcomeFromJson( const nlohmann::ordered_json& json );
