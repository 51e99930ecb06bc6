// SPDX-License-Identifier: BSD-3-Clause
// A bar is taken, carried past a wall and left there: the program plans and proves it, and its steps are proved once more by `leeway audit --steps`.
#include "cli_fixture.hpp"

#include <nlohmann/json.hpp>

#include <cmath>

using Json = nlohmann::json;

namespace
{

std::string goal( double shoulder, double elbow )
{
	return "goal_constraints: [{joint_constraints: [{joint_name: shoulder, position: " + std::to_string( shoulder ) +
	       "}, {joint_name: elbow, position: " + std::to_string( elbow ) + "}]}]";
}

std::string changed( const std::string& diff )
{
	return "    planning_options: {planning_scene_diff: {is_diff: true, robot_state: {is_diff: true, "
	       "attached_collision_objects: [" +
	       diff + "]}}}\n";
}

class CliSequence : public Cli
{
protected:
	void SetUp() override
	{
		Cli::SetUp();
		// The tip reaches to 0.8 m, the bar to 1.05 m, the wall stands at 0.9 m
		write( "bar.yaml",
		    "world: {collision_objects: [{id: wall, pose: {position: [1, 0, 0]}, primitives: [{type: box, "
		    "dimensions: [0.2, 0.6, 1]}]}, {id: bar, pose: {position: [0, 0.95, 0]}, primitives: [{type: box, "
		    "dimensions: [0.04, 0.2, 0.04]}]}]}" );
		write( "q.yaml", "items:\n  - req: {start_state: {joint_state: {name: [shoulder, elbow], position: [1.2, 0.5]}}, " +
		                     goal( 1.5707963, 0 ) + "}\n  - req: {" + goal( -1.5, 0 ) + "}\n" + changed( held ) +
		                     "  - req: {" + goal( -1.2, 1 ) + "}\n" + changed( "{object: {id: bar, operation: REMOVE}}" ) );
	}
	Outcome plan( const std::vector<std::string>& more = {} ) const
	{
		std::vector<std::string> all = {
		    "--request", "q.yaml", "--no-cache", "--trajectory", "t.json", "--report", "r.json" };
		all.insert( all.end(), more.begin(), more.end() );
		return runModel( "plan", all, "bar.yaml" );
	}
	/// Writes a trajectory for each leg, from its report.
	void split() const
	{
		const Json whole = Json::parse( readFile( path( "t.json" ) ) )["joint_trajectory"],
		           legs = Json::parse( readFile( path( "r.json" ) ) )["legs"];
		const auto nanoseconds = []( const Json& point )
		{
			return point["time_from_start"]["sec"].get<std::int64_t>() * 1000000000 +
			       point["time_from_start"]["nanosec"].get<std::int64_t>();
		};
		for ( std::size_t i = 0; i < legs.size(); ++i )
		{
			const std::int64_t begin = std::llround( 1e9 * legs[i]["begin"].get<double>() ),
			                   end = begin + std::llround( 1e9 * legs[i]["seconds"].get<double>() );
			Json own = { { "joint_names", whole["joint_names"] } };
			for ( Json point : whole["points"] )
			{
				const std::int64_t time = nanoseconds( point );
				if ( time >= begin - 1 && time <= end + 1 )
				{
					point["time_from_start"] = { { "sec", ( time - begin ) / 1000000000 },
					    { "nanosec", std::max<std::int64_t>( 0, ( time - begin ) % 1000000000 ) } };
					own["points"].push_back( point );
				}
			}
			write( "leg" + std::to_string( i ) + ".json", own.dump() );
		}
	}
	Outcome audit( const std::string& steps ) const
	{
		write( "steps.yaml", "steps:\n" + steps );
		return runModel( "audit", { "--steps", "steps.yaml", "--no-cache" }, "bar.yaml" );
	}

	const std::string held = "{link_name: fore, object: {id: bar, operation: ADD}}";
};

/// Two arms side by side, one joint each with a ball at 0.4 m; both reach the point between them.
class CliGroups : public Cli
{
protected:
	void SetUp() override
	{
		Cli::SetUp();
		std::string urdf = "<robot name='two'><link name='base'/>", srdf = "<robot name='two'>";
		for ( const std::string side : { "left", "right" } )
		{
			urdf += "<link name='" + side +
			        "_hand'><collision><origin xyz='0.4 0 0'/><geometry><sphere radius='0.05'/></geometry>" +
			        "</collision></link><joint name='" + side + "' type='revolute'><parent link='base'/><child link='" +
			        side + "_hand'/><origin xyz='" + ( side == "left" ? "0" : "0.8" ) +
			        " 0 0'/><axis xyz='0 0 1'/><limit lower='-6' upper='6' effort='1' velocity='1'/></joint>";
			srdf += "<group name='" + side + "_arm'><joint name='" + side + "'/></group>";
		}
		write( "two.urdf", urdf + "</robot>" );
		write( "two.srdf", srdf + "</robot>" );
		write( "q.yaml",
		    "items:\n  - req: {group_name: left_arm, start_state: {joint_state: {name: [left, right], position: [1, 1]}}, " +
		        goal( "left", 0 ) + "}\n  - req: {group_name: right_arm, " + goal( "right", 2 ) + "}\n" );
	}
	static std::string goal( const std::string& joint, double position )
	{
		return "goal_constraints: [{joint_constraints: [{joint_name: " + joint +
		       ", position: " + std::to_string( position ) + "}]}]";
	}
	Outcome runTwo( const std::string& command, const std::vector<std::string>& more ) const
	{
		std::vector<std::string> all = { command, "--robot", "two.urdf", "--srdf", "two.srdf", "--no-cache" };
		all.insert( all.end(), more.begin(), more.end() );
		return run( all );
	}
	Outcome plan( const std::vector<std::string>& more = {} ) const
	{
		std::vector<std::string> all = { "--request", "q.yaml", "--trajectory", "t.json", "--report", "r.json" };
		all.insert( all.end(), more.begin(), more.end() );
		return runTwo( "plan", all );
	}
	void expectRefused( const Outcome& outcome, const std::vector<std::string>& parts ) const
	{
		EXPECT_EQ( 2, outcome.status ) << outcome.out;
		for ( const std::string& part : parts )
		{
			EXPECT_TRUE( contains( outcome.err, part ) ) << part << " is not in " << outcome.err;
		}
	}
};

} // namespace

