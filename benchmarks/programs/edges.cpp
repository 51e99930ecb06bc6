// SPDX-License-Identifier: BSD-3-Clause
// Edges: certificates without and with the tables of a reach, and OMPL's discrete validation at 1 % of the space's extent over FCL
// and over leeway's own states, the same edges interleaved one by one. Exit status 1 if a certificate is refuted.
//
// The discrete contenders use the method of ompl::base::DiscreteMotionValidator (the end first, then halving, breadth first)
// on joint vectors without OMPL. Times are reported by the certificate's verdict. Edges are random ones near obstacles and
// anywhere, and those that RRT-Connect checks when it solves the scenes' own problems: most of these are blocked. The edges of a
// scene follow each other, so that each query is warm, as a planner's is. All verdicts are kept in the result: of two builds that
// were asked about the same edges `compare` tells those that changed.
#include "peers/edge_judges.hpp"
#include "planning/generated_problems.hpp"
#include "programs/commands.hpp"
#include "support/edge_worlds.hpp"
#include "support/planner_edges.hpp"
#include "support/provenance.hpp"
#include "support/race.hpp"
#include "support/temporary_folder.hpp"

#include <algorithm>
#include <cstdio>

namespace
{

struct Settings
{
	std::string data = LEEWAY_DATA_DIR, zoo, only;
	std::size_t edges = 300, met = 300, random_robots = 0;
	int repetitions = 1;
	std::uint64_t seed = 20260101;
	double budget = 2, resolution = 0.01;
	bool certified_only = false, no_planner = false;
};

constexpr double PLANNING_SECONDS = 2; // for motions of a planner, each scene

/// The judges, in the order of the contenders. Certificates come first: others may be left out.
enum Who
{
	CERTIFIED,
	CERTIFIED_TABLES,
	OWN,
	OWN_TABLES,
	FCL,
	COUNT
};
const char* const NAMES[] = { "certified", "certified_tables", "own_discrete", "own_discrete_tables", "fcl_discrete" };

struct Edge
{
	EdgeJudges* judges;
	Motion motion;
};

/// One robot and group in all its scenes.
class Subject
{
public:
	Subject( const Settings& settings, const std::string& name, const EdgeWorlds& worlds, Result& result )
	    : m_settings( settings ), m_name( name ), m_result( result ), m_random( settings.seed )
	{
		m_has_fcl = !settings.certified_only;
		for ( std::size_t i = 0; i < worlds.size(); ++i )
		{
			m_entries.push_back( &worlds.entry( i ) );
			m_judges.push_back( std::make_unique<EdgeJudges>( worlds.world( i ), m_models ) );
			m_has_fcl = m_has_fcl && m_judges.back()->hasFcl();
		}
		std::printf(
		    "\n%s: %zu scenes, %zu variables; microseconds an edge: mean (median); looks: states a certificate took\n",
		    name.c_str(), m_judges.size(), worlds.world( 0 ).size() );
		std::printf( "%-5s %-4s %-9s %5s | %19s %5s | %19s %5s", "set", "rad", "verdict", "n", "certified", "looks",
		    "with tables", "looks" );
		std::printf( settings.certified_only ? "\n" : " | %19s %19s %19s | %6s %6s\n", "own states", "with tables", "FCL",
		    "own/t", "FCL/t" );
	}

	void run()
	{
		for ( const bool near : { true, false } )
		{
			for ( const double length : { 0.1, 0.5, 2.0 } )
			{
				drawRandom( near, length );
				compare( near ? "near" : "any", length );
			}
		}
		if ( !m_settings.no_planner && drawPlanned() )
		{
			compare( "plan", 0 );
		}
	}

	std::size_t refuted() const { return m_refuted; }
	std::size_t contradicted() const { return m_contradicted; }

private:
	/// lower = verdict, upper = states measured.
	static Answer certify( const Edge& edge, bool tables )
	{
		const lw_edge_def def = lw_edge_def_default();
		lw_edge_result result;
		edge.judges->byCertificate( edge.motion, tables, def, result );
		return { static_cast<double>( result.verdict ), static_cast<double>( result.queries ) };
	}

	Answer ask( Who who, const Edge& edge ) const
	{
		switch ( who )
		{
		case OWN:
		case OWN_TABLES:
			return { edge.judges->byStates( edge.motion, who == OWN_TABLES, m_settings.resolution ) ? 1.0 : 0.0, 0 };
		case FCL:
			return { edge.judges->byFcl( edge.motion, m_settings.resolution ) ? 1.0 : 0.0, 0 };
		default:
			return certify( edge, who == CERTIFIED_TABLES );
		}
	}

	int count() const { return m_settings.certified_only ? OWN : m_has_fcl ? COUNT : FCL; }

