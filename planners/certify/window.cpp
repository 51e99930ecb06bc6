// SPDX-License-Identifier: BSD-3-Clause
// The twin of the checkers' arithmetic: kinematics of a middle state, motion around it, and both tests.
#include "certify/window.hpp"

#include <algorithm>
#include <limits>

namespace leeway::certify
{
namespace
{

constexpr double infinite = std::numeric_limits<double>::infinity();

Pose moved( const Link& link, double value )
{
	Pose pose;
	if ( link.type == Link::shift )
	{
		pose.shift = value * link.axis;
	}
	else if ( link.type == Link::turn )
	{
		const double c = std::cos( value ), s = std::sin( value );
		for ( int k = 0; k < 3; ++k )
		{
			Vec unit{ 0, 0, 0 };
			unit[k] = 1;
			pose.columns[k] = c * unit + ( s * cross( link.axis, unit ) + ( ( 1 - c ) * link.axis[k] ) * link.axis );
		}
	}
	return pose;
}

/// The two halves of a Bezier curve, by averages.
void halveCurve( const std::vector<double>& points, unsigned degree, std::size_t variables, std::vector<double>& first,
    std::vector<double>& later )
{
	first = later = points;
	std::vector<double> row = points;
	for ( unsigned level = 0; level <= degree; ++level )
	{
		for ( std::size_t j = 0; j < variables; ++j )
		{
			first[level * variables + j] = row[j];
			later[( degree - level ) * variables + j] = row[( degree - level ) * variables + j];
		}
		for ( std::size_t i = 0; i < ( degree - level ) * variables; ++i )
		{
			row[i] = 0.5 * ( row[i] + row[i + variables] );
		}
	}
}

} // namespace

Motion::Motion( const Model& model, const std::vector<Piece>& pieces )
    : m_model( model ), m_rounding( 1e-10 * sizeOf( pieces ) )
{
}

double Motion::sizeOf( const std::vector<Piece>& pieces ) const
{
	const std::size_t variables = m_model.variables.size();
	std::vector<double> most( variables, 0 );
	for ( const Piece& piece : pieces )
	{
		for ( std::size_t i = 0; i < piece.points.size(); ++i )
		{
			most[i % variables] = std::max( most[i % variables], std::fabs( piece.points[i] ) );
		}
	}
	double robot = 0, bodies = 0, obstacles = 0;
	for ( const Link& link : m_model.links )
	{
		robot += length( { link.origin[0], link.origin[1], link.origin[2] } );
		if ( link.type == Link::shift )
		{
			robot += std::fabs( link.offset ) +
			         ( link.variable != nothing ? std::fabs( link.multiplier ) * most[link.variable] : 0 );
		}
	}
	const auto extent = [&]( const Placed& placed )
	{
		const Shape& shape = m_model.shapes[placed.shape];
		return length( { placed.pose[0], placed.pose[1], placed.pose[2] } ) +
		       ( shape.unbounded() ? 0 : length( shape.ranges[0].middle ) + length( shape.ranges[0].half ) );
	};
	for ( const Placed& body : m_model.bodies )
	{
		bodies = std::max( bodies, extent( body ) );
	}
	for ( const Placed& obstacle : m_model.obstacles )
	{
		obstacles = std::max( obstacles, extent( obstacle ) );
	}
	return robot + bodies + obstacles;
}

void Motion::finish( Window& window ) const
{
	const std::size_t variables = m_model.variables.size();
	std::vector<double> first, later;
	halveCurve( window.points, window.degree, variables, first, later );
	const std::vector<double> middle( later.begin(), later.begin() + std::ptrdiff_t( variables ) );
	window.speed.resize( variables );
	window.rest.resize( variables );
	for ( std::size_t j = 0; j < variables; ++j )
	{
		const double begin = window.points[j], end = window.points[window.degree * variables + j];
		const double speed = 0.5 * ( end - begin );
		double rest = 0;
		for ( unsigned i = 0; i <= window.degree; ++i )
		{
			const double line = middle[j] + ( 2.0 * i / window.degree - 1 ) * speed;
			rest = std::max( rest, std::fabs( window.points[i * variables + j] - line ) );
		}
		window.speed[j] = speed;
		window.rest[j] = rest + m_model.variables[j].tolerance;
	}
	const std::size_t links = m_model.links.size();
	window.links.resize( links );
	window.axes.resize( links );
	for ( std::size_t i = 0; i < links; ++i )
	{
		const Link& link = m_model.links[i];
		const double value = link.offset + ( link.variable != nothing ? link.multiplier * middle[link.variable] : 0 );
		const Pose local = certify::poseOf( link.origin ) * moved( link, value );
		window.links[i] = i == 0 ? local : window.links[link.parent] * local;
		window.axes[i] = window.links[i].turned( link.axis );
	}
}

std::unique_ptr<Window> Motion::whole( const Piece& piece ) const
{
	auto window = std::make_unique<Window>();
	window->degree = piece.degree;
	window->points = piece.points;
	finish( *window );
	return window;
}

void Motion::halve( Window& window ) const
{
	if ( window.first )
	{
		return;
	}
	window.first = std::make_unique<Window>();
	window.later = std::make_unique<Window>();
	halveCurve( window.points, window.degree, m_model.variables.size(), window.first->points, window.later->points );
	const double quarter = std::ldexp( 0.25, -static_cast<int>( window.depth ) );
	for ( Window* half : { window.first.get(), window.later.get() } )
	{
		half->degree = window.degree;
		half->depth = window.depth + 1;
		half->time = window.time + ( half == window.first.get() ? -quarter : quarter );
		finish( *half );
	}
}

Pose Motion::poseOf( const Part& part, const Window& window ) const
{
	const Pose pose = certify::poseOf( part.placed->pose );
	return part.on_link ? window.links[part.placed->owner] * pose : pose;
}

Vec Motion::middleOf( const Part& part, const Window& window ) const
{
	return poseOf( part, window ).placed( part.shape->ranges[part.range].middle );
}

Motion::Bounds Motion::boundsOf( const Part& part, std::uint32_t ancestor, const Window& window ) const
{
	Bounds bounds;
	if ( !part.on_link )
	{
		return bounds;
	}
	const Vec middle = middleOf( part, window );
	const double radius = part.shape->ranges[part.range].radius;
	double below = 0, turns = 0; // sum of rho e of the joints so far, from the body upwards
	for ( std::uint32_t at = part.placed->owner; at != ancestor; at = m_model.links[at].parent )
	{
		const Link& link = m_model.links[at];
		if ( link.variable == nothing )
		{
			continue;
		}
		const double speed = link.multiplier * window.speed[link.variable];
		const double rest = std::fabs( link.multiplier ) * window.rest[link.variable];
		const double most = std::fabs( speed ) + rest;
		const Vec& axis = window.axes[at];
		if ( link.type == Link::shift )
		{
			bounds.shift = bounds.shift + speed * axis;
			bounds.rest += rest;
			bounds.path += most;
			below += most;
			continue;
		}
		const Vec& origin = window.links[at].shift;
		const double centre = length( cross( axis, middle - origin ) ), rho = centre + radius;
		bounds.turn = bounds.turn + speed * axis;
		bounds.shift = bounds.shift + speed * cross( origin, axis );
		bounds.rest += rho * ( rest + 0.5 * most * most ) + most * below;
		bounds.path += most * centre;
		below += most * rho;
		turns += most;
	}
	if ( turns > 50 ) // FORMAT.md, rounding
	{
		bounds.rest = bounds.path = infinite;
	}
	return bounds;
}

double Motion::spheres( const Part& a, const Part& b, std::uint32_t ancestor, const Window& window, double need ) const
{
	const Vec middle = middleOf( a, window );
	const Bounds of_a = boundsOf( a, ancestor, window );
	const double radius = a.shape->ranges[a.range].radius;
	if ( b.shape->unbounded() )
	{
		const Pose pose = poseOf( b, window );
		const double height = dot( pose.columns[2], middle - pose.shift );
		return ( b.shape->kind == Kind::plane ? std::fabs( height ) : height ) - radius - of_a.path - need - m_rounding;
	}
	const Bounds of_b = boundsOf( b, ancestor, window );
	return length( middleOf( b, window ) - middle ) - radius - b.shape->ranges[b.range].radius - of_a.path - of_b.path -
	       need - m_rounding;
}

double Motion::plane(
    const Part& a, const Part& b, std::uint32_t ancestor, const Window& window, const Vec& direction, double need ) const
{
	const Pose pose_a = poseOf( a, window ), pose_b = poseOf( b, window );
	Vec n = ( 1 / length( direction ) ) * direction;
	if ( b.shape->unbounded() )
	{
		n = b.shape->kind == Kind::plane && dot( n, pose_b.columns[2] ) > 0 ? pose_b.columns[2] : -1.0 * pose_b.columns[2];
	}
	const Bounds of_a = boundsOf( a, ancestor, window ), of_b = boundsOf( b, ancestor, window );
	double room = infinite;
	for ( const double s : { -1.0, 1.0 } )
	{
		const Vec n_a = n + s * cross( n, of_a.turn ), n_b = -1.0 * ( n + s * cross( n, of_b.turn ) );
		const double top =
		    a.shape->support( a.range, pose_a.turnedBack( n_a ) ) + dot( n_a, pose_a.shift ) + s * dot( n, of_a.shift );
		const double bottom = b.shape->unbounded() ? dot( n, pose_b.shift )
		                                           : -b.shape->support( b.range, pose_b.turnedBack( n_b ) ) -
		                                                 dot( n_b, pose_b.shift ) + s * dot( n, of_b.shift );
		room = std::min( room, bottom - top );
	}
	return room - of_a.rest - of_b.rest - need - m_rounding;
}

} // namespace leeway::certify
