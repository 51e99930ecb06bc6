// SPDX-License-Identifier: BSD-3-Clause
// A point that the joints move from the uppermost to the lowest keeps its distance from each axis until that joint turns: its path is at most the sum of
// distance times angle, with the distances at the state itself. So all states of a box are free whose paths are shorter than the clearances.
#include "leeway/certify/bubble.hpp"

#include "certify/window.hpp"
#include "leeway/near.h"

#include <algorithm>
#include <limits>
#include <tuple>

namespace leeway::certify
{
namespace
{

constexpr double interest = 0.2; ///< metres: larger clearances are taken as this
constexpr double alpha = 0.3;    ///< of a measurement: its lower bound is off by no more
constexpr double rounded = 1e-9; ///< metres, and relative: far above the rounding of sums and kinematics

/// A joint above a body, by its lever on the body's farthest point.
struct Lever
{
	std::uint32_t body, link;
	bool operator<( const Lever& other ) const { return std::tie( body, link ) < std::tie( other.body, other.link ); }
};

/// A demand of a body or of a pair of bodies: the sum of lever times deviation is at most its room.
struct Need
{
	std::vector<Lever> levers; ///< in order
	bool self;                 ///< the room of pairs of links
	std::uint32_t link;        ///< whose room to obstacles counts, too; `nothing`
};

} // namespace

struct Bubbles::State
{
	State( const io::Problem& of_problem, const io::RobotModel& robot, lw_check_flags of_flags )
	    : problem( of_problem ), flags( of_flags ),
	      model( modelOf( of_problem, robot, io::startState( of_problem ).data(), of_flags, of_problem.group ) ),
	      motion( model ), tubes{ std::vector<double>( model.variables.size(), 0 ), {} },
	      clearances( lw_robot_link_count( of_problem.robot.get() ), 0 )
	{
		for ( std::uint32_t i = 0; i < model.bodies.size() && ( flags & LW_CHECK_ENVIRONMENT ) != 0; ++i )
		{
			add( { joints( i, 0 ), false, lw_robot_body( of_problem.robot.get(), i ).link } );
		}
		for ( const Pair& pair : pairsOf( model ) )
		{
			if ( !pair.object )
			{
				std::vector<Lever> both = joints( pair.a, pair.ancestor ), other = joints( pair.b, pair.ancestor );
				both.insert( both.end(), other.begin(), other.end() );
				std::sort( both.begin(), both.end() );
				add( { std::move( both ), true, nothing } );
			}
		}
		rows.resize( needs.size() * model.variables.size() );
		rooms.resize( needs.size() );
		weights.resize( model.variables.size() );
	}
	std::vector<Lever> joints( std::uint32_t body, std::uint32_t ancestor ) const;
	void add( Need need );
	void measure( const Window& window );
	void grow( double most, double* out );

