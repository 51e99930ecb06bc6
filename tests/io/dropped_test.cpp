// SPDX-License-Identifier: BSD-3-Clause
// Nothing is dropped silently: in random valid files each field in turn is removed, misspelt or changed. Then the model, the problem built of it, an
// error or a notice differs, or the field stands in a table here, with the reason why it says nothing.
#include "files.hpp"
#include "seeded_rng.hpp"

#include <fmt/format.h>
#include <tinyxml2.h>
#include <yaml-cpp/yaml.h>

#include <functional>
#include <map>
#include <optional>
#include <set>

using namespace leeway::io;

namespace
{

/// Fields without a meaning here, with all below them. Each of them has to be met: a field that gets a meaning leaves the table.
struct Meaningless
{
	const char *field, *why;
};
const std::vector<Meaningless> urdf_table = {
    { "robot/material", "colours are for pictures" },
    { "robot/link/visual", "what is seen is not what collides (--visual asks for it, with a notice)" },
    { "robot/link/inertial", "masses move no link" },
    { "robot/link/collision@name", "names of geometry are the author's" },
    { "robot/joint/dynamics", "friction and damping move no link" },
    { "robot/joint/calibration", "of the joint's sensor" },
    { "robot/joint/safety_controller", "bounds of a controller, within the limits of the joint" },
    { "robot/joint/limit@effort", "forces move no link" },
    { "robot/transmission", "of motors, for controllers" },
    { "robot/gazebo", "of a simulator" },
};
const std::vector<Meaningless> srdf_table = {
    { "robot/end_effector", "which group is a hand: no geometry, and no pair" },
    { "robot@name", "without a name it is taken to be of the robot at hand; another name is a notice" },
    { "robot/passive_joint", "a joint without a motor moves in its limits like others, if a group has it" },
};
const std::vector<Meaningless> scene_table = {
    { "robot_model_name", "the robot is named by --robot" },
    { "world.collision_objects[].operation", "ADD, the only one that is not refused, is the default" },
    { "allowed_collision_matrix.entry_values[=][=]", "a thing against itself" },
    { "world.collision_objects[].header.stamp", "when the message was sent" },
};
const std::vector<Meaningless> request_table = {
    { "planner_id", "which planner searches says nothing of the problem" },
    { "pipeline_id", "as planner_id" },
    { "num_planning_attempts", "how often to plan" },
    { "max_velocity_scaling_factor", "how fast to drive" },
    { "max_acceleration_scaling_factor", "how fast to drive" },
    { "workspace_parameters", "bounds a base that moves freely: here the limits of its joints do" },
    { "goal_constraints[].joint_constraints[].weight", "orders constraints that contradict each other" },
};

std::string text( const lw_transform& pose )
{
	std::string out;
	for ( const auto& row : pose.r )
	{
		out += fmt::format( "{} {} {} ", row[0], row[1], row[2] );
	}
	return out + fmt::format( "at {} {} {}", pose.t[0], pose.t[1], pose.t[2] );
}

std::string text( const std::vector<PlacedShape>& shapes )
{
	std::string out;
	for ( const PlacedShape& shape : shapes )
	{
		const lw_digest digest = lw_shape_digest( shape.shape.get() );
		out += fmt::format( " [{:x} {:x} {}]", digest.word[0], digest.word[1], text( shape.pose ) );
	}
	return out;
}

template <typename T> std::string all( const T& values )
{
	return fmt::format( "{}", fmt::join( values, ", " ) );
}

std::string text( const std::vector<Notice>& notices )
{
	std::string out;
	for ( const Notice& notice : notices )
	{
		out += "notice " + notice.element + ": " + notice.text + "\n";
	}
	return out;
}

std::string text( const RobotModel& model )
{
	std::string out = fmt::format( "{}: root {}, frame {}\n", model.name, model.root_link, model.planning_frame );
	for ( const LinkModel& link : model.links )
	{
		out += link.name + text( link.collision ) + "\n";
	}
	for ( const JointModel& joint : model.joints )
	{
		out += fmt::format( "{} {} {} {} {} axis {} {} {} limits {} {} {} mimic {} {} {}\n", joint.name, int( joint.type ),
		    joint.parent, joint.child, text( joint.parent_from_joint ), joint.axis[0], joint.axis[1], joint.axis[2],
		    joint.lower, joint.upper, joint.velocity, joint.mimic, joint.mimic_multiplier, joint.mimic_offset );
	}
	for ( const DisabledPair& pair : model.disabled )
	{
		out += fmt::format( "may touch {} {} {}\n", pair.link1, pair.link2, pair.reason );
	}
	for ( const Group& group : model.groups )
	{
		out += fmt::format( "group {}: {}; {}; {}\n", group.name, all( group.joints ), all( group.links ), group.defect );
	}
	for ( const GroupState& state : model.group_states )
	{
		out += fmt::format( "state {} {} {}:", state.name, state.group, state.defect );
		for ( const auto& [joint, values] : state.joints )
		{
			out += fmt::format( " {}={}", joint, all( values ) );
		}
		out += "\n";
	}
	return out + text( model.report.notices );
}

std::string text( const SceneModel& scene )
{
	std::string out = "scene " + scene.name + "\n";
	for ( const SceneObject& object : scene.objects )
	{
		out += fmt::format( "{} in {}{} {}\n", object.name, object.frame, text( object.shapes ), text( object.pose ) );
	}
	for ( const AttachedObject& held : scene.attached )
	{
		out += fmt::format( "{} in {}{} held by {}, touching {}\n", held.object.name, held.object.frame,
		    text( held.object.shapes ), held.link, all( held.touch_links ) );
	}
	for ( const auto& [names, kind] :
	    { std::pair( scene.default_allowed, "default" ), std::pair( scene.matrix_names, "matrix" ) } )
	{
		out += fmt::format( "{} {}\n", kind, all( names ) );
	}
	for ( const auto& [a, b] : scene.allowed )
	{
		out += fmt::format( "may touch {} {}\n", a, b );
	}
	for ( const auto& [variable, value] : scene.state.values )
	{
		out += fmt::format( "{}={}\n", variable, value );
	}
	for ( const auto& [child, frame] : scene.fixed_frames )
	{
		out += fmt::format( "frame {} {} {}\n", child, frame.first, text( frame.second ) );
	}
	for ( const auto* map : { &scene.link_padding, &scene.link_scale } )
	{
		for ( const auto& [link, value] : *map )
		{
			out += fmt::format( "link {} {}\n", link, value );
		}
	}
	return out + text( scene.report.notices );
}

std::string text( const Request& request )
{
	std::string out = fmt::format( "group {}, {} s\n", request.group, request.allowed_planning_time );
	for ( const auto& [variable, value] : request.start.values )
	{
		out += fmt::format( "start {}={}\n", variable, value );
	}
	for ( const JointGoal& goal : request.goal )
	{
		out += fmt::format( "goal {}={}+{}-{}\n", goal.joint, goal.position, goal.tolerance_above, goal.tolerance_below );
	}
	for ( const PositionGoal& goal : request.goal_positions )
	{
		out += fmt::format( "goal of {} in {}, {}:", goal.link, goal.frame, all( goal.offset ) );
		for ( const GoalRegion& region : goal.regions )
		{
			out += fmt::format( " {} {} {}", int( region.type ), all( region.size ), text( region.pose ) );
		}
		out += "\n";
	}
	for ( const OrientationGoal& goal : request.goal_orientations )
	{
		out += fmt::format( "goal of {} in {}: {} {} {}\n", goal.link, goal.frame, all( goal.quaternion ),
		    all( goal.tolerance ), int( goal.parameterization ) );
	}
	return out + text( request.notices );
}

/// The four files, and all that is known of them once they are read.
class DroppedTest : public FileTest
{
protected:
	std::string urdf, srdf, scene, request;

