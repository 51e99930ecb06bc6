// SPDX-License-Identifier: BSD-3-Clause
// Trajectories one after the other, and the clearances over their time: see trajectory.hpp.
#include "leeway/motions/trajectory.hpp"
#include "motions/names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace leeway::motions
{
namespace
{

constexpr double profile_step = 0.01;          // seconds
constexpr std::size_t most_samples = 1u << 17; // of a profile
constexpr double gap_tolerance = 1e-3;         // radians or metres between the end of a trajectory and the start of the next

} // namespace

void append( TrajectoryAudit& whole, const TrajectoryAudit& next )
{
	const bool first = whole.segments == 0, was_free = whole.violation.verdict == LW_VERDICT_FREE;
	const bool is_free = was_free && next.violation.verdict == LW_VERDICT_FREE;
	whole.segments += next.segments;
	for ( std::size_t degree = 0; degree < std::size( whole.by_degree ); ++degree )
	{
		whole.by_degree[degree] += next.by_degree[degree];
	}
	whole.duration = next.duration;
	whole.violation = was_free ? next.violation : whole.violation;
	whole.lower_bound = !is_free ? 0 : first ? next.lower_bound : std::min( whole.lower_bound, next.lower_bound );
	whole.problems.insert( whole.problems.end(), next.problems.begin(), next.problems.end() );
	whole.min_d = next.min_d;
	whole.tolerance.insert( next.tolerance.begin(), next.tolerance.end() );
	whole.proof_seconds += next.proof_seconds;
	whole.states += next.states;
}

/// Empty: nothing is known.
std::vector<Drive::Place> Drive::placesOf( const TrajectoryFile& file, const std::string& name ) const
{
	std::vector<Place> out;
	const auto left = m_ends.find( name ), asked = m_start.find( name );
	const auto own = std::find_if( file.start_state.begin(), file.start_state.end(),
	    [&]( const std::pair<std::string, double>& entry ) { return entry.first == name; } );
	if ( left != m_ends.end() )
	{
		out.push_back( { left->second, "the end of the one before" } );
	}
	if ( own != file.start_state.end() )
	{
		out.push_back( { own->second, "its start state" } );
	}
	if ( left == m_ends.end() && asked != m_start.end() )
	{
		out.push_back( { asked->second, "the request's start" } );
	}
	return out;
}

/// The ways to a first point that comes later than the start; empty if it does not, or if the start is not known.
std::vector<Segment> Drive::approachesOf(
    const io::Problem& problem, const TrajectoryFile& file, const TrajectorySettings& settings )
{
	const TrajectoryPoint& first = file.points.front();
	if ( !( first.time > 0 ) )
	{
		return {};
	}
	TrajectoryPoint start = first; // with as many velocities and accelerations as it
	start.time = 0;
	std::fill( start.accelerations.begin(), start.accelerations.end(), 0.0 );
	std::vector<std::string> unknown;
	for ( std::size_t i = 0; i < file.joint_names.size(); ++i )
	{
		const std::string& name = file.joint_names[i];
		const std::vector<Place> places = placesOf( file, name );
		if ( places.empty() )
		{
			unknown.push_back( name );
			continue;
		}
		start.positions[i] = places.front().value;
		if ( !start.velocities.empty() )
		{
			const auto velocity = file.start_velocity.find( name );
			start.velocities[i] = velocity == file.start_velocity.end() ? 0 : velocity->second;
		}
	}
	const std::string element = file.at( "points[0].time_from_start" );
	if ( unknown.size() == file.joint_names.size() )
	{
		m_notices.push_back( { file.file, element,
		    fmt::format(
		        "the first point comes after {:g} s; the motion from the robot's state to it is not known and not proved",
		        first.time ) } );
		return {};
	}
	if ( !unknown.empty() )
	{
		throw io::Error( file.file, element,
		    fmt::format(
		        "the first point comes after {:g} s, and the start of {} is not known", first.time, listed( unknown ) ),
		    "name all joints of the trajectory in trajectory_start" );
	}
	return approachesTo( problem, file, start, settings.interpolation, m_begin );
}

/// Joints that stand elsewhere than a first point at time 0, to which the controller jumps, or in two places at once.
std::vector<std::string> Drive::differences(
    const io::Problem& problem, const io::RobotModel& robot, const TrajectoryFile& file, const Segment& first ) const
{
	const std::vector<std::string>& names = problem.variable_names;
	const std::string what = file.element.empty() ? file.file : file.element;
	std::vector<std::string> out;
	for ( const std::string& name : variableNames( robot ) )
	{
		std::vector<Place> places = placesOf( file, name );
		const auto found = std::find( names.begin(), names.end(), name );
		const std::uint32_t index = variableOf( problem.robot.get(), name );
		if ( found == names.end() && index != LW_INVALID_INDEX )
		{
			places.insert( places.begin(), { problem.reference[index], "the proof" } );
		}
		else if ( found != names.end() && file.points.front().time == 0 )
		{
			places.insert(
			    places.begin(), { first.points[static_cast<std::size_t>( found - names.begin() )], "its first point" } );
		}
		for ( std::size_t k = 1; k < places.size(); ++k )
		{
			if ( !( std::abs( places[k].value - places[0].value ) <= gap_tolerance ) )
			{
				out.push_back( fmt::format( "{}: joint {} is at {:.6g} in {} and at {:.6g} in {}", what, name,
				    places[0].value, places[0].of, places[k].value, places[k].of ) );
			}
		}
	}
	return out;
}

const TrajectoryAudit& Drive::add(
    const io::Problem& problem, const io::RobotModel& robot, const TrajectoryFile& file, const TrajectorySettings& settings )
{
	m_begin = m_whole.duration;
	m_notices.clear();
	const std::vector<Segment> approaches = approachesOf( problem, file, settings );
	m_segments = segmentsOf(
	    problem, file, settings.interpolation, approaches.empty() ? m_begin : m_begin + approaches.back().seconds );
	const std::vector<std::string> problems = differences( problem, robot, file, m_segments.front() );
	if ( !approaches.empty() )
	{
		m_segments.insert( m_segments.begin(), approaches.back() );
	}
	m_last = auditTrajectory( problem, robot, file.file, m_segments, settings, approaches );
	m_last.problems.insert( m_last.problems.end(), problems.begin(), problems.end() );
	append( m_whole, m_last );
	const std::vector<double> end = stateAt( m_segments, m_whole.duration );
	for ( std::size_t v = 0; v < problem.variable_names.size(); ++v )
	{
		m_ends[problem.variable_names[v]] = end[v];
	}
	return m_last;
}

std::string profileCsv(
    const io::Problem& problem, const std::vector<Segment>& segments, lw_check_flags flags, const std::string& file )
{
	const double begin = segments.front().begin, duration = segments.back().begin + segments.back().seconds - begin;
	const std::size_t steps = std::min( most_samples, static_cast<std::size_t>( std::ceil( duration / profile_step ) ) );
	const lw_checker* checker = problem.checker.get();
	const Query query = makeQuery( checker );
	std::string out;
	for ( std::size_t i = 0; i <= steps; ++i )
	{
		const double time = begin + ( steps == 0 ? 0 : duration * static_cast<double>( i ) / static_cast<double>( steps ) );
		const lw_state_result state =
		    measure( checker, query.get(), stateAt( segments, time ), flags, nullptr, file, "the trajectory" );
		const auto cell = [&]( lw_check_flags flag, const lw_clearance& clearance )
		{ return ( flags & flag ) != 0 ? fmt::format( "{}", nameSelf( checker, clearance ).least() ) : ""; };
		out += fmt::format(
		    "{},{},{}\n", time, cell( LW_CHECK_ENVIRONMENT, state.environment ), cell( LW_CHECK_SELF, state.self ) );
	}
	return out;
}

} // namespace leeway::motions
