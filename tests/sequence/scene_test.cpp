// SPDX-License-Identifier: BSD-3-Clause
// Scenes that change between legs: a part belongs to the hand behind the grasp, and stands where it was left. The referees compute distances of boxes
// and balls from the joint values alone.
#include "sequence_world.hpp"

namespace
{

using Kind = io::SceneEdit::Kind;

constexpr double ball = 0.03, half[3] = { 0.1, 0.01, 0.01 }; ///< radius of the post; half lengths of the bar

/// A bar in front of the stretched hand, and a post that the hand passes beneath, but not the bar.
const char* const bar_and_post = R"(
world:
  collision_objects:
    - {id: bar, pose: {position: [0.93, 0, 0], orientation: [0, 0, 0, 1]}, primitives: [{type: box, dimensions: [0.2, 0.02, 0.02]}]}
    - {id: post, pose: {position: [0.648, 0.667, 0], orientation: [0, 0, 0, 1]}, primitives: [{type: sphere, dimensions: [0.03]}]}
)";

/// Distance of a point from the surface of a box around the origin of `pose`; 0 inside.
double distanceToBox( const lw_transform& pose, const double ( &halves )[3], const double ( &point )[3] )
{
	double square = 0;
	for ( int i = 0; i < 3; ++i )
	{
		double along = 0;
		for ( int k = 0; k < 3; ++k )
		{
			along += pose.r[k][i] * ( point[k] - pose.t[k] );
		}
		const double beyond = std::max( std::fabs( along ) - halves[i], 0.0 );
		square += beyond * beyond;
	}
	return std::sqrt( square );
}

struct HandWorld : SequenceWorld
{
	io::World world;

	explicit HandWorld( const std::string& scene ) : SequenceWorld( scene ), world( robot, optionsOf( model ), problem )
	{
		start = { -0.5, 0.3 };
	}

	/// The last leg changes the scene first.
	io::SceneEdit& edit( Kind kind, const std::string& object )
	{
		io::SceneDiff& diff = legs.back().scene;
		diff.file = "request.yaml";
		diff.edits.emplace_back();
		diff.edits.back().kind = kind;
		diff.edits.back().object.name = object;
		diff.edits.back().element = legs.back().element = "items[" + std::to_string( legs.size() - 1 ) + "]";
		diff.edits.back().link = kind == Kind::attach ? "hand" : "";
		return diff.edits.back();
	}
	/// The last leg adds the object of a scene.
	void add( const std::string& name, const std::string& scene )
	{
		edit( Kind::add, name ).object.shapes = io::parseScene( scene, "added" ).objects[0].shapes;
	}
	sequence::Result plan() const { return sequence::planSequence( robot, world, legs, settings, start ); }
	std::vector<sequence::Chapter> chapters( const sequence::Result& r ) const
	{
		const std::vector<motions::Segment> driven =
		    motions::segmentsOf( problem, motions::endsOf( problem, r.segments ), motions::Interpolation::automatic, 0 );
		return sequence::chaptersOf( world, legs, r, driven, start );
	}
	motions::TrajectoryAudit audit( const sequence::Result& r ) const
	{
		motions::TrajectorySettings as_driven;
		as_driven.edge = settings.edge;
		return sequence::auditChapters( robot, chapters( r ), "plan", as_driven );
	}
	/// States of a leg, densely.
	static std::vector<Vector> samples( const sequence::Result& r, std::size_t leg )
	{
		std::vector<Vector> states;
		for ( int i = 0; i <= 1000; ++i )
		{
			states.push_back( motions::stateAt( r.segments, r.legs[leg].begin + r.legs[leg].seconds * i / 1000 ) );
		}
		return states;
	}
	/// Where a body is that was at `then` when the hand was at `grasp`, and moves with the hand.
	lw_transform carried( const lw_transform& then, const Vector& grasp, const Vector& now ) const
	{
		const lw_transform hand = tip( grasp ), back = lw_transform_inverse( &hand ), at = tip( now ),
		                   held = lw_transform_multiply( &back, &then );
		return lw_transform_multiply( &at, &held );
	}
	/// The least distance of bar and post over a leg, if the hand has held the bar since `grasp`.
	double barToPost( const sequence::Result& r, std::size_t leg, const Vector& grasp ) const
	{
		double least = HUGE_VAL;
		for ( const Vector& q : samples( r, leg ) )
		{
			const lw_transform bar = carried( placed( 0.93, 0, 0, 0 ), grasp, q );
			least = std::min( least, distanceToBox( bar, half, { 0.648, 0.667, 0 } ) );
		}
		return least;
	}

private:
	static io::ProblemOptions optionsOf( const io::SceneModel& scene )
	{
		io::ProblemOptions options;
		options.scene = &scene;
		return options;
	}
};

