// SPDX-License-Identifier: BSD-3-Clause
// leeway audit --corridor: the widest tolerances of a trajectory, as a goal of its controller.
#include "cli_fixture.hpp"

#include <nlohmann/json.hpp>

class CliCorridor : public Cli
{
protected:
	Outcome audit( std::vector<std::string> more ) const
	{
		more.insert( more.begin(), { "--trajectory", "t.csv" } );
		return runModel( "audit", more, "blocked.yaml" );
	}
};

TEST_F( CliCorridor, AJointMayLeaveItOrCouldBeProvedFarther )
{
	write( "t.csv",
	    "time,shoulder,elbow,velocity:shoulder,velocity:elbow\n0,-0.5,0,0,0\n1,-0.3,0.4,0.1,0.2\n2,-0.5,0.6,0,0\n" );
	const Outcome outcome = audit( { "--corridor", "goal.json" } );
	ASSERT_EQ( outcome.status, 0 ) << outcome.err;
	EXPECT_TRUE( contains( outcome.out, "corridor    proved " ) ) << outcome.out;
	const nlohmann::json goal = nlohmann::json::parse( readFile( path( "goal.json" ) ) );
	ASSERT_EQ( goal["path_tolerance"].size(), 2U );
	EXPECT_EQ( goal["trajectory"]["points"][1]["velocities"], nlohmann::json::parse( "[0.1, 0.2]" ) );
	const Outcome again = runModel( "audit", { "--trajectory", "goal.json" }, "blocked.yaml" );
	EXPECT_EQ( again.status, 0 ) << "the corridor is not proved: " << again.out << again.err;
	for ( const nlohmann::json& one : goal["path_tolerance"] )
	{
		const double width = one["position"];
		EXPECT_GT( width, 1e-3 );
		ASSERT_LT( width, 0.5 ) << "the post is not in the way";
		const Outcome wider = runModel( "audit",
		    { "--trajectory", "goal.json", "--tolerance",
		        one["name"].get<std::string>() + "=" + std::to_string( 1.1 * width ) },
		    "blocked.yaml" );
		EXPECT_EQ( wider.status, 1 ) << one << " could be wider";
	}
}

TEST_F( CliCorridor, UnusableQuestionsAreAnswered )
{
	write( "t.csv", "time,shoulder,elbow\n0,-0.5,0\n1,-0.3,0.4\n" );
	write( "path.yaml", "joint_names: [shoulder, elbow]\npoints:\n  - positions: [0, 0]\n  - positions: [0.1, 0]\n" );
	const Outcome of_path = runModel( "audit", { "--path", "path.yaml", "--corridor", "goal.json" } );
	EXPECT_EQ( of_path.status, 2 );
	EXPECT_TRUE( contains( of_path.err, "--corridor: is about one timed trajectory; give it by --trajectory" ) )
	    << of_path.err;
	// In contact: there is no corridor
	write( "t.csv", "time,shoulder,elbow\n0,-0.5,0\n1,0.8,0.4\n" );
	const Outcome blocked = audit( { "--corridor", "goal.json" } );
	EXPECT_EQ( blocked.status, 1 ) << blocked.out;
	EXPECT_EQ( readFile( path( "goal.json" ) ), "" );
}
