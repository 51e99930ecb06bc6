// SPDX-License-Identifier: BSD-3-Clause
// Errors of frames in closed form: a hair within the limit is proved, a hair beyond it is found.
#include "region_bench.hpp"

namespace
{

constexpr double hair = 1e-9;

/// One joint that turns about z, a tip at a radius.
RobotPtr turntable( lw_joint_type type = LW_JOINT_REVOLUTE )
{
	RobotModel model;
	model.link( "world" );
	addJoint( model, "arm", type, 0, 2 );
	return model.create();
}

lw_transform at( double x, double y, double z )
{
	lw_transform m = lw_transform_identity();
	m.t[0] = x;
	m.t[1] = y;
	m.t[2] = z;
	return m;
}

lw_transform turned( double x, double y, double z, double yaw )
{
	const double p[3] = { x, y, z }, rpy[3] = { 0, 0, yaw };
	lw_transform m;
	lw_transform_from_rpy( p, rpy, &m );
	return m;
}

lw_region_def ofTip( double radius )
{
	lw_region_def def = lw_region_def_default();
	def.link = 1;
	def.link_from_b = at( radius, 0, 0 );
	return def;
}

void limitPosition( lw_region_def& def, double tolerance )
{
	for ( int i = 0; i < 3; ++i )
	{
		def.lower[i] = -tolerance;
		def.upper[i] = tolerance;
	}
}

} // namespace

TEST( Region, ATurningArmIsOnItsCircleToRounding )
{
	const RobotPtr robot = turntable();
	const RegionBench bench( robot.get() );
	lw_region_def def = ofTip( 0.7 );
	const lw_transform from = turned( 0.7, 0, 0, 0 ), to = turned( 0.7 * std::cos( 2 ), 0.7 * std::sin( 2 ), 0, 2 );
	ASSERT_EQ( LW_OK, lw_region_arc( &def, &from, { 0.7 * std::cos( 0.6 ), 0.7 * std::sin( 0.6 ), 0 }, &to ) );
	EXPECT_NEAR( 2, def.arc.z, 1e-12 );
	limitPosition( def, 1e-9 );
	def.angle = 1e-7;
	const std::vector<double> points = { 0, 0.9, 1.1, 2 };
	OwnedClock clock = onePiece( 1, 3, points );
	const lw_region_result r = bench.ask( def, clock, fractionOf( 3, { 0, 0.45, 0.55, 1 } ), 0, 1 );
	EXPECT_EQ( LW_VERDICT_FREE, r.verdict );
	EXPECT_EQ( 1, r.time );
	EXPECT_LT( r.upper[LW_REGION_X], 1e-9 );
	// the same arc with other timing is not kept, though the path is
	const lw_region_result late = bench.ask( def, clock, fractionOf( 1, { 0, 1 } ), 0, 1 );
	EXPECT_EQ( LW_VERDICT_BLOCKED, late.verdict );
}

TEST( Region, AnArcGoesTheWayThroughItsPoint )
{
	lw_region_def def = lw_region_def_default();
	const lw_transform from = at( 1, 0, 0 ), to = at( 0, 1, 0 );
	ASSERT_EQ( LW_OK, lw_region_arc( &def, &from, { -1, 0, 0 }, &to ) );
	EXPECT_NEAR( -1.5 * M_PI, def.arc.z, 1e-12 );
	const lw_transform middle = lw_region_reference( &def, 2.0 / 3 ), end = lw_region_reference( &def, 1 );
	EXPECT_NEAR( -1, middle.t[0], 1e-12 );
	EXPECT_NEAR( 0, end.t[0], 1e-12 );
	EXPECT_NEAR( 1, end.t[1], 1e-12 );
}

