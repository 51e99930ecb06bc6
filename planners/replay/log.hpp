// SPDX-License-Identifier: BSD-3-Clause
// The sights of a robot's sensors while it drove, as lines of JSON. Format: planners/README.md, "guard".
#pragma once

#include "leeway/cloud.h"
#include "leeway/io/model.hpp"

#include <string>
#include <utility>
#include <vector>

namespace leeway::replay
{

/// One line.
struct Event
{
	enum class Kind
	{
		world,  ///< objects that come, go and move
		people, ///< all of them: they replace those before
		cloud,  ///< begins the live cloud "cloud"; it comes first
		frame,  ///< of a sensor, for the cloud
		attach, ///< the object hangs on the link from now on, where it is
		release ///< the object stays where it is
	};
	Kind kind = Kind::world;
	std::string element;                  ///< "line 12"
	double time = 0;                      ///< seconds on the trajectory's clock, at which the guard was told
	double seen = 0;                      ///< when the sensor saw it; `time` if the line does not say
	std::vector<io::SceneObject> objects; ///< of world: come, in the place of those of their names; of people: all
	std::vector<std::string> removed;
	std::vector<std::pair<std::string, lw_transform>> moved; ///< world_from_object
	lw_cloud_def cloud = lw_cloud_def_default();
	lw_cloud_frame frame = lw_cloud_frame_default(); ///< without data, robot and state
	std::vector<float> measured;                     ///< depths by rows, or points x, y, z of the sensor's frame; metres
	std::string object, link;                        ///< of attach and release
	std::vector<std::string> touch_links;
};

struct Log
{
	std::string file;
	std::vector<Event> events;
	std::vector<io::Notice> notices; ///< of shapes, each text once
};

/// @param options for meshes @throws io::Error that names file, line and key
Log readLog( const std::string& file, const io::LoadOptions& options );

} // namespace leeway::replay
