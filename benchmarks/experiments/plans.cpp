// SPDX-License-Identifier: BSD-3-Clause
// The kitchen reaches end to end: see plans.hpp.
//
// One OMPL Benchmark for each reach. Its "planners" are RRT-Connect under different names, and before each run the judge of
// states and motions is changed to the setting of that name, so that Planner Arena compares settings as it compares
// planners. The auditor of tests/support checks every path densely, after its run and outside of its time.
#include "experiments/plans.hpp"

#include "edge_auditor.hpp"
#include "support/edge_worlds.hpp"

#include "leeway/ompl/benchmark.hpp"
#include "leeway/ompl/validity.hpp"
#include "support/temporary_folder.hpp"

#include <CLI/CLI.hpp>
#include <ompl/base/DiscreteMotionValidator.h>
#include <ompl/geometric/SimpleSetup.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/util/Console.h>
#include <ompl/util/RandomNumbers.h>

#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <mutex>

#ifdef LEEWAY_KITCHEN_MODEL
#include "writer.hpp"
#endif

namespace ob = ::ompl::base;
namespace og = ::ompl::geometric;
namespace ot = ::ompl::tools;

namespace
{

/// How motions are judged. Start and goal of the reaches have 5 mm of clearance: no margin may ask for more.
struct Setting
{
	const char* name;
	const char* planner;       ///< the same for OMPL's log, whose readers make a table of it
	double min_d, slack, step; ///< metres; step 0 = certified
	bool discrete;             ///< OMPL's own validator at 1 % of the space, over leeway's states
	bool quick;                ///< takes part in short runs
	bool proof() const { return step == 0 && !discrete; }
	/// Steps with a margin of at least their length miss nothing (edges.md).
	bool safe() const { return proof() || ( step > 0 && min_d >= step ); }
};

const Setting SETTINGS[] = {
    { "certified, slack 1 mm", "certified_slack_1mm", 0, 0.001, 0, false, true },
    { "certified, slack 0.1 mm", "certified_slack_100um", 0, 0.0001, 0, false, false },
    { "certified, slack 4 mm", "certified_slack_4mm", 0, 0.004, 0, false, false },
    { "certified, margin 4 mm", "certified_margin_4mm", 0.004, 0.0005, 0, false, true },
    { "steps 4 mm, margin 4 mm", "steps_4mm_margin_4mm", 0.004, 0.001, 0.004, false, true },
    { "steps 5 mm", "steps_5mm", 0, 0.001, 0.005, false, false },
    { "steps 20 mm", "steps_20mm", 0, 0.001, 0.02, false, true },
    { "steps 100 mm", "steps_100mm", 0, 0.001, 0.1, false, true },
    { "OMPL, 1 % of the space", "ompl_1percent", 0, 0.001, 0, true, true },
};

/// Hands on to the judge of the setting that is on. One thread at a time.
class Switch
{
public:
	Switch( const ob::SpaceInformationPtr& si, const leeway::Checker& checker )
	{
		for ( const Setting& setting : SETTINGS )
		{
			leeway::ompl::Options options;
			options.min_d = setting.min_d;
			options.slack = setting.slack;
			options.method = setting.step > 0 ? LW_EDGE_STEPS : LW_EDGE_CERTIFIED;
			options.step = setting.step > 0 ? setting.step : options.step;
			Judge judge;
			judge.engine = std::make_shared<leeway::ompl::Engine>( si->getStateSpace(), checker, options );
			judge.states = std::make_shared<leeway::ompl::StateValidityChecker>( si, judge.engine );
			judge.motions = setting.discrete ? ob::MotionValidatorPtr( std::make_shared<ob::DiscreteMotionValidator>( si ) )
			                                 : ob::MotionValidatorPtr(
			                                       std::make_shared<leeway::ompl::MotionValidator>( si, judge.engine ) );
			m_judges.emplace( setting.planner, judge );
		}
		select( SETTINGS[0].planner );
	}

	struct Judge
	{
		std::shared_ptr<leeway::ompl::Engine> engine;
		ob::StateValidityCheckerPtr states;
		ob::MotionValidatorPtr motions;
	};

