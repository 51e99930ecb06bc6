// SPDX-License-Identifier: BSD-3-Clause
// One robot of many: names with prefixes below one root.
#include "world/composite.hpp"

#include <algorithm>
#include <set>

namespace leeway::io::detail
{

namespace
{

/// The link that is no joint's child.
const std::string& topmostLink( const RobotModel& robot )
{
	std::set<std::string> children;
	for ( const JointModel& joint : robot.joints )
	{
		children.insert( joint.child );
	}
	const auto top = std::find_if(
	    robot.links.begin(), robot.links.end(), [&]( const LinkModel& link ) { return children.count( link.name ) == 0; } );
	return top != robot.links.end() ? top->name : robot.root_link;
}

class Prefix
{
public:
	explicit Prefix( const std::string& name ) : m_prefix( name + "/" ) {}
	std::string operator()( const std::string& name ) const { return name.empty() ? "" : m_prefix + name; }
	std::vector<std::string> operator()( std::vector<std::string> names ) const
	{
		for ( std::string& name : names )
		{
			name = ( *this )( name );
		}
		return names;
	}

private:
	std::string m_prefix;
};

void addLinksAndJoints( const Prefix& prefix, const RobotModel& robot, RobotModel& out )
{
	for ( LinkModel link : robot.links )
	{
		link.name = prefix( link.name );
		out.links.push_back( std::move( link ) );
	}
	for ( JointModel joint : robot.joints )
	{
		for ( std::string* name : { &joint.name, &joint.parent, &joint.child, &joint.mimic } )
		{
			*name = prefix( *name );
		}
		out.joints.push_back( std::move( joint ) );
	}
}

/// Those of the robot's SRDF or MJCF, and one of all its joints.
void addGroups( const std::string& name, const Prefix& prefix, const RobotModel& robot, RobotModel& out )
{
	Group all;
	all.name = name;
	for ( const LinkModel& link : robot.links )
	{
		all.links.push_back( prefix( link.name ) );
	}
	for ( const JointModel& joint : robot.joints )
	{
		if ( !variableNames( joint ).empty() )
		{
			all.joints.push_back( prefix( joint.name ) );
		}
	}
	out.groups.push_back( std::move( all ) );
	for ( Group group : robot.groups )
	{
		group.name = prefix( group.name );
		group.joints = prefix( std::move( group.joints ) );
		group.links = prefix( std::move( group.links ) );
		out.groups.push_back( std::move( group ) );
	}
	for ( const GroupState& state : robot.group_states )
	{
		GroupState prefixed{ prefix( state.name ), prefix( state.group ), {}, state.defect };
		for ( const auto& [joint, values] : state.joints )
		{
			prefixed.joints.emplace( prefix( joint ), values );
		}
		out.group_states.push_back( std::move( prefixed ) );
	}
}

void addReport( const Prefix& prefix, LoadReport report, bool shared, RobotModel& out )
{
	for ( LoadedShape& line : report.shapes )
	{
		line.owner = prefix( line.owner );
		line.shared = line.shared || shared;
		line.milliseconds = shared ? 0 : line.milliseconds;
		line.built = shared ? nullptr : line.built;
	}
	report.links_without_geometry = prefix( std::move( report.links_without_geometry ) );
	if ( shared )
	{
		report.notices.clear(); // given once
		report.cache_milliseconds = 0;
	}
	append( report, out.report );
	out.report.cache = report.cache;
}

} // namespace

void addRobot(
    const std::string& name, const lw_transform& base, const RobotModel& robot, bool report_shared, RobotModel& out )
{
	const Prefix prefix( name );
	JointModel stand;
	stand.name = name;
	stand.parent = world_root;
	stand.child = prefix( topmostLink( robot ) );
	stand.parent_from_joint = base;
	out.joints.push_back( stand );
	addLinksAndJoints( prefix, robot, out );
	addGroups( name, prefix, robot, out );
	for ( const DisabledPair& pair : robot.disabled )
	{
		out.disabled.push_back( { prefix( pair.link1 ), prefix( pair.link2 ), pair.reason } );
	}
	addReport( prefix, robot.report, report_shared, out );
}

void addInitialState( const std::vector<WorldPart>& parts, RobotModel& out )
{
	std::map<std::string, double> values;
	for ( const WorldPart& part : parts )
	{
		for ( std::size_t i = 0; i < part.variables.size(); ++i )
		{
			values[part.variables[i]] = part.state[i];
		}
	}
	Group all;
	all.name = "all";
	GroupState state;
	state.name = "qpos0";
	state.group = all.name;
	for ( const LinkModel& link : out.links )
	{
		all.links.push_back( link.name );
	}
	for ( const JointModel& joint : out.joints )
	{
		for ( const std::string& variable : variableNames( joint ) )
		{
			state.joints[joint.name].push_back( values.at( variable ) );
		}
		if ( state.joints.count( joint.name ) != 0 )
		{
			all.joints.push_back( joint.name );
		}
	}
	out.groups.push_back( std::move( all ) );
	out.group_states.push_back( std::move( state ) );
}

std::vector<double> initialValues( const RobotModel& robot, std::vector<std::string>& names )
{
	const Robot built = createRobot( robot, {} );
	std::vector<double> values( lw_robot_variable_count( built.get() ) );
	lw_robot_default_state( built.get(), values.data() );
	const auto placed = std::find_if( robot.group_states.begin(), robot.group_states.end(),
	    []( const GroupState& state ) { return state.name == "qpos0" && state.group == "all"; } );
	for ( std::uint32_t i = 0; i < values.size(); ++i )
	{
		names.push_back( variableName( built.get(), i ) );
		const lw_variable_info info = lw_robot_variable( built.get(), i );
		const std::string joint = lw_robot_joint_name( built.get(), info.joint );
		if ( placed != robot.group_states.end() && placed->joints.count( joint ) != 0 )
		{
			values[i] = placed->joints.at( joint ).at( info.component );
		}
	}
	return values;
}

} // namespace leeway::io::detail
