// SPDX-License-Identifier: BSD-3-Clause
// The hierarchy of a robot for `leeway info`: the reach of each link and its subtree.
#pragma once

#include "motions/json.hpp"

namespace leeway::cli
{

/// The bench's own motion hulls, else new ones, for which no time is spent on pairs. @throws io::Error
io::LoadedReach findHulls( const Workbench& bench );

std::string hierarchyText( const io::LoadedReach& hulls );
Json hierarchyJson( const io::LoadedReach& hulls );

/// Pairs of each class.
std::string pairClassText( const io::LoadedReach& tables );
Json pairClassJson( const io::LoadedReach& tables );

} // namespace leeway::cli
