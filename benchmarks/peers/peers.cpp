// SPDX-License-Identifier: BSD-3-Clause
// The libraries of a comparison, and its results: table, JSON, CSV, pictures. See peers.hpp.
#include "peers/peers.hpp"

#include "peers/fcl_peer.hpp"
#include "support/provenance.hpp"
#include "report/report.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <dlfcn.h>
#include <filesystem>
#include <iterator>
#include <limits>
#include <map>
#include <set>
#include <sstream>
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

} // namespace

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
			peers.push_back( loadModule( file ) );
		}
		catch ( const std::runtime_error& error ) // libraries that the module was built with may be gone
		{
			std::fprintf( stderr, "leeway-bench: without %s\n", error.what() );
		}
	}
	for ( const std::string& file : modules )
	{
		peers.push_back( loadModule( file ) );
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
		}
		for ( const Disagreement& entry : row.examined )
		{
			json["examined"].push_back( { { "number", entry.number }, { "said", entry.said }, { "leeway", entry.leeway },
			    { "true_lower", entry.lower }, { "true_upper", entry.upper }, { "why", entry.why } } );
		}
		rows.push_back( json );
	}
	writeResult( file, { { "rows", rows }, { "provenance", std::move( header ) } } );
}

void PeerReport::writeCsv( const std::string& file ) const
{
	std::ostringstream out;
	out << "workload,library,count,mean_us,median_us,p95_us,answers_hash,disagreements,bytes_per_triangle\n";
	for ( const PeerRow& row : m_rows )
	{
		out << '"' << row.workload << "\"," << row.library << ',' << row.count << ',' << row.time.mean << ','
		    << row.time.median << ',' << row.time.p95 << ',' << row.answers_hash << ',' << row.disagreements << ','
		    << row.bytes_per_triangle << "\n";
	}
	writeFile( file, out.str() );
}

namespace
{

/// The picture of a workload: named by its letter; for states also by the robot, and by environment or self.
std::string pictureOf( const std::string& workload )
{
	for ( const char* about : { " environment ", " self " } )
	{
		const std::size_t found = workload.find( about );
		if ( workload[0] == 'B' && found != std::string::npos )
		{
			std::string name = workload.substr( 0, found + std::string( about ).size() - 1 );
			std::replace( name.begin(), name.end(), ' ', '_' );
			return name;
		}
	}
	return workload.substr( 0, 1 );
}

/// Told apart also by those who see fewer colours; from the ninth library on they repeat.
const char* const COLOURS[] = { "#d55e00", "#0072b2", "#56b4e9", "#009e73", "#cc79a7", "#999999", "#e69f00", "#333333" };

/// Bars are means, marks are medians: a line for each workload, two columns for each library, "-" where it had no part.
void writePlot( std::ostream& out, const std::vector<PeerRow>& rows, const std::string& base )
{
	std::vector<std::string> workloads, libraries;
	double least = std::numeric_limits<double>::infinity();
	for ( const PeerRow& row : rows )
	{
		for ( const auto& [names, name] : { std::pair{ &workloads, row.workload }, std::pair{ &libraries, row.library } } )
		{
			if ( std::find( names->begin(), names->end(), name ) == names->end() )
			{
				names->push_back( name );
			}
		}
		least = std::min( { least, row.time.mean, row.time.median } );
	}
	const double left = std::pow( 10, std::floor( std::log10( 0.7 * least ) ) );
	const std::size_t prefix = std::max<std::size_t>( 1, pictureOf( workloads[0] ).size() ) + 1;
	out << "set terminal svg size 1100," << 110 + workloads.size() * ( 11 * libraries.size() + 14 )
	    << " font 'sans,11' background rgb 'white'\nset output '" << base
	    << ".svg'\nset datafile missing '-'\nset logscale x\nset xlabel 'microseconds: bars are means, marks medians'\n"
	    << "set key outside top horizontal\nset rmargin 6\nset grid x\nset style fill solid\nset xrange [" << left
	    << ":*]\nset yrange [" << static_cast<double>( workloads.size() ) - 0.5 << ":-0.5]\nset ytics (";
	for ( std::size_t w = 0; w < workloads.size(); ++w )
	{
		out << ( w > 0 ? ", " : "" ) << '"' << workloads[w].substr( prefix ) << "\" " << w;
	}
	out << ")\n$rows << END\n";
	for ( const std::string& workload : workloads )
	{
		for ( const std::string& library : libraries )
		{
			const auto found = std::find_if( rows.begin(), rows.end(),
			    [&]( const PeerRow& row ) { return row.workload == workload && row.library == library; } );
			if ( found != rows.end() )
			{
				out << ' ' << found->time.mean << ' ' << found->time.median;
			}
			else
			{
				out << " - -";
			}
		}
		out << "\n";
	}
	out << "END\nplot";
	const double height = 0.85 / static_cast<double>( libraries.size() );
	for ( std::size_t l = 0; l < libraries.size(); ++l )
	{
		const double shift = ( static_cast<double>( l ) + 0.5 ) * height - 0.425;
		out << ( l > 0 ? ", " : " " ) << "$rows using (" << left << "):($0+" << shift << "):(" << left << "):" << 2 * l + 1
		    << ":($0+" << shift - height / 2 << "):($0+" << shift + height / 2 << ") with boxxyerror lc rgb '"
		    << COLOURS[l % std::size( COLOURS )] << "' title '" << libraries[l] << "', $rows using " << 2 * l + 2 << ":($0+"
		    << shift << ") with points pt 7 ps 0.3 lc rgb 'black' notitle";
	}
	out << "\n";
}

} // namespace

void PeerReport::writeSvg( const std::string& folder ) const
{
	if ( !hasGnuplot() )
	{
		throw std::runtime_error( "--svg: there is no gnuplot; install it (Debian: apt-get install gnuplot-nox)" );
	}
	fs::create_directories( folder );
	std::map<std::string, std::vector<PeerRow>> pictures;
	for ( const PeerRow& row : m_rows )
	{
		pictures[pictureOf( row.workload )].push_back( row );
	}
	for ( const auto& [name, rows] : pictures )
	{
		const std::string base = folder + "/" + name, script = base + ".gp";
		std::ostringstream out;
		writePlot( out, rows, base );
		writeFile( script, out.str() );
		runGnuplot( script );
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
	std::printf( "\nmicroseconds, processor time of one thread\n%-62s %-13s %4s | %10s %10s %10s | %s\n", "workload",
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
	std::printf( "\nanswers that brute force contradicts: leeway %zu", report.disagreements( "leeway" ) );
	for ( const PeerLibrary& peer : peers )
	{
		std::printf( ", %s %zu", peer.name.c_str(), report.disagreements( peer.name ) );
	}
	std::printf( "\n" );
	return report.disagreements( "leeway" ) > 0 ? 1 : 0;
}
