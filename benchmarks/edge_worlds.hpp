// SPDX-License-Identifier: BSD-3-Clause
// Edges of ARMAR-III's torso and right arm in the cluttered kitchen, with everybody who can judge them.
#pragma once

#include "fcl_peer.hpp"

#include "leeway/io/model.hpp"

#include <cmath>
#include <memory>
#include <queue>
#include <random>
#include <string>
#include <vector>

/// A robot and scene with the joints outside of the group where they stand, and everybody's own data for it.
struct EdgeWorld
{
	leeway::io::Problem problem;
	leeway::Checker with_tables; ///< the same checker with motion hulls and pair tables
	leeway::Query query, table_query, audit_query;
	std::unique_ptr<FclPeer> fcl;
};

/// The numbers of one edge: world, from, to.
using Edge = std::vector<double>;

/// The worlds of the twelve reach problems: the base parked in front of furniture, the left arm tucked.
class EdgeWorlds
{
public:
	/// @param budget seconds for the pair tables
	EdgeWorlds( const std::string& data, double budget );

	const char* group() const { return "torso_right_arm"; }
	std::size_t size() const { return m_size; }  ///< joints of a state
	double extent() const { return m_extent; }   ///< longest edge in the joint box: OMPL's resolution is a fraction of it
	EdgeWorld& of( const double* edge ) { return m_worlds[static_cast<std::size_t>( edge[0] )]; }

	/// From a random free state (near: within 50 mm of the environment) in a random direction to a free state in the limits.
	Edge random( bool near, double length, std::mt19937_64& random );

	/// The state at t in [0, 1].
	std::vector<double> at( const double* edge, double t ) const;

	bool judgedByCertificate( const double* edge, bool tables, lw_edge_result& result );
	/// As OMPL's DiscreteMotionValidator over leeway's states, or FCL's. @param resolution fraction of the extent
	bool judgedByStates( const double* edge, double resolution );
	bool judgedByFcl( const double* edge, double resolution );
	/// Is one state of an edge's world free, by a query that nobody else uses?
	bool isFree( EdgeWorld& world, const double* q );

private:
	void add( const std::string& request_file, double budget );
	Edge start( bool near, std::mt19937_64& random );

	leeway::io::RobotModel m_robot;
	leeway::io::SceneModel m_scene;
	leeway::Reach m_reach;
	std::vector<EdgeWorld> m_worlds;
	std::size_t m_size = 0;
	double m_extent = 0;
};
