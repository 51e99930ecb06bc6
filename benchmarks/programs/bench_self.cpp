// SPDX-License-Identifier: BSD-3-Clause
// Self clearance: FCL and spheres alone against motion hulls and pair tables, and a long count of answers that differ.
//
// Groups of ARMAR-III, Fetch and Panda; rows of the ground truth tables and uniform states; ranges from a boolean check to
// the exact distance. All contenders check the same pairs. Exit status 1 if any answer differs.
#include "support/bench_program.hpp"
#include "peers/fcl_peer.hpp"
#include "groundtruth.hpp"
#include "leeway/io/model.hpp"
#include "support/provenance.hpp"
#include "support/race.hpp"

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <memory>
#include <random>

namespace
{

using Json = nlohmann::ordered_json;

constexpr double INFINITE = std::numeric_limits<double>::infinity();
constexpr double AGREEMENT = 1e-6; ///< metres, FCL against leeway; leeway against itself must agree to the bit

struct Settings
{
	std::string data = LEEWAY_DATA_DIR, json, cache;
	std::vector<std::string> robots; ///< URDF,SRDF,GROUP
	std::size_t states = 400, identity = 100000;
	int repetitions = 5;
	double budget = 20;
	std::uint64_t seed = 20260101;
};

/// A question about a state: the boolean check stops at the first contact.
struct Question
{
	const char* name;
	lw_range range;
	bool boolean;
};

const Question QUESTIONS[] = {
	{ "in contact?", lw_range_threshold( 0 ), true },
	{ "max_d 0.01", { 0, 0.01, 0 }, false },
	{ "max_d 0.05", { 0, 0.05, 0 }, false },
	{ "max_d 0.2", { 0, 0.2, 0 }, false },
	{ "max_d inf", { 0, INFINITE, 0 }, false },
};

struct Model
{
	std::string name, urdf, srdf;
	std::string tables; ///< folder of the ground truth; empty: none, random states only
	std::vector<std::string> groups;
	bool meshes_only; ///< then FCL takes part; its boxes and spheres are other shapes than its meshes
};

/// The three robots of the data folder, or those that were named.
std::vector<Model> models( const Settings& settings )
{
	const std::string armar = settings.data + "/armar3", fetch = settings.data + "/mbm/fetch",
	                  panda = settings.data + "/mbm/panda";
	if ( settings.robots.empty() )
	{
		return { { "ARMAR-III", armar + "/armar3.urdf", armar + "/armar3.srdf", armar,
					 { "right_arm", "torso_both_arms", "platform_torso_both_arms" }, true },
			{ "Fetch", fetch + "/fetch.urdf", fetch + "/fetch.srdf", fetch, { "arm_with_torso" }, false },
			{ "Panda", panda + "/panda.urdf", panda + "/panda.srdf", panda, { "panda_arm" }, true } };
	}
	std::vector<Model> named;
	for ( const std::string& text : settings.robots )
	{
		const std::vector<std::string> parts = groundtruth::splitLine( text );
		if ( parts.size() != 3 )
		{
			throw std::runtime_error( "--robot " + text + ": give URDF,SRDF,GROUP" );
		}
		named.push_back(
		    { std::filesystem::path( parts[0] ).stem().string(), parts[0], parts[1], "", { parts[2] }, false } );
	}
	return named;
}

/// A robot, and its proved separations with and without subdivision.
struct Subject
{
	const Model* model;
	leeway::io::RobotModel robot;
	leeway::io::LoadedReach hulls, tables;
};

/// A checker for one group that uses one of the two.
leeway::io::Problem makeProblem( const Subject& subject, const char* group, const leeway::Reach& reach )
{
	leeway::io::ProblemOptions options;
	options.group = group;
	options.reach = reach;
	return leeway::io::buildProblem( subject.robot, options );
}

Subject makeSubject( const Settings& settings, const Model& model )
{
	Subject subject{ &model, leeway::io::loadRobot( model.urdf, model.srdf ), {}, {} };
	leeway::io::ProblemOptions none;
	const leeway::io::Problem whole = leeway::io::buildProblem( subject.robot, none );
	leeway::io::ReachOptions options;
	options.def.seconds = 0;
	subject.hulls = leeway::io::loadReach( whole.robot, options );
	options.cache = settings.cache;
	options.def.seconds = settings.budget;
	subject.tables = leeway::io::loadReach( whole.robot, options );
	return subject;
}

double uniform( std::mt19937_64& random )
{
	return static_cast<double>( random() >> 11 ) * 0x1p-53;
}

/// Uniform within the limits; without limits as the neutral state has it.
std::vector<double> uniformState( const leeway::io::Problem& problem, std::mt19937_64& random )
{
	std::vector<double> state;
	for ( uint32_t variable : problem.variables )
	{
		const lw_variable_info info = lw_robot_variable( problem.robot.get(), variable );
		const bool limited = std::isfinite( info.lower ) && std::isfinite( info.upper );
		const double share = uniform( random );
		state.push_back( limited ? info.lower + share * ( info.upper - info.lower ) : problem.reference[variable] );
	}
	return state;
}

/// Rows of the robot's ground truth tables, every n-th; a joint of the group without a column is 0.
ConfigurationSet tableStates( const Settings& settings, const Subject& subject, const leeway::io::Problem& problem )
{
	ConfigurationSet set{ "table", "rows of the ground truth tables", {} };
	std::vector<std::vector<double>> states;
	for ( const auto& file : groundtruth::findTables( subject.model->tables ) )
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

/// A checker and a query of its own, with the proofs of the reach or by spheres alone.
class Asker
{
public:
	Asker( const leeway::io::Problem& problem, bool proofs ) : m_checker( problem.checker.get() )
	{
		lw_query_def def = lw_query_def_default();
		def.motion_hulls = def.pair_tables = proofs;
		m_query = leeway::makeQuery( m_checker, def );
	}

	lw_clearance ask( const double* q, const Question& question )
	{
		lw_state_result result;
		leeway::require( lw_checker_state( m_checker, m_query.get(), q, LW_CHECK_SELF, &question.range, question.boolean,
							 &result ),
			"a state" );
		return result.self;
	}

	Answer answer( const double* q, const Question& question )
	{
		const lw_clearance c = ask( q, question );
		const double contact = c.kind == LW_CLEARANCE_FAR ? 0 : 1;
		return question.boolean ? Answer{ contact, contact } : Answer{ c.lower, std::min( c.upper, question.range.max_d ) };
	}

private:
	const lw_checker* m_checker;
	leeway::Query m_query;
};

Answer askFcl( FclPeer& fcl, const double* q, const Question& question )
{
	fcl.pose( q );
	const double value = question.boolean ? ( fcl.selfCollides() ? 1 : 0 ) : fcl.selfDistance( question.range.max_d );
	return { value, value };
}

/// States whose answer by one contender differs from that by spheres alone.
std::size_t disagreements( const Run& spheres, const Run& other, double tolerance )
{
	std::size_t count = 0;
	for ( std::size_t i = 0; i < spheres.answers.size(); ++i )
	{
		// without an answer (beyond max_d) both are max_d
		count += !( std::abs( spheres.answers[i].upper - other.answers[i].upper ) <= tolerance );
	}
	return count;
}

class Bench
{
public:
	explicit Bench( const Settings& settings ) : m_settings( settings ), m_random( settings.seed ) {}

	void run( const Subject& subject, const char* group )
	{
		const leeway::io::Problem hulls = makeProblem( subject, group, subject.hulls.reach );
		const leeway::io::Problem tables = makeProblem( subject, group, subject.tables.reach );
		const lw_checker_info info = lw_checker_get_info( tables.checker.get() );
		std::printf( "\n%s %s: %u bodies moving, %u static, %u self pairs, %u proved apart (%u by hulls)\n",
		    subject.model->name.c_str(), group, info.moving_bodies, info.static_bodies, info.self_pairs, info.never_pairs,
		    lw_checker_get_info( hulls.checker.get() ).never_pairs );
		std::unique_ptr<FclPeer> fcl;
		if ( subject.model->meshes_only )
		{
			fcl = std::make_unique<FclPeer>( tables.checker.get() );
			m_agreed = m_agreed && fcl->selfPairs() == info.self_pairs;
		}
		m_spheres = std::make_unique<Asker>( tables, false );
		m_hulls = std::make_unique<Asker>( hulls, true );
		m_tables = std::make_unique<Asker>( tables, true );
		ConfigurationSet random{ "uniform", "uniform within the limits", {} };
		for ( std::size_t i = 0; i < m_settings.states; ++i )
		{
			random.states.push_back( uniformState( tables, m_random ) );
		}
		for ( const ConfigurationSet& set : { tableStates( m_settings, subject, tables ), random } )
		{
			if ( set.states.empty() )
			{
				continue; // no ground truth of this robot
			}
			for ( const Question& question : QUESTIONS )
			{
				compare( subject, group, set, question, fcl.get() );
			}
		}
		countDisagreements( subject, group, tables );
	}

	static void printHeader()
	{
		std::printf(
		    "\nself clearance, microseconds per state: mean and median; ratios of means, FCL and spheres over tables\n" );
		std::printf( "%-8s %-12s | %9s %8s | %8s %8s | %8s %8s | %8s %8s | %7s %8s\n", "set", "question", "FCL", "median",
			"spheres", "median", "hulls", "median", "tables", "median", "FCL x", "spheres x" );
	}

	bool agreed() const { return m_agreed; }
	std::string answerHash() const { return m_hash.text(); }
	const Json& rows() const { return m_rows; }
	const Json& identity() const { return m_identity; }

private:
	void compare(
	    const Subject& subject, const char* group, const ConfigurationSet& set, const Question& question, FclPeer* fcl )
	{
		const auto by = [&question]( Asker& asker ) {
			return [&asker, &question]( const double* q ) { return asker.answer( q, question ); };
		};
		std::vector<Contender> contenders = { { "spheres", by( *m_spheres ) }, { "hulls", by( *m_hulls ) },
			{ "tables", by( *m_tables ) } };
		if ( fcl != nullptr )
		{
			contenders.push_back( { "FCL", [fcl, &question]( const double* q ) { return askFcl( *fcl, q, question ); } } );
		}
		const std::vector<Run> runs = race( contenders, set, m_settings.repetitions );
		std::vector<Summary> s;
		Json row = { { "robot", subject.model->name }, { "group", group }, { "set", set.name },
		    { "question", question.name }, { "states", set.states.size() } };
		std::size_t differ = 0;
		for ( std::size_t i = 0; i < runs.size(); ++i )
		{
			s.push_back( summarise( runs[i].microseconds ) );
			row[contenders[i].name] = toJson( s.back() );
			differ += disagreements( runs[0], runs[i], contenders[i].name == "FCL" ? AGREEMENT : 0 );
		}
		for ( const Answer& answer : runs[2].answers )
		{
			m_hash.add( std::llround( std::min( answer.upper, 1e3 ) * 1e9 ) );
		}
		const Summary f = fcl != nullptr ? s[3] : Summary{}; // 0: not asked
		std::printf( "%-8s %-12s | %9.1f %8.1f | %8.1f %8.1f | %8.1f %8.1f | %8.1f %8.1f | %7.1f %8.2f%s\n",
		    set.name.c_str(), question.name, f.mean, f.median, s[0].mean, s[0].median, s[1].mean, s[1].median, s[2].mean,
		    s[2].median, f.mean / s[2].mean, s[0].mean / s[2].mean, differ > 0 ? "  ANSWERS DIFFER" : "" );
		std::fflush( stdout );
		row["disagreements"] = differ;
		m_rows.push_back( row );
		m_agreed = m_agreed && differ == 0;
	}

	/// Verdicts and intervals, tables against spheres alone, one state after the other; every tenth leaves the limits.
	void countDisagreements( const Subject& subject, const char* group, const leeway::io::Problem& problem )
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
			for ( const Question& question : { QUESTIONS[0], QUESTIONS[2], QUESTIONS[4] } )
			{
				const lw_clearance all = m_spheres->ask( q.data(), question ), got = m_tables->ask( q.data(), question );
				const bool violation = all.kind == LW_CLEARANCE_VIOLATION;
				const double lower = all.lower == got.lower ? 0 : std::abs( all.lower - got.lower );
				differ += all.kind != got.kind || ( !violation && ( all.upper != got.upper || lower > 1e-12 ) );
				largest = std::max( largest, lower );
				contacts += violation && question.boolean;
			}
		}
		std::printf(
		    "identity: %zu states, 3 questions each: %zu answers differ, lower ends by at most %.1e m; %zu in contact\n",
		    m_settings.identity, differ, largest, contacts );
		std::fflush( stdout );
		m_identity.push_back( Json{ { "robot", subject.model->name }, { "group", group }, { "states", m_settings.identity },
			{ "disagreements", differ }, { "largest_lower_difference_m", largest }, { "contacts", contacts } } );
		m_agreed = m_agreed && differ == 0;
	}

