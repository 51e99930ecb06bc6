// SPDX-License-Identifier: BSD-3-Clause
// The variables that a problem's states have, and its checker.
#include "scene/group.hpp"

#include <algorithm>

namespace leeway::io
{

std::vector<std::string> groupVariables( const RobotModel& robot, const std::string& group )
{
	std::vector<std::string> variables;
	for ( const std::string& joint : robot.useGroup( group ).joints )
	{
		const auto model = std::find_if( robot.joints.begin(), robot.joints.end(),
		    [&]( const JointModel& candidate ) { return candidate.name == joint; } );
		const std::vector<std::string> names =
		    model != robot.joints.end() ? variableNames( *model ) : std::vector<std::string>();
		variables.insert( variables.end(), names.begin(), names.end() );
	}
	if ( variables.empty() )
	{
		throw Error( robot.srdf_file, "group " + group, "has no movable joint",
		    "use a group with joints that are neither fixed nor mimicking" );
	}
	return variables;
}

void detail::selectGroup( const RobotModel& model, const std::string& group_name, Problem& problem )
{
	const lw_robot* robot = problem.robot.get();
	std::map<std::string, std::uint32_t> index;
	std::vector<std::string> all;
	for ( std::uint32_t i = 0; i < lw_robot_variable_count( robot ); ++i )
	{
		all.push_back( variableName( robot, i ) );
		index[all.back()] = i;
	}
	if ( group_name.empty() && all.empty() )
	{
		throw Error( model.urdf_file, "robot " + model.name, "has no joint that can move",
		    "if it is an object, give it as the scene (--scene)" );
	}
	problem.group = group_name;
	problem.variable_names = group_name.empty() ? all : groupVariables( model, group_name );
	problem.variables.clear();
	for ( const std::string& name : problem.variable_names )
	{
		problem.variables.push_back( index.at( name ) );
	}
}

void detail::makeChecker(
    lw_checker_def def, const std::string& file, const std::string& element, const std::string& remedy, Problem& problem )
{
	def.robot = problem.robot.get();
	def.scene = problem.scene.get();
	def.variables = problem.variables.data();
	def.variable_count = static_cast<std::uint32_t>( problem.variables.size() );
	def.reference = problem.reference.data();
	def.allowed = problem.allowed.data();
	def.allowed_count = static_cast<std::uint32_t>( problem.allowed.size() );
	def.reach = problem.reach.reach.get();
	lw_checker* checker = nullptr;
	lw_diag diag{};
	const lw_status status = lw_checker_create( &def, nullptr, &diag, &checker );
	if ( status != LW_OK )
	{
		throw Error( file, element, diag.message[0] != '\0' ? diag.message : lw_status_name( status ), remedy );
	}
	problem.checker = Checker::adopt( checker );
}

} // namespace leeway::io
