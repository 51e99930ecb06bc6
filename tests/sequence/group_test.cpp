// SPDX-License-Identifier: BSD-3-Clause
// Legs of two arms: each moves its own joints, and the other arm stands where the legs before left it. The referee is plane trigonometry of the joint
// values alone.
#include "line_world.hpp"

#include "leeway/sequence/sequence.hpp"

namespace
{

using Kind = io::SceneEdit::Kind;
using Point = std::array<double, 2>;

constexpr double ball = 0.05, length = 0.4,
                 base = 0.5; ///< radius of a hand; of each link; the arms stand at x = -base and base

/// Two planar arms that face each other, each with two links and a ball as its hand. The right one has half of the speed.
std::string twoArms()
{
	std::string text = "<robot name='two'><link name='base'/>";
	const auto joint = [&]( const std::string& name, const std::string& parent, const std::string& child,
	                       const std::string& origin, bool turns )
	{
		text += "<joint name='" + name + "' type='" + ( turns ? "revolute" : "fixed" ) + "'><parent link='" + parent +
		        "'/><child link='" + child + "'/><origin " + origin + "/><axis xyz='0 0 1'/>" +
		        ( turns ? "<limit lower='-3' upper='3' effort='1' velocity='" + std::string( name[0] == 'l' ? "1" : "0.5" ) +
		                      "'/>"
		                : "" ) +
		        "</joint>";
	};
	for ( const std::string side : { "left", "right" } )
	{
		text += "<link name='" + side + "_upper'/><link name='" + side + "_fore'/><link name='" + side +
		        "_hand'><collision><geometry><sphere radius='0.05'/></geometry></collision></link>";
		joint( side + "_shoulder", "base", side + "_upper",
		    side == "left" ? "xyz='-0.5 0 0'" : "xyz='0.5 0 0' rpy='0 0 3.141592653589793'", true );
		joint( side + "_elbow", side + "_upper", side + "_fore", "xyz='0.4 0 0'", true );
		joint( side + "_wrist", side + "_fore", side + "_hand", "xyz='0.4 0 0'", false );
	}
	return text + "</robot>";
}

const char* const groups =
    "<robot name='two'><group name='left'><joint name='left_shoulder'/><joint name='left_elbow'/></group>"
    "<group name='right'><joint name='right_shoulder'/><joint name='right_elbow'/></group>"
    "<group name='both'><group name='left'/><group name='right'/></group>"
    "<group name='elbows'><joint name='right_elbow'/><joint name='left_elbow'/></group></robot>";

/// Place and direction in the plane.
struct Plane
{
	Point at;
	double angle;
	Point point( const Point& local ) const
	{
		return { at[0] + std::cos( angle ) * local[0] - std::sin( angle ) * local[1],
		    at[1] + std::sin( angle ) * local[0] + std::cos( angle ) * local[1] };
	}
};

/// The hand of an arm at the origin.
Plane handOf( double shoulder, double elbow )
{
	const double both = shoulder + elbow;
	return { { length * ( std::cos( shoulder ) + std::cos( both ) ), length * ( std::sin( shoulder ) + std::sin( both ) ) },
	    both };
}

/// Hands in states of both arms.
Plane left( const Vector& q )
{
	const Plane hand = handOf( q[0], q[1] );
	return { { hand.at[0] - base, hand.at[1] }, hand.angle };
}
Plane right( const Vector& q )
{
	const Plane hand = handOf( q[2], q[3] );
	return { { base - hand.at[0], -hand.at[1] }, hand.angle + M_PI };
}

/// Joints of one arm that bring its hand there; the elbow turns to the left of the arm.
Vector reach( double x, double y, bool is_left )
{
	const double along = is_left ? x + base : base - x, across = is_left ? y : -y,
	             bend = 2 * std::acos( std::hypot( along, across ) / ( 2 * length ) );
	return { std::atan2( across, along ) - bend / 2, bend };
}

double between( const Point& a, const Point& b )
{
	return std::hypot( a[0] - b[0], a[1] - b[1] );
}

struct TwoArms : PoseWorld
{
	io::World world;
	std::vector<sequence::Leg> legs;
	sequence::Settings settings;
	Vector start = { 2.5, 0.3, 0.8, 0 };