	/// The models, a problem of the group, and clearances at its start; or the error.
	std::string answer( const std::string& a_urdf, const std::string& a_srdf, const std::string& a_scene,
	    const std::string& a_request ) const
	{
		std::string out;
		try
		{
			const RobotModel robot = loadRobot( write( "r.urdf", a_urdf ), write( "r.srdf", a_srdf ) );
			out += text( robot );
			const SceneModel room = loadScene( write( "s.yaml", a_scene ) );
			out += text( room );
			const Request asked = loadRequest( write( "q.yaml", a_request ) );
			out += text( asked );
			ProblemOptions options;
			options.scene = &room;
			options.request = &asked;
			options.group = asked.group;
			const Problem problem = buildProblem( robot, options );
			const lw_digest digest = lw_robot_digest( problem.robot.get() );
			out += fmt::format( "{:x} {:x} {}\n", digest.word[0], digest.word[1], all( problem.variable_names ) ) +
			       text( problem.notices );
			for ( const auto& [name, pose] : problem.object_poses )
			{
				out += fmt::format( "{} {}\n", name, text( pose ) );
			}
			const std::vector<double> q = startState( problem );
			const leeway::Query query = leeway::makeQuery( problem.checker.get() );
			lw_state_result result;
			const lw_status status =
			    lw_checker_state( problem.checker.get(), query.get(), q.data(), LW_CHECK_BOTH, nullptr, false, &result );
			out += fmt::format( "{}: {} {} {}\n", all( q ), int( status ), result.environment.lower, result.self.lower );
			out += asked.hasPoseGoal() ? "" : all( goalState( problem, asked ) );
		}
		catch ( const Error& error )
		{
			out += std::string( "error: " ) + error.what();
		}
		return out;
	}

