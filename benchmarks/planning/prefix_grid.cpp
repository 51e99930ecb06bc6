// SPDX-License-Identifier: BSD-3-Clause
// Grids of the first joints of an arm: see prefix_grid.hpp.
#include "planning/prefix_grid.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <deque>
#include <map>
#include <set>

namespace io = leeway::io;

namespace
{

constexpr double MOST_STATES[] = { 0, 0, 2e6, 3e7 }; // by the number of joints

std::string jointName( const EdgeWorld& world, std::size_t variable )
{
	return lw_robot_joint_name( world.robot.get(), world.info( variable ).joint );
}

/// Joints of the tree between a link and the root, the lowest first.
std::vector<std::string> chainOf( const io::RobotModel& model, std::string link )
{
	std::vector<std::string> chain;
	for ( bool found = true; found; )
	{
		const auto joint = std::find_if(
		    model.joints.begin(), model.joints.end(), [&]( const io::JointModel& j ) { return j.child == link; } );
		found = joint != model.joints.end();
		if ( found )
		{
			chain.push_back( joint->name );
			link = joint->parent;
		}
	}
	return chain;
}

/// Variables of the group in runs that begin at a joint with no joint of the group above it.
std::vector<std::vector<std::size_t>> armsOf( const io::RobotModel& model, const EdgeWorld& world )
{
	std::vector<std::vector<std::size_t>> arms;
	std::set<std::string> group;
	for ( std::size_t i = 0; i < world.size(); ++i )
	{
		const std::string name = jointName( world, i );
		const auto joint = std::find_if(
		    model.joints.begin(), model.joints.end(), [&]( const io::JointModel& j ) { return j.name == name; } );
		const std::vector<std::string> above = chainOf( model, joint->parent );
		const bool is_root =
		    std::none_of( above.begin(), above.end(), [&]( const std::string& j ) { return group.count( j ) > 0; } );
		if ( is_root )
		{
			arms.emplace_back();
		}
		arms.back().push_back( i );
		group.insert( name );
	}
	return arms;
}

/// The robot without the links that joints of the group other than these move.
void keepOnly( io::RobotModel& model, const EdgeWorld& world, const std::vector<std::size_t>& kept )
{
	std::set<std::string> dropped;
	for ( std::size_t i = 0; i < world.size(); ++i )
	{
		if ( std::find( kept.begin(), kept.end(), i ) == kept.end() )
		{
			dropped.insert( jointName( world, i ) );
		}
	}
	for ( io::LinkModel& link : model.links )
	{
		const std::vector<std::string> chain = chainOf( model, link.name );
		if ( std::any_of( chain.begin(), chain.end(), [&]( const std::string& j ) { return dropped.count( j ) > 0; } ) )
		{
			link.collision.clear();
		}
	}
	io::Group group;
	group.name = "grid";
	for ( const std::size_t i : kept )
	{
		group.joints.push_back( jointName( world, i ) );
	}
	model.groups.push_back( group );
}

/// States of a few joints, free or not, asked once each.
class Grid
{
public:
	Grid( const io::Problem& problem, double most_states )
	    : m_problem( problem ), m_query( leeway::makeQuery( problem.checker.get() ) )
	{
		double volume = 1;
		for ( const std::uint32_t variable : problem.variables )
		{
			const lw_variable_info info = lw_robot_variable( problem.robot.get(), variable );
			Axis axis = { info.wraps ? -M_PI : info.lower, info.wraps ? M_PI : info.upper, 1, info.wraps, 1 };
			volume *= axis.high - axis.low;
			m_axes.push_back( axis );
		}
		m_step = std::pow( volume / most_states, 1.0 / static_cast<double>( m_axes.size() ) );
		for ( std::size_t i = m_axes.size(); i-- > 0; )
		{
			m_axes[i].count = std::max<long>( 1, std::lround( ( m_axes[i].high - m_axes[i].low ) / m_step ) );
			m_axes[i].stride = m_size;
			m_size *= static_cast<std::size_t>( m_axes[i].count );
		}
	}

	double step() const { return m_step; }

	/// Do steps to neighbours, diagonal ones too, lead from one state to the other?
	bool joins( const std::vector<double>& start, const std::vector<double>& goal )
	{
		const std::vector<std::size_t> goals = around( cellOf( goal ) );
		std::vector<bool> seen( m_size );
		std::deque<std::size_t> open;
		const auto visit = [&]( std::size_t cell )
		{
			if ( !seen[cell] )
			{
				seen[cell] = true;
				if ( isFree( cell ) )
				{
					open.push_back( cell );
				}
			}
		};
		for ( const std::size_t cell : around( cellOf( start ) ) )
		{
			visit( cell );
		}
		while ( !open.empty() )
		{
			const std::size_t cell = open.front();
			open.pop_front();
			if ( std::find( goals.begin(), goals.end(), cell ) != goals.end() )
			{
				return true;
			}
			for ( const std::size_t next : around( cell ) )
			{
				visit( next );
			}
		}
		return false;
	}

private:
	struct Axis
	{
		double low, high;
		long count;
		bool wraps;
		std::size_t stride;
	};

