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

/// The point of a simplex nearest to the origin; corners that do not carry it are dropped.
Vec nearest( std::vector<Vec>& corners )
{
	Vec best{};
	double least = std::numeric_limits<double>::infinity();
	unsigned kept = 0;
	const unsigned count = static_cast<unsigned>( corners.size() );
	for ( unsigned set = 1; set < ( 1U << count ); ++set )
	{
		// Weights of the affine hull's nearest point: normal equations by elimination, first corner as origin
		std::array<Vec, 4> used{};
		unsigned n = 0;
		for ( unsigned i = 0; i < count; ++i )
		{
			if ( ( set >> i & 1U ) != 0 )
			{
				used[n++] = corners[i];
			}
		}
		double m[3][4] = {};
		for ( unsigned i = 1; i < n; ++i )
		{
			for ( unsigned j = 1; j < n; ++j )
			{
				m[i - 1][j - 1] = dot( used[i] - used[0], used[j] - used[0] );
			}
			m[i - 1][3] = -dot( used[i] - used[0], used[0] );
		}
		bool inside = true;
		for ( unsigned i = 0; i + 1 < n; ++i )
		{
			inside = inside && m[i][i] > 0;
			for ( unsigned row = 0; row + 1 < n && inside; ++row )
			{
				const double factor = row != i ? m[row][i] / m[i][i] : 0;
				for ( unsigned k = 0; k < 4; ++k )
				{
					m[row][k] -= factor * m[i][k];
				}
			}
		}
		Vec point = used[0];
		double rest = 1;
		for ( unsigned i = 0; i + 1 < n && inside; ++i )
		{
			const double weight = m[i][3] / m[i][i];
			inside = weight > 0;
			rest -= weight;
			point = point + weight * ( used[i + 1] - used[0] );
		}
		if ( inside && rest > 0 && dot( point, point ) < least )
		{
			least = dot( point, point );
			best = point;
			kept = set;
		}
	}
	std::vector<Vec> carrying;
	for ( unsigned i = 0; i < count; ++i )
	{
		if ( ( kept >> i & 1U ) != 0 )
		{
			carrying.push_back( corners[i] );
		}
	}
	corners = carrying;
	return best;
}

/// A direction from hull a to hull b, and a lower bound of their distance along it; 0 if it is not above `need`.
double hullDistance( const Motion& motion, const Part& a, const Part& b, const Window& window, double need, Vec& direction )
{
	const Pose pose_a = motion.poseOf( a, window ), pose_b = motion.poseOf( b, window );
	Vec v = pose_b.placed( b.shape->ranges[b.range].middle ) - pose_a.placed( a.shape->ranges[a.range].middle );
	std::vector<Vec> simplex;
	double best = 0;
	for ( int round = 0; round < 60; ++round )
	{
		const double size = length( v );
		if ( size <= need || size < 1e-12 )
		{
			break;
		}
		// v points from a to b: the support points nearest to each other along it
		Vec on_a, on_b;
		a.shape->support( a.range, pose_a.turnedBack( v ), &on_a );
		b.shape->support( b.range, pose_b.turnedBack( -1.0 * v ), &on_b );
		const Vec w = pose_b.placed( on_b ) - pose_a.placed( on_a );
		const double lower = dot( w, v ) / size;
		if ( lower > best || round == 0 )
		{
			best = lower;
			direction = ( 1 / size ) * v;
		}
		const bool started = !simplex.empty();
		if ( started && size - lower <= 0.05 * ( size - need ) )
		{
			break;
		}
		if ( simplex.size() == 4 || std::find( simplex.begin(), simplex.end(), w ) != simplex.end() )
		{
			break;
		}
		simplex.push_back( w );
		v = nearest( simplex );
		if ( simplex.empty() )
		{
			break;
		}
	}
	return best > need ? best : 0;
}

} // namespace

struct Search::Task
{
	const Pair& pair;
	double need;
	std::string& out;
};

bool Search::write( const Task& task, const Part& a, const Part& b, const Window& window, const Vec& direction )
{
	const double need = task.need + m_motion.rounding();
	if ( !( m_motion.plane( a, b, task.pair.ancestor, window, direction, need ) > 0 ) )
	{
		return false;
	}
	const double largest = std::max( { std::fabs( direction[0] ), std::fabs( direction[1] ), std::fabs( direction[2] ) } );
	for ( const unsigned bytes : { 1U, 2U, 4U } )
	{
		const double scale = std::ldexp( 1.0, static_cast<int>( 8 * bytes ) - 1 ) - 1;
		Vec rounded;
		for ( int k = 0; k < 3; ++k )
		{
			rounded[k] = std::nearbyint( direction[k] / largest * scale );
		}
		if ( m_motion.plane( a, b, task.pair.ancestor, window, rounded, need ) > 0 )
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
			++m_windows;
			return true;
		}
	}
	return false;
}

