// SPDX-License-Identifier: BSD-3-Clause
// SRDF: groups, allowed pairs, virtual joint and named states, added to a model that a URDF gave.
//
// Semantics follow MoveIt: a chain is the joints from base to tip (through their common ancestor if the base is no ancestor
// of the tip), a link stands for the joint above it, subgroups are included as they are. Fixed and mimic joints have no
// value of their own and are left out of groups. Passive joints and end effectors do not matter to collision checking.
//
// As in srdfdom, an element with a name that the URDF lacks does not spoil the file: it is left out, with a notice. A group
// or state that lost a part this way is kept with its defect, and using it is an error; LoadOptions::strict makes it one at
// once.
#include "base/xml.hpp"

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

/// Elements that SRDFs have below <robot>; leeway has no use for the last four.
constexpr const char* known_elements[] = { "group", "group_state", "virtual_joint", "disable_collisions",
    "enable_collisions", "disable_default_collisions", "end_effector", "passive_joint", "link_sphere_approximation",
    "joint_property" };

class SrdfReader
{
public:
	SrdfReader( const std::string& file, bool strict, RobotModel& model )
	    : m_xml( file ), m_strict( strict ), m_model( model )
	{
		m_xml.requireRobot( "SRDF" );
	}
	void read();

private:
	using Defects = std::vector<std::string>; ///< "the URDF has no link hand (line 7)"

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
		std::string cause; ///< the first defect
	};

	void checkKind();
	void readVirtualJoint( const XMLElement& element );
	bool usableVirtualJoint( const XMLElement& element, const std::string& what, const std::string& name );
	void index();
	void defineGroups();
	void readGroups();
	const Group& group( const std::string& name );
	void addPart( const XMLElement& part, const std::string& what, Group& group, Defects& defects );
	void addSubgroup( const XMLElement& part, const std::string& what, Group& group, Defects& defects );
	void addChain( const XMLElement& chain, const std::string& what, Group& group, Defects& defects );
	void addJoint( const JointModel& joint, Group& group );
	std::vector<const JointModel*> pathToRoot( const std::string& link ) const;
	const JointModel* findJoint( const std::string& name ) const;
	void readPairs();
	std::set<std::pair<std::string, std::string>> readEnabled( std::set<std::string>& all_of );
	void readDisabled( std::set<std::pair<std::string, std::string>>& disabled );
	void readDisabledDefaults( std::set<std::pair<std::string, std::string>>& disabled );
	void disable( const std::string& a, const std::string& b, const std::string& reason,
	    std::set<std::pair<std::string, std::string>>& disabled );
	void readStates();
	void readState( const XMLElement& element, const std::string& name );
	void noticeEndEffectors();
	bool knownLink( const std::string& link );

	/// A non-empty attribute; without one, a defect.
	std::string text( const XMLElement& at, const std::string& what, const char* attribute, Defects& defects ) const;
	/// A link of the URDF; else a defect, and empty.
	std::string link( const XMLElement& at, const std::string& what, const char* attribute, Defects& defects ) const;
	/// Notes a defect of a group or state. @throws Error if strict
	void defect( const XMLElement& at, const std::string& what, const std::string& problem, const std::string& remedy,
	    Defects& defects ) const;
	/// A notice about an element that is left out for its defects; true if there are any.
	bool isLeftOut( const XMLElement& at, const std::string& what, const Defects& defects );
	void notice( const XMLElement& at, const std::string& what, const std::string& text );

	XmlFile m_xml;
	const bool m_strict;
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

void SrdfReader::defect( const XMLElement& at, const std::string& what, const std::string& problem,
    const std::string& remedy, Defects& defects ) const
{
	if ( m_strict )
	{
		m_xml.fail( at, what, problem, remedy );
	}
	addOnce( defects, fmt::format( "{} (line {})", problem, at.GetLineNum() ) );
}

bool SrdfReader::isLeftOut( const XMLElement& at, const std::string& what, const Defects& defects )
{
	if ( !defects.empty() )
	{
		notice( at, what, fmt::format( "was ignored: {}", joinNames( defects ) ) );
	}
	return !defects.empty();
}

