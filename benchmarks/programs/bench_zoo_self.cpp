// SPDX-License-Identifier: BSD-3-Clause
// Exact self clearance of robots as they come: any URDF with its SRDF, all joints, random states.
//
// The first pass over the states pays for everything that is built on first use, so its slowest state is reported apart; the
// other passes show the times of a running planner. Counters of the query and a hash of all answers make two versions of the
// engine comparable on a busy machine.
#include "support/bench_program.hpp"
#include "peers/fcl_peer.hpp"
#include "groundtruth.hpp"
#include "leeway/io/model.hpp"
#include "leeway/prepare.hpp"
#include "peers/peer_engine.hpp"
#include "support/provenance.hpp"
#include "support/race.hpp"

#include <cmath>
#include <cstdio>
#include <cstring>
#include <dlfcn.h>
#include <filesystem>
#include <fmt/format.h>
#include <memory>
#include <random>

namespace
{

using Json = nlohmann::ordered_json;

constexpr double PI = 3.14159265358979323846;
constexpr double AGREEMENT = 1e-6; ///< metres, a peer against leeway

struct Settings
{
	std::vector<std::string> robots; ///< URDF[,SRDF[,GROUP]]
	std::size_t states = 300;
	int passes = 5;
	double budget = 0; ///< seconds of proofs; 0: none, no pair tables
	bool unprepared = false, no_warm = false;
	std::string peer, json;
	std::uint64_t seed = 20260101;
};

struct Subject
{
	std::string name;
	leeway::io::RobotModel robot;
	leeway::io::Problem problem;
	double load_ms = 0, build_ms = 0, prepare_ms = 0;
};

Subject makeSubject( const Settings& settings, const std::string& text )
{
	std::vector<std::string> parts = groundtruth::splitLine( text );
	parts.resize( std::max<std::size_t>( parts.size(), 3 ) );
	if ( parts.size() > 3 )
	{
		throw std::runtime_error( "--robot " + text + ": give URDF, URDF,SRDF or URDF,SRDF,GROUP" );
	}
	Subject subject;
	subject.name = std::filesystem::path( parts[0] ).stem().string();
	const double start = threadMicroseconds();
	subject.robot = leeway::io::loadRobot( parts[0], parts[1] );
	const double loaded = threadMicroseconds();
	leeway::io::ProblemOptions options;
	options.group = parts[2];
	if ( settings.budget > 0 )
	{
		leeway::io::ReachOptions reach;
		reach.def.seconds = settings.budget;
		options.find_reach = reach;
	}
	subject.problem = leeway::io::buildProblem( subject.robot, options );
	subject.load_ms = 1e-3 * ( loaded - start );
	const double built = threadMicroseconds();
	subject.build_ms = 1e-3 * ( built - loaded );
	if ( !settings.unprepared )
	{
		leeway::require( leeway::prepare( subject.problem.checker.get(), 1 ),
		    "meshes" ); // one thread: its processor time is all there is
	}
	subject.prepare_ms = 1e-3 * ( threadMicroseconds() - built );
	return subject;
}

/// Uniform within the limits; within a whole turn for wrapping variables; other variables keep their reference value.
std::vector<double> randomState( const leeway::io::Problem& problem, std::mt19937_64& random )
{
	std::vector<double> state;
	for ( const std::uint32_t variable : problem.variables )
	{
		const lw_variable_info info = lw_robot_variable( problem.robot.get(), variable );
		const bool limited = std::isfinite( info.lower ) && std::isfinite( info.upper );
		const double share = static_cast<double>( random() >> 11 ) * 0x1p-53;
		state.push_back( info.wraps ? ( 2 * share - 1 ) * PI
		                 : limited  ? info.lower + share * ( info.upper - info.lower )
		                            : problem.reference[variable] );
	}
	return state;
}

/// A module that was named: FCL is linked.
std::unique_ptr<PeerEngine> loadEngine( const std::string& file )
{
	void* module = dlopen( file.c_str(), RTLD_NOW | RTLD_LOCAL );
	if ( module == nullptr )
	{
		throw std::runtime_error( std::string( "--peer: " ) + dlerror() );
	}
	using Factory = PeerEngine* (*)();
	Factory factory = nullptr;
	void* symbol = dlsym( module, "leeway_peer_engine" );
	std::memcpy( &factory, &symbol, sizeof factory );
	if ( factory == nullptr )
	{
		throw std::runtime_error( "--peer " + file + ": exports no leeway_peer_engine" );
	}
	return std::unique_ptr<PeerEngine>( factory() );
}

class Bench
{
public:
	explicit Bench( const Settings& settings ) : m_settings( settings ) {}

