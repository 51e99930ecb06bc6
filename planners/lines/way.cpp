// SPDX-License-Identifier: BSD-3-Clause
// Corners are rounded by circles that touch both lines; each half belongs to the part on its side.
#include "lines/way.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace leeway::lines
{
namespace
{

using ik::Vector3d;

constexpr double first_length = 0.12, first_turn = 0.4; // metres and radians between the first states of a leg
constexpr std::uint32_t least_first_states = 4, least_blend_states = 2, most_first_states = 1 << 10;
constexpr double no_way = 1e-9;           // metres and radians
constexpr double straight = 1e-6;         // radians: a corner that is none
constexpr double back = 0.02;             // radians from a reversal: no circle is there
constexpr std::uint32_t least_places = 8; // of a leg

Vector3d vectorOf( const lw_vec3& v )
{
	return { v.x, v.y, v.z };
}

Vector3d placeOf( const lw_transform& pose )
{
	return { pose.t[0], pose.t[1], pose.t[2] };
}

lw_transform movedTo( lw_transform pose, const Vector3d& place )
{
	std::copy_n( place.data(), 3, pose.t );
	return pose;
}

/// u with 3 u^2 - 2 u^3 = s.
double unitTime( double s )
{
	return 0.5 - std::sin( std::asin( std::clamp( 1 - 2 * s, -1.0, 1.0 ) ) / 3 );
}

/// Limits of the place, of the axes, or both.
lw_region_def defOf( const Task& task, bool place, bool axes )
{
	lw_region_def def = lw_region_def_default();
	def.base_link = task.base.link;
	def.base_from_a = task.base.pose;
	def.link = task.tip.link;
	def.link_from_b = task.tip.pose;
	for ( int i = 0; i < 3 && place; ++i )
	{
		def.lower[i] = -task.tolerance;
		def.upper[i] = task.tolerance;
	}
	if ( axes )
	{
		( task.free_axis ? def.tilt : def.angle ) = task.angle;
	}
	def.axis = task.free_axis.value_or( lw_vec3{ 0, 0, 1 } );
	return def;
}

RegionHandle regionOf( const io::Problem& problem, const lw_region_def& def )
{
	lw_diag diag = {};
	lw_region* region = nullptr;
	require( lw_region_create( problem.checker.get(), &def, nullptr, &diag, &region ), diag );
	return RegionHandle( region );
}

/// One part of the task's way, before its corners are cut.
struct Side
{
	lw_transform from, to;
	std::optional<lw_vec3> via;
	double radius = 0; ///< at its end
	std::size_t number = 0;
	std::string name;                            ///< of the waypoint at its end
	lw_region_def def = lw_region_def_default(); ///< of all of it
	double length = 0, turn = 0;
};

double lengthOf( const lw_region_def& def )
{
	const lw_vec3 arm = { def.start.t[0] - def.center.x, def.start.t[1] - def.center.y, def.start.t[2] - def.center.z };
	return length( def.shift ) + ( length( def.arc ) > 0 ? length( def.arc ) * length( arm ) : 0 );
}

class Ways
{
public:
	Ways( const io::Problem& problem, const Task& task, const lw_transform& start ) : m_problem( problem ), m_task( task )
	{
		readParts( start );
		checkRadii();
	}

	std::vector<Run> runs()
	{
		std::vector<Run> runs;
		for ( std::size_t first = 0; first < m_parts.size(); )
		{
			std::size_t last = first;
			while ( m_parts[last].radius > 0 )
			{
				++last;
			}
			runs.push_back( first == last ? lone( m_parts[first] ) : rounded( first, last ) );
			first = last + 1;
		}
		return runs;
	}

private:
	void readParts( const lw_transform& start )
	{
		const std::vector<Waypoint>& waypoints = m_task.waypoints;
		lw_transform from = start;
		const std::size_t first = m_task.any_start ? 1 : 0;
		if ( m_task.any_start && waypoints.front().blend != 0 )
		{
			wrong( "waypoint 1", "has a radius, and the way begins there", "give none to the first waypoint and the last" );
		}
		for ( std::size_t i = first; i < waypoints.size(); ++i )
		{
			const Waypoint& to = waypoints[i];
			Side part = { from, to.pose, to.via, to.blend, i - first, "waypoint " + std::to_string( i + 1 ) };
			part.def = defOf( m_task, true, true );
			const lw_status status =
			    to.via ? lw_region_arc( &part.def, &from, *to.via, &to.pose ) : lw_region_line( &part.def, &from, &to.pose );
			if ( status != LW_OK )
			{
				to.via ? wrong( part.name, "no circle leads there through the given place",
				             "give three places that are not on one line" )
				       : wrong( part.name, "is no finite pose", "give finite numbers and a rotation" );
			}
			if ( !( to.blend >= 0 && to.blend < HUGE_VAL ) )
			{
				wrong(
				    part.name, fmt::format( "has the radius {:g}", to.blend ), "give metres above 0, or 0 to rest there" );
			}
			part.length = lengthOf( part.def );
			part.turn = length( part.def.turn );
			from = to.pose;
			if ( part.length >= no_way || part.turn >= no_way )
			{
				m_parts.push_back( part );
			}
			else if ( to.blend > 0 )
			{
				wrong( part.name, "has a radius, and is where the waypoint before is", "remove one of them" );
			}
		}
		if ( m_parts.empty() )
		{
			wrong( "waypoints", "the frame is there already", "give another pose" );
		}
	}

	void checkRadii() const
	{
		double before = 0; // taken from the part's begin
		for ( std::size_t i = 0; i < m_parts.size(); ++i )
		{
			const Side& part = m_parts[i];
			if ( part.radius > 0 )
			{
				if ( i + 1 == m_parts.size() )
				{
					wrong(
					    part.name, "has a radius, and the way ends there", "give none to the first waypoint and the last" );
				}
				checkCorner( part, m_parts[i + 1] );
			}
			if ( before + part.radius > part.length + no_way && before + part.radius > 0 )
			{
				wrong( before > 0 ? part.name + " and the one before" : part.name,
				    fmt::format( "need {:g} m of a line of {:g} m for their radii", before + part.radius, part.length ),
				    "give smaller radii: both of a line's ends fit on it" );
			}
			before = part.radius;
		}
	}

	static void checkCorner( const Side& part, const Side& next )
	{
		if ( part.via || next.via || !( part.length > no_way ) || !( next.length > no_way ) )
		{
			wrong( part.name, "has a radius beside an arc or a turn in place", "round corners between two lines" );
		}
		if ( angleBetween( part, next ) > M_PI - back )
		{
			wrong( part.name, "has a radius where the way turns back", "rest there, or go around by another waypoint" );
		}
	}

	static Vector3d directionOf( const Side& part ) { return vectorOf( part.def.shift ).normalized(); }
	static double angleBetween( const Side& a, const Side& b )
	{
		const Vector3d u = directionOf( a ), v = directionOf( b );
		return std::atan2( u.cross( v ).norm(), u.dot( v ) );
	}

	static std::uint32_t statesOf( double way, double turn, std::uint32_t least )
	{
		std::uint32_t states = least;
		while ( states < most_first_states && ( way > first_length * states || turn > first_turn * states ) )
		{
			states *= 2;
		}
		return states;
	}

	/// From rest to rest along one part.
	Run lone( const Side& part ) const
	{
		Leg leg;
		leg.def = part.def;
		leg.length = part.length;
		leg.part = part.number;
		leg.states = statesOf( part.length, part.turn, least_first_states );
		leg.region = regionOf( m_problem, leg.def );
		Run run;
		run.length = part.length > no_way ? part.length : part.turn;
		run.legs.push_back( std::move( leg ) );
		return run;
	}

	Leg legOf( const Side& part, const Vector3d& from, const Vector3d* via, const Vector3d& to ) const
	{
		Leg leg;
		leg.part = part.number;
		leg.turns_apart = part.turn >= no_way;
		leg.def = defOf( m_task, true, !leg.turns_apart );
		const lw_transform a = movedTo( part.from, from ), b = movedTo( part.from, to );
		require( via != nullptr ? lw_region_arc( &leg.def, &a, { via->x(), via->y(), via->z() }, &b )
		                        : lw_region_line( &leg.def, &a, &b ),
		    "rounded corner" );
		leg.length = lengthOf( leg.def );
		return leg;
	}

	/// Both halves of the circle at the end of a part.
	std::pair<Leg, Leg> cornerOf( const Side& part, const Side& next ) const
	{
		const Vector3d corner = placeOf( part.to ), u = directionOf( part ), v = directionOf( next );
		const double half = 0.5 * angleBetween( part, next );
		const Vector3d inward = ( v - u ).normalized(), center = corner + part.radius / std::sin( half ) * inward;
		const double radius = part.radius / std::tan( half );
		const Vector3d begin = corner - part.radius * u, end = corner + part.radius * v, middle = center - radius * inward;
		const auto between = [&]( const Vector3d& a, const Vector3d& b )
		{ return Vector3d( center + radius * ( a + b - 2 * center ).normalized() ); };
		const Vector3d left = between( begin, middle ), right = between( middle, end );
		return { legOf( part, begin, &left, middle ), legOf( next, middle, &right, end ) };
	}

	/// Without a rest from the begin of one part to the end of another.
	Run rounded( std::size_t first, std::size_t last ) const
	{
		Run run;
		Vector3d from = placeOf( m_parts[first].from );
		for ( std::size_t i = first; i <= last; ++i )
		{
			const Side& part = m_parts[i];
			const bool rounds = i < last && angleBetween( part, m_parts[i + 1] ) > straight;
			const Vector3d to = placeOf( part.to ) - ( rounds ? part.radius : 0 ) * directionOf( part );
			if ( ( to - from ).norm() > no_way )
			{
				run.legs.push_back( legOf( part, from, nullptr, to ) );
			}
			from = to;
			if ( rounds )
			{
				auto [left, right] = cornerOf( part, m_parts[i + 1] );
				run.legs.push_back( std::move( left ) );
				run.legs.push_back( std::move( right ) );
				from = placeOf( part.to ) + part.radius * directionOf( m_parts[i + 1] );
			}
		}
		takeCourses( run );
		takeTurns( run, first, last );
		for ( Leg& leg : run.legs )
		{
			leg.region = regionOf( m_problem, leg.def );
		}
		return run;
	}

	/// The share of the length goes as 3 u^2 - 2 u^3 at the ends of legs, and by cubics with its speeds between them.
	static void takeCourses( Run& run )
	{
		std::vector<double> part_lengths( run.legs.back().part + 1, 0.0 );
		for ( const Leg& leg : run.legs )
		{
			run.length += leg.length;
			part_lengths[leg.part] += leg.length;
		}
		double sum = 0, part_sum = 0;
		std::uint32_t place = 0;
		for ( std::size_t i = 0; i < run.legs.size(); ++i )
		{
			Leg& leg = run.legs[i];
			part_sum = i > 0 && run.legs[i - 1].part == leg.part ? part_sum : 0;
			leg.part_from = part_sum / part_lengths[leg.part];
			leg.run_from = sum / run.length;
			sum += leg.length;
			part_sum += leg.length;
			const bool is_last = i + 1 == run.legs.size();
			leg.run_to = is_last ? 1 : sum / run.length;
			leg.part_to = part_sum / part_lengths[leg.part];
			const auto to = static_cast<std::uint32_t>( std::lround( most_places * unitTime( leg.run_to ) ) );
			leg.course.from = place;
			leg.course.to = place = is_last ? most_places : to;
			if ( leg.course.to < leg.course.from + least_places )
			{
				wrong( fmt::format( "part {}", leg.part + 1 ),
				    fmt::format( "has {:g} m of a way of {:g} m without a rest", leg.length, run.length ),
				    "give larger radii, or rest at some of the waypoints" );
			}
			const auto speed = [&]( std::uint32_t at )
			{
				const double u = parameter( at );
				return 6 * u * ( 1 - u ) * leg.course.width() / ( leg.run_to - leg.run_from );
			};
			leg.course.first = speed( leg.course.from );
			leg.course.last = speed( leg.course.to );
		}
	}

	/// The axes turn from waypoint to waypoint, and do not turn in the middle of a rounded corner.
	void takeTurns( Run& run, std::size_t first, std::size_t last ) const
	{
		for ( std::size_t i = first; i <= last; ++i )
		{
			const Side& part = m_parts[i];
			Course course;
			bool begun = false;
			for ( const Leg& leg : run.legs )
			{
				if ( leg.part == part.number )
				{
					course.from = begun ? course.from : leg.course.from;
					course.to = leg.course.to;
					begun = true;
				}
			}
			for ( Leg& leg : run.legs )
			{
				if ( leg.part != part.number )
				{
					continue;
				}
				leg.states = statesOf( leg.length, part.turn * leg.course.width() / course.width(), least_blend_states );
				if ( leg.turns_apart )
				{
					leg.turning = defOf( m_task, false, true );
					require( lw_region_line( &leg.turning, &part.from, &part.to ), "turn of a rounded corner" );
					leg.turning_course = course;
					leg.turning_region = regionOf( m_problem, leg.turning );
				}
			}
		}
	}

	const io::Problem& m_problem;
	const Task& m_task;
	std::vector<Side> m_parts;
};

} // namespace

[[noreturn]] void wrong( const std::string& element, const std::string& problem, const std::string& remedy )
{
	throw io::Error( "line", element, problem, remedy );
}

double length( const lw_vec3& v )
{
	return std::sqrt( v.x * v.x + v.y * v.y + v.z * v.z );
}

double fractionAt( double u )
{
	return u * u * ( 3 - 2 * u );
}

// ---- courses and legs

/// A cubic from 0 to 1 with speeds at both ends.
static double cubicAt( double v, double first, double last )
{
	return fractionAt( v ) + v * ( 1 - v ) * ( first * ( 1 - v ) - last * v );
}

double Pace::at( double time ) const
{
	return cubicAt( ( time - begin ) / seconds, first, last );
}

lw_transform Part::wanted( double time ) const
{
	lw_transform pose = lw_region_reference( &region, pace.at( time ) );
	if ( turns_apart )
	{
		const lw_transform axes = lw_region_reference( &turning, turning_pace.at( time ) );
		std::copy_n( &axes.r[0][0], 9, &pose.r[0][0] );
	}
	return pose;
}

double Course::at( std::uint32_t place ) const
{
	return cubicAt( parameter( place - from ) / width(), first, last );
}

double Course::flow( std::uint32_t place ) const
{
	const double v = parameter( place - from ) / width();
	return ( 6 * v * ( 1 - v ) + first * ( 1 - v ) * ( 1 - 3 * v ) + last * v * ( 3 * v - 2 ) ) / width();
}

double Course::mostFlow() const
{
	// A parabola in v: its ends and its top
	const double bend = 3 * ( first + last ) - 6, slope = 6 - 4 * first - 2 * last;
	double most = std::max( first, last );
	const double top = bend < 0 ? -slope / ( 2 * bend ) : -1;
	if ( top > 0 && top < 1 )
	{
		most = std::max( most, first + top * ( slope + top * bend ) );
	}
	return most / width();
}

void Course::points( std::uint32_t begin, std::uint32_t end, double out[4] ) const
{
	const double third = parameter( end - begin ) / 3;
	out[0] = at( begin );
	out[1] = out[0] + flow( begin ) * third;
	out[3] = at( end );
	out[2] = out[3] - flow( end ) * third;
}

ik::Pose Leg::pose( std::uint32_t place ) const
{
	ik::Pose pose = ik::toPose( lw_region_reference( &def, course.at( place ) ) );
	if ( turns_apart )
	{
		pose.r = ik::toPose( lw_region_reference( &turning, turning_course.at( place ) ) ).r;
	}
	return pose;
}

Leg::Motion Leg::motion( std::uint32_t place, double fraction, double turn ) const
{
	const double at = course.at( place );
	const Vector3d arm =
	    ik::toPose( lw_region_reference( &def, at ) ).t - at * vectorOf( def.shift ) - vectorOf( def.center );
	return { fraction * ( vectorOf( def.shift ) + vectorOf( def.arc ).cross( arm ) ),
	    turn * vectorOf( turns_apart ? turning.turn : def.turn ) };
}

std::vector<Run> runsOf( const io::Problem& problem, const Task& task, const lw_transform& start )
{
	return Ways( problem, task, start ).runs();
}

} // namespace leeway::lines
