// SPDX-License-Identifier: BSD-3-Clause
// Links and joints of a robot model from bodies and joints of MuJoCo.
//
// A body moves against its parent by all of its joints in turn: T0 M1 M2 ..., each M a turn about a line of the body's frame or a
// shift along one. In a robot model a joint has one parent and one child, and the child's frame lies on the axis. So each joint but
// the last gets a link of its own, and a body whose last axis does not pass through its origin hangs on a fixed joint: the frame of
// a link that has the name of a body is that of the body.
#include "mjcf/robot.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace leeway::io::detail::mjcf
{

namespace
{

bool isIdentity( const lw_transform& t )
{
	const lw_transform identity = lw_transform_identity();
	return std::equal( &t.r[0][0], &t.r[0][0] + 9, &identity.r[0][0] ) && std::equal( t.t, t.t + 3, identity.t );
}

/// The motion of the frame by a joint at the difference of its value to its reference.
lw_transform motion( const Joint& joint, double difference )
{
	if ( joint.type == Joint::SLIDE )
	{
		return shiftBy( joint.axis[0] * difference, joint.axis[1] * difference, joint.axis[2] * difference );
	}
	return aboutAxis( joint.axis, difference );
}

class LinkWriter
{
public:
	LinkWriter( const Document& document, const Couplings& couplings, RobotModel& model )
	    : m_document( document ), m_couplings( couplings ), m_model( model )
	{
		for ( const LinkModel& link : model.links )
		{
			m_links.insert( link.name );
		}
	}
	void add( const Body& body, const std::string& parent );
	void reserve( const std::string& name ) { m_links.insert( name ); }

private:
	void addJoint( const Body& body, const Joint& joint, bool last );
	void addBall( const Body& body, const Joint& joint, bool last );
	void append( const Body& body, JointModel joint, bool is_body );
	std::string freshLink( const std::string& name );
	std::string freshJoint( const std::string& name );
	void couple( const Joint& joint, JointModel& model );

	const Document& m_document;
	const Couplings& m_couplings;
	RobotModel& m_model;
	std::set<std::string> m_links, m_joints;
	std::string m_parent;     ///< the link that the next joint hangs on
	lw_transform m_pending{}; ///< from that link to the frame of the body so far
};

std::string LinkWriter::freshLink( const std::string& name )
{
	std::string fresh = name;
	while ( !m_links.insert( fresh ).second )
	{
		fresh += '_';
	}
	return fresh;
}

std::string LinkWriter::freshJoint( const std::string& name )
{
	std::string fresh = name;
	while ( !m_joints.insert( fresh ).second )
	{
		fresh += '_';
	}
	return fresh;
}

/// @param is_body the child is the link of the body; else one between
void LinkWriter::append( const Body& body, JointModel joint, bool is_body )
{
	joint.parent = m_parent;
	joint.child = is_body ? body.name : freshLink( fmt::format( "{}/{}", body.name, joint.name ) );
	m_parent = joint.child;
	LinkModel link;
	link.name = joint.child;
	m_model.links.push_back( link );
	m_model.joints.push_back( std::move( joint ) );
}

void LinkWriter::couple( const Joint& joint, JointModel& model )
{
	const auto coupling = m_couplings.find( joint.name );
	if ( coupling == m_couplings.end() )
	{
		return;
	}
	if ( coupling->second.driver.empty() )
	{
		const lw_transform moved = motion( joint, coupling->second.offset );
		model.parent_from_joint = lw_transform_multiply( &model.parent_from_joint, &moved );
		model.type = LW_JOINT_FIXED;
		model.lower = model.upper = 0;
		return;
	}
	model.mimic = coupling->second.driver;
	model.mimic_multiplier = coupling->second.multiplier;
	model.mimic_offset = coupling->second.offset;
}

/// Three turns about x, y and z of the body. A limit of the whole angle is kept by limits of a third of it.
void LinkWriter::addBall( const Body& body, const Joint& joint, bool last )
{
	const lw_transform anchor = shiftBy( joint.position[0], joint.position[1], joint.position[2] );
	lw_transform frame = lw_transform_multiply( &m_pending, &anchor );
	const bool centred = joint.position[0] == 0 && joint.position[1] == 0 && joint.position[2] == 0;
	const std::vector<std::string> names = namesOf( joint ).names;
	for ( std::size_t axis = 0; axis < 3; ++axis )
	{
		JointModel model;
		model.name = names[axis];
		m_joints.insert( model.name );
		model.parent_from_joint = frame;
		model.axis[0] = model.axis[1] = model.axis[2] = 0;
		model.axis[axis] = 1;
		const double most = joint.limited ? joint.upper / 3 : pi;
		const double bound = axis == 1 ? std::min( most, pi / 2 ) : most;
		model.type = bound < pi ? LW_JOINT_REVOLUTE : LW_JOINT_CONTINUOUS;
		model.lower = model.type == LW_JOINT_REVOLUTE ? -bound : 0;
		model.upper = model.type == LW_JOINT_REVOLUTE ? bound : 0;
		append( body, model, last && centred && axis == 2 );
		frame = lw_transform_identity();
	}
	m_pending = shiftBy( -joint.position[0], -joint.position[1], -joint.position[2] );
	m_model.report.notices.push_back( m_document.notice( *joint.element, "joint " + joint.name,
	    fmt::format( "a ball joint is three hinges {}{}", joinNames( names ),
	        joint.limited ? fmt::format( ", each within a third of its limit of {:.4g} rad", joint.upper ) : "" ) ) );
}

void LinkWriter::addJoint( const Body& body, const Joint& joint, bool last )
{
	if ( joint.type == Joint::BALL )
	{
		addBall( body, joint, last );
		return;
	}
	JointModel model;
	model.name = joint.name;
	m_joints.insert( model.name );
	if ( joint.type == Joint::FREE )
	{
		// the values of a free joint are the pose in the world, whatever the body says
		model.type = LW_JOINT_FLOATING;
		model.parent_from_joint = lw_transform_identity();
		append( body, model, true );
		m_pending = lw_transform_identity();
		return;
	}
	const bool turns = joint.type == Joint::HINGE;
	const double* p = joint.position;
	const lw_transform anchor = turns ? shiftBy( p[0], p[1], p[2] ) : lw_transform_identity();
	model.parent_from_joint = lw_transform_multiply( &m_pending, &anchor );
	if ( joint.reference != 0 )
	{
		const lw_transform back = motion( joint, -joint.reference );
		model.parent_from_joint = lw_transform_multiply( &model.parent_from_joint, &back );
	}
	std::copy( joint.axis, joint.axis + 3, model.axis );
	model.type = !turns ? LW_JOINT_PRISMATIC : joint.limited ? LW_JOINT_REVOLUTE : LW_JOINT_CONTINUOUS;
	if ( joint.limited || !turns )
	{
		const double infinity = std::numeric_limits<double>::infinity();
		model.lower = joint.limited ? joint.lower : -infinity;
		model.upper = joint.limited ? joint.upper : infinity;
	}
	couple( joint, model );
	const bool centred = !turns || ( p[0] == 0 && p[1] == 0 && p[2] == 0 );
	append( body, model, last && centred );
	m_pending = centred ? lw_transform_identity() : shiftBy( -p[0], -p[1], -p[2] );
}

void LinkWriter::add( const Body& body, const std::string& parent )
{
	m_parent = parent;
	m_pending = body.pose;
	for ( const Joint& joint : body.joints )
	{
		addJoint( body, joint, &joint == &body.joints.back() );
	}
	if ( body.joints.empty() || !isIdentity( m_pending ) )
	{
		JointModel fixed;
		fixed.name = freshJoint( body.name + "/fixed" );
		fixed.parent_from_joint = m_pending;
		append( body, fixed, true );
	}
}

} // namespace

JointNames namesOf( const Joint& joint )
{
	return joint.type == Joint::BALL ? JointNames{ { joint.name + "_x", joint.name + "_y", joint.name + "_z" } }
	                                 : JointNames{ { joint.name } };
}

void addLinks( const Document& document, const Tree& tree, const Couplings& couplings, RobotModel& model )
{
	LinkModel world;
	world.name = tree.bodies[0].name;
	model.links.push_back( world );
	LinkWriter writer( document, couplings, model );
	for ( const Body& body : tree.bodies )
	{
		writer.reserve( body.name );
	}
	for ( std::size_t i = 1; i < tree.bodies.size(); ++i )
	{
		writer.add( tree.bodies[i], tree.bodies[tree.bodies[i].parent].name );
	}
}

} // namespace leeway::io::detail::mjcf
