// SPDX-License-Identifier: BSD-3-Clause
// Plans of small arms with cups, planes and lines, judged at dense times; starts, goals and constraints that cannot be.
#include "manifold_world.hpp"

#include "leeway/motions/timed.hpp"

namespace
{

const double any = 4; // radians: no limit
const Vector before = { -0.8, 0.6, 0.2, -1.2, 0.1, 0.5, 0.3 };

/// The state that keeps the constraints and is nearest to another.
Vector kept( const ManifoldWorld& world, Vector q )
{
	manifold::Manifold manifold( world.robot, world.problem, world.path );
	EXPECT_TRUE( manifold.project( q.data() ) );
	EXPECT_TRUE( manifold.violations( q.data() ).empty() );
	return q;
}

/// From one state to another, both led to the constraints.
void planBetween( ManifoldWorld& world, const Vector& from, const Vector& to )
{
	world.task.start = kept( world, from );
	world.task.goals = { kept( world, to ) };
}

} // namespace

TEST( ConstrainedPlan, ACupTiltsOnItsWay )
{
	ManifoldWorld world( sevenAxisArm() );
	world.keepOrientation( "hand", before, { 0.1, 0.1, any } );
	planBetween( world, before, { 0.9, 0.3, -0.4, -1.5, 0.5, 0.2, -0.4 } );
	world.expectKept( world.plan() );
}

TEST( ConstrainedPlan, AThinPlaneIsLeft )
{
	for ( const double half : { 1e-2, 1e-3, 1e-4 } )
	{
		ManifoldWorld world( sevenAxisArm() );
		world.keepPlace( "hand", before, { 4, 4, 2 * half } );
		planBetween( world, before, { 0.9, 0.3, -0.4, -1.5, 0.5, 0.2, -0.4 } );
		const manifold::Result r = world.plan();
		world.expectKept( r );
	}
}

TEST( ConstrainedPlan, AHandThatMayOnlySlideTurns )
{
	using Kind = io::OrientationGoal::Parameterization;
	for ( const Kind kind : { Kind::euler_xyz, Kind::rotation_vector } )
	{
		ManifoldWorld world( sevenAxisArm() );
		world.keepOrientation( "hand", before, { 1e-3, 1e-3, 1e-3 }, kind );
		world.keepPlace( "hand", before, { 4, 1e-3, 1e-3 } );
		Vector to = before;
		to[0] += 0.15;
		planBetween( world, before, to );
		world.expectKept( world.plan() );
	}
}

TEST( ConstrainedPlan, AStartThatBreaksThemIsTaken )
{
	ManifoldWorld world( sevenAxisArm() );
	world.keepOrientation( "hand", before, { 0.1, 0.1, any } );
	planBetween( world, before, { 0.9, 0.3, -0.4, -1.5, 0.5, 0.2, -0.4 } );
	world.task.start[5] += 0.4;
	const manifold::Result broken = world.plan();
	EXPECT_EQ( manifold::Outcome::START_BROKEN, broken.outcome );
	ASSERT_FALSE( broken.reasons.empty() );
	EXPECT_NE( std::string::npos, broken.reasons[0].find( "path_constraints.orientation_constraints[0] hand: turn" ) )
	    << broken.reasons[0];
	world.task.mend_start = true;
	const manifold::Result mended = world.plan();
	ASSERT_TRUE( mended.solved() ) << manifold::describe( mended );
	EXPECT_GT( mended.mended, 0 );
	EXPECT_LT( mended.mended_distance, 0.5 );
	EXPECT_EQ( world.task.start, Vector( mended.segments[0].points.begin(), mended.segments[0].points.begin() + 7 ) );
	std::vector<motions::Segment> later;
	for ( const motions::Segment& segment : mended.segments )
	{
		segment.begin >= mended.mended - 1e-9 ? later.push_back( segment ) : void();
	}
	ASSERT_LT( later.size(), mended.segments.size() );
	EXPECT_LE( world.worst( later, 50 ), 0 );
	EXPECT_GT( world.worst( mended.segments, 50 ), 0.1 );
}

