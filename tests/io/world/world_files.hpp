// SPDX-License-Identifier: BSD-3-Clause
// World files of a test: two small robots, and poses of links by forward kinematics.
#pragma once

#include "files.hpp"
#include "leeway/io/world_model.hpp"

#include <map>

/// An arm with two revolute joints, a finger that mimics the second, and an SRDF with a group and a state; a cart on a rail.
class WorldFileTest : public FileTest
{
protected:
	WorldFileTest()
	{
		const std::string box = "<collision><geometry><box size='0.3 0.06 0.06'/></geometry></collision>";
		const std::string limits = "<limit lower='-2' upper='2' effort='1' velocity='1'/>";
		write( "arm.urdf",
		    "<robot name='arm'><link name='base'>" + box + "</link><link name='upper'>" + box + "</link><link name='fore'>" +
		        box + "</link><link name='finger'>" + box +
		        "</link><joint name='shoulder' type='revolute'><origin xyz='0.1 0 0.2' rpy='0.3 0 0'/><parent link='base'/><child "
		        "link='upper'/><axis xyz='0 0 1'/>" +
		        limits +
		        "</joint><joint name='elbow' type='revolute'><origin xyz='0.4 0 0'/><parent link='upper'/><child link='fore'/><axis "
		        "xyz='0 1 0'/>" +
		        limits +
		        "</joint><joint name='grip' type='prismatic'><origin xyz='0.4 0 0'/><parent link='fore'/><child link='finger'/><axis "
		        "xyz='0 1 0'/>" +
		        limits + "<mimic joint='elbow' multiplier='0.1'/></joint></robot>" );
		write( "arm.srdf",
		    "<robot name='arm'><virtual_joint name='fix' type='fixed' parent_frame='floor' child_link='base'/><group name='whole'><chain "
		    "base_link='base' tip_link='fore'/></group><group_state name='up' group='whole'><joint name='shoulder' value='0.5'/><joint "
		    "name='elbow' value='-0.25'/></group_state><disable_collisions link1='base' link2='upper' reason='Adjacent'/></robot>" );
		write( "cart.urdf",
		    "<robot name='cart'><link name='rail'/><link name='cart'>" + box +
		        "</link><joint name='slide' type='prismatic'><parent link='rail'/><child link='cart'/><axis xyz='1 0 0'/>" +
		        limits + "</joint></robot>" );
	}

	leeway::io::WorldModel load( const std::string& body )
	{
		return leeway::io::loadWorld( write( "cell.yaml", "leeway_world: 1\n" + body ) );
	}

	/// Where a link is.
	static lw_transform poseOf(
	    const leeway::io::RobotModel& model, const std::map<std::string, double>& values, const std::string& link )
	{
		const leeway::Robot robot = leeway::io::buildRobot( model );
		std::vector<double> q( lw_robot_variable_count( robot.get() ) );
		lw_robot_default_state( robot.get(), q.data() );
		for ( std::uint32_t i = 0; i < q.size(); ++i )
		{
			const auto found = values.find( leeway::io::variableName( robot.get(), i ) );
			q[i] = found != values.end() ? found->second : q[i];
		}
		std::vector<lw_transform> poses( lw_robot_link_count( robot.get() ) );
		EXPECT_EQ( lw_robot_fk( robot.get(), q.data(), poses.data() ), LW_OK );
		const std::uint32_t index = lw_robot_find_link( robot.get(), link.c_str() );
		EXPECT_NE( index, LW_INVALID_INDEX ) << link;
		return index != LW_INVALID_INDEX ? poses[index] : lw_transform_identity();
	}

	static void expectNear( const lw_transform& a, const lw_transform& b, double tolerance, const std::string& what )
	{
		for ( int i = 0; i < 3; ++i )
		{
			EXPECT_NEAR( a.t[i], b.t[i], tolerance ) << what;
			for ( int k = 0; k < 3; ++k )
			{
				EXPECT_NEAR( a.r[i][k], b.r[i][k], tolerance ) << what;
			}
		}
	}
};
