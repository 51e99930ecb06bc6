// SPDX-License-Identifier: BSD-3-Clause
// Motions of a world on one clock: states between the points of files, loops, changed motions, proofs.
#include "world_files.hpp"

#include "leeway/motions/schedule.hpp"

#include <cmath>
#include <fmt/format.h>

using namespace leeway::io;
using namespace leeway::motions;

namespace
{

const std::string ball = "shapes: [{type: sphere, dimensions: [0.1]}]";

/// A world, its problem and its schedule.
struct Made
{
	explicit Made( WorldModel of, ProblemOptions options = {} ) : world( std::move( of ) )
	{
		const ProblemOptions own = worldProblem( world );
		options.scene = own.scene;
		options.overrides = own.overrides;
		options.allowed = own.allowed;
		problem = buildProblem( world.robot, options );
		schedule = std::make_unique<Schedule>( world, problem );
	}
	double value( double time, const std::string& name )
	{
		const auto found = std::find( problem.variable_names.begin(), problem.variable_names.end(), name );
		return schedule->state( time ).at( static_cast<std::size_t>( found - problem.variable_names.begin() ) );
	}
	ScheduleAudit audit( double from, double to, double resolution = 0 )
	{
		ScheduleSettings settings;
		settings.from = from;
		settings.to = to;
		settings.contact_resolution = resolution;
		return auditSchedule( *schedule, settings );
	}
	WorldModel world;
	Problem problem;
	std::unique_ptr<Schedule> schedule;
};

class ScheduleTest : public WorldFileTest
{
protected:
	static std::string point( double time, const std::string& positions, const std::string& velocities = "" )
	{
		return "{positions: [" + positions + "]" + ( velocities.empty() ? "" : ", velocities: [" + velocities + "]" ) +
		       fmt::format( ", time_from_start: {}}}", time );
	}
	void writeMotion( const std::string& joints, const std::vector<std::string>& points )
	{
		std::string text = "joint_names: [" + joints + "]\npoints:\n";
		for ( const std::string& one : points )
		{
			text += "  - " + one + "\n";
		}
		write( "m.yaml", text );
	}
	/// A cart on the x axis that drives by m.yaml.
	std::string cart( const std::string& more = "motion: m.yaml" ) const
	{
		return "robots: [{name: cart, robot: cart.urdf" + ( more.empty() ? "" : ", " + more ) + "}]\n";
	}
	static std::string object( const std::string& more ) { return "objects: [{name: box, " + ball + ", " + more + "}]\n"; }
};

} // namespace

TEST_F( ScheduleTest, StatesLeaveTheTrajectory )
{
	writeMotion( "slide", { point( 0, "0.2", "0" ), point( 1, "1", "0.5" ), point( 3, "-1", "0" ) } );
	for ( const double shift : { 0.0, 1.5, -0.25 } )
	{
		Made made( load( cart( fmt::format( "motion: m.yaml, motion_start: {}", shift ) ) ) );
		const auto hermite = []( double s, double h, double a, double va, double b, double vb )
		{
			return a * ( 1 - 3 * s * s + 2 * s * s * s ) + b * ( 3 * s * s - 2 * s * s * s ) +
			       h * va * ( s - 2 * s * s + s * s * s ) + h * vb * ( s * s * s - s * s );
		};
		for ( double t = -1; t < 5; t += 0.1 )
		{
			const double expected = t < 0   ? 0.2
			                        : t < 1 ? hermite( t, 1, 0.2, 0, 1, 0.5 )
			                        : t < 3 ? hermite( ( t - 1 ) / 2, 2, 1, 0.5, -1, 0 )
			                                : -1;
			EXPECT_NEAR( made.value( t + shift, "cart/slide" ), expected, 1e-12 ) << t;
		}
		EXPECT_NEAR( made.schedule->duration(), 3 + shift, 1e-12 );
	}
}

