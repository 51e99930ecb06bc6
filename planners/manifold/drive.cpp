// SPDX-License-Identifier: BSD-3-Clause
// Speeds at all states of the path make cubics from them. Where one is not proved the path gets another state; where that does not help the motion
// rests at the corner. Whatever the time is, the curve is the same: the limits choose it last.
#include "drive.hpp"

#include <algorithm>
#include <cmath>
#include <set>

namespace leeway::manifold
{
namespace
{

constexpr int most_rounds = 14, rounds_before_rests = 5;
constexpr double corner_angle = 0.02; // radians between pieces: a smaller one is none
constexpr double shortest = 1e-9;     // of a piece, in joint space

/// A state of the path, and the piece of it that leads to the next one.
struct Knot
{
	State q;
	Piece ahead;       ///< of the last one: none
	bool rest = false; ///< the speed is 0
	bool corner = false;
	double u = 0; ///< of the run; not used at rests
	State rate;   ///< for each unit of u
};

/// u with 3 u^2 - 2 u^3 = s.
double unitTime( double s )
{
	return 0.5 - std::sin( std::asin( std::clamp( 1 - 2 * s, -1.0, 1.0 ) ) / 3 );
}

State endRate( const Piece& piece, bool last )
{
	const std::size_t n = piece.degree;
	return last ? State( piece.control( n ) - piece.control( n - 1 ) ) : State( piece.control( 1 ) - piece.control( 0 ) );
}

bool isCorner( const Piece& a, const Piece& b )
{
	const State from = endRate( a, true ), to = endRate( b, false );
	const double lengths = from.norm() * to.norm();
	return !( lengths > 0 ) || from.dot( to ) < std::cos( corner_angle ) * lengths;
}

class Driving
{
public:
	Driving( Walker& walker, Manifold& manifold, const std::vector<Piece>& pieces, bool keeps )
	    : m_walker( walker ), m_manifold( manifold ), m_keeps( keeps )
	{
		for ( const Piece& piece : pieces )
		{
			if ( piece.length() > shortest )
			{
				const bool corner = !m_knots.empty() && isCorner( m_knots.back().ahead, piece );
				m_knots.push_back( { piece.first(), piece, m_knots.empty(), corner, 0, {} } );
			}
		}
		if ( !m_knots.empty() )
		{
			m_knots.push_back( { m_knots.back().ahead.last(), {}, true, false, 0, {} } );
		}
	}

	bool prove()
	{
		for ( int round = 0; round < most_rounds; ++round )
		{
			takeTimes();
			takeRates();
			if ( proveAll() )
			{
				return true;
			}
			refine( round >= rounds_before_rests );
		}
		return false;
	}

	std::vector<motions::Segment> timed( const motions::MotionLimits& limits, std::int64_t begin ) const
	{
		std::vector<motions::Segment> segments;
		for ( std::size_t first = 0; first + 1 < m_knots.size(); )
		{
			const std::size_t last = runEnd( first );
			double seconds = 0;
			for ( std::size_t k = first; k < last; ++k )
			{
				seconds = std::max( seconds, secondsOf( k, limits ) );
			}
			const double nanoseconds = 1e9 * seconds * ( 1 + 1e-6 ) + 1;
			std::int64_t from = begin;
			for ( std::size_t k = first; k < last; ++k )
			{
				const std::int64_t to =
				    std::max( from + 1, begin + static_cast<std::int64_t>( std::ceil( nanoseconds * after( k ) ) ) );
				const double width = 1e-9 * static_cast<double>( to - from ), scale = 1e9 * width / nanoseconds;
				const Knot &a = m_knots[k], &b = m_knots[k + 1];
				const Piece piece = cubicPiece( a.q, scale * a.rate, b.q, scale * b.rate );
				segments.push_back( { 1e-9 * static_cast<double>( from ), width, 3, piece.points } );
				from = to;
			}
			begin = from;
			first = last;
		}
		return segments;
	}

	std::size_t rests() const
	{
		return static_cast<std::size_t>(
		           std::count_if( m_knots.begin(), m_knots.end(), []( const Knot& knot ) { return knot.rest; } ) ) -
		       2;
	}
	bool empty() const { return m_knots.empty(); }

private:
	std::size_t runEnd( std::size_t first ) const
	{
		std::size_t last = first + 1;
		while ( !m_knots[last].rest )
		{
			++last;
		}
		return last;
	}

	void takeTimes()
	{
		for ( std::size_t first = 0; first + 1 < m_knots.size(); )
		{
			const std::size_t last = runEnd( first );
			double sum = 0;
			std::vector<double> places = { 0 };
			for ( std::size_t k = first; k < last; ++k )
			{
				sum += m_knots[k].ahead.length();
				places.push_back( sum );
			}
			for ( std::size_t k = first + 1; k < last; ++k )
			{
				m_knots[k].u = unitTime( places[k - first] / sum );
			}
			first = last;
		}
	}

