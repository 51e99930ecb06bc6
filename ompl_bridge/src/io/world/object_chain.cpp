// SPDX-License-Identifier: BSD-3-Clause
// The motion of an object as joints: see object_chain.hpp.
#include "world/object_chain.hpp"

#include "base/io_internal.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <tuple>

namespace leeway::io::detail
{

namespace
{

/// Lines closer than this, in radians and metres, are one: an object is off by no more. Smaller shifts and turns are none.
constexpr double same = 1e-9;

double dot( const Vector3& a, const Vector3& b )
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

Vector3 cross( const Vector3& a, const Vector3& b )
{
	return { a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0] };
}

double length( const Vector3& a )
{
	return std::hypot( a[0], a[1], a[2] );
}

Vector3 difference( const Vector3& a, const Vector3& b )
{
	return { a[0] - b[0], a[1] - b[1], a[2] - b[2] };
}

lw_transform shift( const Vector3& by )
{
	lw_transform out = lw_transform_identity();
	std::copy( by.begin(), by.end(), out.t );
	return out;
}

lw_transform rotation( const Vector3& axis, double angle )
{
	const double s = std::sin( 0.5 * angle ), origin[3] = { 0, 0, 0 };
	const double q[4] = { s * axis[0], s * axis[1], s * axis[2], std::cos( 0.5 * angle ) };
	lw_transform out;
	require( lw_transform_from_quaternion( origin, q, &out ), "lw_transform_from_quaternion" );
	return out;
}

/// @param of a pose or its inverse
Vector3 rotated( const lw_transform& of, const Vector3& v )
{
	Vector3 out;
	for ( std::size_t i = 0; i < 3; ++i )
	{
		out[i] = of.r[i][0] * v[0] + of.r[i][1] * v[1] + of.r[i][2] * v[2];
	}
	return out;
}

Vector3 moved( const lw_transform& by, const Vector3& point )
{
	const lw_vec3 p = lw_transform_point( &by, { point[0], point[1], point[2] } );
	return { p.x, p.y, p.z };
}

/// Axis times sine of half the angle, and the angle: 0 to pi.
std::pair<Vector3, double> turnOf( const lw_transform& pose )
{
	double q[4];
	lw_transform_to_quaternion( &pose, q );
	const Vector3 v = { q[0], q[1], q[2] };
	return { v, 2 * std::atan2( length( v ), q[3] ) };
}

/// A joint that is not yet there is at 0.
double valueOf( const std::vector<double>& row, std::size_t i )
{
	return i < row.size() ? row[i] : 0.0;
}

Vector3 positionOf( const lw_transform& pose )
{
	return { pose.t[0], pose.t[1], pose.t[2] };
}

} // namespace

std::optional<LineTurn> turnBetween( const lw_transform& from, const lw_transform& to )
{
	const lw_transform back = lw_transform_inverse( &from ), relative = lw_transform_multiply( &back, &to );
	const auto [v, angle] = turnOf( relative );
	if ( !( angle > same ) )
	{
		return std::nullopt;
	}
	const double size = length( v );
	return LineTurn{ rotated( from, { v[0] / size, v[1] / size, v[2] / size } ), positionOf( from ), angle };
}

lw_transform ObjectChain::turned( std::size_t j ) const
{
	const Vector3& p = m_lines[j].point;
	const lw_transform there = shift( p ), turn = rotation( m_lines[j].axis, m_values[3 + j] ),
	                   back = shift( { -p[0], -p[1], -p[2] } ), half = lw_transform_multiply( &there, &turn );
	return lw_transform_multiply( &half, &back );
}

lw_transform ObjectChain::pose() const
{
	lw_transform out = m_first;
	for ( std::size_t j = 0; j < m_lines.size(); ++j )
	{
		const lw_transform turn = turned( j );
		out = lw_transform_multiply( &out, &turn );
	}
	for ( std::size_t i = 0; i < 3; ++i )
	{
		out.t[i] += m_values[i];
	}
	return out;
}

std::pair<std::size_t, double> ObjectChain::jointOf( const Line& line )
{
	lw_transform before_from_now = lw_transform_identity(); // before the line's joint
	for ( std::size_t j = m_lines.size(); j-- > 0; )
	{
		const lw_transform now_from_before = lw_transform_inverse( &before_from_now );
		const Vector3 axis = rotated( now_from_before, m_lines[j].axis ), point = moved( now_from_before, m_lines[j].point );
		if ( length( cross( axis, line.axis ) ) < same && length( cross( difference( point, line.point ), axis ) ) < same )
		{
			return { j, dot( axis, line.axis ) > 0 ? 1.0 : -1.0 };
		}
		const lw_transform turn = turned( j );
		before_from_now = lw_transform_multiply( &turn, &before_from_now );
	}
	m_lines.push_back( line );
	m_values.push_back( 0 );
	return { m_lines.size() - 1, 1.0 };
}