TEST_F( ScheduleTest, JointsThatATrajectoryDoesNotNameMove )
{
	const std::string robots =
	    "robots: [{name: left, robot: arm.urdf, state: {shoulder: 0.4, elbow: 0.7}, motion: m.yaml}]\n";
	for ( const char* name : { "elbow", "left/elbow" } )
	{
		writeMotion( name, { point( 0.5, "0" ), point( 1, "1" ) } );
		Made made( load( robots ) );
		for ( const double t : { 0.0, 0.75, 2.0 } )
		{
			EXPECT_EQ( made.value( t, "left/shoulder" ), 0.4 );
		}
		EXPECT_EQ( made.value( 0, "left/elbow" ), 0 ) << "it stands at the first point, not at its state";
		EXPECT_EQ( made.value( 0.75, "left/elbow" ), 0.5 );
		EXPECT_EQ( made.value( 9, "left/elbow" ), 1 );
	}
	writeMotion( "elbo", { point( 0, "0" ), point( 1, "1" ) } );
	expectError(
	    [&] { Made made( load( robots ) ); }, { "m.yaml", "joint_names", "robot left has no joint 'elbo'", "elbow" } );
}

TEST_F( ScheduleTest, APartWithoutAMotionIsElsewhereThanItsState )
{
	Made made( load( cart( "state: {slide: 0.3}" ) + object( "unknown_motion: {speed: 1}, pose: {position: [0, 9, 0]}" ) ) );
	EXPECT_EQ( made.value( 5, "cart/slide" ), 0.3 );
	EXPECT_EQ( made.value( 5, "box/x" ), 0 );
	EXPECT_EQ( made.schedule->duration(), 0 );
	writeMotion( "slide", { point( 0, "0.7" ) } );
	EXPECT_EQ( Made( load( cart() ) ).value( 3, "cart/slide" ), 0.7 );
}

TEST_F( ScheduleTest, SeveralTrajectoriesJump )
{
	const auto two = [&]( const std::string& first, const std::string& second )
	{
		write( "m.yaml", "trajectory:\n  - joint_trajectory: {joint_names: [slide], points: [" + first +
		                     "]}\n  - joint_trajectory: {joint_names: [slide], points: [" + second + "]}\n" );
	};
	two( point( 0, "0" ) + ", " + point( 1, "1" ), point( 0, "1" ) + ", " + point( 2, "0" ) );
	Made made( load( cart() ) );
	EXPECT_EQ( made.value( 2, "cart/slide" ), 0.5 );
	EXPECT_EQ( made.schedule->duration(), 3 );
	two( point( 0, "0" ) + ", " + point( 1, "1" ), point( 0, "0.5" ) + ", " + point( 2, "0" ) );
	expectError( [&] { Made bad( load( cart() ) ); }, { "m.yaml", "robots[0] cart", "points[0]", "0.5", "cannot jump" } );
	two( point( 0, "0" ) + ", " + point( 1, "1" ), point( 0, "1" ) );
	expectError( [&] { Made bad( load( cart() ) ); }, { "m.yaml", "one point" } );
}

TEST_F( ScheduleTest, ALoopEnds )
{
	Made made( load(
	    cart( "" ) +
	    object(
	        "pose: {position: [0, 5, 0]}, motion: [{start: 1, end: 2, position: [1, 5, 0]}, {start: 2, end: 3, position: [0, 5, 0]}, "
	        "{start: 3, end: 3.5, turn: {axis: [0, 0, 1], angle: 6.283185307179586}}], repeat: 4" ) ) );
	EXPECT_EQ( made.schedule->duration(), 3.5 );
	for ( const double t : { 0.0, 1.0, 1.5, 2.5, 3.2, 4.9 } )
	{
		for ( const int rounds : { 1, 2, 50 } )
		{
			const double later = t + 4 * rounds, before = std::fmax( 1, t ) - 1;
			EXPECT_NEAR( made.value( later, "box/x" ), made.value( t < 1 ? t + 4 : t, "box/x" ), 1e-9 )
			    << later << " " << before;
			EXPECT_NEAR( std::remainder( made.value( later, "box/turn1" ) - made.value( t < 1 ? t + 4 : t, "box/turn1" ),
			                 6.283185307179586 ),
			    0, 1e-9 )
			    << later;
		}
	}
	EXPECT_NEAR( made.value( 4 * 10 + 1, "box/turn1" ), 10 * 6.283185307179586, 1e-9 );
	expectError( [&] { made.schedule->clock( 1e9 ); }, { "cell.yaml", "objects[0] box", "more than 1000000 pieces" } );
}

