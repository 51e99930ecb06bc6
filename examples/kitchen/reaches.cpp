// SPDX-License-Identifier: BSD-3-Clause
// The robot's parking place and the targets of its reaches. The goals are in reach_goals.cpp, found by kitchen_reaches.
#include "model.hpp"

namespace kitchen
{

std::map<std::string, double> tuckedPose()
{
	std::map<std::string, double> pose;
	for ( const char* side : { "left_", "right_" } )
	{
		const std::string s = side;
		pose[s + "shoulder_pitch"] = -0.45;
		pose[s + "shoulder_roll"] = 0.18;
		pose[s + "upperarm_yaw"] = 0;
		pose[s + "elbow"] = 1.95;
		pose[s + "forearm_yaw"] = 0;
		pose[s + "wrist_pitch"] = 0;
		pose[s + "wrist_roll"] = 0;
	}
	return pose;
}

namespace
{

/// A parked base, looking along `yaw`.
std::map<std::string, double> parked( double x, double y, double yaw )
{
	return { { "base_x", x }, { "base_y", y }, { "base_yaw", yaw } };
}

/// Both arms hang down, a little away from the body.
std::map<std::string, double> hanging( std::map<std::string, double> start )
{
	for ( const char* side : { "left_", "right_" } )
	{
		const std::string s = side;
		start[s + "shoulder_pitch"] = -0.2;
		start[s + "shoulder_roll"] = 0.22;
		start[s + "elbow"] = 0.35;
	}
	return start;
}

} // namespace

std::vector<Reach> reachTasks()
{
	const double north = 0.5 * pi, south = -0.5 * pi;
	const Vec3 forward = { 0, 1, 0 }, back = { 0, -0.94, -0.34 };
	return {
	    { "01_fridge", "left_arm", "into the open fridge, in front of the pot", hanging( parked( 0.66, 2.45, north ) ),
	        { { "left", { 0.38, 3.06, 1.03 }, forward, {} } }, {} },
	    { "02_wall_cupboard", "torso_right_arm", "over the bread, under the wall cupboard", parked( 0.95, 2.46, north ),
	        { { "right", { 1.14, 3.36, 1.22 }, forward, {} } }, {} },
	    { "03_sink", "torso_left_arm", "into the sink, down to the plate", parked( 1.80, 2.52, north ),
	        { { "left", { 1.68, 3.33, 0.85 }, { 0, 0.35, -0.94 }, {} } }, {} },
	    { "04_table", "torso_left_arm", "across the table, over jar and cup to a plate",
	        hanging( parked( 2.62, 1.68, south ) ), { { "left", { 2.98, 0.88, 0.89 }, back, {} } }, {} },
	    { "05_counter", "both_arms", "both hands on the counter, left and right of the bowl",
	        hanging( parked( 3.70, 2.58, north ) ),
	        { { "left", { 3.44, 3.00, 1.00 }, { 0.2, 0.9, -0.4 }, {} },
	            { "right", { 3.86, 3.05, 1.00 }, { -0.2, 0.9, -0.4 }, {} } },
	        {} },
	    { "06_oven", "torso_right_arm", "over the open door into the oven", hanging( parked( 3.02, 2.17, north ) ),
	        { { "right", { 3.12, 3.10, 0.44 }, { 0, 0.9, -0.4 }, {} } }, {} },
	    { "07_drawer", "right_arm", "into the open drawer, down to the cutlery", hanging( parked( 0.84, 2.42, north ) ),
	        { { "right", { 1.10, 2.83, 0.815 }, { 0, 0.3, -0.95 }, {} } }, {} },
	    { "08_hob", "torso_both_arms", "both hands over the hob, around the pans", hanging( parked( 3.08, 2.18, north ) ),
	        { { "left", { 2.86, 3.16, 1.06 }, { 0.2, 0.95, -0.2 }, {} },
	            { "right", { 3.38, 3.16, 1.06 }, { -0.2, 0.95, -0.2 }, {} } },
	        {} },
	    { "09_open_cupboard", "torso_right_arm", "up into the open wall cupboard, beside the plates",
	        parked( 3.70, 2.58, north ), { { "right", { 3.80, 3.36, 1.60 }, forward, {} } }, {} },
	    { "10_under_table", "torso_left_arm", "under the table top", parked( 2.50, 1.80, south ),
	        { { "left", { 2.76, 1.30, 0.50 }, back, {} } }, {} },
	    { "11_cupboard", "torso_right_arm", "into the open cupboard, over the copper pan", parked( 2.60, 2.15, north ),
	        { { "right", { 2.50, 3.06, 0.67 }, forward, {} } }, {} },
	    { "12_across_the_room", "whole_body", "from the oven across the room and into the open fridge",
	        parked( 3.30, 2.10, 0 ), { { "left", { 0.38, 3.06, 1.03 }, forward, {} } }, {} },
	};
}

std::vector<Reach> makeReaches()
{
	std::vector<Reach> reaches;
	for ( Reach reach : reachTasks() )
	{
		reach.goal = storedGoal( reach.name );
		if ( !reach.goal.empty() )
			reaches.push_back( reach );
	}
	return reaches;
}

} // namespace kitchen
