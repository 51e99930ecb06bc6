// SPDX-License-Identifier: BSD-3-Clause
// State spaces of groups: layout, bounds, the curve that OMPL draws against the one that the core proves, and
// requests that are refused.
#include "world.hpp"

#include <ompl/base/Constraint.h>
#include <ompl/base/ConstrainedSpaceInformation.h>
#include <ompl/base/spaces/DiscreteStateSpace.h>
#include <ompl/base/spaces/DubinsStateSpace.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/base/spaces/SE2StateSpace.h>
#include <ompl/base/spaces/SE3StateSpace.h>
#include <ompl/base/spaces/WrapperStateSpace.h>
#include <ompl/base/spaces/constraint/ProjectedStateSpace.h>

#include <functional>

namespace
{

/// Distance of the robot at two group states: the largest difference of any entry of any link's pose.
double poseDifference( const Rig& rig, const double* a, const double* b )
{
	const lw_checker* checker = rig.checker.get();
	const lw_robot* robot = lw_checker_robot( checker );
	std::vector<double> full( lw_robot_variable_count( robot ) );
	std::vector<lw_transform> links_a( lw_robot_link_count( robot ) ), links_b( links_a.size() );
	lw_checker_full_state( checker, a, full.data() );
	leeway::require( lw_robot_fk( robot, full.data(), links_a.data() ), "fk" );
	lw_checker_full_state( checker, b, full.data() );
	leeway::require( lw_robot_fk( robot, full.data(), links_b.data() ), "fk" );
	double worst = 0;
	for ( std::size_t i = 0; i < links_a.size(); ++i )
	{
		for ( int row = 0; row < 3; ++row )
		{
			worst = std::max( worst, std::fabs( links_a[i].t[row] - links_b[i].t[row] ) );
			for ( int column = 0; column < 3; ++column )
			{
				worst = std::max( worst, std::fabs( links_a[i].r[row][column] - links_b[i].r[row][column] ) );
			}
		}
	}
	return worst;
}

/// lw_robot_interpolate on group states.
std::vector<double> coreInterpolate( const Rig& rig, const std::vector<double>& a, const std::vector<double>& b, double t )
{
	const lw_checker* checker = rig.checker.get();
	const lw_robot* robot = lw_checker_robot( checker );
	std::vector<double> full_a( lw_robot_variable_count( robot ) ), full_b( full_a.size() ), group( a.size() );
	lw_checker_full_state( checker, a.data(), full_a.data() );
	lw_checker_full_state( checker, b.data(), full_b.data() );
	lw_robot_interpolate( robot, full_a.data(), full_b.data(), t, full_a.data() );
	for ( std::uint32_t i = 0; i < group.size(); ++i )
	{
		group[i] = full_a[lw_checker_variable( checker, i )];
	}
	return group;
}

class Spaces : public testing::TestWithParam<World>
{
};

TEST_P( Spaces, StatesSurviveTheRoundTrip )
{
	SeededRng rng;
	const Rig rig( GetParam().make() );
	const leeway::ompl::StateAdapter& adapter = rig.engine->adapter();
	ASSERT_EQ( adapter.size(), lw_checker_variable_count( rig.checker.get() ) );
	rig.space->sanityChecks();
	const ob::StateSamplerPtr sampler = rig.space->allocStateSampler();
	ob::ScopedState<> state( rig.space ), again( rig.space );
	for ( int i = 0; i < 200; ++i )
	{
		sampler->sampleUniform( state.get() );
		const std::vector<double> q = rig.vector( state.get() );
		adapter.fromVector( q.data(), again.get() );
		ASSERT_EQ( q, rig.vector( again.get() ) );
		std::vector<double> reals;
		rig.space->copyToReals( reals, state.get() );
		ASSERT_EQ( q, reals ) << "entries out of order";

		// whole turns more or less are the same state, and in bounds once written
		std::vector<double> turned = q;
		for ( std::uint32_t k = 0; k < q.size(); ++k )
		{
			const bool wraps = lw_robot_variable( lw_checker_robot( rig.checker.get() ), k ).wraps;
			turned[k] += wraps ? 2 * pi * rng.integer( -2, 2 ) : 0;
		}
		adapter.fromVector( turned.data(), again.get() );
		ASSERT_TRUE( rig.space->satisfiesBounds( again.get() ) );
		ASSERT_LT( poseDifference( rig, rig.vector( again.get() ).data(), q.data() ), 1e-12 );
	}
}

TEST_P( Spaces, OmplInterpolatesAlongTheEdgesThatAreProved )
{
	SeededRng rng;
	const Rig rig( GetParam().make() );
	ob::ScopedState<> s1( rig.space ), s2( rig.space ), between( rig.space );
	ASSERT_TRUE( rig.engine->adapter().straight() ) << rig.engine->adapter().curveProblem();
	for ( int i = 0; i < 1000; ++i )
	{
		rig.sample( rng, s1.get() );
		rig.sample( rng, s2.get() );
		const double t = rng.uniform( 0, 1 );
		rig.space->interpolate( s1.get(), s2.get(), t, between.get() );
		const std::vector<double> a = rig.vector( s1.get() ), b = rig.vector( s2.get() ), ompl = rig.vector( between.get() );
		const std::vector<double> core = coreInterpolate( rig, a, b, t );
		ASSERT_LT( poseDifference( rig, ompl.data(), core.data() ), 1e-7 ) << "t = " << t;
		std::vector<double> adapter( a.size() );
		rig.engine->adapter().interpolate( a.data(), b.data(), t, adapter.data() );
		ASSERT_LT( poseDifference( rig, ompl.data(), adapter.data() ), 1e-12 ) << "t = " << t;
		ASSERT_EQ( rig.engine->adapter().pieceCount( a.data(), b.data() ), 1u ) << "pieces cost queries";
	}
}

TEST_P( Spaces, WrappedSpacesAreSeenThrough )
{
	SeededRng rng;
	const leeway::Checker checker = GetParam().make();
	const Rig plain( checker );
	const Rig wrapped( checker, {}, std::make_shared<ob::WrapperStateSpace>( leeway::ompl::makeStateSpace( checker ) ) );
	ob::ScopedState<> p1( plain.space ), p2( plain.space ), w1( wrapped.space ), w2( wrapped.space ), last( wrapped.space );
	for ( int i = 0; i < 100; ++i )
	{
		plain.sampleValid( rng, p1.get() );
		plain.sample( rng, p2.get() );
		wrapped.engine->adapter().fromVector( plain.vector( p1.get() ).data(), w1.get() );
		wrapped.engine->adapter().fromVector( plain.vector( p2.get() ).data(), w2.get() );
		ASSERT_EQ( plain.vector( p2.get() ), wrapped.vector( w2.get() ) );
		ASSERT_EQ( plain.si->isValid( p2.get() ), wrapped.si->isValid( w2.get() ) );
		std::pair<ob::State*, double> last_valid( last.get(), 1 );
		ASSERT_EQ( plain.si->checkMotion( p1.get(), p2.get() ), wrapped.si->checkMotion( w1.get(), w2.get(), last_valid ) );
		ASSERT_TRUE( last_valid.second == 1 || wrapped.si->isValid( last.get() ) );
	}
}

INSTANTIATE_TEST_SUITE_P( Worlds, Spaces, testing::ValuesIn( worlds() ),
    []( const testing::TestParamInfo<World>& world ) { return std::string( world.param.name ); } );

TEST( SpaceLayout, EachJointGetsItsOwnKindOfSpace )
{
	const auto gantry = leeway::ompl::makeStateSpace( gantryWorld() );
	ASSERT_EQ( gantry->getType(), ob::STATE_SPACE_REAL_VECTOR );
	EXPECT_EQ( gantry->as<ob::RealVectorStateSpace>()->getDimensionName( 1 ), "rail y" );
	EXPECT_EQ( gantry->as<ob::RealVectorStateSpace>()->getBounds().low[1], -1 );
	const auto carrier = leeway::ompl::makeStateSpace( carrierWorld() );
	const auto* compound = carrier->as<ob::CompoundStateSpace>();
	ASSERT_EQ( compound->getSubspaceCount(), 3u );
	EXPECT_EQ( compound->getSubspace( "drive" )->getType(), ob::STATE_SPACE_SE2 );
	EXPECT_EQ( compound->getSubspace( "mast" )->getType(), ob::STATE_SPACE_SO2 );
	EXPECT_EQ( compound->getSubspace( "slide" )->getType(), ob::STATE_SPACE_REAL_VECTOR );
	EXPECT_EQ( compound->getSubspaceWeight( "mast" ), 1 );
	EXPECT_TRUE( compound->isLocked() );
	const auto drone = leeway::ompl::makeStateSpace( droneWorld() );
	EXPECT_EQ( drone->as<ob::CompoundStateSpace>()->getSubspace( "fly" )->getType(), ob::STATE_SPACE_SE3 );
	for ( const auto& space : { gantry, carrier, drone } )
	{
		space->setup();
		EXPECT_TRUE( space->hasDefaultProjection() );
	}
}

TEST( SpaceLayout, GroupOrderIsKept )
{
	const leeway::Checker checker =
	    makeChecker( { slider( "first", 0, 0, 1 ), slider( "second", 1, 2, 3, makeBall( 0.1 ) ) }, {}, { 1, 0 } );
	const Rig rig( checker );
	EXPECT_EQ( rig.space->as<ob::RealVectorStateSpace>()->getDimensionName( 0 ), "second" );
	EXPECT_EQ( rig.space->as<ob::RealVectorStateSpace>()->getBounds().low[0], 2 );
}

TEST( SpaceLayout, LockedJointsDoNotStopPlanning )
{
	// alone in a subspace of its own, where OMPL would find no extent
	for ( lw_joint_type first : { LW_JOINT_CONTINUOUS, LW_JOINT_REVOLUTE } )
	{
		const Rig rig(
		    makeChecker( { hinge( "turn", first, 0, 0.4, -1, 1 ), hinge( "locked", LW_JOINT_REVOLUTE, 0.4, 0.3, 0.5, 0.5 ) },
		        { { makeBall( 0.1 ), at( -0.5, 0, 0 ) } } ) );
		const double from[2] = { -0.9, 0.5 }, to[2] = { 0.9, 0.5 }, moved[2] = { 0, 0.6 };
		ob::ScopedState<> s1( rig.space ), s2( rig.space );
		rig.engine->adapter().fromVector( from, s1.get() );
		rig.engine->adapter().fromVector( to, s2.get() );
		EXPECT_TRUE( rig.si->isValid( s1.get() ) );
		EXPECT_TRUE( rig.si->checkMotion( s1.get(), s2.get() ) );
		rig.engine->adapter().fromVector( moved, s2.get() );
		EXPECT_FALSE( rig.si->isValid( s2.get() ) );
	}
}

TEST( SpaceLayout, UnlimitedPositionsGetTheGivenBounds )
{
	const leeway::Checker checker = makeChecker( { slider( "rail", 0, -inf, inf, makeBall( 0.1 ) ) }, {} );
	const auto bounds = []( const ob::StateSpacePtr& space ) { return space->as<ob::RealVectorStateSpace>()->getBounds(); };
	EXPECT_EQ( bounds( leeway::ompl::makeStateSpace( checker ) ).high[0], 10 );
	EXPECT_EQ( bounds( leeway::ompl::makeStateSpace( checker, 3 ) ).low[0], -3 );
	for ( double wrong : { 0.0, -1.0, inf, nan_value } )
	{
		EXPECT_THROW( leeway::ompl::makeStateSpace( checker, wrong ), std::invalid_argument ) << wrong;
	}
	const leeway::Checker beyond = makeChecker( { slider( "far rail", 0, 20, inf, makeBall( 0.1 ) ) }, {} );
	try
	{
		leeway::ompl::makeStateSpace( beyond );
		FAIL() << "a joint from 20 to 10";
	}
	catch ( const std::invalid_argument& error )
	{
		EXPECT_NE( std::string( error.what() ).find( "far rail" ), std::string::npos ) << error.what();
	}
	EXPECT_EQ( bounds( leeway::ompl::makeStateSpace( beyond, 30 ) ).high[0], 30 );
}

// ---- curves that deceive ----

/// A turntable with a post that its arm must pass at angle 0.
leeway::Checker postWorld()
{
	return makeChecker( { hinge( "turn", LW_JOINT_CONTINUOUS, 0, 0.5 ) }, { { makeBall( 0.05 ), at( 0.4, 0, 0 ) } } );
}

TEST( Curves, TheLongWayRoundIsCheckedTheLongWayRound )
{
	// in SO2 from -3 to 3 passes pi; in a RealVector it passes 0, where the post is
	const double from = -3, to = 3;
	const Rig shorter( postWorld() );
	auto line = std::make_shared<ob::RealVectorStateSpace>( 1 );
	line->setBounds( -7, 7 );
	const Rig longer( postWorld(), {}, line );
	for ( const Rig* rig : { &shorter, &longer } )
	{
		ob::ScopedState<> s1( rig->space ), s2( rig->space ), last( rig->space );
		rig->engine->adapter().fromVector( &from, s1.get() );
		rig->engine->adapter().fromVector( &to, s2.get() );
		std::pair<ob::State*, double> last_valid( last.get(), 1 );
		EXPECT_EQ( rig->si->checkMotion( s1.get(), s2.get() ), rig == &shorter );
		EXPECT_EQ( rig->si->checkMotion( s1.get(), s2.get(), last_valid ), rig == &shorter );
		EXPECT_EQ( rig->si->checkMotion( s2.get(), s1.get() ), rig == &shorter );
		if ( rig == &longer )
		{
			// the arm meets the post near angle -0.2: the curve is 6 rad long
			EXPECT_GT( last_valid.second, 0.4 );
			EXPECT_LT( last_valid.second, 0.5 );
			EXPECT_NEAR( rig->vector( last.get() )[0], from + 6 * last_valid.second, 1e-9 );
		}
	}
	// once around and back to where it began: no motion for the core, a full turn for OMPL
	const double turn[2] = { -2, -2 + 2 * pi };
	ob::ScopedState<> s1( longer.space ), s2( longer.space );
	longer.engine->adapter().fromVector( &turn[0], s1.get() );
	longer.engine->adapter().fromVector( &turn[1], s2.get() );
	EXPECT_TRUE( longer.si->isValid( s1.get() ) );
	EXPECT_TRUE( longer.si->isValid( s2.get() ) );
	EXPECT_FALSE( longer.si->checkMotion( s1.get(), s2.get() ) );
}

TEST( Curves, HalfTurnsAreProvedOnTheSideThatOmplTakes )
{
	// exactly or nearly opposite angles: whichever way the space interpolates is the way that counts
	SeededRng rng;
	const Rig rig( postWorld() );
	const leeway::Query query = leeway::makeQuery( rig.checker.get() );
	ob::ScopedState<> s1( rig.space ), s2( rig.space ), between( rig.space );
	int free = 0, blocked = 0;
	for ( int i = 0; i < 2000; ++i )
	{
		const double from = rng.uniform( -2.5, 2.5 );
		const double off = i % 4 == 0 ? 0 : rng.integer( -8, 8 ) * ( i % 4 == 1 ? 0x1p-53 : 0x1p-51 );
		const double to = from > 0 ? from - pi + off : from + pi + off;
		rig.engine->adapter().fromVector( &from, s1.get() );
		rig.engine->adapter().fromVector( &to, s2.get() );
		if ( !rig.si->isValid( s1.get() ) || !rig.si->isValid( s2.get() ) )
		{
			continue;
		}
		bool clear = true;
		double least = INFINITY;
		for ( int k = 0; k <= 256; ++k )
		{
			rig.space->interpolate( s1.get(), s2.get(), k / 256.0, between.get() );
			clear = clear && rig.si->isValid( between.get() );
			least = std::min( least, rig.si->getStateValidityChecker()->clearance( between.get() ) );
		}
		if ( clear && least < 0.02 )
		{
			continue; // within the slack, or in contact between two samples: that is no question of sides
		}
		ASSERT_EQ( rig.si->checkMotion( s1.get(), s2.get() ), clear ) << from << " to " << to << " + " << off;
		( clear ? free : blocked )++;
	}
	EXPECT_GT( blocked, 100 );
	EXPECT_GT( free, 1 ) << "no half turn was rounded to the other side";
}

TEST( Curves, RotationsThatOmplTakesForEqualAreProvedAsOmplMoves )
{
	// A boom of 100 m turns by 5e-5 rad, 5 mm at its end. On the core's way the end has moved aside by 2.5 mm when it passes
	// the ball; on OMPL's, which keeps the first rotation until it jumps, it has not, and touches.
	const leeway::Checker checker =
	    makeChecker( { vehicle( "fly", LW_JOINT_FLOATING, 2, makeBall( 0.01 ), at( 100, 0, 0 ) ) },
	        { { makeBall( 0.01 ), at( 100.5, -0.0195, 0 ) } } );
	const Rig rig( checker );
	const double half = 2.5e-5;
	const std::vector<double> from = { 0, 0, 0, 0, 0, 0, 1 }, to = { 1, 0, 0, 0, 0, std::sin( half ), std::cos( half ) };
	ob::ScopedState<> s1( rig.space ), s2( rig.space ), middle( rig.space ), last( rig.space );
	rig.engine->adapter().fromVector( from.data(), s1.get() );
	rig.engine->adapter().fromVector( to.data(), s2.get() );
	rig.space->interpolate( s1.get(), s2.get(), 0.5, middle.get() );
	ASSERT_FALSE( rig.si->isValid( middle.get() ) ) << "OMPL's curve is free: the test has lost its point";
	const leeway::Query query = leeway::makeQuery( checker.get() );
	lw_edge_def def = lw_edge_def_default();
	lw_edge_result result;
	ASSERT_EQ( lw_checker_edge( checker.get(), query.get(), from.data(), to.data(), &def, &result ), LW_OK );
	ASSERT_EQ( result.verdict, LW_VERDICT_FREE ) << "the core's curve is blocked: the test has lost its point";

	EXPECT_FALSE( rig.si->checkMotion( s1.get(), s2.get() ) );
	EXPECT_FALSE( rig.si->checkMotion( s2.get(), s1.get() ) );
	for ( bool back : { false, true } )
	{
		std::pair<ob::State*, double> last_valid( last.get(), 1 );
		EXPECT_FALSE( rig.si->checkMotion( back ? s2.get() : s1.get(), back ? s1.get() : s2.get(), last_valid ) );
		EXPECT_LT( last_valid.second, 0.5 );
		EXPECT_TRUE( rig.si->isValid( last.get() ) );
	}
}

TEST( Curves, MotionsInPartsThatOneOfThreeCurvesBlocksKeepTheirStart )
{
	// The boom again, with a turntable that makes three turns of it parts: along OMPL's curve from the first state all is free, along that
	// from the second the third part is not.
	const leeway::Checker checker = makeChecker( { vehicle( "fly", LW_JOINT_FLOATING, 2, makeBall( 0.01 ), at( 100, 0, 0 ) ),
	                                                 hinge( "turn", LW_JOINT_CONTINUOUS, 0, 0.2 ) },
	    { { makeBall( 0.01 ), at( 100.5, -0.0195, 0 ) } } );
	auto line = std::make_shared<ob::RealVectorStateSpace>( 1 );
	line->setBounds( -7, 7 );
	auto fly = std::make_shared<ob::SE3StateSpace>();
	ob::RealVectorBounds bounds( 3 );
	bounds.setLow( -2 );
	bounds.setHigh( 2 );
	fly->setBounds( bounds );
	const Rig rig( checker, {}, fly + line );
	const double half = 2.5e-5;
	const std::vector<double> from = { 1, 0, 0, 0, 0, std::sin( half ), std::cos( half ), -3 },
	                          to = { 0, 0, 0, 0, 0, 0, 1, 3 };
	ob::ScopedState<> s1( rig.space ), s2( rig.space ), last( rig.space );
	rig.engine->adapter().fromVector( from.data(), s1.get() );
	rig.engine->adapter().fromVector( to.data(), s2.get() );
	ASSERT_GT( rig.engine->adapter().pieceCount( from.data(), to.data() ), 2u );
	std::pair<ob::State*, double> last_valid( last.get(), 1 );
	EXPECT_FALSE( rig.si->checkMotion( s1.get(), s2.get(), last_valid ) );
	EXPECT_EQ( last_valid.second, 0 );
	EXPECT_TRUE( rig.space->equalStates( last.get(), s1.get() ) );
}

TEST( Curves, OppositeRotationsAreProvedOnTheSideThatOmplTakes )
{
	// half a turn about a random axis: the sign of a scalar product that is zero but for rounding decides the way. A boom
	// swings to the one side or to the other of the plane of its ends; one of the sides is full.
	SeededRng rng;
	const Rig rig( makeChecker( { vehicle( "fly", LW_JOINT_FLOATING, 1, makeBall( 0.1 ), at( 1, 0, 0 ) ) },
	    { { makeBall( 0.5 ), at( 0, 1, 0 ) } } ) );
	ob::ScopedState<> s1( rig.space ), s2( rig.space ), between( rig.space );
	int free = 0, blocked = 0, negative = 0;
	for ( int i = 0; i < 4000; ++i )
	{
		// q2 = (axis, 0) q1 is orthogonal to q1: half a turn about the axis, near z
		double q[4], axis[3] = { 0.2 * rng.normal(), 0.2 * rng.normal(), 1 };
		rng.quaternion( q );
		const double length = std::sqrt( axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2] );
		const double ax = axis[0] / length, ay = axis[1] / length, az = axis[2] / length;
		const std::vector<double> from = { 0, 0, 0, q[0], q[1], q[2], q[3] };
		const std::vector<double> to = { 0, 0, 0, ax * q[3] + ay * q[2] - az * q[1], ay * q[3] + az * q[0] - ax * q[2],
		    az * q[3] + ax * q[1] - ay * q[0], -ax * q[0] - ay * q[1] - az * q[2] };
		rig.engine->adapter().fromVector( from.data(), s1.get() );
		rig.engine->adapter().fromVector( to.data(), s2.get() );
		if ( !rig.si->isValid( s1.get() ) || !rig.si->isValid( s2.get() ) )
		{
			continue;
		}
		double product = 0;
		bool clear = true;
		for ( int k = 0; k < 4; ++k )
		{
			product += from[3 + k] * to[3 + k];
		}
		ASSERT_LT( std::fabs( product ), 1e-15 );
		negative += product < 0;
		double lowest = inf;
		const leeway::Query query = leeway::makeQuery( rig.checker.get() );
		for ( int k = 0; k <= 100; ++k )
		{
			rig.space->interpolate( s1.get(), s2.get(), k / 100.0, between.get() );
			const double clearance = exactClearance( rig, query.get(), between.get() );
			clear = clear && clearance > 0;
			lowest = std::min( lowest, clearance );
		}
		if ( clear && lowest < 0.01 )
		{
			continue; // near the band where a proof may be refused
		}
		ASSERT_EQ( rig.si->checkMotion( s1.get(), s2.get() ), clear ) << "product " << product;
		( clear ? free : blocked )++;
	}
	EXPECT_GT( free, 100 );
	EXPECT_GT( blocked, 100 );
	EXPECT_GT( negative, 100 );
}

