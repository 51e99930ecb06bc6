// SPDX-License-Identifier: BSD-3-Clause
// All judges of an edge of a world: certificates, and the method of OMPL's DiscreteMotionValidator over leeway's states and
// over FCL's. For one thread.
#pragma once

#include "edge_world.hpp"
#include "peers/fcl_peer.hpp"

#include <memory>

class EdgeJudges
{
public:
	EdgeJudges( const EdgeWorld& world, std::shared_ptr<FclModels> models );

	const EdgeWorld& world() const { return m_world; }

	/// Each is true for FREE. @param tables with the robot's reach @param fraction of the space's extent per step, as OMPL's
	/// longest valid segment
	bool byCertificate( const Motion& motion, bool tables, const lw_edge_def& def, lw_edge_result& result );
	bool byStates( const Motion& motion, bool tables, double fraction );
	bool byFcl( const Motion& motion, double fraction );
	/// As byFcl(), by another library over the same world.
	/// @param collides if not null and the answer is no: the state that is not free
	bool byPeer( PairPeer& peer, const Motion& motion, double fraction, std::vector<double>* collides = nullptr );

	/// False if the world holds shapes that FCL does not have; then nothing may be asked of it.
	bool hasFcl() const { return m_fcl != nullptr; }
	/// FCL's word on one state: is it in contact, and how far is it from it (no further than `bound`)?
	bool fclCollides( const std::vector<double>& q );
	double fclDistance( const std::vector<double>& q, double bound );
	/// Brute force's answer on contact at a state, for the same pairs as FCL's.
	bool bruteCollides( const std::vector<double>& q );

	/// A query without a part in any of that.
	lw_query* spare() { return m_spare.get(); }

private:
	template <typename IsValid> bool discrete( const Motion& motion, double fraction, const IsValid& is_valid );

	const EdgeWorld& m_world;
	leeway::Query m_query, m_table_query, m_state_query, m_table_state_query, m_spare;
	std::unique_ptr<FclPeer> m_fcl;
	std::vector<double> m_from, m_to, m_at;
};
