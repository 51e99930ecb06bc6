// SPDX-License-Identifier: BSD-3-Clause
// leeway view: options, and the data of the page. The page itself is tested in a browser (tests/view).
#include "cli_fixture.hpp"

#include <nlohmann/json.hpp>

#include <cmath>

class CliView : public Cli
{
protected:
	Outcome view( std::vector<std::string> more, const std::string& scene = "scene.yaml" ) const
	{
		return runModel( "view", more, scene );
	}
	/// The JSON of a page.
	nlohmann::json model( const std::string& page ) const
	{
		const std::string text = readFile( path( page ) ), begin = "<script type=\"application/json\" id=\"model\">";
		const std::size_t at = text.find( begin ) + begin.size();
		return nlohmann::json::parse( text.substr( at, text.find( "</script>", at ) - at ) );
	}
};

#if !defined( LEEWAY_HAS_VIEW )

TEST_F( CliView, TheMissingToolsAreNamed )
{
	const Outcome outcome = view( { "--out", "page.html" } );
	EXPECT_EQ( outcome.status, 2 );
	EXPECT_TRUE( contains( outcome.err, "LEEWAY_BUILD_VIEW=ON" ) ) << outcome.err;
	EXPECT_EQ( readFile( path( "page.html" ) ), "" );
}

#else

TEST_F( CliView, UnusableOptionsAreNamedWithTheirRemedy )
{
	const std::vector<std::pair<std::vector<std::string>, std::string>> wrong = {
	    { {}, "--out: is missing; give --out page.html" },
	    { { "--out", "p.html", "--camera", "1,2" }, "--camera: is about a picture" },
	    { { "--png", "p.png", "--camera", "1" }, "--camera: 1 has not two or three numbers" },
	    { { "--png", "p.png", "--camera", "1,two" }, "--camera: 1,two is no list of numbers" },
	    { { "--png", "p.png", "--camera", "1,2,3,4" }, "has not two or three numbers" },
	    { { "--png", "p.png", "--at", "soon" }, "--at: soon is no number" },
	    { { "--png", "p.png", "--width", "3" }, "--width: 3 is not between" },
	    { { "--out", "p.html", "--triangles", "0" }, "--triangles: 0 is not" },
	    { { "--out", "p.html", "--path", "none.yaml" }, "none.yaml" },
	    { { "--out", "p.html", "--path", "a", "--states", "b" }, "excludes" },
	    { { "--out", "arm.urdf" }, "arm.urdf" },
	};
	for ( const auto& [arguments, message] : wrong )
	{
		const Outcome outcome = view( arguments );
		EXPECT_EQ( outcome.status, 2 ) << message;
		EXPECT_TRUE( contains( outcome.err, message ) ) << outcome.err << message;
		EXPECT_EQ( readFile( path( "p.html" ) ), "" );
	}
}

TEST_F( CliView, TheSmallestClearanceOfAMotionIsFoundBetweenItsSteps )
{
	// The straight way passes the post: its smallest clearance is in the middle, and between two of the equal steps
	write( "t.csv", "time,shoulder,elbow\n0,-0.5003,0\n1,-0.3,0\n2.3,-0.5,0\n" );
	ASSERT_EQ( view( { "--trajectory", "t.csv", "--out", "page.html" }, "blocked.yaml" ).status, 0 );
	const nlohmann::json motion = model( "page.html" )["motion"];
	EXPECT_EQ( motion["unit"], "seconds" );
	const nlohmann::json least = motion["steps"][motion["least"].get<std::size_t>()];
	EXPECT_NEAR( least["at"].get<double>(), 1, 1e-3 );
	EXPECT_EQ( motion["steps"].back()["at"], 2.3 );
	double smallest = HUGE_VAL;
	for ( const nlohmann::json& step : motion["steps"] )
	{
		smallest = std::min( smallest, step["environment"][0].get<double>() );
	}
	EXPECT_EQ( least["environment"][0], smallest );
}

