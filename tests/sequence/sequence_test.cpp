// SPDX-License-Identifier: BSD-3-Clause
// Approach, grasp and retreat in one call: the branch of a goal serves the legs behind it, legs join without a gap, and the leg that fails is named.
#include "sequence_world.hpp"

TEST( Sequence, LegsJumpWhereTheyJoin )
{
	SequenceWorld world;
	world.toGoals( world.branches( 0.5, 0.2 ) );
	world.along( 0.5, 0.3 );
	world.along( 0.4, 0.3 );
	world.toGoals( { { -0.5, 1 } } );
	const sequence::Result r = world.plan();
	world.expectJoined( r );
	EXPECT_TRUE( !r.legs[0].is_line && r.legs[1].is_line && r.legs[2].is_line && !r.legs[3].is_line );
	for ( int i = 0; i <= 20; ++i )
	{
		const sequence::Motion& leg = r.legs[1];
		const Vector q = motions::stateAt( r.segments, leg.begin + leg.seconds * i / 20 );
		EXPECT_NEAR( 0.5, world.x( q ), world.task.tolerance * 1.001 );
	}
	const Vector& end = r.segments.back().points;
	EXPECT_EQ( ( Vector{ -0.5, 1 } ), Vector( end.end() - 2, end.end() ) );
}

TEST( Sequence, TheNearestBranchOfAGoalHasNoWayOn )
{
	// With one sign of the elbow the shoulder has 1.85 rad at the end of the line, with the other 3.36, and its limit is 3
	SequenceWorld world;
	std::vector<Vector> goals = world.branches( -0.1, 0.5 );
	std::swap( goals[0], goals[1] ); // the first is tried first
	world.start = { goals[0][0] - 0.1, goals[0][1] + 0.1 };
	world.toGoals( goals );
	world.along( -0.5, 0.3 );
	const sequence::Result r = world.plan();
	world.expectJoined( r );
	EXPECT_EQ( 1u, r.legs[0].goals );
	EXPECT_GT( motions::stateAt( r.segments, r.legs[1].begin )[1], 0 );
	world.legs.resize( 1 );
	EXPECT_LT( world.plan().segments.back().points.back(), 0 ); // alone it would have been the other
}

TEST( Sequence, AGoalThatNoLaterMotionLeavesIsKept )
{
	// Constraints along the last motion hold in one of the two branches alone
	SequenceWorld world;
	world.start = { 0.9, -0.9 };
	world.toGoals( { { 0.8, -0.8 }, { -0.2, 0.8 } } );
	world.toGoals( { { 0.1, 0.5 } } );
	world.legs.back().path.file = "request.yaml";
	world.legs.back().path.joints.push_back( { "elbow", 0.6, 0.3, 0.3 } );
	const sequence::Result r = world.plan();
	world.expectJoined( r );
	EXPECT_EQ( 1u, r.legs[0].goals );
	EXPECT_NEAR( 0.8, motions::stateAt( r.segments, r.legs[1].begin )[1], 1e-9 );
}

TEST( Sequence, TheFailingLegIsNotNamed )
{
	SequenceWorld world( boxAt( "[0.5, 0.35, 0]", "[0.2, 0.02, 0.2]" ) );
	world.toGoals( world.branches( 0.5, 0.2 ) );
	world.along( 0.5, 0.25 );
	world.along( 0.5, 0.45 ); // through the box
	const sequence::Result r = world.plan();
	EXPECT_FALSE( r.solved );
	EXPECT_EQ( 2u, r.failed );
	EXPECT_EQ( 2u, r.goals );
	EXPECT_TRUE( r.segments.empty() && r.legs.empty() );
	const std::string text = sequence::describe( r );
	EXPECT_NE( std::string::npos, text.find( "leg 3 is not found" ) ) << text;
	EXPECT_NE( std::string::npos, text.find( "box" ) ) << text;
	world.legs.resize( 2 );
	EXPECT_TRUE( world.plan().solved );
}

