// SPDX-License-Identifier: BSD-3-Clause
#include "referee/splines.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace leeway::referee
{
namespace
{

/// A segment of a degree that holds so many numbers of each variable.
motions::Segment segmentOf(
    double begin, double end, std::size_t numbers, const std::string& file, const std::string& element )
{
	if ( !( end > begin ) || !std::isfinite( end - begin ) )
	{
		throw io::Error(
		    file, element, fmt::format( "ends at {:g} s, and begins at {:g} s", end, begin ), "give times that increase" );
	}
	if ( numbers < 1 || numbers > LW_CURVE_MOST_DEGREE + 1 )
	{
		throw io::Error( file, element,
		    fmt::format( "is of degree {}, and 1 to {} can be judged", double( numbers ) - 1, LW_CURVE_MOST_DEGREE ),
		    "approximate it by more pieces of a lower degree" );
	}
	return { begin, end - begin, std::max( 1U, static_cast<unsigned>( numbers ) - 1 ), {} };
}

/// The blossom of the spline on the interval that begins at knots[span], at `degree` arguments.
std::vector<double> blossom(
    const std::vector<double>& knots, const Rows& points, std::size_t span, const std::vector<double>& arguments )
{
	const std::size_t degree = arguments.size();
	Rows row( points.begin() + std::ptrdiff_t( span - degree ), points.begin() + std::ptrdiff_t( span ) + 1 );
	for ( std::size_t level = 1; level <= degree; ++level )
	{
		for ( std::size_t i = degree; i >= level; --i )
		{
			const double low = knots[span - degree + i], high = knots[span + 1 + i - level];
			const double share = ( arguments[level - 1] - low ) / ( high - low );
			for ( std::size_t v = 0; v < row[i].size(); ++v )
			{
				row[i][v] = ( 1 - share ) * row[i - 1][v] + share * row[i][v];
			}
		}
	}
	return row[degree];
}

} // namespace

std::vector<motions::Segment> fromBspline( unsigned order, const std::vector<double>& knots, const Rows& points,
    const std::string& file, const std::string& element )
{
	const unsigned degree = order - 1;
	if ( !std::is_sorted( knots.begin(), knots.end() ) || points.size() < order )
	{
		throw io::Error( file, element, "its knots decrease, or it has fewer control points than its order",
		    "give knots that do not decrease, and `order` control points or more" );
	}
	std::vector<motions::Segment> segments;
	for ( std::size_t span = degree; span < points.size(); ++span )
	{
		if ( !( knots[span + 1] > knots[span] ) )
		{
			continue;
		}
		motions::Segment segment;
		segment.begin = knots[span];
		segment.seconds = knots[span + 1] - knots[span];
		segment.degree = degree;
		for ( unsigned k = 0; k <= degree; ++k )
		{
			std::vector<double> arguments( degree, knots[span] );
			std::fill( arguments.end() - k, arguments.end(), knots[span + 1] );
			const std::vector<double> point = blossom( knots, points, span, arguments );
			segment.points.insert( segment.points.end(), point.begin(), point.end() );
		}
		segments.push_back( std::move( segment ) );
	}
	if ( segments.empty() )
	{
		throw io::Error( file, element, "all its knots are at one time", "give times that increase" );
	}
	return segments;
}

motions::Segment fromBezier(
    double begin, double end, const Rows& points, const std::string& file, const std::string& element )
{
	motions::Segment segment = segmentOf( begin, end, points.size(), file, element );
	for ( unsigned k = 0; k <= segment.degree; ++k )
	{
		const std::vector<double>& point = points[std::min<std::size_t>( k, points.size() - 1 )];
		segment.points.insert( segment.points.end(), point.begin(), point.end() );
	}
	return segment;
}

motions::Segment fromPowers(
    double begin, double end, const Rows& coefficients, const std::string& file, const std::string& element )
{
	motions::Segment segment = segmentOf( begin, end, coefficients.front().size(), file, element );
	segment.points.assign( ( segment.degree + 1 ) * coefficients.size(), 0.0 );
	for ( std::size_t v = 0; v < coefficients.size(); ++v )
	{
		double power = 1, of_degree = 1; // seconds^i, binomial( degree, i )
		for ( unsigned i = 0; i < coefficients[v].size(); ++i )
		{
			double of_k = 1; // binomial( k, i )
			for ( unsigned k = i; k <= segment.degree; ++k )
			{
				segment.points[k * coefficients.size() + v] += of_k / of_degree * coefficients[v][i] * power;
				of_k = of_k * ( k + 1 ) / ( k + 1 - i );
			}
			power *= segment.seconds;
			of_degree = of_degree * ( segment.degree - i ) / ( i + 1 );
		}
	}
	return segment;
}

} // namespace leeway::referee
