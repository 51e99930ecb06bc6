// SPDX-License-Identifier: BSD-3-Clause
// Self clearance of robots as they come: leeway with its proofs, by spheres alone, and a peer over the same pairs.
//
// The first pass over the states pays for everything that is built on first use, so its slowest state is reported apart; the other
// passes show the times of a running planner. Counters of the query and a hash of all answers make two versions of the engine
// comparable on a busy machine. Then many states are asked with proofs and by spheres alone. Exit status 1 if an answer differs.
#include "groundtruth.hpp"
#include "peers/fcl_peer.hpp"
#include "peers/peers.hpp"
#include "programs/commands.hpp"
#include "support/configurations.hpp"
#include "support/provenance.hpp"
#include "support/race.hpp"

#include "leeway/prepare.hpp"

#include <cmath>
#include <cstdio>
#include <filesystem>

namespace
{

namespace io = leeway::io;

constexpr double INFINITE = std::numeric_limits<double>::infinity();
constexpr double AGREEMENT = 1e-6; ///< metres, a peer against leeway; leeway against itself must agree to the bit

struct Settings
{
	std::string data = LEEWAY_DATA_DIR, cache, peer = "fcl";
	std::vector<std::string> robots; ///< URDF[,SRDF[,GROUP]]
	std::size_t states = 300, identity = 1000;
	int repetitions = 5;
	double budget = 20;
	std::uint64_t seed = 20260101;
	bool quick = false, unprepared = false, no_warm = false;
};

/// A question about a state: the boolean check stops at the first contact.
struct Question
{
	const char* name;
	lw_range range;
	bool boolean;
};

const Question QUESTIONS[] = {
    { "max_d inf", { 0, INFINITE, 0 }, false },
    { "max_d 0.2", { 0, 0.2, 0 }, false },
    { "max_d 0.05", { 0, 0.05, 0 }, false },
    { "max_d 0.01", { 0, 0.01, 0 }, false },
    { "in contact?", { 0, 5e-324, 0 }, true },
};

struct Subject
{
	std::string name, urdf, srdf, group;
	std::string tables; ///< folder of the ground truth; empty: none, random states only
};

/// Groups of the three robots of the data folder, or those that were named.
std::vector<Subject> subjects( const Settings& settings )
{
	std::vector<Subject> list;
	if ( settings.robots.empty() )
	{
		requireData( settings.data, "mbm" );
		const std::string armar = settings.data + "/armar3", mbm = settings.data + "/mbm/";
		for ( const char* group : { "right_arm", "torso_both_arms", "platform_torso_both_arms" } )
		{
			list.push_back( { "armar3", armar + "/armar3.urdf", armar + "/armar3.srdf", group, armar } );
		}
		for ( const auto& [name, group] : { std::pair( "fetch", "arm_with_torso" ), std::pair( "panda", "panda_arm" ) } )
		{
			const std::string folder = mbm + name;
			list.push_back( { name, folder + "/" + name + ".urdf", folder + "/" + name + ".srdf", group, folder } );
		}
	}
	for ( const std::string& text : settings.robots )
	{
		std::vector<std::string> parts = groundtruth::splitLine( text );
		if ( parts.empty() || parts.size() > 3 )
		{
			throw std::runtime_error( "--robot " + text + ": give URDF, URDF,SRDF or URDF,SRDF,GROUP" );
		}
		parts.resize( 3 );
		list.push_back( { std::filesystem::path( parts[0] ).stem().string(), parts[0], parts[1], parts[2], "" } );
	}
	return list;
}

/// Rows of the robot's ground truth tables, every n-th; a joint of the group without a column is 0.
ConfigurationSet tableStates( const Settings& settings, const Subject& subject, const io::Problem& problem )
{
	ConfigurationSet set{ "table", "rows of the ground truth tables", {} };
	std::vector<std::vector<double>> states;
	if ( subject.tables.empty() )
	{
		return set;
	}
	for ( const auto& file : groundtruth::findTables( subject.tables ) )
	{
		const groundtruth::Table table = groundtruth::readTable( file, settings.data );
		for ( const groundtruth::Row& row : table.rows )
		{
			std::vector<double> state( problem.variables.size(), 0.0 );
			for ( std::size_t i = 0; i < table.joints.size(); ++i )
			{
				const auto& names = problem.variable_names;
				const auto found = std::find( names.begin(), names.end(), table.joints[i] );
				if ( found != names.end() )
				{
					state[static_cast<std::size_t>( found - names.begin() )] = row.q[i];
				}
			}
			states.push_back( state );
		}
	}
	const std::size_t stride = std::max<std::size_t>( 1, states.size() / settings.states );
	for ( std::size_t i = 0; i < states.size() && set.states.size() < settings.states; i += stride )
	{
		set.states.push_back( states[i] );
	}
	return set;
}

/// A checker and a query of its own, with all proofs or by spheres alone.
class Asker
{
public:
	Asker( const lw_checker* checker, bool proofs, bool warm ) : m_checker( checker )
	{
		lw_query_def def = lw_query_def_default();
		def.warm_start = warm;
		if ( !proofs )
		{
			def.motion_hulls = def.pair_tables = def.planes = def.warm_start = false;
		}
		m_query = leeway::makeQuery( m_checker, def );
	}

