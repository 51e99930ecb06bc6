// SPDX-License-Identifier: BSD-3-Clause
// Inverse kinematics of one frame: poses by kinematics of the test's own, branches of an arm with a spherical wrist by a closed form.
#include "pose_world.hpp"

#include "leeway/ik/inverse.hpp"

#include <algorithm>

namespace
{

constexpr double half = M_PI;

lw_transform toTransform( const Matrix& m )
{
	lw_transform out;
	for ( std::size_t i = 0; i < 3; ++i )
	{
		for ( std::size_t k = 0; k < 3; ++k )
		{
			out.r[i][k] = m[i][k];
		}
		out.t[i] = m[i][3];
	}
	return out;
}

io::Frame frameOf( const PoseWorld& world, const std::string& link )
{
	return io::findFrame( world.problem, link, "test", "link" );
}

/// Metres and radians apart, the larger one.
double apart( const Matrix& a, const Matrix& b )
{
	const std::array<double, 3> turn = rotationVector( product( inverseOf( a ), b ) );
	return std::max(
	    std::hypot( a[0][3] - b[0][3], a[1][3] - b[1][3], a[2][3] - b[2][3] ), std::hypot( turn[0], turn[1], turn[2] ) );
}

double largest( const Vector& a, const Vector& b, bool whole_turns )
{
	double most = 0;
	for ( std::size_t i = 0; i < a.size(); ++i )
	{
		const double step = a[i] - b[i];
		most = std::max( most, std::fabs( whole_turns ? std::remainder( step, 2 * half ) : step ) );
	}
	return most;
}

double squares( const Vector& a, const Vector& b )
{
	double sum = 0;
	for ( std::size_t i = 0; i < a.size(); ++i )
	{
		sum += ( a[i] - b[i] ) * ( a[i] - b[i] );
	}
	return sum;
}

// ---- the closed form --------------------------------------------------------------------------------------------------

constexpr double base = 0.35, shoulder = 0.08, upper_arm = 0.45, elbow = 0.05, forearm = 0.5;

/// Shoulder, elbow, and three axes that meet.
std::string wristArm( const std::array<double, 6>& limits )
{
	return ArmText()
	    .add( "j1", "revolute", "xyz='0 0 0.35'", "0 0 1", -limits[0], limits[0] )
	    .add( "j2", "revolute", "xyz='0.08 0 0'", "0 1 0", -limits[1], limits[1] )
	    .add( "j3", "revolute", "xyz='0 0 0.45'", "0 1 0", -limits[2], limits[2] )
	    .add( "j4", "revolute", "xyz='0.05 0 0.5'", "0 0 1", -limits[3], limits[3] )
	    .add( "j5", "revolute", "xyz='0 0 0'", "0 1 0", -limits[4], limits[4] )
	    .add( "j6", "revolute", "xyz='0 0 0'", "0 0 1", -limits[5], limits[5] )
	    .text();
}

Matrix aboutY( double angle )
{
	return fromQuaternion( {}, { 0, std::sin( angle / 2 ), 0, std::cos( angle / 2 ) } );
}

Matrix aboutZ( double angle )
{
	return fromQuaternion( {}, { 0, 0, std::sin( angle / 2 ), std::cos( angle / 2 ) } );
}

/// All states, angles in [-pi, pi], of a pose of link j6_link.
std::vector<Vector> closedForm( const Matrix& at )
{
	std::vector<Vector> states;
	const double reach = std::hypot( elbow, forearm ), bend = std::atan2( elbow, forearm ),
	             distance = std::hypot( at[0][3], at[1][3] );
	const double z = at[2][3] - base;
	for ( const double side : { 1.0, -1.0 } )
	{
		const double q1 = std::atan2( side * at[1][3], side * at[0][3] ), r = side * distance - shoulder;
		const double cosine = ( r * r + z * z - upper_arm * upper_arm - reach * reach ) / ( 2 * upper_arm * reach );
		if ( std::fabs( cosine ) > 1 )
		{
			continue;
		}
		for ( const double up : { 1.0, -1.0 } )
		{
			const double inner = up * std::acos( cosine ), q3 = inner - bend;
			const double q2 =
			    std::atan2( r, z ) - std::atan2( reach * std::sin( inner ), upper_arm + reach * std::cos( inner ) );
			const Matrix wrist = product( inverseOf( product( aboutZ( q1 ), aboutY( q2 + q3 ) ) ), at );
			for ( const double flip : { 1.0, -1.0 } )
			{
				const double q5 = flip * std::acos( std::clamp( wrist[2][2], -1.0, 1.0 ) );
				Vector q = { q1, q2, q3, std::atan2( flip * wrist[1][2], flip * wrist[0][2] ), q5,
				    std::atan2( flip * wrist[2][1], -flip * wrist[2][0] ) };
				for ( double& angle : q )
				{
					angle = std::remainder( angle, 2 * half );
				}
				states.push_back( q );
			}
		}
	}
	return states;
}

/// No two branches are near each other, so that a count is a count.
bool isRegular( const std::vector<Vector>& states )
{
	for ( std::size_t i = 0; i < states.size(); ++i )
	{
		for ( std::size_t k = 0; k < i; ++k )
		{
			if ( largest( states[i], states[k], true ) < 0.1 )
			{
				return false;
			}
		}
	}
	return true;
}

} // namespace

