// SPDX-License-Identifier: BSD-3-Clause
// leeway plan: a request solved, simplified, certified again, and audited.
#include "program/plan_bounds.hpp"
#include "commands/plan_solution.hpp"
#include "motions/names.hpp"
#include "commands/certificate_file.hpp"
#include "commands/limits_file.hpp"
#include "program/ends.hpp"

#include "leeway/motions/timed.hpp"
#include "leeway/ompl/versions.hpp"
#include "leeway/planners/ompl_planner.hpp"
#include "leeway/planners/planner_registry.hpp"
#include "leeway/planners/smooth.hpp"
#include "leeway/planners/unwrap.hpp"

#include <ompl/base/goals/GoalStates.h>
#include <ompl/geometric/PathGeometric.h>
#include <ompl/geometric/PathSimplifier.h>
#include <ompl/util/Console.h>
#include <ompl/util/Exception.h>
#include <ompl/util/RandomNumbers.h>

#include <fmt/format.h>

#include <mutex>

namespace leeway::cli
{
namespace
{

namespace ob = ::ompl::base;
namespace og = ::ompl::geometric;

// Simplification ends when a round gains less than this share of the length, or after this many rounds.
constexpr double simplify_gain = 0.02;
constexpr int simplify_rounds = 10;
constexpr unsigned smooth_tries = 4;           // of leeway's own smoother
constexpr unsigned int simplify_attempts = 30; // shortcuts tried per round

// OMPL's own messages: silent, or notices with --verbose.
class OmplMessages : public ::ompl::msg::OutputHandler
{
public:
	OmplMessages( Notices& notices, bool verbose ) : m_notices( notices ), m_verbose( verbose )
	{
		::ompl::msg::useOutputHandler( this );
		::ompl::msg::setLogLevel( verbose ? ::ompl::msg::LOG_INFO : ::ompl::msg::LOG_WARN );
	}
	~OmplMessages() override { ::ompl::msg::noOutputHandler(); }
	void log( const std::string& text, ::ompl::msg::LogLevel, const char*, int ) override
	{
		const std::lock_guard<std::mutex> lock( m_mutex );
		if ( m_verbose )
		{
			m_notices.add( "OMPL", "OMPL: " + text );
		}
	}

private:
	Notices& m_notices;
	bool m_verbose;
	std::mutex m_mutex;
};

} // namespace

void requireUsable( const PlanOptions& options, const Workbench& bench, const EndPlace& end, const std::vector<double>& q )
{
	const auto wrong = [&end]( const std::string& problem, const std::string& remedy )
	{ throw io::Error( end.file, end.element, problem, remedy ); };
	const std::vector<std::string> violations = groupLimitViolations( bench.problem(), q, limit_tolerance );
	if ( !violations.empty() )
	{
		std::string all;
		for ( const std::string& violation : violations )
		{
			all += ( all.empty() ? "" : "; " ) + violation;
		}
		wrong( all, end.element == "--start" ? "name these joints in --start: joints without a value start at 0"
		                                     : "give a state inside the joint limits" );
	}
	const lw_check_flags flags = options.common.checkFlags();
	const lw_state_result state = measure( bench, q, flags, nullptr, end.file, end.element );
	const double min_d = options.common.min_d;
	const auto judge = [&]( const char* which, const Named& clearance, const std::string& remedy )
	{
		// A clearance that is not proved to be above the margin is not usable; NaN included.
		if ( !( clearance.lower > min_d ) )
		{
			wrong( clearance.least() > 0 || clearance.margin > 0
			           ? fmt::format( "{} clearance of {} - {} is {} m, not above --min-d {} m{}", which, clearance.first,
			                 clearance.second, clearance.least(), min_d, clearance.marginText() )
			           : fmt::format( "{} - {} are in contact ({})", clearance.first, clearance.second, which ),
			    remedy );
		}
	};
	if ( ( flags & LW_CHECK_ENVIRONMENT ) != 0 )
	{
		const lw_clearance fixed = lw_checker_get_info( bench.checker() ).static_environment;
		judge( "environment", nameEnvironment( bench.checker(), fixed ),
		    fmt::format(
		        "group {} cannot move this link: move the object, the robot's base, or a joint outside of the group",
		        bench.problem().group ) );
		judge( "environment", nameEnvironment( bench.checker(), state.environment ),
		    "move the object, choose another state, or lower --min-d" );
	}
	if ( ( flags & LW_CHECK_SELF ) != 0 )
	{
		const Named self = nameSelf( bench.checker(), state.self );
		judge( "self", self,
		    fmt::format( "choose another state, lower --min-d, or, if these may touch, disable the pair in the SRDF (leeway "
		                 "pairs writes one) or with --allow {}:{}",
		        self.first, self.second ) );
	}
}

namespace
{

lw_edge_def edgeDef( const PlanOptions& options )
{
	lw_edge_def def = lw_edge_def_default();
	def.method = options.edge.validator == "steps" ? LW_EDGE_STEPS : LW_EDGE_CERTIFIED;
	def.flags = options.common.checkFlags();
	def.min_d = options.common.min_d;
	def.slack = options.edge.slack;
	def.max_d = stepLength( options.common );
	return def;
}

// The planners that share the time. Trees that grow towards each other by long motions find most paths at once; where both ends are in narrow
// places, many short motions do (b1, a quadruped with an arm: RRTConnect finds nothing in 30 s, SBL a path in 1.4 s).
// native: the group suits leeway's own planner, which supports no floating joints
std::vector<std::string> plannersOf( const PlanOptions& options, bool native = true )
{
	if ( !options.planner.empty() )
	{
		return { options.planner };
	}
	const std::string first = native ? "Leeway" : "RRTConnect";
	return options.parameters.empty() ? std::vector<std::string>{ first, "SBL" } : std::vector<std::string>{ first };
}

// Length of the longest motion that suits the robot; 0 for spaces with rotations.
double suitableRange( const ::leeway::ompl::Engine& engine )
{
	try
	{
		return planners::geometricRange( engine );
	}
	catch ( const planners::InputError& )
	{
		return 0;
	}
}

// OMPL's planners take a fifth of the space's extent, whatever the robot: proofs of motions that long are mostly in vain.
void setRange( ob::Planner& planner, double range, const std::vector<std::string>& parameters )
{
	const bool given = std::any_of( parameters.begin(), parameters.end(),
	    []( const std::string& assignment ) { return assignment.rfind( "range=", 0 ) == 0; } );
	if ( range > 0 && !given && planner.params().hasParam( "range" ) )
	{
		planner.params().setParam( "range", fmt::format( "{:.3g}", range ) );
	}
}

// All edges once more, with a query of their own: nothing of the planner's is trusted.
Edges certify( const Workbench& bench, const Points& points, const lw_edge_def& def )
{
	const Query query = makeQuery( bench.checker() );
	Edges edges;
	edges.lower_bound = HUGE_VAL;
	for ( std::size_t k = 0; k + 1 < points.size(); ++k )
	{
		lw_edge_result edge;
		require( lw_checker_edge( bench.checker(), query.get(), points[k].data(), points[k + 1].data(), &def, &edge ),
		    "edge check" );
		++( edge.verdict == LW_VERDICT_FREE      ? edges.free
		    : edge.verdict == LW_VERDICT_BLOCKED ? edges.blocked
		                                         : edges.undecided );
		edges.lower_bound = std::min( edges.lower_bound, edge.verdict == LW_VERDICT_FREE ? edge.lower_bound : 0.0 );
	}
	return edges;
}

Points pointsOf( const og::PathGeometric& path, const ::leeway::ompl::Engine& engine )
{
	Points points;
	for ( std::size_t i = 0; i < path.getStateCount(); ++i )
	{
		points.emplace_back( engine.adapter().size() );
		engine.adapter().toVector( path.getState( static_cast<unsigned int>( i ) ), points.back().data() );
	}
	return points;
}

planners::Path flat( const Points& points )
{
	planners::Path path;
	path.dimension = points.front().size();
	for ( const std::vector<double>& point : points )
	{
		path.values.insert( path.values.end(), point.begin(), point.end() );
	}
	return path;
}

Points pointsOf( const planners::Path& path )
{
	Points points;
	for ( std::size_t i = 0; i < path.count(); ++i )
	{
		points.emplace_back( path[i], path[i] + path.dimension );
	}
	return points;
}

// The path after proved shortcuts and cut corners.
Points smoothed( const Workbench& bench, const Points& points, const lw_edge_def& def, std::uint64_t seed )
{
	planners::Path path = flat( points );
	planners::SmoothSettings settings;
	settings.edge = def;
	settings.seed = seed;
	const Query query = makeQuery( bench.checker() );
	require( planners::smooth( bench.checker(), query.get(), settings, {}, path ), "smoothing" );
	return pointsOf( path );
}

// Shortcuts only: the path stays a chain of straight edges, each judged by the motion validator. Rounds are counted, not
// timed, so that equal seeds give equal paths. Shortcuts between points of edges keep parts of these, and a part may be undecided where
// the whole was not (its samples are elsewhere): a step after which not all edges are certified is taken back.
template <typename Certified>
void simplify( og::PathGeometric& path, const ob::SpaceInformationPtr& si, const Certified& certified )
{
	og::PathSimplifier simplifier( si );
	const auto attempt = [&]( const auto& step )
	{
		const og::PathGeometric before( path );
		step();
		if ( !certified( path ) )
		{
			path = before;
		}
	};
	double length = path.length();
	for ( int round = 0; round < simplify_rounds && path.getStateCount() > 2; ++round )
	{
		attempt( [&] { simplifier.reduceVertices( path, simplify_attempts, simplify_attempts ); } );
		attempt( [&] { ompl::shortcutPath( simplifier, path, simplify_attempts, simplify_attempts ); } );
		attempt( [&] { simplifier.collapseCloseVertices( path ); } );
		const double shorter = path.length();
		if ( length - shorter < simplify_gain * length )
		{
			break;
		}
		length = shorter;
	}
}

// A line a second, with --verbose.
void tellGrowth( const planners::Growth& growth, double seconds )
{
	tell( "leeway: planning: {:.0f} s, {} from the start, {} from the goal, least distance between them {:.3g}\n", seconds,
	    counted( growth.start_nodes, "node" ), counted( growth.goal_nodes, "node" ), growth.gap );
}

class Planning
{
public:
	Planning( const PlanOptions& options, const Workbench& bench, std::vector<double> start, Points goals, Notices& notices )
	    : m_options( options ), m_bench( bench ), m_start( std::move( start ) ), m_goals( std::move( goals ) )
	{
		::leeway::ompl::Options judge;
		judge.min_d = options.common.min_d;
		judge.alpha = options.common.alpha;
		judge.max_d = std::max( judge.max_d, 2 * options.common.min_d );
		judge.slack = options.edge.slack;
		judge.method = options.edge.validator == "steps" ? LW_EDGE_STEPS : LW_EDGE_CERTIFIED;
		judge.step = stepLength( options.common );
		judge.flags = options.common.checkFlags();
		m_space = ::leeway::ompl::makeStateSpace( bench.problem().checker );
		const ::leeway::ompl::StateAdapter adapter( m_space, bench.problem().checker );
		ob::ScopedState<> first( m_space ), last( m_space );
		adapter.fromVector( m_start.data(), first.get() );
		adapter.fromVector( m_goals.front().data(), last.get() );
		narrow( *m_space, *first.get(), *last.get(), notices );
		widen( *m_space, *first.get() );
		for ( const std::vector<double>& goal : m_goals )
		{
			adapter.fromVector( goal.data(), last.get() );
			widen( *m_space, *last.get() );
		}
		m_si = std::make_shared<ob::SpaceInformation>( m_space );
		m_engine = ::leeway::ompl::install( m_si, bench.problem().checker, judge );
		m_range = suitableRange( *m_engine );
		m_si->setup();
		planners::ensureProjection( m_space ); // after setup(), which registers the space's own
	}

