// SPDX-License-Identifier: BSD-3-Clause
// Pieces of the JSON reports. JSON has no infinity: an unbounded number is null.
#pragma once

#include "program/setup.hpp"

#include <nlohmann/json.hpp>

namespace leeway::cli
{

using Json = nlohmann::ordered_json;

Json jsonNumber( double value );
Json jsonClearance( const Named& clearance );
/// As a file has it. Bytes of file names that are not UTF-8 are replaced.
std::string jsonText( const Json& json );

} // namespace leeway::cli
