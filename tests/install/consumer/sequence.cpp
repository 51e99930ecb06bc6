// SPDX-License-Identifier: BSD-3-Clause
// leeway::sequence from an installed package: a sequence without motions is an error of the reader or of the sequence.
#include "leeway/sequence/sequence.hpp"

#include <cstdio>

int main()
{
	try
	{
		const leeway::io::RobotModel robot = leeway::io::loadRobot( "none.urdf", "" );
		const leeway::io::Problem problem = leeway::io::buildProblem( robot, {} );
		return leeway::sequence::planSequence( robot, problem, {}, {} ).solved ? 1 : 2;
	}
	catch ( const leeway::io::Error& error )
	{
		std::printf( "%s\n", error.what() );
		return 0;
	}
}
