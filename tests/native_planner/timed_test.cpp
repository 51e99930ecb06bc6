// SPDX-License-Identifier: BSD-3-Clause
// Plans in space and time: each path is looked at densely by an evaluation of its own, with exact distances.
#include "leeway/planners/timed_planner.hpp"
#include "gate_world.hpp"
#include "one_obstacle.hpp"
#include "sanitized.hpp"
#include "simple_shapes.hpp"

#include <gtest/gtest.h>

namespace
{

using namespace leeway::planners;

/// Balls that shift along x and y, each without neighbours that it may touch.
RobotPtr balls( int count )
{
	RobotModel model;
	model.link( "world" );
	for ( int i = 0; i < count; ++i )
	{
		const std::string name = "b" + std::to_string( i );
		addJoint( model, ( name + "x" ).c_str(), LW_JOINT_PRISMATIC, 0, 0 );
		addJoint( model, ( name + "y" ).c_str(), LW_JOINT_PRISMATIC, static_cast<std::uint32_t>( 2 * i + 1 ), 1 );
		for ( std::size_t k = model.joints.size() - 2; k < model.joints.size(); ++k )
		{
			model.joints[k].lower = -3;
			model.joints[k].upper = 3;
		}
		model.body( static_cast<std::uint32_t>( 2 * i + 2 ), primitive( LW_SHAPE_SPHERE, radius ), lw_transform_identity() );
	}
	return model.create();
}

OwnedTrack trackOf( const TimedPath& path, const std::vector<std::uint32_t>& variables )
{
	OwnedTrack track;
	track.variables = variables;
	if ( path.count() == 1 )
	{
		track.pieces = { { path.times[0], path.times[0] + 1, 0, path.values } };
	}
	for ( std::size_t i = 1; i < path.count(); ++i )
	{
		OwnedPiece piece = { path.times[i - 1], path.times[i], 1, {} };
		piece.points.assign( path[i - 1], path[i - 1] + 2 * path.dimension );
		track.pieces.push_back( piece );
	}
	return track;
}

struct Place
{
	double time, x, y;
};

/// Goes straight from place to place.
OwnedTrack going( std::uint32_t ball, const std::vector<Place>& places )
{
	OwnedTrack track;
	track.variables = { 2 * ball, 2 * ball + 1 };
	for ( std::size_t i = 1; i < places.size(); ++i )
	{
		const Place &a = places[i - 1], &b = places[i];
		track.pieces.push_back( { a.time, b.time, 1, { a.x, a.y, b.x, b.y } } );
	}
	return track;
}

TimedSettings settingsFor( std::uint32_t ball, double deadline )
{
	TimedSettings settings;
	settings.variables = { 2 * ball, 2 * ball + 1 };
	settings.velocity = { 1, 1 };
	settings.deadline = deadline;
	return settings;
}

void expectUsable( const TimedPath& path, const TimedSettings& settings, const double* start, const double* goal )
{
	ASSERT_GE( path.count(), 2u );
	EXPECT_EQ( path.times.front(), settings.start_time );
	EXPECT_LE( path.times.back(), settings.deadline + 1e-9 );
	for ( std::size_t v = 0; v < path.dimension; ++v )
	{
		EXPECT_EQ( path[0][v], start[v] );
		EXPECT_EQ( path[path.count() - 1][v], goal[v] );
		for ( std::size_t i = 1; i < path.count(); ++i )
		{
			EXPECT_GT( path.times[i], path.times[i - 1] );
			EXPECT_LE( std::abs( path[i][v] - path[i - 1][v] ),
			    settings.velocity[v] * ( path.times[i] - path.times[i - 1] ) * ( 1 + 1e-9 ) );
		}
	}
}

Stop seconds( double time )
{
	Stop stop;
	stop.seconds = time;
	return stop;
}

} // namespace

