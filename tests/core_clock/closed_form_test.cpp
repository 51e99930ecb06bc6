// SPDX-License-Identifier: BSD-3-Clause
// Balls on rails: contacts, and the times at which they begin, are known in closed form.
#include "clock_world.hpp"
#include "one_obstacle.hpp"
#include "simple_shapes.hpp"

#include <gtest/gtest.h>

namespace
{

constexpr double radius = 0.1;

/// Two balls on rails: one along x through the origin, one along y; a third joint turns far away, so that motions bend.
struct Crossing
{
	RobotPtr robot;

	/// @param follows the second ball's joint follows another one, which moves no body
	explicit Crossing( double height = 0, bool follows = false )
	{
		RobotModel model;
		model.link( "world" );
		addJoint( model, "a", LW_JOINT_PRISMATIC, 0, 0 );
		addJoint( model, "b", LW_JOINT_PRISMATIC, 0, 1 );
		if ( follows )
		{
			model.joints.back().mimic = 2;
			model.joints.back().mimic_multiplier = 1;
			addJoint( model, "driver", LW_JOINT_PRISMATIC, 0, 1 );
		}
		lw_transform up = lw_transform_identity();
		up.t[2] = height;
		model.body( 1, primitive( LW_SHAPE_SPHERE, radius ), lw_transform_identity() );
		model.body( 2, primitive( LW_SHAPE_SPHERE, radius ), up );
		robot = model.create();
	}
};

OwnedTrack straight( std::uint32_t variable, double start, double end, double from, double to )
{
	OwnedTrack track;
	track.variables = { variable };
	track.pieces = { { start, end, 1, { from, to } } };
	return track;
}

lw_timed_def toTheMillisecond()
{
	lw_timed_def def = lw_timed_def_default();
	def.contact_resolution = 1e-3;
	return def;
}

} // namespace

// Each ball by itself passes the crossing; whether they meet is a question of their times, and the pieces begin at different ones.
TEST( Clock, TwoMotionsMeetOnlyIfTheirTimesSaySo )
{
	SeededRng rng;
	const Crossing crossing;
	const ClockBench bench( crossing.robot.get(), nullptr, true );
	int free = 0, blocked = 0;
	for ( int i = 0; i < 400; ++i )
	{
		const double speed = rng.uniform( 0.2, 3 ), late = rng.uniform( -1, 1 ), cut = rng.uniform( -0.3, 0.3 );
		OwnedClock clock;
		clock.rest = { 0, 0 };
		clock.tracks = { straight( 0, -2, 2, -2 * speed, 2 * speed ) };
		// the second ball, in two pieces, at the origin at `late`
		OwnedTrack second;
		second.variables = { 1 };
		second.pieces = { { late - 2, late + cut, 1, { -2 * speed, cut * speed } },
		    { late + cut, late + 2, 1, { cut * speed, 2 * speed } } };
		clock.tracks.push_back( second );
		const double nearest = speed * std::abs( late ) / std::sqrt( 2.0 ) - 2 * radius;
		const lw_timed_result r = bench.ask( clock, -3, 3.5, toTheMillisecond() );
		EXPECT_FALSE( nearest < -1e-9 && r.verdict == LW_VERDICT_FREE ) << "speed " << speed << ", late " << late;
		EXPECT_TRUE( nearest < 2e-3 || r.verdict == LW_VERDICT_FREE ) << "speed " << speed << ", late " << late;
		free += r.verdict == LW_VERDICT_FREE;
		blocked += r.verdict == LW_VERDICT_BLOCKED;
		if ( r.verdict == LW_VERDICT_FREE )
		{
			EXPECT_LE( r.lower_bound, nearest + 1e-9 );
		}
		if ( r.verdict == LW_VERDICT_BLOCKED )
		{
			// (speed t)^2 + (speed (t - late))^2 = (2 radius)^2
			const double d = 2 * radius / speed;
			const double first = 0.5 * ( late - std::sqrt( std::max( 0.0, 2 * d * d - late * late ) ) );
			EXPECT_LE( r.proved_until, first + 1e-9 );
			EXPECT_GE( r.time, first - 1e-9 );
			EXPECT_TRUE( r.time - r.proved_until <= 1e-3 || nearest > -1e-3 ) << r.time - r.proved_until;
		}
	}
	EXPECT_GT( free, 100 );
	EXPECT_GT( blocked, 50 );
}