	Solution solve( double time )
	{
		Solution solution;
		auto definition = std::make_shared<ob::ProblemDefinition>( m_si );
		definition->addStartState( state( m_start ) );
		const auto goals = std::make_shared<ob::GoalStates>( m_si );
		for ( const std::vector<double>& goal : m_goals )
		{
			goals->addState( state( goal ) );
		}
		definition->setGoal( goals );
		const std::vector<std::string> names = plannersOf( m_options, m_range > 0 );
		planners::requireThreads( planners::findPlanner( names.front() ), m_options.threads );
		solution.tried = names;
		for ( std::size_t i = 0; i < names.size() && !solution.solved; ++i )
		{
			run( planners::findPlanner( names[i] ), time / static_cast<double>( names.size() ), definition, solution );
		}
		if ( solution.solved )
		{
			finish( *definition->getSolutionPath()->as<og::PathGeometric>(), solution );
			optimize( solution );
			pushAway( solution );
		}
		else
		{
			solution.stuck = m_native ? m_native->explain() : explainEnds();
		}
		solution.counters = m_engine->counters();
		solution.undecided_pairs = m_engine->undecidedPairs();
		solution.undecided = m_engine->describeUndecided();
		return solution;
	}

private:
	void run(
	    const planners::PlannerEntry& entry, double time, const ob::ProblemDefinitionPtr& definition, Solution& solution )
	{
		solution.planner = entry.name;
		definition->clearSolutionPaths(); // an approximate one of the planner before
		const ob::PlannerPtr planner = entry.make( m_si );
		const auto native = std::dynamic_pointer_cast<planners::OmplPlanner>( planner );
		m_native = native ? native : m_native;
		if ( native )
		{
			native->setSeed( m_options.seed );
			m_options.common.verbose ? native->setProgress( tellGrowth ) : void();
		}
		solution.threads = 1;
		setRange( *planner, m_range, m_options.parameters );
		planners::setParameters( *planner, m_options.parameters );
		if ( entry.threads != nullptr )
		{
			if ( m_options.threads > 0 )
			{
				planner->params().setParam( entry.threads, std::to_string( m_options.threads ) );
			}
			std::string threads;
			planner->params().getParam( entry.threads, threads );
			solution.threads = static_cast<unsigned>( std::stoul( threads ) );
		}
		{
			std::unique_ptr<Progress> progress;
			if ( !native || !m_options.common.verbose ) // its lines would be mixed
			{
				progress = std::make_unique<Progress>( fmt::format( "planning with {}", planner->getName() ) );
			}
			const double begin = now();
			planner->setProblemDefinition( definition );
			planner->setup();
			planner->params().getParams( solution.parameters ); // as set up: 0 may mean the planner's own choice
			solution.status = planner->solve( ob::timedPlannerTerminationCondition( time ) ).asString();
			solution.seconds.plan += now() - begin;
		}
		solution.path_seed = native ? native->seed() : m_options.seed;
		// An approximate solution ends somewhere else: it is none.
		solution.solved = definition->hasExactSolution();
	}

