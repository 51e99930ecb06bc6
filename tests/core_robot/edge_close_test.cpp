// SPDX-License-Identifier: BSD-3-Clause
// Edges closer than the slack: undecided though there is room, called FREE though there is none, work without bound. All
// clearances here are known in closed form.
#include "checker_handles.hpp"
#include "random_robot.hpp"
#include "simple_shapes.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace
{

constexpr double PI = 3.14159265358979323846;

/// Windows within the slack that an edge may take besides 2 V / slack + 2 states, and states that look for a collision
/// (checker.h).
constexpr double CLOSE_WINDOWS = 2 * 1024, LOOKS = 5;

/// The sides of a prism about z, a regular polygon whose corners are `radius` from it.
lw_shape* sides( int corners, double radius, double height )
{
	std::vector<double> vertices;
	std::vector<std::uint32_t> indices;
	for ( int i = 0; i < corners; ++i )
	{
		const double angle = 2 * PI * i / corners, x = radius * std::cos( angle ), y = radius * std::sin( angle );
		vertices.insert( vertices.end(), { x, y, -0.5 * height, x, y, 0.5 * height } );
		const auto a = static_cast<std::uint32_t>( 2 * i ), b = static_cast<std::uint32_t>( 2 * ( ( i + 1 ) % corners ) );
		indices.insert( indices.end(), { a, b, a + 1, b, b + 1, a + 1 } );
	}
	return meshOf( vertices, indices );
}

/// A link that turns about z on its base, or among obstacles.
struct Turning
{
	RobotModel model;
	RobotPtr robot;
	std::vector<ShapePtr> shapes;
	ScenePtr scene;
	CheckerPtr checker;
	QueryPtr query;

	Turning()
	{
		model.link( "base" );
		model.joint( "rotor", LW_JOINT_CONTINUOUS, 0 );
	}

	void open( lw_shape* obstacle = nullptr, const lw_transform& pose = lw_transform_identity() )
	{
		robot = model.create();
		shapes.emplace_back( obstacle );
		const char* name = "obstacle";
		const lw_scene_shape_def shape = { obstacle, 0, pose };
		lw_scene_def scene_def = lw_scene_def_default();
		scene_def.object_names = &name;
		scene_def.shapes = &shape;
		scene_def.object_count = scene_def.shape_count = obstacle != nullptr ? 1 : 0;
		lw_scene* new_scene = nullptr;
		ASSERT_EQ( LW_OK, lw_scene_create( &scene_def, nullptr, nullptr, &new_scene ) );
		scene.reset( new_scene );
		lw_checker_def def = lw_checker_def_default();
		def.robot = robot.get();
		def.scene = new_scene;
		lw_checker* new_checker = nullptr;
		ASSERT_EQ( LW_OK, lw_checker_create( &def, nullptr, nullptr, &new_checker ) );
		checker.reset( new_checker );
		query = makeQuery( new_checker );
	}

	lw_edge_result edge( double a, double b, const lw_edge_def& def ) const
	{
		lw_edge_result result;
		EXPECT_EQ( LW_OK, lw_checker_edge( checker.get(), query.get(), &a, &b, &def, &result ) );
		return result;
	}
};

/// A ball on an arm that turns about z above a slab: nearest where the arm points down.
struct Cam : Turning
{
	double arm, ball, gap;

	/// @param gap least clearance of a full turn
	Cam( double arm_length, double radius, double least ) : arm( arm_length ), ball( radius ), gap( least )
	{
		model.body( 1, primitive( LW_SHAPE_SPHERE, ball, 0, 0 ), at( arm, 0, 0 ) );
		open( primitive( LW_SHAPE_BOX, 1, 1, 1 ), at( 0, -( arm + ball + gap ) - 0.5, 0 ) );
	}

	/// Radians from where it is nearest.
	double clearance( double angle ) const { return gap + 2 * arm * std::pow( std::sin( 0.5 * angle ), 2 ); }
	lw_edge_result edge( double a, double b, const lw_edge_def& def ) const
	{
		return Turning::edge( a - 0.5 * PI, b - 0.5 * PI, def );
	}
};

void expectBounded( const lw_edge_result& r, const lw_edge_def& def, double way )
{
	EXPECT_LE( r.queries, 2 * way / def.slack + 2 + CLOSE_WINDOWS + LOOKS );
}

} // namespace

