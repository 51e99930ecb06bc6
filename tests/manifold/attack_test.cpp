// SPDX-License-Identifier: BSD-3-Clause
// Random arms, constraints, starts and goals: no state of a plan breaks a constraint, by kinematics in long double at dense times and by descents
// from the worst of them. LEEWAY_MANIFOLD_PLANS sets how many.
#include "manifold_world.hpp"

#include <cstdlib>

namespace
{

std::string number( double value )
{
	return std::to_string( value );
}

/// Six to eight joints about axes in any direction, one of three at right angles; perhaps one slides.
std::string randomArm( SeededRng& rng )
{
	ArmText arm;
	const int joints = rng.integer( 6, 8 );
	for ( int i = 0; i < joints; ++i )
	{
		const bool slides = rng.integer( 0, 11 ) == 0;
		const char* const axes[] = { "1 0 0", "0 1 0", "0 0 1" };
		const std::string axis = rng.integer( 0, 2 ) > 0
		                             ? axes[rng.integer( 0, 2 )]
		                             : number( rng.uniform( -1, 1 ) ) + " " + number( rng.uniform( -1, 1 ) ) + " 1";
		const std::string origin = "xyz='" + number( rng.uniform( -0.1, 0.1 ) ) + " " + number( rng.uniform( -0.1, 0.1 ) ) +
		                           " " + number( rng.uniform( 0.05, 0.3 ) ) + "' rpy='" +
		                           number( rng.uniform( -0.5, 0.5 ) ) + " 0 0'";
		arm.add(
		    "j" + number( i ), slides ? "prismatic" : "revolute", origin, axis, slides ? -0.3 : -2.8, slides ? 0.3 : 2.8 );
	}
	return arm.text();
}

/// One or two constraints about a state, with tolerances from 0.0001 to 0.3.
void constrain( ManifoldWorld& world, SeededRng& rng, const Vector& q )
{
	using Kind = io::OrientationGoal::Parameterization;
	const double half = std::pow( 10, rng.uniform( -4, -0.5 ) ), any = 4;
	const Kind kind = rng.integer( 0, 1 ) == 0 ? Kind::euler_xyz : Kind::rotation_vector;
	const std::string frame = rng.integer( 0, 3 ) == 0 ? "j" + number( 0 ) + "_link" : "";
	switch ( rng.integer( 0, 4 ) )
	{
	case 0:
		world.keepOrientation( "hand", q, { half, half, any }, Kind::euler_xyz, frame );
		break;
	case 1:
		world.keepPlace( "hand", q, { 6, 6, 2 * half }, frame );
		break;
	case 2:
		world.keepPlace( "hand", q, { 6, 2 * half, 2 * half }, frame );
		break;
	case 3:
		world.keepOrientation( "hand", q, { half, half, half }, kind, frame );
		break;
	default:
		world.keepOrientation( "hand", q, { half, half, any }, Kind::euler_xyz, frame );
		world.keepPlace( "hand", q, { 6, 6, 2 * half }, frame );
	}
	const std::string first = world.problem.variable_names[0];
	rng.integer( 0, 3 ) == 0 ? world.path.joints.push_back( { first, q[0], 1, 1 } ) : void();
}

int plansWanted()
{
	const char* text = std::getenv( "LEEWAY_MANIFOLD_PLANS" );
	return text != nullptr ? std::atoi( text ) : 60;
}

} // namespace

TEST( ConstrainedPlanAttack, APlanBreaksItsConstraintBetweenSamples )
{
	SeededRng rng( 2604 );
	int solved = 0, tried = 0, near = 0;
	std::size_t bent = 0, straight = 0;
	judge::Real nearest = HUGE_VALL;
	for ( int round = 0; round < plansWanted(); ++round )
	{
		const std::string ball = number( rng.uniform( -0.4, 0.4 ) ) + ", " + number( rng.uniform( -0.4, 0.4 ) ) + ", " +
		                         number( rng.uniform( 0.2, 0.8 ) );
		ManifoldWorld world( randomArm( rng ),
		    "world:\n  collision_objects:\n    - {id: ball, primitives: [{type: sphere, dimensions: [0.08]}], "
		    "primitive_poses: [{position: [" +
		        ball + "], orientation: [0, 0, 0, 1]}]}\n" );
		const Vector about = world.randomState( rng );
		constrain( world, rng, about );
		manifold::Manifold manifold( world.robot, world.problem, world.path );
		world.task.start = about;
		Vector goal = about;
		for ( double& value : goal )
		{
			value += rng.uniform( -1.5, 1.5 );
		}
		if ( !manifold.project( world.task.start.data() ) || !manifold.project( goal.data() ) ||
		     !world.isFree( world.task.start ) || !world.isFree( goal ) )
		{
			continue;
		}
		++tried;
		world.task.goals = { goal };
		world.settings.edge.flags = LW_CHECK_BOTH;
		world.settings.seconds = 1;
		world.settings.shortcuts = 20;
		world.settings.seed = static_cast<std::uint64_t>( round ) + 1;
		const manifold::Result r = world.plan();
		if ( !r.solved() )
		{
			continue;
		}
		++solved;
		bent += r.bent;
		straight += r.straight;
		const judge::Real worst = world.worst( r.segments, 40 );
		EXPECT_LE( worst, 0 ) << "plan " << round;
		nearest = std::min( nearest, -worst );
		near += worst > -1e-5L ? 1 : 0;
		for ( const motions::Segment& segment : r.segments )
		{
			EXPECT_TRUE(
			    world.isFree( motions::stateAt( { segment }, segment.begin + rng.uniform( 0, 1 ) * segment.seconds ) ) );
		}
	}
	std::printf(
	    "%d of %d plans solved; %zu straight and %zu bent pieces; the nearest error to its limit %.3Lg, %d within 1e-5\n",
	    solved, tried, straight, bent, nearest, near );
	EXPECT_GT( solved, plansWanted() / 4 );
	EXPECT_GT( bent, 0u );
	EXPECT_GT( straight, 0u );
}
