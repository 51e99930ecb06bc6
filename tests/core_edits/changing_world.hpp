// SPDX-License-Identifier: BSD-3-Clause
// A random robot among random obstacles that change: kept as lists, from which everything can be made from nothing.
#pragma once

#include "leeway/handles.hpp"
#include "random_robot.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

/// An object of the world, or in the robot's hand. Poses are those of its shapes, in the world or in the link's frame.
struct ChangingObject
{
	std::string name;
	std::vector<leeway::Shape> shapes;
	std::vector<lw_transform> poses;
	std::uint32_t link = LW_INVALID_INDEX; ///< attached to
	std::vector<std::string> touch;
};

class ChangingWorld
{
public:
	ChangingWorld( SeededRng& rng, bool with_reach );

	/// One random change, applied to the lists and, as an edit, to scene, robot and checker. Returns its kind.
	std::string change( SeededRng& rng );

	leeway::Scene sceneFromNothing() const;
	leeway::Robot robotFromNothing() const; ///< with the attached objects, by one def
	/// @param robot robotFromNothing(), or the edited one
	/// @param changes_of only what an earlier checker does not check; NULL: everything
	leeway::Checker checkerFromNothing( const leeway::Robot& robot, const leeway::Scene& scene, const leeway::Reach& tables,
	    const lw_checker* changes_of = nullptr ) const;
	State randomGroupState( SeededRng& rng, double excess = 0 ) const;

	RobotModel model;
	leeway::Robot bare, robot;
	leeway::Reach reach;
	leeway::Scene scene;
	leeway::Checker checker;
	std::vector<std::uint32_t> variables;
	State reference;
	std::vector<ChangingObject> objects, attached;
	std::set<std::pair<std::string, std::string>> allowed; ///< link, object; only of those that are there
	double max_d = INFINITY;
	double environment_margin = 0, self_margin = 0;
	std::map<std::string, double> link_environment, link_self, object_margin; ///< of those that are there
	std::map<std::pair<std::string, std::string>, double> environment_pairs, self_pairs;

private:
	/// lw_margins and the arrays that it points to.
	struct Margins
	{
		std::vector<double> link_environment, link_self, object;
		std::vector<lw_pair_margin> environment_pairs, self_pairs;
		lw_margins def{};
	};
	void fillMargins( const lw_robot* of_robot, const lw_scene* of_scene, Margins& out ) const;
	void forget( const std::string& name, bool object ); ///< forgets the margins of an object, or of a link, that goes away
	std::string margin( SeededRng& rng );
	ChangingObject randomObject( SeededRng& rng );
	lw_transform randomPose( SeededRng& rng ) const;
	/// @param anew all that is allowed and all margins are given again; otherwise they are carried over
	void edit( const std::vector<lw_scene_change>& changes, const leeway::Robot& next_robot, bool anew = false );
	std::string move( SeededRng& rng );
	std::string add( SeededRng& rng );
	std::string drop( SeededRng& rng );
	std::string attach( SeededRng& rng );
	std::string detach( SeededRng& rng );
	std::string allow( SeededRng& rng );
	std::vector<lw_link_object_pair> allowedPairs( const lw_robot* of_robot, const lw_scene* of_scene ) const;

	int m_made = 0;
};

namespace changing_world
{

inline const lw_shape* const* pointers( const ChangingObject& object, std::vector<const lw_shape*>& out )
{
	out.clear();
	for ( const leeway::Shape& shape : object.shapes )
	{
		out.push_back( shape.get() );
	}
	return out.data();
}

inline const std::pair<std::string, std::string>& key( const std::pair<std::string, std::string>& pair )
{
	return pair;
}
inline const std::pair<std::string, std::string>& key(
    const std::pair<const std::pair<std::string, std::string>, double>& pair )
{
	return pair.first;
}

} // namespace changing_world

