// SPDX-License-Identifier: BSD-3-Clause
// Checkers with motion hulls and pair tables against the same checkers without: random robots with joints of every type,
// random groups, states inside and outside of the tables' cells. The answers must not differ.
#include "all_pairs.hpp"
#include "checker_handles.hpp"
#include "counting_allocator.hpp"
#include "random_robot.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <limits>
#include <thread>

namespace
{

const double inf = std::numeric_limits<double>::infinity();

/// Coarse hulls: a tenth of the default cost.
ReachPtr makeReach( const lw_robot* robot, double seconds, uint32_t samples = 100 )
{
	lw_reach_def def = lw_reach_def_default();
	def.robot = robot;
	def.seconds = seconds;
	def.samples = samples;
	def.hull_error = 0.3;
	lw_reach* reach = nullptr;
	lw_diag diag = {};
	EXPECT_EQ( LW_OK, lw_reach_create( &def, nullptr, &diag, &reach ) ) << diag.message;
	return ReachPtr( reach );
}

ScenePtr randomScene( SeededRng& rng, int objects, double spread )
{
	std::vector<ShapePtr> shapes;
	std::vector<std::string> names;
	std::vector<const char*> pointers;
	std::vector<lw_scene_shape_def> placed;
	for ( int i = 0; i < objects; ++i )
	{
		names.push_back( "object" + std::to_string( i ) );
		shapes.emplace_back( i % 2 == 0 ? randomPrimitive( rng, 0.3, nullptr ) : randomMesh( rng, 20, 0.2, nullptr ) );
		placed.push_back( { shapes.back().get(), static_cast<uint32_t>( i ), randomTransform( rng, spread ) } );
	}
	for ( const std::string& name : names )
	{
		pointers.push_back( name.c_str() );
	}
	lw_scene_def def = lw_scene_def_default();
	def.object_names = pointers.data();
	def.object_count = static_cast<uint32_t>( objects );
	def.shapes = placed.data();
	def.shape_count = static_cast<uint32_t>( placed.size() );
	lw_scene* scene = nullptr;
	EXPECT_EQ( LW_OK, lw_scene_create( &def, nullptr, nullptr, &scene ) );
	return ScenePtr( scene );
}

/// A robot in a scene, a group of its variables, and its proofs.
struct World
{
	RobotPtr robot;
	ScenePtr scene;
	ReachPtr reach;
	State reference;
	std::vector<uint32_t> group;
	CheckerPtr checker;

	lw_status build( lw_diag* diag, const lw_allocator* allocator = nullptr )
	{
		lw_checker_def def = lw_checker_def_default();
		const uint32_t none = 0;
		def.robot = robot.get();
		def.scene = scene.get();
		def.variables = group.empty() ? &none : group.data();
		def.variable_count = static_cast<uint32_t>( group.size() );
		def.reference = reference.data();
		def.reach = reach.get();
		lw_checker* made = nullptr;
		lw_status status = lw_checker_create( &def, allocator, diag, &made );
		checker.reset( made );
		return status;
	}

