// SPDX-License-Identifier: BSD-3-Clause
// A straight piece is tried first. Else states are projected one by one, and cubics with tangents of the manifold join them; halves where that fails.
#include "walk.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace leeway::manifold
{
namespace
{

constexpr double longest_step = 0.6, first_step = 0.3; // of states that are projected, in joint space
constexpr double step_growth = 1.5;
constexpr double most_drift = 0.5; // of a step, by projection
constexpr double least_gain = 0.1; // of a step, towards the end of the walk
constexpr int most_halvings = 5;   // of a cubic
constexpr int length_parts = 8;
constexpr double no_length = 1e-12;
constexpr double least_along = 0.7; // of a chord, along the constraints at its begin
constexpr double look_width = 0.1;  // radians or metres between the states of a chord that a look tests
constexpr std::uint32_t most_looks = 31;

} // namespace

// ---- pieces

State Piece::at( double t ) const
{
	const double s = 1 - t;
	return degree == 1 ? State( s * control( 0 ) + t * control( 1 ) )
	                   : State( s * s * s * control( 0 ) + 3 * s * s * t * control( 1 ) + 3 * s * t * t * control( 2 ) +
	                            t * t * t * control( 3 ) );
}

Piece Piece::part( double from, double to ) const
{
	if ( degree == 1 )
	{
		return straightPiece( at( from ), at( to ) );
	}
	const auto rate = [this]( double t )
	{
		const double s = 1 - t;
		return State( 3 * s * s * ( control( 1 ) - control( 0 ) ) + 6 * s * t * ( control( 2 ) - control( 1 ) ) +
		              3 * t * t * ( control( 3 ) - control( 2 ) ) );
	};
	return cubicPiece( at( from ), ( to - from ) * rate( from ), at( to ), ( to - from ) * rate( to ) );
}

double Piece::length() const
{
	if ( m_length < 0 && degree == 1 )
	{
		m_length = ( last() - first() ).norm();
	}
	else if ( m_length < 0 )
	{
		m_length = 0;
		State before = first();
		for ( int i = 1; i <= length_parts; ++i )
		{
			const State now = at( static_cast<double>( i ) / length_parts );
			m_length += ( now - before ).norm();
			before = now;
		}
	}
	return m_length;
}

void Piece::reverse()
{
	const Piece forward = *this;
	points.clear();
	for ( std::size_t i = degree + 1; i-- > 0; )
	{
		const State p = forward.control( i );
		points.insert( points.end(), p.data(), p.data() + p.size() );
	}
}

void Piece::shift( const State& by )
{
	const std::size_t count = variables();
	for ( std::size_t i = 0; i < points.size(); ++i )
	{
		points[i] += by[static_cast<Eigen::Index>( i % count )];
	}
}

Piece straightPiece( const State& a, const State& b )
{
	Piece piece;
	piece.points.assign( a.data(), a.data() + a.size() );
	piece.points.insert( piece.points.end(), b.data(), b.data() + b.size() );
	return piece;
}

Piece cubicPiece( const State& a, const State& from, const State& b, const State& to )
{
	Piece piece;
	piece.degree = 3;
	const State inner[2] = { a + from / 3, b - to / 3 };
	for ( const State* p : { &a, &inner[0], &inner[1], &b } )
	{
		piece.points.insert( piece.points.end(), p->data(), p->data() + p->size() );
	}
	return piece;
}

double lengthOf( const std::vector<Piece>& pieces )
{
	double sum = 0;
	for ( const Piece& piece : pieces )
	{
		sum += piece.length();
	}
	return sum;
}

// ---- walks

Walker::Walker( Manifold& manifold, const io::Problem& problem, const lw_edge_def& edge, lw_query* query )
    : m_manifold( manifold ), m_problem( problem ), m_edge( edge ), m_query( query ),
      m_lower( Eigen::Map<const State>( manifold.lower(), static_cast<Eigen::Index>( manifold.variables() ) ) ),
      m_upper( Eigen::Map<const State>( manifold.upper(), static_cast<Eigen::Index>( manifold.variables() ) ) )
{
	m_turns.resize( m_lower.size() );
	for ( Eigen::Index k = 0; k < m_turns.size(); ++k )
	{
		const std::uint32_t variable = problem.variables[static_cast<std::size_t>( k )];
		m_turns[k] = lw_robot_variable( problem.robot.get(), variable ).wraps ? 2 * M_PI : 0;
	}
}

State Walker::nearestTurns( const State& a, const State& b ) const
{
	State q = b;
	for ( Eigen::Index k = 0; k < q.size(); ++k )
	{
		q[k] = m_turns[k] > 0 ? a[k] + std::remainder( b[k] - a[k], m_turns[k] ) : b[k];
	}
	return q;
}

bool Walker::isFree( const State& q )
{
	bool free = false;
	require( lw_checker_is_free( m_problem.checker.get(), m_query, q.data(), m_edge.flags, m_edge.min_d, &free, nullptr ),
	    "clearance of a state" );
	++m_counts.states;
	return free;
}

/// Joint limits hold at control points, so on the curve too. Ends may be beyond by the tolerance of starts.
bool Walker::isWithin( const Piece& piece ) const
{
	const State ends[2] = { piece.first(), piece.last() };
	const State lower = m_lower.cwiseMin( ends[0] ).cwiseMin( ends[1] ),
	            upper = m_upper.cwiseMax( ends[0] ).cwiseMax( ends[1] );
	for ( std::size_t i = 0; i <= piece.degree; ++i )
	{
		const State p = piece.control( i );
		if ( ( p.array() < lower.array() ).any() || ( p.array() > upper.array() ).any() )
		{
			return false;
		}
	}
	return true;
}

bool Walker::isKept( const Piece& piece )
{
	++m_counts.proofs;
	const motions::Segment segment = { 0, 1, piece.degree, piece.points };
	return isWithin( piece ) && m_manifold.isInRange( piece.at( 0.5 ).data() ) &&
	       m_manifold.constraints().areKept( segment );
}

bool Walker::isClear( const Piece& piece )
{
	lw_edge_result r;
	require( lw_checker_curve( m_problem.checker.get(), m_query, piece.points.data(), piece.degree, &m_edge, &r ),
	    "clearance of a motion" );
	m_counts.queries += r.queries;
	const bool clear = r.verdict == LW_VERDICT_FREE;
	m_counts.proved += clear ? 1 : 0;
	m_counts.bent += clear && piece.degree > 1 ? 1 : 0;
	return clear;
}

/// Looks in lanes at states of a chord, and measures its end. A state that a look leaves open beside the scene is hardly ever free.
bool Walker::seemsClear( const Piece& chord, bool end_is_free )
{
	const double count = std::ceil( chord.length() / look_width );
	const auto looks = static_cast<std::uint32_t>( std::clamp( count - 1, 0.0, static_cast<double>( most_looks ) ) );
	m_states.clear();
	for ( std::uint32_t i = 1; i <= looks; ++i )
	{
		const State q = chord.at( i / ( looks + 1.0 ) );
		m_states.insert( m_states.end(), q.data(), q.data() + q.size() );
	}
	lw_verdict seen[most_looks];
	lw_check_flags open[most_looks];
	require( lw_checker_states( m_problem.checker.get(), m_query, m_states.data(), looks, m_edge.flags, m_edge.min_d,
	             LW_STATES_LANES, seen, open ),
	    "clearances of states" );
	m_counts.states += looks;
	bool good = true;
	for ( std::uint32_t i = 0; i < looks; ++i )
	{
		good = good && ( seen[i] == LW_VERDICT_FREE ||
		                   ( seen[i] == LW_VERDICT_UNDECIDED && ( open[i] & LW_CHECK_ENVIRONMENT ) == 0 ) );
	}
	return good && ( end_is_free || isFree( chord.last() ) );
}

/// Does the chord between two states of the constraints lead along them? Else they are on different parts.
bool Walker::leadsAlong( const State& a, const State& b )
{
	State along = b - a;
	const double chord = along.norm();
	m_manifold.makeTangent( a.data(), along.data() );
	return along.norm() > least_along * chord;
}

/// Appends a piece that keeps the constraints, if it is clear.
bool Walker::take( Piece& piece, std::vector<Piece>& out )
{
	piece.proved = isClear( piece );
	piece.proved ? out.push_back( piece ) : void();
	return piece.proved;
}

/// Proved pieces from a to b: a straight one, else a cubic along the manifold, else two halves.
bool Walker::join( const State& a, const State& b, int halvings, std::vector<Piece>& out )
{
	Piece straight = straightPiece( a, b );
	if ( isKept( straight ) )
	{
		return take( straight, out );
	}
	State from = b - a, to = b - a;
	m_manifold.makeTangent( a.data(), from.data() );
	m_manifold.makeTangent( b.data(), to.data() );
	const double chord = ( b - a ).norm();
	if ( !( from.norm() > no_length ) || !( to.norm() > no_length ) )
	{
		return false;
	}
	Piece bent = cubicPiece( a, chord / from.norm() * from, b, chord / to.norm() * to );
	if ( isKept( bent ) )
	{
		return take( bent, out );
	}
	if ( halvings == most_halvings )
	{
		return false;
	}
	State middle = bent.at( 0.5 );
	++m_counts.projections;
	const std::size_t before = out.size();
	const bool joined = m_manifold.project( middle.data() ) && ( middle - a ).norm() < chord &&
	                    ( middle - b ).norm() < chord && join( a, middle, halvings + 1, out ) &&
	                    join( middle, b, halvings + 1, out );
	joined ? void() : out.resize( before );
	return joined;
}

/// Appends a chord if it seems clear.
bool Walker::takeChord( const Piece& chord, bool end_is_free, std::vector<Piece>& out )
{
	const bool good = seemsClear( chord, end_is_free );
	good ? out.push_back( chord ) : void();
	return good;
}

/// join(), or a chord. @param stepped step() led from a to b: along the constraints, and b is free
bool Walker::link( const State& a, const State& b, const Reach& reach, bool stepped, std::vector<Piece>& out )
{
	if ( !reach.proofs_wait )
	{
		return join( a, b, 0, out );
	}
	return ( stepped || leadsAlong( a, b ) ) && takeChord( straightPiece( a, b ), stepped, out );
}

bool Walker::prove( std::vector<Piece>& way )
{
	std::vector<Piece> proved;
	for ( const Piece& piece : way )
	{
		if ( piece.proved )
		{
			proved.push_back( piece );
		}
		else if ( !join( piece.first(), piece.last(), 0, proved ) )
		{
			return false;
		}
	}
	way = std::move( proved );
	return true;
}

/// A state on the manifold, one step towards the end. @return false: there is none
bool Walker::step( const State& q, const State& to, double length, State& next )
{
	State direction = to - q;
	const double gap = direction.norm();
	m_manifold.makeTangent( q.data(), direction.data() );
	if ( !( direction.norm() > least_gain * gap ) )
	{
		return false;
	}
	const State ahead = q + length / direction.norm() * direction;
	next = ahead;
	++m_counts.projections;
	return m_manifold.project( next.data() ) && ( next - ahead ).norm() < most_drift * length &&
	       ( to - next ).norm() < gap - least_gain * length && isFree( next );
}

bool Walker::walk( const State& a, const State& b, const Reach& reach, std::vector<Piece>& out )
{
	const State to = nearestTurns( a, b );
	State q = a;
	double length = std::min( first_step, reach.most ), left = reach.most;
	Piece straight = straightPiece( a, to );
	const double gap = ( to - a ).norm();
	if ( !( gap > no_length ) )
	{
		out.push_back( straight );
		return true;
	}
	if ( gap <= reach.most && isKept( straight ) &&
	     ( reach.proofs_wait ? takeChord( straight, false, out ) : take( straight, out ) ) )
	{
		return true;
	}
	while ( left > least_step && !( reach.whole && ( to - q ).norm() > left ) )
	{
		const bool near = ( to - q ).norm() <= std::min( length, left );
		if ( near && link( q, to, reach, false, out ) )
		{
			return true;
		}
		State next;
		if ( near || !step( q, to, std::min( length, left ), next ) || !link( q, next, reach, true, out ) )
		{
			length = 0.5 * std::min( length, ( to - q ).norm() );
			if ( length < reach.least )
			{
				return false;
			}
			continue;
		}
		left -= ( next - q ).norm();
		q = next;
		length = std::min( step_growth * length, longest_step );
	}
	return false;
}

} // namespace leeway::manifold
