// SPDX-License-Identifier: BSD-3-Clause
// Another library used well: the peers that leeway's clearance queries are measured against.
//
// One tree per distinct mesh, shared by its instances. World boxes of all bodies; pairs whose boxes are too far apart are
// never looked at. For a smallest distance the pairs are taken from a heap, nearest boxes first, each with the best distance
// so far as its upper bound, until the boxes are further apart than that. No nearest points are asked for. Or, for the
// environment, by the library's own broadphase managers with the same running bound: which is faster depends on the scene.
#pragma once

#include "peers/peer_engine.hpp"

#include "leeway/handles.hpp"

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

struct PlacedPair
{
	const lw_shape *a, *b;
	lw_transform world_from_a, world_from_b;
};

/// Two bodies and their distance. Numbers: of the robot, in its order, then shapes of the scene.
struct NearBodies
{
	std::uint32_t a, b;
	double distance;
};

class PairPeer
{
public:
	/// Bodies that the checker's group moves against the scene, and pairs of bodies whose relative pose it can change.
	/// @param allowed contacts that the checker allows
	/// @param managers the engine's own broadphase answers about the environment
	/// @throws std::runtime_error for shapes that the library does not have: sets of points, spheres or boxes, half-spaces;
	/// if the checker does not allow the same contacts
	PairPeer( const lw_checker* checker, std::unique_ptr<PeerEngine> engine,
	    const std::vector<lw_link_object_pair>& allowed = {}, bool managers = false );

	/// Poses and boxes of the moving bodies at a group state. Everything below is about the last state posed.
	void pose( const double* q );

	/// Smallest distance to the scene, static bodies included.
	/// @param bound nothing at or above it needs a distance: then the bound is returned
	/// @param relative_error each distance may be too large by this factor
	double environmentDistance( double bound, double relative_error = 0 );
	bool environmentWithin( double margin );
	bool environmentCollides();
	double selfDistance( double bound, double relative_error = 0 );
	/// All pairs below the bound, environment and self. The engine measures each pair whose boxes are near, or, with managers, the
	/// pairs of the environment that its broadphase finds.
	std::vector<NearBodies> nearPairs( double bound );
	bool selfWithin( double margin );
	bool selfCollides();
	/// Is the straight motion of the group free at so many states of equal steps? The end, the start, then halving, as LW_EDGE_STEPS.
	bool isFreeAtStates( const std::vector<double>& from, const std::vector<double>& to, std::uint32_t states );

	/// Of the bodies that stand still to the scene: part of every environment answer.
	double staticDistance() const { return m_static_distance; }
	/// Numbers of the bodies that the group moves, and their poses: for other ways of using the engine.
	const std::vector<std::uint32_t>& movingBodies() const { return m_moving; }
	const PeerEngine& engine() const { return *m_engine; }

	/// Pairs that count, at the last state posed, for brute force.
	std::vector<PlacedPair> placedPairs( bool self ) const;
	PlacedPair placedPair( std::uint32_t a, std::uint32_t b ) const;
	/// Number of a shape of the scene.
	std::uint32_t obstacle( std::uint32_t shape ) const { return m_robot_bodies + shape; }
	/// PeerEngine::shapeError() of two bodies together, at most.
	double largestShapeError() const;

	std::size_t selfPairs() const { return m_self_pairs.size(); }
	std::size_t environmentPairs() const { return m_environment_pairs.size(); }

private:
	using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;
	struct Body
	{
		const lw_shape* shape;
		lw_transform parent_from_shape; ///< link or world
		lw_transform world_from_shape;
		std::uint32_t link = LW_INVALID_INDEX, object = LW_INVALID_INDEX;
		double box_center[3], box_half[3]; ///< shape frame
		double low[3], high[3];            ///< world
	};
	struct Candidate
	{
		double squared; ///< of the boxes' distance
		std::uint32_t a, b;
	};

	void addBody( const lw_shape* shape, const lw_transform& parent_from_shape );
	void placeBody( std::uint32_t body, const lw_transform& world_from_parent );
	void addCandidate( std::uint32_t a, std::uint32_t b, double bound );
	double nearest( double bound, double relative_error );
	double nearestOf( const Pairs& pairs, double bound, double relative_error );
	double managedDistance( double bound, double relative_error );
	bool managedCollides();
	bool isAllowed( std::uint32_t body, std::uint32_t obstacle ) const;
	template <typename Test> bool anyOf( const Pairs& pairs, double margin, const Test& test ) const;
	void addBodies(); ///< of the robot, then of the scene
	void findMoving( std::vector<bool>& joint_moves, std::vector<bool>& link_moves ) const;
	void findEnvironmentPairs( const std::vector<bool>& link_moves );
	void findSelfPairs( const std::vector<bool>& joint_moves );
	/// Bodies that never move: once, the others in their neutral state.
	void measureStatic( const std::vector<bool>& link_moves );

	const lw_checker* m_checker;
	const lw_robot* m_robot;
	std::unique_ptr<PeerEngine> m_engine;
	const std::vector<lw_link_object_pair> m_allowed;
	bool m_managers = false;    ///< set once they know all bodies
	std::vector<Body> m_bodies; ///< numbered as the engine's: of the robot, in its order, then shapes of the scene
	std::uint32_t m_robot_bodies = 0;
	std::vector<std::uint32_t> m_moving;
	Pairs m_environment_pairs; ///< moving body, obstacle
	Pairs m_self_pairs;
	Pairs m_static_pairs; ///< body that stands still, obstacle
	std::vector<Candidate> m_heap;
	std::vector<double> m_full;
	std::vector<lw_transform> m_link_poses;
	double m_static_distance;
};