TEST_F( CliSequence, TheStepsOfASequenceAreNotProvedApart )
{
	const Outcome planned = plan();
	ASSERT_EQ( 0, planned.status ) << planned.err;
	EXPECT_TRUE( contains( planned.out, "leg 2: begins with: attach bar to fore" ) ) << planned.out;
	EXPECT_TRUE( contains( planned.out, "leg 3: begins with: release bar" ) );
	const Json report = Json::parse( readFile( path( "r.json" ) ) );
	EXPECT_TRUE( report["good"].get<bool>() );
	EXPECT_EQ( Json( { "attach bar to fore" } ), report["legs"][1]["scene"] );
	EXPECT_FALSE( report["legs"][0].contains( "scene" ) );
	split();
	const std::string first = "- trajectory: leg0.json\n",
	                  last = "- trajectory: leg1.json\n- release: bar\n- trajectory: leg2.json\n";
	const Outcome proved = audit( first + "- {attach: bar, link: fore}\n" + last );
	EXPECT_EQ( 0, proved.status ) << proved.out << proved.err;
	// The empty hand's way past the wall is another one, which the bar would not take
	edit( "q.yaml", changed( held ), "" );
	edit( "q.yaml", changed( "{object: {id: bar, operation: REMOVE}}" ), "" );
	ASSERT_EQ( 0, plan().status );
	split();
	const Outcome hit = audit( first + "- {attach: bar, link: fore}\n" + last );
	EXPECT_EQ( 1, hit.status ) << hit.out << hit.err;
	EXPECT_TRUE( contains( hit.out, "bar" ) && contains( hit.out, "wall" ) ) << hit.out;
}

TEST_F( CliSequence, OtherCommandsProveItInTheFirstScene )
{
	ASSERT_EQ( 0, plan().status );
	const auto expectRefused = [&]( const Outcome& outcome, const std::vector<std::string>& parts )
	{
		EXPECT_EQ( 2, outcome.status ) << outcome.out;
		for ( const std::string& part : parts )
		{
			EXPECT_TRUE( contains( outcome.err, part ) ) << part << " is not in " << outcome.err;
		}
	};
	expectRefused( runModel( "audit", { "--trajectory", "t.json", "--request", "q.yaml", "--no-cache" }, "bar.yaml" ),
	    { "items", "--steps" } );
	edit( "q.yaml", "{id: bar, operation: REMOVE}", "{id: bahr, operation: REMOVE}" );
	expectRefused( plan(), { "q.yaml", "items[2].planning_options.planning_scene_diff", "no object bahr", "bar" } );
}

TEST_F( CliSequence, ACertificateIsOfTheFirstScene )
{
	// The same pairs before the grasp and behind the release, others with the bar in the hand
	const Outcome planned = plan( { "--certificate", "c.lwc" } );
	ASSERT_EQ( 0, planned.status ) << planned.err;
	std::vector<std::string> pairs;
	for ( const char* file : { "c.1.lwc", "c.2.lwc", "c.3.lwc" } )
	{
		EXPECT_EQ( "LWCERT2", readFile( path( file ) ).substr( 0, 7 ) );
		const std::size_t at = planned.out.find( std::string( file ) + ": " );
		ASSERT_NE( std::string::npos, at ) << planned.out;
		pairs.push_back( planned.out.substr( at + 9, planned.out.find( " in ", at ) - at - 9 ) ); // "12 pairs proved"
	}
	EXPECT_EQ( pairs[0], pairs[2] );
	EXPECT_NE( pairs[0], pairs[1] );
	EXPECT_EQ( "", readFile( path( "c.lwc" ) ) );
}

