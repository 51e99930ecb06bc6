// SPDX-License-Identifier: BSD-3-Clause
// leeway::ik from an installed package: a goal for a robot that is not there ends with an error of the reader.
#include "leeway/ik/goal_states.hpp"

#include <cstdio>

int main()
{
	try
	{
		const leeway::io::RobotModel robot = leeway::io::loadRobot( "none.urdf", "" );
		const leeway::io::Problem problem = leeway::io::buildProblem( robot, {} );
		return leeway::ik::findGoalStates( robot, problem, {} ).states.empty() ? 1 : 2;
	}
	catch ( const leeway::io::Error& error )
	{
		std::printf( "%s\n", error.what() );
		return 0;
	}
}
