// SPDX-License-Identifier: BSD-3-Clause
// A ball on a rail, and blocks that come and go: contacts and stops are known in closed form.
#include "rail.hpp"

namespace
{

/// A scene of a rail, and a block beside it.
leeway::Scene withAnother( const Rail& rail, const leeway::Scene& scene_of )
{
	const lw_shape* shapes[] = { rail.block.get() };
	lw_transform far = lw_transform_identity();
	far.t[1] = 9;
	const lw_scene_change add = { LW_SCENE_ADD, "other", shapes, &far, 1 };
	lw_scene* made = nullptr;
	EXPECT_EQ( LW_OK, lw_scene_edit( scene_of.get(), &add, 1, nullptr, nullptr, &made ) );
	return leeway::Scene::adopt( made );
}

double ten( void* time )
{
	return *static_cast<double*>( time ) += 10;
}

} // namespace

TEST( Guard, AStaleSceneIsAnswered )
{
	Rail rail;
	lw_guard_def def = guardOf( rail.checker.get(), 2 );
	def.timed.contact_resolution = 1e-3;
	const GuardPtr guard = makeGuard( def, rail.clock );
	EXPECT_EQ( ask( guard.get(), 0 ).verdict, LW_VERDICT_FREE );
	ASSERT_EQ( LW_OK, rail.publish( guard.get(), 1.5, 7 ) );
	const lw_guard_answer blocked = ask( guard.get(), 0.25 );
	EXPECT_EQ( blocked.verdict, LW_VERDICT_BLOCKED );
	EXPECT_EQ( blocked.stamp, 7u );
	EXPECT_LE( blocked.proved_until, 1.3 );
	EXPECT_GE( blocked.time, 1.3 - 1e-9 );
	EXPECT_LE( blocked.time - blocked.proved_until, 1e-3 );
	EXPECT_EQ( ask( guard.get(), 1.25 ).verdict, LW_VERDICT_BLOCKED ); // and is kept
	EXPECT_EQ( ask( guard.get(), 1.25 ).windows, 0u );
	ASSERT_EQ( LW_OK, lw_guard_publish( guard.get(), inScene( rail.checker.get(), nullptr ).get(), 8, nullptr ) );
	const lw_guard_answer free = ask( guard.get(), 1.26 );
	EXPECT_EQ( free.verdict, LW_VERDICT_FREE );
	EXPECT_EQ( free.stamp, 8u );
	EXPECT_EQ( ask( guard.get(), 1.5 ).windows, 0u ); // known
}

// No change between the base of a world and that world may be forgotten: two blocks come one after the other, the first blocks.
TEST( Guard, AChangeIsForgottenBecauseAnotherFollows )
{
	Rail rail;
	const GuardPtr guard = makeGuard( guardOf( rail.checker.get(), 2 ), rail.clock );
	EXPECT_EQ( ask( guard.get(), 0 ).verdict, LW_VERDICT_FREE );
	const leeway::Scene first = rail.scene( 1.5 );
	ASSERT_EQ( LW_OK, lw_guard_publish( guard.get(), inScene( rail.checker.get(), first.get() ).get(), 1, nullptr ) );
	EXPECT_EQ( ask( guard.get(), 0 ).verdict, LW_VERDICT_BLOCKED );
	const leeway::Scene second = withAnother( rail, first );
	for ( std::uint64_t stamp = 2; stamp < 20; ++stamp ) // worlds are used again
	{
		ASSERT_EQ(
		    LW_OK, lw_guard_publish( guard.get(), inScene( rail.checker.get(), second.get() ).get(), stamp, nullptr ) );
		EXPECT_EQ( stamp % 3 == 0 || ask( guard.get(), 0 ).verdict == LW_VERDICT_BLOCKED, true );
	}
}