inline ChangingWorld::ChangingWorld( SeededRng& rng, bool with_reach )
{
	RandomRobotOptions options;
	options.joints = rng.integer( 2, 8 );
	options.size = 0.1;
	options.triangles = rng.integer( 1, 20 );
	options.meshShare = 0.7;
	options.floating = rng.integer( 0, 2 ) == 0;
	options.bareShare = rng.integer( 0, 1 ) == 0 ? 0.4 : 0;
	do
	{
		model = randomRobot( rng, options );
		model.worldFromRoot = lw_transform_identity();
		robot = leeway::Robot::adopt( model.create().release() );
		variables.clear();
		for ( std::uint32_t j = 0; j < lw_robot_joint_count( robot.get() ); ++j )
		{
			bool take = rng.integer( 0, 3 ) > 0;
			for ( std::uint32_t k = 0; take && k < lw_robot_joint_variable_count( robot.get(), j ); ++k )
			{
				variables.push_back( lw_robot_joint_variable( robot.get(), j ) + k );
			}
		}
	} while ( variables.empty() );
	bare = robot;
	reference = randomState( rng, robot.get() );
	lw_robot_interpolate( robot.get(), reference.data(), reference.data(), 0, reference.data() );
	if ( with_reach )
	{
		lw_reach_def def = lw_reach_def_default();
		def.robot = robot.get();
		def.seconds = 0;
		def.samples = 100;
		lw_reach* made = nullptr;
		lw_diag diag = {};
		leeway::require( lw_reach_create( &def, nullptr, &diag, &made ), diag );
		reach = leeway::Reach::adopt( made );
	}
	const int count = rng.integer( 0, 20 );
	for ( int i = 0; i < count; ++i )
	{
		objects.push_back( randomObject( rng ) );
	}
	max_d = rng.integer( 0, 2 ) > 0 ? INFINITY : rng.uniform( 0.05, 0.5 );
	scene = sceneFromNothing();
	checker = checkerFromNothing( robot, scene, reach );
}

inline lw_transform ChangingWorld::randomPose( SeededRng& rng ) const
{
	return randomTransform( rng, rng.integer( 0, 3 ) > 0 ? 0.7 : 3 );
}

inline ChangingObject ChangingWorld::randomObject( SeededRng& rng )
{
	ChangingObject object;
	object.name = "object" + std::to_string( m_made++ );
	const int count = rng.integer( 0, 9 ) == 0 ? 0 : rng.integer( 1, 3 ); // an object may be empty
	for ( int i = 0; i < count; ++i )
	{
		lw_shape* shape = rng.integer( 0, 2 ) > 0 ? randomMesh( rng, rng.integer( 1, 20 ), 0.15, nullptr )
		                                          : randomPrimitive( rng, 0.2, nullptr );
		if ( rng.integer( 0, 19 ) == 0 )
		{
			lw_shape_release( shape );
			leeway::require(
			    lw_shape_create_primitive( LW_SHAPE_HALFSPACE, nullptr, nullptr, nullptr, &shape ), "half-space" );
		}
		object.shapes.push_back( leeway::Shape::adopt( shape ) );
		object.poses.push_back( randomPose( rng ) );
	}
	return object;
}

inline leeway::Scene ChangingWorld::sceneFromNothing() const
{
	std::vector<const char*> names;
	std::vector<lw_scene_shape_def> shapes;
	for ( const ChangingObject& object : objects )
	{
		for ( std::size_t i = 0; i < object.shapes.size(); ++i )
		{
			shapes.push_back( { object.shapes[i].get(), static_cast<std::uint32_t>( names.size() ), object.poses[i] } );
		}
		names.push_back( object.name.c_str() );
	}
	lw_scene_def def = lw_scene_def_default();
	def.object_names = names.data();
	def.object_count = static_cast<std::uint32_t>( names.size() );
	def.shapes = shapes.data();
	def.shape_count = static_cast<std::uint32_t>( shapes.size() );
	lw_scene* made = nullptr;
	lw_diag diag = {};
	leeway::require( lw_scene_create( &def, nullptr, &diag, &made ), diag );
	return leeway::Scene::adopt( made );
}

