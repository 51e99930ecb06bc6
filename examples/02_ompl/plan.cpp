// SPDX-License-Identifier: BSD-3-Clause
// A motion for a robot of files: URDF, SRDF, scene and request. The smallest program against the OMPL shim.
#include <leeway/io/model.hpp>
#include <leeway/ompl/validity.hpp>

#include <ompl/geometric/SimpleSetup.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>

#include <iostream>

int main( int argc, char** argv )
try
{
	if ( argc != 5 )
	{
		std::cerr << "usage: 02_plan robot.urdf robot.srdf scene.yaml request.yaml\n";
		return 2;
	}
	leeway::io::RobotModel robot = leeway::io::loadRobot( argv[1], argv[2] );
	leeway::io::SceneModel scene = leeway::io::loadScene( argv[3] );
	leeway::io::Request request = leeway::io::loadRequest( argv[4] );
	leeway::io::Problem problem = leeway::io::buildProblem( robot, { request.group, &scene, &request } );

	ompl::geometric::SimpleSetup setup( leeway::ompl::makeStateSpace( problem.checker ) );
	auto engine = leeway::ompl::install( setup.getSpaceInformation(), problem.checker );
	ompl::base::ScopedState<> start( setup.getStateSpace() ), goal( setup.getStateSpace() );
	engine->adapter().fromVector( leeway::io::startState( problem ).data(), start.get() );
	engine->adapter().fromVector( leeway::io::goalState( problem, request ).data(), goal.get() );
	setup.setStartAndGoalStates( start, goal );
	setup.setPlanner( std::make_shared<ompl::geometric::RRTConnect>( setup.getSpaceInformation() ) );
	if ( setup.solve( 60.0 ) != ompl::base::PlannerStatus::EXACT_SOLUTION )
	{
		return 1;
	}
	// every edge of the path is proved, not sampled
	std::cout << "path of " << setup.getSolutionPath().getStateCount() << " states, valid: " << std::boolalpha
	          << setup.getSolutionPath().check() << "; " << engine->counters().edges << " edges checked\n";
	return setup.getSolutionPath().check() ? 0 : 1;
}
catch ( const std::exception& error )
{
	std::cerr << error.what() << '\n';
	return 2;
}
