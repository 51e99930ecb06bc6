// SPDX-License-Identifier: BSD-3-Clause
// leeway and every peer that is installed, at the same work: the rows of a run, and the participants.
#pragma once

#include "peers/peer_engine.hpp"
#include "support/race.hpp"
#include "support/result.hpp"

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

struct PeersSettings
{
	std::string data = LEEWAY_DATA_DIR, only;
	std::string robot, srdf, scene, request, group; ///< the user's own robot and scene; then only these
	std::vector<std::string> modules;               ///< of engines, besides those next to the program
	std::size_t states = 200;
	int repetitions = 3;
	std::uint64_t seed = 20260101;
	double budget = 2;                  ///< seconds for pair proofs
	bool no_tables = false;             ///< of pairs and motion hulls, for edges
	std::vector<double> lengths{ 0.5 }; ///< of edges, radians
	double distance = 0.05;             ///< of near pairs, metres
	bool quick = false;
};

/// A library that takes part.
struct PeerLibrary
{
	std::string name, description;
	std::function<std::unique_ptr<PeerEngine>()> make; ///< an engine that shares nothing
	std::unique_ptr<PeerEngine> shared;                ///< the first of those that share geometry
	bool managers = false;                             ///< its own broadphase answers about the environment
};

/// A module with the engine of another library. @throws std::runtime_error that names it if it cannot be used
PeerLibrary loadPeer( const std::string& file );

/// FCL, and the modules "leeway_peer_*.so" next to the program and those that are named.
/// @throws std::runtime_error for a named module that cannot be used
std::vector<PeerLibrary> findPeers( const std::vector<std::string>& modules );

/// An answer that brute force contradicts.
struct Disagreement
{
	std::size_t number = 0;      ///< of the state or pose, in the order in which they are made
	double said = 0, leeway = 0; ///< metres, or 1 and 0
	double lower = 0, upper = 0; ///< of the truth
	std::string why;
};

/// Results of one library at one workload.
struct PeerRow
{
	std::string workload, library;
	std::size_t count = 0;
	Summary time;
	std::string answers_hash;
	std::size_t disagreements = 0;
	double largest_difference = 0;      ///< metres, of distances
	double bytes_per_triangle = 0;      ///< of builds
	double outside = -1;                ///< answers outside of leeway's interval, of all; below 0: not asked for
	double pairs = -1;                  ///< near ones of a state, the mean; below 0: not asked for
	std::vector<Disagreement> examined; ///< each of them
};

class PeerReport
{
public:
	/// Rows of one workload, leeway's first: printed with the ratio to leeway's mean as they come.
	void add( const std::vector<PeerRow>& rows );
	std::size_t disagreements( const std::string& library ) const;
	void write( Result& result ) const;

private:
	std::vector<PeerRow> m_rows;
};

/// All of them, one after the other.
void runPeerWorkloads( const PeersSettings& settings, const std::vector<PeerLibrary>& peers, PeerReport& report );
/// @return exit status: 1 if brute force contradicts some answer of leeway
int runPeers( const PeersSettings& settings, Result& result );
