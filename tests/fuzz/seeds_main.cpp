// SPDX-License-Identifier: BSD-3-Clause
// Writes the generated seeds: FOLDER/<target>/<name> for each, and prints the names of all targets.
#include "fuzz.hpp"

#include <cstdio>
#include <filesystem>
#include <fstream>

int main( int argc, char** argv )
{
	if ( argc != 2 )
	{
		std::fprintf( stderr, "usage: leeway_fuzz_seeds FOLDER\n" );
		return 2;
	}
	for ( const fuzz::Target& target : fuzz::targets() )
	{
		std::filesystem::create_directories( std::filesystem::path( argv[1] ) / target.name );
		std::printf( "%s %zu\n", target.name, target.longest );
	}
	for ( const fuzz::Seed& seed : fuzz::generatedSeeds() )
	{
		std::ofstream stream(
		    std::filesystem::path( argv[1] ) / seed.target / ( "generated-" + seed.name ), std::ios::binary );
		stream << seed.bytes;
		if ( !stream.flush() )
		{
			std::fprintf( stderr, "cannot write into %s\n", argv[1] );
			return 1;
		}
	}
	return 0;
}
