// SPDX-License-Identifier: BSD-3-Clause
// Position and orientation constraints of goals as MoveIt writes them, bad ones, and the frames that they name.
#include "files.hpp"

using namespace leeway;
using namespace leeway::io;

namespace
{

const std::string head = "group_name: arm\nstart_state: {joint_state: {name: [a], position: [0]}}\n";
const std::string region = "{primitives: [{type: sphere, dimensions: [0.01]}], primitive_poses: [{position: [1, 2, 3]}]}";

const std::string robot_head = "<robot name='r'><link name='base'><collision><geometry><sphere radius='0.1'/></geometry>"
                               "</collision></link><link name='hand'/>";

class PoseGoalTest : public FileTest
{
protected:
	Request load( const std::string& constraints )
	{
		return loadRequest( write( "request.yaml", head + "goal_constraints: [{" + constraints + "}]\n" ) );
	}
	Request position( const std::string& fields ) { return load( "position_constraints: [{" + fields + "}]" ); }
	Request orientation( const std::string& fields ) { return load( "orientation_constraints: [{" + fields + "}]" ); }
	void badPosition( const std::string& fields, std::vector<std::string> parts )
	{
		parts.push_back( "request.yaml" );
		expectError( [&] { position( fields ); }, parts );
	}
	void badOrientation( const std::string& fields, std::vector<std::string> parts )
	{
		parts.push_back( "request.yaml" );
		expectError( [&] { orientation( fields ); }, parts );
	}
};

} // namespace

