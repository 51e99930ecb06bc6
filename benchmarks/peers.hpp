// SPDX-License-Identifier: BSD-3-Clause
// leeway and every peer that is there, at the same work: the rows of a run, and who takes part.
#pragma once

#include "peer_engine.hpp"
#include "race.hpp"

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

struct PeersSettings
{
	std::string data = LEEWAY_DATA_DIR, json, csv, svg, only;
	std::vector<std::string> modules; ///< of engines, besides those next to the program
	std::size_t states = 200;
	int repetitions = 3;
	std::uint64_t seed = 20260101;
	double budget = 2; ///< seconds for pair proofs
	bool quick = false;
};

/// A library that takes part.
struct PeerLibrary
{
	std::string name, description;
	std::function<std::unique_ptr<PeerEngine>()> make; ///< an engine that shares nothing
	std::unique_ptr<PeerEngine> shared;                ///< the first of those that share geometry
};

/// FCL, and the modules "leeway_peer_*.so" next to the program and those that are named.
/// @throws std::runtime_error for a named module that cannot be used
std::vector<PeerLibrary> findPeers( const std::vector<std::string>& modules );

/// What one library did at one workload.
struct PeerRow
{
	std::string workload, library;
	std::size_t count = 0;
	Summary time;
	std::string answers_hash;
	std::size_t disagreements = 0;
	double largest_difference = 0;  ///< metres, of distances
	double bytes_per_triangle = 0;  ///< of builds
	std::string first_disagreement; ///< enough to ask again
};

class PeerReport
{
public:
	/// Rows of one workload, leeway's first: printed with the ratio to leeway's mean as they come.
	void add( const std::vector<PeerRow>& rows );
	std::size_t disagreements( const std::string& library ) const;
	void writeJson( const std::string& file, nlohmann::ordered_json header ) const;
	void writeCsv( const std::string& file ) const;
	/// One picture for each letter of the workloads, by gnuplot. @throws std::runtime_error without it
	void writeSvg( const std::string& folder ) const;

private:
	std::vector<PeerRow> m_rows;
};

/// All of them, one after the other.
void runPeerWorkloads( const PeersSettings& settings, std::vector<PeerLibrary>& peers, PeerReport& report );
/// @return exit status: 1 if some answer of leeway is contradicted by all others
int runPeers( const PeersSettings& settings );
