// SPDX-License-Identifier: BSD-3-Clause
// Bounds and distances of joint space, and the length of edges that suits a robot.
#include "space.hpp"
#include "samples.hpp"

#include "leeway/planners/planner.hpp"

#include <algorithm>
#include <string>

namespace leeway::planners
{

namespace
{

// Radians or metres: descriptions print 3.14159 for pi; ends beyond a bound by less are used unchanged
constexpr double bound_tolerance = 1e-5;
constexpr double unlimited = 1e300;   // metres, in place of infinite limits
constexpr unsigned range_states = 16; // random states at which speeds are measured
constexpr double speed_step = 1e-4;   // radians or metres, for differences of poses
constexpr double range_share = 0.5;   // of the reach that an edge in a random direction moves the fastest point

[[noreturn]] void refuse( const lw_checker* checker, std::size_t variable, const std::string& problem )
{
	throw InputError( std::string( "leeway::planners: joint " ) + jointName( checker, variable ) + ": " + problem );
}

} // namespace

const char* jointName( const lw_checker* checker, std::size_t variable )
{
	const lw_robot* robot = lw_checker_robot( checker );
	const std::uint32_t index = lw_checker_variable( checker, static_cast<std::uint32_t>( variable ) );
	return lw_robot_joint_name( robot, lw_robot_variable( robot, index ).joint );
}

Space::Space( const lw_checker* checker, const std::vector<double>& lower, const std::vector<double>& upper )
{
	const lw_robot* robot = lw_checker_robot( checker );
	const std::size_t size = lw_checker_variable_count( checker );
	if ( size == 0 )
	{
		throw InputError( "leeway::planners: the checker's group has no variables; give one that a joint moves" );
	}
	if ( ( !lower.empty() && lower.size() != size ) || ( !upper.empty() && upper.size() != size ) )
	{
		throw InputError(
		    "leeway::planners: Settings: lower and upper need " + std::to_string( size ) + " entries, or none" );
	}
	for ( std::size_t i = 0; i < size; ++i )
	{
		const lw_variable_info info =
		    lw_robot_variable( robot, lw_checker_variable( checker, static_cast<std::uint32_t>( i ) ) );
		if ( lw_robot_joint_type( robot, info.joint ) == LW_JOINT_FLOATING )
		{
			refuse( checker, i, "floating joints are not supported; plan with one of OMPL's planners" );
		}
		m_wraps.push_back( info.wraps );
		m_any_wraps = m_any_wraps || info.wraps;
		const double low = lower.empty() || info.wraps ? info.lower : lower[i];
		const double high = upper.empty() || info.wraps ? info.upper : upper[i];
		if ( !( std::isfinite( low ) && std::isfinite( high ) && low <= high ) )
		{
			refuse( checker, i, "no finite bounds; give them in Settings::lower and Settings::upper" );
		}
		m_lower.push_back( low );
		m_upper.push_back( high );
	}
}

Space Space::ofLimits( const lw_checker* checker )
{
	std::vector<double> lower, upper;
	for ( std::uint32_t i = 0; i < lw_checker_variable_count( checker ); ++i )
	{
		const lw_variable_info info = lw_robot_variable( lw_checker_robot( checker ), lw_checker_variable( checker, i ) );
		lower.push_back( std::max( info.lower, -unlimited ) );
		upper.push_back( std::min( info.upper, unlimited ) );
	}
	return Space( checker, lower, upper );
}

double Space::distance( const double* a, const double* b ) const
{
	double sum = 0;
	for ( std::size_t i = 0; i < size(); ++i )
	{
		const double d = difference( i, a[i], b[i] );
		sum += d * d;
	}
	return std::sqrt( sum );
}

void Space::between( const double* a, const double* b, double t, double* out ) const
{
	const std::size_t count = size();
	for ( std::size_t i = 0; i < count; ++i )
	{
		out[i] = a[i] + t * difference( i, a[i], b[i] );
	}
	normalise( out );
}

unsigned Space::partCount( const double* a, const double* b ) const
{
	double turn = 0;
	for ( std::size_t i = 0; m_any_wraps && i < size(); ++i )
	{
		turn = wraps( i ) ? std::max( turn, std::fabs( difference( i, a[i], b[i] ) ) ) : turn;
	}
	return turn > longest_turn ? 2 : 1;
}

void Space::wrapAngles( double* q ) const
{
	for ( std::size_t i = 0; m_any_wraps && i < size(); ++i )
	{
		q[i] = wraps( i ) ? difference( i, 0, q[i] ) : q[i];
	}
}

void Space::normalise( double* q ) const
{
	const std::size_t count = size();
	const double *low = m_lower.data(), *high = m_upper.data();
	for ( std::size_t i = 0; i < count; ++i )
	{
		q[i] = wraps( i ) ? difference( i, 0, q[i] ) : std::clamp( q[i], low[i], high[i] );
	}
}

std::size_t Space::firstUnusable( const double* q ) const
{
	for ( std::size_t i = 0; i < size(); ++i )
	{
		const bool inside = q[i] >= m_lower[i] - bound_tolerance && q[i] <= m_upper[i] + bound_tolerance;
		if ( !std::isfinite( q[i] ) || ( !wraps( i ) && !inside ) )
		{
			return i;
		}
	}
	return size();
}

namespace
{

/// Fastest points of bodies per unit of each variable, by differences of poses.
class Speeds
{
public:
	explicit Speeds( const lw_checker* checker )
	    : m_checker( checker ), m_robot( lw_checker_robot( checker ) ), m_full( lw_robot_variable_count( m_robot ) ),
	      m_at( lw_robot_link_count( m_robot ) ), m_moved( m_at.size() )
	{
		for ( std::uint32_t i = 0; i < lw_robot_body_count( m_robot ); ++i )
		{
			const lw_body_def body = lw_robot_body( m_robot, i );
			const lw_shape_info shape = lw_shape_peek_info( body.shape );
			Ball ball{ body.link, {}, shape.sphere_radius };
			apply( body.link_from_shape, shape.sphere_center, ball.center );
			m_balls.push_back( ball );
		}
	}