	explicit TwoArms( const std::string& scene = "", const std::string& group = "left+right" )
	    : PoseWorld( twoArms(), scene, groups, group ), world( robot, optionsOf( model, group ), problem )
	{
		settings.limits = motions::motionLimits( problem, robot, {} );
		settings.seconds = 20;
	}

	void move( const std::string& group, std::vector<Vector> goals )
	{
		legs.emplace_back();
		legs.back().group = group;
		legs.back().goals = std::move( goals );
	}
	void line( const std::string& group, double x, double y )
	{
		legs.emplace_back();
		legs.back().group = group;
		lines::Task task;
		task.tip = io::findFrame( problem, group + "_hand", "test", "tip" );
		task.free_axis = lw_vec3{ 0, 0, 1 };
		task.waypoints = { { placed( x, y, 0, 0 ) } };
		legs.back().line = task;
	}
	io::SceneEdit& edit( Kind kind, const std::string& object, const std::string& link = "" )
	{
		io::SceneDiff& diff = legs.back().scene;
		diff.file = "request.yaml";
		diff.edits.emplace_back();
		diff.edits.back().kind = kind;
		diff.edits.back().object.name = object;
		diff.edits.back().link = link;
		return diff.edits.back();
	}
	sequence::Result plan() const { return sequence::planSequence( robot, world, legs, settings, start ); }

	std::vector<sequence::Chapter> chapters( const sequence::Result& r ) const
	{
		const std::vector<motions::Segment> driven =
		    motions::segmentsOf( problem, motions::endsOf( problem, r.segments ), motions::Interpolation::automatic, 0 );
		return sequence::chaptersOf( world, legs, r, driven, start );
	}
	bool isProved( const sequence::Result& r ) const
	{
		motions::TrajectorySettings as_driven;
		as_driven.edge = settings.edge;
		return sequence::auditChapters( robot, chapters( r ), "plan", as_driven ).valid();
	}
	static std::vector<Vector> samples( const sequence::Result& r, std::size_t leg )
	{
		std::vector<Vector> states;
		for ( int i = 0; i <= 1000; ++i )
		{
			states.push_back( motions::stateAt( r.segments, r.legs[leg].begin + r.legs[leg].seconds * i / 1000 ) );
		}
		return states;
	}
	/// The least distance of the right hand from a point over a leg.
	static double rightFrom( const sequence::Result& r, std::size_t leg, const Point& point )
	{
		double least = HUGE_VAL;
		for ( const Vector& q : samples( r, leg ) )
		{
			least = std::min( least, between( right( q ).at, point ) );
		}
		return least;
	}
	/// The standing joints of each leg have one value, to the bit, and the hands keep apart.
	void expectOwnJoints( const sequence::Result& r, const std::vector<std::vector<std::size_t>>& standing ) const
	{
		Vector state = start;
		for ( std::size_t leg = 0; leg < r.legs.size(); ++leg )
		{
			ASSERT_GT( r.legs[leg].count, 0u );
			for ( std::size_t k = r.legs[leg].first; k < r.legs[leg].first + r.legs[leg].count; ++k )
			{
				const Vector& points = r.segments[k].points;
				ASSERT_EQ( 16u, points.size() );
				for ( std::size_t i = 0; i < 16; i += 4 )
				{
					for ( const std::size_t v : standing[leg] )
					{
						ASSERT_EQ( state[v], points[i + v] ) << "leg " << leg << ", variable " << v;
					}
				}
			}
			const Vector& last = r.segments[r.legs[leg].first + r.legs[leg].count - 1].points;
			state = { last.end() - 4, last.end() };
			EXPECT_EQ( state, Vector( last.end() - 8, last.end() - 4 ) ) << "no rest behind leg " << leg;
			for ( const Vector& q : samples( r, leg ) )
			{
				ASSERT_GT( between( left( q ).at, right( q ).at ), 2 * ball );
			}
		}
	}

private:
	static io::ProblemOptions optionsOf( const io::SceneModel& scene, const std::string& group )
	{
		io::ProblemOptions options;
		options.scene = scene.file.empty() ? nullptr : &scene;
		options.group = group;
		return options;
	}
};

template <typename F> void expectError( const F& call, const std::string& element, const std::vector<std::string>& parts )
{
	try
	{
		call();
		ADD_FAILURE() << "no error of " << element;
	}
	catch ( const io::Error& error )
	{
		EXPECT_EQ( element, error.element() );
		for ( const std::string& part : parts )
		{
			EXPECT_NE( std::string::npos, std::string( error.what() ).find( part ) ) << error.what();
		}
	}
}

} // namespace

