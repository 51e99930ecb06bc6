// SPDX-License-Identifier: BSD-3-Clause
// Trajectories along paths: see timed.hpp.
#include "leeway/motions/timed.hpp"
#include "leeway/motions/motion_files.hpp"

#include "motions/json.hpp"
#include "motions/profile.hpp"

#include <algorithm>
#include <cmath>

namespace leeway::motions
{
namespace
{

using State = std::vector<double>;

constexpr double nanosecond = 1e-9;
/// Of the limits: times of points are rounded, and so are the quintics between them.
constexpr double share_of_limits = 1 - 1e-3;
/// Of an edge: its rounding at a corner takes at most this.
constexpr double share_of_edge = 0.45;
/// How often a rounding is halved until it is proved free.
constexpr int most_halvings = 7;

} // namespace

MotionLimits motionLimits( const io::Problem& problem, const io::RobotModel& robot, const JointLimits& limits )
{
	MotionLimits out;
	for ( const std::string& name : problem.variable_names )
	{
		const lw_variable_info info = lw_robot_variable( problem.robot.get(), variableOf( problem.robot.get(), name ) );
		if ( lw_robot_joint_type( problem.robot.get(), info.joint ) == LW_JOINT_FLOATING )
		{
			throw io::Error( robot.urdf_file, "joint " + name, "is part of a floating joint, whose turns no trajectory has",
			    "choose a group without it, or ask for no trajectory" );
		}
		const VariableLimits most = limitsOf( limits, robot, name );
		out.velocity.push_back( most.velocity );
		out.acceleration.push_back( most.acceleration );
		out.jerk.push_back( most.jerk );
		if ( !( out.velocity.back() > 0 ) )
		{
			throw io::Error( robot.urdf_file, "joint " + name, "has no velocity limit",
			    "give one here, or in a file of joint limits (--joint-limits)" );
		}
		if ( !( out.acceleration.back() > 0 ) )
		{
			out.acceleration.back() = default_acceleration;
			out.usual.push_back( name );
		}
		if ( !( out.jerk.back() > 0 ) )
		{
			out.jerk.back() = default_jerk * out.acceleration.back();
			out.usual_jerk.push_back( name );
		}
	}
	return out;
}

namespace
{

/// A straight edge, without its roundings.
struct Edge
{
	State from, direction; ///< of length 1
	double length = 0;
	LineLimits limits{};
	double left = 0, right = 0; ///< lengths that roundings take
	double clear() const { return length - left - right; }
};

/// A corner between two edges: a quintic from `cut` before it to `cut` behind it, driven in 2 cut / speed seconds. Velocities go from one direction to
/// the other, with no acceleration at both ends.
struct Corner
{
	double cut = 0, speed = 0; ///< 0: a stop
};

State moved( State q, const State& direction, double length )
{
	for ( std::size_t v = 0; v < q.size(); ++v )
	{
		q[v] += length * direction[v];
	}
	return q;
}

/// Limits along a direction.
LineLimits limitsAlong( const State& direction, const MotionLimits& limits )
{
	LineLimits out{ HUGE_VAL, HUGE_VAL, HUGE_VAL };
	for ( std::size_t v = 0; v < direction.size(); ++v )
	{
		const double share = std::abs( direction[v] ) / share_of_limits;
		if ( share > 0 )
		{
			out.velocity = std::min( out.velocity, limits.velocity[v] / share );
			out.acceleration = std::min( out.acceleration, limits.acceleration[v] / share );
			out.jerk = std::min( out.jerk, limits.mostJerk( v ) / share );
		}
	}
	return out;
}

/// Edges of the path, without those of no length.
std::vector<Edge> edgesOf( const io::Problem& problem, const std::vector<State>& points, const MotionLimits& limits )
{
	std::vector<Edge> edges;
	State from = points.front();
	for ( std::size_t k = 1; k < points.size(); ++k )
	{
		Edge edge;
		edge.from = from;
		for ( std::size_t v = 0; v < from.size(); ++v )
		{
			const double shorter = shorterWay( problem.robot.get(), problem.variables[v], from[v], points[k][v] );
			edge.direction.push_back( shorter );
			edge.length = std::hypot( edge.length, shorter );
			from[v] = shorter == points[k][v] - from[v] ? points[k][v] : from[v] + shorter;
		}
		if ( edge.length > 0 )
		{
			for ( double& d : edge.direction )
			{
				d /= edge.length;
			}
			edge.limits = limitsAlong( edge.direction, limits );
			edges.push_back( std::move( edge ) );
		}
	}
	return edges;
}

class Roundings
{
public:
	Roundings( const io::Problem& problem, const MotionLimits& limits, const TimingSettings& settings )
	    : m_checker( problem.checker.get() ), m_query( makeQuery( m_checker ) ), m_limits( limits ), m_settings( settings )
	{
	}