	lw_clearance ask( const double* q, const Question& question )
	{
		lw_state_result result;
		leeway::require(
		    lw_checker_state( m_checker, m_query.get(), q, LW_CHECK_SELF, &question.range, question.boolean, &result ),
		    "a state" );
		return result.self;
	}

	Answer answer( const double* q, const Question& question )
	{
		const lw_clearance c = ask( q, question );
		const double contact = c.kind == LW_CLEARANCE_FAR ? 0 : 1;
		return question.boolean ? Answer{ contact, contact } : Answer{ c.lower, std::min( c.upper, question.range.max_d ) };
	}

	lw_query* query() { return m_query.get(); }

private:
	const lw_checker* m_checker;
	leeway::Query m_query;
};

class Self
{
public:
	Self( const Settings& settings, Result& result ) : m_settings( settings ), m_result( result ), m_random( settings.seed )
	{
	}

	static void printHeader()
	{
		std::printf( "microseconds a state: mean (median); ratios of means\n" );
		std::printf( "%-34s %-8s %-12s | %8s %10s | %8s %10s | %8s %10s | %7s %7s\n", "robot", "set", "question", "peer", "",
		    "spheres", "", "leeway", "", "peer x", "spheres" );
	}

	void run( const Subject& subject )
	{
		m_name = subject.name + ( subject.group.empty() ? "" : " " + subject.group );
		const io::RobotModel model = io::loadRobot( subject.urdf, subject.srdf );
		io::ProblemOptions options;
		options.group = subject.group;
		if ( m_settings.budget > 0 )
		{
			options.find_reach = io::ReachOptions();
			options.find_reach->def.seconds = m_settings.budget;
			options.find_reach->cache = m_settings.cache;
		}
		const io::Problem problem = io::buildProblem( model, options );
		m_checker = problem.checker.get();
		m_prepare_ms = 0;
		if ( !m_settings.unprepared )
		{
			const double start = threadMicroseconds();
			leeway::require( leeway::prepare( m_checker, 1 ), "meshes" ); // one thread: its processor time is all there is
			m_prepare_ms = 1e-3 * ( threadMicroseconds() - start );
		}
		m_usual = std::make_unique<Asker>( m_checker, true, !m_settings.no_warm );
		m_spheres = std::make_unique<Asker>( m_checker, false, false );
		makePeer();
		ConfigurationSet uniform{ "uniform", "uniform within the limits", {} };
		for ( std::size_t i = 0; i < m_settings.states; ++i )
		{
			uniform.states.push_back( uniformState( problem, m_random ) );
		}
		firstPass( uniform );
		for ( const ConfigurationSet& set : { tableStates( m_settings, subject, problem ), uniform } )
		{
			for ( const Question& question : QUESTIONS )
			{
				if ( !set.states.empty() )
				{
					compare( set, question );
				}
			}
		}
		countDifferences( problem );
	}

	bool agreed() const { return m_agreed; }

private:
	void makePeer()
	{
		m_peer.reset();
		if ( m_settings.peer == "none" )
		{
			return;
		}
		std::unique_ptr<PeerEngine> engine =
		    m_settings.peer == "fcl" ? std::make_unique<FclEngine>() : loadPeer( m_settings.peer ).make();
		try
		{
			m_peer = std::make_unique<PairPeer>( m_checker, std::move( engine ) );
		}
		catch ( const std::runtime_error& error ) // a shape that it does not have
		{
			std::printf( "%s: without a peer: %s\n", m_name.c_str(), error.what() );
		}
		const std::size_t pairs = lw_checker_get_info( m_checker ).self_pairs;
		if ( m_peer && m_peer->selfPairs() != pairs )
		{
			throw std::runtime_error( m_name + ": the peer checks " + std::to_string( m_peer->selfPairs() ) +
			                          " pairs, leeway " + std::to_string( pairs ) );
		}
	}