TEST( SequenceGroup, JointsOfTheOtherGroupMove )
{
	TwoArms arms;
	arms.start = { 1.5, 0.3, 1.5, 0.3 };
	arms.move( "left", { { -1, 0.5 } } );
	arms.move( "right", { { -1, 0.5 } } );
	arms.line( "right", 0.45, 0.5 );
	arms.move( "both", { { 1, 0.2, 1, 0.2 } } );
	arms.move( "left", { { 2, 0.2 } } );
	arms.move( "", { { 1, 0.1, 1, 0.1 } } );
	const sequence::Result r = arms.plan();
	ASSERT_TRUE( r.solved ) << sequence::describe( r, arms.legs );
	arms.expectOwnJoints( r, { { 2, 3 }, { 0, 1 }, { 0, 1 }, {}, { 2, 3 }, {} } );
	EXPECT_TRUE( arms.isProved( r ) );
	const Vector& end = r.segments.back().points;
	EXPECT_EQ( ( Vector{ 1, 0.1, 1, 0.1 } ), Vector( end.end() - 4, end.end() ) );
	const Point hand = right( motions::stateAt( r.segments, r.legs[3].begin ) ).at;
	EXPECT_NEAR( 0, between( hand, { 0.45, 0.5 } ), 2e-4 );
	const std::string text = sequence::describe( r, arms.legs );
	EXPECT_NE( std::string::npos, text.find( " s, right, a line" ) ) << text;
}

TEST( SequenceGroup, ValuesGoToTheJointsOfAnotherOrder )
{
	// Groups name joints that are not side by side, and in another order than the plan
	TwoArms arms;
	arms.start = { 1.5, 0.3, 1.5, 0.4 };
	arms.move( "elbows", { { 0.7, -0.6 } } );
	arms.move( "right+left", { { 1, 0.2, 1.2, 0.1 } } );
	const sequence::Result r = arms.plan();
	ASSERT_TRUE( r.solved ) << sequence::describe( r );
	arms.expectOwnJoints( r, { { 0, 2 }, {} } );
	EXPECT_TRUE( arms.isProved( r ) );
	EXPECT_EQ( ( Vector{ 1.5, -0.6, 1.5, 0.7 } ), motions::stateAt( r.segments, r.legs[1].begin ) );
	const Vector& end = r.segments.back().points;
	EXPECT_EQ( ( Vector{ 1.2, 0.1, 1, 0.2 } ), Vector( end.end() - 4, end.end() ) );
}

TEST( SequenceGroup, ConstraintsAreOfTheFirstJoints )
{
	// Along the right arm's way its own elbow has a range that the left one leaves, and the left elbow the value that the first leg gives it
	TwoArms arms;
	arms.start = { 1.5, 0.3, 1.5, 0.4 };
	arms.move( "left", { { 1.5, 0.9 }, { 1.4, 1.5 } } );
	arms.move( "right", { { 1, 0.5 } } );
	arms.legs[1].path.file = "request.yaml";
	arms.legs[1].path.joints = { { "right_elbow", 0.45, 0.1, 0.1 }, { "left_elbow", 1.5, 0.01, 0.01 } };
	const sequence::Result r = arms.plan();
	ASSERT_TRUE( r.solved ) << sequence::describe( r );
	arms.expectOwnJoints( r, { { 2, 3 }, { 0, 1 } } );
	EXPECT_EQ( 1u, r.legs[0].goals ); // the other one breaks a constraint of the second leg
	arms.legs[0].goals = { { 1.5, 0.9 } };
	const sequence::Result broken = arms.plan();
	EXPECT_FALSE( broken.solved );
	EXPECT_NE( std::string::npos, broken.reason.find( "left_elbow" ) ) << broken.reason;
}

