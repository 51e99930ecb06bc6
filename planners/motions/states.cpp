// SPDX-License-Identifier: BSD-3-Clause
// Group states, full states, limits and named clearances: see states.hpp.
#include "leeway/motions/states.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numeric>

namespace leeway::motions
{

std::vector<double> groupState( const io::Problem& problem, const std::vector<double>& full )
{
	std::vector<double> q;
	for ( const std::uint32_t i : problem.variables )
	{
		q.push_back( full[i] );
	}
	return q;
}

std::vector<double> fullState( const io::Problem& problem, const std::vector<double>& q )
{
	std::vector<double> full = problem.reference;
	for ( std::size_t i = 0; i < q.size(); ++i )
	{
		full[problem.variables[i]] = q[i];
	}
	return full;
}

std::uint32_t variableOf( const lw_robot* robot, const std::string& name )
{
	for ( std::uint32_t i = 0; i < lw_robot_variable_count( robot ); ++i )
	{
		if ( io::variableName( robot, i ) == name )
		{
			return i;
		}
	}
	return LW_INVALID_INDEX;
}

namespace
{

/// " (90 degrees are 1.5708: were degrees meant? ...)" of an angle that is beyond its limits by more than a radian, and within them as degrees.
std::string asDegrees( const lw_robot* robot, const lw_variable_info& info, double value )
{
	const double angle = value * ( M_PI / 180 );
	const bool far = value < info.lower - 1 || value > info.upper + 1;
	const bool turns = lw_robot_joint_type( robot, info.joint ) == LW_JOINT_REVOLUTE;
	return turns && far && angle >= info.lower && angle <= info.upper
	           ? fmt::format( " ({:g} degrees are {:.4f}: were degrees meant? Values are radians)", value, angle )
	           : "";
}

void addViolation(
    const lw_robot* robot, std::uint32_t variable, double value, double tolerance, std::vector<std::string>& lines )
{
	const lw_variable_info info = lw_robot_variable( robot, variable );
	if ( !info.wraps && !( value >= info.lower - tolerance && value <= info.upper + tolerance ) )
	{
		const bool below = value < info.lower;
		lines.push_back( fmt::format( "joint {}: {} is {} its limit {}{}", io::variableName( robot, variable ), value,
		    below ? "below" : "above", below ? info.lower : info.upper, asDegrees( robot, info, value ) ) );
	}
}

} // namespace

std::vector<std::string> limitViolations( const lw_robot* robot, const std::vector<double>& full, double tolerance )
{
	std::vector<std::string> lines;
	for ( std::uint32_t i = 0; i < full.size(); ++i )
	{
		addViolation( robot, i, full[i], tolerance, lines );
	}
	return lines;
}

std::vector<std::string> groupLimitViolations( const io::Problem& problem, const std::vector<double>& q, double tolerance )
{
	std::vector<std::string> lines;
	for ( std::size_t i = 0; i < q.size(); ++i )
	{
		addViolation( problem.robot.get(), problem.variables[i], q[i], tolerance, lines );
	}
	return lines;
}

double shorterWay( const lw_robot* robot, std::uint32_t variable, double a, double b )
{
	return lw_robot_variable( robot, variable ).wraps ? std::remainder( b - a, 2 * M_PI ) : b - a;
}

namespace
{

/// Whether the four numbers from this variable of the group on are the rotation of a floating joint.
bool beginsQuaternion( const io::Problem& problem, std::size_t i )
{
	const std::vector<std::uint32_t>& variables = problem.variables;
	const lw_variable_info info = lw_robot_variable( problem.robot.get(), variables[i] );
	return lw_robot_joint_type( problem.robot.get(), info.joint ) == LW_JOINT_FLOATING && info.component == 3 &&
	       i + 3 < variables.size() && variables[i + 3] == variables[i] + 3;
}

} // namespace

double jointDistance( const io::Problem& problem, const std::vector<double>& a, const std::vector<double>& b )
{
	double sum = 0, sign = 1;
	std::size_t turned = 0; // before it b's numbers are those of a quaternion
	for ( std::size_t i = 0; i < a.size(); ++i )
	{
		if ( beginsQuaternion( problem, i ) ) // and its negative is the same rotation
		{
			turned = i + 4;
			sign = std::inner_product( &a[i], &a[i] + 4, &b[i], 0.0 ) < 0 ? -1 : 1;
		}
		const double to = i < turned ? sign * b[i] : b[i];
		const double difference = shorterWay( problem.robot.get(), problem.variables[i], a[i], to );
		sum += difference * difference;
	}
	return std::sqrt( sum );
}

std::vector<std::vector<double>> unwrapped( const io::Problem& problem, std::vector<std::vector<double>> points )
{
	for ( std::size_t v = 0; v < problem.variables.size(); ++v )
	{
		for ( std::size_t i = 1; i < points.size(); ++i )
		{
			const double from = points[i - 1][v];
			const double shorter = shorterWay( problem.robot.get(), problem.variables[v], from, points[i][v] );
			points[i][v] = shorter == points[i][v] - from ? points[i][v] : from + shorter;
		}
	}
	return points;
}

namespace
{

Named named( const lw_clearance& clearance, bool asked )
{
	Named result;
	result.asked = asked;
	result.lower = clearance.lower;
	result.upper = clearance.upper;
	result.has_points = std::isfinite( clearance.upper );
	result.point_a = clearance.point_a;
	result.point_b = clearance.point_b;
	return result;
}

std::string text( const char* name )
{
	return name == nullptr ? "" : name;
}

} // namespace

std::string Named::marginText() const
{
	return margin > 0 ? fmt::format( ", margin {} m", margin ) : "";
}

bool hasMargins( const lw_checker* checker )
{
	const lw_checker_info info = lw_checker_get_info( checker );
	return info.environment_margin > 0 || info.self_margin > 0;
}

Named nameEnvironment( const lw_checker* checker, const lw_clearance& clearance, bool asked )
{
	Named result = named( clearance, asked );
	if ( clearance.a != LW_INVALID_INDEX && clearance.b != LW_INVALID_INDEX && lw_checker_scene( checker ) != nullptr )
	{
		result.first = text( lw_robot_link_name( lw_checker_robot( checker ), clearance.a ) );
		result.second = text( lw_scene_object_name( lw_checker_scene( checker ), clearance.b ) );
		result.margin = lw_checker_environment_margin( checker, clearance.a, clearance.b );
	}
	return result;
}

Named nameSelf( const lw_checker* checker, const lw_clearance& clearance, bool asked )
{
	Named result = named( clearance, asked );
	if ( clearance.a != LW_INVALID_INDEX && clearance.b != LW_INVALID_INDEX )
	{
		result.first = text( lw_robot_link_name( lw_checker_robot( checker ), clearance.a ) );
		result.second = text( lw_robot_link_name( lw_checker_robot( checker ), clearance.b ) );
		result.margin = lw_checker_self_margin( checker, clearance.a, clearance.b );
	}
	return result;
}

lw_state_result measure( const lw_checker* checker, lw_query* query, const std::vector<double>& q, lw_check_flags flags,
    const lw_range* range, const std::string& file, const std::string& element )
{
	lw_state_result result;
	const lw_status status = lw_checker_state( checker, query, q.data(), flags, range, false, &result );
	if ( status != LW_OK )
	{
		throw io::Error( file, element, std::string( "the state cannot be used (" ) + lw_status_name( status ) + ")",
		    "give finite joint values and quaternions that are not zero" );
	}
	return result;
}

} // namespace leeway::motions
