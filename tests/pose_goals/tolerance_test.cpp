// SPDX-License-Identifier: BSD-3-Clause
// Tolerances: no state outside of them, and states near their edges.
#include "pose_world.hpp"

#include <algorithm>

namespace
{

const Vector centre_state = { 0.2, 0.6, -0.3, 1.2, 0.4, 0.7, -0.5 };

ik::Options many()
{
	ik::Options options;
	options.states = 150;
	options.searches = 4000;
	return options;
}

/// Least and largest of each component, as shares of the bounds.
struct Spread
{
	std::array<double, 3> least = { 9, 9, 9 }, largest = { -9, -9, -9 };
	void add( const std::array<double, 3>& values, const std::array<double, 3>& bounds )
	{
		for ( std::size_t i = 0; i < 3; ++i )
		{
			least[i] = std::min( least[i], values[i] / bounds[i] );
			largest[i] = std::max( largest[i], values[i] / bounds[i] );
		}
	}
	void expectWithinAndWide() const
	{
		for ( std::size_t i = 0; i < 3; ++i )
		{
			EXPECT_TRUE( least[i] >= -1 - 1e-7 && least[i] < -0.9 ) << i << ": " << least[i];
			EXPECT_TRUE( largest[i] <= 1 + 1e-7 && largest[i] > 0.9 ) << i << ": " << largest[i];
		}
	}
};

std::array<double, 3> origin( const Matrix& m )
{
	return { m[0][3], m[1][3], m[2][3] };
}

void expectAnglesFillTheirTolerances(
    io::OrientationGoal::Parameterization parameterization, const std::array<double, 3>& tolerance )
{
	PoseWorld world( sevenAxisArm() );
	const Matrix at = world.pose( "hand", centre_state );
	world.askFor( "hand", at, 1e-3, 0 );
	world.request.goal_orientations[0].tolerance = tolerance;
	world.request.goal_orientations[0].parameterization = parameterization;
	const ik::GoalStates goal = world.find( many() );
	ASSERT_GE( goal.states.size(), 50u );
	Spread spread;
	for ( const Vector& q : goal.states )
	{
		const Matrix difference = product( inverseOf( at ), world.pose( "hand", q ) );
		spread.add( parameterization == io::OrientationGoal::Parameterization::euler_xyz ? eulerXyz( difference )
		                                                                                 : rotationVector( difference ),
		    tolerance );
	}
	spread.expectWithinAndWide();
}

} // namespace

TEST( PoseTolerances, EulerAnglesFillTheirTolerancesAndNoMore )
{
	expectAnglesFillTheirTolerances( io::OrientationGoal::Parameterization::euler_xyz, { 0.1, 0.3, 0.8 } );
}

TEST( PoseTolerances, RotationVectorsFillTheirTolerancesAndNoMore )
{
	expectAnglesFillTheirTolerances( io::OrientationGoal::Parameterization::rotation_vector, { 0.1, 0.3, 0.8 } );
}

/// About three axes by 0.8 rad, the two parameterizations differ by a tenth of a radian.
TEST( PoseTolerances, TheParameterizationsAreToldApart )
{
	PoseWorld world( sevenAxisArm() );
	const Matrix at = world.pose( "hand", centre_state );
	world.askFor( "hand", at, 1e-3, 0 );
	world.request.goal_orientations[0].tolerance = { 0.8, 0.8, 0.8 };
	const ik::GoalStates euler = world.find( many() );
	world.request.goal_orientations[0].parameterization = io::OrientationGoal::Parameterization::rotation_vector;
	std::size_t outside = 0;
	for ( const Vector& q : euler.states )
	{
		const auto vector = rotationVector( product( inverseOf( at ), world.pose( "hand", q ) ) );
		const bool beyond = std::fabs( vector[0] ) > 0.8 || std::fabs( vector[1] ) > 0.8 || std::fabs( vector[2] ) > 0.8;
		EXPECT_EQ( beyond, !ik::goalViolations( world.problem, world.request, q.data() ).empty() );
		outside += beyond ? 1 : 0;
	}
	EXPECT_GT( outside, 0u );
}

