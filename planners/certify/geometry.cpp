// SPDX-License-Identifier: BSD-3-Clause
// Shapes of a certificate. Support points by branch and bound over the boxes of index ranges.
#include "certify/geometry.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

namespace leeway::certify
{
namespace
{

unsigned width( Kind kind )
{
	return kind == Kind::balls ? 4 : kind == Kind::boxes ? 6 : 3;
}

double heightOfBox( const Range& range, const Vec& direction )
{
	double top = dot( range.middle, direction );
	for ( int i = 0; i < 3; ++i )
	{
		top += range.half[i] * std::fabs( direction[i] );
	}
	return top;
}

} // namespace

Pose operator*( const Pose& a, const Pose& b )
{
	return { { a.turned( b.columns[0] ), a.turned( b.columns[1] ), a.turned( b.columns[2] ) }, a.placed( b.shift ) };
}

Pose poseOf( const StoredPose& s )
{
	const double size = std::sqrt( s[3] * s[3] + s[4] * s[4] + s[5] * s[5] + s[6] * s[6] );
	const double x = s[3] / size, y = s[4] / size, z = s[5] / size, w = s[6] / size;
	Pose pose;
	pose.columns[0] = { 1 - 2 * ( y * y + z * z ), 2 * ( x * y + z * w ), 2 * ( x * z - y * w ) };
	pose.columns[1] = { 2 * ( x * y - z * w ), 1 - 2 * ( x * x + z * z ), 2 * ( y * z + x * w ) };
	pose.columns[2] = { 2 * ( x * z + y * w ), 2 * ( y * z - x * w ), 1 - 2 * ( x * x + y * y ) };
	pose.shift = { s[0], s[1], s[2] };
	return pose;
}

std::uint32_t Shape::count() const
{
	switch ( kind )
	{
	case Kind::triangles:
		return static_cast<std::uint32_t>( corners.size() / 3 );
	case Kind::balls:
	case Kind::boxes:
		return static_cast<std::uint32_t>( numbers.size() / width( kind ) );
	default:
		return 1;
	}
}

std::size_t Shape::right( std::size_t range ) const
{
	const std::uint32_t left = ( ranges[range].end - ranges[range].begin ) / 2;
	return range + 2 * std::size_t( left );
}

Vec Shape::corner( std::uint32_t element, unsigned i ) const
{
	const double* at = &numbers[3 * std::size_t( corners[3 * std::size_t( element ) + i] )];
	return { at[0], at[1], at[2] };
}

void Shape::elementBox( std::uint32_t element, Vec& least, Vec& most ) const
{
	const double* at =
	    numbers.empty() ? nullptr : &numbers[width( kind ) * std::size_t( kind == Kind::triangles ? 0 : element )];
	switch ( kind )
	{
	case Kind::triangles:
		least = most = corner( element, 0 );
		for ( unsigned i = 1; i < 3; ++i )
		{
			const Vec at_corner = corner( element, i );
			for ( int k = 0; k < 3; ++k )
			{
				least[k] = std::min( least[k], at_corner[k] );
				most[k] = std::max( most[k], at_corner[k] );
			}
		}
		least = least - Vec{ radius, radius, radius };
		most = most + Vec{ radius, radius, radius };
		break;
	case Kind::balls:
		least = { at[0] - at[3], at[1] - at[3], at[2] - at[3] };
		most = { at[0] + at[3], at[1] + at[3], at[2] + at[3] };
		break;
	case Kind::boxes:
		least = { at[0], at[1], at[2] };
		most = { at[3], at[4], at[5] };
		break;
	default:
		most = { radius, radius, height / 2 + ( kind == Kind::capsule ? radius : 0 ) };
		least = -1.0 * most;
		break;
	}
}

double Shape::elementRadius( std::uint32_t element, const Vec& from ) const
{
	if ( kind == Kind::triangles )
	{
		return radius + std::max( { length( corner( element, 0 ) - from ), length( corner( element, 1 ) - from ),
		                    length( corner( element, 2 ) - from ) } );
	}
	Vec least, most;
	elementBox( element, least, most );
	const Vec middle = 0.5 * ( least + most );
	const double size = kind == Kind::balls     ? numbers[4 * std::size_t( element ) + 3]
	                    : kind == Kind::boxes   ? 0.5 * length( most - least )
	                    : kind == Kind::capsule ? height / 2 + radius
	                                            : std::sqrt( radius * radius + height * height / 4 );
	return length( middle - from ) + size;
}

double Shape::elementSupport( std::uint32_t element, const Vec& n, double size, Vec* point ) const
{
	const double* at = numbers.empty() ? nullptr : &numbers[width( kind ) * std::size_t( element )];
	const double unit = size > 0 ? 1 / size : 0, up = n[2] < 0 ? -height / 2 : height / 2;
	const double flat = kind == Kind::cylinder || kind == Kind::cone ? std::hypot( n[0], n[1] ) : 0;
	const double around = flat > 0 ? radius / flat : 0;
	Vec best{};
	switch ( kind )
	{
	case Kind::balls:
		best = Vec{ at[0], at[1], at[2] } + ( at[3] * unit ) * n;
		break;
	case Kind::boxes:
		best = { n[0] < 0 ? at[0] : at[3], n[1] < 0 ? at[1] : at[4], n[2] < 0 ? at[2] : at[5] };
		break;
	case Kind::cylinder:
		best = { around * n[0], around * n[1], up };
		break;
	case Kind::capsule:
		best = Vec{ 0, 0, up } + ( radius * unit ) * n;
		break;
	default: // a cone
		best = { around * n[0], around * n[1], -height / 2 };
		if ( height / 2 * n[2] > dot( best, n ) )
		{
			best = { 0, 0, height / 2 };
		}
		break;
	}
	if ( point != nullptr )
	{
		*point = best;
	}
	return dot( best, n );
}

/// Of triangles without their radius; `best` and `point` as they are if that is higher.
double Shape::cornerSupport( const Range& range, const Vec& n, double best, Vec* point ) const
{
	std::size_t found = corners.size();
	for ( std::size_t i = 3 * std::size_t( range.begin ); i < 3 * std::size_t( range.end ); ++i )
	{
		const double height_of_corner = m_x[i] * n[0] + m_y[i] * n[1] + m_z[i] * n[2];
		if ( height_of_corner > best )
		{
			best = height_of_corner;
			found = i;
		}
	}
	if ( point != nullptr && found < corners.size() )
	{
		*point = { m_x[found], m_y[found], m_z[found] };
	}
	return best;
}

void Shape::arrange()
{
	std::vector<Vec> middles( count() );
	std::vector<std::uint32_t> order( count() );
	for ( std::uint32_t i = 0; i < count(); ++i )
	{
		Vec least, most;
		elementBox( i, least, most );
		middles[i] = least + most;
		order[i] = i;
	}
	// Each range is halved along the axis on which its middles are farthest apart
	std::vector<std::pair<std::uint32_t, std::uint32_t>> open{ { 0, count() } };
	while ( !open.empty() )
	{
		const auto [begin, end] = open.back();
		open.pop_back();
		if ( end - begin < 2 )
		{
			continue;
		}
		Vec low = middles[order[begin]], high = low;
		for ( std::uint32_t i = begin; i < end; ++i )
		{
			for ( int k = 0; k < 3; ++k )
			{
				low[k] = std::min( low[k], middles[order[i]][k] );
				high[k] = std::max( high[k], middles[order[i]][k] );
			}
		}
		const Vec extent = high - low;
		const auto axis = std::max_element( extent.begin(), extent.end() ) - extent.begin();
		const std::uint32_t middle = begin + ( end - begin ) / 2;
		std::nth_element( order.begin() + begin, order.begin() + middle, order.begin() + end,
		    [&]( std::uint32_t a, std::uint32_t b )
		    { return middles[a][axis] != middles[b][axis] ? middles[a][axis] < middles[b][axis] : a < b; } );
		open.emplace_back( begin, middle );
		open.emplace_back( middle, end );
	}
	const auto reorder = [&]( auto& values, std::size_t wide )
	{
		const std::decay_t<decltype( values )> copy( values );
		for ( std::size_t i = 0; i < values.size(); ++i )
		{
			values[i] = copy[wide * order[i / wide] + i % wide];
		}
	};
	kind == Kind::triangles ? reorder( corners, 3 ) : reorder( numbers, width( kind ) );
}

void Shape::finish()
{
	if ( unbounded() )
	{
		return;
	}
	for ( std::size_t i = 0; i < corners.size(); ++i )
	{
		const Vec at = corner( static_cast<std::uint32_t>( i / 3 ), i % 3 );
		m_x.push_back( at[0] );
		m_y.push_back( at[1] );
		m_z.push_back( at[2] );
	}
	// The tree of halves, in the order root, left, right
	ranges.clear();
	ranges.reserve( 2 * std::size_t( count() ) );
	std::vector<std::pair<std::uint32_t, std::uint32_t>> open{ { 0, count() } };
	while ( !open.empty() )
	{
		const auto [begin, end] = open.back();
		open.pop_back();
		ranges.push_back( { begin, end, {}, {}, 0 } );
		if ( end - begin > 1 )
		{
			const std::uint32_t middle = begin + ( end - begin ) / 2;
			open.emplace_back( middle, end );
			open.emplace_back( begin, middle );
		}
	}
	for ( std::size_t i = ranges.size(); i-- > 0; )
	{
		Range& range = ranges[i];
		Vec least, most;
		if ( range.end - range.begin == 1 )
		{
			elementBox( range.begin, least, most );
			range.middle = 0.5 * ( least + most );
			range.half = 0.5 * ( most - least );
			range.radius = elementRadius( range.begin, range.middle );
			continue;
		}
		const Range &a = ranges[i + 1], &b = ranges[right( i )];
		for ( int k = 0; k < 3; ++k )
		{
			least[k] = std::min( a.middle[k] - a.half[k], b.middle[k] - b.half[k] );
			most[k] = std::max( a.middle[k] + a.half[k], b.middle[k] + b.half[k] );
		}
		range.middle = 0.5 * ( least + most );
		range.half = 0.5 * ( most - least );
		range.radius = std::min( length( range.half ),
		    std::max( length( a.middle - range.middle ) + a.radius, length( b.middle - range.middle ) + b.radius ) );
	}
	double whole = 0;
	for ( std::uint32_t i = 0; i < count(); ++i )
	{
		whole = std::max( whole, elementRadius( i, ranges[0].middle ) );
	}
	ranges[0].radius = std::min( ranges[0].radius, whole );
}

double Shape::support( std::size_t range, const Vec& direction, Vec* point ) const
{
	constexpr std::uint32_t few = 8; // triangles, of which all corners are compared
	const double size = length( direction );
	double best = -std::numeric_limits<double>::infinity();
	std::pair<std::size_t, double> open[64]; // ranges and the heights of their boxes
	int count = 0;
	open[count++] = { range, std::numeric_limits<double>::infinity() };
	while ( count > 0 )
	{
		const auto [place, height_of_box] = open[--count];
		const Range& at = ranges[place];
		if ( height_of_box <= best )
		{
			continue;
		}
		if ( kind == Kind::triangles && at.end - at.begin <= few )
		{
			best = cornerSupport( at, direction, best, point );
			continue;
		}
		if ( at.end - at.begin == 1 )
		{
			Vec found;
			const double reached = elementSupport( at.begin, direction, size, &found );
			if ( reached > best )
			{
				best = reached;
				if ( point != nullptr )
				{
					*point = found;
				}
			}
			continue;
		}
		std::pair<std::size_t, double> higher( place + 1, heightOfBox( ranges[place + 1], direction ) ),
		    lower( right( place ), heightOfBox( ranges[right( place )], direction ) );
		if ( lower.second > higher.second )
		{
			std::swap( lower, higher );
		}
		open[count++] = lower;
		open[count++] = higher; // is opened first
	}
	if ( kind == Kind::triangles )
	{
		best += radius * size;
		if ( point != nullptr && size > 0 )
		{
			*point = *point + ( radius / size ) * direction;
		}
	}
	return best;
}

} // namespace leeway::certify
