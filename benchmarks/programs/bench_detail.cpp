// SPDX-License-Identifier: BSD-3-Clause
// Gain by levels of detail: time of queries, bytes and triangles against tolerance, with the observed error.
//
// ARMAR-III in the cluttered kitchen, the states of bench_clearance. The tolerances take turns state by state. An answer
// with an error beyond the excesses, or one that is freer than the exact one, fails the run.
#include "support/bench_program.hpp"
#include "support/configurations.hpp"
#include "support/provenance.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <set>

namespace
{

using Json = nlohmann::ordered_json;

struct Settings
{
	std::string data = LEEWAY_DATA_DIR, json;
	std::vector<double> tolerances = { 0, 0.5, 2, 5 }; ///< millimetres; the first is the reference of the others
	std::size_t count = 200, repetitions = 9;
	std::uint64_t seed = 1;
	bool quick = false;
};

double seconds( clockid_t clock )
{
	timespec time;
	clock_gettime( clock, &time );
	return static_cast<double>( time.tv_sec ) + 1e-9 * static_cast<double>( time.tv_nsec );
}

/// Robot and scene at one tolerance.
struct Contender
{
	double tolerance = 0, seconds = 0; ///< of processor time from the files to all shapes
	leeway::io::Problem problem;
	leeway::Query query;
	std::size_t shapes = 0, same = 0, triangles = 0, bytes = 0;
	double robot_excess = 0, scene_excess = 0;
};

void count( const lw_shape* shape, std::set<const lw_shape*>& seen, Contender& c, double& excess )
{
	lw_diag diag{};
	leeway::require( lw_shape_complete( shape, &diag ), diag );
	const lw_shape_info info = lw_shape_get_info( shape );
	c.triangles += info.triangle_count;
	excess = std::max( excess, info.excess );
	if ( seen.insert( shape ).second )
	{
		++c.shapes;
		c.same += info.excess == 0 ? 1 : 0;
		c.bytes += info.bytes;
	}
}

Contender load( const Settings& settings, double tolerance )
{
	Contender c;
	c.tolerance = tolerance;
	const double start = seconds( CLOCK_PROCESS_CPUTIME_ID );
	c.problem = loadKitchen( settings.data, lw_tree_def_default(), 1e-3 * tolerance );
	std::set<const lw_shape*> seen;
	for ( std::uint32_t i = 0; i < lw_robot_body_count( c.problem.robot.get() ); ++i )
	{
		count( lw_robot_body( c.problem.robot.get(), i ).shape, seen, c, c.robot_excess );
	}
	for ( std::uint32_t i = 0; i < lw_scene_shape_count( c.problem.scene.get() ); ++i )
	{
		count( lw_scene_shape( c.problem.scene.get(), i ).shape, seen, c, c.scene_excess );
	}
	c.seconds = seconds( CLOCK_PROCESS_CPUTIME_ID ) - start;
	c.query = leeway::makeQuery( c.problem.checker.get() );
	return c;
}

struct Question
{
	const char* name;
	lw_check_flags flags;
	bool exact; ///< else: free or not
};
const Question QUESTIONS[] = { { "environment exact", LW_CHECK_ENVIRONMENT, true }, { "self exact", LW_CHECK_SELF, true },
	{ "valid (both)?", LW_CHECK_BOTH, false } };

/// One state, one question, one contender.
struct Answer
{
	double clearance = 0; ///< upper end
	double lower = 0;
	lw_verdict verdict = LW_VERDICT_UNKNOWN;
	double seconds = 0;   ///< median
};

Answer ask( const Contender& c, const Question& question, const std::vector<double>& state )
{
	const lw_range free_or_not = { 0, 1e-9, 0 };
	lw_state_result result;
	const double start = seconds( CLOCK_THREAD_CPUTIME_ID );
	leeway::require( lw_checker_state( c.problem.checker.get(), c.query.get(), state.data(), question.flags,
	                     question.exact ? nullptr : &free_or_not, false, &result ),
	    "lw_checker_state" );
	Answer answer;
	answer.seconds = seconds( CLOCK_THREAD_CPUTIME_ID ) - start;
	const lw_clearance& clearance = question.flags == LW_CHECK_SELF ? result.self : result.environment;
	answer.clearance = clearance.upper;
	answer.lower = clearance.lower;
	answer.verdict = result.verdict;
	return answer;
}

/// Results of one contender for one question over a set.
struct Sums
{
	std::vector<double> seconds;
	double error = 0, promise = 0; ///< metres
	std::size_t free = 0, wrong = 0;
};

void judge( const Question& question, const Contender& c, const Answer& exact, const Answer& answer, Sums& sums )
{
	constexpr double rounding = 1e-9;
	sums.seconds.push_back( answer.seconds );
	sums.free += answer.verdict == LW_VERDICT_FREE ? 1 : 0;
	if ( !question.exact )
	{
		sums.wrong += answer.verdict == LW_VERDICT_FREE && exact.verdict != LW_VERDICT_FREE ? 1 : 0;
		return;
	}
	sums.promise = c.robot_excess + ( question.flags == LW_CHECK_SELF ? c.robot_excess : c.scene_excess );
	const double error = exact.clearance - answer.clearance;
	sums.error = std::max( sums.error, error );
	sums.wrong += !( answer.lower <= exact.clearance + rounding ) || !( error <= sums.promise + rounding ) ? 1 : 0;
}

std::vector<Sums> race( const Settings& settings, const std::vector<Contender>& contenders, const Question& question,
    const std::vector<std::vector<double>>& states )
{
	std::vector<Sums> sums( contenders.size() );
	std::vector<std::vector<std::vector<double>>> times(
	    contenders.size(), std::vector<std::vector<double>>( states.size() ) );
	std::vector<std::vector<Answer>> answers( contenders.size(), std::vector<Answer>( states.size() ) );
	const std::size_t passes = settings.quick ? 1 : settings.repetitions;
	for ( std::size_t pass = 0; pass < passes; ++pass )
	{
		for ( std::size_t i = 0; i < states.size(); ++i )
		{
			for ( std::size_t k = 0; k < contenders.size(); ++k )
			{
				const std::size_t turn = ( k + i + pass ) % contenders.size();
				answers[turn][i] = ask( contenders[turn], question, states[i] );
				times[turn][i].push_back( answers[turn][i].seconds );
			}
		}
	}
	for ( std::size_t k = 0; k < contenders.size(); ++k )
	{
		for ( std::size_t i = 0; i < states.size(); ++i )
		{
			std::vector<double>& t = times[k][i];
			std::sort( t.begin(), t.end() );
			answers[k][i].seconds = t[t.size() / 2];
			judge( question, contenders[k], answers[0][i], answers[k][i], sums[k] );
		}
	}
	return sums;
}

double mean( const std::vector<double>& values )
{
	double sum = 0;
	for ( double value : values )
	{
		sum += value;
	}
	return sum / static_cast<double>( values.size() );
}

Json contendersJson( const std::vector<Contender>& contenders )
{
	Json json = Json::array();
	std::printf( "%8s %10s %10s %8s %10s %12s %12s %10s\n", "mm", "triangles", "bytes", "shapes", "unchanged",
	    "robot excess", "scene excess", "cpu s" );
	for ( const Contender& c : contenders )
	{
		std::printf( "%8g %10zu %10zu %8zu %10zu %12.3f %12.3f %10.2f\n", c.tolerance, c.triangles, c.bytes, c.shapes,
		    c.same, 1e3 * c.robot_excess, 1e3 * c.scene_excess, c.seconds );
		json.push_back( { { "tolerance_mm", c.tolerance }, { "triangles", c.triangles }, { "bytes", c.bytes },
		    { "shapes", c.shapes }, { "unchanged", c.same }, { "robot_excess_mm", 1e3 * c.robot_excess },
		    { "scene_excess_mm", 1e3 * c.scene_excess }, { "cpu_seconds", c.seconds } } );
	}
	return json;
}

int bench( const Settings& settings )
{
	std::vector<Contender> contenders;
	for ( double tolerance : settings.tolerances )
	{
		contenders.push_back( load( settings, tolerance ) );
	}
	Json json = provenance();
	json["seed"] = settings.seed;
	json["data_hash"] = hashFiles( kitchenFiles( settings.data ) );
	json["contenders"] = contendersJson( contenders );
	std::size_t wrong = 0;
	std::printf( "\n%-10s %-18s %8s %10s %8s %8s %12s %12s\n", "states", "query", "mm", "mean us", "ratio", "free",
	    "error mm", "promise mm" );
	for ( const ConfigurationSet& set :
	    makeConfigurations( contenders[0].problem, settings.data, settings.seed, settings.quick ? 10 : settings.count ) )
	{
		for ( const Question& question : QUESTIONS )
		{
			const std::vector<Sums> sums = race( settings, contenders, question, set.states );
			for ( std::size_t k = 0; k < sums.size(); ++k )
			{
				const double microseconds = 1e6 * mean( sums[k].seconds ),
				             ratio = mean( sums[0].seconds ) / mean( sums[k].seconds );
				std::printf( "%-10s %-18s %8g %10.2f %7.2fx %4zu/%-4zu %11.3f %12.3f\n", set.name.c_str(), question.name,
				    contenders[k].tolerance, microseconds, ratio, sums[k].free, set.states.size(), 1e3 * sums[k].error,
				    1e3 * sums[k].promise );
				json["queries"].push_back( { { "states", set.name }, { "query", question.name },
				    { "tolerance_mm", contenders[k].tolerance }, { "mean_us", microseconds }, { "ratio", ratio },
				    { "free", sums[k].free }, { "of", set.states.size() }, { "error_mm", 1e3 * sums[k].error },
				    { "promise_mm", 1e3 * sums[k].promise }, { "wrong", sums[k].wrong } } );
				wrong += sums[k].wrong;
			}
		}
	}
	std::printf( "%zu answers beyond the promise\n", wrong );
	json["beyond_promise"] = wrong;
	writeResult( settings.json, json );
	return wrong == 0 ? 0 : 1;
}

} // namespace

int main( int argc, char** argv )
{
	Settings settings;
	BenchProgram program( "bench_detail", "Levels of detail: speed and memory against tolerance." );
	program.option( "--data", settings.data, "folder with armar3 and kit_kitchen" );
	program.option( "--tolerances", settings.tolerances, "millimetres; the first is compared with" );
	program.option( "--count", settings.count, "states per set", { 1 } );
	program.option( "--repetitions", settings.repetitions, "passes", { 1 } );
	program.option( "--seed", settings.seed, "of the states" );
	program.option( "--json", settings.json, "result file" );
	program.flag( "--quick", settings.quick, "one pass over few states" );
	return program.run( argc, argv, [&] { return bench( settings ); } );
}
