// SPDX-License-Identifier: BSD-3-Clause
// The price and the gain of each setting of a query about a state: parts of the query left out, SIMD levels, fits of
// the spheres, coarser shapes, alpha, max_d, min_d. Exit status 1 if an answer is beyond its promise.
//
// ARMAR-III's base, torso and both arms in the cluttered KIT kitchen. The settings of a family take turns; its first one is the
// usual setting, whose exact answers are the truth for the others. Transform caching, range-of-motion hulls, pair tables, the
// fits and the range (min_d, max_d, alpha) are those of Steinbach, Kuffner, Asfour, Dillmann 2006.
#include "programs/commands.hpp"
#include "support/configurations.hpp"
#include "support/provenance.hpp"
#include "support/race.hpp"

#include <cmath>
#include <cstdio>
#include <functional>

namespace
{

namespace io = leeway::io;

constexpr double INFINITE = std::numeric_limits<double>::infinity();
constexpr double AGREEMENT = 1e-9; ///< metres, granted to shapes with other trees, whose vertices have other origins

struct Settings
{
	std::string data = LEEWAY_DATA_DIR, only;
	std::size_t states = 200;
	int repetitions = 5;
	double budget = 5;
	std::uint64_t seed = 20260101;
	bool quick = false;
};

/// One way to ask.
struct Setting
{
	std::string name;
	const io::Problem* problem;
	lw_query_def query = lw_query_def_default();
	lw_range range = { 0, INFINITE, 0 };
	double detail = 0; ///< metres that each shape may be larger
};

/// Settings that are compared with the first one.
struct Family
{
	std::string name;
	std::vector<Setting> settings;
	bool with_checks = false; ///< also asked whether a state is free, and whether by 10 mm
};

struct Question
{
	const char* name;
	lw_check_flags flags;
	double margin; ///< is it free by this? NaN: how far is it?
	bool isCheck() const { return !std::isnan( margin ); }
};

const Question QUESTIONS[] = {
    { "environment", LW_CHECK_ENVIRONMENT, NAN },
    { "self", LW_CHECK_SELF, NAN },
    { "environment, > 10 mm?", LW_CHECK_ENVIRONMENT, 0.01 },
    { "both, free?", LW_CHECK_BOTH, 0 },
};

/// One way to ask, with its own query.
Contender contenderOf( const Setting& setting, const Question& question )
{
	const auto query = std::make_shared<leeway::Query>( leeway::makeQuery( setting.problem->checker.get(), setting.query ) );
	return { setting.name, [&setting, &question, query]( const double* q )
	    {
		    const lw_checker* checker = setting.problem->checker.get();
		    if ( question.isCheck() )
		    {
			    bool free = false;
			    leeway::require(
			        lw_checker_is_free( checker, query->get(), q, question.flags, question.margin, &free, nullptr ),
			        "a state" );
			    return Answer{ free ? 1.0 : 0.0, free ? 1.0 : 0.0 };
		    }
		    lw_state_result result;
		    leeway::require(
		        lw_checker_state( checker, query->get(), q, question.flags, &setting.range, false, &result ), "a state" );
		    const lw_clearance& c = question.flags == LW_CHECK_SELF ? result.self : result.environment;
		    return Answer{ c.lower, std::min( c.upper, setting.range.max_d ) };
	    } };
}

/// How far an answer is beyond the promise of its setting, metres. @param truth by the usual setting, exactly
double excess( const Setting& setting, const Question& question, const Answer& got, const Answer& truth )
{
	if ( question.isCheck() )
	{
		// shapes that are larger may only turn down more
		return got.upper == truth.upper || ( setting.detail > 0 && got.upper == 0 ) ? 0 : INFINITE;
	}
	const double d = truth.upper;
	const lw_range& range = setting.range;
	if ( d <= range.min_d )
	{
		return std::max( 0.0, got.upper - range.min_d );
	}
	const double nearest = std::min( d, range.max_d ) - 2 * setting.detail; // both shapes may be larger
	return std::max( { 0.0, got.lower - d, nearest - got.upper, got.upper - got.lower - range.alpha * got.upper } );
}

class States
{
public:
	States( const Settings& settings, Result& result ) : m_settings( settings ), m_result( result )
	{
		const lw_tree_def usual = lw_tree_def_default();
		const auto load = [&]( const lw_tree_def& tree, double detail, double budget )
		{
			m_problems.push_back( std::make_unique<io::Problem>( loadKitchen( settings.data, tree, detail, budget ) ) );
			return m_problems.back().get();
		};
		const io::Problem* whole = load( usual, 0, settings.budget );
		m_result["self_pairs"] = lw_checker_get_info( whole->checker.get() ).self_pairs;
		m_result["data_hash"] = hashFiles( kitchenFiles( settings.data ) );
		m_sets = makeConfigurations( *whole, settings.data, settings.seed, settings.states );
		addParts( whole );
		addRanges( whole );
		addLevels( whole );
		if ( wanted( "fits" ) || wanted( "detail" ) )
		{
			const io::Problem* bare = load( usual, 0, 0 ); // without tables, as those below
			addFits( bare, load );
			addDetail( bare, load );
		}
	}

