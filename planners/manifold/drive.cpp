// SPDX-License-Identifier: BSD-3-Clause
// Speeds at all states of the path make cubics from them. Where one is not proved the path gets another state; where that does not help the motion
// rests at the corner. Whatever the time is, the curve is the same: the limits choose it last. Then pieces that need less time than they have give it to
// others: that changes the speeds at states, so the cubics, which are proved again.
#include "drive.hpp"

#include "motions/descent.hpp"

#include <algorithm>
#include <cmath>
#include <set>

namespace leeway::manifold
{
namespace
{

constexpr int most_rounds = 14, rounds_before_rests = 5;
constexpr motions::Descent by_shares = { 2, 1.02, 1e-4, 1000 }; // of a piece's share of the time
constexpr double need_power = 12;                               // of the mean of needs; see Need::power()
constexpr int share_rounds = 4;                                 // with more states where a piece is not proved
constexpr double least_part = 0.05;                             // of a change of shares that is not proved as a whole
constexpr double corner_angle = 0.02;                           // radians between pieces: a smaller one is none
constexpr double shortest = 1e-9;                               // of a piece, in joint space

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

/// The first three derivatives of a cubic as parts of their limits: seconds, seconds^2, seconds^3.
class Need
{
public:
	/// Of the cubic between two states with these rates for each unit of u, over a width of u.
	Need( const State& from, const State& from_rate, const State& to, const State& to_rate, double width,
	    const motions::MotionLimits& limits )
	{
		const double third_width = width / 3;
		for ( Eigen::Index k = 0; k < from.size(); ++k )
		{
			const auto v = static_cast<std::size_t>( k );
			const double a = third_width * from_rate[k], c = third_width * to_rate[k], b = to[k] - from[k] - a - c;
			m_first =
			    std::max( m_first, std::max( { std::fabs( a ), std::fabs( b ), std::fabs( c ) } ) / limits.velocity[v] );
			m_second = std::max( m_second, std::max( std::fabs( b - a ), std::fabs( c - b ) ) / limits.acceleration[v] );
			m_third = std::max( m_third, std::fabs( c - 2 * b + a ) / limits.mostJerk( v ) );
		}
		m_first *= 3;
		m_second *= 6;
		m_third *= 6;
	}
	/// The least time that they allow.
	double seconds() const { return std::max( { m_first, std::sqrt( m_second ), std::cbrt( m_third ) } ); }
	/// seconds() over a width, to the power of need_power, without roots.
	double power( double width ) const
	{
		const double a = cube( m_first ), b = cube( m_second ), c = m_third * m_third, w = cube( width );
		return std::max( { a * a * a * a, b * b, c * c } ) / ( w * w * w * w );
	}

private:
	static double cube( double x ) { return x * x * x; }

	double m_first = 0, m_second = 0, m_third = 0;
};

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

	/// Shares the time of runs otherwise, as far as they get shorter and are proved.
	void shareTime( const motions::MotionLimits& limits )
	{
		const std::vector<Knot> before = m_knots;
		const double seconds = allSeconds( limits );
		if ( !shareAll( limits ) && !sharePart( before, limits ) )
		{
			m_knots = before;
		}
		m_knots = allSeconds( limits ) < seconds ? m_knots : before;
	}

