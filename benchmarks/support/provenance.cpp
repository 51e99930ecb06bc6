// SPDX-License-Identifier: BSD-3-Clause
// Where a figure comes from: see provenance.hpp.
#include "support/provenance.hpp"

#include "leeway/leeway.h"

#include <cstdio>
#include <ctime>
#include <fcl/config.h>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <thread>

void Hash::add( const void* bytes, std::size_t count )
{
	const unsigned char* p = static_cast<const unsigned char*>( bytes );
	for ( std::size_t i = 0; i < count; ++i )
	{
		m_state = ( m_state ^ p[i] ) * 1099511628211ull;
	}
}

std::string Hash::text() const
{
	char text[17];
	std::snprintf( text, sizeof text, "%016llx", static_cast<unsigned long long>( m_state ) );
	return text;
}

std::string hashFiles( const std::vector<std::string>& files )
{
	Hash hash;
	for ( const std::string& file : files )
	{
		std::ifstream in( file, std::ios::binary );
		if ( !in )
		{
			throw std::runtime_error( file + ": cannot be read" );
		}
		std::string content( ( std::istreambuf_iterator<char>( in ) ), std::istreambuf_iterator<char>() );
		hash.add( content.data(), content.size() );
	}
	return hash.text();
}

namespace
{

/// First line of a command's output; empty if it fails.
std::string firstLine( const std::string& command )
{
	std::string line;
	if ( FILE* pipe = popen( command.c_str(), "r" ) )
	{
		char text[256];
		if ( std::fgets( text, sizeof text, pipe ) != nullptr )
		{
			line = text;
		}
		pclose( pipe );
	}
	while ( !line.empty() && line.back() == '\n' )
	{
		line.pop_back();
	}
	return line;
}

std::string processor()
{
	std::ifstream info( "/proc/cpuinfo" );
	for ( std::string line; std::getline( info, line ); )
	{
		if ( line.rfind( "model name", 0 ) == 0 )
		{
			return line.substr( line.find( ':' ) + 2 );
		}
	}
	return "unknown";
}

std::string governor()
{
	std::ifstream in( "/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor" );
	std::string text;
	return in >> text ? text : "unknown";
}

const char* simdName( lw_simd level )
{
	switch ( level )
	{
	case LW_SIMD_SCALAR:
		return "scalar";
	case LW_SIMD_SSE2:
		return "SSE2";
	case LW_SIMD_AVX2:
		return "AVX2";
	case LW_SIMD_NEON:
		return "NEON";
	case LW_SIMD_BEST:
		break;
	}
	return "unknown";
}

} // namespace

nlohmann::ordered_json provenance()
{
	const std::string git = std::string( "git -C '" ) + LEEWAY_SOURCE_DIR + "' ";
	const std::string commit = firstLine( git + "rev-parse HEAD 2>/dev/null" );
	char date[32];
	const std::time_t now = std::time( nullptr );
	std::strftime( date, sizeof date, "%Y-%m-%dT%H:%M:%SZ", std::gmtime( &now ) );

	nlohmann::ordered_json json;
	json["commit"] = commit.empty() ? "unknown" : commit;
	// Files unknown to git are not counted: results and build folders are such files
	json["dirty"] = commit.empty() || !firstLine( git + "status --porcelain --untracked-files=no 2>/dev/null" ).empty();
	json["date"] = date;
	json["compiler"] = LEEWAY_BUILD_COMPILER;
	json["c_flags"] = LEEWAY_BUILD_C_FLAGS;
	json["cxx_flags"] = LEEWAY_BUILD_CXX_FLAGS;
	json["processor"] = processor();
	json["hardware_threads"] = std::thread::hardware_concurrency();
	json["governor"] = governor();
	json["simd"] = simdName( lw_simd_available() );
	json["leeway_version"] = lw_version();
	json["fcl_version"] = FCL_VERSION;
	return json;
}

void writeFile( const std::string& file, const std::string& text )
{
	std::ofstream out( file, std::ios::binary );
	out << text;
	if ( !out.flush() )
	{
		throw std::runtime_error( file + ": cannot be written" );
	}
}
