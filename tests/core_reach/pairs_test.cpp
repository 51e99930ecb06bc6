// SPDX-License-Identifier: BSD-3-Clause
// Pairs of links: no separation that an attack can undercut, good separations where the truth is known, honest classes.
#include "pair_probe.h"
#include "random_robot.hpp"
#include "reach_attack.hpp"

#include <cstdlib>
#include <thread>

namespace
{

constexpr double ROUNDING = 1e-9; ///< metres: an attack may find this much below a separation

lw_transform at( double x, double y, double z )
{
	lw_transform m = lw_transform_identity();
	m.t[0] = x;
	m.t[1] = y;
	m.t[2] = z;
	return m;
}

/// Adds a ball to a link.
void addBall( RobotModel& model, std::uint32_t link, double radius, double x = 0, double y = 0, double z = 0 )
{
	double dimensions[3] = { radius, 0, 0 };
	lw_shape* shape = nullptr;
	ASSERT_EQ( lw_shape_create_primitive( LW_SHAPE_SPHERE, dimensions, nullptr, nullptr, &shape ), LW_OK );
	model.body( link, shape, at( x, y, z ) );
}

/// A joint about z (or along x, if prismatic) at x = offset of its parent.
lw_joint_def& addJoint( RobotModel& model, const char* name, lw_joint_type type, std::uint32_t parent, double offset,
	double lower, double upper )
{
	lw_joint_def& joint = model.joint( name, type, parent );
	joint.parent_from_joint = at( offset, 0, 0 );
	if ( type == LW_JOINT_PRISMATIC )
	{
		joint.axis[0] = 1;
		joint.axis[2] = 0;
	}
	joint.lower = lower;
	joint.upper = upper;
	return joint;
}

/// A pin in an arm, so that the links on both sides of it are not adjacent: below everything else.
void addPin( RobotModel& model, std::uint32_t link )
{
	addBall( model, link, 1e-3, 0, 0, -5 );
}

/// A ball of 0.1 at the origin; two joints about z, 0.4 and then 0.3 from each other; a ball of 0.05 another 0.35 further.
struct PlanarArm
{
	RobotModel model;
	std::uint32_t base = 0, upper = 1, tip = 2;

	PlanarArm( double shoulder, double elbow )
	{
		model.link( "base" );
		addBall( model, base, 0.1 );
		addJoint( model, "upper", LW_JOINT_REVOLUTE, base, 0.4, -shoulder, shoulder );
		addPin( model, upper );
		addJoint( model, "tip", LW_JOINT_REVOLUTE, upper, 0.3, -elbow, elbow );
		addBall( model, tip, 0.05, 0.35 );
	}

	static double distance( double a, double b )
	{
		double x = 0.4 + 0.3 * std::cos( a ) + 0.35 * std::cos( a + b );
		double y = 0.3 * std::sin( a ) + 0.35 * std::sin( a + b );
		return std::hypot( x, y ) - 0.15;
	}

	/// The least distance on a grid of a thousand values per joint: too large by less than 0.7 m * 0.002.
	static double truth( double shoulder, double elbow )
	{
		double least = INFINITY;
		for ( int i = 0; i <= 1000; ++i )
		{
			for ( int j = 0; j <= 1000; ++j )
			{
				least = std::min( least, distance( shoulder * ( i / 500.0 - 1 ), elbow * ( j / 500.0 - 1 ) ) );
			}
		}
		return least;
	}
};

lw_reach_pair pairOf( const ReachPtr& reach, std::uint32_t a, std::uint32_t b )
{
	lw_reach_pair pair = lw_reach_get_pair( reach.get(), a, b );
	lw_reach_pair swapped = lw_reach_get_pair( reach.get(), b, a );
	EXPECT_EQ( pair.kind, swapped.kind );
	EXPECT_EQ( pair.separation, swapped.separation );
	return pair;
}

/// Counts bytes; fails at call number `failAt`.
struct FailingMemory
{
	std::size_t calls = 0, live = 0, failAt = 0;
	lw_allocator allocator{ alloc, release, this };

