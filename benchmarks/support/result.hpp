// SPDX-License-Identifier: BSD-3-Clause
// Results of a subcommand: rows with their origin, written as JSON or CSV. compare.hpp sets two of them side by side.
//
// The fields of a row that are words name it: "robot", "set", "verdict". Times stand in mean_us, median_us, p95_us, or in objects
// with these fields; lower_us and upper_us are the quartiles of the mean over the passes. A field whose name ends in "hash" is
// about answers: equal work has equal hashes. "verdicts" is a word with one letter for each edge.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

using Json = nlohmann::ordered_json;

class Result
{
public:
	/// Notes the origin now: sources may change while the work goes on.
	explicit Result( const std::string& command );

	/// An entry beside the rows.
	Json& operator[]( const char* name ) { return m_json[name]; }
	void add( Json row );
	const Json& rows() const { return m_json.at( "rows" ); }
	/// Processor, compiler and commit in one line.
	std::string origin() const;

	/// @param file may be empty: nothing is written @throws std::runtime_error that names the file
	void writeJson( const std::string& file ) const;
	/// A column for each field; those of objects are called OBJECT.FIELD, and lists are left out.
	void writeCsv( const std::string& file ) const;
	std::string csv() const;

private:
	Json m_json;
};
