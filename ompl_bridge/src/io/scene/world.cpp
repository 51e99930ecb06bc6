// SPDX-License-Identifier: BSD-3-Clause
// A problem whose world changes: names and object frames on top of the core's edits.
#include "leeway/io/world.hpp"

#include "scene/contacts.hpp"
#include "scene/group.hpp"
#include "scene/margins.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <mutex>

namespace leeway::io
{

namespace
{

/// An object as it was given; its shapes' poses are in its own frame.
struct Body
{
	std::vector<PlacedShape> shapes;
	lw_transform pose; ///< world_from_object, or of the link it is attached to
	std::string link;  ///< empty: in the world
	std::set<std::string> touch_links;
	bool is_cloud = false; ///< its shapes are in the scene only
};

std::vector<lw_transform> placed( const Body& body )
{
	std::vector<lw_transform> poses;
	for ( const PlacedShape& shape : body.shapes )
	{
		poses.push_back( lw_transform_multiply( &body.pose, &shape.pose ) );
	}
	return poses;
}

std::vector<const lw_shape*> shapesOf( const Body& body )
{
	std::vector<const lw_shape*> shapes;
	for ( const PlacedShape& shape : body.shapes )
	{
		shapes.push_back( shape.shape.get() );
	}
	return shapes;
}

} // namespace

struct World::State
{
	State( const RobotModel& robot, const ProblemOptions& options, Problem built );
	/// @param other stays as it is while this is made
	State( const State& other )
	    : file( other.file ), allowed( other.allowed ), disabled( other.disabled ), margins( other.margins ),
	      max_d( other.max_d ), bodies( other.bodies ), problem( other.problem )
	{
	}

	/// Throws an Error about an object unless the core is content.
	void require( lw_status status, const lw_diag& diag, const std::string& object, const char* remedy ) const;
	const Body& body( const std::string& object ) const;
	/// The same, but not of a cloud.
	const Body& bodyThatMoves( const std::string& object ) const;
	std::uint32_t linkOf( const std::string& object, const std::string& link ) const;
	/// The problem at hand with another scene and robot, and a checker for them.
	Checker next( const std::vector<lw_scene_change>& changes, Robot robot, const std::string& object,
	    const std::map<std::string, Body>& bodies );
	Scene edited( const std::vector<lw_scene_change>& changes, const std::string& object ) const;
	Checker nextIn( Scene scene, Robot robot, const std::string& object, const std::map<std::string, Body>& bodies );
	Checker attach( const std::string& object, Body next_body );
	/// @throws Error if links of the robot, or attached objects and links, would have other contacts
	void requireSameLinks( const detail::AllowedNames& next_allowed, const ContactMatrix& matrix ) const;
	std::vector<double> fullState( const std::vector<double>& state ) const;
	lw_transform worldFromLink( const std::string& link, const std::vector<double>& state ) const;
	std::vector<lw_link_object_pair> allowedPairs(
	    const Problem& next_problem, const std::map<std::string, Body>& next_bodies ) const;
	/// Margins of the names that are there; nullopt if there are none at all.
	std::optional<detail::BoundMargins> bind( Problem& next_problem, const std::map<std::string, Body>& next_bodies ) const;