TEST( Curves, QuaternionSignsDoNotMatter )
{
	SeededRng rng;
	const Rig rig( droneWorld() );
	ob::ScopedState<> s1( rig.space ), s2( rig.space ), flipped( rig.space );
	for ( int i = 0; i < 200; ++i )
	{
		rig.sampleValid( rng, s1.get() );
		rig.sample( rng, s2.get() );
		std::vector<double> q = rig.vector( s2.get() );
		for ( std::size_t k = 3; k < 7; ++k )
		{
			q[k] = -q[k];
		}
		rig.engine->adapter().fromVector( q.data(), flipped.get() );
		ASSERT_EQ( rig.si->isValid( s2.get() ), rig.si->isValid( flipped.get() ) );
		ASSERT_EQ( rig.si->checkMotion( s1.get(), s2.get() ), rig.si->checkMotion( s1.get(), flipped.get() ) );
	}
}

// ---- continuous joints that do not wrap ----

TEST( Curves, AHalfTurningFollowerKeepsItsLeaderFromWrapping )
{
	// the second hinge follows the first at half its angle: at pi and -pi of the first it stands elsewhere
	std::vector<Segment> chain = {
	    hinge( "leader", LW_JOINT_CONTINUOUS, 0, 0.4 ), hinge( "follower", LW_JOINT_REVOLUTE, 0.4, 0.3, -2, 2 ) };
	chain[1].joint.mimic = 0;
	chain[1].joint.mimic_multiplier = 0.5;
	const leeway::Checker checker = makeChecker( chain, { { makeBall( 0.05 ), at( 0.3, 0, 0 ) } } );
	const Rig rig( checker );
	EXPECT_EQ( rig.space->getType(), ob::STATE_SPACE_REAL_VECTOR ) << "SO2 would jump";
	const double from = -3, to = 3;
	ob::ScopedState<> s1( rig.space ), s2( rig.space );
	rig.engine->adapter().fromVector( &from, s1.get() );
	rig.engine->adapter().fromVector( &to, s2.get() );
	EXPECT_TRUE( rig.si->isValid( s1.get() ) );
	EXPECT_TRUE( rig.si->isValid( s2.get() ) );
	EXPECT_FALSE( rig.si->checkMotion( s1.get(), s2.get() ) ) << "the way leads through 0, where the ball is";

	const auto si = std::make_shared<ob::SpaceInformation>( std::make_shared<ob::SO2StateSpace>() );
	EXPECT_THROW( leeway::ompl::install( si, checker ), std::invalid_argument );
}

