// SPDX-License-Identifier: BSD-3-Clause
// Pairs of links: no separation that an attack can undercut, good separations where the truth is known, honest classes.
#include "pair_world.hpp"

TEST( ReachPairs, RandomRobotsNoStateIsNearerThanTheSeparation )
{
	SeededRng rng;
	int proved = 0, bySubdivision = 0, contacts = 0, unproved = 0;
	for ( int round = 0; round < 24; ++round )
	{
		RobotPtr robot = randomSparseRobot( rng, round % 2 == 0 );
		ASSERT_NE( robot, nullptr );
		ReachPtr reach = makeReach( robot.get(), 0.15, 50 );
		ASSERT_NE( reach, nullptr );
		PairAttacker attacker( reach.get(), rng.engine()() );
		for ( std::uint32_t a = 0; a < lw_robot_link_count( robot.get() ); ++a )
		{
			for ( std::uint32_t b = 0; b < a; ++b )
			{
				lw_reach_pair pair = pairOf( reach, a, b );
				if ( pair.kind == LW_PAIR_NONE || pair.kind == LW_PAIR_RIGID )
				{
					EXPECT_FALSE( std::isfinite( pair.closest ) );
					continue;
				}
				attacker.checkEvidence( a, b );
				EXPECT_EQ( pair.proof == LW_PROOF_NONE, pair.separation <= 0 );
				contacts += pair.closest <= 0;
				unproved += pair.closest > 0 && pair.separation <= 0;
				if ( pair.separation > 0 )
				{
					++proved;
					bySubdivision += pair.proof == LW_PROOF_SUBDIVISION;
					EXPECT_GE( attacker.attack( a, b, 60, 120 ), pair.separation - ROUNDING )
					    << "round " << round << ", links " << a << " " << b << ", " << lw_pair_proof_name( pair.proof );
				}
			}
		}
	}
	std::printf(
	    "%d proved, %d of them by subdivision; %d in contact, %d open\n", proved, bySubdivision, contacts, unproved );
	EXPECT_GE( proved, 100 );
	EXPECT_GE( bySubdivision, 5 ); // few: it depends on the machine
	EXPECT_GE( contacts, 40 );
}

TEST( ReachPairs, PlanarArmSeparationIsGood )
{
	int proved = 0;
	for ( auto limits : { std::pair<double, double>{ 0.5, 0.5 }, { 1.0, 1.5 }, { 2.5, 1.0 }, { 1.2, 1.9 }, { 1.5, 2.1 } } )
	{
		PlanarArm arm( limits.first, limits.second );
		double truth = PlanarArm::truth( limits.first, limits.second );
		ASSERT_GT( truth, 0.01 ) << "the arm's truth is contact: choose other limits";
		RobotPtr robot = arm.model.create();
		ReachPtr reach = makeReach( robot.get(), 5 );
		lw_reach_pair pair = pairOf( reach, arm.base, arm.tip );
		EXPECT_EQ( pair.kind, LW_PAIR_NEVER );
		EXPECT_EQ( pair.variable_count, 2u );
		EXPECT_GE( pair.separation, 0.5 * truth );
		EXPECT_LE( pair.separation, truth );
		EXPECT_GE( pair.closest, truth - 0.002 );
		proved += pair.separation > 0;
	}
	EXPECT_EQ( proved, 5 );
}