	ob::ScopedState<> state( const std::vector<double>& q ) const
	{
		ob::ScopedState<> result( m_space );
		m_engine->adapter().fromVector( q.data(), result.get() );
		m_space->enforceBounds( result.get() ); // angles that wrap, to one turn; the others were found inside their limits
		return result;
	}

	// The same path from the numbers of the start on, without jumps.
	Points unwrapped( const Points& points ) const
	{
		planners::Path path = flat( points );
		planners::unwrap( m_bench.checker(), m_start.data(), path );
		return pointsOf( path );
	}

	void finish( og::PathGeometric& path, Solution& solution )
	{
		const lw_edge_def def = edgeDef( m_options );
		solution.points = unwrapped( pointsOf( path, *m_engine ) );
		solution.raw_states = solution.points.size();
		solution.raw_length = lengthOf( m_bench, solution.points );
		const double begin = now();
		solution.edges = certify( m_bench, solution.points, def );
		solution.seconds.certify = now() - begin;
		if ( !m_options.simplify )
		{
			return;
		}
		const Progress progress( "simplifying the path" );
		const double simplify_begin = now();
		// a path that is not certified to begin with cannot get worse
		const bool was_certified = solution.edges.all();
		Points shorter;
		if ( m_range > 0 )
		{
			// Within the slack a proof may depend on the edges before it: another seed makes other edges
			unsigned tries = 0;
			do
			{
				shorter = unwrapped(
				    smoothed( m_bench, solution.points, def, solution.path_seed + ( std::uint64_t( tries ) << 32 ) ) );
			} while ( was_certified && !certify( m_bench, shorter, def ).all() && ++tries < smooth_tries );
			shorter = tries < smooth_tries ? shorter : solution.points;
		}
		else
		{
			simplify( path, m_si,
			    [&]( const og::PathGeometric& now )
			    { return !was_certified || certify( m_bench, pointsOf( now, *m_engine ), def ).all(); } );
			shorter = unwrapped( pointsOf( path, *m_engine ) );
		}
		solution.simplified = shorter != solution.points;
		solution.points = shorter;
		solution.edges = certify( m_bench, shorter, def );
		solution.seconds.simplify = now() - simplify_begin;
	}