// A ball that may be off by some millimetres goes slowly into another one: before the contact is a time that cannot be proved, and the contact
// that is reported is the first one all the same.
TEST( Clock, AContactBehindAnUndecidedPartIsReportedLate )
{
	SeededRng rng;
	const Crossing crossing;
	const ClockBench bench( crossing.robot.get(), nullptr, false );
	for ( int i = 0; i < 200; ++i )
	{
		const double first = rng.uniform( 0.5, 9 ), end = first + rng.uniform( 0.1, 5 ), speed = rng.uniform( 0.02, 0.1 );
		OwnedClock clock;
		clock.rest = { 0, 0 };
		clock.tracks = { straight( 0, 0, end, 2 * radius + speed * first, 2 * radius - speed * ( end - first ) ) };
		clock.tracks[0].tolerance = { rng.decade( -4, -2 ) };
		const double maybe = first - clock.tracks[0].tolerance[0] / speed; // the earliest time that the controller allows
		const lw_timed_result r = bench.ask( clock, 0, end, toTheMillisecond() );
		if ( r.verdict == LW_VERDICT_BLOCKED )
		{
			EXPECT_LE( r.proved_until, std::max( 0.0, maybe ) + 1e-9 );
			EXPECT_GE( r.time, first - 1e-9 );
			EXPECT_LE( r.time, first + 1e-3 ) << "from " << maybe << ", known until " << r.proved_until;
			EXPECT_LE( r.pair.upper, 1e-12 );
		}
	}
}

// Two controllers may be late: 2 lag speed / sqrt( 2 ) nearer than the tracks say.
TEST( Clock, LagOfBothTracksIsTakenOff )
{
	SeededRng rng;
	int free = 0;
	for ( int i = 0; i < 400; ++i )
	{
		const Crossing crossing( 0, i % 2 == 0 );
		const ClockBench bench( crossing.robot.get(), nullptr, false );
		const double speed = rng.uniform( 0.2, 3 ), late = rng.uniform( 0.05, 1 ), lag = rng.decade( -3, -0.5 );
		OwnedClock clock;
		clock.rest = { 0, 0 };
		clock.tracks = {
		    straight( 0, -2, 2, -2 * speed, 2 * speed ), straight( 1, late - 2, late + 2, -2 * speed, 2 * speed ) };
		clock.tracks[0].lag = clock.tracks[1].lag = lag;
		const double nearest = speed * std::max( 0.0, late - 2 * lag ) / std::sqrt( 2.0 ) - 2 * radius;
		const double with_tubes = speed * late / std::sqrt( 2.0 ) - 2 * speed * lag - 2 * radius;
		const lw_timed_result r = bench.ask( clock, -3, 3.5, lw_timed_def_default() );
		EXPECT_FALSE( nearest < -1e-9 && r.verdict == LW_VERDICT_FREE ) << speed << ' ' << late << ' ' << lag;
		EXPECT_TRUE( with_tubes < 2e-3 || r.verdict == LW_VERDICT_FREE ) << speed << ' ' << late << ' ' << lag;
		free += r.verdict == LW_VERDICT_FREE;
	}
	EXPECT_GT( free, 100 );
}

// A lag reaches over the ends of pieces: a ball that rests now may have been moving, and may begin to move early.
TEST( Clock, LagReachesOverTheEndsOfPieces )
{
	const Crossing crossing;
	const ClockBench bench( crossing.robot.get(), nullptr, false );
	for ( const bool before : { false, true } )
	{
		// the ball leaves the crossing at 0, or comes there at 2; the other rests 0.3 m beside it; a lag of 0.5 s takes it there
		OwnedClock clock;
		clock.rest = { 0, 0 };
		clock.tracks = {
		    before ? straight( 0, 2, 3, -0.5, 0 ) : straight( 0, -1, 0, 0, -0.5 ), straight( 1, 10, 11, 0.15, 0.15 ) };
		clock.tracks[0].lag = 0.3;
		const lw_timed_result r = bench.ask( clock, 0.01, 1.99, lw_timed_def_default() );
		EXPECT_EQ( r.verdict, LW_VERDICT_FREE ) << before; // 0.35 and 0.15 are 0.38 m away
		clock.tracks[0].lag = 0.85;
		const lw_timed_result late = bench.ask( clock, 0.01, 1.99, lw_timed_def_default() );
		EXPECT_NE( late.verdict, LW_VERDICT_FREE ) << before;
	}
}

