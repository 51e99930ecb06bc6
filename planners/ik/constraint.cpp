// SPDX-License-Identifier: BSD-3-Clause
// One position or orientation constraint as geometry: its excess, and errors to reduce.
#include "ik/constraint.hpp"

namespace leeway::ik
{
namespace
{

using Type = io::GoalRegion::Type;

// Below both a random target is as good as any.
constexpr double tight_metres = 0.005, tight_radians = 0.02;
// Metres, radians: a part of an error below this has no direction.
constexpr double no_direction = 1e-12;
// Where the cosine of the pitch is below this, roll and yaw turn about the same axis.
constexpr double gimbal_cosine = 1e-9;

/// The nearest point of a region shrunk by `share`, in the frame of the region.
Vector3d nearest( const io::GoalRegion& region, const Vector3d& p, double share )
{
	const std::array<double, 3>& size = region.size;
	if ( region.type == Type::Box )
	{
		const Vector3d half = 0.5 * share * Vector3d( size[0], size[1], size[2] );
		return p.cwiseMax( -half ).cwiseMin( half );
	}
	if ( region.type == Type::Sphere )
	{
		const double length = p.norm(), radius = share * size[0];
		return length > radius ? Vector3d( radius / length * p ) : p;
	}
	const double radius = share * size[0], half = 0.5 * share * size[1], length = p.head<2>().norm();
	Vector3d result = p;
	if ( length > radius )
	{
		result.head<2>() *= radius / length;
	}
	result.z() = std::clamp( p.z(), -half, half );
	return result;
}

Vector3d randomPoint( const io::GoalRegion& region, Random& random )
{
	const std::array<double, 3>& size = region.size;
	const double share = inner_share;
	Vector3d p;
	if ( region.type == Type::Box )
	{
		for ( int i = 0; i < 3; ++i )
		{
			p[i] = random.between( -0.5, 0.5 ) * share * size[std::size_t( i )];
		}
		return p;
	}
	do // in the ball, or the disk
	{
		for ( int i = 0; i < 3; ++i )
		{
			p[i] = random.between( -1, 1 );
		}
	} while ( region.type == Type::Sphere ? p.squaredNorm() > 1 : p.head<2>().squaredNorm() > 1 );
	return region.type == Type::Sphere
	           ? Vector3d( share * size[0] * p )
	           : Vector3d( share * size[0] * p.x(), share * size[0] * p.y(), 0.5 * share * size[1] * p.z() );
}

/// The projection onto the directions in which a point has left the region, `to_p` from its nearest point: the normals of
/// its surface there.
Matrix3d normals( const io::GoalRegion& region, const Vector3d& to_p )
{
	Matrix3d projection = Matrix3d::Zero();
	const auto add = [&]( const Vector3d& direction )
	{
		const double length = direction.norm();
		if ( length > no_direction )
		{
			projection += direction * direction.transpose() / ( length * length );
		}
	};
	if ( region.type == Type::Sphere && region.size[0] > 0 )
	{
		add( to_p );
	}
	else if ( region.type == Type::Cylinder && region.size[0] > 0 )
	{
		add( { to_p.x(), to_p.y(), 0 } );
		add( { 0, 0, to_p.z() } );
	}
	else // axis by axis; a point, or a cylinder that is a segment
	{
		const bool segment = region.type == Type::Cylinder, point = region.type == Type::Sphere;
		for ( int i = 0; i < 3; ++i )
		{
			const bool always = point || ( segment && i < 2 );
			projection( i, i ) = always || std::fabs( to_p[i] ) > no_direction ? 1 : 0;
		}
	}
	return projection;
}

Vector3d eulerXyz( const Matrix3d& r )
{
	const double cosine = std::hypot( r( 0, 0 ), r( 0, 1 ) ), pitch = std::atan2( r( 0, 2 ), cosine );
	if ( cosine > gimbal_cosine )
	{
		return { std::atan2( -r( 1, 2 ), r( 2, 2 ) ), pitch, std::atan2( -r( 0, 1 ), r( 0, 0 ) ) };
	}
	return { std::atan2( r( 2, 1 ), r( 1, 1 ) ), pitch, 0 }; // only the sum of roll and yaw, or their difference, is known
}

Matrix3d fromEulerXyz( const Vector3d& angles )
{
	return ( Eigen::AngleAxisd( angles.x(), Vector3d::UnitX() ) * Eigen::AngleAxisd( angles.y(), Vector3d::UnitY() ) *
	         Eigen::AngleAxisd( angles.z(), Vector3d::UnitZ() ) )
	    .toRotationMatrix();
}

} // namespace

// ---- positions

Vector3d PositionConstraint::point( const Pose& link ) const
{
	return link * Vector3d( m_goal.offset[0], m_goal.offset[1], m_goal.offset[2] );
}

Vector3d PositionConstraint::inRegion( const io::GoalRegion& region, const Pose& link, const Pose& frame ) const
{
	return inverse( frame * toPose( region.pose ) ) * point( link );
}

double PositionConstraint::excess( const Pose& link, const Pose& frame ) const
{
	double least = HUGE_VAL;
	for ( const io::GoalRegion& region : m_goal.regions )
	{
		const Vector3d p = inRegion( region, link, frame );
		least = std::min( least, ( p - nearest( region, p, 1 ) ).norm() );
	}
	return least;
}

void PositionConstraint::draw( Random& random )
{
	m_region = random.below( m_goal.regions.size() );
	m_target = randomPoint( m_goal.regions[m_region], random );
}

ConstraintError PositionConstraint::toTarget( const Pose& link, const Pose& frame ) const
{
	const io::GoalRegion& region = m_goal.regions[m_region];
	return { inRegion( region, link, frame ) - m_target, ( frame.r * toPose( region.pose ).r ).transpose() };
}

ConstraintError PositionConstraint::toNearest( const Pose& link, const Pose& frame ) const
{
	const io::GoalRegion& region = m_goal.regions[m_region];
	const Vector3d p = inRegion( region, link, frame ), to_p = p - nearest( region, p, inner_share );
	return { to_p, normals( region, to_p ) * ( frame.r * toPose( region.pose ).r ).transpose() };
}

bool PositionConstraint::isTight() const
{
	bool tight = m_goal.regions.size() == 1;
	for ( const io::GoalRegion& region : m_goal.regions )
	{
		tight = tight && std::max( { region.size[0], region.size[1], region.size[2] } ) < tight_metres;
	}
	return tight;
}

// ---- orientations

OrientationConstraint::OrientationConstraint( const io::OrientationGoal& goal )
    : m_goal( goal ),
      m_wanted( Eigen::Quaterniond( goal.quaternion[3], goal.quaternion[0], goal.quaternion[1], goal.quaternion[2] )
                    .normalized()
                    .toRotationMatrix() )
{
	for ( int i = 0; i < 3; ++i )
	{
		const double largest = isEuler() && i == 1 ? pi / 2 : pi;
		const bool free = goal.tolerance[std::size_t( i )] >= largest;
		m_bound[i] = free ? largest : goal.tolerance[std::size_t( i )];
		m_inner[i] = free ? largest : inner_share * m_bound[i];
	}
}

Matrix3d OrientationConstraint::deviation( const Pose& link, const Pose& frame ) const
{
	return m_wanted.transpose() * frame.r.transpose() * link.r;
}

Vector3d OrientationConstraint::angles( const Matrix3d& deviation ) const
{
	if ( !isEuler() )
	{
		return logarithm( deviation );
	}
	Vector3d result = eulerXyz( deviation );
	if ( std::hypot( deviation( 0, 0 ), deviation( 0, 1 ) ) <= gimbal_cosine )
	{
		// roll and yaw share one turn: yaw takes the part that roll's tolerance does not
		const double roll = std::clamp( result.x(), -m_bound.x(), m_bound.x() );
		result.z() = ( result.y() > 0 ? 1 : -1 ) * wrapped( result.x() - roll );
		result.x() = roll;
	}
	return result;
}

Matrix3d OrientationConstraint::rotation( const Vector3d& angles ) const
{
	return isEuler() ? fromEulerXyz( angles ) : exponential( angles );
}

/// Column i: the angular velocity, in the frame of the link, of angle i.
Matrix3d OrientationConstraint::turnsOfAngles( const Vector3d& angles ) const
{
	return isEuler() ? turnsOfEulerXyz( angles ) : rightJacobian( angles );
}

double OrientationConstraint::excess( const Pose& link, const Pose& frame ) const
{
	const Vector3d angle = angles( deviation( link, frame ) );
	return std::max( 0.0, ( angle.cwiseAbs() - m_bound ).maxCoeff() );
}

void OrientationConstraint::draw( Random& random )
{
	Vector3d angle;
	do // a rotation vector is at most half a turn long
	{
		for ( int i = 0; i < 3; ++i )
		{
			angle[i] = random.between( -1, 1 ) * m_inner[i];
		}
	} while ( !isEuler() && angle.norm() > pi );
	m_target = rotation( angle );
}

ConstraintError OrientationConstraint::toTarget( const Pose& link, const Pose& frame ) const
{
	const Vector3d error = logarithm( m_target.transpose() * deviation( link, frame ) );
	return { error, inverseRightJacobian( error ) * link.r.transpose() };
}

ConstraintError OrientationConstraint::toNearest( const Pose& link, const Pose& frame ) const
{
	const Matrix3d turned = deviation( link, frame );
	const Vector3d angle = angles( turned ), inside = angle.cwiseMax( -m_inner ).cwiseMin( m_inner );
	const Vector3d error = logarithm( rotation( inside ).transpose() * turned );
	// Turns that change angles inside of their tolerances are free
	const Matrix3d turns = turnsOfAngles( inside );
	Matrix3d projection = Matrix3d::Identity();
	for ( int i = 0; i < 3; ++i )
	{
		const Vector3d direction = projection * turns.col( i );
		if ( std::fabs( angle[i] ) <= m_inner[i] && m_inner[i] > 0 && direction.norm() > 1e-3 )
		{
			projection -= direction * direction.transpose() / direction.squaredNorm();
		}
	}
	return { projection * error, projection * inverseRightJacobian( error ) * link.r.transpose() };
}

bool OrientationConstraint::isTight() const
{
	return m_bound.maxCoeff() < tight_radians;
}

} // namespace leeway::ik