TEST( ConstrainedPlan, AGoalWhereTheRobotStandsIsRefused )
{
	ManifoldWorld world( sevenAxisArm() );
	world.keepOrientation( "hand", before, { 0.1, 0.1, any } );
	planBetween( world, before, before );
	const manifold::Result r = world.plan();
	ASSERT_TRUE( r.solved() ) << manifold::describe( r );
	EXPECT_TRUE( r.segments.empty() );
	const motions::TrajectoryFile held = motions::endsOf( world.problem, r.segments, world.task.start );
	ASSERT_EQ( held.points.size(), 1u );
	EXPECT_EQ( held.points[0].positions, world.task.start );
	// nor does it go to another goal first
	world.task.goals.insert( world.task.goals.begin(), kept( world, { 0.9, 0.3, -0.4, -1.5, 0.5, 0.2, -0.4 } ) );
	const manifold::Result nearest = world.plan();
	EXPECT_TRUE( nearest.solved() && nearest.segments.empty() ) << manifold::describe( nearest );
	// a start that is mended into the goal has that motion alone
	world.task.start[5] += 0.4;
	world.task.mend_start = true;
	world.task.goals = { kept( world, world.task.start ) };
	const manifold::Result mended = world.plan();
	ASSERT_TRUE( mended.solved() ) << manifold::describe( mended );
	EXPECT_GT( mended.mended, 0 );
}

TEST( ConstrainedPlan, AGoalThatBreaksThemIsTaken )
{
	ManifoldWorld world( sevenAxisArm() );
	world.keepOrientation( "hand", before, { 0.1, 0.1, any } );
	planBetween( world, before, before );
	world.task.goals[0][5] += 0.4;
	const manifold::Result r = world.plan();
	EXPECT_EQ( manifold::Outcome::GOALS_BROKEN, r.outcome );
	EXPECT_FALSE( r.reasons.empty() );
}

TEST( ConstrainedPlan, ConstraintsThatExcludeEachOtherAreSearchedUntilTheTimeIsOver )
{
	ManifoldWorld world( sevenAxisArm() );
	world.keepPlace( "hand", before, { 0.1, 0.1, 0.1 } );
	world.keepPlace( "hand", before, { 0.1, 0.1, 0.1 } );
	world.path.positions[1].regions[0].pose.t[0] += 0.5;
	world.task.start = before;
	world.task.goals = { before };
	EXPECT_EQ( manifold::Outcome::EXCLUDED, world.plan().outcome );
}

TEST( ConstrainedPlan, AJointLeavesItsRange )
{
	ManifoldWorld world( sevenAxisArm() );
	world.path.joints.push_back( { "j4", -1.3, 0.3, 0.3 } );
	world.keepOrientation( "hand", before, { 0.3, 0.3, any } );
	planBetween( world, before, { 0.9, 0.3, -0.4, -1.5, 0.5, 0.2, -0.4 } );
	world.expectKept( world.plan() );
	world.path.joints[0].tolerance_above = world.path.joints[0].tolerance_below = 0;
	EXPECT_THROW( world.plan(), io::Error );
}

TEST( ConstrainedPlan, AJointThatWrapsGoesTheLongWay )
{
	ManifoldWorld world( sevenAxisArm( "continuous" ) );
	world.keepOrientation( "hand", before, { 0.1, 0.1, any } );
	Vector from = before, to = before;
	from[6] = 3;
	to[6] = -3;
	planBetween( world, from, to );
	const manifold::Result r = world.plan();
	world.expectKept( r );
	EXPECT_LT( r.length, 1.5 );
}

/// A wall between start and goal.
std::string wall( double thickness )
{
	return "world:\n  collision_objects:\n    - {id: wall, primitives: [{type: box, dimensions: [0.6, " +
	       std::to_string( thickness ) +
	       ", 1.2]}], primitive_poses: [{position: [0.6, 0, 0.6], orientation: [0, 0, 0, 1]}]}\n";
}

/// That wall, and no constraints.
ManifoldWorld walled( const std::string& wrist = "revolute" )
{
	return ManifoldWorld( sevenAxisArm( wrist ), wall( 0.04 ) );
}