TEST( TimedPlanner, WaitsAtAGateThatOpensAndNotMuchLonger )
{
	const Gate gate;
	const ClockBench bench( gate.robot.get(), gate.scene.get(), false );
	for ( const std::uint64_t seed : { 1, 2, 3 } )
	{
		OwnedClock clock = Gate::clock();
		TimedSettings settings = settingsFor( 0, 20 );
		settings.seed = seed;
		const double start[] = { -1, 0 }, goal[] = { 1, 0 };
		TimedPlanner planner( bench.checker, settings, clock.view() );
		planner.setStart( start );
		planner.addGoal( goal );
		ASSERT_EQ( planner.solve( bench.query.get(), seconds( 60 ) ), Outcome::SOLVED ) << planner.endProblem();
		expectUsable( planner.path(), settings, start, goal );
		EXPECT_GT( planner.path().times.back(), 5 );
		EXPECT_LT( planner.path().times.back(), 9 );
		clock.tracks.push_back( trackOf( planner.path(), settings.variables ) );
		EXPECT_GT( leastClearance( gate.robot.get(), gate.scene.get(), clock, 0, 20 ), 0 );
	}
}

TEST( TimedPlanner, SaysSoIfTheGateOpensTooLate )
{
	const Gate gate;
	const ClockBench bench( gate.robot.get(), gate.scene.get(), false );
	OwnedClock clock = Gate::clock();
	const double start[] = { -1, 0 }, goal[] = { 1, 0 };
	TimedPlanner late( bench.checker, settingsFor( 0, 5 ), clock.view() );
	late.setStart( start );
	late.addGoal( goal );
	EXPECT_EQ( late.solve( bench.query.get(), seconds( 0.3 ) ), Outcome::TIMED_OUT );
	EXPECT_EQ( late.path().count(), 0u );
	TimedPlanner slow( bench.checker, settingsFor( 0, 1.9 ), clock.view() );
	slow.setStart( start );
	slow.addGoal( goal );
	EXPECT_EQ( slow.solve( bench.query.get(), seconds( 60 ) ), Outcome::NO_GOAL );
	EXPECT_NE( slow.endProblem().find( "full speed" ), std::string::npos ) << slow.endProblem();
}

// Another ball comes through the goal at 8 s, and through the start at -1.
TEST( TimedPlanner, ArrivesOnlyWhereItMayStay )
{
	const RobotPtr robot = balls( 2 );
	const ClockBench bench( robot.get(), nullptr, false );
	OwnedClock clock;
	clock.rest = { 0, 0, 0, 0 };
	clock.tracks = { going( 1, { { 0, 1, -2 }, { 6, 1, -2 }, { 10, 1, 2 } } ) };
	const double start[] = { -1, 0 }, goal[] = { 1, 0 };
	TimedSettings settings = settingsFor( 0, 5 );
	TimedPlanner stays( bench.checker, settings, clock.view() );
	stays.setStart( start );
	stays.addGoal( goal );
	EXPECT_EQ( stays.solve( bench.query.get(), seconds( 60 ) ), Outcome::NO_GOAL );
	EXPECT_NE( stays.endProblem().find( "cannot rest" ), std::string::npos ) << stays.endProblem();
	settings.hold_until = 5;
	TimedPlanner goes_on( bench.checker, settings, clock.view() );
	goes_on.setStart( start );
	goes_on.addGoal( goal );
	EXPECT_EQ( goes_on.solve( bench.query.get(), seconds( 60 ) ), Outcome::SOLVED ) << goes_on.endProblem();
	settings.hold_until = std::numeric_limits<double>::quiet_NaN();
	settings.deadline = 14;
	TimedPlanner later( bench.checker, settings, clock.view() );
	later.setStart( start );
	later.addGoal( goal );
	ASSERT_EQ( later.solve( bench.query.get(), seconds( 60 ) ), Outcome::SOLVED ) << later.endProblem();
	EXPECT_GT( later.path().times.back(), 8 );
}

