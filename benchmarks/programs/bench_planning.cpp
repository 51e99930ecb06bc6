// SPDX-License-Identifier: BSD-3-Clause
// Whole planning problems: MotionBenchMaker's of Panda and Fetch, and ARMAR-III's reaches. Rows: leeway's own planner, and OMPL's
// RRT-Connect with motions proved by certificates, or sampled over leeway's states and over FCL's. Exit status 1 if a path of
// proved motions is refuted by a dense look.
//
// All rows plan in the same space, problem by problem in turn, several runs each with random numbers of their own. The time is
// the processor time of solve(), then that of a simplification: leeway's smoother, or OMPL's shortcuts.
// The auditor checks every path afterwards (tests/support/edge_auditor.hpp), outside of its time.
#include "support/bench_program.hpp"
#include "edge_auditor.hpp"
#include "peers/edge_judges.hpp"
#include "support/edge_worlds.hpp"
#include "support/provenance.hpp"
#include "support/race.hpp"

#include "leeway/ompl/validity.hpp"
#include "leeway/planners/ompl_planner.hpp"
#include "leeway/planners/smooth.hpp"

#include <ompl/base/DiscreteMotionValidator.h>
#include <ompl/geometric/PathSimplifier.h>
#include <ompl/geometric/SimpleSetup.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/util/Console.h>
#include <ompl/util/RandomNumbers.h>

#include <cstdio>
#include <map>

namespace ob = ::ompl::base;
namespace og = ::ompl::geometric;

namespace
{

enum class Judge
{
	NATIVE,    ///< leeway's planner
	CERTIFIED, ///< RRTConnect, OMPL's range unless --range is given
	SUITED,    ///< RRTConnect, the range that suits the robot
	STATES,   ///< OMPL's discrete validator over leeway's states
	FCL,      ///< the same over FCL's
	FCL_FINE, ///< and at 1/32 rad
	COUNT
};

constexpr std::size_t JUDGES = static_cast<std::size_t>( Judge::COUNT );
const char* const JUDGE_NAMES[JUDGES] = { "leeway", "RRTConnect", "range by robot", "own states 1 %", "FCL 1 %",
	"FCL 1/32 rad" };

struct Settings
{
	std::string data = LEEWAY_DATA_DIR, json, only;
	int problems = 5, runs = 3;
	double seconds = 5, budget = 1, range = 0;
	bool planners_only = false, native_only = false;
	std::uint64_t seed = 20260101;

	std::size_t rows() const { return native_only ? 1 : planners_only ? 3 : JUDGES; }
};

constexpr double FINE_STEP = 1.0 / 32; // radians: VAMP's resolution
constexpr double FRACTION = 0.01;      // of the space's extent: OMPL's default

class FclStates : public ob::StateValidityChecker
{
public:
	FclStates( const ob::SpaceInformationPtr& si, const leeway::ompl::StateAdapter& adapter, EdgeJudges& judges )
	    : ob::StateValidityChecker( si ), m_adapter( adapter ), m_judges( judges ), m_state( adapter.size() )
	{
	}
	bool isValid( const ob::State* state ) const override
	{
		m_adapter.toVector( state, m_state.data() );
		return si_->satisfiesBounds( state ) && !m_judges.fclCollides( m_state );
	}

private:
	const leeway::ompl::StateAdapter& m_adapter;
	EdgeJudges& m_judges;
	mutable std::vector<double> m_state;
};

/// Result of one run.
struct Planned
{
	bool solved = false, in_contact = false;
	double plan_us = 0, simplify_us = 0, first_length = 0, length = 0;
};

/// One way to judge one problem.
class Planning
{
public:
	Planning( const EdgeWorldEntry& entry, EdgeJudges& judges, Judge judge, double range )
	    : m_setup( leeway::ompl::makeStateSpace( entry.world.with_tables ) )
	{
		const ob::SpaceInformationPtr& si = m_setup.getSpaceInformation();
		m_engine = leeway::ompl::install( si, entry.world.with_tables );
		m_native = judge == Judge::NATIVE;
		if ( judge > Judge::SUITED )
		{
			si->setMotionValidator( std::make_shared<ob::DiscreteMotionValidator>( si ) );
			si->setStateValidityCheckingResolution(
			    judge == Judge::FCL_FINE ? FINE_STEP / m_setup.getStateSpace()->getMaximumExtent() : FRACTION );
		}
		if ( judge == Judge::FCL || judge == Judge::FCL_FINE )
		{
			m_setup.setStateValidityChecker( std::make_shared<FclStates>( si, m_engine->adapter(), judges ) );
		}
		ob::ScopedState<> start( m_setup.getStateSpace() ), goal( m_setup.getStateSpace() );
		m_engine->adapter().fromVector( entry.start.data(), start.get() );
		m_engine->adapter().fromVector( entry.goal.data(), goal.get() );
		si->getStateSpace()->enforceBounds( start.get() );
		si->getStateSpace()->enforceBounds( goal.get() );
		m_setup.setStartAndGoalStates( start, goal );
		ob::PlannerPtr planner = std::make_shared<og::RRTConnect>( si );
		if ( m_native )
		{
			planner = std::make_shared<leeway::planners::OmplPlanner>( si );
		}
		const double longest = judge == Judge::SUITED ? leeway::planners::geometricRange( *m_engine ) : range;
		if ( longest > 0 )
		{
			planner->params().setParam( "range", std::to_string( longest ) );
		}
		m_setup.setPlanner( planner );
		m_setup.setup();
		m_usable = si->isValid( start.get() ) && si->isValid( goal.get() );
	}