	// Free travel at the ends, and pairs in the way of the straight motions between them: of OMPL's planners nothing else is known.
	planners::Stuck explainEnds() const
	{
		if ( !( m_range > 0 ) )
		{
			return {};
		}
		planners::Settings settings = planners::settingsOf( *m_engine );
		settings.edge = edgeDef( m_options );
		settings.most_nodes = 2; // the ends
		planners::Planner planner( m_bench.problem().checker, settings );
		planner.addStart( m_start.data() );
		for ( const std::vector<double>& goal : m_goals )
		{
			planner.addGoal( goal.data() );
		}
		const Query query = makeQuery( m_bench.checker() );
		planner.solve( query.get() );
		planners::Stuck stuck = planner.explain( query.get() );
		stuck.trees[0] = stuck.trees[1] = {};
		return stuck;
	}

	// Shorter paths from the start to any of the goals, for as long as was asked for.
	void optimize( Solution& solution )
	{
		if ( !( m_options.optimize > 0 ) )
		{
			return;
		}
		if ( !( m_range > 0 ) )
		{
			throw io::Error( "command line", "--optimize", "group " + m_bench.problem().group + " has a floating joint",
			    "leave it out, or name a planner that uses all the time (leeway plan --help-all)" );
		}
		const Progress progress( "looking for shorter paths" );
		planners::OptimizeSettings settings;
		settings.search = planners::settingsOf( *m_engine );
		settings.search.edge = edgeDef( m_options );
		settings.search.seed = solution.path_seed;
		for ( const std::vector<double>& goal : m_goals )
		{
			settings.goals.insert( settings.goals.end(), goal.begin(), goal.end() );
		}
		planners::Stop stop;
		stop.seconds = m_options.optimize;
		planners::Path path = flat( solution.points );
		const Query query = makeQuery( m_bench.checker() );
		const double begin = now();
		require(
		    planners::optimize( m_bench.checker(), query.get(), settings, stop, path, &solution.shorter ), "--optimize" );
		solution.seconds.optimize = now() - begin;
		const Points points = unwrapped( pointsOf( path ) );
		const Edges edges = certify( m_bench, points, settings.search.edge );
		if ( edges.all() )
		{
			solution.points = points;
			solution.edges = edges;
		}
	}

