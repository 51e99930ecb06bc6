// SPDX-License-Identifier: BSD-3-Clause
// OMPL's curve between two states as straight edges of the core: usually one, see StateAdapter for the cases that need more.
#include "edge_prover.hpp"

#include <algorithm>
#include <limits>

namespace leeway::ompl
{

namespace ob = ::ompl::base;

bool EdgeProver::read( const ob::SpaceInformation& si, const ob::State* s1, const ob::State* s2 ) const
{
	if ( !si.satisfiesBounds( s1 ) || !si.satisfiesBounds( s2 ) )
	{
		return false;
	}
	m_engine.adapter().toVector( s1, m_slot.a );
	m_engine.adapter().toVector( s2, m_slot.b );
	return true;
}

ProvedMotion EdgeProver::proveCurve( const double* a, const double* b, const lw_edge_def& def, SlotCounter& queries ) const
{
	const StateAdapter& adapter = m_engine.adapter();
	ProvedMotion run;
	double lowest = std::numeric_limits<double>::infinity();
	const unsigned pieces = adapter.pieceCount( a, b );
	std::copy( a, a + adapter.size(), m_slot.from );
	for ( unsigned piece = 0; piece < pieces; ++piece )
	{
		if ( piece + 1 == pieces )
		{
			std::copy( b, b + adapter.size(), m_slot.to );
		}
		else
		{
			adapter.interpolate( a, b, double( piece + 1 ) / pieces, m_slot.to );
		}
		lw_edge_result result;
		const bool done =
		    lw_checker_edge( m_slot.checker.get(), m_slot.query.get(), m_slot.from, m_slot.to, &def, &result ) == LW_OK;
		run.verdict = done ? result.verdict : LW_VERDICT_UNKNOWN;
		run.proved_until = ( piece + ( done ? result.proved_until : 0 ) ) / pieces;
		queries.add( done ? result.queries : 0 );
		if ( run.verdict != LW_VERDICT_FREE )
		{
			run.t = done ? result.t : 1;
			run.self = result.self;
			run.pair = result.pair;
			return run;
		}
		lowest = std::min( lowest, result.lower_bound );
		std::copy( m_slot.to, m_slot.to + adapter.size(), m_slot.from );
	}
	run.lower_bound = lowest;
	return run;
}

// Rotations that OMPL takes for equal (StateAdapter::hasCloseRotations()) make three curves of one motion: OMPL's own from a
// (rotation of a throughout), OMPL's own from b, for planners that walk the edge backwards, and the slerp between. All three
// are proved; together they also cover OMPL's jump at the end. Planners sample such pairs about never, so the price does not
// matter.
ProvedMotion EdgeProver::prove( const lw_edge_def& def, SlotCounter& queries ) const
{
	const StateAdapter& adapter = m_engine.adapter();
	if ( !adapter.hasCloseRotations( m_slot.a, m_slot.b ) )
	{
		return proveCurve( m_slot.a, m_slot.b, def, queries );
	}
	std::copy( m_slot.b, m_slot.b + adapter.size(), m_slot.varied );
	adapter.replaceCloseRotations( m_slot.a, m_slot.varied );
	ProvedMotion run = proveCurve( m_slot.a, m_slot.varied, def, queries );
	if ( run.verdict != LW_VERDICT_FREE )
	{
		return run;
	}
	double lowest = run.lower_bound;
	lw_edge_def verdict_only = def;
	verdict_only.want_proved_until = false;
	std::copy( m_slot.a, m_slot.a + adapter.size(), m_slot.varied );
	adapter.replaceCloseRotations( m_slot.b, m_slot.varied );
	run = proveCurve( m_slot.varied, m_slot.b, verdict_only, queries );
	lowest = std::min( lowest, run.lower_bound );
	if ( run.verdict == LW_VERDICT_FREE )
	{
		run = proveCurve( m_slot.a, m_slot.b, verdict_only, queries );
		lowest = std::min( lowest, run.lower_bound );
	}
	run.lower_bound = lowest;
	if ( run.verdict != LW_VERDICT_FREE )
	{
		// proved along one curve but not along another: nothing but the start counts
		run.proved_until = 0;
	}
	return run;
}

} // namespace leeway::ompl