// ---- refusals ----

/// Expects std::invalid_argument whose text contains `word`.
void expectRefusal( const std::function<void()>& call, const std::string& word )
{
	try
	{
		call();
		ADD_FAILURE() << "not refused: " << word;
	}
	catch ( const std::invalid_argument& error )
	{
		EXPECT_NE( std::string( error.what() ).find( word ), std::string::npos ) << error.what();
	}
}

/// install() must refuse, and leave the space information as it was.
void expectInstallRefused( const ob::StateSpacePtr& space, const leeway::Checker& checker, const std::string& word )
{
	const auto si = std::make_shared<ob::SpaceInformation>( space );
	expectRefusal( [&] { leeway::ompl::install( si, checker ); }, word );
	EXPECT_EQ( si->getStateValidityChecker(), nullptr );
}

TEST( Refusals, SpacesThatDoNotFit )
{
	const leeway::Checker gantry = gantryWorld();
	expectInstallRefused( std::make_shared<ob::RealVectorStateSpace>( 3 ), gantry, "3 numbers" );
	expectInstallRefused( std::make_shared<ob::RealVectorStateSpace>( 1 ), gantry, "1 numbers" );
	expectInstallRefused( std::make_shared<ob::DiscreteStateSpace>( 0, 5 ), gantry, "is not a RealVector" );
	expectInstallRefused( std::make_shared<ob::RealVectorStateSpace>( 7 ), droneWorld(), "fly" );
	// a quaternion's place taken by joints
	std::vector<Segment> chain;
	for ( const char* name : { "a", "b", "c", "d", "e", "f", "g" } )
	{
		chain.push_back( slider( name, 0, 0, 1, makeBall( 0.1 ) ) );
	}
	const leeway::Checker seven = makeChecker( chain, {} );
	auto se3 = std::make_shared<ob::SE3StateSpace>();
	ob::RealVectorBounds cube( 3 );
	cube.setLow( -1 );
	cube.setHigh( 1 );
	se3->setBounds( cube );
	expectInstallRefused( se3, seven, "joint d" );
}

