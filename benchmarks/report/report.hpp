// SPDX-License-Identifier: BSD-3-Clause
// Outcomes of experiments as files: one JSON, a page that needs nothing else, pictures by gnuplot.
#pragma once

#include "report/experiment.hpp"

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

/// Outcomes, and their provenance.
struct Report
{
	nlohmann::ordered_json provenance; ///< commit, machine, settings: common to all outcomes
	std::vector<Outcome> outcomes;
	/// Of the page; not kept in JSON.
	std::string title = "leeway: the trade measured";
	std::string about =
	    "What was claimed, and what this run saw. Times are medians over passes with their quartiles; a verdict comes "
	    "from the figures of this run.";
};

nlohmann::ordered_json toJson( const Report& report );
Report reportFromJson( const nlohmann::ordered_json& json ); ///< @throws std::exception, as outcomeFromJson()
void writeJson( const Report& report, const std::string& file );
/// @throws std::runtime_error naming the file and its error
Report readReport( const std::string& file );

enum class Picture
{
	SVG,
	PNG
};

/// The gnuplot script that draws a plot into a file.
std::string gnuplotScript( const Plot& plot, Picture picture, const std::string& file );

bool hasGnuplot();

/// In a locale that knows the characters of our labels, whatever the user's is.
/// @throws std::runtime_error if gnuplot fails
void runGnuplot( const std::string& script );

/// An SVG as part of a page: no XML header, and every id with a prefix of its own, since a page has many pictures.
std::string embeddedSvg( const std::string& svg, const std::string& prefix );

/// The page. @param pictures SVG of each plot, by "<experiment>-<plot>"; of those that are missing the caption is there
std::string htmlPage( const Report& report, const std::map<std::string, std::string>& pictures );

/// The page with all pictures as one file.
/// @throws std::runtime_error without gnuplot, or if something cannot be written or drawn
void writePage( const Report& report, const std::string& file );

/// index.html, result.json, and each plot as SVG and PNG into a folder, which is made.
/// @throws std::runtime_error without gnuplot, or if something cannot be written or drawn
void writeReport( const Report& report, const std::string& folder );