TEST( Inverse, StatesHaveTheirPose )
{
	for ( const std::string& urdf : { sixAxisArm(), sevenAxisArm(), sevenAxisArm( "continuous" ) } )
	{
		const PoseWorld world( urdf );
		ik::Inverse inverse( world.robot, world.problem, frameOf( world, "hand" ) );
		SeededRng rng;
		int near = 0;
		for ( int i = 0; i < 100; ++i )
		{
			const Vector q = world.randomState( rng );
			Vector start = q;
			for ( double& value : start )
			{
				value += rng.uniform( -0.1, 0.1 );
			}
			const Matrix at = world.pose( "hand", q );
			const ik::InverseStates found = inverse.solve( toTransform( at ), start.data() );
			ASSERT_FALSE( found.states.empty() ) << found.problem;
			EXPECT_EQ( found.failure, ik::Failure::NONE );
			double before = 0;
			for ( const ik::InverseState& state : found.states )
			{
				EXPECT_LE( apart( at, world.pose( "hand", state.q ) ), 1.1e-9 );
				EXPECT_TRUE( io::limitViolations( world.problem, state.q ).empty() );
				EXPECT_GE( squares( state.q, start ), before );
				before = squares( state.q, start );
			}
			for ( std::size_t a = 0; a < found.states.size(); ++a )
			{
				for ( std::size_t b = 0; b < a; ++b )
				{
					EXPECT_GE( largest( found.states[a].q, found.states[b].q, false ), 0.01 );
				}
			}
			near += largest( found.states[0].q, start, false ) < 0.3 ? 1 : 0;
		}
		EXPECT_GE( near, 85 ); // not all: limits and singularities are in between
	}
}

TEST( Inverse, BranchesOfASphericalWristAreFoundAndNoOthers )
{
	SeededRng rng;
	// of joints: all the way round; narrow, so that most branches are outside; a pair in the middle
	for ( const std::array<double, 6>& limits : { std::array<double, 6>{ 3.2, 3.2, 3.2, 3.2, 3.2, 3.2 },
	          std::array<double, 6>{ 2.9, 2.2, 2.5, 3.1, 2.1, 3.1 }, std::array<double, 6>{ 1.5, 1.5, 2, 2, 1.8, 2.5 } } )
	{
		const PoseWorld world( wristArm( limits ) );
		ik::Inverse inverse( world.robot, world.problem, frameOf( world, "j6_link" ) );
		std::size_t wanted = 0, seen = 0;
		for ( int i = 0; i < 100; )
		{
			const Matrix at = world.pose( "j6_link", world.randomState( rng ) );
			const std::vector<Vector> all = closedForm( at );
			if ( !isRegular( all ) )
			{
				continue;
			}
			++i;
			const ik::InverseStates found = inverse.solve( toTransform( at ) );
			for ( const ik::InverseState& state : found.states )
			{
				EXPECT_TRUE( std::any_of(
				    all.begin(), all.end(), [&]( const Vector& q ) { return largest( q, state.q, true ) < 1e-6; } ) );
			}
			for ( const Vector& q : all )
			{
				const bool inside = io::limitViolations( world.problem, q ).empty();
				wanted += inside ? 1 : 0;
				seen += inside && std::any_of( found.states.begin(), found.states.end(),
				                      [&]( const ik::InverseState& state ) { return largest( q, state.q, true ) < 1e-6; } );
			}
		}
		std::printf( "limits %g: %zu of %zu branches\n", limits[0], seen, wanted );
		EXPECT_GE( static_cast<double>( seen ), 0.97 * static_cast<double>( wanted ) );
	}
}