	const Settings& m_settings;
	std::mt19937_64 m_random;
	std::unique_ptr<Asker> m_spheres, m_hulls, m_tables;
	Json m_rows = Json::array(), m_identity = Json::array();
	Hash m_hash;
	bool m_agreed = true;
};

int run( const Settings& settings )
{
	Json json = { { "benchmark", "bench_self" } };
	json.update( provenance() );
	json["seed"] = settings.seed;
	json["repetitions"] = settings.repetitions;
	json["states_per_set"] = settings.states;
	json["budget_s"] = settings.budget;
	std::printf( "%s, %s, leeway at %s, FCL %s; commit %s%s\n", json["processor"].get<std::string>().c_str(),
		json["compiler"].get<std::string>().c_str(), json["simd"].get<std::string>().c_str(),
		json["fcl_version"].get<std::string>().c_str(), json["commit"].get<std::string>().c_str(),
		json["dirty"].get<bool>() ? " (changed)" : "" );
	Bench bench( settings );
	json["reach"] = Json::array();
	Bench::printHeader();
	for ( const Model& model : models( settings ) )
	{
		const Subject subject = makeSubject( settings, model );
		std::printf( "\n%s: hulls and their proofs %.1f s, with %.0f s of subdivision %s %.3f s\n", model.name.c_str(),
		    1e-3 * subject.hulls.milliseconds, settings.budget,
		    subject.tables.cached ? "read from the cache in" : "built in", 1e-3 * subject.tables.milliseconds );
		json["reach"].push_back( Json{ { "robot", model.name }, { "hulls_ms", subject.hulls.milliseconds },
			{ "tables_ms", subject.tables.milliseconds }, { "cached", subject.tables.cached } } );
		for ( const std::string& group : model.groups )
		{
			bench.run( subject, group.c_str() );
		}
	}
	json["comparison"] = bench.rows();
	json["identity"] = bench.identity();
	json["answer_hash"] = bench.answerHash();
	json["agreed"] = bench.agreed();
	std::printf(
	    "\nanswer hash %s: %s\n", bench.answerHash().c_str(), bench.agreed() ? "all answers agree" : "ANSWERS DIFFER" );
	writeResult( settings.json, json );
	return bench.agreed() ? 0 : 1;
}

} // namespace