	static void* alloc( void* user, std::size_t size, std::size_t align )
	{
		auto* self = static_cast<FailingMemory*>( user );
		if ( ++self->calls == self->failAt )
		{
			return nullptr;
		}
		self->live += size;
		return std::aligned_alloc( align, std::max( ( size + align - 1 ) / align * align, align ) );
	}
	static void release( void* user, void* memory, std::size_t size )
	{
		static_cast<FailingMemory*>( user )->live -= size;
		std::free( memory );
	}
};

/// Random robots whose shapes are small enough for many pairs to stay apart.
RobotPtr randomSparseRobot( SeededRng& rng, bool floating )
{
	RandomRobotOptions options;
	options.joints = rng.integer( 4, 8 );
	options.floating = floating;
	options.size = 0.06;
	RobotModel model = randomRobot( rng, options );
	for ( std::uint32_t i = 0; i < 4; ++i )
	{
		std::uint32_t last = static_cast<std::uint32_t>( model.linkNames.size() ) - 1;
		model.allowed.push_back( { static_cast<std::uint32_t>( rng.integer( 0, static_cast<int>( last ) ) ), last } );
	}
	model.allowed.erase( std::remove_if( model.allowed.begin(), model.allowed.end(),
							 []( const lw_link_pair& p ) { return p.link_a == p.link_b; } ),
		model.allowed.end() );
	if ( rng.integer( 0, 1 ) == 0 )
	{
		model.renumberLinks( rng );
	}
	return model.create();
}

} // namespace

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
	std::printf( "%d proved, %d of them by subdivision; %d in contact, %d open\n", proved, bySubdivision, contacts,
		unproved );
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
		double separation = pair_probe_subdivide( reach.get(), arm.base, arm.tip, 0.9, 100, 1000000, &cells );
		EXPECT_GE( separation, 0.8 * truth );
		EXPECT_LE( separation, truth );
		EXPECT_EQ( pair_probe_subdivide( reach.get(), arm.tip, arm.base, 0.9, 100, cells / 2, &cells ), 0.0 )
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
		double separation = pair_probe_subdivide( reach.get(), 0, 1, 0.99, 100, 1000000, &cells );
		EXPECT_GE( separation, 0.95 * 0.3 ) << place;
		EXPECT_LE( separation, 0.3 ) << place;
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
		ReachPtr reach = makeReach( robot.get(), 0.5, samples );
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
	ReachPtr reach = makeReach( robot.get(), 0.5 );
	lw_reach_pair pair = pairOf( reach, 0, 2 );
	EXPECT_EQ( pair.kind, LW_PAIR_CHECK );
	EXPECT_GT( pair.closest, 0.0 );
	EXPECT_LT( pair.closest, 1e-5 );
	EXPECT_EQ( pair.separation, 0.0 );
	PairAttacker( reach.get(), 1 ).checkEvidence( 2, 0 ); // in the order in which it was measured: the other one rounds otherwise
}

TEST( ReachPairs, MimicCouplingKeepsApartWhatWouldMeetWithoutIt )
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
	RobotModel model;
	model.link( "base" );
	addBall( model, 0, 0.1, -0.5 );
	addJoint( model, "wheel", LW_JOINT_CONTINUOUS, 0, 0, 0, 0 );
	addPin( model, 1 );
	addJoint( model, "pin", LW_JOINT_REVOLUTE, 0, 0, 0, 0 );
	addPin( model, 2 );
	addJoint( model, "hand", LW_JOINT_CONTINUOUS, 2, 0, 0, 0 );
	model.joints[2].mimic = 0;
	model.joints[2].mimic_multiplier = 0.5;
	addBall( model, 3, 0.1, 0.5 );
	RobotPtr robot = model.create();
	ASSERT_NE( robot, nullptr );
	ReachPtr reach = makeReach( robot.get(), 0.5 );
	lw_reach_pair pair = pairOf( reach, 0, 3 );
	EXPECT_EQ( pair.kind, LW_PAIR_CHECK );
	EXPECT_EQ( pair.separation, 0.0 );
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

// ---- tables ----------------------------------------------------------------------------------------------------------

namespace
{

/// Equations (1) to (12) to the letter, by recursion over sets.
struct LiteralTables
{
	const lw_reach* reach;
	const lw_robot* robot;
	std::vector<std::vector<std::uint32_t>> children;