	/// Each field of one file. @param with the answer if that file has this text
	void expectNoneIsDropped( const std::vector<std::pair<std::string, std::string>>& mutants,
	    const std::vector<Meaningless>& table, std::set<std::string>& met,
	    const std::function<std::string( const std::string& )>& with, const std::string& good )
	{
		EXPECT_EQ( good.find( "error: " ), std::string::npos ) << good;
		for ( const auto& [field, content] : mutants )
		{
			const bool same = with( content ) == good;
			const std::string bare = field.substr( 0, field.find( ' ' ) );
			const Meaningless* entry = nullptr;
			for ( const Meaningless& candidate : table )
			{
				const std::string name = candidate.field;
				const bool below = bare.size() > name.size() && ( bare[name.size()] == '/' || bare[name.size()] == '@' ||
				                                                    bare[name.size()] == '.' || bare[name.size()] == '[' );
				entry = bare.compare( 0, name.size(), name ) == 0 && ( bare.size() == name.size() || below ) ? &candidate
				                                                                                             : entry;
			}
			EXPECT_TRUE( !same || entry != nullptr ) << field << " is dropped silently; the file was\n" << content;
			if ( same && entry != nullptr )
			{
				met.insert( entry->field );
			}
			++m_tried;
		}
	}
	static void expectAllMet( const std::vector<Meaningless>& table, const std::set<std::string>& met )
	{
		for ( const Meaningless& entry : table )
		{
			EXPECT_EQ( met.count( entry.field ), 1u )
			    << entry.field << " is in the table, and has a meaning or is in no file";
		}
	}