	const io::Problem& problem;
	const lw_check_flags flags;
	const Model model;
	const Motion motion;
	const Tubes tubes;
	std::vector<Need> needs;
	std::vector<double> clearances;  ///< of links, of the last state
	std::vector<double> rows, rooms; ///< [needs][variables] levers, [needs] room that is left
	std::vector<double> weights;     ///< [variables]
	std::vector<char> open, still;
};

/// Joints that move a body against a link above it.
std::vector<Lever> Bubbles::State::joints( std::uint32_t body, std::uint32_t ancestor ) const
{
	std::vector<Lever> out;
	for ( std::uint32_t at = model.bodies[body].owner; at > ancestor; at = model.links[at].parent )
	{
		if ( model.links[at].variable != nothing )
		{
			out.push_back( { body, at } );
		}
	}
	std::sort( out.begin(), out.end() );
	return out;
}

/// Pairs of links have one room: those that another one contains add nothing, and one that a body needs itself is joined to that.
void Bubbles::State::add( Need need )
{
	const auto contains = []( const Need& all, const Need& part )
	{ return std::includes( all.levers.begin(), all.levers.end(), part.levers.begin(), part.levers.end() ); };
	if ( need.levers.empty() )
	{
		return;
	}
	for ( Need& other : needs )
	{
		if ( need.self && other.self && contains( other, need ) )
		{
			return;
		}
		if ( need.self && contains( other, need ) && contains( need, other ) )
		{
			other.self = true;
			return;
		}
	}
	needs.erase( std::remove_if( needs.begin(), needs.end(),
	                 [&]( const Need& other )
	                 { return other.self && other.link == nothing && contains( need, other ) && need.self; } ),
	    needs.end() );
	needs.push_back( std::move( need ) );
}

void Bubbles::State::measure( const Window& window )
{
	const std::size_t n = model.variables.size();
	std::fill( rows.begin(), rows.end(), 0 );
	std::fill( weights.begin(), weights.end(), 0 );
	for ( std::size_t i = 0; i < needs.size(); ++i )
	{
		std::uint32_t body = nothing;
		Vec middle{};
		double radius = 0;
		for ( const Lever& lever : needs[i].levers )
		{
			const Link& link = model.links[lever.link];
			if ( lever.body != body )
			{
				body = lever.body;
				const Body& of = motion.body( body );
				middle = window.links[of.placed->owner].placed( of.pose.placed( of.shape->ranges[0].middle ) );
				radius = of.shape->ranges[0].radius;
			}
			const double reach =
			    link.type == Link::shift
			        ? 1
			        : length( cross( window.axes[lever.link], middle - window.links[lever.link].shift ) ) + radius;
			rows[i * n + link.variable] += std::fabs( link.multiplier ) * reach;
		}
		for ( std::size_t j = 0; j < n; ++j )
		{
			weights[j] = std::max( weights[j], rows[i * n + j] );
		}
	}
}

/// All open variables grow in proportion to their weights until a row is full.
void Bubbles::State::grow( double most, double* out )
{
	const std::size_t n = model.variables.size();
	open.assign( n, 0 );
	for ( std::size_t j = 0; j < n; ++j )
	{
		open[j] = weights[j] > 0; // without a lever it moves no body
		out[j] = open[j] != 0 ? 0 : most;
		weights[j] = open[j] != 0 ? 1 / weights[j] : 0;
	}
	const auto used = [&]( std::size_t row )
	{
		double sum = 0;
		for ( std::size_t j = 0; j < n; ++j )
		{
			sum += open[j] != 0 ? rows[row * n + j] * weights[j] : 0;
		}
		return sum;
	};
	for ( std::size_t round = 0; round < n && std::find( open.begin(), open.end(), 1 ) != open.end(); ++round )
	{
		double step = std::numeric_limits<double>::infinity();
		for ( std::size_t i = 0; i < needs.size(); ++i )
		{
			const double sum = used( i );
			step = sum > 0 ? std::min( step, rooms[i] / sum ) : step;
		}
		for ( std::size_t j = 0; j < n; ++j )
		{
			step = open[j] != 0 ? std::min( step, ( most - out[j] ) / weights[j] ) : step;
		}
		step = std::max( step, 0.0 );
		still = open;
		for ( std::size_t i = 0; i < needs.size(); ++i )
		{
			const double sum = used( i );
			rooms[i] -= step * sum;
			for ( std::size_t j = 0; j < n && sum > 0 && rooms[i] <= rounded * step * sum; ++j )
			{
				still[j] = still[j] != 0 && rows[i * n + j] == 0;
			}
		}
		for ( std::size_t j = 0; j < n; ++j )
		{
			out[j] += open[j] != 0 ? step * weights[j] : 0;
			open[j] = still[j] != 0 && out[j] < most * ( 1 - rounded );
		}
	}
	for ( std::size_t j = 0; j < n; ++j )
	{
		out[j] *= 1 - rounded;
	}
}

Bubbles::Bubbles( const io::Problem& problem, const io::RobotModel& robot, lw_check_flags flags )
    : m_state( std::make_unique<State>( problem, robot, flags ) )
{
}

Bubbles::~Bubbles() = default;

lw_status Bubbles::at( lw_query* query, const double* q, double min_d, double most, double* out )
{
	State& state = *m_state;
	const std::size_t n = state.model.variables.size();
	const lw_checker* checker = state.problem.checker.get();
	std::fill( out, out + n, 0 );
	double self_room = std::numeric_limits<double>::infinity();
	if ( ( state.flags & LW_CHECK_SELF ) != 0 )
	{
		const lw_range range = { min_d, min_d + interest, alpha };
		lw_state_result result;
		const lw_status status = lw_checker_state( checker, query, q, LW_CHECK_SELF, &range, true, &result );
		if ( status != LW_OK || result.verdict != LW_VERDICT_FREE )
		{
			return status;
		}
		self_room = result.self.lower - min_d - rounded;
	}
	if ( ( state.flags & LW_CHECK_ENVIRONMENT ) != 0 )
	{
		lw_near_def def = lw_near_def_default();
		def.flags = LW_CHECK_ENVIRONMENT;
		def.distance = min_d + interest;
		def.alpha = alpha;
		def.link_clearance = state.clearances.data();
		std::uint32_t count;
		if ( const lw_status status = lw_checker_near( checker, query, q, &def, nullptr, 0, &count ); status != LW_OK )
		{
			return status;
		}
	}
	std::vector<double> twice( q, q + n );
	twice.insert( twice.end(), q, q + n );
	const std::unique_ptr<Window> window = state.motion.whole( { 1, std::move( twice ), 0 }, state.tubes );
	state.measure( *window );
	for ( std::size_t i = 0; i < state.needs.size(); ++i )
	{
		const Need& need = state.needs[i];
		double room = need.self ? self_room : std::numeric_limits<double>::infinity();
		room = need.link != nothing ? std::min( room, state.clearances[need.link] - min_d - rounded ) : room;
		if ( !( room > 0 ) )
		{
			return LW_OK;
		}
		state.rooms[i] = room;
	}
	state.grow( most, out );
	return LW_OK;
}

} // namespace leeway::certify
