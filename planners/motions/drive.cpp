// SPDX-License-Identifier: BSD-3-Clause
// Trajectories one after the other, and the clearances over their time: see trajectory.hpp.
#include "leeway/motions/trajectory.hpp"

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

/// Adds the audit of a trajectory that is driven after those before.
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

/// A jump from where the last motion of a joint ended.
void addGaps( const std::vector<std::string>& names, const Values& ends, const std::vector<Segment>& segments, const TrajectoryFile& file,
    TrajectoryAudit& audit )
{
	for ( std::size_t v = 0; v < names.size(); ++v )
	{
		const auto end = ends.find( names[v] );
		const double gap = end == ends.end() ? 0 : std::abs( end->second - segments.front().points[v] );
		if ( gap > gap_tolerance )
		{
			audit.problems.push_back( fmt::format( "{} starts {:.6g} away from the end of the one before (joint {})",
			    file.element.empty() ? file.file : file.element, gap, names[v] ) );
		}
	}
}

/// A controller jumps from where the robot stands to a first point at time 0.
void compareStart( const std::vector<std::string>& names, const std::vector<Segment>& segments, const TrajectoryFile& file,
    TrajectoryAudit& audit )
{
	for ( const auto& [name, value] : file.start_state )
	{
		const auto found = std::find( names.begin(), names.end(), name );
		const double first =
		    found == names.end() ? value : segments.front().points[static_cast<std::size_t>( found - names.begin() )];
		if ( file.points.front().time == 0 && !( std::abs( first - value ) <= gap_tolerance ) )
		{
			audit.problems.push_back( fmt::format( "{} begins with joint {} at {:.6g}, and its start state has {:.6g}",
			    file.element.empty() ? file.file : file.element, name, first, value ) );
		}
	}
}

} // namespace

const TrajectoryAudit& Drive::add(
    const io::Problem& problem, const io::RobotModel& robot, const TrajectoryFile& file, const TrajectorySettings& settings )
{
	const std::vector<std::string>& names = problem.variable_names;
	m_begin = m_whole.duration;
	m_segments = segmentsOf( problem, file, settings.interpolation, m_begin );
	m_last = auditTrajectory( problem, robot, file.file, m_segments, settings );
	addGaps( names, m_ends, m_segments, file, m_last );
	compareStart( names, m_segments, file, m_last );
	append( m_whole, m_last );
	const std::vector<double> end = stateAt( m_segments, m_whole.duration );
	for ( std::size_t v = 0; v < names.size(); ++v )
	{
		m_ends[names[v]] = end[v];
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