	void select( const std::string& name ) { m_now = &m_judges.at( name ); }
	const Judge& now() const { return *m_now; }

private:
	std::map<std::string, Judge> m_judges;
	const Judge* m_now = nullptr;
};

class SwitchedStates : public ob::StateValidityChecker
{
public:
	SwitchedStates( const ob::SpaceInformationPtr& si, std::shared_ptr<const Switch> on )
	    : ob::StateValidityChecker( si ), m_on( std::move( on ) )
	{
		specs_.clearanceComputationType = ob::StateValidityCheckerSpecs::BOUNDED_APPROXIMATE;
	}
	bool isValid( const ob::State* state ) const override { return m_on->now().states->isValid( state ); }
	double clearance( const ob::State* state ) const override { return m_on->now().states->clearance( state ); }

private:
	std::shared_ptr<const Switch> m_on;
};

class SwitchedMotions : public ob::MotionValidator
{
public:
	SwitchedMotions( const ob::SpaceInformationPtr& si, std::shared_ptr<const Switch> on )
	    : ob::MotionValidator( si ), m_on( std::move( on ) )
	{
	}
	bool checkMotion( const ob::State* a, const ob::State* b ) const override
	{
		return m_on->now().motions->checkMotion( a, b );
	}
	bool checkMotion( const ob::State* a, const ob::State* b, std::pair<ob::State*, double>& last ) const override
	{
		return m_on->now().motions->checkMotion( a, b, last );
	}

private:
	std::shared_ptr<const Switch> m_on;
};

/// Results of all runs of one setting.
struct Tally
{
	std::size_t runs = 0, solved = 0, in_contact = 0;
	std::vector<double> plan_ms, simplify_ms, length, clearance_mm;
	Promise promise{ 0 }; ///< of safe settings: 1 for a path that is not as promised, else 0
};

/// The auditor's findings on a path.
struct PathLook
{
	bool below = false;      ///< some clearance is not above the margin
	double least = INFINITY; ///< metres; 0 in contact
};

class Reach
{
public:
	/// @param name of the reach, one word
	Reach( const EdgeWorldEntry& entry, std::string name, std::string inject )
	    : m_world( entry.world ), m_name( std::move( name ) ), m_inject( std::move( inject ) ),
	      m_setup( leeway::ompl::makeStateSpace( entry.world.with_tables ) ),
	      m_auditor( m_world.robot.get(), m_world.scene.get(), m_world.variables, m_world.reference.data(), m_world.allowed )
	{
		const ob::SpaceInformationPtr& si = m_setup.getSpaceInformation();
		m_on = std::make_shared<Switch>( si, entry.world.with_tables );
		m_setup.setStateValidityChecker( std::make_shared<SwitchedStates>( si, m_on ) );
		si->setMotionValidator( std::make_shared<SwitchedMotions>( si, m_on ) );
		ob::ScopedState<> start( m_setup.getStateSpace() ), goal( m_setup.getStateSpace() );
		adapter().fromVector( entry.start.data(), start.get() );
		adapter().fromVector( entry.goal.data(), goal.get() );
		m_setup.setStartAndGoalStates( start, goal );
		m_setup.setup();
	}

	/// @param log empty: none is written
	void run( const std::vector<const Setting*>& settings, std::size_t runs, double seconds, const std::string& log,
	    std::map<std::string, Tally>& tallies )
	{
		ot::Benchmark benchmark( m_setup, "leeway_" + m_name );
		for ( const Setting* setting : settings )
		{
			auto planner = std::make_shared<og::RRTConnect>( m_setup.getSpaceInformation() );
			planner->setName( setting->planner );
			benchmark.addPlanner( planner );
		}
		leeway::ompl::Counters before;
		benchmark.setPreRunEvent(
		    [&]( const ob::PlannerPtr& planner )
		    {
			    m_on->select( planner->getName() );
			    before = m_on->now().engine->counters();
		    } );
		benchmark.setPostRunEvent(
		    [&]( const ob::PlannerPtr& planner, ot::Benchmark::RunProperties& run )
		    {
			    const leeway::ompl::Counters counters = difference( m_on->now().engine->counters(), before );
			    for ( const auto& property : leeway::ompl::runProperties( counters ) )
			    {
				    run[property.first] = property.second;
			    }
			    finish( planner->getName(), run, tallies[planner->getName()] );
		    } );
		const unsigned memory = 4096; // megabytes, OMPL's own default
		benchmark.benchmark( { seconds, double( memory ), static_cast<unsigned>( runs ), 0.05, false, false, true } );
		if ( !log.empty() && !benchmark.saveResultsToFile( log.c_str() ) )
		{
			throw std::runtime_error( log + ": cannot be written" );
		}
	}

private:
	const leeway::ompl::StateAdapter& adapter() const { return m_on->now().engine->adapter(); }

