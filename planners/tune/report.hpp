// SPDX-License-Identifier: BSD-3-Clause
// A tuning as JSON: `leeway tune --json`, and what the Python package returns.
#pragma once

#include "leeway/tune/tune.hpp"
#include "motions/json.hpp"

namespace leeway::tune
{

using motions::Json;

/// "steps" or "certified".
const char* validatorName( const Row& row );

Json toJson( const Tuning& tuning, const Settings& settings );

} // namespace leeway::tune
