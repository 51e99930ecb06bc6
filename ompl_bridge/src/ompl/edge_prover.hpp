// SPDX-License-Identifier: BSD-3-Clause
// One motion between two OMPL states, proved piece by piece along OMPL's own curve.
#pragma once

#include "slot.hpp"

namespace leeway::ompl
{

/// Result of a proof.
struct ProvedMotion
{
	lw_verdict verdict = LW_VERDICT_UNKNOWN;
	double proved_until = 0;                    ///< place on the whole motion; 0 if not wanted
	double lower_bound = 0;                     ///< of all clearances along the motion if FREE (method CERTIFIED), else 0
	double t = 1;                               ///< of the failure, on the piece from slot.from to slot.to
	bool self = false;                          ///< of the pair below
	lw_clearance pair = lw_clearance_unknown(); ///< at the failure
};

/// Works in the slot of a lease, for as long as one question takes.
class EdgeProver
{
public:
	EdgeProver( const Engine& engine, const Engine::Lease& lease ) : m_engine( engine ), m_slot( *lease.m_slot ) {}
	Engine::Slot& slot() const { return m_slot; }

	/// Reads both ends into the slot. False if one is out of the bounds. Both ends within the bounds: then all states
	/// between are, because bounds of RealVector are convex and the others have none.
	bool read(
	    const ::ompl::base::SpaceInformation& si, const ::ompl::base::State* s1, const ::ompl::base::State* s2 ) const;

	/// Proves the motion from slot.a to slot.b. Whatever else the slot holds is overwritten.
	/// @param queries receives the number of states at which distances were measured
	ProvedMotion prove( const lw_edge_def& def, SlotCounter& queries ) const;

private:
	ProvedMotion proveCurve( const double* a, const double* b, const lw_edge_def& def, SlotCounter& queries ) const;

	const Engine& m_engine;
	Engine::Slot& m_slot;
};

} // namespace leeway::ompl
