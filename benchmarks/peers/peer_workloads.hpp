// SPDX-License-Identifier: BSD-3-Clause
// The work of the comparison (peers.hpp): A two meshes, B states of robots, C edges, D building, E growth, F near pairs, G convex bodies.
#pragma once

#include "support/edge_worlds.hpp"
#include "peers/peer_judge.hpp"

#include <random>

/// A triangle mesh of a workload's own.
struct Mesh
{
	std::vector<double> vertices;
	std::vector<std::uint32_t> triangles;
};

leeway::Shape shapeOf( const Mesh& mesh, bool solid = false );
/// Each triangle cut into four at the middles of its edges: the same surface.
Mesh refined( const Mesh& mesh );

void runMeshes( const PeersSettings& settings, const std::vector<PeerLibrary>& peers, PeerReport& out );

/// One robot, each of whose worlds has its own places of the joints outside the group.
struct Subject
{
	std::string name;
	std::function<void( EdgeWorlds& )> add;
};
/// B and C, of all worlds that subjects add.
void runRobots( const PeersSettings& settings, const std::vector<Subject>& subjects, bool states, bool edges,
    const std::vector<PeerLibrary>& peers, PeerReport& out );

/// F, of all worlds that subjects add.
void runNear( const PeersSettings& settings, const std::vector<Subject>& subjects, const std::vector<PeerLibrary>& peers,
    PeerReport& out );

/// G: distances and depths of pairs of convex bodies.
void runConvex( const PeersSettings& settings, const std::vector<PeerLibrary>& peers, PeerReport& out );

/// G: all of many pairs of convex bodies at once, state by state.
void runCrowds( const PeersSettings& settings, const std::vector<PeerLibrary>& peers, PeerReport& out );

/// Robot and scene that are built and refined.
struct Models
{
	std::string name, robot, srdf, scene, request, group;
};
void runBuild( const PeersSettings& settings, const Models& models, const std::vector<PeerLibrary>& peers, PeerReport& out );
void runGrowth(
    const PeersSettings& settings, const Models& models, const std::vector<PeerLibrary>& peers, PeerReport& out );
