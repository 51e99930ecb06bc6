// SPDX-License-Identifier: BSD-3-Clause
// Forward kinematics against long double matrices, and the motion that lw_robot_interpolate makes.
#include "random_robot.hpp"

#include <gtest/gtest.h>

namespace
{

std::vector<lw_transform> fk( const lw_robot* robot, const State& q )
{
	std::vector<lw_transform> poses( lw_robot_link_count( robot ) );
	EXPECT_EQ( lw_robot_fk( robot, q.data(), poses.data() ), LW_OK );
	return poses;
}

double largestDifference( const lw_transform& a, const Matrix& b )
{
	long double largest = 0;
	for ( int i = 0; i < 3; ++i )
	{
		for ( int j = 0; j < 3; ++j )
		{
			largest = std::max( largest, std::abs( a.r[i][j] - b[i][j] ) );
		}
		largest = std::max( largest, std::abs( a.t[i] - b[i][3] ) );
	}
	return static_cast<double>( largest );
}

double angleBetween( const lw_transform& a, const lw_transform& b )
{
	double trace = 0;
	for ( int i = 0; i < 3; ++i )
	{
		for ( int k = 0; k < 3; ++k )
		{
			trace += a.r[i][k] * b.r[i][k];
		}
	}
	return std::acos( std::min( 1.0, std::max( -1.0, ( trace - 1 ) / 2 ) ) );
}

RobotModel single( lw_joint_type type )
{
	RobotModel model;
	model.link( "base" );
	model.joint( "tip", type, 0 );
	return model;
}

State interpolate( const lw_robot* robot, const State& a, const State& b, double t )
{
	State out( a.size() );
	lw_robot_interpolate( robot, a.data(), b.data(), t, out.data() );
	return out;
}

} // namespace

// Random trees of every joint type with mimic joints, skew and exact axes.
TEST( Kinematics, AgreesWithLongDoubleMatrices )
{
	SeededRng rng;
	int types[7] = {}, mimics = 0;
	double worst = 0;
	for ( int i = 0; i < 300; ++i )
	{
		RandomRobotOptions options;
		options.joints = rng.integer( 1, 14 );
		RobotModel model = randomRobot( rng, options );
		RobotPtr robot = model.create();
		ASSERT_NE( robot, nullptr );
		for ( const lw_joint_def& j : model.joints )
		{
			++types[j.type];
			mimics += j.mimic != LW_INVALID_INDEX ? 1 : 0;
		}
		for ( int k = 0; k < 5; ++k )
		{
			State q = randomState( rng, robot.get(), k * 0.5 );
			std::vector<lw_transform> poses = fk( robot.get(), q );
			for ( std::uint32_t link = 0; link < poses.size(); ++link )
			{
				double difference = largestDifference( poses[link], oraclePose( model, robot.get(), link, q ) );
				worst = std::max( worst, difference );
				// core/docs/kinematics.md: 64 u per joint and metre; up to 14 joints, about 10 m of offsets and shifts
				EXPECT_LE( difference, 64 * 0x1p-53 * 16 * 12 );
			}
		}
	}
	std::printf( "largest difference %g\n", worst );
	for ( int type = LW_JOINT_FIXED; type <= LW_JOINT_FLOATING; ++type )
	{
		EXPECT_GE( types[type], 100 ) << "joint type " << type;
	}
	EXPECT_GE( mimics, 100 );
}

TEST( Kinematics, QuarterTurnGoesCounterClockwiseAboutEachAxis )
{
	for ( int axis = 0; axis < 3; ++axis )
	{
		for ( int sign : { 1, -1 } )
		{
			RobotModel model = single( LW_JOINT_REVOLUTE );
			model.joints[0].axis[2] = 0;
			model.joints[0].axis[axis] = 2.5 * sign; // normalised
			RobotPtr robot = model.create();
			std::vector<lw_transform> poses = fk( robot.get(), { M_PI / 2 } );
			int next = ( axis + 1 ) % 3, after = ( axis + 2 ) % 3;
			EXPECT_NEAR( poses[1].r[after][next], sign, 1e-15 );
			EXPECT_NEAR( poses[1].r[next][after], -sign, 1e-15 );
			EXPECT_EQ( poses[1].r[axis][axis], 1 );
		}
	}
}

// Beside a component that rounds to 1 the others are up to 1e-8, which is 1e-8 m at an arm's length.
TEST( Kinematics, AxisBesideACoordinateTurnsAsThatOne )
{
	for ( int axis = 0; axis < 3; ++axis )
	{
		RobotModel model = single( LW_JOINT_REVOLUTE );
		model.joints[0].axis[0] = model.joints[0].axis[1] = model.joints[0].axis[2] = 0;
		model.joints[0].axis[axis] = 1;
		model.joints[0].axis[( axis + 1 ) % 3] = 1e-8;
		RobotPtr robot = model.create();
		EXPECT_LE( largestDifference( fk( robot.get(), { 1.5 } )[1], oraclePose( model, robot.get(), 1, { 1.5 } ) ), 1e-15 );
	}
}