// With a first guess of a hundred metres nothing but the cells' own centres tells where the pair is near: a part of the box
// that is not covered shows as a separation above the truth.
TEST( ReachPairs, SubdivisionAloneFindsTheLeastDistance )
{
	uint64_t cells = 0;
	for ( auto limits : { std::pair<double, double>{ 0.5, 0.5 }, { 1.0, 1.5 }, { 2.5, 1.0 }, { 1.2, 1.9 }, { 1.5, 2.6 } } )
	{
		PlanarArm arm( limits.first, limits.second );
		double truth = PlanarArm::truth( limits.first, limits.second );
		RobotPtr robot = arm.model.create();
		ReachPtr reach = makeReach( robot.get(), 0, 0 );
		double separation = subdivide( reach.get(), arm.base, arm.tip, 0.9, 100, 1000000, &cells );
		EXPECT_GE( separation, 0.8 * truth );
		EXPECT_LE( separation, truth );
		EXPECT_EQ( subdivide( reach.get(), arm.tip, arm.base, 0.9, 100, cells / 2, &cells ), 0.0 )
		    << "half of the cells prove nothing";
	}
	// A wheel without limits: one place of the rim is nearest, wherever that is
	for ( int place = 0; place < 12; ++place )
	{
		RobotModel model;
		model.link( "base" );
		addBall( model, 0, 0.1 );
		addJoint( model, "wheel", LW_JOINT_CONTINUOUS, 0, 1, 0, 0 );
		double angle = place * M_PI / 6 + 0.1;
		addBall( model, 1, 0.1, 0.5 * std::cos( angle ), 0.5 * std::sin( angle ) );
		RobotPtr robot = model.create();
		ReachPtr reach = makeReach( robot.get(), 0, 0 );
		double separation = subdivide( reach.get(), 0, 1, 0.99, 100, 1000000, &cells );
		EXPECT_GE( separation, 0.95 * 0.3 ) << place;
		EXPECT_LE( separation, 0.3 ) << place;
	}
}

// A wheel turns around the base with a gap that stays the same. All of 0.2 mm is of no use to an edge, and took most of the time.
TEST( ReachPairs, ASeparationIsNotRaisedByLessThanEdgesUse )
{
	for ( double gap : { 2e-4, 2e-3 } )
	{
		RobotModel model;
		model.link( "base" );
		addBall( model, 0, 0.1 );
		addJoint( model, "wheel", LW_JOINT_CONTINUOUS, 0, 0, 0, 0 );
		addBall( model, 1, 0.1, 0.2 + gap );
		RobotPtr robot = model.create();
		ReachPtr reach = makeReach( robot.get(), 60 );
		const lw_reach_pair pair = pairOf( reach, 0, 1 );
		EXPECT_TRUE( lw_reach_get_info( reach.get() ).complete ) << gap;
		EXPECT_NEAR( pair.closest, gap, 1e-9 );
		EXPECT_GT( pair.separation, 0 ) << gap;
		EXPECT_EQ( pair.separation > 0.2 * gap, gap > 1e-3 ) << pair.separation;
	}
}

TEST( ReachPairs, ContactInACornerOfTheBoxIsFound )
{
	// both joints must be within a few percent of their limits
	PlanarArm arm( 2.1, 1.45 ); // contact in 1e-4 of the box
	ASSERT_LT( PlanarArm::distance( 2.1, 1.45 ), 0.0 );
	ASSERT_GT( std::min( PlanarArm::distance( 2.0, 1.45 ), PlanarArm::distance( 2.1, 1.38 ) ), 0.0 );
	RobotPtr robot = arm.model.create();
	for ( std::uint32_t samples : { 0u, 20u } )
	{
		ReachPtr reach = makeReach( robot.get(), 30, samples );
		lw_reach_pair pair = pairOf( reach, arm.base, arm.tip );
		EXPECT_EQ( pair.kind, LW_PAIR_CHECK );
		EXPECT_EQ( pair.separation, 0.0 );
		EXPECT_EQ( pair.closest, 0.0 );
	}
}

TEST( ReachPairs, ContactInTheMarginOutsideTheLimitsIsNoNever )
{
	// The ball on the slider stops half a micrometre short of the other one; the range that is proved is 0.1 mm wider
	RobotModel model;
	model.link( "base" );
	addBall( model, 0, 0.1 );
	addJoint( model, "pin", LW_JOINT_REVOLUTE, 0, 0, -0.1, 0.1 );
	addPin( model, 1 );
	addJoint( model, "slider", LW_JOINT_PRISMATIC, 1, 1, -0.8 + 5e-7, 0 );
	addBall( model, 2, 0.1 );
	RobotPtr robot = model.create();
	ReachPtr reach = makeReach( robot.get(), 30 );
	lw_reach_pair pair = pairOf( reach, 0, 2 );
	EXPECT_EQ( pair.kind, LW_PAIR_CHECK );
	EXPECT_GT( pair.closest, 0.0 );
	EXPECT_LT( pair.closest, 1e-5 );
	EXPECT_EQ( pair.separation, 0.0 );
	PairAttacker( reach.get(), 1 )
	    .checkEvidence( 2, 0 ); // in the order in which it was measured: the other one rounds otherwise
}

