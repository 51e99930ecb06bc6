// SPDX-License-Identifier: BSD-3-Clause
// Clearance of ARMAR-III in the cluttered KIT kitchen: leeway against FCL in one run, the same states, interleaved state by
// state, and leeway against itself with other fits, levels and switches. Exit status 1 if the answers differ.
//
// Each contender passes over a set of states several times; the time of a state is the median over the passes. Passes go
// over the whole set, so that no contender sees the same state twice in a row and profits from its last answer.
#include "support/bench_program.hpp"
#include "support/configurations.hpp"
#include "peers/fcl_peer.hpp"
#include "support/provenance.hpp"
#include "support/race.hpp"
#include "support/tree_cost.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <memory>

namespace
{

using Json = nlohmann::ordered_json;

constexpr double INFINITE = std::numeric_limits<double>::infinity();
constexpr double AGREEMENT = 1e-6; ///< metres: both are exact, FCL's triangles are leeway's vertices in double
constexpr double MARGIN = 0.01, ALPHA = 0.3;

struct Settings
{
	std::string data = LEEWAY_DATA_DIR, json;
	std::size_t states = 400;
	int repetitions = 5;
	std::uint64_t seed = 20260101;
};

/// A checker with its own query.
class Leeway
{
public:
	Leeway( const leeway::io::Problem& problem, const lw_query_def& def )
		: m_problem( problem ), m_query( leeway::makeQuery( problem.checker.get(), def ) )
	{
	}

	Answer clearance( const double* q, lw_check_flags flags, const lw_range& range )
	{
		const lw_state_result result = ask( q, flags, range, false );
		const lw_clearance& c = flags == LW_CHECK_SELF ? result.self : result.environment;
		return { c.lower, c.upper };
	}

	/// Is any clearance <= min_d? The answer has no distance.
	Answer violates( const double* q, lw_check_flags flags, double min_d )
	{
		bool free = false;
		leeway::require( lw_checker_is_free( m_problem.checker.get(), m_query.get(), q, flags, min_d, &free, nullptr ), "a state" );
		const double answer = free ? 0 : 1;
		return { answer, answer };
	}

private:
	lw_state_result ask( const double* q, lw_check_flags flags, const lw_range& range, bool stop_at_first )
	{
		lw_state_result result;
		leeway::require(
		    lw_checker_state( m_problem.checker.get(), m_query.get(), q, flags, &range, stop_at_first, &result ),
		    "a state" );
		return result;
	}

