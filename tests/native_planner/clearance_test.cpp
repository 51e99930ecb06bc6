// SPDX-License-Identifier: BSD-3-Clause
// Paths that keep farther away: the clearance that is reported is there, nothing gets nearer than before, the ends stay.
#include "planner_rig.hpp"

#include "leeway/planners/clearance.hpp"
#include "leeway/planners/smooth.hpp"

#include "margin_prover.hpp"

namespace
{

/// Least clearances along a path, by exact states at most 2 mm or 2 mrad apart.
struct Sampled
{
	double environment = inf, self = inf;
};

Sampled sampled( const leeway::Checker& checker, const planners::Path& path )
{
	const leeway::Query query = leeway::makeQuery( checker.get() );
	const lw_robot* robot = lw_checker_robot( checker.get() );
	std::vector<double> a( lw_robot_variable_count( robot ) ), b( a ), between( a ), q( path.dimension );
	Sampled least;
	for ( std::size_t i = 0; i + 1 < path.count(); ++i )
	{
		lw_checker_full_state( checker.get(), path[i], a.data() );
		lw_checker_full_state( checker.get(), path[i + 1], b.data() );
		double travel = 0;
		for ( std::size_t k = 0; k < a.size(); ++k )
		{
			travel = std::max( travel, std::fabs( b[k] - a[k] ) );
		}
		const int count = 1 + static_cast<int>( travel / 0.002 );
		for ( int k = 0; k <= count; ++k )
		{
			lw_robot_interpolate( robot, a.data(), b.data(), double( k ) / count, between.data() );
			for ( std::uint32_t v = 0; v < q.size(); ++v )
			{
				q[v] = between[lw_checker_variable( checker.get(), v )];
			}
			lw_state_result state;
			EXPECT_EQ(
			    lw_checker_state( checker.get(), query.get(), q.data(), LW_CHECK_BOTH, nullptr, false, &state ), LW_OK );
			least.environment = std::min( least.environment, state.environment.lower );
			least.self = std::min( least.self, state.self.lower );
		}
	}
	return least;
}

planners::ClearanceSettings untimed( double goal = 0.03 )
{
	planners::ClearanceSettings settings;
	settings.goal = goal;
	settings.seconds = inf;
	return settings;
}

/// A ball on two rails that passes 2 mm beside the corner of a box.
struct Corner
{
	leeway::Checker checker = makeChecker( { slider( "rail x", 0, -1, 1 ), slider( "rail y", 1, -1, 1, makeBall( 0.05 ) ) },
	    { { makeBox( 0.4, 0.4, 0.4 ), at( 0, -0.252, 0 ) } } );
	leeway::Query query = leeway::makeQuery( checker.get() );
	planners::Path path{ 2, { -0.8, 0, 0.8, 0 } };
	planners::ClearanceReport report;