	// The whole path by the auditor, motion by motion.
	PathLook look( const og::PathGeometric& path, double min_d )
	{
		PathLook all;
		std::vector<double> from( adapter().size() ), to( adapter().size() );
		for ( std::size_t i = 0; i + 1 < path.getStateCount() && !( all.least <= 0 ); ++i )
		{
			adapter().toVector( path.getState( static_cast<unsigned>( i ) ), from.data() );
			adapter().toVector( path.getState( static_cast<unsigned>( i + 1 ) ), to.data() );
			const std::vector<double> a = m_world.full( from ), b = m_world.full( to );
			EdgeAuditor::Look one = m_auditor.look( a.data(), b.data(), min_d );
			all.below = all.below || one.contact;
			if ( one.contact && min_d > 0 )
			{
				one = m_auditor.look( a.data(), b.data() ); // the first did not go on
			}
			all.least = std::min( all.least, one.contact ? 0 : one.least );
		}
		return all;
	}

	static double number( const ot::Benchmark::RunProperties& run, const char* key )
	{
		const auto found = run.find( key );
		return found == run.end() ? 0 : std::stod( found->second );
	}

	void finish( const std::string& name, ot::Benchmark::RunProperties& run, Tally& tally )
	{
		++tally.runs;
		const Setting& setting = *std::find_if(
		    std::begin( SETTINGS ), std::end( SETTINGS ), [&]( const Setting& s ) { return name == s.planner; } );
		run["leeway min d REAL"] = std::to_string( setting.min_d );
		run["leeway slack REAL"] = std::to_string( setting.slack );
		run["leeway step REAL"] = std::to_string( setting.step );
		const auto definition = m_setup.getProblemDefinition();
		if ( !definition->hasExactSolution() )
		{
			return;
		}
		++tally.solved;
		// Between two steps clearance may be anything up to their length less: the promise is then no contact
		const double promised = setting.proof() ? setting.min_d : 0;
		PathLook seen = look( *definition->getSolutionPath()->as<og::PathGeometric>(), promised );
		seen.below = seen.below || ( m_inject == "certified" && setting.proof() );
		tally.in_contact += seen.least <= 0;
		tally.plan_ms.push_back( 1e3 * number( run, "time REAL" ) );
		tally.simplify_ms.push_back( 1e3 * number( run, "simplification time REAL" ) );
		tally.length.push_back( number( run, "simplified solution length REAL" ) );
		tally.clearance_mm.push_back( 1e3 * seen.least );
		if ( setting.safe() )
		{
			tally.promise.observe( seen.below ? 1 : 0, 0,
			    m_world.name + ", " + setting.name + text( ": clearance %.9g m, %g m promised", seen.least, promised ) );
		}
		run["audited clearance REAL"] = std::to_string( seen.least );
		run["audited free BOOLEAN"] = seen.least > 0 ? "1" : "0";
	}

	const EdgeWorld& m_world;
	const std::string m_name, m_inject;
	og::SimpleSetup m_setup;
	std::shared_ptr<Switch> m_on;
	EdgeAuditor m_auditor;
};

double share( std::size_t part, std::size_t whole )
{
	return whole > 0 ? 100.0 * static_cast<double>( part ) / static_cast<double>( whole ) : 0;
}

class Plans : public Experiment
{
public:
	explicit Plans( PlansSettings plans ) : m_plans( std::move( plans ) ) {}

	std::string name() const override { return "plans"; }
	std::string title() const override { return "Planning: the kitchen reaches end to end, by how motions are judged"; }

	double expectedSeconds( const ExperimentSettings& settings ) const override
	{
		return settings.data.empty() || settings.smoke ? 5 : settings.quick ? 15 : 500;
	}

	void addOptions( CLI::App& app ) override
	{
		app.add_option( "--runs", m_plans.runs, "of each setting on each reach (default 5, --quick 2)" );
		app.add_option( "--seconds", m_plans.seconds, "for planning, each run (default 10, --quick 3)" );
		app.add_option( "--only", m_plans.only, "reaches with this in their names, such as /05" );
		app.add_option( "--inject", m_plans.inject, "call paths of certified motions colliding, to see that the run fails" )
		    ->check( CLI::IsMember( { "certified" } ) );
	}