	const leeway::io::Problem& m_problem;
	leeway::Query m_query;
};

/// How two columns of answers compare.
struct Agreement
{
	double largest_difference = 0;
	std::size_t disagreements = 0;
};

/// Distances, or intervals around them: `exact` must be within `got`, widened by the tolerance.
Agreement compareDistances( const Run& exact, const Run& got )
{
	Agreement agreement;
	for ( std::size_t i = 0; i < exact.answers.size(); ++i )
	{
		const double truth = exact.answers[i].upper;
		const double difference = std::max( { 0.0, got.answers[i].lower - truth, truth - got.answers[i].upper } );
		agreement.largest_difference = std::max( agreement.largest_difference, difference );
		agreement.disagreements += !( difference < AGREEMENT );
	}
	return agreement;
}

/// Yes or no: they may only differ where the exact distance is the threshold, to within the tolerance.
Agreement compareVerdicts( const Run& one, const Run& other, const Run* exact, double threshold )
{
	Agreement agreement;
	for ( std::size_t i = 0; i < one.answers.size(); ++i )
	{
		const bool undecidable = exact != nullptr && std::abs( exact->answers[i].upper - threshold ) < AGREEMENT;
		agreement.disagreements += one.answers[i].upper != other.answers[i].upper && !undecidable;
	}
	return agreement;
}

/// A class of the states of a set, by their distance.
struct Class
{
	const char* name;
	bool ( *contains )( double distance );
};

const Class CLASSES[] = {
	{ "all", []( double ) { return true; } },
	{ "free", []( double distance ) { return distance > 0; } },
	{ "free < 50 mm", []( double distance ) { return distance > 0 && distance < 0.05; } },
	{ "colliding", []( double distance ) { return distance <= 0; } },
};

std::vector<double> timesOf( const Run& run, const Run& exact, const Class& of )
{
	std::vector<double> times;
	for ( std::size_t i = 0; i < run.microseconds.size(); ++i )
	{
		if ( of.contains( exact.answers[i].upper ) )
		{
			times.push_back( run.microseconds[i] );
		}
	}
	return times;
}

/// One line of the table: FCL against leeway on a class of a set.
Json printComparison( const char* query, const ConfigurationSet& set, const Class& of, const Run& fcl, const Run& leeway,
	const Run& exact )
{
	const std::vector<double> fcl_times = timesOf( fcl, exact, of ), leeway_times = timesOf( leeway, exact, of );
	const Summary f = summarise( fcl_times ), l = summarise( leeway_times );
	if ( fcl_times.empty() )
	{
		return nullptr;
	}
	std::printf( "%-22s %-10s %-13s %5zu | %8.1f %8.1f %8.1f | %8.1f %8.1f %8.1f | %6.2f %6.2f\n", query, set.name.c_str(),
		of.name, fcl_times.size(), f.median, f.mean, f.p95, l.median, l.mean, l.p95, f.median / l.median, f.mean / l.mean );
	std::fflush( stdout );
	return Json{ { "query", query }, { "set", set.name }, { "class", of.name }, { "states", fcl_times.size() },
		{ "fcl", toJson( f ) }, { "leeway", toJson( l ) }, { "ratio_of_medians", f.median / l.median },
		{ "ratio_of_means", f.mean / l.mean } };
}

class Comparison
{
public:
	Comparison( const Settings& settings, const leeway::io::Problem& problem )
		: m_settings( settings ), m_fcl( problem.checker.get() ), m_leeway( problem, lw_query_def_default() )
	{
		const lw_checker_info info = lw_checker_get_info( problem.checker.get() );
		if ( m_fcl.environmentPairs() != info.environment_pairs || m_fcl.selfPairs() != info.self_pairs )
		{
			std::printf( "the contenders check different pairs: environment %zu and %u, self %zu and %u\n",
				m_fcl.environmentPairs(), info.environment_pairs, m_fcl.selfPairs(), info.self_pairs );
			m_disagreed = true;
		}
	}

	static void printHeader()
	{
		std::printf( "\nmicroseconds per state%46s FCL %24s leeway %15s FCL / leeway\n", "|", "|", "|" );
		std::printf( "%-22s %-10s %-13s %5s | %8s %8s %8s | %8s %8s %8s | %6s %6s\n", "query", "set", "class", "n", "median",
			"mean", "p95", "median", "mean", "p95", "median", "mean" );
	}

	/// All queries over one set.
	void compare( const ConfigurationSet& set, Json& rows )
	{
		const std::vector<Run> exact = race( environmentExact(), set, m_settings.repetitions );
		for ( const Class& of : CLASSES )
		{
			add( rows, printComparison( "environment exact", set, of, exact[0], exact[1], exact[0] ) );
		}
		check( "environment exact", set, compareDistances( exact[0], exact[1] ), rows );
		for ( const Answer& answer : exact[1].answers )
		{
			m_hash.add( std::llround( answer.upper * 1e9 ) );
		}

		const std::vector<Run> relative = race( environmentRelative(), set, m_settings.repetitions );
		add( rows, printComparison( "environment alpha 0.3", set, CLASSES[0], relative[0], relative[1], exact[0] ) );
		check( "environment alpha 0.3", set, compareDistances( exact[0], relative[1] ), rows );

		const std::vector<Run> margin = race( environmentMargin(), set, m_settings.repetitions );
		add( rows, printComparison( "environment > 10 mm?", set, CLASSES[0], margin[0], margin[1], exact[0] ) );
		check( "environment > 10 mm?", set, compareVerdicts( margin[0], margin[1], &exact[0], MARGIN ), rows );

		const std::vector<Run> collision = race( environmentCollision(), set, m_settings.repetitions );
		add( rows, printComparison( "environment free?", set, CLASSES[0], collision[0], collision[1], exact[0] ) );
		check( "environment free?", set, compareVerdicts( collision[0], collision[1], nullptr, 0 ), rows );

		const std::vector<Run> self = race( selfExact(), set, m_settings.repetitions );
		add( rows, printComparison( "self exact", set, CLASSES[0], self[0], self[1], exact[0] ) );
		check( "self exact", set, compareDistances( self[0], self[1] ), rows );

		const std::vector<Run> valid = race( validity(), set, m_settings.repetitions );
		add( rows, printComparison( "valid (both)?", set, CLASSES[0], valid[0], valid[1], exact[0] ) );
		check( "valid (both)?", set, compareVerdicts( valid[0], valid[1], nullptr, 0 ), rows );
	}

