// SPDX-License-Identifier: BSD-3-Clause
// Coordinate descent over widths of courses and speeds at their seams. The geometry is that of the fitted cubics: the joints' derivatives by the fraction of
// a leg, taken in the middle of each cubic.
#include "lines/shares.hpp"

#include "motions/descent.hpp"

#include <algorithm>
#include <cmath>

namespace leeway::lines
{
namespace
{

constexpr std::size_t most_sweeps = 60; // over all widths and speeds
constexpr double worth = 0.01;          // of the time, by all changes: else the run stays as it is
constexpr double need_power = 12;       // of the mean of needs
constexpr int places_of_leg = 12;       // at which needs are estimated
constexpr double most_pace = 2.9; // of both speeds of a course, Euclidean: below 3 it goes forward (Fritsch, Carlson, 1980)
constexpr std::uint32_t least_width = 64;

/// Derivatives of the joints by the fraction of a leg.
struct Sample
{
	double fraction = 0;
	State first, second, third;
};

/// Of a course at a share v of its width: the fraction, and its derivatives by v.
struct Speeds
{
	double at, first, second, third;
};

Speeds speedsOf( double v, double begin, double end )
{
	const double bend = 6 * ( begin + end ) - 12; // third derivative
	const double slope = 6 - 4 * begin - 2 * end; // second derivative at 0
	return {
	    v * ( begin + v * ( 0.5 * slope + v * bend / 6 ) ), begin + v * ( slope + 0.5 * v * bend ), slope + v * bend, bend };
}

State control( const Piece& piece, std::size_t i, std::size_t count )
{
	return Eigen::Map<const State>( piece.points.data() + i * count, static_cast<Eigen::Index>( count ) );
}

std::vector<Sample> samplesOf( const Leg& leg, std::size_t number, const std::vector<Piece>& pieces )
{
	std::vector<Sample> samples;
	const double width = leg.course.width();
	for ( const Piece& piece : pieces )
	{
		if ( piece.leg != number )
		{
			continue;
		}
		const std::size_t count = piece.points.size() / 4;
		const State p[4] = {
		    control( piece, 0, count ), control( piece, 1, count ), control( piece, 2, count ), control( piece, 3, count ) };
		const double h = parameter( piece.to - piece.from ) / width; // of the course's width
		const double v = ( parameter( piece.from - leg.course.from ) + 0.5 * parameter( piece.to - piece.from ) ) / width;
		const Speeds s = speedsOf( v, leg.course.first, leg.course.last );
		Sample sample;
		sample.fraction = s.at;
		sample.first = 0.75 * ( p[3] + p[2] - p[1] - p[0] ) / h / s.first;
		const State change = 3 * ( p[3] - p[2] - p[1] + p[0] ) / ( h * h );
		sample.second = ( change - sample.first * s.second ) / ( s.first * s.first );
		sample.third = State::Zero( sample.first.size() );
		samples.push_back( sample );
	}
	for ( std::size_t k = 0; samples.size() > 1 && k < samples.size(); ++k )
	{
		const Sample &a = samples[k > 0 ? k - 1 : 0], &b = samples[std::min( k + 1, samples.size() - 1 )];
		samples[k].third = ( b.second - a.second ) / std::max( b.fraction - a.fraction, 1e-6 );
	}
	return samples;
}

class Sharing
{
public:
	Sharing( const Run& run, const std::vector<Piece>& pieces, const motions::MotionLimits& limits, double speed )
	    : m_run( run ), m_limits( limits ), m_speed( speed )
	{
		for ( std::size_t i = 0; i < run.legs.size(); ++i )
		{
			const Leg& leg = run.legs[i];
			m_samples.push_back( samplesOf( leg, i, pieces ) );
			m_widths.push_back( leg.course.width() );
			m_seams.push_back( leg.course.first * leg.length / leg.course.width() );
			m_needs.push_back( 0 );
		}
		m_seams.push_back( 0 );
	}

	bool improve()
	{
		if ( std::any_of( m_samples.begin(), m_samples.end(), []( const auto& samples ) { return samples.empty(); } ) )
		{
			return false;
		}
		const std::size_t count = m_widths.size();
		for ( std::size_t i = 0; i < count; ++i )
		{
			m_needs[i] = need( i );
		}
		const auto take = [&]( std::size_t i, double value )
		{
			valueAt( i ) = value;
			for ( std::size_t leg = i < count ? i : i - count; leg <= ( i < count ? i : i - count + 1 ); ++leg )
			{
				m_needs[leg] = need( leg );
			}
		};
		const auto cost = [&] { return seconds(); };
		const motions::Descent by_shares = { 1.5, 1.02, 1e-4, most_sweeps * 2 * ( 2 * count - 1 ) };
		const double before = cost();
		return motions::descend(
		           by_shares, 2 * count - 1, [&]( std::size_t i ) { return valueAt( i ); }, take, cost ) <
		       before * ( 1 - worth );
	}

