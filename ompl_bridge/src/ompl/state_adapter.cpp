// SPDX-License-Identifier: BSD-3-Clause
// States of OMPL spaces as state vectors, and OMPL's interpolation on state vectors.
//
// A certificate holds only if core and planner interpolate along the same curve. The core's is lw_robot_interpolate():
// linear, the shorter way for wrapping angles, slerp for quaternions. OMPL's, by subspace, from a to b with d = b - a:
//
//   RealVector  a + d t. Equal to the core's; for a wrapping angle only while |d| < pi, so longer motions are certified in
//               pieces of at most pi / 2.
//   SO2         the shorter way, and a + d t if |d| = pi exactly. Near |d| = pi rounding decides on the shorter way: pieces.
//   SO3         slerp with the sign of b chosen so that <a, b> >= 0, angle theta = acos <a, b>. OMPL's quaternions may be
//               off unit length by 1e-9, which makes theta slightly wrong, but every value is a combination of a and +-b
//               with non-negative weights, so it lies on the same great arc: the set of rotations passed through is the
//               same, only t is shifted (by less than 1e-8). The sign is ambiguous near <a, b> = 0: pieces.
//               For <a, b> > 1 - 1e-9 OMPL keeps a for all t: see hasCloseRotations().
#include "leeway/ompl/validity.hpp"

#include <ompl/base/ScopedState.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/base/spaces/SO2StateSpace.h>
#include <ompl/base/spaces/SO3StateSpace.h>
#include <ompl/base/spaces/WrapperStateSpace.h>
#include <ompl/base/spaces/constraint/ConstrainedStateSpace.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

namespace leeway::ompl
{

namespace ob = ::ompl::base;

namespace
{

constexpr double pi = 3.14159265358979323846;

// Nearer than this to a tie (radians of an angle, scalar product of quaternions) the shorter way is not left to rounding.
// Far above the rounding of either side (1e-15), far below anything that would cost a planner an edge.
constexpr double tie_band = 1e-9;

// OMPL's own threshold is 1 - 1e-9; a little wider, so that differences in rounding never miss a case.
constexpr double close_rotation = 1 - 2e-9;

double dot4( const double* a, const double* b )
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
}

double wrapAngle( double value )
{
	double wrapped = std::fmod( value, 2 * pi );
	if ( wrapped < -pi )
	{
		wrapped += 2 * pi;
	}
	else if ( wrapped >= pi )
	{
		wrapped -= 2 * pi;
	}
	return wrapped;
}

bool sameRotation( const double* a, const double* b )
{
	bool equal = true, opposite = true;
	for ( int i = 0; i < 4; ++i )
	{
		equal = equal && a[i] == b[i];
		opposite = opposite && a[i] == -b[i];
	}
	return equal || opposite;
}

bool closeRotation( const double* a, const double* b )
{
	return std::fabs( dot4( a, b ) ) > close_rotation && !sameRotation( a, b );
}

// The formula of ompl::base::SO2StateSpace::interpolate().
double interpolateAngle( double a, double b, double t )
{
	double d = b - a;
	if ( std::fabs( d ) <= pi )
	{
		return a + d * t;
	}
	d = d > 0 ? d - 2 * pi : d + 2 * pi;
	double value = a + d * t;
	if ( value > pi )
	{
		value -= 2 * pi;
	}
	else if ( value < -pi )
	{
		value += 2 * pi;
	}
	return value;
}

// The formula of ompl::base::SO3StateSpace::interpolate().
void interpolateRotation( const double* a, const double* b, double t, double* out )
{
	const double product = dot4( a, b );
	const double size = std::fabs( product );
	if ( size > 1 - 1e-9 )
	{
		std::copy( a, a + 4, out );
		return;
	}
	const double theta = std::acos( size );
	const double weight_a = std::sin( ( 1 - t ) * theta ) / std::sin( theta );
	const double weight_b = std::copysign( std::sin( t * theta ) / std::sin( theta ), product );
	for ( int i = 0; i < 4; ++i )
	{
		out[i] = a[i] * weight_a + b[i] * weight_b;
	}
}

std::string variableText( const lw_robot* robot, std::uint32_t variable )
{
	return std::string( "joint " ) + lw_robot_joint_name( robot, lw_robot_variable( robot, variable ).joint );
}

} // namespace

