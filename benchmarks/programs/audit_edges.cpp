// SPDX-License-Identifier: BSD-3-Clause
// Who calls a colliding edge free? Certificates, with and without pair tables, and discrete validators at
// several resolutions over leeway's states and FCL's, against a dense look that knows nothing of certificates
// (tests/support/edge_auditor.hpp). Exit status 1 if a certificate is wrong, or the auditor.
//
// The auditor checks every verdict of a certificate: FREE and its lower bound by a look at the whole edge; BLOCKED and
// UNDECIDED by the distance of the named pair at t, and by FCL; `proved_until` by a look at the part up to there. A discrete
// validator cannot err on a free edge, so only colliding edges are put to it.
#include "edge_truth.hpp"
#include "peers/edge_judges.hpp"
#include "programs/commands.hpp"
#include "support/edge_worlds.hpp"
#include "support/planner_edges.hpp"
#include "support/race.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <iterator>
#include <mutex>
#include <sstream>
#include <thread>

namespace
{

struct Settings
{
	std::string data = LEEWAY_DATA_DIR, record, edges_file, robot, scene, request, only;
	std::size_t edges = 2000;
	double resolution = 1e-4, budget = 2, plan_seconds = 1;
	unsigned threads = 1;
	std::uint64_t seed = 20260101;
};

/// Set by Ctrl-C: the program then reports the edges judged so far.
volatile std::sig_atomic_t interrupted = 0;

constexpr std::array<double, 3> FRACTIONS = { 0.01, 0.005, 0.001 };
constexpr double FCL_TOLERANCE = 1e-6; ///< metres; where the distance is less, FCL may say either

/// One edge to judge: a given motion, or a random one.
struct Task
{
	std::size_t world;
	std::uint64_t number; ///< seed of a random motion
	bool given = false;
	Motion motion;
};

/// Results of a set of worlds.
struct Tally
{
	std::size_t edges = 0, colliding = 0;
	std::array<std::size_t, 2> free{}, undecided{}, wrong{}; ///< certified; certified with tables
	std::array<std::size_t, FRACTIONS.size()> missed_own{}, missed_fcl{};
	std::size_t fcl_differs = 0;   ///< states at which FCL's word on contact is not the auditor's
	std::size_t auditor_wrong = 0; ///< those of them at which brute force is with FCL
	std::uint64_t distances = 0;
	double audit_ms = 0, all_ms = 0;

	void add( const Tally& o )
	{
		edges += o.edges;
		colliding += o.colliding;
		for ( std::size_t i = 0; i < 2; ++i )
		{
			free[i] += o.free[i];
			undecided[i] += o.undecided[i];
			wrong[i] += o.wrong[i];
		}
		for ( std::size_t i = 0; i < FRACTIONS.size(); ++i )
		{
			missed_own[i] += o.missed_own[i];
			missed_fcl[i] += o.missed_fcl[i];
		}
		fcl_differs += o.fcl_differs;
		auditor_wrong += o.auditor_wrong;
		distances += o.distances;
		audit_ms += o.audit_ms;
		all_ms += o.all_ms;
	}
};

lw_reach_def reachDef( double seconds )
{
	lw_reach_def def = lw_reach_def_default();
	def.seconds = seconds;
	return def;
}

/// Everybody who works in one world, for one thread.
struct Seat
{
	EdgeJudges judges;
	EdgeAuditor auditor;

	Seat( const EdgeWorld& world, const std::shared_ptr<FclModels>& models, double resolution )
	    : judges( world, models ),
	      auditor( world.robot.get(), world.scene.get(), world.variables, world.reference.data(), world.allowed, resolution )
	{
	}
};

class Audit
{
public:
	explicit Audit( const Settings& settings )
	    : m_settings( settings ), m_worlds( settings.data, reachDef( settings.budget ) ),
	      m_models( std::make_shared<FclModels>() )
	{
		if ( !settings.record.empty() )
		{
			m_record.open( settings.record );
			if ( !m_record )
			{
				throw std::runtime_error( settings.record + ": cannot be written" );
			}
		}
	}

