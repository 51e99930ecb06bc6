// SPDX-License-Identifier: BSD-3-Clause
// Edges: the certified validator against OMPL's discrete one at 1 % of the space's extent, over FCL and over leeway's own
// state checker, the same edges interleaved one by one; leeway's own two without and with the tables of a reach, like
// against like. Exit status 1 if a certificate is refuted.
//
// The discrete contenders use the method of ompl::base::DiscreteMotionValidator (the end first, then halving, breadth first)
// on joint vectors without OMPL. An edge is FREE, BLOCKED or UNDECIDED by the certificate; times are reported for free edges
// and for the others. Edges are random ones near obstacles and anywhere, and those that RRT-Connect checks when it solves
// the scenes' own problems: most of these are blocked. The edges of a scene follow each other, so that each query is warm,
// as a planner's is. With LEEWAY_ZOO_DIR three robots of the zoo are measured, too (benchmarks/zoo).
#include "support/bench_program.hpp"
#include "peers/edge_judges.hpp"
#include "support/edge_worlds.hpp"
#include "support/planner_edges.hpp"
#include "support/provenance.hpp"
#include "support/race.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>

namespace
{

struct Settings
{
	std::string data = LEEWAY_DATA_DIR, json, only;
	std::size_t edges = 300, met = 300;
	int repetitions = 1;
	std::uint64_t seed = 20260101;
	double budget = 2, resolution = 0.01;
};

constexpr double PLANNING_SECONDS = 2; // for motions of a planner, each scene

/// One robot and group in all its scenes.
class Subject
{
public:
	Subject( const Settings& settings, const std::string& name, const EdgeWorlds& worlds, std::size_t first )
		: m_settings( settings ), m_name( name )
	{
		for ( std::size_t i = first; i < worlds.size(); ++i )
		{
			m_entries.push_back( &worlds.entry( i ) );
			m_judges.push_back( std::make_unique<EdgeJudges>( worlds.world( i ), m_models ) );
		}
		std::printf(
			"\n%s: %zu scenes, %zu variables, discrete contenders at %.2g %% of the extent; microseconds per edge\n",
			name.c_str(), m_judges.size(), worlds.world( first ).size(), 100 * settings.resolution );
		std::printf( "%-28s | %17s | %25s | %25s |\n", "", "", "without tables", "with tables" );
		std::printf( "%-5s %-6s %-8s %5s | %8s %8s | %8s %8s %7s | %8s %8s %7s | %7s %7s %7s %7s\n", "set", "rad", "verdict",
		    "n", "FCL", "mean", "own", "certif.", "queries", "own", "certif.", "queries", "FCL/c", "own/c", "FCL/t",
		    "own/t" );
	}

	void run( std::mt19937_64& random, Json& rows )
	{
		for ( const bool near : { true, false } )
		{
			for ( const double length : { 0.1, 0.5, 2.0 } )
			{
				drawRandom( near, length, random );
				compare( near ? "near" : "any", length, rows );
			}
		}
		if ( drawPlanned() )
		{
			compare( "plan", 0, rows );
		}
	}

	std::size_t refuted() const { return m_refuted; }
	std::size_t contradicted() const { return m_contradicted; }

private:
	enum Who
	{
		FCL,
		OWN,
		CERTIFIED,
		OWN_TABLES,
		CERTIFIED_TABLES,
		COUNT
	};

	struct Edge
	{
		EdgeJudges* judges;
		Motion motion;
	};

	/// lower = verdict, upper = states measured.
	static Answer certify( const Edge& edge, bool tables )
	{
		const lw_edge_def def = lw_edge_def_default();
		lw_edge_result result;
		edge.judges->byCertificate( edge.motion, tables, def, result );
		return { static_cast<double>( result.verdict ), static_cast<double>( result.queries ) };
	}

	static Answer byStates( const Edge& edge, bool tables, double fraction )
	{
		return { edge.judges->byStates( edge.motion, tables, fraction ) ? 1.0 : 0.0, 0 };
	}