	const FclPeer& fcl() const { return m_fcl; }
	bool disagreed() const { return m_disagreed; }
	double largestDifference() const { return m_largest; }
	std::string answerHash() const { return m_hash.text(); }

private:
	static Answer single( double value ) { return { value, value }; }

	std::vector<Contender> environmentExact()
	{
		return { { "FCL",
		             [this]( const double* q )
		             {
			             m_fcl.pose( q );
			             return single( m_fcl.environmentDistance( INFINITE ) );
		             } },
		    { "leeway",
		        [this]( const double* q ) { return m_leeway.clearance( q, LW_CHECK_ENVIRONMENT, lw_range_exact() ); } } };
	}

	// FCL: found <= (1 + rel_err) true. leeway: (1 - alpha) found <= true. Hence rel_err = alpha / (1 - alpha).
	std::vector<Contender> environmentRelative()
	{
		const lw_range range = { 0, INFINITE, ALPHA };
		return { { "FCL",
		             [this]( const double* q )
		             {
			             m_fcl.pose( q );
			             return single( m_fcl.environmentDistance( INFINITE, ALPHA / ( 1 - ALPHA ) ) );
		             } },
		    { "leeway",
		        [this, range]( const double* q ) { return m_leeway.clearance( q, LW_CHECK_ENVIRONMENT, range ); } } };
	}

	std::vector<Contender> environmentMargin()
	{
		return { { "FCL", [this]( const double* q ) {
					m_fcl.pose( q );
					return single( m_fcl.environmentDistance( MARGIN ) < MARGIN );
				} },
			{ "leeway", [this]( const double* q ) { return m_leeway.violates( q, LW_CHECK_ENVIRONMENT, MARGIN ); } } };
	}

	std::vector<Contender> environmentCollision()
	{
		return { { "FCL", [this]( const double* q ) { m_fcl.pose( q ); return single( m_fcl.environmentCollides() ); } },
			{ "leeway", [this]( const double* q ) { return m_leeway.violates( q, LW_CHECK_ENVIRONMENT, 0 ); } } };
	}

	std::vector<Contender> selfExact()
	{
		return { { "FCL", [this]( const double* q ) { m_fcl.pose( q ); return single( m_fcl.selfDistance( INFINITE ) ); } },
			{ "leeway", [this]( const double* q ) { return m_leeway.clearance( q, LW_CHECK_SELF, lw_range_exact() ); } } };
	}

	std::vector<Contender> validity()
	{
		return { { "FCL", [this]( const double* q ) {
					m_fcl.pose( q );
					return single( m_fcl.environmentCollides() || m_fcl.selfCollides() );
				} },
			{ "leeway", [this]( const double* q ) { return m_leeway.violates( q, LW_CHECK_BOTH, 0 ); } } };
	}

	static void add( Json& rows, const Json& row )
	{
		if ( !row.is_null() )
		{
			rows.push_back( row );
		}
	}

	void check( const char* query, const ConfigurationSet& set, const Agreement& agreement, Json& rows )
	{
		rows.back()["largest_difference_m"] = agreement.largest_difference;
		rows.back()["disagreements"] = agreement.disagreements;
		m_largest = std::max( m_largest, agreement.largest_difference );
		if ( agreement.disagreements > 0 )
		{
			std::printf( "DISAGREEMENT: %s, set %s: %zu states, largest difference %g m\n", query, set.name.c_str(),
				agreement.disagreements, agreement.largest_difference );
			m_disagreed = true;
		}
	}

