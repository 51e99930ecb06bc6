// SPDX-License-Identifier: BSD-3-Clause
// Reports as JSON: the program writes them, the Python package returns them. JSON has no infinity: an unbounded number is null.
#pragma once

#include "leeway/motions/states.hpp"

#include <nlohmann/json.hpp>

namespace leeway::motions
{

using Json = nlohmann::ordered_json;

Json jsonNumber( double value );
Json jsonClearance( const Named& clearance );
/// Seconds as ROS's messages have them, to the nanosecond.
Json timeFromStart( double seconds );
/// As a file has it. Bytes of file names that are not UTF-8 are replaced.
std::string jsonText( const Json& json );

} // namespace leeway::motions