	Outcome run( const ExperimentSettings& settings, Progress& progress ) override
	{
		::ompl::msg::setLogLevel( ::ompl::msg::LOG_NONE );
		static std::once_flag seeded; // OMPL takes a seed only before its first random number
		std::call_once(
		    seeded, [&] { ::ompl::RNG::setSeed( static_cast<std::uint_fast32_t>( settings.seed % 0x7fffffff + 1 ) ); } );
		progress.at( 0, "robots and kitchens" );
		lw_reach_def reach = lw_reach_def_default();
		reach.seconds = settings.quick || settings.smoke ? std::min( settings.budget, 0.2 ) : settings.budget;
		reach.hulls_only = settings.quick || settings.smoke;
		reach.hull_error = settings.smoke ? 0.1 : reach.hull_error;
		const TemporaryFolder folder;
		EdgeWorlds worlds( settings.data, reach );
		const std::vector<std::size_t> reaches = listReaches( settings, folder.path(), worlds );
		std::vector<const Setting*> chosen;
		for ( const Setting& setting : SETTINGS )
		{
			if ( setting.quick || !( settings.quick || settings.smoke ) )
			{
				chosen.push_back( &setting );
			}
		}
		const std::size_t runs = m_plans.runs > 0 ? m_plans.runs : settings.pick( 5, 2, 1 );
		const double seconds = m_plans.seconds > 0 ? m_plans.seconds : settings.quick || settings.smoke ? 3 : 10;
		std::map<std::string, Tally> tallies;
		for ( std::size_t i = 0; i < reaches.size(); ++i )
		{
			const EdgeWorldEntry& entry = worlds.entry( reaches[i] );
			progress.at( static_cast<double>( i ) / static_cast<double>( reaches.size() ), entry.world.name );
			const std::string word = wordOf( entry.world.name );
			Reach( entry, word, m_plans.inject ).run( chosen, runs, seconds, logFile( settings, word ), tallies );
		}
		return outcome( settings, chosen, tallies, reaches.size(), runs, seconds );
	}

private:
	/// Of the data folder and of the generated kitchen.
	std::vector<std::size_t> listReaches(
	    const ExperimentSettings& settings, const std::string& folder, EdgeWorlds& worlds ) const
	{
		std::vector<std::size_t> chosen;
		if ( !settings.data.empty() )
		{
			worlds.addArmarProblems();
		}
		if ( settings.data.empty() || !settings.smoke )
		{
			addGeneratedKitchen( settings, folder, worlds );
		}
		std::size_t of_each = settings.pick( SIZE_MAX, 2, 1 ), taken = 0;
		std::string set;
		for ( std::size_t i = 0; i < worlds.size(); ++i )
		{
			const EdgeWorldEntry& entry = worlds.entry( i );
			taken = entry.world.set == set ? taken : 0;
			set = entry.world.set;
			if ( !entry.goal.empty() && taken < of_each && entry.world.name.find( m_plans.only ) != std::string::npos )
			{
				chosen.push_back( i );
				++taken;
			}
		}
		if ( chosen.empty() )
		{
			throw std::runtime_error( m_plans.only.empty()
			                              ? "plans: there is no data folder, and this build has no kitchen of its own"
			                              : "--only " + m_plans.only + ": no reach has that in its name" );
		}
		return chosen;
	}

	/// Reaches of the generated kitchen, where the program has its generator.
	static void addGeneratedKitchen( const ExperimentSettings& settings, const std::string& folder, EdgeWorlds& worlds )
	{
#ifdef LEEWAY_KITCHEN_MODEL
		const kitchen::Demo demo = kitchen::makeDemo();
		kitchen::writeDemo( demo, folder );
		const std::size_t count = std::min( demo.reaches.size(), settings.pick( SIZE_MAX, 2, 1 ) );
		for ( std::size_t i = 0; i < count; ++i )
		{
			const kitchen::Reach& reach = demo.reaches[i];
			worlds.add( { { "set", "kitchen" }, { "name", "kitchen/" + reach.name }, { "robot", folder + "/robot.urdf" },
			    { "srdf", folder + "/robot.srdf" }, { "scene", folder + "/scene.yaml" }, { "group", reach.group },
			    { "request",
				    folder + "/reach/" + reach.name + ".yaml" } } );
		}
#else
		(void)settings, (void)folder, (void)worlds;
#endif
	}

	/// The name of a reach in one word.
	static std::string wordOf( std::string name )
	{
		for ( char& c : name )
		{
			c = std::isalnum( static_cast<unsigned char>( c ) ) != 0 ? c : '_';
		}
		return name;
	}

	static std::string logFile( const ExperimentSettings& settings, const std::string& word )
	{
		if ( settings.out.empty() )
		{
			return "";
		}
		std::filesystem::create_directories( settings.out );
		return ( std::filesystem::path( settings.out ) / ( "plans-" + word + ".log" ) ).string();
	}

	static Outcome outcome( const ExperimentSettings& settings, const std::vector<const Setting*>& chosen,
	    const std::map<std::string, Tally>& tallies, std::size_t reaches, std::size_t runs, double seconds );