	int m_tried = 0;
};

// ---- random files ---------------------------------------------------------------------------------------------------------------

/// Never 0, so that removing it is a change.
std::string number( SeededRng& rng, double low, double high )
{
	return fmt::format( "{:.4f}", rng.uniform( low, high ) );
}

std::string three( SeededRng& rng, double low, double high, const char* between = " " )
{
	return number( rng, low, high ) + between + number( rng, low, high ) + between + number( rng, low, high );
}

std::string geometry( SeededRng& rng )
{
	switch ( rng.integer( 0, 2 ) )
	{
	case 0:
		return "<box size='" + three( rng, 0.01, 0.1 ) + "'/>";
	case 1:
		return "<sphere radius='" + number( rng, 0.01, 0.1 ) + "'/>";
	default:
		return "<cylinder radius='" + number( rng, 0.01, 0.1 ) + "' length='" + number( rng, 0.01, 0.1 ) + "'/>";
	}
}

std::string origin( SeededRng& rng, double low, double high, bool turned = true )
{
	const std::string place = "<origin xyz='" + three( rng, low, high ) + "'";
	return place + ( turned ? " rpy='" + three( rng, 0.1, 1 ) + "'/>" : "/>" );
}

std::string randomUrdf( SeededRng& rng )
{
	std::string out = "<robot name='r'><material name='red'><color rgba='1 0 0 1'/></material>";
	for ( int i = 0; i < 6; ++i )
	{
		out += fmt::format( "<link name='l{}'>", i );
		for ( int k = rng.integer( 1, 2 ); k > 0; --k )
		{
			const std::string form = geometry( rng );
			const bool turned = form.rfind( "<sphere", 0 ) != 0; // the turn of a ball changes no more than a rounding
			out += fmt::format( "<collision name='c{}'>", k ) + origin( rng, 0.01, 0.1, turned ) + "<geometry>" + form +
			       "</geometry></collision>";
		}
		out += "<visual>" + origin( rng, 0.1, 1 ) + "<geometry>" + geometry( rng ) +
		       "</geometry><material name='red'/></visual>";
		out += "<inertial><mass value='1'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link>";
	}
	const char* types[] = { "revolute", "prismatic", "continuous", "revolute", "fixed" };
	for ( int i = 1; i < 6; ++i )
	{
		const std::string type = types[i - 1];
		out += fmt::format( "<joint name='j{}' type='{}'><parent link='l{}'/><child link='l{}'/>", i, type, i - 1, i ) +
		       origin( rng, 0.3, 0.6 );
		out += type != "fixed" ? "<axis xyz='" + three( rng, 0.2, 1 ) + "'/>" : "";
		out += type == "revolute" || type == "prismatic"
		           ? "<limit lower='" + number( rng, -2, -1 ) + "' upper='" + number( rng, 1, 2 ) +
		                 "' effort='5' velocity='" + number( rng, 1, 2 ) + "'/>"
		           : "";
		out += i == 4 ? "<mimic joint='j1' multiplier='" + number( rng, 0.2, 0.9 ) + "' offset='" + number( rng, 0.1, 0.2 ) +
		                    "'/>"
		              : "";
		out += i == 1 ? "<dynamics damping='0.5' friction='0.25'/><calibration rising='0.5'/>"
		                "<safety_controller k_velocity='5' k_position='7' soft_lower_limit='-0.5' soft_upper_limit='0.5'/>"
		              : "";
		out += "</joint>";
	}
	return out +
	       "<transmission name='t'><type>simple</type><joint name='j1'/></transmission><gazebo reference='l1'><mu1>0.2</mu1></gazebo></robot>";
}

std::string randomSrdf( SeededRng& rng )
{
	return "<robot name='r'><virtual_joint name='v' type='fixed' parent_frame='world' child_link='l0'/>"
	       "<group name='arm'><joint name='j1'/><joint name='j2'/></group><group name='tail'><chain base_link='l2' tip_link='l5'/></group>"
	       "<group name='both'><group name='arm'/><link name='l3'/></group><group_state name='home' group='arm'><joint name='j1' value='" +
	       number( rng, 0.1, 0.5 ) + "'/><joint name='j2' value='" + number( rng, 0.1, 0.5 ) +
	       "'/></group_state><end_effector name='hand' parent_link='l4' group='tail'/><passive_joint name='j3'/>"
	       "<disable_collisions link1='l0' link2='l1' reason='Adjacent'/><disable_collisions link1='l1' link2='l3' reason='Never'/></robot>";
}

std::string vector( SeededRng& rng, double low, double high )
{
	return "[" + three( rng, low, high, ", " ) + "]";
}

std::string poseOf( SeededRng& rng, double low, double high )
{
	return "{position: " + vector( rng, low, high ) + ", orientation: [0.6, 0, 0, 0.8]}";
}

std::string randomScene( SeededRng& rng )
{
	return "name: room\nrobot_model_name: r\nworld:\n  collision_objects:\n    - id: box\n      header: {frame_id: l0, stamp: {sec: 3, nanosec: 5}}\n"
	       "      operation: ADD\n      pose: " +
	       poseOf( rng, 3, 4 ) + "\n      primitives: [{type: box, dimensions: " + vector( rng, 0.1, 0.3 ) +
	       "}, {type: sphere, dimensions: [" + number( rng, 0.1, 0.3 ) + "]}]\n      primitive_poses: [" +
	       poseOf( rng, 0.1, 1 ) + ", " + poseOf( rng, 0.1, 1 ) +
	       "]\n    - id: mesh\n      header: {frame_id: camera}\n      meshes: [{vertices: [[0, 0, 0], [1, 0, 0], [0, " +
	       number( rng, 1, 2 ) + ", 0]], triangles: [[0, 1, 2]]}]\n      mesh_poses: [" + poseOf( rng, 3, 4 ) +
	       "]\n    - id: cloud\n      leeway_shapes: [{type: spheres, spheres: [[5, 5, 5, 0.25]], pose: " +
	       poseOf( rng, 0.1, 1 ) +
	       "}]\nallowed_collision_matrix:\n  entry_names: [l5, mesh]\n  entry_values: [[false, true], [true, false]]\n"
	       "  default_entry_names: [cloud]\n  default_entry_values: [true]\nrobot_state:\n  joint_state: {name: [j3], position: [" +
	       number( rng, 0.1, 0.5 ) +
	       "]}\n  attached_collision_objects:\n    - link_name: l5\n      touch_links: [l4]\n      object: {id: cup, header: {frame_id: l5}, primitives: "
	       "[{type: cylinder, dimensions: [0.1, 0.05]}], primitive_poses: [" +
	       poseOf( rng, 0.1, 0.2 ) +
	       "]}\nfixed_frame_transforms: [{header: {frame_id: world}, child_frame_id: camera, transform: {translation: " +
	       vector( rng, 0.1, 0.5 ) +
	       ", rotation: [0.6, 0, 0, 0.8]}}]\nlink_padding: [{link_name: l1, padding: " + number( rng, 0.01, 0.02 ) +
	       "}]\nlink_scale: [{link_name: l2, scale: " + number( rng, 1.1, 1.2 ) + "}]\n";
}

std::string randomRequest( SeededRng& rng, bool pose_goal )
{
	const std::string joints = "      - {joint_name: j1, position: " + number( rng, 0.1, 0.5 ) +
	                           ", tolerance_above: 0.01, tolerance_below: 0.02, weight: 0.5}\n"
	                           "      - {joint_name: j2, position: " +
	                           number( rng, 0.1, 0.5 ) + "}\n";
	const std::string poses =
	    "    position_constraints:\n      - {header: {frame_id: world}, link_name: l5, target_point_offset: {x: 0.1, y: 0.2, z: 0.3}, "
	    "constraint_region: {primitives: [{type: box, dimensions: [0.1, 0.2, 0.3]}], primitive_poses: [" +
	    poseOf( rng, 0.1, 1 ) +
	    "]}}\n    orientation_constraints:\n      - {header: {frame_id: world}, link_name: l5, orientation: [0.6, 0, 0, "
	    "0.8], absolute_x_axis_tolerance: 0.1, absolute_y_axis_tolerance: 0.2, absolute_z_axis_tolerance: 0.3}\n";
	return "group_name: arm\nplanner_id: RRTConnect\npipeline_id: ompl\nnum_planning_attempts: 3\nallowed_planning_time: 7\n"
	       "max_velocity_scaling_factor: 0.5\nmax_acceleration_scaling_factor: 0.5\nworkspace_parameters: {min_corner: {x: -1, y: -1, z: -1}, max_corner: {x: 1, y: "
	       "1, z: 1}}\nstart_state:\n  joint_state: {name: [j1, j2], position: [" +
	       number( rng, 0.1, 0.5 ) + ", " + number( rng, 0.1, 0.5 ) + "]}\ngoal_constraints:\n  - joint_constraints:\n" +
	       joints + ( pose_goal ? poses : "" );
}

// ---- one field less, or another --------------------------------------------------------------------------------------------------

/// A number with 1/16 added to its last component; a word with a letter more.
std::string changed( const std::string& value )
{
	const std::size_t begin = value.find_last_of( " " ) == std::string::npos ? 0 : value.find_last_of( " " ) + 1;
	char* end = nullptr;
	const double last = std::strtod( value.c_str() + begin, &end );
	return end != value.c_str() + begin && *end == '\0' ? value.substr( 0, begin ) + fmt::format( "{}", last + 0.0625 )
	       : value == "true"                            ? "false"
	       : value == "false"                           ? "true"
	                                                    : value + "x";
}

/// The second letter is lost.
std::string misspelt( const std::string& name )
{
	return name.substr( 0, 1 ) + name.substr( 2 );
}

using Mutants = std::vector<std::pair<std::string, std::string>>; ///< "field how" and the text

/// Elements in document order.
std::vector<tinyxml2::XMLElement*> elementsOf( tinyxml2::XMLElement* root )
{
	std::vector<tinyxml2::XMLElement*> out = { root };
	for ( std::size_t i = 0; i < out.size(); ++i )
	{
		for ( tinyxml2::XMLElement* child = out[i]->FirstChildElement(); child != nullptr;
		      child = child->NextSiblingElement() )
		{
			out.push_back( child );
		}
	}
	return out;
}

std::string placeOf( const tinyxml2::XMLNode* element )
{
	const tinyxml2::XMLNode* parent = element->Parent();
	return ( parent != nullptr && parent->ToElement() != nullptr ? placeOf( parent ) + "/" : std::string() ) +
	       element->Value();
}

Mutants mutantsOfXml( const std::string& good )
{
	Mutants out;
	tinyxml2::XMLDocument first;
	first.Parse( good.c_str() );
	const std::size_t count = elementsOf( first.RootElement() ).size();
	const auto mutate = [&]( std::size_t index, const std::function<std::string( tinyxml2::XMLElement& )>& change )
	{
		tinyxml2::XMLDocument copy;
		copy.Parse( good.c_str() );
		const std::string field = change( *elementsOf( copy.RootElement() )[index] );
		tinyxml2::XMLPrinter printer;
		copy.Print( &printer );
		out.emplace_back( field, printer.CStr() );
	};
	for ( std::size_t i = 0; i < count; ++i )
	{
		const tinyxml2::XMLElement& element = *elementsOf( first.RootElement() )[i];
		for ( const tinyxml2::XMLAttribute* a = element.FirstAttribute(); a != nullptr; a = a->Next() )
		{
			const std::string name = a->Name(), value = a->Value();
			mutate( i,
			    [&]( tinyxml2::XMLElement& e )
			    {
				    e.DeleteAttribute( name.c_str() );
				    return placeOf( &e ) + "@" + name + " removed";
			    } );
			mutate( i,
			    [&]( tinyxml2::XMLElement& e )
			    {
				    e.SetAttribute( name.c_str(), changed( value ).c_str() );
				    return placeOf( &e ) + "@" + name + " changed from " + value;
			    } );
			mutate( i,
			    [&]( tinyxml2::XMLElement& e )
			    {
				    e.DeleteAttribute( name.c_str() );
				    e.SetAttribute( misspelt( name ).c_str(), value.c_str() );
				    return placeOf( &e ) + "@" + name + " misspelt";
			    } );
		}
		if ( i > 0 )
		{
			mutate( i,
			    [&]( tinyxml2::XMLElement& e )
			    {
				    const std::string field = placeOf( &e ) + " removed";
				    e.Parent()->DeleteChild( &e );
				    return field;
			    } );
			mutate( i,
			    [&]( tinyxml2::XMLElement& e )
			    {
				    const std::string field = placeOf( &e ) + " misspelt";
				    e.SetName( misspelt( e.Name() ).c_str() );
				    return field;
			    } );
		}
	}
	return out;
}

/// A step into a YAML node: a key, or an index.
struct Step
{
	std::string key;
	std::size_t index = 0;
};

YAML::Node at( const YAML::Node& root, const std::vector<Step>& path )
{
	YAML::Node node;
	node.reset( root );
	for ( const Step& step : path )
	{
		const YAML::Node parent = node;
		node.reset( step.key.empty() ? parent[step.index] : parent[step.key] );
	}
	return node;
}

void addMutants( const YAML::Node& root, std::vector<Step> path, const std::string& field, Mutants& out )
{
	const YAML::Node here = at( root, path );
	if ( !path.empty() )
	{
		const YAML::Node copy = YAML::Clone( root );
		const Step last = path.back();
		YAML::Node parent = at( copy, { path.begin(), path.end() - 1 } );
		if ( last.key.empty() )
		{
			YAML::Node shorter( YAML::NodeType::Sequence );
			for ( std::size_t i = 0; i < parent.size(); ++i )
			{
				if ( i != last.index )
				{
					shorter.push_back( parent[i] );
				}
			}
			shorter.SetStyle( YAML::EmitterStyle::Flow );
			parent = shorter;
		}
		else
		{
			parent.remove( last.key );
		}
		out.emplace_back( field + " removed", YAML::Dump( copy ) + "\n" );
		if ( last.key.size() > 3 )
		{
			const YAML::Node other = YAML::Clone( root );
			YAML::Node map = at( other, { path.begin(), path.end() - 1 } );
			map[misspelt( last.key )] = map[last.key];
			map.remove( last.key );
			out.emplace_back( field + " misspelt", YAML::Dump( other ) + "\n" );
		}
	}
	if ( here.IsScalar() )
	{
		const YAML::Node copy = YAML::Clone( root );
		at( copy, path ) = changed( here.Scalar() );
		out.emplace_back( field + " changed from " + here.Scalar(), YAML::Dump( copy ) + "\n" );
	}
	for ( std::size_t i = 0; here.IsSequence() && i < here.size(); ++i )
	{
		path.push_back( { "", i } );
		const bool diagonal = path.size() > 1 && path[path.size() - 2].key.empty() && path[path.size() - 2].index == i;
		addMutants( root, path, diagonal ? field.substr( 0, field.size() - 2 ) + "[=][=]" : field + "[]", out );
		path.pop_back();
	}
	for ( auto entry = here.begin(); here.IsMap() && entry != here.end(); ++entry )
	{
		path.push_back( { entry->first.Scalar(), 0 } );
		addMutants( root, path, ( field.empty() ? "" : field + "." ) + entry->first.Scalar(), out );
		path.pop_back();
	}
}

Mutants mutantsOfYaml( const std::string& good )
{
	Mutants out;
	addMutants( YAML::Load( good ), {}, "", out );
	return out;
}

} // namespace

