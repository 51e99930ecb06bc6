// SPDX-License-Identifier: BSD-3-Clause
// leeway spherize: the files it writes say the same, enclose the links, and can be read again.
#include "cli_fixture.hpp"

#include <nlohmann/json.hpp>
#include <yaml-cpp/yaml.h>

#include <cmath>
#include <filesystem>
#include <sstream>

namespace
{

using Spheres = std::vector<std::array<double, 4>>;

std::map<std::string, Spheres> fromYaml( const std::string& text )
{
	std::map<std::string, Spheres> out;
	for ( const auto& link : YAML::Load( text )["collision_spheres"] )
	{
		for ( const YAML::Node& s : link.second )
		{
			out[link.first.as<std::string>()].push_back( { s["center"][0].as<double>(), s["center"][1].as<double>(),
			    s["center"][2].as<double>(), s["radius"].as<double>() } );
		}
	}
	return out;
}

// The spheres between an element's start and end, in documents as the program writes them: each begins with `element`, its
// centre is the attribute `center`, its radius the next `radius`.
Spheres fromXml( const std::string& text, const std::string& start, const std::string& end, const std::string& element,
    const std::string& center )
{
	Spheres out;
	const std::size_t from = text.find( start );
	EXPECT_NE( from, std::string::npos ) << start;
	const std::string part = text.substr( from, text.find( end, from ) - from );
	for ( std::size_t at = part.find( element ); at != std::string::npos; at = part.find( element, at + 1 ) )
	{
		std::istringstream xyz( part.substr( part.find( center + "=\"", at ) + center.size() + 2 ) );
		std::array<double, 4> sphere{};
		xyz >> sphere[0] >> sphere[1] >> sphere[2];
		sphere[3] = std::stod( part.substr( part.find( "radius=\"", at ) + 8 ) );
		out.push_back( sphere );
	}
	return out;
}

bool inside( const Spheres& spheres, double x, double y, double z )
{
	for ( const auto& s : spheres )
	{
		if ( std::hypot( x - s[0], y - s[1], z - s[2] ) <= s[3] )
		{
			return true;
		}
	}
	return false;
}

} // namespace

TEST_F( Cli, SpheresOfTheFilesDifferOrMissPoints )
{
	const Outcome result =
	    run( { "spherize", "--robot", "arm.urdf", "--srdf", "arm.srdf", "--excess", "15", "--out", "out" } );
	ASSERT_EQ( result.status, 0 ) << result.err;
	const std::map<std::string, Spheres> links = fromYaml( readFile( path( "out/arm_spheres.yml" ) ) );
	ASSERT_EQ( links.size(), 3u );
	const std::string urdf = readFile( path( "out/arm_spheres.urdf" ) ), srdf = readFile( path( "out/arm_spheres.srdf" ) );
	for ( const auto& [name, spheres] : links )
	{
		EXPECT_EQ( fromXml( urdf, "<link name=\"" + name + "\"", "</link>", "<collision", "xyz" ), spheres );
		EXPECT_EQ( fromXml( srdf, "<link_sphere_approximation link=\"" + name + "\"", "</link_sphere_approximation>",
		               "<sphere ", "center" ),
		    spheres );
	}
	// the boxes of `base` and `upper` are solids: their inside must be covered as well
	for ( int i = 0; i <= 40; ++i )
	{
		for ( int j = 0; j <= 10; ++j )
		{
			for ( int k = 0; k <= 10; ++k )
			{
				EXPECT_TRUE( inside( links.at( "upper" ), 0.01 * i, -0.025 + 0.005 * j, -0.025 + 0.005 * k ) );
				EXPECT_TRUE( inside( links.at( "base" ), -0.1 + 0.005 * i, -0.1 + 0.02 * j, -0.25 + 0.01 * k ) );
			}
		}
	}
	const nlohmann::json report = nlohmann::json::parse( readFile( path( "out/arm_spheres.json" ) ) );
	for ( const auto& link : report["links"] )
	{
		EXPECT_LE( link["excess"].get<double>(), 0.015 );
		EXPECT_GT( link["excess"].get<double>(), 0.005 );
		EXPECT_TRUE( link["encloses"].get<bool>() );
		EXPECT_TRUE( contains( result.out, link["link"].get<std::string>() ) );
	}
	EXPECT_TRUE( contains( srdf, "<disable_collisions link1=\"base\" link2=\"upper\" reason=\"Adjacent\"" ) );

	// the new robot is read again, and it is nearer to the wall than the old one by the excess at most
	write( "zero.csv", "shoulder,elbow\n0,0\n" );
	const std::vector<std::string> more = {
	    "--scene", "scene.yaml", "--group", "arm", "--states", "zero.csv", "--what", "env" };
	std::vector<std::string> arguments = { "check", "--robot", "out/arm_spheres.urdf", "--srdf", "out/arm_spheres.srdf" };
	arguments.insert( arguments.end(), more.begin(), more.end() );
	const Outcome check = run( arguments );
	ASSERT_EQ( check.status, 0 ) << check.err;
	const double clearance = parseTable( check.out ).number( 0, "env_lower" );
	EXPECT_LT( clearance, 0.1 );
	EXPECT_GE( clearance, 0.1 - 0.015 );

	// and so is the SRDF: spherizing twice replaces the elements of the first time
	const Outcome again =
	    run( { "spherize", "--robot", "arm.urdf", "--srdf", "out/arm_spheres.srdf", "--excess", "30", "--out", "." } );
	ASSERT_EQ( again.status, 0 ) << again.err;
	const std::string twice = readFile( path( "arm_spheres.srdf" ) );
	EXPECT_EQ( fromXml( twice, "<robot", "</robot>", "<sphere ", "center" ).size(),
	    nlohmann::json::parse( readFile( path( "arm_spheres.json" ) ) )["spheres"].get<std::size_t>() );
}

