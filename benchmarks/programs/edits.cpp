// SPDX-License-Identifier: BSD-3-Clause
// Cost of a change of the world: each kind of edit against making everything anew.
//
// ARMAR-III, its right arm, in the cluttered KIT kitchen, all meshes made. Edits go through io::World, as a program would do
// them, and through the core's lw_scene_edit() and lw_checker_edit() alone; verdicts of random states must be those of a
// checker made from nothing.
#include "programs/commands.hpp"
#include "support/provenance.hpp"
#include "support/race.hpp"

#include "leeway/io/world.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <functional>
#include <map>
#include <random>

namespace
{

namespace io = leeway::io;

struct Settings
{
	std::string data = LEEWAY_DATA_DIR;
	int repetitions = 300;
	std::uint64_t seed = 1;
	bool quick = false;
};

double microseconds( const std::function<void()>& work )
{
	const auto start = std::chrono::steady_clock::now();
	work();
	return std::chrono::duration<double, std::micro>( std::chrono::steady_clock::now() - start ).count();
}

/// The same checker from nothing: scene and checker; the robot too if it holds something.
leeway::Checker rebuilt( const io::Problem& problem, const std::vector<lw_link_object_pair>& allowed )
{
	const lw_scene* scene = problem.scene.get();
	std::vector<const char*> names;
	std::vector<lw_scene_shape_def> shapes;
	for ( std::uint32_t i = 0; i < lw_scene_object_count( scene ); ++i )
	{
		names.push_back( lw_scene_object_name( scene, i ) );
	}
	for ( std::uint32_t i = 0; i < lw_scene_shape_count( scene ); ++i )
	{
		shapes.push_back( lw_scene_shape( scene, i ) );
	}
	lw_scene_def scene_def = lw_scene_def_default();
	scene_def.object_names = names.data();
	scene_def.object_count = static_cast<std::uint32_t>( names.size() );
	scene_def.shapes = shapes.data();
	scene_def.shape_count = static_cast<std::uint32_t>( shapes.size() );
	lw_scene* made = nullptr;
	leeway::require( lw_scene_create( &scene_def, nullptr, nullptr, &made ), "lw_scene_create" );
	const leeway::Scene owner = leeway::Scene::adopt( made );
	lw_checker_def def = lw_checker_def_default();
	def.robot = problem.robot.get();
	def.scene = made;
	def.variables = problem.variables.data();
	def.variable_count = static_cast<std::uint32_t>( problem.variables.size() );
	def.reference = problem.reference.data();
	def.allowed = allowed.data();
	def.allowed_count = static_cast<std::uint32_t>( allowed.size() );
	lw_checker* checker = nullptr;
	leeway::require( lw_checker_create( &def, nullptr, nullptr, &checker ), "lw_checker_create" );
	return leeway::Checker::adopt( checker );
}

class Edits
{
public:
	explicit Edits( const Settings& settings );
	int run( Result& result );

private:
	lw_transform near( const lw_transform& pose );
	void time( const char* kind, const std::function<void()>& work ) { m_times[kind].push_back( microseconds( work ) ); }
	void edit( int i );
	void compare();