/// The cart drives onto the way of the box when the box is far; it comes back again and again.
TEST_F( ScheduleTest, OnlyTheFirstRoundOfALoopIsProved )
{
	writeMotion( "slide", { point( 0, "-2" ), point( 2.5, "-2" ), point( 3.5, "0" ) } );
	const std::string loop =
	    "pose: {position: [0, 1, 0]}, motion: [{start: 0, end: 1, position: [0, -1, 0]}, {start: 1, end: 2, position: [0, 1, 0]}], repeat: 4";
	Made made( load( cart() + object( loop ) ) );
	EXPECT_EQ( made.audit( 0, 3.9 ).verdict, LW_VERDICT_FREE );
	const ScheduleAudit hit = made.audit( 0, 9, 1e-3 );
	ASSERT_EQ( hit.verdict, LW_VERDICT_BLOCKED );
	// the ball's radius and half of the cart's width from 1 m on, at 2 m/s
	EXPECT_NEAR( hit.time, 4 + ( 1 - 0.13 ) / 2, 2e-3 );
	EXPECT_GT( hit.proved_until, hit.time - 2e-3 );
	EXPECT_EQ( hit.pair.first + hit.pair.second, "cart/cartbox" );
	EXPECT_EQ( made.audit( 100, 101 ).verdict, LW_VERDICT_BLOCKED );
}

TEST_F( ScheduleTest, AnUnknownMotionIsProvedNotToCome )
{
	const std::string person = object( "pose: {position: [0, 2, 0]}, unknown_motion: {speed: 0.5, from: 1}" );
	ProblemOptions with_tables;
	with_tables.find_reach = ReachOptions();
	with_tables.max_d = 0.25;
	for ( const ProblemOptions& options : { ProblemOptions(), with_tables } )
	{
		Made made( load( cart( "" ) + person ), options );
		// 2 m less the ball's radius and half of the cart's width, at 0.5 m/s
		const double meets = 1 + ( 2 - 0.13 ) / 0.5;
		EXPECT_EQ( made.audit( 0, meets - 0.05 ).verdict, LW_VERDICT_FREE );
		const ScheduleAudit audit = made.audit( 0, meets + 1, 1e-3 );
		EXPECT_EQ( audit.verdict, LW_VERDICT_BLOCKED );
		EXPECT_TRUE( audit.by_spread );
		EXPECT_NEAR( audit.time, meets, 0.05 ) << describe( audit );
		EXPECT_NEAR( audit.pair.least(), 2 - 0.13, 1e-6 );
		EXPECT_NE( describe( audit ).find( "which the unknown motion may close" ), std::string::npos ) << describe( audit );
	}
}

TEST_F( ScheduleTest, LagsAndTolerancesAreForgotten )
{
	writeMotion( "slide", { point( 0, "-1" ), point( 1, "1" ), point( 2, "-1" ) } );
	// The ball crosses the rail 0.5 s after the cart has gone
	const std::string passes =
	    object( "pose: {position: [0, 1, 0]}, motion: [{start: 0.5, end: 1.5, position: [0, -1, 0]}]" );
	const auto verdict = [&]( const std::string& more )
	{ return Made( load( cart( "motion: m.yaml" + more ) + passes ) ).audit( 0, 2 ).verdict; };
	EXPECT_EQ( verdict( "" ), LW_VERDICT_FREE );
	EXPECT_EQ( verdict( ", lag: 0.1, tolerance: 0.1" ), LW_VERDICT_FREE );
	EXPECT_NE( verdict( ", lag: 0.45" ), LW_VERDICT_FREE );
	EXPECT_NE( verdict( ", tolerance: 0.9" ), LW_VERDICT_FREE );
	write( "m.yaml", "trajectory: {joint_names: [slide], points: [" + point( 0, "-1" ) + ", " + point( 1, "1" ) + ", " +
	                     point( 2, "-1" ) + "]}\npath_tolerance: [{name: slide, position: 0.9}]\n" );
	EXPECT_NE( verdict( "" ), LW_VERDICT_FREE ) << "the goal's own tolerance";
	EXPECT_EQ( verdict( ", tolerance: 0.1" ), LW_VERDICT_FREE );
}