	void build()
	{
		lw_diag diag = {};
		ASSERT_EQ( LW_OK, build( &diag ) ) << diag.message;
	}
};

/// The same robot in the same scene, without a group, a reference and a checker.
World sameRobot( const World& world )
{
	World same;
	same.robot.reset( lw_robot_retain( world.robot.get() ) );
	same.scene.reset( lw_scene_retain( world.scene.get() ) );
	same.reach.reset( lw_reach_retain( world.reach.get() ) );
	return same;
}

/// Joints in the group with a chance of two in three; all variables of a joint or none.
std::vector<uint32_t> randomGroup( SeededRng& rng, const lw_robot* robot )
{
	std::vector<uint32_t> group;
	bool chosen = false;
	for ( uint32_t i = 0; i < lw_robot_variable_count( robot ); ++i )
	{
		if ( lw_robot_variable( robot, i ).component == 0 )
		{
			chosen = rng.integer( 0, 2 ) > 0;
		}
		if ( chosen )
		{
			group.push_back( i );
		}
	}
	return group;
}

RandomRobotOptions randomOptions( SeededRng& rng )
{
	RandomRobotOptions options;
	options.joints = rng.integer( 3, 14 );
	options.floating = rng.integer( 0, 2 ) == 0;
	options.size = rng.integer( 0, 1 ) != 0 ? 0.05 : 0.15;
	return options;
}

/// @param proved with a reach
World randomWorld( SeededRng& rng, const RandomRobotOptions& options, bool proved )
{
	World world;
	RobotModel model = randomRobot( rng, options );
	for ( int i = rng.integer( 0, 3 ); i > 0; --i ) // links with several bodies
	{
		uint32_t link = static_cast<uint32_t>( rng.integer( 0, options.joints ) );
		model.body( link, randomPrimitive( rng, options.size, nullptr ), randomTransform( rng, 0.2 ) );
	}
	for ( uint32_t i = 0; i < model.joints.size(); ++i )
	{
		model.allowed.push_back( { model.joints[i].parent, model.joints[i].child } );
	}
	world.robot = model.create();
	if ( proved )
	{
		world.reach = makeReach( world.robot.get(), 0.05 );
	}
	world.scene = randomScene( rng, rng.integer( 0, 12 ), 2 );
	world.reference = randomState( rng, world.robot.get() );
	world.group = randomGroup( rng, world.robot.get() );
	world.build();
	return world;
}

World randomWorld( SeededRng& rng )
{
	return randomWorld( rng, randomOptions( rng ), true );
}

State groupState( SeededRng& rng, const World& world, double excess )
{
	State full = randomState( rng, world.robot.get(), excess ), q;
	for ( uint32_t variable : world.group )
	{
		q.push_back( full[variable] );
	}
	return q;
}

/// Questions with one exact answer: alpha is 0. Then come the others.
const lw_range exact_ranges[] = { { 0, inf, 0 }, { 0, 0.01, 0 }, { 0, 0.2, 0 }, { 0.01, 0.05, 0 }, { 0, 5e-324, 0 },
    { 0.02, std::nextafter( 0.02, 1.0 ), 0 } };
const lw_range wide_ranges[] = { { 0, inf, 0.3 }, { 0.01, 0.3, 0.3 } };

void expectSame( const lw_clearance& plain, const lw_clearance& got, const char* which )
{
	EXPECT_EQ( plain.kind, got.kind ) << which << ' ' << plain.upper << ' ' << got.upper;
	if ( plain.kind != LW_CLEARANCE_VIOLATION ) // there any pair at or below min_d will do
	{
		EXPECT_EQ( plain.upper, got.upper ) << which;
		if ( plain.lower != got.lower )
		{
			EXPECT_NEAR( plain.lower, got.lower, 1e-12 ) << which;
		}
	}
}

void expectContains( const lw_clearance& exact, const lw_clearance& got, const lw_range& range, const char* which )
{
	if ( got.kind == LW_CLEARANCE_VIOLATION )
	{
		EXPECT_LE( exact.upper, range.min_d + ALL_PAIRS_ROUNDING ) << which;
		return;
	}
	EXPECT_LE( got.lower, exact.upper + ALL_PAIRS_ROUNDING ) << which;
	EXPECT_GE( got.upper, std::min( exact.lower, range.max_d ) - ALL_PAIRS_ROUNDING ) << which;
	if ( got.upper < inf )
	{
		EXPECT_LE( got.upper - got.lower, range.alpha * got.upper + 1e-10 ) << which; // and the rounding of poses;
	}
}

lw_state_result ask( const World& world, lw_query* query, const State& q, const lw_range* range, bool stop_at_first = false )
{
	lw_state_result out;
	EXPECT_EQ( LW_OK, lw_checker_state( world.checker.get(), query, q.data(), LW_CHECK_BOTH, range, stop_at_first, &out ) );
	return out;
}

/// All questions about one state, by all kinds of queries. @return the exact clearances
lw_state_result compareState( AllPairs& oracle, const World& world, const std::vector<QueryPtr>& queries, const State& q )
{
	const lw_state_result exact = oracle.state( q );
	for ( const QueryPtr& query : queries )
	{
		for ( const lw_range& range : exact_ranges )
		{
			const lw_state_result got = ask( world, query.get(), q, &range );
			expectImplied( exact.environment, got.environment, range, "environment" );
			expectImplied( exact.self, got.self, range, "self" );
			if ( !isDecidedByRounding( exact.environment, range ) && !isDecidedByRounding( exact.self, range ) )
			{
				const bool blocked = std::min( exact.environment.upper, exact.self.upper ) <= range.min_d;
				const lw_verdict verdict = blocked ? LW_VERDICT_BLOCKED : LW_VERDICT_FREE;
				EXPECT_EQ( verdict, got.verdict ) << "min_d " << range.min_d << " max_d " << range.max_d;
				EXPECT_EQ( verdict, ask( world, query.get(), q, &range, true ).verdict ) << "stop at first";
			}
		}
		for ( const lw_range& range : wide_ranges )
		{
			const lw_state_result got = ask( world, query.get(), q, &range );
			expectContains( exact.environment, got.environment, range, "environment" );
			expectContains( exact.self, got.self, range, "self" );
		}
	}
	return exact;
}

/// @param left_out bits: hulls, tables, planes
std::vector<QueryPtr> hierarchicalQueries( const World& world, int left_out )
{
	std::vector<QueryPtr> queries;
	queries.push_back( makeQuery( world.checker.get() ) );
	queries.push_back( makeQuery( world.checker.get(), false ) );
	lw_query_def def = lw_query_def_default();
	def.motion_hulls = ( left_out & 1 ) == 0;
	def.pair_tables = ( left_out & 2 ) == 0;
	def.planes = ( left_out & 4 ) == 0;
	lw_query* query = nullptr;
	EXPECT_EQ( LW_OK, lw_query_create( &def, nullptr, world.checker.get(), nullptr, &query ) );
	queries.emplace_back( query );
	return queries;
}

/// A base, a slider on it that can come 0.3 m near to a post on the far side, and cannot within its limits come nearer.
World sliderWorld( double lower, double upper )
{
	World world;
	RobotModel model;
	uint32_t base = model.link( "base" );
	model.joint( "carriage", LW_JOINT_PRISMATIC, base );
	model.joints.back().axis[0] = 1;
	model.joints.back().axis[2] = 0;
	model.joints.back().lower = lower;
	model.joints.back().upper = upper;
	model.joint( "tool", LW_JOINT_REVOLUTE, 1 );
	model.joints.back().lower = -1;
	model.joints.back().upper = 1;
	const double box[3] = { 0.2, 0.2, 0.2 }, ball[3] = { 0.1, 0, 0 };
	lw_shape* shape = nullptr;
	EXPECT_EQ( LW_OK, lw_shape_create_primitive( LW_SHAPE_BOX, box, nullptr, nullptr, &shape ) );
	lw_transform at = lw_transform_identity();
	at.t[0] = 2;
	model.body( base, shape, at );
	EXPECT_EQ( LW_OK, lw_shape_create_primitive( LW_SHAPE_SPHERE, ball, nullptr, nullptr, &shape ) );
	model.body( 2, shape, lw_transform_identity() );
	world.robot = model.create();
	world.reach = makeReach( world.robot.get(), 0.5 );
	world.reference = { 0, 0 };
	world.group = { 0, 1 };
	return world;
}

} // namespace

