// SPDX-License-Identifier: BSD-3-Clause
// From files to the first answer: all meshes built, only the required ones, and with a warm cache.
//
// ARMAR-III, its right arm, parked at the sink of the cluttered KIT kitchen. Ways take turns; each start reads all
// files again (the system's file cache is warm). The state's answer must be the same to the bit.
#include "programs/commands.hpp"
#include "support/race.hpp"
#include "support/temporary_folder.hpp"

#include "leeway/io/model.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>

namespace
{

namespace io = leeway::io;

struct Settings
{
	std::string data = LEEWAY_DATA_DIR, cache;
	int repetitions = 15;
	bool quick = false;
};

struct Way
{
	const char* name;
	bool defer, cache;
	unsigned threads;
};

const Way WAYS[] = {
    { "everything", false, false, 1 },
    { "required", true, false, 2 },
    { "required, one thread", true, false, 1 },
    { "required, warm cache", true, true, 2 },
};

enum Stage
{
	REQUEST,
	ROBOT,
	SCENE,
	CHECKER,
	ANSWER,
	STAGES
};
const char* const STAGE_NAMES[] = { "request", "robot", "scene", "checker", "answer" };

/// Times and results of one start.
struct Start
{
	double stage[STAGES] = {};
	double wall = 0, cpu = 0; ///< milliseconds
	lw_state_result answer{};
	std::size_t obstacles = 0, kept = 0, made = 0, triangles = 0, made_triangles = 0;
};

double wallClock()
{
	return std::chrono::duration<double, std::milli>( std::chrono::steady_clock::now().time_since_epoch() ).count();
}

void count( const io::Problem& problem, Start& start )
{
	const auto add = [&]( const lw_shape* shape )
	{
		const lw_shape_info info = lw_shape_peek_info( shape );
		start.triangles += info.triangle_count;
		start.made_triangles += info.deferred ? 0 : info.triangle_count;
		return !info.deferred;
	};
	for ( uint32_t i = 0; i < lw_robot_body_count( problem.robot.get() ); ++i )
	{
		add( lw_robot_body( problem.robot.get(), i ).shape );
	}
	start.obstacles = lw_scene_shape_count( problem.scene.get() ); // one shape each
	for ( uint32_t i = 0; i < start.obstacles; ++i )
	{
		start.made += add( lw_scene_shape( problem.scene.get(), i ).shape );
	}
	start.kept = lw_checker_get_info( problem.checker.get() ).near_shapes;
}

Start run( const Settings& settings, const Way& way )
{
	Start start;
	io::LoadOptions load;
	load.defer = way.defer;
	load.cache = way.cache ? settings.cache : "";
	double wall = wallClock(), cpu = processMicroseconds(), last = wall;
	const auto note = [&]( Stage stage )
	{
		const double now = wallClock();
		start.stage[stage] = now - last;
		last = now;
	};
	const io::Request request = io::loadRequest( settings.data + "/armar3/reach/01.yaml" );
	note( REQUEST );
	const io::RobotModel robot =
	    io::loadRobot( settings.data + "/armar3/armar3.urdf", settings.data + "/armar3/armar3.srdf", load );
	note( ROBOT );
	const io::SceneModel scene = io::loadScene( settings.data + "/kit_kitchen/scene_cluttered.yaml", load );
	note( SCENE );
	io::ProblemOptions options;
	options.group = "right_arm";
	options.scene = &scene;
	options.request = &request;
	options.threads = way.threads;
	const io::Problem problem = io::buildProblem( robot, options );
	note( CHECKER );
	const leeway::Query query = leeway::makeQuery( problem.checker.get() );
	const std::vector<double> q = io::startState( problem );
	leeway::require(
	    lw_checker_state( problem.checker.get(), query.get(), q.data(), LW_CHECK_BOTH, nullptr, false, &start.answer ),
	    "lw_checker_state" );
	note( ANSWER );
	start.wall = wallClock() - wall;
	start.cpu = 1e-3 * ( processMicroseconds() - cpu );
	count( problem, start );
	return start;
}

bool sameAnswer( const lw_state_result& a, const lw_state_result& b )
{
	return a.verdict == b.verdict && a.environment.upper == b.environment.upper &&
	       a.environment.lower == b.environment.lower && a.self.upper == b.self.upper && a.self.lower == b.self.lower;
}

Json summary( const std::vector<Start>& starts )
{
	std::vector<double> wall, cpu;
	Json json;
	for ( const Start& start : starts )
	{
		wall.push_back( 1e3 * start.wall );
		cpu.push_back( 1e3 * start.cpu );
	}
	for ( const auto& [name, times] : { std::pair( "wall", &wall ), std::pair( "cpu", &cpu ) } )
	{
		json[name] = toJson( summarise( *times ) );
		json[name]["least_us"] = rounded( *std::min_element( times->begin(), times->end() ) );
	}
	for ( int stage = 0; stage < STAGES; ++stage )
	{
		std::vector<double> values;
		for ( const Start& start : starts )
		{
			values.push_back( start.stage[stage] );
		}
		json["stages_ms"][STAGE_NAMES[stage]] = median( values );
	}
	const Start& last = starts.back();
	json["obstacles"] = last.obstacles;
	json["obstacles_kept"] = last.kept;
	json["obstacles_made"] = last.made;
	json["triangles"] = last.triangles;
	json["triangles_made"] = last.made_triangles;
	return json;
}

int measure( const Settings& settings, Result& result )
{
	constexpr std::size_t contenders = std::size( WAYS );
	std::vector<Start> starts[contenders];
	int different = 0;
	(void)run( settings, WAYS[contenders - 1] ); // fills the cache
	for ( int i = 0; i < ( settings.quick ? 2 : settings.repetitions ); ++i )
	{
		for ( std::size_t k = 0; k < contenders; ++k )
		{
			starts[k].push_back( run( settings, WAYS[k] ) );
			different += !sameAnswer( starts[k].back().answer, starts[0].front().answer );
		}
	}
	std::printf( "%-22s %10s %10s %8s %8s %14s %18s\n", "", "median ms", "least ms", "cpu ms", "ratio", "obstacles",
	    "triangles made" );
	const double everything = summary( starts[0] )["wall"]["least_us"];
	for ( std::size_t k = 0; k < contenders; ++k )
	{
		Json one = { { "way", WAYS[k].name } };
		one.update( summary( starts[k] ) );
		const double least = one["wall"]["least_us"];
		one["ratio"] = everything / least;
		std::printf( "%-22s %10.2f %10.2f %8.2f %7.2fx %4zu of %3zu kept %8zu of %zu\n", WAYS[k].name,
		    1e-3 * one["wall"]["median_us"].get<double>(), 1e-3 * least, 1e-3 * one["cpu"]["least_us"].get<double>(),
		    everything / least, starts[k].back().kept, starts[k].back().obstacles, starts[k].back().made_triangles,
		    starts[k].back().triangles );
		result.add( std::move( one ) );
	}
	result["different_answers"] = different;
	std::printf( "%d answers differ\n", different );
	return different == 0 ? 0 : 1;
}

} // namespace

void addStartup( Bench& bench )
{
	const auto s = std::make_shared<Settings>();
	Command& command = bench.command( "startup", "from files to the first answer" );
	command.option( "--data", s->data, "folder with armar3 and kit_kitchen" );
	command.option( "--cache", s->cache, "folder of the warm cache; none: a temporary one" );
	command.option( "--repetitions", s->repetitions, "starts of each way", { 1 } );
	command.flag( "--quick", s->quick, "two repetitions" );
	command.work(
	    [s]( Result& result )
	    {
		    requireData( s->data, "kit_kitchen" );
		    const TemporaryFolder temporary;
		    s->cache = s->cache.empty() ? temporary.path().string() : s->cache;
		    return measure( *s, result );
	    } );
}
