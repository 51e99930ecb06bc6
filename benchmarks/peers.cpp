// SPDX-License-Identifier: BSD-3-Clause
// Who takes part in a comparison, and its results: table, JSON, CSV, pictures. See peers.hpp.
#include "peers.hpp"

#include "fcl_peer.hpp"
#include "provenance.hpp"

#include <algorithm>
#include <cstdio>
#include <dlfcn.h>
#include <filesystem>
#include <fstream>
#include <set>
#include <stdexcept>

namespace
{

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

PeerLibrary loadModule( const std::string& file )
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

std::ofstream openFile( const std::string& file )
{
	std::ofstream out( file );
	if ( !out )
	{
		throw std::runtime_error( file + ": cannot be written" );
	}
	return out;
}

void finish( std::ofstream& out, const std::string& file )
{
	if ( !out.flush() )
	{
		throw std::runtime_error( file + ": cannot be written" );
	}
}

} // namespace

std::vector<PeerLibrary> findPeers( const std::vector<std::string>& modules )
{
	std::vector<PeerLibrary> peers( 1 );
	peers[0].make = [] { return std::make_unique<FclEngine>(); };
	peers[0].shared = peers[0].make();
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
			peers.push_back( loadModule( file ) );
		}
		catch ( const std::runtime_error& error ) // what it was built with may have gone
		{
			std::fprintf( stderr, "leeway-bench: without %s\n", error.what() );
		}
	}
	for ( const std::string& file : modules )
	{
		peers.push_back( loadModule( file ) );
	}
	for ( PeerLibrary& peer : peers )
	{
		peer.name = peer.shared->name();
		peer.description = peer.shared->description();
	}
	return peers;
}

