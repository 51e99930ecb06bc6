// SPDX-License-Identifier: BSD-3-Clause
// Edges: the certified validator against OMPL's discrete one at 1 % of the space's extent, over FCL and over leeway's own
// state checker, the same edges interleaved one by one. Exit status 1 if a certificate is refuted.
//
// The discrete contenders do what ompl::base::DiscreteMotionValidator does (the end first, then halving, breadth first), in
// joint vectors without OMPL around them. An edge is FREE, BLOCKED or REFUSED by the certificate; times are reported for
// the edges that are free, and for the others.
#include "configurations.hpp"
#include "fcl_peer.hpp"
#include "provenance.hpp"
#include "race.hpp"

#include <CLI/CLI.hpp>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <memory>
#include <queue>
#include <random>

namespace
{

using Json = nlohmann::ordered_json;
namespace io = leeway::io;

struct Settings
{
	std::string data = LEEWAY_DATA_DIR, json;
	std::size_t edges = 300;
	int repetitions = 3;
	std::uint64_t seed = 20260101;
	double budget = 2, resolution = 0.01;
};

/// A robot and scene with the joints outside of its group where they stand, and everybody's own data for it.
struct World
{
	io::Problem problem;
	leeway::Checker with_tables; ///< the same checker with motion hulls and pair tables
	leeway::Query query, table_query, audit_query;
	std::unique_ptr<FclPeer> fcl;
};

/// The numbers of one edge: world, from, to.
using Edge = std::vector<double>;

double uniform( std::mt19937_64& random )
{
	return static_cast<double>( random() >> 11 ) * 0x1p-53;
}

/// Longest edge of the group's joint box, which OMPL's resolution is a fraction of.
double extentOf( const io::Problem& problem )
{
	double sum = 0;
	for ( std::uint32_t variable : problem.variables )
	{
		const lw_variable_info info = lw_robot_variable( problem.robot.get(), variable );
		sum += ( info.upper - info.lower ) * ( info.upper - info.lower );
	}
	return std::sqrt( sum );
}

double lengthOf( const double* a, const double* b, std::size_t size )
{
	double sum = 0;
	for ( std::size_t i = 0; i < size; ++i )
	{
		sum += ( b[i] - a[i] ) * ( b[i] - a[i] );
	}
	return std::sqrt( sum );
}

/// As DiscreteMotionValidator::checkMotion( s1, s2 ): s1 is taken for valid.
template <typename IsValid>
bool discrete( const double* a, const double* b, std::size_t size, double step, const IsValid& is_valid )
{
	if ( !is_valid( b ) )
	{
		return false;
	}
	const int count = static_cast<int>( std::ceil( lengthOf( a, b, size ) / step ) );
	std::vector<double> state( size );
	std::queue<std::pair<int, int>> parts;
	if ( count >= 2 )
	{
		parts.emplace( 1, count - 1 );
	}
	while ( !parts.empty() )
	{
		const auto [first, last] = parts.front();
		parts.pop();
		const int middle = ( first + last ) / 2;
		for ( std::size_t i = 0; i < size; ++i )
		{
			state[i] = a[i] + ( b[i] - a[i] ) * middle / count;
		}
		if ( !is_valid( state.data() ) )
		{
			return false;
		}
		if ( first < middle )
		{
			parts.emplace( first, middle - 1 );
		}
		if ( middle < last )
		{
			parts.emplace( middle + 1, last );
		}
	}
	return true;
}

class Comparison
{
public:
	explicit Comparison( const Settings& settings ) : m_settings( settings ), m_random( settings.seed )
	{
		const std::string armar = settings.data + "/armar3/armar3";
		m_robot = io::loadRobot( armar + ".urdf", armar + ".srdf" );
		m_scene = io::loadScene( settings.data + "/kit_kitchen/scene_cluttered.yaml" );
		for ( int i = 1; i <= 12; ++i )
		{
			char name[64];
			std::snprintf( name, sizeof name, "/armar3/reach/%02d.yaml", i );
			addWorld( settings.data + name );
		}
		m_size = m_worlds[0].problem.variables.size();
		m_extent = extentOf( m_worlds[0].problem );
	}

