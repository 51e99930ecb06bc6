// SPDX-License-Identifier: BSD-3-Clause
// World files: robots, objects and a scene, made into one robot and its scene. Format: ompl_bridge/docs/worlds.md.
#include "world/world_reader.hpp"

#include "base/xml.hpp"
#include "robot/plausibility.hpp"
#include "scene/shape_reader.hpp"
#include "world/composite.hpp"
#include "world/object_motion.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <set>

namespace leeway::io
{

namespace detail
{

namespace
{

constexpr const char* version_key = "leeway_world";

/// Seconds or metres that may not be negative.
double readNotNegative( const YamlNode& node, double fallback )
{
	const double value = node.defined() ? node.number() : fallback;
	if ( value < 0 )
	{
		node.fail( fmt::format( "{} is negative", value ), "give 0 or more" );
	}
	return value;
}

lw_transform poseOr( const YamlNode& node )
{
	return node.defined() ? node.pose() : lw_transform_identity();
}

class WorldReader
{
public:
	WorldReader( const std::string& file, std::string content, const LoadOptions& options, Resting resting )
	    : m_file( file ), m_root( YamlNode::parse( file, std::move( content ), m_world.robot.report.notices ) ),
	      m_options( options ), m_resting( resting ), m_shapes( m_options, m_world.robot.report )
	{
	}
	WorldModel read();

private:
	/// A robot's files, read once.
	struct Known
	{
		RobotModel model;
		std::vector<std::string> variables;
		std::vector<double> values;
	};

	void checkTop() const;
	std::string readName( const YamlNode& node );
	std::string find( const char* kind, const YamlNode& uri );
	void readRobot( const YamlNode& node );
	const Known& knownRobot( const YamlNode& node, const std::string& name, bool& shared );
	void readGroup( const YamlNode& group, const Known& known, WorldPart& part ) const;
	void readState( const YamlNode& state, const Known& known, WorldPart& part ) const;
	void readTolerance( const YamlNode& tolerance, const Known& known, WorldPart& part ) const;
	std::size_t variableOf( const YamlNode& node, const Known& known, const std::string& name ) const;
	void noticeLimits( const YamlNode& node, const Known& known, const WorldPart& part ) const;
	void readObject( const YamlNode& node );
	void rest( const std::string& name, const lw_transform& pose, const std::vector<PlacedShape>& shapes );
	void readScene();
	void allowObjects();
	void readAllowed();