int main( int argc, char** argv )
{
	Settings settings;
	bool quick = false;
	BenchProgram program( "bench_self", "Self clearance of robots: FCL, spheres alone, motion hulls and pair tables." );
	program.option( "--data", settings.data, "folder with armar3 and mbm" );
	program.option(
	    "--robot", settings.robots, "URDF,SRDF,GROUP instead of the robots of the data folder; FCL is not asked" );
	program.option( "--states", settings.states, "states per set, at most", { 1, 100000 } );
	program.option( "--repetitions", settings.repetitions, "passes over each set", { 1, 1000 } );
	program.option( "--identity", settings.identity, "states per group for the count of disagreements" );
	program.option( "--budget", settings.budget, "seconds of proofs by subdivision per robot", { 0 } );
	program.option( "--cache", settings.cache, "folder where tables are kept" );
	program.option( "--seed", settings.seed, "of the random states" );
	program.option( "--json", settings.json, "write the figures and where they come from to this file" );
	program.flag( "--quick", quick, "40 states per set, one pass, 2,000 for identity, a budget of 2 s" );
	return program.run( argc, argv,
		[&]
		{
			if ( quick )
			{
				settings.states = std::min<std::size_t>( settings.states, 40 );
				settings.identity = std::min<std::size_t>( settings.identity, 2000 );
				settings.budget = std::min( settings.budget, 2.0 );
				settings.repetitions = 1;
			}
			if ( settings.robots.empty() )
			{
				requireData( settings.data, "mbm" );
			}
			return run( settings );
		} );
}
