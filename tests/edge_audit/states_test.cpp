// SPDX-License-Identifier: BSD-3-Clause
// Many states at once: looks and answers against one state at a time.
#include "checker_handles.hpp"
#include "one_joint.hpp"
#include "one_obstacle.hpp"
#include "random_world.hpp"
#include "same_bits.hpp"
#include "simple_shapes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace
{

const double inf = std::numeric_limits<double>::infinity();

/// States within and around the ranges of the group, and neighbours of these.
std::vector<double> randomStates( SeededRng& rng, const EdgeWorld& world, std::uint32_t count )
{
	const std::size_t n = world.variables.size();
	std::vector<double> out;
	for ( std::uint32_t i = 0; i < count; ++i )
	{
		const State full = randomState( rng, world.robot.get() );
		const bool near = i > 0 && rng.integer( 0, 1 );
		for ( std::size_t k = 0; k < n; ++k )
		{
			const double other = near ? out[out.size() - n] + 0.05 * rng.uniform( -1, 1 ) : full[world.variables[k]];
			out.push_back( rng.integer( 0, 30 ) > 0 ? other : other + rng.uniform( -1, 1 ) );
		}
	}
	return out;
}

struct Counts
{
	std::size_t free = 0, blocked = 0, undecided = 0;
	std::size_t partly = 0;      ///< undecided by one of the two tests only
	std::size_t passed_over = 0; ///< along a motion, since it is blocked before
};

/// States along a motion against LANES: equal up to the four that have the first BLOCKED state, open or equal from there on.
void compareAlong( const EdgeWorld& world, const std::vector<lw_verdict>& looks, const std::vector<lw_check_flags>& open,
    const std::vector<lw_verdict>& along, const std::vector<lw_check_flags>& open_along, lw_check_flags flags,
    Counts& counts )
{
	const std::size_t first =
	    static_cast<std::size_t>( std::find( looks.begin(), looks.end(), LW_VERDICT_BLOCKED ) - looks.begin() );
	bool ended = first == looks.size();
	for ( std::size_t i = 0; i < looks.size(); ++i )
	{
		const bool equal = along[i] == looks[i] && open_along[i] == open[i];
		const bool passed_over = along[i] == LW_VERDICT_UNDECIDED && open_along[i] == flags;
		EXPECT_TRUE( equal || ( i >= first / 4 * 4 && passed_over ) )
		    << world.name << ", state " << i << ", first " << first;
		ended = ended || ( i / 4 == first / 4 && along[i] == LW_VERDICT_BLOCKED );
		counts.passed_over += !equal;
	}
	EXPECT_TRUE( ended ) << world.name << ": no state says that the motion is blocked";
}

/// Every answer for these states against that for one state.
void compare( const EdgeWorld& world, const lw_checker* checker, const std::vector<double>& q, double min_d,
    lw_check_flags flags, Counts& counts )
{
	const std::size_t n = world.variables.size();
	const auto count = static_cast<std::uint32_t>( q.size() / n );
	const QueryPtr many = makeQuery( checker ), single = makeQuery( checker );
	std::vector<lw_verdict> looks( count ), contacts( count ), full( count ), along( count );
	std::vector<lw_check_flags> open( count ), left( count ), open_along( count );
	ASSERT_EQ( LW_OK, lw_checker_states(
	                      checker, many.get(), q.data(), count, flags, min_d, LW_STATES_LANES, looks.data(), open.data() ) );
	ASSERT_EQ( LW_OK, lw_checker_states( checker, many.get(), q.data(), count, flags, min_d, LW_STATES_CONTACT,
	                      contacts.data(), nullptr ) );
	ASSERT_EQ( LW_OK,
	    lw_checker_states( checker, many.get(), q.data(), count, flags, min_d, LW_STATES_FULL, full.data(), left.data() ) );
	ASSERT_EQ( LW_OK, lw_checker_states( checker, many.get(), q.data(), count, flags, min_d, LW_STATES_ALONG, along.data(),
	                      open_along.data() ) );
	compareAlong( world, looks, open, along, open_along, flags, counts );
	for ( std::uint32_t i = 0; i < count; ++i )
	{
		const double* state = q.data() + i * n;
		bool is_free = false;
		lw_state_result exact;
		ASSERT_EQ( LW_OK, lw_checker_is_free( checker, single.get(), state, flags, min_d, &is_free, nullptr ) );
		ASSERT_EQ( LW_OK, lw_checker_state( checker, single.get(), state, flags, nullptr, false, &exact ) );
		const double least =
		    std::min( exact.environment.upper, exact.self.kind == LW_CLEARANCE_UNKNOWN ? inf : exact.self.upper );
		EXPECT_EQ( is_free, full[i] == LW_VERDICT_FREE ) << world.name << ", state " << i;
		EXPECT_EQ( left[i] != 0, full[i] == LW_VERDICT_UNDECIDED ) << world.name << ", state " << i;
		EXPECT_TRUE( looks[i] != LW_VERDICT_FREE || is_free ) << world.name << ", state " << i;
		EXPECT_TRUE( looks[i] != LW_VERDICT_BLOCKED || least <= 0 ) << world.name << ", state " << i << ": " << least;
		EXPECT_NE( LW_VERDICT_FREE, contacts[i] );
		EXPECT_TRUE( contacts[i] != LW_VERDICT_BLOCKED || least <= 0 ) << world.name << ", state " << i << ": " << least;
		bool passes = looks[i] == LW_VERDICT_FREE;
		if ( looks[i] == LW_VERDICT_UNDECIDED )
		{
			ASSERT_EQ( LW_OK, lw_checker_is_free( checker, single.get(), state, open[i], min_d, &passes, nullptr ) );
			counts.partly += open[i] != flags;
		}
		EXPECT_EQ( looks[i] == LW_VERDICT_UNDECIDED, open[i] != 0 ) << world.name << ", state " << i;
		EXPECT_EQ( is_free, passes ) << world.name << ", state " << i << ": tests that remain " << open[i];
		counts.free += looks[i] == LW_VERDICT_FREE;
		counts.blocked += looks[i] == LW_VERDICT_BLOCKED;
		counts.undecided += looks[i] == LW_VERDICT_UNDECIDED;
	}
}

/// A slider along x with a body, beside a fixed obstacle.
struct Slider : OneJoint
{
	Slider( lw_shape* body, lw_shape* obstacle, const lw_transform& at )
	{
		const double x[3] = { 1, 0, 0 };
		lw_diag diag = {};
		EXPECT_EQ( LW_OK, makeRobot( body, lw_transform_identity(), LW_JOINT_PRISMATIC, x, 4, &diag ) ) << diag.message;
		makeChecker( obstacle, at );
		lw_shape_release( body );
		lw_shape_release( obstacle );
	}
	lw_verdict look( double x, double min_d = 0, lw_check_flags flags = LW_CHECK_BOTH ) const
	{
		const QueryPtr query = makeQuery( checker );
		lw_verdict out = LW_VERDICT_UNKNOWN;
		EXPECT_EQ( LW_OK, lw_checker_states( checker, query.get(), &x, 1, flags, min_d, LW_STATES_LANES, &out, nullptr ) );
		return out;
	}
};

lw_transform shifted( double x, double y = 0, double z = 0 )
{
	lw_transform t = lw_transform_identity();
	t.t[0] = x;
	t.t[1] = y;
	t.t[2] = z;
	return t;
}

/// A cube of half size h about the origin.
lw_shape* cube( double h, bool solid )
{
	std::vector<double> v;
	for ( int i = 0; i < 8; ++i )
	{
		v.insert( v.end(), { i & 1 ? h : -h, i & 2 ? h : -h, i & 4 ? h : -h } );
	}
	const std::vector<std::uint32_t> f = {
	    0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5 };
	lw_mesh_def def = lw_mesh_def_default();
	def.vertices = v.data();
	def.vertex_count = 8;
	def.indices = f.data();
	def.triangle_count = 12;
	def.solid = solid;
	lw_shape* shape = nullptr;
	lw_diag diag = {};
	EXPECT_EQ( LW_OK, lw_shape_create_mesh( &def, nullptr, &diag, &shape ) ) << diag.message;
	return shape;
}

/// A body that reaches from -0.1 to 0.1 along x: a primitive, or the mesh of a cube.
lw_shape* slidingBody( int kind )
{
	switch ( kind )
	{
	case 0:
		return primitive( LW_SHAPE_BOX, 0.2, 0.15, 0.1 );
	case 1:
		return primitive( LW_SHAPE_CYLINDER, 0.1, 0.12 );
	case 2:
		return primitive( LW_SHAPE_CONE, 0.1, 0.12 );
	case 3:
		return primitive( LW_SHAPE_SPHERE, 0.1 );
	default:
		return cube( 0.1, kind == 4 );
	}
}

} // namespace

