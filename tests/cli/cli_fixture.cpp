// SPDX-License-Identifier: BSD-3-Clause
// The small robot's files, and running the program.
#include "cli_fixture.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <sys/wait.h>

namespace fs = std::filesystem;

namespace
{

const char* const urdf = R"(<?xml version="1.0"?>
<robot name="planar_arm">
  <link name="base"><collision><origin xyz="0 0 -0.2"/><geometry><box size="0.2 0.2 0.1"/></geometry></collision></link>
  <link name="upper"><collision><origin xyz="0.2 0 0"/><geometry><box size="0.4 0.05 0.05"/></geometry></collision></link>
  <link name="fore"><collision><geometry><mesh filename="fore.stl"/></geometry></collision></link>
  <link name="tool"/>
  <link name="finger"/>
  <joint name="shoulder" type="revolute">
    <parent link="base"/><child link="upper"/><axis xyz="0 0 1"/><limit lower="-2" upper="2" effort="1" velocity="1"/>
  </joint>
  <joint name="elbow" type="revolute">
    <parent link="upper"/><child link="fore"/><origin xyz="0.4 0 0"/><axis xyz="0 0 1"/>
    <limit lower="-2.8" upper="2.8" effort="1" velocity="1"/>
  </joint>
  <joint name="tool_joint" type="fixed"><parent link="fore"/><child link="tool"/><origin xyz="0.4 0 0"/></joint>
  <joint name="finger_joint" type="revolute">
    <parent link="tool"/><child link="finger"/><axis xyz="0 0 1"/><limit lower="-3" upper="3" effort="1" velocity="1"/>
    <mimic joint="elbow" multiplier="0.5" offset="0"/>
  </joint>
</robot>
)";

const char* const srdf = R"(<?xml version="1.0"?>
<robot name="planar_arm">
  <group name="arm"><joint name="shoulder"/><joint name="elbow"/></group>
  <group name="shoulder_only"><joint name="shoulder"/></group>
  <disable_collisions link1="base" link2="upper" reason="Adjacent"/>
  <disable_collisions link1="upper" link2="fore" reason="Adjacent"/>
</robot>
)";

std::string sceneWith( const std::string& id, const std::string& position, const std::string& size )
{
	return "name: test_scene\nworld:\n  collision_objects:\n    - id: " + id + "\n      primitives:\n        - type: box\n" +
	       "          dimensions: " + size + "\n      primitive_poses:\n        - position: " + position +
	       "\n          orientation: [0, 0, 0, 1]\n";
}

std::string requestWith( double from, double to )
{
	std::ostringstream text;
	text
	    << "group_name: arm\nplanner_id: RRTConnectkConfigDefault\nallowed_planning_time: 30\nstart_state:\n  joint_state:\n"
	    << "    name: [shoulder, elbow]\n    position: [" << from << ", 0]\ngoal_constraints:\n  - joint_constraints:\n"
	    << "      - joint_name: shoulder\n        position: " << to << "\n      - joint_name: elbow\n        position: 0\n";
	return text.str();
}

// An axis-aligned box as ASCII STL.
std::string boxStl( const std::array<double, 3>& low, const std::array<double, 3>& high )
{
	const int faces[12][3] = { { 0, 1, 3 }, { 0, 3, 2 }, { 4, 6, 7 }, { 4, 7, 5 }, { 0, 4, 5 }, { 0, 5, 1 }, { 2, 3, 7 },
	    { 2, 7, 6 }, { 0, 2, 6 }, { 0, 6, 4 }, { 1, 5, 7 }, { 1, 7, 3 } };
	std::ostringstream text;
	text << "solid box\n";
	for ( const auto& face : faces )
	{
		text << "facet normal 0 0 0\nouter loop\n";
		for ( int corner : face )
		{
			text << "vertex " << ( corner & 1 ? high : low )[0] << " " << ( corner & 2 ? high : low )[1] << " "
			     << ( corner & 4 ? high : low )[2] << "\n";
		}
		text << "endloop\nendfacet\n";
	}
	text << "endsolid box\n";
	return text.str();
}

std::string quoted( const std::string& text )
{
	std::string result = "'";
	for ( char c : text )
	{
		result += c == '\'' ? "'\\''" : std::string( 1, c );
	}
	return result + "'";
}

} // namespace