	/// The exact question about states that are new, then the counters of a pass over them.
	void firstPass( const ConfigurationSet& set )
	{
		const Question& exact = QUESTIONS[0];
		double first = 0, worst = 0;
		for ( const std::vector<double>& q : set.states )
		{
			const double start = threadMicroseconds();
			(void)m_usual->ask( q.data(), exact );
			const double taken = threadMicroseconds() - start;
			first += taken;
			worst = std::max( worst, taken );
		}
		lw_query_reset_stats( m_usual->query() );
		for ( const std::vector<double>& q : set.states )
		{
			(void)m_usual->ask( q.data(), exact );
		}
		const lw_query_stats stats = lw_query_get_stats( m_usual->query() );
		const auto each = [&]( std::uint64_t n ) { return rounded( static_cast<double>( n ) / set.states.size() ); };
		const lw_checker_info info = lw_checker_get_info( m_checker );
		m_first = { { "robot", m_name }, { "set", "first pass" }, { "question", exact.name },
		    { "self_pairs", info.self_pairs }, { "proved_apart", info.never_pairs },
		    { "prepare_ms", rounded( m_prepare_ms ) }, { "first_pass_ms", rounded( 1e-3 * first ) },
		    { "worst_ms", rounded( 1e-3 * worst ) }, { "searches", each( stats.queries ) },
		    { "node_tests", each( stats.node_tests ) }, { "leaf_tests", each( stats.leaf_tests ) },
		    { "triangle_tests", each( stats.triangle_tests ) }, { "exact_tests", each( stats.exact_tests ) } };
		std::printf(
		    "%s: %u pairs, %u proved apart; prepared in %.1f ms, first pass %.1f ms, its worst state %.2f ms; a state: %s "
		    "searches, %s node, %s leaf tests, %s triangle pairs, %s in double\n",
		    m_name.c_str(), info.self_pairs, info.never_pairs, m_prepare_ms, 1e-3 * first, 1e-3 * worst,
		    m_first["searches"].dump().c_str(), m_first["node_tests"].dump().c_str(), m_first["leaf_tests"].dump().c_str(),
		    m_first["triangle_tests"].dump().c_str(), m_first["exact_tests"].dump().c_str() );
		m_result.add( m_first );
	}

	void compare( const ConfigurationSet& set, const Question& question )
	{
		const auto by = [&question]( Asker& asker )
		{ return [&asker, &question]( const double* q ) { return asker.answer( q, question ); }; };
		std::vector<Contender> contenders = { { "leeway", by( *m_usual ) }, { "spheres", by( *m_spheres ) } };
		if ( m_peer )
		{
			contenders.push_back( { m_peer->engine().name(), [this, &question]( const double* q )
			    {
				    m_peer->pose( q );
				    const double d =
				        question.boolean ? ( m_peer->selfCollides() ? 1 : 0 ) : m_peer->selfDistance( question.range.max_d );
				    return Answer{ d, d };
			    } } );
		}
		const std::vector<Run> runs = race( contenders, set, m_settings.repetitions );
		Json row = {
		    { "robot", m_name }, { "set", set.name }, { "question", question.name }, { "states", set.states.size() } };
		std::vector<Summary> s;
		for ( std::size_t c = 0; c < runs.size(); ++c )
		{
			s.push_back( summarise( runs[c] ) );
			row[contenders[c].name] = toJson( s.back() );
		}
		s.resize( 3 ); // zeros: no peer
		const double tolerance = m_peer ? AGREEMENT + m_peer->largestShapeError() : 0;
		std::size_t differ = disagreements( runs[0], runs[1], 0 );
		differ += m_peer ? disagreements( runs[0], runs[2], tolerance ) : 0;
		Hash hash;
		for ( const Answer& answer : runs[0].answers )
		{
			hash.add( std::llround( std::min( answer.upper, 1e3 ) * 1e12 ) );
		}
		row["disagreements"] = differ;
		row["answers_hash"] = hash.text();
		m_agreed = m_agreed && differ == 0;
		std::printf( "%-34.34s %-8s %-12s | %8.1f (%8.1f) | %8.1f (%8.1f) | %8.1f (%8.1f) | %7.1f %7.2f%s\n", m_name.c_str(),
		    set.name.c_str(), question.name, s[2].mean, s[2].median, s[1].mean, s[1].median, s[0].mean, s[0].median,
		    s[2].mean / s[0].mean, s[1].mean / s[0].mean, differ > 0 ? "  ANSWERS DIFFER" : "" );
		std::fflush( stdout );
		m_result.add( std::move( row ) );
	}