	int run( Result& result )
	{
		if ( !m_settings.edges_file.empty() )
		{
			readEdges();
		}
		else if ( !m_settings.robot.empty() )
		{
			makeUp( { addNamedWorld() } );
		}
		else
		{
			listWorlds();
		}
		recordWorlds();
		const auto start = std::chrono::steady_clock::now();
		std::vector<std::thread> threads;
		for ( unsigned i = 0; i < m_settings.threads; ++i )
		{
			threads.emplace_back( [this] { work(); } );
		}
		while ( m_done < m_tasks.size() && !m_failed && interrupted == 0 )
		{
			std::this_thread::sleep_for( std::chrono::seconds( 1 ) );
			const double seconds = std::chrono::duration<double>( std::chrono::steady_clock::now() - start ).count();
			const double done = static_cast<double>( m_done ), all = static_cast<double>( m_tasks.size() );
			std::fprintf( stderr, "\r%.0f of %.0f edges, %.0f s left   ", done, all,
			    done > 0 ? seconds * ( all - done ) / done : 0.0 );
		}
		std::fprintf( stderr, "\r%60s\r", "" );
		for ( std::thread& thread : threads )
		{
			thread.join();
		}
		if ( !m_error.empty() )
		{
			throw std::runtime_error( m_error );
		}
		m_seconds = std::chrono::duration<double>( std::chrono::steady_clock::now() - start ).count();
		return report( result );
	}

private:
	// ---- which edges ------------------------------------------------------------------------------------------------

	/// Edges made up, evenly over the groups of worlds.
	void makeUp( const std::vector<std::vector<std::size_t>>& groups )
	{
		std::mt19937_64 random( m_settings.seed );
		for ( std::size_t i = 0; m_tasks.size() < m_settings.edges; ++i )
		{
			const std::vector<std::size_t>& group = groups[i % groups.size()];
			m_tasks.push_back( { group[random() % group.size()], i, false, {} } );
		}
	}

	/// Calls `add`. @return the worlds that it added
	template <typename Add> std::vector<std::size_t> added( const Add& add )
	{
		const std::size_t before = m_worlds.size();
		add();
		std::vector<std::size_t> list;
		for ( std::size_t i = before; i < m_worlds.size(); ++i )
		{
			list.push_back( i );
		}
		std::fprintf( stderr, "\r%zu worlds ", m_worlds.size() );
		return list;
	}

	bool wanted( const std::string& set ) const { return set.find( m_settings.only ) != std::string::npos; }

	void listWorlds()
	{
		std::vector<std::vector<std::size_t>> groups;
		for ( const char* base : { "", "torso_", "platform+torso_" } )
		{
			for ( const char* arm : { "left_arm", "right_arm", "both_arms" } )
			{
				const std::string group = std::string( base ) + arm;
				if ( wanted( "armar3 " + group ) )
				{
					groups.push_back( added( [&] { m_worlds.addArmar( group ); } ) );
				}
			}
		}
		const std::vector<int> numbers = { 1, 13 };
		for ( const auto& [robot, group] :
		    { std::pair( "fetch", "arm_with_torso" ), std::pair( "fetch", "arm" ), std::pair( "panda", "panda_arm" ) } )
		{
			if ( wanted( std::string( robot ) + " " + group ) )
			{
				groups.push_back( added( [&, r = robot, g = group] { m_worlds.addMbm( r, g, numbers ); } ) );
			}
		}
		if ( wanted( "random robots" ) )
		{
			const std::size_t count = std::max<std::size_t>( 10, m_settings.edges / 1000 );
			groups.push_back( added( [&] { m_worlds.addRandom( m_settings.seed, count ); } ) );
			groups.push_back( groups.back() ); // twice the share of any other set
		}
		if ( wanted( "planner" ) )
		{
			plan( m_settings.edges / ( groups.size() + 3 ) * 3 );
		}
		if ( groups.empty() && m_tasks.empty() )
		{
			throw std::runtime_error( "--only " + m_settings.only + ": no set of worlds has that in its name" );
		}
		if ( !groups.empty() )
		{
			makeUp( groups );
		}
	}