TEST( Region, ASagittaIsProvedAndFoundToAHair )
{
	const RobotPtr robot = turntable();
	const RegionBench bench( robot.get() );
	const double radius = 0.5, half = 0.3, sagitta = radius * ( 1 - std::cos( half ) );
	OwnedClock clock = onePiece( 1, 1, { -half, half } );
	lw_region_def def = ofTip( radius );
	def.start = at( radius * std::cos( half ), 0, 0 ); // the chord: x is constant, y is free
	def.lower[0] = -hair;
	def.upper[0] = sagitta + hair;
	const lw_region_result kept = bench.ask( def, clock, {}, 0, 1 );
	EXPECT_EQ( LW_VERDICT_FREE, kept.verdict );
	EXPECT_GE( kept.upper[LW_REGION_X], sagitta );
	def.upper[0] = sagitta - hair;
	const lw_region_result broken = bench.ask( def, clock, {}, 0, 1 );
	EXPECT_EQ( LW_VERDICT_BLOCKED, broken.verdict );
	EXPECT_EQ( LW_REGION_X, broken.limit );
	EXPECT_NEAR( 0.5, broken.time, 0.01 );
	EXPECT_NEAR( hair, broken.excess, hair );
	EXPECT_LE( broken.proved_until, broken.time );
	EXPECT_GT( broken.proved_until, 0.45 );
}

TEST( Region, ACupThatTiltsIsFoundAtItsLargestAngle )
{
	RobotModel model;
	model.link( "world" );
	addJoint( model, "lift", LW_JOINT_PRISMATIC, 0, 2 );
	addJoint( model, "tilt", LW_JOINT_REVOLUTE, 1, 0 );
	addJoint( model, "spin", LW_JOINT_CONTINUOUS, 2, 2 );
	const RobotPtr robot = model.create();
	const RegionBench bench( robot.get() );
	// 4 k t (1 - t) has its largest value k at 1/2; control points 0, 2 k, 0
	const double most = 0.2;
	OwnedClock clock = onePiece( 3, 2, { 0, 0, 0, 1, 2 * most, 9, 2, 0, 1 } );
	lw_region_def def = lw_region_def_default();
	def.link = 3;
	def.tilt = most + hair;
	EXPECT_EQ( LW_VERDICT_FREE, bench.ask( def, clock, {}, 0, 1 ).verdict );
	def.tilt = most - hair;
	const lw_region_result broken = bench.ask( def, clock, {}, 0, 1 );
	EXPECT_EQ( LW_VERDICT_BLOCKED, broken.verdict );
	EXPECT_EQ( LW_REGION_TILT, broken.limit );
	EXPECT_NEAR( most, broken.value, 2 * hair );
}

TEST( Region, TwoHandsHoldOneTray )
{
	RobotModel model;
	model.link( "world" );
	for ( int arm = 0; arm < 2; ++arm ) // each turns its shoulder and its hand back by as much
	{
		const std::string name = arm == 0 ? "left" : "right";
		addJoint( model, ( name + "_shoulder" ).c_str(), LW_JOINT_REVOLUTE, 0, 2 );
		model.joints.back().parent_from_joint.t[1] = arm == 0 ? 0.4 : -0.4;
		addJoint( model, ( name + "_hand" ).c_str(), LW_JOINT_REVOLUTE, model.joints.back().child, 2 );
		model.joints.back().parent_from_joint.t[0] = 0.6;
	}
	const RobotPtr robot = model.create();
	const RegionBench bench( robot.get() );
	lw_region_def def = lw_region_def_default();
	def.base_link = 2;
	def.link = 4;
	def.start = at( 0, -0.8, 0 );
	limitPosition( def, 1e-6 );
	def.angle = 1e-6;
	OwnedClock clock = onePiece( 4, 1, { 0, 0, 0, 0, 1, -1, 1, -1 } );
	const lw_region_result kept = bench.ask( def, clock, {}, 0, 1 );
	EXPECT_EQ( LW_VERDICT_FREE, kept.verdict );
	clock = onePiece( 4, 1, { 0, 0, 0, 0, 1, -1, 1, -1 - 1e-5 } );
	const lw_region_result broken = bench.ask( def, clock, {}, 0, 1 );
	EXPECT_EQ( LW_VERDICT_BLOCKED, broken.verdict );
	EXPECT_EQ( LW_REGION_ANGLE, broken.limit );
}

