// SPDX-License-Identifier: BSD-3-Clause
// Worlds of edges from their sources: see edge_worlds.hpp.
#include "support/edge_worlds.hpp"

#include "random_world.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <numeric>
#include <sstream>

namespace io = leeway::io;

namespace
{

std::vector<std::string> armarRequests( std::vector<int> numbers = {} )
{
	if ( numbers.empty() )
	{
		numbers.resize( 12 );
		std::iota( numbers.begin(), numbers.end(), 1 );
	}
	std::vector<std::string> files;
	for ( const int number : numbers )
	{
		char name[64];
		std::snprintf( name, sizeof name, "armar3/reach/%02d.yaml", number );
		files.push_back( name );
	}
	return files;
}

Json armarSource( const std::string& set, const std::string& name, const std::string& group )
{
	return { { "set", set }, { "name", set + "/" + name }, { "robot", "armar3/armar3.urdf" },
	    { "srdf", "armar3/armar3.srdf" }, { "scene", "kit_kitchen/scene_cluttered.yaml" }, { "group", group } };
}

/// Adds "a+b", the joints of both, to the groups of the model. A part may also be a joint.
void joinGroups( io::RobotModel& model, const std::string& name )
{
	if ( name.empty() || model.findGroup( name ) != nullptr )
	{
		return;
	}
	io::Group joined;
	joined.name = name;
	std::stringstream parts( name );
	for ( std::string part; std::getline( parts, part, '+' ); )
	{
		const io::Group* group = model.findGroup( part );
		if ( group != nullptr )
		{
			joined.joints.insert( joined.joints.end(), group->joints.begin(), group->joints.end() );
			continue;
		}
		joined.joints.push_back( part );
		if ( std::none_of(
		         model.joints.begin(), model.joints.end(), [&]( const io::JointModel& j ) { return j.name == part; } ) )
		{
			throw std::runtime_error(
			    "group " + name + ": '" + part + "' is neither a group nor a joint of " + model.urdf_file );
		}
	}
	model.groups.push_back( joined );
}

/// Pairs of a link and an object that the scene's allowed collision matrix allows. Every peer that checks pairs counts them
/// and compares with the checker's number (PairPeer).
std::vector<lw_link_object_pair> allowedContacts( const io::SceneModel& scene, const EdgeWorld& world )
{
	std::vector<lw_link_object_pair> pairs;
	const auto allow = [&]( const std::string& link, const std::string& object )
	{
		const lw_link_object_pair pair = { lw_robot_find_link( world.robot.get(), link.c_str() ),
		    lw_scene_find_object( world.scene.get(), object.c_str() ) };
		if ( pair.link != LW_INVALID_INDEX && pair.object != LW_INVALID_INDEX )
		{
			pairs.push_back( pair );
		}
	};
	for ( const auto& [a, b] : scene.allowed )
	{
		allow( a, b );
		allow( b, a );
	}
	const auto decided = [&]( const std::string& name )
	{ return std::find( scene.matrix_names.begin(), scene.matrix_names.end(), name ) != scene.matrix_names.end(); };
	for ( const std::string& name : scene.default_allowed )
	{
		for ( std::uint32_t i = 0; i < lw_scene_object_count( world.scene.get() ); ++i )
		{
			const std::string object = lw_scene_object_name( world.scene.get(), i );
			if ( !decided( name ) || !decided( object ) )
			{
				allow( name, object );
			}
		}
		for ( std::uint32_t i = 0; i < lw_robot_link_count( world.robot.get() ); ++i )
		{
			const std::string link = lw_robot_link_name( world.robot.get(), i );
			if ( !decided( name ) || !decided( link ) )
			{
				allow( link, name );
			}
		}
	}
	return pairs;
}

} // namespace

std::string EdgeWorlds::path( const Json& name ) const
{
	const std::filesystem::path file = name.get<std::string>();
	const bool is_here = file.is_absolute() || !std::filesystem::exists( m_data / file );
	return is_here ? file.string() : ( m_data / file ).string();
}