// Links that are near each other by design keep a small gap whatever the joint does: faces that slide past each other, and a
// shaft in its bearing, whose hulls meet so that no plane is between them.
TEST( EdgeClose, LinksThatAreNearByDesignAreFreeWithoutASlackThatSomeoneHasToKnow )
{
	SeededRng rng;
	const lw_edge_def def = lw_edge_def_default();
	for ( int i = 0; i < 40; ++i )
	{
		const double gap = rng.decade( -5, -3 ), from = rng.uniform( -3, 3 ), turn = rng.uniform( -2, 2 );
		Turning faces;
		faces.model.body( 0, primitive( LW_SHAPE_BOX, 0.1, 0.1, 0.1 ), at( 0, 0, -0.05 ) );
		faces.model.body( 1, primitive( LW_SHAPE_BOX, 0.1, 0.04, 0.1 ), at( 0.02, 0, 0.05 + gap ) );
		faces.open();
		const lw_edge_result slid = faces.edge( from, from + turn, def );
		EXPECT_EQ( LW_VERDICT_FREE, slid.verdict ) << "gap " << gap;
		EXPECT_GT( slid.lower_bound, 0 );
		EXPECT_LE( slid.lower_bound, gap + 1e-12 );

		const int corners = 48;
		const double hole = 0.02, shaft = hole * std::cos( PI / corners ) - std::max( gap, 4e-5 );
		Turning bearing;
		bearing.model.body( 0, sides( corners, hole, 0.03 ), lw_transform_identity() );
		bearing.model.body( 1, sides( corners, shaft, 0.05 ), lw_transform_identity() );
		bearing.open();
		const lw_edge_result turned = bearing.edge( from, from + 0.5 * turn, def );
		EXPECT_EQ( LW_VERDICT_FREE, turned.verdict ) << "gap " << gap;
		expectBounded( turned, def, hole * std::abs( turn ) );
	}
}

// Gripping begins and ends near contact: there the room is small, and it grows.
TEST( EdgeClose, MotionsLeaveAndReachObjectsNearerThanTheSlack )
{
	SeededRng rng;
	const lw_edge_def def = lw_edge_def_default();
	for ( int i = 0; i < 100; ++i )
	{
		const Cam cam( rng.uniform( 0.1, 0.6 ), rng.uniform( 0.02, 0.09 ), rng.decade( -5.5, -3.5 ) );
		const double end = rng.uniform( 0.05, 2 ) * ( rng.integer( 0, 1 ) ? 1 : -1 );
		for ( const bool leaves : { true, false } )
		{
			const lw_edge_result r = cam.edge( leaves ? 0 : end, leaves ? end : 0, def );
			EXPECT_EQ( LW_VERDICT_FREE, r.verdict ) << "gap " << cam.gap << " to " << end;
			EXPECT_LE( r.lower_bound, cam.gap + 1e-12 );
			expectBounded( r, def, ( cam.arm + cam.ball ) * std::abs( end ) );
		}
	}
}