/// As `ros2 topic echo` prints a goal of RViz: maps, numbers for types, all fields.
TEST_F( PoseGoalTest, EveryFieldOfAMessageIsRead )
{
	Request request = loadRequest( write( "request.yaml", head + R"(
goal_constraints:
- name: ''
  joint_constraints: []
  position_constraints:
  - header: {stamp: {sec: 0, nanosec: 0}, frame_id: /table}
    link_name: hand
    target_point_offset: {x: 0.1, y: 0.2, z: 0.3}
    constraint_region:
      primitives:
      - type: 1
        dimensions: [0.1, 0.2, 0.3]
        polygon: {points: []}
      - {type: 3, dimensions: [0.5, 0.25]}
      primitive_poses:
      - position: {x: 1.0, y: 2.0, z: 3.0}
        orientation: {x: 0.0, y: 0.0, z: 0.0, w: 1.0}
      - position: {x: 4.0, y: 5.0, z: 6.0}
      meshes: []
      mesh_poses: []
    weight: 1.0
  orientation_constraints:
  - header: {frame_id: base}
    orientation: {x: 0.0, y: 1.0, z: 0.0, w: 0.0}
    link_name: wrist
    absolute_x_axis_tolerance: 0.001
    absolute_y_axis_tolerance: 0.002
    absolute_z_axis_tolerance: 3.2
    parameterization: 1
    weight: 1.0
  visibility_constraints: []
)" ) );
	EXPECT_TRUE( request.notices.empty() ) << allNotices( request.notices );
	EXPECT_TRUE( request.hasPoseGoal() && request.goal.empty() );
	ASSERT_EQ( request.goal_positions.size(), 1u );
	const PositionGoal& position = request.goal_positions[0];
	EXPECT_EQ( position.link, "hand" );
	EXPECT_EQ( position.frame, "table" );
	EXPECT_EQ( position.offset, ( std::array<double, 3>{ 0.1, 0.2, 0.3 } ) );
	ASSERT_EQ( position.regions.size(), 2u );
	EXPECT_EQ( position.regions[0].type, GoalRegion::Type::Box );
	EXPECT_EQ( position.regions[0].size, ( std::array<double, 3>{ 0.1, 0.2, 0.3 } ) );
	EXPECT_EQ( position.regions[0].pose.t[1], 2 );
	EXPECT_EQ( position.regions[1].type, GoalRegion::Type::Cylinder );
	EXPECT_EQ( position.regions[1].size, ( std::array<double, 3>{ 0.25, 0.5, 0 } ) ) << "the message has the height first";
	ASSERT_EQ( request.goal_orientations.size(), 1u );
	const OrientationGoal& orientation = request.goal_orientations[0];
	EXPECT_EQ( orientation.link, "wrist" );
	EXPECT_EQ( orientation.frame, "base" );
	EXPECT_EQ( orientation.quaternion, ( std::array<double, 4>{ 0, 1, 0, 0 } ) );
	EXPECT_EQ( orientation.tolerance, ( std::array<double, 3>{ 0.001, 0.002, 3.2 } ) );
	EXPECT_EQ( orientation.parameterization, OrientationGoal::Parameterization::rotation_vector );
}

TEST_F( PoseGoalTest, JointConstraintsAreKeptBesidePoses )
{
	Request request = load( "joint_constraints: [{joint_name: a, position: 1, tolerance_above: 0.5}], position_constraints: "
	                        "[{link_name: hand, constraint_region: " +
	                        region + "}]" );
	EXPECT_EQ( request.goal.size(), 1u );
	EXPECT_EQ( request.goal_positions.size(), 1u );
	EXPECT_EQ( request.goal_positions[0].frame, "" );
}

TEST_F( PoseGoalTest, BadPositionConstraintsNameTheFieldAndTheLink )
{
	const std::string hand = "link_name: hand, constraint_region: ";
	badPosition( "constraint_region: " + region, { "position_constraints[0].link_name", "missing" } );
	badPosition( "link_name: '', constraint_region: " + region, { "link_name", "empty" } );
	badPosition( "link_name: hand", { "position_constraints[0] hand.constraint_region.primitives", "region is missing" } );
	badPosition( hand + "{primitives: [{type: sphere, dimensions: [0.1]}]}", { "1 primitives and 0 primitive_poses" } );
	badPosition( hand + "{primitives: [{type: cone, dimensions: [1, 1]}], primitive_poses: [{position: [0, 0, 0]}]}",
	    { "type cone", "box (1), sphere (2) or cylinder (3)" } );
	badPosition( hand + "{meshes: [{vertices: []}], mesh_poses: [{position: [0, 0, 0]}]}", { "meshes", "not supported" } );
	badPosition( hand + "{primitives: [{type: box, dimensions: [1, -1, 1]}], primitive_poses: [{position: [0, 0, 0]}]}",
	    { "dimensions", "-1 is negative" } );
	badPosition( hand + "{primitives: [{type: box, dimensions: [1, 1]}], primitive_poses: [{position: [0, 0, 0]}]}",
	    { "2 numbers, not 3" } );
	badPosition( hand + "{primitives: [{type: sphere, dimensions: [.nan]}], primitive_poses: [{position: [0, 0, 0]}]}",
	    { "not finite" } );
	badPosition( hand + region + ", target_point_ofset: [0, 0, 0]", { "target_point_offset" } );
}

TEST_F( PoseGoalTest, BadOrientationConstraintsNameTheFieldAndTheLink )
{
	badOrientation( "orientation: [0, 0, 0, 1]", { "link_name", "missing" } );
	badOrientation( "link_name: hand", { "orientation_constraints[0] hand.orientation", "missing" } );
	badOrientation( "link_name: hand, orientation: [0, 0, 0, 0]", { "hand.orientation", "zero" } );
	badOrientation( "link_name: hand, orientation: [0, 0, 0, 1], absolute_y_axis_tolerance: -0.1",
	    { "absolute_y_axis_tolerance", "-0.1 is negative" } );
	badOrientation( "link_name: hand, orientation: [0, 0, 0, 1], parameterization: 2", { "parameterization", "0 (XYZ" } );
	Request request = orientation( "link_name: hand, orientation: [0, 0, 3, 4]" );
	EXPECT_NOTICE( request.notices, "quaternion of length 5" );
	EXPECT_DOUBLE_EQ( request.goal_orientations[0].quaternion[3], 0.8 );
}

TEST_F( PoseGoalTest, NoGoalStateOfAPoseGoalIsMadeUpFromTheStart )
{
	write( "r.urdf", robot_head + "<joint name='a' type='continuous'>"
	                              "<parent link='base'/><child link='hand'/></joint></robot>" );
	RobotModel robot = loadRobot( path( "r.urdf" ), "" );
	Request request = position( "link_name: hand, constraint_region: " + region );
	request.goal_keeps_rest = true;
	Problem problem = buildProblem( robot, {} );
	expectError( [&] { goalState( problem, request ); }, { "goal_constraints[0]", "poses of links" } );
}

TEST_F( PoseGoalTest, FramesOfLinksObjectsAndFixedFramesAreFound )
{
	write( "r.urdf",
	    robot_head + "<joint name='a' type='prismatic'>"
	                 "<parent link='base'/><child link='hand'/><limit lower='0' upper='1' effort='1' velocity='1'/></joint>"
	                 "</robot>" );
	RobotModel robot = loadRobot( path( "r.urdf" ), "" );
	SceneModel scene = loadScene( write( "scene.yaml", R"(
world:
  collision_objects:
    - {id: box, pose: {position: [5, 0, 0]}, primitives: [{type: box, dimensions: [1, 1, 1]}]}
robot_state:
  attached_collision_objects:
    - {link_name: hand, object: {id: cup, pose: {position: [0, 0, 0.5]}, primitives: [{type: sphere, dimensions: [0.1]}]}}
fixed_frame_transforms:
  - {child_frame_id: camera, header: {frame_id: hand}, transform: {translation: [0, 1, 0], rotation: [0, 0, 0, 1]}}
  - {child_frame_id: lens, header: {frame_id: camera}, transform: {translation: [0, 2, 0], rotation: [0, 0, 0, 1]}}
  - {child_frame_id: lost, header: {frame_id: nowhere}, transform: {translation: [0, 2, 0], rotation: [0, 0, 0, 1]}}
)" ) );
	ProblemOptions options;
	options.scene = &scene;
	Problem problem = buildProblem( robot, options );
	const std::uint32_t hand = lw_robot_find_link( problem.robot.get(), "hand" );
	EXPECT_EQ( findFrame( problem, "hand", "f", "e" ).link, hand );
	EXPECT_EQ( findFrame( problem, "", "f", "e" ).link, LW_INVALID_INDEX );
	EXPECT_EQ( findFrame( problem, "world", "f", "e" ).link, LW_INVALID_INDEX );
	EXPECT_EQ( findFrame( problem, "/box", "f", "e" ).pose.t[0], 5 );
	const Frame lens = findFrame( problem, "lens", "f", "e" );
	EXPECT_EQ( lens.link, hand ) << "it moves with the hand";
	EXPECT_EQ( lens.pose.t[1], 3 );
	const Frame cup = findFrame( problem, "cup", "f", "e" );
	EXPECT_EQ( cup.pose.t[2], 0.5 );
	EXPECT_STREQ( lw_robot_link_name( problem.robot.get(), cup.link ), "cup" );
	expectError( [&] { findFrame( problem, "lost", "q.yaml", "goal" ); }, { "q.yaml", "frame lost is not known", "lens" } );
	expectError( [&] { findFrame( problem, "none", "q.yaml", "goal" ); }, { "frame none is not known", "camera" } );
}
