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
constexpr std::size_t lanes = 8; // of a look

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

/// Appends a chord; its states wait for look().
void Walker::addChord( const State& a, const State& b, std::vector<Piece>& out )
{
	out.push_back( straightPiece( a, b ) );
	const double count = std::ceil( out.back().length() / look_width );
	const auto looks = static_cast<std::uint32_t>( std::clamp( count - 1, 0.0, static_cast<double>( most_looks ) ) );
	for ( std::uint32_t i = 1; i <= looks; ++i )
	{
		const State q = out.back().at( i / ( looks + 1.0 ) );
		m_states.insert( m_states.end(), q.data(), q.data() + q.size() );
		m_chords.push_back( out.size() - 1 );
	}
}

/// Looks in lanes at the first `count` states that wait. A state that a look leaves open beside the scene is hardly ever free.
/// @return the first chord that does not seem clear, and no state waits; or `end`
std::size_t Walker::look( std::size_t count, std::size_t end )
{
	m_seen.resize( count );
	m_open.resize( count );
	require( lw_checker_states( m_problem.checker.get(), m_query, m_states.data(), static_cast<std::uint32_t>( count ),
	             m_edge.flags, m_edge.min_d, LW_STATES_LANES, m_seen.data(), m_open.data() ),
	    "clearances of states" );
	m_counts.states += count;
	for ( std::size_t i = 0; i < count; ++i )
	{
		if ( m_seen[i] != LW_VERDICT_FREE &&
		     ( m_seen[i] != LW_VERDICT_UNDECIDED || ( m_open[i] & LW_CHECK_ENVIRONMENT ) != 0 ) )
		{
			const std::size_t chord = m_chords[i];
			forgetChords();
			return chord;
		}
	}
	const auto done = static_cast<std::ptrdiff_t>( count ), values = static_cast<std::ptrdiff_t>( m_manifold.variables() );
	m_states.erase( m_states.begin(), m_states.begin() + done * values );
	m_chords.erase( m_chords.begin(), m_chords.begin() + done );
	return end;
}

void Walker::forgetChords()
{
	m_states.clear();
	m_chords.clear();
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

/// Appends a chord to a state that is not known to be free, if both seem clear.
bool Walker::takeChord( const Piece& chord, std::vector<Piece>& out )
{
	const std::size_t end = out.size();
	addChord( chord.first(), chord.last(), out );
	const bool good = look( m_chords.size(), end + 1 ) > end && isFree( chord.last() );
	good ? void() : out.pop_back();
	return good;
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

/// Tries one step. @return true: it ends at `to`
bool Walker::advance( Front& front, const State& to, const Reach& reach, std::vector<Piece>& out )
{
	const State q = front.at;
	const double most = std::min( front.length, front.left ), gap = ( to - q ).norm();
	const bool near = gap <= most;
	State next = to;
	const bool led = near ? !reach.proofs_wait || ( leadsAlong( q, to ) && isFree( to ) ) : step( q, to, most, next );
	if ( !led || !( reach.proofs_wait || join( q, next, 0, out ) ) )
	{
		front.length = 0.5 * std::min( front.length, gap );
		front.stuck = front.length < reach.least;
		return false;
	}
	reach.proofs_wait ? addChord( q, next, out ) : void();
	front = { next, std::min( step_growth * front.length, longest_step ), front.left - ( next - q ).norm(), false };
	return near;
}

/// Takes the chords from `from` on away, and tries half of the first.
void Walker::goBack( Front& front, double least, std::size_t from, std::vector<Piece>& out )
{
	front.at = out[from].first();
	front.length = 0.5 * out[from].length();
	front.stuck = front.length < least;
	for ( ; out.size() > from; out.pop_back() )
	{
		front.left += out.back().length();
	}
}

bool Walker::walk( const State& a, const State& b, const Reach& reach, std::vector<Piece>& out )
{
	const State to = nearestTurns( a, b );
	const double gap = ( to - a ).norm();
	Piece straight = straightPiece( a, to );
	if ( !( gap > no_length ) )
	{
		out.push_back( straight );
		return true;
	}
	forgetChords();
	if ( gap <= reach.most && isKept( straight ) &&
	     ( reach.proofs_wait ? takeChord( straight, out ) : take( straight, out ) ) )
	{
		return true;
	}
	Front front = { a, std::min( first_step, reach.most ), reach.most, false };
	while ( true )
	{
		const bool over =
		    front.stuck || !( front.left > least_step ) || ( reach.whole && ( to - front.at ).norm() > front.left );
		const bool arrived = !over && advance( front, to, reach, out );
		const std::size_t waiting = m_chords.size();
		const std::size_t clear = look( over || arrived ? waiting : waiting - waiting % lanes, out.size() );
		if ( clear < out.size() )
		{
			goBack( front, reach.least, clear, out );
		}
		else if ( over || arrived )
		{
			return arrived;
		}
	}
}

} // namespace leeway::manifold