TEST( Sequence, ABlendStopsBetweenTwoLines )
{
	SequenceWorld world;
	world.toGoals( world.branches( 0.5, 0.2 ) );
	world.along( 0.5, 0.35 );
	world.along( 0.35, 0.35 );
	world.legs[1].blend = 0.03;
	const sequence::Result r = world.plan();
	world.expectJoined( r );
	const motions::Segment& last = r.segments[r.legs[1].first + r.legs[1].count - 1];
	EXPECT_GT( std::fabs( last.points[6] - last.points[4] ), 1e-4 ); // it goes on at the seam
	const Vector q = motions::stateAt( r.segments, r.legs[2].begin );
	EXPECT_GT( std::hypot( world.x( q ) - 0.5, world.y( q ) - 0.35 ), 0.005 );
}

TEST( Sequence, ABlendThatCannotBeIsTaken )
{
	SequenceWorld world;
	const auto expectError = [&]( const std::string& element, const std::string& part )
	{
		try
		{
			world.plan();
			ADD_FAILURE() << element;
		}
		catch ( const io::Error& error )
		{
			EXPECT_EQ( element, error.element() );
			EXPECT_NE( std::string::npos, std::string( error.what() ).find( part ) ) << error.what();
		}
	};
	expectError( "legs", "there is none" );
	world.toGoals( { { 0, 1 } } );
	world.legs[0].blend = 0.1;
	world.along( 0.5, 0.3 );
	expectError( "legs[0]", "not a line before another line" );
	world.legs[0].blend = 0;
	world.along( 0.4, 0.3 );
	world.legs[1].blend = 0.02;
	world.legs[2].line->speed = 0.1;
	world.legs[1].element = "items[1]";
	expectError( "items[1]", "another frame, speed or tolerance" );
	world.legs[1].blend = 0;
	world.legs[2].line->any_start = true;
	expectError( "legs[2]", "start of its own" );
	world.legs[2] = {};
	expectError( "legs[2]", "no goal and no line" );
}

TEST( Sequence, OnlyTheFirstLegsConstraintsAreProved )
{
	// The second leg is planned without its constraint: the elbow goes from 0.3 to -1, and may not be below 0
	SequenceWorld world;
	world.toGoals( { { 0.5, 0.3 } } );
	world.toGoals( { { 0.5, -1 } } );
	const sequence::Result r = world.plan();
	world.expectJoined( r );
	const std::string goal = R"("goal_constraints": [{"joint_constraints": [{"joint_name": "elbow", "position": 0.3}]}])";
	const auto pathOf = []( const char* position )
	{
		return std::string(
		           R"("path_constraints": {"joint_constraints": [{"joint_name": "elbow", "tolerance_above": 1, )" ) +
		       R"("tolerance_below": 1, "position": )" + position + "}]}";
	};
	io::PathConstraints path;
	io::parseConstrainedRequest( "request",
	    R"({"items": [{"req": {"start_state": {}, )" + goal + ", " + pathOf( "0.5" ) + R"(}}, {"req": {)" + goal + ", " +
	        pathOf( "1" ) + "}}]}",
	    path );
	const std::shared_ptr<const io::Problem> only( std::shared_ptr<const io::Problem>(), &world.problem );
	const std::vector<sequence::Chapter> chapters = { { only, 0, 2, r.segments } };
	const std::vector<std::vector<motions::ConstraintProof>> proofs = sequence::proveLegs( chapters, path, r, r.segments );
	ASSERT_EQ( 2u, proofs.size() );
	ASSERT_EQ( 1u, proofs[0].size() );
	ASSERT_EQ( 1u, proofs[1].size() );
	EXPECT_TRUE( motions::areKept( proofs[0] ) );
	EXPECT_FALSE( motions::areKept( proofs[1] ) ) << motions::describe( proofs[1] );
}

TEST( Sequence, NobodyCanStopIt )
{
	SequenceWorld world( boxAt( "[0, -0.5, 0]", "[0.01, 0.9, 0.2]" ) );
	world.toGoals( { { -2.9, 0 } } ); // the box is between both: no way around
	int asked = 0;
	world.settings.stop = [&] { return ++asked > 20; };
	world.settings.seconds = 1e6;
	world.start = { 2.9 - 3.2, 0 };
	EXPECT_FALSE( world.plan().solved );
	EXPECT_GT( asked, 20 );
}