TEST( States, AnswersDifferFromThoseOfSingleStates )
{
	SeededRng rng;
	Counts counts;
	for ( int i = 0; i < 150; ++i )
	{
		RandomWorldOptions options;
		options.margins = rng.integer( 0, 2 ) == 0;
		const auto seed = static_cast<std::uint64_t>( rng.integer( 0, 1 << 30 ) );
		const EdgeWorld world = randomWorld( seed, options );
		for ( const lw_checker* checker : { world.checker.get(), world.with_tables.get() } )
		{
			const auto flags = static_cast<lw_check_flags>( rng.integer( 1, 3 ) );
			const double min_d = rng.integer( 0, 1 ) ? 0 : rng.decade( -4, -1 );
			const std::vector<double> q = randomStates( rng, world, static_cast<std::uint32_t>( rng.integer( 1, 27 ) ) );
			compare( world, checker, q, min_d, flags, counts );
		}
	}
	std::printf( "free %zu, blocked %zu, undecided %zu, by one test %zu, passed over %zu\n", counts.free, counts.blocked,
	    counts.undecided, counts.partly, counts.passed_over );
	EXPECT_GT( counts.free, counts.undecided / 8 );
	EXPECT_GT( counts.blocked, 5u );
	EXPECT_GT( counts.partly, counts.undecided / 20 );
}

