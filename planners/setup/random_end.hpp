// SPDX-License-Identifier: BSD-3-Clause
// A free state of a robot at random, for first tries: --start random, --goal random.
#pragma once

#include "setup/setup.hpp"

#include <string>

namespace leeway::cli
{

/// Values of the group's joints, the same for the same seed on every machine: uniform within the limits; joints without limits turn once and
/// shift by a metre. Joints outside of the group are where input.request starts, or at zero.
/// @param option "--goal", for the error @param seed different for start and goal
/// @throws io::Error if none of many states is free
Values randomFreeState( const std::string& option, const Input& input, const std::string& group, std::uint64_t seed );

} // namespace leeway::cli