io::RobotModel& EdgeWorlds::robot( const Json& source )
{
	const std::string urdf = path( source.at( "robot" ) ),
	                  srdf = source.contains( "srdf" ) ? path( source.at( "srdf" ) ) : "";
	const auto [place, is_new] = m_robots.try_emplace( urdf + "," + srdf );
	if ( is_new )
	{
		place->second = io::loadRobot( urdf, srdf );
	}
	return place->second;
}

const io::SceneModel& EdgeWorlds::scene( const std::string& file )
{
	const auto [place, is_new] = m_scenes.try_emplace( file );
	if ( is_new )
	{
		place->second = io::loadScene( file );
	}
	return place->second;
}

void EdgeWorlds::addArmar( const std::string& group, const std::vector<int>& problems )
{
	const std::vector<std::string> requests = armarRequests( problems );
	if ( group.find( "platform" ) != std::string::npos )
	{
		Json source = armarSource( "armar3 " + group, "kitchen", group );
		source["request"] = requests[0];
		source["anchors"] = requests;
		source["anchored"] = { "X_Platform_joint", "Y_Platform_joint", "Yaw_Platform_joint" };
		add( source );
		return;
	}
	for ( const std::string& request : requests )
	{
		Json source = armarSource( "armar3 " + group, std::filesystem::path( request ).stem(), group );
		source["request"] = request;
		add( source );
	}
}

void EdgeWorlds::addArmarProblems()
{
	for ( const std::string& request : armarRequests() )
	{
		const std::string group = io::loadRequest( path( request ) ).group;
		Json source = armarSource( "armar3 planner", std::filesystem::path( request ).stem(), group );
		source["request"] = request;
		add( source );
	}
}

void EdgeWorlds::addMbm(
    const std::string& robot_name, const std::string& group, const std::vector<int>& numbers, const std::string& only )
{
	const std::string folder = "mbm/" + robot_name;
	std::vector<std::string> sets;
	for ( const auto& item : std::filesystem::directory_iterator( path( folder + "/problems" ) ) )
	{
		if ( item.path().filename().string().find( only ) != std::string::npos )
		{
			sets.push_back( item.path().filename() );
		}
	}
	std::sort( sets.begin(), sets.end() );
	for ( const std::string& set : sets )
	{
		for ( const int number : numbers )
		{
			char digits[16];
			std::snprintf( digits, sizeof digits, "%04d.yaml", number );
			const std::string name = robot_name + " " + group;
			if ( !std::filesystem::exists( path( folder + "/problems/" + set + "/request" + digits ) ) )
			{
				continue;
			}
			add( { { "set", name }, { "name", name + "/" + set + "/" + std::to_string( number ) },
			    { "robot", folder + "/" + robot_name + ".urdf" }, { "srdf", folder + "/" + robot_name + ".srdf" },
			    { "scene", folder + "/problems/" + set + "/scene" + digits },
			    { "request", folder + "/problems/" + set + "/request" + digits }, { "group", group } } );
		}
	}
}

std::vector<std::pair<std::string, std::string>> EdgeWorlds::mbmRobots() const
{
	std::vector<std::pair<std::string, std::string>> robots;
	for ( const auto& item : std::filesystem::directory_iterator( std::filesystem::path( m_data ) / "mbm" ) )
	{
		const std::filesystem::path problems = item.path() / "problems";
		if ( !std::filesystem::is_directory( problems ) || std::filesystem::is_empty( problems ) )
		{
			continue;
		}
		std::string group;
		for ( const auto& file : std::filesystem::recursive_directory_iterator( problems ) )
		{
			if ( file.path().filename() == "request0001.yaml" )
			{
				group = io::loadRequest( file.path().string() ).group;
				break;
			}
		}
		if ( group.empty() )
		{
			throw std::runtime_error(
			    problems.string() + ": no set has a request0001.yaml; unpack MotionBenchMaker's problems here" );
		}
		robots.emplace_back( item.path().filename().string(), group );
	}
	std::sort( robots.begin(), robots.end() );
	return robots;
}