std::string readFile( const std::string& path )
{
	std::ifstream stream( path, std::ios::binary );
	std::ostringstream text;
	text << stream.rdbuf();
	return text.str();
}

bool contains( const std::string& text, const std::string& part )
{
	return text.find( part ) != std::string::npos;
}

Outcome runLeeway( const std::string& folder, const std::vector<std::string>& arguments )
{
	// Streams go to hidden files beside the folder's own, so that a test can list the files that the program left.
	// The cache of a run that names none is there too, not the user's own.
	std::string command =
	    "cd " + quoted( folder ) + " && XDG_CACHE_HOME=" + quoted( folder + "/.caches" ) + " " + quoted( LEEWAY_PROGRAM );
	for ( const std::string& argument : arguments )
	{
		command += " " + quoted( argument );
	}
	command += " >.stdout 2>.stderr";
	const int raw = std::system( command.c_str() );
	Outcome result;
	result.status = WIFEXITED( raw ) ? WEXITSTATUS( raw ) : -1;
	result.out = readFile( folder + "/.stdout" );
	result.err = readFile( folder + "/.stderr" );
	return result;
}

Table parseTable( const std::string& text )
{
	Table table;
	std::istringstream lines( text );
	std::string line;
	while ( std::getline( lines, line ) )
	{
		std::vector<std::string> cells( 1 );
		for ( char c : line )
		{
			if ( c == ',' )
			{
				cells.emplace_back();
				continue;
			}
			cells.back().push_back( c );
		}
		if ( table.header.empty() )
		{
			table.header = cells;
			continue;
		}
		if ( cells.size() != table.header.size() )
		{
			throw std::runtime_error( "a row has another number of cells than the header: " + line );
		}
		table.rows.emplace_back();
		for ( std::size_t i = 0; i < cells.size(); ++i )
		{
			table.rows.back()[table.header[i]] = cells[i];
		}
	}
	return table;
}

double Table::number( std::size_t row, const std::string& column ) const
{
	return std::stod( rows.at( row ).at( column ) );
}

void Cli::SetUp()
{
	std::string pattern = testing::TempDir() + "/leeway_cli_XXXXXX";
	ASSERT_NE( mkdtemp( pattern.data() ), nullptr );
	m_folder = pattern;
	write( "arm.urdf", urdf );
	write( "arm.srdf", srdf );
	write( "fore.stl", boxStl( { 0, -0.025, -0.025 }, { 0.4, 0.025, 0.025 } ) );
	write( "scene.yaml", sceneWith( "wall", "[1.0, 0, 0]", "[0.2, 2, 2]" ) );
	write( "blocked.yaml", sceneWith( "post", "[0.6, 0, 0]", "[0.1, 0.1, 1]" ) );
	write( "request.yaml", requestWith( -1, 1 ) );
	write( "states.csv", "shoulder,elbow\n0,0\n0.5,0.5\n0,0.1\n" );
	write( "edges.csv", "from:shoulder,from:elbow,to:shoulder,to:elbow\n-1,0,1,0\n" );
}

void Cli::TearDown()
{
	std::error_code ignored;
	fs::remove_all( m_folder, ignored );
}

void Cli::write( const std::string& name, const std::string& text ) const
{
	std::ofstream( path( name ), std::ios::binary ) << text;
}

void Cli::edit( const std::string& name, const std::string& from, const std::string& to ) const
{
	std::string text = readFile( path( name ) );
	const std::size_t at = text.find( from );
	ASSERT_NE( at, std::string::npos ) << name << " lacks " << from;
	write( name, text.replace( at, from.size(), to ) );
}

Outcome Cli::runModel( const std::string& subcommand, const std::vector<std::string>& more, const std::string& scene ) const
{
	std::vector<std::string> arguments = { subcommand, "--robot", "arm.urdf", "--srdf", "arm.srdf", "--scene", scene };
	arguments.insert( arguments.end(), more.begin(), more.end() );
	return run( arguments );
}

std::vector<std::string> Cli::files() const
{
	std::vector<std::string> names;
	for ( const fs::directory_entry& entry : fs::directory_iterator( m_folder ) )
	{
		const std::string name = entry.path().filename().string();
		if ( name[0] != '.' )
		{
			names.push_back( name );
		}
	}
	std::sort( names.begin(), names.end() );
	return names;
}
