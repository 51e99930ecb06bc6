// SPDX-License-Identifier: BSD-3-Clause
// leeway::manifold from an installed package: a task without goals is an error of the reader or of the task.
#include "leeway/manifold/plan.hpp"

#include <cstdio>

int main()
{
	try
	{
		const leeway::io::RobotModel robot = leeway::io::loadRobot( "none.urdf", "" );
		const leeway::io::Problem problem = leeway::io::buildProblem( robot, {} );
		return leeway::manifold::planPath( robot, problem, {}, {}, {} ).solved() ? 1 : 2;
	}
	catch ( const leeway::io::Error& error )
	{
		std::printf( "%s\n", error.what() );
		return 0;
	}
}