// Planar joints of URDF and OMPL's SE2: x and y are those of the joint frame, then theta.
TEST( Kinematics, PlanarAboutZMovesAlongXAndYOfTheJointFrame )
{
	RobotPtr robot = single( LW_JOINT_PLANAR ).create();
	std::vector<lw_transform> poses = fk( robot.get(), { 2, 3, M_PI / 2 } );
	EXPECT_EQ( poses[1].t[0], 2 );
	EXPECT_EQ( poses[1].t[1], 3 );
	EXPECT_EQ( poses[1].t[2], 0 );
	EXPECT_NEAR( poses[1].r[1][0], 1, 1e-15 );
}

TEST( Kinematics, PlanarPlaneIsNormalToItsAxisAndRightHanded )
{
	SeededRng rng;
	for ( int i = 0; i < 200; ++i )
	{
		RobotModel model = single( LW_JOINT_PLANAR );
		lw_vec3 n = { rng.normal(), rng.normal(), i % 4 == 0 ? -1e-9 : rng.normal() };
		double length = std::sqrt( n.x * n.x + n.y * n.y + n.z * n.z );
		model.joints[0].axis[0] = n.x;
		model.joints[0].axis[1] = n.y;
		model.joints[0].axis[2] = n.z;
		RobotPtr robot = model.create();
		lw_transform alongX = fk( robot.get(), { 1, 0, 0 } )[1], alongY = fk( robot.get(), { 0, 1, 0 } )[1];
		const double *x = alongX.t, *y = alongY.t;
		EXPECT_NEAR( x[1] * y[2] - x[2] * y[1], n.x / length, 1e-14 );
		EXPECT_NEAR( x[2] * y[0] - x[0] * y[2], n.y / length, 1e-14 );
		EXPECT_NEAR( x[0] * y[1] - x[1] * y[0], n.z / length, 1e-14 );
		EXPECT_NEAR( x[0] * x[0] + x[1] * x[1] + x[2] * x[2], 1, 1e-14 );
	}
}

TEST( Kinematics, FloatingQuaternionOfAnyLengthIsNormalised )
{
	RobotPtr robot = single( LW_JOINT_FLOATING ).create();
	for ( double scale : { 1e-200, 0.3, 1.0, 1e200 } )
	{
		double h = std::sqrt( 0.5 ) * scale;
		std::vector<lw_transform> poses = fk( robot.get(), { 1, 2, 3, 0, 0, h, h } );
		EXPECT_NEAR( poses[1].r[1][0], 1, 1e-15 );
		EXPECT_NEAR( poses[1].r[0][0], 0, 1e-15 );
		EXPECT_EQ( poses[1].t[2], 3 );
	}
}

TEST( Kinematics, NonFiniteValueOrZeroQuaternionIsAnError )
{
	RobotPtr robot = single( LW_JOINT_FLOATING ).create();
	lw_transform poses[2];
	State zero = { 0, 0, 0, 0, 0, 0, 0 };
	EXPECT_EQ( lw_robot_fk( robot.get(), zero.data(), poses ), LW_ERROR_INVALID_ARGUMENT );
	for ( int i = 0; i < 7; ++i )
	{
		for ( double bad : std::initializer_list<double>{ std::nan( "" ), INFINITY, -INFINITY } )
		{
			State q = { 0, 0, 0, 0, 0, 0, 1 };
			q[i] = bad;
			EXPECT_EQ( lw_robot_fk( robot.get(), q.data(), poses ), LW_ERROR_INVALID_ARGUMENT );
		}
	}
}

// a follows b follows c: a = 2 (3 c + 0.5) - 1
TEST( Kinematics, MimicChainComposesMultipliersAndOffsets )
{
	RobotModel model;
	model.link( "base" );
	for ( const char* name : { "a", "b", "c" } )
	{
		model.joint( name, LW_JOINT_PRISMATIC, 0 );
	}
	model.joints[0].mimic = 1;
	model.joints[0].mimic_multiplier = 2;
	model.joints[0].mimic_offset = -1;
	model.joints[1].mimic = 2;
	model.joints[1].mimic_multiplier = 3;
	model.joints[1].mimic_offset = 0.5;
	RobotPtr robot = model.create();
	ASSERT_EQ( lw_robot_variable_count( robot.get() ), 1u );
	EXPECT_EQ( lw_robot_joint_mimic( robot.get(), 0 ), 2u );
	EXPECT_EQ( lw_robot_joint_variable( robot.get(), 0 ), LW_INVALID_INDEX );
	std::vector<lw_transform> poses = fk( robot.get(), { 0.25 } );
	EXPECT_DOUBLE_EQ( poses[1].t[2], 2 * ( 3 * 0.25 + 0.5 ) - 1 );
	EXPECT_DOUBLE_EQ( poses[2].t[2], 3 * 0.25 + 0.5 );
	EXPECT_DOUBLE_EQ( poses[3].t[2], 0.25 );
}