TEST( PoseTolerances, ABoxTurnedInItsFrameIsFilled )
{
	PoseWorld world( sevenAxisArm() );
	const Matrix at = world.pose( "hand", centre_state );
	world.askForPlace( "hand", origin( at ), 0 );
	io::GoalRegion& region = world.request.goal_positions[0].regions[0];
	region.type = io::GoalRegion::Type::Box;
	region.size = { 0.1, 0.2, 0.05 };
	const double turn[4] = { 0, std::sin( 0.3 ), 0, std::cos( 0.3 ) };
	require( lw_transform_from_quaternion( origin( at ).data(), turn, &region.pose ), "pose" );
	const Matrix frame = fromQuaternion( origin( at ), { turn[0], turn[1], turn[2], turn[3] } );
	const ik::GoalStates goal = world.find( many() );
	ASSERT_GE( goal.states.size(), 100u );
	Spread spread;
	for ( const Vector& q : goal.states )
	{
		spread.add( transformed( inverseOf( frame ), origin( world.pose( "hand", q ) ) ), { 0.05, 0.1, 0.025 } );
	}
	spread.expectWithinAndWide();
}

TEST( PoseTolerances, BallsAndCylindersAreFilled )
{
	for ( bool cylinder : { false, true } )
	{
		PoseWorld world( sixAxisArm() );
		const Matrix at = world.pose( "hand", { 0.2, 0.6, 0.9, 0.4, 0.7, -0.5 } );
		world.askForPlace( "hand", origin( at ), 0.1 );
		io::GoalRegion& region = world.request.goal_positions[0].regions[0];
		region.type = cylinder ? io::GoalRegion::Type::Cylinder : io::GoalRegion::Type::Sphere;
		region.size = { 0.1, 0.04, 0 };
		const ik::GoalStates goal = world.find( many() );
		ASSERT_GE( goal.states.size(), 100u );
		double widest = 0, highest = 0;
		for ( const Vector& q : goal.states )
		{
			const auto p = origin( world.pose( "hand", q ) );
			const double x = p[0] - at[0][3], y = p[1] - at[1][3], z = p[2] - at[2][3];
			const double wide = cylinder ? std::hypot( x, y ) : std::hypot( x, y, z );
			EXPECT_LE( wide, 0.1 + 1e-8 );
			EXPECT_LE( cylinder ? std::fabs( z ) : 0, 0.02 + 1e-8 );
			widest = std::max( widest, wide );
			highest = std::max( highest, std::fabs( z ) );
		}
		EXPECT_GT( widest, 0.09 );
		EXPECT_GT( highest, cylinder ? 0.018 : 0.05 );
	}
}

/// Most of the box is out of reach: targets there lead to the part within reach.
TEST( PoseTolerances, ABoxMostlyOutOfReach )
{
	PoseWorld world( sixAxisArm() );
	world.askForPlace( "hand", { 3, 0, 0.3 }, 0 );
	io::GoalRegion& region = world.request.goal_positions[0].regions[0];
	region.type = io::GoalRegion::Type::Box;
	region.size = { 5, 0.02, 0.02 }; // from x = 0.5; the arm reaches 0.9
	const ik::GoalStates goal = world.find();
	ASSERT_EQ( goal.states.size(), 8u ) << goal.problem;
	for ( const Vector& q : goal.states )
	{
		EXPECT_GE( origin( world.pose( "hand", q ) )[0], 0.5 - 1e-8 );
	}
}

TEST( PoseTolerances, EachOfTheRegionsIsReached )
{
	PoseWorld world( sixAxisArm() );
	world.askForPlace( "hand", { 0.4, 0.3, 0.4 }, 0.02 );
	std::vector<io::GoalRegion>& regions = world.request.goal_positions[0].regions;
	regions.push_back( regions[0] );
	regions[1].pose.t[1] = -0.3;
	ik::Options options = many();
	options.states = 40;
	std::array<int, 2> counts = { 0, 0 };
	for ( const Vector& q : world.find( options ).states )
	{
		const auto p = origin( world.pose( "hand", q ) );
		const double left = std::hypot( p[0] - 0.4, p[1] - 0.3, p[2] - 0.4 ),
		             right = std::hypot( p[0] - 0.4, p[1] + 0.3, p[2] - 0.4 );
		EXPECT_LE( std::min( left, right ), 0.02 + 1e-8 );
		++counts[left < right ? 0 : 1];
	}
	EXPECT_GT( counts[0], 5 );
	EXPECT_GT( counts[1], 5 );
}