	/// About so many edges that a planner asks for: ARMAR-III's problems, Fetch's and Panda's.
	void plan( std::size_t edges )
	{
		std::vector<std::size_t> problems = added( [this] { m_worlds.addArmarProblems(); } );
		for ( std::size_t i = 0; i < m_worlds.size(); ++i )
		{
			const std::string& set = m_worlds.world( i ).set;
			if ( ( set == "fetch arm_with_torso" || set == "panda panda_arm" ) && !m_worlds.entry( i ).goal.empty() )
			{
				problems.push_back( i );
			}
		}
		for ( const std::size_t i : problems )
		{
			if ( interrupted != 0 )
			{
				break;
			}
			const EdgeWorldEntry& entry = m_worlds.entry( i );
			std::size_t from =
			    m_worlds.world( i ).set == "armar3 planner" ? i : m_worlds.add( plannerSource( entry.source ) );
			for ( Motion& motion :
			    motionsOfPlanner( entry, m_settings.plan_seconds, edges / problems.size() + 1, m_settings.seed + i ) )
			{
				m_tasks.push_back( { from, m_tasks.size(), true, std::move( motion ) } );
			}
			std::fprintf( stderr, "\r%zu motions of planners ", m_tasks.size() );
		}
	}

	/// The same world in a set of its own.
	static Json plannerSource( Json source )
	{
		source["set"] = source.at( "set" ).get<std::string>() + ", planner";
		source["name"] = source.at( "name" ).get<std::string>() + ", planner";
		return source;
	}

	std::vector<std::size_t> addNamedWorld()
	{
		std::stringstream parts( m_settings.robot );
		std::vector<std::string> names;
		for ( std::string part; std::getline( parts, part, ',' ); )
		{
			names.push_back( part );
		}
		if ( names.size() != 3 )
		{
			throw std::runtime_error( "--robot " + m_settings.robot + ": give URDF,SRDF,GROUP" );
		}
		Json source = {
		    { "set", names[2] }, { "name", names[2] }, { "robot", names[0] }, { "srdf", names[1] }, { "group", names[2] } };
		if ( !m_settings.scene.empty() )
		{
			source["scene"] = m_settings.scene;
		}
		if ( !m_settings.request.empty() )
		{
			source["request"] = m_settings.request;
		}
		return { m_worlds.add( source ) };
	}

	/// Lines of JSON: worlds, then edges that name one. An edge without a world belongs to that of --robot.
	void readEdges()
	{
		std::ifstream file( m_settings.edges_file );
		if ( !file )
		{
			throw std::runtime_error( m_settings.edges_file + ": cannot be read" );
		}
		std::map<std::string, std::size_t> worlds;
		if ( !m_settings.robot.empty() )
		{
			worlds[""] = addNamedWorld()[0];
		}
		std::string line;
		for ( std::size_t number = 1; std::getline( file, line ); ++number )
		{
			try
			{
				readLine( Json::parse( line ), worlds );
			}
			catch ( const std::exception& error )
			{
				throw std::runtime_error(
				    m_settings.edges_file + ": line " + std::to_string( number ) + ": " + error.what() );
			}
		}
	}

	void readLine( const Json& line, std::map<std::string, std::size_t>& worlds )
	{
		if ( !line.contains( "from" ) )
		{
			worlds[line.at( "name" ).get<std::string>()] = m_worlds.add( line );
			return;
		}
		const auto world = worlds.find( line.value( "world", "" ) );
		if ( world == worlds.end() )
		{
			throw std::runtime_error( "no line before names this edge's world; give it one, or the option --robot" );
		}
		Task task = { world->second, m_tasks.size(), true,
		    { line.at( "from" ).get<std::vector<double>>(), line.at( "to" ).get<std::vector<double>>() } };
		const std::size_t size = m_worlds.world( task.world ).size();
		if ( task.motion.from.size() != size || task.motion.to.size() != size )
		{
			throw std::runtime_error(
			    "\"from\" and \"to\" need " + std::to_string( size ) + " numbers, as the group has variables" );
		}
		m_tasks.push_back( std::move( task ) );
	}

	void recordWorlds()
	{
		std::vector<bool> used( m_worlds.size(), false );
		for ( const Task& task : m_tasks )
		{
			used[task.world] = true;
		}
		for ( std::size_t i = 0; i < m_worlds.size() && m_record.is_open(); ++i )
		{
			if ( used[i] )
			{
				m_record << m_worlds.entry( i ).source.dump() << '\n';
			}
		}
	}