TEST( SequenceGroup, TheOtherArmStandsWhereItStoodAtTheStart )
{
	// The stretched right arm turns past (-0.3, 0), where the left hand stands by then
	TwoArms arms;
	const Point there = { -0.3, 0 };
	arms.move( "left", { reach( there[0], there[1], true ) } );
	arms.move( "right", { { -0.8, 0 } } );
	const sequence::Result r = arms.plan();
	ASSERT_TRUE( r.solved ) << sequence::describe( r );
	arms.expectOwnJoints( r, { { 2, 3 }, { 0, 1 } } );
	EXPECT_TRUE( arms.isProved( r ) );
	EXPECT_NEAR( 0, between( left( motions::stateAt( r.segments, r.legs[1].begin ) ).at, there ), 1e-12 );
	EXPECT_GT( TwoArms::rightFrom( r, 1, there ), 2 * ball );
	arms.legs.erase( arms.legs.begin() );
	const sequence::Result alone = arms.plan();
	ASSERT_TRUE( alone.solved );
	EXPECT_LT( TwoArms::rightFrom( alone, 0, there ), 2 * ball ); // else the test would not see it
}

TEST( SequenceGroup, ALineRunsIntoTheArmOfTheOtherBranch )
{
	// One of the left hand's places is on the line of the right one, which decides before the left arm moves
	TwoArms arms;
	const Vector from = reach( 0, 0.3, false );
	arms.start = { 2.5, 0.3, from[0], from[1] };
	const Vector on_it = reach( 0, 0.1, true ), beside = reach( -0.3, 0.4, true );
	arms.move( "left", { on_it, beside } );
	arms.line( "right", 0, -0.1 );
	const sequence::Result r = arms.plan();
	ASSERT_TRUE( r.solved ) << sequence::describe( r );
	arms.expectOwnJoints( r, { { 2, 3 }, { 0, 1 } } );
	EXPECT_EQ( 1u, r.legs[0].goals );
	EXPECT_TRUE( arms.isProved( r ) );
	arms.legs[0].goals = { on_it };
	const sequence::Result none = arms.plan();
	EXPECT_FALSE( none.solved );
	EXPECT_EQ( 1u, none.failed );
	EXPECT_EQ( 1u, none.goals );
	EXPECT_NE( std::string::npos, none.reason.find( "left_hand" ) ) << none.reason;
}

TEST( SequenceGroup, APartIsHandedOverWhereTheOtherHandWas )
{
	// A bar between both hands: 0.3 m long, held 0.21 m from its middle
	const std::string scene = "world: {collision_objects: [{id: bar, pose: {position: [0, 0, 0]}, primitives: [{type: box, "
	                          "dimensions: [0.3, 0.04, 0.04]}]}]}";
	TwoArms arms( scene );
	const Vector grasp = reach( -0.21, 0, true ), brought = { grasp[0] + 0.1, grasp[1] };
	arms.start = { grasp[0], grasp[1], 2, 0.3 };
	const auto local = []( const Plane& hand, const Point& point ) {
		return Plane{ { 0, 0 }, -hand.angle }.point( { point[0] - hand.at[0], point[1] - hand.at[1] } );
	};
	const Plane first = left( arms.start ), then = left( { brought[0], brought[1], 0, 0 } );
	const Point middle = then.point( local( first, { 0, 0 } ) ), end = then.point( local( first, { 0.21, 0 } ) );
	const Vector take = reach( end[0], end[1], false );
	arms.move( "left", { brought } );
	arms.edit( Kind::attach, "bar", "left_hand" );
	arms.move( "right", { take } );
	arms.move( "left", { { 2, 0.3 } } );
	arms.edit( Kind::release, "bar" );
	arms.edit( Kind::attach, "bar", "right_hand" );
	arms.move( "right", { { take[0] + 0.4, take[1] } } );
	const sequence::Result r = arms.plan();
	ASSERT_TRUE( r.solved ) << sequence::describe( r );
	arms.expectOwnJoints( r, { { 2, 3 }, { 0, 1 }, { 2, 3 }, { 0, 1 } } );
	EXPECT_TRUE( arms.isProved( r ) );
	const std::vector<sequence::Chapter> chapters = arms.chapters( r );
	ASSERT_EQ( 2u, chapters.size() );
	const Point held = local( right( { 0, 0, take[0], take[1] } ), middle );
	const lw_transform& bar = chapters[1].problem->object_poses.at( "bar" );
	EXPECT_NEAR( held[0], bar.t[0], 1e-9 );
	EXPECT_NEAR( held[1], bar.t[1], 1e-9 );
	EXPECT_NEAR( 0.21, std::hypot( bar.t[0], bar.t[1] ), 1e-9 );
}

