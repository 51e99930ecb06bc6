// SPDX-License-Identifier: BSD-3-Clause
// Two trees on the manifold (Kuffner, LaValle, RRT-Connect, 2000; Berenson et al., CBiRRT, 2009), then shortcuts along it, then time. Without constraints
// the path is that of leeway/planners/planner.hpp.
#include "leeway/manifold/plan.hpp"

#include "drive.hpp"
#include "free_path.hpp"
#include "ik/random.hpp"
#include "tree.hpp"

#include <algorithm>
#include <chrono>
#include <numeric>
#include <utility>

namespace leeway::manifold
{
namespace
{

constexpr double range = 2; // of one growth towards a sample, in joint space
constexpr double growth_step =
    0.29; // trees and shortcuts take the first step or none: other tries cost less than its halves
constexpr std::size_t small_steps = 16; // of so many samples one goes by halves of steps too, for narrow places
constexpr double near_samples = 1.5;    // radians or metres about a node, for half of the samples
constexpr double far_limits = 100;      // radians or metres: samples are drawn about the start instead
constexpr double least_saving = 0.01;   // of a path's length, by a shortcut
constexpr int mend_tries = 100;         // states that are led to the constraints
constexpr double mend_spread = 0.3;     // radians or metres about the start
constexpr std::size_t excluded_tries = 200;
constexpr std::size_t least_proved_per_failure = 4; // of proofs that waited; else none waits

class Clock
{
public:
	double seconds() const { return std::chrono::duration<double>( std::chrono::steady_clock::now() - m_begin ).count(); }

private:
	std::chrono::steady_clock::time_point m_begin = std::chrono::steady_clock::now();
};

class Planning
{
public:
	Planning( const io::RobotModel& robot, const io::Problem& problem, const io::PathConstraints& path, const Task& task,
	    const Settings& settings )
	    : m_task( task ), m_settings( settings ), m_is_free( path.empty() ), m_manifold( robot, problem, path ),
	      m_query( makeQuery( problem.checker.get() ) ), m_walker( m_manifold, problem, settings.edge, m_query.get() ),
	      m_random( settings.seed ), m_free_path( problem, m_query.get(), m_walker )
	{
		require( task.start );
		for ( const std::vector<double>& goal : task.goals )
		{
			require( goal );
		}
		if ( task.goals.empty() )
		{
			throw std::invalid_argument( "planPath: there is no goal" );
		}
	}

	Result run()
	{
		if ( takeStart() && takeGoals() )
		{
			std::vector<Piece> path;
			const bool found = standsAtGoal() || ( m_is_free ? goStraight( path ) || searchFreely( path ) : search( path ) );
			m_result.outcome = found ? Outcome::SOLVED : Outcome::TIMED_OUT;
			m_result.search_seconds = m_clock.seconds();
			if ( m_result.solved() )
			{
				m_result.raw_length = lengthOf( path );
				m_free_path.isFound() ? m_free_path.smooth( m_settings, stopOf(), path )
				: path.empty()        ? void()
				                      : shorten( path );
				m_result.length = lengthOf( path );
				m_result.shortcut_seconds = m_clock.seconds() - m_result.search_seconds;
				finish( path );
			}
		}
		m_result.start_nodes += m_trees[0].size();
		m_result.goal_nodes += m_trees[1].size();
		return m_result;
	}

private:
	void require( const std::vector<double>& q ) const
	{
		if ( q.size() != m_manifold.variables() )
		{
			throw std::invalid_argument( "planPath: a state has " + std::to_string( q.size() ) + " values, the group " +
			                             std::to_string( m_manifold.variables() ) );
		}
	}

	static State stateOf( const std::vector<double>& q )
	{
		return Eigen::Map<const State>( q.data(), static_cast<Eigen::Index>( q.size() ) );
	}

	bool fail( Outcome outcome, std::vector<std::string> reasons = {} )
	{
		m_result.outcome = outcome;
		m_result.reasons = std::move( reasons );
		return false;
	}

	bool takeStart()
	{
		m_start = stateOf( m_task.start );
		if ( !m_walker.isFree( m_start ) )
		{
			return fail( Outcome::START_NOT_FREE, { "the start is not proved free" } );
		}
		const std::vector<std::string> broken = m_manifold.violations( m_start.data() );
		if ( !broken.empty() && !( m_task.mend_start && mend() ) )
		{
			return canBeKept()
			           ? fail( m_task.mend_start ? Outcome::START_NOT_FREE : Outcome::START_BROKEN,
			                 m_task.mend_start ? std::vector<std::string>{ "no straight motion to a state that keeps the "
			                                                               "constraints is proved free" }
			                                   : broken )
			           : fail( Outcome::EXCLUDED, broken );
		}
		m_trees[0].addRoot( m_start );
		return true;
	}