// Counterexamples are looked for where they would be: edges whose least clearance, somewhere in between, is a hair above or
// below min_d.
TEST( EdgeClose, NoEdgeIsFreeWhoseLeastClearanceIsNotAboveMinD )
{
	SeededRng rng;
	int free = 0, blocked = 0, undecided = 0;
	for ( int i = 0; i < 1000; ++i )
	{
		lw_edge_def def = lw_edge_def_default();
		def.min_d = rng.integer( 0, 1 ) ? 0 : rng.decade( -4, -2 );
		def.slack = rng.integer( 0, 1 ) ? 1e-3 : rng.decade( -5, -2 );
		def.alpha = rng.integer( 0, 1 ) ? 0.1 : 0;
		def.want_proved_until = rng.integer( 0, 1 ) == 1;
		const double above = rng.decade( rng.integer( 0, 3 ) ? -7 : -13, -3 ) * ( rng.integer( 0, 1 ) ? 1 : -1 ),
		             rounding = 1e-12;
		const Cam cam( rng.uniform( 0.05, 0.6 ), rng.uniform( 0.02, 0.09 ), def.min_d + above );
		const double a = -rng.decade( -3, 0.18 ), b = rng.decade( -3, 0.18 ); // less than half a turn together
		const lw_edge_result r = cam.edge( a, b, def );
		const double there = cam.clearance( a + r.t * ( b - a ) );
		switch ( r.verdict )
		{
		case LW_VERDICT_FREE:
			++free;
			EXPECT_GT( above, -rounding );
			EXPECT_GT( r.lower_bound, def.min_d );
			EXPECT_LE( r.lower_bound, cam.gap + rounding );
			break;
		case LW_VERDICT_BLOCKED:
			++blocked;
			EXPECT_LT( above, rounding );
			EXPECT_LE( there, def.min_d + rounding );
			break;
		default:
			++undecided;
			ASSERT_EQ( LW_VERDICT_UNDECIDED, r.verdict );
			EXPECT_LE( there, ( def.min_d + def.slack ) / ( 1 - def.alpha ) + rounding );
			EXPECT_LT( std::abs( above ), 3e-6 ) << "there is room, or a collision"; // floats of planes, 1 m from the origin
		}
		// all that is proved from the left is above min_d: it ends before the arm is where the clearance is min_d
		if ( r.verdict != LW_VERDICT_FREE && r.proved_until > 0 )
		{
			const double last = a + r.proved_until * ( b - a );
			EXPECT_GT( cam.clearance( std::min( last, 0.0 ) ), def.min_d - rounding );
		}
		if ( !def.want_proved_until )
		{
			expectBounded( r, def, ( cam.arm + cam.ball ) * ( b - a ) );
		}
	}
	std::printf( "FREE %d, BLOCKED %d, UNDECIDED %d\n", free, blocked, undecided );
	EXPECT_GE( free, 200 );
	EXPECT_GE( blocked, 200 );
}

// The same head-on, where each bound of a motion is used up: a ball goes straight at a ball until their clearance is a hair
// above or below min_d.
TEST( EdgeClose, NoEdgeIsFreeThatEndsNotAboveMinD )
{
	SeededRng rng;
	for ( int i = 0; i < 1000; ++i )
	{
		lw_edge_def def = lw_edge_def_default();
		def.min_d = rng.integer( 0, 1 ) ? 0 : rng.decade( -4, -2 );
		def.alpha = rng.integer( 0, 1 ) ? 0.1 : 0;
		const double above = rng.decade( -12, -3 ) * ( rng.integer( 0, 1 ) ? 1 : -1 ), way = rng.decade( -3, 0 );
		Turning slide;
		slide.model.joints[0].type = LW_JOINT_PRISMATIC;
		slide.model.joints[0].axis[0] = 1;
		slide.model.joints[0].axis[2] = 0;
		const double ball = rng.uniform( 0.01, 0.1 ), beyond = rng.integer( 0, 1 ) ? 0 : rng.decade( -12, -3 );
		slide.model.body( 1, primitive( LW_SHAPE_SPHERE, ball, 0, 0 ), at( 0, 0, 0 ) );
		slide.open( primitive( LW_SHAPE_SPHERE, ball, 0, 0 ), at( 2 * ball + def.min_d + above + beyond, 0, 0 ) );
		const lw_edge_result r = rng.integer( 0, 1 ) ? slide.edge( -way, beyond, def ) : slide.edge( beyond, -way, def );
		if ( r.verdict == LW_VERDICT_FREE )
		{
			EXPECT_GT( above, -1e-12 );
			EXPECT_LE( r.lower_bound, def.min_d + above + 1e-12 );
		}
		EXPECT_TRUE( r.verdict == LW_VERDICT_FREE || above < 1e-6 ) << above << " way " << way;
	}
}

// Gaps below the resolution of planes in floats, on a way that no distance proves in the windows that there are: undecided,
// with the pair, and soon.
TEST( EdgeClose, WorkEndsWhereTheRoomIsRounding )
{
	const lw_edge_def def = lw_edge_def_default();
	for ( const double gap : { 1e-8, 1e-10, 1e-13 } )
	{
		Turning faces;
		faces.model.body( 0, primitive( LW_SHAPE_BOX, 0.2, 0.2, 0.1 ), at( 0, 0, -0.05 ) );
		faces.model.body( 1, sides( 12, 0.09, 0.1 ), at( 0, 0, 0.05 + gap ) );
		faces.open();
		const lw_edge_result r = faces.edge( -1, 1, def );
		EXPECT_EQ( LW_VERDICT_UNDECIDED, r.verdict ) << gap;
		EXPECT_TRUE( r.self );
		EXPECT_EQ( 0u, std::min( r.pair.a, r.pair.b ) );
		EXPECT_EQ( 1u, std::max( r.pair.a, r.pair.b ) );
		EXPECT_NEAR( gap, r.pair.upper, 1e-12 );
		expectBounded( r, def, 0.2 );
	}
}

