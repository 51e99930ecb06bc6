// SPDX-License-Identifier: BSD-3-Clause
// The joints by which a group moves certain frames: their poses, and the Jacobians of points on them.
#include "ik/chain.hpp"

#include <algorithm>

namespace leeway::ik
{
namespace
{

/// Two axes of the plane normal to z, as the core has them (Duff et al., Building an Orthonormal Basis, Revisited, 2017).
void planeAxes( const Vector3d& z, Vector3d& x, Vector3d& y )
{
	const double sign = std::copysign( 1.0, z.z() ), a = -1 / ( sign + z.z() ), b = z.x() * z.y() * a;
	x = { 1 + sign * z.x() * z.x() * a, sign * b, -sign * z.x() };
	y = { b, sign + z.y() * z.y() * a, -z.y() };
}

bool turns( lw_joint_type type )
{
	return type == LW_JOINT_REVOLUTE || type == LW_JOINT_CONTINUOUS;
}

int freedomCount( lw_joint_type type )
{
	return type == LW_JOINT_PLANAR ? 3 : type == LW_JOINT_FLOATING ? 6 : 1;
}

} // namespace

Chain::Chain( const io::RobotModel& model, const io::Problem& problem )
    : m_robot( problem.robot.get() ), m_entry( lw_robot_variable_count( m_robot ), -1 ),
      m_reference( lw_robot_link_count( m_robot ) )
{
	for ( const io::JointModel& joint : model.joints )
	{
		m_models[joint.name] = &joint;
	}
	for ( std::size_t i = 0; i < problem.variables.size(); ++i )
	{
		m_entry[problem.variables[i]] = static_cast<int>( i );
	}
	require( lw_robot_fk( m_robot, problem.reference.data(), m_reference.data() ), "kinematics of the reference state" );
	findFreedoms( problem );
}

void Chain::findFreedoms( const io::Problem& problem )
{
	m_first_freedom.assign( problem.variables.size(), -1 );
	for ( std::uint32_t i = 0; i < problem.variables.size(); ++i )
	{
		const lw_variable_info info = lw_robot_variable( m_robot, problem.variables[i] );
		const bool quaternion = lw_robot_joint_type( m_robot, info.joint ) == LW_JOINT_FLOATING && info.component >= 3;
		m_first_freedom[i] = static_cast<int>( m_freedoms.size() );
		if ( !quaternion )
		{
			m_freedoms.push_back( { i, -1 } );
		}
		else if ( info.component == 3 )
		{
			for ( int axis = 0; axis < 3; ++axis )
			{
				m_freedoms.push_back( { i, axis } );
			}
		}
	}
	m_moves.assign( m_freedoms.size(), false );
}

const io::JointModel* Chain::model( std::uint32_t joint ) const
{
	const auto found = m_models.find( lw_robot_joint_name( m_robot, joint ) );
	return found == m_models.end() ? nullptr : found->second;
}

ChainFrame Chain::add( const io::Frame& frame )
{
	ChainFrame result;
	result.pose = toPose( frame.pose );
	if ( frame.link == LW_INVALID_INDEX )
	{
		return result;
	}
	std::uint32_t link = frame.link;
	while ( result.joint < 0 )
	{
		const std::uint32_t joint = lw_robot_link_joint( m_robot, link );
		if ( joint == LW_INVALID_INDEX )
		{
			result.pose = toPose( m_reference[link] ) * result.pose;
			return result;
		}
		result.joint = addJoint( joint, result.pose );
		link = lw_robot_joint_parent( m_robot, joint );
	}
	return result;
}

std::vector<bool> Chain::movesBetween( const ChainFrame& a, const ChainFrame& b ) const
{
	std::vector<int> paths( m_joints.size(), 0 ); // 1: to one of them; 2: to both
	for ( const ChainFrame* frame : { &a, &b } )
	{
		for ( int i = frame->joint; i >= 0; i = m_joints[std::size_t( i )].parent )
		{
			++paths[std::size_t( i )];
		}
	}
	std::vector<bool> moves( m_freedoms.size(), false );
	for ( std::size_t i = 0; i < m_joints.size(); ++i )
	{
		if ( paths[i] == 1 )
		{
			std::fill_n( moves.begin() + m_joints[i].freedom, freedomCount( m_joints[i].type ), true );
		}
	}
	return moves;
}

bool Chain::wholeTurns( std::size_t freedom ) const
{
	return std::all_of( m_joints.begin(), m_joints.end(),
	    [&]( const Joint& joint )
	    {
		    const int k = static_cast<int>( freedom ) - joint.freedom;
		    const bool of_plane = joint.type == LW_JOINT_PLANAR && k <= 2;
		    const bool one = turns( joint.type ) && joint.multiplier == std::round( joint.multiplier );
		    return k < 0 || k >= freedomCount( joint.type ) || ( of_plane ? k == 2 : k == 0 && one );
	    } );
}

/// A moving joint is added, with those above it, and its index returned. Of a joint at rest the motion goes into `rest`,
/// and -1 is returned.
int Chain::addJoint( std::uint32_t joint, Pose& rest )
{
	const auto known = m_known.find( joint );
	if ( known != m_known.end() )
	{
		return known->second;
	}
	const io::JointModel* const description = model( joint );
	if ( description == nullptr && !lw_robot_is_attached( m_robot, lw_robot_joint_child( m_robot, joint ) ) )
	{
		throw io::Error( "robot", lw_robot_joint_name( m_robot, joint ), "the model has no such joint",
		    "give the model that the problem was built from" );
	}
	const std::uint32_t followed = lw_robot_joint_mimic( m_robot, joint );
	const std::uint32_t variable = lw_robot_joint_variable( m_robot, followed == LW_INVALID_INDEX ? joint : followed );
	if ( description == nullptr || variable == LW_INVALID_INDEX || m_entry[variable] < 0 )
	{
		const lw_transform parent = m_reference[lw_robot_joint_parent( m_robot, joint )];
		rest = inverse( toPose( parent ) ) * toPose( m_reference[lw_robot_joint_child( m_robot, joint )] ) * rest;
		return -1;
	}
	Joint added;
	added.type = description->type;
	added.axis = Vector3d( description->axis[0], description->axis[1], description->axis[2] ).stableNormalized();
	planeAxes( added.axis, added.plane_x, added.plane_y );
	added.variable = static_cast<std::uint32_t>( m_entry[variable] );
	added.freedom = m_first_freedom[added.variable];
	for ( const io::JointModel* at = description; !at->mimic.empty(); at = m_models.at( at->mimic ) )
	{
		added.offset += added.multiplier * at->mimic_offset;
		added.multiplier *= at->mimic_multiplier;
	}
	const ChainFrame parent = add( { lw_robot_joint_parent( m_robot, joint ), description->parent_from_joint } );
	added.parent = parent.joint;
	added.parent_from_joint = parent.pose;
	m_joints.push_back( added );
	std::fill_n( m_moves.begin() + added.freedom, freedomCount( added.type ), true );
	return m_known[joint] = static_cast<int>( m_joints.size() ) - 1;
}

void Chain::placeJoint( Joint& joint, const double* q ) const
{
	const double* const v = q + joint.variable;
	joint.world_from_joint = joint.parent < 0
	                             ? joint.parent_from_joint
	                             : m_joints[std::size_t( joint.parent )].world_from_child * joint.parent_from_joint;
	joint.world_from_child = joint.world_from_joint;
	const double value = joint.multiplier * v[0] + joint.offset;
	if ( turns( joint.type ) )
	{
		joint.world_from_child.r *= Eigen::AngleAxisd( value, joint.axis ).toRotationMatrix();
	}
	else if ( joint.type == LW_JOINT_PRISMATIC )
	{
		joint.world_from_child.t += joint.world_from_joint.r * ( value * joint.axis );
	}
	else if ( joint.type == LW_JOINT_PLANAR )
	{
		joint.world_from_child.t += joint.world_from_joint.r * ( v[0] * joint.plane_x + v[1] * joint.plane_y );
		joint.world_from_child.r *= Eigen::AngleAxisd( v[2], joint.axis ).toRotationMatrix();
	}
	else if ( joint.type == LW_JOINT_FLOATING )
	{
		joint.world_from_child.t += joint.world_from_joint.r * Vector3d( v[0], v[1], v[2] );
		joint.world_from_child.r *= Eigen::Quaterniond( v[6], v[3], v[4], v[5] ).normalized().toRotationMatrix();
	}
}

void Chain::place( const double* q )
{
	for ( Joint& joint : m_joints ) // parents come first
	{
		placeJoint( joint, q );
	}
}

Pose Chain::pose( const ChainFrame& frame ) const
{
	return frame.joint < 0 ? frame.pose : m_joints[std::size_t( frame.joint )].world_from_child * frame.pose;
}

void Chain::addJacobian( const ChainFrame& frame, const Vector3d& point, double sign, Eigen::Ref<Twists> twists ) const
{
	for ( int i = frame.joint; i >= 0; i = m_joints[std::size_t( i )].parent )
	{
		const Joint& joint = m_joints[std::size_t( i )];
		const Vector3d arm = point - joint.world_from_child.t;
		const auto slide = [&]( int freedom, const Vector3d& direction ) { twists.col( freedom ).head<3>() += direction; };
		const auto turn = [&]( int freedom, const Vector3d& axis )
		{
			twists.col( freedom ).head<3>() += axis.cross( arm );
			twists.col( freedom ).tail<3>() += axis;
		};
		const Vector3d axis = sign * joint.multiplier * ( joint.world_from_child.r * joint.axis );
		const Matrix3d before = sign * joint.world_from_joint.r;
		switch ( joint.type )
		{
		case LW_JOINT_REVOLUTE:
		case LW_JOINT_CONTINUOUS:
			turn( joint.freedom, axis );
			break;
		case LW_JOINT_PRISMATIC:
			slide( joint.freedom, axis );
			break;
		case LW_JOINT_PLANAR:
			slide( joint.freedom, before * joint.plane_x );
			slide( joint.freedom + 1, before * joint.plane_y );
			turn( joint.freedom + 2, axis );
			break;
		case LW_JOINT_FLOATING:
			for ( int k = 0; k < 3; ++k )
			{
				slide( joint.freedom + k, before.col( k ) );
				turn( joint.freedom + 3 + k, sign * joint.world_from_child.r.col( k ) );
			}
			break;
		case LW_JOINT_FIXED:
			break;
		}
	}
}

} // namespace leeway::ik
