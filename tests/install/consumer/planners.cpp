// SPDX-License-Identifier: BSD-3-Clause
// leeway::planners from the installed package: OMPL's face refuses a space whose motion validator is not leeway's.
#include <leeway/planners/ompl_planner.hpp>

#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/util/Exception.h>

int main()
{
	namespace ob = ompl::base;
	auto space = std::make_shared<ob::RealVectorStateSpace>( 2 );
	space->setBounds( -1, 1 );
	auto si = std::make_shared<ob::SpaceInformation>( space );
	try
	{
		leeway::planners::OmplPlanner( si ).setup();
	}
	catch ( const ompl::Exception& )
	{
		return 0;
	}
	return 1;
}
