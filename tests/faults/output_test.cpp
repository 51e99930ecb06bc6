// SPDX-License-Identifier: BSD-3-Clause
// Outputs that cannot be written, by every command that writes: a full disk, a place that is no folder, a limit of the
// system. Exit status 2, one line that names the output, the old file untouched, nothing left behind.
#include "cli_fixture.hpp"

#include <filesystem>
#include <sys/resource.h>

namespace
{

struct Writer
{
	std::string name;
	std::vector<std::string> arguments; ///< "@" stands for the output
	std::string output;                 ///< its name in a run that goes well
};

std::ostream& operator<<( std::ostream& stream, const Writer& writer )
{
	return stream << writer.name;
}

const std::vector<std::string> model = { "--robot", "arm.urdf", "--srdf", "arm.srdf" };
const std::vector<std::string> world = { "--robot", "arm.urdf", "--srdf", "arm.srdf", "--scene", "scene.yaml" };

std::vector<std::string> command(
    const std::string& name, const std::vector<std::string>& with, const std::vector<std::string>& more )
{
	std::vector<std::string> all = { name };
	all.insert( all.end(), with.begin(), with.end() );
	all.insert( all.end(), more.begin(), more.end() );
	return all;
}

std::vector<Writer> writers()
{
	std::vector<Writer> all = {
	    { "CheckOut", command( "check", world, { "--group", "arm", "--states", "states.csv", "--out", "@" } ), "out.csv" },
	    { "EdgeOut", command( "edge", world, { "--group", "arm", "--edges", "edges.csv", "--out", "@" } ), "out.csv" },
	    { "InfoJson", command( "info", world, { "--group", "arm", "--json", "@" } ), "out.json" },
	    { "PlanOut", command( "plan", world, { "--request", "request.yaml", "--out", "@" } ), "path.yaml" },
	    { "PlanReport", command( "plan", world, { "--request", "request.yaml", "--out", "x.yaml", "--report", "@" } ),
	        "out.json" },
	    { "AuditReport",
	        command( "audit", world, { "--group", "arm", "--path", "good.yaml", "--resolution", "0.05", "--report", "@" } ),
	        "out.json" },
	    { "AuditProfile",
	        command( "audit", world, { "--group", "arm", "--path", "good.yaml", "--resolution", "0.05", "--profile", "@" } ),
	        "out.csv" },
	    { "CacheJson", { "cache", "--cache", "folder", "--json", "@" }, "out.json" },
	    { "SpherizeOut", command( "spherize", model, { "--excess", "50", "--out", "@" } ), "spheres" },
	};
	if ( LEEWAY_HULLS )
	{
		all.push_back(
		    { "PairsOut", command( "pairs", model, { "--budget", "0", "--samples", "20", "--out", "@" } ), "out.srdf" } );
		all.push_back(
		    { "PairsJson", command( "pairs", model, { "--budget", "0", "--samples", "20", "--json", "@" } ), "out.json" } );
	}
	return all;
}

std::string writerName( const testing::TestParamInfo<Writer>& info )
{
	return info.param.name;
}

class Output : public Cli, public testing::WithParamInterface<Writer>
{
protected:
	void SetUp() override
	{
		Cli::SetUp();
		write( "good.yaml", "joint_names: [shoulder, elbow]\npoints:\n  - positions: [0, 0]\n  - positions: [0.2, 0.1]\n" );
		std::filesystem::create_directory( path( "folder" ) );
		write( "folder/tree.txt", "of somebody else" );
	}

	std::vector<std::string> arguments( const std::string& output ) const
	{
		std::vector<std::string> result = GetParam().arguments;
		for ( std::string& argument : result )
		{
			argument = argument == "@" ? output : argument;
		}
		return result;
	}

	void expectRefused( const Outcome& result, const std::string& output ) const
	{
		EXPECT_EQ( result.status, 2 ) << result.out << result.err;
		const std::size_t error = result.err.find( "leeway: error: " );
		ASSERT_NE( error, std::string::npos ) << result.err;
		EXPECT_TRUE( contains( result.err.substr( error ), output ) ) << result.err;
		EXPECT_FALSE( contains( result.err, "internal" ) ) << result.err;
	}

	bool writesFolder() const { return GetParam().name == "SpherizeOut"; }
};

/// Files may grow to so many bytes, for this process and its children.
class FileSizeLimit
{
public:
	explicit FileSizeLimit( rlim_t bytes )
	{
		getrlimit( RLIMIT_FSIZE, &m_before );
		rlimit limit = m_before;
		limit.rlim_cur = bytes;
		setrlimit( RLIMIT_FSIZE, &limit );
	}
	~FileSizeLimit() { setrlimit( RLIMIT_FSIZE, &m_before ); }

private:
	rlimit m_before;
};

} // namespace