TEST_F( CliView, PairsThatKeepTheirDistanceAreSetApartFromTheSmallestClearance )
{
	// Without its SRDF's pairs: the upper arm turns over the base, 125 mm above it, nearer than all other links
	std::string open = readFile( path( "arm.srdf" ) );
	open.erase( open.find( "<disable_collisions link1=\"base\"" ),
	    open.find( "<disable_collisions link1=\"upper\"" ) - open.find( "<disable_collisions link1=\"base\"" ) );
	write( "open.srdf", open );
	write( "t.csv", "time,shoulder,elbow\n0,-0.5,0\n1,-0.3,0.9\n2,-0.5,2.6\n" );
	const auto page = [&]( const std::string& srdf, const std::vector<std::string>& more )
	{
		std::vector<std::string> arguments = {
		    "view", "--robot", "arm.urdf", "--srdf", srdf, "--trajectory", "t.csv", "--out", "page.html" };
		arguments.insert( arguments.end(), more.begin(), more.end() );
		const Outcome outcome = run( arguments );
		EXPECT_EQ( outcome.status, 0 ) << outcome.err;
		return model( "page.html" )["motion"];
	};
	const nlohmann::json motion = page( "open.srdf", {} );
	ASSERT_EQ( motion["apart"].size(), 1U ) << motion["apart"];
	EXPECT_EQ( motion["apart"][0]["self"], 1 );
	EXPECT_NEAR( motion["apart"][0]["least"].get<double>(), 0.125, 1e-9 );
	EXPECT_NEAR( motion["apart"][0]["most"].get<double>(), 0.125, 1e-9 );
	const nlohmann::json least = motion["steps"][motion["least"].get<std::size_t>()];
	EXPECT_NEAR( least["self"][0].get<double>(), 0.125, 1e-9 ) << "the state's own answer is whole";
	// The same with the SRDF that allows this pair: independent of how the page leaves it out
	const nlohmann::json allowed = page( "arm.srdf", {} );
	EXPECT_NEAR( least["others"]["self"][0].get<double>(),
	    allowed["steps"][allowed["least"].get<std::size_t>()]["self"][0].get<double>(), 1e-9 );
	EXPECT_EQ( page( "open.srdf", { "--min-d", "0.2" } )["apart"].size(), 0U )
	    << "a pair that is too near is never set apart";
}

TEST_F( CliView, TheWayToALateFirstPointIsNotShown )
{
	const std::string late = R"({"joint_names": ["shoulder", "elbow"], "points": [
		{"positions": [-0.4, 0.1], "time_from_start": {"sec": 1}}, {"positions": [-0.5, 0.1], "time_from_start": {"sec": 3}}]})";
	write( "t.json", R"({"trajectory_start": {"joint_state": {"name": ["shoulder", "elbow"], "position": [0.3, 0]}},
		"trajectory": [{"joint_trajectory": )" +
	                     late + "}]}" );
	ASSERT_EQ( view( { "--trajectory", "t.json", "--out", "page.html" } ).status, 0 );
	const nlohmann::json motion = model( "page.html" )["motion"];
	EXPECT_EQ( motion["steps"].front()["q"], nlohmann::json::parse( "[0.3, 0.0]" ) );
	EXPECT_EQ( motion["steps"].back()["at"], 3 );
	write( "late.json", late );
	const Outcome outcome = view( { "--trajectory", "late.json", "--out", "late.html" } );
	ASSERT_EQ( outcome.status, 0 ) << outcome.err;
	for ( const std::string& text : { outcome.err, readFile( path( "late.html" ) ) } )
	{
		EXPECT_TRUE( contains( text, "the first point comes after 1 s" ) );
	}
}

TEST_F( CliView, APageListsItsSimplifiedMeshes )
{
	ASSERT_EQ( view( { "--triangles", "8", "--out", "coarse.html" } ).status, 0 );
	ASSERT_EQ( view( { "--out", "whole.html", "--stored" } ).status, 0 );
	EXPECT_TRUE( contains( model( "coarse.html" )["omitted"].dump(), "link fore: " ) ) << model( "coarse.html" )["omitted"];
	EXPECT_TRUE( contains( model( "coarse.html" )["omitted"].dump(), "of 12 triangles are shown" ) )
	    << model( "coarse.html" )["omitted"];
	EXPECT_FALSE( contains( model( "whole.html" )["omitted"].dump(), "triangles are shown" ) )
	    << model( "whole.html" )["omitted"];
	EXPECT_LT( readFile( path( "whole.html" ) ).size(), readFile( path( "coarse.html" ) ).size() )
	    << "no engine data in a stored page";
}

TEST_F( CliView, APageListsPlanesThatItCannotDrawWhole )
{
	write( "plane.yaml",
	    "name: plane\nworld:\n  collision_objects:\n    - id: ground\n      planes: [{coef: [0, 0, 1, 3]}]\n      plane_poses: [{position: [0, 0, 0]}]\n" );
	ASSERT_EQ( view( { "--out", "page.html" }, "plane.yaml" ).status, 0 );
	EXPECT_EQ( model( "page.html" )["omitted"][0], "object ground: it has no end; a square of 20 m is drawn" );
	EXPECT_EQ( model( "page.html" )["shapes"].back()["levels"].size(), 0U ) << "no sphere contains it";
}

