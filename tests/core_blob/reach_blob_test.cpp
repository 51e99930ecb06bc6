// SPDX-License-Identifier: BSD-3-Clause
// Reaches in blobs: hulls, pairs, evidence and tables come back bit by bit, for the robot they were made of and no other.
#include "blob_support.hpp"

#include <cmath>
#include <limits>

namespace
{

struct RobotDeleter
{
	void operator()( lw_robot* robot ) const { lw_robot_release( robot ); }
};
using RobotPtr = std::unique_ptr<lw_robot, RobotDeleter>;

struct ReachDeleter
{
	void operator()( lw_reach* reach ) const { lw_reach_release( reach ); }
};
using ReachPtr = std::unique_ptr<lw_reach, ReachDeleter>;

struct RobotOptions
{
	std::uint32_t links = 7;
	double limit = 2.0;  ///< of the first joint
	double size = 0.1;   ///< of the first box
	bool allowed = true; ///< links 1 and 3 may touch
	bool limited = true; ///< the sliding joint has limits
	const char* name = "arm";
};

/// A chain: fixed, revolute, continuous, prismatic joints in turn. Link 2 has no geometry.
RobotPtr makeRobot( const RobotOptions& o = {} )
{
	std::vector<std::string> names, jointNames;
	std::vector<lw_joint_def> joints;
	std::vector<ShapePtr> shapes;
	std::vector<lw_body_def> bodies;
	SeededRng rng( 3 );
	for ( std::uint32_t i = 0; i < o.links; ++i )
	{
		names.push_back( "link" + std::to_string( i ) );
		jointNames.push_back( "joint" + std::to_string( i ) );
		if ( i > 0 )
		{
			static const lw_joint_type types[] = {
			    LW_JOINT_REVOLUTE, LW_JOINT_CONTINUOUS, LW_JOINT_FIXED, LW_JOINT_PRISMATIC };
			lw_joint_def joint = lw_joint_def_default();
			joint.type = types[( i - 1 ) % 4];
			joint.parent = i - 1;
			joint.child = i;
			joint.parent_from_joint.t[0] = 0.3;
			joint.lower = -1;
			joint.upper = i == 1 ? o.limit : 1;
			if ( joint.type == LW_JOINT_PRISMATIC && !o.limited )
			{
				joint.lower = -INFINITY;
				joint.upper = INFINITY;
			}
			joint.axis[i % 2] = 1;
			joints.push_back( joint );
		}
		if ( i != 2 )
		{
			double size = i == 0 ? o.size : 0.1;
			shapes.push_back( i % 2 == 0 ? makePrimitive( LW_SHAPE_BOX, size, 0.1, 0.2 ) : randomSoup( rng, 12, size ) );
			bodies.push_back( { shapes.back().get(), i, lw_transform_identity() } );
		}
	}
	std::vector<const char*> nameList;
	for ( std::uint32_t i = 0; i < o.links; ++i )
	{
		nameList.push_back( names[i].c_str() );
		if ( i > 0 )
		{
			joints[i - 1].name = jointNames[i].c_str();
		}
	}
	const lw_link_pair allowed = { 1, 3 };
	lw_robot_def def = lw_robot_def_default();
	def.name = o.name;
	def.link_names = nameList.data();
	def.link_count = o.links;
	def.joints = joints.data();
	def.joint_count = static_cast<std::uint32_t>( joints.size() );
	def.bodies = bodies.data();
	def.body_count = static_cast<std::uint32_t>( bodies.size() );
	def.allowed_pairs = &allowed;
	def.allowed_pair_count = o.allowed && o.links > 3 ? 1 : 0;
	lw_robot* robot = nullptr;
	lw_diag diag = {};
	EXPECT_EQ( lw_robot_create( &def, nullptr, &diag, &robot ), LW_OK ) << diag.message;
	return RobotPtr( robot );
}

ReachPtr readReach( const Bytes& blob, const lw_robot* robot, lw_status* status, lw_diag* diag = nullptr,
    const lw_allocator* allocator = nullptr )
{
	lw_reach* reach = reinterpret_cast<lw_reach*>( &status );
	*status = lw_blob_read_reach( blob.begin(), blob.size(), test_key, robot, allocator, diag, &reach );
	EXPECT_EQ( reach == nullptr, *status != LW_OK );
	return ReachPtr( *status == LW_OK ? reach : nullptr );
}

lw_status readStatus( const Bytes& blob, const lw_robot* robot, lw_diag* diag = nullptr )
{
	lw_status status = LW_OK;
	readReach( blob, robot, &status, diag );
	return status;
}

bool mentions( const lw_diag& diag, const char* text )
{
	return std::strstr( diag.message, text ) != nullptr;
}

/// Everything that can be asked of a reach; numbers that no checker could use are failures.
void expectUsable( const lw_reach* reach )
{
	const lw_robot* robot = lw_reach_robot( reach );
	std::uint32_t links = lw_robot_link_count( robot ), variables = lw_robot_variable_count( robot );
	std::vector<double> q( variables );
	bool finite = true;
	for ( std::uint32_t a = 0; a < links; ++a )
	{
		lw_reach_node node = lw_reach_get_node( reach, a );
		EXPECT_FALSE( std::isnan( node.r.radius ) || std::isnan( node.m.radius ) || std::isnan( node.mr.radius ) );
		const double* points = lw_reach_hull_points( reach, a );
		for ( std::uint32_t i = 0; i < 3 * node.hull_point_count; ++i )
		{
			finite = finite && std::isfinite( points[i] );
		}
		for ( std::uint32_t b = 0; b < links; ++b )
		{
			lw_reach_pair pair = lw_reach_get_pair( reach, a, b );
			EXPECT_GE( pair.separation, 0.0 );
			EXPECT_GE( pair.closest, 0.0 );
			EXPECT_STRNE( lw_pair_class_name( pair.kind ), "unknown class" );
			EXPECT_STRNE( lw_pair_proof_name( pair.proof ), "unknown proof" );
			if ( lw_reach_closest_state( reach, a, b, q.data() ) )
			{
				for ( double x : q )
				{
					finite = finite && std::isfinite( x );
				}
			}
		}
	}
	for ( std::uint32_t i = 0; i < variables; ++i )
	{
		double lower = 0, upper = 0;
		lw_reach_variable_range( reach, i, &lower, &upper );
		EXPECT_LE( lower, upper );
	}
	EXPECT_TRUE( finite );
}

} // namespace

