// SPDX-License-Identifier: BSD-3-Clause
// leeway plan --line: trajectories on lines, the places where they end, and options that cannot be meant.
#include "cli_fixture.hpp"

#include <nlohmann/json.hpp>

#include <cmath>

namespace
{

class CliLine : public Cli
{
protected:
	/// From shoulder -1, elbow 1 the planar arm's tool goes along lines, free to turn in its plane.
	Outcome line(
	    const std::vector<std::string>& poses, std::vector<std::string> more = {}, const char* scene = "scene.yaml" ) const
	{
		std::vector<std::string> arguments = { "--group", "arm", "--start", "shoulder=-1,elbow=1", "--free-axis", "0,0,1" };
		for ( const std::string& pose : poses )
		{
			arguments.insert( arguments.end(), { "--line", pose } );
		}
		arguments.insert( arguments.end(), more.begin(), more.end() );
		return runModel( "plan", arguments, scene );
	}
};

} // namespace

TEST_F( CliLine, ATrajectoryOnALineIsRefusedByItsAudit )
{
	const Outcome plan = line(
	    { "tool=0.6,0,0", "tool=0.5,0.2,0 via 0.6,0.1,0" }, { "--trajectory", "line.json", "--report", "report.json" } );
	ASSERT_EQ( plan.status, 0 ) << plan.err;
	EXPECT_TRUE( contains( plan.out, "2 part(s)" ) ) << plan.out;
	EXPECT_TRUE( contains( plan.out, "proved at all times" ) ) << plan.out;
	const Outcome audit = runModel( "audit", { "--trajectory", "line.json" } );
	EXPECT_EQ( audit.status, 0 ) << audit.out << audit.err;
	const auto file = nlohmann::json::parse( readFile( path( "line.json" ) ) );
	const auto& points = file["joint_trajectory"]["points"];
	bool moves = false;
	for ( const auto& point : points )
	{
		EXPECT_FALSE( point.contains( "accelerations" ) ); // cubics
		moves = moves || std::fabs( point["velocities"][0].get<double>() ) > 0.01;
	}
	EXPECT_TRUE( moves );
	const auto q = points.back()["positions"].get<std::vector<double>>();
	EXPECT_NEAR( 0.5, 0.4 * std::cos( q[0] ) + 0.4 * std::cos( q[0] + q[1] ), 1e-9 );
	EXPECT_NEAR( 0.2, 0.4 * std::sin( q[0] ) + 0.4 * std::sin( q[0] + q[1] ), 1e-9 );
	const auto report = nlohmann::json::parse( readFile( path( "report.json" ) ) );
	EXPECT_TRUE( report["solved"].get<bool>() );
	EXPECT_LE( report["position_error"].get<double>(), 1e-4 );
}

TEST_F( CliLine, WithoutAFileTheTrajectoryIsLost )
{
	const Outcome plan = line( { "tool=0.6,0,0" } );
	ASSERT_EQ( plan.status, 0 ) << plan.err;
	EXPECT_TRUE( nlohmann::json::parse( plan.out ).contains( "joint_trajectory" ) );
	EXPECT_TRUE( contains( plan.err, "proved at all times" ) );
}

TEST_F( CliLine, ThePlaceOfACollisionIsNotNamed )
{
	const Outcome plan =
	    line( { "tool=0.6,0.3,0" }, { "--trajectory", "line.json", "--report", "report.json" }, "blocked.yaml" );
	EXPECT_EQ( plan.status, 1 );
	EXPECT_TRUE( contains( plan.err, "come too near" ) ) << plan.err;
	EXPECT_TRUE( contains( plan.err, "post" ) ) << plan.err;
	EXPECT_TRUE( contains( plan.err, "shoulder=" ) ) << plan.err;
	EXPECT_TRUE( readFile( path( "line.json" ) ).empty() );
	const auto report = nlohmann::json::parse( readFile( path( "report.json" ) ) );
	EXPECT_EQ( "collision", report["obstacle"]["kind"] );
	EXPECT_GT( report["obstacle"]["fraction"].get<double>(), 0 );
}