TEST( Hierarchy, ChangesAnAnswer )
{
	SeededRng rng;
	int covered = 0, ruled_out = 0, blocked = 0, free = 0;
	for ( int i = 0; i < 100; ++i )
	{
		SCOPED_TRACE( ::testing::Message() << "world " << i );
		World world = randomWorld( rng );
		const lw_checker_info info = lw_checker_get_info( world.checker.get() );
		covered += info.hierarchy;
		ruled_out += info.never_pairs > 0;
		AllPairs oracle( world.checker.get() );
		std::vector<QueryPtr> queries = hierarchicalQueries( world, i % 7 + 1 );
		for ( int k = 0; k < 12 && !HasFailure(); ++k )
		{
			SCOPED_TRACE( ::testing::Message() << "state " << k );
			State q = groupState( rng, world, k % 4 == 3 ? 1.5 : 0 );
			++( compareState( oracle, world, queries, q ).verdict == LW_VERDICT_FREE ? free : blocked );
		}
	}
	EXPECT_GE( covered, 80 );
	EXPECT_GE( ruled_out, 20 );
	EXPECT_GE( std::min( free, blocked ), 60 );
}

// More clusters than there are proxies for, and nothing proved of any state: all of them are asked at once.
TEST( Hierarchy, PairOfManyNodesIsLost )
{
	SeededRng rng;
	int apart = 0;
	for ( int i = 0; i < 12; ++i )
	{
		SCOPED_TRACE( ::testing::Message() << "world " << i );
		RandomRobotOptions options = randomOptions( rng );
		options.joints = i == 0 ? 270 : rng.integer( 40, 80 ); // the first has more than there is room for
		options.size = 0.01;
		const World world = randomWorld( rng, options, false );
		AllPairs oracle( world.checker.get() );
		const std::vector<QueryPtr> queries = hierarchicalQueries( world, i % 7 + 1 );
		for ( int k = 0; k < 12 && !HasFailure(); ++k )
		{
			SCOPED_TRACE( ::testing::Message() << "state " << k );
			const State q = groupState( rng, world, k % 4 == 3 ? 1.5 : 0 );
			apart += compareState( oracle, world, queries, q ).self.upper > 0;
		}
	}
	EXPECT_GE( apart, 30 );
}

