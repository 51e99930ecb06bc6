// SPDX-License-Identifier: BSD-3-Clause
// Motion plan requests: both spellings, missing parts, unsupported parts.
#include "files.hpp"

#include <cmath>

using namespace leeway::io;

namespace
{

const std::string start = "start_state:\n  joint_state:\n    name: [a, b]\n    position: [0.5, -1]\n";
const std::string goal =
    "goal_constraints:\n  - joint_constraints:\n      - {joint_name: a, position: 1, tolerance_above: 0.01, "
    "tolerance_below: 0.02, weight: 1}\n      - position: 2\n        joint_name: b\n";
const std::string group = "group_name: arm\n";

class RequestTest : public FileTest
{
protected:
	Request load( const std::string& text ) { return loadRequest( write( "request.yaml", text ) ); }
	void expectBad( const std::string& text, std::vector<std::string> parts )
	{
		parts.push_back( "request.yaml" );
		expectError( [&] { load( text ); }, parts );
	}
};

} // namespace

TEST_F( RequestTest, ListsAndMaps )
{
	Request request =
	    load( start + goal + group + "planner_id: RRTConnect\nallowed_planning_time: 5\nnum_planning_attempts: 2\n" );
	EXPECT_EQ( request.group, "arm" );
	EXPECT_EQ( request.planner_id, "RRTConnect" );
	EXPECT_DOUBLE_EQ( request.allowed_planning_time, 5 );
	EXPECT_DOUBLE_EQ( request.start.values.at( "a" ), 0.5 );
	EXPECT_DOUBLE_EQ( request.start.values.at( "b" ), -1 );
	ASSERT_EQ( request.goal.size(), 2u );
	EXPECT_EQ( request.goal[0].joint, "a" );
	EXPECT_DOUBLE_EQ( request.goal[0].tolerance_above, 0.01 );
	EXPECT_DOUBLE_EQ( request.goal[0].tolerance_below, 0.02 );
	EXPECT_DOUBLE_EQ( request.goal[1].position, 2 );
	EXPECT_TRUE( request.notices.empty() ) << allNotices( request.notices );
}

TEST_F( RequestTest, MultiDofInBothSpellings )
{
	std::string names = "  multi_dof_joint_state:\n    joint_names: [v]\n    transforms:\n";
	Request request = load( start + names + "      - {translation: [1, 2, 3], rotation: [0, 0, 1, 1]}\n" + goal + group );
	EXPECT_DOUBLE_EQ( request.start.values.at( "v/trans_y" ), 2 );
	EXPECT_NEAR( request.start.values.at( "v/rot_z" ), std::sqrt( 0.5 ), 1e-15 );
	EXPECT_NOTICE( request.notices, "quaternion of length 1.41421" );
	request = load(
	    start + names + "      - {rotation: {w: 1, x: 0, y: 0, z: 0}, translation: {z: 3, y: 2, x: 1}}\n" + goal + group );
	EXPECT_DOUBLE_EQ( request.start.values.at( "v/trans_z" ), 3 );
	EXPECT_DOUBLE_EQ( request.start.values.at( "v/rot_w" ), 1 );
	expectBad( start + names + "      []\n" + goal + group, { "1 joint_names and 0 transforms" } );
	expectBad( start + names + "      - {translation: [1, 2, 3], rotation: [0, 0, 0, 0]}\n" + goal + group,
	    { "zero", "[0, 0, 0, 1]" } );
}

TEST_F( RequestTest, PartsMissing )
{
	EXPECT_EQ( load( start + goal ).group, "" ); // a planner may give it otherwise, or mean all joints
	EXPECT_EQ( load( start + goal + "group_name: \"\"\n" ).group, "" );
	expectBad( goal + group, { "start_state", "missing" } );
	expectBad( start + group, { "goal_constraints", "no goal" } );
	expectBad( start + group + "goal_constraints: []\n", { "no goal" } );
	expectBad( start + group + "goal_constraints: [{joint_constraints: []}]\n", { "names no joint" } );
	expectBad( start + group + "goal_constraints: [{joint_constraints: [{position: 1}]}]\n", { "joint_name", "missing" } );
	expectBad( start + group + "goal_constraints: [{joint_constraints: [{joint_name: a}]}]\n",
	    { "position", "missing", "joint_constraints[0] a" } );
	expectBad( "", { "request.yaml" } );
	expectBad( "- a\n- b\n", { "not a map" } );
	expectBad( "world: {collision_objects: []}\n", { "planning scene" } );
	expectBad( "a: [1, 2\nb: }", { "YAML", "line" } );
	expectError( [&] { loadRequest( path( "none.yaml" ) ); }, { "none.yaml", "no such file" } );
}

TEST_F( RequestTest, NumbersThatAreNone )
{
	for ( const char* bad : { ".nan", "nan", ".inf", "-.inf", "inf", "1e999", "one", "[1]", "" } )
	{
		SCOPED_TRACE( bad );
		std::string n = bad;
		expectBad( "start_state:\n  joint_state: {name: [a], position: [" + ( n.empty() ? "~" : n ) + "]}\n" + goal + group,
		    { "position[0]" } );
		expectBad( start + group +
		               "goal_constraints:\n  - joint_constraints:\n      - joint_name: a\n        position: " + n + "\n",
		    { "joint_constraints[0] a.position" } );
	}
	expectBad( start + group + "goal_constraints:\n  - joint_constraints:\n      - joint_name: a\n        position: .nan\n",
	    { "line 9" } );
}

TEST_F( RequestTest, ListsThatDisagree )
{
	expectBad( "start_state:\n  joint_state:\n    name: [a, b]\n    position: [0]\n" + goal + group,
	    { "2 names and 1 positions" } );
	expectBad(
	    "start_state:\n  joint_state:\n    name: [a, a]\n    position: [0, 1]\n" + goal + group, { "a is there twice" } );
	expectBad( start + group +
	               "goal_constraints: [{joint_constraints: [{joint_name: a, position: 1}, {joint_name: a, position: 2}]}]\n",
	    { "a is there twice" } );
	expectBad( start + start + goal + group, { "start_state", "twice" } );
}

TEST_F( RequestTest, UnsupportedPartsAreErrors )
{
	std::string head = start + group;
	expectBad( head + "goal_constraints: [{visibility_constraints: [{sensor_pose: {}}]}]\n",
	    { "goal_constraints[0].visibility_constraints[0]", "not supported" } );
	expectBad( head + goal + "path_constraints: {orientation_constraints: [{link_name: hand}]}\n",
	    { "path_constraints.orientation_constraints[0] hand" } );
	expectBad( head + goal + "path_constraints: {joint_constraints: [{joint_name: a}]}\n",
	    { "path_constraints.joint_constraints[0] a" } );
	EXPECT_NO_THROW( load( head + goal + "path_constraints: {orientation_constraints: []}\n" ) );
	expectBad(
	    group + goal + start + "  attached_collision_objects: [{link_name: hand}]\n", { "attached", "planning scene" } );
}

TEST_F( RequestTest, IgnoredPartsAreTold )
{
	Request request =
	    load( start + group + goal + "  - joint_constraints:\n      - {joint_name: a, position: 3}\ncolour: red\n" );
	EXPECT_DOUBLE_EQ( request.goal[0].position, 1 );
	EXPECT_NOTICE( request.notices, "2 alternative goals" );
	EXPECT_NOTICE( request.notices, "colour" );
}
