// SPDX-License-Identifier: BSD-3-Clause
// Edges: the certified validator against OMPL's discrete one at 1 % of the space's extent, over FCL and over leeway's own
// state checker, the same edges interleaved one by one. Exit status 1 if a certificate is refuted.
//
// The discrete contenders do what ompl::base::DiscreteMotionValidator does (the end first, then halving, breadth first), in
// joint vectors without OMPL around them. An edge is FREE, BLOCKED or REFUSED by the certificate; times are reported for
// the edges that are free, and for the others.
#include "edge_worlds.hpp"
#include "provenance.hpp"
#include "race.hpp"

#include <CLI/CLI.hpp>

#include <cstdio>
#include <fstream>

namespace
{

using Json = nlohmann::ordered_json;

struct Settings
{
	std::string data = LEEWAY_DATA_DIR, json;
	std::size_t edges = 300;
	int repetitions = 3;
	std::uint64_t seed = 20260101;
	double budget = 2, resolution = 0.01;
};

class Comparison
{
public:
	explicit Comparison( const Settings& settings )
		: m_settings( settings ), m_random( settings.seed ), m_worlds( settings.data, settings.budget )
	{
	}

	int run()
	{
		std::printf( "ARMAR-III, group %s, %zu joints, extent %.3f; step of the discrete contenders %.4f\n", m_worlds.group(), m_worlds.size(), m_worlds.extent(),
			m_settings.resolution * m_worlds.extent() );
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
				{ "edges", m_settings.edges }, { "resolution", m_settings.resolution }, { "extent", m_worlds.extent() }, { "rows", rows } }.dump( 2 )
											 << "\n";
		}
		return m_refuted + m_contradicted > 0 ? 1 : 0;
	}

private:
	/// lower = verdict, upper = states measured.
	Answer certify( const double* edge, bool tables )
	{
		lw_edge_result result;
		m_worlds.judgedByCertificate( edge, tables, result );
		return { static_cast<double>( result.verdict ), static_cast<double>( result.queries ) };
	}

	std::vector<Contender> contenders()
	{
		const double resolution = m_settings.resolution;
		return { { "FCL", [this, resolution]( const double* edge ) {
					return Answer{ m_worlds.judgedByFcl( edge, resolution ) ? 1.0 : 0.0, 0 };
				} },
			{ "own", [this, resolution]( const double* edge ) {
				 return Answer{ m_worlds.judgedByStates( edge, resolution ) ? 1.0 : 0.0, 0 };
			 } },
			{ "certified", [this]( const double* edge ) { return certify( edge, false ); } },
			{ "tables", [this]( const double* edge ) { return certify( edge, true ); } } };
	}

	/// A few hundred exact states of an edge that was proved free.
	bool refuted( const Edge& edge )
	{
		for ( int k = 0; k <= 200; ++k )
		{
			if ( !m_worlds.isFree( m_worlds.of( edge.data() ), m_worlds.at( edge.data(), k / 200.0 ).data() ) )
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
			edges.push_back( m_worlds.random( near, length, m_random ) );
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
	EdgeWorlds m_worlds;
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
