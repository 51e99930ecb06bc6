// SPDX-License-Identifier: BSD-3-Clause
// FCL as a peer: one OBBRSS tree per distinct mesh, its own primitives.
#pragma once

#include "pair_peer.hpp"

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

class FclEngine : public PeerEngine
{
public:
	explicit FclEngine( std::shared_ptr<FclModels> models = std::make_shared<FclModels>() ) : m_models( std::move( models ) )
	{
	}

	std::string name() const override { return "FCL"; }
	std::string description() const override;
	std::size_t add( const void* key, const PeerGeometry& geometry ) override;
	void place( std::size_t body, const lw_transform& world_from_shape ) override;
	double distance( std::size_t a, std::size_t b, double bound, double relative_error ) override;
	bool collides( std::size_t a, std::size_t b ) override;
	std::unique_ptr<PeerEngine> another() const override { return std::make_unique<FclEngine>( m_models ); }
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
	std::shared_ptr<fcl::CollisionGeometryd> makeMesh( const PeerGeometry& geometry );

	std::shared_ptr<FclModels> m_models;
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
