// SPDX-License-Identifier: BSD-3-Clause
#include "referee/region.hpp"

#include "leeway/near.h"
#include "motions/seconds.hpp"
#include "referee/columns.hpp"
#include "referee/polyhedron.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numeric>
#include <queue>

namespace leeway::referee
{
namespace
{

constexpr std::size_t measure_states = 2000; // random states that stand for the region's volume
constexpr int longest_descent = 30;          // steps
constexpr int deepening_steps = 40;
constexpr double deepening = 0.003; // metres in a step
constexpr double at_ends = 0.3;     // of random states: at the ends of their line, where IRIS regions collide most

Polyhedron polyhedronOf( const io::Problem& problem, const Region& region, Box& box )
{
	const std::vector<std::size_t> columns = groupColumns(
	    problem, region.joint_names, region.a.empty() ? 0 : region.a.front().size(), region.file, region.element );
	Polyhedron polyhedron( columns.size() );
	const auto wrong = [&]( const std::string& problem_, const char* remedy )
	{ throw io::Error( region.file, region.element, problem_, remedy ); };
	bool possible = true;
	for ( std::size_t row = 0; row < region.a.size(); ++row )
	{
		State a;
		for ( const std::size_t column : columns )
		{
			a.push_back( region.a[row][column] );
		}
		possible = polyhedron.add( std::move( a ), region.b[row] ) && possible;
	}
	for ( std::size_t i = 0; i < columns.size(); ++i )
	{
		const lw_variable_info info = lw_robot_variable( problem.robot.get(), problem.variables[i] );
		if ( lw_robot_joint_type( problem.robot.get(), info.joint ) == LW_JOINT_FLOATING )
		{
			wrong( "the group has a floating joint, whose turn is no region of numbers", "choose --group without it" );
		}
		const bool limited = !info.wraps;
		for ( const double sign : { -1.0, 1.0 } )
		{
			const double limit = sign < 0 ? -info.lower : info.upper;
			if ( limited && std::isfinite( limit ) )
			{
				State a( columns.size(), 0.0 );
				a[i] = sign;
				polyhedron.add( std::move( a ), limit );
			}
		}
		box.lower.push_back( limited ? info.lower : -HUGE_VAL );
		box.upper.push_back( limited ? info.upper : HUGE_VAL );
	}
	if ( !possible )
	{
		wrong( "a row of zeros demands the impossible: it has no states", "remove the region" );
	}
	return polyhedron;
}

class Judge
{
public:
	Judge( const io::Problem& problem, const Region& region, const RegionSettings& settings )
	    : m_problem( problem ), m_region( region ), m_settings( settings ),
	      m_polyhedron( polyhedronOf( problem, region, m_box ) ), m_query( makeQuery( problem.checker.get() ) ),
	      m_random( settings.seed )
	{
	}

	RegionVerdict run()
	{
		m_begin = std::chrono::steady_clock::now();
		const std::optional<State> inside = m_polyhedron.inside();
		if ( !inside )
		{
			throw io::Error( m_region.file, m_region.element, "no state inside of it was found within the joint limits",
			    "remove the region, or correct the order of its columns" );
		}
		m_verdict.verdict = search( *inside ) ? LW_VERDICT_BLOCKED : prove();
		if ( m_verdict.verdict == LW_VERDICT_BLOCKED )
		{
			deepen();
		}
		m_verdict.seconds = secondsSince( m_begin );
		return m_verdict;
	}

private:
	/// The nearest pair. @return true: at or below the margin
	bool collides( const State& q, lw_clearance& nearest, bool& self )
	{
		++m_verdict.states;
		const lw_state_result state = motions::measure(
		    m_problem.checker.get(), m_query.get(), q, m_settings.flags, nullptr, m_region.file, m_region.element );
		const bool environment = ( m_settings.flags & LW_CHECK_ENVIRONMENT ) != 0;
		self = ( m_settings.flags & LW_CHECK_SELF ) != 0 && ( !environment || state.self.upper < state.environment.upper );
		nearest = self ? state.self : state.environment;
		return nearest.upper <= m_settings.min_d;
	}

