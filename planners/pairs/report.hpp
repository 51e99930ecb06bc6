// SPDX-License-Identifier: BSD-3-Clause
// Pairs of links as JSON: the files of `leeway pairs` and `leeway info`, and what the Python package returns.
#pragma once

#include "leeway/pairs/analysis.hpp"
#include "leeway/pairs/hierarchy.hpp"
#include "leeway/pairs/required.hpp"
#include "motions/json.hpp"

namespace leeway::pairs
{

using motions::Json;

Json hierarchyJson( const io::LoadedReach& hulls );
Json pairClassJson( const io::LoadedReach& tables );
Json requiredJson( const Required& required );

/// Adds "near" and "usability". @param srdf may be null
void addUse(
    Json& json, const PairTable& table, const ContactSamples& samples, const io::RobotModel& model, const NewSrdf* srdf );

Json toJson( const Analysis& analysis, const io::RobotModel& model, const Settings& settings );

} // namespace leeway::pairs