template <typename F> void expectError( const F& call, const std::string& element, const std::string& part )
{
	try
	{
		call();
		ADD_FAILURE() << "no error of " << element;
	}
	catch ( const io::Error& error )
	{
		EXPECT_EQ( element, error.element() );
		EXPECT_NE( std::string::npos, std::string( error.what() ).find( part ) ) << error.what();
	}
}

} // namespace

TEST( SequenceScene, AHeldPartHitsAPostThatTheEmptyHandPasses )
{
	HandWorld world( bar_and_post );
	world.toGoals( { { 0, 0 } } );
	world.toGoals( { { 1.6, 0 } } );
	const sequence::Result empty = world.plan();
	ASSERT_TRUE( empty.solved );
	EXPECT_LT( world.barToPost( empty, 1, { 0, 0 } ), ball ); // the plan of the empty hand would hit it
	world.edit( Kind::attach, "bar" );
	const sequence::Result r = world.plan();
	ASSERT_TRUE( r.solved ) << sequence::describe( r );
	EXPECT_GT( world.barToPost( r, 1, { 0, 0 } ), ball );
	EXPECT_TRUE( world.audit( r ).valid() );
	EXPECT_EQ( 2u, world.chapters( r ).size() );
	EXPECT_NE( std::string::npos, sequence::describe( r, world.legs ).find( "leg 2: begins with: attach bar to hand" ) );
	EXPECT_TRUE( world.world.holder( "bar" ).empty() ); // the world of before is as it was
}

TEST( SequenceScene, TheTrajectoryIsProvedInTheFirstScene )
{
	// The plan of the empty hand is free in the scene of its first leg, and in that of the second it hits
	HandWorld world( bar_and_post );
	world.toGoals( { { 0, 0 } } );
	world.toGoals( { { 1.6, 0 } } );
	const sequence::Result empty = world.plan();
	ASSERT_TRUE( empty.solved );
	EXPECT_TRUE( world.audit( empty ).valid() );
	world.edit( Kind::attach, "bar" );
	const motions::TrajectoryAudit audit = world.audit( empty );
	EXPECT_EQ( LW_VERDICT_BLOCKED, audit.violation.verdict );
	EXPECT_GT( audit.violation.time, empty.legs[1].begin );
	EXPECT_EQ( "bar", audit.violation.pair.first );
	EXPECT_EQ( "post", audit.violation.pair.second );
	EXPECT_EQ( empty.segments.size(), audit.segments );
	EXPECT_NEAR( empty.legs[1].begin + empty.legs[1].seconds, audit.duration, 1e-8 );
}

TEST( SequenceScene, TheProofOfALaterSceneHidesAViolation )
{
	HandWorld world( bar_and_post );
	world.toGoals( { { 0, 0 } } );
	world.toGoals( { { 1.6, 0 } } );
	world.toGoals( { { 1.6, 0.5 } } );
	const sequence::Result empty = world.plan();
	ASSERT_TRUE( empty.solved );
	world.edit( Kind::release, "bar" );
	world.legs[1].scene = world.legs[2].scene;
	world.legs[1].scene.edits[0].kind = Kind::attach;
	world.legs[1].scene.edits[0].link = "hand";
	EXPECT_EQ( 3u, world.chapters( empty ).size() );
	const motions::TrajectoryAudit audit = world.audit( empty );
	EXPECT_FALSE( audit.valid() );
	EXPECT_EQ( 0, audit.lower_bound );
}

TEST( SequenceScene, TheLeftPartIsNoObstacle )
{
	// Held at (0, 1) and left at (1.6, 1), in front of the straight way to the last goal
	const std::string scene = R"(
world:
  collision_objects:
    - id: block
      pose: {position: [0.6484, 0.3875, 0], orientation: [0, 0, 0.479426, 0.877583]}
      primitives: [{type: box, dimensions: [0.06, 0.04, 0.04]}]
)";
	const double halves[3] = { 0.03, 0.02, 0.02 };
	HandWorld world( scene );
	world.start = { -0.3, 1.1 };
	world.toGoals( { { 0, 1 } } );
	world.toGoals( { { 1.6, 1 } } );
	world.edit( Kind::attach, "block" );
	world.toGoals( { { 2.8, -0.9 } } );
	world.edit( Kind::release, "block" );
	const lw_transform then = world.carried( placed( 0.6484, 0.3875, 0, 0, 0, 1 ), { 0, 1 }, { 1.6, 1 } );
	const auto nearest = [&]( const sequence::Result& r )
	{
		double least = HUGE_VAL;
		for ( const Vector& q : HandWorld::samples( r, 2 ) )
		{
			const lw_transform hand = world.tip( q );
			least = std::min( least, distanceToBox( then, halves, { hand.t[0], hand.t[1], hand.t[2] } ) );
		}
		return least;
	};
	const sequence::Result r = world.plan();
	ASSERT_TRUE( r.solved ) << sequence::describe( r );
	EXPECT_GT( nearest( r ), 0.02 ); // the ball of the hand
	EXPECT_TRUE( world.audit( r ).valid() );
	world.legs[1].scene = world.legs[2].scene = {};
	world.edit( Kind::remove, "block" );
	const sequence::Result without = world.plan();
	ASSERT_TRUE( without.solved );
	EXPECT_LT( nearest( without ), 0.02 ); // else the test would not see it
}