// Another ball is in the goal at the deadline, and nobody asks the first one to be there then. The third case: the ball is there when
// nobody needs to hold any more, so the first one comes behind it.
TEST( TimedPlanner, TheDeadlineIsNotWhenAGoalIsHeld )
{
	const RobotPtr robot = balls( 2 );
	const ClockBench bench( robot.get(), nullptr, false );
	const double start[] = { -1, 0 }, goal[] = { 1, 0 };
	struct Case
	{
		double deadline, hold, pass; ///< the other ball is in the goal at `pass`
		bool late;
	};
	for ( const Case& c : { Case{ 8, 5, 8, false }, Case{ 8, 0, 8, false }, Case{ 8, 3, 3, true } } )
	{
		OwnedClock clock;
		clock.rest = { 0, 0, 0, 0 };
		clock.tracks = { going( 1, { { c.pass - 2, 1, -2 }, { c.pass + 2, 1, 2 } } ) };
		TimedSettings settings = settingsFor( 0, c.deadline );
		settings.hold_until = c.hold;
		TimedPlanner planner( bench.checker, settings, clock.view() );
		planner.setStart( start );
		planner.addGoal( goal );
		ASSERT_EQ( planner.solve( bench.query.get(), seconds( 60 ) ), Outcome::SOLVED ) << planner.endProblem();
		const double arrival = planner.path().times.back();
		EXPECT_EQ( arrival > c.pass, c.late ) << arrival;
		clock.tracks.push_back( trackOf( planner.path(), settings.variables ) );
		EXPECT_GT( leastClearance( robot.get(), nullptr, clock, 0, std::max( arrival, c.hold ) ), 0 );
	}
	// a ball that stays in the goal is known to stay there
	OwnedClock clock;
	clock.rest = { 0, 0, 1, 0 };
	TimedSettings settings = settingsFor( 0, 8 );
	settings.hold_until = 3;
	TimedPlanner never( bench.checker, settings, clock.view() );
	never.setStart( start );
	never.addGoal( goal );
	EXPECT_EQ( never.solve( bench.query.get(), seconds( 60 ) ), Outcome::NO_GOAL );
}

namespace
{

/// A bar that turns without limits, with a post at angle 0, or none.
struct Turntable
{
	RobotPtr robot;
	leeway::Scene scene;

	explicit Turntable( bool post )
	{
		RobotModel model;
		model.link( "world" );
		addJoint( model, "turn", LW_JOINT_CONTINUOUS, 0, 2 );
		lw_transform out = lw_transform_identity();
		out.t[0] = 0.5;
		model.body( 1, primitive( LW_SHAPE_BOX, 1, 0.1, 0.1 ), out );
		robot = model.create();
		const ShapePtr ball( primitive( LW_SHAPE_SPHERE, 0.1 ) );
		out.t[0] = post ? 0.8 : 5;
		scene = oneObstacle( ball.get(), out );
	}
};

TimedPath turned( const Turntable& table, TimedSettings settings, double start, double goal )
{
	const ClockBench bench( table.robot.get(), table.scene.get(), false );
	OwnedClock clock;
	clock.rest = { 0 };
	settings.variables = { 0 };
	settings.velocity = { 1 };
	TimedPlanner planner( bench.checker, settings, clock.view() );
	planner.setStart( &start );
	planner.addGoal( &goal );
	EXPECT_EQ( planner.solve( bench.query.get(), seconds( 20 ) ), Outcome::SOLVED ) << planner.endProblem();
	return planner.path();
}

} // namespace