TEST( PoseTolerances, AnOrientationAloneLeavesThePlaceFree )
{
	PoseWorld world( sevenAxisArm() );
	const Matrix at = world.pose( "hand", centre_state );
	world.askFor( "hand", at, 0, 1e-3 );
	world.request.goal_positions.clear();
	const ik::GoalStates goal = world.find();
	ASSERT_EQ( goal.states.size(), 8u );
	double farthest = 0;
	for ( const Vector& q : goal.states )
	{
		const Matrix found = world.pose( "hand", q );
		for ( double angle : eulerXyz( product( inverseOf( at ), found ) ) )
		{
			EXPECT_LE( std::fabs( angle ), 1e-3 + 1e-8 );
		}
		farthest = std::max( farthest, std::hypot( found[0][3] - at[0][3], found[1][3] - at[1][3] ) );
	}
	EXPECT_GT( farthest, 0.1 );
}

TEST( PoseTolerances, JointConstraintsHoldBesideThePose )
{
	PoseWorld world( sevenAxisArm( "continuous" ) );
	world.askFor( "hand", world.pose( "hand", centre_state ), 1e-3, 1e-3 );
	world.request.goal = { { "j2", 0.6, 0.05, 0.1 }, { "j3", centre_state[2] + 6.283185307179586, 0.1, 0.1 } };
	ik::Options options;
	options.states = 20;
	const ik::GoalStates goal = world.find( options );
	ASSERT_GE( goal.states.size(), 3u ) << goal.problem;
	for ( const Vector& q : goal.states )
	{
		EXPECT_GE( q[1], 0.5 );
		EXPECT_LE( q[1], 0.65 );
		EXPECT_NEAR( q[2], centre_state[2], 0.1 + 1e-8 ) << "a turn further is the same angle";
	}
	const io::Request constrained = world.request;
	world.request.goal.clear();
	std::size_t outside = 0;
	for ( const Vector& q : world.find( options ).states )
	{
		const std::vector<std::string> lines = ik::goalViolations( world.problem, constrained, q.data() );
		if ( q[1] > 0.65 + 1e-6 )
		{
			++outside;
			EXPECT_TRUE( !lines.empty() && lines[0].find( "joint j2" ) == 0 );
		}
	}
	EXPECT_GT( outside, 0u );
}

/// Each type of region, at points within it, beside each of its faces and far away.
TEST( PoseTolerances, ViolationsOfRegionsAgreeWithTheOracle )
{
	PoseWorld world( ArmText()
	                     .add( "x", "prismatic", "xyz='0 0 0'", "1 0 0", -1, 1 )
	                     .add( "y", "prismatic", "xyz='0 0 0'", "0 1 0", -1, 1 )
	                     .add( "z", "prismatic", "xyz='0 0 0'", "0 0 1", -1, 1 )
	                     .text() );
	const double turn[4] = { 0, 0.6, 0, 0.8 };
	const std::array<double, 3> at = { 0.1, -0.2, 0.3 };
	const Matrix frame = fromQuaternion( at, { turn[0], turn[1], turn[2], turn[3] } );
	world.askForPlace( "z_link", at, 0 );
	io::GoalRegion& region = world.request.goal_positions[0].regions[0];
	require( lw_transform_from_quaternion( at.data(), turn, &region.pose ), "pose" );
	SeededRng rng;
	for ( const io::GoalRegion::Type type :
	    { io::GoalRegion::Type::Box, io::GoalRegion::Type::Sphere, io::GoalRegion::Type::Cylinder } )
	{
		region.type = type;
		std::array<int, 2> counts = { 0, 0 };
		for ( int i = 0; i < 2000; ++i )
		{
			region.size = { rng.uniform( 0.1, 0.5 ), rng.uniform( 0.1, 0.5 ), rng.uniform( 0.1, 0.5 ) };
			const Vector q = { rng.uniform( -0.3, 0.5 ), rng.uniform( -0.6, 0.2 ), rng.uniform( -0.1, 0.7 ) };
			const auto p = transformed( inverseOf( frame ), origin( world.pose( "z_link", q ) ) );
			const double x = std::fabs( p[0] ), y = std::fabs( p[1] ), z = std::fabs( p[2] );
			const auto& s = region.size;
			const bool inside = type == io::GoalRegion::Type::Box      ? x <= s[0] / 2 && y <= s[1] / 2 && z <= s[2] / 2
			                    : type == io::GoalRegion::Type::Sphere ? std::hypot( x, y, z ) <= s[0]
			                                                           : std::hypot( x, y ) <= s[0] && z <= s[1] / 2;
			EXPECT_EQ( inside, ik::goalViolations( world.problem, world.request, q.data() ).empty() );
			++counts[inside ? 1 : 0];
		}
		EXPECT_GT( std::min( counts[0], counts[1] ), 20 );
	}
}
