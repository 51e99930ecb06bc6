// SPDX-License-Identifier: BSD-3-Clause
// Timed trajectories: see trajectory.hpp. Control points of Hermite data: core/docs/motions.md.
#include "leeway/motions/trajectory.hpp"
#include "leeway/motions/motion_files.hpp"

#include "leeway/handles.hpp"
#include "motions/names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

namespace leeway::motions
{
namespace
{

// ---- segments --------------------------------------------------------------------------------------------------------

/// Columns of the group's variables.
std::vector<std::size_t> columnsOf( const io::Problem& problem, const TrajectoryFile& file )
{
	const std::vector<std::string>& wanted = problem.variable_names;
	const std::string group = problem.group.empty() ? "all joints" : "group '" + problem.group + "'";
	std::vector<std::size_t> columns;
	for ( const std::string& name : wanted )
	{
		const auto found = std::find( file.joint_names.begin(), file.joint_names.end(), name );
		if ( found == file.joint_names.end() )
		{
			throw io::Error( file.file, file.at( "joint_names" ), fmt::format( "lacks joint '{}' of {}", name, group ),
			    "name the group of the trajectory by --group" );
		}
		columns.push_back( static_cast<std::size_t>( found - file.joint_names.begin() ) );
	}
	for ( const std::string& name : file.joint_names )
	{
		if ( std::find( wanted.begin(), wanted.end(), name ) == wanted.end() )
		{
			throw io::Error( file.file, file.at( "joint_names" ), fmt::format( "joint '{}' is not in {}", name, group ),
			    "name the group of the trajectory by --group" );
		}
	}
	return columns;
}

/// @param index of b in the file
unsigned degreeOf( const TrajectoryFile& file, const TrajectoryPoint& a, const TrajectoryPoint& b, std::size_t index,
    Interpolation interpolation )
{
	const bool velocities = !a.velocities.empty() && !b.velocities.empty();
	const bool accelerations = velocities && !a.accelerations.empty() && !b.accelerations.empty();
	for ( const TrajectoryPoint* point : { &a, &b } )
	{
		if ( interpolation == Interpolation::automatic && point->velocities.empty() && !point->accelerations.empty() )
		{
			throw io::Error( file.file, file.at( fmt::format( "points[{}]", point == &a ? index - 1 : index ) ),
			    "has accelerations and no velocities: ROS's joint_trajectory_controller does not interpolate such points",
			    "add the velocities, or remove the accelerations" );
		}
	}
	switch ( interpolation )
	{
	case Interpolation::linear:
		return 1;
	case Interpolation::automatic:
		return accelerations ? 5 : velocities ? 3 : 1;
	case Interpolation::cubic:
	case Interpolation::quintic:
		break;
	}
	const bool cubic = interpolation == Interpolation::cubic;
	if ( !( cubic ? velocities : accelerations ) )
	{
		const std::size_t lacking = ( cubic ? a.velocities : a.accelerations ).empty() ? index - 1 : index;
		throw io::Error( file.file, file.at( fmt::format( "points[{}]", lacking ) ),
		    cubic ? "has no velocities" : "has no velocities or no accelerations",
		    "add them, or choose --interpolation auto or linear" );
	}
	return cubic ? 3 : 5;
}

Segment segmentOf(
    const TrajectoryPoint& a, const TrajectoryPoint& b, const std::vector<std::size_t>& columns, unsigned degree )
{
	Segment s;
	s.seconds = b.time - a.time;
	s.degree = degree;
	s.points.resize( ( degree + 1 ) * columns.size() );
	const double h = s.seconds;
	for ( std::size_t v = 0; v < columns.size(); ++v )
	{
		const std::size_t k = columns[v];
		const auto point = [&]( unsigned n ) -> double& { return s.points[n * columns.size() + v]; };
		const double p0 = a.positions[k], p1 = b.positions[k];
		point( 0 ) = p0;
		point( degree ) = p1;
		if ( degree == 3 )
		{
			point( 1 ) = p0 + h * a.velocities[k] / 3;
			point( 2 ) = p1 - h * b.velocities[k] / 3;
		}
		else if ( degree == 5 )
		{
			point( 1 ) = p0 + h * a.velocities[k] / 5;
			point( 2 ) = p0 + 2 * h * a.velocities[k] / 5 + h * h * a.accelerations[k] / 20;
			point( 3 ) = p1 - 2 * h * b.velocities[k] / 5 + h * h * b.accelerations[k] / 20;
			point( 4 ) = p1 - h * b.velocities[k] / 5;
		}
	}
	return s;
}

// ---- limits ----------------------------------------------------------------------------------------------------------

struct Extremes
{
	double least = HUGE_VAL, least_at = 0, most = -HUGE_VAL, most_at = 0;
};

/// Extremes of a Bezier polynomial on [a, b], to `precision`: its control points enclose it, its ends are on it.
void addExtremes( const std::vector<double>& points, double a, double b, double precision, Extremes& out )
{
	const std::size_t n = points.size() - 1;
	if ( !std::all_of( points.begin(), points.end(), []( double value ) { return std::isfinite( value ); } ) )
	{
		out.most = HUGE_VAL; // an overflow keeps no limit
		return;
	}
	const auto take = [&out]( double value, double at )
	{
		if ( value < out.least )
		{
			out.least = value;
			out.least_at = at;
		}
		if ( value > out.most )
		{
			out.most = value;
			out.most_at = at;
		}
	};
	take( points.front(), a );
	take( points.back(), b );
	const auto [low, high] = std::minmax_element( points.begin(), points.end() );
	if ( ( *low >= out.least - precision && *high <= out.most + precision ) || b - a < 1e-9 )
	{
		return;
	}
	std::vector<double> row = points, left( n + 1 ), right( n + 1 ); // de Casteljau
	for ( std::size_t k = 0; k <= n; ++k )
	{
		left[k] = row.front();
		right[n - k] = row[n - k];
		for ( std::size_t i = 0; i + k < n; ++i )
		{
			row[i] = 0.5 * ( row[i] + row[i + 1] );
		}
	}
	const double middle = 0.5 * ( a + b );
	addExtremes( left, a, middle, precision, out );
	addExtremes( right, middle, b, precision, out );
}

/// @param seconds 0: a state that is held, which has none
std::vector<double> derivative( const std::vector<double>& points, double seconds )
{
	std::vector<double> out;
	for ( std::size_t i = 0; i + 1 < points.size() && seconds > 0; ++i )
	{
		out.push_back( static_cast<double>( points.size() - 1 ) * ( points[i + 1] - points[i] ) / seconds );
	}
	return out;
}

struct Limit
{
	double lower = -HUGE_VAL, upper = HUGE_VAL;
	const char *what, *unit;
	double tolerance;
};

/// The first segment in which a variable exceeds a limit.
bool exceeds( const Segment& segment, const std::vector<double>& points, const std::string& name, const Limit& limit,
    std::vector<std::string>& problems )
{
	if ( points.empty() || ( limit.lower == -HUGE_VAL && limit.upper == HUGE_VAL ) )
	{
		return false;
	}
	Extremes found;
	addExtremes( points, 0, 1, 1e-9, found );
	const bool above = found.most > limit.upper + limit.tolerance, below = found.least < limit.lower - limit.tolerance;
	if ( above || below )
	{
		problems.push_back( fmt::format( "joint {}: {} of {:.6g} {} at {:.4f} s is {} its limit {:.6g}", name, limit.what,
		    above ? found.most : found.least, limit.unit,
		    segment.begin + segment.seconds * ( above ? found.most_at : found.least_at ), above ? "above" : "below",
		    above ? limit.upper : limit.lower ) );
	}
	return above || below;
}

void checkLimits( const io::Problem& problem, const io::RobotModel& robot, const std::vector<Segment>& segments,
    const JointLimits& limits, std::vector<std::string>& problems )
{
	const std::vector<std::string>& names = problem.variable_names;
	for ( std::size_t v = 0; v < names.size(); ++v )
	{
		const lw_variable_info info = lw_robot_variable( problem.robot.get(), problem.variables[v] );
		const bool shift = lw_robot_joint_type( problem.robot.get(), info.joint ) == LW_JOINT_PRISMATIC;
		const VariableLimits most = limitsOf( limits, robot, names[v] );
		const auto within = []( double limit, const char* what, const char* unit )
		{
			const double bound = limit > 0 ? limit : HUGE_VAL;
			return Limit{ -bound, bound, what, unit, 1e-6 * bound };
		};
		const Limit position{ info.wraps ? -HUGE_VAL : info.lower, info.wraps ? HUGE_VAL : info.upper, "position",
		    shift ? "m" : "rad", limit_tolerance };
		const Limit velocity = within( most.velocity, "velocity", shift ? "m/s" : "rad/s" );
		const Limit acceleration = within( most.acceleration, "acceleration", shift ? "m/s^2" : "rad/s^2" );
		const Limit jerk = within( most.jerk, "jerk", shift ? "m/s^3" : "rad/s^3" );
		bool told[4] = { false, false, false, false };
		for ( const Segment& segment : segments )
		{
			std::vector<double> own;
			for ( unsigned i = 0; i <= segment.degree; ++i )
			{
				own.push_back( segment.points[i * names.size() + v] );
			}
			const std::vector<double> first = derivative( own, segment.seconds ),
			                          second = derivative( first, segment.seconds ),
			                          third = derivative( second, segment.seconds );
			told[0] = told[0] || exceeds( segment, own, names[v], position, problems );
			told[1] = told[1] || exceeds( segment, first, names[v], velocity, problems );
			told[2] = told[2] || exceeds( segment, second, names[v], acceleration, problems );
			told[3] = told[3] || exceeds( segment, third, names[v], jerk, problems );
		}
	}
}

std::vector<double> valueOf( const Segment& segment, std::size_t count, double t )
{
	std::vector<double> row = segment.points;
	for ( unsigned k = segment.degree; k > 0; --k )
	{
		for ( std::size_t i = 0; i < k * count; ++i )
		{
			row[i] += t * ( row[i + count] - row[i] );
		}
	}
	row.resize( count );
	return row;
}

/// Where a proof ended. A proof looks no closer at a contact than it has to: the clearance of the state is measured here.
Violation violationOf( const io::Problem& problem, lw_query* query, const Segment& segment, const lw_edge_result& result,
    lw_check_flags flags, const std::string& file )
{
	Violation out;
	out.verdict = result.verdict;
	out.time = segment.begin + segment.seconds * result.t;
	out.q = valueOf( segment, problem.variable_names.size(), result.t );
	out.names = problem.variable_names;
	out.self = result.self;
	out.pair =
	    result.self ? nameSelf( problem.checker.get(), result.pair ) : nameEnvironment( problem.checker.get(), result.pair );
	if ( result.verdict == LW_VERDICT_BLOCKED )
	{
		const lw_state_result state =
		    measure( problem.checker.get(), query, out.q, flags, nullptr, file, "the state of the violation" );
		out.pair = result.self ? nameSelf( problem.checker.get(), state.self )
		                       : nameEnvironment( problem.checker.get(), state.environment );
	}
	return out;
}

} // namespace

std::vector<double> tolerances( const io::Problem& problem, const std::string& file,
    const std::map<std::string, double>& of_goal, const std::vector<Tolerance>& given )
{
	const std::vector<std::string>& names = problem.variable_names;
	std::vector<double> out( names.size(), 0.0 );
	const auto set = [&]( const std::string& name, double value, const std::string& source, const std::string& element )
	{
		const auto found = std::find( names.begin(), names.end(), name );
		if ( found == names.end() )
		{
			throw io::Error(
			    source, element, fmt::format( "joint '{}' is not in the group", name ), useOneOf( name, names ) );
		}
		if ( !( value >= 0 ) )
		{
			throw io::Error( source, element, "is negative", "give radians or metres, 0 or more" );
		}
		out[static_cast<std::size_t>( found - names.begin() )] = value;
	};
	for ( const auto& [name, value] : of_goal )
	{
		const bool is_given = std::any_of( given.begin(), given.end(),
		    [&, &joint = name]( const Tolerance& tolerance )
		    { return tolerance.variable.empty() || tolerance.variable == joint; } );
		if ( value > 0 )
		{
			set( name, value, file, "path_tolerance of " + name );
		}
		else if ( !is_given ) // as control_msgs/JointTolerance says
		{
			throw io::Error( file, "path_tolerance of " + name,
			    value < 0 ? fmt::format( "{:g} lets the controller deviate as far as it likes", value )
			              : "0 stands for the controller's own tolerance, which the file does not say",
			    fmt::format( "give it by --tolerance {}=RADIANS", name ) );
		}
	}
	for ( const Tolerance& tolerance : given )
	{
		for ( const std::string& name : tolerance.variable.empty() ? names : std::vector<std::string>{ tolerance.variable } )
		{
			set( name, tolerance.value, tolerance.file, tolerance.element );
		}
	}
	const bool any = std::any_of( out.begin(), out.end(), []( double value ) { return value > 0; } );
	return any ? out : std::vector<double>();
}

std::vector<Segment> segmentsOf(
    const io::Problem& problem, const TrajectoryFile& file, Interpolation interpolation, double begin )
{
	return segmentsOf( file, columnsOf( problem, file ), interpolation, begin );
}

std::vector<Segment> segmentsOf(
    const TrajectoryFile& file, const std::vector<std::size_t>& columns, Interpolation interpolation, double begin )
{
	std::vector<Segment> segments;
	for ( std::size_t i = 0; i + 1 < file.points.size(); ++i )
	{
		const TrajectoryPoint &a = file.points[i], &b = file.points[i + 1];
		segments.push_back( segmentOf( a, b, columns, degreeOf( file, a, b, i + 1, interpolation ) ) );
		segments.back().begin = begin + file.points[i].time - file.points.front().time;
	}
	if ( file.points.size() == 1 ) // one state that is held
	{
		segments.push_back( segmentOf( file.points.front(), file.points.front(), columns, 1 ) );
		segments.back().begin = begin;
	}
	return segments;
}

std::vector<Segment> approachesTo( const io::Problem& problem, const TrajectoryFile& file, const TrajectoryPoint& start,
    Interpolation interpolation, double begin )
{
	const std::vector<std::size_t> columns = columnsOf( problem, file );
	const unsigned most = degreeOf( file, start, file.points.front(), 0, interpolation );
	std::vector<Segment> segments;
	for ( unsigned degree = interpolation == Interpolation::automatic ? 1 : most; degree <= most; degree += 2 )
	{
		segments.push_back( segmentOf( start, file.points.front(), columns, degree ) );
		segments.back().begin = begin;
	}
	return segments;
}

TrajectoryAudit auditTrajectory( const io::Problem& problem, const io::RobotModel& robot, const std::string& file,
    const std::vector<Segment>& segments, const TrajectorySettings& settings, const std::vector<Segment>& instead )
{
	std::vector<Segment> driven = instead;
	driven.insert( driven.end(), segments.begin(), segments.end() );
	TrajectoryAudit audit;
	audit.segments = segments.size();
	audit.duration = segments.back().begin + segments.back().seconds;
	audit.min_d = settings.edge.min_d;
	for ( std::size_t v = 0; v < settings.tolerance.size(); ++v )
	{
		audit.tolerance[problem.variable_names[v]] = settings.tolerance[v];
	}
	lw_edge_def def = settings.edge;
	def.tolerance = settings.tolerance.empty() ? nullptr : settings.tolerance.data();
	double lower_bound = HUGE_VAL;
	const Query query = makeQuery( problem.checker.get() );
	const auto start = std::chrono::steady_clock::now();
	for ( const Segment& segment : segments )
	{
		++audit.by_degree[segment.degree];
	}
	for ( const Segment& segment : driven )
	{
		lw_edge_result result;
		require(
		    lw_checker_curve( problem.checker.get(), query.get(), segment.points.data(), segment.degree, &def, &result ),
		    "proof of a segment" );
		audit.states += result.queries;
		lower_bound = std::min( lower_bound, result.lower_bound );
		if ( result.verdict != LW_VERDICT_FREE )
		{
			audit.violation = violationOf( problem, query.get(), segment, result, def.flags, file );
			break;
		}
	}
	audit.proof_seconds = std::chrono::duration<double>( std::chrono::steady_clock::now() - start ).count();
	audit.lower_bound = audit.violation.verdict == LW_VERDICT_FREE ? lower_bound : 0;
	checkLimits( problem, robot, driven, settings.limits, audit.problems );
	return audit;
}

std::vector<double> stateAt( const std::vector<Segment>& segments, double time )
{
	std::size_t i = 0;
	while ( i + 1 < segments.size() && segments[i + 1].begin <= time )
	{
		++i;
	}
	const Segment& segment = segments[i];
	const double t = segment.seconds > 0 ? std::clamp( ( time - segment.begin ) / segment.seconds, 0.0, 1.0 ) : 0;
	return valueOf( segment, segment.points.size() / ( segment.degree + 1 ), t );
}

std::string describe( const TrajectoryAudit& audit )
{
	std::string out = fmt::format( "trajectory  {}, {:.4f} s: {} linear, {} cubic, {} quintic\n",
	    counted( audit.segments, "segment" ), audit.duration, audit.by_degree[1], audit.by_degree[3], audit.by_degree[5] );
	out += fmt::format( "proof       {:.6f} s, {} states{}\n", audit.proof_seconds, audit.states,
	    audit.tolerance.empty() ? "" : ", for all motions within the tolerance" );
	const Violation& v = audit.violation;
	if ( v.verdict == LW_VERDICT_FREE )
	{
		out += fmt::format(
		    "clearance   at least {:.6g} m at all times, proved; --min-d {:g} m\n", audit.lower_bound, audit.min_d );
	}
	else
	{
		out += fmt::format( "{}  {:.6f} s: {} - {}, {} clearance {:.6g} m{}\n",
		    v.verdict == LW_VERDICT_BLOCKED ? "BLOCKED   " : "UNDECIDED ", v.time, v.pair.first, v.pair.second,
		    v.self ? "self" : "environment", v.pair.least(), v.pair.marginText() );
		for ( std::size_t k = 0; k < v.q.size(); ++k )
		{
			out += fmt::format( "{}{} {:.6g}", k == 0 ? "state       " : ", ", v.names[k], v.q[k] );
		}
		out += v.q.empty() ? "" : "\n";
	}
	for ( const std::string& problem : audit.problems )
	{
		out += "problem     " + problem + "\n";
	}
	return out + ( audit.valid() ? "valid\n" : "not valid\n" );
}

} // namespace leeway::motions