TEST_F( CliLine, AnArmTooShortIsNotNamed )
{
	const Outcome plan = line( { "tool=0.2,-1.5,0" }, { "--trajectory", "line.json" } );
	EXPECT_EQ( plan.status, 1 );
	EXPECT_TRUE( contains( plan.err, "the end of the arm's reach" ) || contains( plan.err, "at its limit" ) ) << plan.err;
}

TEST_F( CliLine, OptionsThatCannotBeMeant )
{
	const struct
	{
		std::vector<std::string> poses, more;
		const char* words;
	} cases[] = {
	    { { "0.6,0,0" }, {}, "names no link" },
	    { { "tool=0.6,0" }, {}, "has 2 numbers; give 3 or 7" },
	    { { "tool=0.6,0,x" }, {}, "'x' is not a finite number" },
	    { { "tool=0.6,0,0,0,0,0,0" }, {}, "the quaternion has length 0, not 1" },
	    { { "tool=0.6,0,0", "finger=0.6,0.1,0" }, {}, "names another link" },
	    { { "nobody=0.6,0,0" }, {}, "nobody" },
	    { { "tool=0.6,0,0 via 0.6,0" }, {}, "has 2 numbers; give 3" },
	    { { "tool=0.6,0,0 blend 0.1" }, {}, "the way ends there" },
	    { { "tool=0.6,0,0 blend x", "tool=0.6,0.1,0" }, {}, "'x' is not a finite number" },
	    { { "tool=0.6,0,0 blend -1", "tool=0.6,0.1,0" }, {}, "has the radius -1" },
	    { { "tool=0.6,0,0", "tool=0.6,0.1,0" }, { "--line-blend", "-1" }, "--line-blend" },
	    { { "tool=0.6,0,0", "tool=0.6,0.1,0" }, { "--line-blend", "0.2" }, "of a line of 0.1 m" },
	    { { "tool=0.6,0,0" }, { "--line-tolerance", "0" }, "--line-tolerance" },
	    { { "tool=0.6,0,0" }, { "--line-angle", "-1" }, "--line-angle" },
	    { { "tool=0.6,0,0" }, { "--line-speed", "0" }, "--line-speed" },
	    { { "tool=0.6,0,0" }, { "--goal", "shoulder=1" }, "stands beside --line" },
	    { { "tool=0.6,0,0" }, { "--out", "path.yaml" }, "give --trajectory FILE" },
	    { { "tool=0.6,0,0" }, { "--line-tip", "1" }, "--line-tip" },
	    { { "tool=0.6,0,0" }, { "--line-frame", "nowhere" }, "nowhere" },
	    { { "base=0.6,0,0" }, {}, "does not move the frame" },
	};
	for ( const auto& wrong : cases )
	{
		const Outcome plan = line( wrong.poses, wrong.more );
		EXPECT_EQ( plan.status, 2 ) << wrong.words;
		EXPECT_TRUE( contains( plan.err, wrong.words ) ) << "lacks '" << wrong.words << "': " << plan.err;
	}
}

TEST_F( CliLine, AProvedLineHasNoCertificateAndNoPage )
{
	std::vector<std::string> more = { "--trajectory", "line.json", "--certificate", "line.lwc" };
	std::vector<std::string> blocked = { "--trajectory", "none.json", "--certificate", "none.lwc" };
#ifdef LEEWAY_HAS_VIEW
	more.insert( more.end(), { "--view", "line.html" } );
	blocked.insert( blocked.end(), { "--view", "none.html" } );
#endif
	const Outcome plan = line( { "tool=0.6,0,0" }, more );
	ASSERT_EQ( plan.status, 0 ) << plan.err;
	EXPECT_TRUE( contains( plan.out, "that the frame stays on its lines is no part of it" ) ) << plan.out;
	EXPECT_FALSE( readFile( path( "line.lwc" ) ).empty() );
	// Of a line that is not found nothing is certified; the page shows the start, and why
	EXPECT_EQ( line( { "tool=0.6,0.3,0" }, blocked, "blocked.yaml" ).status, 1 );
	EXPECT_TRUE( readFile( path( "none.json" ) ).empty() );
	EXPECT_TRUE( readFile( path( "none.lwc" ) ).empty() );
#ifdef LEEWAY_HAS_VIEW
	EXPECT_TRUE( contains( readFile( path( "line.html" ) ), "proved at all times" ) );
	EXPECT_TRUE( contains( readFile( path( "none.html" ) ), "come too near" ) );
#endif
}

