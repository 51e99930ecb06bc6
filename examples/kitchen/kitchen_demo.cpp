// SPDX-License-Identifier: BSD-3-Clause
// kitchen_demo: writes a self-contained planning demo, a humanoid of 23 degrees of freedom in a kitchen, into a folder.
#include "writer.hpp"

#include <fmt/format.h>

#include <exception>
#include <string>

int main( int argc, char** argv )
{
	if ( argc != 2 || std::string( argv[1] ).rfind( "-", 0 ) == 0 )
	{
		const bool help = argc == 2 && ( std::string( argv[1] ) == "--help" || std::string( argv[1] ) == "-h" );
		fmt::print( help ? stdout : stderr, "usage: kitchen_demo FOLDER\nWrites robot.urdf, robot.srdf, scene.yaml, "
		                                    "reach/*.yaml, meshes/ and colours.yaml.\n" );
		return help ? 0 : 2;
	}
	try
	{
		const kitchen::Demo demo = kitchen::makeDemo();
		kitchen::writeDemo( demo, argv[1] );
		fmt::print(
		    "robot: {} joints, {} triangles; kitchen: {} objects, {} triangles; together {} triangles; {} requests\n",
		    demo.robot.movableJoints(), demo.robot.triangles(), demo.room.objects.size(), demo.room.triangles(),
		    demo.robot.triangles() + demo.room.triangles(), demo.reaches.size() );
	}
	catch ( const std::exception& error )
	{
		fmt::print( stderr, "kitchen_demo: {}\n", error.what() );
		return 2;
	}
	return 0;
}