TEST_F( DroppedTest, AFieldOfAFileHasNoSay )
{
	SeededRng rng;
	std::set<std::string> met[4];
	for ( int i = 0; i < 2; ++i )
	{
		urdf = randomUrdf( rng );
		srdf = randomSrdf( rng );
		scene = randomScene( rng );
		request = randomRequest( rng, i == 1 );
		const std::string good = answer( urdf, srdf, scene, request );
		expectNoneIsDropped(
		    mutantsOfXml( urdf ), urdf_table, met[0],
		    [&]( const std::string& t ) { return answer( t, srdf, scene, request ); }, good );
		expectNoneIsDropped(
		    mutantsOfXml( srdf ), srdf_table, met[1],
		    [&]( const std::string& t ) { return answer( urdf, t, scene, request ); }, good );
		expectNoneIsDropped(
		    mutantsOfYaml( scene ), scene_table, met[2],
		    [&]( const std::string& t ) { return answer( urdf, srdf, t, request ); }, good );
		expectNoneIsDropped(
		    mutantsOfYaml( request ), request_table, met[3],
		    [&]( const std::string& t ) { return answer( urdf, srdf, scene, t ); }, good );
	}
	expectAllMet( urdf_table, met[0] );
	expectAllMet( srdf_table, met[1] );
	expectAllMet( scene_table, met[2] );
	expectAllMet( request_table, met[3] );
	EXPECT_GT( m_tried, 1500 );
	std::printf( "%d fields removed or changed\n", m_tried );
}
