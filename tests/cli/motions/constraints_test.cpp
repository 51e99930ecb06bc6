// SPDX-License-Identifier: BSD-3-Clause
// Constraints along the path of a request: proved of a trajectory, or found broken; those that no proof knows are refused by name.
#include "../cli_fixture.hpp"

#include <nlohmann/json.hpp>

#include <cmath>

namespace
{

/// The planar arm turns its shoulder from -1 to 1 within two seconds, its elbow stays at 0.5.
class CliConstraints : public Cli
{
protected:
	void SetUp() override
	{
		Cli::SetUp();
		write( "t.json", R"({"joint_trajectory": {"joint_names": ["shoulder", "elbow"], "points": [
			{"positions": [-1, 0.5], "velocities": [0, 0], "time_from_start": 0},
			{"positions": [1, 0.5], "velocities": [0, 0], "time_from_start": 4}]}})" );
	}

	Outcome audit( const std::string& constraints, std::vector<std::string> more = {} ) const
	{
		write( "q.yaml", "group_name: arm\nstart_state: {joint_state: {name: [shoulder, elbow], position: [-1, 0.5]}}\n"
		                 "goal_constraints:\n  - joint_constraints:\n      - {joint_name: shoulder, position: 1}\n"
		                 "      - {joint_name: elbow, position: 0.5}\npath_constraints:\n" +
		                     constraints );
		more.insert( more.end(), { "--trajectory", "t.json", "--request", "q.yaml" } );
		return runModel( "audit", more );
	}

	static std::string orientation( const std::string& tolerances, const std::string& more = "" )
	{
		return "  orientation_constraints:\n    - {link_name: tool, header: {frame_id: base}, orientation: [0, 0, 0, 1], " +
		       tolerances + more + "}\n";
	}
	static std::string joint( double below, double above )
	{
		return "  joint_constraints:\n    - {joint_name: shoulder, position: 0, tolerance_below: " +
		       std::to_string( below ) + ", tolerance_above: " + std::to_string( above ) + "}\n";
	}
	/// A box about the middle of the tool's circle: the tool is at sqrt( 0.32 + 0.32 cos( 0.5 ) ) = 0.7751 from the shoulder.
	static std::string box( double size )
	{
		const std::string text = std::to_string( size );
		return "  position_constraints:\n    - {link_name: tool, header: {frame_id: base}, constraint_region: {primitives: [{type: box, "
		       "dimensions: [" +
		       text + ", " + text + ", 0.01]}], primitive_poses: [{position: [0, 0, 0], orientation: [0, 0, 0, 1]}]}}\n";
	}
};

} // namespace

TEST_F( CliConstraints, AKeptConstraintIsCalledBroken )
{
	const std::string upright =
	    orientation( "absolute_x_axis_tolerance: 0.01, absolute_y_axis_tolerance: 0.01, absolute_z_axis_tolerance: 3.2" );
	const Outcome all = audit( upright + joint( 1.001, 1.001 ) + box( 1.5504 ), { "--report", "report.json" } );
	EXPECT_EQ( all.status, 0 ) << all.out << all.err;
	EXPECT_TRUE( contains( all.out, "kept at all times, proved" ) ) << all.out;
	const auto report = nlohmann::json::parse( readFile( path( "report.json" ) ) );
	ASSERT_EQ( 3u, report["path_constraints"].size() );
	EXPECT_EQ( "FREE", report["path_constraints"][2]["verdict"] );
}

TEST_F( CliConstraints, ABrokenConstraintIsCalledKept )
{
	const std::string turns =
	    "absolute_x_axis_tolerance: 0.01, absolute_y_axis_tolerance: 0.01, absolute_z_axis_tolerance: 1";
	for ( const char* kind : { ", parameterization: 0", ", parameterization: 1" } )
	{
		const Outcome turned = audit( orientation( turns, kind ), { "--report", "report.json" } );
		EXPECT_EQ( turned.status, 1 ) << turned.out << turned.err;
		EXPECT_TRUE( contains( turned.out, "turn z is 1.0" ) ) << turned.out;
		const auto report = nlohmann::json::parse( readFile( path( "report.json" ) ) )["path_constraints"][0];
		EXPECT_EQ( "BLOCKED", report["verdict"] );
		// shoulder at 0.5: -1 + 2 (3 u^2 - 2 u^3) = 0.5 at u = 0.6736
		EXPECT_NEAR( 4 * 0.6736, report["time"].get<double>(), 0.01 );
	}
	EXPECT_EQ( 1, audit( joint( 0.5, 2 ) ).status ); // it starts at -1
	EXPECT_EQ( 1, audit( joint( 2, 0.999 ) ).status );
	const Outcome out = audit( box( 1.55 ) );
	EXPECT_EQ( out.status, 1 );
	EXPECT_TRUE( contains( out.out, "position x" ) ) << out.out;
}