	// ---- judging ----------------------------------------------------------------------------------------------------

	void work()
	{
		std::map<std::size_t, std::unique_ptr<Seat>> seats;
		std::map<std::string, Tally> tallies;
		try
		{
			for ( std::size_t i = m_next++; i < m_tasks.size() && interrupted == 0; i = m_next++ )
			{
				const Task& task = m_tasks[i];
				std::unique_ptr<Seat>& seat = seats[task.world];
				if ( !seat )
				{
					seat = std::make_unique<Seat>( m_worlds.world( task.world ), m_models, m_settings.resolution );
				}
				judge( task, *seat, tallies[m_worlds.world( task.world ).set] );
				++m_done;
			}
		}
		catch ( const std::exception& error )
		{
			const std::lock_guard<std::mutex> lock( m_mutex );
			m_error = error.what();
			m_failed = true;
		}
		const std::lock_guard<std::mutex> lock( m_mutex );
		for ( const auto& [set, tally] : tallies )
		{
			m_tallies[set].add( tally );
		}
	}

	/// Half of the starts near the environment; three lengths; for random robots also any two states.
	static Motion makeUpMotion( Seat& seat, std::mt19937_64& random )
	{
		static const double lengths[] = { 0.1, 0.5, 2 };
		const EdgeWorld& world = seat.judges.world();
		if ( !world.home.empty() && random() % 4 == 0 )
		{
			return { world.randomState( random ), world.randomState( random ) };
		}
		const bool near = random() % 2 == 0;
		return world.randomMotion( near, lengths[random() % 3], random, seat.judges.spare() );
	}

	void judge( const Task& task, Seat& seat, Tally& tally )
	{
		const double start = 1e-3 * threadMicroseconds();
		std::mt19937_64 random( m_settings.seed + 0x9e3779b97f4a7c15u * ( task.number + 1 ) );
		const Motion motion = task.given ? task.motion : makeUpMotion( seat, random );
		EdgeTruth truth( seat.judges.world(), seat.auditor, motion, 0 );
		lw_edge_def def = lw_edge_def_default();
		def.want_proved_until = random() % 4 == 0;
		std::array<lw_edge_result, 2> results;
		double audit = 0;
		for ( std::size_t i = 0; i < 2; ++i )
		{
			seat.judges.byCertificate( motion, i == 1, def, results[i] );
			tally.free[i] += results[i].verdict == LW_VERDICT_FREE;
			tally.undecided[i] += results[i].verdict == LW_VERDICT_UNDECIDED;
			const double before = 1e-3 * threadMicroseconds();
			complain( truth.refute( def, results[i] ), task, motion, i, def, tally );
			audit += 1e-3 * threadMicroseconds() - before;
		}
		const double before = 1e-3 * threadMicroseconds();
		const bool blocked = truth.isBlocked();
		audit += 1e-3 * threadMicroseconds() - before;
		if ( random() % 8 == 0 )
		{
			askForMore( task, seat, motion, random, tally );
		}
		askOthers( seat, motion, truth, results, blocked, tally );
		++tally.edges;
		tally.colliding += blocked;
		tally.distances += truth.distances();
		tally.audit_ms += audit;
		tally.all_ms += 1e-3 * threadMicroseconds() - start;
		if ( m_record.is_open() )
		{
			record( task, seat.judges.world(), motion, results, blocked );
		}
	}

	/// The same edge with a margin, and with another slack: claims that the table does not count.
	void askForMore( const Task& task, Seat& seat, const Motion& motion, std::mt19937_64& random, Tally& tally )
	{
		lw_edge_def def = lw_edge_def_default();
		def.min_d = std::pow( 10.0, -4 + 2.5 * EdgeWorld::uniform( random ) );
		def.slack = std::pow( 10.0, -4 + 2 * EdgeWorld::uniform( random ) );
		def.want_proved_until = random() % 2 == 0;
		EdgeTruth truth( seat.judges.world(), seat.auditor, motion, def.min_d );
		for ( std::size_t i = 0; i < 2; ++i )
		{
			lw_edge_result result;
			seat.judges.byCertificate( motion, i == 1, def, result );
			complain( truth.refute( def, result ), task, motion, i, def, tally );
		}
	}