// A mimic joint of a fixed joint, or with multiplier 0, stands at its offset and is rigid.
TEST( Kinematics, MimicOfNothingThatMovesIsConstant )
{
	RobotModel model;
	model.link( "base" );
	model.joint( "held", LW_JOINT_FIXED, 0 );
	lw_joint_def& follower = model.joint( "follower", LW_JOINT_REVOLUTE, 0 );
	follower.mimic = 0;
	follower.mimic_offset = M_PI / 2;
	model.joint( "mover", LW_JOINT_REVOLUTE, 0 );
	lw_joint_def& idle = model.joint( "idle", LW_JOINT_PRISMATIC, 0 );
	idle.mimic = 2;
	idle.mimic_multiplier = 0;
	idle.mimic_offset = 0.75;
	RobotPtr robot = model.create();
	ASSERT_EQ( lw_robot_variable_count( robot.get() ), 1u );
	std::vector<lw_transform> poses = fk( robot.get(), { 1.0 } );
	EXPECT_NEAR( poses[2].r[1][0], 1, 1e-15 );
	EXPECT_EQ( poses[4].t[2], 0.75 );
	EXPECT_TRUE( lw_robot_pair_allowed( robot.get(), 0, 2 ) );
	EXPECT_TRUE( lw_robot_pair_allowed( robot.get(), 2, 4 ) );
	EXPECT_FALSE( lw_robot_pair_allowed( robot.get(), 2, 3 ) );
}

// A file with six digits per number gives matrices that are rotations to 1e-6 only; lengths must not suffer.
TEST( Kinematics, NearlyRotationsAreMadeRotations )
{
	SeededRng rng;
	RobotModel model = single( LW_JOINT_REVOLUTE );
	model.joints[0].parent_from_joint = randomTransform( rng, 1 );
	for ( auto& row : model.joints[0].parent_from_joint.r )
	{
		for ( double& value : row )
		{
			value += rng.uniform( -2e-7, 2e-7 );
		}
	}
	RobotPtr robot = model.create();
	ASSERT_NE( robot, nullptr );
	lw_transform pose = fk( robot.get(), { 0.7 } )[1];
	for ( int i = 0; i < 3; ++i )
	{
		for ( int k = 0; k < 3; ++k )
		{
			double dot = pose.r[0][i] * pose.r[0][k] + pose.r[1][i] * pose.r[1][k] + pose.r[2][i] * pose.r[2][k];
			EXPECT_NEAR( dot, i == k ? 1 : 0, 2e-15 );
		}
	}
}

// ---- interpolation ---------------------------------------------------------------------------------------------------

TEST( Interpolation, EndsAreExactAndOutputMayAliasInput )
{
	SeededRng rng;
	for ( int i = 0; i < 200; ++i )
	{
		RobotModel model = randomRobot( rng, {} );
		RobotPtr robot = model.create();
		State a = randomState( rng, robot.get() ), b = randomState( rng, robot.get() );
		State end = interpolate( robot.get(), a, b, 1 ), begin = interpolate( robot.get(), a, b, 0 );
		State into_a = a, into_b = b, middle = interpolate( robot.get(), a, b, 0.3 );
		lw_robot_interpolate( robot.get(), into_a.data(), b.data(), 0.3, into_a.data() );
		lw_robot_interpolate( robot.get(), a.data(), into_b.data(), 0.3, into_b.data() );
		EXPECT_EQ( into_a, middle );
		EXPECT_EQ( into_b, middle );
		for ( std::uint32_t k = 0; k < a.size(); ++k )
		{
			lw_variable_info info = lw_robot_variable( robot.get(), k );
			if ( lw_robot_joint_type( robot.get(), info.joint ) != LW_JOINT_FLOATING || info.component < 3 )
			{
				EXPECT_EQ( begin[k], a[k] );
				EXPECT_EQ( end[k], b[k] );
			}
		}
		std::vector<lw_transform> want = fk( robot.get(), b ), got = fk( robot.get(), end );
		for ( std::size_t link = 0; link < want.size(); ++link )
		{
			EXPECT_LE( largestDifference( got[link], matrixOf( want[link] ) ), 1e-12 );
		}
	}
}