	/// Each contender gets the number of an edge.
	std::vector<Contender> contenders() const
	{
		const double fraction = m_settings.resolution;
		const auto edge = [this]( const double* number ) -> const Edge&
		{ return m_edges[static_cast<std::size_t>( *number )]; };
		return { { "FCL",
		             [edge, fraction]( const double* number )
		             {
						 const Edge& e = edge( number );
						 return Answer{ e.judges->byFcl( e.motion, fraction ) ? 1.0 : 0.0, 0 };
		             } },
		    { "own", [edge, fraction]( const double* number ) { return byStates( edge( number ), false, fraction ); } },
		    { "certified", [edge]( const double* number ) { return certify( edge( number ), false ); } },
		    { "own, tables",
		        [edge, fraction]( const double* number ) { return byStates( edge( number ), true, fraction ); } },
		    { "certified, tables", [edge]( const double* number ) { return certify( edge( number ), true ); } } };
	}

	/// Asks those who remember, FCL does not, about an edge that is not measured.
	void meet( const Edge& edge ) const
	{
		for ( const bool tables : { false, true } )
		{
			certify( edge, tables );
			byStates( edge, tables, m_settings.resolution );
		}
	}

	/// A few hundred exact states of an edge that was proved free.
	static bool refuted( const Edge& edge )
	{
		const EdgeWorld& world = edge.judges->world();
		for ( int k = 0; k <= 200; ++k )
		{
			if ( !world.isFree( world.at( edge.motion, k / 200.0 ), edge.judges->spare() ) )
			{
				return true;
			}
		}
		return false;
	}

	void drawRandom( bool near, double length, std::mt19937_64& random )
	{
		m_edges.clear();
		for ( std::size_t i = 0; i < m_judges.size(); ++i )
		{
			EdgeJudges* judges = m_judges[i].get();
			const auto draw = [&] {
				return Edge{ judges, judges->world().randomMotion( near, length, random, judges->spare() ) };
			};
			for ( std::size_t k = 0; k < m_settings.met; ++k )
			{
				meet( draw() );
			}
			for ( const std::size_t end = ( i + 1 ) * m_settings.edges / m_judges.size(); m_edges.size() < end; )
			{
				m_edges.push_back( draw() );
			}
		}
	}

	/// The same number of edges in all, of the scenes that have a problem. @return false if there are none
	bool drawPlanned()
	{
		m_edges.clear();
		for ( std::size_t i = 0; i < m_judges.size(); ++i )
		{
			if ( !m_entries[i]->goal.empty() )
			{
				const std::size_t most = ( m_settings.edges + m_judges.size() - 1 ) / m_judges.size();
				if ( m_settings.met > 0 )
				{
					for ( Motion& motion :
					    motionsOfPlanner( *m_entries[i], PLANNING_SECONDS, m_settings.met, m_settings.seed + 1 ) )
					{
						meet( { m_judges[i].get(), std::move( motion ) } );
					}
				}
				for ( Motion& motion : motionsOfPlanner( *m_entries[i], PLANNING_SECONDS, most, m_settings.seed ) )
				{
					m_edges.push_back( { m_judges[i].get(), std::move( motion ) } );
				}
			}
		}
		return !m_edges.empty();
	}

	void compare( const std::string& name, double length, Json& rows )
	{
		ConfigurationSet set{ name, "edges", {} };
		for ( std::size_t i = 0; i < m_edges.size(); ++i )
		{
			set.states.push_back( { static_cast<double>( i ) } );
		}
		const std::vector<Run> runs = race( contenders(), set, m_settings.repetitions );
		for ( std::size_t i = 0; i < m_edges.size(); ++i )
		{
			const bool proved = runs[CERTIFIED].answers[i].lower == LW_VERDICT_FREE ||
			                    runs[CERTIFIED_TABLES].answers[i].lower == LW_VERDICT_FREE;
			m_refuted += proved && refuted( m_edges[i] );
			m_contradicted += proved && ( runs[FCL].answers[i].lower == 0 || runs[OWN].answers[i].lower == 0 ||
											runs[OWN_TABLES].answers[i].lower == 0 );
		}
		for ( const lw_verdict verdict : { LW_VERDICT_FREE, LW_VERDICT_BLOCKED, LW_VERDICT_UNDECIDED } )
		{
			print( name, length, verdict, runs, rows );
		}
	}

