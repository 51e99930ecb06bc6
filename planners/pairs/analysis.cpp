// SPDX-License-Identifier: BSD-3-Clause
// Pairs of links, from a robot to its new SRDF: see analysis.hpp.
#include "leeway/pairs/analysis.hpp"

namespace leeway::pairs
{
namespace
{

io::LoadedReach findReach( const Robot& robot, const io::RobotModel& model, const Settings& settings )
{
	io::ReachOptions options = settings.reach;
	options.def.samples = settings.samples.states;
	options.def.seed = settings.samples.seed;
	io::LoadedReach reach = io::loadReach( robot, options );
	if ( !reach.reach )
	{
		throw io::Error( model.urdf_file, "motion hulls", "this build of leeway cannot make them", "build it with qhull" );
	}
	return reach;
}

} // namespace

Analysis::Analysis( const io::RobotModel& model, const Settings& settings )
    : robot( io::buildRobot( model ) ), reach( findReach( robot, model, settings ) ), table( model, robot, reach.reach ),
      samples( robot, table, settings.samples )
{
	if ( settings.new_srdf )
	{
		srdf = pairs::newSrdf( table, model );
	}
}

} // namespace leeway::pairs