TEST( SequenceScene, ThePartIsHeldAsTheOtherGraspHoldsIt )
{
	// Of both branches of the elbow one would bring the block into the post, at the same last state
	const std::string scene = R"(
world:
  collision_objects:
    - {id: block, pose: {position: [0.53, 0.15, 0]}, primitives: [{type: box, dimensions: [0.04, 0.02, 0.02]}]}
    - {id: post, pose: {position: [-0.0037, 0.7778, 0]}, primitives: [{type: sphere, dimensions: [0.02]}]}
)";
	const double halves[3] = { 0.02, 0.01, 0.01 };
	HandWorld world( scene );
	const std::vector<Vector> branches = world.branches( 0.45, 0.15 );
	world.start = { branches[0][0] - 0.1, branches[0][1] + 0.1 }; // the wrong one is nearer
	world.toGoals( branches );
	world.toGoals( { { 1.2, 0.9 } } );
	world.edit( Kind::attach, "block" );
	const sequence::Result r = world.plan();
	ASSERT_TRUE( r.solved ) << sequence::describe( r );
	const Vector grasp = motions::stateAt( r.segments, r.legs[1].begin );
	EXPECT_LT( grasp[1], 0 );
	EXPECT_EQ( 1u, r.legs[0].tried );
	for ( const Vector& q : HandWorld::samples( r, 1 ) )
	{
		const lw_transform block = world.carried( placed( 0.53, 0.15, 0, 0 ), grasp, q );
		ASSERT_GT( distanceToBox( block, halves, { -0.0037, 0.7778, 0 } ), 0.02 );
	}
	const lw_transform hand = world.tip( grasp ), back = lw_transform_inverse( &hand ), block = placed( 0.53, 0.15, 0, 0 ),
	                   held = lw_transform_multiply( &back, &block );
	const std::vector<sequence::Chapter> chapters = world.chapters( r );
	for ( int i = 0; i < 3; ++i )
	{
		EXPECT_NEAR( held.t[i], chapters[1].problem->object_poses.at( "block" ).t[i], 1e-12 );
	}
	world.legs.resize( 1 );
	const sequence::Result alone = world.plan();
	EXPECT_GT( alone.segments.back().points.back(), 0 ); // without the second leg the wrong one is taken
}

TEST( SequenceScene, LinesBehindTheGraspForgetThePart )
{
	// The same, by lines: from the grasp the retreat is planned with the bar in the hand before the motion to the grasp is
	HandWorld world( bar_and_post );
	world.toGoals( { { 0, 0.05 }, { 0, -0.05 } } );
	world.along( 0.65, 0.0 );
	world.edit( Kind::attach, "bar" );
	world.legs.back().line->free_axis = lw_vec3{ 0, 0, 1 };
	const sequence::Result r = world.plan();
	ASSERT_TRUE( r.solved ) << sequence::describe( r );
	EXPECT_TRUE( world.audit( r ).valid() );
	const Vector grasp = motions::stateAt( r.segments, r.legs[1].begin );
	EXPECT_GT( world.barToPost( r, 1, grasp ), ball );
	world.add( "wall", boxAt( "[0.86, 0, 0]", "[0.02, 0.3, 0.3]" ) ); // in the bar
	const sequence::Result blocked = world.plan();
	EXPECT_FALSE( blocked.solved );
	EXPECT_EQ( 1u, blocked.failed );
	EXPECT_EQ( 2u, blocked.goals );
	const std::string text = sequence::describe( blocked );
	EXPECT_NE( std::string::npos, text.find( "bar - wall" ) ) << text;
	EXPECT_NE( std::string::npos, text.find( "allowed_collision_matrix" ) ) << text;
	io::ContactMatrix matrix;
	matrix.allowed = { { "wall", "bar" } };
	matrix.names = { "wall", "bar" };
	world.legs.back().scene.matrix = matrix;
	EXPECT_TRUE( world.plan().solved );
}

