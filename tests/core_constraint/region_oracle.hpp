// SPDX-License-Identifier: BSD-3-Clause
// Errors of a region in long double, written anew: matrices, Rodrigues' formula, Bernstein polynomials.
#pragma once

#include "leeway/constraint.h"
#include "owned_clock.hpp"
#include "random_robot.hpp"

#include <array>
#include <cmath>

using Errors = std::array<long double, LW_REGION_LIMITS>;

inline Matrix inverseOf( const Matrix& m )
{
	Matrix out = identityMatrix();
	for ( int i = 0; i < 3; ++i )
	{
		for ( int j = 0; j < 3; ++j )
		{
			out[i][j] = m[j][i];
			out[i][3] -= m[j][i] * m[j][3];
		}
	}
	return out;
}

inline Matrix turnBy( const lw_vec3& by, long double share )
{
	const long double angle =
	    share * std::sqrt( static_cast<long double>( by.x ) * by.x + static_cast<long double>( by.y ) * by.y +
	                       static_cast<long double>( by.z ) * by.z );
	return rodrigues( { by.x, by.y, by.z }, std::sin( angle ), std::cos( angle ) );
}

/// Value of a variable of a track at a share of one of its pieces.
inline long double bernsteinAt( const OwnedPiece& piece, std::size_t stride, std::size_t variable, long double u )
{
	std::vector<long double> p;
	for ( unsigned k = 0; k <= piece.degree; ++k )
	{
		p.push_back( piece.points[k * stride + variable] );
	}
	for ( unsigned k = piece.degree; k > 0; --k )
	{
		for ( unsigned i = 0; i < k; ++i )
		{
			p[i] = ( 1 - u ) * p[i] + u * p[i + 1];
		}
	}
	return p[0];
}

/// Errors at a state, angles as lw_turns says; NaN at a gimbal lock.
inline Errors errorsAt(
    const RobotModel& model, const lw_robot* robot, const lw_region_def& def, const State& q, long double fraction )
{
	const auto frame = [&]( std::uint32_t link, const lw_transform& offset ) {
		return product(
		    link == LW_INVALID_INDEX ? identityMatrix() : oraclePose( model, robot, link, q ), matrixOf( offset ) );
	};
	const Matrix b = product( inverseOf( frame( def.base_link, def.base_from_a ) ), frame( def.link, def.link_from_b ) );
	const Matrix start = matrixOf( def.start ), arc = turnBy( def.arc, fraction );
	Matrix reference = product( turnBy( def.turn, fraction ), start );
	const long double center[3] = { def.center.x, def.center.y, def.center.z };
	const long double shift[3] = { def.shift.x, def.shift.y, def.shift.z };
	for ( int i = 0; i < 3; ++i )
	{
		reference[i][3] = center[i] + fraction * shift[i];
		for ( int k = 0; k < 3; ++k )
		{
			reference[i][3] += arc[i][k] * ( start[k][3] - center[k] );
		}
	}
	const Matrix turn = product( inverseOf( reference ), b );
	Errors e = {};
	long double square = 0, tilt = 0;
	const long double axis[3] = { def.axis.x, def.axis.y, def.axis.z };
	const long double length = std::sqrt( axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2] );
	for ( int i = 0; i < 3; ++i )
	{
		long double moved = -axis[i] / length;
		for ( int k = 0; k < 3; ++k )
		{
			e[static_cast<std::size_t>( i )] += start[k][i] * ( b[k][3] - reference[k][3] );
			square += ( turn[i][k] - ( i == k ) ) * ( turn[i][k] - ( i == k ) );
			moved += turn[i][k] * axis[k] / length;
		}
		tilt += moved * moved;
	}
	const long double chord = std::min( 1.0L, std::sqrt( square / 8 ) );
	e[LW_REGION_ANGLE] = 2 * std::asin( chord );
	e[LW_REGION_TILT] = 2 * std::asin( std::min( 1.0L, std::sqrt( tilt ) / 2 ) );
	if ( def.turns_are == LW_TURNS_XYZ )
	{
		e[LW_REGION_TURN_X] = std::atan2( -turn[1][2], turn[2][2] );
		e[LW_REGION_TURN_Y] = std::asin( std::max( -1.0L, std::min( 1.0L, turn[0][2] ) ) );
		e[LW_REGION_TURN_Z] = std::atan2( -turn[0][1], turn[0][0] );
		return e;
	}
	const long double half[3] = { turn[2][1] - turn[1][2], turn[0][2] - turn[2][0], turn[1][0] - turn[0][1] };
	const long double sine = std::sqrt( half[0] * half[0] + half[1] * half[1] + half[2] * half[2] );
	for ( std::size_t i = 0; i < 3; ++i )
	{
		// within 0.1 rad of half a turn the axis is not known well from this part
		e[LW_REGION_TURN_X + i] = e[LW_REGION_ANGLE] > 3 ? NAN : sine > 0 ? half[i] / sine * e[LW_REGION_ANGLE] : 0;
	}
	return e;
}
