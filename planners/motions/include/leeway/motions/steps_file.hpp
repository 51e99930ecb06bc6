// SPDX-License-Identifier: BSD-3-Clause
// A sequence of trajectories with changes of the world in between, as YAML.
#pragma once

#include <string>
#include <vector>

namespace leeway::motions
{

struct Step
{
	enum class Kind
	{
		trajectory, ///< is driven
		attach,     ///< the object hangs on the link from now on, where it is
		release,    ///< the object stays where it is
		allow,      ///< the link, or an attached object, may touch the object
		forbid      ///< no longer
	};
	Kind kind = Kind::trajectory;
	std::string element;      ///< its place in the file
	std::string file;         ///< trajectory: beside the file of the steps, unless absolute
	std::string object, link; ///< of the others
	std::vector<std::string> touch_links;
};

/// A map with the list `steps`; each of them is one of
///     trajectory: FILE
///     attach: OBJECT, link: LINK, touch_links: [LINK, ...]
///     release: OBJECT
///     allow: [LINK, OBJECT]
///     forbid: [LINK, OBJECT]
/// @throws io::Error, also if no step is a trajectory
std::vector<Step> readSteps( const std::string& file );

} // namespace leeway::motions