TEST( Inverse, WholeTurnsAreStatesOnlyIfWanted )
{
	const PoseWorld world( wristArm( { 2 * half, 1.5, 3, 2 * half, 2, 2 * half } ) );
	ik::Inverse inverse( world.robot, world.problem, frameOf( world, "j6_link" ) );
	const Vector q = { 3.5, 0.4, 1.2, -4, 0.9, 0.5 };
	const lw_transform at = toTransform( world.pose( "j6_link", q ) );
	const ik::InverseStates near = inverse.solve( at, q.data() );
	ASSERT_FALSE( near.states.empty() );
	EXPECT_LT( largest( near.states[0].q, q, false ), 1e-8 );
	ik::InverseOptions options;
	options.turns = true;
	options.states = 1000;
	const ik::InverseStates all = inverse.solve( at, q.data(), options );
	EXPECT_EQ( all.states.size(), 8 * near.states.size() );
	for ( const ik::InverseState& state : all.states )
	{
		EXPECT_LE( apart( world.pose( "j6_link", q ), world.pose( "j6_link", state.q ) ), 1.1e-9 );
		EXPECT_TRUE( io::limitViolations( world.problem, state.q ).empty() );
	}
}

TEST( Inverse, AFrameThatMovesItselfIsTheBase )
{
	const std::string limits = "<limit lower='-2.5' upper='2.5' effort='1' velocity='1'/>";
	std::string urdf =
	    "<robot name='two'><link name='base'><collision><geometry><sphere radius='0.05'/></geometry></collision></link>";
	for ( const std::string side : { "l", "r" } )
	{
		std::string last = "base";
		for ( int i = 0; i < 5; ++i )
		{
			const std::string link = side + std::to_string( i );
			urdf += "<link name='" + link + "'/><joint name='j" + link + "' type='revolute'><parent link='" + last +
			        "'/><child link='" + link + "'/><origin xyz='" +
			        ( i == 0 ? ( side == "l" ? "0 0.2 0" : "0 -0.2 0" ) : "0.03 0 0.25" ) + "'/><axis xyz='" +
			        ( i % 2 == 0 ? "0 0 1" : "0 1 0.2" ) + "'/>" + limits + "</joint>";
			last = link;
		}
	}
	const PoseWorld world( urdf + "</robot>" );
	io::Frame tip = frameOf( world, "l4" );
	tip.pose.t[2] = 0.1;
	ik::Inverse inverse( world.robot, world.problem, tip, frameOf( world, "r4" ) );
	SeededRng rng;
	Matrix tool = identity();
	tool[2][3] = 0.1;
	for ( int i = 0; i < 30; ++i )
	{
		const auto wantedAt = [&]( const Vector& q )
		{ return product( inverseOf( world.pose( "r4", q ) ), product( world.pose( "l4", q ), tool ) ); };
		const Matrix at = wantedAt( world.randomState( rng ) );
		const ik::InverseStates found = inverse.solve( toTransform( at ) );
		ASSERT_FALSE( found.states.empty() ) << found.problem;
		for ( const ik::InverseState& state : found.states )
		{
			EXPECT_LE( apart( at, wantedAt( state.q ) ), 1.1e-9 );
		}
	}
}

TEST( Inverse, StatesInCollisionComeLastWithTheirIntervals )
{
	const std::string urdf = sevenAxisArm();
	const PoseWorld empty( urdf );
	const Vector q = { 0.3, 0.5, 0.2, 1, -1, 0.5, 1 };
	const Matrix at = empty.pose( "hand", q );
	const auto ballAt = [&]( double radius, double side )
	{
		return "name: s\nworld:\n  collision_objects:\n    - id: ball\n      primitives:\n        - type: sphere\n          dimensions: [" +
		       std::to_string( radius ) + "]\n      primitive_poses:\n        - position: [" +
		       std::to_string( at[0][3] + side ) + ", " + std::to_string( at[1][3] ) + ", " + std::to_string( at[2][3] ) +
		       "]\n          orientation: [0, 0, 0, 1]\n";
	};
	const PoseWorld apart_world( urdf, ballAt( 0.05, 0.2 ) ), contact( urdf, ballAt( 0.05, 0.01 ) );
	ik::InverseOptions options;
	options.clearances = true;
	options.min_d = 0.1;
	ik::Inverse inverse( apart_world.robot, apart_world.problem, frameOf( apart_world, "hand" ) );
	const ik::InverseStates found = inverse.solve( toTransform( at ), q.data(), options );
	ASSERT_EQ( found.failure, ik::Failure::NONE );
	bool all = true;
	for ( const ik::InverseState& state : found.states )
	{
		EXPECT_LE( state.lower, state.upper );
		EXPECT_LE( state.upper, 0.131 ); // the hand's ball of 2 cm is there in every state
		EXPECT_EQ( state.lower > 0.1, apart_world.isFree( state.q, 0.1 ) );
		EXPECT_TRUE( all || !( state.lower > 0.1 ) );
		all = state.lower > 0.1;
	}
	ik::Inverse blocked( contact.robot, contact.problem, frameOf( contact, "hand" ) );
	options.min_d = 0;
	const ik::InverseStates none = blocked.solve( toTransform( at ), q.data(), options );
	EXPECT_EQ( none.failure, ik::Failure::IN_COLLISION );
	EXPECT_FALSE( none.states.empty() );
	EXPECT_NE( none.problem.find( "none has a clearance above 0 m" ), std::string::npos ) << none.problem;
}

