// SPDX-License-Identifier: BSD-3-Clause
// The world of `leeway world`: its file with the motions of the command line, and its checker.
#pragma once

#include "leeway/motions/schedule.hpp"
#include "program/setup.hpp"

#include <set>
#include <string>
#include <vector>

namespace leeway::cli
{

class Cell
{
public:
	/// @param focus parts whose clearances count; empty: all. Pairs of other parts are left out
	Cell( const WorldOptions& options, Notices& notices, const std::set<std::string>& focus = {} );

	const io::WorldModel& world() const { return *m_input.world; }
	const Input& input() const { return m_input; }
	const Workbench& bench() const { return m_bench; }
	/// The motions of the file and of the command line.
	Schedule& schedule() { return m_schedule; }

private:
	Input m_input;
	Workbench m_bench;
	Schedule m_schedule;
};

/// The robot or object that a link belongs to: its name up to the first slash.
std::string ownerOf( const std::string& link );

/// leeway world plan.
int runWorldPlan( const WorldOptions& options );

} // namespace leeway::cli