	const Settings& m_settings;
	FclPeer m_fcl;
	Leeway m_leeway;
	Hash m_hash;
	double m_largest = 0;
	bool m_disagreed = false;
};

const std::pair<lw_sphere_fit, const char*> FITS[] = {
	{ LW_FIT_GREEDY, "GREEDY" }, { LW_FIT_COMPACT, "COMPACT" }, { LW_FIT_MINIMAL, "MINIMAL" } };

/// Races of leeway against itself over all sets; the first contender is the reference. @return false if an answer changed
bool raceVariants( const char* title, const std::vector<Contender>& contenders, const std::vector<ConfigurationSet>& sets,
	int repetitions, Json& rows )
{
	std::printf( "\nleeway, environment exact, %s: microseconds per state\n", title );
	std::printf( "%-22s %-10s | %8s %8s %8s | %s\n", "variant", "set", "median", "mean", "p95", "mean / default" );
	bool same = true;
	for ( const ConfigurationSet& set : sets )
	{
		const std::vector<Run> runs = race( contenders, set, repetitions );
		const double reference = summarise( runs[0].microseconds ).mean;
		for ( std::size_t c = 0; c < contenders.size(); ++c )
		{
			const Summary s = summarise( runs[c].microseconds );
			const Agreement agreement = compareDistances( runs[0], runs[c] );
			std::printf( "%-22s %-10s | %8.1f %8.1f %8.1f | %6.2f%s\n", contenders[c].name.c_str(), set.name.c_str(),
			    s.median, s.mean, s.p95, s.mean / reference, agreement.disagreements > 0 ? "  ANSWERS DIFFER" : "" );
			same = same && agreement.disagreements == 0;
			rows.push_back( Json{ { "variant", contenders[c].name }, { "set", set.name }, { "leeway", toJson( s ) },
				{ "mean_over_default", s.mean / reference },
				{ "largest_difference_m", agreement.largest_difference } } );
		}
		std::fflush( stdout );
	}
	return same;
}

/// leeway against itself: exact environment clearance with one thing changed at a time. Fits race by themselves, because
/// each has trees of its own, which the caches must hold in turn. @return false if an answer changed
bool compareVariants( const Settings& settings, const leeway::io::Problem& problem,
	const std::vector<ConfigurationSet>& sets, Json& rows )
{
	std::vector<std::unique_ptr<leeway::io::Problem>> problems;
	std::vector<std::unique_ptr<Leeway>> engines;
	const auto enter = [&engines]( const std::string& name, const leeway::io::Problem& of, const lw_query_def& def ) {
		engines.push_back( std::make_unique<Leeway>( of, def ) );
		Leeway* engine = engines.back().get();
		return Contender{ name,
			[engine]( const double* q ) { return engine->clearance( q, LW_CHECK_ENVIRONMENT, lw_range_exact() ); } };
	};
	std::vector<Contender> switches = { enter( "default", problem, lw_query_def_default() ) };
	lw_query_def def = lw_query_def_default();
	def.transform_caching = !def.transform_caching;
	switches.push_back( enter( def.transform_caching ? "transform caching" : "no transform caching", problem, def ) );
	def = lw_query_def_default();
	def.warm_start = !def.warm_start;
	switches.push_back( enter( def.warm_start ? "warm start" : "no warm start", problem, def ) );
	static const char* const levels[] = { "", "level scalar", "level SSE2", "level AVX2", "level NEON" };
	for ( int level = LW_SIMD_SCALAR; level <= lw_simd_available(); ++level )
	{
		if ( !lw_simd_supported( static_cast<lw_simd>( level ) ) )
		{
			continue;
		}
		def = lw_query_def_default();
		def.simd = static_cast<lw_simd>( level );
		switches.push_back( enter( levels[level], problem, def ) );
	}

	const lw_sphere_fit default_fit = lw_tree_def_default().fit;
	std::vector<Contender> fits = { enter( "default fit", problem, lw_query_def_default() ) };
	for ( const auto& [fit, name] : FITS )
	{
		if ( fit != default_fit )
		{
			lw_tree_def tree = lw_tree_def_default();
			tree.fit = fit;
			problems.push_back( std::make_unique<leeway::io::Problem>( loadKitchen( settings.data, tree ) ) );
			fits.push_back( enter( std::string( "fit " ) + name, *problems.back(), lw_query_def_default() ) );
		}
		else
		{
			fits[0].name = std::string( "fit " ) + name;
		}
	}
	const bool same = raceVariants( "one thing changed at a time", switches, sets, settings.repetitions, rows );
	return raceVariants( "fits", fits, sets, settings.repetitions, rows ) && same;
}

void printTrees( const leeway::io::Problem& problem, const FclPeer& fcl, Json& rows )
{
	std::printf( "\ntrees of robot and scene: distinct meshes, fastest of three builds\n" );
	std::printf( "%-16s %6s %9s | %9s %14s\n", "trees", "meshes", "triangles", "seconds", "bytes/triangle" );
	TreeCost cost;
	for ( const auto& [fit, name] : FITS )
	{
		lw_tree_def tree = lw_tree_def_default();
		const bool is_default = tree.fit == fit;
		tree.fit = fit;
		cost = measureTrees( distinctMeshes( problem ), tree );
		std::printf( "leeway %-9s %6zu %9zu | %9.3f %14.1f%s\n", name, cost.meshes, cost.triangles, cost.seconds,
			cost.bytes_per_triangle, is_default ? "  (default)" : "" );
		rows.push_back( Json{ { "trees", std::string( "leeway " ) + name }, { "default", is_default },
		    { "meshes", cost.meshes }, { "triangles", cost.triangles }, { "seconds", cost.seconds },
		    { "bytes_per_triangle", cost.bytes_per_triangle } } );
	}
	const double bytes = static_cast<double>( fcl.engine().bytes() ) / static_cast<double>( cost.triangles );
	std::printf(
	    "%-16s %6zu %9zu | %9.3f %14.1f\n", "FCL OBBRSS", cost.meshes, cost.triangles, fcl.engine().buildSeconds(), bytes );
	rows.push_back( Json{ { "trees", "FCL OBBRSS" }, { "meshes", cost.meshes }, { "triangles", cost.triangles },
		{ "seconds", fcl.engine().buildSeconds() }, { "bytes_per_triangle", bytes } } );
}

int run( const Settings& settings )
{
	Json json = { { "benchmark", "bench_clearance" } };
	json.update( provenance() );
	json["seed"] = settings.seed;
	json["repetitions"] = settings.repetitions;
	json["states_per_set"] = settings.states;
	json["data_hash"] = hashFiles( kitchenFiles( settings.data ) );

	const leeway::io::Problem problem = loadKitchen( settings.data, lw_tree_def_default() );
	const std::vector<ConfigurationSet> sets = makeConfigurations( problem, settings.data, settings.seed, settings.states );
	std::printf( "%s, %s, leeway at %s, FCL %s; commit %s%s\n", json["processor"].get<std::string>().c_str(),
		json["compiler"].get<std::string>().c_str(), json["simd"].get<std::string>().c_str(),
		json["fcl_version"].get<std::string>().c_str(), json["commit"].get<std::string>().c_str(),
		json["dirty"].get<bool>() ? " (changed)" : "" );
	std::printf( "seed %llu, %d passes, median per state\n", static_cast<unsigned long long>( settings.seed ),
		settings.repetitions );
	for ( const ConfigurationSet& set : sets )
	{
		std::printf( "set %-10s %4zu states: %s\n", set.name.c_str(), set.states.size(), set.description.c_str() );
		json["sets"].push_back(
			Json{ { "name", set.name }, { "states", set.states.size() }, { "description", set.description } } );
	}

	Comparison comparison( settings, problem );
	Comparison::printHeader();
	json["comparison"] = Json::array();
	for ( const ConfigurationSet& set : sets )
	{
		comparison.compare( set, json["comparison"] );
	}
	json["variants"] = Json::array();
	const bool same = compareVariants( settings, problem, sets, json["variants"] );
	json["trees"] = Json::array();
	printTrees( problem, comparison.fcl(), json["trees"] );

	json["largest_difference_m"] = comparison.largestDifference();
	json["answer_hash"] = comparison.answerHash();
	const bool agreed = !comparison.disagreed() && same;
	json["agreed"] = agreed;
	std::printf( "\nlargest difference of distances %.3g m, answer hash %s: %s\n", comparison.largestDifference(),
		comparison.answerHash().c_str(), agreed ? "all answers agree" : "ANSWERS DIFFER" );
	writeResult( settings.json, json );
	return agreed ? 0 : 1;
}

} // namespace

int main( int argc, char** argv )
{
	Settings settings;
	bool quick = false;
	BenchProgram program( "bench_clearance", "Clearance queries of ARMAR-III in a kitchen: leeway against FCL." );
	program.option( "--data", settings.data, "folder with armar3 and kit_kitchen" );
	program.option( "--states", settings.states, "states per set, at most", { 1, 100000 } );
	program.option( "--repetitions", settings.repetitions, "passes over each set", { 1, 1000 } );
	program.option( "--seed", settings.seed, "of the random states" );
	program.option( "--json", settings.json, "write the figures and where they come from to this file" );
	program.flag( "--quick", quick, "40 states per set, one pass: for agreement, not for figures" );
	return program.run( argc, argv,
		[&]
		{
			if ( quick )
			{
				settings.states = std::min<std::size_t>( settings.states, 40 );
				settings.repetitions = 1;
			}
			requireData( settings.data, "kit_kitchen" );
			return run( settings );
		} );
}
