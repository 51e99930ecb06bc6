// SPDX-License-Identifier: BSD-3-Clause
#include "referee/polyhedron.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace leeway::referee
{
namespace
{

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double on_face = 1e-9; // radians and metres
constexpr double rounding = 1e-12;

double dot( const State& a, const State& b )
{
	double sum = 0;
	for ( std::size_t i = 0; i < a.size(); ++i )
	{
		sum += a[i] * b[i];
	}
	return sum;
}

} // namespace

bool Polyhedron::add( State a, double b )
{
	const double size = std::sqrt( dot( a, a ) );
	if ( size == 0 )
	{
		return b >= 0;
	}
	for ( double& value : a )
	{
		value /= size;
	}
	m_rows.push_back( { std::move( a ), b / size } );
	return true;
}

double Polyhedron::excess( const Row& row, const State& x ) const
{
	return dot( row.a, x ) - row.b;
}

std::optional<State> Polyhedron::inside() const
{
	State x( m_variables, 0.0 );
	for ( double room = 0.1; room > 1e-7; room *= 0.3 )
	{
		for ( int round = 0; round < 3000; ++round )
		{
			const Row* worst = nullptr;
			double most = 0;
			for ( const Row& row : m_rows )
			{
				const double over = excess( row, x ) + room;
				if ( over > most )
				{
					most = over;
					worst = &row;
				}
			}
			if ( worst == nullptr )
			{
				return x;
			}
			for ( std::size_t i = 0; i < m_variables; ++i )
			{
				x[i] -= ( 1.5 * most ) * worst->a[i];
			}
		}
	}
	return std::nullopt;
}

bool Polyhedron::contains( const State& x, double room ) const
{
	return std::all_of( m_rows.begin(), m_rows.end(), [&]( const Row& row ) { return excess( row, x ) <= -room; } );
}

double Polyhedron::reach( const State& x, const State& direction ) const
{
	double most = infinite;
	for ( const Row& row : m_rows )
	{
		const double speed = dot( row.a, direction );
		if ( speed > 0 )
		{
			most = std::min( most, -excess( row, x ) / speed );
		}
	}
	return std::max( most, 0.0 );
}

void Polyhedron::alongFaces( const State& x, State& direction ) const
{
	std::vector<State> normals; // orthonormal
	for ( std::size_t round = 0; round < m_variables; ++round )
	{
		const Row* left = nullptr;
		double most = rounding * std::sqrt( dot( direction, direction ) );
		for ( const Row& row : m_rows )
		{
			const double speed = dot( row.a, direction );
			if ( excess( row, x ) > -on_face && speed > most )
			{
				most = speed;
				left = &row;
			}
		}
		if ( left == nullptr )
		{
			return;
		}
		State normal = left->a;
		for ( const State& other : normals )
		{
			const double part = dot( normal, other );
			for ( std::size_t i = 0; i < m_variables; ++i )
			{
				normal[i] -= part * other[i];
			}
		}
		const double size = std::sqrt( dot( normal, normal ) );
		if ( size < 1e-6 )
		{
			break;
		}
		const double part = dot( direction, normal ) / size;
		for ( std::size_t i = 0; i < m_variables; ++i )
		{
			normal[i] /= size;
			direction[i] -= part * normal[i];
		}
		normals.push_back( normal );
	}
}

void Polyhedron::step( State& x, std::mt19937_64& random, double at_ends ) const
{
	std::normal_distribution<double> normal;
	std::uniform_real_distribution<double> uniform( 0, 1 );
	State direction( m_variables ), back( m_variables );
	for ( std::size_t i = 0; i < m_variables; ++i )
	{
		direction[i] = normal( random );
		back[i] = -direction[i];
	}
	// Not quite to the boundary: the next line would have no length on one side
	const double size = std::sqrt( dot( direction, direction ) );
	const double ahead = std::min( reach( x, direction ), 100 / size ), behind = std::min( reach( x, back ), 100 / size );
	const double share = uniform( random );
	const double to = share < at_ends ? ( share < 0.5 * at_ends ? 0.001 : 0.999 ) : uniform( random );
	for ( std::size_t i = 0; i < m_variables; ++i )
	{
		x[i] += ( to * ( ahead + behind ) - behind ) * direction[i];
	}
}

bool Polyhedron::tighten( Box& box ) const
{
	for ( int round = 0; round < 4; ++round )
	{
		bool changed = false;
		for ( const Row& row : m_rows )
		{
			double least = 0;
			std::size_t open = 0, open_at = 0; // variables whose part has no lower bound
			for ( std::size_t i = 0; i < m_variables; ++i )
			{
				const double part = row.a[i] == 0 ? 0 : row.a[i] * ( row.a[i] > 0 ? box.lower[i] : box.upper[i] );
				least += std::isfinite( part ) ? part : 0;
				open_at = std::isfinite( part ) ? open_at : i;
				open += std::isfinite( part ) ? 0 : 1;
			}
			if ( open == 0 && least > row.b + rounding * ( 1 + std::fabs( row.b ) ) )
			{
				return false;
			}
			for ( std::size_t i = 0; i < m_variables && open < 2; ++i )
			{
				if ( row.a[i] == 0 || ( open == 1 && open_at != i ) )
				{
					continue;
				}
				const double own = open == 1 ? 0 : row.a[i] * ( row.a[i] > 0 ? box.lower[i] : box.upper[i] );
				const double limit = ( row.b - ( least - own ) ) / row.a[i];
				const double loose = rounding * ( 1 + std::fabs( row.b ) + std::fabs( least ) ) / std::fabs( row.a[i] );
				if ( row.a[i] > 0 && limit + loose < box.upper[i] )
				{
					changed = changed || limit < box.upper[i] - 0.01 * ( box.upper[i] - box.lower[i] );
					box.upper[i] = limit + loose;
				}
				else if ( row.a[i] < 0 && limit - loose > box.lower[i] )
				{
					changed = changed || limit > box.lower[i] + 0.01 * ( box.upper[i] - box.lower[i] );
					box.lower[i] = limit - loose;
				}
				if ( box.lower[i] > box.upper[i] )
				{
					return false;
				}
			}
			// `least` is of the box before this row: the row moves only bounds that `least` has no part of
		}
		if ( !changed )
		{
			break;
		}
	}
	return true;
}

} // namespace leeway::referee