TEST_F( Cli, NumberOfSpheresIsExceeded )
{
	double before = 1e9;
	for ( const char* number : { "3", "9", "40" } )
	{
		const Outcome result = run( { "spherize", "--robot", "arm.urdf", "--spheres", number, "--out", "out" } );
		ASSERT_EQ( result.status, 0 ) << result.err;
		const nlohmann::json report = nlohmann::json::parse( readFile( path( "out/arm_spheres.json" ) ) );
		EXPECT_LE( report["spheres"].get<int>(), std::stoi( number ) );
		EXPECT_LT( report["excess"].get<double>(), before );
		before = report["excess"].get<double>();
		EXPECT_TRUE( contains( readFile( path( "out/arm_spheres.srdf" ) ), "<robot name=\"planar_arm\">" ) );
	}
}

TEST_F( Cli, SpherizeWritesNothingWhenTimeEnds )
{
	const Outcome result =
	    run( { "spherize", "--robot", "arm.urdf", "--excess", "0.5", "--time", "0.000001", "--out", "deep/er" } );
	ASSERT_EQ( result.status, 0 ) << result.err;
	EXPECT_TRUE( contains( result.err, "--time" ) ) << result.err;
	const nlohmann::json report = nlohmann::json::parse( readFile( path( "deep/er/arm_spheres.json" ) ) );
	for ( const auto& link : report["links"] )
	{
		EXPECT_TRUE( link["encloses"].get<bool>() );
		EXPECT_FALSE( link["met_target"].get<bool>() );
		EXPECT_GT( link["excess"].get<double>(), 0.0005 );
	}
	EXPECT_EQ( fromYaml( readFile( path( "deep/er/arm_spheres.yml" ) ) ).size(), 3u );
}

TEST_F( Cli, SpherizeTakesNonsense )
{
	const auto fails = [&]( std::vector<std::string> arguments, const std::string& word )
	{
		arguments.insert( arguments.begin(), { "spherize", "--robot", "arm.urdf" } );
		const Outcome result = run( arguments );
		EXPECT_EQ( result.status, 2 ) << word;
		EXPECT_TRUE( contains( result.err, word ) ) << result.err;
		EXPECT_FALSE( contains( result.out, "written" ) );
	};
	fails( { "--out", "out" }, "--excess" );
	fails( { "--out", "out", "--excess", "10", "--spheres", "5" }, "excludes" );
	fails( { "--out", "out", "--excess", "0" }, "--excess" );
	fails( { "--out", "out", "--excess", "0.005" }, "below" );
	fails( { "--out", "out", "--excess", "nan" }, "--excess" );
	fails( { "--out", "out", "--spheres", "0" }, "--spheres" );
	fails( { "--out", "out", "--spheres", "2" }, "3 or more" );
	fails( { "--out", "out", "--excess", "10", "--close-holes", "-1" }, "--close-holes" );
	fails( { "--out", "arm.srdf", "--excess", "10" }, "arm.srdf" );
	fails( { "--excess", "10" }, "--out" );
	fails( { "--out", "out", "--excess", "10", "--time", "0" }, "--time" );
	fails( { "--out", "new/folder", "--excess", "0.005" }, "below" );
	EXPECT_FALSE( std::filesystem::exists( path( "new" ) ) ) << "an empty folder is left";
}