// The ball passes the block beside the rail at 0.05 m.
TEST( Guard, AMarginThatGrewReadsAsFree )
{
	Rail rail;
	lw_transform beside = lw_transform_identity();
	beside.t[0] = 1.5;
	beside.t[1] = 0.25;
	const leeway::Checker checker = inScene( rail.checker.get(), oneObstacle( rail.block.get(), beside ).get() );
	const GuardPtr guard = makeGuard( guardOf( checker.get(), 2 ), rail.clock );
	EXPECT_EQ( ask( guard.get(), 0 ).verdict, LW_VERDICT_FREE );
	const auto edited = [&]( const lw_margins* margins, bool only_changes )
	{
		lw_checker_edit_def edit = lw_checker_edit_def_default();
		edit.margins = margins;
		edit.only_changes = only_changes;
		lw_checker* made = nullptr;
		EXPECT_EQ( LW_OK, lw_checker_edit( checker.get(), &edit, nullptr, nullptr, &made ) );
		return leeway::Checker::adopt( made );
	};
	const double object = 0.06;
	lw_margins margins = {};
	margins.object = &object;
	ASSERT_EQ( LW_OK, lw_guard_publish( guard.get(), edited( &margins, false ).get(), 1, nullptr ) );
	EXPECT_EQ( ask( guard.get(), 0 ).verdict, LW_VERDICT_BLOCKED );
	ASSERT_EQ( LW_OK, lw_guard_publish( guard.get(), checker.get(), 2, nullptr ) );
	EXPECT_EQ( ask( guard.get(), 0 ).verdict, LW_VERDICT_FREE );
	// a checker that lacks pairs is none of a world
	lw_diag diag = {};
	EXPECT_EQ( lw_guard_publish( guard.get(), edited( &margins, true ).get(), 3, &diag ), LW_ERROR_INVALID_ARGUMENT );
	EXPECT_EQ( ask( guard.get(), 0 ).verdict, LW_VERDICT_UNDECIDED );
}

// With a block in tow that is wider than the ball: beside the rail is another one, 0.05 m from the ball.
TEST( Guard, AnAttachedObjectIsForgotten )
{
	Rail rail;
	lw_transform beside = lw_transform_identity();
	beside.t[0] = 1.5;
	beside.t[1] = 0.25;
	const leeway::Checker checker = inScene( rail.checker.get(), oneObstacle( rail.block.get(), beside ).get() );
	lw_guard_def def = guardOf( checker.get(), 2 );
	def.spare_bodies = 1;
	const GuardPtr guard = makeGuard( def, rail.clock );
	EXPECT_EQ( ask( guard.get(), 0 ).verdict, LW_VERDICT_FREE );
	const ShapePtr wide( primitive( LW_SHAPE_BOX, 0.1, 0.4, 0.1 ) );
	lw_attachment_def attached = lw_attachment_def_default();
	const lw_shape* shape = wide.get();
	lw_transform at = lw_transform_identity();
	attached.name = "wide";
	attached.link = 1;
	attached.shapes = &shape;
	attached.link_from_shape = &at;
	attached.shape_count = 1;
	lw_robot* robot = nullptr;
	lw_diag diag = {};
	ASSERT_EQ( LW_OK, lw_robot_attach( rail.robot.get(), &attached, nullptr, &diag, &robot ) ) << diag.message;
	const RobotPtr holding( robot );
	lw_checker_edit_def edit = lw_checker_edit_def_default();
	edit.robot = holding.get();
	lw_checker* made = nullptr;
	ASSERT_EQ( LW_OK, lw_checker_edit( checker.get(), &edit, nullptr, &diag, &made ) ) << diag.message;
	const leeway::Checker with = leeway::Checker::adopt( made );
	ASSERT_EQ( LW_OK, lw_guard_publish( guard.get(), with.get(), 1, &diag ) ) << diag.message;
	EXPECT_EQ( ask( guard.get(), 0 ).verdict, LW_VERDICT_BLOCKED );
	const GuardPtr narrow = makeGuard( guardOf( checker.get(), 2 ), rail.clock );
	EXPECT_EQ( lw_guard_publish( narrow.get(), with.get(), 1, &diag ), LW_ERROR_INVALID_ARGUMENT );
	EXPECT_NE( std::string( diag.message ).find( "spare_bodies" ), std::string::npos ) << diag.message;
}

