// SPDX-License-Identifier: BSD-3-Clause
// Space and time: see timed_planner.hpp.
#include "leeway/planners/timed_planner.hpp"

#include "samples.hpp"
#include "timed_motion.hpp"
#include "validator.hpp"

#include <algorithm>
#include <cmath>

namespace leeway::planners
{

namespace
{

constexpr unsigned delays = 16;         ///< departures that are tried before the search
constexpr unsigned rests = 64;          ///< parts of the time before the deadline in which goals are asked to rest
constexpr unsigned samples_a_root = 20; ///< then a goal gets one more time of arrival
constexpr double longest_step = 0.25;   ///< of the time from corner to corner of the bounds
constexpr double no_way = 1e-9;         ///< seconds at full speed: states so near are one

/// Nodes in flat arrays.
struct TimedTree
{
	std::vector<double> states, times;
	std::vector<std::uint32_t> parents;

	std::size_t size() const { return times.size(); }
	std::uint32_t add( const double* q, std::size_t n, double time, std::uint32_t parent )
	{
		states.insert( states.end(), q, q + n );
		times.push_back( time );
		parents.push_back( parent );
		return static_cast<std::uint32_t>( times.size() - 1 );
	}
	void clear() { *this = {}; }
};

constexpr std::uint32_t none = 0xffffffffu;

} // namespace

struct TimedPlanner::Parts
{
	Parts( Checker given, TimedSettings s, const lw_clock& others )
	    : settings( std::move( s ) ), motion( std::move( given ), settings, others, statistics ), random( settings.seed )
	{
		const std::size_t n = settings.variables.size();
		needOfSettings( n > 0, "give variables, and a velocity for each" );
		needOfSettings( settings.deadline > settings.start_time && std::isfinite( settings.deadline ),
		    "deadline must come after start_time" );
		needOfSettings( settings.most_nodes >= 4 && settings.most_nodes < none, "most_nodes must be 4 to 2^32 - 2" );
		for ( std::size_t i = 0; i < n; ++i )
		{
			needOfSettings(
			    settings.velocity[i] > 0 && std::isfinite( settings.velocity[i] ), "velocities must be above 0 and finite" );
		}
		motion.findBounds( lower, upper );
		for ( std::size_t i = 0; i < n; ++i )
		{
			step = std::max( step, longest_step * ( upper[i] - lower[i] ) / settings.velocity[i] );
		}
		hold = std::isnan( settings.hold_until ) ? motion.othersEnd() : settings.hold_until;
		sample.resize( n );
		next.resize( n );
	}

	std::size_t size() const { return settings.variables.size(); }
	double least( const double* a, const double* b ) const { return motion.least( a, b ); }
	const double* goal( std::size_t i ) const { return goals.data() + i * size(); }
	std::size_t goalCount() const { return goals.size() / size(); }

	void requireInside( const double* q ) const
	{
		for ( std::size_t i = 0; i < size(); ++i )
		{
			const bool inside =
			    motion.wraps( i ) ? std::isfinite( q[i] ) : q[i] >= lower[i] - 1e-5 && q[i] <= upper[i] + 1e-5;
			if ( !inside )
			{
				throw InputError( "leeway::planners: TimedPlanner: value " + std::to_string( i ) +
				                  " of a start or goal is outside of its bounds; give a state within them" );
			}
		}
	}

	Outcome solve( lw_query* query, const Stop& stop );
	bool prepareGoals();
	bool prepareGoal( std::size_t g );
	double share( std::size_t i, double from, double to, double part ) const;
	bool isThere() const;
	bool goStraight();
	void addRoot();
	bool drawSample();
	bool grow( unsigned side );
	bool join( unsigned side, std::uint32_t node );
	std::uint32_t nearest( unsigned side, const double* q, double time ) const;
	void finish( std::uint32_t from_start, std::uint32_t from_goal );
	bool isFree( const TimedPath& whole, std::size_t from );
	void improve( Deadline& deadline );
	bool proveWhole();
	TimedPath made( std::vector<double> times, const std::vector<const double*>& states ) const;