// A person of whom the first place is known: the first possible contact is at distance / speed.
TEST( Clock, SpreadGrowsFromItsStart )
{
	SeededRng rng;
	const Crossing crossing;
	const ClockBench bench( crossing.robot.get(), nullptr, true );
	int free = 0, blocked = 0;
	for ( int i = 0; i < 300; ++i )
	{
		const double speed = rng.uniform( 0.1, 2 ), start = rng.uniform( -1, 2 ), away = rng.uniform( 0.3, 3 );
		OwnedClock clock;
		clock.rest = { 0, 0 };
		clock.tracks = { straight( 0, 0, 1, away, away ), straight( 1, 0, 1, 0, 0 ) };
		clock.tracks[0].spread_speed = speed;
		clock.tracks[0].spread_start = start;
		const double first = start + ( away - 2 * radius ) / speed, end = rng.uniform( std::max( 0.0, start ), 4 );
		lw_timed_def def = toTheMillisecond();
		def.edge.slack = 1e-4;
		const lw_timed_result r = bench.ask( clock, 0, end, def );
		EXPECT_FALSE( first < end - 1e-9 && r.verdict == LW_VERDICT_FREE ) << first << ", until " << end;
		EXPECT_TRUE( first < end + 0.01 || r.verdict == LW_VERDICT_FREE ) << first << ", until " << end;
		free += r.verdict == LW_VERDICT_FREE;
		if ( r.verdict == LW_VERDICT_BLOCKED )
		{
			++blocked;
			EXPECT_TRUE( r.by_spread );
			EXPECT_LE( r.proved_until, std::max( first, 0.0 ) + 1e-9 ); // before 0 nobody asks
			EXPECT_GE( r.time, first - 1e-9 );
			EXPECT_LE( r.time - r.proved_until, 2e-3 );
		}
	}
	EXPECT_GT( free, 30 );
	EXPECT_GT( blocked, 100 );
}

// A block at rest does not see whether a motion is late: the ball passes a block a hair away, at a speed at which its lag is decimetres.
TEST( Clock, LagTakesOffBesideABlockAtRest )
{
	SeededRng rng;
	const Crossing crossing( 0.5 );
	for ( int i = 0; i < 100; ++i )
	{
		const double gap = ( i % 2 == 0 ? 1 : -1 ) * rng.decade( -4, -2 ), lag = rng.uniform( 0.1, 0.3 );
		const ShapePtr block( primitive( LW_SHAPE_BOX, 1, 1, 1 ) );
		lw_transform beside = lw_transform_identity();
		beside.t[1] = radius + gap + 0.5;
		const leeway::Scene scene = oneObstacle( block.get(), beside );
		const ClockBench bench( crossing.robot.get(), scene.get(), false );
		OwnedClock clock;
		clock.rest = { 0, -2 };
		clock.tracks = { straight( 0, 0, 2, -2, 2 ) };
		clock.tracks[0].lag = lag;
		lw_timed_def def = lw_timed_def_default();
		def.edge.slack = 1e-5;
		// before the motion, from its middle on, until its middle
		for ( const auto& [from, to] : { std::pair<double, double>{ -1, 3 }, { 1.9, 3 }, { -1, 0.1 } } )
		{
			const lw_timed_result r = bench.ask( clock, from, to, def );
			const double nearest =
			    from == -1 && to == 3 ? gap : 0.1; // else it is beside the block only if it is late or early by 0.65 s
			EXPECT_EQ( r.verdict == LW_VERDICT_FREE, nearest > 0 ) << "gap " << gap << ", lag " << lag << ", from " << from;
		}
	}
}