TEST( Region, AToleranceIsProvedToo )
{
	const RobotPtr robot = turntable();
	const RegionBench bench( robot.get() );
	OwnedClock clock = onePiece( 1, 1, { -0.2, 0.2 } );
	clock.tracks[0].tolerance = { 0.01 };
	lw_region_def def = ofTip( 1 );
	def.angle = 0.2 + 0.0101;
	EXPECT_EQ( LW_VERDICT_FREE, bench.ask( def, clock, {}, 0, 1 ).verdict );
	def.angle = 0.2 + 0.0099; // the tracks keep it, motions near them do not
	EXPECT_EQ( LW_VERDICT_UNDECIDED, bench.ask( def, clock, {}, 0, 1 ).verdict );
	def.angle = INFINITY;
	def.lower[1] = -std::sin( 0.2 ) - 0.0101;
	EXPECT_EQ( LW_VERDICT_FREE, bench.ask( def, clock, {}, 0, 1 ).verdict );
	def.lower[1] = -std::sin( 0.2 ) - 0.0095;
	EXPECT_EQ( LW_VERDICT_UNDECIDED, bench.ask( def, clock, {}, 0, 1 ).verdict );
}

TEST( Region, ALateTrackIsWhereItWas )
{
	const RobotPtr robot = turntable();
	const RegionBench bench( robot.get() );
	OwnedClock clock = onePiece( 1, 1, { 0, 1 } );
	clock.tracks[0].lag = 0.05;
	lw_region_def def = ofTip( 1 );
	def.turn = { 0, 0, 1 };
	def.angle = 0.0501;
	EXPECT_EQ( LW_VERDICT_FREE, bench.ask( def, clock, fractionOf( 1, { 0, 1 } ), 0, 1 ).verdict );
	def.angle = 0.0499;
	EXPECT_EQ( LW_VERDICT_UNDECIDED, bench.ask( def, clock, fractionOf( 1, { 0, 1 } ), 0, 1 ).verdict );
}

TEST( Region, TurnsOfMoreThanARightAngleAreRead )
{
	const RobotPtr robot = turntable( LW_JOINT_CONTINUOUS );
	const RegionBench bench( robot.get() );
	OwnedClock clock = onePiece( 1, 1, { 0, 3 } );
	for ( const lw_turns kind : { LW_TURNS_VECTOR, LW_TURNS_XYZ } )
	{
		lw_region_def def = ofTip( 1 );
		def.turns_are = kind;
		def.turns[0] = def.turns[1] = 1e-3;
		def.turns[2] = 3 + hair;
		EXPECT_EQ( LW_VERDICT_FREE, bench.ask( def, clock, {}, 0, 1 ).verdict ) << kind;
		def.turns[2] = 3 - 2e-9;
		EXPECT_EQ( LW_VERDICT_BLOCKED, bench.ask( def, clock, {}, 0, 1 ).verdict ) << kind;
	}
}

TEST( Region, AFreeTurnAboutOneAxisGoesAllTheWayRound )
{
	const RobotPtr robot = turntable( LW_JOINT_CONTINUOUS );
	const RegionBench bench( robot.get() );
	OwnedClock clock = onePiece( 1, 1, { 0, 20 } );
	lw_region_def def = ofTip( 1 );
	def.turns_are = LW_TURNS_XYZ;
	def.turns[0] = def.turns[1] = 1e-3;
	EXPECT_EQ( LW_VERDICT_FREE, bench.ask( def, clock, {}, 0, 1 ).verdict );
	def.turns_are = LW_TURNS_VECTOR;
	EXPECT_EQ( LW_VERDICT_FREE, bench.ask( def, clock, {}, 0, 1 ).verdict );
	def.turns[0] = def.turns[1] = INFINITY;
	def.tilt = 1e-3;
	EXPECT_EQ( LW_VERDICT_FREE, bench.ask( def, clock, {}, 0, 1 ).verdict );
}