void EdgeWorlds::addRandom( std::uint64_t seed, std::size_t count )
{
	for ( std::size_t i = 0; i < count; ++i )
	{
		const std::uint64_t own = seed * 1000003 + i;
		add( { { "set", "random robots" }, { "name", "random/" + std::to_string( own ) }, { "random", own } } );
	}
}

std::size_t EdgeWorlds::add( const Json& source )
{
	for ( std::size_t i = 0; i < m_entries.size(); ++i )
	{
		if ( m_entries[i]->source == source )
		{
			return i;
		}
	}
	auto entry = std::make_unique<EdgeWorldEntry>();
	entry->source = source;
	if ( source.contains( "random" ) )
	{
		entry->world = randomWorld( source.at( "random" ).get<std::uint64_t>() );
	}
	else
	{
		makeFromFiles( *entry );
	}
	entry->world.set = source.at( "set" ).get<std::string>();
	entry->world.name = source.at( "name" ).get<std::string>();
	m_entries.push_back( std::move( entry ) );
	return m_entries.size() - 1;
}

void EdgeWorlds::makeFromFiles( EdgeWorldEntry& entry )
{
	const Json& source = entry.source;
	io::RobotModel& model = robot( source );
	io::ProblemOptions options;
	options.group = source.value( "group", "" );
	joinGroups( model, options.group );
	io::Request request;
	if ( source.contains( "request" ) )
	{
		request = io::loadRequest( path( source.at( "request" ) ) );
		options.request = &request;
	}
	if ( source.contains( "start" ) )
	{
		for ( const auto& [variable, value] : source.at( "start" ).items() )
		{
			request.start.values[variable] = value.get<double>();
		}
		options.request = &request;
	}
	if ( source.contains( "scene" ) )
	{
		options.scene = &scene( path( source.at( "scene" ) ) );
	}
	if ( options.scene != nullptr && !options.scene->attached.empty() )
	{
		throw std::runtime_error(
		    options.scene->file + ": robot_state: attached objects cannot be audited; make them links of the robot" );
	}
	const io::Problem problem = io::buildProblem( model, options );
	leeway::Reach& reach = m_reaches[model.urdf_file + "," + model.srdf_file];
	if ( !reach )
	{
		io::ReachOptions reach_options;
		reach_options.def = m_reach_def;
		reach = io::loadReach( problem.robot, reach_options ).reach;
	}
	options.reach = reach;
	EdgeWorld& world = entry.world;
	world.robot = problem.robot;
	world.scene = problem.scene;
	world.checker = problem.checker;
	world.with_tables = io::buildProblem( model, options ).checker;
	world.variables = problem.variables;
	world.reference = problem.reference;
	if ( options.scene != nullptr )
	{
		world.allowed = allowedContacts( *options.scene, world );
	}
	if ( options.request != nullptr && request.group == options.group )
	{
		entry.start = io::startState( problem );
		entry.goal = io::goalState( problem, request );
	}
	if ( source.contains( "anchors" ) )
	{
		anchor( entry, problem.variable_names );
	}
}

void EdgeWorlds::anchor( EdgeWorldEntry& entry, const std::vector<std::string>& names ) const
{
	for ( const Json& file : entry.source.at( "anchors" ) )
	{
		const io::Request request = io::loadRequest( path( file ) );
		std::vector<double> state( names.size(), NAN );
		for ( std::size_t i = 0; i < names.size(); ++i )
		{
			const Json& anchored = entry.source.at( "anchored" );
			if ( std::find( anchored.begin(), anchored.end(), names[i] ) != anchored.end() )
			{
				state[i] = request.start.values.at( names[i] );
			}
		}
		entry.world.anchors.push_back( state );
	}
}