TEST( ReachBlob, TheSameComesBack )
{
	std::uint32_t grids = 0;
	for ( std::uint64_t seed = 1; seed < 40; ++seed )
	{
		RobotOptions options;
		options.links = 1 + static_cast<std::uint32_t>( seed % 9 );
		RobotPtr robot = makeRobot( options );
		ReachPtr reach( randomReach( robot.get(), seed ) );
		Bytes blob = writeBlob( {}, reach.get() );
		lw_status status = LW_OK;
		lw_diag diag = {};
		ReachPtr loaded = readReach( blob, robot.get(), &status, &diag );
		ASSERT_EQ( status, LW_OK ) << diag.message;
		const char* difference = reachDifference( reach.get(), loaded.get() );
		EXPECT_EQ( difference, nullptr ) << difference;
		EXPECT_TRUE( blob == writeBlob( {}, loaded.get() ) ) << "a second generation differs";
		EXPECT_EQ( lw_reach_robot( loaded.get() ), robot.get() );
		expectUsable( loaded.get() );
		robot.reset(); // the reach holds it
		expectUsable( loaded.get() );
		grids += loaded->grid_count;
	}
	EXPECT_GT( grids, 50u );
}

TEST( ReachBlob, TheProbeSeesDifferences )
{
	RobotPtr robot = makeRobot();
	ReachPtr a( randomReach( robot.get(), 1 ) ), b( randomReach( robot.get(), 2 ) );
	EXPECT_NE( reachDifference( a.get(), b.get() ), nullptr );
	EXPECT_FALSE( writeBlob( {}, a.get() ) == writeBlob( {}, b.get() ) );
}

