// SPDX-License-Identifier: BSD-3-Clause
// Judges of edges: see edge_judges.hpp.
#include "peers/edge_judges.hpp"

#include "brute_distance.hpp"
#include "peers/brute_truth.hpp"

#include <cstdio>
#include <queue>
#include <stdexcept>

EdgeJudges::EdgeJudges( const EdgeWorld& world, std::shared_ptr<FclModels> models )
    : m_world( world ), m_query( leeway::makeQuery( world.checker.get() ) ),
      m_table_query( leeway::makeQuery( world.with_tables.get() ) ),
      m_state_query( leeway::makeQuery( world.checker.get() ) ),
      m_table_state_query( leeway::makeQuery( world.with_tables.get() ) ),
      m_spare( leeway::makeQuery( world.checker.get() ) )
{
	try
	{
		m_fcl = std::make_unique<FclPeer>( world.checker.get(), std::move( models ), world.allowed );
	}
	catch ( const std::runtime_error& error )
	{
		std::fprintf( stderr, "\r%s: judged without FCL: %s\n", world.name.c_str(), error.what() );
	}
	m_from.resize( lw_robot_variable_count( world.robot.get() ) );
	m_to = m_at = m_from;
}

bool EdgeJudges::byCertificate( const Motion& motion, bool tables, const lw_edge_def& def, lw_edge_result& result )
{
	leeway::require( lw_checker_edge( tables ? m_world.with_tables.get() : m_world.checker.get(),
	                     tables ? m_table_query.get() : m_query.get(), motion.from.data(), motion.to.data(), &def, &result ),
	    "an edge" );
	return result.verdict == LW_VERDICT_FREE;
}

/// As DiscreteMotionValidator::checkMotion( s1, s2 ): s1 is taken for valid.
template <typename IsValid> bool EdgeJudges::discrete( const Motion& motion, double fraction, const IsValid& is_valid )
{
	if ( !is_valid( motion.to.data() ) )
	{
		return false;
	}
	lw_checker_full_state( m_world.checker.get(), motion.from.data(), m_from.data() );
	lw_checker_full_state( m_world.checker.get(), motion.to.data(), m_to.data() );
	const int count = static_cast<int>( m_world.segmentCount( motion, fraction ) );
	std::vector<double> state( m_world.size() );
	std::queue<std::pair<int, int>> parts;
	if ( count >= 2 )
	{
		parts.emplace( 1, count - 1 );
	}
	while ( !parts.empty() )
	{
		const auto [first, last] = parts.front();
		parts.pop();
		const int middle = ( first + last ) / 2;
		lw_robot_interpolate(
		    m_world.robot.get(), m_from.data(), m_to.data(), static_cast<double>( middle ) / count, m_at.data() );
		for ( std::size_t i = 0; i < state.size(); ++i )
		{
			state[i] = m_at[m_world.variables[i]];
		}
		if ( !is_valid( state.data() ) )
		{
			return false;
		}
		if ( first < middle )
		{
			parts.emplace( first, middle - 1 );
		}
		if ( middle < last )
		{
			parts.emplace( middle + 1, last );
		}
	}
	return true;
}

bool EdgeJudges::byStates( const Motion& motion, bool tables, double fraction )
{
	const lw_checker* checker = tables ? m_world.with_tables.get() : m_world.checker.get();
	lw_query* query = tables ? m_table_state_query.get() : m_state_query.get();
	return discrete( motion, fraction,
	    [checker, query]( const double* q )
	    {
		    bool free = false;
		    leeway::require( lw_checker_is_free( checker, query, q, LW_CHECK_BOTH, 0, &free, nullptr ), "a state" );
		    return free;
	    } );
}

bool EdgeJudges::byPeer( PairPeer& peer, const Motion& motion, double fraction, std::vector<double>* collides )
{
	return discrete( motion, fraction,
	    [&]( const double* q )
	    {
		    peer.pose( q );
		    const bool is_free = !peer.environmentCollides() && !peer.selfCollides();
		    if ( !is_free && collides != nullptr )
		    {
			    collides->assign( q, q + m_world.size() );
		    }
		    return is_free;
	    } );
}

bool EdgeJudges::byFcl( const Motion& motion, double fraction )
{
	return byPeer( *m_fcl, motion, fraction );
}

bool EdgeJudges::fclCollides( const std::vector<double>& q )
{
	m_fcl->pose( q.data() );
	return m_fcl->environmentCollides() || m_fcl->selfCollides();
}

double EdgeJudges::fclDistance( const std::vector<double>& q, double bound )
{
	m_fcl->pose( q.data() );
	return m_fcl->selfDistance( m_fcl->environmentDistance( bound ) );
}

bool EdgeJudges::bruteCollides( const std::vector<double>& q )
{
	m_fcl->pose( q.data() );
	BruteDistance brute;
	const double bound = 1e-6;
	return bruteForce( brute, m_fcl->placedPairs( false ), bound ).upper <= 0 ||
	       bruteForce( brute, m_fcl->placedPairs( true ), bound ).upper <= 0;
}
