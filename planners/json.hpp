// SPDX-License-Identifier: BSD-3-Clause
// Pieces of the JSON reports. JSON has no infinity: an unbounded number is null.
#pragma once

#include "setup.hpp"

#include <nlohmann/json.hpp>

namespace leeway::cli
{

using Json = nlohmann::ordered_json;

Json jsonNumber( double value );
Json jsonClearance( const Named& clearance );

} // namespace leeway::cli
