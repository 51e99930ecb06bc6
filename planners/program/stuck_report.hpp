// SPDX-License-Identifier: BSD-3-Clause
// Reasons of a plan without a path, as lines and as JSON.
#pragma once

#include "motions/json.hpp"
#include "program/setup.hpp"

#include "leeway/planners/stuck.hpp"

namespace leeway::cli
{

/// At most seven lines "leeway:   ...\n"; empty if there was no search to explain.
std::string stuckLines( const Workbench& bench, const planners::Stuck& stuck );

Json toJson( const Workbench& bench, const planners::Stuck& stuck );

} // namespace leeway::cli