std::string SrdfReader::text( const XMLElement& at, const std::string& what, const char* attribute, Defects& defects ) const
{
	const char* value = at.Attribute( attribute );
	if ( value == nullptr || *value == '\0' )
	{
		defect( at, what, fmt::format( "<{}> has no {}", at.Name(), attribute ),
		    fmt::format( "add {}=\"...\" to it", attribute ), defects );
		return "";
	}
	m_xml.requireUtf8( at, what, attribute );
	return value;
}

std::string SrdfReader::link( const XMLElement& at, const std::string& what, const char* attribute, Defects& defects ) const
{
	std::string name = text( at, what, attribute, defects );
	if ( name.empty() || m_links.count( name ) != 0 )
	{
		return name;
	}
	defect( at, what, fmt::format( "the URDF has no link {}", name ), "correct the name, or give the URDF it belongs to",
	    defects );
	return "";
}

/// Whether a virtual joint can be added; else it is left out, as MoveIt does.
bool SrdfReader::usableVirtualJoint( const XMLElement& element, const std::string& what, const std::string& name )
{
	Defects defects;
	if ( name.empty() )
	{
		defect( element, what, "<virtual_joint> has no name", "add name=\"...\" to it", defects );
	}
	const std::string type = text( element, what, "type", defects );
	const std::string parent = text( element, what, "parent_frame", defects );
	const std::string child = text( element, what, "child_link", defects );
	if ( !child.empty() && child != m_model.root_link )
	{
		defect( element, what, fmt::format( "child_link {} is not the root link {}", child, m_model.root_link ),
		    "attach the root link to the world", defects );
	}
	if ( !type.empty() && type != "fixed" && type != "planar" && type != "floating" )
	{
		defect( element, what, fmt::format( "type {} is not known", type ), "use fixed, planar or floating", defects );
	}
	if ( !m_model.joints.empty() && m_model.joints.front().child == m_model.root_link )
	{
		defect( element, what, "a second virtual joint", "keep one", defects );
	}
	const bool parent_is_link = std::any_of(
	    m_model.links.begin(), m_model.links.end(), [&]( const LinkModel& known ) { return known.name == parent; } );
	if ( parent_is_link && type == "fixed" && parent == child && defects.empty() )
	{
		return false; // a root link called "world", fixed to the world: nothing to add
	}
	if ( parent_is_link )
	{
		defect( element, what, fmt::format( "parent_frame {} is a link of the robot", parent ),
		    "give the frame another name", defects );
	}
	if ( std::any_of(
	         m_model.joints.begin(), m_model.joints.end(), [&]( const JointModel& joint ) { return joint.name == name; } ) )
	{
		defect( element, what, "the URDF has a joint of this name", "rename the virtual joint", defects );
	}
	return !isLeftOut( element, what, defects );
}