	void askOthers( Seat& seat, const Motion& motion, EdgeTruth& truth, const std::array<lw_edge_result, 2>& results,
	    bool blocked, Tally& tally )
	{
		for ( std::size_t i = 0; blocked && i < FRACTIONS.size(); ++i )
		{
			tally.missed_own[i] += seat.judges.byStates( motion, true, FRACTIONS[i] );
			tally.missed_fcl[i] += seat.judges.hasFcl() && seat.judges.byFcl( motion, FRACTIONS[i] );
		}
		if ( !seat.judges.hasFcl() )
		{
			return;
		}
		// FCL's word on the nearest state that the look found, and on the state that blocks
		const EdgeWorld& world = seat.judges.world();
		if ( !blocked && truth.whole().least > FCL_TOLERANCE )
		{
			const std::vector<double> state = world.at( motion, truth.whole().t );
			settle( seat, state, false, seat.judges.fclCollides( state ), tally );
		}
		for ( const lw_edge_result& result : results )
		{
			if ( result.verdict == LW_VERDICT_BLOCKED )
			{
				const std::vector<double> state = world.at( motion, result.t );
				settle( seat, state, true,
				    seat.judges.fclCollides( state ) || seat.judges.fclDistance( state, 1 ) <= FCL_TOLERANCE, tally );
			}
		}
	}

	/// Settles two answers on contact at a state. FCL's distances of curved shapes are off by some micrometres now and then,
	/// so brute force decides where the two differ.
	static void settle( Seat& seat, const std::vector<double>& state, bool auditor, bool fcl, Tally& tally )
	{
		if ( auditor != fcl )
		{
			++tally.fcl_differs;
			tally.auditor_wrong += seat.judges.bruteCollides( state ) != auditor;
		}
	}

	void complain( const std::string& why, const Task& task, const Motion& motion, std::size_t judge, const lw_edge_def& def,
	    Tally& tally )
	{
		if ( why.empty() )
		{
			return;
		}
		++tally.wrong[judge];
		const std::lock_guard<std::mutex> lock( m_mutex );
		const Json source = m_worlds.entry( task.world ).source;
		m_wrong.push_back( { { "why", why }, { "tables", judge == 1 }, { "min_d", def.min_d }, { "slack", def.slack },
		    { "want_proved_until", def.want_proved_until }, { "world", source }, { "from", motion.from },
		    { "to", motion.to } } );
		std::printf( "WRONG: %s\n", m_wrong.back().dump().c_str() );
		std::fflush( stdout );
	}

	void record( const Task& task, const EdgeWorld& world, const Motion& motion,
	    const std::array<lw_edge_result, 2>& results, bool blocked )
	{
		const Json line = { { "world", world.name }, { "edge", task.number }, { "from", motion.from }, { "to", motion.to },
		    { "certified", lw_verdict_name( results[0].verdict ) }, { "certified_t", results[0].t },
		    { "tables", lw_verdict_name( results[1].verdict ) }, { "tables_t", results[1].t }, { "collides", blocked } };
		const std::lock_guard<std::mutex> lock( m_mutex );
		m_record << line.dump() << '\n';
	}

	// ---- results ----------------------------------------------------------------------------------------------------

	static Json print( const std::string& set, const Tally& t )
	{
		const double n = static_cast<double>( std::max<std::size_t>( t.edges, 1 ) );
		std::printf( "%-36s %7zu %7zu | %7zu %6zu %5zu | %7zu %6zu %5zu | %5zu %5zu %5zu | %5zu %5zu %5zu | %7.0f %6.2f\n",
		    set.c_str(), t.edges, t.colliding, t.free[0], t.undecided[0], t.wrong[0], t.free[1], t.undecided[1], t.wrong[1],
		    t.missed_own[0], t.missed_own[1], t.missed_own[2], t.missed_fcl[0], t.missed_fcl[1], t.missed_fcl[2],
		    static_cast<double>( t.distances ) / n, t.audit_ms / n );
		Json row = { { "set", set }, { "edges", t.edges }, { "colliding", t.colliding } };
		for ( std::size_t i = 0; i < 2; ++i )
		{
			row[i == 0 ? "certified" : "certified_tables"] = {
			    { "free", t.free[i] }, { "undecided", t.undecided[i] }, { "wrong", t.wrong[i] } };
		}
		row["missed_by_own_states"] = t.missed_own;
		row["missed_by_fcl"] = t.missed_fcl;
		row["fcl_differs"] = t.fcl_differs;
		row["auditor_wrong"] = t.auditor_wrong;
		row["distances_per_edge"] = static_cast<double>( t.distances ) / n;
		row["audit_ms_per_edge"] = t.audit_ms / n;
		row["all_ms_per_edge"] = t.all_ms / n;
		return row;
	}