TEST( Guard, AClockThatStepsBackReadsAsFree )
{
	Rail rail;
	const GuardPtr guard = makeGuard( guardOf( rail.checker.get(), 2 ), rail.clock );
	EXPECT_EQ( ask( guard.get(), 1.2 ).verdict, LW_VERDICT_FREE );
	ASSERT_EQ( LW_OK, rail.publish( guard.get(), 0.5, 1 ) ); // behind the ball
	EXPECT_EQ( ask( guard.get(), 1.2 ).verdict, LW_VERDICT_FREE );
	EXPECT_EQ( ask( guard.get(), 0.2 ).verdict, LW_VERDICT_BLOCKED );
	EXPECT_EQ( ask( guard.get(), 1.2 ).verdict, LW_VERDICT_FREE );
	// the block is proved from 1.2 s on only, so its scene is no base for changes beside it
	ASSERT_EQ( LW_OK, lw_guard_publish( guard.get(),
	                      inScene( rail.checker.get(), withAnother( rail, rail.scene( 0.5 ) ).get() ).get(), 2, nullptr ) );
	EXPECT_EQ( ask( guard.get(), 0.2 ).verdict, LW_VERDICT_BLOCKED );
}

// Stops take hold of worlds, too; the place of a world that was being proved is then used again.
TEST( Guard, AStopInBetweenHidesANewScene )
{
	SeededRng rng;
	Rail rail;
	const double a = 2;
	lw_guard_def def = guardOf( rail.checker.get(), 2 );
	def.braking = 0;
	def.deceleration = &a;
	const GuardPtr guard = makeGuard( def, rail.clock );
	bool blocked = false;
	std::uint64_t stamp = 0;
	for ( int i = 0; i < 2000; ++i )
	{
		const int what = rng.integer( 0, 3 );
		if ( what < 2 )
		{
			blocked = rng.integer( 0, 1 );
			ASSERT_EQ( LW_OK, rail.publish( guard.get(), blocked ? 1.5 : 50, ++stamp ) );
		}
		else if ( what == 2 )
		{
			lw_guard_answer stop;
			ASSERT_EQ( LW_OK, lw_guard_stop( guard.get(), rng.uniform( 0, 0.5 ), INFINITY, &stop ) );
			ASSERT_EQ( stop.verdict, LW_VERDICT_FREE );
			ASSERT_EQ( stop.stamp, stamp );
		}
		else
		{
			const lw_guard_answer answer = ask( guard.get(), 0 );
			ASSERT_EQ( answer.verdict, blocked ? LW_VERDICT_BLOCKED : LW_VERDICT_FREE ) << i;
			ASSERT_EQ( answer.stamp, stamp );
		}
	}
}

// Where the motion has ended the robot rests, and something may come there.
TEST( Guard, AMotionThatHasEndedReadsAsFree )
{
	Rail rail;
	const GuardPtr guard = makeGuard( guardOf( rail.checker.get(), 2 ), rail.clock );
	EXPECT_EQ( ask( guard.get(), 3 ).verdict, LW_VERDICT_FREE );
	ASSERT_EQ( LW_OK, rail.publish( guard.get(), 2, 1 ) );
	EXPECT_NE( ask( guard.get(), 3 ).verdict, LW_VERDICT_FREE );
	EXPECT_NE( ask( guard.get(), 4 ).verdict, LW_VERDICT_FREE );
}

