// SPDX-License-Identifier: BSD-3-Clause
// Robot states from the columns of a table.
#pragma once

#include "motions/csv.hpp"
#include "program/setup.hpp"

#include <string>
#include <utility>
#include <vector>

namespace leeway::cli
{

/// Maps columns to robot variables.
class StateColumns
{
public:
	/// @param prefix of the columns that are meant, e.g. "from:"; empty = all columns
	/// @param notices gets a line about columns that are no variables of the robot, and one about variables without a column
	/// @throws io::Error naming a column that means a moving joint but none of its values
	StateColumns( const CsvTable& table, const std::string& prefix, const Workbench& bench, const io::RobotModel& robot,
	    Notices& notices );

	/// The full state of a row: its columns over `base`.
	/// @throws io::Error naming line and column of a cell that is not a finite number
	std::vector<double> full( std::size_t row, const std::vector<double>& base ) const;

	/// Columns in use: (column, robot variable).
	const std::vector<std::pair<std::size_t, std::uint32_t>>& used() const { return m_used; }

private:
	void noteMissing( const std::string& prefix, const Workbench& bench, Notices& notices ) const;
	const CsvTable& m_table;
	std::vector<std::pair<std::size_t, std::uint32_t>> m_used;
};

/// The columns env_lower ... self_link2 that `check` and `edge` share, and the margins of the two pairs if there are any.
std::string clearanceHeader( bool margins );
/// Their cells; those of a question that was not asked are empty.
std::string clearanceCells( const Named& environment, const Named& self, bool margins );

/// Tells about a table that has a header only: then there are no answers, perhaps by mistake.
void noteEmpty( Notices& notices, const CsvTable& table );

/// Tells about values outside of joint limits: the first rows, then a count. Nothing is clamped.
void noteLimits( Notices& notices, const std::string& file, std::size_t row, const std::vector<std::string>& violations );

/// Median and mean of a sample, for a summary line.
std::pair<double, double> medianAndMean( std::vector<double> values );

} // namespace leeway::cli
