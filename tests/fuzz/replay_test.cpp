// SPDX-License-Identifier: BSD-3-Clause
// The corpora once more, in normal runs: every seed, inputs of mended faults, and cuts and flipped bits of
// each.
#include "fuzz.hpp"

#include "seeded_rng.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace
{

struct Case
{
	std::string name, bytes;
};

std::vector<Case> corpusOf( const std::string& target )
{
	std::vector<Case> all;
	const std::filesystem::path folder = std::filesystem::path( LEEWAY_FUZZ_CORPUS ) / target;
	if ( std::filesystem::is_directory( folder ) )
	{
		for ( const auto& entry : std::filesystem::directory_iterator( folder ) )
		{
			std::ifstream stream( entry.path(), std::ios::binary );
			std::ostringstream bytes;
			bytes << stream.rdbuf();
			all.push_back( { entry.path().filename().string(), bytes.str() } );
		}
	}
	for ( const fuzz::Seed& seed : fuzz::generatedSeeds() )
	{
		if ( seed.target == target )
		{
			all.push_back( { "generated-" + seed.name, seed.bytes } );
		}
	}
	std::sort( all.begin(), all.end(), []( const Case& a, const Case& b ) { return a.name < b.name; } );
	return all;
}

class FuzzCorpus : public testing::TestWithParam<fuzz::Target>
{
protected:
	/// An exception that leaves a target is a failure with the name of its input; a crash names it by
	/// LEEWAY_FUZZ_VERBOSE.
	static void run( const std::string& name, fuzz::Input input )
	{
		if ( std::getenv( "LEEWAY_FUZZ_VERBOSE" ) != nullptr )
		{
			std::fprintf( stderr, "%s: %s\n", GetParam().name, name.c_str() );
		}
		try
		{
			GetParam().run( input );
		}
		catch ( const std::exception& error )
		{
			ADD_FAILURE() << GetParam().name << ": " << name << ": " << error.what();
		}
	}
};

std::string nameOf( const testing::TestParamInfo<fuzz::Target>& info )
{
	return info.param.name;
}

} // namespace

TEST_P( FuzzCorpus, IsReadOrRefused )
{
	const std::vector<Case> corpus = corpusOf( GetParam().name );
	EXPECT_GT( corpus.size(), 0u );
	for ( const Case& input : corpus )
	{
		run( input.name, input.bytes );
	}
}

TEST_P( FuzzCorpus, SurvivesCutsAndFlippedBits )
{
	SeededRng rng;
	for ( const Case& input : corpusOf( GetParam().name ) )
	{
		for ( int i = 0; i < 6 && input.bytes.size() > 1 && input.bytes.size() <= GetParam().longest; ++i )
		{
			std::string damaged = input.bytes;
			const int last = static_cast<int>( damaged.size() ) - 1;
			const std::size_t at = static_cast<std::size_t>( rng.integer( 0, last ) );
			if ( i % 3 == 0 )
			{
				damaged.resize( at );
			}
			else
			{
				damaged[at] = static_cast<char>( damaged[at] ^ ( 1 << rng.integer( 0, 7 ) ) );
			}
			run( input.name + ", damaged", damaged );
		}
	}
}

INSTANTIATE_TEST_SUITE_P( All, FuzzCorpus, testing::ValuesIn( fuzz::targets() ), nameOf );
