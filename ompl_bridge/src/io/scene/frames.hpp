// SPDX-License-Identifier: BSD-3-Clause
// Frames of a problem by name: links of the robot, the planning frame, the scene's fixed frames.
#pragma once

#include "leeway/io/model.hpp"

#include <map>
#include <string>
#include <utility>
#include <vector>

namespace leeway::io::detail
{

/// Poses of frames in the planning frame: links at the reference state, then the scene's fixed frames.
class Frames
{
public:
	/// @param q [robot variable_count]
	/// @param scene may be nullptr
	Frames( const RobotModel& model, const lw_robot* robot, const std::vector<double>& q, const SceneModel* scene,
	    std::vector<Notice>& notices );
	/// @param wanted_by the file and element that name the frame, for the error
	lw_transform planningFrom( const std::string& name, const std::string& file, const std::string& wanted_by ) const;
	/// All frames except the robot's links. A fixed frame that hangs on an unknown frame, or on itself, is absent.
	std::map<std::string, Frame> fixed() const;

private:
	enum class Found
	{
		yes,
		unknown,
		cycle
	};
	/// @param name on failure the name of the unknown frame
	Found find( std::string& name, Frame& out ) const;
	bool isPlanning( const std::string& name ) const;
	std::vector<std::string> known() const;

	const RobotModel& m_model;
	const lw_robot* m_robot;
	std::vector<lw_transform> m_links;
	std::map<std::string, std::pair<std::string, lw_transform>> m_fixed; ///< frame -> parent, pose
};

} // namespace leeway::io::detail
