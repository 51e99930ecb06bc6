// SPDX-License-Identifier: BSD-3-Clause
// Prints leeway's model of a robot, for a comparison with MuJoCo (compare.py): variables, links, shapes; then the poses of all
// links at each state that standard input has.
#include "leeway/io/model.hpp"

#include "leeway/prepare.hpp"

#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <sstream>

using namespace leeway::io;

namespace
{

void printPose( const lw_transform& pose )
{
	for ( const auto& row : pose.r )
	{
		std::printf( " %.17g %.17g %.17g", row[0], row[1], row[2] );
	}
	std::printf( " %.17g %.17g %.17g\n", pose.t[0], pose.t[1], pose.t[2] );
}

/// Fields are separated by tabs, numbers of a field by blanks.
/// One line: link, type, dimensions, solid, pose; then the vertices, if it is a mesh.
void printShape( const std::string& link, const PlacedShape& placed )
{
	const lw_shape_info info = lw_shape_get_info( placed.shape.get() );
	std::printf( "shape\t%s\t%s %.17g %.17g %.17g %u", link.c_str(), lw_shape_type_name( info.type ), info.dimensions[0],
	    info.dimensions[1], info.dimensions[2], info.vertex_count );
	printPose( placed.pose );
	const double* vertices = lw_shape_vertices( placed.shape.get() );
	const double* radii = lw_shape_radii( placed.shape.get() );
	for ( std::uint32_t i = 0; vertices != nullptr && i < info.vertex_count; ++i )
	{
		std::printf( "%.17g %.17g %.17g %.17g\n", vertices[3 * i], vertices[3 * i + 1], vertices[3 * i + 2],
		    radii != nullptr ? radii[i] : 0.0 );
	}
}

void printModel( const RobotModel& model )
{
	for ( const JointModel& joint : model.joints )
	{
		for ( const std::string& name : variableNames( joint ) )
		{
			std::printf(
			    "variable\t%s\t%.17g\t%.17g\t%d\n", name.c_str(), joint.lower, joint.upper, static_cast<int>( joint.type ) );
		}
		if ( !joint.mimic.empty() )
		{
			std::printf( "mimic\t%s\t%s\t%.17g\t%.17g\n", joint.name.c_str(), joint.mimic.c_str(), joint.mimic_multiplier,
			    joint.mimic_offset );
		}
	}
	for ( const LinkModel& link : model.links )
	{
		std::printf( "link\t%s\n", link.name.c_str() );
	}
	for ( const DisabledPair& pair : model.disabled )
	{
		std::printf( "allowed\t%s\t%s\t%s\n", pair.link1.c_str(), pair.link2.c_str(), pair.reason.c_str() );
	}
	for ( const GroupState& state : model.group_states )
	{
		std::printf( "state\t%s\t%zu\n", state.name.c_str(), state.joints.size() );
	}
	for ( const Notice& notice : model.report.notices )
	{
		std::printf( "notice\t%s: %s\n", notice.element.c_str(), notice.text.c_str() );
	}
	for ( const LinkModel& link : model.links )
	{
		for ( const PlacedShape& placed : link.collision )
		{
			printShape( link.name, placed );
		}
	}
	std::printf( "end\n" );
}

int run( const char* file )
{
	LoadOptions options;
	options.defer = false;
	options.strict = true; // without pairs of neighbours, which the file does not allow
	const RobotModel model = loadRobot( file, "", options );
	const leeway::Robot robot = buildRobot( model );
	printModel( model );
	std::vector<lw_transform> poses( lw_robot_link_count( robot.get() ) );
	for ( std::string line; std::getline( std::cin, line ); )
	{
		std::istringstream numbers( line );
		std::vector<double> q;
		for ( double value = 0; numbers >> value; )
		{
			q.push_back( value );
		}
		if ( q.size() != lw_robot_variable_count( robot.get() ) ||
		     lw_robot_fk( robot.get(), q.data(), poses.data() ) != LW_OK )
		{
			std::fprintf( stderr, "%zu numbers are no state\n", q.size() );
			return 1;
		}
		for ( const lw_transform& pose : poses )
		{
			printPose( pose );
		}
	}
	return 0;
}

} // namespace

int main( int argc, char** argv )
{
	if ( argc != 2 )
	{
		std::fprintf( stderr, "usage: mjcf_poses MODEL.xml <states\n" );
		return 2;
	}
	try
	{
		return run( argv[1] );
	}
	catch ( const std::exception& error )
	{
		std::fprintf( stderr, "%s\n", error.what() );
		return 3;
	}
}