	static void printHeader()
	{
		std::printf( "%-26s %5s %5s | %7s %7s %6s %6s | %8s %8s %8s | %7s %7s %7s %7s %7s | %8s | %s\n", "robot", "vars",
		    "pairs", "prepare", "1st ms", "worst", "ratio", "mean us", "median", "p95", "search", "node", "leaf", "tri",
		    "exact", "peer us", "answers" );
	}

	void run( Subject& subject )
	{
		const lw_checker* checker = subject.problem.checker.get();
		std::mt19937_64 random( m_settings.seed );
		ConfigurationSet set{ "random", "uniform within the limits", {} };
		for ( std::size_t i = 0; i < m_settings.states; ++i )
		{
			set.states.push_back( randomState( subject.problem, random ) );
		}
		lw_query_def def = lw_query_def_default();
		def.warm_start = !m_settings.no_warm;
		const leeway::Query query = leeway::makeQuery( checker, def );
		const auto ask = [&]( const double* q )
		{
			const lw_range exact = lw_range_exact();
			lw_state_result result;
			leeway::require( lw_checker_state( checker, query.get(), q, LW_CHECK_SELF, &exact, false, &result ), "a state" );
			return Answer{ result.self.lower, result.self.upper };
		};
		std::vector<double> first_times;
		std::vector<Answer> first_answers;
		Hash hash;
		for ( const std::vector<double>& q : set.states )
		{
			const double start = threadMicroseconds();
			const Answer answer = ask( q.data() );
			first_times.push_back( threadMicroseconds() - start );
			hash.add( std::llround( std::min( answer.upper, 1e3 ) * 1e12 ) );
			first_answers.push_back( answer );
		}
		countDifferences( checker, set, first_answers );
		lw_query_reset_stats( query.get() );
		for ( const std::vector<double>& q : set.states )
		{
			(void)ask( q.data() );
		}
		const lw_query_stats stats = lw_query_get_stats( query.get() );
		std::vector<Contender> contenders = { { "leeway", ask } };
		std::unique_ptr<PairPeer> peer;
		if ( !m_settings.peer.empty() )
		{
			peer = m_settings.peer == "fcl" ? std::make_unique<FclPeer>( checker )
			                                : std::make_unique<PairPeer>( checker, loadEngine( m_settings.peer ) );
			contenders.push_back( { "peer", [&peer]( const double* q )
				{
					peer->pose( q );
					const double d = peer->selfDistance( std::numeric_limits<double>::infinity() );
					return Answer{ d, d };
				} } );
		}
		const std::vector<Run> runs = race( contenders, set, m_settings.passes );
		report( subject, set, runs, first_times, stats, hash, peer.get() );
	}

	const Json& rows() const { return m_rows; }
	bool agreed() const { return m_agreed; }

private:
	/// A query without proofs, planes and memory has to give the same distances, to the last bit.
	void countDifferences( const lw_checker* checker, const ConfigurationSet& set, const std::vector<Answer>& answers )
	{
		lw_query_def def = lw_query_def_default();
		def.motion_hulls = def.pair_tables = def.planes = def.warm_start = false;
		const leeway::Query query = leeway::makeQuery( checker, def );
		m_differ = 0;
		m_largest = 0;
		for ( std::size_t i = 0; i < set.states.size(); ++i )
		{
			const lw_range exact = lw_range_exact();
			lw_state_result result;
			leeway::require(
			    lw_checker_state( checker, query.get(), set.states[i].data(), LW_CHECK_SELF, &exact, false, &result ),
			    "a state" );
			m_differ += result.self.upper != answers[i].upper;
			m_largest = std::max(
			    m_largest, result.self.upper == answers[i].upper ? 0 : std::abs( result.self.upper - answers[i].upper ) );
		}
	}