TEST( States, ContactIsFreeOrARoomOfMicrometresBlocked )
{
	SeededRng rng;
	std::array<std::size_t, 4> seen{};
	for ( int i = 0; i < 20000; ++i )
	{
		const int kind = rng.integer( 0, 2 );
		const double gap = ( rng.integer( 0, 1 ) ? 1 : -1 ) * rng.decade( -9, -1 );
		lw_shape* obstacle = kind == 0   ? primitive( LW_SHAPE_BOX, 0.4, 0.5, 0.6 )
		                     : kind == 1 ? primitive( LW_SHAPE_CYLINDER, 0.2, 0.7 )
		                                 : primitive( LW_SHAPE_HALFSPACE, 0 );
		lw_transform at = lw_transform_identity();
		at.t[0] = rng.uniform( -1, 1 );
		const double face = at.t[0] + ( kind == 2 ? 0 : 0.2 );
		if ( kind == 2 ) // its normal is x
		{
			const double r[3][3] = { { 0, 0, 1 }, { 0, 1, 0 }, { -1, 0, 0 } };
			std::copy( &r[0][0], &r[0][0] + 9, &at.r[0][0] );
		}
		const int body = rng.integer( 0, 5 );
		SCOPED_TRACE( "body " + std::to_string( body ) );
		const Slider slider( slidingBody( body ), obstacle, at );
		const lw_verdict verdict = slider.look( face + 0.1 + gap );
		seen[verdict]++;
		EXPECT_TRUE( gap > 0 || verdict != LW_VERDICT_FREE ) << gap << ", obstacle " << kind;
		EXPECT_TRUE( gap < 0 || verdict != LW_VERDICT_BLOCKED ) << gap << ", obstacle " << kind;
		const bool by_sphere = kind == 2 && body < 3; // a primitive against a half-space
		EXPECT_TRUE( gap < ( by_sphere ? 0.1 : 1e-3 ) || verdict == LW_VERDICT_FREE ) << gap << ", obstacle " << kind;
		EXPECT_TRUE( gap > -1e-4 || kind > 0 || verdict == LW_VERDICT_BLOCKED ) << gap << ", a box";
	}
	EXPECT_GT( seen[LW_VERDICT_FREE], 1000u );
	EXPECT_GT( seen[LW_VERDICT_BLOCKED], 1000u );
}

TEST( States, CollisionsAtAMiddleOfTheGateTakeManyStates )
{
	// at 5/16 of the edge, where no halving comes early; the body is long, so that its sphere is near for half of the edge
	const Slider slider(
	    primitive( LW_SHAPE_BOX, 0.04, 0.04, 1 ), primitive( LW_SHAPE_BOX, 0.06, 0.3, 1.2 ), shifted( -0.375 ) );
	const QueryPtr query = makeQuery( slider.checker );
	const lw_edge_def def = lw_edge_def_default();
	const double a = -1, b = 1;
	lw_edge_result edge;
	ASSERT_EQ( LW_OK, lw_checker_edge( slider.checker, query.get(), &a, &b, &def, &edge ) );
	EXPECT_EQ( LW_VERDICT_BLOCKED, edge.verdict );
	EXPECT_NEAR( 5 / 16.0, edge.t, 1e-12 );
	EXPECT_LE( edge.queries, 4u ) << "ends and middle, for bounds of the motion, and the collision";
}

