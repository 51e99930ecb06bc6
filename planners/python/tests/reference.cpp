// SPDX-License-Identifier: BSD-3-Clause
// The answers of the C functions for the tests of the Python package, as bytes, and the time of their loops.
//
//     python_reference states URDF SRDF SCENE GROUP STATES OUT [ROUNDS]
//     python_reference edges  URDF SRDF SCENE GROUP STATES OUT
//     python_reference plan   URDF SRDF SCENE GROUP STATES OUT
//
// STATES: doubles, rows of the group's variables. OUT: for each state lower, upper, pair (two doubles) and witnesses (six doubles) of the
// nearer clearance; for each edge between neighbours verdict, t, lower bound; for a plan from the first to the last state its path. SRDF
// and SCENE may be "". The last line printed is the least of ROUNDS times of the loop over states, in seconds.
#include "leeway/io/model.hpp"
#include "leeway/planners/planner.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace
{

using namespace leeway;

std::vector<double> readDoubles( const std::string& file )
{
	std::ifstream in( file, std::ios::binary );
	const std::vector<char> bytes( ( std::istreambuf_iterator<char>( in ) ), std::istreambuf_iterator<char>() );
	std::vector<double> values( bytes.size() / sizeof( double ) );
	std::copy( bytes.begin(), bytes.end(), reinterpret_cast<char*>( values.data() ) );
	return values;
}

/// Processor time of this thread: other programs do not lengthen it.
double threadSeconds()
{
	timespec time{};
	clock_gettime( CLOCK_THREAD_CPUTIME_ID, &time );
	return static_cast<double>( time.tv_sec ) + 1e-9 * static_cast<double>( time.tv_nsec );
}

/// The loop of a program in C: one query, one call for each state.
void checkStates( const lw_checker* checker, lw_query* query, const std::vector<double>& q,
    std::vector<lw_state_result>& out, std::size_t reset_every )
{
	const std::size_t width = lw_checker_variable_count( checker );
	for ( std::size_t i = 0; i < out.size(); ++i )
	{
		if ( reset_every > 0 && i % reset_every == 0 )
		{
			lw_query_reset( query );
		}
		require( lw_checker_state( checker, query, q.data() + i * width, LW_CHECK_BOTH, nullptr, false, &out[i] ), "state" );
	}
}

double number( std::uint32_t index, std::uint32_t first )
{
	return index == LW_INVALID_INDEX ? -1 : double( index ) + first;
}

std::vector<double> states( const io::Problem& problem, const std::vector<double>& q, int rounds, double& seconds )
{
	const lw_checker* checker = problem.checker.get();
	const Query query = makeQuery( checker );
	std::vector<lw_state_result> results( q.size() / problem.variables.size() );
	checkStates( checker, query.get(), q, results, 256 ); // as the package's blocks
	std::vector<double> out;
	const std::uint32_t links = lw_robot_link_count( lw_checker_robot( checker ) );
	for ( const lw_state_result& r : results )
	{
		const bool self = r.self.upper < r.environment.upper ||
		                  ( r.self.upper == r.environment.upper && r.self.lower < r.environment.lower );
		const lw_clearance& c = self ? r.self : r.environment;
		out.insert( out.end(),
		    { std::min( r.self.lower, r.environment.lower ), c.upper, number( c.a, 0 ), number( c.b, self ? 0 : links ),
		        c.point_a.x, c.point_a.y, c.point_a.z, c.point_b.x, c.point_b.y, c.point_b.z } );
	}
	for ( int round = 0; round < rounds; ++round )
	{
		const double begin = threadSeconds();
		checkStates( checker, query.get(), q, results, 0 );
		seconds = std::min( seconds, threadSeconds() - begin );
	}
	return out;
}

std::vector<double> edges( const io::Problem& problem, const std::vector<double>& q )
{
	const Query query = makeQuery( problem.checker.get() );
	const lw_edge_def def = lw_edge_def_default();
	const std::size_t width = problem.variables.size();
	std::vector<double> out;
	for ( std::size_t i = 0; i + 1 < q.size() / width; ++i )
	{
		if ( i % 16 == 0 ) // as the package's blocks
		{
			lw_query_reset( query.get() );
		}
		lw_edge_result r;
		require(
		    lw_checker_edge( problem.checker.get(), query.get(), &q[i * width], &q[( i + 1 ) * width], &def, &r ), "edge" );
		out.insert( out.end(), { double( r.verdict ), r.t, r.lower_bound } );
	}
	return out;
}

std::vector<double> plan( const io::Problem& problem, const std::vector<double>& q )
{
	lw_plan_def def = lw_plan_def_default();
	def.checker = problem.checker.get();
	def.starts = q.data();
	def.start_count = 1;
	def.goals = q.data() + q.size() - problem.variables.size();
	def.goal_count = 1;
	lw_diag diag{};
	lw_plan_result result{};
	require( lw_plan( &def, &diag, &result ), diag );
	std::vector<double> out( result.states, result.states + std::size_t( result.state_count ) * result.variable_count );
	lw_plan_result_clear( &result );
	return out;
}

} // namespace

int main( int argc, char** argv )
try
{
	if ( argc < 8 )
	{
		std::fprintf( stderr, "usage: python_reference states|edges|plan URDF SRDF SCENE GROUP STATES OUT [ROUNDS]\n" );
		return 2;
	}
	const std::string question = argv[1];
	const io::RobotModel robot = io::loadRobot( argv[2], argv[3] );
	io::SceneModel scene;
	io::ProblemOptions options;
	options.group = argv[5];
	if ( *argv[4] != '\0' )
	{
		scene = io::loadScene( argv[4] );
		options.scene = &scene;
	}
	const io::Problem problem = io::buildProblem( robot, options );
	const std::vector<double> q = readDoubles( argv[6] );
	double seconds = 1e300;
	const std::vector<double> out = question == "states" ? states( problem, q, argc > 8 ? std::atoi( argv[8] ) : 1, seconds )
	                                : question == "edges" ? edges( problem, q )
	                                                      : plan( problem, q );
	std::ofstream( argv[7], std::ios::binary )
	    .write( reinterpret_cast<const char*>( out.data() ), static_cast<std::streamsize>( out.size() * sizeof( double ) ) );
	std::printf( "%.9f\n", seconds );
	return 0;
}
catch ( const std::exception& error )
{
	std::fprintf( stderr, "%s\n", error.what() );
	return 1;
}
