// SPDX-License-Identifier: BSD-3-Clause
// A problem from its parts: robot with attached objects, scene in the planning frame, reference state, allowed contacts.
//
// Contacts between links: the SRDF allows the pairs that it lists; a planning scene's matrix can allow more. A "false" in
// the matrix does not forbid a pair of the SRDF: the MotionBenchMaker matrices were written for other link sets than the
// SRDFs beside them, and ground truth made with the SRDF agrees with this reading only. A notice reports such entries.
#include "leeway/prepare.hpp"
#include "scene/frames.hpp"
#include "scene/group.hpp"
#include "scene/margins.hpp"
#include "scene/padding.hpp"
#include "robot/plausibility.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <set>

namespace leeway::io
{

namespace
{

using detail::Frames;
using detail::joinNames;

std::vector<std::string> jointSuffixes( lw_joint_type type )
{
	switch ( type )
	{
	case LW_JOINT_PLANAR:
		return { "/x", "/y", "/theta" };
	case LW_JOINT_FLOATING:
		return { "/trans_x", "/trans_y", "/trans_z", "/rot_x", "/rot_y", "/rot_z", "/rot_w" };
	default:
		return { "" };
	}
}

// ---- reference state

/// Sets variables of a state by name and remembers the names that the robot has no use for.
class StateWriter
{
public:
	StateWriter( const RobotModel& model, const lw_robot* robot, std::vector<double>& q ) : m_model( model ), m_q( q )
	{
		for ( std::uint32_t i = 0; i < lw_robot_variable_count( robot ); ++i )
		{
			m_index[variableName( robot, i )] = i;
		}
	}

	void apply( const JointState& state, const std::string& file, const std::string& element, std::vector<Notice>& notices );

private:
	/// A planar joint takes x, y and the yaw of a multi_dof transform; true if `joint` is planar.
	bool applyPlanar( const std::string& joint, const JointState& state, const std::string& file, const std::string& element,
	    std::vector<Notice>& notices );

	const RobotModel& m_model;
	std::vector<double>& m_q;
	std::map<std::string, std::uint32_t> m_index;
};

bool StateWriter::applyPlanar( const std::string& joint, const JointState& state, const std::string& file,
    const std::string& element, std::vector<Notice>& notices )
{
	auto model = std::find_if( m_model.joints.begin(), m_model.joints.end(),
	    [&]( const JointModel& candidate ) { return candidate.name == joint && candidate.type == LW_JOINT_PLANAR; } );
	if ( model == m_model.joints.end() || !model->mimic.empty() )
	{
		return false;
	}
	if ( model->axis[0] != 0 || model->axis[1] != 0 || !( model->axis[2] > 0 ) )
	{
		throw Error( file, element, fmt::format( "a transform cannot set the planar joint {}, whose axis is not z", joint ),
		    fmt::format( "give {0}/x, {0}/y and {0}/theta", joint ) );
	}
	auto value = [&]( const char* suffix, double fallback )
	{
		auto found = state.values.find( joint + suffix );
		return found != state.values.end() ? found->second : fallback;
	};
	double z = value( "/trans_z", 0 ), x_turn = value( "/rot_x", 0 ), y_turn = value( "/rot_y", 0 );
	std::uint32_t first = m_index.at( joint + "/x" );
	m_q[first] = value( "/trans_x", 0 );
	m_q[first + 1] = value( "/trans_y", 0 );
	m_q[first + 2] = std::remainder( 2 * std::atan2( value( "/rot_z", 0 ), value( "/rot_w", 1 ) ), 2 * detail::pi );
	// A planar joint cannot follow the rest of the transform; below a micrometre or microradian it is rounding
	if ( std::fabs( z ) > 1e-6 || std::hypot( x_turn, y_turn ) > 1e-6 )
	{
		notices.push_back(
		    { file, element, fmt::format( "planar joint {} takes only x, y and yaw of its transform", joint ) } );
	}
	return true;
}

void StateWriter::apply(
    const JointState& state, const std::string& file, const std::string& element, std::vector<Notice>& notices )
{
	std::vector<std::string> ignored;
	std::set<std::string> planar;
	for ( const auto& [name, value] : state.values )
	{
		auto found = m_index.find( name );
		if ( found != m_index.end() )
		{
			m_q[found->second] = value;
			continue;
		}
		std::string joint = name.substr( 0, name.rfind( '/' ) );
		if ( planar.count( joint ) != 0 )
		{
			continue;
		}
		if ( joint != name && applyPlanar( joint, state, file, element, notices ) )
		{
			planar.insert( joint );
		}
		else if ( ignored.empty() || ignored.back() != joint )
		{
			ignored.push_back( joint );
		}
	}
	if ( !ignored.empty() )
	{
		notices.push_back( { file, element,
		    fmt::format(
		        "joints that the robot lacks, fixes or drives by another joint were ignored: {}", joinNames( ignored ) ) } );
	}
}

// ---- allowed contacts

/// An attached object: shapes in the frame of the link it hangs on.
struct AttachedLink
{
	std::string name, parent;
	std::vector<PlacedShape> shapes;
};

/// Collects allowed pairs by name; each name is a link (attached objects are links) or an object of the scene.
class Contacts
{
public:
	Contacts( const RobotModel& model, const std::vector<AttachedLink>& attached, const SceneModel* scene );
	void allow( const std::string& a, const std::string& b );
	/// Names that are neither link nor object.
	std::vector<std::string> unknown( const std::vector<std::string>& names ) const;
	void allowMatrix( const RobotModel& model, const SceneModel& scene, std::vector<Notice>& notices );