TEST( States, MarginIsForgotten )
{
	const Slider slider( cube( 0.1, false ), primitive( LW_SHAPE_BOX, 0.2, 0.3, 0.3 ), shifted( 0 ) );
	EXPECT_EQ( LW_VERDICT_FREE, slider.look( 0.3, 0.05 ) );
	EXPECT_NE( LW_VERDICT_FREE, slider.look( 0.3, 0.15 ) );
	EXPECT_EQ( LW_VERDICT_BLOCKED, slider.look( 0.15 ) );
}

TEST( States, MarginOfAPairIsForgotten )
{
	// two cubes on rails of their own, and a box 5 cm before the first
	RobotModel model;
	model.link( "base" );
	for ( const char* name : { "left", "right" } )
	{
		lw_joint_def& joint = model.joint( name, LW_JOINT_PRISMATIC, 0 );
		joint.axis[0] = 1;
		joint.axis[2] = 0;
		model.body( joint.child, cube( 0.1, false ), lw_transform_identity() );
	}
	const RobotPtr robot = model.create();
	const ShapePtr box( primitive( LW_SHAPE_BOX, 0.2, 0.3, 0.3 ) );
	const leeway::Scene scene = oneObstacle( box.get(), shifted( -0.25 ) );
	for ( const double margin : { 0.03, 0.07, 0.19, 0.21 } )
	{
		const leeway::Checker checker = checkerOf( robot.get(), scene.get(), margin );
		const QueryPtr query = makeQuery( checker.get() );
		for ( const lw_check_flags flags : { LW_CHECK_ENVIRONMENT, LW_CHECK_SELF } )
		{
			const double q[2] = { 0, 0.4 }; // spheres 5.4 cm apart, boxes 20 cm
			lw_verdict verdict;
			ASSERT_EQ(
			    LW_OK, lw_checker_states( checker.get(), query.get(), q, 1, flags, 0, LW_STATES_LANES, &verdict, nullptr ) );
			const double apart = flags == LW_CHECK_SELF ? 0.2 : 0.05;
			EXPECT_EQ( margin < apart, verdict == LW_VERDICT_FREE ) << margin << ", flags " << flags;
		}
	}
}

TEST( States, ObstacleInsideOfASolidLinkIsFree )
{
	const Slider solid( cube( 0.5, true ), primitive( LW_SHAPE_BOX, 0.1, 0.1, 0.1 ), shifted( 0 ) );
	EXPECT_NE( LW_VERDICT_FREE, solid.look( 0 ) );
	const Slider hollow( cube( 0.5, false ), primitive( LW_SHAPE_BOX, 0.1, 0.1, 0.1 ), shifted( 0 ) );
	EXPECT_EQ( LW_VERDICT_FREE, hollow.look( 0 ) );
}

TEST( States, LinkInsideOfASolidObstacleIsFree )
{
	for ( const lw_shape_type type : { LW_SHAPE_BOX, LW_SHAPE_CYLINDER } )
	{
		const Slider inside( cube( 0.1, false ), primitive( type, 2, 2, 2 ), shifted( 0 ) );
		EXPECT_EQ( LW_VERDICT_BLOCKED, inside.look( 0 ) );
	}
}

/// All its vertices are at the height of its middle, which is none of them.
TEST( States, HoleOfAFlatRingIsContact )
{
	constexpr std::uint32_t SIDES = 1200; // more vertices than are searched without the tree
	std::vector<double> vertices;
	std::vector<std::uint32_t> indices;
	for ( std::uint32_t i = 0; i < SIDES; ++i )
	{
		const double angle = 2 * std::acos( -1.0 ) * i / SIDES, y = std::cos( angle ), z = std::sin( angle );
		vertices.insert( vertices.end(), { 0, 0.9 * y, 0.9 * z, 0, y, z } );
		const std::uint32_t in = 2 * i, next = 2 * ( ( i + 1 ) % SIDES );
		indices.insert( indices.end(), { in, in + 1, next, in + 1, next + 1, next } );
	}
	const Slider slider( meshOf( vertices, indices ), primitive( LW_SHAPE_BOX, 0.2, 1.2, 1.2 ), shifted( 0 ) );
	EXPECT_NE( LW_VERDICT_BLOCKED, slider.look( 0 ) );
}