	/// Metres per radian of the clearance of a pair; empty if it has no direction.
	State derivative( const State& q, const lw_clearance& pair, bool self )
	{
		const lw_vec3 n{ pair.point_a.x - pair.point_b.x, pair.point_a.y - pair.point_b.y, pair.point_a.z - pair.point_b.z };
		const double size = std::sqrt( n.x * n.x + n.y * n.y + n.z * n.z );
		if ( !( size > 1e-9 ) || !std::isfinite( size ) )
		{
			return {};
		}
		State out( q.size(), 0.0 );
		for ( const bool second : { false, true } )
		{
			if ( second && !self )
			{
				continue;
			}
			std::vector<double> jacobian( 3 * q.size() );
			require( lw_checker_point_jacobian( m_problem.checker.get(), m_query.get(), q.data(), second ? pair.b : pair.a,
			             second ? pair.point_b : pair.point_a, jacobian.data() ),
			    "velocity of a point" );
			for ( std::size_t i = 0; i < q.size(); ++i )
			{
				out[i] += ( second ? -1 : 1 ) / size *
				          ( n.x * jacobian[i] + n.y * jacobian[q.size() + i] + n.z * jacobian[2 * q.size() + i] );
			}
		}
		return out;
	}

	bool found( State q )
	{
		// Rounding may have left a state of a face outside of it
		for ( int round = 0; round < 3 && !m_polyhedron.contains( q ); ++round )
		{
			for ( std::size_t i = 0; i < q.size(); ++i )
			{
				q[i] += 1e-9 * ( m_inside[i] - q[i] );
			}
		}
		lw_clearance pair;
		bool self;
		if ( !m_polyhedron.contains( q ) || !collides( q, pair, self ) )
		{
			return false;
		}
		m_verdict.q = m_verdict.worst = q;
		m_verdict.self = self;
		m_verdict.pair = self ? motions::nameSelf( m_problem.checker.get(), pair )
		                      : motions::nameEnvironment( m_problem.checker.get(), pair );
		return true;
	}

	/// Moves a state against a slope, within the region, until `metres` are lost along the tangent; by 0.3 rad at the most.
	/// @return false: the region lets it lose none
	bool move( State& q, const State& slope, double metres ) const
	{
		State down = slope;
		std::transform( down.begin(), down.end(), down.begin(), []( double value ) { return -value; } );
		m_polyhedron.alongFaces( q, down );
		const double gain = -std::inner_product( slope.begin(), slope.end(), down.begin(), 0.0 );
		if ( gain < 1e-6 )
		{
			return false;
		}
		const double size = std::sqrt( std::inner_product( down.begin(), down.end(), down.begin(), 0.0 ) );
		const double by = std::min( { metres / gain, 0.3 / size, ( 1 - 1e-9 ) * m_polyhedron.reach( q, down ) } );
		for ( std::size_t i = 0; i < q.size(); ++i )
		{
			q[i] += by * down[i];
		}
		return true;
	}

	/// Lessens the clearance from a state of the region.
	bool descend( State q )
	{
		++m_verdict.descents;
		lw_clearance pair;
		bool self;
		double least = std::numeric_limits<double>::infinity();
		int worse = 0;
		for ( int step = 0; step < longest_descent && worse < 4; ++step )
		{
			if ( collides( q, pair, self ) )
			{
				return found( q );
			}
			worse = pair.upper < least - 1e-4 ? 0 : worse + 1;
			least = std::min( least, pair.upper );
			const State slope = derivative( q, pair, self );
			// The clearance seen along the tangent ends a little beyond contact
			if ( slope.empty() || !move( q, slope, 1.1 * ( pair.upper - m_settings.min_d ) + 1e-4 ) )
			{
				return false;
			}
		}
		return false;
	}

	/// From the colliding state along the way in which the bodies come deeper into each other.
	void deepen()
	{
		State q = m_verdict.q;
		for ( int step = 0; step < deepening_steps; ++step )
		{
			std::optional<Contact> contact = deepestContact( m_problem, m_query.get(), q, m_settings.flags );
			++m_verdict.states;
			if ( !contact || ( step > 0 && !( m_verdict.depth < contact->depth ) ) )
			{
				return;
			}
			m_verdict.worst = q;
			m_verdict.depth = contact->depth;
			m_verdict.pair = contact->pair;
			m_verdict.self = contact->self;
			const State& slope = contact->slope;
			if ( !move( q, slope, deepening ) )
			{
				return;
			}
		}
	}

	bool search( const State& inside )
	{
		m_inside = inside;
		State q = inside;
		const auto in_time = [&] { return secondsSince( m_begin ) < m_settings.search_seconds; };
		while ( in_time() )
		{
			m_polyhedron.step( q, m_random, at_ends );
			if ( descend( q ) )
			{
				return true;
			}
		}
		return false;
	}

	struct Task
	{
		Box box;
		std::vector<std::uint32_t> states; ///< of the random ones, those in it
		bool operator<( const Task& other ) const { return states.size() < other.states.size(); }
	};