TEST( ReachBlob, AReachThatWasComputedComesBack )
{
	for ( bool limited : { true, false } )
	{
		RobotOptions options;
		options.limited = limited; // without, hulls are unbounded
		RobotPtr robot = makeRobot( options );
		lw_reach_def def = lw_reach_def_default();
		def.robot = robot.get();
		def.seconds = 0.2;
		def.samples = 200;
		lw_reach* created = nullptr;
		lw_diag diag = {};
		lw_status status = lw_reach_create( &def, nullptr, &diag, &created );
		if ( status == LW_ERROR_UNSUPPORTED )
		{
			GTEST_SKIP() << diag.message;
		}
		ASSERT_EQ( status, LW_OK ) << diag.message;
		ReachPtr reach( created );
		Bytes blob = writeBlob( {}, reach.get() );
		ReachPtr loaded = readReach( blob, robot.get(), &status, &diag );
		ASSERT_EQ( status, LW_OK ) << diag.message;
		const char* difference = reachDifference( reach.get(), loaded.get() );
		EXPECT_EQ( difference, nullptr ) << difference;
		expectUsable( loaded.get() );
	}
}

TEST( ReachBlob, ShapesAndReachTogether )
{
	RobotPtr robot = makeRobot();
	ReachPtr reach( randomReach( robot.get(), 5 ) );
	std::vector<const lw_shape*> shapes;
	for ( std::uint32_t i = 0; i < lw_robot_body_count( robot.get() ); ++i )
	{
		shapes.push_back( lw_robot_body( robot.get(), i ).shape );
	}
	Bytes blob = writeBlob( shapes, reach.get() );
	lw_blob_info info = {};
	ASSERT_EQ( lw_blob_get_info( blob.begin(), blob.size(), nullptr, &info ), LW_OK );
	EXPECT_EQ( info.shape_count, shapes.size() );
	EXPECT_TRUE( info.has_reach );
	lw_status status = LW_OK;
	std::vector<ShapePtr> loaded = readShapes( blob, shapes.size(), &status );
	ASSERT_EQ( status, LW_OK );
	EXPECT_EQ( readStatus( blob, robot.get() ), LW_OK );
	for ( std::size_t i = 0; i < shapes.size(); ++i )
	{
		EXPECT_TRUE( lw_digest_equal( lw_shape_digest( shapes[i] ), lw_shape_digest( loaded[i].get() ) ) );
	}
}

// The use it is made for: a robot built from loaded shapes is the robot that the reach was made of.
TEST( ReachBlob, OtherRobotsAreStale )
{
	RobotPtr robot = makeRobot();
	ReachPtr reach( randomReach( robot.get(), 5 ) );
	Bytes blob = writeBlob( {}, reach.get() );
	EXPECT_EQ( readStatus( blob, makeRobot().get() ), LW_OK ) << "an equal robot, built again";
	RobotOptions others[5];
	others[0].limit = std::nextafter( 2.0, 3.0 );
	others[1].size = std::nextafter( 0.1, 1.0 );
	others[2].allowed = false;
	others[3].links = 8;
	others[4].links = 1;
	for ( const RobotOptions& options : others )
	{
		lw_diag diag = {};
		EXPECT_EQ( readStatus( blob, makeRobot( options ).get(), &diag ), LW_ERROR_STALE );
		EXPECT_TRUE( mentions( diag, "another robot" ) && mentions( diag, "'arm'" ) && mentions( diag, "build again" ) )
		    << diag.message;
	}
	lw_diag diag = {};
	lw_digest key = test_key;
	key.word[1] ^= 1;
	lw_reach* out = nullptr;
	EXPECT_EQ( lw_blob_read_reach( blob.begin(), blob.size(), key, robot.get(), nullptr, &diag, &out ), LW_ERROR_STALE );
	EXPECT_EQ( lw_blob_read_reach( blob.begin(), blob.size(), test_key, nullptr, nullptr, &diag, &out ),
	    LW_ERROR_INVALID_ARGUMENT );
	EXPECT_EQ( lw_blob_read_reach( blob.begin(), blob.size(), test_key, robot.get(), nullptr, &diag, nullptr ),
	    LW_ERROR_INVALID_ARGUMENT );
	EXPECT_EQ( readStatus( writeBlob( std::vector<const lw_shape*>() ), robot.get(), &diag ), LW_ERROR_INVALID_ARGUMENT );
	EXPECT_TRUE( mentions( diag, "no reach" ) ) << diag.message;
}