	explicit LiteralTables( const lw_reach* r )
		: reach( r ), robot( lw_reach_robot( r ) ), children( lw_robot_link_count( robot ) )
	{
		for ( std::uint32_t j = 0; j < lw_robot_joint_count( robot ); ++j )
		{
			children[lw_robot_joint_parent( robot, j )].push_back( lw_robot_joint_child( robot, j ) );
		}
	}
	double base( std::uint32_t i, std::uint32_t j ) const
	{
		lw_reach_pair pair = lw_reach_get_pair( reach, i, j );
		bool checked = i != j && pair.kind != LW_PAIR_NONE && !lw_robot_pair_allowed( robot, i, j );
		return checked ? pair.separation : INFINITY;
	}
	std::vector<std::uint32_t> parts( std::uint32_t i ) const
	{
		std::vector<std::uint32_t> all = { i };
		for ( std::uint32_t child : children[i] )
		{
			std::vector<std::uint32_t> below = parts( child );
			all.insert( all.end(), below.begin(), below.end() );
		}
		return all;
	}
	double rigid( std::uint32_t i, std::uint32_t j ) const
	{
		double least = INFINITY;
		for ( std::uint32_t k : parts( j ) )
		{
			least = std::min( least, base( i, k ) );
		}
		return least;
	}
	double motion( std::uint32_t i, std::uint32_t j ) const
	{
		double least = INFINITY;
		for ( std::uint32_t l : parts( i ) )
		{
			least = std::min( least, rigid( l, j ) );
		}
		return least;
	}
	/// `neighbours`: R_i against its children too; without, as the paper has it, grandchildren only.
	double scfree( std::uint32_t i, bool neighbours ) const
	{
		double least = INFINITY;
		for ( std::uint32_t child : children[i] )
		{
			least = std::min( least, scfree( child, neighbours ) );
			least = neighbours ? std::min( least, rigid( i, child ) ) : least;
			for ( std::uint32_t grandchild : children[child] )
			{
				least = std::min( least, rigid( i, grandchild ) );
			}
			for ( std::uint32_t sibling : children[i] )
			{
				least = sibling != child ? std::min( least, motion( child, sibling ) ) : least;
			}
		}
		return least;
	}
};

} // namespace

TEST( ReachTables, EqualTheFormulas )
{
	SeededRng rng;
	int finite = 0, positive = 0, paper = 0;
	for ( int round = 0; round < 20; ++round )
	{
		RandomRobotOptions options;
		options.joints = rng.integer( 3, 12 );
		options.size = 0.05;
		RobotModel model = randomRobot( rng, options );
		bool neighboursAllowed = round % 2 == 0; // the paper's case
		for ( const lw_joint_def& joint : model.joints )
		{
			if ( neighboursAllowed || rng.integer( 0, 2 ) == 0 )
			{
				model.allowed.push_back( { joint.parent, joint.child } );
			}
		}
		// some links without geometry
		model.bodies.erase( model.bodies.begin() + rng.integer( 0, static_cast<int>( model.bodies.size() ) - 1 ) );
		RobotPtr robot = model.create();
		ASSERT_NE( robot, nullptr );
		ReachPtr reach = makeReach( robot.get(), 0.05, 20 );
		LiteralTables tables( reach.get() );
		std::uint32_t count = lw_robot_link_count( robot.get() );
		for ( std::uint32_t i = 0; i < count; ++i )
		{
			double scfree = lw_reach_scfree( reach.get(), i );
			EXPECT_EQ( scfree, tables.scfree( i, true ) ) << i;
			if ( neighboursAllowed )
			{
				EXPECT_EQ( scfree, tables.scfree( i, false ) ) << "with neighbours allowed (12) is the paper's, link " << i;
				++paper;
			}
			for ( std::uint32_t j = 0; j < count; ++j )
			{
				EXPECT_EQ( lw_reach_base( reach.get(), i, j ), tables.base( i, j ) ) << i << " " << j;
				EXPECT_EQ( lw_reach_rigid( reach.get(), i, j ), tables.rigid( i, j ) ) << i << " " << j;
				EXPECT_EQ( lw_reach_motion( reach.get(), i, j ), tables.motion( i, j ) ) << i << " " << j;
				finite += std::isfinite( tables.motion( i, j ) );
				positive += std::isfinite( tables.motion( i, j ) ) && tables.motion( i, j ) > 0;
			}
		}
	}
	EXPECT_GE( finite, 200 );
	EXPECT_GE( positive, 50 );
	EXPECT_GE( paper, 20 );
}

