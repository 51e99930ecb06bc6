// SPDX-License-Identifier: BSD-3-Clause
// Whole planning problems: MotionBenchMaker's of each robot of the data, and ARMAR-III's reaches. Rows: leeway's own planner, OMPL's
// with motions proved by certificates, or sampled over leeway's states and over FCL's, and modules of other libraries. Exit
// status 1 if a path of proved motions is refuted by a dense look.
//
// All rows plan the same problems, problem by problem in turn, several runs each with random numbers of their own. The time is
// the processor time of planning, then that of a simplification: leeway's smoother, OMPL's shortcuts, or the module's own.
// The auditor checks every path afterwards (tests/support/edge_auditor.hpp), outside of its time.
#include "edge_auditor.hpp"
#include "planning/clearance_tally.hpp"
#include "planning/generated_problems.hpp"
#include "planning/page.hpp"
#include "planning/prefix_grid.hpp"
#include "planning/tally.hpp"
#include "planning/ways.hpp"
#include "programs/commands.hpp"
#include "support/provenance.hpp"
#include "support/temporary_folder.hpp"

#include <ompl/util/Console.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <numeric>

namespace
{

struct Settings
{
	std::string data = LEEWAY_DATA_DIR, html, only, zoo, files, paths;
	std::vector<std::string> planners, ranges, modules, rows;
	int problems = 5, runs = 3;
	double seconds = 5, budget = 10;
	double clearance_goal = 0, clearance_ms = 10;
	bool planners_only = false, native_only = false, why = false;
	std::uint64_t seed = 20260101;
};

std::vector<WayKind> allWays( const Settings& settings )
{
	if ( settings.native_only )
	{
		return planningWays( { "leeway" }, {} );
	}
	std::vector<WayKind> ways = planningWays( settings.planners, settings.ranges );
	const auto append = [&]( const std::vector<WayKind>& more ) { ways.insert( ways.end(), more.begin(), more.end() ); };
	if ( !settings.planners_only && settings.planners.empty() && settings.ranges.empty() )
	{
		append( sampledWays() );
	}
	append( moduleWays( settings.modules ) );
	return ways;
}

/// The first row stays: its judge selects the problems.
std::vector<WayKind> waysOf( const Settings& settings )
{
	std::vector<WayKind> ways;
	for ( WayKind& way : allWays( settings ) )
	{
		const auto named = [&]( const std::string& row ) { return way.name.find( row ) != std::string::npos; };
		if ( ways.empty() || settings.rows.empty() || std::any_of( settings.rows.begin(), settings.rows.end(), named ) )
		{
			ways.push_back( std::move( way ) );
		}
	}
	return ways;
}

bool inContact( EdgeAuditor& auditor, const EdgeWorld& world, const States& path )
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

std::uint64_t seedOf( const Settings& settings, const std::string& problem, int run )
{
	Hash hash;
	hash.add( static_cast<std::int64_t>( settings.seed ) );
	hash.add( problem.data(), problem.size() );
	hash.add( run );
	return std::stoull( hash.text(), nullptr, 16 );
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

class Planning
{
public:
	explicit Planning( const Settings& settings ) : m_settings( settings ), m_ways( waysOf( settings ) )
	{
		for ( const WayKind& way : m_ways )
		{
			m_needs_fcl = m_needs_fcl || way.motions == Motions::FCL || way.motions == Motions::FCL_FINE;
		}
		if ( !settings.paths.empty() )
		{
			m_paths.open( settings.paths );
			if ( !m_paths )
			{
				throw std::runtime_error( settings.paths + ": cannot be written; give another --paths" );
			}
		}
	}

	void run( const EdgeWorlds& worlds )
	{
		printHeader( m_ways );
		for ( std::size_t i = 0; i < worlds.size(); )
		{
			// "panda panda_arm/box_panda/1": all of one set together
			m_clearances.emplace_back();
			SetResult result = { setOf( worlds.world( i ).name ), std::vector<Tally>( m_ways.size() ) };
			for ( ; i < worlds.size() && setOf( worlds.world( i ).name ) == result.name; ++i )
			{
				if ( result.name.find( m_settings.only ) != std::string::npos )
				{
					planProblem( worlds.entry( i ), i, result );
					explain( worlds.entry( i ), result.tallies[0] );
				}
			}
			if ( !result.tallies[0].runs.empty() )
			{
				add( std::move( result ) );
			}
			else
			{
				m_clearances.pop_back();
			}
		}
		for ( const SetResult& total : m_totals )
		{
			print( total, m_ways );
		}
		printClearances();
	}

	std::size_t refuted() const
	{
		std::size_t count = 0;
		for ( const SetResult& total : m_totals )
		{
			for ( std::size_t w = 0; w < m_ways.size(); ++w )
			{
				count += m_ways[w].proved() ? total.tallies[w].inContact() : 0;
			}
		}
		return count;
	}

	std::size_t leftOut() const { return m_left_out; }
	bool empty() const { return m_sets.empty(); }

	void write( Result& result ) const
	{
		result["left_out"] = m_left_out;
		result["unsolved"] = m_why;
		for ( std::size_t i = 0; m_settings.clearance_goal > 0 && i < m_sets.size(); ++i )
		{
			result["clearance"].push_back( m_clearances[i].json( m_sets[i].name ) );
		}
		for ( const WayKind& way : m_ways )
		{
			if ( way.module )
			{
				result["modules"].push_back( way.module->description() );
			}
		}
		for ( const std::vector<SetResult>* results : { &m_sets, &m_totals } )
		{
			for ( const SetResult& set : *results )
			{
				for ( const Json& row : toJson( set, m_ways, results == &m_totals ) )
				{
					result.add( row );
				}
			}
		}
		if ( !m_settings.html.empty() )
		{
			writePlanningPage( m_settings.html, m_ways, m_totals, m_sets, result.origin() );
		}
	}

private:
	/// Nobody plans if leeway finds an end in contact.
	void planProblem( const EdgeWorldEntry& entry, std::size_t number, SetResult& result )
	{
		const EdgeWorld& world = entry.world;
		m_first = &result.tallies[0];
		EdgeJudges judges( world, m_models );
		std::vector<std::unique_ptr<Way>> ways;
		for ( const WayKind& kind : m_ways )
		{
			ways.push_back( makeWay( kind, entry, result.name, judges, seedOf( m_settings, world.name, -1 ) ) );
		}
		for ( std::size_t w = 0; w < ways.size(); ++w )
		{
			++result.tallies[w].asked;
			result.tallies[w].accepted += ways[w]->usable();
		}
		if ( !ways[0]->usable() || ( m_needs_fcl && !judges.hasFcl() ) )
		{
			++m_left_out;
			return;
		}
		for ( std::size_t w = 0; w < ways.size(); ++w )
		{
			++result.tallies[w].problems;
			result.tallies[w].refused += !ways[w]->usable();
		}
		std::vector<std::vector<Planned>> plans;
		for ( const std::unique_ptr<Way>& way : ways )
		{
			plans.push_back( runsOf( *way, world.name ) );
		}
		EdgeAuditor auditor( world.robot.get(), world.scene.get(), world.variables, world.reference.data(), world.allowed );
		for ( int run = 1; run <= m_settings.runs; ++run )
		{
			for ( std::size_t w = 0; w < ways.size(); ++w )
			{
				PlanRun out = audited(
				    plans[w][static_cast<std::size_t>( run )], world, auditor, run, result.tallies[w], m_ways[w].name );
				out.problem = number;
				addRun( out, world.name, result.tallies[w] );
			}
		}
	}

	/// All runs of a problem, one after another as in a program with one planner: what another one writes, 12 MB a run for VAMP, would
	/// cool the caches. The first run warms memory and caches and is not counted; the auditor, which would cool them, waits.
	std::vector<Planned> runsOf( Way& way, const std::string& world ) const
	{
		std::vector<Planned> plans( static_cast<std::size_t>( m_settings.runs ) + 1 );
		for ( std::size_t run = 0; way.usable() && run < plans.size(); ++run )
		{
			plans[run] = way.run( m_settings.seconds, seedOf( m_settings, world, static_cast<int>( run ) ) );
		}
		return plans;
	}

	/// Looks for a reason if the problem is the last one that was not solved.
	void explain( const EdgeWorldEntry& entry, const Tally& tally )
	{
		const std::string& name = entry.world.name;
		if ( m_settings.why && !m_settings.zoo.empty() && !tally.unsolved.empty() && tally.unsolved.back() == name )
		{
			const std::string found = disconnectedPrefix( entry );
			m_why[name] = found.empty() ? "unknown" : found;
			std::printf( "%s: %s\n", name.c_str(), m_why[name].get<std::string>().c_str() );
		}
	}

	static void addRun( const PlanRun& run, const std::string& problem, Tally& tally )
	{
		tally.runs.push_back( run );
		if ( !run.solved && ( tally.unsolved.empty() || tally.unsolved.back() != problem ) )
		{
			tally.unsolved.push_back( problem );
		}
	}

	/// A line of --paths.
	void keep( const EdgeWorld& world, const std::string& way, int run, const Planned& planned, const PlanRun& out )
	{
		if ( !m_paths.is_open() )
		{
			return;
		}
		Json line = { { "problem", world.name }, { "way", way }, { "run", run }, { "plan_us", out.plan_us },
		    { "simplify_us", out.simplify_us }, { "in_contact", out.in_contact }, { "path", planned.path } };
		for ( const std::uint32_t variable : world.variables )
		{
			const lw_variable_info info = lw_robot_variable( world.robot.get(), variable );
			line["joints"].push_back( lw_robot_joint_name( world.robot.get(), info.joint ) );
		}
		m_paths << line.dump() << '\n' << std::flush;
	}

	PlanRun audited( const Planned& planned, const EdgeWorld& world, EdgeAuditor& auditor, int run, Tally& tally,
	    const std::string& name )
	{
		PlanRun out;
		out.solved = planned.solved;
		out.plan_us = planned.plan_us;
		out.simplify_us = planned.simplify_us;
		out.direct = planned.solved && planned.first.size() == 2;
		if ( planned.solved )
		{
			out.first_length = lengthOf( world, planned.first );
			out.length = lengthOf( world, planned.path );
			out.in_contact = inContact( auditor, world, planned.path );
			tally.addPath( planned.path );
			if ( &tally == m_first && m_settings.clearance_goal > 0 )
			{
				m_clearances.back().add( world, planned.path, m_settings.clearance_goal, m_settings.clearance_ms * 1e-3 );
			}
			keep( world, name, run, planned, out );
		}
		return out;
	}

	/// Each set, then all of each robot.
	void printClearances() const
	{
		if ( !( m_settings.clearance_goal > 0 ) )
		{
			return;
		}
		ClearanceTally::printHeader( m_settings.clearance_goal );
		std::map<std::string, ClearanceTally> robots;
		for ( std::size_t i = 0; i < m_sets.size(); ++i )
		{
			m_clearances[i].print( m_sets[i].name );
			robots[robotOf( m_sets[i].name )].add( m_clearances[i] );
		}
		for ( const auto& [robot, tally] : robots )
		{
			tally.print( "all of " + robot );
		}
	}

	void add( SetResult result )
	{
		print( result, m_ways );
		const std::string name = "all of " + robotOf( result.name );
		auto total = std::find_if( m_totals.begin(), m_totals.end(), [&]( const SetResult& t ) { return t.name == name; } );
		if ( total == m_totals.end() )
		{
			total = m_totals.insert( m_totals.end(), { name, std::vector<Tally>( m_ways.size() ) } );
		}
		for ( std::size_t w = 0; w < m_ways.size(); ++w )
		{
			total->tallies[w].add( result.tallies[w] );
		}
		m_sets.push_back( std::move( result ) );
	}

	const Settings& m_settings;
	const std::vector<WayKind> m_ways;
	bool m_needs_fcl = false;
	const std::shared_ptr<FclModels> m_models = std::make_shared<FclModels>();
	std::vector<SetResult> m_sets, m_totals;
	std::vector<ClearanceTally> m_clearances; ///< as m_sets
	const Tally* m_first = nullptr;           ///< of the first row, whose paths they are
	std::size_t m_left_out = 0;
	Json m_why = Json::object(); ///< reasons by problem
	std::ofstream m_paths;       ///< open with --paths
};

/// ARMAR-III's reaches, which a folder of MotionBenchMaker's robots alone does not have.
void addArmar( EdgeWorlds& worlds, const Settings& settings )
{
	if ( std::string( "armar3 planner" ).find( settings.only ) == std::string::npos )
	{
		return;
	}
	if ( settings.only.empty() && !std::filesystem::exists( settings.data + "/armar3" ) )
	{
		std::fprintf( stderr, "leeway-bench planning: without ARMAR-III: %s has no folder armar3\n", settings.data.c_str() );
		return;
	}
	worlds.addArmarProblems();
}

/// Every robot of the folder mbm: NAME/NAME.urdf, NAME.srdf and the sets of NAME/problems.
void addData( EdgeWorlds& worlds, const Settings& settings )
{
	requireData( settings.data, "mbm" );
	std::vector<int> numbers( static_cast<std::size_t>( settings.problems ) );
	std::iota( numbers.begin(), numbers.end(), 1 );
	for ( const auto& [robot, group] : worlds.mbmRobots() )
	{
		worlds.addMbm( robot, group, numbers, settings.only );
	}
	addArmar( worlds, settings );
}

void addZoo( EdgeWorlds& worlds, const Settings& settings, const std::string& folder )
{
	const std::string robots = robotsOfZoo( settings.zoo );
	for ( const ZooRobot& robot : zooRobots() )
	{
		// "ur5" and "table" are parts of the sets' names, as with the data's
		if ( ( "table_" + robot.name + " shelf_" + robot.name + " cage_" + robot.name + " boxes_" + robot.name )
		         .find( settings.only ) != std::string::npos )
		{
			addGeneratedProblems( worlds, robot, robots, settings.problems, settings.seed, folder );
		}
	}
}

int run( const Settings& settings, Result& result )
{
	::ompl::msg::setLogLevel( ::ompl::msg::LOG_NONE );
	Planning planning( settings );
	lw_reach_def reach = lw_reach_def_default();
	reach.seconds = settings.budget;
	EdgeWorlds worlds( settings.data, reach );
	const TemporaryFolder temporary;
	const std::string folder = settings.files.empty() ? temporary.path().string() : settings.files;
	std::filesystem::create_directories( folder );
	settings.zoo.empty() ? addData( worlds, settings ) : addZoo( worlds, settings, folder );
	planning.run( worlds );
	if ( planning.empty() )
	{
		throw std::runtime_error( "--only " + settings.only + ": no set of problems has that in its name" );
	}
	std::printf( "\nproblems left out because an end is in contact: %zu; paths of proved motions in contact: %zu\n",
	    planning.leftOut(), planning.refuted() );
	planning.write( result );
	return planning.refuted() > 0 ? 1 : 0;
}

} // namespace

void addPlanning( Bench& bench )
{
	const auto s = std::make_shared<Settings>();
	Command& command =
	    bench.command( "planning", "planning problems end to end: leeway's planner, OMPL's, modules of other libraries" );
	command.option( "--data", s->data, "folder of robots and scenes" );
	command.option( "--zoo", s->zoo,
	    "folder of .ci/install.sh zoo: its robots in scenes made by seed, in place of the data's problems" );
	command.option( "--files", s->files, "with --zoo: folder that keeps SRDFs, scenes and requests, for leeway plan" );
	command.flag( "--why", s->why, "with --zoo: grids of the first joints for problems that the first row does not solve" );
	command.option( "--only", s->only, "only sets with this in their name, such as 'panda' or 'box_fetch'" );
	command.option( "--problems", s->problems, "of each set, if it has as many", { 1, 100 } );
	command.option( "--runs", s->runs, "of each problem", { 1 } );
	command.option( "--seconds", s->seconds, "at most for a run", POSITIVE );
	command.option( "--planner", s->planners, "'leeway' or one of OMPL's, such as BKPIECE1; again for more" );
	command.option( "--range", s->ranges,
	    "longest motion that these planners add: a number, 'robot' (suits the robot) or 'default'; again for more" );
	command.option( "--row", s->rows, "only rows with this in their name, and the first one; again for more" );
	command.option( "--paths", s->paths, "file for every path, a line of JSON each: python -m leeway.fleet referee" );
	command.option( "--clearance-goal", s->clearance_goal,
	    "metres, above 0: raises the clearance of the first row's paths afterwards, and prints it before and after" );
	command.option( "--clearance-ms", s->clearance_ms, "milliseconds for each of these paths", POSITIVE );
	command.option( "--module", s->modules,
	    "planner of another library: a file, or the name of one beside the program; those are found without this, too" );
	command.option( "--budget", s->budget, "seconds for pair proofs, at most; a user has complete tables after few runs" );
	command.flag(
	    "--planners-only", s->planners_only, "without the rows of sampled motions, as with --planner and --range" );
	command.flag( "--native-only", s->native_only, "leeway's planner only" );
	command.option( "--seed", s->seed, "of the planners" );
	command.option( "--html", s->html, "page with distributions and tables" );
	command.work( [s]( Result& result ) { return run( *s, result ); } );
}
