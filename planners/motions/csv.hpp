// SPDX-License-Identifier: BSD-3-Clause
// Comma-separated tables with a header: spaces around cells, CR LF ends, a byte order mark, "quoted" cells, blank lines and
// lines that start with # are understood.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace leeway::motions
{

/// No robot moves as far, as fast or as long; products of a few such numbers are finite.
constexpr double largest_number = 1e15;

struct CsvRow
{
	std::size_t line = 0; ///< in the file, from 1
	std::vector<std::string> cells;
};

struct CsvTable
{
	std::string file;
	std::vector<std::string> header;
	std::vector<CsvRow> rows;

	/// The number in a cell. Only finite decimal numbers are accepted, up to largest_number.
	/// @throws io::Error naming line and column
	double value( std::size_t row, std::size_t column ) const;
};

/// @param file "-": standard input
/// @throws io::Error (unreadable, no header, repeated or empty column name, a row with another number of cells)
CsvTable readCsv( const std::string& file );

/// The finite decimal number that is the whole of `text`.
std::optional<double> finiteNumber( const std::string& text );

/// Without blanks at both ends.
std::string trimmed( const std::string& text );

/// Cell text, quoted if it must be.
std::string csvCell( const std::string& text );

} // namespace leeway::motions