inline leeway::Robot ChangingWorld::robotFromNothing() const
{
	RobotModel all;
	all.linkNames = model.linkNames;
	all.jointNames = model.jointNames;
	all.joints = model.joints;
	all.bodies = model.bodies;
	all.allowed = model.allowed;
	all.worldFromRoot = model.worldFromRoot;
	const auto link = [&]( const std::string& name )
	{
		auto found = std::find( all.linkNames.begin(), all.linkNames.end(), name );
		return static_cast<std::uint32_t>( found - all.linkNames.begin() );
	};
	for ( const ChangingObject& object : attached )
	{
		lw_joint_def joint = lw_joint_def_default();
		joint.parent = object.link;
		joint.child = static_cast<std::uint32_t>( all.linkNames.size() );
		all.linkNames.push_back( object.name );
		all.joints.push_back( joint );
		all.jointNames.push_back( object.name + "/attached" );
		for ( std::size_t i = 0; i < object.shapes.size(); ++i )
		{
			all.bodies.push_back( { object.shapes[i].get(), joint.child, object.poses[i] } );
		}
	}
	for ( const ChangingObject& object : attached )
	{
		for ( const std::string& touch : object.touch )
		{
			all.allowed.push_back( { link( object.name ), link( touch ) } );
		}
	}
	return leeway::Robot::adopt( all.create().release() );
}

inline std::vector<lw_link_object_pair> ChangingWorld::allowedPairs(
    const lw_robot* of_robot, const lw_scene* of_scene ) const
{
	std::vector<lw_link_object_pair> pairs;
	for ( const auto& [link, object] : allowed )
	{
		pairs.push_back(
		    { lw_robot_find_link( of_robot, link.c_str() ), lw_scene_find_object( of_scene, object.c_str() ) } );
	}
	return pairs;
}

inline leeway::Checker ChangingWorld::checkerFromNothing( const leeway::Robot& of_robot, const leeway::Scene& of_scene,
    const leeway::Reach& tables, const lw_checker* changes_of ) const
{
	const std::vector<lw_link_object_pair> pairs = allowedPairs( of_robot.get(), of_scene.get() );
	lw_checker_def def = lw_checker_def_default();
	def.robot = of_robot.get();
	def.scene = of_scene.get();
	def.variables = variables.data();
	def.variable_count = static_cast<std::uint32_t>( variables.size() );
	def.reference = reference.data();
	def.allowed = pairs.data();
	def.allowed_count = static_cast<std::uint32_t>( pairs.size() );
	def.reach = tables.get();
	def.previous = changes_of;
	def.only_changes = changes_of != nullptr;
	def.max_d = max_d;
	Margins margins;
	fillMargins( of_robot.get(), of_scene.get(), margins );
	def.margins = margins.def;
	lw_checker* made = nullptr;
	lw_diag diag = {};
	leeway::require( lw_checker_create( &def, nullptr, &diag, &made ), diag );
	return leeway::Checker::adopt( made );
}

inline State ChangingWorld::randomGroupState( SeededRng& rng, double excess ) const
{
	State full = randomState( rng, bare.get(), excess ), q;
	lw_robot_interpolate( bare.get(), full.data(), full.data(), 0, full.data() );
	for ( std::uint32_t variable : variables )
	{
		q.push_back( full[variable] );
	}
	return q;
}

// --- edits -----------------------------------------------------------------------------------------------------------