TEST( ConstrainedPlan, AThinWallBetweenStatesIsPassed )
{
	// A hand of 4 mm and a wall of 1 mm: of states 0.1 rad apart nearly all are on one side of it
	std::string arm = sevenAxisArm();
	const std::string ball = "radius='0.02'";
	ASSERT_NE( std::string::npos, arm.find( ball ) );
	arm.replace( arm.find( ball ), ball.size(), "radius='0.002'" );
	for ( std::uint64_t seed = 1; seed <= 5; ++seed )
	{
		ManifoldWorld world( arm, wall( 0.001 ) );
		const Vector start = { -0.9, 1.2, 0, -0.3, 0, 0.3, 0 };
		world.keepPlace( "hand", start, { 4, 4, 2e-3 } );
		const lw_transform level = lw_transform_identity();
		lw_transform& box = world.path.positions[0].regions[0].pose;
		std::copy_n( &level.r[0][0], 9, &box.r[0][0] ); // the first joint alone would keep the height
		planBetween( world, start, { 0.9, 1.2, 0, -0.3, 0, 0.3, 0 } );
		world.settings.seed = seed;
		const manifold::Result r = world.plan();
		world.expectKept( r );
		EXPECT_LT( r.start_nodes + r.goal_nodes, 600u ) << "trees grow behind the wall again and again";
	}
}

TEST( FreePlan, AWallIsPassedThrough )
{
	for ( std::uint64_t seed = 1; seed <= 5; ++seed )
	{
		ManifoldWorld world = walled();
		world.task.start = { -0.9, 1.2, 0, -0.3, 0, 0.3, 0 };
		world.task.goals = { { 0.9, 1.2, 0, -0.3, 0, 0.3, 0 }, { 0.8, 1.1, 0.1, -0.2, 0, 0.3, 0 } };
		world.settings.seed = seed;
		const manifold::Result r = world.plan();
		world.expectKept( r );
		EXPECT_GT( r.start_nodes + r.goal_nodes, 3u );
		EXPECT_LE( r.length, r.raw_length );
		const Vector& last = r.segments.back().points;
		const Vector end( last.end() - 7, last.end() );
		EXPECT_TRUE( end == world.task.goals[0] || end == world.task.goals[1] );
	}
}

TEST( FreePlan, AJointThatWrapsJumpsByATurn )
{
	ManifoldWorld world = walled( "continuous" );
	world.task.start = { -0.9, 1.2, 3, -0.3, 3.1, 0.3, 3 };
	world.task.goals = { { 0.9, 1.2, -3, -0.3, -3.1, 0.3, -3 } };
	const manifold::Result r = world.plan();
	world.expectKept( r );
	const Vector& last = r.segments.back().points;
	EXPECT_GT( r.length, 1.9 ); // the wall is in the way
	EXPECT_LT( r.length, 6 );   // a whole turn alone is more
	for ( const std::size_t v : { 2u, 4u, 6u } )
	{
		const double turns = ( last[21 + v] - world.task.goals[0][v] ) / ( 2 * M_PI );
		EXPECT_NEAR( turns, std::round( turns ), 1e-9 );
	}
}

TEST( FreePlan, AStartBeyondALimitByItsToleranceIsLost )
{
	ManifoldWorld world = walled();
	world.task.start = { -0.9, 1.2, 2.9 + 5e-5, -0.3, 0, 0.3, 0 };
	world.task.goals = { { 0.9, 1.2, 2.5, -0.3, 0, 0.3, 0 } };
	const manifold::Result r = world.plan();
	ASSERT_TRUE( r.solved() ) << manifold::describe( r );
	EXPECT_EQ( world.task.start, Vector( r.segments[0].points.begin(), r.segments[0].points.begin() + 7 ) );
}

TEST( FreePlan, ItsTimeIsOverAndItSearchesOn )
{
	ManifoldWorld world = walled();
	world.task.start = { -0.9, 1.2, 0, -0.3, 0, 0.3, 0 };
	world.task.goals = { { 0.9, 1.2, 0, -0.3, 0, 0.3, 0 } };
	int asked = 0;
	world.settings.stop = [&asked] { return ++asked > 2; };
	const manifold::Result r = world.plan();
	EXPECT_EQ( r.outcome, manifold::Outcome::TIMED_OUT );
	EXPECT_LT( asked, 20 );
	world.settings.stop = nullptr;
	world.settings.most_nodes = 2;
	EXPECT_EQ( world.plan().outcome, manifold::Outcome::TIMED_OUT );
}

