// SPDX-License-Identifier: BSD-3-Clause
// Digests: unequal inputs differ, equal ones agree, and no value changes unnoticed.
#include "random_robot.hpp"

#include "leeway/blob.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <functional>

namespace
{

using Word = std::pair<std::uint64_t, std::uint64_t>;

const lw_digest start = { { 0, 0 } };

Word words( const lw_digest& d )
{
	return { d.word[0], d.word[1] };
}

lw_digest ofText( const char* text, lw_digest from = start )
{
	return lw_digest_bytes( from, text, std::strlen( text ) );
}

std::vector<unsigned char> randomBytes( SeededRng& rng, std::size_t size )
{
	std::vector<unsigned char> bytes( size );
	for ( unsigned char& b : bytes )
	{
		b = static_cast<unsigned char>( rng.integer( 0, 255 ) );
	}
	return bytes;
}

int bitCount( std::uint64_t x )
{
	int count = 0;
	for ( ; x != 0; x &= x - 1 )
	{
		++count;
	}
	return count;
}

} // namespace

TEST( Digest, PartsAreNotTheirConcatenation )
{
	std::vector<Word> all = { words( ofText( "abc" ) ), words( ofText( "c", ofText( "ab" ) ) ),
	    words( ofText( "bc", ofText( "a" ) ) ), words( ofText( "ab", ofText( "c" ) ) ),
	    words( ofText( "abc", ofText( "" ) ) ), words( ofText( "", ofText( "abc" ) ) ), words( ofText( "" ) ),
	    words( start ) };
	std::sort( all.begin(), all.end() );
	EXPECT_EQ( std::adjacent_find( all.begin(), all.end() ), all.end() );
	EXPECT_TRUE( lw_digest_equal( ofText( "c", ofText( "ab" ) ), ofText( "c", ofText( "ab" ) ) ) );
	EXPECT_TRUE( lw_digest_equal( lw_digest_bytes( start, nullptr, 0 ), ofText( "" ) ) );
	lw_digest other = ofText( "abc" );
	other.word[1] ^= 1;
	EXPECT_FALSE( lw_digest_equal( ofText( "abc" ), other ) ) << "the second half does not count";
}

// A checksum rests on this: certain, not only likely, within one word of 8 bytes.
TEST( Digest, EveryFlippedBitChangesBothHalves )
{
	SeededRng rng;
	double fewest = 1, most = 0;
	for ( std::size_t size = 1; size < 140; ++size )
	{
		std::vector<unsigned char> bytes = randomBytes( rng, size );
		lw_digest before = lw_digest_bytes( start, bytes.data(), size );
		int changed = 0;
		for ( std::size_t bit = 0; bit < 8 * size; ++bit )
		{
			bytes[bit / 8] = static_cast<unsigned char>( bytes[bit / 8] ^ 1 << bit % 8 );
			lw_digest after = lw_digest_bytes( start, bytes.data(), size );
			bytes[bit / 8] = static_cast<unsigned char>( bytes[bit / 8] ^ 1 << bit % 8 );
			ASSERT_NE( before.word[0], after.word[0] );
			ASSERT_NE( before.word[1], after.word[1] );
			changed += bitCount( before.word[0] ^ after.word[0] ) + bitCount( before.word[1] ^ after.word[1] );
		}
		double share = changed / ( 8.0 * static_cast<double>( size ) * 128 );
		fewest = std::min( fewest, share );
		most = std::max( most, share );
	}
	EXPECT_GT( fewest, 0.4 ) << "bits are not spread";
	EXPECT_LT( most, 0.6 );
}

TEST( Digest, ZerosOfDifferentLengthsDiffer )
{
	std::vector<unsigned char> zeros( 3000, 0 );
	std::vector<Word> all;
	for ( std::size_t size = 0; size <= zeros.size(); ++size )
	{
		all.push_back( words( lw_digest_bytes( start, zeros.data(), size ) ) );
	}
	std::sort( all.begin(), all.end() );
	EXPECT_EQ( std::adjacent_find( all.begin(), all.end() ), all.end() );
}