	TimedSettings settings;
	Statistics statistics;
	TimedMotion motion;
	Random random;
	std::vector<double> lower, upper, start, goals;
	std::vector<double> rest_from; ///< [goals] arrivals from here on may be held; infinite: none
	double step = 0, hold = 0;
	TimedTree trees[2];
	std::vector<double> sample, next;
	double sample_time = 0;
	TimedPath path;
	std::string problem;
};

/// From when on a goal may rest until nobody needs to hold it, and whether it can be reached by then.
bool TimedPlanner::Parts::prepareGoal( std::size_t g )
{
	const double earliest = settings.start_time + least( start.data(), goal( g ) );
	if ( !( earliest <= settings.deadline ) )
	{
		problem = "goal " + std::to_string( g ) + ": takes " + std::to_string( earliest - settings.start_time ) +
		          " s at full speed, more than there are until the deadline";
		return false;
	}
	// Later arrivals than `until` are moments, which the motion there proves
	const double until = std::clamp( hold, earliest, settings.deadline ), end = std::max( hold, until );
	rest_from[g] = until;
	if ( !motion.isRestFree( goal( g ), until, end ) )
	{
		problem = "goal " + std::to_string( g ) + ": cannot rest from " + std::to_string( until ) + " to " +
		          std::to_string( end ) + " s: " + motion.lastPair();
		return until < std::min( settings.deadline, motion.othersEnd() );
	}
	for ( unsigned i = rests; i-- > 0; )
	{
		const double before = earliest + ( until - earliest ) * i / rests;
		if ( before < rest_from[g] && !motion.isRestFree( goal( g ), before, rest_from[g] ) )
		{
			break;
		}
		rest_from[g] = std::min( rest_from[g], before );
	}
	return true;
}

bool TimedPlanner::Parts::prepareGoals()
{
	rest_from.assign( goalCount(), HUGE_VAL );
	problem.clear();
	bool any = false;
	for ( std::size_t g = 0; g < goalCount(); ++g )
	{
		const bool usable = prepareGoal( g );
		rest_from[g] = usable ? rest_from[g] : HUGE_VAL;
		any = any || usable;
	}
	return any;
}

/// A number between two, the shorter way.
double TimedPlanner::Parts::share( std::size_t i, double from, double to, double part ) const
{
	return from + part * motion.difference( i, from, to );
}

/// The path of some states, on which the numbers of variables that wrap go on.
TimedPath TimedPlanner::Parts::made( std::vector<double> times, const std::vector<const double*>& states ) const
{
	TimedPath out;
	out.dimension = size();
	out.times = std::move( times );
	for ( std::size_t k = 0; k < states.size(); ++k )
	{
		for ( std::size_t i = 0; i < size(); ++i )
		{
			const bool follows = k > 0 && motion.wraps( i );
			out.values.push_back( follows ? share( i, out[k - 1][i], states[k][i], 1 ) : states[k][i] );
		}
	}
	return out;
}

/// Is the start a goal where it may stay?
bool TimedPlanner::Parts::isThere() const
{
	for ( std::size_t g = 0; g < goalCount(); ++g )
	{
		if ( least( start.data(), goal( g ) ) <= no_way && rest_from[g] <= settings.start_time + no_way )
		{
			return true;
		}
	}
	return false;
}

/// At full speed to each goal, now or after some waiting.
bool TimedPlanner::Parts::goStraight()
{
	for ( unsigned i = 0; i <= delays; ++i )
	{
		for ( std::size_t g = 0; g < goalCount(); ++g )
		{
			const double way = least( start.data(), goal( g ) );
			const double first = std::max( settings.start_time, rest_from[g] - way ), last = settings.deadline - way;
			const double depart = first + ( last - first ) * i / delays;
			if ( !( last >= first ) || !motion.isFree( start.data(), depart, goal( g ), depart + way ) )
			{
				continue;
			}
			if ( depart > settings.start_time && !motion.isRestFree( start.data(), settings.start_time, depart ) )
			{
				continue;
			}
			if ( depart > settings.start_time )
			{
				path = made( { settings.start_time, depart, depart + way }, { start.data(), start.data(), goal( g ) } );
			}
			else
			{
				path = made( { depart, depart + way }, { start.data(), goal( g ) } );
			}
			return true;
		}
	}
	return false;
}

/// One more time at which a goal is reached.
void TimedPlanner::Parts::addRoot()
{
	const std::size_t g = random.below( goalCount() );
	const double first = std::max( rest_from[g], settings.start_time + least( start.data(), goal( g ) ) );
	if ( first <= settings.deadline )
	{
		const bool early = trees[1].size() == 0 || random.uniform() < 0.2;
		trees[1].add( goal( g ), size(), early ? first : first + ( settings.deadline - first ) * random.uniform(), none );
	}
}

/// A state and a time that can be reached from the start, and from which a goal can be reached.
bool TimedPlanner::Parts::drawSample()
{
	++statistics.samples;
	for ( std::size_t i = 0; i < size(); ++i )
	{
		sample[i] = lower[i] + ( upper[i] - lower[i] ) * random.uniform();
	}
	// half of them near the way from the start to a goal
	if ( random.uniform() < 0.5 )
	{
		const double* g = goal( random.below( goalCount() ) );
		const double part = random.uniform(), off = random.uniform();
		for ( std::size_t i = 0; i < size(); ++i )
		{
			sample[i] = ( 1 - off ) * share( i, start[i], g[i], part ) + off * sample[i];
		}
	}
	double after = HUGE_VAL;
	for ( std::size_t g = 0; g < goalCount(); ++g )
	{
		after = rest_from[g] < HUGE_VAL ? std::min( after, least( sample.data(), goal( g ) ) ) : after;
	}
	const double first = settings.start_time + least( start.data(), sample.data() ), last = settings.deadline - after;
	sample_time = first + ( last - first ) * random.uniform();
	return last > first;
}

/// The node of a tree from which the place can be reached in time, or from which it comes in time, at the least cost: half of the time
/// between them, and the time at full speed.
std::uint32_t TimedPlanner::Parts::nearest( unsigned side, const double* q, double time ) const
{
	const TimedTree& tree = trees[side];
	std::uint32_t best = none;
	double cost = HUGE_VAL;
	for ( std::uint32_t i = 0; i < tree.size(); ++i )
	{
		const double between = side == 0 ? time - tree.times[i] : tree.times[i] - time;
		if ( !( between > 0 && 0.5 * between < cost ) )
		{
			continue;
		}
		const double way = least( tree.states.data() + i * size(), q );
		if ( way <= between && way + 0.5 * between < cost )
		{
			cost = way + 0.5 * between;
			best = i;
		}
	}
	return best;
}

/// A step towards the sample, half as long if that is not free. @return true if the trees have met
bool TimedPlanner::Parts::grow( unsigned side )
{
	TimedTree& tree = trees[side];
	const std::uint32_t near = nearest( side, sample.data(), sample_time );
	if ( near == none )
	{
		return false;
	}
	const std::vector<double> from( tree.states.begin() + static_cast<std::ptrdiff_t>( near * size() ),
	    tree.states.begin() + static_cast<std::ptrdiff_t>( ( near + 1 ) * size() ) );
	const double from_time = tree.times[near], way = std::abs( sample_time - from_time );
	double part = std::min( 1.0, step / way );
	for ( int i = 0; i < 2; ++i, part *= 0.5 )
	{
		for ( std::size_t k = 0; k < size(); ++k )
		{
			next[k] = share( k, from[k], sample[k], part );
		}
		const double time = from_time + part * ( sample_time - from_time );
		const bool free = side == 0 ? motion.isFree( from.data(), from_time, next.data(), time )
		                            : motion.isFree( next.data(), time, from.data(), from_time );
		if ( free )
		{
			return join( side, tree.add( next.data(), size(), time, near ) );
		}
	}
	return false;
}

/// Tries to join a new node with the other tree.
bool TimedPlanner::Parts::join( unsigned side, std::uint32_t node )
{
	const std::vector<double> q( trees[side].states.begin() + static_cast<std::ptrdiff_t>( node * size() ),
	    trees[side].states.begin() + static_cast<std::ptrdiff_t>( ( node + 1 ) * size() ) );
	const double time = trees[side].times[node];
	const std::uint32_t other = nearest( 1 - side, q.data(), time );
	if ( other == none )
	{
		return false;
	}
	const double* to = trees[1 - side].states.data() + other * size();
	const double to_time = trees[1 - side].times[other];
	const bool free =
	    side == 0 ? motion.isFree( q.data(), time, to, to_time ) : motion.isFree( to, to_time, q.data(), time );
	if ( free )
	{
		finish( side == 0 ? node : other, side == 0 ? other : node );
	}
	return free;
}

void TimedPlanner::Parts::finish( std::uint32_t from_start, std::uint32_t from_goal )
{
	std::vector<double> times;
	std::vector<const double*> states;
	for ( std::uint32_t i = from_start; i != none; i = trees[0].parents[i] )
	{
		times.insert( times.begin(), trees[0].times[i] );
		states.insert( states.begin(), trees[0].states.data() + i * size() );
	}
	for ( std::uint32_t i = from_goal; i != none; i = trees[1].parents[i] )
	{
		times.push_back( trees[1].times[i] );
		states.push_back( trees[1].states.data() + i * size() );
	}
	path = made( std::move( times ), states );
}

/// The motions of a path behind a state, and the rest behind it.
bool TimedPlanner::Parts::isFree( const TimedPath& whole, std::size_t from )
{
	bool free = true;
	for ( std::size_t i = from + 1; free && i < whole.count(); ++i )
	{
		free = motion.isFree( whole[i - 1], whole.times[i - 1], whole[i], whole.times[i] );
	}
	return free && motion.isRestFree( whole[whole.count() - 1], whole.times.back(), std::max( hold, whole.times.back() ) );
}

/// Cuts corners: from one point to a later one at full speed, and everything behind it as much earlier, or at the same time.
void TimedPlanner::Parts::improve( Deadline& deadline )
{
	for ( unsigned k = 0; k < settings.improvements && path.count() > 1 && !deadline.over(); ++k )
	{
		const std::size_t count = path.count();
		const std::size_t a = random.below( count - 1 ), b = a + 1 + random.below( count - 1 - a );
		const double way = least( path[a], path[b] ), saved = path.times[b] - path.times[a] - way;
		for ( const double earlier : { saved, 0.5 * saved, 0.0 } )
		{
			const bool same = b == a + 1 && !( earlier > 1e-6 );
			std::vector<double> times;
			std::vector<const double*> states;
			for ( std::size_t i = 0; i < count; i = i == a ? b : i + 1 )
			{
				times.push_back( path.times[i] - ( i < b ? 0 : earlier ) );
				states.push_back( path[i] );
			}
			if ( same || !( times[a + 1] > times[a] ) )
			{
				continue;
			}
			TimedPath shorter = made( std::move( times ), states );
			if ( isFree( shorter, a ) ) // all before it is as it was
			{
				path = std::move( shorter );
				break;
			}
		}
	}
}

/// The whole path with all that its controller may do.
bool TimedPlanner::Parts::proveWhole()
{
	return motion.isPathFree( path, settings.start_time, std::max( hold, path.times.back() + settings.lag ) );
}

Outcome TimedPlanner::Parts::solve( lw_query* query, const Stop& stop )
{
	Deadline deadline( stop );
	path = {};
	trees[0].clear();
	trees[1].clear();
	random = Random( settings.seed );
	if ( start.empty() || goals.empty() )
	{
		throw InputError( "leeway::planners: TimedPlanner: give a start and a goal before solve()" );
	}
	motion.begin( query );
	if ( !motion.isRestFree( start.data(), settings.start_time, settings.start_time ) )
	{
		problem = "the start is not free: " + motion.lastPair();
		return motion.status() == LW_OK ? Outcome::NO_START : Outcome::FAILED;
	}
	if ( !prepareGoals() )
	{
		return motion.status() == LW_OK ? Outcome::NO_GOAL : Outcome::FAILED;
	}
	bool found = isThere();
	if ( found )
	{
		path = made( { settings.start_time }, { start.data() } );
	}
	found = found || goStraight();
	trees[0].add( start.data(), size(), settings.start_time, none );
	for ( std::size_t k = 0; !found && !deadline.over() && motion.status() == LW_OK; ++k )
	{
		if ( trees[0].size() + trees[1].size() >= settings.most_nodes )
		{
			return Outcome::NODES_FULL;
		}
		if ( k % samples_a_root == 0 )
		{
			addRoot();
		}
		found = drawSample() && grow( k % 2 );
	}
	statistics.start_nodes += trees[0].size();
	statistics.goal_nodes += trees[1].size();
	if ( motion.status() != LW_OK )
	{
		return Outcome::FAILED;
	}
	if ( !found )
	{
		return deadline.outcome();
	}
	improve( deadline );
	if ( !proveWhole() )
	{
		problem = "the path was proved by parts, but not as a whole: " + motion.lastPair();
		path = {};
		return motion.status() == LW_OK ? Outcome::TIMED_OUT : Outcome::FAILED;
	}
	return Outcome::SOLVED;
}

std::vector<lw_timed_piece> TimedPath::pieces() const
{
	std::vector<lw_timed_piece> out;
	for ( std::size_t i = 1; i < count(); ++i )
	{
		out.push_back( { times[i - 1], times[i], 1, ( *this )[i - 1] } );
	}
	if ( count() == 1 )
	{
		out.push_back( { times[0], times[0] + 1, 0, values.data() } );
	}
	return out;
}

// ---- public ----------------------------------------------------------------------------------------------------------

TimedPlanner::TimedPlanner( Checker checker, TimedSettings settings, const lw_clock& others )
    : m_parts( std::make_unique<Parts>( std::move( checker ), std::move( settings ), others ) )
{
}
TimedPlanner::~TimedPlanner() = default;
TimedPlanner::TimedPlanner( TimedPlanner&& ) noexcept = default;
TimedPlanner& TimedPlanner::operator=( TimedPlanner&& ) noexcept = default;

void TimedPlanner::setStart( const double* q )
{
	m_parts->requireInside( q );
	m_parts->start.assign( q, q + m_parts->size() );
}

void TimedPlanner::addGoal( const double* q )
{
	m_parts->requireInside( q );
	m_parts->goals.insert( m_parts->goals.end(), q, q + m_parts->size() );
}

Outcome TimedPlanner::solve( lw_query* query, const Stop& stop )
{
	return m_parts->solve( query, stop );
}

const TimedPath& TimedPlanner::path() const
{
	return m_parts->path;
}

const Statistics& TimedPlanner::statistics() const
{
	return m_parts->statistics;
}

const std::string& TimedPlanner::endProblem() const
{
	return m_parts->problem;
}

lw_status TimedPlanner::failure() const
{
	return m_parts->motion.status();
}

} // namespace leeway::planners
