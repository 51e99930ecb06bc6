// SPDX-License-Identifier: BSD-3-Clause
// OMPL's interface around the search: states to and from vectors, goals that come late, planner data.
#include "leeway/planners/ompl_planner.hpp"
#include "leeway/planners/optimize.hpp"

#include <ompl/base/goals/GoalSampleableRegion.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/base/spaces/SO2StateSpace.h>
#include <ompl/geometric/PathGeometric.h>
#include <ompl/util/Exception.h>

#include <algorithm>
#include <chrono>
#include <limits>

namespace leeway::planners
{

namespace ob = ::ompl::base;
namespace og = ::ompl::geometric;

namespace
{

constexpr double half_turn = 3.14159265358979323846;

struct Bounds
{
	std::vector<double> lower, upper;
};

/// Bounds of a space's numbers, in the order of the state vector.
void collect( const ob::StateSpace& space, Bounds& bounds )
{
	if ( space.isCompound() )
	{
		const auto& compound = *space.as<ob::CompoundStateSpace>();
		for ( unsigned i = 0; i < compound.getSubspaceCount(); ++i )
		{
			collect( *compound.getSubspace( i ), bounds );
		}
	}
	else if ( const auto* vector = dynamic_cast<const ob::RealVectorStateSpace*>( &space ) )
	{
		const ob::RealVectorBounds& own = vector->getBounds();
		bounds.lower.insert( bounds.lower.end(), own.low.begin(), own.low.end() );
		bounds.upper.insert( bounds.upper.end(), own.high.begin(), own.high.end() );
	}
	else if ( dynamic_cast<const ob::SO2StateSpace*>( &space ) != nullptr )
	{
		bounds.lower.push_back( -half_turn );
		bounds.upper.push_back( half_turn );
	}
	else
	{
		throw InputError( "leeway::planners: state space " + space.getName() +
		                  ": only RealVector, SO2 and compounds of them are supported; plan with one of OMPL's planners" );
	}
}

Bounds boundsOf( const leeway::ompl::Engine& engine )
{
	Bounds bounds;
	collect( *engine.adapter().space(), bounds );
	return bounds;
}

} // namespace

Settings settingsOf( const leeway::ompl::Engine& engine )
{
	const leeway::ompl::Options& options = engine.options();
	Settings settings;
	settings.edge.method = options.method;
	settings.edge.flags = options.flags;
	settings.edge.min_d = options.min_d;
	settings.edge.slack = options.slack;
	settings.edge.max_d = options.step;
	settings.edge.tolerance = options.tolerance.empty() ? nullptr : options.tolerance.data(); // the engine's
	Bounds bounds = boundsOf( engine );
	settings.lower = std::move( bounds.lower );
	settings.upper = std::move( bounds.upper );
	return settings;
}

double geometricRange( const leeway::ompl::Engine& engine )
{
	const Bounds bounds = boundsOf( engine );
	return geometricRange( engine.checker().get(), bounds.lower.data(), bounds.upper.data() );
}

/// OMPL's goals: the first one is waited for; then one more whenever the work has grown by an eighth since the last. The hundredth comes
/// after some ten thousand looks at the clock: of a region of which a small part can be reached, enough is drawn.
class OmplPlanner::Goals
{
public:
	Goals( OmplPlanner& planner, const ob::PlannerTerminationCondition& end ) : m_planner( planner ), m_end( end ) {}

	bool isOver() const { return m_end(); }

	/// Adds the goals that are there, after waiting for the first one if none was used so far.
	bool add()
	{
		const bool first = m_planner.pis_.getSampledGoalsCount() == 0;
		const ob::State* state = first ? m_planner.pis_.nextGoal( m_end ) : m_planner.pis_.nextGoal();
		if ( state == nullptr )
		{
			return false;
		}
		std::vector<double> q( m_planner.engine().adapter().size() );
		m_planner.engine().adapter().toVector( state, q.data() );
		m_planner.m_planner->addGoal( q.data() );
		m_planner.m_goals.insert( m_planner.m_goals.end(), q.begin(), q.end() );
		return true;
	}