TEST( Inverse, ReasonsAreNamed )
{
	const PoseWorld world( sixAxisArm() );
	ik::Inverse inverse( world.robot, world.problem, frameOf( world, "hand" ) );
	const ik::InverseStates far = inverse.solve( toTransform( fromQuaternion( { 3, 0, 0.3 }, { 0, 0, 0, 1 } ) ) );
	EXPECT_EQ( far.failure, ik::Failure::UNREACHABLE );
	EXPECT_GT( far.metres, 1.5 );
	EXPECT_NE( far.problem.find( "no state of the robot reaches the pose" ), std::string::npos ) << far.problem;
	const ik::InverseStates outside = inverse.solve( toTransform( world.pose( "hand", { 0, 2.3, 0.2, 0.3, 0.4, 0.5 } ) ) );
	EXPECT_EQ( outside.failure, ik::Failure::OUT_OF_LIMITS );
	EXPECT_NE( outside.problem.find( "joint j" ), std::string::npos ) << outside.problem;
	EXPECT_GT( outside.metres + outside.radians, 1e-6 );
	EXPECT_TRUE( far.states.empty() && outside.states.empty() );
}

TEST( Inverse, QuestionsThatCannotBeMeant )
{
	const PoseWorld world( ArmText().add( "j1", "revolute", "xyz='0 0 0.3'", "0 0 1", -2.9, 2.9 ).text() );
	ik::Inverse inverse( world.robot, world.problem, frameOf( world, "hand" ) );
	const auto message = [&]( const lw_transform& pose, const Vector& start, const ik::InverseOptions& options )
	{
		try
		{
			inverse.solve( pose, start.data(), options );
		}
		catch ( const io::Error& error )
		{
			return std::string( error.what() );
		}
		return std::string( "nothing" );
	};
	lw_transform wrong = lw_transform_identity();
	wrong.t[1] = NAN;
	EXPECT_NE( message( wrong, { 0 }, {} ).find( "pose" ), std::string::npos );
	wrong = lw_transform{};
	EXPECT_NE( message( wrong, { 0 }, {} ).find( "no rigid motion" ), std::string::npos );
	EXPECT_NE( message( lw_transform_identity(), { INFINITY }, {} ).find( "joint j1 is not finite" ), std::string::npos );
	ik::InverseOptions options;
	options.states = 0;
	EXPECT_NE( message( lw_transform_identity(), { 0 }, options ).find( "above 0" ), std::string::npos );
	options = {};
	options.clearances = true;
	options.min_d = -1;
	EXPECT_NE( message( lw_transform_identity(), { 0 }, options ).find( "min_d" ), std::string::npos );
	try
	{
		const ik::Inverse none( world.robot, world.problem, frameOf( world, "base" ) );
		ADD_FAILURE() << "the base does not move";
	}
	catch ( const io::Error& error )
	{
		EXPECT_NE( std::string( error.what() ).find( "no joint of it moves base" ), std::string::npos ) << error.what();
	}
}

TEST( Inverse, EqualSeedsGiveEqualStates )
{
	const PoseWorld world( sevenAxisArm() );
	ik::Inverse first( world.robot, world.problem, frameOf( world, "hand" ) ),
	    second( world.robot, world.problem, frameOf( world, "hand" ) );
	const lw_transform at = toTransform( world.pose( "hand", { 0.3, 0.5, 0.2, 1, -1, 0.5, 1 } ) );
	second.solve(
	    toTransform( world.pose( "hand", { 0.1, 0.5, 0.2, 1, -1, 0.5, 1 } ) ) ); // earlier questions change nothing
	ik::InverseOptions options;
	const auto statesOf = [&]( ik::Inverse& inverse )
	{
		std::vector<Vector> states;
		for ( const ik::InverseState& state : inverse.solve( at, nullptr, options ).states )
		{
			states.push_back( state.q );
		}
		return states;
	};
	const std::vector<Vector> states = statesOf( first );
	EXPECT_EQ( states.size(), 16u );
	EXPECT_EQ( states, statesOf( second ) );
	options.seed = 2;
	EXPECT_NE( states, statesOf( second ) );
}
