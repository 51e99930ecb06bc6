// SPDX-License-Identifier: BSD-3-Clause
// Digests: 128 bits that tell contents apart, of bytes. Not cryptographic.
//
// The inner loop has the form of xxHash64 (Collet, xxHash fast digest algorithm, specification 0.1.1, 2018): four lanes,
// each lane = rotl( lane + word * P2, 31 ) * P1, which can overlap as no lane waits for another. The end is our own: each
// half of the digest takes all four lanes in, in opposite orders, by the 64-bit finaliser of MurmurHash3 (Appleby 2011).
//
// Every step is a bijection of the word taken in while the rest is fixed (odd multipliers, rotations, shifts by xor). So two
// inputs of one length that differ within one aligned word of 8 bytes *always* have digests that differ in both halves: no
// flipped bit escapes a checksum. Other differences escape with a probability of about 2^-128.
#include "base/base.h"

static const uint64_t prime_1 = 0x9e3779b185ebca87ull; // of xxHash64: odd, half of the bits set
static const uint64_t prime_2 = 0xc2b2ae3d27d4eb4full;

// initial values that keep lanes and halves apart: fractions of pi
static const uint64_t lane_start[4] = { 0x243f6a8885a308d3ull, 0x13198a2e03707344ull, 0xa4093822299f31d0ull,
	0x082efa98ec4e6c89ull };
static const uint64_t half_start[2] = { 0x452821e638d01377ull, 0xbe5466cf34e90c6cull };

enum
{
	STRIPE = 32 // bytes: a word for each lane
};

/// Eight bytes, the first the lowest: the same digest on machines of either byte order.
static uint64_t load_word( const unsigned char* p )
{
	return (uint64_t)p[0] | (uint64_t)p[1] << 8 | (uint64_t)p[2] << 16 | (uint64_t)p[3] << 24 | (uint64_t)p[4] << 32 |
		   (uint64_t)p[5] << 40 | (uint64_t)p[6] << 48 | (uint64_t)p[7] << 56;
}

static uint64_t rotate_left( uint64_t x, int bits )
{
	return x << bits | x >> ( 64 - bits );
}

static uint64_t take_in( uint64_t lane, uint64_t word )
{
	return rotate_left( lane + word * prime_2, 31 ) * prime_1;
}

lw_digest lw_digest_bytes( lw_digest from, const void* bytes, size_t size )
{
	const unsigned char* p = bytes;
	// both halves of the digest so far go into two lanes each
	uint64_t a = lane_start[0] + from.word[0], b = lane_start[1] + from.word[1];
	uint64_t c = lane_start[2] ^ rotate_left( from.word[0], 32 ), d = lane_start[3] ^ rotate_left( from.word[1], 32 );
	size_t left = size;
	for ( ; left >= STRIPE; left -= STRIPE, p += STRIPE )
	{
		a = take_in( a, load_word( p ) );
		b = take_in( b, load_word( p + 8 ) );
		c = take_in( c, load_word( p + 16 ) );
		d = take_in( d, load_word( p + 24 ) );
	}
	if ( left > 0 )
	{
		// padded with zeros: the length, mixed in below, distinguishes them from zeros of the input
		unsigned char last[STRIPE] = { 0 };
		for ( size_t i = 0; i < left; ++i )
		{
			last[i] = p[i];
		}
		a = take_in( a, load_word( last ) );
		b = take_in( b, load_word( last + 8 ) );
		c = take_in( c, load_word( last + 16 ) );
		d = take_in( d, load_word( last + 24 ) );
	}
	uint64_t length = (uint64_t)size * prime_1;
	lw_digest out;
	out.word[0] = lwi_mix( lwi_mix( lwi_mix( lwi_mix( half_start[0] ^ length, a ), b ), c ), d );
	out.word[1] = lwi_mix( lwi_mix( lwi_mix( lwi_mix( half_start[1] ^ length, d ), c ), b ), a );
	return out;
}

bool lw_digest_equal( lw_digest a, lw_digest b )
{
	return a.word[0] == b.word[0] && a.word[1] == b.word[1];
}
