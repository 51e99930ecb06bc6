// SPDX-License-Identifier: BSD-3-Clause
#include "robot/urdf_writer.hpp"

#include "leeway/io/joint_type.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstring>

namespace leeway::io::detail
{

namespace
{

using tinyxml2::XMLElement;

std::string three( double x, double y, double z )
{
	return fmt::format( "{} {} {}", x, y, z );
}

/// Roll, pitch and yaw of a rotation: Rz( yaw ) Ry( pitch ) Rx( roll ).
std::string rpyOf( const lw_transform& m )
{
	const double level = std::hypot( m.r[0][0], m.r[1][0] );
	const double pitch = std::atan2( -m.r[2][0], level );
	if ( level < 1e-12 ) // upright: roll and yaw turn about one axis
	{
		return three( std::atan2( -m.r[1][2], m.r[1][1] ), pitch, 0 );
	}
	return three( std::atan2( m.r[2][1], m.r[2][2] ), pitch, std::atan2( m.r[1][0], m.r[0][0] ) );
}

XMLElement* add( XMLElement& parent, const char* name )
{
	return parent.InsertNewChildElement( name );
}

void setNumber( XMLElement& element, const char* name, double value )
{
	element.SetAttribute( name, fmt::format( "{}", value ).c_str() );
}

void addJoint( XMLElement& root, const JointModel& joint )
{
	XMLElement* const out = add( root, "joint" );
	out->SetAttribute( "name", joint.name.c_str() );
	out->SetAttribute( "type", jointTypeName( joint.type ) );
	XMLElement* const origin = add( *out, "origin" );
	const lw_transform& pose = joint.parent_from_joint;
	origin->SetAttribute( "xyz", three( pose.t[0], pose.t[1], pose.t[2] ).c_str() );
	origin->SetAttribute( "rpy", rpyOf( pose ).c_str() );
	add( *out, "parent" )->SetAttribute( "link", joint.parent.c_str() );
	add( *out, "child" )->SetAttribute( "link", joint.child.c_str() );
	if ( joint.type != LW_JOINT_FIXED && joint.type != LW_JOINT_FLOATING )
	{
		add( *out, "axis" )->SetAttribute( "xyz", three( joint.axis[0], joint.axis[1], joint.axis[2] ).c_str() );
	}
	if ( joint.type == LW_JOINT_REVOLUTE || joint.type == LW_JOINT_PRISMATIC )
	{
		XMLElement* const limit = add( *out, "limit" );
		// a rail without limits
		constexpr double none = 1e9;
		setNumber( *limit, "lower", std::isfinite( joint.lower ) ? joint.lower : -none );
		setNumber( *limit, "upper", std::isfinite( joint.upper ) ? joint.upper : none );
		setNumber( *limit, "effort", 0 );
		setNumber( *limit, "velocity", joint.velocity );
		for ( const auto& [name, value] :
		    { std::pair( "acceleration", joint.acceleration ), std::pair( "jerk", joint.jerk ) } )
		{
			if ( value > 0 )
			{
				setNumber( *limit, name, value );
			}
		}
	}
	if ( !joint.mimic.empty() )
	{
		XMLElement* const mimic = add( *out, "mimic" );
		mimic->SetAttribute( "joint", joint.mimic.c_str() );
		setNumber( *mimic, "multiplier", joint.mimic_multiplier );
		setNumber( *mimic, "offset", joint.mimic_offset );
	}
}

} // namespace

bool isPlainUrdf( const XmlFile& file )
{
	const XMLElement* const root = file.document().RootElement();
	return root != nullptr && std::strcmp( root->Name(), "robot" ) == 0 && root->Attribute( "xmlns:xacro" ) == nullptr;
}

void describe( const RobotModel& model, tinyxml2::XMLDocument& out )
{
	out.Clear();
	out.InsertEndChild( out.NewDeclaration() );
	XMLElement* const root = out.NewElement( "robot" );
	root->SetAttribute( "name", model.name.c_str() );
	out.InsertEndChild( root );
	const bool has_frame = model.planning_frame != model.root_link; // of a virtual joint
	for ( const LinkModel& link : model.links )
	{
		if ( !has_frame || link.name != model.planning_frame )
		{
			add( *root, "link" )->SetAttribute( "name", link.name.c_str() );
		}
	}
	for ( const JointModel& joint : model.joints )
	{
		if ( !has_frame || joint.parent != model.planning_frame )
		{
			addJoint( *root, joint );
		}
	}
}

} // namespace leeway::io::detail
