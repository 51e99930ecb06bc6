// SPDX-License-Identifier: BSD-3-Clause
// xacro files as robots: the program that expands them is started for them alone, without a shell, within limits. (With the real xacro:
// planners/python/tests/test_xacro.py.)
#include "cli_fixture.hpp"

#include <cstdlib>
#include <filesystem>

namespace
{

/// A folder with a xacro file and stand-ins for the program xacro.
class Xacro : public Cli
{
protected:
	void SetUp() override
	{
		Cli::SetUp();
		std::string text = readFile( path( "arm.urdf" ) );
		write( "expanded.urdf", text );
		const std::string head = "<robot name=\"planar_arm\"";
		text.replace( text.find( head ), head.size(),
		    head + " xmlns:xacro=\"http://www.ros.org/wiki/xacro\"><xacro:arg name=\"side\" default=\"left\"/" );
		write( "arm.urdf.xacro", text );
		m_path = std::getenv( "PATH" );
	}
	void TearDown() override
	{
		setenv( "PATH", m_path.c_str(), 1 );
		unsetenv( "LEEWAY_XACRO" );
		Cli::TearDown();
	}
	/// A program in the folder.
	std::string program( const std::string& name, const std::string& commands ) const
	{
		write( name, "#!/bin/sh\n" + commands );
		std::filesystem::permissions( path( name ), std::filesystem::perms::owner_all );
		return path( name );
	}
	Outcome info( const std::string& robot, const std::vector<std::string>& more = {} ) const
	{
		std::vector<std::string> arguments = { "info", "--robot", robot };
		arguments.insert( arguments.end(), more.begin(), more.end() );
		return run( arguments );
	}
	/// The program that leaves its arguments in a file, one a line, and expands.
	std::string expander() const
	{
		return program(
		    "expand", "printf '%s\\n' \"$@\" > \"" + path( "arguments" ) + "\"\ncat \"" + path( "expanded.urdf" ) + "\"\n" );
	}

	std::string m_path;
};

} // namespace

TEST_F( Xacro, ArgumentsArriveWithoutAShell )
{
	setenv( "LEEWAY_XACRO", expander().c_str(), 1 );
	const Outcome outcome = info( "arm.urdf.xacro", { "side:=$(touch made); `touch made` 'a b'", "gripper:=" } );
	EXPECT_EQ( outcome.status, 0 ) << outcome.err;
	EXPECT_TRUE( contains( outcome.out, "robot planar_arm (arm.urdf.xacro)" ) ) << outcome.out;
	EXPECT_TRUE( contains( outcome.err, "was expanded by " + path( "expand" ) ) ) << outcome.err;
	EXPECT_EQ(
	    readFile( path( "arguments" ) ), std::filesystem::path( path( "arm.urdf.xacro" ) ).lexically_normal().string() +
	                                         "\nside:=$(touch made); `touch made` 'a b'\ngripper:=\n" );
	EXPECT_FALSE( std::filesystem::exists( path( "made" ) ) );
}

TEST_F( Xacro, AnArgumentMayStandBehindEveryOption )
{
	setenv( "LEEWAY_XACRO", expander().c_str(), 1 );
	const Outcome outcome =
	    run( { "plan", "--robot", "arm.urdf.xacro", "--package-path", ".", "a:=1", "--start", "shoulder=0", "--goal-pose",
	        "tool=0.8,0,0", "b:=2", "--planner", "RRTConnect", "--planner-param", "range=0.5", "c:=3" } );
	EXPECT_EQ( outcome.status, 0 ) << outcome.err;
	EXPECT_EQ( readFile( path( "arguments" ) ),
	    std::filesystem::path( path( "arm.urdf.xacro" ) ).lexically_normal().string() + "\na:=1\nb:=2\nc:=3\n" );
	EXPECT_EQ( info( "arm.urdf.xacro", { "stray" } ).status, 2 );
	EXPECT_TRUE( contains( info( "arm.urdf.xacro", { "stray" } ).err, "stray" ) );
}

TEST_F( Xacro, ItRunsForNothingElse )
{
	setenv( "LEEWAY_XACRO", program( "expand", "touch \"" + path( "ran" ) + "\"\ncat expanded.urdf\n" ).c_str(), 1 );
	edit( "expanded.urdf", "<robot name", "<robot xmlns:xacro=\"http://www.ros.org/wiki/xacro\" name" );
	write( "no_namespace.urdf", "<robot name=\"r\"><link name=\"${name}\"/></robot>" );
	write( "s.srdf", "<robot name=\"planar_arm\" xmlns:xacro=\"x\"><xacro:group/></robot>" );
	write( "model.xml", "<mujoco xmlns:xacro=\"x\"><worldbody><body name=\"${a}\"/></worldbody></mujoco>" );
	EXPECT_EQ( info( "expanded.urdf" ).status, 0 ) << "xacro's own output still declares the namespace";
	EXPECT_EQ( info( "arm.urdf" ).status, 0 );
	EXPECT_TRUE( contains( info( "no_namespace.urdf" ).err, "run xacro first" ) );
	EXPECT_TRUE(
	    contains( info( "arm.urdf", { "--srdf", "s.srdf" } ).err, "s.srdf: <xacro:group> (line 1): this is a xacro file" ) );
	EXPECT_TRUE( contains( info( "arm.urdf", { "--scene", "arm.urdf.xacro" } ).err, "run xacro first" ) );
	EXPECT_EQ( info( "model.xml" ).status, 2 );
	EXPECT_FALSE( std::filesystem::exists( path( "ran" ) ) );
	const std::string err = info( "arm.urdf", { "side:=left" } ).err;
	EXPECT_TRUE( contains( err, "side:=left: is an argument of xacro, and arm.urdf is no xacro file" ) ) << err;
}