TEST_F( CliLine, ARoundedCornerIsRestedAt )
{
	const std::vector<std::string> way = {
	    "tool=0.6,-0.1,0", "tool=0.6,0.1,0", "tool=0.5,0.2,0 via 0.6,0.2,0", "tool=0.45,0.2,0" };
	const Outcome plan = line( way, { "--line-blend", "0.03", "--trajectory", "line.json", "--report", "report.json" } );
	ASSERT_EQ( plan.status, 0 ) << plan.err;
	EXPECT_TRUE( contains( plan.out, "4 part(s)" ) ) << plan.out;
	const auto report = nlohmann::json::parse( readFile( path( "report.json" ) ) );
	EXPECT_EQ( 6u, report["parts"].size() ); // two lines and two halves of a corner; an arc has none
	const auto file = nlohmann::json::parse( readFile( path( "line.json" ) ) );
	int rests = 0;
	for ( const auto& point : file["joint_trajectory"]["points"] )
	{
		rests += point["velocities"][0].get<double>() == 0 && point["velocities"][1].get<double>() == 0 ? 1 : 0;
	}
	EXPECT_EQ( 4, rests ); // both ends, and both of the arc
	// A radius of its own
	const Outcome own = line( { "tool=0.6,-0.1,0 blend 0.02", "tool=0.6,0.1,0" }, { "--trajectory", "line.json" } );
	EXPECT_EQ( own.status, 0 ) << own.err;
}

TEST_F( CliLine, WaypointsOfARequestAreLeftOut )
{
	const std::string start = "group_name: arm\nstart_state: {joint_state: {name: [shoulder, elbow], position: [-1, 1]}}\n";
	const std::string waypoints = "link_name: tool\nheader: {frame_id: base}\nmax_step: 0.01\nwaypoints:\n"
	                              "  - {position: {x: 0.6, y: -0.1, z: 0}, orientation: {x: 0, y: 0, z: 0, w: 1}}\n"
	                              "  - {position: {x: 0.6, y: 0.1, z: 0}, orientation: {x: 0, y: 0, z: 0, w: 1}}\n";
	const auto plan = [&]( const std::string& request, std::vector<std::string> more = {} )
	{
		write( "way.yaml", request );
		more.insert( more.end(), { "--request", "way.yaml", "--trajectory", "way.json", "--free-axis", "0,0,1" } );
		return runModel( "plan", more );
	};
	const Outcome way = plan( start + waypoints );
	ASSERT_EQ( way.status, 0 ) << way.err;
	EXPECT_TRUE( contains( way.err, "max_step" ) && contains( way.err, "proved at all times, not at steps" ) ) << way.err;
	const auto by_request = nlohmann::json::parse( readFile( path( "way.json" ) ) );
	ASSERT_EQ( 0, line( { "tool=0.6,-0.1,0", "tool=0.6,0.1,0" }, { "--trajectory", "line.json" } ).status );
	const auto by_options = nlohmann::json::parse( readFile( path( "line.json" ) ) );
	EXPECT_EQ( by_request["joint_trajectory"]["points"], by_options["joint_trajectory"]["points"] );
	EXPECT_EQ( 0, plan( start + waypoints, { "--line-blend", "0.02" } ).status );
	const struct
	{
		std::string request, words;
		std::vector<std::string> more;
	} cases[] = {
	    { start + waypoints + "goal_constraints: [{joint_constraints: [{joint_name: elbow, position: 0}]}]\n",
	        "beside waypoints", {} },
	    { start + waypoints + "avoid_collisions: false\n", "always proved free", {} },
	    { start + waypoints + "max_cartesian_speed: -1\n", "is below 0", {} },
	    { start + "link_name: tool\nwaypoints: []\n", "give one pose or more", {} },
	    { start + "link_name: palm\nwaypoints: [{position: [0.6, 0, 0]}]\n", "palm", {} },
	    { start + waypoints, "stands beside a request that has waypoints", { "--line", "tool=0.6,0,0" } },
	};
	for ( const auto& wrong : cases )
	{
		const Outcome outcome = plan( wrong.request, wrong.more );
		EXPECT_EQ( outcome.status, 2 ) << wrong.words;
		EXPECT_TRUE( contains( outcome.err, wrong.words ) ) << "lacks '" << wrong.words << "': " << outcome.err;
	}
	write( "s.csv", "shoulder,elbow\n0,0\n" );
	const Outcome check = runModel( "check", { "--request", "way.yaml", "--states", "s.csv" } );
	EXPECT_TRUE( contains( check.err, "give them to `leeway plan`" ) ) << check.err;
}

