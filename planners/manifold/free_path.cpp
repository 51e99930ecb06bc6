// SPDX-License-Identifier: BSD-3-Clause
#include "free_path.hpp"

#include "leeway/planners/smooth.hpp"

namespace leeway::manifold
{

bool FreePath::find( const State& start, const std::vector<State>& goals, const planners::Settings& settings,
    planners::Stop stop, Result& result, std::vector<Piece>& path )
{
	m_start = start;
	planners::Planner planner( m_problem.checker, settings );
	planner.addStart( start.data() );
	for ( const State& goal : goals )
	{
		planner.addGoal( goal.data() );
	}
	const planners::Outcome outcome = planner.solve( m_query, stop );
	result.samples += planner.statistics().samples;
	result.start_nodes += planner.statistics().start_nodes;
	result.goal_nodes += planner.statistics().goal_nodes;
	if ( outcome == planners::Outcome::FAILED )
	{
		leeway::require( planner.failure(), "search of joint space" );
	}
	m_found = planner.path();
	take( path );
	return outcome == planners::Outcome::SOLVED;
}

void FreePath::smooth( const Settings& settings, planners::Stop stop, std::vector<Piece>& path )
{
	planners::SmoothSettings by;
	by.edge = settings.edge;
	by.seed = settings.seed;
	by.rounds = settings.shortcuts > 0 ? by.rounds : 0;
	leeway::require( planners::smooth( m_problem.checker.get(), m_query, by, stop, m_found ), "smoothing" );
	take( path );
}

/// The edges of the path, from the start on without jumps by whole turns.
void FreePath::take( std::vector<Piece>& path ) const
{
	State before = m_start;
	path.clear();
	for ( std::size_t i = 1; i < m_found.count(); ++i )
	{
		const State next = m_walker.nearestTurns( before, Eigen::Map<const State>( m_found[i], before.size() ) );
		path.push_back( straightPiece( before, next ) );
		before = next;
	}
}

} // namespace leeway::manifold