	bool usable() const { return m_usable; }

	Planned run( double seconds )
	{
		m_setup.clear();
		Planned out;
		double start = threadMicroseconds();
		// by the clock itself: with solve( seconds ) a thread would look at it, which may not get its turn
		const auto status = m_setup.getPlanner()->solve( ob::timedPlannerTerminationCondition( seconds ) );
		out.plan_us = threadMicroseconds() - start;
		out.solved = status == ob::PlannerStatus::EXACT_SOLUTION;
		if ( !out.solved )
		{
			return out;
		}
		m_path = std::make_unique<og::PathGeometric>( m_setup.getSolutionPath() );
		out.first_length = m_path->length();
		start = threadMicroseconds();
		if ( m_native )
		{
			smooth();
			out.simplify_us = threadMicroseconds() - start;
			out.length = m_path->length();
			return out;
		}
		og::PathSimplifier simplifier( m_setup.getSpaceInformation() );
		simplifier.reduceVertices( *m_path );
		simplifier.shortcutPath( *m_path );
		simplifier.reduceVertices( *m_path );
		out.simplify_us = threadMicroseconds() - start;
		out.length = m_path->length();
		return out;
	}

	/// The last path, simplified.
	std::vector<std::vector<double>> path() const
	{
		std::vector<std::vector<double>> points;
		for ( std::size_t i = 0; i < m_path->getStateCount(); ++i )
		{
			points.emplace_back( m_engine->adapter().size() );
			m_engine->adapter().toVector( m_path->getState( static_cast<unsigned>( i ) ), points.back().data() );
		}
		return points;
	}

private:
	void smooth()
	{
		leeway::planners::Path path;
		for ( const std::vector<double>& point : this->path() )
		{
			path.dimension = point.size();
			path.values.insert( path.values.end(), point.begin(), point.end() );
		}
		const leeway::ompl::Engine::Lease lease( *m_engine );
		leeway::require( leeway::planners::smooth( lease.checker(), lease.query(), {}, {}, path ), "smoothing" );
		m_path = std::make_unique<og::PathGeometric>( m_setup.getSpaceInformation() );
		ob::ScopedState<> state( m_setup.getStateSpace() );
		for ( std::size_t i = 0; i < path.count(); ++i )
		{
			m_engine->adapter().fromVector( path[i], state.get() );
			m_path->append( state.get() );
		}
	}

	bool m_native = false;
	og::SimpleSetup m_setup;
	std::shared_ptr<leeway::ompl::Engine> m_engine;
	std::unique_ptr<og::PathGeometric> m_path;
	bool m_usable = false;
};

/// Results of all runs of one judge on one set of problems.
struct Tally
{
	std::size_t runs = 0, solved = 0, in_contact = 0;
	std::vector<double> plan, simplify, first_length, length;

	std::uint64_t hash = 0xcbf29ce484222325u; ///< of all states of all paths, FNV-1a over their bytes

	void addPath( const std::vector<std::vector<double>>& path )
	{
		for ( const std::vector<double>& point : path )
		{
			for ( std::size_t i = 0; i < point.size() * sizeof( double ); ++i )
			{
				hash = ( hash ^ reinterpret_cast<const unsigned char*>( point.data() )[i] ) * 0x100000001b3u;
			}
		}
	}