	const std::string& m_file;
	WorldModel m_world;
	const YamlNode m_root;
	const LoadOptions& m_options;
	const Resting m_resting;
	ShapeReader m_shapes;
	std::map<std::tuple<std::string, std::string, std::vector<std::string>>, Known> m_known;
	std::set<std::string> m_names;
	std::vector<std::string> m_moving; ///< links of objects on the robot, resting ones among them
	std::vector<SceneObject> m_objects;
};

/// What a YAML file is that is no world.
std::string kindOf( const YamlNode& root )
{
	const std::vector<std::pair<const char*, const char*>> kinds = { { "world", "a planning scene" },
	    { "robot_state", "a planning scene" }, { "allowed_collision_matrix", "a planning scene" },
	    { "goal_constraints", "a request" }, { "start_state", "a request, or a path" },
	    { "joint_trajectory", "a trajectory" }, { "trajectory", "a trajectory" }, { "points", "a path or trajectory" },
	    { "steps", "a list of steps" }, { "pairs", "a file of margins" } };
	const auto found =
	    std::find_if( kinds.begin(), kinds.end(), [&]( const auto& kind ) { return root[kind.first].defined(); } );
	return found != kinds.end() ? found->second : "";
}

void WorldReader::checkTop() const
{
	const std::vector<std::string> keys = { version_key, "robots", "objects", "scene", "allowed" };
	const YamlNode version = m_root[version_key];
	if ( !version.defined() )
	{
		for ( const std::string& key : m_root.keys() )
		{
			m_root.refuseMisspelt( key, { version_key } );
		}
		const std::string kind = kindOf( m_root );
		throw Error( m_file, version_key,
		    kind.empty() ? "is missing: this is no world file" : "this is " + kind + ", not a world file",
		    "give a file with leeway_world: 1 and a list of robots" );
	}
	if ( version.text() != "1" )
	{
		version.fail( fmt::format( "version {} is not known", version.text() ), "write 1, or use a newer leeway" );
	}
	m_root.refuseUnknownKeys( keys );
	if ( m_root["robots"].size() + m_root["objects"].size() == 0 )
	{
		m_root["robots"].fail( "there are no robots and no objects", "give a list of robots" );
	}
}

std::string WorldReader::readName( const YamlNode& node )
{
	const YamlNode key = node["name"];
	const std::string name = key.text();
	if ( name.empty() || name.find( '/' ) != std::string::npos )
	{
		key.fail( name.empty() ? "is empty"
		                       : fmt::format( "{} has a /, which joins a robot's name with those of its links", name ),
		    "give a name without /" );
	}
	if ( name == world_root || name == "all" )
	{
		key.fail(
		    fmt::format( "{} is the name of {}", name, name == world_root ? "the world's root" : "the group of all joints" ),
		    "give another name" );
	}
	if ( !m_names.insert( name ).second )
	{
		key.fail( fmt::format( "a robot or an object is called {} already", name ), "rename one of them" );
	}
	return name;
}

std::string WorldReader::find( const char* kind, const YamlNode& uri )
{
	m_world.files.push_back(
	    findResource( kind, uri.text(), m_file, uri.place(), m_options, m_world.robot.report.notices ) );
	return m_world.files.back();
}

// ---- robots ----------------------------------------------------------------------------------------------------------

const WorldReader::Known& WorldReader::knownRobot( const YamlNode& node, const std::string& name, bool& shared )
{
	LoadOptions options = m_options;
	options.expand_xacro = nullptr; // nobody but this file names the robot
	options.solid = node["solid"].textList();
	for ( const std::string& link : m_options.solid )
	{
		const bool of_this = link.compare( 0, name.size() + 1, name + "/" ) == 0;
		if ( of_this || link == "*" )
		{
			options.solid.push_back( of_this ? link.substr( name.size() + 1 ) : link );
		}
	}
	const std::string file = find( "robot", node["robot"] );
	const std::string srdf = node["srdf"].defined() ? find( "SRDF", node["srdf"] ) : "";
	std::error_code error;
	const auto [found, fresh] = m_known.try_emplace( { std::filesystem::weakly_canonical( file, error ).string(),
	    std::filesystem::weakly_canonical( srdf, error ).string(), options.solid } );
	Known& known = found->second;
	shared = !fresh;
	if ( fresh )
	{
		std::string content = readFile( file );
		if ( isWorld( content ) )
		{
			node["robot"].fail(
			    fmt::format( "{} is a world file, not a robot", file ), "name the robots of that world here" );
		}
		known.model = loadOneRobot( file, std::move( content ), srdf, options );
		known.values = initialValues( known.model, known.variables );
	}
	return known;
}

std::size_t WorldReader::variableOf( const YamlNode& node, const Known& known, const std::string& name ) const
{
	const auto found = std::find( known.variables.begin(), known.variables.end(), name );
	if ( found == known.variables.end() )
	{
		node.fail( fmt::format( "{} has no joint {} that can move by itself", known.model.urdf_file, name ),
		    fmt::format( "use names without the robot's: {}", joinNames( known.variables ) ) );
	}
	return static_cast<std::size_t>( found - known.variables.begin() );
}

void WorldReader::noticeLimits( const YamlNode& node, const Known& known, const WorldPart& part ) const
{
	const Robot robot = createRobot( known.model, {} );
	for ( std::uint32_t i = 0; i < part.state.size(); ++i )
	{
		const lw_variable_info info = lw_robot_variable( robot.get(), i );
		const bool bounded = lw_robot_joint_type( robot.get(), info.joint ) != LW_JOINT_FLOATING && !info.wraps;
		if ( bounded && !( part.state[i] >= info.lower && part.state[i] <= info.upper ) )
		{
			node.notice( fmt::format( "joint {} is at {}, outside of its limits {} to {}", known.variables[i], part.state[i],
			    info.lower, info.upper ) );
		}
	}
}

/// A map of joints, or the name of a state of the robot.
void WorldReader::readState( const YamlNode& state, const Known& known, WorldPart& part ) const
{
	part.state = known.values;
	if ( state.isScalar() )
	{
		for ( const auto& [name, values] : known.model.useGroupState( "", state.text() ).joints )
		{
			const auto joint = std::find_if( known.model.joints.begin(), known.model.joints.end(),
			    [&, &wanted = name]( const JointModel& candidate ) { return candidate.name == wanted; } );
			const std::vector<std::string> variables =
			    joint != known.model.joints.end() ? variableNames( *joint ) : std::vector<std::string>();
			for ( std::size_t i = 0; i < std::min( variables.size(), values.size() ); ++i )
			{
				part.state[variableOf( state, known, variables[i] )] = values[i];
			}
		}
	}
	else
	{
		for ( const auto& [name, value] : state.numberMap() )
		{
			part.state[variableOf( state, known, name )] = value;
		}
	}
	if ( state.defined() )
	{
		noticeLimits( state, known, part );
	}
}

void WorldReader::readGroup( const YamlNode& group, const Known& known, WorldPart& part ) const
{
	part.planned.assign( known.variables.size(), group.defined() ? 0 : 1 );
	if ( !group.defined() )
	{
		return;
	}
	part.group = group.text();
	const std::vector<std::string> joints = known.model.useGroup( part.group ).joints;
	for ( const JointModel& joint : known.model.joints )
	{
		const bool in = std::find( joints.begin(), joints.end(), joint.name ) != joints.end();
		for ( const std::string& variable : in ? variableNames( joint ) : std::vector<std::string>() )
		{
			part.planned[variableOf( group, known, variable )] = 1;
		}
	}
}

/// A number for all joints of one variable, or a map.
void WorldReader::readTolerance( const YamlNode& tolerance, const Known& known, WorldPart& part ) const
{
	part.tolerance.assign( known.variables.size(), 0.0 );
	const bool all = tolerance.isScalar();
	std::map<std::string, double> values = all ? std::map<std::string, double>() : tolerance.numberMap();
	std::vector<std::string> bases;
	std::set<std::string> quaternions;
	for ( const JointModel& joint : known.model.joints )
	{
		const std::vector<std::string> names = variableNames( joint );
		const bool single = names.size() == 1;
		if ( all && single )
		{
			values[names[0]] = tolerance.number();
		}
		if ( names.size() > 1 )
		{
			bases.push_back( joint.name );
		}
		for ( std::size_t i = 3; joint.type == LW_JOINT_FLOATING && i < names.size(); ++i )
		{
			quaternions.insert( names[i] );
		}
	}
	for ( const auto& [name, value] : values )
	{
		const bool turns = quaternions.count( name ) != 0 && value != 0;
		if ( value < 0 || turns )
		{
			tolerance.fail( fmt::format( turns ? "{} is a number of a quaternion, which has no tolerance"
			                                   : "the tolerance of {} is negative",
			                    name ),
			    turns ? "give those of other joints" : "give radians or metres, 0 or more" );
		}
		part.tolerance[variableOf( tolerance, known, name )] = value;
	}
	if ( all && !bases.empty() )
	{
		tolerance.notice(
		    fmt::format( "is not that of joints of several variables: {}; give them in a map", joinNames( bases ) ) );
	}
}

void WorldReader::readRobot( const YamlNode& unnamed )
{
	WorldPart part;
	part.name = readName( unnamed );
	const YamlNode node = unnamed.named( part.name );
	node.refuseUnknownKeys(
	    { "name", "robot", "srdf", "group", "base", "state", "tolerance", "lag", "motion", "motion_start", "solid" } );
	part.element = node.place();
	bool shared = false;
	const Known& known = knownRobot( node, part.name, shared );
	addRobot( part.name, poseOr( node["base"] ), known.model, shared, m_world.robot );
	for ( const std::string& variable : known.variables )
	{
		part.variables.push_back( part.name + "/" + variable );
	}
	readGroup( node["group"], known, part );
	readState( node["state"], known, part );
	readTolerance( node["tolerance"], known, part );
	part.lag = readNotNegative( node["lag"], 0 );
	if ( node["motion"].defined() )
	{
		part.motion_file = find( "trajectory", node["motion"] );
	}
	if ( node["motion_start"].defined() )
	{
		if ( part.motion_file.empty() )
		{
			node["motion_start"].fail( "there is no motion to start", "give motion: FILE, or remove this" );
		}
		part.motion_start = node["motion_start"].number();
	}
	m_world.parts.push_back( std::move( part ) );
}

// ---- objects ---------------------------------------------------------------------------------------------------------

void WorldReader::rest( const std::string& name, const lw_transform& pose, const std::vector<PlacedShape>& shapes )
{
	if ( m_resting == Resting::links )
	{
		WorldPart none;
		none.name = name;
		ObjectChain( pose ).build( world_root, shapes, none, m_world.robot );
		m_moving.push_back( name );
	}
}

void WorldReader::readObject( const YamlNode& unnamed )
{
	WorldPart part;
	part.kind = WorldPart::Kind::object;
	part.name = readName( unnamed );
	const YamlNode node = unnamed.named( part.name ), unknown = node["unknown_motion"];
	node.refuseUnknownKeys( { "name", "shapes", "pose", "motion", "repeat", "unknown_motion", "lag" } );
	part.element = node.place();
	const bool moves = node["motion"].size() > 0 || unknown.defined();
	const lw_transform pose = poseOr( node["pose"] );
	std::vector<PlacedShape> shapes;
	for ( std::size_t i = 0; i < node["shapes"].size(); ++i )
	{
		PlacedShape shape = m_shapes.any( node["shapes"][i], part.name );
		if ( shape.shape && moves && isUnbounded( shape ) )
		{
			node["shapes"][i].fail( "a plane cannot move", "give the object another shape, or no motion" );
		}
		if ( shape.shape ) // else an empty map, which has a notice already
		{
			shapes.push_back( std::move( shape ) );
		}
	}
	if ( node["shapes"].size() == 0 )
	{
		node["shapes"].fail( "there are none: nothing can touch the object", "give a list of shapes" );
	}
	SceneObject object;
	object.name = part.name;
	object.pose = pose;
	for ( const PlacedShape& shape : shapes )
	{
		object.shapes.push_back( { shape.shape, lw_transform_multiply( &pose, &shape.pose ) } );
	}
	ObjectChain chain( pose );
	readMotion( node, chain );
	part.lag = readNotNegative( node["lag"], 0 );
	if ( unknown.defined() )
	{
		unknown.refuseUnknownKeys( { "speed", "from" } );
		part.spread_speed = unknown["speed"].number();
		part.spread_start = unknown["from"].defined() ? unknown["from"].number() : 0;
		if ( !( part.spread_speed > 0 ) )
		{
			unknown["speed"].fail( fmt::format( "{} is not above 0", part.spread_speed ), "give metres per second" );
		}
	}
	m_objects.push_back( std::move( object ) );
	if ( !moves )
	{
		rest( part.name, pose, shapes );
		return;
	}
	chain.build( world_root, shapes, part, m_world.robot );
	m_moving.push_back( part.name );
	m_objects.back().name.clear(); // it is on the robot
	if ( !part.variables.empty() )
	{
		m_world.parts.push_back( std::move( part ) );
	}
}

/// The scene of the file, and the objects that rest.
void WorldReader::readScene()
{
	SceneModel own;
	own.file = m_file;
	own.objects = m_objects;
	noticeOddSizes( own, m_world.robot.report.notices );
	if ( m_root["scene"].defined() )
	{
		LoadOptions options = m_options;
		options.solid.clear();
		m_world.scene = loadScene( find( "scene", m_root["scene"] ), options );
		for ( const SceneObject& object : m_world.scene->objects )
		{
			if ( m_names.count( object.name ) != 0 )
			{
				m_root["scene"].fail(
				    fmt::format( "it has an object {}, and so has this file", object.name ), "rename one of them" );
			}
		}
	}
	own.objects.clear();
	std::copy_if( m_objects.begin(), m_objects.end(), std::back_inserter( own.objects ),
	    [&]( const SceneObject& object ) { return m_resting == Resting::scene && !object.name.empty(); } );
	if ( m_world.scene )
	{
		m_world.scene->objects.insert( m_world.scene->objects.end(), own.objects.begin(), own.objects.end() );
	}
	else if ( !own.objects.empty() )
	{
		own.name = m_world.robot.name;
		m_world.scene = std::move( own );
	}
}

/// Objects never meet objects.
void WorldReader::allowObjects()
{
	for ( std::size_t i = 0; i < m_moving.size(); ++i )
	{
		for ( std::size_t k = i + 1; k < m_moving.size(); ++k )
		{
			m_world.robot.disabled.push_back( { m_moving[i], m_moving[k], world_reason } );
		}
		for ( std::size_t k = 0; m_world.scene && k < m_world.scene->objects.size(); ++k )
		{
			m_world.allowed.emplace_back( m_moving[i], m_world.scene->objects[k].name );
		}
	}
}

void WorldReader::readAllowed()
{
	std::set<std::string> links, objects;
	for ( const LinkModel& link : m_world.robot.links )
	{
		links.insert( link.name );
	}
	for ( std::size_t i = 0; m_world.scene && i < m_world.scene->objects.size(); ++i )
	{
		objects.insert( m_world.scene->objects[i].name );
	}
	for ( std::size_t i = 0; m_world.scene && i < m_world.scene->attached.size(); ++i )
	{
		objects.insert( m_world.scene->attached[i].object.name );
	}
	const YamlNode list = m_root["allowed"];
	for ( std::size_t i = 0; i < list.size(); ++i )
	{
		const std::vector<std::string> names = list[i].textList();
		if ( names.size() != 2 )
		{
			list[i].fail( fmt::format( "has {} names, not 2", names.size() ),
			    "write [robot/link, robot/link] or [robot/link, object]" );
		}
		for ( std::size_t k = 0; k < 2; ++k )
		{
			if ( links.count( names[k] ) + objects.count( names[k] ) == 0 )
			{
				list[i][k].fail( fmt::format( "there is no link and no object {}", names[k] ),
				    "write robot/link for a link, and the name of an object" );
			}
		}
		if ( links.count( names[0] ) != 0 && links.count( names[1] ) != 0 && names[0] != names[1] )
		{
			m_world.robot.disabled.push_back( { names[0], names[1], world_reason } );
		}
		m_world.allowed.emplace_back( names[0], names[1] );
	}
}

WorldModel WorldReader::read()
{
	checkTop();
	RobotModel& robot = m_world.robot;
	m_world.file = robot.urdf_file = m_file;
	robot.name = std::filesystem::path( m_file ).stem().string();
	robot.root_link = robot.planning_frame = world_root;
	LinkModel root;
	root.name = world_root;
	robot.links.push_back( std::move( root ) );
	const YamlNode robots = m_root["robots"], objects = m_root["objects"];
	for ( std::size_t i = 0; i < robots.size(); ++i )
	{
		readRobot( robots[i] );
	}
	for ( std::size_t i = 0; i < objects.size(); ++i )
	{
		readObject( objects[i] );
	}
	checkLimit( &Limits::links, robot.links.size(), "links", m_file, "robots and objects" );
	readScene();
	allowObjects();
	readAllowed();
	addInitialState( m_world.parts, robot );
	return std::move( m_world );
}

/// Of other formats what they are.
void refuseXml( const std::string& file, std::string content )
{
	const XmlFile xml( file, std::move( content ) );
	const std::string root = xml.document().RootElement() != nullptr ? xml.root().Name() : "nothing";
	const std::string kind = root == "robot"    ? "a URDF or SRDF"
	                         : root == "mujoco" ? "an MJCF model"
	                         : root == "sdf"    ? "an SDF model or world of Gazebo"
	                                            : "XML";
	throw Error( file, fmt::format( "<{}>", root ), fmt::format( "this is {}, not a world file", kind ),
	    fmt::format( "name it in one: {{leeway_world: 1, robots: [{{name: r, robot: {}}}]}}",
	        std::filesystem::path( file ).filename().string() ) );
}

} // namespace

bool isWorld( const std::string& content )
{
	return !beginsAsXml( content ) && content.find( version_key ) != std::string::npos;
}

WorldModel readWorld( const std::string& file, std::string content, const LoadOptions& options, Resting resting )
{
	refuseUsd( file, content );
	if ( beginsAsXml( content ) )
	{
		refuseXml( file, content );
	}
	return WorldReader( file, std::move( content ), options, resting ).read();
}

} // namespace detail

const WorldPart& WorldModel::part( const std::string& name ) const
{
	std::vector<std::string> names;
	for ( const WorldPart& candidate : parts )
	{
		if ( candidate.name == name )
		{
			return candidate;
		}
		names.push_back( candidate.name );
	}
	throw Error( file, "part " + name, "there is no robot and no moving object of this name",
	    "use one of " + detail::joinNames( names ) );
}

JointState WorldModel::state() const
{
	JointState out;
	for ( const WorldPart& part : parts )
	{
		for ( std::size_t i = 0; i < part.variables.size(); ++i )
		{
			out.values[part.variables[i]] = part.state[i];
		}
	}
	return out;
}

ProblemOptions worldProblem( const WorldModel& world )
{
	ProblemOptions options;
	options.scene = world.scene ? &*world.scene : nullptr;
	options.overrides = world.state();
	options.allowed = world.allowed;
	return options;
}

} // namespace leeway::io
