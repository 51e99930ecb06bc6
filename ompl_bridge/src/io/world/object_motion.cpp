// SPDX-License-Identifier: BSD-3-Clause
// Pieces of an object's motion, as the file gives them.
#include "world/object_motion.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace leeway::io::detail
{

namespace
{

/// Each is a joint of the object's chain.
constexpr std::size_t most_lines = 64;

Vector3 vectorOf( const YamlNode& node )
{
	const std::vector<double> v = node.vector( { "x", "y", "z" } );
	const double largest = std::max( { std::fabs( v[0] ), std::fabs( v[1] ), std::fabs( v[2] ) } );
	if ( largest > LW_MAX_TRANSLATION )
	{
		node.fail( fmt::format( "{} is beyond {:g} m", largest, double( LW_MAX_TRANSLATION ) ), "give metres" );
	}
	return { v[0], v[1], v[2] };
}

Vector3 shiftTo( const Vector3& to, const lw_transform& from )
{
	return { to[0] - from.t[0], to[1] - from.t[1], to[2] - from.t[2] };
}

/// Control points of a position, as shifts.
std::vector<Vector3> readPoints( const YamlNode& points, const lw_transform& now )
{
	const std::size_t count = points.size();
	if ( count < 2 || count > LW_CURVE_MOST_DEGREE + 1 )
	{
		points.fail( fmt::format( "has {} control points: a curve of degree {}", count, static_cast<long>( count ) - 1 ),
		    fmt::format( "give 2 to {} points, or cut the curve into pieces", LW_CURVE_MOST_DEGREE + 1 ) );
	}
	std::vector<Vector3> shifts;
	for ( std::size_t k = 0; k < count; ++k )
	{
		shifts.push_back( shiftTo( vectorOf( points[k] ), now ) );
	}
	const double jump = std::hypot( shifts[0][0], shifts[0][1], shifts[0][2] );
	if ( jump > ObjectChain::closing )
	{
		points[std::size_t( 0 )].fail( fmt::format( "the object jumps: it is {:g} m from there, at [{:g}, {:g}, {:g}]", jump,
		                                   now.t[0], now.t[1], now.t[2] ),
		    "begin where the piece before ends" );
	}
	shifts[0] = { 0, 0, 0 };
	return shifts;
}

/// A rigid turn, and the shift along its axis.
LineTurn readTurn( const YamlNode& turn, const lw_transform& now, std::vector<Vector3>& shifts )
{
	turn.refuseUnknownKeys( { "axis", "point", "angle", "shift" } );
	Vector3 axis = vectorOf( turn["axis"] );
	const double length = std::hypot( axis[0], axis[1], axis[2] );
	if ( !( length > 1e-9 ) )
	{
		turn["axis"].fail( "has no direction", "give a vector that is not zero" );
	}
	for ( double& coordinate : axis )
	{
		coordinate /= length;
	}
	const Vector3 point = turn["point"].defined() ? vectorOf( turn["point"] ) : Vector3{ now.t[0], now.t[1], now.t[2] };
	const double shift = turn["shift"].defined() ? turn["shift"].number() : 0;
	shifts = { { 0, 0, 0 }, { shift * axis[0], shift * axis[1], shift * axis[2] } };
	return { axis, point, turn["angle"].number() };
}

void readPiece( const YamlNode& piece, ObjectChain& chain )
{
	const lw_transform now = chain.pose();
	const YamlNode position = piece["position"], orientation = piece["orientation"], points = piece["points"],
	               turn = piece["turn"];
	if ( !position.defined() && !orientation.defined() && !points.defined() && !turn.defined() )
	{
		piece.fail( "has no motion", "give position, orientation, points or turn; between pieces the object rests" );
	}
	if ( ( position.defined() && points.defined() ) ||
	     ( turn.defined() && ( position.defined() || points.defined() || orientation.defined() ) ) )
	{
		piece.fail( "has two motions at once",
		    "give one of position and points, perhaps with orientation, or turn alone, or cut it into pieces" );
	}
	std::vector<Vector3> shifts = { { 0, 0, 0 }, { 0, 0, 0 } };
	std::optional<LineTurn> line;
	if ( position.defined() )
	{
		shifts[1] = shiftTo( vectorOf( position ), now );
	}
	if ( points.defined() )
	{
		shifts = readPoints( points, now );
	}
	if ( turn.defined() )
	{
		line = readTurn( turn, now, shifts );
	}
	if ( orientation.defined() )
	{
		const std::array<double, 4> q = orientation.quaternion();
		lw_transform target;
		require( lw_transform_from_quaternion( now.t, q.data(), &target ), "lw_transform_from_quaternion" );
		line = turnBetween( now, target );
	}
	chain.add( piece["start"].number(), piece["end"].number(), shifts, line );
	if ( chain.lineCount() > most_lines )
	{
		piece.fail( fmt::format( "the object has turned about more than {} lines by then", most_lines ),
		    "turn about the same axes again, in its own frame" );
	}
}

void readLoop( const YamlNode& repeat, double begin, double end, ObjectChain& chain )
{
	const double period = repeat.number();
	if ( !( period >= end - begin ) || !( period > 0 ) )
	{
		repeat.fail( fmt::format( "{} s is shorter than the motion, which takes {} s", period, end - begin ),
		    "give the seconds after which the motion begins again" );
	}
	const ObjectChain::Gap gap = chain.gap();
	if ( gap.distance > ObjectChain::closing || gap.angle > ObjectChain::closing )
	{
		repeat.fail( fmt::format( "the loop does not close: its last pose is {:g} m and {:g} rad from its first one",
		                 gap.distance, gap.angle ),
		    "end the motion at the pose of the object" );
	}
	if ( gap.joints )
	{
		repeat.fail( "the loop comes back to its first orientation about another axis than it left: its joints do not close",
		    "turn back about the same axes, in the opposite order, or by whole turns" );
	}
	chain.close( period );
}

} // namespace

void readMotion( const YamlNode& object, ObjectChain& chain )
{
	const YamlNode motion = object["motion"], repeat = object["repeat"];
	double end = 0;
	for ( std::size_t i = 0; i < motion.size(); ++i )
	{
		const YamlNode piece = motion[i];
		piece.refuseUnknownKeys( { "start", "end", "position", "orientation", "points", "turn" } );
		const double from = piece["start"].number(), to = piece["end"].number();
		if ( !( from < to ) )
		{
			piece.fail( fmt::format( "begins at {} s and ends at {} s: the clock runs backwards", from, to ),
			    "give an end after the start" );
		}
		if ( i > 0 && from < end )
		{
			piece.fail(
			    fmt::format( "begins at {} s, before the end of the one before, {} s: the clock runs backwards", from, end ),
			    "give pieces in the order of time" );
		}
		end = to;
		readPiece( piece, chain );
	}
	if ( repeat.defined() && motion.size() == 0 )
	{
		repeat.fail( "there is no motion to repeat", "give motion, or remove this" );
	}
	if ( repeat.defined() )
	{
		readLoop( repeat, motion[std::size_t( 0 )]["start"].number(), end, chain );
	}
}

} // namespace leeway::io::detail