// The slack is a bound of work, not of provable clearance.
TEST( EdgeClose, SmallerSlacksProveNoMore )
{
	SeededRng rng;
	for ( int i = 0; i < 50; ++i )
	{
		const Cam cam( rng.uniform( 0.1, 0.6 ), rng.uniform( 0.02, 0.09 ), rng.decade( -5, -2 ) );
		const double a = -rng.uniform( 0.1, 1 ), b = rng.uniform( 0.1, 1 );
		for ( const double slack : { 1e-5, 1e-4, 1e-3, 1e-2, 0.1 } )
		{
			lw_edge_def def = lw_edge_def_default();
			def.slack = slack;
			EXPECT_EQ( LW_VERDICT_FREE, cam.edge( a, b, def ).verdict ) << "gap " << cam.gap << ", slack " << slack;
		}
	}
}

// The proved run from the start of a blocked edge must not end at once because two links are near each other all the way.
TEST( EdgeClose, RunsAreNotHeldUpByLinksThatAreNearByDesign )
{
	lw_edge_def def = lw_edge_def_default();
	def.want_proved_until = true;
	for ( const double gap : { 1e-5, 1e-4, 5e-4 } )
	{
		Turning faces;
		faces.model.body( 0, primitive( LW_SHAPE_BOX, 0.1, 0.1, 0.1 ), at( 0, 0, -0.05 ) );
		faces.model.body( 1, primitive( LW_SHAPE_BOX, 0.1, 0.04, 0.1 ), at( 0.02, 0, 0.05 + gap ) );
		faces.open( primitive( LW_SHAPE_SPHERE, 0.005, 0, 0 ), at( 0, 0.06, 0.05 ) );
		const lw_edge_result r = faces.edge( 0, 2, def );
		EXPECT_EQ( LW_VERDICT_BLOCKED, r.verdict );
		EXPECT_FALSE( r.self );
		const double contact = std::acos( ( 0.02 + 0.005 ) / 0.06 ); // radians, of the link's side, 20 mm from the axis
		EXPECT_LT( 2 * r.proved_until, contact );
		// the verdict takes 3 to 5 states, so the run has 8: it gets as far as they do in windows as short as the near pair needs
		EXPECT_GT( 2 * r.proved_until, ( gap < 1e-4 ? 0.025 : gap < 5e-4 ? 0.1 : 0.15 ) * contact ) << "gap " << gap;
	}
}

// An edge of a billion radians took minutes.
TEST( EdgeClose, EdgesOfAbsurdLengthAreRefusedForTheirLength )
{
	for ( const lw_edge_method method : { LW_EDGE_CERTIFIED, LW_EDGE_STEPS } )
	{
		Turning faces;
		faces.model.joints[0].type = LW_JOINT_REVOLUTE;
		faces.model.body( 0, primitive( LW_SHAPE_BOX, 0.1, 0.1, 0.1 ), at( 0, 0, -0.055 ) );
		faces.model.body( 1, primitive( LW_SHAPE_BOX, 0.1, 0.04, 0.1 ), at( 0.02, 0, 0.055 ) );
		faces.open();
		lw_edge_def def = lw_edge_def_default();
		def.method = method;
		def.want_proved_until = true;
		for ( const double turn : { 1e9, 1e15 } )
		{
			const lw_edge_result r = faces.edge( 0.3, turn, def );
			EXPECT_EQ( LW_VERDICT_UNDECIDED, r.verdict );
			EXPECT_TRUE( r.pair.kind == LW_CLEARANCE_UNKNOWN || turn > 1e9 )
			    << "where poses round to more than the pair's clearance, it is named";
			EXPECT_LE( r.queries, 2u * LW_EDGE_MOST_STATES );
		}
		EXPECT_EQ( LW_VERDICT_FREE, faces.edge( 0.3, 1000, def ).verdict );
	}
}