TEST( SequenceScene, AnUnknownObjectIsNoError )
{
	HandWorld world( bar_and_post );
	world.toGoals( { { 0, 0 } } );
	world.toGoals( { { 1.6, 0 } } );
	world.edit( Kind::remove, "baar" );
	expectError( [&] { world.plan(); }, "items[1]", "there is no object baar by then; use one of bar, post" );
	world.legs[1].scene = {};
	world.edit( Kind::attach, "bar" ).link = "palm";
	expectError( [&] { world.plan(); }, "items[1]", "palm" );
	world.legs[1].scene = {};
	world.edit( Kind::attach, "bar" );
	world.toGoals( { { 0, 0 } } );
	world.edit( Kind::attach, "bar" );
	world.settings.seconds = 1e-9; // the search does not come to the last leg
	expectError( [&] { world.plan(); }, "items[2]", "is attached to link hand by then" );
	expectError( [&] { sequence::planSequence( world.robot, world.problem, world.legs, world.settings, world.start ); },
	    "items[1]", "plan in an io::World" );
}

TEST( SequenceScene, ABlendGoesThroughAChange )
{
	HandWorld world( bar_and_post );
	world.toGoals( { { 0, 0.3 } } );
	world.along( 0.7, 0.0 );
	world.along( 0.6, 0.0 );
	world.edit( Kind::attach, "bar" );
	world.legs[1].blend = 0.02;
	expectError( [&] { world.plan(); }, "legs[1]", "the scene changes before the next line" );
	world.legs[2].scene = {};
	EXPECT_TRUE( world.plan().solved );
}

TEST( SequenceScene, AChangeWithoutARestIsProved )
{
	HandWorld world( bar_and_post );
	world.toGoals( { { 0, 0 } } );
	world.toGoals( { { 1.6, 0 } } );
	sequence::Result r = world.plan();
	world.edit( Kind::attach, "bar" );
	std::vector<motions::Segment> segments = r.segments;
	segments[r.legs[1].first].points[2] += 1e-6;
	expectError( [&] { sequence::chaptersOf( world.world, world.legs, r, segments, world.start ); }, "items[1]", "rest" );
	segments = r.segments;
	segments[r.legs[1].first - 1].points[4] += 1e-6;
	expectError( [&] { sequence::chaptersOf( world.world, world.legs, r, segments, world.start ); }, "items[1]", "rest" );
}

TEST( SequenceScene, ALegThatGoesNowhereIsNotProved )
{
	// The robot stays, and the scene changes to one in which it cannot
	HandWorld world( bar_and_post );
	world.toGoals( { { 1, 0 } } );
	world.toGoals( { { 1, 0 } } );
	sequence::Result r = world.plan();
	ASSERT_TRUE( r.solved ) << sequence::describe( r );
	ASSERT_EQ( 0u, r.legs[1].count );
	EXPECT_TRUE( world.audit( r ).valid() );
	world.add( "wall", boxAt( "[0.4322, 0.6732, 0]", "[0.1, 0.1, 0.1]" ) );
	EXPECT_FALSE( world.audit( r ).valid() );
	EXPECT_FALSE( world.plan().solved );
}

TEST( SequenceScene, AGoalWithinRoundingOfTheStateIsNotReached )
{
	HandWorld world( bar_and_post );
	world.toGoals( { { 1, 0 } } );
	world.toGoals( { { 1 + 1e-15, 0 } } );
	world.toGoals( { { 0.5, 0 } } );
	const sequence::Result r = world.plan();
	ASSERT_TRUE( r.solved ) << sequence::describe( r );
	EXPECT_EQ( 0u, r.legs[1].count );
	EXPECT_EQ( r.segments.size(), r.legs[0].count + r.legs[2].count );
	EXPECT_TRUE( world.audit( r ).valid() );
}

TEST( SequenceScene, AHeldPartIsNoLinkOfALine )
{
	// Behind the grasp the part itself goes along a line; before, it is an object of the world, and no link
	HandWorld world( bar_and_post );
	world.toGoals( { { 0, 0 } } );
	io::PathConstraints path;
	io::parseConstrainedRequest( "request",
	    R"({"items": [{"req": {"start_state": {}, "link_name": "bar", "waypoints": [{"position": [0.6, 0.3, 0]}]}}]})",
	    path );
	lines::Task line;
	line.free_axis = lw_vec3{ 0, 0, 1 };
	line.tolerance = world.task.tolerance;
	world.legs.push_back( sequence::legsOf( path, line )[0] );
	world.edit( Kind::attach, "bar" );
	const sequence::Result r = world.plan();
	ASSERT_TRUE( r.solved ) << sequence::describe( r );
	const Vector& end = r.segments.back().points;
	const lw_transform bar = world.carried( placed( 0.93, 0, 0, 0 ), { 0, 0 }, { end.end() - 2, end.end() } );
	EXPECT_NEAR( 0.6, bar.t[0], 2e-4 );
	EXPECT_NEAR( 0.3, bar.t[1], 2e-4 );
}