TEST( Digest, CountersDoNotCollideInHalves )
{
	std::vector<std::uint64_t> halves[2], low;
	for ( std::uint32_t i = 0; i < 200000; ++i )
	{
		// small numbers at several places of a block, as counts and indices are
		std::uint32_t input[4] = { i % 7, i, 0, i / 1000 };
		lw_digest d = lw_digest_bytes( start, input, sizeof( input ) );
		halves[0].push_back( d.word[0] );
		halves[1].push_back( d.word[1] );
		low.push_back( d.word[0] & 0xffffffffu );
	}
	for ( std::vector<std::uint64_t>& half : halves )
	{
		std::sort( half.begin(), half.end() );
		EXPECT_EQ( std::adjacent_find( half.begin(), half.end() ), half.end() );
	}
	// 32 bits: n^2 / 2^33 = 4.7 pairs are expected of a random function
	std::sort( low.begin(), low.end() );
	int collisions = 0;
	for ( std::size_t i = 1; i < low.size(); ++i )
	{
		collisions += low[i] == low[i - 1];
	}
	EXPECT_LT( collisions, 25 );
}

TEST( Digest, AlignmentDoesNotMatter )
{
	SeededRng rng;
	std::vector<unsigned char> bytes = randomBytes( rng, 101 );
	lw_digest expected = lw_digest_bytes( start, bytes.data(), bytes.size() );
	for ( std::size_t offset = 0; offset < 9; ++offset )
	{
		std::vector<unsigned char> moved( offset, 0x5a );
		moved.insert( moved.end(), bytes.begin(), bytes.end() );
		EXPECT_TRUE( lw_digest_equal( expected, lw_digest_bytes( start, moved.data() + offset, bytes.size() ) ) );
	}
}

// Checksums and keys in files on users' disks: whoever changes these values must raise the format version of blobs.
TEST( Digest, ValuesAreThoseOfTheFirstVersion )
{
	unsigned char bytes[100];
	for ( int i = 0; i < 100; ++i )
	{
		bytes[i] = static_cast<unsigned char>( 7 * i );
	}
	lw_digest empty = lw_digest_bytes( start, bytes, 0 ), some = lw_digest_bytes( start, bytes, 100 );
	lw_digest chained = lw_digest_bytes( some, bytes, 33 );
	EXPECT_EQ( empty.word[0], 0xa7332e4215980db8ull );
	EXPECT_EQ( empty.word[1], 0x7820c2fb0a3c6ce9ull );
	EXPECT_EQ( some.word[0], 0x181780ded4a74299ull );
	EXPECT_EQ( some.word[1], 0x0e86a88d3c58a655ull );
	EXPECT_EQ( chained.word[0], 0x461679e8339302d8ull );
	EXPECT_EQ( chained.word[1], 0x7121e7690f25c63bull );
}

// ---- shapes ---------------------------------------------------------------------------------------------------------