	int run()
	{
		std::printf(
		    "microseconds a state; beyond: answers beyond their promise; loose: mean share by which the upper end is too "
		    "far or too near\n" );
		std::printf( "%-8s %-22s %-22s %-10s %5s | %8s %8s %8s | %7s | %6s %6s\n", "family", "setting", "question", "states",
		    "n", "median", "mean", "p95", "/ usual", "beyond", "loose" );
		for ( const Family& family : m_families )
		{
			for ( const Question& question : QUESTIONS )
			{
				for ( const ConfigurationSet& set : m_sets )
				{
					if ( !question.isCheck() || family.with_checks )
					{
						measure( family, question, set );
					}
				}
			}
		}
		std::printf( "%zu of %zu answers are beyond their promise\n", m_beyond, m_answers );
		m_result["beyond"] = m_beyond;
		return m_beyond > 0 || m_answers == 0 ? 1 : 0;
	}

private:
	bool wanted( const std::string& family ) const { return family.find( m_settings.only ) != std::string::npos; }

	/// @param settings the first one is the usual
	void add( const std::string& name, std::vector<Setting> settings, bool with_checks )
	{
		if ( wanted( name ) )
		{
			m_families.push_back( { name, std::move( settings ), with_checks } );
		}
	}

	void addParts( const io::Problem* problem )
	{
		const auto without = [&]( const char* name, const std::function<void( lw_query_def& )>& leave_out )
		{
			Setting setting{ name, problem };
			leave_out( setting.query );
			return setting;
		};
		add( "parts",
		    { { "all parts", problem },
		        without( "no transform caching", []( lw_query_def& d ) { d.transform_caching = false; } ),
		        without( "no motion hulls", []( lw_query_def& d ) { d.motion_hulls = false; } ),
		        without( "no pair tables", []( lw_query_def& d ) { d.pair_tables = false; } ),
		        without( "no hulls, no tables", []( lw_query_def& d ) { d.motion_hulls = d.pair_tables = false; } ),
		        without( "no warm start", []( lw_query_def& d ) { d.warm_start = false; } ),
		        without( "no planes", []( lw_query_def& d ) { d.planes = false; } ),
		        without( "none of these", []( lw_query_def& d )
		            { d.transform_caching = d.motion_hulls = d.pair_tables = d.warm_start = d.planes = false; } ) },
		    true );
	}

	void addRanges( const io::Problem* problem )
	{
		const auto family = [&]( const char* knob, const std::vector<double>& values, double lw_range::*member )
		{
			std::vector<Setting> settings = { { "exact", problem } };
			for ( const double value : values )
			{
				char name[32];
				std::snprintf( name, sizeof name, "%s %g", knob, value );
				settings.push_back( { name, problem } );
				settings.back().range.*member = value;
			}
			add( knob, std::move( settings ), false );
		};
		family( "alpha", { 0.1, 0.3, 0.8 }, &lw_range::alpha );
		family( "max_d", { 0.2, 0.05, 0.01 }, &lw_range::max_d );
		family( "min_d", { 0.01, 0.1 }, &lw_range::min_d );
	}

	void addLevels( const io::Problem* problem )
	{
		static const char* const names[] = { "", "scalar", "SSE2", "AVX2", "NEON" };
		std::vector<Setting> settings = { { "usual", problem } };
		for ( int level = LW_SIMD_SCALAR; level <= lw_simd_available(); ++level )
		{
			if ( lw_simd_supported( static_cast<lw_simd>( level ) ) )
			{
				settings.push_back( { names[level], problem } );
				settings.back().query.simd = static_cast<lw_simd>( level );
			}
		}
		add( "levels", std::move( settings ), false );
	}

	template <typename Load> void addFits( const io::Problem* bare, const Load& load )
	{
		std::vector<Setting> settings = { { "usual", bare } };
		for ( const auto& [fit, name] : { std::pair( LW_FIT_GREEDY, "GREEDY" ), std::pair( LW_FIT_COMPACT, "COMPACT" ),
		          std::pair( LW_FIT_MINIMAL, "MINIMAL" ) } )
		{
			lw_tree_def tree = lw_tree_def_default();
			tree.fit = fit;
			settings.push_back( { name, wanted( "fits" ) ? load( tree, 0, 0 ) : bare } );
		}
		add( "fits", std::move( settings ), false );
	}