void SrdfReader::readVirtualJoint( const XMLElement& element )
{
	const char* given = element.Attribute( "name" );
	m_xml.requireUtf8( element, "virtual_joint", "name" );
	const std::string name = given != nullptr ? given : "";
	if ( !usableVirtualJoint( element, name.empty() ? "virtual_joint" : "virtual_joint " + name, name ) )
	{
		return;
	}
	const std::string type = element.Attribute( "type" ), parent = element.Attribute( "parent_frame" );
	JointModel joint;
	joint.name = name;
	joint.type = type == "fixed" ? LW_JOINT_FIXED : type == "planar" ? LW_JOINT_PLANAR : LW_JOINT_FLOATING;
	joint.parent = parent;
	joint.child = m_model.root_link;
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

void SrdfReader::addChain( const XMLElement& chain, const std::string& what, Group& group, Defects& defects )
{
	const std::string base = link( chain, what, "base_link", defects ), tip = link( chain, what, "tip_link", defects );
	if ( base.empty() || tip.empty() )
	{
		return;
	}
	std::vector<const JointModel*> up = pathToRoot( base ), down = pathToRoot( tip );
	// Joints on both paths lie above the common ancestor
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

void SrdfReader::addSubgroup( const XMLElement& part, const std::string& what, Group& out, Defects& defects )
{
	const std::string name = text( part, what, "name", defects );
	auto found = m_definitions.find( name );
	if ( name.empty() )
	{
		return;
	}
	if ( found == m_definitions.end() )
	{
		defect( part, what, fmt::format( "there is no group {}", name ),
		    fmt::format( "use one of {}", joinNames( m_group_order ) ), defects );
		return;
	}
	if ( found->second.state == Definition::OPEN )
	{
		defect( part, what, fmt::format( "group {} contains itself", name ), "break the cycle of subgroups", defects );
		return;
	}
	const Group& sub = group( name );
	std::for_each( sub.links.begin(), sub.links.end(), [&]( const std::string& n ) { addOnce( out.links, n ); } );
	std::for_each( sub.joints.begin(), sub.joints.end(), [&]( const std::string& n ) { addOnce( out.joints, n ); } );
	if ( !sub.defect.empty() )
	{
		addOnce( defects, fmt::format( "its group {}: {}", name, found->second.cause ) );
	}
}

void SrdfReader::addPart( const XMLElement& part, const std::string& what, Group& out, Defects& defects )
{
	const std::string kind = part.Name();
	if ( kind == "chain" )
	{
		addChain( part, what, out, defects );
	}
	else if ( kind == "group" )
	{
		addSubgroup( part, what, out, defects );
	}
	else if ( kind == "joint" )
	{
		const std::string name = text( part, what, "name", defects );
		const JointModel* joint = findJoint( name );
		if ( joint != nullptr )
		{
			addJoint( *joint, out );
		}
		else if ( !name.empty() )
		{
			defect( part, what, fmt::format( "the URDF has no joint {}", name ),
			    "correct the name, or give the URDF it belongs to", defects );
		}
	}
	else if ( kind == "link" )
	{
		const std::string name = link( part, what, "name", defects );
		auto above = m_joint_above.find( name );
		if ( !name.empty() )
		{
			addOnce( out.links, name );
		}
		if ( above != m_joint_above.end() )
		{
			addJoint( *above->second, out );
		}
	}
	else if ( kind != "passive_joint" )
	{
		notice( part, what, fmt::format( "<{}> is not known in a group and was ignored", kind ) );
	}
}

const Group& SrdfReader::group( const std::string& name )
{
	Definition& definition = m_definitions.at( name );
	if ( definition.state == Definition::DONE )
	{
		return definition.group;
	}
	definition.state = Definition::OPEN;
	const std::string what = "group " + name;
	Group result;
	result.name = name;
	Defects defects;
	for ( const XMLElement& part : children( *definition.element, nullptr ) )
	{
		addPart( part, what, result, defects );
	}
	if ( !defects.empty() )
	{
		result.defect = joinNames( defects, 4 );
		definition.cause = defects.front();
		notice( *definition.element, what, "cannot be used: " + result.defect );
	}
	definition.group = result;
	definition.state = Definition::DONE;
	return definition.group;
}

void SrdfReader::defineGroups()
{
	for ( const XMLElement& e : children( m_xml.root(), "group" ) )
	{
		Defects defects;
		const std::string name = text( e, "group", "name", defects ), what = "group " + name;
		Definition definition{};
		definition.element = &e;
		if ( !name.empty() && !m_definitions.emplace( name, definition ).second )
		{
			defect( e, what, "a group of this name was defined before", "rename or remove one of them", defects );
		}
		if ( !isLeftOut( e, name.empty() ? "group" : what, defects ) )
		{
			m_group_order.push_back( name );
		}
	}
}

void SrdfReader::readGroups()
{
	defineGroups();
	for ( const std::string& name : m_group_order )
	{
		// of the same name, the SRDF's group counts and not the MJCF's
		m_model.groups.erase( std::remove_if( m_model.groups.begin(), m_model.groups.end(),
		                          [&]( const Group& known ) { return known.name == name; } ),
		    m_model.groups.end() );
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

/// @param all_of links of elements that name only one: all their pairs stay enabled, whichever was meant
std::set<std::pair<std::string, std::string>> SrdfReader::readEnabled( std::set<std::string>& all_of )
{
	std::set<std::pair<std::string, std::string>> enabled;
	for ( const XMLElement& e : children( m_xml.root(), "enable_collisions" ) )
	{
		Defects defects;
		const std::string a = text( e, "enable_collisions", "link1", defects ),
		                  b = text( e, "enable_collisions", "link2", defects );
		if ( !defects.empty() )
		{
			all_of.insert( a.empty() ? b : a );
			notice( e, "enable_collisions",
			    fmt::format( "{}: no pair of {} is disabled by default", joinNames( defects ), a.empty() ? b : a ) );
			continue;
		}
		knownLink( a );
		knownLink( b );
		enabled.insert( std::minmax( a, b ) );
	}
	return enabled;
}

void SrdfReader::disable( const std::string& a, const std::string& b, const std::string& reason,
    std::set<std::pair<std::string, std::string>>& disabled )
{
	if ( disabled.insert( std::minmax( a, b ) ).second )
	{
		m_model.disabled.push_back( { a, b, reason } );
	}
}

void SrdfReader::readDisabled( std::set<std::pair<std::string, std::string>>& disabled )
{
	for ( const XMLElement& e : children( m_xml.root(), "disable_collisions" ) )
	{
		Defects defects;
		const std::string a = text( e, "disable_collisions", "link1", defects ),
		                  b = text( e, "disable_collisions", "link2", defects );
		if ( isLeftOut( e, "disable_collisions", defects ) )
		{
			continue;
		}
		bool known = knownLink( a );
		known = knownLink( b ) && known;
		m_xml.requireUtf8( e, "disable_collisions", "reason" );
		if ( known && a != b )
		{
			disable( a, b, e.Attribute( "reason" ) != nullptr ? e.Attribute( "reason" ) : "", disabled );
		}
	}
}

void SrdfReader::readDisabledDefaults( std::set<std::pair<std::string, std::string>>& disabled )
{
	std::set<std::string> all_of;
	const std::set<std::pair<std::string, std::string>> enabled = readEnabled( all_of );
	for ( const XMLElement& e : children( m_xml.root(), "disable_default_collisions" ) )
	{
		Defects defects;
		const std::string a = text( e, "disable_default_collisions", "link", defects );
		if ( isLeftOut( e, "disable_default_collisions", defects ) || !knownLink( a ) )
		{
			continue;
		}
		for ( const LinkModel& other : m_model.links )
		{
			if ( other.name != a &&
			     enabled.count( std::minmax( a, other.name ) ) + all_of.count( a ) + all_of.count( other.name ) == 0 )
			{
				disable( a, other.name, "disable_default_collisions", disabled );
			}
		}
	}
}

void SrdfReader::readPairs()
{
	std::set<std::pair<std::string, std::string>> disabled; // an MJCF has pairs of its own
	for ( const DisabledPair& pair : m_model.disabled )
	{
		disabled.insert( std::minmax( pair.link1, pair.link2 ) );
	}
	readDisabled( disabled );
	readDisabledDefaults( disabled );
	if ( !m_unknown.empty() )
	{
		m_model.report.notices.push_back( { m_xml.path(), "disable_collisions",
		    fmt::format( "pairs of links that the URDF lacks were ignored: {}", joinNames( m_unknown ) ) } );
	}
}

/// A state that names joints which the URDF lacks (a root_joint, a hand that is not mounted) is the state that was meant if
/// it has a value for each joint of its group.
void SrdfReader::readState( const XMLElement& element, const std::string& name )
{
	const std::string what = "group_state " + name;
	GroupState state;
	state.name = name;
	Defects defects, absent;
	state.group = text( element, what, "group", defects );
	const Group* group = m_model.findGroup( state.group );
	if ( group == nullptr && !state.group.empty() )
	{
		addOnce( defects, fmt::format( "there is no group {} (line {})", state.group, element.GetLineNum() ) );
	}
	for ( const XMLElement& e : children( element, "joint" ) )
	{
		const std::string joint = text( e, what, "name", defects );
		if ( findJoint( joint ) == nullptr )
		{
			if ( !joint.empty() )
			{
				addOnce( absent, fmt::format( "the URDF has no joint {} (line {})", joint, e.GetLineNum() ) );
			}
			continue;
		}
		try
		{
			state.joints[joint] = m_xml.numbers( e, what, "value", 0 );
		}
		catch ( const Error& error )
		{
			defect( e, what, error.problem(), error.remedy(), defects );
		}
	}
	const bool whole =
	    group != nullptr && std::all_of( group->joints.begin(), group->joints.end(),
	                            [&]( const std::string& joint ) { return state.joints.count( joint ) != 0; } );
	if ( defects.empty() && whole && !absent.empty() )
	{
		notice( element, what, fmt::format( "joints were left out: {}", joinNames( absent, 4 ) ) );
	}
	else if ( defects.size() + absent.size() > 0 )
	{
		defects.insert( defects.end(), absent.begin(), absent.end() );
		state.defect = joinNames( defects, 4 );
		notice( element, what, "cannot be used: " + state.defect );
	}
	m_model.group_states.push_back( state );
}

void SrdfReader::readStates()
{
	for ( const XMLElement& e : children( m_xml.root(), "group_state" ) )
	{
		Defects defects;
		const std::string name = text( e, "group_state", "name", defects );
		if ( !isLeftOut( e, "group_state", defects ) )
		{
			readState( e, name );
		}
	}
}

/// No answer depends on end effectors: the notices about their unknown names help the author of the file.
void SrdfReader::noticeEndEffectors()
{
	for ( const XMLElement& e : children( m_xml.root(), "end_effector" ) )
	{
		const auto missing = [&]( const char* attribute, const auto& known )
		{
			const char* name = e.Attribute( attribute );
			if ( name != nullptr && *name != '\0' && !known( name ) )
			{
				notice( e, "end_effector", fmt::format( "there is no {} {}", attribute, name ) );
			}
		};
		missing( "group", [&]( const char* name ) { return m_definitions.count( name ) != 0; } );
		missing( "parent_group", [&]( const char* name ) { return m_definitions.count( name ) != 0; } );
		missing( "parent_link", [&]( const char* name ) { return m_links.count( name ) != 0; } );
	}
}

/// A URDF has the same root element: without this check it would pass as an empty SRDF.
void SrdfReader::checkKind()
{
	const XMLElement* urdf = nullptr;
	bool any = false;
	std::vector<std::string> unknown;
	for ( const XMLElement& e : children( m_xml.root(), nullptr ) )
	{
		const std::string name = e.Name();
		const bool known =
		    std::find( std::begin( known_elements ), std::end( known_elements ), name ) != std::end( known_elements );
		const bool of_urdf = name == "link" || name == "joint";
		any = any || known;
		urdf = of_urdf && urdf == nullptr ? &e : urdf;
		if ( !known && !of_urdf )
		{
			addOnce( unknown, "<" + name + ">" );
		}
	}
	if ( urdf != nullptr && !any )
	{
		m_xml.fail( *urdf, fmt::format( "<{}>", urdf->Name() ),
		    "this is a URDF: it has links and joints, and nothing that an SRDF has",
		    "give the SRDF here and this file as the robot, or leave the SRDF out" );
	}
	if ( urdf != nullptr )
	{
		notice( *urdf, fmt::format( "<{}>", urdf->Name() ),
		    "links and joints of an SRDF were ignored: those of the URDF count" );
	}
	if ( !unknown.empty() )
	{
		notice(
		    m_xml.root(), "<robot>", fmt::format( "elements that are not known were ignored: {}", joinNames( unknown ) ) );
	}
	if ( !any )
	{
		notice( m_xml.root(), "<robot>", "holds no group and disables no pair" );
	}
}

void SrdfReader::read()
{
	checkKind();
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
	noticeEndEffectors();
}

} // namespace

void readSrdf( const std::string& srdf_file, bool strict, RobotModel& model )
{
	SrdfReader reader( srdf_file, strict, model );
	reader.read();
	model.srdf_file = srdf_file;
}

} // namespace leeway::io::detail