// Without reach the same checker must say the same: a reach is no part of a checker's meaning.
TEST( Hierarchy, ReachChangesAChecker )
{
	SeededRng rng;
	for ( int i = 0; i < 20; ++i )
	{
		World world = randomWorld( rng ), bare = sameRobot( world );
		bare.reference = world.reference;
		bare.group = world.group;
		bare.reach.reset();
		bare.build();
		lw_checker_info with = lw_checker_get_info( world.checker.get() ),
		                without = lw_checker_get_info( bare.checker.get() );
		EXPECT_EQ( with.self_pairs, without.self_pairs );
		EXPECT_EQ( with.environment_pairs, without.environment_pairs );
		EXPECT_EQ( with.static_environment.upper, without.static_environment.upper );
		EXPECT_EQ( without.never_pairs, 0u );
		EXPECT_FALSE( without.hierarchy );
		QueryPtr one = makeQuery( world.checker.get() ), other = makeQuery( bare.checker.get() );
		for ( int k = 0; k < 10; ++k )
		{
			State q = groupState( rng, world, 0 );
			lw_state_result a = ask( world, one.get(), q, nullptr ), b = ask( bare, other.get(), q, nullptr );
			expectSame( b.environment, a.environment, "environment" );
			expectSame( b.self, a.self, "self" );
		}
	}
}

TEST( Hierarchy, OneQueryMixesUpTwoCheckers )
{
	SeededRng rng;
	for ( int i = 0; i < 10; ++i )
	{
		World world = randomWorld( rng ), other = sameRobot( world );
		other.reference = randomState( rng, world.robot.get() );
		other.group = randomGroup( rng, world.robot.get() );
		other.build();
		// a query must be large enough for both
		const World& large = world.group.size() > other.group.size() ? world : other;
		QueryPtr shared = makeQuery( large.checker.get(), false );
		QueryPtr fresh[2] = {
		    makeQueryWithoutReach( world.checker.get(), false ), makeQueryWithoutReach( other.checker.get(), false ) };
		for ( int k = 0; k < 10; ++k )
		{
			const World& asked = k % 2 == 0 ? world : other;
			State q = groupState( rng, asked, 0 );
			lw_state_result want = ask( asked, fresh[k % 2].get(), q, nullptr ), got;
			lw_status status =
			    lw_checker_state( asked.checker.get(), shared.get(), q.data(), LW_CHECK_BOTH, nullptr, false, &got );
			if ( status == LW_OK ) // else it was too small
			{
				expectSame( want.environment, got.environment, "environment" );
				expectSame( want.self, got.self, "self" );
			}
		}
	}
}

TEST( Hierarchy, TablesAreUsedOutsideTheirRanges )
{
	World world = sliderWorld( -1, 1.5 );
	world.build();
	lw_checker_info info = lw_checker_get_info( world.checker.get() );
	ASSERT_TRUE( info.hierarchy );
	ASSERT_EQ( info.never_pairs, 1u ) << "the case is pointless if nothing is proved";
	QueryPtr query = makeQuery( world.checker.get() );
	const lw_range boolean = { 0, 5e-324, 0 };
	EXPECT_EQ( ask( world, query.get(), { 1.5, 0 }, &boolean, true ).verdict, LW_VERDICT_FREE );
	EXPECT_EQ( ask( world, query.get(), { 1.95, 0 }, &boolean, true ).verdict, LW_VERDICT_BLOCKED );
	EXPECT_EQ( ask( world, query.get(), { 1.95, 0 }, nullptr ).verdict, LW_VERDICT_BLOCKED );
	EXPECT_NEAR( ask( world, query.get(), { 1.75, 0 }, nullptr ).self.upper, 0.05, 1e-9 );
	EXPECT_NEAR( ask( world, query.get(), { 1.5, 0 }, nullptr ).self.upper, 0.3, 1e-9 );

	// an edge out of the ranges and back into them would pass if its ends were looked at one by one
	lw_edge_def edge = lw_edge_def_default();
	lw_edge_result out;
	const double inside[2] = { 1.2, 0 }, outside[2] = { 1.95, 0 };
	ASSERT_EQ( LW_OK, lw_checker_edge( world.checker.get(), query.get(), inside, outside, &edge, &out ) );
	EXPECT_EQ( out.verdict, LW_VERDICT_BLOCKED );
	ASSERT_EQ( LW_OK, lw_checker_edge( world.checker.get(), query.get(), outside, inside, &edge, &out ) );
	EXPECT_EQ( out.verdict, LW_VERDICT_BLOCKED );
}