TEST( States, VertexOfNoTriangleIsContact )
{
	const Slider slider( meshOf( { 0, 0, 0, 0, 0.1, 0, 0, 0, 0.1, 3, 0, 0 }, { 0, 1, 2 } ),
	    primitive( LW_SHAPE_BOX, 0.2, 0.2, 0.2 ), shifted( 3 ) );
	EXPECT_EQ( LW_VERDICT_FREE, slider.look( 0 ) );
	EXPECT_EQ( LW_VERDICT_BLOCKED, slider.look( 3 ) );
}

TEST( States, StatesBeforeABlockedOneAreLost )
{
	const Slider slider( cube( 0.1, false ), primitive( LW_SHAPE_BOX, 0.4, 0.4, 0.4 ), shifted( 0 ) );
	const QueryPtr query = makeQuery( slider.checker );
	for ( std::uint32_t blocked = 0; blocked < 20; ++blocked )
	{
		double q[20];
		std::fill_n( q, 20, 1.0 );
		q[blocked] = 0;
		lw_verdict along[20];
		lw_check_flags open[20];
		ASSERT_EQ(
		    LW_OK, lw_checker_states( slider.checker, query.get(), q, 20, LW_CHECK_BOTH, 0, LW_STATES_ALONG, along, open ) );
		for ( std::uint32_t i = 0; i < 20; ++i )
		{
			const lw_verdict other = i < blocked / 4 * 4 ? LW_VERDICT_FREE : LW_VERDICT_UNDECIDED;
			EXPECT_EQ( i == blocked ? LW_VERDICT_BLOCKED : other, along[i] ) << i << " of those with " << blocked;
			EXPECT_EQ( along[i] == LW_VERDICT_UNDECIDED ? LW_CHECK_BOTH : 0, open[i] ) << i << " of those with " << blocked;
		}
	}
}

TEST( States, BadStatesReadAsFree )
{
	const Slider slider( cube( 0.1, false ), primitive( LW_SHAPE_BOX, 0.2, 0.2, 0.2 ), shifted( 0 ) );
	const QueryPtr query = makeQuery( slider.checker );
	const double nan = std::numeric_limits<double>::quiet_NaN();
	for ( const double bad : { nan, inf, -inf } )
	{
		const double q[3] = { 1, bad, 1 };
		lw_verdict verdicts[3] = { LW_VERDICT_FREE, LW_VERDICT_FREE, LW_VERDICT_FREE };
		EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT,
		    lw_checker_states( slider.checker, query.get(), q, 3, LW_CHECK_BOTH, 0, LW_STATES_LANES, verdicts, nullptr ) );
		lw_verdict full[3] = { LW_VERDICT_FREE, LW_VERDICT_FREE, LW_VERDICT_FREE };
		EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT,
		    lw_checker_states( slider.checker, query.get(), q, 3, LW_CHECK_BOTH, 0, LW_STATES_FULL, full, nullptr ) );
		for ( int i = 0; i < 3; ++i )
		{
			EXPECT_EQ( LW_VERDICT_UNKNOWN, verdicts[i] );
			EXPECT_EQ( LW_VERDICT_UNKNOWN, full[i] );
		}
	}
	const double q[1] = { 1e13 }; // its place rounds by millimetres
	EXPECT_EQ( LW_VERDICT_UNDECIDED, slider.look( q[0] ) );
	const auto states = [&]( const lw_checker* checker, lw_query* with, std::uint32_t count, lw_check_flags flags,
	                        double min_d, int effort, lw_verdict* out )
	{
		const double one = 1;
		return lw_checker_states(
		    checker, with, &one, count, flags, min_d, static_cast<lw_states_effort>( effort ), out, nullptr );
	};
	lw_verdict out = LW_VERDICT_FREE;
	EXPECT_EQ( LW_OK, states( slider.checker, query.get(), 0, LW_CHECK_BOTH, 0, LW_STATES_FULL, nullptr ) );
	const lw_status bad_argument = LW_ERROR_INVALID_ARGUMENT;
	EXPECT_EQ( bad_argument, states( slider.checker, query.get(), 1, LW_CHECK_BOTH, 0, LW_STATES_FULL, nullptr ) );
	EXPECT_EQ( bad_argument, states( slider.checker, query.get(), 1, LW_CHECK_BOTH, 0, 0, &out ) );
	EXPECT_EQ( bad_argument, states( slider.checker, query.get(), 1, LW_CHECK_BOTH, 0, LW_STATES_ALONG + 1, &out ) );
	for ( const double bad : { nan, -1.0, inf } )
	{
		out = LW_VERDICT_FREE;
		EXPECT_EQ( bad_argument, states( slider.checker, query.get(), 1, LW_CHECK_BOTH, bad, LW_STATES_FULL, &out ) );
		EXPECT_EQ( LW_VERDICT_UNKNOWN, out );
	}
	EXPECT_EQ(
	    bad_argument, states( slider.checker, query.get(), 1, static_cast<lw_check_flags>( 0 ), 0, LW_STATES_FULL, &out ) );
	EXPECT_EQ( bad_argument, states( nullptr, query.get(), 1, LW_CHECK_BOTH, 0, LW_STATES_FULL, &out ) );
	EXPECT_EQ( bad_argument, states( slider.checker, nullptr, 1, LW_CHECK_BOTH, 0, LW_STATES_FULL, &out ) );
	EXPECT_EQ( LW_VERDICT_UNKNOWN, out );
}

