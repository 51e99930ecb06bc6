// SPDX-License-Identifier: BSD-3-Clause
#include "view/apart.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

namespace leeway::view
{
namespace
{

constexpr double relative_change = 0.01, absolute_change = 1e-4; // metres

struct Candidate
{
	ApartPair range;
	std::size_t count = 0; // of states at which it is the nearest
	bool moves = true;
};

bool keeps( const ApartPair& range )
{
	return range.most - range.least <= std::max( absolute_change, relative_change * range.least );
}

void widen( ApartPair& range, double clearance )
{
	range.least = std::min( range.least, clearance );
	range.most = std::max( range.most, clearance );
}

/// Number of the group's joints above a link.
std::size_t movingJoints( const io::Problem& problem, std::uint32_t link )
{
	const lw_robot* robot = problem.robot.get();
	std::size_t count = 0;
	std::uint32_t joint = lw_robot_link_joint( robot, link );
	while ( joint != LW_INVALID_INDEX )
	{
		const std::uint32_t driver = lw_robot_joint_mimic( robot, joint );
		const std::uint32_t variable = lw_robot_joint_variable( robot, driver != LW_INVALID_INDEX ? driver : joint );
		const auto& group = problem.variables;
		count += variable != LW_INVALID_INDEX && std::find( group.begin(), group.end(), variable ) != group.end() ? 1 : 0;
		joint = lw_robot_link_joint( robot, lw_robot_joint_parent( robot, joint ) );
	}
	return count;
}

/// Pairs of one kind that are the nearest at some state and seem to keep their distance there.
std::vector<Candidate> candidates(
    const io::Problem& problem, const std::vector<SeenState>& states, double min_d, bool self )
{
	std::map<std::pair<std::uint32_t, std::uint32_t>, Candidate> found;
	for ( const SeenState& state : states )
	{
		const lw_clearance& c = self ? state.result->self : state.result->environment;
		if ( std::isfinite( c.upper ) && c.a != LW_INVALID_INDEX && c.b != LW_INVALID_INDEX )
		{
			Candidate& candidate =
			    found.emplace( std::pair( c.a, c.b ), Candidate{ { { self, c.a, c.b }, c.upper, c.upper } } ).first->second;
			widen( candidate.range, c.upper );
			++candidate.count;
		}
	}
	std::vector<Candidate> chosen;
	for ( auto& [names, candidate] : found )
	{
		const std::size_t joints = self ? 1 : movingJoints( problem, names.first );
		candidate.moves = joints > 0;
		if ( joints <= 1 && keeps( candidate.range ) && candidate.range.least > std::max( 0.0, min_d ) )
		{
			chosen.push_back( candidate );
		}
	}
	return chosen;
}

/// Where another pair is the nearest a candidate may be anywhere: measures the candidates at all states.
void measureEverywhere(
    const io::Problem& problem, const std::vector<SeenState>& states, const std::string& file, std::vector<Candidate>& all )
{
	std::vector<lwv_pair> pairs;
	double distance = 0;
	for ( const Candidate& candidate : all )
	{
		pairs.push_back( candidate.range.pair );
		distance = std::max( distance, ( 1 + 2 * relative_change ) * candidate.range.most + 2 * absolute_change );
	}
	const Others meter( problem.checker.get(), pairs, file );
	for ( const SeenState& state : states )
	{
		const std::vector<double> measured = meter.ofPairs( *state.q, distance );
		for ( std::size_t i = 0; i < all.size(); ++i )
		{
			if ( all[i].moves ) // the other links and obstacles stand still
			{
				widen( all[i].range, measured[i] );
			}
		}
	}
}

} // namespace

Others::Others( const lw_checker* checker, const std::vector<lwv_pair>& pairs, const std::string& file )
    : m_apart( lwv_apart_create( checker, pairs.data(), static_cast<std::uint32_t>( pairs.size() ) ), lwv_apart_destroy ),
      m_count( pairs.size() ), m_file( file )
{
	if ( !m_apart )
	{
		throw io::Error( file, "clearances of the page", "memory is too small", "close other programs" );
	}
}

lw_state_result Others::measured( const std::vector<double>& q, lw_check_flags flags ) const
{
	lw_state_result result;
	if ( const lw_status status = lwv_apart_state( m_apart.get(), q.data(), flags, &result ); status != LW_OK )
	{
		throw io::Error( m_file, "a state of the motion",
		    std::string( "the state cannot be used (" ) + lw_status_name( status ) + ")", "give finite joint values" );
	}
	return result;
}

std::vector<double> Others::ofPairs( const std::vector<double>& q, double distance ) const
{
	std::vector<double> out( m_count );
	if ( const lw_status status = lwv_apart_pairs( m_apart.get(), q.data(), distance, out.data() ); status != LW_OK )
	{
		throw io::Error( m_file, "a state of the motion",
		    std::string( "the state cannot be used (" ) + lw_status_name( status ) + ")", "give finite joint values" );
	}
	return out;
}

std::vector<ApartPair> keepingDistance(
    const io::Problem& problem, const std::vector<SeenState>& states, double min_d, const std::string& file )
{
	std::vector<ApartPair> apart;
	for ( const bool self : { false, true } )
	{
		std::vector<Candidate> all = candidates( problem, states, min_d, self );
		if ( !all.empty() )
		{
			measureEverywhere( problem, states, file, all );
		}
		all.erase( std::remove_if( all.begin(), all.end(),
		               [&]( const Candidate& c ) { return !keeps( c.range ) || c.range.least <= std::max( 0.0, min_d ); } ),
		    all.end() );
		std::size_t places = 0;
		for ( const Candidate& candidate : all )
		{
			places += candidate.count;
		}
		for ( std::size_t i = 0; i < all.size() && 2 * places > states.size(); ++i )
		{
			apart.push_back( all[i].range );
		}
	}
	return apart;
}

} // namespace leeway::view