TEST_F( CliLine, WaypointsBreakTheConstraintsAlongTheirWay )
{
	const auto plan = [&]( const char* tolerances )
	{
		write( "way.yaml",
		    std::string( "group_name: arm\nstart_state: {joint_state: {name: [shoulder, elbow], position: [-1, 1]}}\n"
		                 "link_name: tool\nwaypoints: [{position: [0.6, -0.1, 0]}, {position: [0.6, 0.1, 0]}]\n"
		                 "path_constraints: {joint_constraints: [{joint_name: elbow, position: 1.2, " ) +
		        tolerances + "}]}\n" );
		return runModel( "plan",
		    { "--request", "way.yaml", "--trajectory", "way.json", "--free-axis", "0,0,1", "--report", "report.json" } );
	};
	const Outcome kept = plan( "tolerance_above: 0.3, tolerance_below: 0.3" ); // the way needs 1 to 1.446
	ASSERT_EQ( kept.status, 0 ) << kept.err;
	EXPECT_TRUE( contains( kept.out, "elbow" ) ) << kept.out;
	EXPECT_EQ( 0, runModel( "audit", { "--trajectory", "way.json" } ).status );
	const Outcome broken = plan( "tolerance_above: 0.22, tolerance_below: 0.3" ); // broken in the second part alone
	EXPECT_EQ( broken.status, 1 );
	EXPECT_TRUE( contains( broken.err, "part 2" ) && contains( broken.err, "elbow" ) ) << broken.err;
	const auto report = nlohmann::json::parse( readFile( path( "report.json" ) ) );
	EXPECT_EQ( "constraint", report["obstacle"]["kind"] );
	EXPECT_TRUE( contains( report["obstacle"]["constraint"], "elbow" ) );
}

