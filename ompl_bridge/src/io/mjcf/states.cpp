// SPDX-License-Identifier: BSD-3-Clause
// Groups and named states of an MJCF model: keyframes, and qpos0, the state in which the file places the bodies.
#include "mjcf/robot.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace leeway::io::detail::mjcf
{

namespace
{

/// Angles about x, y and z, in this order, of a quaternion w, x, y, z of length 1.
std::array<double, 3> ballAngles( const double* q )
{
	const double zero[3] = { 0, 0, 0 };
	lw_transform turn = lw_transform_identity();
	(void)fromQuaternion( zero, q, turn );
	const double s = std::clamp( turn.r[0][2], -1.0, 1.0 );
	return { std::atan2( -turn.r[1][2], turn.r[2][2] ), std::asin( s ), std::atan2( -turn.r[0][1], turn.r[0][0] ) };
}

class StateAdder
{
public:
	StateAdder( const Document& document, const Tree& tree, RobotModel& model ) : m_document( document ), m_model( model )
	{
		for ( const Body& body : tree.bodies )
		{
			for ( const Joint& joint : body.joints )
			{
				m_joints.emplace_back( &body, &joint );
				m_value_count += joint.valueCount();
			}
		}
	}
	void addGroups( const Tree& tree );
	void addKeyframes();

private:
	Group groupOf( const std::string& name, const std::set<std::string>& joints, const std::set<std::string>& links ) const;
	std::vector<double> initial() const;
	GroupState stateOf( const std::string& name, const std::vector<double>& values ) const;

	const Document& m_document;
	RobotModel& m_model;
	std::vector<std::pair<const Body*, const Joint*>> m_joints; ///< in the order of qpos
	std::size_t m_value_count = 0;
};

/// Of the movable joints with one of these names, and links.
Group StateAdder::groupOf(
    const std::string& name, const std::set<std::string>& joints, const std::set<std::string>& links ) const
{
	Group group;
	group.name = name;
	for ( const JointModel& joint : m_model.joints )
	{
		if ( links.count( joint.child ) != 0 )
		{
			group.links.push_back( joint.child );
		}
		if ( joints.count( joint.name ) != 0 && joint.type != LW_JOINT_FIXED && joint.mimic.empty() )
		{
			group.joints.push_back( joint.name );
		}
	}
	return group;
}

void StateAdder::addGroups( const Tree& tree )
{
	std::set<std::string> joints, links;
	for ( const JointModel& joint : m_model.joints )
	{
		joints.insert( joint.name );
		links.insert( joint.child );
	}
	const Group all = groupOf( "all", joints, links );
	if ( all.joints.empty() )
	{
		return;
	}
	m_model.groups.push_back( all );
	// one group for each child of the world below which something moves
	std::map<std::size_t, std::set<std::string>> joints_of, links_of;
	for ( std::size_t i = 1; i < tree.bodies.size(); ++i )
	{
		std::size_t top = i;
		while ( tree.bodies[top].parent != 0 )
		{
			top = tree.bodies[top].parent;
		}
		links_of[top].insert( tree.bodies[i].name );
		for ( const Joint& joint : tree.bodies[i].joints )
		{
			const std::vector<std::string> names = namesOf( joint ).names;
			joints_of[top].insert( names.begin(), names.end() );
		}
	}
	for ( const auto& [top, names] : joints_of )
	{
		const Group group = groupOf( tree.bodies[top].name, names, links_of[top] );
		if ( !group.joints.empty() && group.joints.size() < all.joints.size() && group.name != all.name )
		{
			m_model.groups.push_back( group );
		}
	}
}

std::vector<double> StateAdder::initial() const
{
	std::vector<double> values;
	for ( const auto& [body, joint] : m_joints )
	{
		double xyzw[4] = { 0, 0, 0, 1 };
		if ( joint->type == Joint::FREE )
		{
			lw_transform_to_quaternion( &body->pose, xyzw );
			values.insert( values.end(), body->pose.t, body->pose.t + 3 );
		}
		if ( joint->type == Joint::FREE || joint->type == Joint::BALL )
		{
			values.insert( values.end(), { xyzw[3], xyzw[0], xyzw[1], xyzw[2] } );
		}
		else
		{
			values.push_back( joint->reference );
		}
	}
	return values;
}

GroupState StateAdder::stateOf( const std::string& name, const std::vector<double>& values ) const
{
	GroupState state;
	state.name = name;
	state.group = "all";
	const double* at = values.data();
	for ( const auto& [body, joint] : m_joints )
	{
		const std::vector<std::string> names = namesOf( *joint ).names;
		const double* q = joint->type == Joint::FREE ? at + 3 : at;
		if ( joint->type == Joint::FREE )
		{
			const double length = std::hypot( std::hypot( q[0], q[1] ), std::hypot( q[2], q[3] ) );
			const double scale = length > 0 ? 1 / length : 0;
			state.joints[names[0]] = {
			    at[0], at[1], at[2], q[1] * scale, q[2] * scale, q[3] * scale, length > 0 ? q[0] * scale : 1 };
		}
		else if ( joint->type == Joint::BALL )
		{
			const std::array<double, 3> angles = ballAngles( q );
			for ( std::size_t k = 0; k < 3; ++k )
			{
				state.joints[names[k]] = { angles[k] };
			}
		}
		else
		{
			state.joints[names[0]] = { at[0] };
		}
		at += joint->valueCount();
	}
	return state;
}

void StateAdder::addKeyframes()
{
	if ( m_model.groups.empty() )
	{
		return;
	}
	const std::vector<double> start = initial();
	std::set<std::string> names;
	std::size_t index = 0;
	for ( const XMLElement* key : m_document.inSections( "keyframe", "key" ) )
	{
		std::string name = m_document.optionalText( *key, "key", "name" );
		name = name.empty() ? fmt::format( "key{}", index ) : name;
		++index;
		const std::string what = "key " + name;
		if ( !names.insert( name ).second )
		{
			m_document.fail( *key, what, "a keyframe of this name was defined before", "rename or remove one of them" );
		}
		std::vector<double> values = start;
		std::string defect;
		if ( key->Attribute( "qpos" ) != nullptr )
		{
			const std::vector<double> given = m_document.numbers( *key, what, "qpos", 1, SIZE_MAX );
			if ( given.size() > m_value_count )
			{
				defect =
				    fmt::format( "qpos has {} numbers for {} (line {})", given.size(), m_value_count, key->GetLineNum() );
				m_model.report.notices.push_back( m_document.notice( *key, what, "cannot be used: " + defect ) );
			}
			std::copy_n( given.begin(), std::min( given.size(), values.size() ), values.begin() );
		}
		GroupState state = stateOf( name, values );
		state.defect = defect;
		m_model.group_states.push_back( std::move( state ) );
	}
	if ( names.count( "qpos0" ) == 0 )
	{
		m_model.group_states.push_back( stateOf( "qpos0", start ) );
	}
}

} // namespace

void addStates( const Document& document, const Tree& tree, RobotModel& model )
{
	StateAdder adder( document, tree, model );
	adder.addGroups( tree );
	adder.addKeyframes();
}

} // namespace leeway::io::detail::mjcf