	void add( const Tally& other )
	{
		runs += other.runs;
		solved += other.solved;
		in_contact += other.in_contact;
		hash = hash * 31 + other.hash;
		const auto append = []( std::vector<double>& to, const std::vector<double>& from )
		{ to.insert( to.end(), from.begin(), from.end() ); };
		append( plan, other.plan );
		append( simplify, other.simplify );
		append( first_length, other.first_length );
		append( length, other.length );
	}

	void add( const Planned& planned )
	{
		++runs;
		solved += planned.solved;
		in_contact += planned.in_contact;
		if ( planned.solved )
		{
			plan.push_back( planned.plan_us );
			simplify.push_back( planned.simplify_us );
			first_length.push_back( planned.first_length );
			length.push_back( planned.length );
		}
	}
};

using Tallies = std::array<Tally, JUDGES>;

bool inContact( EdgeAuditor& auditor, const EdgeWorld& world, const std::vector<std::vector<double>>& path )
{
	for ( std::size_t i = 0; i + 1 < path.size(); ++i )
	{
		const std::vector<double> a = world.full( path[i] ), b = world.full( path[i + 1] );
		if ( auditor.look( a.data(), b.data() ).contact )
		{
			return true;
		}
	}
	return false;
}

/// @return false if an end of the problem is in contact: no judge plans then
bool planProblem(
    const Settings& settings, const EdgeWorldEntry& entry, const std::shared_ptr<FclModels>& models, Tallies& tallies )
{
	const EdgeWorld& world = entry.world;
	EdgeJudges judges( world, models );
	EdgeAuditor auditor(
	    world.robot.get(), world.scene.get(), world.variables, world.reference.data(), world.allowed );
	std::vector<std::unique_ptr<Planning>> plannings;
	for ( std::size_t j = 0; j < settings.rows(); ++j )
	{
		plannings.push_back(
		    std::make_unique<Planning>( entry, judges, static_cast<Judge>( j ), settings.range ) );
	}
	if ( !plannings[0]->usable() || ( settings.rows() == JUDGES && !judges.hasFcl() ) )
	{
		return false;
	}
	for ( int run = 0; run <= settings.runs; ++run )
	{
		for ( std::size_t j = 0; j < settings.rows(); ++j )
		{
			Planned planned = plannings[j]->run( settings.seconds );
			if ( run == 0 )
			{
				continue; // the first run of each judge warms memory and caches and is not counted
			}
			planned.in_contact = planned.solved && inContact( auditor, world, plannings[j]->path() );
			tallies[j].add( planned );
			if ( planned.solved )
			{
				tallies[j].addPath( plannings[j]->path() );
			}
		}
	}
	return true;
}

Json report( const std::string& name, const Tallies& tallies, std::size_t count )
{
	Json rows = Json::array();
	for ( std::size_t j = 0; j < count; ++j )
	{
		const Tally& t = tallies[j];
		const Summary plan = summarise( t.plan ), simplify = summarise( t.simplify ), ours = summarise( tallies[0].plan );
		std::printf( "%-28s %-15s %4zu/%-4zu | %9.0f %9.0f %10.0f | %9.0f | %6.2f %6.2f | %7.2f %7.2f | %4zu\n", name.c_str(),
		    JUDGE_NAMES[j], t.solved, t.runs, plan.median, plan.mean, plan.p95, simplify.median,
		    ours.median > 0 ? plan.median / ours.median : 0, ours.mean > 0 ? plan.mean / ours.mean : 0, median( t.first_length ),
		    median( t.length ),
		    t.in_contact );
		rows.push_back( { { "problems", name }, { "judge", JUDGE_NAMES[j] }, { "runs", t.runs }, { "solved", t.solved },
		    { "planning", toJson( plan ) }, { "simplification", toJson( simplify ) }, { "first_length_median", median( t.first_length ) },
		    { "length_median", median( t.length ) },
		    { "in_contact", t.in_contact }, { "paths_hash", std::to_string( t.hash ) } } );
	}
	std::fflush( stdout );
	return rows;
}

/// The set of a problem: box_panda of "panda panda_arm/box_panda/1", armar3 planner of "armar3 planner/06".
std::string setOf( const std::string& name )
{
	const std::size_t first = name.find( '/' ), last = name.rfind( '/' );
	return first == last ? name.substr( 0, first ) : name.substr( first + 1, last - first - 1 );
}

/// panda of "box_panda", armar3 of "armar3 planner".
std::string robotOf( const std::string& set )
{
	return set.find( ' ' ) != std::string::npos ? set.substr( 0, set.find( ' ' ) ) : set.substr( set.rfind( '_' ) + 1 );
}

int run( const Settings& settings )
{
	::ompl::msg::setLogLevel( ::ompl::msg::LOG_NONE );
	::ompl::RNG::setSeed( static_cast<std::uint_fast32_t>( settings.seed % 0x7fffffff + 1 ) );
	lw_reach_def reach = lw_reach_def_default();
	reach.seconds = settings.budget;
	EdgeWorlds worlds( settings.data, reach );
	std::vector<int> numbers( static_cast<std::size_t>( settings.problems ) );
	std::iota( numbers.begin(), numbers.end(), 1 );
	worlds.addMbm( "panda", "panda_arm", numbers );
	worlds.addMbm( "fetch", "arm_with_torso", numbers );
	worlds.addArmarProblems();
	std::printf( "microseconds of processor time; ratios to leeway; solved of runs; paths in contact\n" );
	std::printf( "%-28s %-15s %9s | %9s %9s %10s | %9s | %6s %6s | %7s %7s | %s\n", "problems", "judge", "solved", "median",
	    "mean", "p95", "simplify", "median", "mean", "first", "length", "contact" );
	const auto models = std::make_shared<FclModels>();
	Json rows = Json::array();
	std::size_t refuted = 0, left_out = 0;
	std::map<std::string, Tallies> totals;
	for ( std::size_t i = 0; i < worlds.size(); )
	{
		// "panda panda_arm/box_panda/1": all of one set together
		const std::string& name = worlds.world( i ).name;
		const std::string set = setOf( name );
		Tallies tallies;
		std::size_t planned = 0;
		for ( ; i < worlds.size() && setOf( worlds.world( i ).name ) == set; ++i )
		{
			if ( set.find( settings.only ) != std::string::npos )
			{
				const bool usable = planProblem( settings, worlds.entry( i ), models, tallies );
				planned += usable;
				left_out += !usable;
			}
		}
		if ( planned > 0 )
		{
			refuted += tallies[0].in_contact + tallies[1].in_contact + tallies[2].in_contact;
			Tallies& total = totals["all of " + robotOf( set )];
			for ( std::size_t j = 0; j < settings.rows(); ++j )
			{
				total[j].add( tallies[j] );
			}
			for ( const Json& row : report( set, tallies, settings.rows() ) )
			{
				rows.push_back( row );
			}
		}
	}
	for ( const auto& [name, total] : totals )
	{
		for ( const Json& row : report( name, total, settings.rows() ) )
		{
			rows.push_back( row );
		}
	}
	if ( rows.empty() )
	{
		throw std::runtime_error( "--only " + settings.only + ": no set of problems has that in its name" );
	}
	std::printf( "\nproblems left out because an end is in contact: %zu; paths of proved motions in contact: %zu\n",
	    left_out, refuted );
	writeResult( settings.json,
	    { { "provenance", provenance() }, { "seed", settings.seed }, { "problems", settings.problems },
	        { "runs", settings.runs }, { "seconds", settings.seconds }, { "range", settings.range }, { "rows", rows } } );
	return refuted > 0 ? 1 : 0;
}

} // namespace

int main( int argc, char** argv )
{
	Settings settings;
	BenchProgram program(
	    "bench_planning", "MotionBenchMaker's problems end to end: certified motions against sampled ones." );
	program.option( "--data", settings.data, "folder of robots and scenes" );
	program.option( "--only", settings.only, "only sets with this in their name, such as 'panda' or 'box_fetch'" );
	program.option( "--problems", settings.problems, "of each set", { 1, 20 } );
	program.option( "--runs", settings.runs, "of each problem", { 1 } );
	program.option( "--seconds", settings.seconds, "at most for a run", POSITIVE );
	program.option( "--range", settings.range, "longest motion that the planner adds; 0 = OMPL's choice" );
	program.option( "--budget", settings.budget, "seconds for pair proofs" );
	program.flag( "--planners-only", settings.planners_only, "rows of proved motions only" );
	program.flag( "--native-only", settings.native_only, "leeway's planner only" );
	program.option( "--seed", settings.seed, "of the planners" );
	program.option( "--json", settings.json, "result file" );
	return program.run( argc, argv, [&] { return run( settings ); } );
}
