// SPDX-License-Identifier: BSD-3-Clause
// Trajectories that stop at corners: see timed.hpp.
#include "leeway/motions/timed.hpp"

#include "motions/json.hpp"

#include <algorithm>
#include <cmath>

namespace leeway::motions
{
namespace
{

// Of p(s) = 10 s^3 - 15 s^4 + 6 s^5 from 0 to 1: the largest first and second derivatives.
constexpr double most_speed = 1.875, most_pull = 5.773502691896258;
constexpr double nanosecond = 1e-9;

double limitOf( const std::map<std::string, double>& limits, const std::string& name, double otherwise )
{
	const auto found = limits.find( name );
	return found == limits.end() ? otherwise : found->second;
}

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
		double urdf = 0;
		for ( const io::JointModel& joint : robot.joints )
		{
			urdf = joint.name == name ? joint.velocity : urdf;
		}
		out.velocity.push_back( limitOf( limits.velocity, name, urdf ) );
		out.acceleration.push_back( limitOf( limits.acceleration, name, default_acceleration ) );
		if ( !( out.velocity.back() > 0 ) )
		{
			throw io::Error( robot.urdf_file, "joint " + name, "has no velocity limit",
			    "give one here, or in a file of joint limits (--joint-limits)" );
		}
		if ( limits.acceleration.count( name ) == 0 )
		{
			out.usual.push_back( name );
		}
	}
	return out;
}

std::vector<Segment> stopAtCorners(
    const io::Problem& problem, const std::vector<std::vector<double>>& points, const MotionLimits& limits )
{
	const std::vector<std::string>& names = problem.variable_names;
	std::vector<Segment> segments;
	std::vector<double> from = points.front();
	double begin = 0;
	for ( std::size_t k = 1; k < points.size(); ++k )
	{
		std::vector<double> to = points[k];
		double seconds = 0;
		for ( std::size_t v = 0; v < names.size(); ++v )
		{
			const double shorter = shorterWay( problem.robot.get(), problem.variables[v], from[v], to[v] );
			to[v] = shorter == to[v] - from[v] ? to[v] : from[v] + shorter;
			seconds = std::max( { seconds, most_speed * std::abs( shorter ) / limits.velocity[v],
			    std::sqrt( most_pull * std::abs( shorter ) / limits.acceleration[v] ) } );
		}
		if ( !( seconds > 0 ) )
		{
			continue; // twice the same point
		}
		Segment segment;
		segment.begin = begin;
		segment.seconds = ( std::ceil( seconds * ( 1 + 1e-9 ) / nanosecond ) + 1 ) * nanosecond;
		segment.degree = 5;
		for ( int i = 0; i < 6; ++i )
		{
			segment.points.insert( segment.points.end(), i < 3 ? from.begin() : to.begin(), i < 3 ? from.end() : to.end() );
		}
		begin += segment.seconds;
		segments.push_back( std::move( segment ) );
		from = to;
	}
	if ( segments.empty() ) // start and goal are one state
	{
		Segment segment;
		segment.points = from;
		segment.points.insert( segment.points.end(), from.begin(), from.end() );
		segments.push_back( std::move( segment ) );
	}
	return segments;
}

std::string robotTrajectory( const io::Problem& problem, const std::vector<Segment>& segments )
{
	const std::vector<std::string>& names = problem.variable_names;
	const std::vector<double> rest( names.size(), 0.0 );
	const auto count = static_cast<std::ptrdiff_t>( names.size() );
	Json points = Json::array();
	const auto add = [&]( const std::vector<double>& q, double time )
	{
		points.push_back( { { "positions", q }, { "velocities", rest }, { "accelerations", rest },
		    { "time_from_start", timeFromStart( time ) } } );
	};
	add( { segments.front().points.begin(), segments.front().points.begin() + count }, 0 );
	for ( const Segment& segment : segments )
	{
		if ( segment.seconds > 0 )
		{
			add( { segment.points.end() - count, segment.points.end() }, segment.begin + segment.seconds );
		}
	}
	Json out;
	out["joint_trajectory"] = { { "joint_names", names }, { "points", points } };
	return jsonText( out );
}

} // namespace leeway::motions