TEST_F( CliView, EverySubcommandWritesAPageOfItsResult )
{
	const Outcome plan = runModel( "plan", { "--start", "shoulder=-0.6", "--goal", "shoulder=-0.2", "--out", "path.yaml",
	                                           "--trajectory", "t.yaml", "--view", "plan.html" } );
	ASSERT_EQ( plan.status, 0 ) << plan.err;
	EXPECT_EQ( model( "plan.html" )["motion"]["unit"], "share" );
	ASSERT_EQ( runModel( "audit", { "--path", "path.yaml", "--view", "audit.html" } ).status, 0 );
	EXPECT_EQ( model( "audit.html" )["motion"], model( "plan.html" )["motion"].patch( nlohmann::json::parse(
	                                                R"([{"op": "replace", "path": "/source", "value": "path.yaml"}])" ) ) );
	ASSERT_EQ( runModel( "audit", { "--trajectory", "t.yaml", "--view", "timed.html" } ).status, 0 );
	EXPECT_EQ( model( "timed.html" )["motion"]["unit"], "seconds" );
	const auto with = [&]( const std::string& command, std::vector<std::string> more )
	{
		more.insert( more.begin(), { command, "--robot", "arm.urdf", "--srdf", "arm.srdf" } );
		return run( more );
	};
	ASSERT_EQ( with( "spherize", { "--excess", "30", "--out", "spheres", "--view", "spheres.html" } ).status, 0 );
	EXPECT_EQ( model( "spheres.html" )["spheres"].size(), 3U );
	ASSERT_EQ(
	    with( "tune", { "--scene", "scene.yaml", "--states", "20", "--edges", "5", "--view", "tune.html" } ).status, 0 );
	EXPECT_EQ( model( "tune.html" )["motion"]["steps"].size(), 20U );
	EXPECT_NE( with( "pairs", { "--budget", "0", "--view", "pairs.html" } ).status, 2 );
	EXPECT_EQ( model( "pairs.html" )["what"], 2 ) << "links against links";
	write( "steps.yaml", "steps:\n- trajectory: t.yaml\n" );
	ASSERT_EQ( runModel( "audit", { "--steps", "steps.yaml", "--view", "steps.html" } ).status, 0 );
	EXPECT_EQ( model( "steps.html" )["motion"]["steps"], model( "timed.html" )["motion"]["steps"] );
}

TEST_F( CliView, OneOfSeveralPathsIsLostOrItsPairsAreSetApart )
{
	const auto path_to = [&]( const std::string& name, const std::string& end ) {
		write(
		    name, "joint_names: [shoulder, elbow]\npoints:\n  - positions: [-0.6, 0]\n  - positions: [" + end + ", 0]\n" );
	};
	path_to( "short.yaml", "-0.3" );
	path_to( "long.yaml", "0.2" );
	ASSERT_EQ( view( { "--path", "short.yaml", "--path", "long.yaml", "--out", "page.html" } ).status, 0 );
	const nlohmann::json page = model( "page.html" );
	ASSERT_EQ( page["more"].size(), 1U );
	EXPECT_NEAR( page["motion"]["length"].get<double>(), 0.3, 1e-9 );
	EXPECT_NEAR( page["more"][0]["length"].get<double>(), 0.8, 1e-9 );
	EXPECT_EQ( page["motion"]["source"], "short.yaml" );
	EXPECT_EQ( page["more"][0]["source"], "long.yaml" );
	EXPECT_NEAR( page["more"][0]["steps"].back()["q"][0].get<double>(), 0.2, 1e-12 );
	EXPECT_TRUE( page["motion"]["apart"].empty() && page["more"][0]["apart"].empty() );
}

TEST_F( CliView, StatesThatMoveOtherJointsAreRefused )
{
	write( "states.csv", "shoulder,elbow\n0.1,0.2\n0.3,0.2\n0.3,0.4\n" );
	ASSERT_EQ( view( { "--states", "states.csv", "--out", "page.html" } ).status, 0 );
	EXPECT_EQ( model( "page.html" )["motion"]["steps"].size(), 3U );
	EXPECT_EQ( model( "page.html" )["motion"]["steps"][1]["q"][0], 0.3 );
	const Outcome outcome = view( { "--states", "states.csv", "--group", "shoulder_only", "--out", "other.html" } );
	EXPECT_EQ( outcome.status, 2 );
	EXPECT_TRUE( contains( outcome.err, "states.csv: line 4: moves a joint outside of the group" ) ) << outcome.err;
}

#endif