	Settings m_settings;
	std::mt19937_64 m_random;
	io::RobotModel m_robot;
	io::SceneModel m_scene;
	std::unique_ptr<io::World> m_world;
	leeway::Query m_query;
	std::map<std::string, std::vector<double>> m_times;
	int m_states = 0, m_different = 0;
	Hash m_answers;
};

Edits::Edits( const Settings& settings ) : m_settings( settings ), m_random( settings.seed )
{
	io::LoadOptions load;
	load.defer = false;
	const io::Request request = io::loadRequest( settings.data + "/armar3/reach/01.yaml" );
	m_robot = io::loadRobot( settings.data + "/armar3/armar3.urdf", settings.data + "/armar3/armar3.srdf", load );
	m_scene = io::loadScene( settings.data + "/kit_kitchen/scene_cluttered.yaml", load );
	io::ProblemOptions options;
	options.group = "right_arm";
	options.scene = &m_scene;
	options.request = &request;
	m_world = std::make_unique<io::World>( m_robot, options );
}

lw_transform Edits::near( const lw_transform& pose )
{
	lw_transform moved = pose;
	for ( double& t : moved.t )
	{
		t += std::uniform_real_distribution<double>( -0.2, 0.2 )( m_random );
	}
	return moved;
}

/// Compares verdicts and intervals of the present snapshot with those of everything made anew, and times the latter.
void Edits::compare()
{
	const std::shared_ptr<const io::Problem> problem = m_world->problem();
	leeway::Checker fresh;
	time( "everything anew", [&] { fresh = rebuilt( *problem, {} ); } ); // this scene allows nothing
	const leeway::Query query = leeway::makeQuery( fresh.get() );
	if ( !lw_query_fits( m_query.get(), problem->checker.get() ) )
	{
		lw_query_def def = lw_query_def_default();
		def.spare_shapes = 8;
		def.spare_bodies = 2;
		m_query = leeway::makeQuery( problem->checker.get(), def );
	}
	for ( int k = 0; k < 4; ++k )
	{
		std::vector<double> q;
		for ( std::uint32_t variable : problem->variables )
		{
			const lw_variable_info info = lw_robot_variable( problem->robot.get(), variable );
			q.push_back( std::uniform_real_distribution<double>( info.lower, info.upper )( m_random ) );
		}
		lw_state_result x, y;
		lw_query_reset( m_query.get() );
		lw_query_reset( query.get() );
		leeway::require(
		    lw_checker_state( problem->checker.get(), m_query.get(), q.data(), LW_CHECK_BOTH, nullptr, false, &x ),
		    "state" );
		leeway::require(
		    lw_checker_state( fresh.get(), query.get(), q.data(), LW_CHECK_BOTH, nullptr, false, &y ), "state" );
		++m_states;
		m_different += x.verdict != y.verdict || x.environment.upper != y.environment.upper || x.self.upper != y.self.upper;
		m_answers.add( x.verdict );
	}
}

void Edits::edit( int i )
{
	const std::string object = m_scene.objects[static_cast<std::size_t>( i ) % m_scene.objects.size()].name;
	const lw_transform pose = m_world->problem()->object_poses.at( object );
	const std::vector<io::PlacedShape> shapes =
	    m_scene.objects[static_cast<std::size_t>( i ) % m_scene.objects.size()].shapes;
	time( "move", [&] { m_world->move( object, near( pose ) ); } );
	compare();
	time( "move back", [&] { m_world->move( object, pose ); } );
	time( "add", [&] { m_world->add( "fresh", shapes, near( lw_transform_identity() ) ); } );
	compare();
	time( "remove", [&] { m_world->remove( "fresh" ); } );
	time( "margin",
	    [&]
	    {
		    io::Margins margins;
		    margins.objects[object] = 0.01;
		    m_world->setMargins( margins );
	    } );
	time( "no margin", [&] { m_world->setMargins( {} ); } );
	time( "attach", [&] { m_world->attach( object, "TCP_R", {} ); } );
	compare();
	time( "detach", [&] { m_world->detach( object ); } );

	const std::shared_ptr<const io::Problem> problem = m_world->problem();
	const lw_scene* scene = problem->scene.get();
	const std::uint32_t index = lw_scene_find_object( scene, object.c_str() );
	std::vector<lw_transform> poses;
	for ( std::uint32_t k = 0; k < lw_scene_shape_count( scene ); ++k )
	{
		if ( lw_scene_shape( scene, k ).object == index )
		{
			poses.push_back( near( lw_scene_shape( scene, k ).world_from_shape ) );
		}
	}
	const lw_scene_change change = {
	    LW_SCENE_MOVE, object.c_str(), nullptr, poses.data(), static_cast<std::uint32_t>( poses.size() ) };
	lw_scene* moved = nullptr;
	time( "core: move in the scene",
	    [&] { leeway::require( lw_scene_edit( scene, &change, 1, nullptr, nullptr, &moved ), "lw_scene_edit" ); } );
	const leeway::Scene owner = leeway::Scene::adopt( moved );
	lw_checker_edit_def def = lw_checker_edit_def_default();
	def.scene = moved;
	lw_checker* next = nullptr;
	time( "core: its checker",
	    [&] {
		    leeway::require( lw_checker_edit( problem->checker.get(), &def, nullptr, nullptr, &next ), "lw_checker_edit" );
	    } );
	lw_checker_release( next );
}

int Edits::run( Result& result )
{
	for ( int i = 0; i < ( m_settings.quick ? 10 : m_settings.repetitions ); ++i )
	{
		edit( i );
	}
	result["objects"] = lw_scene_object_count( m_world->problem()->scene.get() );
	std::printf( "%-26s %12s %12s %12s\n", "", "least us", "median us", "95 % us" );
	for ( auto& [kind, times] : m_times )
	{
		std::sort( times.begin(), times.end() );
		const Summary s = summarise( times );
		std::printf( "%-26s %12.1f %12.1f %12.1f\n", kind.c_str(), times.front(), s.median, s.p95 );
		Json row = { { "edit", kind }, { "least_us", rounded( times.front() ) } };
		row.update( toJson( s ) );
		result.add( std::move( row ) );
	}
	result["states"] = m_states;
	result["different_answers"] = m_different;
	result["answers_hash"] = m_answers.text();
	std::printf( "%d of %d answers differ\n", m_different, m_states );
	return m_different == 0 ? 0 : 1;
}

} // namespace

void addEdits( Bench& bench )
{
	const auto s = std::make_shared<Settings>();
	Command& command = bench.command( "edits", "what a change of the world costs" );
	command.option( "--data", s->data, "folder with armar3 and kit_kitchen" );
	command.option( "--repetitions", s->repetitions, "rounds of all kinds of edits", { 1 } );
	command.option( "--seed", s->seed, "of poses and states" );
	command.flag( "--quick", s->quick, "ten rounds" );
	command.work(
	    [s]( Result& result )
	    {
		    requireData( s->data, "kit_kitchen" );
		    return Edits( *s ).run( result );
	    } );
}
