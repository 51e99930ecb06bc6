// SPDX-License-Identifier: BSD-3-Clause
// Approach, grasp and retreat in one call: the branch of a goal serves the legs behind it, legs join without a gap, and the leg that fails is named.
#include "line_world.hpp"

#include "leeway/sequence/sequence.hpp"

namespace
{

/// Two joints in a plane and a hand, 0.8 m long; the elbow bends either way. The hand may turn about the axis of the plane.
std::string planarArm()
{
	const std::string links =
	    "<link name='base'/><link name='upper'/><link name='hand'><collision><geometry><sphere radius='0.02'/>"
	    "</geometry></collision></link><link name='fore'/>";
	const auto joint = []( const char* name, const char* parent, const char* child, const char* x, const char* type )
	{
		return std::string( "<joint name='" ) + name + "' type='" + type + "'><parent link='" + parent + "'/><child link='" +
		       child + "'/><origin xyz='" + x + " 0 0'/><axis xyz='0 0 1'/>" +
		       ( std::string( type ) == "fixed" ? "" : "<limit lower='-3' upper='3' effort='1' velocity='1'/>" ) +
		       "</joint>";
	};
	return "<robot name='arm'>" + links + joint( "shoulder", "base", "upper", "0", "revolute" ) +
	       joint( "elbow", "upper", "fore", "0.4", "revolute" ) + joint( "wrist", "fore", "hand", "0.4", "fixed" ) +
	       "</robot>";
}

struct SequenceWorld : LineWorld
{
	std::vector<sequence::Leg> legs;
	sequence::Settings settings;
	Vector start = { 0.2, 0.3 };

	explicit SequenceWorld( const std::string& scene = "" ) : LineWorld( planarArm(), scene )
	{
		settings.edge.flags = LW_CHECK_ENVIRONMENT;
		settings.limits = motions::motionLimits( problem, robot, {} );
		settings.seconds = 20;
		task.any_start = false;
		task.free_axis = lw_vec3{ 0, 0, 1 };
	}
	/// Both branches of the elbow.
	std::vector<Vector> branches( double x, double y ) const
	{
		const double reach = std::hypot( x, y ), bend = 2 * std::acos( reach / 0.8 ), about = std::atan2( y, x );
		return { { about - bend / 2, bend }, { about + bend / 2, -bend } };
	}
	void toGoals( std::vector<Vector> goals )
	{
		legs.emplace_back();
		legs.back().goals = std::move( goals );
	}
	void along( double x, double y )
	{
		legs.emplace_back();
		legs.back().line = task;
		legs.back().line->waypoints = { { placed( x, y, 0, 0 ) } };
	}
	sequence::Result plan() const { return sequence::planSequence( robot, problem, legs, settings, start ); }

	/// From the start, without gaps in places, speeds and times, at rest between legs without a blend; free and within limits.
	void expectJoined( const sequence::Result& r ) const
	{
		ASSERT_TRUE( r.solved ) << sequence::describe( r );
		ASSERT_EQ( legs.size(), r.legs.size() );
		const std::size_t n = problem.variables.size();
		EXPECT_EQ( start, Vector( r.segments[0].points.begin(), r.segments[0].points.begin() + std::ptrdiff_t( n ) ) );
		std::size_t next = 0;
		for ( std::size_t i = 0; i < r.legs.size(); ++i )
		{
			const sequence::Motion& leg = r.legs[i];
			ASSERT_EQ( next, leg.first );
			ASSERT_GT( leg.count, 0u );
			next = leg.first + leg.count;
			const motions::Segment& last = r.segments[next - 1];
			EXPECT_NEAR( r.segments[leg.first].begin, leg.begin, 1e-9 );
			EXPECT_NEAR( last.begin + last.seconds, leg.begin + leg.seconds, 2e-9 );
			for ( std::size_t v = 0; v < n && legs[i].blend == 0; ++v )
			{
				EXPECT_EQ( last.points[2 * n + v], last.points[3 * n + v] );
			}
		}
		ASSERT_EQ( next, r.segments.size() );
		for ( std::size_t k = 1; k < r.segments.size(); ++k )
		{
			const motions::Segment &a = r.segments[k - 1], &b = r.segments[k];
			EXPECT_NEAR( a.begin + a.seconds, b.begin, 2e-9 );
			for ( std::size_t v = 0; v < n; ++v )
			{
				EXPECT_EQ( a.points[3 * n + v], b.points[v] );
			}
		}
		motions::TrajectorySettings as_driven;
		as_driven.edge = settings.edge;
		const motions::TrajectoryAudit audit = motions::auditTrajectory( problem, robot, "plan",
		    motions::segmentsOf( problem, motions::endsOf( problem, r.segments ), motions::Interpolation::automatic, 0 ),
		    as_driven );
		EXPECT_TRUE( audit.valid() ) << motions::describe( audit );
	}
	double x( const Vector& q ) const { return tip( q ).t[0]; }
	double y( const Vector& q ) const { return tip( q ).t[1]; }
};

std::string boxAt( const std::string& place, const std::string& size )
{
	return "world:\n  collision_objects:\n    - id: box\n      primitives: [{type: box, dimensions: " + size +
	       "}]\n      primitive_poses: [{position: " + place + ", orientation: [0, 0, 0, 1]}]\n";
}

} // namespace

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
	const std::vector<std::vector<motions::ConstraintProof>> proofs =
	    sequence::proveLegs( world.problem, path, r, r.segments );
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