TEST_F( CliSequence, AllGoalStatesAreTaken )
{
	edit( "q.yaml", goal( 1.5707963, 0 ),
	    "goal_constraints: [{position_constraints: [{link_name: tool, constraint_region: {primitives: [{type: box, "
	    "dimensions: [0.02, 0.02, 0.02]}], primitive_poses: [{position: [0, 0.7, 0]}]}}]}]" );
	edit( "q.yaml", changed( held ), "" );
	edit( "q.yaml", changed( "{object: {id: bar, operation: REMOVE}}" ), "" );
	const auto goals = [&]( const std::vector<std::string>& more )
	{
		const Outcome outcome = plan( more );
		EXPECT_EQ( 0, outcome.status ) << outcome.err;
		return Json::parse( readFile( path( "r.json" ) ) )["legs"][0]["goals"].get<int>();
	};
	EXPECT_EQ( 1, goals( { "--goal-states", "1" } ) );
	EXPECT_EQ( 3, goals( { "--goal-states", "3" } ) );
	EXPECT_LT( 3, goals( {} ) );
}

TEST_F( CliGroups, OneTrajectoryForEachGroup )
{
	const Outcome planned = plan( { "--certificate", "c.lwc" } );
	ASSERT_EQ( 0, planned.status ) << planned.err;
	EXPECT_TRUE( contains( planned.out, "s, right_arm, to one of 1 goal(s)" ) ) << planned.out;
	const Json legs = Json::parse( readFile( path( "r.json" ) ) )["legs"];
	EXPECT_EQ( "left_arm", legs[0]["group"] );
	EXPECT_EQ( "right_arm", legs[1]["group"] );
	const Json trajectory = Json::parse( readFile( path( "t.json" ) ) )["joint_trajectory"];
	EXPECT_EQ( Json( { "left", "right" } ), trajectory["joint_names"] );
	for ( const Json& point : trajectory["points"] )
	{
		const double left = point["positions"][0], right = point["positions"][1];
		EXPECT_TRUE( right == 1 || left == 0 ) << point; // one after the other
	}
	EXPECT_EQ( Json( { 0, 2 } ), trajectory["points"].back()["positions"] );
	EXPECT_EQ( "LWCERT2", readFile( path( "c.lwc" ) ).substr( 0, 7 ) );
	const std::vector<std::string> audit = { "--trajectory", "t.json" };
	EXPECT_EQ( 0, runTwo( "audit", audit ).status ); // all joints of this robot
	EXPECT_EQ( 0, runTwo( "audit", { "--trajectory", "t.json", "--group", "right_arm+left_arm" } ).status );
	expectRefused( runTwo( "audit", { "--trajectory", "t.json", "--group", "left_arm" } ), { "right", "not in group" } );
	expectRefused(
	    runTwo( "audit", { "--trajectory", "t.json", "--group", "left_arm+arm" } ), { "group arm", "no such group" } );
}

TEST_F( CliGroups, TheArmThatStandsIsNotSeen )
{
	// Where the left hand stands at x = 0.4, the right one cannot come
	edit( "q.yaml", goal( "right", 2 ), goal( "right", 3.1 ) );
	const Outcome blocked = plan();
	EXPECT_EQ( 1, blocked.status ) << blocked.out;
	EXPECT_TRUE( contains( blocked.err, "leg 2 is not found" ) ) << blocked.err;
	EXPECT_EQ( 2, Json::parse( readFile( path( "r.json" ) ) )["failed_leg"] );
	edit( "q.yaml", goal( "left", 0 ), goal( "left", 2 ) );
	EXPECT_EQ( 0, plan().status );
}

TEST_F( CliGroups, AGroupOfAnItemIsDropped )
{
	expectRefused( plan( { "--group", "left_arm" } ), { "--group", "items of different groups", "leave it out" } );
	edit( "q.yaml", "right_arm", "rihgt_arm" );
	expectRefused( plan(), { "q.yaml", "items[1].req.group_name", "group rihgt_arm", "use one of left_arm, right_arm" } );
	edit( "q.yaml", "rihgt_arm", "right_arm" );
	const auto line = []( const std::string& side, const char* blend )
	{ return "link_name: " + side + "_hand, waypoints: [{position: [0, 0, 0]}]}" + blend; };
	edit( "q.yaml", goal( "left", 0 ) + "}", line( "left", "\n    blend_radius: 0.01" ) );
	edit( "q.yaml", goal( "right", 2 ) + "}", line( "right", "" ) );
	expectRefused( plan(), { "q.yaml", "items[0]", "has a blend", "'right_arm'", "give 0" } );
	// one group for all items, which --group still replaces
	write( "q.yaml", "items: [{req: {group_name: left_arm, start_state: {}, " + goal( "left", 1 ) + "}}]" );
	ASSERT_EQ( 0, plan().status );
	EXPECT_FALSE( Json::parse( readFile( path( "r.json" ) ) )["legs"][0].contains( "group" ) );
	EXPECT_EQ( Json( { "left" } ), Json::parse( readFile( path( "t.json" ) ) )["joint_trajectory"]["joint_names"] );
	write( "q.yaml", "items: [{req: {group_name: left_arm, start_state: {}, " + goal( "right", 1 ) + "}}]" );
	EXPECT_EQ( 0, plan( { "--group", "right_arm" } ).status );
}