TEST( Refusals, CurvesThatAreNotStraight )
{
	auto dubins = std::make_shared<ob::DubinsStateSpace>( 0.3 );
	ob::RealVectorBounds square( 2 );
	square.setLow( -1 );
	square.setHigh( 1 );
	dubins->setBounds( square );
	expectInstallRefused( dubins, cartWorld(), "straight" );

	// state by state they can be checked, with OMPL's own validator
	const auto si = std::make_shared<ob::SpaceInformation>( dubins );
	const auto engine = std::make_shared<const leeway::ompl::Engine>( dubins, cartWorld(), leeway::ompl::Options() );
	EXPECT_FALSE( engine->adapter().straight() );
	si->setStateValidityChecker( std::make_shared<leeway::ompl::StateValidityChecker>( si, engine ) );
	si->setup();
	ob::ScopedState<ob::SE2StateSpace> state( dubins );
	state->setXY( 0, -0.5 );
	state->setYaw( 0 );
	EXPECT_FALSE( si->isValid( state.get() ) );
	state->setXY( -0.6, 0 );
	EXPECT_TRUE( si->isValid( state.get() ) );
	EXPECT_TRUE( si->checkMotion( state.get(), state.get() ) );
}

/// The diagonal of the gantry's rails.
struct Diagonal : ob::Constraint
{
	Diagonal() : ob::Constraint( 2, 1 ) {}
	void function( const Eigen::Ref<const Eigen::VectorXd>& x, Eigen::Ref<Eigen::VectorXd> out ) const override
	{
		out[0] = x[0] - x[1];
	}
};