	/// The largest one that is proved free, of `most` and its halves.
	Corner at( const Edge& in, const Edge& out, double most )
	{
		double turn = 0; // length of the difference of the directions
		for ( std::size_t v = 0; v < in.direction.size(); ++v )
		{
			turn = std::hypot( turn, out.direction[v] - in.direction[v] );
		}
		Corner corner;
		corner.cut = std::min( most, m_settings.path_tolerance / ( deviation * std::max( turn, 1e-12 ) ) );
		for ( int i = 0; i <= most_halvings && corner.cut > 0; ++i, corner.cut *= 0.5 )
		{
			if ( isFree( in, out, corner.cut ) )
			{
				corner.speed = speedOf( in, out, corner.cut );
				return corner;
			}
		}
		return {};
	}

private:
	/// In cuts and lengths of the turn: the middle of a quintic from its corner; its largest acceleration and jerk at a speed of 1.
	static constexpr double deviation = 0.1875, most_pull = 0.75, most_jerk = 1.5;

	bool isFree( const Edge& in, const Edge& out, double cut )
	{
		const double along[] = { -1, -0.6, -0.2, 0.2, 0.6, 1 };
		std::vector<double> points;
		for ( const double share : along )
		{
			const State q = moved( out.from, share < 0 ? in.direction : out.direction, share * cut );
			points.insert( points.end(), q.begin(), q.end() );
		}
		lw_edge_result result;
		const lw_status status = lw_checker_curve( m_checker, m_query.get(), points.data(), 5, &m_settings.edge, &result );
		require( status, "a rounding" );
		return result.verdict == LW_VERDICT_FREE;
	}
	double speedOf( const Edge& in, const Edge& out, double cut ) const
	{
		double speed = std::min( in.limits.velocity, out.limits.velocity );
		for ( std::size_t v = 0; v < in.direction.size(); ++v )
		{
			const double turn = std::abs( out.direction[v] - in.direction[v] );
			if ( turn > 0 )
			{
				const double pull = share_of_limits * m_limits.acceleration[v],
				             jerk = share_of_limits * m_limits.mostJerk( v );
				speed = std::min( { speed, std::sqrt( pull * cut / ( most_pull * turn ) ),
				    std::cbrt( jerk * cut * cut / ( most_jerk * turn ) ), 2 * cut / shortest_phase } );
			}
		}
		return speed;
	}

	const lw_checker* m_checker;
	Query m_query;
	const MotionLimits& m_limits;
	const TimingSettings& m_settings;
};

/// Speeds at corners that can be reached from the corners before and behind.
void connect( std::vector<Corner>& corners, const std::vector<Edge>& edges )
{
	double speed = 0;
	for ( std::size_t k = 0; k < corners.size(); ++k )
	{
		speed = corners[k].speed = std::min( corners[k].speed, reachableSpeed( speed, edges[k].clear(), edges[k].limits ) );
	}
	speed = 0;
	for ( std::size_t k = corners.size(); k-- > 0; )
	{
		const Edge& behind = edges[k + 1];
		speed = corners[k].speed = std::min( corners[k].speed, reachableSpeed( speed, behind.clear(), behind.limits ) );
	}
}

/// Collects points at whole nanoseconds.
class Points
{
public:
	explicit Points( const State& start ) { add( 0, start, start, { 0, 0, 0, 0 } ); }