	/// Asks those who remember, FCL does not, about an edge that is not measured.
	void meet( const Edge& edge ) const
	{
		for ( int who = CERTIFIED; who < std::min<int>( count(), FCL ); ++who )
		{
			ask( static_cast<Who>( who ), edge );
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

	void drawRandom( bool near, double length )
	{
		m_edges.clear();
		for ( std::size_t i = 0; i < m_judges.size(); ++i )
		{
			EdgeJudges* judges = m_judges[i].get();
			const auto draw = [&] {
				return Edge{ judges, judges->world().randomMotion( near, length, m_random, judges->spare() ) };
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
		const std::size_t most = ( m_settings.edges + m_judges.size() - 1 ) / m_judges.size();
		for ( std::size_t i = 0; i < m_judges.size(); ++i )
		{
			if ( m_entries[i]->goal.empty() )
			{
				continue;
			}
			const auto motions = [&]( std::size_t number, std::uint64_t seed ) {
				return number > 0 ? motionsOfPlanner( *m_entries[i], PLANNING_SECONDS, number, seed )
				                  : std::vector<Motion>();
			};
			for ( Motion& motion : motions( m_settings.met, m_settings.seed + 1 ) )
			{
				meet( { m_judges[i].get(), std::move( motion ) } );
			}
			for ( Motion& motion : motions( most, m_settings.seed ) )
			{
				m_edges.push_back( { m_judges[i].get(), std::move( motion ) } );
			}
		}
		return !m_edges.empty();
	}

	void compare( const std::string& set, double length )
	{
		ConfigurationSet numbers{ set, "numbers of edges", {} };
		for ( std::size_t i = 0; i < m_edges.size(); ++i )
		{
			numbers.states.push_back( { static_cast<double>( i ) } );
		}
		std::vector<Contender> contenders;
		for ( int who = CERTIFIED; who < count(); ++who )
		{
			contenders.push_back( { NAMES[who], [this, who]( const double* number )
			    { return ask( static_cast<Who>( who ), m_edges[static_cast<std::size_t>( *number )] ); } } );
		}
		const std::vector<Run> runs = race( contenders, numbers, m_settings.repetitions );
		for ( std::size_t i = 0; i < m_edges.size(); ++i )
		{
			const bool proved = runs[CERTIFIED].answers[i].lower == LW_VERDICT_FREE ||
			                    runs[CERTIFIED_TABLES].answers[i].lower == LW_VERDICT_FREE;
			m_refuted += proved && refuted( m_edges[i] );
			for ( std::size_t who = OWN; proved && who < runs.size(); ++who )
			{
				m_contradicted += runs[who].answers[i].lower == 0;
			}
		}
		for ( const lw_verdict verdict : { LW_VERDICT_FREE, LW_VERDICT_BLOCKED, LW_VERDICT_UNDECIDED } )
		{
			report( set, length, verdict, runs );
		}
		keepVerdicts( set, length, runs );
	}

	void report( const std::string& set, double length, lw_verdict verdict, const std::vector<Run>& runs )
	{
		std::vector<std::size_t> members;
		for ( std::size_t i = 0; i < m_edges.size(); ++i )
		{
			if ( runs[CERTIFIED].answers[i].lower == verdict )
			{
				members.push_back( i );
			}
		}
		if ( members.empty() )
		{
			return;
		}
		Json row = { { "robot", m_name }, { "set", set }, { "length", length }, { "verdict", lw_verdict_name( verdict ) },
		    { "edges", members.size() } };
		std::printf( "%-5s %-4.1f %-9s %5zu", set.c_str(), length, lw_verdict_name( verdict ), members.size() );
		double with_tables = 0;
		for ( std::size_t who = 0; who < runs.size(); ++who )
		{
			const Summary s = summarise( runs[who], members );
			row[NAMES[who]] = toJson( s );
			std::printf( "%s %8.1f (%8.1f)", who <= OWN ? " |" : "", s.mean, s.median );
			if ( who < OWN )
			{
				std::vector<double> looks;
				for ( const std::size_t i : members )
				{
					looks.push_back( runs[who].answers[i].upper );
				}
				row[std::string( NAMES[who] ) + "_looks"] = median( looks );
				std::printf( " %5.0f", median( looks ) );
			}
			with_tables = who == CERTIFIED_TABLES ? s.mean : with_tables;
		}
		const auto ratio = [&]( Who who ) { return row[NAMES[who]]["mean_us"].get<double>() / with_tables; };
		if ( runs.size() > OWN )
		{
			std::printf( " | %6.2f", ratio( OWN_TABLES ) );
		}
		if ( runs.size() > FCL )
		{
			std::printf( " %6.2f", ratio( FCL ) );
		}
		std::printf( "\n" );
		std::fflush( stdout );
		m_result.add( std::move( row ) );
	}

	/// A letter for each edge, and a hash by which two results know that they are about the same edges.
	void keepVerdicts( const std::string& set, double length, const std::vector<Run>& runs )
	{
		Hash edges;
		for ( const Edge& edge : m_edges )
		{
			for ( const std::vector<double>* end : { &edge.motion.from, &edge.motion.to } )
			{
				edges.add( end->data(), end->size() * sizeof( double ) );
			}
		}
		for ( const Who who : { CERTIFIED, CERTIFIED_TABLES } )
		{
			std::string letters;
			for ( const Answer& answer : runs[who].answers )
			{
				letters += answer.lower == LW_VERDICT_FREE ? 'F' : answer.lower == LW_VERDICT_BLOCKED ? 'B' : 'U';
			}
			m_result.add( { { "robot", m_name }, { "set", set }, { "length", length }, { "judge", NAMES[who] },
			    { "edges_hash", edges.text() }, { "verdicts", letters } } );
		}
	}

	const Settings& m_settings;
	const std::string m_name;
	Result& m_result;
	std::mt19937_64 m_random;
	const std::shared_ptr<FclModels> m_models = std::make_shared<FclModels>();
	std::vector<std::unique_ptr<EdgeJudges>> m_judges;
	std::vector<const EdgeWorldEntry*> m_entries; ///< one for each judge
	std::vector<Edge> m_edges;
	bool m_has_fcl = false;
	std::size_t m_refuted = 0, m_contradicted = 0;
};

void addData( const Settings& settings, const EdgeWorlds& worlds, Subjects& subjects )
{
	if ( std::filesystem::exists( settings.data + "/armar3" ) )
	{
		for ( const char* group : { "right_arm", "torso_right_arm" } )
		{
			subjects.emplace_back( std::string( "armar3 " ) + group, [group]( EdgeWorlds& w ) { w.addArmar( group ); } );
		}
	}
	if ( std::filesystem::exists( settings.data + "/mbm" ) )
	{
		for ( const auto& [robot, group] : worlds.mbmRobots() )
		{
			subjects.emplace_back( robot + " " + group,
			    [robot = robot, group = group]( EdgeWorlds& w ) {
				    w.addMbm( robot, group, { 1, 13 } );
			    } );
		}
	}
}

int run( const Settings& settings, Result& result )
{
	lw_reach_def reach = lw_reach_def_default();
	reach.seconds = settings.budget;
	const TemporaryFolder temporary;
	Subjects subjects;
	addData( settings, EdgeWorlds( settings.data, reach ), subjects );
	addUntuned( subjects, settings.zoo, "zoo ", settings.random_robots, settings.seed, temporary.path().string() );
	if ( subjects.empty() )
	{
		throw NoData( settings.data + ": neither armar3 nor mbm is there; give --data, --zoo or --random-robots" );
	}
	std::size_t refuted = 0, contradicted = 0, judged = 0;
	for ( const auto& [name, add] : subjects )
	{
		if ( name.find( settings.only ) == std::string::npos )
		{
			continue;
		}
		EdgeWorlds worlds( settings.data, reach );
		add( worlds );
		Subject subject( settings, name, worlds, result );
		subject.run();
		refuted += subject.refuted();
		contradicted += subject.contradicted();
		++judged;
	}
	if ( judged == 0 )
	{
		throw std::runtime_error( "--only " + settings.only + ": no robot and group has that in its name" );
	}
	std::printf(
	    "\ncertificates that a dense look refutes: %zu; free by the certificate and blocked by a discrete contender: %zu\n",
	    refuted, contradicted );
	result["refuted"] = refuted;
	result["contradicted"] = contradicted;
	return refuted + contradicted > 0 ? 1 : 0;
}

} // namespace

void addEdges( Bench& bench )
{
	const auto s = std::make_shared<Settings>();
	Command& command = bench.command( "edges", "certified edges of many robots, beside discrete validation" );
	command.option( "--data", s->data, "folder of robots and scenes: ARMAR-III, and all of mbm" );
	command.option( "--zoo", s->zoo, "folder of .ci/install.sh zoo: eight robots more, in scenes made by seed" );
	command.option( "--random-robots", s->random_robots, "so many robots more, made by seed" );
	command.option( "--only", s->only, "only robots and groups with this in their name, such as 'armar3' or 'zoo'" );
	command.option( "--edges", s->edges, "per robot, set and length", { 1 } );
	command.option( "--met", s->met, "other edges that each query is asked about first, per scene, set and length" );
	command.option(
	    "--repetitions", s->repetitions, "passes over the edges; with more than one most are no longer new", { 1 } );
	command.option( "--resolution", s->resolution, "of the discrete contenders, a fraction of the extent", POSITIVE );
	command.flag( "--certified-only", s->certified_only, "without the discrete contenders" );
	command.flag( "--no-planner", s->no_planner, "without the motions of a planner, which depend on the time it gets" );
	command.option( "--budget", s->budget, "seconds for pair proofs; 0: only those that take no time of their own", { 0 } );
	command.option( "--seed", s->seed, "of the edges" );
	command.work( [s]( Result& result ) { return run( *s, result ); } );
}