	int run()
	{
		std::printf( "ARMAR-III, group %s, %zu joints, extent %.3f; step of the discrete contenders %.4f\n", GROUP, m_size, m_extent,
			m_settings.resolution * m_extent );
		std::printf( "microseconds per edge\n%-5s %-6s %-8s %5s | %8s %8s | %8s %8s | %8s %8s %7s | %8s %8s %7s | %7s %7s %7s\n", "set", "rad",
			"verdict", "n", "FCL 1 %", "mean", "own 1 %", "mean", "certif.", "mean", "queries", "tables", "mean", "queries", "FCL/c",
			"own/c", "own/t" );
		Json rows = Json::array();
		for ( const bool near : { true, false } )
		{
			for ( const double length : { 0.1, 0.5, 2.0 } )
			{
				compare( near, length, rows );
			}
		}
		std::printf( "certificates that a dense look refutes: %zu; free by the certificate and blocked by a discrete contender: %zu\n",
			m_refuted, m_contradicted );
		if ( !m_settings.json.empty() )
		{
			std::ofstream( m_settings.json ) << Json{ { "provenance", provenance() }, { "seed", m_settings.seed },
				{ "edges", m_settings.edges }, { "resolution", m_settings.resolution }, { "extent", m_extent }, { "rows", rows } }.dump( 2 )
											 << "\n";
		}
		return m_refuted + m_contradicted > 0 ? 1 : 0;
	}

private:
	static constexpr const char* GROUP = "torso_right_arm";

	void addWorld( const std::string& request_file )
	{
		const io::Request request = io::loadRequest( request_file );
		io::ProblemOptions options;
		options.group = GROUP;
		options.scene = &m_scene;
		options.request = &request;
		World world;
		world.problem = io::buildProblem( m_robot, options );
		if ( !m_reach )
		{
			lw_reach_def def = lw_reach_def_default();
			def.robot = world.problem.robot.get();
			def.seconds = m_settings.budget;
			lw_diag diag{};
			lw_reach* reach = nullptr;
			leeway::require( lw_reach_create( &def, nullptr, &diag, &reach ), diag );
			m_reach = leeway::Reach::adopt( reach );
		}
		lw_checker_def def = lw_checker_def_default();
		def.robot = world.problem.robot.get();
		def.scene = world.problem.scene.get();
		def.variables = world.problem.variables.data();
		def.variable_count = static_cast<std::uint32_t>( world.problem.variables.size() );
		def.reference = world.problem.reference.data();
		def.reach = m_reach.get();
		lw_diag diag{};
		lw_checker* checker = nullptr;
		leeway::require( lw_checker_create( &def, nullptr, &diag, &checker ), diag );
		world.with_tables = leeway::Checker::adopt( checker );
		world.query = leeway::makeQuery( world.problem.checker.get() );
		world.table_query = leeway::makeQuery( world.with_tables.get() );
		world.audit_query = leeway::makeQuery( world.problem.checker.get() );
		world.fcl = std::make_unique<FclPeer>( world.problem.checker.get() );
		m_worlds.push_back( std::move( world ) );
	}

	bool isFree( const World& world, lw_query* query, const lw_checker* checker, const double* q ) const
	{
		(void)world;
		const lw_range range = { 0, std::nextafter( 0.0, 1.0 ), 0 };
		lw_state_result result;
		leeway::require( lw_checker_state( checker, query, q, LW_WHAT_BOTH, &range, true, &result ), "a state" );
		return result.verdict == LW_VERDICT_FREE;
	}