	/// States whose answer differs. A peer that says "in contact" without a distance must agree about that.
	static std::size_t disagreements( const Run& one, const Run& other, double tolerance )
	{
		std::size_t count = 0;
		for ( std::size_t i = 0; i < one.answers.size(); ++i )
		{
			// without an answer (beyond max_d) both are max_d
			count += !( std::abs( one.answers[i].upper - other.answers[i].upper ) <= tolerance );
		}
		return count;
	}

	/// Verdicts and intervals, with proofs against spheres alone, one state after the other; every tenth leaves the limits.
	void countDifferences( const io::Problem& problem )
	{
		std::size_t differ = 0, contacts = 0;
		double largest = 0;
		for ( std::size_t i = 0; i < m_settings.identity; ++i )
		{
			std::vector<double> q = uniformState( problem, m_random );
			if ( i % 10 == 9 )
			{
				q[m_random() % q.size()] += 4 * uniform( m_random ) - 2;
			}
			for ( const Question& question : { QUESTIONS[4], QUESTIONS[2], QUESTIONS[0] } )
			{
				const lw_clearance all = m_spheres->ask( q.data(), question ), got = m_usual->ask( q.data(), question );
				const bool violation = all.kind == LW_CLEARANCE_VIOLATION;
				const double lower = all.lower == got.lower ? 0 : std::abs( all.lower - got.lower );
				differ += all.kind != got.kind || ( !violation && ( all.upper != got.upper || lower > 1e-12 ) );
				largest = std::max( largest, lower );
				contacts += violation && question.boolean;
			}
		}
		std::printf(
		    "%s: %zu states, 3 questions each: %zu answers differ from those by spheres alone, lower ends by at most %.1e "
		    "m; %zu in contact\n\n",
		    m_name.c_str(), m_settings.identity, differ, largest, contacts );
		m_result["identity"].push_back( Json{ { "robot", m_name }, { "states", m_settings.identity },
		    { "disagreements", differ }, { "largest_lower_difference_m", largest }, { "contacts", contacts } } );
		m_agreed = m_agreed && differ == 0;
	}

	const Settings& m_settings;
	Result& m_result;
	std::mt19937_64 m_random;
	std::string m_name;
	const lw_checker* m_checker = nullptr;
	double m_prepare_ms = 0;
	Json m_first;
	std::unique_ptr<Asker> m_usual, m_spheres;
	std::unique_ptr<PairPeer> m_peer;
	bool m_agreed = true;
};

int run( const Settings& settings, Result& result )
{
	Self self( settings, result );
	Self::printHeader();
	bool failed = false;
	for ( const Subject& subject : subjects( settings ) )
	{
		try
		{
			self.run( subject );
		}
		catch ( const std::exception& error ) // the next robot may do
		{
			std::printf( "%s: error: %s\n", subject.name.c_str(), error.what() );
			failed = true;
		}
	}
	std::printf( "%s\n", self.agreed() ? "all answers agree" : "ANSWERS DIFFER" );
	return failed || !self.agreed() ? 1 : 0;
}

} // namespace

void addSelf( Bench& bench )
{
	const auto s = std::make_shared<Settings>();
	Command& command = bench.command( "self", "self clearance of robots: leeway, by spheres alone, and a peer" );
	command.option( "--data", s->data, "folder with armar3 and mbm" );
	command.option( "--robot", s->robots, "URDF, URDF,SRDF or URDF,SRDF,GROUP instead of the data's; again for more" );
	command.option( "--states", s->states, "per set, at most", { 1, 100000 } );
	command.option( "--repetitions", s->repetitions, "passes over each set", { 1, 1000 } );
	command.option( "--identity", s->identity, "states per robot that are asked with proofs and by spheres alone" );
	command.option( "--budget", s->budget, "seconds of proofs for pair tables, per robot; 0: no tables", { 0 } );
	command.option( "--cache", s->cache, "folder where tables are kept" );
	command.option( "--peer", s->peer, "fcl, none, or a module such as leeway_peer_coal.so" );
	command.flag( "--unprepared", s->unprepared, "leave meshes to the states that need them first" );
	command.flag( "--no-warm", s->no_warm, "no warm starts" );
	command.option( "--seed", s->seed, "of the random states" );
	command.flag( "--quick", s->quick, "40 states per set, one pass, a budget of 2 s" );
	command.work(
	    [s]( Result& result )
	    {
		    if ( s->quick )
		    {
			    s->states = std::min<std::size_t>( s->states, 40 );
			    s->budget = std::min( s->budget, 2.0 );
			    s->repetitions = 1;
		    }
		    return run( *s, result );
	    } );
}