// From 3.0 to -3.0 it is 0.28 rad over half a turn, and 6 rad over 0, where a post stands. The numbers of a path go on.
TEST( TimedPlanner, ContinuousJointsGoTheLongWayRound )
{
	TimedSettings settings;
	settings.deadline = 10;
	for ( const bool post : { false, true } )
	{
		const TimedPath path = turned( Turntable( post ), settings, 3.0, -3.0 );
		ASSERT_GE( path.count(), 2u );
		EXPECT_EQ( path[0][0], 3.0 );
		EXPECT_NEAR( path[path.count() - 1][0], 2 * M_PI - 3.0, 1e-12 );
		EXPECT_NEAR( path.times.back(), 2 * M_PI - 6, 1e-6 );
	}
	// the shorter way over 0 is closed: the other one
	const TimedPath other = turned( Turntable( true ), settings, 1.0, -1.0 );
	ASSERT_GE( other.count(), 3u );
	EXPECT_NEAR( other[other.count() - 1][0], 2 * M_PI - 1.0, 1e-9 );
	EXPECT_GE( other.times.back(), 2 * M_PI - 2 - 1e-6 );
	// whole turns are no way at all, but for their rounding
	EXPECT_EQ( turned( Turntable( false ), settings, 0.7 + 10 * M_PI, 0.7 ).count(), 1u );
	// with bounds it does not go round
	settings.lower = { -3.1 };
	settings.upper = { 3.1 };
	const TimedPath bounded = turned( Turntable( false ), settings, 3.0, -3.0 );
	ASSERT_GE( bounded.count(), 2u );
	EXPECT_EQ( bounded[bounded.count() - 1][0], -3.0 );
	EXPECT_NEAR( bounded.times.back(), 6, 1e-6 );
}

// Nothing to do is a wait, of one state; where another ball comes through, it gets out of the way and comes back.
TEST( TimedPlanner, AStartThatIsTheGoalMoves )
{
	const RobotPtr robot = balls( 2 );
	const ClockBench bench( robot.get(), nullptr, false );
	const double start[] = { 1, 0 };
	for ( const bool passes : { false, true } )
	{
		OwnedClock clock;
		clock.rest = { 0, 0, 0, 0 };
		const double x = passes ? 1 : 2;
		clock.tracks = { going( 1, { { 2, x, -2 }, { 6, x, 2 } } ) };
		TimedSettings settings = settingsFor( 0, 10 );
		settings.start_time = 0.5;
		TimedPlanner planner( bench.checker, settings, clock.view() );
		planner.setStart( start );
		planner.addGoal( start );
		ASSERT_EQ( planner.solve( bench.query.get(), seconds( 60 ) ), Outcome::SOLVED ) << planner.endProblem();
		const TimedPath& path = planner.path();
		if ( passes )
		{
			expectUsable( path, settings, start, start );
			clock.tracks.push_back( trackOf( path, settings.variables ) );
			EXPECT_GT( leastClearance( robot.get(), nullptr, clock, 0.5, 10 ), 0 );
			continue;
		}
		ASSERT_EQ( path.count(), 1u );
		EXPECT_EQ( path.times[0], 0.5 );
		EXPECT_EQ( path[0][0], 1 );
		EXPECT_EQ( path[0][1], 0 );
	}
}

// A ball passes behind the goal 0.1 s after the arrival, where a controller that is late still is.
TEST( TimedPlanner, ALateControllerIsProvedUntilItArrives )
{
	const RobotPtr robot = balls( 2 );
	const ClockBench bench( robot.get(), nullptr, false );
	const double start[] = { -1, 0 }, goal[] = { 1, 0 };
	for ( const double lag : { 0.0, 0.3 } )
	{
		OwnedClock clock;
		clock.rest = { 0, 0, 0, 0 };
		clock.tracks = { going( 1, { { 1.95, 0.55, -3 }, { 2.25, 0.55, 3 } } ) };
		TimedSettings settings = settingsFor( 0, 2 );
		settings.lag = lag;
		settings.hold_until = 0;
		TimedPlanner planner( bench.checker, settings, clock.view() );
		planner.setStart( start );
		planner.addGoal( goal );
		EXPECT_EQ( planner.solve( bench.query.get(), seconds( 0.3 ) ) == Outcome::SOLVED, lag == 0 ) << planner.endProblem();
	}
}