	/// u at both ends of the piece ahead of a knot.
	double before( std::size_t k ) const { return m_knots[k].rest ? 0 : m_knots[k].u; }
	double after( std::size_t k ) const { return m_knots[k + 1].rest ? 1 : m_knots[k + 1].u; }

	void takeRates()
	{
		for ( std::size_t k = 0; k < m_knots.size(); ++k )
		{
			Knot& knot = m_knots[k];
			knot.rate = State::Zero( knot.q.size() );
			if ( knot.rest )
			{
				continue;
			}
			const double left = knot.u - before( k - 1 ), right = after( k ) - knot.u;
			const State back = ( knot.q - m_knots[k - 1].q ) / left, ahead = ( m_knots[k + 1].q - knot.q ) / right;
			knot.rate = ( right * back + left * ahead ) / ( left + right );
			m_keeps ? m_manifold.makeTangent( knot.q.data(), knot.rate.data() ) : void();
		}
	}

	Piece curve( std::size_t k ) const
	{
		const double width = after( k ) - before( k );
		return cubicPiece( m_knots[k].q, width * m_knots[k].rate, m_knots[k + 1].q, width * m_knots[k + 1].rate );
	}

	bool proveAll()
	{
		m_failed.assign( m_knots.size(), false );
		bool all = true;
		for ( std::size_t k = 0; k + 1 < m_knots.size(); ++k )
		{
			const Piece piece = curve( k );
			const bool proved =
			    m_known.count( piece.points ) > 0 || ( m_keeps ? m_walker.isProved( piece ) : m_walker.isClear( piece ) );
			proved ? static_cast<void>( m_known.insert( piece.points ) ) : void();
			m_failed[k] = !proved;
			all = all && proved;
		}
		return all;
	}

	void refine( bool may_rest )
	{
		if ( may_rest )
		{
			for ( std::size_t k = 0; k + 1 < m_knots.size(); ++k )
			{
				m_knots[k].rest = m_knots[k].rest || ( m_knots[k].corner && m_failed[k] );
				m_knots[k + 1].rest = m_knots[k + 1].rest || ( m_knots[k + 1].corner && m_failed[k] );
			}
		}
		std::vector<Knot> finer;
		for ( std::size_t k = 0; k < m_knots.size(); ++k )
		{
			finer.push_back( m_knots[k] );
			if ( k + 1 < m_knots.size() && m_failed[k] )
			{
				Knot middle;
				middle.q = m_knots[k].ahead.at( 0.5 );
				middle.ahead = m_knots[k].ahead.part( 0.5, 1 );
				finer.back().ahead = m_knots[k].ahead.part( 0, 0.5 );
				finer.push_back( middle );
			}
		}
		m_knots = finer;
	}

	/// Seconds of the run that the limits ask for at the piece ahead of a knot.
	double secondsOf( std::size_t k, const motions::MotionLimits& limits ) const
	{
		const Piece piece = curve( k );
		const double width = after( k ) - before( k );
		const State p[4] = { piece.control( 0 ), piece.control( 1 ), piece.control( 2 ), piece.control( 3 ) };
		double seconds = 0;
		for ( std::size_t v = 0; v < piece.variables(); ++v )
		{
			const auto i = static_cast<Eigen::Index>( v );
			for ( int j = 0; j < 3; ++j )
			{
				seconds = std::max( seconds, 3 * std::fabs( p[j + 1][i] - p[j][i] ) / width / limits.velocity[v] );
			}
			for ( int j = 0; j < 2; ++j )
			{
				const double change = 6 * std::fabs( p[j + 2][i] - 2 * p[j + 1][i] + p[j][i] ) / ( width * width );
				seconds = std::max( seconds, std::sqrt( change / limits.acceleration[v] ) );
			}
			const double third = 6 * std::fabs( p[3][i] - 3 * p[2][i] + 3 * p[1][i] - p[0][i] ) / std::pow( width, 3 );
			seconds = std::max( seconds, std::cbrt( third / limits.mostJerk( v ) ) );
		}
		return seconds;
	}

	Walker& m_walker;
	Manifold& m_manifold;
	const bool m_keeps;
	std::vector<Knot> m_knots;
	std::vector<bool> m_failed;
	std::set<std::vector<double>> m_known; ///< control points of proved curves
};

} // namespace

Driven drive( Walker& walker, Manifold& manifold, const std::vector<Piece>& pieces, const motions::MotionLimits& limits,
    bool keeps, std::int64_t begin )
{
	Driving driving( walker, manifold, pieces, keeps );
	Driven driven;
	if ( driving.empty() || !driving.prove() )
	{
		return driven;
	}
	driven.proved = true;
	driven.segments = driving.timed( limits, begin );
	driven.rests = driving.rests();
	return driven;
}

} // namespace leeway::manifold