TEST( Hierarchy, TablesAreUsedForAReferenceOutsideTheirRanges )
{
	World world = sliderWorld( -1, 1.5 );
	world.group = { 1 };
	world.reference = { 1.95, 0 }; // the slider is not in the group, and further out than its limits
	world.build();
	lw_checker_info info = lw_checker_get_info( world.checker.get() );
	EXPECT_FALSE( info.hierarchy );
	EXPECT_EQ( info.never_pairs, 0u );
	QueryPtr query = makeQuery( world.checker.get() );
	const lw_range boolean = { 0, 5e-324, 0 };
	EXPECT_EQ( ask( world, query.get(), { 0.5 }, &boolean, true ).verdict, LW_VERDICT_BLOCKED );
}

namespace
{

/// The same, with a reference that has the group as far away as numbers go.
World farReference( const World& world )
{
	World far = sameRobot( world );
	far.reference = world.reference;
	far.group = world.group;
	for ( uint32_t variable : far.group )
	{
		if ( lw_robot_variable( far.robot.get(), variable ).component < 3 ) // a floating joint's quaternion stays one
		{
			far.reference[variable] = 1e266;
		}
	}
	far.build();
	return far;
}

} // namespace

/// Links were put to each other with the roundings of such a state, which no answer accounts for, and spheres of bodies that
/// stand overflowed.
TEST( Hierarchy, ReferenceOfTheGroupChangesAnAnswer )
{
	SeededRng rng;
	uint64_t tests = 0;
	for ( int i = 0; i < 30; ++i )
	{
		World world = randomWorld( rng ), far = farReference( world );
		ASSERT_TRUE( far.checker != nullptr );
		if ( world.group.empty() )
		{
			continue; // no edges without variables
		}
		EXPECT_EQ(
		    lw_checker_get_info( world.checker.get() ).hierarchy, lw_checker_get_info( far.checker.get() ).hierarchy );
		for ( bool tables : { false, true } )
		{
			QueryPtr near_query =
			    tables ? makeQuery( world.checker.get() ) : makeQueryWithoutReach( world.checker.get(), false );
			QueryPtr far_query = tables ? makeQuery( far.checker.get() ) : makeQueryWithoutReach( far.checker.get(), false );
			for ( int k = 0; k < 10; ++k )
			{
				const State q = groupState( rng, world, 0 ), to = groupState( rng, world, 0 );
				lw_state_result want = ask( world, near_query.get(), q, nullptr ),
				                got = ask( far, far_query.get(), q, nullptr );
				expectSame( want.environment, got.environment, "environment" );
				expectSame( want.self, got.self, "self" );
				const lw_edge_def def = lw_edge_def_default();
				lw_edge_result edge, far_edge;
				ASSERT_EQ(
				    LW_OK, lw_checker_edge( world.checker.get(), near_query.get(), q.data(), to.data(), &def, &edge ) );
				ASSERT_EQ(
				    LW_OK, lw_checker_edge( far.checker.get(), far_query.get(), q.data(), to.data(), &def, &far_edge ) );
				EXPECT_EQ( edge.verdict, far_edge.verdict );
			}
			const lw_query_stats want = lw_query_get_stats( near_query.get() ), got = lw_query_get_stats( far_query.get() );
			EXPECT_EQ( want.robot_tests, got.robot_tests );
			EXPECT_EQ( want.queries, got.queries );
			tests += want.robot_tests;
		}
	}
	EXPECT_GT( tests, 0u );
}

/// The default state of a slider whose limits are absurd: spheres of standing bodies overflow, and by that all are near.
/// Lanes without a body were too, and read behind the array of bodies (seen by the address sanitizer).
TEST( Hierarchy, BodiesThatThereAreNotAreNear )
{
	RobotModel model;
	uint32_t root = model.link( "root" );
	lw_joint_def& slider = model.joint( "slider", LW_JOINT_PRISMATIC, root );
	slider.axis[0] = 1;
	slider.axis[1] = slider.axis[2] = 0;
	slider.lower = 1e266;
	slider.upper = 1e267;
	const double cube[3] = { 0.1, 0.1, 0.1 };
	for ( uint32_t i = 0; i < 5; ++i )
	{
		lw_shape* shape = nullptr;
		ASSERT_EQ( LW_OK, lw_shape_create_primitive( LW_SHAPE_BOX, cube, nullptr, nullptr, &shape ) );
		lw_transform at = lw_transform_identity();
		at.t[1] = 0.2 * i;
		model.body( i < 3 ? root : 1, shape, at );
	}
	World world;
	world.robot = model.create();
	world.reference = { 0 };
	world.group = { 0 };
	world.build();
	for ( bool warm : { false, true } )
	{
		QueryPtr query = makeQuery( world.checker.get(), warm );
		for ( double way : { 0.5, 0.3, 4.0 } )
		{
			EXPECT_NEAR( ask( world, query.get(), { way }, nullptr ).self.upper, std::hypot( way - 0.1, 0.1 ), 1e-9 );
			const lw_edge_def def = lw_edge_def_default();
			lw_edge_result edge;
			const double to = way + 0.01;
			ASSERT_EQ( LW_OK, lw_checker_edge( world.checker.get(), query.get(), &way, &to, &def, &edge ) );
			EXPECT_EQ( edge.verdict, LW_VERDICT_FREE );
		}
	}
}

