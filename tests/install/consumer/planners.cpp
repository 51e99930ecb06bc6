// SPDX-License-Identifier: BSD-3-Clause
// leeway::planners from the installed package: a search without a checker is refused.
#include <leeway/planners/planner.hpp>

int main()
{
	try
	{
		leeway::planners::Planner( leeway::Checker(), leeway::planners::Settings() );
	}
	catch ( const leeway::planners::InputError& )
	{
		return 0;
	}
	return 1;
}