TEST( ReachBlob, TruncationAndFlippedBitsAreDamage )
{
	RobotOptions options;
	options.links = 4;
	RobotPtr robot = makeRobot( options );
	ReachPtr reach( randomReach( robot.get(), 5 ) );
	Bytes blob = writeBlob( {}, reach.get() );
	for ( std::size_t size = 0; size < blob.size(); ++size )
	{
		ASSERT_EQ( readStatus( Bytes( blob.begin(), size ), robot.get() ), LW_ERROR_DAMAGED ) << size;
	}
	for ( std::size_t bit = 0; bit < 8 * blob.size(); ++bit )
	{
		unsigned char& byte = blob.begin()[bit / 8];
		byte = static_cast<unsigned char>( byte ^ 1 << bit % 8 );
		ASSERT_EQ( readStatus( blob, robot.get() ), LW_ERROR_DAMAGED ) << "byte " << bit / 8 << " bit " << bit % 8;
		byte = static_cast<unsigned char>( byte ^ 1 << bit % 8 );
	}
	EXPECT_EQ( readStatus( blob, robot.get() ), LW_OK );
}

TEST( ReachBlob, EveryAllocationMayFail )
{
	RobotPtr robot = makeRobot();
	ReachPtr reach( randomReach( robot.get(), 6 ) );
	Bytes blob = writeBlob( {}, reach.get() );
	lw_status status = LW_ERROR_OUT_OF_MEMORY;
	std::size_t failures = 0;
	for ( ; status != LW_OK && failures < 1000; ++failures )
	{
		FailingAllocator memory;
		memory.fail_at = failures + 1;
		lw_diag diag = {};
		{
			ReachPtr loaded = readReach( blob, robot.get(), &status, &diag, &memory.allocator );
			EXPECT_TRUE( status == LW_OK || status == LW_ERROR_OUT_OF_MEMORY ) << diag.message;
		}
		EXPECT_EQ( memory.live, 0u );
	}
	EXPECT_GT( failures, 8u ) << "the allocator is not used";
}

// ---- nonsense with a checksum that holds ----------------------------------------------------------------------------

TEST( ReachBlobNonsense, ImpossibleContentsAreRefused )
{
	RobotPtr robot = makeRobot();
	ReachPtr reach( randomReach( robot.get(), 5 ) );
	const Bytes blob = writeBlob( {}, reach.get() );
	const std::size_t begin = LWI_BLOB_TABLE + LWI_BLOB_TABLE_ENTRY, numbers = begin + 16, counts = numbers + 16;
	const std::size_t links = counts + 48, pairs = links + 124u * 7u, points = pairs + 44u * 21u;
	const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
	ASSERT_EQ( blob.get<std::uint32_t>( counts + 8 ), 7u ) << "the places below are not right any more";
	ASSERT_EQ( blob.get<double>( pairs + 36 ), lw_reach_get_pair( reach.get(), 0, 1 ).contact_share );
	auto refused = [&]( const char* what, std::size_t at, auto value )
	{
		Bytes bytes( blob.begin(), blob.size() );
		bytes.put( at, value );
		bytes.seal();
		lw_diag diag = {};
		EXPECT_EQ( readStatus( bytes, robot.get(), &diag ), LW_ERROR_DAMAGED ) << what;
		EXPECT_TRUE( mentions( diag, "reach" ) && mentions( diag, "build again" ) ) << diag.message;
	};
	for ( double value : { nan, -1.0 } )
	{
		refused( "hull error", numbers, value );
		refused( "margin", numbers + 8, value );
		refused( "dilation", links + 96, value );
		refused( "excess", links + 104, value );
		refused( "separation", pairs + 20, value );
		refused( "closest", pairs + 28, value );
		refused( "share", pairs + 36, value );
	}
	refused( "margin", numbers + 8, inf );
	refused( "share", pairs + 36, 1.5 );
	refused( "center", links, nan );
	refused( "center", links + 32, inf );
	refused( "radius", links + 24, nan );
	refused( "radius", links + 88, -inf );
	refused( "point", points + 8, nan );
	refused( "evidence", points + 24 * blob.get<std::uint64_t>( counts ) + 8, inf );
	for ( std::uint64_t count : { std::uint64_t( 0 ), std::uint64_t( 1 ) << 61, UINT64_MAX } )
	{
		refused( "points", counts, count );
	}
	for ( std::uint64_t first : { std::uint64_t( 1 ) << 20, UINT64_MAX } )
	{
		refused( "first point", links + 112, first );
	}
	for ( std::uint32_t count : { 0u, 6u, 8u, 0xffffffffu } )
	{
		refused( "links", counts + 8, count );
		refused( "variables", counts + 12, count );
		refused( "evidence", counts + 16, count == 0u || count == 6u ? count + 77u : count );
	}
	refused( "hull points", links + 120, 0xffffffffu );
	refused( "class", pairs, 7u );
	refused( "proof", pairs + 4, 3u );
	refused( "flags", pairs + 8, 4u );
	refused( "variables of a pair", pairs + 12, 100u );
	refused( "state", pairs + 16, 0xfffffffeu );
	// links 0 and 1 have geometry, move against each other, and may not touch
	refused( "exempt as without geometry", pairs, std::uint32_t( LW_PAIR_NONE ) );
	refused( "exempt as rigid", pairs, std::uint32_t( LW_PAIR_RIGID ) );
	refused( "exempt as allowed", pairs + 8, 2u );
}