	std::vector<motions::Segment> timed( const motions::MotionLimits& limits, std::int64_t begin ) const
	{
		std::vector<motions::Segment> segments;
		for ( std::size_t first = 0; first + 1 < m_knots.size(); )
		{
			const std::size_t last = runEnd( first );
			const double seconds = runSeconds( first, last, limits );
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

	/// A way from a knot, or to it, along the constraints.
	State alongConstraints( std::size_t k, State way )
	{
		m_keeps ? m_manifold.makeTangent( m_knots[k].q.data(), way.data() ) : void();
		return way;
	}

	/// The speed for each unit of u between pieces of these widths, of the ways from the state before and to the next one.
	static State rateOf( const State& back, const State& ahead, double left, double right )
	{
		return ( right / left * back + left / right * ahead ) / ( left + right );
	}

	State rateAt( std::size_t k, double left, double right )
	{
		const State &before = m_knots[k - 1].q, &q = m_knots[k].q, &after = m_knots[k + 1].q;
		return alongConstraints( k, rateOf( q - before, after - q, left, right ) );
	}

	void takeRates()
	{
		for ( std::size_t k = 0; k < m_knots.size(); ++k )
		{
			Knot& knot = m_knots[k];
			knot.rate = State::Zero( knot.q.size() );
			if ( !knot.rest )
			{
				knot.rate = rateAt( k, knot.u - before( k - 1 ), after( k ) - knot.u );
			}
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

	void shareRuns( const motions::MotionLimits& limits )
	{
		for ( std::size_t first = 0; first + 1 < m_knots.size(); first = runEnd( first ) )
		{
			shareRun( first, runEnd( first ), limits );
		}
		takeRates();
	}

	/// With more states where a piece is not proved. @return false: it is not proved
	bool shareAll( const motions::MotionLimits& limits )
	{
		for ( int round = 0; round < share_rounds; ++round )
		{
			shareRuns( limits );
			if ( proveAll() )
			{
				return true;
			}
			refine( false );
			takeTimes();
			takeRates();
		}
		return false;
	}

	/// A part of the way from known shares to others. @return false: it is not proved
	bool sharePart( const std::vector<Knot>& before, const motions::MotionLimits& limits )
	{
		m_knots = before;
		shareRuns( limits );
		const std::vector<Knot> wanted = m_knots;
		for ( double part = 0.5; part > least_part; part *= 0.5 )
		{
			for ( std::size_t k = 0; k < m_knots.size(); ++k )
			{
				m_knots[k].u = before[k].u + part * ( wanted[k].u - before[k].u );
			}
			takeRates();
			if ( proveAll() )
			{
				return true;
			}
		}
		return false;
	}

	double allSeconds( const motions::MotionLimits& limits ) const
	{
		double sum = 0;
		for ( std::size_t first = 0; first + 1 < m_knots.size(); first = runEnd( first ) )
		{
			sum += runSeconds( first, runEnd( first ), limits );
		}
		return sum;
	}

	double runSeconds( std::size_t first, std::size_t last, const motions::MotionLimits& limits ) const
	{
		double seconds = 0;
		for ( std::size_t k = first; k < last; ++k )
		{
			seconds = std::max( seconds, secondsOf( k, limits ) );
		}
		return seconds;
	}

	/// Changes the share of one piece after the other, by smaller and smaller factors. One change concerns three pieces.
	void shareRun( std::size_t first, std::size_t last, const motions::MotionLimits& limits )
	{
		const std::size_t count = last - first;
		std::vector<double> shares( count ), powers( count );
		std::vector<State> rates, back( count ), ahead( count ); // of inner knots
		double sum = 0, all = 0;
		const auto power = [&]( std::size_t i )
		{
			const State &a = m_knots[first + i].q, &b = m_knots[first + i + 1].q;
			const double width = shares[i];
			return width * Need( a, rates[i], b, rates[i + 1], width, limits ).power( width );
		};
		for ( std::size_t k = first; k <= last; ++k )
		{
			rates.push_back( m_knots[k].rate );
		}
		for ( std::size_t k = 1; k < count; ++k )
		{
			const State &before = m_knots[first + k - 1].q, &q = m_knots[first + k].q, &after = m_knots[first + k + 1].q;
			back[k] = alongConstraints( first + k, q - before );
			ahead[k] = alongConstraints( first + k, after - q );
		}
		for ( std::size_t i = 0; i < count; ++i )
		{
			shares[i] = after( first + i ) - before( first + i );
			powers[i] = power( i );
			all += shares[i];
			sum += powers[i];
		}
		// Near the largest need, times the length of u; it falls with the needs of others too
		const auto seconds = [&] { return all * std::pow( sum / all, 1 / need_power ); };
		const auto take = [&]( std::size_t i, double share )
		{
			all += share - shares[i];
			shares[i] = share;
			for ( std::size_t k = i; k <= i + 1; ++k )
			{
				// rateAt(), but for limits that one of the sides meets
				rates[k] = k > 0 && k < count ? rateOf( back[k], ahead[k], shares[k - 1], shares[k] ) : rates[k];
			}
			for ( std::size_t k = i > 0 ? i - 1 : 0; k < std::min( i + 2, count ); ++k )
			{
				const double now = power( k );
				sum += now - powers[k];
				powers[k] = now;
			}
		};
		motions::descend(
		    by_shares, count, [&]( std::size_t i ) { return shares[i]; }, take, seconds );
		double at = 0;
		for ( std::size_t i = 0; i + 1 < count; ++i )
		{
			at += shares[i] / all;
			m_knots[first + 1 + i].u = at;
		}
	}

	/// Seconds for a unit of u that the limits ask for at the piece ahead of a knot.
	double secondsOf( std::size_t k, const motions::MotionLimits& limits ) const
	{
		const Knot &a = m_knots[k], &b = m_knots[k + 1];
		const double width = after( k ) - before( k );
		return Need( a.q, a.rate, b.q, b.rate, width, limits ).seconds() / width;
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
	driven.proved = driving.empty() || driving.prove();
	if ( driving.empty() || !driven.proved )
	{
		return driven;
	}
	driving.shareTime( limits );
	driven.segments = driving.timed( limits, begin );
	driven.rests = driving.rests();
	return driven;
}

} // namespace leeway::manifold