TEST( ShapeDigest, EqualShapesAreEqualOthersAreNot )
{
	std::vector<Word> all;
	auto add = [&all]( lw_shape* shape )
	{
		ASSERT_NE( shape, nullptr );
		all.push_back( words( lw_shape_digest( shape ) ) );
		lw_shape_release( shape );
	};
	auto mesh = []( double x, lw_sphere_fit fit, std::uint32_t leafSize )
	{
		const double vertices[12] = { 0, 0, 0, 1, 0, 0, 0, 1, 0, x, 1, 1 };
		const std::uint32_t indices[9] = { 0, 1, 2, 1, 2, 3, 0, 1, 3 };
		lw_mesh_def def = lw_mesh_def_default();
		def.vertices = vertices;
		def.vertex_count = 4;
		def.indices = indices;
		def.triangle_count = 3;
		def.tree.fit = fit;
		def.tree.leaf_size = leafSize;
		lw_shape* shape = nullptr;
		lw_shape_create_mesh( &def, nullptr, nullptr, &shape );
		return shape;
	};
	auto points = []( double radius )
	{
		const double p[6] = { 0, 0, 0, 1, 2, 3 };
		lw_shape* shape = nullptr;
		lw_shape_create_points( p, 2, radius, nullptr, nullptr, nullptr, &shape );
		return shape;
	};
	auto primitive = []( lw_shape_type type, double x, double y )
	{
		const double d[3] = { x, y, 1 };
		lw_shape* shape = nullptr;
		lw_shape_create_primitive( type, d, nullptr, nullptr, &shape );
		return shape;
	};
	for ( int copy = 0; copy < 2; ++copy )
	{
		add( mesh( 0.5, LW_FIT_MINIMAL, 8 ) );
		add( mesh( std::nextafter( 0.5, 1 ), LW_FIT_MINIMAL, 8 ) );
		add( mesh( 0.5, LW_FIT_MINIMAL, 1 ) );
		add( mesh( 0.5, LW_FIT_GREEDY, 1 ) );
		add( points( 0.0 ) );
		add( points( 0.1 ) );
		for ( int type = LW_SHAPE_BOX; type <= LW_SHAPE_CONE; ++type )
		{
			add( primitive( static_cast<lw_shape_type>( type ), 1, 1 ) );
			add( primitive( static_cast<lw_shape_type>( type ), std::nextafter( 1.0, 2 ), 1 ) );
		}
		add( primitive( LW_SHAPE_CAPSULE, 1, 0.5 ) );
		add( primitive( LW_SHAPE_HALFSPACE, 0, 0 ) );
		add( primitive( LW_SHAPE_PLANE, 0, 0 ) );
		const double balls[8] = { 0, 0, 0, 0.1, 1, 2, 3, 0.1 }, larger[8] = { 0, 0, 0, 0.1, 1, 2, 3, 0.2 };
		const double box[6] = { 0, 0, 0, 1, 1, 1 }, longer[6] = { 0, 0, 0, 1, 1, 1.5 };
		for ( int i = 0; i < 2; ++i )
		{
			lw_shape* shape = nullptr;
			lw_shape_create_spheres( i == 0 ? balls : larger, 2, nullptr, nullptr, nullptr, &shape );
			add( shape );
			lw_shape_create_boxes( i == 0 ? box : longer, 1, nullptr, nullptr, nullptr, &shape );
			add( shape );
		}
	}
	std::size_t half = all.size() / 2;
	EXPECT_TRUE( std::equal( all.begin(), all.begin() + static_cast<std::ptrdiff_t>( half ),
	    all.begin() + static_cast<std::ptrdiff_t>( half ) ) );
	all.resize( half );
	std::sort( all.begin(), all.end() );
	EXPECT_EQ( std::adjacent_find( all.begin(), all.end() ), all.end() );
}

// ---- robots ---------------------------------------------------------------------------------------------------------

namespace
{

/// Joints of every type, a mimic joint, and bodies of a mesh and a box.
RobotModel someRobot()
{
	SeededRng rng( 7 );
	RobotModel model;
	std::uint32_t root = model.link( "root" );
	model.joint( "fixed", LW_JOINT_FIXED, root );
	model.joint( "revolute", LW_JOINT_REVOLUTE, 1 );
	model.joint( "continuous", LW_JOINT_CONTINUOUS, 2 );
	model.joint( "prismatic", LW_JOINT_PRISMATIC, 3 );
	model.joint( "planar", LW_JOINT_PLANAR, 2 );
	model.joint( "floating", LW_JOINT_FLOATING, 0 );
	lw_joint_def& follower = model.joint( "mimic", LW_JOINT_REVOLUTE, 4 );
	follower.mimic = 1;
	follower.mimic_multiplier = 0.5;
	model.body( 2, randomMesh( rng, 20, 0.1, nullptr ), lw_transform_identity() );
	model.body( 5, randomPrimitive( rng, 0.1, nullptr ), lw_transform_identity() );
	model.allowed.push_back( { 2, 5 } );
	return model;
}

} // namespace

