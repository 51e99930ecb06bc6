// SPDX-License-Identifier: BSD-3-Clause
// SRDF: groups, allowed pairs, virtual joint and named states, added to a model that a URDF gave.
//
// Semantics follow MoveIt: a chain is the joints from base to tip (through their common ancestor if the base is no ancestor
// of the tip), a link stands for the joint above it, subgroups are included as they are. Fixed and mimic joints have no
// value of their own and are left out of groups. Passive joints and end effectors do not matter to collision checking.
#include "xml.hpp"

#include <algorithm>
#include <cstring>
#include <fmt/format.h>
#include <set>

namespace leeway::io::detail
{

namespace
{

using tinyxml2::XMLElement;

/// Adds a name if it is not there yet; groups are small.
void addOnce( std::vector<std::string>& names, const std::string& name )
{
	if ( std::find( names.begin(), names.end(), name ) == names.end() )
	{
		names.push_back( name );
	}
}

class SrdfReader
{
public:
	SrdfReader( const std::string& file, RobotModel& model ) : m_xml( file, "SRDF" ), m_model( model ) {}
	void read();

private:
	struct Definition
	{
		const XMLElement* element;
		enum
		{
			UNREAD,
			OPEN, ///< being read: meeting it again is a cycle
			DONE
		} state = UNREAD;
		Group group;
	};

	void readVirtualJoint( const XMLElement& element );
	void index();
	void readGroups();
	const Group& group( const std::string& name );
	void addChain( const XMLElement& chain, const std::string& what, Group& group );
	void addJoint( const JointModel& joint, Group& group );
	std::vector<const JointModel*> pathToRoot( const std::string& link ) const;
	const JointModel* findJoint( const std::string& name ) const;
	void readPairs();
	void readStates();
	bool knownLink( const std::string& link );
	std::string requireLink( const XMLElement& at, const std::string& what, const char* attribute ) const;
	void notice( const XMLElement& at, const std::string& what, const std::string& text );