	/// A state of a line from `from`, some seconds after the last phase.
	void add( double begin, const State& from, const State& direction, const LineState& at )
	{
		const double exact = begin + at.time, time = std::round( exact / nanosecond ) * nanosecond, late = time - exact;
		const double place = at.place + late * ( at.speed + 0.5 * late * at.acceleration ),
		             speed = at.speed + late * at.acceleration;
		TrajectoryPoint point;
		point.time = time;
		for ( std::size_t v = 0; v < from.size(); ++v )
		{
			point.positions.push_back( from[v] + place * direction[v] );
			point.velocities.push_back( speed * direction[v] );
			point.accelerations.push_back( at.acceleration * direction[v] );
		}
		m_points.push_back( std::move( point ) );
	}
	std::vector<TrajectoryPoint> take() { return std::move( m_points ); }

private:
	std::vector<TrajectoryPoint> m_points;
};

} // namespace

TrajectoryFile timedPath( const io::Problem& problem, const std::vector<std::vector<double>>& points,
    const MotionLimits& limits, const TimingSettings& settings )
{
	std::vector<Edge> edges = edgesOf( problem, points, limits );
	std::vector<Corner> corners( edges.empty() ? 0 : edges.size() - 1 );
	if ( settings.path_tolerance > 0 && !corners.empty() )
	{
		Roundings roundings( problem, limits, settings );
		for ( std::size_t k = 0; k < corners.size(); ++k )
		{
			corners[k] =
			    roundings.at( edges[k], edges[k + 1], share_of_edge * std::min( edges[k].length, edges[k + 1].length ) );
			edges[k].right = edges[k + 1].left = corners[k].cut;
		}
	}
	connect( corners, edges );
	TrajectoryFile out;
	out.file = "the path";
	out.joint_names = problem.variable_names;
	Points timed( points.front() );
	double begin = 0;
	for ( std::size_t k = 0; k < edges.size(); ++k )
	{
		const Edge& edge = edges[k];
		const State from = moved( edge.from, edge.direction, edge.left );
		const double entry = k > 0 ? corners[k - 1].speed : 0, exit = k < corners.size() ? corners[k].speed : 0;
		if ( k > 0 && corners[k - 1].cut > 0 )
		{
			begin += 2 * corners[k - 1].cut / entry;
			timed.add( begin, from, edge.direction, { 0, 0, entry, 0 } );
		}
		const std::vector<LineState> states = fastestProfile( edge.clear(), entry, exit, edge.limits );
		for ( std::size_t i = 1; i < states.size(); ++i )
		{
			timed.add( begin, from, edge.direction, states[i] );
		}
		begin += states.back().time;
	}
	out.points = timed.take();
	return out;
}

TrajectoryFile endsOf(
    const io::Problem& problem, const std::vector<Segment>& segments, const std::vector<double>& standing )
{
	const std::size_t count = problem.variable_names.size();
	TrajectoryFile out;
	out.file = "the path";
	out.joint_names = problem.variable_names;
	// from, to: the outermost control points at an end
	const auto add = [&]( const double* at, const double* from, const double* to, double seconds, double time )
	{
		TrajectoryPoint point;
		point.time = time;
		for ( std::size_t v = 0; v < count; ++v )
		{
			point.positions.push_back( at[v] );
			point.velocities.push_back( 3 * ( to[v] - from[v] ) / seconds + 0.0 );
		}
		out.points.push_back( std::move( point ) );
	};
	if ( segments.empty() )
	{
		add( standing.data(), standing.data(), standing.data(), 1, 0 );
		return out;
	}
	const double* begin = segments.front().points.data();
	add( begin, begin, begin + count, segments.front().seconds, 0 );
	for ( const Segment& segment : segments )
	{
		const double* end = segment.points.data() + 3 * count;
		add( end, end - count, end, segment.seconds, segment.begin + segment.seconds );
	}
	return out;
}

std::string robotTrajectory( const TrajectoryFile& trajectory )
{
	Json points = Json::array();
	for ( const TrajectoryPoint& of : trajectory.points )
	{
		Json point = { { "positions", of.positions }, { "velocities", of.velocities } };
		if ( !of.accelerations.empty() )
		{
			point["accelerations"] = of.accelerations;
		}
		point["time_from_start"] = timeFromStart( of.time );
		points.push_back( point );
	}
	Json out;
	out["joint_trajectory"] = { { "joint_names", trajectory.joint_names }, { "points", points } };
	return jsonText( out );
}

} // namespace leeway::motions