TEST( RobotDigest, EachChangeOfTheModelIsSeen )
{
	using Change = std::function<void( RobotModel& )>;
	auto ulp = []( double& x ) { x = std::nextafter( x, 10 ); };
	std::vector<Change> changes = {
	    []( RobotModel& ) {},
	    [&]( RobotModel& m ) { ulp( m.joints[1].lower ); },
	    [&]( RobotModel& m ) { ulp( m.joints[1].upper ); },
	    [&]( RobotModel& m ) { ulp( m.joints[3].lower ); },
	    []( RobotModel& m ) { m.joints[4].position_upper[1] = 2; },
	    []( RobotModel& m ) { m.joints[5].position_lower[2] = -2; },
	    [&]( RobotModel& m ) { ulp( m.joints[6].mimic_multiplier ); },
	    []( RobotModel& m ) { m.joints[6].mimic_offset = 1e-300; },
	    []( RobotModel& m ) { m.joints[6].mimic = 2; },
	    []( RobotModel& m ) { m.joints[6].mimic = LW_INVALID_INDEX; },
	    []( RobotModel& m ) { m.joints[1].axis[2] = -1; },
	    []( RobotModel& m ) { m.joints[1].axis[0] = 1e-9; },
	    []( RobotModel& m ) { m.joints[1].parent_from_joint.t[0] = 1e-300; },
	    []( RobotModel& m ) { m.joints[0].parent_from_joint.t[2] = 1; },
	    []( RobotModel& m ) { m.joints[5].parent = 1; },
	    []( RobotModel& m ) { std::swap( m.joints[0], m.joints[5] ); },
	    []( RobotModel& m ) { m.joints[1].type = LW_JOINT_PRISMATIC; },
	    []( RobotModel& m ) { m.joints[0].type = LW_JOINT_CONTINUOUS; },
	    []( RobotModel& m ) { m.allowed[0].link_b = 4; },
	    []( RobotModel& m ) {
		    m.allowed.push_back( { 6, 7 } );
	    },
	    []( RobotModel& m ) { m.allowed.clear(); },
	    []( RobotModel& m ) { m.bodies[0].link = 3; },
	    []( RobotModel& m ) { m.bodies[0].link_from_shape.t[1] = 1e-300; },
	    []( RobotModel& m ) { std::swap( m.bodies[0].shape, m.bodies[1].shape ); },
	    []( RobotModel& m ) { std::swap( m.bodies[0], m.bodies[1] ); },
	    []( RobotModel& m ) { m.bodies.pop_back(); },
	    []( RobotModel& m ) { m.worldFromRoot.t[2] = 1e-300; },
	};
	std::vector<Word> all;
	for ( const Change& change : changes )
	{
		RobotModel model = someRobot();
		change( model );
		RobotPtr robot = model.create();
		ASSERT_NE( robot, nullptr ) << "change " << all.size();
		all.push_back( words( lw_robot_digest( robot.get() ) ) );
	}
	std::vector<Word> sorted = all;
	std::sort( sorted.begin(), sorted.end() );
	auto twice = std::adjacent_find( sorted.begin(), sorted.end() );
	for ( std::size_t i = 0; twice != sorted.end() && i < all.size(); ++i )
	{
		EXPECT_NE( all[i], *twice ) << "change " << i;
	}
}

TEST( RobotDigest, EqualModelsAreEqualWhateverTheirNames )
{
	RobotModel model = someRobot();
	RobotPtr a = model.create();
	RobotModel renamed = someRobot();
	renamed.linkNames[3] = "another name";
	renamed.jointNames[3] = "and a longer one";
	renamed.allowed.push_back( { 5, 2 } ); // the same pair again
	RobotPtr b = renamed.create();
	EXPECT_TRUE( lw_digest_equal( lw_robot_digest( a.get() ), lw_robot_digest( b.get() ) ) );
}