TEST( ConstrainedSpaces, StatesAreSeenThroughToTheNumbers )
{
	const leeway::Checker checker = gantryWorld();
	const Rig plain( checker );
	const auto constraint = std::make_shared<Diagonal>();
	const auto space = std::make_shared<ob::ProjectedStateSpace>( leeway::ompl::makeStateSpace( checker ), constraint );
	const auto si = std::make_shared<ob::ConstrainedSpaceInformation>( space );
	const auto engine = std::make_shared<const leeway::ompl::Engine>( space, checker, leeway::ompl::Options() );
	const auto states = std::make_shared<leeway::ompl::StateValidityChecker>( si, engine );
	si->setStateValidityChecker( states );
	si->setup();
	ob::ScopedState<> constrained( space ), same( plain.space );
	int valid = 0;
	for ( int i = 0; i <= 100; ++i )
	{
		const double q[2] = { -1 + 0.02 * i, -1 + 0.02 * i };
		engine->adapter().fromVector( q, constrained.get() );
		plain.engine->adapter().fromVector( q, same.get() );
		const auto& unwrapped = *constrained->as<ob::ConstrainedStateSpace::StateType>();
		ASSERT_EQ( unwrapped[0], q[0] );
		ASSERT_EQ( unwrapped[1], q[1] );
		ASSERT_EQ( si->isValid( constrained.get() ), plain.si->isValid( same.get() ) );
		ASSERT_NEAR(
		    states->clearance( constrained.get() ), plain.si->getStateValidityChecker()->clearance( same.get() ), 1e-12 );
		valid += si->isValid( constrained.get() );
	}
	EXPECT_GT( valid, 20 );
	EXPECT_LT( valid, 90 );
	// and OMPL's own validator for such spaces asks the checker along the manifold
	const double start[2] = { -0.9, -0.9 }, near_start[2] = { -0.8, -0.8 }, beyond[2] = { 0.9, 0.9 };
	ob::ScopedState<> goal( space );
	engine->adapter().fromVector( start, constrained.get() );
	engine->adapter().fromVector( near_start, goal.get() );
	EXPECT_TRUE( si->checkMotion( constrained.get(), goal.get() ) );
	engine->adapter().fromVector( beyond, goal.get() );
	ASSERT_TRUE( si->isValid( goal.get() ) );
	EXPECT_FALSE( si->checkMotion( constrained.get(), goal.get() ) ) << "the wall is in between";
}

