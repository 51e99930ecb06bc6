// SPDX-License-Identifier: BSD-3-Clause
// Digests: 128 bits that tell contents apart, of bytes, shapes and robots. Not cryptographic.
//
// The inner loop has the form of xxHash64 (Collet, xxHash fast digest algorithm, specification 0.1.1, 2018): four lanes, each
// lane = rotl( lane + word * P2, 31 ) * P1, which can overlap as no lane waits for another. The end is our own: each half of
// the digest takes all four lanes in, in opposite orders, by the 64-bit finaliser of MurmurHash3 (Appleby 2011).
//
// Every step is a bijection of the word taken in while the rest is fixed (odd multipliers, rotations, shifts by xor). So two
// inputs of one length that differ within one aligned word of 8 bytes *always* have digests that differ in both halves: no
// flipped bit escapes a checksum. Other differences escape with a probability of about 2^-128.
#include "leeway/blob.h"
#include "robot_internal.h"
#include "shape_internal.h"

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
	// both halves of what came before go into two lanes each
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
		// filled up with zeros: the length, mixed in below, tells them from zeros of the input
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

// ---- shapes and robots: field by field, as structs have padding -------------------------------------------------------

static lw_digest add_doubles( lw_digest d, const double* values, size_t count )
{
	return lw_digest_bytes( d, values, count * sizeof( double ) );
}

static lw_digest add_floats( lw_digest d, const float* values, size_t count )
{
	return lw_digest_bytes( d, values, count * sizeof( float ) );
}

static lw_digest add_indices( lw_digest d, const uint32_t* values, size_t count )
{
	return lw_digest_bytes( d, values, count * sizeof( uint32_t ) );
}

static lw_digest add_transform( lw_digest d, const lw_transform* m )
{
	return add_doubles( add_doubles( d, &m->r[0][0], 9 ), m->t, 3 );
}

_Static_assert( sizeof( lwi_node ) == LWI_WIDTH * ( 4 * sizeof( float ) + sizeof( lwi_ref ) ), "nodes have no padding" );
_Static_assert( sizeof( lwi_leaf ) == LWI_WIDTH * ( 9 * sizeof( float ) + sizeof( uint32_t ) ), "leaves have no padding" );

lw_digest lw_shape_digest( const lw_shape* shape )
{
	lw_status status;
	if ( shape->deferred != NULL && shape->deferred->def.has_digest )
	{
		return shape->deferred->def.digest;
	}
	shape = lwi_shape_made( shape, &status, NULL );
	if ( shape == NULL )
	{
		return (lw_digest){ { 0, 0 } };
	}
	const uint32_t counts[] = { (uint32_t)shape->type, shape->solid ? 1u : 0u, shape->vertex_count, shape->item_count,
		shape->degenerate_count, shape->root, shape->node_count, shape->leaf_count, shape->depth, shape->filled ? 1u : 0u };
	lw_digest d = add_indices( (lw_digest){ { 0, 0 } }, counts, sizeof( counts ) / sizeof( counts[0] ) );
	d = add_indices( d, &shape->original_count, 1 );
	d = add_doubles( d, &shape->excess, 1 );
	d = add_doubles( d, &shape->radius, 1 );
	d = add_doubles( d, shape->dimensions, 3 );
	d = add_doubles( d, shape->box_min, 3 );
	d = add_doubles( d, shape->box_max, 3 );
	d = add_doubles( d, shape->sphere_center, 3 );
	d = add_doubles( d, &shape->sphere_radius, 1 );
	d = add_doubles( d, shape->origin, 3 );
	d = add_floats( d, &shape->extent, 1 );
	d = add_floats( d, shape->root_sphere, 4 );
	d = add_doubles( d, shape->vertices, 3 * (size_t)shape->vertex_count );
	d = shape->indices != NULL ? add_indices( d, shape->indices, 3 * (size_t)shape->item_count ) : d;
	d = shape->radii != NULL ? add_doubles( d, shape->radii, shape->item_count ) : d;
	d = lw_digest_bytes( d, shape->nodes, shape->node_count * sizeof( lwi_node ) );
	switch ( shape->family )
	{
	case LWI_BALLS:
		return lw_digest_bytes( d, shape->ball_leaves, shape->leaf_count * sizeof( lwi_ball_leaf ) );
	case LWI_BOXES:
		return lw_digest_bytes( d, shape->box_leaves, shape->leaf_count * sizeof( lwi_box_leaf ) );
	case LWI_TRIANGLES:
	case LWI_CONVEX:
	case LWI_UNBOUNDED:
		break;
	}
	return lw_digest_bytes( d, shape->leaves, shape->leaf_count * sizeof( lwi_leaf ) );
}

static lw_digest add_joint( lw_digest d, const lwi_joint* joint )
{
	const uint32_t numbers[] = { (uint32_t)joint->type, (uint32_t)joint->axis_kind, joint->constant ? 1u : 0u, joint->parent,
		joint->child, joint->driver, joint->mimic, joint->own_variable, joint->variable };
	const double values[] = { joint->multiplier, joint->offset, joint->axis_sign, joint->lower, joint->upper };
	d = add_indices( d, numbers, sizeof( numbers ) / sizeof( numbers[0] ) );
	d = add_doubles( d, values, sizeof( values ) / sizeof( values[0] ) );
	d = add_transform( d, &joint->parent_from_joint );
	d = add_doubles( d, joint->axis, 3 );
	d = add_doubles( d, &joint->plane[0][0], 6 );
	d = add_doubles( d, joint->position_lower, 3 );
	return add_doubles( d, joint->position_upper, 3 );
}

static lw_digest add_variable( lw_digest d, const lw_variable_info* variable )
{
	const uint32_t numbers[] = { variable->joint, variable->component, variable->wraps ? 1u : 0u };
	const double limits[] = { variable->lower, variable->upper };
	return add_doubles( add_indices( d, numbers, 3 ), limits, 2 );
}

lw_digest lw_robot_digest( const lw_robot* robot )
{
	const uint32_t counts[] = { robot->link_count, robot->joint_count, robot->body_count, robot->variable_count };
	lw_digest d = add_indices( (lw_digest){ { 0, 0 } }, counts, 4 );
	d = add_transform( d, &robot->world_from_root );
	for ( uint32_t i = 0; i < robot->joint_count; ++i )
	{
		d = add_joint( d, &robot->joints[i] );
	}
	for ( uint32_t i = 0; i < robot->variable_count; ++i )
	{
		d = add_variable( d, &robot->variables[i] );
	}
	for ( uint32_t i = 0; i < robot->body_count; ++i )
	{
		const lw_body_def* body = &robot->bodies[i];
		lw_digest shape = lw_shape_digest( body->shape );
		d = lw_digest_bytes( d, shape.word, sizeof( shape.word ) );
		d = add_indices( d, &body->link, 1 );
		d = add_transform( d, &body->link_from_shape );
	}
	// link_joint, link_order and rigid_group follow from the joints
	size_t words = ( (size_t)robot->link_count * robot->link_count + 31 ) / 32;
	return add_indices( d, robot->allowed, words );
}