// A ball leaves late, and all that time its spread grows.
TEST( Clock, SpreadGoesOnWhileATrackIsLate )
{
	SeededRng rng;
	const Crossing crossing( 0.5 );
	int free = 0;
	for ( int i = 0; i < 100; ++i )
	{
		const double speed = rng.uniform( 0.1, 0.4 ), lag = rng.uniform( 0.02, 0.3 ),
		             gap = ( i % 2 == 0 ? 1 : -1 ) * rng.decade( -3, -1.5 );
		const ShapePtr block( primitive( LW_SHAPE_BOX, 1, 1, 1 ) );
		lw_transform before = lw_transform_identity();
		before.t[0] = radius + speed * ( 1 + lag ) + gap + 0.5;
		const leeway::Scene scene = oneObstacle( block.get(), before );
		const ClockBench bench( crossing.robot.get(), scene.get(), false );
		OwnedClock clock;
		clock.rest = { 0, -2 };
		clock.tracks = { straight( 0, 1, 1.2, 0, -2 ) };
		clock.tracks[0].lag = lag;
		clock.tracks[0].spread_speed = speed;
		clock.tracks[0].spread_start = 0;
		const lw_timed_result r = bench.ask( clock, 0, 3, lw_timed_def_default() );
		EXPECT_FALSE( gap < 0 && r.verdict == LW_VERDICT_FREE ) << "gap " << gap << ", lag " << lag << ", speed " << speed;
		EXPECT_TRUE( gap < 2e-3 || r.verdict == LW_VERDICT_FREE ) << "gap " << gap << ", lag " << lag << ", speed " << speed;
		free += r.verdict == LW_VERDICT_FREE;
	}
	EXPECT_GT( free, 20 );
}

// Polynomials of several degrees side by side: the ball turns back a hair before or behind the face of a block, in a piece that the
// other track's pieces cut.
TEST( Clock, DegreesAreRaisedAndPiecesCutAlike )
{
	SeededRng rng;
	int free = 0;
	for ( int i = 0; i < 300; ++i )
	{
		const double far = rng.uniform( 0.02, 1 ), gap = ( i % 2 == 0 ? 1 : -1 ) * rng.decade( -5, -2 );
		RobotModel model;
		model.link( "rail" );
		addJoint( model, "ball", LW_JOINT_PRISMATIC, 0, 0 );
		addJoint( model, "other", LW_JOINT_PRISMATIC, 0, 1 );
		model.body( 1, primitive( LW_SHAPE_SPHERE, radius ), lw_transform_identity() );
		lw_transform off = lw_transform_identity();
		off.t[2] = 5;
		model.body( 2, primitive( LW_SHAPE_SPHERE, radius ), off );
		const RobotPtr robot = model.create();
		const ShapePtr block( primitive( LW_SHAPE_BOX, 1, 1, 1 ) );
		lw_transform behind = lw_transform_identity();
		behind.t[0] = far + gap + radius + 0.5;
		const leeway::Scene scene = oneObstacle( block.get(), behind );
		const ClockBench bench( robot.get(), scene.get(), false );
		// farthest at t, from the derivative of 3 a t (1 - t)^2 + 3 b t^2 (1 - t)
		const double t = rng.uniform( 0.35, 0.65 ), b = -( 1 - t ) * ( 1 - 3 * t ) / ( t * ( 2 - 3 * t ) );
		const double scale = far / ( 3 * t * ( 1 - t ) * ( 1 - t + b * t ) );
		OwnedClock clock;
		clock.rest = { 0, 0 };
		OwnedTrack ball, other;
		ball.variables = { 0 };
		ball.pieces = { { 1, 3, 3, { 0, scale, b * scale, 0 } } };
		other.variables = { 1 };
		double at = 0, time = rng.uniform( 0, 1.5 );
		for ( int k = 0; k < 4; ++k )
		{
			OwnedPiece piece = {
			    time, time + rng.uniform( 0.05, 0.8 ), static_cast<unsigned>( rng.integer( 0, 7 ) ), { at } };
			for ( unsigned p = 0; p < piece.degree; ++p )
			{
				piece.points.push_back( at += rng.uniform( -0.2, 0.2 ) );
			}
			time = piece.end;
			other.pieces.push_back( piece );
		}
		clock.tracks = { ball, other };
		const lw_timed_result r = bench.ask( clock, 0, 4, toTheMillisecond() );
		EXPECT_FALSE( gap < 0 && r.verdict == LW_VERDICT_FREE ) << "far " << far << ", gap " << gap;
		EXPECT_TRUE( gap < 1e-3 || r.verdict == LW_VERDICT_FREE ) << "far " << far << ", gap " << gap;
		free += r.verdict == LW_VERDICT_FREE;
		const lw_clock view = clock.view();
		double state[2];
		const double when = rng.uniform( 0, 4 );
		ASSERT_EQ( lw_clock_state( bench.checker.get(), &view, when, state ), LW_OK );
		EXPECT_NEAR( state[0], clock.tracks[0].at( 0, when ), 1e-12 );
		EXPECT_NEAR( state[1], clock.tracks[1].at( 0, when ), 1e-12 );
	}
	EXPECT_GT( free, 50 );
}
