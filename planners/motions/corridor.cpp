// SPDX-License-Identifier: BSD-3-Clause
#include "leeway/motions/corridor.hpp"

#include "leeway/handles.hpp"
#include "motions/json.hpp"
#include "motions/seconds.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace leeway::motions
{
namespace
{

constexpr double least = 1e-6;    // radians and metres: the first uniform deviation that is tried
constexpr double accuracy = 1.02; // of the uniform one
constexpr double widenings[] = { 1.5, 1.1, 1.02 };

/// Proves the motion for a tolerance, beginning with the segment that failed last.
class Prover
{
public:
	Prover( const io::Problem& problem, const std::vector<Segment>& segments, const CorridorSettings& settings )
	    : m_problem( problem ), m_segments( segments ), m_settings( settings ), m_query( makeQuery( problem.checker.get() ) )
	{
	}
	bool holds( const std::vector<double>& tolerance )
	{
		++proofs;
		lw_edge_def def = m_settings.edge;
		def.tolerance = tolerance.data();
		for ( std::size_t k = 0; k < m_segments.size(); ++k )
		{
			const std::size_t i = ( m_first + k ) % m_segments.size();
			lw_edge_result result;
			require( lw_checker_curve( m_problem.checker.get(), m_query.get(), m_segments[i].points.data(),
			             m_segments[i].degree, &def, &result ),
			    "proof of a segment" );
			if ( result.verdict != LW_VERDICT_FREE )
			{
				m_first = i;
				return false;
			}
		}
		return true;
	}
	std::size_t proofs = 0;

private:
	const io::Problem& m_problem;
	const std::vector<Segment>& m_segments;
	const CorridorSettings& m_settings;
	Query m_query;
	std::size_t m_first = 0;
};

/// 1 for each variable that may deviate, 0 for quaternions.
std::vector<double> freedoms( const io::Problem& problem )
{
	std::vector<double> out;
	for ( const std::uint32_t variable : problem.variables )
	{
		const lw_variable_info info = lw_robot_variable( problem.robot.get(), variable );
		const bool floating = lw_robot_joint_type( problem.robot.get(), info.joint ) == LW_JOINT_FLOATING;
		out.push_back( floating && info.component >= 3 ? 0 : 1 );
	}
	return out;
}

std::vector<double> scaled( double by, std::vector<double> values )
{
	std::transform( values.begin(), values.end(), values.begin(), [by]( double value ) { return by * value; } );
	return values;
}

} // namespace

Corridor widestCorridor( const io::Problem& problem, const std::vector<Segment>& segments, const CorridorSettings& settings )
{
	const auto begin = std::chrono::steady_clock::now();
	const std::vector<double> freedom = freedoms( problem );
	Prover prover( problem, segments, settings );
	const auto in_time = [&] { return secondsSince( begin ) < settings.seconds; };
	double low = std::min( least, settings.most ), high = settings.most;
	Corridor corridor;
	corridor.tolerance = scaled( 0, freedom );
	if ( prover.holds( scaled( low, freedom ) ) )
	{
		low = prover.holds( scaled( high, freedom ) ) ? high : low;
		while ( high > accuracy * low && in_time() )
		{
			const double middle = std::sqrt( low * high );
			( prover.holds( scaled( middle, freedom ) ) ? low : high ) = middle;
		}
		corridor.tolerance = scaled( low, freedom );
	}
	for ( const double by : widenings )
	{
		std::vector<bool> open( freedom.size(), true );
		while ( std::find( open.begin(), open.end(), true ) != open.end() )
		{
			for ( std::size_t v = 0; v < freedom.size(); ++v )
			{
				std::vector<double> wider = corridor.tolerance;
				wider[v] = std::min( settings.most, by * wider[v] );
				open[v] = open[v] && wider[v] > corridor.tolerance[v] && in_time() && prover.holds( wider );
				corridor.tolerance = open[v] ? wider : corridor.tolerance;
			}
		}
	}
	corridor.proofs = prover.proofs;
	corridor.seconds = secondsSince( begin );
	return corridor;
}

std::string goalWithCorridor(
    const io::Problem& problem, const TrajectoryFile& trajectory, const std::vector<double>& corridor )
{
	Json points = Json::array();
	for ( const TrajectoryPoint& point : trajectory.points )
	{
		Json one = { { "positions", point.positions } };
		if ( !point.velocities.empty() )
		{
			one["velocities"] = point.velocities;
		}
		if ( !point.accelerations.empty() )
		{
			one["accelerations"] = point.accelerations;
		}
		one["time_from_start"] = timeFromStart( point.time );
		points.push_back( one );
	}
	Json tolerances = Json::array();
	for ( std::size_t v = 0; v < corridor.size(); ++v )
	{
		if ( corridor[v] > 0 ) // 0 means no tolerance is asked for, which would be the controller's own
		{
			tolerances.push_back( { { "name", problem.variable_names[v] }, { "position", corridor[v] } } );
		}
	}
	Json out;
	out["trajectory"] = { { "joint_names", trajectory.joint_names }, { "points", points } };
	out["path_tolerance"] = tolerances;
	return jsonText( out );
}

} // namespace leeway::motions