StateAdapter::StateAdapter( const ob::StateSpacePtr& space, const Checker& checker ) : m_space( space )
{
	if ( !space || !checker )
	{
		throw std::invalid_argument( "leeway::ompl::StateAdapter: no state space or no checker" );
	}
	const ob::StateSpace* inner = space.get();
	while ( const auto* wrapper = dynamic_cast<const ob::WrapperStateSpace*>( inner ) )
	{
		if ( dynamic_cast<const ob::ConstrainedStateSpace*>( wrapper ) != nullptr )
		{
			m_curve_problem = "space " + space->getName() + " interpolates along a constraint manifold";
		}
		inner = wrapper->getSpace().get();
		++m_wrappers;
	}
	std::vector<unsigned> path;
	collect( inner, path );
	match( checker );
	if ( straight() )
	{
		compareCurves();
	}
}

void StateAdapter::collect( const ob::StateSpace* space, std::vector<unsigned>& path )
{
	auto add = [&]( Kind kind, std::size_t count )
	{
		m_parts.push_back( { kind, path, m_size, count, space } );
		m_size += count;
	};
	if ( const auto* compound = dynamic_cast<const ob::CompoundStateSpace*>( space ) )
	{
		for ( unsigned i = 0; i < compound->getSubspaceCount(); ++i )
		{
			path.push_back( i );
			collect( compound->getSubspace( i ).get(), path );
			path.pop_back();
		}
	}
	else if ( dynamic_cast<const ob::RealVectorStateSpace*>( space ) != nullptr )
	{
		add( Kind::Vector, space->getDimension() );
	}
	else if ( dynamic_cast<const ob::SO2StateSpace*>( space ) != nullptr )
	{
		add( Kind::Angle, 1 );
	}
	else if ( dynamic_cast<const ob::SO3StateSpace*>( space ) != nullptr )
	{
		add( Kind::Rotation, 4 );
	}
	else
	{
		throw std::invalid_argument(
		    "leeway::ompl: subspace " + space->getName() + " is not a RealVector, SO2, SO3, SE2, SE3 or compound space" );
	}
}

void StateAdapter::match( const Checker& checker )
{
	const lw_robot* robot = lw_checker_robot( checker.get() );
	const std::size_t count = lw_checker_variable_count( checker.get() );
	if ( count != m_size )
	{
		throw std::invalid_argument( "leeway::ompl: space " + m_space->getName() + " has " + std::to_string( m_size ) +
		                             " numbers, the checker's state vector has " + std::to_string( count ) );
	}
	for ( const Part& part : m_parts )
	{
		for ( std::size_t i = 0; i < part.count; ++i )
		{
			const auto entry = static_cast<std::uint32_t>( part.first + i );
			const std::uint32_t variable = lw_checker_variable( checker.get(), entry );
			const lw_variable_info info = lw_robot_variable( robot, variable );
			const bool quaternion = lw_robot_joint_type( robot, info.joint ) == LW_JOINT_FLOATING && info.component >= 3;
			const bool fits = part.kind == Kind::Rotation ? quaternion && info.component == 3 + i : !quaternion;
			if ( !fits )
			{
				throw std::invalid_argument( "leeway::ompl: " + variableText( robot, variable ) + ", component " +
				                             std::to_string( info.component ) + ", does not fit its place in subspace " +
				                             part.leaf->getName() +
				                             " (quaternions, and only they, belong in SO3 subspaces)" );
			}
			if ( info.wraps )
			{
				m_wrapping.push_back( part.first + i );
			}
			else if ( part.kind == Kind::Angle )
			{
				m_curve_problem = variableText( robot, variable ) +
				                  " does not wrap and cannot take the shorter way round that subspace " +
				                  part.leaf->getName() + " takes";
			}
		}
	}
}