	/// A straight motion to the nearest state that keeps the constraints, or to one of its neighbours.
	bool mend()
	{
		std::vector<std::pair<double, State>> found;
		for ( int i = 0; i < mend_tries; ++i )
		{
			State q = m_start;
			for ( Eigen::Index k = 0; k < q.size(); ++k )
			{
				q[k] += i == 0 ? 0 : m_random.between( -mend_spread, mend_spread );
			}
			if ( m_manifold.project( q.data() ) && m_manifold.violations( q.data() ).empty() && m_walker.isFree( q ) )
			{
				found.emplace_back( ( q - m_start ).norm(), q );
			}
		}
		std::sort( found.begin(), found.end(), []( const auto& a, const auto& b ) { return a.first < b.first; } );
		for ( const auto& [distance, q] : found )
		{
			if ( m_walker.isClear( straightPiece( m_start, q ) ) )
			{
				m_mend = { straightPiece( m_start, q ) };
				m_result.mended_distance = distance;
				m_start = q;
				return true;
			}
		}
		return false;
	}

	/// Is there any state, free or not?
	bool canBeKept()
	{
		for ( std::size_t i = 0; i < excluded_tries; ++i )
		{
			State q = i == 0 ? m_start : drawn( m_start, far_limits );
			if ( m_manifold.project( q.data() ) )
			{
				return true;
			}
		}
		return false;
	}

	bool takeGoals()
	{
		std::vector<std::string> reasons;
		bool kept = false;
		for ( const std::vector<double>& goal : m_task.goals )
		{
			const State q = stateOf( goal );
			const std::vector<std::string> broken = m_manifold.violations( q.data() );
			reasons = reasons.empty() ? broken : reasons;
			kept = kept || broken.empty();
			if ( broken.empty() && m_walker.isFree( q ) )
			{
				m_trees[1].addRoot( q );
			}
		}
		return m_trees[1].size() > 0 ||
		       fail( kept ? Outcome::GOALS_NOT_FREE : Outcome::GOALS_BROKEN, kept ? std::vector<std::string>() : reasons );
	}

	/// The range of a variable that samples come from.
	std::pair<double, double> drawnFrom( Eigen::Index variable ) const
	{
		const double lower = m_manifold.lower()[variable], upper = m_manifold.upper()[variable], at = m_start[variable];
		return upper - lower < far_limits ? std::pair( lower, upper )
		                                  : std::pair( std::max( lower, at - M_PI ), std::min( upper, at + M_PI ) );
	}

	/// A random state within a distance of another, in each variable.
	State drawn( const State& about, double distance )
	{
		State q = about;
		for ( Eigen::Index i = 0; i < q.size(); ++i )
		{
			const auto [least, most] = drawnFrom( i );
			const double from = std::max( least, about[i] - distance ), to = std::min( most, about[i] + distance );
			q[i] = from < to ? m_random.between( from, to ) : std::clamp( about[i], least, most );
		}
		return q;
	}

	bool isOver() const
	{
		return m_clock.seconds() > m_settings.seconds || m_trees[0].size() + m_trees[1].size() > m_settings.most_nodes ||
		       ( m_settings.stop && m_settings.stop() );
	}

	/// Most nodes end on no path: pieces are found and proved when the trees meet, unless too many of these proofs fail, as beside thin walls.
	bool proofsWait() const { return m_late_failed * least_proved_per_failure <= m_late_proved; }

	/// Proves what waited on the way from the root to a node. Where that fails, all nodes behind leave the tree.
	bool prove( Tree& tree, std::size_t node )
	{
		std::vector<std::size_t> nodes = tree.unproved( node );
		while ( !nodes.empty() )
		{
			const bool proved = m_walker.prove( tree.pieces( nodes.back() ) );
			++( proved ? m_late_proved : m_late_failed );
			if ( !proved )
			{
				tree.cut( nodes.back() );
				return false;
			}
			nodes.pop_back();
		}
		return true;
	}