TEST( ReachBlobNonsense, ImpossibleProofsUnderWayAreRefused )
{
	RobotPtr robot = makeRobot();
	ReachPtr reach( randomReach( robot.get(), 5 ) );
	const Bytes blob = writeBlob( {}, reach.get() );
	const std::size_t counts = LWI_BLOB_TABLE + LWI_BLOB_TABLE_ENTRY + 32, points = counts + 48 + 124u * 7u + 44u * 21u;
	const std::size_t evidence = points + 24 * blob.get<std::uint64_t>( counts );
	const std::uint32_t count = blob.get<std::uint32_t>( counts + 16 );
	const std::size_t efforts = evidence + 8u * lw_robot_variable_count( robot.get() ) * count,
	                  cells = efforts + 64u * count;
	const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
	std::size_t under_way = efforts;
	while ( blob.get<std::uint32_t>( under_way + 20 ) == 0 )
	{
		under_way += 64;
	}
	ASSERT_LT( under_way, cells ) << "no proof is under way";
	ASSERT_EQ( blob.get<double>( under_way + 40 ), 0.5 ) << "the places below are not right any more";
	auto refused = [&]( const char* what, std::size_t at, auto value )
	{
		Bytes bytes( blob.begin(), blob.size() );
		bytes.put( at, value );
		bytes.seal();
		EXPECT_EQ( readStatus( bytes, robot.get() ), LW_ERROR_DAMAGED ) << what;
	};
	refused( "time", counts + 32, nan );
	refused( "fewer samples than contacts", counts + 40, 0u );
	refused( "flags", under_way, 64u );
	refused( "contacts", under_way + 4, 101u );
	refused( "visits", under_way + 8, 101u );
	refused( "grids", under_way + 12, 9u );
	refused( "parts of a grid", under_way + 16, 1u << 30 );
	for ( std::uint32_t height : { 0u, 302u, 0xffffffffu } )
	{
		refused( "open cells", under_way + 20, height );
	}
	for ( std::size_t at : { 32u, 40u, 48u, 56u } )
	{
		refused( "no number", under_way + at, nan );
		refused( "below zero", under_way + at, -1.0 );
	}
	refused( "share of all", under_way + 40, 1.0 );
	refused( "share of a proof under way", under_way + 40, 0.0 );
	refused( "target", under_way + 48, inf );
	refused( "cell", cells, nan );
	refused( "evidence of another pair", points - 44u * 21u + 16, 3u );
}

