// SPDX-License-Identifier: BSD-3-Clause
// Small arms that follow lines, and the places of their tips at all times.
#pragma once

#include "pose_world.hpp"

#include "leeway/lines/lines.hpp"

#include <algorithm>

inline lw_transform placed( double x, double y, double z, double roll = M_PI, double pitch = 0, double yaw = 0 )
{
	const double p[3] = { x, y, z }, rpy[3] = { roll, pitch, yaw };
	lw_transform m;
	lw_transform_from_rpy( p, rpy, &m );
	return m;
}

struct LineWorld : PoseWorld
{
	lines::Task task;
	lines::Settings settings;

	explicit LineWorld( const std::string& urdf, const std::string& scene = "" ) : PoseWorld( urdf, scene )
	{
		task.tip = io::findFrame( problem, "hand", "test", "tip" );
		task.any_start = true;
		settings.edge.flags = LW_CHECK_ENVIRONMENT;
		settings.limits = motions::motionLimits( problem, robot, {} );
	}

	lines::Result plan() const { return lines::planLines( robot, problem, task, settings ); }

	/// The tip in the base, by the kinematics of the core.
	lw_transform tip( const Vector& q ) const
	{
		Vector full = problem.reference;
		for ( std::size_t i = 0; i < q.size(); ++i )
		{
			full[problem.variables[i]] = q[i];
		}
		std::vector<lw_transform> links( lw_robot_link_count( problem.robot.get() ) );
		EXPECT_EQ( LW_OK, lw_robot_fk( problem.robot.get(), full.data(), links.data() ) );
		const lw_transform world = lw_transform_multiply( &links[task.tip.link], &task.tip.pose );
		if ( task.base.link == LW_INVALID_INDEX )
		{
			return world;
		}
		const lw_transform base = lw_transform_multiply( &links[task.base.link], &task.base.pose ),
		                   back = lw_transform_inverse( &base );
		return lw_transform_multiply( &back, &world );
	}

	/// Positions and angles are within the proved errors at 100 times of each cubic; joints are within limits, and go on without a jump.
	void expectOnItsWay( const lines::Result& r ) const
	{
		ASSERT_TRUE( r.solved ) << lines::describe( problem, r );
		EXPECT_LE( r.position_error, task.tolerance );
		EXPECT_LE( r.angle_error, task.angle );
		double worst = 0, worst_angle = 0;
		for ( const lines::Part& part : r.parts )
		{
			for ( std::size_t k = part.first; k < part.first + part.count; ++k )
			{
				for ( int i = 0; i <= 100; ++i )
				{
					const motions::Segment& s = r.segments[k];
					const double time = s.begin + s.seconds * i / 100;
					const Vector q = motions::stateAt( r.segments, time );
					const lw_transform is = tip( q ), wanted = part.wanted( time );
					for ( int x = 0; x < 3; ++x )
					{
						worst = std::max( worst, std::fabs( is.t[x] - wanted.t[x] ) );
					}
					worst_angle = std::max( worst_angle, angleOf( is, wanted ) );
					EXPECT_TRUE( io::limitViolations( problem, q ).empty() );
				}
			}
		}
		EXPECT_LE( worst, r.position_error * 1.8 + 1e-12 ); // coordinates of the world, not of the reference
		EXPECT_LE( worst_angle, r.angle_error + 1e-9 );
		EXPECT_GT( worst, 0.01 * r.position_error );
		for ( std::size_t k = 1; k < r.segments.size(); ++k )
		{
			const motions::Segment &a = r.segments[k - 1], &b = r.segments[k];
			EXPECT_NEAR( a.begin + a.seconds, b.begin, 1e-12 );
			for ( std::size_t v = 0; v < problem.variables.size(); ++v )
			{
				const std::size_t count = problem.variables.size();
				EXPECT_EQ( a.points[3 * count + v], b.points[v] );
				EXPECT_NEAR( ( a.points[3 * count + v] - a.points[2 * count + v] ) / a.seconds,
				    ( b.points[count + v] - b.points[v] ) / b.seconds, 1e-9 ); // speeds
			}
		}
	}

private:
	/// The angle, or the tilt of the free axis.
	double angleOf( const lw_transform& is, const lw_transform& wanted ) const
	{
		const lw_transform back = lw_transform_inverse( &wanted ), turn = lw_transform_multiply( &back, &is );
		if ( task.free_axis )
		{
			const double axis[3] = { task.free_axis->x, task.free_axis->y, task.free_axis->z };
			double dot = 0, square = 0;
			for ( int i = 0; i < 3; ++i )
			{
				for ( int k = 0; k < 3; ++k )
				{
					dot += axis[i] * turn.r[i][k] * axis[k];
				}
				square += axis[i] * axis[i];
			}
			return std::acos( std::min( 1.0, dot / square ) );
		}
		double q[4];
		lw_transform_to_quaternion( &turn, q );
		return 2 * std::atan2( std::sqrt( q[0] * q[0] + q[1] * q[1] + q[2] * q[2] ), q[3] );
	}
};