	lw_status raise( const planners::ClearanceSettings& settings, const planners::Stop& stop = {} )
	{
		return planners::raiseClearance( checker.get(), query.get(), settings, stop, path, &report );
	}
};

TEST( NativeClearance, GoalIsReachedAroundACorner )
{
	Corner corner;
	ASSERT_EQ( corner.raise( untimed() ), LW_OK );
	EXPECT_TRUE( corner.report.changed );
	EXPECT_NEAR( corner.report.environment.before.upper, 0.002, 1e-6 );
	EXPECT_GT( corner.report.environment.before.lower, 0.0016 );
	EXPECT_LT( corner.report.environment.before.lower, 0.002 );
	EXPECT_GE( corner.report.environment.after.lower, 0.03 - 1e-12 );
	EXPECT_GE( sampled( corner.checker, corner.path ).environment, 0.03 - 1e-9 );
	EXPECT_LE( corner.report.length_after, 1.1 * corner.report.length_before );
	EXPECT_EQ( corner.report.length_after, planners::length( corner.checker.get(), corner.path ) );
	EXPECT_LE( corner.path.count(), 8u ) << "states that nothing needs stay";
	EXPECT_EQ( corner.report.notice, "" );
}

TEST( NativeClearance, ReportedClearanceIsThereAndNothingComesNearer )
{
	unsigned changed = 0, doubled = 0;
	for ( const char* name : { "Gantry", "Arm", "Cart", "Carrier" } )
	{
		for ( const std::uint64_t seed : { 3u, 4u, 5u } )
		{
			SCOPED_TRACE( name + std::string( ", seed " ) + std::to_string( seed ) );
			planners::Settings search;
			search.seed = seed;
			Problem problem( worldOf( name ), search );
			ASSERT_EQ( problem.solve(), Outcome::SOLVED );
			planners::Path path = problem.planner.path();
			planners::SmoothSettings smoothing;
			smoothing.seed = seed;
			ASSERT_EQ( planners::smooth( problem.checker.get(), problem.query.get(), smoothing, {}, path ), LW_OK );
			const planners::Path given = path;
			const Sampled before = sampled( problem.checker, given );
			planners::ClearanceReport report;
			ASSERT_EQ( planners::raiseClearance( problem.checker.get(), problem.query.get(), untimed(), {}, path, &report ),
			    LW_OK );
			const Sampled after = sampled( problem.checker, path );
			const double goal = report.goal, rounding = 1e-9;
			EXPECT_GE( after.environment, report.environment.after.lower - rounding );
			EXPECT_GE( after.self, report.self.after.lower - rounding );
			EXPECT_GE( before.environment, report.environment.before.lower - rounding );
			EXPECT_LE( std::min( before.environment, goal ), report.environment.before.upper + 1e-3 );
			EXPECT_LE( std::min( after.environment, goal ), report.environment.after.upper + 1e-3 );
			EXPECT_GE( report.environment.after.lower, report.environment.before.lower );
			EXPECT_GE( report.self.after.lower, report.self.before.lower );
			EXPECT_LE( planners::length( problem.checker.get(), path ),
			    1.1 * planners::length( problem.checker.get(), given ) + rounding );
			EXPECT_EQ( stateOf( path, 0 ), stateOf( given, 0 ) );
			EXPECT_EQ( stateOf( path, path.count() - 1 ), stateOf( given, given.count() - 1 ) );
			EXPECT_EQ( report.changed, path.values != given.values );
			audit( problem.checker, path );
			changed += report.changed;
			doubled += report.environment.middle_after.lower >= 2 * report.environment.middle_before.upper;
		}
	}
	EXPECT_GE( changed, 8u );
	EXPECT_GE( doubled, 5u );
}

TEST( NativeClearance, SameCallSamePath )
{
	for ( const char* name : { "Arm", "Carrier" } )
	{
		planners::Settings search;
		search.seed = 4;
		Problem problem( worldOf( name ), search );
		ASSERT_EQ( problem.solve(), Outcome::SOLVED );
		planners::Path paths[2] = { problem.planner.path(), problem.planner.path() };
		for ( planners::Path& path : paths ) // the second time the query is warm
		{
			ASSERT_EQ( planners::raiseClearance( problem.checker.get(), problem.query.get(), untimed(), {}, path ), LW_OK );
		}
		EXPECT_EQ( paths[0].values, paths[1].values ) << name;
	}
}

TEST( NativeClearance, PathThatIsNotFreeStaysAsItIs )
{
	Corner corner;
	corner.path.values = { -0.8, -0.3, 0.8, -0.3 }; // through the box
	const planners::Path given = corner.path;
	ASSERT_EQ( corner.raise( untimed() ), LW_OK );
	EXPECT_EQ( corner.path.values, given.values );
	EXPECT_FALSE( corner.report.changed );
	EXPECT_EQ( corner.report.environment.after.lower, 0 );
	EXPECT_NE( corner.report.notice.find( "not proved free" ), std::string::npos ) << corner.report.notice;
}

TEST( NativeClearance, TimeEndsItWithAFreePath )
{
	for ( const double seconds : { 0.0, 1e-5, 1e-4, 3e-4, 1e-3 } )
	{
		Corner corner;
		planners::Stop stop;
		stop.seconds = seconds;
		ASSERT_EQ( corner.raise( untimed(), stop ), LW_OK );
		EXPECT_TRUE( seconds > 0 || !corner.report.changed );
		EXPECT_GE( sampled( corner.checker, corner.path ).environment, 0.002 - 1e-9 );
		EXPECT_GE( corner.report.environment.after.lower, corner.report.environment.before.lower );
	}
}

TEST( NativeClearance, ClearanceOfAnEndIsNamed )
{
	Corner corner;
	corner.path.values = { -0.8, 0, 0.4, 0, 0.26, -0.252 }; // the goal is 10 mm beside the box
	ASSERT_EQ( corner.raise( untimed() ), LW_OK );
	EXPECT_NEAR( corner.report.environment.ends, 0.01, 1e-6 );
	EXPECT_LE( corner.report.environment.after.upper, 0.01 + 1e-6 );
	EXPECT_NE( corner.report.notice.find( "0.01 m" ), std::string::npos ) << corner.report.notice;
}

TEST( NativeClearance, PairThatNoJointChangesDoesNotHoldTheOthers )
{
	// A ball turns about its own centre 4 mm beside the body that carries it: self clearance is 4 mm in every state
	Segment spin = hinge( "spin", LW_JOINT_REVOLUTE, 0, 0.1, -1, 1 );
	spin.shape = makeBall( 0.03 );
	spin.link_from_shape = lw_transform_identity();
	spin.joint.parent_from_joint = at( 0, 0, 0.084 );
	Segment bare = hinge( "bare", LW_JOINT_REVOLUTE, 0, 0.1, -1, 1 );
	bare.shape = {};
	const leeway::Checker checker =
	    makeChecker( { slider( "rail x", 0, -1, 1 ), slider( "rail y", 1, -1, 1, makeBall( 0.05 ) ), bare, spin },
	        { { makeBox( 0.4, 0.4, 0.4 ), at( 0, -0.252, 0 ) } } );
	const leeway::Query query = leeway::makeQuery( checker.get() );
	planners::Path path{ 4, { -0.8, 0, 0, -0.5, 0.8, 0, 0, 0.5 } };
	planners::ClearanceReport report;
	ASSERT_EQ( planners::raiseClearance( checker.get(), query.get(), untimed(), {}, path, &report ), LW_OK );
	EXPECT_NEAR( report.self.before.upper, 0.004, 1e-6 );
	EXPECT_NEAR( report.self.after.upper, 0.004, 1e-6 );
	EXPECT_GE( report.environment.after.lower, 0.03 - 1e-12 ) << report.notice;
}

TEST( NativeClearance, MarginsOfTheCallerStay )
{
	Corner corner;
	corner.path.values = { -0.8, 0.02, 0.8, 0.02 }; // 22 mm
	planners::ClearanceSettings settings = untimed( 0.02 );
	settings.edge.min_d = 0.02;
	ASSERT_EQ( corner.raise( settings ), LW_OK );
	EXPECT_EQ( corner.report.goal, 0.04 );
	EXPECT_GE( corner.report.environment.after.lower, 0.04 - 1e-12 );
	EXPECT_GE( sampled( corner.checker, corner.path ).environment, 0.04 - 1e-9 );
	settings.edge.min_d = 0.2;
	EXPECT_EQ( corner.raise( settings ), LW_OK );
	EXPECT_NE( corner.report.notice.find( "not proved free" ), std::string::npos ) << corner.report.notice;
}

TEST( NativeClearance, LengthKeepsItsLimit )
{
	for ( const double longer : { 0.0, 0.002, 0.02 } )
	{
		Corner corner;
		planners::ClearanceSettings settings = untimed( 0.2 );
		settings.longer = longer;
		ASSERT_EQ( corner.raise( settings ), LW_OK );
		EXPECT_LE( planners::length( corner.checker.get(), corner.path ), ( 1 + longer ) * 1.6 + 1e-12 ) << longer;
	}
}

TEST( NativeClearance, ProofsEndWhereAPointMoves )
{
	planners::Band band;
	for ( const double x : { 0.0, 1.0, 2.0, 3.0 } )
	{
		band.add( &x, 1 );
	}
	for ( planners::Band::Edge& edge : band.edges )
	{
		edge.proved = { 0.01, 0.02 };
		edge.upper = { 0.1, 0.1 };
	}
	band.first = 1;
	band.last = 2;
	band.insert( 1, { 1.5 } );
	EXPECT_EQ( band.last, 3u );
	EXPECT_EQ( band.edges[1].proved[1], 0.02 ) << "parts of a proved edge are proved";
	EXPECT_EQ( band.edges[2].proved[1], 0.02 );
	EXPECT_TRUE( std::isnan( band.edges[1].upper[0] ) ) << "the place of the low state is another now";
	band.move( 3, { 2.1 } );
	EXPECT_EQ( band.edges[1].proved[0], 0.01 );
	EXPECT_EQ( band.edges[2].proved[0], 0 );
	EXPECT_EQ( band.edges[3].proved[0], 0 );
	EXPECT_TRUE( std::isnan( band.points[3].upper[0] ) );
	planners::Band::Edge joined;
	joined.proved = { 0.005, 0.006 };
	band.drop( 2, joined );
	ASSERT_EQ( band.points.size(), 4u );
	EXPECT_EQ( band.last, 2u );
	EXPECT_EQ( band.edges[1].proved[0], 0.005 );
	EXPECT_EQ( band.points[2].q[0], 2.1 );
}

TEST( NativeClearance, BadInputIsRefused )
{
	Corner corner;
	const auto refuses = [&]( auto change )
	{
		planners::ClearanceSettings settings = untimed();
		change( settings );
		EXPECT_THROW( corner.raise( settings ), planners::InputError );
	};
	refuses( []( planners::ClearanceSettings& s ) { s.goal = 0; } );
	refuses( []( planners::ClearanceSettings& s ) { s.goal = nan_value; } );
	refuses( []( planners::ClearanceSettings& s ) { s.longer = -1; } );
	refuses( []( planners::ClearanceSettings& s ) { s.seconds = 0; } );
	refuses( []( planners::ClearanceSettings& s ) { s.edge.cookie = 0; } );
	refuses( [&]( planners::ClearanceSettings& ) { corner.path.dimension = 3; } );
	corner.path = { 2, { -0.8, nan_value } };
	refuses( []( planners::ClearanceSettings& ) {} );
	corner.path = { 2, { -0.8, 0 } };
	ASSERT_EQ( corner.raise( untimed() ), LW_OK );
	EXPECT_FALSE( corner.report.changed );
}

} // namespace