TEST( ReachBlobNonsense, ImpossibleChartsAreRefused )
{
	RobotPtr robot = makeRobot();
	ReachPtr reach( randomReach( robot.get(), 5 ) );
	const Bytes blob = writeBlob( {}, reach.get() );
	const std::size_t counts = LWI_BLOB_TABLE + LWI_BLOB_TABLE_ENTRY + 32, points = counts + 48 + 124u * 7u + 44u * 21u;
	const std::size_t evidence = points + 24 * blob.get<std::uint64_t>( counts );
	const std::uint32_t efforts = blob.get<std::uint32_t>( counts + 16 );
	const std::size_t grids =
	    evidence + ( 8u * lw_robot_variable_count( robot.get() ) + 64u ) * efforts + openBytes( reach.get() );
	const std::uint32_t count = blob.get<std::uint32_t>( counts + 20 ), bits = blob.get<std::uint32_t>( grids + 8 );
	ASSERT_EQ( count, reach->grid_count ) << "the places below are not right any more";
	ASSERT_GE( count, 2u );
	auto refused = [&]( const char* what, std::size_t at, std::uint32_t value )
	{
		Bytes bytes( blob.begin(), blob.size() );
		bytes.put( at, value );
		bytes.seal();
		EXPECT_EQ( readStatus( bytes, robot.get() ), LW_ERROR_DAMAGED ) << what;
	};
	for ( std::uint32_t wrong : { 0u, count - 1, count + 1, 1u << 20, 0xffffffffu } )
	{
		refused( "count", counts + 20, wrong );
	}
	refused( "link that is none", grids, 7u );
	refused( "links the wrong way round", grids, 0u );
	refused( "links the wrong way round", grids + 4, blob.get<std::uint32_t>( grids ) );
	refused( "links that are none", grids + 4, 0xffffffffu );
	for ( std::uint32_t wrong : { bits + 1, bits | 0xffu, bits | 0x0a000000u, 0xffffffffu, 0x090909u } )
	{
		refused( "size", grids + 8, wrong );
	}
	const std::size_t cells = std::size_t( 1 ) << ( ( bits & 255 ) + ( bits >> 8 & 255 ) + ( bits >> 16 & 255 ) );
	refused( "order", grids + 12 + cells, 1u );
}

// Fewer bytes than links and pairs take, and a point count that fits the rest of 2^64.
TEST( ReachBlobNonsense, CountsThatWrapAroundAreRefused )
{
	RobotPtr robot = makeRobot();
	ReachPtr reach( randomReach( robot.get(), 5 ) );
	const Bytes blob = writeBlob( {}, reach.get() );
	const std::size_t begin = LWI_BLOB_TABLE + LWI_BLOB_TABLE_ENTRY, counts = begin + 32, missing = 16;
	const std::size_t size = counts + 44 + 124u * 7u + 44u * 21u - missing;
	Bytes cut( blob.begin(), ( size + 7 ) / 8 * 8 );
	cut.put( LWI_BLOB_SIZE, std::uint64_t( cut.size() ) );
	cut.put( LWI_BLOB_TABLE + 8, std::uint64_t( size - begin ) );
	cut.put( counts, ( std::uint64_t( 0 ) - missing ) / 24 );
	cut.put( counts + 16, std::uint32_t( 0 ) );
	cut.seal();
	ASSERT_EQ( ( std::uint64_t( 0 ) - missing ) % 24, 0u );
	EXPECT_EQ( readStatus( cut, robot.get() ), LW_ERROR_DAMAGED );
}

TEST( ReachBlobNonsense, RandomEditsNeverGiveAnUnusableReach )
{
	SeededRng rng;
	RobotPtr robot = makeRobot();
	int accepted = 0, refused = 0;
	for ( std::uint64_t seed = 1; seed <= 4; ++seed )
	{
		ReachPtr reach( randomReach( robot.get(), seed ) );
		const Bytes blob = writeBlob( {}, reach.get() );
		const std::size_t payload = LWI_BLOB_TABLE;
		for ( int round = 0; round < 10000; ++round )
		{
			Bytes bytes( blob.begin(), blob.size() );
			for ( int edits = rng.integer( 1, 3 ); edits > 0; --edits )
			{
				auto at = static_cast<std::size_t>(
				    rng.integer( static_cast<int>( payload ), static_cast<int>( blob.size() ) - 1 ) );
				unsigned char& byte = bytes.begin()[at];
				byte = static_cast<unsigned char>(
				    rng.integer( 0, 2 ) == 0 ? rng.integer( 0, 255 ) : byte ^ 1 << rng.integer( 0, 7 ) );
			}
			bytes.seal();
			lw_status status = LW_OK;
			ReachPtr loaded = readReach( bytes, robot.get(), &status );
			ASSERT_TRUE( status == LW_OK || status == LW_ERROR_DAMAGED || status == LW_ERROR_STALE );
			++( status == LW_OK ? accepted : refused );
			if ( status == LW_OK )
			{
				expectUsable( loaded.get() );
			}
		}
	}
	EXPECT_GT( accepted, 300 ) << "edits that change nothing of importance are let in";
	EXPECT_GT( refused, 300 );
}