TEST( States, BaseInContactIsForgotten )
{
	// the base stands within 1 cm of the scene; the slider is far away
	RobotModel model;
	model.link( "base" );
	model.body( 0, cube( 0.1, false ), lw_transform_identity() );
	model.joint( "arm", LW_JOINT_PRISMATIC, 0 );
	model.body( 1, cube( 0.1, false ), shifted( 0, 5 ) );
	const RobotPtr robot = model.create();
	const ShapePtr box( primitive( LW_SHAPE_BOX, 0.2, 0.2, 0.2 ) );
	const leeway::Scene scene = oneObstacle( box.get(), shifted( 0.21 ) );
	const leeway::Checker checker = checkerOf( robot.get(), scene.get() );
	const QueryPtr query = makeQuery( checker.get() );
	const double q = 0.5;
	lw_verdict verdict;
	ASSERT_EQ( LW_OK,
	    lw_checker_states( checker.get(), query.get(), &q, 1, LW_CHECK_BOTH, 0.005, LW_STATES_LANES, &verdict, nullptr ) );
	EXPECT_EQ( LW_VERDICT_FREE, verdict );
	ASSERT_EQ( LW_OK,
	    lw_checker_states( checker.get(), query.get(), &q, 1, LW_CHECK_BOTH, 0.02, LW_STATES_LANES, &verdict, nullptr ) );
	EXPECT_NE( LW_VERDICT_FREE, verdict );
}

TEST( States, LooksLeaveTraces )
{
	SeededRng rng;
	for ( int i = 0; i < 30; ++i )
	{
		const EdgeWorld world = randomWorld( static_cast<std::uint64_t>( rng.integer( 0, 1 << 30 ) ) );
		const lw_checker* checker = world.with_tables.get();
		const QueryPtr looked = makeQuery( checker, false ), fresh = makeQuery( checker, false );
		const std::size_t n = world.variables.size();
		const std::vector<double> q = randomStates( rng, world, 16 );
		std::vector<lw_verdict> verdicts( 16 );
		for ( std::uint32_t k = 0; k < 16; ++k )
		{
			lw_state_result a, b;
			ASSERT_EQ( LW_OK, lw_checker_states( checker, looked.get(), q.data(), 16, LW_CHECK_BOTH, 0,
			                      k % 2 != 0 ? LW_STATES_CONTACT : LW_STATES_LANES, verdicts.data(), nullptr ) );
			ASSERT_EQ(
			    LW_OK, lw_checker_state( checker, looked.get(), q.data() + k * n, LW_CHECK_BOTH, nullptr, false, &a ) );
			ASSERT_EQ(
			    LW_OK, lw_checker_state( checker, fresh.get(), q.data() + k * n, LW_CHECK_BOTH, nullptr, false, &b ) );
			EXPECT_TRUE( sameBits( a.environment.lower, b.environment.lower ) &&
			             sameBits( a.environment.upper, b.environment.upper ) && sameBits( a.self.lower, b.self.lower ) &&
			             sameBits( a.self.upper, b.self.upper ) )
			    << world.name << ", state " << k;
		}
	}
}