TEST_F( CliConstraints, AToleranceIsLeftOut )
{
	EXPECT_EQ( 0, audit( joint( 1.01, 1.01 ), { "--tolerance", "0.009" } ).status );
	const Outcome joints = audit( joint( 1.01, 1.01 ), { "--tolerance", "0.011" } );
	EXPECT_EQ( 1, joints.status );
	EXPECT_TRUE( contains( joints.out, "not proved" ) ) << joints.out;
	const std::string near =
	    orientation( "absolute_x_axis_tolerance: 3.2, absolute_y_axis_tolerance: 3.2, absolute_z_axis_tolerance: 1.51" );
	EXPECT_EQ( 0, audit( near, { "--tolerance", "0.004" } ).status ); // of both joints
	EXPECT_EQ( 1, audit( near, { "--tolerance", "0.006" } ).status );
}

TEST_F( CliConstraints, ConstraintsThatNoProofKnowsAreLeftOut )
{
	const struct
	{
		std::string constraints;
		const char* words;
	} cases[] = {
	    { box( 0 ), "leaves no room" },
	    { orientation( "absolute_x_axis_tolerance: 0" ), "leaves no room" },
	    { joint( 0, 0 ), "leave no room" },
	    { "  position_constraints:\n    - {link_name: tool, header: {frame_id: base}, constraint_region: {primitives: [{type: sphere, "
	      "dimensions: [1]}], primitive_poses: [{position: [0, 0, 0]}]}}\n",
	        "only one box" },
	    { "  joint_constraints:\n    - {joint_name: wrist, position: 0, tolerance_above: 1}\n", "wrist" },
	    { "  visibility_constraints:\n    - {target_pose: x}\n", "visibility_constraints" },
	};
	for ( const auto& wrong : cases )
	{
		const Outcome outcome = audit( wrong.constraints );
		EXPECT_EQ( outcome.status, 2 ) << wrong.words;
		EXPECT_TRUE( contains( outcome.err, wrong.words ) ) << "lacks '" << wrong.words << "': " << outcome.err;
		EXPECT_TRUE( contains( outcome.err, "path_constraints" ) ) << outcome.err;
	}
}

TEST_F( CliConstraints, APlannerLeavesThemOut )
{
	audit( joint( 2, 2 ) + box( 1.7 ) ); // writes the request
	const Outcome plan = runModel(
	    "plan", { "--request", "q.yaml", "--trajectory", "plan.json", "--report", "report.json" }, "blocked.yaml" );
	ASSERT_EQ( plan.status, 0 ) << plan.err;
	EXPECT_TRUE( contains( plan.out, "kept at all times, proved" ) ) << plan.out;
	const auto report = nlohmann::json::parse( readFile( path( "report.json" ) ) );
	EXPECT_TRUE( report["good"].get<bool>() );
	ASSERT_EQ( 2u, report["path_constraints"].size() );
	const Outcome again = runModel( "audit", { "--trajectory", "plan.json", "--request", "q.yaml" }, "blocked.yaml" );
	EXPECT_EQ( again.status, 0 ) << again.out << again.err;
	// A narrower box than the free plan keeps
	const Outcome narrow = runModel( "audit", { "--trajectory", "plan.json", "--request", "q.yaml", "--tolerance", "2" } );
	EXPECT_EQ( narrow.status, 1 );
}