	void report( const Subject& subject, const ConfigurationSet& set, const std::vector<Run>& runs,
	    const std::vector<double>& first_times, const lw_query_stats& stats, const Hash& hash, const PairPeer* peer )
	{
		const lw_checker_info info = lw_checker_get_info( subject.problem.checker.get() );
		const double n = static_cast<double>( set.states.size() );
		const Summary s = summarise( runs[0].microseconds ),
		              p = runs.size() > 1 ? summarise( runs[1].microseconds ) : Summary{};
		double first = 0, worst = 0, worst_ratio = 0;
		for ( std::size_t i = 0; i < first_times.size(); ++i )
		{
			first += first_times[i];
			worst = std::max( worst, first_times[i] );
			worst_ratio = std::max( worst_ratio, first_times[i] / std::max( 1.0, runs[0].microseconds[i] ) );
		}
		std::size_t differ = 0;
		for ( std::size_t i = 0; peer != nullptr && i < set.states.size(); ++i )
		{
			differ += !(
			    std::abs( runs[0].answers[i].upper - runs[1].answers[i].upper ) <= AGREEMENT + peer->largestShapeError() );
		}
		const auto each = [n]( std::uint64_t count ) { return static_cast<double>( count ) / n; };
		const std::string note =
		    m_differ == 0 ? "" : fmt::format( "  {} differ without proofs, by {:.1e} m at the most", m_differ, m_largest );
		std::printf(
		    "%-26.26s %5zu %5u | %7.1f %7.1f %6.2f %6.1f | %8.1f %8.1f %8.1f | %7.1f %7.1f %7.1f %7.1f %7.1f | %8.1f | %s%s%s\n",
		    subject.name.c_str(), subject.problem.variables.size(), info.self_pairs, subject.prepare_ms, 1e-3 * first,
		    1e-3 * worst, worst_ratio, s.mean, s.median, s.p95, each( stats.queries ), each( stats.node_tests ),
		    each( stats.leaf_tests ), each( stats.triangle_tests ), each( stats.exact_tests ), p.mean, hash.text().c_str(),
		    note.c_str(), differ > 0 ? "  PEER DIFFERS" : "" );
		std::fflush( stdout );
		m_rows.push_back( Json{ { "robot", subject.name }, { "variables", subject.problem.variables.size() },
		    { "self_pairs", info.self_pairs }, { "load_ms", subject.load_ms }, { "build_ms", subject.build_ms },
		    { "prepare_ms", subject.prepare_ms }, { "first_pass_ms", 1e-3 * first }, { "worst_first_ms", 1e-3 * worst },
		    { "worst_first_ratio", worst_ratio }, { "leeway", toJson( s ) }, { "searches", each( stats.queries ) },
		    { "node_tests", each( stats.node_tests ) }, { "leaf_tests", each( stats.leaf_tests ) },
		    { "triangle_tests", each( stats.triangle_tests ) }, { "exact_tests", each( stats.exact_tests ) },
		    { "answers", hash.text() } } );
		if ( peer != nullptr )
		{
			m_rows.back()[peer->engine().name()] = toJson( p );
			m_rows.back()["disagreements"] = differ;
		}
		m_agreed = m_agreed && differ == 0;
	}

	const Settings& m_settings;
	std::size_t m_differ = 0; ///< of the last robot
	double m_largest = 0;     ///< metres
	Json m_rows = Json::array();
	bool m_agreed = true;
};

int run( const Settings& settings )
{
	Json json = { { "benchmark", "bench_zoo_self" } };
	json.update( provenance() );
	json["seed"] = settings.seed;
	json["states"] = settings.states;
	json["passes"] = settings.passes;
	json["budget_s"] = settings.budget;
	Bench bench( settings );
	Bench::printHeader();
	int failed = 0;
	for ( const std::string& robot : settings.robots )
	{
		try
		{
			Subject subject = makeSubject( settings, robot );
			bench.run( subject );
		}
		catch ( const std::exception& error )
		{
			std::printf( "%s: %s\n", robot.c_str(), error.what() );
			failed = 1;
		}
	}
	json["robots"] = bench.rows();
	writeResult( settings.json, json );
	return failed != 0 || !bench.agreed() ? 1 : 0;
}

} // namespace

int main( int argc, char** argv )
{
	Settings settings;
	BenchProgram program( "bench_zoo_self", "Exact self clearance of robots as they come." );
	program.option( "--robot", settings.robots, "URDF, URDF,SRDF or URDF,SRDF,GROUP; again for more" );
	program.option( "--states", settings.states, "random states per robot", { 1, 100000 } );
	program.option( "--passes", settings.passes, "passes over them after the first one", { 1, 1000 } );
	program.option( "--budget", settings.budget, "seconds of proofs for pair tables; 0 for none", { 0 } );
	program.flag( "--unprepared", settings.unprepared, "leave meshes to the states that need them first" );
	program.flag( "--no-warm", settings.no_warm, "no warm starts" );
	program.option( "--peer", settings.peer, "fcl, or a module such as leeway_peer_coal.so, in the same run" );
	program.option( "--seed", settings.seed, "of the random states" );
	program.option( "--json", settings.json, "write the figures and where they come from to this file" );
	return program.run( argc, argv,
		[&]
		{
			if ( settings.robots.empty() )
			{
				throw std::runtime_error( "--robot: give at least one" );
			}
			return run( settings );
		} );
}
