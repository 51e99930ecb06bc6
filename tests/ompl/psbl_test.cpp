// SPDX-License-Identifier: BSD-3-Clause
// pSBL, in a program of its own for the sake of the thread sanitizer.
//
// pSBL keeps its threads from using motions that one of them deletes by a mutex that the first thread to enter a section
// locks and the last one to leave unlocks (loopLock_ in pSBL.cpp, from 1.5.2 to 2.0.2 the same). The C++ standard forbids to
// unlock another thread's mutex. glibc does as pSBL means, but the sanitizer reports it, and then misses that whoever
// deletes comes after whoever made: each deletion of a motion, and each look at one that is to be deleted, is a report more.
// Those are left out below by the names of OMPL's functions. The validity checker and the motion validator are called from
// none of them: all events there are looked at in full.
#include "planning.hpp"

#include <ompl/geometric/planners/sbl/pSBL.h>

#if defined( __SANITIZE_THREAD__ )
extern "C" const char* __tsan_default_suppressions();
extern "C" const char* __tsan_default_suppressions()
{
	return "mutex:ompl::geometric::pSBL::threadSolve\n"
	       "deadlock:ompl::geometric::pSBL::threadSolve\n"
	       "race:ompl::geometric::pSBL::removeMotion\n"
	       "race:ompl::base::*::freeState\n"
	       "race:ompl::base::ProjectionEvaluator::computeCoordinates\n" // of a motion that is to be deleted
	       "race:std::vector<ompl::geometric::pSBL::Motion*\n"          // the children of one
	       "race:ompl::PDF<ompl::Grid<ompl::geometric::pSBL::MotionInfo>\n"
	       "race:ompl::Grid<ompl::geometric::pSBL::MotionInfo>\n";
}
#endif

namespace
{

ob::PlannerPtr makeParallelTrees( const ob::SpaceInformationPtr& si )
{
	auto planner = std::make_shared<og::pSBL>( si );
	planner->setThreadCount( 4 );
	return planner;
}

class PlannerThreads : public testing::TestWithParam<World>
{
};

TEST_P( PlannerThreads, TwoTreesGrownByAll )
{
	solveAndAudit( GetParam(), makeParallelTrees );
}

INSTANTIATE_TEST_SUITE_P( Sbl, PlannerThreads, testing::ValuesIn( worlds() ),
    []( const testing::TestParamInfo<World>& world ) { return std::string( world.param.name ); } );

} // namespace