TEST( ConstrainedPlan, EqualSeedsGiveOtherPlans )
{
	ManifoldWorld world( sevenAxisArm() );
	world.keepPlace( "hand", before, { 4, 4, 2e-3 } );
	planBetween( world, before, { 0.9, 0.3, -0.4, -1.5, 0.5, 0.2, -0.4 } );
	const manifold::Result a = world.plan(), b = world.plan();
	ASSERT_TRUE( a.solved() && b.solved() );
	ASSERT_EQ( a.segments.size(), b.segments.size() );
	for ( std::size_t k = 0; k < a.segments.size(); ++k )
	{
		EXPECT_EQ( a.segments[k].points, b.segments[k].points );
	}
}

TEST( Manifold, DerivativesAreThoseOfOtherErrors )
{
	SeededRng rng( 11 );
	for ( int round = 0; round < 40; ++round )
	{
		ManifoldWorld world( sevenAxisArm() );
		const Vector at = world.randomState( rng );
		using Kind = io::OrientationGoal::Parameterization;
		world.keepOrientation( "hand", at, { 1e-3, 0.01, 0.01 }, round % 2 == 0 ? Kind::euler_xyz : Kind::rotation_vector,
		    round % 3 == 0 ? "j2_link" : "" );
		world.keepPlace( "hand", at, { 1e-3, 1e-3, 1e-3 }, round % 5 == 0 ? "j1_link" : "" );
		manifold::Manifold manifold( world.robot, world.problem, world.path );
		ASSERT_EQ( 6u, manifold.thinRows() );
		Vector q = at;
		for ( double& value : q )
		{
			value += rng.uniform( -0.1, 0.1 );
		}
		Vector values( 6 ), jacobian( 42 ), up( 6 ), down( 6 );
		manifold.errors( q.data(), values.data(), jacobian.data() );
		for ( std::size_t v = 0; v < 7; ++v )
		{
			const double step = 1e-6;
			Vector other = q;
			other[v] += step;
			manifold.errors( other.data(), up.data(), nullptr );
			other[v] -= 2 * step;
			manifold.errors( other.data(), down.data(), nullptr );
			for ( std::size_t r = 0; r < 6; ++r )
			{
				EXPECT_NEAR( ( up[r] - down[r] ) / ( 2 * step ), jacobian[7 * r + v], 1e-7 )
				    << round << " " << r << " " << v;
			}
		}
	}
}

TEST( Manifold, AProjectedStateStandsAtAJointLimit )
{
	// A path along a limit has no room to bend: no cubic near it is within the limit
	SeededRng rng( 12 );
	std::size_t projected = 0;
	for ( int round = 0; round < 40; ++round )
	{
		ManifoldWorld world( sevenAxisArm() );
		const Vector at = world.randomState( rng );
		world.keepPlace( "hand", at, { 2, 2, 1e-3 } );
		manifold::Manifold manifold( world.robot, world.problem, world.path );
		for ( int i = 0; i < 20; ++i )
		{
			Vector q( 7 );
			for ( std::size_t v = 0; v < 7; ++v )
			{
				// some begin at a limit, or beyond
				const double t = rng.uniform( -0.2, 1.2 );
				q[v] = manifold.lower()[v] + t * ( manifold.upper()[v] - manifold.lower()[v] );
			}
			if ( !manifold.project( q.data() ) )
			{
				continue;
			}
			++projected;
			for ( std::size_t v = 0; v < 7; ++v )
			{
				const double room = 0.9e-3 * ( manifold.upper()[v] - manifold.lower()[v] );
				ASSERT_GT( q[v], manifold.lower()[v] + room ) << round << " " << v;
				ASSERT_LT( q[v], manifold.upper()[v] - room ) << round << " " << v;
			}
		}
	}
	EXPECT_GT( projected, 200u );
}
