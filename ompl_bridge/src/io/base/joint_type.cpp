// SPDX-License-Identifier: BSD-3-Clause
#include "leeway/io/joint_type.hpp"

namespace leeway::io
{

const char* jointTypeName( lw_joint_type type )
{
	switch ( type )
	{
	case LW_JOINT_FIXED:
		return "fixed";
	case LW_JOINT_REVOLUTE:
		return "revolute";
	case LW_JOINT_CONTINUOUS:
		return "continuous";
	case LW_JOINT_PRISMATIC:
		return "prismatic";
	case LW_JOINT_PLANAR:
		return "planar";
	case LW_JOINT_FLOATING:
		return "floating";
	}
	return "";
}

} // namespace leeway::io
