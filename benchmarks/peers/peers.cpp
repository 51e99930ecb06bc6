// SPDX-License-Identifier: BSD-3-Clause
// The libraries of a comparison, and its results: table, JSON, CSV, pictures. See peers.hpp.
#include "peers/peers.hpp"

#include "peers/fcl_peer.hpp"

#include <algorithm>
#include <cstdio>
#include <dlfcn.h>
#include <filesystem>
#include <set>
#include <stdexcept>

namespace fs = std::filesystem;

PeerLibrary loadPeer( const std::string& file )
{
	// Its own versions of libraries that this program has too stay its own. It stays loaded: its engines live as long as we
	// do.
	void* module = dlopen( file.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_DEEPBIND );
	void* symbol = module != nullptr ? dlsym( module, "leeway_peer_engine" ) : nullptr;
	if ( symbol == nullptr )
	{
		const char* problem = dlerror();
		throw std::runtime_error( file + ": " + ( problem != nullptr ? problem : "exports no leeway_peer_engine" ) );
	}
	const auto make = reinterpret_cast<PeerEngine* (*)()>( symbol );
	PeerLibrary library;
	library.make = [make] { return std::unique_ptr<PeerEngine>( make() ); };
	library.shared = library.make();
	return library;
}

std::vector<PeerLibrary> findPeers( const std::vector<std::string>& modules )
{
	std::vector<PeerLibrary> peers( 2 );
	peers[0].make = [] { return std::make_unique<FclEngine>(); };
	peers[1].make = [] { return std::make_unique<FclEngine>( std::make_shared<FclModels>(), FclVolume::RSS ); };
	peers[0].shared = peers[0].make();
	peers[1].shared = peers[1].make();
	std::set<fs::path> beside;
	for ( const auto& entry : fs::directory_iterator( fs::read_symlink( "/proc/self/exe" ).parent_path() ) )
	{
		const std::string name = entry.path().filename();
		if ( name.rfind( "leeway_peer_", 0 ) == 0 && entry.path().extension() == ".so" )
		{
			beside.insert( entry.path() );
		}
	}
	for ( const fs::path& file : beside )
	{
		try
		{
			peers.push_back( loadPeer( file ) );
		}
		catch ( const std::runtime_error& error ) // libraries that the module was built with may be gone
		{
			std::fprintf( stderr, "leeway-bench: without %s\n", error.what() );
		}
	}
	for ( const std::string& file : modules )
	{
		peers.push_back( loadPeer( file ) );
	}
	for ( std::size_t p = 0, count = peers.size(); p < count; ++p )
	{
		peers[p].name = peers[p].shared->name();
		peers[p].description = peers[p].shared->description();
		if ( peers[p].shared->hasManagers() && peers[p].shared->isForContacts() )
		{
			PeerLibrary managed;
			managed.name = peers[p].name + " managers";
			managed.description = peers[p].description + ", DynamicAABBTreeCollisionManager";
			managed.make = peers[p].make;
			managed.shared = peers[p].shared->another();
			managed.managers = true;
			peers.push_back( std::move( managed ) );
		}
	}
	return peers;
}

void PeerReport::add( const std::vector<PeerRow>& rows )
{
	for ( const PeerRow& row : rows )
	{
		std::printf( "%-62s %-13s %4zu | %10.2f %10.2f %10.2f | %7.2f", row.workload.c_str(), row.library.c_str(), row.count,
		    row.time.median, row.time.mean, row.time.p95, row.time.mean / rows[0].time.mean );
		if ( row.bytes_per_triangle > 0 )
		{
			std::printf( "  %.0f bytes per triangle", row.bytes_per_triangle );
		}
		if ( row.pairs >= 0 )
		{
			std::printf( "  %.1f pairs, differ by at most %.1g m", row.pairs, row.largest_difference );
		}
		if ( row.outside >= 0 )
		{
			std::printf( "  %.2g %% outside, at most %.1g m", 100 * row.outside, row.largest_difference );
		}
		if ( row.disagreements > 0 )
		{
			std::printf(
			    "  %zu WRONG, number %zu: %s", row.disagreements, row.examined[0].number, row.examined[0].why.c_str() );
		}
		std::printf( "\n" );
		m_rows.push_back( row );
	}
	std::fflush( stdout );
}

std::size_t PeerReport::disagreements( const std::string& library ) const
{
	std::size_t sum = 0;
	for ( const PeerRow& row : m_rows )
	{
		sum += row.library == library ? row.disagreements : 0;
	}
	return sum;
}

void PeerReport::write( Result& result ) const
{
	for ( const PeerRow& row : m_rows )
	{
		Json json = { { "workload", row.workload }, { "library", row.library }, { "count", row.count } };
		json.update( toJson( row.time ) );
		json["answers_hash"] = row.answers_hash;
		if ( row.outside >= 0 )
		{
			json["outside"] = row.outside;
		}
		json["disagreements"] = row.disagreements;
		if ( row.bytes_per_triangle > 0 )
		{
			json["bytes_per_triangle"] = row.bytes_per_triangle;
		}
		if ( row.pairs >= 0 )
		{
			json["pairs"] = row.pairs;
		}
		if ( row.disagreements > 0 || row.pairs >= 0 || row.outside >= 0 )
		{
			json["largest_difference_m"] = row.largest_difference;
		}
		for ( const Disagreement& entry : row.examined )
		{
			json["examined"].push_back( { { "number", entry.number }, { "said", entry.said }, { "leeway", entry.leeway },
			    { "true_lower", entry.lower }, { "true_upper", entry.upper }, { "why", entry.why } } );
		}
		result.add( std::move( json ) );
	}
}

int runPeers( const PeersSettings& settings, Result& result )
{
	std::vector<PeerLibrary> peers = findPeers( settings.modules );
	for ( const PeerLibrary& peer : peers )
	{
		std::printf( "against %s\n", peer.description.c_str() );
		result["peers"].push_back( peer.description );
	}
	std::printf( "\nmicroseconds, processor time of one thread\n%-62s %-13s %4s | %10s %10s %10s | %s\n", "workload",
	    "library", "n", "median", "mean", "p95", "mean / leeway's" );
	PeerReport report;
	runPeerWorkloads( settings, peers, report );
	report.write( result );
	std::printf( "\nanswers that brute force contradicts: leeway %zu", report.disagreements( "leeway" ) );
	for ( const PeerLibrary& peer : peers )
	{
		std::printf( ", %s %zu", peer.name.c_str(), report.disagreements( peer.name ) );
	}
	std::printf( "\n" );
	return report.disagreements( "leeway" ) > 0 ? 1 : 0;
}
