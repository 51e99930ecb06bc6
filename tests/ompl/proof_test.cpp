// SPDX-License-Identifier: BSD-3-Clause
// Motions that are proved in several parts, along several curves or in both directions: each proof counts.
#include "leeway/ompl/objective.hpp"
#include "leeway/reach.h"
#include "world.hpp"

#include <ompl/base/spaces/RealVectorStateSpace.h>

namespace
{

using leeway::ompl::ClearanceObjective;

/// A state of the rig with these numbers.
ob::ScopedState<> stateOf( const Rig& rig, const std::vector<double>& numbers )
{
	ob::ScopedState<> state( rig.space );
	rig.engine->adapter().fromVector( numbers.data(), state.get() );
	return state;
}

double costOf( const Rig& rig, const std::vector<double>& from, const std::vector<double>& to, double tolerance )
{
	const ob::ScopedState<> s1 = stateOf( rig, from ), s2 = stateOf( rig, to );
	return ClearanceObjective( rig.si, rig.engine, tolerance ).motionCost( s1.get(), s2.get() ).value();
}

// ---- motions in parts ----

TEST( Proofs, TurnsOfALittleMoreThanHalfAreProvedTheShorterWay )
{
	// a line from -a to a passes 0, where the post is; the core's way passes pi
	auto line = std::make_shared<ob::RealVectorStateSpace>( 1 );
	line->setBounds( -7, 7 );
	const Rig rig(
	    makeChecker( { hinge( "turn", LW_JOINT_CONTINUOUS, 0, 0.5 ) }, { { makeBall( 0.05 ), at( 0.4, 0, 0 ) } } ), {},
	    line );
	for ( const double turn : { pi + 1e-12, pi + 1e-3, pi + 0.5, pi + 0.999, pi + 1.001, 5.0 } )
	{
		const ob::ScopedState<> s1 = stateOf( rig, { -turn / 2 } ), s2 = stateOf( rig, { turn / 2 } );
		ASSERT_TRUE( rig.si->isValid( s1.get() ) && rig.si->isValid( s2.get() ) );
		EXPECT_FALSE( rig.si->checkMotion( s1.get(), s2.get() ) ) << turn;
		EXPECT_FALSE( rig.si->checkMotion( s2.get(), s1.get() ) ) << turn;
	}
}

/// The same robot with its pair tables; without obstacles. Empty in a build without motion hulls.
leeway::Checker withTables( const leeway::Checker& checker )
{
	lw_reach_def reach_def = lw_reach_def_default();
	reach_def.robot = lw_checker_robot( checker.get() );
	lw_reach* made = nullptr;
	lw_diag diag = {};
	const lw_status status = lw_reach_create( &reach_def, nullptr, &diag, &made );
	if ( status == LW_ERROR_UNSUPPORTED )
	{
		return {};
	}
	leeway::require( status, diag );
	const leeway::Reach reach = leeway::Reach::adopt( made );
	lw_checker_def def = lw_checker_def_default();
	def.robot = reach_def.robot;
	def.scene = lw_checker_scene( checker.get() );
	def.reach = made;
	lw_checker* out = nullptr;
	leeway::require( lw_checker_create( &def, nullptr, &diag, &out ), diag );
	return leeway::Checker::adopt( out );
}

TEST( Proofs, TheClearanceOfAMotionInPartsIsThatOfItsLastPart )
{
	// The turntable makes the motion one of several parts. The carriage begins below its limits, 5 cm above the turntable; within
	// them a table of the robot's says how far away it is.
	auto plane = std::make_shared<ob::RealVectorStateSpace>( 2 );
	plane->setBounds( -7, 7 );
	leeway::ompl::Options options;
	options.max_d = 1;
	std::vector<Segment> chain = { vehicle( "turn", LW_JOINT_CONTINUOUS, 0, makeBall( 0.05 ) ), slider( "none", 0, 0, 0 ),
	    slider( "lift", 2, 0.5, 1, makeBall( 0.05 ) ) };
	chain[1].joint.type = LW_JOINT_FIXED;
	const leeway::Checker checker = withTables( makeChecker( chain, {} ) );
	if ( !checker )
	{
		GTEST_SKIP() << "no pair tables without motion hulls";
	}
	const Rig rig( checker, options, plane );
	const std::vector<double> from = { -3, 0.15 }, to = { 3, 0.95 };
	ASSERT_GT( rig.engine->adapter().pieceCount( from.data(), to.data() ), 2u );
	const double cost = costOf( rig, from, to, 0.1 );
	EXPECT_LE( cost, 0.05 + 1e-9 );
	EXPECT_GE( cost, 0.05 / 1.1 - 1e-9 );
	EXPECT_GT( costOf( rig, { 1, 0.7 }, to, 0.1 ), 0.5 );
}

// ---- close rotations: three curves of one motion ----

/// The end of a boom of 100 m, which a turn by 5e-5 rad moves by 5 mm along y, and a small ball by it.
leeway::Checker boomWorld( double radius, double x, double y )
{
	return makeChecker( { vehicle( "fly", LW_JOINT_FLOATING, 2, makeBall( radius ), at( 100, 0, 0 ) ) },
	    { { makeBall( radius ), at( x, y, 0 ) } } );
}

/// The boom's end at (100 + x, 0 or 5 mm).
std::vector<double> boom( double x, bool turned )
{
	const double half = turned ? 2.5e-5 : 0;
	return { x, 0, 0, 0, 0, std::sin( half ), std::cos( half ) };
}

TEST( Proofs, TheWayBetweenTwoCloseRotationsIsNotProved )
{
	// With either rotation the end passes the ball at 1.5 mm; while it turns from one to the other, it meets it.
	const Rig rig( boomWorld( 0.0005, 100.5, 0.0025 ) );
	const ob::ScopedState<> s1 = stateOf( rig, boom( 0, false ) ), s2 = stateOf( rig, boom( 1, true ) );
	for ( const bool turned : { false, true } )
	{
		const ob::ScopedState<> from = stateOf( rig, boom( 0, turned ) ), to = stateOf( rig, boom( 1, turned ) );
		ASSERT_TRUE( rig.si->checkMotion( from.get(), to.get() ) ) << "the test has lost its point";
	}
	EXPECT_FALSE( rig.si->checkMotion( s1.get(), s2.get() ) );
	EXPECT_FALSE( rig.si->checkMotion( s2.get(), s1.get() ) );
}

TEST( Proofs, TheWayBackBetweenTwoCloseRotationsIsNotProved )
{
	// The ball is met by the curve with the rotation of one end alone, which is the other end's curve in one direction.
	const Rig rig( boomWorld( 0.0005, 100.1, 0.005 ) );
	const ob::ScopedState<> s1 = stateOf( rig, boom( 0, false ) ), s2 = stateOf( rig, boom( 1, true ) );
	EXPECT_FALSE( rig.si->checkMotion( s1.get(), s2.get() ) );
	EXPECT_FALSE( rig.si->checkMotion( s2.get(), s1.get() ) );
}

TEST( Proofs, TheClearanceBetweenTwoCloseRotationsForgetsACurve )
{
	// The end travels by 3 mm along y, and its turn by -5 mm: with the rotation of the first state it goes from 2 to 5 mm, with that
	// of the second from -3 to 0, and while it turns from 2 to 0. The ball is beyond 5 or below -3 mm.
	SeededRng rng;
	leeway::ompl::Options options;
	options.slack = 1e-4;
	options.max_d = 2;
	std::vector<double> from = boom( 0, true ), to = boom( 0, false );
	from[1] = -0.003;
	for ( int i = 0; i < 400; ++i )
	{
		const double clearance = rng.uniform( 0.008, 0.012 ), away = clearance + 0.001;
		const Rig rig( boomWorld( 0.0005, 100, i % 2 == 0 ? 0.005 + away : -0.003 - away ), options );
		for ( const double tolerance : { 0.3, 0.03, 0.01 } )
		{
			const double cost = costOf( rig, from, to, tolerance );
			ASSERT_LE( cost, clearance + 1e-7 ) << i << " " << tolerance;
			ASSERT_GE( cost, clearance / ( 1 + tolerance ) - 1e-6 ) << i << " " << tolerance;
		}
	}
}

// ---- self clearances in a cost ----

/// A ball on a rail along x, on whose carriage another one moves along z and y.
Rig carriageRig()
{
	leeway::ompl::Options options;
	options.max_d = 1;
	return Rig( makeChecker( { slider( "x", 0, -1, 1, makeBall( 0.05 ) ), slider( "z", 2, -1, 1 ),
	                             slider( "y", 1, -1, 1, makeBall( 0.05 ) ) },
	                { { makeBall( 0.1 ), at( 0, 0, 5 ) } } ),
	    options );
}

TEST( Proofs, ACostIsProvedWithoutTheSelfClearance )
{
	const Rig rig = carriageRig();
	const double cost = costOf( rig, { 0, 0.15, -0.5 }, { 0, 0.15, 0.5 }, 0.1 );
	EXPECT_LE( cost, 0.05 + 1e-9 );
	EXPECT_GE( cost, 0.05 / 1.1 - 1e-9 );
}

TEST( Proofs, TheSearchForACostDoesNotMeasureSelfClearances )
{
	// the two balls keep 5 cm: measured at an end, proved at once
	const Rig rig = carriageRig();
	const leeway::ompl::Counters before = rig.engine->counters();
	const double cost = costOf( rig, { -0.5, 0, 0.15 }, { 0.5, 0, 0.15 }, 0.1 );
	EXPECT_LE( cost, 0.05 + 1e-9 );
	EXPECT_GE( cost, 0.05 / 1.1 - 1e-9 );
	EXPECT_EQ( rig.engine->counters().cost_edges - before.cost_edges, 1u );
}

// ---- last valid states ----
//
// A proof halves 1,024 windows of pairs within the slack. The run up to a last valid state uses all of them here; as a motion of
// its own it has other windows, and may need more.

/// A turntable with arms of 1 m above each other; each passes a pin at angle 0 at a hair's breadth.
leeway::Checker pinWorld( int count, double gap )
{
	std::vector<Segment> chain = { hinge( "turn", LW_JOINT_REVOLUTE, 0, 1, -3, 3 ) };
	std::vector<Obstacle> pins;
	for ( int i = 0; i < count; ++i )
	{
		if ( i > 0 )
		{
			chain.push_back( hinge( "layer", LW_JOINT_FIXED, 0, 1 ) );
			chain.back().name += std::to_string( i );
			chain.back().joint.parent_from_joint = at( 0, 0, 0.2 );
		}
		pins.push_back( { makeBall( 0.01 ), at( 1.04 + gap, 0, 0.2 * i ) } );
	}
	return makeChecker( chain, pins );
}

struct Interval
{
	double low, high;
};

/// Drives the arms past the pins, and expects that the motions to and from the last valid states are valid.
/// @param count of the arms
/// @param start radians, before the pins if negative
void expectLastValidBothWays( int trials, Interval count, Interval start )
{
	SeededRng rng;
	int undecided = 0;
	for ( int i = 0; i < trials; ++i )
	{
		const double gap = std::pow( 10, rng.uniform( -6.6, -6.4 ) );
		const Rig rig( pinWorld( rng.integer( int( count.low ), int( count.high ) ), gap ) );
		const ob::ScopedState<> s1 = stateOf( rig, { rng.uniform( start.low, start.high ) } );
		const ob::ScopedState<> s2 = stateOf( rig, { rng.uniform( 1, 2.8 ) } );
		ob::ScopedState<> last( rig.space );
		std::pair<ob::State*, double> last_valid( last.get(), 1 );
		if ( !rig.si->checkMotion( s1.get(), s2.get(), last_valid ) )
		{
			undecided += last_valid.second > 0;
			ASSERT_TRUE( rig.si->checkMotion( s1.get(), last.get() ) ) << gap << ", " << s1[0] << " to " << last[0];
			ASSERT_TRUE( rig.si->checkMotion( last.get(), s1.get() ) ) << gap << ", " << last[0] << " to " << s1[0];
		}
	}
	EXPECT_GT( undecided, trials / 2 ) << "the test has lost its point";
}

TEST( Proofs, TheMotionToALastValidStateWithinTheSlackIsNotProved )
{
	expectLastValidBothWays( 80, { 34, 47 }, { -1e-5, 1e-5 } );
}

TEST( Proofs, TheRunToALastValidStateGoesIntoTheSlack )
{
	// 1 to 2 mm from the pins at first
	expectLastValidBothWays( 100, { 90, 150 }, { -0.011, -0.0093 } );
}

TEST( Proofs, TheMotionBackFromALastValidStateIsNotProved )
{
	// with 64 arms, in a tenth of these scenes the first candidate can be reached but not left
	expectLastValidBothWays( 80, { 64, 64 }, { -0.0009, -0.0007 } );
}

} // namespace