inline void ChangingWorld::fillMargins( const lw_robot* of_robot, const lw_scene* of_scene, Margins& out ) const
{
	const auto value = []( const std::map<std::string, double>& values, const char* name )
	{
		auto found = values.find( name );
		return found != values.end() ? found->second : 0;
	};
	for ( std::uint32_t i = 0; i < lw_robot_link_count( of_robot ); ++i )
	{
		out.link_environment.push_back( value( link_environment, lw_robot_link_name( of_robot, i ) ) );
		out.link_self.push_back( value( link_self, lw_robot_link_name( of_robot, i ) ) );
	}
	for ( std::uint32_t i = 0; i < lw_scene_object_count( of_scene ); ++i )
	{
		out.object.push_back( value( object_margin, lw_scene_object_name( of_scene, i ) ) );
	}
	for ( const auto& [pair, m] : environment_pairs )
	{
		out.environment_pairs.push_back( { lw_robot_find_link( of_robot, pair.first.c_str() ),
		    lw_scene_find_object( of_scene, pair.second.c_str() ), m } );
	}
	for ( const auto& [pair, m] : self_pairs )
	{
		out.self_pairs.push_back(
		    { lw_robot_find_link( of_robot, pair.first.c_str() ), lw_robot_find_link( of_robot, pair.second.c_str() ), m } );
	}
	out.def.environment = environment_margin;
	out.def.self = self_margin;
	out.def.link_environment = out.link_environment.data();
	out.def.link_self = out.link_self.data();
	out.def.object = out.object.data();
	out.def.environment_pairs = out.environment_pairs.data();
	out.def.environment_pair_count = static_cast<std::uint32_t>( out.environment_pairs.size() );
	out.def.self_pairs = out.self_pairs.data();
	out.def.self_pair_count = static_cast<std::uint32_t>( out.self_pairs.size() );
}

inline void ChangingWorld::forget( const std::string& name, bool object )
{
	const auto drop_pairs = [&]( auto& pairs, bool first, bool second )
	{
		for ( auto pair = pairs.begin(); pair != pairs.end(); )
		{
			bool gone = ( first && changing_world::key( *pair ).first == name ) ||
			            ( second && changing_world::key( *pair ).second == name );
			pair = gone ? pairs.erase( pair ) : std::next( pair );
		}
	};
	drop_pairs( allowed, !object, object );
	drop_pairs( environment_pairs, !object, object );
	drop_pairs( self_pairs, !object, !object );
	( object ? object_margin : link_environment ).erase( name );
	if ( !object )
	{
		link_self.erase( name );
	}
}

/// Another margin of something.
inline std::string ChangingWorld::margin( SeededRng& rng )
{
	const auto any_link = [&]() -> std::string
	{
		const int links = static_cast<int>( lw_robot_link_count( robot.get() ) );
		return lw_robot_link_name( robot.get(), static_cast<std::uint32_t>( rng.integer( 0, links - 1 ) ) );
	};
	const double value = rng.integer( 0, 3 ) > 0 ? rng.uniform( 0, 0.05 ) : 0;
	const std::string link = any_link(), other = any_link();
	const std::string object =
	    objects.empty() ? ""
	                    : objects[static_cast<std::size_t>( rng.integer( 0, static_cast<int>( objects.size() ) - 1 ) )].name;
	switch ( rng.integer( 0, objects.empty() ? 4 : 6 ) )
	{
	case 0:
		environment_margin = value;
		break;
	case 1:
		self_margin = value;
		break;
	case 2:
		link_environment[link] = value;
		break;
	case 3:
		link_self[link] = value;
		break;
	case 4:
		if ( link != other )
		{
			self_pairs[std::minmax( link, other )] = value;
		}
		break;
	case 5:
		object_margin[object] = value;
		break;
	default:
		environment_pairs[{ link, object }] = value;
		break;
	}
	edit( {}, robot, true );
	return "margin";
}