TEST_F( CliLine, ItemsOfASequenceArePlannedOneByOne )
{
	const std::string start = "start_state: {joint_state: {name: [shoulder, elbow], position: [-1, 1]}}";
	const std::string goal =
	    "goal_constraints: [{position_constraints: [{link_name: tool, constraint_region: {primitives: [{type: "
	    "sphere, dimensions: [0.001]}], primitive_poses: [{position: [0.6, -0.1, 0]}]}}]}]";
	const std::string line = "link_name: tool, waypoints: [{position: [0.6, 0.1, 0]}]";
	const std::string back = "link_name: tool, waypoints: [{position: [0.5, 0.1, 0]}]";
	const auto plan = [&]( const std::string& items, std::vector<std::string> more = {}, const char* scene = "scene.yaml" )
	{
		write( "q.yaml", "items:\n" + items );
		more.insert(
		    more.end(), { "--group", "arm", "--request", "q.yaml", "--trajectory", "q.json", "--free-axis", "0,0,1" } );
		return runModel( "plan", more, scene );
	};
	const auto item = []( const std::string& request, const std::string& blend = "0" )
	{ return "  - {req: {" + request + "}, blend_radius: " + blend + "}\n"; };
	const std::string all = item( start + ", " + goal ) + item( line, "0.02" ) + item( back );
	const Outcome whole = plan( all, { "--report", "report.json", "--certificate", "q.lwc" } );
	ASSERT_EQ( whole.status, 0 ) << whole.err;
	EXPECT_TRUE( contains( whole.out, "3 leg(s)" ) && contains( whole.out, "leg 3:" ) ) << whole.out;
	EXPECT_EQ( 0, runModel( "audit", { "--trajectory", "q.json" } ).status );
	EXPECT_FALSE( readFile( path( "q.lwc" ) ).empty() );
	const auto report = nlohmann::json::parse( readFile( path( "report.json" ) ) );
	ASSERT_EQ( 3u, report["legs"].size() );
	EXPECT_NEAR( report["legs"][1]["begin"].get<double>(), report["legs"][0]["seconds"].get<double>(), 1e-8 );
	const auto file = nlohmann::json::parse( readFile( path( "q.json" ) ) );
	const auto& points = file["joint_trajectory"]["points"];
	int rests = 0;
	for ( const auto& point : points )
	{
		rests += point["velocities"][0].get<double>() == 0 && point["velocities"][1].get<double>() == 0 ? 1 : 0;
	}
	EXPECT_GE( 4, rests ); // at the ends, before the first line, perhaps at a corner of the first motion; not at the blend
	const auto q = points.back()["positions"].get<std::vector<double>>();
	EXPECT_NEAR( 0.1, 0.4 * std::sin( q[0] ) + 0.4 * std::sin( q[0] + q[1] ), 1e-9 );
	// The post stands in the way of the second leg
	const Outcome blocked = plan( all, { "--report", "report.json" }, "blocked.yaml" );
	EXPECT_EQ( blocked.status, 1 );
	EXPECT_TRUE( contains( blocked.err, "leg 2 is not found" ) && contains( blocked.err, "post" ) ) << blocked.err;
	EXPECT_EQ( 2, nlohmann::json::parse( readFile( path( "report.json" ) ) )["failed_leg"] );
	const struct
	{
		std::string items, words;
		std::vector<std::string> more;
	} cases[] = {
	    { item( start + ", " + goal, "0.1" ) + item( line ), "items[0]", {} },
	    { item( start + ", " + goal ) + item( line, "0.1" ), "behind the last motion", {} },
	    { item( start + ", " + goal ) + item( start + ", " + line ), "starts where items[0] ends", {} },
	    { item( goal ) + item( line ), "start_state", {} },
	    { item( start + ", " + goal ) + item( goal + ", group_name: legs" ) + item( goal + ", group_name: arm" ),
	        "items of different groups", {} },
	    { item( start + ", planner_id: LIN, " + goal ), "give waypoints", {} },
	    { item( start + ", " + goal ) + item( "link_name: palm, waypoints: [{position: [0.6, 0, 0]}]" ),
	        "items[1].req.link_name", {} },
	    { "  []\n", "give one motion", {} },
	    { "  - {req: {" + start + ", " + goal + "}, blend: 0}\n", "blend", {} },
	    { all, "--goal", { "--goal", "shoulder=0" } },
	    { all, "--planner", { "--planner", "SBL" } },
	    { all, "--line-blend", { "--line-blend", "0.1" } },
	};
	for ( const auto& wrong : cases )
	{
		const Outcome outcome = plan( wrong.items, wrong.more );
		EXPECT_EQ( outcome.status, 2 ) << wrong.words;
		EXPECT_TRUE( contains( outcome.err, wrong.words ) ) << "lacks '" << wrong.words << "': " << outcome.err;
	}
	const Outcome audit = runModel( "audit", { "--trajectory", "q.json", "--request", "q.yaml" } );
	EXPECT_EQ( audit.status, 2 ) << audit.out;
}
