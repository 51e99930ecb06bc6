// SPDX-License-Identifier: BSD-3-Clause
// Windows and pieces by halving. Directions come from the distance of two convex hulls: Gilbert, Johnson, Keerthi, IEEE J-RA 4(2), 1988.
#include "certify/search.hpp"

#include <algorithm>
#include <limits>

namespace leeway::certify
{
namespace
{

constexpr unsigned most_halvings = 40;
/// Of the bound of a motion: half of the window has a quarter of it
constexpr double box_share = 0.25;
/// Of a part's radius: more than this is seldom between its box and its hull
constexpr double hull_share = 0.1;
constexpr unsigned few_halvings = 6;

/// At most four points, of which the last one is new.
struct Simplex
{
	std::array<Vec, 4> corners;
	unsigned count = 0;
};

/// Weights of the point nearest to the origin in the affine hull of n points; false if one is negative, or the points are not independent.
bool weightsOf( const std::array<Vec, 4>& points, unsigned n, Vec& nearest )
{
	double m[3][4] = {}; // normal equations with the first point as origin, by elimination
	std::array<Vec, 3> sides;
	for ( unsigned i = 1; i < n; ++i )
	{
		sides[i - 1] = points[i] - points[0];
	}
	for ( unsigned i = 0; i + 1 < n; ++i )
	{
		for ( unsigned j = 0; j + 1 < n; ++j )
		{
			m[i][j] = dot( sides[i], sides[j] );
		}
		m[i][3] = -dot( sides[i], points[0] );
	}
	for ( unsigned i = 0; i + 1 < n; ++i )
	{
		if ( !( m[i][i] > 0 ) )
		{
			return false;
		}
		for ( unsigned row = 0; row + 1 < n; ++row )
		{
			const double factor = row != i ? m[row][i] / m[i][i] : 0;
			for ( unsigned k = i; k < 4 && factor != 0; ++k )
			{
				m[row][k] -= factor * m[i][k];
			}
		}
	}
	nearest = points[0];
	double rest = 1;
	for ( unsigned i = 0; i + 1 < n; ++i )
	{
		const double weight = m[i][3] / m[i][i];
		if ( !( weight > 0 ) )
		{
			return false;
		}
		rest -= weight;
		nearest = nearest + weight * sides[i];
	}
	return rest > 0;
}

/// The point of a simplex nearest to the origin; corners that do not carry it are dropped. The newest one carries it, as it is nearer along the last
/// direction than all others.
Vec nearest( Simplex& simplex )
{
	Vec best = simplex.corners[simplex.count - 1];
	double least = dot( best, best );
	Simplex carrying;
	carrying.corners[0] = best;
	carrying.count = 1;
	for ( unsigned set = 1; set < ( 1U << ( simplex.count - 1 ) ); ++set )
	{
		Simplex used;
		used.corners[used.count++] = simplex.corners[simplex.count - 1];
		for ( unsigned i = 0; i + 1 < simplex.count; ++i )
		{
			if ( ( set >> i & 1U ) != 0 )
			{
				used.corners[used.count++] = simplex.corners[i];
			}
		}
		Vec point;
		if ( weightsOf( used.corners, used.count, point ) && dot( point, point ) < least )
		{
			least = dot( point, point );
			best = point;
			carrying = used;
		}
	}
	// The newest one is the last again
	std::rotate( carrying.corners.begin(), carrying.corners.begin() + 1, carrying.corners.begin() + carrying.count );
	simplex = carrying;
	return best;
}

} // namespace

struct Search::Task
{
	const Pair& pair;
	double need; ///< with the rounding that the writer leaves
	Vec& last;   ///< direction that was written
	std::string& out;
};

Side Search::sideOf( const Task& task, const Side& old, std::size_t range, const Window& window ) const
{
	return old.body->on_link ? m_motion.side( *old.body, range, task.pair.ancestor, task.pair.late, window )
	                         : m_motion.side( *old.body, range, 0, false, window );
}

/// Writes a direction with as few bits as prove the window.
bool Search::write( const Task& task, const Side& a, const Side& b, const Vec& direction, bool boxes )
{
	const double largest = std::max( { std::fabs( direction[0] ), std::fabs( direction[1] ), std::fabs( direction[2] ) } );
	// A direction of so many bits is off by 1 / scale at most, and no point's height by more than that of the distance
	const double size = length( b.middle - a.middle ) + a.radius + b.radius;
	for ( const unsigned bytes : { 1U, 2U, 4U } )
	{
		const double scale = std::ldexp( 1.0, static_cast<int>( 8 * bytes ) - 1 ) - 1;
		Vec rounded;
		for ( int k = 0; k < 3; ++k )
		{
			rounded[k] = std::nearbyint( direction[k] / largest * scale );
		}
		const double room = m_motion.plane( a, b, rounded, task.need, boxes );
		if ( room > 0 )
		{
			task.out.push_back( static_cast<char>( bytes == 4   ? Word::plane32
			                                       : bytes == 2 ? Word::plane16
			                                                    : Word::plane8 ) );
			for ( const double value : rounded )
			{
				const auto bits = static_cast<std::uint32_t>( static_cast<std::int32_t>( value ) );
				for ( unsigned i = 0; i < bytes; ++i )
				{
					task.out.push_back( static_cast<char>( bits >> ( 8 * i ) & 0xff ) );
				}
			}
			++directions;
			task.last = direction;
			return true;
		}
		if ( !( room > -2 / scale * size ) )
		{
			return false;
		}
	}
	return false;
}

/// Looks for a direction between two hulls, and writes the first one that proves the window.
/// @param boxes in the place of the hulls
/// @param direction of any length, where to begin if `hinted`; the best one, if it is not written
/// @param apart a lower bound of their distance along `direction`; 0 if it is not above `need`
/// @return true: it is written
bool Search::separate(
    const Task& task, const Side& a, const Side& b, bool boxes, bool hinted, Vec& direction, double& apart )
{
	const auto farthest = [boxes]( const Side& side, const Vec& v )
	{
		if ( boxes )
		{
			return side.boxPoint( v );
		}
		Vec point;
		side.body->shape->support( side.range, side.pose.turnedBack( v ), &point );
		return side.pose.placed( point );
	};
	const double lost = a.rest + b.rest + m_motion.rounding();
	Vec v = hinted ? direction : b.middle - a.middle;
	Simplex simplex;
	apart = 0;
	for ( int round = 0; round < 60; ++round )
	{
		const double size = length( v );
		const bool is_guess = hinted && round == 0; // a direction, no difference of points
		// v joins two points: of hulls the room for a plane is measured further, to be compared with the distance of the bodies
		if ( size < 1e-12 || ( !is_guess && size <= task.need + ( boxes ? lost : 0 ) ) )
		{
			break;
		}
		// v points from a to b: the support points nearest to each other along it
		const Vec w = farthest( b, -1.0 * v ) - farthest( a, v );
		const double lower = dot( w, v ) / size;
		if ( lower > apart || round == 0 )
		{
			apart = std::max( lower, 0.0 );
			direction = ( 1 / size ) * v;
			if ( lower > task.need + lost && write( task, a, b, direction, boxes ) )
			{
				return true;
			}
		}
		const bool same = std::find( simplex.corners.begin(), simplex.corners.begin() + simplex.count, w ) !=
		                  simplex.corners.begin() + simplex.count;
		if ( same || simplex.count == 4 || ( simplex.count > 0 && size - lower <= 0.05 * ( size - task.need ) ) )
		{
			break;
		}
		simplex.corners[simplex.count++] = w;
		v = nearest( simplex );
	}
	apart = apart > task.need ? apart : 0;
	return false;
}

double Search::measured( const Task& task, const Window& window ) const
{
	const auto core = [&]( const Body& body )
	{
		const Pose pose = body.on_link ? window.links[body.placed->owner] * body.pose : body.pose;
		lw_transform result;
		for ( int i = 0; i < 3; ++i )
		{
			for ( int j = 0; j < 3; ++j )
			{
				result.r[i][j] = pose.columns[j][i];
			}
			result.t[i] = pose.shift[i];
		}
		return result;
	};
	const Pair& pair = task.pair;
	const lw_transform world_from_a = core( m_motion.body( pair.a ) ),
	                   world_from_b = core( pair.object ? m_motion.obstacle( pair.b ) : m_motion.body( pair.b ) );
	const lw_range range = { task.need + m_motion.rounding(), std::numeric_limits<double>::infinity(), 0.3 };
	lw_clearance clearance;
	const lw_status status = lw_shape_distance( m_bodies[pair.a], &world_from_a,
	    pair.object ? m_obstacles[pair.b] : m_bodies[pair.b], &world_from_b, &range, m_query, &clearance );
	return status == LW_OK && clearance.kind == LW_CLEARANCE_NEAR ? clearance.lower : 0;
}

/// Halves the larger part, if that is worth it. @return false: it is not
bool Search::halvePart(
    const Task& task, const Side& a, const Side& b, Window& window, const Vec& direction, double distance )
{
	const bool can_a = a.body->shape->divisible( a.range ),
	           can_b = !b.body->shape->unbounded() && b.body->shape->divisible( b.range );
	if ( !can_a && !can_b )
	{
		return false;
	}
	const bool divide_a = can_a && ( !can_b || a.radius >= b.radius );
	const Side& part = divide_a ? a : b;
	task.out.push_back( static_cast<char>( divide_a ? Word::halve_a : Word::halve_b ) );
	for ( const std::size_t range : { part.range + 1, part.body->shape->right( part.range ) } )
	{
		const Side half = sideOf( task, part, range, window );
		step( task, divide_a ? half : a, divide_a ? b : half, window, direction, distance );
	}
	return true;
}

void Search::halveTime( const Task& task, const Side& a, const Side& b, Window& window, const Vec& direction )
{
	if ( window.depth >= most_halvings )
	{
		throw Failure{ "is too near", window.time };
	}
	task.out.push_back( static_cast<char>( Word::halve_time ) );
	m_motion.halve( window );
	const bool is_kept = a.range == 0 && task.pair.object && !task.pair.late;
	for ( Window* half : { window.first.get(), window.later.get() } )
	{
		const Side& next_a = is_kept ? m_motion.whole( task.pair.a, *half ) : sideOf( task, a, a.range, *half );
		step( task, next_a, b.body->on_link ? sideOf( task, b, b.range, *half ) : b, *half, direction, -1 );
	}
}

/// @param hint a direction that may separate them; zero: none
/// @param distance of the whole bodies at this window's middle; negative: not measured yet
void Search::step( const Task& task, const Side& a, const Side& b, Window& window, Vec hint, double distance )
{
	if ( m_motion.spheres( a, b, task.need ) > 0 )
	{
		task.out.push_back( static_cast<char>( Word::spheres ) );
		++spheres;
		return;
	}
	const Shape& other = *b.body->shape;
	const bool hinted = dot( hint, hint ) > 0;
	double apart = 0;
	Vec direction = hint;
	if ( other.unbounded() )
	{
		direction = b.pose.columns[2];
		const double height = dot( direction, a.middle - b.pose.shift );
		direction = ( other.kind == Kind::plane && height < 0 ? 1.0 : -1.0 ) * direction;
		apart = std::numeric_limits<double>::infinity(); // halving one side gains nothing
		if ( write( task, a, b, direction, false ) )
		{
			return;
		}
	}
	else
	{
		const double lost = a.rest + b.rest;
		const bool large = window.depth < few_halvings; // a window; halving it shrinks no tolerances
		if ( large && lost > length( b.middle - a.middle ) - task.need )
		{
			halveTime( task, a, b, window, hint );
			return;
		}
		// Boxes first: they cost little
		if ( separate( task, a, b, true, hinted, direction, apart ) )
		{
			return;
		}
		// Is it the motion that is too large? Hulls leave little more room than boxes do
		const bool gains = apart - task.need > box_share * lost;
		if ( gains || ( large && lost > hull_share * std::min( a.radius, b.radius ) ) )
		{
			halveTime( task, a, b, window, direction );
			return;
		}
		if ( separate( task, a, b, false, hinted || apart > 0, direction, apart ) )
		{
			return;
		}
	}
	if ( distance < 0 )
	{
		distance = measured( task, window );
		if ( !( distance > task.need ) )
		{
			throw Failure{ "is not farther apart than required", window.time };
		}
	}
	if ( !( apart - task.need > 0.3 * ( distance - task.need ) ) && halvePart( task, a, b, window, direction, distance ) )
	{
		return;
	}
	if ( apart <= 0 )
	{
		throw Failure{ "cannot be separated by a plane: a solid mesh around or beside it", window.time };
	}
	halveTime( task, a, b, window, direction );
}

void Search::prove( const Pair& pair, double min_d, Window& window, Vec& hint, std::string& out )
{
	const Task task = { pair, min_d + pair.margin + m_motion.rounding(), hint, out };
	const Vec begin = hint;
	const auto moving = [&]( std::uint32_t body )
	{ return m_motion.side( m_motion.body( body ), 0, pair.ancestor, pair.late, window ); };
	if ( pair.object && !pair.late )
	{
		step( task, m_motion.whole( pair.a, window ), m_motion.whole( pair.b ), window, begin, -1 );
	}
	else
	{
		step( task, moving( pair.a ), pair.object ? m_motion.whole( pair.b ) : moving( pair.b ), window, begin, -1 );
	}
}

} // namespace leeway::certify