inline void ChangingWorld::edit( const std::vector<lw_scene_change>& changes, const leeway::Robot& next_robot, bool anew )
{
	lw_diag diag = {};
	lw_scene* next_scene = nullptr;
	leeway::require( lw_scene_edit( scene.get(), changes.data(), static_cast<std::uint32_t>( changes.size() ), nullptr,
	                     &diag, &next_scene ),
	    diag );
	scene = leeway::Scene::adopt( next_scene );
	robot = next_robot;
	const std::vector<lw_link_object_pair> pairs = allowedPairs( robot.get(), scene.get() );
	lw_checker_edit_def def = lw_checker_edit_def_default();
	def.scene = scene.get();
	def.robot = robot.get();
	Margins margins;
	fillMargins( robot.get(), scene.get(), margins );
	if ( anew )
	{
		def.allowed = pairs.data();
		def.allowed_count = static_cast<std::uint32_t>( pairs.size() );
		def.replace_allowed = true;
		def.margins = &margins.def;
	}
	def.max_d = max_d;
	lw_checker* next = nullptr;
	leeway::require( lw_checker_edit( checker.get(), &def, nullptr, &diag, &next ), diag );
	checker = leeway::Checker::adopt( next );
}

inline std::string ChangingWorld::move( SeededRng& rng )
{
	if ( objects.empty() )
	{
		return add( rng );
	}
	ChangingObject& object = objects[static_cast<std::size_t>( rng.integer( 0, static_cast<int>( objects.size() ) - 1 ) )];
	for ( lw_transform& pose : object.poses )
	{
		pose = rng.integer( 0, 4 ) > 0 ? randomPose( rng ) : pose;
	}
	edit( { { LW_SCENE_MOVE, object.name.c_str(), nullptr, object.poses.data(),
	          static_cast<std::uint32_t>( object.poses.size() ) } },
	    robot );
	return "move";
}

inline std::string ChangingWorld::add( SeededRng& rng )
{
	objects.push_back( randomObject( rng ) );
	const ChangingObject& object = objects.back();
	std::vector<const lw_shape*> shapes;
	edit( { { LW_SCENE_ADD, object.name.c_str(), changing_world::pointers( object, shapes ), object.poses.data(),
	          static_cast<std::uint32_t>( object.poses.size() ) } },
	    robot );
	return "add";
}

inline std::string ChangingWorld::drop( SeededRng& rng )
{
	if ( objects.empty() )
	{
		return add( rng );
	}
	const std::size_t at = static_cast<std::size_t>( rng.integer( 0, static_cast<int>( objects.size() ) - 1 ) );
	const std::string name = objects[at].name;
	objects.erase( objects.begin() + static_cast<std::ptrdiff_t>( at ) );
	forget( name, true );
	edit( { { LW_SCENE_REMOVE, name.c_str(), nullptr, nullptr, 0 } }, robot );
	return "remove";
}

inline std::string ChangingWorld::attach( SeededRng& rng )
{
	const auto bounded = [&]( const ChangingObject& object )
	{
		return std::all_of( object.shapes.begin(), object.shapes.end(),
		    []( const leeway::Shape& shape ) { return lw_shape_get_info( shape.get() ).type != LW_SHAPE_HALFSPACE; } );
	};
	auto found = std::find_if( objects.begin(), objects.end(), bounded );
	if ( found == objects.end() || attached.size() >= 4 )
	{
		return move( rng );
	}
	ChangingObject object = *found;
	objects.erase( found );
	forget( object.name, true );
	object.link = static_cast<std::uint32_t>( rng.integer( 0, static_cast<int>( lw_robot_link_count( bare.get() ) ) - 1 ) );
	std::vector<std::uint32_t> touch;
	for ( std::uint32_t link = 0; link < lw_robot_link_count( robot.get() ); ++link )
	{
		if ( rng.integer( 0, 3 ) == 0 )
		{
			touch.push_back( link );
			object.touch.emplace_back( lw_robot_link_name( robot.get(), link ) );
		}
	}
	for ( lw_transform& pose : object.poses )
	{
		pose = randomTransform( rng, 0.15 );
	}
	std::vector<const lw_shape*> shapes;
	lw_attachment_def def = lw_attachment_def_default();
	def.name = object.name.c_str();
	def.link = object.link;
	def.shapes = changing_world::pointers( object, shapes );
	def.link_from_shape = object.poses.data();
	def.shape_count = static_cast<std::uint32_t>( object.poses.size() );
	def.touch_links = touch.data();
	def.touch_link_count = static_cast<std::uint32_t>( touch.size() );
	lw_robot* made = nullptr;
	lw_diag diag = {};
	leeway::require( lw_robot_attach( robot.get(), &def, nullptr, &diag, &made ), diag );
	attached.push_back( object );
	edit( { { LW_SCENE_REMOVE, attached.back().name.c_str(), nullptr, nullptr, 0 } }, leeway::Robot::adopt( made ) );
	return "attach";
}