// ---- the build -------------------------------------------------------------------------------------------------------

TEST( ReachPairs, WithoutATimeBudgetTheBuildRepeats )
{
	SeededRng rng;
	for ( int round = 0; round < 4; ++round )
	{
		RobotPtr robot = randomSparseRobot( rng, true );
		ReachPtr first = makeReach( robot.get(), 0 ), second = makeReach( robot.get(), 0 );
		std::uint32_t count = lw_robot_link_count( robot.get() );
		State q1( lw_robot_variable_count( robot.get() ) ), q2 = q1;
		for ( std::uint32_t a = 0; a < count; ++a )
		{
			for ( std::uint32_t b = 0; b < a; ++b )
			{
				lw_reach_pair x = pairOf( first, a, b ), y = pairOf( second, a, b );
				EXPECT_EQ( x.kind, y.kind );
				EXPECT_EQ( x.separation, y.separation );
				EXPECT_EQ( x.closest, y.closest );
				EXPECT_EQ( x.contact_share, y.contact_share );
				EXPECT_NE( x.proof, LW_PROOF_SUBDIVISION );
				EXPECT_EQ( lw_reach_closest_state( first.get(), a, b, q1.data() ),
					lw_reach_closest_state( second.get(), a, b, q2.data() ) );
				EXPECT_EQ( q1, q2 );
			}
		}
	}
}

/// Runs the tasks of a reach on three threads, the last one first; leaves some of them to the library, and runs some twice.
void runOnThreads( void* user, void ( *task )( void*, std::uint32_t ), void* context, std::uint32_t count )
{
	*static_cast<int*>( user ) += 1;
	std::vector<std::thread> threads;
	for ( std::uint32_t first = 0; first < 3; ++first )
	{
		threads.emplace_back(
			[=]
			{
				for ( std::uint32_t i = first; i < count; i += 3 )
				{
					if ( i % 7 != 5 )
					{
						task( context, count - 1 - i );
						task( context, i % 5 == 0 ? i : count + i );
					}
				}
			} );
	}
	for ( std::thread& thread : threads )
	{
		thread.join();
	}
}

// Threads that share random streams, queries or "closest so far" give tables that nobody can repeat.
TEST( ReachPairs, ThreadsChangeNothing )
{
	SeededRng rng;
	int runs = 0;
	for ( int round = 0; round < 4; ++round )
	{
		RobotPtr robot = randomSparseRobot( rng, true );
		ReachPtr alone = makeReach( robot.get(), 0 );
		lw_reach_def def = lw_reach_def_default();
		def.robot = robot.get();
		def.seconds = 0;
		def.samples = 200;
		def.parallel = runOnThreads;
		def.parallel_user = &runs;
		lw_reach* made = nullptr;
		ASSERT_EQ( lw_reach_create( &def, nullptr, nullptr, &made ), LW_OK );
		ReachPtr threaded( made );
		for ( std::uint32_t a = 0; a < lw_robot_link_count( robot.get() ); ++a )
		{
			EXPECT_EQ( lw_reach_get_node( alone.get(), a ).m.radius, lw_reach_get_node( threaded.get(), a ).m.radius );
			for ( std::uint32_t b = 0; b < a; ++b )
			{
				lw_reach_pair x = pairOf( alone, a, b ), y = pairOf( threaded, a, b );
				EXPECT_EQ( x.kind, y.kind );
				EXPECT_EQ( x.separation, y.separation );
				EXPECT_EQ( x.closest, y.closest );
				EXPECT_EQ( x.contact_share, y.contact_share );
			}
		}
	}
	EXPECT_GT( runs, 0 );
}

lw_reach* continued( const lw_reach* reach, double seconds, const lw_allocator* allocator = nullptr, std::uint32_t samples = 200 )
{
	lw_reach_def def = lw_reach_def_default();
	def.seconds = seconds;
	def.samples = samples;
	lw_reach* more = nullptr;
	lw_diag diag = {};
	lw_status status = lw_reach_continue( reach, &def, allocator, &diag, &more );
	EXPECT_TRUE( status == LW_OK || ( allocator != nullptr && status == LW_ERROR_OUT_OF_MEMORY ) ) << diag.message;
	return more;
}