void ObjectChain::add( double start, double end, const std::vector<Vector3>& shifts, const std::optional<LineTurn>& turn )
{
	std::size_t joint = 0;
	double angle = 0;
	if ( turn )
	{
		const lw_transform world_from_now = pose(), now_from_world = lw_transform_inverse( &world_from_now );
		const auto [j, sign] = jointOf( { rotated( now_from_world, turn->axis ), moved( now_from_world, turn->point ) } );
		joint = 3 + j;
		angle = sign * turn->angle;
	}
	Piece piece{ start, end, {} };
	const double degree = static_cast<double>( shifts.size() - 1 );
	for ( std::size_t k = 0; k < shifts.size(); ++k )
	{
		std::vector<double> row = m_values;
		for ( std::size_t i = 0; i < 3; ++i )
		{
			row[i] += shifts[k][i];
		}
		row[joint] += angle * ( static_cast<double>( k ) / degree ); // linear, written with as many points
		piece.rows.push_back( std::move( row ) );
	}
	m_values = piece.rows.back();
	m_pieces.push_back( std::move( piece ) );
}

ObjectChain::Gap ObjectChain::gap() const
{
	const lw_transform now = pose(), back = lw_transform_inverse( &m_first ),
	                   relative = lw_transform_multiply( &back, &now );
	Gap out;
	out.distance = length( difference( positionOf( now ), positionOf( m_first ) ) );
	out.angle = turnOf( relative ).second;
	for ( std::size_t i = 0; i < m_values.size(); ++i )
	{
		const double off = i < 3 ? m_values[i] : std::remainder( m_values[i], 2 * pi );
		out.joints = out.joints || !( std::fabs( off ) <= closing );
	}
	return out;
}

void ObjectChain::close( double period )
{
	m_period = period;
	m_advance.assign( m_values.size(), 0.0 );
	for ( std::size_t i = 3; i < m_values.size(); ++i )
	{
		m_advance[i] = 2 * pi * std::round( m_values[i] / ( 2 * pi ) );
	}
	std::vector<double>& last = m_pieces.back().rows.back();
	std::copy_n( m_advance.begin(), last.size(), last.begin() );
}

std::pair<double, double> ObjectChain::rangeOf( std::size_t value ) const
{
	std::pair<double, double> range( 0, 0 );
	for ( const Piece& piece : m_pieces )
	{
		for ( const std::vector<double>& row : piece.rows )
		{
			range.first = std::min( range.first, valueOf( row, value ) );
			range.second = std::max( range.second, valueOf( row, value ) );
		}
	}
	return range;
}

void ObjectChain::append(
    Tail& tail, const std::string& name, lw_joint_type type, const Vector3& axis, std::size_t value ) const
{
	JointModel joint;
	joint.name = name;
	joint.type = type;
	joint.parent = tail.parent;
	joint.child = name;
	joint.parent_from_joint = tail.to_joint;
	std::copy( axis.begin(), axis.end(), joint.axis );
	if ( type != LW_JOINT_FIXED )
	{
		std::tie( joint.lower, joint.upper ) = rangeOf( value );
		tail.values.push_back( value );
		tail.part.variables.push_back( name );
	}
	tail.model.joints.push_back( joint );
	LinkModel link;
	link.name = name;
	tail.model.links.push_back( std::move( link ) );
	tail.parent = name;
	tail.to_joint = lw_transform_identity();
}

/// State, tolerances and pieces of the values that have joints.
void ObjectChain::tell( const std::vector<std::size_t>& values, WorldPart& part ) const
{
	part.state.assign( values.size(), 0.0 );
	part.tolerance.assign( values.size(), 0.0 );
	part.period = m_period;
	for ( std::size_t value : values )
	{
		if ( m_period > 0 )
		{
			part.advance.push_back( valueOf( m_advance, value ) );
		}
	}
	for ( const Piece& piece : m_pieces )
	{
		TimedPiece out{ piece.start, piece.end, static_cast<unsigned>( piece.rows.size() - 1 ), {} };
		for ( const std::vector<double>& row : piece.rows )
		{
			for ( std::size_t value : values )
			{
				out.points.push_back( valueOf( row, value ) );
			}
		}
		part.pieces.push_back( std::move( out ) );
	}
}

void ObjectChain::build(
    const std::string& root, const std::vector<PlacedShape>& shapes, WorldPart& part, RobotModel& model ) const
{
	Tail tail{ part, model, root, shift( positionOf( m_first ) ), {} };
	const char* const names[3] = { "/x", "/y", "/z" };
	for ( std::size_t i = 0; i < 3; ++i )
	{
		const auto [low, high] = rangeOf( i );
		const bool carries_spread = i == 0 && part.spread_speed > 0;
		if ( high - low > same || carries_spread )
		{
			Vector3 axis = { 0, 0, 0 };
			axis[i] = 1;
			append( tail, part.name + names[i], LW_JOINT_PRISMATIC, axis, i );
		}
	}
	lw_transform orientation = m_first;
	std::fill( orientation.t, orientation.t + 3, 0.0 );
	tail.to_joint = lw_transform_multiply( &tail.to_joint, &orientation );
	for ( std::size_t j = 0; j < m_lines.size(); ++j )
	{
		const lw_transform there = shift( m_lines[j].point );
		tail.to_joint = lw_transform_multiply( &tail.to_joint, &there );
		const bool goes_on = valueOf( m_advance, 3 + j ) != 0;
		append( tail, fmt::format( "{}/turn{}", part.name, j + 1 ), goes_on ? LW_JOINT_CONTINUOUS : LW_JOINT_REVOLUTE,
		    m_lines[j].axis, 3 + j );
		tail.to_joint = lw_transform_inverse( &there );
	}
	append( tail, part.name, LW_JOINT_FIXED, { 1, 0, 0 }, 0 );
	model.links.back().collision = shapes;
	tell( tail.values, part );
}

} // namespace leeway::io::detail