inline std::string ChangingWorld::detach( SeededRng& rng )
{
	if ( attached.empty() )
	{
		return attach( rng );
	}
	const std::size_t at = static_cast<std::size_t>( rng.integer( 0, static_cast<int>( attached.size() ) - 1 ) );
	ChangingObject object = attached[at];
	attached.erase( attached.begin() + static_cast<std::ptrdiff_t>( at ) );
	for ( ChangingObject& other : attached )
	{
		other.touch.erase( std::remove( other.touch.begin(), other.touch.end(), object.name ), other.touch.end() );
	}
	forget( object.name, false );
	object.link = LW_INVALID_INDEX;
	object.touch.clear();
	for ( lw_transform& pose : object.poses )
	{
		pose = randomPose( rng );
	}
	lw_robot* made = nullptr;
	lw_diag diag = {};
	leeway::require( lw_robot_detach( robot.get(), object.name.c_str(), nullptr, &diag, &made ), diag );
	objects.push_back( object );
	std::vector<const lw_shape*> shapes;
	edit( { { LW_SCENE_ADD, objects.back().name.c_str(), changing_world::pointers( object, shapes ), object.poses.data(),
	          static_cast<std::uint32_t>( object.poses.size() ) } },
	    leeway::Robot::adopt( made ) );
	return "detach";
}

/// Allows a contact or forbids it again, or asks for another max_d.
inline std::string ChangingWorld::allow( SeededRng& rng )
{
	if ( rng.integer( 0, 3 ) == 0 || objects.empty() )
	{
		max_d = rng.integer( 0, 2 ) > 0 ? INFINITY : rng.uniform( 0.05, 0.5 );
		edit( {}, robot );
		return "max_d";
	}
	const std::uint32_t links = lw_robot_link_count( robot.get() );
	const lw_clearance standing = lw_checker_get_info( checker.get() ).static_environment;
	// a checker remembers the nearest pair: as often as any other pair
	const bool nearest = standing.a != LW_INVALID_INDEX && rng.integer( 0, 1 ) == 0;
	const std::uint32_t link =
	    nearest ? standing.a : static_cast<std::uint32_t>( rng.integer( 0, static_cast<int>( links ) - 1 ) );
	const std::uint32_t object =
	    nearest ? standing.b : static_cast<std::uint32_t>( rng.integer( 0, static_cast<int>( objects.size() ) - 1 ) );
	if ( !allowed.empty() && rng.integer( 0, 1 ) == 0 )
	{
		allowed.erase( std::next( allowed.begin(), rng.integer( 0, static_cast<int>( allowed.size() ) - 1 ) ) );
	}
	else
	{
		allowed.insert( { lw_robot_link_name( robot.get(), link ), objects[object].name } );
	}
	edit( {}, robot, true );
	return "allow";
}

inline std::string ChangingWorld::change( SeededRng& rng )
{
	switch ( rng.integer( 0, 9 ) )
	{
	case 0:
	case 1:
		return add( rng );
	case 2:
		return drop( rng );
	case 3:
		return attach( rng );
	case 4:
		return detach( rng );
	case 5:
		return allow( rng );
	case 6:
		return margin( rng );
	default:
		return move( rng );
	}
}
