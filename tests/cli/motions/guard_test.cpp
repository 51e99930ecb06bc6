// SPDX-License-Identifier: BSD-3-Clause
// leeway guard: recorded drives of the arm, whose shoulder turns from -0.6 to 0.6 in 2 s, and a post that comes into its way.
#include "cli_fixture.hpp"

#include <nlohmann/json.hpp>

#include <array>
#include <cmath>

namespace
{

class CliGuard : public Cli
{
protected:
	void SetUp() override
	{
		Cli::SetUp();
		write( "t.csv", "time,shoulder,elbow\n0,-0.6,0\n2,0.6,0\n" );
	}
	Outcome guard( const std::string& log, const std::vector<std::string>& more = {} )
	{
		write( "log.jsonl", log );
		std::vector<std::string> all = {
		    "--trajectory", "t.csv", "--replay", "log.jsonl", "--rate", "100", "--json", "r.json", "--profile", "r.csv" };
		all.insert( all.end(), more.begin(), more.end() );
		const Outcome outcome = runModel( "guard", all );
		report = outcome.status == 2 ? nlohmann::json() : nlohmann::json::parse( readFile( path( "r.json" ) ) );
		profile = outcome.status == 2 ? Table() : parseTable( readFile( path( "r.csv" ) ) );
		return outcome;
	}
	/// An object of the log: a box of 0.1 m whose middle is there.
	static std::string box( double x, double y, const std::string& id = "post" )
	{
		return R"({"id": ")" + id +
		       R"(", "primitives": [{"type": "box", "dimensions": [0.1, 0.1, 1]}], "primitive_poses": [{"position": [)" +
		       std::to_string( x ) + ", " + std::to_string( y ) + R"(, 0], "orientation": [0, 0, 0, 1]}]})";
	}
	static std::string line( double t, const std::string& kind, const std::string& objects, double seen )
	{
		return "{\"t\": " + std::to_string( t ) + ", \"seen\": " + std::to_string( seen ) + ", \"" + kind +
		       "\": {\"collision_objects\": [" + objects + "]}}\n";
	}
	/// Three points as NumPy's array.
	void writePoints( const std::string& name, const std::array<float, 9>& points ) const
	{
		std::string header = "{'descr': '<f4', 'fortran_order': False, 'shape': (3, 3), }";
		header += std::string( 63 - ( 10 + header.size() ) % 64, ' ' ) + "\n";
		write( name, std::string( "\x93NUMPY\x01\x00", 8 ) + static_cast<char>( header.size() ) + std::string( 1, '\0' ) +
		                 header + std::string( reinterpret_cast<const char*>( points.data() ), sizeof( points ) ) );
	}
	std::string verdict( double time ) const
	{
		return profile.rows.at( static_cast<std::size_t>( std::lround( 100 * time ) ) ).at( "verdict" );
	}
	nlohmann::json report;
	Table profile;
};

} // namespace

TEST_F( CliGuard, AnObjectThatComesIsSeenTooLate )
{
	const Outcome outcome = guard( line( 0.5, "world", box( 0.6, 0.3 ), 0.45 ) + "\n" +
	                                   line( 1.5, "world", R"({"id": "post", "operation": "REMOVE"})", 1.5 ),
	    { "--deceleration", "4", "--reaction", "0.05" } );
	EXPECT_EQ( outcome.status, 1 ) << outcome.err;
	EXPECT_EQ( verdict( 0.49 ), "FREE" );
	EXPECT_EQ( verdict( 0.5 ), "BLOCKED" );
	EXPECT_EQ( verdict( 1.49 ), "BLOCKED" );
	EXPECT_EQ( verdict( 1.5 ), "FREE" );
	EXPECT_EQ( profile.rows.size(), 201u );
	const nlohmann::json alarm = report["alarm"];
	EXPECT_EQ( alarm["at"], 0.5 );
	EXPECT_EQ( alarm["verdict"], "BLOCKED" );
	EXPECT_TRUE( contains( alarm["pair"].dump(), "post" ) ) << alarm;
	// the arm's edge, 0.05 m beside its middle, meets the post's corner between its middle's angles: some 0.25 rad below that of the post
	const double contact = alarm["time"], brake = alarm["brake_by"];
	EXPECT_GT( contact, 1 );
	EXPECT_LT( contact, 2 );
	// from 0.6 rad/s with 4 rad/s^2 it stands after 0.15 s, 0.045 rad farther, and goes on for 0.05 s before: 0.125 s before the contact
	EXPECT_LE( brake, contact - 0.125 + 1e-3 );
	EXPECT_GE( brake, contact - 0.125 - 0.02 );
	EXPECT_EQ( profile.rows.front().at( "stands" ).substr( 0, 3 ), "0.2" );
}

// A controller that begins to move a second after the trajectory's time 0.
TEST_F( CliGuard, TheClockIsNotThatOfTheTrajectory )
{
	guard( line( 0, "world", box( 0.6, 0.3 ), 0 ) );
	const double contact = report["alarm"]["time"];
	write( "t.csv", "time,shoulder,elbow\n1,-0.6,0\n3,0.6,0\n" );
	guard( line( 0, "world", box( 0.6, 0.3 ), 0 ) );
	EXPECT_NEAR( report["alarm"]["time"].get<double>(), contact + 1, 2e-3 );
	EXPECT_EQ( profile.rows.front().at( "time" ), "1" );
}

TEST_F( CliGuard, AWorldThatIsUnknownReadsAsFree )
{
	EXPECT_EQ( guard( "" ).status, 0 );
	EXPECT_TRUE( report["alarm"].is_null() );
	// an object that nobody has
	EXPECT_EQ( guard( line( 0.5, "world", R"({"id": "nobody", "operation": 1})", 0.5 ) + "{\"t\": 0.7}\n" +
	                  line( 1, "world", box( 5, 5, "nobody" ), 1 ) )
	               .status,
	    1 );
	EXPECT_EQ( verdict( 0.49 ), "FREE" );
	EXPECT_EQ( verdict( 0.5 ), "UNDECIDED" );
	EXPECT_EQ( verdict( 0.99 ), "UNDECIDED" ) << "the look at 0.7 s says nothing of the change that was lost";
	EXPECT_EQ( verdict( 1 ), "FREE" );
	EXPECT_TRUE( contains( report["rejected"].dump(), "line 1" ) && contains( report["rejected"].dump(), "nobody" ) )
	    << report;
	// a sensor that fell silent
	EXPECT_EQ( guard( "{\"t\": 0, \"seen\": -0.05}\n{\"t\": 0.3}\n", { "--stale", "0.2" } ).status, 1 );
	EXPECT_EQ( verdict( 0.14 ), "FREE" );
	EXPECT_EQ( verdict( 0.17 ), "UNDECIDED" );
	EXPECT_EQ( verdict( 0.45 ), "FREE" );
	EXPECT_EQ( verdict( 0.55 ), "UNDECIDED" );
	EXPECT_EQ( profile.rows[20].at( "proved_until" ), "0.2" ) << "nothing is proved of an unknown world";
}

TEST_F( CliGuard, AnOlderSightReplacesANewerOne )
{
	const Outcome outcome = guard(
	    line( 0.5, "world", box( 0.6, 0.3 ), 0.45 ) + line( 0.6, "world", R"({"id": "post", "operation": 1})", 0.4 ) );
	EXPECT_EQ( outcome.status, 1 );
	EXPECT_EQ( report["late"], 1 );
	EXPECT_EQ( verdict( 0.7 ), "BLOCKED" );
}

TEST_F( CliGuard, PeopleAreNoReasonToSlowDown )
{
	// nobody was looked for until 0.2 s; then somebody is far, near, and gone
	EXPECT_EQ( guard( line( 0.2, "people", box( 9, 0, "anna" ), 0.2 ) + line( 0.5, "people", box( 1.1, 0, "anna" ), 0.5 ) +
	                      line( 1, "people", "", 1 ),
	               { "--people-deceleration", "5", "--people-reaction", "0.02" } )
	               .status,
	    0 );
	const auto scale = [&]( double time )
	{ return profile.number( static_cast<std::size_t>( std::lround( 100 * time ) ), "scale" ); };
	EXPECT_EQ( scale( 0.1 ), 0 );
	EXPECT_EQ( scale( 0.3 ), 1 );
	EXPECT_GT( scale( 0.5 ), 0 );
	EXPECT_LT( scale( 0.5 ), 1 );
	EXPECT_LT( scale( 0.7 ), scale( 0.5 ) ) << "the older the sight, the nearer anybody may be";
	EXPECT_EQ( scale( 1 ), 1 );
}

// Sights at 0.1, 0.2 and 0.4 s; one between the last two comes late.
TEST_F( CliGuard, FramesThatWereLeftOutCount )
{
	std::string log = R"({"t": 0, "cloud": {"resolution": 0.02, "box_min": [-1, -1, -0.2], "box_max": [1, 1, 0.2]}})"
	                  "\n";
	EXPECT_EQ( guard( log ).status, 0 );
	EXPECT_EQ( report["frames"]["taken"], 0 );
	EXPECT_TRUE( report["frames"]["per_second"].is_null() );
	writePoints( "p.npy", { 5, 5, 0, 5, 5, 0.1F, 5, 5, 0.2F } );
	for ( const auto& [t, seen] :
	    { std::pair( 0.1, 0.1 ), std::pair( 0.2, 0.2 ), std::pair( 0.5, 0.4 ), std::pair( 0.6, 0.3 ) } )
	{
		log += "{\"t\": " + std::to_string( t ) + ", \"seen\": " + std::to_string( seen ) +
		       R"(, "frame": {"points": "p.npy"}})" + "\n";
	}
	const Outcome outcome = guard( log );
	EXPECT_EQ( report["frames"]["taken"], 3 ) << report;
	EXPECT_NEAR( report["frames"]["per_second"].get<double>(), 2 / 0.3, 1e-9 );
	EXPECT_NEAR( report["frames"]["longest_gap"].get<double>(), 0.2, 1e-9 );
	EXPECT_TRUE( contains( outcome.out, "frames      3, 6.7 per second, at most 200 ms between two" ) ) << outcome.out;
}

// Points of a post, seen from above the arm; the second frame is older than the first, the third one's file is no array.
TEST_F( CliGuard, AFrameIsNotSeen )
{
	writePoints( "p.npy", { 0.6F, 0.3F, -2, 0.61F, 0.3F, -2, 0.6F, 0.31F, -2 } );
	write( "bad.npy", "hello" );
	const std::string cloud =
	    R"({"t": 0, "cloud": {"resolution": 0.02, "box_min": [-1, -1, -0.2], "box_max": [1, 1, 0.2], "shadow": 0.01}})";
	const std::string seen =
	    R"({"t": 0.5, "seen": 0.45, "frame": {"points": "p.npy", "pose": {"position": [0, 0, 2], "orientation": [0, 0, 0, 1]}}})";
	const std::string older = R"({"t": 0.6, "seen": 0.4, "frame": {"points": "p.npy"}})";
	EXPECT_EQ( guard( cloud + "\n" + seen + "\n" + older + "\n" ).status, 1 );
	EXPECT_EQ( verdict( 0.49 ), "FREE" );
	EXPECT_EQ( verdict( 0.5 ), "BLOCKED" );
	EXPECT_EQ( verdict( 0.6 ), "BLOCKED" );
	EXPECT_EQ( report["late"], 1 );
	EXPECT_TRUE( contains( report["alarm"]["pair"].dump(), "cloud" ) ) << report;
	// a frame without a cloud, and a pose that is none
	EXPECT_EQ( guard( seen ).status, 1 );
	EXPECT_EQ( verdict( 0.5 ), "UNDECIDED" );
	EXPECT_TRUE( contains( report["rejected"].dump(), "comes before any cloud" ) ) << report;
	EXPECT_EQ( guard( cloud + "\n" + R"({"t": 1, "frame": {"points": "bad.npy"}})" ).status, 2 );
	EXPECT_EQ( guard( cloud + "\n" + R"({"t": 1, "frame": {"depth": "p.npy"}})" ).status, 2 ) << "no camera";
	EXPECT_EQ( guard( R"({"t": 0, "cloud": {"resolution": -1, "box_min": [0, 0, 0], "box_max": [1, 1, 1]}})" ).status, 1 );
	EXPECT_EQ( verdict( 0 ), "UNDECIDED" );
}

TEST_F( CliGuard, RefusesBadLines )
{
	const auto refused = [&]( const std::string& text, const std::string& message )
	{
		const Outcome outcome = guard( "{\"t\": 0}\n" + text );
		EXPECT_EQ( outcome.status, 2 );
		EXPECT_TRUE( contains( outcome.err, "log.jsonl: line 2" ) && contains( outcome.err, message ) ) << outcome.err;
	};
	refused( "hello", "is no JSON object" );
	refused( "{\"seen\": 1}", "t: is missing" );
	refused( "{\"t\": 1e999}", "is no JSON object" );
	refused( "{\"t\": 1, \"seen\": 2}", "after t = 1 s" );
	refused( "{\"t\": 1, \"wrld\": {}}", "wrld: is unknown" );
	refused( "{\"t\": 1, \"attach\": \"post\"}", "link: is missing" );
	refused( "{\"t\": 1, \"world\": {}, \"people\": {}}", "is in one line with" );
	refused( line( 1, "world", box( 1, 0 ) + "," + box( 2, 0 ), 1 ), "is there twice" );
	refused( line( 1, "people", R"({"id": "anna", "operation": "MOVE", "pose": {}})", 1 ), "people have no operation" );
	refused( line( 1, "world", R"({"id": "post", "operation": 3})", 1 ), "has no pose" );
	refused( line( 1, "world",
	             R"({"id": "post", "primitives": [{"type": "box", "dimensions": [1, 1]}], "primitive_poses": [{}]})", 1 ),
	    "post" );
	EXPECT_EQ( runModel( "guard", { "--trajectory", "t.csv", "--replay", "none.jsonl" } ).status, 2 );
	EXPECT_EQ( guard( "", { "--rate", "0" } ).status, 2 );
	EXPECT_EQ( guard( "", { "--reaction", "1" } ).status, 2 );
	EXPECT_EQ( guard( "", { "--deceleration", "shoulder=1" } ).status, 2 ) << "and the elbow?";
}