TEST( Interpolation, ContinuousJointTakesTheShorterWayAcrossTheSeam )
{
	RobotPtr robot = single( LW_JOINT_CONTINUOUS ).create();
	ASSERT_TRUE( lw_robot_variable( robot.get(), 0 ).wraps );
	double way = 2 * M_PI - 6;
	EXPECT_NEAR( interpolate( robot.get(), { 3 }, { -3 }, 0.25 )[0], 3 + 0.25 * way, 1e-15 );
	EXPECT_NEAR( interpolate( robot.get(), { 3 }, { -3 }, 0.75 )[0], -3 - 0.25 * way, 1e-15 );
	EXPECT_NEAR( interpolate( robot.get(), { -1 }, { 1 }, 0.5 )[0], 0, 1e-15 );
	// values outside [-pi, pi] are the same angles
	EXPECT_NEAR( interpolate( robot.get(), { 3 + 2 * M_PI }, { -3 - 4 * M_PI }, 0.25 )[0], 3 + 0.25 * way, 1e-14 );
	for ( double t = 0; t <= 1; t += 0.0625 )
	{
		EXPECT_LE( std::abs( interpolate( robot.get(), { 3 }, { -3 }, t )[0] ), M_PI );
	}
}

TEST( Interpolation, LimitedJointNeverWraps )
{
	RobotPtr robot = single( LW_JOINT_REVOLUTE ).create();
	EXPECT_FALSE( lw_robot_variable( robot.get(), 0 ).wraps );
	EXPECT_EQ( interpolate( robot.get(), { 3 }, { -3 }, 0.5 )[0], 0 );
}

// A joint that follows at half the angle would jump by half a turn at the seam: the variable must then not wrap.
TEST( Interpolation, VariableFollowedAtAFractionDoesNotWrap )
{
	for ( double multiplier : { 0.5, 1.0, -2.0 } )
	{
		for ( lw_joint_type type : { LW_JOINT_REVOLUTE, LW_JOINT_PRISMATIC } )
		{
			RobotModel model = single( LW_JOINT_CONTINUOUS );
			lw_joint_def& follower = model.joint( "follower", type, 0 );
			follower.mimic = 0;
			follower.mimic_multiplier = multiplier;
			RobotPtr robot = model.create();
			bool wraps = type == LW_JOINT_REVOLUTE && multiplier != 0.5;
			EXPECT_EQ( lw_robot_variable( robot.get(), 0 ).wraps, wraps );
			State a = { 3.1 }, b = { -3.1 };
			lw_transform last = fk( robot.get(), a )[2];
			for ( int i = 1; i <= 1000; ++i )
			{
				lw_transform next = fk( robot.get(), interpolate( robot.get(), a, b, i / 1000.0 ) )[2];
				EXPECT_LE( angleBetween( last, next ), 0.02 );
				EXPECT_LE( std::abs( next.t[2] - last.t[2] ), 0.02 );
				last = next;
			}
		}
	}
}

// Uniform speed, the shorter arc, whatever the lengths and signs of the quaternions; equal, nearly equal, opposite.
TEST( Interpolation, SlerpTurnsAtUniformSpeedAlongTheShorterArc )
{
	SeededRng rng;
	RobotPtr robot = single( LW_JOINT_FLOATING ).create();
	int sameSign = 0, otherSign = 0;
	for ( int i = 0; i < 2000; ++i )
	{
		State a( 7, 0.0 ), b( 7, 0.0 );
		rng.quaternion( &a[3] );
		rng.quaternion( &b[3] );
		double separation = i % 3 == 0 ? 1 : rng.decade( -12, 0 );
		double dot = 0;
		for ( int k = 3; k < 7; ++k )
		{
			b[k] = separation == 1 ? b[k] : a[k] + separation * b[k];
			b[k] = i % 20 == 1 ? a[k] : b[k];
			b[k] *= i % 2 ? -3 : 0.2;
			dot += a[k] * b[k];
		}
		++( dot > 0 ? sameSign : otherSign );
		lw_transform first = fk( robot.get(), a )[1], last = fk( robot.get(), b )[1];
		double whole = angleBetween( first, last );
		for ( double t : { 0.125, 0.5, 0.8 } )
		{
			lw_transform pose = fk( robot.get(), interpolate( robot.get(), a, b, t ) )[1];
			// acos loses half the digits near 0 and pi
			EXPECT_NEAR( angleBetween( first, pose ), t * whole, 1e-7 );
			EXPECT_NEAR( angleBetween( pose, last ), ( 1 - t ) * whole, 1e-7 );
		}
	}
	EXPECT_GE( sameSign, 500 );
	EXPECT_GE( otherSign, 500 );
}
