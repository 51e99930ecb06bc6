// SPDX-License-Identifier: BSD-3-Clause
// --joint-limits: see limits_file.hpp.
#include "commands/limits_file.hpp"

#include "leeway/motions/motion_files.hpp"
#include "motions/names.hpp"

namespace leeway::cli
{

JointLimits limitsOfFile( const std::string& file )
{
	JointLimits limits;
	if ( !file.empty() )
	{
		limits = readJointLimits( file );
		readsFile( "--joint-limits", file );
	}
	return limits;
}

void note( JointLimits& limits, const std::string& file, const io::RobotModel& robot, Notices& notices )
{
	noteUnknownLimits( limits, file, robot, limits.notices );
	notices.add( "joint limits of the file", limits.notices );
}

void noteUsual( const MotionLimits& limits, Notices& notices )
{
	if ( !limits.usual.empty() )
	{
		notices.add( "accelerations",
		    fmt::format( "no acceleration limit of {}: {:g} (rad/s^2 or m/s^2) is kept; --joint-limits sets others",
		        listed( limits.usual ), default_acceleration ) );
	}
	if ( !limits.usual_jerk.empty() )
	{
		notices.add( "jerks", fmt::format( "no jerk limit of {}: {:g} times that of the acceleration, per second, is kept; "
		                                   "--joint-limits sets others",
		                          listed( limits.usual_jerk ), default_jerk ) );
	}
}

} // namespace leeway::cli