// Types give the layout. Any of the classes may be derived from, so 200 random motions compare interpolate() with the
// formulas of the layout; an override that agrees on all 200 is taken to implement these formulas.
void StateAdapter::compareCurves()
{
	constexpr int motions = 200;
	constexpr double tolerance = 1e-7; // radians, metres; OMPL's quaternions have 1e-9, other curves differ visibly
	std::mt19937_64 random( 1 );
	std::uniform_real_distribution<double> unit( -1, 1 );
	std::vector<double> a( m_size ), b( m_size ), expected( m_size ), got( m_size );
	auto sample = [&]( std::vector<double>& q )
	{
		for ( const Part& part : m_parts )
		{
			for ( std::size_t i = part.first; i < part.first + part.count; ++i )
			{
				q[i] = unit( random ) * ( part.kind == Kind::Angle ? 3.1 : 1.0 );
			}
			if ( part.kind == Kind::Vector )
			{
				// within the bounds where there are some: overrides may rely on that
				const ob::RealVectorBounds& bounds = static_cast<const ob::RealVectorStateSpace*>( part.leaf )->getBounds();
				for ( std::size_t i = 0; i < part.count; ++i )
				{
					const double low = bounds.low[i], high = bounds.high[i];
					if ( high > low && std::isfinite( high - low ) )
					{
						q[part.first + i] = low + ( high - low ) * ( 0.5 + 0.5 * q[part.first + i] );
					}
				}
			}
		}
		enforceBounds( q.data() );
	};
	try
	{
		ob::ScopedState<> state_a( m_space ), state_b( m_space ), state( m_space );
		for ( int i = 0; i < motions; ++i )
		{
			sample( a );
			sample( b );
			fromVector( a.data(), state_a.get() );
			fromVector( b.data(), state_b.get() );
			const double t = 0.5 + 0.5 * unit( random );
			m_space->interpolate( state_a.get(), state_b.get(), t, state.get() );
			toVector( state.get(), got.data() );
			interpolate( a.data(), b.data(), t, expected.data() );
			for ( std::size_t k = 0; k < m_size; ++k )
			{
				const double scale = std::max( { 1.0, std::fabs( a[k] ), std::fabs( b[k] ) } );
				if ( !( std::fabs( got[k] - expected[k] ) <= tolerance * scale ) )
				{
					m_curve_problem =
					    "space " + m_space->getName() + " does not interpolate straight (Dubins, Reeds-Shepp, ...)";
					return;
				}
			}
		}
	}
	catch ( const std::exception& error )
	{
		m_curve_problem = "space " + m_space->getName() + " could not interpolate: " + error.what();
	}
}

const ob::State* StateAdapter::component( const ob::State* state, const Part& part ) const
{
	for ( unsigned i = 0; i < m_wrappers; ++i )
	{
		state = static_cast<const ob::WrapperStateSpace::StateType*>( state )->getState();
	}
	for ( unsigned index : part.path )
	{
		state = static_cast<const ob::CompoundState*>( state )->components[index];
	}
	return state;
}

void StateAdapter::toVector( const ob::State* state, double* q ) const
{
	for ( const Part& part : m_parts )
	{
		const ob::State* leaf = component( state, part );
		double* out = q + part.first;
		switch ( part.kind )
		{
		case Kind::Vector:
		{
			const double* values = static_cast<const ob::RealVectorStateSpace::StateType*>( leaf )->values;
			std::copy( values, values + part.count, out );
			break;
		}
		case Kind::Angle:
			out[0] = static_cast<const ob::SO2StateSpace::StateType*>( leaf )->value;
			break;
		case Kind::Rotation:
		{
			const auto* rotation = static_cast<const ob::SO3StateSpace::StateType*>( leaf );
			out[0] = rotation->x;
			out[1] = rotation->y;
			out[2] = rotation->z;
			out[3] = rotation->w;
			break;
		}
		}
	}
}

