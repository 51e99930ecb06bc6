// SPDX-License-Identifier: BSD-3-Clause
// leeway::pairs from an installed package: two boxes on a rail, of which one is proved to stay away from the other.
#include <leeway/pairs/analysis.hpp>
#include <leeway/pairs/hierarchy.hpp>
#include <leeway/pairs/required.hpp>

#include <cstdio>
#include <fstream>

int main()
{
	using namespace leeway;
	const char* const box = "<collision><geometry><box size='0.1 0.1 0.1'/></geometry></collision>";
	std::ofstream( "consumer_rail.urdf" )
	    << "<robot name='rail'><link name='foot'>" << box << "</link><link name='arm'/><link name='slider'>" << box
	    << "</link><joint name='column' type='fixed'><parent link='foot'/><child link='arm'/></joint>"
	    << "<joint name='slide' type='prismatic'><parent link='arm'/><child link='slider'/><axis xyz='1 0 0'/>"
	    << "<limit lower='1' upper='2' effort='1' velocity='1'/></joint></robot>";
	const io::RobotModel robot = io::loadRobot( "consumer_rail.urdf", "" );
	std::remove( "consumer_rail.urdf" );
	pairs::Settings settings;
	settings.reach.def.seconds = 0;
	settings.samples.states = 10;
	try
	{
		const pairs::Analysis analysis( robot, settings );
		return analysis.table.rows().size() == 1 && analysis.samples.freeStates( []( std::size_t ) { return true; } ) == 10
		           ? 0
		           : 1;
	}
	catch ( const io::Error& error ) // a build without qhull says so
	{
		std::printf( "%s\n", error.what() );
		return error.element() == "motion hulls" ? 0 : 2;
	}
}
