// SPDX-License-Identifier: BSD-3-Clause
// Paths without constraints: those of the planner of joint space (leeway/planners/planner.hpp), whose edges are proved as they are.
#pragma once

#include "leeway/manifold/plan.hpp"
#include "leeway/planners/planner.hpp"
#include "walk.hpp"

namespace leeway::manifold
{

class FreePath
{
public:
	/// All have to outlive it.
	FreePath( const io::Problem& problem, lw_query* query, const Walker& walker )
	    : m_problem( problem ), m_query( query ), m_walker( walker )
	{
	}
	/// @param result gets samples and nodes @throws CoreError, planners::InputError (a floating joint, an end beyond a limit)
	bool find( const State& start, const std::vector<State>& goals, const planners::Settings& settings, planners::Stop stop,
	    Result& result, std::vector<Piece>& path );
	bool isFound() const { return m_found.count() > 0; }
	/// Shortens the path. @throws CoreError
	void smooth( const Settings& settings, planners::Stop stop, std::vector<Piece>& path );

private:
	void take( std::vector<Piece>& path ) const;

	const io::Problem& m_problem;
	lw_query* m_query;
	const Walker& m_walker;
	State m_start;
	planners::Path m_found;
};

} // namespace leeway::manifold