TEST_F( ScheduleTest, AReplacedMotionStaysAsItWas )
{
	writeMotion( "slide", { point( 0, "0" ), point( 1, "1" ) } );
	Made made(
	    load( cart() + object( "pose: {position: [-1, 0, 0]}, motion: [{start: 0, end: 4, position: [-1, 0, 3]}]" ) ) );
	EXPECT_EQ( made.schedule->duration(), 4 );
	made.schedule->add( "cart", { 2, 4, 8 }, { { 0.5 }, { 1 }, { 1.5 } } );
	EXPECT_EQ( made.value( 0, "cart/slide" ), 0.5 );
	EXPECT_EQ( made.value( 3, "cart/slide" ), 0.75 );
	EXPECT_EQ( made.value( 9, "cart/slide" ), 1.5 );
	EXPECT_EQ( made.schedule->duration(), 8 );
	expectError(
	    [&] {
		    made.schedule->add( "cart", { 2, 1 }, { { 0 }, { 1 } } );
	    },
	    { "cell.yaml", "robots[0] cart", "edge 0", "begin before it ends" } );
	expectError( [&] { made.schedule->add( "cart", { 2, 3 }, { { 0 }, { 1, 2 } } ); }, { "motion of cart", "variables" } );
	expectError( [&] { made.schedule->add( "car", { 2, 3 }, { { 0 }, { 1 } } ); }, { "motion of car", "no such part" } );
	expectError( [&] { made.schedule->add( "cart", { 2, 3 }, { { 0 }, { NAN } } ); }, { "cart", "not finite" } );
	EXPECT_EQ( made.value( 3, "cart/slide" ), 0.75 ) << "a bad motion changed the one before";
	made.schedule->add( "cart", { 0 }, { { 0.25 } } );
	EXPECT_EQ( made.value( 3, "cart/slide" ), 0.25 );
}

TEST_F( ScheduleTest, AGroupLeavesAMovingPartOut )
{
	writeMotion( "slide", { point( 0, "0" ), point( 1, "1" ) } );
	const WorldModel world = load(
	    "robots:\n  - {name: cart, robot: cart.urdf, motion: m.yaml}\n  - {name: left, robot: arm.urdf, base: {position: [0, 4, 0]}}\n" );
	ProblemOptions options;
	options.group = "left";
	expectError(
	    [&] { Made made( world, options ); }, { "cell.yaml", "robots[0] cart", "cart/slide is not in group 'left'" } );
	options.group = "cart";
	EXPECT_EQ( Made( world, options ).schedule->state( 0.5 ), std::vector<double>{ 0.5 } );
}

TEST_F( ScheduleTest, AProofSaysMoreThanSamplesSee )
{
	writeMotion( "slide", { point( 0, "-1", "0" ), point( 1.5, "1", "1" ), point( 3, "-0.5", "0" ) } );
	Made made( load(
	    cart() +
	    object(
	        "pose: {position: [0, 0.6, 0]}, motion: [{start: 0, end: 2, points: [[0, 0.6, 0], [0.5, 0.3, 0], [1, 0.5, 0.2]]}]" ) ) );
	const ScheduleAudit audit = made.audit( 0, 3 );
	ASSERT_EQ( audit.verdict, LW_VERDICT_FREE );
	const leeway::Query query = leeway::makeQuery( made.problem.checker.get() );
	double least = HUGE_VAL;
	for ( double t = 0; t <= 3; t += 0.01 )
	{
		const lw_state_result state =
		    measure( made.problem.checker.get(), query.get(), made.schedule->state( t ), LW_CHECK_SELF, nullptr, "", "" );
		least = std::fmin( least, state.self.upper );
	}
	EXPECT_LE( audit.lower_bound, least );
	EXPECT_GT( audit.lower_bound, 0 );
	EXPECT_NE( describe( audit ).find( "at least" ), std::string::npos );
}