	void print( const std::string& name, double length, lw_verdict verdict, const std::vector<Run>& runs, Json& rows ) const
	{
		std::array<std::vector<double>, COUNT> times, queries;
		for ( std::size_t i = 0; i < runs[FCL].answers.size(); ++i )
		{
			for ( std::size_t c = 0; c < COUNT && runs[CERTIFIED].answers[i].lower == verdict; ++c )
			{
				times[c].push_back( runs[c].microseconds[i] );
				queries[c].push_back( runs[c].answers[i].upper );
			}
		}
		if ( times[FCL].empty() )
		{
			return;
		}
		std::array<Summary, COUNT> of;
		std::transform( times.begin(), times.end(), of.begin(), []( const auto& all ) { return summarise( all ); } );
		const double looks = median( queries[CERTIFIED] ), looks_tables = median( queries[CERTIFIED_TABLES] );
		std::printf(
		    "%-5s %-6.1f %-8s %5zu | %8.1f %8.1f | %8.1f %8.1f %7.0f | %8.1f %8.1f %7.0f | %7.2f %7.2f %7.2f %7.2f\n",
		    name.c_str(), length, lw_verdict_name( verdict ), times[FCL].size(), of[FCL].median, of[FCL].mean, of[OWN].mean,
		    of[CERTIFIED].mean, looks, of[OWN_TABLES].mean, of[CERTIFIED_TABLES].mean, looks_tables,
		    of[FCL].mean / of[CERTIFIED].mean, of[OWN].mean / of[CERTIFIED].mean, of[FCL].mean / of[CERTIFIED_TABLES].mean,
		    of[OWN_TABLES].mean / of[CERTIFIED_TABLES].mean );
		std::fflush( stdout );
		rows.push_back( { { "robot", m_name }, { "set", name }, { "length", length },
		    { "verdict", lw_verdict_name( verdict ) }, { "edges", times[FCL].size() }, { "fcl_discrete", toJson( of[FCL] ) },
		    { "own_discrete", toJson( of[OWN] ) }, { "certified", toJson( of[CERTIFIED] ) },
		    { "certified_queries_median", looks }, { "own_discrete_tables", toJson( of[OWN_TABLES] ) },
		    { "certified_tables", toJson( of[CERTIFIED_TABLES] ) }, { "certified_tables_queries_median", looks_tables } } );
	}

