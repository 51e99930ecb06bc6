// SPDX-License-Identifier: BSD-3-Clause
// FCL used well: the peer that leeway's clearance queries are measured against.
//
// One OBBRSS tree per distinct mesh, shared by its instances. World boxes of all bodies; pairs whose boxes are too far
// apart are never looked at. For a smallest distance the pairs are taken from a heap, nearest boxes first, each with the
// best distance so far as its upper bound (DistanceResult::min_distance), until the boxes are further apart than that.
// No nearest points are asked for. This is faster than FCL's own broadphase managers on these scenes.
#pragma once

#include "leeway/handles.hpp"

#include <cstdint>
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/math/bv/OBBRSS.h>
#include <map>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

/// FCL's geometry of shapes, for peers of several worlds and threads: big trees are built once. An entry that is there already
/// is taken as it is, for shapes that FCL has in another form (an octree for its boxes).
struct FclModels
{
	struct Entry
	{
		leeway::Shape shape; ///< kept, so that no other shape gets its address
		std::shared_ptr<fcl::CollisionGeometryd> geometry;
	};
	std::map<const lw_shape*, Entry> entries;
	std::mutex mutex;
};

class FclPeer
{
public:
	/// Bodies that the checker's group moves against the scene, and pairs of bodies whose relative pose it can change.
	/// @param models shared with other peers; none = its own
	/// @param allowed contacts that the checker was told not to count
	/// @throws std::runtime_error for shapes that FCL does not have: sets of points, spheres or boxes, half-spaces
	explicit FclPeer( const lw_checker* checker, std::shared_ptr<FclModels> models = nullptr,
		const std::vector<lw_link_object_pair>& allowed = {} );

	/// Poses and boxes of the moving bodies at a group state. Everything below is about the last state posed.
	void pose( const double* q );

	/// Smallest distance to the scene, static bodies included.
	/// @param bound nothing at or above it needs a distance: then the bound is returned
	/// @param relative_error FCL's rel_err: each distance may be too large by this factor
	double environmentDistance( double bound, double relative_error = 0 );
	bool environmentCollides();
	double selfDistance( double bound );
	bool selfCollides();

	/// Of the bodies that stand still to the scene: part of every environment answer.
	double staticDistance() const { return m_static_distance; }
	/// Bodies that the group moves, where they are now: for other ways of using FCL.
	std::vector<std::pair<std::shared_ptr<fcl::CollisionGeometryd>, fcl::Transform3d>> movingBodies() const;

	std::size_t environmentPairs() const { return m_environment_pairs.size(); }
	std::size_t selfPairs() const { return m_self_pairs.size(); }
	double buildSeconds() const { return m_build_seconds; }
	std::size_t bytes() const { return m_bytes; } ///< of the trees: boxes, triangles, vertices

private:
	using Model = fcl::BVHModel<fcl::OBBRSSd>;
	struct Body
	{
		std::shared_ptr<fcl::CollisionGeometryd> model;
		lw_transform parent_from_shape; ///< link or world
		uint32_t link = LW_INVALID_INDEX, object = LW_INVALID_INDEX;
		double box_center[3], box_half[3]; ///< shape frame
		fcl::Transform3d pose;
		double low[3], high[3]; ///< world
	};
	struct Candidate
	{
		double squared; ///< of the boxes' distance
		const Body *a, *b;
	};

	std::shared_ptr<fcl::CollisionGeometryd> modelOf( const lw_shape* shape );
	std::shared_ptr<fcl::CollisionGeometryd> makeMesh( const lw_shape* shape );
	Body makeBody( const lw_shape* shape, const lw_transform& parent_from_shape, uint32_t link );
	static void placeBody( Body& body, const lw_transform& world_from_parent );
	void addCandidate( const Body& a, const Body& b, double bound );
	double nearest( double bound, double relative_error );
	void findMoving( const lw_checker* checker, std::vector<bool>& joint_moves, std::vector<bool>& link_moves ) const;

	const lw_checker* m_checker;
	const lw_robot* m_robot;
	std::shared_ptr<FclModels> m_models;
	std::vector<Body> m_bodies;    ///< of the robot, in its order
	std::vector<Body> m_obstacles; ///< shapes of the scene
	std::vector<uint32_t> m_moving;
	std::vector<std::pair<uint32_t, uint32_t>> m_environment_pairs; ///< moving body, obstacle
	std::vector<std::pair<uint32_t, uint32_t>> m_self_pairs;
	std::vector<Candidate> m_heap;
	std::vector<double> m_full;
	std::vector<lw_transform> m_link_poses;
	double m_static_distance;
	double m_build_seconds = 0;
	std::size_t m_bytes = 0;
};