// The start and the goal touch nearly a block, and the controller is late by decimetres: the block does not see how late.
TEST( TimedPlanner, ALateControllerStartsBesideABlock )
{
	const RobotPtr robot = balls( 1 );
	const ShapePtr block( primitive( LW_SHAPE_BOX, 1, 1, 1 ) );
	lw_transform place = lw_transform_identity();
	place.t[1] = 0.5 + radius + 0.005;
	const leeway::Scene scene = oneObstacle( block.get(), place );
	const ClockBench bench( robot.get(), scene.get(), false );
	const double start[] = { -0.3, 0 }, goal[] = { 0.3, 0 };
	OwnedClock clock;
	clock.rest = { 0, 0 };
	TimedSettings settings = settingsFor( 0, 3 );
	settings.lag = 0.3;
	TimedPlanner planner( bench.checker, settings, clock.view() );
	planner.setStart( start );
	planner.addGoal( goal );
	EXPECT_EQ( planner.solve( bench.query.get(), seconds( 5 ) ), Outcome::SOLVED ) << planner.endProblem();
}

// Balls pass in front of the goal one after the other, at random speeds; the controller is late by up to 30 ms and 1 cm off.
TEST( TimedPlanner, PathsThroughTrafficSurviveADenseLook )
{
	SeededRng rng;
	int solved = 0;
	for ( int i = 0; i < unlessSanitized( 25, 3 ); ++i )
	{
		const int count = rng.integer( 2, 6 );
		const RobotPtr robot = balls( count );
		const ClockBench bench( robot.get(), nullptr, i % 2 == 0 );
		OwnedClock clock;
		clock.rest.assign( 2 * static_cast<std::size_t>( count ), 0.0 );
		for ( int k = 1; k < count; ++k )
		{
			const double x = -1.1 + 0.45 * k, begin = rng.uniform( 0, 3 ), side = rng.integer( 0, 1 ) ? 1 : -1;
			clock.tracks.push_back( going( static_cast<std::uint32_t>( k ),
			    { { begin, x, -2.5 * side + 0.01 * k }, { begin + rng.uniform( 1, 6 ), x, 2.5 * side } } ) );
		}
		TimedSettings settings = settingsFor( 0, 12 );
		settings.tolerance = { 0.01, 0.01 };
		settings.lag = 0.03;
		settings.seed = static_cast<std::uint64_t>( i );
		const double start[] = { -2, 0 }, goal[] = { 2, 0 };
		clock.rest[0] = -2;
		TimedPlanner planner( bench.checker, settings, clock.view() );
		planner.setStart( start );
		planner.addGoal( goal );
		const Outcome outcome = planner.solve( bench.query.get(), seconds( 5 ) );
		if ( outcome != Outcome::SOLVED )
		{
			continue;
		}
		++solved;
		expectUsable( planner.path(), settings, start, goal );
		clock.tracks.push_back( trackOf( planner.path(), settings.variables ) );
		for ( const double late : { -0.03, 0.0, 0.03 } )
		{
			for ( const double off : { -0.01, 0.01 } )
			{
				OwnedClock moved = clock;
				for ( OwnedPiece& piece : moved.tracks.back().pieces )
				{
					piece.start += late;
					piece.end += late;
					for ( double& value : piece.points )
					{
						value += off;
					}
				}
				EXPECT_GT( leastClearance( robot.get(), nullptr, moved, 0, 13 ), 0 ) << "late " << late << ", off " << off;
			}
		}
	}
	std::printf( "%d solved\n", solved );
	EXPECT_GE( solved, unlessSanitized( 15, 1 ) );
}

TEST( TimedPlanner, EqualSeedsGiveEqualPaths )
{
	const Gate gate;
	const ClockBench bench( gate.robot.get(), gate.scene.get(), false );
	TimedPath paths[2];
	for ( TimedPath& path : paths )
	{
		OwnedClock clock = Gate::clock();
		TimedSettings settings = settingsFor( 0, 20 );
		settings.seed = 7;
		const double start[] = { -1, 1 }, goal[] = { 1, -1 };
		TimedPlanner planner( bench.checker, settings, clock.view() );
		planner.setStart( start );
		planner.addGoal( goal );
		ASSERT_EQ( planner.solve( bench.query.get(), seconds( 60 ) ), Outcome::SOLVED ) << planner.endProblem();
		path = planner.path();
	}
	EXPECT_EQ( paths[0].times, paths[1].times );
	EXPECT_EQ( paths[0].values, paths[1].values );
}

