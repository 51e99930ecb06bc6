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

Motion::Motion( const Model& model ) : m_model( model )
{
	for ( const Placed& placed : model.bodies )
	{
		m_bodies.push_back( { &placed, &model.shapes[placed.shape], true, certify::poseOf( placed.pose ) } );
	}
	for ( const Placed& placed : model.obstacles )
	{
		m_obstacles.push_back( { &placed, &model.shapes[placed.shape], false, certify::poseOf( placed.pose ) } );
	}
	for ( const Body& obstacle : m_obstacles )
	{
		m_resting.push_back( side( obstacle, 0, 0, false, {} ) );
	}
	for ( std::uint32_t i = 0; i < model.links.size(); ++i )
	{
		m_origins.push_back( certify::poseOf( model.links[i].origin ) );
		m_moved.push_back( model.links[i].variable != nothing ? i : i > 0 ? m_moved[model.links[i].parent] : nothing );
	}
}

void Motion::begin( const std::vector<Piece>& pieces )
{
	m_rounding = 1e-10 * sizeOf( pieces );
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
	const double* middle = later.data();
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
		window.rest[j] = rest + window.tubes->timely[j];
	}
	const std::size_t links = m_model.links.size();
	window.links.resize( links );
	window.axes.resize( links );
	for ( std::size_t i = 0; i < links; ++i )
	{
		const Link& link = m_model.links[i];
		Pose local = m_origins[i];
		if ( link.type != Link::fixed )
		{
			local = local *
			        moved( link, link.offset + ( link.variable != nothing ? link.multiplier * middle[link.variable] : 0 ) );
		}
		window.links[i] = i == 0 ? local : window.links[link.parent] * local;
		window.axes[i] = window.links[i].turned( link.axis );
	}
}

std::unique_ptr<Window> Motion::whole( const Piece& piece, const Tubes& tubes ) const
{
	auto window = std::make_unique<Window>();
	window->degree = piece.degree;
	window->points = piece.points;
	window->tubes = &tubes;
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
		half->tubes = window.tubes;
		finish( *half );
	}
}

Side Motion::side( const Body& body, std::size_t range, std::uint32_t ancestor, bool late, const Window& window ) const
{
	Side side;
	side.body = &body;
	side.range = range;
	side.pose = body.on_link ? window.links[body.placed->owner] * body.pose : body.pose;
	if ( body.shape->unbounded() )
	{
		return side;
	}
	side.middle = side.pose.placed( body.shape->ranges[range].middle );
	side.radius = body.shape->ranges[range].radius;
	for ( int k = 0; k < 3; ++k )
	{
		side.arms[k] = body.shape->ranges[range].half[k] * side.pose.columns[k];
	}
	double below = 0, turns = 0; // sum of rho e of the joints so far, from the body upwards
	std::uint32_t at = body.on_link ? m_moved[body.placed->owner] : nothing;
	for ( ; at != nothing && at > ancestor; at = m_moved[m_model.links[at].parent] )
	{
		const Link& link = m_model.links[at];
		const double speed = link.multiplier * window.speed[link.variable];
		const double tube = window.rest[link.variable] + ( late ? window.tubes->late[link.variable] : 0 );
		const double rest = std::fabs( link.multiplier ) * tube, most = std::fabs( speed ) + rest;
		const Vec& axis = window.axes[at];
		if ( link.type == Link::shift )
		{
			side.shift = side.shift + speed * axis;
			side.rest += rest;
			side.path += most;
			below += most;
			continue;
		}
		const Vec& origin = window.links[at].shift;
		const double centre = length( cross( axis, side.middle - origin ) ), rho = centre + side.radius;
		side.turn = side.turn + speed * axis;
		side.shift = side.shift + speed * cross( origin, axis );
		side.rest += rho * ( rest + 0.5 * most * most ) + most * below;
		side.path += most * centre;
		below += most * rho;
		turns += most;
	}
	side.turns = dot( side.turn, side.turn ) > 0;
	if ( turns > 50 ) // FORMAT.md, rounding
	{
		side.rest = side.path = infinite;
	}
	return side;
}

const Side& Motion::whole( std::uint32_t body, Window& window ) const
{
	if ( window.whole.empty() )
	{
		window.whole.resize( m_bodies.size() );
	}
	if ( window.whole[body].body == nullptr )
	{
		window.whole[body] = side( m_bodies[body], 0, 0, false, window );
	}
	return window.whole[body];
}

double Side::boxHeight( const Vec& direction ) const
{
	return dot( middle, direction ) + std::fabs( dot( arms[0], direction ) ) + std::fabs( dot( arms[1], direction ) ) +
	       std::fabs( dot( arms[2], direction ) );
}

Vec Side::boxPoint( const Vec& direction ) const
{
	Vec point = middle;
	for ( const Vec& arm : arms )
	{
		point = dot( arm, direction ) < 0 ? point - arm : point + arm;
	}
	return point;
}

double Motion::spheres( const Side& a, const Side& b, double need ) const
{
	const Kind kind = b.body->shape->kind;
	double gap;
	if ( b.body->shape->unbounded() )
	{
		gap = dot( b.pose.columns[2], a.middle - b.pose.shift );
		gap = kind == Kind::plane ? std::fabs( gap ) : gap;
	}
	else
	{
		gap = length( b.middle - a.middle );
	}
	return gap - a.radius - b.radius - a.path - b.path - need - m_rounding;
}

double Motion::plane( const Side& a, const Side& b, const Vec& direction, double need, bool boxes ) const
{
	const Shape &shape_a = *a.body->shape, &shape_b = *b.body->shape;
	Vec n = ( 1 / length( direction ) ) * direction;
	if ( shape_b.unbounded() )
	{
		n = shape_b.kind == Kind::plane && dot( n, b.pose.columns[2] ) > 0 ? b.pose.columns[2] : -1.0 * b.pose.columns[2];
	}
	/// Height of a side's farthest point along n at s, seen in direction sign * n
	const auto height = [&]( const Side& side, const Shape& shape, double sign, double s )
	{
		const Vec to = sign * ( n + s * cross( n, side.turn ) );
		const double farthest = boxes ? side.boxHeight( to )
		                              : shape.support( side.range, side.pose.turnedBack( to ) ) + dot( to, side.pose.shift );
		return farthest + sign * s * dot( n, side.shift );
	};
	double room = infinite, top = 0, bottom = shape_b.unbounded() ? dot( n, b.pose.shift ) : 0;
	for ( const double s : { -1.0, 1.0 } )
	{
		if ( s < 0 || a.turns )
		{
			top = height( a, shape_a, 1, s );
		}
		else
		{
			top += 2 * dot( n, a.shift );
		}
		if ( !shape_b.unbounded() && ( s < 0 || b.turns ) )
		{
			bottom = -height( b, shape_b, -1, s );
		}
		else if ( !shape_b.unbounded() )
		{
			bottom += 2 * dot( n, b.shift );
		}
		room = std::min( room, bottom - top );
	}
	return room - a.rest - b.rest - need - m_rounding;
}

} // namespace leeway::certify