	int report( Result& result )
	{
		std::printf(
		    "edges judged, those that collide; certificates without and with tables: called free, undecided, wrong; "
		    "colliding edges that discrete\n"
		    "validation calls free; distances and milliseconds of processor time per audit\n"
		    "%-36s %7s %7s | %7s %6s %5s | %7s %6s %5s | %5s %5s %5s | %5s %5s %5s | %7s %6s\n",
		    "", "edges", "collide", "free", "ref.", "wrong", "free", "ref.", "wrong", "own1%", ".5%", ".1%", "FCL1%", ".5%",
		    ".1%", "dist.", "ms" );
		Tally total;
		for ( const auto& [set, tally] : m_tallies )
		{
			result.add( print( set, tally ) );
			total.add( tally );
		}
		result.add( print( "all", total ) );
		std::printf(
		    "states at which FCL and the auditor disagree on contact: %zu, brute force with FCL: %zu; %.0f s, %.2f ms of processor "
		    "time per edge\n",
		    total.fcl_differs, total.auditor_wrong, m_seconds,
		    total.all_ms / static_cast<double>( std::max<std::size_t>( total.edges, 1 ) ) );
		result["edges"] = total.edges;
		result["discrete_fractions"] = FRACTIONS;
		result["seconds"] = m_seconds;
		result["wrong"] = m_wrong;
		return total.wrong[0] + total.wrong[1] + total.auditor_wrong > 0 ? 1 : 0;
	}

	const Settings& m_settings;
	EdgeWorlds m_worlds;
	std::shared_ptr<FclModels> m_models;
	std::vector<Task> m_tasks;
	std::atomic<std::size_t> m_next{ 0 }, m_done{ 0 };
	std::atomic<bool> m_failed{ false };
	std::mutex m_mutex; ///< of all below
	std::map<std::string, Tally> m_tallies;
	Json m_wrong = Json::array();
	std::ofstream m_record;
	std::string m_error;
	double m_seconds = 0;
};

} // namespace

void addAuditEdges( Bench& bench )
{
	const auto s = std::make_shared<Settings>();
	Command& command = bench.command( "audit-edges", "who calls a colliding edge free?" );
	command.option( "--data", s->data, "folder of robots and scenes" );
	command.option( "--count", s->edges, "how many edges to judge" );
	command.option( "--only", s->only, "only sets of worlds with this in their name, such as 'armar3 torso' or 'random'" );
	command.option( "--robot", s->robot, "URDF,SRDF,GROUP: this robot instead; GROUP may be joints and groups joined by +" );
	command.inputFile( "--scene", s->scene, "with --robot: planning scene" );
	command.inputFile( "--request", s->request, "with --robot: its start state places the other joints" );
	command.inputFile( "--edges", s->edges_file, "judge the edges of this file instead" );
	command.option( "--record", s->record, "write edges and verdicts to this file" );
	command.option( "--plan-seconds", s->plan_seconds, "for each problem whose planner's motions are judged" );
	command.option( "--resolution", s->resolution, "metres of motion between two states near contact" );
	command.option( "--budget", s->budget, "seconds for pair proofs, per robot" );
	command.option( "--threads", s->threads, "that judge", { 1, 64 } );
	command.option( "--seed", s->seed, "of the edges that are made up" );
	command.work(
	    [s]( Result& result )
	    {
		    std::signal( SIGINT, []( int ) { interrupted = 1; } );
		    return Audit( *s ).run( result );
	    } );
}