	PlansSettings m_plans;
};

void addTable( const std::vector<const Setting*>& chosen, const std::map<std::string, Tally>& tallies, Outcome& out )
{
	Table table{ "settings", "RRT-Connect by how motions are judged",
	    "Medians and quartiles over all solved runs. In contact: paths in which a dense look finds a collision. Clearance: "
	    "the least that it "
	    "found along the path.",
	    { { "setting", "", 0 }, { "proof", "", 0 }, { "runs", "", 0 }, { "solved", "%", 1 }, { "planning", "ms", -1 },
	        { "simplifying", "ms", -1 }, { "length", "joint space", -1 }, { "clearance", "mm", 1 },
	        { "in contact", "", -1 } },
	    {} };
	for ( const Setting* setting : chosen )
	{
		const Tally& t = tallies.at( setting->planner );
		table.rows.push_back( { std::string( setting->name ), std::string( setting->safe() ? "yes" : "no" ),
		    static_cast<double>( t.runs ), share( t.solved, t.runs ), measure( t.plan_ms ), measure( t.simplify_ms ),
		    measure( t.length ), measure( t.clearance_mm ), static_cast<double>( t.in_contact ) } );
	}
	out.tables.push_back( table );
}

void addPlots( const std::vector<const Setting*>& chosen, const std::map<std::string, Tally>& tallies, Outcome& out )
{
	Plot time{ "time", "Time to a path", "Median over all solved runs, with quartiles.", { "", "" }, { "time", "ms", true },
	    {}, {}, {} };
	Plot contact{ "contact", "Paths in contact", "Of all paths found, after simplification.", { "", "" },
	    { "paths in contact", "%" }, {}, {}, {} };
	contact.y.from = 0;
	Series plan{ "planning", {}, Mark::BARS, false }, simplify{ "simplifying", {}, Mark::BARS, false },
	    broken{ "in contact", {}, Mark::BARS, false };
	for ( std::size_t i = 0; i < chosen.size(); ++i )
	{
		const Tally& t = tallies.at( chosen[i]->planner );
		const auto x = static_cast<double>( i );
		const Measure p = measure( t.plan_ms ), s = measure( t.simplify_ms );
		plan.points.push_back( { x, p.median, p.lower, p.upper } );
		simplify.points.push_back( { x, s.median, s.lower, s.upper } );
		broken.points.push_back( { x, share( t.in_contact, t.solved ) } );
		time.categories.push_back( chosen[i]->name );
	}
	contact.categories = time.categories;
	time.series = { plan, simplify };
	contact.series = { broken };
	out.plots.push_back( time );
	out.plots.push_back( contact );
}

Outcome Plans::outcome( const ExperimentSettings& settings, const std::vector<const Setting*>& chosen,
    const std::map<std::string, Tally>& tallies, std::size_t reaches, std::size_t runs, double seconds )
{
	Outcome out;
	out.name = "plans";
	out.title = "Planning: the kitchen reaches end to end, by how motions are judged";
	out.about = text(
	    "%zu reaches of humanoids in kitchens, %zu runs of each setting, up to %g s each, RRT-Connect with OMPL's default "
	    "parameters and simplification. The validator, min_d, slack and step are turned; max_d and alpha belong to "
	    "clearances, which "
	    "RRT-Connect does not ask for. Every path is audited densely.",
	    reaches, runs, seconds );
	addTable( chosen, tallies, out );
	addPlots( chosen, tallies, out );
	std::vector<const Promise*> promises;
	std::size_t missed = 0, paths = 0;
	for ( const Setting* setting : chosen )
	{
		const Tally& t = tallies.at( setting->planner );
		if ( setting->safe() )
		{
			promises.push_back( &t.promise );
			continue;
		}
		missed += t.in_contact;
		paths += t.solved;
	}
	out.claims.push_back( claimOf(
	    "a path whose motions are proved keeps its margin all along; stepped with the step as margin, it is free of contact",
	    promises, text( "of the %zu paths of steps without a margin %zu are in contact", paths, missed ) ) );
	out.details = { { "reaches", reaches }, { "runs", runs }, { "seconds", seconds }, { "planner", "RRTConnect" },
	    { "logs", settings.out.empty() ? "none" : "plans-*.log, for ompl_benchmark_statistics.py and Planner Arena" } };
	return out;
}

} // namespace

std::unique_ptr<Experiment> makePlansExperiment( const PlansSettings& plans )
{
	return std::make_unique<Plans>( plans );
}

std::unique_ptr<Experiment> makePlansExperiment()
{
	return makePlansExperiment( PlansSettings() );
}
