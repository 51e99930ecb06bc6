// SPDX-License-Identifier: BSD-3-Clause
// Poses of an MJCF model: five ways to write an orientation, and fromto. All arithmetic is that of quaternions and vectors in
// double.
#include "mjcf/settings.hpp"

#include <array>
#include <cctype>
#include <cmath>
#include <cstring>
#include <fmt/format.h>

namespace leeway::io::detail::mjcf
{

namespace
{

using Vector = std::array<double, 3>;

constexpr double too_small = 1e-14; // MuJoCo's own bound for directions

Vector vectorOf( const std::vector<double>& numbers, std::size_t first = 0 )
{
	return { numbers[first], numbers[first + 1], numbers[first + 2] };
}

double dot( const Vector& a, const Vector& b )
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// @return false if it has no direction
bool normalise( Vector& v )
{
	const double length = std::hypot( v[0], v[1], v[2] );
	if ( !( length > too_small ) || !std::isfinite( length ) )
	{
		return false;
	}
	v = { v[0] / length, v[1] / length, v[2] / length };
	return true;
}

/// Columns x, y, z.
lw_transform fromAxes( const Vector& x, const Vector& y, const Vector& z )
{
	lw_transform out = lw_transform_identity();
	for ( std::size_t row = 0; row < 3; ++row )
	{
		out.r[row][0] = x[row];
		out.r[row][1] = y[row];
		out.r[row][2] = z[row];
	}
	return out;
}

/// The least turn from the z axis to a unit vector; half a turn about x for the opposite direction.
lw_transform leastTurn( const Vector& z )
{
	const Vector axis = { -z[1], z[0], 0 };
	const double length = std::hypot( axis[0], axis[1] );
	if ( length < 1e-10 )
	{
		const double x[3] = { 1, 0, 0 };
		return z[2] < 0 ? aboutAxis( x, 3.14159265358979323846 ) : lw_transform_identity();
	}
	const double unit[3] = { axis[0] / length, axis[1] / length, 0 };
	return aboutAxis( unit, std::atan2( length, z[2] ) );
}

} // namespace

bool fromQuaternion( const double position[3], const double wxyz[4], lw_transform& out )
{
	const double xyzw[4] = { wxyz[1], wxyz[2], wxyz[3], wxyz[0] };
	return lw_transform_from_quaternion( position, xyzw, &out ) == LW_OK;
}

lw_transform aboutAxis( const double axis[3], double angle )
{
	const double s = std::sin( angle / 2 ), zero[3] = { 0, 0, 0 };
	const double wxyz[4] = { std::cos( angle / 2 ), s * axis[0], s * axis[1], s * axis[2] };
	lw_transform out = lw_transform_identity();
	(void)fromQuaternion( zero, wxyz, out );
	return out;
}

lw_transform shiftBy( double x, double y, double z )
{
	lw_transform out = lw_transform_identity();
	out.t[0] = x;
	out.t[1] = y;
	out.t[2] = z;
	return out;
}

lw_transform Poses::turn( const std::vector<double>& position, const std::vector<double>& euler ) const
{
	lw_transform out = lw_transform_identity();
	for ( std::size_t i = 0; i < 3; ++i )
	{
		const char axis = m_compiler.euler[i];
		double unit[3] = { 0, 0, 0 };
		unit[std::tolower( axis ) - 'x'] = 1;
		const lw_transform step = aboutAxis( unit, m_compiler.angle( euler[i] ) );
		out = axis >= 'x' ? lw_transform_multiply( &out, &step ) : lw_transform_multiply( &step, &out );
	}
	std::copy( position.begin(), position.end(), out.t );
	return out;
}

lw_transform Poses::read(
    const XMLElement* position, const XMLElement* orientation, const char* kind, const std::string& what ) const
{
	const std::vector<double> at =
	    position != nullptr ? m_document.numbers( *position, what, "pos", 3, 3 ) : std::vector<double>( 3, 0.0 );
	lw_transform out = lw_transform_identity();
	const std::string way = kind != nullptr ? kind : "";
	const auto bad = [&]( const char* problem )
	{
		m_document.fail( *orientation, what, fmt::format( "{}=\"{}\" {}", way, orientation->Attribute( kind ), problem ),
		    "give directions that are not zero" );
	};
	if ( way == "quat" )
	{
		const std::vector<double> q = m_document.numbers( *orientation, what, kind, 4, 4 );
		if ( !fromQuaternion( at.data(), q.data(), out ) )
		{
			bad( "is the zero quaternion" );
		}
	}
	else if ( way == "euler" )
	{
		out = turn( at, m_document.numbers( *orientation, what, kind, 3, 3 ) );
	}
	else if ( way == "axisangle" )
	{
		const std::vector<double> a = m_document.numbers( *orientation, what, kind, 4, 4 );
		Vector axis = vectorOf( a );
		if ( !normalise( axis ) )
		{
			bad( "has no axis" );
		}
		out = aboutAxis( axis.data(), m_compiler.angle( a[3] ) );
	}
	else if ( way == "xyaxes" )
	{
		const std::vector<double> a = m_document.numbers( *orientation, what, kind, 6, 6 );
		Vector x = vectorOf( a ), y = vectorOf( a, 3 );
		bool good = normalise( x );
		const double along = dot( x, y );
		y = { y[0] - along * x[0], y[1] - along * x[1], y[2] - along * x[2] };
		good = normalise( y ) && good;
		if ( !good )
		{
			bad( "has no two directions" );
		}
		out = fromAxes( x, y, { x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0] } );
	}
	else if ( way == "zaxis" )
	{
		Vector z = vectorOf( m_document.numbers( *orientation, what, kind, 3, 3 ) );
		if ( !normalise( z ) )
		{
			bad( "has no direction" );
		}
		out = leastTurn( z );
	}
	std::copy( at.begin(), at.end(), out.t );
	return out;
}

lw_transform Poses::own( const XMLElement& element, const std::string& what ) const
{
	const char* kind = orientationOf( m_document, element );
	return read(
	    element.Attribute( "pos" ) != nullptr ? &element : nullptr, kind != nullptr ? &element : nullptr, kind, what );
}

lw_transform Poses::ofClass( const XMLElement& element, const std::string& what, const std::string& child_class ) const
{
	const auto [orientation, kind] = m_defaults.findOrientation( element, child_class );
	return read( m_defaults.find( element, child_class, "pos" ), orientation, kind, what );
}

lw_transform Poses::between( const XMLElement& carrier, const std::string& what, double& length ) const
{
	const std::vector<double> ends = m_document.numbers( carrier, what, "fromto", 6, 6 );
	Vector along = { ends[0] - ends[3], ends[1] - ends[4], ends[2] - ends[5] }; // as MuJoCo has it, not as its page says
	length = std::hypot( along[0], along[1], along[2] );
	if ( !normalise( along ) )
	{
		m_document.fail( carrier, what,
		    fmt::format( "fromto=\"{}\" joins a point with itself", carrier.Attribute( "fromto" ) ),
		    "give two different points" );
	}
	lw_transform out = leastTurn( along );
	for ( std::size_t k = 0; k < 3; ++k )
	{
		out.t[k] = 0.5 * ends[k] + 0.5 * ends[k + 3];
	}
	return out;
}

} // namespace leeway::io::detail::mjcf