TEST( SequenceGroup, ABlendGoesOnToAnotherArm )
{
	TwoArms arms;
	const Vector a = reach( -0.2, -0.3, true ), b = reach( 0.2, 0.3, false );
	arms.start = { a[0], a[1], b[0], b[1] };
	arms.line( "left", -0.2, -0.2 );
	arms.line( "right", 0.2, 0.2 );
	arms.legs[0].blend = 0.02;
	expectError( [&] { arms.plan(); }, "legs[0]", { "has a blend", "another group, 'right'", "give 0" } );
	arms.legs.pop_back();
	arms.line( "left", -0.3, -0.2 );
	const sequence::Result r = arms.plan();
	ASSERT_TRUE( r.solved ) << sequence::describe( r );
	const motions::Segment& last = r.segments[r.legs[1].first - 1];
	EXPECT_NE( last.points[8], last.points[12] ); // it goes on at the seam
	EXPECT_TRUE( arms.isProved( r ) );
}

TEST( SequenceGroup, AnUnknownGroupIsNotNamed )
{
	TwoArms arms;
	arms.move( "left", { { 1, 0.3 } } );
	arms.move( "rihgt", { { 1, 0.3 } } );
	arms.legs[1].element = "items[1]";
	expectError( [&] { arms.plan(); }, "items[1]", { "rihgt", "no such group", "use one of left, right, both, elbows" } );
	arms.legs[1].group = "right";
	EXPECT_TRUE( arms.plan().solved );
	expectError( [&] { sequence::planSequence( arms.robot, arms.problem, arms.legs, arms.settings, arms.start ); },
	    "legs[0]", { "another group than the problem", "io::World" } );
	arms.legs[1].goals = { { 1, 0.3, 1, 0.3 } };
	expectError( [&] { arms.plan(); }, "items[1]", { "a goal of 4 values", "right has 2 variables" } );
	TwoArms one( "", "left" );
	one.start = { 1, 0.3 };
	one.settings.limits = motions::motionLimits( one.problem, one.robot, {} );
	one.move( "right", { { 1, 0.3 } } );
	expectError( [&] { one.plan(); }, "legs[0]", { "right_shoulder", "group 'left'" } );
}

TEST( SequenceGroup, TheStartIsProvedOfTheMovingArmAlone )
{
	// The right hand is in a box on its own upper arm, and the left arm moves: no leg may begin
	TwoArms arms(
	    "robot_state: {attached_collision_objects: [{link_name: right_upper, object: {id: box, header: {frame_id: "
	    "right_upper}, primitives: [{type: box, dimensions: [0.1, 0.1, 0.1]}], primitive_poses: [{position: [0, 0.1, "
	    "0]}]}}]}" );
	arms.start = { 1, 0.3, 1, 2.9 };
	arms.move( "left", { { 2, 0.3 } } );
	const sequence::Result r = arms.plan();
	EXPECT_FALSE( r.solved );
	EXPECT_NE( std::string::npos, r.reason.find( "right_hand" ) ) << r.reason;
	arms.start[3] = 0.3;
	EXPECT_TRUE( arms.plan().solved );
}

TEST( SequenceGroup, LegsOfTheWholeGroupAreAnotherPlan )
{
	// Every way to name the group of the plan gives the same bits
	TwoArms arms( "", "both" );
	arms.move( "", { { 1, 0.2, 1, 0.2 } } );
	arms.move( "", { { 2, 0.2, 2, 0.2 } } );
	const sequence::Result plain = arms.plan();
	ASSERT_TRUE( plain.solved );
	for ( const char* name : { "both", "left+right", "left+both" } )
	{
		arms.legs[0].group = arms.legs[1].group = name;
		const sequence::Result r = arms.plan();
		ASSERT_EQ( plain.segments.size(), r.segments.size() );
		for ( std::size_t i = 0; i < r.segments.size(); ++i )
		{
			EXPECT_EQ( plain.segments[i].points, r.segments[i].points );
			EXPECT_EQ( plain.segments[i].begin, r.segments[i].begin );
		}
	}
}

