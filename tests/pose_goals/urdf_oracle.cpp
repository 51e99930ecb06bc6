// SPDX-License-Identifier: BSD-3-Clause
// Forward kinematics of the tests.
#include "urdf_oracle.hpp"

#include <cmath>
#include <sstream>
#include <stdexcept>
#include <tinyxml2.h>

namespace
{

std::array<double, 3> numbers( const tinyxml2::XMLElement* element, const char* attribute, std::array<double, 3> fallback )
{
	const char* text = element != nullptr ? element->Attribute( attribute ) : nullptr;
	if ( text != nullptr )
	{
		std::istringstream stream( text );
		stream >> fallback[0] >> fallback[1] >> fallback[2];
	}
	return fallback;
}

/// Rodrigues' formula.
Matrix turned( std::array<double, 3> axis, double angle )
{
	const double length = std::sqrt( axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2] );
	for ( double& a : axis )
	{
		a /= length;
	}
	const double c = std::cos( angle ), s = std::sin( angle ), v = 1 - c;
	const auto& [x, y, z] = axis;
	Matrix m = identity();
	m[0] = { c + x * x * v, x * y * v - z * s, x * z * v + y * s, 0 };
	m[1] = { y * x * v + z * s, c + y * y * v, y * z * v - x * s, 0 };
	m[2] = { z * x * v - y * s, z * y * v + x * s, c + z * z * v, 0 };
	return m;
}

} // namespace

Matrix identity()
{
	Matrix m{};
	for ( std::size_t i = 0; i < 4; ++i )
	{
		m[i][i] = 1;
	}
	return m;
}

Matrix product( const Matrix& a, const Matrix& b )
{
	Matrix m{};
	for ( std::size_t i = 0; i < 4; ++i )
	{
		for ( std::size_t j = 0; j < 4; ++j )
		{
			for ( std::size_t k = 0; k < 4; ++k )
			{
				m[i][j] += a[i][k] * b[k][j];
			}
		}
	}
	return m;
}

Matrix inverseOf( const Matrix& a )
{
	Matrix m = identity();
	for ( std::size_t i = 0; i < 3; ++i )
	{
		for ( std::size_t j = 0; j < 3; ++j )
		{
			m[i][j] = a[j][i];
			m[i][3] -= a[j][i] * a[j][3];
		}
	}
	return m;
}

Matrix fromQuaternion( const std::array<double, 3>& position, const std::array<double, 4>& q )
{
	const double sine = std::sqrt( q[0] * q[0] + q[1] * q[1] + q[2] * q[2] );
	Matrix m = sine > 0 ? turned( { q[0], q[1], q[2] }, 2 * std::atan2( sine, q[3] ) ) : identity();
	for ( std::size_t i = 0; i < 3; ++i )
	{
		m[i][3] = position[i];
	}
	return m;
}

std::array<double, 3> transformed( const Matrix& a, const std::array<double, 3>& p )
{
	std::array<double, 3> result;
	for ( std::size_t i = 0; i < 3; ++i )
	{
		result[i] = a[i][0] * p[0] + a[i][1] * p[1] + a[i][2] * p[2] + a[i][3];
	}
	return result;
}

std::array<double, 3> eulerXyz( const Matrix& r )
{
	return { std::atan2( -r[1][2], r[2][2] ), std::asin( std::fmin( 1, std::fmax( -1, r[0][2] ) ) ),
	    std::atan2( -r[0][1], r[0][0] ) };
}

std::array<double, 3> rotationVector( const Matrix& r )
{
	const double x = r[2][1] - r[1][2], y = r[0][2] - r[2][0], z = r[1][0] - r[0][1];
	const double sine = 0.5 * std::sqrt( x * x + y * y + z * z ), cosine = 0.5 * ( r[0][0] + r[1][1] + r[2][2] - 1 );
	const double angle = std::atan2( sine, cosine ), factor = sine > 1e-12 ? 0.5 * angle / sine : 0.5;
	return { factor * x, factor * y, factor * z };
}

UrdfOracle::UrdfOracle( const std::string& text )
{
	tinyxml2::XMLDocument document;
	document.Parse( text.c_str() );
	if ( document.RootElement() == nullptr )
	{
		throw std::runtime_error( "no URDF" );
	}
	for ( auto e = document.RootElement()->FirstChildElement( "joint" ); e != nullptr; e = e->NextSiblingElement( "joint" ) )
	{
		Joint joint;
		joint.name = e->Attribute( "name" );
		joint.type = e->Attribute( "type" );
		joint.parent = e->FirstChildElement( "parent" )->Attribute( "link" );
		joint.child = e->FirstChildElement( "child" )->Attribute( "link" );
		const auto xyz = numbers( e->FirstChildElement( "origin" ), "xyz", { 0, 0, 0 } );
		const auto rpy = numbers( e->FirstChildElement( "origin" ), "rpy", { 0, 0, 0 } );
		joint.origin = product(
		    turned( { 0, 0, 1 }, rpy[2] ), product( turned( { 0, 1, 0 }, rpy[1] ), turned( { 1, 0, 0 }, rpy[0] ) ) );
		for ( std::size_t i = 0; i < 3; ++i )
		{
			joint.origin[i][3] = xyz[i];
		}
		joint.axis = numbers( e->FirstChildElement( "axis" ), "xyz", { 1, 0, 0 } );
		if ( const auto* limit = e->FirstChildElement( "limit" ) )
		{
			joint.lower = limit->DoubleAttribute( "lower" );
			joint.upper = limit->DoubleAttribute( "upper" );
		}
		if ( const auto* mimic = e->FirstChildElement( "mimic" ) )
		{
			joint.mimic = mimic->Attribute( "joint" );
			joint.multiplier = mimic->DoubleAttribute( "multiplier", 1 );
			joint.offset = mimic->DoubleAttribute( "offset", 0 );
		}
		m_joints.push_back( joint );
	}
}

double UrdfOracle::value( const Joint& joint, const std::map<std::string, double>& values ) const
{
	if ( joint.mimic.empty() )
	{
		const auto found = values.find( joint.name );
		return found != values.end() ? found->second : 0;
	}
	for ( const Joint& other : m_joints )
	{
		if ( other.name == joint.mimic )
		{
			return joint.multiplier * value( other, values ) + joint.offset;
		}
	}
	throw std::runtime_error( joint.mimic );
}

Matrix UrdfOracle::pose( const std::string& link, const std::map<std::string, double>& values ) const
{
	for ( const Joint& joint : m_joints )
	{
		if ( joint.child != link )
		{
			continue;
		}
		const double q = joint.type == "fixed" ? 0 : value( joint, values );
		Matrix motion = identity();
		if ( joint.type == "prismatic" )
		{
			const auto& a = joint.axis;
			const double length = std::sqrt( a[0] * a[0] + a[1] * a[1] + a[2] * a[2] );
			for ( std::size_t i = 0; i < 3; ++i )
			{
				motion[i][3] = q * a[i] / length;
			}
		}
		else if ( joint.type == "revolute" || joint.type == "continuous" )
		{
			motion = turned( joint.axis, q );
		}
		return product( pose( joint.parent, values ), product( joint.origin, motion ) );
	}
	return identity();
}
