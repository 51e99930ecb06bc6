// SPDX-License-Identifier: BSD-3-Clause
// Cuts and flipped bits in binary files: reading gives a model or an Error, nothing else.
#pragma once

#include "files.hpp"
#include "seeded_rng.hpp"

#include <string>

/// The fate of a series of damaged files.
struct DamageCount
{
	int read = 0, refused = 0;
};

/// @param read takes the bytes of a file and throws io::Error, or does not
template <typename F> void tryDamaged( F read, const std::string& bytes, DamageCount& count )
{
	try
	{
		read( bytes );
		++count.read;
	}
	catch ( const leeway::io::Error& error )
	{
		++count.refused;
		EXPECT_FALSE( error.remedy().empty() ) << error.what();
	}
	catch ( const std::exception& error )
	{
		ADD_FAILURE() << error.what();
	}
}

/// Every file that is the beginning of this one, in steps of at most 1 + size / 60 bytes, is refused.
template <typename F> void expectCutsRefused( F read, const std::string& bytes, std::size_t last )
{
	DamageCount count;
	for ( std::size_t size = 0; size < last; size += 1 + bytes.size() / 60 )
	{
		int before = count.read;
		tryDamaged( read, bytes.substr( 0, size ), count );
		EXPECT_EQ( count.read, before ) << "the first " << size << " of " << bytes.size()
		                                << " bytes were taken for a whole file";
	}
	EXPECT_GT( count.refused, 10 );
}

/// One to four flipped bits in each of 100 copies.
template <typename F> DamageCount tryFlippedBits( F read, const std::string& bytes )
{
	DamageCount count;
	SeededRng rng;
	for ( int i = 0; i < 100; ++i )
	{
		std::string damaged = bytes;
		for ( int flips = rng.integer( 1, 4 ); flips > 0; --flips )
		{
			// Half of them near the beginning, where the sizes are
			int end = static_cast<int>( bytes.size() ) - 1;
			std::size_t at = static_cast<std::size_t>( rng.integer( 0, flips % 2 == 0 ? std::min( end, 150 ) : end ) );
			damaged[at] = static_cast<char>( damaged[at] ^ ( 1 << rng.integer( 0, 7 ) ) );
		}
		tryDamaged( read, damaged, count );
	}
	return count;
}
