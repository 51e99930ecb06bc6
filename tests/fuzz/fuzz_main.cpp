// SPDX-License-Identifier: BSD-3-Clause
// The program that libFuzzer drives: LEEWAY_FUZZ_TARGET names the target. One program for all of them links once.
#include "fuzz.hpp"

#include "leeway/io/limits.hpp"

#include <cstdio>
#include <cstdlib>

namespace
{

const fuzz::Target* chosen = nullptr;

} // namespace

extern "C" int LLVMFuzzerInitialize( int*, char*** );
extern "C" int LLVMFuzzerTestOneInput( const std::uint8_t* data, std::size_t size );

extern "C" int LLVMFuzzerInitialize( int*, char*** )
{
	const char* name = std::getenv( "LEEWAY_FUZZ_TARGET" );
	chosen = name != nullptr ? fuzz::findTarget( name ) : nullptr;
	if ( chosen == nullptr )
	{
		std::fprintf( stderr, "set LEEWAY_FUZZ_TARGET to one of:\n" );
		for ( const fuzz::Target& target : fuzz::targets() )
		{
			std::fprintf( stderr, "  %s\n", target.name );
		}
		std::exit( 2 );
	}
	return 0;
}

extern "C" int LLVMFuzzerTestOneInput( const std::uint8_t* data, std::size_t size )
{
	if ( size <= chosen->longest )
	{
		leeway::io::Limits limits;
		limits.alias_nodes = 10'000; // a million take ten seconds under sanitizers, and a minute beside other work
		const leeway::io::LimitScope scope( limits );
		chosen->run( fuzz::Input( reinterpret_cast<const char*>( data ), size ) );
	}
	return 0;
}