	/// For Stop::poll: true if the search has to end, or to take a goal.
	static bool poll( void* user )
	{
		Goals& goals = *static_cast<Goals*>( user );
		goals.report();
		goals.m_due = ++goals.m_polls >= goals.m_next && goals.m_planner.pis_.haveMoreGoalStates();
		if ( goals.m_due )
		{
			goals.m_next = goals.m_polls + std::max( first_wait, goals.m_polls / 8 );
		}
		return goals.m_due || goals.m_end();
	}
	bool isDue() const { return m_due; }

	/// For Stop::poll of work that takes no goals.
	static bool pollEnd( void* user ) { return static_cast<Goals*>( user )->m_end(); }

private:
	void report()
	{
		if ( !m_planner.m_progress )
		{
			return;
		}
		const double seconds = std::chrono::duration<double>( std::chrono::steady_clock::now() - m_begin ).count();
		if ( seconds >= m_reported + m_planner.m_interval )
		{
			m_reported = seconds;
			m_planner.m_progress( m_planner.m_planner->planner( 0 ).growth(), seconds );
		}
	}

	OmplPlanner& m_planner;
	const ob::PlannerTerminationCondition& m_end;
	const std::chrono::steady_clock::time_point m_begin = std::chrono::steady_clock::now();
	double m_reported = 0;
	static constexpr std::uint64_t first_wait = 16;
	std::uint64_t m_polls = 0, m_next = first_wait;
	bool m_due = false;
};

OmplPlanner::OmplPlanner( const ob::SpaceInformationPtr& si ) : ob::Planner( si, "Leeway" )
{
	specs_.approximateSolutions = true;
	specs_.directed = true;
	specs_.recognizedGoal = ob::GOAL_SAMPLEABLE_REGION;
	Planner::declareParam<double>( "range", this, &OmplPlanner::setRange, &OmplPlanner::getRange, "0.:1.:10000." );
	Planner::declareParam<bool>( "optimize", this, &OmplPlanner::setOptimize, &OmplPlanner::getOptimize, "0,1" );
	Planner::declareParam<unsigned>( "seed", this, &OmplPlanner::setSeed, &OmplPlanner::getSeed, "0:1:4294967295" );
	Planner::declareParam<unsigned>( "threads", this, &OmplPlanner::setThreads, &OmplPlanner::getThreads, "1:1:64" );
}

OmplPlanner::~OmplPlanner()
{
	freeStates();
}

void OmplPlanner::freeStates()
{
	for ( ob::State* state : m_states )
	{
		si_->freeState( state );
	}
	m_states.clear();
}

const leeway::ompl::Engine& OmplPlanner::engine() const
{
	const auto* validator = dynamic_cast<const leeway::ompl::MotionValidator*>( si_->getMotionValidator().get() );
	if ( validator == nullptr || !validator->engine()->adapter().straight() )
	{
		throw ::ompl::Exception( getName(), "the motion validator is not leeway's; call leeway::ompl::install() first" );
	}
	return *validator->engine();
}

void OmplPlanner::setRange( double range )
{
	m_range = range;
	m_planner.reset();
}

void OmplPlanner::setThreads( unsigned threads )
{
	if ( threads < 1 || threads > Portfolio::most_threads )
	{
		throw ::ompl::Exception( getName(), "threads must be 1 to " + std::to_string( Portfolio::most_threads ) );
	}
	m_threads = threads;
	m_planner.reset();
}

void OmplPlanner::setSeed( unsigned seed )
{
	m_seed = seed;
	m_seed_given = true;
	m_planner.reset();
}

void OmplPlanner::setProgress( std::function<void( const Growth&, double )> progress, double interval )
{
	m_progress = std::move( progress );
	m_interval = interval;
}

void OmplPlanner::setOptimize( bool optimize )
{
	m_optimize = optimize;
	specs_.optimizingPaths = optimize;
}

std::uint64_t OmplPlanner::seed() const
{
	return m_planner ? m_planner->seed() : 0;
}

void OmplPlanner::setup()
{
	Planner::setup();
	try
	{
		const double suited = geometricRange( engine() ); // also refuses spaces that are not supported
		m_range = m_range > 0 ? m_range : suited;
	}
	catch ( const InputError& error )
	{
		setup_ = false;
		throw ::ompl::Exception( getName(), error.what() );
	}
}

void OmplPlanner::clear()
{
	Planner::clear();
	m_planner.reset();
	m_statistics = {};
	m_counted.clear();
	freeStates();
}

void OmplPlanner::makePlanner( const lw_checker* checker )
{
	Settings settings = settingsOf( engine() );
	settings.range = m_range;
	settings.seed =
	    m_seed_given ? m_seed : static_cast<std::uint64_t>( m_rng.uniformInt( 0, std::numeric_limits<int>::max() ) );
	m_planner = std::make_unique<Portfolio>( Checker::adopt( lw_checker_retain( checker ) ), settings, m_threads );
	m_checker = checker;
	m_statistics = {};
	m_counted.clear();
	m_starts.clear();
	m_goals.clear();
	pis_.restart(); // all starts and goals are new to it
}

bool OmplPlanner::addStarts()
{
	std::vector<double> q( engine().adapter().size() );
	while ( const ob::State* state = pis_.nextStart() )
	{
		engine().adapter().toVector( state, q.data() );
		m_planner->addStart( q.data() );
		m_starts.insert( m_starts.end(), q.begin(), q.end() );
	}
	return pis_.getSeenStartStatesCount() > 0;
}

Outcome OmplPlanner::search( const leeway::ompl::Engine::Lease& lease, Goals& goals )
{
	Stop stop;
	stop.poll = Goals::poll;
	stop.user = &goals;
	Outcome outcome = m_planner->solve( lease.query(), stop );
	while ( outcome == Outcome::CANCELLED && goals.isDue() && !goals.isOver() )
	{
		goals.add();
		outcome = m_planner->solve( lease.query(), stop );
	}
	return outcome;
}

namespace
{

void countWork( const leeway::ompl::Engine::Lease& lease, const Statistics& work )
{
	leeway::ompl::Counters counters;
	counters.states = work.states;
	counters.edges = work.edges;
	counters.free = work.free;
	counters.blocked = work.blocked;
	counters.undecided = work.undecided;
	counters.edge_queries = work.edge_queries;
	lease.count( counters );
}

} // namespace

/// The work since the last call goes to the engine.
void OmplPlanner::count( const leeway::ompl::Engine::Lease& lease )
{
	const Statistics now = m_planner->statistics();
	countWork( lease, now.since( m_statistics ) );
	std::vector<BlockingPair> pairs = m_planner->blockingPairs();
	for ( const BlockingPair& pair : pairs )
	{
		const auto known = std::find_if( m_counted.begin(), m_counted.end(),
		    [&]( const BlockingPair& p ) { return p.self == pair.self && p.a == pair.a && p.b == pair.b; } );
		const std::uint64_t more = pair.undecided - ( known != m_counted.end() ? known->undecided : 0 );
		if ( more > 0 )
		{
			lease.countUndecided( pair.self, pair.a, pair.b, more, pair.clearance );
		}
	}
	m_counted = std::move( pairs );
	m_statistics = now;
}

Stuck OmplPlanner::explain() const
{
	const leeway::ompl::Engine::Lease lease( engine() );
	return m_planner && lease && lease.checker() == m_checker ? m_planner->best().explain( lease.query() ) : Stuck();
}

void OmplPlanner::addPath( const Path& path, bool approximate, double distance )
{
	auto result = std::make_shared<og::PathGeometric>( si_ );
	ob::ScopedState<> state( si_ );
	for ( std::size_t i = 0; i < path.count(); ++i )
	{
		engine().adapter().fromVector( path[i], state.get() );
		result->append( state.get() );
	}
	pdef_->addSolutionPath( result, approximate, distance, getName() );
}

void OmplPlanner::addShortestPath( const leeway::ompl::Engine::Lease& lease, Goals& goals )
{
	Path path = m_planner->best().path();
	if ( m_optimize )
	{
		OptimizeSettings settings;
		settings.search = settingsOf( engine() );
		settings.search.range = m_range;
		settings.search.seed = m_planner->seed();
		settings.starts = m_starts;
		settings.goals = m_goals;
		Stop stop;
		stop.poll = Goals::pollEnd;
		stop.user = &goals;
		OptimizeReport report;
		optimize(
		    lease.checker(), lease.query(), settings, stop, path, &report ); // after a failure: the best path up to there
		countWork( lease, report.work );
	}
	addPath( path, false, 0 );
}

ob::PlannerStatus OmplPlanner::solve( const ob::PlannerTerminationCondition& end )
{
	checkValidity();
	const auto* goal = dynamic_cast<const ob::GoalSampleableRegion*>( pdef_->getGoal().get() );
	if ( goal == nullptr )
	{
		return ob::PlannerStatus::UNRECOGNIZED_GOAL_TYPE;
	}
	const leeway::ompl::Engine::Lease lease( engine() );
	if ( !lease )
	{
		return ob::PlannerStatus::CRASH; // no memory for a query
	}
	if ( !m_planner || m_checker != lease.checker() ) // edges that were proved in an older scene prove nothing
	{
		makePlanner( lease.checker() );
	}
	if ( !addStarts() )
	{
		return ob::PlannerStatus::INVALID_START;
	}
	Goals goals( *this, end );
	if ( !goal->couldSample() || ( pis_.getSampledGoalsCount() == 0 && !goals.add() ) )
	{
		return ob::PlannerStatus::INVALID_GOAL;
	}
	while ( goals.add() && pis_.getSampledGoalsCount() < goal->maxSampleCount() && pis_.getSampledGoalsCount() < 8 )
	{
	}
	const Outcome outcome = search( lease, goals );
	count( lease );
	switch ( outcome )
	{
	case Outcome::SOLVED:
		addShortestPath( lease, goals );
		return ob::PlannerStatus::EXACT_SOLUTION;
	case Outcome::NO_START:
		return ob::PlannerStatus::INVALID_START;
	case Outcome::NO_GOAL:
		return ob::PlannerStatus::INVALID_GOAL;
	case Outcome::FAILED:
		return ob::PlannerStatus::CRASH;
	case Outcome::TIMED_OUT:
	case Outcome::CANCELLED:
	case Outcome::NODES_FULL:
		break;
	}
	double distance = 0;
	const Path path = m_planner->approximatePath( &distance );
	if ( path.count() == 0 )
	{
		return ob::PlannerStatus::TIMEOUT;
	}
	addPath( path, true, distance );
	return ob::PlannerStatus::APPROXIMATE_SOLUTION;
}

void OmplPlanner::getPlannerData( ob::PlannerData& data ) const
{
	Planner::getPlannerData( data );
	if ( !m_planner )
	{
		return;
	}
	struct Visit
	{
		const OmplPlanner& planner;
		ob::PlannerData& data;
		std::vector<ob::State*> nodes[2];
	} visit{ *this, data, {} };
	m_planner->best().visitNodes(
	    []( void* user, bool of_goal, std::uint32_t parent, const double* q )
	    {
		    Visit& to = *static_cast<Visit*>( user );
		    ob::State* state = to.planner.si_->allocState();
		    to.planner.m_states.push_back( state );
		    to.planner.engine().adapter().fromVector( q, state );
		    std::vector<ob::State*>& nodes = to.nodes[of_goal];
		    nodes.push_back( state );
		    const int tag = of_goal ? 2 : 1;
		    if ( parent == LW_INVALID_INDEX )
		    {
			    of_goal ? to.data.addGoalVertex( ob::PlannerDataVertex( state, tag ) )
			            : to.data.addStartVertex( ob::PlannerDataVertex( state, tag ) );
			    return;
		    }
		    const ob::PlannerDataVertex from( nodes[parent], tag ), here( state, tag );
		    of_goal ? to.data.addEdge( here, from ) : to.data.addEdge( from, here );
	    },
	    &visit );
}

} // namespace leeway::planners