TEST_F( CliConstraints, AStartThatBreaksThemIsPlannedFrom )
{
	audit( joint( 0.8, 1.2 ) ); // it starts at -1
	const Outcome broken = runModel( "plan", { "--request", "q.yaml", "--trajectory", "plan.json" } );
	EXPECT_EQ( broken.status, 2 );
	EXPECT_TRUE( contains( broken.err, "joint shoulder is -1, by 0.2 beyond its limit" ) ) << broken.err;
	EXPECT_TRUE( contains( broken.err, "--mend-start" ) ) << broken.err;
	const Outcome mended = runModel( "plan", { "--request", "q.yaml", "--trajectory", "plan.json", "--mend-start" } );
	EXPECT_EQ( mended.status, 0 ) << mended.err;
	EXPECT_TRUE( contains( mended.out, "the motion leads the start to the constraints" ) ) << mended.out;
	EXPECT_EQ( 1, runModel( "audit", { "--trajectory", "plan.json", "--request", "q.yaml" } ).status );
}

TEST_F( CliConstraints, GoalsAndOptionsThatCannotBeAreTaken )
{
	audit( joint( 1.2, 0.8 ) ); // the goal is 1
	const Outcome goal = runModel( "plan", { "--request", "q.yaml", "--trajectory", "plan.json" } );
	EXPECT_EQ( goal.status, 2 );
	EXPECT_TRUE( contains( goal.err, "goal_constraints" ) ) << goal.err;
	audit( joint( 2, 2 ) );
	for ( const std::vector<std::string>& more : { std::vector<std::string>{ "--out", "path.yaml" }, { "--planner", "RRT" },
	          { "--optimize", "1" }, { "--validator", "steps" } } )
	{
		std::vector<std::string> arguments = { "--request", "q.yaml" };
		arguments.insert( arguments.end(), more.begin(), more.end() );
		const Outcome outcome = runModel( "plan", arguments );
		EXPECT_EQ( outcome.status, 2 ) << more[0];
		EXPECT_TRUE( contains( outcome.err, more[0] ) ) << outcome.err;
	}
}

TEST_F( CliConstraints, AProvedPlanHasNoCertificateAndNoPage )
{
	audit( joint( 2, 2 ) + box( 1.7 ) ); // writes the request
	std::vector<std::string> arguments = { "--request", "q.yaml", "--trajectory", "plan.json", "--certificate", "plan.lwc" };
#ifdef LEEWAY_HAS_VIEW
	arguments.insert( arguments.end(), { "--view", "plan.html" } );
#endif
	const Outcome plan = runModel( "plan", arguments, "blocked.yaml" );
	ASSERT_EQ( plan.status, 0 ) << plan.err;
	EXPECT_TRUE( contains( plan.out, "path_constraints are no part of it" ) ) << plan.out;
	EXPECT_FALSE( readFile( path( "plan.lwc" ) ).empty() );
#ifdef LEEWAY_HAS_VIEW
	EXPECT_TRUE( contains( readFile( path( "plan.html" ) ), "kept at all times, proved" ) );
#endif
}

TEST_F( CliConstraints, AGoalWhereTheRobotStandsHasNoPlan )
{
	write( "q.yaml", "group_name: arm\nstart_state: {joint_state: {name: [shoulder, elbow], position: [-1, 0.5]}}\n"
	                 "goal_constraints:\n  - joint_constraints:\n      - {joint_name: shoulder, position: -1}\n"
	                 "      - {joint_name: elbow, position: 0.5}\npath_constraints:\n" +
	                     joint( 1.1, 1.1 ) );
	const Outcome plan =
	    runModel( "plan", { "--request", "q.yaml", "--trajectory", "plan.json", "--report", "report.json" } );
	ASSERT_EQ( 0, plan.status ) << plan.out << plan.err;
	EXPECT_TRUE( contains( plan.out, "kept at all times, proved" ) ) << plan.out;
	const auto report = nlohmann::json::parse( readFile( path( "report.json" ) ) );
	EXPECT_EQ( 0, report["duration"] ) << report.dump();
	const auto points = nlohmann::json::parse( readFile( path( "plan.json" ) ) )["joint_trajectory"]["points"];
	ASSERT_EQ( 1u, points.size() );
	EXPECT_EQ( ( std::vector<double>{ -1, 0.5 } ), points[0]["positions"].get<std::vector<double>>() );
}