TEST( TimedPlanner, RefusesUnusableSettings )
{
	const Gate gate;
	const ClockBench bench( gate.robot.get(), gate.scene.get(), false );
	OwnedClock clock = Gate::clock();
	const auto refused = [&]( const TimedSettings& settings, const char* words )
	{
		try
		{
			TimedPlanner planner( bench.checker, settings, clock.view() );
			ADD_FAILURE() << words;
		}
		catch ( const InputError& error )
		{
			EXPECT_NE( std::string( error.what() ).find( words ), std::string::npos ) << error.what();
		}
	};
	const TimedSettings good = settingsFor( 0, 20 );
	TimedSettings bad = good;
	bad.velocity = { 1 };
	refused( bad, "velocity" );
	bad = good;
	bad.velocity = { 1, 0 };
	refused( bad, "velocities" );
	bad = good;
	bad.deadline = 0;
	refused( bad, "deadline" );
	bad = good;
	bad.variables = { 0, 2 };
	refused( bad, "both move variable 2" );
	bad = good;
	bad.tolerance = { -1, 0 };
	refused( bad, "tolerance" );
	bad = good;
	bad.lag = NAN;
	refused( bad, "lag" );
	bad = good;
	bad.lower = { 0 };
	bad.upper = { 1 };
	refused( bad, "lower and upper" );
	for ( const std::vector<std::size_t>& sizes : { std::vector<std::size_t>{ 1 }, { 1, 2 }, { 2, 0 } } )
	{
		bad = good;
		bad.controllers = sizes;
		refused( bad, "controllers" );
	}
	TimedPlanner planner( bench.checker, good, clock.view() );
	const double outside[] = { 5, 0 };
	EXPECT_THROW( planner.setStart( outside ), InputError );
	EXPECT_THROW( planner.solve( bench.query.get() ), InputError );
}

namespace
{

TimedRobot robotOf( std::uint32_t ball, std::vector<double> start, std::vector<double> goal )
{
	TimedRobot robot;
	robot.name = "ball " + std::to_string( ball );
	robot.variables = { 2 * ball, 2 * ball + 1 };
	robot.velocity = { 1, 1 };
	robot.lower = { -3, -3 };
	robot.upper = { 3, 3 };
	robot.start = std::move( start );
	robot.goals = { std::move( goal ) };
	return robot;
}

void expectFree( const RobotPtr& robot, const SchedulePlan& plan, const std::vector<TimedRobot>& robots )
{
	OwnedClock clock;
	clock.rest.assign( 2 * robots.size(), 0.0 );
	for ( std::size_t r = 0; r < robots.size(); ++r )
	{
		clock.tracks.push_back( trackOf( plan.paths[r], robots[r].variables ) );
	}
	EXPECT_GT( leastClearance( robot.get(), nullptr, clock, 0, 20 ), 0 );
}

} // namespace

// The second ball rests in the goal of the first: only it can go first.
TEST( SchedulePlanner, FindsTheOnlyOrderThatWorks )
{
	const RobotPtr robot = balls( 2 );
	const ClockBench bench( robot.get(), nullptr, false );
	const std::vector<TimedRobot> robots = { robotOf( 0, { -2, 0 }, { 1, 0 } ), robotOf( 1, { 1, 0 }, { 1, 2 } ) };
	OwnedClock clock;
	clock.rest.assign( 4, 0.0 );
	ScheduleSettings settings;
	settings.timed.deadline = 15;
	settings.search_seconds = 0.5;
	const SchedulePlan plan = planSchedule( bench.checker, bench.query.get(), robots, clock.view(), settings );
	ASSERT_EQ( plan.outcome, Outcome::SOLVED ) << plan.problem;
	EXPECT_EQ( plan.order, ( std::vector<std::size_t>{ 1, 0 } ) );
	EXPECT_EQ( plan.proof.verdict, LW_VERDICT_FREE );
	expectFree( robot, plan, robots );
}