// A clock of ten microseconds a look. A block at the end makes the last window long.
TEST( Guard, ABudgetThatEndsReadsAsFree )
{
	Rail rail;
	const double deceleration = 5;
	lw_guard_def def = guardOf( rail.checker.get(), 2 );
	double time = 0;
	def.window = 0.25;
	def.microseconds = ten;
	def.user = &time;
	def.braking = 0;
	def.deceleration = &deceleration;
	const GuardPtr guard = makeGuard( def, rail.clock );
	ASSERT_EQ( LW_OK, rail.publish( guard.get(), 2.2 + 2e-3, 1 ) );
	double proved = 0;
	int calls = 1;
	for ( lw_guard_answer answer = ask( guard.get(), 0, 15 ); answer.verdict != LW_VERDICT_FREE;
	      answer = ask( guard.get(), 0, 10.0 * ( 2 + ++calls / 10 ) ) )
	{
		ASSERT_LT( calls, 200 );
		EXPECT_EQ( answer.verdict, LW_VERDICT_UNDECIDED );
		EXPECT_EQ( answer.pair.kind, LW_CLEARANCE_UNKNOWN );
		EXPECT_GE( answer.proved_until, proved );
		proved = answer.proved_until;
	}
	EXPECT_GT( calls, 4 );
	EXPECT_GT( proved, 1 );
	// a budget for nothing
	ASSERT_EQ( LW_OK, rail.publish( guard.get(), 2.2 + 3e-3, 2 ) );
	EXPECT_EQ( ask( guard.get(), 0, 5 ).proved_until, 0 );
	lw_guard_answer stop;
	ASSERT_EQ( LW_OK, lw_guard_stop( guard.get(), 1, 5, &stop ) );
	EXPECT_EQ( stop.verdict, LW_VERDICT_UNDECIDED );
	EXPECT_EQ( stop.proved_until, 1 );
	double latest = 0;
	ASSERT_EQ( LW_OK, lw_guard_brake_by( guard.get(), 0, 2, 0.1, 5, &latest ) );
	EXPECT_TRUE( std::isnan( latest ) ) << latest;
	EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT, lw_guard_stop( guard.get(), 1, 0, &stop ) );
	// a block in the place in which it rests
	ASSERT_EQ( LW_OK, rail.publish( guard.get(), 2, 3 ) );
	for ( int budget = 5; budget < 300; budget += 10 )
	{
		EXPECT_NE( ask( guard.get(), 3, budget ).verdict, LW_VERDICT_FREE ) << budget;
	}
	EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT, lw_guard_brake_by( guard.get(), 0, 2, 0.1, NAN, &latest ) );
}

TEST( Guard, ASceneThatCouldNotBePublishedReadsAsFree )
{
	Rail rail;
	lw_guard_def def = guardOf( rail.checker.get(), 2 );
	def.spare_shapes = 0;
	const GuardPtr guard = makeGuard( def, rail.clock );
	EXPECT_EQ( ask( guard.get(), 0 ).verdict, LW_VERDICT_FREE );
	const std::vector<lw_scene_shape_def> shapes( 200, lw_scene_shape_def{ rail.block.get(), 0, lw_transform_identity() } );
	const char* name = "many";
	lw_scene_def many = lw_scene_def_default();
	many.object_names = &name;
	many.object_count = 1;
	many.shapes = shapes.data();
	many.shape_count = 200;
	lw_scene* made = nullptr;
	ASSERT_EQ( LW_OK, lw_scene_create( &many, nullptr, nullptr, &made ) );
	const leeway::Scene scene = leeway::Scene::adopt( made );
	lw_diag diag = {};
	EXPECT_EQ( lw_guard_publish( guard.get(), inScene( rail.checker.get(), scene.get() ).get(), 1, &diag ),
	    LW_ERROR_INVALID_ARGUMENT );
	EXPECT_NE( std::string( diag.message ).find( "spare_shapes" ), std::string::npos ) << diag.message;
	const lw_guard_answer lost = ask( guard.get(), 0 );
	EXPECT_EQ( lost.verdict, LW_VERDICT_UNDECIDED );
	EXPECT_EQ( lost.proved_until, 0 );
	ASSERT_EQ( LW_OK, rail.publish( guard.get(), 50, 2 ) );
	EXPECT_EQ( ask( guard.get(), 0 ).verdict, LW_VERDICT_FREE );
	EXPECT_EQ( rail.publish( guard.get(), 50, 2 ), LW_ERROR_INVALID_ARGUMENT ) << "a stamp twice";
}

