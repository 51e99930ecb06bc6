// SPDX-License-Identifier: BSD-3-Clause
// leeway::plan from the installed package, without OMPL: both faces refuse a search without a checker.
#include <leeway/planners/planner.h>
#include <leeway/planners/planner.hpp>

int main()
{
	const lw_plan_def def = lw_plan_def_default();
	lw_plan_result result;
	if ( lw_plan( &def, nullptr, &result ) != LW_ERROR_INVALID_ARGUMENT )
	{
		return 2;
	}
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
