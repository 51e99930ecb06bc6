// SPDX-License-Identifier: BSD-3-Clause
// Differences between OMPL 1.5, 1.6, 1.7 and 2.0 in the parts that leeway uses, and their only place in C++. The build has one more: 1.7 and
// later export the target ompl::ompl (ompl_bridge/src/ompl/CMakeLists.txt).
#pragma once

#include <ompl/config.h>
#include <ompl/geometric/PathSimplifier.h>

namespace leeway::ompl
{

/// Shortcuts between random points of the path. PathSimplifier::shortcutPath() became partialShortcutPath() in 1.7.
inline bool shortcutPath( ::ompl::geometric::PathSimplifier& simplifier, ::ompl::geometric::PathGeometric& path,
    unsigned most_steps, unsigned most_empty_steps )
{
#if OMPL_VERSION_VALUE >= 1007000
	return simplifier.partialShortcutPath( path, most_steps, most_empty_steps );
#else
	return simplifier.shortcutPath( path, most_steps, most_empty_steps );
#endif
}

} // namespace leeway::ompl