void PeerReport::add( const std::vector<PeerRow>& rows )
{
	for ( const PeerRow& row : rows )
	{
		std::printf( "%-58s %-8s %5zu | %10.2f %10.2f %10.2f | %7.2f", row.workload.c_str(), row.library.c_str(), row.count,
		    row.time.median, row.time.mean, row.time.p95, row.time.mean / rows[0].time.mean );
		if ( row.bytes_per_triangle > 0 )
		{
			std::printf( "  %.0f bytes per triangle", row.bytes_per_triangle );
		}
		if ( row.disagreements > 0 )
		{
			std::printf( "  %zu DISAGREE, by %.3g m at most: %s", row.disagreements, row.largest_difference,
			    row.first_disagreement.c_str() );
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

void PeerReport::writeJson( const std::string& file, Json header ) const
{
	Json rows = Json::array();
	for ( const PeerRow& row : m_rows )
	{
		Json json = { { "workload", row.workload }, { "library", row.library }, { "mean_us", row.time.mean },
		    { "median_us", row.time.median }, { "p95_us", row.time.p95 }, { "answers_hash", row.answers_hash },
		    { "disagreements", row.disagreements }, { "count", row.count } };
		if ( row.bytes_per_triangle > 0 )
		{
			json["bytes_per_triangle"] = row.bytes_per_triangle;
		}
		if ( row.disagreements > 0 )
		{
			json["largest_difference_m"] = row.largest_difference;
			json["first_disagreement"] = row.first_disagreement;
		}
		rows.push_back( json );
	}
	std::ofstream out = openFile( file );
	out << Json{ { "rows", rows }, { "provenance", std::move( header ) } }.dump( 1, '\t' ) << "\n";
	finish( out, file );
}

void PeerReport::writeCsv( const std::string& file ) const
{
	std::ofstream out = openFile( file );
	out << "workload,library,count,mean_us,median_us,p95_us,answers_hash,disagreements\n";
	for ( const PeerRow& row : m_rows )
	{
		out << '"' << row.workload << "\"," << row.library << ',' << row.count << ',' << row.time.mean << ','
		    << row.time.median << ',' << row.time.p95 << ',' << row.answers_hash << ',' << row.disagreements << "\n";
	}
	finish( out, file );
}

void PeerReport::writeSvg( const std::string& folder ) const
{
	if ( std::system( "command -v gnuplot >/dev/null 2>&1" ) != 0 )
	{
		throw std::runtime_error( "--svg: there is no gnuplot; install it (Debian: apt-get install gnuplot-nox)" );
	}
	fs::create_directories( folder );
	std::set<char> letters;
	std::vector<std::string> libraries;
	for ( const PeerRow& row : m_rows )
	{
		letters.insert( row.workload[0] );
		if ( std::find( libraries.begin(), libraries.end(), row.library ) == libraries.end() )
		{
			libraries.push_back( row.library );
		}
	}
	for ( const char letter : letters )
	{
		// a line for each workload, a column for each library; "-" where one had no part in it
		std::vector<std::string> workloads;
		for ( const PeerRow& row : m_rows )
		{
			if ( row.workload[0] == letter && ( workloads.empty() || workloads.back() != row.workload ) )
			{
				workloads.push_back( row.workload );
			}
		}
		const std::string base = folder + "/" + letter, script = base + ".gp";
		std::ofstream out = openFile( script );
		out << "set terminal svg size 1200," << 200 + 30 * workloads.size() * libraries.size()
		    << " font 'sans,11'\nset output '" << base << ".svg'\nset datafile missing '-'\nset logscale x\n"
		    << "set xlabel 'mean, microseconds'\nset key outside top\nset grid x\nset style fill solid\nset yrange ["
		    << workloads.size() << ":-1]\nset ytics (";
		for ( std::size_t w = 0; w < workloads.size(); ++w )
		{
			out << ( w > 0 ? ", " : "" ) << '"' << workloads[w].substr( 2 ) << "\" " << w;
		}
		out << ")\n$rows << END\n";
		for ( std::size_t w = 0; w < workloads.size(); ++w )
		{
			out << '"' << workloads[w].substr( 2 ) << '"';
			for ( const std::string& library : libraries )
			{
				const auto found = std::find_if( m_rows.begin(), m_rows.end(),
				    [&]( const PeerRow& row ) { return row.workload == workloads[w] && row.library == library; } );
				out << ' ' << ( found != m_rows.end() ? std::to_string( found->time.mean ) : "-" );
			}
			out << "\n";
		}
		out << "END\nplot";
		const double height = 0.8 / static_cast<double>( libraries.size() );
		for ( std::size_t l = 0; l < libraries.size(); ++l )
		{
			const double shift = ( static_cast<double>( l ) + 0.5 ) * height - 0.4;
			out << ( l > 0 ? ", " : " " ) << "$rows using (0.01):($0+" << shift << "):(0.01):" << l + 2 << ":($0+"
			    << shift - height / 2 << "):($0+" << shift + height / 2 << ") with boxxyerror title '" << libraries[l]
			    << "'";
		}
		out << "\n";
		finish( out, script );
		out.close();
		if ( std::system( ( "gnuplot '" + script + "'" ).c_str() ) != 0 )
		{
			throw std::runtime_error( script + ": gnuplot could not draw it" );
		}
	}
}

int runPeers( const PeersSettings& settings )
{
	std::vector<PeerLibrary> peers = findPeers( settings.modules );
	Json header = provenance();
	header["seed"] = settings.seed;
	header["states"] = settings.states;
	header["repetitions"] = settings.repetitions;
	header["quick"] = settings.quick;
	std::printf( "%s, %s, leeway at %s, commit %s\n", header["processor"].get<std::string>().c_str(),
	    header["compiler"].get<std::string>().c_str(), header["simd"].get<std::string>().c_str(),
	    header["commit"].get<std::string>().c_str() );
	for ( const PeerLibrary& peer : peers )
	{
		std::printf( "against %s\n", peer.description.c_str() );
		header["peers"].push_back( peer.description );
	}
	std::printf( "\nmicroseconds, processor time of one thread\n%-58s %-8s %5s | %10s %10s %10s | %s\n", "workload",
	    "library", "n", "median", "mean", "p95", "mean / leeway's" );
	PeerReport report;
	runPeerWorkloads( settings, peers, report );
	if ( !settings.json.empty() )
	{
		report.writeJson( settings.json, header );
	}
	if ( !settings.csv.empty() )
	{
		report.writeCsv( settings.csv );
	}
	if ( !settings.svg.empty() )
	{
		report.writeSvg( settings.svg );
	}
	std::printf( "\ncontradicted: leeway (by all others) %zu", report.disagreements( "leeway" ) );
	for ( const PeerLibrary& peer : peers )
	{
		std::printf( ", %s %zu", peer.name.c_str(), report.disagreements( peer.name ) );
	}
	std::printf( "\n" );
	return report.disagreements( "leeway" ) > 0 ? 1 : 0;
}