	XmlFile m_xml;
	RobotModel& m_model;
	std::map<std::string, const JointModel*> m_joints, m_joint_above; ///< by name; by child link
	std::set<std::string> m_links;
	std::map<std::string, Definition> m_definitions;
	std::vector<std::string> m_group_order;
	std::vector<std::string> m_unknown; ///< links of pairs that the URDF lacks
};

void SrdfReader::notice( const XMLElement& at, const std::string& what, const std::string& text )
{
	m_model.report.notices.push_back( { m_xml.path(), m_xml.place( at, what ), text } );
}

void SrdfReader::index()
{
	m_links.clear();
	for ( const LinkModel& link : m_model.links )
	{
		m_links.insert( link.name );
	}
	for ( const JointModel& joint : m_model.joints )
	{
		m_joints[joint.name] = &joint;
		m_joint_above[joint.child] = &joint;
	}
}

const JointModel* SrdfReader::findJoint( const std::string& name ) const
{
	auto found = m_joints.find( name );
	return found != m_joints.end() ? found->second : nullptr;
}

std::string SrdfReader::requireLink( const XMLElement& at, const std::string& what, const char* attribute ) const
{
	std::string link = m_xml.text( at, what, attribute );
	if ( m_links.count( link ) == 0 )
	{
		m_xml.fail(
		    at, what, fmt::format( "the URDF has no link {}", link ), "correct the name, or give the URDF it belongs to" );
	}
	return link;
}

void SrdfReader::readVirtualJoint( const XMLElement& element )
{
	std::string name = m_xml.text( element, "virtual_joint", "name" );
	std::string what = "virtual_joint " + name;
	std::string type = m_xml.text( element, what, "type" );
	std::string parent = m_xml.text( element, what, "parent_frame" );
	std::string child = m_xml.text( element, what, "child_link" );
	if ( child != m_model.root_link )
	{
		m_xml.fail( element, what, fmt::format( "child_link {} is not the root link {}", child, m_model.root_link ),
		    "attach the root link to the world" );
	}
	if ( type != "fixed" && type != "planar" && type != "floating" )
	{
		m_xml.fail( element, what, fmt::format( "type {} is not known", type ), "use fixed, planar or floating" );
	}
	if ( !m_model.joints.empty() && m_model.joints.front().child == m_model.root_link )
	{
		m_xml.fail( element, what, "a second virtual joint", "keep one" );
	}
	bool parent_is_link = std::any_of(
	    m_model.links.begin(), m_model.links.end(), [&]( const LinkModel& link ) { return link.name == parent; } );
	if ( parent_is_link && type == "fixed" && parent == child )
	{
		return; // a root link called "world", fixed to the world: nothing to add
	}
	if ( parent_is_link )
	{
		m_xml.fail(
		    element, what, fmt::format( "parent_frame {} is a link of the robot", parent ), "give the frame another name" );
	}
	for ( const JointModel& joint : m_model.joints )
	{
		if ( joint.name == name )
		{
			m_xml.fail( element, what, "the URDF has a joint of this name", "rename the virtual joint" );
		}
	}
	JointModel joint;
	joint.name = name;
	joint.type = type == "fixed" ? LW_JOINT_FIXED : type == "planar" ? LW_JOINT_PLANAR : LW_JOINT_FLOATING;
	joint.parent = parent;
	joint.child = child;
	joint.parent_from_joint = lw_transform_identity();
	joint.axis[0] = 0; // a planar base drives in the plane z = 0 of its frame
	joint.axis[2] = 1;
	m_model.joints.insert( m_model.joints.begin(), joint );
	LinkModel world;
	world.name = parent;
	m_model.links.insert( m_model.links.begin(), world );
	m_model.planning_frame = parent;
}

void SrdfReader::addJoint( const JointModel& joint, Group& group )
{
	addOnce( group.links, joint.child );
	if ( joint.type != LW_JOINT_FIXED && joint.mimic.empty() )
	{
		addOnce( group.joints, joint.name );
	}
}

/// Joints from a link up to the root.
std::vector<const JointModel*> SrdfReader::pathToRoot( const std::string& link ) const
{
	std::vector<const JointModel*> path;
	for ( auto above = m_joint_above.find( link ); above != m_joint_above.end();
	      above = m_joint_above.find( above->second->parent ) )
	{
		path.push_back( above->second );
	}
	return path;
}

void SrdfReader::addChain( const XMLElement& chain, const std::string& what, Group& group )
{
	std::string base = requireLink( chain, what, "base_link" );
	std::string tip = requireLink( chain, what, "tip_link" );
	std::vector<const JointModel*> up = pathToRoot( base ), down = pathToRoot( tip );
	// What both paths share lies above the common ancestor
	while ( !up.empty() && !down.empty() && up.back() == down.back() )
	{
		up.pop_back();
		down.pop_back();
	}
	addOnce( group.links, base );
	for ( const JointModel* joint : up )
	{
		addJoint( *joint, group );
	}
	for ( auto joint = down.rbegin(); joint != down.rend(); ++joint )
	{
		addJoint( **joint, group );
	}
}

const Group& SrdfReader::group( const std::string& name )
{
	Definition& definition = m_definitions.at( name );
	std::string what = "group " + name;
	if ( definition.state == Definition::OPEN )
	{
		m_xml.fail( *definition.element, what, "contains itself", "break the cycle of subgroups" );
	}
	if ( definition.state == Definition::DONE )
	{
		return definition.group;
	}
	definition.state = Definition::OPEN;
	Group result;
	result.name = name;
	for ( const XMLElement& e : children( *definition.element, nullptr ) )
	{
		std::string kind = e.Name();
		if ( kind == "chain" )
		{
			addChain( e, what, result );
		}
		else if ( kind == "joint" )
		{
			std::string joint_name = m_xml.text( e, what, "name" );
			const JointModel* joint = findJoint( joint_name );
			if ( joint == nullptr )
			{
				m_xml.fail( e, what, fmt::format( "the URDF has no joint {}", joint_name ),
				    "correct the name, or give the URDF it belongs to" );
			}
			addJoint( *joint, result );
		}
		else if ( kind == "link" )
		{
			std::string link = requireLink( e, what, "name" );
			auto above = m_joint_above.find( link );
			addOnce( result.links, link );
			if ( above != m_joint_above.end() )
			{
				addJoint( *above->second, result );
			}
		}
		else if ( kind == "group" )
		{
			std::string subgroup = m_xml.text( e, what, "name" );
			if ( m_definitions.count( subgroup ) == 0 )
			{
				m_xml.fail( e, what, fmt::format( "there is no group {}", subgroup ),
				    fmt::format( "use one of {}", joinNames( m_group_order ) ) );
			}
			const Group& sub = group( subgroup );
			std::for_each( sub.links.begin(), sub.links.end(), [&]( const std::string& n ) { addOnce( result.links, n ); } );
			std::for_each(
			    sub.joints.begin(), sub.joints.end(), [&]( const std::string& n ) { addOnce( result.joints, n ); } );
		}
		else if ( kind != "passive_joint" )
		{
			notice( e, what, fmt::format( "<{}> is not known in a group and was ignored", kind ) );
		}
	}
	definition.group = result;
	definition.state = Definition::DONE;
	return definition.group;
}

void SrdfReader::readGroups()
{
	for ( const XMLElement& e : children( m_xml.root(), "group" ) )
	{
		std::string name = m_xml.text( e, "group", "name" );
		Definition definition{};
		definition.element = &e;
		if ( !m_definitions.emplace( name, definition ).second )
		{
			m_xml.fail( e, "group " + name, "a group of this name was defined before", "rename or remove one of them" );
		}
		m_group_order.push_back( name );
	}
	for ( const std::string& name : m_group_order )
	{
		m_model.groups.push_back( group( name ) );
	}
}

/// MoveIt ignores pairs of links that the URDF lacks (wheels left out of a collision model, say); so do we, with one notice.
bool SrdfReader::knownLink( const std::string& link )
{
	bool known = m_links.count( link ) != 0;
	if ( !known )
	{
		addOnce( m_unknown, link );
	}
	return known;
}

void SrdfReader::readPairs()
{
	std::set<std::pair<std::string, std::string>> enabled;
	for ( const XMLElement& e : children( m_xml.root(), "enable_collisions" ) )
	{
		std::string a = m_xml.text( e, "enable_collisions", "link1" ), b = m_xml.text( e, "enable_collisions", "link2" );
		knownLink( a );
		knownLink( b );
		enabled.insert( std::minmax( a, b ) );
	}
	std::set<std::pair<std::string, std::string>> disabled;
	auto add = [&]( const std::string& a, const std::string& b, const std::string& reason )
	{
		if ( disabled.insert( std::minmax( a, b ) ).second )
		{
			m_model.disabled.push_back( { a, b, reason } );
		}
	};
	for ( const XMLElement& e : children( m_xml.root(), "disable_collisions" ) )
	{
		std::string a = m_xml.text( e, "disable_collisions", "link1" ), b = m_xml.text( e, "disable_collisions", "link2" );
		bool known = knownLink( a );
		known = knownLink( b ) && known;
		if ( known && a != b )
		{
			add( a, b, e.Attribute( "reason" ) != nullptr ? e.Attribute( "reason" ) : "" );
		}
	}
	for ( const XMLElement& e : children( m_xml.root(), "disable_default_collisions" ) )
	{
		std::string a = m_xml.text( e, "disable_default_collisions", "link" );
		if ( !knownLink( a ) )
		{
			continue;
		}
		for ( const LinkModel& link : m_model.links )
		{
			if ( link.name != a && enabled.count( std::minmax( a, link.name ) ) == 0 )
			{
				add( a, link.name, "disable_default_collisions" );
			}
		}
	}
	if ( !m_unknown.empty() )
	{
		m_model.report.notices.push_back( { m_xml.path(), "disable_collisions",
		    fmt::format( "pairs of links that the URDF lacks were ignored: {}", joinNames( m_unknown ) ) } );
	}
}

void SrdfReader::readStates()
{
	for ( const XMLElement& e : children( m_xml.root(), "group_state" ) )
	{
		GroupState state;
		state.name = m_xml.text( e, "group_state", "name" );
		std::string what = "group_state " + state.name;
		state.group = m_xml.text( e, what, "group" );
		if ( m_model.findGroup( state.group ) == nullptr )
		{
			notice( e, what, fmt::format( "there is no group {}: ignored", state.group ) );
			continue;
		}
		for ( const XMLElement& j : children( e, "joint" ) )
		{
			std::string joint = m_xml.text( j, what, "name" );
			std::vector<double> values = m_xml.numbers( j, what, "value", 0 );
			if ( findJoint( joint ) == nullptr )
			{
				notice( j, what, fmt::format( "the URDF has no joint {}: ignored", joint ) );
				continue;
			}
			state.joints[joint] = values;
		}
		m_model.group_states.push_back( state );
	}
}

void SrdfReader::read()
{
	const char* name = m_xml.root().Attribute( "name" );
	if ( name != nullptr && name != m_model.name )
	{
		notice( m_xml.root(), "<robot>", fmt::format( "is for robot {}, the URDF is {}", name, m_model.name ) );
	}
	for ( const XMLElement& e : children( m_xml.root(), "virtual_joint" ) )
	{
		readVirtualJoint( e );
	}
	index();
	readGroups();
	readPairs();
	readStates();
}

} // namespace

void readSrdf( const std::string& srdf_file, RobotModel& model )
{
	SrdfReader reader( srdf_file, model );
	reader.read();
	model.srdf_file = srdf_file;
}

} // namespace leeway::io::detail