TEST( ReachPairs, MimicCouplingKeepsApartLinksThatWouldMeetWithoutIt )
{
	for ( int chain = 0; chain < 3; ++chain ) // independent, following, following the follower
	{
		RobotModel model;
		model.link( "base" );
		addJoint( model, "first", LW_JOINT_PRISMATIC, 0, 0, 0, 1 );
		addBall( model, 1, 0.1 );
		addJoint( model, "between", LW_JOINT_PRISMATIC, 0, 0, 0, 1 );
		addJoint( model, "last", LW_JOINT_PRISMATIC, 0, 0.3, 0, 1 );
		addBall( model, 3, 0.1 );
		if ( chain > 0 )
		{
			model.joints[2].mimic = 0;
			model.joints[2].mimic_multiplier = 1;
		}
		if ( chain == 2 )
		{
			model.joints[1].mimic = 0;
			model.joints[1].mimic_multiplier = 2;
			model.joints[2].mimic = 1;
			model.joints[2].mimic_multiplier = 0.5;
		}
		RobotPtr robot = model.create();
		ASSERT_NE( robot, nullptr );
		ReachPtr reach = makeReach( robot.get(), 2 );
		lw_reach_pair pair = pairOf( reach, 1, 3 );
		EXPECT_EQ( pair.kind, chain == 0 ? LW_PAIR_CHECK : LW_PAIR_NEVER ) << chain;
		EXPECT_EQ( pair.variable_count, chain == 0 ? 2u : 1u );
		if ( chain == 0 )
		{
			EXPECT_EQ( pair.closest, 0.0 );
		}
		else
		{
			EXPECT_NEAR( pair.closest, 0.1, 1e-9 );
			EXPECT_GE( pair.separation, 0.05 );
			EXPECT_EQ( pair.proof, LW_PROOF_SUBDIVISION ) << "hulls do not know of the coupling";
		}
	}
}

TEST( ReachPairs, JointsWithoutLimits )
{
	// A wheel turns freely in front of a ball: all its states are proved although it has no limits
	RobotModel model;
	model.link( "base" );
	addBall( model, 0, 0.1 );
	addJoint( model, "pin", LW_JOINT_REVOLUTE, 0, 1, -0.1, 0.1 );
	addPin( model, 1 );
	addJoint( model, "wheel", LW_JOINT_CONTINUOUS, 1, 0, 0, 0 );
	addBall( model, 2, 0.1, 0.5 );
	// A slider without limits passes the base
	addJoint( model, "slider", LW_JOINT_PRISMATIC, 1, 0.5, -INFINITY, INFINITY );
	addBall( model, 3, 0.1, 0, 0.5, 0 );
	RobotPtr robot = model.create();
	ReachPtr reach = makeReach( robot.get(), 2 );
	lw_reach_pair wheel = pairOf( reach, 0, 2 ), slider = pairOf( reach, 0, 3 );
	EXPECT_EQ( wheel.kind, LW_PAIR_NEVER );
	EXPECT_GT( wheel.separation, 0.15 );
	EXPECT_LT( wheel.separation, 0.31 );
	EXPECT_GE( PairAttacker( reach.get(), 2 ).attack( 0, 2, 200, 200 ), wheel.separation );
	EXPECT_EQ( slider.kind, LW_PAIR_CHECK ) << "nothing is proved over an endless range";
	EXPECT_EQ( slider.separation, 0.0 );
	EXPECT_TRUE( std::isfinite( slider.closest ) );
}