TEST( Refusals, ConstraintManifolds )
{
	const leeway::Checker checker = gantryWorld();
	const auto space =
	    std::make_shared<ob::ProjectedStateSpace>( leeway::ompl::makeStateSpace( checker ), std::make_shared<Diagonal>() );
	expectInstallRefused( space, checker, "constraint manifold" );
	// the states can be read all the same
	const leeway::ompl::Engine engine( space, checker, {} );
	ob::State* state = space->allocState();
	const double written[2] = { 0.25, 0.5 };
	double read[2] = {};
	engine.adapter().fromVector( written, state );
	engine.adapter().toVector( state, read );
	EXPECT_EQ( read[0], 0.25 );
	EXPECT_EQ( read[1], 0.5 );
	space->freeState( state );
}

TEST( Refusals, ALimitedJointInSO2 )
{
	const leeway::Checker limited = makeChecker(
	    { hinge( "elbow", LW_JOINT_REVOLUTE, 0, 0.4, -2.8, 2.8 ) }, { { makeBall( 0.1 ), at( 0.3, 0.3, 0 ) } } );
	expectInstallRefused( std::make_shared<ob::SO2StateSpace>(), limited, "elbow" );
}

TEST( Refusals, JointsTornApart )
{
	const std::vector<Segment> chain = {
	    vehicle( "drive", LW_JOINT_PLANAR, 1, makeBall( 0.1 ) ), slider( "slide", 0, 0, 1, makeBall( 0.1 ) ) };
	const std::vector<std::vector<std::uint32_t>> groups = { { 0, 1, 3, 2 }, { 1, 0, 2, 3 }, { 3, 0, 1 } };
	for ( const std::vector<std::uint32_t>& group : groups )
	{
		try
		{
			const leeway::Checker checker = makeChecker( chain, {}, group );
			expectRefusal( [&] { leeway::ompl::makeStateSpace( checker ); }, "drive" );
		}
		catch ( const leeway::CoreError& )
		{
			EXPECT_EQ( group.size(), 3u ) << "the core refuses half a joint";
		}
	}
}