	// Pushes the path away from near obstacles and links.
	void pushAway( Solution& solution )
	{
		if ( !( m_options.clearance_goal > 0 ) )
		{
			return;
		}
		if ( !( m_range > 0 ) )
		{
			throw io::Error( "command line", "--clearance-goal",
			    "group " + m_bench.problem().group + " has a floating joint", "leave it out" );
		}
		planners::ClearanceSettings settings;
		settings.edge = edgeDef( m_options );
		settings.goal = m_options.clearance_goal;
		planners::Path path = flat( solution.points );
		const Query query = makeQuery( m_bench.checker() );
		planners::ClearanceReport report;
		require(
		    planners::raiseClearance( m_bench.checker(), query.get(), settings, {}, path, &report ), "--clearance-goal" );
		const Points points = unwrapped( pointsOf( path ) );
		const Edges edges = certify( m_bench, points, settings.edge );
		if ( !edges.all() ) // as numbers that go on without jumps
		{
			report.changed = false;
			report.length_after = report.length_before;
			report.notice = "the better path is not proved with the numbers of the start";
			for ( planners::ClearanceChange* change : { &report.environment, &report.self } )
			{
				change->after = change->before;
				change->middle_after = change->middle_before;
			}
		}
		if ( report.changed )
		{
			solution.points = points;
			solution.edges = edges;
		}
		solution.clearance = report;
	}

