// SPDX-License-Identifier: BSD-3-Clause
// Problems of the native planner in the small worlds of tests/ompl, and paths measured densely by exact queries.
#pragma once

#include "planning.hpp"

#include "leeway/planners/planner.hpp"

namespace planners = leeway::planners;
using planners::Outcome;

inline planners::Stop soon( double seconds = patience )
{
	planners::Stop stop;
	stop.seconds = seconds;
	return stop;
}

inline const World& worldOf( const char* name )
{
	for ( const World& world : worlds() )
	{
		if ( std::string( world.name ) == name )
		{
			return world;
		}
	}
	throw std::runtime_error( name );
}

/// A planner, its checker and its query.
struct Problem
{
	leeway::Checker checker;
	leeway::Query query;
	planners::Planner planner;

	explicit Problem( leeway::Checker the_checker, const planners::Settings& settings = {} )
	    : checker( std::move( the_checker ) ), query( leeway::makeQuery( checker.get() ) ), planner( checker, settings )
	{
	}
	Problem( const World& world, const planners::Settings& settings ) : Problem( world.make(), settings )
	{
		planner.addStart( world.start.data() );
		planner.addGoal( world.goal.data() );
	}
	Outcome solve( const planners::Stop& stop = soon() ) { return planner.solve( query.get(), stop ); }
};

/// Every edge at states at most 5 mm or 5 mrad apart, by exact clearances: nothing of edges or of the planner's metric.
inline void audit( const leeway::Checker& checker, const planners::Path& path, double margin = 0 )
{
	const leeway::Query query = leeway::makeQuery( checker.get() );
	const lw_robot* robot = lw_checker_robot( checker.get() );
	std::vector<double> a( lw_robot_variable_count( robot ) ), b( a ), between( a ), q( path.dimension );
	for ( std::size_t i = 0; i + 1 < path.count(); ++i )
	{
		lw_checker_full_state( checker.get(), path[i], a.data() );
		lw_checker_full_state( checker.get(), path[i + 1], b.data() );
		double travel = 0;
		for ( std::size_t k = 0; k < a.size(); ++k )
		{
			travel = std::max( travel, std::fabs( b[k] - a[k] ) );
		}
		const int count = 1 + static_cast<int>( travel / 0.005 );
		for ( int k = 0; k <= count; ++k )
		{
			lw_robot_interpolate( robot, a.data(), b.data(), double( k ) / count, between.data() );
			for ( std::uint32_t v = 0; v < q.size(); ++v )
			{
				q[v] = between[lw_checker_variable( checker.get(), v )];
			}
			lw_state_result state;
			ASSERT_EQ(
			    lw_checker_state( checker.get(), query.get(), q.data(), LW_CHECK_BOTH, nullptr, false, &state ), LW_OK );
			ASSERT_GT( std::min( state.environment.lower, state.self.lower ), margin - 1e-9 )
			    << "edge " << i << " at " << k << "/" << count;
		}
	}
}

inline std::vector<double> stateOf( const planners::Path& path, std::size_t i )
{
	return std::vector<double>( path[i], path[i] + path.dimension );
}