TEST( Refusals, EnginesOfAnotherSpace )
{
	// states carry no type: the numbers of one space would be read as those of another
	const Rig gantry( gantryWorld() ), arm( armWorld() );
	const Rig twin( gantry.checker );
	expectRefusal( [&] { leeway::ompl::StateValidityChecker( gantry.si, arm.engine ); }, "another" );
	expectRefusal( [&] { leeway::ompl::MotionValidator( gantry.si, arm.engine ); }, "another" );
	expectRefusal( [&] { leeway::ompl::MotionValidator( gantry.si, twin.engine ); }, "another" );
	// one engine may serve several space informations of its space
	const auto second = std::make_shared<ob::SpaceInformation>( gantry.space );
	EXPECT_NO_THROW( leeway::ompl::StateValidityChecker( second, gantry.engine ) );
	EXPECT_NO_THROW( leeway::ompl::MotionValidator( second, gantry.engine ) );
}

TEST( Refusals, NothingGiven )
{
	const leeway::Checker checker = gantryWorld();
	const auto space = leeway::ompl::makeStateSpace( checker );
	const auto si = std::make_shared<ob::SpaceInformation>( space );
	EXPECT_THROW( leeway::ompl::makeStateSpace( {} ), std::invalid_argument );
	EXPECT_THROW( leeway::ompl::Engine( space, {}, {} ), std::invalid_argument );
	EXPECT_THROW( leeway::ompl::Engine( nullptr, checker, {} ), std::invalid_argument );
	EXPECT_THROW( leeway::ompl::StateValidityChecker( si, nullptr ), std::invalid_argument );
	EXPECT_THROW( leeway::ompl::MotionValidator( si, nullptr ), std::invalid_argument );
	const auto engine = std::make_shared<const leeway::ompl::Engine>( space, checker, leeway::ompl::Options() );
	EXPECT_THROW( leeway::ompl::StateValidityChecker( nullptr, engine ), std::invalid_argument );
	EXPECT_THROW( leeway::ompl::MotionValidator( nullptr, engine ), std::invalid_argument );
	EXPECT_THROW( leeway::ompl::install( nullptr, checker ), std::invalid_argument );
}