	const PlanOptions& m_options;
	const Workbench& m_bench;
	const std::vector<double> m_start;
	const Points m_goals; // alternatives
	ob::StateSpacePtr m_space;
	ob::SpaceInformationPtr m_si;
	std::shared_ptr<const ::leeway::ompl::Engine> m_engine;
	std::shared_ptr<planners::OmplPlanner> m_native; // if it was tried
	double m_range = 0;                              // suits the robot; 0: spaces with rotations
};

ik::GoalStates solvePoses( const PlanOptions& options, const Input& input, const Workbench& bench, const PlanEnds& ends )
{
	ik::Options settings;
	settings.seed = options.seed;
	settings.min_d = options.common.min_d;
	settings.flags = options.common.checkFlags();
	settings.states = options.goal_states > 0 ? options.goal_states : settings.states;
	ik::GoalStates goals = ik::findGoalStates( input.robot, bench.problem(), *input.request, settings );
	if ( goals.states.empty() )
	{
		throw io::Error( ends.goal.file, ends.goal.element, goals.problem, goals.remedy );
	}
	return goals;
}

void noteEnd( const EndPlace& end, const std::vector<std::string>& violations, Notices& notices )
{
	for ( const std::string& violation : violations )
	{
		notices.add( "joint limits", fmt::format( "{}: {}: {}; it is used unchanged", end.file, end.element, violation ) );
	}
}

Solution solve(
    const PlanOptions& options, const Input& input, const Workbench& bench, const PlanEnds& ends, Notices& notices )
{
	const io::Request& request = *input.request;
	const std::vector<double> start = io::startState( bench.problem() );
	requireUsable( options, bench, ends.start, start );
	noteEnd( ends.start, limitViolations( bench.robot(), bench.fullState( start ) ), notices );
	ik::GoalStates goals;
	const double begin = now();
	if ( request.hasPoseGoal() )
	{
		goals = solvePoses( options, input, bench, ends );
	}
	else
	{
		const std::vector<double> goal = io::goalState( bench.problem(), request );
		goals.states = ends.goal_is_random ? wholeTurns( bench.problem(), goal ) : Points{ goal };
		requireUsable( options, bench, ends.goal, goals.states.front() );
		noteEnd( ends.goal, groupLimitViolations( bench.problem(), goals.states.front() ), notices );
	}
	const double ik_seconds = now() - begin;
	const OmplMessages messages( notices, options.common.verbose );
	try
	{
		::ompl::RNG::setSeed( options.seed );
		Solution solution = Planning( options, bench, start, goals.states, notices ).solve( timeLimit( options, request ) );
		solution.goals = std::move( goals );
		solution.ik_seconds = ik_seconds;
		return solution;
	}
	catch ( const ::ompl::Exception& error )
	{
		throw io::Error( "command line", "--planner " + ( options.planner.empty() ? "(default)" : options.planner ),
		    error.what(), "choose another planner" );
	}
	catch ( const std::invalid_argument& error )
	{
		throw io::Error(
		    options.common.robot, "group " + bench.problem().group, error.what(), "correct the joint's limits" );
	}
}

TrajectorySettings trajectorySettings( const PlanOptions& options, const JointLimits& limits )
{
	TrajectorySettings settings;
	settings.edge.min_d = options.common.min_d;
	settings.edge.flags = options.common.checkFlags();
	settings.edge.slack = options.edge.slack;
	settings.limits = limits;
	return settings;
}

/// The trajectory along the path, proved as it is driven.
TrajectoryAudit writeTrajectory( const Input& input, const Workbench& bench, const Solution& solution,
    const MotionLimits& motion, const TrajectorySettings& settings, double path_tolerance, OutputFile& file )
{
	const TrajectoryFile timed = timedPath( bench.problem(), solution.points, motion, { settings.edge, path_tolerance } );
	file.text = robotTrajectory( timed );
	return auditTrajectory( bench.problem(), input.robot, timed.file,
	    segmentsOf( bench.problem(), timed, settings.interpolation, 0 ), settings );
}

/// Tables only save work: a plan that finds none in the cache takes less time without them than they take.
std::optional<io::ReachOptions> laterTables( Input& input )
{
	const std::optional<io::ReachOptions> tables = input.reach;
	if ( input.reach )
	{
		input.reach->build = false;
	}
	return tables;
}

/// Seconds for motion hulls, beside those of --proofs: whoever has an answer wants the prompt back.
constexpr double hulls_time = 1;

/// For later runs, when the answer is written.
void proveTables( const PlanOptions& options, const Workbench& bench, const io::ReachOptions& tables )
{
	const bool unfinished = tables.def.seconds > 0 && !bench.reach().info.complete;
	if ( bench.reach().reach && !unfinished )
	{
		return;
	}
	const double seconds = hulls_time + tables.def.seconds;
	tell(
	    "leeway: the answer is complete; for later runs this one proves for at most {:g} s which links never meet (--no-cache declines)\n",
	    seconds );
	if ( !bench.proveTables( tables, seconds ) )
	{
		tell(
		    "leeway: the robot's motion hulls take longer, and are not kept; `leeway info --robot {} --proofs 10` makes them\n",
		    options.common.robot );
	}
}

AuditSettings auditSettings( const PlanOptions& options )
{
	AuditSettings settings;
	settings.min_d = options.common.min_d;
	settings.resolution = options.resolution;
	settings.flags = options.common.checkFlags();
	return settings;
}

/// The audit of a path that was found, and of its ends. A random goal is the state at which the path ends.
Audit auditSolution(
    io::Request& request, const Workbench& bench, const PlanEnds& ends, const AuditSettings& settings, Solution& solution )
{
	Audit audit;
	if ( solution.solved )
	{
		ends.goal_is_random ? setGoal( request, bench.problem(), solution.points.back() ) : void();
		audit = audited( bench, solution.points, settings, request.file );
		auditEnds( bench.problem(), request, solution.points, audit );
		solution.seconds.audit = audit.seconds;
	}
	return audit;
}

/// Plans of requests with items, waypoints or constraints along the path. @return their exit status; none: the request has none of these
std::optional<int> runAlongPath( const PlanOptions& options )
{
	io::PathConstraints path;
	options.common.request.empty()
	    ? io::Request()
	    : io::loadConstrainedRequest( options.common.request, path, loadOptionsOf( options.common ) );
	const bool plain = path.items.empty() && !path.way && path.empty();
	return plain                 ? std::optional<int>()
	       : !path.items.empty() ? runSequence( options )
	       : path.way            ? runLine( options )
	                             : runConstrainedPlan( options );
}

} // namespace

int runPlan( const PlanOptions& options )
{
	if ( const std::optional<int> status = runAlongPath( options ) )
	{
		return *status;
	}
	Notices notices( options.common.verbose );
	planners::requireThreads( planners::findPlanner( plannersOf( options ).front() ), options.threads );
	JointLimits limits = limitsOfFile( options.joint_limits );
	OutputFile out( "--out", options.out ), report( "--report", options.report ),
	    timed( "--trajectory", options.trajectory );
	CertificateFile certificate( options.certificate );
	ViewFile view( options.view );
	Input input = loadInput( options.common, notices );
	note( limits, options.joint_limits, input.robot, notices );
	input.max_d = options.common.min_d + planning_horizon;
	const std::optional<io::ReachOptions> tables = laterTables( input );
	const PlanEnds ends = readEnds( options, input );
	Workbench bench( input, ends.group, {}, notices );
	const bool wants_trajectory = !options.trajectory.empty();
	const MotionLimits motion = wants_trajectory ? motionLimits( bench.problem(), input.robot, limits ) : MotionLimits();
	noteUsual( motion, notices );
	Solution solution = solve( options, input, bench, ends, notices );
	const AuditSettings settings = auditSettings( options );
	const Audit audit = auditSolution( *input.request, bench, ends, settings, solution );
	const bool good = solution.solved && audit.valid && solution.edges.all();
	std::vector<OutputFile*> files;
	std::string driven;
	bool is_driven_free = good;
	if ( good && wants_trajectory )
	{
		const TrajectorySettings as_driven = trajectorySettings( options, limits );
		const TrajectoryAudit proof =
		    writeTrajectory( input, bench, solution, motion, as_driven, options.path_tolerance, timed );
		driven = describe( proof );
		is_driven_free = proof.valid();
		if ( is_driven_free )
		{
			files.push_back( &timed );
		}
	}
	if ( !options.report.empty() )
	{
		report.text = reportText( reportJson( options, input, bench, solution ),
		    solution.solved ? toJson( audit, settings ) : Json( nullptr ), good && is_driven_free );
		files.push_back( &report );
	}
	if ( good )
	{
		out.text = writePath( pathFile( options, input, bench, solution, audit ) );
		files.push_back( &out );
	}
	const bool is_certified =
	    !good || certificate.write( bench.problem(), input, certify::piecesOf( bench.problem(), solution.points ),
	                 claimOf( options.common.min_d, settings.flags, filesOf( options.common, "" ) ), "the path", files );
	if ( view.isWanted() )
	{
		view.write( planPage( options, input, bench, solution, audit ), files );
	}
	commitTogether( files );
	if ( !solution.solved )
	{
		tellNoPath( options, bench, solution );
	}
	else
	{
		// The path itself goes to standard output if no file was named; the summary must not mix with it.
		const std::string text =
		    summary( options, solution ) + describe( audit, settings, solution.points.size() ) + driven + certificate.told();
		out.path().empty() ? tell( "{}", text ) : printOut( text );
		tellWhatIsNotWritten( audit, good, is_driven_free );
	}
	if ( tables )
	{
		proveTables( options, bench, *tables );
	}
	return good && is_driven_free && is_certified ? exit_yes : exit_no;
}

} // namespace leeway::cli