	std::string file;
	detail::AllowedNames allowed;
	std::set<std::pair<std::string, std::string>> disabled; ///< links whose contact the SRDF allows
	Margins margins;
	double max_d; ///< as of ProblemOptions
	std::map<std::string, Body> bodies;
	std::shared_ptr<const Problem> problem;
	mutable std::mutex mutex;
};

World::State::State( const RobotModel& robot, const ProblemOptions& options, Problem of_options )
    : file( options.scene != nullptr ? options.scene->file : robot.urdf_file ), allowed( options.scene ),
      margins( options.margins ), max_d( options.max_d )
{
	for ( const auto& [a, b] : options.allowed )
	{
		allowed.set( a, b, true );
	}
	for ( const DisabledPair& pair : robot.disabled )
	{
		disabled.insert( std::minmax( pair.link1, pair.link2 ) );
	}
	auto built = std::make_shared<Problem>( std::move( of_options ) );
	if ( !built->scene )
	{
		const lw_scene_def def = lw_scene_def_default();
		lw_scene* scene = nullptr;
		leeway::require( lw_scene_create( &def, nullptr, nullptr, &scene ), "lw_scene_create" );
		built->scene = Scene::adopt( scene );
		lw_checker_edit_def edit = lw_checker_edit_def_default();
		edit.scene = built->scene.get();
		lw_checker* checker = nullptr;
		leeway::require( lw_checker_edit( built->checker.get(), &edit, nullptr, nullptr, &checker ), "lw_checker_edit" );
		built->checker = Checker::adopt( checker );
	}
	const auto take = [&]( const SceneObject& object, const std::string& link, const std::vector<std::string>& touch )
	{
		Body body{ object.shapes, built->object_poses.at( object.name ), link, { touch.begin(), touch.end() } };
		const lw_transform object_from_frame = lw_transform_inverse( &object.pose );
		for ( PlacedShape& shape : body.shapes )
		{
			shape.pose = lw_transform_multiply( &object_from_frame, &shape.pose );
		}
		if ( !bodies.emplace( object.name, std::move( body ) ).second )
		{
			throw Error( file, "object " + object.name, "two objects have this name", "rename one" );
		}
	};
	for ( std::size_t i = 0; options.scene != nullptr && i < options.scene->objects.size(); ++i )
	{
		take( options.scene->objects[i], "", {} );
	}
	for ( std::size_t i = 0; options.scene != nullptr && i < options.scene->attached.size(); ++i )
	{
		const AttachedObject& attached = options.scene->attached[i];
		take( attached.object, attached.link, attached.touch_links );
	}
	problem = std::move( built );
}

void World::State::require( lw_status status, const lw_diag& diag, const std::string& object, const char* remedy ) const
{
	if ( status != LW_OK )
	{
		throw Error( file, "object " + object, diag.message[0] != '\0' ? diag.message : lw_status_name( status ), remedy );
	}
}

const Body& World::State::body( const std::string& object ) const
{
	auto found = bodies.find( object );
	if ( found == bodies.end() )
	{
		throw Error( file, "object " + object, "there is no such object", "add it first" );
	}
	return found->second;
}

const Body& World::State::bodyThatMoves( const std::string& object ) const
{
	const Body& found = body( object );
	if ( found.is_cloud )
	{
		throw Error( file, "object " + object, "is a live cloud, which stands where its sensors saw it", "see() renews it" );
	}
	return found;
}

std::uint32_t World::State::linkOf( const std::string& object, const std::string& link ) const
{
	const std::uint32_t index = lw_robot_find_link( problem->robot.get(), link.c_str() );
	if ( index == LW_INVALID_INDEX )
	{
		throw Error( file, "object " + object,
		    fmt::format( "robot {} has no link {}", lw_robot_name( problem->robot.get() ), link ),
		    "name a link of the robot" );
	}
	return index;
}

std::vector<lw_link_object_pair> World::State::allowedPairs(
    const Problem& next_problem, const std::map<std::string, Body>& next_bodies ) const
{
	std::vector<lw_link_object_pair> pairs;
	if ( allowed.empty() )
	{
		return pairs;
	}
	const lw_robot* robot = next_problem.robot.get();
	for ( const auto& [name, body] : next_bodies )
	{
		const std::uint32_t object = body.link.empty() ? lw_scene_find_object( next_problem.scene.get(), name.c_str() ) : 0;
		for ( std::uint32_t link = 0; body.link.empty() && link < lw_robot_link_count( robot ); ++link )
		{
			if ( allowed.allows( lw_robot_link_name( robot, link ), name ) )
			{
				pairs.push_back( { link, object } );
			}
		}
	}
	return pairs;
}

std::optional<detail::BoundMargins> World::State::bind(
    Problem& next_problem, const std::map<std::string, Body>& next_bodies ) const
{
	const Padding& padding = next_problem.padding;
	const bool none = margins.environment == 0 && margins.self == 0 && margins.links.empty() && margins.self_links.empty() &&
	                  margins.objects.empty() && margins.pairs.empty() && padding.object == 0 && padding.attached == 0 &&
	                  padding.link_padding.empty();
	if ( none )
	{
		return std::nullopt;
	}
	std::set<std::string> attached;
	for ( const auto& [name, body] : next_bodies )
	{
		if ( !body.link.empty() )
		{
			attached.insert( name );
		}
	}
	const auto isLink = [&]( const std::string& name )
	{ return lw_robot_find_link( next_problem.robot.get(), name.c_str() ) != LW_INVALID_INDEX; };
	const auto isObject = [&]( const std::string& name )
	{ return lw_scene_find_object( next_problem.scene.get(), name.c_str() ) != LW_INVALID_INDEX; };
	Margins there = margins; // without the names that are gone
	const auto keep = []( auto& map, const auto& is )
	{
		for ( auto entry = map.begin(); entry != map.end(); )
		{
			entry = is( entry->first ) ? std::next( entry ) : map.erase( entry );
		}
	};
	keep( there.links, isLink );
	keep( there.self_links, isLink );
	keep( there.objects, isObject );
	keep( there.pairs,
	    [&]( const std::pair<std::string, std::string>& pair )
	    {
		    return ( isLink( pair.first ) || isLink( pair.second ) ) && ( isLink( pair.first ) || isObject( pair.first ) ) &&
		           ( isLink( pair.second ) || isObject( pair.second ) );
	    } );
	std::vector<Notice> notices; // unused: reported when the problem was built, or the margins set
	return detail::bindMargins( there, next_problem, attached, {}, notices );
}

Scene World::State::edited( const std::vector<lw_scene_change>& changes, const std::string& object ) const
{
	if ( changes.empty() )
	{
		return problem->scene;
	}
	lw_diag diag{};
	lw_scene* scene = nullptr;
	require( lw_scene_edit( problem->scene.get(), changes.data(), static_cast<std::uint32_t>( changes.size() ), nullptr,
	             &diag, &scene ),
	    diag, object, "correct the change" );
	return Scene::adopt( scene );
}

Checker World::State::next( const std::vector<lw_scene_change>& changes, Robot robot, const std::string& object,
    const std::map<std::string, Body>& next_bodies )
{
	return nextIn( edited( changes, object ), std::move( robot ), object, next_bodies );
}

Checker World::State::nextIn(
    Scene scene, Robot robot, const std::string& object, const std::map<std::string, Body>& next_bodies )
{
	auto next_problem = std::make_shared<Problem>( *problem );
	next_problem->robot = std::move( robot );
	next_problem->scene = std::move( scene );
	lw_diag diag{};
	next_problem->allowed = allowedPairs( *next_problem, next_bodies );
	const std::vector<lw_link_object_pair>& pairs = next_problem->allowed;
	const std::optional<detail::BoundMargins> bound = bind( *next_problem, next_bodies );
	const lw_margins given = bound ? bound->def() : lw_margins{};
	lw_checker_edit_def def = lw_checker_edit_def_default();
	def.robot = next_problem->robot.get();
	def.scene = next_problem->scene.get();
	def.allowed = pairs.data();
	def.allowed_count = static_cast<std::uint32_t>( pairs.size() );
	def.replace_allowed = true;
	def.margins = &given;
	lw_checker* checker = nullptr;
	require( lw_checker_edit( problem->checker.get(), &def, nullptr, &diag, &checker ), diag, object, "correct the change" );
	next_problem->checker = Checker::adopt( checker );
	next_problem->object_poses.clear();
	for ( const auto& [name, body] : next_bodies )
	{
		next_problem->object_poses.emplace( name, body.pose );
	}
	problem = next_problem;
	return problem->checker;
}

std::vector<double> World::State::fullState( const std::vector<double>& state ) const
{
	if ( !state.empty() && state.size() != problem->variables.size() )
	{
		throw Error( file, "state", fmt::format( "has {} values instead of {}", state.size(), problem->variables.size() ),
		    "give one for each variable of the group, or none for the reference state" );
	}
	std::vector<double> full = problem->reference;
	for ( std::size_t i = 0; i < state.size(); ++i )
	{
		full[problem->variables[i]] = state[i];
	}
	return full;
}

lw_transform World::State::worldFromLink( const std::string& link, const std::vector<double>& state ) const
{
	const lw_robot* robot = problem->robot.get();
	const std::vector<double> full = fullState( state );
	std::vector<lw_transform> poses( lw_robot_link_count( robot ) );
	if ( lw_robot_fk( robot, full.data(), poses.data() ) != LW_OK )
	{
		throw Error( file, "state", "holds a non-finite value or a zero quaternion", "correct it" );
	}
	return poses[lw_robot_find_link( robot, link.c_str() )];
}

Checker World::State::attach( const std::string& object, Body next_body )
{
	std::vector<std::uint32_t> touch;
	for ( const std::string& link : next_body.touch_links )
	{
		touch.push_back( linkOf( object, link ) );
	}
	for ( std::uint32_t link = 0; link < lw_robot_link_count( problem->robot.get() ); ++link )
	{
		if ( allowed.allows( lw_robot_link_name( problem->robot.get(), link ), object ) )
		{
			touch.push_back( link );
		}
	}
	const std::vector<const lw_shape*> shapes = shapesOf( next_body );
	const std::vector<lw_transform> poses = placed( next_body );
	lw_attachment_def def = lw_attachment_def_default();
	def.name = object.c_str();
	def.link = linkOf( object, next_body.link );
	def.shapes = shapes.data();
	def.link_from_shape = poses.data();
	def.shape_count = static_cast<std::uint32_t>( shapes.size() );
	def.touch_links = touch.data();
	def.touch_link_count = static_cast<std::uint32_t>( touch.size() );
	lw_robot* robot = nullptr;
	lw_diag diag{};
	require( lw_robot_attach( problem->robot.get(), &def, nullptr, &diag, &robot ), diag, object, "correct the object" );
	std::map<std::string, Body> next_bodies = bodies;
	next_bodies[object] = std::move( next_body );
	Checker checker =
	    next( { { LW_SCENE_REMOVE, object.c_str(), nullptr, nullptr, 0 } }, Robot::adopt( robot ), object, next_bodies );
	bodies = std::move( next_bodies );
	return checker;
}

// ---- changes

World::World( const RobotModel& robot, const ProblemOptions& options )
    : m_state( std::make_unique<State>( robot, options, buildProblem( robot, options ) ) )
{
}

World::World( const RobotModel& robot, const ProblemOptions& options, const Problem& problem )
    : m_state( std::make_unique<State>( robot, options, problem ) )
{
}

World::World( const World& other )
{
	const std::lock_guard<std::mutex> lock( other.m_state->mutex );
	m_state = std::make_unique<State>( *other.m_state );
}

World::~World() = default;

std::shared_ptr<const Problem> World::problem() const
{
	const std::lock_guard<std::mutex> lock( m_state->mutex );
	return m_state->problem;
}

std::shared_ptr<const Problem> World::problemOf(
    const RobotModel& robot, const std::string& group, const std::vector<double>& state ) const
{
	const std::lock_guard<std::mutex> lock( m_state->mutex );
	const Problem& here = *m_state->problem;
	auto other = std::make_shared<Problem>( here );
	other->reference = m_state->fullState( state );
	detail::selectGroup( robot, group, *other );
	const std::optional<detail::BoundMargins> bound = m_state->bind( *other, m_state->bodies );
	lw_checker_def def = lw_checker_def_default();
	def.margins = bound ? bound->def() : def.margins;
	def.max_d = m_state->max_d;
	def.previous = here.checker.get();
	detail::makeChecker( def, m_state->file, "group " + group, "correct the state", *other );
	return other;
}

Checker World::move( const std::string& object, const lw_transform& world_from_object )
{
	const std::lock_guard<std::mutex> lock( m_state->mutex );
	Body body = m_state->bodyThatMoves( object );
	if ( !body.link.empty() )
	{
		throw Error( m_state->file, "object " + object, "is attached to link " + body.link, "detach it before it is moved" );
	}
	body.pose = world_from_object;
	const std::vector<lw_transform> poses = placed( body );
	std::map<std::string, Body> bodies = m_state->bodies;
	bodies[object] = std::move( body );
	Checker checker = m_state->next(
	    { { LW_SCENE_MOVE, object.c_str(), nullptr, poses.data(), static_cast<std::uint32_t>( poses.size() ) } },
	    m_state->problem->robot, object, bodies );
	m_state->bodies = std::move( bodies );
	return checker;
}

Checker World::add(
    const std::string& object, const std::vector<PlacedShape>& shapes, const lw_transform& world_from_object )
{
	const std::lock_guard<std::mutex> lock( m_state->mutex );
	if ( m_state->bodies.count( object ) != 0 ||
	     lw_robot_find_link( m_state->problem->robot.get(), object.c_str() ) != LW_INVALID_INDEX )
	{
		throw Error( m_state->file, "object " + object, "an object or a link has this name already",
		    "remove that first, or choose another name" );
	}
	const Body body{ shapes, world_from_object, "", {} };
	const std::vector<const lw_shape*> pointers = shapesOf( body );
	const std::vector<lw_transform> poses = placed( body );
	std::map<std::string, Body> bodies = m_state->bodies;
	bodies.emplace( object, body );
	Checker checker = m_state->next(
	    { { LW_SCENE_ADD, object.c_str(), pointers.data(), poses.data(), static_cast<std::uint32_t>( poses.size() ) } },
	    m_state->problem->robot, object, bodies );
	m_state->bodies = std::move( bodies );
	return checker;
}

Checker World::see( const std::string& object, Cloud& cloud )
{
	const std::lock_guard<std::mutex> lock( m_state->mutex );
	const auto known = m_state->bodies.find( object );
	if ( ( known != m_state->bodies.end() && !known->second.is_cloud ) ||
	     lw_robot_find_link( m_state->problem->robot.get(), object.c_str() ) != LW_INVALID_INDEX )
	{
		throw Error( m_state->file, "object " + object, "an object or a link has this name already",
		    "remove that first, or choose another name" );
	}
	std::vector<lw_scene_change> changes;
	if ( known != m_state->bodies.end() )
	{
		changes.push_back( { LW_SCENE_REMOVE, object.c_str(), nullptr, nullptr, 0 } );
	}
	const Scene base = m_state->edited( changes, object );
	lw_scene* seen = nullptr;
	lw_diag diag{};
	m_state->require( lw_cloud_scene( cloud.get(), base.get(), object.c_str(), &diag, &seen ), diag, object,
	    "clear the cloud and begin again, with more blocks" );
	std::map<std::string, Body> bodies = m_state->bodies;
	Body body{ {}, lw_transform_identity(), "", {} };
	body.is_cloud = true;
	bodies[object] = body;
	Checker checker = m_state->nextIn( Scene::adopt( seen ), m_state->problem->robot, object, bodies );
	m_state->bodies = std::move( bodies );
	return checker;
}

Checker World::remove( const std::string& object )
{
	const std::lock_guard<std::mutex> lock( m_state->mutex );
	const bool attached = !m_state->body( object ).link.empty();
	std::map<std::string, Body> bodies = m_state->bodies;
	bodies.erase( object );
	Robot robot = m_state->problem->robot;
	if ( attached )
	{
		lw_robot* without = nullptr;
		lw_diag diag{};
		m_state->require( lw_robot_detach( robot.get(), object.c_str(), nullptr, &diag, &without ), diag, object,
		    "detach what hangs on it first" );
		robot = Robot::adopt( without );
	}
	std::vector<lw_scene_change> changes;
	if ( !attached )
	{
		changes.push_back( { LW_SCENE_REMOVE, object.c_str(), nullptr, nullptr, 0 } );
	}
	Checker checker = m_state->next( changes, std::move( robot ), object, bodies );
	m_state->bodies = std::move( bodies );
	return checker;
}

Checker World::attach( const std::string& object, const std::string& link, const std::vector<std::string>& touch_links,
    const std::vector<double>& state )
{
	const std::lock_guard<std::mutex> lock( m_state->mutex );
	Body body = m_state->bodyThatMoves( object );
	if ( !body.link.empty() )
	{
		throw Error( m_state->file, "object " + object, "is attached to link " + body.link + " already", "detach it first" );
	}
	m_state->linkOf( object, link );
	const lw_transform world_from_link = m_state->worldFromLink( link, state );
	const lw_transform link_from_world = lw_transform_inverse( &world_from_link );
	body.pose = lw_transform_multiply( &link_from_world, &body.pose );
	body.link = link;
	body.touch_links = { touch_links.begin(), touch_links.end() };
	return m_state->attach( object, std::move( body ) );
}

Checker World::attachAt( const std::string& object, const std::string& link, const std::vector<std::string>& touch_links,
    const lw_transform& link_from_object )
{
	const std::lock_guard<std::mutex> lock( m_state->mutex );
	Body body = m_state->bodyThatMoves( object );
	if ( !body.link.empty() )
	{
		throw Error( m_state->file, "object " + object, "is attached to link " + body.link + " already", "detach it first" );
	}
	body.pose = link_from_object;
	body.link = link;
	body.touch_links = { touch_links.begin(), touch_links.end() };
	return m_state->attach( object, std::move( body ) );
}

Checker World::detach( const std::string& object, const std::vector<double>& state )
{
	const std::lock_guard<std::mutex> lock( m_state->mutex );
	Body body = m_state->body( object );
	if ( body.link.empty() )
	{
		throw Error( m_state->file, "object " + object, "is not attached to the robot", "name an object that is" );
	}
	const lw_transform world_from_link = m_state->worldFromLink( body.link, state );
	lw_robot* robot = nullptr;
	lw_diag diag{};
	m_state->require( lw_robot_detach( m_state->problem->robot.get(), object.c_str(), nullptr, &diag, &robot ), diag, object,
	    "detach what hangs on it first" );
	Robot without = Robot::adopt( robot );
	body.pose = lw_transform_multiply( &world_from_link, &body.pose );
	body.link.clear();
	body.touch_links.clear();
	const std::vector<const lw_shape*> pointers = shapesOf( body );
	const std::vector<lw_transform> poses = placed( body );
	std::map<std::string, Body> bodies = m_state->bodies;
	bodies[object] = std::move( body );
	Checker checker = m_state->next(
	    { { LW_SCENE_ADD, object.c_str(), pointers.data(), poses.data(), static_cast<std::uint32_t>( poses.size() ) } },
	    std::move( without ), object, bodies );
	m_state->bodies = std::move( bodies );
	return checker;
}

Checker World::allow( const std::string& link, const std::string& object, bool allowed )
{
	const std::lock_guard<std::mutex> lock( m_state->mutex );
	m_state->linkOf( object, link );
	const Body& body = m_state->body( object );
	if ( !body.link.empty() )
	{
		throw Error(
		    m_state->file, "object " + object, "is attached to link " + body.link, "give touch_links when it is attached" );
	}
	const detail::AllowedNames before = m_state->allowed;
	m_state->allowed.set( link, object, allowed );
	try
	{
		return m_state->next( {}, m_state->problem->robot, object, m_state->bodies );
	}
	catch ( ... )
	{
		m_state->allowed = before;
		throw;
	}
}

std::string World::holder( const std::string& object ) const
{
	const std::lock_guard<std::mutex> lock( m_state->mutex );
	return m_state->body( object ).link;
}

void World::State::requireSameLinks( const detail::AllowedNames& next_allowed, const ContactMatrix& matrix ) const
{
	const lw_robot* robot = problem->robot.get();
	const auto touches = [&]( const std::string& object, const std::string& link )
	{
		const auto held = bodies.find( object );
		return held != bodies.end() && ( held->second.link == link || held->second.touch_links.count( link ) != 0 );
	};
	for ( std::uint32_t i = 0; i < lw_robot_link_count( robot ); ++i )
	{
		for ( std::uint32_t k = 0; k < i; ++k )
		{
			const std::string a = lw_robot_link_name( robot, k ), b = lw_robot_link_name( robot, i );
			const bool held = lw_robot_is_attached( robot, i );
			const bool stays =
			    disabled.count( std::minmax( a, b ) ) != 0 || ( held && ( touches( b, a ) || touches( a, b ) ) );
			if ( !stays && allowed.allows( a, b ) != next_allowed.allows( a, b ) )
			{
				throw Error( file, matrix.element,
				    fmt::format( "would {} the contact of {} and {}, {}", next_allowed.allows( a, b ) ? "allow" : "forbid",
				        a, b, held ? "which is attached" : "two links of the robot" ),
				    held ? "release the object, and attach it again with its touch_links"
				         : "give this pair as the scene's matrix has it" );
			}
		}
	}
}

Checker World::setContacts( const ContactMatrix& matrix )
{
	const std::lock_guard<std::mutex> lock( m_state->mutex );
	const detail::AllowedNames before = m_state->allowed;
	detail::AllowedNames after = before;
	after.setMatrix( matrix );
	m_state->requireSameLinks( after, matrix );
	m_state->allowed = std::move( after );
	try
	{
		return m_state->next( {}, m_state->problem->robot, "", m_state->bodies );
	}
	catch ( ... )
	{
		m_state->allowed = before;
		throw;
	}
}

Checker World::setMargins( const Margins& margins )
{
	const std::lock_guard<std::mutex> lock( m_state->mutex );
	std::set<std::string> attached;
	for ( const auto& [name, body] : m_state->bodies )
	{
		if ( !body.link.empty() )
		{
			attached.insert( name );
		}
	}
	std::vector<Notice> notices;
	detail::bindMargins( margins, *m_state->problem, attached, {}, notices ); // names of nothing are refused now
	const Margins before = m_state->margins;
	m_state->margins = margins;
	try
	{
		return m_state->next( {}, m_state->problem->robot, "", m_state->bodies );
	}
	catch ( ... )
	{
		m_state->margins = before;
		throw;
	}
}

} // namespace leeway::io
