// SPDX-License-Identifier: BSD-3-Clause
// The interface between leeway-bench and another collision library.
//
// An engine knows bodies by number: geometry at a pose. The caller (pair_peer.hpp) chooses the pairs, their order and their
// bounds, so that all engines are used equally well. Engines of libraries that cannot be linked with the
// rest (their own versions of assimp, octomap, boost) live in modules that are loaded at run time; so this header needs
// nothing but the core's headers, and an engine calls none of the core's functions. README.md tells how to add one.
#pragma once

#include "leeway/shape.h"

#include <cmath>
#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

/// A shape, as a library's own constructors want it. Pointers are valid during the call.
struct PeerGeometry
{
	lw_shape_type type;
	double dimensions[3]; ///< of a primitive, as lw_shape_type has them
	const double* vertices = nullptr;
	std::uint32_t vertex_count = 0;
	const std::uint32_t* triangles = nullptr;
	std::uint32_t triangle_count = 0;
	bool convex = false; ///< of a mesh: the engine may take it for a solid convex body
};

class PeerEngine
{
public:
	PeerEngine() = default;
	PeerEngine( const PeerEngine& ) = delete;
	PeerEngine& operator=( const PeerEngine& ) = delete;
	virtual ~PeerEngine() = default;

	virtual std::string name() const = 0;        ///< "FCL"
	virtual std::string description() const = 0; ///< version, volume, how it was built

	/// @param key equal keys are equal geometry, which is then shared, also by engines that another() made
	/// @return the body's number, from 0 on
	/// @throws std::runtime_error for shapes that the library does not have
	virtual std::size_t add( const void* key, const PeerGeometry& geometry ) = 0;
	virtual void place( std::size_t body, const lw_transform& world_from_shape ) = 0;

	/// Smallest distance of two bodies, or `bound` if it is not below that.
	/// @param relative_error the distance may be too large by this factor, if the library can make use of that
	virtual double distance( std::size_t a, std::size_t b, double bound, double relative_error ) = 0;
	virtual bool collides( std::size_t a, std::size_t b ) = 0;
	/// Is their distance below the margin? In the library's fastest way.
	virtual bool within( std::size_t a, std::size_t b, double margin ) { return distance( a, b, margin, 0 ) < margin; }

	/// Distance of two convex bodies, minus their penetration depth if they overlap, to the tolerance. NaN: the library has none.
	virtual double signedDistance( std::size_t, std::size_t, double ) { return NAN; }

	/// How far its surface of a body may be from the given one, metres: round shapes as polyhedra. Explains disagreements.
	virtual double shapeError( std::size_t ) const { return 0; }
	/// False if primitives are surfaces: a body inside of one does not touch it.
	virtual bool hasSolids() const { return true; }
	/// False for a volume that is only good for distances: such an engine is not asked collides().
	virtual bool isForContacts() const { return true; }

	/// The library's own broadphase, if it has one: pairs of a moving and a fixed body, in its order. manage() once; after
	/// place() of moving bodies refresh(). The tests below ask this engine about the pair.
	virtual bool hasManagers() const { return false; }
	virtual void manage( const std::vector<std::uint32_t>& /*moving*/, const std::vector<std::uint32_t>& /*fixed*/ ) {}
	virtual void refresh() {}
	/// @param test of a pair whose boxes overlap: true ends the search
	virtual void overlappingPairs( const std::function<bool( std::uint32_t, std::uint32_t )>& /*test*/ ) {}
	/// @param test of a pair that may be nearer than the last result; returns the new least distance, 0 to end the search
	virtual void nearPairs( const std::function<double( std::uint32_t, std::uint32_t )>& /*test*/ ) {}

	/// An engine without bodies that shares the geometry of this one.
	virtual std::unique_ptr<PeerEngine> another() const = 0;

	virtual double buildSeconds() const = 0; ///< processor time spent on trees by this engine
	virtual std::size_t bytes() const = 0;   ///< of the trees it built: volumes, triangles, vertices
};

/// The one function that a module exports.
extern "C" PeerEngine* leeway_peer_engine();