TEST( Hierarchy, EdgeLowerBoundForgetsPairsThatNeedNoProof )
{
	World world = sliderWorld( -1, 1.5 );
	world.build();
	QueryPtr query = makeQuery( world.checker.get() ), plain = makeQueryWithoutReach( world.checker.get() );
	lw_edge_def edge = lw_edge_def_default();
	edge.flags = LW_CHECK_SELF;
	lw_edge_result got, want;
	const double from[2] = { 0, -1 }, to[2] = { 1.5, 1 };
	ASSERT_EQ( LW_OK, lw_checker_edge( world.checker.get(), query.get(), from, to, &edge, &got ) );
	ASSERT_EQ( LW_OK, lw_checker_edge( world.checker.get(), plain.get(), from, to, &edge, &want ) );
	EXPECT_EQ( got.verdict, LW_VERDICT_FREE );
	EXPECT_EQ( want.verdict, LW_VERDICT_FREE );
	EXPECT_GT( got.lower_bound, 0 );
	EXPECT_LE( got.lower_bound, 0.3 ) << "the true clearance at the end is 0.3";
	EXPECT_LT( got.queries, want.queries + 1 );
	edge.min_d = 0.31;
	ASSERT_EQ( LW_OK, lw_checker_edge( world.checker.get(), query.get(), from, to, &edge, &got ) );
	EXPECT_EQ( got.verdict, LW_VERDICT_BLOCKED );
}

TEST( Hierarchy, EdgeContradictsItsStates )
{
	SeededRng rng;
	int free = 0, blocked = 0, ruled_out = 0;
	for ( int i = 0; i < 40; ++i )
	{
		World world = randomWorld( rng );
		if ( world.group.empty() )
		{
			continue; // no edges without variables
		}
		ruled_out += lw_checker_get_info( world.checker.get() ).never_pairs > 0;
		QueryPtr query = makeQuery( world.checker.get() ), plain = makeQueryWithoutReach( world.checker.get() );
		for ( int k = 0; k < 6; ++k )
		{
			SCOPED_TRACE( ::testing::Message() << "world " << i << " edge " << k );
			State a = groupState( rng, world, 0 ), b = groupState( rng, world, k == 5 ? 0.5 : 0 );
			for ( std::size_t v = 0; k % 2 == 0 && v < a.size(); ++v )
			{
				b[v] = a[v] + 0.2 * ( b[v] - a[v] ); // short ones are free more often
			}
			lw_edge_def edge = lw_edge_def_default();
			edge.min_d = k % 3 == 0 ? 0.005 : 0;
			lw_edge_result got, want;
			ASSERT_EQ( LW_OK, lw_checker_edge( world.checker.get(), query.get(), a.data(), b.data(), &edge, &got ) );
			ASSERT_EQ( LW_OK, lw_checker_edge( world.checker.get(), plain.get(), a.data(), b.data(), &edge, &want ) );
			EXPECT_FALSE( got.verdict == LW_VERDICT_FREE && want.verdict == LW_VERDICT_BLOCKED );
			EXPECT_FALSE( got.verdict == LW_VERDICT_BLOCKED && want.verdict == LW_VERDICT_FREE );
			free += got.verdict == LW_VERDICT_FREE;
			blocked += got.verdict == LW_VERDICT_BLOCKED;
			State fa( lw_robot_variable_count( world.robot.get() ) ), fb = fa, ft = fa, q( a.size() );
			lw_checker_full_state( world.checker.get(), a.data(), fa.data() );
			lw_checker_full_state( world.checker.get(), b.data(), fb.data() );
			for ( int s = 0; s <= 40 && got.verdict == LW_VERDICT_FREE; ++s )
			{
				lw_robot_interpolate( world.robot.get(), fa.data(), fb.data(), s / 40.0, ft.data() );
				for ( std::size_t v = 0; v < q.size(); ++v )
				{
					q[v] = ft[world.group[v]];
				}
				lw_state_result state = ask( world, plain.get(), q, nullptr );
				EXPECT_GE( std::min( state.environment.upper, state.self.upper ), got.lower_bound - 1e-9 );
				EXPECT_EQ( state.verdict, LW_VERDICT_FREE );
			}
		}
	}
	EXPECT_GE( std::min( free, blocked ), 20 );
	EXPECT_GE( ruled_out, 10 );
}