	template <typename Load> void addDetail( const io::Problem* bare, const Load& load )
	{
		std::vector<Setting> settings = { { "all triangles", bare } };
		for ( const double detail : { 0.0005, 0.002, 0.005 } )
		{
			char name[32];
			std::snprintf( name, sizeof name, "%g mm", 1000 * detail );
			settings.push_back( { name, wanted( "detail" ) ? load( lw_tree_def_default(), detail, 0 ) : bare } );
			settings.back().detail = detail;
		}
		add( "detail", std::move( settings ), true );
	}

	void measure( const Family& family, const Question& question, const ConfigurationSet& set )
	{
		std::vector<Contender> contenders;
		for ( const Setting& setting : family.settings )
		{
			contenders.push_back( contenderOf( setting, question ) );
		}
		const std::vector<Run> runs = race( contenders, set, m_settings.repetitions );
		const double usual = summarise( runs[0] ).mean;
		for ( std::size_t c = 0; c < runs.size(); ++c )
		{
			report( family, family.settings[c], question, set, runs[c], runs[0], usual );
		}
	}

	void report( const Family& family, const Setting& setting, const Question& question, const ConfigurationSet& set,
	    const Run& run, const Run& truth, double usual )
	{
		std::size_t beyond = 0;
		double loose = 0, largest = 0;
		Hash hash;
		for ( std::size_t i = 0; i < run.answers.size(); ++i )
		{
			const double by = excess( setting, question, run.answers[i], truth.answers[i] );
			beyond += !( by <= AGREEMENT );
			largest = std::max( largest, by );
			const double d = std::min( truth.answers[i].upper, setting.range.max_d );
			loose += d > 0 ? std::abs( run.answers[i].upper - d ) / d / static_cast<double>( run.answers.size() ) : 0;
			hash.add( std::llround( 1e9 * std::min( run.answers[i].upper, 1e3 ) ) );
		}
		m_beyond += beyond;
		m_answers += run.answers.size();
		const Summary s = summarise( run );
		std::printf( "%-8s %-22s %-22s %-10s %5zu | %8.1f %8.1f %8.1f | %7.2f | %6zu %6.3f\n", family.name.c_str(),
		    setting.name.c_str(), question.name, set.name.c_str(), run.answers.size(), s.median, s.mean, s.p95,
		    s.mean / usual, beyond, loose );
		std::fflush( stdout );
		Json row = { { "family", family.name }, { "setting", setting.name }, { "question", question.name },
		    { "set", set.name }, { "states", run.answers.size() } };
		row.update( toJson( s ) );
		row["over_usual"] = rounded( s.mean / usual );
		row["loose"] = rounded( loose );
		row["beyond"] = beyond;
		row["largest_excess_m"] = std::isfinite( largest ) ? rounded( largest ) : -1;
		row["answers_hash"] = hash.text();
		m_result.add( std::move( row ) );
	}

	const Settings& m_settings;
	Result& m_result;
	std::vector<std::unique_ptr<io::Problem>> m_problems;
	std::vector<ConfigurationSet> m_sets;
	std::vector<Family> m_families;
	std::size_t m_beyond = 0, m_answers = 0;
};

} // namespace

void addStates( Bench& bench )
{
	const auto s = std::make_shared<Settings>();
	Command& command = bench.command( "states", "what each setting of a query about a state is worth, and gives up" );
	command.option( "--data", s->data, "folder with armar3 and kit_kitchen" );
	command.option( "--only", s->only, "family: parts, alpha, max_d, min_d, levels, fits or detail" );
	command.option( "--states", s->states, "per set, at most", { 1, 100000 } );
	command.option( "--repetitions", s->repetitions, "passes over each set", { 1, 1000 } );
	command.option( "--budget", s->budget, "seconds for proofs of pairs", { 0 } );
	command.option( "--seed", s->seed, "of the states" );
	command.flag( "--quick", s->quick, "40 states per set, 3 passes, a budget of 1 s" );
	command.work(
	    [s]( Result& result )
	    {
		    if ( s->quick )
		    {
			    s->states = std::min<std::size_t>( s->states, 40 );
			    s->repetitions = std::min( s->repetitions, 3 );
			    s->budget = std::min( s->budget, 1.0 );
		    }
		    requireData( s->data, "kit_kitchen" );
		    return States( *s, result ).run();
	    } );
}