TEST( Region, HalfATurnIsNoLimit )
{
	const RobotPtr robot = turntable( LW_JOINT_CONTINUOUS );
	const RegionBench bench( robot.get() );
	OwnedClock clock = onePiece( 1, 1, { 0, 20 } );
	lw_region_def def = ofTip( 1 );
	def.upper[0] = 2;
	def.angle = def.tilt = def.turns[2] = M_PI;
	EXPECT_EQ( LW_VERDICT_FREE, bench.ask( def, clock, {}, 0, 1 ).verdict );
	def.angle = 3.14;
	EXPECT_EQ( LW_VERDICT_BLOCKED, bench.ask( def, clock, {}, 0, 1 ).verdict );
}

TEST( Region, AnErrorAtItsLimitIsUndecidedAndEnds )
{
	RobotModel model;
	model.link( "world" );
	addJoint( model, "rail", LW_JOINT_PRISMATIC, 0, 0 );
	const RobotPtr robot = model.create();
	const RegionBench bench( robot.get() );
	OwnedClock clock = onePiece( 1, 1, { 0.25, 0.25 } );
	lw_region_def def = lw_region_def_default();
	def.link = 1;
	def.upper[0] = 0.25;
	const lw_region_result r = bench.ask( def, clock, {}, 0, 1 );
	EXPECT_EQ( LW_VERDICT_UNDECIDED, r.verdict );
	EXPECT_LT( r.windows, 200u );
}

TEST( Region, ABrokenSecondPieceHasItsTimeOnTheClock )
{
	const RobotPtr robot = turntable();
	const RegionBench bench( robot.get() );
	OwnedClock clock = onePiece( 1, 1, { 0, 0.1 } );
	clock.tracks[0].pieces.push_back( { 3, 5, 1, { 0.1, 0.3 } } );
	lw_region_def def = ofTip( 1 );
	def.angle = 0.2;
	EXPECT_EQ( LW_VERDICT_FREE, bench.ask( def, clock, {}, 0, 3.9 ).verdict );
	const lw_region_result r = bench.ask( def, clock, {}, -1, 9 );
	EXPECT_EQ( LW_VERDICT_BLOCKED, r.verdict );
	EXPECT_GE( r.proved_until, 3 );
	EXPECT_GT( r.time, 4 );
	EXPECT_LE( r.time, 5 );
	EXPECT_EQ( LW_VERDICT_FREE, bench.ask( def, clock, {}, 0.5, 0.5 ).verdict ); // one state
}

TEST( Region, AStateHasItsErrors )
{
	const RobotPtr robot = turntable();
	const RegionBench bench( robot.get() );
	lw_region_def def = ofTip( 2 );
	def.start = turned( 1, 0, 0, M_PI / 2 ); // its x axis is the world's y
	def.lower[0] = -0.5;
	def.angle = 1;
	const RegionPtr region = bench.region( def );
	const double q = 0.5;
	lw_region_errors e;
	ASSERT_EQ( LW_OK, lw_region_state( region.get(), &q, 0, &e ) );
	EXPECT_NEAR( 2 * std::sin( 0.5 ), e.value[LW_REGION_X], 1e-14 );
	EXPECT_NEAR( 1 - 2 * std::cos( 0.5 ), e.value[LW_REGION_Y], 1e-14 );
	EXPECT_NEAR( M_PI / 2 - 0.5, e.value[LW_REGION_ANGLE], 1e-14 );
	EXPECT_NEAR( 0.5 - M_PI / 2, e.value[LW_REGION_TURN_Z], 1e-14 );
	EXPECT_EQ( LW_REGION_ANGLE, e.worst );
	EXPECT_NEAR( M_PI / 2 - 1.5, e.excess[LW_REGION_ANGLE], 1e-14 );
	EXPECT_NEAR( 2 * std::cos( 0.5 ), e.pose.t[0], 1e-14 );
}