// The paper's promise: a distant object costs one test, however many links it has.
TEST( Hierarchy, DistantArmIsPosed )
{
	SeededRng rng;
	World world;
	RobotModel model;
	uint32_t parent = model.link( "root" );
	for ( int i = 0; i < 12; ++i )
	{
		model.joint( "l" + std::to_string( i ), i % 7 == 3 ? LW_JOINT_FIXED : LW_JOINT_REVOLUTE, parent );
		model.joints.back().parent_from_joint.t[0] = 0.05;
		parent = model.joints.back().child;
		model.body( parent, randomMesh( rng, 10, 0.02, nullptr ), lw_transform_identity() );
	}
	world.robot = model.create();
	world.reach = makeReach( world.robot.get(), 0, 10 );
	world.reference = randomState( rng, world.robot.get() );
	for ( uint32_t i = 0; i < lw_robot_variable_count( world.robot.get() ); ++i )
	{
		world.group.push_back( i );
	}
	std::vector<ShapePtr> shapes;
	shapes.emplace_back( randomPrimitive( rng, 0.3, nullptr ) );
	const char* name = "far";
	lw_scene_shape_def placed = { shapes[0].get(), 0, lw_transform_identity() };
	placed.world_from_shape.t[1] = 10;
	lw_scene_def def = lw_scene_def_default();
	def.object_names = &name;
	def.object_count = 1;
	def.shapes = &placed;
	def.shape_count = 1;
	lw_scene* scene = nullptr;
	ASSERT_EQ( LW_OK, lw_scene_create( &def, nullptr, nullptr, &scene ) );
	world.scene.reset( scene );
	world.build();
	QueryPtr query = makeQuery( world.checker.get() );
	const lw_range range = { 0, 0.5, 0 };
	State q = groupState( rng, world, 0 );
	lw_state_result out;
	ASSERT_EQ(
	    LW_OK, lw_checker_state( world.checker.get(), query.get(), q.data(), LW_CHECK_ENVIRONMENT, &range, false, &out ) );
	EXPECT_EQ( out.environment.kind, LW_CLEARANCE_FAR );
	EXPECT_EQ( lw_query_get_stats( query.get() ).robot_tests, 1u );
	EXPECT_EQ( lw_query_get_stats( query.get() ).links_posed, 0u );

	lw_query_def without = lw_query_def_default(); // the switch must switch it off
	without.motion_hulls = false;
	lw_query* made = nullptr;
	ASSERT_EQ( LW_OK, lw_query_create( &without, nullptr, world.checker.get(), nullptr, &made ) );
	QueryPtr posing( made );
	ASSERT_EQ(
	    LW_OK, lw_checker_state( world.checker.get(), posing.get(), q.data(), LW_CHECK_ENVIRONMENT, &range, false, &out ) );
	EXPECT_EQ( out.environment.kind, LW_CLEARANCE_FAR );
	EXPECT_GT( lw_query_get_stats( posing.get() ).links_posed, 0u );
}

// Two links that tables prove apart, and spheres too: without tables their spheres are asked.
TEST( Hierarchy, TablesStayInUseWhenTheyAreLeftOut )
{
	World world = sliderWorld( -0.5, 0.5 );
	world.build();
	ASSERT_GT( lw_checker_get_info( world.checker.get() ).never_pairs, 0u );
	const lw_range contact = { 0, 5e-324, 0 };
	for ( const bool tables : { true, false } )
	{
		lw_query_def def = lw_query_def_default();
		def.pair_tables = tables;
		lw_query* made = nullptr;
		ASSERT_EQ( LW_OK, lw_query_create( &def, nullptr, world.checker.get(), nullptr, &made ) );
		QueryPtr query( made );
		EXPECT_EQ( ask( world, query.get(), { 0, 0 }, &contact ).verdict, LW_VERDICT_FREE );
		const uint64_t posed = lw_query_get_stats( query.get() ).links_posed;
		EXPECT_EQ( posed == 0, tables );
		lw_edge_def edge = lw_edge_def_default();
		edge.flags = LW_CHECK_SELF;
		lw_edge_result out;
		const State from = { -0.4, 0 }, to = { 0.4, 0.5 };
		ASSERT_EQ( LW_OK, lw_checker_edge( world.checker.get(), query.get(), from.data(), to.data(), &edge, &out ) );
		EXPECT_EQ( out.verdict, LW_VERDICT_FREE );
		EXPECT_EQ( out.lower_bound > 0.1, tables ) << out.lower_bound; // tables prove a metre
	}
}

