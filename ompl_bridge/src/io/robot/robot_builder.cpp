// SPDX-License-Identifier: BSD-3-Clause
// The core's robot from a model: names become indices.
#include "base/io_internal.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace leeway::io::detail
{

namespace
{

/// Collects the arrays of a lw_robot_def; they point into the model and into this.
class RobotBuilder
{
public:
	explicit RobotBuilder( const RobotModel& model ) : m_model( model ) {}
	void addLink( const std::string& name, const std::vector<PlacedShape>& shapes );
	void addJoint( const JointModel& joint );
	void allow( const std::string& a, const std::string& b ) { m_pairs.push_back( { m_links.at( a ), m_links.at( b ) } ); }
	Robot create() const;

private:
	std::uint32_t linkOf( const std::string& joint, const std::string& link ) const;
	std::uint32_t mimicOf( const JointModel& joint ) const;

	const RobotModel& m_model;
	std::vector<const char*> m_names;
	std::map<std::string, std::uint32_t> m_links;
	std::vector<lw_body_def> m_bodies;
	std::vector<lw_joint_def> m_joints;
	std::vector<lw_link_pair> m_pairs;
};

void RobotBuilder::addLink( const std::string& name, const std::vector<PlacedShape>& shapes )
{
	std::uint32_t index = static_cast<std::uint32_t>( m_names.size() );
	m_links.emplace( name, index );
	m_names.push_back( name.c_str() );
	for ( const PlacedShape& shape : shapes )
	{
		if ( isUnbounded( shape ) )
		{
			continue; // buildProblem() makes an obstacle of it
		}
		m_bodies.push_back( { shape.shape.get(), index, shape.pose } );
	}
}

std::uint32_t RobotBuilder::linkOf( const std::string& joint, const std::string& link ) const
{
	auto found = m_links.find( link );
	if ( found == m_links.end() )
	{
		throw Error( m_model.urdf_file, "joint " + joint, fmt::format( "there is no link {}", link ), "define it" );
	}
	return found->second;
}

/// Index of the joint that drives this one: that of the model, because all its joints are added in order.
std::uint32_t RobotBuilder::mimicOf( const JointModel& joint ) const
{
	if ( joint.mimic.empty() )
	{
		return LW_INVALID_INDEX;
	}
	auto found = std::find_if(
	    m_model.joints.begin(), m_model.joints.end(), [&]( const JointModel& other ) { return other.name == joint.mimic; } );
	if ( found == m_model.joints.end() )
	{
		throw Error( m_model.urdf_file, "joint " + joint.name,
		    fmt::format( "mimics joint {}, which is not defined", joint.mimic ), "correct the name" );
	}
	return static_cast<std::uint32_t>( found - m_model.joints.begin() );
}

void RobotBuilder::addJoint( const JointModel& joint )
{
	lw_joint_def def = lw_joint_def_default();
	def.name = joint.name.c_str();
	def.type = joint.type;
	def.parent = linkOf( joint.name, joint.parent );
	def.child = linkOf( joint.name, joint.child );
	def.parent_from_joint = joint.parent_from_joint;
	std::copy( joint.axis, joint.axis + 3, def.axis );
	def.lower = joint.lower;
	def.upper = joint.upper;
	def.mimic = mimicOf( joint );
	def.mimic_multiplier = joint.mimic_multiplier;
	def.mimic_offset = joint.mimic_offset;
	m_joints.push_back( def );
}

Robot RobotBuilder::create() const
{
	lw_robot_def def = lw_robot_def_default();
	def.name = m_model.name.c_str();
	def.link_names = m_names.data();
	def.link_count = static_cast<std::uint32_t>( m_names.size() );
	def.joints = m_joints.data();
	def.joint_count = static_cast<std::uint32_t>( m_joints.size() );
	def.bodies = m_bodies.data();
	def.body_count = static_cast<std::uint32_t>( m_bodies.size() );
	def.allowed_pairs = m_pairs.data();
	def.allowed_pair_count = static_cast<std::uint32_t>( m_pairs.size() );
	lw_robot* robot = nullptr;
	lw_diag diag{};
	lw_status status = lw_robot_create( &def, nullptr, &diag, &robot );
	if ( status != LW_OK )
	{
		throw Error( m_model.urdf_file, "robot " + m_model.name,
		    diag.message[0] != '\0' ? diag.message : lw_status_name( status ), "correct the URDF" );
	}
	return Robot::adopt( robot );
}

} // namespace

Robot createRobot( const RobotModel& model, const std::vector<std::pair<std::string, std::string>>& allowed )
{
	RobotBuilder builder( model );
	for ( const LinkModel& link : model.links )
	{
		builder.addLink( link.name, link.collision );
	}
	for ( const JointModel& joint : model.joints )
	{
		builder.addJoint( joint );
	}
	for ( const auto& [a, b] : allowed )
	{
		builder.allow( a, b );
	}
	return builder.create();
}

} // namespace leeway::io::detail