	/// A random free state of a random base; near: within 50 mm of the environment.
	Edge start( bool near )
	{
		while ( true )
		{
			const std::size_t w = m_random() % m_worlds.size();
			const World& world = m_worlds[w];
			Edge edge = { static_cast<double>( w ) };
			for ( std::uint32_t variable : world.problem.variables )
			{
				const lw_variable_info info = lw_robot_variable( world.problem.robot.get(), variable );
				edge.push_back( info.lower + uniform( m_random ) * ( info.upper - info.lower ) );
			}
			const lw_range range = { 0, 0.05, 0 };
			lw_state_result result;
			leeway::require( lw_checker_state( world.problem.checker.get(), world.audit_query.get(), edge.data() + 1, LW_WHAT_BOTH, &range,
								 false, &result ),
				"a state" );
			if ( result.verdict == LW_VERDICT_FREE && ( !near || result.environment.kind == LW_CLEARANCE_NEAR ) )
			{
				return edge;
			}
		}
	}

	/// To a free state in a random direction, inside the limits.
	Edge makeEdge( bool near, double length )
	{
		std::normal_distribution<double> normal;
		while ( true )
		{
			Edge edge = start( near );
			const World& world = m_worlds[static_cast<std::size_t>( edge[0] )];
			for ( int attempt = 0; attempt < 20; ++attempt )
			{
				std::vector<double> direction( m_size ), end( m_size );
				double norm = 0;
				for ( double& d : direction )
				{
					d = normal( m_random );
					norm += d * d;
				}
				bool inside = true;
				for ( std::size_t i = 0; i < m_size; ++i )
				{
					const lw_variable_info info = lw_robot_variable( world.problem.robot.get(), world.problem.variables[i] );
					end[i] = edge[1 + i] + direction[i] * length / std::sqrt( norm );
					inside = inside && end[i] >= info.lower && end[i] <= info.upper;
				}
				if ( inside && isFree( world, world.audit_query.get(), world.problem.checker.get(), end.data() ) )
				{
					edge.insert( edge.end(), end.begin(), end.end() );
					return edge;
				}
			}
		}
	}

	World& worldOf( const double* edge ) { return m_worlds[static_cast<std::size_t>( edge[0] )]; }

	/// lower = verdict, upper = states measured.
	Answer certify( const double* edge, bool tables )
	{
		World& world = worldOf( edge );
		const lw_edge_def def = lw_edge_def_default();
		lw_edge_result result;
		leeway::require( lw_checker_edge( tables ? world.with_tables.get() : world.problem.checker.get(),
							 tables ? world.table_query.get() : world.query.get(), edge + 1, edge + 1 + m_size, &def, &result ),
			"an edge" );
		return { static_cast<double>( result.verdict ), static_cast<double>( result.queries ) };
	}

	std::vector<Contender> contenders()
	{
		const double step = m_settings.resolution * m_extent;
		return { { "FCL", [this, step]( const double* edge ) {
					FclPeer& fcl = *worldOf( edge ).fcl;
					const bool free = discrete( edge + 1, edge + 1 + m_size, m_size, step, [&fcl]( const double* q ) {
						fcl.pose( q );
						return !fcl.environmentCollides() && !fcl.selfCollides();
					} );
					return Answer{ free ? 1.0 : 0.0, 0 };
				} },
			{ "own", [this, step]( const double* edge ) {
				 World& world = worldOf( edge );
				 const bool free = discrete( edge + 1, edge + 1 + m_size, m_size, step, [&]( const double* q ) {
					 return isFree( world, world.table_query.get(), world.with_tables.get(), q );
				 } );
				 return Answer{ free ? 1.0 : 0.0, 0 };
			 } },
			{ "certified", [this]( const double* edge ) { return certify( edge, false ); } },
			{ "tables", [this]( const double* edge ) { return certify( edge, true ); } } };
	}

	/// A few hundred exact states of an edge that was proved free.
	bool refuted( const Edge& edge )
	{
		World& world = worldOf( edge.data() );
		std::vector<double> state( m_size );
		for ( int k = 0; k <= 200; ++k )
		{
			for ( std::size_t i = 0; i < m_size; ++i )
			{
				state[i] = edge[1 + i] + ( edge[1 + m_size + i] - edge[1 + i] ) * k / 200;
			}
			if ( !isFree( world, world.audit_query.get(), world.problem.checker.get(), state.data() ) )
			{
				return true;
			}
		}
		return false;
	}