TEST( SequenceGroup, ItemsForgetTheirGroups )
{
	const std::string goal =
	    R"("goal_constraints": [{"joint_constraints": [{"joint_name": "left_elbow", "position": 0.3}]}])";
	const auto groupsOf = [&]( const std::vector<std::string>& names, std::string& all )
	{
		std::string text;
		for ( const std::string& name : names )
		{
			text += text.empty() ? R"({"items": [{"req": {"start_state": {}, )" : R"(, {"req": {)";
			text += goal + ( name.empty() ? "" : R"(, "group_name": ")" + name + "\"" ) + "}}";
		}
		io::PathConstraints path;
		all = io::parseConstrainedRequest( "request", text + "]}", path ).group;
		std::vector<std::string> of_legs;
		for ( const sequence::Leg& leg : sequence::legsOf( path, {} ) )
		{
			of_legs.push_back( leg.group );
		}
		EXPECT_EQ( of_legs != std::vector<std::string>( of_legs.size(), of_legs[0] ), sequence::hasGroups( path ) );
		return of_legs;
	};
	using Names = std::vector<std::string>;
	std::string all;
	EXPECT_EQ( ( Names{ "left", "left", "right", "right", "left" } ), groupsOf( { "", "left", "right", "", "left" }, all ) );
	EXPECT_EQ( "left+right", all );
	EXPECT_EQ( ( Names{ "left", "left" } ), groupsOf( { "left", "" }, all ) );
	EXPECT_EQ( "left", all );
	EXPECT_EQ( ( Names{ "", "" } ), groupsOf( { "", "" }, all ) );
	EXPECT_EQ( "", all );
}

TEST( SequenceGroup, AnItemsGoalIsOfAllGroups )
{
	// The goals of requests: joints of the item's group, and no more; poses by inverse kinematics of the own arm
	TwoArms arms;
	arms.start = { 1.5, 0.3, 1.5, 0.3 };
	const auto joints = []( const std::string& group, const std::string& more )
	{
		return "\"group_name\": \"" + group + R"(", "goal_constraints": [{"joint_constraints": [{"joint_name": ")" + group +
		       R"(_shoulder", "position": -1})" + more + "]}]";
	};
	const auto elbow = []( const std::string& group )
	{ return R"(, {"joint_name": ")" + group + R"(_elbow", "position": 0.5})"; };
	const auto planOf = [&]( const std::string& second )
	{
		io::PathConstraints path;
		io::parseConstrainedRequest( "request.json",
		    R"({"items": [{"req": {"start_state": {}, )" + joints( "left", elbow( "left" ) ) + "}}, {\"req\": {" + second +
		        "}}]}",
		    path );
		arms.legs = sequence::legsOf( path, {} );
		return arms.plan();
	};
	const sequence::Result r = planOf( joints( "right", elbow( "right" ) ) );
	ASSERT_TRUE( r.solved ) << sequence::describe( r );
	const Vector& end = r.segments.back().points;
	EXPECT_EQ( ( Vector{ -1, 0.5, -1, 0.5 } ), Vector( end.end() - 4, end.end() ) );
	expectError( [&] { planOf( joints( "right", "" ) ); }, "items[1].req.goal_constraints[0]",
	    { "request.json", "no goal for right_elbow" } );
	// the left arm stands at the first goal by then, and so may the second goal name it
	EXPECT_TRUE( planOf( joints( "right", elbow( "right" ) + elbow( "left" ) ) ).solved );
	const sequence::Result posed = planOf(
	    R"("group_name": "right", "goal_constraints": [{"position_constraints": [{"link_name": "right_hand", "constraint_region": )"
	    R"({"primitives": [{"type": "sphere", "dimensions": [0.001]}], "primitive_poses": [{"position": [0.1, 0.3, 0]}]}}]}])" );
	ASSERT_TRUE( posed.solved ) << sequence::describe( posed );
	arms.expectOwnJoints( posed, { { 2, 3 }, { 0, 1 } } );
	const Vector& last = posed.segments.back().points;
	EXPECT_LT( between( right( { last.end() - 4, last.end() } ).at, { 0.1, 0.3 } ), 0.001001 );
	EXPECT_GT( posed.legs[1].goals, 1u ); // both ways to bend the elbow
}