	/// Proves a box; else `levers` has metres per radian of each variable, for the points of the pair in the way.
	lw_verdict proveBox( const Box& box, State& middle, State& levers )
	{
		State tolerance;
		middle.clear();
		for ( std::size_t i = 0; i < box.lower.size(); ++i )
		{
			middle.push_back( 0.5 * ( box.lower[i] + box.upper[i] ) );
			// Not smaller by rounding
			tolerance.push_back( ( 1 + 1e-12 ) * std::max( box.upper[i] - middle[i], middle[i] - box.lower[i] ) + 1e-14 );
		}
		lw_edge_def def = lw_edge_def_default();
		def.min_d = m_settings.min_d;
		def.flags = m_settings.flags;
		def.close_windows = 0;
		def.tolerance = tolerance.data();
		lw_edge_result result;
		require( lw_checker_edge( m_problem.checker.get(), m_query.get(), middle.data(), middle.data(), &def, &result ),
		    "proof of a box" );
		m_verdict.states += result.queries;
		levers.assign( middle.size(), 1e-3 );
		if ( result.verdict == LW_VERDICT_UNDECIDED && result.pair.a != LW_INVALID_INDEX )
		{
			std::vector<double> jacobian( 3 * middle.size() );
			for ( const bool second : { false, true } )
			{
				if ( ( second && !result.self ) ||
				     lw_checker_point_jacobian( m_problem.checker.get(), m_query.get(), middle.data(),
				         second ? result.pair.b : result.pair.a, second ? result.pair.point_b : result.pair.point_a,
				         jacobian.data() ) != LW_OK )
				{
					continue;
				}
				for ( std::size_t i = 0; i < middle.size(); ++i )
				{
					levers[i] += std::hypot( jacobian[i], jacobian[middle.size() + i], jacobian[2 * middle.size() + i] );
				}
			}
		}
		return result.verdict;
	}

	lw_verdict prove()
	{
		std::vector<State> states;
		State q = m_inside;
		for ( std::size_t i = 0; i < measure_states; ++i )
		{
			for ( int k = 0; k < 5; ++k )
			{
				m_polyhedron.step( q, m_random, 0 );
			}
			states.push_back( q );
		}
		Task all{ m_box, {} };
		const bool bounded =
		    m_polyhedron.tighten( all.box ) &&
		    std::all_of( all.box.lower.begin(), all.box.lower.end(), []( double v ) { return std::isfinite( v ); } ) &&
		    std::all_of( all.box.upper.begin(), all.box.upper.end(), []( double v ) { return std::isfinite( v ); } );
		if ( !bounded )
		{
			return LW_VERDICT_UNDECIDED;
		}
		for ( std::uint32_t i = 0; i < states.size(); ++i )
		{
			all.states.push_back( i );
		}
		std::priority_queue<Task> open;
		open.push( std::move( all ) );
		const auto begin = std::chrono::steady_clock::now();
		std::size_t proved = 0;
		State middle, levers;
		while ( !open.empty() && secondsSince( begin ) < m_settings.proof_seconds )
		{
			const Task task = open.top();
			open.pop();
			const lw_verdict verdict = proveBox( task.box, middle, levers );
			if ( verdict == LW_VERDICT_FREE )
			{
				++m_verdict.boxes;
				proved += task.states.size();
				m_verdict.proved = double( proved ) / double( states.size() );
				continue;
			}
			if ( verdict == LW_VERDICT_BLOCKED && m_polyhedron.contains( middle ) && found( middle ) )
			{
				return LW_VERDICT_BLOCKED;
			}
			std::size_t widest = 0;
			for ( std::size_t i = 1; i < levers.size(); ++i )
			{
				const auto span = [&]( std::size_t k ) { return levers[k] * ( task.box.upper[k] - task.box.lower[k] ); };
				widest = span( i ) > span( widest ) ? i : widest;
			}
			for ( const bool upper : { false, true } )
			{
				Task half{ task.box, {} };
				( upper ? half.box.lower : half.box.upper )[widest] = middle[widest];
				if ( !m_polyhedron.tighten( half.box ) )
				{
					continue;
				}
				std::copy_if( task.states.begin(), task.states.end(), std::back_inserter( half.states ),
				    [&]( std::uint32_t i ) { return ( states[i][widest] >= middle[widest] ) == upper; } );
				open.push( std::move( half ) );
			}
		}
		return open.empty() ? LW_VERDICT_FREE : LW_VERDICT_UNDECIDED;
	}

	const io::Problem& m_problem;
	const Region& m_region;
	const RegionSettings& m_settings;
	Box m_box;
	Polyhedron m_polyhedron;
	Query m_query;
	std::mt19937_64 m_random;
	std::chrono::steady_clock::time_point m_begin;
	State m_inside;
	RegionVerdict m_verdict;
};

} // namespace

RegionVerdict judgeRegion( const io::Problem& problem, const Region& region, const RegionSettings& settings )
{
	return Judge( problem, region, settings ).run();
}

} // namespace leeway::referee