	const Settings& m_settings;
	const std::string m_name;
	const std::shared_ptr<FclModels> m_models = std::make_shared<FclModels>();
	std::vector<std::unique_ptr<EdgeJudges>> m_judges;
	std::vector<const EdgeWorldEntry*> m_entries; ///< one for each judge
	std::vector<Edge> m_edges;
	std::size_t m_refuted = 0, m_contradicted = 0;
};

/// A robot of the zoo, on which nothing was tuned, in scenes of MotionBenchMaker.
/// @param files package, URDF and SRDF @param group empty: all joints @param family of the scenes, "fetch" or "panda"
/// @param scenes such as "table_pick/0001", in which random free states are found
void addZoo( EdgeWorlds& worlds, const std::string& name, const std::string& files, const std::string& group,
	const std::string& family, const std::vector<std::string>& scenes )
{
	const std::string folder = std::string( std::getenv( "LEEWAY_ZOO_DIR" ) ) +
							   "/example-robot-data/cmeel.prefix/share/example-robot-data/robots/";
	const std::size_t slash = files.find( '/' ), comma = files.find( ',' );
	const std::string package = folder + files.substr( 0, slash );
	for ( const std::string& scene : scenes )
	{
		const std::string set = scene.substr( 0, scene.find( '/' ) ), number = scene.substr( scene.find( '/' ) + 1 );
		Json source = { { "set", name }, { "name", name + "/" + scene },
			{ "robot", package + "/urdf/" + files.substr( slash + 1, comma - slash - 1 ) + ".urdf" },
			{ "srdf", package + "/srdf/" + files.substr( comma + 1 ) + ".srdf" },
			{ "scene", "mbm/" + family + "/problems/" + set + "_" + family + "/scene" + number + ".yaml" } };
		if ( !group.empty() )
		{
			source["group"] = group;
		}
		worlds.add( source );
	}
}

int run( const Settings& settings )
{
	lw_reach_def reach = lw_reach_def_default();
	reach.seconds = settings.budget;
	EdgeWorlds worlds( settings.data, reach );
	const std::vector<int> numbers = { 1, 13 };
	std::vector<std::pair<std::string, std::function<void()>>> subjects = {
		{ "armar3 right_arm", [&] { worlds.addArmar( "right_arm" ); } },
		{ "armar3 torso_right_arm", [&] { worlds.addArmar( "torso_right_arm" ); } },
		{ "fetch arm_with_torso", [&] { worlds.addMbm( "fetch", "arm_with_torso", numbers ); } },
		{ "panda panda_arm", [&] { worlds.addMbm( "panda", "panda_arm", numbers ); } },
	};
	if ( std::getenv( "LEEWAY_ZOO_DIR" ) != nullptr )
	{
		const std::vector<std::string> most = { "bookshelf_small/0001", "box/0013", "table_pick/0001", "cage/0013" };
		const std::vector<std::string> wide = { "bookshelf_small/0013", "table_pick/0001", "cage/0013" };
		const auto zoo = [&]( const std::string& name, const std::string& files, const std::string& group,
							 const std::string& family, const std::vector<std::string>& scenes )
		{ subjects.emplace_back( name, [=, &worlds] { addZoo( worlds, name, files, group, family, scenes ); } ); };
		zoo( "zoo ur5", "ur_description/ur5_gripper,ur5_gripper", "", "panda", most );
		zoo( "zoo pr2 right_arm_and_torso", "pr2_description/pr2,pr2", "right_arm_and_torso", "fetch", wide );
		zoo( "zoo baxter", "baxter_description/baxter,baxter_manipulation", "", "panda", most );
	}
	Json rows = Json::array();
	std::size_t refuted = 0, contradicted = 0;
	std::mt19937_64 random( settings.seed );
	for ( const auto& [name, add] : subjects )
	{
		if ( name.find( settings.only ) == std::string::npos )
		{
			continue;
		}
		const std::size_t first = worlds.size();
		add();
		Subject subject( settings, name, worlds, first );
		subject.run( random, rows );
		refuted += subject.refuted();
		contradicted += subject.contradicted();
	}
	if ( rows.empty() )
	{
		throw std::runtime_error( "--only " + settings.only + ": no robot and group has that in its name" );
	}
	std::printf(
		"\ncertificates that a dense look refutes: %zu; free by the certificate and blocked by a discrete contender: %zu\n",
		refuted, contradicted );
	writeResult( settings.json,
		{ { "provenance", provenance() }, { "seed", settings.seed }, { "edges", settings.edges },
			{ "met", settings.met }, { "repetitions", settings.repetitions }, { "resolution", settings.resolution },
			{ "rows", rows } } );
	return refuted + contradicted > 0 ? 1 : 0;
}

} // namespace

int main( int argc, char** argv )
{
	Settings settings;
	BenchProgram program( "bench_edges", "Certified edges against discrete validation." );
	program.option( "--data", settings.data, "folder of robots and scenes" );
	program.option( "--only", settings.only, "only robots and groups with this in their name, such as 'armar3' or 'fetch'" );
	program.option( "--edges", settings.edges, "per robot, set and length", { 1 } );
	program.option( "--met", settings.met, "other edges that each query is asked about first, per scene, set and length" );
	program.option(
	    "--repetitions", settings.repetitions, "passes over the edges; with more than one most are no longer new", { 1 } );
	program.option(
		"--resolution", settings.resolution, "of the discrete contenders, a fraction of the extent", POSITIVE );
	program.option( "--budget", settings.budget, "seconds for pair proofs" );
	program.option( "--seed", settings.seed, "of the edges" );
	program.option( "--json", settings.json, "result file" );
	return program.run( argc, argv, [&] { return run( settings ); } );
}
