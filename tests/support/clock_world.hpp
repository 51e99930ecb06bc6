// SPDX-License-Identifier: BSD-3-Clause
// Robots and things that move in one cell, for tests.
#pragma once

#include "edge_auditor.hpp"
#include "leeway/handles.hpp"
#include "owned_clock.hpp"
#include "random_robot.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

/// A checker of all variables of a robot, and a query.
struct ClockBench
{
	leeway::Checker checker;
	leeway::Query query;

	ClockBench( const lw_robot* robot, const lw_scene* scene, bool tables )
	{
		lw_diag diag = {};
		leeway::Reach reach;
		if ( tables )
		{
			lw_reach_def def = lw_reach_def_default();
			def.robot = robot;
			def.seconds = 0.1;
			lw_reach* made = nullptr;
			leeway::require( lw_reach_create( &def, nullptr, &diag, &made ), diag );
			reach = leeway::Reach::adopt( made );
		}
		lw_checker_def def = lw_checker_def_default();
		def.robot = robot;
		def.scene = scene;
		def.reach = reach.get();
		lw_checker* made = nullptr;
		leeway::require( lw_checker_create( &def, nullptr, &diag, &made ), diag );
		checker = leeway::Checker::adopt( made );
		query = leeway::makeQuery( checker.get() );
	}

	lw_timed_result ask( OwnedClock& clock, double start, double end, const lw_timed_def& def ) const
	{
		const lw_clock view = clock.view();
		lw_diag diag = {};
		EXPECT_EQ( LW_OK, lw_clock_check( checker.get(), &view, &diag ) ) << diag.message;
		lw_timed_result result;
		EXPECT_EQ( LW_OK, lw_checker_timed( checker.get(), query.get(), &view, start, end, &def, &result ) );
		return result;
	}
};

/// A joint with one axis of the frame, wide limits.
inline void addJoint( RobotModel& model, const char* name, lw_joint_type type, std::uint32_t parent, int axis )
{
	lw_joint_def& joint = model.joint( name, type, parent );
	for ( int k = 0; k < 3; ++k )
	{
		joint.axis[k] = k == axis ? 1 : 0;
	}
	joint.lower = -20;
	joint.upper = 20;
}