TEST( ReachPairs, HalfOfAnEndlessAngleIsNoAngle )
{
	// The hand follows the wheel by one half: within one turn of the wheel it stays on its side, after two it has been
	// everywhere
	for ( lw_joint_type type : { LW_JOINT_CONTINUOUS, LW_JOINT_REVOLUTE } )
	{
		RobotModel model;
		model.link( "base" );
		addBall( model, 0, 0.1, -0.5 );
		addJoint( model, "wheel", type, 0, 0, -2 * M_PI, 2 * M_PI );
		addPin( model, 1 );
		addJoint( model, "pin", LW_JOINT_REVOLUTE, 0, 0, 0, 0 );
		addPin( model, 2 );
		addJoint( model, "hand", LW_JOINT_CONTINUOUS, 2, 0, 0, 0 );
		model.joints[2].mimic = 0;
		model.joints[2].mimic_multiplier = 0.5;
		addBall( model, 3, 0.1, 0.5 );
		RobotPtr robot = model.create();
		ASSERT_NE( robot, nullptr );
		ReachPtr reach = makeReach( robot.get(), 0.5, 0 );
		lw_reach_pair pair = pairOf( reach, 0, 3 );
		EXPECT_EQ( pair.kind, LW_PAIR_CHECK );
		EXPECT_EQ( pair.separation, 0.0 );
	}
}

// Seven turns stand with one, seen from the middle of their limits: the evidence may not be a turn beyond them.
TEST( ReachPairs, AllTurnsOfARangeAreProvedWithOne )
{
	for ( double lower : { 0.5, -30.0, -44.0 } )
	{
		RobotModel model;
		model.link( "base" );
		addBall( model, 0, 0.1 );
		addJoint( model, "pin", LW_JOINT_REVOLUTE, 0, 1, -0.1, 0.1 );
		addPin( model, 1 );
		addJoint( model, "wheel", LW_JOINT_REVOLUTE, 1, 0, lower, lower + 14 * M_PI );
		addBall( model, 2, 0.1, 0.5 );
		RobotPtr robot = model.create();
		ReachPtr reach = makeReach( robot.get(), 60 );
		lw_reach_pair pair = pairOf( reach, 0, 2 );
		EXPECT_TRUE( lw_reach_get_info( reach.get() ).complete );
		EXPECT_EQ( pair.kind, LW_PAIR_NEVER );
		EXPECT_NEAR( pair.closest, 0.3, 0.01 );
		EXPECT_GT( pair.separation, 0.2 );
		PairAttacker attacker( reach.get(), 2 );
		attacker.checkEvidence( 2, 0 );
		EXPECT_GE( attacker.attack( 0, 2, 200, 200 ), pair.separation );
	}
}

TEST( ReachPairs, LimitsReversedAreRefusedByTheRobot )
{
	RobotModel model;
	model.link( "base" );
	addJoint( model, "arm", LW_JOINT_REVOLUTE, 0, 1, 0.5, -0.5 );
	lw_robot* robot = nullptr;
	lw_diag diag = {};
	EXPECT_EQ( model.create( &robot, &diag ), LW_ERROR_INVALID_ARGUMENT );
	EXPECT_EQ( robot, nullptr );
	EXPECT_NE( std::string( diag.message ).find( "j_arm" ), std::string::npos ) << diag.message;
}