// A run that begins anew each time never ends; one that forgets its proofs is worse than none.
TEST( ReachPairs, ManyShortRunsProveWhatALongOneDoes )
{
	SeededRng rng;
	int runs = 0, proved = 0, by_subdivision = 0;
	for ( int round = 0; round < 6; ++round )
	{
		RobotPtr robot = round == 0 ? PlanarArm( 1.5, 2.6 ).model.create() : randomSparseRobot( rng, round % 2 == 0 );
		ReachPtr reach = makeReach( robot.get(), 1e-9, 200 );
		for ( int run = 0; run < 400 && !lw_reach_get_info( reach.get() ).complete; ++run, ++runs )
		{
			ReachPtr more( continued( reach.get(), 0.02 ) );
			ASSERT_NE( more, nullptr );
			for ( std::uint32_t a = 0; a < lw_robot_link_count( robot.get() ); ++a )
			{
				for ( std::uint32_t b = 0; b < a; ++b )
				{
					lw_reach_pair before = pairOf( reach, a, b ), after = pairOf( more, a, b );
					EXPECT_GE( after.separation, std::min( before.separation, after.closest ) );
					EXPECT_LE( after.closest, before.closest * ( 1 + 1e-12 ) );
				}
			}
			EXPECT_GE( lw_reach_get_info( more.get() ).samples, lw_reach_get_info( reach.get() ).samples );
			EXPECT_GE( lw_reach_get_info( more.get() ).seconds, lw_reach_get_info( reach.get() ).seconds );
			reach = std::move( more );
		}
		const lw_reach_info info = lw_reach_get_info( reach.get() );
		EXPECT_EQ( info.pairs, info.proved + info.contact + info.unprovable + info.open );
		PairAttacker attacker( reach.get(), rng.engine()() );
		for ( std::uint32_t a = 0; a < lw_robot_link_count( robot.get() ); ++a )
		{
			for ( std::uint32_t b = 0; b < a; ++b )
			{
				lw_reach_pair pair = pairOf( reach, a, b );
				proved += pair.separation > 0;
				by_subdivision += pair.proof == LW_PROOF_SUBDIVISION;
				if ( pair.separation > 0 )
				{
					EXPECT_GE( attacker.attack( a, b, 60, 120 ), pair.separation - ROUNDING ) << round << ": " << a << ' ' << b;
				}
			}
		}
		if ( round == 0 )
		{
			EXPECT_TRUE( info.complete );
			EXPECT_GE( pairOf( reach, 0, 2 ).separation, 0.7 * PlanarArm::truth( 1.5, 2.6 ) );
		}
	}
	std::printf( "%d runs, %d proved, %d of them by subdivision\n", runs, proved, by_subdivision );
	EXPECT_GE( proved, 25 );
	EXPECT_GE( by_subdivision, 3 );
}

// A cell that is lost when a proof is interrupted is a part of the box that nobody looked at.
TEST( ReachPairs, NoCellIsLostWhenAProofIsInterrupted )
{
	RobotPtr robot = PlanarArm( 1.5, 2.6 ).model.create();
	ReachPtr reach = makeReach( robot.get(), 0, 10 );
	int open = 0;
	for ( std::uint64_t budget : { 10u, 57u, 200u, 333u } )
	{
		double whole = 0, in_parts = 0;
		const std::uint32_t height = pair_probe_open( reach.get(), 2, 0, budget, budget, &whole );
		EXPECT_EQ( pair_probe_open( reach.get(), 2, 0, budget, 7, &in_parts ), height ) << budget;
		EXPECT_EQ( in_parts, whole ) << budget;
		open += height > 1;
	}
	EXPECT_GE( open, 2 ) << "the proof is too easy";
}

