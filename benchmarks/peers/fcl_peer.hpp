// SPDX-License-Identifier: BSD-3-Clause
// FCL as a peer: one tree per distinct mesh, of OBBRSS or, for distances only, of RSS; its own primitives and managers.
#pragma once

#include "peers/pair_peer.hpp"

#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/narrowphase/collision_object.h>
#include <map>
#include <mutex>

/// FCL's geometry of shapes, for engines of several worlds and threads: big trees are built once. An entry that is there
/// already is taken as it is, for shapes that FCL has in another form (an octree for its boxes).
struct FclModels
{
	std::map<const void*, std::shared_ptr<fcl::CollisionGeometryd>> entries;
	std::mutex mutex;
};

/// RSS trees are half as large and a little faster for distances; collide() would copy and rebuild them each time.
enum class FclVolume
{
	OBBRSS,
	RSS
};

class FclEngine : public PeerEngine
{
public:
	explicit FclEngine(
	    std::shared_ptr<FclModels> models = std::make_shared<FclModels>(), FclVolume volume = FclVolume::OBBRSS )
	    : m_models( std::move( models ) ), m_volume( volume )
	{
	}

	std::string name() const override { return m_volume == FclVolume::RSS ? "FCL RSS" : "FCL"; }
	std::string description() const override;
	std::size_t add( const void* key, const PeerGeometry& geometry ) override;
	void place( std::size_t body, const lw_transform& world_from_shape ) override;
	double distance( std::size_t a, std::size_t b, double bound, double relative_error ) override;
	bool collides( std::size_t a, std::size_t b ) override;
	bool isForContacts() const override { return m_volume != FclVolume::RSS; }
	bool hasManagers() const override { return true; }
	void manage( const std::vector<std::uint32_t>& moving, const std::vector<std::uint32_t>& fixed ) override;
	void refresh() override;
	void overlappingPairs( const std::function<bool( std::uint32_t, std::uint32_t )>& test ) override;
	void nearPairs( const std::function<double( std::uint32_t, std::uint32_t )>& test ) override;
	std::unique_ptr<PeerEngine> another() const override { return std::make_unique<FclEngine>( m_models, m_volume ); }
	double buildSeconds() const override { return m_build_seconds; }
	std::size_t bytes() const override { return m_bytes; }

	struct Body
	{
		std::shared_ptr<fcl::CollisionGeometryd> model;
		fcl::Transform3d pose;
	};
	const Body& body( std::size_t number ) const { return m_bodies[number]; }

private:
	std::shared_ptr<fcl::CollisionGeometryd> make( const PeerGeometry& geometry );
	template <typename Volume> std::shared_ptr<fcl::CollisionGeometryd> makeMesh( const PeerGeometry& geometry );

	struct Managers
	{
		std::vector<std::uint32_t> numbers; ///< objects' user data point here
		std::vector<std::unique_ptr<fcl::CollisionObjectd>> objects;
		std::size_t moving_count = 0;
		fcl::DynamicAABBTreeCollisionManagerd moving, fixed;
	};

	std::shared_ptr<FclModels> m_models;
	const FclVolume m_volume;
	std::unique_ptr<Managers> m_managed;
	std::vector<Body> m_bodies;
	double m_build_seconds = 0;
	std::size_t m_bytes = 0;
};

/// FCL over the pairs of a checker.
class FclPeer : public PairPeer
{
public:
	/// @param models shared with other peers; none = its own
	/// @throws as PairPeer
	explicit FclPeer( const lw_checker* checker, std::shared_ptr<FclModels> models = nullptr,
	    const std::vector<lw_link_object_pair>& allowed = {} )
	    : PairPeer(
	          checker, models ? std::make_unique<FclEngine>( std::move( models ) ) : std::make_unique<FclEngine>(), allowed )
	{
	}
};