TEST( ReachPairs, ZeroLengthLinksAndJointsThatCannotMove )
{
	// A wrist: three joints in one point, links of no length; and a joint whose limits leave it one value
	RobotModel model;
	model.link( "base" );
	addBall( model, 0, 0.1 );
	const double axes[3][3] = { { 0, 0, 1 }, { 0, 1, 0 }, { 1, 0, 0 } };
	for ( std::uint32_t i = 0; i < 3; ++i )
	{
		const char* names[3] = { "a", "b", "c" };
		lw_joint_def& joint = addJoint( model, names[i], LW_JOINT_REVOLUTE, i, i == 0 ? 0.5 : 0, -2, 2 );
		std::copy( axes[i], axes[i] + 3, joint.axis );
	}
	addBall( model, 3, 0.1, 0.2 );
	addJoint( model, "stuck", LW_JOINT_REVOLUTE, 3, 0.3, 0.25, 0.25 );
	addBall( model, 4, 0.05 );
	RobotPtr robot = model.create();
	ReachPtr reach = makeReach( robot.get(), 1 );
	lw_reach_pair hand = pairOf( reach, 0, 3 ), stuck = pairOf( reach, 0, 4 );
	EXPECT_TRUE( hand.adjacent ) << "links without geometry in between are skipped";
	EXPECT_EQ( hand.kind, LW_PAIR_ADJACENT );
	EXPECT_GT( hand.separation, 0.0 );
	EXPECT_FALSE( stuck.adjacent );
	EXPECT_EQ( stuck.kind, LW_PAIR_NEVER );
	EXPECT_EQ( lw_reach_get_pair( reach.get(), 0, 1 ).kind, LW_PAIR_NONE );
	EXPECT_EQ( lw_reach_get_pair( reach.get(), 2, 2 ).kind, LW_PAIR_NONE );
	PairAttacker attacker( reach.get(), 3 );
	EXPECT_GE( attacker.attack( 0, 3, 200, 300 ), hand.separation - ROUNDING );
	EXPECT_GE( attacker.attack( 0, 4, 200, 300 ), stuck.separation - ROUNDING );
}

TEST( ReachPairs, ClassesInTheirOrder )
{
	RobotModel model;
	model.link( "base" );
	addBall( model, 0, 0.2 );
	addJoint( model, "pin", LW_JOINT_REVOLUTE, 0, 0, -0.5, 0.5 );
	addPin( model, 1 );
	addJoint( model, "inside", LW_JOINT_REVOLUTE, 1, 0, -1, 1 ); // never leaves the base
	addBall( model, 2, 0.1, 0.1 );
	addJoint( model, "flap", LW_JOINT_PRISMATIC, 1, 0, 0.31, 0.5 ); // apart, then in contact below 0.3: never
	addBall( model, 3, 0.1 );
	addJoint( model, "mostly", LW_JOINT_PRISMATIC, 1, 0, -0.2, 0.31 ); // in contact but at its upper end
	addBall( model, 4, 0.1 );
	addJoint( model, "plate", LW_JOINT_FIXED, 0, 0, 0, 0 );
	addBall( model, 5, 0.1, 0, 0, 1 );
	model.allowed.push_back( { 0, 4 } );
	model.allowed.push_back( { 0, 5 } );
	RobotPtr robot = model.create();
	ReachPtr reach = makeReach( robot.get(), 5 );
	EXPECT_EQ( pairOf( reach, 0, 1 ).kind, LW_PAIR_ADJACENT );
	EXPECT_EQ( pairOf( reach, 0, 2 ).kind, LW_PAIR_ALWAYS );
	EXPECT_EQ( pairOf( reach, 0, 2 ).contact_share, 1.0 );
	EXPECT_EQ( pairOf( reach, 0, 3 ).kind, LW_PAIR_NEVER );
	EXPECT_EQ( pairOf( reach, 0, 4 ).kind, LW_PAIR_ALLOWED );
	EXPECT_NEAR( pairOf( reach, 0, 4 ).contact_share, 0.5 / 0.51, 0.05 );
	EXPECT_EQ( pairOf( reach, 2, 4 ).kind, LW_PAIR_CHECK ) << "contact in most states is not contact in every state";
	lw_reach_pair rigid = pairOf( reach, 0, 5 );
	EXPECT_EQ( rigid.kind, LW_PAIR_RIGID );
	EXPECT_TRUE( rigid.adjacent );
	EXPECT_TRUE( rigid.allowed );
	// ALWAYS rests on samples
	EXPECT_EQ( pairOf( makeReach( robot.get(), 0, 0 ), 0, 2 ).kind, LW_PAIR_CHECK );
}