TEST( Hierarchy, ReachOfAnotherRobotIsAccepted )
{
	World world = sliderWorld( -1, 1.5 ), twin = sliderWorld( -1, 1.5 ), other = sliderWorld( -1, 1.6 );
	lw_diag diag = {};
	std::swap( world.reach, other.reach );
	EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT, world.build( &diag ) );
	EXPECT_NE( std::string( diag.message ).find( "reach" ), std::string::npos ) << diag.message;
	world.reach = std::move( twin.reach ); // made from an equal robot, another object
	EXPECT_EQ( LW_OK, world.build( &diag ) ) << diag.message;
	EXPECT_TRUE( lw_checker_get_info( world.checker.get() ).hierarchy );
}

TEST( Hierarchy, ZeroQuaternionIsPosed )
{
	RobotModel model;
	uint32_t root = model.link( "root" );
	model.joint( "flyer", LW_JOINT_FLOATING, root );
	SeededRng rng;
	model.body( root, randomPrimitive( rng, 0.1, nullptr ), lw_transform_identity() );
	model.body( 1, randomPrimitive( rng, 0.1, nullptr ), lw_transform_identity() );
	World world;
	world.robot = model.create();
	world.reach = makeReach( world.robot.get(), 0 );
	world.reference = randomState( rng, world.robot.get() );
	world.group = { 0, 1, 2, 3, 4, 5, 6 };
	world.build();
	ASSERT_TRUE( lw_checker_get_info( world.checker.get() ).hierarchy );
	QueryPtr query = makeQuery( world.checker.get() );
	State q = { 1, 2, 3, 0, 0, 0, 0 };
	lw_state_result out;
	EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT,
	    lw_checker_state( world.checker.get(), query.get(), q.data(), LW_CHECK_BOTH, nullptr, false, &out ) );
	EXPECT_EQ( out.verdict, LW_VERDICT_UNKNOWN );
	q[6] = 1;
	EXPECT_EQ( LW_OK, lw_checker_state( world.checker.get(), query.get(), q.data(), LW_CHECK_BOTH, nullptr, false, &out ) );
	EXPECT_EQ( out.verdict, LW_VERDICT_FREE );
}

TEST( Hierarchy, FailedAllocationLeaks )
{
	SeededRng rng;
	World world = randomWorld( rng );
	bool done = false;
	for ( std::size_t at = 1; !done; ++at )
	{
		FailingAllocator memory;
		memory.fail_at = at;
		lw_diag diag = {};
		lw_status status = world.build( &diag, &memory.allocator );
		done = status == LW_OK;
		EXPECT_TRUE( done || status == LW_ERROR_OUT_OF_MEMORY ) << lw_status_name( status );
		world.checker.reset();
		EXPECT_EQ( memory.live, 0u ) << "allocation " << at;
	}
}

TEST( HierarchyThread, ThreadsShareMoreThanTheyShould )
{
	SeededRng rng;
	World world = randomWorld( rng );
	std::vector<State> states;
	std::vector<lw_state_result> want;
	QueryPtr plain = makeQueryWithoutReach( world.checker.get(), false );
	for ( int i = 0; i < 200; ++i )
	{
		states.push_back( groupState( rng, world, i % 5 == 0 ? 1 : 0 ) );
		want.push_back( ask( world, plain.get(), states.back(), nullptr ) );
	}
	std::atomic<int> wrong{ 0 };
	std::vector<std::thread> threads;
	for ( int t = 0; t < 4; ++t )
	{
		threads.emplace_back(
		    [&world, &states, &want, &wrong]
		    {
			    QueryPtr query = makeQuery( world.checker.get() );
			    for ( std::size_t i = 0; i < states.size(); ++i )
			    {
				    lw_state_result got;
				    lw_checker_state(
				        world.checker.get(), query.get(), states[i].data(), LW_CHECK_BOTH, nullptr, false, &got );
				    wrong += got.verdict != want[i].verdict || got.environment.kind != want[i].environment.kind ||
				             got.self.kind != want[i].self.kind;
			    }
		    } );
	}
	for ( std::thread& thread : threads )
	{
		thread.join();
	}
	EXPECT_EQ( wrong, 0 );
}