// From v = 1 m/s with 2 m/s^2: half a second, a quarter of a metre, after the reaction.
TEST( Guard, AStopEndsElsewhere )
{
	SeededRng rng;
	Rail rail;
	int free = 0, blocked = 0;
	for ( int i = 0; i < 100; ++i )
	{
		const double a = rng.uniform( 0.7, 5 ), reaction = rng.integer( 0, 1 ) * rng.uniform( 0, 0.3 );
		lw_guard_def def = guardOf( rail.checker.get(), 2 );
		def.braking = 0;
		def.deceleration = &a;
		def.reaction = reaction;
		def.timed.contact_resolution = 1e-3;
		const GuardPtr guard = makeGuard( def, rail.clock );
		const double middle = rng.uniform( 0.4, 2 ), contact = middle - 0.2, way = 0.5 / a; // of the ball's middle
		ASSERT_EQ( LW_OK, rail.publish( guard.get(), middle, 1 ) );
		const double from = rng.uniform( 0, 1.5 );
		lw_guard_answer stop;
		ASSERT_EQ( LW_OK, lw_guard_stop( guard.get(), from, INFINITY, &stop ) );
		const double begin = std::min( from + reaction, 2.0 ), stands = begin + ( from + reaction < 2 ? way : 0 );
		const double gap = contact - std::max( from, stands );
		EXPECT_FALSE( gap < -1e-9 && stop.verdict == LW_VERDICT_FREE && from < contact )
		    << from << ' ' << a << ' ' << middle;
		EXPECT_TRUE( gap < 2e-3 || stop.verdict == LW_VERDICT_FREE ) << from << ' ' << a << ' ' << middle;
		if ( stop.verdict == LW_VERDICT_FREE && from + reaction < 2 )
		{
			EXPECT_NEAR( stop.time, from + reaction + 1 / a, 1e-12 );
		}
		free += stop.verdict == LW_VERDICT_FREE;
		blocked += stop.verdict == LW_VERDICT_BLOCKED;
		// the latest time of an order to stop
		const lw_guard_answer answer = ask( guard.get(), 0 );
		double latest = -1;
		ASSERT_EQ( LW_OK, lw_guard_brake_by( guard.get(), 0, answer.proved_until, 0.01, INFINITY, &latest ) );
		const double exact = contact - way - reaction;
		if ( exact < -1e-9 && reaction > 0 ) // at 0 it has not begun to move
		{
			EXPECT_TRUE( std::isnan( latest ) ) << latest << " of " << exact;
		}
		else if ( exact > 0.02 )
		{
			EXPECT_LE( latest, exact + 1e-9 );
			EXPECT_GE( latest, exact - 0.015 );
		}
	}
	EXPECT_GT( free, 10 );
	EXPECT_GT( blocked, 10 );
}

TEST( Guard, RefusesBadSettings )
{
	Rail rail;
	const lw_clock view = rail.clock.view();
	const double zero = 0, one = 1;
	const auto refused = [&]( const lw_guard_def& def, lw_status status )
	{
		lw_guard* guard = nullptr;
		lw_diag diag = {};
		EXPECT_EQ( lw_guard_create( &def, nullptr, &diag, &guard ), status ) << diag.message;
		EXPECT_EQ( guard, nullptr );
	};
	lw_guard_def good = guardOf( rail.checker.get(), 2 );
	good.clock = &view;
	lw_guard_def bad = good;
	bad.cookie = 0;
	refused( bad, LW_ERROR_INVALID_DEF );
	bad = good;
	bad.end = NAN;
	refused( bad, LW_ERROR_INVALID_ARGUMENT );
	bad = good;
	bad.window = 0;
	refused( bad, LW_ERROR_INVALID_ARGUMENT );
	bad = good;
	bad.braking = 1;
	bad.deceleration = &one;
	refused( bad, LW_ERROR_INVALID_ARGUMENT );
	bad = good;
	bad.braking = 0;
	bad.deceleration = &zero;
	refused( bad, LW_ERROR_INVALID_ARGUMENT );
	bad = good;
	bad.checker = nullptr;
	refused( bad, LW_ERROR_INVALID_ARGUMENT );
	const GuardPtr guard = makeGuard( good, rail.clock );
	lw_guard_answer answer;
	EXPECT_EQ( lw_guard_ask( guard.get(), NAN, INFINITY, &answer ), LW_ERROR_INVALID_ARGUMENT );
	EXPECT_EQ( answer.verdict, LW_VERDICT_UNKNOWN );
	EXPECT_EQ( lw_guard_ask( guard.get(), 0, 0, &answer ), LW_ERROR_INVALID_ARGUMENT );
	EXPECT_EQ( lw_guard_ask( guard.get(), 0, 100, &answer ), LW_ERROR_INVALID_ARGUMENT ) << "a budget without a clock";
	EXPECT_EQ( lw_guard_stop( guard.get(), 0, INFINITY, &answer ), LW_ERROR_INVALID_ARGUMENT ) << "nothing brakes";
	double latest;
	EXPECT_EQ( lw_guard_brake_by( guard.get(), 0, 1, 0, INFINITY, &latest ), LW_ERROR_INVALID_ARGUMENT );
}