TEST( ReachPairs, GoingOnRefusesAnotherRobotAndKeepsTheReachWhenMemoryEnds )
{
	RobotPtr robot = PlanarArm( 1.5, 2.6 ).model.create(), other = PlanarArm( 1, 1 ).model.create();
	ReachPtr reach = makeReach( robot.get(), 0.02, 20 );
	lw_reach_def def = lw_reach_def_default();
	def.robot = other.get();
	lw_reach* more = nullptr;
	lw_diag diag = {};
	EXPECT_EQ( lw_reach_continue( reach.get(), &def, nullptr, &diag, &more ), LW_ERROR_INVALID_ARGUMENT );
	EXPECT_NE( std::string( diag.message ).find( "another one" ), std::string::npos );
	EXPECT_EQ( lw_reach_continue( nullptr, &def, nullptr, &diag, &more ), LW_ERROR_INVALID_ARGUMENT );
	def.robot = nullptr;
	EXPECT_EQ( lw_reach_create( &def, nullptr, &diag, &more ), LW_ERROR_INVALID_ARGUMENT );
	std::size_t failures = 0;
	for ( bool done = false; !done; )
	{
		FailingMemory memory;
		memory.failAt = ++failures;
		more = continued( reach.get(), 0.01, &memory.allocator, 40 );
		done = more != nullptr;
		lw_reach_release( more );
		ASSERT_EQ( memory.live, 0u ) << "failing at call " << failures;
		ASSERT_LT( failures, 10000u );
	}
	EXPECT_GE( failures, 10u );
}

TEST( ReachPairs, GivingUpIsReported )
{
	RobotPtr robot = PlanarArm( 1.5, 2.6 ).model.create(); // 17 mm apart: too near for hulls
	for ( const char* when : { "samples", "hulls of pairs", "search for contact", "charts and proofs" } )
	{
		lw_reach_def def = lw_reach_def_default();
		def.robot = robot.get();
		def.seconds = 1;
		def.progress_user = const_cast<char*>( when );
		def.progress = []( void* user, const char* stage, double share )
		{
			EXPECT_TRUE( share >= 0 && share <= 1 );
			return std::string( stage ) != static_cast<const char*>( user );
		};
		lw_reach* reach = nullptr;
		lw_diag diag = {};
		lw_status status = lw_reach_create( &def, nullptr, &diag, &reach );
		EXPECT_EQ( status, LW_ERROR_CANCELLED ) << when;
		EXPECT_EQ( reach, nullptr );
		lw_reach_release( reach );
	}
}

TEST( ReachPairs, RobotsWithNothingToMeasure )
{
	RobotModel bare;
	bare.link( "base" );
	addJoint( bare, "arm", LW_JOINT_REVOLUTE, 0, 1, -1, 1 );
	RobotPtr robot = bare.create();
	ReachPtr reach = makeReach( robot.get(), 0.2 );
	ASSERT_NE( reach, nullptr );
	EXPECT_EQ( lw_reach_get_pair( reach.get(), 0, 1 ).kind, LW_PAIR_NONE );
	EXPECT_EQ( lw_reach_scfree( reach.get(), 0 ), INFINITY );
	double q[1];
	EXPECT_FALSE( lw_reach_closest_state( reach.get(), 0, 1, q ) );

	RobotModel rigid;
	rigid.link( "base" );
	addBall( rigid, 0, 0.1 );
	addJoint( rigid, "plate", LW_JOINT_FIXED, 0, 1, 0, 0 );
	addBall( rigid, 1, 0.1 );
	robot = rigid.create();
	reach = makeReach( robot.get(), 0.2 );
	ASSERT_NE( reach, nullptr );
	EXPECT_EQ( lw_reach_get_pair( reach.get(), 0, 1 ).kind, LW_PAIR_RIGID );
	EXPECT_EQ( lw_reach_base( reach.get(), 0, 1 ), INFINITY );
}

TEST( ReachPairs, EveryFailingAllocationIsReportedAndNothingLeaks )
{
	RobotPtr robot = PlanarArm( 1, 1 ).model.create();
	lw_reach_def def = lw_reach_def_default();
	def.robot = robot.get();
	def.samples = 5;
	def.hull_error = 0.2; // small hulls: the loop below makes many
	def.seconds = 0.01;
	std::size_t failures = 0;
	for ( lw_status status = LW_ERROR_OUT_OF_MEMORY; status != LW_OK; )
	{
		FailingMemory memory;
		memory.failAt = ++failures;
		lw_reach* reach = nullptr;
		status = lw_reach_create( &def, &memory.allocator, nullptr, &reach );
		EXPECT_TRUE( status == LW_OK || ( status == LW_ERROR_OUT_OF_MEMORY && reach == nullptr ) ) << failures;
		lw_reach_release( reach );
		ASSERT_EQ( memory.live, 0u ) << "failing at call " << failures;
		ASSERT_LT( failures, 10000u );
	}
	std::printf( "%zu allocations\n", failures - 1 );
	EXPECT_GE( failures, 10u );
}