TEST_P( Output, IsWrittenWhereItCanBe )
{
	const Outcome result = run( arguments( GetParam().output ) );
	EXPECT_LE( result.status, 1 ) << result.err;
	EXPECT_TRUE( std::filesystem::exists( path( GetParam().output ) ) );
}

TEST_P( Output, OnAFullDeviceIsAnError )
{
	if ( writesFolder() || !std::filesystem::exists( "/dev/full" ) )
	{
		GTEST_SKIP() << "no device to write to";
	}
	expectRefused( run( arguments( "/dev/full" ) ), "/dev/full" );
}

TEST_P( Output, BelowAFileIsAnError )
{
	const std::vector<std::string> before = files();
	expectRefused( run( arguments( "arm.urdf/out" ) ), "arm.urdf/out" );
	EXPECT_EQ( files(), before );
}

/// The system's limit is at least one kilobyte less than the output needs: the temporary file is cut, as on a full disk.
TEST_P( Output, ThatDoesNotFitLeavesTheEarlierOne )
{
	if ( GetParam().name == "CacheJson" )
	{
		GTEST_SKIP() << "its list is shorter than any limit that leaves room for messages";
	}
	std::string target = path( GetParam().output );
	if ( writesFolder() )
	{
		std::filesystem::create_directory( target );
		target += "/arm.urdf"; // whatever it is called: it stays
	}
	{
		const Outcome good = run( arguments( GetParam().output ) );
		ASSERT_LE( good.status, 1 ) << good.err;
	}
	// The old file is something else
	for ( const auto& entry : std::filesystem::recursive_directory_iterator( path( "" ) ) )
	{
		const std::string name = std::filesystem::relative( entry.path(), path( "" ) ).string();
		if ( name == GetParam().output || name.rfind( GetParam().output + "/", 0 ) == 0 )
		{
			if ( entry.is_regular_file() )
			{
				write( name, "an earlier result" );
			}
		}
	}
	const std::vector<std::string> before = files();
	Outcome result;
	{
		const FileSizeLimit limit( 64 );
		result = run( arguments( GetParam().output ) );
	}
	EXPECT_EQ( result.status, 2 ) << result.err;
	EXPECT_EQ( files(), before );
	int kept = 0;
	for ( const auto& entry : std::filesystem::recursive_directory_iterator( path( "" ) ) )
	{
		const std::string name = std::filesystem::relative( entry.path(), path( "" ) ).string();
		EXPECT_FALSE( contains( name, ".partial-" ) ) << name;
		if ( entry.is_regular_file() && ( name == GetParam().output || name.rfind( GetParam().output + "/", 0 ) == 0 ) )
		{
			EXPECT_EQ( readFile( entry.path().string() ), "an earlier result" ) << name;
			++kept;
		}
	}
	EXPECT_GT( kept, 0 );
}

INSTANTIATE_TEST_SUITE_P( Commands, Output, testing::ValuesIn( writers() ), writerName );

TEST_F( Cli, AFullStandardOutputIsAnError )
{
	if ( !std::filesystem::exists( "/dev/full" ) )
	{
		GTEST_SKIP() << "no /dev/full";
	}
	for ( const std::string& arguments :
	    { std::string( "info --group arm" ), std::string( "check --group arm --states states.csv" ),
	        std::string( "edge --group arm --edges edges.csv" ), std::string( "plan --request request.yaml" ) } )
	{
		const std::string line = "cd '" + m_folder + "' && '" LEEWAY_PROGRAM "' " + arguments +
		                         " --robot arm.urdf --srdf arm.srdf --scene scene.yaml >/dev/full 2>full.txt";
		const int raw = std::system( line.c_str() );
		EXPECT_EQ( WIFEXITED( raw ) ? WEXITSTATUS( raw ) : -1, 2 ) << arguments;
		EXPECT_TRUE( contains( readFile( path( "full.txt" ) ), "standard output: output: cannot be written" ) )
		    << readFile( path( "full.txt" ) );
	}
}

/// Files that belong together: the second does not fit on its device, so the first is not replaced either.
TEST_F( Cli, OfTwoOutputsNoneIsReplacedIfOneFails )
{
	write( "path.yaml", "an earlier path" );
	const Outcome result =
	    runModel( "plan", { "--request", "request.yaml", "--out", "path.yaml", "--report", "none/report.json" } );
	EXPECT_EQ( result.status, 2 );
	EXPECT_EQ( readFile( path( "path.yaml" ) ), "an earlier path" );
}