double Search::measured( const Task& task, const Window& window ) const
{
	const auto core = [&]( const Placed& placed, bool on_link )
	{
		const Pose pose = m_motion.poseOf( { &placed, nullptr, 0, on_link }, window );
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
	const Model& model = m_motion.model();
	const Placed &a = model.bodies[task.pair.a],
	             &b = task.pair.object ? model.obstacles[task.pair.b] : model.bodies[task.pair.b];
	const lw_transform world_from_a = core( a, true ), world_from_b = core( b, !task.pair.object );
	const lw_shape* other = task.pair.object ? m_obstacles[task.pair.b] : m_bodies[task.pair.b];
	lw_clearance clearance;
	const lw_status status =
	    lw_shape_distance( m_bodies[task.pair.a], &world_from_a, other, &world_from_b, nullptr, m_query, &clearance );
	return status == LW_OK ? clearance.lower : 0;
}

/// @param distance of the whole bodies at this window's middle; negative: not measured yet
void Search::step( const Task& task, Part a, Part b, Window& window, Vec hint, double distance )
{
	const double need = task.need + m_motion.rounding();
	if ( m_motion.spheres( a, b, task.pair.ancestor, window, need ) > 0 )
	{
		task.out.push_back( static_cast<char>( Word::spheres ) );
		++m_windows;
		return;
	}
	if ( length( hint ) > 0 && write( task, a, b, window, hint ) )
	{
		return;
	}
	double apart = 0;
	Vec direction{ 0, 0, 1 };
	if ( b.shape->unbounded() )
	{
		const Pose pose = m_motion.poseOf( b, window );
		direction = pose.columns[2];
		const double height = dot( direction, m_motion.middleOf( a, window ) - pose.shift );
		direction = ( b.shape->kind == Kind::plane && height < 0 ? 1.0 : -1.0 ) * direction;
		apart = std::numeric_limits<double>::infinity(); // halving one side gains nothing
	}
	else
	{
		apart = hullDistance( m_motion, a, b, window, need + m_motion.rounding(), direction );
	}
	if ( apart > 0 && write( task, a, b, window, direction ) )
	{
		return;
	}
	if ( distance < 0 )
	{
		distance = measured( task, window );
		if ( !( distance > need + m_motion.rounding() ) )
		{
			throw Failure{ "is not farther apart than required", window.time };
		}
	}
	const bool can_a = a.shape->divisible( a.range ), can_b = !b.shape->unbounded() && b.shape->divisible( b.range );
	if ( ( can_a || can_b ) && !( apart - task.need > 0.3 * ( distance - task.need ) ) )
	{
		const bool divide_a = can_a && ( !can_b || a.shape->ranges[a.range].radius >= b.shape->ranges[b.range].radius );
		Part& part = divide_a ? a : b;
		const std::size_t range = part.range;
		task.out.push_back( static_cast<char>( divide_a ? Word::halve_a : Word::halve_b ) );
		part.range = range + 1;
		step( task, a, b, window, direction, distance );
		part.range = part.shape->right( range );
		step( task, a, b, window, direction, distance );
		return;
	}
	if ( apart <= 0 )
	{
		throw Failure{ "cannot be separated by a plane: a solid mesh around or beside it", window.time };
	}
	if ( window.depth >= most_halvings )
	{
		throw Failure{ "is too near", window.time };
	}
	task.out.push_back( static_cast<char>( Word::halve_time ) );
	m_motion.halve( window );
	step( task, a, b, *window.first, direction, -1 );
	step( task, a, b, *window.later, direction, -1 );
}

void Search::prove( const Model& model, const Pair& pair, Window& window, std::string& out )
{
	const Placed &a = model.bodies[pair.a], &b = pair.object ? model.obstacles[pair.b] : model.bodies[pair.b];
	step( { pair, model.min_d + pair.margin, out }, { &a, &model.shapes[a.shape], 0, true },
	    { &b, &model.shapes[b.shape], 0, !pair.object }, window, { 0, 0, 0 }, -1 );
}

} // namespace leeway::certify