	std::vector<std::pair<std::string, std::string>> links;
	std::vector<std::pair<std::string, std::string>> link_objects; ///< link first

private:
	bool isLink( const std::string& name ) const { return m_links.count( name ) != 0; }
	bool isObject( const std::string& name ) const { return m_objects.count( name ) != 0; }

	std::set<std::string> m_links, m_objects;
};

Contacts::Contacts( const RobotModel& model, const std::vector<AttachedLink>& attached, const SceneModel* scene )
{
	for ( const LinkModel& link : model.links )
	{
		m_links.insert( link.name );
	}
	for ( const AttachedLink& link : attached )
	{
		m_links.insert( link.name );
	}
	for ( std::size_t i = 0; scene != nullptr && i < scene->objects.size(); ++i )
	{
		m_objects.insert( scene->objects[i].name );
	}
	for ( const DisabledPair& pair : model.disabled )
	{
		allow( pair.link1, pair.link2 );
	}
}

void Contacts::allow( const std::string& a, const std::string& b )
{
	if ( a == b )
	{
		return;
	}
	if ( isLink( a ) && isLink( b ) )
	{
		links.emplace_back( a, b );
	}
	// A link and an object may share a name; a contact is then allowed in both readings
	if ( isLink( a ) && isObject( b ) )
	{
		link_objects.emplace_back( a, b );
	}
	if ( isObject( a ) && isLink( b ) )
	{
		link_objects.emplace_back( b, a );
	}
}

std::vector<std::string> Contacts::unknown( const std::vector<std::string>& names ) const
{
	std::vector<std::string> result;
	std::copy_if( names.begin(), names.end(), std::back_inserter( result ),
	    [&]( const std::string& name ) { return !isLink( name ) && !isObject( name ); } );
	return result;
}

void Contacts::allowMatrix( const RobotModel& model, const SceneModel& scene, std::vector<Notice>& notices )
{
	std::set<std::pair<std::string, std::string>> allowed;
	for ( const auto& [a, b] : scene.allowed )
	{
		allow( a, b );
		allowed.insert( std::minmax( a, b ) );
	}
	std::set<std::string> decided( scene.matrix_names.begin(), scene.matrix_names.end() );
	for ( const std::string& name : scene.default_allowed )
	{
		for ( const std::set<std::string>* others : { &m_links, &m_objects } )
		{
			for ( const std::string& other : *others )
			{
				// An entry of the matrix is more specific than a default
				if ( decided.count( name ) == 0 || decided.count( other ) == 0 )
				{
					allow( name, other );
				}
			}
		}
	}
	std::vector<std::string> forbidden;
	for ( const DisabledPair& pair : model.disabled )
	{
		bool listed = decided.count( pair.link1 ) != 0 && decided.count( pair.link2 ) != 0;
		if ( listed && allowed.count( std::minmax( pair.link1, pair.link2 ) ) == 0 )
		{
			forbidden.push_back( pair.link1 + " - " + pair.link2 );
		}
	}
	if ( !forbidden.empty() )
	{
		notices.push_back( { scene.file, "allowed_collision_matrix",
		    fmt::format( "pairs that the SRDF allows and the matrix does not stay allowed: {}", joinNames( forbidden ) ) } );
	}
	std::vector<std::string> names = scene.matrix_names;
	names.insert( names.end(), scene.default_allowed.begin(), scene.default_allowed.end() );
	std::vector<std::string> strangers = unknown( names );
	if ( !strangers.empty() )
	{
		notices.push_back( { scene.file, "allowed_collision_matrix",
		    fmt::format( "names of no link or object were ignored: {}", joinNames( strangers ) ) } );
	}
}

// ---- assembly

std::vector<AttachedLink> attachedLinks( const RobotModel& model, const SceneModel& scene, const lw_robot* robot,
    const Frames& frames, std::map<std::string, lw_transform>& object_poses )
{
	std::vector<AttachedLink> links;
	for ( const AttachedObject& attached : scene.attached )
	{
		std::string element = "attached object " + attached.object.name;
		if ( lw_robot_find_link( robot, attached.link.c_str() ) == LW_INVALID_INDEX )
		{
			throw Error( scene.file, element, fmt::format( "robot {} has no link {}", model.name, attached.link ),
			    "attach it to a link of the robot" );
		}
		if ( lw_robot_find_link( robot, attached.object.name.c_str() ) != LW_INVALID_INDEX )
		{
			throw Error( scene.file, element, "a link of the robot has this name", "rename the object" );
		}
		AttachedLink link{ attached.object.name, attached.link, attached.object.shapes };
		lw_transform link_from_object = attached.object.pose;
		if ( !attached.object.frame.empty() && attached.object.frame != attached.link )
		{
			lw_transform planning_from_link = frames.planningFrom( attached.link, scene.file, element );
			lw_transform planning_from_frame = frames.planningFrom( attached.object.frame, scene.file, element );
			lw_transform link_from_planning = lw_transform_inverse( &planning_from_link );
			lw_transform link_from_frame = lw_transform_multiply( &link_from_planning, &planning_from_frame );
			for ( PlacedShape& shape : link.shapes )
			{
				shape.pose = lw_transform_multiply( &link_from_frame, &shape.pose );
			}
			link_from_object = lw_transform_multiply( &link_from_frame, &link_from_object );
		}
		object_poses.emplace( attached.object.name, link_from_object );
		links.push_back( std::move( link ) );
	}
	return links;
}

/// The robot as it is without attached objects.
Robot createBareRobot( const RobotModel& model, const Contacts& contacts )
{
	std::set<std::string> names;
	for ( const LinkModel& link : model.links )
	{
		names.insert( link.name );
	}
	std::vector<std::pair<std::string, std::string>> allowed;
	std::copy_if( contacts.links.begin(), contacts.links.end(), std::back_inserter( allowed ),
	    [&]( const std::pair<std::string, std::string>& pair )
	    { return names.count( pair.first ) != 0 && names.count( pair.second ) != 0; } );
	return detail::createRobot( model, allowed );
}

/// Attaches the objects one after the other: their meshes are shared, and tables of the bare robot serve on.
void attachAll(
    const std::vector<AttachedLink>& attached, const Contacts& contacts, const SceneModel* scene, Problem& problem )
{
	for ( const AttachedLink& object : attached )
	{
		const lw_robot* robot = problem.robot.get();
		std::vector<std::uint32_t> touch;
		for ( const auto& [a, b] : contacts.links )
		{
			const std::string& other = a == object.name ? b : a;
			const std::uint32_t link = lw_robot_find_link( robot, other.c_str() );
			if ( ( a == object.name || b == object.name ) &&
			     link != LW_INVALID_INDEX ) // one that comes later sees to it itself
			{
				touch.push_back( link );
			}
		}
		std::vector<const lw_shape*> shapes;
		std::vector<lw_transform> poses;
		for ( const PlacedShape& shape : object.shapes )
		{
			shapes.push_back( shape.shape.get() );
			poses.push_back( shape.pose );
		}
		lw_attachment_def def = lw_attachment_def_default();
		def.name = object.name.c_str();
		def.link = lw_robot_find_link( robot, object.parent.c_str() );
		def.shapes = shapes.data();
		def.link_from_shape = poses.data();
		def.shape_count = static_cast<std::uint32_t>( shapes.size() );
		def.touch_links = touch.data();
		def.touch_link_count = static_cast<std::uint32_t>( touch.size() );
		lw_robot* with = nullptr;
		lw_diag diag{};
		lw_status status = lw_robot_attach( robot, &def, nullptr, &diag, &with );
		if ( status != LW_OK )
		{
			throw Error( scene->file, "attached object " + object.name,
			    diag.message[0] != '\0' ? diag.message : lw_status_name( status ), "correct the object" );
		}
		problem.robot = Robot::adopt( with );
	}
}

Scene createScene( const SceneModel& model, const Frames& frames, std::map<std::string, lw_transform>& object_poses )
{
	std::vector<const char*> names;
	std::vector<lw_scene_shape_def> shapes;
	std::vector<std::string> shape_owner;
	for ( const SceneObject& object : model.objects )
	{
		std::uint32_t index = static_cast<std::uint32_t>( names.size() );
		names.push_back( object.name.c_str() );
		lw_transform planning_from_frame = frames.planningFrom( object.frame, model.file, "object " + object.name );
		object_poses.emplace( object.name, lw_transform_multiply( &planning_from_frame, &object.pose ) );
		for ( const PlacedShape& shape : object.shapes )
		{
			shapes.push_back( { shape.shape.get(), index, lw_transform_multiply( &planning_from_frame, &shape.pose ) } );
			shape_owner.push_back( object.name );
		}
	}
	lw_scene_def def = lw_scene_def_default();
	def.object_names = names.data();
	def.object_count = static_cast<std::uint32_t>( names.size() );
	def.shapes = shapes.data();
	def.shape_count = static_cast<std::uint32_t>( shapes.size() );
	lw_scene* scene = nullptr;
	lw_diag diag{};
	diag.index = LW_INVALID_INDEX;
	lw_status status = lw_scene_create( &def, nullptr, &diag, &scene );
	if ( status != LW_OK )
	{
		std::string element = diag.index < shape_owner.size() ? "object " + shape_owner[diag.index] : "world";
		throw Error(
		    model.file, element, diag.message[0] != '\0' ? diag.message : lw_status_name( status ), "correct the scene" );
	}
	return Scene::adopt( scene );
}

/// Contact of a link that the group cannot move with an obstacle makes every state invalid: one notice reports this.
void noticeStaticContact( const RobotModel& model, const SceneModel* scene, const ProblemOptions& options, Problem& problem )
{
	lw_clearance fixed = lw_checker_get_info( problem.checker.get() ).static_environment;
	if ( scene != nullptr && fixed.upper <= options.min_d )
	{
		const double margin = lw_checker_environment_margin( problem.checker.get(), fixed.a, fixed.b );
		problem.notices.push_back( { scene->file, problem.group.empty() ? "robot " + model.name : "group " + problem.group,
		    fmt::format( "no state is valid: link {}, which stands still, is {} m from {}{}",
		        lw_robot_link_name( problem.robot.get(), fixed.a ), std::fmax( 0, fixed.upper + margin ),
		        lw_scene_object_name( problem.scene.get(), fixed.b ),
		        margin > 0 ? fmt::format( ", and their margin is {} m", margin ) : "" ) } );
	}
}

void createChecker( const RobotModel& model, const SceneModel* scene, const Contacts& contacts,
    const ProblemOptions& options, Problem& problem )
{
	for ( const auto& [link, object] : contacts.link_objects )
	{
		problem.allowed.push_back( { lw_robot_find_link( problem.robot.get(), link.c_str() ),
		    lw_scene_find_object( problem.scene.get(), object.c_str() ) } );
	}
	std::set<std::string> attached;
	for ( std::size_t i = 0; scene != nullptr && i < scene->attached.size(); ++i )
	{
		attached.insert( scene->attached[i].object.name );
	}
	const detail::BoundMargins margins =
	    detail::bindMargins( options.margins, problem, attached, contacts.link_objects, problem.notices );
	lw_checker_def def = lw_checker_def_default();
	def.margins = margins.def();
	def.max_d = options.max_d;
	unsigned threads = options.threads;
	def.prepare = threads > 1 ? makeShapes : nullptr;
	def.prepare_user = &threads;
	detail::makeChecker( def, scene != nullptr ? scene->file : model.urdf_file,
	    problem.group.empty() ? "robot " + model.name : "group " + problem.group,
	    "correct the robot, the group or the state", problem );
	noticeStaticContact( model, scene, options, problem );
}

void findReach( const ProblemOptions& options, Problem& problem )
{
	if ( options.reach )
	{
		problem.reach.reach = options.reach;
	}
	else if ( options.find_reach )
	{
		problem.reach = loadReach( problem.robot, *options.find_reach );
		problem.notices.insert( problem.notices.end(), problem.reach.notices.begin(), problem.reach.notices.end() );
	}
}

/// Goal joints that the robot has no variable for are ignored by goalState(); said once here.
void noticeGoalJoints( const Request& request, const lw_robot* robot, std::vector<Notice>& notices )
{
	std::set<std::string> variables;
	for ( std::uint32_t i = 0; i < lw_robot_variable_count( robot ); ++i )
	{
		variables.insert( variableName( robot, i ) );
	}
	std::vector<std::string> ignored;
	for ( const JointGoal& goal : request.goal )
	{
		if ( variables.count( goal.joint ) == 0 )
		{
			ignored.push_back( goal.joint );
		}
	}
	if ( !ignored.empty() )
	{
		notices.push_back( { request.file, "goal_constraints[0]",
		    fmt::format(
		        "joints that the robot lacks, fixes or drives by another joint were ignored: {}", joinNames( ignored ) ) } );
	}
}

/// The scene with the half-spaces of the robot's own links (the ground of an MJCF), each an object with the name of its link;
/// nothing if the robot has none.
std::optional<SceneModel> withGround( const RobotModel& model, const SceneModel* scene )
{
	std::vector<SceneObject> ground;
	for ( const LinkModel& link : model.links )
	{
		SceneObject object;
		object.name = link.name;
		object.frame = link.name;
		std::copy_if(
		    link.collision.begin(), link.collision.end(), std::back_inserter( object.shapes ), detail::isUnbounded );
		if ( !object.shapes.empty() )
		{
			ground.push_back( std::move( object ) );
		}
	}
	if ( ground.empty() )
	{
		return std::nullopt;
	}
	SceneModel with = scene != nullptr ? *scene : SceneModel();
	with.file = scene != nullptr ? with.file : model.urdf_file;
	for ( SceneObject& object : ground )
	{
		const bool taken = std::any_of( with.objects.begin(), with.objects.end(),
		    [&]( const SceneObject& other ) { return other.name == object.name; } );
		if ( taken )
		{
			throw Error( with.file, "object " + object.name, fmt::format( "{} has a plane of this name", model.urdf_file ),
			    "rename the object" );
		}
		with.objects.push_back( std::move( object ) );
	}
	return with;
}

/// The state in which an MJCF places its bodies: at zero, free ones would stand in each other. Nothing for other robots.
JointState initialState( const RobotModel& model )
{
	JointState initial;
	const auto state = std::find_if( model.group_states.begin(), model.group_states.end(),
	    [&]( const GroupState& one ) { return one.name == "qpos0" && one.group == "all" && one.defect.empty(); } );
	for ( const JointModel& joint : model.joints )
	{
		const std::vector<std::string> names = variableNames( joint );
		const bool given = state != model.group_states.end() && state->joints.count( joint.name ) != 0;
		for ( std::size_t i = 0; given && i < names.size() && i < state->joints.at( joint.name ).size(); ++i )
		{
			initial.values[names[i]] = state->joints.at( joint.name )[i];
		}
	}
	return initial;
}

} // namespace

Robot buildRobot( const RobotModel& model )
{
	return detail::createRobot( model, Contacts( model, {}, nullptr ).links );
}

Problem buildProblem( const RobotModel& unscaled, const ProblemOptions& options )
{
	Problem problem;
	problem.padding = detail::paddingOf( unscaled, options );
	std::optional<RobotModel> scaled;
	if ( !problem.padding.link_scale.empty() )
	{
		scaled = detail::scaledRobot( unscaled, problem.padding );
	}
	const RobotModel& model = scaled ? *scaled : unscaled;
	// First without attached objects: they add no variable, and where they are may depend on the state
	problem.robot = detail::createRobot( model, {} );
	const lw_robot* bare = problem.robot.get();
	problem.reference.resize( lw_robot_variable_count( bare ) );
	lw_robot_default_state( bare, problem.reference.data() );
	StateWriter writer( model, bare, problem.reference );
	writer.apply( initialState( model ), model.urdf_file, "qpos0", problem.notices );
	const std::optional<SceneModel> grounded = withGround( model, options.scene );
	const SceneModel* scene = grounded ? &*grounded : options.scene;
	if ( scene != nullptr )
	{
		writer.apply( scene->state, scene->file, "robot_state", problem.notices );
	}
	if ( options.request != nullptr )
	{
		writer.apply( options.request->start, options.request->file, "start_state", problem.notices );
		noticeGoalJoints( *options.request, bare, problem.notices );
	}
	writer.apply( options.overrides, "", "joint values", problem.notices );

	Frames frames( model, bare, problem.reference, scene, problem.notices );
	problem.frames = frames.fixed();
	std::vector<AttachedLink> attached;
	if ( scene != nullptr )
	{
		attached = attachedLinks( model, *scene, bare, frames, problem.object_poses );
		problem.scene = createScene( *scene, frames, problem.object_poses );
	}
	Contacts contacts( model, attached, scene );
	for ( std::size_t i = 0; scene != nullptr && i < scene->attached.size(); ++i )
	{
		const AttachedObject& object = scene->attached[i];
		for ( const std::string& link : object.touch_links )
		{
			contacts.allow( object.object.name, link );
		}
		std::vector<std::string> strangers = contacts.unknown( object.touch_links );
		if ( !strangers.empty() )
		{
			problem.notices.push_back( { scene->file, "attached object " + object.object.name,
			    fmt::format( "touch_links that are no links were ignored: {}", joinNames( strangers ) ) } );
		}
	}
	if ( scene != nullptr )
	{
		contacts.allowMatrix( model, *scene, problem.notices );
	}
	for ( const auto& [a, b] : options.allowed )
	{
		contacts.allow( a, b );
	}
	problem.robot = createBareRobot( model, contacts );
	findReach( options, problem );
	attachAll( attached, contacts, scene, problem );
	detail::selectGroup( model, options.group, problem );
	createChecker( model, scene, contacts, options, problem );
	if ( scene != nullptr && options.notice_enclosed )
	{
		detail::noticeEnclosures( model, *scene, contacts.link_objects, problem );
	}
	return problem;
}

std::string variableName( const lw_robot* robot, std::uint32_t variable )
{
	lw_variable_info info = lw_robot_variable( robot, variable );
	return lw_robot_joint_name( robot, info.joint ) +
	       jointSuffixes( lw_robot_joint_type( robot, info.joint ) ).at( info.component );
}

std::vector<std::string> variableNames( const JointModel& joint )
{
	std::vector<std::string> names;
	if ( joint.type != LW_JOINT_FIXED && joint.mimic.empty() )
	{
		for ( const std::string& suffix : jointSuffixes( joint.type ) )
		{
			names.push_back( joint.name + suffix );
		}
	}
	return names;
}

std::vector<double> startState( const Problem& problem )
{
	std::vector<double> state;
	for ( std::uint32_t variable : problem.variables )
	{
		state.push_back( problem.reference[variable] );
	}
	return state;
}

std::vector<double> goalState( const Problem& problem, const Request& request )
{
	const lw_robot* robot = problem.robot.get();
	const std::string& file = request.goal_file.empty() ? request.file : request.goal_file;
	if ( request.hasPoseGoal() )
	{
		throw Error( file, request.goal_element, "constrains poses of links: no single state of the joints is the goal",
		    "solve it by inverse kinematics (leeway plan does), or give joint_constraints alone" );
	}
	std::map<std::string, std::uint32_t> variables;
	for ( std::uint32_t i = 0; i < lw_robot_variable_count( robot ); ++i )
	{
		variables[variableName( robot, i )] = i;
	}
	std::vector<double> full = problem.reference;
	std::set<std::uint32_t> group( problem.variables.begin(), problem.variables.end() ), given;
	for ( const JointGoal& goal : request.goal )
	{
		auto found = variables.find( goal.joint );
		if ( found == variables.end() )
		{
			continue; // buildProblem() has reported this
		}
		std::uint32_t variable = found->second;
		double difference = goal.position - problem.reference[variable];
		if ( lw_robot_variable( robot, variable ).wraps )
		{
			difference = std::remainder( difference, 2 * detail::pi );
		}
		// Files round to a few decimals; a microradian is no motion that was meant
		double tolerance = std::fmax( 1e-6, difference > 0 ? goal.tolerance_below : goal.tolerance_above );
		if ( group.count( variable ) == 0 && std::fabs( difference ) > tolerance )
		{
			throw Error( file, request.goal_element + " " + goal.joint,
			    fmt::format( "is to move from {} to {}, but is not in group {}", problem.reference[variable], goal.position,
			        problem.group ),
			    "remove it or plan for a group that has it" );
		}
		full[variable] = goal.position;
		given.insert( variable );
	}
	std::vector<std::string> missing;
	std::vector<double> state;
	for ( std::size_t i = 0; i < problem.variables.size(); ++i )
	{
		state.push_back( full[problem.variables[i]] );
		if ( given.count( problem.variables[i] ) == 0 )
		{
			missing.push_back( problem.variable_names[i] );
		}
	}
	if ( !missing.empty() && !request.goal_keeps_rest )
	{
		throw Error( file, request.goal_element, fmt::format( "names no goal for {}", joinNames( missing ) ),
		    "give one joint constraint for each joint of the group" );
	}
	return state;
}

std::vector<std::string> limitViolations( const Problem& problem, const std::vector<double>& state )
{
	std::vector<std::string> lines;
	const lw_robot* robot = problem.robot.get();
	for ( std::size_t i = 0; i < problem.variables.size() && i < state.size(); ++i )
	{
		lw_variable_info info = lw_robot_variable( robot, problem.variables[i] );
		bool quaternion = lw_robot_joint_type( robot, info.joint ) == LW_JOINT_FLOATING && info.component >= 3;
		if ( info.wraps || quaternion )
		{
			continue;
		}
		if ( !( state[i] <= info.upper ) )
		{
			lines.push_back(
			    fmt::format( "joint {}: {} is above its limit {}", problem.variable_names[i], state[i], info.upper ) );
		}
		else if ( !( state[i] >= info.lower ) )
		{
			lines.push_back(
			    fmt::format( "joint {}: {} is below its limit {}", problem.variable_names[i], state[i], info.lower ) );
		}
	}
	return lines;
}

} // namespace leeway::io