	void compare( bool near, double length, Json& rows )
	{
		std::vector<Edge> edges;
		for ( std::size_t i = 0; i < m_settings.edges; ++i )
		{
			edges.push_back( makeEdge( near, length ) );
		}
		const std::vector<Run> runs = race( contenders(), { near ? "near" : "any", "edges", edges }, m_settings.repetitions );
		for ( std::size_t i = 0; i < edges.size(); ++i )
		{
			const bool proved = runs[2].answers[i].lower == LW_VERDICT_FREE || runs[3].answers[i].lower == LW_VERDICT_FREE;
			m_refuted += proved && refuted( edges[i] );
			m_contradicted += proved && ( runs[0].answers[i].lower == 0 || runs[1].answers[i].lower == 0 );
		}
		for ( const lw_verdict verdict : { LW_VERDICT_FREE, LW_VERDICT_BLOCKED, LW_VERDICT_REFUSED } )
		{
			print( near, length, verdict, runs, rows );
		}
	}

	void print( bool near, double length, lw_verdict verdict, const std::vector<Run>& runs, Json& rows )
	{
		std::vector<std::vector<double>> times( runs.size() ), queries( runs.size() );
		for ( std::size_t i = 0; i < runs[0].answers.size(); ++i )
		{
			for ( std::size_t c = 0; c < runs.size() && runs[2].answers[i].lower == verdict; ++c )
			{
				times[c].push_back( runs[c].microseconds[i] );
				queries[c].push_back( runs[c].answers[i].upper );
			}
		}
		if ( times[0].empty() )
		{
			return;
		}
		const Summary fcl = summarise( times[0] ), own = summarise( times[1] ), certified = summarise( times[2] ), tables = summarise( times[3] );
		std::printf( "%-5s %-6.1f %-8s %5zu | %8.1f %8.1f | %8.1f %8.1f | %8.1f %8.1f %7.0f | %8.1f %8.1f %7.0f | %7.2f %7.2f %7.2f\n",
			near ? "near" : "any", length, lw_verdict_name( verdict ), times[0].size(), fcl.median, fcl.mean, own.median, own.mean,
			certified.median, certified.mean, median( queries[2] ), tables.median, tables.mean, median( queries[3] ),
			fcl.mean / certified.mean, own.mean / certified.mean, own.mean / tables.mean );
		std::fflush( stdout );
		rows.push_back( { { "set", near ? "near" : "any" }, { "length", length }, { "verdict", lw_verdict_name( verdict ) },
			{ "edges", times[0].size() }, { "fcl_discrete", toJson( fcl ) }, { "own_discrete", toJson( own ) },
			{ "certified", toJson( certified ) }, { "certified_queries_median", median( queries[2] ) },
			{ "certified_tables", toJson( tables ) }, { "certified_tables_queries_median", median( queries[3] ) } } );
	}

	const Settings& m_settings;
	std::mt19937_64 m_random;
	io::RobotModel m_robot;
	io::SceneModel m_scene;
	leeway::Reach m_reach;
	std::vector<World> m_worlds;
	std::size_t m_size = 0;
	double m_extent = 0;
	std::size_t m_refuted = 0, m_contradicted = 0;
};

} // namespace

int main( int argc, char** argv )
{
	CLI::App app{ "Certified edges against discrete validation" };
	Settings settings;
	app.add_option( "--data", settings.data, "folder of robots and scenes" );
	app.add_option( "--edges", settings.edges, "per set and length" )->capture_default_str();
	app.add_option( "--repetitions", settings.repetitions )->capture_default_str()->check( CLI::PositiveNumber );
	app.add_option( "--resolution", settings.resolution, "of the discrete contenders, a fraction of the extent" )->capture_default_str();
	app.add_option( "--budget", settings.budget, "seconds for pair proofs" )->capture_default_str();
	app.add_option( "--seed", settings.seed )->capture_default_str();
	app.add_option( "--json", settings.json, "result file" );
	CLI11_PARSE( app, argc, argv );
	try
	{
		return Comparison( settings ).run();
	}
	catch ( const std::exception& error )
	{
		std::fprintf( stderr, "bench_edges: error: %s\n", error.what() );
		return 2;
	}
}
