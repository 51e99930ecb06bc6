// SPDX-License-Identifier: BSD-3-Clause
// Least clearances of paths before and after planners::raiseClearance(): one line for each set of problems.
#pragma once

#include "support/edge_worlds.hpp"

#include "leeway/planners/clearance.hpp"

#include <string>
#include <vector>

class ClearanceTally
{
public:
	/// Raises the clearance of a copy of the path. @param states of the path, each of the world's size
	void add( const EdgeWorld& world, const std::vector<std::vector<double>>& states, double goal, double seconds );
	void add( const ClearanceTally& more ) { m_rows.insert( m_rows.end(), more.m_rows.begin(), more.m_rows.end() ); }

	static void printHeader( double goal );
	void print( const std::string& set ) const;
	Json json( const std::string& set ) const;

private:
	/// One path. Clearances are the smaller ones of both kinds of pairs; `part` is a kind, or both.
	struct Row
	{
		leeway::planners::ClearanceRange before[3], after[3], middle_before[3], middle_after[3]; ///< environment, self, both
		double ends[3];
		double length_ratio, wall_ms, cpu_ms, goal;
		bool changed, proved;
	};
	struct Summary
	{
		double before, after, ratio;
		std::size_t could,
		    doubled; ///< paths whose ends and goal allow twice the clearance, and those that proved twice of what was measured before
	};
	Summary summary( unsigned part, bool middle ) const;
	std::vector<Row> m_rows;
};