	/// @param speeds [variable count] raised to the speeds at q
	void measure( const double* q, double* speeds )
	{
		std::vector<double> state( q, q + lw_checker_variable_count( m_checker ) );
		lw_checker_full_state( m_checker, state.data(), m_full.data() );
		if ( lw_robot_fk( m_robot, m_full.data(), m_at.data() ) != LW_OK )
		{
			return;
		}
		for ( std::size_t i = 0; i < state.size(); ++i )
		{
			state[i] += speed_step;
			lw_checker_full_state( m_checker, state.data(), m_full.data() );
			if ( lw_robot_fk( m_robot, m_full.data(), m_moved.data() ) == LW_OK )
			{
				speeds[i] = std::max( speeds[i], fastest() / speed_step );
			}
			state[i] = q[i];
		}
	}

private:
	/// Around a body, in the frame of its link.
	struct Ball
	{
		std::uint32_t link;
		double center[3], radius;
	};

	static void apply( const lw_transform& x, const double* p, double* out )
	{
		for ( int row = 0; row < 3; ++row )
		{
			out[row] = x.r[row][0] * p[0] + x.r[row][1] * p[1] + x.r[row][2] * p[2] + x.t[row];
		}
	}

	/// Displacement of the bounding spheres' centres between the two poses, and of a point at their radius.
	double fastest() const
	{
		double most = 0;
		for ( const Ball& ball : m_balls )
		{
			double from[3], to[3], turn = 0;
			const lw_transform &a = m_at[ball.link], &b = m_moved[ball.link];
			apply( a, ball.center, from );
			apply( b, ball.center, to );
			for ( int k = 0; k < 9; ++k )
			{
				const double d = b.r[k / 3][k % 3] - a.r[k / 3][k % 3];
				turn += d * d / 2;
			}
			most = std::max(
			    most, std::hypot( to[0] - from[0], to[1] - from[1], to[2] - from[2] ) + std::sqrt( turn ) * ball.radius );
		}
		return most;
	}

	const lw_checker* m_checker;
	const lw_robot* m_robot;
	std::vector<double> m_full;
	std::vector<lw_transform> m_at, m_moved;
	std::vector<Ball> m_balls;
};

bool isAngle( const lw_checker* checker, std::size_t variable )
{
	const lw_robot* robot = lw_checker_robot( checker );
	const lw_variable_info info =
	    lw_robot_variable( robot, lw_checker_variable( checker, static_cast<std::uint32_t>( variable ) ) );
	const lw_joint_type type = lw_robot_joint_type( robot, info.joint );
	return type == LW_JOINT_REVOLUTE || type == LW_JOINT_CONTINUOUS || ( type == LW_JOINT_PLANAR && info.component == 2 );
}

} // namespace

double geometricRange( const lw_checker* checker, const double* lower, const double* upper )
{
	const std::size_t size = lw_checker_variable_count( checker );
	Speeds speeds( checker );
	std::vector<double> fastest( size, 0.0 ), q( size );
	Random random( 1 ); // the same states in every run
	for ( unsigned k = 0; k < range_states; ++k )
	{
		for ( std::size_t i = 0; i < size; ++i )
		{
			q[i] = lower[i] + random.uniform() * ( upper[i] - lower[i] );
		}
		speeds.measure( q.data(), fastest.data() );
	}
	// The reach: how far a radian of the strongest joint moves a point; without angles, half of the longest travel
	double reach = 0, travel = 0, sum = 0;
	for ( std::size_t i = 0; i < size; ++i )
	{
		sum += fastest[i] * fastest[i];
		reach = isAngle( checker, i ) ? std::max( reach, fastest[i] ) : reach;
		travel = std::max( travel, ( upper[i] - lower[i] ) / 2 );
	}
	const double speed = std::sqrt( sum / static_cast<double>( std::max<std::size_t>( size, 1 ) ) );
	const double range = range_share * ( reach > 0 ? reach : travel ) / speed;
	return std::isfinite( range ) && range > 0 ? range : 1;
}

} // namespace leeway::planners