	/// @return false: a leg would have too few places
	bool take( Run& run ) const
	{
		double all = 0, sum = 0;
		for ( const double width : m_widths )
		{
			all += width;
		}
		std::uint32_t place = 0;
		for ( std::size_t i = 0; i < run.legs.size(); ++i )
		{
			Leg& leg = run.legs[i];
			sum += m_widths[i];
			const bool is_last = i + 1 == run.legs.size();
			leg.course.from = place;
			leg.course.to = place =
			    is_last ? most_places : static_cast<std::uint32_t>( std::lround( most_places * sum / all ) );
			if ( leg.course.to < leg.course.from + std::max( least_width, leg.states ) )
			{
				return false;
			}
			leg.course.first = m_seams[i] * all * leg.course.width() / leg.length;
			leg.course.last = m_seams[i + 1] * all * leg.course.width() / leg.length;
		}
		takeTurnings( run );
		return true;
	}

private:
	/// The widths, then the speeds at seams between legs.
	double& valueAt( std::size_t i ) { return i < m_widths.size() ? m_widths[i] : m_seams[i - m_widths.size() + 1]; }

	/// The axes turn from waypoint to waypoint.
	static void takeTurnings( Run& run )
	{
		for ( Leg& leg : run.legs )
		{
			if ( leg.turns_apart )
			{
				leg.turning_course.from = most_places;
				leg.turning_course.to = 0;
				for ( const Leg& other : run.legs )
				{
					if ( other.part == leg.part )
					{
						leg.turning_course.from = std::min( leg.turning_course.from, other.course.from );
						leg.turning_course.to = std::max( leg.turning_course.to, other.course.to );
					}
				}
			}
		}
	}

	/// Near the largest need, times the length of u.
	double seconds() const
	{
		double all = 0, sum = 0;
		for ( std::size_t i = 0; i < m_widths.size(); ++i )
		{
			all += m_widths[i];
			sum += m_widths[i] * m_needs[i];
		}
		return all * std::pow( sum / all, 1 / need_power );
	}

	/// The mean power of the seconds that a unit of u needs in a leg; infinite if its course goes back.
	double need( std::size_t i ) const
	{
		const double width = m_widths[i], length = m_run.legs[i].length;
		const double begin = m_seams[i] * width / length, end = m_seams[i + 1] * width / length;
		if ( std::hypot( begin, end ) > most_pace )
		{
			return HUGE_VAL;
		}
		double sum = 0;
		for ( int k = 0; k <= places_of_leg; ++k )
		{
			const Speeds s = speedsOf( double( k ) / places_of_leg, begin, end );
			sum += std::pow( needAt( m_samples[i], s, width, length ), need_power );
		}
		return sum / ( places_of_leg + 1 );
	}

	double needAt( const std::vector<Sample>& samples, const Speeds& s, double width, double length ) const
	{
		const auto above =
		    std::find_if( samples.begin(), samples.end(), [&]( const Sample& sample ) { return sample.fraction > s.at; } );
		const Sample& b = above == samples.end() ? samples.back() : *above;
		const Sample& a = above == samples.begin() ? b : *( above - 1 );
		const double gap = b.fraction - a.fraction;
		const double t = gap > 0 ? std::clamp( ( s.at - a.fraction ) / gap, 0.0, 1.0 ) : 0;
		const double f = s.first / width, g = s.second / ( width * width ), h = s.third / ( width * width * width );
		double seconds = f * length / m_speed;
		for ( Eigen::Index v = 0; v < a.first.size(); ++v )
		{
			const auto i = static_cast<std::size_t>( v );
			const double q1 = a.first[v] + t * ( b.first[v] - a.first[v] ),
			             q2 = a.second[v] + t * ( b.second[v] - a.second[v] ),
			             q3 = a.third[v] + t * ( b.third[v] - a.third[v] );
			seconds = std::max( { seconds, std::fabs( q1 * f ) / m_limits.velocity[i],
			    std::sqrt( std::fabs( q2 * f * f + q1 * g ) / m_limits.acceleration[i] ),
			    std::cbrt( std::fabs( q3 * f * f * f + 3 * q2 * f * g + q1 * h ) / m_limits.mostJerk( i ) ) } );
		}
		return seconds;
	}

	const Run& m_run;
	const motions::MotionLimits& m_limits;
	const double m_speed;
	std::vector<std::vector<Sample>> m_samples;
	std::vector<double> m_widths; ///< of u, which may grow beyond 1
	std::vector<double> m_seams;  ///< metres for each unit of u, at both ends of legs
	std::vector<double> m_needs;
};

} // namespace

Courses coursesOf( const Run& run )
{
	Courses courses;
	for ( const Leg& leg : run.legs )
	{
		courses.emplace_back( leg.course, leg.turning_course );
	}
	return courses;
}

void setCourses( Run& run, const Courses& courses )
{
	for ( std::size_t i = 0; i < run.legs.size(); ++i )
	{
		run.legs[i].course = courses[i].first;
		run.legs[i].turning_course = courses[i].second;
	}
}

bool shareTime( Run& run, const std::vector<Piece>& pieces, const motions::MotionLimits& limits, double speed )
{
	const Courses before = coursesOf( run );
	Sharing sharing( run, pieces, limits, speed );
	if ( sharing.improve() && sharing.take( run ) )
	{
		return true;
	}
	setCourses( run, before );
	return false;
}

} // namespace leeway::lines