TEST( Refusals, Options )
{
	using leeway::ompl::Options;
	const leeway::Checker checker = gantryWorld();
	const auto space = leeway::ompl::makeStateSpace( checker );
	auto expect = [&]( const char* word, const std::function<void( Options& )>& change )
	{
		Options options;
		change( options );
		expectRefusal( [&] { leeway::ompl::Engine( space, checker, options ); }, word );
	};
	for ( double wrong : { nan_value, -1.0, inf } )
	{
		expect( "min_d", [=]( Options& options ) { options.min_d = wrong; } );
		expect( "slack", [=]( Options& options ) { options.slack = wrong; } );
		expect( "step", [=]( Options& options ) { options.step = wrong; } );
		expect( "alpha", [=]( Options& options ) { options.alpha = wrong; } );
	}
	expect( "slack", []( Options& options ) { options.slack = 0; } );
	expect( "step", []( Options& options ) { options.step = 0; } );
	expect( "alpha", []( Options& options ) { options.alpha = 1; } );
	expect( "max_d", []( Options& options ) { options.max_d = nan_value; } );
	expect( "max_d", []( Options& options ) { options.max_d = -1; } );
	expect( "max_d", []( Options& options ) { options.min_d = options.max_d; } );
	expect( "method", []( Options& options ) { options.method = static_cast<lw_edge_method>( 0 ); } );
	expect( "clearances", []( Options& options ) { options.flags = static_cast<lw_check_flags>( 0 ); } );

	Options unlimited;
	unlimited.max_d = inf;
	const Rig rig( checker, unlimited );
	const leeway::Query query = leeway::makeQuery( checker.get() );
	ob::ScopedState<> state( rig.space );
	state[0] = -0.9;
	state[1] = -0.9;
	const double exact = exactClearance( rig, query.get(), state.get() );
	EXPECT_GT( exact, 0.5 );
	EXPECT_NEAR( rig.si->getStateValidityChecker()->clearance( state.get() ), exact, 1e-12 );
}

} // namespace