	/// Grows a tree towards a state. @return true: it is reached. @param node the new one, or that from which nothing was proved
	bool grow( Tree& tree, const State& to, double most, std::size_t& node )
	{
		const std::size_t from = tree.nearest( m_walker.turns(), to );
		std::vector<Piece> way;
		const double least = m_result.samples % small_steps == 0 ? least_step : growth_step;
		const bool reached = m_walker.walk( tree.state( from ), to, { most, least, false, proofsWait() }, way );
		node = tree.addWay( from, way );
		return reached;
	}

	/// A straight motion to a goal.
	bool standsAtGoal() const
	{
		bool stands = false;
		for ( std::size_t goal = 0; goal < m_trees[1].size(); ++goal )
		{
			stands = stands || m_trees[1].state( goal ) == m_start;
		}
		return stands;
	}

	bool goStraight( std::vector<Piece>& path )
	{
		for ( std::size_t goal = 0; goal < m_trees[1].size(); ++goal )
		{
			const Piece straight = straightPiece( m_start, m_walker.nearestTurns( m_start, m_trees[1].state( goal ) ) );
			if ( m_walker.isProved( straight ) )
			{
				path = { straight };
				return true;
			}
		}
		return false;
	}

	bool search( std::vector<Piece>& path )
	{
		for ( std::size_t goal = 0; goal < m_trees[1].size(); ++goal )
		{
			std::vector<Piece> way;
			if ( m_walker.walk(
			         m_trees[0].state( 0 ), m_trees[1].state( goal ), { HUGE_VAL, growth_step, false, true }, way ) &&
			     m_walker.prove( way ) )
			{
				path = way;
				return true;
			}
			m_trees[0].addWay( 0, way );
		}
		while ( !isOver() )
		{
			const std::size_t side = m_trees[0].size() <= m_trees[1].size() ? 0 : 1;
			Tree &tree = m_trees[side], &other = m_trees[1 - side];
			const bool near = m_random.unit() < 0.5;
			const std::size_t about = m_random.below( tree.size() );
			if ( near && tree.isCut( about ) )
			{
				continue;
			}
			State sample =
			    near ? drawn( tree.state( about ), near_samples * m_random.unit() ) : drawn( m_start, far_limits );
			++m_result.samples;
			if ( !m_manifold.project( sample.data() ) )
			{
				continue;
			}
			++m_result.projected;
			std::size_t node, met;
			const std::size_t before = tree.size();
			grow( tree, sample, range, node );
			if ( tree.size() > before && grow( other, tree.state( node ), HUGE_VAL, met ) && prove( tree, node ) &&
			     prove( other, met ) )
			{
				path = side == 0 ? joined( node, met ) : joined( met, node );
				return true;
			}
		}
		return false;
	}

	planners::Stop stopOf()
	{
		planners::Stop stop;
		stop.seconds = m_settings.seconds - m_clock.seconds();
		stop.poll = []( void* user ) { return static_cast<Planning*>( user )->isOver(); };
		stop.user = this;
		return stop;
	}

	/// Without constraints: by the planner of joint space.
	bool searchFreely( std::vector<Piece>& path )
	{
		planners::Settings settings;
		settings.edge = m_settings.edge;
		settings.seed = m_settings.seed;
		settings.most_nodes = m_settings.most_nodes;
		for ( Eigen::Index k = 0; k < m_start.size(); ++k )
		{
			const auto [lower, upper] = drawnFrom( k );
			settings.lower.push_back( lower );
			settings.upper.push_back( upper );
		}
		std::vector<State> goals;
		for ( std::size_t i = 0; i < m_trees[1].size(); ++i )
		{
			goals.push_back( m_trees[1].state( i ) );
		}
		try
		{
			return m_free_path.find( m_start, goals, settings, stopOf(), m_result, path );
		}
		catch ( const planners::InputError& )
		{
			return search( path ); // a floating joint, or an end beyond a limit by less than its tolerance
		}
	}

	/// @param start, goal nodes at one state, up to whole turns
	std::vector<Piece> joined( std::size_t start, std::size_t goal ) const
	{
		std::vector<Piece> path = m_trees[0].way( start ), back = m_trees[1].way( goal );
		const State turns = m_trees[0].state( start ) - m_trees[1].state( goal );
		for ( auto piece = back.rbegin(); piece != back.rend(); ++piece )
		{
			piece->reverse();
			piece->shift( turns );
			path.push_back( *piece );
		}
		return path;
	}

