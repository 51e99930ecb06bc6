// SPDX-License-Identifier: BSD-3-Clause
// From files to the first answer: all meshes built, only the required ones, and with a warm cache.
//
// ARMAR-III, its right arm, parked at the sink of the cluttered KIT kitchen. Contenders take turns; each start reads all
// files again (the system's file cache is warm). The state's answer must be the same to the bit.
#include "support/bench_program.hpp"
#include "leeway/io/model.hpp"
#include "support/provenance.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>

namespace
{

namespace io = leeway::io;
using Json = nlohmann::ordered_json;

struct Settings
{
	std::string data = LEEWAY_DATA_DIR, json, cache = "bench_startup_cache";
	int repetitions = 15;
	bool quick = false;
};

struct Contender
{
	const char* name;
	bool defer, cache;
	unsigned threads;
};

const Contender CONTENDERS[] = {
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

double cpuClock()
{
	timespec time;
	clock_gettime( CLOCK_PROCESS_CPUTIME_ID, &time );
	return 1e3 * static_cast<double>( time.tv_sec ) + 1e-6 * static_cast<double>( time.tv_nsec );
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

Start run( const Settings& settings, const Contender& contender )
{
	Start start;
	io::LoadOptions load;
	load.defer = contender.defer;
	load.cache = contender.cache ? settings.cache : "";
	double wall = wallClock(), cpu = cpuClock(), last = wall;
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
	options.threads = contender.threads;
	const io::Problem problem = io::buildProblem( robot, options );
	note( CHECKER );
	const leeway::Query query = leeway::makeQuery( problem.checker.get() );
	const std::vector<double> q = io::startState( problem );
	leeway::require(
	    lw_checker_state( problem.checker.get(), query.get(), q.data(), LW_CHECK_BOTH, nullptr, false, &start.answer ),
	    "lw_checker_state" );
	note( ANSWER );
	start.wall = wallClock() - wall;
	start.cpu = cpuClock() - cpu;
	count( problem, start );
	return start;
}

bool sameAnswer( const lw_state_result& a, const lw_state_result& b )
{
	return a.verdict == b.verdict && a.environment.upper == b.environment.upper &&
	       a.environment.lower == b.environment.lower && a.self.upper == b.self.upper && a.self.lower == b.self.lower;
}

double median( std::vector<double> values )
{
	std::sort( values.begin(), values.end() );
	return values[values.size() / 2];
}

Json summary( const std::vector<Start>& starts )
{
	std::vector<double> wall, cpu;
	Json json;
	for ( const Start& start : starts )
	{
		wall.push_back( start.wall );
		cpu.push_back( start.cpu );
	}
	json["wall_ms"] = { { "median", median( wall ) }, { "least", *std::min_element( wall.begin(), wall.end() ) } };
	json["cpu_ms"] = { { "median", median( cpu ) }, { "least", *std::min_element( cpu.begin(), cpu.end() ) } };
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

int bench( const Settings& settings )
{
	constexpr std::size_t contenders = std::size( CONTENDERS );
	std::vector<Start> starts[contenders];
	int different = 0;
	(void)run( settings, CONTENDERS[contenders - 1] ); // fills the cache
	for ( int i = 0; i < ( settings.quick ? 2 : settings.repetitions ); ++i )
	{
		for ( std::size_t k = 0; k < contenders; ++k )
		{
			starts[k].push_back( run( settings, CONTENDERS[k] ) );
			different += !sameAnswer( starts[k].back().answer, starts[0].front().answer );
		}
	}
	Json json = provenance();
	std::printf( "%-22s %10s %10s %8s %8s %14s %18s\n", "", "median ms", "least ms", "cpu ms", "ratio", "obstacles",
	    "triangles made" );
	const double everything = summary( starts[0] )["wall_ms"]["least"];
	for ( std::size_t k = 0; k < contenders; ++k )
	{
		Json one = summary( starts[k] );
		const double least = one["wall_ms"]["least"];
		one["ratio"] = everything / least;
		std::printf( "%-22s %10.2f %10.2f %8.2f %7.2fx %4zu of %3zu kept %8zu of %zu\n", CONTENDERS[k].name,
		    one["wall_ms"]["median"].get<double>(), least, one["cpu_ms"]["least"].get<double>(), everything / least,
		    starts[k].back().kept, starts[k].back().obstacles, starts[k].back().made_triangles, starts[k].back().triangles );
		json["contenders"][CONTENDERS[k].name] = one;
	}
	json["different_answers"] = different;
	std::printf( "%d answers differ\n", different );
	writeResult( settings.json, json );
	return different == 0 ? 0 : 1;
}

} // namespace

int main( int argc, char** argv )
{
	Settings settings;
	BenchProgram program( "bench_startup", "Start-up: from files to the first answer." );
	program.option( "--data", settings.data, "folder with armar3 and kit_kitchen" );
	program.option( "--cache", settings.cache, "folder of the warm cache" );
	program.option( "--repetitions", settings.repetitions, "starts of each contender", { 1 } );
	program.option( "--json", settings.json, "result file" );
	program.flag( "--quick", settings.quick, "two repetitions" );
	return program.run( argc, argv, [&] { return bench( settings ); } );
}