	/// Cells are numbered with the last variable fastest.
	std::size_t cellOf( const std::vector<double>& q ) const
	{
		std::size_t cell = 0;
		for ( std::size_t i = 0; i < q.size(); ++i )
		{
			const Axis& a = m_axes[i];
			const double value = a.wraps ? std::remainder( q[i], 2 * M_PI ) : q[i];
			const double at = ( value - a.low ) / ( a.high - a.low ) * static_cast<double>( a.count );
			cell = cell * static_cast<std::size_t>( a.count ) +
			       static_cast<std::size_t>( std::min( a.count - 1, std::max<long>( 0, static_cast<long>( at ) ) ) );
		}
		return cell;
	}

	/// The place of a cell along one variable.
	long placeOf( std::size_t cell, std::size_t i ) const
	{
		return static_cast<long>( cell / m_axes[i].stride ) % m_axes[i].count;
	}

	/// The cell itself and its neighbours.
	std::vector<std::size_t> around( std::size_t cell ) const
	{
		std::vector<std::size_t> cells = { cell };
		for ( std::size_t i = 0; i < m_axes.size(); ++i )
		{
			const Axis& a = m_axes[i];
			const long place = placeOf( cell, i );
			for ( std::size_t k = cells.size(); k-- > 0; )
			{
				for ( const long move : { -1, 1 } )
				{
					const long next = a.wraps ? ( place + move + a.count ) % a.count : place + move;
					if ( next >= 0 && next < a.count )
					{
						cells.push_back( cells[k] + static_cast<std::size_t>( next - place ) * a.stride );
					}
				}
			}
		}
		return cells;
	}

	bool isFree( std::size_t cell )
	{
		std::vector<double> q;
		for ( std::size_t i = 0; i < m_axes.size(); ++i )
		{
			const Axis& a = m_axes[i];
			q.push_back( a.low + ( a.high - a.low ) * ( static_cast<double>( placeOf( cell, i ) ) + 0.5 ) /
			                         static_cast<double>( a.count ) );
		}
		bool free = false;
		lw_state_reason reason;
		leeway::require(
		    lw_checker_is_free( m_problem.checker.get(), m_query.get(), q.data(), LW_CHECK_BOTH, 0, &free, &reason ),
		    "a state of the grid" );
		return reason.verdict != LW_VERDICT_BLOCKED;
	}

	const io::Problem& m_problem;
	leeway::Query m_query;
	std::vector<Axis> m_axes;
	std::size_t m_size = 1;
	double m_step = 0;
};

std::string disconnected(
    const EdgeWorldEntry& entry, io::RobotModel model, const std::vector<std::size_t>& kept, double share )
{
	keepOnly( model, entry.world, kept );
	const io::SceneModel scene = io::loadScene( entry.source.at( "scene" ).get<std::string>() );
	io::ProblemOptions options;
	options.group = "grid";
	options.scene = &scene;
	const io::Problem problem = io::buildProblem( model, options );
	// the variables of a group may stand in another order
	std::vector<double> start, goal;
	std::string names;
	for ( const std::uint32_t variable : problem.variables )
	{
		const auto found = std::find( entry.world.variables.begin(), entry.world.variables.end(), variable );
		const auto i = static_cast<std::size_t>( found - entry.world.variables.begin() );
		start.push_back( entry.start[i] );
		goal.push_back( entry.goal[i] );
		names += jointName( entry.world, i ) + ", ";
	}
	Grid grid( problem, share * MOST_STATES[kept.size()] );
	if ( grid.joins( start, goal ) )
	{
		return "";
	}
	char step[64];
	std::snprintf( step, sizeof step, "%.1f degrees", grid.step() * 180 / M_PI );
	return "disconnected on a grid: " + names + step;
}

} // namespace

std::string disconnectedPrefix( const EdgeWorldEntry& entry, double share )
{
	const io::RobotModel model =
	    io::loadRobot( entry.source.at( "robot" ).get<std::string>(), entry.source.at( "srdf" ).get<std::string>() );
	for ( const std::size_t count : { std::size_t{ 2 }, std::size_t{ 3 } } )
	{
		for ( std::vector<std::size_t> arm : armsOf( model, entry.world ) )
		{
			arm.resize( std::min( count, arm.size() ) );
			const std::string found = arm.size() == count ? disconnected( entry, model, arm, share ) : "";
			if ( !found.empty() )
			{
				return found;
			}
		}
	}
	return "";
}