// One robot has nothing to do; the other one goes around it.
TEST( SchedulePlanner, ARobotThatStaysIsNoTrack )
{
	const RobotPtr robot = balls( 2 );
	const ClockBench bench( robot.get(), nullptr, false );
	const std::vector<TimedRobot> robots = { robotOf( 0, { 0, 0 }, { 0, 0 } ), robotOf( 1, { -1, 0 }, { 1, 0 } ) };
	OwnedClock clock;
	clock.rest.assign( 4, 0.0 );
	for ( const bool together : { false, true } )
	{
		ScheduleSettings settings;
		settings.timed.deadline = 15;
		settings.search_seconds = 60;
		settings.together = together;
		const SchedulePlan plan = planSchedule( bench.checker, bench.query.get(), robots, clock.view(), settings );
		ASSERT_EQ( plan.outcome, Outcome::SOLVED ) << plan.problem;
		EXPECT_TRUE( together || plan.paths[0].count() == 1 );
		expectFree( robot, plan, robots );
	}
}

// Two balls in each other's goals: neither can go first while the other one stands there.
TEST( SchedulePlanner, TogetherTwoRobotsChangePlaces )
{
	const RobotPtr robot = balls( 2 );
	const ClockBench bench( robot.get(), nullptr, false );
	const std::vector<TimedRobot> robots = { robotOf( 0, { -1, 0 }, { 1, 0 } ), robotOf( 1, { 1, 0 }, { -1, 0 } ) };
	OwnedClock clock;
	clock.rest.assign( 4, 0.0 );
	ScheduleSettings settings;
	settings.timed.deadline = 15;
	settings.search_seconds = 0.2;
	SchedulePlan plan = planSchedule( bench.checker, bench.query.get(), robots, clock.view(), settings );
	EXPECT_NE( plan.outcome, Outcome::SOLVED );
	EXPECT_FALSE( plan.problem.empty() );
	settings.together = true;
	settings.search_seconds = 60;
	plan = planSchedule( bench.checker, bench.query.get(), robots, clock.view(), settings );
	ASSERT_EQ( plan.outcome, Outcome::SOLVED ) << plan.problem;
	expectFree( robot, plan, robots );
}

// One search moves both balls on one path, but each has its own controller: a plan that only holds if both are late alike is none.
TEST( SchedulePlanner, TogetherEachRobotIsLateByItself )
{
	const RobotPtr robot = balls( 2 );
	const ClockBench bench( robot.get(), nullptr, false );
	std::vector<TimedRobot> robots = { robotOf( 0, { -1, 0 }, { 1, 0 } ), robotOf( 1, { 1, 0 }, { -1, 0 } ) };
	OwnedClock clock;
	clock.rest.assign( 4, 0.0 );
	for ( TimedRobot& r : robots )
	{
		r.lag = 0.15;
	}
	ScheduleSettings settings;
	settings.timed.deadline = 15;
	settings.search_seconds = 60;
	settings.together = true;
	for ( std::uint64_t seed = 1; seed <= 5; ++seed )
	{
		settings.timed.seed = seed;
		const SchedulePlan plan = planSchedule( bench.checker, bench.query.get(), robots, clock.view(), settings );
		EXPECT_EQ( plan.outcome, Outcome::SOLVED ) << plan.problem;
	}
}

TEST( SchedulePlanner, RefusesVariablesBeyondTheGroup )
{
	const RobotPtr robot = balls( 2 );
	const ClockBench bench( robot.get(), nullptr, false );
	std::vector<TimedRobot> robots = { robotOf( 0, { -1, 0 }, { 1, 0 } ) };
	robots[0].variables[1] = 100000;
	OwnedClock clock;
	clock.rest.assign( 4, 0.0 );
	const ScheduleSettings settings;
	EXPECT_THROW( planSchedule( bench.checker, bench.query.get(), robots, clock.view(), settings ), InputError );
	lw_clock no_rest = clock.view();
	no_rest.rest = nullptr;
	robots[0].variables[1] = 1;
	EXPECT_THROW( planSchedule( bench.checker, bench.query.get(), robots, no_rest, settings ), InputError );
}