void StateAdapter::fromVector( const double* q, ob::State* state ) const
{
	for ( const Part& part : m_parts )
	{
		// the walk is the same as for reading; the state that was given may be written
		ob::State* leaf = const_cast<ob::State*>( component( state, part ) );
		const double* in = q + part.first;
		switch ( part.kind )
		{
		case Kind::Vector:
			std::copy( in, in + part.count, static_cast<ob::RealVectorStateSpace::StateType*>( leaf )->values );
			break;
		case Kind::Angle:
			static_cast<ob::SO2StateSpace::StateType*>( leaf )->value = wrapAngle( in[0] );
			break;
		case Kind::Rotation:
		{
			auto* rotation = static_cast<ob::SO3StateSpace::StateType*>( leaf );
			rotation->x = in[0];
			rotation->y = in[1];
			rotation->z = in[2];
			rotation->w = in[3];
			break;
		}
		}
	}
}

void StateAdapter::interpolate( const double* a, const double* b, double t, double* out ) const
{
	for ( const Part& part : m_parts )
	{
		const std::size_t first = part.first;
		switch ( part.kind )
		{
		case Kind::Vector:
			for ( std::size_t i = first; i < first + part.count; ++i )
			{
				out[i] = a[i] + ( b[i] - a[i] ) * t;
			}
			break;
		case Kind::Angle:
			out[first] = interpolateAngle( a[first], b[first], t );
			break;
		case Kind::Rotation:
			interpolateRotation( a + first, b + first, t, out + first );
			break;
		}
	}
}

unsigned StateAdapter::pieceCount( const double* a, const double* b ) const
{
	// A wrapping angle moves by any amount in a RealVector, and by at most pi in SO2, where pi + x means pi - x
	double largest = 0;
	for ( std::size_t i : m_wrapping )
	{
		largest = std::max( largest, std::fabs( b[i] - a[i] ) );
	}
	unsigned count = 1;
	if ( largest > pi - tie_band )
	{
		for ( const Part& part : m_parts )
		{
			for ( std::size_t i = part.first; i < part.first + part.count; ++i )
			{
				if ( std::find( m_wrapping.begin(), m_wrapping.end(), i ) == m_wrapping.end() )
				{
					continue;
				}
				double d = std::fabs( b[i] - a[i] );
				if ( part.kind == Kind::Angle && d > pi )
				{
					d = 2 * pi - d;
				}
				if ( d > pi - tie_band )
				{
					// parts of at most pi / 2, with a bound that keeps nonsense (infinite bounds) from overflowing
					count = std::max( count, 1 + static_cast<unsigned>( std::min( d / ( pi / 2 ), 1e6 ) ) );
				}
			}
		}
	}
	for ( const Part& part : m_parts )
	{
		if ( part.kind == Kind::Rotation && std::fabs( dot4( a + part.first, b + part.first ) ) < tie_band )
		{
			count = std::max( count, 2u );
		}
	}
	return count;
}

bool StateAdapter::hasCloseRotations( const double* a, const double* b ) const
{
	return std::any_of( m_parts.begin(), m_parts.end(),
	    [&]( const Part& part ) { return part.kind == Kind::Rotation && closeRotation( a + part.first, b + part.first ); } );
}

void StateAdapter::replaceCloseRotations( const double* from, double* q ) const
{
	for ( const Part& part : m_parts )
	{
		if ( part.kind == Kind::Rotation && closeRotation( from + part.first, q + part.first ) )
		{
			std::copy( from + part.first, from + part.first + 4, q + part.first );
		}
	}
}

void StateAdapter::enforceBounds( double* q ) const
{
	for ( const Part& part : m_parts )
	{
		double* values = q + part.first;
		switch ( part.kind )
		{
		case Kind::Vector:
		{
			const ob::RealVectorBounds& bounds = static_cast<const ob::RealVectorStateSpace*>( part.leaf )->getBounds();
			for ( std::size_t i = 0; i < part.count; ++i )
			{
				if ( bounds.low[i] < bounds.high[i] )
				{
					values[i] = std::min( std::max( values[i], bounds.low[i] ), bounds.high[i] );
				}
			}
			break;
		}
		case Kind::Angle:
			values[0] = wrapAngle( values[0] );
			break;
		case Kind::Rotation:
		{
			const double length = std::sqrt( dot4( values, values ) );
			for ( int i = 0; i < 4; ++i )
			{
				values[i] = length > 0 ? values[i] / length : ( i == 3 ? 1.0 : 0.0 );
			}
			break;
		}
		}
	}
}

} // namespace leeway::ompl
