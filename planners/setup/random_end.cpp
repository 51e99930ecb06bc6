// SPDX-License-Identifier: BSD-3-Clause
// A free state of a robot at random, for first tries: --start random, --goal random.
#include "setup/random_end.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace leeway::cli
{
namespace
{

/// A humanoid has one free state in thousands; a state takes ten to a hundred microseconds.
constexpr std::size_t most_tries = 100'000;
constexpr double pi = 3.14159265358979323846;

io::Problem problemOf( const Input& input, const std::string& group )
{
	io::ProblemOptions options;
	options.group = group;
	options.scene = input.scene ? &*input.scene : nullptr;
	options.request = input.request ? &*input.request : nullptr;
	options.margins = input.margins;
	options.padding = input.padding;
	options.allowed = input.allowed;
	options.min_d = input.min_d;
	options.notice_enclosed = false;
	return io::buildProblem( input.robot, options );
}

void draw( const io::Problem& problem, std::mt19937_64& random, std::vector<double>& q )
{
	for ( std::size_t i = 0; i < q.size(); ++i )
	{
		const lw_variable_info info = lw_robot_variable( problem.robot.get(), problem.variables[i] );
		const bool bounded = std::isfinite( info.lower ) && std::isfinite( info.upper ) && !info.wraps;
		const double lower = bounded ? info.lower : info.wraps ? -pi : -1, upper = bounded ? info.upper : info.wraps ? pi : 1;
		const double share = static_cast<double>( random() >> 11 ) * 0x1p-53;
		q[i] = lower + ( upper - lower ) * share;
		if ( lw_robot_joint_type( problem.robot.get(), info.joint ) == LW_JOINT_FLOATING && info.component == 6 )
		{
			const double length = std::hypot( std::hypot( q[i - 3], q[i - 2] ), std::hypot( q[i - 1], q[i] ) );
			std::for_each( &q[i - 3], &q[i] + 1, [=]( double& part ) { part = length > 0 ? part / length : 0.5; } );
		}
	}
}

} // namespace

Values randomFreeState( const std::string& option, const Input& input, const std::string& group, std::uint64_t seed )
{
	const Progress progress( "looking for a free state" );
	const io::Problem problem = problemOf( input, group );
	const Query query = makeQuery( problem.checker.get() );
	std::mt19937_64 random( seed );
	std::vector<double> q( problem.variables.size() );
	for ( std::size_t tries = 0; tries < most_tries; ++tries )
	{
		draw( problem, random, q );
		bool free = false;
		const lw_status status = lw_checker_is_free( problem.checker.get(), query.get(), q.data(), LW_CHECK_BOTH, input.min_d, &free );
		if ( status == LW_OK && free )
		{
			Values values;
			for ( std::size_t i = 0; i < q.size(); ++i )
			{
				values[problem.variable_names[i]] = q[i];
			}
			return values;
		}
	}
	throw io::Error( "command line", option, fmt::format( "none of {} random states is free", most_tries ),
	    "`leeway pairs` shows which pairs of links are always in contact; or write joint=value,joint=value" );
}

} // namespace leeway::cli
