// SPDX-License-Identifier: BSD-3-Clause
// The hierarchy of a robot for `leeway info`: the reach of each link and its subtree.
#pragma once

#include "leeway/io/model.hpp"

#include <string>

namespace leeway::pairs
{

/// Settings of motion hulls without proofs of pairs.
io::ReachOptions hullsOnly();
/// The motion hulls of a problem, else new ones of its robot. @throws io::Error, CoreError
io::LoadedReach findHulls( const io::Problem& problem, const io::ReachOptions& options = hullsOnly() );

std::string hierarchyText( const io::LoadedReach& hulls );

/// Pairs of each class.
std::string pairClassText( const io::LoadedReach& tables );

} // namespace leeway::pairs
