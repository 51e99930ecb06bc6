// SPDX-License-Identifier: BSD-3-Clause
// C++ against the installed model i/o: a file that does not exist is an Error that names it.
#include <leeway/io/model.hpp>

#include <string>

int main()
{
	try
	{
		leeway::io::loadRobot( "no_such_robot.urdf", "" );
	}
	catch ( const leeway::io::Error& error )
	{
		return std::string( error.what() ).find( "no_such_robot.urdf" ) != std::string::npos ? 0 : 1;
	}
	return 1;
}
