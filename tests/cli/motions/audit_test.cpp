// SPDX-License-Identifier: BSD-3-Clause
// leeway audit --path: bounds between states, profiles and places, beside closed forms.
#include "cli_fixture.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <functional>

// leeway audit --path: bounds between states from motion that is measured here once more.
class CliAuditBounds : public Cli
{
protected:
	/// A base, and a link on one joint, along a path of two points or more. Returns the audit; samples are in p.csv.
	nlohmann::json audited( const std::string& joint, const std::string& path_text, const std::string& origin = "" )
	{
		const std::string box = "<collision>" + origin + "<geometry><box size='0.2 0.2 0.2'/></geometry></collision></link>";
		write( "two.urdf",
		    "<robot name='two'><link name='base'><collision><geometry><box size='0.2 0.2 0.2'/></geometry></collision></link>"
		    "<link name='cart'>" +
		        box + joint + "</robot>" );
		write( "p.yaml", path_text );
		const Outcome outcome = run(
		    { "audit", "--robot", "two.urdf", "--strict", "--path", "p.yaml", "--report", "r.json", "--profile", "p.csv" } );
		EXPECT_EQ( outcome.status, 0 ) << outcome.err;
		return nlohmann::json::parse( readFile( path( "r.json" ) ) )["audit"];
	}
	static std::string jointOf( const std::string& type, const std::string& axis, const std::string& origin )
	{
		return "<joint name='rail' type='" + type + "'><origin xyz='" + origin +
		       "'/><parent link='base'/><child link='cart'/><axis xyz='" + axis +
		       "'/><limit lower='0' upper='2' effort='1' velocity='1'/></joint>";
	}
	/// The least of half of two neighbours' clearances less twice the motion between them. @param moved of a step of t
	double expectedBetween( const std::function<double( double )>& moved ) const
	{
		const Table samples = parseTable( readFile( path( "p.csv" ) ) );
		double expected = 9;
		for ( std::size_t i = 1; i < samples.rows.size(); ++i )
		{
			const double step = samples.number( i, "t" ) - samples.number( i - 1, "t" );
			expected = std::min(
			    expected, ( samples.number( i - 1, "self" ) + samples.number( i, "self" ) - 2 * moved( step ) ) / 2 );
		}
		return expected;
	}
};

TEST_F( CliAuditBounds, BoundsBetweenStatesForgetAMotion )
{
	for ( const char* axis : { "1 0 0", "0 1 0", "0 0 1" } )
	{
		const nlohmann::json audit =
		    audited( jointOf( "prismatic", axis, "0 0 0" ), "joint_names: [rail]\npoints: [[1], [0.3]]\n" );
		EXPECT_NEAR( audit["self"]["between_states"].get<double>(),
		    expectedBetween( []( double step ) { return 1.001 * 0.7 * step; } ), 1e-9 )
		    << axis;
	}
}

TEST_F( CliAuditBounds, BoundsOfTheSceneForgetTheStateBefore )
{
	// towards the wall at x = 0.9, which stands still: the motion counts once
	audited( jointOf( "prismatic", "1 0 0", "0 0 0" ), "joint_names: [rail]\npoints: [[0.3], [0.75]]\n" );
	const Outcome outcome = run( { "audit", "--robot", "two.urdf", "--scene", "scene.yaml", "--strict", "--path", "p.yaml",
	    "--report", "r.json", "--profile", "p.csv" } );
	ASSERT_EQ( outcome.status, 0 ) << outcome.err;
	const Table samples = parseTable( readFile( path( "p.csv" ) ) );
	double expected = 9;
	for ( std::size_t i = 1; i < samples.rows.size(); ++i )
	{
		const double moved = 1.001 * 0.45 * ( samples.number( i, "t" ) - samples.number( i - 1, "t" ) );
		expected = std::min(
		    expected, ( samples.number( i - 1, "environment" ) + samples.number( i, "environment" ) - moved ) / 2 );
	}
	const nlohmann::json audit = nlohmann::json::parse( readFile( path( "r.json" ) ) )["audit"];
	EXPECT_NEAR( audit["environment"]["between_states"].get<double>(), expected, 1e-9 );
}

TEST_F( CliAuditBounds, BoundsBetweenStatesForgetATurn )
{
	// a cube that turns about its middle: its corners, 0.1 sqrt( 3 ) away, move by the chord, its middle not at all
	const nlohmann::json audit =
	    audited( jointOf( "revolute", "0 0 1", "0.5 0 0" ), "joint_names: [rail]\npoints: [[0], [1]]\n" );
	const double radius = 0.1 * std::sqrt( 3.0 );
	const double expected = expectedBetween( [&]( double step ) { return 2 * radius * std::sin( step / 2 ); } );
	EXPECT_LE( audit["self"]["between_states"].get<double>(), expected + 1e-9 );
	EXPECT_GE( audit["self"]["between_states"].get<double>(), expected - 0.01 * radius );
}

TEST_F( CliAuditBounds, ProfilesAndPlacesAreOfAnotherPart )
{
	const nlohmann::json audit =
	    audited( jointOf( "prismatic", "1 0 0", "0 0 0" ), "joint_names: [rail]\npoints: [[1], [0.4], [0.9]]\n" );
	double least = 9;
	for ( const nlohmann::json& part : audit["profile"] )
	{
		least = part["self"].is_number() ? std::min( least, part["self"].get<double>() ) : least;
	}
	EXPECT_NEAR( least, audit["self"]["upper"].get<double>(), 1e-9 );
	EXPECT_NEAR( audit["self"]["s"].get<double>(), 0.6 / 1.1, 1e-9 );
	const Table samples = parseTable( readFile( path( "p.csv" ) ) );
	for ( std::size_t i = 1; i < samples.rows.size(); ++i )
	{
		ASSERT_GE( samples.number( i, "s" ), samples.number( i - 1, "s" ) );
	}
	EXPECT_NEAR( samples.number( samples.rows.size() - 1, "s" ), 1, 1e-12 );
}