	/// Motions between random states of the path take the place of longer ones.
	void shorten( std::vector<Piece>& path )
	{
		for ( unsigned i = 0; i < m_settings.shortcuts && !isOver(); ++i )
		{
			const double n = static_cast<double>( path.size() );
			double from = m_random.between( 0, n ), to = m_random.between( 0, n );
			from > to ? std::swap( from, to ) : void();
			if ( i % 2 == 0 ) // ends of pieces
			{
				from = std::floor( from );
				to = std::ceil( to );
			}
			const auto a = std::min( static_cast<std::size_t>( from ), path.size() - 1 ),
			           b = std::min( static_cast<std::size_t>( to ), path.size() - 1 );
			const double s = from - static_cast<double>( a ), t = to - static_cast<double>( b );
			std::vector<Piece> middle(
			    path.begin() + static_cast<std::ptrdiff_t>( a ), path.begin() + static_cast<std::ptrdiff_t>( b ) + 1 );
			const State begin = path[a].at( s ), end = path[b].at( t );
			std::vector<Piece> head, way, tail;
			s > 0 ? head.push_back( path[a].part( 0, s ) ) : void();
			t < 1 ? tail.push_back( path[b].part( t, 1 ) ) : void();
			const double wanted = lengthOf( middle ) - least_saving * lengthOf( path );
			const double most = wanted - lengthOf( head ) - lengthOf( tail );
			if ( !( ( end - begin ).norm() < most ) ||
			     !m_walker.walk( begin, end, { most, growth_step, true, true }, way ) || !m_walker.prove( way ) )
			{
				continue;
			}
			way.insert( way.begin(), head.begin(), head.end() );
			way.insert( way.end(), tail.begin(), tail.end() );
			if ( lengthOf( way ) < wanted && isContinuous( way, path[b] ) )
			{
				path.erase(
				    path.begin() + static_cast<std::ptrdiff_t>( a ), path.begin() + static_cast<std::ptrdiff_t>( b ) + 1 );
				path.insert( path.begin() + static_cast<std::ptrdiff_t>( a ), way.begin(), way.end() );
			}
		}
	}

	/// A shortcut may turn a wrapping joint the other way round: then it ends a whole turn away.
	static bool isContinuous( const std::vector<Piece>& way, const Piece& last )
	{
		for ( std::size_t i = 1; i < way.size(); ++i )
		{
			if ( ( way[i].first() - way[i - 1].last() ).cwiseAbs().maxCoeff() > 1e-6 )
			{
				return false;
			}
		}
		return ( way.back().last() - last.last() ).cwiseAbs().maxCoeff() < 1e-6;
	}

	void finish( const std::vector<Piece>& path )
	{
		const double begin = m_clock.seconds();
		m_result.straight = static_cast<std::size_t>(
		    std::count_if( path.begin(), path.end(), []( const Piece& piece ) { return piece.degree == 1; } ) );
		m_result.bent = path.size() - m_result.straight;
		Driven mended;
		std::int64_t from = 0;
		if ( !m_mend.empty() )
		{
			mended = drive( m_walker, m_manifold, m_mend, m_settings.limits, false, 0 );
			m_result.mended = mended.segments.empty() ? 0 : mended.segments.back().begin + mended.segments.back().seconds;
			from = std::llround( 1e9 * m_result.mended );
		}
		Driven driven = drive( m_walker, m_manifold, path, m_settings.limits, true, from );
		m_result.rests = driven.rests;
		m_result.segments = mended.segments;
		m_result.segments.insert( m_result.segments.end(), driven.segments.begin(), driven.segments.end() );
		m_result.outcome = driven.proved && ( m_mend.empty() || mended.proved ) ? Outcome::SOLVED : Outcome::NOT_DRIVEN;
		m_result.drive_seconds = m_clock.seconds() - begin;
	}

	const Task& m_task;
	const Settings& m_settings;
	const bool m_is_free; ///< there are no constraints
	Manifold m_manifold;
	const Query m_query;
	Walker m_walker;
	ik::Random m_random;
	Clock m_clock;
	State m_start;
	std::vector<Piece> m_mend;
	FreePath m_free_path;
	Tree m_trees[2];                                  ///< of the start and of the goals
	std::size_t m_late_proved = 0, m_late_failed = 0; ///< pieces whose proof waited
	Result m_result;
};

} // namespace

Result planPath( const io::RobotModel& robot, const io::Problem& problem, const io::PathConstraints& path, const Task& task,
    const Settings& settings )
{
	return Planning( robot, problem, path, task, settings ).run();
}

} // namespace leeway::manifold