TEST_F( Xacro, AFailureShowsItsLastWords )
{
	setenv( "LEEWAY_XACRO",
	    program( "expand", "printf '\\033[31mundefined symbol: reach\\033[0m\\n' >&2\nexit 3\n" ).c_str(), 1 );
	const Outcome outcome = info( "arm.urdf.xacro", { "side:=left" } );
	EXPECT_EQ( outcome.status, 2 );
	EXPECT_TRUE( contains( outcome.err, "arm.urdf.xacro: xacro: " + path( "expand" ) +
	                                        " failed with exit status 3: undefined symbol: reach; correct the file" ) )
	    << outcome.err;
	EXPECT_TRUE( contains( outcome.err, "xacro arm.urdf.xacro side:=left" ) ) << outcome.err;
	setenv( "LEEWAY_XACRO", program( "expand", "kill -TERM $$\n" ).c_str(), 1 );
	EXPECT_TRUE( contains( info( "arm.urdf.xacro" ).err, "was killed by signal 15" ) );
	setenv( "LEEWAY_XACRO", path( "arm.urdf" ).c_str(), 1 );
	EXPECT_TRUE( contains( info( "arm.urdf.xacro" ).err, "$LEEWAY_XACRO: is no program" ) );
}

TEST_F( Xacro, WrongOutputIsLocatedInTheExpandedText )
{
	edit( "expanded.urdf", "<child link=\"upper\"/>", "<child link=\"lower\"/>" );
	setenv( "LEEWAY_XACRO", expander().c_str(), 1 );
	const Outcome outcome = info( "arm.urdf.xacro" );
	EXPECT_EQ( outcome.status, 2 );
	EXPECT_TRUE(
	    contains( outcome.err, "arm.urdf.xacro: joint shoulder (line 9) of the text that xacro wrote: child link lower" ) )
	    << outcome.err;
	setenv( "LEEWAY_XACRO", program( "expand", "exit 0\n" ).c_str(), 1 );
	EXPECT_EQ( info( "arm.urdf.xacro" ).status, 2 ) << "no output at all";
	setenv( "LEEWAY_XACRO", program( "expand", "echo '<robot name=\"r\"/>'\n" ).c_str(), 1 );
	EXPECT_TRUE(
	    contains( info( "arm.urdf.xacro" ).err, "has no link: it may define macros only; name the file that uses them" ) );
}

TEST_F( Xacro, OneThatNeverStopsIsStopped )
{
	setenv( "LEEWAY_XACRO", program( "expand", "yes '<!-- again -->'\n" ).c_str(), 1 );
	const Outcome outcome = info( "arm.urdf.xacro" );
	EXPECT_EQ( outcome.status, 2 );
	EXPECT_TRUE( contains( outcome.err, "wrote more than 67108864 bytes and was killed" ) ) << outcome.err;
	// The program ends; a part of it that holds its output open does not
	setenv( "LEEWAY_XACRO", program( "expand", "sleep 5 &\ncat expanded.urdf\n" ).c_str(), 1 );
	EXPECT_EQ( info( "arm.urdf.xacro" ).status, 0 );
}

TEST_F( Xacro, WithoutTheProgramTheRemedyIsTold )
{
	std::filesystem::create_directory( path( "bin" ) );
	setenv( "PATH", path( "bin" ).c_str(), 1 );
	const Outcome outcome = runLeeway( m_folder, { "info", "--robot", "arm.urdf.xacro" } );
	EXPECT_EQ( outcome.status, 2 );
	EXPECT_TRUE( contains( outcome.err, "this is a xacro file, and the program xacro was not found" ) ) << outcome.err;
	EXPECT_TRUE( contains( outcome.err, "pip install xacro" ) ) << outcome.err;
	program( "bin/python3", "exit 117\n" ); // has no module xacro
	EXPECT_TRUE( contains( info( "arm.urdf.xacro" ).err, "the program xacro was not found" ) );
	program( "bin/python3", "/bin/cat expanded.urdf\n" );
	EXPECT_EQ( info( "arm.urdf.xacro" ).status, 0 );
	program( "bin/xacro", "exit 5\n" );
	EXPECT_TRUE( contains( info( "arm.urdf.xacro" ).err, "bin/xacro failed with exit status 5" ) )
	    << "in front of python3's";
}
